"""What a user would otherwise pick for Σ(v, c): ``scipy.integrate.quad``, and a root finder.

The root finder is cxroots (argument principle, subdivided boxes, Newton), an optional extra. It is
given the derivative, and a box known to hold the roots of consecutive labels and no others.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import mpmath as mp
import numpy as np

from benchmarks.runner import Answer, Contender
from theory.piecewise.root_count import height_above_roots
from theory.piecewise.sums.series import SeriesScene, tail_sum

_TAIL_DIGITS = 15
_MOST_TAIL_TERMS = 24


class MissedRootError(ArithmeticError):
    """A root finder that did not return one root a strip."""


def peers(v: float, c: float, reference: Any) -> Iterator[Contender]:
    """Yield the peers at one (v, c)."""
    for tolerance, limit in ((None, 50), (1e-8, 1_000), (1e-10, 10_000), (1e-12, 10_000)):
        knob = "defaults" if tolerance is None else f"tolerance {tolerance:g}, limit {limit}"
        yield Contender(
            "scipy.integrate.quad",
            knob,
            partial(plain_quad, v, c, tolerance, limit),
            reference,
            peer=True,
        )
    settings: tuple[tuple[str, dict[str, Any], tuple[int, ...]], ...] = (
        ("M=2", {"M": 2}, (1, 3, 6, 9)),
        ("romb, M=3", {"int_method": "romb", "M": 3}, (1, 3, 6)),
        ("defaults", {}, (1, 3)),
    )
    for name, options, reaches in settings:
        for reach in reaches:
            for tail in (True, False) if name == "M=2" else (True,):
                yield Contender(
                    "cxroots, our tail" if tail else "cxroots, cut off",
                    f"{2 * reach + 1} roots, {name}",
                    partial(by_contour_roots, v, c, reach, tail, options),
                    reference,
                    quick=reach == 1 and name == "M=2" and 0.1 < v < 1.0,
                    peer=True,
                )


def plain_quad(v: float, c: float, tolerance: float | None, limit: int) -> Answer:
    """Return Σ = -1 + (v/π) ∫₀^∞ dk/(A² + v²k²) as one call of ``quad``."""
    from scipy.integrate import quad

    def integrand(k: float) -> complex:
        onsite = 0.5 - 1j * c * (1.0 - math.cos(k))
        return 1.0 / (onsite * onsite + v * v * k * k)

    options: dict[str, Any] = {} if tolerance is None else {"epsabs": tolerance, "epsrel": 0.0}
    value, estimate = quad(integrand, 0.0, math.inf, complex_func=True, limit=limit, **options)
    size = abs(complex(estimate)) if np.iscomplexobj(estimate) else float(estimate)
    return Answer(complex(value) * v / math.pi - 1.0, size * v / math.pi)


def by_contour_roots(
    v: float, c: float, reach: int, tail: bool, options: Mapping[str, Any]
) -> Answer:
    """Return Σ from the roots that cxroots finds in the strips -reach … reach above the axis.

    With ``tail`` the terms beyond are added by the Euler–Maclaurin tail of
    ``theory.piecewise.sums.series``, here also at labels nearer to the singularities than that
    module would dare; hence no bound is claimed. ``options`` are handed to cxroots; M = 2, at most
    two roots a box, is the fastest found for it, and romb the one that bears roots near the edge of
    the box.

    Raises
    ------
    MissedRootError
        If there is not one root a strip.
    """
    from cxroots import Rectangle

    logging.getLogger("cxroots").setLevel(logging.ERROR)
    left, right = -2.0 * math.pi * reach - math.pi, 2.0 * math.pi * reach
    box = Rectangle((left, right), (0.0, height_above_roots(v, c, -left)))

    def dispersion(k: Any) -> Any:
        return 0.5 - 1j * c * (1.0 - np.cos(k)) - 1j * v * k

    def slope(k: Any) -> Any:
        return -1j * (v + c * np.sin(k))

    k = np.array(box.roots(dispersion, slope, **options).roots, dtype=complex)
    labels = np.ceil(k.real / (2.0 * math.pi)).astype(int)  # Re k from 2πn - π to 2πn
    wanted = np.arange(-reach, reach + 1)
    if not np.array_equal(np.sort(labels), wanted):
        raise MissedRootError(f"{k.size} roots found, {wanted.size} exist in the box")
    terms = 1.0 / (k * slope(k))
    if not tail:
        return Answer(complex(np.sum(terms)), None)
    terms = np.where(np.abs(labels) == reach, 0.5 * terms, terms)  # the tail holds the other half
    with mp.workdps(_TAIL_DIGITS + 15):
        scene = SeriesScene(mp.mpf(v), mp.mpf(c), 1)
        rest = [tail_sum(scene, side * reach, side, _MOST_TAIL_TERMS) for side in (-1, 1)]
        return Answer(complex(sum(part for part, _ in rest)) + complex(np.sum(terms)), None)
