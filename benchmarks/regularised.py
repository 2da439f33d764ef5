"""The friction chain with regularised friction by scipy: the usual alternative.

F = -μ(v_rel) tanh(v_rel/δ) is smooth and stiff, stick becomes a slow creep, and the error is of
order δ however small the tolerance of the solver; with loose tolerances the results are wrong
without any warning.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.chains.friction import FrictionChain
from theory.parameters import positive, within
from verification.references.equations import Rate, dynamic_friction, load


class Solver(StrEnum):
    """A solver of ``scipy.integrate.solve_ivp``."""

    LSODA = "LSODA"
    RADAU = "Radau"
    BDF = "BDF"


def regularised_rate(chain: FrictionChain, delta: float) -> Rate:
    """Return d(y_1, ẏ_1, y_2, …)/dτ of (5) with friction -μ(|v|) tanh(v/δ), v = ẏ - v_d.

    Sites are interleaved, so that the Jacobian is banded.
    """
    cell = chain.cell

    def rate(_: float, z: FloatArray) -> FloatArray:
        velocity = z[1::2]
        slip = velocity - cell.v_d
        out = np.empty_like(z)
        out[0::2] = velocity
        out[1::2] = -dynamic_friction(np.abs(slip), cell) * np.tanh(slip / delta)
        out[1::2] -= load(z[0::2], velocity, chain)
        return out

    return rate


def run_regularised(
    chain: FrictionChain,
    start: FloatArray,
    t_end: float,
    *,
    solver: Solver = Solver.LSODA,
    delta: float = 1e-4,
    tolerance: float = 1e-6,
    samples: int = 201,
) -> FloatArray:
    """Return y of the regularised chain from τ = 0 to ``t_end``, shape (samples, N).

    Parameters
    ----------
    chain : FrictionChain
        Parameters of (5).
    start : ndarray, shape (2, N)
        y and ẏ.
    t_end : float
        τ, positive.
    solver : Solver
        It is given the bandwidth (LSODA) or the sparsity (Radau, BDF) of the Jacobian.
    delta : float
        Width δ of the regularisation, positive.
    tolerance : float
        Relative tolerance; the absolute one is a thousandth of it.
    samples : int
        Number of states sampled, evenly spaced.

    Raises
    ------
    ArithmeticError
        If the solver fails.

    Examples
    --------
    >>> chain = FrictionChain(c=0.02, sites=2)
    >>> run_regularised(chain, np.array([[2.0, 0.5], [0.0, 0.0]]), 1.0, delta=1e-2).shape
    (201, 2)
    """
    from scipy.integrate import solve_ivp

    positive("end time tau", t_end)
    positive("width delta", delta)
    within("tolerance", tolerance, 1e-13, 1e-1)
    sites = chain.sites
    options: dict[str, Any] = {}
    if Solver(solver) is Solver.LSODA:
        options = {"lband": 3, "uband": 2}
    else:
        options = {"jac_sparsity": _sparsity(sites)}
    times = np.linspace(0.0, t_end, samples)
    first = np.empty(2 * sites)
    first[0::2], first[1::2] = start
    result = solve_ivp(
        regularised_rate(chain, delta), (0.0, t_end), first, method=solver.value, t_eval=times,
        rtol=tolerance, atol=1e-3 * tolerance, **options,
    )  # fmt: skip
    if not result.success:
        raise ArithmeticError("the solver failed")
    return np.asarray(result.y[0::2].T)


def _sparsity(sites: int) -> Any:
    from scipy.sparse import lil_matrix

    pattern = lil_matrix((2 * sites, 2 * sites), dtype=int)
    for n in range(sites):
        pattern[2 * n, 2 * n + 1] = 1
        pattern[2 * n + 1, 2 * n + 1] = 1
        for neighbour in range(max(0, n - 1), min(sites, n + 2)):
            pattern[2 * n + 1, 2 * neighbour] = 1
    return pattern.tocsr()
