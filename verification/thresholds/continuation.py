"""Critical coupling of a breather by continuation, in the averaged chain and in the chain (8).

Two couplings are distinguished. Up to the *fold* the breather exists, and a run that keeps its
mirror symmetry finds it; a perturbation of any shape destroys it where the first exponent crosses
zero, which can be earlier, or from the start.
"""

from __future__ import annotations

import time
from dataclasses import replace

from theory.chains.nucleus import MARGIN, Nucleus, Place
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers import envelope as envelope_breather
from verification.breathers import exponents, orbits
from verification.continuation.branch import Branch, Crossing, Monitor, first_crossing
from verification.continuation.newton import System
from verification.thresholds.result import BranchThreshold, Definition, Mechanism, ThresholdMethod

EXTRA = 3
"""Sites added on each side to measure what the finite chain does to a threshold."""


def breather_threshold(
    chain: VanDerPolChain,
    nucleus: Nucleus,
    method: ThresholdMethod = ThresholdMethod.ENVELOPE,
    margin: int = MARGIN,
) -> BranchThreshold:
    """Follow a breather to its fold, and say how it loses stability up to there.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        a, b, ε and the ends; its c and N are not used.
    nucleus : Nucleus
        Size, pattern, place.
    method : ThresholdMethod, optional
        ``envelope`` (ε → 0) or ``orbit``.
    margin : int, optional
        Sites at rest on each side.

    Raises
    ------
    ParameterError
        If the pattern has no breather, the method is no continuation, or the branch does not fold
        below c = 2.

    Examples
    --------
    >>> found = breather_threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"))
    >>> round(found.c, 6), found.stability_lost_by.value
    (0.199234, 'never stable')
    """
    started = time.perf_counter()
    if method not in (ThresholdMethod.ENVELOPE, ThresholdMethod.ORBIT):
        raise ParameterError(
            "method", method.value, "envelope or orbit", "call threshold() instead"
        )
    here = _sized(chain, nucleus, method, margin)
    branch, system, monitor = _followed(here, nucleus)
    if branch.fold is None:
        raise ParameterError(
            "pattern", repr(nucleus.pattern), "one whose branch folds below c = 2", "change a or b"
        )
    longer = _sized(chain, nucleus, method, margin + EXTRA)
    other = _followed(longer, nucleus, monitored=False)[0].fold
    finite = abs(other.c - branch.fold.c) if other is not None else branch.fold.c
    error = branch.fold.error + finite + _step_error(here, nucleus, branch)
    crossing = first_crossing(system, branch, monitor, 0)
    at_half = _nearest(branch, 0.5 * branch.fold.c)
    mirrored = nucleus.mirrored(here.sites)
    c_stable, error_stable = _stable_until(crossing, branch, error)
    return BranchThreshold(
        c=branch.fold.c,
        error=error,
        method=method,
        definition=Definition.EXISTENCE,
        mechanism=Mechanism.FOLD,
        model=here.model,
        nucleus=nucleus,
        sites=here.sites,
        c_stable=c_stable,
        error_stable=error_stable,
        stability_lost_by=_mechanism(
            crossing, system, monitor, chain=here, nucleus=nucleus, branch=branch
        ),
        growth=branch.monitored[at_half][0],
        growth_mirrored=branch.monitored[at_half][1] if mirrored else None,
        seconds=time.perf_counter() - started,
    )


def _sized(
    chain: VanDerPolChain, nucleus: Nucleus, method: ThresholdMethod, margin: int
) -> VanDerPolChain:
    """Return the chain whose breather is followed, with the nucleus and ``margin`` beside it."""
    kind = VdpChain if method is ThresholdMethod.ORBIT else AveragedChain
    # An edge needs the same rest on its one side.
    sides = 2 if nucleus.place is Place.BULK else 1
    sites = nucleus.size + sides * margin
    return kind(a=chain.a, b=chain.b, c=0.0, eps=chain.eps, sites=sites, ends=chain.ends)


def _followed(
    chain: VanDerPolChain, nucleus: Nucleus, *, monitored: bool = True
) -> tuple[Branch, System, Monitor]:
    centre = nucleus.centre(chain.sites)
    if isinstance(chain, VdpChain):
        return (
            orbits.orbit_branch(chain, nucleus, monitored=monitored),
            orbits.shooting_system(chain, centre),
            orbits.stability_monitor(chain, nucleus),
        )
    return (
        envelope_breather.envelope_branch(chain, nucleus, monitored=monitored),
        envelope_breather.rotating_system(chain, centre),
        exponents.stability_monitor(chain, nucleus),
    )


def _step_error(chain: VanDerPolChain, nucleus: Nucleus, branch: Branch) -> float:
    """Return the shift of the fold under a halved integration step: residual over |∂F/∂c|."""
    if not isinstance(chain, VdpChain) or branch.fold is None:
        return 0.0
    finer = orbits.shooting_system(chain, nucleus.centre(chain.sites), 2 * orbits.steps_for(chain))
    value, _, by_c = finer(branch.fold.u, branch.fold.c)
    return float(abs(value).max() / abs(by_c).max())


def _nearest(branch: Branch, c: float) -> int:
    before = branch.points[: len(branch.monitored)]
    return min(range(len(before)), key=lambda place: abs(before[place].c - c))


def _stable_until(
    crossing: Crossing | None, branch: Branch, error: float
) -> tuple[float | None, float]:
    if crossing is None and branch.fold is not None:
        return branch.fold.c, error
    if crossing is None or crossing.from_start:
        return None, 0.0
    return crossing.c, crossing.error + error


def _mechanism(
    crossing: Crossing | None,
    system: System,
    monitor: Monitor,
    *,
    chain: VanDerPolChain,
    nucleus: Nucleus,
    branch: Branch,
) -> Mechanism:
    if crossing is None:
        return Mechanism.FOLD
    if crossing.from_start:
        return Mechanism.NEVER_STABLE
    if nucleus.mirrored(chain.sites):
        own = first_crossing(system, branch, monitor, 1)
        if own is None or own.c > crossing.c:
            return Mechanism.SYMMETRY_BREAKING
    return (
        Mechanism.COMPLEX_EXPONENTS if _turns(crossing, chain) > 1e-6 else Mechanism.REAL_EXPONENT
    )


def _turns(crossing: Crossing, chain: VanDerPolChain) -> float:
    """Return the imaginary part, per unit T, of what crosses."""
    here = replace(chain, c=crossing.c)
    if isinstance(here, VdpChain):
        return orbits.leading_frequency(here, crossing.u)
    phi, omega = exponents.unpack(crossing.u)
    return exponents.exponents(phi, omega, here).frequency
