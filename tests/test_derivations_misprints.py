"""What is printed wrongly differs from what is derived by the stated term and by nothing else.

The check of a misprint must fail on print, so it cannot notice a second slip in the transcription:
these tests do. The terms were read off the paper by hand.
"""

import random

import pytest
import sympy as sp

from derivations import catalogue
from derivations import judgement as printed
from derivations.algebra.evidence import value
from derivations.averaging.symbols import phi
from derivations.friction.symbols import d, k, m, mu_d, mu_st, omega_n, xi, y_0
from derivations.friction.symbols import v_tilde_rel as speed
from derivations.front.symbols import F, phi_s, phi_us
from derivations.linearisation.symbols import SITES, components
from derivations.symbols import a, alpha_0, c, epsilon, i, n, omega, t

CLOSE = 1e-12
"""Rounding of numbers of order one."""


def derived(number):
    return catalogue.load(catalogue.owner(number)).numbered(number).result


def at_random(expression, seed):
    """The value where each symbol or function is a number, complex if it may be."""
    rng = random.Random(seed)
    found = expression.atoms(sp.Symbol) | expression.atoms(sp.Derivative)
    functions = expression.atoms(sp.core.function.AppliedUndef)
    point = {}
    for atom in sorted(found | functions, key=str):
        point[atom] = rng.uniform(0.5, 1.5)
        if not atom.is_real and not atom.is_positive:
            point[atom] += 1j * rng.uniform(-1.0, 1.0)
    return value(expression, point)


def same(one, other):
    assert one.free_symbols | other.free_symbols
    for seed in range(3):
        difference = at_random(one - other, seed)
        assert abs(difference) < CLOSE, (one, other)


def test_2_has_one_mu_st_in_the_place_of_mu_d():
    same(printed.printed(2).expression.rhs - derived(2).rhs, mu_st - mu_d)


def test_3_has_the_strict_sign_in_the_bound_and_nothing_else():
    theirs, ours = printed.printed(3).expression.args, derived(3).args
    assert [one for one, other in zip(theirs, ours, strict=True) if one != other] == [theirs[2]]
    assert (type(theirs[2]), type(ours[2])) == (sp.StrictLessThan, sp.LessThan)
    assert theirs[2].args == ours[2].args


def test_36_and_its_form_for_displacements_differ_by_omega_in_the_amplitude():
    """By hand: |phi| = omega |y|, so alpha_0 of the print is (1 + eps c) times that of (9)."""
    as_printed, for_y = (reading.equation for reading in printed.printed(36).readings)
    scaled = as_printed.subs(alpha_0, alpha_0 * (1 + epsilon * c))
    for one, other in zip(scaled.args, for_y.args, strict=True):
        same(one.rhs, other.rhs)


def test_4_has_a_d_in_the_place_of_k_and_nothing_else():
    for ours, theirs in zip(derived(4).args, printed.printed(4).expression.args, strict=True):
        assert ours.lhs == theirs.lhs
        if ours.lhs == xi:
            same(theirs.rhs, d / (2 * sp.sqrt(d * m)))
            same(ours.rhs, d / (2 * sp.sqrt(k * m)))
        else:
            same(ours.rhs, theirs.rhs)


def test_6_read_literally_has_the_unscaled_speed_and_nothing_else():
    literal, meant = (reading.equation for reading in printed.printed(6).readings)
    (mu,) = {q.func for q in meant.atoms(sp.core.function.AppliedUndef)}
    for one, other in zip(literal.args, meant.args, strict=True):
        assert one.xreplace({mu(speed): mu(omega_n * y_0 * speed)}) == other
        assert (one == other) == (not one.has(mu))


def test_32_has_no_zero_on_the_right_and_every_term_is_right():
    same(printed.printed(32).expression, derived(32).lhs)


def test_33_has_the_other_sign_of_one_term():
    own = phi(n, t)
    bar = sp.conjugate(own) * sp.exp(-2 * i * omega * t)
    velocity = (own + bar) / 2
    square = sp.conjugate(own) ** 2 * sp.exp(-2 * i * omega * t)
    wrong = -2 * epsilon * velocity * a * square / (4 * omega**2)
    same(printed.printed(33).expression.lhs - derived(33).lhs, wrong)
    before, after, whole = printed.printed(33).slip
    same(before, -square)
    same(after, square)
    same(whole.lhs, derived(33).lhs)


def test_42_has_a_one_too_many_in_each_entry_below_the_zero_block():
    given, found = printed.printed(42).expression.rhs, derived(42).rhs
    x = components(SITES)
    assert given.shape == found.shape == (2 * SITES, 2 * SITES)
    for row in range(2 * SITES):
        for column in range(2 * SITES):
            extra = -epsilon * x[row] if (row, column) == (row, row - SITES) else 0
            assert sp.expand(given[row, column] - found[row, column] - extra) == 0


@pytest.mark.parametrize("number", [44, 45])
@pytest.mark.parametrize("own", [0.3 + 0.1j, 1.4 - 0.2j])
def test_both_readings_of_44_and_45_pull_to_the_same_cycle_on_either_side(number, own):
    # |phi_us| = 0.9 and Re phi_us = 0.85 lie between the two values of phi_n by either reading.
    cycle, threshold, small = 2.0 - 0.5j, 0.85 + 0.3j, 0.2
    pull = -small / 2 * (own if abs(own) < 0.9 else own - cycle)
    left, right = 0.4 + 0.7j, -0.2 + 0.5j
    springs = 1j * small * 0.7 / 2 * (2 * own - left - right)
    point = {phi(n, t).diff(t): 0.6 - 0.3j, phi(n, t): own, phi(n - 1, t): left,
             phi(n + 1, t): right, phi_s: cycle, phi_us: threshold, epsilon: small, c: 0.7,
             F: pull}  # fmt: skip
    for reading in printed.printed(number).readings:
        one, other = reading.equation.args
        assert abs(value(other, point) - pull) < CLOSE
        if number == 44:
            assert abs(value(one, point) - (0.6 - 0.3j - springs)) < CLOSE
