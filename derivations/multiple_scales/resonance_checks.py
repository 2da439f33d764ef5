"""Checks of Eqs. (21)-(30), the resonant part of (19), by direct Fourier averages.

No symbolic computation is used; only the coefficients of the chain are taken from its model.
"""

from __future__ import annotations

import cmath
import random
from typing import Any

import numpy as np
import sympy as sp

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, equals, fast_average
from derivations.algebra.steps import Evidence
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn
from derivations.multiple_scales import symbols as own
from derivations.multiple_scales.motions import wave_numbers
from derivations.symbols import R, alpha_0, delta, epsilon, k_1, k_2, omega, omega_1, tau, theta

_DIRECT = "the Fourier coefficient of the drive by direct averaging"


class ResonanceChecks:
    """The checks of the amplitude equations and of the breather, for one chain.

    Each can judge any equation in place of that of a step.

    Parameters
    ----------
    model : ChainModel
        The chain.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model

    def _resonance(
        self, p: ChainNumbers, size: complex, rate: complex, w1: float, wave: Point
    ) -> complex:
        """Return minus the e^{it} Fourier coefficient of the right-hand side of (19)."""

        def drive(s: Any) -> Any:
            place, first, mixed = (2 * (q * np.exp(1j * s)).real
                                   for q in (size, 1j * size, 1j * rate))  # fmt: skip
            step = cmath.exp(complex(wave[k_1], wave[k_2]))
            field = {0: place}
            for at in range(1, p.reach + 1):
                side = wave[alpha_0] * (np.exp(1j * s) * step**at).imag
                field |= {at: side, -at: side}
            return 2 * w1 * place - 2 * mixed - p.force(place, first) + p.tension(field)

        return -fast_average(drive, 1, samples=128)

    def _drawn_amplitude(
        self, rng: random.Random
    ) -> tuple[dict[Any, Any], ChainNumbers, dict[sp.Symbol, float]]:
        p = drawn(self.model, rng)
        wave = wave_numbers(rng, p.unit)
        size, angle, w1 = (rng.uniform(0.4, 1.3) for _ in range(3))
        point = {R: p.unit * size, theta: angle, omega_1: p.strength * w1}
        return {**p.values, **wave, **point}, p, wave

    @equals(_DIRECT)
    def secular(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a complex amplitude and its rate."""
        point, p, wave = self._drawn_amplitude(rng)
        size = point[R] * cmath.exp(1j * point[theta])
        rate = p.strength * p.unit * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point |= {own.A.diff(tau): rate, own.A: size}
        return point, [self._resonance(p, size, rate, point[omega_1], wave)]

    def _turned(self, rng: random.Random, steady: bool) -> tuple[dict[Any, Any], complex]:
        point, p, wave = self._drawn_amplitude(rng)
        turn = cmath.exp(1j * point[theta])
        grow, spin = (p.strength * unit * rng.uniform(0.4, 1) for unit in (p.unit, 1.0))
        rate = 0 if steady else (grow + 1j * point[R] * spin) * turn
        found = self._resonance(p, point[R] * turn, rate, point[omega_1], wave)
        point |= {own.R_slow.diff(tau): grow, own.theta_slow.diff(tau): spin,
                  own.R_slow: point[R], own.theta_slow: point[theta]}  # fmt: skip
        return point, found / turn

    @equals(_DIRECT)
    def secular_polar(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw modulus and argument, and their rates."""
        point, found = self._turned(rng, False)
        return point, [found]

    @equals(_DIRECT)
    def parts(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the part in quadrature, then the part in phase."""
        return self._parts(rng, steady=False)

    @equals(_DIRECT)
    def steady_parts(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the same parts of a motion with constant amplitude and phase."""
        return self._parts(rng, steady=True)

    def _parts(self, rng: random.Random, steady: bool) -> tuple[Point, list[complex]]:
        point, found = self._turned(rng, steady)
        return point, [found.imag, found.real]

    def _split(self, rng: random.Random) -> tuple[dict[Any, Any], complex, complex, float]:
        """Split the resonance at α_0 = 2R, divided by R e^{iθ}.

        Returns the cell's part, the neighbours' part, and the frequency at which the cell's part is
        imaginary.
        """
        point, p, wave = self._drawn_amplitude(rng)
        point[alpha_0] = wave[alpha_0] = 2 * point[R]
        size = point[R] * cmath.exp(1j * point[theta])
        alone = {**wave, alpha_0: 0.0}
        cell = self._resonance(p, size, 0, point[omega_1], alone) / size
        both = self._resonance(p, size, 0, point[omega_1], wave) / size
        still = self._resonance(p, size, 0, 0.0, alone) / size
        moved = self._resonance(p, size, 0, p.strength, alone) / size
        free = p.strength * still.real / (still.real - moved.real)
        point[delta] = point[omega_1] - free
        return point, cell, both - cell, free

    @equals(_DIRECT + ", over the amplitude")
    def own(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a steady motion of site 0 of the assumed form."""
        point, cell, neighbours, _ = self._split(rng)
        return point, [(cell + neighbours).imag, (cell + neighbours).real]

    @equals("moduli of " + _DIRECT)
    def modulus(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare the moduli of the contributions of the cell and of the neighbours."""
        point, cell, neighbours, _ = self._split(rng)
        return point, [abs(neighbours) ** 2 - abs(cell) ** 2]

    @equals("moduli of " + _DIRECT)
    def detuned(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare the moduli with the frequency expressed by δ alone."""
        point, cell, neighbours, _ = self._split(rng)
        del point[omega_1]
        return point, [abs(neighbours) ** 2 - abs(cell) ** 2]

    @equals("moduli of " + _DIRECT)
    def neglected(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Omit the part of the cell's contribution that detunes it."""
        point, cell, neighbours, _ = self._split(rng)
        return point, [abs(neighbours) ** 2 - cell.imag**2]

    @equals("moduli of " + _DIRECT)
    def cost(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Divide by the modulus of the neighbours' contribution."""
        point, cell, neighbours, _ = self._split(rng)
        return point, [1 - abs(cell / neighbours) ** 2]

    @equals("moduli of " + _DIRECT, parts=2)
    def _signed(self, rng: random.Random) -> tuple[Point, list[complex]]:
        point, pull, loss = self._pull_and_loss(rng)
        return point, [pull - loss, pull + loss]

    def branches(self, candidate: sp.Basic) -> Evidence:
        """Take the neighbours' pull minus and plus the loss of the cell, in either order."""
        found = self._signed(candidate)
        return found if found.holds else self._signed(sp.Tuple(*reversed(parts_of(candidate))))

    @equals("the loss of the cell by direct averaging")
    def loss(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a cell with its neighbours at rest."""
        point, cell, *_ = self._split(rng)
        return point, [cell.imag]

    @equals("moduli of " + _DIRECT)
    def decay(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the branch on which the cell feeds energy into its motion."""
        point, pull, loss = self._pull_and_loss(rng)
        return point, [pull + loss]

    def _pull_and_loss(self, rng: random.Random) -> tuple[Point, float, float]:
        point, cell, neighbours, _ = self._split(rng)
        spring = abs(float(self.model.coupling.subs(point)))
        return point, abs(neighbours) / (2 * spring), cell.imag / (2 * spring)

    @equals("the drive of the cell alone, averaged")
    def free_frequency(self, rng: random.Random) -> Point:
        """Draw a cell at its own frequency."""
        point, _, _, free = self._split(rng)
        return {**point, omega_1: free}

    @equals("the cell alone, averaged")
    def close_frequency(self, rng: random.Random) -> Point:
        """Draw a cell at a frequency higher than its own by δ."""
        return self._split(rng)[0]

    @equals("a real part that averages to zero")
    def detuning(self, rng: random.Random) -> Point:
        """Shift the frequency until the in-phase part vanishes."""
        point, cell, neighbours, _ = self._split(rng)
        # The real part decreases by 2 per unit of ω_1.
        shift = (cell + neighbours).real / 2
        return {**point, omega_1: point[omega_1] + shift, delta: point[delta] + shift}

    @equals("the cell alone, averaged")
    def breather_frequency(self, rng: random.Random) -> Point:
        """Draw the frequency of the whole motion rather than its correction."""
        point, _, _, free = self._split(rng)
        return {**point, omega: 1 + point[epsilon] * free}
