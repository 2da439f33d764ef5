"""Multiple scales and averaging agree at both orders, with each other and with true orbits."""

import math
import random

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from derivations.algebra.equations import equation
from derivations.algebra.modulation import (
    Force,
    by_averaging,
    by_multiple_scales,
    fundamental_shift,
)
from derivations.algebra.modulation import in_scales_amplitude as carried
from derivations.averaging.periodic_orbit import harmonic, orbit
from derivations.averaging.readings import paper_numbers
from derivations.chain import PAPER
from derivations.symbols import epsilon, n, t, y
from tests.second_order_breather import breather
from verification.references.equations import damping

SYMBOLS = sp.symbols("p q c", positive=True)


def same_polynomial(left, right):
    """Whether two coefficients of rings with matching generators are the same polynomial."""
    return dict(left.items()) == dict(right.items())


def van_der_pol(coupled):
    return Force.read(PAPER.equation() if coupled else PAPER.cell().equation(), epsilon)


def Oscillator(damping, stiffness=None, coupling=0, weights=(1,)):
    own = y(n, t)
    force = own.diff(t) * sum(q * own**k for k, q in damping.items())
    force += sum(q * own**k for k, q in (stiffness or {}).items())
    for j, weight in enumerate(weights, start=1):
        force += coupling * weight * (2 * own - y(n - j, t) - y(n + j, t))
    return Force.read(equation(own.diff(t, 2) + own + epsilon * force), epsilon)


def in_scales_amplitude(averaged):
    return carried(averaged, fundamental_shift(averaged))


P, Q, C = SYMBOLS
CELLS = {
    "cell": van_der_pol(False),
    "chain": van_der_pol(True),
    "detuned": Oscillator({0: sp.Integer(-1), 2: P}, {3: Q}),
    "detuned chain": Oscillator({0: P, 2: sp.Integer(-1)}, {2: Q, 3: sp.Integer(1)}, C),
    "asymmetric": Oscillator({0: sp.Integer(1)}, {1: P, 2: Q, 4: sp.Integer(1)}),
    "second neighbours": Oscillator({0: P, 2: sp.Integer(-1)}, {3: Q}, C, (1, sp.Rational(1, 3))),
    "degree eight": Oscillator({0: P, 4: -Q, 8: sp.Integer(1)}),
}


@pytest.mark.parametrize("name", CELLS)
def test_both_routes_give_the_same_polynomials(name):
    scales = by_multiple_scales(CELLS[name], 2)
    first, second = in_scales_amplitude(by_averaging(CELLS[name], 2))
    assert same_polynomial(first, scales.first)
    assert same_polynomial(second, scales.second)


def test_without_the_change_of_amplitude_the_second_orders_differ():
    scales = by_multiple_scales(CELLS["cell"], 2)
    averaged = by_averaging(CELLS["cell"], 2)
    size = sp.Rational(7, 10)
    plain = averaged.second_expr().subs(averaged.ring.amplitudes[0], 2 * sp.I * size) / (2 * sp.I)
    there = scales.second_expr().subs(scales.ring.amplitudes[0], size)
    assert sp.expand(plain - there) != 0


def test_known_frequencies():
    cell = by_multiple_scales(Oscillator({0: sp.Integer(-1), 2: sp.Integer(1)}), 2)
    assert cell.second_expr().subs(sp.Symbol("A"), 1) == -sp.I / 16  # van der Pol, eps^2/16
    # Undamped Duffing, y'' + y + eps y^3: 1 + 3 r^2/8 eps - 15 r^4/256 eps^2, with 2A = r = 1.
    duffing = by_multiple_scales(Oscillator({}, {3: sp.Integer(1)}), 2)
    half = {sp.Symbol("A"): sp.Rational(1, 2)}
    assert duffing.first_expr().subs(half) * 2 == sp.I * sp.Rational(3, 8)
    assert duffing.second_expr().subs(half) * 2 == -sp.I * sp.Rational(15, 256)


def test_a_linear_chain_has_its_exact_dispersion():
    # omega^2 = 1 + 4 eps c sin^2(q/2), expanded to second order; the coupling alone.
    chain = by_multiple_scales(Oscillator({}, {}, C), 2)
    q = sp.Symbol("q", real=True)
    wave = {s: sp.exp(sp.I * q * (k - 2)) for k, s in enumerate(chain.ring.amplitudes)}
    springs = 2 * C * (1 - sp.cos(q))
    first = (chain.first_expr().subs(wave) / sp.I - springs / 2).rewrite(sp.cos)
    second = (chain.second_expr().subs(wave) / sp.I + springs**2 / 8).rewrite(sp.cos)
    assert sp.expand(sp.expand_trig(sp.expand(first))) == 0
    assert sp.expand(sp.expand_trig(sp.expand(second))) == 0


def test_the_prediction_for_the_cell_converges_to_direct_integration_with_the_predicted_slopes():
    a, b = 2.5, 0.5
    s = (a + math.sqrt(a * a - 8 * b)) / b
    omega_2 = -(a**3 * s - 4 * a**2 - 10 * a * b * s + 56 * b) / (384 * b)
    first, second = [], []
    for e in (0.02, 0.01):
        period = _integrated_period(a, b, e, math.sqrt(s))
        frequency = 2 * math.pi / period
        first.append(abs(frequency - 1))
        second.append(abs(frequency - 1 - e * e * omega_2))
    # The frequency is even in eps, so the orders are 2 and 4; eps_eff is up to 0.2 here.
    assert math.log2(first[0] / first[1]) == pytest.approx(2, abs=0.1)
    assert math.log2(second[0] / second[1]) == pytest.approx(4, abs=0.3)


def _integrated_period(a, b, e, size):
    """Return time to y = 0 going up, once the motion has settled on the stable cycle."""

    def field(_, x):
        return [x[1], -x[0] - e * x[1] * damping(x[0], a, b)]

    def upward(_, x):
        return x[0]

    upward.direction = 1
    # The cycle attracts at about 13 eps here: 400 time units settle it to rounding.
    run = solve_ivp(field, (0, 400), [0.0, size], "DOP853", events=upward, rtol=1e-12, atol=1e-13)
    return float(np.mean(np.diff(run.t_events[0][-6:])))


@pytest.mark.parametrize("coupling", [0.05, 0.12])
def test_both_routes_predict_the_same_breather(coupling):
    given = {"a": 2.5, "b": 0.5, "c": coupling}
    one = breather(by_multiple_scales(van_der_pol(True), 2), given)
    other = breather(by_averaging(van_der_pol(True), 2), given)
    # Newton's method and differences leave 1e-9.
    assert one.omega_2 == pytest.approx(other.omega_2, rel=1e-7)
    np.testing.assert_allclose(one.amplitude_corrections, other.amplitude_corrections, atol=1e-7)
    np.testing.assert_allclose(one.phase_corrections[:5], other.phase_corrections[:5], atol=1e-6)


def test_the_breather_of_the_full_chain_approaches_the_prediction_with_the_predicted_slopes():
    given = {"a": 2.5, "b": 0.5, "c": 0.1}
    sites, samples = 6, 41
    found = breather(by_multiple_scales(van_der_pol(True), 2), given)
    steps, phase = np.arange(sites), 2 * np.pi * np.arange(samples) / samples
    errors = {"frequency 1": [], "frequency 2": [], "amplitude 0": [], "amplitude 1": []}
    for e in (0.01, 0.005):
        start = found.amplitudes[:sites, None] * np.sin(phase - np.pi / 2 * steps[:, None])
        y, w = orbit(start, 1 + e * 0.1, paper_numbers(2.5, 0.5, 0.1, e))
        size = 2 * abs(harmonic(y, 1))
        errors["frequency 1"].append(abs(w - 1 - e * 0.1))
        errors["frequency 2"].append(abs(w - 1 - e * 0.1 - e * e * found.omega_2))
        errors["amplitude 0"].append(abs(size[1] - found.amplitudes[1]))
        corrected = found.amplitudes[1] + e * found.amplitude_corrections[1]
        errors["amplitude 1"].append(abs(size[1] - corrected))
    slopes = {name: math.log2(large / small) for name, (large, small) in errors.items()}
    # eps_eff is about 0.1 here, which is what the slopes are off by at most.
    assert slopes["frequency 1"] == pytest.approx(2, abs=0.2)
    assert slopes["frequency 2"] == pytest.approx(3, abs=0.3)
    assert slopes["amplitude 0"] == pytest.approx(1, abs=0.2)
    assert slopes["amplitude 1"] == pytest.approx(2, abs=0.3)


def test_random_cells_agree_too():
    rng = random.Random(11)
    for _ in range(6):
        damping = {2 * k: sp.Rational(rng.randrange(-5, 6), 3) for k in range(rng.randrange(1, 4))}
        stiffness = {k: sp.Rational(rng.randrange(-5, 6), 4) for k in range(1, rng.randrange(2, 6))}
        cell = Oscillator(damping, stiffness, rng.choice([sp.Integer(0), sp.Rational(1, 3)]))
        first, second = in_scales_amplitude(by_averaging(cell, 2))
        scales = by_multiple_scales(cell, 2)
        assert same_polynomial(first, scales.first), f"seed 11: {cell}"
        assert same_polynomial(second, scales.second), f"seed 11: {cell}"
