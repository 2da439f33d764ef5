"""A derivation is a graph of steps: given equations, and the results of operations on them.

A `Given` step is entered by hand: a model, a definition or an ansatz. A `Derived` step never is: it
contains operations and source steps, and its result is that of the operations applied to the
results of the sources. Every step has a check that shares no code with its derivation.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property, partialmethod

import numpy as np
import sympy as sp

from derivations.algebra.errors import CheckFailedError, DerivationInputError, StepError
from derivations.algebra.operations import Operation, OperationError


class Kind(StrEnum):
    """The kinds of steps."""

    MODEL = "model"
    DEFINITION = "definition"
    ANSATZ = "ansatz"
    DERIVED = "derived"


@dataclass(frozen=True)
class Evidence:
    """The result of a check.

    Attributes
    ----------
    holds : bool
        Whether the equation passed.
    statement : str
        What was compared with what, and how closely they agree.
    """

    holds: bool
    statement: str

    def __post_init__(self) -> None:
        if not isinstance(self.statement, str):  # a text in place of the verdict would be true
            raise TypeError(f"evidence is a verdict and a statement, not {self.statement}")
        object.__setattr__(self, "holds", bool(self.holds))  # numpy has a boolean type of its own


Check = Callable[[sp.Basic], Evidence]
"""Judges an equation by means that share no code with its derivation."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Step(ABC):
    """One step of a derivation; either `Given` or `Derived`.

    Attributes
    ----------
    name : str
        Name used by other steps and by the graph; unique within the toolkit.
    check : callable
        Judges any equation in place of this one; see `Check`.
    number : int or None
        Number of the equation in the paper.
    note : str
        Additional information beside the operation: a branch rule, a condition.
    """

    name: str
    check: Check = field(repr=False)
    number: int | None = None
    note: str = ""

    @property
    @abstractmethod
    def kind(self) -> Kind:
        """Model, definition, ansatz or derived."""

    @property
    @abstractmethod
    def result(self) -> sp.Basic:
        """The equation: an ``Eq``, an inequality, or a ``Tuple`` of them."""

    @property
    @abstractmethod
    def sources(self) -> tuple[Step, ...]:
        """The steps from which it follows."""

    @property
    @abstractmethod
    def operation(self) -> str:
        """What was done, in words."""

    @property
    def label(self) -> str:
        """``(n)`` for an equation of the paper, otherwise the name."""
        return f"({self.number})" if self.number is not None else f"'{self.name}'"

    def verify(self, candidate: sp.Basic | None = None) -> Evidence:
        """Run the check on this step's result, or on another equation in its place.

        An equation that the check cannot evaluate does not hold.
        """
        return self._own_evidence if candidate is None else self._judged(candidate)

    @cached_property
    def _own_evidence(self) -> Evidence:
        """The evidence for the result, which never changes."""
        return self._judged(self.result)

    def _judged(self, candidate: sp.Basic) -> Evidence:
        try:
            with np.errstate(all="ignore"):  # a value that is not finite fails the check
                return self.check(candidate)
        except DerivationInputError:  # concerns the model, not the candidate
            raise
        except (TypeError, ValueError, ArithmeticError, AttributeError, LookupError) as error:
            return Evidence(False, f"it could not be evaluated ({type(error).__name__}: {error})")


@dataclass(frozen=True, kw_only=True, eq=False)
class Given(Step):
    """A step entered by hand: a model, a definition or an ansatz.

    Attributes
    ----------
    given_as : Kind
        MODEL, DEFINITION or ANSATZ.
    equation : Basic
        The equation.
    words : str
        What is assumed or defined, and why.
    """

    given_as: Kind
    equation: sp.Basic
    words: str

    def __post_init__(self) -> None:
        if self.given_as is Kind.DERIVED:
            raise ValueError(f"step '{self.name}': a derived equation is never given")

    @property
    def kind(self) -> Kind:
        """Model, definition or ansatz."""
        return self.given_as

    @property
    def result(self) -> sp.Basic:
        """The equation as given."""
        return self.equation

    @property
    def sources(self) -> tuple[Step, ...]:
        """Empty, since the step is given."""
        return ()

    @property
    def operation(self) -> str:
        """What is assumed or defined."""
        return self.words


@dataclass(frozen=True, kw_only=True, eq=False)
class Derived(Step):
    """A computed step: operations applied to the results of other steps.

    The first operation receives the results of all sources, each further one the preceding result.

    Attributes
    ----------
    operations : tuple of Operation
        At least one.
    given_by : tuple of Step
        The sources, at least one.
    assumes : bool
        Whether the step only expresses an ansatz in terms of earlier results; it then counts as an
        ansatz.
    """

    operations: tuple[Operation, ...]
    given_by: tuple[Step, ...]
    assumes: bool

    def __post_init__(self) -> None:
        if not self.operations or not self.given_by:
            raise ValueError(f"step '{self.name}' needs an operation and a source")

    @property
    def kind(self) -> Kind:
        """Derived, or ansatz if the step only expresses one."""
        return Kind.ANSATZ if self.assumes else Kind.DERIVED

    @cached_property
    def result(self) -> sp.Basic:
        """The result of the operations on the sources.

        Raises
        ------
        StepError
            If the operations cannot be carried out for this model.
        """
        sources = [source.result for source in self.given_by]
        try:
            found = self.operations[0](*sources)
            for operation in self.operations[1:]:
                found = operation(found)
        except OperationError as error:
            raise StepError(self.name, str(error)) from error
        return found

    @property
    def sources(self) -> tuple[Step, ...]:
        """The steps from which it follows."""
        return self.given_by

    @property
    def operation(self) -> str:
        """What was done, one sentence per operation."""
        labels = [source.label for source in self.given_by]
        sentences = [self.operations[0].words(labels)]
        sentences += [operation.words(["the result"]) for operation in self.operations[1:]]
        return "; ".join(sentences)


@dataclass(frozen=True)
class Derivation:
    """A named sequence of steps, each after its sources, which may lie in earlier derivations.

    Attributes
    ----------
    key : str
        Name on the command line.
    title : str
        A title of one line.
    steps : tuple of Step
        The steps in order.
    """

    key: str
    title: str
    steps: tuple[Step, ...]

    def __post_init__(self) -> None:
        names = [step.name for step in self.steps]
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated:
            raise ValueError(f"derivation '{self.key}' has two steps called '{repeated[0]}'")

    def examined(self) -> Iterator[tuple[Step, Evidence]]:
        """Each step with its evidence; stops after the first step whose check fails."""
        for step in self.steps:
            evidence = step.verify()
            yield step, evidence
            if not evidence.holds:
                return

    def verify(self) -> tuple[Evidence, ...]:
        """Check every step.

        Returns
        -------
        tuple of Evidence
            One for each step.

        Raises
        ------
        CheckFailedError
            At the first step whose check fails.
        """
        found = []
        for position, (_, evidence) in enumerate(self.examined(), start=1):
            if not evidence.holds:
                raise CheckFailedError(self.key, position, evidence.statement)
            found.append(evidence)
        return tuple(found)

    def numbered(self, number: int) -> Step:
        """Return the step with a given equation number of the paper.

        Raises
        ------
        DerivationInputError
            If no step of this derivation has this number.
        """
        for step in self.steps:
            if step.number == number:
                return step
        numbers = ", ".join(str(step.number) for step in self.steps if step.number is not None)
        raise DerivationInputError(
            "equation", number, f"one of {numbers} in '{self.key}'", "choose one of these numbers"
        )

    def named(self, name: str) -> Step:
        """Return the step with a given name.

        Raises
        ------
        DerivationInputError
            If there is none.
        """
        for step in self.steps:
            if step.name == name:
                return step
        raise DerivationInputError(
            "step", name, f"a step of '{self.key}'", "choose one of its names"
        )

    def only(self, number: int) -> Derivation:
        """Return the same derivation with only the step that has this ``number``."""
        return replace(self, steps=(self.numbered(number),))


class Draft:
    """The steps of a derivation while it is being written, each after its sources.

    Sources are referred to by name, as in an appendix; a name stands for a step of this derivation,
    otherwise of an earlier one.

    Parameters
    ----------
    *earlier : Derivation
        Derivations that this one builds on.
    """

    def __init__(self, *earlier: Derivation) -> None:
        self._earlier = [step for derivation in earlier for step in derivation.steps]
        self._steps: list[Step] = []

    def __getitem__(self, name: str) -> Step:
        for step in (*self._steps, *self._earlier):
            if step.name == name:
                return step
        raise ValueError(f"no step is called '{name}' so far")

    def __contains__(self, name: str) -> bool:
        return any(step.name == name for step in self._steps)

    def add(self, *steps: Step) -> None:
        """Add existing steps unchanged."""
        self._steps += steps

    def given(
        self, kind: Kind, name: str, equation: sp.Basic, words: str, *, check: Check,
        number: int | None = None, note: str = "",
    ) -> None:  # fmt: skip
        """Add a given step: its equation, and in words what is assumed or defined."""
        self.add(Given(name=name, given_as=kind, equation=equation, words=words, check=check,
                       number=number, note=note))  # fmt: skip

    model = partialmethod(given, Kind.MODEL)
    definition = partialmethod(given, Kind.DEFINITION)
    ansatz = partialmethod(given, Kind.ANSATZ)

    def derived(
        self, name: str, operations: Operation | tuple[Operation, ...], *sources: str,
        check: Check, number: int | None = None, note: str = "", assumes: bool = False,
    ) -> None:  # fmt: skip
        """Add a step derived from the steps with these names."""
        sequence = operations if isinstance(operations, tuple) else (operations,)
        self.add(Derived(name=name, operations=sequence, given_by=tuple(self[q] for q in sources),
                         check=check, number=number, note=note, assumes=assumes))  # fmt: skip

    def finished(self, key: str, title: str) -> Derivation:
        """Return the finished derivation."""
        return Derivation(key, title, tuple(self._steps))
