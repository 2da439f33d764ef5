"""A number that is at its tolerance is not within it, and just inside it is: each rule is tried.

Of every comparison in a rule the number on the left is put beside what it is compared with, on
either side and where it is alone also to the very bit, in the made-up evidence of the rule
(`tests.test_claim_rules`). The sign of the comparison is read from the source, so that the rule
itself is held to it. Of ``max(...)`` each entry in turn is put there, of ``abs(...)`` both signs.
"""

from __future__ import annotations

import ast
import inspect
import sys
import textwrap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.test_claim_rules import CASES

Evidence = Mapping[str, Any]
BESIDE = 1e-6
"""A comparison is tried so far from what is compared with, relative to it."""

SIGNS: dict[type[ast.cmpop], tuple[float, bool]] = {
    ast.Lt: (-1.0, False), ast.LtE: (-1.0, True), ast.Gt: (1.0, False), ast.GtE: (1.0, True),
}  # fmt: skip
"""On which side of what is compared with a comparison holds, and whether it holds there too."""

Case = tuple[Any, Evidence, Any, list[tuple[Evidence, Any]]]


ELSEWHERE = {
    "fig11.rule_values: min(e.late.values()) > 0.0",
    "fig11.rule_order: e.orbit[1] < min(larger)",
    "fig11.rule_stable: set(e.odd_stable) >= {3, 5, 7}",
    "fig11.rule_stable: max(e.growth_mirrored.values()) > 0.0",
    "fig13.rule_law: len(e.settled) >= 10",
    "fig16.rule_admissible: size[e.zeta < 0] > e.threshold",
    "fig16.rule_admissible: size[e.zeta > 0] < e.threshold",
    "fig16.rule_admissible: e.zeta < 0",
    "fig16.rule_admissible: e.zeta > 0",
    "text_friction.rule_nucleation: len(e.outward) > 2",
}
"""Comparisons of counts, sets and arrays, which the cases of the rules themselves hold."""


@dataclass(frozen=True, kw_only=True)
class Edge:
    """One comparison of a rule: ``left < right``, where `left` is made of one piece of evidence."""

    case: Case
    test: ast.Compare

    def __str__(self) -> str:
        rule = self.case[0]
        return f"{rule.__module__.rpartition('.')[2]}.{rule.__name__}: {ast.unparse(self.test)}"

    @property
    def sign(self) -> type[ast.cmpop]:
        """How it compares."""
        return type(self.test.ops[0])

    @property
    def around(self) -> str:
        """``abs``, ``max`` or ``min`` if that is around the left side, else an empty word."""
        name = _called(self.test.left)
        return name if name in ("abs", "max", "min") else ""

    @property
    def inner(self) -> ast.expr:
        """What is on the left, without that."""
        return _argument(self.test.left) if self.around else self.test.left

    @property
    def name(self) -> str:
        """Of the evidence that is put beside the edge."""
        return next(node.attr for node in ast.walk(self.inner) if _is_evidence(node))

    @property
    def places(self) -> list[int | None]:
        """Where in that piece of evidence the number is: every place of those of a maximum."""
        held = self.case[1][self.name]
        if isinstance(held, int | float):
            return [None]
        if self.around in ("max", "min"):
            return list(range(len(held)))
        index = [node.slice for node in ast.walk(self.inner) if isinstance(node, ast.Subscript)]
        return [ast.literal_eval(index[0])]

    @property
    def each_counts(self) -> bool:
        """Whether it takes all places, as in ``max(...) < bound``, to be on its side."""
        return SIGNS[self.sign][0] == {"max": -1.0, "min": 1.0}.get(self.around, 0.0)

    def tried(self, place: int | None, evidence: Evidence) -> Iterator[tuple[Any, ...]]:
        """Yield the sign of the number; the verdicts inside, outside and, if exact, at the edge."""
        held = evidence[self.name]

        def put(x: float) -> dict[str, Any]:
            return {**evidence, self.name: x if place is None else _with(held, place, x)}

        def left(x: float) -> float:
            alone = self.around in ("max", "min")  # one of its numbers
            return x if alone else float(_value(self.case[0], self.inner, put(x)))

        def verdict(x: float) -> Any:
            return self.case[0](SimpleNamespace(**put(x))).verdict

        side, _ = SIGNS[self.sign]
        bound = _value(self.case[0], self.test.comparators[0], evidence)
        start, rise = left(0.0), left(1.0) - left(0.0)
        for sign in (1.0, -1.0) if self.around == "abs" else (1.0,):
            width = side * max(BESIDE * abs(bound), 1e-15)
            near = [(sign * (bound + way * width) - start) / rise for way in (1.0, -1.0)]
            exact = (start, rise) == (0.0, 1.0)
            yield sign, *map(verdict, near), verdict(sign * bound) if exact else None


def _value(rule: Callable[..., Any], node: ast.expr, evidence: Evidence) -> Any:
    names = {**vars(sys.modules[rule.__module__]), "e": SimpleNamespace(**evidence)}
    return eval(compile(ast.Expression(node), rule.__name__, "eval"), names)


def _called(node: ast.expr) -> str:
    if not isinstance(node, ast.Call):
        return ""
    return node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)


def _argument(node: ast.expr) -> ast.expr:
    assert isinstance(node, ast.Call)
    return node.args[0] if node.args else node.func.value  # type: ignore[attr-defined]


def _is_evidence(node: ast.AST) -> bool:
    return isinstance(node, ast.Attribute) and ast.unparse(node.value) == "e"


def _with(held: Any, index: int, x: Any) -> Any:
    entries = list(held)
    entries[index] = x
    return tuple(entries) if isinstance(held, tuple) else np.array(entries)


def rule_nodes(rule: Callable[..., Any]) -> Iterator[ast.AST]:
    """Yield the nodes of a rule and of the functions of its module to which it hands evidence."""
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(rule)))):
        yield node
        if isinstance(node, ast.Call) and list(map(ast.unparse, node.args)) == ["e"]:
            yield from rule_nodes(getattr(sys.modules[rule.__module__], _called(node)))


def edges() -> Iterator[Edge]:
    """Yield the comparisons whose left side is made of one piece of evidence, a number."""
    for case in CASES:
        for node in rule_nodes(case[0]):
            if not (isinstance(node, ast.Compare) and len(node.ops) == 1):
                continue
            edge = Edge(case=case, test=node)
            if type(node.ops[0]) in SIGNS and any(map(_is_evidence, ast.walk(edge.inner))):
                yield edge


EDGES = [edge for edge in edges() if str(edge) not in ELSEWHERE]


@pytest.mark.parametrize("edge", EDGES, ids=str)
def test_a_rule_changes_its_verdict_at_its_edge_and_nowhere_else(edge: Edge) -> None:
    good, changes = edge.case[1], edge.case[3]
    every = [{**good, **change} for change in ({}, *(change for change, _ in changes))]
    if edge.each_counts:  # where the other places are on their side
        every = [each for each in every if _value(edge.case[0], edge.test, each)]
    decided = 0
    for place in edge.places:
        tried = (each for evidence in every for each in edge.tried(place, evidence))
        found = [each for each in tried if each[1] is not each[2]]
        signs = {sign for sign, *_ in found}
        assert signs or not edge.each_counts, place
        decided += len(signs) == (2 if edge.around == "abs" else 1)
        for _, inside, _, at in found:
            assert at is None or (at is inside) is SIGNS[edge.sign][1]
    assert decided, "no evidence of this rule is decided by this comparison"


def test_what_is_held_elsewhere_is_still_there() -> None:
    assert set(map(str, edges())) >= ELSEWHERE
