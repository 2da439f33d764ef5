"""The law v = c + kappa (c/6)^(1/3) of the averaged chain, its slope, and kappa near eta = 0."""

import math

import pytest

from tests.strong_coupling import kappa_by_shooting
from theory.averaged.front import StrongCouplingFront, strong_coupling_front, wave_fast_eta


def test_the_velocity_is_c_and_the_width_of_the_front_times_kappa():
    # (48/6)^(1/3) = 2 and (162/6)^(1/3) = 3, by hand.
    assert StrongCouplingFront(0.03, 0.5, 0.0).velocity(48.0) == pytest.approx(49.0, rel=1e-15)
    assert StrongCouplingFront(0.06, -0.25, 0.0).velocity(162.0) == pytest.approx(161.25)


@pytest.mark.parametrize("c", [0.7, 20.0, 3000.0])
def test_the_exponent_is_the_slope_of_the_velocity_on_logarithmic_axes(c):
    law, step = StrongCouplingFront(0.03125, 0.49, 0.0), 1e-4
    rise = math.log(law.velocity(c * math.exp(step)) / law.velocity(c * math.exp(-step)))
    assert law.exponent(c) == pytest.approx(rise / (2 * step), rel=1e-8)


def test_for_little_damping_at_rest_kappa_is_that_of_the_fastest_decay():
    # a = 1, b = eta: s = r^2 = u / eta makes f(r) = r/2 (1 - u/(4 eta) + u^2/(8 eta)); for small
    # eta the bracket is of order 1/eta. Lengths scale with eta^(1/3), kappa with eta^(-2/3):
    # kappa eta^(2/3) tends to a constant, with a relative change of order eta.
    small, smaller = (strong_coupling_front(eta).kappa * eta ** (2 / 3) for eta in (1e-3, 5e-4))
    assert small == pytest.approx(smaller, rel=0.05)
    assert smaller > 0.1


@pytest.mark.parametrize("eta", [0.002, 0.03125, 0.085])
def test_kappa_is_that_of_shooting(eta):
    found = strong_coupling_front(eta)
    low, high = kappa_by_shooting(eta, found.kappa - 1e-8, found.kappa + 2e-8)
    # A hundred steps of scipy, each to 1e-13.
    assert low - 1e-11 <= found.kappa + found.error
    assert found.kappa - found.error <= high + 1e-11
    assert found.error < 1e-10


def test_where_fronts_are_as_fast_as_waves():
    eta, error = wave_fast_eta()
    assert error < 1e-11
    beside = 1e-6
    before, after = (kappa_by_shooting(eta + x, -1e-4, 1e-4) for x in (-beside, beside))
    assert before[0] > 0.0 > after[1]
    # κ is smooth: its zero is where the line through both neighbours is zero.
    assert sum(before) + sum(after) == pytest.approx(0.0, abs=1e-9)
