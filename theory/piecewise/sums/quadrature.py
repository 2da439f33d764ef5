"""Σ(v, c) by adaptive quadrature on the real line: the plain baseline."""

from __future__ import annotations

import itertools
import math
from time import perf_counter

from theory.parameters import Range, with_ranges, within
from theory.piecewise.roots import checked_velocity_and_coupling
from theory.piecewise.sums.result import KineticSum, PrecisionError

TOLERANCES = Range(1e-14, 0.1)
_MAX_PIECES = 50_000

LARGEST_COUPLING = 20.0
"""Largest c; beyond it QUADPACK misses peaks of width 1/c, and its estimate is not a bound."""


@with_ranges(tolerances=TOLERANCES)
def sum_by_quadrature(v: float, c: float, tolerance: float = 1e-10) -> KineticSum:
    """Return Σ = -1 + (v/π) ∫₀^∞ dk/(A² + v²k²), A = ½ - i c (1 - cos k), by QUADPACK.

    The formula follows from closing the contour of (53) along the real axis, where L has no root,
    and combining k with -k. With x = vk the integrand is 1/(A² + x²). Pieces of at most an octave
    of x and at most two periods of A are integrated by ``scipy.integrate.quad`` (over more periods
    its extrapolation returns wrong values with small error estimates); the integral beyond X is 1/X
    to within max|A|²/(2X³).

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, dimensionless.
    tolerance : float
        Required absolute tolerance, {tolerances}. The error returned may be larger.

    Returns
    -------
    KineticSum
        ``error`` is twice QUADPACK's estimate plus the bound on the error beyond X.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    PrecisionError
        If c is above 20, or more than 50 000 pieces would be needed (small v).

    Examples
    --------
    >>> result = sum_by_quadrature(0.3, 0.5, 1e-8)
    >>> bool(abs(result.value - (-0.28879675619025+0.45226875874939j)) < result.error < 1e-6)
    True
    """
    import numpy as np
    from scipy.integrate import quad

    start = perf_counter()
    v, c = checked_velocity_and_coupling(v, c)
    within("tolerance", tolerance, *TOLERANCES)
    if c > LARGEST_COUPLING:
        raise PrecisionError(
            f"quadrature at v = {v:.6g}, c = {c:.6g} would step over narrow peaks and understate "
            f"its error beyond c = {LARGEST_COUPLING:g}; use the method integral."
        )
    largest = 0.25 + 4.0 * c * c
    end = max((2.0 * largest / tolerance) ** (1.0 / 3.0), 2.0 * math.sqrt(largest), 2.0)
    widest = 4.0 * math.pi * v
    pieces = end / widest + math.log2(end) + 1.0
    if pieces > _MAX_PIECES:
        raise PrecisionError(
            f"quadrature to {tolerance:g} at v = {v:.6g}, c = {c:.6g} needs {pieces:.2g} pieces, "
            f"more than {_MAX_PIECES}; use the method integral, or a larger tolerance."
        )
    edges = [0.0]
    while edges[-1] < end:
        edges.append(min(end, edges[-1] + min(widest, max(0.5, edges[-1]))))
    calls = 0

    def integrand(x: float) -> complex:
        nonlocal calls
        calls += 1
        onsite = 0.5 - 2j * c * math.sin(0.5 * x / v) ** 2
        return 1.0 / (onsite * onsite + x * x)

    parts, error = [1.0 / end + 0j], largest / (2.0 * end**3)
    for low, high in itertools.pairwise(edges):
        part, estimate, _ = quad(
            integrand,
            low,
            high,
            complex_func=True,
            epsabs=0.1 * tolerance / len(edges),
            epsrel=0.0,
            limit=2000,
            full_output=True,  # suppresses the warning, which the estimate makes superfluous
        )
        parts.append(part)
        error += 2.0 * (abs(estimate.real) + abs(estimate.imag))
    # Adding tens of thousands of pieces one by one would round by more than the estimates.
    total = complex(math.fsum(np.real(parts)), math.fsum(np.imag(parts)))
    value = total / np.pi - 1.0
    return KineticSum(
        value=value,
        error=error / np.pi + 1e-15,
        terms=calls,
        method="quadrature",
        seconds=perf_counter() - start,
    )
