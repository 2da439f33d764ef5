"""Work reduction in runs: of the piecewise-linear chain (44), of (8) and of (43)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from theory.arrays import BoolArray, ComplexArray, FloatArray
from theory.cells.vdp import threshold_ratio
from theory.chains.vdp import VanDerPolChain, VdpChain
from verification.piecewise.chain import PiecewiseMotion, Rest
from verification.piecewise.simulation import simulate_front
from verification.piecewise.window import (
    ChainState,
    starting_velocity,
    travelling_state,
    widened,
    window_length,
)
from verification.references.equations import piecewise_rate
from verification.runs.comparison import difference
from verification.runs.excite import excite, excite_edge
from verification.runs.simulate import simulate
from verification.work_reduction.comparison import Comparison, timed


def _moving(c: float, r: float) -> ChainState:
    """Return a moving start in the window that the code chooses."""
    v = starting_velocity(c, r)
    return travelling_state(c, v, window_length(c, v, 1e-15 * r))


def sites_of_the_window(c: float = 0.5, eta: float = 0.03125) -> Comparison:
    """Follow a front in its window, and in one that contains every site it passes.

    The cost is the smallest number of such sites; the run itself has twice as many, so that none is
    cut off.
    """
    short = simulate_front(c, eta)
    passed = short.window + short.crossing_times.size
    long = simulate_front(c, eta, widened(_moving(c, threshold_ratio(eta)), 2 * passed))
    if short.v is None or long.v is None or short.error is None or long.error is None:
        return Comparison(short.window, passed, np.inf, 0.0)
    return Comparison(short.window, passed, abs(short.v - long.v), short.error + long.error)


class CountedSearch(PiecewiseMotion):
    """A chain whose searches for a crossing are counted; with ``every``, none is left out."""

    every: bool
    sought = 0

    def _suspects(
        self,
        gap: FloatArray,
        least: float,
        parts: ComplexArray,
        phi: ComplexArray,
        step: float,
    ) -> BoolArray:
        found = super()._suspects(gap, least, parts, phi, step)
        return np.ones_like(found) if self.every else found

    def _first_crossing(
        self, modes: ComplexArray, now: complex, slot: int, step: float, fresh: bool
    ) -> float | None:
        self.sought += 1
        return super()._first_crossing(modes, now, slot, step, fresh)


def crossings_sought(c: float = 0.5, eta: float = 0.03125, count: int = 6) -> Comparison:
    """Search for a crossing where a bound on the second derivative permits one, or everywhere."""
    r = threshold_ratio(eta)
    found, sought = [], []
    for every in (False, True):
        chain = CountedSearch(c, r, _moving(c, r))
        chain.every = every
        found.append(_switchings(chain, count))
        sought.append(float(chain.sought))
    return Comparison(sought[0], sought[1], _apart(found[0], found[1]), 0.0)


def _switchings(chain: PiecewiseMotion, count: int) -> FloatArray:
    """Return (time, site, direction, jitter) of the next switchings, shape (count, 4)."""
    rows: list[tuple[float, int, int, float]] = []
    time = 0.0
    for _ in range(count):
        step = chain.advance(1e3)
        if isinstance(step, Rest):
            break
        time += step.wait
        rows.append((time, step.site, step.direction, step.jitter))
    return np.array(rows).reshape(-1, 4)


def _apart(one: FloatArray, other: FloatArray) -> float:
    """Return the largest difference in time; inf if sites or directions differ."""
    if one.shape != other.shape or np.any(one[:, 1:3] != other[:, 1:3]):
        return float("inf")
    return float(np.max(np.abs(one[:, 0] - other[:, 0])))


def steps_between_crossings(c: float = 0.5, eta: float = 0.03125, count: int = 6) -> Comparison:
    """Propagate exactly from crossing to crossing, or by Runge-Kutta steps; times in ms."""
    r = threshold_ratio(eta)
    start = _moving(c, r)
    exact, spent = timed(lambda: _switchings(PiecewiseMotion(c, r, start), count))
    stepped, whole = timed(lambda: _stepped_switchings(c, r, start, count, 1e-13), 1)
    looser = _stepped_switchings(c, r, start, count, 1e-11)
    own = float(exact[:, 3].sum())
    return Comparison(
        1e3 * spent, 1e3 * whole, _apart(exact, stepped), own + _apart(stepped, looser)
    )


def _stepped_switchings(
    c: float, r: float, start: ChainState, count: int, tolerance: float
) -> FloatArray:
    """Return the switchings by DOP853 on the same twisted ring, restarted after each of them."""
    phi, on = start.phi, np.abs(start.phi) > r
    rows: list[tuple[float, int, int, float]] = []
    time, latest = 0.0, None
    slots = np.arange(phi.size)

    class Least:
        """The smallest gap of any site but the latest; its zero ends an integration."""

        terminal, direction = True, -1.0

        def __call__(self, _: float, y: ComplexArray) -> float:
            gap = np.where(on, 1.0, -1.0) * (np.abs(y) - r)
            return float(np.min(gap[slots != latest]))

    while len(rows) < count:
        end = time + (1e3 if latest is None else 0.05)
        found = solve_ivp(
            piecewise_rate(c, on, 1.0, -1.0, ring=True), (time, end), phi, method="DOP853",
            rtol=tolerance, atol=tolerance, events=Least(),
        )  # fmt: skip
        time, phi = float(found.t[-1]), found.y[:, -1]
        if found.status != 1:
            latest = None
            continue
        gap = np.abs(np.abs(phi) - r)
        latest = int(np.argmin(np.where(slots == latest, np.inf, gap)))
        on[latest] = not on[latest]
        rows.append((time, start.origin + latest, 1 if on[latest] else -1, 0.0))
    return np.array(rows)


CHAIN = VdpChain(a=4, b=0.5, c=0.6, sites=60)


def sites_at_rest(
    chain: VanDerPolChain = CHAIN, end: float = 600.0, tolerance: float = 1e-9
) -> Comparison:
    """Step only the moving sites, or all of them."""
    start = excite(chain, [1])
    few, whole = (
        simulate(
            chain, start, end, tolerance=tolerance, samples=5, active_window=window,
            estimate_error=False)
        for window in (True, False)
    )  # fmt: skip
    changed = float(np.abs(few.psi - whole.psi).max())
    bound = 0.1 * tolerance * float(np.abs(start).max())
    return Comparison(few.mean_active, whole.mean_active, changed, bound)


def sites_behind(c: float = 0.6, end: float = 3e4, tolerance: float = 1e-9) -> Comparison:
    """Step 24 sites behind a front, or all that it has passed."""
    chain = VdpChain(a=4, b=0.5, c=c, sites=300)
    few, whole = (
        simulate(
            chain.averaged(), excite_edge(chain, 24), end, samples=2,
            tolerance=tolerance, trailing_sites=behind)
        for behind in (24, 0)
    )  # fmt: skip
    return Comparison(
        few.mean_active,
        whole.mean_active,
        difference(few.arrivals, whole.arrivals),
        few.arrival_error or 0.0,
    )
