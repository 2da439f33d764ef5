"""The state of any smooth chain in which a few sites are excited: front, breather, or rest.

General rules for chains of which only the contract is known. They define a state by what *lasts*: a
chain is not filled because each site was reached once. Times are in units of the chain's
`time_unit`; the amplitudes in a window of length ``WINDOW`` are those at ``SAMPLES`` times in it;
"level" is the unstable amplitude of the chain.

front
    Every site was above the level throughout each of ``HOLD`` successive windows.
breather
    From some time until twice that time no site passed the level, the largest and the smallest
    amplitude of every site in a window changed by at most ``STEADY`` times the level from one
    window to the next, and some sites, but not all, were above it.
fixed point
    The largest amplitude decreased in each of ``HOLD`` windows and is below ``SMALL`` times the
    level. This is a long decay, not a proof: an energy that can only decrease is known for (5), (8)
    and (43) (``friction_rules``, ``vdp_rules``) but not for every chain.
undecided
    No rule applied by half of the end time.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from theory.arrays import FloatArray
from theory.chains.chain import SmoothChain
from theory.chains.nucleus import Nucleus
from theory.parameters import Range, with_ranges, within
from verification.maps.state import FoundState, Reason, State
from verification.runs.excite import excite
from verification.runs.integration import checked_state
from verification.runs.integrations import integration

WINDOW = 5.0
SAMPLES = 16
HOLD = 4
STEADY = 1e-5
SMALL = 1e-3
TOLERANCES = Range(1e-13, 1e-3)
_STATE = "a map of states, which requires a chain without external forces"


def check_chain(chain: SmoothChain) -> None:
    """Refuse a chain with external forces."""
    chain.check_unforced(_STATE)


def start(
    chain: SmoothChain, sites: tuple[int, ...] | None, displacement: float | None = None, **_: Any
) -> FloatArray:
    """Return a start at rest except for some sites, by default the middle one."""
    return excite(chain, sites or Nucleus(1).excited(chain.sites), displacement)


class _Window(NamedTuple):
    """Largest and smallest amplitude of every site in a window."""

    high: FloatArray
    low: FloatArray


@with_ranges(tolerance=TOLERANCES)
def find_smooth_state(
    chain: SmoothChain, start: npt.ArrayLike, *, end: float = 2000.0, tolerance: float = 1e-8
) -> FoundState:
    """Run a chain until its state is determined.

    Parameters
    ----------
    chain : SmoothChain
        Parameters.
    start : array_like, shape (2, N)
        (y, w) at t = 0.
    end : float, optional
        End time in units of the chain's `time_unit`; states found in its second half are not
        accepted.
    tolerance : float, optional
        Local error relative to the largest value, {tolerance}.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or the chain has no level.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> chain = AveragedChain(a=4, b=0.5, c=0.6, sites=16)
    >>> found = find_smooth_state(chain, excite(chain, [16], 6.0))
    >>> found.state.value, found.reached
    ('front', 16)
    """
    begin = perf_counter()
    within("tolerance", tolerance, *TOLERANCES)
    check_chain(chain)
    level = chain.unstable_amplitude
    state, elapsed, steps = checked_state(chain, start), 0.0, 0
    reached = np.hypot(*state) > level
    windows: list[_Window] = []
    steady_from = 0.0
    found = State.UNDECIDED
    while elapsed + WINDOW <= 0.5 * end and found is State.UNDECIDED:
        state, window, window_steps = _through_window(chain, state, tolerance)
        elapsed, steps = elapsed + WINDOW, steps + window_steps
        newly_reached = (window.high > level) & ~reached
        reached |= newly_reached
        crossing = (window.low <= level) & (window.high >= level)
        changed = not windows or _change(windows[-1], window) > STEADY * level
        if newly_reached.any() or crossing.any() or changed:
            steady_from = elapsed
        windows = [*windows, window][-HOLD:]
        found = _state_of(windows, level, elapsed >= 2.0 * steady_from)
    return FoundState(
        state=found,
        reason=Reason.END_TIME if found is State.UNDECIDED else Reason.DECIDED,
        time=elapsed,
        above=int(np.count_nonzero(windows[-1].high > level)) if windows else 0,
        reached=int(np.count_nonzero(reached)),
        steps=steps,
        amplitude=np.hypot(*state),
        seconds=perf_counter() - begin,
    )


def _through_window(
    chain: SmoothChain, state: FloatArray, tolerance: float
) -> tuple[FloatArray, _Window, int]:
    """Return the state at the end of a window, its amplitudes, and the steps taken."""
    length = WINDOW * chain.time_unit
    times = np.linspace(length / SAMPLES, length, SAMPLES)
    run = integration(chain, state, times, tolerance=tolerance)
    run.finish()
    amplitude = run.sampled_amplitude
    window = _Window(amplitude.max(axis=0), amplitude.min(axis=0))
    return run.samples[-1].copy(), window, run.counts["steps"]


def _change(before: _Window, after: _Window) -> float:
    return max(float(np.abs(new - old).max()) for old, new in zip(before, after, strict=True))


def _state_of(windows: list[_Window], level: float, steady: bool) -> State:
    """Apply the rules to the last ``HOLD`` windows."""
    if len(windows) == HOLD:
        if all((each.low > level).all() for each in windows):
            return State.FRONT
        largest = [float(each.high.max()) for each in windows]
        if largest[-1] < SMALL * level and all(np.diff(largest) < 0.0):
            return State.FIXED_POINT
    above = windows[-1].low > level
    return State.BREATHER if steady and above.any() and not above.all() else State.UNDECIDED
