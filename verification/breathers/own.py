"""Periodic orbits of any chain or network of oscillators: motion, steps, starting points.

The chain is first run until the nucleus has settled, so that the orbit found is near a stable
breather. The variational equations are integrated along with the motion by DOP853 at equal steps,
for all sites at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import DOP853

from theory.arrays import FloatArray
from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.parameters import ParameterError, RunError
from verification.breathers.family import ReportCallback, silent
from verification.breathers.orbits import STARTS, Orbits
from verification.breathers.result import Breather
from verification.continuation.newton import BranchPoint, NotConvergedError, solve_at
from verification.runs.excite import excite
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers.variational import Flow

STEPS = 64
"""Steps per period where damping is weak."""
MAX_SITES = 101
SETTLED = 40.0
"""Time in units of ``time_unit`` after which the nucleus has either settled or disappeared."""
_LAST = 6
"""Periods of a cell, as ε → 0, at the end of this time in which the nucleus is sampled."""


@dataclass(frozen=True)
class OwnOrbits(Orbits):
    """The periodic orbits of any chain or network of oscillators, started from settled runs."""

    symmetric_chain = False  # sites may differ
    chain: OscillatorChain

    def __post_init__(self) -> None:
        check_orbits(self.chain)

    @property
    def count(self) -> int:
        """Steps per period: more where ε max|h| on the cycle is larger."""
        if self.steps:
            return self.steps
        chain = self.chain
        (cycle,) = [each for each in chain.cell.cycles if each.amplitude == chain.stable_amplitude]
        angle = np.linspace(0.0, 2.0 * math.pi, 200)
        y, v = cycle.amplitude * np.sin(angle), cycle.velocity * np.cos(angle)
        h = chain.cell.damping_at(y, v)
        return math.ceil(STEPS * (1.0 + chain.eps * float(np.max(np.abs(h)))))

    @property
    def unit(self) -> float:
        """The power of ten below the stable amplitude: unknowns are then of order one."""
        return float(10.0 ** math.floor(math.log10(self.chain.stable_amplitude)))

    def flow(self, c: float, start: FloatArray, duration: float, steps: int) -> Flow:
        """Return the motion with its variations, by DOP853, in units of the amplitude."""
        chain, unit = self.chain.replace(c=c), self.unit
        found = integrate_with_tangents(chain, unit * start, duration, steps)
        state, by_c, samples = (each / unit for each in (found.state, found.by_c, found.samples))
        return replace(found, state=state, by_c=by_c, samples=samples)

    def rate(self, c: float, state: FloatArray) -> FloatArray:
        """Return the right-hand side of the chain as a first-order system, in these units."""
        columns = self.unit * state[:, None].repeat(2, axis=1)
        return _rate_of(self.chain.replace(c=c))(columns)[:, 0] / self.unit

    def start(
        self, c_end: float, lowest: float = math.inf, report: ReportCallback = silent
    ) -> BranchPoint:
        """Return the orbit on which a nucleus settles at small c."""
        system = self.system()
        for c in STARTS:
            with suppress(NotConvergedError, ParameterError):
                chain_at_c = self.chain.replace(c=c)
                return solve_at(system, self._settled(chain_at_c, report), c)
        raise ParameterError(
            "pattern",
            repr(self.nucleus.pattern),
            "one that is stable at small couplings",
            "take another",
        )

    def directly(self) -> BranchPoint:
        """Return the orbit on which the nucleus settles.

        Raises
        ------
        ParameterError
            If the nucleus does not stay localised.
        """
        return solve_at(self.system(), self._settled(self.chain), self.chain.c)

    def _settled(self, chain: OscillatorChain, report: ReportCallback = silent) -> FloatArray:
        start = _settled_start(chain, self.nucleus, report)
        return np.append(start[:-1] / self.unit, start[-1])

    def solve(self) -> Breather:
        """Solve for the breather, under the name of the pattern on which the nucleus settles."""
        found = super().solve()
        if not self.chain.along_line:
            return found
        settled = self.nucleus.found_in(found.waves, self.chain.unstable_amplitude)
        if settled is None or settled.size != self.nucleus.size:
            return found
        return replace(found, nucleus=settled)


def integrate_with_tangents(
    chain: OscillatorChain, start: FloatArray, duration: float, steps: int
) -> Flow:
    """Integrate a chain and its variational equations.

    Parameters
    ----------
    chain : OscillatorChain
        A chain with inertia.
    start : float array, shape (2N,)
        Displacements, then velocities.
    duration : float
        Time t.
    steps : int
        Number of equal steps of DOP853.

    Returns
    -------
    Flow
        State, monodromy matrix, derivative with respect to c, and displacements before each step.

    Raises
    ------
    ParameterError
        If the motion overflows.
    """
    count, h = chain.sites, duration / steps
    columns = np.zeros((2 * count, 2 * count + 2))
    columns[:, 0] = start
    columns[:, 1:-1] = np.eye(2 * count)
    samples = np.zeros((steps, count))
    stages = np.zeros((DOP853.n_stages, *columns.shape))
    flat = stages.reshape(DOP853.n_stages, -1)
    rate = _rate_of(chain)
    with np.errstate(over="ignore", invalid="ignore"):
        for step in range(steps):
            samples[step] = columns[:count, 0]
            for i in range(DOP853.n_stages):
                increment = DOP853.A[i, :i] @ flat[:i]
                stages[i] = rate(columns + h * increment.reshape(columns.shape))
            columns = columns + h * (DOP853.B @ flat).reshape(columns.shape)
    if not np.isfinite(columns.sum()):
        raise ParameterError(
            "coupling c", chain.c, "one at which the motion does not overflow within a period",
            "take a smaller coupling",
        )  # fmt: skip
    return Flow(columns[:, 0], columns[:, 1:-1], columns[:, -1], samples, steps)


def _rate_of(chain: OscillatorChain) -> Callable[[FloatArray], FloatArray]:
    """Return the rate of a motion, its tangents and its c-derivative, as a function of all of them.

    They are columns of one array; shared quantities are looked up once rather than at every stage.
    """
    count, velocity_coupling = chain.sites, chain.velocity_coupling
    matrix, p, n = chain.links.matrix.toarray(), chain.kernel_parameters(), np.arange(count)
    cell, slopes = chain.kernels()
    line = chain.network is None
    strength, gains = chain.eps * chain.c, np.empty((count, 2))

    def rate(columns: FloatArray) -> FloatArray:
        y, v = columns[:count], columns[count:]
        pull = matrix @ (y + velocity_coupling * v) if velocity_coupling else matrix @ y
        by_y, by_v = slopes(y[:, 0], v[:, 0], p, n, count)
        derivative = np.empty_like(columns)
        derivative[:count] = v
        gains[:, 0], gains[:, 1] = by_y, by_v  # each one number, or one for each site
        derivative[count:] = gains[:, :1] * y + gains[:, 1:] * v - strength * pull
        derivative[count:, -1] -= chain.eps * pull[:, 0]
        site = y[:, 0], v[:, 0]
        # Differences of velocities are needed only where velocities are coupled.
        springs = (
            (matrix @ site[0], matrix @ site[1]) if velocity_coupling else (pull[:, 0], site[1])
        )
        if line:
            neighbours = 2.0 * site[0] - springs[0], 2.0 * site[1] - springs[1]
            derivative[count:, 0] = cell(site, neighbours, (0.0, 0.0), p)[1]
        else:
            derivative[count:, 0] = cell(site, springs, p, n, count)[1]
        return derivative

    return rate


def check_orbits(chain: OscillatorChain) -> None:
    """Refuse a chain that has no periodic orbits, or is too long for them.

    Raises
    ------
    ParameterError
        The message states the reason.
    """
    chain.check_unforced("a breather, which requires a chain without external forces")
    if chain.overdamped:
        raise ParameterError("overdamped", "true", "false for a breather", "change it")
    if chain.sites > MAX_SITES:
        raise ParameterError(
            "number of sites n", chain.sites, f"at most {MAX_SITES} for an orbit", "take fewer"
        )
    chain.kernels()  # refuses, before any search, a function without derivatives


def _settled_start(
    chain: OscillatorChain, nucleus: Nucleus, report: ReportCallback = silent
) -> FloatArray:
    """Run until the nucleus has settled; return (X, period) where y passes 0 upwards at the centre.

    In progress reports the run counts as one solution.

    Raises
    ------
    ParameterError
        If other sites are excited by then, or part of the nucleus no longer is.
    RunError
        If its period is far from that of a cell as ε → 0.
    """
    sites, centre = nucleus.excited(chain.sites), nucleus.centre(chain.sites)
    start = excite(chain, sites, quarter_turns=nucleus.quarter_turns())
    period = max(each.period for each in chain.cell.cycles)
    end = SETTLED * chain.time_unit
    times = np.linspace(end - _LAST * period, end, 200 * _LAST + 1)
    run = SmoothIntegration(chain, start, times, tolerance=1e-10)
    while not run.finished:
        before = run.time
        run.advance(run.default_budget)
        report((run.time - before) / end)
    above = np.flatnonzero(run.sampled_amplitude.max(axis=0) > chain.unstable_amplitude) + 1
    if above.tolist() != list(sites):
        raise ParameterError(
            "coupling c", chain.c, "one at which the nucleus stays localised: after "
            f"{SETTLED:g} units of slow time {above.size} sites are excited",
            "take a smaller coupling",
        )  # fmt: skip
    y = run.samples[:, 0, centre]
    rising = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    if rising.size < 2:
        raise RunError(
            f"at eps = {chain.eps:g} the nucleus oscillates more slowly than in {_LAST // 2} "
            f"periods of a cell as eps -> 0, {period:.4g}: take a smaller eps."
        )
    fractions = -y[rising] / (y[rising + 1] - y[rising])
    crossings = times[rising] + fractions * (times[1] - times[0])
    last, fraction = rising[-1], fractions[-1]
    state = (1.0 - fraction) * run.samples[last] + fraction * run.samples[last + 1]
    return np.append(state.ravel(), crossings[-1] - crossings[-2])
