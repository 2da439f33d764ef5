"""The piecewise-linear front, Eqs. (43)-(54): moving frame, transform, residues."""

from __future__ import annotations

import sys

import sympy as sp

from derivations import piecewise_front_evidence as seen
from derivations.averaging import averaged_form
from derivations.averaging_symbols import phi as site_phi
from derivations.averaging_symbols import phi_rate as site_rate
from derivations.derivation import Derivation, Step, equation
from derivations.front_symbols import (
    DISPERSION,
    SLOPE,
    F,
    L,
    L_k,
    M_minus,
    M_plus,
    a,
    b,
    c,
    epsilon,
    eta,
    k,
    n,
    over_roots,
    phi,
    phi_s,
    phi_us,
    speed,
    t,
    v,
    zeta,
)
from derivations.symbols import a as a_chain
from derivations.symbols import b as b_chain
from derivations.symbols import c as c_chain
from derivations.symbols import epsilon as small
from derivations.symbols import omega

i = sp.I


def derive() -> Derivation:
    """Eqs. (43)-(54), the proofs about the roots, and the other forms of the sum."""
    from derivations import front_limits, front_roots

    return Derivation(
        "piecewise-front",
        "The piecewise-linear front and its kinetic relation (43)-(54)",
        _to_moving_frame() + _to_profile() + front_roots.steps() + _to_kinetic_relation()
        + front_limits.steps(),
    )  # fmt: skip


def switched(target: sp.Expr, threshold: sp.Expr) -> sp.Piecewise:
    """Return the two branches of Eq. (44), by the modulus of phi."""
    own = site_phi[0]
    return sp.Piecewise((own, sp.Abs(own) < sp.Abs(threshold)), (own - target, True))


def lattice_side() -> sp.Expr:
    """Return the left side of Eq. (44)."""
    differences = 2 * site_phi[0] - site_phi[-1] - site_phi[1]
    return site_rate - i * epsilon * c / 2 * differences


def _to_moving_frame() -> tuple[Step, ...]:
    at_one = averaged_form().subs({omega: 1, a_chain: a, b_chain: b, c_chain: c, small: epsilon})
    own = site_phi[0]
    force = -epsilon * own / 2 + epsilon * phi_s / 2 * sp.Heaviside(
        sp.Abs(own) - sp.Abs(phi_us), sp.Rational(1, 2)
    )
    moving = sp.Tuple(equation(zeta, n - speed * t), equation(own, phi(zeta)),
                      equation(site_phi[1], phi(zeta + 1)),
                      equation(site_phi[-1], phi(zeta - 1)))  # fmt: skip
    # phi_n' = -v dphi/dzeta with v = eps v_hat; theta(|phi| - |phi_us|) = theta(-zeta); over eps.
    front = lattice_side().subs({
        site_rate: -epsilon * v * phi(zeta).diff(zeta), own: phi(zeta),
        site_phi[1]: phi(zeta + 1), site_phi[-1]: phi(zeta - 1),
    })  # fmt: skip
    linear = sp.expand((front + epsilon * phi(zeta) / 2) / epsilon)
    bracket = 2 * phi(zeta) - phi(zeta + 1) - phi(zeta - 1)
    tidy = -v * phi(zeta).diff(zeta) - i * c / 2 * bracket + phi(zeta) / 2
    if sp.expand(linear - tidy) != 0:
        raise ArithmeticError("the moving frame was collected wrongly")
    return (
        Step("The averaged chain (34) at omega = 1", equation(at_one, 0), seen.averaged, 43),
        Step("Replace the nonlinear term by two lines of equal slope, switched where |phi_n| "
             "passes |phi_us|",
             equation(lattice_side(), -epsilon / 2 * switched(phi_s, phi_us)), seen.two_lines, 44),
        Step("The same with a step function", equation(F, force), seen.force, 45),
        Step("Travelling wave", moving, seen.moving, 46),
        Step("Assume that each site passes the threshold once (shown here for a = 4, b = 0.5, "
             "c = 0.5, as in Fig. 16)",
             sp.Equivalent(sp.Abs(phi(zeta)) > sp.Abs(phi_us), zeta < 0), seen.admissible, 47),
        Step("Put (46), (45), (47) into (44) with v = eps v_hat and divide by eps",
             equation(tidy, phi_s / 2 * sp.Heaviside(-zeta, sp.Rational(1, 2))), seen.front, 48),
    )  # fmt: skip


def _to_profile() -> tuple[Step, ...]:
    wave = sp.exp(i * k * zeta)
    symbol = -v * i * k - i * c / 2 * (2 - sp.exp(i * k) - sp.exp(-i * k)) + sp.Rational(1, 2)
    if sp.simplify(symbol.rewrite(sp.cos) - DISPERSION) != 0:
        raise ArithmeticError("the dispersion relation was collected wrongly")
    # Contour above k = 0. Closing it upwards: 2 pi i times residues in M+. Downwards: minus those
    # at k = 0, where k L = k/2, and in M-. The prefactor is i phi_s / (4 pi).
    pre = i * phi_s / (4 * sp.pi)
    ahead = sp.simplify(pre * 2 * sp.pi * i) * over_roots(wave, M_plus)
    pole = sp.simplify(-pre * 2 * sp.pi * i / DISPERSION.subs(k, 0))
    behind = pole + sp.simplify(-pre * 2 * sp.pi * i) * over_roots(wave, M_minus)
    sides = (sp.im(k) > 0, sp.im(k) < 0)
    members = (sp.And(sp.Eq(DISPERSION, 0), side) for side in sides)
    sets = sp.Tuple(*(
        sp.Contains(k, sp.ConditionSet(k, member, sp.S.Complexes), evaluate=False)
        for member in members
    ))  # fmt: skip
    on_roots = -1 / (2 * k) + 2 * i * c / k * sp.sin(k / 2) ** 2 - i * c * sp.sin(k)
    return (
        Step("Fourier transform of (48) and its inverse, closed above for zeta > 0 (residues in M+)"
             " and below for zeta < 0 (M- and k = 0)",
             equation(phi(zeta), sp.Piecewise((behind, zeta < 0), (ahead, zeta > 0))),
             seen.profile, 49),
        Step("What e^{ik zeta} gives on the left of (48)", equation(L, DISPERSION),
             seen.dispersion, 50),
        Step("Its derivative", equation(L_k, SLOPE), seen.slope, 51),
        Step("The derivative where L = 0, and only there: i v_hat eliminated by L = 0",
             equation(L_k, on_roots), seen.slope_on_roots),
        Step("Roots in the upper and in the lower half-plane (M+, then M-)", sets,
             seen.root_sets, 52),
    )  # fmt: skip


def _to_kinetic_relation() -> tuple[Step, ...]:
    root = sp.sqrt(1 - 8 * eta)
    relation = sp.Tuple(
        equation(sp.Abs(over_roots(1, M_plus)), 2 * sp.Abs(phi_us) / sp.Abs(phi_s)),
        equation(sp.Abs(phi_us) / sp.Abs(phi_s), sp.sqrt((1 - root) / (1 + root))),
        equation(eta, b / a**2),
    )
    return (
        Step("The condition phi(0) = phi_us", equation(over_roots(1, M_plus), -2 * phi_us / phi_s),
             seen.threshold, 53),
        Step("Absolute values; only they are known, for the phase of each cycle is free",
             relation, seen.relation, 54),
    )  # fmt: skip


if __name__ == "__main__":
    from derivations.catalogue import main

    sys.exit(main("piecewise-front"))
