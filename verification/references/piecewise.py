"""The front of (44) by scipy and mpmath alone: Σ as one quadrature, L, the static limit and r.

Functions take mpmath numbers and work at the current precision of mpmath, unless stated otherwise.
"""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np


def sum_by_quadrature(
    v: float, c: float, tolerance: float | None = None, limit: int = 50
) -> tuple[complex, float]:
    """Return Σ = -1 + (v/π) ∫₀^∞ dk/(A² + v²k²) of (53) by one call of ``scipy.integrate.quad``.

    Parameters
    ----------
    v, c : float
        Velocity and coupling, positive, dimensionless.
    tolerance : float, optional
        Absolute tolerance of the integral; by default that of scipy.
    limit : int
        Largest number of subintervals.

    Returns
    -------
    complex, float
        Σ, and the error that scipy states.

    Examples
    --------
    >>> value, error = sum_by_quadrature(0.3, 0.5, 1e-8, 1000)
    >>> complex(round(value.real, 6), round(value.imag, 6)), error < 1e-8
    ((-0.288797+0.452269j), True)
    """
    from scipy.integrate import quad

    def integrand(k: float) -> complex:
        onsite = 0.5 - 1j * c * (1.0 - math.cos(k))
        return 1.0 / (onsite * onsite + v * v * k * k)

    options: dict[str, Any] = {} if tolerance is None else {"epsabs": tolerance, "epsrel": 0.0}
    value, stated = quad(integrand, 0.0, math.inf, complex_func=True, limit=limit, **options)
    return complex(value) * v / math.pi - 1.0, abs(complex(stated)) * v / math.pi


def sum_on_the_line(v: float, c: float) -> tuple[complex, float]:
    """Return Σ = -1 + (v/π) ∫₀^∞ dk/(A² + v²k²) by scipy's quadrature, and a bound on its error.

    A = ½ - ic(1 - cos k). The integral is taken over one period of A at a time; beyond the last, at
    K, the remainder is 1/(v²K) to within max|A|²/(3v⁴K³).
    """
    from scipy.integrate import quad

    def integrand(k: float) -> complex:
        onsite = 0.5 - 1j * c * (1.0 - np.cos(k))
        return complex(1.0 / (onsite**2 + (v * k) ** 2))

    total, error, periods = 0j, 0.0, 400
    for n in range(periods):
        value, off = quad(integrand, 2.0 * np.pi * n, 2.0 * np.pi * (n + 1), complex_func=True,
                          epsabs=1e-13, epsrel=1e-12)  # fmt: skip
        total, error = total + value, error + abs(off)
    end = 2.0 * np.pi * periods
    rest = (0.25 + 4.0 * c**2) / (3.0 * v**4 * end**3)
    return -1.0 + v / np.pi * (total + 1.0 / (v**2 * end)), v / np.pi * (error + rest)


def dispersion(v: Any, c: Any, k: Any, cos: Any = mp.cos) -> Any:
    """Return L(k) = 1/2 - ic(1 - cos k) - ivk of (50)."""
    return 0.5 - 1j * c * (1 - cos(k)) - 1j * v * k


def dispersion_slope(v: Any, c: Any, k: Any, sin: Any = mp.sin) -> Any:
    """Return L'(k) = -i(v + c sin k)."""
    return -1j * (v + c * sin(k))


def static_sum(c: Any) -> Any:
    """Return the limit of Σ as v → 0, -1 + 1/√(1 - 4ic)."""
    return -1 + 1 / mp.sqrt(1 - 4j * c)


def threshold_ratio(eta: Any) -> Any:
    """Return r = √[(1 - s)/(1 + s)], s = √(1 - 8η), directly from the two cycles."""
    with mp.workdps(mp.mp.dps + 40):  # 1 - s loses as many digits as η has leading zeros
        s = mp.sqrt(1 - 8 * mp.mpf(eta))
        return mp.sqrt((1 - s) / (1 + s))
