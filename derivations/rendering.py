"""Show a derivation: text, LaTeX, MathML, JSON, Markdown, and a document that compiles."""

from __future__ import annotations

import html
import re
from typing import Any

import sympy as sp

from derivations.derivation import Derivation, Evidence, Step
from derivations.evidence import parts_of

TERMS_A_LINE = 3
"""Longer sums are broken so that they fit the width of a page."""

FORMATS = ("text", "latex", "mathml", "json")
"""How a derivation can be shown on the command line."""

PREAMBLE = r"""\documentclass[a4paper,11pt]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\usepackage[margin=22mm]{geometry}
\usepackage{amsmath,amssymb}
\allowdisplaybreaks
\setcounter{MaxMatrixCols}{40}
"""


def equation_text(equation: sp.Basic) -> str:
    """Return an equation on one line, a system on several.

    Examples
    --------
    >>> equation_text(sp.Eq(sp.Symbol("x"), 2))
    'x = 2'
    """
    return "\n".join(_one_text(part) for part in parts_of(equation))


def equation_latex(equation: sp.Basic) -> str:
    """LaTeX for use inside a display; a system becomes ``aligned`` lines."""
    parts = [str(sp.latex(part)) for part in parts_of(equation)]
    if len(parts) == 1:
        return parts[0]
    return "\\begin{aligned}\n" + " \\\\\n".join(f"& {part}" for part in parts) + "\n\\end{aligned}"


def equation_mathml(equation: sp.Basic) -> str:
    """Presentation MathML, one ``math`` element."""
    rows = [_ENTITY.sub(_plain, sp.mathml(part, printer="presentation"))
            for part in parts_of(equation)]  # fmt: skip
    rows = [row.replace("<mo><</mo>", "<mo>&lt;</mo>") for row in rows]  # left bare by SymPy
    body = rows[0]
    if len(rows) > 1:
        cells = "".join(f"<mtr><mtd>{row}</mtd></mtr>" for row in rows)
        body = f"<mtable>{cells}</mtable>"
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">{body}</math>'


def text(derivation: Derivation) -> str:
    """Write the steps with their evidence; where a check fails, say so and stop."""
    lines = [derivation.title, ""]
    for position, (step, evidence) in enumerate(derivation.examined(), start=1):
        label = f"  (Eq. {step.number})" if step.number is not None else ""
        lines.append(f"{position}. {step.operation}{label}")
        lines += [f"     {line}" for line in equation_text(step.equation).splitlines()]
        lines += [f"   {_verdict(evidence)}: {evidence.statement}", ""]
        if not evidence.holds:
            lines.append(f"Stopped at step {position} of {len(derivation.steps)}.")
    return "\n".join(lines).rstrip()


def records(derivation: Derivation) -> dict[str, Any]:
    """Return the derivation as plain data for JSON."""
    steps = []
    complete = True
    for step, evidence in derivation.examined():
        complete = complete and evidence.holds
        steps.append(
            {
                "operation": step.operation,
                "number": step.number,
                "equation": equation_text(step.equation),
                "latex": equation_latex(step.equation),
                "holds": evidence.holds,
                "evidence": evidence.statement,
            }
        )
    return {
        "derivation": derivation.key,
        "title": derivation.title,
        "complete": complete and len(steps) == len(derivation.steps),
        "steps": steps,
    }


def markdown(derivation: Derivation) -> str:
    """Markdown with displayed LaTeX, for a notebook."""
    lines = [f"### {derivation.title}", ""]
    for position, (step, evidence) in enumerate(derivation.examined(), start=1):
        label = f" (Eq. {step.number})" if step.number is not None else ""
        lines += [f"{position}. {step.operation}{label}", ""]
        lines += [f"$$\n{equation_latex(step.equation)}\n$$", ""]
        lines += [f"*{_verdict(evidence)}:* {evidence.statement}", ""]
    return "\n".join(lines)


def mathml(derivation: Derivation) -> str:
    """One XHTML fragment with a ``math`` element a step."""
    rows = []
    for step, evidence in derivation.examined():
        label = f" (Eq. {step.number})" if step.number is not None else ""
        rows.append(
            f"<li><p>{_escape(step.operation)}{label}</p>{equation_mathml(step.equation)}"
            f"<p>{_verdict(evidence)}: {_escape(evidence.statement)}</p></li>"
        )
    return f"<section><h2>{_escape(derivation.title)}</h2><ol>{''.join(rows)}</ol></section>"


def document(*derivations: Derivation) -> str:
    """Return a complete LaTeX document."""
    body = []
    for derivation in derivations:
        body.append(f"\\section*{{{_tex_words(derivation.title)}}}\n\\begin{{enumerate}}")
        for step, evidence in derivation.examined():
            body.append(f"\\item {_tex_words(step.operation)}")
            body.append(_display(step))
            body.append(f"\\emph{{{_verdict(evidence)}:}} {_tex_words(evidence.statement)}.")
        body.append("\\end{enumerate}")
    return PREAMBLE + "\\begin{document}\n" + "\n".join(body) + "\n\\end{document}\n"


def shown(derivation: Derivation, form: str) -> str:
    """Return the derivation in one of the text formats."""
    if form == "latex":
        return document(derivation)
    return mathml(derivation) if form == "mathml" else text(derivation)


def _display(step: Step) -> str:
    lines = []
    for part in parts_of(step.equation):
        if isinstance(part, sp.Equality) and not part.has(sp.MatrixBase):
            lines.append(_broken(part))
        else:
            lines.append("& " + sp.latex(part))
    tag = f" \\tag{{{step.number}}}" if step.number is not None else ""
    return "\\begin{align*}\n" + " \\\\\n".join(lines) + tag + "\n\\end{align*}"


def _broken(equation: sp.Equality) -> str:
    left, right = equation.args
    if len(sp.Add.make_args(left)) > TERMS_A_LINE and right == 0:
        return _lines(left, "") + " = 0"
    return f"{sp.latex(left)} ={{}} " + _lines(right, "")


def _lines(total: sp.Expr, prefix: str) -> str:
    pieces: list[str] = []
    for place, term in enumerate(sp.Add.make_args(total)):
        printed = sp.latex(term)
        if place and not printed.startswith("-"):
            printed = "+ " + printed
        if place % TERMS_A_LINE == 0:
            pieces.append((" \\\\\n" if place else "") + "& ")
        pieces.append(printed + " ")
    return prefix + "".join(pieces).rstrip()


_ENTITY = re.compile(r"&([A-Za-z]+);")
"""SymPy writes names such as InvisibleTimes, which XML does not know."""


def _plain(match: re.Match[str]) -> str:
    known = ("lt", "gt", "amp", "quot", "apos")
    return match[0] if match[1] in known else html.unescape(match[0])


def _one_text(part: sp.Basic) -> str:
    if isinstance(part, sp.Equality):
        return f"{sp.sstr(part.lhs)} = {sp.sstr(part.rhs)}"
    return str(sp.sstr(part))


def _verdict(evidence: Evidence) -> str:
    return "checked" if evidence.holds else "CHECK FAILED"


def _escape(words: str) -> str:
    return words.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


_TEX = {
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "_": r"\_",
    "&": r"\&",
    "%": r"\%",
    "#": r"\#",
    "$": r"\$",
    "{": r"\{",
    "}": r"\}",
    "<": r"\ensuremath{<}",
    ">": r"\ensuremath{>}",
    "|": r"\ensuremath{|}",
}


def _tex_words(words: str) -> str:
    return "".join(_TEX.get(letter, letter) for letter in words)
