"""The derivation of the averaged equation of any oscillator, with a check in each step."""

from __future__ import annotations

import random
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from derivations import front_numbers
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import Point, equals, fast_average, parts_of, solved_for, value
from derivations.derivation import Derivation, Evidence, Step, equation
from derivations.envelope import PHI, Envelope, phi_rate, r, r_rate, square
from derivations.front_symbols import SumOver
from derivations.front_symbols import c as c_front
from derivations.front_symbols import v as v_front
from derivations.symbols import epsilon, site, t

shift = sp.Symbol("Omega", real=True)
ratio = sp.Symbol(r"|\varphi_us|/|\varphi_s|", positive=True)

_SAMPLED = "the equation averaged by direct sampling"


def derive(envelope: Envelope) -> Derivation:
    """Equation, average, amplitude, cycles, stability, and the front that follows from them."""
    oscillator = envelope.oscillator
    y, numbers = site(), _Numbers(envelope)
    damping = sum(value * y**power for power, value in oscillator.damping.items())
    stiffness = sum((value * y**power for power, value in oscillator.stiffness.items()), sp.S.Zero)
    springs = oscillator.coupling * (2 * y - site(-1) - site(1))
    motion = y.diff(t, 2) + y + epsilon * (y.diff(t) * damping + stiffness + springs)
    steps = [
        Step("The oscillator in its chain", equation(motion, 0),
             equals(numbers.motion, "spring, damper and neighbours, term by term")),
        Step("Averaged over the fast period: y = Im(phi e^{it}), prime is d/d(eps t)",
             envelope.equation, equals(numbers.averaged, _SAMPLED)),
        Step("Amplitude of the isolated cell", envelope.amplitude_equation,
             equals(numbers.amplitude, _SAMPLED)),
        Step("Frequency of the isolated cell: 1 + eps Omega",
             equation(shift, envelope.shift_mean.subs(square, r**2)),
             equals(numbers.frequency, _SAMPLED, floor=1.0)),
    ]  # fmt: skip
    try:
        cycles = envelope.cycles
    except DerivationInputError:
        return Derivation("cell", f"Averaged equation of {_title(envelope)}", tuple(steps))
    if cycles:
        amplitudes = sp.Tuple(*(equation(sp.Symbol(f"r_{k}"), cycle.amplitude)
                                for k, cycle in enumerate(cycles, start=1)))  # fmt: skip
        growth = sp.Tuple(*(equation(sp.Symbol(f"lambda_{k}"), cycle.exponent)
                            for k, cycle in enumerate(cycles, start=1)))  # fmt: skip
        kinds = ", ".join(cycle.stability or "stable where negative" for cycle in cycles)
        steps += [
            Step("All limit cycles (each exists where its amplitude is real)", amplitudes,
                 numbers.cycles),
            Step(f"Growth rate of a small change of each amplitude ({kinds})", growth,
                 numbers.growth),
        ]  # fmt: skip
    try:
        relation = envelope.kinetic_relation()
    except DerivationInputError:
        return Derivation("cell", f"Averaged equation of {_title(envelope)}", tuple(steps))
    left_out = f" ({relation.neglected})" if relation.neglected else ""
    steps += [
        Step("Ratio of the unstable to the stable cycle", equation(ratio, relation.ratio),
             numbers.ratio),
        Step(f"Kinetic relation of the piecewise-linear front{left_out}; M+ holds the roots of "
             "(50) in the upper half-plane at v_hat and c divided by the damping at rest",
             relation.equation, numbers.relation),
    ]  # fmt: skip
    return Derivation("cell", f"Averaged equation of {_title(envelope)}", tuple(steps))


def _title(envelope: Envelope) -> str:
    y = sp.Symbol("y")
    h = sum(value * y**power for power, value in envelope.oscillator.damping.items())
    return f"the cell with damping {sp.sstr(h)}"


class _Numbers:
    """Random coefficients for one envelope, and averages of its oscillator by sampling."""

    def __init__(self, envelope: Envelope) -> None:
        self.envelope = envelope
        self.oscillator = envelope.oscillator
        self._seen: dict[Any, tuple[list[float], list[float], float]] = {}

    def given(self, rng: random.Random) -> dict[Any, Any]:
        return {symbol: rng.uniform(0.3, 3) for symbol in self.envelope.symbols}

    def _concrete(self, given: dict[Any, Any]) -> tuple[list[float], list[float], float]:
        """Damping and stiffness from the highest power down, and the coupling, as floats."""
        key = tuple(given.values())
        if key not in self._seen:
            h, g = (
                [float(sp.sympify(powers.get(power, 0)).subs(given))
                 for power in range(max(powers, default=0), -1, -1)]
                for powers in (self.oscillator.damping, self.oscillator.stiffness)
            )  # fmt: skip
            self._seen[key] = h, g, float(sp.sympify(self.oscillator.coupling).subs(given))
        return self._seen[key]

    def force(self, y: Any, velocity: Any, given: dict[Any, Any]) -> Any:
        """Damping and stiffness on numbers."""
        h, g, _ = self._concrete(given)
        return velocity * np.polyval(h, y) + np.polyval(g, y)

    def mean(self, values: list[complex], given: dict[Any, Any]) -> complex:
        """phi'/eps of the middle site, by sampling one period."""
        spring = self._concrete(given)[2]

        def at(when: Any) -> Any:
            own, left, right = (value * np.exp(1j * when) for value in values)
            neighbours = spring * (2 * own - left - right).imag
            force = self.force(own.imag, own.real, given) + neighbours
            return -np.exp(-1j * when) * force

        return fast_average(at, samples=256)

    def motion(self, rng: random.Random) -> tuple[Point, list[complex]]:
        given, e = self.given(rng), rng.uniform(0.1, 0.5)
        y, left, right, rate, second = (rng.uniform(-1, 1) for _ in range(5))
        spring = self._concrete(given)[2]
        force = self.force(y, rate, given) + spring * (2 * y - left - right)
        point = {**given, epsilon: e, site(): y, site(-1): left, site(1): right,
                 site().diff(t): rate, site().diff(t, 2): second}  # fmt: skip
        return point, [second + y + e * force]

    def averaged(self, rng: random.Random) -> tuple[Point, list[complex]]:
        given = self.given(rng)
        values = [complex(rng.uniform(-1, 1), rng.uniform(-1, 1)) for _ in range(3)]
        moving = complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point = {**given, PHI[0]: values[0], PHI[-1]: values[1], PHI[1]: values[2],
                 phi_rate: moving}  # fmt: skip
        return point, [moving - self.mean(values, given)]

    def _single(self, size: float, given: dict[Any, Any]) -> complex:
        """phi'/(eps phi) of the isolated cell."""
        alone = {**given}
        return self.mean([complex(size), 0, 0], alone) / size - 1j * self._concrete(given)[2]

    def amplitude(self, rng: random.Random) -> tuple[Point, list[complex]]:
        given, size, moving = self.given(rng), rng.uniform(0.3, 1.5), rng.uniform(0.5, 1)
        return {**given, r: size, r_rate: moving}, [moving - size * self._single(size, given).real]

    def frequency(self, rng: random.Random) -> tuple[Point, list[complex]]:
        given, size, other = self.given(rng), rng.uniform(0.3, 1.5), rng.uniform(0.5, 1)
        return {**given, r: size, shift: other}, [other - self._single(size, given).imag]

    def _all_cycles(self, given: dict[Any, Any]) -> Any:
        """Positive zeros of the sampled rate: a fit through sampled amplitudes, then its roots."""
        degree = max(self.oscillator.damping) // 2
        squares = np.linspace(0.2, 4, degree + 1)
        rates = [-2 * self._single(float(np.sqrt(q)), given).real for q in squares]
        fit = np.polynomial.polynomial.Polynomial.fit(squares, rates, degree).convert()
        found = np.polynomial.polynomial.polyroots(np.trim_zeros(fit.coef, "b"))
        real = found[(abs(found.imag) < 1e-5) & (found.real > 1e-9)].real
        return np.sqrt(np.sort(real))

    @cached_property
    def _draws(self) -> list[dict[Any, Any]]:
        """Coefficients at which every cycle that the envelope lists is real."""
        rng: random.Random = random.Random(5)
        kept: list[dict[Any, Any]] = []
        names = self.envelope.symbols
        fixed = all(q.amplitude.is_number for q in self.envelope.cycles)
        if fixed:  # every draw will do
            return [self.given(rng) for _ in range(2)]
        amplitudes = [sp.lambdify(names, q.amplitude, "cmath") for q in self.envelope.cycles]
        for _ in range(4000):
            given = self.given(rng)
            listed = [complex(amplitude(*given.values())) for amplitude in amplitudes]
            if all(abs(q.imag) < 1e-12 and q.real > 1e-6 for q in listed):
                kept.append(given)
            if len(kept) == 2:
                break
        return kept

    def cycles(self, candidate: sp.Basic) -> Evidence:
        draws, worst = self._draws, 0.0
        if not draws:
            return Evidence(False, "no coefficients were found at which the cycles are real")
        for given in draws:
            exact = self._all_cycles(given)
            listed = sorted(
                solved_for(part, sp.Symbol(f"r_{k}"), given).real
                for k, part in enumerate(parts_of(candidate), start=1)
            )
            double = sum(cycle.multiplicity - 1 for cycle in self.envelope.cycles)
            if len(listed) + double != len(exact):
                return Evidence(False, f"{len(listed)} cycles, but sampling finds {len(exact)}")
            if not double:
                worst = max(worst, *(abs(p - q) for p, q in zip(listed, exact, strict=True)))
        return Evidence(worst < 1e-6, f"the zeros of the sampled rate: off by at most {worst:.1e}")

    def growth(self, candidate: sp.Basic) -> Evidence:
        worst, step = 0.0, 1e-4
        for given in self._draws:
            pairs = zip(parts_of(candidate), self.envelope.cycles, strict=True)
            for k, (part, cycle) in enumerate(pairs, start=1):
                size = value(cycle.amplitude, given).real
                sides = [(size + d) * self._single(size + d, given).real for d in (step, -step)]
                exact = (sides[0] - sides[1]) / (2 * step)
                found = solved_for(part, sp.Symbol(f"lambda_{k}"), given).real
                worst = max(worst, abs(found - exact) / (1 + abs(exact)))
        return Evidence(worst < 1e-5, f"the slope of the sampled rate: off by at most {worst:.1e}")

    def ratio(self, candidate: sp.Basic) -> Evidence:
        worst = 0.0
        for given in self._draws:
            inner, outer = self._all_cycles(given)
            worst = max(worst, abs(solved_for(candidate, ratio, given) - inner / outer))
        return Evidence(worst < 1e-6, f"the sampled cycles: off by at most {worst:.1e}")

    def relation(self, candidate: sp.Basic) -> Evidence:
        """Both sides at a velocity: the left by the time-domain front, the right by sampling."""
        worst, (left, right) = 0.0, candidate.args
        for given in self._draws:
            inner, outer = self._all_cycles(given)
            h, _, spring = self._concrete(given)
            rest = h[-1]
            (node,) = left.atoms(SumOver)
            term, variable, roots = node.args
            # The roots are those of the scaled problem; the term already holds the scaled slope.
            point = {v_front: 0.6 * rest, **given}
            scaled = {v_front: 0.6, c_front: spring / rest}
            total = front_numbers.evaluated(
                SumOver(
                    term.xreplace({q: sp.sympify(n) for q, n in point.items()}), variable, roots
                ),
                scaled,
            )
            exact = abs(front_numbers.kinetic_sum(0.6, spring / rest))
            found = value(left.xreplace({node: sp.sympify(complex(total))}), given)
            worst = max(worst, abs(found - exact))
            worst = max(worst, abs(value(right, given) - 2 * inner / outer))
        return Evidence(
            worst < 1e-6, f"the front in the time domain and the sampled cycles: {worst:.1e}"
        )
