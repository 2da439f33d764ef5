"""The branch of the closed-form breather with (37) at the neighbour of the centre, up to its fold.

Its parameter is the squared central amplitude S, expressed by its distance from that of the stable
cycle, so that nothing cancels where the coupling is small or the two cycles nearly meet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from theory.arrays import EPS, FloatArray
from theory.chains.vdp import VanDerPolChain


def discriminant(chain: VanDerPolChain) -> float:
    """Return a² - 8b, computed exactly and then rounded, since it cancels where the cycles meet."""
    _ = chain.stable_amplitude
    return float(Fraction(chain.a) ** 2 - 8 * Fraction(chain.b))


@dataclass(frozen=True)
class NeighbourBranch:
    """The branch for n = 1, parametrised by t = ln(x/x₀), x = S_s - S, x₀ = S_s - S_us.

    Then G = (b/16) x (x₀ - x) without cancellation and, with s = S w, the squared amplitude of the
    neighbour, (37) is s (1 - a s/4 + b s²/8) = G (S - s). As S decreases, c rises and turns, and
    only then S turns, so that S identifies every point up to the fold. (w does not: for η above
    0.09 it turns before c.)
    """

    a: float
    b: float
    gap: float

    @property
    def first(self) -> float:
        """x/x₀ at which the search begins; G S is at most 0.01 there, and c far from the fold."""
        largest = (self.a + math.sqrt(self.gap)) / self.b
        return 0.01 / (1.0 + self.gap / (4.0 * self.b) * self.a * largest)

    def start_at(self, c: float) -> float:
        """Return a t below the one at c; there G is far below c², while c ≈ √G at small c."""
        return 2.0 * math.log(c) - math.log1p(self.gap / (4.0 * self.b)) - 7.0

    def squares(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return S and the smallest s, by Newton's method from below."""
        G, S = self._gain_and_square(t)
        s = G * S / (1.0 + G)
        for _ in range(60):
            value = s * (1.0 - 0.25 * self.a * s + 0.125 * self.b * s * s) + G * (s - S)
            slope = 1.0 - 0.5 * self.a * s + 0.375 * self.b * s * s + G
            step = np.where(slope > 0.0, value / slope, 0.0)
            s = s - step
            if np.all(np.abs(step) <= EPS * s):
                break
        return S, s

    def _gain_and_square(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        fraction = np.exp(t)
        G = 0.25 * self.gap / self.b * fraction * np.maximum(1.0 - fraction, 0.0)
        return G, (self.a + math.sqrt(self.gap) * (1.0 - 2.0 * fraction)) / self.b

    def coupling(self, t: FloatArray) -> FloatArray:
        """Return c = G/z = G √(S/s), or zero beyond the turning point of S."""
        G, _ = self._gain_and_square(t)
        S, s = self.squares(t)
        slope = 1.0 - 0.5 * self.a * s + 0.375 * self.b * s * s + G
        ok = (slope > 0.0) & (s > 0.0) & (s < S)
        return np.where(ok, G * np.sqrt(S / np.where(ok, s, 1.0)), 0.0)

    def coupling_at(self, t: float) -> float:
        """Return c at a single t."""
        return float(self.coupling(np.array([t]))[0])
