"""Fig. 12: a front in the Van der Pol chain, at three times."""

from __future__ import annotations

from typing import Any

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.claims._fronts import EPS, A, B, arrivals_of_chain
from paper_checks.data_table import long_table
from paper_checks.pictures import NO_NUMBERS, new_panels, picture

C = 0.6
TIMES = (14000.0, 17000.0, 20000.0)
SITES = 160
"""The paper does not say how long its chain is; this one is longer than the front comes."""

_BEYOND = 500.0
"""Time run beyond the last of them, so that the front's place is known between two arrivals."""

_COMPARED = 8
_GAP = 1e-2
"""Arrival times by scipy at 1e-8 a step may be wrong by this; one passage takes some 140."""
_STEADY = 1e-3


def _steady() -> Finding:
    """Run the chain from one displaced site, and time the front at every site."""
    from theory.chains.vdp import VdpChain
    from verification.fronts.measure import measure_front
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain = VdpChain(a=A, b=B, c=C, eps=EPS, sites=SITES)
    start = excite(chain, [1])
    run = simulate(chain, start, TIMES[-1] + _BEYOND, samples=206, tolerance=1e-8)
    reached = np.flatnonzero(~np.isnan(run.arrivals))
    arrivals = run.arrivals[reached]
    places = np.interp(TIMES, arrivals, reached + 1.0)
    velocities = np.diff(places) / np.diff(TIMES) / EPS
    late = np.diff(arrivals[reached.size // 2 :])
    spread = float(np.ptp(late) / late.mean())
    in_order = bool(np.all(np.diff(arrivals) > 0.0) and np.all(np.diff(reached) == 1))
    measured = measure_front(chain)
    by_scipy = arrivals_of_chain(
        C, _COMPARED + 4, float(arrivals[_COMPARED]) + 50.0, run.level, chain.stable_amplitude
    )
    gap = float(np.max(np.abs(by_scipy[:_COMPARED] - arrivals[:_COMPARED])))
    if not gap < _GAP:
        raise ArithmeticError(f"arrival times differ by {gap:.1e} from those of scipy")
    steady = in_order and spread < 0.05 and abs(velocities[1] / velocities[0] - 1.0) < _STEADY
    figure, panels = new_panels(1, 3, width="column", height=5.6, sharex=True)
    site = np.arange(1, SITES + 1)
    series: dict[str, dict[str, Any]] = {}
    for axes, time in zip(panels, TIMES, strict=True):
        k = int(np.argmin(np.abs(run.times - time)))
        axes.plot(site, run.psi[k].imag, lw=0.7, label=r"$y_n$")
        axes.plot(site, run.amplitude[k], lw=1.0, label=r"$|\dot y_n + iy_n|$")
        axes.set(title=f"t = {time:g}", ylabel=r"$y_n$")
        series[f"t = {time:g}"] = {
            "t": time,
            "n": site,
            "y": run.psi[k].imag,
            "amplitude": run.amplitude[k],
        }
    panels[-1].set_xlabel("site n")
    panels[0].legend(loc="upper right")
    drawn = picture(
        "fig12-front",
        "The chain (8) at a = 4, b = 0.5, c = 0.6, ε = 0.01, free ends, started from the first "
        "site on its cycle: displacements and amplitudes at the three times of Fig. 12. "
        f"{NO_NUMBERS}",
        figure,
        long_table(series),
    )
    return Finding(
        verdict=Verdict.REPRODUCED if steady else Verdict.PARTIAL,
        value=(
            f"front at sites {places[0]:.1f}, {places[1]:.1f} and {places[2]:.1f}; "
            f"v̂ = {measured.v:.5f}"
        ),
        error=(
            f"v̂ uncertain by {measured.error:.1e}; between the three times it is "
            f"{velocities[0]:.5f} and {velocities[1]:.5f}; arrival times known to "
            f"{run.arrival_error:.0e} of {TIMES[-1]:g}"
        ),
        methods=(
            "(8) by a Runge-Kutta method of order 8 with an error estimate, sites at rest left out",
            f"scipy's DOP853 on the first {_COMPARED} arrivals: the same times to {gap:.1e}",
        ),
        tolerance=(
            f"steady if both velocities agree to {_STEADY:g} and the delays from site to site to "
            "0.05: the level is met at any phase of the ripple of O(ε) on the amplitude"
        ),
        explanation=(
            f"Every site is reached after the one before it, {late.mean():.2f} later on average; "
            f"the delays in the second half differ by {spread:.1e} of that. The paper names "
            f"neither its start nor the length of its chain; the front needs {places[-1]:.0f} "
            "sites by the last of its times."
        ),
        pictures=(drawn,),
    )


CLAIMS = (
    Claim(
        "fig12-steady",
        "Fig. 12, section 2.3.1",
        "Above the critical coupling a front runs steadily along the chain, site after site going "
        "over from rest to the stable cycle.",
        "at a = 4, b = 0.5, c = 0.6, ε = 0.01",
        Verdict.REPRODUCED,
        "fronts front vdp --a 4 --b 0.5 --c 0.6 --eps 0.01",
        _steady,
    ),
)
