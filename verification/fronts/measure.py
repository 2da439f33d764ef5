"""Velocity of a travelling front of any chain, measured by running the chain, with an uncertainty.

A front is started from the first sites of a chain with free ends, and its arrival at each site is
timed; the chain is lengthened until the velocity has settled or the front has stopped. The rule is
the same for all models (``arrival_fit``, ``watch``, ``preparation``); what differs is in ``smooth``
and ``friction``. Lattices and networks are not lengthened (``network``).

* For (43) one can solve for the travelling wave itself (``wave``), which gives v to 1e-11 and the
  multipliers.
* The piecewise-linear chain (44) is infinite and is advanced exactly from one switching to the next
  (``verification.piecewise``).
"""

from __future__ import annotations

from dataclasses import replace
from functools import singledispatch
from time import perf_counter
from typing import Literal

import numpy as np

from theory.chains.chain import Chain, SmoothChain
from theory.chains.friction import FrictionChain
from theory.chains.own import OwnChain
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain
from theory.parameters import (
    ParameterError,
    check_progress,
    need_instance,
    number,
    with_ranges,
    word,
)
from verification.execution.progress import ProgressCallback
from verification.fronts import friction, network, smooth
from verification.fronts.friction import friction_front
from verification.fronts.request import TOLERANCE, Request
from verification.fronts.resting import StaticFold, static_fold
from verification.fronts.result import Front, LeftBoundary
from verification.fronts.smooth import OUTRUNS, own_front, smooth_front
from verification.fronts.status import FrontStatus
from verification.fronts.switchings import front_by_switchings
from verification.fronts.wave import FrontWave, NoFrontError, front_wave
from verification.piecewise import simulation
from verification.runs.excite import StartPoint


@with_ranges(
    smooth_accuracy=smooth.ACCURACY.allowed,
    friction_accuracy=friction.ACCURACY.allowed,
    piecewise_accuracy=simulation.ACCURACIES,
    smooth_tolerance=TOLERANCE.allowed,
    friction_tolerance=friction.TOLERANCE.allowed,
    smooth_excited=smooth.EXCITED.allowed,
    friction_excited=friction.EXCITED.allowed,
    more_smooth_sites=smooth.MORE_SITES,
    more_sites=friction.MORE_SITES,
    piecewise_sites=simulation.MAX_SITES_RANGE,
    usual_smooth_accuracy=smooth.ACCURACY.default,
    usual_network_accuracy=network.ACCURACY.default,
    usual_friction_accuracy=friction.ACCURACY.default,
    usual_piecewise_accuracy=simulation.ACCURACY,
    usual_smooth_tolerance=TOLERANCE.default,
    usual_friction_tolerance=friction.TOLERANCE.default,
    usual_smooth_excited=smooth.EXCITED.default,
    usual_friction_excited=friction.EXCITED.default,
    usual_rows=network.ROWS,
    usual_network_excited=network.EXCITED,
    usual_smooth_sites=smooth.LONGEST,
    usual_friction_sites=friction.LONGEST,
    usual_piecewise_sites=simulation.MAX_SITES,
    usual_smooth_stall=smooth.STALL_TIME.default,
    usual_friction_stall=friction.STALL_TIME.default,
    directions=network.DIRECTIONS.allowed,
)
def measure_front(  # noqa: PLR0913  (options of every kind of chain)
    chain: Chain,
    *,
    method: Literal["run", "wave"] = "run",
    accuracy: float | None = None,
    tolerance: float | None = None,
    excited: int | None = None,
    max_sites: int | None = None,
    stall_time: float | None = None,
    left_boundary: LeftBoundary = LeftBoundary.FREE,
    point: StartPoint | str | float = StartPoint.MAXIMUM,
    directions: int | None = None,
    progress: ProgressCallback | None = None,
) -> Front:
    """Return the velocity of a front of (8), (43), (44), (5), or of a user-defined smooth chain.

    Parameters
    ----------
    chain : Chain
        The chain and its parameters, with free ends. Its ``sites`` is the length tried first: for a
        smooth chain the number of sites beyond the excited ones, at least {more_smooth_sites}; for
        a friction chain the total.
    method : {"run", "wave"}, optional
        ``run``: fit the arrival times on a running chain. ``wave``, for (43) only: solve for the
        travelling wave itself, with its multipliers; no other option applies then.
    accuracy : float, optional
        Relative error of v below which the front counts as steady. Smooth chain: {smooth_accuracy},
        by default {usual_smooth_accuracy}. Lattice or network: by default {usual_network_accuracy}.
        Friction chain: {friction_accuracy}, by default {usual_friction_accuracy}. Chain (44): the
        relative spread of the period, {piecewise_accuracy}, by default {usual_piecewise_accuracy}.
    tolerance : float, optional
        Local error of the integrator. Smooth chain: {smooth_tolerance}, by default
        {usual_smooth_tolerance}. Friction chain: {friction_tolerance}, by default
        {usual_friction_tolerance}.
    excited : int, optional
        Number of sites excited at the start. Smooth chain: {smooth_excited}, by default
        {usual_smooth_excited}; as many sites are kept behind a front that outruns its waves, and
        more behind a wide one, for which by default more are excited.
        Friction chain: {friction_excited}, by default {usual_friction_excited}.
        Lattice: the number of rows, by default {usual_rows}. Lattice with ``directions``, or
        network: the number of sites nearest to its centre, by default {usual_network_excited}.
    max_sites : int, optional
        Length of the longest chain tried before a front is called unsteady, with the excited sites.
        Smooth chain: at least {more_smooth_sites} more than are excited, by default
        {usual_smooth_sites} more. Friction chain: at least {more_sites} more than are excited, by
        default {usual_friction_sites}. Chain (44): the largest number of sites that a front may
        pass, {piecewise_sites}, by default {usual_piecewise_sites}.
    stall_time : float, optional
        Time without an arrival after which a front is suspected of having stopped; after twice
        this time it is called pinned or creeping. Smooth chain: in slow time εt, by default
        {usual_smooth_stall}. Friction chain: in τ, by default {usual_friction_stall}.
    left_boundary : LeftBoundary
        What is to the left of the first site of a smooth chain.
    point : StartPoint, str or float
        Where on the cycle, or at which y, the excited sites of a friction chain start.
    directions : int, optional
        For a lattice: excite its centre and measure v in this number of directions,
        {directions}; by default a planar front runs across its rows. Lattices and networks are not
        lengthened.
    progress : callable, optional
        Called at intervals with the fraction of the present chain that the front has passed.

    Returns
    -------
    Front
        Its ``v`` and ``error`` are in sites per unit of the chain's slow time, dimensionless.

    Raises
    ------
    ParameterError
        If the cell does not have two cycles, sites start to oscillate by themselves, a parameter is
        out of range, or an option is given that has no effect on this front.

    References
    ----------
    Fronts in chains of discrete cells: W. Atkinson and N. Cabrera (1965), L. Slepyan (2002).

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> front = measure_front(AveragedChain(a=4, b=0.5, c=0.6))
    >>> front.status.value, abs(front.v - 0.722566) < 1e-6, front.error < 1e-5
    ('steady', True, True)
    """
    begin = perf_counter()
    need_instance("chain", chain, (Chain,), "give one, as VdpChain(a=4, b=0.5, c=0.6)")
    word("method", method, ("run", "wave"))
    check_progress(progress)
    request = Request(
        accuracy=accuracy,
        tolerance=tolerance,
        excited=excited,
        max_sites=max_sites,
        stall_time=stall_time,
        left_boundary=LeftBoundary(left_boundary),
        point=StartPoint(point) if isinstance(point, str) else number("start point", point),
        directions=directions,
        progress=progress,
    )
    if method == "wave":
        request.reads(where="with the method wave")
        return front_of_wave(chain)
    if getattr(chain, "c", 1.0) == 0.0:
        raise ParameterError("coupling c", 0.0, "positive for a front", "give a coupling")
    return replace(_measured(chain, request), seconds=perf_counter() - begin)


def front_of_wave(chain: Chain, wave: FrontWave | StaticFold | None = None) -> Front:
    """Return the front of (43) by solving for the wave, or from a wave already solved for.

    For a front at rest the fold of such fronts stands in place of the wave.

    Raises
    ------
    ParameterError
        If the chain is not of the form (43), or η is out of range.
    NoFrontError
        If the front is pinned, or travels at a velocity below 1e-3.
    """
    if not isinstance(chain, AveragedChain):
        raise ParameterError(
            "method", "wave", f"run for the model {chain.model}: the wave is a solution of (43)",
            "take the model averaged",
        )  # fmt: skip
    begin = perf_counter()
    found = wave
    if found is None:
        try:
            found = front_wave(chain.c, chain.eta)
        except NoFrontError:
            found = static_fold(chain.eta)
            if chain.c > found.c + found.error:
                raise
    front = Front(
        chain=chain,
        status=FrontStatus.PINNED,
        v=0.0,
        error=None,
        excited=None,
        left_boundary=LeftBoundary.WAVE,
        outruns_waves=False,
        arrivals=np.empty(0),
        method="wave",
        counts={},
        seconds=perf_counter() - begin,
        detail=found,
    )
    if isinstance(found, StaticFold):
        return replace(front, error=found.fastest(chain.c))
    return replace(
        front,
        status=FrontStatus.STEADY,
        v=found.v,
        error=found.error,
        outruns_waves=found.v > OUTRUNS * chain.c,
        counts={"steps": found.steps, "iterations": found.iterations},
        seconds=found.seconds,
    )


@singledispatch
def _measured(chain: Chain, request: Request) -> Front:
    """Return the front of a chain; each kind registers its method and the options it uses."""
    raise ParameterError(
        "model", chain.model, "one whose fronts can be measured", "take another chain"
    )


_measured.register(SmoothChain, smooth_front)
_measured.register(OwnChain, own_front)
_measured.register(FrictionChain, friction_front)


@_measured.register
def _piecewise_front(chain: PiecewiseChain, request: Request) -> Front:
    request.reads("accuracy", "max_sites", where="for the chain (44)")
    return front_by_switchings(
        chain,
        accuracy=simulation.ACCURACY if request.accuracy is None else request.accuracy,
        max_sites=simulation.MAX_SITES if request.max_sites is None else request.max_sites,
    )
