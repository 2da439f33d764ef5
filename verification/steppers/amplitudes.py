"""Real amplitudes of (43) with a quarter-turn phase step, and small disturbances, compiled.

With φ_n = (-i)^n (r_n + i s_n) e^{icT}, r and s real, ρ = r/r_s and s small,

    ρ_n' = (c/2)(ρ_{n-1} - ρ_{n+1}) - ρ_n g(ρ_n),    g = ½(1 - r²/4 + η r⁴/8),   r = r_s ρ,

so that the amplitudes evolve independently; for their disturbances d(ρg)/dρ replaces g, and for s
it is g itself. In terms of ρ, g = ½(1 - ρ²)(1 - ρ²/r(η)²), with r(η) the ratio of the two cycles,
so that

    ∂ρ_n'/∂c = ½(ρ_{n-1} - ρ_{n+1}),    ∂ρ_n'/∂η = -(r'(η)/r(η)³) ρ_n³(1 - ρ_n²).

Equal steps of DOP853 are taken, with one row of sites for the amplitudes and one for each
disturbance. The step of ``runge_kutta``, which turns each row of the tableau into code of its own,
would take four times as long to compile for this right-hand side, and is no faster here.

References
----------
E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I (1993), II.5.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from scipy.integrate import DOP853

from theory.arrays import FloatArray
from theory.cells.vdp import threshold_ratio, threshold_ratio_slope
from verification.execution.compiled import outer

Parameter = Literal["c", "eta"]

_STAGES = DOP853.n_stages
_TABLEAU = np.vstack([DOP853.A[:_STAGES, :_STAGES], DOP853.B])


class Amplitudes(NamedTuple):
    """The chain at a = 1, b = η.

    Attributes
    ----------
    c, eta : float
        Coupling and η, dimensionless.
    square : float
        r_s².
    """

    c: float
    eta: float
    square: float


def rate(rho: FloatArray, chain: Amplitudes) -> FloatArray:
    """Return ρ', shape (N,), between the stable cycle on the left and rest on the right."""
    s = chain.square * rho * rho
    g = 0.5 * (1.0 - 0.25 * s + 0.125 * chain.eta * s * s)
    padded = np.concatenate([[1.0], rho, [0.0]])
    found: FloatArray = 0.5 * chain.c * (padded[:-2] - padded[2:]) - rho * g
    return found


def weights(chain: Amplitudes, along: Parameter) -> tuple[float, float]:
    """Return the weights of ½(ρ_{n-1} - ρ_{n+1}) and of ρ_n³(1 - ρ_n²) in ∂ρ_n'/∂c or ∂ρ_n'/∂η."""
    if along == "c":
        return 1.0, 0.0
    return 0.0, -threshold_ratio_slope(chain.eta) / threshold_ratio(chain.eta) ** 3


def rate_by(rho: FloatArray, chain: Amplitudes, along: Parameter) -> FloatArray:
    """Return the derivative of ρ' with respect to c or η, shape (N,)."""
    of_spring, of_damping = weights(chain, along)
    padded = np.concatenate([[1.0], rho, [0.0]])
    spring = 0.5 * (padded[:-2] - padded[2:])
    found: FloatArray = of_spring * spring + of_damping * rho**3 * (1.0 - rho * rho)
    return found


def advanced(rho: FloatArray, chain: Amplitudes, time: float) -> FloatArray:
    """Return the amplitudes after a time, shape (N,), by one step."""
    rows = rho[None, :].copy()
    _advance(rows, chain, False, weights(chain, "c"), time, 1)
    found: FloatArray = rows[0]
    return found


def with_disturbances(
    rho: FloatArray,
    chain: Amplitudes,
    time: float,
    steps: int,
    phases: bool = False,
    along: Parameter = "c",
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the amplitudes after a time, their derivative by c or η, and the disturbances.

    Parameters
    ----------
    rho : ndarray, shape (N,)
        Amplitudes divided by r_s.
    chain : Amplitudes
        Parameters.
    time : float
        Time in units of slow time.
    steps : int
        Number of equal steps.
    phases : bool, optional
        Compute disturbances s of the phases instead of those of the amplitudes.
    along : {"c", "eta"}, optional
        The parameter of the derivative.

    Returns
    -------
    tuple of ndarray, shapes (N,), (N,), (N, N)
        In a time t a disturbance reaches sites at distance d with (ct/2)^d/d! of its size.
        Disturbances of sites that are too far apart to overlap share one row.
    """
    sites = rho.size
    width = min(2 * _reach(0.5 * chain.c * time) + 1, sites)
    rows = np.zeros((2 + width, sites))
    rows[0] = rho
    column = np.arange(sites)
    rows[2 + column % width, column] = 1.0
    _advance(rows, chain, phases, weights(chain, along), time / steps, steps)
    first = np.clip(column - width // 2, 0, sites - width)
    nearby = first[:, None] + np.arange(width)
    matrix = np.zeros((sites, sites))
    matrix[column[:, None], nearby] = rows[2 + nearby % width, column[:, None]]
    return rows[0], rows[1], matrix


def _reach(half: float) -> int:
    """Return the d beyond which half^d/d! is below 1e-19."""
    far, term = 1, half
    while term > 1e-19 or far < half:
        far += 1
        term *= half / far
    return far


@outer(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _slopes(
    x: FloatArray,
    chain: Amplitudes,
    phases: bool,
    by: tuple[float, float],
    damping: FloatArray,
    out: FloatArray,
) -> None:
    """Put the derivatives into ``out``: amplitudes, their c- or η-derivative, disturbances."""
    rows, sites = x.shape
    half, last = 0.5 * chain.c, sites - 1
    for n in range(sites):
        s = chain.square * x[0, n] * x[0, n]
        damping[n] = 0.5 * (1.0 - 0.25 * s + 0.125 * chain.eta * s * s)
    for k in range(rows):
        if k == 1 and not phases:
            for n in range(sites):
                s = chain.square * x[0, n] * x[0, n]
                damping[n] = 0.5 - 0.375 * s + 0.3125 * chain.eta * s * s
        before = 1.0 if k == 0 else 0.0
        out[k, 0] = half * (before - x[k, 1]) - damping[0] * x[k, 0]
        for n in range(1, last):
            out[k, n] = half * (x[k, n - 1] - x[k, n + 1]) - damping[n] * x[k, n]
        out[k, last] = half * x[k, last - 1] - damping[last] * x[k, last]
    if rows > 1:
        for n in range(sites):
            left = x[0, n - 1] if n > 0 else 1.0
            right = x[0, n + 1] if n < last else 0.0
            square = x[0, n] * x[0, n]
            out[1, n] += by[0] * 0.5 * (left - right) + by[1] * x[0, n] * square * (1.0 - square)


@outer(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _advance(
    x: FloatArray,
    chain: Amplitudes,
    phases: bool,
    by: tuple[float, float],
    h: float,
    steps: int,
) -> None:
    """Advance all rows in place by equal steps."""
    K = np.zeros((_STAGES, *x.shape))
    stage, damping = np.zeros(x.shape), np.zeros(x.shape[1])
    y, work, slopes = x.reshape(x.size), stage.reshape(x.size), K.reshape(_STAGES, x.size)
    for _ in range(steps):
        for i in range(_STAGES + 1):
            for n in range(y.size):
                work[n] = y[n]
            for j in range(min(i, _STAGES)):
                weight = h * _TABLEAU[i, j]
                if weight != 0.0:
                    row = slopes[j]
                    for n in range(y.size):
                        work[n] += weight * row[n]
            if i < _STAGES:
                _slopes(stage, chain, phases, by, damping, K[i])
        for n in range(y.size):
            y[n] = work[n]


def steps_in(time: float, largest_rate: float, step: float) -> int:
    """Return the number of equal steps of length at most ``step`` over the largest rate."""
    return max(4, math.ceil(time * largest_rate / step - 1e-9))
