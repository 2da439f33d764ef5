"""The kinetic relation (54): every velocity, and the couplings between which fronts exist."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import mpmath as mp
import numpy as np

from theory.arrays import EPS
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
from verification.quantities.quantity import (
    Axis,
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.quantities.sums import reference_sum
from verification.references.piecewise import static_sum, threshold_ratio

(C,) = axes(c=(1e-8, 1e8))
ETA = Axis(name="eta", low=1e-12, high=ETA_END, near=(ETA_END, ETA_PIN_END))
ROUNDING = 16.0 * EPS
"""Relative error of a closed form in double precision."""
_DIGITS = 30


def _velocities(at: Mapping[str, float]) -> StatedValue:
    found = kinetic_relation(at["c"], at["eta"])
    spread = max((branch.error / abs(branch.v) for branch in found.branches), default=0.0)
    numbers = [branch.v for branch in found.branches]
    limits = [x for x in (found.c_pin, found.c_fold, found.c_retreat) if x is not None]
    return StatedValue(value=np.array(numbers + limits), error=spread, extra=found)


def _check_velocities(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Test g = |Σ + shift| - 2r, with many digits, for a change of sign over each error interval.

    The distance is the largest further shift that the change of sign would require, relative to v;
    it is one if g, in double precision on a plain grid, changes sign more often than there are
    branches.
    """
    found: KineticRelation = stated.extra
    worst, by = 0.0, "sign of g in many digits"
    for branch in found.branches:
        shift = 2 if branch.v < 0 else 0
        speed = mp.mpf(abs(branch.v))
        # The bound refers to v as a binary number; velocity and bound are used exactly as stored.
        ends = [_excess(float(speed + side * mp.mpf(branch.error)), at, shift) for side in (-1, 1)]
        if (ends[0] > 0) == (ends[1] > 0):
            slope = abs(ends[1] - ends[0]) / (2.0 * branch.error)
            off = min(abs(ends[0]), abs(ends[1]))
            # A fold that is touched to within rounding is one branch without a change of sign.
            flat = off < 1e-15 * (1.0 + 2.0 * float(threshold_ratio(at["eta"])))
            if not (flat and branch.error / abs(branch.v) > 1e-9):
                worst = max(worst, (branch.error + off / max(slope, 1e-300)) / abs(branch.v))
    if at["eta"] < ETA_END and _changes_of_sign(at) > len(found.branches):
        return ReferenceCheck(distance=1.0, method="changes of sign on a grid")
    return ReferenceCheck(distance=worst, method=by)


def _excess(v: float, at: Mapping[str, float], shift: int) -> float:
    with mp.workdps(_DIGITS + 20):
        g, uncertainty = _defect(v, at, shift)
        return float(g) if abs(g) > uncertainty else 0.0


def precise_velocity(v: float, at: Mapping[str, float]) -> tuple[Any, float]:
    """Return the root of (54) next to v by a Newton step with many digits, and its uncertainty.

    The relative uncertainty of the slope, and hence of the step, is the difference between the
    slopes to the left and to the right. From a root in double precision the step is as small as a
    rounding error.
    """
    shift = 2 if v < 0 else 0
    with mp.workdps(_DIGITS + 20):
        points = [abs(v) * (1.0 + side * 1e-9) for side in (-1, 0, 1)]
        below, here, above = (_defect(x, at, shift)[0] for x in points)
        x0, x1, x2 = (mp.mpf(x) for x in points)
        left, right = (here - below) / (x1 - x0), (above - here) / (x2 - x1)
        slope = (left + right) / 2
        step = here / slope
        return mp.sign(v) * (x1 - step), float(abs(step * (right - left) / slope))


def _defect(v: float, at: Mapping[str, float], shift: int) -> tuple[Any, float]:
    """Return |Σ + shift| - 2r with many digits, and the uncertainty of Σ."""
    value, uncertainty, _ = reference_sum(v, at["c"], _DIGITS)
    return abs(value + shift) - 2 * threshold_ratio(at["eta"]), uncertainty


def _changes_of_sign(at: Mapping[str, float]) -> int:
    """Count certain changes of sign of g, in both directions, on a grid that no search chose."""
    c, target = at["c"], 2.0 * float(threshold_ratio(at["eta"]))
    v = np.geomspace(0.0181, 10.0 * (c + math.sqrt(c) + 1.0) / min(target, 1.0), 1500)
    found = sums(v, c, 1e-13)
    total = 0
    for shift in (0.0, 2.0) if at["eta"] > ETA_PIN_END else (0.0,):
        g = np.abs(found.value + shift) - target
        sure = np.sign(g[np.abs(g) > 2.0 * found.error + 1e-12])
        total += int(np.count_nonzero(sure[1:] != sure[:-1]))
    return total


def _closed(
    value: Callable[[float], float | None], name: str
) -> Callable[[Mapping[str, float]], StatedValue]:
    """Return a closed form with its error: rounding at the argument as it is stored."""

    def compute(at: Mapping[str, float]) -> StatedValue:
        found = value(at[name])
        return StatedValue(value=found, error=ROUNDING * found if found else 0.0)

    return compute


def _by_newton(
    defect: Callable[[Any, Any], Any], exists: Callable[[float], bool], name: str
) -> Callable[[Mapping[str, float], StatedValue], ReferenceCheck]:
    """Return a check: a Newton step of a defining equation in many digits, from the value."""

    def check(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
        if stated.value is None or not exists(at[name]):
            return ReferenceCheck.exact(
                (stated.value is not None) == exists(at[name]), method="whether it exists"
            )
        with mp.workdps(100):
            x, given = mp.mpf(stated.value), mp.mpf(at[name])
            if x == 0:
                return ReferenceCheck.exact(defect(x, given) == 0, method="substitution of zero")
            h = x * mp.mpf(10) ** -40
            here = defect(x, given)
            slope = (defect(x + h, given) - defect(x - h, given)) / (2 * h)
            return ReferenceCheck(distance=float(abs(here / slope)), method="Newton in 100 digits")

    return check


def _pinned(c: Any, eta: Any) -> Any:
    return abs(static_sum(c)) - 2 * threshold_ratio(eta)


def _retreats(c: Any, eta: Any) -> Any:
    return abs(2 + static_sum(c)) - 2 * threshold_ratio(eta)


def _strong(V: Any, eta: Any) -> Any:
    q = mp.sqrt(mp.mpc(-V * V, 1))
    return 1 / abs(q * (V - 1j * q)) - 2 * threshold_ratio(eta)


def _static_eta(eta: Any, c: Any) -> Any:
    return _pinned(c, eta)


def _fold(at: Mapping[str, float]) -> StatedValue:
    found = fold_coupling(at["eta"])
    return StatedValue.of(found, None if found is None else found.value)


def _check_fold(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare the maximum of |Σ| near the fold's velocity with 2r on both sides of c_fold."""
    eta, below_end = at["eta"], at["eta"] < ETA_PIN_END
    if stated.value is None or not below_end:
        return ReferenceCheck.exact((stated.value is None) != below_end, method="existence")
    if stated.extra.velocity == 0.0:  # the fold is at pinning itself
        with mp.workdps(60):
            h = mp.mpf(stated.value) * mp.mpf(10) ** -25
            slope = (_pinned(stated.value + h, eta) - _pinned(stated.value - h, eta)) / (2 * h)
            off = float(abs(_pinned(mp.mpf(stated.value), eta) / slope))
        return ReferenceCheck(
            distance=off, uncertainty=ROUNDING * stated.value, method="Newton in 60 digits"
        )
    return _check_height(stated.value, stated.extra.velocity, eta, stated.error, 0.0)


def _check_height(
    c: float, v: float, eta: float, c_error: float, eta_error: float
) -> ReferenceCheck:
    """Check that the local maximum of |Σ| over v passes through 2r within the stated error."""

    def excess(v_: float, side: int) -> float:
        at = {"c": c + side * c_error, "eta": eta - side * eta_error}
        return _excess(v_, at, 0)

    above = excess(v, 1)
    beside = [excess(v * (1.0 + t), -1) for t in (-1e-7, 0.0, 1e-7)]
    held = above >= 0 and all(value <= 0 for value in beside)
    return ReferenceCheck.exact(held, method="height of the maximum in many digits")


def _eta_fold(at: Mapping[str, float]) -> StatedValue:
    found = fold_eta(at["c"])
    return StatedValue.of(found, found.value)


def _check_eta_fold(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    if stated.extra.velocity == 0.0:
        return _by_newton(_static_eta, lambda _: True, "c")(at, stated)
    return _check_height(at["c"], stated.extra.velocity, stated.value, 0.0, stated.error)


_OF_ETA: Mapping[str, Any] = {"axes": (ETA,), "problems": "relation"}

QUANTITIES = (
    Quantity(
        name="velocity", title="front velocity of Eq. (54)", equation="(54)",
        problems="relation", accuracy=1e-27, default="kinetic relation", useful=(1e-12, 1e-2),
        reference="secants of mpmath over the series and over the integral, 30 digits each",
        computations=(
            Computation(
                name="kinetic", title="every velocity of (54), none missed", axes=(C, ETA),
                compute=_velocities, check=_check_velocities,
                seconds=20.0, share=0.3, problems="relation",
            ),
        ),
    ),
    Quantity(
        name="limits", title="couplings and η at which fronts begin, are pinned, retreat",
        equation="(54)", problems="relation", accuracy=1e-15, default="closed form or fold",
        reference="Newton's step of the defining equation in 100 digits",
        computations=(
            Computation(
                name="c-pin", title="the coupling up to which static fronts exist",
                compute=_closed(pinning_coupling, "eta"),
                check=_by_newton(_pinned, lambda eta: eta < ETA_PIN_END, "eta"),
                seconds=0.01, **_OF_ETA,
            ),
            Computation(
                name="c-retreat", title="the coupling above which the excited state retreats",
                compute=_closed(retreat_coupling, "eta"),
                check=_by_newton(_retreats, lambda eta: eta > ETA_PIN_END, "eta"),
                seconds=0.01, **_OF_ETA,
            ),
            Computation(
                name="strong-coupling-velocity", title="V of v = V sqrt(c) as c grows",
                compute=_closed(strong_coupling_velocity, "eta"),
                check=_by_newton(_strong, lambda eta: eta < ETA_PIN_END, "eta"),
                seconds=0.05, **_OF_ETA,
            ),
            Computation(
                name="eta-pin", title="the eta above which static fronts exist", axes=(C,),
                compute=_closed(pinning_eta, "c"),
                check=_by_newton(_static_eta, lambda _: True, "c"), seconds=0.01,
            ),
            Computation(
                name="c-fold", title="the coupling at which moving fronts begin",
                compute=_fold, check=_check_fold, seconds=1.0, share=0.6, **_OF_ETA,
            ),
            Computation(
                name="eta-fold", title="the eta at which moving fronts end", axes=(C,),
                compute=_eta_fold, check=_check_eta_fold, seconds=1.0, share=0.6,
                problems="relation",
            ),
        ),
    ),
)  # fmt: skip
