"""The front far from ζ = 0, as the sum (49): a few slowly varying terms, and a bound on the others.

At strong coupling the slow terms vary over about √c sites, and the sum of the moduli of all others
falls with |ζ|. Where this sum is smaller than the distance of the slow terms from the threshold,
(47) is proven.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from theory.arrays import ComplexArray, FloatArray, IntArray
from theory.piecewise.roots import labelled_roots

NEAR = 2.0
"""Distance in sites from ζ = 0 from which the sum is used."""
MAX_CELLS = 20_000
"""Largest number of intervals that are examined on one side."""
_SLOW = 24
"""Number of terms that are followed; the others are bounded."""
_INTERPOLATION_MARGIN = 0.02
"""Relative amount by which a term or a rate may exceed those at both ends of a block of labels."""
_MIN_LENGTH = 0.125
"""Length in sites below which an interval is not divided further."""


@dataclass(frozen=True)
class ProvenRange:
    """Result of the bound on all but a few terms, on one side at distances beyond ``NEAR``.

    Attributes
    ----------
    fails_at : float or None
        Smallest distance at which (47) was found to fail.
    thin : ndarray of float, shape (2, n)
        Ends of the intervals at smaller distances in which the margin is within the bound.
    """

    fails_at: float | None
    thin: FloatArray


@dataclass(frozen=True)
class FarField:
    """φ/φ_s on one side of ζ = 0: limit + Σ_j terms_j e^{rates_j a} + others, a = |ζ|.

    Attributes
    ----------
    limit : float
        0 ahead, 1 behind.
    terms, rates : ndarray of complex, shape (``_SLOW``,)
        The terms that are largest at a = ``NEAR``; Re rates < 0.
    size, decay : ndarray of float, shape (n,)
        The sum of the other terms is at most Σ_j size_j e^{decay_j a}; decay < 0.
    tail : float
        Bound on the sum of the moduli of all omitted terms, at a = 0.
    """

    limit: float
    terms: ComplexArray
    rates: ComplexArray
    size: FloatArray
    decay: FloatArray
    tail: float

    @classmethod
    def make(cls, speed: float, c: float, upper: bool, limit: float) -> FarField:
        """Return the far field, from the roots of one half-plane with labels up to c/v.

        Where v|k| > 6c, |cos k| ≥ 5 and |L_k| ≥ v|k|/2, so that a term is below 1/(v k²) and falls
        with a faster than 9^{-a}. Roots are computed for a sample of labels. Between two of these,
        terms and rates are assumed to lie between those at both, to within a fraction
        ``_INTERPOLATION_MARGIN``.
        """
        last = max(_SLOW, math.ceil(c / speed))
        labels = _sampled_labels(last, c / (math.pi * speed))
        k = labelled_roots(speed, c, labels, upper).k
        terms = (0.5j if limit == 1.0 else -0.5j) / (k * (speed + c * np.sin(k)))
        rates = 1j * k if upper else -1j * k
        size, decay = np.abs(terms), rates.real
        between = (
            (np.diff(labels) - 1.0)
            * (1.0 + _INTERPOLATION_MARGIN)
            * np.maximum(size[1:], size[:-1])
        )
        slowest = (1.0 - _INTERPOLATION_MARGIN) * np.maximum(decay[1:], decay[:-1])
        slow, others = np.split(np.argsort(-size * np.exp(NEAR * decay)), [_SLOW])
        tail = 1.0 / (math.pi**2 * speed * (last - 0.5))
        return cls(
            limit,
            terms[slow],
            rates[slow],
            np.append(size[others], between),
            np.append(decay[others], slowest),
            tail,
        )

    def reach(self, r: float) -> tuple[float, float]:
        """Return how far to check, and the distance beyond which the sum of moduli proves (47)."""
        gap = r if self.limit == 0.0 else 1.0 - r
        size = np.append(np.abs(self.terms), self.size)
        decay = np.append(self.rates.real, self.decay)
        distance = NEAR
        tail = self.tail * 9.0**-NEAR
        level = max(gap - tail, tail)  # if the tail proves nothing, the rest is checked
        while float(size @ np.exp(decay * distance)) >= level:
            distance *= 1.5
        return distance, distance if tail < 0.5 * gap else math.inf

    def proven(self, r: float) -> ProvenRange:
        """Follow the slow terms outwards; their slopes and the moduli of the others bound |φ|."""
        outermost, no_interval = self.reach(r)[0], np.empty((2, 0))
        if outermost == NEAR:
            return ProvenRange(None, no_interval)
        knots = np.geomspace(NEAR, outermost, 64)
        remainder = np.exp(np.outer(knots, self.decay)) @ self.size
        remainder += self.tail * 9.0**-NEAR
        terms, rates = self.terms, self.rates
        slope_bounds = np.abs(terms * rates)
        a, b = knots[:-1], knots[1:]
        nearest, thin = math.inf, [no_interval]
        while a.size:
            middle, width = 0.5 * (a + b), b - a
            modulus = np.abs(self.limit + np.exp(np.outer(middle, rates)) @ terms)
            margin = modulus - r if self.limit else r - modulus
            others = remainder[np.searchsorted(knots, a, side="right") - 1]  # decreases with a
            slope = np.exp(np.outer(a, rates.real)) @ slope_bounds
            failed = margin + others < 0.0
            if failed.any():
                nearest = min(nearest, float(middle[failed].min()))
            open_ = (margin <= 0.5 * slope * width + others) & (a < nearest)
            short = width < _MIN_LENGTH
            thin.append(np.stack([a, b])[:, open_ & short & ~failed])
            open_ &= ~short
            a, middle, b = a[open_], middle[open_], b[open_]
            a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
            if a.size > MAX_CELLS:
                thin.append(np.stack([a, b]))
                break
        intervals = np.concatenate(thin, axis=1)
        intervals = intervals[:, intervals[0] < nearest]
        return ProvenRange(nearest if nearest < math.inf else None, intervals)


def _sampled_labels(last: int, resonance: float) -> IntArray:
    """Return labels from -last to last: all of them near 0 and ± resonance, and fewer farther away.

    Away from these three labels, roots, terms and rates vary with the label on a scale comparable
    to the distance from the nearest of them. The largest term is at -c/πv, where the linear wave
    with k = π travels with the front.
    """
    offsets = np.arange(2.0 * _SLOW)
    if last > offsets[-1]:
        steps = math.ceil(math.log(last / offsets[-1]) / math.log1p(1.0 / _SLOW))
        offsets = np.append(offsets, np.ceil(np.geomspace(offsets[-1], last, steps + 1)[1:]))
    centres = np.array([[0.0], [round(resonance)]])
    labels = np.concatenate([centres - offsets, centres + offsets]).astype(np.int64)
    symmetric: IntArray = np.union1d(labels, -labels)
    return symmetric[np.abs(symmetric) <= last]
