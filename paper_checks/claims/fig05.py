"""Fig. 5: the map of states of the friction chain over (c, v_d)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._friction import SITES, arrivals_by_scipy, chain_of, disagreement
from paper_checks.claims._maps import FEW, REGIONS, LabelledMap
from paper_checks.report.state_picture import draw_states
from paper_checks.ruling import fails, holds
from verification.pictures.data_table import long_table
from verification.pictures.figures import new_axes, picture

COUPLINGS = (0.005, 0.015, 0.025, 0.035, 0.045, 0.055, 0.065, 0.075, 0.085, 0.095)
VELOCITIES = (1.05, 1.15, 1.25, 1.35, 1.45, 1.55, 1.65, 1.75, 1.85, 1.95)
"""Grid half as fine as a map of 20 by 20; ``fronts map friction`` draws any map."""
REFINED = 0.125
"""Fraction of the spacing to which boundaries are bisected."""
CHECKED = ((0.095, 1.05, 7), (0.095, 1.45, 1), (0.005, 1.55, 1))
"""c, v_d and the number of sites that stick by τ = 80: a front, steady sliding, a breather."""


@dataclass(frozen=True, kw_only=True)
class FrictionStateMap(LabelledMap):
    """Labels of the map, and the results of its check."""

    hopf: float
    cycle_end: float
    gap: float
    seen: tuple[int, ...]
    """Number of sites that stick at `CHECKED`, by scipy."""

    @property
    def widths(self) -> tuple[int, ...]:
        """Number of breathers in each column, in order of c."""
        c, label = self.states["c"], self.states["label"]
        return tuple(int(np.count_nonzero((label == "breather") & (c == x))) for x in COUPLINGS)

    @property
    def above(self) -> tuple[str, ...]:
        """Labels above the v_d at which the cycle of one cell ends."""
        high = self.states["v_d"] > self.cycle_end
        return tuple(sorted(set(self.states["label"][high].tolist())))


def state_map() -> FrictionStateMap:
    """Label a map of 10 by 10 points, bisect its boundaries, and check three points by scipy."""
    from verification.cells.friction import cycle_end_velocity
    from verification.execution.sweep import sweep
    from verification.maps.boundary import Bisection, boundary_lines
    from verification.maps.task import StateTask, state_points

    task = StateTask(chain=chain_of(0.0))
    points = state_points(task, {"c": COUPLINGS, "v_d": VELOCITIES})
    states = sweep(task, points, workers=1)
    lines = boundary_lines(states, ("c", "v_d"))
    cell = chain_of(0.0).cell
    return FrictionStateMap(
        states=states,
        boundary=sweep(Bisection(replace(task.alone(), end=4000.0), REFINED), lines, workers=1),
        hopf=cell.hopf_velocity,
        cycle_end=cycle_end_velocity(cell),
        gap=max(disagreement(chain_of(c, 7, v_d), (4,), 80.0) for c, v_d, _ in CHECKED),
        seen=tuple(
            int(np.isfinite(arrivals_by_scipy(chain_of(c, 7, v_d), (4,), 80.0)).sum())
            for c, v_d, _ in CHECKED
        ),
    )


def rule_map(e: FrictionStateMap) -> Ruling:
    """Rule: three regions; breathers only in the lower half, fewer as c grows, and finally none."""
    three = all(e.counts.get(name, 0) for name in REGIONS)
    shrinks = all(first >= second for first, second in pairwise(e.widths)) and e.widths[-1] == 0
    low = e.highest < 0.5 * COUPLINGS[-1]
    checked = e.gap < 1e-3 and e.seen == tuple(n for *_, n in CHECKED)
    if three and shrinks and low and checked and e.undecided <= FEW * e.points:
        return holds()
    return fails("the map does not have these three regions.")


def draw_map(e: FrictionStateMap) -> tuple[Picture, ...]:
    """Draw Fig. 5 with contours between the regions."""
    figure, axes = new_axes(
        "column", height=4.0, xlabel="coupling c", ylabel=r"belt velocity $\tilde{v}_d$"
    )
    drawn = draw_states(axes, e.states, "c", "v_d", e.boundary,
                        names={"fixed point": "steady sliding"})  # fmt: skip
    axes.set(xlim=(0.0, 0.1), ylim=(1.0, 2.0))
    axes.set(title=rf"$N_\mathrm{{dof}}$ = {SITES}, $N_\mathrm{{size}}$ = 1 (bulk)")
    for value, line, name in ((e.hopf, ":", "Hopf velocity"), (e.cycle_end, "-.", "cycle ends")):
        axes.axhline(value, color="0.4", lw=0.8, ls=line, label=f"{name}, one cell")
    figure.legend(loc="outside lower center", ncols=2, columnspacing=1.0)
    return (picture("fig05-states", figure, long_table(drawn)),)


LASTING = (1.1, 1.2, 1.25, 1.35, 1.45, 1.6, 1.9)
STRONG = 0.095
LATE, WINDOW = 12_000.0, 400.0
WIDE, WIDE_AT = 9, (1.38, 1.40)
"""A nucleus that at these belt velocities first fills the chain and then dies out."""


@dataclass(frozen=True, kw_only=True)
class Lasting:
    """What lasts at strong coupling: sites in stick-slip in the last window of a long run."""

    active: tuple[int, ...]
    """Number of sites at each of `LASTING`, from one site in the bulk."""
    wide_reached: tuple[int, ...]
    """Number of sites that ever stuck, from nine sites, at `WIDE_AT`."""
    wide_active: tuple[int, ...]
    """Number of sites that stick there in the last window."""
    gap: float


def _lasting(v_d: float, size: int) -> tuple[int, int]:
    """Return how many sites ever stuck, and how many stick in the last window."""
    from theory.chains.nucleus import Nucleus
    from verification.runs.excite import excite
    from verification.runs.friction_integration import FrictionIntegration

    chain = chain_of(STRONG, SITES, v_d)
    run = FrictionIntegration(chain, excite(chain, Nucleus(size).excited(SITES)), tolerance=1e-8)
    ever = np.zeros(SITES, dtype=bool)
    for end in (LATE - WINDOW, LATE):
        # Only sites active in the last window, of some sixty periods, count as lasting.
        run.arrivals[:] = np.nan
        run.advance_to(end)
        ever |= ~np.isnan(run.arrivals)
        if run.going_to_rest():
            return int(ever.sum()), 0
    return int(ever.sum()), int(np.count_nonzero(~np.isnan(run.arrivals)))


def lasting() -> Lasting:
    """Run chains at strong coupling to τ = 12000 and count what still sticks."""
    wide = [_lasting(v_d, WIDE) for v_d in WIDE_AT]
    return Lasting(
        active=tuple(_lasting(v_d, 1)[1] for v_d in LASTING),
        wide_reached=tuple(ever for ever, _ in wide),
        wide_active=tuple(active for _, active in wide),
        gap=max(disagreement(chain_of(STRONG, 7, v_d), (4,), 80.0) for v_d in (1.1, 1.45)),
    )


def rule_lasting(e: Lasting) -> Ruling:
    """Rule: all sites or none must last: all at low velocity and none at high velocity."""
    ends = all(n in (0, SITES) for n in e.active)
    falls = list(e.active) == sorted(e.active, reverse=True)
    if ends and falls and e.active[0] == SITES and e.active[-1] == 0 and e.gap < 1e-3:
        return holds()
    return fails("a part of the chain stays in stick-slip.")


CLAIMS = (
    Claim.beside(
        "fig05-regions", evidence=state_map, rule=rule_map, figure=draw_map, expensive=True
    ),
    Claim.beside("fig05-after-front", evidence=lasting, rule=rule_lasting),
)
