"""References, each against a closed form, a scaling law, or a second method, on small problems."""

from __future__ import annotations

import itertools
import math
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from benchmarks import regularised
from tests import strong_coupling
from theory.averaged.front import strong_coupling_front
from theory.cells.friction import FrictionCell
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from theory.piecewise.roots import labelled_roots
from verification.breathers.envelope import solve_envelope_breather
from verification.fronts.wave import front_wave
from verification.quantities import fronts as quantities_fronts
from verification.quantities.quantity import StatedValue
from verification.references import (
    equations,
    extrapolation,
    friction_cell,
    pace,
    passages,
    phase_locked,
    piecewise,
    precise_breather,
    switch_model,
)
from verification.references import friction_events as events
from verification.references import (
    front_wave as waves,
)
from verification.references.equations import full_rate
from verification.references.friction_events import (
    BEGINS,
    ENDS,
    REVERSES,
    EventRun,
    _earliest,
    _Law,
    _located,
    run_events,
)
from verification.references.pace import NoReferenceError
from verification.references.switch_model import SwitchRun, run_switch
from verification.runs.simulate import simulate
from verification.steppers import friction

# ------------------------------------------------------------------- runs in extended precision


def test_a_driven_run_in_extended_precision_knows_the_time() -> None:
    """ẏ = cos t + (y - sin t)(1 - t²), y = sin t; and ẏ = t¹⁵, which order sixteen has exactly."""

    def rate(t: Any, y: Any) -> Any:
        return np.cos(t) + (y - np.sin(t)) * (1 - t * t)

    found = extrapolation.precise_state(rate, np.zeros(1), 2.5)
    assert abs(found.value[0] - np.sin(np.longdouble(2.5))) <= found.uncertainty < 1e-15
    power = extrapolation.precise_state(lambda t, y: 0 * y + t**15, np.zeros(1), -1.5)
    assert abs(power.value[0] - np.longdouble(1.5) ** 16 / 16) <= power.uncertainty < 1e-12


def test_a_run_of_objects_is_as_exact_as_they_are_and_one_of_long_doubles_is_rounded() -> None:
    with mp.workdps(30):
        start = np.array([mp.mpf(1)], dtype=object)
        exact = extrapolation.integrate(lambda _, y: -y, start, 1.0, 1e-24)
        assert abs(exact.value[0] - mp.exp(-1)) < 1e-22
    assert exact.uncertainty == 0.0  # of its roundings, which the caller sets
    rounded = extrapolation.integrate(lambda _, y: -y, extrapolation.extended([1.0]), 1.0, 1e-17)
    assert 1e-19 < rounded.uncertainty < 1e-15


def test_a_reference_is_compared_with_a_run_at_ten_times_its_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[float] = []
    integrate = extrapolation.integrate

    def noted(rate: Any, start: Any, end: float, tolerance: float) -> Any:
        asked.append(tolerance)
        return integrate(rate, start, end, tolerance)

    monkeypatch.setattr(extrapolation, "integrate", noted)
    extrapolation.precise_state(lambda _, y: -y, np.ones(1), 1.0)
    sharper, looser = sorted(asked)
    assert looser == pytest.approx(10.0 * sharper, rel=1e-12, abs=0.0)


def test_roundings_of_a_run_are_of_its_largest_size_at_each_of_its_steps() -> None:
    """Of a state that is small at both ends, and of a turn beside one that is ten times as long."""

    def hump(t: Any, y: Any) -> Any:
        return np.array([-2 * (t - 3) * y[0], 0 * y[1]])

    eps = float(np.finfo(np.longdouble).eps)
    start = extrapolation.extended([math.exp(-9.0), 0.0])
    end = extrapolation.integrate(hump, start, 6.0, 1e-17)
    assert float(abs(end.value[0] - np.exp(np.longdouble(-9)))) < end.uncertainty
    assert end.uncertainty > 100.0 * eps  # its largest size is one, those of start and end 1e-4
    short, long, large = (
        extrapolation.integrate(
            lambda _, y: np.array([y[1], -y[0]]), extrapolation.extended([size, 0.0]), t, 1e-17
        ).uncertainty
        for t, size in ((4.0, 1.0), (40.0, 1.0), (4.0, 1000.0))
    )
    assert long == pytest.approx(10.0 * short, rel=0.2, abs=0.0)
    assert large == pytest.approx(1000.0 * short, rel=0.2, abs=0.0)


def test_rounding_errors_of_the_scheme_are_enlarged_by_the_sum_of_its_weights() -> None:
    """Those with which Aitken and Neville's recursion in 1/n² combines results of n = 1, 2, …."""
    count = extrapolation.COLUMNS
    weights = [[Fraction(int(n == m)) for m in range(1, count + 1)] for n in range(1, count + 1)]
    for column in range(1, count):
        for n in range(count, column, -1):
            ratio = Fraction(n, n - column) ** 2
            weights[n - 1] = [
                last + (last - before) / (ratio - 1)
                for last, before in zip(weights[n - 1], weights[n - 2], strict=True)
            ]
    assert sum(weights[-1]) == 1
    total = float(sum(map(abs, weights[-1])))
    assert total == pytest.approx(extrapolation._ENLARGED, rel=1e-14)


def test_steps_of_a_run_are_allowed_an_error_relative_to_its_largest_size_so_far(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They are those of a run beside which something as large as its start stands still."""
    unit = float(np.finfo(np.longdouble).eps) * extrapolation._ENLARGED
    parts: list[float] = []
    monkeypatch.setattr(extrapolation, "Pace", lambda: SimpleNamespace(check=parts.append))
    alone, beside = (
        extrapolation.integrate(
            lambda _, y: np.array([-1, 0][: y.size]) * y, extrapolation.extended(start), 30.0, 1e-15
        )
        for start in ([1.0], [1.0, 1.0])
    )
    assert alone.uncertainty == beside.uncertainty
    assert alone.value[0] == beside.value[0]
    parts.clear()
    still = extrapolation.integrate(lambda _, y: 0 * y, extrapolation.extended([1.0]), 30.0, 1e-15)
    assert still.uncertainty == pytest.approx(len(parts) * unit, rel=1e-12)  # none is refused


def test_a_step_has_the_order_of_its_last_column() -> None:
    """Sixteen, which has the integral of t¹⁵ exactly; that before it is of order fourteen."""
    zero, one = extrapolation.extended([0.0, 1.0])
    state, error = extrapolation._step(lambda t, y: 0 * y + t**15, zero, np.array([zero]), one)
    assert abs(float(state[0] - one / 16)) < 1e-17
    assert error > 1e-13


def test_a_run_may_take_its_share_of_the_time_and_a_beginning(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = iter([100.0, 104.9, 100.4, 105.6, 110.4])
    monkeypatch.setattr(pace, "MAX_SECONDS", 10.0)
    monkeypatch.setattr(pace.time, "process_time", lambda: next(clock))
    run = pace.Pace()
    run.check(0.5)
    run.check(0.0)
    with pytest.raises(pace.TooSlowError, match="10 s"):
        run.check(0.5)
    run.check(1.0)


def test_a_reference_front_that_takes_too_long_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "MAX_SECONDS", 0.0)
    stated = StatedValue(value=1.0, error=1e-4)
    with pytest.raises(pace.TooSlowError):
        quantities_fronts._by_scipy({"c": 1.0, "eta": 0.03125}, stated, full=False)


@pytest.mark.parametrize("end", [4.0, -4.0, 0.25])
def test_the_pace_of_a_run_is_the_part_that_is_done(
    end: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts: list[float] = []
    monkeypatch.setattr(extrapolation, "Pace", lambda: SimpleNamespace(check=parts.append))
    extrapolation.integrate(lambda _, y: 1j * y, np.array([1.0 + 0j]), end, 1e-12)
    assert parts[0] == 0.0
    assert parts == sorted(parts)
    assert (parts[-1] > 0.5) is (abs(end) > 1.0)
    assert parts[-1] < 1.0


# ----------------------------------------------------------------------------- the friction cell


@pytest.mark.parametrize("belt", [0.5, 1.25, 2.0, 4.0])
def test_a_cell_rises_after_slip_as_high_as_in_the_chain(belt: float) -> None:
    """A chain of one site; on fast belts it does not come back to the belt's speed."""
    cell = FrictionCell(v_d=belt)
    chain = FrictionChain.of(cell, c=0.0, sites=1)
    start = np.array([[cell.release - 0.1 * belt], [belt]])
    run = run_events(chain, start, 8.0, times=np.linspace(0.0, 8.0, 4001), tolerance=1e-11)
    (release,) = run.when(ENDS)[:1]
    late = run.times > release + 1.0
    highest = float((run.velocity[late, 0] - belt).max())
    assert friction_cell.highest_after_slip(belt) == pytest.approx(min(highest, 0.0), abs=1e-5)
    assert (run.when(BEGINS).size > 0) is (highest > -1e-9)


def test_friction_in_slip_depends_on_the_distance_from_the_speed_of_the_belt() -> None:
    """μ_d + (μ_st - μ_d) e^{-|w - v_d|/v₀}, here also above the belt, where it is not turned."""
    cell, y = friction_cell.CELL, 0.3
    for w in (0.5, 2.0):
        friction = cell.mu_d + (cell.mu_st - cell.mu_d) * math.exp(-0.75 / cell.v0)
        rate = friction_cell.slip_rate(1.25)(0.0, np.array([y, w]))
        assert rate == pytest.approx([w, -2.0 * cell.xi * w - y + friction], rel=1e-14)


@pytest.mark.parametrize("belt", [0.8, 1.25])
def test_the_averaged_damping_is_the_work_over_a_turn(belt: float) -> None:
    """By scipy's quadrature of (6), split where the cell overtakes the belt."""
    cell = friction_cell.CELL
    amplitudes, damping = friction_cell.averaged_damping(belt)
    assert amplitudes[-1] > 2.0 * belt
    assert (amplitudes[0], damping[0]) == (0.0, pytest.approx(0.0, abs=1e-14))

    def work(angle: float, R: float) -> float:
        slip = R * math.cos(angle) - belt
        size = cell.mu_d + (cell.mu_st - cell.mu_d) * math.exp(-abs(slip) / cell.v0)
        return -math.copysign(size, slip) * math.cos(angle)

    for place in (300, 1000, 1300, 1500, 2900):
        R = float(amplitudes[place])
        turns = [0.0, math.acos(min(1.0, belt / R)), math.pi]
        total = sum(quad(work, low, high, (R,), epsabs=1e-11)[0]
                    for low, high in pairwise(turns))  # fmt: skip
        assert damping[place] == pytest.approx(cell.xi * R - total / math.pi, abs=1e-7)


def test_an_averaged_amplitude_is_pulled_by_its_neighbours_and_damped_against_its_sign(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """To the left is the cycle and to the right is rest; the damping is made up."""
    amplitudes = np.arange(31.0) / 10.0
    damping = amplitudes * (amplitudes - 0.95) * (amplitudes - 2.05)
    seen: list[Any] = []
    monkeypatch.setattr(friction_cell, "averaged_damping", lambda _: (amplitudes, damping))
    monkeypatch.setattr(friction_cell, "solve_ivp", lambda *x, **how: seen.extend((*x, how)))
    monkeypatch.setattr(friction_cell, "passage_velocity", lambda _, sites, level: [*sites, level])
    assert friction_cell.averaged_front(1.0, 44) == [33, pytest.approx(0.95, abs=0.1)]
    rate, span, start, how = seen
    assert span[0] == 0.0
    assert span[1] > 44  # a front is at least about as fast as the waves
    assert how["dense_output"]  # arrivals are between steps
    cycle = start[0]
    assert set(start[12:]) == {0.0}
    r = np.array([1.5, -0.7, 0.2])
    drag = [1.5 * 0.55 * -0.55, -(0.7 * -0.25 * -1.35), 0.2 * -0.75 * -1.85]
    pull = [0.5 * (cycle + 0.7), 0.5 * (1.5 - 0.2), 0.5 * -0.7]
    assert rate(0.0, r) == pytest.approx(np.array(pull) - drag, rel=1e-12)


def test_the_averaged_front_of_friction_has_the_velocity_of_steps_of_another_method() -> None:
    """Classical Runge-Kutta with fixed steps, and arrivals by lines between them."""
    belt, sites, h = 1.25, 60, 0.02
    amplitudes, damping = friction_cell.averaged_damping(belt)
    zeros = [
        float(np.interp(0.0, [damping[i], damping[i + 1]], amplitudes[i : i + 2]))
        if damping[i] < damping[i + 1]
        else float(amplitudes[i + 1])
        for i in range(1, amplitudes.size - 1)
        if damping[i] * damping[i + 1] < 0.0
    ]
    level, cycle = zeros[0], zeros[-1]

    def rate(r: np.ndarray) -> np.ndarray:
        beside = np.concatenate([[cycle], r, [0.0]])
        drag = np.sign(r) * np.interp(np.abs(r), amplitudes, damping)
        found: np.ndarray = 0.5 * (beside[:-2] - beside[2:]) - drag
        return found

    r = np.where(np.arange(sites) < 15, cycle, 0.0)
    arrivals = np.full(sites, np.nan)
    for step in range(round(1.3 * sites / h)):
        k1 = rate(r)
        k2 = rate(r + 0.5 * h * k1)
        k3 = rate(r + 0.5 * h * k2)
        following = r + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rate(r + h * k3))
        for n in np.flatnonzero((r <= level) & (following > level) & np.isnan(arrivals)):
            arrivals[n] = h * (step + (level - r[n]) / (following[n] - r[n]))
        r = following
    watched = arrivals[45:50]
    v = 1.0 / np.polyfit(np.arange(5), watched, 1)[0]
    assert friction_cell.averaged_front(belt, sites) == pytest.approx(v, abs=1e-3)


def test_a_front_of_friction_needs_an_unstable_cycle() -> None:
    """On slower belts rest is unstable, and the averaged damping has one zero only."""
    with pytest.raises(ValueError, match="unpack"):
        friction_cell.averaged_front(1.0, 60)


# ----------------------------------------------------------------- friction with located events


def _event_run(*log: tuple[float, int, int]) -> EventRun:
    return EventRun(np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1)),
                    np.array(log, dtype=float).reshape(-1, 3), 0.0)  # fmt: skip


def test_a_cycle_is_from_release_to_release_with_the_stick_before_the_last() -> None:
    cycle = [(1.0, 1, ENDS), (4.0, 1, BEGINS), (4.5, 1, ENDS), (7.5, 1, BEGINS), (8.25, 1, ENDS)]
    assert _event_run(*cycle).last_cycle == (3.75, 0.75)
    assert _event_run(*cycle, (11.0, 1, BEGINS)).last_cycle == (3.75, 0.75)
    assert _event_run(*cycle[:3]).last_cycle == (3.5, 0.5)
    for few in ([], cycle[:1], cycle[:2], cycle[1:3], [cycle[0], cycle[2]]):
        assert _event_run(*few).last_cycle is None


@pytest.mark.parametrize(
    ("place", "sticks"), [(0.8, True), (-0.8, True), (1.5, False), (-1.5, False)]
)
def test_a_site_at_the_speed_of_the_belt_sticks_if_friction_can_hold_it(
    place: float, sticks: bool
) -> None:
    """Else it slips to where it is pulled; here μ_st = 1 and damping adds 2ξv_d = 0.1."""
    cell = FrictionCell(v_d=0.5, mu_st=1.0, xi=0.1)
    chain = FrictionChain.of(cell, c=0.0, sites=1)
    run = run_events(chain, np.array([[place], [0.5]]), 0.1, tolerance=1e-13, times=np.array([0.1]))
    carried = place + 0.5 * 0.1
    if sticks:
        assert run.y[0, 0] == pytest.approx(carried, abs=1e-14)
    else:
        assert (run.y[0, 0] - carried) * place < -1e-4


def test_events_have_the_numbers_of_those_of_the_compiled_method() -> None:
    kinds = [friction.STICK_BEGINS, friction.STICK_ENDS, friction.REVERSAL]
    assert kinds == [BEGINS, ENDS, REVERSES]


def test_a_site_that_is_pulled_past_the_belt_reverses_its_slip_as_in_the_other_method() -> None:
    """It then slips ahead of the belt until it sticks; events have the same numbers in both."""
    chain = FrictionChain(c=0.0, sites=1)
    start = np.array([[-5.0], [chain.cell.v_d - 1.0]])
    run = run_events(chain, start, 4.0, tolerance=1e-10)
    other = simulate(chain, start, 4.0, logged_events=10).event_log
    assert run.log[0, 2] == REVERSES
    assert run.log[:, 1:].tolist() == other[:, 1:].tolist()
    assert run.log[:, 0] == pytest.approx(other[:, 0], abs=1e-6)


def test_a_site_that_its_neighbour_pulls_off_the_belt_slips_ahead_as_in_the_other_method() -> None:
    """What holds it has then the other sign than at the release behind a rising y."""
    chain = FrictionChain(c=0.3, sites=2)
    start = np.array([[0.0, 0.0], [chain.cell.v_d, 20.0]])
    run = run_events(chain, start, 1.0, times=np.array([1.0]), tolerance=1e-10)
    found = simulate(chain, start, 1.0, logged_events=10)
    assert run.log[0, 1:].tolist() == [1, ENDS]
    assert run.velocity[0, 0] > chain.cell.v_d
    assert run.log[:, 1:].tolist() == found.event_log[:, 1:].tolist()
    assert run.log[:, 0] == pytest.approx(found.event_log[:, 0], abs=1e-6)


def test_of_two_releases_within_a_step_the_earlier_one_is_first() -> None:
    """On the belt y rises by v_d τ until the cell is released; without coupling each on its own."""
    chain = FrictionChain(c=0.0, sites=2)
    belt, times = chain.cell.v_d, np.array([0.03, 0.01])
    start = np.array([chain.cell.release - belt * times, [belt, belt]])
    run = run_events(chain, start, 0.05, tolerance=1e-10)
    assert run.log[:, 1:].tolist() == [[2, ENDS], [1, ENDS]]
    assert run.log[:, 0] == pytest.approx(np.sort(times), abs=1e-9)


@pytest.mark.parametrize("slope", [1.0, 1e-6, -1e-6, 1e4])
def test_an_event_is_due_however_slowly_or_fast_it_is_come_to(slope: float) -> None:
    """Made up: the velocity over the belt is zero to rounding, and was not a moment before.

    Or it would be zero at a time that differs by rounding. The first of two sites goes on to slip.
    """
    cell = FrictionCell(v_d=0.5, mu_st=1.0, xi=0.1)
    law = _Law(FrictionChain.of(cell, c=0.0, sites=2))

    def dense(t: float) -> np.ndarray:
        return np.array([0.2, 0.3, 0.1, 1e-16 + slope * (t - 2.0 - 1e-13)])

    modes = np.array([1, -1 if slope > 0.0 else 1])
    state, kinds = law.switched(dense(2.0), dense, 2.0, modes)
    assert kinds == [(1, BEGINS)]
    assert modes.tolist() == [1, 0]
    assert state.tolist() == [0.2, 0.3, 0.1, 0.0]


@pytest.mark.parametrize("slope", [1.0, 1e3])
@pytest.mark.parametrize("off", [1e-10, -1e-10])
def test_an_event_at_another_time_is_not_due(off: float, slope: float) -> None:
    """Made up: the velocity over the belt passes zero at a time that differs by more than rounding.

    Of two sites whose events follow each other so closely, only one has its event at a time.
    """
    law = _Law(FrictionChain.of(FrictionCell(v_d=0.5, mu_st=1.0, xi=0.1), c=0.0, sites=1))

    def dense(t: float) -> np.ndarray:
        return np.array([0.3, slope * (t - 2.0 - off)])

    modes = np.array([-1])
    _, kinds = law.switched(dense(2.0), dense, 2.0, modes)
    assert (kinds, modes.tolist()) == ([], [-1])


def test_a_site_that_stays_at_an_event_has_none() -> None:
    law = _Law(FrictionChain.of(FrictionCell(v_d=0.5, mu_st=1.0, xi=0.1), c=0.0, sites=1))
    modes = np.array([1])
    _, kinds = law.switched(np.array([0.3, 0.0]), lambda _: np.array([0.3, 0.0]), 2.0, modes)
    assert (kinds, modes.tolist()) == ([], [1])


@pytest.mark.parametrize("root", [0.3, 0.7, 1.1])
def test_an_event_is_located_to_rounding(root: float) -> None:
    """Made up, and bent at its root: (root - t) + 100 (root - t)³."""

    def dense(t: float) -> np.ndarray:
        return np.array([(root - t) + 100.0 * (root - t) ** 3])

    law: Any = SimpleNamespace(distance=lambda z, _: z)
    found = _located(law, dense, np.zeros(1, dtype=np.int64), 0, low=0.0, high=2.0)
    assert found == pytest.approx(root, abs=2e-15)


def test_a_run_with_events_has_the_tolerances_that_are_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[dict[str, float]] = []

    def noted(*given: Any, **how: float) -> Any:
        asked.append(how)
        return solver(*given, **how)

    solver = events.DOP853
    monkeypatch.setattr(events, "DOP853", noted)
    chain = FrictionChain(c=0.0, sites=1)
    run_events(chain, np.array([[2.0], [0.0]]), 0.1, tolerance=1e-9, longest_step=0.04)
    assert asked == [{"rtol": 1e-9, "atol": pytest.approx(1e-10), "max_step": 0.04}]


def test_a_site_that_starts_on_an_event_is_no_reference() -> None:
    cell = FrictionCell(v_d=1.0, mu_st=1.0, xi=0.25)
    chain = FrictionChain.of(cell, c=0.0, sites=1)
    for end in (1e-4, 1.0):  # of one step, and of several
        with pytest.raises(NoReferenceError, match="site 1 starts on an event"):
            run_events(chain, np.array([[0.5], [1.0]]), end, tolerance=1e-13)  # y + 2ξv_d is μ_st


def test_a_run_with_events_is_positive_and_fast_enough() -> None:
    chain, start = FrictionChain(c=0.0, sites=1), np.array([[2.0], [0.0]])
    for end in (0.0, -1.0):
        with pytest.raises(ParameterError, match="end time"):
            run_events(chain, start, end, tolerance=1e-9)
    covered: list[float] = []
    pace: Any = SimpleNamespace(check=covered.append)
    found = run_events(chain, start, 12.0, tolerance=1e-9, pace=pace)
    assert len(found.log) == 4
    assert covered[-1] == 1.0
    assert 0.0 < covered[0] < 0.1


@pytest.mark.parametrize("scale", [1e3, 1e-3])
def test_a_friction_chain_with_all_forces_and_speeds_scaled_moves_alike(scale: float) -> None:
    def run(times: float) -> EventRun:
        cell = FrictionCell(
            v_d=1.25 * times, mu_st=1.0 * times, mu_d=0.5 * times, v0=0.5 * times, xi=0.05
        )
        chain = FrictionChain.of(cell, c=0.05, sites=2)
        start = times * np.array([[0.5, 0.2], [1.25, 1.25]])  # both are carried at first
        return run_events(chain, start, 9.0, times=np.array([9.0]), tolerance=1e-11)

    plain, scaled = run(1.0), run(scale)
    assert plain.log.shape[0] >= 2
    assert scaled.log == pytest.approx(plain.log, abs=1e-5)
    assert scaled.y / scale == pytest.approx(plain.y, abs=1e-5)


def test_the_pattern_of_regularised_friction_is_that_of_its_derivatives() -> None:
    chain = FrictionChain.of(FrictionCell(), c=0.3, sites=4)
    rate, z = regularised.regularised_rate(chain, 0.1), np.random.default_rng(4).normal(size=8)
    slope = [(rate(0.0, z + 1e-6 * e) - rate(0.0, z - 1e-6 * e)) / 2e-6 for e in np.eye(8)]
    found = regularised._sparsity(4).toarray() != 0
    assert np.array_equal(found, np.abs(np.array(slope).T) > 1e-6)


@pytest.mark.parametrize("root", [0.001, 0.5, 0.88, 0.95, 0.999])
def test_an_event_is_found_in_all_of_a_step(root: float) -> None:
    law: Any = SimpleNamespace(distance=lambda z, _: z)
    modes = np.zeros(1, dtype=np.int64)
    found = _earliest(law, lambda t: np.array([root - t]), modes, 0.0, 1.0)
    assert found == pytest.approx(root, rel=1e-14)


@pytest.mark.parametrize(
    ("end", "refused"), [(0.0, False), (-1e-12, False), (-2e-9, True), (-1e-6, True)]
)
def test_a_site_may_start_on_an_event_if_it_stays_there(end: float, refused: bool) -> None:
    """Within rounding; what it would do beyond its event is not known."""
    law: Any = SimpleNamespace(distance=lambda z, _: z)

    def run() -> float | None:
        return _earliest(
            law, lambda t: end * np.atleast_2d(t), np.zeros(1, dtype=np.int64), 0.0, 1.0
        )

    if refused:
        with pytest.raises(NoReferenceError, match="site 1 starts on an event"):
            run()
    else:
        assert run() is None


def test_the_switch_model_is_run_with_the_numbers_that_are_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its longest step is 1/(√(1 + 4c) + 2ξ), or the whole run."""
    seen: list[Any] = []

    def run(rule: Any, z: np.ndarray, record: Any) -> float:
        seen[:] = rule, z, record
        record.counters[:] = 7, 5, 3, 0
        record.states[1] = 2.0
        record.arrivals[0] = 0.5
        return 3.5

    monkeypatch.setattr(switch_model, "_trapezoid", run)
    chain = FrictionChain.of(FrictionCell(xi=0.3), c=2.0, sites=2)
    start, most = np.array([[2.0, 0.5], [0.0, 0.1]]), 1.0 / (3.0 + 0.6)
    found = run_switch(chain, start, 4.0, step=0.999 * most, relative=1e-4, absolute=1e-7,
                       samples=5)  # fmt: skip
    rule, z, record = seen
    assert (rule.t_end, rule.relative, rule.absolute, rule.free) == (4.0, 1e-4, 1e-7, True)
    assert rule.law[-1] == switch_model.PAPER_BAND == 1e-4  # as in the paper
    assert rule.fixed == pytest.approx(4.0 / 15.0, rel=1e-12)
    assert np.array_equal(z, start)
    assert record.times.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert (found.steps, found.rejected, found.unconverged, found.reached) == (7, 5, 3, 3.5)
    assert (found.y[1].tolist(), found.velocity[0].tolist()) == ([2.0, 2.0], [0.0, 0.0])
    assert found.arrivals.tolist() == [0.5, pytest.approx(math.nan, nan_ok=True)]
    # A whole number, to rounding; 4/(4/49) is above 49.
    for step, steps in ((0.01, 400), (4.0 / (400.0 + 1e-7), 401), (4.0 / 49.0, 49)):
        run_switch(chain, start, 4.0, step=step)
        assert seen[0].fixed == pytest.approx(4.0 / steps, rel=1e-12)
    run_switch(chain, start, 4.0)
    assert (seen[0].fixed, seen[0].relative, seen[0].absolute) == (0.0, 1e-3, 1e-6)
    for end, step in ((4.0, 1.001 * most), (0.1, 0.1001), (4.0, 0.0)):
        with pytest.raises(ParameterError, match="step"):
            run_switch(chain, start, end, step=step)


def test_steps_of_the_switch_model_are_bounded_and_their_refusals_counted() -> None:
    """Fastest where all neighbours pull against each other: √(1 + 4c), and twice the damping."""
    cell = FrictionCell(xi=0.3)
    chain, start = FrictionChain.of(cell, c=2.0, sites=2), np.array([[2.0, 0.5], [0.0, 0.0]])
    most = 1.0 / (3.0 + 0.6)
    assert run_switch(chain, start, 4.0, step=0.999 * most).steps == math.ceil(4.0 / (0.999 * most))
    with pytest.raises(ParameterError, match="step"):
        run_switch(chain, start, 4.0, step=1.001 * most)
    for absolute in (0.0, -1e-6, math.nan):
        with pytest.raises(ParameterError, match="absolute tolerance"):
            run_switch(chain, start, 4.0, absolute=absolute)
    fixed = run_switch(chain, start, 4.0, step=0.01)
    assert (fixed.steps, fixed.rejected, fixed.unconverged, fixed.reached) == (400, 0, 0, 4.0)
    chosen = run_switch(chain, start, 4.0, band=1e-6, relative=1e-8, absolute=1e-10)
    assert chosen.rejected > 0
    assert chosen.unconverged == 0
    usual = run_switch(chain, start, 4.0, relative=1e-3, absolute=1e-6)  # MATLAB's
    assert np.array_equal(run_switch(chain, start, 4.0).y, usual.y)


@pytest.mark.parametrize("phase", [0.0, 0.3])
@pytest.mark.parametrize("period", [8.0, 10.37])
@pytest.mark.parametrize("apart", [1.0, 0.25])
def test_the_period_of_a_switch_run_is_from_one_turn_to_the_next(
    period: float, phase: float, apart: float
) -> None:
    """By lines between samples; where one is at the turn itself it counts once."""
    times = apart * np.arange(0.0, 101.0)
    period *= apart
    swing = np.mod(times / period + phase, 1.0)  # of a velocity that is linear between its turns
    velocity = np.where(swing < 0.5, 1.0 - 4.0 * swing, 4.0 * swing - 3.0)[:, None]
    run = SwitchRun(times, 0.0 * velocity, velocity, np.zeros(1), 1, 0, 0, 100.0, 0.0)
    assert run.period == pytest.approx(period, rel=1e-12)


def test_the_period_of_a_switch_run_is_that_of_its_second_half() -> None:
    """Of ten turns, each at a sample, the later ones twice as far apart."""
    turns = np.array([5, 10, 15, 20, 25, 35, 45, 55, 65, 75])
    velocity = np.ones(80)
    for turn in turns:
        velocity[turn : turn + 3] = 0.0, -1.0, -1.0
    run = SwitchRun(np.arange(80.0), velocity[:, None], velocity[:, None], np.zeros(1), 1, 0, 0,
                    80.0, 0.0)  # fmt: skip
    assert run.period == pytest.approx(10.0, rel=1e-12)


# -------------------------------------------------------------------------------- travelling waves


def test_a_wave_by_differences_is_free_of_roundings_of_doubles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Newton's method ends at one v, wherever it starts, and it is that of the wave to 1e-4."""
    given = {"per_site": 12, "behind": 8, "ahead": 14}
    v = waves.front_velocity(0.6, 0.03125, **given)
    assert float(v) == pytest.approx(front_wave(0.6, 0.03125).v, abs=1e-4)
    guess = waves._guess

    def other(*given: Any) -> Any:
        R, v = guess(*given)
        return R * (1.0 + 1e-3 * np.sin(np.arange(R.size))), 1.01 * v

    monkeypatch.setattr(waves, "_guess", other)
    assert abs(waves.front_velocity(0.6, 0.03125, **given) - v) < 2e-17


def test_a_wave_is_looked_for_from_a_run_of_the_chain_between_both_cycles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The velocity of the run is that of the wave but for what is left of its start."""
    eta, given = 0.03125, []
    guess = waves._guess

    def noted(*known: Any) -> Any:
        given.extend(known)
        raise ArithmeticError("seen")

    monkeypatch.setattr(waves, "_guess", noted)
    with pytest.raises(ArithmeticError, match="seen"):
        waves.front_velocity(0.6, eta)
    unstable, stable = np.sqrt(np.sort(np.roots([eta / 8.0, -0.25, 1.0])))
    assert given[2] == pytest.approx(np.linspace(-12.0, 24.0, 36 * 48 + 1), abs=1e-12)
    assert given[3:] == pytest.approx([stable, unstable], rel=1e-12)
    R, v = guess(0.6, eta, np.array([-12.0, -0.5, 0.0, 0.5, 20.0]), stable, unstable)
    assert v == pytest.approx(0.722566, abs=1e-3)  # as in the docstring of front_velocity
    assert R[0] == stable  # where the run has not come to its end
    assert R[2] == pytest.approx(unstable, rel=1e-2)
    assert stable > R[1] > R[2] > R[3] > 0.0
    assert abs(R[4]) < 0.1 * unstable


@pytest.mark.parametrize("guessed", [0.5, 1.0])
def test_a_wave_is_found_from_a_step_in_which_no_chain_has_been_run(
    guessed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Newton's first steps hardly shrink from there."""
    given = {"per_site": 10, "behind": 7, "ahead": 12}
    v = waves.front_velocity(0.6, 0.03125, **given)
    chain = VdpChain(a=1.0, b=0.03125, c=0.6)
    ratio = chain.stable_amplitude / chain.unstable_amplitude
    step = chain.stable_amplitude / (1.0 + np.exp(0.4 * np.arange(-70, 121)) * (ratio - 1.0))
    monkeypatch.setattr(waves, "_guess", lambda *_: (step, guessed))
    assert abs(waves.front_velocity(0.6, 0.03125, **given) - v) < 1e-18


def test_corrections_of_a_wave_go_on_while_any_of_them_is_large(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Made up: three of a hundredth, of either sign, and then none."""
    size = 10 * (4 + 5) + 2
    monkeypatch.setattr(waves, "_guess", lambda *_: (np.ones(size - 1), 0.5))
    for sign in (1.0, -1.0):
        left = [0.01 * sign] * 3
        monkeypatch.setattr(
            waves, "spsolve", lambda *_, left=left, **__: np.full(size, left.pop() if left else 0.0)
        )
        v = waves.front_velocity(0.6, 0.03125, per_site=10, behind=4, ahead=5)
        assert float(v) == pytest.approx(0.5 - 0.03 * sign, rel=1e-12)


def test_a_wave_ends_in_both_states_of_the_chain() -> None:
    """A longer window behind it changes v by the square of what is left there of the front."""
    short, long = (
        waves.front_velocity(0.6, 0.03125, per_site=10, behind=behind, ahead=12)
        for behind in (7, 12)
    )
    assert abs(short - long) < 1e-14


@pytest.mark.parametrize("m", [10, 12])
def test_the_matrix_of_a_wave_is_the_derivative_of_its_equation(m: int) -> None:
    """Where a site has as many points as a difference reaches, both act on one diagonal."""
    c, eta, v, size = 2.0, 0.05, 0.7, 60
    R = 1.0 + 0.5 * np.sin(0.3 * np.arange(size))
    weights = [float(w) for w in waves._CENTRAL]

    def equation(R: np.ndarray) -> np.ndarray:
        at = {i: R[i] if 0 <= i < size else 0.0 for i in range(-20, size + 20)}
        return np.array([
            v * m * sum(w * (at[i + k] - at[i - k]) for k, w in enumerate(weights, start=1))
            + 0.5 * c * (at[i - m] - at[i + m])
            - 0.5 * R[i] * (1.0 - R[i] ** 2 / 4.0 + eta * R[i] ** 4 / 8.0)
            for i in range(size)
        ])  # fmt: skip

    slope = [(equation(R + 1e-5 * e) - equation(R - 1e-5 * e)) / 2e-5 for e in np.eye(size)]
    assert np.abs(waves._matrix(R, v, c, eta, m).toarray() - np.array(slope).T).max() < 1e-8


def test_sites_arrive_in_a_chain_as_they_do_by_the_engine() -> None:
    chain = VdpChain(a=4.0, b=0.5, c=5.0, eps=0.3, sites=5)
    start = np.zeros((2, 5))
    start[0, 0] = 3.0
    for level in (1e-4, 0.4):
        found = passages.arrivals_of_chain(chain, 60.0, level, 3.0)
        run = simulate(chain, start, 60.0, samples=2, level=level, tolerance=1e-12)
        assert np.isfinite(found).sum() == 5
        assert found[1:] == pytest.approx(run.arrivals[1:], abs=1e-7)
        assert found[0] == 0.0
    never = passages.arrivals_of_chain(chain, 3.0, 50.0, 3.0)
    assert np.isnan(never[1:]).all()


def test_an_arrival_in_the_first_step_of_a_piece_is_found() -> None:
    """A run goes on every half turn; here a site is higher just after it than ever before."""
    start, when = np.array([3.0, 0.0, 0.0, 0.0, 0.0, 0.0]), np.pi + 1e-4
    times = [*np.linspace(0.0, np.pi, 400), when]
    tried = 0
    for c in (0.5, 1.0, 1.5, 2.0):
        chain = VdpChain(a=4.0, b=0.5, c=c, eps=0.3, sites=3)
        run = solve_ivp(full_rate(chain), (0.0, when), start, "DOP853", t_eval=times, rtol=1e-10)
        for site in (1, 2):
            height = np.hypot(run.y[site], run.y[site + 3])
            if height[-1] > height[:-1].max():
                found = passages.arrivals_of_chain(chain, 2.0 * np.pi, float(height[-1]), 3.0)
                assert found[site] == pytest.approx(when, abs=1e-5)
                tried += 1
    assert tried


def test_a_site_sticks_in_the_band_of_relative_velocity_that_the_paper_takes() -> None:
    assert switch_model.PAPER_BAND == 1e-4


@pytest.mark.parametrize(("eta", "c", "eps"), [(0.03125, 5.0, 0.1), (0.11, 1.0, 0.3)])
def test_a_front_on_few_sites_has_the_velocity_of_the_engine(
    eta: float, c: float, eps: float
) -> None:
    """From the passages of the same sites; those of scipy are on lines between its steps."""
    chain, filled, watched = VdpChain(a=1.0, b=eta, c=c, eps=eps, sites=40), 10, np.arange(25, 32)
    start, turn = np.zeros((2, 40)), 0.5 * np.pi * np.arange(filled)
    start[:, :filled] = chain.stable_amplitude * np.array([np.cos(turn), np.sin(turn)])
    run = simulate(chain, start, 250.0, samples=2, level=chain.unstable_amplitude, tolerance=1e-10)
    v = 1.0 / np.polyfit(watched, run.arrivals[watched], 1)[0] / eps
    assert passages.velocity_on_few_sites(chain, filled) == pytest.approx(v, rel=3e-4)


def test_a_front_on_few_sites_is_timed_over_the_last_half_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Made up: sites 25 to 31 are passed one after the other, and the others later than that.

    The later the farther they are from the middle one, which leaves the slope of a line through all
    of them as it is, and not of a line through fewer.
    """
    chain, filled, v = VdpChain(a=1.0, b=0.05, c=1.0, eps=0.1, sites=40), 10, 0.7
    n = np.arange(40)
    passed = n / (chain.eps * v) + np.where((n >= 25) & (n < 32), 0.1 * (n - 28) ** 2, 3.0)

    def run(_: object, span: tuple[float, float], start: np.ndarray, **how: Any) -> Any:
        assert how["rtol"] <= 1e-6
        assert how["atol"] <= 1e-7
        # y and its derivative at t = 0, of cos(t - φ), where φ grows by a quarter turn per site.
        turned = chain.stable_amplitude * 1j ** np.arange(filled)
        assert start[:filled] + 1j * start[40 : 40 + filled] == pytest.approx(turned, abs=1e-12)
        assert not start[filled:40].any()
        assert not start[40 + filled :].any()
        t = np.linspace(0.0, 24.5, 437) ** 2
        size = np.maximum(chain.unstable_amplitude + 0.01 * (t - passed[:, None]), 0.0)
        return SimpleNamespace(t=t, y=np.concatenate([size * np.cos(t), size * np.sin(t)]))

    monkeypatch.setattr(passages, "solve_ivp", run)
    assert passages.velocity_on_few_sites(chain, filled) == pytest.approx(v, rel=1e-9)


@pytest.mark.parametrize("eta", [0.11, 0.115])
def test_a_front_that_passes_some_or_none_of_the_sites_has_no_velocity(
    eta: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is given half as long again as the fastest waves take, in steps of at most a half."""
    seen: list[np.ndarray] = []

    def run(*given: Any, **how: Any) -> Any:
        found = solve_ivp(*given, **how)
        seen.append(found.t)
        return found

    monkeypatch.setattr(passages, "solve_ivp", run)
    chain = VdpChain(a=1.0, b=eta, c=0.7, eps=0.3, sites=40)
    with pytest.raises(ArithmeticError, match="does not come to its end"):
        passages.velocity_on_few_sites(chain, 10)
    omega = np.sqrt(1.0 + 2.0 * 0.3 * 0.7 * (1.0 - np.cos(np.linspace(0.0, np.pi, 4001))))
    fastest = np.diff(omega).max() / (np.pi / 4000)
    assert seen[0][-1] == pytest.approx(1.5 * 30.0 / fastest, rel=1e-6)
    assert np.diff(seen[0]).max() <= 0.5 + 1e-12


@pytest.mark.parametrize(
    ("c", "eta", "sites", "within"),
    [(0.3, 0.03125, 30, 2e-9), (0.6, 0.03125, 100, 1e-8), (0.34, 0.07, 100, 1e-8)],
)
def test_a_front_of_quarter_turns_is_timed_until_it_has_run_through(
    c: float, eta: float, sites: int, within: float
) -> None:
    """Also where it is slower than the first run allows for, v = 0.67 c."""
    wave = front_wave(c, eta).v
    found = passages.quarter_turn_velocity(1.0, eta, c, sites)
    assert found == pytest.approx(wave, abs=within)


def test_a_front_of_quarter_turns_is_run_longer_until_all_sites_are_passed_or_it_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Made up: sites are passed one after the other, at some velocity or at none."""
    c, sites, v = 0.3, 24, 0.25
    chain = VdpChain(a=1.0, b=0.05, c=c)
    ends: list[float] = []
    rates: list[Any] = []

    late = np.where(np.arange(sites) < sites - 4, 0.0, 0.5)  # those beside the end are not timed

    def run(rate: Any, span: tuple[float, float], start: np.ndarray, **how: Any) -> Any:
        assert span[0] == 0.0
        assert how["rtol"] <= 1e-8
        assert how["atol"] <= 1e-9
        assert sorted(set(start)) == [0.0, chain.stable_amplitude]
        assert np.all(np.diff(start) <= 0.0)  # the cycle is on the left
        ends.append(span[1])
        rates.append(rate)
        t = np.linspace(*span, 2000)

        def heights(t: Any) -> Any:
            behind = (np.arange(sites) + late).reshape(-1, *[1] * np.ndim(t))
            return np.maximum(10.0 + v * t - behind, 0.0)

        return SimpleNamespace(t=t, y=heights(t), sol=heights)

    monkeypatch.setattr(passages, "solve_ivp", run)
    assert passages.quarter_turn_velocity(1.0, 0.05, c, sites) == pytest.approx(v, rel=1e-9)
    assert ends[0] == pytest.approx(sites / c)
    r = np.cos(np.arange(sites))
    damping = 0.5 * r[0] * (1.0 - r[0] ** 2 / 4.0 + 0.05 * r[0] ** 4 / 8.0)
    pull = 0.5 * c * (chain.stable_amplitude - r[1])
    assert rates[0](0.0, r)[0] == pytest.approx(pull - damping, rel=1e-12)
    v = 0.07  # too slow for the first run, which then ends beside the first of the sites watched
    ends.clear()
    assert passages.quarter_turn_velocity(1.0, 0.05, c, sites) == pytest.approx(v, rel=1e-9)
    assert len(ends) > 1
    v = 1.6  # the first of the sites watched is passed at T = 2.6
    assert passages.quarter_turn_velocity(1.0, 0.05, c, sites) == pytest.approx(v, rel=1e-9)
    v = 2.2  # the first of the sites watched is passed at T = 1.9, and the next one at 2.3
    with pytest.raises(ArithmeticError, match="has not settled"):
        passages.quarter_turn_velocity(1.0, 0.05, c, sites)
    v = 0.0
    ends.clear()
    with pytest.raises(ArithmeticError, match="does not end"):
        passages.quarter_turn_velocity(1.0, 0.05, c, sites)
    assert 25.0 < max(ends) * c / sites <= 100.0


def test_a_front_of_quarter_turns_at_strong_coupling_obeys_the_law() -> None:
    """v = c + κ (c/6)^{1/3}, to the next order."""
    law = 100.0 + strong_coupling_front(0.03125).kappa * (100.0 / 6.0) ** (1.0 / 3.0)
    assert passages.quarter_turn_velocity(1.0, 0.03125, 100.0, 850) == pytest.approx(law, rel=5e-3)


def test_a_front_of_quarter_turns_is_refused_until_its_start_is_forgotten() -> None:
    """It takes 1.5, and then 2.4, to the first site timed; less than a thousandth is then left."""
    with pytest.raises(ArithmeticError, match="has not settled on 126 sites"):
        passages.quarter_turn_velocity(1.0, 0.05, 20.0, 126)
    found = passages.quarter_turn_velocity(1.0, 0.05, 20.0, 200)
    assert found == pytest.approx(front_wave(20.0, 0.05).v, rel=1e-3)


def test_sites_that_return_to_rest_beside_the_free_end_do_not_stop_a_front_of_quarter_turns() -> (
    None
):
    """The last of them is below the unstable cycle again, and stays there."""
    found = passages.quarter_turn_velocity(1.0, 0.08, 20.0, 168)
    assert found == pytest.approx(front_wave(20.0, 0.08).v, rel=1e-3)


@pytest.mark.parametrize("eta", [0.01, 0.03125])
def test_the_front_of_strong_coupling_is_between_what_leaves_upwards_and_downwards(
    eta: float,
) -> None:
    kappa = strong_coupling_front(eta).kappa
    for off in (-1e-2, -1e-6, 1e-6, 1e-2):
        assert strong_coupling._leaves_upwards(kappa + off, eta) is (off > 0.0)
    low, high = strong_coupling.kappa_by_shooting(eta, kappa - 1e-10, kappa + 1e-10)
    assert low - 1e-11 <= kappa <= high + 1e-11
    assert 0.0 < high - low < 2e-12
    for ends in ((kappa - 1e-2, kappa - 1e-3), (kappa + 1e-3, kappa + 1e-2)):
        with pytest.raises(ArithmeticError, match="no front"):
            strong_coupling.kappa_by_shooting(eta, *ends)


# ------------------------------------------------------------------------------ phase-locked states

A, B = 2.5, 0.5


@pytest.fixture(name="short")
def short_tails(monkeypatch: pytest.MonkeyPatch) -> int:
    """Few sites at rest beside the core: what is asked here does not depend on how many."""
    monkeypatch.setattr(phase_locked, "MARGIN", 3)
    return 3


def test_a_nucleus_has_its_core_and_no_other_site_above_the_unstable_cycle(short: int) -> None:
    """By a fifth: sites there have left it. r² = (a/b)(1 - √(1 - 8b/a²))."""
    unstable = math.sqrt(A / B * (1.0 - math.sqrt(1.0 - 8.0 * B / A**2)))
    sites = 2 + 2 * short
    for core, beside, held in ((1.21, 1.19, True), (1.19, 1.19, False), (1.21, 1.21, False)):
        r = np.full(sites, beside * unstable)
        r[short : short + 2] = core * unstable
        turned = r * np.exp(0.7j * np.arange(sites))
        u = np.concatenate([turned.real, turned.imag, [0.1]])
        assert phase_locked._is_nucleus(u, 2, A, B) is held


def test_a_breather_is_stable_if_it_grows_by_no_more_than_rounding(short: int) -> None:
    (one,) = phase_locked.locked_breathers(1, A, B)
    stable = {growth: replace(one, growth=growth).stable for growth in (-1.0, 1e-8, 1e-6, 1.0)}
    assert stable == {-1.0: True, 1e-8: True, 1e-6: False, 1.0: False}


def test_branches_start_on_the_cycle_of_the_cell_with_tails_of_first_order(short: int) -> None:
    """It solves (43) at c = 0; φ₁ = -icφ₀ leaves a term from φ₂ and the damping a|φ₁|²/4."""
    steps = np.array([0.4, -0.5 * np.pi])
    still = phase_locked.residual(phase_locked.start_from(steps, A, B, 0.0), 0.0, A, B)
    assert np.abs(still).max() < 1e-14  # rounding
    c, size = 0.01, steps.size + 1
    u = phase_locked.start_from(steps, A, B, c)
    off = phase_locked.residual(u, c, A, B)[:-1].reshape(2, -1)
    tails = np.hypot(*np.delete(off, range(short, short + size), axis=1))
    r = abs(u[short])  # the first site of the core is in phase with the zero
    assert tails.max() <= c**3 * r * (0.5 + A * r**2 / 8.0)


def test_two_sites_may_be_in_phase_opposite_or_anything_between() -> None:
    steps = [abs(float(each[0])) for each in phase_locked.phase_patterns(2)]
    assert (min(steps), max(steps)) == (0.0, pytest.approx(np.pi))


@pytest.mark.parametrize("size", [2, 3, 4])
def test_no_pattern_of_phase_steps_is_tried_twice(size: int) -> None:
    """A step of 0 or π has no sense."""
    steps = [np.exp(1j * each).round(12) for each in phase_locked.phase_patterns(size, 5)]
    assert len({tuple(each.tolist()) for each in steps}) == len(steps)


def test_a_pattern_that_newton_does_not_lead_to_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    for found in (None, np.zeros(2 * (2 + 2 * phase_locked.MARGIN) + 1)):  # or to rest
        monkeypatch.setattr(phase_locked, "solve", lambda *_, found=found: found)
        assert phase_locked._distinct([np.zeros(1)], 2, A, B) == []


def test_breathers_are_the_same_but_for_their_phase_and_a_reflection() -> None:
    one = np.array([0.1, 2.0, -1.5j, 0.2 + 0.1j])
    for other in (one, one[::-1]):
        for turn in (0.7, -2.5):
            turned = other * np.exp(1j * turn)
            assert phase_locked._same(one, turned)
            assert not phase_locked._same(one, turned + np.array([0.0, 0.0, 0.0, 1e-4]))


@pytest.mark.parametrize("size", [2, 4, 8])
def test_a_family_is_of_quarter_turns_at_every_second_step(
    size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And of one step δ between them; either changes its sign at the middle or not at all."""
    asked: list[Any] = []
    monkeypatch.setattr(phase_locked, "_distinct", lambda *given: asked.append(given) or given[0])
    patterns: Any = phase_locked.family(size, A, B)
    assert asked[0][1:] == (size, A, B)
    for steps in patterns:
        assert steps.shape == (size - 1,)
        assert np.abs(steps[1::2]) == pytest.approx(0.5 * np.pi)
        assert np.ptp(np.abs(steps[::2])) == 0.0
        right = steps[(size - 1) // 2 :]
        left = steps[: (size - 1) // 2]
        for half in (left, right):
            assert all(np.ptp(half[begin::2]) == 0.0 for begin in range(min(2, half.size)))
    deltas = sorted({float(abs(steps[0])) for steps in patterns})
    assert deltas == pytest.approx(np.linspace(0.0, np.pi, 25).tolist())
    signs = {tuple(np.sign(steps)) for steps in patterns if 0.1 < abs(steps[0]) < 3.0}
    assert len(signs) == {2: 2, 4: 8, 8: 8}[size]


@pytest.mark.parametrize("size", [2, 6])
def test_a_step_in_the_middle_of_a_mirrored_pattern_is_zero_or_half_a_turn(
    size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whichever of the two is nearer to the other steps δ; of two sites it is the only step."""
    monkeypatch.setattr(phase_locked, "_distinct", lambda patterns, *_: patterns)
    patterns: Any = phase_locked.family(size, A, B)
    middle = [(steps[0], steps[size // 2 - 1]) for steps in patterns]
    mirrored = [(abs(delta), step) for delta, step in middle if step in (0.0, np.pi)]
    assert len(mirrored) >= len(patterns) // 2
    assert {step for _, step in mirrored} == {0.0, np.pi}
    assert all(abs(delta - step) <= 0.5 * np.pi for delta, step in mirrored)


def test_growth_of_mirrored_perturbations_is_that_of_eigenvectors_that_are_mirrored(
    short: int,
) -> None:
    u = phase_locked.outward_breather(3, 0.05, A, B)
    sites = 3 + 2 * short
    rates, vectors = np.linalg.eig(phase_locked.jacobian(u, 0.05, A, B)[:-1, :-1])
    both = vectors.reshape(2, sites, -1)
    even = np.abs(both - both[:, ::-1]).max(axis=(0, 1)) < 1e-6
    odd = np.abs(both + both[:, ::-1]).max(axis=(0, 1)) < 1e-6
    assert (even.sum(), odd.sum()) == (2 * ((sites + 1) // 2), 2 * (sites // 2))
    grows = [np.delete(each, np.argmin(np.abs(each))).real.max() for each in (rates, rates[even])]
    assert phase_locked.growth_rate(u, 0.05, A, B) == pytest.approx(grows[0], abs=1e-10)
    mirrored = phase_locked.growth_rate(u, 0.05, A, B, mirrored=True)
    assert mirrored == pytest.approx(grows[1], abs=1e-10)
    assert abs(grows[0] - grows[1]) > 1e-4


def test_growth_of_mirrored_perturbations_of_an_even_number_of_sites(short: int) -> None:
    """Made up: any mirror-symmetric state, and its eigenvectors that are mirrored."""
    sites = 2 + 2 * short
    half = np.random.default_rng(5).normal(size=(2, sites // 2))
    u = np.append(np.hstack([half, half[:, ::-1]]).ravel(), 0.3)
    rates, vectors = np.linalg.eig(phase_locked.jacobian(u, 0.4, A, B)[:-1, :-1])
    both = vectors.reshape(2, sites, -1)
    even = rates[np.abs(both - both[:, ::-1]).max(axis=(0, 1)) < 1e-6]
    assert even.size == sites
    expected = np.delete(even, np.argmin(np.abs(even))).real.max()
    found = phase_locked.growth_rate(u, 0.4, A, B, mirrored=True)
    assert found == pytest.approx(expected, abs=1e-10)


def test_a_breather_is_followed_to_the_coupling_that_is_asked_for(
    short: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    (one,) = phase_locked.locked_breathers(1, A, B)
    for c in (0.06, 0.03, 0.02):
        found = phase_locked.follow_to(one, c, A, B)
        u = np.concatenate([found.phi.real, found.phi.imag, [found.omega]])
        assert np.abs(phase_locked.residual(u, c, A, B)).max() < 1e-10
        assert found.c == c
    asked: list[Any] = []
    with monkeypatch.context() as patched:
        patched.setattr(
            phase_locked, "_solved_along", lambda u, c, *_: asked.append(np.diff(c)) or u
        )
        for c_end in (0.15, 0.001):
            phase_locked.follow_to(found, c_end, A, B)
            phase_locked.outward_breather(5, c_end, A, B)
    assert max(np.abs(each).max() for each in asked) < 1.2 * phase_locked.LONGEST
    near = phase_locked.follow_to(found, c + 0.001, A, B)  # nearer than the longest step
    u = np.concatenate([near.phi.real, near.phi.imag, [near.omega]])
    assert np.abs(phase_locked.residual(u, near.c, A, B)).max() < 1e-10
    for c in (0.02, 0.03, 0.0305, 0.05):  # also below where branches start, and hardly above it
        outward = phase_locked.outward_breather(5, c, A, B)
        assert np.abs(phase_locked.residual(outward, c, A, B)).max() < 1e-10
    phi = outward[: 5 + 2 * short] + 1j * outward[5 + 2 * short : -1]
    assert np.abs(phi) == pytest.approx(np.abs(phi[::-1]), abs=1e-10)
    steps = np.angle(phi[1:] / phi[:-1])[short:-short] / np.pi
    assert steps == pytest.approx([-0.5, -0.5, 0.5, 0.5], abs=0.05)


def test_a_breather_is_followed_whatever_its_phase(short: int) -> None:
    (one,) = phase_locked.locked_breathers(1, A, B)
    for turn in (0.7, -2.5):
        u = phase_locked._unknowns(replace(one, phi=one.phi * np.exp(1j * turn)))
        assert np.abs(phase_locked.residual(u, one.c, A, B)).max() < 1e-10


def test_a_branch_ends_where_its_last_breather_is(
    short: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At a fold, where the distance to the breather of the other branch goes like a root."""
    (one,) = phase_locked.locked_breathers(1, A, B)
    growth, of = phase_locked.growth_rate, set()
    monkeypatch.setattr(
        phase_locked, "growth_rate", lambda u, *of_: (of.add(of_[1:]), growth(u, *of_))[1]
    )
    branch = phase_locked.follow(one, A, B)
    assert of == {(A, B)}
    last = branch.last
    u = np.concatenate([last.phi.real, last.phi.imag, [last.omega]])
    assert np.abs(phase_locked.residual(u, last.c, A, B)).max() < 1e-9
    assert 0.0 <= branch.c_end - last.c < 1e-6
    assert last.growth == pytest.approx(phase_locked.growth_rate(u, last.c, A, B), abs=1e-12)
    singular = np.linalg.svd(phase_locked.jacobian(u, last.c, A, B), compute_uv=False)
    start = np.concatenate([one.phi.real, one.phi.imag, [one.omega]])
    before = np.linalg.svd(phase_locked.jacobian(start, one.c, A, B), compute_uv=False)
    assert singular[-1] < 0.02 * before[-1]
    ((begin, end),) = branch.stable  # but for the last steps, where rounding is seen
    assert begin == one.c
    assert 0.999 * last.c < end <= last.c


def test_newton_finds_a_breather_from_far_off_too(short: int) -> None:
    """Steps are shortened until the residual falls."""
    (one,) = phase_locked.locked_breathers(1, A, B)
    true = np.concatenate([one.phi.real, one.phi.imag, [one.omega]])
    turned = true[: one.phi.size] + 1j * true[one.phi.size : -1]
    turned *= np.exp(-1j * np.angle(turned[short]))
    true[:-1] = np.concatenate([turned.real, turned.imag])
    rng = np.random.default_rng(3)

    def size(u: np.ndarray) -> float:
        return float(np.linalg.norm(phase_locked.residual(u, one.c, A, B)))

    reached = []
    for _ in range(200):
        guess = true + 0.5 * rng.normal(size=true.size)
        step = np.linalg.solve(
            phase_locked.jacobian(guess, one.c, A, B), phase_locked.residual(guess, one.c, A, B)
        )
        whole = guess - min(1.0, 0.5 / float(np.abs(step).max())) * step
        if size(whole) > size(guess):  # the first step leads away
            reached.append(phase_locked.solve(guess, one.c, A, B))
    exact = next(u for u in reached if u is not None)
    again = phase_locked.solve(exact, one.c, A, B, rounds=1)
    assert again is not None
    assert np.array_equal(again, exact)  # no step is taken from a solution
    assert len(reached) >= 2
    assert all(size(u) < 1e-10 for u in reached if u is not None)
    assert any(u is not None for u in reached)


@pytest.mark.parametrize("jump", [0.2, -0.2])
def test_a_branch_is_followed_along_its_line_and_not_across_a_gap(
    jump: float, short: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Made-up solutions on a line in c, of which one unknown jumps at c = 0.1."""
    (one,) = phase_locked.locked_breathers(1, A, B)
    first = phase_locked._unknowns(one)
    slope = 0.1 * np.cos(np.arange(first.size))
    asked: list[float] = []

    def on_the_line(guess: np.ndarray, c: float, *_: object) -> np.ndarray:
        found: np.ndarray = first + slope * (c - one.c)
        if c < 0.1:
            asked.append(float(np.abs(guess - found).max()))
            return found
        return found + jump * (np.arange(first.size) == 2)

    monkeypatch.setattr(phase_locked, "solve", on_the_line)
    branch = phase_locked.follow(one, A, B)
    assert branch.c_end == pytest.approx(0.1, abs=1e-7)
    assert max(asked[1:]) < 1e-12  # from the second step on each is where two before lead


@pytest.mark.parametrize(
    ("growths", "ranges"),
    [
        ([], ()),
        ([-1.0], ((0.0, 0.0),)),
        ([1.0, 1.0], ()),
        ([-1.0, -1.0, 1.0, -1.0, -1.0], ((0.0, 1.0), (3.0, 4.0))),
        ([1.0, -1.0, 0.0, 1.0, -1.0], ((1.0, 2.0), (4.0, 4.0))),
    ],
)
def test_ranges_of_stability_are_from_first_to_last_of_what_is_stable(
    growths: list[float], ranges: tuple[tuple[float, float], ...]
) -> None:
    history = [(float(c), growth) for c, growth in enumerate(growths)]
    assert phase_locked._ranges(history) == ranges


# --------------------------------------------------------------------- the front of (44), and r


def test_the_sum_by_quadrature_has_a_tolerance_of_its_own() -> None:
    """That of scipy, about 1e-8; at c = 0, where Σ = 0."""
    value, error = piecewise.sum_by_quadrature(1.0, 0.0)
    assert abs(value) <= error < 1e-7


@pytest.mark.parametrize("v", [0.01, 0.3])
def test_the_error_of_the_quadrature_counts_what_is_beyond_its_end(v: float) -> None:
    """At c = 0, where A = 1/2 and Σ = 0."""
    value, error = piecewise.sum_on_the_line(v, 0.0)
    assert abs(value) <= error < 1e-5


@pytest.mark.parametrize("c", [0.1, 0.3, 3.0])
def test_what_the_quadrature_leaves_out_is_bounded_by_the_largest_damping(
    c: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """max|A|²/(3v⁴K³) beyond K; what is added for 1/(v²K) says where K is."""
    monkeypatch.setattr("scipy.integrate.quad", lambda *_, **__: (0.0, 0.0))
    v = 2.0
    value, error = piecewise.sum_on_the_line(v, c)
    K = 1.0 / (np.pi * v * (value.real + 1.0))
    largest = np.max(np.abs(0.5 - 1j * c * (1.0 - np.cos(np.linspace(0.0, np.pi, 101)))) ** 2)
    assert error >= (1.0 - 1e-9) * v / np.pi * largest / (3.0 * v**4 * K**3)


def test_roots_are_zeros_of_the_dispersion_relation_and_its_slope_is_a_difference() -> None:
    v, c = 0.3, 0.5
    with mp.workdps(30):
        for k in labelled_roots(v, c, np.arange(-3, 4), True).k.tolist():
            assert abs(piecewise.dispersion(v, c, mp.mpc(k))) < 1e-13
        for k in (mp.mpc(1, 2), mp.mpc(-3, 0.5)):
            ahead, behind = (piecewise.dispersion(v, c, k + s * mp.mpf("1e-9")) for s in (1, -1))
            slope = piecewise.dispersion_slope(v, c, k)
            assert abs((ahead - behind) / mp.mpf("2e-9") - slope) < 1e-15


@pytest.mark.parametrize("eta", [1e-30, 1e-12, 0.03125, 0.08, 0.125])
def test_the_threshold_ratio_gives_eta_back_to_all_its_digits(eta: float) -> None:
    """η = r²/2(1 + r²)², from sum and product of the squares of both cycles."""
    with mp.workdps(30):
        r = piecewise.threshold_ratio(eta)
        assert abs(r**2 / (2 * (1 + r**2) ** 2) / mp.mpf(eta) - 1) < 1e-28


# ----------------------------------------------------------------- breathers in extended precision


@pytest.mark.parametrize("start", [1.0, 3.0, -1.0, -3.0])
def test_a_root_is_approached_from_either_side(start: float) -> None:
    """√2 and -√2 to the last digit of extended precision, by steps of either sign."""
    root, _ = precise_breather._newton(lambda x: x * x - 2, extrapolation.extended([start]))
    true = np.copysign(np.sqrt(np.longdouble(2)), root[0])
    assert abs(root[0] - true) <= 2 * np.finfo(np.longdouble).eps
    assert root[0] * start > 0


def test_a_state_is_fixed_in_phase_at_its_largest_site_whatever_its_phase_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The largest of |φ|, not of its real part."""
    asked: list[int] = []
    defect = precise_breather._defect

    def noted(x: Any, eta: float, c: Any, centre: int) -> Any:
        asked.append(centre)
        return defect(x, eta, c, centre)

    monkeypatch.setattr(precise_breather, "_defect", noted)
    phi = np.array([1.0 + 0j, -3.0 + 0j, 1.0 + 0j])
    for find in (precise_breather.locked_state, precise_breather.locked_fold):
        asked.clear()
        with suppress(NoReferenceError):
            find(0.05, 5.0, phi, 3.0)
        assert set(asked) == {1}


def test_the_fold_is_as_uncertain_as_roundings_at_its_own_coupling_make_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    eta, chain = 0.05, VdpChain(a=1.0, b=0.05, c=1.0, eps=0.01, sites=3)
    fold = solve_envelope_breather(chain, Nucleus(1)).fold
    near = solve_envelope_breather(chain.replace(c=0.999 * fold), Nucleus(1))
    asked = []

    def noted(x: Any, *given: float) -> Any:
        asked.append(given)
        return roundings(x, *given)

    roundings = precise_breather._rounding
    monkeypatch.setattr(precise_breather, "_rounding", noted)
    found = precise_breather.locked_fold(eta, fold, near.waves, float(near.unknowns[-1]))
    assert asked == [(eta, pytest.approx(fold, rel=1e-8))]
    # Where a matrix maps to zero from the left, its equation moves with c alone.
    keep, whole = precise_breather._mirrored(3)
    x, c = found.value[:-1], found.value[-1]

    def locked(x: Any, c: Any) -> Any:
        return precise_breather._defect(x[whole], eta, c, 1)[keep]

    h = extrapolation.extended(1e-6 * np.eye(keep.size))
    slopes = [(locked(x[keep] + each, c) - locked(x[keep] - each, c)) / 2e-6 for each in h]
    left = np.linalg.svd(np.array(slopes).T.astype(float))[0][:, -1]
    by_c = (locked(x[keep], c + 1e-6) - locked(x[keep], c - 1e-6)).astype(float) / 2e-6
    expected = np.abs(left) @ roundings(x, eta, float(c))[keep] / abs(left @ by_c)
    assert found.uncertainty == pytest.approx(expected, rel=1e-2)
    assert 0.0 < found.uncertainty < 1e-15


def test_a_site_alone_is_as_uncertain_as_its_roundings_over_the_slope_of_its_damping() -> None:
    """(1 - 3r²/4 + 5ηr⁴/8)/2 at the outer cycle; there Ω = 0, uncertain by roundings over r."""
    eta = 0.08
    found = precise_breather.locked_state(eta, 0.0, np.array([4.5 + 0j]), 0.0)
    r = float(found.value[0])
    slope = 0.5 * (1.0 - 0.75 * r**2 + 0.625 * eta * r**4)
    terms = r * (1.0 + r**2 / 4.0 + eta * r**4 / 8.0)
    roundings = 10.0 * float(np.finfo(np.longdouble).eps) * terms
    assert found.uncertainty == pytest.approx(roundings * max(1.0 / slope, 1.0 / r), rel=1e-6)


def test_roundings_of_a_state_add_up_whatever_their_signs(monkeypatch: pytest.MonkeyPatch) -> None:
    inverse = np.array([[1.0, -1.0, 0.5], [0.0, 2.0, 0.0], [-3.0, 0.0, 0.0]])
    monkeypatch.setattr(precise_breather, "_newton", lambda *_: (np.zeros(3), inverse))
    monkeypatch.setattr(precise_breather, "_rounding", lambda *_: np.array([1.0, 1.0, 4.0]))
    found = precise_breather.locked_state(0.08, 0.1, np.array([1.0 + 0j]), 0.0)
    assert found.uncertainty == 4.0


def test_roundings_of_a_state_are_larger_than_those_of_each_of_its_terms() -> None:
    """Of doubles in place of long doubles, scaled: what one rounding of each operation changes."""
    rng = np.random.default_rng(6)
    ratio = float(np.finfo(float).eps / np.finfo(np.longdouble).eps)
    for omega, c, size in itertools.product((0.0, 0.3, -40.0), (0.0, 0.4, 1e3), (0.01, 1.0, 30.0)):
        x = np.array([*size * rng.normal(size=8), omega])
        exact = precise_breather._defect(x.astype(np.longdouble), 0.05, c, 2)
        rounded = precise_breather._defect(x, 0.05, c, 2)
        bound = ratio * precise_breather._rounding(x, 0.05, c)
        assert np.all(np.abs(rounded - exact) <= bound)
        # Terms that are turned into each other by Ω are as large as Ω.
        phi = x[:4] + 1j * x[4:8]
        assert np.all(bound[:4] >= np.finfo(float).eps * np.abs(omega * phi))


def test_roundings_of_a_small_amplitude_are_those_of_the_neighbour_that_pulls_it() -> None:
    rng = np.random.default_rng(7)
    ratio = float(np.finfo(float).eps / np.finfo(np.longdouble).eps)
    for _ in range(20):
        x = np.array([*rng.normal(size=4) * [1.0, 1e-9, 1e-9, 1e-9], *np.zeros(4), 0.1])
        exact = precise_breather._defect(x.astype(np.longdouble), 0.05, 0.4, 0)
        rounded = precise_breather._defect(x, 0.05, 0.4, 0)
        bound = ratio * precise_breather._rounding(x, 0.05, 0.4)
        assert np.all(np.abs(rounded - exact) <= bound)


@pytest.mark.parametrize("sites", [1, 2, 3, 4])
def test_a_mirrored_state_is_known_from_one_half_of_it(sites: int) -> None:
    """The amplitudes of one half with its middle, their phases, and Ω; each of them counts."""
    keep, whole = precise_breather._mirrored(sites)
    rng = np.random.default_rng(8)
    re, im = (each + each[::-1] for each in rng.normal(size=(2, sites)))
    x = np.concatenate([re, im, [0.7]])
    assert np.array_equal(x[keep][whole], x)
    assert sorted(set(whole.tolist())) == list(range(keep.size))


def test_after_each_step_of_a_reference_the_arrivals_so_far_are_shown() -> None:
    seen: list[tuple[float, np.ndarray]] = []
    found = passages.arrivals_by_scipy(
        lambda t, y: np.ones(3),
        np.array([0.0, -1.0, 0.7]),
        amplitude=lambda y: y,
        level=0.5,
        watched=slice(0, 3),
        rtol=1e-9,
        atol=1e-9,
        each_step=lambda t, times: seen.append((t, times.copy())),
    )
    assert found == pytest.approx([0.5, 1.5, 0.0], rel=1e-9)  # the last is above it at the start
    for t, times in seen:
        assert np.isnan(times).tolist() == (found > t).tolist()
    assert len(seen) > 1
    assert np.all(np.diff([t for t, _ in seen]) > 0.0)
    assert seen[-1][1].tolist() == found.tolist()


def test_the_pace_of_a_run_is_asked_for_at_the_part_of_it_that_is_done(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[float] = []
    monkeypatch.setattr(pace.Pace, "check", lambda _, part: asked.append(part))
    rate = pace.paced(lambda t, y: -y, 4.0)
    assert [rate(t, 2.0) for t in (0.0, 1.0, 4.0)] == [-2.0, -2.0, -2.0]
    assert asked == [0.0, 0.25, 1.0]
    pace.paced(lambda t, y: -y, -4.0)(-1.0, 2.0)  # backwards
    assert asked[3:] == [0.25]


def test_intervals_have_the_weights_that_are_said() -> None:
    """Of three, s = 1/4, 1/2 and 3/4; those of n² lie evenly on either side of their middle."""
    middle = math.exp(-4.0) / (math.exp(-4.0) + 2.0 * math.exp(-16.0 / 3.0))
    assert passages.mean_interval(np.array([0.0, 1.0, 3.0, 4.0])) == pytest.approx(1.0 + middle)
    assert passages.mean_interval(np.arange(10.0) ** 2) == pytest.approx(9.0, rel=1e-12)


def test_a_site_passes_a_level_when_it_first_exceeds_it() -> None:
    """Of sin(t - n) the level ½ is passed at n + π/6, and again after each turn."""
    t = np.linspace(0.0, 14.0, 281)
    run = SimpleNamespace(t=t, y=_waves(t), sol=_waves)
    assert passages.passage_velocity(run, range(3), 0.5) == pytest.approx(1.0, rel=1e-9)


def _waves(t: Any) -> Any:
    return np.sin(np.maximum(np.subtract.outer(t, np.arange(3.0)).T, 0.0))


def test_a_rate_that_is_asked_too_slowly_is_no_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "MAX_SECONDS", -1.0)
    with pytest.raises(pace.TooSlowError):
        pace.paced(lambda t, y: -y, 1.0)(0.5, 2.0)


def test_a_step_that_overflows_or_has_no_known_error_is_a_tenth_next_time() -> None:
    for error, allowed in ((math.inf, 1.0), (math.nan, 1.0), (1.0, math.inf), (math.inf, math.inf)):
        assert extrapolation._change(error, allowed) == 0.1


def test_sites_of_a_piecewise_ring_are_pulled_by_neighbours_across_its_end() -> None:
    phi = np.exp(1j * np.arange(5.0))
    excited = np.arange(5) < 2
    found = equations.piecewise_rate(0.3, excited, 0.0, 0.0, ring=True)(0.0, phi)
    pull = 2.0 * phi - np.roll(phi, 1) - np.roll(phi, -1)
    assert found == pytest.approx(0.15j * pull - 0.5 * phi + 0.5 * excited, rel=1e-12)
