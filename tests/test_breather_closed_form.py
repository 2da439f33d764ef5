"""The closed form satisfies (36) with its own phase step, and its error is never below rounding."""

import math

import numpy as np
import pytest

from theory.averaged.breather import Reading, solve_breather
from theory.chains.vdp import VdpChain

CHAINS = [VdpChain(a=2.5, b=0.5, c=0.1), VdpChain(a=4.0, b=0.5, c=0.05)]


@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize(("reading", "site"), [(Reading.NEIGHBOUR, 1), (Reading.TAIL, 40)])
def test_the_phase_step_is_the_one_of_36(chain: VdpChain, reading: Reading, site: int) -> None:
    found = solve_breather(chain, reading)
    assert found.alpha_0 is not None
    assert found.decay is not None
    square = (found.alpha_0 * found.decay**site) ** 2
    bracket = 0.5 - chain.a * square / 8 + chain.b * square**2 / 16
    sine = 2 / (chain.c * (found.decay - 1 / found.decay)) * bracket  # (36) at eps = 0
    assert math.sin(found.phase_step) == pytest.approx(sine, abs=1e-12)
    assert math.cos(found.phase_step) == pytest.approx(0, abs=1e-15)
    np.testing.assert_allclose(found.amplitudes(3)[1:] / found.amplitudes(3)[:-1], found.decay)
    assert found.error >= 8 * np.finfo(float).eps
