"""Numbers of the toolkit inserted into printed equations: a second method for some of them.

Only the transcription of the printed equation is taken from the derivations; the numbers come from
code that shares nothing with them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from paper_checks.claim import Method
from paper_checks.claims._required import required

A, B, C, EPS = 2.5, 0.5, 0.1, 0.01


def residual(number: int) -> float | None:
    """Return the residual of a printed equation for the toolkit's numbers, if there are any."""
    if number not in _CHECKS:
        return None
    return _CHECKS[number][1]()


def method(number: int) -> tuple[Method, ...]:
    """Return the second method of an equation, if it has one."""
    if number not in _CHECKS:
        return ()
    return (Method("numbers of the toolkit put into the printed equation", _CHECKS[number][0]),)


def _off(number: int, values: Mapping[str, Any], part: int | None = None) -> float:
    """Evaluate both sides of a printed equation at numbers given by the names of symbols."""
    from derivations.judgement import printed

    equation: Any = printed(number).expression
    equation = equation if part is None else equation[part]
    known = {
        symbol: values[str(symbol)]
        for symbol in equation.atoms(sp.Symbol, AppliedUndef, sp.Derivative)
        if str(symbol) in values
    }
    return abs(complex(sp.N((equation.lhs - equation.rhs).subs(known))))


def _breather(number: int, part: int | None = None) -> float:
    from theory.averaged.breather import solve_breather
    from theory.chains.vdp import VdpChain

    found = solve_breather(VdpChain(a=A, b=B, c=C, eps=EPS))
    names = {
        "a": A, "b": B, "c": C, "epsilon": EPS, "n": 1, "omega": found.frequency,
        "alpha_0": required(found.alpha_0, "amplitude of the closed form"),
        "k_1": float(np.log(required(found.decay, "decay of the closed form"))),
    }  # fmt: skip
    return _off(number, names, part)


def _at_roots(number: int) -> float:
    from theory.piecewise.dispersion import dispersion_slope
    from theory.piecewise.roots import labelled_roots

    roots = labelled_roots(0.4, 0.6, np.arange(-3, 4), True).k
    slopes = dispersion_slope(roots, 0.4, 0.6)
    return max(
        _off(number, {"c": 0.6, "\\hat{v}": 0.4, "k": complex(k), "L(k)": 0.0,
                      "L_k": complex(slope)})
        for k, slope in zip(roots, slopes, strict=True)
    )  # fmt: skip


def _full() -> float:
    from theory.chains.vdp import VdpChain
    from verification.references.equations import full_rate

    y, w = np.array([0.3, 1.4, -0.7]), np.array([0.2, -0.9, 0.4])
    rate = full_rate(VdpChain(a=A, b=B, c=C, eps=EPS, sites=3))(0.0, np.concatenate([y, w]))
    names = {
        "a": A, "b": B, "c": C, "epsilon": EPS, "y(n, t)": y[1], "y(n - 1, t)": y[0],
        "y(n + 1, t)": y[2], "Derivative(y(n, t), t)": w[1],
        "Derivative(y(n, t), (t, 2))": rate[4],
    }  # fmt: skip
    return _off(8, names)


def _averaged() -> float:
    from theory.chains.vdp import VdpChain
    from verification.references.equations import averaged_rate

    phi = np.array([0.3 + 0.2j, 1.1 - 0.6j, -0.4 + 0.9j])
    rate = averaged_rate(VdpChain(a=A, b=B, c=C, eps=EPS, sites=3))(0.0, phi)
    names = {
        "a": A, "b": B, "c": C, "epsilon": EPS, "varphi(n, t)": complex(phi[1]),
        "varphi(n - 1, t)": complex(phi[0]), "varphi(n + 1, t)": complex(phi[2]),
        "Derivative(varphi(n, t), t)": complex(EPS * rate[1]),
    }  # fmt: skip
    return _off(43, names)


_CLOSED = "theory.averaged.breather:solve_breather"
_CHECKS: Mapping[int, tuple[str, Callable[[], float]]] = {
    8: ("verification.references.equations:full_rate", _full),
    29: (_CLOSED, lambda: _breather(29)),
    30: (_CLOSED, lambda: _breather(30)),
    37: (_CLOSED, lambda: _breather(37, 0)),
    43: ("verification.references.equations:averaged_rate", _averaged),
    50: ("theory.piecewise.roots:labelled_roots", lambda: _at_roots(50)),
    51: ("theory.piecewise.roots:labelled_roots", lambda: _at_roots(51)),
}
