"""The kinetic relation (54): every velocity, and the couplings at which fronts begin and end."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import mpmath as mp
import numpy as np

from theory.cells.vdp import ETA_END
from theory.piecewise.folds import fold_coupling, fold_eta
from theory.piecewise.kinetic_relation import KineticRelation, kinetic_relation
from theory.piecewise.limits import (
    ETA_PIN_END,
    pinning_coupling,
    pinning_eta,
    retreat_coupling,
    strong_coupling_velocity,
)
from theory.piecewise.sums.integral import sums
from verification.quantities.quantity import Axis, Check, Claim, Quantity
from verification.references.kinetic_relation import (
    ratio_precise,
    reference_sum,
    static_sum_precise,
)

C = Axis("c", 1e-8, 1e8)
ETA = Axis("eta", 1e-12, ETA_END, near=(ETA_END, ETA_PIN_END))
EPS = float(np.finfo(float).eps)
_DIGITS = 40


def _velocities(at: Mapping[str, float]) -> Claim:
    found = kinetic_relation(at["c"], at["eta"])
    spread = max((branch.error / abs(branch.v) for branch in found.branches), default=0.0)
    numbers = [branch.v for branch in found.branches]
    limits = [x for x in (found.c_pin, found.c_fold, found.c_retreat) if x is not None]
    return Claim(np.array(numbers + limits), spread, extra=found)


def _check_velocities(at: Mapping[str, float], claim: Claim) -> Check:
    """Hold g = |Σ + shift| - 2r, in many digits, to a change of sign over each error interval.

    The distance is the farthest that g would still have to go, relative to v; and one if double
    precision sees more changes of sign on a plain grid than there are branches.
    """
    found: KineticRelation = claim.extra
    worst, by = 0.0, "sign of g in many digits"
    for branch in found.branches:
        shift = 2 if branch.v < 0 else 0
        speed = mp.mpf(abs(branch.v))
        # The bound is on v itself; a velocity and its bound are the binary numbers they are.
        ends = [_excess(float(speed + side * mp.mpf(branch.error)), at, shift) for side in (-1, 1)]
        if (ends[0] > 0) == (ends[1] > 0):
            slope = abs(ends[1] - ends[0]) / (2.0 * branch.error)
            off = min(abs(ends[0]), abs(ends[1]))
            # A fold touched to within rounding is one branch with no change of sign.
            flat = abs(off) < 1e-15 * (1.0 + 2.0 * float(ratio_precise(at["eta"])))
            if not (flat and branch.error / abs(branch.v) > 1e-9):
                worst = max(worst, (branch.error + off / max(slope, 1e-300)) / abs(branch.v))
    if at["eta"] < ETA_END and _changes_of_sign(at) > len(found.branches):
        return Check(1.0, 0.0, "changes of sign on a grid")
    return Check(worst, 0.0, by)


def _excess(v: float, at: Mapping[str, float], shift: int) -> float:
    value, uncertainty, _ = reference_sum(v, at["c"], _DIGITS)
    with mp.workdps(_DIGITS + 20):
        g = abs(value + shift) - 2 * ratio_precise(at["eta"])
        return float(g) if abs(g) > uncertainty else 0.0


def _changes_of_sign(at: Mapping[str, float]) -> int:
    """Count sure changes of sign of g, of both directions, on a grid that no search has chosen."""
    c, target = at["c"], 2.0 * float(ratio_precise(at["eta"]))
    v = np.geomspace(0.0181, 10.0 * (c + math.sqrt(c) + 1.0) / min(target, 1.0), 1500)
    found = sums(v, c, 1e-13)
    total = 0
    for shift in (0.0, 2.0) if at["eta"] > ETA_PIN_END else (0.0,):
        g = np.abs(found.value + shift) - target
        sure = np.sign(g[np.abs(g) > 2.0 * found.error + 1e-12])
        total += int(np.count_nonzero(sure[1:] != sure[:-1]))
    return total


def _closed(
    value: Callable[[float], float | None], name: str, condition: Callable[[float, float], float]
) -> Callable[[Mapping[str, float]], Claim]:
    """Return a closed form as a claim: right to rounding, of its argument as well."""

    def compute(at: Mapping[str, float]) -> Claim:
        found = value(at[name])
        if found is None:
            return Claim(None, 0.0)
        return Claim(found, 16.0 * EPS * found * (1.0 + condition(at[name], found)))

    return compute


def _by_newton(
    defect: Callable[[Any, Any], Any], exists: Callable[[float], bool], name: str
) -> Callable[[Mapping[str, float], Claim], Check]:
    """Return a check: Newton's step of a defining equation, in many digits, from the claim."""

    def check(at: Mapping[str, float], claim: Claim) -> Check:
        if (claim.value is not None) != exists(at[name]):
            return Check(math.inf, 0.0, "whether it exists")
        if claim.value is None:
            return Check(0.0, 0.0, "whether it exists")
        with mp.workdps(100):
            x, given = mp.mpf(claim.value), mp.mpf(at[name])
            if x == 0:
                return Check(0.0 if defect(x, given) == 0 else math.inf, 0.0, "zero put in")
            h = x * mp.mpf(10) ** -40
            here = defect(x, given)
            slope = (defect(x + h, given) - defect(x - h, given)) / (2 * h)
            return Check(float(abs(here / slope)), 0.0, "Newton in 100 digits")

    return check


def _pinned(c: Any, eta: Any) -> Any:
    return abs(static_sum_precise(c)) - 2 * ratio_precise(eta)


def _retreats(c: Any, eta: Any) -> Any:
    return abs(2 + static_sum_precise(c)) - 2 * ratio_precise(eta)


def _strong(V: Any, eta: Any) -> Any:
    q = mp.sqrt(mp.mpc(-V * V, 1))
    return 1 / abs(q * (V - 1j * q)) - 2 * ratio_precise(eta)


def _static_eta(eta: Any, c: Any) -> Any:
    return _pinned(c, eta)


def _near_pin_end(eta: float, _: float) -> float:
    return eta / abs(ETA_PIN_END - eta) + _near_end(eta, 0.0)


def _near_end(eta: float, _: float) -> float:
    """|d ln r/d ln η| = 1/(2s), s = √(1 - 8η)."""
    return 1.0 / math.sqrt(max(1.0 - 8.0 * eta, EPS))


def _fold(at: Mapping[str, float]) -> Claim:
    found = fold_coupling(at["eta"])
    if found is None:
        return Claim(None, 0.0)
    return Claim(found.value, found.error, extra=found.velocity)


def _check_fold(at: Mapping[str, float], claim: Claim) -> Check:
    """Hold the height of |Σ| near the fold's velocity against 2r on both sides of c_fold."""
    eta, below_end = at["eta"], at["eta"] < ETA_PIN_END
    if claim.value is None or not below_end:
        return Check(0.0 if (claim.value is None) != below_end else math.inf, 0.0, "existence")
    if claim.extra == 0.0:  # at pinning itself
        with mp.workdps(60):
            h = mp.mpf(claim.value) * mp.mpf(10) ** -25
            slope = (_pinned(claim.value + h, eta) - _pinned(claim.value - h, eta)) / (2 * h)
            rounding = 16.0 * EPS * claim.value * (1.0 + _near_pin_end(eta, 0.0))
            off = float(abs(_pinned(mp.mpf(claim.value), eta) / slope))
        return Check(off, rounding, "Newton in 60 digits")
    return _check_height(claim.value, claim.extra, eta, claim.error, 0.0)


def _check_height(c: float, v: float, eta: float, c_error: float, eta_error: float) -> Check:
    """Check that the local maximum of |Σ| over v passes 2r within the stated error."""

    def excess(v_: float, side: int) -> float:
        at = {"c": c + side * c_error, "eta": eta - side * eta_error}
        return _excess(v_, at, 0)

    above = excess(v, 1)
    beside = [excess(v * (1.0 + t), -1) for t in (-1e-7, 0.0, 1e-7)]
    held = above >= 0 and all(value <= 0 for value in beside)
    return Check(0.0 if held else math.inf, 0.0, "height of the maximum in many digits")


def _eta_fold(at: Mapping[str, float]) -> Claim:
    found = fold_eta(at["c"])
    return Claim(found.value, found.error, extra=found.velocity)


def _check_eta_fold(at: Mapping[str, float], claim: Claim) -> Check:
    if claim.extra == 0.0:
        return _by_newton(_static_eta, lambda _: True, "c")(at, claim)
    return _check_height(at["c"], claim.extra, claim.value, 0.0, claim.error)


QUANTITIES = (
    Quantity(
        "kinetic",
        "every velocity of (54), none missed",
        (C, ETA),
        _velocities,
        _check_velocities,
        seconds=20.0,
        share=0.3,
        scenes="relation",
    ),
    Quantity(
        "c-pin",
        "the coupling up to which static fronts exist",
        (ETA,),
        _closed(pinning_coupling, "eta", _near_pin_end),
        _by_newton(_pinned, lambda eta: eta < ETA_PIN_END, "eta"),
        seconds=0.01,
        scenes="relation",
    ),
    Quantity(
        "c-retreat",
        "the coupling above which the excited state retreats",
        (ETA,),
        _closed(retreat_coupling, "eta", _near_pin_end),
        _by_newton(_retreats, lambda eta: eta > ETA_PIN_END, "eta"),
        seconds=0.01,
        scenes="relation",
    ),
    Quantity(
        "strong-coupling-velocity",
        "V of v = V sqrt(c) as c grows",
        (ETA,),
        _closed(strong_coupling_velocity, "eta", _near_pin_end),
        _by_newton(_strong, lambda eta: eta < ETA_PIN_END, "eta"),
        seconds=0.05,
        scenes="relation",
    ),
    Quantity(
        "eta-pin",
        "the eta above which static fronts exist",
        (Axis("c", 1e-8, 1e8),),
        _closed(pinning_eta, "c", lambda *_: 0.0),
        _by_newton(_static_eta, lambda _: True, "c"),
        seconds=0.01,
    ),
    Quantity(
        "c-fold",
        "the coupling at which moving fronts begin",
        (ETA,),
        _fold,
        _check_fold,
        seconds=1.0,
        share=0.6,
        scenes="relation",
    ),
    Quantity(
        "eta-fold",
        "the eta at which moving fronts end",
        (C,),
        _eta_fold,
        _check_eta_fold,
        seconds=1.0,
        share=0.6,
        scenes="relation",
    ),
)
