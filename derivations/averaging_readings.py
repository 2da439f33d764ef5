"""What each reading of the open n in (35)-(37) amounts to, against the averaged chain itself."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import root

from derivations.algebra.evidence import parts_of, value
from derivations.averaging_evidence import damping_mean
from derivations.derivation import Check, Evidence
from derivations.printed import Reading
from derivations.symbols import a, alpha_0, b, c, k_1, n

_CELL = {"a": 2.5, "b": 0.5, "c": 0.1}
_CLOSE = 0.01
"""Relative error of the neighbour's amplitude that still counts as agreement."""


@lru_cache(maxsize=1)
def _averaged_breather() -> Any:
    """r_n of the steady breather: sampled damping, phase steps of -pi/2, Newton's method."""
    p, sites = {**_CELL, "e": 1.0, "w": 1.0}, 12

    def rates(r: Any) -> Any:
        out = np.empty(sites)
        for site in range(sites):
            left = r[site - 1] if site else -r[1]
            right = r[site + 1] if site + 1 < sites else 0.0
            out[site] = p["c"] / 2 * (left - right) - r[site] * damping_mean(r[site] ** 2, p)
        return out

    return root(rates, 2.82 * 0.1 ** np.arange(sites), tol=1e-12).x


def at_every_site(candidate: sp.Basic) -> Evidence:
    """Whether three sites of a decaying sequence can have the same damping."""
    p = {**_CELL, "e": 1.0, "w": 1.0}
    for growth in (-0.2, -0.7, -2.0):
        for size in (0.3, 1.5, 2.8, 6.0):
            means = [damping_mean((size * math.exp(growth * site)) ** 2, p) for site in (1, 2, 3)]
            if max(means) - min(means) < 1e-6:
                return Evidence(True, "three sites balance at once")
    return Evidence(
        False, "sites 1, 2 and 3 never share their mean damping: twelve sequences tried"
    )


def of_the_site(decay: sp.Tuple) -> tuple[Reading, ...]:
    """Return the readings of (37): together with (29) at n = 0, n = 1, and far out."""
    far = sp.Tuple(*(part.subs({sp.exp(2 * k_1 * n): 0, sp.exp(4 * k_1 * n): 0}) for part in decay))
    return (
        Reading("n = 0, the centre", decay.subs(n, 0), False,
                "with (29) no solution: its bracket is negative on the cycle", _solves(0)),
        Reading("n = 1, the first neighbour", decay.subs(n, 1), True,
                "the reading that agrees with the close match claimed for Fig. 8", _solves(1)),
        Reading("n large, the linear tail", far, False,
                "right for the tail, 2 c sinh k_1 = -1, but not for the neighbour", _solves(None)),
    )  # fmt: skip


def _solves(place: int | None) -> Check:
    """Solve (29) with the reading and compare the neighbour with the averaged chain."""

    def check(candidate: sp.Basic) -> Evidence:
        exact = _averaged_breather()
        relation = parts_of(candidate)[0]

        def rest(unknown: Any) -> Any:
            size, growth = unknown
            point = {a: _CELL["a"], b: _CELL["b"], c: _CELL["c"], alpha_0: size, k_1: growth}
            if place is None:
                point[n] = 0
            left, right = (value(side, point).real for side in relation.args)
            mean = damping_mean(size**2, {**_CELL, "e": 1.0, "w": 1.0})
            return [left - right, math.exp(growth) * _CELL["c"] + mean]

        for start in (-2.3, -1.0, -3.5):
            found = root(rest, [exact[0], start], tol=1e-12)
            # The solver also reports success where it merely stopped moving.
            if found.success and np.abs(rest(found.x)).max() < 1e-9:
                neighbour = found.x[0] * math.exp(found.x[1])
                error = float(abs(neighbour / exact[1] - 1))
                return Evidence(error < _CLOSE, f"with (29) the neighbour is off by {error:.1e}")
        return Evidence(False, "with (29) it has no solution")

    return check
