"""What is said of a front and of a threshold: of made-up arrivals, waves, searches and lattices."""

from __future__ import annotations

import inspect
import itertools
import math
from collections import Counter
from collections.abc import Callable
from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from fronts.catalogue import COMMANDS, MeasurementCall
from tests.folds import fold_of
from tests.settling import prepared, settle
from theory.arrays import FloatArray
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import MARGIN, Nucleus, Place
from theory.chains.oscillator import OscillatorChain
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError, Range, RunError
from verification.continuation.branch import Crossing, trace
from verification.continuation.newton import solve_at
from verification.fronts import (
    follow,
    friction,
    measure,
    network,
    preparation,
    request,
    resting,
    smooth,
    switchings,
    wave,
)
from verification.fronts.arrival_fit import error_by_disorder, velocity_of_arrivals
from verification.fronts.measure import front_of_wave
from verification.fronts.preparation import FrontPreparation, Settled, Trial
from verification.fronts.result import LeftBoundary
from verification.fronts.status import FrontStatus
from verification.fronts.watch import follow as followed
from verification.piecewise import simulation
from verification.piecewise.simulation import simulate_front
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration
from verification.runs.smooth_integration import SmoothIntegration
from verification.thresholds import continuation, escape, slow_sweep, spreading
from verification.thresholds import threshold as thresholds
from verification.thresholds.result import Definition, Mechanism, RunThreshold, ThresholdMethod
from verification.thresholds.spreading import Spreading

NAN = math.nan
AVERAGED = AveragedChain(a=4, b=0.5, c=0.6)


def _request(**given: Any) -> measure.Request:
    return measure.Request(**given)


# -------------------------------------------------------------------------- a front that is run


def test_a_chain_is_long_enough_when_waves_of_its_end_have_long_overtaken_the_front() -> None:
    """They gain waves - v on it, from 24 sites behind; four times that, or it is faster."""
    prepared = smooth._prepare_smooth(AVERAGED, _request(), LeftBoundary.FREE)
    waves = AVERAGED.trailing_wave_velocity
    assert waves == pytest.approx(0.6 * AVERAGED.eps)
    for share, sites in ((0.5, 96), (0.75, 288)):
        assert not prepared.long_enough(sites - 1, share * waves)
        assert prepared.long_enough(sites + 1, share * waves)
    for share, enough in ((1.0, False), (1.0099, False), (1.0101, True), (2.0, True)):
        assert prepared.long_enough(10**6, share * waves) is enough
    ring = smooth._prepare_smooth(
        AVERAGED.replace(ends=Ends.PERIODIC), _request(), LeftBoundary.FREE
    )
    assert prepared.sized(40) == ring.sized(40) == AVERAGED.replace(sites=64)
    on_wave = smooth._prepare_smooth(AVERAGED, _request(), LeftBoundary.WAVE)
    assert on_wave.long_enough(1, 0.5 * waves)


def test_sites_behind_a_front_are_left_out_only_where_a_wave_is_continued_there() -> None:
    for left, trailing in ((LeftBoundary.FREE, 0), (LeftBoundary.WAVE, 24)):
        prepared = smooth._prepare_smooth(AVERAGED, _request(), left)
        begun = prepared.begin(prepared.sized(40), 1e-8)
        assert isinstance(begun, SmoothIntegration)
        assert begun.trailing_sites == trailing


def test_a_front_is_followed_for_long_enough_to_pass_a_site_in_two_stall_times() -> None:
    prepared = smooth._prepare_smooth(AVERAGED, _request(stall_time=3.0), LeftBoundary.FREE)
    for beyond in (40, 400):
        begun: Any = prepared.begin(prepared.sized(beyond), 1e-8)
        assert begun.end >= 2.0 * 3.0 / AVERAGED.eps * beyond


def test_a_smooth_chain_is_measured_as_is_asked_or_as_is_usual() -> None:
    chain = AveragedChain(a=4, b=0.5, c=0.6, sites=50)
    usual = smooth._prepare_smooth(chain, _request(), LeftBoundary.FREE)
    given = smooth._prepare_smooth(
        chain, _request(accuracy=1e-5, tolerance=1e-9, excited=8, max_sites=77, stall_time=3.0),
        LeftBoundary.FREE,
    )  # fmt: skip
    assert _numbers(usual) == (24, 50, 1000, 1e-3, 1e-8, pytest.approx(60.0 / chain.eps))
    assert _numbers(given) == (8, 50, 77 - 8, 1e-5, 1e-9, pytest.approx(3.0 / chain.eps))
    short = smooth._prepare_smooth(replace(chain, sites=5), _request(), LeftBoundary.FREE)
    assert short.sites == 32
    assert usual.sized(40).sites == 64
    assert usual.settling_tolerance == pytest.approx(1e-3 * chain.stable_amplitude)


def _numbers(made: FrontPreparation) -> tuple[Any, ...]:
    return (made.excited, made.sites, made.max_sites, made.accuracy, made.tolerance,
            made.stall_time)  # fmt: skip


class _Begun(tuple):
    """An integration that is not begun: its start and tolerance."""

    method_of = FrictionIntegration.method_of

    def __new__(cls, _: object, start: Any, *, tolerance: float) -> _Begun:
        return super().__new__(cls, (start, tolerance))


def test_a_friction_chain_is_measured_as_is_asked_or_as_is_usual(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[Any] = []

    def settled(prepared: Any, _: object) -> Settled:
        made.append(prepared)
        return Settled(FrontStatus.STEADY, 0.5, 1e-3, np.arange(3.0), 40, Counter(steps=7))

    monkeypatch.setattr(FrontPreparation, "settled", settled)
    monkeypatch.setattr(friction, "excite", lambda _, sites, **__: [*sites])
    monkeypatch.setattr(friction, "FrictionIntegration", _Begun)
    chain = FrictionChain(c=0.02, sites=40)
    front = friction.friction_front(chain, _request())
    asked = {"accuracy": 1e-3, "tolerance": 1e-9, "excited": 2, "max_sites": 50}
    friction.friction_front(chain, _request(**asked, stall_time=10.0))
    assert _numbers(made[0]) == (1, 40, 800, 1e-2, 1e-8, 3000.0)
    assert _numbers(made[1]) == (2, 40, 50, 1e-3, 1e-9, 10.0)
    assert (front.outruns_waves, front.left_boundary, front.v) == (False, None, 0.5)
    assert [each.begin(chain, 1e-6) for each in made] == [([1], 1e-6), ([1, 2], 1e-6)]
    unknown: Any = None  # whatever the run: all sites are kept, and all are alike
    assert [each.unsettled(unknown) for each in made] == [0.0, 0.0]
    assert not any(each.compared or each.disordered for each in made)
    periods = [each.settling_time / (2.0 * math.pi) for each in made]  # of free oscillation
    assert periods == pytest.approx([10.0, 10.0])


def test_a_measured_front_is_in_slow_time_and_names_the_methods_of_its_steps() -> None:
    prepared: Any = SimpleNamespace(sized=lambda _: AVERAGED, excited=24, kind=SmoothIntegration)
    for stiff, method in ((0, "DOP853"), (2, "DOP853, Radau"), (5, "Radau")):
        counts = Counter(steps=5, stiff_steps=stiff)
        found = Settled(FrontStatus.STEADY, 0.003, 1e-5, np.arange(3.0), 40, counts)
        front = FrontPreparation.front(prepared, found, LeftBoundary.FREE, True)
        assert (front.v, front.error) == pytest.approx((0.3, 1e-3))
        assert (front.method, front.counts, front.outruns_waves) == (method, {"steps": 5}, True)


def test_of_a_smooth_chain_four_to_a_thousand_sites_are_excited() -> None:
    for excited in (4, 1000):
        prepared = smooth._prepare_smooth(AVERAGED, _request(excited=excited), LeftBoundary.FREE)
        assert prepared.sized(40).sites - 40 == prepared.excited == excited
    for excited in (3, 1001):
        with pytest.raises(ParameterError, match="excited sites") as refusal:
            smooth._prepare_smooth(AVERAGED, _request(excited=excited), LeftBoundary.FREE)
        assert refusal.value.quantity == "excited sites"


@pytest.mark.parametrize("v", [None, 0.0, 0.5])
def test_without_waves_behind_it_no_front_is_run_twice(
    v: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[LeftBoundary] = []

    def prepare(_: object, __: object, left: LeftBoundary, ___: int = 1) -> Any:
        made.append(left)
        return SimpleNamespace(settled=lambda _: found, front=lambda *given: given, compared=False)

    found = Settled(FrontStatus.STEADY, v, 1e-3, np.arange(3.0), 40, Counter(steps=7))
    monkeypatch.setattr(smooth, "_prepare_smooth", prepare)
    still: Any = SimpleNamespace(trailing_wave_velocity=0.0)
    front: Any = smooth.smooth_front(still, _request())
    assert made == [LeftBoundary.WAVE]
    assert front == (found, LeftBoundary.FREE, v == 0.5)


@pytest.mark.parametrize("stopped", [None, FrontStatus.CREEPING, FrontStatus.COLLAPSED])
def test_a_front_whose_sites_are_left_out_too_early_has_no_velocity(
    stopped: FrontStatus | None,
) -> None:
    """A hundred times the square of what they were away is part of the error."""
    times = np.arange(64) / 2.0

    def trial(away: float) -> Trial:
        return Trial(stopped, times, np.empty(0) if stopped else times, Counter(steps=3), away)

    how: dict[str, Any] = {"sites": 64, "max_sites": 64, "accuracy": 1e-2}
    wide = settle(lambda _: trial(0.0101), **how)
    assert (wide.v, wide.error, wide.wide, wide.counts) == (None, None, True, {"steps": 3})
    assert (wide.sites, wide.arrivals.tolist()) == (64, times.tolist())
    found = settle(lambda _: trial(0.0099), **how)
    assert not found.wide
    if stopped is None:
        assert (found.v, found.error) == pytest.approx((2.0, 100.0 * 0.0099**2 * 2.0))


def test_a_site_is_away_from_its_final_state_by_what_it_had_when_it_was_left_out() -> None:
    """The later half of them, by the mean of its amplitudes; waves and oscillations say nothing."""
    cell: Any = {"damping": 0, "stiffness": "y*(2 - y)*(0.4 - y)", "overdamped": True, "c": 1.0}
    made = smooth._prepare_smooth(OscillatorChain(**cell), _request(), LeftBoundary.WAVE)
    run = made.begin(made.sized(40), 1e-6)
    assert made.unsettled(run) == 0.0  # of none
    run._run.counters[0] = 5
    run.state[0, :5] = [0.0, 0.0, 1.8, 2.4, 1.4]  # of 2
    assert made.unsettled(run) == pytest.approx(0.2)
    oscillators = OscillatorChain(damping="1 - 4*y**2 + y**4/2", c=0.1, velocity_coupling=1.0)
    for other in (AVERAGED, oscillators):
        waves = smooth._prepare_smooth(other, _request(), LeftBoundary.WAVE)
        assert waves.unsettled(run) == 0.0
    free = smooth._prepare_smooth(OscillatorChain(**cell), _request(), LeftBoundary.FREE)
    whole = free.begin(free.sized(40), 1e-6)
    for first in (0, 5):  # of a run without trailing sites, these are at rest and not left behind
        whole._run.counters[0] = first
        assert whole.left_behind.size == 0


@pytest.mark.parametrize("excited", [None, 10])
def test_a_wide_front_is_measured_with_twice_as_many_sites_until_its_chain_is_too_long(
    excited: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[FrontPreparation] = []

    def settled(prepared: FrontPreparation, _: object) -> Settled:
        made.append(prepared)
        narrow = len(made) == needed
        v = 0.5 if narrow else None
        return Settled(
            FrontStatus.STEADY,
            v,
            v,
            np.arange(3.0),
            prepared.sites,
            Counter(steps=7),
            wide=not narrow,
        )

    monkeypatch.setattr(FrontPreparation, "settled", settled)
    chain = OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(0.2 - y)", overdamped=True, c=1.0, sites=40
    )
    needed = 3
    front = smooth.smooth_front(chain, _request(excited=excited))
    assert [each.sites for each in made] == [40, 64, 128]
    assert [each.tail_amplitude for each in made] == pytest.approx([2e-3] * 3)
    assert [each.excited for each in made] == ([24, 48, 96] if excited is None else [10] * 3)
    runs = [each.begin(each.sized(200), 1e-6) for each in made]
    assert [run.trailing_sites for run in runs] == [(excited or 24) * n for n in (1, 2, 4)]
    assert (front.v, front.counts, front.excited) == (0.5, {"steps": 21}, excited or 96)
    made.clear()
    needed = 6
    with pytest.raises(RunError, match="too wide for chains of max_sites = 600 sites"):
        smooth.smooth_front(chain, _request(excited=excited, max_sites=600))
    # With the excited sites, the next chain of at least 512 is too long, or just not.
    assert [each.sites for each in made] == [40, 64, 128, 256, *([] if excited is None else [512])]
    longest, last = (24 * 8 + 256, 256) if excited is None else (excited + 512, 512)
    for less in (0, 1):  # a chain of as many sites as may be, and one that is too long
        made.clear()
        with pytest.raises(RunError, match="too wide"):
            smooth.smooth_front(chain, _request(excited=excited, max_sites=longest - less))
        assert made[-1].sites == last // (1 + less)


def test_a_front_that_goes_to_rest_is_begun_wider_until_its_chain_is_too_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[FrontPreparation] = []

    def settled(prepared: FrontPreparation, _: object) -> Settled:
        made.append(prepared)
        return Settled(status, None, None, np.empty(0), prepared.sites, Counter(steps=7))

    status = FrontStatus.COLLAPSED
    monkeypatch.setattr(FrontPreparation, "settled", settled)
    chain = OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(0.2 - y)", overdamped=True, c=1.0, coupling="chain:1,0.2",
        sites=40,
    )  # fmt: skip
    front = smooth.own_front(chain, _request(max_sites=600))
    # 16 times as many would be 384 excited and at least 512 beyond them.
    assert [(each.excited, each.sites) for each in made] == [
        (24, 40), (48, 64), (96, 128), (192, 256),
    ]  # fmt: skip
    assert (front.status, front.counts) == (FrontStatus.COLLAPSED, {"steps": 28})
    for asked, tried in (
        ({"max_sites": 192 + 256}, 4), ({"max_sites": 192 + 255}, 3), ({"excited": 24}, 1)
    ):  # fmt: skip
        made.clear()
        smooth.own_front(chain, _request(**asked))
        assert len(made) == tried
    made.clear()
    waves = OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="chain:1,0.2")
    assert waves.trailing_wave_velocity > 0.0
    smooth.own_front(waves, _request(max_sites=600))
    assert len(made) == 1  # where waves travel, fronts are never so wide
    made.clear()
    status = FrontStatus.CREEPING
    smooth.own_front(chain, _request(max_sites=600))
    assert len(made) == 1  # it did not go to rest


def test_a_front_beside_a_longer_wave_has_as_many_sites_beyond_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[FrontPreparation] = []
    found = Settled(FrontStatus.STEADY, 0.5, 1e-6, np.arange(3.0), 40, Counter(steps=7))
    monkeypatch.setattr(FrontPreparation, "settled", lambda each, _: made.append(each) or found)
    request = _request(excited=30, max_sites=400)
    smooth._beside_longer_wave(found, 1e-3, AVERAGED, request)
    first = smooth._prepare_smooth(AVERAGED, request, LeftBoundary.WAVE)
    (longer,) = made
    assert (longer.excited, longer.max_sites) == (2 * first.excited, first.max_sites)


def test_velocities_are_compared_for_oscillating_cells_whose_velocities_are_coupled() -> None:
    own: dict[str, Any] = {"damping": "1 - 4*y**2 + 0.5*y**4", "c": 0.3}
    for chain, compared in (
        (AVERAGED, False), (VdpChain(a=4, b=0.5, c=0.3), False), (OscillatorChain(**own), False),
        (OscillatorChain(**own, velocity_coupling=0.5), True),
    ):  # fmt: skip
        made = smooth._prepare_smooth(chain, _request(), LeftBoundary.WAVE)
        assert made.compared is compared


def test_where_it_is_compared_a_velocity_errs_by_what_half_of_the_chain_changes_in_it() -> None:
    """On the first chain there is none with which to compare it."""
    velocities = {32: 1.0, 64: 1.5, 128: 1.48}

    def trial(sites: int) -> Trial:
        times = np.arange(float(sites)) / velocities[sites]
        return Trial(None, times, times, Counter(steps=1))

    how: dict[str, Any] = {"sites": 32, "accuracy": 0.05, "compared": True}
    found = settle(trial, max_sites=128, **how)
    assert (found.status, found.v) == (FrontStatus.STEADY, pytest.approx(1.48))
    assert found.error == pytest.approx(0.02)
    for longest, v, error in ((40, 1.0, 1.0), (100, 1.5, 0.5)):
        found = settle(trial, max_sites=longest, **how)
        assert (found.status, found.v) == (FrontStatus.UNSTEADY, pytest.approx(v))
        assert found.error == pytest.approx(error)
    assert settle(trial, max_sites=128, **how | {"compared": False}).sites == 32


def test_a_chain_whose_sites_are_reached_at_once_is_made_longer() -> None:
    """A velocity on it is none with which one on the longer chain could be compared."""

    def trial(sites: int) -> Trial:
        times = np.arange(sites) / 2.0 if sites > 32 else np.zeros(sites)
        return Trial(None, times, times, Counter(steps=1))

    for compared, error, status in (
        (False, 5e-9, FrontStatus.STEADY), (True, 2.0, FrontStatus.UNSTEADY),
    ):  # fmt: skip
        found = settle(trial, sites=32, max_sites=127, accuracy=0.1, compared=compared)
        assert (found.sites, found.status, found.v) == (64, status, 2.0)
        assert found.error == pytest.approx(error)


@pytest.mark.parametrize(
    ("velocities", "trailing", "error", "status"),
    [
        ([2.0, 2.01], 48, 0.01, FrontStatus.STEADY),
        ([2.0, 2.5, 2.51], 96, 0.01, FrontStatus.STEADY),
        ([2.0, 2.5, 3.0, 4.0], 192, 1.0, FrontStatus.UNSTEADY),  # the next chain is too long
        ([None], 24, None, FrontStatus.STEADY),
    ],
)
def test_wide_fronts_of_oscillating_cells_have_more_sites_behind_them_until_v_is_the_same(
    velocities: list[float | None], trailing: int, error: float | None, status: FrontStatus,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    made: list[FrontPreparation] = []

    def settled(prepared: FrontPreparation, _: object) -> Settled:
        made.append(prepared)
        v = velocities[len(made) - 1]
        off = None if v is None else 1e-3
        return Settled(FrontStatus.STEADY, v, off, np.arange(3.0), 40, Counter(steps=7))

    monkeypatch.setattr(FrontPreparation, "settled", settled)
    cell: Any = {"damping": "1 - 4*y**2 + 0.5*y**4", "c": 0.3}
    wide = OscillatorChain(**cell, velocity_coupling=1.0)
    wave, found = smooth._widened(wide, _request(max_sites=600, accuracy=0.01))
    assert len(made) == len(velocities)
    assert wave.excited == trailing
    assert found.v == velocities[-1]
    assert found.error == (None if error is None else pytest.approx(error))
    assert found.status is status
    assert found.counts == {"steps": 7 * len(made)}
    made.clear()
    smooth._widened(OscillatorChain(**cell), _request())
    assert len(made) == 1
    pinned = Settled(FrontStatus.PINNED, 0.0, 1.0 / 60.0, np.empty(0), 40, Counter(steps=7))
    assert wave.compared
    assert smooth._alike(pinned, None, wave) == (True, pinned)  # it has no velocity to compare


def test_where_sites_differ_at_random_a_velocity_errs_by_that_disorder() -> None:
    wandering = np.random.default_rng(4).normal(2.0, 0.3, 64).cumsum()
    v, error = velocity_of_arrivals(wandering)
    assert error_by_disorder(wandering) > 1.1 * error  # so that it is the larger one
    made = Trial(None, wandering, wandering, Counter(steps=1))
    for disordered, expected in ((False, error), (True, error_by_disorder(wandering))):
        found = settle(lambda _: made, accuracy=0.1, disordered=disordered)
        assert (found.v, found.error) == (v, pytest.approx(expected))


def test_arrivals_of_a_front_that_reached_the_end_are_complete_though_it_skipped_sites() -> None:
    """As many at both tolerances, even if no site but the one that ends the run was reached."""

    def begin(tolerance: float) -> Any:
        arrivals = np.where(np.arange(40) < 5, 0.0, NAN)
        if tolerance < 1e-7:
            arrivals[5:31] = np.arange(26.0)
        arrivals[[33, 36]] = 50.0, 0.7
        return SimpleNamespace(
            state=np.zeros((2, 40)), arrivals=arrivals, counts={"steps": 1}, time=1.0,
            chain=AVERAGED, amplitude=np.ones(40), advance=lambda _: None,
            going_to_rest=lambda: False,
        )  # fmt: skip

    found = prepared(begin).trial(40, None)
    assert found.arrivals.tolist() == [*range(26), 25.0]  # not before those behind it
    assert found.coarser.tolist() == [0.7] * 27


@pytest.mark.parametrize("v", [1e-4, 1.0, 1e3])
@pytest.mark.parametrize("part", [0.9, 1.1])
def test_a_front_is_steady_by_its_error_over_v_in_whatever_unit_of_time(
    v: float, part: float
) -> None:
    """Three times what the coarser run is off by is a part of what is asked, or a little more."""
    accuracy, sites = 1e-3, np.arange(64)

    def trial(_: int) -> Trial:
        return Trial(None, sites / v, sites / (v * (1.0 + part * accuracy / 3.0)), Counter(steps=1))

    found = settle(trial, sites=64, max_sites=64, accuracy=accuracy, pinned_error=0.0)
    assert found.status is (FrontStatus.STEADY if part < 1.0 else FrontStatus.UNSTEADY)
    assert found.error == pytest.approx(part * accuracy * v)


def test_a_front_that_stops_at_a_coarser_tolerance_is_as_uncertain_as_it_is_fast() -> None:
    """And is tried on longer chains: there the other may arrive, or this one stop."""
    asked: list[int] = []

    def trial(sites: int) -> Trial:
        asked.append(sites)
        return Trial(None, np.arange(sites) / 2.0, np.empty(0), Counter(steps=3))

    found = settle(trial, sites=32, max_sites=99, accuracy=0.1, pinned_error=0.02)
    assert asked == [32, 64]
    assert (found.status, found.v, found.error) == (FrontStatus.UNSTEADY, 2.0, 2.0)


@pytest.mark.parametrize(
    ("stopped", "v", "error"),
    [(FrontStatus.PINNED, 0.0, 0.02), (FrontStatus.CREEPING, None, None)],
)
def test_a_front_that_stopped_has_no_velocity_but_those_that_could_not_be_seen(
    stopped: FrontStatus, v: float | None, error: float | None
) -> None:
    trials = iter(
        [
            # not settled: a longer one
            Trial(None, np.arange(32) ** 1.5, np.arange(32) ** 1.5, Counter(steps=3)),
            Trial(stopped, np.array([0.0, 1.0, NAN, 3.0, NAN]), np.empty(0), Counter(steps=4)),
        ]
    )
    found = settle(lambda _: next(trials), sites=32, max_sites=99, accuracy=1e-6, pinned_error=0.02)
    assert (found.status, found.v, found.error) == (stopped, v, error)
    assert found.arrivals.tolist() == [0.0, 1.0, 3.0]
    assert (found.sites, found.counts) == (64, {"steps": 7})


@pytest.mark.parametrize("displacement", [0.25, -1.5])
def test_a_friction_front_may_begin_from_a_displacement(
    displacement: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Any] = []
    tolerances: list[float] = []

    def settled(prepared: Any, _: object) -> Settled:
        tolerances.append(prepared.settling_tolerance)
        begun.append(prepared.begin(prepared.sized(20), 1e-6))
        return Settled(FrontStatus.STEADY, 0.5, 1e-3, np.arange(3.0), 40, Counter(steps=7))

    monkeypatch.setattr(FrontPreparation, "settled", settled)
    chain = FrictionChain(c=0.02, sites=40)
    friction.friction_front(chain, _request(point=displacement, excited=2))
    (run,) = begun
    start = excite(chain.replace(sites=20), [3])  # of the others, at rest
    assert run.chain.sites == 20
    assert run.state[0, :2].tolist() == [displacement] * 2
    assert tolerances == [1e-4]  # change of y below which a front at rest is pinned
    assert run.state[:, 3:].tolist() == start[:, 3:].tolist()


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"accuracy": 0.2}, "accuracy"),
        ({"accuracy": 1e-7}, "accuracy"),
        ({"tolerance": 1e-3}, "tolerance"),
        ({"tolerance": 1e-13}, "tolerance"),
        ({"excited": 0}, "excited sites"),
        ({"max_sites": 39}, "number of sites n"),
        ({"max_sites": 33, "excited": 10}, "longest chain, max_sites,"),
    ],
)
def test_a_friction_front_is_asked_for_within_ranges(given: dict[str, Any], named: str) -> None:
    with pytest.raises(ParameterError) as refusal:
        friction.friction_front(FrictionChain(c=0.02, sites=40), _request(**given))
    assert refusal.value.quantity == named


def test_a_longest_chain_that_is_too_short_for_a_smooth_front_is_refused_by_its_name() -> None:
    """It is not the number of sites that is out of range, and no longer chain than it is run."""
    with pytest.raises(ParameterError, match=r"max_sites, = 55 .* from 56 to 1000000"):
        measure.measure_front(replace(AVERAGED, sites=20), max_sites=55)
    with pytest.raises(ParameterError, match=r"max_sites, = 41 .* from 42 to 1000000"):
        measure.measure_front(replace(AVERAGED, sites=20), max_sites=41, excited=10)
    with pytest.raises(ParameterError, match=r"n = 41 .* from 2 to 40; .* more max_sites"):
        measure.measure_front(replace(AVERAGED, sites=41), max_sites=64)


@pytest.mark.parametrize("boundary", LeftBoundary)
@pytest.mark.parametrize("excited", [24, 200])
@pytest.mark.parametrize("beyond", [32, 63, 64, 127])
def test_the_longest_chain_contains_the_excited_sites(
    boundary: LeftBoundary, excited: int, beyond: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Chains are doubled from 32 sites beyond the excited ones, as long as all sites fit."""
    lengths: list[int] = []

    def trial(made: FrontPreparation, sites: int, _: object) -> Trial:
        lengths.append(made.sized(sites).sites)
        noise = np.random.default_rng(sites).normal(size=sites)
        return Trial(None, np.arange(sites) + noise, np.empty(0), Counter(steps=1))

    monkeypatch.setattr(FrontPreparation, "trial", trial)
    for max_sites in (excited + beyond, None):
        lengths.clear()
        made = smooth._prepare_smooth(
            replace(AVERAGED, sites=20), _request(excited=excited, max_sites=max_sites), boundary
        )
        made.settled(None)
        most = beyond if max_sites else 1000
        beyond_them = [32 * 2**n for n in range(6) if 32 * 2**n <= most]
        assert lengths == [excited + sites for sites in beyond_them]


@pytest.mark.parametrize(
    ("given", "asked"),
    [
        ({"max_sites": 250, "accuracy": 1e-9}, {"max_sites": 250, "accuracy": 1e-9}),
        ({"max_sites": 9000}, {"max_sites": 9000}),
    ],
)
def test_a_piecewise_front_is_followed_over_so_many_sites_as_are_asked_for(
    given: dict[str, Any], asked: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[dict[str, Any]] = []
    monkeypatch.setattr(switchings, "simulate_front", lambda *_, **how: made.append(how))
    monkeypatch.setattr(switchings, "front_of_switchings", lambda *_: "front")
    chain = PiecewiseChain(c=0.5, eta=0.03)
    assert measure._piecewise_front(chain, _request(**given)) == "front"
    measure._piecewise_front(chain, _request())
    usual = inspect.signature(simulate_front).parameters
    assert made[0] == made[1] | asked
    names = ("start_velocity", "accuracy", "max_sites")
    assert made[1] == {name: usual[name].default for name in names}
    switchings.front_by_switchings(chain)  # what the command line calls
    assert made[1] == made[2]


def test_a_motion_over_a_lattice_has_what_was_excited_and_when_others_were_reached(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lattice = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(3, 4)
    )
    arrivals = np.array([0.0, 0.0, 3.0, 1.0, NAN, 0.0, 2.0, 1.0, NAN, 5.0, 4.0, 6.0])
    found = network.Spread(
        angles=np.zeros(1), velocities=np.full(1, 0.5), errors=np.full(1, 0.01),
        distances=np.zeros(12), arrivals=arrivals,
    )  # fmt: skip
    asked: list[dict[str, Any]] = []
    steady = network.SpreadRun(stopped=None, spread=found, steps=3)
    for name in ("planar", "spread"):
        monkeypatch.setattr(network, name, lambda *_, **given: asked.append(given) or steady)
    monkeypatch.setattr(network, "velocity_of", lambda *_: (0.5, 0.01))
    for directions in (None, 4):
        front = network.spreading_front(lattice, _request(directions=directions))
        assert (front.v, front.error, front.excited) == (0.5, 0.01, 3)
        assert front.arrivals.tolist() == [1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
        assert (front.left_boundary, front.outruns_waves) == (None, False)  # there is no left end
    assert [each["tolerance"] for each in asked] == [1e-8, 1e-8]


def test_a_pinned_front_is_slower_than_one_site_in_the_stall_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In units of slow time: of a chain as of a lattice, along it or in directions."""
    lattice = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(12, 12)
    )
    never = network.Spread(
        angles=np.zeros(1), velocities=np.full(1, NAN), errors=np.full(1, NAN),
        distances=np.zeros(144), arrivals=np.full(144, NAN),
    )  # fmt: skip
    stands = network.SpreadRun(stopped=FrontStatus.PINNED, spread=never, steps=3)
    asked: list[Any] = []
    monkeypatch.setattr(network, "planar", lambda *_, **given: asked.append(given) or stands)
    monkeypatch.setattr(network, "spread", lambda *_, **given: asked.append(given) or stands)
    for stall, time in ((None, 60.0), (10.0, 10.0)):
        for directions in (None, 12):
            front = network.spreading_front(
                lattice, _request(stall_time=stall, directions=directions)
            )
            assert (front.status, front.v) == (FrontStatus.PINNED, 0.0)
            assert front.error == pytest.approx(1.0 / time)
            assert asked[-1].get("directions") == directions
            assert asked[-1]["stall"] == pytest.approx(time * lattice.time_unit)
    monkeypatch.setattr(FrontPreparation, "trial", lambda *_: pinned)
    pinned = Trial(FrontStatus.PINNED, np.full(40, NAN), np.empty(0), Counter(steps=1))
    prepared = smooth._prepare_smooth(AVERAGED, _request(stall_time=10.0), LeftBoundary.FREE)
    found = prepared.settled(None)
    front = FrontPreparation.front(prepared, found, None, False)
    assert front.error == pytest.approx(1.0 / 10.0)
    assert front.counts == {"steps": 1}


@pytest.mark.parametrize(("accuracy", "limit"), [(None, 0.1), (1e-3, 1e-3)])
@pytest.mark.parametrize("v", [1e-3, 0.4, 1e3])
def test_a_front_on_a_lattice_is_steady_if_its_velocity_is_known_as_well_as_is_asked(
    accuracy: float | None, limit: float, v: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    lattice = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(12, 12)
    )
    for part, status in ((0.99, FrontStatus.STEADY), (1.01, FrontStatus.UNSTEADY)):
        error = part * limit * v
        spread = network.Spread(
            angles=np.zeros(1), velocities=np.full(1, v), errors=np.full(1, error),
            distances=np.zeros(144), arrivals=np.arange(144.0),
        )  # fmt: skip
        run = network.SpreadRun(stopped=None, spread=spread, steps=3)
        monkeypatch.setattr(network, "planar", lambda *_, run=run, **__: run)
        front = network.spreading_front(lattice, _request(accuracy=accuracy))
        assert (front.status, front.v, front.error) == (status, v, error)


def test_a_motion_is_followed_in_as_many_directions_as_are_asked_for_or_in_four(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[int] = []

    def spread(*_: Any, directions: int, **__: Any) -> Any:
        asked.append(directions)
        raise KeyboardInterrupt

    monkeypatch.setattr(network, "spread", spread)
    for shape, directions, expected in ((None, None, 4), ((30, 30), 9, 9)):
        chain: Any = SimpleNamespace(shape=shape, time_unit=1.0)
        with pytest.raises(KeyboardInterrupt):
            network.spreading_front(chain, _request(directions=directions))
        assert asked[-1] == expected


@pytest.mark.parametrize(("share", "outruns"), [(1.0, False), (1.02, True)])
def test_a_front_of_a_network_along_a_line_outruns_its_waves_or_not(
    share: float, outruns: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    chain = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.6, coupling="chain:1,0.2", sites=40
    )
    waves = chain.trailing_wave_velocity
    assert chain.network is not None
    assert waves > 0.0
    found = Settled(FrontStatus.STEADY, share * waves, 1e-6, np.arange(3.0), 40, Counter(steps=7))
    asked: list[Any] = []
    monkeypatch.setattr(FrontPreparation, "settled", lambda *given: asked.append(given) or found)
    request = _request(progress=print)
    assert smooth.own_front(chain, request).outruns_waves is outruns
    ((prepared, progress),) = asked
    assert (prepared.excited, progress) == (24, print)


class _BegunError(Exception):
    """Nothing that was asked has been refused."""


@pytest.fixture
def stopped_at_its_beginning(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever runs the chain."""
    for place, name in (
        (FrontPreparation, "settled"), (network, "_measured"), (simulation, "_start_state")
    ):  # fmt: skip
        monkeypatch.setattr(place, name, Mock(side_effect=_BegunError))


def _lengths(kind: str) -> Any:
    smooth = {"damping": "1 - 4*y**2 + 0.5*y**4", "c": 0.1}
    return {
        "smooth": AVERAGED,
        "friction": FrictionChain(c=0.02, sites=400),
        "piecewise": PiecewiseChain(c=0.5, eta=0.03125),
        "lattice": OscillatorChain(**smooth, coupling="square", sites=(40, 3)),
        "network": OscillatorChain(**smooth, coupling=np.ones((60, 60)) - np.eye(60)),
        "beyond neighbours": OscillatorChain(**smooth, coupling="next-nearest:1,0.2"),
        "own": OscillatorChain(**smooth),
    }[kind]


@pytest.mark.usefixtures("stopped_at_its_beginning")
@pytest.mark.parametrize(
    ("kind", "option", "low", "high"),
    [
        ("smooth", "accuracy", 1e-13, 0.1),
        ("smooth", "tolerance", 1e-14, 1e-4),
        ("smooth", "excited", 4, 1000),
        ("smooth", "stall_time", 1e-6, 1e9),
        ("friction", "accuracy", 1e-6, 0.1),
        ("friction", "tolerance", 1e-12, 1e-4),
        ("friction", "excited", 1, 100),
        ("piecewise", "accuracy", 1e-13, 0.01),
        ("piecewise", "max_sites", 80, 1_000_000),
        ("lattice", "accuracy", 1e-13, 0.1),
        ("lattice", "tolerance", 1e-14, 1e-4),
        ("lattice", "excited", 1, 40 - 14),
        ("network", "excited", 1, 59),
    ],
)
def test_options_of_a_front_have_the_ranges_that_are_documented(
    kind: str, option: str, low: Any, high: Any
) -> None:
    """And are refused by their names."""
    chain = _lengths(kind)
    for inside in (low, high):
        with pytest.raises(_BegunError):
            measure.measure_front(chain, **{option: inside})
    step = 1 if isinstance(low, int) else 0.0
    for outside in (0.99 * low - step, 1.01 * high + step):
        with pytest.raises(ParameterError, match=option.replace("_", ".")):
            measure.measure_front(
                chain,
                **{option: round(outside) if step else outside},  # type: ignore[arg-type]
            )


GIVEN: dict[str, Any] = {
    "accuracy": 1e-3, "tolerance": 1e-6, "excited": 7, "max_sites": 500, "stall_time": 3.0,
    "left_boundary": "wave", "point": 3.0, "directions": 8,
}  # fmt: skip
RUNS = {"accuracy", "tolerance", "excited", "max_sites", "stall_time"}
READ = {
    "smooth": RUNS | {"left_boundary"},
    "friction": RUNS | {"point"},
    "piecewise": {"accuracy", "max_sites"},
    "lattice": RUNS - {"max_sites"} | {"directions"},
    "network": RUNS - {"max_sites"},
    "beyond neighbours": RUNS,
    "own": RUNS | {"left_boundary"},
}


@pytest.mark.usefixtures("stopped_at_its_beginning")
@pytest.mark.parametrize("option", GIVEN)
@pytest.mark.parametrize("kind", READ)
def test_an_option_is_read_or_refused(kind: str, option: str) -> None:
    read = option in READ[kind]
    with pytest.raises(_BegunError if read else ParameterError, match=None if read else option):
        measure.measure_front(_lengths(kind), **{option: GIVEN[option]})
    usual = {each.name: each.default for each in fields(measure.Request)}
    with pytest.raises(_BegunError):  # as if it were not given
        measure.measure_front(
            _lengths(kind),
            **{option: usual[option]},
            progress=lambda _: None,  # type: ignore[arg-type]
        )


@pytest.mark.parametrize("option", GIVEN)
def test_a_wave_depends_on_no_option_of_runs_in_the_library_as_in_the_shell(option: str) -> None:
    shell = COMMANDS["front"].calls["averaged"]
    assert isinstance(shell, MeasurementCall)
    assert (option in shell.only) is (option not in shell.hidden)
    with pytest.raises(ParameterError, match=f"{option} = .* absent with the method wave"):
        measure.measure_front(AVERAGED, method="wave", **{option: GIVEN[option]})


def test_the_infinite_chain_has_no_left_end_whose_waves_could_be_outrun() -> None:
    front = measure.measure_front(PiecewiseChain(c=0.5, eta=0.03125))
    assert (front.outruns_waves, front.left_boundary, front.excited) == (False, None, None)
    assert front.counts["events"] > 0
    assert front.steps == front.to_dict()["steps"] == 0


@pytest.mark.parametrize("above", [False, True])
def test_where_no_wave_is_found_the_front_is_pinned_below_c_pin_alone(
    above: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def front_wave(*_: object) -> None:
        raise wave.NoFrontError("made up")

    monkeypatch.setattr(measure, "front_wave", front_wave)
    fold = resting.static_fold(AVERAGED.eta)
    c_pin = fold.c
    if above:
        with pytest.raises(wave.NoFrontError, match="made up"):
            front_of_wave(replace(AVERAGED, c=c_pin * (1.0 + 1e-9)))
    else:
        for c in (0.5 * c_pin, c_pin - 2.0 * fold.error, c_pin, c_pin + 0.9 * fold.error):
            front = front_of_wave(replace(AVERAGED, c=c))
            assert (front.status, front.v) == (FrontStatus.PINNED, 0.0)
            assert not front.outruns_waves
            beyond = max(0.0, c - (c_pin - fold.error))
            assert front.error == pytest.approx(fold.square_root * math.sqrt(beyond), rel=1e-6)


def test_of_two_runs_the_steps_are_those_of_both(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second has the velocity of the first for comparison, and its own as the answer."""
    first = Settled(FrontStatus.STEADY, 1e-4, 1e-9, np.arange(3.0), 40, Counter(steps=7))
    second = replace(first, v=2e-4, counts=Counter(steps=11))
    asked: list[Any] = []

    def settled(prepared: Any, _: object) -> Settled:
        asked.append(prepared.other_velocity)
        return second if len(asked) == 2 else first

    monkeypatch.setattr(FrontPreparation, "settled", settled)
    front = smooth.smooth_front(AVERAGED, _request())
    assert asked == [None, 1e-4]
    assert (front.v, front.counts["steps"]) == (pytest.approx(2e-2), 18)
    assert front.steps == front.to_dict()["steps"] == 18


@pytest.mark.parametrize(
    ("share", "outruns"), [(1.0, False), (1.0099, False), (1.0101, True), (5.0, True)]
)
def test_a_wave_that_was_solved_for_states_its_own_error(share: float, outruns: bool) -> None:
    made: Any = SimpleNamespace(v=share * 0.6, error=1e-9, steps=7, iterations=3, seconds=2.0)
    front = front_of_wave(AVERAGED, made)
    assert (front.v, front.error, front.seconds) == (share * 0.6, 1e-9, 2.0)
    assert (front.status, front.outruns_waves) == (FrontStatus.STEADY, outruns)
    assert front.counts == {"steps": 7, "iterations": 3}


def test_another_velocity_counts_only_where_the_longest_chain_is_not_long_enough() -> None:
    def found(enough: bool, max_sites: int) -> Settled:
        def trial(sites: int) -> Trial:
            times = np.arange(sites) / 2.0
            return Trial(None, times, times, Counter(steps=3))

        return settle(trial, sites=32, max_sites=max_sites, accuracy=1.0, pinned_error=0.0,
                      other_velocity=2.5,
                      long_enough=lambda sites, v: enough and v < 3.0 < sites)  # fmt: skip

    for enough, most, sites, error, steps in (
        (False, 63, 32, 0.5, 3), (True, 63, 32, 5e-9, 3), (False, 64, 64, 0.5, 6),
        (False, 128, 128, 0.5, 9),
    ):  # fmt: skip
        settled = found(enough, most)
        assert (settled.sites, settled.counts["steps"]) == (sites, steps)
        assert settled.error == pytest.approx(error, abs=1e-9)
        assert settled.arrivals.size == sites


def test_a_front_is_steady_only_if_it_has_travelled_for_the_settling_time() -> None:
    """Otherwise no error of its velocity is known."""
    prepared = smooth._prepare_smooth(AVERAGED, _request(), LeftBoundary.WAVE)
    assert prepared.settling_time == pytest.approx(2.0 / AVERAGED.eps)

    def trial(sites: int) -> Trial:
        times = np.arange(sites) / (2.0 if sites < 100 else 2.125)
        return Trial(None, times, times, Counter(steps=3))

    for time, most, sites, error, status in (
        (16.0, 1000, 32, 5e-9, FrontStatus.STEADY), (16.1, 1000, 64, 5e-9, FrontStatus.STEADY),
        (16.1, 63, 32, math.inf, FrontStatus.UNSTEADY),
        (65.0, 128, 128, math.inf, FrontStatus.UNSTEADY),
    ):  # fmt: skip
        found = settle(trial, sites=32, max_sites=most, accuracy=0.1, settling_time=time)
        assert (found.sites, found.status) == (sites, status)
        assert found.error == pytest.approx(error, abs=1e-7)


def test_a_run_that_is_asked_too_often_is_asked_less() -> None:
    """Its budget of steps is doubled for as long as less than a part of the stall time passes."""
    budgets: list[int] = []

    class Slow:
        time, state, amplitude = 0.0, np.zeros((2, 40)), np.zeros(40)
        arrivals = np.full(40, NAN)

        def advance(self, budget: int) -> None:
            budgets.append(budget)
            self.time += 1.0

        def going_to_rest(self) -> bool:
            return len(budgets) == 6

    made: Any = Slow()
    found = followed(made, stall_time=1e3, settling_tolerance=1e-3)
    assert found is FrontStatus.COLLAPSED
    assert [later // budgets[0] for later in budgets] == [1, 2, 4, 8, 16, 32]


# ------------------------------------------------------------------------- waves, resting fronts


@pytest.mark.parametrize(
    ("values", "along", "length"), [([0.5, 3.0], "c", 3.125), ([0.5, 0.6], "c", 2.0),
                                    ([0.02, 0.05], "eta", 2.0), ([0.5, 3.0, 1.0], "c", 3.125),
                                    ([0.05, 0.02, 0.03], "eta", 2.0)],
)  # fmt: skip
def test_a_branch_of_fronts_is_followed_from_the_largest_value_past_the_smallest(
    values: list[float], along: Any, length: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, Any] = {}
    window = SimpleNamespace(system=lambda: "system", guess="guess", described=lambda *_: "front")

    def started(c: float, eta: float, by: str) -> Any:
        asked["started"] = (c, eta, by)
        return window

    def trace(system: str, start: Any, end: float, _: None, steps: Any) -> Any:
        asked["trace"] = (system, start, steps.longest)
        asked["end"] = end
        return SimpleNamespace(folds=("one", "two", "three"))

    monkeypatch.setattr(follow.Window, "started", started)
    monkeypatch.setattr(follow, "solve_at", lambda *given: given)
    monkeypatch.setattr(follow, "trace", trace)
    monkeypatch.setattr(follow, "solutions_at", lambda *_: [("p", 0), ("q", 1), ("r", 1), ("s", 3)])
    found = follow.follow_front_wave(values, 0.7, along)
    expected = (max(values), 0.7) if along == "c" else (0.7, max(values))
    assert asked["started"] == (*expected, along)
    assert asked["trace"] == ("system", ("system", "guess", max(values)), length)
    assert min(values) * (1.0 - 1e-11) < asked["end"] < min(values)
    assert found.fronts == ("front",) * 4
    assert found.folds == (("one", 1), ("two", 3), ("three", 3))


@pytest.mark.parametrize(
    ("c", "eta", "v"),
    [
        (0.6, 0.03125, 0.72),
        (3.0, 0.1, 3.6),
        (0.1, 0.01, 0.3),
        (100.0, 0.1, 102.3),
        (0.02, 0.05, 0.3),
    ],
)
def test_a_front_dies_away_by_its_tails(c: float, eta: float, v: float) -> None:
    """vλ = c sinh λ + f'(ρ): the one root ahead, and behind the one with the least real part."""
    window = wave.Window(resting.amplitudes_of(c, eta), 4, 6, np.append(np.ones(10), v))
    behind, ahead = window._decay(v)
    assert min(behind, ahead) > 0.0
    assert abs(c * math.sinh(ahead) - v * ahead - 0.5) < 1e-10
    turns = np.linspace(-math.pi, math.pi, 4001)
    on_line = behind + 1j * turns
    off = np.abs(c * np.sinh(on_line) - v * on_line + window.attraction)
    assert off.min() < 0.01 * (1.0 + abs(window.attraction))  # a root has that real part
    s = (1.0 + math.sqrt(1.0 - 8.0 * eta)) / eta
    assert window.attraction == pytest.approx(0.5 - 0.375 * s + 0.3125 * eta * s**2, rel=1e-12)


@pytest.mark.parametrize(("left", "right"), [(2, 3), (6, 9), (6, 3), (2, 9)])
def test_a_window_that_is_resized_keeps_its_front_in_its_place(
    left: int, right: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Behind what it had stands the cycle, ahead of it rest; v is the last of the unknowns."""
    chain = resting.amplitudes_of(0.6, 0.03125)
    rho = np.array([0.99, 0.98, 0.97, 0.96, 0.5, 0.1, 0.02, 0.01, 0.005])
    window = wave.Window(chain, 4, 5, np.append(rho, 0.72))
    depth = 10.0
    monkeypatch.setattr(
        wave.Window, "_decay", lambda *_: (depth / (left - 1.5), depth / (right - 1.5))
    )
    found = window._resized(0.72, depth)
    assert (found.left, found.right) == (left, right)
    padded = np.concatenate([np.ones(9), rho, np.zeros(9)])
    assert found.guess.tolist() == [*padded[13 - left : 13 + right], 0.72]


@pytest.mark.parametrize("c", [0.2, 100.0])
def test_steps_of_a_wave_are_half_the_time_of_its_fastest_rate(c: float) -> None:
    """Of coupling and attraction together; 1.5 times as many for the check."""
    window = wave.Window(resting.amplitudes_of(c, 0.03125), 4, 6, np.ones(11))
    for time in (0.7, 40.0, 2.45 / (c + window.attraction)):
        fewest = time * (c + window.attraction) / 0.5
        assert fewest <= window._steps_in(time, 1.0) <= fewest + 1.0
        assert 1.5 * fewest <= window._steps_in(time, 1.5) <= 1.5 * (fewest + 1.0) + 1.0


@pytest.mark.parametrize("v", [0.9e-3, 1.1e-3, 1.5e-3])
def test_a_run_to_a_front_is_given_up_when_one_site_takes_too_long(
    v: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up motion, in which sites pass the unstable cycle one by one, at a velocity v."""
    window = wave.Window(resting.amplitudes_of(0.1, 0.1), 4, 6, np.empty(0))

    def advanced(rho: FloatArray, _: object, time: float) -> FloatArray:
        ahead = int(np.argmax(rho < (1.0 - 1e-9) * window.unstable))  # of those that have passed
        return rho + time * v * window.unstable * (np.arange(rho.size) == ahead)

    def given_up(_: wave.Window) -> wave.NoFrontError:
        return wave.NoFrontError("made up")

    monkeypatch.setattr(wave, "_PERIODS", 3)
    monkeypatch.setattr(wave, "advanced", advanced)
    monkeypatch.setattr(wave.Window, "_no_front", given_up)
    if v < wave.SLOWEST == 1e-3:
        with pytest.raises(wave.NoFrontError, match="made up"):
            window._run_to_a_front()
    else:
        rho, found = window._run_to_a_front()
        assert found == pytest.approx(v, rel=1e-3)  # it starts Newton's method
        assert rho[4:6] == pytest.approx([window.unstable, 0.0], rel=1e-2, abs=1e-12)


def test_where_no_front_was_found_it_is_pinned_or_slower_than_one_thousandth(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    window = wave.Window(resting.amplitudes_of(0.1, 0.1), 4, 6, np.empty(0))
    for c_pin, said in (
        (0.125, "no front travels at c = 0.1, eta = 0.1: fronts are pinned up to c_pin = 0.125;"),
        (0.0625, "the front at c = 0.1, eta = 0.1 is slower than 0.001; near c_pin = 0.0625 its"),
    ):
        fold = SimpleNamespace(c=c_pin, square_root=0.5)
        monkeypatch.setattr(wave, "static_fold", lambda _, fold=fold: fold)
        assert str(window._no_front()).startswith(said)


def test_fronts_are_looked_for_down_to_a_velocity_of_one_thousandth(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Few steps suffice for a weak attraction."""
    assert wave.SLOWEST == 1e-3
    eta = 0.1
    monkeypatch.setattr(wave, "_PERIODS", 3)
    fold = resting.static_fold(eta)

    def coupling(v: float) -> float:
        return fold.c + (v / fold.square_root) ** 2

    window = wave.Window.started(coupling(1.5e-3), eta)
    assert window.guess[-1] == pytest.approx(1.5e-3, rel=0.1)
    with pytest.raises(wave.NoFrontError, match=r"slower than 0\.001"):
        wave.Window.started(coupling(7e-4), eta)


def test_multipliers_are_compared_with_those_of_the_first_solution(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """That of its own window and steps; their difference is then the error of both."""
    asked: list[tuple[int, float]] = []
    multipliers = wave.Window._multipliers

    def noted(window: wave.Window, u: FloatArray, finer: float) -> Any:
        asked.append((window.left + window.right, finer))
        return multipliers(window, u, finer)

    monkeypatch.setattr(wave.Window, "_multipliers", noted)
    first = wave.Window.started(0.6, 0.03125)
    point = solve_at(first.system(), first.guess, 0.6)
    first.described(point, 0.0)
    assert sorted(asked)[0] == (first.left + first.right, 1.0)
    assert [finer for _, finer in sorted(asked)] == [1.0, 1.5]


def test_a_window_at_another_value_is_the_same_sites_of_another_chain() -> None:
    window = wave.Window(resting.amplitudes_of(0.6, 0.03125), 4, 5, np.zeros(10))
    assert window.at(0.7).chain == resting.amplitudes_of(0.7, 0.03125)
    other = replace(window, along="eta").at(0.05)
    assert other.chain == resting.amplitudes_of(0.6, 0.05)
    assert (other.left, other.right) == (4, 5)
    assert (window.place, window.at(0.7).place, other.place) == (0.6, 0.7, 0.05)
    assert (
        window._steps_in(3.0, 1.5)
        > window._steps_in(3.0, finer=1.0)
        > window._steps_in(2.0, finer=1.0)
    )


def test_the_law_beside_the_fold_is_that_of_its_second_derivative() -> None:
    """α by a step of c along ψ, β by second differences of the rate along φ."""
    chain = resting.amplitudes_of(0.0, 0.05)
    fold = resting._fold(chain, 8, 20)
    at = chain._replace(c=fold.parameter)
    matrix = resting._at_rest(chain, 28)(fold.u, fold.parameter)[1]
    left, _, right = np.linalg.svd(matrix)
    psi, phi = left[:, -1], right[-1]
    psi = psi / (psi @ phi)
    h = 1e-4

    def drift(rho: Any, c: float) -> float:
        return float(psi @ resting.rate(rho, at._replace(c=c)))

    alpha = (drift(fold.u, fold.parameter + h) - drift(fold.u, fold.parameter - h)) / (2.0 * h)
    beta = (drift(fold.u + h * phi, fold.parameter) + drift(fold.u - h * phi, fold.parameter)) / (
        2.0 * h * h
    )
    square_root, _ = resting._beside(chain, fold.u, fold.parameter)
    assert square_root == pytest.approx(math.sqrt(alpha * beta) / math.pi, rel=1e-5)
    inverse = np.linalg.pinv(matrix, rcond=1e-6)  # without the null vectors
    sensitive = np.linalg.norm(matrix, 2) * np.linalg.norm(inverse, 2)
    assert resting._condition(chain, fold) == pytest.approx(sensitive, rel=1e-6)


def _rest_at_the_fold(eta: float, start: Any, c: float) -> tuple[float, float, float]:
    """Newton's method for rest and null vector together; returns c, √(αβ)/π and dc/dη.

    r_n' = (c/2)(r_{n-1} - r_{n+1}) - f(r_n) with a = 1, b = η; f is ``rest``.
    """
    sites, cycle = start.size, math.sqrt((1.0 + math.sqrt(1.0 - 8.0 * eta)) / eta)
    shifts = 0.5 * (np.eye(sites, k=-1) - np.eye(sites, k=1))
    edge = np.zeros(sites)
    edge[0] = 0.5 * cycle
    r = start * cycle
    phi = np.linalg.svd(c * shifts - np.diag(0.5 - 0.375 * r**2 + 0.3125 * eta * r**4))[2][-1]
    for _ in range(8):
        f = 0.5 * r * (1.0 - 0.25 * r**2 + 0.125 * eta * r**4)
        bend = 0.75 * r - 1.25 * eta * r**3
        matrix = c * shifts - np.diag(0.5 - 0.375 * r**2 + 0.3125 * eta * r**4)
        off = np.concatenate([c * (shifts @ r + edge) - f, matrix @ phi, [phi @ phi - 1.0]])
        whole = np.zeros((2 * sites + 1, 2 * sites + 1))
        whole[:sites, :sites], whole[:sites, -1] = matrix, shifts @ r + edge
        whole[sites:-1, :sites] = np.diag(bend * phi)
        whole[sites:-1, sites:-1], whole[sites:-1, -1] = matrix, shifts @ phi
        whole[-1, sites:-1] = 2.0 * phi
        step = np.linalg.solve(whole, off)
        r, phi, c = r - step[:sites], phi - step[sites:-1], c - float(step[-1])
    assert np.abs(step).max() < 1e-12
    psi = np.linalg.svd(matrix.T)[2][-1]
    psi /= psi @ phi
    alpha, beta = psi @ (shifts @ r + edge), 0.5 * psi @ (bend * phi**2)
    return c, math.sqrt(alpha * beta) / math.pi, float(psi @ (r**5 / 16.0)) / alpha


@pytest.mark.parametrize("eta", [0.005, 0.03125, 0.06, 0.09])
def test_the_error_of_the_square_root_law_bounds_it(eta: float) -> None:
    fold = resting.static_fold(eta)
    cycle = math.sqrt((1.0 + math.sqrt(1.0 - 8.0 * eta)) / eta)
    c, square_root, slope = _rest_at_the_fold(eta, fold.r / cycle, fold.c)
    assert abs(c - fold.c) <= fold.error + 1e-15
    assert abs(square_root - fold.square_root) <= fold.square_root_error < 1e-7
    assert abs(slope - fold.slope) <= fold.slope_error < 1e-5


def test_a_stall_time_is_positive_and_has_a_default() -> None:
    option = request.stall_time(60.0)
    assert [option.number(given) for given in (None, 1e-6, 5.0)] == [60.0, 1e-6, 5.0]
    for given in (0.0, 9e-7, 2.0 * request.LATEST):
        with pytest.raises(ParameterError, match="stall time"):
            option.number(given)


@pytest.mark.parametrize("shorter", [0.1 - 3e-9, 0.1 + 3e-9])
def test_the_fold_errs_by_what_a_longer_window_changes_and_by_its_own_error(
    shorter: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of made-up folds; the first window leaves out more, so that its difference is a bound."""
    folds = iter(
        [
            SimpleNamespace(parameter=shorter, error=1e-15),
            SimpleNamespace(parameter=0.1, error=5e-9),
        ]
    )
    made = SimpleNamespace(u=np.ones(3), offset=np.zeros(3))

    def fold(*_: Any) -> Any:
        found = next(folds)
        found.u, found.offset = made.u, made.offset
        return found

    monkeypatch.setattr(resting, "_fold", fold)
    monkeypatch.setattr(resting, "_beside", lambda *_: (0.5, 4.0))
    monkeypatch.setattr(resting, "_condition", lambda *_: 1e6)
    found = resting.static_fold.__wrapped__(0.05)
    assert found.c == 0.1
    # Beside the fold both windows agree, and what is left is rounding.
    rounding = 16e6 * np.finfo(float).eps
    assert found.square_root_error == pytest.approx(0.5 * rounding, rel=1e-12)
    assert found.slope_error == pytest.approx(4.0 * rounding, rel=1e-12)
    assert 3e-9 + 5e-9 <= found.error <= 2.0 * (3e-9 + 5e-9)
    off = math.copysign(1e-3, shorter - 0.1)
    for window, place in ((off, 0.0), (0.0, off), (off, off)):
        folds = iter([made, made])
        made.parameter, made.error = 0.1, 0.0
        beside = iter([(0.5, 4.0), (0.5 + window, 4.0 + window), (0.5 + place, 4.0 + place)])
        monkeypatch.setattr(resting, "_beside", lambda *_, beside=beside: next(beside))
        found = resting.static_fold.__wrapped__(0.05)
        for error in (found.square_root_error, found.slope_error):
            assert abs(window) + abs(place) <= error <= 2.0 * abs(window) + abs(place) + 4e-8


def test_the_pinning_eta_errs_by_what_is_left_of_c_and_by_the_error_of_the_fold(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a made-up fold, c_pin = 0.1 + 4 η, which errs by 1e-6; what is left has either sign."""
    for off in (-3e-6, 3e-6):
        asked: list[float] = []

        def fold(eta: float, off: float = off, asked: list[float] = asked) -> Any:
            asked.append(eta)
            return SimpleNamespace(
                c=0.1 + 4.0 * eta, error=1e-6, slope=4.0, slope_error=0.08,
                square_root=0.5, square_root_error=1e-3,
            )  # fmt: skip

        def root(f: Any, *ends: float, off: float = off, **_: Any) -> float:
            assert f(0.05) == pytest.approx(0.0, abs=1e-15)
            assert ends == tuple(resting.ETAS)
            return 0.05 + 0.25 * off

        monkeypatch.setattr(resting, "static_fold", fold)
        monkeypatch.setattr(resting, "brentq", root)
        found = resting.pinning_eta.__wrapped__(0.3)
        assert found.eta == 0.05 + 0.25 * off
        assert found.error == pytest.approx((3e-6 + 1e-6) / 4.0, rel=1e-6)
        assert found.square_root == pytest.approx(0.5 * math.sqrt(4.0))
        ends = [(0.5 + x) * math.sqrt(4.0 + y) for x in (-1e-3, 1e-3) for y in (-0.08, 0.08)]
        assert found.square_root_error == pytest.approx(max(ends) - 1.0, rel=0.02)


# --------------------------------------------------------------------------------- lattices


def _lattice(rows: int, columns: int, tilt: float = 0.0) -> Any:
    """A square lattice far from the origin, of which only its places are asked."""
    row, column = np.unravel_index(np.arange(rows * columns), (rows, columns))
    positions = np.column_stack([column + tilt * row, row]) + np.array([100.0, -50.0])
    links = SimpleNamespace(positions=positions, distances=lambda _: pytest.fail("of a lattice"))
    return SimpleNamespace(
        links=links, sites=rows * columns, shape=(rows, columns), time_unit=2.0, relaxation_time=0.0
    )


def test_distances_on_a_lattice_are_in_the_plane_from_its_middle_site() -> None:
    chain = _lattice(5, 9)
    middle = network.middle_site(chain)
    assert middle == 2 * 9 + 4
    for rows, columns in ((4, 9), (9, 4), (6, 6), (2, 3)):
        row, column = divmod(network.middle_site(_lattice(rows, columns)), columns)
        assert max(abs(2 * row + 1 - rows), abs(2 * column + 1 - columns)) <= 1
    away = network.distances_from(chain, middle).reshape(5, 9)
    assert away[0, 0] == pytest.approx(math.hypot(2.0, 4.0))
    assert away[2].tolist() == [4.0, 3.0, 2.0, 1.0, 0.0, 1.0, 2.0, 3.0, 4.0]
    # To the nearest side, less two sites; a side that is farther does not matter.
    assert network._radius(chain, middle) == 2.0 - network.EDGE
    assert network._radius(_lattice(9, 5), 4 * 5 + 2) == 2.0 - network.EDGE
    assert network._radius(_lattice(11, 11), 4 * 11 + 6) == 4.0 - network.EDGE
    assert network._radius(_lattice(11, 11), 7 * 11 + 5) == 3.0 - network.EDGE
    assert network._radius(_lattice(11, 11), 5 * 11 + 8) == 2.0 - network.EDGE


def test_the_velocity_in_a_direction_is_that_along_its_ray() -> None:
    """Twice as fast to the right; of sites beyond the first ones, and not beside an end."""
    chain = _lattice(41, 41)
    middle = network.middle_site(chain)
    away = network.distances_from(chain, middle)
    offset = chain.links.positions - chain.links.positions[middle]
    speed = np.where(offset[:, 0] > 0.0, 4.0, 2.0)
    arrivals = np.abs(offset).max(axis=1) / speed
    arrivals[middle] = 0.0
    arrivals[away > 18.5] = 77.0  # beside a side: not used
    arrivals[away < 3.5] = 55.0  # among the first
    arrivals[np.abs(offset[:, 1]) == 2.0] = 66.0  # beside the rays to the right and the left
    arrivals[(offset[:, 1] == 1.0) & (offset[:, 0] == 10.0)] = NAN
    excited = int(np.count_nonzero(away < 3.5))
    angles, v, error = network._fitted(
        chain, away, middle=middle, arrivals=arrivals, directions=4, excited=excited
    )
    assert angles == pytest.approx([0.0, 0.5 * math.pi, math.pi, 1.5 * math.pi])
    assert v[[0, 2]] == pytest.approx([4.0, 2.0])
    assert error[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert all(2.0 - 1e-9 < each < 3.0 for each in v[[1, 3]])  # of sites on both sides of the ray


def test_rays_begin_beyond_the_farthest_of_the_excited_sites() -> None:
    """One site alone: from it on; what is among the excited sites was not reached by a front."""
    chain = _lattice(41, 41)
    middle = network.middle_site(chain)
    away = network.distances_from(chain, middle)
    for excited, beyond in ((1, 0.0), (49, 4.0)):
        arrivals = away / 2.0
        arrivals[away <= beyond] = 0.0
        _, v, error = network._fitted(
            chain, away, middle=middle, arrivals=arrivals, directions=4, excited=excited
        )
        assert np.sort(away)[excited - 1] == beyond
        assert v == pytest.approx([2.0] * 4, rel=0.03)  # sites beside a ray are farther off
        assert np.all(error < 0.1)


def test_a_ray_has_three_sites_at_each_distance_beyond_the_farthest_excited_one() -> None:
    """To the right, also if rounding moves sites; by numpy's line, of times at random."""
    chain = _lattice(41, 41)
    middle = network.middle_site(chain)
    away = network.distances_from(chain, middle)
    times = np.sort(np.random.default_rng(2).random(41 * 41))[np.argsort(np.argsort(away))]
    _, v, _ = network._fitted(
        chain, away, middle=middle, arrivals=times, directions=1, excited=49
    )  # the farthest excited site is four sites away
    sites = [middle + n + 41 * beside for n in range(5, 19) for beside in (-1, 0, 1)]
    sites = [site for site in sites if away[site] <= 18.0]
    outer = sites[len(sites) // 2 :]
    along = [(site - middle + 20) % 41 - 20.0 for site in outer]
    assert v == pytest.approx([1.0 / np.polyfit(along, times[outer], 1)[0]])


@pytest.mark.parametrize("sites", [2, 7, 8, 31])
def test_the_middle_of_a_network_is_that_of_its_numbers(sites: int) -> None:
    chain: Any = SimpleNamespace(links=SimpleNamespace(positions=None), sites=sites)
    middle = network.middle_site(chain)
    assert abs(middle - (sites - 1 - middle)) <= 1


def test_a_motion_on_a_lattice_stands_if_no_amplitude_changes_by_a_part_in_a_thousand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the stable cycle, whatever its size."""
    asked: list[tuple[float, float]] = []

    def stall(_: Any, time: float, tolerance: float) -> Any:
        asked.append((time, tolerance))
        return SimpleNamespace(note=lambda _: None, status=lambda: FrontStatus.PINNED)

    monkeypatch.setattr(network, "Stall", stall)
    for size in (0.1, 30.0):
        run: Any = SimpleNamespace(
            chain=SimpleNamespace(stable_amplitude=size), advance=lambda _: None,
            arrivals=np.array([0.0, NAN]),
        )  # fmt: skip
        stopped = network._follow(run, 7.0, np.ones(2, dtype=bool), None)
        assert stopped is FrontStatus.PINNED
        assert asked[-1] == (7.0, pytest.approx(1e-3 * size))


def test_distances_in_a_network_are_in_links() -> None:
    links = SimpleNamespace(positions=None, distances=lambda sites: np.arange(5.0) + sites[0])
    chain: Any = SimpleNamespace(links=links, sites=5)
    assert network.distances_from(chain, 3).tolist() == [3.0, 4.0, 5.0, 6.0, 7.0]


@pytest.mark.parametrize("excited", [0, 9, 10])
def test_some_sites_of_a_lattice_are_excited_and_not_all(excited: int) -> None:
    lattice = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(3, 3)
    )
    with pytest.raises(ParameterError, match="excited sites"):
        network.spread(lattice, excited=excited, directions=4, tolerance=1e-8, stall=1.0)


def test_of_a_network_each_distance_in_links_counts_once() -> None:
    """By the mean of its sites, beyond the first and without the farthest four."""
    away = np.array([0.0, 1.0, 1.0, 2.0, 2.0, 2.0, *range(3, 20), math.inf])
    arrivals = np.array([0.0, 0.5, 0.5, 1.0, 1.25, NAN, *(0.5 * n for n in range(3, 20)), 3.0])
    assert [each.size for each in network._shells(away, np.full(24, NAN), 1.0)] == [0, 0]
    levels, times = network._shells(away, arrivals, 1.0)
    assert levels.tolist() == [2.0, *range(3, 16)]
    assert times.tolist() == [1.125, *(0.5 * n for n in range(3, 16))]
    chain: Any = SimpleNamespace(links=SimpleNamespace(positions=None))
    angles, v, error = network._fitted(
        chain, away, middle=0, arrivals=arrivals, directions=9, excited=3
    )
    assert (angles.tolist(), v.tolist()) == ([0.0], pytest.approx([2.0]))
    assert error == pytest.approx([0.0], abs=1e-12)


@pytest.mark.parametrize("excited", [9, 11])
def test_distances_in_links_are_used_from_the_first_beyond_the_excited_sites(excited: int) -> None:
    """On a ring, by numpy's line through the outer half of them; times are at random."""
    away = np.abs(np.arange(60.0) - 30.0)
    times = np.sort(np.random.default_rng(2).random(31))
    chain: Any = SimpleNamespace(links=SimpleNamespace(positions=None))
    _, v, _ = network._fitted(
        chain, away, middle=30, arrivals=times[away.astype(int)], directions=1, excited=excited
    )
    distances = np.arange((excited + 1) // 2, 31 - network.MEETING)
    outer = distances[distances.size // 2 :]
    assert v == pytest.approx([1.0 / np.polyfit(outer, times[outer], 1)[0]])


@pytest.mark.parametrize(("rows", "excited", "margin"), [(24, 3, 8), (24, 4, 8), (20, 4, 4),
                                                         (20, 6, 2)])  # fmt: skip
def test_a_planar_front_is_timed_from_the_row_beyond_the_excited_ones(
    monkeypatch: pytest.MonkeyPatch, rows: int, excited: int, margin: int
) -> None:
    """To eight rows before the far side, or as many as leave twelve, by numpy's line through the
    outer half; in its middle, at random times."""
    monkeypatch.setattr(network, "_measured", lambda _, __, ___, fit, **____: fit)
    random = np.random.default_rng(3)
    times = np.sort(random.random(rows))
    lattice = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(rows, 6)
    )
    fit: Any = network.planar(lattice, excited=excited, tolerance=1e-8, stall=1.0)
    timed = np.arange(excited, rows - margin)
    outer = timed[timed.size // 2 :]
    straight = fit(times.repeat(6))
    assert straight[1] == pytest.approx([1.0 / np.polyfit(outer, times[outer], 1)[0]])
    for first, last in ((0.4, 1.0), (1.0, 0.4)):  # two and a half times as fast at one side
        bent = np.stack([first * times, times, times, times, times, last * times], axis=1)
        _, v, error = fit(bent.ravel())
        assert v == straight[1]
        assert error == pytest.approx(np.maximum(straight[2], 1.5 * v))
    slower = np.stack([2.0 * times, times, times, times, times, times, 2.0 * times], axis=1)
    slower[:, [1, 5]] *= 3.0  # of seven columns the third to the fifth are the middle
    slower[:, 2:5] *= [1.5, 0.0, 1.5]
    odd = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(rows, 7)
    )
    fit = network.planar(odd, excited=excited, tolerance=1e-8, stall=1.0)
    assert fit(slower.ravel())[1] == pytest.approx(straight[1])


@pytest.mark.parametrize(
    ("excited", "words"),
    [(1, "at least 15 .* from 1 excited row; take more rows, or turn the lattice"),
     (4, "at least 18 .* from 4 excited rows; take more rows, or turn the lattice")],
)  # fmt: skip
def test_a_lattice_without_room_for_a_front_from_any_row_is_refused(
    excited: int, words: str
) -> None:
    """Twelve rows are timed, and two before the far side are not: of 14 rows none is left."""
    lattice = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(14, 6)
    )
    with pytest.raises(ParameterError, match=f"number of rows = 14 .* {words}.$"):
        network.planar(lattice, excited=excited, tolerance=1e-8, stall=1.0)


def test_sites_within_a_radius_of_some_three_and_a_half_are_excited_on_a_lattice(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By default; as many as points of a square lattice are within it."""
    lattice = OscillatorChain(
        damping="1 - 4*y**2 + 0.5*y**4", c=0.1, coupling="square", sites=(11, 11)
    )
    monkeypatch.setattr(network, "_measured", lambda _, start, *__, **___: start)
    start: Any = network.spread(lattice, directions=4, tolerance=1e-8, stall=1.0)
    excited = np.hypot(*start).reshape(11, 11) > lattice.unstable_amplitude
    row, column = np.indices((11, 11)) - 5
    assert np.array_equal(excited, np.hypot(row, column) < 3.5)


def test_a_velocity_and_its_error_scale_with_the_unit_of_time() -> None:
    rng = np.random.default_rng(1)
    distance = np.arange(40.0)
    times = distance + 0.2 * rng.random(40)
    assert velocity_of_arrivals(1e3 * times, distance) == pytest.approx(
        [1e-3 * each for each in velocity_of_arrivals(times, distance)], rel=1e-9
    )


def test_the_halves_of_a_slope_may_differ_to_either_side() -> None:
    distance = np.arange(40.0)
    bent = np.where(distance < 30.0, distance / 2.0, 15.0 + (distance - 30.0))
    faster = np.where(distance < 30.0, distance, 30.0 + (distance - 30.0) / 2.0)
    for times in (bent, faster):
        v, error = velocity_of_arrivals(times, distance)
        assert error >= 6.0 * 0.45 * v**2  # slopes of 1/2 and 1, whatever comes first
    rounded = 0.1 + 1e-17 * distance[::-1]
    for at_once in (np.zeros(40), np.full(40, 0.1), rounded):  # is no velocity
        assert velocity_of_arrivals(at_once, distance) == (math.inf, math.inf)
    least = np.arange(2.0 * network.LEAST)
    assert network._velocity(least, least)[0] == pytest.approx(1.0)
    assert math.isnan(network._velocity(least[:-1], least[:-1])[0])


def test_distances_in_links_at_which_only_corners_are_left_are_not_used() -> None:
    """Of a square of 61 sites a side: beyond 31 links, where a front would seem to be faster."""
    row, column = np.indices((61, 61)) - 30
    away = (np.abs(row) + np.abs(column)).ravel().astype(float)
    levels, times = network._shells(away, np.hypot(row, column).ravel(), 4.0)
    assert levels.tolist() == [*range(5, 32)]
    assert times[0] == pytest.approx(np.hypot([5, 4, 3], [0, 1, 2]) @ [4, 8, 8] / 20)


@pytest.mark.parametrize(("fullest", "last"), [(11, 16), (12, 12), (13, 13)])
def test_distances_beyond_the_fullest_one_are_left_out_if_twelve_remain(
    fullest: int, last: int
) -> None:
    """Of twenty distances, of which the farthest four are not used in any case."""
    away = np.append(np.arange(21.0), fullest)
    levels, _ = network._shells(away, away, 0.0)
    assert levels.tolist() == [*range(1, last + 1)]


class _Lattice:
    """Runs on a lattice that are made up: when each row or site is reached at each tolerance."""

    def __init__(self, *courses: Any, stopped: FrontStatus | None = None) -> None:
        self.courses, self.stopped = iter(courses), stopped

    def run(self, *_: Any, **__: Any) -> Any:
        return SimpleNamespace(arrivals=next(self.courses), counts={"steps": 5})

    def follow(self, run: Any, _: float, within_reach: Any, __: Any) -> FrontStatus | None:
        assert within_reach.all()
        return self.stopped if run.arrivals is not None else FrontStatus.PINNED

    def put(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(network, "SmoothIntegration", self.run)
        monkeypatch.setattr(network, "_follow", self.follow)


def test_a_planar_front_is_as_sure_as_its_run_at_a_coarser_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain = _lattice(30, 3)
    chain.front_phase_step = -1
    row = np.arange(90) // 3
    fine, coarse = row / 2.0, row / 2.5
    for each in (fine, coarse):
        each[row < 4] = 0.0
        each[row >= 28] = 99.0  # faster, or slower, at the side
    turned: list[Any] = []

    def excite(_: object, sites: Any, quarter_turns: Any) -> str:
        turned.extend([sites, quarter_turns])
        return "start"

    monkeypatch.setattr(network, "excite", excite)
    for courses, stopped, apart in (
        ((fine, coarse), None, 3.0 * 0.5),
        ((coarse, fine), None, 3.0 * 0.5),
        ((fine, None), None, 2.0),  # the other one stopped: nothing is known of v
        ((fine, None), FrontStatus.CREEPING, 0.0),  # and was not run
    ):
        _Lattice(*courses, stopped=stopped).put(monkeypatch)
        found = network.planar(chain, tolerance=1e-8, stall=1.0)
        assert found.spread.velocities == pytest.approx(
            2.0 * (2.5 if courses[0] is coarse else 2.0)
        )
        assert found.spread.errors == pytest.approx([2.0 * apart], abs=1e-12)
        assert found.spread.angles.tolist() == [0.5 * math.pi]
        assert found.spread.arrivals is not courses[0]
        assert found.spread.arrivals.tolist() == courses[0].tolist()
        assert (found.steps, found.stopped) == (10 if stopped is None else 5, stopped)
    assert turned[:2] == [[*range(1, 13)], [0, 0, 0, -1, -1, -1, -2, -2, -2, -3, -3, -3]]


def test_a_motion_from_the_middle_is_as_sure_as_its_run_at_a_coarser_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain = _lattice(41, 41)
    chain.front_phase_step = -1
    away = network.distances_from(chain, network.middle_site(chain))
    fine, coarse = away / 2.0, away / 2.5
    monkeypatch.setattr(network, "excite", lambda *_, **__: "start")
    for courses, v in (((fine, coarse), 2.0), ((coarse, fine), 2.5)):
        _Lattice(*courses).put(monkeypatch)
        found = network.spread(chain, directions=4, tolerance=1e-8, stall=1.0).spread
        # Twice as much in slow time; sites beside a ray are farther than along it.
        assert found.velocities == pytest.approx([2.0 * v] * 4, rel=0.02)
        assert found.errors == pytest.approx([3.0 * 2.0 * 0.5] * 4, rel=0.05)


@pytest.mark.parametrize(
    ("ends", "stopped", "steps", "compared"),
    [
        ([None, None], None, 12, True),
        ([None, FrontStatus.PINNED], None, 12, False),
        ([FrontStatus.PINNED], FrontStatus.PINNED, 5, False),
    ],
)
def test_what_becomes_of_a_motion_is_said_by_its_run_at_the_tolerance_asked(
    ends: list[Any], stopped: Any, steps: int, compared: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a lattice and along a chain; that at the coarser tolerance is there to be compared."""
    asked: list[float] = []
    start = np.zeros((2, 40))

    def begun(*given: Any, tolerance: float) -> Any:
        assert not given or (given[0] is chain and given[1] is start)
        asked.append(tolerance)
        return SimpleNamespace(
            counts={"steps": 3 + 2 * len(asked)}, state=np.zeros((2, 40)),
            arrivals=np.arange(40.0),
        )  # fmt: skip

    left = itertools.cycle(ends)
    monkeypatch.setattr(network, "SmoothIntegration", begun)
    monkeypatch.setattr(network, "_follow", lambda *_: next(left))
    # Equal velocities are known to a quarter of the tolerance, but not at all if the last site, at
    # 39, is reached within the relaxation time.
    known = 0.25 * 1e-8 if compared else 1.0
    for relaxation_time, error in ((39.1, math.inf), (39.0, known)):
        asked.clear()
        chain: Any = SimpleNamespace(
            time_unit=1.0, links=SimpleNamespace(positions=None), relaxation_time=relaxation_time
        )
        found = network._measured(
            chain, start, np.zeros(1), lambda _: (np.zeros(1), np.ones(1), np.zeros(1)),
            tolerance=1e-8, stall=1.0, progress=None,
        )  # fmt: skip
        assert (found.stopped, found.steps) == (stopped, steps)
        assert found.spread.errors == pytest.approx(0.0 if stopped else error)
    assert asked == pytest.approx([1e-8, 1e-6][: len(ends)])
    asked.clear()
    monkeypatch.setattr(preparation, "follow", lambda *_, **__: next(left))
    trial = prepared(lambda each: begun(tolerance=each)).trial(40, None)
    assert (trial.stopped, trial.counts["steps"], trial.coarser.size) == (
        stopped,
        steps,
        27 * compared,
    )
    assert trial.arrivals.tolist() == [*range(5, 32)]


def test_a_lattice_is_run_until_all_sites_in_reach_are_reached_or_none_is_for_long() -> None:
    class Made:
        chain = SimpleNamespace(stable_amplitude=2.0)
        amplitude = np.ones(4)

        def __init__(self, reached: list[int]) -> None:
            self.reached, self.time, self.arrivals = iter(reached), 0.0, np.full(4, NAN)

        def advance(self, _: int) -> None:
            self.time += 6.0
            self.arrivals[: next(self.reached)] = 1.0

        def going_to_rest(self) -> bool:
            return False

    seen: list[float] = []
    reach = np.array([True, True, True, False])
    for reached, status in (
        ([1, 2, 3], None),
        ([1, 2, 2, 2, 2, 2], FrontStatus.PINNED),
    ):
        made: Any = Made(reached)
        assert network._follow(made, 10.0, reach, seen.append) is status
    assert seen == [0.25, 0.5, 0.25, *[0.5] * 5]


# -------------------------------------------------------------------------------- thresholds


def _crossing(c: float, *, from_start: bool = False) -> Crossing:
    return Crossing(c, 1e-6, np.zeros(1), from_start)


def test_what_is_never_stable_is_stable_up_to_nowhere() -> None:
    fold = fold_of(0.19, 0.0, np.zeros(1))
    to = continuation._stable_to
    assert (to(None, fold), to(None, None)) == (0.19, None)
    assert (to(_crossing(0.1), fold), to(_crossing(0.1, from_start=True), fold)) == (0.1, None)


class _Growth:
    """Solutions u = c whose growth is rate (c - at) near ``at``; half the steps change ``at``."""

    def __init__(self, at: float, finer: float, rate: float = 0.5) -> None:
        self.at, self.steps, self.slope = at, finer, rate

    def finer(self) -> Any:
        return _Growth(self.steps, self.steps, self.slope)

    def system(self) -> Any:
        return lambda u, c: (u - c, np.eye(1), -np.ones(1))

    def stability(self, u: Any, c: float, *, split: bool) -> Any:
        return SimpleNamespace(marginal=1e-7)

    def monitor(self, u: Any, c: float) -> tuple[float]:
        off = u[0] - self.at
        return (self.slope * off * (1.0 + (off / 1e-4) ** 4) - 1e-7,)


@pytest.mark.parametrize("shift", [0.0, 3e-5, -3e-5])
def test_the_error_of_a_loss_of_stability_is_that_of_its_growth_over_its_rate(shift: float) -> None:
    """What counts as zero is added to the growth, so that it is found late; and the steps err."""
    family: Any = _Growth(0.17, 0.17 + shift)
    found = Crossing(0.17 + 2e-7, 1e-12, np.array([0.17 + 2e-7]), from_start=False)
    error = continuation._crossing_error(family, found)
    assert abs(found.parameter - family.steps) <= error < 3.0 * (abs(shift) + 4e-7)
    less_exact = continuation._crossing_error(family, replace(found, error=1e-5))
    assert less_exact - error == pytest.approx(1e-5, rel=1e-6)
    falls: Any = _Growth(0.17, 0.17, -0.5)
    assert continuation._crossing_error(falls, found) == found.parameter


@pytest.mark.parametrize("longer", [None, 0.07, 0.071])
def test_the_error_of_a_loss_of_stability_has_what_a_longer_chain_changes_in_it(
    longer: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And not what it changes in the fold; all of it where the longer chain is never stable."""
    crossings = [
        _crossing(0.07), _crossing(0.01, from_start=True) if longer is None else _crossing(longer),
        None,
    ]  # fmt: skip
    monkeypatch.setattr(continuation, "first_crossing", lambda *given: crossings.pop(0))
    monkeypatch.setattr(continuation, "_crossing_error", lambda *given: 1e-6)
    monkeypatch.setattr(continuation, "_mechanism", lambda *given: Mechanism.REAL_EXPONENT)
    found = continuation.breather_threshold(
        AVERAGED.replace(sites=9), Nucleus(1), margin=2, method=ThresholdMethod.ENVELOPE
    )
    assert found.stable_to == 0.07
    apart = abs(0.07 - (longer or 0.0))
    assert found.stable_to_error == pytest.approx(1e-6 + 2.0 * apart, abs=1e-15)


def test_a_search_along_a_branch_reports_how_far_it_is() -> None:
    parts: list[float] = []
    found = thresholds.threshold(AVERAGED.replace(sites=9), Nucleus(1), progress=parts.append)
    assert found.method is ThresholdMethod.ENVELOPE
    assert len(parts) > 10
    assert parts == sorted(parts)
    assert 0.0 < parts[0] < 0.1
    assert 0.5 < parts[-1] < 1.0


@pytest.mark.parametrize("change", [None, 1e-3, -1e-3])
def test_a_threshold_errs_by_what_a_longer_chain_changes_or_by_itself_without_a_fold_there(
    change: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[int] = []
    family = continuation.own_family
    own = family(AVERAGED.replace(sites=3), Nucleus(1)).branch(monitored=False).fold
    assert own is not None
    there = None if change is None else fold_of(own.parameter + change, 0.0, np.zeros(1))

    def of(chain: Any, nucleus: Nucleus) -> Any:
        made.append(chain.sites)
        longer: Any = SimpleNamespace(
            branch=lambda **_: SimpleNamespace(fold=there, points=[], monitored=[]),
            system=lambda: None, reported_monitor=lambda _: lambda *_: (-1.0,),
        )  # fmt: skip
        return family(chain, nucleus) if len(made) == 1 else longer

    monkeypatch.setattr(continuation, "own_family", of)
    found = continuation.breather_threshold(
        AVERAGED.replace(sites=9), Nucleus(1), margin=1, method=ThresholdMethod.ENVELOPE
    )
    assert made == [3, 9]
    assert found.error == pytest.approx(2.0 * abs(change or found.c_crit), rel=1e-6)


def test_a_breather_that_loses_no_stability_is_stable_up_to_its_fold_within_errors_of_both(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The fold errs by its own error and by what a longer chain changes, here 0.01."""
    families: list[Any] = []

    def of(chain: Any, _: Nucleus) -> Any:
        fold = SimpleNamespace(parameter=0.25 if families else 0.26)
        families.append(SimpleNamespace(
            chain=chain, system=lambda: None, fold_error=lambda _: 2e-4,
            branch=lambda **_: SimpleNamespace(fold=fold), reported_monitor=lambda _: None,
        ))  # fmt: skip
        return families[-1]

    monkeypatch.setattr(continuation, "own_family", of)
    monkeypatch.setattr(continuation, "first_crossing", lambda *_: None)
    for own, error, stated in ((None, math.inf, (None, None)), (-0.75, 1e-5, (-0.75, 1e-5))):
        there = SimpleNamespace(
            growth=-0.5, growth_error=1e-6, symmetric=own, symmetric_error=error
        )  # fmt: skip
        families.clear()
        monkeypatch.setattr(continuation, "_half_way", lambda *_, there=there: there)
        found = continuation.breather_threshold(
            AVERAGED.replace(sites=9), Nucleus(1), ThresholdMethod.ENVELOPE, margin=1
        )
        assert [each.chain.sites for each in families] == [3, 9]
        assert (found.c_crit, found.stable_to, found.lost_by) == (0.26, 0.26, Mechanism.FOLD)
        assert found.error == pytest.approx(2e-4 + 2.0 * 0.01)
        assert found.stable_to_error == pytest.approx(2e-4 + 4.0 * 0.01)
        assert (found.growth_half_way, found.growth_half_way_error) == (-0.5, 1e-6)
        # Without modes of its own parity the error of their growth is given as infinite.
        assert (found.growth_half_way_mirrored, found.growth_half_way_mirrored_error) == stated


def test_what_is_not_split_by_parity_has_no_growth_of_its_own_parity(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As a nucleus at an edge, or one of a chain whose sites may differ, which has a mirror image.

    The error of a growth that there is not is given as infinite.
    """
    for own, error, stated in ((None, math.inf, (None, None)), (-0.25, 1e-3, (-0.25, 1e-3))):
        there = SimpleNamespace(
            growth=0.5, growth_error=1e-6, symmetric=own, symmetric_error=error
        )  # fmt: skip
        monkeypatch.setattr(continuation, "_half_way", lambda *_, there=there: there)
        found = continuation.breather_threshold(
            AVERAGED.replace(sites=3), Nucleus(1), ThresholdMethod.ENVELOPE
        )
        assert (found.growth_half_way, found.growth_half_way_error) == (0.5, 1e-6)
        assert (found.growth_half_way_mirrored, found.growth_half_way_mirrored_error) == stated


@pytest.mark.parametrize(
    ("chain", "nucleus", "method", "kind", "sites"),
    [
        (VdpChain(a=2.5, b=0.5, c=0.1, sites=99), Nucleus(3, "--"), "envelope", AveragedChain, 13),
        (AveragedChain(a=2.5, b=0.5, c=0.1, sites=99), Nucleus(1), "orbit", VdpChain, 11),
        (VdpChain(a=2.5, b=0.5, c=0.1, sites=9), Nucleus(1), "orbit", VdpChain, 9),
        (
            VdpChain(a=2.5, b=0.5, c=0.1, sites=99),
            Nucleus(2, "0", Place.EDGE),
            "envelope",
            AveragedChain,
            7,
        ),
        (OscillatorChain(damping="y**2 - 1", c=0.1, sites=99), Nucleus(1, place=Place.EDGE),
         "orbit", OscillatorChain, 6),
    ],
)  # fmt: skip
def test_of_a_chain_the_nucleus_is_solved_for_with_five_sites_beside_it(
    chain: Any, nucleus: Nucleus, method: str, kind: type, sites: int
) -> None:
    """On either side in the bulk, on one side at an edge, and fewer where there are no more."""
    here = continuation._sized(chain, nucleus, ThresholdMethod(method), 5)
    assert (type(here), here.sites, here.ends) == (kind, sites, chain.ends)


@pytest.mark.parametrize(
    ("own", "turns", "mirrored", "mechanism"),
    [
        (None, 0.0, True, Mechanism.SYMMETRY_BREAKING),
        (0.18, 0.0, True, Mechanism.SYMMETRY_BREAKING),
        (0.17, 0.0, True, Mechanism.REAL_EXPONENT),  # a mode of its own parity is the first
        (0.17, 0.5, True, Mechanism.COMPLEX_EXPONENTS),
        (0.18, 0.0, False, Mechanism.REAL_EXPONENT),
        (0.18, 2e-6, False, Mechanism.COMPLEX_EXPONENTS),
        (0.18, 0.5e-6, False, Mechanism.REAL_EXPONENT),
    ],
)
def test_how_stability_is_lost_is_read_from_who_crosses_first(
    own: float | None, turns: float, mirrored: bool, mechanism: Mechanism,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    def first(_: object, __: object, ___: object, entry: int) -> Crossing | None:
        return None if own is None or entry != 1 else _crossing(own)

    def stability(u: Any, c: float, **_: Any) -> Any:
        assert (u.tolist(), c) == ([0.0], 0.17)
        return SimpleNamespace(frequency=turns)

    monkeypatch.setattr(continuation, "first_crossing", first)
    family: Any = SimpleNamespace(
        nucleus=SimpleNamespace(mirrored=lambda _: mirrored), chain=AVERAGED, system=lambda: None,
        monitor=None, stability=stability,
    )  # fmt: skip
    made: Any = None
    assert continuation._mechanism(_crossing(0.17), family, made) is mechanism
    assert continuation._mechanism(None, family, made) is Mechanism.FOLD
    never = _crossing(0.01, from_start=True)
    assert continuation._mechanism(never, family, made) is Mechanism.NEVER_STABLE


def test_runs_of_43_have_the_noise_and_the_seed_that_are_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for how, name in (
        (ThresholdMethod.HOLD, "escape_range"),
        (ThresholdMethod.SWEEP, "sweep_threshold"),
    ):
        monkeypatch.setattr(thresholds, name, lambda chain, made: made)
        made: Any = thresholds.threshold(
            AVERAGED, Nucleus(1), method=how, perturbation=0.05, seed=7
        )
        assert (made.perturbation, made.seed, made.size) == (0.05, 7, 1)
    assert made.chain(AVERAGED, 0.1) == AVERAGED.replace(c=0.1, sites=1 + 2 * MARGIN)
    chain = AVERAGED.replace(sites=2001)
    noise = made.start(chain) - replace(made, perturbation=0.0).start(chain)
    assert np.cov(noise.real, noise.imag) / 0.05**2 == pytest.approx(np.eye(2), abs=0.15)


def _made_up_holds(
    monkeypatch: pytest.MonkeyPatch, highest: float, share: Callable[[float], float]
) -> list[float]:
    """Let runs escape above a coupling, after a share of their time; return the couplings tried."""
    tried: list[float] = []

    def hold(chain: object, preparation: object, c: float, duration: float) -> Any:
        assert chain is AVERAGED
        assert isinstance(preparation, escape.NucleusPreparation)
        tried.append(c)
        return SimpleNamespace(escaped=c > highest, time=share(c) * duration)

    monkeypatch.setattr(escape, "hold", hold)
    return tried


def test_the_range_of_escape_is_looked_for_downwards_and_upwards(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From 0.2 by a fifth down until it holds, by a quarter up until it escapes soon."""
    tried = _made_up_holds(monkeypatch, 0.12, lambda c: 0.75 if c < 0.3 else 0.5)
    runs = escape._EscapeRuns(AVERAGED, escape.NucleusPreparation(1), 100.0)
    runs.bracket()
    assert tried == pytest.approx([0.2, 0.16, 0.128, 0.1024, 0.25, 0.3125])
    assert runs.ends() == (
        (pytest.approx(0.1024), pytest.approx(0.128)), (0.25, 0.3125)
    )  # fmt: skip


def test_runs_are_made_up_to_a_hundredth_beyond_the_range_of_escape(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried = _made_up_holds(monkeypatch, 0.19, lambda _: 0.25)
    found = escape.escape_range(AVERAGED, escape.NucleusPreparation(1), 100.0, 1e-5)
    assert found.c_crit == pytest.approx(0.19, abs=1e-5)
    near = np.sort([c for c in tried if abs(c / 0.19 - 1.0) < 0.0101])
    assert (near[0] / 0.19, near[-1] / 0.19) == pytest.approx((0.99, 1.01), abs=2e-3)
    assert np.diff(near).max() <= 0.19 * 0.01 / 8 * 1.001
    assert found.runs == len(set(tried)) == len(tried)


def test_a_loss_of_stability_is_told_from_a_fold_beyond_the_errors_of_both() -> None:
    family: Any = SimpleNamespace(fold_error=lambda _: 0.25)
    fold: Any = SimpleNamespace(parameter=2.0)
    for c, told in ((1.375, True), (1.625, False), (1.9, False)):
        crossing = Crossing(c, 0.25, np.zeros(1), from_start=False)
        assert (continuation._before(family, fold, crossing) is crossing) is told


@pytest.mark.parametrize("begins", [1.2, 1.6999])
def test_the_growth_half_way_is_solved_for_where_the_branch_begins_above_half_its_fold(
    begins: float,
) -> None:
    """On u² + (c - 1)² = 0.49, whose fold at c = 1.7 is followed from below it: u² = 0.4675."""

    def circle(u: Any, c: float) -> tuple[Any, Any, Any]:
        return u**2 + (c - 1.0) ** 2 - 0.49, np.diag(2.0 * u), np.array([2.0 * (c - 1.0)])

    branch = trace(circle, solve_at(circle, np.array([0.6]), begins), 5.0)
    family: Any = SimpleNamespace(
        system=lambda: circle, measured=lambda point, _: SimpleNamespace(stability=point)
    )
    found = continuation._half_way(family, branch, 0.0)
    assert found.parameter == pytest.approx(0.85, abs=1e-10)
    assert found.u == pytest.approx([math.sqrt(0.4675)], abs=1e-10)


def test_the_growth_half_way_is_that_of_the_branch_where_this_passes_half_its_fold() -> None:
    """On sin²u + (c - 1)² = 0.49; Newton's method leads from the first point to another branch."""

    def waves(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.sin(u) ** 2 + (c - 1.0) ** 2 - 0.49
        return value, np.diag(np.sin(2.0 * u)), np.array([2.0 * (c - 1.0)])

    branch = trace(waves, solve_at(waves, np.array([0.1]), 0.31), 5.0)
    assert solve_at(waves, branch.points[0].u, 0.85).u > 1.0
    family: Any = SimpleNamespace(
        system=lambda: waves, measured=lambda point, _: SimpleNamespace(stability=point)
    )
    found = continuation._half_way(family, branch, 0.0)
    assert found.parameter == pytest.approx(0.85, abs=1e-10)
    assert found.u == pytest.approx([math.asin(math.sqrt(0.4675))], abs=1e-10)


def test_no_front_within_the_errors_of_its_fold_is_faster_than_the_fastest() -> None:
    """v = K√(c - c_pin), with the largest K and the smallest c_pin."""
    fold = resting.StaticFold(
        c=0.1, error=0.01, square_root=2.0, square_root_error=0.5, slope=1.0, slope_error=0.0,
        r=np.zeros(0),
    )  # fmt: skip
    for c in (0.05, 0.095, 0.1, 0.2):
        fastest = max(
            (2.0 + k) * math.sqrt(max(0.0, c - 0.1 + e)) for k in (-0.5, 0.5) for e in (-0.01, 0.01)
        )
        assert fold.fastest(c) == pytest.approx(fastest, rel=1e-12)


def test_the_error_of_a_range_reaches_to_escapes_within_twice_the_duration(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And to at most twice their distance, since distances are doubled; later ones do not count."""
    tolerance, duration, beyond = 1e-5, 100.0, 5e-4

    def hold(_: object, __: object, c: float, length: float) -> Any:
        after = 0.25 if c > 0.2 else 1.5 if c > 0.2 - beyond else 3.0 if c > 0.198 else math.inf
        return SimpleNamespace(escaped=after * duration <= length, time=after * duration)

    monkeypatch.setattr(escape, "hold", hold)
    found = escape.escape_range(AVERAGED, escape.NucleusPreparation(1), duration, tolerance)
    assert beyond <= 0.2 - (found.c_crit - found.error) < 2.0 * beyond + tolerance


def test_longer_runs_are_made_below_a_wide_range_of_escape(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Escapes take most of the duration between 0.19 and 0.1905."""
    tolerance, duration = 1e-5, 100.0
    longer: list[float] = []

    def hold(_: object, __: object, c: float, length: float) -> Any:
        if length > duration:
            longer.append(c)
        after = 0.25 if c > 0.1905 else 0.75 if c > 0.19 else math.inf
        return SimpleNamespace(escaped=after * duration <= length, time=after * duration)

    monkeypatch.setattr(escape, "hold", hold)
    escape.escape_range(AVERAGED, escape.NucleusPreparation(1), duration, tolerance)
    assert tolerance <= 0.19 - longer[0] <= 2.0 * tolerance
    assert np.diff(longer) == pytest.approx(-tolerance * 2.0 ** np.arange(len(longer) - 1))


@pytest.mark.parametrize(
    "escape_after", [lambda _: math.inf, lambda _: 0.1, lambda c: 0.75 if c > 0.1 else math.inf]
)
def test_a_nucleus_that_always_holds_or_always_escapes_or_never_soon_is_refused(
    escape_after: Callable[[float], float], monkeypatch: pytest.MonkeyPatch
) -> None:
    def hold(_: object, __: object, c: float, duration: float) -> Any:
        share = escape_after(c)
        return SimpleNamespace(escaped=share < math.inf, time=share * duration)

    monkeypatch.setattr(escape, "hold", hold)
    allowed = r"one that holds at some c from 0\.001 and escapes at some up to 2; take another size"
    with pytest.raises(ParameterError, match=allowed) as refusal:
        escape._EscapeRuns(AVERAGED, escape.NucleusPreparation(3), 100.0).bracket()
    assert (refusal.value.quantity, refusal.value.value) == ("nucleus", 3)
    with pytest.raises(ParameterError, match="tolerance"):
        escape.escape_range(AVERAGED, escape.NucleusPreparation(3), tolerance=0.0)


def test_escapes_are_monotone_where_none_lies_below_a_run_that_held() -> None:
    for escapes, monotone in (
        ({0.1: math.inf, 0.2: 10.0, 0.3: 5.0}, True),
        ({0.1: math.inf, 0.2: 10.0, 0.3: math.inf, 0.4: 5.0}, False),
    ):
        runs = escape._EscapeRuns(AVERAGED, escape.NucleusPreparation(1), 100.0, escapes)
        assert runs.monotone() is monotone


def test_an_escape_apart_that_only_a_run_around_the_range_shows_is_bisected_as_well(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Escapes from 0.19 on, and between 0.1885 and 0.189, about a run made beside the range."""
    apart, tolerance = 0.1885, 1e-6

    def hold(_: object, __: object, c: float, duration: float) -> Any:
        return SimpleNamespace(escaped=c > 0.19 or apart < c < 0.189, time=0.25 * duration)

    monkeypatch.setattr(escape, "hold", hold)
    found = escape.escape_range(AVERAGED, escape.NucleusPreparation(1), 100.0, tolerance)
    assert not found.monotone
    pad = 0.25 * (found.high - found.low)  # half of the width is added on either side
    assert apart - tolerance <= found.low + pad <= apart
    assert 0.19 <= found.high - pad <= 0.19 + tolerance


def test_every_run_of_a_bisection_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    made = _made_up_holds(monkeypatch, 0.19, lambda _: 0.25)
    found = escape.escape_threshold(AVERAGED, escape.NucleusPreparation(1), tolerance=1e-3)
    assert found.runs == len(made)


def test_a_fuzzy_interval_is_as_wide_as_it_is() -> None:
    given: dict[str, Any] = {
        "c_crit": 0.5, "error": 0.1, "method": ThresholdMethod.BISECTION, "definition": "first",
        "mechanism": Mechanism.SPREADING, "model": "vdp", "nucleus": Nucleus(1), "seconds": 0.0,
        "low": 0.4, "high": 0.6, "final_time": 1.0, "runs": 3,
    }  # fmt: skip
    assert RunThreshold(**given).fuzzy_width == 0.0
    assert RunThreshold(**given, fuzzy=(0.25, 0.75)).fuzzy_width == 0.5


def test_what_is_not_tested_of_a_threshold_is_not_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither that spreading is monotone, nor that more time changes nothing."""
    made: list[float] = []

    def spreads(chain: Any, *_: object) -> bool:
        made.append(chain.c)
        return bool(chain.c > 0.0314)

    monkeypatch.setattr(spreading, "spreads", spreads)
    chain = VdpChain(a=4, b=0.5, c=0.1)
    found = spreading.spreading_threshold(chain, Spreading(), accuracy=1e-4, tests=0, lowest=1e-3)
    assert (found.monotone, found.c_crit_at_twice_the_time, found.fuzzy) == (None, None, None)
    assert found.runs == len(made)
    # Each coupling is tried once, but the ends of the bracket: at the finer tolerance as well.
    assert sorted(c for c in {*made} if made.count(c) > 1) == [found.low, found.high]
    made.clear()
    tested = spreading.spreading_threshold(chain, Spreading(), accuracy=1e-4, tests=4, lowest=1e-3)
    assert (tested.monotone, tested.c_crit_at_twice_the_time) == (True, tested.c_crit)
    share = np.array([0.05, -0.05, 0.1, -0.1, 0.15, -0.15, 0.2, -0.2])
    assert sorted(made[-8:]) == pytest.approx(sorted(tested.c_crit * (1.0 + share)))
    assert tested.runs == len(made)
    once = spreading.spreading_threshold(chain, Spreading(), accuracy=1e-4, tests=1, lowest=1e-3)
    assert (once.monotone, once.c_crit_at_twice_the_time) == (True, once.c_crit)


@pytest.mark.parametrize("tests", [0, 4])
def test_a_search_tells_after_each_run_what_part_is_done(
    tests: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(spreading, "spreads", lambda chain, *_: chain.c > 0.0314)
    seen: list[float] = []
    found = spreading.spreading_threshold(
        VdpChain(a=4, b=0.5, c=0.1),
        Spreading(),
        accuracy=1e-4,
        tests=tests,
        progress=seen.append,
        lowest=1e-3,
    )
    assert len(seen) == found.runs
    assert all(0.0 < part < 1.0 for part in seen)
    assert seen == sorted(seen)
    assert seen[0] == pytest.approx(1.0 / (1.0 + math.log(500.0, 1.25) + 2.0 * tests))
    assert seen[-1] > 0.4


def test_a_search_tells_while_a_run_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """One run can take minutes, where eps is small."""
    monkeypatch.setattr(spreading, "_BUDGET", 500)
    seen: list[float] = []
    chain = VdpChain(a=4, b=0.5, c=0.0, sites=5)
    assert not spreading.spreads(chain, Spreading(), 5.0, seen.append)
    assert len(seen) > 3
    assert seen == sorted(seen)
    assert 0.0 < seen[0] < seen[-1] == 1.0


@pytest.mark.parametrize(
    ("chain", "displacement", "point"),
    [
        (VdpChain(a=4, b=0.5, c=0.1), None, None),
        (VdpChain(a=4, b=0.5, c=0.1), 2.0, None),
        (FrictionChain(c=0.1), None, StartPoint.MINIMUM),
        (FrictionChain(c=0.1), 2.0, None),
    ],
)
def test_a_threshold_names_the_point_of_the_cycle_that_its_sites_start_from(
    chain: Any, displacement: float | None, point: StartPoint, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(spreading, "spreads", lambda chain, *_: chain.c > 0.0314)
    asked = Spreading(displacement=displacement, point=StartPoint.MINIMUM)
    found = spreading.spreading_threshold(chain, asked, accuracy=1e-3, tests=0, lowest=1e-3)
    assert found.start_point is point


def test_what_is_usual_of_a_threshold() -> None:
    """Numbers that users rely on where they say nothing; `threshold` passes them on."""
    usual = {
        "final_time": 1000.0, "lowest": 1e-3, "highest": 0.5, "accuracy": 1e-6, "tests": 12,
        "perturbation": 0.0, "seed": 0,
    }  # fmt: skip
    whole = inspect.signature(thresholds.threshold).parameters
    assert {name: whole[name].default for name in usual} == usual
    search = inspect.signature(spreading.spreading_threshold).parameters
    assert search["highest"].default == usual["highest"]
    assert Spreading().final_time == usual["final_time"]
    held = inspect.signature(escape.escape_range).parameters
    assert (held["duration"].default, held["tolerance"].default) == (2000.0, 1e-5)


def test_a_threshold_is_refused_where_it_could_not_be_compared_with_a_finer_one() -> None:
    """A run at 1e-12 has no finer one; at 1e-10 it has, with a hundredth of the tolerance."""
    assert Spreading(tolerance=1e-12).tolerance == 1e-12
    with pytest.raises(ParameterError, match="tolerance") as refusal:
        spreading.spreading_threshold(
            AVERAGED, Spreading(tolerance=9e-11), accuracy=1e-6, lowest=1e-3, tests=12
        )
    assert refusal.value.allowed.endswith(str(Range(1e-10, 1e-4)))


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_a_threshold_is_compared_with_that_at_a_hundredth_of_the_tolerance(
    tolerance: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[tuple[float, float]] = []

    def spreads(chain: Any, how: Spreading, final: float, *_: object) -> bool:
        made.append((how.tolerance, final))
        return bool(chain.c > 0.15)

    monkeypatch.setattr(spreading, "spreads", spreads)
    search = spreading._Search(AVERAGED, Spreading(tolerance=tolerance), 1e-4, 0.1, 0.2)
    assert search.spreads(0.2, longer=2.0)
    assert search.effect_of_tolerance(0.14, 0.16) == 0.0
    assert made[0] == (tolerance, 2000.0)
    assert made[1:] == [(pytest.approx(0.01 * tolerance), 1000.0)] * 2


def test_the_progress_of_a_search_grows_within_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[float] = []

    def spreads(_: object, __: object, ___: float, report: Any) -> bool:
        report(0.25)
        report(0.75)
        return True

    monkeypatch.setattr(spreading, "spreads", spreads)
    search = spreading._Search(AVERAGED, Spreading(), 1e-4, 0.1, 0.2)
    search.expect(3, told.append)
    search.spreads(0.1)
    search.spreads(0.1)
    assert told == sorted({*told})
    assert 0.0 < told[0] < told[-1] < 1.0


def test_a_bracket_ends_between_neighbouring_numbers_and_a_search_at_its_highest_coupling(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Doubles are 6e-11 apart there, farther than the accuracy that is asked for."""
    monkeypatch.setattr(spreading, "spreads", lambda chain, *_: chain.c > 314159.26)
    low, high = spreading._Search(AVERAGED, Spreading(), 1e-12, 1e5, 1e6).bracket()
    assert low <= 314159.26 < high == np.nextafter(low, 1e6)
    with pytest.raises(ParameterError, match="highest coupling = 300000"):
        spreading._Search(AVERAGED, Spreading(), 1e-12, 1e5, 3e5).bracket()


def test_the_widest_nucleus_whose_breather_is_followed_has_41_sites(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(thresholds, "breather_threshold", lambda *given, **_: given[1].size)
    chain = AVERAGED.replace(sites=61)
    found: Any = thresholds.threshold(chain, Nucleus(41, "0" * 40))
    assert found == 41
    with pytest.raises(ParameterError, match=r"nucleus = 42 .* at most 41 sites"):
        thresholds.threshold(chain, Nucleus(42, "0" * 41))


def test_several_sites_to_be_reached_are_three_on_each_side() -> None:
    several = Spreading(2, Place.BULK, Definition.SEVERAL)
    assert several.watched(12) == (3, 4, 5, 8, 9, 10)


@pytest.mark.parametrize("steps", [(0.0, 1.0, 0.0), (1.0, 0.0, 1.0)])
def test_the_limit_of_sweeps_errs_by_the_step_within_which_each_escape_is_noticed(
    steps: tuple[float, ...],
) -> None:
    """Escapes are those of the law, each as late as it may be; the weights alternate in sign.

    With a suitable linear term the two extrapolations of the law agree: the error is that alone.
    """
    speed = np.array(slow_sweep.RATES[-3:])
    late = np.array(steps) * speed * slow_sweep.STEP
    found = slow_sweep._extrapolated(speed, 0.2 + 0.5 * speed ** (2.0 / 3.0) + late)
    assert abs(found[0] - 0.2) <= found[1] * (1.0 + 1e-9)

    def apart(linear: float) -> float:
        escapes = 0.2 + 0.5 * speed ** (2.0 / 3.0) + linear * speed + late
        three = np.column_stack([np.ones(3), speed ** (2.0 / 3.0), speed])
        limit = np.linalg.solve(three[1:, :2], escapes[1:])[0]
        return float(np.linalg.solve(three, escapes)[0] - limit)

    linear = apart(0.0) / (apart(0.0) - apart(1.0))
    escapes = 0.2 + 0.5 * speed ** (2.0 / 3.0) + linear * speed + late
    c_0, error = slow_sweep._extrapolated(speed, escapes)
    assert error == pytest.approx(abs(c_0 - 0.2), rel=1e-6)


def test_the_limit_of_sweeps_errs_by_the_next_term_of_the_law() -> None:
    """It is of order rate^{4/3}; beside it the step within which escapes are noticed is small."""
    speed = np.array(slow_sweep.RATES)
    escapes = 0.2 + 50.0 * speed ** (2.0 / 3.0) + 300.0 * speed + 2e3 * speed ** (4.0 / 3.0)
    c_0, error = slow_sweep._extrapolated(speed, escapes)
    assert 100.0 * slow_sweep.STEP * speed[-3] < abs(c_0 - 0.2) <= error


def test_sweeps_and_runs_begin_where_a_nucleus_is_excited_though_it_may_die_above() -> None:
    """Near η = 1/8 it goes to rest at higher couplings, and does not escape there."""
    prepared = escape.NucleusPreparation(1)
    chain = AveragedChain(a=1.0, b=0.115, c=0.0)
    here, phi = slow_sweep._settled(chain, prepared)
    assert np.abs(phi).max() > here.unstable_amplitude
    dead = escape.hold(chain, prepared, 0.24, slow_sweep.SETTLING)
    assert np.abs(dead.phi).max() < 1e-9
    assert not dead.escaped
    chain = chain.replace(b=0.098)
    fold = continuation.breather_threshold(chain, Nucleus(1), ThresholdMethod.ENVELOPE)
    found = escape.escape_threshold(chain, prepared, duration=200.0, tolerance=1e-3)
    assert abs(found.c_crit - fold.c_crit) <= found.error
    assert not escape.hold(chain, prepared, 0.4, 200.0).escaped


@pytest.mark.parametrize(("off", "extrapolated"), [(0.0, True), (0.09, False), (-0.09, False)])
def test_sweeps_have_a_limit_of_rate_zero_where_the_delay_is_that_of_a_fold(
    off: float, extrapolated: bool
) -> None:
    """A delay K rate^{2/3}; the next term, of first order, is a cube root of the rate beside it."""
    exponent = 2.0 / 3.0 + off
    delay = slow_sweep.fit_delay(
        slow_sweep.RATES, [0.2 + 0.5 * rate**exponent for rate in slow_sweep.RATES], seconds=0.0
    )
    assert delay.delay_exponent == pytest.approx(exponent, abs=1e-9)
    assert (delay.c_0 is not None) is extrapolated
    assert slow_sweep.fit_delay(slow_sweep.RATES, [0.2] * 5, seconds=0.0).delay_exponent is None
    assert pytest.approx(2.0 * math.cbrt(min(slow_sweep.RATES)), rel=0.1) == slow_sweep.LAW


def test_a_sweep_that_does_not_escape_ends_where_sweeps_are_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        slow_sweep, "hold", lambda *given: SimpleNamespace(escaped=given[2] > 0.11, phi=None)
    )
    ends: list[float] = []

    def run(here: Any, _: None, duration: float, *, rate: float, **__: Any) -> Any:
        ends.append(here.c + rate * duration)
        return SimpleNamespace(escaped=False, coupling=ends[-1])

    monkeypatch.setattr(slow_sweep, "run_envelope", run)
    assert slow_sweep.sweep_envelope(AVERAGED, escape.NucleusPreparation(1), 1e-3) is None
    assert ends == [pytest.approx(slow_sweep.END)]


@pytest.mark.parametrize(
    ("noise", "limit", "by"), [(1e-3, 0.2, "hold"), (0.0, None, "both"), (0.0, 0.2, "sweep")]
)
def test_what_has_no_limit_of_rate_zero_is_held(
    noise: float, limit: float | None, by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With noise it is not swept at all."""
    preparation = escape.NucleusPreparation(1, perturbation=noise)
    held = _held(0.19, seconds=2.0)
    delay = slow_sweep.Delay(
        rates=(), escapes=(), c_0=limit, error=None if limit is None else 1e-3,
        delay_exponent=None, seconds=3.0,
    )  # fmt: skip

    def given(value: Any) -> Any:
        def answer(chain: object, prepared: object) -> Any:
            assert (chain, prepared) == (AVERAGED, preparation)
            return value

        return answer

    monkeypatch.setattr(slow_sweep, "escape_range", given(held))
    monkeypatch.setattr(slow_sweep, "measure_delay", given(delay))
    found = slow_sweep.sweep_threshold(AVERAGED, preparation)
    assert (found.c_crit, found.seconds, found.delay) == {
        "hold": (0.19, 2.0, None), "both": (0.19, 5.0, delay), "sweep": (0.2, 3.0, delay),
    }[by]  # fmt: skip


def _held(c: float, seconds: float) -> RunThreshold:
    return RunThreshold(
        c_crit=c, error=1e-3, method=ThresholdMethod.HOLD, definition=Definition.FIRST,
        mechanism=Mechanism.HELD, model="averaged", nucleus=Nucleus(1), low=c, high=c,
        final_time=1.0, runs=1, seconds=seconds,
    )  # fmt: skip


def test_what_is_usual_on_a_lattice_is_what_its_description_says() -> None:
    """The sites excited are those within 3.5 of one, and a stall is as long as on a chain."""
    rows, columns = np.indices((9, 9)) - 4
    assert np.count_nonzero(rows**2 + columns**2 < 3.5**2) == network.EXCITED
    assert network.STALL_TIME.default == smooth.STALL_TIME.default


def test_what_is_usual_is_allowed() -> None:
    options = [
        each
        for module in (friction, network, smooth)
        for name in ("ACCURACY", "TOLERANCE", "EXCITED", "STALL_TIME", "DIRECTIONS")
        if isinstance(each := getattr(module, name, None), request.Option)
    ]
    assert len(options) >= 9
    for each in options:
        assert each.allowed.low <= each.default <= each.allowed.high, each.quantity
    for allowed, usual in (
        (simulation.ACCURACIES, simulation.ACCURACY),
        (simulation.MAX_SITES_RANGE, simulation.MAX_SITES),
        (wave.COUPLINGS, 0.6),
    ):
        assert allowed.low <= usual <= allowed.high
