"""Fig. 17: front velocity against coupling in the simplified model, by (54) and (47)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._required import required
from paper_checks.report.velocity_plot import (
    PlottedSolutions,
    curve_of,
    draw_curve,
    draw_runs,
    draw_thresholds,
)
from paper_checks.ruling import fails, holds
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_panels, picture

if TYPE_CHECKING:
    from verification.piecewise.run import FrontRun
    from verification.piecewise.simulation import Hysteresis

A, B = 4.0, 0.5
ETA = B / A**2
WINDOW = 0.05
"""Tolerance of the exponent: a tenth of the difference between linear and square root."""
AGREE = 1e-9
"""Tolerance of v: far above the uncertainty of a steady run."""
RUNS = (0.44, 0.46, 0.5, 0.7, 1.0, 1.4, 1.8, 2.2, 2.6, 3.0)
LAST = 1e4


@dataclass(frozen=True, kw_only=True)
class PiecewiseScaling:
    """The fastest solution of (54) up to c = 10⁴, and runs of the chain (44)."""

    c: tuple[float, ...]
    v: tuple[float, ...]
    exponent: tuple[float, ...]
    by_series: float
    """The last exponent, by finite differences of the root series."""
    limit: float
    """V of v̂ → V√c in closed form."""
    runs: tuple[FrontRun, ...]
    theory: tuple[float, ...]
    """The fastest admissible solution at the coupling of each run."""
    solutions: PlottedSolutions
    """Every solution of (54) up to c = 3."""
    near: PlottedSolutions
    """Every solution close to the thresholds."""
    c_fold: float | None
    c_pin: float | None
    hysteresis: Hysteresis
    """The chain with slowly decreasing coupling, and from rest, close to the thresholds."""

    @property
    def last(self) -> float:
        """D ln v̂/d ln c at c = 10⁴."""
        return self.exponent[-1]

    @property
    def gap(self) -> float:
        """Largest difference between a steady run and theory."""
        pairs = zip(self.runs, self.theory, strict=True)
        return max(abs(required(run.v, "velocity") - v) for run, v in pairs if run.steady)

    @property
    def series_gap(self) -> float:
        """Difference between the two exponents."""
        return abs(self.last - self.by_series)

    @property
    def linear_range(self) -> tuple[float, float]:
        """Couplings below the resonances between which the exponent is within 0.1 of one."""
        c, off = np.array(self.c), np.abs(np.array(self.exponent) - 1.0) - 0.1
        within = np.flatnonzero((off < 0.0) & (c < 5.0))

        def edge(k: int) -> float:
            """Return where the line through two points of the exponent leaves this range."""
            return float(c[k] - off[k] * (c[k + 1] - c[k]) / (off[k + 1] - off[k]))

        return edge(within[0] - 1), edge(within[-1])


@lru_cache(maxsize=1)
def scaling() -> PiecewiseScaling:
    """Follow d ln v/d ln c along the fastest branch, and run the chain."""
    from theory.piecewise.kinetic_relation import kinetic_relation, trace_kinetic_relation
    from theory.piecewise.limits import strong_coupling_velocity
    from verification.piecewise.simulation import hysteresis, simulate_front

    # Between c = 3 and 100 there are narrow resonance peaks, which need many points.
    grid = np.unique(np.concatenate([np.geomspace(0.46, 3.0, 60), np.geomspace(3.0, 100.0, 300),
                                     np.geomspace(100.0, LAST, 60)]))  # fmt: skip
    wide = trace_kinetic_relation(grid, ETA, admissibility=False)
    fastest = [(answer.c, answer.branches[-1]) for answer in wide]
    c, v = fastest[-1][0], fastest[-1][1].v
    admissible = [
        [b.v for b in kinetic_relation(x, ETA).branches if b.admissible][-1] for x in RUNS
    ]
    drawn = trace_kinetic_relation(np.linspace(0.42, 3.0, 130), ETA)
    return PiecewiseScaling(
        c=tuple(each for each, _ in fastest),
        v=tuple(branch.v for _, branch in fastest),
        exponent=tuple(branch.by_c * each / branch.v for each, branch in fastest),
        by_series=_exponent_by_series(c, v),
        limit=required(strong_coupling_velocity(ETA), "law for strong coupling"),
        runs=tuple(simulate_front(each, ETA) for each in RUNS),
        theory=tuple(admissible),
        solutions=curve_of(drawn, "c"),
        near=curve_of(trace_kinetic_relation(np.linspace(0.4335, 0.499, 250), ETA), "c"),
        c_fold=drawn[0].c_fold,
        c_pin=drawn[0].c_pin,
        hysteresis=hysteresis(ETA, np.arange(0.43, 0.4961, 0.006).tolist()),
    )


def _exponent_by_series(c: float, v: float) -> float:
    """Return d ln v/d ln c = -|Σ|_{ln c}/|Σ|_{ln v} by finite differences of the root series."""
    from theory.piecewise.sums.series import sum_by_roots

    def size(v_: float, c_: float) -> float:
        return float(abs(sum_by_roots(v_, c_).value))

    h = 1e-4
    by_c = size(v, c * (1 + h)) - size(v, c * (1 - h))
    by_v = size(v * (1 + h), c) - size(v * (1 - h), c)
    return -by_c / by_v


def rule_scaling(e: PiecewiseScaling) -> Ruling:
    """Rule: the exponent must tend to one; both methods and the chain must agree."""
    if e.gap < AGREE and e.series_gap < 1e-5 and abs(e.last - 1.0) < WINDOW:
        return holds()
    return fails(
        "for large c the velocity grows like √c, and is nearly linear over a short range only."
    )


def draw_scaling(e: PiecewiseScaling) -> tuple[Picture, ...]:
    """Draw Fig. 17 with every solution, its end near the fold, and the exponent."""
    return draw_velocities(e), draw_exponent(e)


def draw_velocities(e: PiecewiseScaling) -> Picture:
    """Draw Fig. 17, and the hysteresis at its left end."""
    figure, (first, second) = new_panels(2, width="page", height=2.7)
    draw_curve(first, e.solutions)
    draw_curve(second, e.near)
    curves = Curves({
        "solutions of (54)": e.solutions.columns("c"), "near the thresholds": e.near.columns("c"),
    })  # fmt: skip
    settled = curves.add("chain, steady", c=[run.coupling for run in e.runs if run.steady],
                         v=[run.v for run in e.runs if run.steady])  # fmt: skip
    draw_runs(first, *settled, "s", "chain (44), steady")
    draw_thresholds(second, {"fold": e.c_fold, "pin": e.c_pin}, "c")
    both = e.hysteresis
    for runs, mark, name in (
        (both.moving, "s", "chain, moving start"), (both.resting, "x", "chain, resting start"),
    ):  # fmt: skip
        found = curves.add(name, c=both.couplings, v=[run.v for run in runs])
        draw_runs(second, *found, mark, name)
    for axes, title in ((first, r"$a$ = 4, $b$ = 0.5"), (second, "near the thresholds")):
        axes.set(title=title, xlabel="coupling c", ylabel=r"$\hat v$")
        axes.legend(loc="lower right")
    return picture("fig17-velocity", figure, long_table(curves))


def draw_exponent(e: PiecewiseScaling) -> Picture:
    """Draw the fastest solution up to c = 10⁴ with the two laws, and the local exponent."""
    c = np.array(e.c)
    curves = Curves({"fastest solution": {"c": c, "v": e.v, "exponent": e.exponent}})
    figure, (left, right) = new_panels(2, width="page", height=2.5)
    left.loglog(c, e.v, color=COLOURS["blue"], label="fastest solution of (54)")
    left.loglog(*curves.add("square-root law", c=c, v=e.limit * np.sqrt(c)), ":", color="black",
                label=f"V√c, V = {e.limit:.5f}")  # fmt: skip
    left.loglog(*curves.add("linear law", c=c, v=float(np.interp(1.0, c, e.v)) * c), "--",
                color="black", lw=0.9, label="paper: linear")  # fmt: skip
    right.semilogx(c, e.exponent, color=COLOURS["blue"], label="fastest solution of (54)")
    right.axhline(1.0, color="black", lw=0.9, ls="--", label="paper: linear")
    right.axhline(0.5, color="black", lw=0.9, ls=":", label="√c")
    left.set(xlabel="coupling c", ylabel=r"$\hat v$", title=r"$a$ = 4, $b$ = 0.5")
    right.set(xlabel="coupling c", ylabel=r"$d\ln\hat v\,/\,d\ln c$", ylim=(0, 2))
    left.legend()
    right.legend()
    return picture("fig17-exponent", figure, long_table(curves))


@dataclass(frozen=True, kw_only=True)
class Implicit:
    """Solutions of (54) below and above the coupling of depinning, and runs of the chain."""

    below: int
    """Solutions at c = 0.445."""
    above: int
    """Solutions at c = 0.46."""
    c_fold: float
    c_pin: float
    moving: float | None
    resting: str
    theory: float

    @property
    def gap(self) -> float:
        """Fastest solution minus the chain started moving, at c = 0.445; ∞ if it stops."""
        return math.inf if self.moving is None else abs(self.moving - self.theory)


def implicit() -> Implicit:
    """Solve (54) on either side of depinning, and start the chain from rest and moving."""
    from theory.piecewise.kinetic_relation import kinetic_relation
    from verification.piecewise.simulation import hysteresis

    below, above = kinetic_relation(0.445, ETA), kinetic_relation(0.46, ETA)
    both = hysteresis(ETA, [0.47, 0.445, 0.43])
    return Implicit(
        below=len(below.branches),
        above=len(above.branches),
        c_fold=required(below.c_fold, "c_fold"),
        c_pin=required(below.c_pin, "c_pin"),
        moving=both.moving[1].v,
        resting=str(both.resting[1].status.value),
        theory=below.branches[-1].v,
    )


def rule_implicit(e: Implicit) -> Ruling:
    """Rule: (54) must give the velocity of the moving chain wherever it has one."""
    if e.gap < AGREE and e.above >= 1:
        return holds()
    return fails("solutions of (54) are not the velocities of the chain.")


@dataclass(frozen=True, kw_only=True)
class AdmissibilityRuns:
    """Steady fronts of the chain (44), which does not assume (47), and solutions of (54)."""

    rows: tuple[tuple[float, float, float], ...]
    """c, η and v̂ of every steady run."""
    nearest: tuple[float, ...]
    """Distance of each from the nearest admissible solution of (54)."""
    inadmissible: tuple[tuple[float, float, float], ...]
    """c, η and v̂ of solutions that violate (47) at the same parameters."""
    reached: tuple[bool, ...]
    """Whether any steady run moves at the velocity of one of these."""

    @property
    def gap(self) -> float:
        """Largest of these distances."""
        return max(self.nearest)

    @property
    def runs(self) -> int:
        """Number of steady runs."""
        return len(self.rows)


def admissibility() -> AdmissibilityRuns:
    """Run the chain at several (c, η), and compare with admissible and other solutions."""
    from theory.piecewise.kinetic_relation import kinetic_relation
    from verification.piecewise.simulation import simulate_front

    rows, nearest, bad, reached = [], [], [], []
    for c, eta in ((0.44, ETA), (0.45, ETA), (0.5, ETA), (1.0, ETA), (2.0, ETA), (0.3, 0.01),
                   (0.3, 0.02), (1.0, 0.05)):  # fmt: skip
        branches = kinetic_relation(c, eta).branches
        run = simulate_front(c, eta)
        good = [branch.v for branch in branches if branch.admissible]
        v = run.v if run.steady else None
        if v is not None:
            rows.append((c, eta, v))
            nearest.append(min((abs(v - each) for each in good), default=np.inf))
        for branch in branches:
            if branch.admissible is False:
                bad.append((c, eta, branch.v))
                reached.append(v is not None and abs(v - branch.v) < AGREE)
    return AdmissibilityRuns(
        rows=tuple(rows), nearest=tuple(nearest), inadmissible=tuple(bad), reached=tuple(reached)
    )


def rule_admissibility(e: AdmissibilityRuns) -> Ruling:
    """Rule: every steady front must be an admissible solution of (54), and none another one."""
    if e.runs >= 5 and e.gap < AGREE and not any(e.reached):
        return holds()
    return fails("the chain has steady fronts that do not satisfy (47).")


CLAIMS = (
    Claim.beside(
        "fig17-linear", evidence=scaling, rule=rule_scaling, figure=draw_scaling, weight=2
    ),
    Claim.beside("fig17-implicit", evidence=implicit, rule=rule_implicit),
    Claim.beside("fig17-condition", evidence=admissibility, rule=rule_admissibility),
)
