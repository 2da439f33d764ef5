"""The branch of the closed-form breather that reads (37) at the neighbour, through its fold.

Its parameter is the square S of the central amplitude, as the distance from the stable cycle, so
that nothing cancels where the coupling is small or the two cycles nearly meet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from theory.arrays import FloatArray
from theory.chains.vdp import VanDerPolChain

_EPS = float(np.finfo(float).eps)


def discriminant(chain: VanDerPolChain) -> float:
    """Return a² - 8b, exact before it is rounded: it cancels where the two cycles meet."""
    _ = chain.stable_amplitude
    return float(Fraction(chain.a) ** 2 - 8 * Fraction(chain.b))


@dataclass(frozen=True)
class NeighbourBranch:
    """The branch of reading n = 1, by t = ln(x/x₀), x = S_s - S, x₀ = S_s - S_us.

    Then G = (b/16) x (x₀ - x) without cancellation, and with s = S w, the square of the neighbour,
    (37) is s (1 - a s/4 + b s²/8) = G (S - s). As S falls c rises, turns, and only then S turns:
    so S names every point up to the fold. (w does not: for η above 0.09 it turns before c.)
    """

    a: float
    b: float
    gap: float

    @property
    def first(self) -> float:
        """Where the search begins: G S is then a hundredth at most, and c far from its fold."""
        largest = (self.a + math.sqrt(self.gap)) / self.b
        return 0.01 / (1.0 + self.gap / (4.0 * self.b) * self.a * largest)

    def start_at(self, c: float) -> float:
        """Return t below the one of c: there G is far below c², while c ≈ √G at small c."""
        return 2.0 * math.log(c) - math.log1p(self.gap / (4.0 * self.b)) - 7.0

    def squares(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return S and s: the smallest s, by Newton from below."""
        G, S = self._gain_and_square(t)
        s = G * S / (1.0 + G)
        for _ in range(60):
            value = s * (1.0 - 0.25 * self.a * s + 0.125 * self.b * s * s) + G * (s - S)
            slope = 1.0 - 0.5 * self.a * s + 0.375 * self.b * s * s + G
            step = np.where(slope > 0.0, value / slope, 0.0)
            s = s - step
            if np.all(np.abs(step) <= _EPS * s):
                break
        return S, s

    def _gain_and_square(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        part = np.exp(t)
        G = 0.25 * self.gap / self.b * part * np.maximum(1.0 - part, 0.0)
        return G, (self.a + math.sqrt(self.gap) * (1.0 - 2.0 * part)) / self.b

    def coupling(self, t: FloatArray) -> FloatArray:
        """Return c = G/z = G √(S/s); zero where S has turned."""
        G, _ = self._gain_and_square(t)
        S, s = self.squares(t)
        slope = 1.0 - 0.5 * self.a * s + 0.375 * self.b * s * s + G
        ok = (slope > 0.0) & (s > 0.0) & (s < S)
        return np.where(ok, G * np.sqrt(S / np.where(ok, s, 1.0)), 0.0)

    def coupling_at(self, t: float) -> float:
        """Return c at one t."""
        return float(self.coupling(np.array([t]))[0])
