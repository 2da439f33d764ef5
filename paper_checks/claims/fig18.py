"""Fig. 18: front velocity against η in the simplified model, and the solution of (54) for it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
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
from paper_checks.ruling import fails, holds, partly
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_panels, picture

if TYPE_CHECKING:
    from verification.piecewise.run import FrontRun

C = 0.3
ETAS = (0.002, 0.005, 0.01, 0.015, 0.02)
"""η at which both models have fronts that outrun the waves."""
AGREE = 1e-8
CROSSING = (0.0207, 0.0211, 0.0215, 0.0217, 0.0219, 0.0221)
"""η from below η_pin to just below the fold, 0.0223."""


@dataclass(frozen=True, kw_only=True)
class VelocityAgreement:
    """v̂ against η by (54), by runs of (44), and by the averaged chain (43)."""

    simplified: tuple[float, ...]
    averaged: tuple[float, ...]
    fold: float
    pin: float
    averaged_reaches: float
    """An η beyond the fold at which (43) still has a front."""
    runs: tuple[tuple[float, FrontRun], ...]
    scipy_gap: float
    solutions: PlottedSolutions
    """Every solution of (54) over η."""
    near: PlottedSolutions
    """Every solution close to the thresholds."""
    moving: tuple[float | None, ...]
    """v̂ of the chain at `CROSSING`, started from a moving front."""
    resting: tuple[float | None, ...]
    """v̂ of the chain there, started from rest."""

    @property
    def gap(self) -> float:
        """Largest difference between a steady run of (44) and (54)."""
        found = dict(zip(ETAS, self.simplified, strict=True))
        steady = ((eta, required(run.v, "velocity")) for eta, run in self.runs if run.steady)
        return max(abs(v - found[eta]) for eta, v in steady)

    @property
    def slopes(self) -> str:
        """D ln v̂/d ln η between successive η, by (43) and by (54)."""
        rows = zip(pairwise(ETAS), pairwise(self.averaged), pairwise(self.simplified), strict=True)
        return ", ".join(
            f"{math.log(y / x) / math.log(high / low):.2f} and "
            f"{math.log(w / u) / math.log(high / low):.2f}"
            for (low, high), (x, y), (u, w) in rows
        )


def alike() -> VelocityAgreement:
    """Measure and solve for v̂ along η."""
    from theory.chains.vdp import VdpChain
    from theory.piecewise.folds import fold_eta
    from theory.piecewise.kinetic_relation import kinetic_relation, trace_kinetic_relation
    from theory.piecewise.limits import pinning_eta
    from verification.fronts.measure import measure_front
    from verification.piecewise.simulation import simulate_front
    from verification.references.passages import quarter_turn_velocity

    fold, pin = fold_eta(C).value, pinning_eta(C)
    etas = np.concatenate([np.geomspace(2e-4, 2e-3, 40), np.linspace(2.2e-3, 1.005 * fold, 160)])
    averaged = [
        required(
            measure_front(VdpChain(a=1.0, b=eta, c=C).averaged(), max_sites=250).v,
            f"front of (43) at η = {eta:g}",
        )
        for eta in ETAS
    ]
    beyond = measure_front(VdpChain(a=1.0, b=2.0 * fold, c=C).averaged(), max_sites=250).v
    return VelocityAgreement(
        simplified=tuple(kinetic_relation(C, eta).branches[-1].v for eta in ETAS),
        averaged=tuple(averaged),
        fold=fold,
        pin=pin,
        averaged_reaches=2.0 * fold if beyond is not None else fold,
        runs=tuple((eta, simulate_front(C, eta)) for eta in ETAS),
        scipy_gap=abs(quarter_turn_velocity(1.0, ETAS[0], C, 40) / averaged[0] - 1.0),
        solutions=curve_of(trace_kinetic_relation(C, etas), "eta"),
        near=curve_of(trace_kinetic_relation(C, np.linspace(0.95 * pin, 1.005 * fold, 200)), "eta"),
        moving=tuple(simulate_front(C, eta, "moving").v for eta in CROSSING),
        resting=tuple(simulate_front(C, eta, "resting").v for eta in CROSSING),
    )


def rule_alike(e: VelocityAgreement) -> Ruling:
    """Rule: both velocities must decrease with η, at every step."""
    falls = all(a > b for row in (e.simplified, e.averaged) for a, b in pairwise(row))
    if falls and e.gap < AGREE and e.scipy_gap < 1e-4:
        return holds()
    return fails("the two velocities do not vary with η in the same direction.")


def draw(e: VelocityAgreement) -> tuple[Picture, ...]:
    """Draw Fig. 18 with every solution, the averaged chain, and the end of the curve."""
    figure, (left, right) = new_panels(2, width="page", height=2.7)
    curves = Curves(
        {
            "solutions of (54)": e.solutions.columns("eta"),
            "near the thresholds": e.near.columns("eta"),
        }
    )
    draw_curve(left, e.solutions)
    chain = curves.add("chain (44)", eta=[x for x, _ in e.runs], v=[run.v for _, run in e.runs])
    draw_runs(left, *chain, "s", "chain (44)")
    left.plot(*curves.add("averaged (43)", eta=ETAS, v=e.averaged), "^", color=COLOURS["green"],
              label="averaged chain (43), Fig. 14")  # fmt: skip
    left.set(xlim=(0, 0.024), ylim=(0, 1.3), title=r"$c$ = 0.3")
    draw_curve(right, e.near)
    draw_thresholds(right, {"fold": e.fold, "pin": e.pin}, r"\eta")
    for name, found, mark in (
        ("chain, moving start", e.moving, "s"), ("chain, resting start", e.resting, "x"),
    ):  # fmt: skip
        draw_runs(right, *curves.add(name, eta=CROSSING, v=found), mark, name)
    right.set(title="near the thresholds")
    for axes in (left, right):
        axes.set(xlabel="η = b/a²", ylabel=r"$\hat v$")
        axes.locator_params(axis="x", nbins=5)
        axes.legend()
    return (picture("fig18-velocity", figure, long_table(curves)),)


@dataclass(frozen=True, kw_only=True)
class AnySet:
    """Whether (54) has a solution, and the motion of the chain, at several (c, η)."""

    rows: tuple[tuple[float, float, int, float | None, str], ...]
    """c, η, number of solutions with v > 0, v̂ of the chain if steady, its status."""
    gap: float
    """Retreating chain compared with |2 + Σ(v, c)| = 2r at v < 0."""

    @property
    def words(self) -> str:
        """The rows in words."""
        return "; ".join(
            f"c = {c:g}, η = {eta:g}: {n} solution{'' if n == 1 else 's'}, chain "
            + (status if v is None else f"{status} at v̂ = {v:.6f}")
            for c, eta, n, v, status in self.rows
        )


def any_set() -> AnySet:
    """Solve (54) and run the chain where fronts advance, are pinned, and retreat."""
    from theory.piecewise.kinetic_relation import kinetic_relation
    from verification.piecewise.simulation import simulate_front

    rows, gaps = [], []
    for c, eta in ((0.5, 0.03125), (0.3, 0.03125), (0.5, 0.11), (2.0, 0.11)):
        answer, run = kinetic_relation(c, eta), simulate_front(c, eta)
        forward = [branch for branch in answer.branches if branch.v > 0.0]
        v = run.v if run.steady else None
        rows.append((c, eta, len(forward), v, str(run.status.value)))
        if v is not None:
            gaps.append(min(abs(v - branch.v) for branch in answer.branches))
    return AnySet(rows=tuple(rows), gap=max(gaps))


def rule_any_set(e: AnySet) -> Ruling:
    """Rule: each set must have a solution; where it has none the chain must not advance."""
    advance = [n > 0 for _, _, n, _, _ in e.rows]
    moves = [v is not None and v > 0.0 for *_, v, _ in e.rows]
    if e.gap > AGREE or advance != moves:
        return fails("(54) has no solution where the chain advances, or one where it does not.")
    if all(advance):
        return holds()
    return partly(
        "for any set of parameters $\\eta$, $c$",
        "below c_fold and for all η above 2/25 there is no solution, the front being pinned or "
        "retreating there.",
    )


@dataclass(frozen=True, kw_only=True)
class Explicit:
    """Σ without any root, and the velocity in its closed limits."""

    terms: int
    gap: float
    bound: float
    strong: tuple[float, float]
    """v̂/√c at c = 10⁶ and its limit."""
    weak: float
    """v̂ relative to √(c/(8r)) at η = 1e-12."""
    pin: float
    rest: float
    """Residual of (54) at v = 0.001 and the closed form of c_pin."""


def explicit() -> Explicit:
    """Evaluate Σ by an integral and by roots, and the velocity near its closed limits."""
    from theory.cells.vdp import threshold_ratio
    from theory.piecewise.kinetic_relation import kinetic_relation
    from theory.piecewise.limits import (
        pinning_coupling,
        strong_coupling_velocity,
        weak_threshold_velocity,
    )
    from theory.piecewise.sums.integral import sum_by_integral
    from verification.references.piecewise import sum_on_the_line

    integral, (plain, plain_error) = sum_by_integral(0.3, 0.5), sum_on_the_line(0.3, 0.5)
    pin = required(pinning_coupling(0.03125), "pinning coupling")
    far = kinetic_relation(1e6, 0.03125).branches[-1].v / 1e3
    weak = kinetic_relation(0.3, 1e-12).branches[-1].v / weak_threshold_velocity(0.3, 1e-12)
    return Explicit(
        terms=integral.terms,
        gap=abs(integral.value - plain),
        bound=integral.error + plain_error,
        strong=(far, required(strong_coupling_velocity(0.03125), "law for strong coupling")),
        weak=weak,
        pin=pin,
        rest=abs(abs(sum_by_integral(1e-3, pin).value) - 2.0 * threshold_ratio(0.03125)),
    )


def rule_explicit(e: Explicit) -> Ruling:
    """Rule: the reason fails if the sum needs no root and the limits are explicit."""
    if e.gap > e.bound:
        return fails("two integrals without roots differ.")
    near = max(abs(e.strong[0] / e.strong[1] - 1.0), abs(e.weak - 1.0), e.rest)
    if near < 0.01:
        return partly(
            "due the infinite number of complex roots",
            "the sum over all roots is one integral, so that v̂ follows from one scalar equation, "
            "and is explicit in its limits.",
        )
    return holds()


CLAIMS = (
    Claim.beside("fig18-alike", evidence=alike, rule=rule_alike, figure=draw),
    Claim.beside("fig18-any", evidence=any_set, rule=rule_any_set),
    Claim.beside("fig18-explicit", evidence=explicit, rule=rule_explicit, weight=0),
)
