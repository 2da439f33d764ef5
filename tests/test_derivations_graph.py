"""The graph of equations: everything derived has an operation and rests on what is given."""

import xml.etree.ElementTree as ET

import pytest
import sympy as sp

from derivations import catalogue
from derivations.algebra.steps import Derived, Given, Kind
from derivations.cell.envelope import derive_envelope
from derivations.cell.steps import derive as derive_cell
from derivations.chain import ChainModel
from derivations.graph import graph_of, key_of, svg

GIVEN = {Kind.MODEL, Kind.DEFINITION, Kind.ANSATZ}
TYPED = {1, 3, 7, 8, 9, 12, 13, 17, 22, 31, 39, 44, 46, 47, 52}
"""Numbers that are typed; (27) is an ansatz written out in terms of a derived frequency."""
RESULTS = {
    "Hopf velocity", "end of pure slip",
    "detuning", "relative error",
    "phase step by displacement", "two sites", "too many sites",
    "centre in quarter turns", "decay of the tail",
    "averaging in the amplitude of multiple scales, cell",
    "averaging in the amplitude of multiple scales, chain",
    "next harmonics of the cell", "frequency of its cycles", "fundamental of the cycles",
    "chain in quarter turns to second order",
    "Jacobian with free ends", "resonant part of the added term",
    "phase of the cell", "radial decay on the cycle", "kept at rest", "dropped on the cycle",
    "no double root", "one root from odd to even",
    "no root from even to odd",
    "both half-planes", "pinning coupling", "retreat coupling", "largest η of pinning",
    "strong coupling", "inner problem", "speed of the averaged front",
}  # fmt: skip
"""What the derivations lead to beside the numbered equations: nothing follows from these."""


def rests_on(graph, key):
    """Return the given steps (models, definitions, ansätze) that a step hangs on."""
    found, seen, waiting = set(), set(), [key]
    while waiting:
        here = waiting.pop()
        if here not in seen:
            seen.add(here)
            found |= set() if graph.sources[here] else {here}
            waiting += graph.sources[here]
    return found


def _ends(graph):
    """Return the steps without a number from which nothing follows."""
    used = {source for sources in graph.sources.values() for source in sources}
    return {key for key, step in graph.steps.items() if key not in used and step.number is None}


@pytest.fixture(scope="module")
def derivations():
    return catalogue.everything()


@pytest.fixture(scope="module")
def graph(derivations):
    return graph_of(derivations)


def test_every_number_of_the_paper_is_in_the_graph(graph):
    found = sorted(step.number for step in graph.steps.values() if step.number is not None)
    assert found == list(range(1, 55))


def test_each_derivation_leads_to_all_of_its_results_and_to_nothing_else(graph):
    assert _ends(graph) == RESULTS


def test_no_equation_without_a_path_to_something_given(graph):
    for key in graph.steps:
        ends = rests_on(graph, key)
        assert ends, key
        assert all(graph.steps[end].kind in GIVEN for end in ends), key


def test_every_derived_numbered_equation_rests_on_a_model_or_an_ansatz(graph):
    for key, step in graph.steps.items():
        # (14) follows from the definition of the two times alone.
        if step.number not in (None, 14) and step.kind is Kind.DERIVED:
            kinds = {graph.steps[end].kind for end in rests_on(graph, key)}
            assert kinds & {Kind.MODEL, Kind.ANSATZ}, key


def test_what_is_derived_has_an_operation_and_what_is_given_has_none(graph):
    for key, step in graph.steps.items():
        if isinstance(step, Derived):
            assert step.operations, key
            assert step.sources, key
        else:
            assert isinstance(step, Given), key
            assert step.kind in GIVEN, key
        assert step.operation, key


def test_only_models_definitions_and_ansatze_are_typed(graph):
    typed = {step.number for step in graph.steps.values() if isinstance(step, Given)} - {None}
    assert typed == TYPED


def test_54_rests_on_both_models_of_the_front_and_of_the_chain(graph):
    assert {"8", "44", "46", "47"} <= rests_on(graph, "54")


def test_the_order_is_that_of_an_appendix(derivations):
    for derivation in derivations:
        seen: set[str] = set()
        own = {key_of(step) for step in derivation.steps}
        for step in derivation.steps:
            assert {key_of(source) for source in step.sources} & own <= seen, step.name
            seen.add(key_of(step))


def test_a_cell_of_one_s_own_has_a_graph_too():
    model = derive_envelope("1 - a*y**2 + b*y**4").model
    graph = graph_of([derive_cell(model, 2)])
    assert all(rests_on(graph, key) for key in graph.steps)
    of_second = RESULTS & {step.name for step in catalogue.load("second-order").steps}
    own = {"frequency shift of the cell", "growth rates", "kinetic relation of the cell"}
    assert _ends(graph) == own | of_second
    assert _ends(graph_of([derive_cell(model)])) == own


def test_two_different_steps_of_one_name_are_refused(derivations):
    step = derivations[1].named("centre in two times")
    other = Given(name=step.name, given_as=Kind.ANSATZ, equation=sp.true, words="something else",
                  check=step.check)  # fmt: skip
    broken = type(derivations[1])("x", "x", (other,))
    with pytest.raises(ValueError, match="two different steps"):
        graph_of([derivations[1], broken])


def test_the_picture_is_well_formed_and_shows_every_number(derivations):
    root = ET.fromstring(svg(derivations))
    labels = [node.text for node in root.iter() if node.tag.endswith("}text")]
    assert all(labels.count(f"({number})") == 1 for number in range(1, 55))
    arrows = [node for node in root.iter() if node.tag.endswith("}path")]
    assert len(arrows) > 54
    width = float(root.get("width"))
    for node in root.iter():
        if node.tag.endswith("}rect") and node.get("x"):
            assert 0 <= float(node.get("x")) < width


def test_a_derivation_is_called_by_its_name_and_has_a_title_besides(derivations):
    made = [*derivations, derive_cell(derive_envelope("y**2 - 1").model)]
    assert [each.key for each in made] == [*catalogue.NUMBERED, "second-order", "cell"]
    assert all(each.title[0].isupper() and " " in each.title for each in made)


@pytest.mark.parametrize(("damping", "left_out"), [({0: -1, 2: 1}, True), ({0: 1, 4: 1}, False)])
def test_sites_are_too_many_where_the_averaged_damping_is_not_linear(damping, left_out):
    made = catalogue.load("averaging", model=ChainModel(damping=damping))
    assert ("too many sites" not in {step.name for step in made.steps}) == left_out


@pytest.mark.parametrize("reach", [1, 2, 3])
def test_the_branches_of_the_phase_step_are_written_down_for_springs_over_two_sites(reach):
    made = catalogue.load(
        "averaging", model=ChainModel(damping={0: 1, 2: -3}, weights=(1,) * reach)
    )
    assert ("branch of the phase step" in {step.name for step in made.steps}) == (reach <= 2)


@pytest.mark.parametrize("key", catalogue.WITH_ORDER)
def test_to_second_order_the_steps_of_the_second_order_follow_those_of_the_first(key):
    extended = catalogue.load(key, order=2)
    assert extended.key == key
    first, second = catalogue.load(key).steps, extended.steps
    assert second[: len(first)] == first
    _, *names = [step.name for step in catalogue.load("second-order").steps]  # without (8)
    assert [step.name for step in second[len(first) :]] == names
