"""Linear stability of the fronts of (44): the multipliers of perturbations of the switching times.

The multipliers are the zeros of the symbol (``theory.piecewise.symbol``). The coupling c_stable, at
which one of them first leaves the unit circle, is found in ``theory.piecewise.stability_limit``.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace

from theory.parameters import number, within
from theory.piecewise.roots import PARAMETERS
from theory.piecewise.symbol import Symbol, terms_at

_ROOM = 1e-9
"""Distance of a multiplier from the unit circle below which stability is not decided."""
_BESIDE = 1e-6
"""Relative step of the difference by which a multiplier depends on v."""


@dataclass(frozen=True, kw_only=True)
class FrontStability:
    """Linear stability of one travelling front.

    Attributes
    ----------
    floor : float
        e^{-1/4v}, below which no multiplier is searched for; the memory of earlier switchings
        decays like its square per site.
    terms : int
        Number of terms p_k of the symbol.
    stable : bool or None
        Whether every perturbation of the switching times decays; None where this was not decided,
        because a multiplier lies on the unit circle or |φ| passes the threshold at no rate to
        within its error, the series is too long (v above a few tens), or its terms underflow (v
        below 7e-4).
    multiplier : float or None
        Largest modulus of a multiplier per site other than the trivial one; None where all are
        below ``floor``, or none could be determined.
    angle : float or None
        Its argument, in radians per site from 0 to π; π means a perturbation of alternating sign.
    error : float or None
        Error of ``multiplier``: a bound for the given v, plus the effect of the error of v to first
        order.
    """

    floor: float
    terms: int
    stable: bool | None = None
    multiplier: float | None = None
    angle: float | None = None
    error: float | None = None


def front_stability(v: float, c: float, v_error: float = 0.0) -> FrontStability:
    """Return the linear stability of the front of velocity v (a solution of Eq. 54).

    Parameters
    ----------
    v, c : float
        Front velocity v̂ (negative where the excited state retreats) and coupling, dimensionless.
    v_error : float
        Error of v.

    Returns
    -------
    FrontStability

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Notes
    -----
    The result refers to small perturbations of the switching times and presupposes (47).

    Examples
    --------
    >>> front_stability(0.300992350758521, 0.5).stable
    True
    """
    v = number("velocity v", v)
    speed = within("velocity |v|", abs(v), *PARAMETERS)
    c = within("coupling c", c, *PARAMETERS)
    found = FrontStability(floor=math.exp(-0.25 / speed), terms=terms_at(speed))
    symbol = Symbol.of(v, c)
    if symbol is None:
        return found
    rate = float(symbol.q[0])
    off = symbol.uncertainty * math.exp(-0.5 / speed)  # |p_k| ≤ e^{-k/2v}
    if v_error:
        off += v_error * _rate_by_v(v, c, rate)
    if abs(rate) <= off:
        return found
    if rate < 0.0:
        return replace(found, stable=False)
    if symbol.zeros_within(1.0 / found.floor) == 0:
        return replace(found, stable=True)
    inside = symbol.zeros_within(1.0 - _ROOM)
    outside = symbol.zeros_within(1.0 + _ROOM)
    found = replace(found, stable=None if inside is None or inside != outside else inside == 0)
    nearest = symbol.nearest_zero(1.0 / found.floor)
    if nearest is None:
        return found
    w, error = nearest
    modulus = 1.0 / abs(w)
    error *= modulus**2
    if v_error:
        error += v_error * _by_v(v, c, w)
    if abs(modulus - 1.0) <= error:
        found = replace(found, stable=None)
    return replace(found, multiplier=modulus, angle=abs(cmath.phase(w)), error=float(error))


def _rate_by_v(v: float, c: float, rate: float) -> float:
    """Return |dΣp_k/dv|, doubled, by a one-sided difference from its value ``rate`` at v."""
    beside = v * (1.0 + _BESIDE)
    symbol = Symbol.of(beside, c)
    return 2.0 * abs(float(symbol.q[0]) - rate) / abs(beside - v) if symbol else math.inf


def _by_v(v: float, c: float, w: complex) -> float:
    """Return |d|z|/dv| of the multiplier z = 1/w, doubled, by a one-sided difference."""
    beside = v * (1.0 + _BESIDE)
    symbol = Symbol.of(beside, c)
    moved = math.nan if symbol is None else abs(symbol.zero_near(w))
    change = abs(1.0 / moved - 1.0 / abs(w))
    return 2.0 * change / abs(beside - v) if math.isfinite(change) else math.inf
