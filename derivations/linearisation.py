"""Linearisation of the chain, Eqs. (39)-(42): the Jacobian for any N and both kinds of ends."""

from __future__ import annotations

import random
import sys
from typing import Any

import numpy as np
import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import equals, fast_average, has_order, solved_for, value
from derivations.algebra.harmonics import HarmonicRing, Harmonics
from derivations.derivation import Check, Derivation, Evidence, Step, equation
from derivations.symbols import a, b, c, epsilon

ENDS = ("ring", "free")
SITES = 4
"""Sites in the displayed matrices: the smallest ring whose corners stand apart from the band."""

mean_extra = sp.Symbol("M")
first_mode, motion = sp.symbols("D A")
field_name, state_name, jacobian_name = sp.symbols(r"\dot{X} X J")
row_name = sp.Symbol(r"\dot{\delta}_4")


def states(sites: int) -> tuple[sp.Symbol, ...]:
    """``x_1 … x_2N``: displacements, then velocities (Eq. 39)."""
    return tuple(sp.Symbol(f"x_{place}", real=True) for place in range(1, 2 * sites + 1))


def vector_field(sites: int, ends: str = "ring") -> sp.ImmutableMatrix:
    """Return the right side of Eq. (40).

    Parameters
    ----------
    sites : int
        N, from 3 (on a smaller ring a site would be its own neighbour twice).
    ends : {"ring", "free"}
        ``ring`` as printed: site 1 and site N are neighbours. ``free``: they have one neighbour.

    Returns
    -------
    ImmutableMatrix, shape (2 N, 1)

    Raises
    ------
    DerivationInputError
        If ``sites`` or ``ends`` is not allowed.
    """
    if sites < 3:
        raise DerivationInputError("number of sites N", sites, "at least 3", "use a longer chain")
    if ends not in ENDS:
        raise DerivationInputError("ends", ends, "'ring' or 'free'", "choose one of the two")
    x = states(sites)
    rows = list(x[sites:])
    for place in range(sites):
        springs = sum((x[place] - x[other] for other in neighbours(place, sites, ends)),
                      sp.Integer(0))  # fmt: skip
        damping = epsilon * x[sites + place] * (1 - a * x[place] ** 2 + b * x[place] ** 4)
        rows.append(-x[place] - epsilon * c * springs - damping)
    return sp.ImmutableMatrix(rows)


def neighbours(place: int, sites: int, ends: str) -> list[int]:
    """Return the sites, from 0, that a spring joins to ``place``."""
    if ends == "ring":
        return [(place + 1) % sites, (place - 1) % sites]
    return [other for other in (place + 1, place - 1) if 0 <= other < sites]


def jacobian(sites: int, ends: str = "ring") -> sp.ImmutableMatrix:
    """Differentiate `vector_field`, shape (2 N, 2 N); only entries that can differ from 0.

    Parameters and errors are those of `vector_field`.
    """
    x, field = states(sites), vector_field(sites, ends)
    rows = sp.zeros(2 * sites, 2 * sites)
    for place, entry in enumerate(field):
        for variable in entry.free_symbols & set(x):
            rows[place, x.index(variable)] = sp.diff(entry, variable)
    return sp.ImmutableMatrix(rows)


def numerical_field(x: Any, p: dict[str, Any], ends: str = "ring") -> Any:
    """Return the right side of (40) from an adjacency matrix; any number type that supports @."""
    size = len(x) // 2
    joined = np.diag(np.ones(size - 1), 1)
    if ends == "ring":
        joined[0, -1] = 1
    joined = joined + joined.T
    laplacian = np.diag(joined.sum(axis=0)) - joined
    y, v = x[:size], x[size:]
    drag = v * (1 + y**2 * (p["b"] * y**2 - p["a"]))
    return np.concatenate([v, -y - p["e"] * (p["c"] * (laplacian @ y) + drag)])


def numerical_jacobian(x: Any, p: dict[str, Any], ends: str = "ring") -> Any:
    """Complex-step derivative of `numerical_field`: exact to rounding."""
    size, step = len(x), 1e-30
    columns = [numerical_field(x + 1j * step * row, p, ends).imag / step for row in np.eye(size)]
    return np.array(columns).T


def matrix_check(ends: str, columns: int) -> Check:
    """Entry by entry against the numerical field (one column) or its derivative."""

    def check(candidate: sp.Basic) -> Evidence:
        name, matrix = candidate.args
        if name not in (field_name, jacobian_name):
            return Evidence(False, f"it gives {name}, not the field or its Jacobian")
        sites = matrix.shape[0] // 2
        rng = random.Random(7)
        p = {"e": 0.3, "a": 1.9, "b": 0.6, "c": 0.4}
        x = np.array([rng.uniform(-1.4, 1.4) for _ in range(2 * sites)])
        exact = numerical_field(x, p, ends)[:, None]
        if columns > 1:
            exact = numerical_jacobian(x, p, ends)
        if matrix.shape != exact.shape:
            return Evidence(False, f"its shape is {matrix.shape}, not {exact.shape}")
        point = {epsilon: p["e"], a: p["a"], b: p["b"], c: p["c"]}
        point |= dict(zip(states(sites), x, strict=True))
        wrong = [
            (row + 1, column + 1)
            for row in range(matrix.shape[0])
            for column in range(matrix.shape[1])
            if abs(value(matrix[row, column], point) - exact[row, column]) > 1e-12
        ]
        if wrong:
            return Evidence(False, f"{len(wrong)} entries differ, the first at {wrong[0]}")
        return Evidence(True, f"all {exact.size} entries agree with the {ends} chain, numerically")

    return check


def _state_check(candidate: sp.Basic) -> Evidence:
    """Check that the first half of X is displacements and the second their rates."""
    name, vector = candidate.args
    entries = [str(entry) for entry in vector]
    holds = name == state_name and entries == [str(entry) for entry in states(len(entries) // 2)]
    return Evidence(holds, "displacements x_1..x_N, then velocities x_{N+1}..x_{2N}")


def _taylor_error(candidate: sp.Basic, step: Any) -> Any:
    """How far a candidate ``delta' = J delta`` is from the exact change, against the size."""
    import mpmath as mp

    sites, p = 3, {"e": mp.mpf("0.3"), "a": mp.mpf("1.9"), "b": mp.mpf("0.6"), "c": mp.mpf("0.4")}
    x = np.array([mp.mpf(k) / 7 for k in (3, -5, 8, -2, 6, 4)])
    d = np.array([mp.mpf(k) / 5 for k in (2, 3, -4, 1, -3, 5)])
    change = numerical_field(x + step * d, p)[sites] - numerical_field(x, p)[sites]
    point: dict[sp.Basic, Any] = {epsilon: p["e"], a: p["a"], b: p["b"], c: p["c"]}
    point |= dict(zip(states(sites), x, strict=True))
    point |= dict(zip(perturbations(sites), step * d, strict=True))
    return solved_for(candidate, row_name, point, 40) - change


def perturbations(sites: int) -> tuple[sp.Symbol, ...]:
    """``delta_1 … delta_2N`` (Eq. 41)."""
    return tuple(sp.Symbol(rf"\delta_{place}", real=True) for place in range(1, 2 * sites + 1))


def _extra_term() -> sp.Eq:
    """Return the resonant part of ``-y' d``, which the '1' in print adds to the equation."""
    ring = HarmonicRing((first_mode, motion), ())
    y, d = (Harmonics(ring, {1: ring.ring.gens[k], -1: ring.ring.gens[2 + k]}) for k in (1, 0))
    return equation(mean_extra, ring.as_expr((y.fast_derivative() * d).coefficient(1)))


def _extra_point(rng: random.Random) -> tuple[Any, None]:
    size, other = (complex(rng.uniform(-1, 1), rng.uniform(-1, 1)) for _ in range(2))

    def product(s: Any) -> Any:
        return 2 * (1j * size * np.exp(1j * s)).real * 2 * (other * np.exp(1j * s)).real

    return {motion: size, first_mode: other, mean_extra: fast_average(product, 1)}, None


def derive(sites: int = SITES) -> Derivation:
    """Eqs. (39)-(42) for a chain of ``sites`` sites, as a ring and with free ends."""
    x = states(sites)
    three = jacobian(3)
    change = sum(three[3, k] * d for k, d in enumerate(perturbations(3)))
    free = [matrix_check("free", k) for k in (1, 2)]
    ring = [matrix_check("ring", k) for k in (1, 2)]
    steps = (
        Step("State: displacements, then velocities",
             equation(state_name, sp.ImmutableMatrix(x)), _state_check, 39),
        Step("The chain as a first-order system, closed to a ring",
             equation(field_name, vector_field(sites)), ring[0], 40),
        Step("The same with free ends: sites 1 and N have one neighbour",
             equation(field_name, vector_field(sites, "free")), free[0]),
        Step("Linearise about a solution: d(delta)/dt = J delta, here for site 1 of N = 3",
             equation(row_name, change),
             has_order(_taylor_error, 2, "what the exact change adds to J delta, against delta"),
             41),
        Step("J by differentiating (40)", equation(jacobian_name, jacobian(sites)), ring[1], 42),
        Step("J with free ends: no corners, and one spring at sites 1 and N",
             equation(jacobian_name, jacobian(sites, "free")), free[1]),
        Step("Mean at e^{it} of the product that print adds to (42) by its '1', for motions "
             "A e^{it} + c.c. and D e^{it} + c.c.: it vanishes, so print errs at O(eps^2) only",
             _extra_term(),
             equals(_extra_point, "the product averaged by direct sampling", floor=1.0)),
    )  # fmt: skip
    return Derivation("linearisation", "Linearisation and the Jacobian (39)-(42)", steps)


if __name__ == "__main__":
    from derivations.catalogue import main

    sys.exit(main("linearisation"))
