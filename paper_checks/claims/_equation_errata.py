"""The entry of a displayed equation in the table of errata, from the results of its derivation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from paper_checks.finding import Erratum, Fault

if TYPE_CHECKING:
    import sympy as sp

    from derivations.judgement import EquationJudgement

LONG = 420
"""Number of characters of LaTeX above which a difference is shown instead of the whole equation."""


def erratum_of(found: EquationJudgement, derivation: str) -> Erratum | None:
    """Return the erratum of a misprinted, ambiguous or inconsistent equation, otherwise None.

    Parameters
    ----------
    found : EquationJudgement
        The results of the checks in this run.
    derivation : str
        Name of the derivation that contains the step.
    """
    from derivations.printing import EquationVerdict

    printed = found.printed
    line = printed.amended_latex
    differs = ""
    step = f"the step '{found.step.name}: {found.step.operation}' of the derivation '{derivation}'"
    if printed.verdict is EquationVerdict.MISPRINT:
        fault = Fault.MISPRINT
        differs = correction(found)
        corrected = f"${line}$" if line else differs
        proof = (
            f"The check on print fails: {found.on_print.statement}. What {step} gives passes the "
            f"same check: {found.on_derived.statement}."
        )
        differs = f" The derivation differs from print in this: {differs}." if line else ""
    elif printed.verdict in (EquationVerdict.AMBIGUOUS, EquationVerdict.INCONSISTENT):
        ambiguous = printed.verdict is EquationVerdict.AMBIGUOUS
        fault = Fault.AMBIGUOUS if ambiguous else Fault.INCONSISTENT
        tried = list(zip(printed.readings, found.on_readings, strict=True))
        right = [reading for reading, evidence in tried if evidence.holds]
        # A changed line has a single reading, the last; otherwise all readings that hold are named.
        named = right[-1:] if line else right
        mark = "read: " if ambiguous else ""
        corrected = "; or ".join(f"{mark}{reading.meaning}" for reading in named)
        if line or ambiguous:
            corrected = f"${line or printed.latex}$; {corrected}"
        proof = f"Compared with {step}. "
        if not ambiguous:
            proof += f"By itself the print passes: {found.on_print.statement}. "
        proof += " ".join(
            f"{'The reading ' if ambiguous else ''}“{reading.meaning}” "
            f"{'holds' if evidence.holds else 'fails'}: {evidence.statement}."
            for reading, evidence in tried
        )
    else:
        return None
    return Erratum(
        fault=fault,
        printed=f"${printed.latex}$",
        corrected=corrected,
        reason=printed.note,
        proof=proof + differs,
        affects=printed.affects or "Nothing else.",
    )


def correction(found: EquationJudgement) -> str:
    """Return the part of the derived equation that differs from print, between dollar signs.

    For a system, the equations that differ; for a matrix, the first entry that differs; if a single
    term is identified as wrong, that term; for another long equation, the difference from print.
    """
    import sympy as sp

    from derivations.algebra.equations import parts_of
    from derivations.algebra.rendering import equation_latex

    printed, derived = found.printed.expression, found.step.result
    if found.printed.slip is not None:
        before, after, whole = found.printed.slip
        if sp.expand(_side(whole) - _side(derived)) != 0:
            raise ArithmeticError(f"({found.printed.number}): the slip is not all that is wrong")
        return f"${equation_latex(after)}$ in place of ${equation_latex(before)}$"
    if not isinstance(printed, sp.Eq | sp.Tuple):
        if sp.expand(printed - _side(derived)) == 0:
            return "add $= 0$ at the end"
        return f"${found.corrected}$"
    pairs = list(zip(parts_of(printed), parts_of(derived), strict=False))
    wrong = [(old, new) for old, new in pairs if _differ(old, new)]
    if len(pairs) > 1 and wrong:
        return "; ".join(f"${equation_latex(new)}$" for _, new in wrong)
    if isinstance(printed.rhs, sp.MatrixBase):
        return _entry(printed.rhs, derived.rhs)
    if len(found.corrected or "") <= LONG:
        return f"${found.corrected}$"
    missing = sp.factor(sp.expand(_side(derived) - _side(printed)))
    return f"add to the left side ${equation_latex(missing)}$"


def _differ(old: sp.Basic, new: sp.Basic) -> bool:
    """Whether two parts of a system differ; inequalities differ if their signs do."""
    import sympy as sp

    if isinstance(old, sp.Eq) or not isinstance(old, sp.core.relational.Relational):
        return bool(sp.simplify(_side(old) - _side(new)) != 0)
    return bool(old != new)


def _side(equation: sp.Basic) -> sp.Expr:
    import sympy as sp

    if isinstance(equation, sp.Eq):
        left, right = equation.args
        if isinstance(right, sp.MatrixBase):
            return sp.Integer(0)
        return left - right
    return sp.sympify(equation)


def _entry(printed: sp.MatrixBase, derived: sp.MatrixBase) -> str:
    from derivations.algebra.rendering import equation_latex

    places = [
        (row, column)
        for row in range(printed.rows)
        for column in range(printed.cols)
        if printed[row, column] - derived[row, column] != 0
    ]
    row, column = places[0]
    return (
        f"the entry ({row + 1}, {column + 1}) for N = {printed.rows // 2} is "
        f"${equation_latex(derived[row, column])}$, and so for {len(places) - 1} others"
    )
