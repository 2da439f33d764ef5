"""Taylor coefficients in time of the friction chain (5), and the first root of a polynomial.

While no site changes its mode (5) is smooth, with E = e^{-|v_rel|/v₀} as a third unknown:

    w = ẏ - v_d,  ẏ = w + v_d,  Ė = -(s/v₀) ẇ E,
    ẇ = -s(μ_d + (μ_st - μ_d)E) - 2ξ(w + v_d) - y - c(…),   s = sgn(w) fixed;   in stick ẇ = 0.

w is stepped and not ẏ, so that it keeps all its digits near stick. All quantities are
dimensionless. Shapes: coefficients (order + 1, N); ``modes`` (N,): STICK 0, slip s = -1 or +1.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from verification.execution.compiled import njit
from verification.steppers.rows import put

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

MU_ST, MU_D, V0, XI, V_D, C = 0, 1, 2, 3, 4, 5
"""Places in the array of parameters."""

_DEPTH = 48
_LOOKS = 16


@njit(cache=True)
def exponential(parameters: FloatArray, speed: float) -> float:
    """Return E = e^{-speed/v₀}; below the normal numbers 0, which costs nothing to multiply.

    A negative speed continues a slip phase smoothly beyond its end.
    """
    e = math.exp(-speed / parameters[V0])
    return e if e > 1e-300 else 0.0


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def coupling_row(out: FloatArray, row: FloatArray, free: bool, lo: int, hi: int) -> None:
    """Put 2u_n - (u_{n-1} + u_{n+1}), with the end condition, into out[lo:hi].

    The sum in brackets keeps a mirror-symmetric chain symmetric to the last bit.
    """
    last = row.size - 1
    if last == 0:
        out[0] = 0.0 if free else 2.0 * row[0]
        return
    first, beyond = max(lo, 1), min(hi, last)
    target, here = out[first:beyond], row[first:beyond]
    left, right = row[first - 1 : beyond - 1], row[first + 1 : beyond + 1]
    for n in range(beyond - first):
        target[n] = 2.0 * here[n] - (left[n] + right[n])
    own = 1.0 if free else 2.0
    if lo == 0:
        out[0] = own * row[0] - row[1]
    if hi == last + 1:
        out[last] = own * row[last] - row[last - 1]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def coefficients(
    Y: FloatArray,
    W: FloatArray,
    E: FloatArray,
    D: FloatArray,
    lap: FloatArray,
    modes: IntArray,
    released: npt.NDArray[np.bool_],
    signs: FloatArray,
    parameters: FloatArray,
    free: bool,
    order: int,
    lo: int,
    hi: int,
) -> None:
    """Fill Y[k], W[k], k = 1 … order, on lo:hi from Y[0], W[0].

    Parameters
    ----------
    Y, W : ndarray, shape (order + 1, N)
        Coefficients of y and of w = ẏ - v_d.
    E, D : ndarray, shape (order + 1, N)
        Room for E and ẇ.
    lap : ndarray, shape (N,)
        Room for the coupling term.
    modes : ndarray of int, shape (N,)
        0 in stick, else the sign of w.
    released : ndarray of bool, shape (N,)
        Sites whose stick ends at this very time: there ẇ = 0 exactly.
    signs : ndarray, shape (3, N)
        Room.
    """
    v_d, c = parameters[V_D], parameters[C]
    drag = 2.0 * parameters[XI]
    static, slope = parameters[MU_D], parameters[MU_ST] - parameters[MU_D]
    free_rate, gain, rate = signs[0], signs[1], signs[2]
    for n in range(lo, hi):
        s = float(modes[n])
        free_rate[n] = 1.0 if modes[n] != 0 else 0.0
        gain[n] = -s * slope
        rate[n] = -s / parameters[V0]
        E[0, n] = exponential(parameters, s * W[0, n]) if modes[n] != 0 else 0.0
    for k in range(order):
        factor = 1.0 / (k + 1)
        y, w, e = Y[k, lo:hi], W[k, lo:hi], E[k, lo:hi]
        next_y, next_w, next_e = Y[k + 1, lo:hi], W[k + 1, lo:hi], E[k + 1, lo:hi]
        d, bend = D[k, lo:hi], lap[lo:hi]
        moving, times, scale = free_rate[lo:hi], gain[lo:hi], rate[lo:hi]
        coupling_row(lap, Y[k], free, lo, hi)
        for n in range(hi - lo):
            d[n] = moving[n] * (times[n] * e[n] - drag * w[n] - y[n] - c * bend[n])
            next_y[n] = factor * w[n]
        if k == 0:
            for n in range(hi - lo):
                d[n] = moving[n] * (d[n] - drag * v_d) - float(modes[lo + n]) * static
                next_y[n] += v_d
                if released[lo + n]:
                    d[n] = 0.0
        next_e[:] = 0.0
        for j in range(k + 1):
            u, f = D[j, lo:hi], E[k - j, lo:hi]
            for n in range(hi - lo):
                next_e[n] += u[n] * f[n]
        for n in range(hi - lo):
            next_w[n] = factor * d[n]
            next_e[n] *= factor * scale[n]


@njit(cache=True, fastmath={"contract"})
def horner(P: FloatArray, order: int, h: float, lo: int, hi: int, out: FloatArray) -> None:
    """Put the value a time h after the expansion point into out[lo:hi]."""
    target = out[lo:hi]
    put(P[order, lo:hi], target)
    for k in range(order - 1, -1, -1):
        row = P[k, lo:hi]
        for n in range(hi - lo):
            target[n] = target[n] * h + row[n]


@njit(cache=True)
def site_value(P: FloatArray, order: int, h: float, n: int) -> float:
    """Return the value of site n a time h after the expansion point."""
    value = P[order, n]
    for k in range(order - 1, -1, -1):
        value = value * h + P[k, n]
    return float(value)


@njit(cache=True)
def value_at(f: FloatArray, degree: int, h: float) -> float:
    """Return Σ f_k h^k."""
    value = f[degree]
    for k in range(degree - 1, -1, -1):
        value = value * h + f[k]
    return float(value)


@njit(cache=True)
def resolved(
    W: FloatArray, order: int, h: float, n: int, s: float, v0: float, allowed: float
) -> float:
    """Return h, halved until the series of site n in slip sees the growth of E = e^{-s w/v₀}.

    Far from stick E is too small to leave a trace in the coefficients; still it can be of order
    one at the end of the step. The remainder of its series, E(nearest w) x^order/order! with
    x = (w's approach)/v₀, is held below the tolerance.

    Parameters
    ----------
    W : ndarray, shape (order + 1, N)
        Coefficients of w.
    order : int
        Order.
    h : float
        Step proposed.
    n : int
        Site.
    s : float
        Its direction of slip.
    v0, allowed : float
        Reference velocity, and :func:`allowed_remainder`.
    """
    start = s * W[0, n]
    while h > 0.0:
        size = 0.0
        for k in range(order, 0, -1):
            size = (size + abs(W[k, n])) * h
        if size <= v0:
            return h
        nearest = max(0.0, start - size)
        if start - nearest <= v0 or _remainder(nearest, start, v0, order) <= allowed:
            return h
        nearest = start
        for i in range(1, _LOOKS + 1):
            nearest = min(nearest, s * site_value(W, order, h * i / _LOOKS, n))
        nearest = max(0.0, nearest)
        if start - nearest <= v0 or _remainder(nearest, start, v0, order) <= allowed:
            return h
        h *= 0.5
    return h


@njit(cache=True)
def allowed_remainder(order: int, tolerance: float) -> float:
    """Return the largest logarithm of order! times a remainder within the tolerance."""
    return math.log(tolerance) + math.lgamma(order + 1.0)


@njit(cache=True)
def _remainder(nearest: float, start: float, v0: float, order: int) -> float:
    """Return the logarithm of order! times the remainder of the series of E."""
    return order * math.log((start - nearest) / v0) - nearest / v0


@njit(cache=True)
def _polish(f: FloatArray, degree: int, low: float, high: float) -> float:
    """Return the root between low, where f > 0, and high, where f <= 0: Newton, safeguarded."""
    x = 0.5 * (low + high)
    for _ in range(100):
        value, slope = f[degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope = slope * x + value
            value = value * x + f[k]
        if value > 0.0:
            low = x
        else:
            high = x
        following = x - value / slope if slope != 0.0 else low - 1.0
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - x) <= 4e-16 * abs(x) or following in (low, high):
            return float(following)
        x = following
    return float(x)


@njit(cache=True)
def first_root(
    f: FloatArray, degree: int, h: float, work: FloatArray, binomial: FloatArray
) -> float:
    """Return the first time in [0, h] at which f, positive before, becomes negative; else inf.

    f(0) <= 0 counts as zero: then the sign just after is that of the first coefficient that is
    not zero, and if that is negative the answer is 0. A root of even order is no crossing.
    Isolation is by Bernstein coefficients: no change of sign, no root; one, one root; else halve.

    Parameters
    ----------
    f : ndarray, shape (degree + 1,)
        Coefficients; overwritten.
    degree : int
        Degree.
    h : float
        End of the interval.
    work : ndarray, shape (_DEPTH + 2, degree + 1)
        Room.
    binomial : ndarray, shape (degree + 1, degree + 1)
        Binomial coefficients.
    """
    while f[0] <= 0.0:
        if degree == 0 or f[1] < 0.0:
            return 0.0 if degree > 0 else math.inf
        for k in range(degree):
            f[k] = f[k + 1]
        degree -= 1
    size = 0.0
    for k in range(degree, 0, -1):
        size = (size + abs(f[k])) * h
    if size < f[0]:
        return math.inf
    power = 1.0
    top = work[0]
    for k in range(degree + 1):
        top[k] = f[k] * power / binomial[degree, k]
        power *= h
    for k in range(1, degree + 1):  # in place: differences back to Bernstein coefficients
        for i in range(degree, k - 1, -1):
            top[i] += top[i - 1]
    depth, width = 0, 1.0
    left = 0.0
    # work[depth] is the interval at hand, work[:depth] those to its right, each twice as wide.
    while depth >= 0:
        b = work[depth]
        changes = 0
        for i in range(degree):
            if (b[i] > 0.0) != (b[i + 1] > 0.0):
                changes += 1
        if changes == 1 and b[0] > 0.0:
            return _polish(f, degree, left * h, (left + width) * h)
        if changes > 1 and depth < _DEPTH:
            following = work[depth + 1]
            for i in range(degree + 1):
                following[i] = b[0]
                for j in range(degree - i):
                    b[j] = 0.5 * (b[j] + b[j + 1])
            # b[0] is now the value at the middle; b is the right half.
            depth += 1
            width *= 0.5
            continue
        left += width
        depth -= 1
        # The interval to the right is as wide as its sibling just left behind, or wider.
        width = _width_of(left)
    return math.inf


@njit(cache=True)
def _width_of(left: float) -> float:
    """Return the width of the dyadic interval that begins at ``left``, after a left neighbour."""
    width = 1.0
    while left % width != 0.0:
        width *= 0.5
    return width


def binomials(degree: int) -> FloatArray:
    """Return the table of binomial coefficients up to a degree.

    Examples
    --------
    >>> binomials(2)[2]
    array([1., 2., 1.])
    """
    return np.array(
        [[math.comb(n, k) for k in range(degree + 1)] for n in range(degree + 1)], dtype=float
    )
