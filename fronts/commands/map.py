"""``fronts map MODEL``: the state of a chain over a plane of parameters, one function a model."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter

import numpy as np

from fronts.answer import Answer, UsageError
from fronts.arguments import (
    MOST_POINTS,
    check_writable,
    given,
    real,
    real_or_range,
    refuse,
    whole,
)
from fronts.friction_options import (
    CELL,
    START,
    add_cell_options,
    add_start_option,
    cell_numbers,
    start_point_of,
)
from fronts.state_plane import Plane, boundary_path, map_plane, swept

EXAMPLE = """examples:
  fronts map vdp --eta 0.01:0.14:7 --c 0.05:1:7 --model envelope
  fronts map vdp --eta 0.01:0.14:14 --c 0.05:1:20 --model envelope --out map.csv --picture map.png
  fronts map vdp --eta 0.01:0.14:14 --c 0.05:1:20 --model full --refine 0 --out map.csv --resume

The paper does not say which of a and b is the same for all eta: b = 0.5 is held, unless --a or
another --b is given.

  fronts map friction --c 0:0.1:11 --v-d 1:2:11
  fronts map friction --c 0:0.1:21 --v-d 1:2:21 --out map.csv --picture map.png
  fronts map friction --c 0:0.1:21 --v-d 1:2:21 --nucleus 9 --out wide.csv --resume

OUT.json has parameters and versions; OUT-boundary.csv has the boundaries."""

_VDP = ("eta", "model", "a", "b", "eps", "displacement")
_FRICTION = (*CELL, *START, "nucleus", "place", "ends")

_PAPER = {
    "vdp": {"eta": (0.01, 0.14, 14), "c": (0.05, 1.0, 20)},
    "friction": {"v_d": (1.0, 2.0, 21), "c": (0.0, 0.1, 21)},
}
"""The planes of Figs. 15 and 5."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts map``."""
    parser.add_argument("chain", choices=sorted(MODELS), help="the chain to run")
    parser.add_argument(
        "--eta", type=real_or_range, help="vdp: b/a^2, or low:high:count (default 0.01:0.14:14)"
    )
    parser.add_argument(
        "--v-d",
        type=real_or_range,
        help="friction: velocity of the belt, or low:high:count (1:2:21)",
    )
    parser.add_argument(
        "--c",
        type=real_or_range,
        help="coupling, or low:high:count (vdp: 0.05:1:20, friction: 0:0.1:21)",
    )
    parser.add_argument(
        "--model", choices=("full", "envelope"), help="vdp: Eq. 8 (full), or its average 43"
    )
    held = parser.add_mutually_exclusive_group()
    held.add_argument("--a", type=real, help="vdp: hold a at this value; b = eta a^2")
    held.add_argument("--b", type=real, help="vdp: hold b at this value (default 0.5)")
    parser.add_argument("--n", type=whole, help="number of oscillators (vdp: 16, friction: 31)")
    parser.add_argument("--eps", type=real, help="vdp: small parameter (default 0.01)")
    parser.add_argument("--displacement", type=real, help="vdp: of the last site (default 6)")
    add_cell_options(parser, v_d=False)
    add_start_option(parser)
    parser.add_argument(
        "--nucleus", type=whole, metavar="SIZE", help="friction: excited sites (default 1)"
    )
    parser.add_argument(
        "--place", choices=("bulk", "edge"), help="friction: middle (default) or end of the chain"
    )
    parser.add_argument(
        "--ends",
        choices=("free", "literal"),
        help="friction: free ends (default), or Eq. 5 with the missing neighbours zero",
    )
    parser.add_argument(
        "--t-end",
        "--end",
        dest="end",
        type=real,
        help="end time; a label found after half of it does not count (vdp: 2000 in slow time "
        "eps t; friction: 20000 in tau)",
    )
    parser.add_argument(
        "--refine",
        type=real,
        default=0.0625,
        help="bisect boundaries to this part of the grid's spacing; 0 leaves them (default 1/16)",
    )
    parser.add_argument("--out", type=Path, help="write the map to a .csv file")
    parser.add_argument("--picture", type=Path, help="draw the map")
    parser.add_argument(
        "--workers", type=whole, help="processes (default: 1 for the envelope, else one a core)"
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on from OUT.part, which a killed run has left"
    )


def run(options: argparse.Namespace) -> Answer:
    """Run the model that was named."""
    return MODELS[options.chain](options)


def _values(given: float | tuple[float, float, int]) -> list[float]:
    if not isinstance(given, tuple):
        return [given]
    low, high, count = given
    # Rounded, so that 0.01:0.14:14 has 0.03 and not 0.030000000000000002.
    return [float(f"{value:.15g}") for value in np.linspace(low, high, count)]


def _check(options: argparse.Namespace) -> None:
    from theory.parameters import count_within, within
    from verification.execution.sweep import part_path

    if options.out is not None:
        check_writable(options.out, (".csv",))
        # Before the map overwrites what an interrupted run has finished.
        part = part_path(boundary_path(options.out))
        if part.exists() and not options.resume:
            raise UsageError(f"{part} is left by an interrupted run: --resume it, or remove it.")
    if options.picture is not None:
        check_writable(options.picture, (".png", ".svg", ".pdf"), "--picture")
    if options.resume and options.out is None:
        raise UsageError("--resume needs --out: what an earlier run has left is beside it.")
    within("part of the spacing, --refine,", options.refine, 0.0, 1.0)
    if options.workers is not None:
        count_within("workers", options.workers, 1, 1024)


def _axes(options: argparse.Namespace, first: str, second: str) -> tuple[list[float], list[float]]:
    """Return the values on both axes, as many as may be."""
    both = []
    for name in (first, second):
        chosen = getattr(options, name)
        both.append(_values(_PAPER[options.chain][name] if chosen is None else chosen))
    if len(both[0]) * len(both[1]) > MOST_POINTS:
        raise UsageError(f"{len(both[0]) * len(both[1])} points are more than {MOST_POINTS}.")
    return both[0], both[1]


def _vdp(options: argparse.Namespace) -> Answer:
    from verification.maps.vdp import StateTask, compare, state_points
    from verification.runs.model import Model

    refuse(options, _FRICTION, options.chain)
    _check(options)
    etas, couplings = _axes(options, "eta", "c")
    points = state_points(etas, couplings)
    task = StateTask(
        Model(options.model or "full"),
        held="b" if options.a is None else "a",
        value=given(options.b, 0.5) if options.a is None else options.a,
        sites=given(options.n, 16),
        eps=given(options.eps, 0.01),
        displacement=given(options.displacement, 6.0),
        end=given(options.end, 2000.0),
    )
    for eta in etas:
        task.chain(eta, couplings[0])
    envelope = task.model is Model.ENVELOPE
    workers = 1 if envelope and options.workers is None else options.workers
    titles = ("η = b/a²", "coupling c")
    plane = Plane(
        task.model.value, ("eta", "c"), titles, points, task, task.alone(), workers
    )  # fmt: skip
    begin = perf_counter()
    payload, states = map_plane(plane, options)
    payload["held"] = {task.held: task.value}
    if not envelope:
        other = swept("envelope", task.averaged(), points, None, False, None)
        agreement = compare(states, other)
        payload["agreement"] = {
            "with": "envelope",
            "same": agreement.same,
            "total": agreement.total,
            "contradicting": agreement.contradicting,
            "differing": list(agreement.differing),
        }
    payload["seconds"] = perf_counter() - begin
    return Answer(payload, _in_words(payload, plane.axes))


def _friction(options: argparse.Namespace) -> Answer:
    from theory.cells.friction import FrictionCell
    from theory.chains.chain import Ends
    from theory.chains.nucleus import Place
    from verification.maps.friction import FrictionStateTask, friction_points

    refuse(options, _VDP, options.chain)
    _check(options)
    couplings, velocities = _axes(options, "c", "v_d")
    points = friction_points(couplings, velocities)
    cell = FrictionCell(v_d=velocities[0], **cell_numbers(options))
    task = FrictionStateTask(
        sites=given(options.n, 31),
        size=given(options.nucleus, 1),
        place=Place(options.place or "bulk"),
        point=start_point_of(options),
        ends=Ends(options.ends or "free"),
        end=given(options.end, 20_000.0),
        mu_st=cell.mu_st,
        mu_d=cell.mu_d,
        v0=cell.v0,
        xi=cell.xi,
    )
    titles = ("coupling c", "velocity of the belt $v_d$")
    plane = Plane(
        "friction", ("c", "v_d"), titles, points, task, task.alone(), options.workers
    )  # fmt: skip
    payload, _ = map_plane(plane, options)
    return Answer(payload, _in_words(payload, plane.axes))


def _in_words(payload: Mapping[str, object], axes: tuple[str, str]) -> str:
    counts, undecided, agreement = payload["counts"], payload["undecided"], payload["agreement"]
    assert isinstance(counts, dict)
    assert isinstance(undecided, list)
    lines = [f"{payload['points']} points, {payload['model']}:"]
    lines += [f"  {label:<12} {number}" for label, number in counts.items()]
    if isinstance(agreement, dict):
        lines.append(
            f"  the envelope gives the same label at {agreement['same']} of {agreement['total']}"
        )
        lines += [
            f"    eta = {row['eta']:g}, c = {row['c']:g}: {row['first']}, envelope {row['second']}"
            for row in agreement["differing"][:10]
        ]
    if undecided:
        places = ", ".join(f"({row[axes[0]]:g}, {row[axes[1]]:g})" for row in undecided[:10])
        more = f" and {len(undecided) - 10} more" if len(undecided) > 10 else ""
        lines.append(f"  undecided at ({axes[0]}, {axes[1]}) = {places}{more}")
    lines.append(f"  {payload['map_seconds']:.2f} s, with everything {payload['seconds']:.2f} s")
    return "\n".join(lines)


MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {"friction": _friction, "vdp": _vdp}
"""Chain and the function that maps it."""
