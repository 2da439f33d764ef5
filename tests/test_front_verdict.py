"""The verdict on a front of (44): from periods that are made up, so that the answer is known."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from verification.fronts.status import FrontStatus
from verification.piecewise import verdict
from verification.piecewise.chain import PiecewiseMotion, Rest, Switching
from verification.piecewise.run import FrontRun
from verification.piecewise.simulation import simulate_front
from verification.piecewise.verdict import BLOCK, History
from verification.piecewise.window import (
    ChainState,
    switching_amplitude,
    travelling_state,
    window_length,
)

GROUP = 5
FLOOR = 1e-6


def _history(floor: float = FLOOR) -> Any:
    """Return what the rules ask of a history: how much of a spread is rounding."""
    made = SimpleNamespace(_floor=lambda: floor)
    made._relative_error = lambda spreads: History._relative_error(made, spreads)
    return made


@pytest.mark.parametrize("ratio", [0.5, 0.9, 0.99])
def test_the_error_bounds_what_a_geometric_approach_has_still_before_it(ratio: float) -> None:
    """A block that begins d from the limit and ends q d from it spreads by (1 - q) d."""
    left = 0.1 * ratio ** np.arange(30)
    spreads = (1.0 - ratio) * left
    error = History._relative_error(_history(1e-12), spreads)
    assert left[-1] == pytest.approx(error, rel=1e-2)  # no mean over it is farther away


def test_the_error_of_a_motion_that_does_not_settle_is_neither_small_nor_negative() -> None:
    growing = 1e-3 * 1.5 ** np.arange(12)
    assert History._relative_error(_history(), growing) >= 100.0 * growing[-1]


def test_the_slower_of_two_decays_counts() -> None:
    """The last step may be a fast one by chance: five blocks before it fell by half only."""
    spreads = np.array([0.1] * GROUP + [0.05] * (GROUP - 1) + [0.005])
    slow = 0.5 ** (1 / GROUP)
    expected = spreads[-1] / (1.0 - slow)
    assert History._relative_error(_history(), spreads) == pytest.approx(expected)


def test_what_rounding_explains_is_steady_however_small_the_tolerance() -> None:
    at_floor = np.full(6, FLOOR)
    assert History._is_steady(_history(), at_floor, 1e-12)
    assert not History._is_steady(_history(), 30.0 * at_floor, 1e-12)
    assert History._is_steady(_history(), 30.0 * at_floor, 1e-3)


def test_a_block_that_is_quiet_by_chance_is_not_steady_yet() -> None:
    assert not History._is_steady(_history(), np.array([0.1, 0.1, 1e-9]), 1e-3)
    assert not History._is_steady(_history(), np.array([1e-9, 1e-9]), 1e-3)
    assert History._is_steady(_history(), np.array([1e-9, 1e-9, 1e-9]), 1e-3)


def test_the_last_block_but_one_must_be_nearly_steady_already() -> None:
    quiet, loud = 1e-13, 1e-6
    history = _history(1e-14)
    for spreads, steady in (
        ((loud, quiet, quiet), True),
        ((quiet, loud, quiet), False),
        ((loud, 0.1 * loud, quiet, quiet), True),
        ((quiet, quiet, loud, quiet), False),
    ):
        assert History._is_steady(history, np.array(spreads), 1e-12) is steady


def test_a_decay_is_that_of_the_last_two_groups_of_blocks() -> None:
    """Not of groups before, in which it may have been faster."""
    first, second = [1e-2, *[1e-3] * (GROUP - 1)], [5e-3, *[1e-3] * (GROUP - 2), 1e-4]
    expected = second[-1] / (1.0 - (second[0] / first[0]) ** (1 / GROUP))
    for before in ([], [1.0] * GROUP, [1e3] * 3 * GROUP):
        error = History._relative_error(_history(), np.array([*before, *first, *second]))
        assert error == pytest.approx(expected)


def _groups(*largest: float) -> npt.NDArray[np.float64]:
    """Return spreads in groups of five, of each of which one is large."""
    return np.concatenate([[0.01 * each] * (GROUP - 1) + [each] for each in largest])


@pytest.mark.parametrize(
    ("largest", "shrinks"),
    [
        ((1.0, 0.9, 0.8), True),
        ((9.0, 1.0, 0.9, 0.8), True),  # only the last three count
        ((1.0, 0.9, 0.9), False),
        ((0.9, 0.9, 0.8), False),
        ((1.0, 0.995, 0.99), False),  # by less than a hundredth
        ((1.0, 0.985, 0.97), True),  # by more than that, twice
        ((1.0, 0.995, 0.9), False),
        ((1.0, 0.9), False),
    ],
)
def test_spreads_shrink_if_the_largest_of_a_group_falls_twice(
    largest: tuple[float, ...], shrinks: bool
) -> None:
    assert verdict._shrinks(_groups(*largest)) is shrinks
    # as they fall that far, a motion is settling if they are small besides
    assert verdict._decays(0.11 * _groups(*largest)) is False
    assert verdict._decays(0.09 * _groups(*(100.0 * largest[0], *largest[-3:]))) is shrinks


def test_the_error_of_an_unsteady_front_is_half_the_range_of_five_means() -> None:
    periods = np.repeat([1.0, 2.0, 4.0, 5.0, 10.0], 8)
    assert verdict._spread_of_means(periods) == pytest.approx((1.0 - 0.1) / 2.0)
    assert verdict._spread_of_means(periods[::-1]) == pytest.approx((1.0 - 0.1) / 2.0)
    assert verdict._spread_of_means(np.array([1.0, 2.0])) == 0.25
    # of a single period nothing is known but itself
    assert verdict._spread_of_means(np.array([2.0])) == 0.5


@pytest.mark.parametrize("lag", [1, 2, 7, 60])
def test_a_repeat_is_the_smallest_number_of_sites_after_which_periods_come_again(lag: int) -> None:
    rng = np.random.default_rng(lag)
    once = 1.0 + 0.1 * rng.random(lag)
    periods = np.resize(once, 120)
    assert verdict._repeat(periods) == lag
    periods[-1] *= 1.0 + 1e-6
    assert verdict._repeat(periods) is None


@pytest.mark.parametrize("step", [1e-3, -1e-3])
def test_periods_that_become_longer_or_shorter_do_not_repeat(step: float) -> None:
    assert verdict._repeat(1.0 + step * np.arange(150)) is None


SITES = 2048


class _Made:
    """A chain whose switchings are made up, in a window that never has to be moved."""

    sites, origin, grazes, threshold = SITES, -SITES // 2, 0, 0.5

    def __init__(self, switchings: Iterator[Switching]) -> None:
        self._switchings = switchings

    def advance(self, _: float) -> Switching:
        return next(self._switchings)

    def zone(self) -> tuple[int, int]:
        return SITES // 2 + 1, SITES // 2

    def state(self) -> ChainState:
        return ChainState(np.zeros(SITES, complex), self.origin)


def _switch(wait: float, direction: int = 1, *, sliding: bool = False) -> Switching:
    return Switching(wait, 0, direction, sliding, jitter=0.0)


def _followed(*switchings: Switching) -> History:
    made: Any = _Made(iter(switchings))
    return History(made, 0.5)


def _run(history: History) -> FrontRun:
    return history.verdict(None, 1e-12, 0.0)


@pytest.mark.parametrize("on", [1, -1])
def test_a_site_lost_and_gained_again_is_passed_when_it_was_first_gained(on: int) -> None:
    waits, directions = (1.0, 2.0, 4.0, 8.0, 16.0), (on, on, -on, on, on)
    history = _followed(*map(_switch, waits, directions))
    history.extend(3)
    assert _run(history).crossing_times.tolist() == [1.0, 3.0, 31.0]
    assert history.events == 5


def test_the_same_front_the_other_way_round_has_the_opposite_velocity_and_the_same_error() -> None:
    """Rounding of a crossing blurs a retreating front as it blurs an advancing one."""
    runs, floors = [], []
    for direction in (1, -1):
        blurred = [Switching(2.0, 0, direction, False, jitter=1e-7) for _ in range(4 * BLOCK + 1)]
        history = _followed(*blurred)
        history.extend(len(blurred))
        runs.append(_run(history))
        floors.append(history._floor())
    assert runs[0].v == 0.5 == -(runs[1].v or 0.0)
    assert runs[0].error == runs[1].error
    assert floors[0] == floors[1] > 1e-8  # 1e-7 of a time in periods of 2


def test_the_time_to_the_first_site_is_no_period() -> None:
    history = _followed(*map(_switch, (70.0, 1.0, 2.0, 3.0)))
    history.extend(4)
    assert history._periods().tolist() == [1.0, 2.0, 3.0]
    assert history._mean_velocity() == 0.5
    assert _run(history).crossing_times[0] == 70.0
    assert history._floor() == verdict._FLOOR  # of crossings that no rounding blurs
    once = _followed(*map(_switch, (70.0, 4.0)))
    once.extend(2)
    assert _run(once).v == 0.25
    fast = _followed(*map(_switch, (70.0, 0.125, 0.25, 0.25)))
    fast.extend(4)
    assert fast._mean_velocity() == 4.8


def test_the_ends_of_a_window_disturb_a_faster_front_more() -> None:
    truncations = []
    for wait in (50.0, 1.0, 0.2):
        history = _followed(*(_switch(wait) for _ in range(4 * BLOCK + 1)))
        history.extend(4 * BLOCK + 1)
        truncations.append(_run(history).truncation)
    at_rest = _followed(_switch(1.0)).verdict(Rest(margin=0.1, remainder=0.0), 1e-12, 0.0)
    assert 0.0 <= at_rest.truncation <= truncations[0] <= truncations[1] < truncations[2]


def test_a_front_that_shuttles_between_two_sites_gets_no_velocity() -> None:
    history = _followed(*(_switch(1.0, (-1) ** k) for k in range(5000)))
    history.extend(BLOCK)
    run = _run(history)
    assert (run.status, run.v, run.error) == (FrontStatus.UNSTEADY, None, None)
    assert history._mean_velocity() == 0.0


def test_each_block_of_a_run_may_have_as_many_switchings_as_the_first() -> None:
    """However many there have been before: a run that has had many goes on."""
    history = _followed(*(_switch(1.0, (-1) ** k) for k in range(5000)))
    counts = []
    for _ in range(3):
        history.extend(BLOCK)
        counts.append(history.events)
    assert counts == [counts[0], 2 * counts[0], 3 * counts[0]]
    assert counts[0] > 0


def test_a_run_whose_front_has_come_to_rest_asks_for_no_further_switching(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    steps = iter((_switch(1.0), Rest(margin=0.1, remainder=0.0)))

    def advance(_: object, __: float) -> Switching | Rest:
        return next(steps)  # a third one does not exist

    monkeypatch.setattr(PiecewiseMotion, "advance", advance)
    run = simulate_front(0.3, 0.03125, "step")
    assert (run.status, run.margin, run.events) == (FrontStatus.PINNED, 0.1, 1)


@pytest.mark.parametrize(
    ("slid", "status"),
    [
        (2 * BLOCK - 5, FrontStatus.STEADY),
        (-BLOCK - 1, FrontStatus.STEADY),
        (-BLOCK, FrontStatus.SLIDING),
        (-5, FrontStatus.SLIDING),
    ],
)
def test_a_front_slides_if_it_slid_in_the_block_that_is_judged(
    slid: int, status: FrontStatus
) -> None:
    waits = [_switch(1.0) for _ in range(4 * BLOCK + 1)]
    waits[slid] = _switch(1.0, sliding=True)
    history = _followed(*waits)
    history.extend(len(waits))
    assert _run(history).status is status


@pytest.mark.parametrize("on", [1, -1])
def test_a_front_that_slides_is_as_sure_whichever_way_it_goes(on: int) -> None:
    waits = [_switch(1.0, on) for _ in range(4 * BLOCK + 1)]
    steady, sliding = _followed(*waits), _followed(*waits[:-1], _switch(1.0, on, sliding=True))
    steady.extend(len(waits))
    sliding.extend(len(waits))
    sure, less = _run(steady), _run(sliding)
    assert (sure.v, less.v) == (on, on)
    assert less.error - sure.error == pytest.approx(verdict._SLIDING_ERROR)


@pytest.mark.parametrize(
    ("slot", "zone", "becomes"),
    [
        (32, (40, 39), None),  # a switching in the middle says nothing
        (45, (46, 45), ("moved", 13)),
        (18, (19, 18), ("moved", -14)),
        (41, (20, 50), None),
        (45, (20, 50), ("moved", 3)),
        (7, (8, 7), ("widened", 128)),  # beside either end
        (57, (58, 57), ("widened", 128)),
        (45, (10, 41), ("moved", -7)),
        (45, (10, 42), ("widened", 128)),  # broader than half of the window
    ],
)
def test_a_window_is_moved_after_the_front_and_widened_where_it_is_too_narrow(
    slot: int, zone: tuple[int, int], becomes: tuple[str, int] | None
) -> None:
    """A window of 64 sites whose first one has the number 100."""
    done: list[tuple[str, int]] = []
    chain = SimpleNamespace(
        sites=64, origin=100, zone=lambda: zone, shift=lambda sites: done.append(("moved", sites))
    )
    made: Any = SimpleNamespace(
        chain=chain, zone=0, _widen=lambda sites: done.append(("widened", sites))
    )
    History._keep_in_window(made, 100 + slot)
    assert done == ([] if becomes is None or abs(becomes[1]) < 8 else [becomes])
    width = zone[1] - zone[0] + 1
    for before in (0, 60):  # the broadest that it has been where it was looked at
        made.zone = before
        History._keep_in_window(made, 100 + slot)
        assert made.zone == (before if slot == 32 else max(before, width))


def test_a_front_that_settles_is_judged_by_its_last_block() -> None:
    """Periods that tend to 1 geometrically: the mean of the last block is within its error."""
    periods = 1.0 + 0.05 * 0.9 ** (np.arange(18 * BLOCK) / BLOCK)
    history = _followed(_switch(1.0), *map(_switch, periods))
    history.extend(periods.size + 1)
    run = _run(history)
    assert run.status is FrontStatus.SETTLING
    assert abs(run.v - 1.0) <= run.error
    assert run.v == pytest.approx(1.0 / periods[-BLOCK:].mean(), rel=1e-14)


def test_the_mean_of_a_repeating_front_is_over_whole_repeats() -> None:
    once = np.array([1.0, 1.5, 0.7, 1.1, 0.9, 1.3, 0.4])
    periods = np.resize(once, 10 * BLOCK)
    history = _followed(_switch(1.0), *map(_switch, periods))
    history.extend(periods.size + 1)
    run = _run(history)
    assert (run.status, run.repeat) == (FrontStatus.UNSTEADY, once.size)
    assert run.v == pytest.approx(1.0 / once.mean(), rel=1e-14)
    assert run.error == pytest.approx(1e-9 * run.v)  # to which they are asked to repeat


def test_a_front_is_as_broad_as_the_sites_from_the_first_off_to_the_last_on() -> None:
    on = np.arange(64) < 30
    on[[25, 33]] = False, True
    state = travelling_state(0.5, 0.3, 64)
    history = History(PiecewiseMotion(0.5, 0.4, ChainState(state.phi, 0, on)), 0.5)
    history._keep_wide()
    assert history.zone == 33 - 25 + 1


def test_the_window_of_a_front_is_lengthened_to_what_its_velocity_asks_for() -> None:
    """A wave at the threshold that it fits: 48 sites are too few for it, not for three periods."""
    threshold = switching_amplitude(0.5, 0.3)
    history = History(PiecewiseMotion(0.5, threshold, travelling_state(0.5, 0.3, 48)), 0.5)
    assert history.extend(3) is None
    assert history._mean_velocity() == pytest.approx(0.3, rel=1e-9)
    assert history.chain.sites >= window_length(0.5, 0.3, 1e-14 * threshold) > 48


def test_of_sites_that_cross_within_one_interval_the_first_is_switched() -> None:
    """Of a later interval none is looked at, though its site crosses sooner in its interval."""
    chain: Any = PiecewiseMotion(0.1, 0.4, ChainState(np.where(np.arange(64) < 32, 1.0 + 0j, 0j)))
    step = chain._sampling_step()[0]
    parts = {(2, 10): 0.9, (2, 30): 0.2, (2, 31): 0.3, (3, 40): 0.1}

    def suspects(gap: np.ndarray, *_: object) -> np.ndarray:
        found = np.zeros(gap.shape, dtype=bool)
        found[tuple(zip(*parts, strict=True))] = True
        return found

    sites = {site: part for (_, site), part in parts.items()}
    chain._suspects = suspects
    chain._first_crossing = lambda _, __, site, ___, ____: sites[site] * step
    chain._switch = lambda site, time, waited: (site, time, waited)
    assert chain.advance(10.0) == (30, pytest.approx(2.2 * step), 0.0)


def _judged(
    spreads: npt.NDArray[np.float64], *, total: int = 100, events: int = 100, steady: bool = False
) -> bool:
    made: Any = SimpleNamespace(
        _spreads=lambda: spreads, _total=lambda: total, events=events,
        _is_steady=lambda *_: steady,
    )  # fmt: skip
    return History.decided(made, 1e-12, 200)


def test_a_run_goes_on_while_more_periods_could_change_what_is_said() -> None:
    constant, falling = np.full(25, 0.1), 0.1 * 0.8 ** np.arange(25)
    assert _judged(falling, steady=True)
    assert not _judged(falling)
    assert not _judged(constant[:19])  # too early to call it unsteady
    assert _judged(constant[:20])
    assert _judged(constant)
    for total, enough in ((199, False), (200, True)):
        assert _judged(falling, total=total) is enough
    # Sites that cross and cross back for ever make events, and no periods.
    assert _judged(falling, events=100 * 200)


def test_a_front_at_rest_within_rounding_of_the_threshold_is_neither_pinned_nor_moving() -> None:
    state = ChainState(np.where(np.arange(64) < 32, 1.0 + 0j, 0j))
    history = History(PiecewiseMotion(0.1, 0.4, state), 0.1)
    for margin, status, v in (
        (1e-12, FrontStatus.PINNED, 0.0),
        (1e-14, FrontStatus.MARGINAL, None),
        (-1e-3, FrontStatus.MARGINAL, None),
    ):
        run = history.verdict(Rest(margin=margin, remainder=0.0), 1e-12, 0.0)
        assert (run.status, run.v, run.error, run.period_spread) == (status, v, v, None)
        assert run.margin == margin


@pytest.mark.parametrize("unit", [0.5, 20.0])
@pytest.mark.parametrize("decay", [0.9, 1.0])
def test_a_front_in_another_unit_of_time_has_its_velocity_and_error_in_that(
    unit: float, decay: float
) -> None:
    """Settling or not: spreads, and what is said, have no unit."""
    rng = np.random.default_rng(4)
    ripple = decay ** (np.arange(18 * BLOCK) / BLOCK) * rng.random(18 * BLOCK)
    runs = []
    for each in (1.0, unit):
        history = _followed(_switch(each), *map(_switch, each * (1.0 + 0.05 * ripple)))
        history.extend(ripple.size + 1)
        runs.append(_run(history))
    one, other = runs
    assert one.status is other.status is not FrontStatus.STEADY
    assert other.v == pytest.approx(one.v / unit, rel=1e-12)
    assert other.error == pytest.approx(one.error / unit, rel=1e-9)
    assert other.period_spread == pytest.approx(one.period_spread, rel=1e-9)


def test_the_blur_of_a_crossing_is_forgotten_as_sharper_ones_follow() -> None:
    blurred = Switching(1.0, 0, 1, False, jitter=1e-6)
    history = _followed(*map(_switch, np.ones(30)), blurred, *map(_switch, np.ones(400)))
    history.extend(31)
    least = history._floor()
    assert least > 1e-7
    history.extend(20)
    assert 1e-3 * least < history._floor() < least
    history.extend(380)
    assert history._floor() < 1e-12
