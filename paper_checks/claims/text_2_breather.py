"""What the text of section 2.1 (Model II, the breather) asserts beside its figures."""

from __future__ import annotations

import math

import numpy as np

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
from paper_checks.claims._breathers import EPS, A, B, flow, monodromy_by_differences
from paper_checks.following import following

SETS = ((2.5, 0.5), (4.0, 0.5))
"""The (a, b) of Figs. 7-11, and of Figs. 12, 13, 16, 17."""


def _substitution() -> Finding:
    """Put (14) into (10) and into (11) and compare with (15)."""
    import sympy as sp

    from derivations.judgement import printed
    from derivations.multiple_scales.symbols import Y
    from derivations.symbols import omega, t, t_hat

    fifteen = printed(15).expression
    ten, eleven = printed(10).expression, printed(11).expression
    wave = sp.sin
    has = {
        number: bool(equation.args[0].atoms(wave))
        for number, equation in ((10, ten), (11, eleven), (15, fifteen))
    }
    forcing = list(eleven.args[0].atoms(wave))
    turned = forcing[0].subs(t, t_hat / omega) if forcing else sp.Integer(0)
    same = (
        bool(fifteen.args[0].atoms(wave))
        and sp.simplify(turned - next(iter(fifteen.args[0].atoms(wave)))) == 0
    )
    right = has == {10: False, 11: True, 15: True} and same and Y is not None
    return Finding(
        verdict=Verdict.CORRECTED if right else Verdict.NOT_REPRODUCED,
        value="(15) contains the forcing of (11); (10) has none",
        error="none: symbolic",
        methods=("the equations as printed, compared term by term", "ω t = t̂ in the forcing"),
        tolerance="equal or not",
        explanation="The unknown y_1 of (10) does not appear in (15), the wave of (11) does.",
        erratum=Erratum(
            Fault.MISPRINT,
            "“Substitution of (14) into (10)”",
            "Substitution of (14) into (11)",
            "(15) has the wave of (9) in the place of $y_1$, as (11) has.",
            "The forcing of (11) at $\\omega t = \\hat t$ equals that of (15); (10) contains none.",
            "Nothing else.",
        ),
    )


def _unknowns() -> Finding:
    """Solve (25) at the phases that (9) and (37) give, without (27)."""
    import sympy as sp

    from derivations.judgement import printed
    from derivations.symbols import c, k_2, omega_1, theta
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.breathers.envelope import solve_envelope_breather

    second = printed(25).expression.args[1].args[0]
    at = second.subs({theta: -sp.pi / 2, k_2: -sp.pi / 2})
    found = sp.solve(at, omega_1)
    exact = found == [c]
    numeric = abs(
        solve_envelope_breather(VdpChain(a=A, b=B, c=0.1, eps=EPS, sites=11), Nucleus(1)).omega
        - 0.1
    )
    return Finding(
        verdict=Verdict.PARTIAL if exact and numeric < 1e-9 else Verdict.REPRODUCED,
        value="ω_1 = c exactly, from (25) at θ = k_2 = -π/2",
        error=f"the averaged breather at c = 0.1 has |Ω - c| = {numeric:.0e}",
        methods=("(25) solved in computer algebra", "the breather of the averaged chain (34)"),
        tolerance="1e-9: above the tolerance of the solver",
        explanation=(
            "(26) alone does leave three unknowns, because squaring drops a phase. But (9) at "
            "n = 0 fixes θ and (37) fixes k_2, and then (25) gives ω_1 = c without assuming "
            "anything."
        ),
    )


def _extraction() -> Finding:
    """Solve (29) with (37) at n = 0, 1 and in the tail, and search at random as well."""
    from theory.averaged.breather import Reading, solve_breather
    from theory.chains.vdp import VdpChain

    chain = VdpChain(a=A, b=B, c=0.1, eps=EPS)
    closed = {reading: solve_breather(chain, reading) for reading in Reading}
    generator = np.random.default_rng(37)
    hits = {
        site: _solutions(site, chain.c, generator.uniform((1.0, 0.02), (3.5, 0.95), (150, 2)))
        for site in (0, 1)
    }
    alpha, decay = closed[Reading.NEIGHBOUR].alpha_0, closed[Reading.NEIGHBOUR].decay
    if alpha is None or decay is None or not hits[1]:
        raise ArithmeticError("no solution at n = 1: the closed form and the search must find one.")
    gap = min(math.hypot(a - alpha, z - decay) for a, z in hits[1])
    none = closed[Reading.CENTRE].alpha_0 is None and not hits[0]
    listed = ", ".join(f"({a:.4f}, {z:.4f})" for a, z in hits[1])
    return Finding(
        verdict=Verdict.PARTIAL if none and gap < 1e-8 else Verdict.NOT_REPRODUCED,
        value=f"n = 1: α_0 = {alpha:.6f}, e^(k_1) = {decay:.6f} at c = 0.1; n = 0: no solution",
        error=f"closed branch and search differ by {gap:.0e}",
        methods=("the branch in closed form", "Newton's method from 150 random starts a site"),
        tolerance="1e-8 between both",
        explanation=(
            "It is possible once n is chosen. At the centre, where (29) holds, (37) contradicts "
            "it. At n = 1 the pair does not have one solution: the search finds "
            f"{len(hits[1])} with 0 < e^(k_1) < 1, (α_0, e^(k_1)) = {listed}. One of them joins "
            "the stable cycle of a cell as c → 0 with e^(k_1) → 0; that one is the breather. In "
            f"the linear tail α_0 = {closed[Reading.TAIL].alpha_0:.6f}."
        ),
    )


def _solutions(site: int, c: float, starts: np.ndarray) -> list[tuple[float, float]]:
    """Return the solutions of (29) and (37) with 0 < e^{k_1} < 1 that Newton's method finds."""
    from scipy.optimize import root

    def equations(x: np.ndarray) -> list[float]:
        alpha, z = x
        near = alpha * z**site
        gain = (-B * alpha**4 + 2 * A * alpha**2 - 8) / (16 * c)
        return [gain - z, 0.5 - A * near**2 / 8 + B * near**4 / 16 - 0.5 * c * (1 / z - z)]

    found: list[tuple[float, float]] = []
    for start in starts:
        trial = root(equations, start, tol=1e-13)
        alpha, z = (float(value) for value in trial.x)
        fits = max(map(abs, equations(trial.x))) < 1e-10 and 0 < z < 1 and alpha > 0
        if fits and all(math.hypot(alpha - a, z - b) > 1e-6 for a, b in found):
            found.append((alpha, z))
    return sorted(found, reverse=True)


STABLE, UNSTABLE = (1, 0.15), (3, 0.15)
"""Nucleus sizes and couplings of a stable breather and of one that a multiplier has left."""


def _escape() -> Finding:
    """Perturb a breather inside and one outside, and time what becomes of the perturbation."""
    from theory.chains.nucleus import Nucleus, outward_pattern
    from theory.chains.vdp import VdpChain
    from verification.breathers.orbits import solve_orbit

    turns, rows = 8, []
    for size, c in (STABLE, UNSTABLE):
        nucleus = Nucleus(size, outward_pattern(size))
        orbit = solve_orbit(VdpChain(a=A, b=B, c=c, eps=EPS, sites=9), nucleus)
        if orbit.multipliers is None:
            raise ArithmeticError(f"no multipliers of size {size}")
        values, vectors = np.linalg.eig(monodromy_by_differences(orbit.state, c, orbit.period))
        ours = np.sort(np.abs(orbit.multipliers.values))[::-1]
        apart = np.argsort(np.abs(values - 1.0))[1:]
        lead = apart[int(np.argmax(np.abs(values[apart])))]
        kick = 1e-5 * np.real(vectors[:, lead] / np.linalg.norm(vectors[:, lead]))
        starts = np.column_stack([orbit.state, orbit.state + kick, orbit.state - kick])
        ends = flow(starts, c, turns * orbit.period)
        grown = np.linalg.norm(ends[:, 1] - ends[:, 2]) / np.linalg.norm(2.0 * kick)
        rows.append((size, c, float(np.abs(values[lead])), float(grown ** (1.0 / turns))))
        if np.abs(ours - np.abs(values[lead])).min() > 1e-6:
            raise ArithmeticError(f"size {size}: no multiplier {np.abs(values[lead]):.7f} by ours")
    gap = max(abs(multiplier - growth) for _, _, multiplier, growth in rows)
    right = gap < 1e-4 and rows[0][3] < 1.0 < rows[1][3]
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value="; ".join(
            f"size {size}, c = {c:g}: multiplier {multiplier:.6f}, a perturbation changes by "
            f"{growth:.6f} a period"
            for size, c, multiplier, growth in rows
        ),
        error=f"{gap:.0e} between the two",
        methods=(
            "multipliers of the periodic orbit, trivial one apart: variational equations and "
            "differences of scipy's flow",
            f"scipy's runs of (8) from the orbit perturbed by 1e-5, over {turns} periods",
        ),
        tolerance="1e-4: a perturbation of 1e-5 is linear to about as much",
        explanation=(
            "As theory has it: inside the unit circle a perturbation decays, outside it grows, at "
            "the rate of the multiplier. The multiplier one along the orbit is always there. Along "
            "an orbit that is only approximate it is not exactly one (fig09-multipliers)."
        ),
    )


CLAIMS = (
    Claim(
        "text-escape",
        "Section 2.1.4, before Fig. 9",
        "Loss of stability corresponds to the escape of multipliers from the unit circle.",
        None,
        Verdict.REPRODUCED,
        "fronts breather --a 2.5 --b 0.5 --c 0.15 --method all",
        _escape,
        weight=0,
    ),
    following(
        "text-constant-rates",
        "Section 2.1, after Eq. (9)",
        "k_1 and k_2 are constants.",
        "eq09",
        "fig07-decay",
    ),
    Claim(
        "text-substitution",
        "Section 2.1.1, before Eq. (15)",
        "Equation (15) is (14) put into (10).",
        "(10)",
        Verdict.CORRECTED,
        "fronts derive --equation 15",
        _substitution,
        weight=0,
    ),
    Claim(
        "text-unknowns",
        "Section 2.1.1, after Eq. (26)",
        "(26) has three unknowns, so an assumption on ω_1 is needed.",
        None,
        Verdict.PARTIAL,
        "fronts derive --equation 26",
        _unknowns,
    ),
    Claim(
        "text-extraction",
        "Section 2.1.3",
        "α_0 and k_1 can be extracted numerically from (29) and (37).",
        None,
        Verdict.PARTIAL,
        "fronts breather --c 0.1 --method closed-form",
        _extraction,
    ),
    following(
        "text-self-consistent-amplitude",
        "Section 2.1.1, before Eq. (26)",
        "For self-consistency α_0 = 2R.",
        "eq26",
        printed="α_0 = 2R",
    ),
    following(
        "text-all-amplitudes",
        "Section 2.1.3, Eq. (38)",
        "(38) gives the amplitudes of all particles.",
        "fig07-decay",
        "fig08-amplitudes",
    ),
)
