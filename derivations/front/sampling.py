"""Chains in plain numbers for the checks of the front, with their cycles."""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import islice, pairwise
from typing import Any

import numpy as np
import sympy as sp
from scipy.linalg import solve_banded
from scipy.optimize import brentq

from derivations.algebra.equations import parts_of
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import Points, at_points
from derivations.algebra.steps import Check, Evidence
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, numbers_of
from derivations.front import symbols as s
from derivations.front.numbers import Lattice, evaluated, profile
from derivations.symbols import c, n, t

MAX_RATIO = 0.6
"""Largest ratio of the cycles; above it the cell relaxes too slowly for a direct run."""
TINY = 1e-5
"""Amplitude of a linear response divided by that of the inner cycle: nonlinear terms are then 1e-10
of the linear ones."""
MAX_IMBALANCE = 27.0
"""Largest ratio, in either direction, of the strength of the springs to the damping at rest."""
CYCLE = 0.8 - 0.4j
"""Value of the envelope on the cycle behind a front."""
_SPEEDS = (0.5, 1.3, 0.7)
"""Velocities of fronts, divided by the damping at rest."""


@dataclass(frozen=True, eq=False)
class Sample:
    """A chain in numbers, with the two cycles of its cell from the direct average.

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
        """Ratio of the inner to the outer amplitude."""
        return self.inner / self.outer

    @property
    def tiny(self) -> float:
        """Amplitude of a linear response."""
        return TINY * self.inner

    @cached_property
    def lattice(self) -> Lattice:
        """Linear part of (44): the response to a tiny amplitude, per unit of eps t."""
        decay = -self.rate(self.tiny) / self.tiny / self.chain.eps
        return Lattice(float(decay), self.chain.springs)

    def coupled(self, factor: float) -> Lattice:
        """Linear part with the springs stronger by a factor."""
        return Lattice(self.lattice.decay, tuple(factor * q for q in self.chain.springs))

    @property
    def damping_at_rest(self) -> float:
        """Damping at rest, the unit of velocities and couplings of fronts."""
        return self.chain.damping[0]

    @cached_property
    def return_rate(self) -> float:
        """Rate at which the cell returns to its cycle, per unit of eps t."""
        increment = 1e-3 * self.outer
        change = self.rate(self.outer + increment) - self.rate(self.outer - increment)
        return float(abs(change) / (2 * increment * self.chain.eps))

    @property
    def eta(self) -> float:
        """Product of the outer damping coefficients over the square of the middle one."""
        low, middle, top = (q for q in self.chain.damping if q != 0)
        return low * top / middle**2

    def rate(self, amplitude: float) -> float:
        """Rate of change of the amplitude of the cell."""
        return float((self.chain.cell_rate(amplitude) * amplitude).real)

    def linear(self, field: dict[int, complex]) -> complex:
        """Rate of the averaged chain at a tiny amplitude, scaled back."""
        small = {place: self.tiny * value for place, value in field.items()}
        return self.chain.averaged_rate(small) / self.tiny


@lru_cache(maxsize=16)
def samples(model: ChainModel) -> tuple[Sample, ...]:
    """Return three chains of the model whose cells have two cycles.

    Raises
    ------
    DerivationInputError
        If no such cells are found.
    """
    found = tuple(islice(cells(model), 3))
    if len(found) == 3:
        return found
    if next(cells(model, math.inf), None):
        raise DerivationInputError(
            "coupling", model.coupling, "such that the springs pull on long waves between "
            f"1/{MAX_IMBALANCE:g} and {MAX_IMBALANCE:g} times as strongly as the cell is damped",
            "take other numbers: the fronts of such a chain are not resolved by the checks",
        )  # fmt: skip
    raise DerivationInputError(
        "damping", model.damping_of(sp.Symbol("y")), "that of a cell with two cycles around a "
        "stable rest state at some positive values of its letters",
        "give one, as 1 - a*y**2 + b*y**4: other cells have no front of (44)",
    )  # fmt: skip


def cells(model: ChainModel, max_imbalance: float = MAX_IMBALANCE) -> Iterator[Sample]:
    """Draw coefficients over two decades, then more; yield cells with two well-separated cycles.

    Springs and damping at rest differ at most by the cube root of ``max_imbalance`` at first, and
    later by up to ``max_imbalance``.
    """
    rng = random.Random(11)
    for draw in range(2000):
        widening = 1.0 + draw // 500
        chain = _drawn(model, rng, widening)
        imbalance = max_imbalance ** (min(widening, 3.0) / 3.0)
        if not _may_have_two_cycles(chain) or not _is_balanced(chain, imbalance):
            continue
        cycles = chain.cycles()
        if len(cycles) == 2 and cycles[0] / cycles[1] < MAX_RATIO:
            yield Sample(chain, *cycles)


def _drawn(model: ChainModel, rng: random.Random, widening: float) -> ChainNumbers:
    """Return a chain whose springs pull on long waves as strongly as its cell is damped.

    Much weaker springs pin most fronts; much stronger ones make them too wide to be resolved.
    """
    values = {q: math.exp(widening * rng.uniform(-4.0, 1.4)) for q in model.parameters}
    letters = model.coupling.free_symbols
    for q in model.parameters:
        if q in letters:
            values[q] = rng.uniform(0.3, 0.9)
        elif q in sp.Tuple(*model.weights).free_symbols:
            values[q] = rng.uniform(0.3, 1.5)
    chain = numbers_of(model, values, rng.uniform(0.05, 0.3))
    pull = chain.pull_on_long_waves
    if model.is_scaled_by_c and chain.damping[0] > 0 and pull > 0:
        values[c] *= values[c] * chain.damping[0] / pull
        chain = numbers_of(model, values, chain.eps)
    return chain


def _is_balanced(chain: ChainNumbers, imbalance: float) -> bool:
    """Whether springs and damping at rest differ by less than a factor; a coupling may lack c."""
    pull = abs(chain.pull_on_long_waves)
    return pull == 0 or 1 / imbalance < pull / chain.damping[0] < imbalance


def _may_have_two_cycles(chain: ChainNumbers) -> bool:
    """Descartes' rule: at most as many cycles as sign changes in the even powers of the damping."""
    even = [q for q in chain.damping[::2] if q]
    changes = sum(low * high < 0 for low, high in pairwise(even))
    return chain.damping[0] > 0 and changes >= 2


def complex_number(rng: random.Random, size: float = 1.0) -> complex:
    """Return a random complex number in a square."""
    return size * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))


def sites(model: ChainModel, rng: random.Random, size: float = 1.0) -> dict[int, complex]:
    """Return random values of the envelope at the sites coupled by springs."""
    return {place: complex_number(rng, size) for place in range(-model.reach, model.reach + 1)}


def as_point(chain: ChainNumbers, field: dict[int, complex], rate: complex) -> dict[Any, Any]:
    """Return values for the envelope at the sites, its rate, and the parameters."""
    point: dict[Any, Any] = {s.phi(n + place, t): value for place, value in field.items()}
    return {**point, s.phi(n, t).diff(t): rate, **chain.values}


PLACES = (-4.3, -2.0, -1.2, -0.5, -0.1, 0.1, 0.5, 1.2, 2.0, 4.3)
"""Coordinates at which a front is compared with its threshold."""


@lru_cache(maxsize=16)
def front(model: ChainModel) -> tuple[Sample, float]:
    """Return a chain and the velocity of a front that passes the threshold once at each site.

    Raises
    ------
    DerivationInputError
        If no such front is found.
    """
    for sample in cells(model):
        lattice = sample.lattice
        speeds = sample.damping_at_rest * np.linspace(0.35, 3.0, 9)
        differences = [abs(profile(lattice, 0.0, float(v))) - sample.ratio for v in speeds]
        for low, high, before, after in zip(
            speeds, speeds[1:], differences, differences[1:], strict=False
        ):
            if before * after < 0:
                v = float(brentq(lambda q, at=lattice, r=sample.ratio: abs(profile(at, 0.0, q)) - r,
                                 low, high, xtol=1e-12 * sample.damping_at_rest))  # fmt: skip
                if all((abs(profile(lattice, z, v)) > sample.ratio) == (z < 0) for z in PLACES):
                    return sample, v
    raise DerivationInputError(
        "coupling", model.coupling, "such that a front of the chain runs and passes the threshold "
        "once at each site, at 0.35 to 3 times the damping at rest",
        "take other numbers: no such front was found",
    )  # fmt: skip


@lru_cache(maxsize=64)
def standing(lattice: Lattice) -> complex:
    """Return phi/phi_s at the first site ahead of a standing front, by solving the linear chain.

    The number of sites is doubled until the result no longer changes.

    Raises
    ------
    ArithmeticError
        If the result still depends on the ends of a chain of 8000 sites.
    """
    before = _ahead(lattice, 125)
    for half in (250, 500, 1000, 2000, 4000):
        found = _ahead(lattice, half)
        if abs(found - before) < 1e-12:
            return found
        before = found
    raise ArithmeticError("a standing front reaches beyond 4000 sites")


def _ahead(lattice: Lattice, half: int) -> complex:
    size, reach = 2 * half, len(lattice.springs)
    bands = np.zeros((2 * reach + 1, size), dtype=complex)
    bands[reach] = lattice.decay
    for distance, spring in enumerate(lattice.springs, start=1):
        pull = 0.5j * spring
        bands[reach - distance, distance:] = bands[reach + distance, :-distance] = pull
        bands[reach, distance:] -= pull  # beyond an end there is no neighbour
        bands[reach, :-distance] -= pull
    drive = np.where(np.arange(size) < half, lattice.decay, 0.0).astype(complex)
    return complex(solve_banded((reach, reach), bands, drive)[half])


class SampledChecks:
    """Common part of the checks of the front: three chains in numbers, and their fronts.

    Parameters
    ----------
    model : ChainModel
        The chain, of which only the coefficients are used.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model

    @property
    def samples(self) -> tuple[Sample, ...]:
        """Three chains whose cells have two cycles."""
        return samples(self.model)

    def waves(self) -> Iterator[tuple[Sample, float, complex]]:
        """Yield each chain with a velocity and a wavenumber above the real axis."""
        rng = random.Random(6)
        for sample, velocity in zip(self.samples, _SPEEDS, strict=True):
            wavenumber = complex(rng.uniform(-3, 3), rng.uniform(0.1, 0.6))
            yield sample, velocity * sample.damping_at_rest, wavenumber

    def on_cycles(self, what: str, parts: int) -> Check:
        """Return a check of every part with the cycles of the direct average, at any phase."""

        def points() -> Points:
            for sample in self.samples:
                inner, outer = sample.inner * 1j, sample.outer * cmath.exp(0.3j)
                yield {s.phi_us: inner, s.phi_s: outer, s.ratio: sample.ratio,
                       s.eta: sample.eta, **sample.chain.values}, None  # fmt: skip

        return at_points(what, parts=parts)(points)

    def at_front(self, candidate: sp.Basic) -> Evidence:
        """Evaluate left minus right of each part on fronts at three velocities."""
        worst = 0.0
        for sample, velocity, _ in self.waves():
            lattice = sample.lattice
            phi_0 = CYCLE * profile(lattice, 0.0, velocity)
            worst = max(worst, *_differences(candidate, sample, lattice, velocity, phi_0))
        other = Lattice(1.1 * lattice.decay, lattice.springs)
        if min(_differences(candidate, sample, other, velocity, 1.1 * phi_0)) < 1e-7:
            return Evidence(False, "it holds for another front as well, so it has no content")
        return Evidence(worst < 1e-7, f"φ(0) of the front from its history: off by {worst:.1e}")


def _differences(
    candidate: sp.Basic, sample: Sample, lattice: Lattice, v: float, phi_0: complex
) -> list[float]:
    """Return left minus right of each part, with sums over the roots of a lattice, and phi(0)."""
    point = {**sample.chain.values, s.v: v, s.phi_s: CYCLE, s.phi(0): phi_0, s.phi_us: phi_0,
             s.ratio: abs(phi_0 / CYCLE)}  # fmt: skip
    sides = (part.args for part in parts_of(candidate))
    return [abs(evaluated(left - right, point, lattice, v)) for left, right in sides]
