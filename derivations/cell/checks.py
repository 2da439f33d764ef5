"""What the derivation of any cell is held against: averages of its oscillator by sampling."""

from __future__ import annotations

import cmath
import random
from typing import Any

import numpy as np
import sympy as sp

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, equals, solved_for, value
from derivations.algebra.steps import Check, Evidence
from derivations.averaging.symbols import phi
from derivations.cell.cycles import LimitCycle
from derivations.cell.symbols import angle, radius, ratio
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn, numbers_of
from derivations.front.numbers import Lattice, evaluated, kinetic_sum
from derivations.front.symbols import v as v_front
from derivations.multiple_scales.checks import Checks as ScalesChecks
from derivations.symbols import n, t

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
        self.motion = ScalesChecks(model).chain
        self.averaged = equals(_SAMPLED)(self._averaged_point)
        self.polar = equals("modulus and argument")(_polar_point)
        self.parts = equals(_SAMPLED, parts=2)(self._parts_point)
        self.amplitude = equals(_SAMPLED)(lambda rng: self._part_point(rng, 0))
        self.frequency = equals(_SAMPLED, floor=1.0)(lambda rng: self._part_point(rng, 1))

    def _averaged_point(self, rng: random.Random) -> tuple[Point, list[complex]]:
        p = drawn(self.model, rng)
        field = {at: complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
                 for at in range(-p.reach, p.reach + 1)}  # fmt: skip
        moving = complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point = {**p.values, phi(n, t).diff(t): moving}
        point |= {phi(n + at, t): size for at, size in field.items()}
        return point, [moving - p.averaged_rate(field)]

    def _parts_point(self, rng: random.Random) -> tuple[Point, list[complex]]:
        p, size = drawn(self.model, rng), rng.uniform(0.3, 1.5)
        grow, turn = rng.uniform(0.5, 1), rng.uniform(0.5, 1)
        found = p.cell_rate(size)
        point = {**p.values, radius.diff(t): grow, angle.diff(t): turn, radius: size, angle: 0.3}
        return point, [grow - size * found.real, size * (turn - found.imag)]

    def _part_point(self, rng: random.Random, place: int) -> tuple[Point, list[complex]]:
        point, references = self._parts_point(rng)
        return point, [references[place] / (point[radius] if place else 1)]

    # Cycles.

    def _all_cycles(self, p: ChainNumbers) -> Any:
        """Positive zeros of the sampled rate: a fit through sampled amplitudes, then its roots."""
        degree = max(self.model.damping) // 2
        squares = np.linspace(0.2, 4, degree + 1)
        rates = [-2 * p.cell_rate(float(np.sqrt(q))).real / p.eps for q in squares]
        fit = np.polynomial.polynomial.Polynomial.fit(squares, rates, degree).convert()
        found = np.polynomial.polynomial.polyroots(np.trim_zeros(fit.coef, "b"))
        real = found[(abs(found.imag) < 1e-5) & (found.real > 1e-9)].real
        return np.sqrt(np.sort(real))

    def _draws(self, known: tuple[LimitCycle, ...]) -> list[ChainNumbers]:
        """Coefficients at which every cycle that is listed is real."""
        rng: random.Random = random.Random(5)
        names = self.model.parameters
        kept: list[ChainNumbers] = []
        if all(q.amplitude.is_number for q in known):  # every draw will do
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
                exact = self._all_cycles(p)
                listed = sorted(
                    solved_for(part, sp.Symbol(f"r_{place}"), p.values).real
                    for place, part in enumerate(_parts(candidate), start=1)
                )
                double = sum(cycle.multiplicity - 1 for cycle in known)
                if len(listed) + double != len(exact):
                    return Evidence(False, f"{len(listed)} cycles, but sampling finds {len(exact)}")
                if not double:
                    worst = max(worst, *(abs(p - q) for p, q in zip(listed, exact, strict=True)))
            return Evidence(worst < 1e-6, f"the zeros of the sampled rate: off by {worst:.1e}")

        return check

    def growth(self, known: tuple[LimitCycle, ...]) -> Check:
        """Differentiate the sampled rate."""

        def check(candidate: sp.Basic) -> Evidence:
            worst, step = 0.0, 1e-4
            draws = self._draws(known)
            if not draws:
                return Evidence(False, "no coefficients were found at which the cycles are real")
            for p in draws:
                pairs = zip(_parts(candidate), known, strict=True)
                for place, (part, cycle) in enumerate(pairs, start=1):
                    size = value(cycle.amplitude, p.values).real
                    sides = [(size + d) * p.cell_rate(size + d).real / p.eps
                             for d in (step, -step)]  # fmt: skip
                    exact = (sides[0] - sides[1]) / (2 * step)
                    found = solved_for(part, sp.Symbol(f"lambda_{place}"), p.values).real
                    worst = max(worst, abs(found - exact) / (1 + abs(exact)))
            return Evidence(worst < 1e-5, f"the slope of the sampled rate: off by {worst:.1e}")

        return check

    def ratio(self, known: tuple[LimitCycle, ...]) -> Check:
        """Divide the sampled cycles."""

        def check(candidate: sp.Basic) -> Evidence:
            worst = 0.0
            for p in self._draws(known):
                inner, outer = self._all_cycles(p)
                found = solved_for(candidate, ratio, p.values)
                worst = max(worst, abs(found - inner / outer))
            return Evidence(worst < 1e-6, f"the sampled cycles: off by {worst:.1e}")

        return check

    def relation(self, known: tuple[LimitCycle, ...]) -> Check:
        """Both sides at a velocity: the left by the time-domain front, the right by sampling."""

        def check(candidate: sp.Basic) -> Evidence:
            worst, (left, right) = 0.0, candidate.args
            for p in self._draws(known):
                inner, outer = self._all_cycles(p)
                rest, spring = p.damping[0], p.springs[0]
                # The roots are those of the scaled problem; the term holds the scaled slope.
                lattice = Lattice(0.5, (spring / rest,))
                found = evaluated(left, {v_front: 0.6 * rest, **p.values}, lattice, 0.6)
                worst = max(worst, abs(found - abs(kinetic_sum(lattice, 0.6))))
                worst = max(
                    worst, abs(value(right, {**p.values, ratio: inner / outer}) - 2 * inner / outer)
                )
            return Evidence(
                worst < 1e-6, f"the front in the time domain and the sampled cycles: {worst:.1e}"
            )

        return check


def _parts(candidate: sp.Basic) -> tuple[sp.Basic, ...]:
    return parts_of(candidate)


def _polar_point(rng: random.Random) -> Point:
    size, turn = rng.uniform(0.3, 2), rng.uniform(-3, 3)
    return {radius: size, angle: turn, phi(n, t): size * cmath.exp(1j * turn)}
