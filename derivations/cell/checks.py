"""Checks of the derivation for any cell, by averages of its oscillator over samples.

Amplitudes are drawn and compared in units of the order of those of the cycles.
"""

from __future__ import annotations

import cmath
import random

import sympy as sp

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, equals, solved_for, value
from derivations.algebra.steps import Check, Evidence
from derivations.averaging.cycles import LimitCycle
from derivations.averaging.symbols import angle, phi, radius, ratio
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn, numbers_of
from derivations.front.numbers import Lattice, evaluated, kinetic_sum
from derivations.front.symbols import v as v_front
from derivations.multiple_scales.two_times_checks import TwoTimesChecks
from derivations.symbols import c, n, t

_SAMPLED = "the equation averaged by direct sampling"


class CellChecks:
    """The checks of the derivation of one cell.

    Parameters
    ----------
    model : ChainModel
        The cell in its chain.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model
        self.motion = TwoTimesChecks(model).chain

    @equals(_SAMPLED)
    def averaged(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw an envelope at coupled sites, and its rate."""
        p = drawn(self.model, rng)
        field = {at: p.unit * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
                 for at in range(-p.reach, p.reach + 1)}  # fmt: skip
        moving = p.unit * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point = {**p.values, phi(n, t).diff(t): moving}
        point |= {phi(n + at, t): size for at, size in field.items()}
        return point, [moving - p.averaged_rate(field)]

    @staticmethod
    @equals("modulus and argument")
    def polar(rng: random.Random) -> Point:
        """Compare the polar form with cosine and sine."""
        size, turn = rng.uniform(0.3, 2), rng.uniform(-3, 3)
        return {radius: size, angle: turn, phi(n, t): size * cmath.exp(1j * turn)}

    @equals(_SAMPLED, parts=2)
    def parts(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compute the rates of modulus and argument from the rate of a cell."""
        return self._parts(rng)

    @equals(_SAMPLED)
    def amplitude(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the rate of the modulus."""
        point, references = self._parts(rng)
        return point, references[:1]

    @equals(_SAMPLED, floor=1.0)
    def frequency(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the rate of the argument."""
        point, references = self._parts(rng)
        return point, [references[1] / point[radius]]

    def _parts(self, rng: random.Random) -> tuple[Point, list[complex]]:
        p = drawn(self.model, rng)
        size, grow = p.unit * rng.uniform(0.3, 1.5), p.unit * rng.uniform(0.5, 1)
        turn = rng.uniform(0.5, 1)
        found = p.cell_rate(size)
        point = {**p.values, radius.diff(t): grow, angle.diff(t): turn, radius: size, angle: 0.3}
        return point, [grow - size * found.real, size * (turn - found.imag)]

    # Cycles.

    def _draws(self, known: tuple[LimitCycle, ...]) -> list[ChainNumbers]:
        """Return coefficients for which every listed cycle is real."""
        rng: random.Random = random.Random(5)
        names = self.model.parameters
        kept: list[ChainNumbers] = []
        if all(q.amplitude.is_number for q in known):  # every draw is suitable
            return [drawn(self.model, rng) for _ in range(2)]
        amplitudes = [sp.lambdify(names, q.amplitude, "cmath") for q in known]
        for _ in range(4000):
            given = {symbol: rng.uniform(0.3, 3) for symbol in names}
            listed = [complex(amplitude(*given.values())) for amplitude in amplitudes]
            if all(abs(q.imag) < 1e-12 and q.real > 1e-6 for q in listed):
                kept.append(numbers_of(self.model, given, 0.4))
            if len(kept) == 2:
                break
        return kept

    def cycles(self, known: tuple[LimitCycle, ...]) -> Check:
        """Find all zeros of the sampled rate."""

        def check(candidate: sp.Basic) -> Evidence:
            draws, worst = self._draws(known), 0.0
            if not draws:
                return Evidence(False, "no coefficients were found at which the cycles are real")
            for p in draws:
                exact = p.cycles()
                listed = sorted(
                    solved_for(part, sp.Symbol(f"r_{place}"), p.values).real
                    for place, part in enumerate(parts_of(candidate), start=1)
                )
                double = sum(cycle.multiplicity - 1 for cycle in known)
                if len(listed) + double != len(exact):
                    return Evidence(False, f"{len(listed)} cycles, but sampling finds {len(exact)}")
                if not double:
                    pairs = zip(listed, exact, strict=True)
                    worst = max(worst, *(abs(one - other) / p.unit for one, other in pairs))
            return Evidence(worst < 1e-6, f"the zeros of the sampled rate: off by {worst:.1e}")

        return check

    def growth(self, known: tuple[LimitCycle, ...]) -> Check:
        """Differentiate the sampled rate."""

        def check(candidate: sp.Basic) -> Evidence:
            worst = 0.0
            draws = self._draws(known)
            if not draws:
                return Evidence(False, "no coefficients were found at which the cycles are real")
            for p in draws:
                pairs, step = zip(parts_of(candidate), known, strict=True), 1e-4 * p.unit
                for place, (part, cycle) in enumerate(pairs, start=1):
                    size = value(cycle.amplitude, p.values).real
                    sides = [(size + d) * p.cell_rate(size + d).real / p.eps
                             for d in (step, -step)]  # fmt: skip
                    exact = (sides[0] - sides[1]) / (2 * step)
                    found = solved_for(part, sp.Symbol(f"lambda_{place}"), p.values).real
                    worst = max(worst, abs(found - exact) / (p.strength + abs(exact)))
            return Evidence(worst < 1e-5, f"the slope of the sampled rate: off by {worst:.1e}")

        return check

    def ratio(self, known: tuple[LimitCycle, ...]) -> Check:
        """Divide the sampled cycles."""

        def check(candidate: sp.Basic) -> Evidence:
            worst = 0.0
            for p in self._draws(known):
                inner, outer = p.cycles()
                found = solved_for(candidate, ratio, p.values)
                worst = max(worst, abs(found - inner / outer))
            return Evidence(worst < 1e-6, f"the sampled cycles: off by {worst:.1e}")

        return check

    def relation(self, known: tuple[LimitCycle, ...]) -> Check:
        """Compare the left side with the time-domain front, the right with sampled cycles."""

        def check(candidate: sp.Basic) -> Evidence:
            worst, (left, right) = 0.0, candidate.args
            for p in self._draws(known):
                inner, outer = p.cycles()
                values, rest, spring = dict(p.values), p.damping[0], p.springs[0]
                if self.model.is_scaled_by_c:  # otherwise c/h(0) may be of any size
                    stronger = 0.7 * rest / abs(spring)
                    values[c] *= stronger
                    spring *= stronger
                # The roots are those of the scaled problem; the term contains the scaled slope.
                lattice = Lattice(0.5, (spring / rest,))
                found = evaluated(left, {v_front: 0.6 * rest, **values}, lattice, 0.6)
                worst = max(worst, abs(found - abs(kinetic_sum(lattice, 0.6))))
                worst = max(
                    worst, abs(value(right, {**p.values, ratio: inner / outer}) - 2 * inner / outer)
                )
            return Evidence(
                worst < 1e-6, f"the front in the time domain and the sampled cycles: {worst:.1e}"
            )

        return check
