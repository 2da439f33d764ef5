"""Fronts and thresholds of Model I: against scipy, mirror symmetry, and their own error bounds."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tests.settling import settle
from theory.cells.friction import FrictionCell
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, RunError
from verification.fronts import measure
from verification.fronts.arrival_fit import leading, line, velocity_of_arrivals
from verification.fronts.measure import measure_front
from verification.fronts.preparation import Trial
from verification.fronts.request import Request
from verification.fronts.result import Front
from verification.fronts.status import FrontStatus
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration
from verification.thresholds import spreading
from verification.thresholds.spreading import (
    Definition,
    Spreading,
    spreading_threshold,
    spreads,
)
from verification.thresholds.threshold import threshold

MU_ST, MU_D, V0, XI, V_D = 1.0, 0.5, 0.5, 0.05, 1.25
"""(7), written out once more."""


def _arrivals_by_scipy(c: float, y: NDArray[np.float64], end: float) -> NDArray[np.float64]:
    """Return the first stick of every site, from solve_ivp with one terminal event a site."""
    n = y.size
    spring = np.eye(n) * (1.0 + 2.0 * c) - c * (np.eye(n, k=1) + np.eye(n, k=-1))
    spring[0, 0] = spring[-1, -1] = 1.0 + c
    stuck = np.zeros(n, dtype=bool)
    arrivals = np.full(n, np.nan)
    free_until = np.zeros(n)

    def hold(z: NDArray[np.float64]) -> NDArray[np.float64]:
        return 2.0 * XI * V_D + spring @ z[:n]

    def rate(_: float, z: NDArray[np.float64]) -> NDArray[np.float64]:
        velocity = z[n:]
        slide = velocity - V_D
        # backward slip only, which the assertion below makes sure of; smooth through w = 0
        friction = MU_D + (MU_ST - MU_D) * np.exp(slide / V0)
        force = friction - 2.0 * XI * velocity - spring @ z[:n]
        return np.concatenate([velocity, np.where(stuck, 0.0, force)])

    def event_of(k: int):  # type: ignore[no-untyped-def]
        def event(t: float, z: NDArray[np.float64]) -> float:
            if stuck[k]:
                return MU_ST - abs(hold(z)[k])
            return V_D - z[n + k] if t >= free_until[k] else 1.0

        event.terminal = True  # type: ignore[attr-defined]
        event.direction = -1.0  # type: ignore[attr-defined]
        return event

    events = [event_of(k) for k in range(n)]
    t, z = 0.0, np.concatenate([y, np.zeros(n)])
    while t < end:
        run = solve_ivp(
            rate, (t, end), z, "DOP853", events=events, rtol=1e-9, atol=1e-10, max_step=0.25
        )
        assert run.success
        t, z = float(run.t[-1]), run.y[:, -1].copy()
        for k in [k for k in range(n) if run.t_events[k].size]:
            z[n + k] = V_D
            if stuck[k]:
                stuck[k] = False
                # released with ẏ = v_d it falls behind as -v_d t²/2: no event before it has
                free_until[k] = t + 0.02
            else:
                assert abs(hold(z)[k]) <= MU_ST
                stuck[k] = True
                if np.isnan(arrivals[k]):
                    arrivals[k] = t
    return arrivals


def test_arrivals_and_velocity_are_those_of_scipy_on_a_short_chain() -> None:
    chain = FrictionChain(c=0.1, sites=12)
    start = excite(chain, [1])
    run = FrictionIntegration(chain, start, tolerance=1e-10)
    run.advance_to(110.0)
    by_scipy = _arrivals_by_scipy(0.1, start[0], 110.0)
    known = ~np.isnan(by_scipy)
    assert np.count_nonzero(known) >= 9
    assert (known == ~np.isnan(run.arrivals)).all()
    # a relative tolerance of 1e-9 a step over some thousand steps, each event located to its own
    assert np.max(np.abs(by_scipy - run.arrivals)[known]) < 1e-5
    reached = np.flatnonzero(known)[2:]
    slope = np.polyfit(reached, by_scipy[reached], 1)[0]
    front = measure_front(FrictionChain(c=0.1, sites=61), accuracy=0.02)
    # a few sites only, timed in steps of a period of 6.35: one step over the sites seen
    few = 6.35 / (reached.size * slope)
    assert front.v == pytest.approx(1.0 / slope, rel=few)
    assert line(reached, by_scipy[reached])[0] == pytest.approx(slope, rel=1e-12)


def test_the_bracket_of_a_threshold_holds_for_scipy() -> None:
    chain = FrictionChain(c=0.0, sites=5)
    found = spreading_threshold(
        chain, Spreading(final_time=400.0), accuracy=1e-5, tests=0, lowest=1e-3
    )
    assert found.error < 1e-5
    assert found.perturbation == 0.0  # there is no noise
    for c, arrives in ((0.98 * found.low, False), (1.02 * found.high, True)):
        start = excite(replace(chain, c=c), [1])
        by_scipy = _arrivals_by_scipy(c, start[0], 400.0)
        assert (not np.isnan(by_scipy[1])) is arrives


@pytest.mark.parametrize("size", [1, 2])
def test_by_mirror_symmetry_the_middle_of_two_chains_is_the_edge_of_one(size: int) -> None:
    edge, bulk = (
        spreading_threshold(
            FrictionChain(c=0.0, sites=sites),
            Spreading(factor * size, place, final_time=400.0),
            accuracy=1e-5,
            tests=0,
            lowest=1e-3,
        )
        for sites, factor, place in ((16, 1, Place.EDGE), (32, 2, Place.BULK))
    )
    assert edge.c_crit == pytest.approx(bulk.c_crit, abs=edge.error + bulk.error)


def test_a_front_from_the_other_end_is_the_mirror_image() -> None:
    chain = FrictionChain(c=0.05, sites=15)
    one, other = (
        FrictionIntegration(chain, excite(chain, [site]), tolerance=1e-10) for site in (1, 15)
    )
    for run in (one, other):
        run.advance_to(200.0)
    assert np.count_nonzero(~np.isnan(one.arrivals)) > 6
    # sums in another order: round-off, a little amplified
    np.testing.assert_allclose(one.arrivals, other.arrivals[::-1], atol=1e-8)


def test_the_stated_error_bounds_what_a_long_chain_shows() -> None:
    for c, long in ((0.1, 121), (0.2, 161)):
        short = measure_front(FrictionChain(c=c, sites=41), max_sites=41, accuracy=0.1)
        far = measure_front(FrictionChain(c=c, sites=long), max_sites=long, accuracy=0.1)
        assert far.error < short.error
        assert abs(short.v - far.v) < short.error + far.error


def test_the_stated_error_bounds_the_pace_over_many_bursts_at_strong_coupling() -> None:
    # on a chain of this length the front passes nearly all sites in one burst
    chain = FrictionChain.of(FrictionCell(v_d=1.1642), c=12.926, sites=31)
    found = measure_front(chain, accuracy=0.1, max_sites=400)
    longer = replace(chain, sites=1000)
    run = FrictionIntegration(longer, excite(longer, [1]), tolerance=1e-7)
    run.advance_to(1.2 * longer.sites / math.sqrt(chain.c))  # waves travel at the root of c
    reached = np.fmin.accumulate(run.arrivals[::-1])[::-1]
    reached = reached[np.isfinite(reached)]
    half, last = reached.size // 2, reached.size - 1
    pace = (last - half) / (reached[last] - reached[half])
    # between the two sites there may be one burst more, or one fewer, than on average
    bursts = (reached[last] - reached[half]) / (2.0 * math.pi)
    assert bursts > 10.0
    assert abs(found.v - pace) < found.error + pace / bursts


def test_statuses() -> None:
    pinned = measure_front(FrictionChain(c=0.008, sites=31))
    assert (pinned.status, pinned.v, pinned.steady) == (FrontStatus.PINNED, 0.0, False)
    assert pinned.error == pytest.approx(1.0 / 3000.0)
    beyond = FrictionChain.of(FrictionCell(v_d=1.9), c=0.05, sites=31)
    collapsed = measure_front(beyond)
    assert (collapsed.status, collapsed.v) == (FrontStatus.COLLAPSED, None)
    # the same coupling from six sites: they creep on, below the threshold of one
    wide = measure_front(FrictionChain(c=0.009, sites=31), excited=6, accuracy=0.1)
    assert wide.steady
    assert 0.002 < wide.v < 0.004
    unsteady = measure_front(
        FrictionChain(c=0.1, sites=31), max_sites=31, accuracy=1e-6
    )  # fmt: skip
    assert unsteady.status is FrontStatus.UNSTEADY


def test_the_regression_finds_a_velocity_through_steps_and_a_transient() -> None:
    rng = np.random.default_rng(6)
    site = np.arange(200)
    for v in (0.01, 0.3):
        period = 0.4 / v
        steps = period * np.ceil((site / v + 20.0 * np.exp(-site / 9.0)) / period)
        noisy = steps + 1e-3 * rng.standard_normal(200)
        found, error = velocity_of_arrivals(noisy)
        assert abs(found - v) < error < 0.01 * v


def test_sites_reached_at_once_have_no_velocity() -> None:
    together = 0.13 + 1e-16 * np.random.default_rng(3).random(64)
    assert velocity_of_arrivals(together) == (np.inf, np.inf)
    assert velocity_of_arrivals(np.zeros(32)) == (np.inf, np.inf)
    apart = 1.0 + np.arange(64) * 2e-12 / 32  # twice a rounding error, over the second half
    assert velocity_of_arrivals(apart)[0] == pytest.approx(16e12, rel=1e-2)


def test_a_front_whose_sites_are_reached_at_once_is_unsteady_with_their_arrivals() -> None:
    trial = Trial(
        stopped=None, arrivals=np.full(40, 2.0), coarser=np.full(40, 2.0), counts=Counter(steps=7)
    )
    found = settle(lambda _: trial, sites=32, max_sites=40)
    assert (found.status, found.v, found.error) == (FrontStatus.UNSTEADY, None, None)
    assert found.arrivals.tolist() == [2.0] * 40
    assert (found.sites, found.counts) == (32, {"steps": 7})


@pytest.mark.parametrize(
    ("other", "status", "error"),
    [(None, FrontStatus.STEADY, 0.0), (0.5002, FrontStatus.STEADY, 2e-4),
     (0.51, FrontStatus.UNSTEADY, 1e-2)],
)  # fmt: skip
@pytest.mark.parametrize("enough", [True, False])
def test_on_the_longest_chain_a_front_is_measured_though_it_should_be_longer(
    enough: bool, other: float | None, status: FrontStatus, error: float
) -> None:
    """Then the error holds the distance from a second velocity."""
    arrivals = 2.0 * np.arange(40.0)
    trial = Trial(stopped=None, arrivals=arrivals, coarser=arrivals, counts=Counter(steps=7))
    found = settle(lambda _: trial, sites=40, long_enough=lambda *_: enough, other_velocity=other)
    assert found.v == pytest.approx(0.5, rel=1e-12)
    assert found.status is (FrontStatus.STEADY if enough else status)
    assert found.error == pytest.approx(0.0 if enough else error, abs=1e-7)
    assert (found.sites, found.counts["steps"]) == (40, 7)
    assert found.arrivals.tolist() == arrivals.tolist()


def test_sites_left_out_and_filled_later_do_not_slow_a_front_down() -> None:
    arrivals = np.arange(40.0)
    late = arrivals.copy()
    late[[5, 17, 30]] = 500.0
    assert velocity_of_arrivals(leading(late))[0] == pytest.approx(1.0, rel=1e-2)
    assert leading(np.array([1.0, np.nan, 3.0, np.nan])).tolist() == [1.0, 3.0, 3.0]


@pytest.mark.parametrize("power", [2 / 3, 1.0, 2.0])
@pytest.mark.parametrize("sites", [64, 1024])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_error_of_a_velocity_that_drifts_bounds_the_way_to_its_limit(
    power: float, sites: int, side: float
) -> None:
    """The head of a dispersive wave comes to its velocity like n^{-2/3}; from above or below."""
    local = 1.0 - side * 0.5 * np.arange(1, sites + 1) ** -power
    v, error = velocity_of_arrivals(np.cumsum(1.0 / local))
    assert abs(v - 1.0) <= error <= 6.0 * abs(v - 1.0)


@pytest.mark.parametrize("start", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("end", [0.25, 0.5])
@pytest.mark.parametrize("share", [0.5, 1.0, 2.0])
def test_the_error_bounds_the_effect_of_both_ends_where_they_are_alike(
    start: float, end: float, share: float
) -> None:
    """Periods of 1 but for a transient at the beginning and an end, of which the fit sees both."""
    n = np.arange(1, 33)
    early = start ** (n - 16.0)
    periods = 1.0 - 1e-5 * (early + share * end ** (32.0 - n))
    v, error = velocity_of_arrivals(np.cumsum(periods))
    assert abs(v - 1.0) <= error < 20.0 * abs(v - 1.0)


@pytest.mark.parametrize("period", [2.3, 7.1, 16.0])
def test_a_ripple_of_the_arrivals_is_no_drift(period: float) -> None:
    n = np.arange(256)
    v, error = velocity_of_arrivals(n + 0.2 * np.sin(2 * np.pi * n / period))
    assert abs(v - 1.0) <= error < 2e-3


def test_chains_are_made_longer_until_velocity_and_companion_agree() -> None:
    asked = []

    def trial(sites: int) -> Trial:
        asked.append(sites)
        times = np.arange(float(sites))
        # the run beside it is late by a time that matters less on a longer chain
        return Trial(None, times, times * (1.0 + 1.0 / (3.0 * sites)), Counter(steps=1))

    found = settle(trial, sites=32, max_sites=1000, accuracy=0.01, pinned_error=0.0)
    assert asked == [32, 64, 128]
    assert found.status is FrontStatus.STEADY
    assert found.error == pytest.approx(3.0 / 385.0, rel=1e-6)
    short = settle(trial, sites=32, max_sites=40, accuracy=0.01, pinned_error=0.0)
    assert short.status is FrontStatus.UNSTEADY
    exact = Trial(None, np.arange(64.0), np.arange(64.0), Counter(steps=1))
    doubted = settle(
        lambda _: exact,
        sites=64,
        max_sites=64,
        accuracy=0.01,
        pinned_error=0.0,
        long_enough=lambda *_: False,
        other_velocity=0.9,
    )
    assert (doubted.status, doubted.error) == (FrontStatus.UNSTEADY, pytest.approx(0.1))
    stopped = settle(
        lambda _: exact._replace(stopped=FrontStatus.PINNED),
        sites=64,
        max_sites=64,
        accuracy=0.01,
        pinned_error=0.5,
    )
    assert (stopped.v, stopped.error) == (0.0, 0.5)


def test_definitions_times_and_ends_move_the_threshold_as_they_must() -> None:
    chain = FrictionChain(c=0.0, sites=15)

    def at(**options: object) -> float:
        spreading = Spreading(**{"size": 3, "final_time": 600.0, **options})  # type: ignore[arg-type]
        return spreading_threshold(chain, spreading, accuracy=1e-4, tests=0, lowest=1e-3).c_crit

    first, several, whole = (
        at(definition=each) for each in (Definition.FIRST, Definition.SEVERAL, Definition.WHOLE)
    )
    assert first < several < whole
    assert at(final_time=1200.0) < first
    literal = replace(chain, ends=Ends.LITERAL)
    one = [
        spreading_threshold(ends, Spreading(), accuracy=1e-4, tests=0, lowest=1e-3).c_crit
        for ends in (chain, literal)
    ]
    # a spring to a wall on the excited site changes it by far more than the bracket
    assert abs(one[0] - one[1]) > 10 * 1e-4
    assert at(point=StartPoint.MINIMUM) == pytest.approx(first, abs=3e-4)


def test_late_spreading_is_reported_as_fuzzy_and_a_sharp_threshold_is_not() -> None:
    chain = FrictionChain(c=0.0, sites=15)
    sharp = spreading_threshold(
        chain, Spreading(1, Place.BULK), accuracy=1e-5, tests=4, lowest=1e-3
    )
    assert sharp.monotone
    assert sharp.c_crit_at_twice_the_time <= sharp.c_crit
    assert sharp.fuzzy_width < 1e-3 * sharp.c_crit
    spreading = Spreading(3, final_time=400.0)
    late = spreading_threshold(chain, spreading, accuracy=1e-5, tests=4, lowest=1e-3)
    assert late.fuzzy[0] == late.c_crit_at_twice_the_time < late.c_crit
    assert late.fuzzy_width > 100.0 * late.error
    # and it does spread at such a coupling, later than the final time
    between = replace(chain, c=0.5 * (late.c_crit_at_twice_the_time + late.c_crit))
    assert not spreads(between, spreading)
    assert spreads(between, spreading, 800.0)


def test_the_error_of_a_threshold_bounds_that_of_its_runs_where_a_coarser_one_errs_alike() -> None:
    chain = VdpChain(a=1, b=0.07913434305938917, c=0, eps=0.3, sites=5)
    how = Spreading(1, Place.BULK, final_time=45.187014347546196)
    found = spreading_threshold(chain, how, accuracy=1e-12, tests=0, lowest=1e-4)
    exact = replace(how, tolerance=1e-12)
    assert not spreads(replace(chain, c=found.c_crit - found.error), exact)
    assert spreads(replace(chain, c=found.c_crit + found.error), exact)
    # the difference from a hundred times the tolerance, by which the error was once estimated
    coarse = spreading_threshold(
        chain, replace(how, tolerance=1e-6), accuracy=1e-12, tests=0, lowest=1e-4
    )
    assert not spreads(replace(chain, c=found.c_crit - abs(found.c_crit - coarse.c_crit)), how)
    assert spreads(replace(chain, c=found.c_crit - abs(found.c_crit - coarse.c_crit)), exact)


def test_a_third_of_the_tolerance_gives_the_same_threshold() -> None:
    chain = FrictionChain(c=0.0, sites=9)
    coarse, fine = (
        spreading_threshold(
            chain, Spreading(final_time=400.0, tolerance=each), accuracy=1e-6, tests=0, lowest=1e-3
        )
        for each in (1e-6, 1e-10)
    )
    assert coarse.c_crit == pytest.approx(fine.c_crit, abs=coarse.error + fine.error)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Spreading(0),
        lambda: Spreading(final_time=0.0),
        lambda: Spreading(tolerance=1.0),
        lambda: spreads(FrictionChain(c=0.01, sites=3), Spreading(3)),
        lambda: spreading_threshold(
            FrictionChain.of(FrictionCell(v_d=1.9), c=0.0),
            Spreading(),
            accuracy=1e-6,
            lowest=1e-3,
            tests=12,
        ),
        lambda: spreading_threshold(
            FrictionChain(c=0.0, sites=5), Spreading(), lowest=0.1, accuracy=1e-6, tests=12
        ),
        lambda: spreading_threshold(
            FrictionChain(c=0.0), Spreading(), lowest=0.0, accuracy=1e-6, tests=12
        ),
        lambda: spreading_threshold(
            FrictionChain(c=0.0), Spreading(), highest=1e-4, accuracy=1e-6, lowest=1e-3, tests=12
        ),
        lambda: spreading_threshold(
            FrictionChain(c=0.0), Spreading(), accuracy=0.0, lowest=1e-3, tests=12
        ),
        lambda: measure_front(FrictionChain(c=0.0, sites=101)),
        lambda: measure_front(FrictionChain(c=0.02, sites=5)),
        lambda: measure_front(FrictionChain(c=0.02, sites=101), excited=0),
        lambda: measure_front(FrictionChain(c=1.001e4, sites=101)),
        lambda: measure_front(FrictionChain(c=1e6, sites=101)),
        lambda: measure_front(FrictionChain(c=0.02, sites=101), accuracy=1.0),
        lambda: measure_front(FrictionChain(c=0.02, sites=101, ends=Ends.LITERAL)),
        lambda: Nucleus(32, place=Place.EDGE).excited(31),
    ],
)
def test_bad_parameters_are_refused(make: object) -> None:
    with pytest.raises(ParameterError):
        make()  # type: ignore[operator]


def test_phase_steps_of_a_friction_chain_are_refused_and_not_passed_over() -> None:
    with pytest.raises(ParameterError, match="start in phase"):
        threshold(FrictionChain(c=0.0), Nucleus(3, "-+"), accuracy=1e-3, tests=0)
    with pytest.raises(ParameterError, match="start point"):
        threshold(VdpChain(a=4, b=0.5, c=0.0), method="bisection", start_point=StartPoint.MINIMUM)
    with pytest.raises(ParameterError, match="start point"):
        threshold(FrictionChain(c=0.0), start_point=StartPoint.MINIMUM, displacement=1.0)


def test_the_start_point_of_a_front_may_be_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []

    def stop(_: object, request: Request) -> Front:
        asked.append(request.point)
        raise RunError("enough")

    monkeypatch.setattr(measure, "_measured", stop)
    for point in ("minimum", StartPoint.MINIMUM, 2.0):
        with pytest.raises(RunError, match="enough"):
            measure.measure_front(FrictionChain(c=0.02), point=point)
    assert asked == [StartPoint.MINIMUM, StartPoint.MINIMUM, 2.0]
    assert asked[0] is StartPoint.MINIMUM


def test_a_search_runs_for_the_time_and_with_the_tolerance_that_it_is_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []
    monkeypatch.setattr(
        spreading, "spreads",
        lambda chain, how, time, _: bool(asked.append((chain.c, time, how.tolerance))),
    )  # fmt: skip
    how = Spreading(final_time=300.0, tolerance=1e-7)
    search = spreading._Search(FrictionChain(c=0.0), how, 1e-4, 0.1, 0.5)
    search.spreads(0.2)
    search.spreads(0.3, longer=2.0)
    search.spreads(0.4, finer=10.0)
    assert asked == [(0.2, 300.0, 1e-7), (0.3, 600.0, 1e-7), (0.4, 300.0, 1e-7 / 10.0)]
    monkeypatch.setattr(spreading, "spreads", lambda *_: True)
    assert search.spreads(0.4)


@pytest.mark.parametrize(("widths", "told"), [(1.2, False), (3.0, True)])
def test_couplings_without_a_sharp_threshold_are_told_where_they_are_two_brackets_wide(
    widths: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    accuracy, c = 1e-3, 0.2
    below = c - widths * accuracy
    searching = spreading._Search
    monkeypatch.setattr(searching, "bracket", lambda _: (c - 0.5 * accuracy, c + 0.5 * accuracy))
    monkeypatch.setattr(searching, "effect_of_tolerance", lambda *_: 0.0)
    monkeypatch.setattr(searching, "spreads", lambda *_, **__: False)
    monkeypatch.setattr(searching, "exceptions", lambda *_: ([below], []))
    found = spreading.spreading_threshold(
        FrictionChain(c=0.0), Spreading(), lowest=0.1, accuracy=accuracy, tests=1
    )
    assert found.monotone is False
    assert found.fuzzy == (pytest.approx((below, c)) if told else None)


@pytest.mark.parametrize("displacement", [None, 0.5])
def test_excited_sites_start_at_rest_beside_sites_that_slide_steadily(
    displacement: float | None,
) -> None:
    """A turning point of the cycle has no velocity."""
    start = excite(FrictionChain(c=0.0, sites=3), [2], displacement)
    assert start[1].tolist() == [0.0, 0.0, 0.0]
    assert start[0, 1] == 0.5 or (displacement is None and start[0, 1] > start[0, 0])
