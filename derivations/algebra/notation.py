"""How symbols, fields and derivatives are written: LaTeX, and one line of Unicode.

``y(n + 1, t)`` is suitable for computation but hard to read. Before printing, fields at a site,
functions of slow times, their derivatives and conjugates are replaced by symbols with the paper's
names: y with index n+1, dots for the time, primes for the slow time.
"""

from __future__ import annotations

import re
from enum import Enum
from unicodedata import normalize

import sympy as sp
from sympy.core.function import AppliedUndef

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def raised(number: object) -> str:
    """Return a whole number as an exponent.

    Examples
    --------
    >>> raised(-12)
    '⁻¹²'
    """
    return str(number).translate(_RAISED)


class Script(Enum):
    """The LaTeX and the Unicode form of a name."""

    LATEX = "latex"
    UNICODE = "unicode"


NAMES: dict[str, tuple[str, str]] = {
    "Y": ("y_{0}", "y₀"),
    "Y_0": ("y_{0}^{(0)}", "y₀⁽⁰⁾"),
    "Y_1": ("y_{0}^{(1)}", "y₀⁽¹⁾"),
    "Psi": (r"\Psi", "Ψ"),
    "varphi": (r"\varphi", "φ"),
    "y_next": ("y_{n}^{(1)}", "yₙ⁽¹⁾"),
    "turn": ("E", "E"),
    "ratio": (r"\left|\varphi_{us}\right|/\left|\varphi_{s}\right|", "│φᵤₛ│/│φₛ│"),
    "psi": (r"\psi", "ψ"),
    "A_abs": (r"\left|A\right|", "│A│"),
    "varphi_s": (r"\varphi_{s}", "φₛ"),
    "varphi_us": (r"\varphi_{us}", "φᵤₛ"),
    "vartheta": (r"\vartheta", "ϑ"),
    "ell": (r"\ell", "ℓ"),
}
"""Names that are not written as in SymPy."""

PRIMED = ("tau", "T")
"""Slow times, whose derivatives are written as primes."""

_LIMIT = "_infinity"
_LOW = str.maketrans("0123456789+-nmjpkzt", "₀₁₂₃₄₅₆₇₈₉₊₋ₙₘⱼₚₖzₜ")
_ACCENTS = {"tilde": "\u0303", "hat": "\u0302", "dot": "\u0307"}
_ACCENTED = re.compile(r"\\(tilde|hat|dot)\{")
_DOTS = {1: "\u0307", 2: "\u0308", 3: "\u20db"}


def displayed(expression: sp.Basic, script: Script) -> sp.Basic:
    r"""Return the expression with readable symbols for fields and derivatives.

    Examples
    --------
    >>> t, n = sp.Symbol("t"), sp.Symbol("n", integer=True)
    >>> y = sp.Function("y", real=True)
    >>> displayed(y(n + 1, t).diff(t, 2), Script.LATEX)
    \ddot{y}_{n+1}
    """
    if isinstance(expression, sp.core.relational.Relational):
        # Rebuilt unevaluated: on evaluation, an equation of a symbol with a matrix becomes false.
        sides = [displayed(side, script) for side in expression.args]
        return expression.func(*sides, evaluate=False)
    found: dict[sp.Basic, sp.Basic] = {}
    for atom in expression.atoms(sp.Derivative, AppliedUndef, sp.conjugate):
        name = _name(atom, script)
        if name is not None:
            found[atom] = sp.Symbol(name)
    for symbol in expression.atoms(sp.Symbol):
        accented = "\\" in symbol.name and script is Script.UNICODE
        if symbol.name in NAMES or accented or symbol.name.endswith(_LIMIT):
            found[symbol] = sp.Symbol(_base(symbol.name, script))
    if script is Script.UNICODE:
        for atom in expression.atoms(AppliedUndef) - found.keys():
            if "\\" in atom.func.__name__ or atom.func.__name__ in NAMES:
                found[atom] = sp.Function(_base(atom.func.__name__, script))(*atom.args)
    shown = expression.xreplace(found)
    return shown if script is Script.LATEX else shown.replace(sp.besseli, _bessel)


def _bessel(order: sp.Expr, argument: sp.Expr) -> sp.Expr:
    return sp.Function(_base(f"I_{order}", Script.UNICODE))(argument)


def _name(atom: sp.Basic, script: Script) -> str | None:
    if isinstance(atom, sp.conjugate):
        inner = atom.args[0]
        if isinstance(inner, sp.Symbol):
            name = _base(inner.name, script)
        else:
            found = _name(inner, script) if isinstance(inner, AppliedUndef) else None
            if found is None:
                return None
            name = found
        return name + ("^{*}" if script is Script.LATEX else "*")
    if isinstance(atom, sp.Derivative):
        return _derivative(atom, script)
    if not isinstance(atom, AppliedUndef):
        return None
    return _function(atom, script, "")


def _base(name: str, script: Script) -> str:
    if name in NAMES:
        return NAMES[name][script is Script.UNICODE]
    if name.endswith(_LIMIT):
        index = r"_{\infty}" if script is Script.LATEX else "_∞"
        return _base(name.removesuffix(_LIMIT), script) + index
    if script is Script.LATEX:
        return str(sp.latex(sp.Symbol(name)))
    plain = name.replace("\\", "").translate({ord("{"): None, ord("}"): None})
    if accent := _ACCENTED.match(name):
        plain = _base(plain.removeprefix(accent[1]), script)
        return normalize("NFC", plain[0] + _ACCENTS[accent[1]] + plain[1:])
    letter, _, index = plain.partition("_")
    if index and letter in NAMES:
        return NAMES[letter][1] + _base(f"x_{index}", script)[1:]
    # Not `pretty_symbol`, which writes Unicode only if the terminal importing SymPy supported it.
    return str(sp.pretty(sp.Symbol(plain), use_unicode=True))


def _function(field: AppliedUndef, script: Script, mark: str) -> str | None:
    """Return the name of a field at a site or of a function of slow times; None for others."""
    base = _base(field.func.__name__, script)
    if mark:
        base = _marked(base, mark, script)
    first = field.args[0]
    if first.is_integer and not first.has(sp.Function):
        index = str(sp.sstr(first)).replace(" ", "")
        if script is Script.LATEX:
            return f"{base}_{{{index}}}"
        low = index.translate(_LOW)
        return base + (low if set(index) <= set("0123456789+-nmjpkt") else f"[{index}]")
    if all(
        argument.is_Symbol and argument.name in (*PRIMED, "that", "t") for argument in field.args
    ):
        return base
    return None


def _derivative(derivative: sp.Derivative, script: Script) -> str | None:
    inner = derivative.expr
    if not isinstance(inner, AppliedUndef):
        return None
    counts = {variable: int(times) for variable, times in derivative.variable_count}
    if set(map(str, counts)) == {"t"} and sum(counts.values()) <= 3:
        return _function(inner, script, "." * sum(counts.values()))
    name = _function(inner, script, "")
    if name is None:
        return None
    names = [variable.name for variable in counts]
    if (
        len(inner.args) <= 2
        and len(names) == 1
        and names[0] in PRIMED
        and "that" not in map(str, inner.args)
    ):
        return _function(inner, script, "'" * counts[next(iter(counts))])
    times = [_base(variable.name, script) for variable, count in counts.items()
             for _ in range(count)]  # fmt: skip
    if script is Script.LATEX:
        return f"{{{name}}}_{{,{''.join(_spaced(q) for q in times)}}}"
    return f"∂{{{','.join(times)}}}{name}"


def _spaced(name: str) -> str:
    return name + " " if name.startswith("\\") else name


def _marked(base: str, mark: str, script: Script) -> str:
    if mark.startswith("'"):
        return base + ("'" if script is Script.LATEX else "′") * len(mark)
    dots = len(mark)
    if script is Script.LATEX:
        return f"\\{'d' * dots}ot{{{base}}}"
    return base[0] + _DOTS[dots] + base[1:]
