"""Checks of (44)-(54): direct averages, the front built from its history, and computed roots."""

from __future__ import annotations

import cmath
import random
from collections.abc import Iterator
from functools import cached_property, partial
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp
from scipy.integrate import quad

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, Points, at_points, slope_of, value
from derivations.algebra.steps import Check, Evidence
from derivations.front import symbols as s
from derivations.front.numbers import evaluated, profile, roots
from derivations.front.sampling import (
    CYCLE,
    PLACES,
    Sample,
    SampledChecks,
    as_point,
    complex_number,
    front,
    sites,
)
from derivations.symbols import epsilon, n, t

_PHI_N = s.phi(n, t)


def _wave(z: Any) -> Any:
    return mp.tanh(1 - z) * mp.exp(0.4j * z) + 0.3 * mp.sin(z)


class ProfileChecks(SampledChecks):
    """The checks of (44)-(54)."""

    def _states(self) -> Iterator[tuple[Sample, dict[int, complex], complex, complex, bool]]:
        """Yield sites just below and just above the threshold 2, and far from it, at any phase."""
        rng = random.Random(7)
        for amplitude in (0.4, 1.999, 2.001, 3.0):
            for sample in self.samples:
                field = sites(self.model, rng, 2.0)
                field[0] = amplitude * cmath.exp(1j * rng.uniform(0, 6))
                yield sample, field, complex_number(rng), complex_number(rng, 4.0), amplitude > 2

    @at_points(
        "the direct average linearised at rest, and its translate, on both sides close to the "
        "threshold", tolerance=1e-7,
    )  # fmt: skip
    def two_lines(self) -> Points:
        """Linearise the direct average about rest and, beyond the threshold, about phi_s."""
        for sample, field, rate, cycle, excited in self._states():
            shift = cycle if excited else 0
            linear = sample.linear({place: value - shift for place, value in field.items()})
            point = as_point(sample.chain, field, rate)
            yield {**point, s.phi_s: cycle, s.phi_us: 2 * cmath.exp(1j)}, [rate - linear]

    @at_points("the two branches, taken one at a time, close to the threshold", tolerance=1e-7)
    def force(self) -> Points:
        """Compare with the force on a site: the response without springs."""
        for sample, field, rate, cycle, excited in self._states():
            deviation = field[0] - (cycle if excited else 0)
            uniform = dict.fromkeys(field, deviation)
            point = as_point(sample.chain, field, rate)
            yield {**point, s.phi_s: cycle, s.phi_us: 2 * cmath.exp(1j),
                   s.F: sample.linear(uniform)}, [0]  # fmt: skip

    @at_points("the direct average linearised at rest, and its translate", tolerance=1e-7)
    def located(self) -> Points:
        """Compare with the branch chosen by the sign of the coordinate."""
        for sample, field, rate, cycle, excited in self._states():
            shift = cycle if excited else 0
            linear = sample.linear({place: value - shift for place, value in field.items()})
            point = as_point(sample.chain, field, rate)
            yield {**point, s.phi_s: cycle, s.zeta: -0.01 if excited else 0.01}, [rate - linear]

    @at_points("a wave watched at fixed sites")
    def moving(self) -> Points:
        """Compare with a wave observed at fixed sites."""
        rng = random.Random(2)
        for _ in range(3):
            site, time, velocity = rng.randrange(-3, 4), rng.uniform(0, 2), rng.uniform(0.3, 1)
            zeta = site - velocity * time
            point: dict[Any, Any] = {n: site, t: time, s.speed: velocity, s.zeta: zeta}
            for offset in range(-self.model.reach, self.model.reach + 1):
                observed = complex(_wave(site + offset - velocity * time))
                point[s.phi(n + offset, t)] = observed
                point[s.phi(n - s.speed * t + offset)] = observed
                point[s.phi(s.zeta + offset)] = complex(_wave(zeta + offset))
            yield point, [0] * (2 * (2 * self.model.reach + 1))

    def admissible(self, candidate: sp.Basic) -> Evidence:
        """Compare both sides at several places of an existing front."""
        sample, velocity = front(self.model)
        for place in PLACES:
            modulus = abs(profile(sample.lattice, place, velocity))
            found = candidate.xreplace({_PHI_N: sp.Float(modulus), s.phi_us: sp.Float(sample.ratio),
                                        s.zeta: sp.Float(place)})  # fmt: skip
            if found != sp.true:
                return Evidence(False, f"not so at ζ = {place}: |φ/φₛ| = {modulus:.4f}")
        return Evidence(True, f"so at {len(PLACES)} places of a front with v̂ = {velocity:.6f}")

    @at_points("a distance over both times")
    def slow_velocity(self) -> Points:
        """Require the distance covered to be the same by both clocks."""
        eps, time, distance = 0.2, 3.0, 1.7
        point = {epsilon: eps, s.v: distance / (eps * time), s.speed: distance / time}
        yield point, [0]

    def profile_equation(self, velocity: sp.Symbol) -> Check:
        """Compare (44) for a travelling test wave, on the branch selected by the sign of zeta."""

        def points() -> Points:
            rng = random.Random(4)
            for zeta in (-0.7, 0.6, -0.02, 0.02):
                for sample in self.samples:
                    v_value, cycle, eps = rng.uniform(0.3, 1), complex_number(rng), sample.chain.eps
                    unit = 1 if velocity == s.speed else eps
                    rate = -unit * v_value * complex(mp.diff(_wave, zeta))
                    field = {q: complex(_wave(zeta + q))
                             for q in range(-self.model.reach, self.model.reach + 1)}  # fmt: skip
                    shift = cycle if zeta < 0 else 0
                    linear = sample.linear({q: value - shift for q, value in field.items()})
                    point: dict[Any, Any] = {
                        **sample.chain.values, velocity: v_value, s.phi_s: cycle, s.zeta: zeta,
                    }  # fmt: skip
                    point[s.phi(s.zeta).diff(s.zeta)] = complex(mp.diff(_wave, zeta))
                    point |= {s.phi(s.zeta + q): value for q, value in field.items()}
                    yield point, [(rate - linear) / unit]

        return at_points("(44) for a travelling test wave", tolerance=1e-7)(points)

    def transformed(self, candidate: sp.Basic) -> Evidence:
        """Transform both sides of (48) by quadrature, with a bell-shaped profile."""
        worst = 0.0
        for point, left, right in self._transforms:
            worst = max(worst, abs(value(candidate.lhs, point) - left),
                        abs(value(candidate.rhs, point) - right))  # fmt: skip
        return Evidence(worst < 1e-6, f"both sides of (48) transformed by quadrature: {worst:.1e}")

    @cached_property
    def _transforms(self) -> list[tuple[Point, complex, complex]]:
        """Return the image of the bell, and both sides of (48), at three wavenumbers."""
        found: list[tuple[Point, complex, complex]] = []
        for sample, velocity, wavenumber in self.waves():
            image = _integral(lambda z, q=wavenumber: _bell(z) * np.exp(-1j * q * z), -12, 12)
            left = _integral(
                lambda z, at=sample, f=velocity, q=wavenumber: (
                    _operated(at, f, z) * np.exp(-1j * q * z)
                ),
                -14,
                14,
            )
            step = _integral(
                lambda z, q=wavenumber: np.exp(-1j * q * z), -90 / wavenumber.imag**0.5, 0
            )
            point: dict[Any, Any] = {**sample.chain.values, s.v: velocity, s.k: wavenumber,
                                     s.phi_s: CYCLE, s.phi_hat(s.k): image}  # fmt: skip
            found.append((point, left, sample.lattice.decay * CYCLE * step))
        return found

    @at_points("(48) applied to e^(ikζ), numerically", tolerance=1e-8)
    def dispersion(self) -> Points:
        """Compare with (48) applied to a wave, computed from its values at the neighbours."""
        for sample, velocity, wavenumber in self.waves():
            exact = complex(sample.lattice.dispersion(wavenumber, velocity))
            yield {**sample.chain.values, s.v: velocity, s.k: wavenumber, s.L(s.k): exact}, [0]

    def _slopes(self, on_roots: bool) -> Points:
        for sample, velocity, wavenumber in self.waves():
            for k in (
                roots(sample.lattice, velocity)[::1999] if on_roots else (wavenumber, -wavenumber)
            ):
                slope = complex(
                    slope_of(partial(sample.lattice.dispersion, v=velocity), k, step=1e-4)
                )
                yield {**sample.chain.values, s.v: velocity, s.k: complex(k), s.L_k: slope}, [0]

    @at_points("numerical derivatives of L at any k", tolerance=1e-8)
    def slope(self) -> Points:
        """Compare with numerical derivatives of L at any k."""
        yield from self._slopes(False)

    @at_points("numerical derivatives of L at its roots", tolerance=1e-6)
    def slope_on_roots(self) -> Points:
        """Compare with numerical derivatives of L at its roots."""
        yield from self._slopes(True)

    def root_sets(self, candidate: sp.Basic) -> Evidence:
        """Require roots found by iteration to be members, and roots of the other half-plane not."""
        sample = self.samples[0]
        members = parts_of(candidate)
        if [member.lhs for member in members] != [s.M_plus, s.M_minus]:
            return Evidence(False, "the sets are not M+ and M-")
        for place, member in enumerate(members):
            conditions = member.rhs.condition.args
            relation = next(q for q in conditions if isinstance(q, sp.Equality))
            others = sp.And(*(q for q in conditions if q != relation))
            for nearby in (0.7 + 1e-9j, 0.7 - 1e-9j):  # the half-plane is bounded by the axis
                if bool(others.subs(s.k, sp.sympify(nearby))) != (
                    (nearby.imag > 0) == (place == 0)
                ):
                    return Evidence(False, f"wrong about numbers like {nearby}")
            for upper in (True, False):
                for root in roots(sample.lattice, 0.5, 60, upper)[::17]:
                    L_value = complex(sample.lattice.dispersion(root, 0.5))
                    difference = value(relation.lhs - relation.rhs, {s.L(s.k): L_value})
                    k = sp.sympify(complex(root))
                    inside = abs(difference) < 1e-8 and bool(others.subs(s.k, k))
                    if inside != (upper == (place == 0)):
                        return Evidence(False, f"wrong about the root {complex(root):.4f}")
        return Evidence(True, "roots of both half-planes are sorted correctly")

    def _image(self, sample: Sample, velocity: float, wavenumber: complex) -> complex:
        step = _integral(lambda z: np.exp(-1j * wavenumber * z), -90 / wavenumber.imag**0.5, 0)
        drive = sample.lattice.decay * CYCLE * step
        return complex(drive / sample.lattice.dispersion(wavenumber, velocity))

    @at_points("the transform of the step by quadrature", tolerance=1e-6)
    def image(self) -> Points:
        """Compare with the transform of the step by quadrature, divided by the numerical L."""
        for sample, velocity, wavenumber in self.waves():
            yield {**sample.chain.values, s.v: velocity, s.k: wavenumber, s.phi_s: CYCLE,
                   s.L(s.k): complex(sample.lattice.dispersion(wavenumber, velocity)),
                   s.phi_hat(s.k): self._image(sample, velocity, wavenumber)}, [0]  # fmt: skip

    def contour(self, candidate: sp.Basic) -> Evidence:
        """Integrate along a line above the axis, by the trapezoidal rule with a cut-off."""
        worst = 0.0
        for place, (sample, velocity, _) in zip((-0.6, 0.7, 1.4), self.waves(), strict=True):
            lattice = sample.lattice
            height = 0.5 * float(roots(lattice, velocity).imag.min())
            # With three points in the distance to 0 and to the first root, the error is of order
            # e^(-6π).
            count = int(2000.0 / min(0.02, height / 3.0)) + 1
            line = np.linspace(-1000.0, 1000.0, count) + 1j * height
            integral = candidate.rhs.atoms(sp.Integral).pop()
            if integral.limits != (sp.Tuple(s.k),):
                return Evidence(False, "it is not an integral over the wavenumber along a line")
            integrand = integral.function.xreplace({s.L(s.k): s.L_k, s.phi_s: _sympy(CYCLE)})
            integrand = integrand.subs({**sample.chain.values, s.v: velocity, s.zeta: place})
            terms = sp.lambdify((s.k, s.L_k), integrand, "numpy")(
                line, lattice.dispersion(line, velocity)
            )
            found = complex(np.trapezoid(terms, line))
            total = complex(value(candidate.rhs.xreplace({integral: _sympy(found)}), {}))
            worst = max(worst, abs(total - CYCLE * profile(lattice, place, velocity)))
            if candidate.lhs != s.phi(s.zeta):
                return Evidence(False, "it does not give the profile")
        # The tails beyond 1000 decrease like 1/k² and oscillate.
        return Evidence(worst < 1e-5, f"the front from its history: off by at most {worst:.1e}")

    def profile(self, candidate: sp.Basic) -> Evidence:
        """Compare with the front built from its history, at both signs of zeta."""
        left, right = candidate.args
        worst = 0.0
        cases = zip((-1.5, -0.4, 0.3, 1.5), (*self.waves(), next(self.waves())), strict=True)
        for place, (sample, velocity, _) in cases:
            point = {**sample.chain.values, s.v: velocity, s.phi_s: CYCLE, s.zeta: place}
            branch = right.xreplace({s.zeta: sp.Float(place)})
            found = evaluated(branch, point, sample.lattice, velocity)
            worst = max(worst, abs(found - CYCLE * profile(sample.lattice, place, velocity)))
        holds = worst < 1e-7 and left == s.phi(s.zeta)
        return Evidence(holds, f"the front from its history: off by at most {worst:.1e}")

    @at_points("a value at the front")
    def meeting(self) -> Points:
        """Compare with a value at the front."""
        yield {s.phi(0): 0.4 - 0.3j, s.phi_us: 0.4 - 0.3j}, [0]

    def relation_in_eta(self, candidate: sp.Basic) -> Evidence:
        """Compare with the modulus of (53) on the front, and with the two sampled cycles."""
        pieces = parts_of(candidate)
        if len(pieces) != 3:
            return Evidence(False, "three equations are expected")
        first = self.at_front(pieces[0])
        if not first.holds:
            return first
        second = self.on_cycles("cycles of the direct average", 2)(sp.Tuple(*pieces[1:]))
        return Evidence(second.holds, f"{first.statement}; {second.statement}")


def _sympy(number: complex) -> sp.Expr:
    return sp.Float(number.real, 17) + sp.I * sp.Float(number.imag, 17)


def _bell(z: Any) -> Any:
    return np.exp(-((z - 0.4) ** 2)) * (1 + 0.5j * z)


def _operated(sample: Sample, velocity: float, z: Any) -> Any:
    """Return the left side of (48) for the bell: derivative, decay and springs."""
    lattice = sample.lattice
    total = -velocity * slope_of(_bell, z, step=1e-4) + lattice.decay * _bell(z)
    for distance, spring in enumerate(lattice.springs, start=1):
        total = total - 0.5j * spring * (2 * _bell(z) - _bell(z + distance) - _bell(z - distance))
    return total


def _integral(function: Any, low: float, high: float) -> complex:
    return complex(quad(function, low, high, limit=400, complex_func=True)[0])
