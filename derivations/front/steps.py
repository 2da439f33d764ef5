"""The front, Eqs. (44)-(54), from the averaged chain; its thresholds, limits and speed."""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.rearrangement import (
    Apply,
    Differentiate,
    Divide,
    Form,
    Function,
    Join,
    Rewrite,
    TakeCoefficient,
)
from derivations.algebra.solution import SolveFor
from derivations.algebra.steps import Derivation, Draft
from derivations.algebra.substitution import (
    HALF,
    Eliminate,
    EnterMovingFrame,
    InsertRightSide,
    Substitute,
    TakeBranch,
    WriteWithStep,
)
from derivations.algebra.transform import CloseContour, FourierTransform, InvertTransform
from derivations.averaging.steps import derive as derive_averages
from derivations.chain import PAPER, ChainModel
from derivations.front import cell, limits, roots, strong
from derivations.front.checks_profile import ProfileChecks
from derivations.front.symbols import (
    F,
    L,
    L_k,
    M_minus,
    M_plus,
    k,
    over_roots,
    phi,
    phi_hat,
    phi_s,
    phi_us,
    speed,
    v,
    zeta,
)
from derivations.multiple_scales.steps import derive as derive_scales
from derivations.symbols import epsilon, i, n, t

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


@lru_cache(maxsize=8)
def derive(chain: ChainModel = PAPER) -> Derivation:
    """Derive Eqs. (44)-(54), the limits of the kinetic relation, and the speed of the full front.

    Parameters
    ----------
    chain : ChainModel
        The chain; by default that of Eq. (8).

    Returns
    -------
    Derivation

    Raises
    ------
    DerivationInputError
        If the stiffness has a linear term, or a cell at rest is not damped.
    """
    if 1 in chain.stiffness:
        raise DerivationInputError(
            "stiffness", chain.stiffness_of(sp.Symbol("y")), "without a linear term: a cell at "
            "rest has the frequency 1",
            "count time in its periods instead",
        )  # fmt: skip
    if 0 not in chain.damping:
        raise DerivationInputError(
            "damping", chain.damping_of(sp.Symbol("y")), "with a constant term: a cell at rest is "
            "damped, and the rest state ahead of the front decays",
            "give a coefficient of y^0",
        )  # fmt: skip
    draft, checks = Draft(derive_averages(chain), derive_scales(chain)), ProfileChecks(chain)
    cell.steps(draft, chain)
    _to_profile(draft, chain, checks)
    cell.comparison(draft, chain)
    roots.steps(draft, chain)
    _to_kinetic_relation(draft, checks)
    limits.steps(draft, chain)
    strong.steps(draft, chain)
    title = "The piecewise-linear front and its kinetic relation (44)-(54)"
    return draft.finished("piecewise-front", title)


def two_lines(chain: ChainModel) -> sp.Eq:
    """Return Eq. (44): two lines with the slope of (43) at rest, selected by the modulus."""
    phi_n = phi(n, t)
    modulus, threshold = sp.Abs(phi_n), sp.Abs(phi_us)
    branches = sp.Piecewise(
        (phi_n, sp.Lt(modulus, threshold)),
        (phi_n - phi_s, sp.Gt(modulus, threshold)),
        evaluate=False,
    )
    decay = chain.damping[0]
    return equation(phi_n.diff(t) - i * epsilon * chain.coupling / 2 * chain.springs(phi),
                    -HALF * epsilon * decay * branches)


def travelling_wave(reach: int) -> sp.Tuple:
    """Return Eq. (46) for the sites that springs couple."""
    place = n - speed * t
    parts = []
    for j in sorted(range(-reach, reach + 1), key=lambda q: (abs(q), -q)):
        parts += [equation(phi(n + j, t), phi(place + j)), equation(phi(place + j), phi(zeta + j))]
    return sp.Tuple(*parts)


def _half_plane(side: type[sp.Rel]) -> sp.ConditionSet:
    condition = sp.And(equation(L(k), 0), side(sp.im(k), 0))
    return sp.ConditionSet(k, condition, sp.S.Complexes)


def _to_profile(draft: Draft, chain: ChainModel, checks: ProfileChecks) -> None:
    """Derive (44) to (52)."""
    phi_n = phi(n, t)
    draft.model("two lines", two_lines(chain),
                "two lines of equal slope replace the nonlinear term, switched "
                "where |φ_n| passes |φ_us|", check=checks.two_lines, number=44)
    draft.derived("force", WriteWithStep(F), "two lines", check=checks.force,
                  number=45)
    draft.ansatz("travelling wave", travelling_wave(chain.reach),
                 "a travelling wave with a phase that does not rotate", check=checks.moving,
                 number=46)
    once = sp.Equivalent(sp.Gt(sp.Abs(phi_n), sp.Abs(phi_us)), sp.Lt(zeta, 0), evaluate=False)
    draft.ansatz("one passage", once, "each site passes the threshold once, at ζ = 0",
                 check=checks.admissible, number=47)
    draft.definition("slow velocity", equation(speed, epsilon * v), "the velocity a unit of εt",
                     check=checks.slow_velocity)
    draft.derived("driven chain", InsertRightSide(), "two lines", "force",
                  check=checks.two_lines)
    draft.derived("chain with the step at the front", Substitute(), "driven chain", "one passage",
                  check=checks.located)
    draft.derived("profile", EnterMovingFrame(n, t), "chain with the step at the front",
                  "travelling wave", check=checks.profile_equation(speed))
    draft.derived("front", (Substitute(), Divide(epsilon)), "profile", "slow velocity",
                  check=checks.profile_equation(v), number=48)
    draft.derived("transformed front", FourierTransform(zeta, k, phi, phi_hat), "front",
                  check=checks.transformed)
    draft.derived("dispersion", TakeCoefficient(phi_hat(k), L(k)), "transformed front",
                  check=checks.dispersion, number=50)
    draft.derived("slope of the dispersion", Differentiate(L(k), k, (L_k,)), "dispersion",
                  check=checks.slope)
    draft.derived("slope on the roots", (Eliminate((v,), {L(k): 0}), Rewrite(Form.EXPANDED)),
                  "slope of the dispersion", "dispersion", check=checks.slope_on_roots, number=51,
                  note="only where L = 0")
    draft.definition("roots",
                     sp.Tuple(equation(M_plus, _half_plane(sp.Gt)),
                              equation(M_minus, _half_plane(sp.Lt))),
                     "the roots in the upper and in the lower half-plane", check=checks.root_sets,
                     number=52)
    draft.derived("transform of the front", SolveFor(phi_hat(k)), "transformed front", "dispersion",
                  check=checks.image)
    draft.derived("front as a contour integral", InvertTransform(zeta, k, phi(zeta)),
                  "transform of the front", check=checks.contour)
    draft.derived("front as sums over roots", CloseContour(zeta, k, L_k),
                  "front as a contour integral", "dispersion", "roots", check=checks.profile,
                  number=49,
                  note="no root is double or real, see 'no double root' and 'real axis'")


def _to_kinetic_relation(draft: Draft, checks: ProfileChecks) -> None:
    """Derive (53) and (54)."""
    total, summed = over_roots(1, M_plus), "front as sums over roots"
    draft.derived("front from ahead", (TakeBranch(zeta > 0), Substitute({zeta: 0})), summed,
                  check=checks.at_front)
    draft.derived("front from behind", (TakeBranch(zeta < 0), Substitute({zeta: 0})), summed,
                  check=checks.at_front)
    draft.definition("threshold at the front", equation(phi(0), phi_us),
                     "the front is at the point where the threshold is passed",
                     check=checks.meeting)
    draft.derived("threshold", (Substitute(), SolveFor(total)), "front from ahead",
                  "threshold at the front", check=checks.at_front, number=53)
    draft.derived("kinetic relation", Apply(Function.MODULUS), "threshold",
                  check=checks.at_front)
    if "ratio by η" in draft:
        draft.derived("kinetic relation in η", Join(), "kinetic relation", "ratio by η",
                      "forcing parameter", check=checks.relation_in_eta, number=54,
                      note="only moduli are known: the phase of each cycle is free")
