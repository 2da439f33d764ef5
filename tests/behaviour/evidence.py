"""Compute the evidence of every claim at a smaller size, as plain data, and record it.

    python -m tests.behaviour.evidence                    all of it, some seconds
    python -m tests.behaviour.evidence fig17:scaling ...  these only; the others stay as recorded

At the published sizes this takes minutes; shorter runs of fewer cases go through the same code.
Kept are the evidence, what each claim says that rests on it, its verdict first, the data of the
pictures, and on how many sites and for how long two methods are compared; of evidence that is
shipped, also at the published size.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from importlib import import_module
from types import SimpleNamespace
from typing import Any
from unittest import mock

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from paper_checks import shipped
from paper_checks.claim import Claim
from paper_checks.claims import fig02
from paper_checks.claims._friction import disagreement
from paper_checks.claims.fig08 import closed_form
from paper_checks.discover import find_entries
from paper_checks.plain_evidence import evidence_from, plain_evidence
from paper_checks.shipped import root_of
from tests.behaviour.replay import EVIDENCE, Json, same_sentence, shortened
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Place
from theory.piecewise.kinetic_relation import trace_kinetic_relation
from verification.breathers.outcome import follow_nucleus
from verification.cells.diagram import cell_diagram
from verification.execution.imports import SOURCES
from verification.execution.record import Record
from verification.fronts.measure import measure_front
from verification.fronts.result import Front
from verification.fronts.status import FrontStatus
from verification.piecewise.simulation import hysteresis
from verification.references.friction_cell import averaged_front
from verification.references.friction_events import run_events
from verification.references.passages import quarter_turn_velocity, velocity_on_few_sites
from verification.references.switch_model import run_switch
from verification.thresholds.result import ThresholdMethod


def _shorter_fronts(chain: Any, **options: Any) -> Front:
    """Measure a front on fewer sites, so roughly that its uncertainty need not be small."""
    options["max_sites"] = 48 if isinstance(chain, FrictionChain) else 24 + 48
    return measure_front(replace(chain, sites=min(chain.sites, 28)), **options)


def _made_up_front(chain: Any, **_: Any) -> Any:
    """Return a steady front that is a tenth faster than the square root of its coupling."""
    v = 1.1 * chain.c**0.5
    return SimpleNamespace(chain=chain, v=v, error=1e-3, steady=True, status=FrontStatus.STEADY)


def _threshold(chain: Any, spreading: Any, **options: Any) -> Any:
    """Return made-up thresholds of spreading that fall with the size of the nucleus."""
    del chain
    falls = 0.2 if spreading.place is Place.BULK else 0.4
    return SimpleNamespace(c_crit=0.0138 * (1.0 - falls * (spreading.size > 1)), **options)


def _breather_threshold(chain: Any, nucleus: Any, by: ThresholdMethod) -> Any:
    """Return made-up folds by size, those of (8) a little below the averaged ones."""
    c = {1: 0.19, 3: 0.2, 5: 0.199, 7: 0.1985, 9: 0.19849}[nucleus.size] + chain.c
    c -= 1e-4 * (by is ThresholdMethod.ORBIT)
    return SimpleNamespace(c_crit=c, stable_to=c - 1e-3, error=1e-6 * nucleus.size)


def _escape_threshold(chain: Any, preparation: Any, tolerance: float) -> Any:
    fold = _breather_threshold(chain, preparation, ThresholdMethod.ENVELOPE)
    return SimpleNamespace(c_crit=fold.c_crit + 0.3 * tolerance * preparation.size, error=tolerance)


def _measure_delay(chain: Any, preparation: Any) -> Any:
    rates = np.array([4e-5, 2e-5, 1e-5])
    fold = _breather_threshold(chain, preparation, ThresholdMethod.ENVELOPE)
    late = fold.c_crit + preparation.size * rates ** (2.0 / 3.0)
    return SimpleNamespace(rates=rates.tolist(), escapes=late.tolist(), delay_exponent=0.66)


def _with(function: Callable[..., Any], **changed: Any) -> Callable[..., Any]:
    """Return a function that is called with some options changed, whatever they were."""
    return lambda *given, **options: function(*given, **{**options, **changed})


_cell_run = fig02._scipy.__wrapped__


def _quarter_turn(sites: int) -> dict[str, Any]:
    def shorter(a: float, b: float, c: float, _: int = 0) -> float:
        return quarter_turn_velocity(a, b, c, sites)

    return {"verification.references.passages.quarter_turn_velocity": shorter}


_compared: list[Json] = []
"""Of each comparison of two methods: the coupling, the sites, the excited sites and the end."""


def _short(chain: Any, excited: tuple[int, ...], end: float) -> float:
    _compared.append([chain.c, chain.sites, *excited, end])
    return disagreement(chain, excited, 0.1 * end)


ROUGH = {"verification.references.friction_events.run_events":
         _with(run_events, longest_step=0.4, tolerance=1e-8)}  # fmt: skip
FRONTS = {"verification.fronts.measure.measure_front": _shorter_fronts}
FOLDS = {"verification.thresholds.continuation.breather_threshold": _breather_threshold}
SPREADING = {"verification.thresholds.spreading.spreading_threshold": _threshold}


def _trace(c: Any, eta: Any, **given: Any) -> Any:
    return trace_kinetic_relation(np.atleast_1d(c)[::30], np.atleast_1d(eta)[::30], **given)


TRACE = {"theory.piecewise.kinetic_relation.trace_kinetic_relation": _trace}

SMALLER: Mapping[str, Mapping[str, Any]] = {
    "fig02:two_states": {**ROUGH, "SETTLED": 60.0, "LONG": 40.0,
                         "_scipy": lambda cell, y, end, samples=1001, **given:
                         _cell_run(cell, y, end, min(samples, 1001), **given)},
    "fig02:regions": {**ROUGH, "VELOCITIES": (1.2, 1.9), "LONG": 60.0,
                      "verification.cells.diagram.cell_diagram":
                      lambda cell, v_d: cell_diagram(cell, v_d[::50])},
    "fig02:subcritical": {"_scipy": lambda cell, y, end, samples, **given:
                          _cell_run(cell, y, 0.2 * end, samples, **given)},
    "fig02:friction_law": {},
    "fig02:stick": ROUGH,
    "fig02:switch_model": {"verification.references.switch_model.run_switch":
                           lambda chain, start, end, **given: run_switch(chain, start, 0.2 * end,
                                                                         **given)},
    "fig03:breather": {"TIMES_A": (20.0, 40.0, 60.0), "disagreement": _short},
    "fig03:front": {"TIMES_B": (100.0, 150.0, 200.0), "disagreement": _short},
    "fig04:thresholds": {**SPREADING, "disagreement": _short},
    "fig04:long_runs": {**SPREADING, "LONG": 100.0, "STALL": 50.0, "disagreement": _short},
    "fig05:state_map": {"COUPLINGS": (0.095,), "VELOCITIES": (1.05, 1.55), "REFINED": 0.5,
                        "CHECKED": ((0.095, 1.05, 7),), "disagreement": _short},
    "fig05:lasting": {"LASTING": (1.1, 1.45), "WIDE_AT": (1.38,), "LATE": 800.0,
                      "disagreement": _short},
    "fig06:velocities": {**FRONTS, **SPREADING, "COUPLINGS": (0.05, 0.07, 0.1), "LINEAR_FROM": 0.05,
                         "LARGE": (0.3,), "SCIPY": ((0.05, 30.0),), "BELOW": (0.004,),
                         "disagreement": _short},
    "fig06:no_propagation": {**SPREADING, "BELOW": (0.004,), "disagreement": _short},
    "fig07:localised": {"EPS": 1.0},
    "fig08:amplitudes": {"COUPLINGS": (0.08,) * 3 + (0.1,) * 8,
                         "closed_form": lambda reading, c:
                         np.repeat(closed_form(reading, c[::12]), 12, axis=0)[: len(c)]},
    "fig08:assumptions": {},
    "fig09:multipliers": {**FOLDS, "ALONG": (0.1, 0.18, 0.19, 0.197), "EXACT": (0.1, 0.19),
                          "scipy.optimize.brentq": _with(brentq, xtol=1e-3)},
    "fig09:escape": {},
    "fig10:in_phase": {"END": 40.0, "TIMES": np.arange(0.0, 41.0, 4.0), "EPS": 0.2},
    "fig11:folds": {**FOLDS, "verification.thresholds.escape.escape_threshold": _escape_threshold},
    "fig11:sweeps": {**FOLDS, "verification.thresholds.escape.escape_threshold": _escape_threshold,
                     "verification.thresholds.slow_sweep.measure_delay": _measure_delay},
    "fig12:steady": {"SITES": 24, "TIMES": (500.0, 700.0, 900.0), "BEYOND": 100.0,
                     "COMPARED": 1},
    "fig13:scaling": {**FRONTS, "AVERAGED": (0.3, 1.0, 2.0), "FULL": (0.4, 0.6, 1.0),
                      "CHECKED": (0.3,),
                      **_quarter_turn(24)},
    "fig13:velocity_law": {"verification.fronts.measure.measure_front": _made_up_front,
                           "LAW_COUPLINGS": (100.0, 300.0),
                           "verification.references.passages.velocity_on_few_sites":
                           lambda chain: velocity_on_few_sites(replace(chain, sites=60), 20),
                           "verification.references.friction_cell.averaged_front":
                           _with(averaged_front, sites=60)},
    "fig14:collapse": {**FRONTS, "C": 1.0, "ETAS": (0.005, 0.03), "FULL": (0.02,),
                       **_quarter_turn(13)},
    "fig15:state_map": {"ETAS": (0.03, 0.14), "COUPLINGS": (0.05, 0.5), "CHECKED": ((0.03, 0.5),),
                        "EMPTIED": 0.03, "EMPTIED_AT": (0.5,), "WATCHED": 60.0, "SCIPY_END": 4.0},
    "fig16:profile": {},
    "fig17:scaling": {**TRACE, "RUNS": (0.5,), "LAST": 20.0,
                      "verification.piecewise.simulation.hysteresis":
                      lambda eta, couplings: hysteresis(eta, couplings[::5])},
    "fig17:implicit": {},
    "fig17:admissibility": {},
    "fig18:alike": {**FRONTS, **TRACE, "ETAS": (0.01, 0.015, 0.02), "CROSSING": (0.0211, 0.0217),
                    **_quarter_turn(20)},
    "fig18:any_set": {},
    "fig18:explicit": {},
    "text_friction:spring": {},
    "text_friction:length": {},
    "text_friction:ends": {},
    "text_friction:trapezoid": {},
    "text_friction:patterns": {"LATE": 150.0, "disagreement": _short},
    "text_friction:nucleation": {"FRICTION": (0.0079, 0.011), "END": 800.0, "PAUSE": 200.0,
                                 "SLOW_END": 20.0, "disagreement": _short},
    "text_nuclei:to_larger": {"COUPLINGS": (0.193, 0.197, 0.199, 0.203), "SEEDS": (1,),
                              "CHAIN_SITES": 9,
                              "verification.breathers.outcome.follow_nucleus":
                              _with(follow_nucleus, slow_time=20.0)},
    "text_simplified:gauge": {"scipy.integrate.solve_ivp":
                              _with(solve_ivp, rtol=1e-7, atol=1e-9)},
    "text_simplified:equilibria": {},
    "text_simplified:velocities": {},
    "text_vdp:cells": {"SETS": ((4.0, 0.5),)},
    "text_vdp:small": {"EPS": 0.05},
    "text_vdp:substitution": {},
    "text_vdp:extraction": {},
    "text_vdp:unknowns": {},
    "text_vdp:displays": {},
}  # fmt: skip
"""By evidence, the constants of its module, or of another one as ``module.NAME``, made smaller."""


def claims_by_evidence() -> dict[str, list[Claim]]:
    """Return the claims that rest on each evidence, by ``module:function``."""
    found: dict[str, list[Claim]] = {}
    for entry in find_entries():
        if hasattr(entry.claim.evidence, "__qualname__"):
            root = root_of(entry.claim.evidence).rpartition("claims.")[2]
            found.setdefault(root, []).append(entry.claim)
    return found


def shipped_roots() -> list[str]:
    """Return the evidence that is shipped."""
    every = claims_by_evidence().items()
    return [root for root, claims in every if all(claim.expensive for claim in claims)]


@contextmanager
def _smaller(root: str) -> Iterator[None]:
    """Have constants small, nothing computed before, and nothing kept afterwards."""
    own = f"paper_checks.claims.{root.partition(':')[0]}"
    with ExitStack() as stack:
        for name, value in SMALLER.get(root, {}).items():
            module, _, constant = name.rpartition(".")
            target = import_module(module or own)
            stack.enter_context(mock.patch.object(target, constant, value))
        for name in ("_render", "_encoded"):  # what a picture looks like is not compared
            target = import_module("verification.pictures.figures")
            stack.enter_context(mock.patch.object(target, name, return_value=""))
        stack.callback(_forget)
        _forget()
        yield


def _forget() -> None:
    for name, module in list(sys.modules.items()):
        if name.startswith("paper_checks.claims"):
            for value in list(vars(module).values()):
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def computed(root: str) -> Json:
    """Return what `found_in` some evidence at a smaller size."""
    claims = claims_by_evidence()[root]
    _compared.clear()
    with _smaller(root):
        found = found_in(claims[0].evidence(), claims)
    return {**found, "compared": [*_compared]} if _compared else found


def stored(root: str) -> Json:
    """Return what is `found_in` the evidence that is shipped."""
    claims = claims_by_evidence()[root]
    path = shipped.Shipped(shipped.FOLDER, SOURCES).path(claims[0].evidence)
    plain = Record.load(path, "evidence").content["evidence"]
    with _smaller(""):
        return found_in(evidence_from(plain, SOURCES), claims)


def found_in(evidence: Any, claims: Sequence[Claim]) -> Json:
    """Return evidence as plain data, what claims say of it, and the data of their pictures."""
    found = {each.key: each.found(evidence) for each in claims}
    names = [name for name, it in vars(type(evidence)).items() if isinstance(it, property)]
    kept = {
        "evidence": plain_evidence(evidence),
        "properties": {name: plain_evidence(getattr(evidence, name)) for name in names},
        "said": {
            key: [str(one.verdict), one.value, one.error, one.explanation, *one.remarks]
            for key, one in found.items()
        },
        "drawn": {one.name: _table(one.data) for each in found.values() for one in each.pictures},
    }
    return shortened(json.loads(json.dumps(kept), object_hook=_without_metadata))


def _without_metadata(one: dict[str, Json]) -> dict[str, Json]:
    """Leave out by which code, when and with what versions a table was made."""
    return {name: held for name, held in one.items() if name != "metadata"}


def _table(data: str) -> list[list[str]]:
    """Return the header of a picture's data and a dozen of its lines."""
    head, *lines = data.splitlines()
    return [each.split(",") for each in (head, *lines[:: max(len(lines) // 12, 1)], lines[-1])]


def apart(old: Json, new: Json, where: str = "") -> Iterator[str]:
    """Yield where new evidence differs from the recorded, by more than rounding can do.

    Numbers may differ by a part in 1e6, which adaptive steps with other roundings can make of
    them, and by 1e-8, the size of differences between two methods that agree.
    """
    if isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
        for name, was in old.items():
            yield from apart(was, new[name], f"{where}.{name}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for number, (was, now) in enumerate(zip(old, new, strict=True)):
            yield from apart(was, now, f"{where}[{number}]")
    else:
        one, other = _number(old), _number(new)
        if one is None or other is None:
            same = old == new or same_sentence(str(old), str(new))
        else:
            same = abs(one - other) <= 1e-8 + 1e-6 * abs(one)
        if not same and str(old) != str(new):
            yield f"{where}: {old!r} was recorded, now {new!r}"


def _number(value: Json) -> float | None:
    try:
        return None if isinstance(value, bool) else float(value)
    except (TypeError, ValueError):
        return None


def main(roots: list[str]) -> None:
    """Compute and write them."""
    known = json.loads(EVIDENCE.read_text(encoding="utf-8")) if EVIDENCE.exists() else {}
    known |= {root: computed(root) for root in roots or SMALLER}
    known |= {f"{root} as shipped": stored(root) for root in shipped_roots()}
    lines = (f"{json.dumps(root)}: {json.dumps(one)}" for root, one in sorted(known.items()))
    EVIDENCE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
