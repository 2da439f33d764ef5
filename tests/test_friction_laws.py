"""Claims about friction laws other than (2): events against scipy, Hopf velocities by mpmath."""

from __future__ import annotations

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.test_friction_integrator import assert_error_bounds, assert_events_of_scipy, random_start
from theory.cells.friction import (
    FrictionCell,
    check_sliding_stable,
    friction_coefficient,
    friction_slope,
)
from theory.cells.friction_law import FrictionLaw
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError
from verification.cells import friction_cycles
from verification.cells.diagram import cell_diagram
from verification.cells.friction import cycle_velocities, friction_cell, unstable_cycle
from verification.cells.result import CellStatus
from verification.references.equations import dynamic_friction
from verification.references.friction_events import run_events
from verification.runs.excite import excite
from verification.runs.simulate import simulate
from verification.steppers import friction_series

LAWS = {
    "exponential": FrictionCell(viscous=0.1),
    "stribeck": FrictionCell(law="stribeck", v_s=0.6, viscous=0.05),
    "stribeck steep": FrictionCell(law="stribeck", v_s=0.05, v_d=0.4),
    "coulomb": FrictionCell(law="coulomb", v_d=0.6),
    "coulomb viscous": FrictionCell(law="coulomb", mu_d=0.3, viscous=0.1),
}


START = random_start(4, seed=20261122)
RUNS = {
    **{
        f"{name}, c = {c}": (FrictionChain.of(cell, c=c, sites=4), START, 10.0)
        for name, cell in LAWS.items()
        for c in (0.05, 3.0)
    },
    # So far from stick e^{-(w/v_s)²} is below 1e-300 at first, and of order one on return.
    "stribeck, far": (
        FrictionChain.of(LAWS["stribeck"], c=0.1, sites=3),
        np.array([[20.0, 0, 0], [0, 0, 0]]),
        12.0,
    ),
}


@pytest.mark.parametrize("name", RUNS)
def test_every_event_is_that_of_scipy(name: str) -> None:
    run = assert_events_of_scipy(*RUNS[name], steep="steep" in name or "far" in name)
    assert run.event_count >= 2


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_the_error_reported_bounds_the_true_one(name: str, tolerance: float) -> None:
    assert_error_bounds(*RUNS[name], tolerance)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("speed", [0.0, 0.01, 0.3, 0.7, 2.0, 40.0])
def test_the_curve_and_its_slope_are_those_of_mpmath(name: str, speed: float) -> None:
    cell = LAWS[name]

    def curve(v: mp.mpf) -> mp.mpf:
        return dynamic_friction(v, cell, mp.exp)

    slope = mp.diff(curve, speed, direction=1)
    assert friction_coefficient(cell, -speed) == pytest.approx(float(curve(mp.mpf(speed))), 1e-14)
    assert friction_slope(cell, speed) == pytest.approx(float(slope), rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("viscous", [0.0, 0.1])
@pytest.mark.parametrize("v_s", [0.01, 0.5, 0.8])
@pytest.mark.parametrize("xi", [1e-9, 0.05, 0.2])
def test_stribeck_sliding_loses_stability_at_both_roots(
    v_s: float, xi: float, viscous: float
) -> None:
    cell = FrictionCell(law="stribeck", v_s=v_s, xi=xi, viscous=viscous)
    low, high, error = cell.curve.unstable_sliding(2 * xi)
    with mp.workdps(40):
        level = (2 * mp.mpf(xi) + mp.mpf(viscous)) * mp.mpf(v_s) / (2 * (mp.mpf(1) - cell.mu_d))
        # x e^{-x²} = a is -2x² e^{-2x²} = -2a².
        roots = [v_s * mp.sqrt(-mp.lambertw(-2 * level**2, k).real / 2) for k in (0, -1)]
        assert abs(low - roots[0]) <= error < 1e-13
        assert abs(high - roots[1]) <= error
    assert cell.hopf_velocity == high
    for v_d, stable in ((0.99 * low, True), (1.01 * low, False), (0.99 * high, False)):
        other = FrictionCell(law="stribeck", v_s=v_s, xi=xi, viscous=viscous, v_d=v_d)
        assert (other.effective_damping > 0) == (other.stability_margin > 0) == stable
        if not stable:
            with pytest.raises(ParameterError, match="steady sliding is unstable"):
                check_sliding_stable(other)


def test_stribeck_sliding_is_stable_at_every_velocity_with_enough_damping() -> None:
    enough = 0.5 * math.sqrt(2 / math.e) / 0.5  # the largest |μ'|
    for factor, stable in ((1.001, True), (0.999, False)):
        cell = FrictionCell(law="stribeck", viscous=factor * enough, xi=0.0)
        assert (cell.hopf_velocity == 0.0) == stable
    assert FrictionCell(law="stribeck", xi=0.0).hopf_velocity == math.inf


def test_a_viscous_part_moves_the_hopf_velocity_as_damping_does() -> None:
    with_both = FrictionCell(xi=0.05, viscous=0.06)
    assert with_both.hopf_velocity == pytest.approx(FrictionCell(xi=0.08).hopf_velocity, rel=1e-14)


def test_a_viscous_part_acts_on_a_cell_in_slip_as_damping_and_a_shift() -> None:
    # κ(v_d - ẏ) is κv_d and a damping κ = 2ξ of its own, as long as the cell does not stick.
    with_both = unstable_cycle(FrictionCell(xi=0.05, viscous=0.02))
    damped = unstable_cycle(FrictionCell(xi=0.06))
    room = with_both.error + damped.error
    assert abs(with_both.max - 0.02 * 1.25 - damped.max) <= room < 1e-8
    assert abs(with_both.min - 0.02 * 1.25 - damped.min) <= room
    near = [
        unstable_cycle(FrictionCell(xi=xi, viscous=viscous, v_d=cell.hopf_velocity + 1e-8))
        for xi, viscous in ((0.05, 0.02), (0.06, 0.0))
        for cell in (FrictionCell(xi=0.06),)
    ]
    assert near[0].max - near[0].min == pytest.approx(near[1].max - near[1].min, rel=1e-6)


def test_coulomb_friction_has_no_hopf_bifurcation_and_says_so() -> None:
    with pytest.raises(ParameterError, match="mu does not fall"):
        _ = LAWS["coulomb"].hopf_velocity
    assert LAWS["coulomb"].stability_margin == LAWS["coulomb"].v_d


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"law": "dry"}, "exponential, stribeck, coulomb"),
        ({"law": 3}, "exponential, stribeck, coulomb"),
        ({"v_s": 0.3}, "the law stribeck only"),
        ({"law": "coulomb", "v_s": 0.3}, "the law stribeck only"),
        ({"law": "stribeck", "v0": 0.3}, "the law exponential only"),
        ({"law": "stribeck", "v_s": 0.0}, "v_s"),
        ({"law": "stribeck", "viscous": -0.1}, "viscous"),
        ({"viscous": float("nan")}, "viscous"),
    ],
)
def test_what_a_law_does_not_have_is_refused(given: dict[str, object], words: str) -> None:
    for make in (FrictionCell, lambda **rest: FrictionChain(c=0.1, **rest)):
        with pytest.raises(ParameterError, match=words):
            make(**given)


CELLS = {
    "stribeck": FrictionCell(law="stribeck"),
    "stribeck viscous": FrictionCell(law="stribeck", v_s=0.3, viscous=0.05, v_d=0.9),
    "coulomb": FrictionCell(law="coulomb", v_d=0.5),
    "coulomb viscous": FrictionCell(law="coulomb", mu_d=0.3, viscous=0.1, v_d=0.3),
}


@pytest.mark.parametrize("name", CELLS)
@pytest.mark.parametrize("side", [0, 1])
def test_the_basin_of_a_law_ends_where_runs_of_scipy_begin_to_stick(name: str, side: int) -> None:
    found = friction_cell(CELLS[name])
    assert found.status is CellStatus.BISTABLE
    assert found.basin is not None
    chain = FrictionChain.of(CELLS[name], c=0.0, sites=1)
    sticks = []
    for step in (-1e-3, 1e-3):
        start = np.array([[found.basin[side] + (2 * side - 1) * step], [0.0]])
        run = run_events(chain, start, 80.0, tolerance=1e-8, longest_step=1.0)
        sticks.append(run.log.size > 0)
    assert sticks == [False, True]


@pytest.mark.parametrize("name", CELLS)
def test_the_stick_slip_cycle_of_a_law_is_what_a_run_of_scipy_settles_to(name: str) -> None:
    cell = CELLS[name]
    found = friction_cell(cell).stable_cycle
    chain = FrictionChain.of(cell, c=0.0, sites=1)
    start = np.array([[cell.release - 1e-3], [cell.v_d - 1e-6]])  # it sticks at once
    run = run_events(chain, start, 30.0, tolerance=1e-11, longest_step=0.2)
    begins, ends = (run.log[run.log[:, 2] == kind, 0] for kind in (0, 1))
    assert begins[-1] - begins[-2] == pytest.approx(found.period, abs=1e-8)
    assert ends[-1] - begins[begins < ends[-1]][-1] == pytest.approx(found.stick_time, abs=1e-8)


def test_stick_slip_of_a_law_that_does_not_fall_at_small_velocities_begins_at_one() -> None:
    cell = FrictionCell(law="stribeck")
    first, end = cycle_velocities(cell, tolerance=1e-12)
    for v_d, sticks in ((0.99 * first, False), (1.01 * first, True), (0.99 * end, True),
                        (1.01 * end, False)):  # fmt: skip
        chain = FrictionChain.of(replace(cell, v_d=v_d), c=0.0, sites=1)
        run = run_events(
            chain, np.array([[chain.cell.release - 1e-4 * v_d], [v_d * (1.0 - 1e-9)]]), 12.0,
            tolerance=1e-11, longest_step=0.2,
        )  # fmt: skip
        assert (run.log.size > 0) is sticks


@pytest.mark.parametrize(("v_s", "xi"), [(0.5, 1e-3), (2.0, 1e-5), (0.05, 1e-6), (0.05, 1e-7)])
def test_stick_slip_of_little_damping_begins_and_ends_where_work_is_balanced(
    v_s: float, xi: float
) -> None:
    """Slow slip is harmonic: 2ξ + ⟨μ'⟩ = 0. Fast slip gains while w is v_d, at a speed v_d t²/2.

    With μ' = -2Δv/v_s² (1 - v²/v_s²) and a mean over v = v_d - w = v_d(1 - sin τ), weighted with
    cos², slip first touches at v_H(1 + ¾x²), x = v_H/v_s and v_H(1 - x²) = ξv_s²/Δ. Fast slip gains
    Δ v_d ∫exp(-(v_d t²/2v_s)²)dt, from which 2ξ takes 2πξv_d².
    """
    found = friction_cell(FrictionCell(law="stribeck", v_s=v_s, xi=xi, v_d=0.3 * v_s))
    drop = 0.5
    x = xi * v_s / drop
    hopf = xi * v_s**2 / drop * (1.0 + x**2)
    begin = hopf * (1.0 + 0.75 * x**2)
    end = (drop * math.sqrt(2.0 * v_s) * math.gamma(1.25) / (math.pi * xi)) ** (2.0 / 3.0)
    assert abs(found.cycle_begin_velocity - begin) <= found.cycle_end_error + 3.0 * x**4 * begin
    assert found.cycle_begin_velocity == pytest.approx(begin, rel=1e-7)
    assert found.cycle_end_velocity == pytest.approx(end, rel=5e-3)


def test_stick_slip_of_a_narrow_fall_of_friction_begins_above_the_hopf_velocity() -> None:
    """By ¾(v_H/v_s)² of it, as above; here that is 6.8e-8, of which round-off leaves 1e-9."""
    v_s, xi, drop = 0.05, 0.003, 0.5
    begin, _ = cycle_velocities(FrictionCell(law="stribeck", v_s=v_s, xi=xi), tolerance=1e-12)
    x = xi * v_s / drop
    hopf = xi * v_s**2 / drop * (1.0 + x**2)
    assert begin / hopf - 1.0 == pytest.approx(0.75 * x**2, rel=0.05)


@pytest.mark.parametrize(("xi", "drop"), [(0.05, 0.5), (0.05, 1e-5), (0.9, 0.5), (0.95, 1e-2)])
def test_the_end_of_cycles_under_coulomb_friction_is_that_of_the_linear_equation(
    xi: float, drop: float
) -> None:
    """From release, u = Δ - 2ζv_d, slip returns with ẏ = v_d where ẅ + 2ζẇ + w = 0 has w = v_d."""
    cell = FrictionCell(law="coulomb", mu_d=0.5, mu_st=0.5 + drop, xi=xi)
    omega = math.sqrt(1.0 - xi**2)

    def excess(v_d: float) -> float:
        t = np.linspace(1.0, 8.0, 200_001) / omega
        slope = -drop  # ẇ at release: the force falls by Δ
        w = np.exp(-xi * t) * (
            v_d * np.cos(omega * t) + (slope + xi * v_d) / omega * np.sin(omega * t)
        )
        return float(w.max() - v_d)

    expected = brentq(excess, 1e-7 * drop, 2.0 * drop, xtol=1e-14 * drop)
    # Rounding of the force, 1e-16, is seen beside a small drop.
    end = cycle_velocities(cell, tolerance=1e-12)[1]
    assert end == pytest.approx(expected, rel=1e-7)
    assert friction_cell(replace(cell, v_d=0.9 * end)).status is CellStatus.BISTABLE


@pytest.mark.parametrize("xi", [0.9, 0.05, 1e-3, 1e-4, 1e-6, 1e-8])
def test_the_error_of_the_end_of_cycles_under_coulomb_friction_holds_to_round_off(
    xi: float,
) -> None:
    """In precise arithmetic; runs at two tolerances agree to the last bit, or differ by chance."""
    found = friction_cell(FrictionCell(law="coulomb", xi=xi))
    with mp.workdps(40):
        damping, drop = mp.mpf(xi), mp.mpf(0.5)
        omega = mp.sqrt(1 - damping**2)

        def excess(v_d: mp.mpf) -> mp.mpf:
            at = (damping * v_d - drop) / omega  # w = e^(-ζt)(v_d cos ωt + at sin ωt), ẇ(0) = -Δ
            turn = mp.atan2(omega * at - damping * v_d, omega * v_d + damping * at)
            t = (turn + (2 * mp.pi if turn < 0 else 0)) / omega
            return mp.exp(-damping * t) * (v_d * mp.cos(omega * t) + at * mp.sin(omega * t)) - v_d

        exact = mp.findroot(excess, mp.mpf(found.cycle_end_velocity))
        off = abs(exact - mp.mpf(found.cycle_end_velocity))
    assert off <= found.cycle_end_error < 1e-12 / xi**2
    lost = friction_cell(FrictionCell(law="coulomb", xi=1e-17))  # finds 3.5e6 for 4.5e7
    assert lost.cycle_end_error == lost.error == math.inf


@pytest.mark.parametrize(
    ("mu_st", "mu_d", "v0", "exact"),
    [
        (3.8, 2.6, 18.0, "1.92214020081271994911"),
        (2.0, 1.5, 8.0, "0.3282595577170017977405"),
    ],
)
def test_the_error_of_the_end_of_cycles_holds_to_round_off_where_friction_falls_slowly(
    mu_st: float, mu_d: float, v0: float, exact: str
) -> None:
    """Runs at two tolerances agree to the last bit; the ends are from mpmath, by Taylor series."""
    found = friction_cell(FrictionCell(mu_st=mu_st, mu_d=mu_d, v0=v0, xi=0.03), tolerance=1e-14)
    off = abs(mp.mpf(exact) - mp.mpf(found.cycle_end_velocity))
    assert off <= found.cycle_end_error < 1e-11


def test_a_curve_of_cells_under_coulomb_friction_is_that_of_its_points() -> None:
    """Sliding is stable at every velocity, so that 0 takes the place of the Hopf velocity."""
    cell = FrictionCell(law="coulomb")
    diagram = cell_diagram(cell, [0.3, 0.5, 0.6])
    found = diagram.to_dict()
    points = [friction_cell(replace(cell, v_d=v_d)) for v_d in (0.3, 0.5, 0.6)]
    assert found["hopf_velocity"] == points[0].hopf_velocity == 0.0
    assert found["cycle_end_velocity"] == pytest.approx(points[0].cycle_end_velocity, rel=1e-9)
    cycles = [point.stable_cycle for point in points]
    assert found["stable_max"] == [
        None if each is None else pytest.approx(each.max, rel=1e-9) for each in cycles
    ]
    labels = [line.get_label() for line in diagram.plot().lines]
    assert "steady sliding, stable" in labels
    assert "steady sliding, unstable" not in labels


def test_cells_whose_cycles_have_no_meaning_say_so() -> None:
    with pytest.raises(ParameterError, match="without damping every slip near steady sliding"):
        friction_cell(FrictionCell(law="coulomb", xi=0.0))
    with pytest.raises(ParameterError, match="no cycle that slips all the time is stable"):
        friction_cell(FrictionCell(law="stribeck", xi=0.35, v_d=0.4))


def test_a_diagram_is_refused_where_another_cycle_is_stable() -> None:
    with pytest.raises(ParameterError, match="no cycle that slips all the time is stable"):
        cell_diagram(FrictionCell(law="stribeck", xi=0.35), [0.4], 1e-6)


def test_a_diagram_says_where_sliding_is_stable_on_both_sides_of_the_fall_of_friction() -> None:
    """2ξ + μ' = 0.1 - 2x e^{-x²}, x = v_d/v_s, is negative from x = 0.05 to x = 1.9."""
    diagram = cell_diagram(FrictionCell(law="stribeck", v_s=0.5), [0.02, 0.3, 0.9, 1.0], 1e-8)
    speeds = np.array([0.02, 0.3, 0.9, 1.0])
    slope = -2.0 * 0.5 * speeds / 0.5**2 * np.exp(-((speeds / 0.5) ** 2))
    assert diagram.sliding_stable.tolist() == (0.1 + slope > 0.0).tolist()
    assert diagram.sliding_stable.tolist() == [True, False, False, True]


def test_a_stable_cycle_that_passes_close_to_the_point_of_release_is_seen() -> None:
    """Just above the end of the stick-slip cycle, by scipy: slip for ever, with a largest y."""
    cell = FrictionCell(law="stribeck", viscous=0.3, v_d=0.6855)

    def slip(_: float, state: np.ndarray) -> list[float]:
        y, w = state
        away = cell.v_d - w
        friction = 0.5 + 0.5 * math.exp(-((away / 0.5) ** 2)) + 0.3 * away
        return [w, -y - 0.1 * w + friction]

    start = [cell.steady_sliding + 0.3, 0.0]
    run = solve_ivp(slip, (0.0, 300.0), start, rtol=1e-9, atol=1e-12, dense_output=True)
    y, w = run.sol(np.linspace(280.0, 300.0, 2001))
    assert w.max() < cell.v_d
    assert y.max() - cell.steady_sliding > 0.8
    with pytest.raises(ParameterError, match="no cycle that slips all the time is stable"):
        friction_cell(cell)
    with pytest.raises(ParameterError, match="no cycle that slips all the time is stable"):
        cell_diagram(cell, [0.6855], 1e-10)
    # What the refusal advises finds it.
    one = FrictionChain.of(cell, c=0.0, sites=1)
    found = simulate(one, excite(one, [1]), 300.0, samples=3001)
    assert found.states[-200:, 0, 0].max() == pytest.approx(y.max(), rel=1e-3)
    assert found.event_count == 0


def test_without_a_stick_slip_cycle_at_any_velocity_both_its_ends_are_zero() -> None:
    """With enough damping no slip returns to the belt; without any it does at all velocities."""
    for law in ("stribeck", "exponential"):
        assert cycle_velocities(FrictionCell(law=law, xi=3.0), 1e-8) == (0.0, 0.0)
        assert cycle_velocities(FrictionCell(law=law, xi=0.0), 1e-8)[1] == math.inf
    for xi, end in ((3.0, 0.0), (0.0, math.inf)):
        found = friction_cell(FrictionCell(xi=xi), 1e-8)
        assert (found.cycle_end_velocity, found.cycle_end_error) == (end, 0.0)


@pytest.mark.parametrize("size", [1e-2, 1e2])
def test_velocities_of_stick_slip_scale_with_forces_and_velocities_of_the_law(size: float) -> None:
    plain = cycle_velocities(FrictionCell(law="stribeck"), 1e-10)
    scaled = FrictionCell(law="stribeck", v_s=0.5 * size, mu_st=size, mu_d=0.5 * size)
    found = np.array(cycle_velocities(scaled, 1e-10)) / size
    assert found == pytest.approx(plain, rel=1e-6)


def test_a_chain_holds_its_law_as_a_word() -> None:
    chain = FrictionChain(c=0.1, law="stribeck", v_s=0.3)
    assert chain.law is FrictionLaw.STRIBECK
    assert chain.parameters()["law"] == "stribeck"
    assert FrictionChain.of(chain.cell, c=0.1) == chain


def test_numbers_of_a_run_are_those_of_its_law_and_no_other() -> None:
    """v_0 of the exponential, v_s of Stribeck's; where a law has none it is as if infinite."""
    coulomb, exponential = FrictionCell(law="coulomb"), FrictionCell(v0=0.4)
    stribeck = FrictionCell(law="stribeck", v_s=0.3)
    assert [friction_series.law_of(cell) for cell in (coulomb, exponential, stribeck)] == [
        (), (), (0.3,),
    ]  # fmt: skip
    assert [
        friction_series.new_numbers(cell, 0.1, 1e-9)[friction_series.V0]
        for cell in (coulomb, exponential, stribeck)
    ] == [math.inf, 0.4, math.inf]
    # Viscous friction and the damping of the cell act alike.
    viscous = friction_series.new_numbers(FrictionCell(xi=0.05, viscous=0.3), 0.1, 1e-9)
    assert viscous[friction_series.DRAG] == pytest.approx(0.4)


@pytest.mark.parametrize("order", [4, 25])
def test_an_interval_is_halved_as_often_as_there_is_room_for(order: int) -> None:
    """The work of a search goes from row 0 to row `_DEPTH` after the binomials."""
    work = friction_series.new_work(order)
    rows = work.shape[0] - (friction_series.BINOMIALS + order + 1)
    assert rows > friction_series._DEPTH
    assert work[friction_series.BINOMIALS + order].sum() == 2.0**order


def test_slip_that_reaches_the_belt_is_not_continued_beyond(monkeypatch):
    # Strong drag: continued smoothly, it crept for thousands of steps, at each of sixty heights.
    cell = FrictionCell(law="stribeck", v_s=2.2e-4, v_d=3.5e-4, xi=40.0, mu_d=0.1, viscous=1.5e-3)
    phase = friction_cycles._phase

    def begun_below_the_belt(cell, y, w, *rest, **options):
        assert w <= 0.0
        return phase(cell, y, w, *rest, **options)

    monkeypatch.setattr(friction_cycles, "_phase", begun_below_the_belt)
    friction_cycles.check_slip_cycles(cell, 1e-12)


@pytest.mark.parametrize(
    ("cell", "falls"),
    [
        (FrictionCell(law="stribeck", v_s=0.0075, v_d=0.0195, xi=0.12, mu_d=0.28), False),
        (FrictionCell(law="stribeck", v_s=0.004, v_d=0.021, xi=0.003, mu_d=0.85), True),
    ],
)
def test_a_cell_whose_slip_reaches_the_belt_has_no_cycle_without_stick(cell, falls):
    """Its slip, continued beyond the belt, turns at a smaller y: such cells were refused."""
    found = friction_cell(cell)
    sliding, top = found.steady_sliding, found.stable_cycle.max

    def rate(_, state):
        y, w = state
        rel = cell.v_d - w
        mu = cell.mu_d + (1.0 - cell.mu_d) * math.exp(-((rel / cell.v_s) ** 2))
        return [w, mu - y - 2.0 * cell.xi * w]

    def touch(_, state):
        return state[1] - cell.v_d

    def highest(t, state):
        return state[1] if t > 1e-3 else -1.0

    touch.terminal = highest.terminal = True
    touch.direction, highest.direction = 1.0, -1.0

    def lasting(y):  # whether slip from the maximum y turns at a smaller one, short of the belt
        ends = [touch, highest]
        run = solve_ivp(rate, (0.0, 50.0), [y, 0.0], rtol=1e-9, atol=1e-13, events=ends)
        assert run.status == 1
        return run.t_events[0].size == 0 and run.y[0, -1] < y

    turned = [lasting(y) for y in sliding + np.geomspace(2e-3, 0.99, 25) * (top - sliding)]
    assert turned == sorted(turned, reverse=True)  # at most one cycle without stick
    assert any(turned) == falls == (found.status is CellStatus.BISTABLE)
