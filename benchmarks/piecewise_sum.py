"""Σ(v, c) of Eq. (53), by each of our methods, as contenders with independent references."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import mpmath as mp
import numpy as np

from benchmarks.piecewise_peers import peers
from benchmarks.runner import Answer, Contender, distance
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral, sums
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.result import KineticSum
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities.scenes import Scene

QUANTITY = "sum"
REFERENCE_DIGITS = 60
BATCH = 4096


@dataclass(frozen=True)
class References:
    """Σ to 60 digits from the series over the roots, and from the periodised integral."""

    series: Any
    integral: Any

    @property
    def apart(self) -> float:
        """How far they are apart."""
        return distance(self.series, self.integral)


def references(v: float, c: float) -> References:
    """Return both references; the two computations have no code in common but complex numbers."""
    return References(
        sum_by_roots(v, c, REFERENCE_DIGITS).value,
        precise_sum_by_integral(v, c, REFERENCE_DIGITS).value,
    )


def contenders(scene: Scene, known: References) -> tuple[Contender, ...]:
    """Return all methods and knobs at a scene, ours and the peers'.

    Methods built on the integral over k are held against the series, and the other way round.
    """
    v, c = scene.v, scene.c
    return (*_integrals(v, c, known), *_series(v, c, known), *peers(v, c, known.integral))


def _integrals(v: float, c: float, known: References) -> Iterator[Contender]:
    true = known.series
    for tolerance in (1e-2, 1e-4, 1e-8, 1e-12, 1e-15):
        yield Contender(
            "integral, in a batch",
            f"tolerance {tolerance:g}",
            partial(_batch, v, c, tolerance),
            true,
            BATCH,
            quick=1e-14 < tolerance < 1e-6,
        )
        yield Contender(
            "integral, one call",
            f"tolerance {tolerance:g}",
            _ours(sum_by_integral, v, c, tolerance),
            true,
        )
    for digits in (15, 30, 50):
        yield Contender(
            "integral, many digits",
            f"{digits} digits",
            _ours(precise_sum_by_integral, v, c, digits),
            true,
            quick=digits < 50,
        )
    for tolerance in (1e-4, 1e-8, 1e-12):
        yield Contender(
            "quadrature in pieces",
            f"tolerance {tolerance:g}",
            _ours(sum_by_quadrature, v, c, tolerance),
            true,
            quick=tolerance > 1e-9,
        )


def _series(v: float, c: float, known: References) -> Iterator[Contender]:
    true = known.integral
    for digits in (5, 10, 15, 30, 50):
        knob = f"{digits} digits"
        yield Contender("root series", knob, _ours(sum_by_roots, v, c, digits), true)
    for roots in (100, 2_000, 50_000):
        yield Contender(
            "root series, cut off",
            f"{roots} roots",
            partial(_cut_off, v, c, roots),
            true,
            quick=roots < 50_000,
        )
    for tolerance in (1e-4, 1e-8, 1e-12):
        yield Contender(
            "Bessel series",
            f"tolerance {tolerance:g}",
            _ours(sum_by_bessel, v, c, tolerance),
            true,
            quick=c < 10.0,
        )


def _ours(
    method: Callable[..., KineticSum], v: float, c: float, knob: float
) -> Callable[[], Answer]:
    def evaluate() -> Answer:
        result = method(v, c, knob)
        return Answer(result.value, result.error)

    return evaluate


def _batch(v: float, c: float, tolerance: float) -> Answer:
    """Return Σ(v, c), the first of a batch whose velocities go up by one per cent."""
    many = sums(v * np.geomspace(1.0, 1.01, BATCH), c, tolerance)
    return Answer(complex(many.value[0]), float(many.error[0]))


def first_batch(v: float, c: float) -> Answer:
    """Return Σ(v, c), the first of a batch, as it is called by default."""
    return _batch(v, c, 1e-12)


def _cut_off(v: float, c: float, count: int) -> Answer:
    """Return the printed series as it stands, over ``count`` roots about the origin; no bound."""
    labels = np.arange(count) - count // 2
    k = labelled_roots(v, c, labels, upper=True).k
    return Answer(complex(np.sum(1.0 / (-1j * k * (v + c * np.sin(k))))), None)


def exact_sum(v: float, c: float) -> mp.mpc:
    """Return Σ to 30 digits from the roots, to hold the fast integral against."""
    return sum_by_roots(v, c, 30).value
