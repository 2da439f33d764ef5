"""Roots of the dispersion relation (50), and the front profile (49) built from them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import mpmath as mp
import numpy as np

from theory.parameters import ParameterError, within
from theory.piecewise.profile import FrontShape, front_profile
from theory.piecewise.root_count import count_in_strips
from theory.piecewise.roots import MAX_LABEL, labelled_roots
from verification.quantities.quantity import (
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.references.pace import NoReferenceError
from verification.references.piecewise import dispersion, dispersion_slope

_TERMS = 400


def _roots(at: Mapping[str, float]) -> StatedValue:
    upper = at["side"] < 2
    label = within("label", at["label"], 1, MAX_LABEL - 2)
    middle = round(label) * (1 if at["side"] % 2 else -1)
    labels = np.arange(middle - 2, middle + 3)
    found = labelled_roots(at["v"], at["c"], labels, upper)
    relative = float(np.max(found.radius / np.abs(found.k)))
    return StatedValue(value=found.k, error=relative, extra=found)


def _check_roots(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Check each root by Newton in 50 digits, and the number of roots by the argument principle."""
    found, upper = stated.extra, at["side"] < 2
    worst = 0.0
    with mp.workdps(50):
        v, c = mp.mpf(at["v"]), mp.mpf(at["c"])
        for k, radius in zip(found.k.tolist(), found.radius.tolist(), strict=True):
            k_ = mp.mpc(k)
            for _ in range(8):
                k_ -= dispersion(v, c, k_) / dispersion_slope(v, c, k_)
            off = float(abs(k_ - mp.mpc(k)))
            if off > radius:
                worst = max(worst, off / abs(k))
    try:
        counted = count_in_strips(at["v"], at["c"], found.labels, upper)
    except ParameterError:  # a root is too near the contour for double precision
        return ReferenceCheck(distance=worst, method="Newton in 50 digits")
    if counted != found.labels.size:
        return ReferenceCheck(distance=math.inf, method=f"{counted} roots counted")
    return ReferenceCheck(distance=worst, method="Newton in 50 digits and the argument principle")


def _profile(at: Mapping[str, float]) -> StatedValue:
    zeta = at["distance"] * (1.0 if at["side"] < 2 else -1.0)
    found = front_profile([zeta], at["v"], at["c"], at["tolerance"])
    return StatedValue(value=complex(found.phi[0]), error=found.error, extra=found)


def _check_profile(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Sum the printed series (49) in 30 digits, where its terms decay within the roots available.

    Between roots n and the next period the terms decrease at least like |k|^{-2-|ζ|}: the remainder
    is bounded by the last terms kept times their number.
    """
    found: FrontShape = stated.extra
    zeta = float(found.zeta[0])
    upper = zeta > 0
    v, c = at["v"], at["c"]
    if c / v > 100.0:
        raise NoReferenceError("too many roots one by one.")
    reach = _TERMS + math.ceil(2.0 * c / v)
    labels = np.arange(-reach, reach + 1)
    roots = labelled_roots(v, c, labels, upper)
    size = 1.0 / (np.abs(roots.k) * np.abs(v + c * np.sin(roots.k)))
    waves = np.exp(-zeta * roots.k.imag) * size
    rest = float(max(waves[0], waves[-1])) * reach * 4.0
    slope = v + c * np.sin(roots.k)
    moved = abs(zeta) + 1.0 / np.abs(roots.k) + c * np.abs(np.cos(roots.k) / slope)
    rounding = 0.5 * float(np.sum(waves * (roots.radius * moved + 1e-15))) + 1e-15
    terms = np.exp(1j * zeta * roots.k) / (-1j * roots.k * slope)
    total = complex(np.sum(terms[np.argsort(np.abs(terms))]))
    value = -0.5 * total if upper else 1.0 + 0.5 * total
    uncertain = rest + rounding
    if uncertain > 1e3 * stated.error + 1e-9:
        raise NoReferenceError("the series converges too slowly this near the front.")
    return ReferenceCheck(
        distance=abs(complex(stated.value) - value),
        uncertainty=uncertain,
        method="the printed series",
    )


QUANTITIES = (
    Quantity(
        name="roots", title="41 roots of Eq. (50), none left out", equation="(50)",
        problems="sum", accuracy=1e-35, default="labelled roots", useful=(1e-12, 1e-2),
        reference="secants of mpmath at 40 digits; their number from the winding of L",
        computations=(
            Computation(
                name="roots", title="labelled roots of (50), five strips in a row",
                axes=axes(v=(1e-8, 1e8), c=(1e-8, 1e8), label=(1, 1_000_000), side=(1, 4)),
                compute=_roots, check=_check_roots, seconds=0.1, share=2.0, problems="sum",
            ),
        ),
    ),
    Quantity(
        name="profile", title="shape of the front", equation="(49)",
        problems="sum", accuracy=1e-9, default="periodised integral",
        reference="the printed series (49), summed root by root",
        computations=(
            Computation(
                name="profile", title="the shape (49) of the front",
                axes=axes(
                    v=(1e-8, 1e8), c=(1e-8, 1e8), distance=(1e-3, 1e4), tolerance=(1e-14, 0.1),
                    side=(1, 3),
                ),
                compute=_profile, check=_check_profile, seconds=10.0, problems="sum",
            ),
        ),
    ),
)  # fmt: skip
