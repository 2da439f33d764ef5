"""What the text of section 1 (Model I) asserts beside its figures, from the first line on."""

from __future__ import annotations

import math

import numpy as np

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
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
from paper_checks.claims._text import untestable
from paper_checks.following import following


def _limits_of_friction() -> Finding:
    """Put v_rel = 0 and a large one into (2) as printed and as corrected."""
    from derivations import catalogue
    from derivations.printed import judge, printed

    def as_printed(speed: float) -> float:
        return MU_ST + (MU_ST - MU_D) * math.exp(-speed / V_0)

    found = judge(printed(2), catalogue.load("friction"))
    wrong = max(abs(as_printed(0.0) - MU_ST), abs(as_printed(1e3) - MU_D))
    right = max(abs(friction(0.0) - MU_ST), abs(friction(1e3) - MU_D))
    agree = right < 1e-12 and found.on_derived.holds and not found.on_print.holds
    return Finding(
        verdict=Verdict.CORRECTED if agree and wrong > 1e-12 else Verdict.REPRODUCED,
        value=f"as printed μ(0) = {as_printed(0.0):g}, μ(∞) = {as_printed(1e3):g}",
        error="none: two values of an elementary function",
        methods=("numbers at the parameters (7)", found.on_print.statement),
        tolerance="1e-12",
        explanation=(
            "It does not follow from (2) as printed. It does with μ_d in front, and shows that "
            "this is what was meant."
        ),
    )


def _spring() -> Finding:
    """Scale (1) with random dimensional parameters and read the coefficient off (5)."""
    from derivations import catalogue
    from derivations.printed import judge, printed

    generator = np.random.default_rng(4)
    gaps = []
    for m, k, eta_c, force in generator.uniform(0.5, 3.0, (5, 4)):
        # The coefficient of (2y_n - …) in (1), divided by that of y'' and the square of ω_n.
        length = force / k
        gaps.append(abs(eta_c * length / (m * length * (k / m)) - eta_c / k))
    found = judge(printed(5), catalogue.load("friction"))
    right = max(gaps) < 1e-12 and found.on_derived.holds
    return Finding(
        verdict=Verdict.CORRECTED if right else Verdict.NOT_REPRODUCED,
        value="the spring is η_c; c = η_c/k is dimensionless",
        error=f"{max(gaps):.0e} at five random sets of dimensional parameters",
        methods=("scaling of (1) with numbers", found.on_derived.statement),
        tolerance="1e-12: rounding",
        explanation="The text before (1) calls the spring c, (1) calls it η_c, (4) defines c.",
        erratum=Erratum(
            Fault.INCONSISTENT,
            "“via a linear spring $c$”",
            "via a linear spring $\\eta_c$",
            "The letter c is the dimensionless coupling of (4), as in all figures.",
            f"(1) scaled by (4) gives (5) only with c = η_c/k (off by {max(gaps):.0e}).",
            "Nothing else.",
        ),
    )


def _length() -> Finding:
    """Scale a velocity by ω_n x_0 for x_0 = y_0 and for another length."""
    from derivations import catalogue
    from derivations.printed import judge, printed

    generator = np.random.default_rng(5)
    gaps, others = [], []
    for omega, y_0, rate, other in generator.uniform(0.5, 3.0, (5, 4)):
        # y = sin(rate t), differentiated by τ = ω t after division by y_0, against dy/dt scaled.
        step = 1e-5
        slope = (math.sin(rate * step / omega) - math.sin(-rate * step / omega)) / (2 * step * y_0)
        gaps.append(abs(rate / (omega * y_0) - slope))
        others.append(abs(rate / (omega * other) - slope))
    found = judge(printed(5), catalogue.load("friction"))
    right = max(gaps) < 1e-8 < min(others) and found.on_print.holds
    return Finding(
        verdict=Verdict.CORRECTED if right else Verdict.NOT_REPRODUCED,
        value="x_0 = y_0",
        error="none: an identity",
        methods=("numerical derivative of a scaled displacement", found.on_derived.statement),
        tolerance="1e-8: error of the derivative; any other length fails by more",
        explanation="x_0 is defined nowhere. The derivative of y/y_0 by ω_n t has y_0 in it.",
        erratum=Erratum(
            Fault.MISPRINT,
            "$\\tilde v_{rel} = \\frac{v_{rel}}{\\omega_n x_0}$",
            "$\\tilde v_{rel} = \\frac{v_{rel}}{\\omega_n y_0}$",
            "x_0 is not defined; (4) has y_0.",
            f"With any other length the scaled velocity is off (by {min(others):.2g} or more in "
            "five random cases).",
            "Nothing else.",
        ),
    )


def _ends() -> Finding:
    """Look whether uniform steady sliding is an equilibrium of (1) with literal and free ends."""
    from theory.envelope import coupling_matrix
    from theory.vdp_chain import Ends

    sites, c, belt = 31, 0.02, 1.25
    sliding = np.full(sites, friction(belt))
    literal = 2.0 * np.eye(sites) - np.eye(sites, k=1) - np.eye(sites, k=-1)
    pull = {
        "literal": float(np.abs(c * literal @ sliding).max()),
        "free": float(np.abs(c * coupling_matrix(sites, Ends.FREE) @ sliding).max()),
    }
    by_hand = c * friction(belt)
    agree = abs(pull["literal"] - by_hand) < 1e-12 and pull["free"] < 1e-12
    return Finding(
        verdict=Verdict.PARTIAL if agree else Verdict.NOT_REPRODUCED,
        value=f"unbalanced force on a uniform chain at c = 0.02: {pull['literal']:.4f} at the ends "
        "by (1) with missing neighbours at zero, none with one neighbour",
        error="1e-16: rounding",
        methods=("the matrices of both chains", f"by hand c μ(v_d) = {by_hand:.4f}"),
        tolerance="1e-12: rounding",
        explanation=(
            "The words are right, (1) is not written for sites 1 and N. Free ends mean one "
            "neighbour and the term y_1 - y_2; then uniform steady sliding is an equilibrium at "
            "every c, as Figs. 3 to 6 need. (1) taken literally, with y_0 = y_{N+1} = 0, ties the "
            "ends to the ground."
        ),
        erratum=Erratum(
            Fault.AMBIGUOUS,
            "(1) at $n = 1$ and $n = N_{dof}$, with “free-free boundary conditions”",
            "one neighbour at the ends: $\\eta_c(y_1 - y_2)$ and $\\eta_c(y_N - y_{N-1})$",
            "(1) needs sites 0 and N + 1, which do not exist.",
            f"With them at zero a uniform chain is pulled by {pull['literal']:.4f} at its ends.",
            "All thresholds of Model I with excitation at an edge.",
        ),
    )


def _trapezoid() -> Finding:
    """Advance a harmonic oscillator by the trapezoidal rule and by backward Euler."""
    step, turns = 0.1, 200
    generator = np.array([[0.0, 1.0], [-1.0, 0.0]])
    eye = np.eye(2)
    rule = np.linalg.solve(eye - 0.5 * step * generator, eye + 0.5 * step * generator)
    state = np.linalg.matrix_power(rule, round(turns * 2 * math.pi / step)) @ [1.0, 0.0]
    drift = abs(float(np.hypot(*state)) - 1.0)
    factors = [abs((1 + 0.5j * z) / (1 - 0.5j * z)) for z in np.geomspace(1e-3, 1e3, 61)]
    off = max(abs(factor - 1.0) for factor in factors)
    return Finding(
        verdict=Verdict.REPRODUCED if max(drift, off) < 1e-10 else Verdict.NOT_REPRODUCED,
        value=f"amplitude after {turns} turns off by {drift:.0e}",
        error="rounding",
        methods=("200 turns of an oscillator", f"|amplification factor| - 1 is at most {off:.0e}"),
        tolerance="1e-10, far above rounding",
        explanation=(
            "True of the rule at a fixed step, for smooth slip. It says nothing of its phase, nor "
            "of the steps in which an oscillator passes from slip to stick."
        ),
    )


def _band() -> Finding:
    """Compare the cycle with a stick band of 1e-4 with the cycle without one."""
    belt = 1.25
    _, duration, landing = slip_from_stick(belt)
    _, duration_band, landing_band = slip_from_stick(belt, 1e-4)
    period = duration + (MU_ST - 2.0 * XI * belt - landing) / belt
    period_band = duration_band + (MU_ST - 2.0 * XI * belt - landing_band) / belt
    change = abs(period_band / period - 1.0)
    steps = slip_by_steps(belt, 2e-3)
    return Finding(
        verdict=Verdict.REPRODUCED if change < 1e-2 and steps == 0.0 else Verdict.PARTIAL,
        value=f"the period of the cycle changes by {change:.1e} of itself",
        error="1e-9: tolerance of the integration",
        methods=("slip by an 8th-order pair with events", "slip by fixed steps returns to stick"),
        tolerance="1e-2 of the period: what a figure shows",
        explanation=(
            "The text asserts only that the band was used. For the cycle of one cell at "
            f"v_d = {belt:g} it makes no visible difference. Its effect near a grazing contact and "
            "on thresholds of the chain is another matter."
        ),
    )


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


def _parameters() -> Finding:
    """See which of the equations named hold with the parameters (7)."""
    from derivations import catalogue
    from derivations.printed import judge, printed

    derivation = catalogue.load("friction")
    five, seven = (judge(printed(number), derivation) for number in (5, 7))
    fine = five.on_derived.holds and seven.on_derived.holds
    return Finding(
        verdict=Verdict.CORRECTED if fine else Verdict.NOT_REPRODUCED,
        value="(7) belongs to (5), not to (1)",
        error="none",
        methods=(five.on_derived.statement, seven.on_derived.statement),
        tolerance="a set of dimensionless numbers fits a dimensionless equation only",
        explanation=(
            "(7) gives ξ and the scaled v_0, which (1) does not contain; m, d, k, F_N are given "
            "nowhere and are not needed."
        ),
        erratum=Erratum(
            Fault.INCONSISTENT,
            "“the set of equations (1)” before (7)",
            "the set of equations (5)",
            "(7) holds dimensionless parameters, (1) has dimensional ones.",
            f"(5) with the scales of (4): {five.on_derived.statement}.",
            "Nothing else.",
        ),
    )


CLAIMS = (
    Claim(
        "text-friction-limits",
        "Section 1.1, after Eq. (2)",
        "From (2) it follows that μ(0) = μ_st and μ(∞) = μ_d.",
        "μ_st, μ_d",
        Verdict.CORRECTED,
        "fronts derive --equation 2",
        _limits_of_friction,
    ),
    Claim(
        "text-spring",
        "Section 1.1, before Eq. (1)",
        "Neighbours are coupled by a linear spring c.",
        "c",
        Verdict.CORRECTED,
        "fronts derive --equation 5",
        _spring,
        weight=0,
    ),
    Claim(
        "text-length",
        "Section 1.1, after Eq. (5)",
        "The relative velocity is scaled by ω_n x_0.",
        "x_0",
        Verdict.CORRECTED,
        "fronts derive --equation 5",
        _length,
        weight=0,
    ),
    Claim(
        "text-ends",
        "Section 1.1, after Eq. (1)",
        "(1) has free-free boundary conditions.",
        None,
        Verdict.PARTIAL,
        "fronts check text-ends",
        _ends,
    ),
    Claim(
        "text-trapezoid",
        "Section 1.1",
        "The trapezoidal rule of ode23t has no numerical damping.",
        None,
        Verdict.REPRODUCED,
        "fronts check text-trapezoid",
        _trapezoid,
        weight=0,
    ),
    Claim(
        "text-band",
        "Section 1.1",
        "An oscillator may be taken to stick where the relative velocity is below 10⁻⁴.",
        "10⁻⁴",
        Verdict.REPRODUCED,
        "fronts check text-band",
        _band,
        weight=0,
    ),
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
    Claim(
        "text-parameters",
        "Section 1.2, before Eq. (7)",
        "The parameters (7) are those of the chain (1).",
        "(1)",
        Verdict.CORRECTED,
        "fronts derive --equation 7",
        _parameters,
        weight=0,
    ),
    untestable(
        "text-excited",
        "Section 1.2, after Eq. (7)",
        "Excited oscillators start close to the stick-slip cycle, the others near steady sliding.",
        "How close is not given: the initial displacements are missing, only zero velocity is. "
        "Thresholds depend on them; each of ours names its start.",
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
