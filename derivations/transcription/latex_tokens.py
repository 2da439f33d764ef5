r"""Division of LaTeX mathematics into tokens, by which two formulas are compared.

Spacing (``\,``, ``\quad``), sizing (``\left``, ``\right``) and layout (``aligned``) have no meaning
and are dropped, so that two transcriptions of the same print have the same tokens.
"""

from __future__ import annotations

import difflib
import re
from itertools import pairwise

from derivations.algebra.errors import DerivationInputError

_TOKEN = re.compile(
    r"\\(?:begin|end)\{[a-z]+\}|\\text\{[^}]*\}|\\mathrm\{[^}]*\}|\\[A-Za-z]+|\\.|\d+\.\d+|\d|[^\s]",
    re.DOTALL,
)
_SPACING = frozenset(
    (r"\,", r"\;", r"\:", r"\!", r"\ ", r"\quad", r"\qquad", r"\left", r"\right", "~", "$")
)
_ALIAS = {r"\dfrac": r"\frac", r"\to": r"\rightarrow", r"\neq": r"\ne", r"\leq": r"\le",
          r"\geq": r"\ge", r"\mid": "|", r"\vert": "|", r"\text{sgn}": r"\sgn",
          r"\mathrm{sgn}": r"\sgn", r"\mathrm{Im}": r"\Im", r"\bigl": "", r"\bigr": ""}  # fmt: skip
NEW_LINE = r"\\"


def tokens_of(latex: str) -> tuple[str, ...]:
    r"""Return the tokens of a formula.

    Parameters
    ----------
    latex : str
        Mathematics without the dollar signs.

    Examples
    --------
    >>> tokens_of(r"\left( a + b \right)^2")
    ('(', 'a', '+', 'b', ')', '^', '2')
    """
    return tuple(_without_alignment(_meaningful(latex)))


def _meaningful(latex: str) -> list[str]:
    """Return all tokens except spacing.

    Each digit is a token: in LaTeX "x^12" raises one digit. The reader joins digits in line.
    """
    found = [_ALIAS.get(token, token) for token in _TOKEN.findall(latex)]
    return [q for q in found if q and q not in _SPACING]


def _without_alignment(tokens: list[str]) -> list[str]:
    """Drop ``aligned``: a row that starts with a sign continues, any other is a new statement."""
    kept: list[str] = []
    open_environments: list[str] = []
    for place, token in enumerate(tokens):
        if token.startswith(r"\begin"):
            open_environments.append(token[7:-1])
            if open_environments[-1] == "aligned":
                continue
        elif token.startswith(r"\end"):
            if not open_environments or open_environments.pop() != token[5:-1]:
                raise DerivationInputError(
                    "LaTeX", token, "the end of the environment that is open", "balance the two"
                )
            if token == r"\end{aligned}":
                continue
        elif open_environments and open_environments[-1] == "aligned":
            if token == "&":
                continue
            if token == NEW_LINE:
                following = next((q for q in tokens[place + 1 :] if q != "&"), "")
                if following in ("+", "-"):
                    continue
        kept.append(token)
    return kept


def changed_tokens(one: str, other: str) -> tuple[tuple[str, str], ...]:
    r"""Return the replacements that turn one formula into the other, token by token.

    Examples
    --------
    >>> changed_tokens(r"\frac{d}{2\sqrt{dm}}", r"\frac{d}{2\sqrt{km}}")
    (('d', 'k'),)
    """
    first, second = _meaningful(one), _meaningful(other)
    matcher = difflib.SequenceMatcher(None, first, second, autojunk=False)
    return tuple(
        ("".join(first[a:b]), "".join(second[c:d]))
        for kind, a, b, c, d in matcher.get_opcodes()
        if kind != "equal"
    )


def joined(tokens: tuple[str, ...] | list[str]) -> str:
    """Join tokens without spaces, except where LaTeX needs one after a command."""
    text = tokens[0] if tokens else ""
    for before, after in pairwise(tokens):
        gap = re.fullmatch(r"\\[A-Za-z]+", before) and after[0].isalpha()
        text += (" " if gap else "") + after
    return text
