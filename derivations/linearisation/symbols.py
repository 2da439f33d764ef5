"""Symbols of the linearisation, and their notation in the paper."""

from __future__ import annotations

from typing import Any

import sympy as sp

from derivations.symbols import a, b, c, epsilon, t, y
from derivations.transcription.latex_reader import Notation

SITES = 4
"""Sites in the displayed matrices: the smallest ring whose corners are separate from the band."""

N = sp.Symbol("N", integer=True, positive=True)
X, X_rate, J, delta_rate = sp.symbols(r"X \dot{X} J \dot{\delta}")
displacements, velocities, displacement_rates = sp.symbols(r"Y V \dot{Y}")
solution_rate, change, jacobian_on_solution = sp.symbols(r"\dot{\hat{X}} delta J|_{X=\hat{X}}")
blocks = sp.symbols("0_{NN} I_{NN} A_{NN} B_{NN}")
D, A = sp.symbols("D A")
resonant = sp.Symbol("M")
motion, deviation = sp.Function("y", real=True)(t), sp.Function("delta", real=True)(t)


def component(place: Any) -> sp.Symbol:
    """Return an entry of the state, ``x_1 ... x_2N``, or ``x_{N+1}`` with N as a letter."""
    return sp.Symbol(f"x_{{{place}}}" if not str(place).isdigit() else f"x_{place}", real=True)


def components(sites: int) -> tuple[sp.Symbol, ...]:
    """Return ``x_1 ... x_2N``: displacements, then velocities (Eq. 39)."""
    return tuple(map(component, range(1, 2 * sites + 1)))


def perturbations(sites: int) -> tuple[sp.Symbol, ...]:
    """Return ``delta_1 ... delta_2N`` (Eq. 41)."""
    return tuple(sp.Symbol(rf"\delta_{place}", real=True) for place in range(1, 2 * sites + 1))


PLACES = {"1": 1, "2": 2, "3": 3, "N": N, "N-1": N - 1, "N+1": N + 1, "N+2": N + 2, "2N": 2 * N}
"""Indices that occur in print."""
x = sp.Function("x", real=True)
"""An entry of the state with an index that contains N."""

_BLOCKS = dict(zip((r"0_{N\timesN}", r"I_{N\timesN}", r"A_{N\timesN}", r"B_{N\timesN}"), blocks,
                   strict=True))  # fmt: skip
NOTATION = Notation(
    names={
        "a": a, "b": b, "c": c, r"\varepsilon": epsilon, "X": X, r"\dot{X}": X_rate,
        "Y": displacements, "V": velocities, r"\dot{Y}": displacement_rates,
        **{f"y_{{{name}}}": y(place, t) for name, place in PLACES.items()},
        **{f"x_{{{name}}}": x(place) for name, place in PLACES.items()},
        r"\dot{\hat{X}}": solution_rate, r"\dot{\delta}": delta_rate, r"\delta": change,
        r"J\big|_{X=\hat{X}}": jacobian_on_solution, r"\hat{X}": sp.Symbol(r"\hat{X}"), "J": J,
        **_BLOCKS,
    },
    functions={"f": sp.Function("f"), "O": sp.Function("O")},
)  # fmt: skip
