"""The verdict on every displayed equation, as given by its checks.

A verdict is never merely recorded: `judge` puts the printed equation in place of the derived one,
compares the two symbolically, and runs the same numerical check. An equation that holds must agree
in both ways. For a misprint both must fail on print, and the derived form must pass. An ambiguous
equation lists its readings and the result for each; an inconsistent one passes its own check, and
fails that of another passage of the paper.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from derivations import catalogue
from derivations.algebra.equations import same
from derivations.algebra.errors import CheckFailedError, DerivationInputError
from derivations.algebra.rendering import equation_latex, source_of
from derivations.algebra.steps import Derivation, Evidence, Step
from derivations.printing import EquationVerdict, PrintedEquation
from derivations.transcription.readings import found_changes, read_correction, stated_changes


@dataclass(frozen=True)
class EquationJudgement:
    """The results of the checks of a printed equation.

    Attributes
    ----------
    printed : PrintedEquation
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
        One for each reading.
    agrees : bool
        Whether left minus right of print and of the derived equation simplify to the same.
    correction_agrees : bool
        For a misprint: whether print with only the stated tokens replaced reads as the derived
        equation.
    """

    printed: PrintedEquation
    step: Step
    corrected: str | None
    on_print: Evidence
    on_derived: Evidence
    on_readings: tuple[Evidence, ...]
    agrees: bool
    correction_agrees: bool = False

    @property
    def confirmed(self) -> bool:
        """Whether the checks confirm the recorded verdict."""
        if not self.on_derived.holds:
            return False
        if self.printed.verdict is EquationVerdict.MISPRINT:
            return not self.on_print.holds and not self.agrees and self.correction_agrees
        expected = [reading.holds for reading in self.printed.readings]
        as_expected = expected == [found.holds for found in self.on_readings]
        if self.printed.verdict is EquationVerdict.AMBIGUOUS:
            return as_expected and any(expected)
        if self.printed.verdict is EquationVerdict.INCONSISTENT:
            both = any(expected) and not all(expected)
            return self.on_print.holds and self.agrees and as_expected and both
        if self.printed.verdict is EquationVerdict.HOLDS:
            return self.on_print.holds and self.agrees
        return self.on_print.holds  # a definition or an assumption is not derived

    def record(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        readings = [
            {"meaning": reading.meaning, "holds": found.holds, "implies": reading.implies,
             "latex": equation_latex(reading.equation), "evidence": found.statement}
            for reading, found in zip(self.printed.readings, self.on_readings, strict=True)
        ]  # fmt: skip
        return {
            "number": self.printed.number,
            "verdict": self.printed.verdict.value,
            "kind": self.step.kind.value,
            "operation": self.step.operation,
            "from": [source_of(source) for source in self.step.sources],
            "check": self.on_derived.statement,
            "corrected": self.corrected,
            "note": self.printed.note,
            "affects": self.printed.affects,
            "printed": self.printed.latex,
            "confirmed": self.confirmed,
            "evidence": {"printed": self.on_print.statement, "derived": self.on_derived.statement},
            "readings": readings,
        }


def _transcribed(name: str) -> tuple[PrintedEquation, ...]:
    """Return the printed equations that belong to a derivation."""
    folder = catalogue.LISTING[name][0].partition(".")[0]
    entries: tuple[PrintedEquation, ...] = importlib.import_module(
        f"derivations.{folder}.printed"
    ).EQUATIONS
    return entries


@lru_cache(maxsize=1)
def equations() -> tuple[PrintedEquation, ...]:
    """Return all 54 displayed equations in order."""
    found = [entry for name in catalogue.NUMBERED for entry in _transcribed(name)]
    return tuple(sorted(found, key=lambda printed: printed.number))


def printed(number: int) -> PrintedEquation:
    """Return one displayed equation.

    Raises
    ------
    DerivationInputError
        If the paper has no equation with this number.
    """
    for found in _transcribed(catalogue.owner(number)):
        if found.number == number:
            return found
    raise DerivationInputError("equation", number, "from 1 to 54", "choose one of these numbers")


def judge(found: PrintedEquation, derivation: Derivation) -> EquationJudgement:
    """Run the checks on a printed equation.

    Parameters
    ----------
    found : PrintedEquation
        The equation.
    derivation : Derivation
        The derivation that contains its number.
    """
    step = derivation.numbered(found.number)
    on_derived = step.verify()
    on_print = on_derived if found.expression == step.result else step.verify(found.expression)
    readings = []
    for reading in found.readings:
        check = reading.check or step.check
        try:
            readings.append(check(reading.equation))
        except (TypeError, ValueError, ArithmeticError, AttributeError) as error:
            readings.append(Evidence(False, f"it could not be evaluated ({error})"))
    wrong = found.verdict in (EquationVerdict.MISPRINT, EquationVerdict.AMBIGUOUS)
    corrected = equation_latex(step.result) if wrong else None
    agrees = _agrees(found, step)
    return EquationJudgement(found, step, corrected, on_print, on_derived, tuple(readings), agrees,
                     correction_agrees=_corrects(found, step))  # fmt: skip


def _agrees(found: PrintedEquation, step: Step) -> bool:
    """Whether print is the step's equation; an assumption may be read as amended."""
    if found.verdict is EquationVerdict.ASSUMPTION and found.amendments:
        return same(read_correction(found), step.result)
    return same(found.expression, step.result)


def _corrects(found: PrintedEquation, step: Step) -> bool:
    """Whether its stated tokens alone turn a misprint into the derived equation."""
    if found.verdict is not EquationVerdict.MISPRINT or not found.amendments:
        return False
    if found_changes(found) != stated_changes(found):
        return False
    return same(read_correction(found), step.result)


@dataclass(frozen=True, kw_only=True)
class EquationReport:
    """The verdict on every equation, including a check of all derivations.

    Attributes
    ----------
    judgements : tuple of EquationJudgement
        One for each number, 1 to 54.
    failures : tuple of str
        Derivations that stopped, and verdicts that were not confirmed.
    seconds : float
        Wall-clock time.
    """

    judgements: tuple[EquationJudgement, ...]
    failures: tuple[str, ...]
    seconds: float


def report(
    keys: Sequence[str] = catalogue.NUMBERED, progress: Callable[[float], None] | None = None
) -> EquationReport:
    """Check every step of every derivation and judge every printed equation.

    Parameters
    ----------
    keys : sequence of str
        Names of the derivations.
    progress : callable, optional
        Called after each step with the fraction done.
    """
    start = time.perf_counter()
    judgements: list[EquationJudgement] = []
    failures: list[str] = []
    derivations = [catalogue.load(key) for key in keys]
    done, total = 0, sum(len(derivation.steps) for derivation in derivations)
    for derivation in derivations:
        for step in derivation.steps:
            judgements += [judge(e, derivation) for e in equations() if e.number == step.number]
            step.verify()
            done += 1
            if progress is not None:
                progress(done / total)
        try:
            # The failures of numbered steps are found with their judgements, those of others here.
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
    return EquationReport(
        judgements=tuple(judgements), failures=tuple(failures),
        seconds=time.perf_counter() - start,
    )  # fmt: skip
