"""The front, Eqs. (44)-(54), from the averaged chain; its thresholds, limits and speed."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
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
from derivations.algebra.steps import Derivation, Step, ansatz, definition, derived, model
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
from derivations.front.checks import Checks
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
from derivations.symbols import epsilon, i, n, t


def derive(chain: ChainModel = PAPER) -> Derivation:
    """Derive Eqs. (44)-(54), the limits of the kinetic relation, and the speed of the full front.

    Parameters
    ----------
    chain : ChainModel
        The chain; that of Eq. (8) by default.

    Returns
    -------
    Derivation
    """
    checks = Checks(chain)
    averaged = derive_averages(chain).numbered(43)
    cycles = cell.steps(chain, averaged, checks)
    profile = _to_profile(chain, checks)
    kept = cell.comparison(chain, averaged, profile["two lines"], checks)
    located = roots.steps(chain, profile, checks)
    relation = _to_kinetic_relation(profile, cycles, checks)
    found = (*cycles.values(), *profile.values(), *kept, *located, *relation.values(),
             *limits.steps(chain, {**cycles, **profile, **relation}, checks),
             *strong.steps(chain, cycles, checks))  # fmt: skip
    title = "The piecewise-linear front and its kinetic relation (44)-(54)"
    return Derivation("piecewise-front", title, found)


def two_lines(chain: ChainModel) -> sp.Eq:
    """Return Eq. (44): two lines with the slope of (43) at rest, switched by the modulus."""
    own = phi(n, t)
    springs = sum(
        (weight * (2 * own - phi(n - j, t) - phi(n + j, t))
         for j, weight in enumerate(chain.weights, start=1)), sp.S.Zero)  # fmt: skip
    size, threshold = sp.Abs(own), sp.Abs(phi_us)
    branches = sp.Piecewise(
        (own, sp.Lt(size, threshold, evaluate=False)),
        (own - phi_s, sp.Gt(size, threshold, evaluate=False)), evaluate=False,
    )  # fmt: skip
    rest = chain.damping.get(0, sp.S.Zero)
    return equation(own.diff(t) - i * epsilon * chain.coupling / 2 * springs,
                    -HALF * epsilon * rest * branches)  # fmt: skip


def travelling_wave(reach: int) -> sp.Tuple:
    """Return Eq. (46) for the sites that springs join."""
    place = n - speed * t
    parts = []
    for j in sorted(range(-reach, reach + 1), key=lambda q: (abs(q), -q)):
        parts += [equation(phi(n + j, t), phi(place + j)), equation(phi(place + j), phi(zeta + j))]
    return sp.Tuple(*parts)


def _half_plane(side: type[sp.Rel]) -> sp.ConditionSet:
    condition = sp.And(equation(L(k), 0), side(sp.im(k), 0, evaluate=False), evaluate=False)
    return sp.ConditionSet(k, condition, sp.S.Complexes)


def _to_profile(chain: ChainModel, checks: Checks) -> dict[str, Step]:
    """From (44) to (52)."""
    own = phi(n, t)
    lines = model("two lines", two_lines(chain), "two lines of equal slope in place of the "
                  "nonlinear term, switched where |φ_n| passes |φ_us|",
                  check=checks.two_lines, number=44)  # fmt: skip
    force = derived("force", WriteWithStep(F), lines, check=checks.force, number=45)
    moving = ansatz("travelling wave", travelling_wave(chain.reach),
                    "a travelling wave that does not turn its phase on the way",
                    check=checks.moving, number=46)  # fmt: skip
    once = sp.Equivalent(sp.Gt(sp.Abs(own), sp.Abs(phi_us), evaluate=False),
                         sp.Lt(zeta, 0, evaluate=False), evaluate=False)  # fmt: skip
    passed = ansatz("one passage", once, "each site passes the threshold once, at ζ = 0",
                    check=checks.admissible, number=47)  # fmt: skip
    slow = definition("slow velocity", equation(speed, epsilon * v), "the velocity a unit of εt",
                      check=checks.slow_velocity)  # fmt: skip
    driven = derived("driven chain", InsertRightSide(), lines, force, check=checks.driven)
    located = derived("chain with the step at the front", Substitute(), driven, passed,
                      check=checks.located)  # fmt: skip
    frame = derived("profile", EnterMovingFrame(n, t, zeta), located, moving,
                    check=checks.profile_equation(speed))  # fmt: skip
    front = derived("front", (Substitute(), Divide(epsilon)), frame, slow,
                    check=checks.profile_equation(v), number=48)  # fmt: skip
    transformed = derived("transformed front", FourierTransform(zeta, k, phi, phi_hat), front,
                          check=checks.transformed)  # fmt: skip
    dispersion = derived("dispersion", TakeCoefficient(phi_hat(k), L(k)), transformed,
                         check=checks.dispersion, number=50)  # fmt: skip
    slope = derived("slope of the dispersion", Differentiate(k, L_k), dispersion,
                    check=checks.slope)  # fmt: skip
    on_roots = derived(
        "slope on the roots",
        (Eliminate((v,), {L(k): 0}), Rewrite(Form.EXPANDED)),
        slope,
        dispersion,
        check=checks.slope_on_roots,
        number=51,
        note="only where L = 0",
    )
    sets = definition("roots", sp.Tuple(equation(M_plus, _half_plane(sp.Gt)),
                                        equation(M_minus, _half_plane(sp.Lt))),
                      "the roots in the upper and in the lower half-plane",
                      check=checks.root_sets, number=52)  # fmt: skip
    image = derived("transform of the front", SolveFor(phi_hat(k)), transformed, dispersion,
                    check=checks.image)  # fmt: skip
    inverse = derived("front as a contour integral", InvertTransform(zeta, k, phi(zeta)), image,
                      check=checks.contour)  # fmt: skip
    summed = derived(
        "front as sums over roots",
        CloseContour(zeta, k, L_k),
        inverse,
        dispersion,
        sets,
        check=checks.profile,
        number=49,
        note="no root is double or real, see 'no double root' and 'real axis'",
    )
    steps = (lines, force, moving, passed, slow, driven, located, frame, front, transformed,
             dispersion, slope, on_roots, sets, image, inverse, summed)  # fmt: skip
    return {step.name: step for step in steps}


def _to_kinetic_relation(
    profile: dict[str, Step], cycles: dict[str, Step], checks: Checks
) -> dict[str, Step]:
    """(53) and (54)."""
    total = over_roots(1, M_plus)
    summed = profile["front as sums over roots"]
    ahead = derived(
        "front from ahead",
        (TakeBranch(zeta > 0), Substitute({zeta: 0})),
        summed,
        check=checks.at_zero,
    )
    behind = derived("front from behind", (TakeBranch(zeta < 0), Substitute({zeta: 0})), summed,
                     check=checks.at_zero)  # fmt: skip
    meeting = definition(
        "threshold at the front",
        equation(phi(0), phi_us),
        "the front is where the threshold is passed",
        check=checks.meeting,
    )
    relation = derived("threshold", (Substitute(), SolveFor(total)), ahead, meeting,
                       check=checks.threshold, number=53)  # fmt: skip
    modulus = derived("kinetic relation", Apply(Function.MODULUS), relation, check=checks.relation)
    steps = [ahead, behind, meeting, relation, modulus]
    if "ratio by η" in cycles:
        steps.append(derived("kinetic relation in η", Join(), modulus, cycles["ratio by η"],
                             cycles["forcing parameter"], check=checks.relation_in_eta,
                             number=54, note="only moduli are known: the phase of each cycle is "
                             "free"))  # fmt: skip
    return {step.name: step for step in steps}
