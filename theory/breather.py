"""The closed form of the breather, Eqs. (9), (29), (30), (37), (38), for each reading of n in (37).

The unknowns are α_0 and z = e^{k_1}. Write S = α_0², w = z². Then (29) is c z = G(S) with
G = (-b S² + 2a S - 8)/16, and (37), with k_2 = -π/2, is

    ½ - a S w^n/8 + b S² w^{2n}/16 = (c/2)(1/z - z).                                          (37)

(37) holds at one site n at most; print leaves n open. The readings:

- ``centre``, n = 0. The left side is -G by definition, so -G = (G/2)(1/w - 1): G = 0 or w = -1.
  No solution.
- ``neighbour``, n = 1. A quadratic for S at given w,
  b[2w³ + 1 - w] S² - a[4w² + 2(1 - w)] S + 16w + 8(1 - w) = 0: the whole branch is explicit,
  with w as its parameter and c = G/√w.
- ``tail``, n → ∞. c = z/(1 - w), and (29) is b S² - 2a S + 8 + 16 w/(1 - w) = 0.

Each branch has a largest c, its fold; from w = 0 to there it starts from the cycle of one cell.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from theory.parameters import ParameterError
from theory.vdp_chain import VdpChain


class Reading(StrEnum):
    """At which site (37) is taken."""

    CENTRE = "centre"
    NEIGHBOUR = "neighbour"
    TAIL = "tail"


class BreatherStatus(StrEnum):
    """Whether there is a breather."""

    EXISTS = "exists"
    NONE = "none"


@dataclass(frozen=True)
class ClosedFormFold:
    """The largest coupling of the closed form.

    Attributes
    ----------
    c : float or None
        Dimensionless; None if the reading has no solution at any coupling.
    error : float
        Estimated error of ``c``.
    reading : Reading
        Where (37) was taken.
    """

    c: float | None
    error: float
    reading: Reading


@dataclass(frozen=True)
class ClosedFormBreather:
    """The closed form at one coupling.

    Attributes
    ----------
    status : BreatherStatus
        ``none`` beyond the fold, or for the reading ``centre``.
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
    fold : ClosedFormFold
        Where the branch ends.
    seconds : float
        Wall-clock time.
    """

    status: BreatherStatus
    alpha_0: float | None
    decay: float | None
    frequency: float
    phase_step: float
    residual: float
    fold: ClosedFormFold
    seconds: float

    def amplitudes(self, count: int) -> NDArray[np.float64]:
        """Return A_n = α_0 e^{k_1|n|} for n = 0 … count-1 (Eq. 38); empty if there is none."""
        if self.alpha_0 is None or self.decay is None:
            return np.empty(0)
        return np.array([self.alpha_0 * self.decay**n for n in range(count)])


def decay_of_centre(alpha_0: float, chain: VdpChain) -> float:
    """Return e^{k_1} = (-b α_0⁴ + 2a α_0² - 8)/(16 c) (Eq. 29)."""
    return _gain(alpha_0**2, chain) / chain.c


def breather_frequency(chain: VdpChain) -> float:
    """Return ω = 1 + εc (Eq. 30).

    Examples
    --------
    >>> breather_frequency(VdpChain(a=2.5, b=0.5, c=0.1, eps=0.01))
    1.001
    """
    return 1.0 + chain.eps * chain.c


def tail_residual(alpha_0: float, decay: float, site: float, chain: VdpChain) -> float:
    """Return left minus right side of (37) at a site, times -(c/2)(z - 1/z).

    Parameters
    ----------
    alpha_0, decay : float
        α_0 and z = e^{k_1}.
    site : float
        n; ``math.inf`` for the linear tail.
    chain : VdpChain
        a, b, c.
    """
    square = 0.0 if math.isinf(site) else alpha_0**2 * decay ** (2 * site)
    balance = 0.5 - chain.a * square / 8.0 + chain.b * square**2 / 16.0
    return balance - 0.5 * chain.c * (1.0 / decay - decay)


def solve_breather(chain: VdpChain, reading: Reading = Reading.NEIGHBOUR) -> ClosedFormBreather:
    """Solve (29) with (37) on the branch that starts from the stable cycle of one cell.

    Parameters
    ----------
    chain : VdpChain
        Needs two cycles (8b < a²) and c > 0.
    reading : Reading, optional
        Where (37) is taken.

    Raises
    ------
    ParameterError
        If the cell has no cycle, or c = 0.

    Examples
    --------
    >>> breather = solve_breather(VdpChain(a=2.5, b=0.5, c=0.1))
    >>> [round(float(value), 4) for value in breather.amplitudes(2)]
    [2.8185, 0.2946]
    >>> solve_breather(VdpChain(a=2.5, b=0.5, c=0.1), Reading.CENTRE).status.value
    'none'
    """
    started = time.perf_counter()
    if chain.c == 0:
        raise ParameterError("coupling c", 0, "positive for a breather", "give c > 0")
    fold = closed_form_fold(chain, reading)
    top = _top(chain, reading)
    frequency, step = breather_frequency(chain), -0.5 * math.pi
    if fold.c is None or top is None or chain.c > fold.c:
        seconds = time.perf_counter() - started
        return ClosedFormBreather(
            BreatherStatus.NONE, None, None, frequency, step, math.inf, fold, seconds
        )
    coupling = _coupling_along(chain, reading)
    # w falls like c² as c → 0, so the bracket is taken in log w.
    low = min(-2.0 * math.log(1e3 + 1e3 / chain.c), math.log(top) - 1.0)
    w = math.exp(
        brentq(lambda x: coupling(math.exp(x)) - chain.c, low, math.log(top), xtol=1e-15)
        if chain.c < fold.c
        else math.log(top)
    )
    alpha_0, decay = math.sqrt(_square(w, chain, reading)), math.sqrt(w)
    site = 1.0 if reading is Reading.NEIGHBOUR else math.inf
    residual = max(
        abs(decay_of_centre(alpha_0, chain) - decay),
        abs(tail_residual(alpha_0, decay, site, chain)),
    )
    return ClosedFormBreather(
        BreatherStatus.EXISTS,
        alpha_0,
        decay,
        frequency,
        step,
        residual,
        fold,
        time.perf_counter() - started,
    )


def closed_form_fold(chain: VdpChain, reading: Reading = Reading.NEIGHBOUR) -> ClosedFormFold:
    """Return the largest coupling at which (29) and (37) have a solution.

    For the reading ``tail`` it is known: c² = m(1 + m) with m = (a² - 8b)/(16 b).

    Examples
    --------
    >>> round(closed_form_fold(VdpChain(a=2.5, b=0.5, c=0.1)).c, 6)
    0.197334
    >>> round(closed_form_fold(VdpChain(a=2.5, b=0.5, c=0.1), Reading.TAIL).c, 6)
    0.600293
    """
    top = _top(chain, reading)
    if top is None:
        return ClosedFormFold(None, 0.0, reading)
    c = _coupling_along(chain, reading)(top)
    # A maximum is flat: its position is known to 1e-8, its height to rounding.
    return ClosedFormFold(c, 1e-13 * c, reading)


def _gain(square: float, chain: VdpChain) -> float:
    return (-chain.b * square**2 + 2.0 * chain.a * square - 8.0) / 16.0


def _square(w: float, chain: VdpChain, reading: Reading) -> float:
    """S = α_0² on the branch, at w = e^{2 k_1}; NaN where it has ended."""
    a, b = chain.a, chain.b
    if reading is Reading.TAIL:
        quadratic = (b, -2.0 * a, 8.0 + 16.0 * w / (1.0 - w))
    else:
        quadratic = (
            b * (2.0 * w**3 + 1.0 - w),
            -a * (4.0 * w**2 + 2.0 * (1.0 - w)),
            8.0 + 8.0 * w,
        )
    first, second, third = quadratic
    inside = second**2 - 4.0 * first * third
    return (-second + math.sqrt(inside)) / (2.0 * first) if inside >= 0.0 else math.nan


def _coupling_along(chain: VdpChain, reading: Reading) -> Callable[[float], float]:
    def coupling(w: float) -> float:
        if reading is Reading.TAIL:
            return math.sqrt(w) / (1.0 - w)
        square = _square(w, chain, reading)
        # Beyond the end of the branch: below every coupling on it.
        return -1.0 if math.isnan(square) else _gain(square, chain) / math.sqrt(w)

    return coupling


def _top(chain: VdpChain, reading: Reading) -> float | None:
    """W at the first maximum of c along the branch."""
    _ = chain.stable_amplitude
    if reading is Reading.CENTRE:
        return None
    if reading is Reading.TAIL:
        m = (chain.a**2 - 8.0 * chain.b) / (16.0 * chain.b)
        return m / (1.0 + m)
    coupling = _coupling_along(chain, reading)
    grid = np.geomspace(1e-8, 0.999, 400)
    values = np.array([coupling(float(w)) for w in grid])
    falling = np.flatnonzero(np.diff(values) < 0.0)
    if not falling.size:
        return None
    peak = max(int(falling[0]), 1)
    found = minimize_scalar(
        lambda x: -coupling(math.exp(x)),
        bounds=(math.log(grid[peak - 1]), math.log(grid[min(peak + 1, 399)])),
        method="bounded",
        options={"xatol": 1e-11},
    )
    return math.exp(float(found.x))
