"""Checks of Eqs. (8)-(30) by forces, numerical derivatives and direct Fourier averages.

No symbolic computation is used. Test motions are fixed smooth functions; parameters are random.
Only the coefficients of the chain are taken from its model.
"""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import (
    Point,
    Points,
    at_points,
    equals,
    fast_average,
    residual,
    solved_for,
)
from derivations.algebra.steps import Evidence
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn, numbers_of
from derivations.multiple_scales import symbols as own
from derivations.symbols import (
    R,
    alpha_0,
    delta,
    epsilon,
    k_1,
    k_2,
    n,
    omega,
    omega_1,
    omega_2,
    t,
    t_hat,
    tau,
    theta,
    y,
)

_DIRECT = "the Fourier coefficient of the drive by direct averaging"
_W1, _W2 = mp.mpf("0.37"), mp.mpf("-0.23")
_WAVE = {k_1: mp.mpf("-0.8"), k_2: mp.mpf("0.9"), alpha_0: mp.mpf("1.3")}
_AT = (mp.mpf("0.8"), mp.mpf("0.35"))
_EPSILONS = (mp.mpf("0.3"), mp.mpf("-0.8"))
_STEP = mp.mpf("1e-9")


def wave_numbers(rng: random.Random) -> dict[sp.Symbol, float]:
    """Draw an amplitude, a decay rate and a phase step."""
    return {k_1: rng.uniform(-2, -0.3), k_2: rng.uniform(-2, 2), alpha_0: rng.uniform(0.5, 2)}


def _test_motion(p: Any, q: Any) -> Any:
    return mp.sin(1.1 * p + 0.3) * mp.exp(-0.7 * q) + 0.4 * mp.cos(2 * p) * (1 + q**2)


def _second_motion(p: Any, q: Any) -> Any:
    return mp.cos(0.9 * p + 0.2) * (1 + 0.5 * q) + 0.3 * mp.sin(3 * p - q)


def _partials(function: Callable[[Any, Any], Any], symbol: sp.Expr, p: Any, q: Any) -> Point:
    point: dict[Any, Any] = {symbol: function(p, q)}
    for first, second in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        variables = [t_hat] * first + [tau] * second
        point[symbol.diff(*variables)] = mp.diff(function, (p, q), (first, second))
    return point


class ScalesChecks:
    """The checks of the derivation for one chain; each can judge any equation in place of a step's.

    Parameters
    ----------
    model : ChainModel
        The chain.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model
        self.sites = tuple(range(-model.reach, model.reach + 1))
        self._fixed = {q: mp.mpf(17 + 5 * at) / 20 for at, q in enumerate(model.parameters)}

    # Springs and dampers.

    @equals("the forces of springs and damper")
    def chain(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a moving chain, for which (8) states the deviation from free motion."""
        p = drawn(self.model, rng)
        field = {at: rng.uniform(-1, 1) for at in self.sites}
        rate, second = rng.uniform(-1, 1), rng.uniform(-1, 1)
        point = {**p.values, y(n, t).diff(t, 2): second, y(n, t).diff(t): rate}
        point |= {y(n + at, t): value for at, value in field.items()}
        return point, [second + p.rest(field, rate)]

    def _mirrored(self, p: ChainNumbers, own_value: float, sides: list[float], rate: float) -> Any:
        field = {0: own_value}
        for at, value in enumerate(sides, start=1):
            field |= {at: value, -at: value}
        return p.rest(field, rate)

    @equals("Eq. (8) with mirrored neighbours")
    def centre(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a chain that is symmetric about site 0."""
        p = drawn(self.model, rng)
        place, rate, second = (rng.uniform(0.2, 1) for _ in range(3))
        sides = [rng.uniform(-1, 1) for _ in range(p.reach)]
        point = {**p.values, y(0, t).diff(t, 2): second, y(0, t).diff(t): rate, y(0, t): place}
        point |= {y(at, t): value for at, value in enumerate(sides, start=1)}
        return point, [second + self._mirrored(p, place, sides, rate)]

    @equals("Eq. (8) with the assumed neighbours")
    def forced(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw an arbitrary motion of site 0, with neighbours that move as in (9)."""
        p, wave = drawn(self.model, rng), wave_numbers(rng)
        place, rate, second, when, w = (rng.uniform(0.2, 1) for _ in range(5))
        step = cmath.exp(complex(wave[k_1], wave[k_2]))
        turned = wave[alpha_0] * cmath.exp(1j * w * when)
        sides = [(turned * step**at).imag for at in range(1, p.reach + 1)]
        point = {**p.values, **wave, y(0, t).diff(t, 2): second, y(0, t).diff(t): rate,
                 y(0, t): place, t: when, omega: w}  # fmt: skip
        return point, [second + self._mirrored(p, place, sides, rate)]

    # Two times: the residual of the central equation along a test motion, differentiated in ε.

    def _exact(self, motion: Callable[[Any, Any, Any], Any], e: Any, w: Any) -> Any:
        """Evaluate Eq. (11) along ``y = motion(p + w s, q + e s, e)``, differentiated along s."""
        numbers = numbers_of(self.model, self._fixed, e)
        p, q = _AT

        def path(s: Any) -> Any:
            return motion(p + w * s, q + e * s, e)

        place, rate, second = path(mp.mpf(0)), mp.diff(path, 0), mp.diff(path, 0, 2)
        sides = [_WAVE[alpha_0] * mp.exp(at * _WAVE[k_1]) * mp.sin(p + at * _WAVE[k_2])
                 for at in range(1, numbers.reach + 1)]  # fmt: skip
        return second + self._mirrored(numbers, place, sides, rate)

    def _point(self, e: Any, w: Any) -> dict[Any, Any]:
        return {**self._fixed, **_WAVE, epsilon: e, omega: w, omega_1: _W1, omega_2: _W2,
                t_hat: _AT[0], tau: _AT[1]}  # fmt: skip

    def _coefficients(
        self, motion: Callable[[Any, Any, Any], Any], frequency: Callable[[Any], Any]
    ) -> tuple[Any, Any]:
        """Return value at ε = 0 and slope in ε of the exact residual."""
        up, down = (self._exact(motion, e, frequency(e)) for e in (_STEP, -_STEP))
        middle = self._exact(motion, mp.mpf(0), frequency(mp.mpf(0)))
        return middle, (up - down) / (2 * _STEP)

    def _compare(
        self, candidate: sp.Basic, point: Point, expected: Callable[[Any], Any], what: str
    ) -> Evidence:
        """Compare left minus right at two values of ε, neither of them small."""
        worst = mp.mpf(0)
        for e in _EPSILONS:
            found, size = residual(candidate, {**point, epsilon: e}, 40)
            worst = max(worst, abs(found - expected(e)) / (size + abs(expected(e))))
        shown = mp.nstr(worst, 2)
        # The slope is a central difference with step 1e-9, whose error is of order 1e-18.
        return Evidence(worst < 1e-12, f"{what}: relative difference {shown}")

    def in_two_times(self, candidate: sp.Basic) -> Evidence:
        """Compare with the residual itself, from which nothing was omitted."""
        with mp.workdps(40):
            w = 1 + _W1
            point = {**self._point(0, w), **_partials(_test_motion, own.Y, *_AT)}
            return self._compare(
                candidate, point,
                lambda e: self._exact(lambda p, q, _: _test_motion(p, q), e, w),
                "the centre along a test motion, differentiated numerically",
            )  # fmt: skip

    def two_times(self, candidate: sp.Basic) -> Evidence:
        """Compare with value and slope in ε at fixed ω; no terms of order ε² may be left."""
        with mp.workdps(40):
            w = 1 + _W1
            point = {**self._point(0, w), **_partials(_test_motion, own.Y, *_AT)}
            low, slope = self._coefficients(lambda p, q, _: _test_motion(p, q), lambda _: w)
            return self._compare(candidate, point, lambda e: low + e * slope,
                                 "value and slope in ε of the centre along a test motion at fixed "
                                 "ω")  # fmt: skip

    def expanded(self, candidate: sp.Basic) -> Evidence:
        """Compare with value and slope in ε along the expanded frequency."""
        with mp.workdps(40):
            point = {**self._point(0, 1), **_partials(_test_motion, own.Y, *_AT)}
            low, slope = self._coefficients(lambda p, q, _: _test_motion(p, q), _frequency)
            what = "value and slope in ε of the centre along a test motion"
            return self._compare(candidate, point, lambda e: low + e * slope, what)

    def _order_point(self) -> dict[Any, Any]:
        return {**self._point(0, 1), **_partials(_test_motion, own.Y_0, *_AT),
                **_partials(_second_motion, own.Y_1, *_AT)}  # fmt: skip

    def solution_put(self, candidate: sp.Basic) -> Evidence:
        """Compare value and slope in ε, with the ε of the expanded solution fixed at two values."""
        with mp.workdps(40):
            point = self._order_point()

            def expected(e: Any) -> Any:
                low, slope = self._coefficients(
                    lambda p, q, _: _expanded_motion(p, q, e), _frequency
                )
                return low + e * slope

            what = "value and slope in ε of the centre along a test motion"
            return self._compare(candidate, point, expected, what)

    def order_zero(self, candidate: sp.Basic) -> Evidence:
        """Compare with the residual at ε = 0."""
        with mp.workdps(40):
            low, _ = self._coefficients(_expanded_motion, _frequency)
            return self._compare(candidate, self._order_point(), lambda _: low,
                                 "the centre along a test motion at ε = 0")  # fmt: skip

    def order_one(self, candidate: sp.Basic) -> Evidence:
        """Compare with the slope of the residual in ε."""
        with mp.workdps(40):
            _, slope = self._coefficients(_expanded_motion, _frequency)
            return self._compare(candidate, self._order_point(), lambda _: slope,
                                 "the slope in ε of the centre along a test motion")  # fmt: skip

    # Definitions and ansätze.

    @staticmethod
    @equals("a motion multiplied by one complex factor per site")
    def ansatz(rng: random.Random) -> Point:
        """Compare the assumed motion with one that is multiplied by a complex factor per site."""
        place, when, w = rng.choice([-3, -1, 2]), rng.uniform(0, 1), rng.uniform(0.5, 1.5)
        wave = wave_numbers(rng)
        step = cmath.exp(complex(wave[k_1], wave[k_2]))
        value = wave[alpha_0] * (cmath.exp(1j * w * when) * step ** abs(place)).imag
        return {**wave, y(n, t): value, n: place, t: when, omega: w}

    @staticmethod
    def frequency(candidate: sp.Basic) -> Evidence:
        """Check the linear frequency at ε = 0, and the coefficients as derivatives in ε."""
        h = 1e-3
        down, middle, up = (
            solved_for(candidate, omega, {epsilon: e, omega_1: 0.7, omega_2: -0.4}).real
            for e in (-h, 0.0, h)
        )
        found = (middle - 1, (up - down) / (2 * h) - 0.7,
                 (up - 2 * middle + down) / (2 * h**2) + 0.4)  # fmt: skip
        worst = max(map(abs, found))
        return Evidence(worst < 1e-8, f"1, ω_1 and ω_2 recovered by differences to {worst:.1e}")

    @staticmethod
    @equals("time counted in periods and in units of 1/ε", parts=2)
    def times(rng: random.Random) -> Point:
        """Count time in periods and in units of 1/ε."""
        period, scale, when = rng.uniform(4, 8), rng.uniform(5, 20), rng.uniform(0, 3)
        return {t: when, omega: 2 * math.pi / period, epsilon: 1 / scale,
                t_hat: 2 * math.pi * when / period, tau: when / scale}  # fmt: skip

    @staticmethod
    @equals("numerical derivatives of a test motion", parts=2, tolerance=1e-8)
    def chain_rule(rng: random.Random) -> Point:
        """Differentiate a test motion numerically."""
        w, e, when = (mp.mpf(rng.uniform(0.3, 1.5)) for _ in range(3))

        def motion(s: Any) -> Any:
            return _test_motion(w * s, e * s)

        own_rate = y(0, t).diff(t)
        return {own_rate.diff(t): mp.diff(motion, when, 2), own_rate: mp.diff(motion, when),
                **_partials(_test_motion, own.Y, w * when, e * when), omega: w,
                epsilon: e}  # fmt: skip

    @staticmethod
    @at_points("the motion of order 1 at ε = 0, and its slope in ε")
    def expansion() -> Points:
        """Require at ε = 0 the motion of order 1, and as its slope in ε the motion of order ε."""
        for e in (0.0, 0.3):
            yield {epsilon: e, own.Y_0: 0.7, own.Y_1: -1.2, own.Y: 0.7 - 1.2 * e}, None

    @staticmethod
    def free_solution(candidate: sp.Basic) -> Evidence:
        """Require a real motion of one harmonic whose complex coefficient is A."""
        size = 0.6 - 0.8j
        return _one_harmonic(candidate, own.Y_0, {own.A: size}, size)

    @staticmethod
    def steady_oscillation(candidate: sp.Basic) -> Evidence:
        """Require a real motion of one harmonic of modulus R and argument θ."""
        return _one_harmonic(candidate, own.Y_0, {R: 1.3, theta: 0.4}, 1.3 * cmath.exp(0.4j))

    @staticmethod
    @at_points("a sine of amplitude α_0")
    def central_motion() -> Points:
        """Require a sine of amplitude α_0 that starts at zero, in t or in the fast time."""
        for phase in (0.3, 1.7):
            exact = 1.7 * math.sin(phase)
            yield {alpha_0: 1.7, t_hat: phase, omega: 0.8, t: phase / 0.8, k_1: -0.4, k_2: 0.6,
                   y(0, t): exact, own.Y: exact}, [0]  # fmt: skip

    @staticmethod
    @equals("modulus and argument")
    def polar(rng: random.Random) -> Point:
        """Compare the polar form with cosine and sine."""
        size, angle = rng.uniform(0.3, 2), rng.uniform(-3, 3)
        value = complex(size * math.cos(angle), size * math.sin(angle))
        return {own.R_slow: size, own.theta_slow: angle, own.A: value}

    @staticmethod
    @at_points("the Fourier coefficient of a sine, sampled", parts=2)
    def match() -> Points:
        """Compute the first Fourier coefficient of the assumed motion by sampling."""
        found = fast_average(lambda s: 1.7 * np.sin(s), 1)
        yield {alpha_0: 1.7, R: abs(found), theta: cmath.phase(found)}, None

    @staticmethod
    @at_points("the amplitude of a sine, sampled", parts=1)
    def doubled() -> Points:
        """Compute the modulus of the first Fourier coefficient of the assumed motion."""
        yield {alpha_0: 1.7, R: abs(fast_average(lambda s: 1.7 * np.sin(s), 1))}, None

    # The resonant part of (19).

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
        p, wave = drawn(self.model, rng), wave_numbers(rng)
        size, angle, w1 = (rng.uniform(0.4, 1.3) for _ in range(3))
        return {**p.values, **wave, R: size, theta: angle, omega_1: w1}, p, wave

    @equals(_DIRECT)
    def secular(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a complex amplitude and its rate."""
        point, p, wave = self._drawn_amplitude(rng)
        size = point[R] * cmath.exp(1j * point[theta])
        rate = complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
        point |= {own.A.diff(tau): rate, own.A: size}
        return point, [self._resonance(p, size, rate, point[omega_1], wave)]

    def _turned(self, rng: random.Random, steady: bool) -> tuple[dict[Any, Any], complex]:
        point, p, wave = self._drawn_amplitude(rng)
        turn = cmath.exp(1j * point[theta])
        grow, spin = rng.uniform(0.4, 1), rng.uniform(0.4, 1)
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
        moved = self._resonance(p, size, 0, 1.0, alone) / size
        free = still.real / (still.real - moved.real)
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


def _frequency(e: Any) -> Any:
    return 1 + e * _W1 + e**2 * _W2


def _expanded_motion(p: Any, q: Any, e: Any) -> Any:
    return _test_motion(p, q) + e * _second_motion(p, q)


def _one_harmonic(
    candidate: sp.Basic, unknown: sp.Expr, given: Point, coefficient: complex
) -> Evidence:
    samples = 2 * np.pi * np.arange(8) / 8
    found = np.array([solved_for(candidate, unknown, {**given, t_hat: s}) for s in samples])
    spectrum = np.fft.fft(found) / 8
    expected = np.zeros(8, complex)
    expected[1], expected[-1] = coefficient, coefficient.conjugate()
    worst = float(abs(spectrum - expected).max())
    return Evidence(worst < 1e-12, f"its Fourier coefficients are as named: off by {worst:.1e}")
