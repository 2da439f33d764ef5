"""Claims about the loss of breathers: continuation, bisection, sweeps, and what noise does."""

from __future__ import annotations

import inspect
import itertools
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from tests.folds import fold_of
from tests.one_step import compiled_condition, steps
from theory.averaged.breather import BreatherStatus
from theory.averaged.envelope import envelope_rate
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place, outward_pattern
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers.breather import breather
from verification.breathers.envelope import RotatingWaves
from verification.breathers.orbits import solve_orbit
from verification.breathers.run import run_breather
from verification.continuation.branch import Crossing, FoldShift
from verification.runs.envelope_run import escape as escape_condition
from verification.runs.envelope_run import run_envelope
from verification.runs.excite import StartPoint
from verification.steppers.smooth import BUDGET, CONDITION, OUTCOME
from verification.thresholds import continuation, escape
from verification.thresholds import threshold as thresholds
from verification.thresholds.continuation import breather_threshold
from verification.thresholds.escape import escape_range, escape_threshold
from verification.thresholds.preparation import NucleusPreparation, hold, phase_steps
from verification.thresholds.result import Mechanism, ThresholdMethod
from verification.thresholds.slow_sweep import START, measure_delay
from verification.thresholds.spreading import Spreading, spreads
from verification.thresholds.threshold import threshold

CHAIN = VdpChain(a=2.5, b=0.5, c=0)
SEED = 20261121
ESCAPE = compiled_condition(escape_condition)


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_a_run_of_the_envelope_is_that_of_scipy(ends: Ends) -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.15, sites=7, ends=ends)
    rng = np.random.default_rng(SEED)
    phi = rng.normal(size=7) + 1j * rng.normal(size=7)
    exact = solve_ivp(
        lambda _, x: envelope_rate(x, chain), (0, 20), phi, "DOP853", rtol=1e-11, atol=1e-12
    ).y[:, -1]
    # Eighth order at steps of a tenth, of rates of order one: what scipy's errors add up to.
    assert np.abs(run_envelope(chain, phi, 20.0).phi - exact).max() < 1e-10


def test_a_run_of_the_envelope_of_a_cell_without_a_cycle_is_that_of_scipy() -> None:
    chain = AveragedChain(a=1.0, b=0.2, c=0.3, sites=3)
    phi = np.array([0.1, 2.0, 0.5j])
    exact = solve_ivp(
        lambda _, x: envelope_rate(x, chain), (0, 5), phi, "DOP853", rtol=1e-11, atol=1e-12
    ).y[:, -1]
    assert np.abs(run_envelope(chain, phi, 5.0).phi - exact).max() < 1e-10


def test_a_run_of_the_envelope_at_small_eta_is_that_of_scipy() -> None:
    """Its stable cycle attracts at a rate of 1/(2η), for which a step of a tenth is unstable."""
    chain = AveragedChain(a=1.0, b=2e-3, c=0.02, sites=3)
    phi = chain.stable_amplitude * np.array([0.1, 0.8, 0.1j])
    exact = solve_ivp(
        lambda _, x: envelope_rate(x, chain), (0, 3), phi, "DOP853", rtol=1e-11, atol=1e-12
    ).y[:, -1]
    assert np.abs(run_envelope(chain, phi, 3.0).phi - exact).max() < 1e-4 * np.abs(exact).max()


def test_a_run_of_the_envelope_where_cells_come_to_rest_is_that_of_scipy() -> None:
    """At η above 1/8 there is no cycle, and no rate at which one attracts."""
    chain = AveragedChain(a=1.0, b=0.3, c=0.1, sites=3)
    phi = np.array([1.0, 0.5j, -0.2])
    exact = solve_ivp(
        lambda _, x: envelope_rate(x, chain), (0, 3), phi, "DOP853", rtol=1e-11, atol=1e-12
    ).y[:, -1]
    assert np.abs(run_envelope(chain, phi, 3.0).phi - exact).max() < 1e-9


def test_a_breather_by_runs_of_the_envelope_at_small_eta_is_that_of_the_equation() -> None:
    """It was said to have escaped, since the run overflowed; far smaller η are refused."""
    chain = AveragedChain(a=1.0, b=1e-4, c=5e-4, sites=9)
    run, solved = (breather(chain, method=each) for each in ("simulation", "envelope"))
    assert np.abs(run.amplitudes - solved.amplitudes).max() <= run.error < 1e-6
    with pytest.raises(ParameterError, match=r"^eta = b/a\^2 = 9e-06 .* at least 1e-05"):
        breather(chain.replace(b=9e-6), method="simulation")


def test_a_coupling_that_grows_is_that_of_its_time() -> None:
    """c = c₀ + rate·T: held within a step, whose middle it is taken at, so of second order."""
    chain, rate = VdpChain(a=2.5, b=0.5, c=0.05, sites=5), 0.01
    rng = np.random.default_rng(SEED)
    phi = 2.0 + rng.normal(size=5) + 1j * rng.normal(size=5)
    exact = solve_ivp(
        lambda t, x: envelope_rate(x, chain.replace(c=0.05 + rate * t)), (0, 10), phi, "DOP853",
        rtol=1e-11, atol=1e-12,
    ).y[:, -1]  # fmt: skip
    run = run_envelope(chain, phi, 10.0, rate=rate)
    assert run.coupling == pytest.approx(0.15, rel=1e-14)
    assert np.abs(run.phi - exact).max() < 1e-4
    assert np.abs(run_envelope(chain, phi, 10.0).phi - exact).max() > 1e-2


def test_a_run_ends_when_a_watched_site_passes_the_limit() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.0, sites=3)
    start = np.array([0.1, 1.5, 2.6], dtype=complex)  # the last two go to the cycle, at 2.83
    assert chain.unstable_amplitude < 1.5
    watched = np.array([True, True, False])
    run = run_envelope(chain, start, 100.0, watched=watched, limit=2.0)
    assert run.escaped
    assert 2.0 < abs(run.phi[1]) < 2.2  # within a step
    # Its rate alone, without coupling, from the start to the limit: dr/g(r).
    r = np.linspace(1.5, 2.0, 20_001)
    middle = 0.5 * (r[1:] + r[:-1])
    needed = np.sum(np.diff(r) / (-0.5 * middle * (1 - 2.5 * middle**2 / 4 + 0.5 * middle**4 / 8)))
    assert 0.0 <= run.time - needed < 0.11
    assert run.coupling == 0.0
    free = run_envelope(chain, start, 100.0, watched=watched, limit=3.0)
    assert (free.escaped, free.time) == (False, 100.0)


@pytest.mark.parametrize(
    ("sites", "escapes"),
    [
        ([(3.0, 4.0), (-4.0, 3.0)], False),  # on the limit
        ([(3.0, 4.01), (0.0, 0.0)], True),
        ([(0.0, 0.0), (-4.01, 3.0)], True),
        ([(0.0, -5.01), (0.0, 0.0)], True),
        ([(3.6, -3.6), (0.0, 0.0)], True),
        ([(0.0, 0.0), (5.01, 0.0)], True),
        ([(3.5, 3.5), (-3.5, 3.5)], False),
    ],
)
def test_a_site_escapes_by_its_amplitude_at_any_phase(
    sites: list[tuple[float, float]], escapes: bool
) -> None:
    """Of two watched sites between two that are not, and after the step."""
    state = np.array([(9.0, 9.0), *sites, (9.0, -9.0)]).T
    memory = [25.0, 0.0, 1.0, 1.0, 0.0]
    for motion in (np.zeros((2, 4)), state):
        found = steps(state - motion, [motion], watch=ESCAPE, memory=memory)
        assert found.counters[OUTCOME] == escapes
        assert found.code == (CONDITION if escapes else BUDGET)


def test_a_nucleus_is_prepared_in_phase_and_without_noise_unless_some_is_asked_for() -> None:
    chain = CHAIN.replace(c=0.1, sites=7)
    cycle = np.where(np.abs(np.arange(7) - 3) <= 1, chain.stable_amplitude, 0.0)
    assert NucleusPreparation(3).start(chain) == pytest.approx(cycle)
    noisy = NucleusPreparation(3, perturbation=0.01).start(chain)
    assert 0.0 < np.abs(noisy - cycle).max() < 0.1


def test_runs_of_a_bisection_are_more_accurate_than_its_bracket_is_narrow() -> None:
    narrow = inspect.signature(threshold).parameters["accuracy"].default
    assert Spreading().tolerance <= 0.1 * narrow


def test_runs_keep_mirror_symmetry_to_the_last_bit() -> None:
    run = hold(CHAIN, NucleusPreparation(5), 0.1, 500.0)
    assert np.array_equal(run.phi, run.phi[::-1])


@pytest.mark.parametrize("size", [1, 3])
def test_bisection_and_sweeps_agree_with_the_fold_within_their_errors(size: int) -> None:
    fold = breather_threshold(
        CHAIN, Nucleus(size, outward_pattern(size)), method=ThresholdMethod.ENVELOPE
    ).c_crit
    runs = escape_threshold(CHAIN, NucleusPreparation(size), tolerance=1e-5)
    assert abs(runs.c_crit - fold) <= runs.error
    delay = measure_delay(CHAIN, NucleusPreparation(size))
    assert abs(delay.c_0 - fold) <= delay.error
    # 2/3 with a correction of order rate^{1/3} = 0.03.
    assert delay.delay_exponent == pytest.approx(2 / 3, abs=0.03)


def test_a_nucleus_that_goes_to_rest_where_its_breather_ends_is_not_refused_for_the_rate() -> None:
    """Near η = 1/8 the cycle holds too weakly to excite a neighbour when the breather ends."""
    chain = AveragedChain(a=1.0, b=0.12, c=0.0)
    with pytest.raises(ParameterError, match="not go to rest; take the method envelope") as said:
        measure_delay(chain, NucleusPreparation(1))
    assert (said.value.quantity, said.value.value) == ("nucleus", 1)
    end = breather_threshold(chain, Nucleus(1), ThresholdMethod.ENVELOPE).c_crit
    run = hold(chain, NucleusPreparation(1), 1.1 * end, 1000.0)
    assert not run.escaped
    assert np.abs(run.phi).max() < 1e-6


@pytest.mark.parametrize("size", [1, 3])
def test_a_sweep_begins_below_the_fold_wherever_that_is(size: int) -> None:
    """At b = 0.2 nothing holds at the coupling at which sweeps usually begin."""
    chain = CHAIN.replace(b=0.2)
    fold = breather_threshold(
        chain, Nucleus(size, outward_pattern(size)), method=ThresholdMethod.ENVELOPE
    ).c_crit
    assert fold < START
    delay = measure_delay(chain, NucleusPreparation(size))
    assert all(fold < slow < fast for fast, slow in itertools.pairwise(delay.escapes))
    assert abs(delay.c_0 - fold) <= delay.error


@pytest.mark.parametrize("method", ["sweep", "hold"])
def test_runs_that_would_take_hours_at_small_eta_are_refused_by_that_name(method: str) -> None:
    with pytest.raises(ParameterError, match=r"^eta = b/a\^2 = 0.0009 .* method envelope"):
        threshold(AveragedChain(a=1.0, b=9e-4, c=0.0), method=method)


@pytest.mark.parametrize(
    ("eta", "place"),
    [
        (0.1004957490665929, "edge"),
        (0.0068, "edge"),
        (0.012165893361963, "bulk"),
        (0.058489375756792, "bulk"),
    ],
)
def test_the_error_of_a_sweep_covers_its_steps_and_its_start(eta: float, place: str) -> None:
    """The two extrapolations agree by chance at the first η; rates are large at the second one.

    At the others a starting coupling lies just above the fold, where the nucleus holds for long, or
    just below it.
    """
    chain, nucleus = AveragedChain(a=1.0, b=eta, c=0.0), Nucleus(1, place=Place(place))
    fold = threshold(chain, nucleus, method=ThresholdMethod.ENVELOPE)
    swept = threshold(chain, nucleus, method=ThresholdMethod.SWEEP)
    assert swept.method is ThresholdMethod.SWEEP
    assert abs(swept.c_crit - fold.c_crit) <= swept.error < 1e-3 * fold.c_crit + 6e-5


def test_a_sweep_of_what_holds_nowhere_is_refused() -> None:
    """Noise on the start above the unstable cycle."""
    with pytest.raises(ParameterError, match=r"holds at some c from 0\.001"):
        measure_delay(CHAIN, NucleusPreparation(1, perturbation=10.0))


def test_the_error_of_a_threshold_bounds_the_effect_of_a_longer_chain() -> None:
    for nucleus in (Nucleus(1), Nucleus(2, "0")):
        short = breather_threshold(CHAIN, nucleus, margin=4, method=ThresholdMethod.ENVELOPE)
        long = breather_threshold(CHAIN, nucleus, margin=11, method=ThresholdMethod.ENVELOPE)
        assert 1e-13 < abs(short.c_crit - long.c_crit) <= short.error
        assert short.error < 2.001 * abs(short.c_crit - long.c_crit)


def test_on_a_ring_a_threshold_errs_by_more_than_its_change_with_a_few_sites() -> None:
    """All sites that are left out have more effect than the first of them."""
    chain = AveragedChain(a=4.0, b=0.5344321, c=0.0, sites=16, ends=Ends.PERIODIC)
    nucleus = Nucleus(3, "--", Place.EDGE)
    found = threshold(chain, nucleus)
    whole = breather_threshold(chain, nucleus, margin=13, method=ThresholdMethod.ENVELOPE)
    assert (found.sites, whole.sites) == (10, 16)
    assert abs(found.c_crit - whole.c_crit) <= found.error + whole.error < 1e-6


def test_the_fold_of_a_nucleus_beside_the_middle_is_the_same_at_every_scale() -> None:
    """Of six sites; a branch that breaks the symmetry of five nearly meets it before the fold."""
    eta = 0.07922767848615941
    one, other = (
        threshold(AveragedChain(a=a, b=eta * a**2, c=0.0, sites=6))
        for a in (4.0, 3.0922169137320945)
    )
    assert abs(one.c_crit - other.c_crit) <= one.error + other.error < 1e-10


def test_size_1_loses_stability_to_an_odd_mode_just_before_its_fold() -> None:
    for method in (ThresholdMethod.ENVELOPE, ThresholdMethod.ORBIT):
        found = breather_threshold(CHAIN, Nucleus(1), method)
        assert found.lost_by is Mechanism.SYMMETRY_BREAKING
        assert 1e-5 < found.c_crit - found.stable_to < 3e-5


def test_an_odd_push_beyond_that_coupling_grows_in_a_run() -> None:
    """Between loss of stability and fold, a run leaves the breather; below, it returns."""
    from verification.breathers.envelope import solve_envelope_breather

    growth = []
    for c in (0.19076, 0.19078):
        chain = replace(CHAIN, c=c, sites=15)
        found = solve_envelope_breather(chain, Nucleus(1))
        push = 1e-8 * (np.arange(15) == 8) - 1e-8 * (np.arange(15) == 6)
        phi, sizes = found.waves * (1 + push), []
        for _ in range(3):
            phi = run_envelope(chain, phi, 200.0).phi
            sizes.append(np.abs(np.abs(phi) - np.abs(phi[::-1])).max())
        growth.append(math.log(sizes[2] / sizes[1]) / 200)
        assert growth[-1] == pytest.approx(found.stability.antisymmetric, abs=2e-5)
    assert growth[0] < 0 < growth[1]


def test_an_edge_nucleus_is_half_of_a_pair_in_phase() -> None:
    edge = breather_threshold(CHAIN, Nucleus(1, "", "edge"), method=ThresholdMethod.ENVELOPE)  # type: ignore[arg-type]
    pair = breather_threshold(CHAIN, Nucleus(2, "0"), method=ThresholdMethod.ENVELOPE)
    assert edge.c_crit == pytest.approx(pair.c_crit, abs=edge.error + pair.error)
    # Its modes are those of the pair that keep the mirror symmetry; the slowest of the pair is
    # another one.
    both = edge.growth_half_way_error + pair.growth_half_way_mirrored_error
    assert abs(edge.growth_half_way - pair.growth_half_way_mirrored) <= both < 1e-6
    assert pair.growth_half_way > 0.1 * edge.growth_half_way


def test_the_growth_half_way_is_that_of_differences_at_half_the_coupling() -> None:
    """The rotating solution of (43) by scipy, and its Jacobian by differences."""
    found = breather_threshold(CHAIN, Nucleus(1), margin=3, method=ThresholdMethod.ENVELOPE)
    c, sites = 0.5 * found.c_crit, found.sites
    assert sites == 7

    def off(u: np.ndarray) -> np.ndarray:
        phi, omega = u[:sites] + 1j * u[sites : 2 * sites], u[-1]
        padded = np.concatenate([phi[:1], phi, phi[-1:]])
        pull = 2.0 * phi - padded[:-2] - padded[2:]
        s = np.abs(phi) ** 2
        loss = 0.5 * phi * (1.0 - 2.5 * s / 4.0 + 0.5 * s**2 / 8.0)
        rate = 0.5j * c * pull - loss - 1j * omega * phi
        return np.concatenate([rate.real, rate.imag, [phi[3].imag]])

    start = np.zeros(2 * sites + 1)
    start[3] = math.sqrt((1.0 + math.sqrt(1.0 - 8.0 * 0.08)) / 0.08 / 2.5)
    u = fsolve(off, start, xtol=1e-14)
    h = 1e-5 * np.eye(2 * sites + 1)
    matrix = np.array([(off(u + each) - off(u - each)) / 2e-5 for each in h]).T[:-1, :-1]
    rates = np.sort(np.linalg.eigvals(matrix).real)
    mirror = np.kron(np.eye(2), np.eye(sites)[::-1])
    even = np.linalg.eigvals(matrix @ (np.eye(2 * sites) + mirror) / 2.0).real
    # The others, which have no mirror symmetry, become zero, as is that of the phase.
    own = max(even[np.abs(even) > 1e-9])
    assert abs(own - found.growth_half_way_mirrored) <= found.growth_half_way_mirrored_error + 1e-8
    assert rates[-1] == pytest.approx(0.0, abs=1e-9)  # the phase
    assert abs(rates[-2] - found.growth_half_way) <= found.growth_half_way_error + 1e-8
    assert found.growth_half_way_error < 1e-7
    half_way = breather(AveragedChain(a=2.5, b=0.5, c=c, sites=sites), method="envelope")
    assert found.growth_half_way_error == pytest.approx(half_way.stability.growth_error, rel=1e-6)


def test_no_pattern_of_three_or_five_is_stable() -> None:
    """Of two that mirror each other one is tried: their steps backwards, with the other sign."""
    for size in (3, 5):
        for pattern in map("".join, itertools.product("-+", repeat=size - 1)):
            if pattern[::-1].translate(str.maketrans("-+", "+-")) < pattern:
                continue
            found = breather_threshold(
                CHAIN, Nucleus(size, pattern), method=ThresholdMethod.ENVELOPE
            )
            assert found.lost_by is Mechanism.NEVER_STABLE
            assert found.growth_half_way > 1e-4


def test_opposed_patterns_grow_at_half_the_coupling_as_it_vanishes() -> None:
    """Phases alone, to leading order: D_1' = (c/2) D_2 and D_2' = (c/2) D_1 for size 3."""
    from verification.breathers.envelope import solve_envelope_breather

    for c in (1e-3, 1e-4):
        chain = replace(CHAIN, c=c, sites=9)
        found = solve_envelope_breather(chain, Nucleus(3, "-+"))
        assert found.growth == pytest.approx(c / 2, rel=2 * c)


def test_a_nucleus_of_three_leaves_its_phase() -> None:
    settled = hold(CHAIN, NucleusPreparation(3), 0.1, 400.0)
    assert np.abs(phase_steps(settled, NucleusPreparation(3))) == pytest.approx(
        [0.5, 0.5], abs=1e-6
    )
    noisy = NucleusPreparation(3, perturbation=1e-6)
    steps = [np.abs(phase_steps(hold(CHAIN, noisy, 0.1, time), noisy)) for time in (320, 330, 340)]
    assert max(np.abs(step - 0.5).max() for step in steps) > 0.1


def test_perturbed_nuclei_of_three_escape_below_the_threshold_of_one() -> None:
    single = breather_threshold(CHAIN, Nucleus(1), method=ThresholdMethod.ENVELOPE).c_crit
    for seed in range(3):
        noisy = NucleusPreparation(3, perturbation=1e-6, seed=seed)
        assert hold(CHAIN, noisy, 0.188, 1500.0).escaped
        assert not hold(CHAIN, noisy, 0.18, 1500.0).escaped
    assert single > 0.19


@pytest.mark.parametrize("size", [3, 5, 9])
def test_sweeps_of_what_leaves_its_breather_are_not_extrapolated(size: int) -> None:
    """A perturbed nucleus escapes away from the fold: its delay has another exponent."""
    delay = measure_delay(CHAIN, NucleusPreparation(size, perturbation=1e-6))
    assert delay.c_0 is None
    assert delay.error is None


@pytest.mark.parametrize(
    ("size", "lowest", "highest"),
    [(3, 0.178, 0.192), (7, 0.182, 0.187)],
)
def test_the_range_of_escape_holds_every_run_that_contradicts_one_threshold(
    size: int, lowest: float, highest: float
) -> None:
    """At couplings far and near; size 7 escapes, holds and escapes again."""
    noisy, duration = NucleusPreparation(size, perturbation=1e-6), 1000.0
    found = escape_range(CHAIN, noisy, duration)
    assert found.low < found.high
    assert found.monotone is (size < 7)
    near = np.linspace(found.low - 3e-4, found.high + 3e-4, 10)
    for seed in range(3):
        for c in (*np.linspace(lowest, highest, 11), *near):
            escaped = hold(CHAIN, replace(noisy, seed=seed), c, duration).escaped
            assert escaped or c <= found.high
            assert not escaped or c >= found.low


def test_a_range_of_escape_needs_a_coupling_at_which_the_nucleus_holds() -> None:
    with pytest.raises(ParameterError, match="holds at some c"):
        escape_range(CHAIN, NucleusPreparation(3, perturbation=1.0), seeds=1)


@pytest.mark.parametrize(
    ("c", "eps", "sites"), [(0.15, 0.05, 7), (0.1, 0.1, 9), (0.1, 0.15, 9), (0.1, 0.2, 9)]
)
def test_a_run_of_the_chain_settles_on_the_orbit(c: float, eps: float, sites: int) -> None:
    """Where damping is strong too: with one step for every ε the drift stays at its truncation."""
    chain = VdpChain(a=2.5, b=0.5, c=c, eps=eps, sites=sites)
    run, orbit = run_breather(chain, Nucleus(1)), solve_orbit(chain, Nucleus(1))
    assert run.status is BreatherStatus.SETTLED
    assert np.abs(run.amplitudes - orbit.amplitudes).max() <= run.error < 1e-5
    assert run.frequency == pytest.approx(orbit.frequency, abs=1e-8)


def test_beyond_the_fold_a_run_of_the_chain_escapes() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.21, eps=0.05, sites=7)
    assert run_breather(chain, Nucleus(1)).status is BreatherStatus.ESCAPED


@pytest.mark.parametrize(("c", "eta"), [(0.3, 0.11), (0.1, 0.124)])
@pytest.mark.parametrize("model", [VdpChain, AveragedChain])
def test_a_run_of_which_only_decaying_noise_is_left_has_found_no_breather(
    model: type[VdpChain | AveragedChain], c: float, eta: float
) -> None:
    found = breather(model(a=1.0, b=eta, c=c, sites=9), method="simulation")
    assert found.status is BreatherStatus.DIED
    assert (found.frequency, found.stable, found.error) == (None, None, None)
    assert not found.amplitudes.size


def test_a_run_that_has_not_settled_has_no_frequency(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("verification.breathers.run.SLOW_TIME", 10.0)
    found = run_breather(VdpChain(a=2.5, b=0.5, c=0.1, sites=7), Nucleus(1))
    assert (found.status, found.frequency) == (BreatherStatus.UNSETTLED, None)
    assert found.amplitudes.max() > 1.0


def test_wrong_nuclei_are_refused() -> None:
    for make in (
        lambda: Nucleus(0),
        lambda: Nucleus(3, "+"),
        lambda: Nucleus(2, "?"),
        lambda: Nucleus(9, "+" * 8).first(5),
        lambda: breather_threshold(CHAIN, Nucleus(4, "000"), method=ThresholdMethod.ENVELOPE),
        lambda: outward_pattern(4),
    ):
        with pytest.raises(ParameterError):
            make()


def test_a_short_chain_is_solved_with_its_own_sites() -> None:
    """In antiphase on a ring of five (34) has two unknowns, |φ| and Ω/c: scipy has the fold."""
    a, b = 4.202370876211798, 2.087241963578165

    def left(u: np.ndarray, c: float) -> np.ndarray:
        r, omega = u
        half = 0.5 * (1.0 - a * r * r / 4.0 + b * r**4 / 8.0)
        beside = r * (3.0 - 2.0 * omega + 2j * half / c)
        s = abs(beside) ** 2
        damped = -0.5 * (1.0 - a * s / 4.0 + b * s * s / 8.0) * beside
        gap = damped + 0.5j * c * (2.0 * beside - r) - 1j * c * omega * beside
        return np.array([gap.real, gap.imag])

    def slope(u: np.ndarray, c: float) -> float:
        steps = 1e-6 * np.eye(2)
        rows = [(left(u + each, c) - left(u - each, c)) / 2e-6 for each in steps]
        return float(np.linalg.det(np.array(rows)))

    u = np.array([math.sqrt((a / b) * (1.0 + math.sqrt(1.0 - 8.0 * b / a**2))), 1.5])
    for c in np.linspace(0.02, 0.23, 43):
        u = fsolve(left, u, args=(c,), xtol=1e-12)
    fold = fsolve(
        lambda z: [*left(z[:2], z[2]), slope(z[:2], z[2])], [*u, 0.231], xtol=1e-12
    )  # fmt: skip
    chain = VdpChain(a=a, b=b, c=0.0, sites=5, ends="periodic")  # type: ignore[arg-type]
    found = breather_threshold(chain, Nucleus(2, "x"), method=ThresholdMethod.ENVELOPE)
    assert found.sites == 5
    assert found.c_crit == pytest.approx(fold[2], abs=1e-7)
    with pytest.raises(ParameterError, match="at most the 5 sites"):
        breather_threshold(chain, Nucleus(7, "000000"), method=ThresholdMethod.ENVELOPE)


def test_without_a_fold_the_fold_is_named_and_not_the_pattern() -> None:
    """At η = 1e-4, ε = 1e-4 the cycle turns too slowly for its neighbours to follow."""
    chain = VdpChain(a=1, b=1e-4, c=0, eps=1e-4, sites=3)
    with pytest.raises(ParameterError, match="fold of the breather = absent up to c = 2"):
        breather_threshold(chain, Nucleus(1), ThresholdMethod.ORBIT)


def test_at_small_eta_breathers_outlive_the_fold_of_the_average_as_runs_do() -> None:
    """Runs of (8) at η = 1e-3, ε = 1e-4, on both sides; the fold of (43) is at 0.0172."""
    chain = VdpChain(a=1, b=1e-3, c=0.03, eps=1e-4, sites=5)
    spreading = Spreading(place=Place.BULK, final_time=10.0)
    assert not spreads(chain, spreading)
    assert spreads(chain.replace(c=0.1), spreading)
    assert breather(chain, method="envelope").status is BreatherStatus.NONE
    found = breather(chain, method="orbit")
    assert (found.status, found.stable) == (BreatherStatus.EXISTS, True)
    assert breather(chain.replace(c=0.1), method="orbit").stable is False


@pytest.mark.parametrize("b", [0.69, 0.7, 0.71])
def test_a_breather_that_is_stable_up_to_its_fold_is_lost_by_the_fold(b: float) -> None:
    """Its growth rate is zero at the fold itself, and was found just above it for two of these."""
    chain = AveragedChain(a=2.5, b=b, c=0)
    found = breather_threshold(chain, Nucleus(1), method=ThresholdMethod.ENVELOPE)
    assert found.lost_by is Mechanism.FOLD
    assert found.stable_to == found.c_crit
    assert found.stable_to_error < 1e-11
    assert breather(replace(chain, c=found.c_crit - 1e-7)).stable


@pytest.mark.parametrize("before", [0.5, 2.0])
def test_a_loss_of_stability_within_the_error_of_the_steps_is_the_fold(before: float) -> None:
    shift, u = 1e-4, np.zeros(1)
    fold = fold_of(0.2, 1e-9, u)
    family: Any = SimpleNamespace(fold_error=lambda given: given.error + shift)
    crossing = Crossing(0.2 - before * shift, 1e-12, u, from_start=False)
    kept = continuation._before(family, fold, crossing)
    assert kept is (crossing if before > 1.0 else None)
    never = replace(crossing, from_start=True)
    assert continuation._before(family, fold, never) is never
    assert continuation._before(family, None, crossing) is crossing
    assert continuation._before(family, fold, None) is None


def test_progress_begins_at_nothing_and_never_reaches_the_end_before_it() -> None:
    seen: list[float] = []
    report = continuation._Report(seen.append)
    for done in (0.5, 0.5, 38.0, 1.0, 10.0):
        report(done)
    assert seen == [0.5 / 40.0, 1.0 / 40.0, 39.0 / 40.0, 40.0 / 41.0, 50.0 / 51.0]


def test_the_error_of_a_fold_contains_those_of_the_steps_and_of_the_sites_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where the breather is stable up to the fold, the sites left out count for either end."""
    chain = AveragedChain(a=2.5, b=0.5, c=0.0, sites=15)
    monkeypatch.setattr(RotatingWaves, "step_error", lambda *_: FoldShift(1e-3, 0.0))
    monkeypatch.setattr(continuation, "first_crossing", lambda *_: None)
    found, longer = (
        breather_threshold(chain, Nucleus(1), ThresholdMethod.ENVELOPE, each) for each in (1, 4)
    )
    apart = abs(found.c_crit - longer.c_crit)
    assert apart > 1e-4
    assert found.error == pytest.approx(1e-3 + 2.0 * apart, rel=1e-6)
    assert found.stable_to == found.c_crit
    assert found.stable_to_error == pytest.approx(1e-3 + 4.0 * apart, rel=1e-6)


def test_the_error_of_a_threshold_of_stability_is_that_of_the_coupling_it_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found: Any = SimpleNamespace(stable_to=0.25, stable_to_error=1e-3, lost_by=Mechanism.FOLD)
    monkeypatch.setattr(thresholds, "replace", lambda _, **changed: SimpleNamespace(**changed))
    stated = thresholds._of_stability(found)
    assert (stated.c_crit, stated.error, stated.mechanism) == (0.25, 1e-3, Mechanism.FOLD)


def test_a_point_of_a_cycle_is_no_start_with_a_displacement_or_of_a_chain_without_a_belt() -> None:
    friction, full = FrictionChain(c=0.0), VdpChain(a=4, b=0.5, c=0)
    assert thresholds._start_point(friction, StartPoint.MAXIMUM, None) is StartPoint.MAXIMUM
    for chain, displacement in ((friction, 0.5), (full, None), (full, 0.5)):
        with pytest.raises(ParameterError, match="absent with a displacement"):
            thresholds._start_point(chain, StartPoint.MAXIMUM, displacement)


@pytest.mark.parametrize(
    ("high", "tolerance", "expected"),
    [(0.2 + 1e-4, 1e-4, [1e-4 * 2.0**n for n in range(5)]), (0.75, 0.05, [0.05, 0.1])],
)
def test_runs_that_show_whether_a_nucleus_escapes_later_take_twice_the_time(
    high: float, tolerance: float, expected: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Below 0.2, in distances that are doubled from the tolerance to a hundredth of it.

    Or, where that is more, to as far as the range is wide, at couplings above zero.
    """
    given: Any = None
    runs = escape._EscapeRuns(given, given, 100.0)
    monkeypatch.setattr(runs, "range", lambda: (0.2, high), raising=False)
    asked: list[tuple[float, float]] = []

    def hold_for(_: object, __: object, c: float, duration: float) -> Any:
        asked.append((0.2 - c, duration))
        return SimpleNamespace(escaped=False)

    monkeypatch.setattr(escape, "hold", hold_for)
    assert runs.end_by_longer_runs(tolerance) == pytest.approx(0.4 - high)
    assert [duration for _, duration in asked] == [200.0] * len(asked)
    assert [distance for distance, _ in asked] == pytest.approx(expected)
