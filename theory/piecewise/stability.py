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

_MARGIN = 1e-9
"""Distance of a multiplier from the unit circle below which stability is not decided."""
_PHASE_STEP, _MAX_PHASE_CHANGE = 1e-6, 1e-2
"""Changes of phase in the coefficients p_k over the shortest step in v by which differences are
taken, and over the largest error of v whose effect is still proportional to it."""


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
        because within the error of v a multiplier may lie on the unit circle or the rate of |φ| at
        the threshold may vanish, the series is too long (v above a few tens), or its terms
        underflow (v below 7e-4).
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
    phase = (1.0 + c / speed) * (1.0 + 1.0 / speed)  # change of phase in p_k per change of v
    if v_error * phase > _MAX_PHASE_CHANGE:
        return found
    step = max(v_error, _PHASE_STEP / phase)
    neighbour = Symbol.of(v + math.copysign(step, v), c) if v_error else symbol
    if neighbour is None:
        return found
    widened = symbol.up_to(neighbour, 2.0 * v_error / step)
    rate = float(symbol.q[0])
    rate_bound = symbol.uncertainty * math.exp(-0.5 / speed)  # |p_k| ≤ e^{-k/2v}
    if abs(rate) <= rate_bound + widened.spread[0]:
        return found
    if rate < 0.0:
        return replace(found, stable=False)
    if widened.zeros_within(1.0 / found.floor) == 0:
        return replace(found, stable=True)
    inside = widened.zeros_within(1.0 - _MARGIN)
    outside = widened.zeros_within(1.0 + _MARGIN)
    found = replace(found, stable=None if inside is None or inside != outside else inside == 0)
    nearest = symbol.nearest_zero(1.0 / found.floor)
    if nearest is None:
        return found
    w, error = nearest
    modulus = 1.0 / abs(w)
    error *= modulus**2
    if v_error:
        change = abs(1.0 / abs(neighbour.zero_near(w)) - modulus)
        error += 2.0 * v_error / step * change if math.isfinite(change) else math.inf
    if abs(modulus - 1.0) <= error:
        found = replace(found, stable=None)
    return replace(found, multiplier=modulus, angle=abs(cmath.phase(w)), error=float(error))
