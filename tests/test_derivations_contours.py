"""Transforms and integrals along contours: both forms are integrated and compared."""

import mpmath as mp
import pytest
import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.expansion import Limit
from derivations.algebra.operations import OperationError
from derivations.algebra.sums import SumOver
from derivations.algebra.transform import (
    CloseContour,
    IntegratePeriod,
    LayOnRealAxis,
    SumOverPeriods,
    hyperbolic,
    residue_at_root,
)

p, q, v = sp.symbols("p q v", positive=True)
zeta = sp.Symbol("zeta", real=True)
k, name, upper, lower = sp.symbols("k name upper lower")
profile, L = sp.Function("g", real=True), sp.Function("L")
HALF_PLANES = sp.Tuple(
    *(
        equation(
            half, sp.ConditionSet(k, sp.And(sp.Eq(L(k), 0), relation(sp.im(k), 0)), sp.S.Complexes)
        )
        for half, relation in ((upper, sp.Gt), (lower, sp.Lt))
    )
)


def contour(integrand):
    return equation(profile(zeta), sp.Integral(integrand * sp.exp(sp.I * k * zeta), k))


def test_closing_the_contour_gives_the_residues_on_either_side():
    slope = sp.Symbol("L_k")
    integral = contour(sp.I / (2 * sp.pi * k * L(k)))
    found = CloseContour(zeta, k, slope)(integral, equation(L(k), p - sp.I * v * k), HALF_PLANES)
    (behind, _), (ahead, _) = found.rhs.args
    at_root = sp.exp(sp.I * k * zeta) / (k * slope)
    assert sp.simplify(ahead + SumOver(at_root, k, upper)) == 0
    assert sp.simplify(behind - 1 / p - SumOver(at_root, k, lower)) == 0


def test_a_residue_is_that_of_a_simple_zero_and_no_other():
    slope = sp.Symbol("L_k")
    # Near the root L is slope times the distance.
    assert residue_at_root((2 + L(k)) / L(k) * k, L(k), slope) == 2 * k / slope
    for integrand in (1 / L(k) ** 2, k * L(k)):
        with pytest.raises(OperationError, match="no simple zero"):
            residue_at_root(integrand, L(k), slope)


def test_cotangents_of_unequal_weight_do_not_combine():
    with pytest.raises(OperationError, match="do not combine"):
        hyperbolic(sp.cot(k + q) + 2 * sp.cot(k - q), k)


def numerical(side, **values):
    """An expression with integrals over k, by mpmath."""
    plain = side.subs({sp.Symbol(letter, positive=True): value for letter, value in values.items()})
    for integral in plain.atoms(sp.Integral):
        own, low, high = integral.limits[0]
        inner = sp.lambdify(own, integral.function, "mpmath")
        if high is sp.oo:  # period by period while the integrand oscillates
            bounds = [*(2 * mp.pi * place for place in range(60)), mp.inf]
        else:
            bounds = [mp.mpf(sp.N(low)), mp.mpf(sp.N(high))]
        plain = plain.subs(integral, sp.sympify(mp.quad(inner, bounds)))
    return complex(plain.evalf())


def test_a_contour_on_the_real_axis_keeps_its_value():
    # With L = p + i q k the profile is a decaying exponential: at zero half of the jump, here 1/p.
    found = LayOnRealAxis(zeta, k)(
        contour(sp.I / (2 * sp.pi * k * L(k))), equation(L(k), p + sp.I * q * k)
    )
    assert found.lhs == profile(0)
    assert numerical(found.rhs, p=0.7, q=1.3) == pytest.approx(1 / 0.7)


def test_the_sum_over_periods_keeps_the_integral():
    whole = equation(name, sp.Integral(1 / ((2 + sp.cos(k)) ** 2 + q**2 * k**2), (k, 0, sp.oo)))
    found = SumOverPeriods(k)(whole)
    (one,) = found.rhs.atoms(sp.Integral)
    assert one.limits[0][1:] == (-sp.pi, sp.pi)
    # The quadrature up to infinity is good to 7e-9 here.
    assert numerical(found.rhs, q=0.8) == pytest.approx(numerical(whole.rhs, q=0.8), rel=1e-7)


@pytest.mark.parametrize("part", [2 + k, 2 + sp.sin(k)])
def test_what_is_not_periodic_and_even_has_no_sum_over_periods(part):
    with pytest.raises(OperationError, match="no even periodic part"):
        SumOverPeriods(k)(equation(name, sp.Integral(1 / (part**2 + p**2 * k**2), (k, 0, sp.oo))))


@pytest.mark.parametrize("sign", [1, -1])
def test_the_static_limit_is_approached(sign):
    velocity = sp.Symbol("v", real=True)
    wide = (2 + sp.cos(k)) / velocity
    moving = equation(
        name,
        sp.Integral(
            sp.sinh(wide) / (sp.cosh(wide) - sp.cos(k)) / (2 + sp.cos(k)), (k, -sp.pi, sp.pi)
        ),
    )
    found = Limit(velocity, 0, sign)(moving)
    near = numerical(moving.rhs.subs(velocity, sign * sp.Rational(1, 40)))
    assert numerical(found.rhs) == pytest.approx(near, rel=1e-12)
    assert found.rhs.has(sp.Integral)


@pytest.mark.parametrize("off", [2, 1 + p, -1 - p, 1 + sp.I * p, 1 - sp.I * p, sp.I * p])
def test_the_integral_over_a_period_is_that_of_samples(off):
    """``1/(w - cos k)`` with w off the interval from -1 to 1."""
    whole = equation(name, sp.Integral(1 / (off - sp.cos(k)), (k, -sp.pi, sp.pi)))
    found = IntegratePeriod()(whole).rhs
    assert not found.has(sp.Integral)
    assert numerical(found, p=0.9) == pytest.approx(numerical(whole.rhs, p=0.9))


def test_the_integral_of_a_product_of_two_poles_is_that_of_samples():
    cosine = sp.cos(k)
    whole = sp.Integral((1 + cosine) / ((2 - cosine) * (3 + cosine)), (k, -sp.pi, sp.pi))
    assert numerical(IntegratePeriod()(equation(name, whole)).rhs) == pytest.approx(
        numerical(whole), rel=1e-12
    )


@pytest.mark.parametrize("integrand", [sp.exp(sp.cos(k)), sp.sin(k) / (2 - sp.cos(k)), sp.cos(k)])
def test_what_is_not_a_rational_function_of_the_cosine_with_poles_is_refused(integrand):
    with pytest.raises(OperationError, match="rational"):
        IntegratePeriod()(equation(name, sp.Integral(integrand, (k, -sp.pi, sp.pi))))
