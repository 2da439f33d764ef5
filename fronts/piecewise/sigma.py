"""The sum of the kinetic relation, by five methods (Eq. 53)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from theory.arrays import EPS
from theory.parameters import ParameterError, count_within, decimal, with_ranges, word
from theory.piecewise.sums.result import DIGITS, DOUBLE, KineticSum, PrecisionError


@with_ranges(digits=DIGITS)
def sigma(
    v: float | str,
    c: float | str,
    *,
    method: Literal["integral", "series", "bessel", "quadrature", "certified"] = "integral",
    digits: int = 12,
) -> KineticSum:
    """Return Σ(v, c), the left side of the kinetic relation (Eq. 53).

    Parameters
    ----------
    v : float or str
        Front velocity v̂ > 0, dimensionless; a string is read as a decimal with all its digits.
    c : float or str
        Coupling c > 0, dimensionless; a string is read as a decimal with all its digits.
    method : {"integral", "series", "bessel", "quadrature", "certified"}, optional
        Integral: an integral over one period, by the trapezoidal rule; series: the printed series
        over the roots, with its tail summed; bessel: a series of Bessel functions, in double
        precision; quadrature: adaptive quadrature on the real line, in double precision; certified:
        the integral in ball arithmetic, with a proven error (needs the extra certify).
    digits : int, optional
        Required digits after the point, {digits}.

    Returns
    -------
    KineticSum
        ``value``, its ``error`` bound, ``terms``, ``method`` and ``seconds``; beyond 15 digits the
        value is an mpmath number.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or the method never reaches this number of digits.
    PrecisionError
        If the method cannot reach this number of digits at these parameters.

    References
    ----------
    Trefethen, L. N. & Weideman, J. A. C. (2014), SIAM Review 56, 385: the trapezoidal rule.

    Examples
    --------
    >>> import fronts as fr
    >>> found = fr.sigma(0.3, 0.5)
    >>> bool(abs(found.value - (-0.28879675619025 + 0.45226875874939j)) < 1e-12)
    True
    """
    v, c = decimal("velocity v", v), decimal("coupling c", c)
    word("method", method, _SUMS)
    digits = count_within("digits", digits, *DIGITS)
    within_double = digits <= 13 or method in ("integral", "series", "certified")
    if not within_double:
        raise ParameterError(
            "digits", digits, f"at most 13 for {method}, which works in double precision",
            "ask for fewer, or take the method integral or series",
        )  # fmt: skip
    try:
        return _SUMS[method](v, c, digits)
    except ParameterError:
        raise
    except ArithmeticError as refusal:
        raise PrecisionError(str(refusal)) from None


def _by_series(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.sums.series import sum_by_roots

    found = sum_by_roots(v, c, digits)
    if digits > DOUBLE or found.error <= 10.0**-digits:
        return found
    return _rounded(sum_by_roots(v, c, DOUBLE + 1))


def _by_integral(v: float | str, c: float | str, digits: int) -> KineticSum:
    if digits <= DOUBLE:
        from theory.piecewise.sums.integral import sum_by_integral

        tolerance = 0.5 * 10.0**-digits if digits < DOUBLE else 1e-15
        found = sum_by_integral(float(v), float(c), tolerance)
        if found.error <= 10.0**-digits:
            return found
    from theory.piecewise.sums.precise import precise_sum_by_integral

    found = precise_sum_by_integral(v, c, digits)
    return found if digits > DOUBLE else _rounded(found)


def _by_bessel(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.sums.bessel import sum_by_bessel

    return sum_by_bessel(float(v), float(c), 10.0**-digits)


def _by_quadrature(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.sums.quadrature import sum_by_quadrature

    return sum_by_quadrature(float(v), float(c), 0.1 * 10.0**-digits)


def _certified_sum(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.certified_sum import certified_sum

    return certified_sum(v, c, digits)


def _rounded(found: KineticSum) -> KineticSum:
    """Return a precise sum rounded to double precision; its error includes the rounding."""
    value = complex(found.value)
    error = float(found.error) + abs(value) * EPS
    return replace(found, value=value, error=float(error), digits=DOUBLE)


_SUMS: dict[str, Callable[[float | str, float | str, int], KineticSum]] = {
    "integral": _by_integral,
    "series": _by_series,
    "bessel": _by_bessel,
    "quadrature": _by_quadrature,
    "certified": _certified_sum,
}
