"""Σ without its oscillations, and the search for velocities that skips where these do not reach."""

import math

import numpy as np
import pytest

from theory.cells.vdp import threshold_ratio
from theory.piecewise import smooth_part
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.limits import strong_coupling_sum
from theory.piecewise.smooth_part import smooth_part_of_sum
from theory.piecewise.sums.integral import sums


@pytest.mark.parametrize("c", [2.5, 8.0, 60.0, 1e3, 1e5, 1e8])
def test_the_sum_is_no_farther_from_its_smooth_part_than_is_said(c: float) -> None:
    centres = np.geomspace(0.03, 0.9 * c / 3.0, 30)
    # over a period of the oscillations, which is that of 2c/v, densely
    inverse = 1.0 / centres[:, None] + np.linspace(0.0, math.pi / c, 300)
    v = 1.0 / inverse.ravel()
    smooth, height = smooth_part_of_sum(v, np.full(v.size, c))
    gone = np.abs(sums(v, c, 1e-14, compiled=True).value - smooth)
    assert np.all(gone <= height)
    slow = smooth_part_of_sum(np.array([1e-2]), np.array([c]))[0]
    oscillations = gone > 1e-4 * np.abs(smooth - slow)
    if c < 1e3:  # beyond, they are below the error of the integral
        assert oscillations.any()
        assert (gone / height)[oscillations].max() > 0.1  # nor is it said to be much more


@pytest.mark.parametrize("x", [0.01, 0.3, 1.0, 5.0])
def test_at_strong_coupling_the_smooth_part_is_the_limit(x: float) -> None:
    c = 1e8
    (smooth,), _ = smooth_part_of_sum(np.array([x * math.sqrt(c)]), np.array([c]))
    # the next terms are of order 1/√c
    assert abs(smooth - strong_coupling_sum(x)) < 3.0 / math.sqrt(c)


def test_more_nodes_change_the_smooth_part_by_less_than_its_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rng = np.random.default_rng(1)
    c = 10.0 ** rng.uniform(0.4, 8.0, 400)
    v = np.exp(rng.uniform(math.log(0.03), np.log(c / 3.0)))
    smooth, _ = smooth_part_of_sum(v, c)
    still, _ = smooth_part_of_sum(np.full(400, 1e-3), c)
    monkeypatch.setattr(smooth_part, "_NODES", 500)
    exact, _ = smooth_part_of_sum(v, c)
    assert np.all(np.abs(smooth - exact) <= smooth_part._INACCURACY * np.abs(exact - still) + 1e-15)


@pytest.mark.parametrize(
    ("c", "eta", "count"), [(9597.97784724901, 0.07965328094918311, 3), (80.0, 0.076, 1)]
)
def test_no_velocity_is_lost_where_the_oscillations_are_skipped(
    c: float, eta: float, count: int
) -> None:
    """Against every change of sign of |Σ| - 2r on a grid of eight points an oscillation."""
    target = 2.0 * threshold_ratio(eta)
    found = all_velocities(np.array([c]), np.array([target])).v
    v = 1.0 / np.arange(0.3 / math.sqrt(c), 15.0, math.pi / (8.0 * c))
    above = np.abs(sums(v, c, 1e-14, compiled=True).value) > target
    (change,) = np.nonzero(above[1:] != above[:-1])
    assert found.size == change.size == count
    np.testing.assert_array_less(v[change + 1][::-1], found)
    np.testing.assert_array_less(found, v[change][::-1])
