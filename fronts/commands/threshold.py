"""``fronts threshold MODEL``: the coupling at which a nucleus stops being localised."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import Any

from fronts.answer import Answer, UsageError
from fronts.arguments import given, real, refuse, refuse_other_methods, whole
from fronts.commands.breather import add_chain_options, add_nucleus_options, nucleus_of
from fronts.escape_answer import held_answer
from fronts.friction_options import (
    CELL,
    START,
    add_cell_options,
    add_start_option,
    cell_of,
    start_point_of,
)
from verification.execution.progress import Progress

EXAMPLE = """examples:
  fronts threshold vdp --nucleus 3
  fronts threshold vdp --nucleus 1 --method orbit --json
  fronts threshold vdp --nucleus 5 --method sweep
  fronts threshold vdp --nucleus 3 --method sweep --perturbation 1e-6 --seed 1
  fronts threshold vdp --nucleus 1 --place edge
  fronts threshold friction --place edge --nucleus 1
  fronts threshold friction --nucleus 3 --definition whole --final-time 2000 --json"""

_VDP = {
    "a": 2.5,
    "b": 0.5,
    "eps": 0.01,
    "pattern": None,
    "method": "envelope",
    "perturbation": 0.0,
    "seed": 0,
}
_FRICTION = (*CELL, *START, "definition", "final_time", "ends", "n", "accuracy", "c_min", "c_max")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts threshold``."""
    parser.add_argument("model", choices=sorted(MODELS), help="the chain")
    add_chain_options(parser)
    add_nucleus_options(parser)
    parser.add_argument(
        "--method",
        choices=["envelope", "orbit", "sweep", "closed-form"],
        help="vdp: envelope: continuation as eps tends to 0; orbit: continuation in (8); sweep: "
        "slow growth of c from an in-phase start, extrapolated to rate zero, or c held and "
        "bisected where that has no limit; closed-form: (29), (37) (envelope)",
    )
    parser.add_argument(
        "--perturbation",
        "--perturb",
        type=real,
        help="vdp, sweep: seeded noise on the start; c is then held, not swept (0)",
    )
    parser.add_argument("--seed", type=whole, help="vdp: first of three seeds of the noise (0)")
    add_cell_options(parser)
    add_start_option(parser)
    parser.add_argument("--n", type=whole, help="friction: number of oscillators (31)")
    parser.add_argument(
        "--definition",
        choices=("first", "several", "whole"),
        help="friction: what counts as spreading: one new site sticks, three on each side, all "
        "sites (first)",
    )
    parser.add_argument(
        "--t-end",
        "--final-time",
        dest="final_time",
        type=real,
        help="friction: tau by which it must have happened (1000)",
    )
    parser.add_argument(
        "--ends",
        choices=("free", "literal"),
        help="friction: free ends, or Eq. 5 with the missing neighbours zero (free)",
    )
    parser.add_argument("--accuracy", type=real, help="friction: width of the bracket (1e-6)")
    parser.add_argument("--c-min", type=real, help="friction: lowest coupling tried (0.001)")
    parser.add_argument("--c-max", type=real, help="friction: highest coupling tried (0.5)")
    # The defaults of Model II are put in below, so that Model I can refuse its options.
    parser.set_defaults(**dict.fromkeys(_VDP))


def run(options: argparse.Namespace) -> Answer:
    """Find the threshold of the model that was named."""
    return MODELS[options.model](options)


def _vdp(options: argparse.Namespace) -> Answer:
    refuse(options, _FRICTION, options.model)
    refuse_other_methods(options, {"perturbation": "sweep", "seed": "sweep"})
    for name, default in _VDP.items():
        setattr(options, name, given(getattr(options, name), default))
    from theory.chains.vdp import VdpChain

    chain = VdpChain(a=options.a, b=options.b, c=0.0, eps=options.eps)
    _ = chain.stable_amplitude
    if options.nucleus > 41:
        raise UsageError(f"--nucleus {options.nucleus} is too wide: at most 41 sites.")
    if options.method == "sweep":
        return _sweep(chain, options)
    if options.method == "closed-form":
        return _closed_form(chain, options)
    return _continuation(chain, options)


def _continuation(chain: Any, options: argparse.Namespace) -> Answer:
    from verification.thresholds.breather import Method, breather_threshold

    found = breather_threshold(chain, nucleus_of(options), Method(options.method))
    payload: dict[str, object] = {
        "c_crit": found.c,
        "error": found.error,
        "mechanism": "fold",
        "seconds": found.seconds,
        "stable_to": found.c_stable,
        "stable_to_error": found.error_stable if found.c_stable is not None else None,
        "lost_by": found.mechanism.value,
        "growth_half_way": found.growth,
        "growth_half_way_mirrored": found.growth_mirrored,
        "pattern": found.nucleus.pattern,
        "method": found.method.value,
        "sites": found.sites,
    }
    lines = [
        f"fold: the breather exists up to c = {found.c:.12g}, uncertain by {found.error:.1e}",
        f"  {_STABILITY[found.mechanism.value]}"
        + (f" at c = {found.c_stable:.12g}" if found.c_stable is not None else ""),
        f"  half way there the largest growth rate is {found.growth:.4g} per unit of slow time",
    ]
    if found.growth_mirrored is not None:
        lines.append(f"  and {found.growth_mirrored:.4g} if mirror symmetry is kept")
    lines.append(f"  {found.sites} sites, {found.seconds:.3f} s")
    return Answer(payload, "\n".join(lines))


_STABILITY = {
    "fold": "it is stable up to the fold,",
    "symmetry-breaking": "it loses stability to a mode that breaks mirror symmetry",
    "real exponent": "it loses stability by a real exponent",
    "complex exponents": "it loses stability by a pair of complex exponents",
    "never stable": "it is stable at no coupling",
}


def _sweep(chain: Any, options: argparse.Namespace) -> Answer:
    from theory.chains.nucleus import Nucleus, Place
    from theory.parameters import within
    from verification.breathers.nucleation import Preparation
    from verification.breathers.slow_sweep import measure_delay

    if options.pattern is not None:
        raise UsageError("--pattern is not for --method sweep: a sweep starts in phase.")
    within("perturbation", options.perturbation, 0.0, 0.1)
    Nucleus(options.nucleus, "0" * max(options.nucleus - 1, 0))
    preparation = Preparation(
        options.nucleus, Place(options.place), options.perturbation, options.seed
    )
    if options.perturbation > 0.0:
        return held_answer(chain, preparation)
    found = measure_delay(chain, preparation)
    law = found.exponent if math.isfinite(found.exponent) else None
    payload: dict[str, object] = {
        "c_crit": found.c_0,
        "error": found.error,
        "mechanism": "escape in a slow sweep",
        "seconds": found.seconds,
        "rates": list(found.rates),
        "escapes": list(found.escapes),
        "delay_exponent": law,
        "method": "sweep",
    }
    table = [
        f"  dc/dT = {rate:<8.3g} escapes at c = {c:.6f}"
        for rate, c in zip(found.rates, found.escapes, strict=True)
    ]
    if law is None:
        table.append("  the escapes do not fall with the rate")
    else:
        table.append(f"  the delay grows like rate^{law:.3f}; 2/3 at a fold")
    if found.c_0 is None:
        # What does not escape at a fold has no limit of rate zero that these sweeps could show.
        held = held_answer(chain, preparation)
        payload |= {**held.payload, "seconds": found.seconds + float(str(held.payload["seconds"]))}
        return Answer(
            payload,
            "\n".join([held.text, "the sweeps do not follow the law of a fold:", *table]),
        )
    lines = [f"escape at c = {found.c_0:.8g}, uncertain by {found.error:.1e}, at rate zero"]
    return Answer(payload, "\n".join([*lines, *table, f"  {found.seconds:.3f} s"]))


def _closed_form(chain: Any, options: argparse.Namespace) -> Answer:
    from theory.averaged.breather import Reading, closed_form_fold

    if options.nucleus != 1 or options.place != "bulk":
        raise UsageError("--method closed-form is for --nucleus 1 in the bulk: (9) has one centre.")
    import time

    started = time.perf_counter()
    folds = {reading.value: closed_form_fold(chain, reading).c for reading in Reading}
    error = closed_form_fold(chain).error
    payload: dict[str, object] = {
        "c_crit": folds["neighbour"],
        "error": error,
        "mechanism": "fold",
        "seconds": time.perf_counter() - started,
        "readings": folds,
        "method": "closed-form",
    }
    lines = ["fold of (29) with (37), by the site n at which (37) is taken:"]
    lines += [
        f"  {name:<10} {'no solution' if c is None else f'c = {c:.12g}'}"
        for name, c in folds.items()
    ]
    return Answer(payload, "\n".join(lines))


def _friction(options: argparse.Namespace) -> Answer:
    refuse(options, _VDP, options.model)
    from theory.chains.chain import Ends
    from theory.chains.friction import FrictionChain
    from verification.thresholds.friction import Definition, Spreading, friction_threshold

    ends = Ends(options.ends or "free")
    chain = FrictionChain.of(cell_of(options), c=0.0, sites=given(options.n, 31), ends=ends)
    spreading = Spreading(
        options.nucleus,
        options.place,
        Definition(options.definition or "first"),
        given(options.final_time, 1000.0),
        start_point_of(options),
    )
    with Progress("threshold") as shown:
        found = friction_threshold(
            chain,
            spreading,
            lowest=given(options.c_min, 1e-3),
            highest=given(options.c_max, 0.5),
            accuracy=given(options.accuracy, 1e-6),
            progress=shown.report,
        )
    payload: dict[str, object] = {
        "c_crit": found.c,
        "error": found.error,
        "mechanism": "spreading by the final time",
        "seconds": found.seconds,
        "bracket": [found.low, found.high],
        "c_crit_at_twice_the_time": found.late,
        "fuzzy": None if found.fuzzy is None else list(found.fuzzy),
        "fuzzy_width": found.width,
        "monotone": found.monotone,
        "definition": spreading.definition.value,
        "final_time": spreading.final_time,
        "ends": ends.value,
        "start_point": spreading.point.value,
        "place": spreading.place.value,
        "sites": chain.sites,
        "runs": found.runs,
    }
    lines = [
        f"spreads from c = {found.c:.8g} on, uncertain by {found.error:.1e}",
        f"  {_SPREADING[spreading.definition.value]} by tau = {spreading.final_time:g}; "
        f"{ends.value} ends; start at the {spreading.point.value} of the cycle",
        f"  by tau = {2.0 * spreading.final_time:g}: c = {found.late:.8g}",
    ]
    if found.fuzzy is not None:
        lines.append(
            f"  fuzzy from c = {found.fuzzy[0]:.8g} to {found.fuzzy[1]:.8g}, a width of "
            f"{found.width:.2g}" + ("" if found.monotone else ": not monotone in c")
        )
    lines.append(f"  {found.runs} runs of {chain.sites} sites, {found.seconds:.3f} s")
    return Answer(payload, "\n".join(lines))


_SPREADING = {
    "first": "a new site sticks",
    "several": "three new sites on each side of the nucleus have stuck",
    "whole": "every site has stuck",
}

MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {"friction": _friction, "vdp": _vdp}
"""Model and the function that finds its threshold."""
