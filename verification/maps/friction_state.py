"""What becomes of a friction chain (5) in which a few sites are excited: front, breather, or rest.

The labels are those of Model II (``verification.maps.vdp_state``), by rules for stick and slip.
Times are τ; "active" sites are those that stick at some time within a window of length ``WINDOW``,
which is about six periods of the cycle.

front
    Every site has stuck at some time, and in each of the ``HOLD`` windows that follow at least
    half of the sites were active.
breather
    Some sites are active, not all have stuck, and from some time to twice that time no new site
    stuck and no site's amplitude changed by more than ``STILL`` from one window to the next.
fixed point
    Steady sliding: the chain is certain never to stick again, by an energy that can only fall
    from here on (``FrictionIntegration.going_to_rest``).
undecided
    None of these by half of the end time: a label found later would be another one, namely none,
    if the end time were halved. Also a breather where steady sliding is unstable (v_d at or below
    the Hopf velocity): the sites around it cannot stay at rest, however long it looks still.
"""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.chains.friction import FrictionChain
from theory.parameters import within
from verification.maps.state import Label
from verification.runs.friction_integration import FrictionIntegration

WINDOW = 40.0
HOLD = 3
STILL = 1e-5


@dataclass(frozen=True)
class FrictionLabel:
    """What one run has shown.

    Attributes
    ----------
    label : Label
        See the module.
    why : str
        "decided", "end time", or "unstable background".
    time : float
        τ at which the label was certain, or at which the run was given up.
    active : int
        Sites that stuck in the last window.
    reached : int
        Sites that stuck at some time.
    steps : int
        Steps taken.
    seconds : float
        Run time.
    """

    label: Label
    why: str
    time: float
    active: int
    reached: int
    steps: int
    seconds: float


def label_friction(
    chain: FrictionChain,
    start: npt.NDArray[np.float64],
    *,
    end: float = 20_000.0,
    tolerance: float = 1e-8,
) -> FrictionLabel:
    """Run a chain until its state has a name.

    Parameters
    ----------
    chain : FrictionChain
        Parameters.
    start : ndarray, shape (2, N)
        y and ẏ.
    end : float, optional
        End time τ, at least eight windows; labels found in its second half do not count.
    tolerance : float, optional
        Local error, absolute, from 1e-12 to 1e-4.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> from verification.runs.excite import excite
    >>> chain = FrictionChain(c=0.05, sites=7)
    >>> str(label_friction(chain, excite(chain, [4])).label)
    'front'
    """
    begin = perf_counter()
    within("end time tau", end, 8.0 * WINDOW, 1e7)
    within("tolerance", tolerance, 1e-12, 1e-4)
    lane = FrictionIntegration(chain, start, tolerance=tolerance)
    ever = np.zeros(chain.sites, dtype=bool)
    still_from, held = 0.0, 0
    amplitude = lane.amplitude
    label, why, active = Label.UNDECIDED, "end time", 0
    # Whole windows only: in a part of one fewer sites stick, and less changes.
    while lane.time + WINDOW <= 0.5 * end:
        lane.forget_arrivals()
        lane.advance_to(lane.time + WINDOW)
        sticking = ~np.isnan(lane.arrivals)
        active = int(np.count_nonzero(sticking))
        fresh = bool(np.any(sticking & ~ever))
        ever |= sticking
        before, amplitude = amplitude, lane.amplitude
        if fresh or float(np.max(np.abs(amplitude - before))) > STILL:
            still_from = lane.time
        if lane.going_to_rest():
            label, why = Label.FIXED_POINT, "decided"
            break
        held = held + 1 if not fresh and ever.all() and 2 * active >= chain.sites else 0
        if held == HOLD:
            label, why = Label.FRONT, "decided"
            break
        if active and not ever.all() and lane.time >= 2.0 * still_from:
            if chain.cell.effective_damping > 0.0:
                label, why = Label.BREATHER, "decided"
            else:
                why = "unstable background"
            break
    return FrictionLabel(
        label,
        why,
        lane.time,
        active,
        int(np.count_nonzero(ever)),
        lane.counts["steps"],
        perf_counter() - begin,
    )
