"""Other forms of the sum of (53), and its limits: pinning, retreat, strong coupling."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.expansion import Limit
from derivations.algebra.rearrangement import (
    Apply,
    Form,
    Function,
    Isolate,
    Join,
    Rewrite,
    Take,
)
from derivations.algebra.roots import ParametriseRadical, RootTerm, SquareModulus
from derivations.algebra.solution import SelectRoot, SolveFor
from derivations.algebra.steps import Step, definition, derived
from derivations.algebra.substitution import Substitute
from derivations.algebra.transform import IntegratePeriod, LayOnRealAxis, SumOverPeriods
from derivations.chain import ChainModel
from derivations.front.checks import Checks
from derivations.front.symbols import (
    L,
    M_minus,
    M_plus,
    V,
    c_pin,
    c_retreat,
    eta,
    k,
    kappa,
    long_wave,
    over_roots,
    p,
    phi_s,
    phi_us,
    ratio,
    retreating_sum,
    static_sum,
    strong_sum,
    v,
    zeta,
)
from derivations.symbols import c

_TOTAL = over_roots(1, M_plus)


def steps(chain: ChainModel, found: dict[str, Step], checks: Checks) -> tuple[Step, ...]:
    """Return forms and limits of the kinetic relation as steps."""
    forms = _forms(found, checks)
    size = definition("ratio", equation(sp.Abs(phi_us / phi_s), ratio),
                      "the ratio of the two cycles", check=checks.ratio_named)  # fmt: skip
    relation = derived("relation by the ratio", Substitute(), found["kinetic relation"], size,
                       check=checks.by_ratio)  # fmt: skip
    static = _static(forms["sum over one period"], relation, checks)
    closed = _pinning(static, {**found, "ratio": size}, checks) if _one_radical(chain) else ()
    strong = _strong(found["dispersion"], relation, checks)
    return (*forms.values(), size, relation, *static.values(), *closed, *strong)


def _one_radical(chain: ChainModel) -> bool:
    """Whether the static sum has a single square root: springs to nearest neighbours that pull."""
    return chain.reach == 1 and bool(chain.coupling.is_positive)


def _forms(found: dict[str, Step], checks: Checks) -> dict[str, Step]:
    behind = over_roots(1, M_minus)
    both = derived("both half-planes", (Substitute(), SolveFor(behind), Isolate((_TOTAL, behind))),
                   found["front from behind"], found["front from ahead"],
                   check=checks.sums)  # fmt: skip
    laid = derived("front on the real axis", LayOnRealAxis(zeta, k),
                   found["front as a contour integral"], found["dispersion"],
                   check=checks.at_zero)  # fmt: skip
    line = derived("sum on the real axis", (Substitute(), SolveFor(_TOTAL), Rewrite(Form.EXPANDED)),
                   laid, found["front from ahead"], check=checks.sums,
                   note="holds for either sign of the velocity")  # fmt: skip
    period = derived("sum over one period", SumOverPeriods(k), line, check=checks.sums)
    return {step.name: step for step in (both, laid, line, period)}


def _static(period: Step, relation: Step, checks: Checks) -> dict[str, Step]:
    at_rest = derived(
        "static sum",
        (
            Limit(v, 0, 1),
            IntegratePeriod(),
            Substitute({_TOTAL: static_sum}),
            Rewrite(Form.EXPANDED),
        ),
        period,
        check=checks.static(1),
    )
    back = derived("static sum from behind",
                   (Limit(v, 0, -1), IntegratePeriod(), Substitute({_TOTAL: retreating_sum}),
                    Rewrite(Form.EXPANDED)), period, check=checks.static(-1))  # fmt: skip
    ends = derived("end of pinning", Substitute({_TOTAL: static_sum}), relation,
                   check=checks.named_relation(static_sum))  # fmt: skip
    leaves = derived("end of pinning from behind", Substitute({_TOTAL: retreating_sum}), relation,
                     check=checks.named_relation(retreating_sum))  # fmt: skip
    depins = derived(
        "depinning",
        Join(),
        ends,
        at_rest,
        check=checks.depinning(1),
        note="static fronts exist as long as the site ahead stays below threshold",
    )
    retreats = derived("retreat", Join(), leaves, back, check=checks.depinning(-1),
                       note="and as long as the site behind stays above it")  # fmt: skip
    steps = (at_rest, back, ends, leaves, depins, retreats)
    return {step.name: step for step in steps}


def _pinning(static: dict[str, Step], found: dict[str, Step], checks: Checks) -> tuple[Step, ...]:
    """Return the closed form of both thresholds."""
    radical = derived("radical in one parameter", ParametriseRadical(p, c), static["static sum"],
                      check=checks.radical, note="p > 1 for c > 0")  # fmt: skip
    by_p = derived("coupling by the parameter", Take(1), radical, check=checks.coupling_by_p)
    out: list[Step] = [radical, by_p]
    cases = (
        ("depinning", "pinning coupling", c_pin, 1, (0.1, 0.3, 0.45)),
        ("retreat", "retreat coupling", c_retreat, -1, (0.55, 0.7, 0.95)),
    )
    for source, name, symbol, side, ratios in cases:
        squared = derived(f"{source} squared", SquareModulus(p), static[source], radical,
                          check=checks.squared(side))  # fmt: skip
        rule = SelectRoot("p > 1", lambda q: abs(q.imag) < 1e-12 and q.real > 1, {ratio: ratios})
        root = derived(f"{source} parameter", (SolveFor(p), rule), squared,
                       check=checks.parameter(side))  # fmt: skip
        coupling = derived(name, (Substitute(), Substitute({c: symbol})), by_p, root,
                           check=checks.threshold_coupling(side))  # fmt: skip
        out += [squared, root, coupling]
    infinite = (Apply(Function.RECIPROCAL), Limit(p, sp.oo), SolveFor(ratio),
                SelectRoot("r > 0", lambda q: q.real > 0, {}))  # fmt: skip
    pole = derived("largest ratio of pinning", infinite, out[3],
                   check=checks.largest_ratio,
                   note="beyond it static fronts exist at every coupling, and fronts retreat at "
                        "strong coupling")  # fmt: skip
    out.append(pole)
    if "ratio by η" in found:
        named = derived("ratio named", (Substitute(), SolveFor(ratio)), found["ratio by η"],
                        found["ratio"],
                        check=checks.ratio_in_eta)  # fmt: skip
        largest = derived("largest η of pinning",
                          (Substitute(), Apply(Function.SQUARE), SolveFor(eta)), named, pole,
                          check=checks.largest_eta)  # fmt: skip
        out += [named, largest]
    return tuple(out)


def _strong(dispersion: Step, relation: Step, checks: Checks) -> tuple[Step, ...]:
    """Strong coupling: two roots are left, one on each side."""
    scales = {L(k): long_wave, k: kappa / sp.sqrt(c), v: V * sp.sqrt(c)}
    long = derived("long waves", (Substitute(scales), Limit(c, sp.oo)), dispersion,
                   check=checks.long_waves)  # fmt: skip
    above = SelectRoot("Im κ > 0", lambda q: q.imag > 0, {V: (0.2, 0.9, 3.0)})
    root = derived("long-wave root", (Substitute({long_wave: 0}), SolveFor(kappa), above), long,
                   check=checks.long_wave_root)  # fmt: skip
    term = derived("strong sum", RootTerm(strong_sum), long, root, check=checks.strong_sum,
                   note="the other roots contribute O(1/c)")  # fmt: skip
    named = derived("relation at strong coupling", Substitute({_TOTAL: strong_sum}), relation,
                    check=checks.named_relation(strong_sum))  # fmt: skip
    limit = derived("strong coupling", Join(), named, term, check=checks.strong_relation)
    return long, root, term, named, limit
