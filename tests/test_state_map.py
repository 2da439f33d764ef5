"""The state map: labels against independent runs, symmetries, boundaries, the command line."""

from __future__ import annotations

import inspect
import json
import math
import re
import shlex
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks.steppers.fixed import fixed_steps
from fronts.cli import main
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import ParameterError
from verification.execution.points import Point
from verification.execution.sweep import part_path, sweep
from verification.execution.table import Table
from verification.maps import smooth_rules, state_run, vdp_rules
from verification.maps import state_map as state_map_module
from verification.maps.boundary import NOTHING, Bisection, boundary_lines
from verification.maps.friction_rules import find_friction_state
from verification.maps.rules import RULES, StateRules
from verification.maps.smooth_rules import HOLD, SAMPLES, SMALL, WINDOW, find_smooth_state
from verification.maps.state import FoundState, Reason, State
from verification.maps.state_map import StateMap, boundary_path, compare, state_map
from verification.maps.state_run import LONGEST, at_rest_for_ever, run_to_state
from verification.maps.task import StateTask, state_points
from verification.maps.vdp_rules import (
    DISPLACEMENT,
    FIGURE_15,
    find_vdp_state,
    level_of,
    positive_damping_square,
)
from verification.references.equations import amplitude_of, as_state, averaged_rate, full_rate
from verification.runs.excite import excite
from verification.runs.simulate import simulate
from verification.steppers.active import FREE

FULL, ENVELOPE = (StateTask(chain=each) for each in (FIGURE_15, FIGURE_15.averaged()))
FULL_OF_LARGER_EPS = StateTask(chain=replace(FIGURE_15, eps=0.05))
"""A front of it settles five times sooner, in the time of the equation (8)."""


def _chain_by_scipy(
    task: StateTask, eta: float, c: float, times: NDArray[np.float64], tolerance: float = 1e-9
) -> NDArray[np.float64]:
    """Return amplitudes, shape (M, N), at slow times, by scipy on (8) or (43)."""
    chain = task.at({"eta": eta, "c": c})
    by_average = isinstance(chain, AveragedChain)
    start = np.zeros(chain.sites, dtype=complex)
    start[-1] = 1j * DISPLACEMENT
    clock = times if by_average else times / chain.eps
    run = solve_ivp(
        averaged_rate(chain) if by_average else full_rate(chain),
        (0, clock[-1]),
        start if by_average else as_state(start),
        method="DOP853",
        rtol=tolerance,
        atol=1e-2 * tolerance,
        t_eval=clock,
    )
    assert run.success
    return (np.abs(run.y) if by_average else amplitude_of(run.y)).T


@pytest.mark.parametrize(
    ("task", "eta", "c", "label"),
    [
        (ENVELOPE, 0.03, 0.6, State.FRONT),
        (ENVELOPE, 0.09, 1.0, State.FRONT),
        (ENVELOPE, 0.05, 0.15, State.FRONT),
        (ENVELOPE, 0.03, 0.1, State.BREATHER),
        (ENVELOPE, 0.11, 0.35, State.BREATHER),
        (ENVELOPE, 0.11, 0.40, State.FIXED_POINT),
        (ENVELOPE, 0.12, 0.25, State.FIXED_POINT),
        (ENVELOPE, 0.14, 0.05, State.FIXED_POINT),
        (FULL_OF_LARGER_EPS, 0.03, 0.9, State.FRONT),
        (FULL, 0.14, 0.3, State.FIXED_POINT),
    ],
)
def test_a_label_holds_on_in_an_independent_run_long_after_it_was_given(
    task: StateTask, eta: float, c: float, label: State
) -> None:
    result = task(Point(eta=eta, c=c))
    assert result["label"] == label
    time = float(result["time"])
    # just beyond η = 1/8 the passage by the lost cycle alone takes ten units
    beyond = 25.0 if label is State.FIXED_POINT else 10.0
    longer = np.array([0.6 * time, max(time, 1e-3), 1.5 * time + 5.0, 2.0 * time + beyond])
    # All that is asked are levels and a hundredth of one: a tolerance of 1e-7 errs by some 1e-5.
    amplitude = _chain_by_scipy(task, eta, c, longer, tolerance=1e-7)
    level = level_of(task.at({"eta": eta, "c": c}).a, task.at({"eta": eta, "c": c}).b)
    above = np.count_nonzero(amplitude > level, axis=1)
    if label is State.FRONT:
        assert (above[1:] == 16).all()
    elif label is State.BREATHER:
        assert (above[1:] == result["above"]).all()
        # It was still from half of that time on: the rule asks for 1e-5 of the level in each
        # window of 5, and here are several, all of the same transient.
        assert np.ptp(amplitude, axis=0).max() < 1e-4 * level
    else:
        # small amplitudes decay like e^{-T/2}; the ripple of (8) is below one per cent there
        norms = np.linalg.norm(amplitude, axis=1)
        assert norms[3] < norms[2] * 1.01 < norms[1] * 1.01
        assert norms[3] < 0.05 * DISPLACEMENT


@pytest.mark.parametrize(
    ("eta", "c", "label"),
    [(0.05, 0.05, "breather"), (0.05, 0.3, "front"), (0.11, 0.5, "fixed point")],
)
def test_the_labels_of_the_full_equation_hold_for_the_taylor_stepper(
    eta: float, c: float, label: str
) -> None:
    result = FULL(Point(eta=eta, c=c))
    assert result["label"] == label
    chain = FULL.at({"eta": eta, "c": c})
    end = float(result["time"])
    run = simulate(
        chain,
        excite(chain, [16], 6.0),
        end / chain.eps,
        samples=301,
        tolerance=1e-8,
        estimate_error=False,
    )
    level = chain.unstable_amplitude
    if label == "front":
        # the arrival, the same again, and a step of at most 1.5
        assert run.arrivals[0] * chain.eps == pytest.approx(end / 2.0, abs=0.2)
    else:
        assert math.isnan(run.arrivals[0])
        assert np.count_nonzero(run.amplitude[-1] > level) == (1 if label == "breather" else 0)
        if label == "breather":
            # the last half: no change but the ripple of O(ε_eff) within a period
            assert np.ptp(run.amplitude[150:, -1]) < 0.1 * chain.stable_amplitude


@pytest.mark.parametrize(
    ("eta", "c", "label"),
    [(0.03, 0.6, "front"), (0.03, 0.1, "breather"), (0.12, 0.3, "fixed point")],
)
def test_the_rules_of_any_smooth_chain_read_off_what_scipy_finds(
    eta: float, c: float, label: str
) -> None:
    """What they count, sites reached and sites above the unstable cycle, and when they stop."""
    chain = ENVELOPE.at({"eta": eta, "c": c})
    assert isinstance(chain, AveragedChain)
    found = find_smooth_state(chain, excite(chain, [16], DISPLACEMENT))
    times = np.arange(1, round(found.time * SAMPLES / WINDOW) + 1) * (WINDOW / SAMPLES)
    amplitude, level = _chain_by_scipy(ENVELOPE, eta, c, times), level_of(chain.a, chain.b)
    above = amplitude > level
    assert found.state.value == label
    assert found.reached == max(1, int(above.any(axis=0).sum()))  # the excited site is above
    assert found.above == int(above[-SAMPLES:].any(axis=0).sum())
    assert found.time >= HOLD * WINDOW
    if label != "fixed point":  # decided when nothing has changed for as long as before
        late = above[above.shape[0] // 2 :]
        assert np.array_equal(late.all(axis=0), late.any(axis=0))
    else:  # at the first window throughout which all is small
        before, last = np.split(amplitude[-2 * SAMPLES :], 2)
        assert last.max() < SMALL * level <= before.max()
    np.testing.assert_allclose(found.amplitude, amplitude[-1], atol=1e-4)


def test_the_compiled_run_follows_scipy() -> None:
    """Steps to a section, so that both right sides and the pair itself are compared."""
    task = ENVELOPE
    times = np.linspace(0.0, 20.0, 3)
    reference = _chain_by_scipy(task, 0.05, 0.4, times)
    chain = task.at({"eta": 0.05, "c": 0.4})
    start = np.zeros((2, 16))
    start[0, -1] = 6.0
    fixed_steps(chain, start, 0.01, 2000, 8)
    # scipy's relative tolerance of 1e-9 a step, over some hundred steps
    assert np.hypot(*start) == pytest.approx(reference[-1], abs=3e-7)


def test_the_energy_rule_is_never_wrong() -> None:
    """From any start below the bound, the energy of (8) falls; just beyond it, it may grow."""
    rng = np.random.default_rng(4)
    chain = FULL.at({"eta": 0.05, "c": 0.5})
    rest_bound = positive_damping_square(chain.a, chain.b)
    stiffness = chain.eps * chain.c
    for _ in range(20):
        state = rng.standard_normal((2, 16))
        # nearly all of the energy in one site, where the damping is the smallest
        state[:, 1:] *= 1e-3
        energy = (state**2).sum() + chain.eps * chain.c * (np.diff(state[0]) ** 2).sum()
        state *= math.sqrt(0.99 * rest_bound / energy)
        assert at_rest_for_ever(state.ravel(), stiffness, rest_bound)
        start = state[1] + 1j * state[0]
        run = simulate(chain, start, 200.0, samples=41, estimate_error=False, level=10.0)
        y = run.psi.imag
        energies = (run.amplitude**2).sum(1) + chain.eps * chain.c * (np.diff(y) ** 2).sum(1)
        assert (np.diff(energies) < 1e-7 * energies[0]).all()
        assert not at_rest_for_ever(1.02 * state.ravel(), stiffness, rest_bound)


@pytest.mark.parametrize("stiffness", [0.0, 0.5, 3.0])
def test_the_energy_is_that_of_all_sites_and_of_the_springs_between_neighbours(
    stiffness: float,
) -> None:
    """Σ(y² + w²) + κΣ(y_n - y_{n-1})², of whole numbers, and below its bound by however little."""
    for y, w in (([1.0, -3.0, 4.0], [2.0, 0.0, 5.0]), ([4.0], [3.0]), ([-2.0, 1.0], [0.0, 0.0])):
        state = np.array([*y, *w])
        twice = float(np.sum(state**2) + stiffness * np.sum(np.diff(y) ** 2))
        assert at_rest_for_ever(state, stiffness, np.nextafter(twice, np.inf))
        assert not at_rest_for_ever(state, stiffness, twice)
        assert not at_rest_for_ever(state, stiffness, 0.75 * twice)


@pytest.mark.parametrize("task", [ENVELOPE, FULL])
def test_labels_and_times_do_not_depend_on_the_sign_of_the_displacement(task: StateTask) -> None:
    for eta, c in ((0.05, 0.5), (0.1, 0.1), (0.12, 0.6)):
        chain = task.at({"eta": eta, "c": c})
        start = excite(chain, [16], 6.0)
        one, other = (find_vdp_state(chain, sign * start) for sign in (1, -1))
        assert one.state is other.state
        # The equations are odd, and so is every step, to the last bit; sections at y = 0 rising
        # come half a period later, which changes no window here.
        assert one.time == other.time


@pytest.mark.parametrize("task", [ENVELOPE, FULL])
def test_scaling_a_b_and_the_displacement_together_changes_nothing(task: StateTask) -> None:
    for eta, c in ((0.05, 0.5), (0.05, 0.1)):
        chain = task.at({"eta": eta, "c": c})
        # a = 2 makes the factor of the amplitude irrational, so that every number is rounded anew
        scaled = chain.replace(a=2.0, b=4.0 * chain.eta)
        first = find_vdp_state(chain, excite(chain, [16], 6.0))
        second = find_vdp_state(scaled, excite(scaled, [16], 6.0 * math.sqrt(chain.a / 2.0)))
        assert first.state is second.state
        # tolerance 1e-8 a step, and growth from the nucleus to the front or breather
        assert first.time == pytest.approx(second.time, rel=1e-6)


@pytest.mark.parametrize(("c", "label"), [(0.4, "undecided"), (0.5, "front")])
def test_a_chain_that_was_filled_once_is_no_front_unless_it_stays_so(c: float, label: str) -> None:
    """By scipy on (43) from the same start: both are filled; the one loses most of its sites."""
    times = np.arange(0.0, 400.0, 0.5)
    task = StateTask(chain=FIGURE_15.averaged())
    amplitude = _chain_by_scipy(task, 0.09, c, times, tolerance=1e-7)
    chain = task.at({"eta": 0.09, "c": c})
    above = np.count_nonzero(amplitude > level_of(chain.a, chain.b), axis=1)
    filled = int(above.argmax())
    assert above[filled] == chain.sites
    assert (above[filled:].min() >= chain.sites / 2) is np.bool_(label == "front")
    assert task(Point(eta=0.09, c=c))["label"] == label


def test_a_late_label_does_not_count_and_a_small_perturbation_can_undecide() -> None:
    point = Point(eta=0.05, c=0.15)
    sure = ENVELOPE(point)
    assert (sure["label"], sure["why"]) == ("front", "decided")
    end = 2.0 * float(sure["time"])
    assert replace(ENVELOPE, end=0.98 * end)(point)["why"] == "end time"
    assert replace(ENVELOPE, end=1.02 * end)(point)["label"] == "front"
    # 1e-2 of the displacement is enough beside a boundary, bisected to much less than that
    lines = boundary_lines(
        sweep(ENVELOPE, state_points(ENVELOPE, {"eta": [0.11], "c": [0.35, 0.4]}), workers=1),
        ["eta", "c"],
    )
    edge = sweep(Bisection(ENVELOPE.alone(), 1e-4), lines, workers=1)
    reasons = {
        replace(ENVELOPE, perturbation=1e-2, seed=seed)(
            Point(eta=0.11, c=float(edge["at"][0]) + shift)
        )["why"]
        for seed in range(4)
        for shift in (-5e-4, 5e-4)
    }
    assert "perturbation" in reasons


@pytest.mark.parametrize(
    ("eta", "c"),
    # on either side of the boundaries of the map of Fig. 15, and an undecided point between
    [(0.01, 0.1), (0.01, 0.15), (0.06, 0.15), (0.06, 0.2), (0.08, 0.2), (0.11, 0.35), (0.11, 0.4)],
)
def test_the_chain_needs_no_more_digits_for_a_label(eta: float, c: float) -> None:
    """No label of the 280 points of that map differs, either."""
    point = Point(eta=eta, c=c)
    assert FULL.local_error == 1e-6
    assert FULL(point)["label"] == replace(FULL, tolerance=1e-8)(point)["label"]


def test_of_the_averaged_chain_only_amplitudes_decide_whether_it_rests() -> None:
    """Σ|φ|² is below the unstable cycle's at the start, so it rests; (8) has springs besides."""
    task = StateTask(chain=FIGURE_15.averaged()).at({"eta": 0.05, "c": 0.3})
    size = math.sqrt(0.9 / task.sites) * level_of(task.a, task.b)
    alternating = np.zeros((2, task.sites))
    alternating[0] = size * (-1.0) ** np.arange(task.sites)
    found = find_vdp_state(task, alternating)
    assert (found.state, found.time, found.steps) == (State.FIXED_POINT, 0.0, 0)
    stiff = StateTask(chain=FIGURE_15).at({"eta": 0.05, "c": 1e3})
    assert find_vdp_state(stiff, alternating, end=1.0).steps > 0


def test_boundaries_are_bisected_to_a_sixteenth_of_the_spacing_if_nothing_else_is_said() -> None:
    chain = FIGURE_15.averaged()
    found = state_map(chain, eta=[0.05], c=[0.1, 0.14], workers=1)
    (row,) = found.boundary.rows()
    width = float(row["high"]) - float(row["low"])
    assert width == pytest.approx(0.04 / 16.0, rel=1e-9)


def test_the_point_of_a_grid_that_the_table_has_not_is_named() -> None:
    points = [{"x": x, "y": y} for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0)]
    for missing in range(1, 5):  # not at a corner whose values would be missing as well
        table = sweep(
            lambda p: {"label": "in" if p["x"] < 0.5 else "out"},
            [each for at, each in enumerate(points) if at != missing],
            workers=1,
        )
        here = (points[missing]["x"], points[missing]["y"])
        with pytest.raises(ValueError, match=re.escape(f"the point {here} of the grid")):
            boundary_lines(table, ["x", "y"])


def test_bisection_finds_both_sides_of_a_third_label() -> None:
    def task(point: Point) -> dict[str, str]:
        x = point.number("x")
        return {"label": "a" if x < 0.3 else "b" if x < 0.65 else "c"}

    lines = boundary_lines(sweep(task, {"x": [0.0, 1.0, 2.0]}, workers=1), ["x"])
    assert len(lines) == 1
    row = next(sweep(Bisection(task, 1e-6), lines, workers=1).rows())
    assert row["low"] == pytest.approx(0.3, abs=1e-6)
    assert row["high"] == pytest.approx(0.65, abs=1e-6)
    assert row["between"] == "b"
    # two searches of 20 halvings, some of them shared
    assert row["runs"] <= 40

    narrow = Bisection(lambda p: {"label": "a" if p["x"] < 0.3 else "c"}, 1e-3)
    row = next(sweep(narrow, lines, workers=1).rows())
    assert float(row["low"]) < 0.3 <= float(row["high"])
    assert float(row["high"]) - float(row["low"]) <= 1e-3
    assert row["between"] == NOTHING


@pytest.mark.parametrize("shift", [0.0, 4e-4, -4e-4, 3e-3, -0.02, 0.31, -0.29])
@pytest.mark.parametrize("third", [0.0, 0.2])
def test_a_prediction_saves_runs_and_decides_nothing(shift: float, third: float) -> None:
    """Its boundary is off by a shift; what is stated is of the task, and as close as without it."""
    calls: list[float] = []

    def made(off: float, noted: list[float]) -> Any:
        def task(point: Point) -> dict[str, str]:
            x = point.number("x")
            noted.append(x)
            return {"label": "a" if x < 0.3 + off else "b" if x < 0.3 + third + off else "c"}

        return task

    task, width = made(0.0, calls), 1e-3
    line = Point(x=0.0, along="x", until=1.0, label_low="a", label_high="c")
    plain = Bisection(task, width)(line)
    calls.clear()
    led = Bisection(task, width, predictor=made(shift, []))(line)
    for row in (plain, led):
        assert float(row["low"]) < 0.3
        assert float(row["high"]) >= 0.3 + third
        slack = float(row["high"]) - float(row["low"]) - third
        assert slack <= (2.0 if third else 1.0) * width
        assert row["between"] == ("b" if third else NOTHING)
    assert led["runs"] == len(set(calls))
    assert led["runs"] <= 2.5 * float(plain["runs"])
    if abs(shift) < 4.0 * width:
        assert float(led["runs"]) < float(plain["runs"])
    if abs(shift) < 0.45 * width:
        assert led["runs"] == (4 if third else 2)


@pytest.mark.parametrize("at", [2e-4, 1.0 - 2e-4])
def test_a_prediction_near_an_end_asks_for_nothing_beyond_it(at: float) -> None:
    """There the map ends, and so may the range of a parameter."""

    def task(point: Point) -> dict[str, str]:
        x = point.number("x")
        assert 0.0 <= x <= 1.0
        return {"label": "a" if x < at else "c"}

    line = Point(x=0.0, along="x", until=1.0, label_low="a", label_high="c")
    found = Bisection(task, 1e-3, predictor=task)(line)
    assert found["low"] < at <= found["high"] <= found["low"] + 1e-3  # type: ignore[operator]


def test_lines_of_a_grid_of_any_number_of_axes_are_along_what_changes() -> None:
    def task(point: Point) -> dict[str, str]:
        return {"label": "in" if point.number("y") < 0.5 else "out"}

    axes = {name: [0.0, 1.0] for name in ("x", "y", "z")}
    lines = boundary_lines(sweep(task, axes, workers=1), [*axes])
    assert [(each["along"], each["y"], each["until"]) for each in lines] == [("y", 0.0, 1.0)] * 4
    with pytest.raises(ParameterError, match="tolerance of the boundary"):
        Bisection(task, 0.999e-9)
    found = Bisection(task, 1e-9, predictor=task)(lines[0])  # the finest that there is
    assert found["low"] < 0.5 <= found["high"] <= found["low"] + 1.001e-9


@pytest.mark.parametrize("full", [True, False])
def test_runs_of_a_map_miss_no_passage_and_hold_the_energy_of_the_springs(
    full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    chain = VdpChain(a=4, b=0.5, c=2.0, eps=0.01, sites=3)
    seen: list[float] = []
    run = state_run.SmoothIntegration

    def begun(*given: Any, longest_step: float, **options: Any) -> Any:
        seen.append(longest_step)
        return run(*given, longest_step=longest_step, **options)

    def rests(_: object, stiffness: float, __: float) -> bool:
        seen.append(stiffness)
        return True

    monkeypatch.setattr(state_run, "SmoothIntegration", begun)
    monkeypatch.setattr(state_run, "at_rest_for_ever", rests)
    found = find_vdp_state(chain if full else chain.averaged(), np.zeros((2, 3)))
    assert found.state is State.FIXED_POINT
    assert seen == ([LONGEST, 0.01 * 2.0] if full else [math.inf, 0.0])
    assert math.pi > LONGEST  # half of a period


@pytest.mark.parametrize("full", [True, False])
def test_the_rules_for_model_ii_are_in_slow_time_and_in_parts_of_the_unstable_cycle(
    full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Filled for T = 10, windows of T = 5, changes of 1e-5; no state of the second half."""
    given: dict[str, float] = {}
    monkeypatch.setattr(vdp_rules, "run_to_state", lambda *_, **numbers: given.update(numbers))
    whole = VdpChain(a=4, b=0.5, c=2.0, eps=0.01, sites=3)
    chain = whole if full else whole.averaged()
    find_vdp_state(chain, np.zeros((2, 3)), end=300.0)
    squares = np.roots([chain.b / 8.0, -chain.a / 4.0, 1.0])  # 1 - a|φ|²/4 + b|φ|⁴/8 = 0
    per_slow = 1.0 / whole.eps if full else 1.0
    times = {"hold": 10.0 * per_slow, "window": 5.0 * per_slow, "end": 150.0 * per_slow}
    level = math.sqrt(squares.min())
    rest = np.roots([chain.b, -chain.a, 1.0]).min() if full else level**2
    assert given == pytest.approx({
        "level": level, "settled": 1e-5 * level, "rest_bound": rest, "tolerance": 1e-8,
        "stiffness": whole.eps * chain.c if full else 0.0, **times,
    })  # fmt: skip


@pytest.mark.parametrize("rules", RULES.values(), ids=[kind.__name__ for kind in RULES])
def test_a_state_alone_is_found_as_accurately_as_in_a_map_and_for_as_long(
    rules: StateRules,
) -> None:
    usual = inspect.signature(rules.find).parameters
    assert rules.tolerances.low <= usual["tolerance"].default <= rules.tolerance
    assert usual["end"].default == rules.default_end


def test_a_point_at_which_two_starts_end_otherwise_is_undecided(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    states = iter([State.FRONT, State.BREATHER])

    def find(*_: object, **__: object) -> FoundState:
        return FoundState(
            state=next(states), reason=Reason.DECIDED, time=1.0, above=3, steps=5,
            amplitude=np.zeros(16), seconds=0.0,
        )  # fmt: skip

    rules = replace(RULES[VanDerPolChain], find=find)
    monkeypatch.setitem(RULES, VanDerPolChain, rules)
    row = ENVELOPE(Point(eta=0.05, c=0.1))
    assert (row["label"], row["why"], row["steps"]) == ("undecided", "perturbation", 10)


def test_a_point_tells_of_the_longer_run_and_of_the_amplitudes_of_the_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second start has the noise of the seed of the rules, the same each time."""
    starts: list[NDArray[np.float64]] = []

    def find(_: object, start: NDArray[np.float64], **__: object) -> FoundState:
        starts.append(start)
        return FoundState(
            state=State.FRONT, reason=Reason.DECIDED, time=float(len(starts)), above=3, steps=5,
            amplitude=np.full(16, float(len(starts))), seconds=0.0,
        )  # fmt: skip

    rules = replace(RULES[VanDerPolChain], find=find)
    monkeypatch.setitem(RULES, VanDerPolChain, rules)
    row = replace(ENVELOPE, amplitudes=True)(Point(eta=0.05, c=0.1))
    assert (row["time"], row["amplitude_time"], row["amplitude"][0]) == (2.0, 1.0, 1.0)
    assert "amplitude" not in ENVELOPE(Point(eta=0.05, c=0.1))  # unless it is asked for
    assert np.array_equal(starts[1], starts[3])
    assert 0.0 < np.abs(starts[1] - starts[0]).max() < 10.0 * ENVELOPE.perturbation * DISPLACEMENT


def test_runs_of_model_ii_are_as_accurate_as_the_second_start_is_near_the_first() -> None:
    assert FULL.local_error == FULL.perturbation == 1e-6
    assert ENVELOPE.local_error < FULL.local_error


def test_by_default_the_last_site_is_displaced_by_six_as_in_the_figure() -> None:
    for chain in (FIGURE_15, FIGURE_15.averaged()):
        start = vdp_rules.start(chain, None)
        assert start[0].tolist() == [0.0] * 15 + [6.0]
        assert not start[1].any()


def test_a_chain_that_is_more_than_half_filled_and_never_whole_is_no_front() -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.0, sites=4)
    found = run_to_state(
        chain,
        excite(chain, [1, 2, 3]),
        level=chain.unstable_amplitude,
        rest_bound=0.0,
        stiffness=0.0,
        hold=10.0,
        window=math.inf,
        settled=1e-5,
        end=50.0,
        tolerance=1e-8,
    )
    assert (found.state, found.reason) == (State.UNDECIDED, Reason.END_TIME)


def test_a_prediction_with_other_labels_at_the_ends_is_not_used() -> None:
    def task(point: Point) -> dict[str, str]:
        return {"label": "a" if point.number("x") < 0.3 else "c"}

    line = Point(x=0.0, along="x", until=1.0, label_low="a", label_high="c")
    other = Bisection(task, 1e-3, predictor=lambda _: {"label": "c"})
    assert other(line) == Bisection(task, 1e-3)(line)


def test_the_boundary_of_the_full_chain_begins_at_that_of_the_averaged_one() -> None:
    axes = {"eta": [0.11, 0.13], "c": [0.3]}
    found = state_map(FULL, refine=1.0 / 64.0, workers=1, **axes)
    (line,) = boundary_lines(found.states, ["eta", "c"])
    (row,) = found.boundary.rows()
    alone = Bisection(FULL.alone(), 1.0 / 64.0)(line)
    assert row["runs"] == 2
    assert alone["runs"] >= 6
    assert row["low"] <= alone["high"]
    assert alone["low"] <= row["high"]
    assert row["high"] - row["low"] <= 0.02 / 64.0


def test_the_maps_of_both_equations_agree() -> None:
    """That other processes give the same map is tested in tests/test_cluster.py."""
    points = state_points(FULL, {"eta": [0.03, 0.11], "c": [0.05, 0.3, 0.6]})
    full = sweep(FULL_OF_LARGER_EPS, points, workers=1)
    assert set(full["label"]) == {"front", "breather", "fixed point"}
    agreement = compare(full, sweep(ENVELOPE, points, workers=1))
    assert (agreement.same, agreement.total, agreement.contradicting) == (6, 6, 0)
    with pytest.raises(ValueError, match="same points"):
        compare(full, sweep(ENVELOPE, points[:3], workers=1))


@pytest.mark.parametrize(
    "make",
    [
        lambda: StateTask(chain=FIGURE_15, held="c"),
        lambda: StateTask(chain=FIGURE_15, end=1.0),
        lambda: StateTask(chain=FIGURE_15, seed=-1),
        lambda: StateTask(chain=FIGURE_15.replace(sites=1001)),
        lambda: StateTask(chain=FIGURE_15.replace(eps=1e-6)),
        lambda: StateTask(chain=FIGURE_15, displacement=1e6),
        lambda: StateTask(chain=FIGURE_15, tolerance=1e-2),
        lambda: StateTask(chain=FrictionChain(c=0.05, sites=7), tolerance=1e-3),
        lambda: StateTask(chain=FrictionChain(c=0.05, sites=7), tolerance=1e-13),
        lambda: find_vdp_state(FIGURE_15, np.zeros((2, 16)), end=0.0),
        lambda: state_points(FULL, {"eta": [0.0], "c": [0.1]}),
        lambda: state_points(FULL, {"eta": [0.1], "c": [-0.1]}),
        lambda: find_vdp_state(
            VdpChain(a=4, b=0.5, c=0.1, sites=3, ends=Ends.PERIODIC), np.zeros(3, dtype=complex)
        ),
    ],
)
def test_bad_parameters_are_refused(make: object) -> None:
    with pytest.raises(ParameterError):
        make()  # type: ignore[operator]


def test_a_refusal_names_the_value_that_was_given() -> None:
    with pytest.raises(ParameterError, match=r"^displacement = 200\b"):
        StateTask(chain=FIGURE_15, displacement=200.0)
    with pytest.raises(ParameterError, match=r"^part of the spacing, refine, = 3\b"):
        state_map(ENVELOPE, c=[0.1], refine=3.0)
    with pytest.raises(ParameterError, match=r"^part of the spacing, refine, = 1e-12\b.*0 for no"):
        state_map(ENVELOPE, c=[0.1, 0.6], eta=[0.03, 0.13], refine=1e-12, workers=1)
    with pytest.raises(ParameterError, match=r"^number of sites n = 1001\b"):
        StateTask(chain=FIGURE_15.replace(sites=1001))

    for chain in (FIGURE_15, OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.1)):
        with pytest.raises(ParameterError, match=r"^number of sites n = 1001\b"):
            StateTask(chain=chain.replace(sites=1001))


@pytest.mark.parametrize(
    ("chain", "usual", "shortest"),
    [
        (FIGURE_15, 2000.0, 40.0),
        (FrictionChain(c=0.0, sites=7), 20_000.0, 320.0),
        (OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.1, sites=7), 2000.0, 80.0),
    ],
)
def test_a_map_has_its_usual_end_and_a_shortest_one(
    chain: Any, usual: float, shortest: float
) -> None:
    """The shortest leaves a state time to hold in its first half."""
    assert StateTask(chain=chain).end_time == usual
    finds = {20_000.0: (find_friction_state,), 2000.0: (find_smooth_state, find_vdp_state)}
    for find in finds[usual]:
        given = inspect.signature(find).parameters
        assert (given["end"].default, given["tolerance"].default) == (usual, StateRules.tolerance)
    assert StateTask(chain=chain, end=shortest).end_time == shortest
    with pytest.raises(ParameterError, match="end time"):
        StateTask(chain=chain, end=0.999 * shortest)


def test_the_longest_time_of_a_map_is_that_of_its_slowest_point() -> None:
    found = state_map(ENVELOPE.alone(), c=[0.3, 0.6], eta=[0.12], refine=0.0, workers=1)
    times = [row["time"] for row in found.states.rows()]
    assert times[0] != times[1]
    assert found.to_dict()["longest_time"] == max(times)


def test_a_comparison_says_which_map_named_what() -> None:
    """The second map is of another displacement, which goes to rest."""
    one, other = (
        state_map(replace(ENVELOPE, displacement=y), c=[0.6], eta=[0.03], refine=0.0, workers=1)
        for y in (DISPLACEMENT, 0.1)
    )
    found = compare(one.states, other.states, ("eta", "c"))
    (row,) = found.differing
    assert (row["first"], row["second"]) == ("front", "fixed point")
    axes = one.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("coupling c", "η = b/a²")
    assert (found.same, found.total) == (0, 1)
    assert (row["eta"], row["c"]) == (0.03, 0.6)
    assert compare(one.states, one.states, ("eta", "c")).differing == ()
    elsewhere = state_map(ENVELOPE, c=[0.5], eta=[0.03], refine=0.0, workers=1)
    with pytest.raises(ValueError, match="same points"):
        compare(one.states, elsewhere.states, ("eta", "c"))


def test_the_command_writes_map_boundary_stamp_and_picture(tmp_path: Path, answered: Any) -> None:
    out, drawn = tmp_path / "map.csv", tmp_path / "map.png"
    line = (
        "map vdp --eta 0.03:0.13:6 --c 0.1:0.7:4 --model envelope --refine 0.25 "
        f"--out {out} --picture {drawn}"
    )
    answer = answered(line)
    assert sum(answer["counts"].values()) == answer["points"] == 24
    assert answer["agreement"] is None
    assert answer["held"] == {"b": 0.5, "eps": 0.01, "sites": 16, "ends": "free"}
    read = np.genfromtxt(out, names=True, delimiter=",", dtype=None, encoding="utf-8")
    assert read.size == 24
    assert read["eta"].max() == 0.13
    assert drawn.read_bytes().startswith(b"\x89PNG")
    edge = np.genfromtxt(
        tmp_path / "map-boundary.csv", names=True, delimiter=",", dtype=None, encoding="utf-8"
    )
    assert edge.size == answer["boundary_points"] > 5
    assert (edge["low"] <= edge["at"]).all()
    for table in ("map.csv", "map-boundary.csv"):
        comments = (tmp_path / table).read_text(encoding="utf-8").splitlines()[-3:]
        assert comments[0].startswith("# command: fronts map averaged --eta"), table
        assert "--out" not in comments[0]
    record = json.loads((tmp_path / "map.csv.json").read_text(encoding="utf-8"))
    assert record["parameters"]["chain"]["is"].endswith("AveragedChain")
    # again: nothing is left to compute
    assert answered(line + " --resume")["resumed"] == 24
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "map-boundary.csv",
        "map-boundary.csv.json",
        "map.csv",
        "map.csv.json",
        "map.png",
    ]


def test_the_command_compares_the_full_equation_with_the_envelope(answered: Any) -> None:
    answer = answered("map vdp --eta 0.05 --c 0.1:0.5:2 --refine 0 --workers 1")
    assert answer["counts"] == {"breather": 1, "front": 1}
    found = {name: answer["agreement"][name] for name in ("with", "same", "total")}
    assert found == {"with": "averaged", "same": 2, "total": 2}
    assert answer["undecided"] == []


@pytest.fixture
def nothing_computed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """No point is computed, and nothing is written into the folder of the test."""

    def computed(*_: object) -> None:
        raise AssertionError("a point was computed")

    monkeypatch.setattr(StateTask, "__call__", computed)
    monkeypatch.chdir(tmp_path)
    yield
    assert not [*tmp_path.iterdir()]


@pytest.mark.usefixtures("nothing_computed")
@pytest.mark.parametrize(
    ("options", "word"),
    [
        ("--eta 0.14:0.01:14 --c 0.1", "begin with the smaller"),
        ("--eta 0.01:0.14 --c 0.1", "low:high:count"),
        ("--eta 0.01:0.14:1000 --c 0.1:1:1000", "at most 100000"),
        ("--eta -0.1 --c 0.1", "eta = b/a^2"),
        ("--eta 0.1 --c -0.1", "coupling c"),
        ("--eta 0.1 --c 0.1 --a 4 --b 0.5", "not allowed with"),
        ("--eta 0.1 --c 0.1 --n 1", "sites"),
        ("--eta 0.1 --c 0.1 --eps 0", "eps"),
        ("--eta 0.1 --c 0.1 --out missing/map.csv", "--out missing/map.csv"),
        ("--eta 0.1 --c 0.1 --out map.txt", ".csv"),
        ("--eta 0.1 --c 0.1 --picture missing/map.png", "--picture missing/map.png"),
        ("--eta 0.1 --c 0.1 --picture map.doc", ".png"),
        ("--eta 0.1 --c 0.1 --workers 0", "workers"),
        ("--eta 0.1 --c 0.1 --refine -1", "refine"),
        ("--eta 0.1 --c 0.1 --resume", "--out"),
        ("--eta 0.1 --c 0.1 --end 1", "end time"),
    ],
)
def test_bad_input_to_the_command_ends_with_two_and_one_sentence(
    options: str, word: str, refused: Any
) -> None:
    assert word in refused(f"map vdp --model envelope {options}")["message"]


def test_a_store_of_other_parameters_stops_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], answered: Any
) -> None:
    out = tmp_path / "map.csv"

    def stop(done: float) -> None:
        if done > 0.5:
            raise KeyboardInterrupt

    task = StateTask(chain=ENVELOPE.chain.replace(c=0.1))  # as the command has it
    points = state_points(task, {"eta": [0.05], "c": [0.1, 0.2, 0.3]})
    with pytest.raises(KeyboardInterrupt):
        sweep(task, points, out=out, workers=1, progress=stop)
    line = f"map vdp --eta 0.05 --c 0.1:0.3:3 --model envelope --out {out}"
    assert main(shlex.split(line)) == 2
    assert "--resume" in capsys.readouterr().err
    assert main(shlex.split(line + " --b 0.6 --resume")) == 2
    assert "parameters.chain.b" in capsys.readouterr().err
    assert answered(line + " --resume")["resumed"] == 2
    assert not part_path(out).exists()


def test_what_is_left_of_a_boundary_is_resumed_and_never_overwritten(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Here the map itself was complete when the run was interrupted."""

    def stopped(*_: object, resume: bool, **options: object) -> None:
        assert (resume, options["out"]) == (True, out)
        raise KeyboardInterrupt

    monkeypatch.setattr("fronts.maps.state_map", stopped)
    out = tmp_path / "map.csv"
    part = part_path(boundary_path(out))
    part.touch()
    line = f"map vdp --eta 0.05 --c 0.1:0.3:3 --model envelope --out {out}"
    assert main(shlex.split(line)) == 2
    said = capsys.readouterr().err
    assert said == f"fronts: {part} was left by an interrupted run: give --resume, or remove it.\n"
    assert main(shlex.split(line + " --resume")) == 130


@pytest.mark.usefixtures("nothing_computed")
@pytest.mark.parametrize("files", ["-o a.npz -o b.csv", "-o b.csv -o a.npz"])
def test_amplitudes_are_refused_for_csv_before_any_point(
    files: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(f"map averaged --c 0.1:0.6:2 --n 16 --amplitudes {files}".split()) == 2
    said = capsys.readouterr().err
    assert re.fullmatch(r"fronts: file of .* b\.csv .* ending in \.zarr or \.npz\.\n", said)
    chain = AveragedChain(a=4, b=0.5, c=0, sites=16)
    with pytest.raises(ParameterError, match=r"a\.csv .* \.zarr or \.npz"):
        state_map(StateTask(chain=chain, amplitudes=True), c=[0.1], out=Path("a.csv"))


def test_amplitudes_are_kept_in_a_file_that_holds_arrays(tmp_path: Path) -> None:
    task, out = replace(ENVELOPE, perturbation=0.0, amplitudes=True), tmp_path / "map.npz"
    found = state_map(task, c=[0.6], eta=[0.12], refine=0.0, workers=1, out=out)
    with np.load(out) as file:
        assert file["amplitude"].tolist() == found.states["amplitude"].tolist()
        assert file["amplitude"].shape == (1, 16)


@pytest.mark.usefixtures("nothing_computed")
@pytest.mark.parametrize("files", ["", "--json", "--out a.json", "--out a.svg", "-o a.csv"])
def test_amplitudes_that_no_file_would_keep_are_refused_before_any_point(
    files: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(f"map averaged --c 0.1:0.6:2 --n 16 --amplitudes {files}".split()) == 2
    assert "--amplitudes needs a file that keeps arrays" in capsys.readouterr().err


def test_a_picture_is_drawn_of_a_map_with_amplitudes(tmp_path: Path) -> None:
    command = "map averaged --eta 0.03:0.11:2 --c 0.1:0.6:2 --n 16 --refine 0 --amplitudes"
    files = [tmp_path / "map.npz", tmp_path / "map.svg"]
    assert main([*command.split(), *(word for file in files for word in ("--out", str(file)))]) == 0
    assert files[1].read_text().lstrip().startswith("<?xml")


def test_amplitudes_of_every_site_are_those_of_an_independent_run(tmp_path: Path) -> None:
    """A map from the shell, beside a plain loop over its points that knows only the equation."""
    out = tmp_path / "map.npz"
    command = "map averaged --eta 0.03:0.11:2 --c 0.1:0.6:2 --n 16 --refine 0 --amplitudes --out"
    assert main([*command.split(), str(out)]) == 0
    with np.load(out) as file:
        found, times = file["amplitude"], file["amplitude_time"]
        labels = file["label"].tolist()
    assert {*labels} == {"breather", "front", "fixed point"}
    for n, (eta, c) in enumerate((eta, c) for eta in (0.03, 0.11) for c in (0.1, 0.6)):
        alone = _chain_by_scipy(ENVELOPE, eta, c, np.array([times[n]]))[0]
        # Steps of the map err by 1e-8 of the largest value, 6 at first, and contract.
        assert found[n] == pytest.approx(alone, abs=1e-8 * DISPLACEMENT)


def test_a_map_has_its_executor_and_is_resumed_only_if_that_is_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[dict[str, Any]] = []

    def swept(*_: Any, **how: Any) -> Any:
        asked.append(how)
        raise KeyboardInterrupt

    def pool(count: int) -> Any:
        return nullcontext(f"pool of {count}")

    monkeypatch.setattr(state_map_module, "sweep", swept)
    monkeypatch.setattr(state_map_module, "worker_pool", pool)
    given: Any = object()
    for options, executor, resume in (
        ({"workers": 2, "executor": given}, given, False),
        ({"workers": 2}, "pool of 2", False),
        ({"workers": 7, "resume": True}, "pool of 3", True),
        ({"workers": 1}, None, False),
    ):
        with pytest.raises(KeyboardInterrupt):
            state_map(FIGURE_15.averaged(), eta=[0.05], c=[0.1, 0.2, 0.3], **options)
        assert (asked[-1]["executor"], asked[-1]["resume"], asked[-1]["dims"]) == (
            executor, resume, {},
        )  # fmt: skip
    with pytest.raises(KeyboardInterrupt):
        state_map(StateTask(chain=FIGURE_15.averaged(), amplitudes=True), c=[0.1], workers=1)
    assert asked[-1]["dims"] == {"amplitude": "site"}


def test_a_task_alone_is_of_one_run_and_keeps_no_amplitudes() -> None:
    task = StateTask(chain=FIGURE_15, perturbation=1e-3, amplitudes=True, end=500.0)
    one_run = StateTask(chain=FIGURE_15, perturbation=0.0, end=500.0)
    assert task.alone() == one_run
    assert task.average() == replace(one_run, chain=FIGURE_15.averaged())


@pytest.mark.parametrize("held", ["a", "b"])
def test_eta_is_b_over_the_square_of_a_whichever_is_held(held: str) -> None:
    task = StateTask(chain=FIGURE_15.replace(a=3.0, b=0.7), held=held)
    chain = task.at({"eta": 0.04, "c": 0.2})
    assert chain.b / chain.a**2 == pytest.approx(0.04, rel=1e-14)
    assert (chain.c, getattr(chain, held)) == (0.2, getattr(task.chain, held))


@pytest.mark.parametrize("sites", [5, 9])
def test_a_nucleus_is_in_the_middle_of_the_chain_at_each_point_of_a_map(sites: int) -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.05, sites=16)
    row = StateTask(chain=chain, nucleus=Nucleus(1), amplitudes=True)(Point(sites=sites))
    assert row["label"] == "breather"
    assert np.argmax(row["amplitude"]) == sites // 2


@pytest.mark.parametrize(
    ("name", "values", "match"),
    [
        ("sites", [9, 5], "7"),
        ("sites", [9, 1001], "number of sites n = 1001 .* from 2 to 1000"),
        ("eps", [0.01, 1e-5], "small parameter eps = 1e-05 .* averaged chain"),
    ],
)
def test_what_no_run_at_a_point_would_accept_is_refused_before_any_run(
    name: str, values: list[float], match: str
) -> None:
    task = StateTask(chain=VdpChain(a=4, b=0.5, c=0.1, sites=16), nucleus=Nucleus(7))
    with pytest.raises(ParameterError, match=match):
        state_points(task, {name: values})


def test_no_boundary_is_sought_between_whole_numbers() -> None:
    # three excited sites fill a chain of three, and are a breather of a longer one
    task = StateTask(chain=AveragedChain(a=4, b=0.5, c=0.05, sites=8), nucleus=Nucleus(3))
    found = state_map(task, workers=1, refine=0.5, sites=[3, 8], c=[0.05, 0.6])
    assert found.states["label"].tolist() == ["front", "front", "breather", "front"]
    assert found.boundary is not None
    assert found.boundary["along"].tolist() == ["c"]


def test_a_chain_that_was_filled_once_and_keeps_half_its_sites_is_a_breather() -> None:
    """Of two sites: one starts just above the unstable cycle, and the coupling pulls it below."""
    chain = AveragedChain(a=2.5, b=0.5, c=0.05, sites=2)
    start = np.array([[chain.stable_amplitude, 0.0], [0.0, -1.02 * chain.unstable_amplitude]])
    found = find_vdp_state(chain, start, end=2000.0, tolerance=1e-8)
    assert (found.state, found.above) == (State.BREATHER, 1)


@pytest.mark.parametrize("refine", [0.0, 0.25])
@pytest.mark.parametrize("out", [None, Path("map.csv")])
def test_a_map_and_its_boundary_are_in_two_files(
    out: Path | None, refine: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[Path | None] = []

    def made(_: object, points: Any, *, out: Path | None, **__: object) -> Table:
        written.append(out)
        return sweep(
            lambda point: {"label": "in" if point["eta"] < 0.12 else "out"}, points, workers=1
        )

    monkeypatch.setattr(state_map_module, "sweep", made)
    state_map(ENVELOPE, refine=refine, workers=1, out=out, eta=[0.11, 0.13], c=[0.3])
    edge = None if out is None else Path("map-boundary.csv")
    assert written == ([out, edge] if refine else [out])


def test_two_maps_are_compared_in_the_order_in_which_they_are_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(state_map_module, "compare", lambda *given: asked.append(given))
    one, other = (
        SimpleNamespace(states=name, axes=("eta", "c")) for name in ("the one", "the other")
    )
    StateMap.agreement(one, other)  # type: ignore[arg-type]
    assert asked == [("the one", "the other", ("eta", "c"))]


def test_where_the_cycles_meet_the_level_is_that_of_both() -> None:
    """At η = 1/8, r² = 4/a·2: the double root of 1 - ar²/4 + br⁴/8."""
    assert level_of(4.0, 2.0) == pytest.approx(math.sqrt(2.0), rel=1e-12)
    assert level_of(4.0, 2.0 + 1e-9) == math.inf


def test_a_map_starts_from_the_sites_that_are_named_or_from_the_middle_one() -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.1, sites=5)
    for sites, excited in ((None, [2]), ((1, 2), [0, 1])):
        start = smooth_rules.start(chain, sites)
        assert np.flatnonzero(np.hypot(*start)).tolist() == excited


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("late", [False, True])
def test_samples_are_taken_where_the_last_site_passes_zero(late: bool, sign: float) -> None:
    """Its y is ±(e^{4t} - 2), or this backwards, so that secants keep one end again and again."""
    p, state, out = np.array([4.0]), np.array([0.0, -1.0, 0.0, 5.0]), np.zeros(4)
    lengths = []

    def flow(h: float) -> list[float]:
        y = 2.0 - math.exp(4.0 * (1.0 - h)) if late else math.exp(4.0 * h) - 2.0
        return [h, sign * y, -h, 5.0 * h]

    def step(*given: Any) -> None:
        x, parameters, *ends, h, _, target = given
        assert x is state
        assert parameters is p
        assert ends == [FREE, FREE]
        lengths.append(h)
        target[:] = flow(h)

    state[:] = flow(0.0)
    state_run._to_section.py_func(step, p, state, 1.0, np.zeros((12, 4)), out)
    time = 1.0 - math.log(2.0) / 4.0 if late else math.log(2.0) / 4.0
    assert out == pytest.approx(flow(time), abs=2e-12)
    assert 0.0 <= min(lengths) <= max(lengths) <= 1.0
    # By bisection some 40, and by secants that keep an end of full weight more.
    assert len(lengths) < 20
