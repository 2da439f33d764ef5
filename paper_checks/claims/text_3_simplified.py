"""What the text of section 2.3.2 (the simplified model) asserts beside its figures."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
from paper_checks.following import following

if TYPE_CHECKING:
    pass

A, B = 4.0, 0.5


@lru_cache(maxsize=1)
def _velocities() -> tuple[float, float, float, float]:
    """Velocity and error at c = 0.6: of (43) by a run, and of (54) with a run of (44)."""
    from theory.kinetic_relation import kinetic_relation
    from theory.vdp_chain import VdpChain
    from verification.piecewise.simulation import simulate_front
    from verification.vdp.front import measure_front

    front = measure_front(VdpChain(A, B, 0.6))
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


def _any_set() -> Finding:
    """Count the solutions of (54) over a few (c, η), with runs of the chain beside them."""
    from theory.kinetic_relation import kinetic_relation
    from verification.piecewise.simulation import simulate_front

    rows, seen = [], []
    for c, eta in ((0.3, 0.03125), (0.445, 0.03125), (0.5, 0.03125), (0.5, 0.1)):
        answer = kinetic_relation(c, eta)
        forward = [branch for branch in answer.branches if branch.v > 0 and branch.admissible]
        run = simulate_front(c, eta)
        rows.append((c, eta, len(answer.branches), len(forward)))
        moves = run.v is not None and run.v > 0
        seen.append((bool(forward) == moves, run.status.value))
    if not all(same for same, _ in seen):
        raise ArithmeticError(f"theory and chain disagree: {rows}, {seen}")
    none = [row for row in rows if row[3] == 0]
    several = [row for row in rows if row[2] > 1]
    return Finding(
        verdict=Verdict.PARTIAL if none or several else Verdict.REPRODUCED,
        value="; ".join(
            f"c = {c:g}, η = {eta:g}: {total} solutions, {good} admissible"
            for c, eta, total, good in rows
        ),
        error="none: numbers of solutions",
        methods=(
            "all branches of (54) with their admissibility",
            "runs of (44): " + ", ".join(status for _, status in seen),
        ),
        tolerance="a run must move where an admissible solution exists, and rest where none does",
        explanation=(
            "Where there is exactly one solution, it can. Below the fold there is none and the "
            "front is pinned; just above it there are several; for η > 2/25 none runs forward."
        ),
    )


CLAIMS = (
    following(
        "text-bistable-kept",
        "Section 2.3.2, before Eq. (44)",
        "The two linear equations keep the two equilibria of the envelope and its bistability.",
        "eq44",
    ),
    following(
        "text-self-consistent",
        "Section 2.3.2, Eq. (47)",
        "Condition (47) does not restrict the scope as far as solutions are checked for it.",
        "eq47",
        "fig17-stable",
    ),
    following(
        "text-fourier",
        "Section 2.3.2, Eq. (49)",
        "(48) is solved by the Fourier transform.",
        "eq48",
        "eq49",
    ),
    Claim(
        "text-any-set",
        "Section 2.3.2, after Eq. (54)",
        "(54) can be solved numerically for the velocity at any set of η and c.",
        None,
        Verdict.PARTIAL,
        "fronts kinetic --c 0.445 --eta 0.03125",
        _any_set,
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
    following(
        "text-eta-alike",
        "Section 2.3.2, Fig. 18",
        "The dependence of the velocity on η is qualitatively that of the Van der Pol system.",
        "fig14-velocity",
        "fig18-velocity",
    ),
    following(
        "text-equivalent",
        "Section 2.3.2",
        "Both similarities imply that the two models are equivalent in their dynamics.",
        "fig17-linear",
        "fig18-velocity",
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
