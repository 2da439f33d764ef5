"""Checks of Eqs. (8)-(19) by forces and numerical derivatives along test motions in two times.

No symbolic computation is used; only the coefficients of the chain are taken from its model.
"""

from __future__ import annotations

import cmath
import random
from collections.abc import Callable
from typing import Any

import mpmath as mp
import sympy as sp

from derivations.algebra.evidence import Point, equals, residual
from derivations.algebra.steps import Evidence
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn, numbers_of
from derivations.multiple_scales import symbols as own
from derivations.multiple_scales.motions import first_motion, partials, second_motion, wave_numbers
from derivations.symbols import (
    alpha_0,
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
    y,
)

_W1, _W2 = mp.mpf("0.37"), mp.mpf("-0.23")
_WAVE = {k_1: mp.mpf("-0.8"), k_2: mp.mpf("0.9")}
_SIZE = mp.mpf("1.3")
_AT = (mp.mpf("0.8"), mp.mpf("0.35"))
_EPSILONS = (mp.mpf("0.3"), mp.mpf("-0.8"))
_STEP = mp.mpf("1e-9")


class TwoTimesChecks:
    """The checks of the chain and of its expansion in two times, for one chain.

    Each can judge any equation in place of that of a step.

    Parameters
    ----------
    model : ChainModel
        The chain.
    """

    def __init__(self, model: ChainModel) -> None:
        self.model = model
        self.sites = tuple(range(-model.reach, model.reach + 1))
        self._fixed = {q: mp.mpf(17 + 5 * at) / 20 for at, q in enumerate(model.parameters)}
        self._unit = numbers_of(model, self._fixed, 1.0).unit
        self._wave = {**_WAVE, alpha_0: self._unit * _SIZE}

    def _first(self, p: Any, q: Any) -> Any:
        return self._unit * first_motion(p, q)

    def _second(self, p: Any, q: Any) -> Any:
        return self._unit * second_motion(p, q)

    def _expanded(self, p: Any, q: Any, e: Any) -> Any:
        return self._first(p, q) + e * self._second(p, q)

    @equals("the forces of springs and damper")
    def chain(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw a moving chain, for which (8) states the deviation from free motion."""
        p = drawn(self.model, rng)
        field = {at: p.unit * rng.uniform(-1, 1) for at in self.sites}
        rate, second = (p.unit * rng.uniform(-1, 1) for _ in range(2))
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
        place, rate, second = (p.unit * rng.uniform(0.2, 1) for _ in range(3))
        sides = [p.unit * rng.uniform(-1, 1) for _ in range(p.reach)]
        point = {**p.values, y(0, t).diff(t, 2): second, y(0, t).diff(t): rate, y(0, t): place}
        point |= {y(at, t): value for at, value in enumerate(sides, start=1)}
        return point, [second + self._mirrored(p, place, sides, rate)]

    @equals("Eq. (8) with the assumed neighbours")
    def forced(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Draw an arbitrary motion of site 0, with neighbours that move as in (9)."""
        p = drawn(self.model, rng)
        wave = wave_numbers(rng, p.unit)
        place, rate, second = (p.unit * rng.uniform(0.2, 1) for _ in range(3))
        when, w = rng.uniform(0.2, 1), rng.uniform(0.2, 1)
        step = cmath.exp(complex(wave[k_1], wave[k_2]))
        turned = wave[alpha_0] * cmath.exp(1j * w * when)
        sides = [(turned * step**at).imag for at in range(1, p.reach + 1)]
        point = {**p.values, **wave, y(0, t).diff(t, 2): second, y(0, t).diff(t): rate,
                 y(0, t): place, t: when, omega: w}  # fmt: skip
        return point, [second + self._mirrored(p, place, sides, rate)]

    # The residual of the central equation along a test motion, differentiated in ε.

    def _exact(self, motion: Callable[[Any, Any, Any], Any], e: Any, w: Any) -> Any:
        """Evaluate Eq. (11) along ``y = motion(p + w s, q + e s, e)``, differentiated along s."""
        numbers = numbers_of(self.model, self._fixed, e)
        p, q = _AT

        def path(s: Any) -> Any:
            return motion(p + w * s, q + e * s, e)

        place, rate, second = path(mp.mpf(0)), mp.diff(path, 0), mp.diff(path, 0, 2)
        sides = [self._wave[alpha_0] * mp.exp(at * _WAVE[k_1]) * mp.sin(p + at * _WAVE[k_2])
                 for at in range(1, numbers.reach + 1)]  # fmt: skip
        return second + self._mirrored(numbers, place, sides, rate)

    def _point(self, e: Any, w: Any) -> dict[Any, Any]:
        return {**self._fixed, **self._wave, epsilon: e, omega: w, omega_1: _W1, omega_2: _W2,
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
            point = {**self._point(0, w), **partials(self._first, own.Y, *_AT)}
            return self._compare(
                candidate, point,
                lambda e: self._exact(lambda p, q, _: self._first(p, q), e, w),
                "the centre along a test motion, differentiated numerically",
            )  # fmt: skip

    def two_times(self, candidate: sp.Basic) -> Evidence:
        """Compare with value and slope in ε at fixed ω; no terms of order ε² may be left."""
        with mp.workdps(40):
            w = 1 + _W1
            point = {**self._point(0, w), **partials(self._first, own.Y, *_AT)}
            low, slope = self._coefficients(lambda p, q, _: self._first(p, q), lambda _: w)
            return self._compare(candidate, point, lambda e: low + e * slope,
                                 "value and slope in ε of the centre along a test motion at fixed "
                                 "ω")  # fmt: skip

    def expanded(self, candidate: sp.Basic) -> Evidence:
        """Compare with value and slope in ε along the expanded frequency."""
        with mp.workdps(40):
            point = {**self._point(0, 1), **partials(self._first, own.Y, *_AT)}
            low, slope = self._coefficients(lambda p, q, _: self._first(p, q), _frequency)
            what = "value and slope in ε of the centre along a test motion"
            return self._compare(candidate, point, lambda e: low + e * slope, what)

    def _order_point(self) -> dict[Any, Any]:
        return {**self._point(0, 1), **partials(self._first, own.Y_0, *_AT),
                **partials(self._second, own.Y_1, *_AT)}  # fmt: skip

    def solution_put(self, candidate: sp.Basic) -> Evidence:
        """Compare value and slope in ε, with the ε of the expanded solution fixed at two values."""
        with mp.workdps(40):
            point = self._order_point()

            def expected(e: Any) -> Any:
                low, slope = self._coefficients(lambda p, q, _: self._expanded(p, q, e), _frequency)
                return low + e * slope

            what = "value and slope in ε of the centre along a test motion"
            return self._compare(candidate, point, expected, what)

    def order_zero(self, candidate: sp.Basic) -> Evidence:
        """Compare with the residual at ε = 0."""
        with mp.workdps(40):
            low, _ = self._coefficients(self._expanded, _frequency)
            return self._compare(candidate, self._order_point(), lambda _: low,
                                 "the centre along a test motion at ε = 0")  # fmt: skip

    def order_one(self, candidate: sp.Basic) -> Evidence:
        """Compare with the slope of the residual in ε."""
        with mp.workdps(40):
            _, slope = self._coefficients(self._expanded, _frequency)
            return self._compare(candidate, self._order_point(), lambda _: slope,
                                 "the slope in ε of the centre along a test motion")  # fmt: skip


def _frequency(e: Any) -> Any:
    return 1 + e * _W1 + e**2 * _W2
