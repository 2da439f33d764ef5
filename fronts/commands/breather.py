"""``fronts breather``: the localised oscillation of the Van der Pol chain, four ways."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import given, real, refuse_other_methods, whole
from fronts.breather_words import breather_in_words, breather_table

if TYPE_CHECKING:
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain

EXAMPLE = """examples:
  fronts breather --c 0.1
  fronts breather --c 0.1 --method all
  fronts breather --c 0.19 --a 2.5 --b 0.5 --eps 0.01 --method orbit --json
  fronts breather --c 0.1 --nucleus 3 --pattern=-+ --method envelope
  fronts breather --c 0.195 --method closed-form --reading tail"""

MAX_SITES = {"closed-form": 100_000, "envelope": 401, "orbit": 101, "simulation": 2001}


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
        choices=[*METHODS, "all"],
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

    nucleus = nucleus_of(options)
    sites = nucleus.size + 14 if options.n is None else options.n
    most = MAX_SITES.get(options.method, min(MAX_SITES.values()))
    if sites > most:
        raise UsageError(
            f"--n {sites} is too many for --method {options.method}: "
            f"at most {most}; a breather needs a few sites."
        )
    chain = VdpChain(a=options.a, b=options.b, c=options.c, eps=options.eps, sites=sites)
    nucleus.first(sites)
    _ = chain.stable_amplitude
    payload: dict[str, Any] = {
        "method": options.method,
        "pattern": nucleus.pattern,
        "c": chain.c,
    }
    if options.method != "all":
        payload |= METHODS[options.method](chain, nucleus, options)
        return Answer(payload, breather_in_words(payload))
    names = [name for name in METHODS if name != "closed-form" or has_closed_form(nucleus)]
    payload["methods"] = {name: METHODS[name](chain, nucleus, options) for name in names}
    return Answer(payload, breather_table(payload["methods"]))


def has_closed_form(nucleus: Nucleus) -> bool:
    """Tell whether (9) is about such a nucleus: it has one centre, far from the ends."""
    return nucleus.size == 1 and nucleus.place == "bulk"


def _closed_form(
    chain: VdpChain, nucleus: Nucleus, options: argparse.Namespace
) -> dict[str, object]:
    from dataclasses import replace

    from theory.averaged.breather import Reading, solve_breather
    from verification.breathers.floquet import approximate_multipliers

    if not has_closed_form(nucleus):
        raise UsageError("--method closed-form is for --nucleus 1 in the bulk: (9) has one centre.")
    found = solve_breather(chain, Reading(options.reading or "neighbour"))
    fold: dict[str, object] = {"fold": found.fold.c, "fold_error": found.fold.error}
    if found.alpha_0 is None:
        return _none(found.seconds, fold)
    odd = replace(chain, sites=min(chain.sites + (chain.sites + 1) % 2, 31))
    multipliers = approximate_multipliers(odd, found)
    amplitudes = found.amplitudes(chain.sites - nucleus.outward(chain.sites))
    return {
        "status": "exists",
        "amplitudes": amplitudes.tolist(),
        "frequency": found.frequency,
        "phase_step": found.phase_step,
        "stable": multipliers.stable,
        "growth": multipliers.growth,
        **_trust(chain, nucleus, amplitudes, found.frequency),
        "residual": found.residual,
        "seconds": found.seconds,
        "trivial": multipliers.trivial,
        "decay": found.decay,
        **fold,
    }


def _envelope(chain: VdpChain, nucleus: Nucleus, options: argparse.Namespace) -> dict[str, object]:
    from verification.breathers.envelope import solve_envelope_breather

    found = solve_envelope_breather(chain, nucleus)
    if found.exponents is None:
        return _none(found.seconds, _fold(found.fold))
    amplitudes = abs(found.phi)
    frequency = 1.0 + chain.eps * found.omega
    return {
        "status": "exists",
        **_sites(found.phi, amplitudes, nucleus),
        "frequency": frequency,
        "stable": found.exponents.stable,
        "growth": found.exponents.growth,
        **_trust(chain, nucleus, amplitudes[nucleus.outward(chain.sites) :], frequency),
        "residual": found.residual,
        "seconds": found.seconds,
        "trivial": found.exponents.trivial,
    }


def _orbit(chain: VdpChain, nucleus: Nucleus, options: argparse.Namespace) -> dict[str, object]:
    from verification.breathers.orbits import solve_orbit

    found = solve_orbit(chain, nucleus)
    if found.multipliers is None:
        return _none(found.seconds, _fold(found.fold))
    return {
        "status": "exists",
        **_sites(found.harmonics, found.amplitudes, nucleus),
        "frequency": found.frequency,
        "stable": found.multipliers.stable,
        "growth": found.multipliers.growth,
        "error": found.error,
        "seconds": found.seconds,
        "trivial": found.multipliers.trivial,
        "residual": found.residual,
    }


def _simulation(
    chain: VdpChain, nucleus: Nucleus, options: argparse.Namespace
) -> dict[str, object]:
    from verification.breathers.run import run_breather

    found = run_breather(chain, nucleus, seed=given(options.seed, 0))
    if found.status == "escaped":
        beyond = _beyond_fold(chain, nucleus)
        if beyond:
            return {**_none(found.seconds, beyond), "time": found.time}
        return {**_none(found.seconds, {"time": found.time}), "status": "escaped"}
    return {
        "status": found.status.value,
        **_sites(found.harmonics, found.amplitudes, nucleus),
        "frequency": found.frequency,
        # A run that settled has forgotten its noise; one that has not settled decides nothing.
        "stable": True if found.status == "settled" else None,
        "growth": None,
        "error": found.error if math.isfinite(found.error) else None,
        "seconds": found.seconds,
        "drift": found.drift,
        "time": found.time,
    }


def _beyond_fold(chain: VdpChain, nucleus: Nucleus) -> dict[str, object]:
    """Return the fold of the periodic orbits of (8), or nothing if it is not known to be below c.

    A run has no fold of its own. The chain of the orbits is short: a breather needs a few sites.
    """
    from theory.parameters import ParameterError
    from verification.breathers.newton import NotConvergedError
    from verification.thresholds.breather import Method, breather_threshold

    try:
        fold = breather_threshold(chain, nucleus, Method.ORBIT)
    except (ParameterError, NotConvergedError):
        return {}
    return {"fold": fold.c, "fold_error": fold.error} if chain.c > fold.c + fold.error else {}


def _trust(
    chain: VdpChain, nucleus: Nucleus, amplitudes: Any, frequency: float
) -> dict[str, object]:
    """Return how far a theory of small ε is from the periodic orbit of (8)."""
    from theory.parameters import ParameterError
    from verification.breathers.newton import NotConvergedError
    from verification.breathers.orbit_distance import distance_from_orbit

    unknown: dict[str, object] = {"error": None, "frequency_error": None}
    try:
        distance = distance_from_orbit(chain, nucleus, amplitudes, frequency)
    except (ParameterError, NotConvergedError) as error:
        return {**unknown, "error_unknown": str(error)}
    if distance is None:
        return {**unknown, "error_unknown": "(8) has no such orbit at this coupling"}
    return {"error": distance.amplitude, "frequency_error": distance.frequency}


def _sites(waves: Any, amplitudes: Any, nucleus: Nucleus) -> dict[str, object]:
    """List amplitudes from the centre to the right end, and all phases in units of pi."""
    import numpy as np

    sites = len(amplitudes)
    centre = nucleus.outward(sites)
    edge = nucleus.first(sites) + nucleus.size - 1
    outward = waves[edge + 1] / waves[edge] if edge + 1 < sites else 1.0
    return {
        "amplitudes": [float(value) for value in amplitudes[centre:]],
        "left": [float(value) for value in amplitudes[: centre + nucleus.size % 2][::-1]],
        "phase_step": float(np.angle(outward)),
        "phases": [float(value) for value in np.angle(waves / waves[centre]) / np.pi],
    }


def _fold(fold: Any) -> dict[str, object]:
    return {"fold": None if fold is None else fold.c, "fold_error": fold and fold.error}


def _none(seconds: float, fold: dict[str, object]) -> dict[str, object]:
    return {
        "status": "none",
        "amplitudes": [],
        "frequency": None,
        "phase_step": None,
        "stable": None,
        "error": None,
        "seconds": seconds,
        **fold,
    }


METHODS: dict[str, Callable[[VdpChain, Nucleus, argparse.Namespace], dict[str, object]]] = {
    "closed-form": _closed_form,
    "envelope": _envelope,
    "orbit": _orbit,
    "simulation": _simulation,
}
"""Method and the function that computes by it."""
