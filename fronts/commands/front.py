"""``fronts front MODEL``: direct simulation of a front, one function a model."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from fronts.answer import Answer, UsageError
from fronts.arguments import real

if TYPE_CHECKING:
    from verification.piecewise_run import FrontRun

EXAMPLE = """examples:
  fronts front piecewise --c 0.5 --eta 0.03125
  fronts front piecewise --c 0.44 --a 4 --b 0.5 --start resting --json"""

_STARTS = {
    "moving": "a travelling wave, near the fastest that fits",
    "resting": "the static front",
    "step": "phi = 1 up to site 0 and 0 beyond",
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts front``."""
    parser.add_argument("model", choices=sorted(MODELS), help="the chain to run")
    parser.add_argument("--c", type=real, required=True, help="coupling c > 0")
    parser.add_argument("--eta", type=real, help="b/a^2, between 0 and 1/8")
    parser.add_argument(
        "--a", type=real, help="damping coefficient a (with --b, in place of --eta)"
    )
    parser.add_argument(
        "--b", type=real, help="damping coefficient b (with --a, in place of --eta)"
    )
    parser.add_argument(
        "--start",
        choices=list(_STARTS),
        default="moving",
        help="; ".join(f"{name}: {text}" for name, text in _STARTS.items()),
    )
    parser.add_argument(
        "--start-v", type=real, metavar="V", help="velocity of a moving start, negative to retreat"
    )


def run(options: argparse.Namespace) -> Answer:
    """Run the model that was named."""
    return MODELS[options.model](options)


def _eta(options: argparse.Namespace) -> float:
    given = (options.a is not None, options.b is not None)
    if options.eta is not None:
        if any(given):
            raise UsageError("--eta and --a, --b say the same thing twice: give one of them.")
        return float(options.eta)
    if not all(given):
        raise UsageError("give --eta, or both --a and --b.")
    from theory.unit_cell import eta_from_damping

    return eta_from_damping(options.a, options.b)


def _piecewise(options: argparse.Namespace) -> Answer:
    from verification.piecewise_simulation import simulate_front

    result = simulate_front(options.c, _eta(options), options.start, start_velocity=options.start_v)
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

MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {"piecewise": _piecewise}
"""Model and the function that runs it."""
