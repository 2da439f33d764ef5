"""The result of every method for Σ(v, c) = Σ_{k ∈ M⁺} 1/(k L_k), the left side of (53).

Four methods compute it in floating point, and ``theory.piecewise.certified_sum`` in ball
arithmetic:

* ``theory.piecewise.sums.integral``: the periodised integral by the trapezoidal rule, which is the
  fastest method, and ``theory.piecewise.sums.precise``, the same to any precision;
* ``theory.piecewise.sums.series``: the printed series over the roots with its tail summed, at any
  precision;
* ``theory.piecewise.sums.bessel``: a series of Bessel-function integrals, from the direct solution
  in time;
* ``theory.piecewise.sums.quadrature``: adaptive quadrature on the real line, the simplest method.

The last two share no code with the others or with each other. Beyond double precision the first two
use the same solver for roots, since the integral is then corrected for poles near its contour.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from theory.parameters import Range
from theory.result import Result

DOUBLE = 15
"""Largest number of digits for which a value is computed in double precision."""

DIGITS = Range(1, 2000)
"""Range of the number of digits that may be required of a root or a sum."""


@dataclass(frozen=True, kw_only=True)
class KineticSum(Result):
    """One value of Σ(v, c).

    Attributes
    ----------
    value : complex or mpmath.mpc
        Σ, dimensionless.
    error : float or mpmath.mpf
        Bound on |value - Σ|; an mpf where it is too small for a float.
    terms : int
        Number of roots summed, or of points at which an integrand was evaluated.
    method : str
        Name of the method.
    seconds : float
        Wall time.
    digits : int
        Digits after the point with which `to_dict` writes ``re`` and ``im``; beyond 15, as strings.
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
        """Error of the value as written: ``error`` plus one unit in the last of its ``digits``."""
        if self.digits <= DOUBLE:
            return self.error
        import mpmath as mp

        return stated(self.error + mp.mpf(10) ** -self.digits)

    def _number(self, value: Any) -> float | str:
        return float(value) if self.digits <= DOUBLE else decimals(value, self.digits)


def decimals(value: Any, digits: int) -> str:
    """Return an mpmath number in decimal notation, rounded to ``digits`` significant digits.

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
    """Return an mpmath error as a float, or unchanged where the float would be zero or subnormal.

    Examples
    --------
    >>> import mpmath as mp
    >>> stated(mp.mpf(10) ** -30), stated(mp.mpf(10) ** -400) > 0
    (1e-30, True)
    """
    number = float(error)
    return number if number >= 1e-300 or error == 0 else error


def in_powers(error: Any) -> str:
    """Return an error, however small, as two digits and a power of ten, rounded up.

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
    """Raised where a method cannot reach the tolerance at given parameters; suggests a remedy."""
