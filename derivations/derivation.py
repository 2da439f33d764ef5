"""A derivation is a list of steps, and each step can fail."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import sympy as sp

from derivations.algebra.errors import CheckFailedError, DerivationInputError
from derivations.algebra.steps import Check, Evidence


@dataclass(frozen=True)
class Step:
    """One step of a derivation.

    Attributes
    ----------
    operation : str
        What was done, in words.
    equation : Basic
        The equation that came out: an ``Eq``, an inequality, or a ``Tuple`` of them.
    check : callable
        Judges any equation in the place of this one; see `Check`.
    number : int or None
        Number of the equation in the paper.
    """

    operation: str
    equation: sp.Basic
    check: Check = field(repr=False)
    number: int | None = None

    def verify(self, equation: sp.Basic | None = None) -> Evidence:
        """Run the check on this step's equation, or on another one put in its place.

        An equation that the check cannot even evaluate does not hold.
        """
        judged = self.equation if equation is None else equation
        try:
            return self.check(judged)
        except (TypeError, ValueError, ArithmeticError, AttributeError, IndexError) as error:
            return Evidence(False, f"it could not be evaluated ({type(error).__name__}: {error})")

    def _repr_latex_(self) -> str:
        from derivations.rendering import equation_latex

        return f"$\\displaystyle {equation_latex(self.equation)}$"


@dataclass(frozen=True)
class Derivation:
    """A named list of steps.

    Attributes
    ----------
    key : str
        Name on the command line.
    title : str
        One line.
    steps : tuple of Step
        In order.
    """

    key: str
    title: str
    steps: tuple[Step, ...]

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
            One a step.

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
        """Return the step that carries an equation number of the paper.

        Raises
        ------
        DerivationInputError
            If no step of this derivation carries it.
        """
        for step in self.steps:
            if step.number == number:
                return step
        held = ", ".join(str(step.number) for step in self.steps if step.number is not None)
        raise DerivationInputError(
            "equation", number, f"one of {held} in '{self.key}'", "choose one of these numbers"
        )

    def only(self, number: int) -> Derivation:
        """Return the same derivation with the single step that carries ``number``."""
        return replace(self, steps=(self.numbered(number),))

    def _repr_markdown_(self) -> str:
        from derivations.rendering import markdown

        return markdown(self)


def joined(key: str, title: str, parts: Sequence[Derivation]) -> Derivation:
    """Several derivations, one after the other."""
    return Derivation(key, title, tuple(step for part in parts for step in part.steps))


def equation(left: sp.Expr, right: sp.Expr | int) -> sp.Eq:
    """``left = right`` as a live object, never collapsed to true or false."""
    return sp.Eq(left, right, evaluate=False)
