"""The state of a friction chain (5) in which a few sites are excited: front, breather, or rest.

The states are those of Model II (``verification.maps.vdp_rules``), with rules for stick and slip.
Times are τ; "active" sites are those that stick at some time within a window of length ``WINDOW``,
which is about six periods of the cycle.

front
    Every site has stuck at some time, and in each of the ``HOLD`` windows that follow at least half
    of the sites were active.
breather
    Some sites are active, not all have stuck, and from some time until twice that time no new site
    stuck and no site's amplitude changed by more than ``STEADY`` from one window to the next.
fixed point
    Steady sliding: the chain is certain never to stick again, by an energy that can only decrease
    from then on (``FrictionIntegration.going_to_rest``).
undecided
    No rule applied by half of the end time; a state found later would not be found if the end time
    were halved. Also a breather where steady sliding is unstable (v_d at or below the Hopf
    velocity): the sites around it cannot remain at rest, however long they seem to.
"""

from __future__ import annotations

from time import perf_counter

import numpy as np

from theory.arrays import FloatArray
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus
from theory.parameters import Range, with_ranges, within
from verification.maps.state import FoundState, Reason, State
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration

WINDOW = 40.0
HOLD = 3
STEADY = 1e-5
ENDS = Range(8.0 * WINDOW, 1e7)
TOLERANCES = Range(1e-12, 1e-4)


def start(
    chain: FrictionChain,
    sites: tuple[int, ...] | None,
    displacement: float | None = None,
    point: StartPoint = StartPoint.MAXIMUM,
) -> FloatArray:
    """Return a start in steady sliding except for some sites, by default the middle one."""
    chosen = sites or Nucleus(1).excited(chain.sites)
    return excite(chain, chosen, displacement, point=point)


def perturbed(start: FloatArray, size: float, seed: int) -> FloatArray:
    """Return the start with noise of this size on y and ẏ, both of which are of order one."""
    return start + size * np.random.default_rng(seed).standard_normal(start.shape)


@with_ranges(tolerance=TOLERANCES)
def find_friction_state(
    chain: FrictionChain,
    start: FloatArray,
    *,
    end: float = 20_000.0,
    tolerance: float = 1e-8,
) -> FoundState:
    """Run a chain until its state is determined.

    The time of the result is τ.

    Parameters
    ----------
    chain : FrictionChain
        Parameters.
    start : ndarray, shape (2, N)
        y and ẏ.
    end : float, optional
        End time τ, at least eight windows; states found in its second half are not accepted.
    tolerance : float, optional
        Local error, absolute, {tolerance}.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> chain = FrictionChain(c=0.05, sites=7)
    >>> str(find_friction_state(chain, excite(chain, [4])).state)
    'front'
    """
    begin = perf_counter()
    within("end time tau", end, *ENDS)
    within("tolerance", tolerance, *TOLERANCES)
    run = FrictionIntegration(chain, start, tolerance=tolerance)
    reached = np.zeros(chain.sites, dtype=bool)
    steady_from, front_windows = 0.0, 0
    amplitude = run.amplitude
    state, reason, active = State.UNDECIDED, Reason.END_TIME, 0
    # Whole windows only: in a part of one, fewer sites stick and amplitudes change less.
    while run.time + WINDOW <= 0.5 * end:
        run.forget_arrivals()
        run.advance_to(run.time + WINDOW)
        sticking = ~np.isnan(run.arrivals)
        active = int(np.count_nonzero(sticking))
        newly_reached = bool(np.any(sticking & ~reached))
        reached |= sticking
        previous, amplitude = amplitude, run.amplitude
        if newly_reached or float(np.max(np.abs(amplitude - previous))) > STEADY:
            steady_from = run.time
        if run.going_to_rest():
            state, reason = State.FIXED_POINT, Reason.DECIDED
            break
        front_windows = (
            front_windows + 1
            if not newly_reached and reached.all() and 2 * active >= chain.sites
            else 0
        )
        if front_windows == HOLD:
            state, reason = State.FRONT, Reason.DECIDED
            break
        if active and not reached.all() and run.time >= 2.0 * steady_from:
            if chain.cell.effective_damping > 0.0:
                state, reason = State.BREATHER, Reason.DECIDED
            else:
                reason = Reason.UNSTABLE_BACKGROUND
            break
    return FoundState(
        state=state,
        reason=reason,
        time=run.time,
        above=active,
        reached=int(np.count_nonzero(reached)),
        steps=run.counts["steps"],
        amplitude=run.amplitude,
        seconds=perf_counter() - begin,
    )
