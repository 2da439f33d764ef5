"""Values in double precision are those of SymPy's arithmetic of many digits, or are not given."""

import random

import pytest
import sympy as sp

from derivations.algebra.doubles import LOST, in_doubles
from derivations.algebra.evidence import value

x, y = sp.symbols("x y")
f = sp.Function("f")
UNARY = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.Abs, sp.conjugate)


def _made_up(rng: random.Random, depth: int) -> sp.Expr:
    if depth == 0:
        return rng.choice([x, y, f(x), sp.Rational(rng.randint(1, 9), 7), sp.I, sp.pi])
    one, other = _made_up(rng, depth - 1), _made_up(rng, depth - 1)
    kind = rng.randrange(5)
    if kind == 0:
        return one + other
    if kind == 1:
        return one * other
    if kind == 2:
        return one ** rng.choice([-2, -1, 2, 3, sp.Rational(1, 2), sp.Rational(-1, 3)])
    return rng.choice(UNARY)(one) if kind == 3 else one - other


def test_a_value_that_is_given_is_right():
    rng, given = random.Random(5), 0
    for _ in range(150):
        expression = _made_up(rng, 3)
        point = {q: complex(rng.uniform(-2, 2), rng.choice([0.0, rng.uniform(-1, 1)]))
                 for q in (x, y, f(x))}  # fmt: skip
        found = in_doubles(expression, point)
        if found is not None:
            given += 1
            numbers = {q: sp.Float(z.real, 40) + sp.I * sp.Float(z.imag, 40)
                       for q, z in point.items()}  # fmt: skip
            true = complex(expression.xreplace(numbers).evalf(30))
            assert abs(found - true) <= LOST * abs(true), expression
    assert given > 100


@pytest.mark.parametrize(
    ("expression", "at"),
    [
        (1 - sp.cos(x), 1e-7),  # half of the digits cancel
        (sp.sqrt(sp.exp(2 * sp.pi * sp.I * x) - 4), 1.0),  # on the cut, to within rounding
        (sp.Heaviside(x**2 - x * 0.3), 0.3),
        (sp.exp(x), 1e4),
        (1 / x, 0.0),
        (sp.log(x), 2.0),
        (x + y, 1.0),
    ],
)
def test_what_loses_digits_or_is_not_known_is_left_to_sympy(expression, at):
    assert in_doubles(expression, {x: at}) is None


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_a_root_of_a_negative_number_has_its_principal_value(zero):
    assert in_doubles(sp.sqrt(x), {x: complex(-4.0, zero)}) == pytest.approx(2j)
    assert value(sp.sqrt(x), {x: complex(-4.0, zero)}) == pytest.approx(2j)


def test_a_value_left_to_sympy_keeps_its_digits():
    assert value(1 - sp.cos(x), {x: 1e-7}) == pytest.approx(5e-15, rel=1e-9)
