"""Trajectories: whether a run is resolved and until when, what is refused, what becomes JSON."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import DOP853, solve_ivp

from tests.one_step import LEFT, RIGHT, TAKEN, steps
from theory.arrays import FloatArray
from theory.chains.chain import CHAINS
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.oscillator import OscillatorChain
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.fronts.status import FrontStatus
from verification.references import equations
from verification.runs import simulate as simulate_module
from verification.runs.comparison import other_tolerance
from verification.runs.excite import excite
from verification.runs.integration import checked_state
from verification.runs.simulate import _with_comparisons, simulate
from verification.runs.smooth_integration import SmoothIntegration
from verification.runs.trajectory import RunStatus, Trajectory
from verification.steppers import smooth
from verification.steppers.active import FOLLOWING, FREE, NETWORK, REST
from verification.steppers.stop_code import StopCode

FRONT = VdpChain(a=4, b=0.5, c=0.6, sites=8)


def test_a_run_that_rounding_decides_says_until_when_it_is_resolved() -> None:
    """On its unstable cycle a cell of (43) stands still for ever; rounding makes it leave."""
    cell = AveragedChain(a=1.0, b=0.11, c=0.0, sites=2)
    start = np.array([[cell.unstable_amplitude, 0.0], [0.0, 0.0]])
    end = 400.0 / cell.eps
    run = simulate(cell, start, end, samples=101)
    assert run.status is RunStatus.NOT_RESOLVED
    assert 0.0 < run.resolved_until < end
    until = run.times <= run.resolved_until
    wrong = np.abs(run.amplitude[:, 0] - cell.unstable_amplitude)
    assert wrong[until].max() <= cell.unstable_amplitude
    assert wrong.max() > 0.5 * cell.unstable_amplitude
    short = simulate(cell, start, run.resolved_until, samples=11)
    assert short.status is RunStatus.RESOLVED
    assert short.resolved_until == run.resolved_until


@pytest.mark.parametrize(("steps", "mean"), [(0, 0.0), (1, 7.0), (2, 3.5)])
def test_the_mean_number_of_active_sites_is_over_the_steps(steps: int, mean: float) -> None:
    run: Any = SimpleNamespace(steps=steps, counts={"site_steps": 7 if steps else 0})
    active: Any = Trajectory.mean_active
    assert active.fget(run) == mean


@pytest.mark.parametrize(("apart", "resolved"), [(0.3, True), (0.4, False), (2.0, False)])
def test_a_run_that_is_not_resolved_may_be_on_the_other_side(apart: float, resolved: bool) -> None:
    """Two motions on one cycle, as far apart as chance has it: the true one may be opposite."""
    turn = 2.0 * math.asin(0.5 * apart)
    first, other = (
        SimpleNamespace(
            samples=np.array([[[0.0], [1.0]], [[math.sin(phase)], [math.cos(phase)]]]),
            sampled_amplitude=np.ones((2, 1)), times=np.array([0.0, 1.0]), chain=FRONT,
            arrivals=np.zeros(1), counts={}, events={}, log=np.zeros((0, 3)), tolerance=1e-8,
            level=1.0, least_error=lambda: 0.0, least_arrival_error=lambda: 0.0,
            method_of=lambda _: "",
        )
        for phase in (0.0, turn)
    )  # fmt: skip
    runs: Any = [first, other]
    found = simulate_module._trajectory(FRONT, 1.0, runs, 0.0)
    assert found.error is not None
    if resolved:
        assert found.status is RunStatus.RESOLVED
        assert found.error == pytest.approx(3.0 * apart)
    else:
        assert found.status is RunStatus.NOT_RESOLVED
        assert found.error >= max(2.0, 3.0 * apart) - 1e-12


def _made_up(samples: FloatArray, arrivals: FloatArray) -> Any:
    """A run of two or more samples of one site, whose least errors are 0.1."""
    return SimpleNamespace(
        samples=samples, sampled_amplitude=np.hypot(samples[:, 0], samples[:, 1]),
        times=np.arange(float(len(samples))), chain=FRONT, arrivals=arrivals, counts={}, events={},
        log=np.zeros((0, 3)), tolerance=1e-8, level=1.0, least_error=lambda: 0.0,
        least_arrival_error=lambda: 0.1, method_of=lambda _: "",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("arrivals", "others", "error"),
    [
        ([0.0, math.nan], [0.0, math.nan], 0.0),
        ([0.0, 2.0], [0.0, 2.0], 0.1),
        ([0.0, 0.5], [0.0, 0.5], 0.1),
        ([0.0, 2.0], [0.0, 2.5], 1.5),
    ],
)
def test_arrivals_err_by_three_differences_and_not_at_the_start(
    arrivals: list[float], others: list[float], error: float
) -> None:
    runs = [_made_up(np.ones((2, 2, 1)), np.array(each)) for each in (arrivals, others)]
    found = simulate_module._trajectory(FRONT, 1.0, runs, 0.0)
    assert found.arrival_error == pytest.approx(error)


def test_a_chain_at_rest_is_resolved_and_one_whose_runs_differ_at_once_never_was() -> None:
    still = np.zeros((3, 2, 1))
    for other, status, until in (
        (still, RunStatus.RESOLVED, 2.0),
        (still + 1.0, RunStatus.NOT_RESOLVED, 0.0),
    ):
        runs = [_made_up(each, np.full(1, math.nan)) for each in (still, other)]
        found = simulate_module._trajectory(FRONT, 2.0, runs, 0.0)
        assert (found.status, found.resolved_until) == (status, until)


@pytest.mark.parametrize("apart", [0, 1, 2, 3])
def test_a_run_is_resolved_up_to_the_sample_before_its_error_exceeds_it(apart: int) -> None:
    """Of samples of size one that are one apart from the given one on, which is three in error.

    That the number of events differs is said only of runs that are resolved.
    """
    samples = np.zeros((3, 2, 1))
    samples[:, 0] = 1.0
    first, other = (_made_up(samples.copy(), np.full(1, math.nan)) for _ in range(2))
    other.samples[apart:, 1] = 1.0
    resolved = apart == 3
    for events in ({}, {"sticks": 1}):
        other.events = events
        found = simulate_module._trajectory(FRONT, 2.0, [first, other], 0.0)
        differ = RunStatus.EVENTS_DIFFER if events else RunStatus.RESOLVED
        assert found.status is (differ if resolved else RunStatus.NOT_RESOLVED)
        assert found.resolved_until == (2.0 if resolved else max(0.0, apart - 1.0))


@pytest.mark.parametrize(
    ("tolerance", "other"), [(1e-6, 1e-7), (1e-12, 1e-13), (2e-13, 2e-14), (5e-14, 5e-13)]
)
def test_a_run_is_compared_with_a_tenth_of_its_tolerance_down_to_1e_14(
    tolerance: float, other: float
) -> None:
    assert other_tolerance(tolerance) == pytest.approx(other, rel=1e-12)


def test_201_samples_are_taken_unless_another_number_is_asked_for() -> None:
    chain = FrictionChain(c=0.02, sites=2)
    run = simulate(chain, excite(chain, [1]), 1.0, estimate_error=False)
    assert run.times.size == simulate_module.DEFAULT_SAMPLES
    assert run.times.tolist() == np.linspace(0.0, 1.0, 201).tolist()


def test_distances_are_from_rest_wherever_that_is() -> None:
    chain = FrictionChain(c=0.02, sites=2)
    moved = np.array([[[0.3, 0.0], [0.4, 0.0]], [[0.0, -3.0], [0.1, 4.0]]])
    run: Any = SimpleNamespace(chain=chain, samples=moved + np.array(chain.rest_state)[:, None])
    assert chain.rest_state.y > 0.0
    assert simulate_module._distance_from_rest(run) == pytest.approx([0.5, 5.0])


@pytest.mark.parametrize(
    ("force", "y", "t_end"),
    [
        (8.24223773803062, 0.8964516036045524, 162.39316530890815),  # 2.7 ± 0.69, by chance
        (9.034535489797122, -1.0539078888097322, 119.27571073377663),  # 5.1e-5 ± 2.4e-5
    ],
)
def test_the_error_of_a_chaotic_run_does_not_depend_on_its_samples(
    force: float, y: float, t_end: float
) -> None:
    """Duffing's oscillator, by scipy: at one sample alone, two runs may agree by chance."""
    chain = OscillatorChain(
        stiffness="0.02*y + y**3", damping="0.05", eps=1.0, c=0.0, sites=2, drive=f"{force},1@all"
    )
    start = np.array([[y, y + 0.1], [0.0, 0.0]])
    few, many = (simulate(chain, start, t_end, level=50.0, samples=count) for count in (2, 201))
    assert few.states.shape == (2, 2, 2)
    assert few.times.tolist() == [0.0, t_end]
    assert np.array_equal(few.states[-1], many.states[-1])

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        pull = force * math.cos(t) - 0.05 * z[2:] - 0.02 * z[:2] - z[:2] ** 3
        return np.concatenate([z[2:], pull])

    exact = solve_ivp(rate, (0.0, t_end), start.ravel(), "DOP853", rtol=3e-14, atol=1e-14)
    off = np.hypot(*(few.states[-1] - exact.y[:, -1].reshape(2, 2))).max()
    assert off <= few.error
    assert few.status is many.status
    assert few.error == pytest.approx(many.error, rel=0.5)  # of maxima over other times


def test_the_error_of_a_run_that_dies_away_is_the_largest_on_the_way_at_two_samples_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain = VdpChain(a=4.0, b=0.5, c=0.1, sites=3, eps=0.05)
    start = excite(chain, [1], 0.5)
    few, many = (simulate(chain, start, 400.0, samples=count).error for count in (2, 301))
    assert few == pytest.approx(many, rel=0.05)
    monkeypatch.setattr(simulate_module, "_COMPARED", 0)
    at_the_ends = simulate(chain, start, 400.0, samples=2).error
    assert None not in (few, at_the_ends)
    assert at_the_ends < 0.5 * few  # type: ignore[operator]


@pytest.mark.parametrize(
    ("asked", "sites", "count"),
    [
        ([0.0, 3.0, 10.0], 3, 200),
        ([3.0, 3.0, 10.0], 500, 200),
        ([0.0, 3.0, 10.0], 501, 199),  # of 100 000 numbers
        ([0.0, 3.0, 10.0], 1000, 100),
        (np.linspace(0.0, 10.0, 99), 1000, 100),
        (np.linspace(0.0, 10.0, 100), 1000, 100),
        (np.linspace(0.0, 10.0, 101), 1000, 101),
    ],
)
def test_runs_are_also_compared_in_the_middle_of_equal_parts_of_their_time(
    asked: list[float], sites: int, count: int
) -> None:
    chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=sites)
    times, places = simulate_module._with_comparisons(np.array(asked), chain)
    parts = count - len(asked)
    middles = [10.0 * (2 * part + 1) / (2 * parts) for part in range(parts)]
    assert times.tolist() == pytest.approx(sorted([*asked, *middles]))
    shown = times if places is None else times[places]
    assert shown.tolist() == list(asked)
    assert places is None or len(set(places)) == len(asked)


def test_a_run_that_is_not_compared_takes_the_samples_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[int] = []

    def integration(chain: Any, start: Any, times: Any, **options: Any) -> Any:
        asked.append(len(times))
        return SmoothIntegration(chain, start, times, **options)

    monkeypatch.setattr(simulate_module, "integration", integration)
    chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=3)
    start, times = excite(chain, [1]), [3.0, 3.0, 7.0]
    found = simulate(chain, start, 20.0, times=times, level=0.7, estimate_error=False)
    same = simulate(chain, start, 20.0, times=times)
    assert asked == [3, 200, 200]
    assert (found.level, same.level) == (0.7, chain.unstable_amplitude)
    assert found.times.tolist() == same.times.tolist() == [3.0, 3.0, 7.0]
    assert np.array_equal(found.states, same.states)
    assert np.array_equal(found.amplitude, same.amplitude)


def test_a_resolved_run_says_so_and_without_comparison_nothing_is_claimed() -> None:
    run = simulate(FRONT, excite(FRONT, [1]), 50.0)
    assert (run.status, run.resolved_until) == (RunStatus.RESOLVED, 50.0)
    alone = simulate(FRONT, excite(FRONT, [1]), 50.0, estimate_error=False)
    assert (alone.status, alone.error, alone.resolved_until) == (RunStatus.NOT_COMPARED, None, None)
    assert np.array_equal(alone.states, run.states)


@pytest.mark.parametrize("model", ["vdp", "averaged", "friction"])
def test_a_trajectory_becomes_json(model: str) -> None:
    chain = FRONT if model == "vdp" else FRONT.averaged()
    if model == "friction":
        run = simulate(FrictionChain(c=0.02, sites=4), excite(FrictionChain(c=0.02, sites=4), [1]),
                       20.0, samples=3)  # fmt: skip
    else:
        run = simulate(chain, excite(chain, [1]), 20.0, samples=3)
    found = json.loads(json.dumps(run.to_dict(), allow_nan=False))
    assert found["model"] == model == run.chain.model
    assert (found["t_end"], found["amplitudes"]) == (20.0, run.amplitude[-1].tolist())
    assert found["tolerance"] == (1e-10 if model == "friction" else 1e-9)
    assert isinstance(run.chain, CHAINS[model])
    if model != "friction":  # sites above the level, and not all that have ever been
        amplitude = run.amplitude.copy()
        amplitude[-1, :3], amplitude[-1, 4] = 2.0 * run.level, run.level
        passed = replace(run, arrivals=np.zeros(run.arrivals.size), amplitude=amplitude)
        assert passed.to_dict()["width"] == 3


def test_the_phase_is_that_of_the_envelope_and_stands_still_without_damping() -> None:
    """y = sin(t + α), ẏ = cos(t + α) has Ψe^{-it} = e^{iα}; φ of (43) is taken as it is."""
    times, at = np.linspace(0.0, 20.0, 7), np.array([0.3, -1.2, 2.0])
    angle = times[:, None] + at
    run = replace(
        simulate(FRONT.replace(sites=3), np.zeros((2, 3)), 20.0, samples=7), times=times,
        states=np.stack([np.sin(angle), np.cos(angle)], axis=1),
    )  # fmt: skip
    assert run.phase == pytest.approx(np.broadcast_to(at, (7, 3)), abs=1e-14)
    turning = replace(run, chain=FRONT.averaged().replace(sites=3))
    assert np.exp(1j * turning.phase) == pytest.approx(np.exp(1j * angle))


def test_events_are_counted_of_chains_that_have_any() -> None:
    smooth = simulate(FRONT, excite(FRONT, [1]), 5.0, samples=2)
    assert (smooth.event_count, smooth.event_log.shape) == (0, (0, 3))
    chain = FrictionChain(c=0.02, sites=4)
    run = simulate(chain, excite(chain, [1]), 40.0, samples=2, logged_events=1000)
    assert run.event_count == len(run.event_log) > 2


def test_sites_stick_that_go_with_the_belt_at_the_end() -> None:
    """Of three without a coupling, one is carried on, one is released on the way, one slides."""
    chain = FrictionChain(c=0.0, sites=3)
    cell = chain.cell
    start = np.array([[0.0, cell.release - 1e-3, cell.steady_sliding], [cell.v_d, cell.v_d, 0.0]])
    run = simulate(chain, start, 0.01, times=[0.0, 1e-4, 0.01])
    assert run.event_log.shape == (0, 3)  # which nobody asked for
    assert run.stuck.tolist() == [True, False, False]
    assert np.array_equal(run.phase, np.angle(run.psi))  # in no turning frame
    assert run.to_dict()["width"] == 2  # sites that have stuck
    assert simulate(chain, start, 1e-4, samples=2).stuck.tolist() == [True, True, False]
    assert run.counts["releases"] == 1


def test_a_run_takes_no_longer_than_who_waits_for_it() -> None:
    before = perf_counter()
    seconds = [simulate(FRONT, excite(FRONT, [1]), 5.0, samples=2).seconds for _ in range(2)]
    assert min(seconds) > 0.0
    assert sum(seconds) <= perf_counter() - before


def test_a_start_may_be_complex_or_a_pair_of_rows() -> None:
    rows = excite(FRONT, [1, 2], quarter_turns=[0, -1])
    psi = rows[1] + 1j * rows[0]
    one, other = (simulate(FRONT, each, 20.0, samples=2) for each in (rows, psi))
    assert np.array_equal(one.states, other.states)


def test_a_pair_of_complex_rows_is_refused_as_such() -> None:
    with pytest.raises(ParameterError, match=r"start = a complex array .* must be real;"):
        checked_state(FRONT, np.zeros((2, FRONT.sites), dtype=complex))


def test_a_run_is_given_its_end_its_budget_its_checkpoint_and_whom_it_reports_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def run_to_end(runs: list[SmoothIntegration], *given: Any) -> float:
        asked.extend(given)
        assert [each.end for each in runs] == [5.0]
        return 0.0

    monkeypatch.setattr(simulate_module, "run_to_end", run_to_end)
    file = tmp_path / "run.npz"
    simulate(
        FRONT, np.zeros((2, 8)), 5.0, samples=2, estimate_error=False, budget=7, checkpoint=file,
        progress=asked.append,
    )  # fmt: skip
    assert asked == [5.0, 7, file, asked.append]


@pytest.mark.parametrize(
    "run",
    [
        lambda: simulate(PiecewiseChain(c=0.5, eta=0.03), np.zeros((2, 4)), 10.0),
        lambda: simulate(FRONT, np.zeros((3, 8)), 10.0),
        lambda: simulate(FRONT, np.zeros((2, 8), dtype=complex), 10.0),
        lambda: simulate(FRONT, [["a"] * 8] * 2, 10.0),
        lambda: simulate(FRONT, np.zeros((2, 8)), 10.0, times=[5.0, 1.0]),
        lambda: simulate(FRONT, np.zeros((2, 8)), 10.0, times=[5.0, 11.0]),
        lambda: simulate(FRONT, np.zeros((2, 8)), 10.0, tolerance=1.0),
        lambda: simulate(
            FRONT.replace(ends=Ends.PERIODIC), np.zeros((2, 8)), 9.0, trailing_sites=4
        ),
        lambda: simulate(FRONT, np.zeros((2, 8)), 10.0, logged_events=5),
        lambda: simulate(FrictionChain(c=0.1, sites=2), np.zeros((2, 2)), 10.0, level=1.0),
        lambda: excite(FRONT, []),
        lambda: excite(FRONT, [9]),
        lambda: excite(FRONT, [1], 1e4),
        lambda: excite(PiecewiseChain(c=0.5, eta=0.03), [1]),
    ],
)
def test_what_does_not_fit_is_refused_in_one_sentence(run: Callable[[], object]) -> None:
    with pytest.raises(ParameterError) as caught:
        run()
    assert "\n" not in str(caught.value)


def test_every_status_has_its_sentence() -> None:
    for member in (*RunStatus, *FrontStatus, *StopCode, *Ends):
        assert member.sentence.endswith(".")


def test_the_second_process_does_not_compile() -> None:
    """What is compiled for a chain is found on disk again: no signature is missed."""
    code = (
        "from theory.chains.vdp import VdpChain as C\n"
        "from verification.runs.excite import excite\n"
        "from verification.runs.simulate import simulate\n"
        "chain = C(a=4, b=0.5, c=0.6, sites=4)\n"
        "simulate(chain, excite(chain, [1]), 5.0)\n"
        "from verification.steppers import smooth\n"
        "step = smooth.compiled_step(chain)\n"
        "print(sum(smooth._advance.stats.cache_misses.values()), step.cache_hits)\n"
    )
    simulate(FRONT, excite(FRONT, [1]), 5.0)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0", "1"]


def test_times_are_those_asked_for_and_the_run_goes_to_its_end() -> None:
    chain = FrictionChain(c=0.02, sites=4)
    run = simulate(chain, excite(chain, [1]), 50.0, times=[1.0, 2.5])
    whole = simulate(chain, excite(chain, [1]), 50.0, samples=2)
    assert run.times.tolist() == [1.0, 2.5]
    assert math.isclose(run.arrivals[0], whole.arrivals[0], abs_tol=1e-8)
    assert run.counts["sticks"] == whole.counts["sticks"]
    assert run.t_end == run.to_dict()["t_end"] == 50.0


def test_one_time_is_enough_and_a_number_of_samples_beside_times_is_refused() -> None:
    start = excite(FRONT, [1])
    alone = simulate(FRONT, start, 3.0, times=[2.0], estimate_error=False)
    assert (alone.times.tolist(), alone.states.shape) == ([2.0], (1, 2, FRONT.sites))
    among = simulate(FRONT, start, 3.0, times=[0.0, 2.0, 3.0], estimate_error=False)
    assert np.array_equal(alone.states[0], among.states[1])
    with pytest.raises(ParameterError, match=r"samples = 2 is not allowed: .* absent beside times"):
        simulate(FRONT, start, 3.0, samples=2, times=[0.0, 3.0])
    with pytest.raises(ParameterError, match="number of samples = 0"):
        simulate(FRONT, start, 3.0, times=[])


@pytest.mark.parametrize(
    "times", [[-1.0, 1.0], [2.0, 1.0], [0.0, 3.5], [-2.0, -1.0], [0.0, 2.0, 1.0], [[0.0, 1.0]]]
)
def test_times_of_samples_ascend_from_zero_to_the_end(times: Any) -> None:
    with pytest.raises(
        ParameterError, match=r"times of the samples = \[.*one ascending list .* and t_end = 3;"
    ):
        simulate_module._sample_times(FRONT, 3.0, None, times)


@pytest.mark.parametrize("times", [[0.0, 3.0], [1.0, 1.0, 2.0], [0.0, 0.0], [3.0, 3.0]])
def test_times_of_samples_may_be_the_ends_and_twice_the_same(times: list[float]) -> None:
    assert simulate_module._sample_times(FRONT, 3.0, None, times).tolist() == times


@pytest.mark.parametrize("displacement", [1000.0, -1000.0])
def test_a_displacement_is_at_most_a_thousand(displacement: float) -> None:
    y, _ = np.abs(excite(FRONT, [1], displacement))
    assert y[0] == 1000.0
    with pytest.raises(ParameterError, match="displacement"):
        excite(FRONT, [1], 1.001 * displacement)


def test_a_loop_ends_in_one_of_several_ways_each_with_its_sentence() -> None:
    """Codes that are equal would be one member under two names."""
    assert [code.name for code in StopCode] == list(StopCode.__members__)
    assert len({code.sentence for code in StopCode}) == len(StopCode)


BY_ACCIDENT = {
    "both came to each sample by one step": (
        AveragedChain(a=4, b=0.475, c=2.356, sites=9), [5], 12.55, 1e-3
    ),
    "one step of the finer run was bad": (
        VdpChain(a=4, b=0.5044099266762305, c=0.018981541178243064, eps=0.14252998801228128,
                 sites=21),
        [20, 9], 12.079822604229983, 1.753435608529151e-06,
    ),
}  # fmt: skip
"""Runs that agreed with those at a tenth of the tolerance better than they were right."""


@pytest.mark.parametrize("how", BY_ACCIDENT)
def test_runs_that_agree_by_accident_state_the_error_that_they_have(how: str) -> None:
    chain, excited, end, tolerance = BY_ACCIDENT[how]
    run = simulate(chain, excite(chain, excited), end, tolerance=tolerance, samples=11)
    true = np.hypot(*np.moveaxis(run.states - reference_states(run), 1, 0)).max()
    assert 1e-9 < true <= run.error  # 1e-9: far above rounding and the error of the reference


def reference_states(run: Trajectory) -> np.ndarray:
    """Integrate the chain of a run from its start by scipy; return the states at its samples."""
    chain, start, error = run.chain, run.states[0], {"rtol": 1e-12, "atol": 1e-13}
    if isinstance(chain, AveragedChain):
        rate, times = equations.averaged_rate(chain), chain.eps * run.times
        found = solve_ivp(
            rate, (0.0, times[-1]), start[1] + 1j * start[0], "DOP853", times, **error
        )
        return np.stack([found.y.T.imag, found.y.T.real], axis=1)
    rate, times = equations.full_rate(chain), run.times
    found = solve_ivp(rate, (0.0, times[-1]), start.ravel(), "DOP853", times, **error)
    return found.y.T.reshape(times.size, 2, -1)


@pytest.mark.parametrize(
    ("b", "excited"), [(0.75, [1]), (0.68, [1, 3, 5, 7, 9, 11])], ids=["few", "many at once"]
)
def test_a_site_that_is_above_the_level_within_a_step_only_has_arrived(
    b: float, excited: list[int]
) -> None:
    """It rises to a maximum that passes the level by a thousandth of it, and falls again."""
    chain = AveragedChain(a=4, b=b, c=5.0, sites=12, ends=Ends.PERIODIC)
    start = excite(chain, excited)
    fine = reference_states(simulate(chain, start, 400.0, samples=2001, tolerance=1e-6))
    amplitude = np.hypot(fine[:, 0, 1], fine[:, 1, 1])  # of the second site, which is at rest first
    level = (1.0 - 1e-3) * amplitude.max()
    first = 0.2 * np.flatnonzero(amplitude >= level)[0]
    assert max(amplitude[0], amplitude[-1]) < 0.98 * level
    run = simulate(chain, start, 400.0, samples=2, level=level, tolerance=1e-4)
    assert run.arrivals[1] == pytest.approx(first, abs=1.0)  # it is flat there


def test_an_arrival_in_the_last_step_but_after_the_end_is_none() -> None:
    chain = FRONT.replace(eps=0.1)
    last = simulate(chain, excite(chain, [1]), 30.0, samples=2).arrivals[2]
    assert 20.0 < last < 30.0
    for end, arrived in ((last - 1e-6, False), (last + 1e-6, True)):
        run = simulate(chain, excite(chain, [1]), end, samples=2)
        assert np.isfinite(run.arrivals[2]) == arrived


def test_every_cubic_that_passes_zero_between_negative_ends_is_looked_at() -> None:
    """Of a few thousand at random; the largest value of each is found on a fine grid."""
    rng = np.random.default_rng(3)
    part = np.linspace(0.0, 1.0, 401)
    before, after = -rng.uniform(0.0, 1.0, (2, 4000, 1))
    rise, fall = rng.normal(0.0, 8.0, (2, 4000, 1))
    curve = 3.0 * (after - before) - 2.0 * rise - fall
    bend = 2.0 * (before - after) + rise + fall
    passes = (before + part * (rise + part * (curve + part * bend))).max(axis=1) >= 0.0
    highest = smooth._highest.py_func  # type: ignore[attr-defined]
    ends = np.hstack([before, rise, after, fall])
    looked_at = np.array([highest(*(float(each) for each in row)) >= 0.0 for row in ends])
    assert 1000 < passes.sum() < 3000
    assert np.all(looked_at[passes])
    assert looked_at.sum() < 3800  # some are left out


@pytest.fixture
def not_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("_highest", "_mark_arriving", "_beyond", "_interpolated"):
        monkeypatch.setattr(smooth, name, getattr(smooth, name).py_func)


@pytest.mark.usefixtures("not_compiled")
def test_a_site_is_looked_at_for_its_first_slope_or_its_last_one_until_it_has_arrived() -> None:
    """Before and after the step it is below the level; slopes within the step do not count."""
    x = np.array([0.9, 0.9, 0.9, 0.9, 0.0, 0.0, 0.0, 0.0])
    K = np.full((smooth.STAGES, 8), math.nan)
    K[[0, -1]] = 0.0
    K[0, [0, 3]], K[-1, 1] = 1.0, -1.0
    rows: Any = SimpleNamespace(x=x, new=x, K=K, work=np.full((2, 8), -7.0))
    arrivals = np.array([math.nan, math.nan, math.nan, math.nan, math.nan, 2.0])
    run: Any = SimpleNamespace(counters=[2], arrivals=arrivals)
    arriving = smooth._arriving.py_func  # type: ignore[attr-defined]
    assert arriving(SimpleNamespace(level=1.0), run, rows, 1.0)
    assert rows.work[0, :4].tolist() == [1.0, 1.0, 0.0, 0.0]
    assert not arriving(SimpleNamespace(level=1.0), run, rows, 0.1)
    assert rows.work[0, :4].tolist() == [0.0] * 4


@pytest.mark.usefixtures("not_compiled")
@pytest.mark.parametrize("moving", [(12, 28), (9, 30), (10, 17), (15, 29), (14, 25), ()])
@pytest.mark.parametrize("sites", [100, 31])
def test_a_window_is_widened_until_its_margins_are_at_rest(
    moving: tuple[int, ...], sites: int
) -> None:
    """Of sites 9 to 30, with four sites at rest inside either end."""
    state = np.full((2, sites), 0.05)
    state[0, list(moving)] = 0.2
    widened = smooth._widened.py_func  # type: ignore[attr-defined]
    found = widened(state[:, 9:31].ravel(), 0.1, 4, 9, 31, sites)
    low, high = (min(moving), max(moving)) if moving else (20, 20)
    assert found == (min(9, low - 4), min(sites, max(31, high + 5)))


@pytest.mark.usefixtures("not_compiled")
@pytest.mark.parametrize("end", [100.0, 10.7])
def test_an_arrival_is_where_the_amplitude_first_passes_the_level(end: float) -> None:
    """Displacements are parabolas in time, and y² is the polynomial through nine values of it.

    One site passes the level and falls below it again, one stays below it, one is above it
    when the step begins, one is not marked, and one passes it late.
    """
    rows: Any = SimpleNamespace(p=np.array([3.0]), inside=np.zeros(10), work=np.zeros((2, 10)))

    def flow(h: float) -> list[float]:
        t = h / 2.0
        humps = [height - (t - 0.5) ** 2 for height in (2.04, 1.99)]
        return [*humps, 3.0 - t, 1.0 + 2.0 * t, 1.5 + t, *[0.0] * 5]

    def step(*given: Any) -> None:
        x, p, *ends, h, _, target = given
        assert x is rows.x
        assert p is rows.p
        assert ends == [5, 6]
        target[:] = flow(h)

    rows.x, rows.new, rows.K = np.array(flow(0.0)), np.array(flow(2.0)), None
    rows.work[0, :5] = 1.0, 1.0, 1.0, 0.0, 1.0
    task: Any = SimpleNamespace(level=2.0, end=end)
    run: Any = SimpleNamespace(clock=[10.0], counters=[1, 6], arrivals=np.full(6, math.nan))
    foremost = smooth._note_arrivals.py_func(step, task, run, rows, (5, 6), 2.0)  # type: ignore[attr-defined]
    late = 11.0 if end > 11.0 else math.nan
    expected = [math.nan, 10.0 + 2.0 * 0.3, math.nan, 10.0, math.nan, late]
    assert run.arrivals == pytest.approx(expected, abs=1e-12, nan_ok=True)
    assert foremost == (5 if end > 11.0 else 3)


# The following tests take steps of the compiled loop _advance by motions that are known. It calls
# _try_steps, step_error, finite, _sample_is_due, _take_samples, _arriving, _mark_arriving,
# _note_arrivals, _interpolated, _pass_time, _moved_window, _widened and _beyond.

# Displacement, then velocity: value at the beginning, and coefficients of t, t² and t³.
PASSING = [
    ((0.5, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
    ((0.9, 2.0, -2.2, 0.0), (0.0, 0.0, 0.0, 0.0)),  # and falls again
    ((0.9, 4.0, -12.1, 6.9), (0.0, 0.0, 0.0, 0.0)),  # from 0.9 at once, to -0.3
    ((-0.3, -0.5, 8.6, -6.9), (0.0, 0.0, 0.0, 0.0)),  # the same backwards
    ((0.6, 0.0, 0.0, 0.0), (0.6, 0.0, 0.0, 0.0)),  # stays below
    ((-0.5, 3.0, -1.5, 0.0), (0.0, 0.0, 0.0, 0.0)),  # touches the level at the end
    ((1.5, -1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),  # is above at the beginning
    ((0.6, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)),  # by its velocity
    ((0.5, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),  # has arrived before
    ((1.02, -2.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),  # is just above at the beginning
    ((0.0, 0.0, 0.0, 0.0), (1.02, -2.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0, 0.0), (-0.3, -0.5, 8.6, -6.9)),  # only between the ends, by its velocity
    ((0.0, 0.0, 0.0, 0.0), (0.9, 4.0, -12.1, 6.9)),
    ((0.6, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)),
    ((0.9, 0.3, -0.3, 0.0), (0.0, 0.0, 0.0, 0.0)),  # turns below the level
]
TOUCHES, EARLIER, LAST = 5, 8, 13
"""Places among these: at rest at the level; arrived at time 3; the last one that arrives."""


def _first_time_above(y: tuple[float, ...], w: tuple[float, ...]) -> float:
    """Return the first time within a step of length 1 at which y² + w² is 1 or more."""
    y_up, w_up = np.polynomial.Polynomial(y), np.polynomial.Polynomial(w)
    excess = y_up**2 + w_up**2 - 1.0
    if excess(0.0) >= 0.0:
        return 0.0
    roots = excess.roots()
    real = roots.real[np.abs(roots.imag) < 1e-6]
    return float(min((each for each in real if 0.0 < each < 1.0 + 1e-6), default=math.nan))


@pytest.mark.parametrize("level", [1.0, 0.5])
@pytest.mark.parametrize("trailing", [0, 1, 20])
@pytest.mark.parametrize("end", [100.0, 10.25])
def test_the_compiled_loop_finds_the_arrivals_of_sites_that_move_as_cubics(
    end: float, trailing: int, level: float
) -> None:
    """The amplitude squared is then of degree 6, and its interpolation exact."""
    motion, count = np.moveaxis(np.array(PASSING), 0, -1), len(PASSING)
    state, before = np.zeros((2, count + 2)), np.full(count + 2, math.nan)
    state[:, 1:-1], before[1 + EARLIER] = level * motion[:, 0], 3.0
    taken = steps(
        state, level * np.moveaxis(motion[:, 1:], 0, 1), window=(1, count + 1),
        clock=[10.0, 0.0, 0.0, 0.0, 0.0], arrivals=before, level=level, end=end, trailing=trailing,
    )  # fmt: skip
    times = 10.0 + np.array([_first_time_above(*each) for each in PASSING])
    assert np.isfinite(times).sum() == count - 2
    expected = before.copy()
    expected[1:-1] = np.where(times <= end, times, math.nan)
    expected[1 + EARLIER] = 3.0
    assert taken.arrivals == pytest.approx(expected, abs=1e-7, nan_ok=True)  # it is flat at the end
    sharp = np.arange(count + 2) != 1 + TOUCHES
    assert taken.arrivals[sharp] == pytest.approx(expected[sharp], abs=1e-13, nan_ok=True)
    foremost = 1 + LAST if end > 11.0 else LAST
    low = max(1, foremost - trailing) if trailing else 1  # it never moves back
    assert taken.counters[[smooth.LO, smooth.HI]].tolist() == [low, count + 1]
    assert taken.counters[smooth.SITE_STEPS] == count
    ended = smooth.BUDGET if end > 11.0 else smooth.REACHED
    assert taken.code == (smooth.MOVED if low > 1 else ended)
    assert taken.marks[[LEFT, RIGHT]].tolist() == [FOLLOWING if trailing else REST, REST]


@pytest.mark.parametrize("trailing", [0, 1, 3])
@pytest.mark.parametrize(
    ("window", "sites"),
    [((9, 31), 100), ((9, 31), 31), ((1, 31), 31), ((0, 30), 31), ((0, 31), 31)],
)
def test_the_compiled_loop_widens_its_window_until_margins_are_at_rest(
    window: tuple[int, int], sites: int, trailing: int
) -> None:
    """At rest is also what is as large as that; behind a front sites are left out for good."""
    low, high = window
    left = FREE if low == 0 else FOLLOWING if trailing else REST
    for moving in ((12, 28), (13, 26), (10, 17), (15, 27), (14, 25), (3, 29), (1, 4, 9), ()):
        for rest in (0.125, 0.0):
            inside = [n for n in moving if low <= n < high]
            state = np.zeros((2, sites))
            state[0], state[0, inside] = rest, -0.2
            taken = steps(state, window=window, rest=rest, margin=4, trailing=trailing)
            expected = [low, high]
            if inside:
                wider = low if trailing else max(0, min(low, min(inside) - 4))
                expected = [wider, min(sites, max(high, max(inside) + 5))]
            assert taken.counters[[smooth.LO, smooth.HI]].tolist() == expected
            assert taken.code == (smooth.BUDGET if expected == [low, high] else smooth.MOVED)
            assert taken.marks.tolist() == [1.0, left, FREE if high == sites else REST]


def test_parameters_are_those_of_the_middle_of_a_step_and_its_time_that_of_the_beginning() -> None:
    """Of which 0.25 has been left out by rounding so far; the step has length 0.5."""
    count = steps(np.zeros((2, 1))).p.size
    start = np.arange(1.0, count + 1.0)
    one, two = np.zeros(count), np.zeros(count)
    one[3], two[[3, 4]] = 0.5, 1.0
    for rates in (np.ones(count), np.full(count, -0.7), one, two, 0.0 * one):
        for place in (-1, 0, 5):
            taken = steps(
                np.zeros((2, 1)), clock=[2.0, 0.0, 0.0, 0.0, 0.25], parameters=start, drift=rates,
                clock_place=place, longest=0.5,
            )  # fmt: skip
            expected = start + rates * (2.0 + 0.25 + 0.25)
            if place >= 0:
                expected[place] = 2.25
            assert taken.p[:6] == pytest.approx(expected[:6], rel=1e-15)


def test_a_network_is_told_its_first_active_site_and_the_number_of_all() -> None:
    taken = steps(np.zeros((2, 7)), window=(2, 5), first=NETWORK)
    assert taken.marks[[LEFT, RIGHT]].tolist() == [2.0, 7.0]


def test_samples_are_those_of_their_times_and_of_sites_left_out_the_last_state() -> None:
    state = np.arange(8.0).reshape(2, 4)
    motion = np.array([[[1.0, -2.0], [3.0, 0.5]], [[-1.0, 0.7], [0.0, 2.0]]])
    taken = steps(
        state, motion, window=(1, 3), clock=[2.0, 0.0, 0.0, 0.0, 0.25],
        times=[2.25, 2.5, 3.0, 3.25, 3.26],
    )  # fmt: skip
    assert taken.counters[smooth.SAMPLED] == 4
    for sample, t in zip(taken.samples, (0.0, 0.25, 0.75, 1.0), strict=False):
        expected = state.copy()
        expected[:, 1:3] += t * motion[0] + t * t * motion[1]
        assert sample == pytest.approx(expected, abs=1e-14)
    assert np.isnan(taken.samples[4]).all()


@pytest.mark.parametrize("largest_error", [0.0, 1e-3, 0.2, 0.25, 0.9])
@pytest.mark.parametrize("review", [2.5, 2.6])
def test_a_step_grows_at_a_review_if_errors_were_below_a_quarter_of_the_tolerance(
    largest_error: float, review: float
) -> None:
    """By the order of the method, up to twofold; errors are forgotten then."""
    taken = steps(
        np.zeros((2, 1)), clock=[2.0, 0.5, largest_error, review, 0.0], tolerance=1.0, review=3.0,
        least_size=1.0,
    )  # fmt: skip
    growth = min(2.0, 0.9 * largest_error ** (-1 / 8)) if 0.0 < largest_error < 0.25 else 1.0
    growth = growth if largest_error else 2.0
    if review == 2.5:
        expected = [2.5, 0.5 * growth, 0.0, 5.5, 0.0]
    else:
        expected = [2.5, 0.5, largest_error, 2.6, 0.0]
    assert taken.clock == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("size", [0.5, 0.9, 3.0, 40.0])
@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e-200])
def test_the_error_of_a_compiled_step_is_that_of_its_two_estimates(
    size: float, scale: float
) -> None:
    """e5²/√(e5² + e3²/100) by scipy's weights; a step whose e3 is as large as the state is refused.

    Of two components the second one has twice the error. A state at rest has the least size.
    """
    both = np.stack([DOP853.E5[:12], DOP853.E3[:12]])
    for five, three in ((0.3, -0.2), (-0.1, 0.3), (0.01, 0.4), (1e-9, 0.45)):
        errors = np.linalg.lstsq(both, 0.5 * scale * np.array([five, three]))[0]
        taken = steps(
            np.zeros((2, 1)), clock=[0.0, 1.0, 0.0, 99.0, 0.0], tolerance=2.0, least_size=size,
            errors=errors,
        )  # fmt: skip
        e5, e3 = abs(five) * scale, abs(three) * scale
        # 1e-200 squared is no number that is not zero; of so small an error e5 is a bound.
        error = e5 / size * (1.0 if scale < 1e-100 else e5 / math.hypot(e5, 0.1 * e3))
        assert e3 < size
        assert taken.marks[TAKEN] == 1.0
        assert taken.clock[2] == pytest.approx(error / 2.0, rel=1e-6)
        if scale == 1.0 and five == 0.01:
            for smaller in (0.399, 0.401):
                found = steps(
                    np.zeros((2, 1)), clock=[0.0, 1.0, 0.0, 99.0, 0.0], tolerance=2.0,
                    least_size=smaller, errors=errors,
                )  # fmt: skip
                assert found.marks[TAKEN] == (2.0 if smaller < 0.4 else 1.0)
                assert found.clock[0] == pytest.approx(0.3 if smaller < 0.4 else 1.0)


@pytest.mark.parametrize(
    ("task", "count", "code", "taken"),
    [
        ({"end": 2.0}, 3, smooth.REACHED, 0),
        ({"end": 2.5}, 1, smooth.REACHED, 1),  # beyond it
        ({"end": 3.0}, 1, smooth.REACHED, 1),  # upon it
        ({"end": 3.5}, 1, smooth.BUDGET, 1),
        ({"end": 3.5}, 3, smooth.REACHED, 2),
        ({"shortest": 1.0}, 2, smooth.BUDGET, 2),
        ({"shortest": 1.1}, 2, smooth.TOO_SHORT, 0),
    ],
)
def test_the_compiled_loop_says_how_it_has_ended(
    task: dict[str, float], count: int, code: int, taken: int
) -> None:
    """After steps of length 1 from time 2."""
    start = [2.0, 0.0, 0.0, 0.0, 0.0]
    found = steps(np.zeros((2, 1)), [[[1.0], [-2.0]]], count=count, clock=start, **task)
    assert (found.code, found.marks[TAKEN]) == (code, taken)
    assert code != smooth.TOO_SHORT or found.clock[1] == 0.0  # a later run begins anew
    assert found.rows.x.tolist() == [taken, -2.0 * taken]
    assert found.clock[0] == 2.0 + taken
    assert found.counters[[smooth.STEPS, smooth.SITE_STEPS]].tolist() == [taken, taken]


@pytest.mark.parametrize("large", [(1.5e308, -1.5e308), (math.inf, 0.0), (0.0, math.nan)])
def test_a_state_whose_size_is_no_number_ends_the_compiled_loop(large: tuple[float, float]) -> None:
    for state in (large, large[::-1]):
        found = steps(np.array(state)[:, None])
        assert (found.code, found.marks[TAKEN]) == (smooth.NOT_FINITE, 0.0)


def test_equal_steps_add_up_where_each_alone_is_lost_to_rounding() -> None:
    found = steps(np.zeros((2, 1)), count=9, clock=[1.0, 0.0, 0.0, 0.0, 0.0], longest=2.0**-55)
    assert found.clock[0] + found.clock[4] == 1.0 + 2.0**-52
    assert found.clock[0] == 1.0 + 2.0**-52
    assert found.clock[4] == 2.0**-55


@pytest.mark.parametrize(
    ("samples", "times"), [(2, 200), (51, 199), (101, 199), (200, 200), (300, 300)]
)
def test_runs_are_compared_at_some_two_hundred_times(samples: int, times: int) -> None:
    """At different ones: a run compared twice at a time is compared once."""
    asked = np.linspace(0.0, 7.0, samples)
    every, places = _with_comparisons(asked, FRONT)
    assert np.unique(every).size == every.size >= times or samples == 2
    assert np.unique(every).size >= times
    assert np.array_equal(every if places is None else every[places], asked)
    assert (places is None) is (samples >= 200)
    long = FRONT.replace(sites=100_000)
    assert _with_comparisons(asked, long)[0] is asked


def test_runs_that_have_become_independent_are_no_farther_apart_than_is_said() -> None:
    """Each is at a distance from rest; the largest of all sites and samples count."""
    chain = AveragedChain(a=4, b=0.5, c=0.6, sites=2)
    samples = np.zeros((2, 3, 2, 2))
    samples[0, 1, 0, 1], samples[1, 2, 1, 0] = 3.0, -4.0
    one, other = (SimpleNamespace(chain=chain, samples=each) for each in samples)
    for first, second in ((one, other), (other, one)):
        found = simulate_module._independent_distance(first, second)  # type: ignore[arg-type]
        assert 7.0 <= found <= 1.5 * 7.0


def test_a_site_that_decays_from_the_level_has_arrived_when_the_run_begins() -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.0, sites=3)
    start = excite(chain, [2], 0.5)
    run = SmoothIntegration(chain, start, [1.0], level=0.5)
    for amplitude in (0.5, 0.5 * math.exp(-0.5 * chain.eps)):
        assert np.isnan(run.arrivals[[0, 2]]).all()
        assert run.arrivals[1] == 0.0
        assert run.amplitude[1] == pytest.approx(amplitude, rel=0.01)
        run.finish()
    assert run.amplitude[1] < 0.5
