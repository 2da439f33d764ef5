"""Σ(v, c) by the periodised integral of ``sums.integral`` to any number of digits.

Where the root-free strip is wide, the points are equispaced on the real axis. Elsewhere they are
given by tan(k/2) = e^{σ + iπ/4} with σ equispaced: there are equally many on every scale of k, and
they lie on the side of the axis where Re A grows. The poles of the integrand lie near Im σ = ±π/4
or farther from the path. The exceptions are the poles at -k, where k is one of the roots below the
axis near Re k = -2c/v, where such roots turn away from the axis. A pole at σ_p that belongs above
the path changes the rule with step h by t/(e^{-2πiσ_p/h} - 1), t = 1/(k L_k), wherever it lies;
this error is subtracted.
"""

from __future__ import annotations

import math
from time import perf_counter
from typing import Any

import mpmath as mp
import numpy as np

from theory.arrays import IntArray
from theory.parameters import count_within, with_ranges
from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.limits import static_sum_distance
from theory.piecewise.precise_roots import exact, precise_roots
from theory.piecewise.roots import MAX_LABEL, checked_velocity_and_coupling
from theory.piecewise.sums.result import DIGITS, KineticSum, PrecisionError, stated

_MAX_POINTS = 200_000
_SPARE_DIGITS = 8
"""Number of correct digits beyond those required, of the twelve that are computed."""


@with_ranges(digits=DIGITS)
def precise_sum_by_integral(v: float | str, c: float | str, digits: int) -> KineticSum:
    """Return Σ(v, c) of Eq. (53) to ``digits`` digits after the point.

    Where v is so small that Σ agrees to this accuracy with its limit as v → 0
    (``theory.piecewise.limits.static_sum``), the limit is returned, and ``method`` says so.

    Parameters
    ----------
    v, c : float or str
        Front velocity v̂ and coupling, dimensionless; strings are read as decimals.
    digits : int
        Required digits after the point, {digits}.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    PrecisionError
        If more than 200 000 points would be needed.

    Examples
    --------
    >>> total = precise_sum_by_integral("0.3", "0.5", digits=30)
    >>> print(mp.nstr(total.value.real, 25))
    -0.2887967561902519894582199
    """
    start = perf_counter()
    digits = count_within("digits", digits, *DIGITS)
    v_, c_ = checked_velocity_and_coupling(v, c)
    if (distance := static_sum_distance(v_, c_)) < 10.0 ** (-digits - 2):
        with mp.workdps(digits + 12):
            q = mp.sqrt(1 - 4j * exact(c))
            value = 4j * exact(c) / (q * (1 + q))
        error = distance + mp.mpf(10) ** (-digits - _SPARE_DIGITS)
        return KineticSum(
            value=value,
            error=stated(error),
            terms=0,
            method="static limit",
            seconds=perf_counter() - start,
            digits=digits,
        )
    # The second term includes the loss in 1 - e^{-A/v}.
    lost_digits = math.log10(2.0 + c_ / v_) + 2.0 * math.log10(2.0 + v_)
    # The bound is least on a line inside the strip; with more points it lies nearer the edge.
    strip = (1.0 - 1.0 / (2.0 + (digits + 1) * math.log(10.0))) * root_free_strip(v_, c_)
    gap = 0.5 - c_ * math.sinh(strip)
    # 2M/(e^{Nσ} - 1) as in `axis.plain_points`, with the largest |G| on the line as M.
    peak = 1.0 / (math.tanh(0.5 * (gap - v_ * strip) / v_) * 2.0 * gap)
    equispaced = 2 * math.ceil((math.log(2.0 * peak) + (digits + 1) * math.log(10.0)) / strip / 2.0)
    step = math.pi**2 / 2.0 / ((digits + 3) * math.log(10.0)) * 0.8
    half_count = 2 * math.ceil(
        ((digits + 3) * math.log(10.0) + math.log(4.0 + 4.0 * v_)) / step / 2.0
    )
    points = min(equispaced // 2, 2 * half_count)
    if points > _MAX_POINTS:
        raise PrecisionError(f"{digits} digits need {points} points, more than {_MAX_POINTS}.")
    with mp.workdps(digits + 12 + math.ceil(lost_digits)):
        if equispaced // 2 <= 2 * half_count:
            value = _equispaced(exact(v), exact(c), equispaced)
            truncation = 2.0 * peak / mp.expm1(equispaced * strip)
        else:
            value, coarse = _graded(exact(v), exact(c), mp.mpf(step), half_count)
            value += _correction(exact(v), exact(c), mp.mpf(step))
            coarse += _correction(exact(v), exact(c), 2 * mp.mpf(step))
            # At both ends |G| ≤ coth(1/4v) approximately, and the weights fall like 2e^{-|σ|}/π.
            end_bound = 4.0 * (1.0 + 4.0 * v_) * mp.exp(-half_count * step)
            truncation = 100 * abs(value - coarse) ** 2 + end_bound
        error = stated(truncation + mp.mpf(10) ** (-digits - _SPARE_DIGITS))
    return KineticSum(
        value=value,
        error=error,
        terms=points,
        method="integral",
        seconds=perf_counter() - start,
        digits=digits,
    )


def _integrand(X: Any, E: Any, A: Any) -> Any:
    """Return G = S/2A, E = e^{-A/v}."""
    square = E * E
    return (1 - square) / ((1 + square + (4 * X - 2) * E) * (2 * A))


def _equispaced(v: Any, c: Any, count: int) -> Any:
    total, decay = mp.mpc(0), mp.exp(-1 / (2 * v))
    for j in range(count // 2 + 1):
        X = mp.sin(mp.pi * j / count) ** 2
        turn = 2 * c * X
        cosine, sine = mp.cos_sin(turn / v)
        E, A = mp.mpc(decay * cosine, decay * sine), mp.mpc(0.5, -turn)
        value = _integrand(X, E, A)
        total += value if j in (0, count // 2) else 2 * value
    return total / count - 1


def departing_labels(v: float, c: float) -> IntArray:
    """Return the labels of the three roots below the axis nearest Re k = -2c/v.

    The root in the strip (2πn, 2πn + 2π) leaves the axis as its Re k passes (2n + 1)π, which
    happens when v (2|n| - 1)π = c (1 + cosh(1/2v)) (fact 4 of ``theory.piecewise.dispersion``).
    """
    crossing = -(c / v) * (1.0 + math.cosh(min(0.5 / v, 30.0)))
    middle = min(max(math.floor(crossing / (2.0 * math.pi)), 1 - MAX_LABEL), -2)
    return np.array([middle - 1, middle, middle + 1], dtype=np.int64)


def _correction(v: Any, c: Any, step: Any) -> Any:
    """Return the correction for the departing roots; see `departing_labels`."""
    labels = departing_labels(float(v), float(c))
    total = mp.mpc(0)
    for k in precise_roots(v, c, labels, False, mp.mp.dps):
        residue = 1 / (-1j * k * (v + c * mp.sin(k)))
        sigma = mp.log(mp.tan(-k / 2)) - 1j * mp.pi / 4
        total += residue / mp.expm1(-2j * mp.pi * sigma / step)
    return total


def _graded(v: Any, c: Any, step: Any, half_count: int) -> tuple[Any, Any]:
    """Return the sums over the graded points with the given step and with twice the step.

    With t = e^σ and p = t², the point is X = (p² + ip)/(1 + p²), and the weight
    1/cosh(σ + iπ/4) = √2 t (p + 1 - i(p - 1))/(1 + p²).
    """
    total = {0: mp.mpc(0), 1: mp.mpc(0)}
    t, ratio, root = mp.exp(-half_count * step), mp.exp(step), mp.sqrt(2)
    for j in range(-half_count, half_count + 1):
        p = t * t
        inverse = 1 / (1 + p * p)
        height = p * inverse
        X = mp.mpc(p * height, height)
        A = mp.mpc(0.5 + 2 * c * height, -2 * c * X.real)
        decay, (cosine, sine) = mp.exp(-A.real / v), mp.cos_sin(A.imag / v)
        E = mp.mpc(decay * cosine, -decay * sine)
        scale = root * t * inverse
        total[j % 2] += _integrand(X, E, A) * mp.mpc(scale * (p + 1), scale * (1 - p))
        t *= ratio
    scale = step / mp.pi
    return (total[0] + total[1]) * scale - 1, 2 * total[0] * scale - 1
