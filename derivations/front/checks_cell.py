"""Checks of the cell of the averaged chain, and of the two straight lines of (44)."""

from __future__ import annotations

import cmath
import random
from collections.abc import Iterator

import sympy as sp

from derivations.algebra.evidence import Points, at_points, residual, slope_of
from derivations.algebra.steps import Evidence
from derivations.front import symbols as s
from derivations.front.sampling import Sample, SampledChecks, as_point, complex_number, sites
from derivations.symbols import n, t

_PHI_N = s.phi(n, t)


class FrontCellChecks(SampledChecks):
    """The checks of the cell, by averaging Eq. (8) over equal samples in time."""

    def _cells(self) -> Iterator[tuple[Sample, random.Random]]:
        rng = random.Random(5)
        for sample in self.samples:
            yield sample, rng

    @at_points("Eq. (8) averaged by sampling, all sites alike")
    def averaged_cell(self) -> Points:
        """Sample the cell without springs."""
        for sample, rng in self._cells():
            unit = sample.chain.unit
            phi_n, rate = complex_number(rng, 2.0 * unit), complex_number(rng, unit)
            uniform = dict.fromkeys(range(-self.model.reach, self.model.reach + 1), phi_n)
            expected = sample.chain.averaged_rate(uniform)
            yield as_point(sample.chain, {0: phi_n}, rate), [rate - expected]

    @at_points("moduli and arguments of numbers")
    def polar(self) -> Points:
        """Compare with modulus and argument of a number."""
        for phi_n in (0.7 - 0.4j, -1.1 + 0.2j):
            yield {_PHI_N: phi_n, s.radius: abs(phi_n), s.phase: cmath.phase(phi_n)}, [0]

    @at_points("Eq. (8) averaged by sampling")
    def cell_parts(self) -> Points:
        """Compare with the rate of a real amplitude: real and imaginary part."""
        for sample, rng in self._cells():
            unit = sample.chain.unit
            amplitude, rate = unit * rng.uniform(0.3, 2), unit * rng.uniform(0.3, 2)
            phase_rate = rng.uniform(0.3, 2)
            expected = sample.chain.cell_rate(amplitude) * amplitude
            point = {s.radius: amplitude, s.radius.diff(t): rate, s.phase.diff(t): phase_rate,
                     **sample.chain.values}  # fmt: skip
            yield point, [rate - expected.real, amplitude * phase_rate - expected.imag]

    @at_points("the sampled loss of the cell")
    def amplitude_rate(self) -> Points:
        """Compare after solving for the rate of the amplitude."""
        for sample, rng in self._cells():
            amplitude = sample.chain.unit * rng.uniform(0.3, 2)
            yield {s.radius: amplitude, s.radius.diff(t): sample.rate(amplitude),
                   **sample.chain.values}, [0]  # fmt: skip

    @at_points("the sampled detuning of the cell", floor=0.1)
    def phase_rate(self) -> Points:
        """Compare after solving for the rate of the phase."""
        for sample, rng in self._cells():
            amplitude = sample.chain.unit * rng.uniform(0.3, 2)
            detuning = sample.chain.cell_rate(amplitude).imag
            yield {s.radius: amplitude, s.phase.diff(t): detuning, **sample.chain.values}, [0]

    def cycles(self, candidate: sp.Basic) -> Evidence:
        """Compare with the zeros of the sampled loss."""
        return self.on_cycles("zeros of the sampled loss", 2)(candidate)

    def ratio(self, candidate: sp.Basic) -> Evidence:
        """Compare with the ratio of these zeros."""
        return self.on_cycles("zeros of the sampled loss", 1)(candidate)

    def forcing(self, candidate: sp.Basic) -> Evidence:
        """Compare with the damping coefficients, and require independence of the amplitude."""
        return self.on_cycles("the coefficients of the damping", 1)(candidate)

    @at_points("the slope of the sampled loss", tolerance=1e-7)
    def radial_decay(self) -> Points:
        """Compare with the slope of the sampled loss on the outer cycle."""
        for sample in self.samples:
            step = 1e-3 * sample.outer
            slope = slope_of(sample.rate, sample.outer, step)
            yield {s.radial_rate: -slope, **sample.chain.values}, [0]

    @at_points("the response of the averaged chain to a tiny amplitude", tolerance=1e-7)
    def near_rest(self) -> Points:
        """Compare with the response of the averaged chain to a tiny amplitude."""
        for sample, rng in self._cells():
            field, rate = sites(self.model, rng), complex_number(rng)
            yield as_point(sample.chain, field, rate), [rate - sample.linear(field)]

    def nothing(self, candidate: sp.Basic) -> Evidence:
        """Require that nothing is left, at numerical values."""
        worst = 0.0
        for sample, rng in self._cells():
            point = as_point(sample.chain, sites(self.model, rng), complex_number(rng))
            worst = max(worst, abs(residual(candidate, point)[0]))
        return Evidence(worst < 1e-9, f"no terms remain, for random states: {worst:.1e}")

    @at_points("a displaced number")
    def shifted(self) -> Points:
        """Compare with a relative deviation."""
        point = {_PHI_N: (2 - 1j) * (1.1 + 0.2j), s.phi_s: 2 - 1j, s.deviation: 0.1 + 0.2j}
        yield point, [0]

    @at_points("the linear response about rest, moved to the cycle", tolerance=1e-7)
    def upper(self) -> Points:
        """Compare with the response about rest, shifted to the cycle."""
        for sample, rng in self._cells():
            phi_n, cycle = complex_number(rng, 2.0), complex_number(rng, 2.0)
            uniform = dict.fromkeys(range(-self.model.reach, self.model.reach + 1), phi_n - cycle)
            rate = sample.linear(uniform)
            yield {**as_point(sample.chain, {0: phi_n}, rate), s.phi_s: cycle}, [0]

    @at_points("the linear response about rest", tolerance=1e-7)
    def upper_decay(self) -> Points:
        """Compare with the response about rest, for a relative deviation."""
        for sample, rng in self._cells():
            value = complex_number(rng)
            uniform = dict.fromkeys(range(-self.model.reach, self.model.reach + 1), value)
            rate = sample.linear(uniform)
            yield {s.deviation: value, s.deviation.diff(t): rate, **sample.chain.values}, [0]
