"""The fastest linear wave about steady sliding."""

import numpy as np
import pytest

from theory.chains.friction import FrictionChain


@pytest.mark.parametrize("c", [0.01, 0.3, 4.0])
def test_the_largest_group_velocity_is_that_of_the_fastest_linear_wave(c: float) -> None:
    # omega^2 = 1 + 4 c sin^2(q/2), differentiated by hand: omega' = c sin q / omega.
    q = np.linspace(0.0, np.pi, 200_001)
    speed = c * np.sin(q) / np.sqrt(1.0 + 4.0 * c * np.sin(q / 2.0) ** 2)
    assert FrictionChain(c=c).largest_group_velocity == pytest.approx(speed.max(), rel=1e-9)
