"""Typeset the mathematics in prose: formulas between dollar signs, and plainly written symbols.

Plainly written are subscripts and powers (``v_d``, ``e^{-2 i omega t}``, ``(φ*)^2``) and the names
of Greek letters. Names of files and options, and words, are left unchanged.
"""

from __future__ import annotations

import re
from html import escape

from derivations.algebra.rendering import tex_words
from paper_checks.report.mathml import LatexError, breakable, formula

GREEK = (
    "alpha", "delta", "epsilon", "varepsilon", "zeta", "eta", "theta", "mu", "xi", "pi", "rho",
    "tau", "varphi", "phi", "Psi", "psi", "omega", "Omega", "infty",
)  # fmt: skip

_NAMES = "|".join(sorted({*GREEK, "eps"}, key=len, reverse=True))
_GROUP = r"\{(?:[^{}]|\{[^{}]*\})*\}"
_BELOW = rf"_(?:{_GROUP}|[A-Za-z]+|\d+)"
_ABOVE = rf"\^(?:{_GROUP}|\([^()]*\)|[-−]?\d+(?:\.\d+)?|[A-Za-z*])"
_LETTER = rf"(?:{_NAMES}|[A-Za-zΑ-Ωα-ωϕ])"
_PLAIN = re.compile(
    rf"(?<![\w\\'-])(?<!\w\.){_LETTER}{_BELOW}(?:{_ABOVE})?(?![A-Za-z0-9_^])"  # v_d, x_1^2
    rf"|(?<![\w\\'.])(?:{_LETTER}|[A-Za-z]+|\d+|(?<=[)|])){_ABOVE}"  # x^2, rate^(2/3), )^2
    r"|(?<![\w\\'])[Α-Ωα-ωϕ]\*(?![\w*])"  # φ*
    rf"|(?<![\w\\'.-])(?:{_NAMES})(?![\w'.-]|\()"  # eta
)
_WORD = re.compile(r"(?<![A-Za-z\\])[A-Za-z]+")
_INDEX = re.compile(r"_([A-Za-z]{2,})")


def typeset(text: str) -> str:
    """Return prose as HTML, with its mathematics as MathML and everything else escaped.

    Mathematics that cannot be typeset is shown as it is written.

    Examples
    --------
    >>> typeset("c < v_d")
    'c &lt; <math><mrow><msub><mi>v</mi><mi>d</mi></msub></mrow></math>'
    >>> typeset("tests/test_sums.py, --eta 0.1 and eta-pin")
    'tests/test_sums.py, --eta 0.1 and eta-pin'
    """
    parts = text.split("$")
    if len(parts) % 2 == 0:
        parts = [text]
    return "".join(formula(part) if place % 2 else _plain(part) for place, part in enumerate(parts))


def in_latex(text: str) -> str:
    r"""Return prose as LaTeX, with its mathematics as formulas and everything else escaped.

    Examples
    --------
    >>> print(in_latex("about 40% at $c = 2$, η > 0 and v_d"))
    about 40\% at $c = 2$, \ensuremath{\eta} \ensuremath{>} 0 and $v_d$
    """
    parts = text.split("$")
    if len(parts) % 2 == 0:
        parts = [text]
    return "".join(
        f"${_in_macros(part)}$" if place % 2 else _plain_latex(part)
        for place, part in enumerate(parts)
    )


def _plain_latex(text: str) -> str:
    written, end = [], 0
    for found in _PLAIN.finditer(text):
        formula_of = f"${_in_macros(_latex(found.group()))}$"
        written += [tex_words(text[end : found.start()]), formula_of]
        end = found.end()
    return "".join([*written, tex_words(text[end:])])


def _in_macros(latex: str) -> str:
    """Return a formula with the letters that are not ASCII as macros."""
    return re.sub(r"[^\x00-\x7f]", lambda found: tex_words(found[0]), latex)


def _plain(text: str) -> str:
    written, end = [], 0
    for found in _PLAIN.finditer(text):
        written += [escape(text[end : found.start()]), _formula(found.group())]
        end = found.end()
    return "".join([*written, escape(text[end:])])


def _formula(plain: str) -> str:
    try:
        return breakable(_latex(plain))
    except LatexError:
        return escape(plain)


def _latex(plain: str) -> str:
    r"""Convert plainly written mathematics to LaTeX.

    Examples
    --------
    >>> _latex("mu_st"), _latex("e^(k_1)"), _latex("A_nn")
    ('\\mu _{\\mathrm{st}}', 'e^{k_1}', 'A_{nn}')
    """

    def index(letters: str) -> str:
        same = len(set(letters)) == 1
        return f"_{{{letters}}}" if same else rf"_{{\mathrm{{{letters}}}}}"

    def word(found: re.Match[str]) -> str:
        name = found[0]
        if name in GREEK:
            return rf"\{name} "
        if name == "eps":
            return r"\varepsilon "
        return rf"\text{{{name}}}" if len(name) > 2 else name

    text = re.sub(r"\^\(([^()]*)\)", r"^{\1}", plain).replace("−", "-")
    text = re.sub(r"\^(-?\d+(?:\.\d+)?)", r"^{\1}", text)
    text = text if not text.startswith("^") else "{}" + text
    if text.endswith("*") and "^" not in text:
        text = text[:-1] + "^*"
    return "".join(
        index(piece) if place % 2 else _WORD.sub(word, piece)
        for place, piece in enumerate(_INDEX.split(text))
    )
