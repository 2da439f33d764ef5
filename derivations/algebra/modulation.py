"""Modulation equations of a chain to second order, by two routes that share only the algebra.

Multiple scales expands ``y`` in powers of eps on the times T0, T1, T2 and forbids secular terms.
Averaging writes ``y' + i y = phi e^{it}`` and removes the oscillating part of the right-hand side
by a near-identity change of phi. The two amplitudes differ by this change, which
``in_scales_amplitude`` carries out; the two equations must then be identical.

Both start from the equation of motion itself, which `Force.read` analyses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.polys.domains import QQ_I

from derivations.algebra.equations import left_minus_right
from derivations.algebra.harmonics import Coefficient, HarmonicRing, Harmonics, chain_ring
from derivations.algebra.operations import OperationError

RATE = "rate"
"""Stands for y_n' among the arguments of a force; the others are site offsets."""

Argument = int | str


@dataclass(frozen=True)
class Force:
    """The factor of eps in ``y_n'' + y_n + eps F(y_{n-p} … y_{n+p}, y_n') = 0``.

    Attributes
    ----------
    arguments : tuple
        Offsets of the sites that occur, and `RATE`.
    polynomial : Poly
        F in these arguments.
    """

    arguments: tuple[Argument, ...]
    polynomial: sp.Poly

    @classmethod
    def read(cls, motion: sp.Basic, small: sp.Symbol) -> Force:
        """Extract the force from the equation of motion of site n.

        Raises
        ------
        OperationError
            If it is not of this form, or F is not a polynomial.
        """
        whole = left_minus_right(motion)
        accelerations = [q for q in whole.atoms(sp.Derivative) if q.derivative_count == 2]
        if len(accelerations) != 1:
            raise OperationError("one second derivative is needed")
        field = accelerations[0].expr
        index, time = field.args
        force = sp.diff(whole, small)
        if sp.expand(whole.subs(small, 0) - accelerations[0] - field) != 0 or force.has(small):
            raise OperationError(f"{motion} is not y'' + y + {small} F = 0")
        stand_ins: dict[sp.Basic, sp.Symbol] = {field.diff(time): sp.Dummy("rate")}
        names: dict[sp.Symbol, Argument] = {stand_ins[field.diff(time)]: RATE}
        for site in sorted(force.atoms(AppliedUndef), key=str):
            stand_ins[site] = sp.Dummy(str(site))
            names[stand_ins[site]] = int(site.args[0] - index)
        polynomial = sp.expand(force.xreplace(stand_ins))
        used = [symbol for symbol in names if polynomial.has(symbol)]
        return cls(tuple(names[symbol] for symbol in used), sp.Poly(polynomial, *used))

    @property
    def reach(self) -> int:
        """Largest distance, in sites, on which the force depends."""
        return max((abs(q) for q in self.arguments if isinstance(q, int)), default=0)

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """The symbols in its coefficients, sorted by name."""
        return tuple(sorted(self.polynomial.free_symbols_in_domain, key=lambda q: str(q.name)))

    def of(self, values: Mapping[Argument, Harmonics], ring: HarmonicRing) -> Harmonics:
        """Return the force for given arguments."""
        return _evaluated(self.polynomial, [values[q] for q in self.arguments], ring)

    def change(
        self, values: Mapping[Argument, Harmonics], changes: Mapping[Argument, Harmonics],
        ring: HarmonicRing,
    ) -> Harmonics:  # fmt: skip
        """Return its change to first order in ``changes`` of the arguments."""
        total = Harmonics(ring, {})
        given = [values[q] for q in self.arguments]
        for argument, generator in zip(self.arguments, self.polynomial.gens, strict=True):
            slope = self.polynomial.diff(generator)
            if not slope.is_zero:
                total = total + _evaluated(slope, given, ring) * changes[argument]
        return total


def _evaluated(polynomial: sp.Poly, values: list[Harmonics], ring: HarmonicRing) -> Harmonics:
    powers = [{0: Harmonics(ring, {0: ring.ring.one})} for _ in values]
    total = Harmonics(ring, {})
    for exponents, coefficient in polynomial.terms():
        term = Harmonics(ring, {0: ring.element(coefficient)})
        for exponent, value, known in zip(exponents, values, powers, strict=True):
            for power in range(1, exponent + 1):
                if power not in known:
                    known[power] = known[power - 1] * value
            if exponent:
                term = term * known[exponent]
        total = total + term
    return total


@dataclass(frozen=True)
class Modulation:
    """``d amplitude / dt = eps first + eps^2 second`` at the middle site.

    Attributes
    ----------
    ring : HarmonicRing
        The ring of the coefficients.
    reach : int
        Largest distance, in sites, on which the first order depends.
    first, second : ring element
        Right-hand sides; ``second`` is None at order one.
    correction : Harmonics
        The part of O(eps) that is not slow: of y for multiple scales, of phi for averaging.
    """

    ring: HarmonicRing
    reach: int
    first: Coefficient
    second: Coefficient | None
    correction: Harmonics

    def first_expr(self) -> sp.Expr:
        """Return the O(eps) right-hand side as a SymPy expression."""
        return self.ring.as_expr(self.first)

    def second_expr(self) -> sp.Expr:
        """Return the O(eps^2) right-hand side as a SymPy expression."""
        return self.ring.as_expr(self.second if self.second is not None else self.ring.ring.zero)


def by_multiple_scales(force: Force, order: int) -> Modulation:
    """Return the modulation of ``y = A e^{iT0} + c.c. + eps y1``, where y1 has no ``e^{±iT0}``.

    Parameters
    ----------
    force : Force
        The force of the chain, or of an isolated cell.
    order : {1, 2}
        The power of eps to which the modulation is carried.

    Returns
    -------
    Modulation
        Right-hand sides of ``dA_n/dt``.

    References
    ----------
    Nayfeh, A. H. (1973), Perturbation Methods, chapter 6.

    Examples
    --------
    The frequency of van der Pol's own cell, h = y^2 - 1, falls by eps^2/16.

    >>> n, t, e = sp.Symbol("n", integer=True), sp.Symbol("t"), sp.Symbol("e")
    >>> y = sp.Function("y", real=True)(n, t)
    >>> cell = Force.read(y.diff(t, 2) + y + e * y.diff(t) * (y**2 - 1), e)
    >>> by_multiple_scales(cell, 2).second_expr().subs(sp.Symbol("A"), 1)
    -I/16
    """
    reach = force.reach
    ring = chain_ring("A", force.parameters, order * reach)
    y0 = ring.real_wave(0)
    rate0 = y0.fast_derivative()
    values: dict[Argument, Harmonics] = {RATE: rate0}
    values |= {at: y0.shifted(at) for at in range(-reach, reach + 1)}
    # Order eps: y1'' + y1 = -2 D0 D1 y0 - force. The coefficient of e^{iT0} must vanish.
    drive = force.of(values, ring)
    half_i = ring.ring.ground_new(QQ_I(0, sp.QQ(1, 2)))
    first = drive.coefficient(1) * half_i
    y1 = drive.scaled(-1).response()
    if order == 1:
        return Modulation(ring, reach, first, None, y1)
    # Order eps^2: -2 D0 D1 y1 - D1^2 y0 - 2 D0 D2 y0 - (change of the force), resonant part.
    flow = ring.flow(first, reach)
    slow_y1 = y1.along(flow)
    slow_y0 = y0.along({0: first})
    changes: dict[Argument, Harmonics] = {RATE: y1.fast_derivative() + slow_y0}
    changes |= {at: y1.shifted(at) for at in range(-reach, reach + 1)}
    change = force.change(values, changes, ring)
    slow_twice = ring.along(first, flow)
    resonant = (slow_y1.fast_derivative().scaled(2) + change).coefficient(1) + slow_twice
    return Modulation(ring, reach, first, resonant * half_i, y1)


def by_averaging(force: Force, order: int) -> Modulation:
    """Return the modulation of the mean of phi, ``y' + i y = phi e^{it}`` (Eq. 31 with omega = 1).

    Parameters
    ----------
    force : Force
        The force of the chain, or of an isolated cell.
    order : {1, 2}
        The power of eps to which averaging is carried.

    Returns
    -------
    Modulation
        Right-hand sides of ``dphi_n/dt``; ``correction`` is the oscillating part of phi at O(eps).

    References
    ----------
    Sanders, J. A., Verhulst, F. and Murdock, J. (2007), Averaging Methods in Nonlinear Dynamical
    Systems, section 2.9.
    """
    reach = force.reach
    ring = chain_ring(r"\varphi", force.parameters, order * reach)
    phi = Harmonics(ring, {1: ring.amplitude(0)})
    half = QQ_I(sp.QQ(1, 2), 0)
    y = (phi - phi.conjugate()).scaled(ring.ring.ground_new(QQ_I(0, sp.QQ(-1, 2))))
    values: dict[Argument, Harmonics] = {
        RATE: (phi + phi.conjugate()).scaled(ring.ring.ground_new(half))
    }
    values |= {at: y.shifted(at) for at in range(-reach, reach + 1)}
    right = force.of(values, ring).turned(-1).scaled(-1)
    first = right.coefficient(0)
    u = right.oscillation()
    if order == 1:
        return Modulation(ring, reach, first, None, u)
    # <Dg u1>: only the product of opposite harmonics has a mean.
    second = ring.ring.zero
    for m, value in right.terms.items():
        shifted = {site: u.shifted(site) for site in range(-reach, reach + 1)}
        changes = {site: shifted[site].coefficient(-m) for site in shifted}
        conjugate_changes = {site: ring.conjugate(shifted[site].coefficient(m)) for site in shifted}
        second += ring.along(value, changes, conjugate_changes)
    return Modulation(ring, reach, first, second, u)


def fundamental_shift(averaged: Modulation) -> Coefficient:
    """Return W, where the fundamental of y is ``-(i/2)(phi + eps W)``.

    The conjugate of the oscillating part of phi at ``e^{-2it}`` contributes to ``e^{it}`` in y.
    """
    return -averaged.ring.conjugate(averaged.correction.coefficient(-2))


def in_scales_amplitude(
    averaged: Modulation, shift: Coefficient
) -> tuple[Coefficient, Coefficient]:
    """Return the averaged equations rewritten for the amplitude A of ``e^{it}`` in y itself.

    In terms of phi, the equation of A is ``second + (W along first) - (first along W)``; finally,
    phi is replaced by 2 i A.

    Parameters
    ----------
    averaged : Modulation
        The averaged equations, to second order.
    shift : ring element
        W of `fundamental_shift`.

    Returns
    -------
    first, second : ring elements
        In the generators of the averaging ring, with A in place of phi.

    Raises
    ------
    ValueError
        If averaging was carried out to first order only.
    """
    ring, first, reach = averaged.ring, averaged.first, averaged.reach
    if averaged.second is None:
        raise ValueError("averaging was carried to first order only")
    second = averaged.second
    second += ring.along(shift, ring.flow(first, reach)) - ring.along(
        first, ring.flow(shift, reach)
    )
    return _phi_to_amplitude(ring, first), _phi_to_amplitude(ring, second)


def _phi_to_amplitude(ring: HarmonicRing, value: Any) -> Any:
    """Replace phi by 2 i A and divide by 2 i, monomial by monomial.

    An averaged monomial contains one more phi than conjugates of phi, so the powers of i cancel.
    """
    count = 2 * len(ring.amplitudes)
    return ring.ring.from_dict(
        {powers: number * QQ_I(sp.QQ(2) ** (sum(powers[:count]) - 1), 0)
         for powers, number in value.items()}
    )  # fmt: skip
