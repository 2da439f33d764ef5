"""Fig. 5: the map of states of the friction chain over (c, v_d)."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.claims._friction import SITES, chain_of, disagreement
from paper_checks.data_table import long_table
from paper_checks.pictures import COLOURS, NO_NUMBERS, new_axes, picture
from paper_checks.state_picture import draw_states

COUPLINGS = (0.005, 0.015, 0.025, 0.035, 0.045, 0.055, 0.065, 0.075, 0.085, 0.095)
VELOCITIES = (1.05, 1.15, 1.25, 1.35, 1.45, 1.55, 1.65, 1.75, 1.85, 1.95)
"""Half as fine as the paper's map; ``fronts map friction`` draws all of it."""

REFINED = 0.125
"""Part of the spacing to which boundaries are bisected here."""

WIDE = 9
WIDE_COUPLINGS = (0.03, 0.06, 0.095)
CHECKED = ((0.095, 1.05), (0.095, 1.45), (0.005, 1.55))
"""A front, steady sliding, a breather, run by scipy as well on a short chain."""


@lru_cache(maxsize=1)
def _checked() -> float:
    """Compare arrivals with scipy, and count them: all sites of a front, else the nucleus only."""
    from paper_checks.claims._friction import arrivals_by_scipy

    for (c, v_d), expected in zip(CHECKED, (7, 1, 1), strict=True):
        seen = int(np.isfinite(arrivals_by_scipy(chain_of(c, 7, v_d), (4,), 80.0)).sum())
        if seen != expected:
            raise ArithmeticError(f"scipy sees {seen} sites stick at c = {c:g}, v_d = {v_d:g}")
    return max(disagreement(chain_of(c, 7, v_d), (4,), 80.0) for c, v_d in CHECKED)


def _regions() -> Finding:
    """Label a coarse map, bisect its boundaries, and look where breathers are."""
    from verification.execution.sweep import sweep
    from verification.maps.boundary import Bisection, boundary_lines
    from verification.maps.state_map import StateTask, state_points

    gap = _checked()
    task = StateTask(chain=chain_of(0.0, SITES))
    points = state_points(task, {"c": COUPLINGS, "v_d": VELOCITIES})
    states = sweep(task, points, workers=1)
    lines = boundary_lines(states, ("c", "v_d"))
    quick = replace(task.alone(), end=4000.0)
    boundary = sweep(Bisection(quick, REFINED), lines, workers=1)
    counts = states.counts("label")
    three = all(counts.get(name, 0) for name in ("front", "breather", "fixed point"))
    c, v_d, label = states["c"], states["v_d"], states["label"]
    highest = float(c[label == "breather"].max(initial=0.0))
    widths = [int(np.count_nonzero((label == "breather") & (c == value))) for value in COUPLINGS]
    shrinks = all(first >= second for first, second in pairwise(widths))
    end_of_cycle = _cycle_end()
    above = set(label[v_d > end_of_cycle].tolist())
    undecided = [
        f"({row['c']:g}, {row['v_d']:g}): {row['why']}"
        for row in states.rows()
        if row["label"] == "undecided"
    ]
    figure, axes = new_axes(
        "column", height=4.4, xlabel="coupling c", ylabel=r"belt velocity $\tilde{v}_d$"
    )
    draw_states(axes, states, "c", "v_d", boundary, {"fixed point": "steady sliding"})
    axes.set(xlim=(0.0, 0.1), ylim=(1.0, 2.0))
    hopf = chain_of(0.0).cell.hopf_velocity
    for value, line, name in ((hopf, ":", "Hopf"), (end_of_cycle, "--", "end of the cycle")):
        axes.axhline(value, color="0.5", lw=0.8, ls=line, label=f"{name}, one cell")
    figure.legend(loc="outside lower center", ncols=2, columnspacing=1.0)
    drawn = picture(
        "fig05-states",
        f"States of {SITES} oscillators, the middle one excited. Dashes: where the label changes, "
        "by bisection between neighbours of the grid. Axes, marks and colours are the paper's. "
        f"{NO_NUMBERS}",
        figure,
        long_table(
            {
                "states": states.columns(),
                "boundary": {name: boundary[name] for name in ("c", "v_d", "along", "at")},
                "Hopf, one cell": {"v_d": hopf},
                "end of the cycle, one cell": {"v_d": end_of_cycle},
            }
        ),
    )
    low_only = highest < 0.5 * max(COUPLINGS)
    holds = three and low_only and shrinks and above == {"fixed point"} and not undecided
    return Finding(
        verdict=Verdict.REPRODUCED if holds else Verdict.PARTIAL,
        value=", ".join(f"{number} {name}" for name, number in counts.items())
        + f" of {len(states)} points; breathers up to c = {highest:g} only",
        error=(
            f"{len(undecided)} points undecided; boundaries bisected at {len(lines)} places to "
            f"{REFINED:g} of the spacing"
        ),
        methods=(
            "Taylor steps from event to event, until a rule names the state; each start twice, "
            "the second time perturbed by 1e-6",
            f"DOP853 with located events at {len(CHECKED)} points, 7 sites: arrivals the same to "
            f"{gap:.0e}",
        ),
        tolerance=(
            "a region is missing if none of its labels is found; 'only for low coupling' fails if "
            "a breather is found beyond half of the couplings, 'shrinks' if they become more, and "
            "three regions are not all if any point is in none of them at τ = 10000"
        ),
        explanation=(
            f"Numbers of breathers in the columns of growing c: {', '.join(map(str, widths))}. "
            f"Above v_d = {end_of_cycle:.4f}, where the cycle of one cell ends, all points are in "
            "steady sliding. Below the Hopf velocity "
            f"{hopf:.4f} steady sliding is unstable by itself, coupled or not: there "
            "stick-slip fills the chain from any disturbance, and what the map shows as fronts "
            "needs no nucleus; nor can a breather live there. "
            + (
                f"In none of the three states at (c, v_d) = {'; '.join(undecided)}: a few sites "
                "stick on for ever, others now and then, and it is neither periodic nor a front. "
                "Model II has the same between its fronts and its rest (fig15-regions)."
                if undecided
                else ""
            )
        ),
        pictures=(drawn,),
    )


def _cycle_end() -> float:
    from verification.cells.friction import cycle_end_velocity

    return cycle_end_velocity(chain_of(0.0).cell)


def _fills(c: float, v_d: float, size: int) -> bool:
    from theory.chains.nucleus import Place
    from verification.thresholds.result import Definition
    from verification.thresholds.spreading import Spreading, spreads

    spreading = Spreading(size, Place.BULK, Definition.WHOLE, 2000.0)
    return spreads(chain_of(c, SITES, v_d), spreading)


def _last_velocity(c: float, size: int) -> tuple[float, float]:
    """Return v_d between which the chain is filled and is not, by bisection."""
    low, high = 1.2, 1.8
    while high - low > 5e-3:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _fills(c, middle, size) else (low, middle)
    return low, high


def _nucleation() -> Finding:
    """Compare where one site and where nine sites fill the chain."""
    gap = _checked()
    one = {c: _last_velocity(c, 1) for c in WIDE_COUPLINGS}
    wide = {c: _last_velocity(c, WIDE) for c in WIDE_COUPLINGS}
    last = WIDE_COUPLINGS[-1]
    fails = [c for c in WIDE_COUPLINGS if wide[c][0] > one[c][1]]
    figure, axes = new_axes(
        "column", xlabel="coupling c", ylabel=r"largest $\tilde{v}_d$ of a front"
    )
    for found, style, colour, name in (
        (one, "o-", "blue", "1 site excited"),
        (wide, "s--", "vermilion", f"{WIDE} sites excited"),
    ):
        middle = [0.5 * sum(found[c]) for c in WIDE_COUPLINGS]
        axes.plot(WIDE_COUPLINGS, middle, style, color=COLOURS[colour], label=name)
    axes.legend()
    drawn = picture(
        "fig05-nucleation",
        "Largest belt velocity at which stick-slip fills the chain by τ = 2000, from one site as "
        f"in Fig. 5 and from {WIDE}; the paper has the former only. {NO_NUMBERS}",
        figure,
        long_table(
            {
                name: {
                    "c": WIDE_COUPLINGS,
                    "v_d_filled": [found[c][0] for c in WIDE_COUPLINGS],
                    "v_d_not_filled": [found[c][1] for c in WIDE_COUPLINGS],
                }
                for name, found in (("1 site excited", one), (f"{WIDE} sites excited", wide))
            }
        ),
    )
    return Finding(
        verdict=Verdict.PARTIAL if fails else Verdict.REPRODUCED,
        value="; ".join(
            f"c = {c:g}: up to v_d = {one[c][0]:.3f} from 1 site, {wide[c][0]:.3f} from {WIDE}"
            for c in WIDE_COUPLINGS
        ),
        error="0.005 in v_d, the bracket; beyond it the chain may be filled again",
        methods=(
            "bisection over v_d of Taylor steps from event to event",
            f"DOP853 with located events at {len(CHECKED)} points, 7 sites: arrivals the same to "
            f"{gap:.0e}",
        ),
        tolerance="the brackets of 1 and of 9 sites must not overlap to count as different",
        explanation=(
            "The upper boundary of the fronts in Fig. 5 is where one site fails to start one, not "
            f"where there is none: at c = {last:g} a nucleus of {WIDE} still fills the chain at "
            f"v_d = {wide[last][0]:.3f}, where the map shows steady sliding from "
            f"{one[last][1]:.3f} on. The stronger the coupling, the more a single site loses to "
            "its neighbours. Between the boundary of the wide nucleus and the end of the cycle "
            f"at {_cycle_end():.3f} no front was seen from either."
        ),
        pictures=(drawn,),
    )


CLAIMS = (
    Claim(
        "fig05-regions",
        "Fig. 5, section 1.3",
        "The plane (c, v_d) has three regions: fronts, steady sliding, and breathers at low "
        "coupling only, which become fewer as c grows.",
        "at N_dof = 31, N_size = 1, c from 0 to 0.1, v_d from 1 to 2",
        Verdict.PARTIAL,
        "fronts map friction --c 0.005:0.095:10 --v-d 1.05:1.95:10 --refine 0.125 "
        "--picture map.png",
        _regions,
        weight=2,
        because=(
            "beside the three regions there are chains in which a few sites stick on without end, "
            "neither at a steady amplitude nor as a front."
        ),
    ),
    Claim(
        "fig05-nucleation",
        "Fig. 5, section 1.3",
        "At higher coupling the homogeneous state that remains is steady sliding where v_d is "
        "large.",
        None,
        Verdict.PARTIAL,
        "fronts map friction --c 0.095 --v-d 1.2:1.8:13 --nucleus 9",
        _nucleation,
    ),
)
