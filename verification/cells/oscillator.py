"""The cycles of one cell of an `OscillatorChain`, and what is stable."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from theory.cells.oscillator import OscillatorCycle
from theory.chains.oscillator import OscillatorChain
from theory.parameters import ParameterError, with_ranges, within
from verification.cells.result import CellCycle, CellStatus, OwnCell
from verification.cells.shooting import TOLERANCES, check_turns, shot_cycles


@with_ranges(tolerance=TOLERANCES)
def oscillator_cell(chain: OscillatorChain, tolerance: float) -> OwnCell:
    """Return all cycles of a cell of a chain; parameters that vary between sites are averaged.

    Parameters
    ----------
    chain : OscillatorChain
        A chain with inertia and without forces; its coupling has no effect.
    tolerance : float
        Relative tolerance of DOP853, {tolerance}.

    Raises
    ------
    ParameterError
        If the cell has no inertia, a force acts, or ε is so large that the limits ε → 0 do not lead
        to the cycles, that there are others, or that the cycles are too stiff.

    Examples
    --------
    >>> found = oscillator_cell(OscillatorChain(damping="v**2 - 1", c=0.0), 1e-12)
    >>> found.status.value, round(found.stable_cycle.amplitude, 4), found.error < 1e-9
    ('cycle only', 1.1547, True)
    """
    begin = perf_counter()
    within("tolerance", tolerance, *TOLERANCES)
    chain.check_unforced("the cycles of a cell without external forces")
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
    cycles = shot_cycles(chain.cell, chain.eps, tolerance)
    # If the linear damping is zero, weak nonlinear damping decides.
    rests = damping > 0.0 or (damping == 0.0 and not limits[0].stable)
    # Motion stays bounded, so the outermost cycle, if there is one, is stable.
    check_turns(chain.cell, chain.eps, cycles, rests)
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
    """Return the innermost cycle of a kind, counted from a given one outwards."""
    pairs = zip(cycles[above:], limits[above:], strict=True)
    return next((cycle for cycle, limit in pairs if limit.stable is stable), None)


def _status(rests: bool, stable: int) -> CellStatus:
    """Return the status of a cell with this number of stable cycles."""
    if stable == 0:
        return CellStatus.REST
    if stable > 1:
        return CellStatus.MULTISTABLE if rests else CellStatus.CYCLES
    return CellStatus.BISTABLE if rests else CellStatus.OSCILLATION
