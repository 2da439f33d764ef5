"""A chain of one's own at a time, against scipy: a disordered Duffing-Van der Pol cell.

The right side is generated from text and stepped by compressed rows, as for any other polynomial
cell and coupling; the reference has cell and matrix written a second time.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from theory.chains.oscillator import OscillatorChain
from verification.quantities.quantity import Computation, ReferenceCheck, StatedValue, axes, whole
from verification.quantities.scipy_states import compared, last_state
from verification.references.equations import pull_matrix
from verification.references.network import oscillator_rate

FloatArray = npt.NDArray[np.float64]

_END = 30.0


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
        # The absolute tolerance fits small motion.
        start, atol = stated.extra.ravel(), 1e-2 * tolerance * size
        return last_state(rate, _END, start, rtol=tolerance, atol=atol).reshape(2, sites)

    return compared(stated.value, last, "scipy's DOP853", 1e-14 * size)


RUN_OF_OWN_CHAIN = Computation(
    name="run-chain",
    title="state of a chain of one's own at t = 30 from one displaced site",
    axes=axes(
        k=(1e-6, 1.0), far=(1e-3, 1.0), d=(1e-6, 1.0), spread=(1e-6, 0.3), c=(1e-8, 10.0),
        eps=(1e-6, 1.0), sites=(5, 60), displacement=(1e-6, 3.0), tolerance=(1e-12, 1e-4),
    ),
    compute=own_run, check=own_by_scipy, seconds=60.0, share=0.3,
    limits="one polynomial stands for all; stronger damping takes scipy minutes",
)  # fmt: skip
