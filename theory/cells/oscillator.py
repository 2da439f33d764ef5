"""Cycles of any oscillator ÿ + g(y) + εh(y, ẏ)ẏ = 0, to leading order in ε, and of ẏ + g(y) = 0.

At ε = 0 the energy E = ẏ²/2 + V(y), V' = g, is conserved. Over one cycle it decreases by

    εΔ(A) = ε ∮ h(y, ẏ) ẏ dy,    V(A) = E,                                     (Melnikov)

so that for small ε the amplitude A of a limit cycle is a zero of Δ; the cycle is stable where Δ
increases. For g = ω²y this is the averaged equation r' = -(r/2)H(r²) of (34) without coupling.

References
----------
J. Guckenheimer, P. Holmes (1983), Nonlinear Oscillations, Dynamical Systems, and Bifurcations of
Vector Fields.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from theory.arrays import EPS, FloatArray
from theory.cells.averaging import mean_of_powers
from theory.parameters import ParameterError

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(80)
_SIN, _COS = np.sin(0.5 * math.pi * _NODES), np.cos(0.5 * math.pi * _NODES)
_HALF_TURN = 0.5 * math.pi * _WEIGHTS
_SMALL, _LARGE, _TRIED = 1e-3, 1e3, 600
"""Range of amplitudes, in units of `Oscillator.sizes`, in which Δ, if it is not a polynomial, is
evaluated, and number of values; as many more in proportion if the two sizes differ."""
_WIDEST = 10
"""Largest power of ten of a size: far beyond it, high powers of y overflow."""
_APART = 1e-3
"""Part of the amplitude of a cycle by which those beside it differ, to find how they leave it."""
_ZERO = 1e-12
_CLOSE = 4.0 * EPS
"""Smallest relative tolerance that scipy accepts."""


class OscillatorCycle(NamedTuple):
    """A limit cycle of a cell: its largest y, its largest ẏ, its period, and its stability."""

    amplitude: float
    velocity: float
    period: float
    stable: bool


class Oscillator(ABC):
    """A cell described by its forces; cycles and periods are found here for any cell.

    Attributes
    ----------
    overdamped : bool
        Whether the equation is ẏ + g(y) = 0 instead.
    harmonic : bool
        Whether g = ω²y.
    frequency : float
        Angular frequency ω of small motion.
    """

    overdamped: bool
    harmonic: bool
    frequency: float

    @abstractmethod
    def potential(self, y: FloatArray | float) -> FloatArray:
        """Return V(y), V(0) = 0."""

    @abstractmethod
    def force(self, y: float, v: float, eps: float, step: float) -> tuple[float, float]:
        """Return g(y) + εh(y, v)v and its derivative by v; a cycle takes 100 000 such calls.

        Where the derivative is a central difference, its step is ``step`` times v.
        """

    @abstractmethod
    def damping_at(self, y: FloatArray, v: FloatArray) -> FloatArray:
        """Return h(y, v)."""

    @abstractmethod
    def rest_states(self, side: int = 1) -> list[tuple[float, bool]]:
        """Return the distances of the rest states at y > 0, or at y < 0 for the side -1.

        With each is whether it is stable. Stability is that without inertia: stable rest states are
        minima of the potential.
        """

    @property
    def sizes(self) -> tuple[float, float]:
        """Order of magnitude of the smallest and the largest amplitudes of interest."""
        return 1.0, 1.0

    @property
    def largest(self) -> float:
        """Largest amplitude at which cycles are searched for."""
        return _LARGE * self.sizes[1]

    @cached_property
    def cycles(self) -> tuple[OscillatorCycle, ...]:
        """All cycles from the innermost outwards; for an overdamped cell, rest states at y > 0."""
        if self.overdamped:
            return tuple(
                OscillatorCycle(y, 0.0, math.inf, stable) for y, stable in self.rest_states()
            )
        return tuple(
            self._cycle(
                float(brentq(self.loss, low, high, xtol=1e-14 * low, rtol=1e-14)),
                self.loss(high) > 0.0,
            )
            for low, high in self._brackets()
        )

    def _brackets(self) -> list[tuple[float, float]]:
        """Return intervals of amplitude, ascending, in each of which Δ changes sign once.

        A pair of cycles between two neighbouring amplitudes is found by the extremum of Δ there.
        """
        low, high = self.sizes
        count = round(_TRIED * (1.0 + math.log10(high / low) / math.log10(_LARGE / _SMALL)))
        parts = self._between_barriers(np.geomspace(_SMALL * low, self.largest, count))
        return [each for part in parts for each in self._brackets_among(part)]

    def _between_barriers(self, tried: FloatArray) -> list[FloatArray]:
        """Divide ascending amplitudes where motion begins to pass a barrier of the potential.

        Amplitudes from which motion stays in another well, without passing through y = 0, are left
        out. A ParameterError is raised if motion grows at a barrier, and so leaves for another
        well.
        """
        energy = self.potential(tried)
        passes = energy >= np.maximum.accumulate(energy)
        passed = np.searchsorted([height for _, height in self._barriers], energy)
        divisions = np.flatnonzero(np.diff(passes) | (np.diff(passed) != 0)) + 1
        parts = [each for each in np.split(np.arange(tried.size), divisions) if passes[each[0]]]
        for last in (part[-1] for part in parts if part[-1] + 1 < tried.size):
            if self.loss(tried[last]) < 0.0:
                at = self._barriers[passed[last]][0] if passes[last + 1] else tried[last]
                raise ParameterError(
                    "potential", f"lower beyond y = {at:.4g}", "rising as far as motion "
                    "grows, so that it does not leave for another well",
                    "add damping there, or a stiffer term",
                )  # fmt: skip
        return [tried[part] for part in parts]

    def _brackets_among(self, tried: FloatArray) -> list[tuple[float, float]]:
        """Return such intervals between some amplitudes at all of which Δ is defined."""
        lost = np.array([self.loss(amplitude) for amplitude in tried])
        edges = [float(tried[0])]
        for at in range(1, tried.size):
            sign = math.copysign(1.0, lost[at - 1])
            inner = at + 1 < tried.size and sign * lost[at + 1] > 0.0
            if inner and 0.0 < sign * lost[at] <= min(sign * lost[at - 1], sign * lost[at + 1]):
                lowest = minimize_scalar(
                    lambda amplitude, sign=sign: sign * self.loss(amplitude),
                    bounds=(tried[at - 1], tried[at + 1]), method="bounded",
                    options={"xatol": 1e-9 * tried[at]},
                )  # fmt: skip
                if lowest.fun < 0.0:
                    edges += [float(lowest.x), float(tried[at + 1])]
                    continue
            if sign * lost[at] < 0.0:
                edges += [float(tried[at - 1]), float(tried[at])]
        signs = [self.loss(each) > 0.0 for each in edges]
        return [
            (low, high)
            for low, high, one, other in zip(edges, edges[1:], signs, signs[1:], strict=False)
            if one != other
        ]

    def _check_rest(self, stiffness: float, slope: float) -> None:
        """Refuse a cell that is not at rest, in a minimum of the potential, at y = 0."""
        if stiffness != 0.0:
            raise ParameterError(
                "stiffness at y = 0", f"{stiffness:g}", "zero, so that y = 0 is a state of rest",
                "measure y from a rest state of the cell, if it has one",
            )  # fmt: skip
        if not slope > 0.0:
            raise ParameterError(
                "slope of the stiffness at y = 0", f"{slope:g}", "positive, so that the "
                "rest state is a minimum of the potential", "measure y from such a state",
            )  # fmt: skip

    def velocity(self, amplitude: float) -> float:
        """Return the largest ẏ, attained at y = 0, of the motion of this amplitude at ε = 0."""
        return math.sqrt(2.0 * float(self.potential(amplitude)))

    def loss(self, amplitude: float) -> float:
        """Return Δ/A², the energy lost in a cycle of this amplitude, by quadrature."""
        y, v, dy = self._turn(amplitude)
        return float(np.sum(dy * self._damping_both_ways(y, v) * v)) / amplitude**2

    def _damping_both_ways(self, y: FloatArray, v: FloatArray) -> FloatArray:
        """Return h(y, v) + h(y, -v)."""
        return self.damping_at(y, v) + self.damping_at(y, -v)

    @cached_property
    def relaxation_time(self) -> float:
        """Time εt in which motion at rest or near the unstable cycle forgets its start, if damped.

        It is that in which small motion at rest decays by a factor e or, if shorter, as where small
        motion is hardly damped, twice that in which a deviation from the innermost unstable cycle
        grows by this factor. Both are to first order in ε.
        """
        rest = np.zeros(1)
        fastest = 0.5 * float(self.damping_at(rest, rest)[0])
        unstable = [each.amplitude for each in self.cycles if not each.stable]
        if unstable:
            low, high = ((1.0 + side * _APART) * unstable[0] for side in (-1.0, 1.0))
            lost = self._power(low) - self._power(high)
            growth = lost / float(self.potential(high) - self.potential(low))
            fastest = max(fastest, 0.5 * growth)
        return 1.0 / fastest if fastest > 0.0 else math.inf

    def _power(self, amplitude: float) -> float:
        """Return Δ over the period, the energy lost per unit of εt."""
        return self.loss(amplitude) * amplitude**2 / self.period(amplitude)

    def period(self, amplitude: float) -> float:
        """Return the period of the motion of this amplitude at ε = 0."""
        if self.harmonic:
            return 2.0 * math.pi / self.frequency
        _, v, dy = self._turn(amplitude)
        return 2.0 * float(np.sum(dy / v))

    def _turn(self, amplitude: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return y, v and weights dy of half a cycle, by an angle in which v is smooth."""
        energy = float(self.potential(amplitude))
        low = self._other_end(amplitude, energy)
        middle, half = 0.5 * (amplitude + low), 0.5 * (amplitude - low)
        y = middle + half * _SIN
        v = np.sqrt(2.0 * np.maximum(energy - self.potential(y), 1e-300))
        return y, v, _HALF_TURN * half * _COS

    def _other_end(self, amplitude: float, energy: float) -> float:
        """Return the negative y at which the motion turns, the first one from y = 0."""
        low, high = self._flank(energy)
        if math.isinf(low):
            low = min(-amplitude, 1.5 * high)
            while float(self.potential(low)) < energy:
                low *= 1.5
        tolerance = 1e-15 * self.sizes[0]
        return float(brentq(lambda y: float(self.potential(y)) - energy, low, high, xtol=tolerance))

    @cached_property
    def _barriers(self) -> list[tuple[float, float]]:
        """Maxima of the potential at negative y, with their heights, each higher than the last."""
        found, highest = [], 0.0
        for distance, stable in self.rest_states(-1):
            height = float(self.potential(-distance))
            if not stable and height > highest:
                found.append((-distance, height))
                highest = height
        return found

    def _flank(self, energy: float) -> tuple[float, float]:
        """Return the y between which the potential rises to this energy; -inf if without end."""
        low = next((y for y, height in self._barriers if height >= energy), -math.inf)
        high = min((y for y, height in self._barriers if height < energy), default=0.0)
        return low, high

    def _cycle(self, amplitude: float, stable: bool) -> OscillatorCycle:
        return OscillatorCycle(amplitude, self.velocity(amplitude), self.period(amplitude), stable)


@dataclass(frozen=True, kw_only=True)
class OscillatorCell(Oscillator):
    """A cell given by the coefficients of polynomials; dimensionless.

    Attributes
    ----------
    stiffness : mapping of int to float
        g(y): coefficient of each power of y.
    damping : mapping of (int, int) to float
        h(y, v): coefficient of each yⁱvʲ.
    overdamped : bool
        Whether the equation is ẏ + g(y) = 0 instead.

    Raises
    ------
    ParameterError
        If y = 0 is not a rest state with a restoring force, or large motion grows without bound.

    Examples
    --------
    >>> cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -1.0, (2, 0): 1.0})
    >>> [(round(each.amplitude, 12), each.stable) for each in cell.cycles]
    [(2.0, True)]
    """

    stiffness: Mapping[int, float]
    damping: Mapping[tuple[int, int], float]
    overdamped: bool = False

    def __post_init__(self) -> None:
        g = {power: value for power, value in self.stiffness.items() if value != 0.0}
        object.__setattr__(self, "stiffness", g)
        self._check_rest(g.get(0, 0.0), g.get(1, 0.0))
        highest = max(g)
        if highest % 2 == 0 or g[highest] < 0.0:
            raise ParameterError(
                "stiffness", f"{g[highest]:g} y**{highest} at large y", "of odd degree with a "
                "positive coefficient, so that motion stays bounded", "add a stiffer term",
            )  # fmt: skip
        if not self.overdamped and self._loss_at_large() < 0.0:
            raise ParameterError(
                "damping", "negative over large cycles", "positive there, so that motion stays "
                "bounded", "add a higher even power with a positive coefficient",
            )  # fmt: skip

    @property
    def harmonic(self) -> bool:  # type: ignore[override]
        """Whether g = ω²y."""
        return set(self.stiffness) == {1}

    @property
    def frequency(self) -> float:  # type: ignore[override]
        """Angular frequency ω of small motion."""
        return math.sqrt(self.stiffness[1])

    @cached_property
    def sizes(self) -> tuple[float, float]:
        """Powers of ten nearest to the smallest and the largest amplitude at which terms are equal.

        Terms of g are compared with one another, and terms of h at ẏ = ωy.
        """
        terms: list[dict[int, float]] = [{}, {}]
        for power, value in self.stiffness.items():
            terms[0][power] = abs(value)
        for (i, j), value in self.damping.items():
            if value != 0.0:
                terms[1][i + j] = max(terms[1].get(i + j, 0.0), abs(value) * self.frequency**j)
        equal = [
            math.log10(one[low] / one[high]) / (high - low)
            for one in terms
            for low, high in combinations(sorted(one), 2)
        ]
        low, high = min(equal, default=0.0), max(equal, default=0.0)
        low, high = np.clip((low, high), -_WIDEST, _WIDEST).tolist()
        return 10.0 ** round(low), 10.0 ** round(high)

    @cached_property
    def mean_damping(self) -> FloatArray:
        """Coefficients of H by ascending powers of s = A²; A' = -(εA/2)H(A²) where g = ω²y."""
        found = np.zeros(1 + max((i + j for i, j in self.damping), default=0) // 2)
        for (i, j), value in self.damping.items():
            if i % 2 == 0 and j % 2 == 0:
                moment = 2.0 * float(mean_of_powers(i, j + 2))
                found[(i + j) // 2] += value * self.frequency**j * moment
        return found

    @cached_property
    def cycles(self) -> tuple[OscillatorCycle, ...]:
        """All cycles, as for any cell; where g = ω²y, from the roots of H."""
        if self.overdamped or not self.harmonic:
            return super().cycles
        found = _positive_crossings(self.mean_damping)
        return tuple(self._cycle(math.sqrt(s), stable) for s, stable in found)

    def rest_states(self, side: int = 1) -> list[tuple[float, bool]]:
        """Return the distances of the rest states on a side, and whether they are stable."""
        given = {power: side ** (power + 1) * value for power, value in self.stiffness.items()}
        return _positive_crossings(_ascending(given)[1:])  # zeros of g/y, as of g

    def potential(self, y: FloatArray | float) -> FloatArray:
        """Return V(y), V(0) = 0."""
        return np.asarray(np.polynomial.polynomial.polyval(y, self._potential))

    @cached_property
    def _potential(self) -> FloatArray:
        """Coefficients of V by ascending powers of y: thousands of values are asked for."""
        return np.asarray(np.polynomial.polynomial.polyint(_ascending(self.stiffness)))

    def force(self, y: float, v: float, eps: float, step: float) -> tuple[float, float]:
        """Return g(y) + εh(y, v)v and its derivative by v; infinite or NaN where they overflow."""
        stiffness, damping = self._descending
        loss = slope = 0.0
        for coefficients in damping:
            slope = slope * v + loss
            loss = loss * v + _by_horner(coefficients, y)
        return _by_horner(stiffness, y) + eps * v * loss, eps * (loss + v * slope)

    @cached_property
    def _descending(self) -> tuple[list[float], list[list[float]]]:
        """Coefficients of g, and of h for each descending power of v, by descending powers of y."""
        powers: dict[int, dict[int, float]] = {}
        for (i, j), value in self.damping.items():
            powers.setdefault(j, {})[i] = value
        rows = (powers.get(j, {0: 0.0}) for j in range(max(powers, default=0), -1, -1))
        return _ascending(self.stiffness)[::-1].tolist(), [
            _ascending(row)[::-1].tolist() for row in rows
        ]

    def damping_at(self, y: FloatArray, v: FloatArray) -> FloatArray:
        """Return h(y, v)."""
        terms = (value * y**i * v**j for (i, j), value in self.damping.items())
        return sum(terms, np.zeros_like(y))

    def _damping_both_ways(self, y: FloatArray, v: FloatArray) -> FloatArray:
        """Return h(y, v) + h(y, -v) without terms that lose no energy, whose rounding is larger.

        These are odd powers of v and, in a symmetric potential, odd powers of y.
        """
        terms = (
            2.0 * value * y**i * v**j
            for (i, j), value in self.damping.items()
            if j % 2 == 0 and (i % 2 == 0 or not self._symmetric)
        )
        return sum(terms, np.zeros_like(y))

    @property
    def _symmetric(self) -> bool:
        return all(power % 2 for power in self.stiffness)

    def _other_end(self, amplitude: float, energy: float) -> float:
        """Return the negative y at which the motion turns."""
        if self._symmetric:
            return -amplitude
        return super()._other_end(amplitude, energy)

    def _loss_at_large(self) -> float:
        """Return a number with the sign of Δ at large amplitudes; 0 where Δ vanishes."""
        if self.harmonic:
            top = np.flatnonzero(np.abs(self.mean_damping) > 0.0)
            return float(self.mean_damping[top[-1]]) if top.size else 0.0
        found = self.loss(10.0 * self.largest)
        return 0.0 if abs(found) < _ZERO else found


def _ascending(coefficients: Mapping[int, float]) -> FloatArray:
    found = np.zeros(max(coefficients) + 1)
    for power, value in coefficients.items():
        found[power] = value
    return found


def _by_horner(descending: list[float], x: float) -> float:
    found = 0.0
    for coefficient in descending:
        found = found * x + coefficient
    return found


def _positive_crossings(ascending: FloatArray) -> list[tuple[float, bool]]:
    """Return the simple positive roots of a polynomial, and whether it increases there."""
    rate = np.polynomial.polynomial.polyder(ascending)
    return [
        (x, float(np.polynomial.polynomial.polyval(x, rate)) > 0.0)
        for x in _positive_roots(ascending)
    ]


def _positive_roots(ascending: FloatArray) -> list[float]:
    """Return the simple positive roots of a polynomial, ascending."""
    top = np.flatnonzero(ascending != 0.0)
    if not top.size:
        return []
    if top[-1] == 2:  # the closed form, without the rounding of an eigenvalue
        c, b, a = (float(each) for each in ascending[:3])
        below = b * b - 4.0 * a * c
        if below <= 0.0:
            return []
        q = -0.5 * (b + math.copysign(math.sqrt(below), b))
        roots = [each for each in (q / a, c / q if q else 0.0) if each > 0.0]
        return sorted(roots)
    # Between two stationary points there is at most one root.
    coefficients = ascending[top[0] : top[-1] + 1]
    slope = np.asarray(np.polynomial.polynomial.polyder(coefficients), dtype=float)
    largest = 1.0 + float(np.max(np.abs(coefficients / coefficients[-1])))  # Cauchy's bound
    edges = [0.0, *(each for each in _positive_roots(slope) if each < largest), largest]

    def value(x: float) -> float:
        return float(np.polynomial.polynomial.polyval(x, coefficients))

    return [
        float(brentq(value, low, high, xtol=1e-300, rtol=_CLOSE))
        for low, high in pairwise(edges)
        if value(low) * value(high) < 0.0
    ]
