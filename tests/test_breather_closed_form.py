"""The closed form satisfies (36) with its own phase step, and its error is never below rounding."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from theory.averaged.breather import Reading, closed_form_fold, solve_breather
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError

CHAINS = [VdpChain(a=2.5, b=0.5, c=0.1), VdpChain(a=4.0, b=0.5, c=0.05)]


@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize(("reading", "site"), [(Reading.NEIGHBOUR, 1), (Reading.TAIL, 40)])
def test_the_phase_step_is_the_one_of_36(chain: VdpChain, reading: Reading, site: int) -> None:
    found = solve_breather(chain, reading)
    square = (found.alpha_0 * found.decay**site) ** 2
    bracket = 0.5 - chain.a * square / 8 + chain.b * square**2 / 16
    sine = 2 / (chain.c * (found.decay - 1 / found.decay)) * bracket  # (36) at eps = 0
    assert math.sin(found.phase_step) == pytest.approx(sine, abs=1e-12)
    assert math.cos(found.phase_step) == pytest.approx(0, abs=1e-15)
    np.testing.assert_allclose(found.amplitudes(3)[1:] / found.amplitudes(3)[:-1], found.decay)
    assert found.error >= 8 * np.finfo(float).eps


def _tail_in_many_digits(chain: VdpChain) -> tuple[mp.mpf, mp.mpf] | None:
    """Return α_0 and z of (29) and the linear tail, from two quadratics; None without a root."""
    a, b, c = mp.mpf(chain.a), mp.mpf(chain.b), mp.mpf(chain.c)
    z = (mp.sqrt(1 + 4 * c * c) - 1) / (2 * c)
    inside = a * a - 8 * b - 16 * b * c * z
    return (mp.sqrt((a + mp.sqrt(inside)) / b), z) if inside >= 0 else None


def _chains_near_the_fold(count: int) -> list[VdpChain]:
    """Return chains at the last few couplings before, at and after the fold as it is rounded."""
    random = np.random.default_rng(18)
    chains = []
    for _ in range(count):
        a = 10.0 ** random.uniform(-3, 3)
        gap = 10.0 ** random.uniform(-12, 0)  # 1 - 8 eta: the two cycles meet where it is zero
        b = (
            a * a * (1 - gap) / 8
            if random.random() < 0.7
            else a * a * 10.0 ** random.uniform(-9, -1)
        )
        fold = closed_form_fold(VdpChain(a=a, b=b, c=0.1), Reading.TAIL).c
        if fold is None or not 0 < fold < 1e6:
            continue
        for ulps in (-1000, -3, -2, -1, 0):
            c = fold
            for _ in range(-ulps):
                c = math.nextafter(c, 0.0)
            chains.append(VdpChain(a=a, b=b, c=c))
    return chains


def test_the_error_of_the_tail_reading_bounds_at_its_fold() -> None:
    """Near the fold α_0 goes as the square root of what is left of c; print's rounding does not."""
    exact = 0
    chains = [VdpChain(a=2.5, b=0.5, c=0.6002928972593295), *_chains_near_the_fold(400)]
    for chain in chains:
        found = solve_breather(chain, Reading.TAIL)
        with mp.workdps(60):
            true = _tail_in_many_digits(chain)
            if true is None:
                # Beyond the fold by the rounding of its c: compared with the fold's own breather.
                m = (mp.mpf(chain.a) ** 2 - 8 * mp.mpf(chain.b)) / (16 * mp.mpf(chain.b))
                true = mp.sqrt(mp.mpf(chain.a) / chain.b), mp.sqrt(m / (1 + m))
                assert chain.c == found.fold.c or chain.c > found.fold.c - found.fold.error
            else:
                exact += 1
            assert found.alpha_0 is not None, chain
            assert found.decay is not None, chain
            off = max(abs(found.alpha_0 / true[0] - 1), abs(found.decay / true[1] - 1))
        assert off <= found.error, chain
        assert found.error < 1e-6
    assert exact > 0.7 * len(chains)


def test_at_the_coupling_of_the_fold_as_rounded_a_breather_stands_for_those_beside_it() -> None:
    """Its error is then a square root of rounding: what α_0 moves over the error of c."""
    beyond = 0
    for chain in _chains_near_the_fold(200):
        found = solve_breather(chain, Reading.TAIL)
        with mp.workdps(60):
            if _tail_in_many_digits(chain) is not None:
                continue
            beyond += 1
            before = _tail_in_many_digits(replace(chain, c=chain.c - found.fold.error))
            assert abs(found.alpha_0 / before[0] - 1) <= found.error
    assert beyond > 20


@pytest.mark.parametrize("reading", [Reading.NEIGHBOUR, Reading.TAIL])
@pytest.mark.parametrize("c", [5e-324, 1e-300, 9e-101])
def test_a_coupling_too_small_for_double_precision_is_refused_in_a_sentence(
    reading: Reading, c: float
) -> None:
    with pytest.raises(ParameterError, match="coupling c"):
        solve_breather(VdpChain(a=2.5, b=0.5, c=c), reading)


@pytest.mark.parametrize("reading", [Reading.NEIGHBOUR, Reading.TAIL])
@pytest.mark.parametrize("c", [1e-100, 1e-20])
def test_at_small_coupling_the_decay_is_the_coupling(reading: Reading, c: float) -> None:
    chain = VdpChain(a=2.5, b=0.5, c=c)
    found = solve_breather(chain, reading)
    assert found.decay == pytest.approx(c, rel=1e-9)
    assert found.alpha_0 == pytest.approx(chain.stable_amplitude, rel=1e-12)
