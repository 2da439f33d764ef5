"""Equations (39)-(42) as printed, written out for N = 4."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.lattice import LatticeEnds
from derivations.chain import PAPER
from derivations.linearisation import checks, layout
from derivations.linearisation.symbols import (
    SITES,
    J,
    X,
    X_rate,
    components,
    delta_rate,
    perturbations,
)
from derivations.printing import EquationReading, EquationVerdict, PrintedEquation
from derivations.symbols import a, b, c, epsilon, t, y

_x, _delta = components(SITES), perturbations(SITES)
_SITES = range(SITES)


def _neighbours(place: int) -> tuple[int, int]:
    return (place + 1) % SITES, (place - 1) % SITES


def _drag(place: int) -> sp.Expr:
    return 1 - a * _x[place] ** 2 + b * _x[place] ** 4


def _field() -> sp.Eq:
    rows = list(_x[SITES:])
    for place in _SITES:
        right, left = (_x[other] for other in _neighbours(place))
        springs = 2 * _x[place] - right - left
        rows.append(-_x[place] - epsilon * c * springs - epsilon * _x[SITES + place] * _drag(place))
    return equation(X_rate, sp.ImmutableMatrix(rows))


def _open_field() -> sp.Eq:
    """Return (40) without the spring between sites 1 and N, and otherwise unchanged."""
    rows = list(_field().rhs)
    pull = epsilon * c * (_x[0] - _x[SITES - 1])
    rows[SITES] += pull
    rows[-1] -= pull
    return equation(X_rate, sp.ImmutableMatrix(rows))


def _linearised() -> sp.Eq:
    rows = list(_delta[SITES:])
    for place in _SITES:
        own, rate = _x[place], _x[SITES + place]
        row = _delta[place] * (
            -1 - 2 * epsilon * c - epsilon * rate * (-2 * a * own + 4 * b * own**3)
        )
        row += sum(epsilon * c * _delta[other] for other in _neighbours(place))
        rows.append(row - epsilon * _drag(place) * _delta[SITES + place])
    return equation(delta_rate, sp.ImmutableMatrix(rows))


def _jacobian() -> sp.Eq:
    """Return (42), with a superfluous '1' in the bracket that multiplies x_{N+n}."""
    matrix = sp.zeros(2 * SITES, 2 * SITES)
    for place in _SITES:
        own, rate = _x[place], _x[SITES + place]
        matrix[place, SITES + place] = 1
        matrix[SITES + place, place] = (
            -1 - 2 * epsilon * c - epsilon * rate * (1 - 2 * a * own + 4 * b * own**3)
        )
        matrix[SITES + place, SITES + place] = -epsilon * _drag(place)
        for other in _neighbours(place):
            matrix[SITES + place, other] = epsilon * c
    return equation(J, sp.ImmutableMatrix(matrix))


_open_check = checks.field(PAPER, LatticeEnds.FREE)

EQUATIONS = (
    PrintedEquation(
        number=39,
        latex=r"X = \begin{pmatrix} Y \\ V \end{pmatrix}, \quad Y = \begin{pmatrix} y_1 \\ y_2 \\ "
              r"\vdots \\ y_N \end{pmatrix}, \quad V = \dot{Y}",
        expression=equation(X, sp.ImmutableMatrix(
            [*(y(site + 1, t) for site in _SITES), *(y(site + 1, t).diff(t) for site in _SITES)])),
        verdict=EquationVerdict.DEFINITION,
        note="Displacements first, then velocities; shown for N = 4.",
    ),
    PrintedEquation(
        number=40,
        latex=r"\dot{X} = f(X) = \begin{pmatrix} x_{N+1} \\ x_{N+2} \\ \vdots \\ -x_1 - "
              r"\varepsilon c(2x_1 - x_2 - x_N) - \varepsilon x_{N+1}(1 - ax_1^2 + bx_1^4) \\ "
              r"-x_2 - \varepsilon c(2x_2 - x_3 - x_1) - \varepsilon x_{N+2}(1 - ax_2^2 + bx_2^4) "
              r"\\ \vdots \\ -x_N - \varepsilon c(2x_N - x_1 - x_{N-1}) - "
              r"\varepsilon x_{2N}(1 - ax_N^2 + bx_N^4) \end{pmatrix}",
        expression=_field(),
        verdict=EquationVerdict.INCONSISTENT,
        note="The printed corners, as those of (42), close the chain into a ring; Figs. 12 and 15 "
             "state open ends, and (8) does not say.",
        affects="Fig. 9. For a breather far from the ends the difference is of the size of its "
                "tail.",
        readings=(
            EquationReading("the open ends of Figs. 12 and 15", _field(), False,
                            "the rows of sites 1 and N have one neighbour too many", _open_check),
            EquationReading(
                "for an open chain: rows -x_1 - ε c (x_1 - x_2) - ... and its mirror for N",
                _open_field(), True,
                "what Figs. 12 and 15 need; uniform states are as on the ring", _open_check),
        ),
        amendments=((r"2x_1 - x_2 - x_N", r"x_1 - x_2"),
                    (r"2x_N - x_1 - x_{N-1}", r"x_N - x_{N-1}")),
    ),
    PrintedEquation(
        number=41,
        latex=r"\dot{\hat{X}} + \dot{\delta} = J\big|_{X=\hat{X}} \delta + f(\hat{X}) + "
              r"O(\delta^2) \quad \rightarrow \quad \dot{\delta} = J\big|_{X=\hat{X}} \delta",
        expression=_linearised(),
        verdict=EquationVerdict.HOLDS,
        note="Linearisation, with J the derivative of f; shown for N = 4. The letter δ is that "
             "of (27).",
    ),
    PrintedEquation(
        number=42,
        latex=r"J = \begin{pmatrix} 0_{N \times N} & I_{N \times N} \\ A_{N \times N} & "
              r"B_{N \times N} \end{pmatrix} \\ A_{N \times N} = \begin{bmatrix} -1 - "
              r"2\varepsilon c - \varepsilon x_{N+1}(1 - 2ax_1 + 4bx_1^3) & \varepsilon c & 0 & "
              r"\varepsilon c \\ \varepsilon c & -1 - 2\varepsilon c - \varepsilon x_{N+2}"
              r"(1 - 2ax_2 + 4bx_2^3) & \ddots & 0 \\ 0 & \ddots & \ddots & \varepsilon c \\ "
              r"\varepsilon c & 0 & \varepsilon c & -1 - 2\varepsilon c - \varepsilon x_{2N}"
              r"(1 - 2ax_N + 4bx_N^3) \end{bmatrix} \\ B_{N \times N} = "
              r"\begin{bmatrix} -\varepsilon(1 - ax_1^2 + bx_1^4) & 0 & 0 \\ "
              r"0 & -\varepsilon(1 - ax_2^2 + bx_2^4) & \\ & & 0 \\ 0 & & "
              r"-\varepsilon(1 - ax_N^2 + bx_N^4) \end{bmatrix}",
        expression=_jacobian(),
        verdict=EquationVerdict.MISPRINT,
        note="The '1' in the bracket of A_nn must go: the derivative of 1 - a x^2 + b x^4 is "
             "-2 a x + 4 b x^3. All other entries agree, with the corners of the ring (40).",
        affects="Fig. 9 if the matrix was coded as printed. The extra term has no resonant mean, "
                "so it moves the multipliers at O(ε^2) only.",
        amendments=tuple((f"(1 - 2ax_{n}", f"(-2ax_{n}") for n in ("1", "2", "N")),
    ),
)  # fmt: skip


def written_out(number: int, reading: sp.Basic, field_reading: sp.Basic) -> sp.Eq:
    """Return one of these equations as read from its LaTeX, written in full for N = 4.

    Parameters
    ----------
    number : int
        39 to 42.
    reading, field_reading : Basic
        Results of the reader for this equation and for (40).
    """
    if number == 41:
        return layout.linearised(reading, field_reading, SITES)
    rules = {39: layout.state, 40: layout.field, 42: layout.jacobian}
    return rules[number](reading, SITES)
