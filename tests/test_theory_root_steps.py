"""Where the search for a labelled root starts, and the step it takes."""

import numpy as np
import pytest

from theory.piecewise.dispersion import dispersion
from theory.piecewise.roots import _argument, _labelled_step, _plain_step, _seeds, labelled_roots

LABELS = np.array([-9, -3, 4, 12])


def scene(v: float, c: float) -> tuple[np.ndarray, np.ndarray]:
    return np.full(LABELS.shape, v), np.full(LABELS.shape, c)


@pytest.mark.parametrize("upper", [True, False])
@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1.4, 0.8)])
def test_either_step_converges_with_the_second_power(v: float, c: float, upper: bool) -> None:
    exact = labelled_roots(v, c, LABELS, upper).k
    assert np.abs(dispersion(exact, *scene(v, c))).max() < 1e-12
    for step_of in (_labelled_step, _plain_step):
        left = []
        for size in (1e-2, 5e-3):
            k = exact + size * np.exp(0.7j)
            left.append(np.abs(k - step_of(k, LABELS, *scene(v, c), upper) - exact))
        assert np.all(left[0] < 1e-2 * 0.5)
        np.testing.assert_allclose(np.log2(left[0] / left[1]), 2.0, atol=0.1)


@pytest.mark.parametrize("upper", [True, False])
def test_the_argument_is_on_the_sheet_of_the_label(upper: bool) -> None:
    v, c = 0.6, 1.1
    k = labelled_roots(v, c, LABELS, upper).k
    w = _argument(k, LABELS, *scene(v, c), upper)
    np.testing.assert_allclose(4 * np.sinh(w / 2) ** 2, (2 * v * k + 1j) / c, rtol=1e-12)
    np.testing.assert_allclose(k, (1j if upper else -1j) * w + 2 * np.pi * LABELS, rtol=1e-12)


@pytest.mark.parametrize("upper", [True, False])
def test_the_first_start_is_the_root_of_a_standing_front(upper: bool) -> None:
    start = next(_seeds(LABELS, *scene(0.4, 0.7), upper))
    # L at v = 0 is 1/2 - 2ic sin^2(k/2)
    assert np.abs(0.5 - 2j * 0.7 * np.sin(start / 2) ** 2).max() < 1e-13
    assert np.all((start.imag > 0) == upper)
