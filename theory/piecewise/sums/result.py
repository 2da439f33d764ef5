"""What a method returns for Σ(v, c) = Σ_{k ∈ M⁺} 1/(k L_k), the left side of (53).

Four methods give it:

* ``theory.piecewise.sums.integral``: the periodised integral by the trapezoidal rule, the fast one;
* ``theory.piecewise.sums.series``: the printed series over the roots, its tail summed, at any
  precision;
* ``theory.piecewise.sums.bessel``: a series of Bessel-function integrals, from the direct solution
  in time;
* ``theory.piecewise.sums.quadrature``: adaptive quadrature on the real line, the plain baseline.

The last two share no code with the others or with each other. The first two share the solver for
roots, where the integral has to know how near a pole comes to its contour.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class KineticSum:
    """One value of Σ(v, c).

    Attributes
    ----------
    value : complex or mpmath.mpc
        Σ, dimensionless.
    error : float
        Bound on |value - Σ|.
    terms : int
        Roots summed, or points at which an integrand was evaluated.
    method : str
        How it was computed.
    seconds : float
        Wall time.
    """

    value: Any
    error: float
    terms: int
    method: str
    seconds: float


class PrecisionError(ArithmeticError):
    """A tolerance that a method cannot reach at these parameters; says what to use instead."""
