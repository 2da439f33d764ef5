"""Claims about the switch model as printed, and regularised friction, beside event-exact runs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from benchmarks.regularised import Solver, run_regularised
from theory.cells.friction import FrictionCell
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError
from verification.cells.friction import stick_slip_cycle
from verification.references.switch_model import run_switch
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
