"""What a method returns for Σ(v, c) = Σ_{k ∈ M⁺} 1/(k L_k), the left side of (53).

Four methods give it in floating point, and ``theory.piecewise.certified_sum`` in ball arithmetic:

* ``theory.piecewise.sums.integral``: the periodised integral by the trapezoidal rule, the fast one,
  and ``theory.piecewise.sums.precise``, the same to any precision;
* ``theory.piecewise.sums.series``: the printed series over the roots, its tail summed, at any
  precision;
* ``theory.piecewise.sums.bessel``: a series of Bessel-function integrals, from the direct solution
  in time;
* ``theory.piecewise.sums.quadrature``: adaptive quadrature on the real line, the plain baseline.

The last two share no code with the others or with each other. The first two share the solver for
roots beyond double precision, where the integral is corrected for poles beside its contour.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from theory.result import Result

DOUBLE = 15
"""Digits up to which a value is one in double precision."""

MAX_DIGITS = 2000
"""Digits that may be required of a root or a sum."""


@dataclass(frozen=True, kw_only=True)
class KineticSum(Result):
    """One value of Σ(v, c).

    Attributes
    ----------
    value : complex or mpmath.mpc
        Σ, dimensionless.
    error : float or mpmath.mpf
        Bound on |value - Σ|; no float where it is below the smallest one.
    terms : int
        Roots summed, or points at which an integrand was evaluated.
    method : str
        How it was computed.
    seconds : float
        Wall time.
    digits : int
        Digits after the point in which `to_dict` writes ``re`` and ``im``: as strings beyond 15.
    """

    value: Any
    error: Any
    terms: int
    method: str
    seconds: float
    digits: int = field(default=DOUBLE, metadata={"json": None})

    def to_dict(self) -> dict[str, Any]:
        """Return re, im, error, terms, method and seconds; see `Result.to_dict`."""
        error = self.error_as_written
        return {
            "re": self._number(self.value.real),
            "im": self._number(self.value.imag),
            "error": error if isinstance(error, float) else in_powers(error),
            "terms": self.terms,
            "method": self.method,
            "seconds": self.seconds,
        }

    @property
    def error_as_written(self) -> Any:
        """Error of the value written in ``digits`` decimals, which costs one of the last."""
        if self.digits <= DOUBLE:
            return self.error
        import mpmath as mp

        return stated(self.error + mp.mpf(10) ** -self.digits)

    def _number(self, value: Any) -> float | str:
        return float(value) if self.digits <= DOUBLE else decimals(value, self.digits)


def decimals(value: Any, digits: int) -> str:
    """Return a number of mpmath in decimal notation, rounded to so many significant digits.

    Examples
    --------
    >>> import mpmath as mp
    >>> decimals(mp.mpf(1) / 4, 5)
    '0.25000'
    """
    import mpmath as mp

    with mp.workdps(digits + 5):
        return str(mp.nstr(value, digits, strip_zeros=False))


def stated(error: Any) -> Any:
    """Return an error of mpmath as a float, or as it is where that would be zero or subnormal.

    Examples
    --------
    >>> import mpmath as mp
    >>> stated(mp.mpf(10) ** -30), stated(mp.mpf(10) ** -400) > 0
    (1e-30, True)
    """
    number = float(error)
    return number if number >= 1e-300 or error == 0 else error


def in_powers(error: Any) -> str:
    """Return an error in two digits and a power of ten, however small, rounded up.

    Examples
    --------
    >>> import mpmath as mp
    >>> in_powers(mp.mpf("1.01e-402")), in_powers(1e-13), in_powers(0.0)
    ('1.1e-402', '1.0e-13', '0.0e+00')
    """
    if isinstance(error, float):
        return f"{error:.1e}"
    import mpmath as mp

    power = int(mp.floor(mp.log10(error)))
    tenths = int(mp.ceil(error / mp.mpf(10) ** (power - 1)))
    if tenths == 100:
        tenths, power = 10, power + 1
    return f"{tenths // 10}.{tenths % 10}e{power:+03d}"


class PrecisionError(ArithmeticError):
    """A tolerance that a method cannot reach at these parameters; says what to use instead."""
