"""Operations on a dispersion relation: the largest group velocity, and the envelope of a wave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import sympy as sp

from derivations.algebra.equations import equation, parts_of
from derivations.algebra.operations import Operation, OperationError


@dataclass(frozen=True)
class FastestWave(Operation):
    """Find the wave of largest group velocity, for which the second derivative vanishes.

    The sources are the derivatives and the dispersion relation ``omega² = D(cos k)``. With
    ``omega'' = 0`` the second derivative of the relation gives the square of the group velocity.

    Attributes
    ----------
    frequency, wavenumber : Symbol
        omega and k.
    """

    phrase: ClassVar[str] = (
        "set the second derivative of the frequency in {first} to zero, with {others}, and keep "
        "the root with |cos {wavenumber}| < 1"
    )
    frequency: sp.Symbol
    wavenumber: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``cos k = root``."""
        derivatives, relation = sources
        first, second = parts_of(derivatives)[:2]
        cosine = sp.Dummy("C")
        second_derivative = second.rhs.subs(first.lhs, first.rhs) * self.frequency**3
        second_derivative = sp.expand(second_derivative).subs(self.frequency, sp.sqrt(relation.rhs))
        k = self.wavenumber
        polynomial = sp.expand(
            sp.expand_trig(sp.expand(second_derivative)).subs(sp.sin(k) ** 2, 1 - sp.cos(k) ** 2)
        )
        polynomial = sp.expand(polynomial.subs(sp.cos(k), cosine))
        if polynomial.has(k) or sp.degree(polynomial, cosine) > 2:
            raise OperationError("the fastest wave has no closed form")
        admissible = [root for root in sp.solve(polynomial, cosine) if _is_cosine(root)]
        if len(admissible) != 1:
            raise OperationError("not one wave of largest group velocity")
        return equation(sp.cos(k), admissible[0])


def _is_cosine(root: sp.Expr) -> bool:
    """Whether the modulus is below one, at several values of all parameters."""
    symbols = sorted(root.free_symbols, key=str)
    trials = [{symbol: scale * (1 + place / 7) for place, symbol in enumerate(symbols)}
              for scale in (0.03, 0.4, 3.0)]  # fmt: skip
    return all(abs(complex(root.subs(trial).evalf())) < 1 for trial in trials)


@dataclass(frozen=True)
class AtFastestWave(Operation):
    """Evaluate a derivative of the frequency at the wave of largest group velocity.

    The sources are the derivatives, the dispersion relation and the cosine of the wave. A square
    root in the cosine is replaced by a parameter, so that the radicands of further roots become
    squares.

    Attributes
    ----------
    frequency, wavenumber : Symbol
        omega and k.
    """

    frequency: sp.Symbol
    wavenumber: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = value`` for the first and the third derivative, k between 0 and pi."""
        derivatives, relation, fastest = sources
        first, second, third = parts_of(derivatives)
        k = self.wavenumber
        root = fastest.rhs
        radical, parameter, by_parameter, smallest = _parametrised(root)
        cosine = sp.factor(root.subs(by_parameter))
        square = sp.factor(sp.expand_trig(first.rhs**2 * self.frequency**2).subs(
            sp.sin(k) ** 2, 1 - sp.cos(k) ** 2).subs(sp.cos(k), cosine).subs(by_parameter)
            / relation.rhs.subs(sp.cos(k), cosine).subs(by_parameter))  # fmt: skip
        excess = sp.Dummy("x", positive=True)
        above = sp.sqrt(sp.factor(square.subs(parameter, smallest + excess)))
        speed = above.subs(excess, parameter - smallest)
        if not speed.is_rational_function(parameter):
            raise OperationError("the group velocity is not rational in the radical")
        group_velocity = equation(first.lhs, sp.factor(speed).subs(parameter, radical))
        # At the flat point the second derivative is zero, so the third follows from the first.
        third_derivative = third.rhs.subs(second.lhs, 0)
        ratio = sp.simplify(third_derivative / first.rhs)
        return sp.Tuple(group_velocity, equation(third.lhs, sp.expand(ratio * group_velocity.rhs)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the wave."""
        return f"evaluate {labels[0]} at the wave {labels[2]}, with {labels[1]}"


def _parametrised(root: sp.Expr) -> tuple[sp.Expr, sp.Symbol, dict[sp.Basic, sp.Expr], sp.Expr]:
    """Return the square root in an expression, a symbol s for it, a parameter, and the least s.

    The square root grows with this positive parameter, which is replaced by a function of s.
    """
    radicals = [q for q in root.atoms(sp.Pow) if q.exp == sp.Rational(1, 2)]
    if len(radicals) != 1:
        raise OperationError("not one square root in the cosine of the wave")
    parameter = sp.Dummy("s")
    radicand = radicals[0].base
    eliminated = sorted(radicand.free_symbols, key=str)[0]
    (value,) = sp.solve(radicand - parameter**2, eliminated)
    return radicals[0], parameter, {eliminated: value}, sp.sqrt(radicand.subs(eliminated, 0))


@dataclass(frozen=True)
class EnvelopeOfWave(Operation):
    """Expand about a carrier whose wave number is nearly that of the wave: a differential equation.

    The carrier is at a stationary point of the group velocity. The frequency is expanded to third
    order in the difference K, and K stands for ``-i d/dx`` acting on the envelope. The second
    source gives the local rate of the envelope.

    Attributes
    ----------
    envelope : Expr
        A function of x and t.
    position, time : Symbol
        x and t.
    coefficients : tuple of Expr
        First, second and third derivative of the frequency at the carrier.
    """

    phrase: ClassVar[str] = (
        "expand the frequency about the fastest wave to third order, write the distance of the "
        "wavenumber as -i∂/∂{position} on the envelope, and add the local rate of {sources}"
    )
    envelope: sp.Expr
    position: sp.Symbol
    time: sp.Symbol
    coefficients: tuple[sp.Expr, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the rate of the envelope: dispersion and local rate."""
        (local,) = sources
        rate = sp.S.Zero
        for order, coefficient in enumerate(self.coefficients, start=1):
            derivative = (-sp.I) ** order * self.envelope.diff((self.position, order))
            rate -= sp.I * coefficient / sp.factorial(order) * derivative
        return equation(self.envelope.diff(self.time), sp.expand(rate) + local.rhs)
