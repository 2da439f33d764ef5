"""The closed form of the breather, Eqs. (9), (29), (30), (37), (38), for each reading of n in (37).

The unknowns are α_0 and z = e^{k_1}. With S = α_0² and w = z², (29) is c z = G(S) with
G = (-b S² + 2a S - 8)/16, and (37), with k_2 = -π/2, is

    ½ - a S w^n/8 + b S² w^{2n}/16 = (c/2)(1/z - z).                                          (37)

(37) can hold at one site n at most, and the paper does not say at which. The possible readings are:

- ``centre``, n = 0. The left side is -G by definition, so -G = (G/2)(1/w - 1): G = 0 or w = -1.
  There is no solution.
- ``neighbour``, n = 1. With s = S w, s (1 - a s/4 + b s²/8) = G (S - s): a cubic for s at given
  S, the parameter of the branch, and c = G √(S/s).
- ``tail``, n → ∞. c = z/(1 - w), and (29) is b S² - 2a S + 8 + 16 w/(1 - w) = 0.

Each branch starts from the stable cycle of a single cell and ends at a largest c, its fold.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, overload

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from theory.arrays import EPS, FloatArray
from theory.averaged.breather_branch import NeighbourBranch, discriminant
from theory.cells.vdp import SMALLEST_ETA
from theory.chains.chain import MAX_SITES, SMALLEST_C
from theory.chains.nucleus import Nucleus, Place
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError, at_least
from theory.status import Status

_NOISE = 64.0 * EPS
"""Relative rounding error of c along a branch."""
_SCAN_POINTS = 500


class Reading(Status):
    """The site n at which (37) is evaluated, which the paper leaves open."""

    CENTRE = "centre", "(37) is taken at the centre, n = 0, where it has no solution."
    NEIGHBOUR = "neighbour", "(37) is taken at the neighbour of the centre, n = 1."
    TAIL = "tail", "(37) is taken far out, n → ∞, where it is linear."


class BreatherStatus(Status):
    """The outcome of the search for a breather, by any method; each member has a sentence."""

    EXISTS = "exists", "the equations have a breather at this coupling."
    NONE = (
        "none",
        "there is no such breather at this coupling: its branch ends in a fold below it, if there "
        "is a branch at all.",
    )
    SETTLED = "settled", "the motion is periodic to within the tolerance."
    UNSETTLED = (
        "unsettled",
        "the motion was still changing at the end of the run: allow more slow time, or solve for "
        "the orbit.",
    )
    ESCAPED = (
        "escaped",
        "a site that was at rest passed the unstable cycle; the run does not show whether there is "
        "an unstable breather: solve for the orbit.",
    )
    DIED = (
        "died",
        "the nucleus died out: no site is left above the unstable cycle; whether there is a "
        "breather the run does not show; solve for the orbit.",
    )


@dataclass(frozen=True, kw_only=True)
class ClosedFormFold:
    """The largest coupling at which the closed form has a solution.

    Attributes
    ----------
    c : float
        Coupling, dimensionless.
    error : float
        Estimated error of ``c``.
    place : float
        For the reading ``neighbour``, the value of (S_s - S)/(S_s - S_us) at the fold, where S_s
        and S_us are the squared amplitudes of the two cycles.
    """

    c: float
    error: float
    place: float = 0.0


@dataclass(frozen=True, kw_only=True)
class ClosedFormBreather:
    """The closed form at one coupling.

    Attributes
    ----------
    status : BreatherStatus
        ``exists``; or ``none`` beyond the fold and for the reading ``centre``.
    alpha_0 : float or None
        Amplitude of the central site.
    decay : float or None
        e^{k_1}, the ratio of neighbouring amplitudes.
    frequency : float
        ω = 1 + εc of (30).
    phase_step : float
        k_2 = -π/2 of (37).
    residual : float
        Largest residual of (29) and (37).
    error : float
        Bound on the relative error of ``alpha_0`` and ``decay``; infinite without a solution.
    fold : ClosedFormFold or None
        The fold at which the branch ends; None if the reading has no solution at any coupling.
    seconds : float
        Wall-clock time.
    """

    status: BreatherStatus
    alpha_0: float | None = None
    decay: float | None = None
    frequency: float
    phase_step: float = -0.5 * math.pi
    residual: float = math.inf
    error: float = math.inf
    fold: ClosedFormFold | None
    seconds: float

    def amplitudes(self, count: int) -> FloatArray:
        """Return A_n = α_0 e^{k_1|n|} for n = 0 … count-1 (Eq. 38); empty without a solution."""
        if self.alpha_0 is None or self.decay is None:
            return np.empty(0)
        return np.array([self.alpha_0 * self.decay**n for n in range(count)])


def has_closed_form(nucleus: Nucleus, sites: int) -> bool:
    """Return whether (9) applies to the nucleus: one centre with a neighbour on either side."""
    return nucleus.size == 1 and nucleus.place is Place.BULK and sites > 2


def check_closed_form(nucleus: Nucleus, sites: int) -> None:
    """Refuse a nucleus, or a number of sites, to which (9) does not apply.

    Raises
    ------
    ParameterError
        If the nucleus is not one site in the bulk, or the chain has fewer than three sites.
    """
    if has_closed_form(nucleus, sites):
        return
    remedy = "take the method envelope or orbit"
    if has_closed_form(nucleus, MAX_SITES):
        allowed = "at least 3: in (9) the centre has two neighbours"
        raise ParameterError("number of sites n", sites, allowed, remedy)
    allowed = "one site in the bulk: (9) has one centre"
    raise ParameterError("nucleus", nucleus.size, allowed, remedy)


def decay_of_centre(alpha_0: float, chain: VanDerPolChain) -> float:
    """Return e^{k_1} = (-b α_0⁴ + 2a α_0² - 8)/(16 c) (Eq. 29)."""
    square = alpha_0**2
    return (-chain.b * square**2 + 2.0 * chain.a * square - 8.0) / 16.0 / chain.c


def breather_frequency(chain: VanDerPolChain) -> float:
    """Return ω = 1 + εc (Eq. 30).

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> breather_frequency(VdpChain(a=2.5, b=0.5, c=0.1, eps=0.01))
    1.001
    """
    return 1.0 + chain.eps * chain.c


def tail_residual(alpha_0: float, decay: float, site: float, chain: VanDerPolChain) -> float:
    """Return the left side minus the right side of (37) at a site, times -(c/2)(z - 1/z).

    Parameters
    ----------
    alpha_0, decay : float
        α_0 and z = e^{k_1}.
    site : float
        The site n; ``math.inf`` for the linear tail.
    chain : VdpChain or AveragedChain
        The chain, of which a, b and c are used.
    """
    square = 0.0 if math.isinf(site) else alpha_0**2 * decay ** (2 * site)
    balance = 0.5 - chain.a * square / 8.0 + chain.b * square**2 / 16.0
    return balance - 0.5 * chain.c * (1.0 / decay - decay)


def solve_breather(
    chain: VanDerPolChain, reading: Reading = Reading.NEIGHBOUR
) -> ClosedFormBreather:
    """Solve (29) with (37) on the branch that starts from the stable cycle of a single cell.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        A chain with two cycles (8b < a²) and c > 0.
    reading : Reading, optional
        Site at which (37) is evaluated.

    Raises
    ------
    ParameterError
        If the cell has no cycle, c is zero or below `SMALLEST_C`, or η is below `SMALLEST_ETA`.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> breather = solve_breather(VdpChain(a=2.5, b=0.5, c=0.1))
    >>> [round(float(value), 4) for value in breather.amplitudes(2)]
    [2.8185, 0.2946]
    >>> solve_breather(VdpChain(a=2.5, b=0.5, c=0.1), Reading.CENTRE).status.value
    'none'
    """
    started = time.perf_counter()
    _check_range(chain)
    fold = closed_form_fold(chain, reading)
    if fold is None or chain.c > fold.c:
        return ClosedFormBreather(
            status=BreatherStatus.NONE,
            frequency=breather_frequency(chain),
            fold=fold,
            seconds=time.perf_counter() - started,
        )
    solve = _tail if reading is Reading.TAIL else _neighbour
    S, w, error = solve(chain, fold)
    alpha_0, decay = math.sqrt(S), math.sqrt(w)
    site = math.inf if reading is Reading.TAIL else 1.0
    residual = max(
        abs(decay_of_centre(alpha_0, chain) - decay),
        abs(tail_residual(alpha_0, decay, site, chain)),
    )
    return ClosedFormBreather(
        status=BreatherStatus.EXISTS,
        alpha_0=alpha_0,
        decay=decay,
        frequency=breather_frequency(chain),
        residual=residual,
        error=error,
        fold=fold,
        seconds=time.perf_counter() - started,
    )


def _check_range(chain: VanDerPolChain) -> None:
    if chain.c == 0:
        raise ParameterError("coupling c", 0, "positive for a breather", "give c > 0")
    remedy = (
        "take a larger coupling: at small c the decay equals c, and the centre is on the stable "
        "cycle"
    )
    at_least("coupling c", chain.c, SMALLEST_C, remedy)


@overload
def closed_form_fold(
    chain: VanDerPolChain, reading: Literal[Reading.NEIGHBOUR, Reading.TAIL] = ...
) -> ClosedFormFold: ...


@overload
def closed_form_fold(chain: VanDerPolChain, reading: Reading) -> ClosedFormFold | None: ...


def closed_form_fold(
    chain: VanDerPolChain, reading: Reading = Reading.NEIGHBOUR
) -> ClosedFormFold | None:
    """Return the largest coupling at which (29) and (37) have a solution; at the centre they never.

    For the reading ``tail`` it is known in closed form: c² = m(1 + m) with m = (a² - 8b)/(16 b).

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> round(closed_form_fold(VdpChain(a=2.5, b=0.5, c=0.1)).c, 6)
    0.197334
    >>> round(closed_form_fold(VdpChain(a=2.5, b=0.5, c=0.1), Reading.TAIL).c, 6)
    0.600293
    """
    at_least("eta = b/a^2", chain.eta, SMALLEST_ETA, "take a smaller a or a larger b")
    gap = discriminant(chain)
    if reading is Reading.CENTRE:
        return None
    if reading is Reading.TAIL:
        m = gap / (16.0 * chain.b)
        c = math.sqrt(m) * math.sqrt(1.0 + m)
        return ClosedFormFold(c=c, error=8.0 * EPS * c)
    branch = NeighbourBranch(chain.a, chain.b, gap)
    grid = np.linspace(math.log(branch.first), 0.0, _SCAN_POINTS)
    # the first decrease: c rises from zero, and decreases before S turns
    falling = np.flatnonzero(np.diff(branch.coupling(grid)) < 0.0)
    peak = max(int(falling[0]), 1)
    low, high = float(grid[peak - 1]), float(grid[min(peak + 1, _SCAN_POINTS - 1)])
    found = minimize_scalar(
        lambda t: -branch.coupling_at(t),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-10},
    )
    t = float(found.x)
    # SciPy stops at 1e-8 of t; one parabolic step makes the maximum accurate to rounding.
    below, middle, above = (branch.coupling_at(t + side * 1e-4) for side in (-1.0, 0.0, 1.0))
    t -= 0.5e-4 * (above - below) / (above - 2.0 * middle + below)
    c = branch.coupling_at(t)
    return ClosedFormFold(c=c, error=_NOISE * c, place=math.exp(t))


def _tail(chain: VanDerPolChain, fold: ClosedFormFold) -> tuple[float, float, float]:
    """Return S, w and their relative error for n → ∞: c z² + z - c = 0, then c z = G(S).

    G(S) = c z is b S² - 2a S + 8 + 16 c z = 0, whose discriminant, divided by 4, is
    a² - 8b - 16 b c z = 16 b (m - c z). With c z = (√(1 + 4c²) - 1)/2 and m as at the fold,

        m - c z = 2 (m (1 + m) - c²)/(2m + 1 + √(1 + 4c²)),

    whose numerator is computed in rational numbers, to avoid cancellation as c approaches the fold.
    """
    a, b, c = Fraction(chain.a), Fraction(chain.b), Fraction(chain.c)
    m = (a * a - 8 * b) / (16 * b)
    denominator = Fraction(2.0 * float(m) + 1.0) + Fraction(math.hypot(1.0, 2.0 * chain.c))
    radicand = 32 * b * (m * (1 + m) - c * c) / denominator
    root = math.sqrt(max(float(radicand), 0.0))
    error = 8.0 * EPS
    if radicand <= 0:
        # c is beyond the fold by the rounding error of the fold only. The breather at the fold is
        # returned; the rounding error of c moves it by an amount like the square root of the error.
        radicand_bound = 32 * b * 2 * c * Fraction(fold.error) / denominator
        error += math.sqrt(float(radicand_bound)) / chain.a
    z = 2.0 * chain.c / (1.0 + math.hypot(1.0, 2.0 * chain.c))
    return (chain.a + root) / chain.b, z * z, error


def _neighbour(chain: VanDerPolChain, fold: ClosedFormFold) -> tuple[float, float, float]:
    """Return S, w and their relative error for n = 1, on the branch before the fold."""
    branch = NeighbourBranch(chain.a, chain.b, discriminant(chain))
    c, t_fold = chain.c, math.log(fold.place)
    low = min(math.log(branch.first), branch.start_at(c))
    t = t_fold
    if branch.coupling_at(t_fold) > c:
        t = brentq(lambda x: branch.coupling_at(x) - c, low, t_fold, xtol=1e-15, rtol=4.0 * EPS)
    # The true t lies in an interval over which c - c(t) changes sign beyond its rounding error or,
    # near the fold, at both ends of which c(t) is below c by more than this error.
    half_width = 4.0 * EPS * max(1.0, abs(t))
    rounding = _NOISE * c
    for _ in range(60):
        c_above = branch.coupling_at(t + half_width)
        bracketed_above = (
            c_above > c + rounding or branch.coupling_at(max(t, t_fold) + half_width) < c - rounding
        )
        if branch.coupling_at(t - half_width) < c - rounding and bracketed_above:
            break
        half_width *= 2.0
    ends = [branch.squares(np.array([x])) for x in (t - half_width, t, t + half_width)]
    (S_low, s_low), (S, s), (S_high, s_high) = [(float(x[0]), float(y[0])) for x, y in ends]
    w = s / S
    relative_change = max(abs(S_low - S) / S, abs(S_high - S) / S, abs(s_low / S_low - w) / w)
    relative_change = max(relative_change, abs(s_high / S_high - w) / w)
    return S, w, relative_change + 16.0 * EPS
