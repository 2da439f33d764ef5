"""Stated errors of made-up results: each holds what it must hold, on either side where it matters.

The runs themselves are elsewhere; here every estimate is given numbers of which the worst case can
be written down.
"""

from __future__ import annotations

import itertools
import math
import statistics
from collections import Counter
from contextlib import nullcontext
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import linregress

import fronts as fr
from tests.settling import settle
from theory.arrays import EPS, FloatArray
from theory.cells.friction import FrictionCell
from theory.cells.vdp import attraction_rate
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers.orbits import Orbits
from verification.cells import shooting
from verification.cells.friction import ROUND_OFF, _rounding_of_end, _with_error
from verification.cells.result import CellCycle
from verification.fronts.arrival_fit import (
    error_beside,
    error_by_disorder,
    velocity_of_arrivals,
)
from verification.fronts.preparation import Trial
from verification.fronts.resting import pinning_eta, static_fold
from verification.piecewise.chain import PiecewiseMotion, Rest
from verification.piecewise.verdict import History
from verification.piecewise.window import _RESERVE, ChainState, decay_rate, truncation_bound
from verification.runs import averaging_error, smooth_integration
from verification.runs.averaging_error import AveragingError
from verification.runs.ensemble import Ensemble, SeedTask, ensemble
from verification.runs.envelope_run import escape as escape_condition
from verification.runs.envelope_run import run_envelope
from verification.runs.excite import excite
from verification.runs.friction_integration import FrictionIntegration
from verification.runs.integration import StandstillError
from verification.runs.simulate import simulate
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers import active, friction, smooth, stiff_stage
from verification.steppers.friction_series import CLOCK
from verification.thresholds import escape
from verification.thresholds.preparation import NucleusPreparation


def test_the_slope_of_the_averaging_error_bounds_what_errors_of_the_runs_can_do() -> None:
    """Both distances may be wrong by their errors, in opposite directions."""
    distances, errors = np.array([0.4, 0.2, 0.1]), np.array([0.0, 2e-4, 1e-4])
    made = partial_averaging_error(distances, errors)
    off = []
    for signs in itertools.product((-1.0, 1.0), repeat=2):
        true = distances[1:] + np.array(signs) * errors[1:]
        slope = math.log(true[0] / true[1]) / math.log(2.0)
        off.append(abs(slope - made.slope))
    assert made.slope_error == pytest.approx(max(off), rel=2e-3)  # to second order
    exact = partial_averaging_error(distances, 0.0 * errors)
    assert exact.slope_error == pytest.approx(0.0, abs=1e-15)
    for last, slope in ((0.05, 2.0), (0.2, 0.0)):  # after slopes of one, by one more and less
        bent = partial_averaging_error(np.array([0.8, 0.4, 0.2, last]), np.zeros(4))
        assert (bent.slope, bent.slope_error) == pytest.approx((slope, 1.0))


def test_averaged_and_full_chain_are_compared_at_eps_and_at_halves_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Up to a slow time of 3, or another one up to 100."""
    asked: list[tuple[float, float]] = []

    def distance(chain: VdpChain, _: FloatArray, slow_time: float) -> tuple[float, float]:
        asked.append((chain.eps, slow_time))
        return 2.0 * chain.eps, 1e-3 * chain.eps

    monkeypatch.setattr(averaging_error, "_distance", distance)
    chain = VdpChain(a=4, b=0.5, c=0.6, eps=0.04, sites=3)
    usual = averaging_error.averaging_error(chain)
    assert usual.slow_time == 3.0
    assert asked == [(0.04, 3.0), (0.02, 3.0), (0.01, 3.0)]
    assert usual.errors == pytest.approx([4e-5, 2e-5, 1e-5])
    assert averaging_error.averaging_error(chain, slow_time=100.0).slow_time == 100.0
    with pytest.raises(ParameterError, match=r"slow time = 100\.1.* at most 100"):
        averaging_error.averaging_error(chain, slow_time=100.1)


def partial_averaging_error(
    distances: np.ndarray[tuple[int], np.dtype[np.float64]],
    errors: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> AveragingError:
    return AveragingError(
        chain=None, slow_time=3.0, eps=0.1 * 0.5 ** np.arange(distances.size),
        distances=distances,
        errors=errors, seconds=0.0,
    )  # fmt: skip


@pytest.mark.parametrize("period", [7.0, 700.0])
def test_a_cycle_is_no_better_than_rounding_of_its_period(period: float) -> None:
    one = CellCycle(max=2.0, min=-2.0, period=period, slip_time=period, speed=2.0, error=0.0)
    found = _with_error(FrictionCell(), one, one)
    assert found.error == ROUND_OFF * period
    other = _with_error(FrictionCell(), one, replace(one, period=period + 0.5))
    assert other.error == 0.5


def test_a_velocity_of_a_network_is_uncertain_by_six_times_how_much_its_halves_differ() -> None:
    distance = np.arange(40.0)
    v, error = velocity_of_arrivals(distance / 2.0, distance)
    assert (v, error) == pytest.approx((2.0, 0.0), abs=1e-9)  # rounding of forty times
    slower = np.where(distance < 30.0, distance / 2.0, 15.0 + (distance - 30.0))
    v, error = velocity_of_arrivals(slower, distance)
    # The outer half has times of 1/2 and then of 1 a site: the true velocity is either of these.
    assert max(abs(v - 1.0), abs(v - 2.0)) <= error
    assert error == pytest.approx(6.0 * 0.5 * v**2, rel=1e-2)  # not explained by standard errors


def test_distances_of_any_order_and_spacing_give_the_velocity_of_neighbouring_sites() -> None:
    sites = np.arange(64)
    arrivals = sites / 2.0 + 0.3 * np.exp(-sites / 20.0)
    v, error = velocity_of_arrivals(arrivals[:40])
    mixed = np.random.default_rng(2).permutation(40)
    found = velocity_of_arrivals(arrivals[mixed], 3.0 * mixed)
    assert found[0] == pytest.approx(3.0 * v, rel=1e-12)
    assert found[1] >= 3.0 * error


@pytest.mark.parametrize("earlier", [0.1, -0.1])
def test_a_velocity_that_earlier_arrivals_bend_is_as_uncertain_in_either_direction(
    earlier: float,
) -> None:
    """The farther half is straight, and only the fit of three quarters has another slope."""
    distances = np.arange(5.0, 45.0)
    arrivals = distances + np.where(np.abs(distances - 20.0) < 5.0, earlier, 0.0)
    terms = np.array([np.ones(30), distances[10:], np.log(distances[10:])])
    slope = np.linalg.solve(terms @ terms.T, terms @ arrivals[10:])[1]
    v, error = velocity_of_arrivals(arrivals, distances)
    assert v == pytest.approx(1.0, rel=1e-12)
    assert error == pytest.approx(2.0 * abs(slope - 1.0), rel=1e-6)


def test_sites_far_away_that_are_reached_at_once_to_rounding_have_an_infinite_velocity() -> None:
    """What counts is how far they are from one another: they are twenty times as far away.

    From the first to the last of the farther half the times differ by 49 of their differences.
    """
    distances = np.arange(1000.0, 1100.0)
    for late, finite in ((2.03e-14, False), (2.05e-14, True)):
        v, error = velocity_of_arrivals(1.0 + late * np.arange(100.0), distances)
        assert (math.isfinite(v), math.isfinite(error)) == (finite, finite)
    # Rounding is that of the latest: at both ends of the farther half sites are reached first.
    both_ends = (np.abs(np.arange(100.0) - 74.5) < 12.0) + 1e-14 * np.arange(100.0)
    assert velocity_of_arrivals(both_ends) == (math.inf, math.inf)
    assert error_beside(*np.full(3, math.inf), 1e-8) == math.inf


def test_of_few_arrivals_no_change_of_velocity_is_explained_by_standard_errors() -> None:
    """Periods from row to row of 20 of a square lattice, c = 3; on a long one v is 0.977449."""
    periods = [
        0.214,
        0.388,
        0.543,
        0.671,
        0.770,
        0.845,
        0.9,
        0.937,
        0.961,
        0.97,
        0.957,
        0.905,
        0.791,
    ]
    v, error = velocity_of_arrivals(np.cumsum([0.04, *periods]))
    assert 0.09 < abs(v - 0.977449) <= error


@pytest.mark.parametrize("count", [14, 15, 16, 19, 22, 40])
def test_the_error_of_a_velocity_is_that_of_its_rule_with_the_regression_of_scipy(
    count: int,
) -> None:
    """From eight fitted arrivals on, two standard errors may explain that quarters differ.

    They explain nothing of arrivals that have distances of their own.
    """
    for seed in range(8):
        noise = np.random.default_rng(seed).normal(size=count)
        arrivals = 3.0 + 2.0 * np.arange(count) + 0.05 * noise
        late = arrivals[count // 2 :]
        half, outer = late.size // 2, late.size // 4
        parts = slice(None), slice(half), slice(half, None), slice(outer, -outer)
        whole, first, second, middle = (
            linregress(np.arange(late.size)[part], late[part]) for part in parts
        )
        apart, bend = abs(first.slope - second.slope), abs(whole.slope - middle.slope)
        explained = 0.0, 0.0
        if late.size >= 8:
            errors = math.hypot(first.stderr, second.stderr), middle.stderr
            explained = 2.0 * errors[0], 3.0 * errors[1]
        drift = 6.0 * (apart - explained[0]), 3.0 * (bend - explained[1])
        error = max(3.0 * whole.stderr, apart, *drift) / whole.slope**2
        assert velocity_of_arrivals(arrivals) == pytest.approx((1.0 / whole.slope, error), rel=1e-6)
        unexplained = max(3.0 * whole.stderr, apart, 6.0 * apart, 3.0 * bend) / whole.slope**2
        own_distances = velocity_of_arrivals(arrivals, np.arange(float(count)))
        assert own_distances[1] >= unexplained * (1.0 - 1e-9)


@pytest.mark.parametrize("radius", [17.0, 28.0])
@pytest.mark.parametrize("curvature", [0.2, 1.0, 2.0])
def test_the_error_along_a_ray_bounds_the_way_to_the_velocity_of_a_straight_front(
    radius: float, curvature: float
) -> None:
    """dR/dt = 1 - curvature/R, at the sites within 1 of a row, which lag behind by their offset."""
    along, offset = np.meshgrid(np.arange(4.0, radius), [-1.0, 0.0, 1.0])
    r = np.hypot(along, offset).ravel()
    arrivals = r + curvature * np.log(r - curvature)
    v, error = velocity_of_arrivals(arrivals, along.ravel())
    assert abs(v - 1.0) <= error <= 12.0 * abs(v - 1.0)


def test_the_error_along_a_ray_bounds_the_way_to_a_straight_front_though_quarters_agree() -> None:
    """In the farther half all is on a line, as where scatter hides the drift; nearer the centre the
    front is slower, like 1 - 1/R, and far away v is 1.
    """
    along = np.arange(4.0, 28.0)
    arrivals = along + np.log(along - 1.0)
    half = along.size // 2
    slope = (arrivals[-1] - arrivals[half]) / (along[-1] - along[half])
    arrivals[half:] = arrivals[half] + slope * (along[half:] - along[half])
    v, error = velocity_of_arrivals(arrivals, along)
    assert 0.04 < abs(v - 1.0) <= error < 2.5 * abs(v - 1.0)


@pytest.mark.parametrize(
    ("tolerance", "off", "error"), [(1e-6, 1e-4, 3e-4), (1e-6, 1e-9, 5e-7), (1e-10, 0.0, 5e-11)]
)
def test_a_velocity_errs_by_more_than_its_difference_from_the_run_beside_it(
    tolerance: float, off: float, error: float
) -> None:
    """Errors of runs are not proportional to the tolerance: both may err alike."""
    trial = Trial(None, np.arange(64) / 2.0, np.arange(64) / (2.0 + off), Counter(steps=1))
    found = settle(lambda _: trial, sites=64, max_sites=64, tolerance=tolerance)
    assert found.error == pytest.approx(error, rel=1e-3)


@pytest.mark.parametrize(("other", "enough", "error"), [(3.0, False, 1.0), (1.0, False, 1.0),
                                                        (3.0, True, 5e-9)])  # fmt: skip
def test_on_the_longest_chain_the_difference_from_another_velocity_is_part_of_the_error(
    other: float, enough: bool, error: float
) -> None:
    def trial(sites: int) -> Trial:
        return Trial(None, np.arange(sites) / 2.0, np.arange(sites) / 2.0, Counter(steps=sites))

    found = settle(trial, sites=32, max_sites=40, accuracy=1e-3, pinned_error=0.0,
                   other_velocity=other, long_enough=lambda *_: enough)  # fmt: skip
    assert found.error == pytest.approx(error, abs=1e-9)


def test_the_truncation_bound_is_its_series_summed_term_by_term() -> None:
    c, v, distance = 0.5, 0.3, 40.0
    s = decay_rate(c, v)
    n = np.arange(4000)
    ahead = np.exp(-s * n).sum()
    waits = np.exp(-0.5 * _RESERVE * n / v).sum()  # switchings of the past, one every 1/v
    behind = waits + ahead + np.exp(-2.0 * s * n).sum()
    images = np.exp(-s * distance * (1.0 + n)).sum()
    expected = 0.5 / (0.5 - c * math.sinh(s)) * (ahead + behind) * images
    assert truncation_bound(c, v, distance) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("remainder", [1e-3, 0.0])
def test_rest_is_proven_beyond_what_is_left_and_rounding(remainder: float) -> None:
    assert Rest(margin=remainder + 1.1e-13, remainder=remainder).proven
    assert not Rest(margin=remainder + 0.9e-13, remainder=remainder).proven


@pytest.mark.parametrize(("name", "rate"), [("c", 0.5), ("a", -2.0), ("b", 0.25)])
def test_what_drifts_is_after_one_unit_of_time_what_it_was_and_its_rate(
    name: str, rate: float
) -> None:
    """In slow time, in which the averaged chain is run, the rate is larger by 1/ε."""
    full = VdpChain(a=4.0, b=0.5, c=0.1, eps=0.01, sites=3)
    for chain, units in ((full, 1.0), (full.averaged(), 0.01)):
        run = SmoothIntegration(chain, np.zeros((2, 3)), [0.0, 1.0], drift={name: rate})
        later = chain.replace(**{name: getattr(chain, name) + rate}).kernel_parameters()
        drifted = np.array(chain.kernel_parameters()) + run._task.drift * units
        assert drifted == pytest.approx(np.array(later), rel=1e-13)


@pytest.mark.parametrize("c", [0.1, 10.0])
def test_the_sites_stepped_beyond_the_last_moving_one_are_more_where_coupling_reaches_farther(
    c: float,
) -> None:
    """What moves passes in one evaluation as many sites as one coupling reaches over."""
    near = OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=c, sites=100)
    far = near.replace(coupling="chain:1,0,0.2")
    assert smooth_integration._margin(far) == 3 * smooth_integration._margin(near)


def test_the_margin_is_doubled_at_couplings_above_3() -> None:
    chain = AveragedChain(a=4, b=0.5, c=3.0, sites=100)
    weak, strong = (smooth_integration._margin(replace(chain, c=c)) for c in (3.0, 3.01))
    assert (weak, strong) == (smooth_integration.MARGIN, 2 * smooth_integration.MARGIN)


def test_the_margin_of_a_front_at_rest_is_what_no_motion_can_use_up() -> None:
    state = ChainState(np.where(np.arange(64) < 32, 1.0 + 0j, 0j))
    history = History(PiecewiseMotion(0.1, 0.4, state), 0.1)
    found = history.verdict(Rest(margin=0.3, remainder=0.1), 1e-9, 0.0)
    assert found.margin == pytest.approx(0.2)
    assert (found.v, found.error, found.status.value) == (0.0, 0.0, "pinned")


def test_the_pinning_eta_is_no_better_than_the_fold_that_it_inverts() -> None:
    pin = pinning_eta(0.101944386)
    fold = static_fold(pin.eta)
    slope = (static_fold(pin.eta + 1e-6).c - static_fold(pin.eta - 1e-6).c) / 2e-6
    assert pin.error >= fold.error / slope
    assert static_fold(pin.eta + pin.error).c >= 0.101944386 >= static_fold(pin.eta - pin.error).c


@pytest.mark.parametrize(
    ("integration", "chain", "part", "place"),
    [
        *((SmoothIntegration, VdpChain(a=4, b=0.5, c=0.6, sites=4), "clock", n) for n in (0, -1)),
        (FrictionIntegration, FrictionChain(c=0.02, sites=4), "numbers", CLOCK),
    ],
)
def test_a_clock_that_is_not_finite_in_any_part_is_refused(
    integration: Any, chain: Any, part: str, place: int
) -> None:
    run = integration(chain, excite(chain, [1]), [10.0])
    run.check_state()
    getattr(run._run, part)[place] = math.nan
    with pytest.raises(ValueError, match="clock"):
        run.check_state()


@pytest.mark.parametrize("counters", [(-1, 4, 0), (3, 2, 0), (0, 5, 0), (0, 4, -1), (0, 4, 3)])
def test_counters_of_a_smooth_chain_beyond_what_they_count_are_refused(
    counters: tuple[int, int, int],
) -> None:
    """Of four sites and two samples."""
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=4)
    run = SmoothIntegration(chain, excite(chain, [1]), [5.0, 10.0])
    places = [smooth.LO, smooth.HI, smooth.SAMPLED]
    for given in ((0, 4, 0), (4, 4, 2)):
        run._run.counters[places] = given
        run.check_state()
    run._run.counters[places] = counters
    with pytest.raises(ValueError, match="counters"):
        run.check_state()


@pytest.mark.parametrize(
    ("counter", "least", "most"),
    [(friction.LO, 1, 5), (friction.HI, 1, 5), (friction.SAMPLED, 0, 2), (friction.LOGGED, 0, 3)],
)
def test_counters_of_a_friction_chain_beyond_what_they_count_are_refused(
    counter: int, least: int, most: int
) -> None:
    """Of four sites, two samples and three events."""
    chain = FrictionChain(c=0.02, sites=4)
    start = excite(chain, [1])
    run = FrictionIntegration(chain, start, [5.0, 10.0], active_window=False, logged_events=3)
    counters = run._run.counters
    counters[friction.LO], counters[friction.HI] = (5, 5) if counter == friction.LO else (1, 5)
    if counter == friction.HI:
        counters[friction.LO] = 1
    for value in (least, most):
        counters[counter] = value
        run.check_state()
    for value in (least - 1, most + 1):
        counters[counter] = value
        with pytest.raises(ValueError, match="counters"):
            run.check_state()


def _ensemble(values: FloatArray, errors: FloatArray) -> Ensemble:
    return Ensemble(
        chain=None, quantity="v", seeds=np.arange(values.size), values=values, errors=errors,
        reasons=np.full(values.size, ""), seconds=0.0,
    )  # fmt: skip


def test_the_mean_over_seeds_errs_by_the_errors_of_the_values() -> None:
    """Equal values have the error of one; those that are missing do not count."""
    for values, errors in (
        (np.ones(5), np.full(5, 1e-3)),
        (np.append(np.ones(4), math.nan), np.append(np.full(4, 1e-3), math.nan)),
    ):
        found = _ensemble(values, errors)
        assert found.mean_error == pytest.approx(1e-3)
        assert found.missing == np.isnan(values).sum()


@pytest.mark.parametrize("count", [2, 3, 8, 64])
def test_the_error_of_a_mean_over_seeds_covers_it_in_95_of_100_cases(count: int) -> None:
    """Of normal values with mean zero; the standard error alone covers 50 to 68 of 100."""
    drawn = np.random.default_rng(count).normal(size=(2000, count))
    found = [_ensemble(values, np.zeros(count)) for values in drawn]
    covered = sum(abs(each.mean) <= (each.mean_error or 0.0) for each in found) / len(found)
    assert covered == pytest.approx(0.95, abs=4.0 * math.sqrt(0.95 * 0.05 / len(found)))


def test_mean_and_spread_over_seeds_hold_where_the_largest_value_is_negative() -> None:
    """Of -2^601 and a far smaller one half is the mean, and the spread by the root of two more."""
    found = _ensemble(np.array([-(2.0**601), 2.0**-600]), np.zeros(2))
    assert found.mean == -(2.0**600)
    assert found.spread == pytest.approx(2.0**600 * math.sqrt(2.0), rel=1e-15)


@pytest.mark.parametrize("power", [-1000, -600, 0, 600, 1000])
def test_mean_and_spread_over_seeds_hold_at_any_scale(power: int) -> None:
    values = np.random.default_rng(1).normal(1.0, 0.1, 8)
    ours, found = (_ensemble(each, np.zeros(8)) for each in (values, np.ldexp(values, power)))
    assert ours.spread == pytest.approx(statistics.stdev(values.tolist()), rel=1e-14)
    for name in ("mean", "spread", "mean_error"):
        assert getattr(found, name) == math.ldexp(getattr(ours, name), power) > 0.0


def test_the_spread_over_seeds_is_that_of_the_largest_values_of_either_sign() -> None:
    large = math.ldexp(1.0, 600)
    for values in ([large, 1.0], [-large, -1.0]):
        found = _ensemble(np.array(values), np.zeros(2))
        assert found.spread == pytest.approx(large / math.sqrt(2.0), rel=1e-14)


@pytest.mark.parametrize("count", [3, 7, 1000])
def test_the_error_of_a_mean_of_equal_values_covers_its_rounding(count: int) -> None:
    found = _ensemble(np.full(count, 0.1), np.zeros(count))
    assert abs(found.mean - 0.1) <= (found.mean_error or 0.0) < 1e-15
    assert found.mean_error != 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_error_of_a_mean_of_neighbouring_numbers_covers_its_rounding(sign: float) -> None:
    """Of a thousand values the spread explains far less than the half unit by which it is off."""
    values = sign * np.tile([1.0, 1.0 + EPS], 500)
    exact = sum(map(Fraction, values)) / values.size
    found = _ensemble(values, np.zeros(values.size))
    assert 0 < abs(Fraction(found.mean) - exact) <= Fraction(found.mean_error or 0.0) < 2 * EPS


@pytest.mark.parametrize(("value", "error"), [(0.5, 0.1), (0.5, None)])
def test_a_number_of_one_seed_has_its_error_where_there_is_one(
    value: float, error: float | None
) -> None:
    chain = SimpleNamespace(replace=lambda seed: seed)
    made: Any = SeedTask(
        function=lambda seed, more: SimpleNamespace(c_crit=value, error=error, seed=seed + more),
        chain=chain,  # type: ignore[arg-type]
        options={"more": 1},
    )
    found = made({"seed": 3})
    for name, expected in (("value", value), ("error", error)):
        assert found[name] == pytest.approx(math.nan if expected is None else expected, nan_ok=True)
    assert found["quantity"] == "c_crit"


def test_one_seed_is_an_ensemble_and_a_truth_value_is_no_number_of_it() -> None:
    chain = OscillatorChain(
        damping="1 - a*y**2 + y**4", c=0.1, sites=3, values={"a": 4.0}, disorder={"a": 0.1}
    )
    found = ensemble(lambda made: 2.5, chain, seeds=[3])
    assert (found.seeds.tolist(), found.values.tolist(), found.quantity) == ([3], [2.5], "value")
    with pytest.raises(ParameterError, match=r"= bool .* must be a real number"):
        ensemble(lambda made: True, chain, seeds=[3])


def test_the_smallest_eta_of_a_run_of_the_envelope_is_1e_5() -> None:
    """Its steps are at most two of the times in which the cycle attracts."""
    chain = AveragedChain(a=1.0, b=1e-5, c=0.1, sites=3)
    start = np.zeros(3, dtype=complex)
    run = run_envelope(chain, start, 1e-3)
    assert 1e-3 / run.steps * attraction_rate(1e-5) <= 2.0 * (1.0 + 1.0 / run.steps)
    with pytest.raises(ParameterError, match="eta = b/a"):
        run_envelope(replace(chain, b=0.99e-5), start, 1e-3)


def test_a_run_counts_the_steps_of_both_methods_and_errs_as_the_less_accurate_one() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=5)
    run = SmoothIntegration(chain, excite(chain, [1]), [0.0, 10.0], tolerance=1e-14)
    run.samples[1, 0, 2] = -3.0
    assert run.least_error() == pytest.approx(smooth.LAZY * 1e-14 * 3.0)
    run._run.counters[[smooth.STEPS, smooth.STIFF_STEPS]] = 5, 2
    assert run.counts["steps"] == 7
    assert run.least_error() == pytest.approx(smooth.LAZY * stiff_stage.TIGHTEST * 3.0)
    averaged = SmoothIntegration(chain.averaged(), excite(chain, [1]), [0.0, 10.0], tolerance=1e-6)
    assert averaged.least_arrival_error() == pytest.approx(smooth.LAZY * 1e-6 / chain.eps)


def test_a_run_to_a_condition_has_no_implicit_stage_which_would_not_ask_for_it() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=5)
    start = excite(chain, [1])
    alone = SmoothIntegration(chain, start, [10.0])
    watched = SmoothIntegration(chain, start, [10.0], watch=escape_condition, memory=np.ones(6))
    shortest = [each.metadata["step_limits"][0] for each in (alone, watched)]
    assert shortest == [str(smooth_integration.STIFF_STEP), "1e-13"]
    assert watched.state_arrays["memory"].tolist() == [1.0] * 6  # of the condition


def stepped_sites(run: SmoothIntegration) -> list[int]:
    """Return the first site of the active window and the one after its last."""
    return [int(run._run.counters[n]) for n in (smooth.LO, smooth.HI)]


def test_a_site_on_which_a_force_acts_is_stepped_though_it_is_at_rest() -> None:
    chain = OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.1, sites=60, drive="0.3,1.1@40")
    start = np.zeros((2, 60))
    start[0, 9] = 3.8
    run = SmoothIntegration(chain, start, [10.0])
    margin = smooth_integration.MARGIN
    window = stepped_sites(run)
    assert window == [9 - margin, 39 + margin + 1]


def test_where_rest_is_unstable_every_site_is_stepped() -> None:
    for damping, high in (("y**2 - 1", 60), ("1 - 4*y**2 + 0.5*y**4", 10 + 4)):
        chain = OscillatorChain(damping=damping, c=0.1, sites=60)
        start = np.zeros((2, 60))
        start[0, 9] = 2.0
        run = SmoothIntegration(chain, start, [10.0], level=1.0)
        assert stepped_sites(run)[1] == high


def test_on_a_ring_every_site_is_stepped() -> None:
    """At its ends too sites begin to move, of which the window would know nothing."""
    for ends, window in ((Ends.PERIODIC, [0, 60]), (Ends.FREE, [0, 1 + smooth_integration.MARGIN])):
        chain = AveragedChain(a=4, b=0.5, c=0.1, sites=60, ends=ends)
        assert stepped_sites(SmoothIntegration(chain, excite(chain, [1]), [10.0])) == window


@pytest.mark.parametrize(("wave", "first"), [(False, active.FREE), (True, active.FOLLOWING)])
def test_before_the_first_site_there_is_nothing_or_a_wave(wave: bool, first: int) -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=3)
    run = SmoothIntegration(chain, np.zeros((2, 3)), [1.0], left_boundary_wave=wave)
    assert run._task.first == first


def test_the_errors_of_a_driven_chain_are_relative_to_its_force_while_it_is_at_rest() -> None:
    """Of y'' + y = 0.3 cos 2t from rest: relative to a state of zero no step is short enough."""
    chain = OscillatorChain(damping="0", c=0.0, sites=2, drive="0.3,2@all")
    run = SmoothIntegration(chain, np.zeros((2, 2)), [1.0, 10.0], level=1.0)
    run.finish()
    exact = 0.1 * (np.cos(run.times) - np.cos(2.0 * run.times))
    assert run.samples[:, 0] == pytest.approx(np.tile(exact[:, None], 2), abs=1e-7)


def test_a_piece_of_work_is_about_as_large_as_its_budget() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=50)
    run = SmoothIntegration(chain, excite(chain, range(1, 51)), [1e4], active_window=False)
    for spent in (1000, 2000):  # and so is the next one, whatever has been done before
        run.advance(1000)
        assert spent - 50 < run.counts["site_steps"] <= spent


def test_a_friction_chain_is_integrated_to_a_tolerance_of_1e_10_and_has_no_amplitude_at_first() -> (
    None
):
    chain = FrictionChain(c=0.02, sites=3)
    start = excite(chain, [2])
    assert start[1].tolist() == excite(chain, [2], 2.0)[1].tolist() == [0.0, 0.0, 0.0]
    run = FrictionIntegration(chain, start, [0.0, 0.1])
    assert run.tolerance == 1e-10
    assert run._run.series.shape[1] == 1 + 16  # of order 4 - ln(1e-10)/2, rounded up
    run.finish()
    assert run.sampled_amplitude.tolist() == [[0.0] * 3] * 2


@pytest.mark.parametrize(("left", "right"), [(9, 12), (2, 20), (14, 14), (35, 38)])
def test_after_a_stiff_stage_all_that_moves_is_stepped_with_its_margin(
    left: int, right: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up stage in which sites began to move that did not before."""
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=40)
    start = np.zeros((2, 40))
    start[0, 14] = 1e3
    run = SmoothIntegration(chain, start, [10.0])
    margin = smooth_integration.MARGIN
    window = stepped_sites(run)
    assert window == [14 - margin, 14 + margin + 1]
    after = np.zeros((2, 38))
    after[0, left - 1 : right] = 1.0
    piece = stiff_stage.StiffPiece(1, 39, np.array([0.0, 2.0]), lambda _: after.ravel())
    asked: list[Any] = []

    def solve(*given: Any) -> stiff_stage.StiffPiece:
        asked.extend(given)
        return piece

    monkeypatch.setattr(stiff_stage, "solve_stiff_piece", solve)
    assert run._rest == pytest.approx(1e3 * run.tolerance)
    run._run.clock[0], run._run.counters[smooth.STIFF_STEPS] = 1.5, 7
    run._pass_stiff_stage()
    assert asked[0] is chain
    assert asked[2:] == [tuple(window), 1.5, 10.0, run.tolerance, run._rest, margin, 7]
    low, high = stepped_sites(run)
    assert low == min(window[0], max(0, left - margin))
    assert high == max(window[1], min(40, right + margin + 1))
    assert (run.time, run.counts["stiff_steps"]) == (2.0, 7 + 1)
    assert run.counts["site_steps"] == 38  # one step of the sites of the piece
    assert run.state[0].nonzero()[0].tolist() == [*range(left, right + 1)]


def test_a_stiff_stage_that_ends_in_what_is_not_finite_is_no_answer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ended = SimpleNamespace(
        success=True, y=np.array([[1.0, 1.0, math.nan], [0.0, 0.0, 0.0]]),
        t=np.array([0.0, 0.1, 0.3]), message="?",
    )  # fmt: skip
    asked: list[dict[str, Any]] = []

    def solve(_: Any, span: tuple[float, float], __: Any, **given: Any) -> Any:
        assert span == (0.0, 1.0)
        asked.append(given)
        return ended

    monkeypatch.setattr("scipy.integrate.solve_ivp", solve)
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=2)
    gentle: Any = None
    for size in (1e3, 1e5):
        state = np.array([[-size, 0.0], [0.0, 0.0]])
        with pytest.raises(ArithmeticError, match=r"t = 0\.3"):
            stiff_stage._radau(chain, state, 0.0, 1.0, 1e-6, gentle)
        assert 0.0 < asked[-1]["atol"] < asked[-1]["rtol"] * size
    assert asked[1]["atol"] == pytest.approx(100.0 * asked[0]["atol"])
    with pytest.raises(ArithmeticError):
        stiff_stage._radau(chain, state, 0.0, 1.0, 1e-15, gentle)
    assert [each["rtol"] for each in asked] == [1e-6, 1e-6, 1e-12]
    assert asked[0]["dense_output"]
    ended.y[0, -1], ended.success = 1.0, False
    with pytest.raises(ArithmeticError):
        stiff_stage._radau(chain, state, 0.0, 1.0, 1e-6, gentle)
    ended.success = True
    assert stiff_stage._radau(chain, state, 0.0, 1.0, 1e-6, gentle) is ended


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(("beyond", "high", "wider"), [(0, 2.0, 1), (-1, 2.0, 4), (0, 0.9, 1)])
def test_the_part_of_a_stiff_stage_is_widened_until_its_margins_stay_at_rest(
    side: int, beyond: int, high: float, wider: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One site moves at its end, beside the margin on one side, or in it."""
    chain, margin, rest = VdpChain(a=4, b=0.5, c=0.6, sites=400), 2, 1e-6
    pad = stiff_stage._PAD * margin
    state = np.array([np.arange(400.0), np.zeros(400)])
    spans: list[tuple[float, float]] = []

    def solve(part: Any, x: Any, *given: Any) -> Any:
        begin, end, tolerance, gentle = given
        assert (part.sites, tolerance) == (x.shape[1], 1e-9)
        assert gentle == stiff_stage.MAX_STEPS - 7
        spans.append((begin, end))
        moves = x[0] == 200 + side * (pad - margin - beyond)
        y = np.zeros((2 * part.sites, 2))
        y[: part.sites, 1] = np.where(moves, high * rest, 0.0)
        return SimpleNamespace(t=np.array([begin, end]), y=y, sol="path")

    monkeypatch.setattr(stiff_stage, "_radau", solve)
    monkeypatch.setattr(stiff_stage, "_Gentle", lambda _, steps: steps)
    piece = stiff_stage.solve_stiff_piece(
        chain, state, (200, 201), 5.0, 6.0, 1e-9, rest, margin, steps_taken=7
    )
    assert (piece.first, piece.last) == (200 - wider * pad, 201 + wider * pad)
    assert piece.times.tolist() == [5.0, 6.0]
    assert set(spans) == {(5.0, 6.0)}  # the end of the run comes before that of a piece


def test_a_stiff_stage_that_begins_at_the_second_site_is_widened_to_the_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where the second one moves."""
    chain, rest, pad = VdpChain(a=4, b=0.5, c=0.6, sites=99), 1e-6, 2 * stiff_stage._PAD

    def solve(part: Any, x: Any, *_: Any) -> Any:
        y = np.zeros((2 * part.sites, 2))
        y[: part.sites, 1] = np.where(x[0] == 1.0, 2.0 * rest, 0.0)
        return SimpleNamespace(t=np.array([0.0, 1.0]), y=y, sol="path")

    monkeypatch.setattr(stiff_stage, "_radau", solve)
    state = np.array([np.arange(99.0), np.zeros(99)])
    piece = stiff_stage.solve_stiff_piece(
        chain, state, (pad + 1, pad + 2), 0.0, 1.0, 1e-9, rest, 2, steps_taken=0
    )
    assert (piece.first, piece.last) == (0, pad + 2 + 4 * pad)


def test_a_chain_without_an_implicit_method_says_that_it_is_too_stiff() -> None:
    chain = AveragedChain(a=4e4, b=1e8, c=0.6, sites=3)
    with pytest.raises(StandstillError, match="run \\(8\\), which has a stiff method"):
        simulate(chain, excite(chain, [1], 1e3), 1.0, samples=2)


@pytest.mark.parametrize("displacement", [300.0, 2000.0])
def test_a_chain_so_far_out_that_it_would_run_for_minutes_is_refused_at_once(
    displacement: float,
) -> None:
    """A damping rate of ε b y⁴ limits its steps, and y hardly changes until the end."""
    chain = OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.6, sites=3)
    start, taken = [[0.0, displacement, 0.0], [0.0, 0.0, 0.0]], []
    with pytest.raises(StandstillError, match="start from a smaller displacement, or end earlier"):
        simulate(chain, start, 30.0, samples=2, progress=taken.append)
    assert not taken  # it is refused before the first report
    soon = 3e5 / (chain.eps * 0.5 * displacement**4)  # after some 1e5 steps
    assert simulate(chain, start, soon, samples=2).states.shape == (2, 2, 3)


def test_a_stiff_run_is_not_refused_for_steps_that_soon_become_longer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """ẏ = -y³ from 1e3: at first steps are of some 1e-6, of which the end is 1e7 away."""
    monkeypatch.setattr(smooth_integration, "_PACE_STEPS", 10)
    monkeypatch.setattr(smooth_integration, "MAX_STIFF_STEPS", 1000)
    chain = OscillatorChain(damping=0, stiffness="y/1000 + y**3", overdamped=True, c=0.0, sites=2)
    start = [[1e3, 0.0], [0.0, 0.0]]
    run = SmoothIntegration(chain, start, np.array([10.0]), level=1.0)
    while not run.finished:
        run.advance(40)
        run.check_pace()
    assert run.samples[0, 0, 0] == pytest.approx(math.sqrt(1.0 / 20.0), rel=0.02)


_UNREFUSED_END = 412.75
"""End at which 0.4 of the steps ahead, of 1.25e-6 each from t = 100.25, are exactly 1e8."""


@pytest.mark.parametrize(
    ("end", "now", "refused"),
    [
        (_UNREFUSED_END + 0.01, (200_000, 100.25, -10.0), True),
        (_UNREFUSED_END, (200_000, 100.25, -10.0), False),
        (1e6, (99_999, 100.25, -10.0), False),  # too few for a pace
        (1e6, (100_000, 100.25, -10.0), True),
        (1e6, (200_000, 100.25, -10.001), True),  # by a fifth at t = 600
        (1e6, (200_000, 100.25, -10.002), False),  # at t = 350
        (1e6, (200_000, 100.25, -9.998), False),
        (1e8, (200_000, 200.0, -10.0), False),  # steps of 5e-4
        (100.0, (200_000, 100.0004, -10.0), False),  # beyond the end by rounding
    ],
)
@pytest.mark.parametrize("kind", ["free", "fixed", "watched"])
def test_a_run_is_refused_for_the_steps_that_it_still_needs_at_its_present_pace(
    end: float, now: tuple[int, float, float], refused: bool, kind: str
) -> None:
    """The steps are counted, and the time and size compared, since the pace was last measured.

    Never is one of given steps refused, nor one that a condition may end at any time.
    """
    taken, reached, size = now
    chain = OscillatorChain(damping=0, stiffness="y", overdamped=True, c=0.0, sites=2)
    step = 1e-6 if kind == "fixed" else None
    run = SmoothIntegration(chain, [[1.0, 0.0], [0.0, 0.0]], np.array([end]), level=1.0, step=step)
    run._watch = smooth.loop if kind == "watched" else None
    run._measured = (500_000, 100.0, 10.0)
    run._run.counters[smooth.STEPS] = 500_000 + taken
    run._run.clock[0] = reached
    run.state[0, 0] = size
    pace = f"{(reached - 100.0) / taken:.2g}"
    if refused and kind == "free":
        with pytest.raises(StandstillError, match=f"steps of some {pace}: start"):
            run.check_pace()
    else:
        run.check_pace()
    measured = kind == "free" and taken >= 100_000
    assert run._measured == ((500_000 + taken, reached, -size) if measured else (500_000, 100, 10))


def test_the_pace_of_a_run_is_first_measured_from_its_beginning() -> None:
    """Of 100 000 steps of 1e-6 each: 0.4 of those ahead are 1e8 at the end of 250.1."""
    chain = OscillatorChain(damping=0, stiffness="y", overdamped=True, c=0.0, sites=2)
    for end, refused in ((250.0, False), (250.2, True)):
        run = SmoothIntegration(chain, [[1.0, 0.0], [0.0, 0.0]], np.array([end]), level=1.0)
        run._run.counters[smooth.STEPS], run._run.clock[0] = 100_000, 0.1
        with pytest.raises(StandstillError) if refused else nullcontext():
            run.check_pace()


def test_the_step_of_an_oscillation_is_reviewed_after_a_period_and_of_its_envelope_always() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=3)
    full, averaged = (
        SmoothIntegration(each, np.zeros((2, 3)), [1.0])._task.review
        for each in (chain, chain.averaged())
    )
    assert averaged == 0.0
    assert 2.0 * math.pi < full < 2.2 * math.pi


@pytest.mark.parametrize(
    ("exponent", "others", "found", "error"),
    [
        (0.1, [0.2, 0.3], math.exp(0.1), math.exp(0.3) - math.exp(0.1)),
        (0.1, [0.4, 0.0], math.exp(0.1), math.exp(0.4) - math.exp(0.1)),
        (-0.5, [-0.7, -0.4], math.exp(-0.5), math.exp(-0.5) - math.exp(-0.7)),
        (-800.0, [-1.0], 0.0, math.exp(-1.0)),
        (1.0, [800.0], math.e, math.inf),
        (800.0, [1.0], None, None),
    ],
)
def test_a_multiplier_is_that_of_the_first_turn_and_as_uncertain_as_the_others_are_apart(
    exponent: float, others: list[float], found: float | None, error: float | None
) -> None:
    value, off = shooting._multiplier(exponent, *others)
    if found is None:
        assert value is off is None
    else:
        assert (value, off) == (pytest.approx(found, rel=1e-15), pytest.approx(error, rel=1e-12))


@pytest.mark.parametrize("end", [0.0, math.inf])
def test_that_cycles_exist_at_no_velocity_or_at_every_one_is_exact(end: float) -> None:
    assert _rounding_of_end(FrictionCell(), end, 1e-9) == 0.0


def test_a_multiplier_of_turns_that_agree_is_known_to_rounding() -> None:
    """Of the exponent and of its exponential."""
    for exponent in (2.0, -2.0):
        _, off = shooting._multiplier(exponent, exponent)
        assert off / (shooting.ROUNDING * math.exp(exponent)) == pytest.approx(3.0)


@pytest.mark.parametrize("parity", [1, -1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_parity_of_an_orbit_is_read_from_places_and_velocities(
    parity: int, sign: float
) -> None:
    y, v = np.array([0.1, 1.0, 0.1 * parity]), np.array([3.0, 0.5, 3.0 * parity])
    if parity == -1:
        y[1] = v[1] = 0.0
    orbits = Orbits(VdpChain(a=4, b=0.5, c=0.6, sites=3), Nucleus(1))
    for state in (np.concatenate([y, v]), np.concatenate([v, y])):
        assert orbits._parity(sign * state) == parity
        # At an edge a nucleus has no mirror image of its own, whatever its state.
        assert replace(orbits, nucleus=Nucleus(1, place=Place.EDGE))._parity(state) == 0


def test_of_several_seeds_the_range_of_escape_holds_every_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ends = {0: 0.19, 1: 0.2, 2: 0.21}

    def hold(chain: object, preparation: NucleusPreparation, c: float, duration: float) -> object:
        return SimpleNamespace(time=1.0, escaped=c > ends[preparation.seed])

    monkeypatch.setattr(escape, "hold", hold)
    noisy = NucleusPreparation(1, perturbation=1e-3)
    found = escape.escape_range(AveragedChain(a=2.5, b=0.5, c=0.0), noisy, 500.0, 1e-5)
    assert found.low <= ends[0]
    assert found.high >= ends[2]
    assert found.error == pytest.approx(0.01, abs=1e-4)  # half of what the seeds are apart
    assert found.monotone


@pytest.mark.parametrize("law", [1.0, 2.0])
@pytest.mark.parametrize("end", [0.19, 0.1901234, 0.1907])
@pytest.mark.parametrize("constant", [1e-6, 1e-5, 1e-4])
def test_the_error_of_a_range_of_escape_reaches_to_where_escapes_of_any_duration_end(
    law: float, end: float, constant: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Times of escape as near a fold, (c - end)^(-1/2), or a loss of stability, 1/(c - end)."""
    duration = 500.0

    def hold(_: object, __: object, c: float, length: float) -> object:
        time = duration * (constant / (c - end)) ** (1.0 / law) if c > end else math.inf
        return SimpleNamespace(time=min(time, length), escaped=time <= length)

    monkeypatch.setattr(escape, "hold", hold)
    chain, once = AveragedChain(a=2.5, b=0.5, c=0.0), NucleusPreparation(1)
    for tolerance in (1e-5, 3e-5, 1e-4):
        found = escape.escape_range(chain, once, duration, tolerance)
        assert abs(found.c_crit - end) <= found.error
        assert found.error <= 3.0 * ((2**law - 1) * constant + 2.0 * tolerance)
        found = escape.escape_threshold(chain, once, duration=duration, tolerance=tolerance)
        assert abs(found.c_crit - end) <= found.error


def test_escapes_at_some_time_from_an_irregular_motion_widen_the_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From 0.19 on escapes are soon; from 0.1895 on they take more than the duration."""
    duration = 500.0

    def hold(_: object, __: object, c: float, length: float) -> object:
        time = 0.1 * duration if c > 0.19 else 1.5 * duration if c > 0.1895 else math.inf
        return SimpleNamespace(time=min(time, length), escaped=time <= length)

    monkeypatch.setattr(escape, "hold", hold)
    chain = AveragedChain(a=2.5, b=0.5, c=0.0)
    found = escape.escape_range(chain, NucleusPreparation(1), duration, 1e-5)
    assert found.c_crit == pytest.approx(0.19, abs=1e-5)
    assert 5e-4 < found.error < 1.1e-3  # the distances of the runs are doubled
    assert found.runs > 20 + 8


@pytest.mark.parametrize(
    ("xi", "viscous", "end"),
    [(50.0, 0.0, 2.0), (1.0, 98.0, 10.0), (50.0, 0.0, 0.9), (0.05, 0.0, 2.0), (0.05, 0.0, 0.5)],
)
def test_round_off_of_an_end_of_cycles_is_that_of_the_release_over_a_strong_damping(
    xi: float, viscous: float, end: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Slip that falls steeply with the velocity adds nothing; 2ξ + κ is 100, or counts as 1."""
    cell = FrictionCell(xi=xi, viscous=viscous)
    steep = "verification.cells.friction.largest_after_release"
    monkeypatch.setattr(steep, lambda at, _: -1e9 * at.v_d)
    release = abs(replace(cell, v_d=end).release)
    found = _rounding_of_end(cell, end, 1e-9)
    drag = 100.0 if xi >= 1.0 else 1.0
    assert found / ROUND_OFF == pytest.approx(max(end, (end + release) / drag), rel=1e-12)


def test_the_velocity_through_disorder_is_as_near_as_it_says() -> None:
    """Times from site to site that vary by 0.3 about a mean of 1; v is 1.

    Three times a deviation that is itself found from eight blocks is exceeded by one case in fifty
    (Student's distribution of seven degrees of freedom), and by twice as many in a bad draw of 200.
    """
    steps = np.random.default_rng(0).normal(1.0, 0.3, (200, 160))
    found = [(velocity_of_arrivals(each)[0], error_by_disorder(each)) for each in steps.cumsum(1)]
    assert sum(abs(v - 1.0) > error for v, error in found) <= 8
    assert max(error for _, error in found) < 0.3


@pytest.mark.parametrize("length", [1, 2, 5])
def test_the_error_through_disorder_is_found_from_the_durations_of_eight_blocks(
    length: int,
) -> None:
    """Of durations of which two differ by 2 from the others the variance is 8/7.

    The site beyond the eight blocks is reached later than any other.
    """
    blocks = 2.0 * length + np.array([0.0, 0.0, 2.0, 0.0, -2.0, 0.0, 0.0, 0.0])
    durations = np.append(np.repeat(blocks / length, length), 9.0)
    late = np.append(0.0, durations.cumsum())
    before = late[:-1] - late[-1]  # the half that is not used
    slope = linregress(np.arange(late.size), late).slope
    error = 3.0 * math.sqrt(1.2 * (8.0 / 7.0) / length / late.size) / slope**2
    assert error_by_disorder(np.concatenate([before, late])) == pytest.approx(error, rel=1e-9)


def test_of_sites_reached_at_once_or_of_fewer_than_eight_blocks_disorder_leaves_no_velocity() -> (
    None
):
    assert error_by_disorder(np.zeros(32)) == math.inf
    assert error_by_disorder(np.arange(16.0)) == math.inf
    assert error_by_disorder(np.arange(17.0)) == 0.0


def test_a_front_through_disorder_has_that_error() -> None:
    chain = fr.OscillatorChain(
        damping="0", stiffness="a*y*(1-y)*(0.3-y)", overdamped=True, values={"a": 1.0}, eps=1.0,
        c=2.0, coupling="next-nearest:1,1", disorder={"a": "uniform:0.6"}, seed=4,
    )  # fmt: skip
    found = fr.measure_front(chain, accuracy=0.1, max_sites=120)
    assert found.error is not None
    assert found.error >= error_by_disorder(found.arrivals) > 0.0
