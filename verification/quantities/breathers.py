"""Breathers of Model II: closed form, averaged chain, exact orbits, and their thresholds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import mpmath as mp
import numpy as np
from scipy.optimize import linear_sum_assignment

from theory.averaged.breather import BreatherStatus, Reading, closed_form_fold, solve_breather
from theory.cells.vdp import ETA_END
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from verification.breathers.envelope import quarter_turn_branch, solve_envelope_breather
from verification.breathers.orbits import solve_orbit
from verification.quantities.chains import vdp_chain
from verification.quantities.quantity import (
    Axis,
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.references.equations import full_rate, variational_rate
from verification.references.extrapolation import PreciseState, integrate, precise_state
from verification.references.pace import NoReferenceError
from verification.references.precise_breather import locked_fold, locked_state
from verification.thresholds.continuation import breather_threshold
from verification.thresholds.result import ThresholdMethod

ETA = Axis(name="eta", low=1e-12, high=ETA_END, near=(ETA_END,))
A, C, READING = axes(a=(1e-6, 1e6), c=(1e-8, 1e6), reading=(1, 2))
WEAK, EPSILON = axes(c=(1e-8, 1e2), eps=(1e-6, 1.0))
_SITES = 9

_DIGITS = 26
_TOLERANCES = (1e-19, 1e-21)
"""Tolerances of the flow in Newton's steps with many digits; the residual at the second shows the
error of the first."""
_OF_MATRIX = 1e-12
"""Tolerance of the flow from which the matrix of Newton's method is computed."""


def _chain(at: Mapping[str, float], sites: int = 31) -> VdpChain:
    return vdp_chain({"a": 1.0, "eps": 0.01, "sites": sites, **at})


def _reading(at: Mapping[str, float]) -> Literal[Reading.NEIGHBOUR, Reading.TAIL]:
    return Reading.NEIGHBOUR if at["reading"] < 2 else Reading.TAIL


def _fold(at: Mapping[str, float]) -> StatedValue:
    found = closed_form_fold(_chain({**at, "c": 1.0}), _reading(at))
    return StatedValue.of(found, found.c)


def _gain(S: Any, a: Any, b: Any) -> Any:
    return (-b * S * S + 2 * a * S - 8) / 16


def _coefficients(at: Mapping[str, float]) -> tuple[Any, Any]:
    chain = _chain({**at, "c": 1.0})
    return mp.mpf(chain.a), mp.mpf(chain.b)


def _scan(at: Mapping[str, float]) -> tuple[float, float]:
    """Return (S, w) at the first maximum of c along the two sheets, with w as the parameter.

    Eliminating c from (29) and (37) gives a quadratic equation for S at given w,
    b (2w³ + 1 - w) S² - a (4w² + 2(1 - w)) S + 16w + 8(1 - w) = 0; here a = 1, b = η. A maximum
    exists, since c is zero at w = 0 on both sheets and positive between. It tends to w = 2η/3 as
    η → 0 and to (1 - 8η)/2 as η → 1/8, so that w is larger than 1e-18 for η above 1.5e-18.
    """
    eta = at["eta"]
    w = np.geomspace(1e-18, 0.999, 6000)
    first = eta * (2.0 * w**3 + 1.0 - w)
    second = -(4.0 * w**2 + 2.0 * (1.0 - w))
    inside = second**2 - 4.0 * first * (8.0 + 8.0 * w)
    end = int(np.argmax(inside < 0)) if np.any(inside < 0) else w.size
    path = []
    for sign, order in ((1.0, slice(0, end)), (-1.0, slice(end - 1, None, -1))):
        root = np.sqrt(np.maximum(inside[order], 0.0))
        path.append(((-second[order] + sign * root) / (2.0 * first[order]), w[order]))
    S, w = (np.concatenate(each) for each in zip(*path, strict=True))
    s = S * w
    c = np.sqrt(s * S) * (1.0 - s / 4.0 + eta * s * s / 8.0) / (S - s)
    top = np.flatnonzero(np.diff(c) < 0.0)[0]
    return float(S[top]), float(w[top])


def _true_fold(at: Mapping[str, float]) -> tuple[Any, Any]:
    """Return S and c of the fold: (29), (37) and their tangency by Newton, after a plain scan."""
    a, b = _coefficients(at)
    if _reading(at) is Reading.TAIL:  # c = √(G(1 + G)), largest with G
        m = (a * a - 8 * b) / (16 * b)
        return a / b, mp.sqrt(m * (1 + m))
    start = _scan(at)
    S, w = mp.mpf(start[0]) / a, mp.mpf(start[1])
    try:
        S, w = mp.findroot(lambda S, w: _tangency(S, w, a, b), (S, w), tol=1e-80)
    except (ValueError, ZeroDivisionError):
        raise NoReferenceError("Newton in 80 digits does not converge.") from None
    return S, _gain(S, a, b) / mp.sqrt(w)


def _check_fold(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare the coupling of the fold with its value computed in 80 digits."""
    with mp.workdps(80):
        off = abs(_true_fold(at)[1] - stated.value)
        return ReferenceCheck(distance=float(off), method="fold in 80 digits")


def _on_branch(S: Any, w: Any, a: Any, b: Any) -> Any:
    """Return (37) at n = 1 with c of (29), times 2 w/G: zero on the branch."""
    s = S * w
    return w * (1 - a * s / 4 + b * s**2 / 8) - _gain(S, a, b) * (1 - w)


def _tangency(S: Any, w: Any, a: Any, b: Any) -> tuple[Any, Any]:
    """Return (37) and ∂(37, ln c)/∂(S, w), both zero where c is stationary.

    The first is divided by η, as w is for small η, and not by w: Newton's steps would then be
    halved again and again where w tends to zero as η → 1/8.
    """
    s, G = S * w, _gain(S, a, b)
    G_S = (a - b * S) / 8
    shape = 1 - a * s / 4 + b * s**2 / 8
    bend = -a / 4 + b * s / 4
    P_S = w * w * bend - G_S * (1 - w)
    P_w = shape + w * S * bend + G
    return _on_branch(S, w, a, b) * a * a / b, (P_S * (-G / (2 * w)) - P_w * G_S) * S


def _breather(at: Mapping[str, float]) -> StatedValue:
    found = solve_breather(_chain(at), _reading(at))
    none = found.status is BreatherStatus.NONE
    return StatedValue.of(found, None if none else np.array([found.alpha_0, found.decay]))


def _check_breather(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Solve (29) and (37) for S and w by Newton in 80 digits; return the relative distance.

    Newton starts from the stated values; the branch before the fold is the one whose S is above
    that of the fold.
    """
    top = stated.extra.fold.c
    if stated.value is None:
        # The true fold cannot lie farther beyond the stated one than that is from its reference.
        fold = _check_fold(at, StatedValue.of(stated.extra.fold, top))
        return ReferenceCheck.exact(at["c"] > top - fold.distance, method=fold.method)
    a, b = _coefficients(at)
    with mp.workdps(80):
        least = _true_fold(at)[0] * (1 - 2 * stated.error)
        c = mp.mpf(at["c"])
        S, w = mp.mpf(stated.value[0]) ** 2, mp.mpf(stated.value[1]) ** 2
        tail = _reading(at) is Reading.TAIL

        def both(x: Any, y: Any) -> tuple[Any, Any]:
            S_, w_ = S * x, w * y
            second = w_ - (1 - w_) * _gain(S_, a, b) if tail else _on_branch(S_, w_, a, b)
            return _gain(S_, a, b) / (c * mp.sqrt(w_)) - 1, second / w

        try:
            x, y = mp.findroot(both, (mp.mpf(1), mp.mpf(1)), tol=1e-40)
        except (ValueError, ZeroDivisionError):
            if at["c"] > top * (1.0 - 1e-12):
                return ReferenceCheck.exact(True, method="at the fold to within rounding")
            raise NoReferenceError("Newton in 80 digits does not converge.") from None
        off = max(abs(mp.sqrt(x) - 1), abs(mp.sqrt(y) - 1)) if S * x >= least else mp.inf
        return ReferenceCheck(distance=float(off), method="Newton in 80 digits")


def _envelope(at: Mapping[str, float]) -> StatedValue:
    found = solve_envelope_breather(_chain(at, _SITES), Nucleus(1))
    none = found.status is BreatherStatus.NONE
    return StatedValue.of(found, None if none else np.append(found.waves, found.unknowns[-1]))


def _check_envelope(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Solve (34) in the rotating frame by Newton, with the residual in extended precision."""
    if stated.value is None:
        fold = quarter_turn_branch(_chain({**at, "c": 0.1}, 31), Nucleus(1)).fold
        if fold is None:
            raise NoReferenceError("the quarter-turn reduction has no fold.")
        # Nine sites with free ends are not the infinite chain; their folds differ by the effect of
        # the tail.
        return ReferenceCheck.exact(
            at["c"] > 0.98 * fold.parameter, method="quarter-turn reduction"
        )
    phi, omega = np.asarray(stated.value[:-1]), complex(stated.value[-1]).real
    true = locked_state(at["eta"], at["c"], phi, omega)
    given = np.array([*phi.real, *phi.imag, omega])
    return ReferenceCheck(
        distance=float(np.abs(true.value - given).max()),
        uncertainty=true.uncertainty,
        method="Newton in extended precision",
    )


def _orbit(at: Mapping[str, float]) -> StatedValue:
    found = solve_orbit(_chain(at, _SITES), Nucleus(1))
    none = found.status is BreatherStatus.NONE
    return StatedValue.of(found, None if none else found.unknowns)


def _check_orbit(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Solve by shooting, with a flow in extended precision in place of our integrator."""
    if stated.value is None:
        raise NoReferenceError("no orbit to compare with.")
    true = _precise_orbit(at, stated.value)
    return ReferenceCheck(
        distance=float(max(np.abs(true.value - stated.value))),
        uncertainty=true.uncertainty,
        method="shooting in extended precision",
    )


def _flow(
    at: Mapping[str, float], state: Any, period: Any, run: Callable[..., PreciseState]
) -> PreciseState:
    """Return the state after a period and, in the further columns, the monodromy matrix of (42)."""
    start = np.column_stack([state, np.eye(state.size)])
    rate = variational_rate(_chain(at, state.size // 2))
    found = run(rate, start.ravel(), period)
    return replace(found, value=found.value.reshape(start.shape))


def _precise_orbit(at: Mapping[str, float], given: Any) -> PreciseState:
    """Refine an orbit, (X, period) with y = 0 at the centre, by Newton's method with many digits.

    The matrix is in double precision: its errors, multiplied by those of the given orbit, are below
    the accuracy required of the first step. The uncertainty of the flow affects the orbit through
    the inverse of the matrix.
    """
    slope = np.zeros((given.size, given.size))
    slope[-1, _SITES // 2] = 1.0
    with mp.workdps(_DIGITS):
        x = np.array([mp.mpf(each) for each in given], dtype=object)
        flow = _flow(at, given[:-1], given[-1], partial(integrate, tolerance=_OF_MATRIX))
        slope[:-1, :-1] = flow.value[:, 1:] - np.eye(given.size - 1)
        rate = full_rate(_chain(at, _SITES))
        slope[:-1, -1] = rate(0.0, given[:-1])
        inverse = np.linalg.inv(slope)
        for tolerance in _TOLERANCES:
            end = integrate(rate, x[:-1], x[-1], tolerance).value
            residual = np.append(end - x[:-1], x[_SITES // 2])
            step = inverse @ residual
            x = x - step
    known = float(np.abs(inverse).sum(axis=1).max()) * float(np.abs(residual).max())
    return PreciseState(value=x, uncertainty=known)


def _multipliers(at: Mapping[str, float]) -> StatedValue:
    orbit = solve_orbit(_chain(at, _SITES), Nucleus(1))
    stated = StatedValue.of(orbit.stability, orbit.multipliers)
    return replace(stated, extra=orbit)


def _check_multipliers(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare with the eigenvalues, with many digits, of the monodromy of the refined orbit.

    Their uncertainty is their change when the monodromy is changed by its own uncertainty, with
    either sign.
    """
    if stated.value is None:
        raise NoReferenceError("no orbit to compare with.")
    orbit = stated.extra
    true = _precise_orbit(at, np.append(orbit.state, orbit.period)).value
    state = np.array([_as_long(x) for x in true[:-1]])
    flow = _flow(at, state, _as_long(true[-1]), precise_state)
    monodromy = flow.value[:, 1:]
    signs = np.where(np.indices(monodromy.shape).sum(axis=0) % 2, 1.0, -1.0)
    values, *beside = (
        _eigenvalues(monodromy + side * flow.uncertainty * signs) for side in (0.0, 1.0, -1.0)
    )
    return ReferenceCheck(
        distance=_farthest(stated.value, values),
        uncertainty=max(_farthest(each, values) for each in beside),
        method="eigenvalues in many digits of a monodromy in extended precision",
    )


def _eigenvalues(matrix: Any) -> Any:
    """Return the eigenvalues of a matrix of long doubles, by mpmath in thirty digits."""
    with mp.workdps(30):
        exact = mp.matrix([[_as_mpf(x) for x in row] for row in matrix])
        return np.array([complex(x) for x in mp.eig(exact, left=False, right=False)])


def _as_long(x: Any) -> np.longdouble:
    """Return an mpmath number in extended precision: a double plus the remainder."""
    return np.longdouble(float(x)) + np.longdouble(float(x - float(x)))


def _as_mpf(x: np.longdouble) -> Any:
    """Return the same number for mpmath: a double plus the remainder."""
    return mp.mpf(float(x)) + mp.mpf(float(x - np.longdouble(float(x))))


def _farthest(values: Any, others: Any) -> float:
    """Return the largest distance within pairs, matched so that the sum of squares is smallest."""
    apart = np.abs(np.subtract.outer(values, others))
    return float(apart[linear_sum_assignment(apart**2)].max())


def _threshold(at: Mapping[str, float]) -> StatedValue:
    found = breather_threshold(_chain({**at, "c": 0.1}, 15), Nucleus(1), ThresholdMethod.ENVELOPE)
    return StatedValue.of(found, found.c_crit)


def _check_threshold(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Solve for the fold of (34) on the same chain, with the residual in extended precision."""
    if stated.value is None:
        raise NoReferenceError("no fold to compare with.")
    found = solve_envelope_breather(
        _chain({**at, "c": stated.value * 0.999}, stated.extra.sites), Nucleus(1)
    )
    true = locked_fold(at["eta"], stated.value, found.waves, float(found.unknowns[-1]))
    return ReferenceCheck(
        distance=abs(float(true.value[-1] - stated.value)),
        uncertainty=true.uncertainty,
        method="fold by Newton in extended precision",
    )


QUANTITIES = (
    Quantity(
        name="closed-form", title="closed form of a breather, and its largest coupling",
        equation="(29), (37)", problems="breather", accuracy=1e-15, default="closed form",
        reference="Newton in 80 digits from a plain scan",
        computations=(
            Computation(
                name="closed-form-fold", title="the largest coupling of the closed form (29), (37)",
                axes=(A, ETA, READING), compute=_fold, check=_check_fold,
                seconds=0.1, share=0.4, problems="breather",
            ),
            Computation(
                name="closed-form-breather",
                title="amplitude and decay of the closed form (29), (37)",
                axes=(A, ETA, C, READING), compute=_breather, check=_check_breather,
                seconds=0.1, share=0.4, problems="breather",
            ),
        ),
    ),
    Quantity(
        name="breather", title="breather of the chain (8)", equation="(8), (34)",
        problems="breather", accuracy=1e-11, default="shooting", useful=(1e-8, 1e-3),
        reference="shooting over a flow in extended precision",
        computations=(
            Computation(
                name="envelope-breather", title="a breather of the averaged chain (34)",
                axes=(ETA, C), compute=_envelope, check=_check_envelope,
                seconds=5.0, share=0.15, problems="breather",
            ),
            Computation(
                name="orbit", title="a true periodic orbit of (8)",
                axes=(ETA, WEAK, EPSILON), compute=_orbit, check=_check_orbit,
                seconds=20.0, share=0.1, problems="breather",
            ),
        ),
    ),
    Quantity(
        name="multipliers", title="Floquet multipliers of a breather, Eqs. 39-42",
        equation="(39)-(42)", problems="multipliers", accuracy=1e-10, useful=(1e-10, 1e-3),
        reference="the variational equations (42) by scipy's DOP853 at 1e-13",
        default="Taylor series with variations",
        computations=(
            Computation(
                name="multipliers", title="Floquet multipliers of a true orbit",
                axes=(ETA, WEAK, EPSILON), compute=_multipliers, check=_check_multipliers,
                seconds=20.0, share=0.1, problems="breather",
            ),
        ),
    ),
    Quantity(
        name="threshold", title="coupling at which a breather ends", equation="(34)",
        problems="breather", accuracy=1e-6, default="continuation",
        reference="the equations of a fold by Newton's method in extended precision",
        computations=(
            Computation(
                name="envelope-threshold", title="the coupling at which a breather of (34) ends",
                axes=(ETA,), compute=_threshold, check=_check_threshold,
                seconds=20.0, share=0.1, problems="breather",
            ),
        ),
    ),
)  # fmt: skip
