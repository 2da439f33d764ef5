"""Equations (1) to (54) as printed, judged by the checks of the derivations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING

from paper_checks.claim import Claim, Erratum, Formula, Method, Ruling, Verdict
from paper_checks.claims._equation_errata import LONG, erratum_of
from paper_checks.claims._equation_numbers import method, residual
from paper_checks.ruling import corrected, fails, holds

if TYPE_CHECKING:
    from derivations.judgement import EquationJudgement

MISPRINTS = frozenset({2, 4, 33, 42})
"""Equations that are wrong as printed and right after a correction proved by the derivation."""

STYLE = {
    3: "< stands for ≤ at the one instant of release (fig02-stick).",
    6: "The argument of μ is scaled: its reference velocity is the $\\tilde v_0$ of (7). As in "
    "(3), < stands for ≤ at the instant of release.",
    7: "The text before (7) names (1) as the chain that it belongs to; the parameters are scaled, "
    "so it is (5).",
    32: "The sign of equality with zero is left out; (33), which follows from it, has it.",
    40: "It is written for a ring; with open ends, as the figures have them, the end sites have "
    "one neighbour. Thresholds of breathers in the bulk do not depend on it.",
    44: "The inequalities are between moduli: φ is complex, and its modulus decides which line "
    "holds.",
    45: "The argument of the step is a difference of moduli: φ is complex.",
    51: "It is the derivative on the roots of (50), where $-i\\hat v$ has been eliminated by L = "
    "0; (49) and (53) use it there only.",
}
"""Matters of notation that fail a literal check but can be used as they stand: remarks."""

ROUNDING = 1e-10
"""Tolerance for numbers inserted into an equation whose terms are of order one."""

KINDS = {
    "holds": "holds",
    "definition": "definition",
    "misprint": "misprint",
    "inconsistent": "holds",
    "ambiguous": "holds",
    "assumption": "ansatz or assumption",
}


@cache
def judgements() -> dict[int, EquationJudgement]:
    """Return the results of the derivations for every equation."""
    from derivations.judgement import report

    return {found.printed.number: found for found in report().judgements}


@dataclass(frozen=True, kw_only=True)
class CheckedEquation:
    """A printed equation with the results of its derivation and its check."""

    number: int
    kind: str
    passes: bool
    """Whether the printed equation passes the numerical test."""
    derived_passes: bool
    confirmed: bool
    """Whether everything recorded about it is found again."""
    note: str
    test: str
    derived_test: str
    readings: tuple[tuple[str, bool, str], ...]
    """Meaning, whether it holds, and what it implies."""
    latex: str
    derived: str
    affects: str
    residual: float | None
    """By how much numbers of the toolkit violate the printed equation; None if there are none."""

    @property
    def numbers_agree(self) -> bool:
        """Whether they satisfy it to within rounding."""
        return self.residual is None or self.residual < ROUNDING

    @property
    def style(self) -> str:
        """The remark on its notation, if there is one."""
        return STYLE.get(self.number, "")

    @property
    def remarks(self) -> tuple[str, ...]:
        """Further remarks: its notation, other readings."""
        remarks = [self.style] if self.style else []
        remarks += [
            f"Read as “{meaning}” it {'holds' if good else 'fails'}: {implies}."
            for meaning, good, implies in self.readings
        ]
        return tuple(remarks)

    @property
    def outcome(self) -> str:
        """The result in words."""
        kind = KINDS.get(self.kind, self.kind)
        if self.passes:
            return f"{kind}; the printed equation passes the numerical test"
        if self.style and self.number not in MISPRINTS:
            return "holds as it is meant; see the remark on how it is written"
        return f"{kind}; the printed equation fails the numerical test"


def printed(number: int) -> CheckedEquation:
    """Return the evidence on one equation."""
    found = judgements()[number]
    corrected_form = found.corrected or ""
    return CheckedEquation(
        number=number,
        kind=found.printed.verdict.value,
        passes=found.on_print.holds,
        derived_passes=found.on_derived.holds,
        confirmed=found.confirmed,
        note=found.printed.note,
        test=_said(found.on_print.statement),
        derived_test=_said(found.on_derived.statement),
        readings=tuple(
            (reading.meaning, evidence.holds, str(reading.implies).rstrip("."))
            for reading, evidence in zip(found.printed.readings, found.on_readings, strict=True)
        ),
        latex=found.printed.latex,
        derived=corrected_form if len(corrected_form) <= LONG else "",
        affects=found.printed.affects,
        residual=residual(number),
    )


def _said(statement: str) -> str:
    """Return the result of a test in words; a statement that cannot be evaluated has none."""
    meant = "taken literally it cannot be evaluated"
    return meant if "could not be evaluated" in statement else statement


def rule(e: CheckedEquation) -> Ruling:
    """Rule: a printed equation that passes holds; a matter of notation is only a remark."""
    if not e.confirmed or not e.derived_passes:
        return fails("the derivation does not give this equation, nor a corrected form of it.")
    if not e.numbers_agree:
        return fails("numbers of the toolkit do not satisfy the printed equation.")
    if e.passes or (e.style and e.number not in MISPRINTS):
        return holds()
    if e.kind == "misprint":
        return corrected(
            "the printed equation fails the numerical test, and the derived one passes it."
        )
    return fails("the printed equation fails the numerical test.")


def formulas(e: CheckedEquation) -> tuple[Formula, ...]:
    """Return the equation as printed, and as derived if it differs."""
    shown = [Formula("As printed", e.latex)]
    if e.derived and not e.passes:
        shown.append(Formula("As derived", e.derived))
    return tuple(shown)


def erratum(e: CheckedEquation) -> Erratum | None:
    """Return the erratum of a misprint; matters of notation have none."""
    if rule(e).verdict is not Verdict.CORRECTED:
        return None
    from derivations.catalogue import owner

    return erratum_of(judgements()[e.number], owner(e.number))


CLAIMS = tuple(
    Claim(
        key=f"eq{number:02d}",
        place=f"Eq. ({number})",
        quote=f"Eq. ({number})",
        statement=f"Equation ({number}) holds as printed.",
        recorded=Verdict.CORRECTED if number in MISPRINTS else Verdict.REPRODUCED,
        command=f"fronts derive --equation {number}",
        evidence=partial(printed, number),
        rule=rule,
        methods=(
            Method(
                "derived step by step in computer algebra, print and derivation compared at "
                "random points",
                "derivations.judgement:report",
            ),
            *method(number),
        ),
        formulas=formulas,
        erratum=erratum,
        weight=0,
        shared=judgements,
    )
    for number in range(1, 55)
)
