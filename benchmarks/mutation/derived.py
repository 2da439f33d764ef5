"""Whether the checks of the derivations notice a change in them that no test noticed.

Everything is derived once, and the functions that the result of each step and its check enter are
recorded. After a change, each derivation that enters the changed function is derived and checked
again: a step whose result differs is judged by its check, and a check that enters the function must
pass its step as before and refuse the perturbed equations that it refused before.
"""

from __future__ import annotations

import ast
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import sympy as sp

from benchmarks.mutation.mutants import Mutant
from derivations import catalogue
from derivations.algebra.steps import Derivation, Derived, Step
from derivations.cell.envelope import derive_envelope
from derivations.chain import ChainModel
from derivations.symbols import a, b
from tests.perturbed_equations import sampled


def derivations() -> Iterator[tuple[str, Callable[[], Derivation]]]:
    """Yield name and constructor of derivations for the paper's chain, another, and two cells."""
    weight, cubic = sp.symbols("w g", positive=True)
    other = ChainModel(damping={0: 1, 2: -a, 4: b}, stiffness={3: cubic}, weights=(1, weight))
    for key in catalogue.LISTING:
        yield key, partial(catalogue.load, key)
    for key in ("multiple-scales", "averaging", "second-order"):
        yield f"{key} of another chain", partial(catalogue.load, key, model=other)
    for damping, stiffness in (("2 - a*y**2 + b*y**4", None), ("y**2 - 1", "k2*y**2 + k3*y**3")):
        yield f"cell with {damping}", partial(_cell, damping, stiffness)


def _cell(damping: str, stiffness: str | None) -> Derivation:
    return derive_envelope(damping, stiffness).derivation


def reached(steps: tuple[Step, ...], found: dict[Step, None]) -> dict[Step, None]:
    """Add the steps to ``found``, each preceded by all steps that it follows from; return it."""
    for step in steps:
        if step not in found:
            reached(step.sources, found)[step] = None
    return found


@dataclass(frozen=True, kw_only=True)
class _Made:
    """An unchanged derivation: the functions entered in building it and in all, and the time."""

    key: str
    make: Callable[[], Derivation]
    derivation: Derivation
    building: frozenset[str]
    entered: frozenset[str]
    seconds: float


class DerivationChecks:
    """The unchanged derivations, and the functions that each step enters.

    Parameters
    ----------
    names : set of str
        Names of functions entered, as returned by :func:`benchmarks.mutation.entered.install`.
    forget : callable
        Empties the caches of the project.
    """

    def __init__(self, names: set[str], forget: Callable[[], None]) -> None:
        self._names, self._forget = names, forget
        self._made: list[_Made] = []
        self._result: dict[Step, frozenset[str]] = {}
        self._check: dict[Step, frozenset[str]] = {}
        self._refused: dict[Step, list[sp.Basic]] = {}
        forget()
        names.clear()
        begin = time.process_time()
        for key, make in derivations():
            made = make()
            building = frozenset(names)
            every = reached(made.steps, {})
            for step in every:
                self._result[step] = self._entered(partial(getattr, step, "result"))
            for step in made.steps:
                forget()
                self._check[step] = self._entered(partial(self._judge, step))
            results = frozenset().union(*(self._result[step] for step in every))
            checks = frozenset().union(*(self._check[step] for step in made.steps))
            entered = building | results | checks
            end = time.process_time()
            self._made.append(
                _Made(
                    key=key,
                    make=make,
                    derivation=made,
                    building=building,
                    entered=entered,
                    seconds=end - begin,
                )
            )
            forget()
            names.clear()
            begin = end
        self._made.sort(key=lambda made: made.seconds)  # the first ones notice most changes

    def _entered(self, run: Callable[[], object]) -> frozenset[str]:
        self._names.clear()
        run()
        return frozenset(self._names)

    def _judge(self, step: Step) -> None:
        step.verify()
        changes = [changed for _, changed in sampled(step)]
        self._refused[step] = [each for each in changes if not step.verify(each).holds]

    def seconds(self, mutant: Mutant) -> float:
        """Return the processor time of all derivations that enter the changed function."""
        places = self._places(mutant)
        return sum(made.seconds for made in self._made if places & made.entered)

    def _places(self, mutant: Mutant) -> frozenset[str]:
        """Return the changed function; for a change outside any, all functions of its module."""
        if mutant.outermost:
            return frozenset({mutant.function_at})
        own = f"{mutant.module}:"
        return frozenset(q for made in self._made for q in made.entered if q.startswith(own))

    def noticing(self, mutant: Mutant) -> str | None:
        """Return the step whose check notices the change now in place, or None."""
        places = self._places(mutant)
        self._forget()
        for before in self._made:
            if not places & before.entered:
                continue
            made = before.make()
            again = {step.name: step for step in made.steps}
            # A step that is now missing is a matter for the tests.
            steps = [step for step in before.derivation.steps if step.name in again]
            known: dict[tuple[Step, Step], bool] = {}
            other = [q for q in steps if not self._is_same(q, again[q.name], places, known)]
            asked = [q for q in steps if places & self._check[q]]
            if places & before.building:  # a check may be built differently
                named = _texts_around(mutant) & again.keys()
                asked = [q for q in steps if not named or q in asked or q.name in named]
            for step in dict.fromkeys((*other, *asked)):
                new = again[step.name]
                if not new.verify().holds:
                    return f"{before.key}: {step.name}"
                if step in asked and any(new.verify(q).holds for q in self._refused[step]):
                    return f"{before.key}: {step.name}, perturbed"
        return None

    def _is_same(
        self, old: Step, new: Step, places: frozenset[str], known: dict[tuple[Step, Step], bool]
    ) -> bool:
        """Whether the result of a step is unchanged; it is computed only if it may have changed."""
        if (old, new) in known:
            return known[old, new]
        pairs = zip(old.sources, new.sources, strict=False)
        same = [self._is_same(*pair, places, known) for pair in pairs]
        if (
            isinstance(old, Derived)
            and isinstance(new, Derived)
            and not places & self._result[old]
            and old.operations == new.operations
            and len(same) == len(new.sources) == len(old.sources)
            and all(same)
        ):
            vars(new)["result"] = old.result
        known[old, new] = new.result == old.result
        return known[old, new]


def _texts_around(mutant: Mutant) -> set[str]:
    """Return the strings in the calls around a change, among them the names of the steps there."""
    calls = [node for node in ast.walk(mutant.tree) if isinstance(node, ast.Call)]
    around = [node for node in calls if node.lineno <= mutant.line <= (node.end_lineno or 0)]
    parts = [part for node in around for part in ast.walk(node)]
    return {
        part.value
        for part in parts
        if isinstance(part, ast.Constant) and isinstance(part.value, str)
    }
