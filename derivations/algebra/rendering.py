"""Display of a derivation: text, LaTeX, MathML, JSON, Markdown, and a complete LaTeX document."""

from __future__ import annotations

import re
from functools import partial
from html import escape
from keyword import iskeyword
from typing import Any
from unicodedata import name as unicode_name
from unicodedata import normalize

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import parts_of
from derivations.algebra.mathml import as_text, mathml_element
from derivations.algebra.notation import Script, displayed
from derivations.algebra.steps import Derivation, Evidence, Kind, Step
from derivations.algebra.sums import SumOver

_escape = partial(escape, quote=False)

TERMS_A_LINE = 3
"""Number of terms above which a sum is broken to fit the width of a page."""

PREAMBLE = r"""\documentclass[a4paper,11pt]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\usepackage[margin=22mm]{geometry}
\usepackage{amsmath,amssymb,graphicx}
\newsavebox{\row}
\newcommand{\fitted}[1]{\sbox{\row}{$\displaystyle #1$}%
  \ifdim\wd\row>0.85\linewidth\resizebox{0.85\linewidth}{!}{\usebox{\row}}\else\usebox{\row}\fi}
\allowdisplaybreaks
\setcounter{MaxMatrixCols}{40}
"""


_ASSUMED = re.compile(r"""(Symbol\((?:'[^']*'|"[^"]*"))(?:, \w+=(?:True|False))+\)""")
"""A symbol in ``srepr``, with its assumptions."""


def equation_text(equation: sp.Basic) -> str:
    """Return an equation in Unicode; a system part by part, a long sum in several rows.

    Examples
    --------
    >>> equation_text(sp.Eq(sp.Symbol("x"), 2))
    'x = 2'
    """
    return "\n".join(_one_text(part) for part in parts_of(equation))


def equation_latex(equation: sp.Basic) -> str:
    """Return LaTeX for use inside a display; a system becomes ``aligned`` lines."""
    parts = [_latex(part) for part in parts_of(equation)]
    if len(parts) == 1:
        return parts[0]
    return "\\begin{aligned}\n" + " \\\\\n".join(f"& {part}" for part in parts) + "\n\\end{aligned}"


def equation_mathml(equation: sp.Basic) -> str:
    """Return presentation MathML, one ``math`` element; a long sum is broken as in LaTeX."""
    rows = [
        "".join(as_text(inner) for inner in mathml_element(row, block=True))
        for part in parts_of(equation)
        for row in _broken(part)
    ]
    body = rows[0]
    if len(rows) > 1:
        cells = "".join(f"<mtr><mtd>{row}</mtd></mtr>" for row in rows)
        body = f'<mtable displaystyle="true" columnalign="left">{cells}</mtable>'
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">{body}</math>'


def equation_expression(equation: sp.Basic) -> str:
    """Return the equation as text that ``sympy.sympify`` reads back.

    Relations are written unevaluated, so that none collapses to true or false. ``str`` is used if
    no name has a meaning of its own in SymPy, otherwise ``srepr``. In both, symbols are written
    without assumptions; a sum over roots is read back as an unknown function.

    Examples
    --------
    >>> equation_expression(sp.Eq(sp.Symbol("x"), sp.Symbol("zeta"), evaluate=False))
    "Equality(Symbol('x'), Symbol('zeta'), evaluate=False)"
    """
    parts = [_written(part) for part in parts_of(equation)]
    return parts[0] if not isinstance(equation, sp.Tuple) else f"Tuple({', '.join(parts)})"


def _written(part: sp.Basic) -> str:
    names = {q.name for q in part.atoms(sp.Symbol)}
    names |= {q.func.__name__ for q in part.atoms(AppliedUndef)}
    reserved = any(
        hasattr(sp, name) or iskeyword(name) or not name.isidentifier() for name in names
    )
    has_sums = part.has(SumOver)
    write = _bare if reserved or has_sums else sp.sstr
    if isinstance(part, sp.core.relational.Relational):
        sides = ", ".join(str(write(side)) for side in part.args)
        return f"{type(part).__name__}({sides}, evaluate=False)"
    return str(write(part))


def _bare(part: sp.Basic) -> str:
    return _ASSUMED.sub(r"\1)", sp.srepr(part))


def sentence(step: Step) -> str:
    """Return kind, operation and note of a step as running text."""
    kind = "" if step.kind is Kind.DERIVED else f"{step.kind.value.capitalize()}: "
    words = step.operation if kind else step.operation[:1].upper() + step.operation[1:]
    # A note that begins with a lower-case letter, possibly a symbol, continues the sentence.
    mark = "; " if step.note[:1].islower() else ". "
    return f"{kind}{words}" + (f"{mark}{step.note}" if step.note else "")


def named(step: Step) -> str:
    """Return the equation number of a step, or the name by which later steps refer to it."""
    return f"(Eq. {step.number})" if step.number is not None else f"['{step.name}']"


def text(derivation: Derivation) -> str:
    """Write the steps with their evidence; if a check fails, say so and stop."""
    lines = [derivation.title, ""]
    for position, (step, evidence) in enumerate(derivation.examined(), start=1):
        lines.append(f"{position}. {sentence(step)}  {named(step)}")
        lines += [f"     {line}" for line in equation_text(step.result).splitlines()]
        lines += [f"   {_verdict(evidence)}: {evidence.statement}", ""]
        if not evidence.holds:
            lines.append(f"Stopped at step {position} of {len(derivation.steps)}.")
    return "\n".join(lines).rstrip()


def source_of(step: Step) -> int | str:
    """Return the name of a source in JSON: its number, or its name if it has none."""
    return step.number if step.number is not None else step.name


def records(derivation: Derivation) -> dict[str, Any]:
    """Return the derivation as plain data for JSON."""
    steps = []
    complete = True
    for step, evidence in derivation.examined():
        complete = complete and evidence.holds
        steps.append(
            {
                "name": step.name,
                "number": step.number,
                "kind": step.kind.value,
                "operation": step.operation,
                "from": [source_of(source) for source in step.sources],
                "note": step.note,
                "equation": equation_text(step.result),
                "expression": equation_expression(step.result),
                "latex": equation_latex(step.result),
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
    """Return Markdown with displayed LaTeX, for a notebook."""
    lines = [f"### {derivation.title}", ""]
    for position, (step, evidence) in enumerate(derivation.examined(), start=1):
        lines += [f"{position}. {sentence(step)} {named(step)}", ""]
        lines += [f"$$\n{equation_latex(step.result)}\n$$", ""]
        lines += [f"*{_verdict(evidence)}:* {evidence.statement}", ""]
    return "\n".join(lines)


def mathml(derivation: Derivation) -> str:
    """Return an XHTML fragment with one ``math`` element per step."""
    rows = []
    for step, evidence in derivation.examined():
        rows.append(
            f"<li><p>{_escape(f'{sentence(step)} {named(step)}')}</p>{equation_mathml(step.result)}"
            f"<p>{_verdict(evidence)}: {_escape(evidence.statement)}</p></li>"
        )
    return f"<section><h2>{_escape(derivation.title)}</h2><ol>{''.join(rows)}</ol></section>"


def document(*derivations: Derivation) -> str:
    """Return a complete LaTeX document."""
    body = []
    for derivation in derivations:
        body.append(f"\\section*{{{tex_words(derivation.title)}}}\n\\begin{{enumerate}}")
        for step, evidence in derivation.examined():
            body.append(f"\\item {tex_words(f'{sentence(step)} {named(step)}')}")
            body.append(_display(step))
            body.append(f"\\emph{{{_verdict(evidence)}:}} {tex_words(evidence.statement)}.")
        body.append("\\end{enumerate}")
    return PREAMBLE + "\\begin{document}\n" + "\n".join(body) + "\n\\end{document}\n"


def shown(derivation: Derivation, form: str) -> str:
    """Return the derivation in one of the text formats."""
    if form == "latex":
        return document(derivation)
    writers = {"mathml": mathml, "markdown": markdown}
    return writers.get(form, text)(derivation)


def _display(step: Step) -> str:
    rows = [f"& \\fitted{{{row}}}" for part in parts_of(step.result) for row in _broken(part)]
    tag = f" \\tag{{{step.number}}}" if step.number is not None else ""
    return "\\begin{align*}\n" + " \\\\\n".join(rows) + tag + "\n\\end{align*}"


def _broken(part: sp.Basic) -> list[str]:
    """Return LaTeX in rows, each with a few terms of the longer side of an equation."""
    if not isinstance(part, sp.Equality) or part.has(sp.MatrixBase):
        return [_latex(part)]
    left, right = displayed(part, Script.LATEX).args
    if len(sp.Add.make_args(left)) > TERMS_A_LINE and right == 0:
        *rows, last = _rows_of_terms(left)
        return [*rows, f"{last} = 0"]
    first, *rows = _rows_of_terms(right)
    return [f"{sp.latex(left)} = {first}", *rows]


def _rows_of_terms(total: sp.Expr) -> list[str]:
    """Return a sum in rows of a few terms; a factor that is a long sum begins rows of its own."""
    rows: list[str] = []
    terms_in_row = 0
    for place, term in enumerate(sp.Add.make_args(total)):
        factor, inner = _factor_and_sum(term)
        new = [str(sp.latex(term))]
        if inner is not None:
            new = _rows_of_terms(inner)
            new[0], new[-1] = f"{sp.latex(factor)} \\Bigl( {new[0]}", f"{new[-1]} \\Bigr)"
        if place and not new[0].startswith("-"):
            new[0] = f"{{}} + {new[0]}"
        if 0 < terms_in_row < TERMS_A_LINE and len(new) == 1:
            rows[-1] += new[0]
            terms_in_row += 1
        else:
            rows += new
            terms_in_row = 1 if len(new) == 1 else 0
    return rows


def _factor_and_sum(term: sp.Expr) -> tuple[sp.Expr, sp.Expr | None]:
    """Split a product into its long sum and the remaining factor."""
    for part in sp.Mul.make_args(term):
        if part != term and len(sp.Add.make_args(part)) > TERMS_A_LINE:
            return term / part, part
    return term, None


def _latex(part: sp.Basic) -> str:
    return str(sp.latex(displayed(part, Script.LATEX)))


WIDTH = 100
"""Columns of a terminal that an equation may fill before it is broken."""


def _one_text(part: sp.Basic) -> str:
    shown = displayed(part, Script.UNICODE)
    whole = _pretty(shown)
    if _width(whole) <= WIDTH or not isinstance(shown, sp.Equality):
        return whole
    left, right = shown.args
    if right == 0:
        return "\n".join([*_rows(left, ""), "= 0"])
    return "\n".join([*_rows(left, ""), *_rows(right, "= ")])


def _rows(total: sp.Basic, prefix: str) -> list[str]:
    """Return a sum in rows that fit the width; the first row starts with ``prefix``."""
    rows: list[str] = []
    current: list[sp.Expr] = []
    for term in sp.Add.make_args(total):
        if current and _width(_pretty(sp.Add(*current, term, evaluate=False))) > WIDTH - 6:
            rows.append(_row(current, "+ " if rows else prefix))
            current = []
        current.append(term)
    rows.append(_row(current, "+ " if rows else prefix))
    return rows


def _row(terms: list[sp.Expr], prefix: str) -> str:
    block = _pretty(sp.Add(*terms, evaluate=False)) if len(terms) > 1 else _pretty(terms[0])
    lines = block.splitlines()
    middle = len(lines) // 2
    return "\n".join((prefix if at == middle else " " * len(prefix)) + line
                     for at, line in enumerate(lines))  # fmt: skip


def _pretty(expression: sp.Basic) -> str:
    return str(sp.pretty(expression, use_unicode=True, wrap_line=False))


def _width(block: str) -> int:
    return max(map(len, block.splitlines()), default=0)


def _verdict(evidence: Evidence) -> str:
    return "checked" if evidence.holds else "CHECK FAILED"


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
    **{sign: rf"\ensuremath{{{name}}}" for sign, name in {
        "⋅": r"\cdot", "→": r"\to", "∞": r"\infty", "′": r"{}^{\prime}", "ⅈ": "i",
        "≪": r"\ll", "∂": r"\partial", "≥": r"\ge", "≤": r"\le", "√": r"\surd",
        "∈": r"\in", "ℓ": r"\ell", "ϑ": r"\vartheta",
    }.items()},
}  # fmt: skip
_TEX_ACCENTS = {
    "\u0307": "dot", "\u0308": "ddot", "\u20db": "dddot", "\u0302": "hat", "\u0303": "tilde",
}  # fmt: skip
_PIECE = re.compile(
    r"(?P<base>.)(?P<accent>[\u0302\u0303\u0307\u0308\u20db])|(?P<low>[ᵢ-ᵥₐ-ₜ₀-₋]+)|(?P<high>[²³¹⁰-⁾]+)|.",
    re.DOTALL,
)


def tex_words(words: str) -> str:
    """Return running text for LaTeX; indices, accents and Greek letters become formulas."""
    return "".join(_tex_piece(found) for found in _PIECE.finditer(normalize("NFD", words)))


def _tex_piece(found: re.Match[str]) -> str:
    if found["accent"]:
        base = _tex_letter(found["base"]).removeprefix(r"\ensuremath{").removesuffix("}")
        return rf"\ensuremath{{\{_TEX_ACCENTS[found['accent']]}{{{base}}}}}"
    for group, mark in (("low", "_"), ("high", "^")):
        if found[group]:
            plain = normalize("NFKC", found[group]).replace("\u2212", "-")
            return rf"\ensuremath{{{mark}{{{plain}}}}}"
    return _tex_letter(found[0])


def _tex_letter(letter: str) -> str:
    name = unicode_name(letter, "")
    if name.startswith("GREEK") and " LETTER " in name:
        macro = name.rpartition(" ")[2]
        macro = macro.capitalize() if "CAPITAL" in name else macro.lower()
        return rf"\ensuremath{{\{macro.replace('amda', 'ambda')}}}"
    return _TEX.get(letter, letter)
