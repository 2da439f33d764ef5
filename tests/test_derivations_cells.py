"""Each step of a derived cell holds, with letters and with numbers for the coefficients."""

import math

import pytest
import sympy as sp

from derivations import catalogue
from derivations.cell.envelope import derive_envelope
from derivations.cell.polynomial_input import chain_of
from derivations.cell.steps import derive

CELLS = {
    "letters": ("1 - a*y**2 + b*y**4", None, "c"),
    "numbers": ("1 - 4*y**2 + y**4/2", None, "c"),
    "other rest": ("3 - 11*y**2 + y**4", None, 0.7),
    "one cycle": ("y**2 - 1", "k2*y**2 + k3*y**3", "c"),
}


@pytest.mark.parametrize("name", CELLS)
def test_every_step_of_the_cell_holds(name):
    damping, stiffness, coupling = CELLS[name]
    derivation = derive(derive_envelope(damping, stiffness, coupling).model)
    # Seven steps to amplitude and frequency, two for the cycles, three for the front.
    assert len(derivation.verify()) == (9 if name == "one cycle" else 12)


@pytest.mark.parametrize("decades", [-6, -2, 1, 6])
@pytest.mark.parametrize("linear", [4, 1.3])
def test_every_step_of_a_cell_holds_whatever_the_size_of_its_cycles(linear, decades):
    """Of 1 - a(y/s)² + (y/s)⁴/20, s = 10^decades, whose cycles are more or less far apart."""
    damping = f"1 - {linear}e{-2 * decades}*y**2 + 5e{-4 * decades - 2}*y**4"
    assert len(derive(derive_envelope(damping).model).verify()) == 12


@pytest.mark.parametrize("decades", [-6, 6])
def test_a_wrong_coefficient_is_found_whatever_the_size_of_the_cycles(decades):
    """At amplitudes of order one the other terms would be larger by up to 24 decades."""
    damping = f"1 - 4e{-2 * decades}*y**2 + 5e{-4 * decades - 1}*y**4"
    step = derive(derive_envelope(damping).model).named("amplitude of the cell")
    left, right = step.result.args
    for term in sp.Add.make_args(sp.expand(right)):
        assert not step.verify(sp.Eq(left, right + term / 1000)).holds


def scaled(decades, faster=0):
    """Return damping and stiffness with cycles 10^decades and forces 10^faster times as large."""
    damping = {0: 1, 2: -4, 4: 0.5}
    terms = (f"{q * 10.0 ** (faster - k * decades)!r}*y**{k}" for k, q in damping.items())
    return " + ".join(terms), f"{0.3 * 10.0 ** (faster - 2 * decades)!r}*y**3"


@pytest.mark.parametrize(("decades", "faster"), [(-8, 0), (-8, 6), (7, -6)])
def test_the_second_order_of_a_cell_holds_whatever_the_size_of_its_cycles_and_forces(
    decades, faster
):
    derivation = derive(derive_envelope(*scaled(decades, faster)).model, 2)
    assert len(derivation.verify()) == 28  # twelve to the front, sixteen to second order


def wrong(equality):
    """Return the equation with one of its terms at a time in error by a thousandth."""
    left, right = equality.args
    for term in sp.Add.make_args(sp.expand(left - right)):
        yield sp.Eq(left + term / 1000, right, evaluate=False)


@pytest.mark.parametrize(("decades", "faster"), [(-6, 0), (0, -6), (6, 3)])
def test_a_wrong_coefficient_of_second_order_is_found_whatever_its_scales(decades, faster):
    derivation = derive(derive_envelope(*scaled(decades, faster)).model, 2)
    names = ("modulation by multiple scales, cell", "fundamental of the average, chain")
    for step in map(derivation.named, names):
        assert step.verify().holds
        for equality in wrong(step.result):
            assert not step.verify(equality).holds


@pytest.mark.parametrize("faster", [-6, 6])
def test_a_wrong_coefficient_is_found_whatever_the_size_of_the_forces(faster):
    """With eps and the springs of order one, the forces of the cell would not be seen."""
    derivation = derive(derive_envelope(*scaled(0, faster)).model)
    step, rates = (derivation.named(q) for q in ("averaged cell in its chain", "growth rates"))
    for equality in wrong(step.result):
        assert not step.verify(equality).holds
    inner, outer = rates.result
    for equality in wrong(outer):
        assert not rates.verify(sp.Tuple(inner, equality)).holds


@pytest.mark.parametrize("name", ["multiple-scales", "averaging", "linearisation"])
def test_every_step_of_a_chain_holds_where_its_cycles_are_small(name):
    catalogue.load(name, 1, chain_of(*scaled(-6), None, None, {})).verify()


@pytest.mark.parametrize(
    ("name", "step"),
    [
        ("multiple-scales", "chain"),
        ("averaging", "averaged centre"),
        ("piecewise-front", "amplitude of the cell"),
    ],
)
@pytest.mark.parametrize("decades", [-6, 6])
def test_a_wrong_coefficient_of_a_chain_is_found_whatever_the_size_of_the_cycles(
    name, step, decades
):
    judged = catalogue.load(name, 1, chain_of(*scaled(decades), None, None, {})).named(step)
    assert judged.verify().holds
    for equality in wrong(judged.result):
        assert not judged.verify(equality).holds


def test_the_second_order_is_checked_on_a_cycle_of_any_size():
    """Of 6 here, in the unit of the coefficients 10^0."""
    step = derive(derive_envelope("y**2 - 9").model, 2).named("frequency of its cycles")
    assert step.verify().holds


def test_the_title_shows_the_damping():
    assert derive(derive_envelope("2 - 3*y**2 + 5*y**4").model).title.endswith(
        "5*y**4 - 3*y**2 + 2"
    )


@pytest.mark.parametrize(("rest", "linear", "quintic"), [(1, 4, 0.5), (3, 11, 1)])
def test_the_ratio_is_that_of_54_for_the_cell_divided_by_its_rest_damping(rest, linear, quintic):
    cell = derive_envelope(f"{rest} - {linear}*y**2 + {quintic}*y**4")
    root = math.sqrt(1 - 8 * quintic * rest / linear**2)  # eta of the cell divided by rest
    assert float(cell.ratio) == pytest.approx(math.sqrt((1 - root) / (1 + root)), rel=1e-14)
    # The zeros of rest - a s / 4 + b s^2 / 8, s = r^2.
    inner, outer = (float(cycle.amplitude) for cycle in cell.cycles)
    for size in (inner, outer):
        assert rest - linear * size**2 / 4 + quintic * size**4 / 8 == pytest.approx(0, abs=1e-12)
    assert inner < outer


@pytest.mark.parametrize("damping", ["0.01 - y**2 + y**4", "1e6 - 1e4*y**2 + y**4"])
def test_a_front_of_cells_with_any_damping_at_rest_is_checked(damping):
    # The coupling of the check is one in units of the damping at rest; else it is far from order 1.
    step = derive_envelope(damping).derivation.named("kinetic relation at this damping")
    evidence = step.verify()
    assert evidence.holds, evidence.statement
