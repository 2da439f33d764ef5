"""What becomes of a chain (8) or (43) whose last site is displaced: front, breather, or rest.

Four labels, by rules. Times are slow times T = εt; "level" is the amplitude of the unstable cycle
of one cell, √[(8/a)/(1 + √(1 - 8η))].

front
    The far end, site 1, has been above the level for ``HOLD`` without a break.
fixed point
    The chain is certain to go to rest, by a norm or an energy that can only fall from here on:
    see ``verification.runs.state_run.at_rest_for_ever``.
breather
    From some time to twice that time no site's amplitude varied by more than ``STILL`` times the
    level within any window of length ``WINDOW``, none passed the level, and at least one site was
    above it, not the far end.
undecided
    None of these by half of the end time: a label found later would be another one, namely none,
    if the end time were halved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter

import numpy.typing as npt

from theory.chains.vdp import VanDerPolChain, VdpChain
from theory.parameters import ParameterError, positive, within
from verification.maps.state import Label
from verification.runs.state_run import Outcome, Rules, run_to_state

HOLD = 10.0
WINDOW = 5.0
STILL = 1e-5


_LABELS = {
    Outcome.UNDECIDED: Label.UNDECIDED,
    Outcome.FRONT: Label.FRONT,
    Outcome.BREATHER: Label.BREATHER,
    Outcome.FIXED_POINT: Label.FIXED_POINT,
}


@dataclass(frozen=True)
class StateLabel:
    """What one run has shown.

    Attributes
    ----------
    label : Label
        See the module.
    time : float
        Slow time at which the label was certain, or at which the run was given up.
    above : int
        Sites above the level at the last sample.
    steps : int
        Steps taken.
    model : str
        Model that was stepped.
    seconds : float
        Run time.
    """

    label: Label
    time: float
    above: int
    steps: int
    model: str
    seconds: float


def label_state(
    chain: VanDerPolChain,
    start: npt.ArrayLike,
    *,
    end: float = 2000.0,
    tolerance: float = 1e-8,
) -> StateLabel:
    """Run a chain until its state has a name.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        Parameters, with free ends.
    start : array_like
        State at time zero. The far end is the first site, and the last one is where amplitudes of
        (8) are sampled.
    end : float, optional
        End time, slow; labels found in its second half do not count.
    tolerance : float, optional
        Local error of a step relative to the largest value, from 1e-13 to 1e-3.

    Raises
    ------
    ParameterError
        If the chain is not as said, or ε is so small that (8) takes hours (use the envelope).
    ArithmeticError
        If the steps became shorter than 1e-9.

    Examples
    --------
    >>> from verification.runs.excite import excite
    >>> chain = VdpChain(a=4, b=0.5, c=0.6, sites=16).averaged()
    >>> str(label_state(chain, excite(chain, [16], 6.0)).label)
    'front'
    """
    begin = perf_counter()
    positive("end time", end)
    within("tolerance", tolerance, 1e-13, 1e-3)
    if chain.ends != "free":
        raise ParameterError("ends", str(chain.ends), "free", "the far end must be an end")
    full = isinstance(chain, VdpChain)
    if full:
        within("small parameter eps", chain.eps, 1e-4, 10.0, "use the envelope for smaller eps")
    level = level_of(chain.a, chain.b)
    scale = chain.time_unit * chain.kernel_rate
    rules = Rules(
        level=level,
        quiet=positive_damping_square(chain.a, chain.b) if full else level**2,
        stiffness=chain.eps * chain.c if full else 0.0,
        hold=HOLD * scale,
        window=WINDOW * scale,
        settled=STILL * (level if math.isfinite(level) else 1.0),
    )
    run = run_to_state(chain, start, rules, 0.5 * end * scale, tolerance)
    return StateLabel(
        _LABELS[run.outcome],
        run.time / scale,
        run.above,
        run.steps,
        chain.model,
        perf_counter() - begin,
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
