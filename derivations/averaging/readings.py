"""Checks of each reading of the open n in (35)-(37) against the averaged chain itself."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import root

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import value
from derivations.algebra.steps import Check, Evidence
from derivations.chain import PAPER
from derivations.chain_numbers import ChainNumbers, numbers_of
from derivations.symbols import a, alpha_0, b, c, k_1, n

_POINT = {a: 2.5, b: 0.5, c: 0.1}
"""The chain of Fig. 8."""
_CLOSE = 0.01
"""Relative error of the neighbour's amplitude that still counts as agreement."""


def paper_numbers(
    linear: float, quintic: float, coupling: float = 0.1, eps: float = 1.0
) -> ChainNumbers:
    """Return the chain of Eq. (8) in numbers, per unit of eps if eps is omitted."""
    return numbers_of(PAPER, {a: linear, b: quintic, c: coupling}, eps)


def damping_mean(square: float, p: ChainNumbers) -> float:
    """Return the averaged damping of a cell with ``|phi|² = square``, per unit of eps t."""
    return float(-p.cell_rate(math.sqrt(square)).real / p.eps)


@lru_cache(maxsize=1)
def averaged_breather() -> Any:
    """Return r_n of the steady breather: sampled damping, phase steps of -π/2, Newton's method."""
    p, sites = paper_numbers(_POINT[a], _POINT[b], _POINT[c]), 12

    def rates(r: Any) -> Any:
        out = np.empty(sites)
        for site in range(sites):
            left = r[site - 1] if site else -r[1]
            right = r[site + 1] if site + 1 < sites else 0.0
            loss = damping_mean(max(r[site] ** 2, 1e-24), p)
            out[site] = _POINT[c] / 2 * (left - right) - r[site] * loss
        return out

    return root(rates, 2.82 * 0.1 ** np.arange(sites), tol=1e-12).x


def at_every_site(candidate: sp.Basic) -> Evidence:
    """Test whether three sites of a decaying sequence can have the same damping."""
    del candidate  # the requirement is judged, not its form
    p = paper_numbers(_POINT[a], _POINT[b], _POINT[c])
    for growth in (-0.2, -0.7, -2.0):
        for size in (0.3, 1.5, 2.8, 6.0):
            means = [damping_mean((size * math.exp(growth * site)) ** 2, p) for site in (1, 2, 3)]
            if max(means) - min(means) < 1e-6:
                return Evidence(True, "three sites balance at once")
    return Evidence(
        False, "sites 1, 2 and 3 never share their mean damping: twelve sequences tried"
    )


def solved_with_29(place: int | None) -> Check:
    """Solve (29) with the reading, and compare the neighbour with the averaged chain."""
    p = paper_numbers(_POINT[a], _POINT[b], _POINT[c])

    def check(candidate: sp.Basic) -> Evidence:
        exact = averaged_breather()
        relation = parts_of(candidate)[0]

        def rest(unknown: Any) -> Any:
            size, growth = unknown
            point = {**_POINT, alpha_0: size, k_1: growth}
            if place is None:
                point[n] = 0
            left, right = (value(side, point).real for side in relation.args)
            return [left - right, math.exp(growth) * _POINT[c] + damping_mean(size**2, p)]

        for start in (-2.3, -1.0, -3.5):
            found = root(rest, [exact[0], start], tol=1e-12)
            # The solver also reports success when it has merely stopped moving.
            if found.success and np.abs(rest(found.x)).max() < 1e-9:
                neighbour = found.x[0] * math.exp(found.x[1])
                error = float(abs(neighbour / exact[1] - 1))
                return Evidence(error < _CLOSE, f"with (29) the neighbour is off by {error:.1e}")
        return Evidence(False, "with (29) it has no solution")

    return check
