"""What the text asserts about the set-up of Model I (section 1.1 and the start of 1.2)."""

from __future__ import annotations

import math

import numpy as np

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
from paper_checks.claims._friction_cell import (
    friction,
)
from paper_checks.claims._text import untestable


def _spring() -> Finding:
    """Compare eigenfrequencies of (1), over ω_n, with those of (5) for c = η_c/k and c = η_c."""
    from derivations import catalogue
    from derivations.judgement import judge, printed

    generator = np.random.default_rng(4)
    springs = 2.0 * np.eye(5) - np.eye(5, k=1) - np.eye(5, k=-1)
    springs[0, 0] = springs[-1, -1] = 1.0
    gaps: list[float] = []
    others: list[float] = []
    for m, k, eta_c in generator.uniform(0.5, 3.0, (5, 3)):
        frequencies = np.sqrt(np.linalg.eigvalsh((k * np.eye(5) + eta_c * springs) / m))
        scaled = frequencies / math.sqrt(k / m)
        for c, off in ((eta_c / k, gaps), (eta_c, others)):
            expected = np.sqrt(np.linalg.eigvalsh(np.eye(5) + c * springs))
            off.append(float(np.abs(scaled - expected).max()))
    found = judge(printed(5), catalogue.load("friction"))
    right = max(gaps) < 1e-12 and min(others) > 1e-3 and found.on_derived.holds
    return Finding(
        verdict=Verdict.CORRECTED if right else Verdict.NOT_REPRODUCED,
        value="the spring is η_c; c = η_c/k is dimensionless",
        error=f"{max(gaps):.0e} in the frequencies at five random sets of dimensional parameters",
        methods=(
            "eigenfrequencies of five undamped sites by (1) and by (5)",
            found.on_derived.statement,
        ),
        tolerance="1e-12: rounding; with c = η_c they must differ by more than 1e-3",
        explanation="The text before (1) calls the spring c, (1) calls it η_c, (4) defines c.",
        erratum=Erratum(
            Fault.INCONSISTENT,
            "“via a linear spring $c$”",
            "via a linear spring $\\eta_c$",
            "The letter c is the dimensionless coupling of (4), as in all figures.",
            f"Eigenfrequencies of (1) over ω_n are those of (5) with c = η_c/k (to {max(gaps):.0e})"
            f" and not with c = η_c (off by {min(others):.2g} or more).",
            "Nothing else.",
        ),
    )


def _length() -> Finding:
    """Scale a velocity by ω_n x_0 for x_0 = y_0 and for another length."""
    from derivations import catalogue
    from derivations.judgement import judge, printed

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
    from theory.averaged.envelope import coupling_matrix
    from theory.chains.chain import Ends

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


def _parameters() -> Finding:
    """See which of the equations named hold with the parameters (7)."""
    from derivations import catalogue
    from derivations.judgement import judge, printed

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
)
