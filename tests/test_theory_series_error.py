"""The error that the series (49) states bounds the true one and is not far above it."""

import numpy as np
import pytest

from theory.piecewise.profile import front_profile, front_profile_by_roots


@pytest.mark.parametrize("zeta", [-0.5, 0.5])
@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1.2, 2.0)])
def test_the_error_of_the_series_bounds_and_falls_with_the_roots(
    zeta: float, v: float, c: float
) -> None:
    exact = front_profile([zeta], v, c).phi[0]
    stated = []
    for count in (200, 2000):
        found = front_profile_by_roots([zeta], v, c, count)
        stated.append(found.error)
        assert np.abs(found.phi[0] - exact) <= found.error
    # The last two terms fall like 1/k^2 and stand for count of them: together like 1/count.
    assert stated[1] < 0.2 * stated[0]
    assert stated[0] < 0.05
