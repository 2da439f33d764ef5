"""``fronts simulate MODEL``: run a chain from a given start; samples, arrivals, a picture."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fronts.answer import Answer, UsageError
from fronts.arguments import (
    BadText,
    check_seed,
    check_writable,
    given,
    real,
    refuse,
    same_file,
    whole,
)
from fronts.friction_options import CELL, START, add_cell_options, add_start_option
from fronts.interrupted import resumable_run
from verification.execution.files import write_by
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from verification.runs.trajectory import Trajectory

EXAMPLE = """examples:
  fronts simulate vdp --n 31 --a 2.5 --b 0.5 --c 0.1 --excite 15 --t-end 2000
  fronts simulate vdp --n 31 --a 2.5 --b 0.5 --c 0.25 --excite 15 --t-end 20000 \\
      --out run.npz --picture run.png
  fronts simulate vdp --n 60 --a 4 --b 0.5 --c 0.6 --excite 1:3 --model envelope --t-end 9000
  fronts simulate friction --n 31 --c 0.02 --excite 1 --t-end 1000 --picture run.png"""

_VDP = ("a", "b", "eps", "model")
_MOST_EXCITED = 1_000_000


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts simulate``."""
    parser.add_argument("chain", choices=sorted(MODELS), help="the chain to run")
    parser.add_argument("--n", type=whole, default=31, help="number of oscillators (default 31)")
    parser.add_argument("--a", type=real, help="vdp: damping coefficient a (2.5)")
    parser.add_argument("--b", type=real, help="vdp: damping coefficient b (0.5)")
    parser.add_argument("--c", type=real, help="coupling c (vdp: 0.1, friction: 0.02)")
    parser.add_argument("--eps", type=real, help="vdp: small parameter (default 0.01)")
    add_cell_options(parser)
    parser.add_argument(
        "--ends",
        choices=("free", "periodic", "literal"),
        default="free",
        help="free; vdp: or periodic; friction: or literal, Eq. 5 with the missing neighbours zero",
    )
    parser.add_argument(
        "--model", choices=("full", "envelope"), help="vdp: Eq. 8 (full), or its average 43"
    )
    parser.add_argument(
        "--excite",
        type=sites,
        help="sites displaced: 15, or 14,15,16, or 14:16 (vdp: the middle, friction: 1)",
    )
    parser.add_argument(
        "--displacement", type=real, help="how far (default: the stable cycle of one cell)"
    )
    add_start_option(parser)
    parser.add_argument(
        "--perturbation",
        "--perturb",
        dest="perturb",
        type=real,
        help="size of noise on every site (0)",
    )
    parser.add_argument("--seed", type=whole, help="seed of the noise (default 1)")
    parser.add_argument(
        "--t-end", type=real, help="end time t; slow time is eps t (vdp: 2000, friction: 1000)"
    )
    parser.add_argument("--tolerance", type=real, help="local error (vdp: 1e-9, friction: 1e-10)")
    parser.add_argument("--samples", type=whole, default=201, help="states kept (default 201)")
    parser.add_argument("--out", type=Path, help="write times, states, arrivals to a .npz file")
    parser.add_argument("--picture", type=Path, help="draw the envelope in space and time")
    parser.add_argument(
        "--checkpoint",
        type=Path,
        help="keep the run in this .npz file; if it exists, go on from it",
    )


def run(options: argparse.Namespace) -> Answer:
    """Run the model that was named."""
    middle = (max(options.n, 1) + 1) // 2
    scene = {"c": 0.1, "t_end": 2000.0, "excite": (middle,)}
    if options.chain == "friction":
        scene = {"c": 0.02, "t_end": 1000.0, "excite": (1,)}
    for name, value in scene.items():
        if getattr(options, name) is None:
            setattr(options, name, value)
    return MODELS[options.chain](options)


def sites(text: str) -> tuple[int, ...]:
    """Read ``15``, ``14,15,16`` or ``14:16`` (both ends included).

    Examples
    --------
    >>> sites("15"), sites("14:16"), sites("3,5")
    ((15,), (14, 15, 16), (3, 5))
    """
    try:
        if ":" in text:
            first, last = (int(part) for part in text.split(":"))
            if last - first < _MOST_EXCITED:
                return tuple(range(first, last + 1))
        else:
            return tuple(int(part) for part in text.split(","))
    except ValueError:
        pass
    raise BadText(
        text,
        f"a site, a list as in 14,15,16 or a range of at most {_MOST_EXCITED} as in 14:16",
        "give one of these",
    )


def _check(options: argparse.Namespace) -> None:
    for path, kinds, option in (
        (options.out, (".npz",), "--out"),
        (options.picture, (".png", ".svg", ".pdf"), "--picture"),
        (options.checkpoint, (".npz",), "--checkpoint"),
    ):
        if path is not None:
            check_writable(path, kinds, option)
    if None not in (options.out, options.checkpoint) and same_file(options.out, options.checkpoint):
        raise UsageError(f"--out and --checkpoint are both {options.out}: name two files.")
    if options.seed is not None and options.perturb is None:
        raise UsageError(
            f"--seed {options.seed} is of the noise, and there is none: give --perturbation too.",
            quantity="--seed",
            value=options.seed,
            allowed="absent without --perturbation",
            remedy="give --perturbation too",
        )
    check_seed(options.seed)
    options.seed, options.perturb = given(options.seed, 1), given(options.perturb, 0.0)


def _vdp(options: argparse.Namespace) -> Answer:
    refuse(options, (*CELL, *START), options.chain)
    _check(options)
    if options.ends == "literal":
        raise UsageError("--ends literal is for the model friction: take free or periodic.")
    from theory.chains.chain import Ends
    from theory.chains.vdp import VdpChain
    from theory.parameters import within
    from verification.runs.excite import add_noise, excite
    from verification.runs.model import Model
    from verification.runs.simulate import simulate

    a, b, eps = given(options.a, 2.5), given(options.b, 0.5), given(options.eps, 0.01)
    chain = VdpChain(a=a, b=b, c=options.c, eps=eps, sites=options.n, ends=Ends(options.ends))
    within("size of the noise", options.perturb, 0.0, 1.0)
    start = excite(chain, options.excite, options.displacement)
    if options.perturb > 0:
        start = add_noise(start, options.perturb, options.seed)
    level = None if chain.bistable else max(1e-3, 0.5 * float(np.hypot(*start).max()))
    with resumable_run(options.checkpoint), Progress(f"run to t = {options.t_end:g}") as shown:
        result = simulate(
            Model(options.model or "full").chain_of(chain),
            start,
            options.t_end,
            tolerance=given(options.tolerance, 1e-9),
            samples=options.samples,
            level=level,
            checkpoint=options.checkpoint,
            progress=shown.report,
        )
    if options.out is not None:
        write_by(options.out, lambda path: _save(path, result))
    if options.picture is not None:
        write_by(options.picture, lambda path: _draw(path, result))
    payload, words = _payload(result), _in_words(result)
    if chain.bistable and chain.ends is Ends.FREE:
        from verification.breathers.outcome import growth_of

        grown = growth_of(result)
        payload["nucleus"] = {
            "end": grown.end.value,
            "size": grown.size,
            "sizes": [list(station) for station in grown.sizes],
            "longest_pause": grown.longest_pause,
        }
        stations = [f"{size} from {joined:.4g}" for joined, size in grown.sizes]
        listed = stations if len(stations) < 9 else [*stations[:6], "…", *stations[-2:]]
        words += (
            f"\n  nucleus: {grown.end.value}; sites that had joined by slow time: "
            + ", ".join(listed)
        )
    return Answer(payload, words)


def _payload(run: Trajectory) -> dict[str, object]:
    arrivals = [None if np.isnan(t) else float(t) for t in run.arrivals]
    return {
        "model": "full" if run.chain.model == "vdp" else "envelope",
        "status": run.status.value,
        "resolved_until": run.resolved_until,
        "t_end": float(run.times[-1]),
        "amplitudes": run.amplitude[-1].tolist(),
        "width": int(run.width[-1]),
        "arrivals": arrivals,
        "level": run.level,
        "error": run.error,
        "arrival_error": run.arrival_error if np.isfinite(run.arrival_error or 0.0) else None,
        "steps": run.steps,
        "stiff_steps": run.counts["stiff_steps"],
        "mean_active": run.mean_active,
        "seconds": run.seconds,
    }


def _in_words(run: Trajectory) -> str:
    last = run.amplitude[-1]
    reached = int(np.count_nonzero(~np.isnan(run.arrivals)))
    loudest = int(np.argmax(last))
    stiff = run.counts["stiff_steps"]
    resolved = run.status.value == "resolved"
    doubt = (
        []
        if resolved
        else [f"  {run.status.value} after t = {run.resolved_until:g}: {run.status.sentence}"]
    )
    return "\n".join(
        [
            *doubt,
            f"t = {run.times[-1]:g}: {run.width[-1]} of {run.chain.sites} sites above "
            f"{run.level:.4g} (at the start {run.width[0]}), {reached} were at some time",
            f"  largest amplitude {last[loudest]:.8g} at site {loudest + 1}",
            f"  error of the states at most {run.error:.1e} (from two less exact runs beside it)",
            f"  {run.steps} steps of {run.mean_active:.1f} sites, {stiff} stiff steps, "
            f"{run.seconds:.3f} s",
        ]
    )


def _save(path: Path, run: Trajectory) -> None:
    chain = run.chain
    parameters = {
        "model": "full" if run.chain.model == "vdp" else "envelope",
        "a": chain.a,
        "b": chain.b,
        "c": chain.c,
        "eps": chain.eps,
        "sites": chain.sites,
        "ends": chain.ends.value,
        "tolerance": run.tolerance,
        "error": run.error,
    }
    np.savez_compressed(
        path,
        times=run.times,
        psi=run.psi,
        arrivals=run.arrivals,
        level=run.level,
        parameters=json.dumps(parameters),
    )


def _draw(path: Path, run: Trajectory) -> None:
    from fronts.space_time import draw_space_time

    mark = f"reaches {run.level:.3g}"
    draw_space_time(path, run.times, run.amplitude, run.arrivals, mark)


def _friction(options: argparse.Namespace) -> Answer:
    refuse(options, _VDP, options.chain)
    _check(options)
    from fronts.friction_simulation import simulate_friction

    return simulate_friction(options)


MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {"friction": _friction, "vdp": _vdp}
"""Chain and the function that runs it."""
