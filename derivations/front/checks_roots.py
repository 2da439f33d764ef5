"""Checks of the location of the roots: L computed from its neighbours, and winding numbers."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from typing import Any

import sympy as sp

from derivations.algebra.evidence import Points, at_points, solved_for
from derivations.algebra.steps import Check, Evidence
from derivations.front import symbols as s
from derivations.front.numbers import count_between
from derivations.front.sampling import Sample, SampledChecks


class RootChecks(SampledChecks):
    """The checks of the proofs about roots."""

    def on_line(self, where: Callable[[dict[Any, Any]], Any]) -> Check:
        """Compare with L computed from its neighbours, at points of a line."""

        def points() -> Points:
            rng = random.Random(12)
            for sample, velocity, _ in self.waves():
                for _ in range(3):
                    point: dict[Any, Any] = {s.x: rng.uniform(-9, 9), s.turns: rng.randrange(-4, 5)}
                    point |= {s.y: rng.uniform(-2, 2), **sample.chain.values, s.v: velocity}
                    exact = complex(sample.lattice.dispersion(complex(where(point)), velocity))
                    yield {**point, s.half_real: exact.real, s.half_imag: exact.imag}, [0, 0]

        return at_points("L from its values at the neighbours")(points)

    def _turns(self) -> Iterator[tuple[Sample, float, complex, dict[Any, Any]]]:
        """Yield velocity and wavenumber at which the numerical slope of L vanishes."""
        for sample in self.samples:
            for m, height in ((0, 0.9), (1, -1.4), (-2, 0.3)):
                velocity = sample.lattice.springs[0] * math.cosh(height)
                wavenumber = complex(2 * math.pi * m - math.pi / 2, height)
                yield sample, velocity, wavenumber, {
                    **sample.chain.values, s.v: velocity, s.k: wavenumber, s.turns: m,
                    s.height: height,
                }  # fmt: skip

    def turning(self, candidate: sp.Basic) -> Evidence:
        """Compare with wavenumbers at which the numerical slope of L vanishes."""
        worst = max(
            abs(sample.lattice.slope(wavenumber, velocity))
            for sample, velocity, wavenumber, _ in self._turns()
        )
        points = [(point, [0]) for *_, point in self._turns()]
        what = "wavenumbers where the slope of L vanishes"
        found = at_points(what)(lambda: iter(points))(candidate)
        return Evidence(found.holds and worst < 1e-9, found.statement)

    @at_points("velocities at which the slope of L vanishes there")
    def turning_velocity(self) -> Points:
        """Compare with velocities at which the numerical slope of L vanishes."""
        for *_, point in self._turns():
            yield point, [0]

    @at_points("L where its slope vanishes")
    def at_turning(self) -> Points:
        """Compare with L at this point, computed from its values at the neighbours."""
        for sample, velocity, wavenumber, point in self._turns():
            exact = complex(sample.lattice.dispersion(wavenumber, velocity))
            yield {**point, s.half_real: exact.real, s.half_imag: exact.imag}, [0, 0]

    def no_double(self, candidate: sp.Basic) -> Evidence:
        """Require Im L to vanish on the line at the value of n found, which is no integer."""
        worst, nearest = 0.0, 1.0
        for sample, velocity, wavenumber, point in self._turns():
            m = solved_for(candidate, s.turns, point).real
            shifted = complex(2 * math.pi * m - math.pi / 2, wavenumber.imag)
            L_value = sample.lattice.dispersion(wavenumber, velocity) - 1j * velocity * (
                shifted - wavenumber
            )
            worst = max(worst, abs(L_value.imag))
            nearest = min(nearest, abs(m - round(m)))
        return Evidence(
            worst < 1e-9 and nearest > 0.05,
            f"Im L there: at most {worst:.1e}; {nearest:.3f} from any integer",
        )

    def number_in_strips(self, left: int) -> Check:
        """Compare with winding numbers around strips, two periods apart."""

        def check(candidate: sp.Basic) -> Evidence:
            expected = solved_for(candidate, s.root_count, {})
            for sample, velocity, _ in self.waves():
                for start in (left - 2, left, left + 2):
                    found = count_between(sample.lattice, velocity, start * math.pi,
                                          (start + 1) * math.pi, True)  # fmt: skip
                    if abs(found - expected) > 1e-12:
                        return Evidence(False, f"{found} roots in a strip from {start} pi")
            return Evidence(True, "winding numbers of three strips on three chains")

        return check
