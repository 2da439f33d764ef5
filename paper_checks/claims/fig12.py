"""Fig. 12: a front in the Van der Pol chain, at three times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._fronts import EPS, A, B
from paper_checks.claims._required import required
from paper_checks.ruling import fails, holds
from theory.arrays import FloatArray
from verification.pictures.data_table import long_table
from verification.pictures.figures import new_panels, picture

C = 0.6
TIMES = (14000.0, 17000.0, 20000.0)
SITES = 160
"""The paper does not state the length of its chain; this one is longer than the front's path."""
BEYOND = 500.0
"""Time run beyond the last of these times, so that the front's position lies between two
arrivals."""
COMPARED = 8
AGREE = 1e-2
"""Largest error of arrival times by scipy at 1e-8 per step; one passage takes about 140."""
STEADY, DELAY = 1e-3, 0.05
"""Tolerances of the velocity, and of the delays from site to site, which vary because the amplitude
has a ripple of O(ε) and passes the level at any phase of it."""


@dataclass(frozen=True, kw_only=True)
class Steady:
    """The front of Fig. 12 at its three times."""

    places: tuple[float, ...]
    delay: float
    """Mean delay from one site to the next, in the second half."""
    spread: float
    """Spread of the delays relative to their mean."""
    in_order: bool
    arrival_error: float
    gap: float
    shapes: tuple[FloatArray, ...]
    amplitudes: tuple[FloatArray, ...]

    @property
    def velocities(self) -> tuple[float, float]:
        """v̂ from the first to the second and to the third time."""
        v = np.diff(self.places) / np.diff(TIMES) / EPS
        return float(v[0]), float(v[1])


def steady() -> Steady:
    """Run the chain from one displaced site, and record the arrival of the front at every site."""
    from theory.chains.vdp import VdpChain
    from verification.references.passages import arrivals_of_chain
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain = VdpChain(a=A, b=B, c=C, eps=EPS, sites=SITES)
    run = simulate(chain, excite(chain, [1]), TIMES[-1] + BEYOND, samples=206, tolerance=1e-8)
    reached = np.flatnonzero(~np.isnan(run.arrivals))
    arrivals = run.arrivals[reached]
    late = np.diff(arrivals[reached.size // 2 :])
    by_scipy = arrivals_of_chain(
        chain.replace(sites=COMPARED + 4),
        float(arrivals[COMPARED]) + 50.0,
        run.level,
        chain.stable_amplitude,
    )
    at = [int(np.argmin(np.abs(run.times - time))) for time in TIMES]
    return Steady(
        places=tuple(float(x) for x in np.interp(TIMES, arrivals, reached + 1.0)),
        delay=float(late.mean()),
        spread=float(np.ptp(late) / late.mean()),
        in_order=bool(np.all(np.diff(arrivals) > 0.0) and np.all(np.diff(reached) == 1)),
        arrival_error=required(run.arrival_error, "error of the arrivals"),
        gap=float(np.max(np.abs(by_scipy[:COMPARED] - arrivals[:COMPARED]))),
        shapes=tuple(run.psi[k].imag for k in at),
        amplitudes=tuple(run.amplitude[k] for k in at),
    )


def rule_steady(e: Steady) -> Ruling:
    """Rule: site after site must join, at a single velocity between the three times."""
    even = abs(e.velocities[1] / e.velocities[0] - 1.0) < STEADY and e.spread < DELAY
    if e.in_order and even and e.gap < AGREE:
        return holds()
    return fails("the front does not move from site to site at one velocity.")


def draw(e: Steady) -> tuple[Picture, ...]:
    """Draw the chain at the three times of Fig. 12."""
    figure, panels = new_panels(1, 3, width="column", height=4.6, sharex=True)
    site = np.arange(1, SITES + 1)
    series: dict[str, dict[str, Any]] = {}
    for axes, time, y, size in zip(panels, TIMES, e.shapes, e.amplitudes, strict=True):
        axes.plot(site, y, lw=0.7, label=r"$y_n$")
        axes.plot(site, size, lw=1.0, label=r"$|\dot y_n + iy_n|$")
        axes.set(title=f"t = {time:g}", ylabel=r"$y_n$")
        series[f"t = {time:g}"] = {"t": time, "n": site, "y": y, "amplitude": size}
    panels[-1].set_xlabel("site n")
    panels[0].set_title(r"t = 14000; $a$ = 4, $b$ = 0.5, $c$ = 0.6, $\varepsilon$ = 0.01")
    panels[0].legend(loc="upper right")
    return (picture("fig12-front", figure, long_table(series)),)


CLAIMS = (Claim.beside("fig12-steady", evidence=steady, rule=rule_steady, figure=draw),)
