"""Fig. 7: a discrete breather with one excited site."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._breathers import EPS, flow
from paper_checks.claims._orbits import CENTRE, SITES, orbit_of
from paper_checks.ruling import fails, holds
from theory.arrays import FloatArray
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_panels, picture

C = 0.1
STRONGER = 0.19
SEEN = 0.01
"""Difference of amplitudes, relative to the largest, that is visible in the bars of the figure."""
AGREE = 1e-6


@dataclass(frozen=True, kw_only=True)
class Localised:
    """Amplitudes of the breather by site, from the orbit and from a run of (8)."""

    orbit: FloatArray
    run: FloatArray
    harmonics: FloatArray
    stable: bool
    frequency: float
    error: float
    stronger: tuple[float, float]
    """First ratio of neighbouring amplitudes and that of the tail, at a stronger coupling."""

    @property
    def gap(self) -> float:
        """Largest difference of the first harmonics between run and orbit."""
        return float(np.abs(self.run - self.harmonics).max())

    @property
    def ratios(self) -> tuple[float, ...]:
        """Ratios of neighbouring amplitudes, outwards from the centre."""
        tail = self.orbit[CENTRE:]
        return tuple(float(x) for x in tail[1:5] / tail[:4])

    @property
    def first_off(self) -> float:
        """Relative difference of the first ratio from that of the tail, 2c sinh k₁ = -1."""
        return abs(self.ratios[0] / math.exp(-math.asinh(0.5 / C)) - 1.0)

    @property
    def rate(self) -> float:
        """Rate of the exponential through the centre that best fits the other amplitudes."""
        place = np.arange(4)
        return float(np.polyfit(place, np.log(self.orbit[CENTRE : CENTRE + 4]), 1)[0])

    @property
    def off(self) -> float:
        """Largest distance of the amplitudes from one exponential, relative to the largest."""
        place = np.abs(np.arange(SITES) - CENTRE)
        return float(np.abs(self.orbit[CENTRE] * np.exp(self.rate * place) - self.orbit).max()
                     / self.orbit.max())  # fmt: skip


@lru_cache(maxsize=1)
def localised() -> Localised:
    """Prepare one site near the cycle, run (8) with scipy, and find the periodic orbit."""
    orbit, strong = orbit_of(C), orbit_of(STRONGER)
    assert orbit.frequency is not None
    assert orbit.error is not None
    state = np.zeros(2 * SITES)
    state[SITES + CENTRE] = 2.0 * math.sqrt(2.0)  # on the cycle of one averaged cell
    # Deviations decay at a rate of 0.45 per unit of εt, so that e^-18 is left.
    state = flow(state, C, 40.0 / EPS, 1e-10)
    history = []
    for _ in range(16):
        state = flow(state, C, orbit.period / 16, 1e-10)
        history.append(state[:SITES])
    spectrum = np.fft.rfft(np.array(history), axis=0) / len(history)
    return Localised(
        orbit=orbit.amplitudes,
        run=2.0 * np.abs(spectrum[1]),
        harmonics=np.abs(orbit.waves),
        stable=orbit.stable is True,
        frequency=orbit.frequency,
        error=orbit.error,
        stronger=(
            float(strong.amplitudes[CENTRE + 1] / strong.amplitudes[CENTRE]),
            math.exp(-math.asinh(0.5 / STRONGER)),
        ),
    )


def rule_localised(e: Localised) -> Ruling:
    """Rule: the run must settle on a stable orbit with the ends of the chain at rest."""
    if e.gap < AGREE and e.stable and e.orbit[0] < 1e-4 * e.orbit[CENTRE]:
        return holds()
    return fails("the run does not settle on a stable localised orbit.")


def rule_decay(e: Localised) -> Ruling:
    """Rule: a single exponential must reproduce every amplitude to within what the figure shows."""
    if e.gap < AGREE and e.rate < -1.0 and e.off < SEEN:
        return holds()
    return fails("the amplitudes are not those of one exponential.")


def draw(e: Localised) -> tuple[Picture, ...]:
    """Draw the breather, linear as in Fig. 7 and logarithmic."""
    figure, (left, right) = new_panels(2, width="page", height=2.4)
    place = np.arange(SITES) - CENTRE
    one = e.orbit[CENTRE] * np.exp(e.rate * np.abs(place))
    curves = Curves()
    orbit = curves.add("periodic orbit", n=place, amplitude=e.orbit)
    left.bar(*orbit, color=COLOURS["blue"], width=0.7)
    left.set(xlabel="site n", ylabel=r"amplitude of $y_n$", ylim=(0, 3.2))
    left.set(title=r"$c$ = 0.1, $a$ = 2.5, $b$ = 0.5, $\varepsilon$ = 0.01")
    right.semilogy(*orbit, "o", color=COLOURS["blue"], label="periodic orbit of (8)")
    right.semilogy(*curves.add("run of (8), scipy", n=place, amplitude=e.run), "x",
                   color=COLOURS["black"], label="run of (8), scipy")  # fmt: skip
    right.semilogy(*curves.add("one exponential, (9)", n=place, amplitude=one), "--", lw=0.9,
                   color=COLOURS["vermilion"],
                   label=rf"paper, (9): one rate, fitted $k_1 = {e.rate:.3f}$")  # fmt: skip
    right.set(xlabel="site n", ylabel=r"amplitude of $y_n$", ylim=(1e-6, 1e4))
    right.legend(loc="upper center")
    return (picture("fig07-breather", figure, long_table(curves)),)


CLAIMS = (
    Claim.beside("fig07-localised", evidence=localised, rule=rule_localised, figure=draw),
    Claim.beside("fig07-decay", evidence=localised, rule=rule_decay),
)
