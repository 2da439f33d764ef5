"""One cell of one's own: published cycles, those of (8), and what scipy says of any other."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import fields, replace
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import Any

import numba
import numpy as np
import pytest
from scipy.integrate import ode, solve_ivp
from scipy.special import ai_zeros

from fronts.cli import main
from tests.reference_runs import states_by_scipy
from theory.cells.compiled_cell import CompiledCell, compiled_cell
from theory.cells.oscillator import OscillatorCell, OscillatorCycle
from theory.cells.polynomial import read_polynomial
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.cells import oscillator, shooting
from verification.cells.cell import cell
from verification.cells.result import Cell, CellCycle, CellStatus, OwnCell
from verification.cells.shooting import longest_step
from verification.cells.vdp import averaged_cell, vdp_cell
from verification.references.equations import damping
from verification.references.network import oscillator_rate

PERIOD, AMPLITUDE = 6.663286859323130, 2.008619860874843
"""Of the cycle of Van der Pol at ε = 1: P. Amore, Computing the solutions of the van der Pol
equation to arbitrary precision, arXiv:2111.12198."""


@numba.njit
def hardening(y, k):  # type: ignore[no-untyped-def]
    return np.sinh(k * y) / k


@cache
def exact_cell(chain: Any) -> Any:
    return cell(chain, tolerance=1e-13)


def own(**changes: Any) -> OwnCell:
    found = cell(OscillatorChain(**{"c": 0.0, **changes}))
    assert isinstance(found, OwnCell)
    return found


def test_the_cycle_of_van_der_pol_is_the_published_one() -> None:
    found = own(damping="y**2 - 1", eps=1.0)
    assert found.status is CellStatus.OSCILLATION
    assert found.basin is None
    assert abs(found.stable_cycle.period - PERIOD) <= found.error < 1e-9
    assert abs(found.stable_cycle.max - AMPLITUDE) <= found.error
    assert abs(found.stable_cycle.min + AMPLITUDE) <= found.error


@pytest.mark.parametrize("size", [1e-6, 1e6])
def test_a_cycle_scales_with_the_displacement_at_which_its_damping_ends(size: float) -> None:
    found = own(damping="k*y**2 - 1", values={"k": size**-2}, eps=1.0).stable_cycle
    assert found.max / size == pytest.approx(AMPLITUDE, rel=1e-10)
    assert found.period == pytest.approx(PERIOD, rel=1e-10)


def test_a_cell_without_cycles_rests_from_everywhere_without_error() -> None:
    found = own(damping=1, stiffness="y", eps=0.1)
    assert (found.status, found.cycles, found.error) == (CellStatus.REST, (), 0.0)
    assert found.steady_sliding is None
    assert found.basin == (-np.inf, np.inf)


@pytest.mark.parametrize("tolerance", [1e-12, 1e-7])
@pytest.mark.parametrize(
    ("text", "h", "by_v"),
    [
        ("y**2 - 1", lambda y, v: y**2 - 1.0, lambda y, v: y**2 - 1.0),
        ("v**4 - 1", lambda y, v: v**4 - 1.0, lambda y, v: 5.0 * v**4 - 1.0),
        (
            "y**2 + y*v + v**4 - 1",
            lambda y, v: y**2 + y * v + v**4 - 1.0,
            lambda y, v: y**2 + 2.0 * y * v + 5.0 * v**4 - 1.0,
        ),
    ],
)
def test_a_multiplier_is_what_the_damping_leaves_of_a_deviation_in_a_turn(
    text: str, h: Any, by_v: Any, tolerance: float
) -> None:
    """Liouville: the Floquet multiplier of a cycle is exp(-ε ∮ ∂(hẏ)/∂ẏ dt)."""
    eps, chain = 0.5, OscillatorChain(damping=text, c=0.0, eps=0.5)
    found, exact = cell(chain, tolerance=tolerance).stable_cycle, exact_cell(chain).stable_cycle
    rate = oscillator_rate(lambda y: y, h, np.zeros((1, 1)), c=0.0, eps=eps)
    times = np.linspace(0.0, exact.period, 4001)
    y, v = states_by_scipy(rate, np.array([exact.max, 0.0]), times).T
    lost = eps * float(np.mean(by_v(y, v)[:-1])) * exact.period  # the mean over a period
    off = abs(found.multiplier - np.exp(-lost))
    assert off <= found.multiplier_error < 1e4 * tolerance


@pytest.mark.parametrize("tolerance", [1e-2, 1e-14])
def test_a_tolerance_that_the_errors_are_not_stated_for_is_refused(tolerance: float) -> None:
    chains = OscillatorChain(damping="y**2 - 1", c=0.0), VdpChain(a=2.5, b=0.5, c=0.0)
    for chain in chains:
        with pytest.raises(ParameterError, match="tolerance"):
            cell(chain, tolerance=tolerance)


def test_the_cell_of_van_der_pol_is_found_for_eps_from_1e_4_to_one() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.0, eps=1e-4)
    assert cell(chain, tolerance=1e-6).stable_cycle is not None
    for eps in (0.999e-4, 1.001):
        with pytest.raises(ParameterError, match="eps"):
            cell(replace(chain, eps=eps), tolerance=1e-6)


def test_the_usual_tolerance_gives_cycles_to_eight_digits() -> None:
    assert cell(VdpChain(a=2.5, b=0.5, c=0.0, eps=0.1)).error < 1e-8


def test_the_cycle_of_rayleigh_has_the_published_period_of_van_der_pol() -> None:
    """The velocity of ẍ + ε(ẋ²/3 - 1)ẋ + x = 0 obeys the equation of Van der Pol."""
    found = own(damping="v**2/3 - 1", eps=1.0).stable_cycle
    assert abs(found.period - PERIOD) <= found.error


def test_the_cell_of_the_paper_as_text_is_the_built_in_one() -> None:
    ours = own(damping="1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5})
    theirs = cell(VdpChain(a=4, b=0.5, c=0.0))
    assert ours.status is theirs.status is CellStatus.BISTABLE
    for one, other in (
        (ours.stable_cycle, theirs.stable_cycle),
        (ours.unstable_cycle, theirs.unstable_cycle),
    ):
        assert one is not None
        assert other is not None
        for name in ("max", "min", "period"):
            assert abs(getattr(one, name) - getattr(other, name)) <= one.error + other.error
        assert one.averaged == pytest.approx(other.averaged, rel=1e-14)
    assert ours.basin == pytest.approx(theirs.basin, abs=1e-9)


def test_all_cycles_of_a_cell_with_three_close_in_scipy_and_alternate() -> None:
    found = own(damping="0.005*y**6 - 0.144*y**4 + y**2 - 1", eps=0.1)
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 0.005 * y**6 - 0.144 * y**4 + y**2 - 1.0, np.zeros((1, 1)), c=0.0,
        eps=0.1,
    )  # fmt: skip
    assert len(found.cycles) == 3
    assert [each.multiplier < 1.0 for each in found.cycles if each.multiplier] == [
        True, False, True,
    ]  # fmt: skip
    assert (found.status, found.basin) == (CellStatus.CYCLES, None)
    assert found.stable_cycle is found.cycles[2]
    assert found.unstable_cycle is found.cycles[1]
    for each in found.cycles:
        start, times = np.array([each.max, 0.0]), np.array([0.0, each.period])
        back = states_by_scipy(rate, start, times, 1e-13)[-1]
        assert np.abs(back - start).max() <= 3.0 * each.error  # what is off grows in the turn


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize(
    "chain",
    [
        VdpChain(a=2.5, b=0.5, c=0.0, eps=0.1),
        VdpChain(a=2.5, b=0.5, c=0.0, eps=0.01),
        OscillatorChain(damping="v**4 - 1", c=0.0, eps=0.1),
    ],
    ids=["eps 0.1", "eps 0.01", "own"],
)
def test_the_stated_errors_bound_the_true_ones_at_every_tolerance(
    chain: Any, tolerance: float
) -> None:
    """Also where the longest step, and no tolerance, limits the steps of a smooth motion."""
    exact, rough = exact_cell(chain), cell(chain, tolerance=tolerance)
    for ours, true in (
        (rough.stable_cycle, exact.stable_cycle),
        (rough.unstable_cycle, exact.unstable_cycle),
    ):
        if true is not None:
            assert ours is not None
            for name in ("max", "min", "period"):
                gap = abs(getattr(ours, name) - getattr(true, name))
                assert gap <= ours.error + true.error


@pytest.mark.parametrize(
    ("damping", "eps", "count", "side"),
    [("y*v + y**2 - 1", 0.3, 1, -1), ("0.005*v**6 - 0.144*v**4 + v**2 - 1", 0.1, 3, 1)],
)
def test_cycles_are_found_on_either_side_of_their_limits(
    damping: str, eps: float, count: int, side: int
) -> None:
    """Smaller or larger than as ε → 0, the one between two others as well: they close in scipy."""
    found = cell(OscillatorChain(damping=damping, c=0.0, eps=eps), tolerance=1e-9)
    assert isinstance(found, OwnCell)
    assert len(found.cycles) == count

    def damped(y: Any, v: Any) -> Any:
        return eval(damping, {"y": y, "v": v})

    rate = oscillator_rate(lambda y: y, damped, np.zeros((1, 1)), c=0.0, eps=eps)
    for each in found.cycles:
        assert side * (each.max - each.averaged) > 1e-4
        start = np.array([each.max, 0.0])
        back = states_by_scipy(rate, start, np.array([0.0, each.period]), 1e-12)[-1]
        assert np.abs(back - start).max() <= 3.0 * each.error  # what is off grows in the turn


@pytest.mark.parametrize("at", [0, 1, 2])
def test_a_cycle_is_looked_for_between_those_beside_it(at: int) -> None:
    """On both sides of its limit, which here are smaller than the cycles, the middle one's too."""
    chain = OscillatorChain(damping="0.005*v**6 - 0.144*v**4 + v**2 - 1", c=0.0, eps=0.1)
    limits = [each.amplitude for each in chain.cell.cycles]
    found, _ = shooting._closed_turn(chain.cell, chain.eps, at, 1e-6, limits[at])
    assert limits[at] < found.top < 1.05 * limits[at]


def _limit(amplitude: float, velocity: float, frequency: float) -> Any:
    period = 2.0 * np.pi / frequency
    return SimpleNamespace(amplitude=amplitude, velocity=velocity, period=period)


def test_the_stiffness_of_a_cycle_is_taken_along_it() -> None:
    """Where y is largest v is zero: of a damping yv the largest is half of both sizes."""
    cell: Any = SimpleNamespace(damping_at=lambda y, v: y * v)
    for share, frequency in ((0.99, 1.0), (0.99, 1e6), (1.01, 1.0), (1.01, 1e-6)):
        limit = _limit(2.0, 3.0, frequency)
        eps = share * frequency * shooting._STIFFEST / 3.0
        with nullcontext() if share < 1.0 else pytest.raises(ParameterError, match="at most 300"):
            # To the sampling of the angle.
            assert shooting._stiffness(cell, eps, limit) == pytest.approx(297.0, rel=1e-3)
    # Of either sign, where all of it has one.
    for sign in (-1.0, 1.0):
        single: Any = SimpleNamespace(damping_at=lambda y, _, sign=sign: sign * (1.0 + y * y))
        strength, both = shooting._strength(single, 0.1, _limit(2.0, 3.0, 1.0))
        assert (strength, both) == (pytest.approx(0.5), False)
    cell.cycles = (_limit(1.0, 1.0, frequency), limit)
    with pytest.raises(ParameterError, match="at most 300"):  # before any turn is taken
        shooting.shot_cycles(cell, eps, 1e-9)


@pytest.mark.parametrize("rests", [True, False])
@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_turn_that_does_not_fit_the_cycles_found_is_refused(
    factor: float, rests: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a cycle motion decays if rest is stable, and grows if it is not."""
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -1.0, (2, 0): 1.0})
    monkeypatch.setattr(shooting, "_turn", lambda _, __, y, *___: SimpleNamespace(top=factor * y))
    fits = rests is (factor < 1.0)
    word = "decays" if factor < 1.0 else "grows"
    with nullcontext() if fits else pytest.raises(ParameterError, match=word):
        shooting.check_turns(cell, 0.1, (), rests)


def test_the_error_of_a_cycle_on_which_all_tolerances_agree_is_rounding_of_its_period(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    period = 1e6
    turn = SimpleNamespace(top=1.0, bottom=-1.0, period=period, exponent=-0.1)
    monkeypatch.setattr(shooting, "_closed_turn", lambda *_: (turn, 0.0))
    cell: Any = SimpleNamespace(cycles=(OscillatorCycle(1.0, 1.0, period, stable=True),))
    assert shooting._cycle(cell, 0.1, 0, 1e-9).error >= np.finfo(float).eps * period


def test_motion_that_turns_back_only_once_makes_no_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    swings = iter([shooting._Swing(-1.0, 3.0, 0.0), None])
    monkeypatch.setattr(shooting, "_swing", lambda *_: next(swings))
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): 1.0})
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, stable=True)
    assert shooting._turn(cell, 0.1, 1.0, limit, 1e-9) is None


def test_a_coarser_turn_takes_larger_differences_as_it_takes_longer_steps() -> None:
    shifts: list[float] = []
    cell: Any = SimpleNamespace(force=lambda _, __, ___, shift: shifts.append(shift) or (0.0, 0.0))
    limit: Any = SimpleNamespace(amplitude=1.0, velocity=1.0, period=6.0, stable=True)
    for tolerance in (1e-12, 1e-4):
        shooting._solver(cell, 0.1, limit, tolerance, 1.0).f(0.0, np.zeros(3))
    assert shifts[1] / shifts[0] == pytest.approx(longest_step(1e-4) / longest_step(1e-12))
    assert shifts[1] > 5.0 * shifts[0]


@pytest.mark.parametrize("stable", [True, False])
def test_a_turn_of_a_linear_cell_is_the_one_in_closed_form(stable: bool) -> None:
    """ÿ + εẏ + y = 0, forwards or backwards in time: y decays or grows by half of the exponent."""
    eps, sense = 0.5, -1.0 if stable else 1.0
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): 1.0})
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, stable)
    found = shooting._turn(cell, eps, 3.0, limit, 1e-12)
    assert found is not None
    period = 2.0 * np.pi / np.sqrt(1.0 - 0.25 * eps**2)
    part = np.exp(0.5 * sense * eps * period)
    expected = (3.0 * part, -3.0 * np.sqrt(part), period, sense * eps * period, part)
    got = (found.top, found.bottom, found.period, found.exponent, found.slope)
    assert got == pytest.approx(expected, rel=1e-11)  # some ten steps at 1e-12


@pytest.mark.parametrize(("eps", "start"), [(3.0, 1.0), (3.0, -1.0), (0.1, 1e300)])
def test_motion_that_creeps_to_rest_or_overflows_does_not_turn(eps: float, start: float) -> None:
    """At ε > 2 rest is a node; at 1e300 the damping is infinite."""
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): 1.0, (2, 0): 1e-300})
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, True)
    assert shooting._turn(cell, eps, start, limit, 1e-9) is None


def test_motion_that_creeps_to_rest_after_it_has_turned_back_once_does_not_turn_twice() -> None:
    """ÿ + 3(1 - y)ẏ + y = 0: rest is a node, to which motion from y > 1 comes from beyond."""
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): 3.0, (1, 0): -3.0})
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, True)
    down = shooting._swing(cell, 1.0, 2.0, limit, 1e-9)
    assert down is not None
    assert -math.inf < down.y < 0.0
    assert shooting._turn(cell, 1.0, 2.0, limit, 1e-9) is None


def test_motion_that_is_infinite_after_a_finite_time_has_no_top() -> None:
    """ÿ + ẏ² + y = 0: u = ẏ² obeys du/dy + 2u = -2y, and does not return to zero from y > 1/2.

    Then ẏ becomes infinite as the inverse of the time that is left, and y as its logarithm.
    """
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 1): 1.0})
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, True)
    turn = shooting._turn(cell, 1.0, 0.6, limit, 1e-9)
    assert turn is not None
    assert turn.top == math.inf
    returning = shooting._swing(cell, 1.0, 0.4, limit, 1e-9)
    assert returning is not None
    y = returning.y  # where u = ½ - y - (½ - 0.4) exp(2(0.4 - y)) is zero again
    assert 0.5 - y - 0.1 * math.exp(2.0 * (0.4 - y)) == pytest.approx(0.0, abs=1e-8)


def test_a_coarser_search_takes_larger_differences_by_the_eighth_root_of_the_tolerance() -> None:
    steps: list[float] = []
    cell: Any = SimpleNamespace(force=lambda y, v, eps, step: (steps.append(step), (y, 0.0))[1])
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, True)
    for tolerance in (1e-12, 1e-4):
        run = shooting._solver(cell, 0.1, limit, tolerance, 1.0)
        run.set_initial_value([1.0, 0.0, 0.0]).integrate(1.0)
    assert max(steps) == pytest.approx(10.0 * min(steps))
    assert steps[0] == min(steps) < max(steps) == steps[-1]


def test_a_relaxation_oscillation_is_as_accurate_where_it_is_small() -> None:
    """Its steps are limited by their errors, which are relative to its size."""
    found = []
    for size in (1.0, 1e-6):
        cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -1.0, (2, 0): size**-2})
        (cycle,) = shooting.shot_cycles(cell, 10.0, 1e-9)
        found.append((cycle.max / size, cycle.period))
    assert found[1] == pytest.approx(found[0], rel=1e-9)


def test_the_error_of_a_cycle_is_no_less_than_the_rounding_of_its_period(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    turn = shooting._Turn(top=1.0, bottom=-1.0, period=1e3, exponent=-1.0, slope=0.5)
    monkeypatch.setattr(shooting, "_closed_turn", lambda *_: (turn, 0.0))
    limit = OscillatorCycle(1.0, 1.0, 1e3, True)
    found = shooting._cycle(SimpleNamespace(cycles=[limit]), 0.1, 0, 1e-9)  # type: ignore[arg-type]
    assert np.finfo(float).eps * 1e3 < found.error < 1e-8


@pytest.mark.parametrize("start", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize("frequency", [1.0, 0.1])
def test_motion_without_bound_has_no_top(start: float, frequency: float) -> None:
    """It grows as exp(2.6ωt), and ẏ is 2.6ω times y: its velocity is less than y if it is slow."""
    cell = OscillatorCell(stiffness={1: frequency**2}, damping={(0, 0): 1.0})
    limit = OscillatorCycle(1.0, frequency, 2.0 * np.pi / frequency, True)
    turn = shooting._turn(cell, -3.0 * frequency, start, limit, 1e-9)
    assert turn is not None
    assert turn.top == turn.slope == math.inf


def test_motion_too_stiff_for_its_steps_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the 1000th step on scipy stops where stability limits them: each time it is resumed."""
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): 1.0})
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, True)
    monkeypatch.setattr(shooting, "_MAX_STEPS", 2500)
    asked: list[float] = []
    force = cell.force
    monkeypatch.setattr(
        OscillatorCell, "force",
        lambda _, y, v, eps, step: (asked.append(y), force(y, v, eps, step))[1],
    )  # fmt: skip
    assert shooting._turn(cell, 1e4, 1.0, limit, 1e-6) is None
    assert 1000 * 12 < len(asked) < 2500 * 24  # of 12 stages; at most every second is rejected


@pytest.mark.parametrize("ahead", [0.5, 2.0])
def test_a_jump_of_the_map_of_maxima_is_no_cycle(
    ahead: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It passes over the line on which a turn ends where it begins, from either side."""
    monkeypatch.setattr(
        shooting, "_turn",
        lambda _, __, y, *___: SimpleNamespace(
            top=y * (ahead if y < 1.00003 else 1.0 / ahead), slope=0.0
        ),
    )  # fmt: skip
    limits = (SimpleNamespace(amplitude=1.0, period=6.0),)
    cell: Any = SimpleNamespace(cycles=limits)
    with pytest.raises(ParameterError, match="so small that averaging"):
        shooting._closed_turn(cell, 0.1, 0, 1e-9, 1.0)


def test_the_innermost_cycle_is_found_however_small_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From far outside, motion is not bounded."""
    true = 1.01e-3
    monkeypatch.setattr(
        shooting, "_turn",
        lambda _, __, y, *___: SimpleNamespace(
            top=np.sqrt(y * true), slope=0.5 * np.sqrt(true / y)
        ) if y < 0.1 else None,
    )  # fmt: skip
    cell: Any = SimpleNamespace(cycles=(SimpleNamespace(amplitude=1e-3, period=6.0),))
    found, error = shooting._closed_turn(cell, 0.1, 0, 1e-9, 1e-3)
    assert found.top == pytest.approx(true, rel=1e-12)
    assert error < 1e-14 * true


def _made_turns(monkeypatch: pytest.MonkeyPatch, cycles: tuple[float, ...], slope: float) -> None:
    """Let the map of maxima have these fixed points, attracting and not, with exact errors.

    Backwards in time the others attract.
    """

    def turn(_: object, __: float, y: float, limit: Any, tolerance: float) -> Any:
        passed = next((at for at, each in enumerate(cycles) if y < each * 1.04), len(cycles) - 1)
        near = cycles[passed] + 1e3 * tolerance
        there = 1.0 / slope if limit.stable == (passed % 2 == 0) else slope
        return shooting._Turn(
            top=near + there * (y - near), bottom=-0.5 * y, period=limit.period + 1e4 * tolerance,
            exponent=np.log(there) + 1e5 * tolerance, slope=there,
        )  # fmt: skip

    monkeypatch.setattr(shooting, "_turn", turn)


@pytest.mark.parametrize("at", [0, 1, 2])
def test_a_cycle_of_a_map_that_is_known_has_its_multiplier_and_its_error(
    at: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Fixed points a per cent below or above their limits: each is found for its own.

    Of the errors in proportion to the tolerance, that of the period is the largest.
    """
    limits = tuple(
        SimpleNamespace(amplitude=y, period=6.0, stable=stable)
        for y, stable in ((1.0, True), (1.07, False), (1.145, True))
    )
    cell: Any = SimpleNamespace(cycles=limits)
    true = (1.01, 1.06, 1.155)
    _made_turns(monkeypatch, true, 3.0)
    found = shooting._cycle(cell, 0.1, at, 1e-9)
    assert found.max == pytest.approx(true[at] + 1e-6, abs=1e-12)
    assert found.min == pytest.approx(-0.5 * found.max)
    multiplier = (1.0 / 3.0, 3.0, 1.0 / 3.0)[at]
    assert found.multiplier == pytest.approx(multiplier, rel=2e-4)
    # Of exponents that are apart by a hundredth: to first order.
    assert found.multiplier_error == pytest.approx(99.0 * 1e5 * 1e-9 * multiplier, rel=1e-2)
    assert found.error == pytest.approx(99.0 * 1e4 * 1e-9, rel=1e-6)


def test_a_fixed_point_that_motion_leaves_is_not_the_cycle_that_it_leads_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Newton's method would go back to the first; motion goes on to the second."""
    left, reached = 1.0, 1.2

    def turn(_: object, __: float, y: float, *___: object) -> Any:
        near, slope = (left, 1.5) if y < 1.1 else (reached, 0.5)
        return SimpleNamespace(top=near + slope * (y - near), slope=slope)

    monkeypatch.setattr(shooting, "_turn", turn)
    cell: Any = SimpleNamespace(cycles=(SimpleNamespace(amplitude=1.05, period=6.0),))
    found, _ = shooting._closed_turn(cell, 0.1, 0, 1e-9, 1.05)
    assert found.top == pytest.approx(reached, abs=1e-12)


def test_a_cycle_is_searched_for_until_its_corrections_are_those_of_rounding(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Turns that decay by a thousandth, and err by 1e-11 up and down: a correction of 1e-8."""
    true, errors = 1.0, iter([1e-11, -1e-11] * 50)

    def turn(_: object, __: float, y: float, *___: object) -> Any:
        return SimpleNamespace(top=true + 0.999 * (y - true) + next(errors), slope=0.999)

    monkeypatch.setattr(shooting, "_turn", turn)
    cell: Any = SimpleNamespace(cycles=(SimpleNamespace(amplitude=1.0, period=6.0),))
    found, left = shooting._closed_turn(cell, 0.1, 0, 1e-9, true + 1e-7)
    assert abs(found.top - true) <= 2.0 * left < 1e-7


def test_cycles_are_shot_to_a_tolerance_in_proportion_to_a_weak_damping(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """On the circle of radius 2 the largest of |y² - 1| is 3."""
    asked: list[float] = []
    monkeypatch.setattr(shooting, "_cycle", lambda *given: asked.append(given[-1]))
    van_der_pol = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -1.0, (2, 0): 1.0})
    strengths = (1.5, 3e-2, 3e-6)
    for strength in strengths:
        shooting.shot_cycles(van_der_pol, strength / 3.0, 1e-9)
    assert asked == pytest.approx([1e-9, 3e-11, shooting.TOLERANCES.low], rel=1e-6)


def test_motion_that_is_followed_on_where_it_is_stiff_is_followed_as_long() -> None:
    """In units of time in which a turn is long as well."""
    asked: list[float] = []

    class Run:
        def set_solout(self, _: object) -> None: ...

        def set_initial_value(self, _: object) -> Run:
            return self

        def integrate(self, until: float) -> None:
            asked.append(until)

        def get_return_code(self) -> int:
            return shooting._STIFF if len(asked) < 3 else 1

    run: Any = Run()
    shooting._path(run, 1.0, OscillatorCycle(1.0, 0.01, 600.0, True), pull=1.0)
    assert len(asked) == 3
    assert min(asked) > 10.0 * 600.0


def test_motion_that_has_come_to_rest_to_underflow_has_not_turned_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    states = [(float(n), np.array([y, v, 0.0])) for n, (y, v) in enumerate(
        ((1.0, 0.0), (1e-170, -1e-170), (1e-180, -1e-180)))]  # fmt: skip
    monkeypatch.setattr(shooting, "_path", lambda *_, **__: states)
    monkeypatch.setattr(shooting, "_solver", lambda *_: SimpleNamespace(get_return_code=lambda: 1))
    cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): 1.0})
    limit = OscillatorCycle(1.0, 1.0, 2.0 * np.pi, True)
    assert shooting._swing(cell, 3.0, 1.0, limit, 1e-9) is None


def test_a_turn_is_as_accurate_in_other_units_of_displacement_and_time() -> None:
    """Of the cell of Van der Pol with y/s and ωt, to ten times the tolerance."""
    found = []
    for size, frequency in ((1.0, 1.0), (1e-3, 1.0), (1.0, 1e6)):
        cell = OscillatorCell(stiffness={1: frequency**2}, damping={(0, 0): -1.0, (2, 0): size**-2})
        limit = OscillatorCycle(size, size * frequency, 2.0 * np.pi / frequency, True)
        turn = shooting._turn(cell, 0.5 * frequency, 2.1 * size, limit, 1e-9)
        assert turn is not None
        found.append((turn.top / size, turn.bottom / size, turn.period * frequency))
    assert found[1] == pytest.approx(found[0], rel=1e-8)
    assert found[2] == pytest.approx(found[0], rel=1e-8)


@pytest.mark.parametrize(
    ("rests", "stable", "status"),
    [
        (True, 0, CellStatus.REST), (True, 1, CellStatus.BISTABLE),
        (True, 2, CellStatus.MULTISTABLE), (False, 1, CellStatus.OSCILLATION),
        (False, 2, CellStatus.CYCLES), (False, 3, CellStatus.CYCLES),
    ],
)  # fmt: skip
def test_the_status_of_a_cell_says_how_many_cycles_are_stable_and_whether_rest_is(
    rests: bool, stable: int, status: CellStatus
) -> None:
    assert oscillator._status(rests, stable) is status


def test_motion_leads_on_where_newton_s_method_would_leave_the_side_of_a_cycle(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def turn(_: object, __: float, y: float, *___: object) -> Any:
        if y > 0.9:  # the step would be five
            return SimpleNamespace(top=y - 0.05, slope=0.99)
        return SimpleNamespace(top=0.8 + 0.5 * (y - 0.8), slope=0.5)

    monkeypatch.setattr(shooting, "_turn", turn)
    cell: Any = SimpleNamespace(cycles=(SimpleNamespace(amplitude=1.0, period=6.0),))
    found, _ = shooting._closed_turn(cell, 0.1, 0, 1e-9, 1.0)
    assert found.top == pytest.approx(0.8, abs=1e-12)


@pytest.mark.parametrize(("limits", "at"), [((1.0, 1.02), 1), ((1.03, 1.05), 0)])
def test_a_cycle_far_from_its_limit_is_looked_for_on_its_side_of_the_next(
    limits: tuple[float, float], at: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between twice the distances of both limits, where the map has both cycles or none."""
    true = (1.0, 1.05)
    _made_turns(monkeypatch, true, 3.0)
    cell: Any = SimpleNamespace(
        cycles=[
            SimpleNamespace(amplitude=limit, period=6.0, stable=stable)
            for limit, stable in zip(limits, (True, False), strict=True)
        ]
    )
    found, _ = shooting._closed_turn(cell, 0.1, at, 1e-9, limits[at])
    assert found.top == pytest.approx(true[at], abs=2e-6)


@pytest.mark.parametrize(
    ("damping", "status", "stable", "unstable"),
    [
        ("y**2 - 1", CellStatus.OSCILLATION, 0, None),
        ("1 - y**2 + 0.1*y**4", CellStatus.BISTABLE, 1, 0),
        # At rest without linear damping: the next term decides.
        ("y**2 - y**4 + 0.1*y**6", CellStatus.BISTABLE, 1, 0),
        ("y**4 - y**2", CellStatus.OSCILLATION, 0, None),
        ("-1 + 3*y**2 - y**4 + y**6/20", CellStatus.CYCLES, 2, 1),
        (
            "1 - 5.6944*y**2 + 3.7917*y**4 - 0.66667*y**6 + 0.031746*y**8",
            CellStatus.MULTISTABLE,
            1,
            0,
        ),
    ],
)
def test_rest_is_stable_as_small_motions_are_damped_or_not(
    damping: str, status: CellStatus, stable: int, unstable: int | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(
        shooting, "_cycle",
        lambda of, _, at, __: SimpleNamespace(at=at, error=0.0, max=of.cycles[at].amplitude),
    )  # fmt: skip
    chain = OscillatorChain(damping=damping, stiffness="y", eps=0.1, c=0.0)
    found: Any = cell(chain)
    assert found.status is status
    assert found.stable_cycle.at == stable
    assert (found.unstable_cycle and found.unstable_cycle.at) == unstable
    assert chain.cell.cycles[stable].amplitude == chain.stable_amplitude
    assert status is not CellStatus.CYCLES or found.basin is None


@pytest.mark.parametrize(
    ("damping_at_rest", "limits", "rests", "named"),
    [
        (0.5, "us", True, (1, 0)),
        (-0.5, "s", False, (0, None)),
        (0.0, "us", True, (1, 0)),
        (0.0, "s", False, (0, None)),
        (-0.5, "sus", False, (2, 1)),
        (0.5, "usus", True, (1, 0)),
    ],
)
def test_of_several_cycles_those_are_named_between_which_rest_ends(
    damping_at_rest: float, limits: str, rests: bool, named: tuple[int, int | None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Of made-up cycles, stable or unstable in turn: they are checked with rest as it is."""
    cycles = tuple(range(len(limits)))
    checked: list[Any] = []
    monkeypatch.setattr(oscillator, "shot_cycles", lambda *_: cycles)
    monkeypatch.setattr(oscillator, "check_turns", lambda *given: checked.append(given[2:]))
    chain: Any = SimpleNamespace(
        eps=0.1, model="chain", overdamped=False, parameters=dict, check_unforced=lambda _: None,
        cell=SimpleNamespace(
            damping_at=lambda y, v: y + v + damping_at_rest,
            cycles=[SimpleNamespace(stable=each == "s") for each in limits],
        ),
    )  # fmt: skip
    found = oscillator.oscillator_cell(chain, 1e-9)
    assert checked == [(cycles, rests)]
    assert (found.stable_cycle, found.unstable_cycle) == named
    assert found.status is oscillator._status(rests, limits.count("s"))
    assert found.effective_damping == 0.1 * damping_at_rest


def test_the_codes_of_scipy_are_those_of_stiff_motion_and_of_steps_too_small() -> None:
    said = ode(lambda *_: 0.0).set_integrator("dop853")._integrator.messages
    assert "stiff" in said[shooting._STIFF]
    assert "step size becomes too small" in said[shooting._SINGULAR]


def test_the_error_of_a_cell_is_the_larger_of_those_of_its_cycles() -> None:
    one = CellCycle(max=1.0, min=-1.0, period=6.0, slip_time=6.0, error=1e-3)
    for errors in ((1e-3, 1e-6), (1e-6, 1e-3)):
        stable, unstable = (replace(one, error=each) for each in errors)
        found = Cell(
            model="vdp", parameters={}, status=CellStatus.BISTABLE, steady_sliding=None,
            effective_damping=0.1, stable_cycle=stable, unstable_cycle=unstable, seconds=0.0,
        )  # fmt: skip
        assert found.error == 1e-3
        assert found.basin == (-1.0, 1.0)
        assert replace(found, status=CellStatus.CYCLES).basin is None  # no motion comes to rest
        given = {each.name: getattr(found, each.name) for each in fields(found)}
        own_cell = OwnCell(**given, cycles=(stable, unstable))
        assert own_cell.error == 1e-3
    assert replace(found, stable_cycle=None, unstable_cycle=None).error == 0.0


def test_the_error_of_closed_cycles_covers_the_rounding_of_their_parameters() -> None:
    """Which grows as they meet, at η = 1/8."""
    b = 0.12499999 * 16.0
    found = cell(AveragedChain(a=4.0, b=b, c=0.0))
    for other in (np.nextafter(b, 0.0), np.nextafter(b, 9.0)):
        near = cell(AveragedChain(a=4.0, b=float(other), c=0.0))
        for name in ("stable_cycle", "unstable_cycle"):
            gap = abs(getattr(found, name).amplitude - getattr(near, name).amplitude)
            assert 1e-13 < gap <= getattr(found, name).error < 1e-5


def test_where_the_averaged_cycles_meet_there_is_one_that_attracts_from_outside() -> None:
    """At η = 1/8: r' = -(r/2)(1 - ar²/4 + br⁴/8) is negative on both sides of its double root."""
    a, b = 4.0, 2.0
    found = cell(AveragedChain(a=a, b=b, c=0.0))
    assert found.status is CellStatus.SEMISTABLE
    assert found.stable_cycle is None
    radius = found.unstable_cycle.amplitude
    double = np.roots([b / 8.0, -a / 4.0, 1.0])  # of r², each with the root of rounding
    assert np.abs(radius**2 - double).max() < 1e-7
    assert found.basin == (-radius, radius)
    assert (found.steady_sliding, found.unstable_cycle.period) == (None, 2.0 * np.pi)
    small = cell(AveragedChain(a=100.0 * a, b=1e4 * b, c=0.0))  # all lengths a tenth
    assert small.error == pytest.approx(0.1 * found.error)
    assert abs(radius - np.sqrt(2.0)) <= found.error < 1e-6
    near = cell(AveragedChain(a=a, b=float(np.nextafter(b, 0.0)), c=0.0))  # b off by its rounding
    for cycle in (near.unstable_cycle, near.stable_cycle):
        assert 0.0 < abs(cycle.amplitude - radius) <= found.error
    for r in (0.9 * radius, 1.1 * radius):
        assert -0.5 * r * (1.0 - a * r**2 / 4.0 + b * r**4 / 8.0) < 0.0


@pytest.mark.parametrize(("a", "eta"), [(2.5, 0.08), (4.0, 0.03125), (1.0, 0.12)])
def test_both_cycles_of_van_der_pol_are_beside_their_limits(a: float, eta: float) -> None:
    """Which are the roots of 1 - ar²/4 + br⁴/8; the true ones are off by the order of ε²."""
    b = eta * a * a
    found = vdp_cell(a, b, 0.01, 1e-6)
    assert found.to_dict()["eta"] == pytest.approx(eta)
    assert (found.steady_sliding, found.effective_damping) == (None, 0.01)
    assert found.status is CellStatus.BISTABLE
    limits = sorted(np.sqrt(np.roots([b / 8.0, -a / 4.0, 1.0]).real))
    for cycle, limit in zip((found.unstable_cycle, found.stable_cycle), limits, strict=True):
        assert cycle.averaged == pytest.approx(limit, rel=1e-12)
        assert (cycle.stick_time, cycle.slip_time) == (0.0, cycle.period)
        assert cycle.amplitude == pytest.approx(limit, rel=1e-3)
        assert cycle.period == pytest.approx(2.0 * np.pi, rel=1e-3)


def test_cycles_are_found_by_shooting_on_any_scale_of_time_and_of_amplitude() -> None:
    """Of (y/s)² - 1 the amplitude is 2s, and stiff springs move fast; the damping is that of y."""
    usual, slow, fast, wide = (
        shooting.shot_cycles(
            OscillatorCell(stiffness={1: k}, damping={(0, 0): -1.0, (2, 0): 1.0 / s**2}), eps, 1e-9
        )[0]
        for k, s, eps in ((1.0, 1.0, 0.2), (1e-4, 1.0, 0.002), (100.0, 1.0, 0.2), (1.0, 1e6, 0.2))
    )
    assert slow.period == pytest.approx(100.0 * usual.period, rel=1e-7)
    assert fast.max == pytest.approx(2.0, rel=1e-3)
    assert wide.max == pytest.approx(1e6 * usual.max, rel=1e-8)
    assert wide.multiplier == pytest.approx(usual.multiplier, rel=1e-9)


def test_a_cell_of_van_der_pol_without_cycles_is_at_rest_and_its_coefficients_have_ranges() -> None:
    assert vdp_cell(1.0, 0.2, 0.01, 1e-6).status is CellStatus.REST
    stable = averaged_cell(1.0, 0.03, 0.01).stable_cycle
    assert 0.0 < stable.error < 1e-11  # of rounding
    for tolerance in (9e-14, 1.1e-6):
        with pytest.raises(ParameterError, match="tolerance"):
            vdp_cell(1.0, 0.03, 0.01, tolerance)
    for a, b, named in ((0.0, 0.5, "a"), (-1.0, 0.5, "a"), (1.0, 0.0, "b"), (1.0, -0.1, "b")):
        with pytest.raises(ParameterError, match=f"^damping coefficient {named} = "):
            vdp_cell(a, b, 0.01, 1e-6)


def test_both_cycles_of_van_der_pol_close_in_scipy_with_their_multipliers() -> None:
    """Liouville: the multiplier of a cycle is exp(-ε ∮ h dt), h = 1 - ay² + by⁴."""
    a, b, eps = 2.5, 0.5, 0.1
    found = vdp_cell(a, b, eps, 1e-9)
    rate = oscillator_rate(
        lambda y: y, lambda y, v: damping(y, a, b), np.zeros((1, 1)), c=0.0, eps=eps
    )  # fmt: skip
    for cycle in (found.unstable_cycle, found.stable_cycle):
        start = np.array([cycle.max, 0.0])
        path = states_by_scipy(rate, start, np.linspace(0.0, cycle.period, 1001), 1e-12)
        off = np.abs(path[-1] - start).max()
        assert off <= (1.0 + cycle.multiplier) * cycle.error  # what is off grows in the turn
        y = path[:-1, 0]
        lost = eps * float(np.mean(damping(y, a, b))) * cycle.period
        # By central differences: their step is a ten-thousandth of the cycle.
        assert cycle.multiplier == pytest.approx(np.exp(-lost), rel=1e-4)


def test_the_longest_step_errs_in_proportion_to_the_tolerance() -> None:
    """Of a method of order eight: a step twice as long errs 256 times as much."""
    assert longest_step(1e-12) == 1.0
    assert longest_step(256e-12) == pytest.approx(2.0, rel=1e-12)


def test_a_cell_that_is_not_symmetric_turns_where_scipy_does() -> None:
    """From the largest y through the smallest and back; stiffness of even powers too."""
    found = own(damping="y**2 - 1", stiffness="y + 0.3*y**2 + 0.2*y**3", eps=0.5).stable_cycle
    rate = oscillator_rate(
        lambda y: y + 0.3 * y**2 + 0.2 * y**3, lambda y, v: y**2 - 1.0, np.zeros((1, 1)), c=0.0,
        eps=0.5,
    )  # fmt: skip
    times = np.linspace(0.0, found.period, 20_001)
    y = states_by_scipy(rate, np.array([found.max, 0.0]), times)[:, 0]
    assert y[-1] == pytest.approx(found.max, abs=1e-9)
    assert y.min() == pytest.approx(found.min, abs=1e-6)  # between samples
    assert found.min < -1.05 * found.max


def test_a_compiled_cell_has_its_cycle() -> None:
    found = own(damping="y**2 - 1", stiffness=hardening, values={"k": 0.8}, eps=0.3).stable_cycle
    rate = oscillator_rate(
        lambda y: np.sinh(0.8 * y) / 0.8, lambda y, v: y**2 - 1.0, np.zeros((1, 1)), c=0.0, eps=0.3
    )
    start, times = np.array([found.max, 0.0]), np.array([0.0, found.period])
    assert states_by_scipy(rate, start, times)[-1] == pytest.approx(start, abs=1e-9)


def test_the_error_of_a_multiplier_covers_the_differences_that_a_compiled_damping_needs() -> None:
    """Of a power as high as this they err by more than everything else; as text it has a slope."""
    compiled = CompiledCell(stiffness=lambda y: y, damping=lambda _, v: v**6 - 1.0)
    text = OscillatorCell(stiffness={1: 1.0}, damping={(0, 6): 1.0, (0, 0): -1.0})
    vars(compiled)["cycles"] = text.cycles  # the limits ε → 0, whose search takes the most time
    found, exact = (shooting.shot_cycles(cell, 0.5, 1e-12)[0] for cell in (compiled, text))
    off = abs(found.multiplier - exact.multiplier)
    assert off > 10.0 * exact.multiplier_error
    assert off <= found.multiplier_error + exact.multiplier_error


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"damping": 0, "overdamped": True, "stiffness": "y"}, "without inertia a cell only has"),
        ({"damping": "y**2 - 1", "drive": "0.1,1@1"}, "drive"),
        ({"damping": 0}, "other than zero in a cell without cycles"),
        ({"damping": "1 - y**2 + 0.12499*y**4", "eps": 1.0}, "take a smaller eps"),
    ],
)
def test_a_cell_without_cycles_or_too_far_from_averaging_is_refused(
    changes: dict[str, Any], words: str
) -> None:
    with pytest.raises(ParameterError, match=words):
        own(**changes)


def test_a_turn_that_never_ends_leads_to_one_sentence() -> None:
    """Rest of ε > 2 is a node: what starts beside it creeps there without turning."""
    chain = OscillatorChain(
        damping="1 - 3.3097*y**2 + 1.35452*y**4", stiffness="y + 0.1*y**3", c=0.0, eps=3.66872
    )
    with pytest.raises(ParameterError, match="small parameter eps"):
        cell(chain, tolerance=1e-6)


@pytest.mark.parametrize("eps", [50.0, 100.0])
def test_the_period_of_relaxation_is_the_asymptotic_one(eps: float) -> None:
    """(3 - 2 ln 2)ε + 3αε^(-1/3) + O(ln ε/ε), α the first zero of Ai(-x): Dorodnitsyn (1947)."""
    van_der_pol = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -1.0, (2, 0): 1.0})
    (found,) = shooting.shot_cycles(van_der_pol, eps, 1e-9)
    alpha = -float(ai_zeros(1)[0][0])
    expected = (3.0 - 2.0 * np.log(2.0)) * eps + 3.0 * alpha * eps ** (-1.0 / 3.0)
    assert abs(found.period - expected) < 2.0 * np.log(eps) / eps
    assert found.multiplier == 0.0  # less than 1e-308


def test_a_cycle_far_from_its_limit_is_found() -> None:
    """The velocity of Rayleigh's cell obeys the equation of Van der Pol: at ε = 10, ẏ/√3."""
    ours, theirs = (own(damping=text, eps=10.0).stable_cycle for text in ("v**2 - 1", "y**2 - 1"))
    assert ours is not None
    assert theirs is not None
    assert ours.averaged is not None
    assert ours.max > 3.0 * ours.averaged
    assert abs(ours.period - theirs.period) <= ours.error + theirs.error < 1e-9
    assert ours.multiplier == pytest.approx(theirs.multiplier, rel=1e-6)  # 1e-9 of an exponent


@pytest.mark.parametrize(
    ("damping", "eps"), [("1 - y**2 + 0.05*y**4", 2.1), ("1 - y**2 + 0.1*y**4", 5.0)]
)
def test_a_strongly_unstable_cycle_closes_in_scipy_backwards_in_time(
    damping: str, eps: float
) -> None:
    """Forwards a deviation of a rounding error grows to one of 1e-9, or beyond all cycles."""
    found = own(damping=damping, eps=eps).unstable_cycle
    assert found is not None
    assert found.multiplier is not None
    assert found.multiplier_error is not None
    h = np.polynomial.Polynomial([1.0, 0.0, -1.0, 0.0, 0.05 if eps < 5.0 else 0.1])

    def rate(_: float, z: np.ndarray) -> list[float]:
        y, v, _ = z
        return [v, -y - eps * h(y) * v, -eps * h(y)]

    times, start = (0.0, -found.period), [found.max, 0.0, 0.0]
    back = solve_ivp(rate, times, start, "DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    assert np.abs(back[:2] - start[:2]).max() <= found.max * found.error < 1e-9
    assert abs(np.exp(-back[2]) - found.multiplier) <= found.multiplier_error
    assert found.multiplier_error < 1e-8 * found.multiplier


WELLS = {"beside": {1: 1.0, 2: -0.295, 3: 0.0084}, "on both sides": {1: 1.0, 3: -1.0, 5: 0.1}}


@pytest.mark.parametrize(
    ("wells", "damping", "stable"),
    [
        ("beside", {(0, 0): -0.01, (2, 0): 1.0}, [True]),
        ("beside", {(0, 0): 1.0, (2, 0): -20.0, (4, 0): 20.0}, [False, True]),
        ("on both sides", {(0, 0): 1.0, (2, 0): -2.0, (4, 0): 0.1}, [True]),
    ],
)
def test_beside_other_wells_of_the_potential_cycles_are_those_through_rest(
    wells: str, damping: Any, stable: list[bool]
) -> None:
    """There the potential is below that at rest: its root was taken."""
    found = OscillatorCell(stiffness=WELLS[wells], damping=damping)
    assert [each.stable for each in found.cycles] == stable
    for cycle in shooting.shot_cycles(found, 1e-3, 1e-9):
        assert cycle.averaged is not None
        assert cycle.min < 0.0 < cycle.max
        assert cycle.max == pytest.approx(cycle.averaged, rel=1e-3)  # to O(ε)


@pytest.mark.parametrize("wells", WELLS.values(), ids=WELLS)
@pytest.mark.parametrize("rests", [1.0, -1.0])
def test_motion_that_grows_into_another_well_is_refused(wells: Any, rests: float) -> None:
    cell = OscillatorCell(stiffness=wells, damping={(0, 0): rests, (2, 0): -9.0, (4, 0): 0.1})
    with pytest.raises(ParameterError, match="potential = lower beyond y = "):
        _ = cell.cycles


@pytest.mark.parametrize(
    "roots", [(-1.0, -3.0), (-1.0, -1.2), (-0.01, -0.05), (-1.0, -3.0, 1.5, 2)]
)
@pytest.mark.parametrize("compiled", [False, True])
def test_motion_that_grows_into_a_well_at_negative_y_is_refused_where_it_leaves(
    roots: tuple[float, ...], compiled: bool
) -> None:
    """Of the mirrored cell, too, whose wells are at positive y: the potential is lower there."""
    g = np.polynomial.Polynomial([0.0, 1.0])
    for root in roots:
        g *= np.polynomial.Polynomial([1.0, -1.0 / root])

    damping = {(0, 0): -1.0, (2, 0): 1.0}
    cell: Any = OscillatorCell(stiffness=dict(enumerate(g.coef)), damping=damping)
    if compiled:
        text = "+".join(f"({each!r})*y**{power}" for power, each in enumerate(g.coef.tolist()))
        cell = compiled_cell(read_polynomial(text), read_polynomial("y**2 - 1"), {}, False)
    with pytest.raises(ParameterError, match=f"potential = lower beyond y = {roots[0]:g} "):
        _ = cell.cycles
    mirrored = {power: (-1) ** (power + 1) * each for power, each in enumerate(g.coef)}
    with pytest.raises(ParameterError, match=r"potential = lower beyond y = \d"):
        _ = OscillatorCell(stiffness=mirrored, damping=damping).cycles


@pytest.mark.parametrize("amplitude", [0.5, 1.4, 1.5, 1.6])
def test_motion_turns_where_the_potential_is_first_as_high_as_its_energy(amplitude: float) -> None:
    """Within the well at y = -3 it is as high again; it was taken for the end of motion at 1.4."""
    g = np.polynomial.Polynomial([0.0, 1.0])
    for root in (-1.0, -3.0, 0.8, 1.2):
        g *= np.polynomial.Polynomial([1.0, -1.0 / root])
    energy = float(g.integ()(amplitude))
    real = [each.real for each in (g.integ() - energy).roots() if abs(each.imag) < 1e-9]
    cell = OscillatorCell(stiffness=dict(enumerate(g.coef)), damping={(0, 0): 1.0})
    expected = max(each for each in real if each < 0.0)
    assert cell._other_end(amplitude, energy) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("eps", [1e-6, 1e-4])
def test_damping_far_weaker_than_the_tolerance_has_its_cycles(eps: float) -> None:
    """Their amplitudes are those of averaging, to O(ε)."""
    found = cell(OscillatorChain(damping="1 - y**2 + 0.1*y**4", c=0.0, eps=eps), tolerance=1e-6)
    for each in (found.stable_cycle, found.unstable_cycle):
        assert each is not None
        assert each.averaged is not None
        assert abs(each.max - each.averaged) <= each.error + eps
        assert each.error < 1e-2


def test_the_cycles_around_a_node_close_in_scipy() -> None:
    """Also where one of the two searched ends creeps to rest."""
    found = cell(
        OscillatorChain(damping="1 - y**2 + 0.1*y**4", c=0.0, eps=2.2), tolerance=1e-9
    )  # fmt: skip
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - y**2 + 0.1 * y**4, np.zeros((1, 1)), c=0.0, eps=2.2
    )
    assert found.status is CellStatus.BISTABLE
    assert found.stable_cycle is not None
    assert found.unstable_cycle is not None
    for each, ahead in ((found.stable_cycle, 1.0), (found.unstable_cycle, -1.0)):
        # Time runs backwards where the cycle repels: nothing that is off grows.
        times = np.array([0.0, ahead * each.period])
        back = states_by_scipy(rate, np.array([each.max, 0.0]), times, 1e-13)[-1]
        assert np.abs(back - [each.max, 0.0]).max() <= 3.0 * each.error


def test_no_multiplier_is_given_that_leaves_double_precision() -> None:
    """By an integration of the divergence in many digits it is 661.37 at ε = 1."""
    chain = OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.0, eps=1.0)
    found = cell(chain, tolerance=1e-7).unstable_cycle
    assert abs(found.multiplier - 661.3679213) < found.multiplier_error < 30.0
    assert shooting._multiplier(709.0, 709.0)[0] == pytest.approx(np.exp(709.0))
    assert shooting._multiplier(710.0, 710.0) == (None, None)
    assert shooting._multiplier(-800.0, -800.0) == (0.0, np.finfo(float).tiny)


def test_the_command_tells_the_cycles(capsys: pytest.CaptureFixture[str], answered: Any) -> None:
    given = ["cell", "chain", "--damping", "y**2 - 1", "--eps", "1"]
    found = answered(given)
    assert found["cycles"] == [found["stable_cycle"]]
    assert main(given) == 0
    assert "the cycle is stable, rest is not" in capsys.readouterr().out


def _next_maximum(h: Callable[[float, float], float], eps: float, y: float) -> float:
    """Return the maximum of y after one turn of ÿ + y + ε h ẏ = 0 from rest at y, by scipy."""

    def top(t: float, z: Any) -> float:
        return float(z[1]) if t > 0.0 else -1.0

    top.terminal, top.direction = True, -1.0  # type: ignore[attr-defined]
    run = solve_ivp(
        lambda _, z: [z[1], -z[0] - eps * h(*z) * z[1]], (0.0, 30.0), [y, 0.0], "LSODA",
        events=top, rtol=1e-8, atol=1e-10,
    )  # fmt: skip
    return float(run.y_events[0][0][0])


def test_cycles_that_exist_at_finite_eps_only_are_not_denied() -> None:
    """Averaged, the odd term has no effect, and there is no cycle; at ε = 0.5 there are two."""
    text = "1 - y**2 + 0.13*y**4 + 0.5*y*v"

    def h(y: float, v: float) -> float:
        return 1.0 - y**2 + 0.13 * y**4 + 0.5 * y * v

    growth = [_next_maximum(h, 0.5, y) - y for y in (1.5, 2.4, 3.5)]
    assert growth[0] < 0.0 < growth[1]
    assert growth[2] < 0.0
    with pytest.raises(ParameterError, match=r"begins at y = 2\.\d+ grows"):
        cell(OscillatorChain(damping=text, c=0.0, eps=0.5))
    assert cell(OscillatorChain(damping=text, c=0.0, eps=0.01)).status.value == "rest only"


def test_a_cell_that_does_not_come_to_rest_from_every_y_is_not_said_to() -> None:
    """ÿ + y + ε(1 + ẏ)ẏ = 0: without the linear damping, u = ẏ² obeys u' + 2εu = -2y.

    From rest at y > 1/2ε it grows without bound; the linear damping raises this by some per cent.
    """
    with pytest.raises(ParameterError, match=r"begins at y = 5\d\.\d grows"):
        cell(OscillatorChain(damping="1 + v", c=0.0, eps=0.01))


@pytest.mark.parametrize("size", [1e-8, 1e6])
def test_such_a_cell_is_refused_whatever_its_amplitudes(size: float) -> None:
    with pytest.raises(ParameterError, match=r"begins at y = 5.*e[-+]07 grows"):
        cell(OscillatorChain(damping=f"1 + {1 / size!r}*v", c=0.0, eps=0.01))


@pytest.mark.parametrize("size", [1e-8, 1e-3, 1e6])
@pytest.mark.parametrize("square", [0.0, 0.4])
def test_the_cycles_of_a_cell_are_as_large_as_the_unit_of_y_makes_them(
    size: float, square: float
) -> None:
    """In the equation of y/size all coefficients are of order one."""

    def found(unit: float) -> tuple[OscillatorCycle, ...]:
        stiffness = {1: 1.0, 2: square / unit, 3: 0.3 / unit**2}
        damping = {(0, 0): 1.0, (2, 0): -4.0 / unit**2, (4, 0): 0.5 / unit**4}
        return OscillatorCell(stiffness=stiffness, damping=damping).cycles

    expected = found(1.0)
    assert [each.stable for each in expected] == [False, True]
    for one, other in zip(found(size), expected, strict=True):
        assert one.stable is other.stable
        assert one[:3] == pytest.approx((size * other[0], size * other[1], other[2]), rel=1e-12)


@pytest.mark.parametrize(
    ("stiffness", "odd"),
    [
        ({1: 1.0, 3: 0.3}, {(4, 3): 1.0}),
        ({1: 1.0, 2: 0.1, 3: 3.0}, {(4, 3): -1.0}),
        ({1: 2.0, 2: 1e-3, 3: 2e-3}, {(3, 3): 0.1, (1, 1): 0.3}),
        ({1: 1.0, 3: 0.1}, {(3, 4): -1.0}),
    ],
)
def test_terms_by_which_no_energy_is_lost_do_not_decide_on_cycles_by_their_rounding(
    stiffness: dict[int, float], odd: dict[tuple[int, int], float]
) -> None:
    """Odd powers of ẏ and, in a symmetric potential, of y; at large amplitudes they are largest."""
    even = {(0, 0): 1.0, (2, 0): -1.0, (4, 0): 0.5}
    with_odd = OscillatorCell(stiffness=stiffness, damping=even | odd)
    assert with_odd.cycles == OscillatorCell(stiffness=stiffness, damping=even).cycles


def test_cycles_of_very_different_amplitudes_are_both_found() -> None:
    """At this stiffness the averaged equation (43), 1 - as/4 + bs²/8 = 0, is exact to rounding."""
    damping = {(0, 0): 1.0, (2, 0): -1e8, (4, 0): 1.0}
    given = OscillatorCell(stiffness={1: 1.0, 3: 1e-30}, damping=damping)
    squares = np.roots([1.0 / 8.0, -1e8 / 4.0, 1.0])[::-1]
    # The larger root leaves 1e-16 of its square for the smaller one.
    expected = [1e-4 * 2.0, np.sqrt(squares[1])]
    assert [each.amplitude for each in given.cycles] == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_turns_are_tried_where_the_damping_has_both_signs_and_is_not_strong(
    size: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of ÿ + 4y + ½ε(y² - 1)ẏ = 0, with a damping from -½ to ½(y² - 1); none turns back twice.

    In units of another size, the same parts of it are tried.
    """
    tried = []
    monkeypatch.setattr(
        shooting, "_turn", lambda _, __, y, limit, ___: tried.append((y, limit)) or None
    )
    given = OscillatorCell(stiffness={1: 4.0}, damping={(0, 0): -0.5, (2, 0): 0.5 / size**2})
    shooting.check_turns(given, 1.0, (), rests=True)
    strongest = 10.0 * 2.0  # ten times the frequency
    expected = [
        y * size
        for y in shooting._TRIED.tolist()
        if y > 1.0 and max(0.5, 0.5 * (y * y - 1.0)) < strongest
    ]
    assert [y for y, _ in tried] == pytest.approx(expected, rel=1e-14)
    assert len(expected) > 10
    for y, limit in tried:
        assert limit.amplitude == y
        assert (limit.velocity, limit.period) == pytest.approx((2.0 * y, np.pi))


@pytest.mark.parametrize("rests", [False, True])
def test_a_turn_that_decays_where_no_cycle_lets_it_is_refused_as_one_that_grows_is(
    rests: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without cycles every turn decays if rest is stable, and grows if it is not.

    Outside of each cycle it is the other way round.
    """
    given = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -0.5, (2, 0): 0.5})
    inside = CellCycle(max=1e-6, min=-1e-6, period=6.0, slip_time=6.0, error=0.0)
    for part, cycles in product((0.9, 1.1), range(4)):
        monkeypatch.setattr(
            shooting, "_turn", lambda _, __, y, *___, part=part: SimpleNamespace(top=part * y)
        )
        wrong = (part > 1.0) == (rests if cycles in (0, 2) else not rests)
        said = f"y = .* {'grows' if part > 1.0 else 'decays'}"
        with pytest.raises(ParameterError, match=said) if wrong else nullcontext():
            shooting.check_turns(given, 1.0, (inside,) * cycles, rests)


def test_turns_that_change_by_their_errors_alone_are_not_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They do not decide whether motion grows, and neither does one that does not turn back."""
    given = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -0.5, (2, 0): 0.5})
    monkeypatch.setattr(shooting, "_TRIED", np.array([1.5, 3.0]))
    for top in (1.0 - 1e-7, 1.0 + 1e-7, None):
        monkeypatch.setattr(
            shooting, "_turn",
            lambda _, __, y, *___, top=top: SimpleNamespace(top=top * y) if top else None,
        )  # fmt: skip
        for rests in (True, False):
            shooting.check_turns(given, 1.0, (), rests)


@pytest.mark.parametrize("stiffness", [{1: 1.0}, {1: 1.0, 3: 1.0}, {1: 1.0, 3: 100.0}])
def test_a_turn_without_damping_neither_grows_nor_decays_by_what_decides_on_turns(
    stiffness: dict[int, float],
) -> None:
    given = OscillatorCell(stiffness=stiffness, damping={(0, 0): 1.0})
    for y in (1e-3, 1.0, 10.0):
        limit = OscillatorCycle(y, given.velocity(y), given.period(y), True)
        turn = shooting._turn(given, 0.0, y, limit, shooting._TRIED_TOLERANCE)
        assert turn is not None
        assert abs(turn.top / y - 1.0) < 0.1 * shooting._GROWTH
