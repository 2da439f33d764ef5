"""From Newton's law to the dimensionless chain, and when its steady sliding is stable."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.balance import BalancePower
from derivations.algebra.equations import equation
from derivations.algebra.expansion import Linearise
from derivations.algebra.lattice import InsertPlaneWave
from derivations.algebra.rearrangement import Divide, Form, Join, Rewrite, Take, TakeCoefficient
from derivations.algebra.solution import PrescribeCoefficients, SolveFor, SolveLimits
from derivations.algebra.steps import Derivation, Given, Step, ansatz, definition, derived, model
from derivations.algebra.substitution import (
    ChangeVariables,
    Eliminate,
    Substitute,
    TakeBranch,
    alike,
)
from derivations.friction.checks import Checks
from derivations.friction.model import PAPER, FrictionModel
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


def derive(chain: FrictionModel = PAPER) -> Derivation:
    """Eqs. (1)-(7) and what follows for steady sliding and for the cycle that slips all the time.

    Parameters
    ----------
    chain : FrictionModel
        The chain; that of the paper by default.
    """
    checks = Checks(chain)
    given = _given(chain, checks)
    scaled = _scaled(chain, given, checks)
    sliding = _sliding(chain, {**given, **scaled}, checks)
    return Derivation(
        "friction",
        "Model I: scales, steady sliding, its stability and the cycle of pure slip (Eqs. 1-7)",
        (*given.values(), *scaled.values(), *sliding),
    )


def _given(chain: FrictionModel, checks: Checks) -> dict[str, Step]:
    falling = mu_far + mu_fall * chain.decay(sp.Abs(v_rel) / v_0)
    law = sp.Tuple(
        equation(F, -sp.sign(v_rel) * F_N * mu(v_rel)), sp.Ne(v_rel, 0, evaluate=False),
        sp.Le(sp.Abs(F), mu_st * F_N, evaluate=False), equation(v_rel, 0),
    )  # fmt: skip
    scales = sp.Tuple(equation(y(n, t), y_0 * y_tilde(n, tau)), equation(tau, omega_n * t),
                      equation(F, F_N * F_tilde))  # fmt: skip
    velocities = sp.Tuple(equation(v_rel, omega_n * y_0 * v_tilde_rel),
                          equation(v_0, omega_n * y_0 * v_tilde_0),
                          equation(F, F_N * F_tilde))  # fmt: skip
    steps: tuple[Given, ...] = (
        model("newton", chain.newton(), "Newton's law for site n between its neighbours",
              check=checks.newton, number=1),
        model("falling friction", equation(mu(v_rel), falling),
              "friction falls with speed from one value to another, with reference velocity v_0",
              check=checks.falling),
        definition("friction at rest and at speed",
                   sp.Tuple(equation(mu(sp.S.Zero), mu_st), equation(mu(sp.oo), mu_d)),
                   "the limits that the text states below (2)", check=checks.limits),
        model("friction law", law, "friction opposes slip; in stick it takes whatever value "
              "balances, up to the limit from which slip starts", check=checks.law, number=3),
        ansatz("scales", scales, "scaled displacement, time and force", check=checks.scales),
        definition("scaled velocities", velocities,
                   "velocities in units of omega_n y_0, the reference velocity too",
                   check=checks.velocities),
        definition("parameters", sp.Tuple(*(equation(own, value)
                                            for own, value in chain.parameters.items())),
                   "the parameters of all simulations of model I",
                   check=checks.parameters, number=7),
        definition("relative velocity",
                   equation(v_tilde_rel, y_tilde(n, tau).diff(tau) - v_tilde_d),
                   "velocity of the site relative to the belt", check=checks.relative),
    )  # fmt: skip
    return {step.name: step for step in steps}


def _scaled(chain: FrictionModel, given: dict[str, Step], checks: Checks) -> dict[str, Step]:
    friction = derived("friction coefficient", SolveLimits(v_rel, (mu_far, mu_fall)),
                       given["falling friction"], given["friction at rest and at speed"],
                       check=checks.coefficient, number=2)  # fmt: skip
    raw = derived("newton in the scales", (ChangeVariables(t, tau), Divide(F_N)),
                  given["newton"], given["scales"], check=checks.in_scales)  # fmt: skip
    here = y_tilde(n, tau)
    sites = tuple(y_tilde(n + sign * distance, tau)
                  for distance in chain.springs for sign in (1, -1))  # fmt: skip
    demands = (
        ((here.diff(tau, 2),), sp.S.One),
        ((here, *sites), sp.S.One),  # what a uniform displacement feels
        ((here.diff(tau),), 2 * xi),
        ((y_tilde(n + 1, tau),), -c),
    )
    units = derived("unit coefficients", PrescribeCoefficients(demands, (omega_n, y_0, c, xi)),
                    raw, check=checks.units,
                    note="inertia and stiffness become one; c and 2 xi are the coefficients left "
                         "of coupling and damping")  # fmt: skip
    clock = derived("scaled time", Take(1), given["scales"], check=checks.clock)
    parameters = derived("scaling", Join(), units, clock, check=checks.scaling, number=4)
    dimensionless = derived(
        "dimensionless chain",
        (Eliminate((d, eta_c)), Rewrite(Form.SIMPLIFIED)),
        raw,
        units,
        check=checks.dimensionless,
        number=5,
    )
    law = derived(
        "dimensionless law",
        (Substitute(), Divide((F_N, omega_n * y_0, F_N, omega_n * y_0))),
        given["friction law"],
        given["scaled velocities"],
        check=checks.scaled_law,
        number=6,
        note="mu is the function (2) of the dimensional velocity",
    )
    force = derived("force of slip", Take(0), law, check=checks.force_of_slip)
    slip = derived("slip law", Substitute(index=v_rel, at=(omega_n * y_0 * v_tilde_rel,)),
                   force, friction, check=checks.slip)  # fmt: skip
    own = derived("slip law in scaled velocities", Substitute(), slip,
                  given["scaled velocities"], check=checks.slip)  # fmt: skip
    steps = (friction, raw, units, clock, parameters, dimensionless, law, force, slip, own)
    return {step.name: step for step in steps}


def _sliding(chain: FrictionModel, found: dict[str, Step], checks: Checks) -> tuple[Step, ...]:
    """Steady sliding, its waves and its loss of stability; then the cycle of pure slip."""
    backwards = derived("slip backwards", TakeBranch(v_tilde_rel < 0),
                        found["slip law in scaled velocities"], check=checks.backwards,
                        note="the belt is faster than the site")  # fmt: skip
    at_velocity = derived("force at a velocity of the site", Substitute(), backwards,
                          found["relative velocity"], check=checks.at_velocity)  # fmt: skip
    slipping = derived("slipping chain", Substitute(), found["dimensionless chain"], at_velocity,
                       check=checks.slipping)  # fmt: skip
    reach = max(chain.springs)
    rest = Substitute({y_tilde(n, tau): y_star}, meaning="at rest")
    sliding = derived("steady sliding", (alike(y_tilde, n, tau, reach), rest, SolveFor(y_star)),
                      slipping, check=checks.sliding)  # fmt: skip
    linear = derived("linearised chain", Linearise({y_tilde: z}), slipping, sliding,
                     check=checks.linear)  # fmt: skip
    waves = derived("waves about sliding", InsertPlaneWave(z, rate, q), linear,
                    check=checks.waves, note="coupling does not damp them")  # fmt: skip
    damping = derived("effective damping", TakeCoefficient(rate), waves,
                      check=checks.damping)  # fmt: skip
    hopf = derived("Hopf velocity", (SolveFor(v_tilde_d), Substitute({v_tilde_d: v_hopf})), damping,
                   check=checks.hopf,
                   note="steady sliding is stable for faster belts")  # fmt: skip
    cell = derived("slipping cell", alike(y_tilde, n, tau, reach), slipping,
                   check=checks.cell)  # fmt: skip
    balance = derived(
        "cycle of pure slip",
        BalancePower(y_tilde(n, tau), tau, y_star + R * sp.sin(s), s),
        cell,
        check=checks.balance,
        note="its velocity amplitude is R; at R = 0 this is the Hopf velocity",
    )
    bound = derived("end of pure slip", Substitute({R: v_tilde_d}), balance,
                    check=checks.bound,
                    note="the largest velocity of the cycle reaches that of the belt: it grazes "
                         "stick, and for slower belts there is no cycle of pure slip")  # fmt: skip
    return (backwards, at_velocity, slipping, sliding, linear, waves, damping, hopf, cell, balance,
            bound)  # fmt: skip
