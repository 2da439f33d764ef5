"""``fronts simulate friction``: a run of Model I; samples, arrivals, a picture."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fronts.answer import Answer, UsageError
from fronts.arguments import given
from fronts.friction_options import CELL, cell_of, start_point_of
from fronts.interrupted import resumable_run
from verification.execution.files import write_by
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from verification.runs.trajectory import Trajectory


def simulate_friction(options: argparse.Namespace) -> Answer:
    """Run the friction chain as the options say.

    Raises
    ------
    UsageError, ParameterError
        If they cannot be carried out.
    """
    from theory.chains.chain import Ends
    from theory.chains.friction import FrictionChain
    from theory.parameters import within
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    if options.ends == "periodic":
        raise UsageError("--ends periodic is for the model vdp: take free or literal.")
    if None not in (options.start_point, options.displacement):
        raise UsageError(
            f"--start-point {options.start_point} and --displacement {options.displacement:g} both "
            "say where excited sites start: give one of them.",
            quantity="--start-point",
            value=options.start_point,
            allowed="absent beside --displacement",
            remedy="give one of them",
        )
    within("size of the noise", options.perturb, 0.0, 1.0)
    chain = FrictionChain.of(
        cell_of(options), c=options.c, sites=options.n, ends=Ends(options.ends)
    )
    start = excite(chain, options.excite, options.displacement, point=start_point_of(options))
    if options.perturb > 0:
        noise = np.random.default_rng(options.seed).standard_normal(start.shape)
        start = start + options.perturb * noise
    with (
        resumable_run(options.checkpoint),
        Progress(f"run to tau = {options.t_end:g}") as shown,
    ):
        result = simulate(
            chain,
            start,
            options.t_end,
            tolerance=given(options.tolerance, 1e-10),
            samples=options.samples,
            checkpoint=options.checkpoint,
            progress=shown.report,
        )
    if options.out is not None:
        write_by(options.out, lambda path: _save(path, result))
    if options.picture is not None:
        write_by(options.picture, lambda path: _draw(path, result))
    return Answer(_payload(result), _in_words(result))


def _payload(run: Trajectory) -> dict[str, object]:
    arrival_error = run.arrival_error
    return {
        "model": "friction",
        "t_end": float(run.times[-1]),
        "amplitudes": run.amplitude[-1].tolist(),
        "width": int(np.count_nonzero(~np.isnan(run.arrivals))),
        "arrivals": [None if np.isnan(t) else float(t) for t in run.arrivals],
        "sticks": run.counts["sticks"],
        "releases": run.counts["releases"],
        "reversals": run.counts["reversals"],
        "status": run.status.value,
        "resolved_until": run.resolved_until,
        "error": run.error,
        "arrival_error": arrival_error if np.isfinite(arrival_error or 0.0) else None,
        "steps": run.steps,
        "mean_active": run.mean_active,
        "seconds": run.seconds,
    }


def _in_words(run: Trajectory) -> str:
    last = run.amplitude[-1]
    reached = int(np.count_nonzero(~np.isnan(run.arrivals)))
    loudest = int(np.argmax(last))
    return "\n".join(
        [
            f"tau = {run.times[-1]:g}: {reached} of {run.chain.sites} sites have stuck at some "
            f"time, {np.count_nonzero(run.stuck)} stick now",
            f"  largest amplitude {last[loudest]:.8g} at site {loudest + 1}",
            f"  error of the states at most {run.error:.1e} (from two less exact runs beside it: "
            f"{run.status.value})",
            *_resolution(run),
            "  {sticks} sticks, {releases} releases, {reversals} reversals".format(**run.counts),
            f"  {run.steps} steps of {run.mean_active:.1f} sites, {run.seconds:.3f} s",
        ]
    )


def _resolution(run: Trajectory) -> list[str]:
    return [f"  {run.status.sentence}"] if run.status.value != "resolved" else []


def _save(path: Path, run: Trajectory) -> None:
    chain = run.chain
    parameters = {
        "model": "friction",
        **{name: getattr(chain.cell, name) for name in CELL},
        "c": chain.c,
        "sites": chain.sites,
        "ends": chain.ends.value,
        "tolerance": run.tolerance,
        "error": run.error,
    }
    np.savez_compressed(
        path,
        times=run.times,
        y=run.y,
        velocity=run.velocity,
        envelope=run.amplitude,
        arrivals=run.arrivals,
        parameters=json.dumps(parameters),
    )


def _draw(path: Path, run: Trajectory) -> None:
    from fronts.space_time import draw_space_time

    quantity = "half of maximum - minimum of y"
    draw_space_time(path, run.times, run.amplitude, run.arrivals, "sticks", "time τ", quantity)
