"""Claims about event-exact runs of the friction chain, against scipy's DOP853 and conservation."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import simpson

from theory.cells.friction import FrictionCell, friction_coefficient
from theory.cells.friction_law import FrictionLaw
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError
from verification.cells.friction import cycle_end_velocity, stick_slip_cycle
from verification.fronts.measure import measure_front
from verification.fronts.status import FrontStatus
from verification.references.friction_events import _Law, run_events
from verification.runs import friction_integration
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration
from verification.runs.integration import NotFiniteError, StandstillError
from verification.runs.simulate import simulate
from verification.runs.trajectory import RunStatus, Trajectory
from verification.steppers import friction
from verification.steppers.friction import (
    _next_due,
    _ranges,
    _rate,
    _reach,
    _renew,
    _switch,
    _turning_point,
    _widen,
)
from verification.steppers.friction_series import (
    ARRIVAL,
    BEYOND,
    BINOMIALS,
    CLOCK,
    DRAG,
    DUE,
    END,
    EVENT,
    FIRST,
    JUMP,
    KEPT,
    LAST_MAXIMUM,
    LAST_MINIMUM,
    LAST_TERM,
    MODE,
    OWN,
    POLYNOMIAL,
    RELEASED,
    REST,
    ROWS,
    SLIDING,
    START,
    STEEPEST,
    STEP,
    SUM,
    TOLERANCE,
    V_D,
    W,
    Y,
    _largest_bend,
    _polish,
    _seen,
    _stays_positive,
    absolute_sum,
    absolute_sums,
    expand,
    first_root,
    friction_outer,
    law_of,
    new_numbers,
    new_work,
    one_way,
    resolved,
    shift,
    site_value,
    site_values,
    taylor_order,
    term_length,
    value_at,
)
from verification.steppers.stop_code import StopCode

CELL = FrictionCell()
SEED = 20261121
BEGINS, ENDS, REVERSES = 0, 1, 2


def random_start(sites: int, seed: int = SEED) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.array([rng.uniform(-1, 2, sites), rng.uniform(-1, 1, sites)])


def holding_force(chain: FrictionChain, y: np.ndarray) -> np.ndarray:
    """The force that would hold each site, y of shape (M, N), written out by hand."""
    bend = 2 * y
    bend[:, 1:] -= y[:, :-1]
    bend[:, :-1] -= y[:, 1:]
    if chain.ends is Ends.FREE:
        bend[:, 0] -= y[:, 0]
        bend[:, -1] -= y[:, -1]
    return 2 * chain.cell.xi * chain.cell.v_d + y + chain.c * bend


def test_a_new_run_has_a_row_for_each_number_that_compiled_code_keeps() -> None:
    """Indices are not checked there: what has no row would be written beside the array."""
    run = friction.new_run(new_numbers(CELL, 0.1, 1e-9), law_of(CELL), np.zeros((2, 3)), np.ones(3),
                           times=np.zeros(5), logged=7, order=12)  # fmt: skip
    assert len(run.mode) > max(MODE, RELEASED, DUE, FIRST, BEYOND)
    assert len(run.counters) >= friction.KINDS + len({BEGINS, ENDS, REVERSES})
    assert len(run.site) > max(LAST_MAXIMUM, LAST_MINIMUM, LAST_TERM)
    assert (run.samples.shape[0], run.log.shape) == (5, (7, 3))


@pytest.mark.parametrize("direction", [-1.0, 1.0])
def test_the_reference_releases_a_site_in_either_direction(direction: float) -> None:
    law = _Law(FrictionChain(c=0.0, sites=1))
    loads = [direction * part * law.cell.mu_st for part in (0.99, 1.01)]
    stuck = np.array([[y - law.hold(np.zeros(2))[0] for y in loads], [0.0, 0.0]])
    assert law.hold(stuck) == pytest.approx(np.array([loads]))
    distance = law.distance(stuck, np.zeros(1, dtype=int))
    assert distance == pytest.approx(np.array([[0.01, -0.01]]) * law.cell.mu_st)


def sorted_log(log: np.ndarray) -> np.ndarray:
    """Events in order of time, simultaneous ones by site."""
    return log[np.lexsort((log[:, 1], log[:, 0].round(8)))]


CASES = {
    "cycle": (FrictionChain(c=0.0, sites=1), np.array([[2.0], [0.0]]), 60.0),
    "three": (FrictionChain(c=0.02, sites=3), random_start(3), 60.0),
    "five": (FrictionChain(c=0.05, sites=5), random_start(5), 60.0),
    "strong": (FrictionChain.of(replace(CELL, v_d=0.5), c=0.5, sites=5), random_start(5), 40.0),
    "reversals": (FrictionChain(c=10.0, sites=5), random_start(5), 15.0),
    "wall": (FrictionChain(c=0.3, sites=4, ends=Ends.LITERAL), random_start(4), 40.0),
    "slow belt": (FrictionChain.of(replace(CELL, v_d=0.01), c=0.1, sites=3), random_start(3), 60.0),
    "undamped": (FrictionChain.of(replace(CELL, xi=0.0), c=0.1, sites=3), random_start(3), 40.0),
    "steep": (
        FrictionChain.of(replace(CELL, v0=0.02, v_d=0.5), c=0.1, sites=3),
        random_start(3),
        10.0,
    ),
    "alike": (FrictionChain(c=0.3, sites=4), np.full((2, 4), 1.2) * [[1.5], [0.0]], 60.0),
    "far": (FrictionChain(c=0.1, sites=3), np.array([[20.0, 0, 0], [0, 0, 0]]), 12.0),
}


def assert_events_of_scipy(
    chain: FrictionChain, start: np.ndarray, t_end: float, *, steep: bool
) -> Trajectory:
    """A run whose events and states are those of scipy; ``steep`` where y is 20 or μ is steep."""
    ours = simulate(chain, start, t_end, tolerance=1e-13, logged_events=10_000, samples=201)
    with warnings.catch_warnings():
        # In trial steps beyond an event the continued exponential may overflow; they are refused.
        warnings.simplefilter("ignore", RuntimeWarning)
        theirs = run_events(
            chain, start, t_end, tolerance=1e-13, longest_step=0.02 if steep else 0.1
        )
    assert ours.status is RunStatus.RESOLVED
    assert len(ours.event_log) == len(theirs.log) == ours.event_count
    mine, other = sorted_log(ours.event_log), sorted_log(theirs.log)
    assert np.array_equal(mine[:, 1:], other[:, 1:])
    # DOP853 at 1e-13 accumulates about 1e-12 in these times, 1e-10 where y is 20 or μ is steep.
    room = 2e-9 if steep else 2e-11
    assert np.abs(mine[:, 0] - other[:, 0]).max() < room
    assert np.abs(ours.y - theirs.y).max() < room
    assert np.abs(ours.velocity - theirs.velocity).max() < 10 * room
    return ours


def assert_error_bounds(
    chain: FrictionChain, start: np.ndarray, t_end: float, tolerance: float
) -> None:
    """The error of a run is no less than its distance from a run at 1e-14."""
    exact = simulate(chain, start, t_end, tolerance=1e-14)
    rough = simulate(chain, start, t_end, tolerance=tolerance)
    assert np.abs(rough.y - exact.y).max() <= rough.error
    assert np.abs(rough.velocity - exact.velocity).max() <= rough.error


def test_a_whole_number_as_the_end_is_the_same_run_and_compiles_nothing() -> None:
    chain, start, _ = CASES["three"]
    ends = [simulate(chain, start, 2.0).states]
    compiled: Any = friction._advance
    before = len(compiled.signatures)
    ends.append(simulate(chain, start, 2).states)
    assert len(compiled.signatures) == before
    np.testing.assert_array_equal(*ends)


@pytest.mark.parametrize("name", CASES)
def test_every_event_is_that_of_scipy(name: str) -> None:
    assert_events_of_scipy(*CASES[name], steep=name in ("steep", "far"))


@pytest.mark.parametrize(
    ("changes", "v_d"),
    [
        ({"c": 0.05, "sites": 13}, 1.25),
        ({"c": 1.0, "sites": 9}, 0.7),
        ({"c": 0.3, "sites": 9, "ends": Ends.LITERAL}, 0.7),
        ({"c": 0.05, "sites": 13, "law": FrictionLaw.STRIBECK}, 0.5),
        ({"c": 0.02, "sites": 13, "law": FrictionLaw.COULOMB}, 0.5),
    ],
)
def test_the_first_events_of_many_sites_are_those_of_scipy(
    changes: dict[str, Any], v_d: float
) -> None:
    """Sites that keep their series and sites with new ones, side by side."""
    chain = FrictionChain(v_d=v_d, **changes)
    ours = assert_events_of_scipy(chain, random_start(chain.sites), 2.5, steep=False)
    assert ours.counts["local_series"] > 0
    assert ours.event_count > 4


@pytest.mark.parametrize("changes", [{"v0": 0.005}, {"law": FrictionLaw.STRIBECK, "v_s": 0.02}])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_friction_that_rises_within_a_narrow_range_is_seen_from_either_side(
    changes: dict[str, Any], side: float
) -> None:
    """The second site is far ahead of the belt or behind it, and is stopped within the time."""
    chain = FrictionChain(c=0.1, sites=2, v_d=0.5, xi=0.0, **changes)
    start = np.array([[0.2, 0.1 * side - 0.2], [-1.5, 0.5 + 0.6 * side]])
    ours = assert_events_of_scipy(chain, start, 1.0, steep=True)
    assert ours.event_log[0, 1:].tolist() == [2, BEGINS]


@pytest.mark.parametrize("name", ["cycle", "three", "strong", "reversals", "steep", "far"])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_the_error_reported_bounds_the_true_one(name: str, tolerance: float) -> None:
    assert_error_bounds(*CASES[name], tolerance)


@pytest.mark.parametrize("name", ["cycle", "three", "strong", "reversals", "wall", "slow belt"])
def test_energy_is_balanced_with_friction_and_belt(name: str) -> None:
    """E(T) - E(0) = ∫ Σ (F ẏ - 2ξẏ²) dt by Simpson's rule between events; F from (6) or held.

    F ẏ is what the belt does, F v_d, less what friction burns, -F v_rel >= 0.
    """
    chain, start, t_end = CASES[name]
    cell = chain.cell
    first = simulate(chain, start, t_end, tolerance=1e-12, logged_events=10_000)
    edges = np.unique(np.concatenate([np.arange(t_end + 1.0), first.event_log[:, 0]]))
    pieces = [np.linspace(a, b, 81) for a, b in pairwise(edges)]
    run = simulate(chain, start, t_end, tolerance=1e-12, times=np.concatenate(pieces).tolist())
    gained = belt = burnt = 0.0
    for k, t in enumerate(pieces):
        rows = slice(81 * k, 81 * (k + 1))
        y, v = run.y[rows], run.velocity[rows]
        w = v - cell.v_d
        slip = -np.sign(w) * (cell.mu_d + (cell.mu_st - cell.mu_d) * np.exp(-np.abs(w) / cell.v0))
        # A site's mode is that of the middle of the piece; at its ends w may be zero.
        middle = w[40]
        direction = np.where(middle == 0, 0.0, np.sign(middle))
        slip = -direction * np.abs(slip)
        slip = np.where(np.abs(w) > 0, slip, -direction * cell.mu_st)
        force = np.where(middle == 0, holding_force(chain, y), slip)
        gained += simpson((force * v - 2 * cell.xi * v**2).sum(axis=1), x=t)
        belt += simpson((force * cell.v_d).sum(axis=1), x=t)
        burnt += simpson((-force * w).sum(axis=1), x=t)

    def energy(y: np.ndarray, v: np.ndarray) -> float:
        ends = np.concatenate([[0.0], y, [0.0]])
        stretch = np.diff(ends if chain.ends is Ends.LITERAL else y)
        return float(0.5 * (v @ v + y @ y + chain.c * stretch @ stretch))

    change = energy(run.y[-1], run.velocity[-1]) - energy(*start)
    # 81 points a piece of length about 1: Simpson is good to 1e-8 in all.
    assert gained == pytest.approx(change, abs=1e-6)
    assert burnt > 0
    assert belt - burnt == pytest.approx(gained + simpson_damping(run, pieces, cell), abs=1e-6)


def simpson_damping(run: Trajectory, pieces: list[np.ndarray], cell: FrictionCell) -> float:
    total = 0.0
    for k, t in enumerate(pieces):
        v = run.velocity[81 * k : 81 * (k + 1)]
        total += simpson((2 * cell.xi * v**2).sum(axis=1), x=t)
    return float(total)


@pytest.mark.parametrize("name", ["three", "five", "strong", "reversals", "undamped"])
def test_in_stick_the_force_can_hold_and_in_slip_the_sign_is_kept(name: str) -> None:
    chain, start, t_end = CASES[name]
    run = simulate(chain, start, t_end, tolerance=1e-12, samples=4001, logged_events=10_000)
    w = run.velocity - chain.cell.v_d
    stuck = run.velocity == chain.cell.v_d
    force = np.abs(holding_force(chain, run.y.copy()))
    assert stuck.any()
    assert force[stuck].max() <= chain.cell.mu_st + 1e-11
    # Exactly one mode: the log alone says which, and w agrees with it at every sample.
    for n in range(chain.sites):
        mode = int(np.sign(start[1, n] - chain.cell.v_d))
        events = run.event_log[run.event_log[:, 1] == n + 1]
        expected, k = np.zeros(run.times.size, dtype=int), 0
        for i, t in enumerate(run.times):
            while k < len(events) and events[k, 0] < t:
                kind = int(events[k, 2])
                if kind == BEGINS:
                    assert mode != 0
                    mode = 0
                elif kind == ENDS:
                    assert mode == 0
                    mode = int(np.sign(w[np.searchsorted(run.times, t), n])) or -1
                else:
                    assert mode != 0
                    mode = -mode
                k += 1
            expected[i] = mode
        settled = np.abs(w[:, n]) > 1e-9
        assert np.array_equal(np.sign(w[settled, n]), expected[settled])
        assert np.array_equal(stuck[:, n], expected == 0)


@pytest.mark.parametrize("sites", [2, 5, 8, 31])
@pytest.mark.parametrize("c", [0.02, 0.5, 10.0])
def test_mirror_symmetry_survives_to_the_last_bit(sites: int, c: float) -> None:
    half = random_start((sites + 1) // 2)
    start = np.concatenate([half, half[:, ::-1][:, sites % 2 :]], axis=1)
    run = simulate(FrictionChain(c=c, sites=sites), start, 60.0 if c < 1 else 20.0)
    assert np.array_equal(run.y, run.y[:, ::-1])
    assert np.array_equal(run.velocity, run.velocity[:, ::-1])


@pytest.mark.parametrize("c", [0.0, 0.02, 1.0, 10.0, 1e4])
@pytest.mark.parametrize("v_d", [0.5, 1.25])
def test_uniform_sliding_is_an_equilibrium_of_free_ends_for_every_coupling(
    c: float, v_d: float
) -> None:
    cell = replace(CELL, v_d=v_d)
    chain = FrictionChain.of(cell, c=c, sites=7)
    start = np.array([np.full(7, cell.steady_sliding), np.zeros(7)])
    run = simulate(chain, start, 10.0, active_window=False)
    # Unstable below the Hopf velocity: round-off grows by e^2 here.
    assert np.abs(run.y - cell.steady_sliding).max() < 1e-14
    walls = simulate(replace(chain, ends=Ends.LITERAL), start, 10.0)
    assert bool(np.abs(walls.y - cell.steady_sliding).max() > 1e-3) is (c > 0)


def test_a_window_run_is_the_full_run() -> None:
    chain = FrictionChain(c=0.02, sites=201)
    start = excite(chain, [1])
    for tolerance in (1e-8, 1e-11):
        full, window = (
            simulate(chain, start, 150.0, tolerance=tolerance, active_window=each)
            for each in (False, True)
        )
        assert window.mean_active < 60 < full.mean_active
        assert full.error is not None
        assert np.abs(full.y - window.y).max() <= max(full.error, tolerance)
        assert full.event_count == window.event_count


def test_uncoupled_sites_move_as_alone() -> None:
    start = random_start(4)
    run = simulate(FrictionChain(c=0.0, sites=4), start, 50.0, tolerance=1e-12)
    for n in range(4):
        alone = simulate(FrictionChain(c=0.0, sites=1), start[:, [n]], 50.0, tolerance=1e-12)
        # Steps differ: each is good to its own error.
        assert np.abs(run.y[:, n] - alone.y[:, 0]).max() < 1e-9


def test_an_amplitude_sampled_counts_every_turning_point_before() -> None:
    chain = FrictionChain(c=0.02, sites=15)
    start, ends = excite(chain, [1]), np.linspace(150.0, 200.0, 101)
    run = simulate(chain, start, 200.0, times=ends.tolist())
    fine = simulate(chain, start, 200.0, times=np.linspace(0.0, 200.0, 40_001).tolist())
    for t, sampled in zip(run.times, run.amplitude, strict=True):
        # Half of the last maximum minus the last minimum, read off a dense picture of y.
        rows = fine.times <= t + 1e-9
        y = fine.y[rows, 2]
        inner = y[1:-1]
        highest = inner[(inner >= y[:-2]) & (inner > y[2:])]
        lowest = inner[(inner <= y[:-2]) & (inner < y[2:])]
        # A parabola within 1/200 of its top is flat to |ÿ|/8 of 4e-5, and |ÿ| < 3; a turning point
        # in the last 1/200 is not seen, which shifts y by no more.
        assert sampled[2] == pytest.approx(0.5 * (highest[-1] - lowest[-1]), abs=1e-4)


@pytest.mark.parametrize("sites", [2, 9, 50])
def test_sites_that_start_alike_switch_together(sites: int) -> None:
    start = np.array([np.full(sites, 1.9), np.zeros(sites)])
    run = simulate(FrictionChain(c=0.3, sites=sites), start, 60.0, logged_events=10_000)
    assert np.ptp(run.y, axis=1).max() == 0.0
    times, counts = np.unique(run.event_log[:, 0], return_counts=True)
    assert len(times) > 10
    assert np.all(counts == sites)


def test_a_site_sticks_for_ever() -> None:
    slow = replace(CELL, v_d=1e-12)
    run = simulate(
        FrictionChain.of(slow, c=0.0, sites=2), np.array([[0.0, 0.5], [1e-12, 1e-12]]), 1e4
    )
    assert run.stuck.all()
    assert run.event_count == 0
    assert run.y[-1] == pytest.approx([1e-8, 0.5 + 1e-8], abs=1e-15)


def test_a_start_at_the_verge_of_release_is_released_at_once() -> None:
    chain = FrictionChain(c=0.0, sites=1)
    start = np.array([[CELL.release], [CELL.v_d]])
    run = simulate(chain, start, 20.0, logged_events=100)
    assert run.event_log[0, 0] < 1e-15
    assert run.event_log[0, 2] == ENDS
    beyond = simulate(chain, np.array([[5.0], [CELL.v_d]]), 1.0)
    assert np.all(np.diff(beyond.velocity[:50, 0]) < 0)


@pytest.mark.parametrize("sites", [1, 2, 5])
@pytest.mark.parametrize("c", [0.0, 0.2, 1e6])
def test_the_start_is_sampled_where_all_sites_are_released_at_once(c: float, sites: int) -> None:
    """The first frame has no length then; the sites are alike, so that their coupling is idle."""
    chain = FrictionChain.of(CELL, c=c, sites=sites)
    start = np.repeat([[CELL.release], [CELL.v_d]], sites, axis=1)
    run = simulate(chain, start, 1.0)
    assert np.array_equal(run.y[0], start[0])
    assert np.array_equal(run.velocity[0], start[1])


def test_sites_released_as_a_run_begins_are_so_however_strongly_they_are_coupled() -> None:
    """The first frame ends as it begins if all sites need new series; alike, they do not pull."""
    runs = []
    for c, sites in ((1e6, 2), (0.0, 1)):
        start = np.full((2, sites), CELL.v_d)
        start[0] = CELL.release
        run = FrictionIntegration(FrictionChain.of(CELL, c=c, sites=sites), start,
                                  tolerance=1e-12, logged_events=9)  # fmt: skip
        run.advance_to(5.0)
        runs.append(run)
    strong, alone = runs
    assert strong.state == pytest.approx(np.tile(alone.state, 2), abs=1e-9)
    assert [each.log[: len(each.state[0]), 0].max() for each in runs] == [0.0, 0.0]
    assert [each.events["releases"] for each in runs] == [2, 1]


def test_an_event_at_the_very_end_of_a_run_is_part_of_it() -> None:
    """The belt moves a site to the verge of release within a time that is exactly one."""
    cell = FrictionCell(xi=0.0, v_d=1.0)
    run = FrictionIntegration(FrictionChain.of(cell, c=0.0, sites=1), np.array([[0.0], [1.0]]),
                              logged_events=2)  # fmt: skip
    run.advance_to(1.0)
    assert run.log.tolist() == [[1.0, 1, ENDS]]
    assert not run.stuck.any()


def test_a_run_ends_at_the_very_time_that_it_is_to_reach() -> None:
    """Also where the time from here to there, added to that of here, is later by rounding."""
    chain, step, later = FrictionChain(c=0.0, sites=1), np.spacing(3.0), 0
    for k in range(8):
        here, there = 0.25 + (k + 0.5) * step, 3.0 + k * step
        later += here + (there - here) > there
        run = FrictionIntegration(chain, np.array(chain.rest_state)[:, None])
        for time in (here, there):
            run.advance_to(time)
            assert run.time == time
    assert later > 0


@pytest.mark.parametrize(
    ("critical", "share"),
    [(lambda cell: cell.hopf_velocity, 1.0)]
    + [(cycle_end_velocity, share) for share in (1.0, 1 - 1e-9, 1 + 1e-9)],
)
def test_at_the_critical_velocities_runs_are_finite_and_say_when_unsure(
    critical: Callable[[FrictionCell], float], share: float
) -> None:
    v_d = critical(CELL) * share
    chain = FrictionChain.of(replace(CELL, v_d=v_d), c=0.0, sites=1)
    start = np.array([[chain.cell.release - 1e-3], [v_d]])
    run = simulate(chain, start, 60.0)
    exact = simulate(chain, start, 60.0, tolerance=1e-14)
    assert np.isfinite(run.y).all()
    assert np.abs(run.y - exact.y).max() <= run.error


@pytest.mark.parametrize("v0", [0.1, 1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("v_d", [1e-6, 0.3, 0.5])
def test_steep_curves_and_slow_belts_converge(v0: float, v_d: float) -> None:
    chain = FrictionChain.of(replace(CELL, v0=v0, v_d=v_d), c=0.05, sites=2)
    start = np.array([[1.4, 0.4], [0.0, 0.0]])
    run = simulate(chain, start, 15.0, tolerance=1e-10)
    exact = simulate(chain, start, 15.0, tolerance=1e-14)
    assert run.counts["sticks"] > 0
    assert np.abs(run.y - exact.y).max() <= run.error
    # At tolerance 1e-10 the peak e^{-|w|/v₀} must have been seen, however narrow.
    assert np.abs(run.y - exact.y).max() < 1e-6


def test_a_chain_of_ten_thousand_sites_runs() -> None:
    chain = FrictionChain(c=0.02, sites=10_000)
    long = simulate(chain, excite(chain, [1]), 60.0, samples=3)
    short = replace(chain, sites=40)
    brief = simulate(short, excite(short, [1]), 60.0, samples=3)
    assert np.isfinite(long.y).all()
    # Forty sites are enough for τ = 60: the far end is not reached to round-off.
    assert np.abs(long.y[:, :20] - brief.y[:, :20]).max() < 1e-9


def test_what_cannot_be_run_is_refused() -> None:
    chain = FrictionChain(c=0.1, sites=2)
    for start in (np.zeros((2, 3)), np.full((2, 2), np.nan), np.full((2, 2), np.inf)):
        with pytest.raises(ParameterError, match="start"):
            simulate(chain, start, 1.0)
    with pytest.raises(ParameterError, match="end time"):
        simulate(chain, np.zeros((2, 2)), -1.0)
    with pytest.raises(NotFiniteError):
        simulate(chain, np.array([[1e300, 0.0], [0.0, 0.0]]), 1.0)


@pytest.mark.parametrize("v0", [1e-16, 1e-30])
def test_a_series_that_is_shorter_than_time_can_be_counted_is_refused(v0: float) -> None:
    """Friction rises within v₀ of the belt, and before is constant as under Coulomb's law."""
    cell = FrictionCell(xi=0.0, mu_d=0.5, v_d=1.25, v0=v0)
    # y = μ_d + 1.5 cos τ reaches the velocity of the belt at sin τ = -5/6.
    run = FrictionIntegration(FrictionChain.of(cell, c=0.0, sites=1), np.array([[2.0], [0.0]]))
    with pytest.raises(StandstillError, match="time step vanished"):
        run.advance_to(10.0)
    assert run.time == pytest.approx(math.pi + math.asin(5.0 / 6.0), abs=1e-6)
    assert run.state[:, 0] == pytest.approx([0.5 + 1.5 * math.cos(run.time), 1.25], abs=1e-6)


@pytest.mark.parametrize("moving", [0, 20, 39])
def test_a_series_that_ends_before_a_late_time_can_advance_is_refused(moving: int) -> None:
    """All others slide steadily, so that the frame is as long as the run."""
    cell = FrictionCell(law="coulomb", xi=0.0)
    start = np.zeros((2, 40))
    start[0] = cell.mu_d
    start[0, moving] += 0.4
    run = FrictionIntegration(FrictionChain.of(cell, c=0.0, sites=40), start)
    late = 1e17  # the next number is 16 later
    run._run.numbers[CLOCK] = late
    with pytest.raises(StandstillError, match="time step vanished"):
        run.advance_to(late + 64.0)
    assert run.time == late


def test_a_site_that_can_neither_stick_nor_slip_ends_the_run() -> None:
    """Friction is made to rise at the end of stick, so that a site is stopped as it is released."""
    cell = FrictionCell(xi=0.0)
    run = FrictionIntegration(FrictionChain.of(cell, c=0.0, sites=3),
                              np.array([[0.9, 0.0, 0.2], [cell.v_d, 0.0, 0.0]]))  # fmt: skip
    run._run.numbers[JUMP] = -0.5
    with pytest.raises(StandstillError):
        run.advance_to(1.0)
    assert run.time < (cell.mu_st - 0.9) / cell.v_d


def test_a_run_goes_to_the_end_that_is_given() -> None:
    """Or to its last sample, or for ever; and no further than its steps last."""
    chain = FrictionChain(c=0.02, sites=3)
    start = excite(chain, [1])
    ends = [
        FrictionIntegration(chain, start, times, end=end).end
        for times, end in (([1.0, 2.0], 5.0), ([1.0, 2.0], None), ([], 5.0), ([], None))
    ]
    assert ends == [5.0, 2.0, 5.0, np.inf]
    run = FrictionIntegration(chain, start, [1.0], end=1e3)
    run.advance_to(1e3, max_steps=5)
    assert run.counts["steps"] == 5
    run.advance(chain.sites)
    assert run.counts["steps"] <= 7  # a budget of one step


@pytest.mark.parametrize(
    ("ends", "window", "narrow"),
    [
        (Ends.FREE, True, True),
        (Ends.FREE, False, False),
        (Ends.LITERAL, True, False),
        (Ends.LITERAL, False, False),
    ],
)
def test_sites_at_rest_are_left_out_of_chains_with_free_ends_alone(
    ends: Ends, window: bool, narrow: bool
) -> None:
    chain = FrictionChain(c=0.02, sites=41, ends=ends)
    run = FrictionIntegration(chain, excite(chain, [21]), active_window=window)
    low, high = (run._run.counters[n] for n in (friction.LO, friction.HI))
    assert low - 1 == chain.sites + 1 - high  # as many on one side as on the other
    run.advance_to(0.5)
    assert (run.counts["site_steps"] < chain.sites * run.counts["steps"]) is narrow
    whole = FrictionIntegration(chain, excite(chain, [21]), active_window=False)
    whole.advance_to(0.5)
    assert run.state == pytest.approx(whole.state, abs=1e-9)  # beside sites that slide steadily


def test_events_are_logged_if_they_are_asked_for() -> None:
    chain = FrictionChain(c=0.02, sites=3)
    for option, room in (({}, 0), ({"logged_events": 5}, 5)):
        run = FrictionIntegration(chain, excite(chain, [1]), **option)
        assert run.state_arrays["log"].shape == (room, 3)


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("away", [0.3, -0.3])
def test_a_site_that_is_displaced_or_pushed_to_either_side_of_steady_sliding_is_in_the_window(
    away: float, row: int
) -> None:
    chain = FrictionChain(c=0.02, sites=41)
    start = np.zeros((2, 41))
    start[0] = chain.cell.steady_sliding
    start[row, [0, 40]] += [-away, away]
    state = FrictionIntegration(chain, start).state
    assert state[0].tolist() == start[0].tolist()
    assert state[1] == pytest.approx(start[1], rel=1e-15)  # kept relative to the belt


def test_sites_outside_of_the_window_slide_steadily_to_the_last_bit() -> None:
    chain = FrictionChain(c=0.02, sites=41)
    start = excite(chain, [21])
    start[:, :8] += 1e-13  # nearer to sliding than is looked at
    start[:, -8:] -= 1e-13
    state = FrictionIntegration(chain, start).state
    for part in (slice(0, 8), slice(-8, None)):
        assert (state[0, part] == chain.cell.steady_sliding).all()
        assert np.abs(state[1, part]).max() == 0.0
    assert not np.array_equal(FrictionIntegration(chain, start, active_window=False).state, state)


def test_no_site_is_left_out_where_sliding_is_unstable_or_all_of_them_slide() -> None:
    """There the smallest deviation grows, or there is nothing to close a window around."""
    unstable = FrictionChain.of(replace(CELL, v_d=0.9 * CELL.hopf_velocity), c=0.02, sites=41)
    stable = FrictionChain(c=0.02, sites=41)
    for chain, away in ((unstable, 0.3), (stable, 0.0)):
        start = np.zeros((2, 41))
        start[0] = chain.cell.steady_sliding
        start[0, 20] += away
        counters = FrictionIntegration(chain, start)._run.counters
        assert (counters[friction.LO], counters[friction.HI]) == (1, 42)


@pytest.mark.parametrize("ends", [Ends.FREE, Ends.LITERAL])
def test_sites_that_start_with_the_belt_stick_if_the_force_can_be_held(ends: Ends) -> None:
    chain = FrictionChain(c=0.3, sites=9, ends=ends)
    y = np.random.default_rng(SEED).uniform(-1.0, 1.6, 9)
    force = holding_force(chain, y[None])[0]
    held = np.abs(force) <= chain.cell.mu_st
    assert 2 < np.count_nonzero(held) < 7
    run = FrictionIntegration(chain, np.array([y, np.full(9, chain.cell.v_d)]))
    assert run.stuck.tolist() == held.tolist()
    run.advance_to(1e-4)
    backwards = run.state[1] < chain.cell.v_d
    # A force that would have to push forwards is not there: the site falls behind the belt.
    assert backwards[~held].tolist() == (force[~held] > 0.0).tolist()


def test_an_amplitude_is_half_of_the_distance_of_its_turning_points() -> None:
    chain = FrictionChain(c=0.02, sites=3)
    run = FrictionIntegration(chain, excite(chain, [1]))
    run._row(LAST_MAXIMUM)[:] = 1.0, 3.0, np.nan
    run._row(LAST_MINIMUM)[:] = 3.0, 1.0, 0.0
    assert run.amplitude.tolist() == [1.0, 1.0, 0.0]


def test_a_perturbed_start_has_each_place_moved_by_its_own_last_digits() -> None:
    chain = FrictionChain(c=0.02, sites=3)
    start = np.array([[8.0, 0.0, -64.0], [1.0, 2.0, 3.0]])
    moved = FrictionIntegration.perturbed(chain, start, 4) - start
    rest = chain.rest_state.y
    assert moved[0].tolist() == [4 * np.spacing(each) for each in (8.0, rest, 64.0)]
    assert not moved[1].any()


def test_what_goes_to_rest_has_no_energy_left_to_stick_with() -> None:
    """Springs hold energy as well; ends that pull, or unstable sliding, never let it rest."""
    for changes, small, rests in (
        ({"c": 0.01}, 1.12e-3, True),  # 1.02 times its square, below ½(1e-3 v_d)²
        ({"c": 0.01}, 1.13e-3, False),
        ({"c": 1e4}, 1e-4, False),  # ½c(Δy)² is ten thousand times the rest
        ({"c": 0.01, "ends": Ends.LITERAL}, 1e-4, False),
        ({"c": 0.01, "v_d": 1.0}, 1e-4, False),
    ):
        chain = FrictionChain(**{"sites": 2, "v_d": 1.6, **changes})  # type: ignore[arg-type]
        y = chain.rest_state.y + small * np.array([1.0, -1.0])
        run = FrictionIntegration(chain, np.array([y, np.zeros(2)]), active_window=False)
        assert run.going_to_rest() is rests


def test_a_run_can_be_taken_in_parts() -> None:
    chain = FrictionChain(c=0.05, sites=9)
    start = excite(chain, [5])
    whole, parts = (FrictionIntegration(chain, start, tolerance=1e-11) for _ in range(2))
    whole.advance_to(50.0)
    for t in (13.0, 29.5, 50.0):
        parts.advance_to(t)
    assert np.abs(whole.state - parts.state).max() < 1e-8
    assert np.array_equal(whole.stuck, parts.stuck)


@pytest.mark.parametrize("law", [FrictionLaw.EXPONENTIAL, FrictionLaw.STRIBECK])
def test_a_run_has_room_for_its_series_and_work(law: FrictionLaw) -> None:
    """Compiled code does not ask: a row of series for y, ẏ, friction, and Gauss's curve if any.

    Of the work space, binomials up to the order are followed by a stack of 48 halvings and two.
    """
    chain = FrictionChain(c=0.05, sites=3, law=law, viscous=0.3)
    run = FrictionIntegration(chain, excite(chain, [2], 0.5))
    rows = 4 if law is FrictionLaw.STRIBECK else 3
    assert run._run.series.shape == (rows, run.order + 1, chain.sites + 2)
    assert run._run.work.shape == (BINOMIALS + (run.order + 1) + 48 + 2, run.order + 1)
    assert run._run.numbers[DRAG] == pytest.approx(2.0 * chain.cell.xi + 0.3)


def test_sites_that_stick_when_a_run_begins_have_arrived() -> None:
    chain = FrictionChain(c=0.0, sites=2)
    start = np.array([[0.0, chain.cell.steady_sliding], [chain.cell.v_d, 0.0]])
    run = FrictionIntegration(chain, start)
    run.advance_to(0.01)
    assert run.stuck.tolist() == [True, False]
    assert run.arrivals.tolist() == pytest.approx([0.0, np.nan], nan_ok=True)


def test_a_chain_at_rest_without_an_end_goes_on_in_finite_frames() -> None:
    chain = FrictionChain(c=0.05, sites=3)
    run = FrictionIntegration(chain, np.tile(np.array(chain.rest_state)[:, None], 3))
    times = [0.0]
    for _ in range(3):
        run.advance(run.default_budget)
        times.append(run.time)
    assert np.all(np.diff(times) > 0.0)
    assert np.isfinite(times[-1])


def test_compiled_code_is_left_at_intervals_but_takes_a_step_of_the_longest_chain(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain = FrictionChain(c=0.05, sites=3)
    run = FrictionIntegration(chain, excite(chain, [2]), [100.0])
    asked: list[int] = []

    def advance(_: object, __: float, steps: int) -> StopCode:
        asked.append(steps)
        assert steps > 0
        return StopCode.BUDGET_SPENT

    monkeypatch.setattr(friction, "advance", advance)
    for piece, steps in ((1, [1, 1, 1]), (4, [2, 1])):  # sites times steps
        monkeypatch.setattr(friction_integration, "_PIECE", piece)
        asked.clear()
        run.advance_to(100.0, max_steps=3)
        assert asked == steps


def test_a_run_full_of_events_is_left_when_its_budget_is_spent() -> None:
    chain = FrictionChain(c=0.05, sites=300)
    run = FrictionIntegration(chain, excite(chain, list(range(1, 301))), tolerance=1e-9)
    run.advance_to(20.0)
    for _ in range(5):
        before = run.counts["steps"]
        run.advance_to(1e5, max_steps=40)
        assert run.counts["steps"] - before == 40
    assert sum(run.events.values()) > 300


def test_more_samples_than_memory_holds_are_refused() -> None:
    chain = FrictionChain(c=0.05, sites=1000)
    with pytest.raises(ParameterError, match="at most 100000 for 1000 sites"):
        simulate(chain, excite(chain, [5]), 9.0, samples=200_000)


class CountedPolynomial(list[float]):
    """Coefficients that count how often one is read."""

    reads = 0

    def __getitem__(self, k: Any) -> Any:
        self.reads += 1
        return super().__getitem__(k)


def test_the_time_of_an_event_takes_a_dozen_evaluations_at_most() -> None:
    rng = np.random.default_rng(SEED)
    for _ in range(200):
        # One root, where a cubic that falls is known to have it.
        root = rng.uniform(0.05, 0.95)
        expanded = np.polynomial.polynomial.polymul([root, -1.0], [rng.uniform(1.0, 3.0), 0.3, 1.0])
        f = CountedPolynomial(expanded.tolist())
        found = _polish.py_func(f, 3, 0.0, 1.0)
        assert found == pytest.approx(root, rel=4e-15)
        # Newton doubles its digits: five or six steps from the middle, and some for round-off.
        assert f.reads <= 12 * 4


@pytest.mark.parametrize("root", [0.55, 0.8, 0.95])
def test_the_time_of_an_event_is_looked_for_in_its_bracket(root: float) -> None:
    """There are two earlier ones at 0.2 and 0.4."""
    f = -np.polynomial.polynomial.polyfromroots([0.2, 0.4, root])
    assert _polish.py_func(f, 3, 0.5, 1.0) == pytest.approx(root, rel=1e-13)


@friction_outer
def first_roots(work: np.ndarray, polynomials: np.ndarray, found: np.ndarray) -> None:
    """Put the first root of each polynomial, up to the time in ``found``, there."""
    for i in range(found.size):
        for k in range(work.shape[1]):
            work[0, k] = polynomials[i, k]
        found[i] = first_root(work, work.shape[1] - 1, found[i])


def test_a_first_root_is_the_first_of_all_roots_of_a_polynomial() -> None:
    """Monotonic, bent and waving polynomials, against the eigenvalues of numpy."""
    rng = np.random.default_rng(3)
    # Falling coefficients: the first three terms often decide, at the slower rates they do not.
    rates = rng.choice([0.2, 0.5, 1.0, 2.0], size=(400, 1))
    polynomials = rng.standard_normal((400, 8)) * rates ** np.arange(8)
    polynomials[:, 0] = rng.uniform(0.0, 1.0, 400)
    # Roots that are close to each other: a parabola that just crosses, or just does not.
    gap = np.tile([1e-3, -1e-3], 50)
    middle = rng.uniform(0.2, 0.8, 100)
    polynomials[:100] = 0.0
    polynomials[:100, :3] = np.column_stack(
        [middle**2 - np.sign(gap) * gap**2, -2 * middle, np.ones(100)]
    )
    ends = rng.choice([0.3, 1.0, 2.5], 400)
    found = ends.copy()
    first_roots(new_work(7), polynomials / ends[:, None] ** np.arange(8), found)
    for coefficients, root in zip(polynomials, found / ends, strict=True):
        roots = np.polynomial.Polynomial(np.trim_zeros(coefficients, "b")).roots()
        real = roots[np.abs(roots.imag) < 1e-7].real
        inside = real[(real > 0.0) & (real < 1.0)]
        if inside.size == 0:
            assert root == np.inf
        else:
            # Of roots 2e-3 apart numpy has some 13 digits, of others 14.
            assert root == pytest.approx(inside.min(), rel=1e-11)
    assert 100 < np.isfinite(found).sum() < 300


@pytest.mark.parametrize(
    ("coefficients", "root"),
    [
        ([1.0, -2.0], 0.5),
        ([1.0, -0.5], np.inf),
        ([0.5, 1.0], np.inf),
        ([1.0, 0.0, -4.0], 0.5),
        ([1.0, -5.0, 4.0], 0.25),
        ([1.0, -2.0, 2.0], np.inf),
        # What is zero at first, or has just left it, turns with its next coefficient.
        ([0.0, -1.0], 0.0),
        ([0.0, 0.0, -1.0], 0.0),
        ([0.0, 1.0, -2.0], 0.5),
        ([-1e-17, 1.0, -4.0], 0.25),
        ([0.0, 1.0, 1.0], np.inf),
        ([0.0, 0.0, 0.0], np.inf),
        # A root close to the beginning of the step, to its own last digits.
        ([1e-24, -1.0, -0.5], 1e-24),
        # Positive, but its Bernstein coefficients 1, 0, 1, 1 are not.
        ([1.0, -3.0, 6.0, -3.0], np.inf),
    ],
)
def test_a_line_or_a_parabola_has_its_first_root(coefficients: list[float], root: float) -> None:
    found = np.ones(1)
    first_roots(new_work(len(coefficients) - 1), np.array([coefficients]), found)
    assert found[0] == pytest.approx(root, rel=1e-15)


def test_roots_too_close_to_be_told_apart_are_looked_for_within_work_space_alone() -> None:
    """A double root 2^-58 after the beginning, of which the 48 halvings of a step see nothing."""
    at = 3.0 * 2.0**-60
    work, found = np.vstack([new_work(2), np.full((20, 3), 7.0)]), np.ones(1)
    first_roots(work, np.array([[at * at, -2.0 * at, 1.0]]), found)
    assert found[0] == np.inf
    assert (work[-20:] == 7.0).all()


@friction_outer
def proofs(work: np.ndarray, polynomials: np.ndarray, h: float, found: np.ndarray) -> None:
    """Of each polynomial, whether it is proved to be positive on [0, h], and monotonic."""
    degree = polynomials.shape[1] - 1
    for i in range(found.shape[0]):
        found[i, 0] = 1.0 if _stays_positive(polynomials[i], degree, h) else 0.0
        found[i, 1] = 1.0 if one_way(polynomials[i], degree, h, work[0]) else 0.0


def excess(f: list[float], h: float) -> tuple[Fraction, Fraction]:
    """By how much the first three terms outweigh the others on [0, h], and the sum of their sizes.

    In exact arithmetic.
    """
    terms = [Fraction(each) * Fraction(h) ** k for k, each in enumerate(f)]
    first, slope, bend = (terms + [Fraction(0)] * 2)[:3]
    least = min(first, first + slope + bend)
    if slope < 0 < 2 * bend + slope:
        least = first - slope**2 / (4 * bend)
    others = sum(map(abs, terms[3:]), Fraction(0))
    return least - others, first + abs(slope) + abs(bend)


@pytest.mark.parametrize("degree", [0, 1, 2, 3, 6])
def test_a_polynomial_is_proved_positive_or_monotonic_if_three_terms_outweigh_the_others(
    degree: int,
) -> None:
    """None that is not, and all but those that rounding may decide; of any size."""
    rng, h, parts = np.random.default_rng(SEED + degree), 0.7, []
    for n in range(200):
        f = rng.standard_normal(degree + 1) * 10.0 ** rng.uniform(-6.0, 0.0, degree + 1)
        f[3:] *= 1e-3
        f[1:3] *= n % 4 > 0
        f *= 10.0 ** rng.uniform(-20.0, 6.0)
        # The first term is what the others need, or a little more or less.
        near = rng.choice([-1e-13, -1e-15, 0.0, 0.0, 1e-13, 1e-12])
        lacking, size = excess([0.0, *f[1:]], h)
        need = float(-lacking)
        f[0] = need + near * (need + float(size)) if degree else f[0]
        parts.append(f)
    parts[0] = np.zeros(degree + 1)
    found = np.zeros((len(parts), 2))
    left_over = np.full((2, degree + 2), 1e9)  # in work space, by what was computed there before
    proofs(left_over, np.array(parts), h, found)
    slopes = np.zeros_like(found)
    rates = [np.polynomial.polynomial.polyder(f) if degree else np.zeros(1) for f in parts]
    if degree:
        # An integral of each of them from zero is monotonic if it is positive, or negative.
        whole = [np.polynomial.polynomial.polyint(f) for f in parts]
        left_over[:] = 1e9
        proofs(left_over, np.array(whole) * (-1.0) ** np.arange(len(parts))[:, None], h, slopes)
        rates = [np.polynomial.polynomial.polyder(f) for f in whole]
    counts = [0, 0]
    for f, rate, positive, monotonic in zip(parts, rates, found[:, 0], slopes[:, 1], strict=True):
        for each, proved in ((f, positive), (rate, monotonic))[: 2 if degree else 1]:
            margin, size = excess(each.tolist(), h)
            if margin <= 0:
                assert proved == 0.0, each
            elif margin > Fraction(2, 10**14) * size:
                assert proved == 1.0, each
            counts[margin <= 0] += 1
    assert min(counts) > 0


@friction_outer
def resolved_steps(
    series: np.ndarray,
    numbers: np.ndarray,
    law: tuple[float, ...],
    side: float,
    steps: np.ndarray,
) -> None:
    """Shorten the step of each site to one over which its series resolves friction."""
    for n in range(steps.size):
        steps[n] = resolved(series, numbers, law, n, side, steps[n])


@pytest.mark.parametrize("law", [FrictionLaw.EXPONENTIAL, FrictionLaw.STRIBECK])
@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("scale", "tolerance"), [(0.02, 1e-6), (0.5, 1e-12), (3.0, 1e-9)])
def test_a_step_is_halved_until_it_resolves_friction_on_the_way_to_stick(
    law: FrictionLaw, side: float, scale: float, tolerance: float
) -> None:
    """Towards stick along a parabola, whose turning point is half-way between two samples."""
    rng, sites, order = np.random.default_rng(SEED), 80, taylor_order(tolerance)
    stribeck = law is FrictionLaw.STRIBECK
    cell = FrictionCell(law=law, **{"v_s" if stribeck else "v0": scale})  # type: ignore[arg-type]

    def left_out(x: float, u: float) -> float:
        if stribeck:
            hermite = 1.09 * (math.sqrt(2.0) * x) ** order / math.sqrt(math.factorial(order))
            return math.exp(-0.5 * u * u) * hermite
        return math.exp(-u) * x**order / math.factorial(order) if x > 1.0 else 0.0

    steps, turns = rng.choice([0.3, 0.6], sites), (2 * rng.integers(8, 16, sites) + 1) / 32.0
    ways, ends = rng.uniform(2.0, 12.0, sites), np.zeros(sites)
    for n, x in enumerate(ways):
        # It turns where the bound allows it, or somewhat nearer or farther.
        power = max(0.0, math.log(left_out(x, 0.0) / tolerance))
        asked = math.sqrt(2.0 * power) if stribeck else power
        ends[n] = max(0.1, asked + rng.uniform(-1.0, 1.0) * (0.1 if n % 2 else 1.0))
    bends = ways * scale / (steps * turns) ** 2
    series = np.zeros((4, order + 1, sites))
    series[1, 0] = side * scale * (ends + ways)
    series[1, 1] = -2.0 * side * bends * steps * turns
    series[1, 2] = side * bends
    found = steps.copy()
    resolved_steps(series, new_numbers(cell, 0.1, tolerance), law_of(cell), side, found)
    kept = [left_out(x, u) <= tolerance for x, u in zip(ways, ends, strict=True)]
    assert (found == steps).tolist() == kept
    assert 20 < sum(kept) < sites - 20
    for n, h in enumerate(found):
        assert h > 0.0
        assert math.log2(steps[n] / h).is_integer()
        part = min(h / steps[n], turns[n])
        nearest = scale * ends[n] + bends[n] * (steps[n] * (turns[n] - part)) ** 2
        start = scale * (ends[n] + ways[n])
        assert left_out((start - nearest) / scale, nearest / scale) <= tolerance


@pytest.mark.parametrize("law", [FrictionLaw.EXPONENTIAL, FrictionLaw.STRIBECK])
def test_a_step_away_from_stick_or_towards_it_at_one_rate_is_halved_if_it_must(
    law: FrictionLaw,
) -> None:
    sites, tolerance, order, scale = 60, 1e-9, taylor_order(1e-9), 0.1
    stribeck = law is FrictionLaw.STRIBECK
    cell = FrictionCell(law=law, **{"v_s" if stribeck else "v0": scale})  # type: ignore[arg-type]
    starts = np.linspace(0.0, 2.0, sites)
    series = np.zeros((4, order + 1, sites))
    series[1, 0] = -starts
    numbers, found = new_numbers(cell, 0.1, tolerance), np.full(sites, 0.7)
    series[1, 1] = -3.0
    resolved_steps(series, numbers, law_of(cell), -1.0, found)
    assert found.tolist() == [0.7] * sites
    series[1, 1], found[:] = 2.0 * starts, 0.5  # to stick itself
    resolved_steps(series, numbers, law_of(cell), -1.0, found)
    for start, h in zip(starts, found, strict=True):
        x = start / scale
        if stribeck:
            most = (math.sqrt(2.0) * x) ** order / math.sqrt(math.factorial(order)) * 1.09
        else:
            most = x**order / math.factorial(order) if x > 1.0 else 0.0
        assert (h == 0.5) == (most <= tolerance)


@pytest.mark.parametrize("v_d", [0.01, 0.5, 1.25])
def test_excited_sites_start_where_the_cycle_turns(v_d: float) -> None:
    """The run of one site that finds the turning points, against shooting by phases of slip."""
    cell = replace(CELL, v_d=v_d)
    cycle = stick_slip_cycle(cell)
    for point, y in ((StartPoint.MAXIMUM, cycle.max), (StartPoint.MINIMUM, cycle.min)):
        # Both are good to 1e-12 a step, some tens of steps.
        assert excite(FrictionChain.of(cell, c=0.0, sites=1), [1], point=point)[0, 0] == (
            pytest.approx(y, abs=1e-11)
        )


def test_a_front_whose_start_is_at_rest_has_collapsed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The only cycle of this cell is too small for the start to differ from steady sliding."""
    chain = FrictionChain(
        c=1e-5, v_d=2.0, mu_st=0.4, mu_d=0.2, xi=1.5, law="stribeck", v_s=0.05, sites=61
    )
    start = excite(chain, [1])
    assert start == pytest.approx(np.tile([[0.2], [0.0]], 61), abs=1e-15)
    asked: list[float] = []

    def noted(run: Any, stop: float, steps: int) -> int:
        asked.append(stop)
        return StopCode.REACHED

    with monkeypatch.context() as patched:
        patched.setattr(friction, "advance", noted)
        FrictionIntegration(chain, start, tolerance=1e-8).advance(1000)
    assert np.isfinite(asked).all()  # otherwise the compiled code below would not return
    assert measure_front(chain).status is FrontStatus.COLLAPSED


def test_a_budget_of_one_step_is_taken() -> None:
    chain = FrictionChain(c=0.05, sites=7)
    run = FrictionIntegration(chain, excite(chain, [4]), [100.0], tolerance=1e-8)
    run.advance(1)
    first = run.time
    run.advance(1)
    assert 0.0 < first < run.time < 100.0


@pytest.mark.parametrize("part", [0.5, 1.5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_site_at_the_velocity_of_the_belt_slips_if_spring_and_damper_overcome_friction(
    part: float, sign: float
) -> None:
    """The damper pulls with 2ξv_d, backwards whichever way the spring does."""
    cell = FrictionCell()
    y = sign * cell.mu_st - part * 2.0 * cell.xi * cell.v_d
    chain = FrictionChain.of(cell, c=0.0, sites=2)
    run = FrictionIntegration(chain, np.array([[y, 0.0], [cell.v_d, cell.v_d]]))
    slips = part < 1.0 if sign > 0.0 else part > 1.0
    assert run._run.mode[friction.MODE, 1:-1].tolist() == [-sign if slips else 0.0, 0.0]


@pytest.mark.parametrize(("part", "slips"), [(0.99, False), (1.01, True)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_site_at_the_velocity_of_the_belt_is_pulled_by_its_neighbours_too(
    part: float, slips: bool, sign: float
) -> None:
    """By 2c·y of them, against the direction in which they are displaced."""
    cell, c = FrictionCell(), 0.1
    most = cell.mu_st - sign * 2.0 * cell.xi * cell.v_d
    y = -sign * part * most / (2.0 * c)
    start = np.array([[y, 0.0, y], [cell.v_d] * 3])
    run = FrictionIntegration(FrictionChain.of(cell, c=c, sites=3), start)
    assert run._run.mode[friction.MODE, 2] == (-sign if slips else 0.0)


@friction_outer
def widen(site: np.ndarray, numbers: np.ndarray, counters: np.ndarray) -> None:
    _widen(site, numbers, counters)


@pytest.mark.parametrize("row", [Y, W])
@pytest.mark.parametrize("away", [1.5, -1.5])
@pytest.mark.parametrize(
    "moving",
    [(5,), (9,), (17,), (21,), (22, 25), (26,), (16, 23), (24, 29), (15, 33), (32,), (37,)],
)
def test_a_window_contains_all_sites_within_its_margin_of_those_that_move(
    row: int, away: float, moving: tuple[int, ...]
) -> None:
    """And is not closed; sites within the distance of rest, or outside of it, do not count."""
    low, high, rest = 14, 34, 2.0**-30
    for first, last in ((low, high), (4, high), (low, 40)):
        run = friction.new_run(new_numbers(CELL, 0.1, 1e-9), law_of(CELL), np.zeros((2, 41)),
                               np.full(41, 2.0), times=np.zeros(0), logged=0, order=12)  # fmt: skip
        # Numbers of which all sums are exact.
        run.numbers[[REST, SLIDING, V_D]] = rest, 0.5, 1.25
        run.site[Y], run.site[W] = 0.5, -1.25
        run.site[row] += np.sign(away) * rest
        run.site[row, list(moving)] += away * rest
        run.counters[[friction.LO, friction.HI]] = first, last
        widen(run.site, run.numbers, run.counters)
        margin = friction.MARGIN
        seen = [n for n in moving if first <= n < last]
        beside = {m for n in seen for m in range(n - margin, n + margin + 1) if 1 <= m <= 41}
        window = sorted(beside | set(range(first, last)))
        assert run.counters[[friction.LO, friction.HI]].tolist() == [window[0], window[-1] + 1]


def test_a_window_is_widened_alike_on_either_side() -> None:
    chain = FrictionChain(c=0.02, sites=61)
    run = FrictionIntegration(chain, excite(chain, [31]))
    counters = run._run.counters
    first = int(counters[friction.LO])
    run.advance_to(30.0)
    assert 1 < counters[friction.LO] < first
    assert counters[friction.LO] - 1 == chain.sites + 1 - counters[friction.HI]
    np.testing.assert_array_equal(run.state, run.state[:, ::-1])


@pytest.mark.parametrize("active_window", [True, False])
def test_the_sites_between_both_ends_of_the_window_are_counted_as_stepped(
    active_window: bool,
) -> None:
    chain = FrictionChain(c=0.02, sites=61)
    run = FrictionIntegration(chain, excite(chain, [51]), active_window=active_window)
    low, high = (int(run._run.counters[n]) for n in (friction.LO, friction.HI))
    assert low == (51 - friction.MARGIN if active_window else 1)
    assert high == (51 + friction.MARGIN + 1 if active_window else 62)
    run.advance(1)
    assert run.counts["site_steps"] == (high - low) * run.counts["steps"] > 0


@friction_outer
def ranges_around(run: friction.Run, due: int, radius: int) -> int:
    return _ranges(run, due, radius)


@pytest.mark.parametrize(
    ("due", "radius", "ranges"),
    [
        ([10], 3, [(7, 14)]),
        ([10, 30], 3, [(7, 14), (27, 34)]),
        ([10, 18], 3, [(7, 14), (15, 22)]),  # site 14 keeps its series
        ([10, 17], 3, [(7, 21)]),
        ([10, 12, 14], 3, [(7, 18)]),
        ([2, 40], 3, [(1, 6), (37, 42)]),
        ([5, 20, 37], 40, [(1, 42)]),
    ],
)
def test_new_series_are_made_on_either_side_of_the_sites_that_are_due(
    due: list[int], radius: int, ranges: list[tuple[int, int]]
) -> None:
    run = friction.new_run(new_numbers(CELL, 0.1, 1e-9), law_of(CELL), np.zeros((2, 41)),
                           np.full(41, 2.0), times=np.zeros(0), logged=0, order=12)  # fmt: skip
    run.mode[DUE, : len(due)] = due
    count = ranges_around(run, len(due), radius)
    assert list(zip(*run.mode[[FIRST, BEYOND], :count].tolist(), strict=True)) == ranges
    assert run.counters[friction.LOCAL] == sum(beyond - first for first, beyond in ranges)


@friction_outer
def reach(numbers: np.ndarray, order: int, change: float, h: float) -> int:
    return _reach(numbers, order, change, h)


def bound_on_force(d: int, change: float, rate: float, c: float, time: float) -> float:
    """What a change of acceleration does within a time at distance d, by the module's docstring."""
    growth = math.exp(rate * time) * math.cosh(c * time**2)
    return c * change * growth * c**d * time ** (2 * d + 2) / math.factorial(2 * d + 2)


@pytest.mark.parametrize("c", [1e-3, 0.05, 1.0, 20.0])
@pytest.mark.parametrize("time", [0.01, 0.1, 0.5, 2.0])
def test_new_series_are_made_as_far_as_the_truncation_is_not_negligible(
    c: float, time: float
) -> None:
    """The bound of the module's docstring, with the positive root of q from numpy."""
    order, tolerance = 16, 1e-10
    numbers = new_numbers(replace(CELL, xi=1.0), c, tolerance)  # damping counts as well
    rates = np.roots([1.0, -(numbers[DRAG] + numbers[STEEPEST]), -(1.0 + 2.0 * c)])

    for change in np.geomspace(1e-3, 1e3, 31):
        forces = [bound_on_force(d, change, rates.max(), c, time) for d in range(1, order + 1)]
        enough = [d for d, force in enumerate(forces, start=1) if force <= 0.01 * tolerance]
        assert reach(numbers, order, change, time) == (enough[0] if enough else -1)


def test_a_frame_in_which_the_truncation_would_overflow_is_ended() -> None:
    for c, time in ((0.05, 1e3), (1e4, 1.0)):
        assert reach(new_numbers(CELL, c, 1e-10), 16, 1.0, time) == -1


@pytest.mark.parametrize("law", [FrictionLaw.EXPONENTIAL, FrictionLaw.STRIBECK])
def test_a_series_resolves_friction_if_the_term_beyond_is_below_the_tolerance(
    law: FrictionLaw,
) -> None:
    """The bounds of ``resolved``, as products and not as sums of logarithms."""
    cell = FrictionCell(law=law)
    scale = cell.v_s if law is FrictionLaw.STRIBECK else cell.v0
    compiled: Any = _seen
    found = []
    for order, tolerance in ((11, 1e-6), (18, 1e-12)):
        numbers = new_numbers(cell, 0.1, tolerance)
        allowed = math.log(tolerance) + math.log(math.factorial(order))
        for u in (0.0, 1.0, 5.0, 20.0, 35.0):
            # Where the term is the tolerance, and a thousandth of this to either side of it.
            edge = (tolerance * math.factorial(order) * math.exp(u)) ** (1.0 / order)
            if law is FrictionLaw.STRIBECK:
                size = tolerance / 1.09 * math.exp(0.5 * u * u) * math.sqrt(math.factorial(order))
                edge = size ** (1.0 / order) / math.sqrt(2.0)
            for x in (0.0, 0.05, 0.2, 0.9, 1.1, 2.0, 5.0, 20.0, 0.999 * edge, 1.001 * edge):
                small = math.exp(-u) * x**order / math.factorial(order) <= tolerance
                if law is FrictionLaw.STRIBECK:
                    hermite = (math.sqrt(2.0) * x) ** order / math.sqrt(math.factorial(order))
                    small = 1.09 * math.exp(-0.5 * u * u) * hermite <= tolerance
                distances = u * scale, (u + x) * scale
                seen = compiled.py_func(numbers, law_of(cell), order, *distances, allowed)
                assert seen is small, (order, x, u)
                found.append(small)
    assert 10 < sum(found) < len(found) - 10


@friction_outer
def switch(run: friction.Run, n: int, time: float) -> None:
    _switch(run, n, time)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("mode", "part", "kind", "following", "released"),
    [
        (0, 1.0, ENDS, -1, True),
        (1, 1 - 1e-6, BEGINS, 0, False),
        (1, -1 + 1e-6, BEGINS, 0, False),
        (1, 1 + 1e-6, REVERSES, -1, False),
        # Slip against the force has only come to the velocity of the belt for an instant.
        (1, -1 - 1e-6, None, 1, True),
    ],
)
def test_the_mode_after_an_event_is_that_of_the_static_force(
    side: int, mode: int, part: float, kind: int | None, *, following: int, released: bool
) -> None:
    """The static force is 2ξv_d + y + c(…): ``part`` times μ_st, or all of it with its mirror."""
    cell = FrictionCell(mu_st=0.8, mu_d=0.3, xi=0.3, v_d=0.7)
    c, own = 0.4, np.array([1.0, 2.0, 1.0])
    for n in (1, 2, 3):
        y = np.array([0.3, -0.5, 1.1])
        others = sum(y[m] for m in (n - 2, n) if 0 <= m < 3)
        load = side * part * cell.mu_st - 2.0 * cell.xi * cell.v_d
        y[n - 1] = (load + c * others) / (1.0 + c * own[n - 1])
        run = friction.new_run(new_numbers(cell, c, 1e-9), law_of(cell), np.array([y, np.zeros(3)]),
                               own, times=np.zeros(0), logged=1, order=12)  # fmt: skip
        run.mode[MODE, n] = side * mode
        switch(run, n, 3.5)
        assert run.mode[MODE, n] == side * following
        assert run.mode[RELEASED, n] == released
        assert run.site[W, 1:-1].tolist() == [-0.7 * (m != n) for m in (1, 2, 3)]
        assert run.counters[friction.KINDS :].tolist() == [each == kind for each in range(3)]
        assert run.counters[friction.LOGGED] == (kind is not None)
        assert run.log.tolist() == ([[0.0] * 3] if kind is None else [[3.5, n, kind]])
        arrival = 3.5 if kind == BEGINS else np.nan
        assert run.site[ARRIVAL, n] == pytest.approx(arrival, nan_ok=True)


def test_events_are_logged_until_the_log_is_full_and_the_first_arrival_remains() -> None:
    """Static friction just holds what pulls with μ_st itself."""
    cell = FrictionCell(xi=0.0)
    y = np.array([cell.mu_st, -cell.mu_st, 1.25])
    run = friction.new_run(new_numbers(cell, 0.0, 1e-9), law_of(cell), np.array([y, np.zeros(3)]),
                           np.zeros(3), times=np.zeros(0), logged=3, order=12)  # fmt: skip
    events = [
        (1, BEGINS, 1.0),
        (2, BEGINS, 1.5),
        (1, ENDS, 2.0),
        (2, ENDS, 2.5),
        (1, REVERSES, 3.0),
    ]
    for n, kind, time in events:
        run.site[Y, 1] = 1.25 if kind == REVERSES else cell.mu_st
        run.mode[MODE, n] = {BEGINS: -1, ENDS: 0, REVERSES: 1}[kind]
        switch(run, n, time)
        assert run.mode[MODE, n] == (0 if kind == BEGINS else {1: -1, 2: 1}[n])
    run.mode[MODE, 1], run.site[Y, 1] = -1, cell.mu_st
    switch(run, 1, 4.0)
    assert run.log.tolist() == [[time, n, kind] for n, kind, time in events[:3]]
    assert run.counters[friction.LOGGED] == 3
    assert run.counters[friction.KINDS :].tolist() == [3, 2, 1]
    assert run.site[ARRIVAL, 1:3].tolist() == [1.0, 1.5]


def test_sites_at_the_verge_of_release_are_released_one_after_another_at_one_time() -> None:
    """The belt is too slow to move them, but to round-off: each is looked at as its neighbour goes.

    They start one unit in the last place below the verge, and have gone 0.7 of it as the first one
    sticks. Time stands still for as many releases as there are sites.
    """
    sites, speed = 30, 1e-3
    below = np.nextafter(CELL.mu_st, 0.0)
    v_d = 0.7 * (CELL.mu_st - below) / (speed / CELL.mu_st)
    chain = FrictionChain.of(replace(CELL, v_d=v_d, xi=0.0), c=0.0, sites=sites)
    start = np.array([np.full(sites, below), np.full(sites, v_d)])
    start[:, 0] = 0.0, -speed
    run = FrictionIntegration(chain, start, logged_events=2 * sites)
    run.advance_to(2.0 * speed / CELL.mu_st)
    assert run.events == {"sticks": 1, "releases": sites - 1, "reversals": 0}
    log = run.state_arrays["log"][:sites]
    assert log[:, 1].tolist() == list(range(1, sites + 1))
    # Static friction stops the first one, but for what friction loses at its speed.
    assert log[:, 0] == pytest.approx(speed / CELL.mu_st, rel=speed)
    assert np.ptp(log[:, 0]) == 0.0


@friction_outer
def turning_point(w: np.ndarray, work: np.ndarray, after: float, h: float) -> tuple[float, int]:
    """Of the middle one of three sites, on a belt of velocity 3/4."""
    return _turning_point(w, work, 0.75, 1, after, h)


def test_turning_points_are_the_roots_of_the_velocity_one_after_another() -> None:
    """Of cubics with simple roots at known times, that rise first or fall."""
    for roots in ([0.25, 0.5, 0.75], [0.125, 0.5, 1.5], [0.0, 0.5, 0.875], [-0.5, 0.0, 0.25]):
        for sign in (1.0, -1.0):
            w = np.zeros((4, 3))
            w[:, 1] = sign * np.polynomial.polynomial.polyfromroots(roots)
            w[0, 1] -= 0.75
            for h in (0.3, 1.0):
                after, expected = 0.0, [t for t in roots if 0.0 < t <= h]
                for t in expected:
                    after, kind = turning_point(w, new_work(3), after, h)
                    assert after == pytest.approx(t, rel=1e-12)
                    # y is lowest where its velocity rises.
                    slope = sum(k * w[k, 1] * t ** (k - 1) for k in (1, 2, 3))
                    assert kind == int(slope > 0.0)
                assert turning_point(w, new_work(3), after, h)[0] == np.inf


@pytest.mark.parametrize("first", [0.0, 0.5, -0.5])
def test_a_site_that_starts_at_rest_turns_only_if_it_is_pulled(first: float) -> None:
    w = np.zeros((4, 3))
    w[:3, 1] = -0.75, first, -2.0 * first
    found, kind = turning_point(w, new_work(3), 0.0, 1.0)
    assert found == (0.25 * 2.0 if first else np.inf)
    assert kind == (first < 0.0)


def test_a_site_whose_velocity_begins_to_fall_turns_nevertheless() -> None:
    w = np.zeros((4, 3))
    for sign in (1.0, -1.0):
        w[:3, 1] = 0.25 * sign - 0.75, 0.0, -sign
        assert turning_point(w, new_work(3), 0.0, 1.0) == (0.5, int(sign < 0.0))


COULOMB = FrictionCell(law=FrictionLaw.COULOMB, mu_st=1.0, mu_d=0.5, xi=0.1, v_d=1.25)


@friction_outer
def renew(run: friction.Run, lo: int, hi: int, now: float, length: float) -> float:
    return _renew(run, lo, hi, now, length)


def coulomb_run(start: np.ndarray, c: float, tolerance: float, order: int) -> friction.Run:
    own = np.full(start.shape[1], 2.0)
    own[[0, -1]] = 1.0
    return friction.new_run(new_numbers(COULOMB, c, tolerance), law_of(COULOMB), start, own,
                            times=np.zeros(0), logged=0, order=order)  # fmt: skip


@pytest.mark.parametrize(("tolerance", "order"), [(1e-10, 12), (1e-3, 14), (1e3, 4)])
@pytest.mark.parametrize("sites", [15, 32, 320])
def test_a_frame_is_so_long_that_a_sixteenth_of_the_series_expire(
    tolerance: float, order: int, sites: int
) -> None:
    """A series holds until one of its last two terms, |y_k| + |w_k| times h^k, is the tolerance."""
    rng = np.random.default_rng(sites)
    start = rng.uniform(-1.0, 1.0, (2, sites))
    start *= 1e-4  # sites that move little hold longer
    some = rng.choice(sites, max(1, sites // 16), replace=False)
    start[:, some] *= 10.0 ** np.linspace(4.0, 1.5, some.size)
    start[0] += COULOMB.mu_d
    run = coulomb_run(start, 0.01, tolerance, order)
    length = renew(run, 1, sites + 1, 0.0, -1e3)
    before, last = np.abs(run.series[[Y, W], -2:, 1:-1]).sum(axis=0)
    holds = np.minimum((tolerance / before) ** (1 / (order - 1)), (tolerance / last) ** (1 / order))
    assert (length > 1.0) is (tolerance > 1e-10)
    # The shortest one, times a power of √2.
    steps = 2.0 * math.log2(length / holds.min())
    assert steps == pytest.approx(round(steps), abs=1e-9)
    expired = [
        16 * np.count_nonzero(holds < each * length - 1e-9) for each in (1.0, math.sqrt(2.0))
    ]
    assert expired[0] <= sites < expired[1]
    assert expired[0] > 0 or sites < 320 or tolerance == 1e-3
    assert run.site[END, 1:-1] == pytest.approx(np.minimum(length, holds), rel=1e-4)
    # A frame is not longer than is asked for.
    assert renew(run, 1, sites + 1, 0.0, -0.5 * length) == 0.5 * length
    assert run.site[END, 1:-1] == pytest.approx(np.minimum(0.5 * length, holds), rel=1e-4)


def test_series_that_end_before_time_can_be_counted_end_the_frame() -> None:
    rng = np.random.default_rng(SEED)
    start = np.array([rng.uniform(0.0, 1.0, 9), rng.uniform(-1.0, 1.0, 9)])
    start[:, [0, -1]] *= 1e-3
    run = coulomb_run(start, 0.01, 1e-10, 12)
    length = 1.1 * renew(run, 1, 10, 0.0, -1e3)
    for late, clock in ((False, 0.0), (False, 1e3), (True, 1e18)):
        run.numbers[CLOCK] = clock
        assert renew(run, 1, 10, 0.0, length) == (0.0 if late else length)
    run.numbers[CLOCK], run.site[Y, 5] = 0.0, np.inf
    assert np.isnan(renew(run, 1, 10, 0.0, length))
    # Coefficients grow by some 1e20 at every second one; only the last is too large a number.
    run = coulomb_run(np.array([[0.0, 0.0], [1e196, -1e196]]), 5e19, 1e-10, 12)
    assert np.isnan(renew(run, 1, 3, 0.0, -1.0))
    assert np.isfinite(run.series[[Y, W], :-1]).all()


def first_fall(f: np.ndarray, h: float) -> float:
    """When a polynomial that is positive first becomes negative, by numpy; inf if not until h."""
    roots = np.polynomial.Polynomial(np.trim_zeros(f, "b")).roots()
    real = roots[np.abs(roots.imag) < 1e-9].real
    return float(min(real[(real > 0.0) & (real <= h)], default=np.inf))


@pytest.mark.parametrize("seed", range(6))
def test_new_series_between_older_ones_are_solutions_with_their_own_events(seed: int) -> None:
    """Every coefficient follows from (5), and the series beside them are those of older times.

    Three ranges are renewed one after another, the last two at one time.
    """
    rng, sites, c, order = np.random.default_rng(seed), 14, 0.2, 12
    start = np.array([rng.uniform(-0.2, 0.4, sites), rng.uniform(0.3, 1.0, sites)])
    others = rng.choice(sites, 8, replace=False)  # in stick, and ahead of the belt
    start[1, others] = COULOMB.v_d + np.repeat([0.0, 0.3], 4)
    run = coulomb_run(start, c, 1e-4, order)
    beyond = np.append(run.queue, [-1.0, -1.0])  # what lies beyond the tree is not read
    run = run._replace(queue=beyond[:-2])
    site, mode, queue = run.site, run.mode[MODE], run.queue
    length, leaves = renew(run, 1, sites + 1, 0.0, -1e3), queue.size // 2
    edges = 0.02 * length, 0.05 * length
    assert edges[1] < site[EVENT, 1:-1].min() < length
    for lo, hi, now, held in ((2, 5, edges[0], 0.9), (5, 8, edges[1], 0.5), (8, 15, edges[1], 0.2)):
        old, begins = run.series[:2].copy(), site[START].copy()
        later = np.zeros_like(old)
        for q in (Y, W):
            for n in range(1, sites + 1):
                moved = np.polynomial.Polynomial([now - begins[n], 1.0])
                coefficients = np.polynomial.Polynomial(old[q, :, n])(moved).coef
                later[q, : coefficients.size, n] = coefficients
        site[END, (lo - 1, hi)[seed % 2]] = now + held * (length - now)
        others = np.r_[0:lo, hi : sites + 2]
        assert renew(run, lo, hi, now, length) == length
        assert np.array_equal(run.series[:2][:, :, others], old[:, :, others])
        assert np.array_equal(
            site[START], np.where(np.isin(np.arange(sites + 2), others), begins, now)
        )
        y, w = run.series[Y].copy(), run.series[W]
        y[:, others] = later[Y][:, others]
        k, first = np.arange(1, order + 1), np.eye(order)[0]
        for n in range(lo, hi):
            assert [y[0, n], w[0, n]] == pytest.approx(later[:, 0, n], rel=1e-12)
            assert site[[Y, W], n].tolist() == [y[0, n], w[0, n]]
            pull = y[:, n] + c * (site[OWN, n] * y[:, n] - y[:, n - 1] - y[:, n + 1])
            pull[0] += 2.0 * COULOMB.xi * COULOMB.v_d
            force = pull[:-1] + 2.0 * COULOMB.xi * w[:-1, n] + mode[n] * COULOMB.mu_d * first
            assert k * y[1:, n] == pytest.approx(w[:-1, n] + COULOMB.v_d * first, abs=1e-13)
            assert k * w[1:, n] == pytest.approx(-abs(mode[n]) * force, abs=1e-12)
            terms = np.abs(y[-2:, n]) + np.abs(w[-2:, n])
            holds = (1e-4 / np.maximum(terms, 1e-300)) ** (1 / np.array([order - 1, order]))
            ends = min(length, now + holds.min())
            beside = [site[END, m] for m in (n - 1, n + 1)
                      if m in others or (mode[n] == 0 != mode[m] and m < n)]  # fmt: skip
            if not (mode[n] == 0 != mode[n + 1] and n + 1 < hi):
                assert site[END, n] == pytest.approx(max(now, min([ends, *beside])), rel=1e-9)
            assert site[END, n] <= min([ends, *beside]) * (1.0 + 1e-9)
            falling = [mode[n] * w[:, n]]
            if mode[n] == 0:
                falling = [COULOMB.mu_st * np.eye(order + 1)[0] - s * pull for s in (1.0, -1.0)]
            event = min(first_fall(f, site[END, n] - now) for f in falling)
            assert site[EVENT, n] == pytest.approx(now + event, rel=1e-9)
            expires = site[END, n] if site[END, n] < length else np.inf
            assert queue[leaves + n] == min(site[EVENT, n], expires)
        assert np.array_equal(queue[1:leaves], queue[2:].reshape(-1, 2).min(axis=1))
        assert np.isinf(queue[[leaves, leaves + sites + 1]]).all()
    assert mode[1:-1].min() < 0 < mode.max()


@pytest.mark.parametrize("sampled", [True, False])
@pytest.mark.parametrize(("c", "sizes"), [(0.0, [1.2, -0.7, 1e-3]), (1e5, [0.002, -0.002])])
def test_the_last_turning_points_are_those_of_a_damped_oscillator(
    sampled: bool, c: float, sizes: list[float]
) -> None:
    """y - μ_d = A e^{-ξτ} (cos ωτ + (ξ/ω) sin ωτ), which turns whenever ωτ is a multiple of π.

    Two sites that swing against each other are coupled twice. They turn several times in a frame,
    whatever the work space contains.
    """
    size, xi, free = np.array(sizes), COULOMB.xi, math.sqrt(1.0 + 2.0 * c)
    omega, own = math.sqrt(free**2 - xi**2), np.ones(len(sizes))
    stops = [each / free for each in (1.0, 1.75, 7.5, 9.3, 17.0)]
    times = np.sort(np.concatenate([np.linspace(0.0, stops[-1], 120), stops]))
    times = times if sampled else times[:0]
    start = np.array([COULOMB.mu_d + size, 0.0 * size])
    run = friction.new_run(new_numbers(COULOMB, c, 1e-12), law_of(COULOMB), start, own,
                           times=np.append(times, 0.0)[:-1], logged=9, order=30)  # fmt: skip
    room = np.zeros((times.size + 1, 3, size.size))
    run = run._replace(samples=room[:-1])
    run.work[POLYNOMIAL : KEPT + 2] = 1.0
    for stop in stops:
        assert friction.advance(run, stop, 100) == StopCode.REACHED
        assert run.numbers[CLOCK] == stop
    # What lies beyond the times and the samples is neither read nor written.
    assert run.counters[friction.SAMPLED] == times.size
    assert not room[-1].any()
    assert run.counters[friction.FRAMES] < 10
    assert run.counters[friction.LOCAL] == 0  # of less than 16 series none expires in a frame
    # It starts at rest, at a point at which it does not turn.
    turn = COULOMB.mu_d + size[:, None] * (-math.exp(-math.pi * xi / omega)) ** np.arange(6)
    for k, t in enumerate(times):
        turned, decay = int(omega * t / math.pi), size * math.exp(-xi * t)
        wave = math.cos(omega * t) + xi / omega * math.sin(omega * t)
        assert run.samples[k, 0] == pytest.approx(COULOMB.mu_d + decay * wave, abs=1e-10)
        wave = -(free**2) * math.sin(omega * t) / omega
        assert run.samples[k, 1] == pytest.approx(decay * wave - COULOMB.v_d, abs=1e-9)
        half = 0.5 * abs(turn[:, turned] - turn[:, turned - 1])
        half = half if turned > 1 else np.full(size.size, np.nan)
        assert run.samples[k, 2] == pytest.approx(half, abs=1e-10, nan_ok=True)
    last = np.sort(turn[:, 4:6], axis=1)
    found = run.site[[LAST_MINIMUM, LAST_MAXIMUM], 1:-1].T
    assert found == pytest.approx(last, abs=1e-10)
    assert not run.log.any()


def test_sites_outside_of_the_window_are_sampled_as_they_are() -> None:
    """Also if they are made to begin beside sites that move."""
    cell, times = replace(COULOMB, xi=0.0), np.linspace(0.0, 9.0, 40)
    sizes = np.array([0.3, -0.4, 0.5, 0.6, -0.7])
    start = np.array([cell.mu_d + sizes, 0.0 * sizes])
    run = friction.new_run(new_numbers(cell, 0.0, 1e-12), law_of(cell), start, 0.0 * sizes,
                           times=times, logged=0, order=30)  # fmt: skip
    run.counters[[friction.LO, friction.HI]] = 2, 5
    for stop in (3.1, 9.0):
        assert friction.advance(run, stop, 100) == StopCode.REACHED
    swing = sizes * np.where([False, True, True, True, False], np.cos(times)[:, None], 1.0)
    assert run.samples[:, 0] == pytest.approx(cell.mu_d + swing, abs=1e-10)
    fall = sizes * np.where([False, True, True, True, False], -np.sin(times)[:, None], 0.0)
    assert run.samples[:, 1] == pytest.approx(fall - cell.v_d, abs=1e-10)


@pytest.mark.parametrize("sampled", [True, False])
def test_stick_and_slip_of_uncoupled_sites_are_those_of_a_circle_and_its_tangent(
    sampled: bool,
) -> None:
    """Slip about μ_d begins and ends at the velocity v_d, at a distance D of μ_st - μ_d from it."""
    cell = replace(COULOMB, xi=0.0)
    radius, half = math.hypot(0.5, cell.v_d), math.atan(0.5 / cell.v_d)
    slip, stick = 2.0 * math.pi - 2.0 * half, 1.0 / cell.v_d
    # Phases: time since slip began, negative in stick; the first one begins to slip at once.
    phases = np.array([0.0, 0.3, slip - 0.4, -0.25 * stick, -0.75 * stick])
    angles = phases + half
    y = np.where(phases < 0.0, 1.0 + cell.v_d * phases, 0.5 + radius * np.sin(angles))
    v = np.where(phases <= 0.0, cell.v_d, radius * np.cos(angles))
    times = np.linspace(0.0, 20.0, 301)[: 301 * sampled]
    run = friction.new_run(new_numbers(cell, 0.0, 1e-12), law_of(cell), np.array([y, v]), 0.0 * y,
                           times=times, logged=99, order=30)  # fmt: skip
    for stop in (0.1, 7.0, 20.0):
        assert friction.advance(run, stop, 100) == StopCode.REACHED
    for n, phase in enumerate(phases, start=1):
        begins = [t for k in range(5) if 0.0 < (t := slip - phase + k * (slip + stick)) < 20.0]
        ends = [t for k in range(5) if 0.0 < (t := -phase + k * (slip + stick)) < 20.0 or t == 0.0]
        log = run.log[run.log[:, 1] == n]
        assert log[log[:, 2] == BEGINS, 0] == pytest.approx(np.array(begins), abs=1e-10)
        assert log[log[:, 2] == ENDS, 0] == pytest.approx(np.array(ends), abs=1e-10)
        first = 0.0 if phase <= 0.0 else begins[0]
        assert run.site[ARRIVAL, n] == pytest.approx(first, abs=1e-10)
        assert run.site[[LAST_MAXIMUM, LAST_MINIMUM], n] == pytest.approx(
            [0.5 + radius, 0.5 - radius]
        )
        for k, t in enumerate(times):
            since = (phase + t + stick) % (slip + stick) - stick
            angle = since + half
            y_now = 1.0 + cell.v_d * since if since < 0.0 else 0.5 + radius * math.sin(angle)
            v_now = cell.v_d if since < 0.0 else radius * math.cos(angle)
            assert run.samples[k, 0, n - 1] == pytest.approx(y_now, abs=1e-9)
            assert run.samples[k, 1, n - 1] == pytest.approx(v_now - cell.v_d, abs=1e-9)
            highest = 0.5 * math.pi - half - phase
            seen = t > max(each % (slip + stick) for each in (highest, highest + math.pi))
            assert np.isnan(run.samples[k, 2, n - 1]) != seen
            assert not seen or run.samples[k, 2, n - 1] == pytest.approx(radius, abs=1e-9)


def before_and_after_a_frame(
    cell: FrictionCell, start: np.ndarray, c: float, tolerance: float, length: float
) -> tuple[friction.Run, friction.Run]:
    """Return a chain with the series that a frame begins with, and another one at its end."""
    own = np.full(start.shape[1], 2.0)
    own[[0, -1]] = 1.0
    first, run = (
        friction.new_run(new_numbers(cell, c, tolerance), law_of(cell), start.copy(), own,
                         times=np.zeros(0), logged=9, order=16)
        for _ in range(2)
    )  # fmt: skip
    assert renew(first, 1, start.shape[1] + 1, 0.0, -length) == length
    assert friction.advance(run, length, 1) == StopCode.REACHED
    return first, run


def assert_renewed_within_two(  # noqa: PLR0917
    first: friction.Run,
    run: friction.Run,
    parts: tuple[float, ...],
    change: float,
    rate: float,
    c: float,
    left: float,
) -> None:
    """Site 21 and two sites to either side have new series, as the bound says for each part."""
    tolerance = first.numbers[TOLERANCE]
    for part in parts:
        forces = [bound_on_force(d, part * change, rate, c, left) for d in range(4)]
        assert [force <= 0.01 * tolerance for force in forces] == [False, False, True, True]
    renewed = np.flatnonzero((run.series[Y] != first.series[Y]).any(axis=0))
    assert renewed.tolist() == [19, 20, 21, 22, 23]


def test_a_site_gets_new_series_as_far_as_its_new_motion_is_felt() -> None:
    """Weak friction holds it, until neighbours that rush by accelerate it a thousand times more."""
    cell = replace(COULOMB, mu_st=0.01, mu_d=0.005, xi=0.0, v_d=1.0)
    c, tolerance, sites, length, speed = 0.05, 1e-6, 41, 0.1, 1000.0
    start = np.array([np.zeros(sites), np.full(sites, speed)])
    start[1, 20] = cell.v_d
    first, run = before_and_after_a_frame(cell, start, c, tolerance, length)
    assert run.log[:, 1:].tolist() == [[21, ENDS], *[[0, 0]] * 8]
    left = length - run.log[0, 0]
    change = 2.0 * c * speed * left  # what the force, and its acceleration, becomes
    parts = (0.5, 20.0)  # not nearer, and no farther than a bound that is not wasteful
    assert_renewed_within_two(first, run, parts, change, math.sqrt(1.0 + 2.0 * c), c, left)


def test_a_site_that_sticks_gets_new_series_as_far_as_its_old_motion_was_expected() -> None:
    """Beyond the velocity of the belt friction continued as in slip would rise exponentially."""
    cell = FrictionCell(mu_st=1.0, mu_d=0.5, xi=0.0, v0=0.1, v_d=1.0)
    c, tolerance, sites, length = 0.05, 1.8e-4, 41, 0.3
    start = np.array([np.full(sites, cell.steady_sliding), np.zeros(sites)])
    start[:, 20] = 0.0, cell.v_d - 0.1
    first, run = before_and_after_a_frame(cell, start, c, tolerance, length)
    assert run.log[:, 1:].tolist() == [[21, BEGINS], *[[0, 0]] * 8]
    times = np.linspace(run.log[0, 0], length, 100)
    change = abs(np.polynomial.Polynomial(first.series[W, :, 21]).deriv()(times)).max()
    left, drag = length - times[0], run.numbers[DRAG] + run.numbers[STEEPEST]
    rate = np.roots([1.0, -drag, -(1.0 + 2.0 * c)]).max()
    parts = (1.0, 20.0)  # not nearer, and no farther than a bound that is not wasteful
    assert_renewed_within_two(first, run, parts, change, rate, c, left)


def test_a_site_released_at_the_end_of_a_frame_is_not_stopped_by_rounding() -> None:
    """Its acceleration is zero exactly, whichever numbers cancel in it."""
    rng = np.random.default_rng(SEED)
    for _ in range(30):
        cell = FrictionCell(
            mu_d=rng.uniform(0.2, 0.8), xi=rng.uniform(0.0, 0.3), v_d=rng.uniform(0.3, 1.0)
        )
        start = np.array(
            [np.full(2, cell.release - rng.uniform(0.001, 0.002)), np.full(2, cell.v_d)]
        )
        run = FrictionIntegration(FrictionChain.of(cell, c=1e6, sites=2), start)
        run.advance_to(0.01)
        assert run.events == {"sticks": 0, "releases": 2, "reversals": 0}
        assert run.counts["steps"] > 1


@pytest.mark.parametrize("clock", [0.0, 1e3])
@pytest.mark.parametrize(("apart", "together"), [(0.4, True), (1.6, False)])
def test_events_within_a_few_units_of_round_off_are_one(
    clock: float, apart: float, together: bool
) -> None:
    """Of the time since the frame began, or of that since the run began."""
    cell = FrictionCell(xi=0.0, v_d=1.0)
    numbers = new_numbers(cell, 0.0, 1e-9)
    numbers[CLOCK] = clock
    y = np.zeros(5)
    y[3] = apart * 8.9e-16 * max(1.0, clock)  # released earlier by as much
    run = friction.new_run(numbers, law_of(cell), np.array([y, np.ones(5)]), 0.0 * y,
                           times=np.zeros(0), logged=9, order=12)  # fmt: skip
    assert friction.advance(run, clock + 1.1, 10) == StopCode.REACHED
    assert run.counters[friction.KINDS :].tolist() == [0, 5, 0]
    assert run.log[:5, 0] == pytest.approx(clock + 1.0, rel=1e-14)
    order = [1, 2, 3, 4, 5] if together else [4, 1, 2, 3, 5]
    assert run.log[:5, 1].tolist() == order


@pytest.mark.parametrize(("away", "row"), [(1.0, 0), (-1.0, 1)])
def test_a_turning_point_at_the_very_end_of_a_run_is_recorded(away: float, row: int) -> None:
    """Under Coulomb's law ÿ is what y lacks to μ_d: here one, so that time and velocity agree."""
    cell = FrictionCell(law=FrictionLaw.COULOMB, xi=0.0)
    time = 2.0**-30
    start = np.array([[cell.mu_d + away], [away * time]])
    run = FrictionIntegration(FrictionChain.of(cell, c=0.0, sites=1), start, end=time)
    run.advance_to(time)
    assert run.state.tolist() == [[cell.mu_d + away], [0.0]]
    assert run.last_extremes[row].tolist() == [cell.mu_d + away]
    assert np.isnan(run.last_extremes[1 - row]).all()


@friction_outer
def rate_of(w: np.ndarray, n: int, h: float) -> float:
    return _rate(w, n, h)


def test_series_and_their_bounds_are_those_of_polynomials_of_numpy() -> None:
    rng = np.random.default_rng(SEED)
    for order, h in ((1, 0.3), (2, 0.7), (4, 1.0), (5, 1.3), (12, 0.9)):
        series = rng.standard_normal((order + 1, 3))
        exact = np.polynomial.Polynomial(series[:, 1])
        largest = np.polynomial.Polynomial(np.abs(series[:, 1]))
        functions: list[tuple[Any, float]] = [
            (site_value, exact(h)),
            (absolute_sum, largest(h) - largest(0.0)),
            (_largest_bend, largest.deriv(2)(h)),
        ]
        for function, value in functions:
            assert function.py_func(series, 1, h) == pytest.approx(value, rel=1e-12, abs=1e-14)
        assert rate_of(series, 1, h) == pytest.approx(largest.deriv()(h), rel=1e-12)
        compiled: Any = value_at
        assert compiled.py_func(series[:, 1], order, h) == pytest.approx(exact(h), rel=1e-12)
        site, every = np.zeros((ROWS, 3)), np.polynomial.Polynomial
        compiled = absolute_sums
        compiled.py_func(series, site, 1, 3, h)
        sums = [every(np.abs(series[:, n]))(h) - abs(series[0, n]) for n in (1, 2)]
        assert site[SUM] == pytest.approx([0.0, *sums], rel=1e-12)
        site[STEP] = 0.0, 0.5 * h, -h
        compiled = site_values
        compiled.py_func(series, site, 1, 3)
        values = [every(series[:, n])(site[STEP, n]) for n in (1, 2)]
        assert site[SUM] == pytest.approx([0.0, *values], rel=1e-12, abs=1e-14)
        later, compiled = np.zeros(order + 1), shift
        compiled.py_func(series, 1, h, later)
        moved = exact(np.polynomial.Polynomial([h, 1.0])).coef
        assert later == pytest.approx(moved, rel=1e-12, abs=1e-11)


@friction_outer
def expanded(run: friction.Run, bounds: np.ndarray) -> None:
    """Make the series of the sites from the first bound to before the second."""
    expand(run.series, run.site, run.mode, run.numbers, run.law, bounds[0], bounds[1])


@pytest.mark.parametrize("sites", [5, 13])
@pytest.mark.parametrize(
    "cell",
    [
        FrictionCell(viscous=0.1),
        FrictionCell(law="stribeck", viscous=0.1),
        FrictionCell(law="coulomb", viscous=0.1),
    ],
    ids=lambda cell: cell.law.value,
)
def test_series_solve_the_equations_of_motion(cell: FrictionCell, sites: int) -> None:
    """Shortly after the beginning; sites slip either way, stick, or are released at the verge."""
    rng, c, order, t = np.random.default_rng(SEED), 0.3, 12, 0.02
    y, v = rng.uniform(-1.0, 1.0, sites), cell.v_d + rng.uniform(-1.5, 1.5, sites)
    v[1::3] = cell.v_d
    for n in range(sites - 2, 0, -6):  # released: held by all of static friction until now
        v[n], beside = cell.v_d, y[n - 1] + y[n + 1]
        y[n] = (cell.mu_st - 2.0 * cell.xi * cell.v_d + c * beside) / (1.0 + 2.0 * c)
    run = friction.new_run(
        new_numbers(cell, c, 1e-9), law_of(cell), np.array([y, v]), np.full(sites, 2.0),
        times=np.zeros(0), logged=0, order=order,
    )  # fmt: skip
    for n in range(sites - 2, 0, -6):
        run.mode[MODE, n + 1], run.mode[RELEASED, n + 1] = -1, 1
    run.series[:2, 0] = run.site[:2]
    expanded(run, np.array([1, sites + 1]))
    whole = run.series.copy()
    positions, relative = (
        [np.polynomial.Polynomial(run.series[row, :, n]) for n in range(sites + 2)]
        for row in (0, 1)
    )
    kinds = set()
    for n in range(1, sites + 1):
        w, side = relative[n](t), int(run.mode[MODE, n])
        assert positions[n].deriv()(t) == pytest.approx(w + cell.v_d, abs=1e-11)
        kinds.add(side)
        if side == 0:
            assert not run.series[1, :, n].any()
            continue
        pull = positions[n](t) + c * np.dot([-1.0, 2.0, -1.0], [
            each(t) for each in positions[n - 1 : n + 2]
        ])  # fmt: skip
        # The force of friction, of which the viscous part is κw.
        force = -side * friction_coefficient(cell, abs(w))
        expected = force - 2.0 * cell.xi * (w + cell.v_d) - pull
        assert relative[n].deriv()(t) == pytest.approx(expected, abs=1e-11)
    assert {-1, 0} <= kinds
    run.series[:2, 1:, 2:4] = 7.0
    expanded(run, np.array([2, 4]))
    np.testing.assert_array_equal(run.series[:2], whole[:2])


def test_a_series_holds_until_one_of_its_last_two_terms_is_the_tolerance() -> None:
    compiled: Any = term_length
    for before, last in ((3.0, 1e-3), (1e-3, 3.0), (0.0, 2.0), (2.0, 0.0), (0.0, 0.5), (0.5, 0.0)):
        h = compiled.py_func(before, last, 12, 1e-9)
        assert max(before * h**11, last * h**12) == pytest.approx(1e-9, rel=1e-12)
    assert compiled.py_func(0.0, 0.0, 12, 1e-9) == np.inf


@friction_outer
def next_due(queue: np.ndarray, n: int, until: float) -> int:
    return _next_due(queue, n, until)


def test_the_next_site_that_is_due_is_found_in_the_tree_of_times() -> None:
    rng, leaves = np.random.default_rng(SEED), 16
    for sites in (0, 1, 2, 7, 16):
        queue = np.full(2 * leaves, np.inf)
        queue[leaves + rng.choice(leaves, sites, replace=False)] = rng.uniform(0.0, 1.0, sites)
        for node in range(leaves - 1, 0, -1):
            queue[node] = min(queue[2 * node], queue[2 * node + 1])
        for until in (0.0, 0.2, 0.6, 1.0, *queue[leaves:]):
            due = np.flatnonzero(queue[leaves:] <= until)
            for n in range(leaves):
                later = due[due >= n]
                expected = later[0] if later.size else -1
                assert next_due(queue, n, until) == expected
