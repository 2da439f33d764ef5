"""Every displayed equation exactly as printed, and the verdict that its check gives.

A verdict is never only on record: `judge` puts the printed equation in the place of the derived
one and runs the same check. For a misprint the check must fail on print and pass on the
correction; an ambiguous equation lists its readings and what becomes of each; an inconsistent one
passes its own check, and fails that of another place of the paper.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import lru_cache
from typing import Any

import sympy as sp

from derivations import catalogue
from derivations.derivation import Check, Derivation, Evidence, Step
from derivations.errors import CheckFailedError, DerivationInputError
from derivations.rendering import equation_latex


class Verdict(StrEnum):
    """The possible verdicts on a printed equation."""

    HOLDS = "holds"
    MISPRINT = "misprint"
    AMBIGUOUS = "ambiguous"
    INCONSISTENT = "inconsistent"
    DEFINITION = "definition"
    ASSUMPTION = "assumption"


@dataclass(frozen=True)
class Reading:
    """One way to read an ambiguous equation, or what another place asks of an inconsistent one.

    Attributes
    ----------
    meaning : str
        The reading, in words.
    equation : Basic
        The equation in this reading.
    check : callable or None
        Judges it; None for the check of the derived step.
    holds : bool
        Whether it is expected to pass.
    implies : str
        What follows from it.
    """

    meaning: str
    equation: sp.Basic
    holds: bool
    implies: str
    check: Check | None = field(default=None, repr=False)


@dataclass(frozen=True)
class Printed:
    """A displayed equation of the paper.

    Attributes
    ----------
    number : int
        1 to 54.
    latex : str
        As printed.
    equation : Basic
        The same as a live object.
    verdict : Verdict
        On record; `judge` must find it again.
    note : str
        Why, in a sentence or two.
    affects : str
        What later in the paper hangs on it; empty for nothing.
    readings : tuple of Reading
        For an ambiguous equation. For an inconsistent one: what another place makes of it, which
        fails, and the form that does not.
    slip : (Basic, Basic, Basic) or None
        For a misprint of one term: as printed, as it should be, and the equation with that change
        alone, which must be the derived one.
    """

    number: int
    latex: str
    equation: sp.Basic
    verdict: Verdict
    note: str
    affects: str = ""
    readings: tuple[Reading, ...] = ()
    slip: tuple[sp.Basic, sp.Basic, sp.Basic] | None = None


@dataclass(frozen=True)
class Judgement:
    """What the checks said about a printed equation.

    Attributes
    ----------
    printed : Printed
        The equation.
    step : Step
        The derivation step with the same number.
    corrected : str or None
        LaTeX of the corrected or disambiguated form.
    on_print : Evidence
        The check run on the equation as printed.
    on_derived : Evidence
        The check run on the derived equation.
    on_readings : tuple of Evidence
        One a reading.
    """

    printed: Printed
    step: Step
    corrected: str | None
    on_print: Evidence
    on_derived: Evidence
    on_readings: tuple[Evidence, ...]

    @property
    def confirmed(self) -> bool:
        """Whether the checks give the verdict on record."""
        if not self.on_derived.holds:
            return False
        if self.printed.verdict is Verdict.MISPRINT:
            return not self.on_print.holds
        expected = [reading.holds for reading in self.printed.readings]
        as_expected = expected == [found.holds for found in self.on_readings]
        if self.printed.verdict is Verdict.AMBIGUOUS:
            return as_expected and any(expected)
        if self.printed.verdict is Verdict.INCONSISTENT:
            both = any(expected) and not all(expected)
            return self.on_print.holds and as_expected and both
        return self.on_print.holds

    def record(self) -> dict[str, Any]:
        """Plain data for JSON."""
        readings = [
            {"meaning": reading.meaning, "holds": found.holds, "implies": reading.implies,
             "latex": equation_latex(reading.equation), "evidence": found.statement}
            for reading, found in zip(self.printed.readings, self.on_readings, strict=True)
        ]  # fmt: skip
        return {
            "number": self.printed.number,
            "verdict": self.printed.verdict.value,
            "corrected": self.corrected,
            "note": self.printed.note,
            "affects": self.printed.affects,
            "printed": self.printed.latex,
            "confirmed": self.confirmed,
            "evidence": {"printed": self.on_print.statement, "derived": self.on_derived.statement},
            "readings": readings,
        }


@lru_cache(maxsize=1)
def equations() -> tuple[Printed, ...]:
    """All 54 displayed equations in order."""
    from derivations import printed_averaging, printed_breather, printed_friction, printed_front

    found = (*printed_friction.EQUATIONS, *printed_breather.EQUATIONS,
             *printed_averaging.EQUATIONS, *printed_front.EQUATIONS)  # fmt: skip
    return tuple(sorted(found, key=lambda printed: printed.number))


def printed(number: int) -> Printed:
    """One displayed equation.

    Raises
    ------
    DerivationInputError
        If the paper has no equation of this number.
    """
    for found in equations():
        if found.number == number:
            return found
    raise DerivationInputError("equation", number, "from 1 to 54", "choose one of these numbers")


def judge(found: Printed, derivation: Derivation) -> Judgement:
    """Run the checks on a printed equation.

    Parameters
    ----------
    found : Printed
        The equation.
    derivation : Derivation
        The derivation that contains its number.
    """
    step = derivation.numbered(found.number)
    on_derived = step.verify()
    on_print = step.verify(found.equation)
    readings = []
    for reading in found.readings:
        check = reading.check or step.check
        try:
            readings.append(check(reading.equation))
        except (TypeError, ValueError, ArithmeticError, AttributeError) as error:
            readings.append(Evidence(False, f"it could not be evaluated ({error})"))
    wrong = found.verdict in (Verdict.MISPRINT, Verdict.AMBIGUOUS)
    corrected = equation_latex(step.equation) if wrong else None
    return Judgement(found, step, corrected, on_print, on_derived, tuple(readings))


@dataclass(frozen=True)
class Report:
    """The verdict on every equation, with all derivations checked on the way.

    Attributes
    ----------
    judgements : tuple of Judgement
        One a number, 1 to 54.
    failures : tuple of str
        Derivations that stopped, and verdicts that were not confirmed.
    seconds : float
        Time taken.
    """

    judgements: tuple[Judgement, ...]
    failures: tuple[str, ...]
    seconds: float


def report(keys: Sequence[str] = catalogue.NUMBERED) -> Report:
    """Check every step of every derivation and judge every printed equation."""
    start = time.perf_counter()
    judgements: list[Judgement] = []
    failures: list[str] = []
    for key in keys:
        order = 2 if key == "multiple-scales" else 1
        derivation = catalogue.load(key, order)
        numbers = {step.number for step in derivation.steps if step.number is not None}
        judgements += [judge(found, derivation) for found in equations() if found.number in numbers]
        try:
            # Numbered steps were just checked; the others are checked here.
            rest = tuple(step for step in derivation.steps if step.number is None)
            Derivation(derivation.key, derivation.title, rest).verify()
        except CheckFailedError as error:
            failures.append(str(error))
    failures += [
        f"equation {found.printed.number}: '{found.printed.verdict}' was not confirmed"
        for found in judgements
        if not found.confirmed
    ]
    judgements.sort(key=lambda found: found.printed.number)
    return Report(tuple(judgements), tuple(failures), time.perf_counter() - start)
