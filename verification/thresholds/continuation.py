"""Critical coupling of a breather by continuation, in the averaged chain and in the chain (8).

Two couplings are distinguished. The breather exists up to its *fold*, which a run that keeps the
mirror symmetry reaches. A perturbation without symmetry destroys it at the coupling where the first
exponent crosses zero, which may be smaller; it may also be unstable from the start.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from theory.chains.nucleus import MARGIN, Nucleus, Place
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers.families import own_family
from verification.breathers.family import BreatherFamily, ReportCallback
from verification.continuation.branch import (
    ContinuationBranch,
    Crossing,
    Fold,
    arrive,
    first_crossing,
)
from verification.continuation.newton import NotConvergedError, solve_at
from verification.execution.progress import ProgressCallback
from verification.thresholds.result import BranchThreshold, Definition, Mechanism, ThresholdMethod

EXTRA = 3
"""Number of sites added on each side to measure the effect of the finite chain on a threshold."""

_REMAINDER = 2.0
"""Bound on the effect of all sites beyond the margin, relative to that of the first `EXTRA` ones.
Amplitudes at rest fall by a fifth or more per site up to c = 2, so that those farther out have less
than half the effect of these."""

_SOLUTIONS = 40
"""Usual number of solutions whose growth is computed: 10 on each branch, and 10 to locate each loss
of stability."""

_BEFORE = 1e-6, 1e-4, 1e-2
"""Relative distances below a crossing at which the slope of the growth is measured, in order of
trial."""


def breather_threshold(
    chain: VanDerPolChain | OscillatorChain,
    nucleus: Nucleus,
    method: ThresholdMethod,
    margin: int = MARGIN,
    progress: ProgressCallback | None = None,
) -> BranchThreshold:
    """Follow a breather to its fold, and determine how it loses stability on the way.

    Parameters
    ----------
    chain : VdpChain, AveragedChain or OscillatorChain
        The chain; its c is not used. The sites of an `OscillatorChain` must be identical and along
        a line. If there are more than ``margin`` sites at rest beside the nucleus, the surplus ones
        are omitted.
    nucleus : Nucleus
        Size, pattern and place of the nucleus.
    method : ThresholdMethod
        ``envelope`` (ε → 0) or ``orbit``.
    margin : int, optional
        Sites at rest on each side.
    progress : callable, optional
        Called with the fraction done, as estimated.

    Raises
    ------
    ParameterError
        If the nucleus is wider than the chain, the pattern has no breather, the method is not a
        continuation, or the branch has no fold below c = 2.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0)
    >>> found = breather_threshold(chain, Nucleus(3, "-+"), ThresholdMethod.ENVELOPE)
    >>> round(found.c_crit, 6), found.lost_by.value
    (0.199234, 'never stable')
    """
    started = time.perf_counter()
    if method not in (ThresholdMethod.ENVELOPE, ThresholdMethod.ORBIT):
        raise ParameterError(
            "method", method.value, "envelope or orbit", "call threshold() instead"
        )
    here = _sized(chain, nucleus, method, margin)
    family = own_family(here, nucleus)
    report = _Report(progress)
    branch = family.branch(report=report)
    if branch.fold is None:
        raise ParameterError(
            "fold of the breather", "absent up to c = 2", "below c = 2 for a critical coupling",
            "take a larger eta, or bisection, which asks whether the nucleus spreads",
        )  # fmt: skip
    longer = own_family(_sized(chain, nucleus, method, margin + EXTRA), nucleus)
    other = longer.branch(report=report)
    finite = (
        abs(other.fold.parameter - branch.fold.parameter)
        if other.fold is not None
        else branch.fold.parameter
    )
    error = family.fold_error(branch.fold) + _REMAINDER * finite
    crossing = _loss_of_stability(family, branch, report)
    beside = _loss_of_stability(longer, other, report)
    there = _half_way(family, branch, started)
    c_stable = _stable_to(crossing, branch.fold)
    error_stable = None
    if c_stable is not None:
        own = error if crossing is None else _crossing_error(family, crossing)
        longest = _stable_to(beside, other.fold) or 0.0
        error_stable = own + _REMAINDER * abs(c_stable - longest)
    return BranchThreshold(
        c_crit=branch.fold.parameter,
        error=error,
        method=method,
        definition=Definition.EXISTENCE,
        mechanism=Mechanism.FOLD,
        model=here.model,
        nucleus=nucleus,
        sites=here.sites,
        stable_to=c_stable,
        stable_to_error=error_stable,
        lost_by=_mechanism(crossing, family, branch),
        growth_half_way=there.growth,
        growth_half_way_error=there.growth_error,
        growth_half_way_mirrored=there.symmetric,
        growth_half_way_mirrored_error=None if there.symmetric is None else there.symmetric_error,
        seconds=time.perf_counter() - started,
    )


class _Report:
    """Progress, estimated from the number of solutions whose growth has been computed."""

    def __init__(self, progress: ProgressCallback | None) -> None:
        self.progress, self.seen = progress, 0.0

    def __call__(self, done: float) -> None:
        """Report one more solution, or a part of the work that precedes the first."""
        self.seen += done
        if self.progress is not None:
            self.progress(self.seen / max(_SOLUTIONS, self.seen + 1))


def _sized(chain: Any, nucleus: Nucleus, method: ThresholdMethod, margin: int) -> Any:
    """Return the chain that is solved: the nucleus and at most ``margin`` sites beside it."""
    # At an edge the same margin is needed on one side only.
    sides = 2 if nucleus.place is Place.BULK else 1
    sites = min(chain.sites, nucleus.size + sides * margin)
    if isinstance(chain, OscillatorChain):
        if not chain.along_line or any(np.ndim(each) for each in chain.site_values.values()):
            raise ParameterError(
                "chain", "one whose sites differ, or a network", "of identical sites along a line "
                f"for the method {method}", "take bisection",
            )  # fmt: skip
        return chain.replace(sites=sites)
    kind = VdpChain if method is ThresholdMethod.ORBIT else AveragedChain
    return kind(a=chain.a, b=chain.b, c=0.0, eps=chain.eps, sites=sites, ends=chain.ends)


def _half_way(family: BreatherFamily, branch: ContinuationBranch, started: float) -> Any:
    """Return the stability at half the coupling of the fold, which a short branch begins above."""
    assert branch.fold is not None
    system, first, c = family.system(), branch.points[0], 0.5 * branch.fold.parameter
    below = c < first.parameter
    point = solve_at(system, first.u, c) if below else arrive(system, branch, c)
    return family.measured(point, started).stability


def _loss_of_stability(
    family: BreatherFamily, branch: ContinuationBranch, report: ReportCallback
) -> Crossing | None:
    """Return where a growth rate crosses zero on the way to the fold; None if at the fold."""
    monitor = family.reported_monitor(report)
    crossing = first_crossing(family.system(), branch, monitor, 0)
    return _before(family, branch.fold, crossing)


def _before(
    family: BreatherFamily, fold: Fold | None, crossing: Crossing | None
) -> Crossing | None:
    """Return a loss of stability on the way to a fold; None if it is the fold, within errors.

    At a fold a growth rate is zero, and it may be found on either side of it.
    """
    if fold is None or crossing is None or crossing.from_start:
        return crossing
    apart = fold.parameter - crossing.parameter
    return crossing if apart > family.fold_error(fold) + crossing.error else None


def _stable_to(crossing: Crossing | None, fold: Fold | None) -> float | None:
    """Return the coupling up to which no mode grows; None if one grows from the start."""
    if crossing is None:
        return None if fold is None else fold.parameter
    return None if crossing.from_start else crossing.parameter


def _crossing_error(family: BreatherFamily, crossing: Crossing) -> float:
    """Return the error of the coupling at which a growth rate crosses zero, on its own chain.

    The error of the growth rate is twice the value that counts as zero, plus the change when the
    integration steps are halved. It is divided by the slope of the growth rate in c, measured just
    below the crossing. If no slope can be measured, the error is c itself.
    """
    finer, c = family.finer(), crossing.parameter
    for part in _BEFORE:
        before = c * (1.0 - part)
        try:
            point = solve_at(family.system(), crossing.u, before)
            nearer = solve_at(finer.system(), point.u, before)
        except NotConvergedError:
            continue
        growth = family.monitor(point.u, before)[0]
        marginal = family.stability(point.u, before, split=False).marginal
        if growth < -4.0 * marginal:
            off = 2.0 * marginal + abs(finer.monitor(nearer.u, before)[0] - growth)
            return crossing.error + off * (c - before) / -growth
    return c


def _mechanism(
    crossing: Crossing | None, family: BreatherFamily, branch: ContinuationBranch
) -> Mechanism:
    if crossing is None:
        return Mechanism.FOLD
    if crossing.from_start:
        return Mechanism.NEVER_STABLE
    if family.nucleus.mirrored(family.chain.sites):
        own_parity = first_crossing(family.system(), branch, family.monitor, 1)
        if own_parity is None or own_parity.parameter > crossing.parameter:
            return Mechanism.SYMMETRY_BREAKING
    turns = family.stability(crossing.u, crossing.parameter, split=False).frequency
    return Mechanism.COMPLEX_EXPONENTS if turns > 1e-6 else Mechanism.REAL_EXPONENT
