"""Other forms of the sum of (53), and its limits: pinning, retreat, strong coupling."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.expansion import Limit
from derivations.algebra.rearrangement import Apply, Form, Function, Isolate, Join, Rewrite, Take
from derivations.algebra.roots import ParametriseRadical, RootTerm, SquareModulus
from derivations.algebra.solution import SelectRoot, SolveFor
from derivations.algebra.steps import Draft
from derivations.algebra.substitution import Substitute
from derivations.algebra.transform import IntegratePeriod, LayOnRealAxis, SumOverPeriods
from derivations.chain import ChainModel
from derivations.front.checks_limits import LimitChecks
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

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


_TOTAL = over_roots(1, M_plus)


def steps(draft: Draft, chain: ChainModel) -> None:
    """Derive forms and limits of the kinetic relation."""
    checks = LimitChecks(chain)
    _forms(draft, checks)
    draft.definition("ratio", equation(sp.Abs(phi_us / phi_s), ratio),
                     "the ratio of the two cycles", check=checks.ratio_named)
    draft.derived("relation by the ratio", Substitute(), "kinetic relation", "ratio",
                  check=checks.at_front)
    if chain.reach <= 2:  # its poles are at most the roots of a quadratic in cos k
        _static(draft, checks)
    if _one_radical(chain):
        _pinning(draft, checks)
    if _has_long_waves(chain):
        _strong(draft, chain, checks)


def _one_radical(chain: ChainModel) -> bool:
    """Whether the static sum has a single square root in c: attracting nearest neighbours."""
    return chain.nearest_pull and chain.is_scaled_by_c


def _has_long_waves(chain: ChainModel) -> bool:
    """Whether the coupling is a multiple of c whose effect on long waves has a definite sign."""
    pull = chain.coupling * sum(j * j * q for j, q in enumerate(chain.weights, start=1))
    return chain.is_scaled_by_c and bool(pull.is_positive or pull.is_negative)


def _forms(draft: Draft, checks: LimitChecks) -> None:
    behind = over_roots(1, M_minus)
    draft.derived("both half-planes", (Substitute(), SolveFor(behind), Isolate((_TOTAL, behind))),
                  "front from behind", "front from ahead", check=checks.at_front)
    draft.derived("front on the real axis", LayOnRealAxis(zeta, k), "front as a contour integral",
                  "dispersion", check=checks.at_front)
    draft.derived("sum on the real axis", (Substitute(), SolveFor(_TOTAL), Rewrite(Form.EXPANDED)),
                  "front on the real axis", "front from ahead", check=checks.at_front,
                  note="holds for either sign of the velocity")
    draft.derived("sum over one period", SumOverPeriods(k), "sum on the real axis",
                  check=checks.at_front)


def _static(draft: Draft, checks: LimitChecks) -> None:
    draft.derived("static sum",
                  (Limit(v, 0, 1), IntegratePeriod(), Substitute({_TOTAL: static_sum}),
                   Rewrite(Form.EXPANDED)), "sum over one period", check=checks.static(ahead=True))
    draft.derived("static sum from behind",
                  (Limit(v, 0, -1), IntegratePeriod(), Substitute({_TOTAL: retreating_sum}),
                   Rewrite(Form.EXPANDED)), "sum over one period", check=checks.static(ahead=False))
    draft.derived("end of pinning", Substitute({_TOTAL: static_sum}), "relation by the ratio",
                  check=checks.named_relation(static_sum))
    draft.derived("end of pinning from behind", Substitute({_TOTAL: retreating_sum}),
                  "relation by the ratio", check=checks.named_relation(retreating_sum))
    draft.derived("depinning", Join(), "end of pinning", "static sum",
                  check=checks.depinning(ahead=True),
                  note="static fronts exist as long as the site ahead stays below threshold")
    draft.derived("retreat", Join(), "end of pinning from behind", "static sum from behind",
                  check=checks.depinning(ahead=False),
                  note="and as long as the site behind stays above it")


def _pinning(draft: Draft, checks: LimitChecks) -> None:
    """Derive the closed form of both thresholds."""
    draft.derived("radical in one parameter", ParametriseRadical(p, c), "static sum",
                  check=checks.radical, note="p > 1 for c > 0")
    draft.derived("coupling by the parameter", Take(1), "radical in one parameter",
                  check=checks.coupling_by_p)
    cases = (
        ("depinning", "pinning coupling", c_pin, True, (0.1, 0.3, 0.45)),
        ("retreat", "retreat coupling", c_retreat, False, (0.55, 0.7, 0.95)),
    )
    for source, name, symbol, ahead, ratios in cases:
        draft.derived(f"{source} squared", SquareModulus(p), source,
                      "radical in one parameter", check=checks.thresholds(ahead=ahead))
        rule = SelectRoot("p > 1", lambda q: abs(q.imag) < 1e-12 and q.real > 1, {ratio: ratios})
        draft.derived(f"{source} parameter", (SolveFor(p), rule), f"{source} squared",
                      check=checks.thresholds(ahead=ahead))
        draft.derived(name, (Substitute(), Substitute({c: symbol})), "coupling by the parameter",
                      f"{source} parameter", check=checks.coupling(ahead=ahead))
    infinite = (Apply(Function.RECIPROCAL), Limit(p, sp.oo), SolveFor(ratio),
                SelectRoot("r > 0", lambda q: q.real > 0, {}))
    draft.derived("largest ratio of pinning", infinite, "depinning parameter",
                  check=checks.largest_ratio,
                  note="beyond it static fronts exist at every coupling, and "
                       "fronts retreat at strong coupling")
    if "ratio by η" in draft:
        draft.derived("ratio named", (Substitute(), SolveFor(ratio)), "ratio by η", "ratio",
                      check=checks.ratio_in_eta)
        draft.derived("largest η of pinning", (Substitute(), Apply(Function.SQUARE), SolveFor(eta)),
                      "ratio named", "largest ratio of pinning",
                      check=checks.largest_eta)


def _strong(draft: Draft, chain: ChainModel, checks: LimitChecks) -> None:
    """Derive strong coupling, at which two roots remain, one on each side."""
    scales = {L(k): long_wave, k: kappa / sp.sqrt(c), v: V * sp.sqrt(c)}
    draft.derived("long waves", (Substitute(scales), Limit(c, sp.oo)), "dispersion",
                  check=checks.long_waves)
    tried: dict[sp.Symbol, tuple[float, ...]] = {V: (0.2, 0.9, 3.0)}
    shown = sp.Tuple(chain.damping[0], chain.coupling / c, *chain.weights)
    tried |= dict.fromkeys(shown.free_symbols, (0.1, 0.6))
    above = SelectRoot("Im κ > 0", lambda q: q.imag > 0, tried)
    draft.derived("long-wave root", (Substitute({long_wave: 0}), SolveFor(kappa), above),
                  "long waves", check=checks.long_wave_root)
    draft.derived("strong sum", RootTerm(strong_sum), "long waves", "long-wave root",
                  check=checks.strong_sum, note="the other roots contribute O(c^(-3/4))")
    draft.derived("relation at strong coupling", Substitute({_TOTAL: strong_sum}),
                  "relation by the ratio", check=checks.named_relation(strong_sum))
    draft.derived("strong coupling", Join(), "relation at strong coupling", "strong sum",
                  check=checks.strong_relation)
