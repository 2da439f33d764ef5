"""Fourier transform of an advance-delay equation, residues, and integrals over a period."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import sympy as sp

from derivations.algebra.equations import equation, left_minus_right, parts_of
from derivations.algebra.operations import Operation, OperationError
from derivations.algebra.sums import SumOver


@dataclass(frozen=True)
class FourierTransform(Operation):
    """Transform a linear advance-delay equation: ``F(k) = integral of f(z) e^{-ikz} dz``.

    A derivative becomes a factor ik and a shift by s a factor ``e^{iks}``; the transform of a given
    term is integrated where it converges. For a step at ``z < 0`` this is ``Im k > 0``.

    Attributes
    ----------
    coordinate, wavenumber : Symbol
        z and k.
    profile, transformed : function class
        The unknown and its transform.
    """

    phrase: ClassVar[str] = (
        "Fourier-transform {sources} in {coordinate}, with Im {wavenumber} > 0 and below the first "
        "root, where the step has a transform"
    )
    coordinate: sp.Symbol
    wavenumber: sp.Symbol
    profile: sp.FunctionClass
    transformed: sp.FunctionClass

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the transformed equation, with the terms of the unknown on the left."""
        (source,) = sources
        known, unknown = sp.S.Zero, sp.S.Zero
        for term in sp.Add.make_args(sp.expand(left_minus_right(source))):
            factor, dependent = term.as_independent(self.coordinate, as_Add=False)
            found = factor * self._of(dependent)
            if found.has(self.transformed):
                unknown += found
            else:
                known -= found
        return equation(sp.collect(unknown, self.transformed(self.wavenumber)), known)

    def _of(self, dependent: sp.Expr) -> sp.Expr:
        z, k = self.coordinate, self.wavenumber
        if isinstance(dependent, sp.Derivative):
            return (sp.I * k) ** dependent.derivative_count * self._of(dependent.expr)
        if dependent.func == self.profile:
            return sp.exp(sp.I * k * sp.expand(dependent.args[0] - z)) * self.transformed(k)
        if dependent.has(self.profile):
            raise OperationError(f"{dependent} is not linear in the profile")
        # e^{-ikz} = e^{sz}: positive s first, then s = -ik by continuation within Im k > 0.
        s = sp.Dummy("s", positive=True)
        found = sp.integrate(dependent * sp.exp(s * z), (z, -sp.oo, sp.oo))
        if found.has(sp.Integral) or not found.is_finite:
            raise OperationError(f"the transform of {dependent} does not converge for Im k > 0")
        return sp.simplify(found).subs(s, -sp.I * k)


@dataclass(frozen=True)
class InvertTransform(Operation):
    """Write the inverse transform as a contour integral.

    Attributes
    ----------
    coordinate, wavenumber : Symbol
        z and k.
    profile : Expr
        The function that was transformed.
    """

    phrase: ClassVar[str] = (
        "invert the transform {sources}, on a line between the real axis and the first root above "
        "it"
    )
    coordinate: sp.Symbol
    wavenumber: sp.Symbol
    profile: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``profile = integral of F(k) e^{ikz} dk / 2 pi``."""
        (source,) = sources
        wave = sp.exp(sp.I * self.wavenumber * self.coordinate)
        return equation(self.profile, sp.Integral(source.rhs * wave / (2 * sp.pi), self.wavenumber))


def residue_at_root(integrand: sp.Expr, symbol: sp.Expr, slope: sp.Symbol) -> sp.Expr:
    """Return the residue where a function in the denominator has a simple zero.

    Parameters
    ----------
    integrand : Expr
        The integrand.
    symbol : Expr
        The function, ``L(k)``; in the result k is the root.
    slope : Symbol
        Name of the derivative of the function at the root.
    """
    distance = sp.Dummy("d")
    scaled = integrand.xreplace({symbol: slope * distance}) * distance
    found = sp.limit(scaled, distance, 0)
    if not found.has(slope) or found.has(sp.oo, sp.zoo):
        raise OperationError(f"{symbol} has no simple zero in the denominator")
    return found


@dataclass(frozen=True)
class CloseContour(Operation):
    """Close a contour on a line just above the real axis, and sum the residues.

    The sources are the contour integral, the function in its denominator, and the sets of its
    roots. For a positive coordinate ``e^{ikz}`` decays above: the contour is closed there, with the
    roots of the upper half-plane inside. For a negative coordinate it is closed below, in the
    opposite sense, with the roots there and the pole at k = 0 inside.

    Attributes
    ----------
    coordinate, wavenumber : Symbol
        z and k.
    slope : Symbol
        Name of the derivative of the function at a root.
    """

    phrase: ClassVar[str] = (
        "close the contour of {first} above for {coordinate} > 0, below for {coordinate} < 0, and "
        "sum the residues at the simple roots {others} and at {wavenumber} = 0"
    )
    coordinate: sp.Symbol
    wavenumber: sp.Symbol
    slope: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the profile as sums over roots, on either side of the step."""
        integral, definition, sets = sources
        z, k = self.coordinate, self.wavenumber
        integrand = integral.rhs.function
        upper, lower = self._half_planes(sets)
        at_root = residue_at_root(integrand, definition.lhs, self.slope)
        at_zero = (k * integrand).xreplace({definition.lhs: definition.rhs}).subs(k, 0)
        if at_zero.has(sp.zoo, sp.nan):
            raise OperationError(f"there is no simple pole at {k} = 0")
        two_pi_i = 2 * sp.pi * sp.I
        above = self._sum(two_pi_i * at_root, upper)
        below = -two_pi_i * at_zero + self._sum(-two_pi_i * at_root, lower)
        return equation(
            integral.lhs,
            sp.Piecewise((sp.simplify(-two_pi_i * at_zero) + below + two_pi_i * at_zero, z < 0),
                         (above, z > 0)),
        )  # fmt: skip

    def _sum(self, term: sp.Expr, roots: sp.Basic) -> sp.Expr:
        factor, summand = sp.simplify(term).as_independent(
            self.wavenumber, self.slope, as_Add=False
        )
        return factor * SumOver(summand, self.wavenumber, roots)

    def _half_planes(self, sets: sp.Basic) -> tuple[sp.Basic, sp.Basic]:
        """Return the names of the sets of roots above and below the real axis."""
        found = {}
        for part in parts_of(sets):
            conditions = part.rhs.condition.args
            (side,) = (q for q in conditions if isinstance(q, sp.Gt | sp.Lt))
            found[isinstance(side, sp.Gt)] = part.lhs
        return found[True], found[False]


@dataclass(frozen=True)
class LayOnRealAxis(Operation):
    """Move a contour at zero coordinate onto the real axis, indented above the pole at k = 0.

    The odd part of the principal value cancels; the indentation gives -i pi times the residue.

    Attributes
    ----------
    coordinate, wavenumber : Symbol
        z and k.
    """

    phrase: ClassVar[str] = (
        "at {coordinate} = 0 lay the contour of {first} on the real axis, indented above the pole "
        "at 0, with {others}: odd parts cancel"
    )
    coordinate: sp.Symbol
    wavenumber: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the profile at zero as half a residue and an integral from 0 to infinity."""
        integral, definition = sources
        k = self.wavenumber
        integrand = integral.rhs.function.subs(self.coordinate, 0)
        even = sp.expand((definition.rhs + definition.rhs.subs(k, -k)) / 2)
        odd = sp.expand(definition.rhs - even)
        constant = sp.simplify(integrand * definition.lhs * k)  # the part that does not depend on k
        if constant.has(k) or even.subs(k, 0) == 0:
            raise OperationError("the integrand is not a constant over k L(k)")
        half_residue = -sp.pi * sp.I * constant / even.subs(k, 0)
        # (1/(even + odd) - 1/(even - odd)) / 2k, the even part of 1/(k L).
        factor = 2 * constant * sp.cancel(-odd / k)
        line = factor * sp.Integral(1 / (even**2 + sp.cancel(-(odd**2))), (k, 0, sp.oo))
        at_zero = integral.lhs.subs(self.coordinate, 0)
        return equation(at_zero, sp.simplify(half_residue) + line)


@dataclass(frozen=True)
class SumOverPeriods(Operation):
    """Sum an integrand over all periods of its periodic part, to give an integral over one period.

    The integrand from 0 to infinity is ``u / (A² + w k²)`` up to constants, with A even and of
    period 2 pi. Partial fractions and ``sum over m of 1/(z + 2 pi m) = cot(z/2)/2`` give the
    result.

    Attributes
    ----------
    wavenumber : Symbol
        k.
    """

    phrase: ClassVar[str] = (
        "sum the integrand of {sources} over all periods of A by partial fractions"
    )
    wavenumber: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation with an integral over one period."""
        (source,) = sources
        (line,) = source.rhs.atoms(sp.Integral)
        k = line.limits[0][0]
        stand_in = sp.Dummy("A")
        denominator = 1 / line.function
        square = sum((q for q in sp.Add.make_args(denominator) if q.is_Pow), sp.S.Zero)
        periodic = square.base if square.is_Pow and square.exp == 2 else sp.S.Zero
        shifted = periodic.subs(k, k + 2 * sp.pi)
        if (
            periodic == 0
            or sp.simplify(shifted - periodic) != 0
            or periodic.subs(k, -k) != periodic
        ):
            raise OperationError("the integrand has no even periodic part A squared")
        remainder = denominator - square
        comb = sp.S.Zero
        for root in sp.solve(stand_in**2 + remainder, k):
            weight = 1 / sp.diff(remainder, k).subs(k, root)
            comb += weight * sp.cot((k - root) / 2) / 2
        period = hyperbolic(comb, k) / 2
        factor, kernel = sp.factor_terms(period).as_independent(k, stand_in, as_Add=False)
        integral = sp.Integral(kernel.xreplace({stand_in: periodic}), (k, -sp.pi, sp.pi))
        return equation(source.lhs, source.rhs.xreplace({line: factor * integral}))


def hyperbolic(comb: sp.Expr, k: sp.Symbol) -> sp.Expr:
    """Return two cotangents of equal weight as ``sin(x + y) / (cos(x - y) - cos(x + y))``."""
    terms = sp.Add.make_args(comb)
    if len(terms) != 2:
        raise OperationError("partial fractions did not give two terms")
    (weight, one), (_, other) = (q.as_independent(k, as_Add=False) for q in terms)
    x, y = one.args[0], other.args[0]
    sum_of_arguments, difference = sp.expand(x + y), sp.expand(x - y)
    total = 2 * weight * sp.sin(sum_of_arguments) / (sp.cos(difference) - sp.cos(sum_of_arguments))
    if sp.simplify((total - comb).rewrite(sp.exp)) != 0:
        raise OperationError("the cotangents do not combine")
    return total


@dataclass(frozen=True)
class IntegratePeriod(Operation):
    """Integrate a rational function of ``cos k`` over a period by residues in the unit disc.

    The mean of ``1/(w - cos k)`` is ``1/(w sqrt(1 - 1/w²))`` for w off the interval [-1, 1].

    Attributes
    ----------
    probe : float
        Value of the parameter at which the sign of a simplified square root is determined; the sign
        cannot change unless a root crosses the unit circle.
    """

    phrase: ClassVar[str] = "carry out the integral of {sources} by residues in the unit disc"
    probe: float = 0.7

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation with the integral carried out."""
        (source,) = sources
        (integral,) = source.rhs.atoms(sp.Integral)
        k = integral.limits[0][0]
        cosine = sp.Dummy("cos")
        in_cosine = sp.expand_trig(integral.function).subs(sp.cos(k), cosine)
        numerator, denominator = sp.fraction(sp.together(in_cosine))
        if in_cosine.has(k) or not denominator.has(cosine):
            raise OperationError("the integrand is not a rational function of the cosine")
        residue = numerator / sp.diff(denominator, cosine)
        weights = [(root, sp.simplify(residue.subs(cosine, root)))
                   for root in sp.solve(denominator, cosine)]  # fmt: skip
        means = [self._short(-weight / (root * sp.sqrt(1 - 1 / root**2)))
                 for root, weight in weights]  # fmt: skip
        return equation(source.lhs, source.rhs.xreplace({integral: 2 * sp.pi * sum(means)}))

    def _short(self, mean: sp.Expr) -> sp.Expr:
        """Return ``±1/sqrt(simplified 1/mean²)``, with the sign of the mean itself."""
        inverse = sp.expand(sp.simplify(1 / mean**2))
        scale = sp.re(inverse).doit()
        if not scale.is_positive:
            scale = sp.S.One
        short = 1 / (sp.sqrt(scale) * sp.sqrt(sp.expand(inverse / scale)))
        values = dict.fromkeys(mean.free_symbols, self.probe)
        sign = complex((mean / short).subs(values).evalf())  # the squares are equal
        return round(sign.real) * short
