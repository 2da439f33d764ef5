"""``fronts breather``: the localised oscillation of the Van der Pol chain, four ways."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import given, real, refuse_other_methods, whole
from fronts.breather_words import breather_in_words, breather_table

if TYPE_CHECKING:
    from theory.chains.nucleus import Nucleus
    from verification.breathers.result import Breather

EXAMPLE = """examples:
  fronts breather --c 0.1
  fronts breather --c 0.1 --method all
  fronts breather --c 0.19 --a 2.5 --b 0.5 --eps 0.01 --method orbit --json
  fronts breather --c 0.1 --nucleus 3 --pattern=-+ --method envelope
  fronts breather --c 0.195 --method closed-form --reading tail"""

METHODS = ("closed-form", "envelope", "orbit", "simulation", "all")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts breather``."""
    parser.add_argument("--c", type=real, default=0.1, help="coupling c > 0 (default 0.1, Fig. 7)")
    add_chain_options(parser)
    parser.add_argument(
        "--n", type=whole, help="number of sites; by default 7 on each side of the nucleus"
    )
    add_nucleus_options(parser)
    parser.add_argument(
        "--method",
        choices=[*METHODS],
        default="orbit",
        help="closed-form: (29), (37); envelope: the averaged chain (43), solved; orbit: the "
        "periodic orbit of (8); simulation: (8) run from a perturbed start; all: a table of the "
        "four (orbit)",
    )
    parser.add_argument(
        "--reading",
        choices=["centre", "neighbour", "tail"],
        help="closed-form: site n at which (37) is taken: 0, 1, or far out (neighbour)",
    )
    parser.add_argument("--seed", type=whole, help="simulation: seed of the noise (0)")


def add_chain_options(parser: argparse.ArgumentParser) -> None:
    """Declare a, b and ε; the defaults are those of Figs. 7-11."""
    parser.add_argument("--a", type=real, default=2.5, help="damping coefficient a (2.5)")
    parser.add_argument("--b", type=real, default=0.5, help="damping coefficient b (0.5)")
    parser.add_argument("--eps", type=real, default=0.01, help="small parameter (0.01)")


def add_nucleus_options(parser: argparse.ArgumentParser) -> None:
    """Declare the nucleus: its size, pattern and place."""
    parser.add_argument(
        "--nucleus", type=whole, default=1, metavar="SIZE", help="excited sites (1)"
    )
    parser.add_argument(
        "--pattern",
        help="one sign a link, left to right: + leads by pi/2, - lags, 0 in phase, x opposite "
        "(write --pattern=-+); by default what an in-phase start relaxes to",
    )
    parser.add_argument(
        "--place", choices=["bulk", "edge"], default="bulk", help="middle or end of the chain"
    )


def nucleus_of(options: argparse.Namespace) -> Nucleus:
    """Return the nucleus that the options describe."""
    from theory.chains.nucleus import Nucleus, outward_pattern

    pattern = options.pattern
    if pattern is None:
        if options.place == "edge" and options.nucleus > 1:
            raise UsageError("an edge nucleus of 2 or more sites needs a --pattern.")
        pattern = outward_pattern(options.nucleus) if options.nucleus > 1 else ""
    return Nucleus(options.nucleus, pattern, options.place)


def run(options: argparse.Namespace) -> Answer:
    """Compute the breather by the method that was named."""
    refuse_other_methods(options, {"reading": "closed-form", "seed": "simulation"})
    from theory.chains.vdp import VdpChain
    from verification.breathers.breather import breather

    nucleus = nucleus_of(options)
    sites = nucleus.size + 14 if options.n is None else options.n
    chain = VdpChain(a=options.a, b=options.b, c=options.c, eps=options.eps, sites=sites)
    if options.method == "all":
        every = breather(chain, nucleus=nucleus, method="all")
        payload: dict[str, Any] = {"method": "all", "pattern": nucleus.pattern, "c": chain.c}
        payload["methods"] = {name: _payload(found) for name, found in every.methods.items()}
        return Answer(payload, breather_table(payload["methods"]))
    found = breather(
        chain,
        nucleus=nucleus,
        method=options.method,
        reading=options.reading or "neighbour",
        seed=given(options.seed, 0),
    )
    payload = _payload(found)
    return Answer(payload, breather_in_words(payload))


def _payload(found: Breather) -> dict[str, Any]:
    """Return what JSON has of a breather."""
    every = found.to_dict()
    return {key: value for key, value in every.items() if key not in ("chain", "nucleus")}
