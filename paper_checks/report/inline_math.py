"""Typeset the mathematics in prose: formulas between dollar signs, and what is written plainly.

Plainly written are subscripts and powers (``v_d``, ``e^{-2 i omega t}``, ``(φ*)^2``) and Greek
letters by their names. Names of files and options, and words, stay as they are.
"""

from __future__ import annotations

import re
from html import escape

from paper_checks.report.mathml import GREEK, LatexError, formula, mathml

_NAMES = "|".join(sorted({*GREEK, "eps"} - {"in"}, key=len, reverse=True))
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
    """Return prose as HTML, its mathematics as MathML, all else escaped.

    What cannot be typeset is shown as it is written.

    Examples
    --------
    >>> typeset("c < v_d")
    'c &lt; <math><msub><mi>v</mi><mi>d</mi></msub></math>'
    >>> typeset("tests/test_sums.py, --eta 0.1 and eta-pin")
    'tests/test_sums.py, --eta 0.1 and eta-pin'
    """
    parts = text.split("$")
    if len(parts) % 2 == 0:
        parts = [text]
    return "".join(formula(part) if place % 2 else _plain(part) for place, part in enumerate(parts))


def _plain(text: str) -> str:
    written, end = [], 0
    for found in _PLAIN.finditer(text):
        written += [escape(text[end : found.start()]), _formula(found.group())]
        end = found.end()
    return "".join([*written, escape(text[end:])])


def _formula(plain: str) -> str:
    try:
        return mathml(_latex(plain))
    except LatexError:
        return escape(plain)


def _latex(plain: str) -> str:
    r"""Write in LaTeX what is written plainly.

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
