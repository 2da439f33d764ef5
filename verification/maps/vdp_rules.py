"""The state of a chain (8) or (43) whose last site is displaced: front, breather, or rest.

There are four states. Times are slow times T = εt; "level" is the amplitude of the unstable cycle
of one cell, √[(8/a)/(1 + √(1 - 8η))].

front
    The chain is filled and remains so: all sites have been above the level without interruption
    from some time until twice that time, and for at least ``HOLD``. Near the boundary to rest,
    sites may fall below it again and again; the run then continues to half of the end time, and the
    state is a front if all sites were above the level at once by half of that time, and never fewer
    than half of them since then.
fixed point
    The chain is certain to go to rest, by a norm or an energy that can only decrease from then on;
    see ``verification.maps.state_run.at_rest_for_ever``.
breather
    From some time until twice that time no site's amplitude varied by more than ``STEADY`` times
    the level within any window of length ``WINDOW``, none passed the level, and some sites, but not
    all, were above it.
undecided
    No rule applied by half of the end time; a state found later would not be found if the end time
    were halved.

Runs of (8) are as accurate as the perturbation of the second start is small, 1e-6: points at which
smaller errors matter are undecided anyway. Runs of (43) are more accurate, since their steps are so
long that an error of 1e-6 would be visible against ``STEADY``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy.typing as npt

from theory.arrays import FloatArray
from theory.chains.ends import Ends
from theory.chains.vdp import VanDerPolChain, VdpChain
from theory.parameters import ParameterError, Range, positive, with_ranges, within
from verification.maps.smooth_rules import TOLERANCES
from verification.maps.state import FoundState
from verification.maps.state_run import run_to_state
from verification.runs.excite import excite

FIGURE_15 = VdpChain(a=4.0, b=0.5, c=0.0, sites=16)
"""The chain of Fig. 15 as it is read here; η replaces a, whose value the paper does not give."""
DISPLACEMENT = 6.0
"""y of the last site at time zero in Fig. 15."""
EPS_RANGE = Range(1e-4, 10.0)
"""Range of ε for runs of (8); below it they take hours."""
HOLD = 10.0
WINDOW = 5.0
STEADY = 1e-5


def start(
    chain: VanDerPolChain,
    sites: tuple[int, ...] | None,
    displacement: float | None = None,
    **_: Any,
) -> FloatArray:
    """Return a start at rest except for some sites, by default the last one, displaced by 6."""
    size = DISPLACEMENT if displacement is None else displacement
    return excite(chain, sites or (chain.sites,), size)


def check_chain(chain: VanDerPolChain) -> None:
    """Refuse closed chains, and an ε so small that (8) takes hours."""
    if chain.ends is not Ends.FREE:
        raise ParameterError("ends", str(chain.ends), "free", "the rule for rest is for these")
    if isinstance(chain, VdpChain):
        within("small parameter eps", chain.eps, *EPS_RANGE, "take the averaged chain")


@with_ranges(tolerance=TOLERANCES)
def find_vdp_state(
    chain: VanDerPolChain, start: npt.ArrayLike, *, end: float = 2000.0, tolerance: float = 1e-8
) -> FoundState:
    """Run a chain until its state is determined.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        Parameters, with free ends.
    start : array_like, shape (2, N)
        (y, ẏ) at time zero; for the averaged chain (Im φ, Re φ). Amplitudes of (8)
        are sampled where the last site passes y = 0.
    end : float, optional
        End time in slow time; states found in its second half are not accepted.
    tolerance : float, optional
        Local error of a step relative to the largest value, {tolerance}.

    Raises
    ------
    ParameterError
        If the chain does not have free ends, or ε is so small that (8) takes hours (then average
        it).
    RunError
        If the steps became shorter than 1e-9.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> chain = AveragedChain(a=4, b=0.5, c=0.6, sites=16)
    >>> str(find_vdp_state(chain, excite(chain, [16], 6.0)).state)
    'front'
    """
    positive("end time", end)
    within("tolerance", tolerance, *TOLERANCES)
    check_chain(chain)
    full = isinstance(chain, VdpChain)
    level = level_of(chain.a, chain.b)
    scale = chain.time_unit * chain.kernel_rate
    return run_to_state(
        chain,
        start,
        level=level,
        rest_bound=positive_damping_square(chain.a, chain.b) if full else level**2,
        stiffness=chain.eps * chain.c if full else 0.0,
        hold=HOLD * scale,
        window=WINDOW * scale,
        settled=STEADY * (level if math.isfinite(level) else 1.0),
        end=0.5 * end * scale,
        tolerance=tolerance,
    )


def level_of(a: float, b: float) -> float:
    """Return the amplitude of the unstable cycle, infinite for η = b/a² > 1/8.

    Examples
    --------
    >>> round(level_of(4, 0.5), 6), level_of(1, 0.2)
    (1.035276, inf)
    """
    root = 1.0 - 8.0 * b / a**2
    return math.sqrt(8.0 / a / (1.0 + math.sqrt(root))) if root >= 0.0 else math.inf


def positive_damping_square(a: float, b: float) -> float:
    """Return the y² up to which 1 - ay² + by⁴ is positive, infinite for η = b/a² > 1/4.

    Examples
    --------
    >>> y2 = positive_damping_square(4, 0.5)
    >>> abs(1 - 4 * y2 + 0.5 * y2**2) < 1e-15, positive_damping_square(1, 0.3)
    (True, inf)
    """
    root = 1.0 - 4.0 * b / a**2
    return 2.0 / a / (1.0 + math.sqrt(root)) if root >= 0.0 else math.inf
