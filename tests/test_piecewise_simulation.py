"""Claims about the direct simulation of the piecewise-linear front (Eq. 44)."""

from __future__ import annotations

import copy
import math
import time
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar
from scipy.special import jv

from fronts.cli import main
from theory.parameters import ParameterError
from verification.fronts.status import FrontStatus
from verification.piecewise import chain as piecewise_chain
from verification.piecewise import crossing, simulation, verdict
from verification.piecewise import window as piecewise_window
from verification.piecewise.chain import PiecewiseMotion, Switching
from verification.piecewise.crossing import FirstZero, first_zero
from verification.piecewise.simulation import SMALLEST_ETA, hysteresis, simulate_front
from verification.piecewise.window import (
    ChainState,
    starting_velocity,
    static_state,
    step_state,
    switching_amplitude,
    travelling_state,
    truncation_bound,
    widened,
)
from verification.references.equations import piecewise_rate

# (c, eta): from just above depinning through the ordinary to the fast and the large-c island
STEADY = [(0.47, 0.03125), (0.5, 0.03125), (0.7, 0.03125), (1.0, 0.03125), (2.2, 0.03125)]
STEADY += [(12.0, 0.03125), (0.3, 0.02), (3.0, 0.02), (0.01, 1e-5), (1.0, 0.005), (2.79, 0.06)]
RETREATING = [(2.0, 0.11), (10.0, 0.1), (1.5, 0.12)]


def ratio(eta: float) -> float:
    return math.sqrt(8 * eta) / (1 + math.sqrt(1 - 8 * eta))


def kinetic_sum(v: float, c: float) -> complex:
    """Sigma(v, c) by the midpoint rule on the periodised integral; geometric, 6000 points."""
    k = 2 * np.pi * (np.arange(6000) + 0.5) / 6000
    A = 0.5 - 1j * c * (1 - np.cos(k))
    decay = np.exp(-A / abs(v))
    kernel = (1 - decay**2) / (1 + decay**2 - 2 * decay * np.cos(k))
    return complex(-1 + np.sign(v) * np.mean(kernel / (2 * A)))


def kinetic_velocity(near: float, c: float, eta: float) -> float:
    """Return the root of |Sigma| = 2 r within one part in a thousand of ``near``."""

    def excess(v: float) -> float:
        return abs(kinetic_sum(v, c)) - 2 * ratio(eta)

    return brentq(excess, 0.999 * near, 1.001 * near, xtol=1e-16 * abs(near), rtol=9e-16)


@pytest.mark.parametrize(("c", "eta"), STEADY + RETREATING)
def test_a_steady_front_moves_at_the_kinetic_velocity_within_its_error(c, eta):
    run = simulate_front(c, eta)
    assert run.steady
    assert run.events_per_site == 1
    assert (run.v < 0) == ((c, eta) in RETREATING)
    difference = abs(run.v - kinetic_velocity(run.v, c, eta))
    assert difference < 1e-11 * abs(run.v)  # ten times the tolerance on the period
    # the reference itself is good to some units of round-off in Sigma over its slope
    assert difference <= run.error + 4e-15 * abs(run.v)


def test_over_random_scenes_a_steady_claim_is_never_wrong():
    seed = 771
    rng = np.random.default_rng(seed)
    steady = 0
    for _ in range(40):
        c, eta = float(np.exp(rng.uniform(-1.5, 1.5))), float(rng.uniform(0.003, 0.12))
        run = simulate_front(c, eta, str(rng.choice(["moving", "resting", "step"])))
        if run.steady and run.events_per_site == 1:
            steady += 1
            difference = abs(run.v - kinetic_velocity(run.v, c, eta))
            # the second part is the round-off of the reference
            assert difference <= run.error + 4e-15 * abs(run.v), (seed, c, eta)
    assert steady >= 10, seed


def crossings_by_runge_kutta(c, r, phi, count, longest_step):
    """Integrate a chain with fixed ends, stopping at the first site that leaves its side."""
    on = np.abs(phi) > r
    time, found, latest = 0.0, [], None
    while len(found) < count:
        keep = np.ones(len(phi), bool)
        if latest is not None:
            keep[latest] = False  # stands at r: let it move off before watching it again
        side = np.where(on, 1.0, -1.0)

        def leaves(_, y, side=side, keep=keep):
            return float(np.min((side * (np.abs(y) - r))[keep]))

        leaves.terminal, leaves.direction = True, -1
        end = time + longest_step if latest is not None else 1e3
        result = solve_ivp(
            piecewise_rate(c, on, 1.0, 0.0), (time, end), phi, method="DOP853",
            rtol=1e-12, atol=1e-14, events=leaves, max_step=longest_step,
        )  # fmt: skip
        time, phi = float(result.t[-1]), result.y[:, -1]
        if result.status == 1:
            latest = int(np.argmin(np.where(keep, side * (np.abs(phi) - r), np.inf)))
            on[latest] = not on[latest]
            found.append((time, latest, 1 if on[latest] else -1))
        else:
            latest = None
    return found


def crossings_by_chain(c, r, state, count):
    chain, time, found = PiecewiseMotion(c, r, state), 0.0, []
    for _ in range(count):
        step = chain.advance(1e3)
        assert isinstance(step, Switching)
        time += step.wait
        found.append((time, step.site - state.origin, step.direction))
    return found


@pytest.mark.parametrize(
    ("c", "eta", "start", "count"),
    [(0.5, 0.03125, "step", 6), (2.5, 0.03125, "moving", 12), (10.0, 0.03125, "unsettled", 25)],
)
def test_crossings_agree_with_a_runge_kutta_integration(c, eta, start, count):
    if start == "step":
        state = step_state(96)
    elif start == "moving":
        state = travelling_state(c, 1.4, 336)
    else:  # sites cross five times each here, close together
        state = simulate_front(c, eta, max_sites=100).final
        state = ChainState(state.phi, state.origin)
    ours = crossings_by_chain(c, ratio(eta), state, count)
    theirs = crossings_by_runge_kutta(c, ratio(eta), state.phi, count, 0.02)
    assert [event[1:] for event in ours] == [event[1:] for event in theirs]
    if start == "unsettled":
        assert {event[2] for event in ours} == {1, -1}
    # the Runge-Kutta run is asked for 1e-12 a step; flat crossings magnify its error
    assert max(abs(a[0] - b[0]) for a, b in zip(ours, theirs, strict=True)) < 1e-9


@pytest.mark.parametrize(("c", "eta"), [(0.5, 0.03125), (2.5, 0.03125)])
def test_a_moving_window_gives_the_times_of_a_long_fixed_chain(c, eta):
    v, count = (0.31, 60) if c < 1 else (1.3, 60)
    moving = simulate_front(c, eta, travelling_state(c, v, 400), max_sites=80)
    long = widened(travelling_state(c, v, 400), 4000)
    fixed = crossings_by_chain(c, ratio(eta), long, count)
    times = np.array([time for time, _, _ in fixed])
    # absolute times up to 200, added from rounded waits
    assert np.max(np.abs(times - moving.crossing_times[:count])) < 1e-11


@pytest.mark.parametrize(("c", "v"), [(0.1, 0.02), (0.5, 0.3), (3.0, 1.4), (0.5, -0.4), (1.0, 5.0)])
def test_the_truncation_bound_bounds_the_window_error(c, v):
    for sites in (32, 48, 64):
        short, long = travelling_state(c, v, sites), travelling_state(c, v, 4096)
        around = slice(-3 - short.origin, 4 - short.origin)
        exact = long.phi[-3 - long.origin : 4 - long.origin]
        error = np.max(np.abs(short.phi[around] - exact))
        # images of the sites four from the front are four sites nearer; 1e-13 is round-off
        assert error <= truncation_bound(c, v, sites - 4) + 1e-13


@pytest.mark.parametrize(("c", "v", "distance"), [(1e-3, 0.1, 4), (0.1, 0.3, 4), (0.01, 1.0, 16)])
def test_images_disturb_within_a_hundred_of_the_truncation_bound(c, v, distance):
    """φ and 1 - φ at the distances of the images, from the sites crossed before: no window.

    1 - φ of a front that advances, seen from the other side, is φ of one that retreats.
    """

    def from_bessel_functions(zeta):
        node, weight = np.polynomial.legendre.leggauss(200)
        total = 0j
        for m in range(math.floor(zeta) + 1, 60):  # J_m(cs) is nothing there for cs ≤ 7
            half = 0.5 * min((m - zeta) / v, 70.0)
            s = half * (node + 1)
            waves = np.exp((-0.5 + 1j * c) * s) * jv(abs(m), c * s)
            total += (-1j) ** (abs(m) % 4) * half * np.sum(weight * waves)
        return 0.5 * total

    images = [from_bessel_functions(j * distance) for j in (1, 2, 3)]
    images += [from_bessel_functions(-j * distance) - 1 for j in (1, 2, 3)]
    bound = truncation_bound(c, v, distance)
    assert 0.01 * bound < abs(sum(images)) <= bound
    assert truncation_bound(c, -v, distance) == bound


@pytest.mark.parametrize(
    ("c", "v"), [(0.5, 0.3), (3.0, 1.4), (0.5, -0.4), (2.0, -0.5), (10.0, -5.0)]
)
def test_a_wave_switches_a_site_at_half_of_sigma_whatever_its_velocity(c, v):
    amplitude = switching_amplitude(c, v)
    assert amplitude == pytest.approx(abs(kinetic_sum(v, c)) / 2, abs=1e-9)  # that of the window


@pytest.mark.parametrize("distance", [1, 3, 10])
@pytest.mark.parametrize(("c", "v"), [(0.5, 0.3), (10.0, -2.0)])
def test_the_truncation_bound_is_a_sum_over_images_each_weaker_than_the_one_before(c, v, distance):
    s = brentq(lambda s: c * math.sinh(s) + abs(v) * s - 15 / 32, 0.0, 5.0, xtol=1e-15)
    images = math.fsum(math.exp(-j * s * distance) for j in range(1, 10_000))
    far = 100 / s  # where the first one is all
    expected = images * math.exp(s * far) * truncation_bound(c, v, far)
    assert truncation_bound(c, v, distance) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("c", "v"), [(0.5, 0.3), (3.0, 1.4), (0.5, -0.4), (2.0, -0.5)])
def test_a_wave_switches_each_period_and_first_after_half_of_one(c, v):
    chain = PiecewiseMotion(c, abs(kinetic_sum(v, c)) / 2, travelling_state(c, v, 512))
    steps = [chain.advance(1e3) for _ in range(4)]
    assert [step.direction for step in steps] == [math.copysign(1, v)] * 4
    assert [step.site for step in steps] == ([1, 2, 3, 4] if v > 0 else [0, -1, -2, -3])
    waits = [step.wait * abs(v) for step in steps]
    assert waits == pytest.approx([0.5, 1, 1, 1], abs=1e-12)


@pytest.mark.parametrize(
    ("c", "eta"),
    [
        (0.46, 0.03125), (0.5, 0.03125), (1.0, 0.005), (12.0, 0.03125), (2.0, 0.11), (10.0, 0.1),
        (60.0, 0.1),
    ],
)  # fmt: skip
def test_a_moving_start_is_a_little_faster_than_the_fastest_wave_that_fits(c, eta):
    v = starting_velocity(c, ratio(eta))
    excess = [abs(kinetic_sum(v / 1.05 * part, c)) - 2 * ratio(eta) for part in (0.99, 1.01)]
    assert excess[0] * excess[1] < 0
    faster = [abs(kinetic_sum(v * part, c)) - 2 * ratio(eta) for part in np.geomspace(1, 5, 30)]
    assert len(set(np.sign(faster))) == 1
    state = simulation._start_state(c, ratio(eta), "moving", None)
    assert np.array_equal(state.phi, travelling_state(c, v, len(state.phi)).phi)


@pytest.mark.parametrize(("c", "eta"), [(0.1, 0.1), (0.3, 0.05)])
def test_where_no_wave_fits_the_start_is_the_advancing_one_that_comes_nearest(c, eta):
    v = starting_velocity(c, ratio(eta))
    assert v > 0
    tried = np.geomspace(0.05, 6.0, 200) * c / (1 + 0.3 * math.sqrt(c))
    off = [abs(kinetic_sum(u, c)) - 2 * ratio(eta) for u in tried]
    assert len(set(np.sign(off))) == 1
    assert abs(abs(kinetic_sum(v, c)) - 2 * ratio(eta)) <= 1.01 * min(map(abs, off))


@pytest.mark.parametrize("v", [0.0, 1e-3, -0.7, 40.0])
@pytest.mark.parametrize("c", [1e-6, 1e-4, 0.02, 0.5, 30.0, 1e3])
def test_the_tails_of_a_front_decay_at_the_rate_of_its_strip(c, v):
    s = piecewise_window.decay_rate(c, v)
    assert c * math.sinh(s) + abs(v) * s == pytest.approx(15 / 32, rel=1e-13)


def test_a_start_at_the_kinetic_velocity_stays_on_it():
    v = kinetic_velocity(0.300992, 0.5, 0.03125)
    run = simulate_front(0.5, 0.03125, start_velocity=v, max_sites=80)
    waits = np.arange(run.crossing_times.size) + 0.5  # from the middle between two switchings
    assert run.crossing_times * v == pytest.approx(waits, rel=1e-11)


@pytest.mark.parametrize("sites", [-37, -1, 0, 1, 5])
def test_a_window_moved_or_widened_shows_the_same_chain(sites):
    chain = PiecewiseMotion(3.0, 0.4, travelling_state(3.0, 1.4, 256))
    for _ in range(3):
        chain.advance(1e3)
    before = chain.state()
    chain._relay[before.latest] = 1e-3
    chain.shift(sites)
    after = chain.state()
    assert after.origin == before.origin + sites
    assert np.flatnonzero(chain._relay).tolist() == [after.latest]  # it is that of the same site
    for changed in (after, widened(before, 300), widened(before, 301)):
        first = max(before.origin, changed.origin)
        last = min(before.origin + 256, changed.origin + len(changed.phi))
        assert last - first >= 219
        seen, was = (slice(first - each.origin, last - each.origin) for each in (changed, before))
        # the ring repeats the front beyond the window, one equilibrium lower
        assert np.abs(changed.phi[seen] - before.phi[was]).max() < 1e-12
        assert (changed.on[seen] == before.on[was]).all()
        assert changed.latest + changed.origin == before.latest + before.origin
        assert changed.on[: first - changed.origin].all()
        assert not changed.on[last - changed.origin :].any()
        assert np.abs(changed.phi[: first - changed.origin] - 1).max(initial=0.0) < 1e-6
        assert np.abs(changed.phi[last - changed.origin :]).max(initial=0.0) < 1e-6
    assert [len(widened(before, asked).phi) for asked in (100, 300, 301)] == [256, 300, 301]


def test_round_off_moves_a_crossing_by_its_size_over_the_rate_of_the_modulus():
    """The rate is that of (44) just before; each jitter times it is one number of round-off."""
    products = []
    for c, v in ((0.5, 0.3), (3.0, 1.4), (2.0, -1.7), (0.05, 0.02)):
        r = switching_amplitude(c, v)
        chain = PiecewiseMotion(c, r, travelling_state(c, v, 400))
        step = chain.advance(1e3)
        state = chain.state()
        on = state.on.copy()
        on[state.latest] = step.direction < 0
        phi, at = state.phi, state.latest
        rate = piecewise_rate(c, on, 1.0, 0.0)(0.0, phi)[at]
        products.append(step.jitter * abs((phi[at].conjugate() * rate).real) / abs(phi[at]))
        assert not step.sliding
    assert products == pytest.approx([products[0]] * 4, rel=1e-6)
    assert 2e-16 < products[0] < 1e-14


@pytest.mark.parametrize("c", [0.5, 5.0, 50.0])
def test_a_site_stands_at_the_threshold_when_it_switches(c):
    """To round-off, however rough the state: where it switches is found from a Taylor sum."""
    rng = np.random.default_rng(3)
    rough = np.exp(-(((np.arange(64) - 32) / 8) ** 2)) * rng.normal(size=(2, 64))
    state = step_state(64)
    chain = PiecewiseMotion(c, 0.5, ChainState(state.phi + 0.3 * (rough[0] + 1j * rough[1])))
    for _ in range(20):
        step = chain.advance(1e3)
        if isinstance(step, Switching) and not step.sliding:
            after = chain.state()
            assert abs(abs(after.phi[after.latest]) - 0.5) < 2e-15
            assert after.latest == step.site  # of a state that says nothing else, counted from 0


def test_a_site_that_slides_switches_with_a_relay_for_as_long_as_it_is_at_the_threshold():
    """It is 1e-4 wide, of r²; a switching that does not slide leaves those of other sites."""
    c, r = 5.0, ratio(0.005)
    chain = PiecewiseMotion(c, r, travelling_state(c, starting_velocity(c, r), 512))
    slid = set()
    for _ in range(80):
        step = chain.advance(1e3)
        after = chain.state()
        past = np.abs(after.phi) ** 2 / r**2 - 1
        expected = 1e-4 * step.direction if step.site in slid else 0.0
        assert past[after.latest] == pytest.approx(expected, abs=1e-9)
        assert not chain._relay[np.abs(past) > 4e-4].any()
        (slid.add if step.sliding else slid.discard)(step.site)
    assert len(slid) > 20
    front = PiecewiseMotion(0.5, 0.5, travelling_state(0.5, 0.3, 128))
    front._relay[5], front._relaying = 1e-4, True
    assert not front._switch(40, 0.0, 0.0).sliding
    assert front._relaying


def test_near_tangencies_of_all_sites_are_counted(monkeypatch):
    asked = []

    def grazing(*given):
        asked.append(given)
        found = first_zero(*given)
        return FirstZero(found.at, found.grazes + 1)

    monkeypatch.setattr(piecewise_chain, "first_zero", grazing)
    chain = PiecewiseMotion(0.5, ratio(0.03125), step_state(96))
    for _ in range(5):
        chain.advance(1e3)
    assert chain.grazes == len(asked) > 0


def test_a_clean_front_grazes_nothing():
    """A site that has just crossed stands at r, which is no near tangency."""
    assert simulate_front(0.5, 0.03125).grazes == 0


def test_what_is_ruled_out_in_crowded_intervals_would_not_have_crossed(monkeypatch):
    """The bound on each site leaves the crossings as they are, where every interval asks it."""
    state = simulate_front(10.0, 0.03125, max_sites=100).final
    found = []
    for many in (0, 10**6):
        monkeypatch.setattr(piecewise_chain, "_MANY", many)
        found.append(crossings_by_chain(10.0, ratio(0.03125), state, 60))
    assert [each[1:] for each in found[0]] == [each[1:] for each in found[1]]
    times = [np.array([each[0] for each in some]) for some in found]
    assert np.abs(times[0] - times[1]).max() < 1e-13


@pytest.mark.parametrize("scale", [2.0**-60, 2.0**60])
@pytest.mark.parametrize("stretch", [2.0**-20, 2.0**20])
def test_a_zero_scales_with_its_polynomial(scale, stretch):
    """p(x) → λ p(x/μ): to the last bit, near tangencies included, since λ and μ are powers of 2."""
    rng = np.random.default_rng(5)
    touches = [[0.1875, -1.0, 1.75, -1.0], [0.25 + 1e-16, -1.0, 1.0], [0.25 - 1e-15, -1.0, 1.0]]
    touches += [[0.25 + 1e-9, -1.0, 1.0], [-1.0, 1.0], [0.0, 1.0, -2.0]]
    touches += [
        np.polynomial.polynomial.polyfromroots(rng.uniform(-1.0, 1.0, 4)).tolist()
        for _ in range(20)
    ]
    for p in touches:
        found = first_zero(p, 1.0)
        scaled = [scale * a / stretch**j for j, a in enumerate(p)]
        other = first_zero(scaled, stretch)
        assert other.grazes == found.grazes
        assert other.at == (None if found.at is None else stretch * found.at)


def test_a_zero_at_the_end_of_the_interval_belongs_to_it():
    assert first_zero([1.0, -1.0], 1.0).at == 1.0


def test_a_zero_from_which_the_polynomial_rises_is_a_touch():
    """Of x - 2x² the first crossing is at 1/2."""
    found = first_zero([0.0, 1.0, -2.0], 1.0)
    assert found.at == pytest.approx(0.5, rel=1e-12)
    assert found.grazes == 1


def test_a_zero_beyond_the_end_of_the_interval_by_some_roundings_is_none():
    """That of (z - x)(w - x), z > 1: near it the polynomial is below round-off before the end."""
    for parts in range(1, 8):
        for other in np.linspace(1.1, 4.0, 50).tolist():
            z = 1.0 + parts * 2.0**-52
            found = first_zero([z * other, -(z + other), 1.0], 1.0)
            assert found.at is None or 1.0 - 1e-14 < found.at <= 1.0
            assert found.grazes in (0, 1)


def test_a_search_that_is_given_up_counts_every_touch(monkeypatch):
    """Of (x - 1/2)^2 (3/4 - x): past 1/2 it touches again as long as steps are left."""
    monkeypatch.setattr(crossing, "_MAX_STEPS", 100)
    found = first_zero([0.1875, -1.0, 1.75, -1.0], 1.0)
    assert found.at == pytest.approx(0.5, abs=1e-3)
    assert found.grazes > 2
    monkeypatch.setattr(crossing, "_MAX_STEPS", 0)
    assert first_zero([1.0, -1.0], 1.0) == FirstZero(0.0, 1)  # where it is given up is one


def test_a_start_of_ones_own_has_32_sites_or_more():
    for sites in (32, 33):
        given = piecewise_window.step_state(sites)
        assert simulation._start_state(0.5, 0.4, given, None) is given
    with pytest.raises(ParameterError, match="31 sites"):
        simulation._start_state(0.5, 0.4, piecewise_window.step_state(31), None)


@pytest.mark.parametrize("part", [1.0, -1.0, 1j, -1j])
@pytest.mark.parametrize("end", [0, -1])
def test_a_start_of_ones_own_has_both_equilibria_at_its_ends(end, part):
    for off, refused in ((0.9e-3, False), (1.5e-3, True)):
        given = step_state(64)
        given.phi[end] += off * part
        with pytest.raises(ParameterError, match=r"end 0\.0015 off") if refused else nullcontext():
            assert simulation._start_state(0.5, 0.4, given, None) is given
    given.phi[20] = math.nan * part
    with pytest.raises(ParameterError, match="finite"):
        simulation._start_state(0.5, 0.4, given, None)


def test_the_smallest_coupling_of_a_simulation_is_allowed() -> None:
    """Below it the decay of a tail to the next site, about 1/2c, is soon no finite number."""
    assert simulation._coupling(1e-300) == 1e-300
    with pytest.raises(ParameterError, match="at least 1e-300"):
        simulation._coupling(0.999e-300)


def test_the_smallest_eta_of_a_simulation_is_allowed() -> None:
    assert simulation._threshold(1e-8) == pytest.approx(ratio(1e-8), rel=1e-12)
    with pytest.raises(ParameterError, match="at least 1e-8"):
        simulation._threshold(0.999e-8)


def test_a_polynomial_below_zero_from_the_start_is_there_at_once():
    assert first_zero([-1.0, 1.0], 2.0).at == 0.0


@pytest.mark.parametrize("power", range(20, 47, 2))
def test_a_shallow_zero_is_found_to_round_off_over_its_slope(power):
    """(x - ½)² = δ, all numbers exact; to some parts in 1e16 of its terms over 2√δ."""
    deep = 2.0**-power
    found = first_zero([0.25 - deep, -1.0, 1.0], 1.0)
    assert abs(found.at - (0.5 - math.sqrt(deep))) <= 1e-16 / math.sqrt(deep)


def test_a_zero_without_a_slope_is_found_where_the_polynomial_is_surely_below():
    for p, at in (([0.125, -0.75, 1.5, -1.0], 0.5), ([0.0, 0.0, -1.0], 0.0)):  # (½ - x)³, -x²
        found = first_zero(p, 1.0)
        assert found.at == pytest.approx(at, abs=1e-3)
        assert found.grazes >= 1


def test_no_zero_is_missed_by_the_polynomial_search():
    seed = 20240607
    rng = np.random.default_rng(seed)
    hits = 0
    for _ in range(300):
        inside = rng.uniform(0, 1.2, rng.integers(0, 4))
        if rng.random() < 0.4:  # a pair so close that a coarse sampling would step over it
            inside = np.append(inside, rng.uniform(0.1, 0.9) + np.array([0.0, 1e-4]))
        outside = rng.uniform(-3, -1, 2)
        p = np.polynomial.polynomial.polyfromroots(np.concatenate([inside, outside]))
        p = p * np.sign(p[0])
        first = min((x for x in inside if x < 1 - 1e-9), default=None)
        got = first_zero(p.tolist(), 1.0).at
        if first is None:
            assert got is None or got > 1 - 1e-9, seed
        else:
            hits += 1
            # a fifth of the closest gap: the first of a pair, not the second; where other
            # roots are near, round-off moves a pair by more than 1e-6
            assert got == pytest.approx(first, abs=2e-5), seed
    assert hits > 100


def test_a_touch_without_a_crossing_is_passed_and_counted():
    # (x - 1/2)^2 (3/4 - x), exact in binary
    found = first_zero([0.1875, -1.0, 1.75, -1.0], 1.0)
    assert found.at == pytest.approx(0.75, abs=1e-12)
    assert found.grazes >= 1


def test_a_touch_is_counted_once_and_does_not_cross():
    """Of (x - 1/2)^2 the bound on the second derivative is that derivative: one step passes it."""
    assert first_zero([0.25, -1.0, 1.0], 1.0) == FirstZero(None, 1)


@pytest.mark.parametrize("excess", [1e-4, 1e-6, 1e-8])
def test_a_site_that_barely_overshoots_the_threshold_is_caught(excess):
    # |phi_1| of a relaxing step rises to a maximum and falls again; r lies just below it
    c, sites, front = 0.4, 121, 60
    matrix = (1j * c - 0.5) * np.eye(sites) - 0.5j * c * (np.eye(sites, k=1) + np.eye(sites, k=-1))
    on = (np.arange(sites) <= front).astype(complex)
    force = 0.5 * on
    force[0] -= 0.5j * c
    balance = np.linalg.solve(matrix, -force)
    rates, modes = np.linalg.eig(matrix)
    weights = modes[front + 1] * np.linalg.solve(modes, on - balance)

    def modulus(time):
        return abs(balance[front + 1] + np.sum(weights * np.exp(rates * time)))

    top = minimize_scalar(lambda t: -modulus(t), bounds=(1, 8), options={"xatol": 1e-10}).x
    r = modulus(top) * (1 - excess)
    expected = brentq(lambda t: modulus(t) - r, 0.5 * top, top, xtol=1e-13)
    step = PiecewiseMotion(c, r, step_state(96)).advance(1e3)
    assert isinstance(step, Switching)
    assert (step.site, step.direction) == (1, 1)
    # the slope there is about sqrt(excess), so 1e-15 in phi moves the time by some 1e-11
    assert step.wait == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("c", [0.05, 0.3, 0.44])
def test_a_pinned_front_is_the_static_balance_and_its_margin_is_right(c):
    run = simulate_front(c, 0.03125, "resting")
    assert (run.status, run.v, run.error, run.steady) == (FrontStatus.PINNED, 0.0, 0.0, False)
    sites, front = 121, 60
    matrix = (1j * c - 0.5) * np.eye(sites) - 0.5j * c * (np.eye(sites, k=1) + np.eye(sites, k=-1))
    force = -0.5 * (np.arange(sites) <= front).astype(complex)
    force[0] += 0.5j * c  # the neighbour on the left is 1
    phi = np.linalg.solve(matrix, force)
    gaps = (np.abs(phi) - ratio(0.03125)) * np.where(np.arange(sites) <= front, 1, -1)
    assert run.margin == pytest.approx(gaps.min(), abs=1e-13)  # both solved to round-off


def test_between_fold_and_depinning_the_start_decides():
    # eta = 0.03125: |1 - 1/sqrt(1 - 4ic)| = 2r at c = 0.45530; the upper branches end at 0.43378
    runs = hysteresis(0.03125, [0.46, 0.4552, 0.445, 0.435, 0.43])
    assert [run.status.value for run in runs.moving] == ["steady"] * 4 + ["pinned"]
    assert [run.status.value for run in runs.resting] == ["steady"] + ["pinned"] * 4
    for c, run in zip(runs.couplings[:4], runs.moving[:4], strict=True):
        assert abs(run.v - kinetic_velocity(run.v, c, 0.03125)) < 1e-11
    assert runs.moving[3].v < runs.moving[0].v


def test_each_moving_run_continues_from_the_one_at_the_next_higher_coupling(monkeypatch):
    def run(c, eta, start):
        return SimpleNamespace(given=(c, eta, start), final=("the end at", c))

    monkeypatch.setattr(simulation, "simulate_front", run)
    found = hysteresis(0.03, [0.3, 0.5, 0.4])
    assert [each.given for each in found.moving] == [
        (0.5, 0.03, "moving"), (0.4, 0.03, ("the end at", 0.5)), (0.3, 0.03, ("the end at", 0.4)),
    ]  # fmt: skip
    assert [each.given for each in found.resting] == [(c, 0.03, "resting") for c in (0.5, 0.4, 0.3)]


@pytest.mark.parametrize(("c", "repeat"), [(2.5, 6), (4.0, 3), (6.0, 2)])
def test_motion_that_does_not_settle_is_reported_with_its_repeat(c, repeat):
    run = simulate_front(c, 0.03125)
    assert (run.status, run.steady, run.repeat) == (FrontStatus.UNSTEADY, False, repeat)
    assert run.period_spread > 0.1
    waits = np.diff(run.crossing_times)
    assert np.ptp(waits[-60:]) > 0.1 * waits[-60:].mean()


def test_an_unstable_front_started_on_its_velocity_still_leaves_it():
    v = kinetic_velocity(1.5134334, 4.0, 0.03125)
    run = simulate_front(4.0, 0.03125, start_velocity=v * (1 + 1e-4))
    assert run.status is FrontStatus.UNSTEADY
    assert abs(run.v - v) > 0.01


def test_slow_settling_is_named_and_its_error_bounds_the_true_one():
    v = kinetic_velocity(1.289527, 2.38, 0.03125)
    run = simulate_front(2.38, 0.03125, start_velocity=1.0005 * v)
    assert run.status is FrontStatus.SETTLING
    assert not run.steady
    assert abs(run.v - v) <= run.error < 1e-6


def test_sliding_is_named_and_its_error_covers_the_choice_of_relay(monkeypatch):
    runs = []
    for relay in (1e-3, 1e-4, 3e-5):
        monkeypatch.setattr(piecewise_chain, "_RELAY", relay)
        runs.append(simulate_front(5.0, 0.005))
    assert {run.status for run in runs} == {FrontStatus.SLIDING}
    assert max(run.v for run in runs) - min(run.v for run in runs) < runs[1].error


def test_a_run_goes_on_from_the_end_of_another():
    first = simulate_front(0.6, 0.03125)
    again = simulate_front(0.6, 0.03125, first.final)
    assert again.v == pytest.approx(first.v, rel=1e-13)  # ten units of round-off a period
    assert again.final.origin >= first.final.origin


@pytest.mark.parametrize("sites", [48, 64])
def test_a_resting_start_has_its_last_site_with_the_force_at_zero(sites):
    state = static_state(0.2, sites)
    size = np.abs(state.phi)
    assert size[-state.origin] > 0.5 > size[1 - state.origin]


@pytest.mark.parametrize(("c", "eta"), [(1.0, 0.005), (1e-3, 1e-8)])
def test_a_site_that_overtakes_the_window_makes_it_longer(c, eta):
    """So long that its ends disturb by little beside the threshold, however low that is."""
    short = ChainState(static_state(c, 48).phi, 0)
    run = simulate_front(c, eta, short)
    assert run.window > 48
    assert run.truncation < 1e-14 * run.threshold
    assert run.v == pytest.approx(simulate_front(c, eta).v, rel=1e-12)


def test_an_interrupted_run_leaves_the_next_one_whole(monkeypatch):
    calls = iter(range(10))
    advance = PiecewiseMotion.advance

    def interrupted(self, patience):
        if next(calls) == 5:
            raise KeyboardInterrupt
        return advance(self, patience)

    with monkeypatch.context() as patch:
        patch.setattr(PiecewiseMotion, "advance", interrupted)
        with pytest.raises(KeyboardInterrupt):
            simulate_front(0.5, 0.03125)
    assert simulate_front(0.5, 0.03125).steady


@pytest.mark.parametrize(
    ("c", "eta"),
    [
        *((c, 0.03) for c in (0, -1, math.nan, math.inf, 1e-310, 1e6, "x")),
        *((1, eta) for eta in (0, -1, 0.125, math.nan, 1e-12)),
    ],
)
def test_bad_parameters_are_refused_in_one_sentence(c, eta):
    with pytest.raises(ParameterError, match=r"^[^.]*( = [^ ]*) is not allowed.*\.$"):
        simulate_front(c, eta)


@pytest.mark.parametrize("velocity", [0.0, math.nan, math.inf, 1e9])
def test_a_bad_starting_velocity_is_refused(velocity):
    with pytest.raises(ParameterError):
        simulate_front(0.5, 0.03125, start_velocity=velocity)


@pytest.mark.parametrize("start", ["step", "resting"])
def test_a_run_from_rest_needs_no_other_window_than_one_that_moves(start):
    for c in (0.1, 1.0, 20 / 3, 30.0, 200.0):
        moving, resting = (
            len(simulation._start_state(c, 0.3, kind, None).phi) for kind in ("moving", start)
        )
        assert 0.5 * moving <= resting <= 2 * moving


def test_a_step_and_a_chain_at_rest_are_different_starts():
    for kind, made in (("step", step_state), ("resting", lambda sites: static_state(0.5, sites))):
        start = simulation._start_state(0.5, 0.3, kind, None)
        assert np.array_equal(start.phi, made(len(start.phi)).phi)


def test_a_threshold_at_the_lowest_that_is_allowed_moves_at_the_kinetic_velocity():
    run = simulate_front(1e-3, SMALLEST_ETA)
    assert run.steady
    assert abs(run.v - kinetic_velocity(run.v, 1e-3, SMALLEST_ETA)) <= run.error


def test_a_start_without_both_equilibria_is_refused():
    with pytest.raises(ParameterError):
        simulate_front(0.5, 0.03125, ChainState(np.zeros(64, complex)))
    broken = step_state(64)
    broken.phi[20] = math.nan
    with pytest.raises(ParameterError, match="finite"):
        simulate_front(0.5, 0.03125, broken)
    with pytest.raises(ParameterError):
        simulate_front(0.5, 0.03125, "sideways")
    with pytest.raises(ParameterError, match="31 sites"):
        simulate_front(0.5, 0.03125, step_state(31))
    assert simulate_front(0.5, 0.03125, step_state(32)).steady
    for end, off in ((0, 1.5e-3), (-1, 1.5e-3j)):
        shifted = step_state(64)
        shifted.phi[end] += off
        with pytest.raises(ParameterError, match=r"with an end 0\.0015 off"):
            simulate_front(0.5, 0.03125, shifted)


def test_a_window_too_long_to_follow_is_refused_before_any_work(monkeypatch):
    for c in (350.0, 1e4):  # of which the first needs some more sites than are allowed
        with pytest.raises(ParameterError, match="32768 sites"):
            piecewise_window.window_length(c, 1.0, 1e-15)
    sites = piecewise_window.window_length(300.0, 1.0, 1e-15)
    assert sites > 2**14
    monkeypatch.setattr(piecewise_window, "MAX_SITES", sites)
    assert piecewise_window.window_length(300.0, 1.0, 1e-15) == sites


def test_the_command_prints_the_promised_json(answered):
    answer = answered("front piecewise --c 0.5 --a 4 --b 0.5")
    assert answer["v"] == pytest.approx(0.300992350758521, abs=1e-12)
    assert answer["steady"] is True
    assert answer["status"] == "steady"
    assert {"error", "events", "seconds"} <= set(answer)


@pytest.mark.parametrize("start", ["resting", "moving"])
def test_the_command_says_pinned(capsys, start):
    options = ["front", "piecewise", "--c", "0.3", "--eta", "0.03125", "--start", start]
    assert main(options) == 0
    assert capsys.readouterr().out.startswith("pinned")


@pytest.mark.parametrize(
    "options",
    [
        "--c 0.5",
        "--c 0.5 --a 4",
        "--c 0.5 --eta 0.03 --a 4",
        "--c nan --eta 0.03",
        "--c 0.5 --eta 0.2",
        "--c 0.5 --eta 0.03 --start resting --start-v 1",
    ],
)
def test_the_command_refuses_bad_input_with_exit_code_2(refused, options):
    refused(f"front piecewise {options}")


@pytest.mark.parametrize("accuracy", [1e-14, 0.02, math.nan])
def test_an_accuracy_that_no_spread_can_have_is_refused(accuracy):
    with pytest.raises(ParameterError, match="accuracy"):
        simulate_front(0.5, 0.03125, accuracy=accuracy)


def test_a_front_is_judged_by_the_tolerance_that_was_asked_for(monkeypatch):
    asked = []

    class Made:
        def __init__(self, *_):
            self.blocks = 0

        def extend(self, records):
            self.blocks += 1

        def decided(self, tolerance, periods):
            asked.append((tolerance, periods))
            return self.blocks == 3

        def verdict(self, rest, tolerance, began):
            asked.append((tolerance, rest))
            return time.perf_counter() - began

    monkeypatch.setattr(simulation, "History", Made)
    seconds = simulate_front(0.5, 0.03125, accuracy=1e-5, max_sites=500)
    assert asked == [(1e-5, 500)] * 3 + [(1e-5, None)]
    assert 0.0 <= seconds < 600.0
    simulate_front(0.5, 0.03125)
    assert asked[-1] == (1e-12, None)  # unless another one is asked for


@pytest.mark.parametrize("size", [0.6e-4, 600.0, 1400.0])
def test_a_start_may_be_far_slower_or_faster_than_any_front(size, monkeypatch):
    """From c/10000 to 1000 (1 + c)."""
    made = []
    monkeypatch.setattr(simulation, "window_length", lambda *given: made.append(given) or 64)
    monkeypatch.setattr(simulation, "travelling_state", lambda *given: made.append(given))
    r = ratio(0.03125)
    for v in (size, -size):
        simulation._start_state(0.5, r, "moving", v)
        assert made == [(0.5, v, pytest.approx(1e-15 * r, rel=1e-3)), (0.5, v, 64)]
        made.clear()
    for c, v in ((0.5, 0.4e-4), (0.5, -1600.0), (1e306, math.inf)):  # 1000 (1 + c) overflows
        with pytest.raises(ParameterError, match="start velocity"):
            simulation._start_state(c, ratio(0.03125), "moving", v)


@pytest.mark.parametrize("mode", [3, 16, 32])
def test_the_bound_on_the_second_derivative_is_reached_by_a_single_mode(mode):
    """|φ|² of e + d exp(λT), with |φ| as large as it becomes in a step and φ* λ² d positive."""
    sites, c, r, d = 64, 2.0, 0.3, 0.05
    motion = PiecewiseMotion(c, r, static_state(c, sites))
    rate = -0.5 + 1j * c * (1 - math.cos(2 * math.pi * mode / sites))
    motion._deviation = np.zeros(sites, dtype=complex)
    motion._deviation[mode] = d * sites
    step, bound, _ = motion._sampling_step()
    size = r + step * abs(rate) * d
    rest = size * np.exp(1j * np.angle(rate**2 * d)) - d

    def square(at):
        return abs(rest + d * np.exp(rate * at)) ** 2

    h = 1e-4
    second = (square(h) - 2 * square(0.0) + square(-h)) / h**2
    assert 0.999 * bound < second < 1.001 * bound


def made_history(waits, monkeypatch, **given):
    """A record of the front after so many waits, with a window of 100 sites and a zone of 10."""
    made = verdict.History.__new__(verdict.History)
    chain = SimpleNamespace(threshold=0.5, sites=100, grazes=0, state=lambda: None)
    vars(made).update(
        chain=chain, coupling=0.5, events=7, sliding=0, zone=10, _jitter=0.0,
        _waits={1: [0.0, *waits], -1: []}, _counts={1: list(range(len(waits) + 1)), -1: []},
        _slides={1: [0] * (len(waits) + 1), -1: []},
    )  # fmt: skip
    vars(made).update(given)
    asked = []
    monkeypatch.setattr(verdict, "truncation_bound", lambda *of: asked.append(of) or 0.0)
    return made, asked


@pytest.mark.parametrize("noise", [3e-10, 1e-8])
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_motion_repeats_where_the_last_120_periods_do_to_a_part_in_1e9(unit, noise):
    rng = np.random.default_rng(8)
    periods = np.tile([1.0, 1.2, 0.7], 40) + noise * rng.uniform(-1, 1, 120)
    assert verdict._repeat(unit * np.array([2.0, *periods])) == (3 if noise < 1e-9 else None)


def test_motion_without_a_repeat_has_the_velocity_of_its_second_half_and_the_spread_of_its_fifths(
    monkeypatch,
):
    waits = 2.0 + np.random.default_rng(9).uniform(-0.5, 0.5, 600)
    made, asked = made_history(waits, monkeypatch)
    found = made.verdict(None, 1e-9, 0.0)
    half = waits[300:]
    assert (found.status, found.repeat) == (FrontStatus.UNSTEADY, None)
    assert found.v == pytest.approx(1 / half.mean(), rel=1e-12)
    fifths = 1 / half.reshape(5, 60).mean(axis=1)
    assert found.error == pytest.approx(np.ptp(fifths) / 2, rel=1e-9)
    assert asked == [(0.5, found.v, 90)]


@pytest.mark.parametrize("blocks", [2, 4, 9, 14])
@pytest.mark.parametrize("shrink", [0.3, 0.7, 0.9])
def test_the_error_of_a_settling_period_bounds_its_distance_from_the_limit(
    shrink, blocks, monkeypatch
):
    """Deviations fall by a factor in each block: the limit is known."""
    n = np.arange(blocks * verdict.BLOCK)
    waits = 2.0 * (1 + 0.01 * shrink ** (n / verdict.BLOCK))
    made, _ = made_history(waits, monkeypatch)
    off = waits[-verdict.BLOCK :].mean() / 2.0 - 1
    assert off <= made._relative_error(made._spreads()) < 10 * off


def test_a_front_that_becomes_faster_or_broader_needs_a_window_for_its_threshold(monkeypatch):
    waits = np.full(3 * verdict.BLOCK, 2.0)
    made, _ = made_history(waits, monkeypatch)
    made.chain.zone = lambda: (40, 60)
    asked = []
    monkeypatch.setattr(verdict, "window_length", lambda *given: asked.append(given) or 0)
    made._keep_wide()
    assert asked == [(0.5, pytest.approx(0.5), pytest.approx(0.5e-14, rel=1e-3), 21)]


@pytest.mark.parametrize("shrink", [1.0, 0.3])
def test_a_front_that_retreats_has_a_positive_error(shrink, monkeypatch):
    """If its periods repeat, to 1e-9, and if they settle."""
    n = np.arange(20 * verdict.BLOCK)
    waits = 2.0 + (0.2 * (n % 2) if shrink == 1.0 else 0.02 * shrink ** (n / verdict.BLOCK))
    ahead, _ = made_history(waits, monkeypatch)
    back, _ = made_history(waits, monkeypatch)
    for record in ("_waits", "_counts", "_slides"):
        vars(back)[record] = {1: [], -1: vars(ahead)[record][1]}
    found, mirrored = (each.verdict(None, 1e-12, 0.0) for each in (ahead, back))
    assert mirrored.status is found.status is not FrontStatus.PINNED
    assert mirrored.v == -found.v < 0.0
    assert mirrored.error == found.error > 0.0


def test_spreads_fall_where_the_largest_of_each_group_does():
    beats = np.tile([1.0, 0.8, 0.5, 0.2, 0.0], 3)  # the smallest are zero throughout
    falling = np.repeat([1.0, 0.5, 0.25], 5)
    assert verdict._shrinks(beats * falling)
    assert not verdict._shrinks(beats)
    assert not verdict._shrinks((beats * falling)[1:])
    ends = np.where(np.arange(15) % 5 == 4, falling, 1.0)  # the smallest of each group falls
    assert not verdict._shrinks(ends)


def test_a_site_is_looked_at_if_a_parabola_of_the_largest_bend_can_cross(
    monkeypatch,
):
    """Of x(h - x)F/2, the depth below its chord is F h²/8."""
    asked = []

    def all_clear(motion, gap, least, *rest):
        asked.append(least)
        modes, phi, _ = rest
        # the state and the part of it that decays, as modes, when the search begins
        assert phi[0] == pytest.approx(motion.state().phi, abs=1e-14)
        assert np.array_equal(modes[0], motion._deviation)
        return np.zeros((len(gap) - 1, motion.sites), dtype=bool)

    monkeypatch.setattr(PiecewiseMotion, "_suspects", all_clear)
    motion = PiecewiseMotion(50.0, 0.3, step_state(64))
    step, bend, _ = motion._sampling_step()
    x = np.linspace(0.0, step, 101)
    motion.advance(0.0)
    assert asked == [pytest.approx((0.5 * bend * x * (step - x)).max(), rel=1e-12)]


def test_a_site_may_cross_in_an_interval_at_either_end_of_which_its_gap_is_small() -> None:
    gap = np.array([[5.0, 5.0, 5.0], [0.1, 5.0, 5.0], [5.0, 5.0, 0.1], [5.0, 5.0, 5.0]])
    few: Any = SimpleNamespace()  # so that the sharper bound is not asked
    found = PiecewiseMotion._suspects(few, gap, 1.0, np.empty(3), np.empty(3), 0.1)
    assert found.tolist() == [[True, False, False], [True, False, True], [False, False, True]]


@pytest.mark.parametrize("zone", [0, *range(100, 116)])
def test_images_of_a_front_of_some_sites_disturb_by_less_than_was_allowed(zone: int) -> None:
    for c, v, tolerance in ((0.5, 0.3, 1e-12), (10.0, -2.0, 1e-9)):
        sites = piecewise_window.window_length(c, v, tolerance, zone)
        assert truncation_bound(c, v, sites - zone - 8) < tolerance  # eight sites are in reserve
        assert truncation_bound(c, v, sites - zone - 24) > tolerance  # sixteen fewer will not do


@pytest.mark.parametrize("part", [1.0, 0.25])
@pytest.mark.parametrize("c", [0.1, 2.0])
def test_a_site_is_clear_that_is_farther_from_the_threshold_than_one_mode_can_move_it(c, part):
    """By d exp(λt) - d at the most: that is less than d (exp(|λ| h) - 1)."""
    sites, mode, d = 64, 20, 0.05
    motion = PiecewiseMotion(c, 0.3, step_state(sites))
    rate = -0.5 + 1j * c * (1 - math.cos(2 * math.pi * mode / sites))
    step = part * motion._longest
    modes = np.zeros(sites, dtype=complex)
    modes[mode] = d * sites
    farthest = d * math.expm1(abs(rate) * step)
    side = np.where(np.arange(sites) <= -step_state(sites).origin, 1.0, -1.0)  # on, then off
    for distance, clear in ((1.001, True), (0.999, False)):
        phi = (0.3 + side * distance * farthest) * np.exp(1j * np.arange(sites))
        assert (motion._clear(modes, phi, step) == clear).all()


def test_of_many_sites_that_may_cross_the_sharper_bound_leaves_the_one_that_does() -> None:
    motion = PiecewiseMotion(0.6, 0.3, step_state(64))
    for _ in range(6):
        motion.advance(50.0)
    later = copy.deepcopy(motion).advance(50.0)
    assert isinstance(later, Switching)
    step, _, level = motion._sampling_step()
    motion._deviation = motion._deviation * np.exp(motion._rates * (later.wait - 0.5 * step))
    parts = motion._deviation * motion._samplers[level]
    phi = np.fft.ifft(parts + motion._equilibrium, axis=1) - motion._ramp
    nowhere = np.zeros((len(phi), motion.sites))  # every gap: all sites are looked at
    found = motion._suspects(nowhere, 1.0, parts, phi, step)
    assert np.flatnonzero(found[0]).tolist() == [later.site - motion.origin]
