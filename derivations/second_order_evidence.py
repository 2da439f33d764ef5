"""What the second order is held against: residuals projected by sampling, and true orbits."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from derivations import second_order_symbols as under_test
from derivations.algebra.evidence import solved_for, value
from derivations.algebra.harmonics import site_symbol
from derivations.derivation import Check, Evidence
from derivations.periodic_orbit import harmonic, orbit
from derivations.symbols import a, b, c, epsilon, omega

_P = {"a": 1.7, "b": 0.6, "c": 0.45}
_SITES = {-2: 0.5 - 0.3j, -1: -0.4 + 0.6j, 0: 0.7 + 0.2j, 1: 0.3 + 0.5j, 2: -0.6 - 0.2j}
_SAMPLES = 64
_T = 2 * np.pi * np.arange(_SAMPLES) / _SAMPLES
_STEPS = (1e-2, 1e-3)


def _force(y: Any, rate: Any) -> Any:
    return rate * (1 + y**2 * (_P["b"] * y**2 - _P["a"]))


def _spring(values: dict[int, complex], coupled: bool, at: int = 0) -> complex:
    if not coupled:
        return 0j
    return _P["c"] * (2 * values[at] - values[at - 1] - values[at + 1])


def _spectrum(samples: Any) -> Any:
    return np.fft.fft(samples) / _SAMPLES


def _first(values: dict[int, complex], coupled: bool, at: int) -> complex:
    """dA/d(eps t) at a site, by sampling: half i times the force at e^{it}."""
    size = values[at]
    y, rate = (2 * (q * np.exp(1j * _T)).real for q in (size, 1j * size))
    return 0.5j * complex(_spectrum(_force(y, rate))[1] + _spring(values, coupled, at))


def _names(symbol: str, coupled: bool, values: dict[int, complex]) -> dict[Any, Any]:
    if not coupled:
        return {sp.Symbol(symbol): values[0]}
    return {site_symbol(symbol, offset): q for offset, q in values.items()}


def _slope(errors: list[float], order: int, what: str) -> Evidence:
    if min(errors) == 0:
        return Evidence(False, f"{what}: the error is exactly zero, so nothing was tested")
    found = math.log(errors[0] / errors[1]) / math.log(_STEPS[0] / _STEPS[1])
    return Evidence(
        abs(found - order) < 0.1, f"{what}: slope {found:.3f} in eps, predicted {order}"
    )


def _predicted(candidate: sp.Basic, names: dict[Any, Any], e: float) -> complex:
    point = {**names, epsilon: e, a: _P["a"], b: _P["b"], c: _P["c"]}
    unknown = {under_test.rate, under_test.phi_rate, under_test.fundamental, under_test.r_rate}
    (symbol,) = candidate.free_symbols & unknown
    return complex(solved_for(candidate, symbol, point))


def _residual(rate: complex, values: dict[int, complex], coupled: bool, e: float) -> float:
    """Return what (8) leaves at e^{it} for a given dA/dt, with y1 from a Fourier transform."""
    size, h = values[0], 1e-5
    # A'' to order eps^2: the first-order flow differentiated along itself.
    flow = {at: _first(values, coupled, at) for at in ((-1, 0, 1) if coupled else (0,))}

    def moved(sign: float) -> complex:
        near = {at: q + sign * h * flow.get(at, 0) for at, q in values.items()}
        return _first(near, coupled, 0)

    second = e * e * (moved(1) - moved(-1)) / (2 * h)
    y0, first0 = (2 * (q * np.exp(1j * _T)).real for q in (size, 1j * size))
    spectrum = -_spectrum(_force(y0, first0))
    numbers = np.fft.fftfreq(_SAMPLES, 1 / _SAMPLES)
    keep = np.abs(numbers) != 1
    answer = np.zeros(_SAMPLES, complex)
    answer[keep] = spectrum[keep] / (1 - numbers[keep] ** 2)
    y1 = (np.fft.ifft(answer) * _SAMPLES).real
    first1 = (np.fft.ifft(1j * numbers * answer) * _SAMPLES).real
    slow = 2 * (rate * np.exp(1j * _T)).real
    drag = complex(_spectrum(_force(y0 + e * y1, first0 + slow + e * first1))[1])
    return abs(2j * rate + second + e * (drag + _spring(values, coupled)))


_ALONG = "what (8) leaves at e^{it} along the predicted flow"


def scales(coupled: bool) -> Check:
    """Project (8) on e^{it} along the predicted flow."""

    def check(candidate: sp.Basic) -> Evidence:
        names = _names("A", coupled, _SITES)
        errors = [_residual(_predicted(candidate, names, e), _SITES, coupled, e) for e in _STEPS]
        return _slope(errors, 3, _ALONG)

    return check


def _right_side(values: dict[int, Any], coupled: bool) -> Any:
    """Phi' over eps, sampled; each phi a number or samples."""
    turned = {at: q * np.exp(1j * _T) for at, q in values.items()}
    force = _force(turned[0].imag, turned[0].real)
    if coupled:
        force = force + _P["c"] * (2 * turned[0] - turned[-1] - turned[1]).imag
    return -np.exp(-1j * _T) * force


def _oscillating(values: dict[int, complex], coupled: bool, at: int) -> Any:
    """Return the zero-mean antiderivative of the right side at a site, by Fourier transform."""
    near = {0: values[at]}
    if coupled:
        near |= {-1: values[at - 1], 1: values[at + 1]}
    spectrum = np.fft.fft(_right_side(near, coupled))
    numbers = np.fft.fftfreq(_SAMPLES, 1 / _SAMPLES)
    numbers[0], spectrum[0] = 1, 0
    return np.fft.ifft(spectrum / (1j * numbers))


def averaging(coupled: bool) -> Check:
    """Return the mean of the right side at phi plus its oscillating part, both by sampling."""

    def residual(candidate: sp.Basic, e: float) -> float:
        rate = _predicted(candidate, _names(r"\varphi", coupled, _SITES), e)
        places = (-1, 0, 1) if coupled else (0,)
        full = {at: _SITES[at] + e * _oscillating(_SITES, coupled, at) for at in places}
        return float(abs(e * np.mean(_right_side(full, coupled)) - rate))

    def check(candidate: sp.Basic) -> Evidence:
        errors = [residual(candidate, e) for e in _STEPS]
        return _slope(errors, 3, "what the sampled mean leaves of the predicted flow")

    return check


def fundamental(coupled: bool) -> Check:
    """Return the Fourier coefficient of y at e^{it}; y is the imaginary part of phi e^{it}."""

    def check(candidate: sp.Basic) -> Evidence:
        worst = 0.0
        for e in (0.1, 0.4):
            phi = _SITES[0] + e * _oscillating(_SITES, coupled, 0)
            exact = complex(_spectrum((phi * np.exp(1j * _T)).imag)[1])
            found = _predicted(candidate, _names(r"\varphi", coupled, _SITES), e)
            worst = max(worst, abs(found - exact))
        return Evidence(worst < 1e-12, f"Fourier coefficient of y: off by at most {worst:.1e}")

    return check


_CELLS = ((2.5, 0.5), (1.3, 0.15))
_EPS = (0.02, 0.01)


@lru_cache(maxsize=32)
def cell_orbit(linear: float, quintic: float, outer: bool, e: float) -> tuple[Any, float, float]:
    """Return the true cycle, its frequency, and the square of its averaged amplitude."""
    squares = np.sort(np.roots([quintic / 8, -linear / 4, 1.0]).real)
    s = float(squares[1 if outer else 0])
    samples = 101
    start = math.sqrt(s) * np.sin(2 * np.pi * np.arange(samples) / samples)[None, :]
    y, w = orbit(start, 1.0, {"e": e, "a": linear, "b": quintic, "c": 0.0})
    return y[0], w, s


def _against_orbits(
    error: Callable[[sp.Basic, Any, float, dict[Any, Any]], float], order: int, what: str
) -> Check:
    def check(candidate: sp.Basic) -> Evidence:
        slopes = []
        for linear, quintic in _CELLS:
            for outer in (False, True):
                errors = []
                for e in _EPS:
                    y, w, s = cell_orbit(linear, quintic, outer, e)
                    point = {a: linear, b: quintic, epsilon: e, under_test.square: s}
                    errors.append(error(candidate, y, w, point))
                if min(errors) == 0:
                    return Evidence(False, f"{what}: nothing was tested")
                slopes.append(math.log2(errors[0] / errors[1]))
        # eps is at most 0.02 here but acts through eps * max|1 - a y^2 + b y^4|, up to 0.3.
        holds = all(abs(slope - order) < 0.35 for slope in slopes)
        shown = ", ".join(f"{slope:.2f}" for slope in slopes)
        return Evidence(holds, f"{what}: slopes {shown} in eps, predicted {order}")

    return check


def _frequency_error(candidate: sp.Basic, _: Any, w: float, point: dict[Any, Any]) -> float:
    left, right = (value(side, {**point, omega: w}) for side in candidate.args)
    return float(abs(left - right))


def _amplitude_error(candidate: sp.Basic, y: Any, _: float, point: dict[Any, Any]) -> float:
    found = abs(complex(harmonic(y, 1)))
    left, right = (value(side, {**point, under_test.size: found}) for side in candidate.args)
    return float(abs(left - right))


def _harmonics_error(candidate: sp.Basic, y: Any, _: float, point: dict[Any, Any]) -> float:
    """Y minus its fundamental, against eps y1, over one period.

    Time is counted from an arbitrary origin: from a zero of y, A is imaginary and y1 the same
    forwards and backwards.
    """
    first = complex(harmonic(y, 1))
    times = 2 * np.pi * np.arange(len(y)) / len(y)
    rest = y - 2 * (first * np.exp(1j * times)).real
    origin = times[11]
    amplitude = -0.5j * math.sqrt(point[under_test.square]) * np.exp(1j * origin)
    numbers = {**point, sp.Symbol("A"): amplitude}
    worst = 0.0
    for place in (7, 31, 58):
        here = {**numbers, under_test.turn: np.exp(1j * (times[place] - origin))}
        found = solved_for(candidate, under_test.y_next, here)
        worst = max(worst, abs(rest[place] - point[epsilon] * found))
    return float(worst)


def staggered(candidate: sp.Basic) -> Evidence:
    """Check the flow of A at staggered real amplitudes; the residual is projected by sampling."""
    reals = {-2: 1.7, -1: 1.4, 0: 1.2, 1: 0.9, 2: 0.7}
    names = {under_test.r_far_left: 1.7, under_test.r_left: 1.4, under_test.r_n: 1.2,
             under_test.r_right: 0.9, under_test.r_far_right: 0.7}  # fmt: skip
    phases = {at: -0.5j * (-1j) ** at for at in reals}
    values = {at: phases[at] * q for at, q in reals.items()}
    errors = []
    for e in _STEPS:
        rho = _predicted(candidate, names, e) + 1j * _P["c"] * reals[0]
        errors.append(_residual(e * phases[0] * rho, values, True, e))
    return _slope(errors, 3, _ALONG)


next_harmonics = _against_orbits(_harmonics_error, 2, "overtones of the true cycle minus eps y1")
cell_frequency = _against_orbits(_frequency_error, 4, "error of the frequency of the true cycle")
cell_amplitude = _against_orbits(_amplitude_error, 2, "error of the fundamental of the true cycle")
