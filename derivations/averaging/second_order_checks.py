"""Checks of the second order: residuals projected by sampling, and exact orbits.

Amplitudes are drawn and compared in units of the order of those of the cycles, and eps is chosen in
units of the inverse of the forces at these amplitudes.
"""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import Point, equals, slope_of, solved_for, value
from derivations.algebra.steps import Evidence
from derivations.averaging import symbols as own
from derivations.averaging.periodic_orbit import harmonic, orbit
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn, drawn_values, numbers_of
from derivations.multiple_scales.two_times_checks import TwoTimesChecks
from derivations.symbols import n, omega, t

_SAMPLES = 128
_T = 2 * np.pi * np.arange(_SAMPLES) / _SAMPLES
_STEPS = (1e-2, 1e-3)
_SMALLEST = 1e-13
"""Smallest relative error of which a slope is computed; those of orbits are limited by rounding."""
_ROUNDING = 1e-15
"""Largest residual of rates of order eps that counts as rounding, in units of the amplitude."""
_ALONG = "the residual of the equation of motion at e^{it} along the predicted flow"
_WEAK = 0.05
"""Largest force on a cycle, over its amplitude, times eps: the effective small parameter."""


class SecondOrderChecks:
    """The checks of the second order for one chain or cell.

    Parameters
    ----------
    model : ChainModel
        The chain; an isolated cell has no springs.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model
        rng: random.Random = random.Random(4)
        self._values = drawn_values(model, rng, 0.4, 1.2)
        far, p = 2 * model.reach, self._numbers(1.0)
        self._unit, self._weak = p.unit, 1 / p.strength
        self._sites = {at: self._unit * complex(rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6))
                       for at in range(-far, far + 1)}  # fmt: skip
        self.motion = TwoTimesChecks(model).chain

    @property
    def _is_linear(self) -> bool:
        return max(self.model.damping) == 0 and max(self.model.stiffness, default=0) <= 1

    @property
    def _steps(self) -> list[float]:
        return [e * self._weak for e in _STEPS]

    def _numbers(self, e: float) -> ChainNumbers:
        return numbers_of(self.model, self._values, e)

    # Residuals.

    def _first(self, values: dict[int, complex], at: int, p: ChainNumbers) -> complex:
        """dA/d(eps t) at a site by sampling: half i times the force at e^{it}."""
        size = values[at]
        y, rate = (2 * (q * np.exp(1j * _T)).real for q in (size, 1j * size))
        return complex(0.5j * (_coefficient(p.force(y, rate)) - p.tension(values, at)))

    def _names(self, field: sp.FunctionClass, values: dict[int, complex]) -> dict[Any, Any]:
        return {field(n + at, t): size for at, size in values.items()}

    def _predicted(self, candidate: sp.Basic, unknown: sp.Basic, names: Any, e: float) -> complex:
        point = {**self._numbers(e).values, **names}
        return complex(solved_for(candidate, unknown, point, self._unit))

    def _residual(self, rate: complex, values: dict[int, complex], e: float) -> float:
        """Return the residual of (8) at e^{it} for a given dA/dt, with y1 by Fourier transform."""
        p, h, reach = self._numbers(e), 1e-5 * self._weak, self.model.reach
        # A'' to order eps^2 is the derivative of the first-order flow along itself.
        flow = {at: self._first(values, at, p) for at in range(-reach, reach + 1)}

        def moved(sign: float) -> complex:
            near = {at: q + sign * h * flow.get(at, 0) for at, q in values.items()}
            return self._first(near, 0, p)

        second = e * e * (moved(1) - moved(-1)) / (2 * h)
        size = values[0]
        y0, first0 = (2 * (q * np.exp(1j * _T)).real for q in (size, 1j * size))
        y1, first1 = _response(p.force(y0, first0))
        slow = 2 * (rate * np.exp(1j * _T)).real
        drag = _coefficient(p.force(y0 + e * y1, first0 + slow + e * first1))
        return float(abs(2j * rate + second + e * (drag - p.tension(values))))

    def scales(self, candidate: sp.Basic) -> Evidence:
        """Project the equation of motion on e^{it} along the predicted flow."""
        names, unknown = self._names(own.amplitude, self._sites), own.amplitude(n, t).diff(t)
        errors = [self._residual(self._predicted(candidate, unknown, names, e), self._sites, e)
                  for e in self._steps]  # fmt: skip
        return _slope(errors, 3, _ALONG)

    def quarter_turn(self, candidate: sp.Basic) -> Evidence:
        """Project on e^{it} along the flow in quarter turns, at t = 0 and n = 0."""
        sizes = {at: 2 * q for at, q in self._sites.items()}
        values = {at: -0.5j * (-1j) ** at * q for at, q in sizes.items()}
        names = {**self._names(own.rho, sizes)}
        # The fields are inserted first; the remaining n and t occur in phases.
        names |= {n: 0, t: 0}
        errors = []
        for e in self._steps:
            rate = self._predicted(candidate, own.rho(n, t).diff(t), names, e)
            spin = 1j * e * sum(self._numbers(e).springs)
            errors.append(self._residual(-0.5j * (rate + spin * sizes[0]), values, e))
        return _slope(errors, 3, _ALONG)

    def _right_side(self, values: dict[int, Any], p: ChainNumbers, at: int = 0) -> Any:
        """Return phi'/eps at a site by sampling; each phi is a number or an array of samples."""
        reach = self.model.reach
        turned = {place: values[at + place] * np.exp(1j * _T) for place in range(-reach, reach + 1)}
        places = {place: q.imag for place, q in turned.items()}
        force = p.force(places[0], turned[0].real) - p.tension(places)
        return -np.exp(-1j * _T) * force

    def _oscillating(self, at: int, p: ChainNumbers) -> Any:
        """Return the zero-mean antiderivative of the right-hand side at a site."""
        spectrum = np.fft.fft(self._right_side(self._sites, p, at))
        numbers = np.fft.fftfreq(_SAMPLES, 1 / _SAMPLES)
        numbers[0], spectrum[0] = 1, 0
        return np.fft.ifft(spectrum / (1j * numbers))

    def averaging(self, candidate: sp.Basic) -> Evidence:
        """Compare with the mean of the right-hand side at phi plus its oscillating part."""
        reach, errors = self.model.reach, []
        names, unknown = self._names(own.phi, self._sites), own.phi(n, t).diff(t)
        for e in self._steps:
            p = self._numbers(e)
            full = {at: self._sites[at] + e * self._oscillating(at, p)
                    for at in range(-reach, reach + 1)}  # fmt: skip
            exact = e * np.mean(self._right_side(full, p))
            missed = exact - self._predicted(candidate, unknown, names, e)
            errors.append(float(abs(missed)) / self._unit)
        what = "the part of the predicted flow that remains after averaging by sampling"
        if self._is_linear:  # this order is then exact
            return Evidence(max(errors) < _ROUNDING, f"{what}: {max(errors):.1e}, rounding")
        return _slope(errors, 3, what)

    def fundamental(self, candidate: sp.Basic) -> Evidence:
        """Compare with the Fourier coefficient of y, the imaginary part of phi e^{it}."""
        worst, names = 0.0, self._names(own.phi, self._sites)
        for e in (0.1 * self._weak, 0.4 * self._weak):
            phi = self._sites[0] + e * self._oscillating(0, self._numbers(e))
            exact = _coefficient((phi * np.exp(1j * _T)).imag)
            found = self._predicted(candidate, own.fundamental, names, e)
            worst = max(worst, abs(found - exact) / self._unit)
        return Evidence(worst < 1e-12, f"Fourier coefficient of y: off by at most {worst:.1e}")

    @equals("a rotation by a quarter turn per site")
    def turned(self, rng: random.Random) -> Point:
        """Rotate a real amplitude by -π/2 per site, and all sites by the shift in frequency."""
        p, place, when = drawn(self.model, rng), rng.choice((1, 3, 5)), rng.uniform(0, 4)
        size = complex(rng.uniform(0.2, 1), rng.uniform(-0.5, 0.5))
        spin = cmath.exp(1j * p.eps * sum(p.springs) * when)
        return {**p.values, own.rho(n, t): size, n: place, t: when,
                own.amplitude(n, t): size * (-1j) ** place * spin / 2j}  # fmt: skip

    # Cycles of the cell.

    @equals("the damping of the cell, averaged by sampling")
    def cycles(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a cell at any amplitude; its energy loss is zero on a cycle."""
        p = drawn(self.model, rng)
        size = p.unit * rng.uniform(0.3, 1.5)
        loss = -2 * p.cell_rate(size).real / p.eps
        return {**p.values, own.square: size**2}, [loss]

    def _against_orbits(
        self, error: Callable[[sp.Basic, Any, float, dict[Any, Any]], float], candidate: sp.Basic,
        order: int, what: str,
    ) -> Evidence:  # fmt: skip
        slopes = []
        for values, square in _cycles(self.model.cell()):
            errors = []
            for e in _small(self.model, values, square):
                p = numbers_of(self.model, dict(values), e)
                y, w = _orbit(self.model.cell(), values, square, e)
                errors.append(error(candidate, y, w, {**p.values, own.square: square}))
            if min(errors) == 0:
                return Evidence(False, f"{what}: nothing was tested")
            if errors[1] < _SMALLEST:
                continue
            slopes.append(math.log2(errors[0] / errors[1]))
        if not slopes:
            raise DerivationInputError(
                "damping", self.model.damping_of(sp.Symbol("y")), "that of a cell with a limit "
                "cycle at some positive values of its letters",
                "for other cells the second order cannot be checked: leave it out",
            )  # fmt: skip
        holds = all(slope > order - 0.35 for slope in slopes)
        shown = ", ".join(f"{slope:.2f}" for slope in slopes)
        return Evidence(holds, f"{what}: slopes {shown} in ε, predicted at least {order}")

    def cell_frequency(self, candidate: sp.Basic) -> Evidence:
        """Compare with the frequency of exact cycles."""
        order = 3 if self.model.stiffness else 4  # without stiffness it is even in eps

        def error(judged: sp.Basic, _: Any, w: float, point: dict[Any, Any]) -> float:
            left, right = (value(side, {**point, omega: w}) for side in judged.args)
            return float(abs(left - right))

        return self._against_orbits(error, candidate, order,
                                    "error of the frequency of the true cycle")  # fmt: skip

    def cell_amplitude(self, candidate: sp.Basic) -> Evidence:
        """Compare with the fundamental of exact cycles."""

        def error(judged: sp.Basic, y: Any, _: float, point: dict[Any, Any]) -> float:
            found = abs(complex(harmonic(y, 1)))
            left, right = (value(side, {**point, own.size: found}) for side in judged.args)
            return float(abs(left - right)) / found

        return self._against_orbits(error, candidate, 2,
                                    "error of the fundamental of the true cycle")  # fmt: skip

    def next_harmonics(self, candidate: sp.Basic) -> Evidence:
        """Compare eps y1 with the exact cycle minus its fundamental, over one period."""
        return self._against_orbits(_harmonics_error, candidate, 2,
                                    "overtones of the true cycle minus ε y₁")  # fmt: skip


def _harmonics_error(candidate: sp.Basic, y: Any, _: float, point: dict[Any, Any]) -> float:
    """Return the largest relative error of the overtones, with time from an arbitrary origin.

    If time starts at a zero of y, A is imaginary and y1 is symmetric under time reversal.
    """
    first = complex(harmonic(y, 1))
    times = 2 * np.pi * np.arange(len(y)) / len(y)
    rest = y - 2 * (first * np.exp(1j * times)).real
    origin = times[11]
    size = math.sqrt(point[own.square])
    amplitude = -0.5j * size * np.exp(1j * origin)
    numbers = {**point, own.amplitude(n, t): amplitude}
    eps = next(given for symbol, given in point.items() if symbol.name == "epsilon")
    worst = 0.0
    for place in (7, 31, 58):
        here = {**numbers, own.turn: np.exp(1j * (times[place] - origin))}
        found = solved_for(candidate, own.y_next, here, size)
        worst = max(worst, abs(rest[place] - eps * found))
    return float(worst) / size


def _coefficient(samples: Any) -> complex:
    return complex(np.mean(samples * np.exp(-1j * _T)))


def _response(force: Any) -> tuple[Any, Any]:
    """Solve ``u'' + u = -force`` without its resonant part; return samples of u and u'."""
    spectrum = -np.fft.fft(force)
    numbers = np.fft.fftfreq(_SAMPLES, 1 / _SAMPLES)
    keep = np.abs(numbers) != 1
    answer = np.zeros(_SAMPLES, complex)
    answer[keep] = spectrum[keep] / (1 - numbers[keep] ** 2)
    return np.fft.ifft(answer).real, np.fft.ifft(1j * numbers * answer).real


def _slope(errors: list[float], order: int, what: str) -> Evidence:
    if min(errors) == 0:
        return Evidence(False, f"{what}: the error is exactly zero, so nothing was tested")
    found = math.log(errors[0] / errors[1]) / math.log(_STEPS[0] / _STEPS[1])
    statement = f"{what}: slope {found:.3f} in ε, predicted at least {order}"
    return Evidence(found > order - 0.1, statement)


Values = tuple[tuple[sp.Symbol, float], ...]


@lru_cache(maxsize=32)
def _cycles(model: ChainModel) -> tuple[tuple[Values, float], ...]:
    """Return two choices of parameters at which a cell has cycles, with the squares of these.

    The rates of attraction or repulsion of the cycles are not small.
    """
    rng: random.Random = random.Random(3)
    found: list[tuple[Values, float]] = []
    for _ in range(2000 if model.parameters else 1):
        values = tuple((symbol, math.exp(rng.uniform(-3, 1.5))) for symbol in model.parameters)
        p = numbers_of(model, dict(values), 1.0)
        found += [(values, size**2) for size in p.cycles() if _is_isolated(size, p)]
        if len(found) >= 2:
            break
    return tuple(found)


def _is_isolated(size: float, p: ChainNumbers) -> bool:
    exponent = size * slope_of(lambda q: p.cell_rate(q).real, size, 1e-3 * size)
    return bool(abs(exponent) > 0.1 * _strongest(size, p))


def _strongest(size: float, p: ChainNumbers) -> float:
    """Return the largest force per eps on a cycle of this size, over the size."""
    return float(np.abs(p.force(np.linspace(0, size, 40), size)).max()) / size


def _small(model: ChainModel, values: Values, square: float) -> tuple[float, float]:
    """Return two values of eps, both weak for a cycle of this size."""
    large = _WEAK / _strongest(math.sqrt(square), numbers_of(model, dict(values), 1.0))
    return large, large / 2


@lru_cache(maxsize=64)
def _orbit(model: ChainModel, values: Values, square: float, e: float) -> tuple[Any, float]:
    """Return the exact cycle near an averaged one over one period, and its frequency."""
    samples = 101
    start = math.sqrt(square) * np.sin(2 * np.pi * np.arange(samples) / samples)[None, :]
    y, w = orbit(start, 1.0, numbers_of(model, dict(values), e))
    return y[0], w
