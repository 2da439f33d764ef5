"""Critical coupling of a breather by continuation, in the averaged chain and in the chain (8).

Two couplings are told apart. Up to the *fold* the breather exists, and a run that keeps its mirror
symmetry finds it; a perturbation of any shape destroys it where the first exponent crosses zero,
which can be earlier, or from the start.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from enum import StrEnum

from theory.chains.nucleus import MARGIN, Nucleus, Place
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.breathers import envelope as envelope_breather
from verification.breathers import exponents, orbits
from verification.breathers.continuation import Branch, Crossing, Monitor, first_crossing
from verification.breathers.newton import System

EXTRA = 3
"""Sites added on each side to measure what the finite chain does to a threshold."""


class Method(StrEnum):
    """What the branch consists of."""

    ENVELOPE = "envelope"
    ORBIT = "orbit"
    CLOSED_FORM = "closed-form"


class Mechanism(StrEnum):
    """How a breather is lost."""

    FOLD = "fold"
    """It meets its unstable partner and neither exists beyond."""

    SYMMETRY_BREAKING = "symmetry-breaking"
    """A mode of the other parity under reflection starts to grow before the fold."""

    REAL_EXPONENT = "real exponent"
    """A real exponent crosses zero before the fold."""

    COMPLEX_EXPONENTS = "complex exponents"
    """A pair of complex exponents crosses before the fold."""

    NEVER_STABLE = "never stable"
    """Something grows at every coupling on the branch."""


@dataclass(frozen=True)
class BreatherThreshold:
    """Where a breather is lost as c grows.

    Attributes
    ----------
    c : float
        Largest coupling at which the breather exists: the fold.
    error : float
        Error of ``c``: the search for the fold, the finite chain, the step of the integrator.
    c_stable : float or None
        Up to where it is stable against every small perturbation; None if it never is.
    error_stable : float
        Error of ``c_stable``.
    mechanism : Mechanism
        How stability is lost: at the fold itself, before it, or never held.
    growth : float
        Largest rate per unit T, trivial one apart, half way to the fold.
    growth_mirrored : float or None
        The same for perturbations that keep the mirror symmetry; None without it.
    nucleus : Nucleus
        Size, pattern, place.
    method : Method
        What was continued.
    sites : int
        Chain length.
    seconds : float
        Wall-clock time.
    """

    c: float
    error: float
    c_stable: float | None
    error_stable: float
    mechanism: Mechanism
    growth: float
    growth_mirrored: float | None
    nucleus: Nucleus
    method: Method
    sites: int
    seconds: float


def breather_threshold(
    chain: VdpChain, nucleus: Nucleus, method: Method = Method.ENVELOPE, margin: int = MARGIN
) -> BreatherThreshold:
    """Follow a breather through its fold and say how it is lost.

    Parameters
    ----------
    chain : VdpChain
        a, b, ε and the ends; its c and N are not used.
    nucleus : Nucleus
        Size, pattern, place.
    method : Method, optional
        ``envelope`` (ε → 0) or ``orbit``.
    margin : int, optional
        Sites at rest on each side.

    Raises
    ------
    ParameterError
        If the pattern has no breather, the method is ``closed-form`` (see `closed_form_fold`), or
        the branch does not fold below c = 2.

    Examples
    --------
    >>> found = breather_threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"))
    >>> round(found.c, 6), found.mechanism.value
    (0.199234, 'never stable')
    """
    started = time.perf_counter()
    if method is Method.CLOSED_FORM:
        raise ParameterError("method", method.value, "envelope or orbit", "see closed_form_fold")
    here = _sized(chain, nucleus, margin)
    branch, system, monitor = _followed(here, nucleus, method)
    if branch.fold is None:
        raise ParameterError(
            "pattern", repr(nucleus.pattern), "one whose branch folds below c = 2", "change a or b"
        )
    longer = _sized(chain, nucleus, margin + EXTRA)
    other = _followed(longer, nucleus, method, monitored=False)[0].fold
    finite = abs(other.c - branch.fold.c) if other is not None else branch.fold.c
    error = branch.fold.error + finite + _step_error(here, nucleus, method, branch)
    lost = first_crossing(system, branch, monitor, 0)
    at_half = _nearest(branch, 0.5 * branch.fold.c)
    mirrored = nucleus.mirrored(here.sites)
    return BreatherThreshold(
        branch.fold.c,
        error,
        *_stable_until(lost, branch, error),
        _mechanism(lost, system, here, nucleus, method, branch),
        branch.monitored[at_half][0],
        branch.monitored[at_half][1] if mirrored else None,
        nucleus,
        method,
        here.sites,
        time.perf_counter() - started,
    )


def _sized(chain: VdpChain, nucleus: Nucleus, margin: int) -> VdpChain:
    sides = 2 if nucleus.place is Place.BULK else 1
    # An edge needs the same rest on its one side; N at least two more than the nucleus.
    return replace(chain, sites=nucleus.size + sides * margin, c=0.0)


def _followed(
    chain: VdpChain, nucleus: Nucleus, method: Method, *, monitored: bool = True
) -> tuple[Branch, System, Monitor]:
    centre = nucleus.centre(chain.sites)
    if method is Method.ENVELOPE:
        return (
            envelope_breather.envelope_branch(chain, nucleus, monitored=monitored),
            envelope_breather.rotating_system(chain, centre),
            exponents.stability_monitor(chain, nucleus),
        )
    return (
        orbits.orbit_branch(chain, nucleus, monitored=monitored),
        orbits.shooting_system(chain, centre),
        orbits.stability_monitor(chain, nucleus),
    )


def _step_error(chain: VdpChain, nucleus: Nucleus, method: Method, branch: Branch) -> float:
    """Return the shift of the fold under a halved integration step: residual over |∂F/∂c|."""
    if method is Method.ENVELOPE or branch.fold is None:
        return 0.0
    finer = orbits.shooting_system(chain, nucleus.centre(chain.sites), 2 * orbits.steps_for(chain))
    value, _, by_c = finer(branch.fold.u, branch.fold.c)
    return float(abs(value).max() / abs(by_c).max())


def _nearest(branch: Branch, c: float) -> int:
    before = branch.points[: len(branch.monitored)]
    return min(range(len(before)), key=lambda place: abs(before[place].c - c))


def _stable_until(
    lost: Crossing | None, branch: Branch, error: float
) -> tuple[float | None, float]:
    if lost is None and branch.fold is not None:
        return branch.fold.c, error
    if lost is None or lost.from_start:
        return None, 0.0
    return lost.c, lost.error + error


def _mechanism(
    lost: Crossing | None,
    system: System,
    chain: VdpChain,
    nucleus: Nucleus,
    method: Method,
    branch: Branch,
) -> Mechanism:
    if lost is None:
        return Mechanism.FOLD
    if lost.from_start:
        return Mechanism.NEVER_STABLE
    if nucleus.mirrored(chain.sites):
        monitor = (
            exponents.stability_monitor(chain, nucleus)
            if method is Method.ENVELOPE
            else orbits.stability_monitor(chain, nucleus)
        )
        own = first_crossing(system, branch, monitor, 1)
        if own is None or own.c > lost.c:
            return Mechanism.SYMMETRY_BREAKING
    return (
        Mechanism.COMPLEX_EXPONENTS
        if _turns(lost, chain, method) > 1e-6
        else Mechanism.REAL_EXPONENT
    )


def _turns(lost: Crossing, chain: VdpChain, method: Method) -> float:
    """Return the imaginary part, per unit T, of what crosses."""
    here = replace(chain, c=lost.c)
    if method is Method.ENVELOPE:
        phi, omega = exponents.unpack(lost.u)
        return exponents.exponents(phi, omega, here).frequency
    return orbits.leading_frequency(here, lost.u)
