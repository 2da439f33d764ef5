"""Any polynomial oscillator: its average, all its cycles, and what it refuses."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from derivations.algebra.errors import DerivationInputError
from derivations.averaging.symbols import square
from derivations.cell.envelope import derive_envelope
from derivations.cell.polynomial_text import read_polynomial
from derivations.cell.steps import derive as derive_cell
from verification.references.equations import damping


@pytest.mark.parametrize("power", range(7))
def test_powers_average_to_catalan_numbers(power):
    # <y' y^{2j}> keeps Catalan_j / 4^j of the amplitude.
    mean = derive_envelope({2 * power: 1}).damping_mean
    catalan = sp.Rational(math.comb(2 * power, power), power + 1)
    assert mean == catalan / 4**power * square**power


@pytest.mark.parametrize("power", range(1, 8))
def test_only_odd_stiffness_shifts_the_frequency(power):
    shift = derive_envelope("1", {power: 1}).shift_mean
    if power % 2 == 0:
        assert shift == 0
    else:
        # Mean of sin * sin^m over a period, per amplitude: C(m+1, (m+1)/2) / 2^{m+1}.
        half = (power + 1) // 2
        expected = sp.Rational(math.comb(2 * half, half), 2 ** (2 * half)) * square ** (half - 1)
        assert sp.expand(shift - expected) == 0


def test_the_cell_of_the_paper():
    cell = derive_envelope("1 - a*y**2 + b*y**4")
    a, b = sp.symbols("a b", positive=True)
    eta = sp.Symbol("eta", positive=True)
    root = sp.sqrt(1 - 8 * eta)
    expected = sp.sqrt((1 - root) / (1 + root))
    assert [q.multiplicity for q in cell.cycles] == [1, 1]
    assert sp.simplify(cell.ratio.subs(b, eta * a**2) - expected) == 0
    assert [q.stability for q in cell.with_values({"a": 4, "b": 0.5}).cycles] == [
        "unstable",
        "stable",
    ]
    assert cell.kinetic_relation().rest_rate == 1


@given(st.lists(st.fractions(min_value=-4, max_value=4, max_denominator=6), min_size=1, max_size=6))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_all_cycles_are_found_and_their_stability_is_the_sign_of_the_rate(coefficients):
    powers = {2 * k: sp.Rational(q.numerator, q.denominator) for k, q in enumerate(coefficients)}
    if not any(powers.values()):
        return
    cell = derive_envelope(powers, coupling=0.1)
    polynomial = sp.Poly(cell.damping_mean, square)
    # Sturm's count of distinct positive roots shares nothing with the isolation of roots.
    bound = 1 + max(abs(q) for q in polynomial.all_coeffs()) / abs(polynomial.LC())
    count = polynomial.count_roots(0, bound) - (polynomial.eval(0) == 0)
    cycles = cell.cycles
    assert len(cycles) == count
    sizes = [float(q.amplitude) for q in cycles]
    rate = cell.compiled().amplitude_rate
    for place, cycle in enumerate(cycles):
        gaps = [abs(sizes[place] - other) for other in sizes if other != sizes[place]]
        step = min([1e-3, *(gap / 3 for gap in gaps), sizes[place] / 3])
        low, high = (math.copysign(1, rate(sizes[place] + d)) for d in (-step, step))
        kind = {(1, -1): "stable", (-1, 1): "unstable"}.get((low, high), "half-stable")
        assert cycle.stability == kind


def test_a_fold_of_cycles_is_one_half_stable_cycle():
    (cycle,) = derive_envelope("1 - y**2 + y**4/8").cycles
    assert (cycle.stability, cycle.multiplicity) == ("half-stable", 2)


def test_compiled_functions_follow_direct_integration():
    cell = derive_envelope("1 - a*y**2 + b*y**4", "k*y**3", "c").compiled(
        a=2.5, b=0.5, k=0.4, c=0.2
    )
    e, end = 2e-3, 1000.0

    def field(_, x):
        drag = x[1] * damping(x[0], 2.5, 0.5)
        return [x[1], -x[0] - e * (drag + 0.4 * x[0] ** 3)]

    def slow(_, x):
        own = x[0] + 1j * x[1]
        moved = cell.rate(own, 0, 0) - 0.2j * own  # one isolated site
        return [e * moved.real, e * moved.imag]

    true = solve_ivp(field, (0, end), [0.0, 1.2], "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    own = complex(*solve_ivp(slow, (0, end), [1.2, 0.0], rtol=1e-10, atol=1e-12).y[:, -1])
    predicted = own * np.exp(1j * end)
    # First-order averaging over a time 2/eps: an error of a few eps.
    assert abs(predicted - complex(true[1], true[0])) < 10 * e


def test_compiled_functions_take_arrays_of_sites():
    cell = derive_envelope("1 - 4*y**2 + 0.5*y**4").compiled(c=0.3)
    phi = np.linspace(0.1, 3, 7) * np.exp(0.3j)
    found = cell.rate(phi, np.roll(phi, 1), np.roll(phi, -1))
    assert found.shape == (7,)
    assert found[2] == pytest.approx(cell.rate(phi[2], phi[1], phi[3]))
    assert cell.amplitude_rate(np.array(cell.amplitudes)) == pytest.approx([0, 0], abs=1e-12)


@pytest.mark.parametrize(
    ("damping", "why"),
    [
        ("y**2 - 1", "1 limit cycle,"),
        ("1 + y**2", "0 limit cycles,"),
        ("1 - y**2", "1 limit cycle,"),
        ("-1 + 4*y**2 - y**4/2", "not stable"),
        ("1 + a*y**2 + b*y**4", "signs"),
    ],
)
def test_other_cells_have_no_kinetic_relation_and_are_told_why(damping, why):
    with pytest.raises(DerivationInputError, match=why):
        derive_envelope(damping).kinetic_relation()


@pytest.mark.parametrize("damping", ["1 - 4*v**2", {0: 1, 2: "-4*v"}, {0: sp.Symbol("v")}])
def test_a_damping_that_depends_on_the_velocity_is_refused_and_v_is_no_constant(damping):
    with pytest.raises(DerivationInputError, match="and not in the velocity v; use another letter"):
        derive_envelope(damping)


def test_the_neglected_detuning_is_named():
    cell = derive_envelope("1 - 4*y**2 + 0.5*y**4", "y**3")
    assert "frequency" in cell.kinetic_relation().neglected
    assert derive_envelope("1 - 4*y**2 + 0.5*y**4").kinetic_relation().neglected == ""


def test_high_degree_with_letters_asks_for_numbers():
    cell = derive_envelope("1 - a*y**2 + b*y**4 - d*y**6")
    with pytest.raises(DerivationInputError, match="give numbers"):
        _ = cell.cycles
    assert len(cell.with_values({"a": 3, "b": 2, "d": 0.3}).cycles) == 1
    with pytest.raises(DerivationInputError, match="missing"):
        cell.compiled(a=3, b=2, c=1)
    with pytest.raises(DerivationInputError, match="leave it out"):
        cell.with_values({"zz": 1})


@pytest.mark.parametrize("stiffness", [None, "y**3/5 + k2*y**2"])
def test_each_step_of_a_new_cell_is_checked(stiffness):
    derive_cell(derive_envelope("1 - 3*y**2 + y**4/2 + y**6/50", stiffness).model, 2).verify()


@pytest.mark.parametrize(
    ("given_", "quantity"),
    [
        ({"damping": "y"}, "damping"),
        ({"damping": "0"}, "damping"),
        ({"damping": {1.5: 2}}, "damping"),
        ({"damping": {2: float("nan")}}, "damping"),
        ({"damping": {2: float("inf")}}, "damping"),
        ({"damping": sp.sin(sp.Symbol("y"))}, "damping"),
        ({"damping": sp.I * sp.Symbol("y") ** 2}, "damping"),
        ({"damping": 3.0}, "damping"),
        ({"damping": "1", "stiffness": "1 + y"}, "stiffness"),
        ({"damping": "1", "coupling": "y"}, "coupling"),
        ({"damping": "1", "coupling": "1e999"}, "coupling"),
    ],
)
def test_what_cannot_be_averaged_is_refused_with_reasons(given_, quantity):
    with pytest.raises(DerivationInputError) as caught:
        derive_envelope(**given_)
    error = caught.value
    assert error.quantity == quantity
    assert error.allowed
    assert error.remedy


ATTACKS = [
    "__import__('os').system('true')", "().__class__", "eval(1)", "exec('1')", "open('x')",
    "lambda: 1", "[1 for y in (1,)]", "y.real", "y if y else 1", "f'{1}'", "'1'", "1;2", "y=1",
    "1,2", "y**y", "y**-1", "y**0.5", "y**True", "y**0b1", "9**9**9", "y**999999999",
    "((y**40)**40)",
    "(1+a+b+d+f+g+h)**40", "(y+1)**40*(y+1)**40", "9" * 31, "(" * 300 + "y" + ")" * 300,
    "-" * 200 + "y", "y" * 401, "1/0", "1/y", "1//2", "2 y", "y y", "1 2", "", "   ", "+", "1+",
    "(1", "1)", "I*y**2", "E", "pi", "y__class__", "_y", "y_", "y\x00", "ү**2", "y\n;1", "0x10",
    "1_000", "1e500", "1e999999999", "1e", "1j", "@", "y%2", "y<1", "{}", "sin(y)", "y!",
]  # fmt: skip


@pytest.mark.parametrize("text", ATTACKS)
def test_an_attack_string_is_refused(text):
    with pytest.raises(DerivationInputError, match="not allowed"):
        derive_envelope(text)


@given(st.text(max_size=40))
@settings(max_examples=200, deadline=None, derandomize=True)
def test_any_text_is_read_as_a_polynomial_or_refused(text):
    try:
        terms = read_polynomial(text)
    except DerivationInputError:
        return
    assert all(value for value in terms.values())


@given(st.dictionaries(st.integers(0, 6), st.fractions(-9, 9, max_denominator=20), max_size=5))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_reading_undoes_writing(powers):
    y = sp.Symbol("y")
    expression = sum((sp.Rational(q.numerator, q.denominator) * y**k for k, q in powers.items()),
                     sp.Integer(0))  # fmt: skip
    terms = read_polynomial(str(expression))
    assert {dict(m).get("y", 0): q for m, q in terms.items()} == {
        k: q for k, q in powers.items() if q
    }


def test_a_damping_in_powers_of_y_to_the_fourth_has_cycles_with_letters_too():
    cell = derive_envelope("1 - a*y**4 + b*y**8")
    numbers = {"a": 4, "b": 0.5}
    inner, outer = (float(q.amplitude) for q in cell.with_values(numbers).cycles)
    letters = {q: numbers[q.name] for q in cell.symbols if q.name in numbers}
    assert [float(q.amplitude.subs(letters)) for q in cell.cycles] == pytest.approx([inner, outer])
    assert float(cell.ratio.subs(letters)) == pytest.approx(inner / outer)
    cell.derivation.verify()
