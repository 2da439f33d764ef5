"""Σ(v, c) from Bessel functions: the response in time, without Fourier transform or roots.

Each site, once it has crossed the threshold, feeds ½ into the linear chain
dφ/dT = (ic/2)(2φ_n - φ_{n-1} - φ_{n+1}) - φ/2, whose response at distance m is
(-i)^|m| e^{-s/2 + ics} J_|m|(cs). The m-th site behind the one at
the threshold crossed it a time m/v ago, so that with φ(0) = -½ φ_s Σ (Eqs. 49, 53)

    Σ(v, c) = -Σ_{m ≥ 1} (-i)^m ∫₀^{m/v} e^{-s/2 + ics} J_m(cs) ds.

After exchanging sum and integral, the integrand on j/v < s < (j + 1)/v is e^{-s/2 + ics} times
Σ_{m > j} (-i)^m J_m(cs).
"""

from __future__ import annotations

import math
from time import perf_counter

import numpy as np

from theory.arrays import EPS, ComplexArray, FloatArray
from theory.parameters import Range, with_ranges, within
from theory.piecewise.roots import checked_velocity_and_coupling
from theory.piecewise.sums.result import KineticSum, PrecisionError

TOLERANCES = Range(1e-14, 0.1)
_MAX_EVALUATIONS = 30_000_000


@with_ranges(tolerances=TOLERANCES)
def sum_by_bessel(v: float, c: float, tolerance: float = 1e-12) -> KineticSum:
    """Return Σ(v, c) by the Bessel series.

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, dimensionless.
    tolerance : float
        Required error, {tolerances}.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    PrecisionError
        If more than 3e7 Bessel functions would be needed, as at large c.

    Examples
    --------
    >>> result = sum_by_bessel(0.3, 0.5)
    >>> bool(abs(result.value - (-0.28879675619025+0.45226875874939j)) < 1e-12)
    True
    """
    start = perf_counter()
    v, c = checked_velocity_and_coupling(v, c)
    within("tolerance", tolerance, *TOLERANCES)
    # The truncation is ∫_S^∞ e^{-s/2} |Σ_{m>j} (-i)^m J_m| ds, bounded by |Σ| ≤ 2 + √(cs).
    end = 2.0 * math.log(8.0 * (2.0 + math.sqrt(80.0 * c)) / tolerance)
    width = min(1.0 / v, 2.0, 3.0 / c)
    pieces_each = math.ceil(min(1.0 / v, end) / width)
    panels = math.ceil(end * v)
    if c < v:  # Σ_{m>j} |J_m(cs)| with cs ≤ c (j + 1)/v decays with j: J_m(x) ≤ (x/2)^m/m!
        x_each = c / v
        for j in range(panels):
            if (j + 1) * (math.log(0.5 * x_each * (j + 1)) - math.log(j + 1) + 1.0) < math.log(
                1e-3 * tolerance
            ):
                panels = j + 1
                break
    orders = c * end + 12.0 * (c * end + 1.0) ** (1 / 3) + 25.0
    cost = panels * pieces_each * 34.0 * orders
    if cost > _MAX_EVALUATIONS:
        raise PrecisionError(
            f"the Bessel series at v = {v:.6g}, c = {c:.6g} needs {cost:.2g} Bessel functions, "
            f"more than {_MAX_EVALUATIONS:.0e}; use the method integral."
        )
    coarse, evaluations, _ = _summed(v, c, panels, end, pieces_each, nodes=14)
    fine, more, size = _summed(v, c, panels, end, pieces_each, nodes=20)
    error = abs(fine - coarse) + 0.5 * tolerance + 20.0 * EPS * (1.0 + c) * size
    return KineticSum(
        value=-fine,
        error=error,
        terms=evaluations + more,
        method="bessel",
        seconds=perf_counter() - start,
    )


def _summed(
    v: float, c: float, panels: int, end: float, pieces: int, *, nodes: int
) -> tuple[complex, int, float]:
    """Return the integral up to ``end`` by Gauss–Legendre, the evaluations, and ∫|integrand|.

    A panel is the time j/v < s < (j + 1)/v between the crossings of two sites; each is divided into
    ``pieces``.
    """
    point, weight = np.polynomial.legendre.leggauss(nodes)
    total, evaluations, size = 0j, 0, 0.0
    for j in range(panels):
        edge = np.linspace(j / v, min((j + 1) / v, max(end, j / v)), pieces + 1)
        half = 0.5 * np.diff(edge)[:, None]
        s = (0.5 * (edge[1:] + edge[:-1])[:, None] + half * point).ravel()
        values = np.exp((-0.5 + 1j * c) * s) * _later_sites(c * s, j + 1)
        weights = (half * weight).ravel()
        total += complex(np.sum(values * weights))
        size += float(np.sum(np.abs(values) * weights))
        evaluations += s.size
    return total, evaluations, size


def _later_sites(x: FloatArray, first: int) -> ComplexArray:
    """Return Σ_{m ≥ first} (-i)^m J_m(x), by Miller's downward recurrence.

    J_{m-1} = (2m/x) J_m - J_{m+1} is run downwards from m far above x, and the result is normalised
    by J_0 + 2 Σ J_{2m} = 1. An x below 1e-20 is replaced by 1e-20, which changes J_1 by less than
    1e-20 and keeps 2m/x in range.
    """
    x = np.maximum(x, 1e-20)
    top = float(x.max())
    last = math.ceil(max(first, top + 12.0 * (top + 1.0) ** (1 / 3) + 12.0)) + 20
    above, current = np.zeros_like(x), np.full_like(x, 1e-280)
    norm = np.zeros_like(x)
    total: ComplexArray = np.zeros(x.shape, dtype=complex)
    for m in range(last, -1, -1):
        if m >= first:
            total = total + (-1j) ** (m % 4) * current
        if m % 2 == 0:
            norm += current if m == 0 else 2.0 * current
        if m:
            above, current = current, (2.0 * m / x) * current - above
            if m % 4 == 0 and np.max(np.abs(current)) > 1e100:
                shrink = np.where(np.abs(current) > 1e100, 1e-120, 1.0)
                above, current, norm, total = (
                    above * shrink,
                    current * shrink,
                    norm * shrink,
                    total * shrink,
                )
    return total / norm
