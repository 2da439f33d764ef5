"""What is said of a breather, its errors and its end: of made-up solutions and runs."""

from __future__ import annotations

import inspect
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from tests.folds import fold_of
from theory.averaged.breather import BreatherStatus, Reading, closed_form_fold, solve_breather
from theory.chains.nucleus import Nucleus, Place
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers import breather as breathers
from verification.breathers import envelope, floquet, follow, orbits, outcome, run
from verification.breathers import exponents as exponents_of
from verification.breathers import family as families
from verification.breathers.envelope import RotatingWaves, solve_envelope_breather
from verification.breathers.exponents import eigenvalue_bound, exponents, unpack
from verification.breathers.family import MAX_STEPS
from verification.breathers.orbits import Orbits
from verification.breathers.result import Breather, BreatherComparison, BreatherMethod
from verification.continuation.branch import FoldShift, StepControl
from verification.continuation.newton import PARAMETER_WEIGHT, BranchPoint, NotConvergedError
from verification.steppers.variational import Flow

AVERAGED = AveragedChain(a=4, b=0.5, c=0.1, sites=9)
CHAIN = AVERAGED.full()
EPSILON = float(np.finfo(float).eps)


# ------------------------------------------------------------------------------------ its errors


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_breather_is_as_far_off_as_from_one_that_errs_and_its_own_error(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = SimpleNamespace(
        frequency=1.0, error=0.25, frequency_error=2.0**-5, amplitudes=np.array([9.0, 2.0, 1.0]),
        waves=np.array([9j, 2j, 1j]), wave_error=0.125, nucleus=Nucleus(1),
        chain=replace(CHAIN, sites=3),
    )  # fmt: skip
    family = SimpleNamespace(solve=lambda: exact)
    monkeypatch.setattr(breathers, "own_family", lambda *_: family)
    far = [0.125] * 3
    amplitudes = np.array([*far, 9.0, 2.0, 1.0 + 0.5 * side, *far])
    own = _breather(
        BreatherMethod.ENVELOPE, amplitudes=amplitudes, waves=amplitudes + 0j,
        frequency=1.0 + 0.125 * side, error=0.0625, frequency_error=2.0**-6,
    )  # fmt: skip
    own = replace(own, chain=CHAIN)
    found = breathers._compared(own, CHAIN)
    assert (found.error, found.error_unknown) == (0.5 + 0.25 + 0.0625, "")
    assert found.frequency_error == 0.125 + 2.0**-5 + 2.0**-6
    # sites beyond count whole, and turn by the error of a centre that is 4.5 times smaller
    gaps = np.array([*far, 0.0, 0.0, 0.5, *far])
    assert found.wave_error == pytest.approx(gaps + 0.125 + 2.0 * (1.0 + 4.5) * 0.0625)


@pytest.mark.parametrize(
    ("chain", "by"), [(CHAIN, "run_breather"), (AVERAGED, "run_averaged_breather")]
)
def test_the_frequency_of_a_run_is_as_far_off_as_it_is_from_that_of_the_chain(
    chain: Any, by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = SimpleNamespace(
        frequency=1.0, error=0.25, frequency_error=2.0**-5, amplitudes=np.ones(3),
        waves=np.ones(3, complex), wave_error=0.0, nucleus=Nucleus(1),
        chain=replace(CHAIN, sites=3),
    )  # fmt: skip
    monkeypatch.setattr(breathers, "own_family", lambda *_: SimpleNamespace(solve=lambda: exact))
    sizes = np.where(np.arange(9) == 4, 3.0, 0.1)
    settled = replace(
        _breather(BreatherMethod.SIMULATION, amplitudes=sizes, waves=sizes.astype(complex),
                  frequency=1.125, error=0.5), chain=chain, status=BreatherStatus.SETTLED,
    )  # fmt: skip
    monkeypatch.setattr(breathers, by, lambda *_, **__: settled)
    found = breathers.breather(chain, method="simulation")
    assert (found.error, found.frequency_error) == (0.5, 0.125 + 2.0**-5)
    assert found.error_unknown == ""
    # Of reasons why an error is unknown that of the run comes first.
    monkeypatch.setattr(breathers, "own_family", lambda *_: SimpleNamespace(solve=lambda: none))
    none = replace(settled, frequency=None, error_unknown="")
    assert "at this coupling" in breathers.breather(chain, method="simulation").error_unknown
    settled = replace(settled, error_unknown="the run")
    assert breathers.breather(chain, method="simulation").error_unknown == "the run"


def test_the_waves_of_a_run_on_another_nucleus_err_beside_the_centre_of_that_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two sites in place of one: the right one is the centre, and the left one twice as large."""
    monkeypatch.setattr(breathers, "own_family", lambda *_: SimpleNamespace(solve=lambda: none))
    sizes = np.array([0.1, 0.1, 0.1, 0.1, 6.0, 3.0, 0.1, 0.1, 0.1, 0.1])
    settled = replace(
        _breather(BreatherMethod.SIMULATION, amplitudes=sizes, waves=sizes.astype(complex),
                  frequency=1.125, error=0.5, wave_error=2.0),
        chain=CHAIN.replace(sites=10), status=BreatherStatus.SETTLED,
    )  # fmt: skip
    none = replace(settled, frequency=None)
    monkeypatch.setattr(breathers, "run_breather", lambda *_, **__: settled)
    found = breathers.breather(settled.chain, Nucleus(1), method="simulation")
    assert found.nucleus.size == 2
    assert found.wave_error == 2.0 * (1.0 + 2.0) * 0.5
    settled = replace(settled, error=None, wave_error=None)  # of a run of a single block
    found = breathers.breather(settled.chain, Nucleus(1), method="simulation")
    assert (found.nucleus.size, found.error, found.wave_error) == (2, None, None)


def test_a_growth_rate_is_as_far_off_as_from_the_exact_one_with_both_errors() -> None:
    own, exact = (
        SimpleNamespace(growth=growth, growth_error=error)
        for growth, error in ((0.5, 0.125), (0.75, 0.0625))
    )
    for one, apart in ((own, 0.4375), (SimpleNamespace(growth=0.5, growth_error=None), 0.3125)):
        assert breathers._growth_distance(one, exact) == apart
    for which, name in (("own", "growth"), ("exact", "growth"), ("exact", "growth_error")):
        pair = {"own": own, "exact": exact}
        pair[which] = SimpleNamespace(**{**vars(pair[which]), name: None})
        assert breathers._growth_distance(pair["own"], pair["exact"]) is None


@pytest.mark.parametrize("gap", [4e-3, 8e-4, 8e-5])
def test_where_the_cycles_nearly_meet_a_branch_of_two_sites_begins_below_its_fold(
    gap: float,
) -> None:
    """A driven neighbour shifts the fold from that of a single site to the order of 1 - 8η."""
    chain = AveragedChain(a=1.0, b=(1.0 - gap) / 8.0, c=0.0, sites=8)
    fold = RotatingWaves(chain, Nucleus(2, "+")).branch(monitored=False).fold
    assert fold is not None
    assert envelope.start_of(chain, Nucleus(2, "+")) < fold.parameter < gap
    # That of a single site, from which its branch begins at a quarter, is far above.
    single = RotatingWaves(chain, Nucleus(1)).branch(monitored=False).fold
    assert single is not None
    begin = envelope.start_of(chain, Nucleus(1), largest=1.0)
    assert begin == pytest.approx(0.25 * single.parameter, rel=0.1)


@pytest.mark.parametrize("gap", [1e-2, 1e-6, 1e-12])
def test_a_branch_begins_at_a_part_of_the_smaller_of_two_folds(gap: float) -> None:
    """That of a single site goes to zero like √gap, that of neighbours like gap = 1 - 8η."""
    chain = AveragedChain(a=1.0, b=(1.0 - gap) / 8.0, c=0.0, sites=8)
    single = envelope.start_of(chain, Nucleus(1), largest=1.0, fraction=0.5)
    assert single == 0.5 * closed_form_fold(chain).c > gap
    for nucleus in (Nucleus(2, "+"), Nucleus(3, "-+")):
        begin = envelope.start_of(chain, nucleus, largest=1.0, fraction=0.5)
        assert begin == pytest.approx(0.5 * gap, rel=1e-3)
        assert envelope.start_of(chain, nucleus, largest=0.1 * gap) == 0.1 * gap


@pytest.mark.parametrize("eta", [0.12, 0.02, 0.007, 1e-3, 1e-4, 1e-6])
def test_rates_are_of_order_one_in_their_unit(eta: float) -> None:
    """The cycle attracts at about 1/2η; where that is moderate rates are left as they are."""
    unit = RotatingWaves(AveragedChain(a=1.0, b=eta, c=0.0), Nucleus(1)).rate_unit
    assert 4.0 < 0.5 / eta / unit < 101.0
    assert math.log2(unit) % 4.0 == 0.0  # a power of 16
    assert (unit == 1.0) is (eta > 0.005)


@pytest.mark.parametrize(("c", "bound"), [(0.28, 0.0), (0.295, 0.01), (0.305, 0.01), (0.32, 0.0)])
def test_a_coupling_within_the_error_of_a_fold_is_as_uncertain_as_the_fold(
    c: float, bound: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(RotatingWaves, "step_error", lambda *_: FoldShift(0.0, 0.0))
    fold = fold_of(0.3, 0.01, np.zeros(1))
    assert RotatingWaves(AVERAGED, Nucleus(1)).near_fold(c, fold) == (0.01, bound)


def test_the_chain_of_a_comparison_has_as_much_rest_beside_a_nucleus_of_any_size(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """But is no longer than the chain itself."""
    lengths: list[int] = []

    def noted(chain: Any, _: Nucleus) -> Any:
        lengths.append(chain.sites)
        raise NotConvergedError("none")

    monkeypatch.setattr(breathers, "own_family", noted)
    for size in (1, 9, 25):
        own = _breather(BreatherMethod.ENVELOPE, nucleus=Nucleus(size))
        breathers._compared(own, CHAIN.replace(sites=101))
        breathers._compared(own, CHAIN.replace(sites=size + 2))
    long, short = lengths[::2], lengths[1::2]
    assert long == [size + breathers.REST for size in (1, 9, 25)]
    assert short == [3, 11, 27]


def test_finer_orbits_have_twice_the_steps() -> None:
    assert Orbits(CHAIN, Nucleus(1), 30).finer().count == 60
    assert Orbits(CHAIN, Nucleus(1)).finer().count == 2 * Orbits(CHAIN, Nucleus(1)).count


@pytest.mark.parametrize(
    ("c", "nearest"),
    [(0.2, None), (0.8, 0.7), (0.95, 1.0), (1.05, 1.0), (1.6, 1.3), (1.8, None)],
)
def test_a_breather_is_beside_the_nearest_fold_whose_error_reaches_it(
    c: float, nearest: float | None
) -> None:
    errors = {0.7: 0.4, 1.0: 0.1, 1.3: 0.4}
    folds = [(fold_of(each, 0.0, np.zeros(1)), error) for each, error in errors.items()]
    for given in (folds, folds[::-1]):
        found = follow._fold_at(given, c)
        assert (found and found.parameter) == nearest


def test_beyond_the_fold_of_the_closed_form_there_is_its_fold_with_its_error() -> None:
    found = breathers.breather(replace(CHAIN, c=0.3), method="closed-form")
    fold = closed_form_fold(replace(CHAIN, c=0.3))
    assert (found.status, found.fold) == (BreatherStatus.NONE, fold.c)
    assert found.fold_error == fold.error > 0.0


def test_a_phase_is_uncertain_by_how_far_its_wave_may_turn() -> None:
    """By a chord of the wave's length, and of the centre, which has none, not at all."""
    found = replace(
        _breather(BreatherMethod.ENVELOPE, waves=np.array([1.0, 2.0, 1j])), wave_error=0.5,
        chain=replace(CHAIN, sites=3),
    )  # fmt: skip
    assert found.phases_error == pytest.approx([1.0 / 6.0, 0.0, 1.0 / 6.0], rel=1e-12)
    turns = math.asin(0.5 / 2.0) + math.asin(0.5)  # of the centre, and of the site beyond
    assert found.phase_step_error == pytest.approx(turns, rel=1e-12)
    longer = replace(found, chain=replace(CHAIN, sites=5), waves=np.array([1.0, 1.0, 2.0, 1j, 1.0]))
    assert longer.phase_step_error == pytest.approx(turns, rel=1e-12)  # of these two sites alone
    nearer = replace(found, wave_error=np.array([0.25, 0.5, 0.5]))
    assert nearer.phase_step_error == pytest.approx(turns, rel=1e-12)
    each = replace(found, wave_error=np.array([0.5, 7.0, 1.0]))
    assert each.phases_error == pytest.approx([1.0 / 6.0, 0.0, 1.0], rel=1e-12)
    whole = replace(found, nucleus=Nucleus(3))  # beyond which there is no site
    assert whole.phase_step is whole.phase_step_error is None
    still = replace(found, waves=np.array([0.0, 2.0, 1.0]), wave_error=0.0)
    assert still.phases_error == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    assert still.phases_error[2] > EPSILON  # of the computed angle


@pytest.mark.parametrize("c", [0.02, 0.1])
def test_phases_far_from_a_nucleus_are_known_as_well_as_those_in_it(c: float) -> None:
    """Small waves turn with their neighbours; against a periodic orbit of the chain itself."""
    chain = VdpChain(a=2.5, b=0.5, c=c, sites=15)
    found = breathers.breather(chain, Nucleus(3), method="envelope")
    assert found.phases_error[4:11].max() < 0.013
    true = breathers.breather(chain, Nucleus(3), method="orbit")
    apart = np.abs((true.phases - found.phases + 1.0) % 2.0 - 1.0)
    assert np.all(apart <= found.phases_error + 1e-12)
    assert apart[4] > 0.5 * found.phases_error[4]


def test_a_branch_begins_at_the_rate_at_which_its_sites_turn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two sites in antiphase are at their solution there: springs turn them at Ω = c."""
    begun: list[Any] = []

    def solve(system: Any, guess: Any, c: float) -> BranchPoint:
        begun.append((guess, system(guess, c)[0]))
        return BranchPoint(guess, c, np.zeros(6), 0.0, 0.0, 1, 1.0)

    monkeypatch.setattr(envelope, "solve_at", solve)
    point = RotatingWaves(AVERAGED.replace(sites=2), Nucleus(2, "x")).start(1.0)
    ((guess, value),) = begun
    assert guess[-1] == pytest.approx(point.parameter, rel=1e-12) != 0.0
    assert value == pytest.approx(np.zeros(5), abs=1e-14)


def test_an_orbit_is_begun_with_the_displacements_and_velocities_of_its_waves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """φ e^{it} is ẏ + iy: displacements are Im φ, velocities are Re φ."""
    found = _breather(BreatherMethod.ENVELOPE, waves=np.array([1j, 2.0, 3.0 - 1j]), frequency=2.0)
    monkeypatch.setattr(orbits, "solve_envelope_breather", lambda *_: found)
    guess = orbits.orbit_guess(CHAIN.replace(sites=3), Nucleus(1))
    assert guess.tolist() == [1.0, 0.0, -1.0, 0.0, 2.0, 3.0, math.pi]


def test_an_orbit_closes_after_its_own_number_of_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless finer ones are asked for; its multipliers are split if it is its own mirror image."""
    asked: list[int] = []
    samples = np.sin(2.0 * math.pi * np.arange(64) / 64)[:, None] * np.ones(3)
    made = Flow(np.zeros(6), np.diag([1.0, 0.5, 0.4, 0.3, 0.2, 0.1]), np.zeros(6), samples, 30)
    monkeypatch.setattr(Orbits, "flow", lambda *given: asked.append(given[-1]) or made)
    monkeypatch.setattr(Orbits, "_monodromy_error", lambda *_: 0.0)
    monkeypatch.setattr(orbits, "solution_error", lambda *_: 0.0)
    family = Orbits(CHAIN.replace(sites=3), Nucleus(1), 30)
    unknowns = np.array([0.0, 0.0, 0.0, 0.1, 1.0, 0.1, 6.0])
    family.system()(unknowns, 0.2)
    family.system(2)(unknowns, 0.2)
    assert asked == [30, 60]
    found = family.measured(BranchPoint(unknowns, 0.2, np.zeros(8), 0.0, 0.0, 1, 1.0), 0.0)
    assert found.stability is not None
    assert None not in (found.stability.symmetric, found.stability.antisymmetric)


@pytest.mark.parametrize(("moved", "left"), [(0.29, False), (0.31, True)])
def test_a_start_that_leads_away_from_its_pattern_has_no_breather(
    moved: float, left: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By more than three tenths of the cycle."""
    monkeypatch.setattr(
        envelope, "solve_at", lambda _, guess, c: SimpleNamespace(u=(1.0 - moved) * guess)
    )
    waves = RotatingWaves(AVERAGED, Nucleus(1))
    if left:
        with pytest.raises(ParameterError, match="pattern"):
            waves.start(0.0)
    else:
        assert np.abs(waves.start(0.0).u).max() > 0.0


@pytest.mark.parametrize(("chain", "which"), [(CHAIN, "(8)"), (AVERAGED, "(43)")])
def test_where_the_chain_itself_has_no_breather_the_error_of_another_is_unknown(
    chain: Any, which: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    none = replace(_breather(BreatherMethod.ORBIT), status=BreatherStatus.NONE)
    monkeypatch.setattr(breathers, "own_family", lambda *_: SimpleNamespace(solve=lambda: none))
    own = _breather(
        BreatherMethod.CLOSED_FORM, frequency=1.0, error=0.5, frequency_error=0.25, wave_error=0.5
    )
    found = breathers._compared(own, chain)
    assert (found.error, found.frequency_error, found.wave_error) == (None, None, None)
    assert found.error_unknown.startswith(f"{which} has no such ")


def test_a_step_beyond_a_coupling_of_zero_finds_the_orbits_of_the_positive_coupling() -> None:
    """As a step along a branch that begins at small c may."""
    system = Orbits(CHAIN.replace(sites=3), Nucleus(1), 30).system()
    u = np.array([0.1, 0.0, 0.1, 0.3, -2.0, 0.3, 6.0])
    for here, there in zip(system(u, 0.125)[:2], system(u, -0.125)[:2], strict=True):
        assert np.array_equal(here, there)


def test_an_orbit_errs_by_the_step_that_twice_the_steps_ask_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Twice that step; its multipliers by what either twice the steps or that step change of it.

    They also err by what the whole error changes along the worst determined direction, which here
    is the velocity of the last site; it is measured at a millionth of the largest entry.
    """
    slope = np.diag([2.0, 2.0, 2.0, 2.0, 2.0, 1.0, 2.0])
    state, period = np.array([0.1, 2.0, 0.1, 0.3, 0.5, 0.3]), 6.0
    step = np.array([0.0, 1e-4, 0.0, 0.0, 0.0, -3e-4, 2e-4])
    flows: list[tuple[float, list[float], float, int]] = []
    parities: list[list[float]] = []

    class Made(Orbits):
        def flow(self, c: float, start: Any, duration: float, steps: int) -> Flow:
            flows.append((c, start.tolist(), duration, steps))
            matrix = np.diag([1.0, 0.5, 0.4, 0.3, 0.2, 0.1])
            if steps > 30:  # twice the steps: this entry is smaller
                matrix[0, 1] = -1e-3
            elif duration != period:
                matrix[2, 1] = 2e-3
            elif start[-1] != state[-1]:
                matrix[3, 1] = 4e-6
            end = start - (1e-5 * np.eye(6)[4] if steps == 30 else 0.0)
            samples = np.sin(2.0 * math.pi * np.arange(64) / 64)[:, None] * np.ones(3)
            return Flow(end, matrix, np.zeros(6), samples, steps)

        def system(self, refinement: int = 1, centre: int | None = None) -> Any:
            assert refinement == 2
            return lambda u, c: (slope @ step, slope, np.zeros(7))

        def _parity(self, state: Any) -> int:
            parities.append(state.tolist())
            return 1

    asked: list[Any] = []
    multipliers = floquet.floquet_multipliers

    def sorted_(*given: Any, **options: Any) -> Any:
        asked.append((*given[1:], options))
        return multipliers(*given, **{**options, "parity": 0})

    monkeypatch.setattr(orbits, "floquet_multipliers", sorted_)
    family = Made(replace(CHAIN, sites=3, c=0.3), Nucleus(1), 30)
    point = BranchPoint(np.append(state, period), 0.2, np.zeros(8), 0.0, 5e-5, 3, 1.0)
    found = family.measured(point, 0.0)
    nearer = (state - step[:-1]).tolist()
    assert flows == [
        (0.2, state.tolist(), period, 30),
        (0.2, state.tolist(), period, 64),
        (0.2, nearer, pytest.approx(period - 2e-4), 30),
        (0.2, pytest.approx(flows[3][1]), period, 30),
    ]
    beside = np.abs(np.array(flows.pop(3)[1]) - state)
    assert beside == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.0, 2e-6], rel=1e-6)
    assert found.error == pytest.approx(2.0 * 3e-4 + 5e-5)
    assert found.frequency == pytest.approx(2.0 * math.pi / period)
    assert found.frequency_error == pytest.approx(2.0 * math.pi / period**2 * 6.5e-4)
    assert found.residual == pytest.approx(1e-5)
    assert found.chain.c == 0.2
    assert asked[0][:2] == (period, CHAIN.eps)
    share = found.error / 2e-6
    assert asked[0][2]["error"] == pytest.approx(1e-3 + 2e-3 + share * 4e-6, rel=1e-6)
    family.stability(point.u, 0.2)
    assert flows[3:] == [(0.2, state.tolist(), period, 30)]
    assert asked[1][:2] == (period, CHAIN.eps)
    assert parities == [state.tolist()] * 2
    with monkeypatch.context() as changed:
        changed.setattr(Made, "symmetric_chain", False)
        family.measured(point, 0.0)
    family.stability(point.u, 0.2, split=False)
    assert [each[2]["parity"] for each in asked] == [1, 1, 0, 0]
    assert len(parities) == 2
    assert (found.fold, found.fold_error) == (None, None)
    monkeypatch.setattr(Made, "step_error", lambda *_: FoldShift(3e-7, 0.0))
    folded = family.measured(point, 0.0, fold_of(0.3, 1e-7, point.u))
    assert (folded.fold, folded.fold_error) == (0.3, pytest.approx(4e-7))
    flows.clear()
    many = Made(family.chain, family.nucleus, 45)
    many.measured(point, 0.0)
    assert [steps for _, _, _, steps in flows] == [45, 90, 45, 45]
    many.amplitudes(point.u, 0.2)
    assert flows[4:] == [(0.2, state.tolist(), period, 90)]
    # Of a slow orbit waves err by the velocity over the frequency, of others by the displacement.
    assert found.wave_error == 4.0 * found.error
    slow = family.measured(replace(point, u=np.append(state, 4.0 * math.pi)), 0.0)
    assert slow.wave_error == pytest.approx(2.0 * 4.0 * slow.error)


def _solved_up_to(eps: float, monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, float]]:
    """Let Newton's method lead from ε of the start to ε of the chain where both are so small.

    From an orbit at half its own ε it leads anywhere. Returns where what was asked is noted.
    """
    tried: list[tuple[float, float]] = []

    def solve(system: float, guess: Any, c: float) -> BranchPoint:
        tried.append((system, float(guess[0])))
        if guess[0] != 0.5 * system and system > eps:
            raise NotConvergedError("too far")
        return BranchPoint(np.array([system]), c, np.zeros(2), 0.0, 0.0, 1, 1.0)

    monkeypatch.setattr(orbits, "orbit_guess", lambda chain, _: np.array([chain.eps]))
    monkeypatch.setattr(Orbits, "system", lambda self: self.chain.eps)
    monkeypatch.setattr(orbits, "solve_at", solve)
    return tried


def test_an_orbit_too_far_from_the_averaged_one_is_begun_at_half_its_small_parameter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried = _solved_up_to(0.1, monkeypatch)
    family = Orbits(replace(CHAIN, eps=0.4), Nucleus(1))
    assert family._from_small_eps().u == [0.4]
    assert tried == [(0.4, 0.4), (0.2, 0.2), (0.1, 0.1), (0.2, 0.1), (0.4, 0.2)]


def test_the_small_parameter_is_halved_five_times_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = _solved_up_to(0.0, monkeypatch)
    with pytest.raises(NotConvergedError, match="too far"):
        Orbits(replace(CHAIN, eps=0.4), Nucleus(1))._from_small_eps()
    assert tried == [(0.4 / 2**k, 0.4 / 2**k) for k in range(6)]
    tried.clear()
    with pytest.raises(ParameterError, match=r"small parameter eps = 0\.4") as refusal:
        Orbits(replace(CHAIN, eps=0.4), Nucleus(1)).start(0.5)
    assert refusal.value.remedy == "take a smaller eps, or another pattern"


def test_an_orbit_that_is_not_found_is_not_blamed_on_a_coupling_that_nobody_gave() -> None:
    """The fold of the averaged breather is at 0.04, below the couplings that are tried last."""
    chain = VdpChain(a=1.0, b=0.00466965, c=0.0, sites=9)
    with pytest.raises(ParameterError, match=r"small parameter eps = 0\.01 .* smaller eps, or"):
        Orbits(chain, Nucleus(3, "-+")).start(2.0)
    assert Orbits(chain.replace(eps=1e-3), Nucleus(3, "-+")).start(2.0).parameter < 0.04


def test_the_run_that_shows_the_error_of_the_multipliers_has_twice_the_steps() -> None:
    asked: list[int] = []

    class Spied(Orbits):
        def flow(self, c: float, start: Any, duration: float, steps: int) -> Flow:
            asked.append(steps)
            return super().flow(c, start, duration, steps)

    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=5)
    known = orbits.solve_orbit(chain, Nucleus(1))
    assert known.unknowns is not None
    for steps in (20, 45, 70):
        asked.clear()
        point = BranchPoint(known.unknowns, 0.1, np.zeros(12), 0.0, 0.0, 1, 1.0)
        found = Spied(chain, Nucleus(1), steps).measured(point, 0.0)
        assert asked[0] == steps
        assert asked[1] >= 2 * steps
        # The monodromy matrices by other steps, of the exact flow: the error bounds what differs.
        assert known.multipliers is not None
        apart = [np.abs(found.multipliers - each).min() for each in known.multipliers]
        assert max(apart) <= found.stability.error + 1e-9


@pytest.mark.parametrize(("off", "known"), [(1e-6, True), (1e3, False)])
def test_of_an_orbit_whose_multipliers_may_be_zero_no_error_of_its_growth_is_known(
    off: float, known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    samples = np.sin(2.0 * math.pi * np.arange(64) / 64)[:, None] * np.ones(3)
    flow = Flow(np.zeros(6), np.diag([1.0, 0.5, 0.4, 0.3, 0.2, 0.1]), np.zeros(6), samples, 30)
    monkeypatch.setattr(Orbits, "flow", lambda *_: flow)
    monkeypatch.setattr(Orbits, "_monodromy_error", lambda *_: off)
    monkeypatch.setattr(orbits, "solution_error", lambda *_: 0.0)
    point = BranchPoint(np.array([0.0] * 6 + [6.0]), 0.2, np.zeros(8), 0.0, 0.0, 1, 1.0)
    edge = Nucleus(1, place=Place.EDGE)  # without parity
    found = Orbits(CHAIN.replace(sites=3), edge, 30).measured(point, 0.0)
    assert found.growth == pytest.approx(math.log(0.5) / (CHAIN.eps * 6.0))
    assert math.isfinite(found.stability.growth_error) is known
    assert found.growth_error == (found.stability.growth_error if known else None)


def test_an_orbit_errs_by_the_rounding_of_its_steps_and_beside_a_fold_by_that_of_its_coupling(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Roundings of as many steps as are taken add up at random, or at most all together."""
    asked: list[Any] = []
    monkeypatch.setattr(orbits, "solution_error", lambda *given: asked.append(given) or 0.5)
    monkeypatch.setattr(Orbits, "_monodromy_error", lambda *_: 0.0)
    monkeypatch.setattr(Orbits, "step_error", lambda *_: FoldShift(0.25, 0.0))
    state = np.array([0.1, 0.0, 0.1, 0.3, -2.0, 0.3])
    point = BranchPoint(np.append(state, 6.0), 0.2, np.zeros(8), 0.0, 0.125, 1, 1.0)
    for steps in (20, 80):
        family = Orbits(CHAIN.replace(sites=3), Nucleus(1), steps)
        found = family.measured(point, 0.0, fold_of(0.3, 0.0, point.u))
        assert (found.error, found.fold_error) == (0.625, 0.25)
        _, u, c, rounding, of_coupling = asked[-1]
        assert (u.tolist(), c, of_coupling) == (point.u.tolist(), 0.2, 0.25)
        each = EPSILON * 2.0
        assert each * math.sqrt(steps) <= rounding <= each * 2.0 * steps


@pytest.mark.parametrize(
    "worst",
    [
        [0.5, -1.0, 0.25, 0.0],
        [1.0, -0.5, 0.25, 0.0],
        [-0.25, -0.5, 1.0, 0.0],
        [1.0, 1.0, 1.0, 0.0],
        [1.0, 0.5, 0.5, 1.0],
    ],
)
def test_multipliers_err_by_what_the_error_of_an_orbit_along_its_worst_direction_changes(
    worst: list[float],
) -> None:
    """As its largest part is off by the error; the matrix changes by twice a part of the state.

    The change is measured a millionth of the state or of the period away, whichever is nearer.
    """
    direction, error = np.array(worst), 1e-4
    asked: list[Any] = []
    slope = np.eye(4) - 0.9 * np.outer(direction, direction) / (direction @ direction)

    class Made(Orbits):
        def flow(self, c: float, start: Any, duration: float, steps: int) -> Flow:
            asked.append(np.append(start, duration))
            return Flow(start, np.diag(2.0 * start), np.zeros(3), np.zeros((1, 1)), steps)

        def system(self, refinement: int = 1, centre: int | None = None) -> Any:
            return lambda u, c: (np.zeros(4), slope, np.zeros(4))

    for *state, period in ([0.3, -2.0, 0.5, 6.0], [0.0, 0.0, -2.0, 6.0], [0.3, -2.0, 0.5, 0.01]):
        u, matrix = np.array([*state, period]), np.diag(2.0 * np.array(state))
        point = BranchPoint(u, 0.2, np.zeros(5), 0.0, 0.0, 1, 1.0)
        found = Made(CHAIN, Nucleus(1), 30)._monodromy_error(point, error, matrix)
        assert found == pytest.approx(2.0 * error, rel=1e-5)
        away = np.abs(asked[-1] - u) / np.array([2.0, 2.0, 2.0, period])
        assert away.max() == pytest.approx(1e-6, rel=1e-3)


def test_a_fold_is_off_by_what_twice_the_steps_leave_of_it() -> None:
    """F changes by δ ∂F/∂c where all its parts say that the coupling is off by δ."""
    by_c, off = np.array([0.5, -2.0, 1.0]), -1e-5

    class Made(Orbits):
        def system(self, refinement: int = 1, centre: int | None = None) -> Any:
            def system(u: Any, c: float) -> Any:
                assert (u.tolist(), c) == ([1.0, 2.0, 3.0], 0.2)
                return (off if refinement == 2 else 0.0) * by_c, np.diag([1.0, 2.0, 0.0]), by_c

            return system

    fold = fold_of(0.2, 1e-12, np.array([1.0, 2.0, 3.0]), tangent=np.array([0.0, 0.0, 1.0]))
    assert Made(CHAIN, Nucleus(1)).step_error(fold).parameter == pytest.approx(abs(off))


def test_a_multiplier_has_its_rate_and_its_frequency_in_slow_time() -> None:
    """exp(ε T (σ + iω)): a pair that turns and grows, beside the one of the orbit itself."""
    eps, period, sigma, omega = 0.05, 6.5, -0.3, 1.7
    turn = eps * period * omega
    pair = np.exp(eps * period * sigma) * np.array(
        [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    )
    matrix = np.zeros((4, 4))
    matrix[:2, :2], matrix[2:, 2:] = pair, np.diag([1.0, 0.1])
    found = floquet.floquet_multipliers(matrix, period, eps, parity=0)
    assert (found.growth, found.frequency) == (pytest.approx(sigma), pytest.approx(omega))
    assert (found.trivial, found.stable) == (pytest.approx(0.0, abs=1e-15), True)
    assert 0.0 < found.error < 1e-13  # of a matrix without error: rounding
    growing = floquet.floquet_multipliers(
        matrix, -period, eps, parity=0
    )  # the same, backwards in time
    assert growing.growth == pytest.approx(-sigma)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_frequency_of_a_multiplier_is_positive_whichever_of_its_pair_leads(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: Any = SimpleNamespace(
        values=np.zeros(0), trivial=0.0, leader=0.5 * np.exp(0.3j * side), symmetric=None,
        antisymmetric=None, error=0.0,
    )  # fmt: skip
    monkeypatch.setattr(floquet, "modes_of", lambda *_, **__: made)
    found = floquet.floquet_multipliers(np.eye(2), 6.0, 0.1, parity=0)
    assert found.frequency == pytest.approx(0.3 / (0.1 * 6.0))


@pytest.mark.parametrize(("error", "bound"), [(0.05, 0.1), (0.15, 0.8)])
def test_of_a_multiplier_that_may_be_zero_no_rate_is_known(error: float, bound: float) -> None:
    """A matrix of two entries is off by twice the error; discs that meet are as one."""
    found = floquet.floquet_multipliers(np.diag([1.0, 0.5]), 6.0, 0.1, parity=0, error=error)
    assert found.error == pytest.approx(bound)
    rate = -math.log1p(-bound / 0.5) / (0.1 * 6.0) if bound < 0.5 else math.inf
    assert found.growth_error == pytest.approx(rate)


@pytest.mark.parametrize("b", [0.5, 0.0016])
@pytest.mark.parametrize("nucleus", [Nucleus(1), Nucleus(2, "x"), Nucleus(1, place=Place.EDGE)])
def test_the_derivatives_of_the_rotating_wave_are_those_of_its_differences(
    nucleus: Nucleus, b: float
) -> None:
    """In the units of a chain of moderate and of small η."""
    chain = AVERAGED.replace(sites=6, b=b)
    system = RotatingWaves(chain, nucleus).system()
    rng = np.random.default_rng(2)
    u, c, step = rng.normal(size=13), 0.3, 1e-6
    _, slope, by_c = system(u, c)
    assert by_c == pytest.approx(
        (system(u, c + step)[0] - system(u, c - step)[0]) / (2.0 * step), abs=1e-8
    )
    for k, unit in enumerate(np.eye(13)):
        ahead, behind = system(u + step * unit, c)[0], system(u - step * unit, c)[0]
        assert slope[:, k] == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-6)


def test_the_derivatives_of_an_orbits_equations_are_those_of_their_differences() -> None:
    system = Orbits(VdpChain(a=2.5, b=0.5, c=0.1, eps=0.1, sites=2), Nucleus(1)).system()
    u, c, step = np.array([0.3, -1.0, 1.5, 0.4, 6.2]), 0.2, 1e-6
    _, slope, by_c = system(u, c)
    apart = (system(u, c + step)[0] - system(u, c - step)[0]) / (2.0 * step)
    assert np.abs(by_c).max() > 1e-2
    assert by_c == pytest.approx(apart, abs=1e-8)
    for k, unit in enumerate(np.eye(5)):
        ahead, behind = system(u + step * unit, c)[0], system(u - step * unit, c)[0]
        assert slope[:, k] == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-7)


@pytest.mark.parametrize("parity", [1, -1])
@pytest.mark.parametrize("moving", [(1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])
def test_the_parity_of_an_orbit_is_that_of_what_moves(
    parity: int, moving: tuple[float, float]
) -> None:
    """Where all sites pass through rest at once displacements are rounding, of any parity."""
    rng = np.random.default_rng(3)
    for sites in (2, 3, 8):
        half = rng.normal(size=(2, sites))
        exact = (np.array(moving)[:, None] * (half + parity * half[:, ::-1])).ravel()
        family = Orbits(
            CHAIN.replace(sites=sites), Nucleus(1 + (sites + 1) % 2, "x" * (1 - sites % 2))
        )
        found = [family._parity(exact + 1e-12 * rng.normal(size=2 * sites)) for _ in range(9)]
        assert found == [parity] * 9
        edge = replace(family, nucleus=Nucleus(1, place=Place.EDGE))
        assert edge._parity(exact) == 0


def test_beyond_zero_the_equations_of_an_orbit_are_those_of_the_opposite_coupling() -> None:
    """So that a last step may lead there; slopes are those of differences at the other one."""
    system = Orbits(VdpChain(a=2.5, b=0.5, c=0.1, eps=0.1, sites=2), Nucleus(1)).system()
    u, step = np.array([0.3, -1.0, 1.5, 0.4, 6.2]), 1e-6
    value, slope, _ = system(u, -0.2)
    assert value.tolist() == system(u, 0.2)[0].tolist()
    for k, unit in enumerate(np.eye(5)):
        ahead, behind = system(u + step * unit, 0.2)[0], system(u - step * unit, 0.2)[0]
        assert slope[:, k] == pytest.approx((ahead - behind) / (2.0 * step), abs=1e-7)


def test_a_branch_of_orbits_is_followed_down_to_any_coupling() -> None:
    """Its last step may lead past zero."""
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=3)
    for lowest in (1e-3, 1e-9):
        assert Orbits(chain, Nucleus(1)).start(2.0, lowest).parameter <= lowest


def test_a_branch_of_orbits_begins_below_what_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun = BranchPoint(np.zeros(7), 0.05, np.zeros(8), 0.0, 0.0, 1, 1.0)
    asked: list[tuple[Any, ...]] = []

    def trace(*given: Any) -> Any:
        asked.append(given)
        return SimpleNamespace(points=["first", "next", "last"])

    monkeypatch.setattr(orbits, "trace", trace)
    monkeypatch.setattr(Orbits, "_first", lambda *_: begun)
    family: Any = Orbits(CHAIN, Nucleus(1))
    assert family.start(1.0, 0.05) is begun
    assert family.start(1.0, 0.01) == "last"
    assert asked[0][1:] == (begun, 0.01, None, orbits.FIRST_STEPS)
    assert callable(asked[0][0])


def test_orbits_are_begun_at_a_coupling_below_the_end_of_their_branch(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From the averaged breather; at the smallest first, where that is far from the fold."""
    tried: list[float] = []

    def fails(self: Orbits, halvings: int = 5) -> Any:
        tried.append(self.chain.c)
        raise orbits.NotConvergedError("no")

    monkeypatch.setattr(Orbits, "_from_small_eps", fails)
    for end, expected in ((1.0, [0.05, 0.1, 0.15]), (0.12, [0.05, 0.1]), (0.02, [0.01])):
        tried.clear()
        with pytest.raises(ParameterError, match="small enough for an orbit"):
            Orbits(CHAIN, Nucleus(1))._first(end)
        assert tried == expected


def test_the_error_of_an_averaged_breather_holds_rounding_where_the_cycles_meet() -> None:
    """The damping cancels there by 1/√(1 - 8η)."""
    phi = np.array([0.0, 2.0j, 0.5])
    small, near = (
        envelope._rounding(phi, AveragedChain(a=1.0, b=b, c=0.1)) / (8.0 * EPSILON * 2.0)
        for b in (1e-6, 0.125 * (1.0 - 1e-8))
    )
    assert small == pytest.approx(2.0, rel=1e-5)
    assert near == pytest.approx(1e4, rel=1e-3)
    nearest = AveragedChain(a=1.0, b=0.125 * (1.0 - 2.0**-50), c=0.1)
    last = envelope._rounding(phi, nearest) / (8.0 * EPSILON * 2.0)
    assert last == pytest.approx(2.0**25, rel=1e-3)


@pytest.mark.parametrize("eps", [0.01, 1.0])
def test_the_frequency_of_an_averaged_breather_errs_as_its_amplitudes_do(
    eps: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of Newton's method nothing is left: by the roundings of φ, relative to it, and by its own."""
    chain = AveragedChain(a=1.0, b=0.125 * (1.0 - 1e-6), c=0.001, eps=eps, sites=5)
    family = RotatingWaves(chain, Nucleus(1))
    phi = Nucleus(1).envelope(chain) / family.unit
    u = np.concatenate([phi.real, phi.imag, [chain.c]])
    assert family.stability(u, chain.c).error == np.inf  # as long as no bound is asked for
    seen: list[float] = []
    assert family.reported_monitor(seen.append)(u, chain.c) == family.monitor(u, chain.c)
    assert seen == [1.0]  # one solution more
    monkeypatch.setattr(envelope, "solution_error", lambda *_: 0.0)
    found = family.measured(BranchPoint(u, chain.c, np.zeros(12), 0.0, 0.0, 1, 1.0), 0.0)
    share = found.error / np.abs(found.waves).max()
    assert share > 1000.0 * EPSILON  # the cycles nearly meet
    assert found.frequency_error == pytest.approx(eps * share + EPSILON * found.frequency)
    assert found.wave_error == 4.0 * found.error  # the centre is the largest
    u[-1] = 0.25  # Ω, of which the rounding of φ' is another multiple than of c
    with monkeypatch.context() as exact:  # but for its own rounding
        exact.setattr(envelope, "_rounding", lambda *_: 0.0)
        turning = family.measured(BranchPoint(u, chain.c, np.zeros(12), 0.0, 0.0, 1, 1.0), 0.0)
    assert turning.frequency_error == pytest.approx(EPSILON * (1.0 + 0.25 * eps), abs=0.0)
    rounding: list[Any] = []
    monkeypatch.setattr(envelope, "solution_error", lambda *given: rounding.append(given[3]) or 0.0)
    family.measured(BranchPoint(u, chain.c, np.zeros(12), 0.0, 0.0, 1, 1.0), 0.0)
    assert rounding[0].max() > 4.0 * EPSILON * 0.25 * np.abs(u[:-1]).max() / family.rate_unit
    fold = fold_of(chain.c, 0.0, u)
    seen_by_fold: list[Any] = []
    monkeypatch.setattr(envelope, "fold_shift", lambda *given: seen_by_fold.append(given[2]))
    family.step_error(fold)
    assert rounding[0].tolist() == seen_by_fold[0].tolist()
    assert found.growth_error == found.stability.growth_error
    assert found.fold is None
    monkeypatch.setattr(RotatingWaves, "fold_error", lambda *_: 0.0)
    beside = family.measured(BranchPoint(u, chain.c, np.zeros(12), 0.0, 0.0, 1, 1.0), 0.0, fold)
    assert beside.fold == chain.c


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_frequency_of_a_growing_mode_is_positive_whichever_of_its_pair_leads(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: Any = SimpleNamespace(
        values=np.zeros(0), trivial=0.0, leader=0.1 + side * 0.3j, symmetric=None,
        antisymmetric=None, error=0.0,
    )  # fmt: skip
    monkeypatch.setattr(exponents_of, "modes_of", lambda *_, **__: made)
    found = exponents(np.ones(AVERAGED.sites, dtype=complex), 0.0, AVERAGED)
    assert (found.growth, found.frequency) == (0.1, 0.3)


@pytest.mark.parametrize("c", [0.3, 3.0])
@pytest.mark.parametrize("parity", [-1.0, 1.0])
def test_exponents_of_two_sites_on_their_cycle_are_those_of_their_sum_and_difference(
    parity: float, c: float
) -> None:
    """φ = (r, ±r) rotates at 0 or c; r relaxes at g = -r f'(r), f the damping.

    Of the other parity are both roots of λ² + gλ + c² = 0, the second of which is its phase.
    """
    chain = AveragedChain(a=2.5, b=0.5, c=c, sites=2)
    r, omega = chain.stable_amplitude, 0.5 * c * (1.0 - parity)
    g = -r * (0.25 * chain.a * r - 0.25 * chain.b * r**3)
    found = exponents(np.array([r, parity * r], dtype=complex), omega, chain, mirrored=True)
    other = np.roots([1.0, g, c**2])
    assert found.trivial == pytest.approx(0.0, abs=1e-12)
    assert found.symmetric == pytest.approx(-g, rel=1e-12)
    assert found.antisymmetric == pytest.approx(other.real.max(), rel=1e-12)
    assert np.sort_complex(found.values) == pytest.approx(
        np.sort_complex(np.array([0.0, -g, *other])), abs=1e-12
    )


def test_exponents_err_by_what_the_rotation_does() -> None:
    """At rest they are -1/2 ± iΩ; of a split breather all errors are the same."""
    chain, off = AveragedChain(a=2.5, b=0.5, c=0.0, sites=2), 1e-4
    rest = np.zeros(2, complex)
    found = exponents(rest, 0.3, chain, omega_error=off)
    moved = exponents(rest, 0.3 + off, chain)
    apart = np.abs(np.sort(found.values.imag) - np.sort(moved.values.imag)).max()
    assert apart == pytest.approx(off, rel=1e-9)
    assert apart <= found.error < 1.1 * off
    assert found.growth_error == found.symmetric_error == found.error


@pytest.mark.parametrize("error", [1e-6, 1e-3])
def test_growth_rates_err_by_what_they_change_with_the_largest_site(error: float) -> None:
    chain = AveragedChain(a=2.5, b=0.5, c=0.0, sites=3)
    phi = np.array([1e-6, chain.stable_amplitude, 1e-6], dtype=complex)
    moved = phi + error * np.array([0.0, 1.0, 0.0])
    found, other = exponents(phi, 0.0, chain, error=error), exponents(moved, 0.0, chain)
    apart = np.abs(np.sort(found.values.real) - np.sort(other.values.real)).max()
    assert 0.1 * found.error < apart <= found.error


@pytest.mark.parametrize("size", [1.0, 1e3])
def test_eigenvalues_err_by_what_their_matrix_does(size: float) -> None:
    """Of orthogonal vectors by as much, of dependent ones by the root of it, and by rounding."""
    ring = size * np.diag([1.0, 2.0, 2.0])
    values = np.diag(ring).astype(complex)
    exact = eigenvalue_bound(ring, values, np.eye(3), 0.0)
    assert exact == pytest.approx(3.0 * EPSILON * 3.0 * size)
    assert eigenvalue_bound(ring, values, np.eye(3), 3e-6) == pytest.approx(3e-6, rel=1e-3)
    for error in (1e-6, size):  # of two equal entries on the diagonal
        block = np.array([[size, size], [0.0, size]])
        vectors = np.array([[1.0, 1.0], [0.0, 0.0]])
        bound = eigenvalue_bound(block, np.full(2, size, complex), vectors, error)
        norm = math.sqrt(3.0) * size
        assert bound == pytest.approx(math.sqrt(error * (2.0 * norm + error)), rel=1e-6)
        moved = np.linalg.eigvals(block + np.array([[0.0, 0.0], [error, 0.0]]))
        assert np.abs(moved - size).max() <= bound


def test_of_two_eigenvalues_that_are_close_both_may_be_beside_one_of_them() -> None:
    """The other computed one is then farther from them than the error of the matrix."""
    error = 1e-3
    values = np.array([1.0, 1.0 + math.sqrt(2.0) * error])
    turn = np.array([[1.0, 1.0], [-1.0, 1.0]]) / math.sqrt(2.0)
    exact = np.diag(values) + error * turn
    assert np.linalg.norm(exact - np.diag(values), 2) == pytest.approx(error)
    assert np.linalg.eigvals(exact) == pytest.approx(values[1], abs=1e-8)
    bound = eigenvalue_bound(np.diag(values), values.astype(complex), np.eye(2), error)
    assert values[1] - values[0] > error
    assert values[1] - values[0] < bound <= (1.0 + math.sqrt(2.0)) * error + 1e-14
    apart = np.diag([1.0, 1.0 + 2.001 * error])  # here each one has one of the exact ones
    alone = eigenvalue_bound(apart, np.diag(apart).astype(complex), np.eye(2), error)
    assert alone == pytest.approx(error)
    row = 1.0 + 1.999 * error * np.arange(9.0)  # each connected with the next
    bound = eigenvalue_bound(np.diag(row), row.astype(complex), np.eye(9), error)
    assert bound == pytest.approx(error + 8.0 * 1.999 * error)


@pytest.mark.parametrize("parity", [1, -1])
def test_multipliers_of_one_parity_err_as_much_as_the_whole_matrix_may(parity: int) -> None:
    """Every entry is off by as much as stated; those of a mode add up over all sites."""
    error, modes = 1e-6, scipy.linalg.hadamard(8).T  # over four sites, each even or odd
    place = 0 if parity == 1 else 1
    exact = np.array([0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 1.0, 0.3])  # of orthogonal modes
    matrix = modes.T @ np.diag(exact / 8.0) @ modes
    off = error * np.outer(modes[place], modes[place])
    found = floquet.floquet_multipliers(matrix + off, 6.0, 0.01, parity=-1, error=error)
    moved = found.values.real - np.sort(exact)[::-1]
    assert moved[1 + place] == pytest.approx(8.0 * error)
    assert moved[1 + place] <= found.error < 8.1 * error
    # The largest of its own, without the trivial one, and those of the other parity.
    rates = [math.log(each) / (0.01 * 6.0) for each in (0.8, 0.9)]
    apart = abs(found.symmetric - rates[0]), abs(found.antisymmetric - rates[1])
    assert max(apart) <= found.symmetric_error < 8.2 * error / 0.8 / (0.01 * 6.0)


@pytest.mark.parametrize("parity", [1, -1])
def test_multipliers_of_either_parity_are_within_the_error_that_is_stated(parity: int) -> None:
    """Those of odd modes, of vectors that nearly depend on one another, move by the root of it."""
    even = np.array([[1.0, 0.0, 1.0], [0.0, math.sqrt(2.0), 0.0]]) / math.sqrt(2.0)
    odd = np.array([[1.0, 0.0, -1.0]]) / math.sqrt(2.0)
    both, error = np.kron(np.eye(2), np.vstack([even, odd])), 1e-6
    matrix = np.diag([1.0, 0.5, 0.2, 0.4, 0.3, 0.2])
    if parity == -1:  # that of the orbit is among its own
        matrix[[0, 1], [0, 1]], matrix[2, 2], matrix[5, 5] = (0.5, 0.6), 1.0, 1.0
    matrix[2, 5] = 100.0
    moved = matrix.copy()
    moved[5, 2] = error
    true, off = (np.linalg.eigvals(each) for each in (matrix, moved))
    found = floquet.floquet_multipliers(
        both.T @ matrix @ both, 6.0, 0.01, parity=parity, error=error
    )
    assert sorted(found.values.real) == pytest.approx(sorted(true.real), abs=1e-6)
    shift = max(float(np.abs(true - each).min()) for each in off)
    assert 5e-3 < shift <= found.error


def test_multipliers_along_sinusoids_err_by_what_twice_the_steps_change(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Along the amplitudes and phases of the closed form, at the distances from the middle."""
    asked: list[Any] = []

    def integrate(chain: VdpChain, *of: Any, steps: int, misprinted: bool) -> Any:
        asked.append((chain.sites, misprinted, *(np.asarray(each).tolist() for each in of)))
        matrix = np.diag([0.5, 0.9, 0.5, 0.3, 1.0, 0.3])
        if steps == floquet.STEPS:
            matrix[1, 1] += 1e-6
        return SimpleNamespace(monodromy=matrix)

    monkeypatch.setattr(floquet, "integrate_along_sinusoids", integrate)
    closed: Any = SimpleNamespace(
        alpha_0=2.0, amplitudes=lambda sites: 2.0 * 0.25 ** np.arange(sites), phase_step=0.1,
        frequency=1.25,
    )  # fmt: skip
    found = floquet.approximate_multipliers(replace(CHAIN, sites=3), closed)
    assert asked == 2 * [(3, False, [0.5, 2.0, 0.5], [0.1, 0.0, 0.1], 1.25)]
    assert 6e-6 <= found.error < 6.1e-6  # six entries of a row
    assert found.growth == pytest.approx(math.log(0.9) / (CHAIN.eps * 2.0 * math.pi / 1.25))


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("entry", [math.inf, math.nan])
def test_variations_along_sinusoids_that_overflow_in_any_part_are_refused(
    entry: float, which: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By few steps or by many."""
    matrices = [np.eye(6), np.eye(6)]
    matrices[which][4, 1] = entry
    made = iter(SimpleNamespace(monodromy=each) for each in matrices)
    monkeypatch.setattr(floquet, "integrate_along_sinusoids", lambda *_, **__: next(made))
    closed: Any = SimpleNamespace(alpha_0=1.0, amplitudes=np.ones, phase_step=0.1, frequency=1.25)
    with pytest.raises(ParameterError, match="so small that variations stay finite"):
        floquet.approximate_multipliers(replace(CHAIN, sites=3), closed)


def test_multipliers_of_the_closed_form_are_those_of_an_odd_chain(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of at most 31 sites; amplitudes are those of the chain itself, outwards from its middle."""
    lengths: list[int] = []
    known = SimpleNamespace(
        stable=False, growth=0.5, trivial=0.125, values=np.array([1.0, 2.0], dtype=complex)
    )

    def along(chain: VdpChain, _: object) -> Any:
        lengths.append(chain.sites)
        return known

    def compared(own: Breather, _: object) -> Breather:
        assert own.frequency_error == 0.0  # (30) is explicit
        assert 0.0 <= own.error < 1e-12
        assert own.fold_error == closed_form_fold(CHAIN).error > 0.0
        return own

    monkeypatch.setattr(breathers, "approximate_multipliers", along)
    monkeypatch.setattr(breathers, "_compared", compared)
    choice = breathers._Choice(Reading.NEIGHBOUR, 0)
    closed = solve_breather(CHAIN)
    assert closed.alpha_0 is not None
    for sites in (8, 9, 30, 31, 40):
        found = breathers._closed_form(AVERAGED.replace(sites=sites), Nucleus(1), choice)
        # (9): each site is smaller than the one before it, and lags behind it by a quarter turn.
        outwards = np.abs(np.arange(sites) - found.amplitudes.argmax())
        expected = closed.alpha_0 * (closed.decay * -1j) ** outwards
        assert found.waves == pytest.approx(expected, rel=1e-12)
        assert found.amplitudes == pytest.approx(np.abs(expected), rel=1e-12)
        assert (found.error, found.decay_error) == pytest.approx(
            (closed.error * closed.alpha_0, closed.error * closed.decay), rel=1e-12, abs=0.0
        )
        assert (found.stable, found.growth, found.trivial) == (False, 0.5, 0.125)
        assert replace(found, error=None).stable is None
        assert found.multipliers is known.values
        assert found.amplitudes.size == sites
        assert found.amplitudes.argmax() == sites // 2 - (sites + 1) % 2
    assert lengths == [9, 9, 31, 31, 31]

    def stiff(*_: object) -> Any:
        raise ParameterError("eps", 1.0, "small", "take less")

    monkeypatch.setattr(breathers, "approximate_multipliers", stiff)
    found = breathers._closed_form(AVERAGED, Nucleus(1), choice)
    assert (found.stable, found.growth, found.trivial, found.multipliers) == (None,) * 4


@pytest.mark.parametrize(
    ("couplings", "turns", "furthest"),
    [([0.1, 0.3], 0, 0.3), ([0.1, 0.3], 1, 2.0), ([0.002, 3.0], 1, 3.0), ([0.1], 0, 0.1)],
)
def test_a_breather_is_followed_from_below_its_smallest_coupling_to_above_its_largest(
    couplings: list[float], turns: int, furthest: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where it is to turn, at least to 2; each fold has the points before it counted."""
    asked: dict[str, Any] = {}

    def start(end: float, lowest: float) -> str:
        asked["start"] = (end, lowest)
        return "start"

    def trace(*given: Any) -> Any:
        asked["trace"] = given
        return SimpleNamespace(folds=folds, fold=folds[0])

    def measured(c: int, _: float, near: Any) -> Breather:
        asked.setdefault("near", []).append(near)
        return Breather(chain=AVERAGED.replace(c=9.0), nucleus=Nucleus(1), seconds=0.0,
                        method=BreatherMethod.ENVELOPE, status=BreatherStatus.EXISTS)  # fmt: skip

    folds = tuple(SimpleNamespace(parameter=c) for c in (0.75, 1.5))

    along = StepControl(length=0.7)
    family = SimpleNamespace(
        system=lambda: "system",
        start=start,
        step_control=lambda _: along,
        measured=measured,
        fold_error=lambda fold: fold.parameter,
    )
    monkeypatch.setattr(follow, "own_family", lambda *_: family)
    monkeypatch.setattr(follow, "trace", trace)
    points = [(SimpleNamespace(parameter=k), k) for k in (0, 1, 1, 2)]
    monkeypatch.setattr(follow, "solutions_at", lambda *_: points)
    monkeypatch.setattr(follow, "_described", lambda _, fold, place: (fold, place))
    found = follow.follow(AVERAGED, couplings, nucleus=Nucleus(1), folds=turns)
    end, lowest = asked["start"]
    assert end == max(couplings)
    assert min(couplings) * (1.0 - 1e-11) < lowest < min(couplings)
    system, begun, until, monitor, steps = asked["trace"]
    assert (system, begun, monitor) == ("system", "start", None)
    assert steps == replace(along, folds=turns)
    assert furthest <= until < furthest * (1.0 + 1e-11)
    assert until > max(couplings)
    assert found.folds == ((folds[0], 1), (folds[1], 3))
    assert asked["near"] == [folds[0]] * 3 + [folds[1]]
    assert {(point.fold, point.fold_error) for point in found.points} == {(1.5, 1.5)}
    assert [point.chain.c for point in found.points[4:]] == couplings
    beyond = {(point.status, point.seconds) for point in found.points[4:]}
    assert beyond == {(BreatherStatus.NONE, 0.0)}  # nothing is computed for them


# --------------------------------------------------------------------------------- its stability


@pytest.mark.parametrize("nucleus", [Nucleus(1), Nucleus(2, "0"), Nucleus(2, "x")])
def test_split_by_reflection_or_not_the_same_exponents_are_found(nucleus: Nucleus) -> None:
    """The mode of the phase, which is left out, has the parity of the breather."""
    chain = AVERAGED.replace(sites=9 + nucleus.size % 2 - 1)
    u = solve_envelope_breather(chain, nucleus).unknowns
    whole, split = (exponents(*unpack(u), chain, mirrored) for mirrored in (False, True))
    assert np.sort(split.values.real) == pytest.approx(np.sort(whole.values.real), abs=1e-9)
    assert split.growth == pytest.approx(whole.growth, abs=1e-9)
    assert max(split.symmetric, split.antisymmetric) == pytest.approx(whole.growth, abs=1e-9)
    assert abs(split.growth) > 1e-4  # not that of the phase


@pytest.mark.parametrize(("part", "stable"), [(-1.0, True), (0.9, True), (1.1, False)])
def test_what_grows_by_more_than_rounding_is_unstable(
    part: float, stable: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of exponents 1e-9 a unit of slow time, of multipliers 1e-8: there it is divided by ε.

    That is so where nothing is known of their errors; rounding of these matrices is far smaller.
    """
    matrix = np.diag([0.0, part * 1e-9, -0.5, -0.4])  # whatever the chain is
    monkeypatch.setattr(exponents_of, "rotating_jacobian", lambda *_: matrix)
    found = exponents(np.ones(2, complex), 0.1, AVERAGED)
    assert 0.0 < found.error < 1e-14
    growing = np.diag([1.0, math.exp(0.01 * 6.0 * part * 1e-8), 0.5, 0.4])
    for each in (found, floquet.floquet_multipliers(growing, 6.0, 0.01, parity=0)):
        assert replace(each, growth_error=math.inf).stable is stable
        assert each.stable is (part < 0.0)


@pytest.mark.parametrize(
    ("growth", "error", "stable"),
    [
        (-2e-6, 1e-6, True),
        (-0.9e-6, 1e-6, None),
        (0.0, 1e-6, None),
        (0.9e-6, 1e-6, None),
        (2e-6, 1e-6, False),
        (-1e-12, 1e-11, True),  # both count as zero
        (0.9e-11, 1e-11, True),
        (1.1e-11, 1e-11, False),  # small, but not zero
        (0.5, math.inf, False),  # nothing is known of the error
    ],
)
def test_stability_is_not_decided_where_the_growth_may_be_of_either_sign(
    growth: float, error: float, stable: bool | None
) -> None:
    found = exponents(np.ones(2, complex), 0.1, AVERAGED.replace(sites=2))
    found = replace(found, growth=growth)
    assert replace(found, growth_error=error).stable is stable
    # Of a breather it is that of the error from the breather of its own chain.
    own = _breather(BreatherMethod.ENVELOPE, stability=replace(found, growth_error=0.0), error=0.5)
    assert replace(own, growth_error=error).stable is stable


@pytest.mark.parametrize("coupling", [1e-5, 3e-5])
def test_a_breather_that_loses_its_phases_slowly_is_not_called_stable(coupling: float) -> None:
    """Between two sites with one between them phases are coupled to the order of c², and repel."""
    chain = AveragedChain(a=2.5, b=0.5, c=coupling, sites=7)
    found = solve_envelope_breather(chain, Nucleus(3, "++"))
    assert found.growth_error is not None
    assert found.growth is not None
    assert found.growth_error < found.growth < 1e-9
    assert found.stable is False
    quicker = solve_envelope_breather(chain.replace(c=1e-3), Nucleus(3, "++"))
    assert quicker.growth == pytest.approx(found.growth * (1e-3 / coupling) ** 2, rel=0.5)
    assert quicker.stable is False


def test_beside_its_fold_the_stability_of_a_breather_is_not_decided() -> None:
    """So close that the growth rate, which changes like a square root, is below its error."""
    chain, edge = AveragedChain(a=1.0, b=0.08, c=1e3, sites=5), Nucleus(1, place=Place.EDGE)
    fold = solve_envelope_breather(chain, edge).fold
    assert fold is not None
    beside, below = (
        solve_envelope_breather(chain.replace(c=fold * (1.0 - part)), edge)
        for part in (1e-13, 1e-3)
    )
    assert (beside.status, below.status) == (BreatherStatus.EXISTS,) * 2  # not beyond it
    assert (beside.stable, below.stable) == (None, True)


def test_exponents_err_by_what_the_error_of_an_amplitude_changes_however_large_it_is() -> None:
    """Of uncoupled cells, along their amplitude, at which growth is -1/2 + 3a|φ|²/8 - …"""
    chain, amplitude, off = AVERAGED.replace(a=4.0, b=1e-3, c=0.0, sites=2), 0.3, 0.0375
    diagonal = np.full(2, np.exp(0.25j * math.pi))  # both parts are off by as much
    found = exponents(amplitude * diagonal, 0.0, chain, error=off / math.sqrt(2.0))
    exact = exponents((amplitude + off) * diagonal, 0.0, chain)
    change = exact.growth - found.growth
    assert change == pytest.approx(1.5 * ((amplitude + off) ** 2 - amplitude**2), rel=1e-3)
    assert change <= found.growth_error < 1.1 * change


def test_a_branch_is_followed_in_as_many_steps_as_reach_its_coupling_up_to_a_limit() -> None:
    waves = RotatingWaves(AVERAGED, Nucleus(1))
    usual = waves.steps_along
    for c_end, steps in ((0.0, 0.0), (2.0, 2.0 * PARAMETER_WEIGHT / usual.longest), (1e9, 1e9)):
        limit = min(usual.max_steps + math.ceil(steps), MAX_STEPS)
        assert waves.step_control(c_end).max_steps == limit
    # Branches of a mirror-symmetric nucleus are crossed by others.
    edge = RotatingWaves(AVERAGED, Nucleus(1, place=Place.EDGE))
    assert (waves.step_control(2.0).generic, edge.step_control(2.0).generic) == (False, True)


@pytest.mark.parametrize(("given", "monitored"), [({}, True), ({"monitored": False}, False)])
def test_along_a_branch_growth_is_monitored_by_default(
    given: dict[str, bool], monitored: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    waves, traced = RotatingWaves(AVERAGED, Nucleus(1)), []
    monkeypatch.setattr(families, "trace", lambda *arguments: traced.append(arguments))
    monkeypatch.setattr(RotatingWaves, "start", lambda *_, **__: "start")
    waves.branch(1.5, **given)
    ((_, start, end, monitor, steps),) = traced
    assert (start, end, steps) == ("start", 1.5, waves.step_control(1.5))
    assert (monitor is not None) is monitored


@pytest.mark.parametrize(("c", "exists"), [(0.1, True), (0.29, True), (0.31, False)])
def test_a_breather_exists_up_to_the_first_fold_of_its_branch(
    c: float, exists: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A branch may pass its fold on the step on which it passes the coupling."""
    fold = fold_of(0.3, 0.0, np.zeros(1))
    monkeypatch.setattr(RotatingWaves, "directly", lambda _: None)
    monkeypatch.setattr(RotatingWaves, "branch", lambda *_, **__: SimpleNamespace(fold=fold))
    monkeypatch.setattr(RotatingWaves, "fold_error", lambda *_: 0.125)
    monkeypatch.setattr(RotatingWaves, "measured", lambda _, point, __, near: (point, near))
    monkeypatch.setattr(families, "arrive", lambda _, __, at: at)
    found: Any = RotatingWaves(AVERAGED.replace(c=c), Nucleus(1)).solve()
    if exists:
        assert found == (c, fold)
    else:
        assert (found.status, found.fold, found.fold_error) == (BreatherStatus.NONE, 0.3, 0.125)


@pytest.mark.parametrize(("a", "b"), [(1.0, 0.0), (0.0, 1.0)])
def test_the_bound_on_second_derivatives_of_the_damping_is_sharp_for_each_term(
    a: float, b: float
) -> None:
    chain: Any = SimpleNamespace(a=a, b=b)
    r, h = 1.5, 1e-3

    def damped(phi: Any) -> Any:
        return -0.5 * phi * (1.0 - a * np.abs(phi) ** 2 / 4.0 + b * np.abs(phi) ** 4 / 8.0)

    aside = h * np.exp(1j * np.linspace(0.0, math.pi, 181))
    second = np.abs(damped(r + aside) - 2.0 * damped(r) + damped(r - aside)) / h**2
    # Finite differences err by h²/2r² of the second derivative.
    assert second.max() == pytest.approx(
        exponents_of._second_derivative_bound(r, chain), rel=(h / r) ** 2
    )


def test_only_what_is_its_own_mirror_image_is_split() -> None:
    family = RotatingWaves(AVERAGED, Nucleus(1))
    u = solve_envelope_breather(AVERAGED, Nucleus(1)).unknowns
    assert family.stability(u, 0.1).symmetric is not None
    assert family.stability(u, 0.1, split=False).symmetric is None
    assert exponents(*unpack(u), AVERAGED).symmetric is None
    edge = RotatingWaves(AVERAGED, Nucleus(1, place=Place.EDGE))
    assert edge.stability(edge.solve().unknowns, 0.1).symmetric is None


def test_multipliers_of_an_averaged_breather_are_of_its_own_period() -> None:
    found = solve_envelope_breather(AVERAGED, Nucleus(1))
    assert found.multipliers is not None
    expected = np.exp(AVERAGED.eps * found.period * found.stability.values)
    assert found.multipliers == pytest.approx(expected, rel=1e-14)


def test_a_solution_far_from_its_start_is_another_pattern() -> None:
    guess = np.array([0.0, 1.0, 1.0, 0.0], dtype=complex)
    chain = AVERAGED.replace(sites=4)
    far = 0.3 * chain.stable_amplitude
    for change, left in ((0.999 * far, False), (1.001 * far, True)):
        for side in (-1.0, 1.0, 1j):
            phi = guess + np.array([5.0, 0.0, side * change, 5.0])  # of excited sites only
            assert envelope._has_left_pattern(phi, guess, np.array([1, 2]), chain) is left


# ------------------------------------------------------------------------------- its methods


@pytest.mark.parametrize(
    ("chain", "nucleus", "methods"),
    [
        (CHAIN, Nucleus(1), {"closed-form", "envelope", "orbit", "simulation"}),
        (CHAIN, Nucleus(2, "0"), {"envelope", "orbit", "simulation"}),
        (CHAIN, Nucleus(1, place=Place.EDGE), {"envelope", "orbit", "simulation"}),
        (AVERAGED, Nucleus(1), {"closed-form", "envelope", "simulation"}),
        (AVERAGED, Nucleus(2, "0"), {"envelope", "simulation"}),
    ],
)
def test_side_by_side_stand_the_methods_that_apply(
    chain: Any, nucleus: Nucleus, methods: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    made = {
        each: lambda *given, each=each: asked.append(given) or _breather(each)
        for each in BreatherMethod
    }
    monkeypatch.setattr(breathers, "_METHODS", made)
    chain = chain.replace(sites=8)
    found = breathers.breather(chain, nucleus=nucleus, method="all")
    assert set(found.methods) == methods
    for name, each in found.methods.items():
        assert each.method == name
    assert asked == [(chain, nucleus, breathers._Choice(Reading.NEIGHBOUR, 0))] * len(methods)


def test_only_a_nucleus_of_the_whole_chain_is_in_phase_at_an_edge() -> None:
    """Elsewhere a breather of three sites in phase has no pattern of its own."""
    edge = Nucleus(3, place=Place.EDGE)
    assert breathers.with_pattern(edge, 3).pattern == "00"
    assert breathers.with_pattern(Nucleus(2, place=Place.EDGE), 4).pattern == "0"
    with pytest.raises(ParameterError, match="pattern"):
        breathers.with_pattern(edge, 4)


@pytest.mark.parametrize("frequency", [1.01, None])
def test_of_the_averaged_chain_the_averaged_breather_is_compared_with_no_other(
    frequency: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = _breather(BreatherMethod.ENVELOPE, frequency=frequency, error=0.5)
    compared = replace(own, error=0.25)
    monkeypatch.setattr(breathers, "solve_envelope_breather", lambda *_: own)
    monkeypatch.setattr(breathers, "_compared", lambda *_: compared)
    choice = breathers._Choice(Reading.NEIGHBOUR, 0)
    assert breathers._envelope(AVERAGED, Nucleus(1), choice) is own
    expected = own if frequency is None else compared
    assert breathers._envelope(CHAIN, Nucleus(1), choice) is expected


@pytest.mark.parametrize(
    ("fold", "status"), [(None, BreatherStatus.ESCAPED), (0.05, BreatherStatus.NONE)]
)
@pytest.mark.parametrize("chain", [CHAIN, AVERAGED])
def test_a_run_that_escapes_shows_that_there_is_no_breather_only_beyond_a_known_fold(
    chain: Any, fold: float | None, status: BreatherStatus, monkeypatch: pytest.MonkeyPatch
) -> None:
    escaped = replace(_breather(BreatherMethod.SIMULATION), status=BreatherStatus.ESCAPED)
    for name in ("run_breather", "run_averaged_breather"):
        monkeypatch.setattr(breathers, name, lambda *_, **__: escaped)
    asked: list[Any] = []
    monkeypatch.setattr(
        breathers, "_fold_below", lambda *given: asked.extend(given) or (fold, fold)
    )
    found = breathers.breather(chain, method="simulation")
    assert (found.status, found.fold) == (status, fold)
    assert asked == [chain, Nucleus(1)]


@pytest.mark.parametrize(
    ("c", "known"), [(0.099, False), (0.105, False), (0.109, False), (0.111, True), (0.3, True)]
)
def test_a_fold_is_known_to_be_below_what_lies_beyond_its_error(
    c: float, known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        breathers, "breather_threshold", lambda *_: SimpleNamespace(c_crit=0.1, error=0.01)
    )
    found = breathers._fold_below(replace(CHAIN, c=c), Nucleus(1))
    assert found == ((0.1, 0.01) if known else (None, None))


def test_a_fold_that_is_not_found_is_not_known_to_be_below(monkeypatch: pytest.MonkeyPatch) -> None:
    for error in (NotConvergedError("lost"), ParameterError("nucleus", 1, "wider", "widen it")):

        def lost(*_: object, error: Exception = error) -> Any:
            raise error

        monkeypatch.setattr(breathers, "breather_threshold", lost)
        assert breathers._fold_below(CHAIN, Nucleus(1)) == (None, None)


def test_an_averaged_breather_is_compared_with_the_chain_it_stands_for_and_if_it_exists(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the averaged chain it is the breather itself."""
    compared: list[Any] = []

    def other(found: Breather, chain: Any) -> Breather:
        compared.append(chain)
        averaged = solve_envelope_breather(chain, found.nucleus)
        assert (found.error, found.frequency_error) == (averaged.error, averaged.frequency_error)
        return replace(found, error=0.5, frequency_error=0.25)

    monkeypatch.setattr(breathers, "_compared", other)
    own = solve_envelope_breather(AVERAGED, Nucleus(1))
    assert breathers.breather(AVERAGED, method="envelope").error == own.error
    beyond = breathers.breather(replace(CHAIN, c=0.3), method="envelope")
    assert (beyond.status, beyond.error, compared) == (BreatherStatus.NONE, None, [])
    found = breathers.breather(CHAIN, method="envelope")
    assert (found.error, found.frequency_error, compared) == (0.5, 0.25, [CHAIN])


def test_beyond_its_fold_the_averaged_breather_is_none_and_the_fold_has_an_error() -> None:
    """The fold by the real reduction, which has half of the unknowns and no ends."""
    for size, pattern in ((1, ""), (3, "-+")):
        nucleus = Nucleus(size, pattern)
        found = RotatingWaves(replace(AVERAGED, c=0.3, sites=size + 20), nucleus).solve()
        fold = envelope.quarter_turn_branch(found.chain, nucleus).fold
        assert found.status is BreatherStatus.NONE
        assert found.fold is not None
        assert found.fold == pytest.approx(fold.parameter, abs=2e-11)
        assert 0.0 < found.fold_error < 2e-11


def test_along_a_branch_the_growth_is_recorded_unless_it_is_not_asked_for() -> None:
    waves = RotatingWaves(AVERAGED.replace(sites=3), Nucleus(1))
    branch, without = waves.branch(), waves.branch(monitored=False)
    first = branch.points[0]
    assert branch.monitored[0] == waves.monitor(first.u, first.parameter)
    assert set(without.monitored) == {()}


def test_the_real_reduction_is_followed_along_its_branch() -> None:
    """Along each tangent F does not change."""
    for point in envelope.quarter_turn_branch(AVERAGED, Nucleus(1)).points:
        du, dc = point.tangent[:-1], point.tangent[-1] / PARAMETER_WEIGHT
        ahead, behind, beside = (
            envelope.quarter_turn_rate(
                point.u + step * du, AVERAGED.replace(c=point.parameter + also * dc)
            )
            for step, also in ((1e-5, 1e-5), (-1e-5, -1e-5), (-1e-5, 1e-5))
        )
        change = np.abs(ahead - behind).max()
        assert change < 1e-8
        assert abs(dc) < 1e-3 or np.abs(ahead - beside).max() > 100.0 * change


@pytest.mark.parametrize(
    "nucleus", [Nucleus(2, "0"), Nucleus(3, "+0"), Nucleus(3, "xx"), Nucleus(1, place=Place.EDGE)]
)
def test_the_real_reduction_is_of_quarter_turns_in_the_bulk(nucleus: Nucleus) -> None:
    with pytest.raises(ParameterError, match="use the full envelope"):
        envelope.quarter_turn_branch(AVERAGED, nucleus)


# --------------------------------------------------------------------------------- its result


def _breather(method: BreatherMethod, **given: Any) -> Breather:
    return Breather(
        chain=replace(CHAIN, sites=3), nucleus=given.pop("nucleus", Nucleus(1)), method=method,
        status=BreatherStatus.EXISTS, seconds=0.0, **given,
    )  # fmt: skip


def test_the_period_of_an_orbit_is_what_was_solved_for() -> None:
    unknowns = np.array([1.0, 2.0, 3.0])
    for method, period in ((BreatherMethod.ORBIT, 3.0), (BreatherMethod.ENVELOPE, math.pi)):
        assert _breather(method, frequency=2.0, unknowns=unknowns).period == period


def test_of_a_breather_that_does_not_exist_nothing_has_been_solved_for() -> None:
    none = _breather(BreatherMethod.ORBIT)
    arrays = (none.unknowns, none.state, none.amplitudes, none.waves, none.phases)
    assert [each.size for each in arrays] == [0] * 5
    assert none.multipliers is None


def test_waves_are_apart_by_those_of_the_sites_that_both_chains_have_whichever_is_longer() -> None:
    """Both turned so that their centres are real; of the first, what is beyond counts whole."""
    few, many = np.array([1j, 2j, 1.25j]), np.array([7.0, 0.5, 3.0, -8.0, -3.0, 1.0, 7.0])
    of = BreatherMethod.ENVELOPE
    short, long = (
        replace(_breather(of, waves=waves + 0j), chain=replace(CHAIN, sites=waves.size))
        for waves in (few, many)
    )
    at = breathers._wave_distances
    assert at(short, long) == pytest.approx([4.0, 6.0, 1.75])  # 2 and 8 at the centre
    beyond = [7.0, 0.5, 4.0, 6.0, 1.75, 1.0, 7.0]
    assert at(long, short) == pytest.approx(beyond)  # beyond the other chain
    assert at(short, short).tolist() == [0.0] * 3


def test_the_phase_step_is_from_the_last_site_of_the_nucleus_to_the_next() -> None:
    waves = np.exp(1j * np.array([0.1, 0.4, 0.9]))
    of = BreatherMethod.ENVELOPE
    assert _breather(of, waves=waves).phase_step == pytest.approx(0.5)
    edge = Nucleus(1, place=Place.EDGE)
    assert _breather(of, waves=waves, nucleus=edge).phase_step == pytest.approx(0.3)
    two = Nucleus(2, "0", Place.EDGE)
    assert _breather(of, waves=waves, nucleus=two).phase_step == pytest.approx(0.5)
    assert _breather(of, waves=waves, nucleus=Nucleus(3, "00")).phase_step is None
    assert _breather(of).phase_step is None


@pytest.mark.parametrize(
    ("nucleus", "outward", "inward"),
    [
        (Nucleus(1), [3.0, 4.0, 5.0], [3.0, 2.0, 1.0]),
        (Nucleus(2, "0"), [4.0, 5.0, 6.0], [3.0, 2.0, 1.0]),
        (Nucleus(3, "-+"), [3.0, 4.0, 5.0], [3.0, 2.0, 1.0]),
        (Nucleus(4, "000"), [4.0, 5.0, 6.0], [3.0, 2.0, 1.0]),
        (Nucleus(5, "0000"), [3.0, 4.0, 5.0], [3.0, 2.0, 1.0]),
        (Nucleus(1, place=Place.EDGE), [1.0, 2.0, 3.0, 4.0, 5.0], [1.0]),
        (Nucleus(2, "0", Place.EDGE), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], []),
    ],
)
def test_amplitudes_are_listed_from_the_centre_to_either_end(
    nucleus: Nucleus, outward: list[float], inward: list[float]
) -> None:
    """Of an even number of excited sites the two in the middle begin either list."""
    amplitudes = np.arange(1.0, 6.0 + (nucleus.size + 1) % 2)
    own = _breather(BreatherMethod.ENVELOPE, nucleus=nucleus, amplitudes=amplitudes)
    found = replace(own, chain=replace(CHAIN, sites=amplitudes.size))
    assert (found.outward.tolist(), found.inward.tolist()) == (outward, inward)


def test_side_by_side_a_breather_has_its_centre_and_neighbour() -> None:
    of = BreatherMethod.ENVELOPE
    rows = {"a": _breather(of, amplitudes=np.array([0.5, 2.0, 0.25])), "b": _breather(of)}
    found = BreatherComparison(chain=CHAIN, nucleus=Nucleus(1), methods=rows, seconds=0.0)
    columns = found.columns()
    assert columns["centre"][0] == 2.0
    assert columns["neighbour"][0] == 0.25
    assert np.isnan([columns["centre"][1], columns["neighbour"][1]]).all()


# --------------------------------------------------------------------------- how a run has ended


@pytest.mark.parametrize(
    ("drifts", "left"),
    [
        ([1e-3], math.inf),
        ([1e-3, 5e-4], run.BLOCK * 5e-4 / 0.5),
        ([9.0, 1e-3, 1e-4], run.BLOCK * 1e-4 / 0.9),
        ([1e-3, 2e-3], run.BLOCK * 2e-3 / 0.01),  # it does not fall
        ([0.0, 0.0], 1e-12),
    ],
)
def test_what_is_still_to_come_is_a_geometric_series(drifts: list[float], left: float) -> None:
    assert run._remaining_distance(drifts) == pytest.approx(left)


class _Envelope:
    """Runs of (43) that are made up: so much drift after each block, and when one escapes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, drifts: list[float], escape: int) -> None:
        self.drifts, self.escape, self.starts = drifts, escape, []
        monkeypatch.setattr(run, "run_envelope", self.block)
        monkeypatch.setattr(run, "envelope_rate", self.rate)

    def block(self, chain: Any, phi: Any, duration: float, **given: Any) -> Any:
        assert given["limit"] == chain.unstable_amplitude
        self.starts.append(phi)
        return SimpleNamespace(
            phi=np.arange(1.0, 6.0) * 1j, time=duration, escaped=len(self.starts) == self.escape
        )

    def rate(self, phi: Any, chain: Any) -> Any:
        """It turns by 0.25 a unit of time, but for one site beside."""
        drift = self.drifts[min(len(self.starts), len(self.drifts)) - 1]
        return 0.25j * phi - drift * (np.arange(5) == 4)


def test_a_run_of_the_averaged_chain_ends_when_its_drift_is_small(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain = AveragedChain(a=2.5, b=0.5, c=0.1, sites=5)
    made = _Envelope(monkeypatch, [1e-2, 1e-6, 0.99 * run.TOLERANCE], 0)
    found = run.run_averaged_breather(chain, Nucleus(1), seed=0)
    assert found.status is BreatherStatus.SETTLED
    assert found.time == pytest.approx(3.0 * run.BLOCK / chain.eps)
    assert found.frequency == pytest.approx(1.0 + 0.25 * chain.eps)
    assert found.drift == pytest.approx(0.99 * run.TOLERANCE)
    assert (found.error_unknown, found.stable) == ("", None)
    assert found.amplitudes == pytest.approx([1.0, 2.0, 3.0, 4.0, 5.0])
    assert found.error == pytest.approx(run._remaining_distance([1e-6, 0.99 * run.TOLERANCE]))
    assert found.wave_error == pytest.approx(2.0 * (1.0 + 5.0 / 3.0) * found.error)
    noise = made.starts[0] - Nucleus(1).envelope(chain)
    parts = np.random.default_rng(0).normal(size=(2, 5))
    assert noise == pytest.approx(run.NOISE * (parts[0] + 1j * parts[1]), abs=1e-15)


def test_a_run_has_the_same_noise_and_drift_by_whichever_function_it_is_asked_for() -> None:
    seeds = [
        inspect.signature(each).parameters["seed"].default
        for each in (breathers.breather, run.run_breather)
    ]
    assert seeds == [0, 0]
    # That of the averaged chain has no other.
    drift = inspect.signature(run.run_breather).parameters["tolerance"].default
    assert drift == run.TOLERANCE == 1e-8


@pytest.mark.parametrize("status", [BreatherStatus.SETTLED, BreatherStatus.UNSETTLED])
def test_a_run_that_has_died_has_settled_and_has_the_drift_of_its_last_block(
    status: BreatherStatus,
) -> None:
    found = run._at_end(
        CHAIN, Nucleus(1), status, [1e-3, 1e-5, 1e-9], waves=np.zeros(9, complex),
        amplitudes=np.full(9, 0.99 * CHAIN.unstable_amplitude), frequency=1.0, elapsed=7.0,
        started=0.0,
    )  # fmt: skip
    died = status is BreatherStatus.SETTLED
    assert found.status is (BreatherStatus.DIED if died else BreatherStatus.UNSETTLED)
    assert (found.drift, found.time, found.frequency) == (1e-9, 7.0, None)


@pytest.mark.parametrize(
    ("escape", "status", "blocks"),
    [(0, BreatherStatus.UNSETTLED, 300), (2, BreatherStatus.ESCAPED, 2)],
)
def test_a_run_that_does_not_settle_ends_when_it_escapes_or_its_time_is_over(
    escape: int, status: BreatherStatus, blocks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = _Envelope(monkeypatch, [1.01 * run.TOLERANCE], escape)
    chain = AveragedChain(a=2.5, b=0.5, c=0.1, sites=5)
    found = run.run_averaged_breather(chain, Nucleus(1), seed=0)
    assert (found.status, found.error, found.stable) == (status, None, None)
    assert found.error_unknown == status.sentence
    assert len(made.starts) == blocks == round(found.time * chain.eps / run.BLOCK)
    assert (found.wave_error, found.phases_error.size) == (None, 0)


@pytest.mark.parametrize(
    ("drifts", "far", "status", "blocks"),
    [
        ([1e-2, 0.9e-8], 0, BreatherStatus.SETTLED, 2),
        ([1.1e-8], 0, BreatherStatus.UNSETTLED, 295),  # eight rounds of 6.5 are 5.1 of slow time
        ([1e-2], 3, BreatherStatus.ESCAPED, 3),
        ([], 1, BreatherStatus.ESCAPED, 1),
    ],
)
def test_a_run_of_the_chain_ends_as_one_of_its_average_does(
    drifts: list[float], far: int, status: BreatherStatus, blocks: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Escaped is who leaves the nucleus; a site that is displaced and turns fast is as far.

    In the unit of y of this chain the level that it crosses is below one.
    """
    chain = VdpChain(a=10.0, b=8.0, c=0.1, eps=0.098, sites=3)
    times: list[float] = []
    measured: list[float] = []
    begun: list[Any] = []
    taken: list[int] = []
    level = chain.unstable_amplitude

    def integrate(_: object, start: Any, time: float, steps: int, *___: object) -> Any:
        times.append(time)
        begun.append(start)
        taken.append(steps)
        beside = 0.75 * level if len(times) == far else 0.7 * level
        state = np.array([0.0, 3.0 * level, beside, 0.0, 0.0, beside])
        return SimpleNamespace(state=state, samples=np.full((64, 3), 3.0 * level))

    def period(_: object, __: object, guess: float, steps: int) -> tuple[float, float]:
        measured.append(guess)
        assert steps == 2 * run._steps(chain)  # half the step of the run
        return 6.5, drifts[min(len(measured), len(drifts)) - 1]

    monkeypatch.setattr(run, "integrate_chain", integrate)
    monkeypatch.setattr(run, "_period", period)
    found = run.run_breather(chain, Nucleus(1))
    assert found.status is status
    assert len(times) == blocks + 1  # and the last period, which is measured
    assert found.time == pytest.approx(sum(times[:-1]))
    assert found.time == pytest.approx(8.0 * (2.0 * math.pi + (blocks - 1) * 6.5))
    assert found.drift == (None if not measured else drifts[-1])
    # At the start y = Im φ is zero and ẏ = Re φ that of the cycle, but for noise.
    noise = np.abs(begun[0] - [0.0, 0.0, 0.0, 0.0, chain.stable_amplitude, 0.0])
    assert 0.0 < noise.min() < noise.max() < 5e-6
    assert taken[0] == 8 * run._steps(chain)
    assert taken[-1] >= 2 * run._steps(chain) > 64  # samples of the last period


def test_a_run_of_the_chain_is_refused_where_its_step_is_too_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class BegunError(Exception): ...

    def begun(*_: object) -> Any:
        raise BegunError

    monkeypatch.setattr(run, "integrate_chain", begun)
    with pytest.raises(BegunError):
        run.run_breather(replace(CHAIN, eps=0.2), Nucleus(1))
    with pytest.raises(ParameterError, match=r"eps = 0\.2001 .* at most 0\.2 "):
        run.run_breather(replace(CHAIN, eps=0.2001), Nucleus(1))


@pytest.mark.parametrize("moved", [-1e-5, 1e-5])
def test_the_period_of_a_run_is_that_after_which_it_is_nearest_to_where_it_was(
    moved: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By as many steps as are asked for; here it turns faster, and is moved by 1e-5 in a turn."""
    asked: set[tuple[int, int]] = set()
    period = 6.25
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=2)

    def integrate(_: Any, state: Any, time: float, steps: int, order: int) -> Any:
        asked.add((steps, order))
        angle = 2.0 * math.pi * (time - period) / period
        y, v = state[:2], state[2:]
        turned = np.concatenate(
            [y * math.cos(angle) + v * math.sin(angle), v * math.cos(angle) - y * math.sin(angle)]
        )
        return SimpleNamespace(state=turned + moved * np.array([0.0, 0.0, 1.0, 0.0]))

    monkeypatch.setattr(run, "integrate_chain", integrate)
    found, drift = run._period(chain, np.array([0.0, 0.0, 0.0, 2.0]), 2.0 * math.pi, 44)
    assert found == pytest.approx(period, abs=1e-12)
    assert drift == pytest.approx(abs(moved) / (chain.eps * period))
    assert asked == {(44, run.ORDER)}


@pytest.mark.parametrize("eps", [1e-3, 0.1, 0.2])
def test_a_run_has_more_steps_where_damping_is_stronger_up_to_a_bound(eps: float) -> None:
    """max |1 - ay² + by⁴| on the stable cycle is (1 + 7s)/(1 - s), s² = 1 - 8η."""
    s = math.sqrt(1.0 - 8.0 * CHAIN.eta)
    stiffness = eps * (1.0 + 7.0 * s) / (1.0 - s)
    assert (stiffness > 6.0) is (eps == 0.2)
    steps = run._steps(replace(CHAIN, eps=eps))
    assert steps == 20 + math.ceil(20.0 * min(stiffness, 6.0))


@pytest.mark.parametrize("mirrored", [True, False])
def test_a_nucleus_that_was_followed_is_the_one_of_the_finer_run(
    mirrored: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its outcome, its run and its symmetry; the other run confirms it, or does not."""
    even, odd = np.array([[9.0, 9.0, 0.0], [1.0, 2.0, 1.0]]), np.array([[1.0] * 3, [1.0, 2.0, 3.0]])
    made: list[Any] = []

    def simulate(*_: object, tolerance: float, **__: object) -> Any:
        psi = even if (tolerance < 1e-7) is mirrored else odd
        made.append(SimpleNamespace(psi=psi, arrivals=np.zeros(3), tolerance=tolerance))
        return made[-1]

    ends = {True: SimpleNamespace(outcome="finer"), False: SimpleNamespace(outcome="coarser")}
    monkeypatch.setattr(outcome, "simulate", simulate)
    monkeypatch.setattr(outcome, "evolution_of", lambda each: ends[each is made[0]])
    found = outcome.follow_nucleus(replace(CHAIN, sites=3), slow_time=5.0, perturbation=0.0, seed=0)
    assert made[0].tolerance < made[1].tolerance
    assert (found.run, found.evolution) == (made[0], ends[True])
    assert (found.mirrored, found.confirmed, found.same_until) == (mirrored, False, 5.0)


def test_the_outcome_of_a_run_is_that_of_its_whole_time_and_of_its_last_width() -> None:
    """In slow time; a nucleus that has grown at once and stays as wide is a larger one."""
    arrivals = np.array([math.nan, 300.0, 0.0, 300.0, math.nan])
    made: Any = SimpleNamespace(
        chain=CHAIN.replace(eps=0.1, sites=5), arrivals=arrivals, width=np.array([1, 3, 2, 3]),
        times=np.array([0.0, 10.0, 900.0, 2000.0]),
    )  # fmt: skip
    found = outcome.evolution_of(made)
    assert (found.outcome, found.size) == (outcome.NucleusOutcome.LARGER, 3)
    assert found.sizes == ((0.0, 1), (30.0, 3))


@pytest.mark.parametrize("perturbation", [0.0, 0.5])
def test_the_start_of_a_nucleus_is_perturbed_if_that_is_asked_for(
    perturbation: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    class StopError(Exception): ...

    def begun(_: object, start: Any, *__: object, **___: object) -> Any:
        farthest = np.abs(start[:, [0, 1, 7, 8]]).max()
        assert (farthest > 0.1) == (farthest > 0.0) == (perturbation > 0.0)
        raise StopError

    monkeypatch.setattr(outcome, "simulate", begun)
    with pytest.raises(StopError):
        outcome.follow_nucleus(replace(CHAIN, sites=9), perturbation=perturbation, seed=0)


@pytest.mark.parametrize("size", [1, 3])
def test_a_nucleus_is_begun_in_the_middle(size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    class StopError(Exception): ...

    def begun(_: object, start: Any, *__: object, **___: object) -> Any:
        excited = np.abs(start).max(axis=0) > 0.1
        assert excited.sum() == size
        assert excited.tolist() == excited[::-1].tolist()
        raise StopError

    monkeypatch.setattr(outcome, "simulate", begun)
    with pytest.raises(StopError):
        outcome.follow_nucleus(replace(CHAIN, sites=9), size, perturbation=0.0, seed=0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_run_is_as_far_from_the_orbit_of_its_size_as_the_farthest_of_its_sites(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The orbit is that of a chain with at most as much rest on either side."""
    lengths: list[int] = []

    def solve(chain: Any, nucleus: Nucleus) -> Any:
        lengths.append(chain.sites)
        amplitudes = np.zeros(chain.sites)
        amplitudes[nucleus.first(chain.sites)] = 2.0
        return SimpleNamespace(amplitudes=amplitudes, growth=0.125)

    monkeypatch.setattr(outcome, "solve_orbit", solve)
    for sites in (9, 41):
        chain = replace(CHAIN, sites=sites)
        amplitude = np.zeros((3, sites))
        amplitude[:2] = 7.0
        amplitude[2, sites // 2 - 1] = 2.0 + 0.25 * side
        made: Any = SimpleNamespace(
            evolution=SimpleNamespace(size=3), run=SimpleNamespace(chain=chain, amplitude=amplitude)
        )
        found = outcome.distance_from_breather(made)
        assert (found.gap, found.growth) == (0.25, 0.125)
    assert lengths == [9, 3 + 2 * outcome.MARGIN]


def test_the_rounding_of_a_rotating_wave_is_that_of_all_its_terms() -> None:
    """Of a site with |φ|² = 2: 1/2 + 2a/8 + 4b/16, Ω, and c/2 at it and beside it.

    Damping leaves the real and the imaginary part what they are, the others turn them into each
    other.
    """
    family = RotatingWaves(AveragedChain(a=8.0, b=4.0, c=0.0, sites=2), Nucleus(1))
    for c, site in ((0.0, 1.0 + 1.0j), (2.0, 1.4 + 0.2j), (2.0, -0.2 - 1.4j)):
        off = family._f_rounding(np.array([site, 0.0]), -0.25, c) * family.unit * family.rate_unit
        damped, turned, beside = 0.5 + 2.0 + 1.0, 0.25 + 0.5 * c, 0.5 * c
        x, y = abs(site.real), abs(site.imag)
        sites = [damped * x + turned * y, beside * y, damped * y + turned * x, beside * x]
        terms = 4.0 * EPSILON * np.array([*sites, 0.0])
        assert off.tolist() == pytest.approx(terms.tolist(), rel=1e-12, abs=0.0)
