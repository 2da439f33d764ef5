"""What the text of section 2.3 (Model II, fronts) asserts beside its figures."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
from paper_checks.claims._text import untestable
from paper_checks.following import following

if TYPE_CHECKING:
    from theory.vdp_chain import VdpChain

A, B = 4.0, 0.5


def _gauge() -> Finding:
    """Run (34) with ω = 1 and with ω = 1 + εc and compare, for three ε."""
    from scipy.integrate import solve_ivp

    from theory.envelope import envelope_rate
    from theory.vdp_chain import VdpChain

    sites, duration = 6, 12.0
    start = VdpChain(A, B, 0.5).stable_amplitude * np.exp(-0.8 * np.arange(sites)) * (1.0 + 0.2j)
    gaps = []
    small = (0.02, 0.01, 0.005)
    for eps in small:
        chain = VdpChain(A, B, 0.5, eps, sites)
        ends = []
        for omega in (1.0, 1.0 + eps * chain.c):

            def rate(_: float, phi: np.ndarray, omega: float = omega) -> np.ndarray:
                return _rate_34(phi, chain, omega)  # noqa: B023 - used within the loop only

            run = solve_ivp(rate, (0.0, duration), start, method="DOP853", rtol=1e-10, atol=1e-12)
            # y = Im(φ e^{iωt})/ω: both must describe the same y, up to O(ε).
            ends.append(run.y[:, -1] * np.exp(1j * (omega - 1.0) / eps * duration) / omega)
        gaps.append(float(np.abs(ends[1] - ends[0]).max() / np.abs(ends[0]).max()))
    order = math.log(gaps[0] / gaps[-1]) / math.log(small[0] / small[-1])
    at_one = np.abs(
        _rate_34(start, VdpChain(A, B, 0.5, 0.01, sites), 1.0)
        - envelope_rate(start.astype(complex), VdpChain(A, B, 0.5, 0.01, sites))
    ).max()
    right = order > 0.9 and gaps[1] < 0.1 and at_one < 1e-12
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value=f"y differs by {gaps[1]:.1e} of itself at ε = 0.01 between ω = 1 and ω = 1 + εc",
        error=f"the difference falls in proportion to ε (observed order {order:.2f})",
        methods=(
            "runs of (34) with both ω by scipy",
            f"the rate of (43) in the toolkit equals (34) at ω = 1 to {at_one:.0e}",
        ),
        tolerance="an order of at least 0.9: the error of averaging itself is O(ε)",
        explanation="ω only says in which rotating frame φ is written.",
    )


def _rate_34(phi: np.ndarray, chain: VdpChain, omega: float) -> np.ndarray:
    """Return dφ/d(εt) of (34) for any ω, free ends."""
    pull = np.zeros_like(phi)
    pull[1:] += phi[1:] - phi[:-1]
    pull[:-1] += phi[:-1] - phi[1:]
    size = np.abs(phi) ** 2
    damping = 1.0 - chain.a * size / (4 * omega**2) + chain.b * size**2 / (8 * omega**4)
    frame = 1j * (omega - 1.0 / omega) / (2.0 * chain.eps)
    rate: np.ndarray = 0.5j * chain.c / omega * pull - 0.5 * phi * damping - frame * phi
    return rate


@lru_cache(maxsize=1)
def _velocities() -> tuple[float, float, float, float]:
    """Velocity and error at c = 0.6: of (43) by a run, and of (54) with a run of (44)."""
    from theory.kinetic_relation import kinetic_relation
    from theory.vdp_chain import VdpChain
    from verification.piecewise_simulation import simulate_front
    from verification.vdp_front import measure_front

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
        value=f"v = {averaged:.5f} by (43), {simplified:.5f} by (54), at c = 0.6: {ratio:.2f} times",
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


def _collapse_figure() -> Finding:
    """See on which figure sets of (a, b) can collapse, by the scaling of (8)."""
    from theory.envelope import envelope_rate
    from theory.vdp_chain import VdpChain

    generator = np.random.default_rng(14)
    gaps = []
    for a, b, c in generator.uniform((1.0, 0.1, 0.1), (5.0, 1.0, 1.0), (5, 3)):
        sites = 5
        phi = generator.normal(size=sites) + 1j * generator.normal(size=sites)
        whole = envelope_rate(phi, VdpChain(a, b, c, sites=sites))
        scaled = envelope_rate(phi * math.sqrt(a), VdpChain(1.0, b / a**2, c, sites=sites))
        gaps.append(float(np.abs(scaled / math.sqrt(a) - whole).max()))
    full = _full_scaling()
    right = max(gaps) < 1e-11 and full < 1e-11
    return Finding(
        verdict=Verdict.CORRECTED if right else Verdict.NOT_REPRODUCED,
        value="the sets (a, b) are in Fig. 14; Fig. 13 has one set, a = 4, b = 0.5",
        error=f"{max(gaps + [full]):.0e}: rounding",
        methods=("the averaged chain with (a, b) and with (1, η)", "the same of (8)"),
        tolerance="1e-11: rounding",
        explanation=(
            "With y√a in the place of y only η is left, so the collapse over η is an identity "
            "and needs no simulation. Over c at one (a, b), as the caption of Fig. 13 says, "
            "there is nothing to collapse."
        ),
        erratum=Erratum(
            Fault.INCONSISTENT,
            "“different sets of $a, b$ in Figure 13”",
            "different sets of $a, b$ in Figure 14",
            "The caption of Fig. 13 gives one set; Fig. 14 is over $\\eta$.",
            "The scaling that makes the sets collapse leaves η, the abscissa of Fig. 14 (checked "
            f"on (8) and (43) to {max(gaps + [full]):.0e}).",
            "Nothing else.",
        ),
    )


def _full_scaling() -> float:
    """Return how far (8) is from its scaled form at random states."""
    generator = np.random.default_rng(8)
    worst = 0.0
    for a, b, c in generator.uniform((1.0, 0.1, 0.1), (5.0, 1.0, 1.0), (5, 3)):
        y, w = generator.normal(size=(2, 3))

        def force(y: np.ndarray, w: np.ndarray, a: float, b: float, c: float = c) -> float:
            drag = w[1] * (1.0 - a * y[1] ** 2 + b * y[1] ** 4)
            return float(-y[1] - 0.01 * (c * (2 * y[1] - y[0] - y[2]) + drag))

        root = math.sqrt(a)
        worst = max(worst, abs(force(root * y, root * w, 1.0, b / a**2) / root - force(y, w, a, b)))
    return worst


def _any_set() -> Finding:
    """Count the solutions of (54) over a few (c, η), with runs of the chain beside them."""
    from theory.kinetic_relation import kinetic_relation
    from verification.piecewise_simulation import simulate_front

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
        "text-successive",
        "Section 2.3.1, Fig. 12",
        "Particles pass one after another from rest to the stable limit cycle.",
        "fig12",
    ),
    following(
        "text-steady",
        "Caption of Fig. 12",
        "At t = 14000, 17000, 20000 the front is seen to propagate steadily.",
        "fig12",
        printed="t = 14000, 17000, 20000",
    ),
    following(
        "text-linear-two",
        "Section 2.3.1, Fig. 13",
        "The velocity of (8) is asymptotically linear in c.",
        "fig13",
    ),
    following(
        "text-linear-both",
        "Section 2.3.1",
        "This is similar to the friction-excited system.",
        "fig06",
        "fig13",
    ),
    following(
        "text-one-parameter",
        "Section 2.3.1, Fig. 14",
        "The velocity scales with the single parameter η = b/a²: all sets collapse on one line.",
        "fig14",
    ),
    Claim(
        "text-collapse",
        "Section 2.3.1",
        "The results for different sets of a, b are in Figure 13.",
        "Figure 13",
        Verdict.CORRECTED,
        "fronts check text-collapse",
        _collapse_figure,
        weight=0,
    ),
    following(
        "text-map-two",
        "Section 2.3.1, Fig. 15",
        "The plane of η and c has fronts, breathers and the trivial fixed point.",
        "fig15-regions",
    ),
    untestable(
        "text-forcing",
        "Section 2.3.1",
        "η is in a sense the equivalent of the belt speed.",
        "The sense is not given. What can be compared, the two maps, is under text-alike.",
    ),
    following(
        "text-alike",
        "Section 2.3.1, Fig. 15",
        "The map looks qualitatively like that of Fig. 5.",
        "fig05",
        "fig15-regions",
    ),
    Claim(
        "text-gauge",
        "Section 2.3.2, before Eq. (43)",
        "ω can be set to 1 in (34) without loss of generality.",
        "ω = 1",
        Verdict.REPRODUCED,
        "fronts check text-gauge",
        _gauge,
        weight=0,
    ),
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
        "fig14",
        "fig18-velocity",
    ),
    following(
        "text-equivalent",
        "Section 2.3.2",
        "Both similarities imply that the two models are equivalent in their dynamics.",
        "fig17-linear",
        "fig18-velocity",
        "fig14",
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
