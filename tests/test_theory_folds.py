"""The search for the velocity at which moving fronts begin."""

import numpy as np
import pytest

from theory.piecewise import folds as thresholds
from theory.piecewise.limits import static_sum
from theory.piecewise.sums.integral import sums


@pytest.mark.parametrize("c", [1.0, 1.2, 1.5, 1.9])
def test_where_no_front_moves_below_pinning_none_is_found(c: float) -> None:
    # |Sum| stays below its limit at rest, which it meets to within rounding for small v.
    height = np.abs(sums(np.geomspace(0.018, 5, 3000), c, 1e-14).value)
    assert abs(height.max() - abs(static_sum(c))) < 2e-13
    assert thresholds._maxima(c).size == 0
    assert thresholds.fold_eta(c).velocity == 0.0


def test_from_beside_a_minimum_the_climb_leads_up_and_not_down(monkeypatch) -> None:
    # e^{-x^2/2}, x = (t - 1)/0.1: beyond x = 1 it is bent upwards, and Newton's step leads away.
    def hill(t: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, ...]:
        x = (t - 1.0) / 0.1
        height = np.exp(-x * x / 2)
        return height, -x / 0.1 * height, np.ones_like(t), np.zeros_like(t)

    monkeypatch.setattr(thresholds, "_modulus_and_slopes", hill)
    found, _ = thresholds._refined_maxima(np.array([0.84, 0.97, 1.2]), np.full(3, 0.5))
    np.testing.assert_allclose(found, 1.0, atol=1e-9)


@pytest.mark.parametrize("c", [0.05, 0.4, 0.7, 0.822, 0.826, 0.83, 0.838, 0.842, 0.848, 0.85])
def test_the_maximum_found_is_the_highest_of_all(c: float) -> None:
    # Near c = 0.826 and 0.838 two maxima are as high to a millionth, and the scan meets neither.
    v = 1.0 / np.linspace(1.0 / 4.0, 1.0 / 0.018, 40_000)
    height = np.abs(sums(v, c, 1e-14).value)
    t = thresholds._maxima(c)
    found = thresholds._modulus_and_slopes(t, np.full(t.shape, c))[0]
    assert found[0] >= height.max() - 1e-13
    assert np.all(np.diff(found) <= 0)


def test_the_fold_in_c_and_the_fold_in_eta_are_inverse_where_maxima_change_places() -> None:
    etas = np.linspace(0.0425, 0.0445, 21)
    folds = thresholds.fold_couplings(etas)
    changes = 0
    for eta, fold, after in zip(etas.tolist(), folds, [*folds[1:], None], strict=True):
        back = thresholds.fold_eta(fold.value)
        assert back.value == pytest.approx(eta, rel=1e-12)
        # no front moves below the fold: the sum stays below 2r there
        below = thresholds.fold_eta(fold.value - 2 * fold.error - 1e-13)
        assert below.value < eta
        changes += after is not None and abs(after.velocity - fold.velocity) > 0.005
    assert changes >= 2


@pytest.mark.parametrize("c", [0.3, 0.5, 0.7, 0.82])
def test_the_climb_begins_at_the_tops_of_the_scan(c: float, monkeypatch) -> None:
    monkeypatch.setattr(thresholds, "_refined_maxima", lambda t, c: (t, c))
    t = thresholds._maxima(c)
    assert t.size > 0
    height = thresholds._modulus_and_slopes(t, np.full(t.shape, c))[0]
    wave = np.pi / (4 * c + 1)  # of |Sum| over 1/v, a half
    for side in (-1, 1):
        beside = np.log(1 / (np.exp(-t) + side * wave))
        assert np.all(thresholds._modulus_and_slopes(beside, np.full(t.shape, c))[0] < height)


def test_a_maximum_that_is_as_high_as_the_limit_to_within_rounding_is_none(monkeypatch) -> None:
    c = 0.5
    height = thresholds._modulus_and_slopes

    def level(excess: float):
        def heights(t: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, ...]:
            _, *rest = height(t, c)
            return np.full(t.shape, abs(static_sum(0.5)) + excess), *rest

        return heights

    monkeypatch.setattr(thresholds, "_refined_maxima", lambda t, c: (t, c))
    for excess, some in ((1e-13, False), (-1e-13, False), (3e-13, True)):
        monkeypatch.setattr(thresholds, "_modulus_and_slopes", level(excess))
        assert (thresholds._maxima(c).size > 0) == some


def test_beyond_the_last_fold_none_is_sought() -> None:
    fold = thresholds.fold_eta(2 * thresholds.LAST_FOLD)
    assert fold.velocity == 0.0


def test_a_fold_that_is_below_pinning_by_less_than_its_error_is_pinning(monkeypatch) -> None:
    eta = 0.03125
    (fold,) = thresholds.fold_couplings([eta])
    pin = thresholds.pinning_coupling(eta)
    height = thresholds._modulus_and_slopes
    # by this much the height may be off; the fold is then uncertain by twice that over d|Sum|/dc
    by_c = height(np.log([fold.velocity]), np.array([fold.value]))[2][0]
    gap = pin - fold.value
    for share, moving in ((0.9, True), (1.1, False)):

        def uncertain(t, c, error=share * gap * by_c / 2):
            *rest, _ = height(t, c)
            return *rest, np.full(t.shape, error)

        monkeypatch.setattr(thresholds, "_modulus_and_slopes", uncertain)
        (found,) = thresholds.fold_couplings([eta])
        assert (found.velocity > 0) == moving
        assert found.value == (pytest.approx(fold.value, rel=1e-13) if moving else pin)


@pytest.mark.parametrize("eta", [1e-3, 0.03, 0.05])
def test_the_error_of_a_fold_at_pinning_is_the_excess_overlooked_over_the_slope(eta: float) -> None:
    """A maximum higher by less than the least excess moves the fold by that over d|Σ|/dc."""
    pin = thresholds.pinning_coupling(eta)
    root = 1.0 / np.sqrt(1.0 - 4.0j * pin)
    size = abs(root - 1.0)
    slope = np.real(np.conj(root - 1.0) * 2.0j * root**3) / size  # closed form, by hand
    overlooked = 2.0 * thresholds._EXCESS / slope
    assert thresholds._pinned_error(pin) == pytest.approx(overlooked + 4e-16 * pin, rel=2e-3)
