"""A tolerance of a rule that is loosened a thousandfold is noticed by the cases of that rule.

Every number that a rule compares with, written there or as a constant of its module, is loosened
in turn, and the rule run on its made-up evidence (`tests.test_claim_rules`): some verdict changes.
The numbers themselves are those that were chosen.
"""

from __future__ import annotations

import ast
import copy
import inspect
import sys
import textwrap
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from tests.test_claim_rules import CASES
from tests.test_rule_edges import rule_nodes

THOUSAND = 1000.0
COUNTS = {"SITES"}
"""Numbers of sites, which are no tolerances."""


def _bounds(tree: ast.AST, module: Any) -> list[tuple[int, bool]]:
    """Return the places of numbers compared with, and whether each is an upper bound."""
    found = []
    nodes = list(ast.walk(tree))
    for node in nodes:
        if not isinstance(node, ast.Compare):
            continue
        for sign, right in zip(node.ops, node.comparators, strict=True):
            if not isinstance(sign, ast.Lt | ast.LtE | ast.Gt | ast.GtE):
                continue
            for part in ast.walk(right):
                if _number(part, module):
                    found.append((nodes.index(part), isinstance(sign, ast.Lt | ast.LtE)))
    return found


def _number(node: ast.AST, module: Any) -> bool:
    if isinstance(node, ast.Constant):
        return isinstance(node.value, float) and node.value not in (0.0, 1.0)
    if isinstance(node, ast.Name) and node.id.isupper() and node.id not in COUNTS:
        return isinstance(getattr(module, node.id, None), float)
    return False


def _loosened(rule: Callable[..., Any], place: int, factor: float) -> Callable[..., Any]:
    """Return the rule with one number multiplied."""
    module = sys.modules[rule.__module__]
    tree = ast.parse(textwrap.dedent(inspect.getsource(rule)))
    target = list(ast.walk(tree))[place]

    class Multiply(ast.NodeTransformer):
        def visit(self, node: ast.AST) -> Any:
            if node is not target:
                return self.generic_visit(node)
            kept = copy.copy(node)
            return ast.BinOp(kept, ast.Mult(), ast.Constant(factor))

    names = dict(vars(module))
    changed = ast.fix_missing_locations(Multiply().visit(tree))
    exec(compile(changed, rule.__module__, "exec"), names)
    made: Callable[..., Any] = names[rule.__name__]
    return made


def _verdicts(rule: Callable[..., Any], case: tuple[Any, ...]) -> list[Any]:
    _, good, _, changes = case
    every = [{}, *(change for change, _ in changes)]
    return [rule(SimpleNamespace(**good | change)).verdict for change in every]


def _tolerances() -> Iterator[Any]:
    for case in CASES:
        rule = case[0]
        tree = ast.parse(textwrap.dedent(inspect.getsource(rule)))
        for place, upper in _bounds(tree, sys.modules[rule.__module__]):
            name = f"{rule.__module__.rpartition('.')[2]}.{rule.__name__}-{place}"
            yield pytest.param(case, place, upper, id=name)


WRITTEN: dict[str, list[float]] = {
    "fig02.rule_subcritical": [1e-3],
    "fig02.rule_friction_law": [1e-9, 1e-12],
    "fig02.rule_stick": [1.0],
    "fig02.rule_switch_model": [0.01, 0.01],
    "fig03.rule_front": [10.0],
    "fig04.rule_edge": [1e-3, 2.0],
    "fig04.rule_bulk": [1e-3, 2.0],
    "fig04.rule_divides": [1e-3],
    "fig05.rule_map": [0.5, 0, 1e-3],
    "fig05.rule_lasting": [0, 1e-3, 0],
    "fig06.rule_linear": [1e-3],
    "fig06.rule_rapid": [1e-3],
    "fig06.rule_no_propagation": [1e-3, 1],
    "fig07.rule_localised": [1e-4],
    "fig07.rule_decay": [1.0],
    "fig08.rule_amplitudes": [1e-8],
    "fig08.rule_assumptions": [1e-9, 0.9],
    "fig08.rule_neglected": [1e-9, 0.9],
    "fig09.rule_multipliers": [1e-6],
    "fig09.rule_escape": [1e-4, 1.0],
    "fig10.rule_in_phase": [0.03],
    "fig11.rule_values": [0.0, 0.05],
    "fig11.rule_order": [1],
    "fig11.rule_stable": [3, 5, 7, 0.0],
    "fig13.rule_scaling": [1e-3, 1e-3],
    "fig13.rule_law": [10],
    "fig14.rule_collapse": [1e-6, 2.0],
    "fig15.rule_map": [1.0],
    "fig16.rule_admissible": [0, 0],
    "fig16.rule_limits": [1e-11, 1e-11],
    "fig17.rule_scaling": [1e-5],
    "fig17.rule_implicit": [1],
    "fig17.rule_admissibility": [5],
    "fig18.rule_alike": [1e-4],
    "fig18.rule_any_set": [0, 0.0],
    "fig18.rule_explicit": [0.01],
    "text_friction.rule_length": [1e-8, 1e-8],
    "text_friction.rule_trapezoid": [1e-10],
    "text_friction.rule_patterns": [1],
    "text_friction.rule_nucleation": [2],
    "text_vdp.rule_cells": [1.0, 1.0, 1.0, 0.05],
    "text_vdp.rule_small": [0.1, 0.8],
    "text_vdp.rule_extraction": [1e-8],
    "text_vdp.rule_uniquely": [1e-8, 1],
    "text_vdp.rule_unknowns": [3],
    "text_vdp.rule_displays": [1e-12, 1e-8],
    "text_simplified.rule_gauge": [0.9, 0.1],
    "text_simplified.rule_equilibria": [1e-6, 0.0],
    "text_simplified.rule_quantitative": [1e-8, 0.1],
    "text_simplified.rule_captions": [1e-8],
}
"""The numbers without a name that each rule compares with, in the order of its text.

They are written here a second time, so that none is loosened unnoticed. Those with a name are held
against the texts of the claims (`tests.test_claim_measurements`)."""


def _written(node: ast.AST) -> Iterator[float]:
    """Yield the numbers of an expression, without those that only say where something stands."""
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield node.value
    within = [node.value] if isinstance(node, ast.Subscript) else ast.iter_child_nodes(node)
    for each in within:
        yield from _written(each)


def test_the_numbers_that_rules_compare_with_are_those_that_were_chosen() -> None:
    found: dict[str, list[float]] = {}
    for rule in dict.fromkeys(case[0] for case in CASES):
        compared = [node for node in rule_nodes(rule) if isinstance(node, ast.Compare)]
        numbers = [x for node in compared for right in node.comparators for x in _written(right)]
        if numbers:
            found[f"{rule.__module__.rpartition('.')[2]}.{rule.__name__}"] = numbers
    assert found == WRITTEN


@pytest.mark.parametrize(("case", "place", "upper"), list(_tolerances()))
def test_a_loosened_tolerance_is_noticed(case: tuple[Any, ...], place: int, upper: bool) -> None:
    rule = case[0]
    before = _verdicts(rule, case)
    # Of "x > bound" it depends on what follows which way is the looser one.
    factors = (THOUSAND,) if upper else (THOUSAND, 1.0 / THOUSAND)
    assert any(_verdicts(_loosened(rule, place, factor), case) != before for factor in factors)
