"""Checks of the limits of the kinetic relation: static chains, long waves, computed roots."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import sympy as sp

from derivations.algebra.evidence import Points, at_points, solved_for
from derivations.algebra.steps import Check, Evidence
from derivations.front import symbols as s
from derivations.front.numbers import Lattice, kinetic_sum
from derivations.front.sampling import Sample, SampledChecks, standing
from derivations.symbols import c

_FACTORS = (0.4, 1.0, 2.3)


class LimitChecks(SampledChecks):
    """The checks of pinning, retreat and strong coupling."""

    def _standing(self, *, ahead: bool = True) -> Iterator[tuple[Sample, complex, dict[Any, Any]]]:
        """Return the value at the site about to switch, with springs of several strengths."""
        for sample in self.samples:
            for factor in _FACTORS if self.model.is_scaled_by_c else (1.0,):
                phi = standing(sample.coupled(factor))
                values = {**sample.chain.values}
                values[c] = values.get(c, 1.0) * factor
                yield sample, phi if ahead else 1 - phi, values

    @at_points("a quotient of moduli")
    def ratio_named(self) -> Points:
        """Compare with a quotient of moduli."""
        point = {s.phi_us: 0.6j, s.phi_s: 1.2 - 0.5j, s.ratio: 0.6 / 1.3}
        yield point, [0]

    def static(self, *, ahead: bool) -> Check:
        """Compare with the last site of a static chain, and with a front that hardly moves."""
        name = s.static_sum if ahead else s.retreating_sum

        def points() -> Points:
            for sample, phi, values in self._standing(ahead=ahead):
                yield {**values, name: -phi / sample.lattice.decay}, [0]
            if ahead:
                sample = self.samples[0]
                # The correction is about e^{-decay/v}, and the decay is half the damping at rest.
                slow = kinetic_sum(sample.lattice, 0.01 * sample.damping_at_rest)
                yield {**sample.chain.values, name: slow}, [0]

        return at_points("a standing chain, solved site by site", floor=1.0)(points)

    def named_relation(self, name: sp.Symbol) -> Check:
        """Compare the modulus of the sum with the ratio."""

        def points() -> Points:
            for sample in self.samples:
                at_front = 0.3 - 0.4j
                yield {**sample.chain.values, name: -at_front / sample.lattice.decay,
                       s.ratio: abs(at_front)}, [0]  # fmt: skip

        return at_points("the value at the front over its modulus")(points)

    def depinning(self, *, ahead: bool) -> Check:
        """Compare both parts for a static chain."""
        name = s.static_sum if ahead else s.retreating_sum

        def points() -> Points:
            for sample, phi, values in self._standing(ahead=ahead):
                yield {**values, name: -phi / sample.lattice.decay, s.ratio: abs(phi)}, [0, 0]

        return at_points("a standing chain, solved site by site", floor=1.0)(points)

    def _roots(self) -> Iterator[tuple[float, complex, dict[Any, Any]]]:
        """Return the value ahead, and the corresponding square root: 1 - 2 phi/phi_s = 1/w."""
        for _, ahead, values in self._standing():
            root = 1 / (1 - 2 * ahead)
            yield abs(ahead), root, {**values, s.p: root.real}

    @at_points("standing chains", floor=1.0)
    def _radical(self) -> Points:
        for _, _, point in self._roots():
            yield point, [0, 0]

    def radical(self, candidate: sp.Basic) -> Evidence:
        """Compare with the root that belongs to a static chain."""
        found = self._radical(candidate)
        worst = max(abs(complex(candidate.args[0].rhs.subs(point).evalf()) - root)
                    for _, root, point in self._roots())  # fmt: skip
        return Evidence(found.holds and worst < 1e-9, f"{found.statement}; root off by {worst:.1e}")

    @at_points("standing chains")
    def coupling_by_p(self) -> Points:
        """Compare the coupling of a static chain with the one from its root."""
        for _, _, point in self._roots():
            yield point, [0]

    def _with_ratio(self, *, ahead: bool) -> Iterator[dict[Any, Any]]:
        for (_, _, point), (_, phi, _) in zip(
            self._roots(), self._standing(ahead=ahead), strict=True
        ):
            coupling = point.pop(c)  # the threshold has its own symbol
            yield {**point, s.ratio: abs(phi), s.c_pin if ahead else s.c_retreat: coupling}

    def thresholds(self, *, ahead: bool) -> Check:
        """Compare with ratio and root of a static chain."""

        def points() -> Points:
            for point in self._with_ratio(ahead=ahead):
                yield point, [0]

        return at_points("standing chains")(points)

    def coupling(self, *, ahead: bool) -> Check:
        """Compare the coupling of a static chain with the one from its ratio alone."""

        def points() -> Points:
            for point in self._with_ratio(ahead=ahead):
                del point[s.p]
                yield point, [0]

        return at_points("standing chains")(points)

    def largest_ratio(self, candidate: sp.Basic) -> Evidence:
        """Compare with the value ahead of a static chain at strong coupling, extrapolated."""
        moduli = [abs(standing(Lattice(0.5, (coupling,)))) for coupling in (2.5e3, 1e4)]
        limit = 2 * moduli[1] - moduli[0]  # the difference decreases like 1/sqrt(c)
        found = solved_for(candidate, s.ratio, {}).real
        return Evidence(
            abs(found - limit) < 1e-4,
            f"a standing chain at c = 2500, 10000, extrapolated: {limit:.6f}",
        )

    def ratio_in_eta(self, candidate: sp.Basic) -> Evidence:
        """Compare with the cycles of the direct average."""
        return self.on_cycles("cycles of the direct average", 1)(candidate)

    def largest_eta(self, candidate: sp.Basic) -> Evidence:
        """Require the cycles of the direct average at this forcing to have the ratio one half."""
        limit = solved_for(candidate, s.eta, {}).real
        powers = sorted(q for q in self.model.damping if q)
        low, middle, top = 1.0, -4.0, limit * 16.0
        phase = 2 * np.pi * np.arange(64) / 64
        means = [float((np.sin(phase) ** q * np.cos(phase) ** 2).mean()) for q in powers]
        squares = np.roots([top * means[1], middle * means[0], low * 0.5]).real
        found = (squares.min() / squares.max()) ** (1 / powers[0])
        return Evidence(abs(found - 0.5) < 1e-12, f"cycles of that η have the ratio {found:.12f}")

    def _strong(self, factor: float) -> Iterator[tuple[Sample, Lattice, dict[Any, Any], float]]:
        """Yield each chain with stronger springs, and the unit in which V is of order one.

        In units of the damping at rest divided by that unit, κ is of order one too: V κ is a rate.
        """
        for sample in self.samples:
            values = {**sample.chain.values}
            unit = math.sqrt(sample.damping_at_rest * sample.chain.pull_on_long_waves / values[c])
            values[c] *= factor
            yield sample, sample.coupled(factor), values, unit

    def long_waves(self, candidate: sp.Basic) -> Evidence:
        """Compare with L at strong coupling, at a wavenumber proportional to 1/sqrt(c)."""
        worst = 0.0
        for sample, lattice, values, unit in self._strong(1e6):
            velocity, kappa = 0.8 * unit, (0.7 - 0.4j) * sample.damping_at_rest / unit
            sqrt_c = math.sqrt(values[c])
            exact = complex(lattice.dispersion(kappa / sqrt_c, velocity * sqrt_c))
            point = {**values, s.V: velocity, s.kappa: kappa}
            difference = abs(solved_for(candidate, s.long_wave, point) - exact)
            worst = max(worst, difference / sample.damping_at_rest)
        return Evidence(
            worst < 1e-4, f"L at a million times the coupling, and k = κ/√c: off by {worst:.1e}"
        )

    def long_wave_root(self, candidate: sp.Basic) -> Evidence:
        """Compare with the root above the axis nearest the origin, by Newton's method."""
        worst = 0.0
        for sample, lattice, values, unit in self._strong(1e6):
            for velocity in (0.3 * unit, 0.8 * unit, 2.0 * unit):
                sqrt_c = math.sqrt(values[c])
                found = sqrt_c * _nearest(
                    lattice, velocity * sqrt_c, sample.damping_at_rest / unit / sqrt_c
                )
                difference = abs(solved_for(candidate, s.kappa, {**values, s.V: velocity}) - found)
                worst = max(worst, difference / abs(found))
        return Evidence(
            worst < 1e-4,
            f"the root nearest the origin at a million times the coupling: off by {worst:.1e}",
        )

    def strong_sum(self, candidate: sp.Basic) -> Evidence:
        """Compare with the whole sum at large c, from the history of the front."""
        errors = []
        # For the same pull on long waves, each spring of a long reach is weaker.
        reach_squared = self.model.reach**2
        for factor in (100.0 * reach_squared, 8100.0 * reach_squared):
            worst = 0.0
            for sample, lattice, values, unit in self._strong(factor):
                velocity = 0.8 * unit
                exact = kinetic_sum(lattice, velocity * math.sqrt(values[c]))
                found = solved_for(candidate, s.strong_sum, {**values, s.V: velocity})
                worst = max(worst, sample.damping_at_rest * abs(found - exact))
            errors.append(worst)
        # The neglected terms are the roots near k = 2 pi m. There c (k - 2 pi m)²/2 balances 2 pi m
        # v, and v is of order sqrt(c): k - 2 pi m decreases like c^(-1/4), L_k grows like c^(3/4),
        # and the neglected sum decreases like c^(-3/4), by 27 for 81 times the coupling. Springs of
        # several lengths have further roots, of order 1/c, which may cancel much of it at one
        # coupling; over two decades that cannot hide the decrease.
        holds = errors[1] < 0.002 and errors[1] < errors[0] / (0.6 * 81.0**0.75)
        return Evidence(holds, "the front from its history at strong coupling, and one 81 times "
                               f"as strong: off by {errors[0]:.1e}, {errors[1]:.1e}")  # fmt: skip

    def strong_relation(self, candidate: sp.Basic) -> Evidence:
        """Compare the modulus of the sum with the ratio, and the sum with its value."""
        relation, value_of = candidate.args
        first = self.named_relation(s.strong_sum)(relation)
        return self.strong_sum(value_of) if first.holds else first


def _nearest(lattice: Lattice, v: float, unit: float) -> complex:
    """Return the root above the axis nearest to the origin, from many starts in this unit."""
    starts = np.array([r * np.exp(1j * a) for r in (0.2, 0.6, 1.2, 2.5, 5.0, 10.0, 20.0)
                       for a in (0.2, 0.8, 1.6, 2.4, 3.0)]) * unit  # fmt: skip
    k = starts
    with np.errstate(all="ignore"):
        for _ in range(40):
            k = k - lattice.dispersion(k, v) / lattice.slope(k, v)
    converged = (
        np.isfinite(k)
        & (k.imag > 0)
        & (np.abs(lattice.dispersion(k, v)) < 1e-7 * 2 * lattice.decay)
    )
    k = k[converged]
    return complex(k[np.abs(k).argmin()])
