"""Shooting for each cycle of the friction cell, once and at one tolerance (``friction``).

The stick-slip cycle passes through the point of release, so that the motion after a release gives
all of it without iteration. If the force on returning to ẏ = v_d is beyond -μ_st (possible for
large v_d or small μ_d), the cell slips forwards before it sticks. The unstable cycle never sticks;
its largest y is a fixed point of the map from one maximum to the next.
"""

from __future__ import annotations

import math
from functools import partial
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from theory.arrays import EPS
from theory.cells.friction import FrictionCell, stick_phase
from theory.cells.friction_law import FrictionLaw
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError
from verification.cells.result import TOLERANCE, CellCycle
from verification.runs.friction_integration import FrictionIntegration
from verification.steppers import friction_cell_phase as phases
from verification.steppers.friction_series import V_D, law_of, new_numbers, new_work, taylor_order

_LONGEST = 1e4
"""Time after which a slip phase is abandoned."""
_SETTLED = 1e-9
"""Part of the distance between release and steady sliding below which slip has settled there."""
_NO_CREEP = phases.Creep(sliding=0.0, lowest=0.0, rising=0.0, falling=0.0)
_MAX_TURNS = 100
ROUND_OFF = 1e-14
_FINEST = 1e-17
_TRIED = 60
_STRONG = 3.0
"""Drag relative to velocity at which slip is overdamped: more than 2, at which it is critical."""
_SMALL = 1e-3
"""Amplitude relative to v₀ or v_s below which the unstable cycle is taken from its expansion at the
Hopf velocity."""
_CONVERGENT = 0.1
"""Relative size of the next order up to which it bounds what the expansion leaves out."""


def _phase(
    cell: FrictionCell,
    y: float,
    w: float,
    released: bool,
    end: int,
    *,
    tolerance: float,
    direction: float = -1.0,
) -> tuple[float, float, float]:
    """Return τ, y, w at the end of a slip phase; direction 1 means slip forwards."""
    flip = -direction
    local = _local(cell, tolerance)
    numbers = new_numbers(cell, 0.0, local)
    numbers[V_D] *= flip
    phase = phases.Phase(
        numbers=numbers,
        law=law_of(cell),
        work=new_work(taylor_order(local)),
        released=released,
        end=end,
        longest=_LONGEST,
        creep=creep(cell) if direction < 0.0 else _NO_CREEP,
    )
    t, y, w = phases.follow(phase, flip * y, flip * w)
    return t, flip * y, flip * w


def creep(cell: FrictionCell) -> phases.Creep:
    """Return where backward slip approaches steady sliding without turning: at strong damping.

    Drag rises by at least `_STRONG` times the velocity outside an interval of speeds, found as that
    of unstable sliding is, with so much less damping. Above the interval, the condition holds for
    every slower speed if the drag gained by v_d/2 exceeds μ_st - μ_d, by which friction falls at
    most. The interval then ends below v_d/2, since the speed times the rate at which friction falls
    is less than μ_st - μ_d.
    """
    curve, v_d, sliding = cell.curve, cell.v_d, cell.steady_sliding
    damping = 2.0 * cell.xi - _STRONG
    if damping + cell.viscous <= 0.0:
        return _NO_CREEP
    low, high, _ = curve.unstable_sliding(damping)
    rising = falling = 0.0
    if v_d < low:
        rising, falling = math.inf, low - v_d
    elif v_d > high:
        everywhere = 2.0 * curve.drop <= (damping + cell.viscous) * v_d
        rising, falling = math.inf if everywhere or high == 0.0 else v_d - high, math.inf
    return phases.Creep(
        sliding=sliding, lowest=min(cell.release, sliding - v_d), rising=rising, falling=falling
    )


def cycle_turning_points(cell: FrictionCell, tolerance: float = TOLERANCE) -> tuple[float, float]:
    """Return the smallest and the largest y of the stick-slip cycle.

    Beyond the end of the cycle they are those of the slip phase that follows a release, with steady
    sliding, which it approaches, where this phase does not turn. Every run with excited sites needs
    them, so they are computed by the stepper that such a run uses anyway.

    Examples
    --------
    >>> low, high = cycle_turning_points(FrictionCell())
    >>> round(low, 6), round(high, 6)
    (-0.76708, 1.995817)
    """
    sliding = cell.steady_sliding
    if cell.v_d <= sliding - cell.release < creep(cell).rising:
        return sliding, sliding
    chain = FrictionChain.of(cell, c=0.0, sites=1)
    start = np.array([[cell.release], [cell.v_d]])
    run = FrictionIntegration(chain, start, tolerance=_local(cell, tolerance))
    # A slip phase lasts at least about two units from a minimum of y to the next maximum.
    while math.isnan(run.last_extremes[1, 0]) and run.time < _LONGEST:
        run.advance_to(run.time + 0.5)
    high, low = np.where(np.isnan(run.last_extremes), sliding, run.last_extremes)[:, 0]
    return float(low), float(high)


def _local(cell: FrictionCell, tolerance: float) -> float:
    """Return the allowed local error: small cycles scale with v_d, large ones with v_d and μ_st."""
    return max(_FINEST, tolerance * (cell.v_d if cell.v_d < 1.0 else max(cell.v_d, cell.mu_st)))


def largest_after_release(cell: FrictionCell, tolerance: float) -> float:
    """Return the first maximum of ẏ - v_d after release; negative if there is none.

    Raises
    ------
    ParameterError
        If slip still creeps on after the longest time, so that it is not known what follows.
    """
    t, y, w = _phase(cell, cell.release, 0.0, True, phases.FASTEST, tolerance=tolerance)
    left, way = (abs(each - cell.steady_sliding) for each in (y, cell.release))
    far = left > max(_SETTLED * way, ROUND_OFF * (cell.v_d + abs(y)))
    if t == phases.ABANDONED and w <= 0.0 and far:
        drag = 2.0 * cell.xi + cell.viscous
        raise ParameterError(
            "damping 2 xi + viscous", f"{drag:g} at v0 or v_s = {cell.curve.scale:g}",
            f"so weak that slip after a release ends within {_LONGEST:g} time units",
            "take less damping, or a larger reference velocity",
        )  # fmt: skip
    return w if t >= 0.0 or w > 0.0 else -cell.v_d


def stick_slip_once(cell: FrictionCell, tolerance: float) -> CellCycle | None:
    """Return the stick-slip cycle; None if the cell never sticks again.

    Its error contains the effect of round-off on the times at which slip ends only.

    Raises
    ------
    ParameterError
        If the cell continues to slip both ways and does not stick (little damping, large v_d).
    """
    y, slip, speed, direction, released = cell.release, 0.0, cell.v_d, -1.0, True
    lows, highs, blurred = [], [], 0.0
    for _ in range(_MAX_TURNS):
        t, end, _ = _phase(
            cell, y, 0.0, released, phases.TOUCH, tolerance=tolerance, direction=direction
        )
        if t < 0.0:
            return None
        if direction < 0.0:
            low, high = (
                _phase(cell, y, 0.0, released, turn, tolerance=tolerance)[1]
                for turn in (phases.LOWEST, phases.HIGHEST)
            )
            lows.append(low)
            highs.append(high)
        else:
            fastest = _phase(
                cell, y, 0.0, released, phases.SLOWEST, tolerance=tolerance, direction=direction
            )[2]
            speed = max(speed, cell.v_d + fastest)
        blurred += _rounding_of_touch(cell, end, direction)
        y, slip, released = end, slip + t, False
        stick = stick_phase(cell, y)
        if stick is not None:
            time = stick.duration
            return CellCycle(
                max=max(highs),
                min=min(lows),
                period=slip + time,
                stick_time=time,
                slip_time=slip,
                speed=speed,
                multiplier=0.0,
                multiplier_error=0.0,
                error=blurred,
            )
        direction = -direction
    raise never_sticks(cell)


def _rounding_of_touch(cell: FrictionCell, y: float, direction: float) -> float:
    """Return how far round-off of the velocity shifts the time at which slip ends at this y.

    The velocity meets that of the belt with the slope ẅ = ẏ', which vanishes at a grazing. There
    the velocity is a parabola of curvature v_d, and the time is shifted by the root of round-off.
    """
    rounding = ROUND_OFF * (cell.v_d + abs(y))
    drag = 2.0 * cell.xi * cell.v_d + y
    slope = abs(drag + direction * cell.curve.coefficient(0.0))
    grazing = math.sqrt(2.0 * rounding / cell.v_d)
    return min(2.0 * rounding / slope, grazing) if slope > 0.0 else grazing


def never_sticks(cell: FrictionCell) -> ParameterError:
    """Return the error for a cell that slips both ways for ever."""
    return ParameterError(
        "belt velocity v_d", f"{cell.v_d:g} at damping xi = {cell.xi:g}",
        "so low that the cell sticks after it has been released",
        "take a lower velocity or more damping",
    )  # fmt: skip


def _slip_from(
    cell: FrictionCell, y: float, end: int, tolerance: float
) -> tuple[float, float, float]:
    """Return τ, y, w at the end of a slip phase that begins at ẏ = 0."""
    return _phase(cell, y, -cell.v_d, False, end, tolerance=tolerance)


def _growth(cell: FrictionCell, y: float, tolerance: float) -> float:
    """Return the growth of a maximum y over one turn, relative to its distance from sliding.

    It is -1 if no maximum follows because the motion approaches sliding without turning, and 1 if
    none does because the motion, continued beyond the touch, leaves double precision.
    """
    t, top, w = _slip_from(cell, y, phases.HIGHEST, tolerance)
    if t >= 0.0 and math.isfinite(top):
        return float((top - y) / (y - cell.steady_sliding))
    return -1.0 if w <= 0.0 else 1.0


def _grows(cell: FrictionCell, y: float, tolerance: float) -> bool:
    """Return whether a maximum y of slip is followed by a larger one.

    It is if slip reaches the belt first: the cell then sticks, and is released on the stick-slip
    cycle. Slip continued beyond the touch does not show this, and may creep for a long time.
    """
    t, top, w = _slip_from(cell, y, phases.FASTEST, tolerance)
    if t >= 0.0 and w <= 0.0:
        t, top, _ = _phase(cell, top, w, False, phases.HIGHEST, tolerance=tolerance)
    return w > 0.0 or (t >= 0.0 and top > y)


def check_slip_cycles(cell: FrictionCell, tolerance: float) -> None:
    """Refuse a cell that has cycles without stick other than the unstable one.

    They are possible under Stribeck's law: its Hopf bifurcations are supercritical where v_d is
    below √1.5 v_s (d³μ/dv³ > 0 there), so that cycles without stick are stable and can meet others.

    Without damping and viscous friction there are none at any v_d: with
    E = ẏ²/2 + (y - μ(v_d))²/2, the rate dE/dt = ẏ (μ(v_d - ẏ) - μ(v_d)) is positive for ẏ of either
    sign, since μ decreases at every speed. For a fast belt the gain per turn would be lost in
    rounding errors.

    Raises
    ------
    ParameterError
        If there are any such cycles.
    """
    if cell.xi == 0.0 and cell.viscous == 0.0:
        return
    # Slip from the point of release that never sticks again and cannot end in steady sliding must
    # end in a cycle, however close to that point the cycle passes.
    if cell.effective_damping <= 0.0 and largest_after_release(cell, tolerance) <= 0.0:
        raise slips_in_a_stable_cycle(cell)
    _, outside = cycle_turning_points(cell, tolerance)
    reach = outside - cell.steady_sliding
    if reach == 0.0:  # the slip phase that ends in sliding without turning crosses every cycle
        return
    tried = cell.steady_sliding + np.geomspace(1e-3 * reach, 0.999 * reach, _TRIED)
    signs = [_grows(cell, float(y), tolerance) for y in tried]
    found = sum(one is not other for one, other in pairwise(signs))
    if found > (1 if cell.effective_damping > 0.0 else 0):
        raise slips_in_a_stable_cycle(cell)


def slips_in_a_stable_cycle(cell: FrictionCell) -> ParameterError:
    """Return the error for a cell with a stable cycle without stick."""
    return ParameterError(
        "belt velocity v_d", f"{cell.v_d:g} under {cell.law.value} friction",
        "one at which no cycle that slips all the time is stable", "take another velocity, or "
        "run a chain of one site, which is exact for every cycle",
    )  # fmt: skip


def grazing_slip(cell: FrictionCell) -> tuple[float, float] | None:
    """Return the turning points of slip that just touches ẏ = v_d (Coulomb); None if there is none.

    With 2ζ = 2ξ + κ slip is linear about steady sliding, ẅ + 2ζẇ + w = 0 for w = ẏ. Backwards in
    time from w = v_d, ẇ = 0, w vanishes after θ/ω and (θ + π)/ω, ω² = 1 - ζ², tan θ = ω/ζ, where y
    differs from steady sliding by -ẇ = ∓v_d e^{ζ(…)}.

    Examples
    --------
    >>> low, high = grazing_slip(FrictionCell(law="coulomb", xi=1e-9))
    >>> round(low, 6), round(high, 6)
    (-0.75, 1.75)
    """
    zeta = cell.xi + 0.5 * cell.viscous
    if zeta >= 1.0:
        return None
    omega = math.sqrt(1.0 - zeta * zeta)
    first = math.atan2(omega, zeta) / omega
    low, high = (cell.v_d * math.exp(zeta * t) for t in (first, first + math.pi / omega))
    return cell.steady_sliding - low, cell.steady_sliding + high


def unstable_once(cell: FrictionCell, tolerance: float) -> CellCycle | None:
    """Return the unstable cycle; its error contains the effect of round-off only.

    Raises
    ------
    ArithmeticError
        If the cycle must exist but cannot be found.
    """
    if cell.effective_damping <= 0.0 or largest_after_release(cell, tolerance) <= 0.0:
        return None
    centre = cell.steady_sliding
    small = _amplitude_near_hopf(cell)
    if small < _SMALL * cell.curve.scale:
        return _expanded(cell, small)
    fine = max(_FINEST, tolerance * min(1.0, small * small))
    growth = partial(_growth, cell, tolerance=fine)

    def following(y: float, end: int) -> tuple[float, float, float]:
        return _slip_from(cell, y, end, fine)

    _, outside, _ = _phase(cell, cell.release, 0.0, True, phases.HIGHEST, tolerance=fine)
    inside = centre + min(0.3 * small, 1e-3 * (outside - centre))
    if growth(inside) >= 0.0:
        raise ArithmeticError(f"no unstable cycle found at v_d = {cell.v_d!r}")
    if growth(outside) <= 0.0:
        # At grazing both cycles coincide to within round-off.
        y = outside
    else:
        y = float(brentq(growth, inside, outside, xtol=1e-15, rtol=9e-16))
    period, _, _ = following(y, phases.HIGHEST)
    _, low, _ = following(y, phases.LOWEST)
    _, _, fastest = following(low, phases.FASTEST)
    step = 1e-5 * (y - centre)
    ahead, behind, farther, opposite = (
        (following(y + each, phases.HIGHEST)[1] - y) / each
        for each in (step, -step, 2.0 * step, -2.0 * step)
    )
    # Where the cycle nearly touches, the step is too large for a finite difference.
    resolved = abs(ahead - behind) < 1e-2 * ahead
    multiplier, wider = 0.5 * (ahead + behind), 0.5 * (farther + opposite)
    size = max(abs(y), abs(low), cell.v_d)
    rounding = ROUND_OFF * size / step
    # Round-off shifts the fixed point by a relative amount 1/(multiplier - 1).
    blurred = 0.1 * ROUND_OFF * max(1.0, size) / math.expm1(period * cell.effective_damping)
    return CellCycle(
        max=y,
        min=low,
        period=period,
        slip_time=period,
        speed=fastest + cell.v_d,
        multiplier=multiplier if resolved else None,
        # Twice the step errs four times as much.
        multiplier_error=abs(wider - multiplier) + rounding if resolved else None,
        error=blurred,
    )


def _amplitude_near_hopf(cell: FrictionCell) -> float:
    """Return √(8δ/F₃) of the unstable cycle, δ being the effective damping; inf far from there.

    From averaging ü + u = -δu̇ + F₂u̇²/2 + F₃u̇³/6 over a cycle u̇ = -A sin τ.
    """
    third = -cell.curve.third_derivative(cell.v_d)
    return math.sqrt(8.0 * cell.effective_damping / third) if third > 0.0 else math.inf


def _rounding_near_hopf(cell: FrictionCell, amplitude: float) -> float:
    """Return how far round-off of the effective damping δ changes the amplitude √(8δ/F₃).

    Near the Hopf velocity δ is the small difference of 2ξ + κ and the fall of friction.
    """
    steepness = (cell.v_d / cell.curve.scale) ** (2 if cell.law is FrictionLaw.STRIBECK else 1)
    falling = abs(cell.curve.slope(cell.v_d) - cell.viscous)
    rounding = EPS * falling * (5.0 + 2.0 * steepness)
    # Of δ ± r, |√(δ ± r) - √δ| is at most √r, and at most r/√δ.
    part = rounding / abs(cell.effective_damping)
    return amplitude * min(part, math.sqrt(part))


def _expanded(cell: FrictionCell, amplitude: float) -> CellCycle:
    """Return the unstable cycle to second order in its amplitude; its error field is a bound.

    The quadratic term shifts both turning points by F₂A²/3 (mean 1/4, second harmonic 1/12).
    """
    second = cell.curve.curvature(cell.v_d)
    shift = second * amplitude**2 / 3.0
    centre = cell.steady_sliding + shift
    period = 2.0 * math.pi
    growth = math.exp(period * cell.effective_damping)
    left_out = amplitude**2 * (second**2 + 10.0 * amplitude / cell.curve.scale**2)
    left_out += _rounding_near_hopf(cell, amplitude)
    squared = amplitude**2 * (second**2 + 10.0 / cell.curve.scale**2)
    # The error of the exponent is relative, of the next order in the square of the amplitude.
    off = math.expm1(2.0 * squared * math.log(growth)) if squared < _CONVERGENT else math.inf
    return CellCycle(
        max=centre + amplitude,
        min=centre - amplitude,
        period=period,
        slip_time=period,
        speed=amplitude,
        multiplier=growth,
        multiplier_error=growth * off + ROUND_OFF,
        error=left_out,
    )
