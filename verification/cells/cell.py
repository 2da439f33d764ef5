"""``cell``: the possible states of one isolated oscillator of any chain."""

from __future__ import annotations

from theory.cells.friction import FrictionCell
from theory.chains.chain import Chain
from theory.chains.friction import FrictionChain
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError, check_progress, with_ranges
from verification.cells import friction, shooting
from verification.cells.friction import friction_cell
from verification.cells.oscillator import oscillator_cell
from verification.cells.result import TOLERANCE, Cell
from verification.cells.vdp import averaged_cell, vdp_cell
from verification.execution.progress import ProgressCallback


@with_ranges(friction=friction.TOLERANCES, shooting=shooting.TOLERANCES)
def cell(
    of: FrictionCell | Chain,
    *,
    tolerance: float = TOLERANCE,
    progress: ProgressCallback | None = None,
) -> Cell:
    """Return rest, cycles and basin of one cell, given directly or taken from a chain.

    Parameters
    ----------
    of : FrictionCell, FrictionChain, VdpChain, AveragedChain or OscillatorChain
        The cell of (5) at c = 0; of (8); of (43), where both cycles are known in closed form; or a
        user-defined one. Coupling, sites and ends of a chain have no effect.
    tolerance : float, optional
        Local error of the integration relative to the size of the cycle, {friction} (friction)
        or {shooting} (otherwise; smaller in proportion to weak damping); the cell of (43) does not
        depend on it. The stated errors are at least the differences from results at a hundred times
        this tolerance.
    progress : callable, optional
        Called at intervals with the fraction done of a friction cell, which takes minutes at strong
        damping.

    Returns
    -------
    Cell
        A `BeltCell` for friction, with the belt velocities at which its states begin and end; an
        `OwnCell` with all its cycles for a user-defined cell. Displacements, velocities and periods
        are dimensionless.

    Raises
    ------
    ParameterError
        If a parameter is so extreme that the cycles cannot be distinguished from round-off, the
        cell slips both ways for ever or has more than one cycle without stick, it is too stiff, or
        it has no inertia and therefore no cycles.

    References
    ----------
    Leine, van Campen, de Kraker and van den Steen (1998), for stick-slip by shooting with a switch;
    Hénon (1982), for sections of a numerical solution.

    Examples
    --------
    >>> found = cell(FrictionCell())
    >>> found.status.value, round(found.stable_cycle.period, 6), found.error < 1e-8
    ('bistable', 6.353749, True)
    >>> cell(VdpChain(a=1.0, b=0.2, c=0.0)).status.sentence
    'rest is stable, and there is no cycle.'
    """
    check_progress(progress)
    if isinstance(of, FrictionChain):
        of = of.cell
    if isinstance(of, FrictionCell):
        return friction_cell(of, tolerance, progress=progress)
    if isinstance(of, VdpChain):
        return vdp_cell(of.a, of.b, of.eps, tolerance)
    if isinstance(of, AveragedChain):
        return averaged_cell(of.a, of.b, of.eps)
    if isinstance(of, OscillatorChain):
        return oscillator_cell(of, tolerance)
    raise ParameterError(
        "cell", type(of).__name__, "a friction cell, or a chain of cells that have cycles",
        "give a FrictionCell, FrictionChain, VdpChain, AveragedChain or OscillatorChain",
    )  # fmt: skip
