"""Breathers of chains of one's own: those of the paper's chain, and orbits that scipy confirms."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numba
import numpy as np
import pytest

from tests.reference_runs import states_by_scipy
from theory.averaged.breather import BreatherStatus
from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, RunError
from verification.breathers import own
from verification.breathers.breather import breather
from verification.breathers.floquet import floquet_multipliers
from verification.breathers.orbits import STARTS, Orbits
from verification.breathers.own import (
    OwnOrbits,
    _rate_of,
    _settled_start,
    integrate_with_tangents,
)
from verification.breathers.periodic_motion import first_harmonics, largest_displacements
from verification.breathers.result import Breather, BreatherMethod
from verification.continuation.newton import BranchPoint, NotConvergedError, solve_at
from verification.references.equations import pull_matrix
from verification.references.network import oscillator_rate
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers.variational import Flow
from verification.thresholds.continuation import _Report, breather_threshold
from verification.thresholds.result import ThresholdMethod
from verification.thresholds.threshold import choices, threshold


@numba.njit
def _bare(y, v):  # type: ignore[no-untyped-def]
    return 1.0 - 2.5 * y**2 + 0.5 * y**4


PAPER = {"damping": "1 - a*y**2 + b*y**4", "values": {"a": 2.5, "b": 0.5}}


@pytest.mark.parametrize("nucleus", [Nucleus(1), Nucleus(2, "0")])
def test_the_breather_of_the_paper_as_text_is_that_of_the_built_in_chain(nucleus: Nucleus) -> None:
    """By other steps (Runge-Kutta and not Taylor), from another start, the same orbit."""
    ours = breather(OscillatorChain(**PAPER, c=0.1, sites=9), nucleus=nucleus)
    theirs = breather(VdpChain(a=2.5, b=0.5, c=0.1, sites=9), nucleus=nucleus, method="orbit")
    assert ours.multipliers is not None
    assert theirs.multipliers is not None
    np.testing.assert_allclose(ours.amplitudes, theirs.amplitudes, atol=1e-11)
    assert ours.frequency == pytest.approx(theirs.frequency, abs=1e-12)
    assert ours.growth == pytest.approx(theirs.growth, abs=1e-8)
    far = [np.abs(ours.multipliers - each).min() for each in theirs.multipliers]
    assert max(far) < 1e-9
    assert ours.stable is theirs.stable


@pytest.mark.parametrize("size", [1e-8, 1e6])
def test_a_breather_and_its_errors_are_as_large_as_the_unit_of_y_makes_them(size: float) -> None:
    """In the equation of y/size all coefficients are of order one."""

    def found(unit: float) -> Breather:
        values = {"a": 2.5 / unit**2, "b": 0.5 / unit**4}
        chain = OscillatorChain(
            damping="1 - a*y**2 + b*y**4", values=values, c=0.1, eps=0.1, sites=3
        )
        return breather(chain, nucleus=Nucleus(1))

    one, other = found(1.0), found(size)
    assert one.error is not None
    assert other.error is not None
    assert one.frequency is not None
    apart = np.abs(other.amplitudes / size - one.amplitudes).max()
    assert apart <= one.error + other.error / size < 1e-10
    assert other.frequency == pytest.approx(one.frequency, abs=1e-11)
    assert other.growth == pytest.approx(one.growth, abs=1e-8)


def test_the_cycle_of_van_der_pol_has_the_published_period_and_amplitude() -> None:
    """ε = 1, far from averaging: two cells in step, whose coupling does nothing.

    The numbers are those of P. Amore, Computing the solutions of the van der Pol equation to
    arbitrary precision, arXiv:2111.12198, and of the test problem of E. Hairer, S. P. Nørsett and
    G. Wanner, Solving Ordinary Differential Equations I.
    """
    chain = OscillatorChain(damping="y**2 - 1", c=0.1, eps=1.0, sites=2)
    start = np.array([0.0, 0.0, 2.0, 2.0, 6.7])
    solved = solve_at(OwnOrbits(chain, Nucleus(1), 400).system(centre=0), start, chain.c).u
    assert solved[-1] == pytest.approx(6.663286859323130, abs=1e-13)
    flow = integrate_with_tangents(chain, solved[:-1], float(solved[-1]), 400)
    assert largest_displacements(flow.samples) == pytest.approx(2.008619860874843, abs=1e-13)


def test_an_orbit_of_a_disordered_chain_is_one_of_scipy_with_its_multipliers() -> None:
    """The state comes back after a period, and disturbances grow as the monodromy matrix says."""
    chain = OscillatorChain(**PAPER, c=0.08, disorder={"a": 0.02}, seed=4, sites=7)
    a = 2.5 * (1.0 + 0.02 * np.random.default_rng([4, 0]).standard_normal(7))
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - a * y**2 + 0.5 * y**4, pull_matrix(7), c=0.08, eps=0.01
    )
    orbit = OwnOrbits(chain, Nucleus(1)).solve()
    times = np.array([0.0, orbit.period])

    def after(state: np.ndarray) -> np.ndarray:
        return states_by_scipy(rate, state, times, 1e-13)[-1]

    assert np.abs(after(orbit.state) - orbit.state).max() < 1e-9 > orbit.error
    flow = integrate_with_tangents(chain, orbit.state, orbit.period, 128)
    kick = np.random.default_rng(0).standard_normal(14)
    moved = (after(orbit.state + 1e-4 * kick) - after(orbit.state - 1e-4 * kick)) / 2e-4
    np.testing.assert_allclose(flow.monodromy @ kick, moved, atol=1e-6)
    size = 1e-4
    apart = [
        integrate_with_tangents(chain.replace(c=0.08 + d), orbit.state, orbit.period, 128).state
        for d in (-size, size)
    ]
    np.testing.assert_allclose(flow.by_c, (apart[1] - apart[0]) / (2.0 * size), atol=1e-8)


SPRINGS = {
    "line": {},
    "ends held": {"ends": "fixed"},
    "resistive line": {"velocity_coupling": 0.7},
    "network": {"coupling": "square", "sites": (2, 2)},
    "resistive network": {"coupling": "square", "sites": (2, 2), "velocity_coupling": 0.7},
}


@pytest.mark.parametrize("springs", SPRINGS)
def test_rates_of_motion_and_tangents_are_those_of_the_equation(springs: str) -> None:
    """Of every coupling: the first column by the chain written anew, the others by differences."""
    chain = OscillatorChain(**PAPER, **{"c": 0.3, "eps": 0.5, "sites": 4, **SPRINGS[springs]})
    matrix = pull_matrix(4, chain.ends)
    if "network" in springs:  # corners of a square: each has two neighbours
        matrix = np.array([[2, -1, -1, 0], [-1, 2, 0, -1], [-1, 0, 2, -1], [0, -1, -1, 2]])

    def rate(state: np.ndarray, c: float) -> np.ndarray:
        made = oscillator_rate(
            lambda y: y, lambda y, v: 1.0 - 2.5 * y**2 + 0.5 * y**4, matrix, c=c, eps=0.5,
            d=chain.velocity_coupling,
        )  # fmt: skip
        return made(0.0, state)

    rng = np.random.default_rng(6)
    columns = rng.normal(size=(8, 4))
    found = _rate_of(chain)(columns)
    state, size = columns[:, 0], 1e-6
    np.testing.assert_allclose(found[:, 0], rate(state, 0.3), rtol=1e-13, atol=1e-13)
    along = columns[:, 1:3]
    for k in range(2):
        apart = rate(state + size * along[:, k], 0.3) - rate(state - size * along[:, k], 0.3)
        np.testing.assert_allclose(found[:, 1 + k], apart / (2.0 * size), atol=1e-7)
    # The last column moves with c as well.
    moved = columns[:, 3]
    apart = rate(state + size * moved, 0.3 + size) - rate(state - size * moved, 0.3 - size)
    np.testing.assert_allclose(found[:, 3], apart / (2.0 * size), atol=1e-7)


def test_in_a_disordered_network_each_site_moves_by_its_own_coefficient() -> None:
    chain = OscillatorChain(
        **PAPER, c=0.3, eps=0.5, coupling="square", sites=(2, 2), disorder={"a": 0.1}, seed=4
    )
    a = 2.5 * (1.0 + 0.1 * np.random.default_rng([4, 0]).standard_normal(4))
    square = np.array([[2, -1, -1, 0], [-1, 2, 0, -1], [-1, 0, 2, -1], [0, -1, -1, 2]])
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - a * y**2 + 0.5 * y**4, square, c=0.3, eps=0.5
    )
    columns = np.random.default_rng(6).normal(size=(8, 3))
    found = _rate_of(chain)(columns)
    state, along, size = columns[:, 0], columns[:, 1], 1e-6
    np.testing.assert_allclose(found[:, 0], rate(0.0, state), rtol=1e-13, atol=1e-13)
    apart = rate(0.0, state + size * along) - rate(0.0, state - size * along)
    np.testing.assert_allclose(found[:, 1], apart / (2.0 * size), atol=1e-7)


def test_tangents_of_a_cell_whose_slopes_are_the_same_everywhere_are_those_of_every_site() -> None:
    """Without a nonlinear spring that by y is a number, and no array of sites."""
    chain = OscillatorChain(damping="a*v**2 - 1", values={"a": 2.0}, c=0.3, eps=0.5, sites=3)
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 2.0 * v**2 - 1.0, pull_matrix(3), c=0.3, eps=0.5
    )
    columns = np.random.default_rng(5).normal(size=(6, 3))
    found = _rate_of(chain)(columns)
    state, along, size = columns[:, 0], columns[:, 1], 1e-6
    np.testing.assert_allclose(found[:, 0], rate(0.0, state), rtol=1e-13, atol=1e-13)
    apart = rate(0.0, state + size * along) - rate(0.0, state - size * along)
    np.testing.assert_allclose(found[:, 1], apart / (2.0 * size), atol=1e-7)


def test_a_motion_that_overflows_is_refused() -> None:
    chain = OscillatorChain(**PAPER, c=0.3, eps=0.5, sites=2)
    with pytest.raises(ParameterError, match="overflow"):
        integrate_with_tangents(chain, np.array([1e100, 0.0, 0.0, 0.0]), 0.1, 1)


def test_a_motion_and_its_tangents_are_stepped_by_dop853() -> None:
    chain = OscillatorChain(**PAPER, c=0.3, eps=0.5, sites=3)
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - 2.5 * y**2 + 0.5 * y**4, pull_matrix(3), c=0.3, eps=0.5
    )
    start = np.array([1.0, 0.2, -0.4, 0.3, 1.5, 0.1])
    flow = integrate_with_tangents(chain, start, 2.0, 40)
    times = np.array([0.0, 1.0, 2.0])
    states = states_by_scipy(rate, start, times)
    np.testing.assert_allclose(flow.state, states[-1], atol=1e-10)
    np.testing.assert_allclose(flow.samples[[0, 20]], states[:2, :3], atol=1e-10)
    kick = 1e-6 * np.array([0.3, -1.0, 0.2, 0.5, 0.4, -0.7])
    ends = [states_by_scipy(rate, start + each, times)[-1] for each in (kick, -kick)]
    np.testing.assert_allclose(flow.monodromy @ kick, 0.5 * (ends[0] - ends[1]), atol=1e-12)
    ends = [
        states_by_scipy(
            oscillator_rate(
                lambda y: y, lambda y, v: 1.0 - 2.5 * y**2 + 0.5 * y**4, pull_matrix(3), c=c,
                eps=0.5,
            ), start, times)[-1]
        for c in (0.3 + 1e-4, 0.3 - 1e-4)
    ]  # fmt: skip
    np.testing.assert_allclose(flow.by_c, (ends[0] - ends[1]) / 2e-4, atol=1e-6)


@pytest.mark.parametrize("eps", [0.05, 0.5])
def test_an_orbit_has_more_steps_where_its_damping_is_stronger(eps: float) -> None:
    """max |h| on the stable cycle of the paper's cell is (1 + 7s)/(1 - s), s² = 1 - 8η."""
    chain = OscillatorChain(**PAPER, c=0.1, eps=eps, sites=3)
    s = np.sqrt(1.0 - 8.0 * 0.5 / 2.5**2)
    stiffness = eps * (1.0 + 7.0 * s) / (1.0 - s)
    # It is looked for at 200 phases, the nearest of which is 1/60 off, so that some is missed.
    assert OwnOrbits(chain, Nucleus(1)).count / 64 == pytest.approx(1.0 + stiffness, rel=0.02)
    assert OwnOrbits(chain, Nucleus(1)).count >= 64 * (1.0 + 0.999 * stiffness)


def test_the_steps_of_an_orbit_are_counted_from_the_damping_along_it() -> None:
    """Of a cell that turns twice as fast, whose velocities are twice as large as its places."""
    chain = OscillatorChain(
        damping="1 - 2.5*y**2 + 0.5*y**4", stiffness="4*y", c=0.1, eps=0.1, sites=3
    )
    y = np.linspace(0.0, chain.stable_amplitude, 1000)
    stiffness = 0.1 * np.abs(1.0 - 2.5 * y**2 + 0.5 * y**4).max()
    assert OwnOrbits(chain, Nucleus(1)).count / 64 == pytest.approx(1.0 + stiffness, rel=0.02)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("angle", [0.3, 2.0, 4.0, 6.0])
def test_all_phases_of_an_orbit_are_looked_at_for_its_strongest_damping(
    angle: float, sign: float
) -> None:
    """Which is at one place of a circle of radius 2, and may be negative."""
    place = 2.0 * math.sin(angle), 2.0 * math.cos(angle)

    def damping(y: Any, v: Any) -> Any:
        return sign * 10.0 * np.exp(-10.0 * ((y - place[0]) ** 2 + (v - place[1]) ** 2))

    cycle = SimpleNamespace(amplitude=2.0, velocity=2.0)
    cell = SimpleNamespace(cycles=[cycle], damping_at=damping)
    chain = SimpleNamespace(cell=cell, stable_amplitude=2.0, eps=0.5)
    count: Any = OwnOrbits.count
    found = count.fget(SimpleNamespace(steps=None, chain=chain))
    assert found / 64 == pytest.approx(1.0 + 0.5 * 10.0, rel=0.01)


def test_the_state_of_an_orbit_moves_as_its_chain_does() -> None:
    state = np.random.default_rng(4).normal(size=6)
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - 2.5 * y**2 + 0.5 * y**4, pull_matrix(3), c=0.3, eps=0.01
    )
    orbits = OwnOrbits(OscillatorChain(**PAPER, c=0.1, sites=3), Nucleus(1))
    np.testing.assert_allclose(orbits.rate(0.3, state), rate(0.0, state), rtol=1e-13)


def test_multipliers_of_a_chain_whose_sites_may_differ_are_not_split(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    parities: list[int] = []
    sort = floquet_multipliers

    def noted(*given: Any, parity: int, **options: Any) -> Any:
        parities.append(parity)
        return sort(*given, parity=parity, **options)

    monkeypatch.setattr("verification.breathers.orbits.floquet_multipliers", noted)
    chain = OscillatorChain(**PAPER, c=0.1, disorder={"a": 0.1}, seed=1, sites=3)
    u = np.array([0.0, 0.0, 0.0, 0.1, 2.8, 0.1, 6.28])
    point = BranchPoint(u, 0.1, np.zeros(8), 0.0, 0.0, 1, 1.0)
    OwnOrbits(chain, Nucleus(1), 10).measured(point, 0.0)
    assert parities == [0]


@pytest.mark.parametrize("size", [3e-9, 0.03, 1.0, 2.8, 9.9, 5e6])
def test_unknowns_of_an_orbit_are_of_order_one_in_their_unit(size: float) -> None:
    unit: Any = OwnOrbits.unit
    found = unit.fget(SimpleNamespace(chain=SimpleNamespace(stable_amplitude=size)))
    assert 1.0 - 1e-12 <= size / found < 10.0
    assert not OwnOrbits.symmetric_chain  # whose sites may differ, and with them both halves


def test_an_orbit_is_solved_for_in_units_of_its_amplitude(monkeypatch: pytest.MonkeyPatch) -> None:
    """States, samples and changes with c are divided by it; periods and slopes are not."""
    chain: Any = SimpleNamespace(c=0.1, replace=SimpleNamespace)
    family: Any = SimpleNamespace(
        chain=chain, unit=100.0, nucleus="nucleus", system=lambda: "system",
        _settled=lambda of: OwnOrbits._settled(family, of),
    )  # fmt: skip
    asked: list[Any] = []

    def integrate(*given: Any) -> Flow:
        asked.append(given)
        return Flow(given[1] + 100.0, np.eye(2), np.full(2, 300.0), np.full((4, 1), 500.0), 4)

    monkeypatch.setattr(own, "integrate_with_tangents", integrate)
    flow = OwnOrbits.flow(family, 0.3, np.array([1.0, 2.0]), 6.0, 4)
    ((at, start, duration, steps),) = asked
    assert (at.c, start.tolist(), duration, steps) == (0.3, [100.0, 200.0], 6.0, 4)
    assert (flow.state.tolist(), flow.by_c.tolist()) == ([2.0, 3.0], [3.0, 3.0])
    assert flow.samples.tolist() == [[5.0]] * 4
    assert flow.monodromy.tolist() == np.eye(2).tolist()

    monkeypatch.setattr(own, "_rate_of", lambda of: lambda columns: of.c * columns**2)
    assert OwnOrbits.rate(family, 0.5, np.array([1.0, 2.0])).tolist() == [50.0, 200.0]

    monkeypatch.setattr(own, "_settled_start", lambda *_: np.array([100.0, 200.0, 300.0, 6.0]))
    monkeypatch.setattr(own, "solve_at", lambda *given: given)
    system, guess, c = OwnOrbits.directly(family)
    assert (system, guess.tolist(), c) == ("system", [1.0, 2.0, 3.0, 6.0], 0.1)


@pytest.mark.parametrize("centre", [0, 2])
def test_an_orbit_begins_where_the_site_that_is_named_is_at_rest(centre: int) -> None:
    u = np.append(np.random.default_rng(3).normal(size=6), 0.5)
    value, slope, _ = Orbits(VdpChain(a=2.5, b=0.5, c=0.1, sites=3), Nucleus(1)).system(
        centre=centre
    )(u, 0.1)
    assert value[-1] == u[centre]
    assert slope[-1].tolist() == [float(k == centre) for k in range(7)]


def test_along_a_circle_without_damping_an_orbit_has_the_fewest_steps() -> None:
    """(y² + ẏ² - 1) ẏ is zero on the cycle."""
    chain = OscillatorChain(damping="y**2 + v**2 - 1", c=0.1, eps=0.5, sites=3)
    assert 64 <= OwnOrbits(chain, Nucleus(1)).count <= 65


def test_orbits_are_of_at_most_a_hundred_and_one_sites() -> None:
    own.check_orbits(OscillatorChain(**PAPER, c=0.1, sites=101))
    assert own.MAX_SITES == 101
    with pytest.raises(
        ParameterError, match=r"number of sites n = 102 .* at most 101 for an orbit"
    ):
        own.check_orbits(OscillatorChain(**PAPER, c=0.1, sites=102))


def test_a_force_without_derivatives_is_refused_before_any_search() -> None:
    with pytest.raises(ParameterError, match="given with its derivatives for a breather"):
        own.check_orbits(OscillatorChain(damping=_bare, c=0.1, sites=3))


def test_a_nucleus_settles_whose_period_is_that_of_no_cell_at_small_eps() -> None:
    """Near the plateau of a force it is 31, and of the cycles of a cell 7.0 and 15.9.

    It ended in an IndexError.
    """
    chain = OscillatorChain(
        stiffness="y - 0.35*y**3 + 0.0307*y**5", damping="1 - 5.5*y**2 + 1.1*y**4", c=0.02,
        sites=3, eps=0.1,
    )  # fmt: skip
    start = _settled_start(chain, Nucleus(1))
    rate = oscillator_rate(
        lambda y: y - 0.35 * y**3 + 0.0307 * y**5, lambda y, v: 1.0 - 5.5 * y**2 + 1.1 * y**4,
        pull_matrix(3), c=0.02, eps=0.1,
    )  # fmt: skip
    after = states_by_scipy(rate, start[:-1], np.array([0.0, start[-1]]))[-1]
    assert start[-1] == pytest.approx(31.0, abs=0.2)
    assert np.abs(after - start[:-1]).max() < 0.05


@pytest.mark.parametrize("turns", [1, 2, 3])
def test_the_start_of_an_orbit_is_the_last_rise_of_its_centre_and_the_period_the_time_before(
    turns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up run that turns six, three or two times as slowly as a cell, in two blocks."""
    chain = OscillatorChain(**PAPER, c=0.1, eps=0.3, sites=3)
    period, begun = 12.0 * np.pi / turns - 0.3, 5.0

    class Made:
        default_budget = 7

        def __init__(self, _: Any, __: Any, times: np.ndarray, *, tolerance: float) -> None:
            angle = 2.0 * np.pi * (times - times[0] - begun) / period
            y = np.outer(np.sin(angle), [0.1, 2.0, 0.1])
            v = np.outer(np.cos(angle), [0.1, 2.0, 0.1])
            self.samples = np.stack([y, v], axis=1)
            self.sampled_amplitude = np.hypot(y, v)
            self.time, self._end = 0.0, float(times[-1])

        @property
        def finished(self) -> bool:
            return self.time >= self._end

        def advance(self, budget: int) -> None:
            assert budget == 7
            self.time += self._end / 2.0

    monkeypatch.setattr(own, "SmoothIntegration", Made)
    parts: list[float] = []
    if turns == 1:
        with pytest.raises(RunError, match="oscillates more slowly than in 3 periods of a cell"):
            _settled_start(chain, Nucleus(1), parts.append)
        return
    start = _settled_start(chain, Nucleus(1), parts.append)
    assert parts == [0.5, 0.5]
    assert start[-1] == pytest.approx(period, abs=1e-3)
    assert start[:-1] == pytest.approx([0.0, 0.0, 0.0, 0.1, 2.0, 0.1], abs=1e-3)


def test_a_nucleus_too_slow_to_be_seen_twice_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(own, "_LAST", 1)
    with pytest.raises(RunError, match=r"at eps = 0\.3 .* oscillates more slowly .* smaller eps"):
        _settled_start(OscillatorChain(**PAPER, c=0.1, eps=0.3, sites=5), Nucleus(1))


@pytest.mark.parametrize("angle", [-2.0, 0.0, 0.5, 3.0])
def test_the_first_harmonic_has_the_phase_at_which_a_site_leads(angle: float) -> None:
    """y = Im(h exp(iωt)), so that a site that rises through rest has a real one."""
    time = 2.0 * np.pi * np.arange(8) / 8
    samples = 3.0 * np.sin(time + angle) + 0.5 * np.cos(3.0 * time)
    (found,) = first_harmonics(samples[:, None])
    assert found == pytest.approx(3.0 * np.exp(1j * angle), abs=1e-13)


@pytest.mark.parametrize("count", [5, 6, 7])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_largest_displacement_is_that_of_all_harmonics_that_samples_hold(
    count: int, side: float
) -> None:
    """To whichever side it is."""

    def y(phase: np.ndarray) -> np.ndarray:
        return np.asarray(side * 0.3 + np.sin(phase) + 0.4 * np.cos(2.0 * phase + 0.5))

    samples = y(2.0 * np.pi * np.arange(count) / count)[:, None]
    true = np.abs(y(np.linspace(0.0, 2.0 * np.pi, 100001))).max()
    assert largest_displacements(samples) == pytest.approx(true, rel=1e-8)


def test_a_settled_nucleus_is_taken_as_its_centre_rises_through_rest() -> None:
    chain = OscillatorChain(**PAPER, c=0.1, eps=0.3, sites=5)
    start = _settled_start(chain, Nucleus(1))
    y, v, period = start[:5], start[5:-1], start[-1]
    assert abs(y[2]) < 1e-3  # between samples
    assert v[2] > 1.0
    assert period == pytest.approx(2.0 * np.pi, rel=0.05)
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - 2.5 * y**2 + 0.5 * y**4, pull_matrix(5), c=0.1, eps=0.3
    )
    after = states_by_scipy(rate, start[:-1], np.array([0.0, period]))[-1]
    assert np.abs(after - start[:-1]).max() < 0.02  # it has settled, to what interpolation leaves


def test_a_branch_begins_at_the_first_of_the_couplings_where_a_nucleus_settles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solved: list[float] = []

    def settled(chain: OscillatorChain, nucleus: Nucleus, _: object) -> np.ndarray:
        if chain.c == STARTS[0]:
            raise ParameterError("coupling c", chain.c, "smaller", "take a smaller coupling")
        return np.full(7, chain.c)

    def solve(system: Any, guess: np.ndarray, c: float) -> float:
        solved.append(c)
        assert callable(system)
        assert np.all(guess == c)
        if c != STARTS[-1]:
            raise NotConvergedError("lost")
        return c

    monkeypatch.setattr(own, "_settled_start", settled)
    monkeypatch.setattr(own, "solve_at", solve)
    orbits = OwnOrbits(OscillatorChain(**PAPER, c=0.1, eps=0.3, sites=3), Nucleus(1))
    assert orbits.start(0.5) == STARTS[-1]
    assert solved == [*STARTS[1:]]
    monkeypatch.setattr(own, "STARTS", STARTS[:-1])
    with pytest.raises(ParameterError, match="stable at small couplings"):
        orbits.start(0.5)


def test_the_run_on_which_a_nucleus_settles_reports_before_the_first_solution(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At small ε it takes minutes; its parts are those of its time, and make one solution."""
    monkeypatch.setattr(SmoothIntegration, "default_budget", 2_000)
    chain = OscillatorChain(**PAPER, c=0.05, sites=3)
    parts: list[float] = []
    _settled_start(chain, Nucleus(1), parts.append)
    assert len(parts) > 5
    assert sum(parts) == pytest.approx(1.0, rel=1e-12)
    assert min(parts) > 0.0
    seen: list[float] = []
    monkeypatch.setattr(own, "solve_at", lambda *_: seen[-1])
    assert 0.0 < OwnOrbits(chain, Nucleus(1)).start(0.5, report=_Report(seen.append)) < 0.2


def test_the_branch_of_a_rayleigh_chain_ends_where_that_of_van_der_pol_does(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The velocity of ÿ + y + εh(ẏ)ẏ + … = 0 obeys (8): (h(w)w)' = (1 - 3aw² + 5bw⁴)w'.

    Orbits are solved some two hundred times; by 24 steps a period they are good to 2e-11.
    """
    monkeypatch.setattr(own, "STEPS", 24)
    rayleigh = OscillatorChain(damping="1 - a*v**2 + b*v**4", values={"a": 2.5 / 3, "b": 0.1}, c=0)
    ours = breather_threshold(rayleigh, Nucleus(1), ThresholdMethod.ORBIT, margin=2)
    theirs = breather_threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(1), ThresholdMethod.ORBIT, 2)
    assert ours.stable_to is not None
    assert ours.c_crit == pytest.approx(theirs.c_crit, abs=1e-10)
    assert ours.stable_to == pytest.approx(theirs.stable_to, abs=1e-8)
    assert ours.growth_half_way == pytest.approx(theirs.growth_half_way, abs=1e-4)
    assert ours.lost_by is theirs.lost_by
    # Its sites may differ, so that modes are not told apart by their parity.
    assert (ours.growth_half_way_mirrored, ours.growth_half_way_mirrored_error) == (None, None)


def test_a_branch_is_followed_of_alike_sites_along_a_line_only() -> None:
    line: dict[str, Any] = {**PAPER, "c": 0.1}
    for chain, words in (
        (OscillatorChain(**line, disorder="a=0.1"), "take bisection"),
        (OscillatorChain(**line, coupling="square", sites=(5, 5)), "take bisection"),
        (OscillatorChain(**line, drive="1,1@1"), "none for a breather"),
    ):
        with pytest.raises(ParameterError, match=words):
            threshold(chain, method="orbit")
    with pytest.raises(ParameterError, match="bisection or orbit for the model chain"):
        threshold(OscillatorChain(**line), method="envelope")


def test_a_nucleus_that_spreads_has_no_orbit_and_an_overdamped_cell_none_at_all() -> None:
    with pytest.raises(ParameterError, match="stays localised: after 40 units of slow time"):
        breather(OscillatorChain(**PAPER, c=0.6, sites=9))
    with pytest.raises(ParameterError, match="orbit for a chain of your own"):
        breather(OscillatorChain(**PAPER, c=0.1, sites=9), method="simulation")
    nagumo = OscillatorChain(damping=0, stiffness="y*(1-y)*(0.2-y)", overdamped=True, c=0.01)
    with pytest.raises(ParameterError, match="overdamped"):
        breather(nagumo)


@pytest.mark.parametrize("method", [None, "orbit"])
def test_a_chain_of_ones_own_has_the_method_orbit_by_its_name_as_well(
    method: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(OwnOrbits, "solve", lambda own: own.nucleus)
    found: Any = breather(OscillatorChain(**PAPER, c=0.1, sites=5), Nucleus(1), method=method)
    assert found == Nucleus(1)


def test_the_command_line_gives_the_breather(answered: Any) -> None:
    line = ["breather", "chain", "--damping", PAPER["damping"], "--value", "a=2.5", "--value"]
    found = answered([*line, "b=0.5", "--c", "0.1", "--n", "9"])
    assert found["stable"] is True
    assert abs(found["frequency"] - 1.0009) < 1e-3


def _in_extended_precision(chain: OscillatorChain, u: np.ndarray) -> np.ndarray:
    """Return the state after a period, by Taylor series in extended precision."""
    wide = np.longdouble
    a, b = (wide(chain.values[name]) for name in ("a", "b"))
    pull = pull_matrix(chain.sites, chain.ends).astype(wide) * wide(chain.eps) * wide(chain.c)
    resistive, order, steps = wide(chain.velocity_coupling), 24, 40
    h = wide(u[-1]) / steps
    start = u[:-1].astype(wide)

    def product(one: np.ndarray, other: np.ndarray, k: int) -> np.ndarray:
        return (one[: k + 1] * other[k::-1]).sum(axis=0)

    y, v, square, fourth, damping = np.zeros((5, order + 1, chain.sites), dtype=wide)
    y[0], v[0] = start[: chain.sites], start[chain.sites :]
    for _ in range(steps):
        for k in range(order):
            square[k] = product(y, y, k)
            fourth[k] = product(square, square, k)
            damping[k] = float(k == 0) - a * square[k] + b * fourth[k]
            force = y[k] + wide(chain.eps) * product(damping, v, k)
            y[k + 1] = v[k] / (k + 1)
            v[k + 1] = -(force + pull @ (y[k] + resistive * v[k])) / (k + 1)
        powers = h ** np.arange(order + 1)
        y[0], v[0] = powers @ y, powers @ v
    return np.concatenate([y[0], v[0]])


def test_the_error_of_an_orbit_covers_its_round_off() -> None:
    """Where the cycle attracts weakly; the distance is a step of Newton's method from the orbit."""
    chain = OscillatorChain(
        damping="1 - a*y**2 + b*y**4", stiffness="y + k*y**3",
        values={"a": 1.7851875404590136, "b": 0.36532459986133087, "k": 0.0},
        eps=0.009692391065914789, c=0.024972876825789712, velocity_coupling=0.2093680712049244,
        sites=3, ends="periodic",
    )  # fmt: skip
    found = breather(chain)
    u, step = found.unknowns, 1e-7

    def gap(u: np.ndarray) -> np.ndarray:
        back = _in_extended_precision(chain, u) - u[:-1]
        return np.append(back, np.longdouble(u[1])).astype(float)

    slope = np.array([(gap(u + step * e) - gap(u - step * e)) / (2 * step) for e in np.eye(7)]).T
    distance = np.abs(np.linalg.solve(slope, gap(u))).max()
    assert distance <= found.error < 1e-12


@pytest.mark.parametrize(
    ("waves", "pattern", "renamed"),
    [
        ([0.1, 2.0, 2.0j, 0.1], "+", True),
        ([0.1, 2.0, 2.0j, 2.0j], "-", False),  # three sites
        ([2.0, 0.1, 0.1, 2.0], "-", False),  # not adjacent: without a name
        ([0.1, 2.0, 2.0j, 2.0, 0.1], "-", False),  # three sites in the middle
    ],
)
def test_a_breather_of_a_line_has_the_name_of_the_nucleus_on_which_it_settled(
    waves: list[complex], pattern: str, renamed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = Nucleus(2, "-")
    for springs, line in (({}, True), ({"coupling": "square", "sites": (2, 2)}, False)):
        chain = OscillatorChain(**PAPER, c=0.1, **({"sites": len(waves)} | springs))
        found = Breather(
            chain=chain, nucleus=given, method=BreatherMethod.ORBIT, status=BreatherStatus.EXISTS,
            waves=np.array(waves), seconds=0.0,
        )  # fmt: skip
        monkeypatch.setattr(Orbits, "solve", lambda *_, found=found: found)
        settled = OwnOrbits(chain, given).solve()
        assert settled.nucleus.pattern == (pattern if line else "-")
        assert (settled is found) is not (line and renamed)


def test_two_methods_and_the_definitions_that_each_evaluates_are_told_apart() -> None:
    help_of_methods = choices(OscillatorChain)["method"][1]
    assert help_of_methods.startswith("bisection (default): ")
    assert " orbit: " in help_of_methods
    words = choices(OscillatorChain)["definition"][1]
    assert words.startswith("bisection: first (default), several or whole; orbit: existence (d")
