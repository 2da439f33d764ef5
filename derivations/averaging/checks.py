"""Checks of Eqs. (31)-(38) and (43) by averaging Eq. (8) itself over equal samples in time.

No symbolic computation is used; only the coefficients of the chain are taken from its model.
"""

from __future__ import annotations

import cmath
import math
import random
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, equals, fast_average, solved_for
from derivations.algebra.steps import Check, Evidence
from derivations.averaging.symbols import A_n, divided, phi, psi, r, square, squares
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn
from derivations.symbols import R, alpha_0, k_1, k_2, n, omega, omega_1, t, y

_DIRECT = "Eq. (8) averaged by direct sampling"


def wave_residual(field: dict[int, Any], rate: Any, p: ChainNumbers, w: float) -> Any:
    """Evaluate Eq. (8) for Ψ = y' + i ω y at the sites of ``field``.

    ``rate`` is dΨ/dt at the middle site. Its imaginary part is ω y' for a true motion; any other
    value is used as it stands.
    """
    places = {at: value.imag / w for at, value in field.items()}
    velocity = field[0].real
    return rate.real + p.rest(places, velocity) + 1j * (rate.imag - w * velocity)


def rotating_residual(field: dict[int, complex], rate: complex, p: ChainNumbers, w: float) -> Any:
    """Evaluate (33) as a function of time at frozen φ and φ'."""

    def at(when: Any) -> Any:
        turn = np.exp(1j * w * when)
        turned = {place: value * turn for place, value in field.items()}
        moving = rate * turn + 1j * w * turned[0]
        return wave_residual(turned, moving, p, w) / turn

    return at


def direct_average(field: dict[int, complex], rate: complex, p: ChainNumbers, w: float) -> complex:
    """Return the mean of (33) over a period 2π/ω by direct sampling."""
    at = rotating_residual(field, rate, p, w)
    return fast_average(lambda phase: at(phase / w), samples=128)


class AveragingChecks:
    """The checks of the derivation for one chain; each can judge any equation in place of a step's.

    Parameters
    ----------
    model : ChainModel
        The chain.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model
        self.sites = tuple(range(-model.reach, model.reach + 1))

    def _field(self, rng: random.Random, unit: float = 1.0) -> dict[int, complex]:
        return {at: unit * complex(rng.uniform(-1.2, 1.2), rng.uniform(-1.2, 1.2))
                for at in self.sites}  # fmt: skip

    # From (8) to the average.

    @equals("Ψ = y' + iωy", parts=3)
    def complex_variable(self, rng: random.Random) -> Point:
        """Draw position, velocity and acceleration of a site."""
        w = rng.uniform(0.8, 1.3)
        place, rate, second = (rng.uniform(-1, 1) for _ in range(3))
        return {omega: w, y(n, t).diff(t, 2): second, y(n, t).diff(t): rate, y(n, t): place,
                psi(n, t).diff(t): complex(second, w * rate),
                psi(n, t): complex(rate, w * place)}  # fmt: skip

    @equals("Eq. (8) at coupled sites")
    def complex_chain(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw Ψ at all coupled sites, and its rate."""
        p = drawn(self.model, rng)
        field, w = self._field(rng, p.unit), rng.uniform(0.8, 1.3)
        rate = p.unit * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point = {**p.values, omega: w, psi(n, t).diff(t): rate}
        point |= {psi(n + at, t): value for at, value in field.items()}
        return point, [wave_residual(field, rate, p, w)]

    @equals("a turning frame")
    def envelope(self, rng: random.Random) -> Point:
        """Rotate φ by ωt."""
        w, when, size = rng.uniform(0.8, 1.3), rng.uniform(0, 6), self._field(rng)[0]
        turned = size * complex(math.cos(w * when), math.sin(w * when))
        return {omega: w, t: when, phi(n, t): size, psi(n, t): turned}

    def _frozen(
        self, rng: random.Random
    ) -> tuple[dict[Any, Any], dict[int, complex], complex, ChainNumbers]:
        p = drawn(self.model, rng)
        field = self._field(rng, p.unit)
        rate = p.unit * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point = {**p.values, phi(n, t).diff(t): rate}
        point |= {phi(n + at, t): value for at, value in field.items()}
        return point, field, rate, p

    @equals("Eq. (8) in the rotating frame")
    def rotating(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw φ, its rate and an instant of the period."""
        point, field, rate, p = self._frozen(rng)
        when, w = rng.uniform(0, 6), rng.uniform(0.8, 1.3)
        return {**point, t: when, omega: w}, [complex(rotating_residual(field, rate, p, w)(when))]

    @equals(_DIRECT)
    def averaged(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Freeze φ and its rate over a period of any frequency."""
        return self._averaged(rng, unit=False)

    @equals(_DIRECT)
    def averaged_at_unit(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Freeze φ and its rate over a period of 2π."""
        return self._averaged(rng, unit=True)

    def _averaged(self, rng: random.Random, unit: bool) -> tuple[Point, list[complex]]:
        point, field, rate, p = self._frozen(rng)
        w = 1.0 if unit else rng.uniform(0.8, 1.3)
        return {**point, omega: w}, [direct_average(field, rate, p, w)]

    # The decaying wave.

    def _wave_numbers(self, rng: random.Random) -> tuple[dict[Any, Any], complex, int]:
        growth, turn, place = rng.uniform(-1.2, -0.3), rng.uniform(-3, 3), rng.randrange(1, 4)
        return ({k_1: growth, k_2: turn, alpha_0: rng.uniform(0.8, 2), n: place},
                cmath.exp(complex(growth, turn)), place)  # fmt: skip

    def _wave_of_chain(self, rng: random.Random) -> tuple[dict[Any, Any], ChainNumbers]:
        """Draw a wave, then a chain in whose unit its amplitude is measured."""
        (wave, _, _), p = self._wave_numbers(rng), drawn(self.model, rng)
        return {**wave, alpha_0: p.unit * wave[alpha_0]}, p

    @equals("one complex factor a site")
    def wave(self, rng: random.Random) -> Point:
        """Multiply by the same complex number from site to site."""
        wave, step, place = self._wave_numbers(rng)
        return {**wave, phi(n, t): wave[alpha_0] * step**place}

    def _wave_average(
        self, wave: dict[Any, Any], p: ChainNumbers, w: float, *, turning: float = 0.0,
        scale: float = 1.0,
    ) -> complex:  # fmt: skip
        """Return the direct average over φ_n, for ``scale`` times the wave's amplitude."""
        step = cmath.exp(complex(wave[k_1], wave[k_2]))
        field = {at: scale * wave[alpha_0] * step ** (wave[n] + at) for at in self.sites}
        return complex(direct_average(field, 1j * turning * field[0], p, w) / field[0])

    @equals(_DIRECT)
    def balance(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a decaying wave, at one site."""
        wave, p = self._wave_of_chain(rng)
        w = rng.uniform(0.8, 1.3)
        return {**p.values, **wave, omega: w}, [self._wave_average(wave, p, w)]

    @equals(_DIRECT, parts=2)
    def parts(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take real and imaginary part of the mean."""
        return self._parts(rng, displacement=False)

    @equals(_DIRECT, parts=2)
    def parts_by_displacement(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the same parts for a wave whose y has the amplitude α₀."""
        return self._parts(rng, displacement=True)

    def _parts(self, rng: random.Random, displacement: bool) -> tuple[Point, list[complex]]:
        wave, p = self._wave_of_chain(rng)
        w = rng.uniform(0.8, 1.3)
        found = self._wave_average(wave, p, w, scale=w if displacement else 1.0)
        return {**p.values, **wave, omega: w}, [found.real, found.imag]

    @equals(_DIRECT)
    def real_part(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw the same wave, with its amplitude at the site given by its square."""
        point, references = self._parts(rng, displacement=False)
        size = point[alpha_0] ** 2 * math.exp(2 * point[k_1] * point[n])
        return {**point, square: size}, references[:1]

    def _detuning(self, size: float, p: ChainNumbers) -> float:
        """Return ω_1 of a cell of amplitude ``size`` with neighbours at rest, by sampling."""
        return float(p.cell_rate(size).imag / p.eps + sum(p.springs))

    @equals("the cell alone, averaged")
    def frequency(self, rng: random.Random) -> Point:
        """Draw a cell with its neighbours at rest."""
        p = drawn(self.model, rng)
        size = p.unit * rng.uniform(0.5, 2)
        w = 1 + p.eps * self._detuning(size, p)
        return {**p.values, alpha_0: size, R: size / 2, omega: w, omega_1: (w - 1) / p.eps}

    def _factors(self, wave: dict[Any, Any], p: ChainNumbers, w: float) -> tuple[float, float]:
        """Return the factors of sin k_2 and cos k_2 in the two parts of the average."""
        up, down = math.exp(wave[k_1]), math.exp(-wave[k_1])
        half = p.eps * p.springs[0] / (2 * w)
        return half * (down - up), half * (up + down)

    @equals(_DIRECT, parts=2)
    def isolated(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Divide the parts of the mean by the factors of sin k₂ and cos k₂."""
        wave, p = self._wave_of_chain(rng)
        w = rng.uniform(0.8, 1.3)
        found = self._wave_average(wave, p, w)
        of_sine, of_cosine = self._factors(wave, p, w)
        return {**p.values, **wave, omega: w}, [found.real / of_sine, found.imag / of_cosine]

    @equals(_DIRECT, parts=2)
    def phases(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Divide the parts as in `isolated`, at the frequency of a cell of this amplitude."""
        return self._phases(rng, displacement=False)

    @equals(_DIRECT + ", with α_0 the amplitude of y", parts=2)
    def phases_by_displacement(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Divide the same parts for a wave whose y has the amplitude α₀."""
        return self._phases(rng, displacement=True)

    def _phases(self, rng: random.Random, displacement: bool) -> tuple[Point, list[complex]]:
        wave, p = self._wave_of_chain(rng)
        w = 1 + p.eps * self._detuning(wave[alpha_0], p)
        found = self._wave_average(wave, p, w, scale=w if displacement else 1.0)
        of_sine, of_cosine = self._factors(wave, p, w)
        return {**p.values, **wave}, [found.real / of_sine, found.imag / of_cosine]

    def _limit_numbers(
        self, rng: random.Random
    ) -> tuple[dict[Any, Any], dict[Any, Any], ChainNumbers]:
        wave, p = self._wave_of_chain(rng)
        return {**p.values, **wave}, wave, p

    def _in_limit(self, wave: dict[Any, Any], p: ChainNumbers) -> tuple[float, float]:
        """Return the parts of the average at ω = 1, divided by the factors of sine and cosine.

        In a motion at frequency 1 + ε ω_1, the φ of frequency 1 rotates at ε ω_1.
        """
        turning = p.eps * self._detuning(wave[alpha_0], p)
        found = self._wave_average(wave, p, 1.0, turning=turning)
        of_sine, of_cosine = self._factors(wave, p, 1.0)
        return found.real / of_sine, found.imag / of_cosine

    @equals(_DIRECT + " at ω = 1", parts=2)
    def limit(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a wave at ε = 0, with its frequency to first order."""
        point, wave, p = self._limit_numbers(rng)
        return point, list(self._in_limit(wave, p))

    @equals(_DIRECT + " at ω = 1")
    def swapped(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the first of the parts, with its sides exchanged."""
        point, wave, p = self._limit_numbers(rng)
        return point, [-self._in_limit(wave, p)[0]]

    def _zeros(self, wave: dict[Any, Any], p: ChainNumbers) -> list[float]:
        """Return the zeros in k_2, from -π to π, of the imaginary part in the limit."""

        def imaginary(turn: float) -> float:
            return self._in_limit({**wave, k_2: turn}, p)[1]

        grid = np.linspace(-math.pi, math.pi, 26)
        heights = [imaginary(q) for q in grid]
        return [float(brentq(imaginary, low, high, xtol=1e-14, rtol=1e-14))
                for low, high, one, other in zip(grid, grid[1:], heights, heights[1:], strict=False)
                if one * other < 0]  # fmt: skip

    def _with_zeros(
        self, rng: random.Random
    ) -> tuple[dict[Any, Any], dict[Any, Any], ChainNumbers, list[float]]:
        for tried in range(60):
            point, wave, p = self._limit_numbers(rng)
            # The smaller the wave, the less the cell detunes it, so that there are zeros near ±π/2.
            size = {alpha_0: 0.9**tried * wave[alpha_0]}
            zeros = self._zeros(wave | size, p)
            if zeros:
                return point | size, wave | size, p, zeros
        raise ArithmeticError("no parameters were found at which the phase step is real")

    def branches(self, candidate: sp.Basic) -> Evidence:
        """Find all zeros of the imaginary part by sampling, and each of them among the branches."""
        rng, worst = random.Random(20), 0.0
        for _ in range(3):
            point, _, _, zeros = self._with_zeros(rng)
            del point[k_2]
            found = [solved_for(part, k_2, point) for part in parts_of(candidate)]
            real = sorted(q.real for q in found if abs(q.imag) < 1e-9)
            if len(real) != len(zeros):
                return Evidence(False, f"{len(real)} branches, but sampling finds {len(zeros)}")
            worst = max(worst, *(abs(p - q) for p, q in zip(real, zeros, strict=True)))
        return Evidence(worst < 1e-9, f"all zeros of the imaginary part: off by {worst:.1e}")

    def _at_branch(self, rng: random.Random) -> tuple[dict[Any, Any], dict[Any, Any], ChainNumbers]:
        """Return numbers with k_2 the zero between -π and 0 that is nearest to -π/2."""
        point, wave, p, zeros = self._with_zeros(rng)
        turn = min((q for q in zeros if q < 0), key=lambda q: abs(q + math.pi / 2))
        return {**point, k_2: turn}, {**wave, k_2: turn}, p

    @equals("a zero of the sampled imaginary part")
    def branch(self, rng: random.Random) -> Point:
        """Take the zero nearest to -π/2."""
        return self._at_branch(rng)[0]

    @equals(_DIRECT + " at a zero of its imaginary part")
    def quarter(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the real part where the imaginary part is zero."""
        point, wave, p = self._at_branch(rng)
        return point, [-self._in_limit(wave, p)[0]]

    @equals(_DIRECT + " at a zero of its imaginary part", parts=2)
    def second_relation(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Take the real part where the imaginary part is zero, and that zero."""
        point, wave, p = self._at_branch(rng)
        return point, [-self._in_limit(wave, p)[0], 0]

    @equals("the amplitude of the sine of (9)")
    def amplitude(self, rng: random.Random) -> Point:
        """Measure the amplitude at two instants a quarter period apart."""
        wave, _, _ = self._wave_numbers(rng)
        place, phase = rng.choice([-2, 1, 3]), rng.uniform(0, 3)
        # Two instants a quarter period apart give the amplitude of a sine.
        size = wave[alpha_0] * math.exp(wave[k_1]) ** abs(place)
        quarter = [size * math.sin(phase + shift) for shift in (0, math.pi / 2)]
        return {**wave, n: place, A_n: math.hypot(*quarter)}

    @equals("the square of an amplitude")
    def square(self, rng: random.Random) -> Point:
        """Square the modulus of the wave at a site."""
        wave, step, place = self._wave_numbers(rng)
        return {**wave, square: abs(wave[alpha_0] * step**place) ** 2}

    def divided(self, count: int) -> Check:
        """Return the check of a divided difference of the sampled damping over ``count`` sites."""

        def draw(rng: random.Random) -> Point:
            p, w = drawn(self.model, rng), rng.uniform(0.8, 1.3)
            sizes = [p.unit**2 * (0.3 + 0.5 * at + rng.uniform(0, 0.2)) for at in range(count)]
            table = [-p.cell_rate(math.sqrt(size), w).real for size in sizes]
            for width in range(1, count):
                table = [(table[at + 1] - table[at]) / (sizes[at + width] - sizes[at])
                         for at in range(len(table) - 1)]  # fmt: skip
            values = dict(zip(squares, sizes, strict=False))
            return {**p.values, **values, omega: w, divided: table[0]}

        what = f"the averaged damping at {count} amplitudes, sampled"
        # Odd powers have no average, and then the difference of the sampled values is rounding.
        unit = drawn(self.model, random.Random(0)).unit
        return equals(what, tolerance=1e-8, floor=1e-3 * unit ** (2 - 2 * count))(draw)

    # Phase steps of -π/2.

    @equals("a rotation by a quarter turn per site")
    def turned(self, rng: random.Random) -> Point:
        """Rotate a real amplitude by -π/2 per site, and all sites by the shift in frequency."""
        p, place, when = drawn(self.model, rng), rng.choice((1, 3, 5)), rng.uniform(0, 4)
        size = complex(rng.uniform(0.2, 1), rng.uniform(-0.5, 0.5))
        spin = cmath.exp(1j * p.eps * sum(p.springs) * when)
        return {**p.values, n: place, t: when, r(n, t): size,
                phi(n, t): size * (-1j) ** place * spin}  # fmt: skip

    def _quarter_turns(self, sizes: dict[int, complex], p: ChainNumbers, centre: bool) -> complex:
        """Return r' of the middle site for amplitudes with phase steps of -π/2."""
        phases = {at: (-1j) ** (abs(at) if centre else at) for at in sizes}
        field = {at: size * phases[at] for at, size in sizes.items()}
        spin = 1j * p.eps * sum(p.springs)
        return -direct_average(field, spin * field[0], p, 1.0)

    @equals(_DIRECT)
    def quarter_turn(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw amplitudes with phase steps of -π/2, away from site 0."""
        p = drawn(self.model, rng)
        sizes = self._field(rng, p.unit)
        moving = p.unit * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point = {**p.values, r(n, t).diff(t): moving, n: 2, t: rng.uniform(0, 3)}
        names = {r(n + at, t): value for at, value in sizes.items()}
        return {**names, **point}, [moving - self._quarter_turns(sizes, p, False)]

    @equals(_DIRECT)
    def quarter_turn_centre(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw the same about site 0, from which phases decrease on both sides."""
        p = drawn(self.model, rng)
        sizes = self._field(rng, p.unit)
        sizes |= {-at: sizes[at] for at in range(1, p.reach + 1)}
        moving = p.unit * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point = {**p.values, r(0, t).diff(t): moving, t: rng.uniform(0, 3)}
        point |= {r(at, t): sizes[at] for at in range(p.reach + 1)}
        return point, [moving - self._quarter_turns(sizes, p, True)]

    @equals(_DIRECT)
    def averaged_centre(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw an envelope that is symmetric about site 0."""
        _, field, rate, p = self._frozen(rng)
        field |= {-at: field[at] for at in range(1, p.reach + 1)}
        point = {**p.values, phi(0, t).diff(t): rate}
        point |= {phi(at, t): field[at] for at in range(p.reach + 1)}
        return point, [direct_average(field, rate, p, 1.0)]

    @equals("one factor a site")
    def tail_wave(self, rng: random.Random) -> Point:
        """Multiply by the same real number from site to site."""
        wave, step, place = self._wave_numbers(rng)
        return {**wave, r(n, t): wave[alpha_0] * abs(step) ** place}

    @equals(_DIRECT + " at vanishing amplitude", tolerance=1e-7)
    def tail(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Average at an amplitude so small that only the linear terms matter."""
        wave, step, _ = self._wave_numbers(rng)
        p = drawn(self.model, rng)
        small = 1e-5 * p.unit
        sizes = {at: complex(small * abs(step) ** at) for at in self.sites}
        return {**p.values, **wave}, [-self._quarter_turns(sizes, p, False) / sizes[0]]
