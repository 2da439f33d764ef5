"""What the text of sections 1.2 and 1.3 asserts about the states and fronts of Model I."""

from __future__ import annotations

import math

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.claims._friction_cell import (
    MU_D,
    MU_ST,
    V_0,
    XI,
    friction,
    hopf_speed,
    slip_by_steps,
    slip_from_stick,
)
from paper_checks.following import following


def _regions() -> Finding:
    """Find the speed above which steady sliding is stable and that where stick-slip ends."""
    from scipy.optimize import brentq

    hopf = hopf_speed()
    graze = float(brentq(_reach, 1.7, 2.2, xtol=1e-7))
    low, high = slip_by_steps(graze - 1e-3, 5e-3), slip_by_steps(graze + 1e-3, 5e-3)
    belts = np.linspace(0.2, 1.8, 9)
    sustained = [slip_from_stick(float(belt))[0] > -1e-12 for belt in belts]
    rates = [_linear_growth(hopf + shift) for shift in (-0.01, 0.01)]
    right = all(sustained) and low == 0.0 > high and rates[0] > 0.0 > rates[1] and hopf < graze
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value=f"both are stable for {hopf:.6f} < v_d < {graze:.5f}; below only stick-slip, above "
        "only steady sliding",
        error="1e-6 in the upper speed; the lower one is a closed form",
        methods=(
            "v_0 ln[(μ_st - μ_d)/(2ξ v_0)], and the slip phase that just touches the belt's speed",
            "eigenvalues by finite differences on both sides of the lower speed, fixed steps on "
            "both sides of the upper one",
        ),
        tolerance="0.001 about the upper speed, 0.01 about the lower one, in the second methods",
        explanation=(
            "Parameters (7). The cycle ends because its stick phase shrinks to a touch; its "
            "amplitude there is finite. Coupling does not damp, so the lower speed is the same for "
            "the chain."
        ),
    )


def _subcritical() -> Finding:
    """Compare the cubic coefficient at the Hopf point with the growth of a run there."""
    from scipy.integrate import solve_ivp

    belt = hopf_speed()
    third = (MU_ST - MU_D) / V_0**3 * math.exp(-belt / V_0)
    coefficient = 3.0 / 8.0 * third / 6.0  # A' = coefficient A³ when the linear damping is zero
    centre = friction(belt)

    def rate(_: float, state: np.ndarray) -> list[float]:
        y, w = state
        return [w, -2.0 * XI * w - y + friction(belt - w)]

    start, turns = 0.1, 40
    run = solve_ivp(
        rate, (0.0, 2 * math.pi * turns), [centre, start], method="DOP853", rtol=1e-11, atol=1e-13
    )
    end = float(np.hypot(run.y[0, -1] - centre, run.y[1, -1]))
    predicted = 1.0 / math.sqrt(1.0 / start**2 - 4.0 * math.pi * turns * coefficient)
    gap = abs((end - start) / (predicted - start) - 1.0)
    if gap > 0.2:
        raise ArithmeticError(f"growth of the run {end - start:.3e}, of the theory {gap:.2f} off")
    return Finding(
        verdict=Verdict.REPRODUCED if coefficient > 0.0 and end > start else Verdict.NOT_REPRODUCED,
        value=f"A' = +{coefficient:.4f} A³ at v_d = {belt:.6f}: subcritical",
        error=f"the run differs by {gap:.1%}, of the order of A²",
        methods=("third derivative of (2), averaged", "direct integration of one cell, 40 turns"),
        tolerance="the sign; 20 per cent between both growths at the amplitude 0.1",
        explanation=(
            "The coefficient is (μ_st - μ_d) e^{-v_d/v_0}/(16 v_0³), positive for every set of "
            "parameters with μ_st > μ_d."
        ),
    )


def _reach(belt: float) -> float:
    """Return a function of v_d that changes sign where the slip phase just touches the belt."""
    return slip_from_stick(belt)[0] + 1e-9


def _linear_growth(belt: float, step: float = 1e-5) -> float:
    slope = (friction(belt - step) - friction(belt + step)) / (2.0 * step)
    matrix = np.array([[0.0, 1.0], [-1.0, slope - 2.0 * XI]])
    return float(np.linalg.eigvals(matrix).real.max())


CLAIMS = (
    Claim(
        "text-regions",
        "Section 1.2, before and after Fig. 2",
        "The cell has stick-slip at low speed, steady sliding at high speed, and both in between.",
        None,
        Verdict.REPRODUCED,
        "fronts check text-regions",
        _regions,
    ),
    Claim(
        "text-subcritical",
        "Introduction",
        "The friction cell has a subcritical Hopf bifurcation.",
        None,
        Verdict.REPRODUCED,
        "fronts check text-subcritical",
        _subcritical,
    ),
    following(
        "text-bistable-point",
        "Section 1.2, Fig. 2",
        "At v_d = 1.25 both steady sliding and the stick-slip cycle are stable.",
        "fig02",
        printed="v_d = 1.25",
    ),
    following(
        "text-breather-one",
        "Section 1.2, Fig. 3a",
        "With sites 15 to 17 of 31 excited at c = 0.4 %, the envelopes at τ = 200, 400, 600 "
        "coincide: a discrete breather.",
        "fig03",
        printed="c = 0.4 %, τ = 200, 400, 600",
    ),
    following(
        "text-front-one",
        "Section 1.2, Fig. 3b",
        "With the first site of 31 excited at c = 2 %, stick-slip spreads into steady sliding, as "
        "seen at τ = 400, 700, 1000.",
        "fig03",
        printed="c = 2 %, τ = 400, 700, 1000",
    ),
    following(
        "text-start-matters",
        "Section 1.2",
        "Initial conditions and coupling decide between breather and front.",
        "fig03",
    ),
    following(
        "text-coupling-promotes",
        "Section 1.3, before Fig. 4",
        "A stronger coupling promotes propagation.",
        "fig04",
    ),
    following(
        "text-edge-drop",
        "Section 1.3 and caption of Fig. 4",
        "For edge excitation the critical coupling drops by about 40 % from nucleus size 1 to "
        "larger ones.",
        "fig04",
        printed="about 40 %",
    ),
    following(
        "text-bulk-flat",
        "Section 1.3 and caption of Fig. 4",
        "For bulk excitation the critical coupling is almost insensitive to the nucleus size.",
        "fig04",
    ),
    following(
        "text-critical-divides",
        "Caption of Fig. 4",
        "Below the critical coupling a breather is expected, above it a front.",
        "fig04",
    ),
    following(
        "text-map-one",
        "Section 1.3, Fig. 5",
        "The plane of coupling (0 to 0.1) and belt speed (1 to 2) has fronts, breathers and steady "
        "sliding.",
        "fig05",
        printed="c from 0 to 0.1, v_d from 1 to 2",
    ),
    following(
        "text-breathers-low-one",
        "Section 1.3, after Fig. 5",
        "Breathers exist only at low coupling; with more coupling their region shrinks and two "
        "homogeneous states remain.",
        "fig05",
    ),
    following(
        "text-after-front",
        "Section 1.3, after Fig. 5",
        "After propagation all oscillators of a finite chain are in stick-slip or, at higher "
        "speed, in steady sliding.",
        "fig05",
    ),
    following(
        "text-no-front-below",
        "Caption of Fig. 6",
        "For c below the critical coupling there is no propagation.",
        "fig06",
    ),
    following(
        "text-velocity-one",
        "Section 1.3, Fig. 6",
        "Beyond the critical coupling the velocity rises rapidly and then scales linearly with c.",
        "fig06",
    ),
)
