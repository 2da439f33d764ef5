"""The verdict on a front of (44): from periods that are made up, so that the answer is known."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from verification.piecewise import verdict
from verification.piecewise.verdict import History

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
        ((1.0, 0.9), False),
    ],
)
def test_spreads_shrink_if_the_largest_of_a_group_falls_twice(
    largest: tuple[float, ...], shrinks: bool
) -> None:
    assert verdict._shrinks(_groups(*largest)) is shrinks
    # as they fall that far, a motion is settling if they are small besides
    assert verdict._decays(_groups(*largest)) is False
    assert verdict._decays(0.09 * _groups(*largest[-3:])) is shrinks


def test_the_error_of_an_unsteady_front_is_half_the_range_of_five_means() -> None:
    periods = np.repeat([1.0, 2.0, 4.0, 5.0, 10.0], 8)
    assert verdict._spread_of_means(periods) == pytest.approx((1.0 - 0.1) / 2.0)
    assert verdict._spread_of_means(periods[::-1]) == pytest.approx((1.0 - 0.1) / 2.0)
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
