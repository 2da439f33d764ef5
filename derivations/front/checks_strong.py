"""Checks of the speed law: linear waves of (8), and direct runs of fronts of the averaged chain."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache
from itertools import islice
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar
from scipy.special import expit

from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import Points, at_points, solved_for
from derivations.algebra.steps import Evidence
from derivations.chain_numbers import ChainNumbers
from derivations.front import symbols as s
from derivations.front.sampling import Sample, SampledChecks, cells
from derivations.symbols import c, epsilon, n, omega, t, y

FASTEST_RETURN = 200.0
"""Largest rate of return of a cell to its cycle, over its damping at rest; with it, a check of the
speed law takes ten seconds."""


def _shape(z: Any) -> Any:
    return mp.tanh(1 - z) + 0.3 * mp.sin(z)


class StrongChecks(SampledChecks):
    """The checks of the speed law."""

    @at_points("the forces on a chain at rest", floor=1.0)
    def rest(self) -> Points:
        """Require that there is no force without displacement."""
        for sample in self.samples:
            at_rest = dict.fromkeys(range(-self.model.reach, self.model.reach + 1), 0.0)
            yield {y(n, t): sample.chain.rest(at_rest, 0.0)}, [0]

    def _linear_force(self, sample: Sample, field: dict[int, float], rate: float) -> float:
        """Return the force of a displacement minus that of its opposite, without even powers."""
        forward, backward = (
            sample.chain.rest({place: size * value for place, value in field.items()}, size * rate)
            for size in (sample.tiny, -sample.tiny)
        )
        return float(forward - backward) / (2 * sample.tiny)

    @at_points("forces at a tiny displacement", tolerance=1e-8)
    def chain_near_rest(self) -> Points:
        """Compare with forces at a tiny displacement."""
        rng = random.Random(8)
        for sample in self.samples:
            field = {q: rng.uniform(-1, 1)
                     for q in range(-self.model.reach, self.model.reach + 1)}  # fmt: skip
            rate, acceleration = rng.uniform(-1, 1), rng.uniform(-1, 1)
            point: dict[Any, Any] = {s.deviation_field(n + q, t): value
                                     for q, value in field.items()}  # fmt: skip
            z_n = s.deviation_field(n, t)
            point |= {z_n.diff(t): rate, z_n.diff(t, 2): acceleration, **sample.chain.values}
            yield point, [acceleration + self._linear_force(sample, field, rate)]

    def _omega_squared(self, chain: ChainNumbers) -> Callable[[Any], Any]:
        """Return omega² of a wave, from the pull of the springs on a cosine."""

        def of(q: Any) -> Any:
            field = {place: mp.cos(q * place) for place in range(-chain.reach, chain.reach + 1)}
            return 1 - chain.eps * chain.tension(field)

        return of

    @at_points("the pull of the springs on a cosine")
    def linear_waves(self) -> Points:
        """Compare with the pull of the springs on a cosine."""
        for sample, q in zip(self.samples, (0.4, 1.7, 2.9), strict=True):
            frequency = math.sqrt(float(self._omega_squared(sample.chain)(q)))
            yield {**sample.chain.values, s.q: q, omega: frequency}, [0]

    @at_points("numerical derivatives of the frequency", tolerance=1e-6)
    def frequency_derivatives(self) -> Points:
        """Compare with numerical derivatives of the frequency."""
        for sample, q in zip(self.samples, (0.4, 1.7, 2.9), strict=True):
            omega_squared = self._omega_squared(sample.chain)
            rates = [
                float(mp.diff(lambda k, f=omega_squared: mp.sqrt(f(k)), q, j)) for j in range(4)
            ]
            yield {**sample.chain.values, s.q: q, omega: rates[0], s.w_1: rates[1],
                   s.w_2: rates[2], s.w_3: rates[3]}, [0, 0, 0]  # fmt: skip

    @at_points("the sampled loss of the cell")
    def local_rate(self) -> Points:
        """Compare with the sampled loss of the cell."""
        for sample in self.samples:
            for amplitude in (0.6, 1.8):
                yield {s.envelope: amplitude, s.envelope.diff(t): sample.rate(amplitude),
                       **sample.chain.values}, [0]  # fmt: skip

    @at_points("the frequency at a distance from the carrier, and the sampled loss", tolerance=1e-8)
    def modulated(self) -> Points:
        """Compare with a tiny wave off the carrier's wave number, and with a uniform envelope."""
        one, three = 0.7, -0.4
        for sample in self.samples:
            for distance in (0.3, -0.8):
                tiny = sample.tiny
                decay = sample.rate(tiny) / tiny
                rotation = -1j * (one * distance + three * distance**3 / 6)
                yield self._envelope(sample, tiny, (rotation + decay) * tiny,
                                     [tiny * (1j * distance) ** j for j in (1, 3)],
                                     one=one, three=three), [0]  # fmt: skip
            yield self._envelope(sample, 1.4, sample.rate(1.4), [0, 0],
                                 one=one, three=three), [0]  # fmt: skip

    def _envelope(self, sample: Sample, size: float, rate: complex, slopes: list[complex],
                  *, one: float, three: float) -> dict[Any, Any]:  # fmt: skip
        return {s.envelope: size, s.envelope.diff(t): rate, s.envelope.diff(s.position): slopes[0],
                s.envelope.diff((s.position, 3)): slopes[1], s.w_1: one, s.w_3: three,
                **sample.chain.values}  # fmt: skip

    @at_points("a shape watched at a fixed place")
    def inner_scale(self) -> Points:
        """Compare with a shape observed at a fixed position."""
        position, time, velocity, length = 1.7, 0.6, 0.9, 2.3
        observed = float(_shape((position - velocity * time) / length))
        moving = s.profile((s.position - s.speed * t) / s.length)
        point = {s.envelope: observed, moving: observed,
                 s.inner: float(_shape((position - velocity * time) / length))}  # fmt: skip
        yield point, [0, 0]

    def _frames(self) -> Iterator[tuple[Sample, dict[Any, Any], dict[str, float]]]:
        rng = random.Random(9)
        for sample in self.samples:
            numbers = {name: rng.uniform(0.3, 1.5) for name in ("v", "length", "w", "g", "z")}
            z = numbers["z"]
            slopes = [float(mp.diff(_shape, z, j)) for j in range(4)]
            point: dict[Any, Any] = {s.inner: slopes[0], s.length: numbers["length"],
                                     s.w_1: numbers["w"], **sample.chain.values}  # fmt: skip
            for order in (1, 2, 3):
                point[s.inner.diff(*[s.inner_position] * order)] = slopes[order]
            numbers |= {"d1": slopes[1], "d3": slopes[3], "loss": sample.rate(slopes[0])}
            yield sample, point, numbers

    def _moving_residual(self, numbers: dict[str, float]) -> float:
        """Return the residual of a moving envelope: its rate, minus dispersion and loss."""
        length = numbers["length"]
        rate = -numbers["v"] * numbers["d1"] / length
        dispersion = -numbers["w"] * numbers["d1"] / length - numbers["g"] * numbers["d3"] / (
            6 * length**3
        )
        return rate - dispersion - numbers["loss"]

    @at_points("a moving shape, differentiated numerically", tolerance=1e-7)
    def inner_frame(self) -> Points:
        """Compare with a test shape and its numerical derivatives."""
        for _, point, numbers in self._frames():
            yield (
                {**point, s.speed: numbers["v"], s.w_3: -numbers["g"]},
                [self._moving_residual(numbers)],
            )

    @at_points("numbers for both")
    def sizes(self) -> Points:
        """Compare the velocity on both clocks, and a sign."""
        point = {s.speed: 0.34, s.v: 1.7, epsilon: 0.2, s.w_3: -0.6, s.w_3_size: 0.6}
        yield point, [0, 0]

    @at_points("a moving shape, differentiated numerically", tolerance=1e-7)
    def inner_named(self) -> Points:
        """Compare with a test shape and its derivatives, per unit of slow time."""
        for sample, point, numbers in self._frames():
            eps = sample.chain.eps
            yield (
                {**point, s.v: numbers["v"] / eps, s.w_3_size: numbers["g"]},
                [self._moving_residual(numbers) / eps],
            )

    def _law_point(self) -> dict[Any, Any]:
        eps, size, kappa, group = 0.13, 0.8, -0.45, 0.37
        length = float(np.cbrt(size / (6 * eps)))
        return {epsilon: eps, s.w_3_size: size, s.kappa_front: kappa, s.w_1: group,
                s.length: length, s.v: group / eps + kappa * length}  # fmt: skip

    @at_points("the scales that make the coefficients one and -κ")
    def speed_law(self) -> Points:
        """Compare length and speed at numerical values."""
        yield self._law_point(), [0, 0]

    @at_points("the scales that make the coefficients one and -κ")
    def speed_alone(self) -> Points:
        """Compare the speed at numerical values."""
        yield self._law_point(), [0]

    @at_points("a shape differentiated numerically, and the sampled loss", tolerance=1e-7)
    def inner_problem(self) -> Points:
        """Compare with the third derivative minus kappa times the first plus the cell's loss."""
        for sample, point, numbers in self._frames():
            kappa = -0.7
            residual = numbers["d3"] - kappa * numbers["d1"] - numbers["loss"] / sample.chain.eps
            yield {**point, s.kappa_front: kappa, s.w_3_size: numbers["g"]}, [residual]

    def _fastest(self, sample: Sample) -> tuple[float, float, float]:
        """Return wave, largest group velocity and third derivative, by maximisation."""
        if sample not in self._found:
            self._found[sample] = self._maximised(sample.chain)
        return self._found[sample]

    @cached_property
    def _found(self) -> dict[Sample, tuple[float, float, float]]:
        return {}

    def _maximised(self, chain: ChainNumbers) -> tuple[float, float, float]:
        omega_squared = self._omega_squared(chain)

        def group(q: float) -> float:
            return float(mp.diff(lambda k: mp.sqrt(omega_squared(k)), q))

        found = float(minimize_scalar(lambda q: -group(q), bounds=(0.05, 3.1), method="bounded",
                                      options={"xatol": 1e-10}).x)  # fmt: skip
        third = float(mp.diff(lambda k: mp.sqrt(omega_squared(k)), found, 3))
        return found, group(found), third

    @at_points("the largest group velocity, by maximisation", tolerance=1e-6, floor=1.0)
    def fastest(self) -> Points:
        """Maximise the group velocity numerically."""
        for sample in self.samples:
            yield {**sample.chain.values, s.q: self._fastest(sample)[0]}, [0]

    def _speeds(self) -> Iterator[tuple[dict[Any, Any], float, float]]:
        for sample in self.samples:
            _, group, third = self._fastest(sample)
            yield (
                {**sample.chain.values, s.w_1: group, s.w_3: third, s.w_3_size: -third},
                group,
                third,
            )

    @at_points("the largest group velocity, by maximisation", tolerance=1e-6)
    def largest_group_velocity(self) -> Points:
        """Compare the group velocity and the third derivative with those found by maximisation."""
        for point, _, _ in self._speeds():
            yield point, [0, 0]

    dispersion_size = largest_group_velocity

    @at_points("the largest group velocity, by maximisation", tolerance=1e-6)
    def closed_law(self) -> Points:
        """Compare with group velocity and third derivative by maximisation."""
        for point, group, third in self._speeds():
            eps, kappa = point[epsilon], -0.45
            velocity = group / eps + kappa * float(np.cbrt(-third / (6 * eps)))
            yield {**point, s.kappa_front: kappa, s.v: velocity}, [0]

    @cached_property
    def _slow_cell(self) -> Sample:
        """Return the cell of slowest return; the law is for couplings much above its rates."""
        drawn = islice(cells(self.model), 12)
        return min(drawn, key=lambda each: each.return_rate / each.damping_at_rest)

    def weak_law(self, candidate: sp.Basic) -> Evidence:
        """Compare with fronts of the averaged chain, with kappa from the inner problem."""
        sample = self._slow_cell
        relative_return = sample.return_rate / sample.damping_at_rest
        if relative_return > FASTEST_RETURN:
            raise DerivationInputError(
                "damping", self.model.damping_of(sp.Symbol("y")), "that of a cell which returns to "
                f"its cycle at most {FASTEST_RETURN:g} times as fast as it comes to rest (here "
                f"{relative_return:.0f})",
                "take other coefficients, or leave this check out: the runs would take minutes",
            )  # fmt: skip
        kappa = inner_velocity(sample)
        weakest = max(20.0, 0.5 * relative_return)
        errors = []
        for factor in (weakest, 8.0 * weakest):
            multiplier = factor * sample.damping_at_rest / sample.chain.springs[0]
            springs = tuple(q * multiplier for q in sample.chain.springs)
            point = {**sample.chain.values, s.kappa_front: kappa}
            point[c] = point.get(c, 1.0) * multiplier
            predicted = float(solved_for(candidate, s.v, point).real)
            difference = (run_front(sample, springs) - predicted) / sample.damping_at_rest
            errors.append(difference / float(np.cbrt(factor / 6)))
        # The neglected terms are smaller by the square of the length, 8^(2/3) = 4.
        holds = abs(errors[1]) < 0.1 and abs(errors[1]) < 0.5 * abs(errors[0])
        return Evidence(
            holds,
            f"runs of the averaged chain at c = {weakest:.3g}, {8 * weakest:.3g} times its damping "
            f"at rest with κ = {kappa:.4f}: off by {errors[0]:.1e}, {errors[1]:.1e} of the length",
        )


def _loss(sample: Sample) -> Callable[[Any], Any]:
    """Return the loss of the cell per unit of eps t, as a polynomial fitted to samples."""
    degree = len(sample.chain.damping)
    amplitudes = (
        sample.outer * 1.2 * np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (2 * degree + 2))
    )
    rates = [
        sample.rate(float(amplitude)) / sample.chain.eps / amplitude for amplitude in amplitudes
    ]
    fit = np.polynomial.Polynomial.fit(amplitudes**2, rates, (degree + 1) // 2)
    return lambda amplitude: amplitude * fit(amplitude**2)


@lru_cache(maxsize=8)
def inner_velocity(sample: Sample) -> float:
    """Return kappa, for which rest at +infinity is connected to the cycle at -infinity.

    The only direction in which solutions leave rest backwards is followed. Below and above kappa
    the path misses the cycle on different sides, running away upwards or falling back, which is
    used for bisection.
    """
    loss, length = _loss(sample), 1.0 / float(np.cbrt(sample.damping_at_rest))

    def misses(kappa: float) -> int:
        rates = np.roots([1.0, 0.0, -kappa, sample.lattice.decay])
        (rate,) = (q.real for q in rates if abs(q.imag) < 1e-12 and q.real < 0)
        start = 1e-4 * sample.inner * np.array([1.0, rate, rate**2])

        def slopes(_: float, state: Any) -> list[float]:
            return [-state[1], -state[2], -(kappa * state[1] + float(loss(state[0])))]

        def high(_: float, state: Any) -> float:
            return float(state[0] - 2 * sample.outer)

        def low(_: float, state: Any) -> float:
            return float(state[0] - 0.5 * sample.inner)

        high.terminal = low.terminal = True  # type: ignore[attr-defined]
        low.direction = -1.0  # type: ignore[attr-defined]
        run = solve_ivp(slopes, (0, 200 * length), start, events=(high, low), rtol=1e-8, atol=1e-10)
        events = run.t_events or []
        return 1 if events and events[0].size else -1

    below, above = -3.0 / length**2, 4.0 / length**2
    sign = misses(below)
    while misses(above) == sign:  # the faster the cell goes to its cycle, the larger kappa is
        below, above = above, 2.0 * above
        if above > 200.0 / length**2:
            raise ArithmeticError("kappa is not bracketed")
    for _ in range(22):
        middle = (below + above) / 2
        if misses(middle) == sign:
            below = middle
        else:
            above = middle
    return (below + above) / 2


@lru_cache(maxsize=16)
def run_front(sample: Sample, springs: tuple[float, ...]) -> float:
    """Return the velocity of a front of the averaged chain, per unit of eps t, from a direct run.

    Phase steps of -pi/2 make the amplitudes real; see 'amplitudes in quarter turns'.
    """
    loss, end, first = _loss(sample), 12.0 / sample.damping_at_rest, springs[0]
    sites = int(1.4 * first * end) + 60
    position = np.arange(sites)
    width = 2 * np.cbrt(max(first / sample.damping_at_rest, 1.0) / 6)
    r = sample.outer * expit((20 - position) / width)
    step = min(0.8 / first, 1.0 / sample.return_rate)  # a longer one runs away from the cycle
    half = 0.5 * sample.outer

    def rates(r: Any) -> Any:
        left = np.concatenate([r[:1], r[:-1]])
        right = np.concatenate([r[1:], [0.0]])
        return 0.5 * first * (left - right) + loss(r)

    positions: list[tuple[float, float]] = []
    for count in range(int(end / step)):
        k1 = rates(r)
        k2 = rates(r + step / 2 * k1)
        k3 = rates(r + step / 2 * k2)
        r = r + step / 6 * (k1 + 2 * k2 + 2 * k3 + rates(r + step * k3))
        if (count + 1) * step > 0.6 * end:
            last = int(np.flatnonzero(r > half)[-1])
            positions.append(
                ((count + 1) * step, last + (r[last] - half) / (r[last] - r[last + 1]))
            )
    times, places = np.array(positions).T
    return float(np.polyfit(times, places, 1)[0])
