"""A chain of one's own at a time, against scipy: a disordered Duffing-Van der Pol cell.

The right side is generated from text and stepped by compressed rows, as for any other polynomial
cell and coupling; the reference has cell and matrix written a second time.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from theory.chains.oscillator import OscillatorChain
from verification.quantities.quantity import (
    Axis,
    Computation,
    NoReferenceError,
    ReferenceCheck,
    StatedValue,
    whole,
)
from verification.references.equations import pull_matrix
from verification.references.network import oscillator_rate, states_by_scipy

FloatArray = npt.NDArray[np.float64]

_END = 30.0
_REFERENCE = 1e-12


def own_chain(at: Mapping[str, float]) -> OscillatorChain:
    """Return the chain of a point: stiffness y + ky³, springs to second neighbours, disorder."""
    return OscillatorChain(
        damping="1 - a*y**2 + b*y**4",
        stiffness="y + k*y**3",
        values={"a": 4.0, "b": 0.5, "k": at["k"]},
        c=at["c"],
        eps=at["eps"],
        sites=whole(at["sites"]),
        coupling=f"next-nearest:1,{at['far']!r}",
        velocity_coupling=at["d"],
        disorder={"a": at["spread"]},
    )


def own_run(at: Mapping[str, float]) -> StatedValue:
    """State of a chain of one's own at t = 30 from one displaced site."""
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain = own_chain(at)
    start = excite(chain, [1], at["displacement"])
    level = 0.5 * at["displacement"]
    run = simulate(chain, start, _END, samples=2, level=level, tolerance=at["tolerance"])
    assert run.error is not None
    return StatedValue(value=run.states[-1], error=run.error, extra=start)


def own_by_scipy(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Return what scipy's DOP853 gives, at two tolerances."""
    chain, sites = own_chain(at), whole(at["sites"])
    a, k = np.asarray(chain.site_values["a"]), at["k"]
    matrix = pull_matrix(sites)
    for n in range(sites - 2):
        pair = np.ix_([n, n + 2], [n, n + 2])
        matrix[pair] += at["far"] * np.array([[1.0, -1.0], [-1.0, 1.0]])

    def force(y: FloatArray) -> FloatArray:
        return y + k * y**3

    def damping(y: FloatArray, v: FloatArray) -> FloatArray:
        h: FloatArray = 1.0 - a * y**2 + 0.5 * y**4
        return h

    rate = oscillator_rate(force, damping, matrix, c=chain.c, eps=chain.eps, d=at["d"])
    size = at["displacement"]

    def last(tolerance: float) -> FloatArray:
        # In units of the displacement, so that the absolute tolerance fits small motion.
        try:
            found = states_by_scipy(
                lambda t, x: rate(t, size * x) / size, stated.extra.ravel() / size,
                np.array([0.0, _END]), tolerance,
            )  # fmt: skip
        except ArithmeticError as error:
            raise NoReferenceError(str(error)) from None
        state: FloatArray = size * found[-1].reshape(2, sites)
        return state

    found = last(_REFERENCE)
    return ReferenceCheck(
        distance=float(np.abs(found - stated.value).max()),
        uncertainty=float(np.abs(found - last(30.0 * _REFERENCE)).max()) + 1e-14 * size,
        method="scipy's DOP853",
    )


RUN_OF_OWN_CHAIN = Computation(
    name="run-chain",
    title="state of a chain of one's own at t = 30 from one displaced site",
    axes=(
        Axis(name="k", low=1e-6, high=1.0),
        Axis(name="far", low=1e-3, high=1.0),
        Axis(name="d", low=1e-6, high=1.0),
        Axis(name="spread", low=1e-6, high=0.3),
        Axis(name="c", low=1e-8, high=10.0),
        Axis(name="eps", low=1e-6, high=1.0),
        Axis(name="sites", low=5, high=60, whole=True),
        Axis(name="displacement", low=1e-6, high=3.0),
        Axis(name="tolerance", low=1e-12, high=1e-4),
    ),
    compute=own_run,
    check=own_by_scipy,
    seconds=60.0,
    share=0.3,
    limits="one polynomial stands for all; stronger damping takes scipy minutes",
)
