"""``fronts cell MODEL``: what one oscillator alone can do (Fig. 2; Eqs. 2-8)."""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import check_writable, given, real, real_or_range, refuse
from fronts.friction_options import CELL, add_cell_options, cell_numbers
from verification.execution.files import write_by

if TYPE_CHECKING:
    from theory.cells.friction import FrictionCell
    from verification.cells.friction_continuation import Continuation
    from verification.cells.friction_cycles import Cycle
    from verification.cells.vdp import VdpCycle

EXAMPLE = """examples:
  fronts cell friction --v-d 1.25
  fronts cell friction --v-d 1.25 --xi 0 --json
  fronts cell friction --v-d 0.9:2:200 --out cell.png
  fronts cell vdp --a 2.5 --b 0.5"""

MOST_POINTS = 2000
_COLUMNS = (
    "v_d", "sliding", "stable_min", "stable_max", "stick_time", "unstable_min", "unstable_max",
)  # fmt: skip
_FRICTION_ONLY = (*CELL, "out")
_VDP_ONLY = ("a", "b", "eps")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts cell``."""
    parser.add_argument("model", choices=sorted(MODELS), help="Model I or Model II")
    parser.add_argument(
        "--v-d", type=real_or_range, help="belt velocity, or low:high:count for a diagram"
    )
    add_cell_options(parser, v_d=False)
    parser.add_argument("--a", type=real, help="damping coefficient a of (8) (2.5)")
    parser.add_argument("--b", type=real, help="damping coefficient b of (8) (0.5)")
    parser.add_argument("--eps", type=real, help="small parameter of (8) (0.01)")
    parser.add_argument(
        "--out", type=Path, help="write the diagram to a file ending in .csv, .png, .svg or .pdf"
    )
    parser.epilog = f"""{EXAMPLE}

In JSON null stands for what does not exist or is infinite; "status" says which. "basin" is the
range of y that goes to steady sliding when started with zero velocity: null if none does,
[null, null] if all do."""


def run(options: argparse.Namespace) -> Answer:
    """Run the model that was named."""
    other = _VDP_ONLY if options.model == "friction" else _FRICTION_ONLY
    refuse(options, other, options.model)
    return MODELS[options.model](options)


def _friction(options: argparse.Namespace) -> Answer:
    if options.v_d is None:
        raise UsageError("give the belt velocity: --v-d 1.25, or a range as in --v-d 1:2:200.")
    ranged = isinstance(options.v_d, tuple)
    if options.out is not None:
        check_writable(options.out, (".csv", ".png", ".svg", ".pdf"))
        if not ranged:
            raise UsageError("--out needs a diagram: give a range, as in --v-d 1:2:200.")
    from theory.cells.friction import FrictionCell

    given = cell_numbers(options)
    if ranged:
        low, high, count = options.v_d
        if count > MOST_POINTS:
            raise UsageError(f"{count} velocities are too many: at most {MOST_POINTS}.")
        # Both ends are checked before any work.
        cells = [FrictionCell(v_d=each, **given) for each in (low, high)]
        return _diagram(cells[0], low, high, count, options.out)
    from verification.cells.friction_orbits import cell_orbits

    orbits = cell_orbits(FrictionCell(v_d=options.v_d, **given))
    cell = orbits.cell
    basin = orbits.basin
    payload: dict[str, object] = {
        "status": orbits.status.value,
        "steady_sliding": cell.steady_sliding,
        "effective_damping": cell.effective_damping,
        "hopf_velocity": _finite(cell.hopf_velocity),
        "cycle_end_velocity": _finite(orbits.cycle_end_velocity),
        "stable_cycle": _cycle(orbits.stable),
        "unstable_cycle": _cycle(orbits.unstable),
        "basin": None if basin is None else [_finite(each) for each in basin],
        "error": _finite(orbits.error),
        "seconds": orbits.seconds,
    }
    return Answer(payload, _in_words(payload))


def _cycle(cycle: Cycle | None) -> dict[str, float] | None:
    if cycle is None:
        return None
    names = ("max", "min", "amplitude", "period", "stick_time")
    return {name: getattr(cycle, name) for name in names}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _in_words(found: dict[str, Any]) -> str:
    def velocity(value: float | None) -> str:
        return "never" if value is None else f"at v_d = {value:.12g}"

    end = found["cycle_end_velocity"]
    lines = [
        f"{found['status']}.",
        f"  steady sliding at y = {found['steady_sliding']:.12g}, effective damping "
        f"{found['effective_damping']:.6g}; stable {_above(found['hopf_velocity'])}",
        "  no stick-slip cycle at any v_d" if end == 0.0 else f"  cycles end {velocity(end)}",
    ]
    for name in ("stable", "unstable"):
        cycle = found[f"{name}_cycle"]
        if cycle is not None:
            lines.append(
                f"  {name} cycle: y from {cycle['min']:.12g} to {cycle['max']:.12g}, amplitude "
                f"{cycle['amplitude']:.9g}, period {cycle['period']:.9g}"
                + (f", of that stick {cycle['stick_time']:.9g}" if cycle["stick_time"] else "")
            )
    basin = found["basin"]
    if basin is None:
        lines.append("  no start at rest ends in steady sliding")
    elif basin[0] is None:
        lines.append("  every start ends in steady sliding")
    else:
        lines.append(
            f"  starts with zero velocity and y from {basin[0]:.12g} to {basin[1]:.12g} end in it"
        )
    error = found["error"]
    lines.append(
        f"  error {'not known' if error is None else f'{error:.1e}'}, {found['seconds']:.3g} s"
    )
    return "\n".join(lines)


def _above(hopf: float | None) -> str:
    if hopf is None:
        return "at no v_d"
    return "at every v_d" if hopf == 0.0 else f"above v_d = {hopf:.12g}"


def _diagram(cell: FrictionCell, low: float, high: float, count: int, out: Path | None) -> Answer:
    from time import perf_counter

    import numpy as np

    from verification.cells.friction_continuation import continue_cycles

    begin = perf_counter()
    diagram = continue_cycles(cell, np.linspace(low, high, count).tolist())
    seconds = perf_counter() - begin
    rows = _rows(diagram)
    payload = {
        "hopf_velocity": _finite(cell.hopf_velocity),
        "cycle_end_velocity": _finite(diagram.end),
        **{
            name: [_finite(row[i]) for row in rows] for i, name in enumerate(_COLUMNS)
        },
        "seconds": seconds,
    }  # fmt: skip
    if out is None:
        lines = ["  ".join(f"{name:>12}" for name in _COLUMNS)]
        lines += ["  ".join(_number(value) for value in row) for row in rows]
        return Answer(payload, "\n".join(lines))
    if out.suffix.lower() == ".csv":
        write_by(out, lambda path: _write_table(path, rows))
    else:
        write_by(out, lambda path: _draw(path, cell, diagram))
    return Answer(payload, f"{count} velocities in {seconds:.3g} s, written to {out}")


def _number(value: float) -> str:
    return f"{'-' if math.isnan(value) else f'{value:.7g}':>12}"


def _rows(diagram: Continuation) -> list[list[float]]:
    columns = (
        diagram.v_d, diagram.sliding, diagram.stable[:, 0], diagram.stable[:, 1],
        diagram.stick_time, diagram.unstable[:, 0], diagram.unstable[:, 1],
    )  # fmt: skip
    return [[float(value) for value in row] for row in zip(*columns, strict=True)]


def _write_table(path: Path, rows: list[list[float]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_COLUMNS)
        writer.writerows(
            ["" if math.isnan(value) else repr(value) for value in row] for row in rows
        )


def _draw(path: Path, cell: FrictionCell, diagram: Continuation) -> None:
    from paper_checks.cell_picture import draw_bifurcation
    from paper_checks.pictures import new_axes, save

    figure, axes = new_axes("page", height=3.2)
    draw_bifurcation(axes, cell, diagram)
    save(path, figure)


def _vdp(options: argparse.Namespace) -> Answer:
    options.a, options.b = given(options.a, 2.5), given(options.b, 0.5)
    from verification.cells.vdp import vdp_cell

    eps = 0.01 if options.eps is None else options.eps
    cell = vdp_cell(options.a, options.b, eps)
    stable, unstable = cell.stable, cell.unstable
    errors = [each.error for each in (stable, unstable) if each is not None]
    payload: dict[str, object] = {
        "status": "rest only" if stable is None else "bistable",
        "eta": cell.eta,
        "steady_sliding": 0.0,
        "effective_damping": eps,
        "hopf_velocity": None,
        "cycle_end_velocity": None,
        "stable_cycle": _vdp_cycle(stable),
        "unstable_cycle": _vdp_cycle(unstable),
        "basin": [None, None] if unstable is None else [-unstable.amplitude, unstable.amplitude],
        "error": max(errors, default=0.0),
        "seconds": cell.seconds,
    }
    lines = [f"{payload['status']}: eta = b/a^2 = {cell.eta:.12g}; two cycles exist below 1/8."]
    for name, cycle in (("stable", stable), ("unstable", unstable)):
        if cycle is not None:
            lines.append(
                f"  {name} cycle: amplitude {cycle.amplitude:.12g}, period {cycle.period:.12g}; "
                f"amplitude as eps -> 0: {cycle.averaged:.12g}"
            )
    lines.append(f"  rest is stable; error {payload['error']:.1e}, {cell.seconds:.3g} s")
    return Answer(payload, "\n".join(lines))


def _vdp_cycle(cycle: VdpCycle | None) -> dict[str, float] | None:
    if cycle is None:
        return None
    return {
        "max": cycle.amplitude,
        "min": -cycle.amplitude,
        "amplitude": cycle.amplitude,
        "period": cycle.period,
        "stick_time": 0.0,
        "averaged": cycle.averaged,
    }


MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {"friction": _friction, "vdp": _vdp}
"""Cell and the function that answers for it."""
