"""Notation of the paper in (31)-(38) and (43)."""

from __future__ import annotations

import sympy as sp

from derivations.averaging.symbols import A_n, phi, psi
from derivations.symbols import a, alpha_0, b, c, epsilon, k_1, k_2, n, omega, t, y
from derivations.transcription.latex_reader import Notation

_SITES = {"n": n, "n+1": n + 1, "n-1": n - 1}


def notation(number: int) -> Notation:
    """Return the meaning of the names in an equation, which is the same in all of them.

    Parameters
    ----------
    number : int
        31 to 38, or 43.
    """
    names = {
        "a": a, "b": b, "c": c, "n": n, "t": t, r"\varepsilon": epsilon, r"\omega": omega,
        r"\alpha_{0}": alpha_0, "k_{1}": k_1, "k_{2}": k_2, r"\pi": sp.pi, "A_{n}": A_n,
        "y_{n}": y(n, t), r"\dot{y}_{n}": y(n, t).diff(t), r"\ddot{y}_{n}": y(n, t).diff(t, 2),
        r"\dot{\Psi}_{n}": psi(n, t).diff(t), r"\dot{\varphi}_{n}": phi(n, t).diff(t),
        **{rf"\Psi_{{{name}}}": psi(place, t) for name, place in _SITES.items()},
        **{rf"\varphi_{{{name}}}": phi(place, t) for name, place in _SITES.items()},
    }  # fmt: skip
    return Notation(names=names)
