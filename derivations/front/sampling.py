"""Chains in plain numbers for the checks of the front, with their cycles."""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from derivations.algebra.equations import parts_of
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import Points, at_points
from derivations.algebra.steps import Check, Evidence
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, numbers_of
from derivations.front import symbols as s
from derivations.front.numbers import Lattice, evaluated, profile
from derivations.symbols import n, t

MAX_RATIO = 0.6
"""Of the cycles: nearer cells relax too slowly for a direct run."""
TINY = 1e-5
"""Amplitude of a linear response: the cubic terms are 1e-10 of the linear ones."""
CYCLE = 0.8 - 0.4j
"""The cycle behind a front."""
_SPEEDS = (0.5, 1.3, 0.7)


@dataclass(frozen=True, eq=False)
class Sample:
    """A chain with numbers and the two cycles of its cell, from the direct average.

    Attributes
    ----------
    chain : ChainNumbers
        The chain.
    inner, outer : float
        Amplitudes of the cycles.
    """

    chain: ChainNumbers
    inner: float
    outer: float

    @property
    def ratio(self) -> float:
        """Inner over outer amplitude."""
        return self.inner / self.outer

    @cached_property
    def lattice(self) -> Lattice:
        """Linear part of the two lines: the response to a tiny amplitude, a unit of eps t."""
        decay = -self.rate(TINY) / TINY / self.chain.eps
        return Lattice(float(decay), self.chain.springs)

    @property
    def eta(self) -> float:
        """Product of the outer coefficients of the damping over the square of the middle one."""
        low, middle, top = (q for q in self.chain.damping if q != 0)
        return low * top / middle**2

    def rate(self, size: float) -> float:
        """Rate of change of the amplitude of the cell."""
        return float((self.chain.cell_rate(size) * size).real)

    def linear(self, field: dict[int, complex]) -> complex:
        """Rate of the averaged chain at a tiny amplitude, scaled back."""
        tiny = {place: TINY * own for place, own in field.items()}
        return self.chain.averaged_rate(tiny) / TINY


@lru_cache(maxsize=16)
def samples(model: ChainModel) -> tuple[Sample, ...]:
    """Return three chains of the model whose cells have two cycles."""
    return tuple(_find(model, 3))


def _find(model: ChainModel, count: int) -> list[Sample]:
    """Draw coefficients over two decades until enough cells have two cycles, well apart."""
    rng = random.Random(11)
    found: list[Sample] = []
    for _ in range(2000):
        values = {q: math.exp(rng.uniform(-4.0, 1.4)) for q in model.parameters}
        for q in model.parameters:
            if model.coupling.has(q):
                values[q] = rng.uniform(0.3, 0.9)  # the checks at strong coupling multiply it
            elif q in sp.Tuple(*model.weights).free_symbols:
                values[q] = rng.uniform(0.3, 1.5)  # the history resolves these, times 900
        chain = numbers_of(model, values, rng.uniform(0.05, 0.3))
        cycles = chain.cycles()
        if len(cycles) == 2 and chain.damping[0] > 0 and cycles[0] / cycles[1] < MAX_RATIO:
            found.append(Sample(chain, *cycles))
        if len(found) == count:
            return found
    raise DerivationInputError(
        "damping", model.damping_of(sp.Symbol("y")), "that of a cell with two cycles around a "
        "stable rest state at some positive values of its letters",
        "give one, as 1 - a*y**2 + b*y**4: other cells have no front of (44)",
    )  # fmt: skip


def complex_number(rng: random.Random, size: float = 1.0) -> complex:
    """Return a random complex number in a square."""
    return size * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))


def sites(model: ChainModel, rng: random.Random, size: float = 1.0) -> dict[int, complex]:
    """Return random values of the envelope at the sites that springs join."""
    return {place: complex_number(rng, size) for place in range(-model.reach, model.reach + 1)}


def as_point(chain: ChainNumbers, field: dict[int, complex], rate: complex) -> dict[Any, Any]:
    """Return values for the envelope at the sites, its rate and the parameters."""
    point: dict[Any, Any] = {s.phi(n + place, t): own for place, own in field.items()}
    return {**point, s.phi(n, t).diff(t): rate, **chain.values}


PLACES = (-4.3, -2.0, -1.2, -0.5, -0.1, 0.1, 0.5, 1.2, 2.0, 4.3)
"""Where a front is compared with its threshold."""


@lru_cache(maxsize=16)
def front(model: ChainModel) -> tuple[Sample, float]:
    """Return a chain and the velocity of a front that passes the threshold once at each site."""
    for sample in _find(model, 40):
        lattice = sample.lattice
        speeds = np.linspace(0.35, 3.0, 9)
        sizes = [abs(profile(lattice, 0.0, float(v))) - sample.ratio for v in speeds]
        for low, high, before, after in zip(speeds, speeds[1:], sizes, sizes[1:], strict=False):
            if before * after < 0:
                v = float(brentq(lambda q, at=lattice, r=sample.ratio: abs(profile(at, 0.0, q)) - r,
                                 low, high, xtol=1e-12))  # fmt: skip
                if all((abs(profile(lattice, z, v)) > sample.ratio) == (z < 0) for z in PLACES):
                    return sample, v
    raise ArithmeticError("no admissible front of this model was found")


@lru_cache(maxsize=64)
def standing(sample: Sample, coupling: float = 1.0, half: int = 60) -> complex:
    """phi/phi_s at the first site ahead of a standing front, by solving the linear chain.

    Parameters
    ----------
    sample : Sample
        The chain.
    coupling : float
        Factor on its springs.
    half : int
        Sites on each side.
    """
    lattice = sample.lattice
    size = 2 * half
    matrix = lattice.decay * np.eye(size, dtype=complex)
    for distance, spring in enumerate(lattice.springs, start=1):
        for site in range(size):
            for other in (site - distance, site + distance):
                if 0 <= other < size:
                    matrix[site, site] -= 0.5j * coupling * spring
                    matrix[site, other] += 0.5j * coupling * spring
    pull = np.zeros(size, dtype=complex)
    pull[:half] = lattice.decay
    return complex(np.linalg.solve(matrix, pull)[half])


class SampledChecks:
    """What the checks of the front have in common: three chains in numbers, and fronts of them.

    Parameters
    ----------
    model : ChainModel
        The chain, of which only coefficients are read.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model

    @property
    def samples(self) -> tuple[Sample, ...]:
        """Three chains whose cells have two cycles."""
        return samples(self.model)

    def waves(self) -> Iterator[tuple[Sample, float, complex]]:
        """Each chain with a velocity and a wavenumber above the real axis."""
        rng = random.Random(6)
        for sample, fast in zip(self.samples, _SPEEDS, strict=True):
            yield sample, fast, complex(rng.uniform(-3, 3), rng.uniform(0.1, 0.6))

    def on_cycles(self, what: str, parts: int) -> Check:
        """Every part holds with the cycles of the direct average, at any phase, put in."""

        def points() -> Points:
            for sample in self.samples:
                inner, outer = sample.inner * 1j, sample.outer * cmath.exp(0.3j)
                yield {s.phi_us: inner, s.phi_s: outer, s.ratio: sample.ratio,
                       s.eta: sample.eta, **sample.chain.values}, None  # fmt: skip

        return at_points(what, parts=parts)(points)

    def at_front(self, candidate: sp.Basic) -> Evidence:
        """Left minus right of each part on fronts at three velocities, series summed."""
        worst = 0.0
        for sample, fast, _ in self.waves():
            lattice = sample.lattice
            here = CYCLE * profile(lattice, 0.0, fast)
            worst = max(worst, *_differences(candidate, sample, lattice, fast, here))
        other = Lattice(1.1 * lattice.decay, lattice.springs)
        if min(_differences(candidate, sample, other, fast, 1.1 * here)) < 1e-7:
            return Evidence(False, "it holds for another front as well: it says nothing")
        return Evidence(worst < 1e-7, f"φ(0) of the front from its history: off by {worst:.1e}")


def _differences(
    candidate: sp.Basic, sample: Sample, lattice: Lattice, v: float, here: complex
) -> list[float]:
    """Left minus right of each part, with sums over the roots of a lattice, and phi(0)."""
    point = {**sample.chain.values, s.v: v, s.phi_s: CYCLE, s.phi(0): here, s.phi_us: here,
             s.ratio: abs(here / CYCLE)}  # fmt: skip
    sides = (part.args for part in parts_of(candidate))
    return [abs(evaluated(left - right, point, lattice, v)) for left, right in sides]
