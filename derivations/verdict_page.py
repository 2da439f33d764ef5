"""The Markdown page of verdicts on the printed equations: `docs/derivations.md`."""

from __future__ import annotations

from derivations.judgement import EquationJudgement, EquationReport
from derivations.printing import EquationVerdict

HEAD = """# Derivations

This page is written by `fronts derive all --format markdown`, and a test compares it with the
output of the code. `fronts derive` lists the derivations. Each is a graph of steps. Only models,
definitions and ansätze are entered by hand; every other equation is the result of operations on
earlier ones. Each step has a check that is independent of the way in which its equation was found.
The checks compare with direct averages, numerical derivatives, winding numbers, a front constructed
in the time domain, or periodic orbits. A derivation stops at the first check that fails.

    fronts derive multiple-scales --order 2
    fronts derive multiple-scales --damping "1 - a*y**2 + b*y**6" --stiffness "g*y**3"
    fronts derive averaging --weights "1, w"
    fronts derive --equation 42
    fronts derive all --json
    fronts derive --graph --out equations.svg
    fronts derive cell --damping "1 - a*y**2 + b*y**4" --value a=4 --value b=0.5 --order 2

![The equations of the paper and what each follows from](derivations.svg)

## Verdicts on the printed equations

Each verdict is computed and compared with the recorded one. The printed equation is compared
symbolically with the derived equation, and is then submitted to the same numerical check.

"""

TAIL = """
## In Python

    from derivations.cell.envelope import derive_envelope
    cell = derive_envelope("1 - a*y**2 + b*y**4", stiffness="k3*y**3")
    cell.equation, cell.ratio, cell.with_values({"a": 4, "b": 0.5}).cycles
    cell.compiled(a=4, b=0.5, k3=0.1, c=0.3).rate(1 + 1j, 0.2, 0.3)

    from derivations.catalogue import load
    from derivations.chain import ChainModel
    load("multiple-scales", model=ChainModel(damping={0: 1, 2: -3, 6: 1}, weights=(1, 1))).verify()

Letters other than y denote positive numbers. Expressions are read by a small grammar and are never
evaluated as code.

## Limits

- Multiple scales and averaging use different amplitudes at second order. Compare them only after
  the step "averaging in the amplitude of multiple scales".
- The expansion to second order is in ε, but its error is governed by ε max|1 - a y^2 + b y^4|
  on the cycle.
- The kinetic relation of a cell with nonlinear stiffness neglects the change of frequency with
  amplitude, which its output states. Linear stiffness, which amounts to another unit of time, is
  refused there.
- Symbolic cycles are given for damping up to degree 4 in y; for higher degrees the parameters must
  be numbers.
- For springs beyond nearest neighbours (29) remains a relation for e^(k_1) that is not solved, and
  the amplitudes with quarter-turn phase steps are real only where springs join odd neighbours.
- With springs to third neighbours the limits at rest, depinning and retreat, and the branch of (37)
  are omitted, since they require the roots of a cubic. Strong coupling is omitted where the force
  of the springs on long waves has no definite sign.
"""


def page(report: EquationReport) -> str:
    """Return the page as Markdown.

    Parameters
    ----------
    report : EquationReport
        The report on all derivations.
    """
    lines = ["| | verdict | kind | follows from | note |", "|---|---|---|---|---|"]
    lines += [_row(found) for found in report.judgements]
    wrong = [found for found in report.judgements
             if found.printed.verdict in (EquationVerdict.MISPRINT, EquationVerdict.AMBIGUOUS,
                                          EquationVerdict.INCONSISTENT)]  # fmt: skip
    parts = ["", "### Equations that are not correct as printed", ""]
    for found in wrong:
        parts += [_entry(found), ""]
    return (HEAD + "\n".join(lines + parts) + TAIL).rstrip()


def _row(found: EquationJudgement) -> str:
    sources = ", ".join(f"({source.number})" if source.number is not None else source.name
                        for source in found.step.sources)  # fmt: skip
    note = found.printed.note.replace("|", r"\|")
    return (
        f"| ({found.printed.number}) | {found.printed.verdict.value} | {found.step.kind.value} | "
        f"{sources} | {note} |"
    )


def _entry(found: EquationJudgement) -> str:
    printed = found.printed
    lines = [f"**({printed.number})**, {printed.verdict.value}. {printed.note}"]
    if printed.affects:
        lines.append(f"Affected: {printed.affects}")
    for reading, evidence in zip(printed.readings, found.on_readings, strict=True):
        holds = "holds" if evidence.holds else "does not hold"
        lines.append(f"Read as {reading.meaning}: {holds} ({reading.implies}).")
    return " ".join(lines)
