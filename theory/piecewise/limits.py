"""Limits of the kinetic relation (54) in closed form: pinning as v → 0, c → ∞, and η → 0."""

from __future__ import annotations

import cmath
import math
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from theory.arrays import EPS, ComplexArray, FloatArray, IntArray
from theory.cells.vdp import ETA_END, bistable_eta, eta_from_ratio, threshold_ratio
from theory.parameters import Range, positive, with_ranges, within

ETA_PIN_END = 2.0 / 25.0
"""η at which r = ½; from here on static fronts exist at every coupling, and there is no c_pin."""
COUPLINGS = Range(1e-150, 1e300)
"""Couplings whose η_pin and η_fold are given."""


@overload
def static_sum(c: float) -> complex: ...
@overload
def static_sum(c: FloatArray) -> ComplexArray: ...
def static_sum(c: Any) -> Any:
    """Return Σ(0⁺, c) = -1 + 1/√(1 - 4ic), approached faster than any power of v; array or number.

    As v → 0, sinh a/(cosh a - cos k) → 1 in the periodised integral, which leaves the mean of
    1/(1 - 4ic sin²(k/2)). With q = √(1 - 4ic) the result is computed as 4ic/(q (1 + q)), without
    cancellation at small c.

    Examples
    --------
    >>> abs(static_sum(1e-8)) < 1e-7
    True
    """
    square = 1.0 - 4j * c
    q = np.sqrt(square) if isinstance(c, np.ndarray) else cmath.sqrt(square)
    return 4j * c / (q * (1.0 + q))


def static_sum_distance(v: float, c: float) -> float:
    """Return a bound on |Σ(v, c) - Σ(0⁺, c)|, which is exponentially small in 1/v.

    |1/(2A)| ≤ 1, and the modulus of sinh a/(cosh a - cos k) - 1 = 2 Σ_{n ≥ 1} e^{-na} cos nk is at
    most 2e/(1 - e), where e = e^{-1/2v} ≥ |e^{-a}|.
    """
    return -2.0 * math.exp(-0.5 / v) / math.expm1(-0.5 / v)


def pinning_coupling(eta: float) -> float | None:
    """Return c_pin(η), up to which static fronts exist; None if they exist at every coupling.

    At c_pin |Σ(0⁺, c)| = 2r. With √(1 - 4ic) = cosh θ - i sinh θ and p = cosh θ, 4c = sinh 2θ, this
    is (1 - 4r²)p² - p + 2r² = 0, whose root above 1 gives c = ½ p √(p² - 1).

    Parameters
    ----------
    eta : float
        η = b/a², dimensionless, 0 < η ≤ 1/8.

    Returns
    -------
    float or None
        c_pin, dimensionless; None for η ≥ 2/25 (r ≥ ½).

    Examples
    --------
    >>> c = pinning_coupling(0.03125)
    >>> abs(abs(static_sum(c)) - 2 * threshold_ratio(0.03125)) < 1e-14
    True
    >>> pinning_coupling(0.08) is None
    True
    """
    eta = bistable_eta(eta)
    r2, gap = threshold_ratio(eta) ** 2, _ratio_gap(eta)
    if eta >= ETA_PIN_END:
        return None
    # p - 1, in a form without cancellation at small r and at r near ½
    root = math.sqrt(1.0 - 8.0 * r2 * gap)
    excess = (8.0 * r2 - 8.0 * r2 * gap / (1.0 + root)) / (2.0 * gap)
    return 0.5 * (1.0 + excess) * math.sqrt(excess * (2.0 + excess))


def _ratio_gap(eta: float) -> float:
    """Return 1 - 4r² to within rounding, as 8(2 - 25η)/((1 + s)(3 + 5s)), s = √(1 - 8η).

    Near η = 2/25 the difference 1 - 4r² cancels, on which c_pin ≈ 1/(1 - 4r²)² depends.
    """
    s = math.sqrt(max(1.0 - 8.0 * eta, 0.0))
    numerator, denominator = eta.as_integer_ratio()  # integers, so that their difference is exact
    return 8.0 * ((2 * denominator - 25 * numerator) / denominator) / ((1.0 + s) * (3.0 + 5.0 * s))


def pinning_error(eta: float) -> float | None:
    """Return a bound on the error of c_pin(η) or, for η > 2/25, of c_retreat(η).

    It includes rounding and the effect of half a unit in the last place of η, by which a decimal η
    may have been rounded.

    Examples
    --------
    >>> pinning_error(0.03125) < 1e-14 < 1e-3 < pinning_error(0.079999)
    True
    """
    eta = bistable_eta(eta)
    coupling_at = pinning_coupling if eta < ETA_PIN_END else retreat_coupling
    value = coupling_at(eta)
    if value is None:
        return None
    neighbours = [coupling_at(math.nextafter(eta, limit)) for limit in (0.0, ETA_END)]
    half_difference = max(0.5 * abs(each - value) for each in neighbours if each is not None)
    return half_difference + 16.0 * EPS * value


def retreat_coupling(eta: float) -> float | None:
    """Return the coupling above which the excited state retreats; None for η ≤ 2/25.

    Static fronts also cease to exist where the site behind the front falls below the threshold:
    |2 + Σ(0⁺, c)| = |1 + 1/√(1 - 4ic)| = 2r, which gives (4r² - 1)p² - p - 2r² = 0 and again
    c = ½ p √(p² - 1). The paper does not mention this limit.

    Examples
    --------
    >>> c = retreat_coupling(0.11)
    >>> abs(abs(2 + static_sum(c)) - 2 * threshold_ratio(0.11)) < 1e-14
    True
    """
    eta = bistable_eta(eta)
    r2, gap = threshold_ratio(eta) ** 2, -_ratio_gap(eta)
    if eta <= ETA_PIN_END:  # 0.08 means 2/25, though the binary number lies above it
        return None
    # p - 1, with 1 - r² = 2s/(1 + s), s = √(1 - 8η), to avoid cancellation at r near 1
    s, root = math.sqrt(1.0 - 8.0 * eta), math.sqrt(1.0 + 8.0 * r2 * gap)
    excess = 4.0 * s / ((1.0 + s) * gap * (1.0 + 4.0 * r2 / (1.0 + root)))
    return 0.5 * (1.0 + excess) * math.sqrt(excess * (2.0 + excess))


@with_ranges(couplings=COUPLINGS)
def pinning_eta(c: float) -> float:
    """Return η_pin(c), the inverse of :func:`pinning_coupling`: static fronts exist above it.

    Raises
    ------
    ParameterError
        If the coupling is not {couplings}.

    Examples
    --------
    >>> abs(pinning_eta(pinning_coupling(0.05)) - 0.05) < 1e-15
    True
    """
    return eta_from_ratio(0.5 * abs(static_sum(within("coupling c", c, *COUPLINGS))))


def strong_coupling_sum(x: npt.ArrayLike) -> ComplexArray:
    """Return lim Σ(x√c, c) as c → ∞: 1/(q(iq - x)) with q = √(i - x²), Re q > 0.

    With k = κ/√c, (50) becomes -iκ²/2 - ixκ + ½ = 0, whose root above the axis is κ = -x + iq.
    """
    x_ = np.asarray(x, dtype=complex)
    q = np.sqrt(1j - x_ * x_)
    result: ComplexArray = 1.0 / (q * (1j * q - x_))
    return result


def strong_coupling_velocity(eta: float) -> float | None:
    """Return V(η) with v ≈ V √c as c → ∞: |q (x - iq)| = 1/(2r), q = √(i - x²), at x = V.

    With Q = |q|² = √(1 + x⁴), the square of this equation is 1 + x⁴ + Q(x² + 2x Im q) = 1/(4r²).
    The terms other than 1 are positive and grow with x, so that V is accurate to rounding up to η =
    2/25, where it vanishes.

    Parameters
    ----------
    eta : float
        η = b/a², 0 < η ≤ 1/8.

    Returns
    -------
    float or None
        V, dimensionless; None for η ≥ 2/25, where no front travels as c → ∞.

    Examples
    --------
    >>> V = strong_coupling_velocity(0.03125)
    >>> bool(abs(abs(strong_coupling_sum(V)) - 2 * threshold_ratio(0.03125)) < 1e-13)
    True
    """
    eta = bistable_eta(eta)
    twice_r, gap = 2.0 * threshold_ratio(eta), _ratio_gap(eta)
    if eta >= ETA_PIN_END:
        return None

    def exceeds(x: float) -> bool:
        square = x * x
        modulus = math.hypot(1.0, square)
        linear = square + 2.0 * x * math.sqrt(0.5 * (modulus + square))
        # 4r² times the terms other than 1; each product is of moderate size where r is tiny
        return (twice_r * square) ** 2 + (twice_r * modulus) * (twice_r * linear) > gap

    low, high = 0.0, 1.0
    while not exceeds(high):
        high *= 2.0
    while high - low > 4.0 * EPS * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if exceeds(middle) else (middle, high)
    return 0.5 * (low + high)


def weak_threshold_velocity(c: float, eta: float) -> float:
    """Return v ≈ √(c/(8r)), the limit η → 0 at fixed c.

    As v → ∞, A² ≈ ¼ - ick²/2 in the real-line integral, which gives Σ ≈ ic/(4v²). The limits do not
    commute: if c → ∞ first, V(η) ≈ 1/(2√r), and the velocity is √2 times larger.

    Examples
    --------
    >>> round(weak_threshold_velocity(0.5, 1e-10), 3)
    66.479
    """
    return math.sqrt(positive("coupling c", c) / (8.0 * threshold_ratio(eta)))


def resonant_velocities(c: float | FloatArray, number: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the velocities at which the front is in resonance with a linear wave, and the widths.

    At v = c max_k (1 - cos k)/(k + 2πj), j = 0, 1, …, two roots of opposite half-planes nearly
    meet, and |Σ| has a peak of half-width about 1/(2(k + 2πj)), which is narrow at large c.

    Parameters
    ----------
    c : float or ndarray of float
        Coupling.
    number : ndarray of int
        The number j of each resonance; their velocities descend.

    Examples
    --------
    >>> resonant_velocities(100.0, np.arange(2))[0].round(4).tolist()
    [72.4611, 21.4661]
    """
    # At the maximum x = k + 2πj obeys x = 2πj + 2 arctan x, and (1 - cos k)/x = 2x/(1 + x²).
    turns = 2.0 * np.pi * number.astype(float)
    x = turns + 2.4
    for _ in range(4):
        square = 1.0 + x * x
        x = x - (x - turns - 2.0 * np.arctan(x)) * square / (square - 2.0)
    return c * (2.0 * x / (1.0 + x * x)), 0.5 / x


def resonance_number(ratio: FloatArray) -> FloatArray:
    """Return the number j, not rounded, of the resonance at v/c = ``ratio``: 2x/(1 + x²) = v/c.

    It is negative where v is above that of every resonance.

    Examples
    --------
    >>> v, _ = resonant_velocities(3.0, np.array([0, 5]))
    >>> resonance_number(v / 3.0).round(9).tolist()
    [0.0, 5.0]
    """
    ratio = np.minimum(ratio, 1.0)
    x = (1.0 + np.sqrt(1.0 - ratio * ratio)) / ratio
    return (0.5 * x - np.arctan(x)) / np.pi
