"""Notation of the paper in (8)-(30)."""

from __future__ import annotations

import sympy as sp

from derivations.multiple_scales.symbols import Y_0, Y_1, A, R_slow, Y, theta_slow
from derivations.symbols import (
    R,
    a,
    alpha_0,
    b,
    c,
    delta,
    epsilon,
    k_1,
    k_2,
    n,
    omega,
    omega_1,
    omega_2,
    t,
    t_hat,
    tau,
    theta,
    y,
)
from derivations.transcription.latex_reader import Notation

_LETTERS = {
    "a": a, "b": b, "c": c, "n": n, "t": t, "R": R, r"\varepsilon": epsilon, r"\omega": omega,
    r"\omega_{1}": omega_1, r"\omega_{2}": omega_2, r"\alpha_{0}": alpha_0, "k_{1}": k_1,
    "k_{2}": k_2, r"\theta": theta, r"\delta": delta, r"\hat{t}": t_hat, r"\tau": tau,
    r"\ldots": sp.S.Zero,
}  # fmt: skip
"""The dots in (12) and (17) stand for higher orders, which the expansions omit."""

_SITES = {"n": n, "n+1": n + 1, "n-1": n - 1, "0": 0, "1": 1}
_MOTION = {
    **{f"y_{{{name}}}": y(place, t) for name, place in _SITES.items()},
    **{f"\\dot{{y}}_{{{name}}}": y(place, t).diff(t) for name, place in _SITES.items()},
    **{f"\\ddot{{y}}_{{{name}}}": y(place, t).diff(t, 2) for name, place in _SITES.items()},
}
_SLOW = {"A'": A.diff(tau), "R'": R_slow.diff(tau), r"\theta'": theta_slow.diff(tau)}


def _derivatives(name: str, function: sp.Expr) -> dict[str, sp.Expr]:
    """Return the derivatives in the two times, as indices: ``y_{0,tt}`` or ``y_{tt}``."""
    scales = {r"\hat{t}": t_hat, r"\tau": tau}
    found = {}
    for first, one in scales.items():
        found[name.format(first)] = function.diff(one)
        for second, other in scales.items():
            found[name.format(first + second)] = function.diff(one, other)
    return found


_FORMS = {
    "in time": {},
    # y_0 and y_t in (15) and (16) are the same function of both times.
    "in two times": {"y_{0}": Y, **_derivatives("y_{{0,{}}}", Y), **_derivatives("y_{{{}}}", Y)},
}


def notation(number: int) -> Notation:
    """Return the meaning of the names in an equation.

    Parameters
    ----------
    number : int
        8 to 30. From (15) on ``y_0`` is a function of both times, and in (23) and (24) R and theta
        are functions of the slow one.
    """
    names = {**_LETTERS, **_MOTION, **_derivatives("y_{{{}}}", Y)}
    if number >= 15:
        names |= _FORMS["in two times"]
        for order, function in ((0, Y_0), (1, Y_1)):
            names[f"y_{{0}}^{{({order})}}"] = function
            names |= _derivatives(f"y_{{{{0,{{}}}}}}^{{{{({order})}}}}", function)
    names |= {"A": A, **_SLOW}
    if number in SLOW_POLAR:
        names |= {"R": R_slow, r"\theta": theta_slow}
    return Notation(names=names, functions={"A": lambda _: A})


SLOW_POLAR = (22, 23, 24)
"""Equations in which R and theta are functions of the slow time; from (25) on they are constant."""
