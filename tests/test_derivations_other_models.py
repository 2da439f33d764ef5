"""Another model gives another chain's equations, and every check still passes.

That is the proof that nothing is typed: a typed equation does not follow when the model changes.
For each change the equations that must stay as they are are listed by number; every other derived
equation must change.
"""

from functools import lru_cache

import pytest
import sympy as sp

from derivations import catalogue
from derivations.algebra.equations import same
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.steps import Kind
from derivations.chain import ChainModel
from derivations.symbols import a, b, c

g, w = sp.symbols("g w", positive=True)

CHANGES = {
    "coefficient": ChainModel(damping={0: 1, 2: -3 * a, 4: b}),
    "power": ChainModel(damping={0: 1, 2: -a, 6: b}),
    "sign": ChainModel(damping={0: 1, 2: a, 4: -b}),
    "stiffness": ChainModel(damping={0: 1, 2: -a, 4: b}, stiffness={3: g}),
    "next-nearest": ChainModel(damping={0: 1, 2: -a, 4: b}, weights=(1, w)),
    "coupling": ChainModel(damping={0: 1, 2: -a, 4: b}, coupling=2 * c),
}
h, u = sp.symbols("h u", positive=True)
UNLIKE_THE_PAPER = {
    "multiple-scales": ChainModel(damping={0: 1, 4: -a}, coupling=-c),  # gains energy far out
    "averaging": ChainModel(damping={0: -h, 2: a}, weights=(1, w, u)),  # a cubic in cos k₂
    "second-order": ChainModel(damping={0: -h, 2: a}, stiffness={2: g, 3: 1}),  # strong stiffness
    "linearisation": ChainModel(damping={1: g}, stiffness={1: h}, weights=(1, 0, -w)),
}
NEITHER_GAIN_NOR_LOSS = ChainModel(damping={1: g}, weights=(w,))
DETUNED = ChainModel(damping={0: 1, 4: -3, 8: 6}, stiffness={3: 12})
"""At amplitudes of order one far beyond what its springs can make good."""
LINEAR = ChainModel(damping={0: h}, stiffness={1: g})
KINEMATICS = {14, 18, 20, 38}
"""They hold for any chain: the chain rule, free oscillation, and the amplitude of (9)."""
FIRST_ORDER_FREQUENCY = {30}
"""It hangs on the springs and on the stiffness, not on the damping."""
UNCHANGED = {
    "coefficient": KINEMATICS | FIRST_ORDER_FREQUENCY,
    "power": KINEMATICS | FIRST_ORDER_FREQUENCY,
    "sign": KINEMATICS | FIRST_ORDER_FREQUENCY,
    # (27) takes up what the stiffness does to the frequency, so it leaves the decay alone.
    "stiffness": KINEMATICS | {28, 29},
    "next-nearest": KINEMATICS,
    "coupling": KINEMATICS,
}
DERIVATIONS = ("multiple-scales", "averaging", "second-order")
GIVEN = {8, 9, 12, 13, 17, 22, 27, 31}
"""The chain itself, definitions and ansätze."""
DERIVED = sorted(
    {q for name in ("multiple-scales", "averaging") for q in catalogue.numbers_of(name)} - GIVEN
)


@lru_cache(maxsize=32)
def derivation(change, name):
    return catalogue.load(name, model=CHANGES[change] if change else None)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        (name, change)
        for name in DERIVATIONS
        for change in CHANGES
        if name != "second-order" or change in ("power", "stiffness", "next-nearest")
    ],
)
def test_every_check_passes_for_another_model(name, change):
    made = derivation(change, name)
    assert len(made.verify()) == len(made.steps)


@pytest.mark.parametrize(
    ("name", "model"),
    [
        *UNLIKE_THE_PAPER.items(),
        ("multiple-scales", NEITHER_GAIN_NOR_LOSS),
        ("averaging", DETUNED),
    ],
)
def test_every_check_passes_for_a_model_unlike_the_paper_s(name, model):
    made = catalogue.load(name, model=model)
    assert len(made.verify()) == len(made.steps)


def test_the_second_order_of_a_linear_cell_is_exact():
    made = catalogue.load("second-order", model=LINEAR)
    found = [step.verify() for step in made.steps if step.name.startswith("modulation")]
    assert [each.holds for each in found] == [True] * 4
    assert any("rounding" in each.statement for each in found)


@pytest.mark.parametrize("number", DERIVED)
def test_a_derived_equation_changes_with_the_model(number):
    name = catalogue.owner(number)
    paper = derivation(None, name).numbered(number).result
    for change, unchanged in UNCHANGED.items():
        found = derivation(change, name).numbered(number).result
        assert same(found, paper) == (number in unchanged), change


@pytest.mark.parametrize("number", DERIVED)
def test_the_check_of_the_paper_refuses_another_model_s_equation(number):
    name = catalogue.owner(number)
    step = derivation(None, name).numbered(number)
    for change, unchanged in UNCHANGED.items():
        if number not in unchanged:
            other = derivation(change, name).numbered(number).result
            assert not step.verify(other).holds, change


def test_the_lists_name_all_equations_that_are_derived():
    kinds = {
        number: derivation(None, catalogue.owner(number)).numbered(number).kind
        for number in (*DERIVED, *GIVEN)
    }
    assert [number for number, kind in kinds.items() if kind is Kind.DERIVED] == DERIVED
    assert all(unchanged <= set(DERIVED) for unchanged in UNCHANGED.values())


def test_only_letters_of_the_derivation_itself_are_refused():
    free, taken = sp.Symbol("D", positive=True), sp.Symbol("omega", positive=True)
    model = ChainModel(damping={0: 1, 2: -free})
    assert free in catalogue.load("multiple-scales", model=model).named("chain").result.free_symbols
    with pytest.raises(DerivationInputError, match="no other meaning in 'multiple-scales'"):
        catalogue.load("multiple-scales", model=ChainModel(damping={0: 1, 2: -taken}))
