"""Claims about breathers solved exactly: averaged, as periodic orbits, and their stability."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve, root

from fronts.cli import main
from tests.folds import fold_of
from theory.averaged.breather import BreatherStatus, solve_breather
from theory.chains.ends import Ends
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers.breather import breather
from verification.breathers.envelope import (
    RotatingWaves,
    quarter_turn_branch,
    solve_envelope_breather,
)
from verification.breathers.floquet import approximate_multipliers, floquet_multipliers
from verification.breathers.follow import _described, follow
from verification.breathers.orbits import STARTS, Orbits, solve_orbit
from verification.continuation.branch import FoldShift, trace
from verification.continuation.newton import NotConvergedError
from verification.references.equations import (
    averaged_damping,
    damping,
    full_rate,
    pull,
    variational_rate,
)
from verification.references.precise_breather import locked_fold, locked_state
from verification.steppers.variational import (
    integrate_along_sinusoids,
    integrate_chain,
    integrate_variations,
)
from verification.thresholds.threshold import threshold

CHAIN = VdpChain(a=2.5, b=0.5, c=0.15, eps=0.02, sites=7)
SEED = 20261121


def flow(chain: VdpChain, state: np.ndarray, time: float, tolerance: float = 1e-12) -> np.ndarray:
    """Return the state, or several in columns, after a time by scipy's DOP853."""
    rate = full_rate(chain)
    run = solve_ivp(rate, (0, time), state.ravel(), "DOP853", rtol=tolerance, atol=1e-13)
    return run.y[:, -1].reshape(state.shape)


def differences(chain: VdpChain, state: np.ndarray, time: float) -> np.ndarray:
    size, step = len(state), 1e-6
    away = step * np.eye(size)
    ends = flow(chain, np.column_stack([state[:, None] + away, state[:, None] - away]), time)
    return (ends[:, :size] - ends[:, size:]) / (2 * step)


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_taylor_flow_is_that_of_scipy(ends: Ends) -> None:
    chain = replace(CHAIN, ends=ends)
    state = np.random.default_rng(SEED).normal(size=14)
    taken = integrate_variations(chain, state, 6.0, 24)
    # scipy at rtol 1e-12 accumulates a few 1e-12 over six units of time.
    assert np.abs(taken.state - flow(chain, state, 6.0)).max() < 1e-10
    # Differences: step² and round-off/step, both about 1e-9 here.
    assert np.abs(taken.monodromy - differences(chain, state, 6.0)).max() < 1e-8
    up, down = (flow(replace(chain, c=chain.c + s), state, 6.0) for s in (1e-5, -1e-5))
    assert np.abs(taken.by_c - (up - down) / 2e-5).max() < 1e-7


@pytest.mark.parametrize("order", [4, 6])
def test_the_taylor_flow_converges_with_its_order(order: int) -> None:
    state = np.random.default_rng(SEED).normal(size=14)
    alone = integrate_chain(CHAIN, state, 6.0, 400, 20)
    exact = alone.state
    assert alone.monodromy.size == alone.by_c.size == 0
    errors = [
        np.linalg.norm(integrate_chain(CHAIN, state, 6.0, steps, order).state - exact)
        for steps in (96, 192)
    ]
    # Halving a step of order p divides the error by 2^p; 0.3 is the room for the next term.
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_displacement_that_is_too_large_on_either_side_is_refused(side: float) -> None:
    """At the end of the first step; the sites are at rest at its beginning."""
    start = np.zeros(2 * CHAIN.sites)
    start[1] = side * 2e6
    with pytest.raises(ParameterError, match="must be below 1e"):
        integrate_chain(CHAIN, start, 1e-30, 1, order=2)
    start[1] = side * 0.5e6
    assert integrate_chain(CHAIN, start, 1e-30, 1, order=2).state == pytest.approx(start, abs=1e-9)


def test_mirror_symmetry_survives_to_the_last_bit() -> None:
    half = np.random.default_rng(SEED).normal(size=(2, 3))
    state = np.concatenate([np.concatenate([row, [0.7], row[::-1]]) for row in half])
    end = integrate_chain(CHAIN, state, 200.0, 1000).state
    assert np.array_equal(end[:7], end[:7][::-1])
    assert np.array_equal(end[7:], end[7:][::-1])


@pytest.mark.parametrize(
    ("nucleus", "sites"), [(Nucleus(1), 7), (Nucleus(2, "0"), 8), (Nucleus(3, "-+"), 9)]
)
def test_the_orbit_closes_in_scipy(nucleus: Nucleus, sites: int) -> None:
    chain = replace(CHAIN, sites=sites)
    orbit = solve_orbit(chain, nucleus)
    gone = flow(chain, orbit.state, orbit.period) - orbit.state
    assert np.abs(gone).max() < 1e-10
    assert orbit.residual < 1e-10
    assert orbit.trivial < 1e-9


def test_harmonic_balance_finds_the_same_orbit() -> None:
    """Odd harmonics to the 9th of three sites at rest ends, solved by a general root finder."""
    chain = VdpChain(a=2.5, b=0.5, c=0.1, eps=0.1, sites=3)
    orbit = solve_orbit(chain, Nucleus(1))
    odd, angle = np.arange(1, 10, 2), 2 * np.pi * np.arange(64) / 64
    waves = np.exp(1j * np.outer(odd, angle))

    def rest(unknown: np.ndarray) -> np.ndarray:
        omega, parts = unknown[0], unknown[1:].reshape(2, 3, 5)
        h = parts[0] + 1j * parts[1]
        y, v = (h @ waves).imag, (1j * omega * h * odd @ waves).imag
        acceleration = -((omega * odd) ** 2 * h @ waves).imag
        left = acceleration + y + chain.eps * (chain.c * pull(y) + v * damping(y, 2.5, 0.5))
        balance = 2 * (left @ waves.conj().T) / 64
        return np.concatenate([[h[1, 0].imag], balance.real.ravel(), balance.imag.ravel()])

    guess = np.zeros((2, 3, 5))
    guess[0, 1, 0], guess[1, [0, 2], 0] = 2.8, -0.28
    # The balance is singular in the phase of one equation set: least squares solves both.
    found = root(rest, np.concatenate([[1.01], guess.ravel()]), method="lm", tol=1e-14)
    assert np.abs(found.fun).max() < 1e-8
    h = found.x[1:].reshape(2, 3, 5)
    # Harmonics beyond the 9th are below 1e-7 at ε = 0.1.
    assert found.x[0] == pytest.approx(orbit.frequency, abs=1e-7)
    assert np.abs(np.hypot(*h[:, :, 0]) - np.abs(orbit.waves)).max() < 1e-5


def test_multipliers_are_those_of_differences_of_the_flow() -> None:
    for nucleus, sites in ((Nucleus(1), 7), (Nucleus(3, "-+"), 7)):
        chain = replace(CHAIN, sites=sites)
        orbit = solve_orbit(chain, nucleus)
        matrix = differences(chain, orbit.state, orbit.period)
        theirs = np.sort(np.abs(np.linalg.eigvals(matrix)))
        assert orbit.multipliers is not None
        ours = np.sort(np.abs(orbit.multipliers))
        # Nearly equal multipliers at rest split like the root of 1e-9.
        assert np.abs(theirs - ours).max() < 1e-4
        assert np.abs(theirs[-3:] - ours[-3:]).max() < 1e-7


def test_multipliers_multiply_to_the_determinant_that_damping_demands() -> None:
    """Liouville: Π μ = exp(-ε ∮ Σ (1 - a y² + b y⁴) dt), from samples of the orbit."""
    orbit = solve_orbit(CHAIN, Nucleus(1))
    y = integrate_chain(CHAIN, orbit.state, orbit.period, 128).samples
    mean = damping(y, CHAIN.a, CHAIN.b).mean(axis=0).sum()
    assert orbit.multipliers is not None
    product = np.prod(orbit.multipliers)
    assert abs(product - math.exp(-CHAIN.eps * orbit.period * mean)) < 1e-9


def test_energy_is_balanced_over_a_period() -> None:
    orbit = solve_orbit(CHAIN, Nucleus(1))
    y = integrate_chain(CHAIN, orbit.state, orbit.period, 256).samples
    v = np.fft.irfft(
        np.fft.rfft(y, axis=0) * (2j * np.pi / orbit.period * np.arange(129))[:, None], axis=0
    )
    loss = (v**2 * damping(y, CHAIN.a, CHAIN.b)).sum(axis=1).mean()
    # Single sites gain up to 1: the balance is between sites.
    assert abs(loss) < 1e-9


def test_reflection_splits_all_multipliers() -> None:
    for parity in (1, -1):
        rng = np.random.default_rng(SEED)
        m = rng.normal(size=(14, 14))
        flip = np.kron(np.eye(2), np.eye(7)[::-1])
        matrix = m + flip @ m @ flip
        split = floquet_multipliers(matrix, 1.0, 1.0, parity=parity).values
        whole = np.linalg.eigvals(matrix)
        assert np.allclose(np.sort_complex(split), np.sort_complex(whole), atol=1e-9)


def test_a_shifted_nucleus_gives_a_shifted_orbit_on_a_ring() -> None:
    ring = VdpChain(a=2.5, b=0.5, c=0.1, eps=0.05, sites=12, ends=Ends.PERIODIC)
    orbit = solve_orbit(ring, Nucleus(1))
    moved = np.concatenate([np.roll(half, 3) for half in np.split(orbit.state, 2)])
    assert np.abs(flow(ring, moved, orbit.period) - moved).max() < 1e-10


def test_orbits_depend_on_a_and_b_through_eta_only() -> None:
    orbit = solve_orbit(CHAIN, Nucleus(1))
    scaled = solve_orbit(replace(CHAIN, a=1.0, b=CHAIN.eta), Nucleus(1))
    assert scaled.frequency == pytest.approx(orbit.frequency, abs=1e-12)
    assert np.abs(scaled.amplitudes / math.sqrt(CHAIN.a) - orbit.amplitudes).max() < 1e-10


def test_the_mirrored_pattern_has_the_mirrored_breather() -> None:
    chain = replace(CHAIN, sites=17)
    one, other = (solve_envelope_breather(chain, Nucleus(3, p)) for p in ("++", "--"))
    assert np.abs(np.abs(one.waves) - np.abs(other.waves)[::-1]).max() < 1e-9


def test_the_averaged_breather_is_a_root_for_a_general_solver() -> None:
    """The real equations of the neighbours, n >= 0, for nucleus 1."""

    def rest(r: np.ndarray) -> np.ndarray:
        left = np.concatenate([[-r[1]], r[:-1]])
        right = np.append(r[1:], 0.0)
        return 0.075 * (left - right) - 0.5 * r * averaged_damping(r, 2.5, 0.5)

    r = fsolve(rest, 2.8 * 0.15 ** np.arange(9), xtol=1e-14)
    found = solve_envelope_breather(replace(CHAIN, sites=17), Nucleus(1))
    assert found.unknowns[-1] == pytest.approx(CHAIN.c, abs=1e-10)
    assert np.abs(np.abs(found.waves[8:]) - np.abs(r)).max() < 1e-6
    assert np.abs(np.abs(found.waves[8:13]) - np.abs(r)[:5]).max() < 1e-9


def test_the_stated_error_of_an_averaged_breather_bounds_its_error() -> None:
    chain = replace(CHAIN, sites=15)
    found = solve_envelope_breather(chain, Nucleus(1))
    exact = solve_envelope_breather(replace(chain, c=chain.c * (1 + 1e-15)), Nucleus(1))
    assert np.abs(found.waves - exact.waves).max() <= 10 * (found.error + exact.error) + 1e-13


@pytest.mark.parametrize(("size", "pattern"), [(1, ""), (3, "-+"), (3, "++"), (5, "++++")])
def test_two_systems_of_equations_fold_at_the_same_coupling(size: int, pattern: str) -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0, sites=size + 20)
    full = RotatingWaves(chain, Nucleus(size, pattern)).branch().fold
    real = quarter_turn_branch(chain, Nucleus(size, pattern)).fold
    assert full.parameter == pytest.approx(real.parameter, abs=2e-11)


def test_at_the_fold_an_exponent_of_the_breathers_own_parity_vanishes() -> None:
    branch = RotatingWaves(VdpChain(a=2.5, b=0.5, c=0, sites=15), Nucleus(1)).branch()
    assert branch.fold is not None
    from verification.breathers.exponents import exponents, unpack

    chain = VdpChain(a=2.5, b=0.5, c=branch.fold.parameter, sites=15)
    found = exponents(*unpack(branch.fold.u), chain, mirrored=True)
    # The exponent crosses like the root of the distance in c, known to 1e-11.
    assert abs(found.symmetric) < 1e-5
    assert found.antisymmetric > 0.005


def test_orbits_tend_to_the_averaged_breather_at_first_order() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.15, sites=9)
    limit = solve_envelope_breather(chain, Nucleus(1))
    assert limit.growth is not None
    amplitude, detuning, growth = [], [], []
    for eps in (0.02, 0.01, 0.005):
        orbit = solve_orbit(replace(chain, eps=eps), Nucleus(1))
        amplitude.append(np.abs(np.abs(orbit.waves) - np.abs(limit.waves)).max())
        detuning.append(abs((orbit.frequency - 1) / eps - limit.unknowns[-1]))
        growth.append(abs(orbit.growth - limit.growth))
    for errors in (amplitude, detuning, growth):
        # First order; the next term at ε = 0.01 is of relative size 0.05 at most.
        assert math.log2(errors[1] / errors[2]) == pytest.approx(1.0, abs=0.07)


def test_the_orbits_fold_tends_to_the_averaged_fold_at_first_order() -> None:
    limit = RotatingWaves(VdpChain(a=2.5, b=0.5, c=0, sites=13), Nucleus(1)).branch().fold
    assert limit is not None
    gaps = []
    for eps in (0.02, 0.01, 0.005):
        chain = VdpChain(a=2.5, b=0.5, c=0, eps=eps, sites=13)
        fold = Orbits(chain, Nucleus(1)).branch(monitored=False).fold
        gaps.append(fold.parameter - limit.parameter)
    assert [math.log2(gaps[k] / gaps[k + 1]) for k in (0, 1)] == pytest.approx([1, 1], abs=0.05)


@pytest.mark.parametrize(
    ("eta", "sites"),
    [
        (0.03125, 3),
        (0.05, 3),
        (0.00118, 3),
        (0.00209, 9),
        (0.01, 5),
        (0.1, 7),
        (0.1174, 5),
    ],
)
def test_the_errors_of_a_fold_cover_those_from_extended_precision(eta: float, sites: int) -> None:
    """Its coupling is known to the square of what its amplitude is; neither error is far larger.

    At small η the residual of the equations displaces the fold by more than its size.
    """
    chain = AveragedChain(a=1.0, b=eta, c=0.0, sites=sites)
    branch = follow(chain, [0.01], nucleus=Nucleus(1), folds=1)
    fold = branch.folds[0]
    assert (fold.points_before, len(branch.points)) == (1, 2)
    near = solve_envelope_breather(
        AveragedChain(a=1.0, b=eta, c=fold.c * (1.0 - 1e-6), sites=sites), Nucleus(1)
    )
    exact = locked_fold(eta, fold.c, near.waves, float(near.unknowns[-1]))
    assert abs(fold.c - float(exact.value[-1])) <= fold.error < 1e-10
    centre = sites // 2
    true = math.hypot(float(exact.value[centre]), float(exact.value[sites + centre]))
    beyond = solve_envelope_breather(chain.replace(c=1.1 * fold.c), Nucleus(1))
    assert abs(beyond.fold - float(exact.value[-1])) <= beyond.fold_error < 1e-10
    # Differences leave an error of some 1e-10 in the state of the reference.
    assert abs(fold.height - true) <= fold.height_error + 1e-10
    assert fold.height_error < 1e-4


@pytest.mark.parametrize(
    ("eta", "nucleus", "before"),
    [
        (0.1248, Nucleus(1), 1.571e-6),
        (0.0388, Nucleus(2, "+"), 2.27e-6),
        (0.1, Nucleus(1), 1e-10),
        (0.08, Nucleus(3, "-+"), 4e-14),
    ],
)
def test_close_to_its_fold_a_breather_errs_by_no_more_than_it_states(
    eta: float, nucleus: Nucleus, before: float
) -> None:
    chain = AveragedChain(a=1.0, b=eta, c=1e3, sites=nucleus.size + 6)
    fold = solve_envelope_breather(chain, nucleus).fold
    near = chain.replace(c=fold * (1.0 - before))
    found = solve_envelope_breather(near, nucleus)
    exact = locked_state(eta, near.c, found.waves, float(found.unknowns[-1]))
    waves = exact.value[: near.sites] + 1j * exact.value[near.sites : -1]
    assert np.abs(np.abs(waves) - found.amplitudes).max() <= found.error < 1e-3


@pytest.mark.parametrize("eta", [0.12, 0.124, 0.1249])
@pytest.mark.parametrize("size", [3, 5])
def test_beyond_the_fold_of_a_larger_nucleus_there_is_none_where_the_cycles_nearly_meet(
    eta: float, size: int
) -> None:
    """The fold vanishes like 1 - 8 eta, that of one site like its root; neither c nor the pattern
    is to be blamed."""
    nucleus, sites = Nucleus(size).relaxed(9), 9
    chain = AveragedChain(a=1.0, b=eta, c=5.0, sites=sites)
    beyond = solve_envelope_breather(chain, nucleus)
    assert beyond.status is BreatherStatus.NONE
    assert 0.5 * (1.0 - 8.0 * eta) < beyond.fold < 1.0 - 8.0 * eta
    near = solve_envelope_breather(chain.replace(c=beyond.fold * (1.0 - 1e-6)), nucleus)
    exact = locked_fold(eta, beyond.fold, near.waves, float(near.unknowns[-1]))
    assert abs(beyond.fold - float(exact.value[-1])) <= beyond.fold_error < 1e-10
    orbit = breather(VdpChain(a=1.0, b=eta, c=5.0, eps=1e-3, sites=sites), nucleus)
    assert orbit.status is BreatherStatus.NONE
    assert orbit.fold == pytest.approx(beyond.fold, rel=1e-2)


def test_where_the_cycles_nearly_meet_a_fold_errs_by_the_rounding_of_the_damping() -> None:
    a = 1.3629350220887508
    chain = AveragedChain(a=a, b=0.12499423213870642 * a**2, c=1e3, sites=7)
    found = solve_envelope_breather(chain, Nucleus(1))
    near = solve_envelope_breather(chain.replace(c=found.fold * (1.0 - 1e-6)), Nucleus(1))
    eta: Any = np.longdouble(chain.b) / np.longdouble(a) ** 2
    exact = locked_fold(eta, found.fold, math.sqrt(a) * near.waves, float(near.unknowns[-1]))
    assert abs(found.fold - float(exact.value[-1])) <= found.fold_error < 1e-12


@pytest.mark.parametrize(("eta", "folds"), [(0.1, 0), (0.1017, 0), (0.11, 1)])
def test_a_breather_of_three_sites_without_a_fold_becomes_a_mode_of_the_chain(
    eta: float, folds: int
) -> None:
    """At strong coupling a mode A(1, -2, 1) has 6 - 18A²/4 + 66ηA⁴/8 = 0, which needs η ≤ 0.1023.

    Of the weights these are Σw², Σw⁴ and Σw⁶ in the balance of energy.
    """
    chain = AveragedChain(a=1.0, b=eta, c=0.0, sites=3)
    branch = follow(chain, [0.02, 4.0, 8.0], nucleus=Nucleus(1), folds=1)
    assert len(branch.folds) == folds
    room = 4.5**2 - 4.0 * 6.0 * 8.25 * eta
    assert (room < 0.0) is bool(folds)
    if folds:
        return
    mode = math.sqrt((4.5 + math.sqrt(room)) / (2.0 * 8.25 * eta)) * np.array([1.0, 2.0, 1.0])
    near, far = (np.abs(point.amplitudes - mode).max() for point in branch.points[1:])
    # A step changes c by 0.06 at most: this is more than 600 steps away.
    (strong,) = follow(chain, [40.0], nucleus=Nucleus(1), folds=0).points
    assert np.abs(strong.amplitudes - mode).max() < 0.25 * far
    # What is left of the other modes falls at least as 1/c.
    assert far < 0.55 * near < 1e-2


def test_the_errors_of_a_fold_of_orbits_cover_those_of_their_steps() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.0, sites=3)
    found = []
    for steps in (10, 14, 18, 50):
        orbits = Orbits(chain, Nucleus(1), steps=steps)
        branch = trace(orbits.system(), orbits.start(0.2, 0.15), 2.0)
        assert branch.fold is not None
        found.append(_described(orbits, branch.fold, 1))
        assert orbits.unit == 1.0  # displacements as they are
    *rough, fine = found
    for each in rough:
        assert abs(each.c - fine.c) <= each.error + fine.error
        assert abs(each.height - fine.height) <= each.height_error + fine.height_error
    assert abs(rough[0].c - fine.c) > 1e-11


@pytest.mark.parametrize("folds", [1, 2])
def test_within_the_error_of_a_fold_the_two_solutions_that_meet_there_are_not_distinguished(
    folds: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The stated error of the fold is made large: the other sheet may then be the true one."""
    monkeypatch.setattr(RotatingWaves, "step_error", lambda *_: FoldShift(1e-4, 0.0))
    chain = AveragedChain(a=2.5, b=0.5, c=0.0, sites=5)
    end = follow(chain, [0.15], nucleus=Nucleus(1), folds=1).folds[0].c
    near, far = end - 5e-5, end - 2e-4
    found = follow(chain, [far, near], nucleus=Nucleus(1), folds=folds)
    first, second, third, fourth = found.points
    assert [point.chain.c for point in found.points] == [far, near, near, far]
    apart = float(np.abs(second.amplitudes - third.amplitudes).max())
    assert apart > 1e-3
    for point in (second, third):
        assert apart <= point.error < 10.0 * apart
    for point in (first, fourth):
        assert point.error < 1e-10
    assert {point.fold for point in found.points} == {end}
    assert {point.fold_error for point in found.points} == {found.folds[0].error}


def test_a_frequency_is_uncertain_by_what_the_last_step_has_left_of_it() -> None:
    chain = AveragedChain(a=2.5, b=0.5, c=0.1, sites=5)
    waves = RotatingWaves(chain, Nucleus(1))
    point = waves.start(0.1)
    errors = [
        waves.measured(replace(point, correction=left), 0.0).frequency_error for left in (0.0, 1e-3)
    ]
    assert errors[0] < 1e-14
    assert errors[1] >= chain.eps * 1e-3


def test_the_amplitude_of_a_fold_is_off_by_what_both_parts_of_its_state_may_be() -> None:
    """Made up: the state is found along the branch, and is off across it by what is stated."""
    aside, unit = 1e-3, 16.0

    def amplitude(u: np.ndarray) -> float:
        return float(unit * math.hypot(u[0], u[1]))

    family: Any = SimpleNamespace(
        nucleus=Nucleus(1), chain=VdpChain(a=2.5, b=0.5, c=0.1, sites=2), unit=unit,
        amplitudes=lambda u, _: np.full(2, amplitude(u)), step_error=lambda _: shift,
    )  # fmt: skip
    shift = FoldShift(0.0, aside)  # by the steps of the integration, as much again
    fold = fold_of(0.2, 1e-12, np.array([0.5, 0.5]), offset=np.zeros(2), transverse_error=aside)
    found = _described(family, fold, 1)
    assert abs(amplitude(fold.u + 2.0 * aside) - found.height) <= found.height_error < 0.1
    shift = FoldShift(0.0, 0.0)
    found = _described(family, replace(fold, transverse_error=0.0), 1)
    assert np.finfo(float).eps * found.height < found.height_error < 1e-12  # rounding is left
    for along in (-1e-3, 1e-3):  # to the fold, on which the amplitude is smaller or larger
        away = np.array([along, 0.0])
        found = _described(family, replace(fold, transverse_error=0.0, offset=away), 1)
        apart = abs(amplitude(fold.u + away) - found.height)
        assert found.height_error == pytest.approx(apart, rel=1e-9)


@pytest.mark.parametrize("averaged", [False, True])
def test_of_a_fold_the_amplitude_is_computed_and_no_multipliers(
    averaged: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.0, sites=3)
    family = RotatingWaves(chain.averaged(), Nucleus(1)) if averaged else Orbits(chain, Nucleus(1))
    point = family.start(0.2, 0.15)
    whole = family.measured(point, 0.0)
    assert family.amplitudes(point.u, point.parameter).tolist() == whole.amplitudes.tolist()
    fold = trace(family.system(), point, 2.0).fold
    expected = family.measured(replace(point, u=fold.u, parameter=fold.parameter), 0.0)
    monkeypatch.setattr(type(family), "measured", None)
    monkeypatch.setattr(type(family), "stability", None)
    assert _described(family, fold, 1).height == expected.outward[0]


def test_multipliers_do_not_depend_on_the_length_of_the_chain() -> None:
    short, long = (
        solve_orbit(VdpChain(a=2.5, b=0.5, c=0.19, sites=sites), Nucleus(1)).stability
        for sites in (11, 21)
    )
    assert short.leader == pytest.approx(long.leader, abs=1e-8)


def test_multipliers_along_sinusoids_are_those_of_scipy() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.18, eps=0.05, sites=5, ends=Ends.PERIODIC)
    breather = solve_breather(chain)
    ours = approximate_multipliers(chain, breather)
    away = np.abs(np.arange(5) - 2)
    size = breather.amplitudes(5)[away]

    def sinusoids(t: float) -> tuple[np.ndarray, np.ndarray]:
        angle = breather.frequency * t - 0.5 * np.pi * away
        return size * np.sin(angle), breather.frequency * size * np.cos(angle)

    beside, period = variational_rate(chain), 2 * np.pi / breather.frequency

    def rate(t: float, flat: np.ndarray) -> np.ndarray:
        both = np.column_stack([np.concatenate(sinusoids(t)), flat.reshape(10, 10)])
        return beside(t, both.ravel()).reshape(10, 11)[:, 1:].ravel()

    run = solve_ivp(rate, (0, period), np.eye(10).ravel(), "DOP853", rtol=1e-12, atol=1e-13)
    theirs = np.linalg.eigvals(run.y[:, -1].reshape(10, 10))
    assert np.abs(np.sort(np.abs(ours.values)) - np.sort(np.abs(theirs))).max() < 1e-9


def test_beyond_the_fold_there_is_no_orbit_and_the_fold_is_named() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.1912, sites=11)
    orbit = solve_orbit(chain, Nucleus(1))
    assert orbit.status is BreatherStatus.NONE
    assert 0.1911 < orbit.fold < 0.1912
    assert solve_orbit(replace(chain, c=0.1911), Nucleus(1)).status is BreatherStatus.EXISTS


def test_amplitudes_are_where_the_velocities_vanish() -> None:
    chain = replace(CHAIN, c=0.1, eps=0.1)
    orbit = solve_orbit(chain, Nucleus(3, "+-"))
    n, rate = chain.sites, full_rate(chain)
    turns = [lambda _, x, site=site: x[n + site] for site in range(n)]
    run = solve_ivp(
        rate, (0, orbit.period), orbit.state, "DOP853", events=turns, rtol=1e-13, atol=1e-15
    )
    largest = [np.abs(states[:, site]).max() for site, states in enumerate(run.y_events)]
    assert np.abs(orbit.amplitudes - largest).max() < 1e-11


def test_a_branch_that_cannot_be_followed_is_no_defect_but_one_sentence(capsys) -> None:
    """Next to eta = 1/8 both cycles of a cell are one."""
    line = "breather --a 1 --b 0.12499999999333289 --c 7.601881158205481e-06 --eps 2.4e-06"
    code = main([*line.split(), "--method", "orbit", "--n", "3"])
    said = capsys.readouterr().err
    assert code == 2
    assert "could not be followed past c = 2.58" in said
    assert "eta farther from 1/8." in said


def _ring_of_four(eta: float, far: Any) -> tuple[list[Any], Any]:
    """Return the amplitudes of (43), a = 1, on a ring of four, and c, from the far amplitude.

    With phase steps of -π/2, Ω = c and the damping f: c r_1 = r_2 f(r_2) = -r_0 f(r_0), and
    c (r_0 - r_2)/2 = r_1 f(r_1).
    """
    b = mp.mpf(eta)

    def f(r: Any) -> Any:
        return (1 - r**2 / 4 + b * r**4 / 8) / 2

    pull = far * f(far)
    centre = mp.findroot(lambda r: r * f(r) + pull, mp.sqrt((1 + mp.sqrt(1 - 8 * b)) / b))
    half = pull * (centre - far) / 2
    beside = mp.findroot(lambda r: r**2 * f(r) - half, (0, mp.sqrt(2)), solver="anderson")
    return [centre, beside, far], pull / beside


@pytest.mark.parametrize(
    ("eta", "furthest"), [(0.08, "2.5"), (5e-3, "1.35"), (2e-4, "1.35"), (1e-6, "1.35")]
)
def test_the_fold_of_a_ring_of_four_is_where_its_coupling_is_largest_at_every_eta(
    eta: float, furthest: str
) -> None:
    """It goes to zero like √η: at small η branches begin below it."""
    chain = AveragedChain(a=1.0, b=eta, c=0.0, sites=4, ends=Ends.PERIODIC)
    found = threshold(chain, method="envelope")
    with mp.workdps(40):
        root_eta = mp.sqrt(eta)

        def coupling(far: Any) -> Any:
            return _ring_of_four(eta, far * root_eta)[1]

        low, high = mp.mpf(1), mp.mpf(furthest)
        for _ in range(120):
            third = (high - low) / 3
            if coupling(low + third) < coupling(high - third):
                low += third
            else:
                high -= third
        assert 1.01 < low < mp.mpf(furthest) - 0.01
        assert abs(found.c_crit - coupling(low)) <= found.error < 1e-7 * found.c_crit


def test_an_averaged_breather_of_an_eta_that_rounding_hides_is_refused() -> None:
    with pytest.raises(ParameterError, match="eta"):
        breather(AveragedChain(a=1.0, b=0.999e-6, c=1e-4, sites=5), method="envelope")


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e8])
@pytest.mark.parametrize("eta", [0.08, 1e-4, 1e-6])
def test_a_breather_is_found_at_every_scale_of_the_damping(eta: float, scale: float) -> None:
    """a → a s, b → b s² divides amplitudes by √s; the error of the frequency has no such scale."""
    with mp.workdps(40):
        exact, c = _ring_of_four(eta, mp.mpf("0.3") * mp.sqrt(eta))
        chain = AveragedChain(a=scale, b=eta * scale**2, c=float(c), sites=4, ends=Ends.PERIODIC)
        found = breather(chain, method="envelope")
        assert found.error is not None
        assert found.frequency_error is not None
        for ours, true in zip(found.outward, exact, strict=True):
            assert abs(ours - true / mp.sqrt(scale)) <= found.error
        assert found.error < 1e-9 * found.outward[0]
        assert abs(found.frequency - (1 + mp.mpf(chain.eps) * c)) <= found.frequency_error < 1e-11


@pytest.mark.parametrize(
    ("failing", "quantity", "count"), [((), "pattern", 1), ((1,), "small parameter", len(STARTS))]
)
def test_where_an_orbit_starts_its_refusal_is_passed_on_and_later_ones_are_not(
    failing: tuple[int, ...], quantity: str, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A later start may be beyond the fold of the averaged breather, which nobody gave."""
    tried: list[float] = []

    def refused(self: Orbits) -> Any:
        tried.append(self.chain.c)
        if len(tried) in failing:
            raise NotConvergedError("no orbit")
        raise ParameterError("pattern", "0", "another", "name another")

    monkeypatch.setattr(Orbits, "_from_small_eps", refused)
    with pytest.raises(ParameterError, match=f"^{quantity}"):
        Orbits(VdpChain(a=2.5, b=0.5, c=0.1, sites=5), Nucleus(1))._first(2.0)
    assert len(tried) == count


@pytest.mark.parametrize("misprinted", [False, True])
def test_variations_along_a_sinusoid_are_those_of_42_as_printed_or_corrected(
    misprinted: bool,
) -> None:
    """Of two uncoupled sites, by scipy; what is printed has a one too many in its derivative."""
    cell, size, omega = VdpChain(a=2.5, b=0.5, c=0.0, eps=0.3, sites=2), 1.4, 0.9
    period = 2.0 * np.pi / omega

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        y, w = size * np.sin(omega * t), size * omega * np.cos(omega * t)
        slope = misprinted - 2.0 * cell.a * y + 4.0 * cell.b * y**3
        damping = 1.0 - cell.a * y**2 + cell.b * y**4
        u, v = x.reshape(2, 2)
        return np.concatenate([v, -u - cell.eps * (damping * v + slope * w * u)])

    true = solve_ivp(rate, (0.0, period), np.eye(2).ravel(), rtol=1e-11, atol=1e-12).y[:, -1]
    found = integrate_along_sinusoids(
        cell, np.full(2, size), np.zeros(2), omega, misprinted=misprinted, steps=200
    )
    assert np.abs(found.monodromy - np.kron(true.reshape(2, 2), np.eye(2))).max() < 1e-8


@pytest.mark.parametrize(("c", "eps"), [(0.005, 7.3e-4), (0.005, 5e-4), (0.012, 7.3e-4)])
def test_the_error_of_growth_covers_the_error_of_the_orbit(c: float, eps: float) -> None:
    """At small ε an orbit is determined by the rounding of a period divided by ε.

    Its multipliers change as it does, much more than by their own rounding.
    """
    chain = VdpChain(a=1.0, b=0.1249, c=c, eps=eps, sites=5)
    found = solve_orbit(chain, Nucleus(1))
    assert found.error is not None
    assert found.growth_error is not None
    assert found.growth is not None
    moved = np.random.default_rng(1).choice([-1.0, 1.0], size=found.state.size)
    flow = integrate_variations(chain, found.state + found.error * moved, found.period, 100)
    multipliers = np.linalg.eigvals(flow.monodromy)
    nontrivial = np.delete(multipliers, np.abs(multipliers - 1.0).argmin())
    growth = math.log(np.abs(nontrivial).max()) / (chain.eps * found.period)
    assert abs(growth - found.growth) <= found.growth_error < 1e-6
