"""Fig. 15: the map of states of the Van der Pol chain over (η, c)."""

from __future__ import annotations

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.data_table import long_table
from paper_checks.pictures import NO_NUMBERS, new_axes, picture
from paper_checks.state_picture import draw_states

ETAS = (0.01, 0.03, 0.05, 0.07, 0.09, 0.11, 0.13)
COUPLINGS = (0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95)
"""The paper's points cannot be read; ``fronts map`` draws a finer grid."""

LARGEST_SHARE = 0.1
"""Share of points that may differ between (8) and its average: their boundaries are displaced by
O(ε_eff), up to one spacing of the grid at the smallest η, and about one point in ten is next to a
boundary."""


def _regions() -> Finding:
    """Label the map by both equations, and bisect its boundaries by the averaged one."""
    from theory.vdp_chain import effective_epsilon
    from verification.sweeps.boundary import Bisection, boundary_lines
    from verification.sweeps.sweep import sweep
    from verification.vdp.map import StateTask, compare, state_points
    from verification.vdp.run import Model

    points = state_points(ETAS, COUPLINGS)
    full = StateTask(Model.FULL)
    average = full.averaged()
    states = sweep(full, points, workers=1)
    averaged = sweep(average, points, workers=1)
    agreement = compare(states, averaged)
    if agreement.total - agreement.same > LARGEST_SHARE * agreement.total:
        raise ArithmeticError(
            f"the two equations differ at {agreement.total - agreement.same} of "
            f"{agreement.total} points: {agreement.differing}"
        )
    lines = boundary_lines(averaged, ("eta", "c"))
    boundary = sweep(Bisection(average.alone(), 1e-3), lines, workers=1)
    edge = [line for line in lines if line["along"] == "c" and line["eta"] == ETAS[0]]
    by_full, by_average = (
        sweep(Bisection(task.alone(), 1.0 / 16.0), edge, workers=1) for task in (full, average)
    )
    held = sweep(StateTask(Model.ENVELOPE, held="a", value=4.0), points, workers=1)
    other_reading = compare(averaged, held)
    counts = states.counts("label")
    ordered = all(_breathers_lowest(states["c"], states["label"], states["eta"] == e) for e in ETAS)
    highest = float(states["c"][states["label"] == "breather"].max(initial=0.0))
    three = all(counts.get(name, 0) for name in ("front", "breather", "fixed point"))
    band = sweep(average, state_points([0.1], np.linspace(0.3, 0.7, 9).tolist()), workers=1)
    figure, axes = new_axes("column", height=4.2, xlabel="η = b/a²", ylabel="coupling c")
    draw_states(axes, states, "eta", "c", boundary)
    axes.axvline(0.125, color="0.5", lw=0.8, ls=":", label="η = 1/8, the cycle ends")
    figure.legend(loc="outside lower center", ncols=2, columnspacing=1.0)
    drawn = picture(
        "fig15-states",
        "States of (8), 16 oscillators, the last one displaced by 6, b = 0.5. Lines: where the "
        "label of the averaged chain (43) changes, by bisection between neighbours of the grid. "
        f"Axes, marks and colours are the paper's. {NO_NUMBERS}",
        figure,
        long_table(
            {
                "states of (8)": states.columns,
                "boundary by (43)": {name: boundary[name] for name in ("eta", "c", "along", "at")},
            }
        ),
    )
    undecided = counts.get("undecided", 0)
    return Finding(
        verdict=Verdict.REPRODUCED if three and ordered else Verdict.PARTIAL,
        value=", ".join(f"{number} {label}" for label, number in counts.items())
        + f" of {len(states)} points; breathers up to c = {highest:g} only",
        error=(
            f"{undecided} points undecided; boundaries of the averaged chain bisected at "
            f"{len(lines)} places to {1e-3:g} of the spacing"
        ),
        methods=(
            "(8), an 8(5,3) Runge-Kutta pair, until a rule names the state; each start twice, "
            "the second time perturbed by 1e-6",
            f"the averaged chain (43): the same label at {agreement.same} of {agreement.total} "
            f"points, {agreement.contradicting} contradict",
        ),
        tolerance=(
            "a region is missing if none of its labels is found, and 'at low coupling only' fails "
            "if at any η a breather lies above another state"
        ),
        explanation=(
            "The paper does not give a and b for each η, and its displacement is not scaled. Here "
            f"b = 0.5 is held; with a = 4 held, {other_reading.same} of {other_reading.total} "
            "points keep their label. For η > 1/8 the averaged chain is certain to go to rest, "
            "since damping is positive at every amplitude. At the smallest η averaging is poor "
            f"(effective ε {effective_epsilon(full.chain(ETAS[0], 0.1)):.2g}): at η = {ETAS[0]:g} "
            f"breathers end at c = {by_full['at'][0]:.3f} by (8) and at c = "
            f"{by_average['at'][0]:.3f} by (43). Between fronts and fixed points three labels are "
            "not enough: at η = 0.1 by (43), "
            f"{band.counts('label').get('undecided', 0)} of {len(band)} couplings from 0.3 to 0.7 "
            "keep a few sites at the edge excited up to the end (slow time 1000), sending out "
            "pulses that die before the far end: neither a stationary breather nor a front. We "
            "call them undecided, and this grid passes them by. The likeness to Fig. 5 "
            "is judged with Fig. 5."
        ),
        pictures=(drawn,),
    )


def _breathers_lowest(c: np.ndarray, label: np.ndarray, column: np.ndarray) -> bool:
    """Tell whether in one column every breather is at a smaller coupling than all other states."""
    breathers = c[column & (label == "breather")]
    others = c[column & (label != "breather")]
    return bool(breathers.size == 0 or others.size == 0 or breathers.max() < others.min())


CLAIMS = (
    Claim(
        "fig15-regions",
        "Fig. 15",
        "The plane (η, c) has three regions: fronts, breathers at low coupling only, and the "
        "fixed point.",
        None,
        Verdict.REPRODUCED,
        "fronts map vdp --eta 0.01:0.13:7 --c 0.05:0.95:10 --refine 0 --picture map.png",
        _regions,
        expensive=True,
    ),
)
