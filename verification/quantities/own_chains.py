"""A user-defined chain compared with scipy: disordered, driven Duffing-Van der Pol cells.

The right-hand side is generated from text and integrated with compressed rows, as for any other
polynomial cell and coupling. The reference contains cell and matrix written a second time.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy import sparse

from theory.arrays import FloatArray
from theory.chains.oscillator import OscillatorChain
from verification.quantities.quantity import (
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
    whole,
)
from verification.quantities.scipy_states import precisely
from verification.references.equations import Rate, pull_matrix
from verification.references.extrapolation import precise_state
from verification.references.network import oscillator_rate
from verification.runs.excite import excite
from verification.runs.simulate import simulate

_END = 30.0
_FREQUENCY = 1.1
"""Frequency of the force, near that of the cells."""

OURS = "Runge-Kutta 8 (default)"


def chain_of(at: Mapping[str, float]) -> OscillatorChain:
    """Return the chain of a point: stiffness y + ky³, springs to second neighbours, disorder.

    A harmonic force acts on the second site. With more than one row it is a square lattice.
    """
    sites, rows = whole(at["sites"]), whole(at.get("rows", 1))
    size: Any = sites if rows == 1 else (rows, sites // rows)
    return OscillatorChain(
        damping="1 - a*y**2 + b*y**4",
        stiffness="y + k*y**3" if at["k"] else "y",
        values={"a": 4.0, "b": 0.5, **({"k": at["k"]} if at["k"] else {})},
        c=at["c"],
        eps=at["eps"],
        sites=size,
        coupling=f"next-nearest:1,{at['far']!r}" if rows == 1 else "square",
        velocity_coupling=at["d"],
        disorder={"a": at["spread"]} if at["spread"] else {},
        drive=f"{at['force']!r},{_FREQUENCY}@2" if at.get("force") else (),
    )


def rate_of(at: Mapping[str, float]) -> Rate:
    """Return its right-hand side for scipy, and for a chain also in extended precision."""
    sites, rows, k = whole(at["sites"]), whole(at.get("rows", 1)), at["k"]
    a = np.asarray(chain_of(at).site_values["a"])
    matrix: Any = pull_matrix(sites // rows)
    matrix = matrix.astype(np.longdouble) if rows == 1 else matrix  # else 2 + 2 far is rounded
    for n in range(sites - 2 if rows == 1 else 0):
        pair = np.ix_([n, n + 2], [n, n + 2])
        matrix[pair] += at["far"] * np.array([[1.0, -1.0], [-1.0, 1.0]])
    matrix = sparse.kronsum(matrix, pull_matrix(rows), format="csr")

    def force(y: FloatArray) -> FloatArray:
        return y + k * y**3

    def damping(y: FloatArray, v: FloatArray) -> FloatArray:
        return 1.0 - a * y**2 + 0.5 * y**4

    driven = np.eye(sites)[1] * at.get("force", 0.0)
    return oscillator_rate(
        force, damping, matrix, c=at["c"], eps=at["eps"], d=at["d"],
        force=lambda t: driven * np.cos(_FREQUENCY * t),
    )  # fmt: skip


def own_run(at: Mapping[str, float]) -> StatedValue:
    """State of a user-defined chain at t = 30 from one displaced site."""
    chain = chain_of(at)
    start = excite(chain, [1], at["displacement"])
    level = 0.5 * at["displacement"]
    run = simulate(chain, start, _END, samples=2, level=level, tolerance=at["tolerance"])
    assert run.error is not None
    return StatedValue(value=run.states[-1], error=run.error, extra=start)


def own_precisely(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Integrate the equation, written a second time, in extended precision."""
    return precisely(stated.value.ravel(), precise_state(rate_of(at), stated.extra.ravel(), _END))


_RUN = Computation(
    name="run-chain",
    title="state of a user-defined chain at t = 30 from one displaced site",
    axes=axes(
        k=(1e-6, 1.0), far=(1e-3, 1.0), d=(1e-6, 1.0), spread=(1e-6, 0.3), c=(1e-8, 10.0),
        eps=(1e-6, 1.0), force=(1e-6, 1.0), sites=(5, 60), displacement=(1e-6, 3.0),
        tolerance=(1e-12, 1e-4),
    ),
    compute=own_run, check=own_precisely, seconds=60.0, share=0.3,
    limits="one polynomial represents all; with stronger damping scipy takes minutes",
)  # fmt: skip

QUANTITIES = (
    Quantity(
        name="own-chain", title="trajectory of a user-defined chain", equation="(8)",
        problems="own-chain", reference="scipy's DOP853 at 1e-13, the equation written again",
        accuracy=1e-8, default=OURS, useful=(1e-10, 1e-3), computations=(_RUN,),
    ),
)  # fmt: skip
