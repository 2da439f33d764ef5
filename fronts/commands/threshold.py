"""``fronts threshold MODEL``: the coupling at which a nucleus stops being localised."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import Any

from fronts.answer import Answer, UsageError
from fronts.arguments import real
from fronts.commands.breather import add_chain_options, add_nucleus_options, nucleus_of

EXAMPLE = """examples:
  fronts threshold vdp --nucleus 3
  fronts threshold vdp --nucleus 1 --method orbit --json
  fronts threshold vdp --nucleus 5 --method sweep
  fronts threshold vdp --nucleus 3 --method sweep --perturbation 1e-6 --seed 1
  fronts threshold vdp --nucleus 1 --place edge"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts threshold``."""
    parser.add_argument("model", choices=sorted(MODELS), help="the chain")
    add_chain_options(parser)
    add_nucleus_options(parser)
    parser.add_argument(
        "--method",
        choices=["envelope", "orbit", "sweep", "closed-form"],
        default="envelope",
        help="envelope: continuation as eps tends to 0; orbit: continuation in (8); sweep: slow "
        "growth of c from an in-phase start, extrapolated to rate zero",
    )
    parser.add_argument(
        "--perturbation", type=real, default=0.0, help="seeded noise on the start of a sweep (0)"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the noise")


def run(options: argparse.Namespace) -> Answer:
    """Find the threshold of the model that was named."""
    return MODELS[options.model](options)


def _vdp(options: argparse.Namespace) -> Answer:
    from theory.vdp_chain import VdpChain

    chain = VdpChain(options.a, options.b, 0.0, options.eps)
    _ = chain.stable_amplitude
    if options.nucleus > 41:
        raise UsageError(f"--nucleus {options.nucleus} is too wide: at most 41 sites.")
    if options.method == "sweep":
        return _sweep(chain, options)
    if options.method == "closed-form":
        return _closed_form(chain, options)
    return _continuation(chain, options)


def _continuation(chain: Any, options: argparse.Namespace) -> Answer:
    from verification.breather_threshold import Method, breather_threshold

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
    from theory.parameters import within
    from verification.nucleation import Preparation, measure_delay
    from verification.nucleus import Nucleus, Place

    if options.pattern is not None:
        raise UsageError("--pattern is not for --method sweep: a sweep starts in phase.")
    within("perturbation", options.perturbation, 0.0, 0.1)
    Nucleus(options.nucleus, "0" * max(options.nucleus - 1, 0))
    preparation = Preparation(
        options.nucleus, Place(options.place), options.perturbation, options.seed
    )
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
    lines = [f"escape at c = {found.c_0:.8g}, uncertain by {found.error:.1e}, at rate zero"]
    lines += [
        f"  dc/dT = {rate:<8.3g} escapes at c = {c:.6f}"
        for rate, c in zip(found.rates, found.escapes, strict=True)
    ]
    if law is not None:
        lines.append(f"  the delay grows like rate^{law:.3f}; 2/3 at a fold")
    lines.append(f"  {found.seconds:.3f} s")
    return Answer(payload, "\n".join(lines))


def _closed_form(chain: Any, options: argparse.Namespace) -> Answer:
    from theory.breather import Reading, closed_form_fold

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


MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {"vdp": _vdp}
"""Model and the function that finds its threshold."""
