"""The front of (43) as a wave R(n - vT), by scipy alone: finite differences in ξ, sparse Newton.

    -v R'(ξ) = (c/2)[R(ξ - 1) - R(ξ + 1)] - (R/2)(1 - R²/4 + η R⁴/8)

on points 1/m apart, so that there are m points per site, with a central difference of order twenty
for R'. Newton's method starts from a run of the chain by scipy. Its matrix is in double precision
and its residual in long doubles, so that the limit is free of the rounding errors of the
differences.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse import csc_matrix, diags, hstack, vstack
from scipy.sparse.linalg import spsolve

from theory.arrays import AnyArray, FloatArray

_REACH = 10
"""Number of points on either side that a difference uses."""

_CENTRAL = [
    -((-1) ** k) * np.longdouble(math.factorial(_REACH) ** 2)
    / (k * math.factorial(_REACH - k) * math.factorial(_REACH + k))
    for k in range(1, _REACH + 1)
]  # fmt: skip
"""Weights of the points on the right, beginning with the nearest."""

_MAX_ITERATIONS = 60


def front_velocity(
    c: float, eta: float, per_site: int = 48, behind: int = 12, ahead: int = 24
) -> np.longdouble:
    """Return v of the front of (43) at a = 1, b = η.

    Parameters
    ----------
    c, eta : float
        Coupling and η, dimensionless.
    per_site : int, optional
        Points per site, at least ten; the error of v decreases like its twentieth power.
    behind, ahead : int, optional
        Number of sites on either side of the one that passes the unstable cycle.

    Raises
    ------
    ArithmeticError
        If Newton's method does not converge.

    Examples
    --------
    >>> round(float(front_velocity(0.6, 0.03125)), 6)
    0.722566
    """
    root = np.sqrt(1 - 8 * np.longdouble(eta))
    stable, unstable = np.sqrt((1 + root) / eta), np.sqrt((1 - root) / eta)
    xi = np.arange(-behind * per_site, ahead * per_site + 1) / per_site
    middle = behind * per_site
    R, v = (
        np.asarray(x, np.longdouble) for x in _guess(c, eta, xi, float(stable), float(unstable))
    )
    left, right = np.full(per_site, stable), np.zeros(per_site, np.longdouble)
    phase = csc_matrix(([1.0], ([0], [middle])), shape=(1, R.size + 1))
    last = math.inf
    for _ in range(_MAX_ITERATIONS):
        padded = np.concatenate([left, R, right])
        slope = sum(
            weight * per_site * (_shifted(padded, k, xi.size) - _shifted(padded, -k, xi.size))
            for k, weight in enumerate(_CENTRAL, start=1)
        )
        neighbours = _shifted(padded, -per_site, xi.size) - _shifted(padded, per_site, xi.size)
        damping = R * (1 - R**2 / 4 + eta * R**4 / 8)
        value = np.append(v * slope + (c * neighbours - damping) / 2, R[middle] - unstable)
        column = csc_matrix(np.asarray(slope, float)[:, None])
        above = hstack([_matrix(R.astype(float), float(v), c, eta, per_site), column])
        change = spsolve(vstack([above, phase]).tocsc(), value.astype(float), permc_spec="MMD_ATA")
        R, v = R - change[:-1], v - change[-1]
        if last < 1e-10:  # this change has left only rounding errors
            return np.longdouble(v)
        last = float(np.abs(change).max() / stable)
    raise ArithmeticError(f"no wave was found at c = {c:g}, eta = {eta:g}")


def _shifted(padded: AnyArray, by: int, size: int) -> AnyArray:
    begin = (padded.size - size) // 2 + by
    return padded[begin : begin + size]


def _matrix(R: FloatArray, v: float, c: float, eta: float, m: int) -> Any:
    bands = {k: v * m * float(weight) for k, weight in enumerate(_CENTRAL, start=1)}
    bands |= {-k: -weight for k, weight in bands.items()}
    bands[-m] = bands.get(-m, 0.0) + 0.5 * c
    bands[m] = bands.get(m, 0.0) - 0.5 * c
    entries = [np.full(R.size - abs(k), weight) for k, weight in bands.items()]
    own = -(0.5 - 3.0 * R**2 / 8.0 + 5.0 * eta * R**4 / 16.0)
    return diags([own, *entries], [0, *bands])


def _guess(
    c: float, eta: float, xi: FloatArray, stable: float, unstable: float
) -> tuple[FloatArray, float]:
    """Run a chain of real amplitudes from rest beside a site on the cycle; return R and v."""
    sites, watched = 60, 20

    def rate(_: float, r: FloatArray) -> FloatArray:
        padded = np.concatenate([[stable], r, [0.0]])
        spring = 0.5 * c * (padded[:-2] - padded[2:])
        return np.asarray(spring - 0.5 * r * (1.0 - r**2 / 4.0 + eta * r**4 / 8.0))

    def arrived(_: float, r: FloatArray) -> float:
        return float(r[watched + 4] - unstable)

    arrived.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(rate, (0.0, 1e3), np.zeros(sites), "DOP853", rtol=1e-8, atol=1e-9,
                    events=arrived, dense_output=True)  # fmt: skip
    end, states = float(run.t[-1]), run.sol
    assert states is not None
    times = np.linspace(0.0, end, 4000)
    late, early = (
        float(np.interp(unstable, states(times)[site], times)) for site in (watched, watched - 1)
    )
    v = 1.0 / (late - early)
    R = states(np.clip(late - xi / v, 0.0, end))[watched]
    return np.where(late - xi / v > end, stable, R), v
