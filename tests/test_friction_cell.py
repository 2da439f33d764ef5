"""Claims about one friction oscillator: closed forms, both cycles, the basin, where cycles end."""

from __future__ import annotations

import inspect
import json
import math
import re
import shlex
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from time import process_time
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from fronts.cli import main
from fronts.curves import Curve
from fronts.wording import in_words, table_lines
from theory.cells.friction import FrictionCell, friction_coefficient, friction_force, friction_slope
from theory.chains.friction import FrictionChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from theory.result import Result
from verification.cells import diagram, friction, friction_cycles
from verification.cells.cell import cell
from verification.cells.diagram import bifurcation, cell_diagram
from verification.cells.friction import (
    _with_error,
    cycle_end_velocity,
    cycle_velocities,
    friction_cell,
    stick_slip_cycle,
    unstable_cycle,
)
from verification.cells.friction_cycles import grazing_slip, unstable_once
from verification.cells.result import Cell, CellStatus, OwnCell
from verification.cells.vdp import vdp_cell
from verification.references.equations import variational_rate
from verification.references.friction_events import run_events
from verification.steppers import friction_cell_phase as phases
from verification.steppers.friction_series import law_of, new_numbers, new_work, taylor_order

CELL = FrictionCell()
DIGITS = 20


def precise_phases(
    cell: FrictionCell, y: float, v: float, speeds: tuple[float, ...]
) -> list[tuple[mp.mpf, mp.mpf]]:
    """Slip backwards from (y, v); τ and y where ẏ rises through ``speeds``, in many digits."""
    with mp.workdps(DIGITS):
        mu_st, mu_d, v0, xi, v_d = (
            mp.mpf(x) for x in (cell.mu_st, cell.mu_d, cell.v0, cell.xi, cell.v_d)
        )

        def rate(_: mp.mpf, z: list[mp.mpf]) -> list[mp.mpf]:
            mu = mu_d + (mu_st - mu_d) * mp.exp((z[1] - v_d) / v0)
            return [z[1], mu - 2 * xi * z[1] - z[0]]

        path = mp.odefun(rate, 0, [mp.mpf(y), mp.mpf(v)], tol=mp.mpf(10) ** (3 - DIGITS))
        times = [mp.mpf(k) / 10 for k in range(20, 70)]
        step, found = mp.mpf("0.1"), []
        for speed in speeds:
            low = next(t for t in times if path(t)[1] < speed <= path(t + step)[1])
            t = mp.findroot(
                lambda s, speed=speed: path(s)[1] - speed, (low, low + step), solver="anderson"
            )
            found.append((t, path(t)[0]))
        return found


def slip(cell: FrictionCell, y: float) -> Any:
    """Return the motion from rest at y, by scipy, backward slip continued smoothly."""

    def rate(_: float, z: np.ndarray) -> list[float]:
        mu = cell.mu_d + (cell.mu_st - cell.mu_d) * math.exp((z[1] - cell.v_d) / cell.v0)
        return [z[1], mu - 2 * cell.xi * z[1] - z[0]]

    return solve_ivp(rate, (0, 8), [y, 0], "DOP853", rtol=1e-13, atol=1e-15, dense_output=True).sol


def peak(cell: FrictionCell, y: float) -> tuple[float, float]:
    """When and how high is the next maximum of y."""
    motion = slip(cell, y)
    t = brentq(lambda s: motion(s)[1], 5.0, 7.5, xtol=1e-14)
    return float(t), float(motion(t)[0])


def test_the_closed_forms_are_those_of_the_force() -> None:
    """Steady sliding balances the force; damping and Hopf velocity follow by differences."""
    for v_d in (0.2, 1.1513, 1.25, 3.0):
        cell = replace(CELL, v_d=v_d)
        assert cell.steady_sliding == friction_force(cell, -v_d)
        step = 1e-6
        slope = (friction_force(cell, step - v_d) - friction_force(cell, -step - v_d)) / (2 * step)
        # Differences are good to step² and 1e-16/step.
        assert cell.effective_damping == pytest.approx(2 * cell.xi - slope, abs=1e-9)
    at_hopf = replace(CELL, v_d=CELL.hopf_velocity)
    assert abs(at_hopf.effective_damping) < 1e-15
    assert friction_coefficient(CELL, 0.0) == CELL.mu_st
    assert friction_coefficient(CELL, 1e3) == CELL.mu_d


def test_a_phase_ends_in_one_of_five_ways() -> None:
    """Compiled code knows them by their numbers."""
    ends = {phases.HIGHEST, phases.LOWEST, phases.TOUCH, phases.FASTEST, phases.SLOWEST}
    assert len(ends) == 5


def test_the_stick_slip_cycle_is_that_of_many_digits() -> None:
    cycle = stick_slip_cycle(CELL)
    (slip, touch), (_, low) = precise_phases(CELL, CELL.release, CELL.v_d, (CELL.v_d, 0.0))
    stick = (CELL.release - touch) / CELL.v_d
    assert cycle.error < 1e-9
    assert cycle.multiplier == 0.0  # stick forgets every deviation
    assert abs(cycle.slip_time - slip) <= cycle.error
    assert abs(cycle.stick_time - stick) <= cycle.error
    assert abs(cycle.period - slip - stick) <= cycle.error
    assert abs(cycle.min - low) <= cycle.error
    run = run_events(
        FrictionChain.of(CELL, c=0.0, sites=1), np.array([[cycle.max], [0.0]]), cycle.period,
        tolerance=1e-13,
    )  # fmt: skip
    # Started at the largest y, the run is back there after a period, at rest; DOP853 to 1e-12.
    assert abs(run.y[-1, 0] - cycle.max) < 1e-11
    assert abs(run.velocity[-1, 0]) < 1e-10


def test_the_stated_errors_bound_the_true_ones() -> None:
    """At every tolerance, against the finest; both cycles and the end."""
    exact = friction_cell(CELL, 1e-14)
    assert exact.stable_cycle is not None
    assert exact.unstable_cycle is not None
    for tolerance in (1e-6, 1e-8, 1e-10, 1e-12):
        rough = friction_cell(CELL, tolerance)
        for ours, true in (
            (rough.stable_cycle, exact.stable_cycle),
            (rough.unstable_cycle, exact.unstable_cycle),
        ):
            assert ours is not None
            for name in ("max", "min", "period", "stick_time"):
                # The finest has round-off of its own, 1e-13 over a period.
                assert abs(getattr(ours, name) - getattr(true, name)) <= ours.error + 1e-13
        gap = abs(rough.cycle_end_velocity - exact.cycle_end_velocity)
        assert gap <= rough.cycle_end_error + 1e-13


def test_the_usual_tolerance_gives_both_cycles_to_ten_digits() -> None:
    for each in (stick_slip_cycle(CELL), unstable_cycle(CELL)):
        assert each.error < 1e-10
    end = cycle_end_velocity(CELL, 1e-14)
    assert cycle_end_velocity(CELL) == pytest.approx(end, rel=1e-11)
    assert cycle_velocities(CELL, tolerance=1e-12)[1] == pytest.approx(end, rel=1e-11)


def scaled(size: float) -> FrictionCell:
    """Return the cell in which y - μ_d, velocities and the fall of friction are so much larger.

    (5) at c = 0 is the same equation then: times and multipliers are those of the cell itself.
    """
    return replace(
        CELL, mu_st=CELL.mu_d + size * (CELL.mu_st - CELL.mu_d), v0=size * CELL.v0,
        v_d=size * CELL.v_d,
    )  # fmt: skip


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_cycles_scale_with_the_cell_within_their_errors(size: float) -> None:
    found, other = friction_cell(CELL), friction_cell(scaled(size))
    assert other.status is found.status
    for one, two in (
        (found.stable_cycle, other.stable_cycle),
        (found.unstable_cycle, other.unstable_cycle),
    ):
        room = one.error + two.error / min(size, 1.0)
        assert room < 1e-6
        for name in ("max", "min"):
            gap = (getattr(two, name) - CELL.mu_d) / size - (getattr(one, name) - CELL.mu_d)
            assert abs(gap) <= room
        for name in ("period", "stick_time", "slip_time"):
            assert abs(getattr(two, name) - getattr(one, name)) <= room
        assert two.speed == pytest.approx(size * one.speed, rel=1e-9)
        assert two.multiplier == pytest.approx(one.multiplier, rel=1e-6)  # of differences


def test_the_end_of_cycles_is_found_to_the_last_digits_of_a_slow_belt() -> None:
    size = 1e-6
    # Both are good to 1e-15 of a velocity of 2e-6, or to what their tolerance lets through.
    expected = pytest.approx(size * cycle_end_velocity(CELL, 1e-14), rel=1e-9)
    assert cycle_end_velocity(scaled(size), 1e-14) == expected


@pytest.mark.parametrize("part", [1e-2, 1e-5])
def test_where_sliding_is_unstable_at_slow_belts_alone_the_cell_sticks_and_slips_there(
    part: float,
) -> None:
    """With ξ just below Δ/2v₀ the Hopf velocity is slow, and the cycles end just beyond it."""
    cell = FrictionCell(xi=0.5 * (1.0 - part))
    hopf = cell.hopf_velocity
    found = friction_cell(replace(cell, v_d=0.5 * hopf))
    assert found.status is CellStatus.CYCLE
    assert 1.0 < found.cycle_end_velocity / hopf < 1.0 + part


def test_the_error_of_a_cycle_is_infinite_if_the_rougher_search_finds_none() -> None:
    cycle = stick_slip_cycle(CELL)
    found = _with_error(CELL, cycle, None)
    assert found.error == math.inf
    assert _with_error(CELL, None, cycle) is None


def test_round_off_of_a_cycle_counts_the_larger_of_its_turning_points() -> None:
    """On a slow belt: a mirrored cycle has the same error, one twice as far out twice as much."""
    cell = FrictionCell(v_d=1e-3)
    cycle = stick_slip_cycle(CELL)
    assert cycle is not None
    errors = []
    for low, high in ((-3.0, 0.1), (-0.1, 3.0), (-6.0, 0.1)):
        made = replace(cycle, min=low, max=high, error=0.0)
        found = _with_error(cell, made, made)
        errors.append(found.error)
    assert errors == pytest.approx([errors[0], errors[0], 2.0 * errors[0]], rel=1e-15, abs=0.0)
    assert errors[0] > 0.0


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_the_stated_error_of_where_cycles_end_covers_that_of_a_rough_search(
    tolerance: float,
) -> None:
    rough = friction_cell(CELL, tolerance)
    assert abs(rough.cycle_end_velocity - cycle_end_velocity(CELL)) <= rough.cycle_end_error


def test_steady_sliding_under_coulomb_friction_is_stable_at_every_velocity() -> None:
    cell = FrictionCell(law="coulomb", v_d=0.5)
    found = friction_cell(cell)
    assert found.hopf_velocity == 0.0
    assert found.unstable_cycle is None
    assert found.basin == grazing_slip(cell)


def test_slip_that_is_overdamped_under_coulomb_friction_never_returns_to_the_belt() -> None:
    cell = FrictionCell(law="coulomb", v_d=1e-3, xi=1.5)
    assert grazing_slip(cell) is None
    assert friction_cell(cell).basin == (-math.inf, math.inf)


def test_the_error_of_the_expanded_cycle_covers_the_next_order_in_its_amplitude() -> None:
    """For weak damping ∮(μ - 2ξẏ)ẏ dτ = 0 along a sine gives Δ e^{-v_d/v₀} I₁(A/v₀) = ξA."""
    xi, amplitude = 1e-4, mp.mpf("4.5e-4")
    with mp.workdps(30):
        x = amplitude / CELL.v0
        fall = mp.mpf(xi) * amplitude / (mp.mpf("0.5") * mp.besseli(1, x))
        v_d = float(-CELL.v0 * mp.log(fall))
    found = unstable_once(replace(CELL, xi=xi, v_d=v_d), 1e-13)
    gap = abs(found.amplitude - float(amplitude))
    assert 1e-13 < gap <= found.error < 1e-7
    # Without damping it turns in 2π; a deviation of a cycle of the root of δ grows by e^{2πδ}.
    assert abs(found.period - 2.0 * math.pi) <= found.error
    assert (found.slip_time, found.stick_time) == (found.period, 0.0)
    delta = 2.0 * xi - math.exp(-v_d / CELL.v0) * 0.5 / CELL.v0
    assert found.multiplier - 1.0 == pytest.approx(2.0 * math.pi * delta, rel=1e-3)


def test_the_error_of_an_expanded_cycle_covers_the_round_off_of_its_damping() -> None:
    """Just above the Hopf velocity the damping is the small difference of two larger terms."""
    cell = FrictionCell(
        mu_st=3.774482419228239, mu_d=1.8872412096141196, xi=0.001629646252820722,
        v0=0.3219455793254197, v_d=2.4128964702687106,
    )  # fmt: skip
    found = unstable_cycle(cell)
    with mp.workdps(30):
        v0 = mp.mpf(cell.v0)
        fall = (mp.mpf(cell.mu_st) - cell.mu_d) * mp.exp(-cell.v_d / v0) / v0
        true = float(mp.sqrt(8 * (2 * mp.mpf(cell.xi) - fall) * v0**2 / fall))
    assert 1e-11 < abs(found.amplitude - true) < found.error < 1e-3 * true


@pytest.mark.parametrize("law", ["exponential", "stribeck"])
@pytest.mark.parametrize("fall", [0.01, 20.0])
def test_the_damping_of_a_cell_is_known_to_the_rounding_that_is_stated(
    fall: float, law: str
) -> None:
    """It is a small difference, here a thousandth of 2ξ."""
    random = np.random.default_rng(5)
    bounds, errors = [], []
    for _ in range(200):
        mu_d, drop, scale = random.uniform(0.1, 1.0, size=3).tolist()
        v_d = fall * scale * random.uniform(0.5, 1.0)
        with mp.workdps(30):
            u = mp.mpf(v_d) / scale
            shape = mp.exp(-u) if law == "exponential" else 2 * u * mp.exp(-u * u)
            exact = (mp.mpf(mu_d + drop) - mu_d) / scale * shape
            slope = float(exact)
            cell = FrictionCell(
                law=law, mu_st=mu_d + drop, mu_d=mu_d, v_d=v_d, xi=0.5005 * slope,
                **{"v0" if law == "exponential" else "v_s": scale},
            )  # fmt: skip
            errors.append(float(abs(cell.effective_damping - (2 * mp.mpf(cell.xi) - exact))))
        bound = friction_cycles._rounding_near_hopf(cell, 1.0) * cell.effective_damping
        bounds.append(bound / slope)
        errors[-1] /= slope
    shares = np.array(errors) / bounds
    assert 0.1 < shares.max() <= 1.0


def test_where_the_damping_is_less_than_its_rounding_the_amplitude_errs_by_the_root_of_it() -> None:
    """Of √(δ + r) and √δ the difference is √r, however much smaller δ is."""
    hopf, errors, dampings = CELL.hopf_velocity, [], []
    for n in range(1, 4):
        cell = replace(CELL, v_d=hopf * (1.0 + n * np.finfo(float).eps))
        if cell.effective_damping > 0.0:
            amplitude = friction_cycles._amplitude_near_hopf(cell)
            errors.append(friction_cycles._rounding_near_hopf(cell, amplitude))
            dampings.append(cell.effective_damping)
    assert max(dampings) > 2.0 * min(dampings)
    assert errors == pytest.approx([errors[0]] * len(errors), rel=1e-9)


def test_the_error_of_an_unstable_cycle_covers_the_round_off_of_a_fast_belt() -> None:
    """From one maximum to the next, a deviation of the cycle grows by e^{2πδ}."""
    cell = FrictionCell(
        mu_st=2.191397532018483, mu_d=1.0956987660092414, xi=0.001643550733988909,
        v0=8.95950669321385, v_d=32.40141877153398,
    )  # fmt: skip
    found = unstable_once(cell, 1e-12)
    assert found is not None
    with mp.workdps(DIGITS):
        drop, v0 = mp.mpf(cell.mu_st) - mp.mpf(cell.mu_d), mp.mpf(cell.v0)

        def rate(_: mp.mpf, z: list[mp.mpf]) -> list[mp.mpf]:
            mu = cell.mu_d + drop * mp.exp((z[1] - cell.v_d) / v0)
            return [z[1], mu - 2 * mp.mpf(cell.xi) * z[1] - z[0]]

        path = mp.odefun(rate, 0, [mp.mpf(found.max), mp.mpf(0)], tol=mp.mpf(10) ** (3 - DIGITS))
        turn = mp.findroot(lambda t: path(t)[1], (found.period - 1e-3, found.period))
        excess = float(path(turn)[0] - mp.mpf(found.max))
    distance = abs(excess) / math.expm1(2.0 * math.pi * cell.effective_damping)
    assert distance <= found.error < 1e-6


@pytest.mark.parametrize("below", [1e-10, 1e-7, 1e-3])
def test_the_error_of_a_cycle_covers_the_round_off_of_a_touch_that_nearly_grazes(
    below: float,
) -> None:
    """Under Coulomb's law slip is linear, and runs at both tolerances take the same steps."""
    cell = FrictionCell(law="coulomb", mu_st=2.2, mu_d=1.8, xi=0.0648, viscous=1e-3)
    cell = replace(cell, v_d=cycle_end_velocity(cell) * (1.0 - below))
    found = stick_slip_cycle(cell)
    assert found is not None
    with mp.workdps(30):
        mu_st, mu_d, xi, kappa, v_d = map(
            mp.mpf, (cell.mu_st, cell.mu_d, cell.xi, cell.viscous, cell.v_d)
        )
        zeta = xi + kappa / 2
        omega = mp.sqrt(1 - zeta**2)

        def speed(t: mp.mpf) -> mp.mpf:  # from ẏ = v_d and ÿ = μ_d - μ_st on
            sine = (mu_d - mu_st + zeta * v_d) / omega
            return mp.exp(-zeta * t) * (v_d * mp.cos(omega * t) + sine * mp.sin(omega * t))

        def slope(t: mp.mpf) -> mp.mpf:
            return mp.diff(speed, t)

        highest = mp.findroot(slope, found.slip_time)
        touch = mp.findroot(lambda t: speed(t) - v_d, (4, highest), solver="anderson")
        assert abs(speed(touch) - v_d) < 1e-25
        y = mu_d + kappa * v_d - slope(touch) - 2 * zeta * v_d
        times = float(touch), float((mu_st - 2 * xi * v_d - y) / v_d)
    for stated, true in zip((found.slip_time, found.stick_time), times, strict=True):
        assert abs(stated - true) <= found.error < 1e-6


@pytest.mark.parametrize("v_d", [0.5, 1.25])
def test_slip_that_begins_at_rest_has_the_maximum_that_scipy_finds(v_d: float) -> None:
    cell = replace(CELL, v_d=v_d)
    for y in (cell.steady_sliding + 0.02, cell.steady_sliding + 0.1):
        found = friction_cycles._slip_from(cell, y, phases.HIGHEST, 1e-13)
        assert found == pytest.approx((*peak(cell, y), -v_d), abs=1e-11)


@pytest.mark.parametrize("excess", [0.03, 0.3, 3.0])
def test_a_short_slip_forwards_is_an_arc_of_an_oscillation(excess: float) -> None:
    """Under Coulomb friction, begun at the belt: it ends where it is as far on the other side."""
    cell = FrictionCell(law="coulomb", xi=0.0)
    y, v_d = -cell.mu_d - excess, cell.v_d
    touch, fastest = (
        friction_cycles._phase(cell, y, 0.0, False, end, tolerance=1e-13, direction=1.0)
        for end in (phases.TOUCH, phases.SLOWEST)
    )
    angle = math.atan2(excess, v_d)
    assert touch == pytest.approx((2.0 * angle, excess - cell.mu_d, 0.0), abs=1e-11)
    assert fastest == pytest.approx((angle, -cell.mu_d, math.hypot(excess, v_d) - v_d), abs=1e-11)
    touch, fastest = (
        friction_cycles._phase(cell, y, 0.0, False, end, tolerance=1e-4, direction=1.0)
        for end in (phases.TOUCH, phases.SLOWEST)
    )
    # They end, to rounding, where their series has the velocity of the belt or no acceleration;
    # this is the series of μ_d + y but for its last term, after steps of one half.
    order = taylor_order(1e-4 * v_d)
    last = math.hypot(excess, v_d) * (angle % 0.5) ** order / math.factorial(order)
    assert abs(touch[2]) < 1e-14
    assert abs(fastest[1] + cell.mu_d) < 1.01 * last + 1e-14


def first_steps(
    cell: FrictionCell, state: tuple[float, float], longest: float, tolerance: float
) -> tuple[float, float]:
    """Return y and ẏ of slip when it is given up, since no end is met in the longest time."""
    phase = phases.Phase(
        numbers=new_numbers(cell, 0.0, tolerance), law=law_of(cell),
        work=new_work(taylor_order(tolerance)), released=False, end=phases.HIGHEST,
        longest=longest, creep=friction_cycles._NO_CREEP,
    )  # fmt: skip
    t, y, w = phases.follow(phase, state[0], state[1] - cell.v_d)
    assert t == phases.ABANDONED
    return y, w + cell.v_d


@pytest.mark.parametrize("tolerance", [1e-6, 2e-8, 1e-12])
@pytest.mark.parametrize("angle", [3.3, 4.7, 5.1])
def test_a_step_of_slip_is_as_long_as_the_last_terms_of_its_series_allow(
    tolerance: float, angle: float
) -> None:
    """Those of a circle of y - μ_d and ẏ; a small one is followed by steps of one half.

    It is given up at the longest time, or at the end of the step in which this lies.
    """
    cell, order = FrictionCell(law="coulomb", xi=0.0), taylor_order(tolerance)
    for amplitude, longest, steps in ((1e8, 1e-9, 1), (0.1, 1e-9, 1), (0.1, 1.0, 2)):
        y = cell.mu_d + amplitude * math.cos(angle)
        state = y, -amplitude * math.sin(angle)
        y, velocity = first_steps(cell, state, longest, tolerance)
        turned = (math.atan2(-velocity, y - cell.mu_d) - angle) % (2.0 * math.pi)
        size = amplitude * (abs(math.cos(angle)) + abs(math.sin(angle)))
        terms = [(tolerance * math.factorial(k) / size) ** (1.0 / k) for k in (order - 1, order)]
        assert turned == pytest.approx(steps * min(*terms, 0.5), rel=1e-6)


@pytest.mark.parametrize("law", ["exponential", "stribeck"])
def test_steep_friction_is_seen_as_slip_returns_to_the_belt_within_a_step(law: str) -> None:
    """It is e^{-40} or less at first, and has no share in the series from there."""
    cell = FrictionCell(law=law, v_d=0.5, **{"v0" if law == "exponential" else "v_s": 0.01})
    y, w = -1.0, -0.4

    def rate(_: float, z: np.ndarray) -> list[float]:
        friction = friction_coefficient(cell, min(z[1], 0.0))
        return [z[1] + cell.v_d, friction - 2.0 * cell.xi * (z[1] + cell.v_d) - z[0]]

    def belt(_: float, z: np.ndarray) -> float:
        return float(z[1])

    belt.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(rate, (0.0, 1.0), [y, w], rtol=1e-9, atol=1e-11, max_step=0.01, events=belt)
    t, y, w = friction_cycles._phase(cell, y, w, False, phases.TOUCH, tolerance=1e-8)
    assert (t, y) == pytest.approx((run.t_events[0][0], run.y_events[0][0, 0]), abs=1e-6)
    assert t < 0.5


def test_steps_towards_stick_are_halved_until_they_resolve_the_growth_of_friction() -> None:
    """So far from stick that friction is still constant: its bound is that of ``resolved``."""
    cell, tolerance = FrictionCell(v0=0.01, xi=0.0), 1e-6
    order, lengths = taylor_order(tolerance), []
    for n in range(60):
        start, pull = (70.0 + n) * cell.v0, 1.0
        angle = math.atan2(cell.v_d - start, pull) + math.pi
        amplitude = math.hypot(pull, cell.v_d - start)
        state = cell.mu_d + amplitude * math.cos(angle), -amplitude * math.sin(angle)
        y, velocity = first_steps(cell, state, 1e-9, tolerance)
        h = (math.atan2(-velocity, y - cell.mu_d) - angle) % (2.0 * math.pi)
        left_out = []
        for length in (h, 2.0 * h):
            times = np.linspace(0.0, length, 1001)
            w = -amplitude * np.sin(angle + times) - cell.v_d
            u = -w.max() / cell.v0
            x = start / cell.v0 - u
            left_out.append(math.exp(-max(u, 0.0)) * x**order / math.factorial(order))
        assert math.log2(0.5 / h) == pytest.approx(round(math.log2(0.5 / h)), abs=1e-6)
        assert left_out[0] <= tolerance
        # The bound takes the way between two samples to be somewhat longer than it is.
        assert h > 0.49 or left_out[1] > 0.5 * tolerance
        lengths.append(round(math.log2(0.5 / h)))
    assert len(set(lengths)) > 1


def test_a_turning_point_where_one_step_ends_and_the_next_begins_is_found() -> None:
    """At seven steps of one half, to rounding, whichever of both computes a change of sign."""
    cell, angle = FrictionCell(law="coulomb", xi=0.0), math.pi - 3.5
    for amplitude in np.linspace(0.1, 0.3, 397).tolist():
        y, velocity = cell.mu_d + amplitude * math.cos(angle), -amplitude * math.sin(angle)
        found = friction_cycles._phase(
            cell, y, velocity - cell.v_d, False, phases.LOWEST, tolerance=1e-14
        )
        assert found == pytest.approx((3.5, cell.mu_d - amplitude, -cell.v_d), abs=1e-12)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_slip_is_not_fastest_where_its_acceleration_is_negative_throughout(
    tolerance: float,
) -> None:
    """It rises and falls again below zero within the first step, where friction bends."""
    cell = FrictionCell(law="stribeck", v_s=0.1, xi=1.8)
    w, acceleration = -0.01, -2.0

    def rate(_: float, z: np.ndarray) -> list[float]:
        drag = 2.0 * cell.xi * (z[1] + cell.v_d)
        return [z[1] + cell.v_d, friction_coefficient(cell, -z[1]) - drag - z[0]]

    y = rate(0.0, np.array([0.0, w]))[1] - acceleration
    times = np.linspace(0.0, 8.0, 401)
    run = solve_ivp(rate, (0.0, 8.0), [y, w], "LSODA", times, rtol=1e-8, atol=1e-10)
    slopes = np.array([rate(0.0, z)[1] for z in run.y.T])
    assert acceleration < slopes[1] < 0.0
    assert slopes[2] < acceleration
    assert slopes.max() < 0.0
    t, _, _ = friction_cycles._phase(cell, y, w, False, phases.FASTEST, tolerance=tolerance)
    assert t == phases.FAILED


def test_an_expanded_cycle_of_a_bent_curve_returns_in_scipy_within_its_error() -> None:
    """Of μ so steep and wide that only its curvature F counts, ü + u = Fu̇²/2: to second order."""
    bend, amplitude, v0 = 0.1, 0.1, 1e3
    cell = FrictionCell(v_d=1.0, v0=v0, mu_d=1.0, mu_st=1.0 + bend * v0**2 * math.exp(1.0 / v0))
    found = friction_cycles._expanded(cell, amplitude)

    def rate(_: float, z: np.ndarray) -> list[float]:
        return [z[1], 0.5 * bend * z[1] ** 2 - z[0]]

    top = found.max - cell.steady_sliding
    run = solve_ivp(rate, (0, 7), [top, 0], "DOP853", rtol=1e-12, atol=1e-14, dense_output=True)
    half, turn = (brentq(lambda s: run.sol(s)[1], *ends) for ends in ((2.0, 4.0), (5.0, 7.0)))
    low = cell.steady_sliding + run.sol(half)[0]
    assert 1e-6 < abs(turn - found.period) <= found.error
    assert abs(low - found.min) <= found.error < 2e-4


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_the_error_of_an_expanded_cycle_where_friction_has_no_curvature_is_a_length(
    size: float,
) -> None:
    """There only the cubic term is left out, which scales as all lengths do."""

    def left_out(size: float) -> float:
        v_s = 0.5 * size
        cell = FrictionCell(
            law="stribeck", v_s=v_s, v_d=v_s / math.sqrt(2.0), mu_st=size, mu_d=0.5 * size
        )
        assert abs(cell.curve.curvature(cell.v_d)) < 1e-14 / size
        return friction_cycles._expanded(cell, 0.1 * size).error

    assert left_out(size) == pytest.approx(size * left_out(1.0), rel=1e-6)
    # Of u̇⁵ there is A³/8v_s² in the amplitude: by averaging A²/48 times H₅/H₃ = -6 at x = 1/√2.
    assert left_out(size) > (0.1 * size) ** 3 / (8.0 * (0.5 * size) ** 2)


def test_the_unstable_cycle_returns_in_scipy_and_repels() -> None:
    cycle = unstable_cycle(CELL)
    period, highest = peak(CELL, cycle.max)
    assert abs(highest - cycle.max) < 1e-10
    assert abs(period - cycle.period) < 1e-9
    assert cycle.slip_time == cycle.period
    y, velocity = slip(CELL, cycle.max)(np.linspace(0.0, period, 20_001))
    assert (y.min(), velocity.max()) == pytest.approx((cycle.min, cycle.speed), abs=1e-6)
    step = 1e-4
    growth = (peak(CELL, cycle.max + step)[1] - peak(CELL, cycle.max - step)[1]) / (2 * step)
    # Differences with a step of 1e-4 are good to 1e-7.
    assert growth == pytest.approx(cycle.multiplier, abs=1e-6)
    assert growth > 1.0


@pytest.mark.parametrize(
    ("given", "tolerance", "most"),
    [
        (CELL, 1e-12, 1e-8), (CELL, 1e-8, 1e-8), (replace(CELL, v_d=1.7), 1e-12, 1e-7),
        (replace(CELL, v_d=1.83), 1e-12, 1e-4),  # the curvature of the map, seen beside rounding
        (FrictionCell(v_d=CELL.hopf_velocity + 1e-6), 1e-12, 1e-5),  # rounding beside the step
        (FrictionCell(v_d=CELL.hopf_velocity + 1e-8), 1e-12, 1e-13),  # expanded
        (FrictionCell(law="stribeck", v_d=1.0), 1e-10, 1e-8),
        (  # y is far smaller than v_d, from which the slip velocity has its round-off
            FrictionCell(
                law="stribeck", v_s=0.19290111547147332, v_d=0.5535966696273482, mu_d=0.0,
                xi=0.003941554227052617,
            ),
            1e-12, 1e-5,
        ),
    ],
)  # fmt: skip
def test_the_error_of_a_multiplier_covers_that_of_its_integral_by_scipy(
    given: FrictionCell, tolerance: float, most: float
) -> None:
    """Of a plane flow it is exp∮(∂ẏ̇/∂ẏ)dτ; of a cycle of stick it is 0 to the last digit."""
    found = friction_cell(given, tolerance)
    assert (found.stable_cycle.multiplier, found.stable_cycle.multiplier_error) == (0.0, 0.0)
    cycle = found.unstable_cycle
    assert cycle.multiplier is not None
    assert cycle.multiplier_error is not None

    def rate(_: float, z: np.ndarray) -> list[float]:
        slip = given.v_d - z[1]
        force = friction_coefficient(given, slip) - 2 * given.xi * z[1] - z[0]
        return [z[1], force, -2 * given.xi - friction_slope(given, slip)]

    run = solve_ivp(rate, (0, cycle.period), [cycle.max, 0, 0], "DOP853", rtol=1e-13, atol=1e-15)
    true = math.exp(run.y[2, -1])
    assert abs(true - cycle.multiplier) <= cycle.multiplier_error
    assert cycle.multiplier_error < 1e3 * abs(true - cycle.multiplier) + most
    assert abs(run.y[1].max() - cycle.speed) <= cycle.error + 0.05 * cycle.speed  # of its steps


@pytest.mark.parametrize("xi", [0.05, 5.0])
def test_the_multiplier_of_an_expanded_cycle_errs_by_the_next_order(xi: float) -> None:
    """In the square of the amplitude, however steep friction is, and however much it is bent."""
    steep = FrictionCell(v0=1e-2, xi=xi)
    given = replace(steep, v_d=steep.hopf_velocity * (1.0 + 1e-8))
    cycle = unstable_once(given, 1e-12)
    bent = given.curve.curvature(given.v_d) > 1.0 / given.v0
    assert bent is (xi > 1.0)
    squared = (cycle.speed * max(1.0 / given.v0, given.curve.curvature(given.v_d))) ** 2
    exponent = 2.0 * math.pi * given.effective_damping
    assert abs(exponent - math.log(cycle.multiplier)) < 1e-15
    assert squared * exponent < cycle.multiplier_error < 100.0 * squared * exponent + 2e-14
    narrow = friction_cycles._expanded(given, 1e-3 * cycle.speed)
    assert narrow.multiplier_error > np.finfo(float).eps  # the rounding of a number beside one
    wide = friction_cycles._expanded(given, 0.5 / given.curve.curvature(given.v_d))
    assert wide.multiplier_error == math.inf  # the next order is not small


@pytest.mark.parametrize(
    ("a", "b", "eps", "tolerance", "most"),
    [
        (2.5, 0.5, 1e-3, 1e-11, 1e-8),
        (2.5, 0.5, 0.3, 1e-11, 1e-7),
        (1.0, 0.1, 0.3, 1e-13, 1e-10),
        (2.5, 0.5, 0.01, 1e-6, 1e-3),
        (4.0, 0.5, 1e-3, 1e-6, 1e-3),  # turns hardly drift, so that the tolerance shifts the cycle
    ],
)
def test_the_error_of_a_multiplier_of_van_der_pol_cycles_covers_that_of_the_monodromy_matrix(
    a: float, b: float, eps: float, tolerance: float, most: float
) -> None:
    """One multiplier is 1, and the trace of the matrix is the sum of both."""
    found = vdp_cell(a, b, eps, tolerance)
    finest = found if tolerance == 1e-13 else vdp_cell(a, b, eps, 1e-13)
    rate = variational_rate(VdpChain(a=a, b=b, c=0.0, eps=eps, sites=2))  # one remains at rest
    for cycle in (found.stable_cycle, found.unstable_cycle):
        exact = next(
            each
            for each in (finest.stable_cycle, finest.unstable_cycle)
            if each is not None and abs(each.max - cycle.max) < 0.3
        )
        start = np.column_stack([[exact.max, 0.0, 0.0, 0.0], np.eye(4)]).ravel()
        run = solve_ivp(rate, (0, exact.period), start, "DOP853", rtol=1e-13, atol=1e-14)
        monodromy = run.y[:, -1].reshape(4, 5)[:, 1:]
        true = float(monodromy[0, 0] + monodromy[2, 2]) - 1.0
        # The trace is a sum of integrals at 1e-13.
        assert abs(true - cycle.multiplier) <= cycle.multiplier_error + 1e-13
        assert cycle.multiplier_error < most


def test_a_multiplier_that_the_coarser_search_does_not_resolve_has_no_known_error() -> None:
    cycle = unstable_cycle(CELL)
    assert cycle is not None
    unresolved = replace(cycle, multiplier=None, multiplier_error=None)
    found = _with_error(CELL, cycle, unresolved)
    assert found.multiplier_error == math.inf
    other = _with_error(CELL, cycle, replace(cycle, multiplier=cycle.multiplier + 0.5))
    assert other.multiplier_error == pytest.approx(0.5 + cycle.multiplier_error, rel=1e-12)
    lost = _with_error(CELL, cycle, None)
    assert lost.multiplier_error == math.inf
    neither = _with_error(CELL, unresolved, None)
    assert (neither.error, neither.multiplier_error) == (math.inf, None)
    none = _with_error(CELL, unresolved, cycle)
    assert none.multiplier_error is None


def test_slip_shrinks_inside_of_the_unstable_cycle_and_grows_outside_beyond_round_off() -> None:
    cell = replace(CELL, v_d=1.4)
    cycle = unstable_once(cell, 1e-17)
    assert cycle is not None
    # Four times the round-off of the cycle: as much again comes from each slip.
    inside, outside = (
        friction_cycles._growth(cell, cycle.max + side * 4.0 * cycle.error, tolerance=1e-17)
        for side in (-1.0, 1.0)
    )
    assert inside < 0.0 < outside


def test_a_maximum_beyond_the_unstable_cycle_is_followed_by_a_larger_one_before_slip_ends() -> None:
    """Slip from there does not reach the belt, and its next maximum is found by scipy."""
    cycle = unstable_once(CELL, 1e-12)
    assert cycle is not None
    for off in (-0.3, -0.01, 0.01, 0.1):
        y = cycle.max + off
        times = np.linspace(1.0, 7.0, 600)
        assert slip(CELL, y)(times)[1].max() < CELL.v_d
        assert friction_cycles._grows(CELL, y, 1e-12) is (off > 0.0) is (peak(CELL, y)[1] > y)


def test_the_error_of_a_multiplier_covers_the_rounding_of_its_differences() -> None:
    """That of the larger turning point, divided by a step of 1e-5 of its distance from sliding.

    With μ_st and μ_d all of the motion is displaced, here so that the other turning point is zero.
    """
    low = unstable_once(CELL, 1e-12).min
    moved = replace(CELL, mu_st=CELL.mu_st - low, mu_d=CELL.mu_d - low)
    cycle = unstable_once(moved, 1e-12)
    assert abs(cycle.min) < 1e-12
    step = 1e-5 * (cycle.max - moved.steady_sliding)
    assert cycle.multiplier_error > np.finfo(float).eps * cycle.max / step


def test_the_error_of_a_multiplier_is_the_same_of_a_cell_of_another_size() -> None:
    """With μ_st, μ_d, v₀ and v_d all displacements are multiplied, by a power of two exactly.

    The error is mostly one of round-off, of which the differences vary from cell to cell.
    """
    cell = replace(CELL, v_d=1.4)
    sized = {name: getattr(cell, name) for name in ("mu_st", "mu_d", "v0", "v_d")}
    errors = []
    for size in (1.0, 256.0):
        larger = replace(cell, **{name: size * value for name, value in sized.items()})
        cycle = unstable_once(larger, 1e-12)
        assert cycle is not None
        errors.append((cycle.multiplier_error, cycle.error / size))
    assert errors[1] == pytest.approx(errors[0], rel=0.5)


def test_the_error_of_a_cycle_covers_the_coarser_search_in_each_of_its_numbers() -> None:
    fine, coarse = (unstable_once(CELL, each) for each in (1e-12, 1e-10))
    stated = unstable_cycle(CELL, 1e-12)
    assert stated.max == fine.max != coarse.max
    faster = _with_error(CELL, fine, replace(fine, speed=fine.speed + 0.5))
    assert faster.error == 0.5
    # Without stick the velocity of the belt, by which positions become times, does not matter.
    slow = _with_error(replace(CELL, v_d=1e-6), fine, fine)
    assert slow.error < 1e-10


@pytest.mark.parametrize("side", [0, 1])
def test_the_basin_ends_where_runs_change_their_fate(side: int) -> None:
    orbits = friction_cell(replace(CELL, v_d=1.6))
    edge, outward = orbits.basin[side], 2 * side - 1
    chain = FrictionChain.of(orbits.cell, c=0.0, sites=1)
    fate = []
    for step in (-1e-3, 1e-3):
        start = np.array([[edge + outward * step], [0.0]])
        run = run_events(chain, start, 80.0, tolerance=1e-10, longest_step=0.3)
        fate.append(run.log.size > 0)
    assert fate == [False, True]


def test_cycles_end_by_grazing_at_the_point_of_release() -> None:
    end = cycle_end_velocity(CELL)

    def largest(v_d: float) -> tuple[float, float]:
        """Largest ẏ - v_d on returning, and y there, by scipy: slip continued smoothly."""

        def rate(_: float, z: np.ndarray) -> list[float]:
            mu = 0.5 + 0.5 * math.exp(z[1] / 0.5)
            return [z[1] + v_d, mu - 0.1 * (z[1] + v_d) - z[0]]

        start = [1 - 0.1 * v_d, 0.0]
        run = solve_ivp(
            rate, (0, 7), start, "DOP853", rtol=1e-13, atol=1e-15, dense_output=True, max_step=0.05
        )
        t = brentq(lambda s: rate(s, run.sol(s))[1], 5.5, 6.8, xtol=1e-14)
        y, w = run.sol(t)
        return float(w), float(y)

    theirs = brentq(lambda v: largest(v)[0], 1.7, 1.9, xtol=1e-13)
    assert end == pytest.approx(theirs, abs=1e-10)
    assert largest(end)[1] == pytest.approx(replace(CELL, v_d=end).release, abs=1e-10)
    assert stick_slip_cycle(replace(CELL, v_d=end * (1 + 1e-9))) is None
    assert stick_slip_cycle(replace(CELL, v_d=end * (1 - 1e-9))) is not None
    sticks = []
    for distance in (1e-3, 1e-5):
        cycle = stick_slip_cycle(replace(CELL, v_d=end * (1 - distance)))
        sticks.append(cycle.stick_time)
    assert math.log10(sticks[0] / sticks[1]) / 2 == pytest.approx(0.5, abs=0.03)
    both = friction_cell(replace(CELL, v_d=end * (1 - 1e-10)))
    assert both.stable_cycle.max == pytest.approx(both.unstable_cycle.max, abs=1e-4)


def test_the_unstable_cycle_is_born_at_the_hopf_velocity() -> None:
    """Shooting tends to the expansion; the expansion takes over within the bound it states."""
    for distance, room in ((1e-3, 1e-3), (1e-5, 1e-5), (2e-7, 1e-4), (1e-6, 1e-6)):
        cell = FrictionCell(v_d=CELL.hopf_velocity + distance)
        cycle = unstable_once(cell, 1e-13)
        small = math.sqrt(8 * cell.effective_damping * cell.v0**2 / -friction_slope(cell, cell.v_d))
        assert abs(cycle.amplitude / small - 1) < room
    near = unstable_cycle(FrictionCell(v_d=CELL.hopf_velocity + 1e-8))
    # The expansion at 1e-8 beside the shot cycle at 1e-6: amplitudes go like the root.
    assert near.amplitude == pytest.approx(cycle.amplitude / 10, abs=near.error)
    assert near.error < 1e-7
    # Both are off centre by an amount that goes like the square of the amplitude.
    off = [
        (each.max + each.min) / 2 - FrictionCell(v_d=CELL.hopf_velocity + distance).steady_sliding
        for each, distance in ((near, 1e-8), (cycle, 1e-6))
    ]
    assert 100 * off[0] == pytest.approx(off[1], rel=1e-2)
    assert abs(near.max + near.min - 2 * FrictionCell(v_d=CELL.hopf_velocity).steady_sliding) < 1e-6


@pytest.mark.parametrize("slower", [1e-8, 1.0])
def test_below_the_hopf_velocity_steady_sliding_has_no_basin_to_be_bounded(slower: float) -> None:
    cell = FrictionCell(v_d=CELL.hopf_velocity - slower)
    assert cell.effective_damping < 0.0
    assert unstable_once(cell, 1e-8) is None
    assert unstable_once(replace(CELL, v_d=2.0), 1e-8) is None  # slip never comes to the belt


def test_a_cell_is_described_by_its_own_hopf_velocity_and_its_unstable_cycle() -> None:
    """Between made-up limits: within them both cycles, and beyond them neither."""
    inside, beyond = (
        friction_cell(CELL, 1e-8, limits=friction.CycleLimits(first=0.0, end=end, error=0.0))
        for end in (1.5, 1.0)
    )
    assert inside.hopf_velocity == CELL.hopf_velocity
    unstable = unstable_once(CELL, 1e-8)
    assert unstable is not None
    assert (inside.grazing, inside.basin) == (None, (unstable.min, unstable.max))
    assert (beyond.stable_cycle, beyond.unstable_cycle) == (None, None)


def test_a_steep_friction_curve_is_seen_by_the_series() -> None:
    """v₀ = 1e-3: the peak of μ is far below round-off until just before the touch."""
    cell = FrictionCell(v_d=0.5, v0=1e-3)
    cycle = stick_slip_cycle(cell)
    assert cycle is not None

    def rate(_: float, z: np.ndarray) -> list[float]:
        return [z[1] + 0.5, 0.5 + 0.5 * math.exp(min(z[1], 0) / 1e-3) - 0.1 * (z[1] + 0.5) - z[0]]

    def touch(t: float, z: np.ndarray) -> float:
        return z[1] if t > 1 else -1.0

    # The first 1e-4: ẇ obeys w'' = 500 w' - 1/2 to leading order in w/v₀; Radau carries it on.
    t, grow = 1e-3, 500.0
    w = -0.5 / grow**2 * ((math.exp(grow * t) - 1) / grow - t) * grow
    run = solve_ivp(
        rate, (t, 5.5), [cell.release + 0.5 * t, w], "Radau", rtol=1e-9, atol=1e-12,
        dense_output=True, max_step=0.01,
    )  # fmt: skip
    values = [touch(s, run.sol(s)) for s in np.linspace(5.0, 5.4, 4001)]
    first = 5.0 + 1e-4 * int(np.argmax(np.array(values) > 0))
    # Leaving out w²/v₀ terms at the start moves the touch by about 1e-3.
    assert cycle.slip_time == pytest.approx(first, abs=3e-3)


@pytest.mark.parametrize(
    ("cell", "reverses"), [(FrictionCell(mu_d=0.0), True), (FrictionCell(v_d=20.0, xi=0.0), True)]
)
def test_a_cell_that_slips_forwards_before_it_sticks_has_its_cycle(
    cell: FrictionCell, reverses: bool
) -> None:
    cycle = stick_slip_cycle(cell)
    assert (cycle.speed > cell.v_d) is reverses
    start = np.array([[cycle.max], [0.0]])
    run = run_events(
        FrictionChain.of(cell, c=0.0, sites=1), start, 4 * cycle.period, tolerance=1e-13
    )
    ends = run.log[run.log[:, 2] == 1, 0]
    assert np.diff(ends)[-1] == pytest.approx(cycle.period, abs=1e-9)
    assert np.any(run.log[:, 2] == 2)


def test_a_cell_that_reverses_before_it_sticks_turns_where_its_slips_back_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of made-up phases: back, forwards, back, until it sticks; the outermost turns count."""
    backwards = iter([(-1.0, 2.0), (-3.0, 1.0)])
    asked: list[float] = []

    def phase(
        _: FrictionCell, y: float, w: float, released: bool, end: int, **given: float
    ) -> tuple[float, float, float]:
        direction = given.get("direction", -1.0)
        if end == phases.TOUCH:
            asked.append(direction)
        assert w == 0.0
        assert released is (len(asked) == 1)  # stick has ended before the first slip only
        if end == phases.TOUCH:
            return 2.0, 0.5, 0.0
        # Slip back has a smallest and a largest y, slip forwards a largest velocity.
        assert end in ((phases.LOWEST, phases.HIGHEST) if direction < 0.0 else (phases.SLOWEST,))
        if end == phases.LOWEST:
            turns[:] = next(backwards)
        begun.append((y, w))
        return 1.0, turns[0] if end == phases.LOWEST else turns[1], 0.25

    begun: list[tuple[float, float]] = []
    turns = [0.0, 0.0]
    sticks = iter([None, None, SimpleNamespace(duration=4.0)])
    monkeypatch.setattr(friction_cycles, "_phase", phase)
    monkeypatch.setattr(friction_cycles, "stick_phase", lambda *_: next(sticks))
    found = friction_cycles.stick_slip_once(CELL, 1e-12)
    assert asked == [-1.0, 1.0, -1.0]
    assert (found.min, found.max) == (-3.0, 2.0)
    assert (found.slip_time, found.stick_time, found.period) == (6.0, 4.0, 10.0)
    assert found.speed == CELL.v_d + 0.25
    # Each slip begins at the velocity of the belt, where the one before has ended.
    assert set(begun) == {(CELL.release, 0.0), (0.5, 0.0)}


def test_an_unstable_cycle_that_must_exist_and_is_not_found_is_said_to_be(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(friction_cycles, "_growth", lambda *_, **__: 0.5)
    with pytest.raises(ArithmeticError, match="no unstable cycle found"):
        friction_cycles.unstable_once(replace(CELL, v_d=1.3), 1e-8)


def test_a_cell_that_never_sticks_is_refused() -> None:
    with pytest.raises(
        ParameterError, match=r"= 200 at damping xi = 0 .*must be so low that the cell st"
    ):
        friction_cell(FrictionCell(v_d=200.0, xi=0.0))
    with pytest.raises(ParameterError, match="v_d"):
        friction_cell(FrictionCell(v_d=1e-300))


@pytest.mark.parametrize(
    "cell",
    [
        FrictionCell(v_d=1e-9), FrictionCell(v_d=1e-6), FrictionCell(v_d=1e4), FrictionCell(xi=0.0),
        FrictionCell(xi=1.0), FrictionCell(v0=1e-4, v_d=0.5), FrictionCell(v0=20.0),
        FrictionCell(mu_d=0.999), FrictionCell(v_d=CELL.hopf_velocity),
        FrictionCell(v_d=CELL.hopf_velocity * (1 + 1e-15)), FrictionCell(xi=1e-6),
    ],
)  # fmt: skip
def test_extreme_cells_have_answers_that_agree_with_themselves(cell: FrictionCell) -> None:
    orbits = friction_cell(cell)
    stable = orbits.stable_cycle
    assert (stable is not None) == (cell.v_d < orbits.cycle_end_velocity)
    assert (orbits.basin is None) == (cell.effective_damping <= 0.0)
    if stable is not None:
        assert math.isfinite(stable.period)
        assert stable.stick_time > 0
        assert stable.min < stable.max
        # Energy over the cycle: what the belt gives, friction and damping take.
        assert stable.max >= cell.release
    assert not math.isnan(orbits.error)


def test_the_diagram_is_the_cells_one_by_one() -> None:
    """With the error of each, which bounds the difference from a computation of another kind."""
    diagram = cell_diagram(CELL, [1.0, 1.3, 1.7, 2.0])
    for i in (1, 2):
        orbits = friction_cell(replace(CELL, v_d=float(diagram.v_d[i])))
        assert orbits.hopf_velocity == CELL.hopf_velocity
        stable, unstable = orbits.stable_cycle, orbits.unstable_cycle
        errors = stable.error, unstable.error, orbits.cycle_end_error
        assert orbits.error == max(errors)
        assert diagram.stable[i].tolist() == [stable.min, stable.max]
        assert diagram.stick_time[i] == stable.stick_time
        assert diagram.unstable[i].tolist() == [unstable.min, unstable.max]
        assert diagram.multiplier[i] == unstable.multiplier
        assert (diagram.stable_error[i], diagram.unstable_error[i]) == errors[:2]
        assert diagram.multiplier_error[i] == unstable.multiplier_error
        ends = orbits.cycle_end_velocity, orbits.cycle_end_error
        assert (diagram.cycle_end_velocity, diagram.cycle_end_error) == ends
    assert np.isnan(diagram.unstable[[0, 3]]).all()
    assert np.isnan(diagram.unstable_error).tolist() == [True, False, False, True]
    assert np.isnan(diagram.stable_error).tolist() == [False, False, False, True]
    assert np.isnan(diagram.stable[3]).all()
    dry = cell_diagram(FrictionCell(law="coulomb", xi=0.01), [0.5])
    assert (np.isnan(dry.stable).any(), np.isnan(dry.unstable).all()) == (False, True)
    # In words it is a table with a row for each velocity.
    first_column = re.findall(r"^ +(\d\S*)", in_words(diagram), re.MULTILINE)
    assert first_column[:4] == ["1", "1.3", "1.7", "2"]
    again = bifurcation([CELL], "v_d", [1.0, 1.3])
    assert again.stable.tolist() == diagram.stable[:2].tolist()
    assert bifurcation([CELL], "xi", [0.1, 0.2]) is None


def test_the_columns_of_a_diagram_have_both_ends_of_both_cycles() -> None:
    two = np.arange(2.0)
    found = diagram.Bifurcation(
        cell=CELL, v_d=two, sliding=two + 2, stable=np.array([[4.0, 6.0], [5.0, 7.0]]),
        stable_error=two + 8, unstable=np.array([[10.0, 12.0], [11.0, 13.0]]),
        unstable_error=two + 14, stick_time=two + 16, multiplier=two + 18,
        multiplier_error=two + 20, cycle_end_velocity=22.0, cycle_end_error=23.0, seconds=0.0,
    )  # fmt: skip
    expected = {
        "v_d": 0, "sliding": 2, "stable_min": 4, "stable_max": 6, "stick_time": 16,
        "stable_error": 8, "unstable_min": 10, "unstable_max": 12, "unstable_error": 14,
    }  # fmt: skip
    columns = {name: column.tolist() for name, column in found.columns().items()}
    assert columns == {name: [first, first + 1] for name, first in expected.items()}
    assert found.is_curve


def test_the_errors_of_a_diagram_are_in_every_form_of_it(tmp_path: Path) -> None:
    """Of a coarse one they bound the differences from a fine one."""
    line = "cell friction --v-d 1.2:2:5 --tolerance"
    rough, fine = (tmp_path / f"{each}.json" for each in ("rough", "fine"))
    assert main(shlex.split(f"{line} 1e-7 --out {rough} --out {tmp_path / 'rough.csv'}")) == 0
    assert main(shlex.split(f"{line} 1e-13 --out {fine}")) == 0
    found, exact = (json.loads(each.read_text()) for each in (rough, fine))
    gap = abs(found["cycle_end_velocity"] - exact["cycle_end_velocity"])
    assert 0.0 < gap <= found["cycle_end_error"]
    for error, names in (
        ("stable_error", ("stable_min", "stable_max", "stick_time")),
        ("unstable_error", ("unstable_min", "unstable_max")),
    ):
        for i, bound in enumerate(found[error]):
            gaps = [abs(found[name][i] - exact[name][i]) for name in names if found[name][i]]
            assert (bound is None) == (not gaps)
            assert not gaps or max(gaps) <= bound
    head = (tmp_path / "rough.csv").read_text().splitlines()[0].split(",")
    assert {"stable_error", "unstable_error"} <= {*head}


def test_a_search_that_takes_minutes_reports_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """At strong damping each slip phase takes a second; the phases are counted."""
    slips: list[float] = []

    def counted(cell: FrictionCell, tolerance: float) -> float:
        slips.append(cell.v_d)
        return friction_cycles.largest_after_release(cell, tolerance)

    monkeypatch.setattr(friction, "largest_after_release", counted)
    monkeypatch.setattr(friction, "_SLIPS", 12)  # fewer than are counted: it goes on below one
    for compute in (
        partial(cell, replace(CELL, v_d=1.3)),
        partial(cell_diagram, CELL, [1.2, 1.3, 1.4]),
        partial(bifurcation, [CELL], "v_d", [1.2, 1.3, 1.4]),
    ):
        slips.clear()
        reports: list[float] = []
        compute(tolerance=1e-8, progress=reports.append)
        assert len(reports) > 0.8 * len(slips)  # the error of the end takes five phases more
        assert reports == sorted(set(reports))
        assert 0.0 < reports[0] < 0.1
        assert reports[-1] <= 1.0


@pytest.mark.parametrize(
    "given",
    [
        CELL, FrictionCell(law="coulomb"), FrictionCell(law="stribeck", v_s=0.01, xi=5.0),
        FrictionCell(v0=1e-3, xi=20.0), FrictionCell(xi=1e-12),
    ],
    ids=["paper", "coulomb", "relaxation, stribeck", "relaxation", "round-off decides"],
)  # fmt: skip
def test_limits_beside_those_at_another_tolerance_are_those_of_a_whole_search(
    given: FrictionCell, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Up to round-off, which decides the sign there; relaxation takes two fifths of the slips."""
    slips: list[float] = []

    def counted(cell: FrictionCell, tolerance: float) -> float:
        slips.append(cell.v_d)
        return friction_cycles.largest_after_release(cell, tolerance)

    monkeypatch.setattr(friction, "largest_after_release", counted)
    fine = friction.cycle_velocities(given, 1e-12)
    slips.clear()
    whole = friction.cycle_velocities(given, 1e-8)
    most = len(slips)
    slips.clear()
    beside = friction._limits_beside(given, fine, 1e-8, None)
    assert beside == pytest.approx(whole, rel=friction_cycles.ROUND_OFF)
    assert len(slips) < (0.4 if given.xi > 1.0 else 1.0) * most + 10


@pytest.mark.parametrize(("errors", "known"), [(2.9, True), (3.1, False)])
def test_the_error_of_an_end_of_cycles_is_known_if_they_have_ended_three_errors_above(
    errors: float, known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of made-up ends at two tolerances, and slip that falls short of v_d from there on."""
    end, gap = 2.0, 1e-3
    monkeypatch.setattr(friction, "cycle_velocities", lambda *_: (0.0, end))
    monkeypatch.setattr(friction, "_limits_beside", lambda *_: (0.0, end + gap))
    monkeypatch.setattr(friction, "_rounding_of_end", lambda *_: 0.0)
    slip = end + errors * gap
    monkeypatch.setattr(friction, "largest_after_release", lambda at, _: slip - at.v_d)
    found = friction.cycle_limits(FrictionCell(), 1e-12, None)
    assert found.error == pytest.approx(gap if known else math.inf)


def test_a_multiplier_that_differences_do_not_resolve_has_no_error() -> None:
    """Where friction falls steeply, slip that nearly touches has different slopes on both sides."""
    cycle = unstable_once(FrictionCell(v0=0.01, v_d=0.65912), 1e-12)
    assert (cycle.multiplier, cycle.multiplier_error) == (None, None)


@pytest.mark.parametrize("steepness", [0.1, 10.0])
def test_round_off_moves_the_end_of_cycles_by_as_much_as_the_slope_of_slip_lets_it(
    steepness: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of made-up slip that falls short of v_d from the end on: where it falls slowly, by more."""
    end = 2.0
    monkeypatch.setattr(
        friction, "largest_after_release", lambda at, _: steepness * end * math.log(end / at.v_d)
    )
    rounding = friction_cycles.ROUND_OFF * (end + abs(replace(CELL, v_d=end).release))
    found = friction._rounding_of_end(CELL, end, 1e-12)
    assert found == pytest.approx(rounding / min(1.0, steepness), rel=1e-6)  # closely beside it


def test_cycles_of_strong_damping_are_found_although_they_end_at_the_slowest_belts() -> None:
    """Coulomb: slip from release, a damped oscillation in closed form, just comes back to v_d."""
    given = FrictionCell(law="coulomb", xi=0.95)
    first, end = friction.cycle_velocities(given, 1e-12)
    assert first == 0.0
    assert 0.0 < end < 1e-4
    omega = math.sqrt(1.0 - given.xi**2)

    def excess(v_d: float) -> float:
        at = replace(given, v_d=v_d)
        u = at.release - at.steady_sliding

        # ü + 2ξu̇ + u = 0 from (u, v_d): its velocity at the turning point of ẏ after the minimum.
        def motion(t: float) -> tuple[float, float]:
            other = (v_d + given.xi * u) / omega
            fall = math.exp(-given.xi * t)
            cos, sin = math.cos(omega * t), math.sin(omega * t)
            place = fall * (u * cos + other * sin)
            rate = fall * (v_d * cos - (u + given.xi * v_d) / omega * sin)
            return place, rate

        def force(t: float) -> float:
            place, rate = motion(t)
            return -2.0 * given.xi * rate - place

        begin = math.pi / (2.0 * omega)
        times = np.linspace(begin, 3.0 * begin + 1.0, 400)
        at_turn = max(motion(float(t))[1] for t in times)
        return at_turn - v_d

    assert excess(0.99 * end) > 0.0 > excess(1.01 * end)


@pytest.mark.parametrize("shift", [-1e-4, -1e-7, -1e-10, 1e-10, 1e-7, 1e-4])
def test_limits_near_those_at_another_tolerance_are_searched_for_beside_them(
    shift: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up excess with both limits, which takes far fewer slips than a whole search."""
    given, first, end = FrictionCell(law="stribeck"), 0.4, 0.9
    slips: list[float] = []

    def excess(at: FrictionCell, _: float) -> float:
        slips.append(at.v_d)
        return (at.v_d - first) * (end - at.v_d)

    monkeypatch.setattr(friction, "largest_after_release", excess)
    assert friction.cycle_velocities(given, 1e-8) == pytest.approx((first, end), rel=1e-14)
    whole = len(slips)
    slips.clear()
    beside = first * (1.0 + shift), end * (1.0 + shift)
    found = friction._limits_beside(given, beside, 1e-8, None)
    assert found == pytest.approx((first, end), rel=1e-14)
    assert len(slips) < 0.7 * whole


@pytest.mark.parametrize("part", [-1e-6, 1e-6])
def test_cycles_that_begin_at_the_hopf_velocity_up_to_round_off_are_found_to_begin_there(
    part: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up excess whose first limit round-off has moved to either side of that velocity."""
    given = FrictionCell(law="stribeck", xi=1e-5)
    first, end = given.unstable_sliding.low * (1.0 + part), 0.9
    monkeypatch.setattr(
        friction, "largest_after_release", lambda at, _: (at.v_d - first) * (end - at.v_d)
    )
    assert first < 1e-3 * given.v_s  # the search begins below the velocity that is usual
    assert friction.cycle_velocities(given, 1e-8) == pytest.approx((first, end), rel=1e-14)


def test_a_limit_that_no_search_has_found_is_not_searched_for_at_another_tolerance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At so little damping the first limit is the velocity at which sliding becomes unstable."""
    given, end = FrictionCell(law="stribeck", xi=1e-8), 0.9
    first = given.unstable_sliding.low
    slips: list[float] = []

    def excess(at: FrictionCell, _: float) -> float:
        slips.append(at.v_d)
        return (at.v_d - first) * (end - at.v_d)

    monkeypatch.setattr(friction, "largest_after_release", excess)
    limits = friction.cycle_velocities(given, 1e-8)
    assert limits == (first, pytest.approx(end, rel=1e-14))
    whole = len(slips)
    slips.clear()
    assert friction._limits_beside(given, limits, 1e-8, None) == pytest.approx(limits, rel=1e-14)
    assert len(slips) < 0.7 * whole
    assert min(slips) > 0.5 * end


@pytest.mark.parametrize("v_s", [1e-3, 30.0])
def test_cycles_are_looked_for_up_to_ten_times_the_velocity_of_the_law(
    v_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up excess, as no velocity but v_s is in the law."""
    given, first, end = FrictionCell(law="stribeck", v_s=v_s, xi=0.01), 7.0 * v_s, 20.0 * v_s
    monkeypatch.setattr(
        friction, "largest_after_release", lambda at, _: (at.v_d - first) * (end - at.v_d)
    )
    assert friction.cycle_velocities(given, 1e-8) == pytest.approx((first, end), rel=1e-14)


@pytest.mark.parametrize("at", [1e-9, 0.1234, 3e8])
def test_a_change_of_sign_is_found_to_the_last_digits_where_it_is_a_jump(at: float) -> None:
    found = friction._zero(lambda v_d: 1.0 if v_d < at else -1.0, 0.5 * at, 1.25 * at)
    assert found == pytest.approx(at, rel=2e-15, abs=0.0)


@pytest.mark.parametrize(
    ("fine", "coarse", "ended"),
    [(-2.0, -3.0, True), (-1.0, -3.0, False), (-1.0, 1.0, False), (1.0, 1.0, False)],
)
def test_cycles_have_ended_where_slip_falls_short_by_more_than_it_differs_between_tolerances(
    fine: float, coarse: float, ended: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        friction, "largest_after_release", lambda _, each: fine if each == 1e-12 else coarse
    )
    assert friction._ends_below(CELL, 3.0, 1e-12) is ended


def test_the_part_of_the_slips_that_is_reported_rises_and_stays_below_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(friction, "largest_after_release", lambda *_: 1.0)
    monkeypatch.setattr(friction, "_SLIPS", 3)
    seen: list[float] = []
    excess = friction._excess(CELL, 1e-8, seen.append)
    assert [excess(1.0) for _ in range(6)] == [1.0] * 6
    assert seen == sorted({*seen})
    assert len(seen) == 6
    assert 0.0 < min(seen) < max(seen) < 1.0


def test_limits_far_from_those_at_another_tolerance_are_searched_for_everywhere() -> None:
    whole = friction.cycle_velocities(CELL, 1e-8)
    assert friction._limits_beside(CELL, (0.0, 0.5 * whole[1]), 1e-8, None) == whole


def test_the_end_of_relaxation_cycles_is_known_to_its_error_and_not_better() -> None:
    """What follows a slow creep changes abruptly with v_d; the sign of the excess does there."""
    for relaxing in (FrictionCell(xi=100.0, v0=1e-3), FrictionCell(xi=30.0, v0=1e-4)):
        limits = friction.cycle_limits(relaxing, friction.TOLERANCE, None)
        assert 0.0 < limits.error < 1e-10 * limits.end
        inside, outside = (
            friction_cycles.largest_after_release(replace(relaxing, v_d=limits.end + each), 1e-13)
            for each in (-limits.error, limits.error)
        )
        assert inside > 0.0 > outside
        assert limits.end > relaxing.hopf_velocity


def test_slip_that_creeps_longer_than_it_is_followed_is_refused() -> None:
    """It had counted as slip that ends in steady sliding, so that the cycles ended too early."""
    cell = FrictionCell(xi=5.0, v0=0.01, v_d=0.001)
    assert friction_cycles.largest_after_release(cell, 1e-8) > 0.0
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(friction_cycles, "_LONGEST", 2.0)  # it creeps for a time of about 2ξ
        with pytest.raises(ParameterError, match="slip after a release ends within 2 time units"):
            friction_cycles.largest_after_release(cell, 1e-8)
    sliding = FrictionCell(xi=1.2, v0=10.0, v_d=1.0)  # neither turns nor creeps: it has settled
    assert friction_cycles.largest_after_release(sliding, 1e-8) <= 0.0
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(friction_cycles, "_LONGEST", 5.0)
        low, _ = friction_cycles.cycle_turning_points(sliding)
    assert low == sliding.steady_sliding


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("part", "settled"), [(1e-10, True), (1e-8, False)])
def test_slip_has_settled_within_a_thousand_millionth_of_its_way_on_either_side(
    part: float, settled: bool, side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of made-up slip that is still backwards after the longest time."""
    y = CELL.steady_sliding + side * part * (CELL.release - CELL.steady_sliding)
    monkeypatch.setattr(friction_cycles, "_phase", lambda *_, **__: (phases.ABANDONED, y, -0.5))
    with nullcontext() if settled else pytest.raises(ParameterError, match="so weak that slip"):
        assert friction_cycles.largest_after_release(CELL, 1e-8) == -CELL.v_d


@pytest.mark.parametrize(("xi", "v0"), [(1.1, 2.0), (1.2, 1.0), (1.4, 2.0)])
def test_slip_that_has_settled_to_rounding_is_not_refused_on_a_slow_belt(
    xi: float, v0: float
) -> None:
    """On a slow belt a thousand-millionth of its way is less than one rounding of y."""
    assert 2.0 * xi - 0.5 / v0 > 0.0  # sliding is stable at every velocity
    assert friction.cycle_velocities(FrictionCell(xi=xi, v0=v0), 1e-8) == (0.0, 0.0)


@pytest.mark.parametrize("follows", [0.5, 2.0])
def test_slip_that_does_not_reach_the_belt_is_followed_from_where_it_is_fastest(
    follows: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def phase(_: object, y: float, w: float, released: bool, end: int, **__: object) -> Any:
        assert (y, w, end) == (0.25, -0.125, phases.HIGHEST)
        assert released is False
        return 0.5, follows, 0.0

    monkeypatch.setattr(friction_cycles, "_slip_from", lambda *_: (2.0, 0.25, -0.125))
    monkeypatch.setattr(friction_cycles, "_phase", phase)
    assert friction_cycles._grows(FrictionCell(), 1.0, 1e-12) is (follows > 1.0)


def test_without_damping_and_weakening_no_cycle_is_unstable() -> None:
    """Slip under constant friction then is a circle at any amplitude."""
    for v_d in (0.01, 1.0):
        assert unstable_once(FrictionCell(law="coulomb", xi=0.0, v_d=v_d), 1e-12) is None


def _cycle_of_map(after: Callable[[float], float], monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the unstable cycle of turns in which a distance d from sliding becomes after(d)."""
    cell = FrictionCell()
    centre = cell.steady_sliding

    def following(_: object, y: float, end: int, __: float) -> tuple[float, float, float]:
        d = y - centre
        return 6.0, centre + (after(d) if end == phases.HIGHEST else -d), 0.125

    monkeypatch.setattr(friction_cycles, "largest_after_release", lambda *_: 1.0)
    monkeypatch.setattr(friction_cycles, "_phase", lambda *_, **__: (3.0, centre + 1.0, 0.0))
    monkeypatch.setattr(friction_cycles, "_slip_from", following)
    found = unstable_once(cell, 1e-12)
    assert found is not None
    return found


@pytest.mark.parametrize(("beyond", "known"), [(1.0, True), (1.02, True), (3.0, False)])
def test_a_multiplier_that_differs_to_both_sides_is_unknown_as_is_its_error(
    beyond: float, known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Turns of a made-up cell: a distance d from sliding becomes d + sd(d - ½), s = 1 below ½.

    The slopes on both sides may differ by a hundredth of their size.
    """
    found = _cycle_of_map(lambda d: d + (beyond if d > 0.5 else 1.0) * d * (d - 0.5), monkeypatch)
    assert found.max == pytest.approx(FrictionCell().steady_sliding + 0.5)
    if known:
        assert found.multiplier == pytest.approx(0.5 * (1.5 + 1.0 + 0.5 * beyond))
    assert (found.multiplier is not None, found.multiplier_error is not None) == (known, known)


@pytest.mark.parametrize("third", [-1e6, 1e6])
def test_the_error_of_a_multiplier_covers_the_third_derivative_of_the_map_of_either_sign(
    third: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up map with the slope 1.5 at its fixed point, and a term of third order there."""

    def after(d: float) -> float:
        off = d - 0.5
        return d + d * off + third * off**3 * math.exp(-((1e3 * off) ** 2))

    found = _cycle_of_map(after, monkeypatch)
    assert 1e-6 < abs(found.multiplier - 1.5) <= found.multiplier_error < 1e-3


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_slip_that_is_followed_no_longer_has_settled_where_little_of_its_way_is_left(
    share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of its way from release to steady sliding, which is shorter than either force."""
    cell = FrictionCell(xi=0.25, viscous=0.125, v0=0.5, v_d=0.01)
    left = share * friction_cycles._SETTLED * (cell.release - cell.steady_sliding)
    abandoned = (phases.ABANDONED, cell.steady_sliding + left, -0.125)
    monkeypatch.setattr(friction_cycles, "_phase", lambda *_, **__: abandoned)
    with nullcontext() if share < 1.0 else pytest.raises(ParameterError, match="so weak"):
        assert friction_cycles.largest_after_release(cell, 1e-8) == -cell.v_d
    faster = (*abandoned[:2], 0.125)  # than the belt, which is all that is asked for
    slower = (3.0, *abandoned[1:])  # a largest velocity that is not that of the belt
    for found in (faster, slower):
        monkeypatch.setattr(friction_cycles, "_phase", lambda *_, found=found, **__: found)
        assert friction_cycles.largest_after_release(cell, 1e-8) == found[2]


@pytest.mark.parametrize(
    "cell",
    [
        FrictionCell(mu_d=0.0, xi=0.5, v0=0.01, v_d=1.0),
        FrictionCell(mu_st=1e6, mu_d=1e6 - 1.0, xi=0.5, v0=1e4, v_d=1e-3),
    ],
    ids=["released in steady sliding at y = 0", "on a slow belt"],
)
def test_slip_has_settled_within_the_rounding_of_its_velocity_or_of_its_place(
    cell: FrictionCell, monkeypatch: pytest.MonkeyPatch
) -> None:
    rounding = np.spacing(max(cell.v_d, cell.steady_sliding))
    assert friction_cycles._SETTLED * abs(cell.release - cell.steady_sliding) < rounding
    for few, settled in ((4.0, True), (400.0, False)):
        y = cell.steady_sliding + few * rounding
        abandoned = (phases.ABANDONED, y, -cell.v_d)
        monkeypatch.setattr(friction_cycles, "_phase", lambda *_, at=abandoned, **__: at)
        with nullcontext() if settled else pytest.raises(ParameterError, match="so weak"):
            assert friction_cycles.largest_after_release(cell, 1e-8) == -cell.v_d


def test_slip_that_is_followed_no_longer_is_refused_with_its_damping(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(friction_cycles, "_LONGEST", 0.5)  # long before slip turns
    slow = FrictionCell(xi=0.25, viscous=0.125, v0=0.5, v_d=1.0)
    refused = r"damping 2 xi \+ viscous = 0\.625 at v0 or v_s = 0\.5 .*within 0\.5 time units"
    with pytest.raises(ParameterError, match=refused):
        friction_cycles.largest_after_release(slow, 1e-8)


@pytest.mark.parametrize(
    "overdamped",
    [
        FrictionCell(law="stribeck", xi=4.0, v_d=0.09, mu_d=0.0, v_s=0.033),
        FrictionCell(law="stribeck", xi=1.4, v_d=3.5, mu_d=0.0, v_s=1.2),
    ],
)
def test_a_maximum_after_which_the_cell_creeps_into_sliding_does_not_grow(
    overdamped: FrictionCell,
) -> None:
    """It had counted as growing, as one does from which the motion runs beyond all bounds."""
    sliding = overdamped.steady_sliding
    top = sliding + 0.1 * abs(overdamped.release - sliding)

    def rate(_: float, z: Any) -> list[float]:
        return [z[1], friction_force(overdamped, z[1] - overdamped.v_d) - z[0] - 2.0 *
                overdamped.xi * z[1]]  # fmt: skip

    run = solve_ivp(rate, (0.0, 200.0), [top, 0.0], "Radau", rtol=1e-8, atol=1e-12)
    assert (run.y[1, 1:] < 1e-9).all()  # it never turns
    assert run.y[0, -1] - sliding < 1e-4 * (top - sliding)
    assert friction_cycles._growth(overdamped, top, 1e-8) == -1.0
    excited = replace(CELL, v_d=0.5)
    far = excited.steady_sliding + 30.0
    assert friction_cycles._growth(excited, far, 1e-8) == 1.0


@pytest.mark.parametrize("distance", [1e-3, 1.0, 30.0])
def test_linear_slip_grows_by_its_decrement_or_creeps_into_sliding(distance: float) -> None:
    """Under Coulomb's law: of ü + 2ξu̇ + u = 0 from rest the next maximum is e^{-2πξ/ω} of it."""
    for xi in (1e-3, 0.1, 0.5):
        weak = FrictionCell(law="coulomb", xi=xi)
        left = math.expm1(-2.0 * math.pi * xi / math.sqrt(1.0 - xi * xi))
        found = friction_cycles._growth(weak, weak.steady_sliding + distance, 1e-12)
        assert found == pytest.approx(left, abs=1e-9)
    strong = FrictionCell(law="coulomb", xi=1.5)
    assert friction_cycles._growth(strong, strong.steady_sliding + distance, 1e-12) == -1.0


def test_near_the_hopf_velocity_the_amplitude_is_that_of_averaging_where_there_is_a_cycle() -> None:
    """8δ/F₃, F₃ = (μ_st - μ_d) e^{-u}/v₀³; under Stribeck's law none is unstable below √1.5 v_s."""
    fall = math.exp(-CELL.v_d / CELL.v0) * (CELL.mu_st - CELL.mu_d)
    expected = math.sqrt(8.0 * (2.0 * CELL.xi - fall / CELL.v0) * CELL.v0**3 / fall)
    assert friction_cycles._amplitude_near_hopf(CELL) == pytest.approx(expected, rel=1e-12)
    for v_d, known in ((1.22, False), (1.23, True)):
        cell = FrictionCell(law="stribeck", v_s=1.0, v_d=v_d, xi=5.0)
        assert math.isfinite(friction_cycles._amplitude_near_hopf(cell)) is known
    assert friction_cycles._amplitude_near_hopf(FrictionCell(law="coulomb")) == math.inf


def test_a_curve_of_cells_has_the_tolerance_that_is_documented() -> None:
    documented = inspect.signature(cell).parameters["tolerance"].default
    found = bifurcation([CELL], "v_d", [1.3, 1.4])
    assert found is not None
    assert found == bifurcation([CELL], "v_d", [1.3, 1.4], tolerance=documented)
    stable = cell(replace(CELL, v_d=1.3)).stable_cycle
    assert found.stable[0].tolist() == [stable.min, stable.max]


@pytest.mark.parametrize(
    "given",
    [
        FrictionCell(xi=1e3), FrictionCell(law="coulomb", xi=1e3),
        FrictionCell(law="stribeck", xi=1e3), FrictionCell(viscous=1e3),
        FrictionCell(v0=1e-3, xi=1e3, v_d=1e-3),
    ],
)  # fmt: skip
def test_a_cell_of_strong_damping_slides_and_is_not_followed_while_it_creeps(
    given: FrictionCell,
) -> None:
    """Following slip takes a minute: it relaxes in 2ξ = 2000, and steps are of the size of 1/2ξ."""
    begin = process_time()
    found = friction_cell(given)
    assert process_time() - begin < 5.0  # the time of compiling
    assert (found.status, found.cycle_end_velocity) == (CellStatus.SLIDING, 0.0)
    low, high = friction_cycles.cycle_turning_points(given)
    assert low == high == found.steady_sliding


@pytest.mark.parametrize("xi", [0.55, 0.7])
def test_slip_that_does_not_creep_turns_although_it_is_slow(xi: float) -> None:
    """Where friction hardly falls, an oscillation about sliding, begun at the speed of the belt."""
    given = FrictionCell(xi=xi, mu_d=0.9999, v_d=0.4)
    t, omega = np.linspace(0.0, 12.0, 4001), math.sqrt(1.0 - xi**2)
    away = given.release - given.steady_sliding
    turning = away * np.cos(omega * t) + (given.v_d + xi * away) / omega * np.sin(omega * t)
    y = given.steady_sliding + np.exp(-xi * t) * turning
    top = int(np.argmax(y))
    expected = (y[top:].min(), y[top])
    assert friction_cycles.cycle_turning_points(given) == pytest.approx(expected, abs=5e-4)


@pytest.mark.parametrize(
    ("given", "slow"),
    [
        (FrictionCell(xi=2.5), True), (FrictionCell(law="coulomb", xi=1.6, v_d=0.2), True),
        (FrictionCell(law="stribeck", xi=1.7, v_d=0.05), True),
        (FrictionCell(law="stribeck", xi=1.7, v_d=0.85), False),
        (FrictionCell(v0=0.05, xi=4.0, v_d=0.15), False),
    ],
)  # fmt: skip
def test_slip_that_is_taken_to_creep_never_turns_in_scipy(given: FrictionCell, slow: bool) -> None:
    """From points all over the wedge between ẏ = 0 and ẏ = μ(v_d) - y, on both sides."""
    where, v_d = friction_cycles.creep(given), given.v_d
    assert (where.rising >= v_d) is slow
    # From rest within v_d of steady sliding no ẏ ≤ μ(v_d) - y is that of the belt.
    assert phases._creeps.py_func(where, where.sliding - 0.99 * v_d, -v_d, v_d) is slow

    def rate(_: float, z: np.ndarray) -> list[float]:
        return [z[1], friction_coefficient(given, v_d - z[1]) - 2 * given.xi * z[1] - z[0]]

    tried = 0
    for u in (0.01, 0.1, 0.9, -0.01, -0.1, -2.0):
        for part in (0.0, 1.0):
            y, w = float(where.sliding - u), min(float(part * u), v_d) - v_d
            if not phases._creeps.py_func(where, y, w, v_d):
                continue
            tried += 1
            run = solve_ivp(rate, (0.0, 20.0), [y, w + v_d], "LSODA", rtol=1e-8, atol=1e-11)
            assert np.all(run.y[1] * np.sign(u) > -1e-9)
            assert np.all(run.y[1] <= v_d)
            assert abs(run.y[0, -1] - where.sliding) < abs(u)
    assert tried >= 4


@pytest.mark.parametrize(
    ("given", "faster"),
    [
        (FrictionCell(law="stribeck", xi=1.7, v_d=0.05), True),
        (FrictionCell(law="stribeck", xi=1.7, v_d=0.85), False),
        (FrictionCell(v0=0.05, xi=4.0, v_d=0.15), False),
    ],
)
def test_slip_creeps_up_to_the_speed_at_which_drag_rises_too_little(
    given: FrictionCell, faster: bool
) -> None:
    where = friction_cycles.creep(given)
    speed = given.v_d + where.falling if faster else given.v_d - where.rising
    drag = 2.0 * given.xi + friction_slope(given, speed)
    assert drag == pytest.approx(friction_cycles._STRONG, rel=1e-12)  # a root, to rounding


def test_a_viscous_part_is_damping_where_slip_creeps_and_where_sliding_loses_stability() -> None:
    """A viscous part 2ξ in place of ξ changes the displacement of sliding alone."""
    for v_d in (0.1, 0.2, 0.9):
        damped = FrictionCell(xi=2.5, v0=0.05, v_d=v_d)
        one, two = map(friction_cycles.creep, (damped, replace(damped, xi=0.0, viscous=5.0)))
        assert (one.rising, one.falling) == (two.rising, two.falling)
    assert one.rising == math.inf
    near = FrictionCell(xi=0.05, v_d=1.2)
    one, two = (
        friction_cycles._rounding_near_hopf(each, 0.1)
        for each in (near, replace(near, xi=0.0, viscous=0.1))
    )
    assert one == pytest.approx(two, rel=1e-9)  # both dampings are differences, to rounding
    dry = [FrictionCell(law="coulomb", **each) for each in ({"xi": 0.1}, {"xi": 0, "viscous": 0.2})]
    one, two = (np.array(grazing_slip(each)) - each.steady_sliding for each in dry)
    assert one == pytest.approx(two, rel=1e-12)


def test_an_unstable_cycle_is_found_wherever_the_force_is_zero() -> None:
    """A constant added to both coefficients of friction is added to every y."""
    far, cell = 1e4, FrictionCell(xi=1e-3, v_d=10.0)
    found = unstable_cycle(cell)
    moved = unstable_cycle(replace(cell, mu_st=cell.mu_st + far, mu_d=cell.mu_d + far))
    room = found.error + moved.error
    assert room < 1e-3
    for name in ("max", "min"):
        assert abs(getattr(moved, name) - far - getattr(found, name)) <= room


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_the_time_of_a_grazing_is_shifted_until_the_velocity_has_left_it_by_its_rounding(
    direction: float,
) -> None:
    """Along the parabola v_d(1 - t²/2); at a slope, by twice the rounding divided by it."""
    cell = replace(CELL, v_d=0.25)
    for steep in (0.0, 0.5):
        y = steep - 2.0 * cell.xi * cell.v_d - direction * cell.mu_st
        shift = friction_cycles._rounding_of_touch(cell, y, direction)
        left = shift * steep / 2.0 if steep else cell.v_d * shift**2 / 2.0
        assert 1.0 < left / np.spacing(cell.v_d + abs(y)) < 100.0
        assert left == pytest.approx(friction_cycles.ROUND_OFF * (cell.v_d + abs(y)), rel=1e-6)


def test_both_searches_for_the_limits_of_cycles_count_as_half_of_the_work(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def velocities(_: Any, __: Any, progress: Any) -> tuple[float, float]:
        progress(0.5)
        progress(1.0)
        return 0.0, math.inf

    monkeypatch.setattr(friction, "cycle_velocities", velocities)
    seen: list[float] = []
    assert friction.cycle_limits(replace(CELL, xi=0.0), 1e-8, seen.append).end == math.inf
    assert seen == [0.25, 0.5, 0.75, 1.0]


def test_the_limits_of_cycles_count_as_half_of_a_diagram_and_its_cells_as_the_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def limits(_: Any, __: Any, progress: Any) -> Any:
        progress(0.5)
        return friction.CycleLimits(first=0.0, end=2.0, error=0.0)

    made: Any = SimpleNamespace(stable_cycle=None, unstable_cycle=None, steady_sliding=0.5)
    monkeypatch.setattr(diagram, "cycle_limits", limits)
    monkeypatch.setattr(diagram, "friction_cell", lambda *_, **__: made)
    seen: list[float] = []
    found = cell_diagram(CELL, [0.5, 1.0, 2.0, 4.0], 1e-8, seen.append)
    assert found.hopf_velocity == CELL.hopf_velocity
    assert seen == [0.25, 0.625, 0.75, 0.875, 1.0]


def test_slip_that_never_turns_leaves_no_room_for_cycles_without_stick() -> None:
    """It was answered with a division by zero."""
    given = FrictionCell(
        law="stribeck", xi=1.9734473899851872, v_d=0.002054872730823412, mu_d=0.0,
        v_s=0.7700112824543293,
    )  # fmt: skip
    found = friction_cell(given, 1e-8)
    assert (found.status, found.stable_cycle) == (CellStatus.SLIDING, None)


def test_slip_creeps_from_the_lowest_point_on_and_nowhere_if_damping_is_weak() -> None:
    """That of release with the belt, if it is far enough; and at rest not even at y = 0."""
    given = FrictionCell(xi=2.5)
    where = friction_cycles.creep(given)
    assert where.lowest == given.release
    assert phases._creeps.py_func(where, given.release, 0.0, given.v_d)
    assert not phases._creeps.py_func(where, given.release, 0.5, given.v_d)  # beyond the belt
    assert not phases._creeps.py_func(friction_cycles._NO_CREEP, 0.0, -given.v_d, given.v_d)


def test_motion_outside_the_wedge_is_followed() -> None:
    """On fast slip towards the belt, and from a y so low that slip reaches the belt."""
    given = FrictionCell(law="coulomb", xi=2.0, v_d=0.2)
    where = friction_cycles.creep(given)
    y = where.lowest - 2.0
    assert not phases._creeps.py_func(where, y, -0.1, 0.2)
    t, _, w = friction_cycles._phase(given, y, -0.1, False, phases.TOUCH, tolerance=1e-10)
    assert t > 0.0
    assert abs(w) < 1e-9
    assert not phases._creeps.py_func(where, where.sliding - 0.05, -0.1, 0.2)
    assert not phases._creeps.py_func(where, where.sliding + 0.05, -0.1, 0.2)


@pytest.mark.parametrize("tolerance", [1e-10, 1e-12, 1e-14])
def test_the_error_of_the_end_of_cycles_is_not_missed_at_the_least_damping(
    tolerance: float,
) -> None:
    """Slip gains Δv_d∫exp(-v_d t²/2v₀)dt near the belt, from which 2ξ takes 2πξv_d².

    Below some ξ the error of a run takes more than 2ξ does, and the end that is found depends on
    the tolerance alone: 3.5e6 ± 3.3e6 was stated of 2.7e7.
    """
    bounded = 0
    for xi in 10.0 ** -np.arange(7.0, 17.0):
        found = friction_cell(FrictionCell(xi=float(xi)), tolerance)
        law = (0.5 * math.sqrt(2.0 * math.pi * 0.5) / (2.0 * math.pi * xi)) ** (2.0 / 3.0)
        # Left out is what friction does to the motion beside the belt, relative to v_d.
        near = 2.0 * law * math.sqrt(0.5 / law)
        if found.cycle_end_error < math.inf:
            bounded += 1
            assert abs(found.cycle_end_velocity - law) <= found.cycle_end_error + near
    assert bounded >= 2
    assert found.cycle_end_error == math.inf


def test_an_end_whose_error_is_not_known_is_printed_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split("cell friction --xi 1e-13")) == 0
    shown = capsys.readouterr().out
    assert re.search(r"^cycle_end_error +inf$", shown, re.MULTILINE)


def test_errors_within_a_result_that_are_not_known_are_printed_too() -> None:
    """Of cycles of a cell, of the points of a curve and of its rows: JSON has null for infinity."""
    found = friction_cell(replace(CELL, v_d=1.3), 1e-8)
    assert found.stable_cycle is not None
    stable = replace(found.stable_cycle, error=math.inf)
    unknown = replace(found, stable_cycle=stable)
    assert unknown.to_dict()["stable_cycle"]["error"] is None
    (line,) = (each for each in in_words(unknown).splitlines() if each.startswith("stable_cycle"))
    assert "error inf" in line
    assert "error inf" not in in_words(found)
    several = OwnCell(
        **{f.name: getattr(found, f.name) for f in fields(Cell)},
        cycles=(found.stable_cycle, stable),
    )
    table = in_words(several).split("cycles:")[1].splitlines()
    assert ["inf" in each for each in table[2:4]] == [False, True]
    curve = Curve(along="xi", values=np.array([0.1, 0.2]), points=(found, unknown), seconds=0.0)
    column = curve.columns()["stable_cycle_error"]
    assert column.tolist() == [found.stable_cycle.error, math.inf]
    rows = [each for each in in_words(curve).splitlines() if each.startswith("  0.2")]
    assert sum("inf" in each for each in rows) == 2  # of the cycle and of the whole
    assert list(
        table_lines([{"x": 0.25, "x_error": math.inf}, {"x": 0.5, "x_error": 1e-3}], units=None)
    ) == [
        "      x  x_error",
        "    0.2      inf",
        "  0.500  1.0e-03",
    ]


def test_a_number_whose_error_is_not_known_is_printed_so() -> None:
    @dataclass(frozen=True, kw_only=True)
    class Measured(Result):
        v: float | None
        error: float

    assert in_words(Measured(v=0.25, error=math.inf)) == "v  0.2 (error unknown)"
    assert in_words(Measured(v=0.25, error=1e-3)) == "v  0.250, uncertain by 1.0e-03"
    assert in_words(Measured(v=None, error=math.inf)) == ""


def test_cycles_that_end_above_the_largest_velocity_are_not_refused_for_it() -> None:
    found = friction_cell(FrictionCell(xi=1e-15), 1e-14)
    assert found.cycle_end_velocity == found.cycle_end_error == math.inf


def test_where_no_cycle_is_left_every_slip_ends_in_sliding() -> None:
    """Under Coulomb's law too, whatever slip would only touch the velocity of the belt."""
    found = friction_cell(FrictionCell(law="coulomb", xi=0.3), 1e-8)
    assert grazing_slip(FrictionCell(law="coulomb", xi=1.0)) is None  # slip does not turn
    turning = grazing_slip(found.cell)
    t = np.linspace(0.0, 3.0 * math.pi, 100_001)
    omega = math.sqrt(1.0 - 0.3**2)
    for y in turning:  # of u + 0.6 u' + u'' = 0 from rest: the largest velocity is the belt's
        u = y - found.steady_sliding
        velocity = -u * np.exp(-0.3 * t) * np.sin(omega * t) / omega
        assert velocity.max() == pytest.approx(found.cell.v_d, rel=1e-8)
    assert (found.stable_cycle, found.basin) == (None, (-math.inf, math.inf))


@pytest.mark.parametrize("damped_by", [{"xi": 0.05}, {"xi": 0.0, "viscous": 0.1}])
@pytest.mark.parametrize("reach", [0.25, 4.0])
def test_cycles_that_slip_are_looked_for_up_to_the_one_that_sticks(
    reach: float, damped_by: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a made-up map two cycles are there in a tenth of the way, or outside of it."""
    cell = replace(CELL, v_d=1.3, **damped_by)
    monkeypatch.setattr(
        friction_cycles, "cycle_turning_points", lambda *_: (0.0, cell.steady_sliding + reach)
    )
    refused = r"^belt velocity v_d = 1\.3 under .*no cycle that slips all.* run a chain of one site"
    for begin, end in ((0.005, 0.105), (0.85, 0.95), (1.05, 1.9)):
        monkeypatch.setattr(
            friction_cycles, "_grows",
            lambda _, y, __, begin=begin, end=end: begin < (y - cell.steady_sliding) / reach < end,
        )  # fmt: skip
        with nullcontext() if begin > 1.0 else pytest.raises(ParameterError, match=refused):
            friction_cycles.check_slip_cycles(cell, 1e-8)


def test_where_sliding_is_unstable_a_single_change_of_growth_is_a_stable_cycle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where it is stable, one change is the unstable cycle, within which motion decays.

    It is stable, too, where slip from release no longer sticks.
    """
    for v_d, refused, sticks in ((1.0, True, True), (1.3, False, True), (3.0, False, False)):
        cell = replace(CELL, v_d=v_d)
        assert (cell.effective_damping < 0.0) is refused
        assert (friction_cycles.largest_after_release(cell, 1e-8) > 0.0) is sticks
        middle = cell.steady_sliding + 0.1
        monkeypatch.setattr(
            friction_cycles, "_grows",
            lambda _, y, __, refused=refused, middle=middle: (y < middle) is refused,
        )  # fmt: skip
        with pytest.raises(ParameterError, match="slips all") if refused else nullcontext():
            friction_cycles.check_slip_cycles(cell, 1e-8)


@pytest.mark.parametrize(
    ("velocity", "following", "grows"),
    [(0.1, 0.9, True), (0.1, 1.1, True), (-0.1, 0.9, False), (-0.1, 1.1, True)],
)
def test_a_maximum_grows_if_slip_reaches_the_belt_or_the_next_one_is_larger(
    velocity: float, following: float, grows: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From a maximum y = 1, at ẏ = 0, past y = 0.4 where slip is fastest."""
    made = {phases.FASTEST: (2.0, 0.4, velocity), phases.HIGHEST: (3.0, following, -CELL.v_d)}
    begun: dict[int, tuple[float, float]] = {}

    def phase(_: Any, y: float, w: float, released: bool, end: int, *, tolerance: float) -> Any:
        assert (released, tolerance) == (False, 1e-9)
        begun[end] = y, w
        return made[end]

    monkeypatch.setattr(friction_cycles, "_phase", phase)
    assert friction_cycles._grows(CELL, 1.0, 1e-9) is grows
    assert begun[phases.FASTEST] == (1.0, -CELL.v_d)
    assert begun.get(phases.HIGHEST, (0.4, velocity)) == (0.4, velocity)


@pytest.mark.parametrize(("largest", "refused"), [(-1.0, True), (-1e-9, True), (1e-9, False)])
@pytest.mark.parametrize(("v_d", "damped"), [(1.0, False), (1.3, True)])
def test_slip_from_release_that_never_sticks_is_a_cycle_where_sliding_is_unstable(
    largest: float, refused: bool, v_d: float, damped: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However close to the point of release it passes: no growth of a maximum shows it there."""
    cell = replace(CELL, v_d=v_d)
    assert (cell.effective_damping > 0.0) is damped
    monkeypatch.setattr(friction_cycles, "largest_after_release", lambda *_: largest)
    monkeypatch.setattr(friction_cycles, "cycle_turning_points", lambda *_: (-1.0, 2.0))
    monkeypatch.setattr(friction_cycles, "_grows", lambda *_: True)
    refusal = pytest.raises(ParameterError, match="slips all")
    with refusal if refused and not damped else nullcontext():
        friction_cycles.check_slip_cycles(cell, 1e-8)


def test_a_cell_of_stribeck_is_searched_for_cycles_that_slip_and_others_need_not_be(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    searched: list[FrictionCell] = []
    monkeypatch.setattr(friction, "check_slip_cycles", lambda cell, _: searched.append(cell))
    cells = [FrictionCell(law=law, v_d=1.0) for law in ("stribeck", "exponential")]
    for given in cells:
        friction_cell(given, 1e-8)
    assert searched == cells[:1]


@pytest.mark.parametrize("v_d", [5.0, 7.0, 20.0])
def test_without_damping_every_slip_gains_energy_however_little(v_d: float) -> None:
    """Of a fast belt less than rounding shows, which had passed for a stable cycle."""
    cell = FrictionCell(law="stribeck", xi=0.0, v_d=v_d)
    friction_cycles.check_slip_cycles(cell, 1e-8)
    speeds = np.concatenate([-np.geomspace(1e-3, 0.99, 50), np.geomspace(1e-3, 0.99, 50)]) * v_d
    drop = mp.mpf(cell.mu_st - cell.mu_d)
    for w in map(mp.mpf, speeds.tolist()):  # w (μ(v_d - w) - μ(v_d)), with digits enough
        with mp.workdps(800):
            gain = (
                w
                * drop
                * (mp.exp(-(((v_d - w) / cell.v_s) ** 2)) - mp.exp(-((v_d / cell.v_s) ** 2)))
            )
        assert gain > 0


def test_van_der_pol_cycles_tend_to_their_closed_forms_at_second_order() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.0)
    gaps = []
    for eps in (0.04, 0.02, 0.01):
        cell = vdp_cell(2.5, 0.5, eps, 1e-12)
        assert cell.stable_cycle.averaged == pytest.approx(chain.stable_amplitude, rel=1e-15)
        gaps.append(
            [
                cell.stable_cycle.amplitude - cell.stable_cycle.averaged,
                cell.unstable_cycle.amplitude - 2**0.5,
            ]
        )
    for ratio in (np.array(gaps[0]) / gaps[1], np.array(gaps[1]) / gaps[2]):
        # Second order in ε; the next term is of relative size ε².
        assert np.log2(ratio) == pytest.approx([2, 2], abs=0.02)
    beyond = vdp_cell(1.0, 0.2, 0.01, 1e-12)
    assert beyond.stable_cycle is None


def test_the_command_prints_the_documented_object(answered: Any) -> None:
    found = answered("cell friction --v-d 1.25")
    assert set(found) >= {
        "status", "steady_sliding", "effective_damping", "hopf_velocity", "cycle_end_velocity",
        "stable_cycle", "unstable_cycle", "basin", "error", "seconds",
    }  # fmt: skip
    keys = {"max", "min", "amplitude", "period", "stick_time"}
    for name in ("stable_cycle", "unstable_cycle"):
        cycle = found[name]
        assert isinstance(cycle, dict)
        assert set(cycle) >= keys
        assert cycle["amplitude"] == pytest.approx((cycle["max"] - cycle["min"]) / 2)
    free = answered("cell friction --v-d 1 --xi 0")
    assert free["hopf_velocity"] is None
    assert free["cycle_end_velocity"] is None
    assert free["basin"] is None
    assert answered("cell friction --v-d 2")["basin"] == [None, None]
    other = answered("cell vdp --a 2.5 --b 0.5")
    assert set(found) <= set(other)


@pytest.mark.parametrize("suffix", [".csv", ".png", ".svg"])
def test_diagrams_are_written_whole(suffix: str, tmp_path: Path) -> None:
    out = tmp_path / f"cell{suffix}"
    assert main(shlex.split(f"cell friction --v-d 1:2:5 --out {out}")) == 0
    assert [path.name for path in tmp_path.iterdir()] == [out.name]
    if suffix == ".csv":
        rows = [row for row in out.read_text().splitlines() if not row.startswith("#")]
        assert len(rows) == 6


@pytest.mark.parametrize(
    "line",
    [
        "friction --v-d 0", "friction --v-d -1", "friction --v-d nan",
        "friction --v-d 1 --mu-st 0.5", "friction --v-d 1 --mu-st 0.4", "friction --v-d 1 --v0 0",
        "friction --v-d 1 --xi -1", "friction --v-d 1 --a 2", "friction --v-d 0:2:5",
        "friction --v-d 1:2:2001", "friction --v-d 1 --out cell.png", "friction --v-d 200 --xi 0",
        "friction --v-d 1:2:3 --out /nowhere/cell.png", "vdp --a 1 --b 1 --v-d 1",
        "vdp --a -1 --b 1", "vdp --a 2.5 --b 0.5 --eps 0",
    ],
)  # fmt: skip
def test_bad_input_gets_one_sentence(line: str, refused: Any) -> None:
    refused(f"cell {line}")
