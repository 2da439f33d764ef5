"""Each check of the robustness table knows a wrong value by how far it is off, to either side.

Where a reference takes long, it is given small problems, or results that are made up, so that only
what the check itself says of them is asked.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from tests.tables import table_of
from theory.averaged.breather import BreatherStatus, Reading
from theory.chains.chain import SmoothChain
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from theory.parameters import RunError
from verification.breathers.envelope import solve_envelope_breather
from verification.execution.table import Table
from verification.quantities import breathers, chains, friction, own_chains, robustness
from verification.quantities.judging import PointOutcome, compared
from verification.quantities.problems import PROBLEMS
from verification.quantities.quantity import Axis, ReferenceCheck, StatedValue, axes
from verification.quantities.registry import all_computations, chosen, computation_named
from verification.references.equations import full_rate
from verification.references.extrapolation import PreciseState, extended
from verification.references.friction_events import BEGINS
from verification.references.pace import NoReferenceError
from verification.runs.trajectory import RunStatus
from verification.thresholds.result import ThresholdMethod

# ---------------------------------------------------------------------------------------- breathers


def _fold_by_cubic(eta: float) -> tuple[float, float, float]:
    """Return S, w and c where c, as a function of S, is largest; a = 1.

    For given S, (29) and (37) without c are a cubic for w, and c follows. From the stable amplitude
    on, where c is zero, S falls and c rises.
    """
    root = math.sqrt(1.0 - 8.0 * eta)
    S = (1.0 + root) / eta - 2.0 * root / eta * np.geomspace(1e-6, 1.0, 3000)
    gain = (-eta * S**2 + 2.0 * S - 8.0) / 16.0
    w = np.full(S.size, np.nan)
    for i, (s, G) in enumerate(zip(S, gain, strict=True)):
        roots = np.roots([eta * s * s / 8.0, -s / 4.0, 1.0 + G, -G])
        w[i] = min(x.real for x in roots if abs(x.imag) < 1e-12 and x.real > 0)
    c = gain / np.sqrt(w)
    top = int(np.flatnonzero(np.diff(c) < 0)[0])
    return float(S[top]), float(w[top]), float(c[top])


@pytest.mark.parametrize("eta", [0.01, 0.05, 0.09, 0.1, 0.11, 0.12])
def test_the_scan_for_the_fold_of_the_closed_form_ends_beside_it(eta: float) -> None:
    """On either sheet of the quadratic, to the spacing of both scans, 0.7 and 0.5 percent."""
    S, w, c = _fold_by_cubic(eta)
    found = breathers._scan({"eta": eta})
    assert found is not None
    assert found == pytest.approx((S, w), rel=0.012)
    gain = (-eta * found[0] ** 2 + 2.0 * found[0] - 8.0) / 16.0
    assert gain / math.sqrt(found[1]) == pytest.approx(c, rel=2e-3)


@pytest.mark.parametrize("eta", [0.01, 0.08])
def test_the_fold_of_the_tail_is_stated_where_it_is_asked_for(eta: float) -> None:
    """c² = m(1 + m), m = (1 - 8η)/16η, and so above that of the nearest neighbours."""
    m = (1.0 - 8.0 * eta) / (16.0 * eta)
    near, tail = (
        breathers._fold({"a": 2.5, "eta": eta, "reading": reading}).value for reading in (1.0, 2.0)
    )
    assert tail == pytest.approx(math.sqrt(m * (1.0 + m)), rel=1e-14)
    assert abs(near - tail) > 0.1 * tail


@pytest.mark.parametrize("none", [False, True])
def test_a_breather_is_stated_with_its_unknowns_unless_there_is_none(
    none: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = SimpleNamespace(
        status=BreatherStatus.NONE if none else BreatherStatus.EXISTS, error=1e-9,
        unknowns=np.array([1.0, 2.0, 6.3]), waves=np.array([1.0, 2.0j]), alpha_0=1.5, decay=0.1,
    )  # fmt: skip

    def solved(chain: VdpChain, *_: object) -> SimpleNamespace:
        assert (chain.b, chain.c) == (0.08, 0.1)
        return made

    for name in ("solve_orbit", "solve_envelope_breather", "solve_breather"):
        monkeypatch.setattr(breathers, name, solved)
    at = {"a": 1.0, "eta": 0.08, "c": 0.1, "eps": 0.01, "reading": 1.0}
    for state, value in (
        (breathers._orbit, [1.0, 2.0, 6.3]), (breathers._envelope, [1.0, 2.0j, 6.3]),
        (breathers._breather, [1.5, 0.1]),
    ):  # fmt: skip
        stated = state(at)
        assert stated.extra is made
        if none:
            assert (stated.value, stated.error) == (None, 0.0)
        else:
            assert stated.value.tolist() == value
            assert stated.error == 1e-9


@pytest.mark.parametrize(
    ("share", "confirmed"),
    [(1.0, True), (1.0 - 1e-13, True), (1.5, True), (1.0 - 1e-11, False), (0.5, False)],
)
def test_where_newton_fails_a_breather_is_confirmed_at_the_fold_alone(
    share: float, confirmed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise ValueError

    monkeypatch.setattr(breathers, "_true_fold", lambda _: (mp.mpf(1), mp.mpf(0.2)))
    monkeypatch.setattr(mp, "findroot", fails)
    fold = SimpleNamespace(c=0.2, error=1e-9)
    stated = StatedValue(value=np.array([2.0, 0.1]), error=1e-12, extra=SimpleNamespace(fold=fold))
    at = {"a": 1.0, "eta": 0.08, "c": 0.2 * share, "reading": 1.0}
    if confirmed:
        assert breathers._check_breather(at, stated).distance == 0.0
    else:
        with pytest.raises(NoReferenceError, match="does not converge"):
            breathers._check_breather(at, stated)


def test_the_flow_of_an_orbit_has_its_state_first_and_then_its_derivatives() -> None:
    """After a short step, the equation itself and its differences."""
    at, state, h = {"eta": 0.08, "c": 0.1, "eps": 0.3}, np.array([0.4, 1.0, -0.3, 0.2]), 1e-3

    def step(rate: Any, start: np.ndarray, period: float) -> PreciseState:
        assert period == 6.5
        return PreciseState(value=start + h * rate(0.0, start), uncertainty=1e-9)

    found = breathers._flow(at, state, 6.5, step)
    rate = full_rate(VdpChain(a=1.0, b=0.08, c=0.1, eps=0.3, sites=2))
    assert found.uncertainty == 1e-9
    assert found.value[:, 0] == pytest.approx(state + h * rate(0.0, state), abs=1e-15)
    slope = [(rate(0.0, state + 1e-6 * e) - rate(0.0, state - 1e-6 * e)) / 2e-6 for e in np.eye(4)]
    assert found.value[:, 1:] == pytest.approx(np.eye(4) + h * np.array(slope).T, abs=1e-10)


def test_an_orbit_of_a_flow_that_is_known_is_polished_to_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A cycle ṙ = r(1 - r²)/8 of the middle site, which the others follow, else damped like 1/8."""
    follows = np.zeros(
        (6, 6)
    )  # of places and velocities of three sites, on those of the middle one
    follows[np.ix_([0, 3, 2, 5], [1, 4])] = [[0.5, 0.25], [-0.25, 0.5], [0.0, -0.75], [0.75, 0.0]]

    def flow(x: Any, t: Any) -> Any:
        """Return the state after a time, in closed form, of doubles or numbers of mpmath."""
        free = x - follows @ x  # its square is zero, so that this is undone below
        square = free[1] ** 2 + free[4] ** 2
        root = 1 / mp.sqrt(square + (1 - square) * mp.exp(-t / 4))
        growth = np.array([mp.exp(-t / 8), root, mp.exp(-t / 8)] * 2, dtype=object)
        turned = np.concatenate(
            [
                free[:3] * mp.cos(t) + free[3:] * mp.sin(t),
                free[3:] * mp.cos(t) - free[:3] * mp.sin(t),
            ]
        )
        return turned * growth + follows @ (turned * growth)

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        return np.array([float(each) for each in (flow(x, 1e-5) - flow(x, -1e-5)) / 2e-5])

    def by_differences(_: object, state: Any, t: Any, run: Any) -> PreciseState:
        assert callable(run)
        columns = [
            (flow(state + 1e-5 * e, t) - flow(state - 1e-5 * e, t)) / 2e-5 for e in np.eye(6)
        ]
        value = np.column_stack([flow(state, t), *columns]).astype(float)
        return PreciseState(value=value, uncertainty=0.0)

    def integrated(_: object, start: Any, end: Any, tolerance: float) -> PreciseState:
        return PreciseState(value=flow(start, end) + tolerance, uncertainty=0.0)

    monkeypatch.setattr(breathers, "_SITES", 3)
    monkeypatch.setattr(breathers, "full_rate", lambda _: rate)
    monkeypatch.setattr(breathers, "_flow", by_differences)
    monkeypatch.setattr(breathers, "integrate", integrated)
    start = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    true = [*(start + follows @ start), 2 * mp.pi]
    given = np.array(true, dtype=float) + 1e-7 * np.cos(np.arange(7.0))
    found = breathers._precise_orbit({"eta": 0.08, "c": 0.1, "eps": 0.01}, given)
    with mp.workdps(30):
        true[-1] = 2 * mp.pi
        off = max(abs(x - y) for x, y in zip(found.value, true, strict=True))
    assert off <= found.uncertainty
    assert 0.0 < found.uncertainty < 1e-13


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_orbit_is_as_far_off_as_its_worst_number(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = np.array([0.5, 0.0, 6.3])
    monkeypatch.setattr(
        breathers, "_precise_orbit",
        lambda _, x: PreciseState(value=x - side * np.array([1e-3, 0.0, 1e-4]), uncertainty=1e-9),
    )  # fmt: skip
    check = breathers._check_orbit({}, StatedValue(value=given, error=0.0))
    assert (check.distance, check.uncertainty) == (pytest.approx(1e-3), 1e-9)
    monkeypatch.setattr(
        breathers, "locked_state",
        lambda _, __, phi, omega: PreciseState(
            value=np.array([*phi.real, *phi.imag, omega]) - side * np.array([0, 0, 0, 1e-3, 1e-4]),
            uncertainty=1e-9,
        ),
    )  # fmt: skip
    waves = StatedValue(value=np.array([1.0, 2.0j, 6.3]), error=0.0)
    check = breathers._check_envelope({"eta": 0.08, "c": 0.1}, waves)
    assert (check.distance, check.uncertainty) == (pytest.approx(1e-3), 1e-9)


def test_the_phase_of_a_refined_orbit_is_that_of_its_middle_site(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A made-up flow returns every state; the period alone moves y of the middle site to zero."""
    slopes = np.arange(1.0, 11.0)
    monkeypatch.setattr(breathers, "_SITES", 5)
    monkeypatch.setattr(breathers, "full_rate", lambda _: lambda _, __: slopes)
    monkeypatch.setattr(
        breathers, "integrate", lambda _, x, *__: PreciseState(value=x, uncertainty=0.0)
    )
    flow = np.column_stack([np.zeros(10), 1.5 * np.eye(10)])
    monkeypatch.setattr(breathers, "_flow", lambda *_: PreciseState(value=flow, uncertainty=0.0))
    found = breathers._precise_orbit({"eta": 0.08, "c": 0.1, "eps": 0.01}, np.arange(2.0, 13.0))
    assert abs(found.value[2]) < 1e-20
    moved = np.arange(2.0, 13.0) - found.value.astype(float)
    assert moved == pytest.approx([*(4.0 / 3.0 * slopes), -4.0 / 6.0], rel=1e-12)


def test_long_doubles_and_numbers_of_mpmath_are_the_same_to_all_their_digits() -> None:
    third = np.longdouble(1) / 3
    with mp.workdps(30):
        assert abs(3 * breathers._as_mpf(third) - 1) < 3e-19
        assert breathers._as_long(mp.mpf(1) / 3) == third


def _envelope_none(c: float) -> ReferenceCheck:
    return computation_named("envelope-breather").check(
        {"eta": 0.08, "c": c}, StatedValue(value=None, error=0.0)
    )


def test_a_breather_that_is_denied_is_missed_below_its_fold_only() -> None:
    """The fold of the closed form is at 0.19733, that of the averaged chain at 0.19079."""
    for c, right in ((0.15, False), (0.186, False), (0.191, True), (0.4, True)):
        assert _envelope_none(c).distance == (0.0 if right else math.inf)
    row = computation_named("closed-form-breather")
    for c, right in ((0.19, False), (0.21, True), (5.0, True)):
        at = {"a": 2.5, "eta": 0.08, "c": c, "reading": 1.0}
        stated = row.compute(at)
        assert (stated.value is None) is right
        denied = row.check(at, replace(stated, value=None))
        assert (denied.distance == 0.0) is right


@pytest.mark.parametrize(("reading", "c"), [(1.0, 0.19), (1.0, 0.1), (2.0, 0.5), (2.0, 0.1)])
def test_a_breather_of_the_branch_beyond_the_fold_is_refuted(reading: float, c: float) -> None:
    """Of the same coupling, a solution of the same equations, but with a smaller amplitude."""
    row, a, b = computation_named("closed-form-breather"), 2.5, 0.5
    at = {"a": a, "eta": 0.08, "c": c, "reading": reading}
    stated = row.compute(at)
    assert compared(stated.error, row.check(at, stated)) is PointOutcome.RIGHT

    def decay(S: float) -> float:
        """Return w of (37) for given S, a cubic; with the reading of the tail it is linear."""
        gain = (-b * S**2 + 2.0 * a * S - 8.0) / 16.0
        if reading == 2.0:
            return gain / (1.0 + gain)
        roots = np.roots([b * S * S / 8.0, -a * S / 4.0, 1.0 + gain, -gain])
        return float(min(x.real for x in roots if abs(x.imag) < 1e-9))

    def excess(S: float) -> float:
        return float((-b * S**2 + 2.0 * a * S - 8.0) / 16.0 / math.sqrt(decay(S)) - c)

    # Down from where c is largest, which is below the breather itself, to where the gain ends.
    S = np.linspace(stated.value[0] ** 2 - 1e-3, 5.0 - 3.0 + 1e-3, 400)
    falls = [i for i in range(S.size - 1) if excess(S[i]) > 0.0 >= excess(S[i + 1])]
    other = brentq(excess, S[falls[0]], S[falls[0] + 1], xtol=1e-14)
    wrong = replace(stated, value=np.sqrt([other, decay(other)]))
    assert compared(stated.error, row.check(at, wrong)) is PointOutcome.EXCEEDED


@pytest.mark.parametrize("reading", [1.0, 2.0])
def test_a_fold_of_the_closed_form_is_as_far_off_as_it_is(reading: float) -> None:
    row = computation_named("closed-form-fold")
    for a, eta in ((2.5, 0.08), (1e-3, 0.11), (40.0, 0.01), (1e-3, 1e-12), (1.0, 0.125 - 1e-13)):
        at = {"a": a, "eta": eta, "reading": reading}
        stated = row.compute(at)
        for off in (0.0, 1e-9, -1e-9):
            check = row.check(at, replace(stated, value=stated.value * (1.0 + off)))
            assert check.distance == pytest.approx(
                abs(off) * stated.value, rel=1e-3, abs=2.0 * stated.error
            )


@pytest.mark.parametrize("eta", [1e-12, 1e-9, 1e-6])
def test_the_fold_of_the_closed_form_tends_to_that_of_a_cubic_for_small_eta(eta: float) -> None:
    """With w = ηu and S = (2 - …)/η (29) and (37) tend to c = √η (√u - u^{3/2}/2): u = 2/3."""
    S, w = breathers._scan({"eta": eta})
    assert (eta * S, w / eta) == pytest.approx((2.0, 2.0 / 3.0), rel=0.012)


@pytest.mark.parametrize("gap", [2.0**-52, 1e-9, 1e-6])
def test_the_fold_of_the_closed_form_is_at_the_largest_gain_where_the_cycles_meet(
    gap: float,
) -> None:
    """With 8η = 1 - g the gain is g/2 at most, at S = 8; w tends to it, and c to its root."""
    S, w = breathers._scan({"eta": 0.125 * (1.0 - gap)})
    assert (S, w / gap) == pytest.approx((8.0, 0.5), rel=0.012)


def test_a_breather_may_be_missing_below_a_fold_by_as_much_as_that_is_off(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fold = SimpleNamespace(c=0.2, error=1e-9)
    made = ReferenceCheck(distance=0.01, method="made up")
    monkeypatch.setattr(breathers, "_check_fold", lambda *_: made)
    none = StatedValue(value=None, error=0.0, extra=SimpleNamespace(fold=fold))
    for c, held in ((0.18, False), (0.195, True), (0.25, True)):
        check = breathers._check_breather({"a": 1.0, "eta": 0.08, "c": c, "reading": 1.0}, none)
        assert (check.distance == 0.0) is held


@pytest.mark.parametrize(("above", "held"), [(0.0, True), (1e-6, True), (1e-5, False)])
def test_a_breather_may_lie_below_the_fold_by_about_its_error(
    above: float, held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the two meet, S of the fold is known no better than S of the breather."""
    row = computation_named("closed-form-breather")
    at = {"a": 2.5, "eta": 0.08, "c": 0.1, "reading": 1.0}
    stated = row.compute(at)
    fold = mp.mpf(float(stated.value[0]) ** 2 * (1.0 + above))
    monkeypatch.setattr(breathers, "_true_fold", lambda _: (fold, mp.mpf(0.2)))
    check = row.check(at, replace(stated, error=1e-6))
    assert (check.distance < 1e-12) is held


def test_a_fold_of_the_averaged_chain_is_as_far_off_as_it_is() -> None:
    chain = VdpChain(a=1.0, b=0.08, c=1.0, eps=0.01, sites=3)
    fold = solve_envelope_breather(chain, Nucleus(1)).fold
    assert fold is not None
    for off in (0.0, 1e-6, -1e-6):
        stated = StatedValue(value=fold * (1.0 + off), error=1e-9, extra=SimpleNamespace(sites=3))
        check = breathers._check_threshold({"eta": 0.08}, stated)
        assert check.uncertainty < 1e-12
        assert check.distance == pytest.approx(abs(off) * fold, rel=1e-3, abs=1e-10)


@pytest.mark.parametrize("c", [0.2, None])
def test_a_threshold_is_the_fold_of_the_averaged_chain_that_is_asked_for(
    c: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def threshold(*given: Any) -> SimpleNamespace:
        asked.append(given)
        return SimpleNamespace(c_crit=c, error=1e-9)

    monkeypatch.setattr(breathers, "breather_threshold", threshold)
    stated = breathers._threshold({"eta": 0.08})
    ((chain, nucleus, method),) = asked
    assert (chain.a, chain.b) == (1.0, 0.08)
    assert (nucleus, method) == (Nucleus(1), ThresholdMethod.ENVELOPE)
    assert (stated.value, stated.error) == (c, 0.0 if c is None else 1e-9)


@pytest.mark.parametrize(
    ("matrix", "changed"),
    [
        # by roundings of u to either side: u where values stand alone, √u where two meet
        (np.diag([1.0, 0.5, -0.2, 0.1]), 1e-8),
        (np.diag([1.0, 1.0, 0.5, 0.1]) + np.diag([1.0, 0.0, 0.0], 1), 1e-4),
        # and by more to one side, where two values 1 ± √u meet, than to the other: 1 ± √(2u)
        (np.diag([1.0 + 1e-4, 1.0 - 1e-4, 0.5, 0.1]) + np.diag([1.0, 0.0, 0.0], 1), 1e-4),
    ],
)
def test_multipliers_are_as_uncertain_as_their_matrix_makes_them(
    matrix: np.ndarray, changed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    orbit = SimpleNamespace(state=np.array([0.1, 0.2, 0.3, 0.4]), period=6.5)
    polished = np.array([mp.mpf(x) for x in (0.5, 0.6, 0.7, 0.8, 6.25)], dtype=object)
    asked: list[Any] = []

    def precise(_: object, given: np.ndarray) -> PreciseState:
        asked.append(given.tolist())
        return PreciseState(value=polished, uncertainty=0.0)

    def flow(_: object, state: Any, period: Any, __: object) -> PreciseState:
        asked.append([*map(float, state), float(period)])
        value = extended(np.column_stack([state, matrix]))
        return PreciseState(value=value, uncertainty=1e-8)

    monkeypatch.setattr(breathers, "_precise_orbit", precise)
    monkeypatch.setattr(breathers, "_flow", flow)
    values = np.diag(matrix).astype(complex)
    for off in (0.0, 1e-3):
        stated = StatedValue(value=values + off * np.eye(4)[2], error=0.0, extra=orbit)
        check = breathers._check_multipliers({}, stated)
        assert check.distance == pytest.approx(off, abs=1e-12)
        assert check.uncertainty == pytest.approx(changed, rel=0.1)
    assert asked[:2] == [[0.1, 0.2, 0.3, 0.4, 6.5], [0.5, 0.6, 0.7, 0.8, 6.25]]


# ------------------------------------------------------------------------------ chains of any kind


class _Drifting:
    """Sites that swing and are pushed by the left neighbour alone: linear, so that e^{At} is known.

    What `SmoothChain` has, of one's own; left and right are no mirror images here.
    """

    sites, kernel_rate = 3, 1.0

    def __init__(self, **_: object) -> None: ...

    def kernel(self) -> Any:
        return lambda site, left, right, p: (
            site[1], -site[0] + p[0] * left[0] - p[1] * (site[1] - right[1])
        )  # fmt: skip

    def kernel_parameters(self) -> tuple[float, float]:
        return (0.3, 0.1)

    def exactly(self, start: np.ndarray, t: float) -> np.ndarray:
        push, drag, one = np.zeros((3, 3)), -0.1 * np.eye(3), np.eye(3)
        for n in range(3):
            push[n, max(n - 1, 0)] += 0.3
            drag[n, min(n + 1, 2)] += 0.1
        whole = np.block([[0.0 * one, one], [push - one, drag]])
        found: np.ndarray = (expm(whole * t) @ start.ravel()).reshape(2, 3)
        return found


@pytest.mark.parametrize("rate", [1.0, 2.0])
def test_a_run_of_any_chain_is_held_against_the_right_side_that_it_gives(
    rate: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which is per unit of the time of its kernel."""
    monkeypatch.setattr(_Drifting, "kernel_rate", rate)
    kind: type[SmoothChain] = _Drifting  # type: ignore[assignment]
    start = np.array([[1.0, 0.0, 0.5], [0.0, -0.25, 0.0]])
    true = _Drifting().exactly(start, chains._END * rate)
    for off in (0.0, 1e-6, -1e-6):
        value = true + off * np.eye(3)[:2]
        stated = StatedValue(value=value, error=1e-8, extra=start)
        check = chains._check_run(kind, [], {"sites": 3.0}, stated)
        assert check.uncertainty < 1e-8
        assert check.distance == pytest.approx(abs(off), abs=1e-9)


def test_a_smooth_chain_that_is_registered_has_a_row_and_another_chain_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With a range for each of its parameters; a model of the table has its own row."""
    known = {"vdp": VdpChain, "another": VdpChain, "friction": FrictionChain}
    monkeypatch.setattr(chains, "CHAINS", known)
    (row,) = chains.computations_of_chains()
    assert row.name == "run-vdp"
    assert {axis.name: axis.whole for axis in row.axes} == {
        "a": False, "b": False, "c": False, "eps": False, "sites": True, "tolerance": False,
    }  # fmt: skip
    assert row.limits
    at = {"a": 4.0, "b": 0.5, "c": 0.6, "eps": 0.1, "sites": 3.0, "tolerance": 1e-6}
    made: list[Any] = []

    def run(chain: Any, start: np.ndarray, _: float, **given: Any) -> SimpleNamespace:
        made.append((chain, given["tolerance"]))
        return SimpleNamespace(error=1e-9, states=np.stack([0.0 * start, start]))

    monkeypatch.setattr(chains, "simulate", run)
    monkeypatch.setattr(chains, "last_state", lambda _, __, start, **___: start)
    stated = row.compute(at)
    assert made == [(VdpChain(a=4.0, b=0.5, c=0.6, eps=0.1, sites=3), 1e-6)]
    assert stated.error == 1e-9
    assert row.check(at, stated).distance == 0.0


def test_both_readings_of_the_closed_form_are_in_its_range() -> None:
    ends = {
        breathers._reading({"reading": x}) for x in (breathers.READING.low, breathers.READING.high)
    }
    assert ends == {Reading.NEIGHBOUR, Reading.TAIL}


def test_multipliers_are_stated_as_the_value_with_the_error_of_their_stability(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    orbit = SimpleNamespace(
        stability=SimpleNamespace(error=1e-9), multipliers=np.array([1.0, 0.5 + 0.1j])
    )
    monkeypatch.setattr(breathers, "solve_orbit", lambda *_: orbit)
    stated = breathers._multipliers({"eta": 0.03, "c": 0.1, "eps": 0.01})
    assert stated.value is orbit.multipliers
    assert (stated.error, stated.extra) == (1e-9, orbit)


def test_newton_in_many_digits_begins_at_the_stated_breather(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    find = mp.findroot

    def noted(f: Any, start: Any, **given: Any) -> Any:
        asked.append(start)
        return find(f, start, **given)

    at = {"a": 1.0, "eta": 0.05, "c": 0.05, "reading": 1.0}
    monkeypatch.setattr(mp, "findroot", noted)
    assert breathers._check_breather(at, breathers._breather(at)).distance < 1e-14
    assert asked[-1] == (1, 1)  # the factors of both stated numbers


@pytest.mark.parametrize("left", ["1e-3", "-1e-3"])
def test_the_uncertainty_of_a_refined_orbit_counts_errors_of_either_sign(
    left: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Made up: so much is left of every entry, and two of them weigh alike with opposite signs."""
    inverse = np.zeros((19, 19))
    inverse[3, :2] = 1.0, -1.0
    monkeypatch.setattr(breathers, "_flow", lambda *_: SimpleNamespace(value=np.zeros((18, 19))))
    monkeypatch.setattr(
        breathers, "integrate", lambda _, x, *__: SimpleNamespace(value=x + mp.mpf(left))
    )
    monkeypatch.setattr(np.linalg, "inv", lambda _: inverse)
    given = np.append(np.zeros(18), 6.3)
    found = breathers._precise_orbit({"eta": 0.03, "c": 0.1, "eps": 0.01}, given)
    assert found.uncertainty == pytest.approx(2e-3, rel=1e-12)


OWN = {
    "k": 0.1, "far": 0.2, "d": 0.3, "spread": 0.1, "c": 2.0, "eps": 0.05, "sites": 6.0,
    "displacement": 2.0, "tolerance": 1e-9, "force": 0.3,
}  # fmt: skip


@pytest.mark.parametrize("change", [{}, {"k": 0.0, "spread": 0.0, "sites": 4.0, "force": None}])
def test_a_run_of_ones_own_chain_is_that_of_the_equation_written_again(
    change: Mapping[str, float | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Disordered, driven, with springs to second neighbours; and without all of it."""
    integrate, known = own_chains.precise_state, []

    def once(*asked: Any) -> PreciseState:
        known.append(known[0] if known else integrate(*asked))
        return known[0]

    monkeypatch.setattr(own_chains, "precise_state", once)  # of the same chain three times
    monkeypatch.setattr(own_chains, "_END", 2.0)
    at = {name: value for name, value in (OWN | change).items() if value is not None}
    stated = own_chains.own_run(at)
    assert np.abs(stated.extra).max() == pytest.approx(at["displacement"])
    check = own_chains.own_precisely(at, stated)
    assert compared(stated.error, check) is PointOutcome.RIGHT, check
    for off in (1e-3, -1e-3):
        wrong = stated.value.copy()
        wrong[0, -1] += off
        check = own_chains.own_precisely(at, replace(stated, value=wrong))
        assert check.distance == pytest.approx(1e-3, abs=2.0 * stated.error)
    assert len(known) == 3


def test_a_run_of_ones_own_chain_is_as_far_off_as_its_worst_number(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def precise(rate: Any, start: np.ndarray, end: float) -> PreciseState:
        asked.append((rate(0.0, start).shape, start.tolist(), end))
        return PreciseState(value=np.arange(10.0), uncertainty=1e-9)

    monkeypatch.setattr(own_chains, "precise_state", precise)
    at = {"k": 0.1, "far": 0.2, "d": 0.3, "spread": 0.1, "c": 2.0, "eps": 0.05, "sites": 5.0}
    value = np.arange(10.0).reshape(2, 5)
    for off in (1e-3, -1e-3):
        stated = StatedValue(value=value + off * np.eye(5)[:2], error=0.0, extra=np.ones((2, 5)))
        check = own_chains.own_precisely(at, stated)
        assert (check.distance, check.uncertainty) == (pytest.approx(1e-3), 1e-9)
    assert asked == [((10,), [1.0] * 10, own_chains._END)] * 2


def test_springs_do_not_act_on_equal_places_in_extended_precision_either() -> None:
    """The sum of a row is zero to the last bit, also of 2 + 2·0.3 in long doubles."""
    state = np.concatenate([np.full(6, np.longdouble(1.0)), np.zeros(6, dtype=np.longdouble)])
    at = OWN | {"far": 0.3, "spread": 0.0, "d": 0.0}
    weak, strong = (own_chains.rate_of(at | {"c": c})(0.0, state) for c in (0.0, 1e6))
    assert np.abs(strong - weak).max() < 1e-12


def test_of_a_lattice_each_place_is_pulled_by_its_four_neighbours() -> None:
    """Of three rows and four columns, written place by place; ends are free."""
    at = OWN | {"k": 0.0, "far": 0.0, "d": 0.0, "spread": 0.0, "force": 0.0, "sites": 12.0}
    y = np.random.default_rng(3).normal(size=(3, 4))
    state = np.concatenate([y.ravel(), np.zeros(12)])
    pulls = np.zeros((3, 4))
    for i, j in np.ndindex(3, 4):
        for other in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
            if 0 <= other[0] < 3 and 0 <= other[1] < 4:
                pulls[i, j] += y[i, j] - y[other]
    found = own_chains.rate_of(at | {"rows": 3.0})(0.0, state)[12:]
    assert found == pytest.approx((-y - at["eps"] * at["c"] * pulls).ravel(), abs=1e-14)


# ----------------------------------------------------------------------------------------- friction


BELT = {
    "c": 0.05, "v_d": 1.25, "v0": 0.5, "xi": 0.05, "mu_st": 1.0, "sites": 3.0, "displacement": 2.0,
    "band": 1e-3, "step": 2e-3,
}  # fmt: skip


@pytest.mark.parametrize("off", [(0.0, 1e-4), (0.0, -1e-4), (1e-4, 0.0), (-1e-4, 0.0)])
def test_a_cycle_is_off_by_its_period_or_its_stick_time_whichever_is_more(
    off: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two runs the tighter is the reference, and uncertain by how far the other is from it."""
    runs = {friction._TIGHT: (6.25, 0.5), friction._LOOSE: (6.25, 0.5 + 1e-6)}

    def events(*given: Any) -> SimpleNamespace:
        return SimpleNamespace(last_cycle=runs[given[-1]])

    monkeypatch.setattr(friction, "_events", events)
    stated = StatedValue(value=np.array([6.25, 0.5]) + off, error=1e-9)
    check = friction.cycle_by_scipy(BELT, stated)
    assert check.distance == pytest.approx(1e-4, rel=1e-9)
    assert check.uncertainty == pytest.approx(1e-6, rel=1e-6)
    for accuracy in (friction._LOOSE, friction._TIGHT):
        with monkeypatch.context() as without:
            without.setitem(runs, accuracy, None)
            assert friction.cycle_by_scipy(BELT, stated).distance == math.inf


def test_a_cell_without_a_cycle_has_neither_period_nor_stick_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("verification.quantities.friction.stick_slip_cycle", lambda _: None)
    stated = friction.stable_cycle(BELT)
    assert (stated.value.tolist(), stated.error, stated.note) == ([0.0, 0.0], 0.0, "no cycle")


@pytest.mark.parametrize("sticks", [0, 1, 2])
def test_a_cycle_that_is_denied_must_not_stick_again(
    sticks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = SimpleNamespace(when=lambda kind: np.arange(float(sticks)) if kind == BEGINS else None)
    asked: list[Any] = []

    def events(chain: Any, start: np.ndarray, *given: Any) -> SimpleNamespace:
        """Of a start on the belt, shortly before release."""
        assert 0.0 < chain.cell.release - start[0, 0] <= chain.cell.mu_st
        assert start.shape == (2, chain.sites)
        asked.append(given)
        return run

    monkeypatch.setattr(friction, "_events", events)
    stated = StatedValue(value=np.zeros(2), error=0.0)
    friction.cycle_by_scipy({**BELT, "v_d": 1e4}, stated)
    asked.clear()
    for v_d in (1.25, 1e-8):
        check = friction.cycle_by_scipy({**BELT, "v_d": v_d}, stated)
        assert check.distance == (math.inf if sticks else 0.0)
    tight = friction._TIGHT[0], friction._ROUGH[1]
    ends = [0.1 * friction._SLIP] if sticks else [0.1 * friction._SLIP, friction._SLIP]
    # On a slow belt slip is as small.
    assert asked == [(end, each) for each in (friction._ROUGH, tight) for end in ends]


def test_the_energy_of_the_switch_model_is_that_at_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """2E = y² + v² + c·(differences of neighbours)²; it has no error of its own."""
    y, velocity = (np.array([[9.0, 9.0, 9.0], last]) for last in ([1.0, 2.0, 2.0], [0.0, 3.0, 1.0]))
    run = SimpleNamespace(y=y, velocity=velocity)

    def switched(chain: FrictionChain, start: np.ndarray, end: float, **_: object) -> Any:
        assert (chain.c, start.shape, end) == (BELT["c"], (2, 3), friction._SHORT)
        return run

    monkeypatch.setattr(friction, "run_switch", switched)
    stated = friction.switch_energy(BELT)
    assert stated.value == pytest.approx(math.sqrt(9.0 + 10.0 + BELT["c"]), rel=1e-12)
    assert stated.error == 0.0


def test_one_wrong_site_of_a_friction_chain_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(friction, "_TAU", 4.0)
    stated = friction.friction_state(BELT)
    check = friction.friction_by_scipy(BELT, stated)
    assert compared(stated.error, check) is PointOutcome.RIGHT, check
    for off in (1e-3, -1e-3):
        wrong = replace(stated, value=stated.value + off * np.eye(3)[1])
        assert friction.friction_by_scipy(BELT, wrong).distance == pytest.approx(1e-3, rel=1e-3)


def test_of_a_long_friction_chain_only_the_sites_that_move_are_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The others slide steadily, and are known."""
    monkeypatch.setattr(friction, "_TAU", 3.0)
    at = BELT | {"c": 1e-5, "sites": 500.0}
    stated = friction.friction_state(at)
    check = friction.friction_by_scipy(at, stated)
    assert compared(stated.error, check) is PointOutcome.RIGHT, check
    far = replace(stated, value=stated.value + 1e-3 * (np.arange(500) == 400))
    assert friction.friction_by_scipy(at, far).distance == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_sites_of_a_friction_chain_move_to_either_side_of_rest(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first ten of them; the reference begins with six."""
    at = BELT | {"sites": 40.0}
    rest = friction.friction_chain(at).cell.steady_sliding
    true = rest + side * 1e-3 * (np.arange(40) < 10)
    followed: list[int] = []
    starts: list[np.ndarray] = []

    def events(chain: Any, start: Any, _: float, accuracy: Any = friction._TIGHT) -> Any:
        followed.append(chain.sites)
        starts.append(start)
        looser = 1e-5 * (np.arange(chain.sites) == 2) * (accuracy == friction._LOOSE)
        return SimpleNamespace(y=[true[: chain.sites] + side * looser])

    monkeypatch.setattr(friction, "_events", events)
    start = np.array([np.full(40, 2.0), np.zeros(40)])
    check = friction.friction_by_scipy(at, StatedValue(value=true, error=1e-9, extra=start))
    assert (check.distance, check.uncertainty) == (0.0, pytest.approx(1e-5))
    assert max(followed) == 12
    assert 0.0 < np.abs(starts[-1][0] / 2.0 - 1.0).max() < 1e-14  # as rounding may be


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_rounding_decides_where_it_changes_a_thousandth_of_the_motion(
    size: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    share = 0.0

    def events(chain: Any, _: Any, __: float, accuracy: Any = friction._TIGHT) -> Any:
        moved = share * (accuracy == friction._LOOSE)
        return SimpleNamespace(y=[np.full(chain.sites, size * (1.0 + moved))])

    monkeypatch.setattr(friction, "_events", events)
    stated = StatedValue(value=np.full(3, size), error=0.0, extra=np.full((2, 3), size))
    share = 0.9e-3
    assert friction.friction_by_scipy(BELT, stated).uncertainty == pytest.approx(share * size)
    share = 1.1e-3
    with pytest.raises(NoReferenceError, match="rounding of the start"):
        friction.friction_by_scipy(BELT, stated)


def test_a_friction_run_states_its_own_error_and_none_where_rounding_decides(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = SimpleNamespace(
        status=RunStatus.RESOLVED, error=1e-5, y=np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]])
    )
    monkeypatch.setattr("verification.quantities.friction.simulate", lambda *_, **__: made)
    stated = friction.friction_state(BELT)
    assert (stated.value.tolist(), stated.error) == ([1.0, 2.0, 3.0], 1e-5)
    for status in set(RunStatus) - {RunStatus.RESOLVED}:
        made.status = status
        with pytest.raises(RunError, match="rounding decides"):
            friction.friction_state(BELT)


def test_the_switch_model_has_the_energy_of_the_run_with_events(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """To the order of its step and band."""
    monkeypatch.setattr(friction, "_SHORT", 4.0)
    stated = friction.switch_energy(BELT)
    chain = friction.friction_chain(BELT)
    end = friction._events(chain, stated.extra, 4.0)
    y, velocity = end.y[-1], end.velocity[-1]
    stretched = sum((y[n + 1] - y[n]) ** 2 for n in range(2))
    true = math.sqrt(float(y @ y + velocity @ velocity) + BELT["c"] * stretched)
    assert stated.value == pytest.approx(true, rel=1e-2)
    assert abs(friction._root_energy(chain.c, *stated.extra) - true) > 0.1 * true
    assert stated.error == 0.0
    assert friction.within_the_work_of_friction(BELT, stated).distance == 0.0


def test_friction_can_add_its_work_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a start with √(2E) = 5, four sites and μ_st = 2 over three units of τ: 2·2·2·3 more."""
    monkeypatch.setattr(friction, "_SHORT", 3.0)
    start = np.array([[3.0, 3.0, 3.0, 3.0], [0.0, 0.0, 0.0, 0.0]])
    start[0] /= 2.0
    start[1, 0] = 4.0
    at = BELT | {"mu_st": 2.0, "sites": 4.0}
    for value, held in ((28.999, True), (29.0, True), (29.001, False), (0.0, True)):
        stated = StatedValue(value=value, error=0.0, extra=start)
        check = friction.within_the_work_of_friction(at, stated)
        assert (check.distance == 0.0) is held


# ------------------------------------------------------------------------ points and their table


def test_whole_parameters_are_drawn_whole_and_special_ones_approached_from_both_sides() -> None:
    rng = np.random.default_rng(5)
    sites = Axis(name="sites", low=2.0, high=40.0, whole=True)
    drawn = {sites.draw(rng) for _ in range(300)}
    assert all(value == int(value) for value in drawn)
    assert {2.0, 3.0, 40.0} <= drawn
    assert sites.middle() == 9.0  # √80
    assert Axis(name="c", low=2.0, high=40.0).middle() == pytest.approx(math.sqrt(80.0))
    for ends, whole in (((2, 40), True), ((2, 40.0), False), ((2.0, 40), False)):
        assert axes(sites=ends)[0].whole is whole
    near = Axis(name="eta", low=0.01, high=0.2, near=(0.125, 0.08), closest=1e-3)
    low, high, *beside = near.ends()
    assert (low, high) == (0.01, 0.2)
    assert sorted(beside) == pytest.approx([0.07992, 0.08008, 0.124875, 0.125125], rel=1e-12)


def test_a_bad_value_is_none_of_the_range() -> None:
    axis, rng = Axis(name="c", low=0.5, high=40.0), np.random.default_rng(7)
    drawn = [axis.bad(rng) for _ in range(200)]
    assert not [value for value in drawn if 0.5 <= value <= 40.0]
    assert {0.0, math.inf} <= set(drawn)
    assert min(drawn) < 0.0
    assert any(math.isnan(value) for value in drawn)
    assert any(40.0 < value < math.inf for value in drawn)
    assert any(0.0 < value < 0.5 for value in drawn)


def test_one_point_in_four_approaches_a_special_value_by_decades_on_either_side() -> None:
    axis = Axis(name="eta", low=10.0, high=20.0, near=(0.5,), closest=1e-3)
    rng = np.random.default_rng(6)
    drawn = np.array([axis.draw(rng) for _ in range(800)])
    away = drawn[drawn < 1.0] / 0.5 - 1.0
    assert np.all((drawn < 1.0) | ((drawn >= 10.0) & (drawn <= 20.0)))
    assert away.size == pytest.approx(200, abs=50)
    assert np.all((np.abs(away) > 0.999e-3) & (np.abs(away) < 0.1001))
    for side in (away[away > 0.0], -away[away < 0.0]):
        assert side.size == pytest.approx(100, abs=40)
        assert np.count_nonzero(side < 1e-2) == pytest.approx(0.5 * side.size, abs=25)


def test_corners_are_all_combinations_of_ends_and_of_many_some_from_first_to_last() -> None:
    def corners(*axes: Axis) -> list[Any]:
        made = replace(computation_named("c-pin"), axes=axes, problems="")
        return [tuple(point.values()) for point in made.fixed_points]

    c, v = Axis(name="c", low=1.0, high=2.0), Axis(name="v", low=3.0, high=5.0, near=(4.0,))
    ends = v.ends()
    assert corners(c, v) == [(x, y) for x in (1.0, 2.0) for y in ends]
    many = [Axis(name=f"x{i}", low=1.0, high=2.0) for i in range(8)]
    found = corners(*many)
    assert len(found) == len(set(found)) == 64
    assert (found[0], found[-1]) == ((1.0,) * 8, (2.0,) * 8)


def test_what_is_not_there_has_no_error() -> None:
    found = SimpleNamespace(error=1e-3)
    assert StatedValue.of(found, 0.5).error == 1e-3
    assert StatedValue.of(SimpleNamespace(error=None), None).error == 0.0


def test_all_computations_are_chosen_where_none_is_named() -> None:
    assert chosen(()) == all_computations()
    assert [each.name for each in chosen(("c-pin", "eta-pin"))] == ["c-pin", "eta-pin"]


def test_a_quantity_has_no_more_points_than_are_asked_for() -> None:
    """Twelve at least, where there are as many; of several quantities each by its share."""
    for points in (1, 5, 12, 40):
        assert len(robustness.points_of(["c-pin"], points)) == points
    several = robustness.points_of(["c-pin", "eta-pin"], 10)
    assert [point["quantity"] for point in several].count("c-pin") == 10


def test_the_tightest_of_what_is_right_is_the_largest_share_of_what_was_allowed() -> None:
    rows = [
        ("c-pin", "right", 1.0, 0.5, 0.3), ("c-pin", "right", 1.0, 1.0, 1.5),
        ("c-pin", "right", 0.0, 0.0, 0.0), ("c-pin", "exceeded", 1.0, 0.0, 9.0),
        ("eta-pin", "right", 1.0, 0.0, 0.9), ("c-pin", "refused", math.nan, math.nan, math.nan),
    ]  # fmt: skip
    table: Table = table_of([
        {"quantity": name, "number": number, "outcome": outcome, "stated": stated,
         "uncertainty": uncertainty, "distance": distance, "seconds": float(number)}
        for number, (name, outcome, stated, uncertainty, distance) in enumerate(rows)
    ])  # fmt: skip
    line = robustness._line(computation_named("c-pin"), table)
    assert line.tightest == 0.75
    assert (line.points, line.random, line.slowest) == (5, 3, 5.0)
    assert (line.counts["right"], line.counts["exceeded"], line.counts["refused"]) == (3, 1, 1)
    none = robustness._line(computation_named("c-retreat"), table)
    assert (none.tightest, none.points, none.slowest) == (0.0, 0, 0.0)


def test_a_test_problem_is_a_chain_of_its_own_length_or_of_another() -> None:
    problem = PROBLEMS["chain"][0]
    assert problem.vdp_chain() == VdpChain(a=4.0, b=0.5, c=0.6, eps=0.01, sites=31)
    assert problem.vdp_chain(5) == VdpChain(a=4.0, b=0.5, c=0.6, eps=0.01, sites=5)
    for eps, of_chain in ((0.3, 0.3), (0.0, 0.01)):
        given = replace(problem, values={**problem.values, "eps": eps})
        assert given.vdp_chain().eps == of_chain
