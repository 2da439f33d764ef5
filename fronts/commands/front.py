"""``fronts front MODEL``: direct simulation of a front, one function a model."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from fronts.answer import Answer, UsageError
from fronts.arguments import add_eta_options, eta_of, given, real, refuse, whole
from fronts.friction_options import (
    CELL,
    START,
    add_cell_options,
    add_start_option,
    cell_of,
    start_point_of,
)
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from verification.fronts.result import Front
    from verification.piecewise.run import FrontRun
    from verification.runs.model import Model

EXAMPLE = """examples:
  fronts front piecewise --c 0.5 --eta 0.03125
  fronts front piecewise --c 0.44 --a 4 --b 0.5 --start resting --json
  fronts front envelope --c 0.6 --a 4 --b 0.5
  fronts front vdp --c 0.6 --a 4 --b 0.5 --eps 0.01 --json
  fronts front friction --c 0.02 --n 101
  fronts front friction --c 0.008 --nucleus 6 --v-d 1.25 --json"""

_FRICTION = (*CELL, *START, "nucleus")

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
        "--n",
        type=whole,
        help="vdp, envelope: sites beyond the start tried first (default 32); friction: sites of "
        "the chain tried first (default 101)",
    )
    parser.add_argument(
        "--behind",
        choices=("free", "wave"),
        help="vdp, envelope: a free end behind the start, or a wave that goes on (default free)",
    )
    parser.add_argument(
        "--accuracy",
        type=real,
        help="relative error of v at which the run ends (vdp, envelope: 1e-3; friction: 1e-2)",
    )
    parser.add_argument(
        "--nucleus", type=whole, metavar="SIZE", help="friction: sites excited at the edge (1)"
    )
    add_cell_options(parser)
    add_start_option(parser)


def run(options: argparse.Namespace) -> Answer:
    """Run the model that was named."""
    return MODELS[options.model](options)


def _piecewise(options: argparse.Namespace) -> Answer:
    refuse(options, ("eps", "n", "accuracy", "behind", *_FRICTION), options.model)
    from verification.piecewise.simulation import simulate_front

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
    from verification.runs.model import Model

    return _chain(options, Model.FULL)


def _envelope(options: argparse.Namespace) -> Answer:
    from verification.runs.model import Model

    refuse(options, ("eps",), options.model)
    return _chain(options, Model.ENVELOPE)


def _chain(options: argparse.Namespace, model: Model) -> Answer:
    """Measure a front of (8) or (43); with --eta alone a = 1 and b = η, the same up to a scale."""
    from theory.chains.vdp import VdpChain
    from theory.parameters import count_within
    from verification.fronts.measure import measure_front
    from verification.fronts.result import LeftBoundary

    refuse(options, ("start_v", *_FRICTION), options.model)
    _moving_only(options)
    eta = eta_of(options)
    a, b = (options.a, options.b) if options.eta is None else (1.0, eta)
    chain = VdpChain(
        a=a,
        b=b,
        c=options.c,
        eps=0.01 if options.eps is None else options.eps,
        sites=count_within("number of sites n", given(options.n, 32), 2, 1000),
    )
    with Progress(f"front at c = {options.c:g}") as shown:
        result = measure_front(
            model.chain_of(chain),
            left_boundary=LeftBoundary(options.behind or "free"),
            accuracy=1e-3 if options.accuracy is None else options.accuracy,
            progress=shown.report,
        )
    payload = _numbers(result) | {"outruns_waves": result.outruns_waves}
    return Answer(payload, "\n".join([_measured(result, "slow time"), _behind(result)]))


def _friction(options: argparse.Namespace) -> Answer:
    from theory.chains.friction import FrictionChain
    from verification.fronts.measure import checked_friction_sites as checked_sites
    from verification.fronts.measure import measure_front

    refuse(options, ("eta", "a", "b", "eps", "behind", "start_v"), options.model)
    _moving_only(options)
    size = given(options.nucleus, 1)
    # Before the chain, which allows more sites than a front.
    sites = checked_sites(given(options.n, 101), size)
    chain = FrictionChain.of(cell_of(options), c=options.c, sites=sites)
    with Progress(f"front at c = {options.c:g}") as shown:
        result = measure_front(
            chain,
            excited=size,
            point=start_point_of(options),
            accuracy=given(options.accuracy, 1e-2),
            progress=shown.report,
        )
    payload = _numbers(result) | {"largest_group_velocity": chain.largest_group_velocity}
    return Answer(payload, _measured(result, "tau"))


def _moving_only(options: argparse.Namespace) -> None:
    if options.start != "moving":
        raise UsageError(f"--start {options.start} is for the model piecewise: leave it out.")


def _numbers(result: Front) -> dict[str, object]:
    return {
        "v": result.v,
        "error": result.error,
        "steady": result.steady,
        "status": result.status.value,
        "seconds": result.seconds,
        "arrivals": int(result.arrivals.size),
        "sites": result.chain.sites,
        "steps": result.steps,
    }


def _behind(result: Front) -> str:
    """Say whether what is behind the front matters."""
    boundary = str(result.left_boundary)
    if result.v is None:
        return "  what is behind it was: " + boundary
    if result.outruns_waves:
        return "  it outruns the waves behind it: v is above c"
    return f"  waves behind it catch up with it: v is that with a {_BEHIND[boundary]}"


_BEHIND = {
    "free": "free end behind, see --behind",
    "wave": "wave behind that goes on for ever, see --behind",
}


def _measured(result: Front, time: str) -> str:
    status = result.status.value
    lines = [f"{status}: {_CHAIN_MEANING[status]}"]
    if result.v is not None and status != "pinned":
        lines.append(
            f"  v = {result.v:.10g}, uncertain by {result.error:.1e} (sites per unit of {time})"
        )
    lines.append(
        f"  {result.arrivals.size} arrivals on a chain of {result.chain.sites} sites, "
        f"{result.steps} steps, {result.seconds:.3f} s"
    )
    return "\n".join(lines)


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
    "friction": _friction,
}
"""Model and the function that runs it."""
