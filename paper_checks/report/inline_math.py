"""Typeset the mathematics in prose: formulas between dollar signs, and plainly written symbols.

Plainly written are subscripts and powers (``v_d``, ``e^{-2 i omega t}``, ``(φ*)^2``) and the names
of Greek letters. Names of files and options, and words, are left unchanged.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape

from derivations.algebra.rendering import tex_words
from paper_checks.report.mathml import LatexError, breakable, formula

GREEK = (
    "alpha", "delta", "epsilon", "varepsilon", "zeta", "eta", "theta", "mu", "xi", "pi", "rho",
    "tau", "varphi", "phi", "Psi", "psi", "omega", "Omega", "infty",
)  # fmt: skip

_NAMES = "|".join((*GREEK, "eps"))
_GROUP = r"\{(?:[^{}]|\{[^{}]*\})*\}"
_BELOW = rf"_(?:{_GROUP}|[A-Za-z]+|\d+)"
_ABOVE = rf"\^(?:{_GROUP}|\([^()]*\)|[-−]?\d+(?:\.\d+)?|[A-Za-z*])"
_LETTER = rf"(?:{_NAMES}|[A-Za-zΑ-Ωα-ωϕ])"
_PLAIN = re.compile(
    rf"((?<![\w\\'-])(?<!\w\.){_LETTER}{_BELOW}(?:{_ABOVE})?(?![A-Za-z0-9_^])"  # v_d, x_1^2
    rf"|(?<![\w\\'.])(?:{_LETTER}|[A-Za-z]+|\d+|(?<=[)|])){_ABOVE}"  # x^2, rate^(2/3), )^2
    r"|(?<![\w\\'])[Α-Ωα-ωϕ]\*(?![\w*])"  # φ*
    rf"|(?<![\w\\'.-])(?:{_NAMES})(?![\w'.-]|\())"  # eta
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
    return _written(text, formula, _formula, escape)


def in_latex(text: str) -> str:
    r"""Return prose as LaTeX, with its mathematics as formulas and everything else escaped.

    Examples
    --------
    >>> print(in_latex(r"about 40% at $c = c_{\mathrm{pin}}$, η > 0 and v_d"))
    about 40\% at $c = c_{\mathrm{pin}}$, \ensuremath{\eta} \ensuremath{>} 0 and $v_d$
    """
    return _written(text, _tex, lambda plain: _tex(_latex(plain)), tex_words)


def _written(
    text: str,
    formula: Callable[[str], str],
    plain: Callable[[str], str],
    words: Callable[[str], str],
) -> str:
    """Write formulas between dollar signs, plainly written mathematics, and the words between."""
    parts = text.split("$")
    if len(parts) % 2 == 0:
        parts = [text]
    found = []
    for place, part in enumerate(parts):
        if place % 2:
            found.append(formula(part))
        else:
            pieces = enumerate(_PLAIN.split(part))
            found += [plain(piece) if odd % 2 else words(piece) for odd, piece in pieces]
    return "".join(found)


def _tex(latex: str) -> str:
    """Return a formula for LaTeX, with the letters that are not ASCII as macros."""
    macros = re.sub(r"[^\x00-\x7f]", lambda found: tex_words(found[0]), latex)
    return f"${macros}$"


def _formula(plain: str) -> str:
    try:
        return breakable(_latex(plain))
    except LatexError:
        return escape(plain)


def _latex(plain: str) -> str:
    r"""Convert plainly written mathematics to LaTeX.

    Examples
    --------
    >>> _latex("mu_st"), _latex("e^(k_1)"), _latex("A_nn"), _latex("mu*"), _latex("A^*")
    ('\\mu _{\\mathrm{st}}', 'e^{k_1}', 'A_{nn}', '\\mu ^*', 'A^*')
    >>> _latex("var^2"), _latex("ab^−2"), _latex("^2")
    ('\\text{var}^{2}', 'ab^{-2}', '{}^{2}')
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
