"""The chain in plain numbers, for checks: forces written as springs and dampers, without SymPy.

The symbolic form of the equations is not used; only the coefficients are taken from the model.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from derivations.algebra.doubles import in_doubles
from derivations.algebra.evidence import fast_average
from derivations.chain import ChainModel
from derivations.symbols import c, epsilon


@dataclass(frozen=True)
class ChainNumbers:
    """One chain with numerical coefficients.

    Attributes
    ----------
    damping, stiffness : tuple of float
        Coefficients of h and g, beginning with power 0.
    springs : tuple of float
        Spring constants c w_j to the j-th neighbours.
    eps : number
        The small parameter.
    values : mapping of Symbol to float
        The same numbers by symbol, including eps.
    """

    damping: tuple[float, ...]
    stiffness: tuple[float, ...]
    springs: tuple[float, ...]
    eps: Any
    values: Mapping[sp.Symbol, Any]

    @property
    def reach(self) -> int:
        """Number of coupled neighbours on either side."""
        return len(self.springs)

    @property
    def pull_on_long_waves(self) -> float:
        """Modulus of the curvature of the springs' dispersion at long waves, Σ j² c w_j."""
        return abs(sum(j * j * spring for j, spring in enumerate(self.springs, start=1)))

    @property
    def unit(self) -> float:
        """The power of ten nearest to the amplitude at which first and last term of h are equal.

        Cycles have amplitudes of this order; it is 1 where the coefficients of h are of order one.
        """
        terms = [(power, abs(size)) for power, size in enumerate(self.damping) if size != 0.0]
        if len(terms) < 2:
            return 1.0
        (low, first), (high, last) = terms[0], terms[-1]
        return float(10.0 ** round(math.log10(first / last) / (high - low)))

    @property
    def strength(self) -> float:
        """The power of ten nearest to the largest term of h, g/y and springs at this amplitude."""
        sizes = [abs(size) * self.unit**power for power, size in enumerate(self.damping)]
        sizes += [abs(size) * self.unit ** (at - 1) for at, size in enumerate(self.stiffness)]
        sizes += map(abs, self.springs)
        return float(10.0 ** round(math.log10(max(sizes))))

    def force(self, y: Any, rate: Any) -> Any:
        """``y' h(y) + g(y)`` by Horner's rule."""
        return rate * _horner(self.damping, y) + _horner(self.stiffness, y)

    def tension(self, field: Mapping[int, Any], at: int = 0) -> Any:
        """Pull of the springs on a site: differences to the right minus those to the left."""
        total: Any = 0
        for j, spring in enumerate(self.springs, start=1):
            right, left = field[at + j] - field[at], field[at] - field[at - j]
            total = total + spring * (right - left)
        return total

    def rest(self, field: Mapping[int, Any], rate: Any) -> Any:
        """Return all terms of (8) other than y'' at site 0: ``y - eps tension + eps force``."""
        return field[0] + self.eps * (self.force(field[0], rate) - self.tension(field))

    def averaged_rate(self, field: Mapping[int, complex], frequency: float = 1.0) -> complex:
        """``dphi_n/dt`` of the averaged chain, ``y = Im(phi e^{i w t})/w``, by sampling (8).

        The time derivative of ``phi e^{i w t} = y' + i w y`` is averaged over a period.
        """

        def sampled(phase: Any) -> Any:
            turned = {offset: value * np.exp(1j * phase) for offset, value in field.items()}
            places = {offset: value.imag / frequency for offset, value in turned.items()}
            rate = turned[0].real
            moved = -self.rest(places, rate) + 1j * frequency * rate
            return (moved - 1j * frequency * turned[0]) * np.exp(-1j * phase)

        return fast_average(sampled, samples=128)

    def cell_rate(self, size: float, frequency: float = 1.0) -> complex:
        """``dphi/dt / phi`` of an isolated cell at ``phi = size``: damping and detuning.

        The springs, and hence the effect of neighbours at rest, are removed.
        """
        alone = ChainNumbers(self.damping, self.stiffness, (), self.eps, self.values)
        return alone.averaged_rate({0: complex(size)}, frequency) / size

    def cycles(self) -> Any:
        """Amplitudes at which a cell neither gains nor loses energy over a period, inner first.

        The growth rate is a polynomial in the square of the amplitude. Its zeros are obtained from
        as many sampled values as it has coefficients, and their last digits by a Newton step on
        sampled values. A double zero is listed twice, to half the digits.
        """
        degree, unit = (len(self.damping) - 1) // 2, self.unit
        squares = np.linspace(0.2, 4, degree + 1)
        rates = [self.cell_rate(unit * float(np.sqrt(q))).real for q in squares]
        fit = np.polynomial.Polynomial.fit(squares, rates, degree).convert().trim()
        zeros = fit.roots()
        real = np.sort(zeros[(abs(zeros.imag) < 1e-5) & (zeros.real > 1e-9)].real)
        apart = np.diff(real, prepend=-np.inf, append=np.inf)
        for place in np.flatnonzero(np.minimum(apart[:-1], apart[1:]) > 1e-4):
            missed = self.cell_rate(unit * float(np.sqrt(real[place]))).real
            real[place] -= missed / fit.deriv()(real[place])
        return unit * np.sqrt(real)


def _horner(coefficients: tuple[float, ...], y: Any) -> Any:
    total: Any = 0 * y
    for value in reversed(coefficients):
        total = total * y + value
    return total


def numbers_of(model: ChainModel, values: Mapping[sp.Symbol, Any], eps: Any) -> ChainNumbers:
    """Return the chain with given values for its symbols."""

    def number(expression: sp.Expr) -> float:
        exact = sp.sympify(expression)
        quick = in_doubles(exact, values)
        if quick is not None and quick.imag == 0.0:
            return quick.real
        return float(exact.subs(values) if exact.free_symbols else exact)

    def row(powers: Mapping[int, sp.Expr]) -> tuple[float, ...]:
        return tuple(number(powers.get(power, 0)) for power in range(max(powers, default=-1) + 1))

    springs = tuple(number(model.coupling * weight) for weight in model.weights)
    return ChainNumbers(row(model.damping), row(model.stiffness), springs, eps,
                        {**values, epsilon: eps})  # fmt: skip


def drawn(model: ChainModel, rng: random.Random) -> ChainNumbers:
    """Return the chain with random numbers for its symbols.

    They lie between 0.2 and 1.5, so that no power of an amplitude of order one dominates. The
    coupling is drawn in units of the forces of the cell, and eps in units of their inverse.
    """
    values = drawn_values(model, rng, 0.2, 1.5)
    strength = numbers_of(model, values, 1.0).strength
    return numbers_of(model, values, rng.uniform(0.1, 0.5) / strength)


def drawn_values(
    model: ChainModel, rng: random.Random, low: float, high: float
) -> dict[sp.Symbol, float]:
    """Return random numbers for the symbols of a chain, c in units of the forces of the cell."""
    values = {symbol: rng.uniform(low, high) for symbol in model.parameters}
    if model.is_scaled_by_c:
        values[c] *= numbers_of(model.cell(), values, 1.0).strength
    return values
