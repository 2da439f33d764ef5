"""Chains in plain numbers for the checks of the front, with their cycles."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, numbers_of
from derivations.front import symbols as s
from derivations.front.numbers import Lattice, profile
from derivations.symbols import n, t

MAX_RATIO = 0.6
"""Of the cycles: nearer cells relax too slowly for a direct run."""
TINY = 1e-5
"""Amplitude of a linear response: the cubic terms are 1e-10 of the linear ones."""


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
        for q in sp.sympify(model.coupling).free_symbols:
            values[q] = rng.uniform(0.3, 0.9)  # neither pinned nor beyond the resolution
        chain = numbers_of(model, values, rng.uniform(0.05, 0.3))
        cycles = _cycles(chain)
        if len(cycles) == 2 and cycles[0] / cycles[1] < MAX_RATIO:
            found.append(Sample(chain, *cycles))
        if len(found) == count:
            return found
    raise ArithmeticError("no chain of this model was found whose cell has two cycles")


def _cycles(chain: ChainNumbers) -> list[float]:
    """Return the stationary amplitudes, by sign changes of the sampled rate."""
    mean = _mean_damping(chain)
    sizes = np.geomspace(0.05, 60.0, 340)
    rates = mean(sizes)
    places = np.flatnonzero(np.sign(rates[:-1]) != np.sign(rates[1:]))
    if rates[0] <= 0:
        return []

    def one(size: float) -> float:
        return float(mean(np.array([size]))[0])

    return [float(brentq(one, sizes[q], sizes[q + 1], xtol=1e-14, rtol=1e-14)) for q in places]


def _mean_damping(chain: ChainNumbers) -> Callable[[Any], Any]:
    """Mean of y' times the damping force over a period, over the square of the amplitude."""
    phase = 2 * np.pi * np.arange(64) / 64

    def mean(sizes: Any) -> Any:
        place = sizes[:, None] * np.sin(phase)
        rate = sizes[:, None] * np.cos(phase)
        return (chain.force(place, rate) * rate).mean(axis=1) / sizes**2

    return mean


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
