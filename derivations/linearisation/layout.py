r"""Write printed vectors and matrices with dots for a given number of sites.

A row of dots stands for rows that continue the printed ones: in a vector, entries of the same form
with all indices raised; in a band matrix, dots continue the diagonal on which they lie.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from derivations.algebra.equations import equation, parts_of
from derivations.algebra.errors import DerivationInputError
from derivations.linearisation.symbols import (
    J,
    N,
    X,
    X_rate,
    blocks,
    change,
    component,
    delta_rate,
    displacement_rates,
    displacements,
    jacobian_on_solution,
    perturbations,
    velocities,
    x,
)
from derivations.symbols import t, y
from derivations.transcription.latex_reader import BLANK, DOTS

_DOTS = frozenset(DOTS.values())


def named(expression: sp.Basic, sites: int) -> sp.Basic:
    """Insert the number of sites, and symbols for entries of the state."""
    return expression.subs(N, sites).replace(x, lambda place: component(int(place)))


def state(printed: sp.Tuple, sites: int) -> sp.Eq:
    """Write (39) in full: X by its two halves, and these by their entries."""
    given = {part.lhs: part.rhs for part in parts_of(printed)}
    if given[velocities] != displacement_rates:
        raise _unclear(39, "V is not the rate of Y")
    first, second, dots, last = given[displacements]
    if dots not in _DOTS or [first, second, last] != [y(1, t), y(2, t), y(N, t)]:
        raise _unclear(39, "Y is not y_1, y_2, dots, y_N")
    places = [y(site, t) for site in range(1, sites + 1)]
    halves = {displacements: places, velocities: [place.diff(t) for place in places]}
    return equation(X, sp.ImmutableMatrix([q for half in given[X] for q in halves[half]]))


def field(printed: sp.Tuple, sites: int) -> sp.Eq:
    """Write (40) in full: the printed rows, and between them rows of the same form.

    The row of site 2 is the pattern. The rows of sites 1 and N are not compared with it, since the
    pattern may end there.
    """
    rate, rows = printed.args[0].lhs, list(printed.args[-1].rhs)
    v_1, v_2, dots, first, second, more_dots, last = rows
    if rate != X_rate or {dots, more_dots} - _DOTS:
        raise _unclear(40, "its rows are not two halves with dots")
    velocity_rows = [named(_raised(v_2, shift), sites) for shift in range(sites - 1)]
    middle = [named(_raised(second, shift), sites) for shift in range(sites - 2)]
    rows_out = [named(v_1, sites), *velocity_rows, named(first, sites), *middle, named(last, sites)]
    return equation(X_rate, sp.ImmutableMatrix(rows_out))


def linearised(printed: sp.Tuple, printed_field: sp.Tuple, sites: int) -> sp.Eq:
    """Write the last equation of (41) in full, with J the Jacobian of the printed field (40)."""
    last = printed.args[-1]
    own = [component(place) for place in range(1, 2 * sites + 1)]
    jacobian = sp.Matrix(field(printed_field, sites).rhs).jacobian(own)
    if last.lhs != delta_rate or last.rhs != jacobian_on_solution * change:
        raise _unclear(41, "it is not the rate of delta as J times delta")
    vector = sp.Matrix(perturbations(sites))
    return equation(delta_rate, sp.ImmutableMatrix(jacobian * vector))


def jacobian(printed: sp.Tuple, sites: int) -> sp.Eq:
    """Write (42) in full: the blocks, with dots that continue their diagonals."""
    given = {part.lhs: part.rhs for part in parts_of(printed)}
    zero, one, a_block, b_block = blocks
    filled: dict[Any, Any] = {
        zero: sp.zeros(sites), one: sp.eye(sites),
        a_block: _band(given[a_block], sites), b_block: _diagonal(given[b_block], sites),
    }  # fmt: skip
    rows = [sp.Matrix.hstack(*(filled[q] for q in given[J].row(row))) for row in range(2)]
    return equation(J, sp.ImmutableMatrix(sp.Matrix.vstack(*rows)))


def _raised(entry: sp.Expr, shift: int) -> sp.Expr:
    """Raise every index by a number of sites."""
    return entry.replace(x, lambda place: x(place + shift))


def _band(printed: sp.Matrix, sites: int) -> sp.Matrix:
    """Write a band matrix of rows 1, 2, dots and N in full for N sites, N at least 4."""
    size = printed.rows
    if printed.shape != (4, 4) or sites != size:
        raise _unclear(42, f"a block of {printed.shape} for N = {sites}")
    out = sp.zeros(size)
    for row in range(size):
        for column in range(size):
            entry, back = printed[row, column], 0
            while entry in _DOTS and min(row, column) > back:
                back += 1
                entry = _raised(printed[row - back, column - back], back)
            out[row, column] = named(entry, sites)
    return out


def _diagonal(printed: sp.Matrix, sites: int) -> sp.Matrix:
    """Write a diagonal matrix in full, of which entries 1, 2, N and zeros or blanks are printed."""
    entries = [q for q in printed if q not in (0, BLANK) and q not in _DOTS]
    if len(entries) != 3 or named(_raised(entries[1], sites - 2), sites) != named(
        entries[2], sites
    ):
        raise _unclear(42, "a diagonal that is not one pattern")
    middle = [named(_raised(entries[1], shift), sites) for shift in range(sites - 2)]
    return sp.diag(named(entries[0], sites), *middle, named(entries[2], sites))


def _unclear(number: int, why: str) -> DerivationInputError:
    return DerivationInputError(
        f"transcription of ({number})", why, "laid out as in the paper", "correct the transcription"
    )
