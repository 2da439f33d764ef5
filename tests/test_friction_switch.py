"""Claims about the switch model as printed, and regularised friction, beside event-exact runs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from benchmarks.regularised import Solver, run_regularised
from theory.cells.friction import FrictionCell
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError
from verification.cells.friction import stick_slip_cycle
from verification.references.switch_model import (
    _error_of_step,
    _Record,
    _right_side,
    _Rule,
    _take_samples,
    run_switch,
)
from verification.runs.excite import excite
from verification.runs.simulate import simulate

CHAIN = FrictionChain(c=0.02, sites=3)
ONE = FrictionChain(c=0.0, sites=1)


@cache
def start() -> np.ndarray:
    """Found by a run, and so not while tests are collected."""
    return excite(CHAIN, [1])


def test_the_switch_model_converges_with_the_first_power_of_the_band() -> None:
    """A site leaves stick with what is left of the band it came with: an error linear in it."""
    exact = simulate(CHAIN, start(), 50.0, tolerance=1e-12)
    errors = []
    for band in (1e-2, 1e-3, 1e-4):
        run = run_switch(CHAIN, start(), 50.0, band=band, relative=1e-9, absolute=1e-11)
        errors.append(np.abs(run.y - exact.y).max())
    orders = np.log10(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([1.0, 1.0], abs=0.1)


def test_the_period_of_the_switch_cell_is_short_in_proportion_to_the_band() -> None:
    """Theory: w decays from the band by e^{-stick}; what is left shortens the next slip.

    The slip from w = -ε e^{-T} instead of 0 and the entry at w = -ε are both linear in ε, so
    bands of both sizes give the same error per band.
    """
    cycle = stick_slip_cycle(FrictionCell())
    assert cycle is not None
    per_band = []
    for band in (4e-3, 1e-3):
        run = run_switch(
            ONE, np.array([[cycle.max], [0.0]]), 20 * cycle.period, band=band, relative=1e-9,
            absolute=1e-11, samples=100_001,
        )  # fmt: skip
        v = run.velocity[:, 0]
        k = np.flatnonzero((v[:-1] > 0) & (v[1:] <= 0))
        turns = run.times[k] + v[k] / (v[k] - v[k + 1]) * run.times[1]
        period = (turns[-1] - turns[9]) / (len(turns) - 10)
        per_band.append((period - cycle.period) / band)
    assert per_band[0] < 0
    # The next order in the band is a few per cent at 4e-3.
    assert per_band[0] == pytest.approx(per_band[1], rel=0.15)


def test_fixed_steps_converge_until_the_band_limits_them() -> None:
    exact = simulate(CHAIN, start(), 30.0, tolerance=1e-12)
    errors = [
        np.abs(run_switch(CHAIN, start(), 30.0, step=h, band=1e-6).y - exact.y).max()
        for h in (1e-1, 1e-2, 1e-3)
    ]
    # Jumps are not located, so the order is about one and not two.
    assert errors[0] > 5 * errors[1] > 25 * errors[2]


def test_on_smooth_motion_the_trapezoidal_rule_is_of_second_order() -> None:
    """No site sticks: started near steady sliding."""
    start = np.array([[0.8, 0.5, 0.5], [0.0, 0.0, 0.0]])
    exact = simulate(CHAIN, start, 20.0, tolerance=1e-13)
    errors = [
        np.abs(run_switch(CHAIN, start, 20.0, step=h).y - exact.y).max() for h in (0.04, 0.02, 0.01)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.02)


@pytest.mark.parametrize("band", [1e-2, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("step", [None, 0.01])
def test_every_band_gives_a_finite_run_or_stops_and_says_where(
    band: float, step: float | None
) -> None:
    run = run_switch(CHAIN, start(), 30.0, band=band, step=step)
    exact = simulate(CHAIN, start(), 30.0)
    assert np.isfinite(run.y).all()
    assert run.reached == 30.0
    # ode23t's default tolerances leave errors of a few hundredths, whatever the band.
    assert np.abs(run.y - exact.y).max() < 0.3
    assert run.unconverged > 0


@pytest.mark.parametrize("other", [{"law": "coulomb"}, {"law": "stribeck"}, {"viscous": 0.2}])
def test_other_laws_than_that_of_the_paper_are_refused(other: dict[str, Any]) -> None:
    chain = FrictionChain.of(FrictionCell(**other), c=0.02, sites=3)
    with pytest.raises(ParameterError, match="friction law"):
        run_switch(chain, start(), 1.0)


def test_mirror_symmetry_of_the_switch_model() -> None:
    chain = FrictionChain(c=0.05, sites=7)
    run = run_switch(chain, excite(chain, [4]), 30.0, step=0.01)
    assert np.abs(run.y - run.y[:, ::-1]).max() < 1e-9


def test_uniform_sliding_stays_in_the_switch_model() -> None:
    chain = FrictionChain(c=3.0, sites=5)
    start = np.array([np.full(5, chain.cell.steady_sliding), np.zeros(5)])
    run = run_switch(chain, start, 20.0, step=0.01)
    assert np.abs(run.y - chain.cell.steady_sliding).max() < 1e-12


@pytest.mark.parametrize("solver", list(Solver))
def test_regularised_friction_converges_with_its_width(solver: Solver) -> None:
    exact = simulate(CHAIN, start(), 12.0, tolerance=1e-12)
    errors = []
    for delta in (1e-1, 1e-2, 1e-3):
        y = run_regularised(CHAIN, start(), 12.0, solver=solver, delta=delta, tolerance=1e-8)
        errors.append(np.abs(y - exact.y).max())
    # Between first order and the logarithms that tanh's tail brings in.
    assert errors[0] > 4 * errors[1] > 16 * errors[2]


@pytest.mark.parametrize(
    "options",
    [
        {"band": 0.0}, {"band": -1.0}, {"step": 0.0}, {"step": 99.0}, {"relative": 0.0},
        {"samples": 1}, {"samples": 1_000_001},
    ],
)  # fmt: skip
def test_bad_options_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(ParameterError):
        run_switch(CHAIN, start(), 10.0, **options)


def test_the_steps_are_chosen_by_default_as_those_of_ode23t_are() -> None:
    default, explicit = (
        run_switch(CHAIN, start(), 10.0, **options)
        for options in ({}, {"relative": 1e-3, "absolute": 1e-6})
    )
    assert default.steps == explicit.steps
    assert np.array_equal(default.y, explicit.y)


@pytest.mark.parametrize(
    "options", [{"t_end": 0.0}, {"t_end": -1.0}, {"delta": 0.0}, {"tolerance": 0.2}]
)
def test_bad_options_of_a_regularised_run_are_refused(options: dict[str, float]) -> None:
    given: dict[str, Any] = {"t_end": 10.0, **options}
    (name,) = options
    with pytest.raises(ParameterError, match=name.removeprefix("t_")):
        run_regularised(CHAIN, start(), **given)


@pytest.mark.parametrize("ends", [Ends.FREE, Ends.LITERAL])
@pytest.mark.parametrize("mu_st", [0.7, 3.0])
def test_each_site_has_the_right_side_of_its_speed_and_load(ends: Ends, mu_st: float) -> None:
    """Slip, transition and stick in both directions, written out for each site; and both edges."""
    mu_d, v0, xi, v_d, c, band = 0.3, 0.5, 0.05, 1.25, 0.2, 0.125
    slips = np.array([-1.0, 0.5, 0.0625, -0.0625, 0.125, -0.125, 0.0, 2.0, -3.0, 0.0])
    y = np.array([0.3, -0.4, 0.5, 0.2, 4.0, -5.0, 0.6, 0.0, 6.0, -6.0])
    z, out = np.array([y, v_d + slips]), np.zeros((2, y.size))
    sticks = np.full(y.size, -1)
    compiled: Any = _right_side
    law = np.array([mu_st, mu_d, v0, xi, v_d, c, band])
    compiled.py_func(z, law, ends is Ends.FREE, out, sticks)
    beyond = np.array([y[0], *y, y[-1]]) if ends is Ends.FREE else np.array([0.0, *y, 0.0])
    load = 2.0 * xi * z[1] + y - c * np.diff(beyond, 2)
    kinds = []
    for n, slip in enumerate(slips):
        velocity, held = v_d + slip, abs(load[n]) <= mu_st
        if abs(slip) > band:
            friction = mu_d + (mu_st - mu_d) * np.exp(-abs(slip) / v0)
            expected = velocity, -np.sign(slip) * friction - load[n]
        elif held:
            expected = v_d, -slip
        else:
            expected = velocity, np.sign(load[n]) * mu_st - load[n]
        kinds.append(0 if abs(slip) > band else 1 if held else np.sign(load[n]) * 2)
        assert out[:, n] == pytest.approx(expected, abs=1e-14)
    assert set(kinds) == {0, 1, 2, -2}
    assert sticks.tolist() == [kind == 1 for kind in kinds]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_site_that_all_of_static_friction_can_hold_sticks(side: float) -> None:
    """And one unit in the last place beyond it does not."""
    mu_st, v_d = 0.7, 1.25
    z, out = np.array([side * mu_st * np.ones(2), [v_d, v_d]]), np.zeros((2, 2))
    z[0, 1] = side * np.nextafter(mu_st, 1.0)
    sticks = np.full(2, -1)
    compiled: Any = _right_side
    compiled.py_func(z, np.array([mu_st, 0.3, 0.5, 0.0, v_d, 0.0, 1e-4]), True, out, sticks)
    assert sticks.tolist() == [1, 0]
    assert out == pytest.approx(np.array([[v_d, v_d], [0.0, 0.0]]), abs=1e-15)


# Friction that does not vary, to 1e-14, and a belt that no site reaches: its motion is linear.
CONSTANT = FrictionCell(mu_st=1.0, mu_d=0.999999, v0=1e9, xi=0.1, v_d=10.0)


def trapezoid(z: np.ndarray, h: float) -> np.ndarray:
    """One step of the trapezoidal rule for a site that slips backwards under constant friction."""
    matrix = np.array([[0.0, 1.0], [-1.0, -2.0 * CONSTANT.xi]])
    ahead, behind = (np.eye(2) + part * h * matrix for part in (0.5, -0.5))
    return np.linalg.solve(behind, ahead @ z + h * np.array([0.0, CONSTANT.mu_st]))


@pytest.mark.parametrize("angle", [0.3, 0.8, 2.5, 4.0, 5.5])
def test_steps_of_linear_motion_are_those_of_the_trapezoidal_rule(angle: float) -> None:
    """Of fixed length, or five times longer each where every error is allowed, from 1e-4 on."""
    z = np.array([CONSTANT.mu_st + np.cos(angle), np.sin(angle)])
    longer = 1e-4 * 5.0 ** np.arange(5)
    for options, end, steps in (
        ({"step": 0.1}, 0.3, [0.1] * 3),
        ({"absolute": 1e6}, 0.2, [*longer, 0.2 - longer.sum()]),
    ):
        chain = FrictionChain.of(CONSTANT, c=0.0, sites=1)
        run = run_switch(chain, z[:, None], end, samples=2, **options)  # type: ignore[arg-type]
        expected = z
        for h in steps:
            expected = trapezoid(expected, h)
        assert (run.steps, run.rejected, run.unconverged) == (len(steps), 0, 0)
        assert [run.y[-1, 0], run.velocity[-1, 0]] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(("error", "rejected"), [(0.5, 0), (1.5, 1), (8.0, 1), (1e3, 2), (1e5, 3)])
def test_a_step_is_refused_until_its_error_is_allowed(error: float, rejected: int) -> None:
    """Its error goes with its cube, and is to be 0.9³; it becomes a fifth as long at most.

    That of the first step, 1e-4 long, is taken to be its length cubed times ÿ/12.
    """
    cell = FrictionCell(mu_st=1e3, mu_d=999.0, v0=1e9, xi=0.1, v_d=10.0)
    absolute = 1e-12 * cell.mu_st / 12.0 / error
    run = run_switch(
        FrictionChain.of(cell, c=0.0, sites=1), np.zeros((2, 1)), 1e-4, relative=1e-13,
        absolute=absolute,
    )  # fmt: skip
    assert run.rejected == rejected


def test_steps_are_as_many_as_the_third_derivatives_of_an_oscillation_ask_for() -> None:
    """Each errs by 0.9³ of what is allowed, in y or in its velocity, whichever errs more."""
    cell = FrictionCell(mu_st=1.0, mu_d=0.999999, v0=1e9, xi=0.0, v_d=10.0)
    start, end, absolute = np.array([[cell.mu_st + 1.0], [0.0]]), 2.0 * np.pi, 1e-9
    run = run_switch(
        FrictionChain.of(cell, c=0.0, sites=1), start, end, relative=1e-13, absolute=absolute
    )
    t = np.linspace(0.0, end, 10_001)
    third = np.maximum(np.abs(np.sin(t)), np.abs(np.cos(t)))
    expected = end * np.mean((third / (12.0 * absolute)) ** (1.0 / 3.0)) / 0.9
    assert run.steps == pytest.approx(expected, rel=0.01)
    assert run.rejected == 0


def test_the_error_of_a_step_is_that_of_its_third_derivative() -> None:
    """Of cubics, whose third derivative is the same everywhere."""
    rng, sites = np.random.default_rng(7), 2
    compiled: Any = _error_of_step
    for _ in range(30):
        motions = [np.polynomial.Polynomial(rng.standard_normal(4)) for _ in range(2 * sites)]
        past, h, absolute, relative = rng.uniform(0.1, 0.5, 4)

        def at(time: float, order: int, motions: list[Any] = motions) -> np.ndarray:
            return np.array([(m.deriv(order) if order else m)(time) for m in motions])

        rule = _Rule(np.zeros(7), True, 1.0, 0.0, relative, absolute)
        ends = [tuple(at(time, order).reshape(2, sites) for time in (0.0, h)) for order in (0, 1)]
        found = compiled.py_func(rule, ends[0], at(-past, 1).reshape(2, sites), ends[1], (past, h))
        size = absolute + relative * np.maximum(np.abs(at(0.0, 0)), np.abs(at(h, 0)))
        assert found == pytest.approx(np.max(np.abs(at(0.0, 3)) * h**3 / 12.0 / size), rel=1e-9)


def test_a_last_step_shorter_than_the_shortest_is_taken() -> None:
    """The first step is 1e-4, as long as the motion near steady sliding allows more."""
    chain = FrictionChain(c=0.02, sites=3)
    start = np.array([np.full(3, chain.cell.steady_sliding + 0.01), np.zeros(3)])
    end = 1e-4 + 5e-13
    assert run_switch(chain, start, end).reached == end


def test_samples_within_a_step_are_those_of_the_cubic_through_both_ends() -> None:
    """A cubic is its own; samples before the step are taken already, those beyond it are not yet.

    At the last step all that remain are taken, at its end.
    """
    rng, sites, (t, h) = np.random.default_rng(5), 3, (1.5, 0.5)
    motions = [np.polynomial.Polynomial(rng.standard_normal(4)) for _ in range(2 * sites)]

    def states(time: float, order: int) -> np.ndarray:
        values = [(motion.deriv(order) if order else motion)(time) for motion in motions]
        return np.array(values).reshape(2, sites)

    times = np.array([0.3, 1.5, 1.6, 1.85, 2.0, 2.001])
    compiled: Any = _take_samples
    for last, taken in ((False, 5), (True, 6)):
        kept = np.zeros((times.size, 2, sites))
        counters = np.array([0, 0, 0, 1])
        record = _Record(times, kept, np.zeros(sites), counters)
        ends = [(states(t, order), states(t + h, order)) for order in (0, 1)]
        compiled.py_func(record, ends[0], ends[1], (t, h), last)
        assert counters.tolist() == [0, 0, 0, taken]
        for n in range(1, taken):
            assert kept[n] == pytest.approx(states(min(times[n], t + h), 0), abs=1e-13)
        assert not kept[0].any()
        assert not kept[taken:].any()


def test_a_site_arrives_as_it_first_sticks() -> None:
    """One sticks at the start, one slides steadily, and static friction brings one to the band."""
    cell, speed, band = FrictionCell(), 1e-2, 1e-4
    start = np.array([[0.0, cell.steady_sliding, 0.0], [cell.v_d, 0.0, cell.v_d - speed]])
    start[0, 2] = -2.0 * cell.xi * cell.v_d
    run = run_switch(FrictionChain(c=0.0, sites=3), start, 0.02, step=1e-5, band=band)
    assert run.arrivals[:2].tolist() == pytest.approx([0.0, np.nan], nan_ok=True)
    # Friction is lower by up to speed/v₀ times half of itself, and the spring pulls with v_d τ.
    assert run.arrivals[2] == pytest.approx((speed - band) / cell.mu_st, rel=0.02)
