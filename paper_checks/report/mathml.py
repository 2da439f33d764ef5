"""Turn the LaTeX in which the paper's equations are kept into MathML, which browsers typeset.

Only the commands that these equations use are known; another one raises `LatexError`.
"""

from __future__ import annotations

import re
from html import escape

GREEK = {
    "alpha": "α",
    "delta": "δ",
    "epsilon": "ε",
    "varepsilon": "ε",
    "zeta": "ζ",
    "eta": "η",
    "theta": "θ",
    "mu": "μ",
    "xi": "ξ",
    "pi": "π",
    "rho": "ρ",
    "tau": "τ",
    "varphi": "φ",
    "phi": "ϕ",
    "Psi": "Ψ",
    "psi": "ψ",
    "omega": "ω",
    "Omega": "Ω",
    "infty": "∞",
}
OPERATORS = {
    "approx": "≈",
    "cdot": "⋅",
    "equiv": "≡",
    "geq": "≥",
    "gtrless": "≷",
    "in": "∈",
    "ldots": "…",
    "leq": "≤",
    "ll": "≪",
    "neq": "≠",
    "pm": "±",
    "times": "×",
    "to": "→",
    "rightarrow": "→",
    "ddots": "⋱",
    "Leftrightarrow": "⇔",
    "vdots": "⋮",
    "{": "{",
    "}": "}",
}
ACCENTS = {"dot": "˙", "ddot": "¨", "tilde": "~", "hat": "^", "bar": "¯", "overline": "‾"}
SPACES = {" ": "0.4em", ",": "0.2em", ":": "0.25em", ";": "0.3em", "quad": "1em"}
FUNCTIONS = frozenset({"sin", "cos", "ln", "exp"})
TABLES = {
    "matrix": ("", ""),
    "pmatrix": ("(", ")"),
    "bmatrix": ("[", "]"),
    "aligned": ("", ""),
    "cases": ("{", ""),
}

_TOKEN = re.compile(
    r"(?P<words>\\(?:text|mathrm|operatorname)\s*\{[^{}]*\})|(?P<command>\\(?:[A-Za-z]+|.))"
    r"|(?P<number>\d+(?:\.\d+)?)|(?P<other>\S)",
    re.DOTALL,
)
_SIGNS = {"-": "−"}
LONG = 80
"""Characters of LaTeX beyond which a line of a phone, or of paper, may not hold the equation."""
WIDE = 60
"""Tokens between brackets beyond which a line may break there as well."""
_BREAKS = frozenset({"+", "-", "=", "\\approx", "\\to", "\\equiv", "\\Leftrightarrow"})
"""A line may break before one of these."""
_OPENS = frozenset({"", "(", "[", "=", ",", ";", "\\to", "\\approx"})
"""A minus after one of these is a sign and stands close to what follows."""


class LatexError(ValueError):
    """LaTeX outside the part that is known."""


def mathml(latex: str, *, block: bool = False) -> str:
    r"""Return one ``math`` element.

    Parameters
    ----------
    latex : str
        Without dollar signs.
    block : bool, optional
        On a line of its own.

    Raises
    ------
    LatexError
        If a command is not known, or braces or ends do not match.

    Examples
    --------
    >>> mathml(r"\frac12 k_1")
    '<math><mfrac><mn>1</mn><mn>2</mn></mfrac><msub><mi>k</mi><mn>1</mn></msub></math>'
    """
    reader = _Reader(latex)
    body = reader.row()
    if reader.left:
        raise LatexError(f"'{reader.left[0]}' closes nothing in {latex!r}.")
    display = ' display="block"' if block else ""
    return f"<math{display}>{body}</math>"


def with_formulas(text: str) -> str:
    """Return prose as HTML, its parts between dollar signs as MathML, all else escaped.

    What cannot be typeset is shown as it is written.

    Examples
    --------
    >>> with_formulas("for $x$ < 1")
    'for <math><mi>x</mi></math> &lt; 1'
    """
    parts = text.split("$")
    if len(parts) % 2 == 0:
        return escape(text)
    return "".join(
        formula(part) if odd else escape(part)
        for part, odd in zip(parts, [False, True] * len(parts), strict=False)
    )


def in_letters(text: str) -> str:
    r"""Return prose for a terminal: without dollar signs, Greek letters and signs as characters.

    Examples
    --------
    >>> in_letters(r"over $\eta \leq 1$")
    'over η ≤ 1'
    """
    known = {**GREEK, **OPERATORS}
    return re.sub(r"\\([A-Za-z]+)", lambda found: known.get(found[1], found[0]), text).replace(
        "$", ""
    )


def formula(latex: str, *, block: bool = False) -> str:
    """Return MathML, or the LaTeX itself where it is outside the part that is known.

    A long equation comes in parts between which a line may break.
    """
    try:
        if len(latex) > LONG:
            parts = _Reader(latex).parts()
            written = "<wbr>".join(f"<math>{part}</math>" for part in parts)
            return f'<span class="broken">{written}</span>'
        return mathml(latex, block=block)
    except LatexError:
        return f"<code>{escape(latex)}</code>"


class _Reader:
    """Reads tokens from the front of ``left``."""

    def __init__(self, latex: str) -> None:
        self.left = [found.group() for found in _TOKEN.finditer(latex)]

    def row(self, *ends: str) -> str:
        """Everything up to one of the ends, which stays, as MathML without an outer row."""
        nodes: list[str] = []
        before = ""
        while self.left and self.left[0] not in (*ends, "}"):
            token = self.left[0]
            if token == "-" and before in _OPENS:
                self.left.pop(0)
                nodes.append('<mo form="prefix">−</mo>')
            else:
                nodes.append(self._scripted())
            before = token
        if ends and not self.left:
            raise LatexError(f"'{ends[0]}' is missing.")
        return "".join(nodes)

    def parts(self) -> list[str]:
        """All of the equation, cut before signs that stand in no bracket, and after spaces."""
        parts = [""]
        before, depth, open_brackets = "", 0, 0
        while self.left:
            token = self.left[0]
            depth += (token in "([") - (token in ")]") if len(token) == 1 else 0
            sign = token in _BREAKS and before not in _OPENS
            if parts[-1] and not depth and (sign or before[1:] in SPACES):
                parts.append("")
            if sign and token in "+-=":
                self.left.pop(0)
                parts[-1] += f'<mo form="infix">{_SIGNS.get(token, token)}</mo>'
            elif token == "-" and before in _OPENS:
                self.left.pop(0)
                parts[-1] += '<mo form="prefix">−</mo>'
            elif token == "\\left" and self._long_bracket():
                self.left.pop(0)
                parts[-1] += self._tall("prefix")
                open_brackets += 1
                token = "("
            elif token == "\\right" and open_brackets:
                self.left.pop(0)
                parts[-1] += self._tall("postfix")
                open_brackets -= 1
            elif token == "}":
                raise LatexError("a brace closes nothing.")
            else:
                parts[-1] += self._scripted()
            before = token
        if open_brackets:
            raise LatexError("'\\right' is missing.")
        return parts

    def _long_bracket(self) -> bool:
        """Whether the bracket that opens here holds more than a line may have room for."""
        depth = 0
        for length, token in enumerate(self.left):
            depth += (token == "\\left") - (token == "\\right")
            if not depth:
                return length > WIDE
        return False

    def _tall(self, form: str) -> str:
        """Write a bracket as high as a fraction: its content is cut, so it cannot grow with it."""
        sign = escape(self._delimiter())
        return f'<mo form="{form}" stretchy="true" minsize="2.6em">{sign}</mo>' if sign else ""

    def _scripted(self) -> str:
        large = self.left[0] == "\\sum"
        base = self._atom()
        below = above = ""
        while self.left and self.left[0] in ("_", "^", "'"):
            sign = self.left.pop(0)
            if sign == "'":
                above += "<mo>′</mo>"
            elif sign == "_":
                below = self._argument()
            else:
                above += self._argument()
        if not (below or above):
            return base
        if above.count("<mo>′</mo>") and above != "<mo>′</mo>":
            above = f"<mrow>{above}</mrow>"
        kind = ("munderover", "munder", "mover") if large else ("msubsup", "msub", "msup")
        if below and above:
            return f"<{kind[0]}>{base}{below}{above}</{kind[0]}>"
        name = kind[1] if below else kind[2]
        return f"<{name}>{base}{below or above}</{name}>"

    def _argument(self) -> str:
        """One token, or a group in braces; of a number its first digit only, as in LaTeX."""
        if not self.left:
            raise LatexError("an argument is missing.")
        token = self.left[0]
        if token[0].isdigit() and len(token) > 1:
            self.left[0] = token[1:]
            return f"<mn>{token[0]}</mn>"
        return self._atom()

    def _atom(self) -> str:
        if not self.left:
            raise LatexError("a formula ends too early.")
        token = self.left.pop(0)
        if token == "{":
            body = self.row("}")
            self._expect("}")
            return f"<mrow>{body}</mrow>"
        if token[0] == "\\":
            return self._command(token[1:])
        if token[0].isdigit():
            return f"<mn>{token}</mn>"
        if token.isalpha():
            return f"<mi>{escape(token)}</mi>"
        if token in ("&", "_", "^", "}"):
            raise LatexError(f"'{token}' is out of place.")
        flat = ' stretchy="false"' if token in "()[]|" else ""
        flat += ' lspace="0" rspace="0"' if token == "|" else ""
        return f"<mo{flat}>{escape(_SIGNS.get(token, token))}</mo>"

    def _command(self, name: str) -> str:
        words = re.fullmatch(r"(text|mathrm|operatorname)\s*\{([^{}]*)\}", name)
        if words:
            tag = "mtext" if words.group(1) == "text" else "mi"
            return f"<{tag}>{escape(words.group(2)).replace(' ', '&#160;')}</{tag}>"
        if name in GREEK:
            return f"<mi>{GREEK[name]}</mi>"
        if name in FUNCTIONS:
            return f"<mi>{name}</mi><mo>&#8289;</mo>"
        if name == "sum":
            return "<mo>∑</mo>"
        if name in OPERATORS:
            return f"<mo>{OPERATORS[name]}</mo>"
        if name == "big":  # a taller delimiter follows, which the renderer stretches by itself
            return ""
        if name == "\\":  # between the displays of one number
            return '<mspace linebreak="newline"></mspace>'
        if name in SPACES:
            return f'<mspace width="{SPACES[name]}"></mspace>'
        if name in ACCENTS:
            return f'<mover accent="true">{self._argument()}<mo>{ACCENTS[name]}</mo></mover>'
        if name in ("frac", "dfrac"):
            return f"<mfrac>{self._argument()}{self._argument()}</mfrac>"
        if name == "sqrt":
            return f"<msqrt>{self._argument()}</msqrt>"
        if name == "left":
            return self._fenced()
        if name == "begin":
            return self._table()
        raise LatexError(f"the command '\\{name}' is not known.")

    def _fenced(self) -> str:
        opening = self._delimiter()
        body = self.row("\\right")
        self._expect("\\right")
        return _fence(opening, body, self._delimiter())

    def _delimiter(self) -> str:
        if not self.left:
            raise LatexError("a delimiter is missing.")
        token = self.left.pop(0).removeprefix("\\")
        return "" if token == "." else token

    def _table(self) -> str:
        kind = self._name()
        rows: list[str] = []
        cells: list[str] = []
        while True:
            cell = self.row("&", "\\\\", "\\end")
            cells.append(f"<mtd>{cell}</mtd>")
            end = self.left.pop(0)
            if end == "&":
                continue
            rows.append(f"<mtr>{''.join(cells)}</mtr>")
            cells = []
            if end == "\\end":
                break
            if end == "}":
                raise LatexError("a brace closes inside a table.")
        if self._name() != kind:
            raise LatexError(f"the end of '{kind}' is missing.")
        align = ' columnalign="left"' if kind in ("aligned", "cases") else ""
        return _fence(TABLES[kind][0], f"<mtable{align}>{''.join(rows)}</mtable>", TABLES[kind][1])

    def _name(self) -> str:
        self._expect("{")
        letters = []
        while self.left and self.left[0] != "}":
            letters.append(self.left.pop(0))
        self._expect("}")
        name = "".join(letters)
        if name not in TABLES:
            raise LatexError(f"the environment '{name}' is not known.")
        return name

    def _expect(self, token: str) -> None:
        if not self.left or self.left[0] != token:
            raise LatexError(f"'{token}' is missing.")
        self.left.pop(0)


def _fence(opening: str, body: str, closing: str) -> str:
    before = f"<mo>{escape(opening)}</mo>" if opening else ""
    after = f"<mo>{escape(closing)}</mo>" if closing else ""
    return f"<mrow>{before}<mrow>{body}</mrow>{after}</mrow>"
