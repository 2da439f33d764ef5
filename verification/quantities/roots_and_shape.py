"""Roots of the dispersion relation (50), and the shape (49) that they make."""

from __future__ import annotations

import math
from collections.abc import Mapping

import mpmath as mp
import numpy as np

from theory.parameters import ParameterError, within
from theory.piecewise.profile import FrontProfile, front_profile
from theory.piecewise.root_count import count_in_strips
from theory.piecewise.roots import labelled_roots
from verification.quantities.quantity import Axis, Check, Claim, NoReferenceError, Quantity

V, C = Axis("v", 1e-8, 1e8), Axis("c", 1e-8, 1e8)
_TERMS = 400


def _roots(at: Mapping[str, float]) -> Claim:
    upper = at["side"] < 2
    label = within("label", at["label"], 1, 1e15)
    middle = round(label) * (1 if at["side"] % 2 else -1)
    labels = np.arange(middle - 2, middle + 3)
    found = labelled_roots(at["v"], at["c"], labels, upper)
    relative = float(np.max(found.radius / np.abs(found.k)))
    return Claim(found.k, relative, extra=found)


def _check_roots(at: Mapping[str, float], claim: Claim) -> Check:
    """Newton in 50 digits from each root, and the number of roots by the argument principle."""
    found, upper = claim.extra, at["side"] < 2
    worst = 0.0
    with mp.workdps(50):
        v, c = mp.mpf(at["v"]), mp.mpf(at["c"])
        for k, radius in zip(found.k.tolist(), found.radius.tolist(), strict=True):
            k_ = mp.mpc(k)
            for _ in range(8):
                value = mp.mpf(0.5) - 1j * c * (1 - mp.cos(k_)) - 1j * v * k_
                k_ -= value / (-1j * (v + c * mp.sin(k_)))
            off = float(abs(k_ - mp.mpc(k)))
            if off > radius:
                worst = max(worst, off / abs(k))
    try:
        counted = count_in_strips(at["v"], at["c"], found.labels, upper)
    except ParameterError:  # an edge too near a root for double precision
        return Check(worst, 0.0, "Newton in 50 digits")
    if counted != found.labels.size:
        return Check(math.inf, 0.0, f"{counted} roots counted")
    return Check(worst, 0.0, "Newton in 50 digits and the argument principle")


def _profile(at: Mapping[str, float]) -> Claim:
    zeta = at["distance"] * (1.0 if at["side"] < 2 else -1.0)
    found = front_profile([zeta], at["v"], at["c"], at["tolerance"])
    return Claim(complex(found.phi[0]), found.error, extra=found)


def _check_profile(at: Mapping[str, float], claim: Claim) -> Check:
    """Sum the printed series (49) in 30 digits, where its terms die off within the roots kept.

    Between roots n and the next period the terms fall at least like |k|^{-2-|ζ|}: the rest is
    bounded by the last terms kept, times the number of them.
    """
    found: FrontProfile = claim.extra
    zeta = float(found.zeta[0])
    upper = zeta > 0
    v, c = at["v"], at["c"]
    if c / v > 100.0:
        raise NoReferenceError("too many roots one by one.")
    reach = _TERMS + math.ceil(2.0 * c / v)
    labels = np.arange(-reach, reach + 1)
    roots = labelled_roots(v, c, labels, upper)
    size = 1.0 / (np.abs(roots.k) * np.abs(v + c * np.sin(roots.k)))
    waves = np.exp(-np.abs(zeta * roots.k.imag)) * size
    rest = float(max(waves[0], waves[-1])) * reach * 4.0
    rounding = float(np.sum(waves * (roots.radius * (1.0 + abs(zeta) + c / v) + 1e-15))) + 1e-15
    terms = np.exp(1j * zeta * roots.k) / (-1j * roots.k * (v + c * np.sin(roots.k)))
    total = complex(np.sum(terms[np.argsort(np.abs(terms))]))
    value = -0.5 * total if upper else 1.0 + 0.5 * total
    uncertain = rest + rounding
    if uncertain > 1e3 * claim.error + 1e-9:
        raise NoReferenceError("the series converges too slowly this near the front.")
    return Check(abs(complex(claim.value) - value), uncertain, "the printed series")


QUANTITIES = (
    Quantity(
        "roots",
        "labelled roots of (50), five strips in a row",
        (V, C, Axis("label", 1, 1e6, whole=True), Axis("side", 1, 4, whole=True)),
        _roots,
        _check_roots,
        seconds=0.1,
        share=2.0,
        scenes="sum",
    ),
    Quantity(
        "profile",
        "the shape (49) of the front",
        (
            V,
            C,
            Axis("distance", 1e-3, 1e4),
            Axis("tolerance", 1e-14, 0.1),
            Axis("side", 1, 3, whole=True),
        ),
        _profile,
        _check_profile,
        seconds=10.0,
        scenes="sum",
    ),
)
