"""Runs of Model II: honest errors, windows, checkpoints, stiff starts, conserved relations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mpmath import mp
from scipy.integrate import quad, simpson, solve_ivp

from tests.test_vdp_steppers import reference
from theory.chains.ends import Ends
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import ParameterError, RunError
from verification.quantities.problems import PROBLEMS, Problem
from verification.references.equations import (
    as_complex,
    as_state,
    averaged_damping,
    damping,
    full_rate,
)
from verification.runs import simulate as simulate_module
from verification.runs.excite import add_noise, as_psi, excite, excite_edge
from verification.runs.simulate import _sample_times, simulate
from verification.runs.smooth_integration import SmoothIntegration
from verification.runs.trajectory import Trajectory
from verification.steppers import stiff_stage
from verification.steppers.stiff_stage import full_jacobian, full_right_side

FRONT = VdpChain(a=4.0, b=0.5, c=0.6, sites=40)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("of", [VdpChain.full, VdpChain.averaged])
def test_the_error_reported_bounds_the_true_error(
    of: Callable[[VdpChain], VanDerPolChain], seed: int
) -> None:
    random = np.random.default_rng(seed)
    a = 10.0 ** random.uniform(0.0, 1.0)
    chain = VdpChain(
        a=a,
        b=a**2 * random.uniform(0.01, 0.12),
        c=10.0 ** random.uniform(-2.0, 1.0),
        eps=10.0 ** random.uniform(-2.5, -0.7),
        sites=int(random.integers(2, 12)),
        ends=Ends.FREE if seed % 2 else Ends.PERIODIC,
    )
    start = add_noise(excite(chain, [1]), 0.3, seed)
    run = simulate(of(chain), start, 60.0, samples=2, tolerance=10.0 ** random.uniform(-10, -5))
    exact = reference(chain, as_psi(start), 60.0, of is VdpChain.full)
    true = float(np.abs(run.psi[-1] - exact).max())
    assert run.error is not None
    # Below 1e-9 the reference is no better than the run.
    assert true <= max(run.error, 1e-9)


@pytest.mark.parametrize("problem", PROBLEMS["chain"], ids=lambda problem: problem.name)
def test_the_error_reported_is_a_few_times_the_true_one(problem: Problem) -> None:
    """It is that of the whole run, at few samples too: where sites relax it has a maximum."""
    chain = problem.vdp_chain(problem.sites)
    start, end = excite(chain, range(1, 4)), 0.25 * problem["t"]
    times = np.linspace(0.0, end, 201)
    exact = solve_ivp(
        full_rate(chain), (0.0, end), as_state(as_psi(start)), "DOP853", times,
        rtol=1e-13, atol=1e-13,
    )  # fmt: skip
    for tolerance in (1e-5, 1e-6, 1e-7):
        run, few = (
            simulate(chain, start, end, samples=count, tolerance=tolerance) for count in (201, 2)
        )
        true = np.abs(run.psi - np.array([as_complex(state) for state in exact.y.T])).max()
        assert few.error is not None
        assert true <= run.error
        # A comparison with larger tolerances would state some hundred times the true error.
        assert max(run.error, few.error) < 20.0 * true


UNSTABLE = VdpChain(a=1.0, b=0.11, c=0.0, sites=2)


def _from_the_unstable_cycle(slow_time: float) -> float:
    """Return |φ| after a slow time from the unstable amplitude as rounded, to 40 digits.

    u = |φ|² obeys u' = -u (1 - au/4 + bu²/8) = -(b/8) ∏ (u - z), so 8/b times the sum over the
    cycles z of ln[(u - z)/(u₀ - z)]/∏ (z - other z) is minus the time, which is bisected.
    """
    with mp.workdps(40):
        a, b = mp.mpf(UNSTABLE.a), mp.mpf(UNSTABLE.b)
        root, start = mp.sqrt(a * a - 8 * b), mp.mpf(UNSTABLE.unstable_amplitude) ** 2
        rest, lower, upper = cycles = (mp.mpf(0), (a - root) / b, (a + root) / b)
        assert all(abs(averaged_damping(mp.sqrt(z), a, b)) < 1e-35 for z in (lower, upper))

        def left(u: mp.mpf) -> mp.mpf:
            weights = (mp.fprod(z - other for other in cycles if other != z) for z in cycles)
            logs = (mp.log((u - z) / (start - z)) for z in cycles)
            return slow_time + 8 / b * mp.fsum(
                each / w for each, w in zip(logs, weights, strict=True)
            )

        near, far = start, upper if start > lower else rest
        for _ in range(140):
            middle = (near + far) / 2
            near, far = (middle, far) if left(middle) > 0 else (near, middle)
        return float(mp.sqrt(near))


@pytest.mark.parametrize("slow_time", [20.0, 40.0, 60.0])
def test_the_error_knows_that_rounding_grows_on_an_unstable_cycle(slow_time: float) -> None:
    """On its unstable cycle a cell of (43) stands still: runs at any tolerance are the same run."""
    start = np.array([UNSTABLE.unstable_amplitude, 0.0], dtype=complex)
    end = slow_time / UNSTABLE.eps
    run = simulate(UNSTABLE.averaged(), start, end, tolerance=1e-12, samples=2)
    exact = _from_the_unstable_cycle(slow_time)
    assert abs(abs(run.psi[-1, 0]) - exact) <= run.error


@pytest.mark.parametrize(
    ("of", "c", "end"),
    [
        (VdpChain.full, 0.6, 900.0),
        (VdpChain.full, 3.0, 300.0),
        (VdpChain.averaged, 0.1, 20000.0),
        (VdpChain.averaged, 0.6, 3000.0),
        (VdpChain.averaged, 3.1, 300.0),
        (VdpChain.averaged, 100.0, 30.0),
    ],
)
def test_sites_left_out_do_not_change_the_run(
    of: Callable[[VdpChain], VanDerPolChain], c: float, end: float
) -> None:
    """At c = 100 fronts are wide, and their first traces run far ahead."""
    tolerance = 1e-8
    chain = VdpChain(a=4.0, b=0.5, c=c, sites=160)
    start = excite_edge(chain, 30)
    kept, whole = (
        simulate(
            of(chain), start, end, samples=10, tolerance=tolerance,
            active_window=window, estimate_error=False,
        )
        for window in (True, False)
    )  # fmt: skip
    assert kept.mean_active < 0.7 * whole.mean_active
    # The bound that the active window states; both runs take the same steps.
    assert np.abs(kept.psi - whole.psi).max() < 0.1 * tolerance * float(np.hypot(*start).max())


def test_the_cost_of_a_front_grows_with_the_length_of_its_path_not_with_its_square() -> None:
    """Steps times sites, a count and not a time, with sites behind the front left out."""
    spent = []
    for sites in (100, 200):
        chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=sites)
        run = simulate(
            chain.averaged(),
            excite_edge(chain, 24),
            sites / 0.72 * 100,
            trailing_sites=24,
            estimate_error=False,
            samples=2,
        )
        spent.append(run.steps * run.mean_active)
    assert spent[1] / spent[0] < 2.2


@pytest.mark.parametrize("of", [VdpChain.full, VdpChain.averaged])
def test_the_motion_depends_on_a_and_b_through_eta_only(
    of: Callable[[VdpChain], VanDerPolChain],
) -> None:
    eta, a = 0.03, 7.0
    one = VdpChain(a=1.0, b=eta, c=0.4, sites=12)
    other = VdpChain(a=a, b=eta * a**2, c=0.4, sites=12)
    first, second = (
        simulate(of(chain), excite(chain, [1, 2]), 800.0, tolerance=1e-11) for chain in (one, other)
    )
    scale = first.amplitude.max()
    assert np.abs(first.psi - math.sqrt(a) * second.psi).max() < 1e-7 * scale


def test_the_energy_lost_is_the_work_of_the_damping() -> None:
    """E(t) - E(0) = -ε∫Σẏ²(1 - ay² + by⁴)dt, by Simpson's rule over dense samples."""
    chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.05, sites=12)
    run = simulate(chain, excite(chain, [1, 2]), 40.0, samples=8001, tolerance=1e-12)
    y, w = run.psi.imag, run.psi.real
    energy = 0.5 * (w**2 + y**2).sum(1) + 0.5 * chain.eps * chain.c * (np.diff(y) ** 2).sum(1)
    power = -chain.eps * (w**2 * damping(y, chain.a, chain.b)).sum(1)
    work = simpson(power, x=run.times)
    assert abs(work) > 0.1
    assert energy[-1] - energy[0] == pytest.approx(work, abs=1e-8)


def test_the_average_is_the_limit_of_small_eps() -> None:
    differences = []
    for eps in (0.02, 0.01, 0.005):
        chain = VdpChain(a=2.5, b=0.5, c=0.3, eps=eps, sites=10)
        start = excite(chain, [1, 2], quarter_turns=[0, -1])
        full, mean = (
            simulate(of(chain), start, 20.0 / eps, samples=2, estimate_error=False)
            for of in (VdpChain.full, VdpChain.averaged)
        )
        differences.append(float(np.abs(full.amplitude[-1] - mean.amplitude[-1]).max()))
    orders = np.log2(np.array(differences[:-1]) / np.array(differences[1:]))
    assert np.all(np.abs(orders - 1.0) < 0.4)


@pytest.mark.parametrize("displacement", [30.0, 300.0])
def test_a_stiff_start_is_passed_rightly(displacement: float) -> None:
    """εby⁴ is from 4e3 to 4e7 at first; scipy's LSODA is the other method."""
    chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.01, sites=5)
    start = excite(chain, [3], displacement)
    run = simulate(chain, start, 12.0, samples=2, tolerance=1e-9)
    state = start.ravel()
    other = solve_ivp(
        full_rate(chain), (0.0, 12.0), state, method="LSODA",
        rtol=1e-10, atol=1e-10,
    )  # fmt: skip
    y, w = np.split(other.y[:, -1], 2)
    assert np.abs(run.psi[-1] - (w + 1j * y)).max() < 1e-5
    assert run.error < 1e-4
    explicit = run.steps - run.counts["stiff_steps"]
    assert (run.method, explicit > 0) == (
        ("DOP853, Radau", True) if displacement < 50.0 else ("Radau", False)
    )
    assert run.counts["stiff_steps"] > 0
    assert run.mean_active == chain.sites


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_jacobian_is_the_derivative_of_the_right_side(ends: Ends) -> None:
    chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.05, sites=4, ends=ends)
    x = np.random.default_rng(1).standard_normal(8)
    columns = [
        (full_right_side(chain, x + step) - full_right_side(chain, x - step)) / 2e-6
        for step in 1e-6 * np.eye(8)
    ]
    assert np.abs(full_jacobian(chain, x) - np.array(columns).T).max() < 1e-8


def test_arrivals_are_the_times_at_which_the_level_is_met() -> None:
    run = simulate(FRONT.averaged(), excite(FRONT, [1]), 1500.0, tolerance=1e-11)
    reached = np.flatnonzero(run.arrivals > 0.0)
    assert reached.size > 3
    for n in reached[:4]:
        upto = simulate(
            FRONT.averaged(), excite(FRONT, [1]), float(run.arrivals[n]), tolerance=1e-11, samples=2
        )
        assert upto.amplitude[-1, n] == pytest.approx(run.level, rel=1e-9)


def _bad(**changes: object) -> Trajectory:
    arguments: dict[str, object] = {"t_end": 10.0} | changes
    return simulate(FRONT, arguments.pop("start", excite(FRONT, [1])), **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"t_end": 0.0}, "end time"),
        ({"t_end": math.nan}, "end time"),
        ({"tolerance": 1e-15}, "tolerance"),
        ({"samples": 1}, "samples"),
        ({"start": np.zeros(3, dtype=complex)}, "start"),
        ({"start": np.full(40, np.nan, dtype=complex)}, "start"),
        ({"start": np.where(np.arange(40) < 1, np.nan, 1j)}, "start"),
        ({"level": 0.0}, "level"),
    ],
)
def test_bad_input_is_named(changes: dict[str, object], named: str) -> None:
    with pytest.raises(ParameterError, match=named):
        _bad(**changes)


@pytest.mark.parametrize("displacement", [1e22, 1e60, 1e300])
def test_a_start_too_far_for_the_implicit_method_is_refused(displacement: float) -> None:
    """scipy's Radau never ends from 1e22, and ends in a raw error from 1e60."""
    start = np.zeros((2, 5))
    start[0, 2] = displacement
    with pytest.raises(RunError, match=r"a displacement of 1e\+\d+ at t = 0 .* a smaller"):
        simulate(VdpChain(a=4, b=0.5, c=0.6, sites=5), start, 3.0)


def test_excited_sites_may_be_whole_numbers_of_any_kind() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=5)
    expected = excite(chain, [2, 4])
    assert np.count_nonzero(expected) == 2
    for sites in ([2.0, 4.0], np.array([2.0, 4.0]), np.array([2, 4]), (2, 4.0)):
        assert np.array_equal(excite(chain, sites), expected)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"samples": 2.5}, "number of samples = 2.5 .* whole"),
        ({"end": 2.0}, "option = end .* beside t_end"),
        ({"trailing_sites": 2.5}, "trailing sites = 2.5 .* whole"),
        ({"step": -0.1}, "step = -0.1 .* positive"),
        ({"longest_step": "1"}, "longest step = '1' .* a number"),
        ({"shortest_step": -1.0}, "shortest step = -1.0 .* from 0"),
        ({"drift": 0.1}, "drift = float .* Mapping"),
        ({"drift": {"d": 0.1}}, "drifting parameter = d .* one of a, b, c, eps;"),
        ({"drift": {"sites": 0.1}}, "drifting parameter = sites .* one of a, b, c, eps;"),
        ({"drift": {"c": "1"}}, "rate of change of c = '1' .* a number .* per unit of t"),
        ({"drifts": {}}, "option = drifts .* drift, .* for the model vdp; leave it out"),
    ],
)
def test_options_of_a_run_are_not_rounded_or_replaced(options: Any, words: str) -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=5)
    with pytest.raises(ParameterError, match=words):
        simulate(chain, np.zeros((2, 5)), 3.0, **options)


@pytest.mark.parametrize("c", [1e-3, 5.0])
def test_a_stiff_start_in_a_long_chain_leaves_out_sites_at_rest(c: float) -> None:
    """The same as with all sites stepped, and the cost does not follow the length."""
    chain = VdpChain(a=4.0, b=0.5, c=c, eps=0.01, sites=100)
    start = excite(chain, [50], 200.0)
    part = simulate(chain, start, 1.0, samples=3, tolerance=1e-9)
    whole = simulate(chain, start, 1.0, samples=3, tolerance=1e-9, active_window=False)
    assert part.counts["stiff_steps"] > 0
    assert part.mean_active < 0.9 * chain.sites
    assert part.error is not None
    assert np.abs(part.psi - whole.psi).max() < 1e-6
    long = replace(chain, sites=10_000)
    far = simulate(long, excite(long, [50], 200.0), 1.0, samples=3, tolerance=1e-9)
    assert far.mean_active < 1.5 * part.mean_active + 60.0
    assert np.abs(far.psi[:, :80] - whole.psi[:, :80]).max() < 1e-6


def test_a_run_by_equal_steps_takes_as_many_as_fit_and_says_their_length() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.6, eps=0.05, sites=4)
    start = excite(chain, [1])
    for steps, end in ((50, 5.0), (100, 5.0), (100, 0.01)):  # none is left to the implicit method
        run = SmoothIntegration(chain, start, [end], step=end / steps)
        while not run.finished:
            run.advance(run.default_budget)
        assert run.counts["steps"] in (steps, steps + 1)  # its last one may be a rounding
        assert run.metadata["step"] == end / steps
    assert SmoothIntegration(chain, start, [5.0]).metadata["step"] is None


def test_steps_of_the_averaged_chain_become_as_short_as_a_large_start_asks() -> None:
    """It has no implicit method; r decays like r' = -b r⁵/16, so that r is (bT/4)^{-1/4} soon."""
    chain = AveragedChain(a=4, b=0.5, c=0.0, eps=0.05, sites=2)
    slow = 1e-9
    run = SmoothIntegration(chain, excite(chain, [1], 900.0), [slow / chain.eps])
    while not run.finished:
        run.advance(run.default_budget)
    expected = (900.0**-4 + 0.25 * chain.b * slow) ** -0.25
    assert run.sampled_amplitude[-1, 0] == pytest.approx(
        expected, rel=1e-3
    )  # 2a/(b r²) of it is left out
    assert run.counts["stiff_steps"] == 0


def test_many_sites_that_arrive_within_a_step_do_so_when_each_alone_would() -> None:
    """Uncoupled sites that grow from beside one another: T = ∫ dr / f(r) up to the level."""
    chain = AveragedChain(a=4, b=0.5, c=0.0, eps=0.05, sites=12)
    starts = 1.5 + 0.002 * np.arange(12.0)
    level = 2.5
    end = 40.0
    run = SmoothIntegration(
        chain, np.array([starts, np.zeros(12)]), [end], tolerance=1e-12, level=level
    )
    while not run.finished:
        run.advance(run.default_budget)

    def slowness(r: float) -> float:
        return -2.0 / (r * (1.0 - chain.a * r**2 / 4.0 + chain.b * r**4 / 8.0))

    expected = [quad(slowness, each, level, epsabs=1e-13)[0] / chain.eps for each in starts]
    assert run.counts["steps"] < 100
    assert np.ptp(expected) < end / run.counts["steps"]  # about a step
    assert run.arrivals == pytest.approx(expected, rel=1e-9)


def test_the_implicit_method_ends_where_damping_is_gentle_or_its_steps_are_spent() -> None:
    """By the damping of the chain that is written anew, at either sign and of any site."""
    chain = VdpChain(a=4, b=0.5, c=0.6, eps=0.05, sites=3)
    for y in ([0.0, 0.5, 0.2], [1.5, 0.0, 0.1], [2.0, 1.9, -2.1], [0.1, 0.0, -40.0]):
        state = np.array([*y, 5.0, 6.0, 7.0])
        rates = chain.eps * np.abs(damping(np.array(y), chain.a, chain.b))
        event = stiff_stage._Gentle(chain, 3)
        found = [event(0.0, state) for _ in range(3)]
        assert found == pytest.approx([rates.max() - stiff_stage.GENTLE] * 3, rel=1e-12)
        largest = max(abs(each) for each in y)
        with pytest.raises(RunError, match=f"y. = {largest:.3g} is .* implicit steps"):
            event(0.0, state)
    state = np.array([[0.0, 0.0, 16.94], [0.0] * 3])
    piece = stiff_stage.solve_stiff_piece(
        chain, state, (0, 3), 0.0, 1.0, 1e-6, -1.0, 2, steps_taken=0
    )
    rates = chain.eps * damping(piece.state(piece.times[-1])[0], chain.a, chain.b)
    assert rates.max() == pytest.approx(stiff_stage.GENTLE, rel=1e-9)


@pytest.mark.parametrize("level", [0.25, 1.3, 2.0, 3.7])
def test_a_site_passes_a_level_between_two_implicit_steps(level: float) -> None:
    """Of two sites whose |Ψ| is t and t/2."""
    piece = stiff_stage.StiffPiece(
        4, 6, np.array([0.0, 1.0, 2.5, 4.0]),
        lambda t: np.array([0.6 * t, 0.5 * t, 0.8 * t, 0.0]),
    )  # fmt: skip
    late = {5: pytest.approx(2.0 * level, rel=1e-12)} if level <= 2.0 else {}
    assert piece.passes(level) == {4: pytest.approx(level, rel=1e-12), **late}
    beyond = replace(piece, times=np.array([8.0, 9.0]))
    assert beyond.passes(level) == {4: 8.0, 5: 8.0}  # from the beginning


@pytest.mark.parametrize(
    ("damping", "displacement", "level", "rests"),
    [
        ("1 - 4*y**2 + 0.5*y**4", 0.1, None, True),
        ("1 - 4*y**2 + 0.5*y**4", 0.1, 0.15, False),  # a neighbour may still pass so low a level
        ("1 - 4*y**2 + 0.5*y**4", 0.7, None, False),
        ("y**2 - 1", 0.1, None, False),  # rest is unstable: every motion grows to the cycle
    ],
)
def test_a_motion_goes_to_rest_below_half_of_what_it_must_pass(
    damping: str, displacement: float, level: float | None, rests: bool
) -> None:
    chain = OscillatorChain(damping=damping, c=0.2, sites=5)
    start = excite(chain, [3], displacement=displacement)
    assert SmoothIntegration(chain, start, [0.0, 1.0], level=level).going_to_rest() is rests


def test_whatever_decides_a_run_is_held_against_a_checkpoint() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.2, sites=81).averaged()
    start = excite(chain, [41])
    options: list[dict[str, Any]] = [
        {}, {"tolerance": 1e-7}, {"level": 0.3}, {"trailing_sites": 3}, {"step": 0.05},
        {"left_boundary_wave": True}, {"drift": {"c": 1e-4}}, {"longest_step": 0.05},
        {"shortest_step": 1e-9}, {"active_window": False},
    ]  # fmt: skip
    found = [SmoothIntegration(chain, start, [0.0, 1.0], **each).metadata for each in options]
    assert all(a != b for n, a in enumerate(found) for b in found[:n])


def test_a_run_goes_on_to_its_end_after_its_last_sample() -> None:
    chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=5)
    run = SmoothIntegration(chain, excite(chain, [1]), [1.0], end=20.0)
    while not run.finished:
        run.advance(50)
    assert run.time == 20.0


def test_left_of_a_run_with_a_wave_there_is_one_a_quarter_turn_ahead() -> None:
    chain = VdpChain(a=4.0, b=0.5, c=1.0, eps=0.3, sites=5)
    start = excite(chain, [1, 2], quarter_turns=[0, -1])
    for wave in (True, False):
        run = simulate(
            chain, start, 6.0, samples=2, estimate_error=False, tolerance=1e-10,
            left_boundary_wave=wave,
        )  # fmt: skip
        ends = [
            solve_ivp(
                full_rate(chain, each), (0.0, 6.0), start.ravel(), "DOP853", rtol=1e-11, atol=1e-12
            ).y[:, -1]
            for each in (wave, not wave)
        ]
        apart = [np.abs(run.states[-1].ravel() - each).max() for each in ends]
        assert apart[0] < 1e-7
        assert apart[1] > 1e-2


def test_a_network_has_no_end_from_which_sites_are_left_behind() -> None:
    chain = OscillatorChain(damping="1", c=0.2, sites=9, coupling="chain:1,0,0.2")
    for option in ({"trailing_sites": 3}, {"left_boundary_wave": True}):
        with pytest.raises(ParameterError, match="left boundary = a wave"):
            SmoothIntegration(chain, np.zeros((2, 9)), [0.0, 1.0], **option)


@pytest.mark.parametrize("steps", [0, 1, 4])
def test_the_mean_number_of_sites_stepped_is_that_of_all_steps(steps: int) -> None:
    run: Any = SimpleNamespace(steps=steps, counts={"site_steps": 7 * steps})
    assert Trajectory.mean_active.fget(run) == (7.0 if steps else 0.0)  # type: ignore[attr-defined]


def test_a_run_without_a_checkpoint_tells_its_progress() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.2, sites=3)
    told: list[float] = []
    begin = perf_counter()
    run = simulate(chain, excite(chain, [2]), 1.0, samples=2, progress=told.append)
    assert told[-1] == 1.0
    assert 0.0 < run.seconds <= perf_counter() - begin


@pytest.mark.parametrize(
    ("option", "said"), [({"progress": 3}, "progress = 3 is"), ({"level": -1.0}, "level = -1.0 is")]
)
def test_options_of_a_run_are_refused_by_their_names(option: dict[str, Any], said: str) -> None:
    chain = VdpChain(a=4, b=0.5, c=0.2, sites=3)
    with pytest.raises(ParameterError, match=f"^{said} not allowed"):
        simulate(chain, excite(chain, [2]), 1.0, **option)


@pytest.mark.parametrize(("compared", "count"), [(True, 200), (False, 2)])
def test_runs_that_are_compared_are_sampled_more_often_and_others_as_asked(
    compared: bool, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(_: object, __: object, times: np.ndarray, **___: Any) -> Any:
        assert times[[0, -1]].tolist() == [0.0, 1.0]
        raise RunError(f"{times.size} samples")

    monkeypatch.setattr(simulate_module, "integration", stop)
    chain = VdpChain(a=4, b=0.5, c=0.2, sites=3)
    with pytest.raises(RunError, match=f"^{count} samples"):
        simulate(chain, excite(chain, [2]), 1.0, samples=2, estimate_error=compared)


@pytest.mark.parametrize(("drive", "least"), [("0.5,1.1@2", 0.5), ((), 0.0)])
def test_errors_of_a_run_are_relative_to_what_forces_displace_or_to_more_than_nothing(
    drive: Any, least: float
) -> None:
    chain = OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.1, sites=3, drive=drive)
    run = SmoothIntegration(chain, np.zeros((2, 3)), [1.0])
    assert least <= run._task.least_size <= least + 1e-280
    assert run._task.least_size > 0.0


def test_a_start_is_perturbed_by_so_many_units_in_the_last_place() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.2, sites=3)
    start = np.array([[1.0, 0.0, -0.5], [0.25, 2.0, -4.0]])
    moved = SmoothIntegration.perturbed(chain, start, 3) - start
    assert moved.tolist() == (3.0 * 2.0**-52 * start).tolist()


def test_samples_are_as_many_as_the_help_says_from_the_start_to_the_end() -> None:
    times = _sample_times(VdpChain(a=4, b=0.5, c=0.2, sites=3), 50.0, None, None)
    assert times.tolist() == pytest.approx([0.25 * n for n in range(201)], abs=1e-13)
