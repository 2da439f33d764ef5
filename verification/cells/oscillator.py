"""Cycles of one cell of an `OscillatorChain`, by shooting.

    ÿ + g(y) + ε h(y, ẏ) ẏ = 0

To leading order in ε they are in ``theory.cells.oscillator``. The true cycles are fixed points of
the map from one maximum of y to the next, taken by scipy's DOP853.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from theory.arrays import FloatArray
from theory.cells.oscillator import OscillatorCycle
from theory.chains.oscillator import OscillatorChain
from theory.parameters import ParameterError, within
from verification.cells.result import CellCycle, CellStatus, OwnCell
from verification.cells.vdp import ROUNDING, Maximum, longest_step

_STIFFEST = 60.0
"""Largest ε max|h| on a cycle: DOP853 takes half a minute there."""
_WIDTHS = (1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.2, 0.4)
"""Relative distances from the limit of ε → 0 at which the cycle is looked for."""
_SHIFT = 1e-4
"""Relative step of the difference that gives the multiplier."""
_CURVED = 1e-2
"""Relative difference of the two one-sided differences from which they resolve no multiplier."""
_CLOSED = 1e-3
"""Relative distance of a fixed point from where its turn ends, above which it is a jump."""


def oscillator_cell(chain: OscillatorChain, tolerance: float = 1e-12) -> OwnCell:
    """Return all cycles of a cell of a chain, at the mean of what differs from site to site.

    Parameters
    ----------
    chain : OscillatorChain
        With inertia and without forces; its coupling plays no role.
    tolerance : float
        Relative tolerance of DOP853, from 1e-13 to 1e-6.

    Raises
    ------
    ParameterError
        If it has no inertia, a force acts, or ε is so large that the limits of ε → 0 do not lead
        to the cycles, or that these are too stiff.

    Examples
    --------
    >>> found = oscillator_cell(OscillatorChain(damping="v**2 - 1", c=0.0))
    >>> found.status.value, round(found.stable_cycle.amplitude, 4), found.error < 1e-9
    ('cycle only', 1.1547, True)
    """
    begin = perf_counter()
    within("tolerance", tolerance, 1e-13, 1e-6)
    chain.check_unforced("the cycles of a cell, which is left alone")
    if chain.overdamped:
        raise ParameterError(
            "overdamped", "true", "false for cycles: without inertia a cell only has rest states",
            "take the chain's stable_amplitude and unstable_amplitude, which are those",
        )  # fmt: skip
    damping = chain.eps * float(chain.cell.damping_at(np.zeros(1), np.zeros(1))[0])
    limits = chain.cell.cycles
    if damping == 0.0 and not limits:
        raise ParameterError(
            "damping at rest", 0, "other than zero in a cell without cycles, so that rest is "
            "stable or not", "add a damping",
        )  # fmt: skip
    cycles = tuple(_cycle(chain, at, tolerance) for at in range(len(limits)))
    # A weak nonlinear damping decides where the linear one is zero.
    rests = damping > 0.0 or (damping == 0.0 and not limits[0].stable)
    # Motion stays bounded, so that the outermost cycle is stable if there is one.
    unstable = _first(cycles, limits, stable=False, above=0)
    inner = 0 if unstable is None else cycles.index(unstable)
    stable = _first(cycles, limits, stable=True, above=inner)
    return OwnCell(
        model=chain.model,
        parameters=chain.parameters(),
        status=_status(rests, sum(each.stable for each in limits)),
        steady_sliding=None,
        effective_damping=damping,
        stable_cycle=stable,
        unstable_cycle=unstable,
        cycles=cycles,
        seconds=perf_counter() - begin,
    )


def _first(
    cycles: tuple[CellCycle, ...], limits: tuple[OscillatorCycle, ...], *, stable: bool, above: int
) -> CellCycle | None:
    """Return the innermost cycle of a kind, from a place on."""
    pairs = zip(cycles[above:], limits[above:], strict=True)
    return next((cycle for cycle, limit in pairs if limit.stable is stable), None)


def _status(rests: bool, stable: int) -> CellStatus:
    """Return the status of a cell with so many stable cycles."""
    if stable == 0:
        return CellStatus.REST
    if stable > 1:
        return CellStatus.MULTISTABLE if rests else CellStatus.CYCLES
    return CellStatus.BISTABLE if rests else CellStatus.OSCILLATION


class _Minimum:
    """An event for scipy: ẏ rises through 0."""

    direction, terminal = 1.0, False

    def __call__(self, t: float, z: FloatArray) -> float:
        return float(z[1]) if t > 0.0 else 1.0


@dataclass(frozen=True, kw_only=True)
class _Turn:
    """A turn from one maximum of y to the next: that, the minimum between, the time."""

    top: float
    bottom: float
    period: float


def _turn(chain: OscillatorChain, y: float, period: float, tolerance: float) -> _Turn:
    """Return the turn that begins at rest at y.

    A motion that creeps to rest without turning ends at 0, one that leaves all bounds at infinity;
    neither has a period.
    """
    force, eps = chain.cell.force, chain.eps

    def rate(_: float, z: FloatArray) -> list[float]:
        y, v = z.tolist()
        return [v, -force(y, v, eps)]

    with np.errstate(over="ignore", invalid="ignore"):
        run = solve_ivp(
            rate, (0.0, 100.0 * period), [y, 0.0], "DOP853", events=(Maximum(), _Minimum()),
            rtol=tolerance, atol=1e-2 * tolerance * y,
            max_step=period / 30.0 * longest_step(tolerance),
        )  # fmt: skip
    lowest: list[FloatArray] = list(run.y_events[1]) if run.y_events is not None else []
    if run.status != 1 or not lowest:
        rests = run.status == 0 and abs(run.y[0, -1]) < y
        return _Turn(top=0.0 if rests else math.inf, bottom=math.nan, period=math.inf)
    bottom = float(lowest[0][0])
    return _Turn(top=float(run.y[0, -1]), bottom=bottom, period=float(run.t[-1]))


def _cycle(chain: OscillatorChain, at: int, tolerance: float) -> CellCycle:
    """Return one cycle with its error, from its limit as ε → 0."""
    limits = chain.cell.cycles
    _check_stiffness(chain, limits[at])
    fine, coarse = (_fixed(chain, at, each) for each in (tolerance, 100.0 * tolerance))
    turn, other = (
        _turn(chain, y, limits[at].period, each)
        for y, each in ((fine, tolerance), (coarse, 100.0 * tolerance))
    )
    shift = _SHIFT * fine
    ahead, behind = (
        (_turn(chain, fine + each, limits[at].period, tolerance).top - turn.top) / each
        for each in (shift, -shift)
    )
    resolved = abs(ahead - behind) < _CURVED * max(1.0, abs(ahead))
    gaps = (fine - coarse, turn.bottom - other.bottom, turn.period - other.period)
    return CellCycle(
        max=fine,
        min=turn.bottom,
        period=turn.period,
        slip_time=turn.period,
        multiplier=0.5 * (ahead + behind) if resolved else None,
        averaged=limits[at].amplitude,
        error=max(*(abs(each) for each in gaps), ROUNDING * turn.period),
    )


def _check_stiffness(chain: OscillatorChain, limit: OscillatorCycle) -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 200)
    h = chain.cell.damping_at(limit.amplitude * np.sin(angle), limit.velocity * np.cos(angle))
    stiffness = chain.eps * float(np.max(np.abs(h)))
    if stiffness > _STIFFEST:
        raise ParameterError(
            "eps max|h| on a cycle", f"{stiffness:.4g}", f"at most {_STIFFEST:g} for a true cycle",
            "take a smaller eps",
        )  # fmt: skip


def _fixed(chain: OscillatorChain, at: int, tolerance: float) -> float:
    """Return the largest y of a cycle: a fixed point between the cycles beside it."""
    amplitudes = [each.amplitude for each in chain.cell.cycles]
    guess, period = amplitudes[at], chain.cell.cycles[at].period
    low = math.sqrt(amplitudes[at - 1] * guess) if at else 0.0
    high = math.sqrt(amplitudes[at + 1] * guess) if at + 1 < len(amplitudes) else math.inf

    def growth(y: float) -> float:
        top = _turn(chain, y, period, tolerance).top
        return top / y - 1.0 if math.isfinite(top) else 1.0

    for width in _WIDTHS:
        ends = max(low, guess * (1.0 - width)), min(high, guess * (1.0 + width))
        if growth(ends[0]) * growth(ends[1]) < 0.0:
            found = float(brentq(growth, *ends, xtol=1e-14 * guess, rtol=1e-14))
            if abs(growth(found)) < _CLOSED:
                return found
            break
    raise ParameterError(
        "small parameter eps", chain.eps, "small enough for averaging to point at the cycles",
        "take a smaller eps, or parameters further from where cycles meet",
    )  # fmt: skip
