"""``fronts front MODEL``: direct simulation of a front, one function a model."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from fronts.answer import Answer, UsageError
from fronts.arguments import add_eta_options, eta_of, real
from fronts.progress import Fraction

if TYPE_CHECKING:
    from verification.piecewise_run import FrontRun
    from verification.vdp_front import FrontMeasurement
    from verification.vdp_run import Model

EXAMPLE = """examples:
  fronts front piecewise --c 0.5 --eta 0.03125
  fronts front piecewise --c 0.44 --a 4 --b 0.5 --start resting --json
  fronts front envelope --c 0.6 --a 4 --b 0.5
  fronts front vdp --c 0.6 --a 4 --b 0.5 --eps 0.01 --json"""

_STARTS = {
    "moving": "a travelling wave, near the fastest that fits",
    "resting": "the static front",
    "step": "phi = 1 up to site 0 and 0 beyond",
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts front``."""
    parser.add_argument("model", choices=sorted(MODELS), help="the chain to run")
    parser.add_argument("--c", type=real, required=True, help="coupling c > 0")
    add_eta_options(parser, real)
    parser.add_argument(
        "--start",
        choices=list(_STARTS),
        default="moving",
        help="piecewise: " + "; ".join(f"{name}: {text}" for name, text in _STARTS.items()),
    )
    parser.add_argument(
        "--start-v",
        type=real,
        metavar="V",
        help="piecewise: velocity of a moving start, negative to retreat",
    )
    parser.add_argument("--eps", type=real, help="vdp: small parameter (default 0.01)")
    parser.add_argument(
        "--n", type=int, help="vdp, envelope: sites beyond the start tried first (default 32)"
    )
    parser.add_argument(
        "--behind",
        choices=("free", "wave"),
        help="vdp, envelope: a free end behind the start, or a wave that goes on (default free)",
    )
    parser.add_argument(
        "--accuracy",
        type=real,
        help="vdp, envelope: relative error of v at which the run ends (default 1e-3)",
    )


def run(options: argparse.Namespace) -> Answer:
    """Run the model that was named."""
    return MODELS[options.model](options)


def _piecewise(options: argparse.Namespace) -> Answer:
    _refuse(options, ("eps", "n", "accuracy", "behind"))
    from verification.piecewise_simulation import simulate_front

    result = simulate_front(
        options.c, eta_of(options), options.start, start_velocity=options.start_v
    )
    payload: dict[str, object] = {
        "v": result.v,
        "error": result.error,
        "steady": result.steady,
        "status": result.status.value,
        "events": result.events,
        "seconds": result.seconds,
        "period_spread": result.period_spread,
        "events_per_site": result.events_per_site,
        "sliding_events": result.sliding_events,
        "repeat": result.repeat,
        "margin": result.margin,
        "window": result.window,
        "truncation": result.truncation,
        "method": result.method,
    }
    return Answer(payload, _in_words(result))


def _in_words(result: FrontRun) -> str:
    status = result.status.value
    lines = [f"{status}: {_MEANING[status]}"]
    if result.v is not None and status != "pinned":
        lines.append(f"  v = {result.v:.15g}, uncertain by {result.error:.1e} (sites per unit T)")
        lines.append(f"  spread of the period {result.period_spread:.1e} of its mean")
        lines.append(f"  {result.events_per_site:g} switchings a site")
    if result.repeat is not None:
        lines.append(f"  the motion repeats itself every {result.repeat} sites")
    if result.sliding_events:
        lines.append(f"  sites slid along the threshold {result.sliding_events} times")
    if result.margin is not None:
        lines.append(f"  closest approach to the threshold from now on: {result.margin:.3g}")
    lines.append(
        f"  {result.events} switchings, a window of {result.window} sites "
        f"(its ends disturb less than {result.truncation:.0e}), {result.seconds:.3f} s"
    )
    return "\n".join(lines)


_MEANING = {
    "steady": "the period of the front has settled to the tolerance.",
    "settling": "the spread of the period still decays geometrically.",
    "unsteady": "the period does not settle; v is a mean.",
    "sliding": "the period settles, with sites sliding along the threshold.",
    "pinned": "no site can ever cross the threshold again.",
    "marginal": "at rest within round-off of the threshold; nothing can be said.",
}


def _vdp(options: argparse.Namespace) -> Answer:
    from verification.vdp_run import Model

    return _chain(options, Model.FULL)


def _envelope(options: argparse.Namespace) -> Answer:
    from verification.vdp_run import Model

    _refuse(options, ("eps",))
    return _chain(options, Model.ENVELOPE)


def _chain(options: argparse.Namespace, model: Model) -> Answer:
    """Measure a front of (8) or (43); with --eta alone a = 1 and b = η, the same up to a scale."""
    from theory.vdp_chain import VdpChain
    from verification.vdp_front import Behind, measure_front

    _refuse(options, ("start_v",))
    if options.start != "moving":
        raise UsageError(f"--start {options.start} is for the model piecewise: leave it out.")
    eta = eta_of(options)
    a, b = (options.a, options.b) if options.eta is None else (1.0, eta)
    chain = VdpChain(
        a,
        b,
        options.c,
        eps=0.01 if options.eps is None else options.eps,
        sites=32 if options.n is None else options.n,
    )
    with Fraction(f"front at c = {options.c:g}") as shown:
        result = measure_front(
            chain,
            model,
            behind=Behind(options.behind or "free"),
            accuracy=1e-3 if options.accuracy is None else options.accuracy,
            progress=shown.show,
        )
    payload: dict[str, object] = {
        "v": result.v,
        "error": result.error,
        "steady": result.steady,
        "status": result.status.value,
        "seconds": result.seconds,
        "arrivals": int(result.arrivals.size),
        "sites": result.chain.sites,
        "steps": result.steps,
    }
    return Answer(payload, _measured(result))


def _measured(result: FrontMeasurement) -> str:
    status = result.status.value
    lines = [f"{status}: {_CHAIN_MEANING[status]}"]
    if result.v is not None and status != "pinned":
        lines.append(
            f"  v = {result.v:.10g}, uncertain by {result.error:.1e} (sites per unit of slow time)"
        )
    lines.append(
        f"  {result.arrivals.size} arrivals on a chain of {result.chain.sites} sites, "
        f"{result.steps} steps, {result.seconds:.3f} s"
    )
    return "\n".join(lines)


def _refuse(options: argparse.Namespace, names: tuple[str, ...]) -> None:
    for name in names:
        if getattr(options, name) is not None:
            flag = name.replace("_", "-")
            raise UsageError(f"--{flag} has no meaning for the model {options.model}.")


_CHAIN_MEANING = {
    "steady": "the velocity has settled to the accuracy asked for.",
    "unsteady": "the front runs, but its velocity has not settled on the longest chain.",
    "pinned": "no further site is reached, and the amplitudes have stopped changing.",
    "creeping": "no site was reached for long, but the amplitudes still change.",
    "collapsed": "the excited sites went to rest.",
}

MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {
    "piecewise": _piecewise,
    "vdp": _vdp,
    "envelope": _envelope,
}
"""Model and the function that runs it."""
