"""The dispersion relation of the piecewise-linear front (Eqs. 50, 51) and where its roots can lie.

Here ``v`` is the paper's v̂ = v/ε and ``c`` the coupling. Everything else is based on five facts.
With k = x + iy, L(k) = 0 is the pair

    Re L = ½ + c sin x sinh y + v y = 0,        Im L = -c (1 - cos x cosh y) - v x = 0.

1. No root is real: on the real axis Re L = ½.
2. No root is double for v, c > 0: L_k = -i (v + c sin k) = 0 makes sin k = -v/c real, so k is real
   (excluded by 1) or k = -π/2 + 2πn + iy with cosh y = v/c. There cos k = -i sin x sinh y is
   imaginary and Im L = -c - v x = 0 fixes x = -c/v = -sech y, which lies in [-1, 0) and is not of
   the form -π/2 + 2πn.
3. Above the real axis no root ever lies on a line x = nπ, since there Re L = ½ + v y > 0. As v and
   c vary continuously no root can therefore enter or leave a strip, nor escape to i∞ (|cos k|
   grows exponentially). As v → 0 each strip 2πn - π < x < 2πn holds one root and each strip
   2πn < x < 2πn + π none. Hence this holds for all v, c > 0.
4. Below the real axis Re L on x = nπ vanishes only at y = -1/(2v), and then Im L = 0 needs
   v x = c (cosh y - 1) > 0 for even n, v x = -c (1 + cosh y) < 0 for odd n. So the lines x = 2πn,
   n ≤ 0, and x = (2n + 1)π > 0 are never crossed, and by the same continuity each strip
   …, (-4π, -2π), (-2π, 0), (0, π), (π, 3π), (3π, 5π), … holds exactly one root.
5. If L(k) = 0 then c sinh|y| + v|y| ≥ ½. The positive solution s of c sinh s + v s = ½ is a strip
   |Im k| < s free of roots.

Facts 3 and 4 give every root a label n that never changes. ``theory.piecewise.root_count`` checks
them by the argument principle, ``derivations.front`` in symbols.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from theory.arrays import AnyArray, ComplexArray, FloatArray


def onsite(k: ComplexArray, c: float | FloatArray) -> ComplexArray:
    """Return A(k) = ½ - i c (1 - cos k), the part of (50) that does not depend on the velocity.

    Parameters
    ----------
    k : ndarray of complex
        Wave numbers per site, any shape.
    c : float
        Coupling, dimensionless.
    """
    return 0.5 - 2j * c * np.sin(0.5 * k) ** 2


def dispersion(k: ComplexArray, v: float | FloatArray, c: float | FloatArray) -> ComplexArray:
    """Return L(k) of Eq. (50), as printed.

    Parameters
    ----------
    k : ndarray of complex
        Wave numbers per site, any shape.
    v, c : float
        Front velocity v̂ (sites per unit εt) and coupling, dimensionless.

    Examples
    --------
    >>> complex(dispersion(np.array(0.0 + 0j), 0.3, 0.5))
    (0.5+0j)
    """
    return onsite(k, c) - 1j * v * k


def dispersion_slope(k: ComplexArray, v: float | FloatArray, c: float | FloatArray) -> ComplexArray:
    """Return L_k(k) = dL/dk = -i (v + c sin k).

    In Equation (51) as printed, -1/(2k) + (2ic/k) sin²(k/2) - i c sin k, v has been eliminated by
    means of L(k) = 0; it equals dL/dk on the roots and nowhere else.
    """
    slope: AnyArray = v + c * np.sin(k)
    return -1j * slope


def root_free_strip(v: Any, c: Any, steps: int = 4) -> Any:
    """Return s > 0 with c sinh s + v s = ½; no root of (50) has |Im k| < s.

    Parameters
    ----------
    v, c : float, or ndarray of float, shape (n,)
        Front velocity v̂ and coupling, positive, dimensionless, both numbers or both arrays.
    steps : int
        Steps of Halley's method: after two, s is at most a thousandth too large; after four it is
        known to rounding.

    Returns
    -------
    float or ndarray
        Half-width of the strip, per site; rounding never makes it larger than the true one.

    Examples
    --------
    >>> s = root_free_strip(0.3, 0.5)
    >>> bool(abs(0.5 * np.sinh(s) + 0.3 * s - 0.5) < 1e-13)
    True
    """
    xp, minimum = (np, np.minimum) if isinstance(v, np.ndarray) else (math, min)
    s = minimum(0.5 / (c + v), xp.log1p(1.0 / c))
    for _ in range(steps):
        sinh_term, derivative = c * xp.sinh(s), c * xp.cosh(s) + v
        value = sinh_term + v * s - 0.5
        s = s - value * derivative / (derivative * derivative - 0.5 * value * sinh_term)
    return s * (1.0 - 1e-14)
