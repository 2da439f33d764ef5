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
from verification.references.switch_model import _Record, _right_side, _take_samples, run_switch
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
