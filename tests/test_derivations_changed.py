"""The checks of a derivation as judges of changes in the code that it enters."""

from __future__ import annotations

import builtins
from collections.abc import Iterator
from contextlib import contextmanager
from types import FunctionType
from typing import Any

import pytest

from benchmarks.mutation import derived
from benchmarks.mutation.entered import ENTER, codes_in, naming
from benchmarks.mutation.mutants import Mutant, mutants_of

MODULE = "derivations/small_checks.py"
SOURCE = """
import sympy as sp
from derivations.algebra.equations import equation
from derivations.algebra.operations import Operation
from derivations.algebra.steps import Draft, Evidence

p, q = sp.symbols("p q")
TWO = 2

def factor():
    return TWO

def unread():
    return 5

class Multiply(Operation):
    def __call__(self, source):
        return equation(source.lhs, factor() * source.rhs)

class Write(Operation):
    def __call__(self, source):
        return equation(source.lhs, source.rhs + 1 - 1)

def given(candidate):
    return Evidence(candidate == equation(p, q), "as given")

def twice(candidate):
    return Evidence(abs(candidate.rhs.subs(q, 0.25) - 0.5) < 1e-9, "a quarter and a half")

def near(size):
    def check(candidate):
        return Evidence(abs(candidate.rhs.subs(q, 0.5) - size) < 1e-9, "a half and one")
    return check

def derive():
    draft = Draft()
    size = 1.0
    draft.model("start", equation(p, q), "a model", check=given)
    draft.derived("twice", Multiply(), "start", check=twice)
    draft.derived("twice in other words", Write(), "twice", check=twice)
    draft.derived("once more", Write(), "twice in other words", check=near(size))
    return draft.finished("small", "a model and its double")
"""

_AGAIN = "draft.derived(Write(), 'once more', 'twice in other words', check=near(size))"
_LAST = "draft.derived('once more', Write(), 'twice in other words', check=near(size))"
_BOUND = "abs(candidate.rhs.subs(q, {}) - {}) <{} 1e-09"
PASSED = {
    "unread:5 -> 6": "nothing enters it",
    "twice:1e-09 -> 1e-06": "how narrow a check is, is a matter of tests",
    f"twice:{_BOUND.format(0.25, 0.5, '')} -> {_BOUND.format(0.25, 0.5, '=')}": "none is there",
    "near.check:1e-09 -> 1e-06": "the same",
    f"near.check:{_BOUND.format(0.5, 'size', '')} -> {_BOUND.format(0.5, 'size', '=')}": "the same",
    f"derive:{_LAST} -> ...": "a step is left out, and nothing follows from it",
    f"derive:{_LAST} -> {_AGAIN}": "a step has another name, and nothing follows from it",
    "derive:draft.finished('small', 'a model and its double') -> "
    "draft.finished('a model and its double', 'small')": "no check reads the title",
}
"""Changes that no check notices, and why."""


class _Living:
    """The module as it lives, and what it enters."""

    def __init__(self) -> None:
        self.names: set[str] = set()
        self.functions: dict[str, FunctionType] = {}
        builtins.__dict__[ENTER] = self.names.add
        scope: dict[str, Any] = {"__name__": "small_checks"}
        exec(compile(naming(SOURCE.encode(), MODULE), MODULE, "exec"), scope)
        self.scope = scope
        for each in list(scope.values()):
            for own in (each, *vars(each).values()) if isinstance(each, type) else (each,):
                if isinstance(own, FunctionType) and own.__code__.co_filename == MODULE:
                    self.functions[own.__qualname__] = own

    def derivations(self) -> Iterator[tuple[str, Any]]:
        yield "small", self.scope["derive"]

    @contextmanager
    def with_change(self, mutant: Mutant) -> Iterator[None]:
        """Put a change in place, and what was there back again."""
        with mutant.made() as tree:
            code = compile(tree, MODULE, "exec")
        if not mutant.outermost:
            changed: dict[str, Any] = {"__name__": "small_checks"}
            exec(code, changed)
            before, self.scope["TWO"] = self.scope["TWO"], changed["TWO"]
            yield
            self.scope["TWO"] = before
            return
        new = {c.co_qualname: c for c in codes_in(code)}
        own = self.functions[mutant.outermost]
        old, own.__code__ = own.__code__, new[own.__qualname__]
        yield
        own.__code__ = old


def _noticed(monkeypatch: pytest.MonkeyPatch) -> dict[str, str | None]:
    monkeypatch.setitem(builtins.__dict__, ENTER, None)  # as it was, afterwards
    living = _Living()
    monkeypatch.setattr(derived, "derivations", living.derivations)
    checks = derived.DerivationChecks(living.names, lambda: None)
    found: dict[str, str | None] = {}
    for mutant in mutants_of(MODULE, SOURCE):
        name = mutant.name.removeprefix(f"{MODULE}:")
        with living.with_change(mutant):
            try:
                found[name] = checks.noticing(mutant)
            except Exception as error:  # a child of a run answers with its type
                found[name] = type(error).__name__
        assert (checks.seconds(mutant) > 0.0) == (mutant.function != "unread")
    return found


def test_a_check_notices_each_change_that_it_can_and_no_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = _noticed(monkeypatch)
    assert {name for name, by in found.items() if by is None} == set(PASSED)
    # What is changed is noticed where it enters first, and a looser check by what it refused.
    multiplied = "factor() * source.rhs -> factor() / source.rhs"
    assert found[f"Multiply.__call__:{multiplied}"] == "small: twice"
    written = "return equation(source.lhs, source.rhs + 1 - 1)"
    assert found[f"Write.__call__:1 -> 2 in {written} #2"] == "small: twice in other words"
    assert found["given:equation(p, q) -> equation(q, p)"] == "small: start"
    # Outside functions, and what a check is made from.
    assert found["<module>:2 -> 3"] == "small: twice"
    assert found["derive:1.0 -> 2.0"] == "small: once more"
    looser = "abs(candidate.rhs.subs(q, 0.25) - 0.5) -> candidate.rhs.subs(q, 0.25) - 0.5"
    assert found[f"twice:{looser}"] == "small: twice, perturbed"
