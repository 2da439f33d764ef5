"""Roots of (50) to any number of digits, by Newton's method in mpmath from the labelled roots."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np

from theory.arrays import IntArray
from theory.parameters import count_within
from theory.piecewise.roots import checked_velocity_and_coupling, labelled_roots
from theory.piecewise.sums.result import DIGITS

GUARD_DIGITS = 100
"""Number of digits beyond ``DIGITS`` with which a sum may compute its roots."""


def exact(value: float | str | mp.mpf) -> mp.mpf:
    """Return the number at the current precision; a string is read as a decimal, a float as binary.

    Examples
    --------
    >>> with mp.workdps(30):
    ...     print(exact("0.3"), exact(0.3))
    0.3 0.299999999999999988897769753748
    """
    return mp.mpf(value if isinstance(value, (str, mp.mpf)) else float(value))


def precise_roots(
    v: float | str | mp.mpf, c: float | str | mp.mpf, labels: IntArray, upper: bool, digits: int
) -> list[mp.mpc]:
    """Return the roots in the strips ``labels``, each to ``digits`` significant digits.

    Parameters
    ----------
    v, c : float, str or mpf
        Front velocity v̂ and coupling, dimensionless; strings are read as decimals.
    labels : ndarray of int
        Strip numbers (``theory.piecewise.roots``).
    upper : bool
        Half-plane.
    digits : int
        From 1 to 2000, or up to 2100 for sums, which compute more digits than they return.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    """
    digits = count_within("digits", digits, DIGITS.low, DIGITS.high + GUARD_DIGITS)
    with mp.workdps(digits + 10):
        start = labelled_roots(*checked_velocity_and_coupling(v, c), labels, upper)
        v_, c_ = exact(v), exact(c)
        return [refine_root(mp.mpc(k), v_, c_) for k in np.atleast_1d(start.k).tolist()]


def refine_root(k: mp.mpc, v: mp.mpf, c: mp.mpf) -> mp.mpc:
    """Return the root near ``k`` to the current precision, doubling the digits at each step."""
    target = mp.mp.dps
    digits = 15
    while True:
        digits = min(2 * digits, target)
        with mp.workdps(digits + 5):
            sine = mp.sin(k / 2)
            value: Any = mp.mpf(0.5) - 2j * c * sine**2 - 1j * v * k
            step = value / (-1j * (v + 2 * c * sine * mp.cos(k / 2)))
            k = k - step
        if digits == target and abs(step) <= mp.mpf(10) ** (-(target // 2)) * abs(k):
            return +k
