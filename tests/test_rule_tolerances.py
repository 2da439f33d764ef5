"""A tolerance of a rule that is loosened a thousandfold is noticed by the cases of that rule.

Every number that a rule compares with, written there or as a constant of its module, is loosened
in turn, and the rule run on its made-up evidence (`tests.test_claim_rules`): some verdict changes.
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


@pytest.mark.parametrize(("case", "place", "upper"), list(_tolerances()))
def test_a_loosened_tolerance_is_noticed(case: tuple[Any, ...], place: int, upper: bool) -> None:
    rule = case[0]
    before = _verdicts(rule, case)
    # Of "x > bound" it depends on what follows which way is the looser one.
    factors = (THOUSAND,) if upper else (THOUSAND, 1.0 / THOUSAND)
    assert any(_verdicts(_loosened(rule, place, factor), case) != before for factor in factors)
