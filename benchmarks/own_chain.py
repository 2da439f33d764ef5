"""Chains of one's own beside heyoka and jitcode at equal error, and a million sites.

Two problems to t = 200: 31 Duffing-Van der Pol cells, each with another a, with springs to second
neighbours; and a square lattice of 100 x 100 cells, of which nine are excited. Ours is the compiled
default stepper, all sites stepped and errors not stated; compile times stand apart. The error is
the largest of y and ẏ at the end against scipy's DOP853 at 1e-13 with the equation written a second
time. ``python -m benchmarks.own_chain`` measures all and writes ``results/own_chain.json``;
``chain``, ``lattice`` or ``million`` after it measures one.
"""

from __future__ import annotations

import json
import resource
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
import numpy.typing as npt

from benchmarks.chain import Solve, compiled_by_heyoka, compiled_by_jitcode
from benchmarks.work_precision import (
    Answer,
    Effort,
    Setting,
    least_factor,
    measure_side_by_side,
)
from theory.chains.oscillator import OscillatorChain
from verification.execution.metadata import installed_versions, this_machine
from verification.execution.time_limit import time_limit
from verification.references.network import oscillator_rate, states_by_scipy
from verification.runs.excite import excite
from verification.runs.smooth_integration import SmoothIntegration

FloatArray = npt.NDArray[np.float64]

RESULT = Path(__file__).parent / "results" / "own_chain.json"
END = 200.0
OURS, HEYOKA, JITCODE = "ours", "heyoka", "jitcode dop853"
LOW, HIGH = 1e-10, 1e-3
TOLERANCES = {"chain": tuple(10.0**-k for k in range(4, 13)), "lattice": (1e-5, 1e-7, 1e-9, 1e-11)}
BUILD_LIMIT = 300
"""Seconds of the wall after which a peer's compilation is given up."""


def problem(name: str) -> OscillatorChain:
    """Return the chain of a problem."""
    cell: dict[str, Any] = {
        "damping": "1 - a*y**2 + b*y**4", "values": {"a": 4.0, "b": 0.5}, "c": 0.6, "eps": 0.05
    }  # fmt: skip
    if name == "lattice":
        return OscillatorChain(**cell, coupling="square", shape=(100, 100))
    return OscillatorChain(
        **cell, stiffness="y + y**3/100", coupling="next-nearest:1,0.2", disorder={"a": 0.1}, seed=1
    )


def start_of(chain: OscillatorChain) -> FloatArray:
    """Return the start: three sites in a row excited, or three rows of three."""
    middle = chain.sites // 2 + (50 if chain.shape else 0)
    rows = (-100, 0, 100) if chain.shape else (0,)
    return excite(chain, [middle + row + n for row in rows for n in (0, 1, 2)], 3.8)


def reference(chain: OscillatorChain) -> FloatArray:
    """Return the final state by scipy."""
    a = np.asarray(chain.site_values["a"])
    k = 0.0 if chain.stiffness == "y" else 0.01
    rate = oscillator_rate(
        lambda y: y + k * y**3, lambda y, v: 1.0 - a * y**2 + 0.5 * y**4, chain.links.matrix,
        c=chain.c, eps=chain.eps,
    )  # fmt: skip
    found: FloatArray = states_by_scipy(rate, start_of(chain).ravel(), np.array([0.0, END]), 1e-13)[
        -1
    ]
    return found


def ours(chain: OscillatorChain, tolerance: float) -> FloatArray:
    """Return the final state of the default stepper, all sites stepped."""
    run = SmoothIntegration(
        chain, start_of(chain), [0.0, END], tolerance=tolerance, level=1e9, active_window=False
    )
    while not run.finished:
        run.advance(10**9)
    found: FloatArray = run.samples[-1].ravel()
    return found


def _forces(chain: OscillatorChain, y: Any, w: Any) -> list[Any]:
    """Return the accelerations in the symbols of a peer."""
    a = np.broadcast_to(np.asarray(chain.site_values["a"]), chain.sites)
    k = 0.0 if chain.stiffness == "y" else 0.01
    links, found = chain.links, []
    for n in range(chain.sites):
        square = y[n] * y[n]
        force = -y[n] - chain.eps * w[n] * (1.0 - float(a[n]) * square + 0.5 * square * square)
        if k:
            force = force - k * square * y[n]
        row = slice(links.starts[n], links.starts[n + 1])
        pull = float(links.total[n]) * y[n]
        for j, weight in zip(links.sites[row], links.weights[row], strict=True):
            pull = pull - float(weight) * y[int(j)]
        found.append(force - chain.eps * chain.c * pull)
    return found


def heyoka_solver(chain: OscillatorChain, tolerance: float) -> Solve:
    """Return heyoka's Taylor integrator, compiled; in compact mode where there are many sites."""
    return compiled_by_heyoka(
        partial(_forces, chain), start_of(chain).ravel(), END, tolerance, compact=chain.sites > 100
    )


def jitcode_solver(chain: OscillatorChain, _: float) -> Solve:
    """Return jitcode's integrator, compiled."""
    return compiled_by_jitcode(partial(_forces, chain), start_of(chain).ravel(), END, "dop853")


def _built(build: Callable[[], Solve]) -> tuple[Solve | None, float, str]:
    """Return a peer's integrator, the seconds of its compilation, and why there is none."""
    begin = perf_counter()
    try:
        with time_limit(BUILD_LIMIT):
            return build(), perf_counter() - begin, ""
    except Exception as error:  # whatever a peer raises is its result
        return None, perf_counter() - begin, str(error)[:160]


def measured(name: str, say: Callable[[str], None] = print) -> dict[str, Any]:
    """Return all points of a problem, compile times, and the least factors of time."""
    chain = problem(name)
    true = reference(chain)
    begin = perf_counter()
    ours(chain, 1e-3)
    compiled = {OURS: perf_counter() - begin}
    settings, missing = [], {}
    for tolerance in TOLERANCES[name]:
        settings.append(_setting(OURS, tolerance, partial(ours, chain), true))
    for method, solver, one in ((HEYOKA, heyoka_solver, True), (JITCODE, jitcode_solver, False)):
        peers = TOLERANCES[name][:2] if name == "lattice" else TOLERANCES[name][::2]
        solve = None
        for tolerance in peers:
            if solve is None or one:
                solve, seconds, why = _built(partial(solver, chain, tolerance))
                say(f"{name}: {method} {tolerance:.0e} compiled in {seconds:.1f} s {why}")
                compiled.setdefault(method, seconds)
            if solve is None:
                missing[method] = why
                break
            settings.append(_setting(method, tolerance, solve, true, peer=True))
    points, failures = measure_side_by_side(
        "own chain", name, settings, effort=Effort(seconds=2.0, most=9, limit=200.0)
    )
    for point in points:
        say(f"{name}: {point.method} {point.knob}: error {point.error:.1e}, {point.seconds:.3g} s")
    own = [point for point in points if point.method == OURS]
    factors = {}
    for method in (HEYOKA, JITCODE):
        found = least_factor(own, [each for each in points if each.method == method], LOW, HIGH)
        factors[method] = None if found is None else found[0]
    return {
        "points": [
            {"method": each.method, "knob": each.knob, "error": each.error, "seconds": each.seconds}
            for each in points
        ],
        "compile_seconds": compiled,
        "least_factor": factors,
        "failures": {**missing, **{each.method: each.reason for each in failures}},
    }  # fmt: skip


def _setting(
    method: str, tolerance: float, solve: Solve, true: FloatArray, *, peer: bool = False
) -> Setting:
    def evaluate() -> Answer:
        return Answer(value=solve(tolerance))

    return Setting(
        method=method, knob=f"tolerance {tolerance:.0e}", evaluate=evaluate, reference=true,
        peer=peer,
    )  # fmt: skip


def million(steps: int = 20) -> dict[str, Any]:
    """Return the seconds a step and the bytes a site of a square lattice of 1000 x 1000."""
    chain = problem("lattice").replace(shape=(1000, 1000), sites=None)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    run = SmoothIntegration(
        chain, excite(chain, [500_500], 3.8), [END], level=1e9, active_window=False
    )
    run.advance(chain.sites)
    begin, done = process_time(), run.counts["steps"]
    run.advance(steps * chain.sites)
    seconds = (process_time() - begin) / (run.counts["steps"] - done)
    size = 1024.0 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
    return {"sites": chain.sites, "seconds_a_step": seconds, "bytes_a_site": size / chain.sites}


def main(names: list[str]) -> None:
    """Measure what is named, or all, and write it beside what was measured before."""
    found = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    for name in names or ["chain", "lattice", "million"]:
        found[name] = million() if name == "million" else measured(name)
        print(json.dumps(found[name].get("least_factor", found[name])))
        found |= {"versions": installed_versions(), "machine": this_machine()}
        RESULT.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
