"""The modulation equations to second order, by two routes that share only the algebra.

Multiple scales expands ``y`` in powers of eps on the times T0, T1, T2 and forbids secular terms.
Averaging writes ``y' + i y = phi e^{it}`` and removes the oscillating part of the right-hand
side by a near-identity change of phi. The two amplitudes differ by that change, which
``in_scales_amplitude`` carries out; afterwards the two equations must be identical.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.polys.domains import QQ_I

from derivations.algebra.harmonics import Coefficient, HarmonicRing, Harmonics, chain_ring
from derivations.oscillator import Oscillator


@dataclass(frozen=True)
class Modulation:
    """``d amplitude / dt = eps first + eps^2 second`` at the middle site.

    Attributes
    ----------
    ring : HarmonicRing
        Where the coefficients live.
    first, second : ring element
        Right-hand sides; ``second`` is None at order one.
    correction : Harmonics
        The O(eps) part that is not slow: of y for multiple scales, of phi for averaging.
    """

    ring: HarmonicRing
    first: Coefficient
    second: Coefficient | None
    correction: Harmonics

    def first_expr(self) -> sp.Expr:
        """Return the O(eps) right-hand side as a SymPy expression."""
        return self.ring.as_expr(self.first)

    def second_expr(self) -> sp.Expr:
        """Return the O(eps^2) right-hand side as a SymPy expression."""
        return self.ring.as_expr(self.second if self.second is not None else self.ring.ring.zero)


def by_multiple_scales(cell: Oscillator, order: int = 1) -> Modulation:
    """Modulation of ``y = A e^{iT0} + c.c. + eps y1``, where y1 holds no ``e^{±iT0}``.

    Parameters
    ----------
    cell : Oscillator
        The oscillator, isolated or in the chain.
    order : {1, 2}
        The power of eps to which the modulation is carried.

    Returns
    -------
    Modulation
        Right-hand sides of ``dA_n/dt``.

    Examples
    --------
    The frequency of van der Pol's own cell, h = y^2 - 1, falls by eps^2/16.

    >>> cell = Oscillator({0: sp.Integer(-1), 2: sp.Integer(1)})
    >>> second = by_multiple_scales(cell, 2).second_expr()
    >>> second.subs(sp.Symbol("A"), 1)
    -I/16
    """
    ring = chain_ring("A", cell.parameters, order if cell.is_chain else 0)
    y0 = ring.real_wave(0)
    rate0 = y0.fast_derivative()
    reach = 1 if cell.is_chain else 0
    # Order eps: y1'' + y1 = -2 D0 D1 y0 - force. The coefficient of e^{iT0} must vanish.
    force = cell.force(ring, y0, rate0)
    drive = force + cell.coupling_force(ring, y0)
    half_i = ring.ring.ground_new(QQ_I(0, sp.QQ(1, 2)))
    first = drive.coefficient(1) * half_i
    y1 = drive.scaled(-1).response()
    if order == 1:
        return Modulation(ring, first, None, y1)
    # Order eps^2: -2 D0 D1 y1 - D1^2 y0 - 2 D0 D2 y0 - (change of the force), resonant part.
    flow = ring.flow(first, reach)
    slow_y1 = y1.along(_inner(flow, reach, ring))
    slow_y0 = y0.along({0: first})
    change = cell.force_change(ring, y0, rate0, y1, y1.fast_derivative() + slow_y0)
    slow_twice = ring.along(first, flow)
    # Linear coupling of y1 carries no e^{iT0}: y1 holds none. So it needs no sites beyond these.
    resonant = (slow_y1.fast_derivative().scaled(2) + change).coefficient(1) + slow_twice
    return Modulation(ring, first, resonant * half_i, y1)


def by_averaging(cell: Oscillator, order: int = 1) -> Modulation:
    """Modulation of the mean of phi, where ``y' + i y = phi e^{it}`` (Eq. 31 with omega = 1).

    Parameters
    ----------
    cell : Oscillator
        The oscillator, isolated or in the chain.
    order : {1, 2}
        The power of eps to which averaging is carried.

    Returns
    -------
    Modulation
        Right-hand sides of ``dphi_n/dt``; ``correction`` is the oscillating part of phi at O(eps).
    """
    ring = chain_ring(r"\varphi", cell.parameters, order if cell.is_chain else 0)
    phi = Harmonics(ring, {1: ring.amplitude(0)})
    half = QQ_I(sp.QQ(1, 2), 0)
    rate = (phi + phi.conjugate()).scaled(ring.ring.ground_new(half))
    y = (phi - phi.conjugate()).scaled(ring.ring.ground_new(QQ_I(0, sp.QQ(-1, 2))))
    drive = cell.force(ring, y, rate) + cell.coupling_force(ring, y)
    right = drive.turned(-1).scaled(-1)
    first = right.coefficient(0)
    u = right.oscillation()
    if order == 1:
        return Modulation(ring, first, None, u)
    # <Dg u1>: only the product of opposite harmonics has a mean.
    second = ring.ring.zero
    for m, value in right.terms.items():
        sites = range(-1, 2) if cell.is_chain else range(1)
        moved = {site: u.shifted(site) for site in sites}
        back = {site: moved[site].coefficient(-m) for site in sites}
        forth = {site: ring.conjugate(moved[site].coefficient(m)) for site in sites}
        second += _mixed_derivative(ring, value, back, forth)
    return Modulation(ring, first, second, u)


def in_scales_amplitude(averaged: Modulation) -> tuple[Coefficient, Coefficient]:
    """Return the averaged equations rewritten for the amplitude A of ``e^{it}`` in y itself.

    ``A = -(i/2)(phi + eps W)``: the conjugate of the oscillating part of phi at ``e^{-2it}``
    contributes to ``e^{it}`` in y, which is W. In phi, the equation of A is then
    ``second + (W along first) - (first along W)``; last, phi is replaced by 2 i A.

    Returns
    -------
    first, second : ring elements
        In the generators of the averaging ring, with A in the place of phi.
    """
    ring, first = averaged.ring, averaged.first
    if averaged.second is None:
        raise ValueError("averaging was carried to first order only")
    shift = -ring.conjugate(averaged.correction.coefficient(-2))
    reach = 1 if len(ring.amplitudes) > 1 else 0
    moved = averaged.second
    moved += ring.along(shift, ring.flow(first, reach)) - ring.along(first, ring.flow(shift, reach))
    return _phi_to_amplitude(ring, first), _phi_to_amplitude(ring, moved)


def same_polynomial(left: Coefficient, right: Coefficient) -> bool:
    """Whether two coefficients of rings with matching generators are the same polynomial."""
    return bool(dict(left.items()) == dict(right.items()))


def _inner(flow: dict[int, Any], reach: int, ring: HarmonicRing) -> dict[int, Any]:
    return {offset: rate for offset, rate in flow.items() if abs(offset) <= min(reach, ring.reach)}


def _mixed_derivative(
    ring: HarmonicRing, value: Any, back: dict[int, Any], forth: dict[int, Any]
) -> Any:
    """Sum over sites of d value/d phi_j * back_j + d value/d conj(phi_j) * forth_j."""
    count = len(ring.amplitudes)
    total = ring.ring.zero
    for site, factor in back.items():
        place = site + ring.reach
        total += value.diff(ring.ring.gens[place]) * factor
        total += value.diff(ring.ring.gens[count + place]) * forth[site]
    return total


def _phi_to_amplitude(ring: HarmonicRing, value: Any) -> Any:
    """Replace phi by 2 i A and divide by 2 i, monomial by monomial."""
    count = len(ring.amplitudes)
    turn = (QQ_I(1, 0), QQ_I(0, 1), QQ_I(-1, 0), QQ_I(0, -1))
    out = {}
    for powers, number in value.items():
        plain, barred = sum(powers[:count]), sum(powers[count : 2 * count])
        size = sp.QQ(2) ** (plain + barred) / 2
        out[powers] = number * QQ_I(size, 0) * turn[(plain - barred - 1) % 4]
    return ring.ring.from_dict(out)
