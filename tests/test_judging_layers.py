"""What judges, stops, saves and labels: each on made-up runs whose answer is known by hand.

The tests of the numbers themselves run chains; those here run none, so that each rule is met by a
case that only this rule decides.
"""

from __future__ import annotations

import inspect
import math
import signal
from collections import Counter
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import mpmath
import numba
import numpy as np
import pytest
from numpy.lib import format as npy
from scipy.optimize import brentq

from fronts.catalogue import COMMANDS
from fronts.cli import main
from fronts.curves import curve
from fronts.piecewise.profile import _chosen
from paper_checks.report.document import Report
from paper_checks.ruling import Verdict, agrees
from tests.folds import fold_of
from tests.one_step import TAKEN, compiled_condition, steps
from tests.settling import prepared
from theory.averaged.breather import Reading, closed_form_fold
from theory.cells.friction import FrictionCell
from theory.cells.oscillator import OscillatorCell
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VdpChain, vdp_acceleration
from theory.parameters import ParameterError, RunError, positive
from theory.piecewise.kinetic_relation import kinetic_relation
from theory.piecewise.limits import retreat_coupling
from verification.breathers import breather as breathers
from verification.breathers import exponents
from verification.breathers import outcome as nuclei
from verification.breathers.envelope import RotatingWaves, solve_envelope_breather
from verification.breathers.floquet import floquet_multipliers
from verification.breathers.orbits import Orbits
from verification.cells import shooting
from verification.execution import sweep as sweeping
from verification.execution.files import FileError
from verification.execution.interruption import Deferred, Terminated
from verification.execution.points import Point, points_of
from verification.execution.store import Store
from verification.execution.sweep import sweep
from verification.execution.task import parameters_of
from verification.execution.time_limit import TimeIsUpError
from verification.fronts import measure, smooth
from verification.fronts.preparation import Settled
from verification.fronts.result import LeftBoundary
from verification.fronts.status import FrontStatus
from verification.fronts.watch import MARGIN, Stall, Tail, cycle_period
from verification.fronts.watch import follow as followed
from verification.maps import friction_rules, smooth_rules, state_run, vdp_rules
from verification.maps import rules as map_rules
from verification.maps import task as map_task
from verification.maps.boundary import _bracketed
from verification.maps.state import Reason, State
from verification.maps.state_map import StateMap
from verification.maps.task import StateTask
from verification.piecewise import verdict as front_verdict
from verification.quantities import fronts as fronts_of
from verification.quantities import judging, robustness
from verification.quantities import kinetic_relation as velocities
from verification.quantities.judging import BAD, PointOutcome, RobustnessTask, is_clear, judge
from verification.quantities.quantity import (
    Axis,
    Computation,
    ReferenceCheck,
    StatedValue,
    axes,
    whole,
)
from verification.quantities.registry import computation_named
from verification.references.pace import NoReferenceError
from verification.runs import checkpoint
from verification.runs.comparison import difference
from verification.runs.excite import StartPoint, excite
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers import (
    amplitudes,
    friction,
    friction_cell_phase,
    friction_series,
    kernel,
)
from verification.steppers import smooth as smooth_steps
from verification.thresholds import escape
from verification.thresholds import spreading as thresholds
from verification.thresholds.result import Definition
from verification.thresholds.spreading import Spreading, spreading_threshold, spreads
from verification.thresholds.threshold import closed_form_threshold
from verification.work_reduction import table as reductions

NAN = math.nan


# ------------------------------------------------------------------------------- the command line


def test_the_exit_code_of_the_robustness_table_is_one_if_a_point_is_bad(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    good = robustness.robustness(["c-pin"], 1, 3, workers=1)
    assert inspect.signature(robustness.robustness).parameters["resume"].default is False
    row = dict[str, object](next(iter(good.table.rows())))
    row["outcome"] = PointOutcome.EXCEEDED.value
    line = ["stress", "--json", "--quantity", "c-pin", "--points", "1"]
    for bad in ([], [row]):
        found = replace(good, bad=tuple(bad))
        monkeypatch.setattr(robustness, "robustness", lambda *_, found=found, **__: found)
        assert main(line) == len(bad)
    capsys.readouterr()


def test_the_exit_code_of_the_work_reductions_is_one_if_a_bound_is_exceeded(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for holds in (True, False):
        row = dict.fromkeys(("what", "decided", "bound", "measured", "changed", "test"), "")
        made_up = SimpleNamespace(measured=lambda row=row, holds=holds: row | {"holds": holds})
        monkeypatch.setattr(reductions, "REDUCTIONS", (made_up,))
        assert main(["stress", "--work-reduction"]) == int(not holds)
    capsys.readouterr()


def test_a_negative_error_is_as_bad_as_none() -> None:
    quantity = Computation(
        name="made-up",
        title="for this test",
        axes=(Axis(name="x", low=1.0, high=2.0),),
        compute=lambda _: StatedValue(value=1.0, error=-1e-9),
        check=lambda *_: ReferenceCheck(distance=0.0, uncertainty=1e-3, method="this test"),
        seconds=1.0,
    )
    assert judge(quantity, {"x": 1.0})["outcome"] == PointOutcome.NAN.value


# ------------------------------------------------------------------------------------------ files


def _times(factor: float, point: Any) -> float:
    return factor * float(point["x"])


def test_the_finished_table_of_another_sweep_is_not_given_back(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    for factor, points in ((2.0, [1.0, 2.0]), (3.0, [1.0, 2.0]), (3.0, [1.0, 4.0])):
        found = sweep(partial(_times, factor), {"x": points}, out=out, resume=True, workers=1)
        assert found["value"].tolist() == [factor * x for x in points]


def test_a_checkpoint_that_cannot_be_finished_leaves_the_one_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.npz"
    old, new = {"y": np.zeros(3), "z": np.zeros(2)}, {"y": np.ones(3), "z": np.ones(2)}
    checkpoint.save_checkpoint(path, old, {}, 1.0)
    written = npy.write_array

    def full(entry: Any, array: Any, **options: Any) -> None:
        if array.size == 2:
            raise OSError(28, "No space left on device")
        written(entry, array, **options)

    monkeypatch.setattr(npy, "write_array", full)
    with pytest.raises(FileError):
        checkpoint.save_checkpoint(path, new, {}, 2.0)
    found = {name: np.full_like(array, NAN) for name, array in old.items()}
    assert checkpoint.load_checkpoint(path, found, {}) == 1.0
    assert not any(array.any() for array in found.values())
    assert [each.name for each in tmp_path.iterdir()] == ["run.npz"]


# ----------------------------------------------------------------------------------------- fronts


class _Run:
    """A front that has reached every site, at times that tell by which tolerance it was run."""

    chain = AveragedChain(a=4, b=0.5, c=0.1)

    def __init__(self, tolerance: float, reached: int = 40) -> None:
        self.tolerance = tolerance
        self.state = np.zeros((2, 40))
        self.arrivals = np.where(np.arange(40) < reached, np.arange(40) + tolerance, NAN)
        self.time, self.counts, self.amplitude = 0.0, {"steps": 7}, np.zeros(40)

    def advance(self, budget: int) -> None:
        self.time += 1.0

    def going_to_rest(self) -> bool:
        return False


@pytest.mark.parametrize(("tolerance", "other"), [(1e-8, 1e-6), (1e-4, 1e-2)])
def test_the_run_beside_a_front_has_a_hundred_times_its_tolerance(
    tolerance: float, other: float
) -> None:
    found = prepared(_Run, tolerance=tolerance).trial(40, None)
    sites = np.arange(5.0, 40.0 - MARGIN)
    assert found.arrivals.tolist() == (sites + tolerance).tolist()
    assert found.coarser.tolist() == pytest.approx((sites + other).tolist(), abs=1e-12)
    assert (found.stopped, found.counts["steps"]) == (None, 14)


def test_of_a_chain_the_sites_that_the_tail_reaches_at_the_far_end_are_not_used() -> None:
    """The longest tail counts, up to a quarter of the chain, and no fewer than the last sites."""
    tail = Tail(0.1)
    for ahead, reached, longest in (([0.1, 0.1], 3, 0), ([0.2, 0.09], 3, 1), ([0.09] * 5, 3, 1),
                                    ([0.0, 0.2], 4, 2), ([0.2], 6, 2)):  # fmt: skip
        tail.note(np.array([1.0] * (reached + 1) + ahead), reached)
        assert tail.sites == longest

    def used(length: int, tail_amplitude: float) -> int:
        run = _Run(1e-8, 25)

        def advance(budget: int) -> None:
            run.time += 1.0
            run.amplitude = np.where(np.arange(40) < 25 + length, 0.5, 0.0)
            if run.time > 1.0:
                run.arrivals = np.arange(40.0)

        run.advance = advance  # type: ignore[method-assign]
        made = prepared(lambda _: run, tail_amplitude=tail_amplitude)
        return int(made.trial(40, None).arrivals.size)

    assert [used(length, 0.4) for length in (0, 7, 8, 9, 10, 11, 15)] == [
        35 - MARGIN, 35 - MARGIN, 35 - 8, 35 - 9, 35 - 10, 35 - 10, 35 - 10,
    ]  # fmt: skip
    assert used(15, math.inf) == 35 - MARGIN


@pytest.mark.parametrize(("moves", "status"), [(0.9, FrontStatus.PINNED), (1.1, "creeping")])
def test_a_front_stops_at_the_last_site_that_is_needed_and_not_before(
    moves: float, status: FrontStatus | str
) -> None:
    """One site short of the margin it is no arrival at the end, and settled or creeping."""
    rule: Any = {"stall_time": 10.0, "settling_tolerance": 1e-3}
    assert followed(_Run(1e-8, 40 - MARGIN), **rule) is None  # type: ignore[arg-type]
    short = _Run(1e-8, 40 - MARGIN - 1)

    def advance(budget: int) -> None:
        short.time += 1.0
        short.amplitude = np.full(40, moves * 1e-3 * (short.time > 15.0))

    short.advance = advance  # type: ignore[method-assign]
    found = followed(short, **rule)  # type: ignore[arg-type]
    assert found is FrontStatus(status)
    assert short.time == 22.0  # the first after twice the stall time since the arrival at 1


# ------------------------------------------------------------------------------------- thresholds


@pytest.mark.parametrize(
    ("definition", "reached", "enough"),
    [
        (Definition.FIRST, [], False),
        (Definition.FIRST, [6], True),
        (Definition.SEVERAL, [2, 3, 4, 6, 7], False),
        (Definition.SEVERAL, [2, 3, 4, 6, 7, 8], True),
        (Definition.WHOLE, [1, 2, 3, 4, 6, 7, 8], False),
        (Definition.WHOLE, [1, 2, 3, 4, 6, 7, 8, 9], True),
    ],
)
def test_of_some_definitions_one_site_is_enough_and_of_others_all_are_needed(
    definition: Definition, reached: list[int], enough: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = SimpleNamespace(finished=False, arrivals=np.full(9, NAN), going_to_rest=lambda: True)
    run.arrivals[[site - 1 for site in reached]] = 1.0
    run.arrivals[4] = 0.0  # the nucleus itself
    run.advance = lambda _: None
    ends: list[float] = []

    def integration(*_: object, end: float, **__: object) -> Any:
        ends.append(end)
        return run

    monkeypatch.setattr(thresholds, "integration", integration)
    asked = Spreading(place=Place.BULK, definition=definition, displacement=1.0, final_time=20.0)
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=9, eps=0.01)
    assert spreads(chain, asked) is enough
    assert spreads(chain, asked, 40.0) is enough
    assert ends == pytest.approx([2000.0, 4000.0])  # in t, of times in εt


C_TRUE = 0.0314159


def _known(
    monkeypatch: pytest.MonkeyPatch, *, finer: float = 0.0, later: float = 0.0, other: float = 0.0
) -> None:
    """Let a nucleus spread from `C_TRUE` on; from elsewhere in finer or longer runs.

    With each doubling of the time it is as much lower. Near one other coupling it is otherwise.
    """

    def made_up(chain: Any, spreading: Spreading, final_time: float, _: Any) -> bool:
        limit = C_TRUE
        if spreading.tolerance < 1e-8:
            limit += finer
        limit -= later * math.log2(final_time / spreading.final_time)
        return bool((chain.c > limit) is not (abs(chain.c - other) < 1e-4))

    monkeypatch.setattr(thresholds, "spreads", made_up)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6])
def test_the_error_of_a_threshold_is_half_of_its_bracket(
    accuracy: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    _known(monkeypatch)
    found = spreading_threshold(
        FrictionChain(c=0.0), Spreading(), accuracy=accuracy, lowest=1e-3, tests=12
    )
    assert found.low <= C_TRUE <= found.high
    assert 0.1 * accuracy < found.high - found.low <= accuracy
    assert found.low + found.error == pytest.approx(found.high - found.error, rel=1e-14)
    assert abs(found.c_crit - C_TRUE) <= found.error <= 0.5 * accuracy
    assert (found.monotone, found.fuzzy, found.c_crit_at_twice_the_time) == (
        True,
        None,
        found.c_crit,
    )


def test_what_a_finer_tolerance_changes_of_a_threshold_is_three_times_in_its_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for shift in (1e-4, -1e-4):
        _known(monkeypatch, finer=shift)
        found = spreading_threshold(
            FrictionChain(c=0.0), Spreading(), accuracy=1e-6, tests=0, lowest=1e-3
        )
        assert 2.98e-4 < found.error < 3.03e-4
        assert found.c_crit_at_twice_the_time_error is None
    for later in (0.0, 5e-4):
        _known(monkeypatch, finer=1e-4, later=later)
        found = spreading_threshold(
            FrictionChain(c=0.0), Spreading(), accuracy=1e-6, lowest=1e-3, tests=12
        )
        assert 2.98e-4 < found.c_crit_at_twice_the_time_error < 3.03e-4
    _known(monkeypatch, finer=1e-3)  # nowhere but in the error
    found = spreading_threshold(
        FrictionChain(c=0.0), Spreading(), accuracy=1e-6, lowest=1e-3, tests=12
    )
    assert (found.monotone, found.fuzzy, found.c_crit_at_twice_the_time) == (
        True, None, found.c_crit
    )  # fmt: skip


def test_a_threshold_that_is_late_or_has_gaps_is_fuzzy(monkeypatch: pytest.MonkeyPatch) -> None:
    _known(monkeypatch, later=5e-4)

    late = spreading_threshold(
        FrictionChain(c=0.0), Spreading(), accuracy=1e-6, lowest=1e-3, tests=12
    )
    off = abs(late.c_crit_at_twice_the_time - (C_TRUE - 5e-4))
    assert off <= late.c_crit_at_twice_the_time_error <= 5e-7
    assert late.fuzzy == (late.c_crit_at_twice_the_time, late.c_crit)
    assert late.monotone
    for later in (1e-6, 3e-6):
        _known(monkeypatch, later=later)
        found = spreading_threshold(
            FrictionChain(c=0.0), Spreading(), accuracy=1e-6, lowest=1e-3, tests=12
        )
        assert (found.fuzzy is None) is (later < 2e-6)
    for place in (-5, 5):
        other = late.c_crit * (1.0 + 0.2 * place / 12)  # one of the couplings that are tried
        _known(monkeypatch, other=other)
        torn = spreading_threshold(
            FrictionChain(c=0.0), Spreading(), accuracy=1e-6, lowest=1e-3, tests=12
        )
        assert not torn.monotone
        assert torn.fuzzy is not None
        assert torn.fuzzy == pytest.approx(sorted([torn.c_crit, other]), rel=1e-14)


# ----------------------------------------------------------------------------------------- labels


def _windows(*sites: tuple[float, float]) -> list[Any]:
    low, high = np.array(sites).T
    return [smooth_rules._Window(high, low)] * smooth_rules.HOLD


def test_of_a_filled_chain_every_site_is_above_and_of_a_breather_some() -> None:
    up, down, passes = (2.0, 2.1), (0.1, 0.2), (0.5, 2.0)
    named = smooth_rules._state_of
    assert named(_windows(up, up, up, up), 1.0, True) is State.FRONT
    for few in ((up, up, up, down), (up, up, down, down), (up, up, up, passes)):
        assert named(_windows(*few), 1.0, True) is State.BREATHER
        assert named(_windows(*few), 1.0, False) is State.UNDECIDED
    assert named(_windows(down, down), 1.0, True) is State.UNDECIDED
    assert named(_windows(up, up)[:-1], 1.0, True) is State.UNDECIDED


@pytest.mark.parametrize(
    ("heights", "state"),
    [
        ([8e-4, 6e-4, 4e-4, 2e-4], State.FIXED_POINT),
        ([8e-4, 6e-4, 6e-4, 2e-4], State.UNDECIDED),
        ([8e-4, 4e-4, 6e-4, 2e-4], State.UNDECIDED),
        ([8.0, 6.0, 4.0, 2.0], State.UNDECIDED),
        ([8e-3, 6e-3, 4e-3, 1.1e-3], State.UNDECIDED),
    ],
)
def test_rest_is_a_fall_in_every_window(heights: list[float], state: State) -> None:
    windows = [smooth_rules._Window(np.full(3, high), np.zeros(3)) for high in heights]
    assert smooth_rules._state_of(windows, 1.0, True) is state


def test_a_window_differs_from_the_one_before_by_the_larger_change_of_either_end() -> None:
    before = smooth_rules._Window(np.array([2.0, 2.0]), np.array([1.0, 1.0]))
    for high, low, change in (
        ([2.0, 2.0], [1.0, 1.0], 0.0),
        ([2.0, 2.0], [1.0, 0.75], 0.25),
        ([2.5, 2.0], [1.0, 1.0], 0.5),
        ([2.5, 2.0], [1.0, 0.25], 0.75),
    ):
        after = smooth_rules._Window(np.array(high), np.array(low))
        assert smooth_rules._change(before, after) == smooth_rules._change(after, before) == change


@pytest.mark.parametrize("start", [None, -5.0, 0.0, 0.3, 1.0, 5.0])
def test_a_boundary_is_sought_within_its_line_from_wherever_it_is_predicted(
    start: float | None,
) -> None:
    asked: list[float] = []

    def is_low(x: float) -> bool:
        asked.append(x)
        return x < 0.3

    low, high = _bracketed(is_low, (0.0, 1.0), 1e-3, start)
    assert low < 0.3 <= high
    assert high - low <= 1e-3 * (1.0 + 1e-8)
    assert all(0.0 < x < 1.0 for x in asked)
    assert len(asked) == len(set(asked))


@pytest.mark.parametrize(("over", "runs"), [(1e-10, 1), (1e-7, 2)])
def test_a_bracket_is_as_narrow_as_asked_to_within_rounding(over: float, runs: int) -> None:
    """A half that is wider than the width by more than that is halved once more."""
    asked: list[float] = []
    _bracketed(lambda x: bool(asked.append(x)), (0.0, 1.0), 0.5 / (1.0 + over), None)
    assert len(asked) == runs


def test_a_bracket_ends_where_no_number_is_left_between_its_ends() -> None:
    """Along values so large that the width asked for is below the distance between two of them."""
    asked: list[float] = []

    def is_low(x: float) -> bool:
        asked.append(x)
        assert len(asked) < 100
        return x < 1e20 + 5e4

    low, high = _bracketed(is_low, (1e20, 1e20 + 1e5), 1e-3, None)
    assert low < 1e20 + 5e4 <= high
    assert high == np.nextafter(low, math.inf)


def test_the_noise_of_a_map_is_relative_to_the_largest_displacement_of_either_sign() -> None:
    start = np.array([[0.0, 0.5, -3.0], [0.0, 0.0, 0.0]])
    noise, of_twice, of_opposite = (
        map_rules._noisy(each, 1e-3, 5) - each for each in (start, 2.0 * start, -start)
    )
    assert 0.0 < np.abs(noise).max() < 10.0 * 1e-3 * 3.0
    np.testing.assert_allclose(of_twice, 2.0 * noise, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(of_opposite, noise, rtol=1e-9, atol=1e-12)


def test_the_chain_of_fig_15_is_that_of_its_caption() -> None:
    """With b as in Figs. 7 to 13; η and c vary."""
    chain = vdp_rules.FIGURE_15
    assert (chain.sites, chain.eps, chain.b, chain.ends) == (16, 0.01, 0.5, Ends.FREE)
    assert np.argwhere(vdp_rules.start(chain, None)).tolist() == [[0, 15]]
    assert vdp_rules.start(chain, None)[0, 15] == 6.0


@pytest.mark.parametrize(("held", "follows"), [("a", "b"), ("b", "a")])
def test_of_a_map_over_eta_the_coefficient_that_is_held_is_told(held: str, follows: str) -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.6, sites=16)
    task = StateTask(chain=chain, held=held)
    nothing: Any = None
    found = StateMap(
        task=task, axes=("eta", "c"), states=nothing, boundary=None, map_seconds=0.0, seconds=0.0
    )
    assert found.held[held] == getattr(chain, held)
    assert not {follows, "c"} & found.held.keys()


def test_the_noise_of_a_map_and_its_excited_sites_are_those_that_are_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain = FrictionChain(c=0.05, sites=7)
    rest = friction_rules.start(chain, (1,), 0.5)[0, 1]
    for sites, places in ((None, [3]), ((2,), [1]), ((1, 7), [0, 6])):
        start = friction_rules.start(chain, sites, 0.5)
        assert np.flatnonzero(start[0] != rest).tolist() == places
    seeds: list[int] = []

    def perturbed(_: object, __: float, seed: int) -> None:
        seeds.append(seed)
        raise KeyboardInterrupt

    rules = replace(map_task.rules_of(chain), perturbed=perturbed)
    monkeypatch.setattr(map_task, "rules_of", lambda _: rules)
    for seed in (None, 11):
        with pytest.raises(KeyboardInterrupt):
            map_task.StateTask(chain=chain, displacement=0.5, seed=seed)({"c": 0.05})  # type: ignore[arg-type]
    assert seeds == [rules.seed, 11]


UNSTABLE = AveragedChain(a=4, b=0.5, c=0.1, sites=4)


@pytest.mark.parametrize(
    ("third", "state"),
    [((0.1, 0.2), State.BREATHER), ((1.5, 2.0), State.BREATHER), ((0.5, 2.0), State.UNDECIDED)],
)
def test_what_passes_the_level_again_and_again_is_not_steady(
    third: tuple[float, float], state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of four sites in windows that are alike: one above, two below, and the third."""
    level = UNSTABLE.unstable_amplitude
    low, high = np.array([(1.5, 2.0), (0.1, 0.2), third, (0.1, 0.2)]).T * level
    window = smooth_rules._Window(high, low)
    monkeypatch.setattr(smooth_rules, "_through_window", lambda _, at, __: (at, window, 7))
    found = smooth_rules.find_smooth_state(UNSTABLE, np.zeros((2, 4)), end=1000.0)
    assert found.state is state
    assert found.steps == 7 * round(found.time / smooth_rules.WINDOW)
    assert found.above == np.count_nonzero(high > level)


def test_of_a_window_the_largest_and_the_smallest_amplitudes_are_kept() -> None:
    """Without springs a site beyond the unstable cycle leaves it, and one within it decays."""
    chain = UNSTABLE.replace(c=0.0, sites=2)
    start = np.array([[1.1, 0.9], [0.0, 0.0]]) * chain.unstable_amplitude
    state, window, _ = smooth_rules._through_window(chain, start, 1e-9)
    end = np.hypot(*state)
    assert start[0, 0] < window.low[0] < window.high[0] == pytest.approx(end[0], rel=1e-8)
    assert end[1] == pytest.approx(window.low[1], rel=1e-8)
    assert window.low[1] < window.high[1] < start[0, 1]


class _FrictionRun:
    """A made-up run of a friction chain of unit amplitudes whose sites have not stuck."""

    def __init__(self, _: object, start: Any, **__: object) -> None:
        self.time, self.counts = 0.0, {"steps": 1}
        self.amplitude, self.arrivals = np.ones(start.shape[1]), np.full(start.shape[1], NAN)

    def forget_arrivals(self) -> None:
        pass

    def advance_to(self, time: float) -> None:
        self.time = time

    def going_to_rest(self) -> bool:
        return False


def test_sites_above_the_level_are_counted_in_the_last_window(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """If there is one: an end time of less than two windows leaves none."""
    heights = UNSTABLE.unstable_amplitude * np.tri(4)  # one site more in each window
    for count, above in ((0, 0), (1, 1), (3, 3)):
        windows = iter([smooth_rules._Window(2.0 * each, 2.0 * each) for each in heights])
        monkeypatch.setattr(
            smooth_rules, "_through_window", lambda _, at, __, of=windows: (at, next(of), 1)
        )
        found = smooth_rules.find_smooth_state(
            UNSTABLE, np.zeros((2, 4)), end=(2 * count + 1) * smooth_rules.WINDOW
        )
        assert (found.above, found.reached, found.time) == (above, above, count * 5.0)


def test_a_site_that_comes_above_the_level_by_however_little_is_not_steady(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In the second of the windows, which would else be the breather of the first."""
    excess = iter([-4e-6, *[4e-6] * 8])

    def risen(_: object, at: Any, __: float) -> Any:
        amplitude = UNSTABLE.unstable_amplitude * np.array([1.5, 1.0 + next(excess), 0.1, 0.1])
        return at, smooth_rules._Window(amplitude, amplitude), 1

    monkeypatch.setattr(smooth_rules, "_through_window", risen)
    found = smooth_rules.find_smooth_state(UNSTABLE, np.zeros((2, 4)), end=100.0)
    assert (found.state, found.time, found.reached) == (State.BREATHER, 20.0, 2)


def test_the_noise_of_a_friction_chain_has_the_size_that_is_given() -> None:
    start = np.ones((2, 5000))
    noise = friction_rules.perturbed(start, 1e-3, 4) - start
    assert noise.std() == pytest.approx(1e-3, rel=0.05)  # of 10⁴ numbers: seven deviations
    assert abs(noise.mean()) < 1e-4
    assert np.abs(noise).max() < 6e-3
    assert np.array_equal(friction_rules.perturbed(start, 1e-3, 4) - start, noise)
    assert not np.array_equal(friction_rules.perturbed(start, 1e-3, 5) - start, noise)


def test_at_the_fold_of_cycles_and_at_a_double_zero_of_the_damping_amplitudes_are_finite() -> None:
    """At η = 1/8 the cycles have a² = 8/a, and at η = 1/4 the damping is (1 - ay²/2)²."""
    assert vdp_rules.level_of(4.0, 2.0) == pytest.approx(math.sqrt(2.0), rel=1e-15)
    assert vdp_rules.positive_damping_square(4.0, 4.0) == 0.5


@pytest.mark.parametrize("drift", [0.98e-5, 1.1e-5, -1.1e-5])
def test_of_a_breather_no_amplitude_changes_by_more_than_1e_5_of_the_level(
    drift: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From one window of slow time 5 to the next, and in the friction chain of the unit of y."""
    level = UNSTABLE.unstable_amplitude
    amplitude = level * np.array([1.5, 0.1, 0.1, 0.1])

    def moved(_: object, at: Any, __: float) -> Any:
        amplitude[0] += drift * level
        return at, smooth_rules._Window(amplitude.copy(), amplitude.copy()), 1

    monkeypatch.setattr(smooth_rules, "_through_window", moved)
    found = smooth_rules.find_smooth_state(UNSTABLE, np.zeros((2, 4)), end=100.0)

    class Run(_FrictionRun):
        def advance_to(self, time: float) -> None:
            self.time, self.amplitude = time, self.amplitude + np.array([0.0, drift])
            self.arrivals[0] = 0.0

    monkeypatch.setattr(friction_rules, "FrictionIntegration", Run)
    chain = FrictionChain(c=0.05, sites=2)
    sliding = friction_rules.find_friction_state(chain, np.zeros((2, 2)), end=2000.0)
    settled = abs(drift) < 1e-5
    for each, at_once, at_end in ((found, 10.0, 50.0), (sliding, 80.0, 1000.0)):
        assert each.state is (State.BREATHER if settled else State.UNDECIDED)
        assert each.time == (at_once if settled else at_end)


@pytest.mark.parametrize(
    ("sticking", "state"),
    [((), State.UNDECIDED), ((1,), State.BREATHER), ((0, 1, 2, 3), State.BREATHER),
     (range(5), State.FRONT)],
)  # fmt: skip
def test_a_steady_friction_chain_is_a_breather_if_some_but_not_all_sites_stick(
    sticking: Sequence[int], state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With all of them it is a front."""

    class Run(_FrictionRun):
        def advance_to(self, time: float) -> None:
            self.time, self.arrivals[list(sticking)] = time, 0.0

    monkeypatch.setattr(friction_rules, "FrictionIntegration", Run)
    chain = FrictionChain(c=0.05, sites=5)
    found = friction_rules.find_friction_state(chain, np.zeros((2, 5)), end=400.0)
    assert (found.state, found.above) == (state, len(sticking))


def _state_of(chain: AveragedChain, excited: Sequence[int], **rules: float) -> Any:
    """Run a chain from excited sites until its state is named, by rules with these departures."""
    usual = {"rest_bound": 1e-3, "stiffness": 0.0, "hold": 10.0, "window": 2.0, "end": 100.0}
    start, level = excite(chain, excited), chain.unstable_amplitude
    given: Any = usual | {"tolerance": 1e-8} | rules
    return state_run.run_to_state(chain, start, level=level, **given)


@pytest.mark.parametrize("hold", [3.0, 8.0])
def test_a_filled_chain_is_a_front_when_it_has_been_filled_for_so_long(hold: float) -> None:
    found = _state_of(UNSTABLE, range(1, 5), hold=hold, window=5.0, settled=1e-5)
    assert found.state is State.FRONT
    assert hold <= found.time < hold + 1.5


def test_a_breather_is_named_the_later_the_less_its_amplitudes_may_still_change() -> None:
    """They tend to theirs at a rate r: a hundredth of the change is left after log(100)/r."""
    chain = AveragedChain(a=4, b=0.5, c=0.05, sites=6)
    times = []
    for settled in (1e-2, 1e-4, 1e-6):
        found = _state_of(chain, [3], settled=settled, end=400.0, tolerance=1e-10)
        assert found.state is State.BREATHER
        times.append(found.time)
    assert times[0] < times[1] < times[2]


def test_a_stop_condition_that_counts_sites_is_given_all_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Also those at rest, which a run without one leaves out."""
    made: list[SmoothIntegration] = []

    def integration(*given: Any, **options: Any) -> SmoothIntegration:
        made.append(SmoothIntegration(*given, **options))
        return made[-1]

    monkeypatch.setattr(state_run, "SmoothIntegration", integration)
    chain = AveragedChain(a=4, b=0.5, c=0.05, sites=40)
    found = _state_of(chain, [3], settled=1e-3)
    (run,) = made
    assert (found.state, found.above) == (State.BREATHER, 1)
    assert run.counts["site_steps"] == 40 * found.steps
    usual = SmoothIntegration(chain, excite(chain, [3]), [1.0])
    usual.advance(usual.default_budget)
    assert usual.counts["site_steps"] < 40 * usual.counts["steps"]


INDICES = {
    friction_series: (
        "MU_ST MU_D V0 XI V_D C TOLERANCE REST SLIDING CLOCK DROP DRAG STEEPEST JUMP",
        "Y W OWN SIGN BEND START END EVENT ARRIVAL LAST_MAXIMUM LAST_MINIMUM STEP SUM TERM "
        "LAST_TERM ROWS",
        "Y W E Q", "MODE RELEASED DUE FIRST BEYOND", "POLYNOMIAL KEPT",
    ),
    friction: (
        "STICK_BEGINS STICK_ENDS REVERSAL",
        "LO HI SAMPLED FRAMES SITE_FRAMES LOGGED STANDING LOCAL KINDS",
    ),
    smooth_steps: ("LO HI SAMPLED STEPS SITE_STEPS STIFF_STEPS OUTCOME",),
    state_run: (
        "_LEVEL _REST_BOUND _STIFFNESS _HOLD _WINDOW _SETTLED _OSCILLATES _FILLED _LASTING _FIRST "
        "_BEGIN _NEXT _COUNT _ABOVE _SITES",
    ),
}  # fmt: skip
"""Names of the rows of each array of compiled code, by module; the last may be their number."""


def test_rows_of_the_arrays_of_compiled_code_have_one_meaning_each_and_none_is_beyond() -> None:
    """Compiled code does not ask where an array ends, and what is beyond it is another's."""
    for module, arrays in INDICES.items():
        for names in arrays:
            found = [getattr(module, name) for name in names.split()]
            assert found == [*range(len(found))], (module.__name__, names)
    assert friction_series.BINOMIALS == friction_series.KEPT + 2  # two are kept, of either side


def test_marks_of_a_phase_that_does_not_end_are_no_times_and_differ() -> None:
    failed, abandoned = friction_cell_phase.FAILED, friction_cell_phase.ABANDONED
    assert failed < 0.0 > abandoned != failed


def _memory(*sites: tuple[float, float]) -> np.ndarray:
    memory = np.zeros(state_run._SITES + 2 * len(sites))
    memory[[state_run._LEVEL, state_run._SETTLED, state_run._HOLD]] = 1.0, 1e-3, 5.0
    memory[[state_run._FILLED, state_run._LASTING]] = -1.0
    memory[state_run._ABOVE] = sum(high > 1.0 for _, high in sites)
    memory[state_run._SITES :] = np.array(sites).T.ravel()
    return memory


def test_compiled_code_finds_the_time_and_the_forces_among_its_parameters() -> None:
    """The time; then frequency, phase and cosine of each force."""
    chain = OscillatorChain(
        damping="1", values={}, c=0.1, eps=0.1, sites=4, drive=("0.2,1.5@1", "0.3,2.5@2")
    )
    place, p = smooth_steps.clock_place(chain), chain.kernel_parameters()
    assert p[place] == 0.0
    assert list(p[place + 1 : place + 7 : 3]) == [1.5, 2.5]


def test_a_wave_beyond_the_left_end_is_as_many_quarter_turns_ahead_as_fronts_lag(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(kernel, "compiled_slope", lambda *given: given[-1])
    for step in range(-3, 4):
        chain: Any = SimpleNamespace(
            kernel=lambda: vdp_acceleration, network=None, kernel_layout=(3,), front_phase_step=step
        )
        assert 1j ** kernel.slope_of(chain) == pytest.approx(1j**-step)
        assert 0 <= kernel.slope_of(chain) < 4


def test_the_right_hand_side_of_a_network_is_made_of_its_kernel_and_layout(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(kernel, "network_slope", lambda *given: given)
    chain: Any = SimpleNamespace(
        kernel=lambda: vdp_acceleration, network="links", kernel_layout=(3, 2, 1)
    )
    made: Any = kernel.slope_of(chain)
    assert made[0] is vdp_acceleration
    assert isinstance(made[1], str)
    assert made[2:] == (3, 2, 1)


def test_disturbances_that_share_a_row_are_those_that_have_one_each(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rho = np.linspace(1.0, 0.0, 80)
    chain = amplitudes.Amplitudes(0.5, 0.03125, 4.0)
    few = amplitudes.with_disturbances(rho, chain, 2.0, 20)[2]
    monkeypatch.setattr(amplitudes, "_reach", lambda _: 80)
    each = amplitudes.with_disturbances(rho, chain, 2.0, 20)[2]
    assert np.abs(few - each).max() < 1e-18
    assert np.count_nonzero(few) < 0.6 * few.size


def test_a_window_is_settled_if_all_its_sites_are() -> None:
    up, down = (2.0, 2.0005), (0.1, 0.1005)
    settled = state_run._settled.py_func
    assert settled(3, _memory(up, down, down))
    for other in ((2.0, 2.01), (0.9999, 1.0004)):
        for place in range(3):
            sites = [up, down, down]
            sites[place] = other
            memory = _memory(*sites)
            memory[state_run._ABOVE] = 1.0
            assert not settled(3, memory)
    assert not settled(2, _memory(down, down))


def test_sites_above_a_level_are_those_whose_root_is_above_it() -> None:
    """Squares decide, but where the two could differ by rounding, the root does.

    The root of compiled code: Python's own differs from it in the last bit.
    """
    is_above = numba.njit(lambda y, w, level: math.hypot(y, w) > level)
    rng = np.random.default_rng(3)
    for level in (1.035276, 3e-7, 2.5e8):
        phase = rng.uniform(0.0, 2.0 * np.pi, (2000, 6))
        size = level * (1.0 + rng.choice([0.0, 1e-16, -1e-16, 1e-13, -1e-13, 0.5], (2000, 6)))
        for state in np.hstack([size * np.cos(phase), size * np.sin(phase)]):
            above = [is_above(y, w, level) for y, w in state.reshape(2, 6).T]
            assert state_run.sites_above(state, level) == sum(above)
    assert state_run.sites_above(np.full(4, 1e150), np.inf) == 0


@pytest.mark.parametrize(
    ("course", "filled", "lasting"),
    [
        # for as long again, and for five at least
        ([(3.0, 4), (7.9, 4)], False, 3.0),
        ([(3.0, 4), (8.0, 4)], True, 3.0),
        ([(9.0, 4), (17.9, 4)], False, 9.0),
        ([(9.0, 4), (18.0, 4)], True, 9.0),
        # a site that falls below begins the time anew, but half of the chain is still there
        ([(3.0, 4), (6.0, 3), (7.0, 4), (13.9, 4)], False, 3.0),
        ([(3.0, 4), (6.0, 2), (7.0, 4), (14.0, 4)], True, 3.0),
        ([(3.0, 4), (6.0, 1), (7.0, 4), (13.9, 4)], False, 7.0),
        ([(0.0, 4), (4.9, 4)], False, 0.0),
        ([(0.0, 4), (5.0, 4)], True, 0.0),
        ([(3.0, 4), (9.0, 1)], False, -1.0),
        ([(3.0, 3), (9.0, 3)], False, -1.0),
    ],
)
def test_a_front_is_a_chain_that_stays_filled_for_as_long_again(
    course: list[tuple[float, int]], filled: bool, lasting: float
) -> None:
    """Not one that has been filled once: at η = 0.09, c = 0.4 one of 16 sites is left after it."""
    memory = _memory(*[(0.0, 0.0)] * 4)
    for t, above in course:
        state = np.zeros(8)
        state[:above] = 2.0
        found = state_run._filled.py_func(t, state, memory)
    assert found is filled
    assert memory[state_run._LASTING] == lasting


# The compiled functions that it calls, of which each test below reaches some, are _take_sample,
# _to_section, _settled, _filled, sites_above, _stays and at_rest_for_ever.
NAMED = compiled_condition(state_run.named_state)


def _watched(memory: np.ndarray, y: Any, w: Any, motion: Any = (), **given: Any) -> Any:
    """Take a step under the compiled stop condition, with these numbers in its memory."""
    numbers = {"_FIRST": -1.0, "_NEXT": 99.0, "_WINDOW": 999.0}
    clock = [given.pop("t", 0.0), 0.0, 0.0, 0.0, 0.0]
    for name in [name for name in given if name.startswith("_")]:
        numbers[name] = given.pop(name)
    memory = memory.copy()
    for name, number in numbers.items():
        memory[getattr(state_run, name)] = number
    found = steps([y, w], motion, clock=clock, memory=memory, watch=NAMED, **given)
    found.outcome = found.counters[smooth_steps.OUTCOME]
    found.named = {
        name: found.memory[getattr(state_run, name)] for name in INDICES[state_run][0].split()[:-1]
    }
    found.lowest, found.highest = np.split(found.memory[state_run._SITES :], 2)
    return found


@pytest.mark.parametrize(
    ("before", "rate", "at"),
    [
        (-0.5, 1.0, 0.5),
        (-0.25, 1.0, 0.25),
        (-0.5, 0.5, 1.0),  # just at the end of the step
        (-0.5, 0.25, None),  # not yet
        (0.0, 1.0, None),  # at the end of the step before
        (0.5, 1.0, None),
        (0.5, -1.0, None),  # downwards
    ],
)
@pytest.mark.parametrize("count", [0.0, 3.0])
def test_amplitudes_are_those_at_which_the_last_site_rises_through_zero(
    before: float, rate: float, at: float | None, count: float
) -> None:
    """Of three sites; in the compiled stop condition, and once a sample is due."""
    y, w = np.array([3.0, 0.5, before]), np.array([4.0, 0.0, -2.0])
    motion = [[[0.0, 1.0, rate], [0.0, 2.0, 0.5]]]
    memory = _memory((0.25, 5.5), (0.2, 0.3), (1.9, 2.0))
    memory[[state_run._LEVEL, state_run._OSCILLATES, state_run._COUNT]] = 5.0, 1.0, count
    for due in (1.0, 2.0, 2.5):
        found = _watched(memory, y, w, motion, t=2.0, _NEXT=due, _WINDOW=8.0, _ABOVE=2.0)
        if at is None or due > 2.0:
            assert found.named["_COUNT"] == count
            assert found.named["_NEXT"] == due
            assert found.memory[state_run._SITES :].tolist() == [0.25, 0.2, 1.9, 5.5, 0.3, 2.0]
            continue
        section = np.array([3.0, 0.5 + at, 0.0, 4.0, 2.0 * at, -2.0 + 0.5 * at])
        assert found.rows.inside == pytest.approx(section, abs=1e-12)
        sizes = np.hypot(*section.reshape(2, 3))
        lowest, highest = sizes, sizes
        if count:
            lowest = np.minimum(sizes, [0.25, 0.2, 1.9])
            highest = np.maximum(sizes, [5.5, 0.3, 2.0])
        assert found.lowest == pytest.approx(lowest, abs=1e-12)
        assert found.highest == pytest.approx(highest, abs=1e-12)
        assert found.named["_COUNT"] == count + 1.0
        assert found.named["_NEXT"] == due + 8.0 / 16.0
        assert found.named["_ABOVE"] == 0.0  # an amplitude of 5 is not above the level
        assert found.outcome == 0


def test_amplitudes_of_what_does_not_oscillate_are_taken_at_the_beginning_of_a_step() -> None:
    memory = _memory((7.0, 8.0), (7.0, 8.0))
    found = _watched(memory, [3.0, 1.0], [4.0, 0.0], [[[1.0, 1.0], [1.0, 1.0]]], t=2.0, _NEXT=2.0)
    assert found.lowest.tolist() == found.highest.tolist() == [5.0, 1.0]
    assert (found.named["_COUNT"], found.named["_ABOVE"]) == (1.0, 1.0)
    late = _watched(memory, [3.0, 1.0], [4.0, 0.0], t=2.0, _NEXT=2.5)
    assert late.lowest.tolist() == [7.0, 7.0]
    assert (late.named["_COUNT"], late.named["_NEXT"]) == (0.0, 2.5)


@pytest.mark.parametrize(
    ("y", "coefficients", "time"),
    [(-1e-3, (0.0, 0.0, 1.0), 0.1), (-0.999, (3.0, -3.0, 1.0), 0.9), (-0.2, (0, 1, 0), 0.2**0.5)],
)
def test_the_compiled_search_for_zero_takes_few_steps_where_secants_keep_an_end(
    y: float, coefficients: tuple[float, float, float], time: float
) -> None:
    motion = np.zeros((3, 2, 2))
    motion[:, 0, 1], motion[0, 1, 0] = coefficients, 1.0
    memory = _memory((1.0, 1.0), (1.0, 1.0))
    memory[state_run._OSCILLATES] = 1.0
    found = _watched(memory, [3.0, y], [0.0, 0.0], motion, _NEXT=0.0)
    assert abs(found.rows.inside[1]) <= 1e-12
    # The time of the section, by the other site; where y is flat it is less sharp.
    assert found.rows.inside[2] == pytest.approx(time, abs=1e-10)
    assert found.marks[TAKEN] < 20.0


UP, DOWN = (2.0, 2.0005), (0.1, 0.1005)


@pytest.mark.parametrize(
    ("sites", "numbers", "first", "breather"),
    [
        # the windows of this length that end at t = 5 have been settled since 5, 2.5, 0.5 or 2.6
        ([UP, DOWN, DOWN], {}, 5.0, False),
        ([UP, DOWN, DOWN], {"_FIRST": 2.5}, 2.5, True),
        ([UP, DOWN, DOWN], {"_FIRST": 0.5}, 0.5, True),
        ([UP, DOWN, DOWN], {"_FIRST": 2.6}, 2.6, False),
        ([UP, DOWN, DOWN], {"_FIRST": 2.5, "_ABOVE": 0.0}, -1.0, False),
        ([UP, DOWN, DOWN], {"_FIRST": 2.5, "_ABOVE": 3.0}, -1.0, False),
        ([DOWN, DOWN, (2.0, 2.01)], {"_FIRST": 2.5}, -1.0, False),
        ([UP, (0.9999, 1.0004), DOWN], {"_FIRST": 2.5}, -1.0, False),
        ([(1.0, 1.0005), DOWN, DOWN], {"_FIRST": 2.5}, -1.0, False),
        ([(0.9996, 1.0), DOWN, UP], {"_FIRST": 2.5}, -1.0, False),
        ([UP, DOWN, (0.25, 0.5)], {"_FIRST": 2.5, "_SETTLED": 0.25}, 2.5, True),
    ],
)
def test_the_compiled_stop_condition_names_a_breather_that_has_been_settled_for_half_the_time(
    sites: list[tuple[float, float]], numbers: dict[str, float], first: float, breather: bool
) -> None:
    given = {"_COUNT": 16.0, "_BEGIN": 1.0, "_WINDOW": 4.0, "_ABOVE": 1.0} | numbers
    at = {"t": 4.0, "y": [3.0, 0.0, 0.0], "w": [0.0] * 3}
    found = _watched(_memory(*sites), **at, **given)
    assert found.outcome == (2 if breather else 0)
    if first > 0.0:
        assert found.named["_FIRST"] == first
    else:
        assert found.named["_FIRST"] < 0.0
    if not breather:
        assert [found.named[name] for name in ("_BEGIN", "_COUNT", "_NEXT")] == [5.0, 0.0, 5.0]
    # Before the end of the window, and where it has too few samples, it goes on.
    for other in ({"_BEGIN": 1.001}, {"_COUNT": 7.0}):
        goes_on = given | {"_FIRST": 2.5, "_NEXT": 5.5} | other
        found = _watched(_memory(*sites), **at, **goes_on)
        assert found.outcome == 0
        for name in ("_FIRST", "_BEGIN", "_COUNT", "_NEXT"):
            assert found.named[name] == goes_on[name]


@pytest.mark.parametrize(
    ("above", "filled", "lasting", "t", "expected", "front"),
    [
        (5, -1.0, -1.0, 3.0, (3.0, 3.0), False),
        (5, 3.0, 1.0, 7.5, (3.0, 1.0), False),
        (5, 3.0, 1.0, 8.0, (3.0, 1.0), True),
        (5, 9.0, 1.0, 17.5, (9.0, 1.0), False),
        (5, 9.0, 1.0, 18.0, (9.0, 1.0), True),
        (5, 1.0, -1.0, 3.0, (1.0, 3.0), False),
        (4, 3.0, 1.0, 8.0, (-1.0, 1.0), False),
        (3, 3.0, 1.0, 8.0, (-1.0, 1.0), False),
        (2, 3.0, 1.0, 8.0, (-1.0, -1.0), False),
        (0, 3.0, 1.0, 8.0, (-1.0, -1.0), False),
    ],
)
def test_the_compiled_stop_condition_names_a_front_that_has_been_filled_for_half_the_time(  # noqa: PLR0917  (as the rows)
    above: int, filled: float, lasting: float, t: float, expected: Any, front: bool
) -> None:
    """And for five at least; by the sites above the level at the end of a step of length 1."""
    up = np.arange(5) < above
    found = _watched(
        _memory(*[DOWN] * 5), up * 0.5, ~up * 3.0, [[up * 1.0, ~up * -3.0]], t=t - 1.0,
        _FILLED=filled, _LASTING=lasting,
    )  # fmt: skip
    assert found.outcome == (1 if front else 0)
    marks = (found.named["_FILLED"], found.named["_LASTING"])
    assert tuple(each if each >= 0.0 else -1.0 for each in marks) == expected


@pytest.mark.parametrize(("size", "rests"), [(0.1, True), (0.3, False)])
def test_the_compiled_stop_condition_names_a_chain_that_goes_to_rest(
    size: float, rests: bool
) -> None:
    """With no site above the level, whatever the last sample was; at the end of the step."""
    found = _watched(
        _memory(UP, DOWN, DOWN), [3.0, 0.0, 0.0], [0.0] * 3, [[[size - 3.0, 0.0, 0.0], [0.0] * 3]],
        _ABOVE=1.0, _REST_BOUND=0.06, _STIFFNESS=4.0,
    )  # fmt: skip
    assert found.outcome == (3 if rests else 0)
    assert found.named["_ABOVE"] == (0.0 if rests else 1.0)


@pytest.mark.parametrize(
    ("lasting", "state"),
    [
        (-1.0, State.UNDECIDED),
        (0.0, State.FRONT),
        (0.1, State.FRONT),
        (50.0, State.FRONT),
        (50.1, State.UNDECIDED),
    ],
)
def test_at_the_end_a_chain_that_has_stayed_half_filled_for_half_the_time_is_a_front(
    lasting: float, state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the start on as well; -1 if it has not."""
    chain = AveragedChain(a=4, b=0.5, c=0.6, sites=8)

    def integration(_: object, start: Any, *__: object, memory: Any, **___: object) -> Any:
        assert memory.size == state_run._SITES + 2 * chain.sites
        memory[state_run._LASTING] = lasting
        return SimpleNamespace(
            state=start, finish=lambda: None, outcome=0, time=1.0, counts={"steps": 1},
            amplitude=np.ones(8),
        )  # fmt: skip

    monkeypatch.setattr(state_run, "SmoothIntegration", integration)
    found = state_run.run_to_state(
        chain,
        np.full((2, 8), 2.0),
        level=1.0,
        rest_bound=0.0,
        stiffness=0.0,
        hold=5.0,
        window=10.0,
        settled=1e-3,
        end=100.0,
        tolerance=1e-6,
    )
    assert found.state is state
    assert (found.reason is Reason.END_TIME) is (state is State.UNDECIDED)


@pytest.mark.parametrize(
    ("ever", "now", "state"),
    [
        (6, 6, State.FRONT),
        (6, 3, State.FRONT),
        (6, 2, State.UNDECIDED),
        (5, 5, State.BREATHER),
        (3, 3, State.BREATHER),
    ],
)
def test_a_friction_front_has_reached_all_sites_and_half_of_them_still_stick(
    ever: int, now: int, state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Run(_FrictionRun):
        def forget_arrivals(self) -> None:
            self.arrivals[:] = NAN

        def advance_to(self, time: float) -> None:
            first, self.time = self.time == 0.0, time
            self.arrivals[: ever if first else now] = time
            self.amplitude = np.full(6, min(time, 200.0))  # changes for five windows

    monkeypatch.setattr(friction_rules, "FrictionIntegration", Run)
    chain = FrictionChain(c=0.05, sites=6)
    found = friction_rules.find_friction_state(chain, np.zeros((2, 6)), end=2000.0)
    assert found.state is state
    assert found.reason is (Reason.END_TIME if state is State.UNDECIDED else Reason.DECIDED)
    assert (found.reached, found.above) == (ever, now)
    # A front has held for three windows; a breather settled for as long as it took to settle.
    assert found.time == {State.FRONT: 160.0, State.BREATHER: 400.0}.get(state, 1000.0)


# --------------------------------------------------------------------------------------- breathers


def test_a_nucleus_is_confirmed_by_a_run_of_another_tolerance_that_ends_alike(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.19, sites=7)
    held = np.array([NAN, NAN, NAN, 0.0, NAN, NAN, NAN])
    larger = np.array([NAN, NAN, 30.0, 0.0, 30.0, NAN, NAN]) / chain.eps
    asked: list[float] = []

    for other, same in ((held, False), (larger, True)):

        def made_up(
            *_: object, tolerance: float, other: Any = other, alike: bool = same, **__: object
        ) -> Any:
            asked.append(tolerance)
            arrivals = larger if tolerance == 1e-8 else other
            width = np.array([1, 1 + 2 * int(arrivals is larger)])
            psi = np.arange(7.0)[None] if alike else np.abs(np.arange(7.0) - 3.0)[None]
            return SimpleNamespace(
                chain=chain, arrivals=arrivals, width=width, psi=psi,
                times=np.array([0.0, 200.0 / chain.eps]),
            )  # fmt: skip

        monkeypatch.setattr(nuclei, "simulate", made_up)
        found = nuclei.follow_nucleus(chain, slow_time=200.0, perturbation=0.0, seed=0)
        assert found.evolution.outcome is nuclei.NucleusOutcome.LARGER
        assert found.confirmed is same
        assert found.same_until == (200.0 if same else pytest.approx(30.0))
        assert found.mirrored is not same
    assert asked == pytest.approx([1e-8, 1e-6] * 2)


def _monodromy(even: list[float], odd: list[float]) -> np.ndarray:
    """Return a matrix of three sites with given multipliers of even and of odd modes."""
    r = math.sqrt(0.5)
    site = np.array([[r, 0.0, r], [0.0, 1.0, 0.0], [r, 0.0, -r]])  # two even modes and an odd one
    basis = np.kron(np.eye(2), site)
    found: np.ndarray = basis.T @ np.diag([*even[:2], odd[0], *even[2:], odd[1]]) @ basis
    return found


def test_of_the_multipliers_the_trivial_one_leads_nothing() -> None:
    def found(
        even: list[float], odd: list[float], parity: int = 0, **options: Any
    ) -> exponents.BreatherStability:
        return floquet_multipliers(_monodromy(even, odd), 2.0, 0.1, parity=parity, **options)

    stable = found([1.0, 0.9, -0.8, 0.3], [0.7, 0.2], parity=1, error=1e-9)
    assert stable.values.real == pytest.approx([1.0, 0.9, -0.8, 0.7, 0.3, 0.2])
    assert stable.trivial == pytest.approx(0.0, abs=1e-14)
    assert stable.leader == pytest.approx(0.9)
    assert stable.growth == pytest.approx(math.log(0.9) / 0.2)
    assert stable.stable
    assert 6.0e-9 <= stable.error < 6.1e-9  # six entries of a row, and orthogonal vectors
    assert stable.symmetric == pytest.approx(math.log(0.9) / 0.2)
    assert stable.antisymmetric == pytest.approx(math.log(0.7) / 0.2)
    # The one that leads may be of the other parity, and be beside the trivial one.
    broken = found([1.0, 0.9, -0.8, 0.3], [-1.2, 0.2], parity=1)
    assert broken.leader == pytest.approx(-1.2)
    assert not broken.stable
    assert (
        broken.antisymmetric == pytest.approx(broken.growth) == pytest.approx(math.log(1.2) / 0.2)
    )
    for growth in (1e-9, 1e-7):
        beside = found([1.0, math.exp(0.2 * growth), 0.5, 0.3], [0.7, 0.2])
        assert not beside.stable  # it grows by more than the rounding of this matrix
        assert replace(beside, growth_error=math.inf).stable is (growth < 1e-8)
    odd = found([0.5, 0.4, 0.3, 0.2], [1.0, 1.0 + 1e-3], parity=-1)
    assert odd.leader == pytest.approx(1.0 + 1e-3)
    assert odd.symmetric == pytest.approx(odd.growth)
    assert odd.antisymmetric == pytest.approx(math.log(0.5) / 0.2)


# -------------------------------------------------------------------------------- rules and stores


def test_a_number_agrees_up_to_its_rounding_and_the_error_of_what_was_found() -> None:
    assert [agrees(x, "2") for x in (1.5, 2.5, 2.5625)] == [True, True, False]
    assert [agrees(x, "2", 0.25) for x in (1.25, 2.75, 2.8125)] == [True, True, False]


def test_a_store_that_is_begun_anew_forgets_what_it_held(tmp_path: Path) -> None:
    for resume, expected in ((False, {}), (True, {"1": 2.0}), (False, {})):
        with Store(tmp_path / "a", {"c": 1}, resume=resume, replace=True) as store:
            assert store.results == expected
            store.add("1", 2.0)


# ------------------------------------------------------------------------- the robustness table


def _judged(stated: StatedValue, distance: float = 0.0, uncertainty: float = 0.0) -> dict[str, Any]:
    quantity = Computation(
        name="made-up", title="for this test", axes=(Axis(name="x", low=1.0, high=2.0),),
        compute=lambda _: stated,
        check=lambda *_: ReferenceCheck(distance=distance, uncertainty=uncertainty, method="a, b"),
        seconds=1.0,
    )  # fmt: skip
    return dict(judge(quantity, {"x": 1.0}))


def test_a_value_is_right_up_to_its_error_and_the_uncertainty_of_the_reference() -> None:
    stated = StatedValue(value=1.0, error=0.5)
    row = _judged(stated, distance=0.75, uncertainty=0.25)
    assert (row["outcome"], row["stated"], row["distance"], row["uncertainty"]) == (
        PointOutcome.RIGHT.value, 0.5, 0.75, 0.25,
    )  # fmt: skip
    assert row["by"] == "a; b"  # a comma would end the cell
    assert 0.0 <= row["seconds"] < 1.0
    assert row["said"] == "-"
    for distance, uncertainty in ((0.7500001, 0.25), (0.75, 0.2499999)):
        assert _judged(stated, distance, uncertainty)["outcome"] == PointOutcome.EXCEEDED.value


@pytest.mark.parametrize(
    ("value", "error", "right"),
    [
        (1.0, 0.0, True),
        (None, 1e-3, True),  # there is none, and the reference has none either
        (np.array([1.0, 2.0]), 0.0, True),
        (np.array([1.0, NAN]), 0.0, False),
        (mpmath.mpc(1, 2), 0.0, True),
        (mpmath.mpf("inf"), 0.0, False),
        (NAN, 0.0, False),
        (1.0, math.inf, False),
        (1.0, NAN, False),
    ],
)
def test_a_value_or_an_error_that_is_no_number_is_nan(
    value: Any, error: float, right: bool
) -> None:
    row = _judged(StatedValue(value=value, error=error))
    assert row["outcome"] == (PointOutcome.RIGHT if right else PointOutcome.NAN).value
    assert row["stated"] == error or math.isnan(error)


@pytest.mark.parametrize(
    ("message", "clear"),
    [
        ("x" * 20 + ".", True),
        ("x" * 19 + ".", False),
        ("x" * 298 + ".", True),
        ("x" * 299 + ".", False),
        ("x" * 50, False),
        ("x" * 50 + "\nx.", False),
    ],
)
def test_a_refusal_is_one_sentence_that_is_neither_short_nor_long(
    message: str, clear: bool
) -> None:
    assert is_clear(message) is clear


class _Given:
    """A clock of the processor, and the time limits that were set while it went."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *readings: float) -> None:
        self.limits: list[tuple[float, bool]] = []
        monkeypatch.setattr(judging, "time_limit", self.limit)
        times = iter(readings)
        monkeypatch.setattr(judging.time, "process_time", lambda: next(times))

    def limit(self, seconds: float, *, of_processor: bool = False) -> AbstractContextManager[None]:
        self.limits.append((seconds, of_processor))
        return nullcontext()


def _fails(error: Exception) -> Any:
    def compute(*_: Any) -> Any:
        raise error

    return compute


def _point(compute: Any, check: Any = None, seconds: float = 2.0) -> dict[str, Any]:
    quantity = Computation(
        name="made-up", title="for this test", axes=(Axis(name="x", low=1.0, high=2.0),),
        compute=compute, check=check or _fails(NoReferenceError("there is none")), seconds=seconds,
    )  # fmt: skip
    return dict(judge(quantity, {"x": 1.0}))


def test_a_value_is_given_up_after_five_times_its_limit_and_a_reference_after_ten_seconds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the processor, both: what else the machine does is no part of the outcome."""
    given = _Given(monkeypatch, 100.0, 101.0)
    _point(lambda _: StatedValue(value=1.0, error=0.0))
    assert given.limits == [(10.0, True), (10.0, True)]


@pytest.mark.parametrize(
    ("error", "outcome", "said"),
    [
        (TimeIsUpError(), PointOutcome.SLOW, "given up"),
        (ParameterError("c", 3, "below 2", "take less"), PointOutcome.REFUSED, None),
        (RunError('the "run", it seems, stands: begin anew.'), PointOutcome.REFUSED,
         "the 'run'; it seems; stands: begin anew."),
        (RunError("No."), PointOutcome.CRASH, "No."),
        (ZeroDivisionError("by zero"), PointOutcome.CRASH, "ZeroDivisionError: by zero"),
    ],
)  # fmt: skip
def test_what_gives_no_value_is_slow_refused_or_a_crash(
    error: Exception, outcome: PointOutcome, said: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    _Given(monkeypatch, 100.0, 103.0)
    row = _point(_fails(error))
    assert (row["outcome"], row["seconds"], row["by"]) == (outcome.value, 3.0, "-")
    assert row["said"] == (str(error).replace(",", ";") if said is None else said)
    assert math.isnan(row["stated"])


@pytest.mark.parametrize(
    ("took", "error", "outcome", "said"),
    [
        (2.0, NoReferenceError("there is none"), PointOutcome.UNCHECKED, "there is none"),
        (2.125, NoReferenceError("there is none"), PointOutcome.SLOW, "limit 2 s"),
        (1.0, TimeIsUpError("time is up"), PointOutcome.UNCHECKED, "time is up"),
        (1.0, KeyError("v"), PointOutcome.CRASH, "in the reference: KeyError: 'v'"),
    ],
)
def test_a_value_that_cannot_be_checked_is_unchecked_unless_it_is_slow_or_the_reference_broken(
    took: float, error: Exception, outcome: PointOutcome, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    _Given(monkeypatch, 100.0, 100.0 + took)
    row = _point(lambda _: StatedValue(value=1.0, error=0.25), _fails(error))
    assert (row["outcome"], row["stated"], row["seconds"]) == (outcome.value, 0.25, took)
    assert row["said"] == said


def test_a_point_of_the_robustness_table_is_known_by_its_seed_and_number() -> None:
    computation, number = (
        computation_named("c-pin"),
        500,
    )  # the first ones do not depend on the seed
    found = RobustnessTask()(Point(quantity="c-pin", number=number))
    again = computation.point(0, number)
    assert again not in (computation.point(1, number), computation.point(number, 0))
    assert found["values"] == " ".join(f"{name}={value!r}" for name, value in again.items())
    assert found["outcome"] not in {each.value for each in BAD}


def test_a_row_of_the_robustness_table_counts_the_points_of_its_quantity() -> None:
    """The tightest is of those that are right, over what was allowed; an exact one is at 0."""
    outcomes = [PointOutcome.RIGHT, PointOutcome.RIGHT, PointOutcome.EXCEEDED, PointOutcome.REFUSED]
    made: Any = {
        "quantity": np.array(["c-pin"] * 4 + ["eta-pin"]),
        "number": np.array([0, 1, 2, 3, 1]),
        "outcome": np.array([*outcomes, PointOutcome.RIGHT]),
        "stated": np.array([0.75, 0.0, 1.0, NAN, 1.0]),
        "uncertainty": np.array([0.25, 0.0, 0.0, NAN, 0.0]),
        "distance": np.array([0.5, 0.0, 10.0, NAN, 0.9]),
        "seconds": np.array([1.0, 3.0, 2.0, 0.5, 9.0]),
    }
    row = robustness._line(computation_named("c-pin"), made)
    assert (row.quantity, row.points, row.random) == ("c-pin", 4, 2)
    assert {name: count for name, count in row.counts.items() if count} == {
        "right": 2, "exceeded": 1, "refused": 1,
    }  # fmt: skip
    assert (row.tightest, row.slowest) == (0.5, 3.0)


def test_every_quantity_has_its_share_of_the_points_and_twelve_at_least(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = _computation(Axis(name="x", low=1.0, high=2.0))
    shares = {"large": 3.0, "middle": 1.0, "small": 0.01}
    computations = tuple(replace(made, name=name, share=share) for name, share in shares.items())
    with monkeypatch.context() as patched:
        patched.setattr(robustness, "chosen", lambda _: computations)
        for points, counts in ((1000, (748, 249, 12)), (5, (5, 5, 5))):
            found = Counter(point["quantity"] for point in robustness.points_of([], points))
            assert found == dict(zip(shares, counts, strict=True))
    names = [str(point["quantity"]) for point in robustness.points_of(["eta-pin", "c-pin"], 40)]
    assert names == ["eta-pin", "c-pin"] * 20
    with pytest.raises(ParameterError, match="number of points = 0 "):
        robustness.points_of(["c-pin"], 0)
    with pytest.raises(ParameterError, match="seed = -1 "):
        robustness.robustness(["c-pin"], 1, -1, workers=1)


# -------------------------------------------------------------------------- a front that stops


class _Motion:
    """A run of which only time, amplitudes, arrivals and whether it goes to rest are asked."""

    finished, chain = False, AveragedChain(a=4, b=0.5, c=0.1)

    def __init__(self) -> None:
        self.time, self.amplitude, self.rests = 0.0, np.array([1.0, 0.5]), False
        self.arrivals = np.full(2, np.nan)

    def going_to_rest(self) -> bool:
        return self.rests


@pytest.mark.parametrize(
    ("change", "status"),
    [([0.0, 0.0], FrontStatus.PINNED), ([0.0, 0.2499], FrontStatus.PINNED),
     ([0.0, 0.25], FrontStatus.CREEPING), ([0.0, -0.25], FrontStatus.PINNED),
     ([0.5, 0.0], FrontStatus.PINNED), ([-0.0999, 0.0], FrontStatus.PINNED),
     ([-0.1001, 0.0], FrontStatus.CREEPING)],
)  # fmt: skip
def test_what_stands_is_pinned_if_nothing_ahead_grows_and_nothing_behind_falls(
    change: list[float], status: FrontStatus
) -> None:
    """From one stall time after the last arrival to two; of four sites the middle two change."""
    run: Any = _Motion()
    run.arrivals, run.amplitude = np.array([2.0, 3.0, np.nan, np.nan]), np.array([1, 1, 0.5, 0.5])
    stall = Stall(run, 10.0, 0.25)
    run.time = 3.0
    stall.note(4)
    for time in (13.0, 13.5, 23.0):
        run.time = time
        assert stall.status() is None
    assert stall.waited == 20.0
    run.amplitude = run.amplitude + np.array([0.0, *change, 0.0])
    run.time = 23.5
    assert stall.status() is status


def test_the_largest_amplitude_within_a_period_is_taken_after_every_step() -> None:
    class Steps(_Motion):
        chain = VdpChain(a=4, b=0.5, c=0.1)

        def advance(self, budget: int) -> None:
            self.time += budget
            self.amplitude = np.full(2, 5.0 if self.time == 1.0 else 1.0)

    run: Any = Steps()
    assert Stall(run, 10.0, 0.25)._largest().tolist() == [5.0, 5.0]
    assert cycle_period(run.chain) <= run.time < cycle_period(run.chain) + 1.0

    class Ended(Steps):
        @property
        def finished(self) -> bool:  # type: ignore[override]
            assert self.time <= 2.0
            return self.time == 2.0

    ended: Any = Ended()
    assert Stall(ended, 10.0, 0.25)._largest().tolist() == [5.0, 5.0]
    assert ended.time == 2.0  # of a run that ends within the period no more is taken


def test_a_site_that_goes_up_and_down_in_either_stall_time_does_not_grow() -> None:
    """Noted at two moments it would: 1 at the first, 2 at the last."""
    run: Any = _Motion()
    stall = Stall(run, 10.0, 0.25)
    for time, height in ((5.0, 2.0), (10.5, 1.0), (15.0, 1.0), (20.5, 2.0)):
        run.time, run.amplitude = time, np.full(2, height)
        status = stall.status()
    assert status is FrontStatus.PINNED
    run = _Motion()
    stall = Stall(run, 10.0, 0.25)
    for time, height in ((5.0, 1.0), (10.5, 1.0), (15.0, 2.0), (20.5, 1.0)):
        run.time, run.amplitude = time, np.full(2, height)
        status = stall.status()
    assert status is FrontStatus.CREEPING


def test_the_time_of_a_cycle_contains_its_relaxation_at_large_eps() -> None:
    """Half of it on a slow branch ε(1 - ay² + by⁴)ẏ = -y, which ends at its fold."""
    a, b, eps = 4.0, 0.5, 10.0
    fold = math.sqrt((a + math.sqrt(a * a - 4.0 * b)) / (2.0 * b))

    def force(y: float) -> float:
        return y - a * y**3 / 3.0 + b * y**5 / 5.0

    def time(y: float) -> float:
        return eps * (math.log(y) - a * y**2 / 2.0 + b * y**4 / 4.0)

    # The jump from the fold on the other side, at the same ẏ + ε force.
    top = brentq(lambda y: force(y) + force(fold), fold, 3.0 * fold)
    assert cycle_period(VdpChain(a=a, b=b, c=0.1, eps=eps)) > 2.0 * (time(top) - time(fold))


@pytest.mark.parametrize("eps", [1e-4, 0.01])
def test_amplitudes_of_what_stands_are_taken_over_two_periods_of_a_cell(eps: float) -> None:
    """As its cycles are found by running it; and somewhat longer, for what relaxes."""
    own = OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.1, eps=eps, sites=3)
    periods = [each.period for each in own.cell.cycles]
    assert len(periods) == 2
    assert cycle_period(own) == pytest.approx(2.0 * max(periods))
    time = cycle_period(VdpChain(a=4, b=0.5, c=0.1, eps=eps))
    assert 2.0 * max(periods) <= time < (1.0 + 3.0 * eps) * 2.0 * max(periods)
    still = OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(0.2 - y)", overdamped=True, c=0.1, sites=3
    )
    assert cycle_period(still) == 0.0  # without inertia nothing oscillates
    stiff = own.replace(stiffness="y + 0.2*y**3")
    small, large = (each.period for each in stiff.cell.cycles)
    assert small > 1.01 * large  # and the period of the slower one counts
    assert cycle_period(stiff) == pytest.approx(2.0 * small)
    assert cycle_period(own.replace(drive="0.1,1.2@all")) == 0.0  # they never become constant


def test_it_is_waited_anew_when_a_further_site_is_reached_and_not_when_the_same_is() -> None:
    run: Any = _Motion()
    stall = Stall(run, 10.0, 0.25)
    for time, reached in ((1.0, 2), (12.0, 2), (12.0, 3), (22.5, 3)):
        run.time = time
        stall.note(reached)
        assert stall.status() is None
    assert (stall.reached, stall.since) == (3, 12.0)
    run.time, run.amplitude = 32.5, run.amplitude + 1.0
    assert stall.status() is FrontStatus.CREEPING
    run.rests = True
    assert stall.status() is FrontStatus.COLLAPSED


def test_a_site_that_is_reached_while_the_last_amplitudes_are_taken_is_farther() -> None:
    class Late(_Motion):
        chain = VdpChain(a=4, b=0.5, c=0.1)  # its amplitudes are taken over a period

        def advance(self, budget: int) -> None:
            self.time += 1.0
            if self.time > 205.0:
                self.arrivals, self.amplitude = np.array([205.0, np.nan]), self.amplitude + 1.0

    run: Any = Late()
    stall = Stall(run, 100.0, 0.25)
    run.time = 101.0
    assert stall.status() is None
    run.time = 201.0
    assert stall.status() is None
    stall.note(1)
    assert (stall.since, stall.early) == (run.time, None)


def test_what_changes_before_the_first_stall_time_is_over_does_not_count() -> None:
    run: Any = _Motion()
    stall = Stall(run, 10.0, 0.25)
    for time, height in ((5.0, 1.0), (10.0, 2.0), (10.5, 3.0), (20.0, 3.0)):
        run.time, run.amplitude = time, np.full(2, height)
        assert stall.status() is None
    run.time = 20.5
    assert stall.status() is FrontStatus.PINNED


def test_the_first_site_that_is_reached_is_an_arrival_too() -> None:
    run: Any = _Motion()
    stall = Stall(run, 10.0, 0.25)
    run.time = 3.0
    stall.note(0)
    assert stall.since == 0.0
    stall.note(1)
    assert stall.since == 3.0


def test_a_front_that_stops_in_the_first_run_is_not_run_again() -> None:
    """No site is ever reached, so that it is waited from the beginning."""
    runs: list[_Run] = []

    def begin(tolerance: float) -> _Run:
        runs.append(_Run(tolerance, reached=0))
        return runs[-1]

    found = prepared(begin).trial(40, None)
    assert found.stopped is FrontStatus.PINNED
    assert [run.time for run in runs] == [21.0]
    assert np.isnan(found.arrivals).all()
    assert (found.arrivals.size, found.coarser.size) == (40 - 5 - MARGIN, 0)


@pytest.mark.parametrize("reached", [3, 27])
def test_progress_is_the_chain_that_is_reached_or_the_time_that_is_waited(reached: int) -> None:
    """Whichever is more, at most one; the last of the sites is reached at time 1."""
    seen: list[float] = []
    run: Any = _Run(1e-8, reached)
    followed(run, stall_time=10.0, settling_tolerance=1e-3, progress=seen.append)
    waited = [n / 20.0 for n in range(22)]
    assert seen == [min(1.0, max(part, (reached - 1) / 40)) for part in waited]


# ------------------------------------------------------- errors and references that are judged by


@pytest.mark.parametrize("eta", [0.02, 0.08, 0.12])
def test_a_cycle_is_too_stiff_by_its_largest_damping(eta: float) -> None:
    """ε max|1 - y² + ηy⁴| over the cycle of amplitude √(8/(1 - √(1 - 8η))), point by point."""
    y = np.linspace(0.0, math.sqrt(8.0 / (1.0 - math.sqrt(1.0 - 8.0 * eta))), 20_001)
    largest = float(np.abs(1.0 - y**2 + eta * y**4).max())
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): 1.0, (2, 0): -1.0, (4, 0): eta})
    limit = shooting._STIFFEST / largest
    shooting._stiffness(cell, 0.999 * limit, cell.cycles[1])
    with pytest.raises(ParameterError, match="at most"):
        shooting._stiffness(cell, 1.001 * limit, cell.cycles[1])


def test_halved_steps_shift_a_fold_by_what_no_change_of_the_state_makes_up_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second equation, c = 0.2 + (residual)/1.5, contains no unknown."""

    def system(_: object, refinement: int = 1) -> Any:
        residual = np.array([1e-6, -3e-6]) if refinement == 2 else np.zeros(2)
        return lambda u, c: (residual, np.array([[1.0, 2.0], [0.0, 0.0]]), np.array([5.0, -1.5]))

    monkeypatch.setattr(Orbits, "system", system)
    chain = AveragedChain(a=4, b=0.5, c=0.2)
    fold = fold_of(0.2, 0.0, np.zeros(2), tangent=np.array([2.0, -1.0]))
    assert Orbits(chain.full(), Nucleus(1)).step_error(fold).parameter == pytest.approx(2e-6)


def test_the_bracket_of_an_escape_holds_the_coupling_at_which_runs_begin_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Those that escape within half the time are 1e-3 above: that is part of the error."""

    def hold(_: object, __: object, c: float, length: float) -> SimpleNamespace:
        return SimpleNamespace(escaped=c > 0.2, time=(0.25 if c > 0.201 else 0.75) * length)

    monkeypatch.setattr(escape, "hold", hold)
    chain = AveragedChain(a=4, b=0.5, c=0.6)
    found = escape.escape_range(chain, escape.NucleusPreparation(1), 100.0, 1e-4)
    probes = 2 * escape.PROBES  # of either side, beside those of the bisection
    assert probes <= found.runs < probes + 40
    found = escape.escape_threshold(
        chain, escape.NucleusPreparation(1), duration=100.0, tolerance=1e-4
    )
    assert found.low <= 0.2 <= found.high
    assert 0.0 < found.high - found.low <= 1e-4
    assert found.low <= found.c_crit <= found.high
    assert 1e-3 <= found.error <= 1.2e-3


def test_a_range_of_escape_with_gaps_is_wider_by_half_of_itself_at_either_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Made:
        escapes: ClassVar[dict[float, float]] = {}
        longer_runs = 0

        def __init__(self, _: object, preparation: escape.NucleusPreparation, __: float) -> None:
            self.preparation = preparation

        def range(self) -> tuple[float, float]:
            return 0.19, 0.21

        def monotone(self) -> bool:
            return self.preparation.seed == 1

        def bracket(self) -> None: ...
        def refine(self, _: float) -> None: ...
        def escape(self, c: float) -> None:
            tried.append(c)

        def end_by_longer_runs(self, _: float) -> float:
            return 0.185

    monkeypatch.setattr(escape, "_EscapeRuns", Made)
    tried: list[float] = []
    noisy = escape.NucleusPreparation(1, perturbation=1e-3, seed=1)
    found = escape.escape_range(AveragedChain(a=4, b=0.5, c=0.6), noisy, seeds=2)
    # Further runs are made from a hundredth of c below the range to as much above it, in eighths.
    assert sorted({*tried}) == pytest.approx(0.2 * (1.0 + 0.01 * np.arange(-48, 49) / 8.0))
    assert len(tried) == 2 * 97
    assert not found.monotone  # one of the two seeds has gaps
    assert (found.low, found.high) == pytest.approx((0.18, 0.22))
    assert found.error == pytest.approx(0.02)
    one = escape.escape_range(AveragedChain(a=4, b=0.5, c=0.6), noisy, seeds=1)
    assert (one.low, one.high, one.monotone) == (0.19, 0.21, True)
    assert one.error == pytest.approx(0.2 - 0.185)  # to where longer runs no longer escape


def test_the_closed_form_is_of_one_site_in_the_bulk() -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.6)
    found = closed_form_threshold(chain, Nucleus(1))
    fold = closed_form_fold(chain, Reading.NEIGHBOUR)
    assert (found.c_crit, found.error) == (fold.c, fold.error)
    for reading in Reading:
        there = closed_form_fold(chain, reading) if reading is not Reading.CENTRE else None
        assert found.readings[reading.value] == (there and there.c)
        assert found.readings_error[reading.value] == (there and there.error)
    for other in (Nucleus(1, place=Place.EDGE), Nucleus(2, "0")):
        with pytest.raises(ParameterError, match="one centre"):
            closed_form_threshold(chain, other)


@pytest.mark.parametrize("mirrored", [False, True])
def test_exponents_come_with_the_fastest_growth_first(mirrored: bool) -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.1, sites=9)
    found = solve_envelope_breather(chain, Nucleus(1))
    growth = exponents.exponents(*exponents.unpack(found.unknowns), chain, mirrored).values.real
    assert np.all(np.diff(growth) <= 0.0)
    assert growth[0] > growth[-1]


@pytest.mark.parametrize(("nucleus", "leads"), [(Nucleus(1), "odd"), (Nucleus(3, "+-"), "even")])
def test_a_monitor_watches_growth_of_either_parity(nucleus: Nucleus, leads: str) -> None:
    """The leading one, that of the nucleus's own parity, and the other, each less the margin."""
    chain = AveragedChain(a=4, b=0.5, c=0.1, sites=9)
    found = solve_envelope_breather(chain, nucleus)
    whole = exponents.exponents(*exponents.unpack(found.unknowns), chain, mirrored=True)
    assert (whole.symmetric > whole.antisymmetric + 1e-6) is (leads == "even")
    watched = RotatingWaves(chain, nucleus).monitor(found.unknowns, chain.c)
    growths = (whole.growth, whole.symmetric, whole.antisymmetric)
    expected = [each - exponents.MARGINAL for each in growths]
    assert watched == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_velocity_off_by_more_than_its_error_is_as_far_off_as_it_is(side: float) -> None:
    at = {"c": 0.5, "eta": 0.03125}
    found = kinetic_relation(at["c"], at["eta"])
    true = found.branches[-1]
    for off in (1e-6, 1e-9):
        wrong = replace(true, v=true.v * (1.0 + side * off), error=1e-13 * true.v)
        stated = StatedValue(
            value=np.array([wrong.v]), error=1e-13,
            extra=replace(found, branches=(*found.branches[:-1], wrong)),
        )  # fmt: skip
        check = velocities._check_velocities(at, stated)
        assert check.distance == pytest.approx(off, rel=1e-2)


def test_velocities_are_counted_on_a_grid_down_to_the_slowest_that_are_searched_for() -> None:
    """Above c_retreat by 1e-9 of it: the only front is hardly faster than |v| = 0.018."""
    at = {"c": (1.0 + 1e-9) * retreat_coupling(0.12), "eta": 0.12}
    (slow,) = kinetic_relation(at["c"], at["eta"]).branches
    assert 0.018 < abs(slow.v) < 0.03
    assert velocities._changes_of_sign(at) == 1


@pytest.mark.parametrize(
    ("status", "error", "settled"),
    [
        (FrontStatus.STEADY, 1e-6, True),
        (FrontStatus.PINNED, 0.0, True),
        (FrontStatus.STEADY, None, False),
        (FrontStatus.UNSTEADY, 1e-6, False),
    ],
)
def test_only_a_settled_front_with_an_error_states_its_velocity(
    monkeypatch: pytest.MonkeyPatch, status: FrontStatus, error: float | None, settled: bool
) -> None:
    v = 0.0 if status is FrontStatus.PINNED else 0.5
    made = SimpleNamespace(v=v, error=error, status=status)
    chains: list[Any] = []
    monkeypatch.setattr(
        "verification.quantities.fronts.measure_front",
        lambda chain, **_: chains.append(chain) or made,
    )
    for full in (True, False):
        found = fronts_of._front({"c": 0.6, "eta": 0.03}, full)
        assert found.value == (v if settled else None)
        assert found.note == ("" if found.value else status.value)
    assert [chain.model for chain in chains] == ["vdp", "averaged"]


@pytest.mark.parametrize(("share", "by"), [(0.49, "differences"), (0.51, "scipy")])
def test_a_reference_that_is_too_uncertain_is_left_for_another(
    monkeypatch: pytest.MonkeyPatch, share: float, by: str
) -> None:
    def reference(method: str) -> Any:
        return lambda *_, **__: ReferenceCheck(
            distance=0.0, uncertainty=share * 1e-3, method=method
        )

    monkeypatch.setattr(fronts_of, "_by_differences", reference("differences"))
    monkeypatch.setattr(fronts_of, "_by_scipy", reference("scipy"))
    stated = StatedValue(value=0.5, error=1e-3)
    assert fronts_of._averaged_front_known({"c": 0.6, "eta": 0.03}, stated).method == by


def test_values_at_random_are_of_every_decade_and_beside_what_is_special() -> None:
    rng = np.random.default_rng(0)
    drawn = [Axis(name="c", low=1e-2, high=1e4).draw(rng) for _ in range(300)]
    decades = np.bincount(np.floor(np.log10(drawn)).astype(int) + 2, minlength=6)
    assert decades.min() > 25  # fifty each, with a deviation of seven
    beside = Axis(name="eta", low=0.01, high=0.02, near=(0.08,))
    near = [value for value in (beside.draw(rng) for _ in range(400)) if value > 0.03]
    away = np.array(near) / 0.08 - 1.0
    assert 60 < away.size < 140  # a quarter of them
    assert np.abs(away).max() <= 0.1
    assert min((away > 0).sum(), (away < 0).sum()) > 20


def test_corners_are_made_of_both_ends_of_each_range_and_of_what_is_special() -> None:
    x = Axis(name="x", low=2.0, high=3.0, near=(2.5,), closest=1e-3)
    y = Axis(name="y", low=1.0, high=100.0)
    assert x.ends() == pytest.approx((2.0, 3.0, 2.4975, 2.5025), rel=1e-14)
    assert (x.middle(), y.middle()) == pytest.approx((math.sqrt(6.0), 10.0))
    assert replace(x, whole=True).middle() == 2.0
    made = _computation(x, y)
    assert made.fixed_points == tuple(
        {"x": one, "y": other} for one in x.ends() for other in (1.0, 100.0)
    )
    assert [axis.whole for axis in axes(n=(1, 2), c=(1, 2.5), v=(1.5, 2))] == [True, False, False]
    assert (whole(3.0), whole(math.inf)) == (3, math.inf)


def _computation(*of: Axis) -> Computation:
    return Computation(
        name="made-up", title="for this test", axes=of, seconds=1.0,
        compute=lambda _: StatedValue(value=1.0, error=0.0),
        check=lambda *_: ReferenceCheck.exact(True, method="this test"),
    )  # fmt: skip


def test_every_twentieth_point_has_a_value_that_is_not_allowed() -> None:
    made = _computation(Axis(name="x", low=0.5, high=2.0), Axis(name="y", low=0.5, high=2.0))
    for number in range(1, 2000, 2):
        outside = [not 0.5 <= value <= 2.0 for value in made.point(0, number).values()]
        assert sum(outside) == (number % 20 == 19)


def test_an_error_belongs_to_a_value_and_a_yes_or_no_is_certain() -> None:
    found = SimpleNamespace(error=1e-3)
    assert [StatedValue.of(found, value).error for value in (0.5, None)] == [1e-3, 0.0]
    for held, distance in ((True, 0.0), (False, math.inf)):
        check = ReferenceCheck.exact(held, method="this test")
        assert (check.distance, check.uncertainty, check.method) == (distance, 0.0, "this test")


# ----------------------------------------------------------------------- what is kept and answered


def test_a_checkpoint_holds_numbers_only(tmp_path: Path) -> None:
    objects = {"y": np.array([{}], dtype=object)}
    with pytest.raises(TypeError, match="references"):  # no digest of what cannot be compared
        checkpoint.save_checkpoint(tmp_path / "run", objects, {"chain": "x"}, 0.0)
    assert not list(tmp_path.iterdir())


def test_of_a_task_all_its_numbers_are_stored_and_no_axes_are_no_points() -> None:
    assert parameters_of(1.0 + 2.0j) == {"complex": [1.0, 2.0]}
    assert len(points_of({})) == 0
    assert len(points_of({"c": [0.1, 0.2], "v": [1.0, 2.0, 3.0]})) == 6


def test_a_list_of_benchmarks_writes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "--list", "--out", str(tmp_path)]) == 2
    assert "--list reads and writes no record" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_curve_goes_on_where_some_points_are_refused() -> None:
    """Only where all are, it is one refusal."""

    def value(chain: float) -> SimpleNamespace:
        positive("c", chain)
        return SimpleNamespace(c=chain)

    found = curve(value, [-1.0, 1.0, -2.0], "c", [-1.0, 1.0, -2.0], {}, workers=1, progress=None)
    assert [type(point).__name__ for point in found.points] == [
        "Refusal", "SimpleNamespace", "Refusal",
    ]  # fmt: skip
    with pytest.raises(ParameterError, match="c = -1"):
        curve(value, [-1.0, -2.0], "c", [-1.0, -2.0], {}, workers=1, progress=None)


# ------------------------------------------------------------ fronts beside waves, and what is said


def _settled(v: float | None, error: float | None, status: FrontStatus, steps: int = 1) -> Settled:
    return Settled(
        status=status, v=v, error=error, arrivals=np.arange(3.0), sites=40,
        counts=Counter(steps=steps),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("other", "error", "status"),
    [
        (0.50004, 1e-4, FrontStatus.STEADY),  # within its own error
        (0.5004, 4e-4, FrontStatus.STEADY),
        (0.4996, 4e-4, FrontStatus.STEADY),
        (0.4990, 1e-3, FrontStatus.UNSTEADY),  # by more than the accuracy of 1e-3
        (None, 0.5, FrontStatus.UNSTEADY),
    ],
)
def test_a_front_that_waves_overtake_is_no_surer_than_with_twice_as_many_sites_behind_it(
    monkeypatch: pytest.MonkeyPatch, other: float | None, error: float, status: FrontStatus
) -> None:
    asked = []

    def prepare(_: object, request: Any, boundary: LeftBoundary, __: int = 1) -> SimpleNamespace:
        asked.append((request.excited, boundary))
        return SimpleNamespace(settled=lambda _: beside)

    beside = _settled(other, 1e-5, FrontStatus.STEADY, steps=20)
    monkeypatch.setattr(smooth, "_prepare_smooth", prepare)
    found = smooth._beside_longer_wave(
        _settled(0.5, 1e-4, FrontStatus.STEADY), 1e-3, VdpChain(a=4, b=0.5, c=0.6), _request()
    )
    assert asked == [(48, LeftBoundary.WAVE)]
    assert found.error == pytest.approx(error, rel=1e-6)
    assert (found.v, found.status, found.counts["steps"]) == (0.5, status, 21)
    slower = smooth._beside_longer_wave(
        _settled(0.25, 1e-4, FrontStatus.STEADY), 1e-3, VdpChain(a=4, b=0.5, c=0.6), _request()
    )
    assert slower.error == pytest.approx(abs(0.25 - (other or 0.0)), rel=1e-6)


@pytest.mark.parametrize(
    ("v", "before", "alike", "error"),
    [(0.5, 0.50004, True, 1e-4), (0.5, 0.6, False, 0.1), (0.5, 0.4, False, 0.1),
     (0.5, None, False, 0.5)],
)  # fmt: skip
def test_a_front_is_compared_with_one_before_it_that_is_faster_or_slower(
    v: float, before: float | None, alike: bool, error: float
) -> None:
    wave: Any = SimpleNamespace(compared=True, accuracy=1e-3)
    found = smooth._alike(_settled(v, 1e-4, FrontStatus.STEADY), before, wave)
    assert found[0] is alike
    assert found[1].error == pytest.approx(error, rel=1e-9)


def _request(boundary: LeftBoundary = LeftBoundary.FREE) -> Any:
    return measure.Request(
        accuracy=None, tolerance=1e-8, excited=None, max_sites=None, stall_time=None,
        left_boundary=boundary, point=StartPoint.MAXIMUM, directions=None, progress=None,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("share", "boundary", "runs"),
    [
        (2.0, LeftBoundary.FREE, ["wave"]),  # faster than the waves: what is behind does not matter
        (0.5, LeftBoundary.FREE, ["wave", "free"]),
        (0.0, LeftBoundary.FREE, ["wave", "free"]),  # it may be pushed
        (0.5, LeftBoundary.WAVE, ["wave", "longer wave"]),
        (2.0, LeftBoundary.WAVE, ["wave"]),
        (0.0, LeftBoundary.WAVE, ["wave"]),
        (None, LeftBoundary.WAVE, ["wave"]),
    ],
)
def test_the_left_end_of_a_smooth_chain_is_run_where_it_can_matter(
    monkeypatch: pytest.MonkeyPatch, share: float | None, boundary: LeftBoundary, runs: list[str]
) -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6)
    v = None if share is None else share * measure.OUTRUNS * chain.trailing_wave_velocity
    made: list[str] = []

    @dataclass(frozen=True)
    class Prepared:
        accuracy: float = 1e-3
        other_velocity: float | None = None
        compared: bool = False

        def settled(self, _: object) -> Settled:
            return _settled(v, 1e-4, FrontStatus.STEADY)

        def front(self, *given: Any) -> Any:
            return given

    def prepare(_: object, request: Any, left: LeftBoundary, __: int = 1) -> Prepared:
        made.append("longer wave" if request.excited == 48 else left.value)
        return Prepared()

    monkeypatch.setattr(smooth, "_prepare_smooth", prepare)
    _, left, outruns, *_ = smooth.smooth_front(chain, _request(boundary))
    assert made == runs
    assert left is boundary
    assert outruns is (share == 2.0)


def test_arrivals_that_come_earlier_are_as_far_off_as_those_that_come_later() -> None:
    one, other = np.array([1.0, 2.0, np.nan]), np.array([1.0, 2.25, np.nan])
    assert difference(one, other) == difference(other, one) == 0.25
    assert difference(one, np.array([1.0, 2.0, 3.0])) == math.inf


def test_headlines_are_what_disagrees_by_the_weight_of_its_claim() -> None:
    def outcome(key: str, weight: int, verdict: Verdict, headline: str = "") -> SimpleNamespace:
        return SimpleNamespace(
            key=key, finding=SimpleNamespace(headline=headline, verdict=verdict),
            claim=SimpleNamespace(weight=weight), entry=SimpleNamespace(group=key[:4]),
        )  # fmt: skip

    every = [
        outcome("fig1 light", 1, Verdict.NOT_REPRODUCED),
        outcome("fig2 heavy", 3, Verdict.PARTIAL),
        outcome("fig3 true", 9, Verdict.REPRODUCED),
        outcome("fig4 middle", 2, Verdict.PARTIAL),
        outcome("fig5 said", 1, Verdict.REPRODUCED, "Read this first."),
        outcome("fig2 heavy too", 3, Verdict.NOT_REPRODUCED),
    ]
    found = Report.headlines.fget(SimpleNamespace(outcomes=every))  # type: ignore[attr-defined]
    assert [each.key for each, _ in found] == ["fig5 said", "fig2 heavy too", "fig4 middle"]


def test_as_many_sites_as_a_method_may_have_are_not_too_many() -> None:
    for method, most in breathers.MAX_SITES.items():
        breathers._check_length(AveragedChain(a=4, b=0.5, c=0.6, sites=most), method)
        with pytest.raises(ParameterError, match=f"at most {most}"):
            breathers._check_length(AveragedChain(a=4, b=0.5, c=0.6, sites=most + 1), method)


def test_help_of_a_model_has_its_line_first_and_then_its_own_examples(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main([]) == 0
    assert "usage: fronts COMMAND" in capsys.readouterr().out
    with pytest.raises(SystemExit, match="0"):
        main(["front", "friction", "--help"])
    said = capsys.readouterr().out
    assert said.index("Velocity of a front") < said.index("options:") < said.index("examples:")
    examples = said[said.index("examples:") :].split("\n  fronts ")[1:]
    assert examples
    assert all(each.startswith("front friction") for each in examples)


def test_help_of_a_command_without_models_has_all_its_examples(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit, match="0"):
        main(["kinetic", "--help"])
    said = capsys.readouterr().out
    every = COMMANDS["kinetic"].examples.split("\n  fronts ")[1:]
    assert len(every) > 1
    assert all(each in said for each in every)


def test_only_nuclei_in_phase_are_given_another_pattern() -> None:
    """A breather of three sites or more has quarter turns between them."""
    for kept in (Nucleus(1), Nucleus(2, "0"), Nucleus(3, "+-"), Nucleus(4, "x00")):
        assert breathers.with_pattern(kept, 31) == kept
        at_edge = replace(kept, place=Place.EDGE)
        assert breathers.with_pattern(at_edge, 31) == at_edge
    assert breathers.with_pattern(Nucleus(3, "00"), 31).pattern == "-+"
    with pytest.raises(ParameterError, match="at an edge"):
        breathers.with_pattern(Nucleus(3, "00", Place.EDGE), 31)


def test_of_a_store_only_results_of_points_of_the_table_are_taken() -> None:
    """Another sweep may have left more points; -1 would be the last of these."""
    points = points_of({"c": [0.1, 0.2]})
    kept = [("1", [("v", 2.0)]), *((key, [("v", 9.0)]) for key in ("-1", "2", "01", "+0", "x"))]
    found = sweeping._Found(points=points, out=None, names={})
    store: Any = SimpleNamespace(read=lambda: kept)
    assert found.take_from(store) == 1
    assert found.stored == 1
    found.put(0, {"v": 1.0})
    assert found.columns.arrays()["v"].tolist() == [1.0, 2.0]


def test_claims_are_shown_with_the_figure_that_they_are_about() -> None:
    every = [SimpleNamespace(entry=SimpleNamespace(group=each), key=i)
             for i, each in enumerate(("fig02", "text_vdp", "fig11", "fig02"))]  # fmt: skip
    found = Report.figures.func(SimpleNamespace(outcomes=every))  # type: ignore[attr-defined]
    assert {name: [one.key for one in of_one] for name, of_one in found.items()} == {
        "fig02": [0, 3], "fig11": [2],
    }  # fmt: skip


@pytest.mark.parametrize("status", [FrontStatus.STEADY, FrontStatus.SLIDING])
def test_the_error_of_a_front_of_44_counts_what_is_cut_off_the_chain(
    monkeypatch: pytest.MonkeyPatch, status: FrontStatus
) -> None:
    """What is missing beyond the window over the threshold, relative to v, besides its periods."""
    sliding = status is FrontStatus.SLIDING
    blocks = 4 * front_verdict.BLOCK
    made: Any = front_verdict.History.__new__(front_verdict.History)
    chain = SimpleNamespace(threshold=0.5, sites=100, grazes=0, state=lambda: None)
    vars(made).update(
        chain=chain, coupling=0.5, events=7, sliding=0, zone=10, _jitter=0.0,
        _waits={1: [2.0] * (blocks + 1), -1: []},
        _counts={1: list(range(blocks + 1)), -1: []},
        _slides={1: [*[0] * blocks, int(sliding)], -1: []},
    )  # fmt: skip
    monkeypatch.setattr(front_verdict, "truncation_bound", lambda *_: 1e-3)
    found = made.verdict(None, 1e-9, 0.0)
    assert (found.v, found.status) == (0.5, status)
    own = front_verdict._SLIDING_ERROR if sliding else 0.0
    assert found.error == pytest.approx(0.5 * (1e-3 / 0.5 + own), rel=1e-6)


@pytest.mark.parametrize(
    ("number", "kind"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)]
)
def test_an_interrupt_says_who_asked_at_once_and_later(
    number: int, kind: type[BaseException]
) -> None:
    """One from the keyboard is no request to end: the exit codes differ."""
    waiting = Deferred()
    waiting.check()
    waiting.note(number, None)
    with pytest.raises(KeyboardInterrupt) as twice:
        waiting.note(number, None)
    with pytest.raises(KeyboardInterrupt) as once:
        waiting.check()
    assert type(twice.value) is kind
    assert type(once.value) is kind
    waiting.check()


def test_no_front_is_measured_where_sites_at_rest_start_by_themselves() -> None:
    slow = FrictionCell(v_d=0.5 * FrictionCell().hopf_velocity)
    with pytest.raises(ParameterError, match="steady sliding is unstable"):
        measure.measure_front(FrictionChain.of(slow, c=0.02, sites=31), max_sites=31)


def test_a_chain_is_too_long_for_all_methods_where_it_is_for_one() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=103)
    with pytest.raises(ParameterError, match="at most 101 for orbit"):
        breathers.breather(chain, nucleus=Nucleus(1), method="all")


def test_the_profile_is_of_the_fastest_admissible_front_and_of_the_fastest_if_none_is() -> None:
    slow, middle, fast = (SimpleNamespace(v=v, admissible=v < 0.5) for v in (0.1, 0.2, 0.9))
    branches: Any = (slow, middle, fast)
    assert _chosen(branches, None) is middle
    assert _chosen(branches[2:] * 2, None) is fast
    assert [_chosen(branches, i) for i in (1, 2, 3)] == [slow, middle, fast]


@pytest.mark.parametrize(
    ("value", "uncertainty", "by"),
    [(0.5, 1e-12, "differences"), (0.5, 1.0, "scipy"), (0.0, 1e-12, "scipy"), (None, 0.0, "scipy")],
)
def test_a_front_is_timed_where_there_is_no_wave_or_differences_do_not_resolve_it(
    value: float | None, uncertainty: float, by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def found(method: str, *given: Any, **_: Any) -> Any:
        assert given == (at, stated)
        return SimpleNamespace(uncertainty=uncertainty, method=method)

    monkeypatch.setattr(fronts_of, "_by_differences", partial(found, "differences"))
    monkeypatch.setattr(fronts_of, "_by_scipy", partial(found, "scipy"))
    stated: Any = SimpleNamespace(value=value, error=1e-9)
    at = {"c": 1.0, "eta": 0.03125}
    assert fronts_of._averaged_front_known(at, stated).method == by


@pytest.mark.parametrize(
    ("steady", "total", "events", "decided"),
    [(False, 9, 59, False), (True, 9, 59, True), (False, 10, 59, True), (False, 9, 60, True)],
)
def test_a_piecewise_front_is_decided_when_steady_or_at_its_most_periods_or_events(
    steady: bool, total: int, events: int, decided: bool
) -> None:
    run: Any = SimpleNamespace(
        _spreads=lambda: np.array([1.0]),
        _is_steady=lambda *_: steady,
        _total=lambda: total,
        events=events,
    )
    assert front_verdict.History.decided(run, 1e-9, 10) is decided


def test_a_front_that_shrinks_no_more_is_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    run: Any = SimpleNamespace(
        _spreads=lambda: np.ones(1000), _is_steady=lambda *_: False, _total=lambda: 0, events=0
    )
    for shrinks in (False, True):
        monkeypatch.setattr(front_verdict, "_shrinks", lambda _, answer=shrinks: answer)
        assert front_verdict.History.decided(run, 1e-9, 10) is not shrinks
    run._spreads = lambda: np.ones(1)
    monkeypatch.setattr(front_verdict, "_shrinks", lambda _: False)
    assert not front_verdict.History.decided(run, 1e-9, 10)


def test_words_of_a_spreading_are_its_definition_and_its_point() -> None:
    asked: Any = Spreading(1, definition="several", point="minimum")  # type: ignore[arg-type]
    assert asked.definition is Definition.SEVERAL
    assert asked.point is StartPoint.MINIMUM
