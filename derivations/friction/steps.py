"""From Newton's law to the dimensionless chain and the stability of its steady sliding."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.balance import BalancePower
from derivations.algebra.equations import equation
from derivations.algebra.expansion import Linearise
from derivations.algebra.lattice import InsertPlaneWave
from derivations.algebra.rearrangement import Divide, Form, Join, Rewrite, Take, TakeCoefficient
from derivations.algebra.solution import PrescribeCoefficients, SolveFor, SolveLimits
from derivations.algebra.steps import Derivation, Draft
from derivations.algebra.substitution import (
    ChangeVariables,
    Eliminate,
    Substitute,
    TakeBranch,
    alike,
)
from derivations.friction.law_checks import LawChecks
from derivations.friction.model import PAPER, FrictionModel
from derivations.friction.scaling_checks import ScalingChecks
from derivations.friction.sliding_checks import SlidingChecks
from derivations.friction.symbols import (
    F_N,
    F,
    F_tilde,
    R,
    c,
    d,
    eta_c,
    mu,
    mu_d,
    mu_fall,
    mu_far,
    mu_st,
    n,
    omega_n,
    q,
    rate,
    s,
    t,
    tau,
    v_0,
    v_hopf,
    v_rel,
    v_tilde_0,
    v_tilde_d,
    v_tilde_rel,
    xi,
    y,
    y_0,
    y_star,
    y_tilde,
    z,
)

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


def derive(chain: FrictionModel = PAPER) -> Derivation:
    """Derive Eqs. (1)-(7), the stability of steady sliding, and the cycle that never sticks.

    Parameters
    ----------
    chain : FrictionModel
        The chain; that of the paper by default.
    """
    draft, law_checks, scaling_checks = Draft(), LawChecks(chain), ScalingChecks(chain)
    _given(draft, chain, law_checks, scaling_checks)
    _scaled(draft, chain, law_checks, scaling_checks)
    _sliding(draft, chain, law_checks, SlidingChecks(chain))
    title = "Model I: scales, steady sliding, its stability and the cycle of pure slip (Eqs. 1-7)"
    return draft.finished("friction", title)


def _given(
    draft: Draft, chain: FrictionModel, law_checks: LawChecks, scaling_checks: ScalingChecks
) -> None:
    falling = mu_far + mu_fall * chain.decay(sp.Abs(v_rel) / v_0)
    law = sp.Tuple(
        equation(F, -sp.sign(v_rel) * F_N * mu(v_rel)), sp.Ne(v_rel, 0),
        sp.Le(sp.Abs(F), mu_st * F_N), equation(v_rel, 0),
    )
    scales = sp.Tuple(equation(y(n, t), y_0 * y_tilde(n, tau)), equation(tau, omega_n * t),
                      equation(F, F_N * F_tilde))
    velocities = sp.Tuple(equation(v_rel, omega_n * y_0 * v_tilde_rel),
                          equation(v_0, omega_n * y_0 * v_tilde_0),
                          equation(F, F_N * F_tilde))
    draft.model("equation of motion", chain.newton(),
                "Newton's law for site n between its neighbours",
                check=scaling_checks.newton, number=1)
    draft.model("falling friction", equation(mu(v_rel), falling),
                "friction falls with speed from one value to another, with reference velocity v₀",
                check=law_checks.falling)
    draft.definition("friction at rest and at speed",
                     sp.Tuple(equation(mu(sp.S.Zero), mu_st), equation(mu(sp.oo), mu_d)),
                     "the limits that the text states below (2)",
                     check=law_checks.limits)
    draft.model("friction law", law,
                "friction opposes slip; in stick it takes whatever value balances, up to the "
                "limit from which slip starts", check=law_checks.law, number=3)
    draft.ansatz("scales", scales, "scaled displacement, time and force",
                 check=scaling_checks.scales)
    draft.definition("scaled velocities", velocities,
                     "velocities in units of ωₙ y₀, the reference velocity too",
                     check=scaling_checks.velocities)
    parameters = (equation(own, value) for own, value in chain.parameters.items())
    draft.definition("parameters", sp.Tuple(*parameters),
                     "the parameters of all simulations of model I",
                     check=scaling_checks.parameters, number=7)
    draft.definition("relative velocity",
                     equation(v_tilde_rel, y_tilde(n, tau).diff(tau) - v_tilde_d),
                     "velocity of the site relative to the belt",
                     check=scaling_checks.relative)


def _scaled(
    draft: Draft, chain: FrictionModel, law_checks: LawChecks, scaling_checks: ScalingChecks
) -> None:
    draft.derived("friction coefficient", SolveLimits(v_rel, (mu_far, mu_fall)), "falling friction",
                  "friction at rest and at speed", check=law_checks.coefficient, number=2)
    draft.derived("scaled equation of motion", (ChangeVariables(t, tau), Divide(F_N)),
                  "equation of motion", "scales", check=scaling_checks.in_scales)
    here = y_tilde(n, tau)
    sites = tuple(y_tilde(n + sign * distance, tau)
                  for distance in chain.springs for sign in (1, -1))
    demands = (
        ((here.diff(tau, 2),), sp.S.One),
        ((here, *sites), sp.S.One),  # what a uniform displacement feels
        ((here.diff(tau),), 2 * xi),
        ((y_tilde(n + 1, tau),), -c),
    )
    draft.derived("unit coefficients", PrescribeCoefficients(demands, (omega_n, y_0, c, xi)),
                  "scaled equation of motion", check=scaling_checks.units,
                  note="inertia and stiffness become one; c and 2ξ are the "
                       "coefficients left of coupling and damping")
    draft.derived("scaled time", Take(1), "scales", check=scaling_checks.clock)
    draft.derived("scaling", Join(), "unit coefficients", "scaled time",
                  check=scaling_checks.scaling, number=4)
    draft.derived("dimensionless chain", (Eliminate((d, eta_c)), Rewrite(Form.SIMPLIFIED)),
                  "scaled equation of motion", "unit coefficients", check=scaling_checks.in_scales,
                  number=5)
    draft.derived("dimensionless law",
                  (Substitute(), Divide((F_N, omega_n * y_0, F_N, omega_n * y_0))), "friction law",
                  "scaled velocities", check=law_checks.scaled_law, number=6,
                  note="μ is the function (2) of the dimensional velocity")
    draft.derived("force of slip", Take(0), "dimensionless law",
                  check=law_checks.force_of_slip)
    draft.derived("slip law", Substitute(index=v_rel, at=(omega_n * y_0 * v_tilde_rel,)),
                  "force of slip", "friction coefficient", check=law_checks.slip)
    draft.derived("slip law in scaled velocities", Substitute(), "slip law", "scaled velocities",
                  check=law_checks.slip)


def _sliding(
    draft: Draft, chain: FrictionModel, law_checks: LawChecks, sliding_checks: SlidingChecks
) -> None:
    """Derive steady sliding, its waves and its loss of stability; then the cycle of pure slip."""
    draft.derived("slip backwards", TakeBranch(v_tilde_rel < 0), "slip law in scaled velocities",
                  check=law_checks.backwards, note="the belt is faster than the site")
    draft.derived("force at a velocity of the site", Substitute(), "slip backwards",
                  "relative velocity", check=law_checks.at_velocity)
    draft.derived("slipping chain", Substitute(), "dimensionless chain",
                  "force at a velocity of the site", check=sliding_checks.slipping)
    reach = max(chain.springs)
    rest = Substitute({y_tilde(n, tau): y_star}, meaning="at rest")
    draft.derived("steady sliding", (alike(y_tilde, n, tau, reach), rest, SolveFor(y_star)),
                  "slipping chain", check=sliding_checks.sliding)
    draft.derived("linearised chain", Linearise({y_tilde: z}), "slipping chain", "steady sliding",
                  check=sliding_checks.linear)
    draft.derived("waves about sliding", InsertPlaneWave(z, rate, q), "linearised chain",
                  check=sliding_checks.waves, note="coupling does not damp them")
    draft.derived("effective damping", TakeCoefficient(rate), "waves about sliding",
                  check=sliding_checks.damping)
    draft.derived("Hopf velocity", (SolveFor(v_tilde_d), Substitute({v_tilde_d: v_hopf})),
                  "effective damping", check=sliding_checks.hopf,
                  note="steady sliding is stable for faster belts")
    draft.derived("slipping cell", alike(y_tilde, n, tau, reach), "slipping chain",
                  check=sliding_checks.cell)
    draft.derived("cycle of pure slip",
                  BalancePower(y_tilde(n, tau), tau, y_star + R * sp.sin(s), s), "slipping cell",
                  check=sliding_checks.balance,
                  note="its velocity amplitude is R; at R = 0 this is the Hopf velocity")
    draft.derived("end of pure slip", Substitute({R: v_tilde_d}), "cycle of pure slip",
                  check=sliding_checks.bound,
                  note="the largest velocity of the cycle reaches that of the "
                       "belt: it grazes stick, and for slower belts there is no "
                       "cycle of pure slip")
