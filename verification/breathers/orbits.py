"""True periodic orbits: shooting with variational equations.

The unknowns are the state X(0) and the period; the equations X(period) - X(0) = 0 and y = 0 at the
centre of the nucleus. What a kind of chain has of its own are its `flow`, its `chain_rate`, its
`steps_for` a period and `start_of_orbits`: here those of the chain (8), whose starts come from the
breather of the averaged chain, y = Im φ, ẏ = Re φ; ``own`` registers those of any oscillators.
"""

from __future__ import annotations

import cmath
import contextlib
import math
import time
from dataclasses import dataclass, field, replace
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from theory.averaged.breather import BreatherStatus
from theory.averaged.envelope import coupling_matrix
from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain, effective_epsilon
from theory.parameters import ParameterError, RunError
from verification.breathers.envelope import solve_envelope_breather
from verification.breathers.floquet import MARGINAL, Multipliers, floquet_multipliers
from verification.breathers.periodic_motion import SAMPLES, first_harmonics, largest_displacements
from verification.continuation.branch import Branch, Fold, Monitor, Steps, arrive, trace
from verification.continuation.newton import BranchPoint, NotConvergedError, System, solve_at
from verification.steppers.variational import STEPS, Flow, integrate_variations

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

STARTS = (0.05, 0.1, 0.15)
"""Couplings at which a branch of orbits may start from the averaged breather, in order of trial:
at small c, terms of order ε outweigh those that fix the phases inside a nucleus."""
FIRST_STEPS = Steps(length=0.3)
STIFFEST = 10.0
"""Largest ε max|damping| over the cycle for which orbits are sought."""


@dataclass(frozen=True, kw_only=True)
class Orbit:
    """A periodic orbit of (8), solved; `Breather` has what every method gives.

    Attributes
    ----------
    status : BreatherStatus
        By default, as all other fields are by default, that there is none: the branch folds below
        this coupling.
    state : float array, shape (2N,)
        Displacements and velocities at the moment when y = 0 < ẏ at the centre; empty if none.
    duration : float or None
        Of one period in t; None if there is no orbit.
    amplitudes : float array, shape (N,)
        max |y_n| over the period.
    harmonics : complex array, shape (N,)
        First Fourier coefficient, y_n = Im(h_n e^{iωt}) + …: |h_n| and the phase of a site.
    multipliers : Multipliers or None
        Stability.
    residual : float
        |X(period) - X(0)|, at the step used.
    error : float
        Change of the unknowns that a halved step asks for, plus the next Newton step.
    fold : Fold or None
        Where the branch ends, if that was reached.
    seconds : float
        Wall-clock time.
    """

    status: BreatherStatus = BreatherStatus.NONE
    state: Real = field(default_factory=lambda: np.empty(0))
    duration: float | None = None
    amplitudes: Real = field(default_factory=lambda: np.empty(0))
    harmonics: Complex = field(default_factory=lambda: np.empty(0, dtype=complex))
    multipliers: Multipliers | None = None
    residual: float = math.inf
    error: float = math.inf
    fold: Fold | None
    seconds: float

    @property
    def period(self) -> float:
        """In t, dimensionless.

        Raises
        ------
        RunError
            If there is no orbit.
        """
        if self.duration is None:
            raise RunError(BreatherStatus.NONE.sentence)
        return self.duration

    @property
    def frequency(self) -> float:
        """2π/period; raises as `period` does."""
        return 2.0 * math.pi / self.period


@singledispatch
def flow(chain: Any, start: Real, duration: float, steps: int) -> Flow:
    """Return the motion from a start over a time, with its variations, by so many equal steps.

    Raises
    ------
    ParameterError
        If the motion grows beyond all bounds.
    """
    return integrate_variations(chain, start, duration, steps)


@singledispatch
def chain_rate(chain: Any, state: Real) -> Real:
    """Return the right side of (40), the chain (8) as a first-order system.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=2)
    >>> chain_rate(chain, np.array([1.0, 0.0, 0.0, 2.0])).tolist()
    [0.0, 2.0, -1.001, -0.019]
    """
    sites = chain.sites
    y, v = state[:sites], state[sites:]
    springs = coupling_matrix(sites, chain.ends) @ y
    damping = v * (1.0 - chain.a * y**2 + chain.b * y**4)
    return np.concatenate([v, -y - chain.eps * (chain.c * springs + damping)])


@singledispatch
def steps_for(chain: Any) -> int:
    """Return Taylor steps a period for errors near 1e-12: more where ε max|damping| is larger.

    Raises
    ------
    ParameterError
        If that is above `STIFFEST`: shooting would take minutes.

    Examples
    --------
    >>> steps_for(VdpChain(a=2.5, b=0.5, c=0.1)), steps_for(VdpChain(a=4, b=0.5, c=0.1))
    (28, 37)
    """
    stiffness = effective_epsilon(chain)
    if stiffness > STIFFEST:
        raise ParameterError(
            "eps max|1 - a y^2 + b y^4|",
            f"{stiffness:.3g}",
            f"at most {STIFFEST:g} for a true orbit",
            "take a smaller eps, or a larger eta",
        )
    return STEPS + math.ceil(STEPS * stiffness)


def shooting_system(
    chain: VdpChain | OscillatorChain, centre: int, steps: int | None = None
) -> System:
    """Return F(u, c) with u = (X, period): X(period) - X = 0 and y = 0 at the centre."""
    sites = chain.sites
    count = steps or steps_for(chain)

    def system(u: Real, c: float) -> tuple[Real, Real, Real]:
        here = chain.replace(c=abs(c))
        try:
            end = flow(here, u[:-1], float(u[-1]), count)
        except ParameterError as error:
            raise NotConvergedError(str(error)) from None
        value = np.append(end.state - u[:-1], u[centre])
        slope = np.zeros((2 * sites + 1, 2 * sites + 1))
        slope[:-1, :-1] = end.monodromy - np.eye(2 * sites)
        slope[:-1, -1] = chain_rate(here, end.state)
        slope[-1, centre] = 1.0
        return value, slope, np.append(end.by_c, 0.0)

    return system


def orbit_guess(chain: VdpChain, nucleus: Nucleus) -> Real:
    """Return (X, period) from the breather of the averaged chain at this coupling.

    Raises
    ------
    ParameterError
        If the averaged chain has no such breather at this coupling.
    """
    found = solve_envelope_breather(chain, nucleus)
    if found.status is BreatherStatus.NONE:
        raise ParameterError(
            "coupling c", chain.c, "below the fold of the averaged breather", "take a smaller one"
        )
    period = 2.0 * math.pi / (1.0 + chain.eps * found.omega)
    return np.concatenate([found.phi.imag, found.phi.real, [period]])


def orbit_branch(
    chain: VdpChain | OscillatorChain,
    nucleus: Nucleus,
    c_end: float = 2.0,
    *,
    steps: int | None = None,
    monitored: bool = True,
) -> Branch:
    """Follow the orbit from small c through its fold, with its growth rates if ``monitored``.

    Raises
    ------
    ParameterError
        If no orbit was found at small c.
    """
    point = start_of_orbits(chain, nucleus, c_end, steps)
    system = shooting_system(chain, nucleus.centre(chain.sites), steps)
    monitor = stability_monitor(chain, nucleus, steps) if monitored else None
    return trace(system, point, c_end, monitor, FIRST_STEPS)


@singledispatch
def start_of_orbits(
    chain: Any, nucleus: Nucleus, c_end: float, steps: int | None = None
) -> BranchPoint:
    """Return an orbit at small c.

    Raises
    ------
    ParameterError
        If none was found.
    """
    for start in STARTS if c_end > STARTS[0] else (0.5 * c_end,):
        if start < c_end:
            with contextlib.suppress(NotConvergedError):
                return _from_small_eps(replace(chain, c=start), nucleus, steps)
    raise ParameterError(
        "small parameter eps",
        chain.eps,
        f"small enough for an orbit with the pattern '{nucleus.pattern}'",
        "take a smaller one, or another pattern",
    )


def _from_small_eps(
    chain: VdpChain, nucleus: Nucleus, steps: int | None, halvings: int = 5
) -> BranchPoint:
    """Solve from the averaged breather, or from the orbit at half the ε where that is too far."""
    system = shooting_system(chain, nucleus.centre(chain.sites), steps)
    try:
        return solve_at(system, orbit_guess(chain, nucleus), chain.c)
    except NotConvergedError:
        if not halvings:
            raise
    weaker = replace(chain, eps=0.5 * chain.eps)
    guess = _from_small_eps(weaker, nucleus, steps, halvings - 1).u
    return solve_at(system, guess, chain.c)


def leading_frequency(chain: VdpChain | OscillatorChain, u: Real) -> float:
    """Return |arg μ|/(ε period) of the leading multiplier at (X, period), per unit T."""
    period = float(u[-1])
    found = flow(chain, u[:-1], period, steps_for(chain))
    leader = floquet_multipliers(found.monodromy, period, chain.eps).leader
    return abs(cmath.phase(leader)) / (chain.eps * period)


def stability_monitor(
    chain: VdpChain | OscillatorChain, nucleus: Nucleus, steps: int | None = None
) -> Monitor:
    """Return a monitor of (growth, own-parity growth, other-parity growth) less `MARGINAL`."""
    count = steps or steps_for(chain)

    def monitor(u: Real, c: float) -> tuple[float, ...]:
        period = float(u[-1])
        matrix = flow(chain.replace(c=c), u[:-1], period, count).monodromy
        parity = _parity(u[:-1], nucleus, chain.sites)
        found = floquet_multipliers(matrix, period, chain.eps, parity=parity)
        own = found.growth if found.symmetric is None else found.symmetric
        other = found.growth if found.antisymmetric is None else found.antisymmetric
        return found.growth - MARGINAL, own - MARGINAL, other - MARGINAL

    return monitor


def solve_orbit(chain: VdpChain, nucleus: Nucleus, *, steps: int | None = None) -> Orbit:
    """Solve for the periodic orbit at the coupling of ``chain``.

    Parameters
    ----------
    chain : VdpChain
        Needs two cycles and c > 0.
    nucleus : Nucleus
        Which sites, and the pattern of phases.
    steps : int, optional
        Taylor steps a period; by default `steps_for`.

    Raises
    ------
    ParameterError
        If c = 0, the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> orbit = solve_orbit(VdpChain(a=2.5, b=0.5, c=0.1, sites=11), Nucleus(1))
    >>> round(orbit.frequency, 6), orbit.multipliers.stable, orbit.residual < 1e-11
    (1.000985, True, True)
    """
    started = time.perf_counter()
    if chain.c == 0:
        raise ParameterError("coupling c", 0, "positive for a breather", "give c > 0")
    system = shooting_system(chain, nucleus.centre(chain.sites), steps)
    fold: Fold | None = None
    try:
        point = solve_at(system, orbit_guess(chain, nucleus), chain.c)
    except (NotConvergedError, ParameterError):
        # Too near the fold for a direct start: follow the branch.
        branch = orbit_branch(chain, nucleus, chain.c, steps=steps, monitored=False)
        fold = branch.fold
        if fold is not None and chain.c > fold.c:
            return Orbit(fold=fold, seconds=time.perf_counter() - started)
        point = arrive(system, branch, chain.c)
    return describe_orbit(chain, nucleus, point, started, steps=steps, fold=fold)


def describe_orbit(
    chain: VdpChain | OscillatorChain,
    nucleus: Nucleus,
    point: BranchPoint,
    started: float,
    *,
    steps: int | None = None,
    fold: Fold | None = None,
    split: bool = True,
) -> Orbit:
    """Measure an orbit that has been solved for: amplitudes, harmonics, multipliers, error.

    Parameters
    ----------
    chain, nucleus
        Of the orbit; the coupling is that of the point.
    point : BranchPoint
        State and period.
    started : float
        ``time.perf_counter()`` at the beginning.
    steps : int, optional
        Steps a period with which it was solved for; twice as many show the error.
    fold : Fold, optional
        Of its branch, where that was followed.
    split : bool, optional
        Split the multipliers by reflection where the nucleus is mirror-symmetric; not where the
        chain may not be.
    """
    here, count = chain.replace(c=point.c), steps or steps_for(chain)
    state, period = point.u[:-1], float(point.u[-1])
    coarse = flow(here, state, period, count)
    fine = flow(here, state, period, max(SAMPLES, 2 * count))
    finer = shooting_system(here, nucleus.centre(chain.sites), 2 * count)
    value, slope, _ = finer(point.u, point.c)
    step = np.linalg.solve(slope, value)
    nearer = flow(here, state - step[:-1], period - float(step[-1]), count)
    # Of the matrix: what a halved step changes, and what the error of the orbit does.
    change = float(sum(np.abs(each.monodromy - coarse.monodromy).max() for each in (fine, nearer)))
    parity = _parity(state, nucleus, chain.sites) if split else 0
    return Orbit(
        status=BreatherStatus.EXISTS,
        state=state,
        duration=period,
        amplitudes=largest_displacements(fine.samples),
        harmonics=first_harmonics(fine.samples),
        multipliers=floquet_multipliers(
            fine.monodromy, period, chain.eps, parity=parity, error=change
        ),
        residual=float(np.abs(coarse.state - state).max()),
        error=float(np.abs(step).max()) + point.correction,
        fold=fold,
        seconds=time.perf_counter() - started,
    )


def _parity(state: Real, nucleus: Nucleus, sites: int) -> int:
    if not nucleus.mirrored(sites):
        return 0
    y, v = state[:sites], state[sites:]
    even = np.abs(y + y[::-1]).sum() + np.abs(v + v[::-1]).sum()
    odd = np.abs(y - y[::-1]).sum() + np.abs(v - v[::-1]).sum()
    return 1 if even > odd else -1
