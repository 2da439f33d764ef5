"""``breather`` and ``cell``: one answer for every method and model, with errors that bound."""

from __future__ import annotations

import dataclasses
import json
import math
import pickle
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from theory.averaged.breather import BreatherStatus
from theory.cells.friction import FrictionCell
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.chains.oscillator import OscillatorChain
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers import breather as breathers
from verification.breathers.breather import breather
from verification.breathers.envelope import solve_envelope_breather
from verification.breathers.exponents import exponents
from verification.breathers.floquet import floquet_multipliers
from verification.breathers.orbits import solve_orbit
from verification.breathers.result import Breather
from verification.cells.cell import cell
from verification.cells.result import BeltCell, CellStatus
from verification.references.equations import full_rate
from verification.thresholds.threshold import threshold

A, B, EPS, SITES = 2.5, 0.5, 0.01, 11
CHAIN = VdpChain(a=A, b=B, c=0.1, eps=EPS, sites=SITES)
BEYOND = 0.21
"""Coupling above the fold at 0.1908."""


def numbers(value: object) -> list[float]:
    """Every float in a nested object."""
    if isinstance(value, float):
        return [value]
    if isinstance(value, dict):
        return [each for part in value.values() for each in numbers(part)]
    if isinstance(value, (list, tuple)):
        return [each for part in value for each in numbers(part)]
    return []


def settled_by_scipy(c: float) -> np.ndarray:
    """Largest |y_n| of (8) over a late period, from one excited site, by scipy."""
    rate = full_rate(VdpChain(a=A, b=B, c=c, eps=EPS, sites=SITES))
    start = np.zeros(2 * SITES)
    start[SITES // 2] = math.sqrt(A / B * (1 + math.sqrt(1 - 8 * B / A**2)))
    late = np.linspace(2000.0, 2000.0 + 2 * math.pi, 400)
    run = solve_ivp(rate, (0, late[-1]), start, "DOP853", late, rtol=1e-7, atol=1e-9)
    return np.abs(run.y[:SITES]).max(axis=1)


def test_the_error_of_every_method_bounds_its_distance_from_a_run_of_scipy() -> None:
    true = settled_by_scipy(0.1)
    found = breather(CHAIN, method="all")
    assert list(found.methods) == ["closed-form", "envelope", "orbit", "simulation"]
    for name, each in found.methods.items():
        assert each.error is not None, name
        # scipy's samples miss the largest by 3e-5 of it, and its tolerance adds 4e-6
        assert np.abs(each.amplitudes - true).max() <= each.error + 1e-4, name
        assert each.stable is (None if name == "simulation" else True)
    errors = [found[name].error for name in ("closed-form", "envelope", "orbit")]
    assert errors == sorted(errors, key=lambda error: -float(error or 0.0))
    assert float(errors[0] or 0.0) < 2e-3
    columns = found.columns()
    assert columns["method"].tolist() == list(found.methods)
    assert columns["centre"] == pytest.approx(true[SITES // 2], abs=1e-3)


def orbit_by_scipy(chain: VdpChain, found: Breather) -> tuple[np.ndarray, np.ndarray]:
    """The orbit (X, period) by a step of Newton's method with scipy, and ∂(X(period) - X)/∂u."""
    rate, sites = full_rate(chain), chain.sites

    def gap(u: np.ndarray) -> np.ndarray:
        run = solve_ivp(rate, (0.0, u[-1]), u[:-1], "DOP853", rtol=1e-12, atol=1e-14)
        return np.append(run.y[:, -1] - u[:-1], u[sites // 2])

    u = found.unknowns
    slope = np.array([(gap(u + 1e-4 * e) - gap(u - 1e-4 * e)) / 2e-4 for e in np.eye(u.size)]).T
    u = u - np.linalg.solve(slope, gap(u))
    assert np.abs(gap(u)).max() < 1e-10
    return u, slope


def phases_by_scipy(chain: VdpChain, u: np.ndarray) -> np.ndarray:
    """Phases against the centre, in units of π, of an orbit."""
    times = u[-1] * np.arange(64) / 64
    run = solve_ivp(full_rate(chain), (0.0, u[-1]), u[:-1], "DOP853", times, rtol=1e-12, atol=1e-14)
    waves = np.fft.rfft(run.y[: chain.sites], axis=1)[:, 1]
    return np.asarray(np.angle(waves / waves[chain.sites // 2]) / np.pi)


def test_errors_of_phases_frequency_and_growth_bound_the_distance_from_those_of_scipy() -> None:
    """Also of an orbit by far too few steps, whose error is far above that of scipy."""
    chain = VdpChain(a=A, b=B, c=0.1, eps=0.03, sites=3)
    exact = solve_orbit(chain, Nucleus(1))
    orbit, slope = orbit_by_scipy(chain, exact)
    true = phases_by_scipy(chain, orbit)
    multipliers = np.sort(np.abs(np.linalg.eigvals(slope[:-1, :-1] + np.eye(6))))
    growth = math.log(multipliers[-2]) / (chain.eps * orbit[-1])
    rough = {steps: solve_orbit(chain, Nucleus(1), steps=steps) for steps in (10, 14)}
    others = {name: breather(chain, method=name) for name in ("closed-form", "envelope")}
    for name, each in {
        "orbit": exact,
        **rough,
        **others,
        "run": breather(chain, method="simulation"),
    }.items():
        gap = np.abs((each.phases - true + 1.0) % 2.0 - 1.0)
        assert each.phases_error.shape == (3,), name
        assert (gap <= each.phases_error + 1e-10).all(), name
        step = math.pi * (true[2] - true[1])
        assert abs(each.phase_step - step) <= each.phase_step_error + 1e-10, name
        off = abs(each.frequency - 2.0 * math.pi / orbit[-1])
        assert off <= each.frequency_error + 1e-11, name
        if each.growth is None:
            assert name == "run"
            continue
        assert abs(each.growth - growth) <= each.growth_error + 1e-6, name  # differences by 1e-4
    assert exact.growth_error < 1e-9
    assert (exact.phases_error < 1e-9).all()
    assert exact.phases_error[1] == 0.0  # the centre, against which phases are measured
    assert rough[10].phases_error.max() > 1e-5
    assert others["envelope"].phases_error[2] < 0.1
    assert exact.to_dict()["phases_error"] == exact.phases_error.tolist()


def test_the_error_of_amplitudes_counts_the_sites_on_both_sides_of_the_centre() -> None:
    """With an even number of sites those on the shorter side differ, here by more."""
    chain = VdpChain(a=2.255944, b=0.5329118, c=0.1934357, eps=0.0468046, sites=6)
    found = breather(chain, method="envelope")
    u = solve_orbit(chain, Nucleus(1)).unknowns
    times = np.linspace(0.0, u[-1], 10_001)
    run = solve_ivp(full_rate(chain), (0.0, u[-1]), u[:-1], "DOP853", times, rtol=1e-11, atol=1e-13)
    assert np.abs(run.y[:, -1] - u[:-1]).max() < 1e-9
    gaps = np.abs(np.abs(run.y[: chain.sites]).max(axis=1) - found.amplitudes)
    assert gaps[:2].max() > gaps[2:].max() + 1e-5
    assert gaps.max() <= found.error + 1e-7  # of samples of a period


def test_the_amplitudes_of_a_run_are_those_of_scipy_where_damping_is_strong() -> None:
    """The wave of a site has corners, of which 64 samples of a period are too few."""
    chain = VdpChain(a=3.532285, b=0.26376950, c=0.04885822, eps=0.061854, sites=7)
    found = breather(chain, method="simulation")
    u = solve_orbit(chain, Nucleus(1)).unknowns
    turns = lambda t, x: x[7 + 3]  # noqa: E731  (the velocity of the centre)
    run = solve_ivp(
        full_rate(chain), (0.0, u[-1]), u[:-1], "DOP853", events=turns, rtol=1e-12, atol=1e-13,
        max_step=0.02,
    )  # fmt: skip
    assert np.abs(run.y[:, -1] - u[:-1]).max() < 1e-9
    highest = max(abs(state[3]) for state in run.y_events[0])
    assert abs(found.amplitudes[3] - highest) <= found.error < 1e-7


def test_a_run_that_settles_does_not_decide_stability() -> None:
    """Beside an orbit that loses stability by 0.005 per unit of slow time."""
    chain = VdpChain(a=3.395, b=0.63436, c=0.0570487, eps=0.0159208, sites=3, ends="periodic")
    found = breather(chain, Nucleus(2), method="simulation")
    assert found.status is BreatherStatus.SETTLED
    orbit = solve_orbit(chain, Nucleus(2))
    assert np.abs(found.amplitudes - orbit.amplitudes).max() < 1e-6
    assert (orbit.stable, found.stable) == (False, None)


def test_stability_is_not_decided_where_the_error_of_the_growth_spans_zero() -> None:
    """The averaged breather is stable by little; the orbit near it, at this eps, is not."""
    chain = VdpChain(a=2.7996171, b=0.36238435, c=0.063000117, eps=0.0250224785, sites=8)
    found = breather(chain, Nucleus(2), method="envelope")
    assert found.stability.stable is True
    assert breather(chain, Nucleus(2), method="orbit").stable is False
    assert found.stable is None
    unknown = dataclasses.replace(found, error=None, growth_error=None)
    assert unknown.stable is None


def test_the_error_of_growth_covers_that_of_an_orbit_by_too_few_steps() -> None:
    """Scipy's multipliers, by differences, do not show so small an error; the same orbit does."""
    chain = VdpChain(a=A, b=B, c=0.1, eps=0.03, sites=3)
    exact = solve_orbit(chain, Nucleus(1))
    assert exact.growth is not None
    assert exact.growth_error is not None
    for steps in (8, 10, 14):
        rough = solve_orbit(chain, Nucleus(1), steps=steps)
        assert 1e-10 < abs(rough.growth - exact.growth) <= rough.growth_error + exact.growth_error


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_error_of_growth_covers_what_an_error_of_the_matrix_or_the_state_changes(
    sign: float,
) -> None:
    """Every entry is off by as much as it may be, in the direction of the multiplier."""
    eps, period, off = 0.1, 2.0, 1e-4
    vector = np.ones((4, 1)) / 2.0
    exact = 0.25 * np.eye(4) + 0.375 * vector @ vector.T  # a quarter three times, and 0.625
    there = floquet_multipliers(exact, period, eps, parity=0)
    found = floquet_multipliers(exact + sign * off, period, eps, error=off, parity=0)
    # The one next to 1 is the trivial one; here it is that of the vector, and moves by 4 off.
    moved = abs(found.trivial - there.trivial)
    assert moved == pytest.approx(4.0 * off, rel=1e-9)
    assert moved <= found.error
    leader = np.diag([1.0, 0.5])
    shifted = floquet_multipliers(
        leader + sign * np.diag([0.0, off]), period, eps, error=off, parity=0
    )
    true = abs(shifted.growth - floquet_multipliers(leader, period, eps, parity=0).growth)
    assert true == pytest.approx(off / 0.5 / (eps * period), rel=1e-3)
    assert true <= shifted.growth_error

    chain = AveragedChain(a=A, b=B, c=0.1, sites=3)
    state = solve_envelope_breather(chain, Nucleus(1))
    omega, size = float(state.unknowns[-1]), float(np.abs(state.waves).max())
    own, other = (
        exponents(waves, omega, chain, mirrored=True, error=error)
        for waves, error in ((state.waves, 0.0), (state.waves * (1.0 + sign * off / size), off))
    )
    assert 1e-6 < abs(own.growth - other.growth) <= other.growth_error


def test_phases_of_which_nothing_is_known_say_so() -> None:
    far = breather(VdpChain(a=A, b=B, c=0.1, sites=31), method="envelope")
    assert far.phases_error[0] == pytest.approx(1.0)
    stiff = breather(dataclasses.replace(CHAIN, eps=1.0), method="envelope")
    assert stiff.error_unknown
    assert stiff.phases.size == SITES
    assert stiff.phases_error.size == 0
    assert stiff.phase_step_error is None


def test_a_method_that_refuses_the_chain_is_left_out_with_its_reason() -> None:
    found = breather(dataclasses.replace(CHAIN, eps=1.0), method="all")
    assert list(found.methods) == ["closed-form", "envelope"]
    assert list(found.refusals) == ["orbit", "simulation"]
    assert "for a true orbit" in found.refusals["orbit"]
    rows = found.to_dict()["refusals"]
    assert [row["method"] for row in rows] == list(found.refusals)
    assert [row["reason"] for row in rows] == list(found.refusals.values())


def test_a_chain_that_every_method_refuses_is_refused() -> None:
    with pytest.raises(ParameterError, match="at most the 5 sites"):
        breather(dataclasses.replace(CHAIN, sites=5), nucleus=Nucleus(9), method="all")


@pytest.mark.parametrize("method", ["closed-form", "all"])
@pytest.mark.parametrize("ends", ["free", "periodic"])
def test_two_sites_have_no_closed_form(ends: str, method: Any) -> None:
    """The centre of (9) has two neighbours."""
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=2, ends=ends)  # type: ignore[arg-type]
    if method == "all":
        assert "closed-form" not in breather(chain, method="all").methods
    else:
        with pytest.raises(ParameterError, match=r"number of sites n = 2 .* at least 3"):
            breather(chain, method=method)
        with pytest.raises(ParameterError, match=r"number of sites n = 2 .* at least 3"):
            threshold(chain, Nucleus(1), method=method)


def test_two_sites_each_coupled_twice_to_the_other_have_no_breather_at_this_coupling() -> None:
    """By scipy: the second site is excited too."""
    start = np.array([VdpChain(a=2.5, b=0.5, c=0.1).stable_amplitude, 0.0, 0.0, 0.0])

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        y, v = state[:2], state[2:]
        pull = 2.0 * 0.1 * (y[::-1] - y)
        return np.concatenate([v, -y + 0.01 * (pull - v * (1 - 2.5 * y**2 + 0.5 * y**4))])

    run = solve_ivp(rate, (0.0, 2400.0), start, "DOP853", rtol=1e-6, atol=1e-8)
    assert abs(run.y[1, run.t > 2300.0]).max() > 2.0


def test_a_breather_says_from_which_pattern_it_has_relaxed() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=9)
    for asked, was in ((Nucleus(3), "00"), (Nucleus(3, "00"), "00"), (Nucleus(3, "-+"), "")):
        found = breather(chain, nucleus=asked, method="envelope").to_dict()
        assert found["pattern"] == "-+"
        assert found["nucleus"].get("relaxed_from", "") == was


def test_a_run_that_settles_on_another_nucleus_has_the_name_of_that_one() -> None:
    """Both sites start a quarter turn apart and end in phase; its errors are those in phase."""
    chain = AveragedChain(a=1.0, b=0.09229, c=0.19292, sites=4)
    found = breather(chain, Nucleus(2, "-"), method="simulation")
    assert isinstance(found, Breather)
    assert found.status is BreatherStatus.SETTLED
    assert abs(np.angle(found.waves[2] / found.waves[1])) < 1e-3
    assert (found.nucleus, found.nucleus.relaxed_from) == (Nucleus(2, "0"), "-")
    exact = breather(chain, Nucleus(2, "0"), method="envelope")
    assert isinstance(exact, Breather)
    assert abs(found.frequency - exact.frequency) <= found.frequency_error < 1e-8


def test_a_run_that_settles_on_sites_beside_the_middle_says_on_which() -> None:
    chain = AveragedChain(a=1.0, b=0.10856, c=0.14099, sites=11)
    found = breather(chain, Nucleus(3, "++"), method="simulation")
    assert isinstance(found, Breather)
    assert found.status is BreatherStatus.SETTLED
    (above,) = np.nonzero(found.amplitudes > chain.unstable_amplitude)
    assert above.tolist() == [4]
    assert "another nucleus than the given one, of the sites 5" in found.error_unknown
    assert found.frequency_error is None


def test_an_orbit_of_a_chain_of_ones_own_has_the_pattern_on_which_its_nucleus_settled() -> None:
    damping = "1 - y^2 + 0.08117*y^4"
    chain = OscillatorChain(damping=damping, c=0.12464, eps=0.05, sites=7)
    found = breather(chain, Nucleus(3, "xx"))
    assert isinstance(found, Breather)
    steps = np.angle(found.waves[3:5] / found.waves[2:4]) / np.pi
    assert steps == pytest.approx([-0.5, 0.5], abs=0.1)
    assert (found.nucleus.pattern, found.nucleus.relaxed_from) == ("-+", "xx")


@cache
def cycle_by_scipy() -> float:
    """Largest y of the cell of (8) on its cycle."""

    def rate(_: float, state: np.ndarray) -> list[float]:
        y, v = state
        return [v, -y - 0.01 * v * (1 - 2.5 * y**2 + 0.5 * y**4)]

    run = solve_ivp(rate, (0.0, 1500.0), [3.0, 0.0], "DOP853", rtol=1e-10, dense_output=True)
    return float(run.sol(np.linspace(1490.0, 1500.0, 20001))[0].max())


@pytest.mark.parametrize("method", ["envelope", "orbit"])
@pytest.mark.parametrize("place", Place)
def test_a_chain_of_which_every_site_is_excited_stays_in_phase(method: Any, place: Place) -> None:
    """All are one cell: the cycle of (8), which scipy finds by running it."""
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=3)
    found = breather(chain, nucleus=Nucleus(3, place=place), method=method)
    assert (found.nucleus.pattern, found.nucleus.relaxed_from) == ("00", "")
    assert abs(found.amplitudes - cycle_by_scipy()).max() <= found.error + 1e-6


def test_of_the_averaged_chain_the_envelope_is_exact_and_the_closed_form_is_not() -> None:
    """The closed form takes |φ_n| as geometric; its error is then its distance from (43)."""
    found = breather(CHAIN.averaged(), method="all")
    assert list(found.methods) == ["closed-form", "envelope", "simulation"]
    exact = found["envelope"]
    assert exact.error < 1e-12
    for name in ("closed-form", "simulation"):
        each = found[name]
        assert np.abs(each.amplitudes - exact.amplitudes).max() <= each.error + exact.error
        assert each.frequency == pytest.approx(1.0 + EPS * 0.1, abs=1e-9)
    assert float(found["closed-form"].error or 0.0) > 1e-4


@pytest.mark.parametrize("chain", [CHAIN, CHAIN.averaged()])
@pytest.mark.parametrize("method", ["closed-form", "envelope", "orbit", "simulation"])
def test_beyond_the_fold_nothing_is_nan_and_the_fold_is_named(chain: Any, method: Any) -> None:
    if method == "orbit" and isinstance(chain, AveragedChain):
        pytest.skip("the averaged chain has no orbits of (8)")
    found = breather(chain.replace(c=BEYOND), method=method)
    assert found.status is BreatherStatus.NONE
    assert found.status.sentence.endswith(".")
    assert found.frequency is None
    assert found.fold == pytest.approx(0.192, abs=6e-3)
    assert found.outward.size == found.inward.size == found.phases.size == 0
    answer = found.to_dict()
    assert not any(math.isnan(value) for value in numbers(answer))
    assert json.loads(json.dumps(answer))["frequency"] is None


def test_amplitudes_and_phases_are_listed_from_the_centre() -> None:
    found = breather(CHAIN, nucleus=Nucleus(3, "-+"), method="envelope")
    centre = SITES // 2
    assert found.outward.tolist() == found.amplitudes[centre:].tolist()
    assert found.inward.tolist() == found.amplitudes[centre::-1].tolist()
    # each excited site leads its inner neighbour by a quarter turn, and the tail lags behind
    assert found.phases[[centre - 1, centre, centre + 1]] == pytest.approx(
        [0.5, 0.0, 0.5], abs=0.03
    )
    assert found.phase_step == pytest.approx(-0.5 * math.pi, abs=0.1)
    assert isinstance(found, Breather)
    as_named = breather(CHAIN, nucleus=Nucleus(3, "00"), method="envelope")
    assert as_named.nucleus.pattern == "-+"


def test_where_the_orbit_cannot_be_had_the_error_is_unknown_and_says_why() -> None:
    stiff = VdpChain(a=A, b=0.001, c=0.003, eps=0.2, sites=SITES)
    found = breather(stiff, method="closed-form")
    assert found.error is None
    assert "eps" in found.error_unknown
    assert found.stable is None


@pytest.mark.parametrize(
    "make",
    [
        lambda: breather(CHAIN, method="guess"),  # type: ignore[call-overload]
        lambda: breather(CHAIN.averaged(), method="orbit"),
        lambda: breather(CHAIN.replace(c=0.0)),
        lambda: breather(CHAIN.replace(c=5e-324), method="closed-form"),
        lambda: breather(CHAIN.replace(b=1.0)),
        lambda: breather(CHAIN.replace(sites=102), method="orbit"),
        lambda: breather(CHAIN, nucleus=Nucleus(13, "0" * 12)),
        lambda: breather(CHAIN, nucleus=Nucleus(3, "00", Place.EDGE)),
        lambda: breather(CHAIN, nucleus=Nucleus(3, "-+"), method="closed-form"),
        lambda: cell(PiecewiseChain(c=0.5, eta=0.03)),
        lambda: cell(VdpChain(a=1e100, b=1e-100, c=0.0)),
        lambda: cell(CHAIN, tolerance=1.0),
    ],
)
def test_what_does_not_apply_is_refused_in_a_sentence(make: Any) -> None:
    with pytest.raises(ParameterError):
        make()


def test_a_cell_is_the_same_from_its_chain() -> None:
    alone, chained = cell(FrictionCell()), cell(FrictionChain(c=0.3, sites=3))
    assert isinstance(alone, BeltCell)
    assert dataclasses.replace(alone, seconds=0.0) == dataclasses.replace(chained, seconds=0.0)
    assert alone.to_dict()["basin"] == [alone.basin[0], alone.basin[1]]  # type: ignore[index]


@cache
def cell_of_unit_scale() -> Any:
    return cell(VdpChain(a=A, b=B, c=0.0))


@pytest.mark.parametrize("scale", [1e-40, 1e-3, 1e30])
def test_the_cycles_of_a_van_der_pol_cell_scale_with_a(scale: float) -> None:
    """y√a has the same cycles for the same η, however large a is."""
    one = cell_of_unit_scale()
    other = cell(VdpChain(a=A * scale, b=B * scale**2, c=0.0))
    for ours, theirs in (
        (one.stable_cycle, other.stable_cycle),
        (one.unstable_cycle, other.unstable_cycle),
    ):
        assert theirs.max * math.sqrt(scale) == pytest.approx(ours.max, rel=1e-9)
        assert theirs.period == pytest.approx(ours.period, rel=1e-9)
        assert abs(theirs.multiplier - ours.multiplier) <= theirs.multiplier_error < 1e-6
        assert theirs.error * math.sqrt(scale) < 1e-6 or theirs.error < 1e-9


def test_the_averaged_cell_has_the_roots_of_its_amplitude_equation() -> None:
    found = cell(CHAIN.averaged())
    low, high = np.sort(np.roots([B / 8, -A / 4, 1.0]).real)
    assert found.unstable_cycle.max**2 == pytest.approx(low, rel=1e-14)
    assert found.stable_cycle.max**2 == pytest.approx(high, rel=1e-14)
    assert found.basin == (-found.unstable_cycle.max, found.unstable_cycle.max)
    assert cell(AveragedChain(a=1.0, b=0.2, c=0.0)).status is CellStatus.REST


def test_the_error_of_the_closed_form_is_in_units_of_y(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a·s² and b·s⁴ for a and b all displacements are s times smaller."""
    monkeypatch.setattr(breathers, "approximate_multipliers", lambda *_: None)  # takes seconds
    monkeypatch.setattr(breathers, "_compared", lambda own, _: own)
    first, second = (
        breather(VdpChain(a=2.5 * s**2, b=0.5 * s**4, c=0.1, sites=15), method="closed-form")
        for s in (1.0, 4.0)
    )
    assert second.amplitudes == pytest.approx(first.amplitudes / 4.0, rel=1e-9)
    assert first.error / second.error == pytest.approx(4.0, rel=0.5)  # both are of rounding
    assert 1e-16 < first.error / first.amplitudes.max() < 1e-12


def test_the_stability_of_a_breather_can_be_copied_and_compared() -> None:
    stability = breather(AveragedChain(a=A, b=B, c=0.1, sites=5)).stability
    assert stability is not None
    again = pickle.loads(pickle.dumps(stability))
    assert again == stability
    assert hash(again) == hash(stability)
    changed = stability.values.copy()
    changed[-1] += 1.0
    assert dataclasses.replace(stability, values=changed) != stability
    assert "<10 complex>" in repr(stability)
