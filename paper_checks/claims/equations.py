"""Equations (1) to (54) as printed, judged by the checks of the derivations."""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING

from paper_checks.claim import Claim, Finding, Formula, Verdict
from paper_checks.claims._assumptions import ASSUMED
from paper_checks.equation_errata import LONG, erratum_of, readable

if TYPE_CHECKING:
    from derivations.judgement import Judgement

MISPRINTS = frozenset({2, 3, 4, 32, 33, 42})
"""Right after a correction that the derivation proves."""

INCONSISTENT = frozenset({36, 40})
"""Right by itself, and another place of the paper asks for something else."""

OPEN = frozenset({6, 9, 35, 37, 38, 44, 45, 47, 51, 53})
"""Ambiguous, or an assumption that does not always hold: right under one reading or in places."""

_VERDICT_OF = {
    "holds": Verdict.REPRODUCED,
    "definition": Verdict.REPRODUCED,
    "misprint": Verdict.CORRECTED,
    "inconsistent": Verdict.CORRECTED,
    "ambiguous": Verdict.PARTIAL,
    "assumption": Verdict.REPRODUCED,
}
"""For an equation that passes as said there and assumes nothing more; see ``_assumptions``."""


@cache
def _judgements() -> dict[int, Judgement]:
    from derivations.judgement import report

    return {found.printed.number: found for found in report().judgements}


def _judge(number: int) -> Finding:
    found = _judgements()[number]
    kind = found.printed.verdict.value
    verdict = _VERDICT_OF[kind]
    lines = [found.printed.note]
    second = readable(found.on_derived.statement)
    value = f"{kind}; print {'passes' if found.on_print.holds else 'fails'} its check"
    if number in ASSUMED:
        holds, words = ASSUMED[number]()
        verdict = verdict if holds else Verdict.PARTIAL
        value += f"; what it assumes {'holds' if holds else 'does not hold throughout'}"
        lines.append(f"What it assumes: {words}.")
        second += f"; {words}"
    if not found.confirmed:
        verdict = Verdict.NOT_REPRODUCED
    if found.printed.affects:
        lines.append(f"What it affects: {found.printed.affects}")
    lines += [
        f"Reading: {reading.meaning}: {'holds' if evidence.holds else 'fails'}. {reading.implies}"
        for reading, evidence in zip(found.printed.readings, found.on_readings, strict=True)
    ]
    lines.append(f"The check on print: {found.on_print.statement}.")
    from derivations.catalogue import owner

    erratum = erratum_of(found, owner(number)) if found.confirmed else None
    formulas = [Formula("As printed", found.printed.latex)]
    if found.corrected and len(found.corrected) <= LONG:
        formulas.append(Formula("As derived", found.corrected))
    return Finding(
        verdict=verdict,
        value=value,
        error="none: the comparison is symbolic, or to rounding at random points",
        methods=("derived step by step in computer algebra", second),
        tolerance="a printed equation must pass the same check as the derived one, or fail it",
        explanation=readable("\n\n".join(line for line in lines if line)),
        formulas=tuple(formulas),
        erratum=erratum,
    )


def _recorded(number: int) -> Verdict:
    if number in MISPRINTS | INCONSISTENT:
        return Verdict.CORRECTED
    return Verdict.PARTIAL if number in OPEN else Verdict.REPRODUCED


CLAIMS = tuple(
    Claim(
        key=f"eq{number:02d}",
        place=f"Eq. ({number})",
        statement=f"Equation ({number}) is right as printed.",
        printed=None,
        recorded=_recorded(number),
        command=f"fronts derive --equation {number}",
        judge=partial(_judge, number),
        weight=0,
        shared=_judgements,
    )
    for number in range(1, 55)
)
