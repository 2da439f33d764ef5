"""The chain (8) with its variational equations over a given time, by Taylor series.

The right-hand side is a polynomial, so the Taylor coefficients follow from products of series
(index k, ⋆ the Cauchy product; S = Y⋆Y, Q = S⋆S, G = 1 - aS + bQ, W = V⋆G):

    (k+1) Y_{k+1} = V_k,      (k+1) V_{k+1} = -Y_k - εc(LY)_k - εW_k                          (8)

and for a tangent (δy, δv), with H = -2aY + 4b S⋆Y and P = V⋆H computed once per step,

    (k+1) δv_{k+1} = -δy_k - εc(Lδy)_k - ε(G⋆δv + P⋆δy)_k.                                   (42)

Order and step are fixed; the error is measured by repetition with a shorter step. The column for c
has the additional forcing -ε(LY)_k. The base solution can be replaced by arbitrary sinusoids A_n
sin(ωt + θ_n), as in the paper; and the Jacobian can be the misprinted one of (42), which adds
-εV⋆δy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from theory.arrays import FloatArray
from theory.chains.ends import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.execution.compiled import inner, outer
from verification.steppers.rows import put

ORDER = 20
"""Order of the Taylor series."""
STEPS = 24
"""Steps per period; also the number of samples of a flow."""
LARGEST = 1e6
"""Displacement beyond which a run is rejected."""


@dataclass(frozen=True)
class Flow:
    """The state after a time, and its derivatives.

    Attributes
    ----------
    state : float array, shape (2N,)
        Displacements, then velocities (Eq. 39).
    monodromy : float array, shape (2N, 2N)
        Derivative of ``state`` with respect to the initial state.
    by_c : float array, shape (2N,)
        Derivative of ``state`` with respect to c.
    samples : float array, shape (steps, N)
        Displacements at the beginning of each step.
    steps : int
        Number of steps.
    """

    state: FloatArray
    monodromy: FloatArray
    by_c: FloatArray
    samples: FloatArray
    steps: int


def integrate_variations(chain: VdpChain, start: FloatArray, duration: float, steps: int) -> Flow:
    """Integrate (8) and its variational equations along the solution.

    Parameters
    ----------
    chain : VdpChain
        A chain of any N, with either kind of ends.
    start : float array, shape (2N,)
        Initial displacements and velocities.
    duration : float
        Time, dimensionless; positive or negative.
    steps : int
        Number of Taylor steps.

    Raises
    ------
    ParameterError
        If the solution exceeds `LARGEST` or the series does not converge at this step.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0, eps=1e-9, sites=2)
    >>> flow = integrate_variations(chain, np.array([0.0, 0.0, 1.0, 0.0]), np.pi / 2, STEPS)
    >>> flow.state.round(6).tolist()
    [1.0, 0.0, 0.0, 0.0]
    """
    return _integrate(chain, start, duration, steps)


def integrate_along_sinusoids(
    chain: VdpChain,
    amplitudes: FloatArray,
    phases: FloatArray,
    omega: float,
    *,
    misprinted: bool,
    steps: int,
) -> Flow:
    """Integrate the variational equations over 2π/ω along y_n = A_n sin(ωt + θ_n) (Eq. 9).

    Parameters
    ----------
    chain : VdpChain
        A chain of any N, with either kind of ends.
    amplitudes, phases : float arrays, shape (N,)
        A_n and θ_n.
    omega : float
        Frequency in t.
    misprinted : bool
        Use the Jacobian as printed in (42), with 1 - 2ax + 4bx³ in place of -2ax + 4bx³.
    steps : int
        Number of Taylor steps.
    """
    start = np.concatenate([amplitudes * np.sin(phases), omega * amplitudes * np.cos(phases)])
    base = np.vstack([amplitudes, phases])
    extra = 1.0 if misprinted else 0.0
    forced = _Sinusoids(base, omega)
    return _integrate(chain, start, 2.0 * np.pi / omega, steps, forced=forced, extra=extra)


def integrate_chain(
    chain: VdpChain, start: FloatArray, duration: float, steps: int, order: int = ORDER
) -> Flow:
    """Integrate (8) alone; `Flow.monodromy` and `Flow.by_c` are empty.

    Parameters
    ----------
    chain : VdpChain
        A chain of any N, with either kind of ends.
    start : float array, shape (2N,)
        Initial displacements and velocities.
    duration : float
        Time, dimensionless.
    steps, order : int
        Total number of Taylor steps, and their order.

    Raises
    ------
    ParameterError
        As `integrate_variations`.
    """
    return _integrate(chain, start, duration, steps, order, variations=False)


def _integrate(
    chain: VdpChain,
    start: FloatArray,
    duration: float,
    steps: int,
    order: int = ORDER,
    *,
    forced: _Sinusoids | None = None,
    extra: float = 0.0,
    variations: bool = True,
) -> Flow:
    sites = chain.sites
    state = np.array(start, dtype=float)
    columns = 2 * sites + 1 if variations else 0
    tangent_y = np.zeros((sites, columns))
    tangent_v = np.zeros((sites, columns))
    if variations:
        tangent_y[:, :sites] = np.eye(sites)
        tangent_v[:, sites:-1] = np.eye(sites)
    samples = np.zeros((steps, sites))
    equation = _Equation(chain.a, chain.b, chain.c, chain.eps, chain.ends is Ends.PERIODIC, extra)
    run = _Run(state[:sites], state[sites:], tangent_y, tangent_v, samples)
    forced = forced or _Sinusoids(np.zeros((0, 0)), 0.0)
    if not _advance(equation, run, forced, duration / steps, order):
        raise ParameterError(
            "displacement",
            "too large",
            f"below {LARGEST:g} all along the orbit",
            "take more steps or a start nearer to the cycle",
        )
    tangents = np.vstack([tangent_y, tangent_v])
    by_c = tangents[:, -1] if variations else np.empty(0)
    return Flow(state, tangents[:, :-1], by_c, samples, steps)


class _Equation(NamedTuple):
    """The chain, whether it is a ring, and the term added to H: 1 for (42) as printed."""

    a: float
    b: float
    c: float
    eps: float
    ring: bool
    extra: float


class _Run(NamedTuple):
    """The quantities that are advanced in place.

    Attributes
    ----------
    y, v : ndarray, shape (N,)
        Displacements and velocities.
    ty, tv : ndarray, shape (N, M)
        Tangents; the last column, if present, is the derivative with respect to c.
    samples : ndarray, shape (steps, N)
        Filled with y at the beginning of each step.
    """

    y: FloatArray
    v: FloatArray
    ty: FloatArray
    tv: FloatArray
    samples: FloatArray


class _Sinusoids(NamedTuple):
    """Amplitudes and phases of the sinusoids in place of the solution, or (0, 0); frequency."""

    base: FloatArray
    omega: float


class _Series(NamedTuple):
    """Taylor coefficients of the orbit, shape (order + 1, N), and of its M tangents.

    N and M are rounded up to multiples of four.
    """

    Y: FloatArray
    V: FloatArray
    S: FloatArray
    T: FloatArray
    Q: FloatArray
    G: FloatArray
    H: FloatArray
    P: FloatArray
    W: FloatArray
    DY: FloatArray
    DV: FloatArray


@outer(cache=True)
def _advance(equation: _Equation, run: _Run, forced: _Sinusoids, h: float, order: int) -> bool:
    """Advance the state and its tangents by all steps; False if the solution is out of range."""
    sites, columns = run.ty.shape
    size = (order + 1, _in_fours(sites))
    Y, V, S, T, Q = (np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size))
    G, H, P, W = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size)
    large = (order + 1, sites, _in_fours(columns))
    DY, DV = np.zeros(large), np.zeros(large)
    series = _Series(Y, V, S, T, Q, G, H, P, W, DY, DV)
    row, spring = np.zeros(large[2]), np.zeros(sites)
    put(run.y, Y[0, :sites])
    put(run.v, V[0, :sites])
    for n in range(sites):
        put(run.ty[n], DY[0, n, :columns])
        put(run.tv[n], DV[0, n, :columns])
    for step in range(run.samples.shape[0]):
        put(Y[0, :sites], run.samples[step])
        for k in range(order):
            _add_products(equation, series, k)
            _stretch(equation.ring, Y[k], spring)
            if forced.base.shape[0] == 2:
                _add_sinusoids(series, forced, forced.omega * step * h, k)
            else:
                _add_motion(equation, series, spring, k)
            if columns > 0:
                _add_tangents(equation, series, spring, row, k)
        for each in (Y, V):
            _sum_up(each, h)
        for tangents in (DY, DV):
            _sum_up(tangents.reshape(order + 1, -1), h)
        put(Y[0, :sites], run.y)
        put(V[0, :sites], run.v)
        for n in range(sites):
            put(DY[0, n, :columns], run.ty[n])
            put(DV[0, n, :columns], run.tv[n])
            if not abs(run.y[n]) < LARGEST:
                return False
    return True


@inner()
def _in_fours(count: int) -> int:
    """Return the next multiple of four: an addition waits for another, so four sums run at once."""
    return -(-count // 4) * 4


@inner()
def _neighbours(ring: bool, sites: int, n: int) -> tuple[int, int]:
    """Return the two neighbours of a site; -1 and ``sites`` where there is none."""
    left, right = n - 1, n + 1
    if ring:
        left = sites - 1 if n == 0 else left
        right = 0 if n == sites - 1 else right
    return left, right


@inner()
def _stretch(ring: bool, y: FloatArray, spring: FloatArray) -> None:
    """Put 2y_n - y_{n-1} - y_{n+1} into ``spring``, without the neighbours that are missing."""
    sites = spring.size
    for n in range(sites):
        left, right = _neighbours(ring, sites, n)
        # The two differences are added, which gives the same bits after reflection.
        spring[n] = 0.0
        if left >= 0:
            spring[n] += y[n] - y[left]
        if right < sites:
            spring[n] += y[n] - y[right]


@inner()
def _add_products(equation: _Equation, series: _Series, k: int) -> None:
    """Fill the coefficients of index k of S, Q, G and W, and of T, H and P for tangents."""
    Y, V, S, Q, G, H = series.Y, series.V, series.S, series.Q, series.G, series.H
    a, b = equation.a, equation.b
    _add_product(Y, Y, S, k)
    _add_product(S, S, Q, k)
    for n in range(Y.shape[1]):
        G[k, n] = b * Q[k, n] - a * S[k, n]
        if k == 0:
            G[k, n] += 1.0
    _add_product(V, G, series.W, k)
    if series.DY.size > 0:
        _add_product(S, Y, series.T, k)
        for n in range(Y.shape[1]):
            H[k, n] = 4.0 * b * series.T[k, n] - 2.0 * a * Y[k, n]
            if k == 0:
                H[k, n] += equation.extra
        _add_product(V, H, series.P, k)


@inner()
def _add_product(left: FloatArray, right: FloatArray, product: FloatArray, k: int) -> None:
    """Fill the coefficients of index k of the product of two series."""
    for n in range(0, product.shape[1], 4):
        first = second = third = fourth = 0.0
        for j in range(k + 1):
            first += left[j, n] * right[k - j, n]
            second += left[j, n + 1] * right[k - j, n + 1]
            third += left[j, n + 2] * right[k - j, n + 2]
            fourth += left[j, n + 3] * right[k - j, n + 3]
        product[k, n], product[k, n + 1] = first, second
        product[k, n + 2], product[k, n + 3] = third, fourth


@inner()
def _add_motion(equation: _Equation, series: _Series, spring: FloatArray, k: int) -> None:
    """Fill the coefficients of index k + 1 of Y and V from (8)."""
    Y, V, W, eps = series.Y, series.V, series.W, equation.eps
    for n in range(spring.size):
        Y[k + 1, n] = V[k, n] / (k + 1)
        V[k + 1, n] = (-Y[k, n] - eps * equation.c * spring[n] - eps * W[k, n]) / (k + 1)


@inner()
def _add_sinusoids(series: _Series, forced: _Sinusoids, phase: float, k: int) -> None:
    """Fill the coefficients of index k + 1 of Y and V with those of sinusoids at ωt = ``phase``."""
    base, omega = forced.base, forced.omega
    factor = 1.0
    for j in range(k + 1):
        factor *= omega / (j + 1)
    for n in range(base.shape[1]):
        angle = phase + base[1, n] + 0.5 * np.pi * (k + 1)
        series.Y[k + 1, n] = base[0, n] * factor * np.sin(angle)
        series.V[k + 1, n] = base[0, n] * factor * omega * np.cos(angle)


@inner()
def _add_tangents(
    equation: _Equation, series: _Series, spring: FloatArray, row: FloatArray, k: int
) -> None:
    """Fill the coefficients of index k + 1 of the tangents; ``row`` is work space."""
    G, P, DY, DV = series.G, series.P, series.DY, series.DV
    sites, columns = spring.size, row.size
    c, eps = equation.c, equation.eps
    for n in range(sites):
        left, right = _neighbours(equation.ring, sites, n)
        row[:] = 0.0
        for j in range(k + 1):
            g, p = G[j, n], P[j, n]
            for m in range(columns):
                row[m] += g * DV[k - j, n, m] + p * DY[k - j, n, m]
        row[2 * sites] += spring[n]  # the derivative with respect to c
        if left >= 0:
            for m in range(columns):
                row[m] += c * (DY[k, n, m] - DY[k, left, m])
        if right < sites:
            for m in range(columns):
                row[m] += c * (DY[k, n, m] - DY[k, right, m])
        for m in range(columns):
            DY[k + 1, n, m] = DV[k, n, m] / (k + 1)
            DV[k + 1, n, m] = (-DY[k, n, m] - eps * row[m]) / (k + 1)


@inner()
def _sum_up(coefficients: FloatArray, h: float) -> None:
    """Replace the first coefficients by the values of the polynomials at h (Horner)."""
    for m in range(0, coefficients.shape[1], 4):
        first, second = coefficients[-1, m], coefficients[-1, m + 1]
        third, fourth = coefficients[-1, m + 2], coefficients[-1, m + 3]
        for k in range(coefficients.shape[0] - 2, -1, -1):
            first = first * h + coefficients[k, m]
            second = second * h + coefficients[k, m + 1]
            third = third * h + coefficients[k, m + 2]
            fourth = fourth * h + coefficients[k, m + 3]
        coefficients[0, m], coefficients[0, m + 1] = first, second
        coefficients[0, m + 2], coefficients[0, m + 3] = third, fourth
