"""What the text of sections 2 to 2.2 (Model II, breathers) asserts beside its figures."""

from __future__ import annotations

import math

import numpy as np

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
from paper_checks.claims._breathers import EPS, A, B
from paper_checks.claims._text import untestable
from paper_checks.following import following

SETS = ((2.5, 0.5), (4.0, 0.5))
"""The (a, b) of Figs. 7-11, and of Figs. 12, 13, 16, 17."""


def _turn(a: float, b: float, height: float) -> float:
    """Return the next largest y after one of the given height, for one cell of (8)."""
    from scipy.integrate import solve_ivp

    def rate(_: float, state: np.ndarray) -> list[float]:
        y, w = state
        return [w, -y - EPS * w * (1.0 - a * y * y + b * y**4)]

    run = solve_ivp(
        rate,
        (0.0, 9.0),
        [height, 0.0],
        method="DOP853",
        rtol=1e-11,
        atol=1e-13,
        dense_output=True,
    )
    from scipy.optimize import brentq

    end = brentq(lambda t: run.sol(t)[1], 5.0, 8.0)
    return float(run.sol(end)[0])


def _cell() -> Finding:
    """Find both cycles of one cell as fixed points of its return map, and their stability."""
    from scipy.optimize import brentq

    from theory.vdp_chain import VdpChain

    rows = []
    for a, b in SETS:
        chain = VdpChain(a, b, 0.0, EPS)
        for predicted in (chain.unstable_amplitude, chain.stable_amplitude):
            cycle = float(
                brentq(
                    lambda y, a=a, b=b: _turn(a, b, y) - y, 0.8 * predicted, 1.1 * predicted
                )
            )
            slope = (_turn(a, b, cycle + 1e-4) - _turn(a, b, cycle - 1e-4)) / 2e-4
            rows.append((a, predicted, cycle, slope))
    rest = [_turn(a, b, 0.01) / 0.01 for a, b in SETS]
    gap = max(abs(cycle / predicted - 1.0) for _, predicted, cycle, _ in rows)
    inner, outer = [row[3] for row in rows[::2]], [row[3] for row in rows[1::2]]
    right = max(rest) < 1.0 and min(inner) > 1.0 and max(outer) < 1.0 and gap < 0.05
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value="; ".join(
            f"a = {a:g}: |y| = {cycle:.5f}, multiplier {slope:.4f}" for a, _, cycle, slope in rows
        ),
        error="1e-8 in the amplitudes, 1e-6 in the multipliers",
        methods=(
            "fixed points of the return map of one cell of (8), ε = 0.01",
            f"the averaged cell: the amplitudes agree to {gap:.1e}, of the order of ε_eff²",
        ),
        tolerance="a multiplier below one is stable; 5 per cent between amplitudes",
        explanation=(
            "At the parameters of the figures the rest state is stable too. In general this needs "
            "η = b/a² < 1/8; beyond it damping is positive at every amplitude and there is no "
            "cycle. The text does not give this bound."
        ),
    )


def _inner_cycle() -> Finding:
    """Find the unstable cycle of the friction cell at v_d = 1.25 and what is on its two sides."""
    from scipy.integrate import solve_ivp

    from paper_checks.claims._friction_cell import friction, hopf_speed, slip_from_stick, slip_rate

    belt = 1.25
    centre = friction(belt)
    rate = slip_rate(belt)

    def height_after(w: float, turns: int = 1) -> float:
        """Return y' at the centre after some turns of slip."""

        def passes(_: float, state: np.ndarray) -> float:
            return float(state[0] - centre)

        state = np.array([centre, w])
        for _ in range(turns):
            run = solve_ivp(
                rate,
                (0.0, 7.5),
                state,
                method="DOP853",
                rtol=1e-11,
                atol=1e-13,
                dense_output=True,
            )
            times = np.linspace(5.0, 7.4, 200)
            values = np.array([passes(t, run.sol(t)) for t in times])
            at = int(np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))[0])
            low, high = times[at], times[at + 1]
            for _ in range(50):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if run.sol(middle)[0] < centre else (low, middle)
            state = np.asarray(run.sol(low))
        return float(state[1])

    from scipy.optimize import brentq

    cycle = float(brentq(lambda w: height_after(w) - w, 0.2, 1.1, xtol=1e-10))
    slope = (height_after(cycle + 1e-4) - height_after(cycle - 1e-4)) / 2e-4
    inside, outside = height_after(0.9 * cycle, 5), height_after(1.1 * cycle, 5)
    sticks = slip_from_stick(belt)[0] > -1e-12
    # The averaged cell: linear damping and the cubic term of (2) about steady sliding.
    strength = 0.5 / 0.5 * math.exp(-belt / 0.5)
    cubic = 0.5 / 0.5**3 * math.exp(-belt / 0.5) / 6.0
    averaged = math.sqrt((0.1 - strength) / (0.75 * cubic))
    right = slope > 1.0 and inside < 0.9 * cycle and outside > 1.1 * cycle and sticks
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value=f"at v_d = 1.25: unstable cycle through y' = {cycle:.6f}, multiplier {slope:.4f}; "
        "outside it stick-slip, inside it steady sliding",
        error="1e-9 in y'",
        methods=(
            "fixed point of the return map of the slip equation",
            f"averaging to third order: amplitude {averaged:.3f}; five turns on either side",
        ),
        tolerance="the multiplier must exceed one, and runs on both sides must part",
        explanation=(
            f"The unstable cycle exists for v_d above {hopf_speed():.4f}, where it is born from "
            "steady sliding, up to where it meets the stick-slip cycle (text-regions)."
        ),
    )


def _small() -> Finding:
    """Compare the ripple of the cycle with ε and with the number that governs averaging."""
    from scipy.integrate import solve_ivp

    from theory.vdp_chain import VdpChain, effective_epsilon

    rows = []
    for a, b in SETS:
        ripples = []
        for eps in (EPS, EPS / 4.0):
            chain = VdpChain(a, b, 0.0, eps)

            def rate(_: float, state: np.ndarray, chain: VdpChain = chain) -> list[float]:
                y, w = state
                return [w, -y - chain.eps * w * (1.0 - chain.a * y * y + chain.b * y**4)]

            settle = 2.5 / eps  # the slower cycle forgets e^{-7} of its start
            run = solve_ivp(
                rate,
                (0.0, settle),
                [chain.stable_amplitude, 0.0],
                method="DOP853",
                rtol=1e-9,
                atol=1e-10,
                t_eval=np.linspace(settle - 2 * math.pi, settle, 400),
            )
            size = np.hypot(*run.y)
            ripples.append(float((size.max() - size.min()) / size.mean()))
        rows.append((a, effective_epsilon(VdpChain(a, b, 0.0, EPS)), *ripples))
    orders = [math.log(row[2] / row[3]) / math.log(4.0) for row in rows]
    return Finding(
        verdict=Verdict.PARTIAL if max(row[2] for row in rows) > 0.1 else Verdict.REPRODUCED,
        value="; ".join(
            f"a = {a:g}: ε_eff = {effective:.3f}, ripple {ripple:.1%} of |ẏ + iy|"
            for a, effective, ripple, _ in rows
        ),
        error="0.1 % of the ripple",
        methods=(
            "largest damping factor on the cycle times ε",
            "direct integration of one cell, at ε and at ε/4: observed orders "
            + ", ".join(f"{order:.2f}" for order in orders),
        ),
        tolerance="a ripple above a tenth: no longer small",
        explanation=(
            "What must be small for averaging is ε max|1 - a y² + b y⁴| on the cycle, not ε. At "
            "a = 4, b = 0.5 it is fifty times ε = 0.01. The cycle is nearly a sinusoid there all "
            "the same; what averaging gets wrong elsewhere is measured with each figure."
        ),
    )


def _substitution() -> Finding:
    """Put (14) into (10) and into (11) and compare with (15)."""
    import sympy as sp

    from derivations.multiple_scales_symbols import Y
    from derivations.printed import printed
    from derivations.symbols import omega, t, t_hat

    fifteen = printed(15).equation
    ten, eleven = printed(10).equation, printed(11).equation
    wave = sp.sin
    has = {
        number: bool(equation.args[0].atoms(wave))
        for number, equation in ((10, ten), (11, eleven), (15, fifteen))
    }
    forcing = [part for part in eleven.args[0].atoms(wave)]
    turned = forcing[0].subs(t, t_hat / omega) if forcing else sp.Integer(0)
    same = bool(fifteen.args[0].atoms(wave)) and sp.simplify(
        turned - next(iter(fifteen.args[0].atoms(wave)))
    ) == 0
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

    from derivations.printed import printed
    from derivations.symbols import c, k_2, omega_1, theta
    from theory.vdp_chain import VdpChain
    from verification.envelope_breather import solve_envelope_breather
    from verification.nucleus import Nucleus

    second = printed(25).equation.args[1].args[0]
    at = second.subs({theta: -sp.pi / 2, k_2: -sp.pi / 2})
    found = sp.solve(at, omega_1)
    exact = found == [c]
    numeric = abs(solve_envelope_breather(VdpChain(A, B, 0.1, EPS, 11), Nucleus(1)).omega - 0.1)
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
    from theory.breather import Reading, solve_breather
    from theory.vdp_chain import VdpChain

    chain = VdpChain(A, B, 0.1, EPS)
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


def _lone() -> Finding:
    """Look for other stable states above the largest printed threshold."""
    from theory.envelope import envelope_jacobian
    from theory.vdp_chain import VdpChain
    from verification.integrators.envelope_run import run_envelope

    chain = VdpChain(A, B, 0.25, EPS, 15)
    still = np.zeros(15, dtype=complex)
    uniform = np.full(15, chain.stable_amplitude, dtype=complex)
    rates = {}
    for name, state in (("rest", still), ("uniform cycle", uniform)):
        growth = np.sort(np.linalg.eigvals(envelope_jacobian(state, chain)).real)[::-1]
        rates[name] = float(growth[0] if name == "rest" else growth[1])
    noise = np.random.default_rng(2).normal(size=(2, 15)) * 1e-3
    kicks = noise[0] + 1j * noise[1]
    after_rest = np.abs(run_envelope(chain, still + kicks, 60.0).phi).max()
    after_cycle = np.abs(np.abs(run_envelope(chain, uniform + kicks, 60.0).phi) - uniform.real)
    left = float(after_rest), float(after_cycle.max())
    others = max(rates.values()) < 0.0 and max(left) < 1e-4
    return Finding(
        verdict=Verdict.PARTIAL if others else Verdict.REPRODUCED,
        value="at c = 0.25 the rest state and the uniform cycle are stable as well",
        error="growth rates per unit εt: "
        + ", ".join(f"{name} {rate:+.4f}" for name, rate in rates.items()),
        methods=(
            "eigenvalues of the averaged chain (the trivial one of the cycle apart)",
            f"runs from a perturbation of 1e-3: {left[0]:.0e} and {left[1]:.0e} are left of it",
        ),
        tolerance="a growth rate below zero is stable; less than a tenth of the perturbation left",
        explanation=(
            "The sentence is a conjecture about breathers and fronts. Among all motions the front "
            "is not alone: the chain at rest and the chain all excited are stable at every "
            "coupling, and on a finite chain a front ends in the second one. What becomes of "
            "breathers is judged under fig11-patterns."
        ),
    )


def _limit_of_sizes() -> Finding:
    """Compare the threshold of size 3 with those that no longer change with size."""
    from theory.vdp_chain import VdpChain
    from verification.breather_threshold import Method, breather_threshold
    from verification.nucleation import Preparation, escape_threshold
    from verification.nucleus import Nucleus, outward_pattern

    chain = VdpChain(A, B, 0.0, EPS)
    folds = {
        size: breather_threshold(chain, Nucleus(size, outward_pattern(size)), Method.ENVELOPE)
        for size in (3, 5, 7)
    }
    runs = {size: escape_threshold(chain, Preparation(size), tolerance=1e-4) for size in (3, 5)}
    for size, run in runs.items():
        if abs(run.c - folds[size].c) > run.error + folds[size].error:
            raise ArithmeticError(f"size {size}: run {run.c:.6f}, fold {folds[size].c:.6f}")
    step, rest = folds[3].c - folds[5].c, abs(folds[5].c - folds[7].c)
    apart = step > 10.0 * rest and step > runs[3].error + runs[5].error
    return Finding(
        verdict=Verdict.CORRECTED if apart else Verdict.REPRODUCED,
        value=", ".join(f"size {size}: {fold.c:.6f}" for size, fold in folds.items()),
        error=f"{max(fold.error for fold in folds.values()):.0e}, in the averaged chain",
        methods=("folds by continuation", "bisection of runs of the averaged chain"),
        tolerance="a step from 3 to 5 of ten times that from 5 to 7: not the limit",
        explanation=(
            f"Size 3 has the largest coupling, {step:.5f} above the value at which the curve "
            "stays. 0.2011 is a maximum over sizes, not the limit for large nuclei."
        ),
        erratum=Erratum(
            Fault.INCONSISTENT,
            "“a limiting value $\\bar c_{cr} = 0.2011$ (obtained for nucleus of size 3)”",
            "a largest value, at size 3; the limit for large nuclei is smaller",
            "The next sentence says that the value is constant from size 5 on.",
            f"Folds: {folds[3].c:.6f} at size 3, {folds[5].c:.6f} at 5, {folds[7].c:.6f} at 7.",
            "The end of the nucleation range in the last sentence of section 2.2.",
        ),
    )


CLAIMS = (
    Claim(
        "text-cell",
        "Section 2, before Eq. (8)",
        "The isolated Van der Pol cell has two stable states, a limit cycle and a fixed point.",
        None,
        Verdict.REPRODUCED,
        "fronts check text-cell",
        _cell,
    ),
    Claim(
        "text-inner-cycle",
        "Conclusions, Fig. 2",
        "The friction cell has an unstable cycle between steady sliding and stick-slip.",
        None,
        Verdict.REPRODUCED,
        "fronts check text-inner-cycle",
        _inner_cycle,
    ),
    Claim(
        "text-small",
        "Section 2, after Eq. (8)",
        "ε = 0.01 is a small parameter.",
        "ε ≪ 1",
        Verdict.REPRODUCED,
        "fronts check text-small",
        _small,
    ),
    following(
        "text-placing",
        "Section 2.1",
        "A breather arises from one particle placed close to the stable limit cycle.",
        "fig07-localised",
    ),
    following(
        "text-exponential",
        "Section 2.1",
        "The breather decays exponentially.",
        "fig07-decay",
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
    following(
        "text-detuning",
        "Section 2.1.1, after Eq. (28)",
        "Assumption (27), δ ≪ c, is to be confirmed by simulation.",
        "fig08-assumptions",
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
        "text-all-amplitudes",
        "Section 2.1.3, Eq. (38)",
        "(38) gives the amplitudes of all particles.",
        "fig07-decay",
        "fig08-amplitudes",
    ),
    following(
        "text-very-good",
        "Section 2.1.3, Fig. 8",
        "For n = 0 and n = 1 a very good match with simulation is observed.",
        "fig08-amplitudes",
    ),
    following(
        "text-crossing",
        "Section 2.1.4",
        "At about c = 0.195 two multipliers cross the unit circle: the breather loses stability.",
        "fig09-multipliers",
        printed="0.195",
    ),
    following(
        "text-to-larger",
        "Section 2.2",
        "Before a front forms, the breather of one particle gives way to larger nuclei.",
        "fig11-order",
        "fig10-stable",
    ),
    Claim(
        "text-lone",
        "Section 2.2",
        "When all breathers have lost stability the front is the lone stable solution.",
        None,
        Verdict.PARTIAL,
        "fronts check text-lone",
        _lone,
    ),
    untestable(
        "text-procedure",
        "Section 2.2",
        "Other breathers could be studied by the procedure of 2.1.",
        "It is said to be possible and not carried out: no ansatz for a larger nucleus is given.",
    ),
    following(
        "text-in-phase",
        "Section 2.2, Fig. 10",
        "Nuclei prepared in phase settle to a breather of the required size.",
        "fig10-in-phase",
    ),
    Claim(
        "text-limiting",
        "Section 2.2, Fig. 11",
        "The critical coupling has the limiting value 0.2011, obtained for size 3.",
        "0.2011",
        Verdict.CORRECTED,
        "fronts check text-limiting",
        _limit_of_sizes,
    ),
    following(
        "text-from-five",
        "Section 2.2, Fig. 11",
        "The critical coupling is constant from nucleus size 5 on.",
        "fig11-converged",
    ),
    following(
        "text-narrow",
        "Section 2.2",
        "Nucleation takes place in a narrow range, from c = 0.1916 to 0.2011.",
        "fig11-values",
        "fig11-order",
        printed="0.1916, 0.2011",
    ),
    following(
        "text-all-lost",
        "Section 2.2",
        "At c = 0.2011 all possible nuclei have lost stability.",
        "fig11-values",
        "fig11-patterns",
        printed="0.2011",
    ),
)
