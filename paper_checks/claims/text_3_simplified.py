"""What the text of section 2.3.2 (the simplified model) asserts beside its figures."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
from paper_checks.claims._text import untestable
from paper_checks.following import following

A, B = 4.0, 0.5

C = 0.3
ETAS = (0.002, 0.005, 0.01, 0.015, 0.02)
"""Coupling of Figs. 14 and 18, and η at which both have fronts that outrun the waves."""


@lru_cache(maxsize=1)
def _velocities() -> tuple[float, float, float, float]:
    """Velocity and error at c = 0.6: of (43) by a run, and of (54) with a run of (44)."""
    from theory.chains.vdp import VdpChain
    from theory.piecewise.kinetic_relation import kinetic_relation
    from verification.fronts.measure import measure_front
    from verification.piecewise.simulation import simulate_front

    front = measure_front(VdpChain(a=A, b=B, c=0.6).averaged())
    branch = kinetic_relation(0.6, B / A**2).branches[-1]
    run = simulate_front(0.6, B / A**2)
    if front.v is None or front.error is None or run.v is None:
        raise ArithmeticError(f"no velocity at c = 0.6: {front.status}, {run.status}")
    return front.v, front.error, branch.v, abs(run.v - branch.v)


def _quantitative() -> Finding:
    """Compare the velocities of (43) and (54) at c = 0.6."""
    averaged, error, simplified, gap = _velocities()
    ratio = averaged / simplified
    return Finding(
        verdict=Verdict.REPRODUCED if abs(ratio - 1.0) > 0.1 else Verdict.NOT_REPRODUCED,
        value=f"at c = 0.6: {averaged:.5f} by (43), {simplified:.5f} by (54), {ratio:.2f} times",
        error=f"{error:.0e} in the first, {gap:.0e} in the second",
        methods=("kinetic relation (54) and a run of (44)", "a run of the averaged chain (43)"),
        tolerance="10 per cent: what would count as a match",
        explanation=(
            "No match is expected, and there is none. The two differ in the law as well: the "
            "velocity of (54) grows as √c (fig17-linear)."
        ),
    )


def _captions() -> Finding:
    """See which of (43) and (44) has the velocities of Figs. 17 and 18."""
    averaged, error, simplified, gap = _velocities()
    apart = abs(averaged - simplified) > 10.0 * (error + gap)
    return Finding(
        verdict=Verdict.CORRECTED if apart and gap < 1e-8 else Verdict.NOT_REPRODUCED,
        value="the simplified model is (44)",
        error=f"the run of (44) agrees with (54) to {gap:.0e}",
        methods=("a run of (44)", "a run of (43)"),
        tolerance="ten times the errors of both velocities",
        explanation="(43) is the averaged chain before the nonlinear term is replaced.",
        erratum=Erratum(
            Fault.MISPRINT,
            "captions of Figs. 17 and 18: “the simplified model (43)”",
            "the simplified model (44)",
            "(54), which the figures show, solves (44).",
            f"At a = 4, b = 0.5, c = 0.6 a run of (44) has v = {simplified:.6f}, as (54); a run "
            f"of (43) has {averaged:.5f}.",
            "Nothing else.",
        ),
    )


def _eta_alike() -> Finding:
    """Compare how the velocities of (43) and of (54) fall with η, and where they end."""
    from theory.chains.vdp import VdpChain
    from theory.piecewise.folds import fold_eta
    from theory.piecewise.kinetic_relation import kinetic_relation
    from verification.fronts.measure import measure_front
    from verification.piecewise.simulation import simulate_front

    def measured(eta: float) -> float | None:
        return measure_front(VdpChain(a=1.0, b=eta, c=C).averaged(), max_sites=250).v

    def solved(eta: float) -> float | None:
        branches = kinetic_relation(C, eta).branches
        return branches[-1].v if branches else None

    pairs = [(measured(eta), solved(eta)) for eta in ETAS]
    known = [(a, b) for a, b in pairs if a is not None and b is not None]
    if len(known) < len(ETAS):
        raise ArithmeticError(f"a front is missing at η up to {ETAS[-1]:g}")
    run = simulate_front(C, ETAS[-1])
    gap = abs((run.v or 0.0) - known[-1][1])
    by_scipy = abs(measured_by_scipy(ETAS[0]) / known[0][0] - 1.0)
    if gap > 1e-8 or by_scipy > 1e-4:
        raise ArithmeticError(f"velocities differ: {gap:.1e} from the chain, {by_scipy:.1e}")
    slopes = [
        [math.log(y[k] / x[k]) / math.log(high / low) for k in (0, 1)]
        for (low, x), (high, y) in pairwise(zip(ETAS, known, strict=True))
    ]
    both_fall = all(one < 0.0 and other < 0.0 for one, other in slopes)
    end = fold_eta(C).value
    reaches = measured(2.0 * end) is not None
    verdict = Verdict.NOT_REPRODUCED
    if both_fall:
        verdict = Verdict.PARTIAL if reaches else Verdict.REPRODUCED
    return Finding(
        verdict=verdict,
        value="; ".join(
            f"η = {eta:g}: {a:.3f} by (43), {b:.3f} by (54)"
            for eta, (a, b) in zip(ETAS, known, strict=True)
        ),
        error=f"{gap:.0e} in (54), {by_scipy:.0e} of itself in (43)",
        methods=(
            "runs of (43) and solutions of (54)",
            "scipy on the real staggered chain at the smallest η; a run of (44) at the largest",
        ),
        tolerance="both must fall, and where fronts end must be the same η within a factor of two",
        explanation=(
            "At c = 0.3 both velocities fall as η grows, at first in the same way: d ln v̂/d ln η "
            + ", ".join(f"{one:.2f} and {other:.2f}" for one, other in slopes)
            + f" from one η to the next, by (43) and by (54). But (54) has no solution beyond its "
            f"fold at η = {end:.4f}, and the chain it stands for "
            + (
                "still has fronts at twice that, up to about 0.09 (fig14-velocity)."
                if reaches
                else "has none at twice that."
            )
        ),
    )


def measured_by_scipy(eta: float) -> float:
    """Return v̂ of the front of (43) at one η by scipy alone; it outruns what is behind."""
    from paper_checks.claims._fronts import staggered_velocity

    return staggered_velocity(1.0, eta, C, 40)


CLAIMS = (
    following(
        "text-bistable-kept",
        "Section 2.3.2, before Eq. (44)",
        "The two linear equations keep the two equilibria of the envelope and its bistability.",
        "eq44",
    ),
    untestable(
        "text-resembles",
        "Section 2.3.2, before Eq. (44)",
        "(44) somewhat resembles the Atkinson-Cabrera equations, and (48) a system with viscosity "
        "[31] in that its dispersion relation is complex.",
        "How much alike is not said. (44) is of first order in time and complex, and has no "
        "energy; the chains cited are of second order and real. That (50) is complex on the real "
        "axis is seen from its real part, 1/2.",
    ),
    following(
        "text-fourier",
        "Section 2.3.2, Eq. (49)",
        "(48) is solved by the Fourier transform.",
        "eq48",
        "eq49",
    ),
    Claim(
        "text-quantitative",
        "Section 2.3.2, after Fig. 16",
        "(49) and (54) do not match the original model quantitatively.",
        None,
        Verdict.REPRODUCED,
        "fronts kinetic --c 0.6 --eta 0.03125",
        _quantitative,
        weight=0,
    ),
    following(
        "text-recovering",
        "Section 2.3.2, Fig. 17",
        "The simplified model recovers the linear scaling of the velocity.",
        "fig17-linear",
        weight=1,
    ),
    Claim(
        "text-eta-alike",
        "Section 2.3.2, Fig. 18",
        "The dependence of the velocity on η is qualitatively that of the Van der Pol system.",
        None,
        Verdict.PARTIAL,
        "fronts kinetic --c 0.3 --eta 0.001:0.03:30",
        _eta_alike,
    ),
    following(
        "text-equivalent",
        "Section 2.3.2",
        "Both similarities imply that the two models are equivalent in their dynamics.",
        "fig17-linear",
        "text-eta-alike",
    ),
    Claim(
        "text-captions",
        "Captions of Figs. 17 and 18",
        "The simplified model of Figs. 17 and 18 is (43).",
        "(43)",
        Verdict.CORRECTED,
        "fronts front piecewise --c 0.6 --eta 0.03125",
        _captions,
        weight=0,
    ),
)
