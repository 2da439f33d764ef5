"""``fronts stress``: comparison of every quantity with another method over all decades."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.files import check_files, write_result
from fronts.interrupted import resumable_tables
from fronts.options import refuse_beside
from theory.parameters import count_within
from theory.result import json_value
from verification.execution.metadata import Code, Metadata
from verification.execution.progress import Progress
from verification.execution.record import Record

if TYPE_CHECKING:
    from verification.quantities.quantity import Computation
    from verification.quantities.robustness import Robustness

EXAMPLE = """examples:
  fronts stress --quantity c-pin --quantity eta-pin --points 40
  fronts stress --points 2000 --seed 1 --out stress.csv
  fronts stress --work-reduction --record
  fronts stress --list

Every quantity is evaluated at test problems, at the corners of its parameter range and at random
points; one point in twenty has a value that is not allowed. The points are distributed according to
the shares shown by --list, with at least twelve for each quantity: quantities with an expensive
reference have smaller shares.

Exit code 1: a stated error was exceeded, or a point gave NaN, crashed or was too slow."""

_MAX_SHOWN = 20
RESUMABLE = (".csv", ".npz", ".zarr")
"""Endings of tables with every point, from which an interrupted run can be resumed."""
ROBUSTNESS_CODE = ("verification.quantities.robustness", "verification.quantities.registry")
REDUCTION_CODE = ("verification.work_reduction.table",)


def stress(  # noqa: PLR0913  (options of a command, by name)
    *,
    quantity: Sequence[str] = (),
    points: int | None = None,
    seed: int | None = None,
    out: Path | None = None,
    workers: int | None = None,
    resume: bool = False,
    listing: bool = False,
    record: bool = False,
    work_reduction: bool = False,
    quiet: bool,
) -> Answer:
    """Evaluate the points, list the quantities, or measure the work reductions.

    Parameters
    ----------
    quantity : sequence of str, optional
        Test this quantity only; may be repeated.
    points : int, optional
        Total number of points (default 1000).
    seed : int, optional
        Seed of the random points (default 0).
    out : Path, optional
        File for all points, ending in .csv, .npz or .zarr, or for the counts, ending in .json.
    workers : int, optional
        Number of processes (default: one per core).
    resume : bool, optional
        Continue from OUT.part, which an interrupted run has left.
    listing : bool, optional
        List the quantities without evaluating anything.
    record : bool, optional
        Store the result for the report (in the source tree).
    work_reduction : bool, optional
        Show what is truncated or not computed, and the gain.
    quiet : bool, optional
        Outside a terminal, print no line for each quantity.
    """
    if record:
        from fronts.commands.bench import ROOT, need_source_tree

        need_source_tree(ROOT)
    of_points = {
        "out": out, "resume": resume, "quantity": quantity, "workers": workers, "points": points,
        "seed": seed,
    }  # fmt: skip
    if work_reduction:
        refuse_beside("--work-reduction tries no points", **of_points, listing=listing)
        return _work_reduction(record)
    if listing:
        refuse_beside("--list tries no points", **of_points, record=record)
        return _list()
    if record and quantity:
        refuse_beside("--record keeps the table of all quantities", quantity=quantity[0])
    points, seed = 1000 if points is None else points, seed or 0
    table = _checked_table(out, resume, workers)
    from verification.quantities.robustness import robustness

    with resumable_tables(table), Progress("stress", quiet=quiet) as live:
        found = robustness(
            tuple(dict.fromkeys(quantity)),  # without duplicates
            points,
            seed,
            out=table,
            resume=resume,
            workers=workers,
            progress=live.report,
        )
    if out is not None and table is None:
        parameters = {"quantities": [*quantity], "points": points, "seed": seed}
        write_result(out, found, parameters)
    payload = _payload(found, seed)
    if record:
        line = f"fronts stress --points {points} --seed {seed}"
        _store("stability", payload, line, ROBUSTNESS_CODE)
    where = {"out": None if out is None else str(out)}
    return Answer(payload | where, _text(found), exit_code=1 if found.bad else 0)


def _checked_table(out: Path | None, resume: bool, workers: int | None) -> Path | None:
    """Check the options before any work; return the file for the points, if it is resumable."""
    if out is not None:
        check_files([(out, "--out")], filmed=False, formats=(*RESUMABLE, ".json"))
    table = out if out is not None and out.suffix.lower() in RESUMABLE else None
    if resume and table is None:
        raise UsageError("--resume needs --out, the file of the interrupted run.")
    if workers is not None:
        count_within("workers", workers, 1, 1024)
    return table


def _payload(found: Robustness, seed: int) -> dict[str, object]:
    from verification.quantities.registry import computation_named

    return {
        "points": len(found.table),
        "seed": seed,
        "counts": found.counts,
        "quantities": [
            vars(line) | _range_of(computation_named(line.quantity)) for line in found.lines
        ],
        "bad": json_value(found.bad),
        "seconds": found.table.seconds,
    }


def _store(name: str, payload: dict[str, object], command: str, modules: tuple[str, ...]) -> None:
    """Store a result where the report finds it, with a digest of the code that was measured."""
    from fronts.commands.bench import ROOT

    metadata = Metadata(command=command, code=Code.of(modules))
    path = ROOT / "benchmarks" / "results" / f"{name}.json"
    Record(kind=name, content=payload, metadata=metadata).save(path)


def _text(found: Robustness) -> str:
    heads = tuple(found.counts)
    lines = [
        f"{'quantity':26}{'points':>7}"
        + "".join(f"{head:>10}" for head in heads)
        + f"{'tightest':>10}{'slowest':>10}"
    ]
    for line in found.lines:
        counts = "".join(f"{line.counts[head]:10}" for head in heads)
        lines.append(
            f"{line.quantity:26}{line.points:7}{counts}{line.tightest:10.2g}{line.slowest:8.3f} s"
        )
    counts = "".join(f"{found.counts[head]:10}" for head in heads)
    lines.append(f"{'all':26}{len(found.table):7}{counts}")
    for row in found.bad[:_MAX_SHOWN]:
        lines.append(
            f"{row['outcome']}: {row['quantity']} at {row['values']}: {row['said']}"
            f" (stated {row['stated']:.2g}, distance {row['distance']:.2g}, {row['by']})"
        )
    if len(found.bad) > _MAX_SHOWN:
        lines.append(f"and {len(found.bad) - _MAX_SHOWN} more; --json or --out has them all.")
    return "\n".join(lines)


def _range_of(quantity: Computation) -> dict[str, Any]:
    axes = ", ".join(f"{axis.name} {axis.low:g} to {axis.high:g}" for axis in quantity.axes)
    return {
        "what": quantity.title, "over": axes, "ends": quantity.limits, "share": quantity.share,
    }  # fmt: skip


def _list() -> Answer:
    from verification.quantities.registry import all_computations

    rows = [
        {
            "quantity": quantity.name,
            "what": quantity.title,
            "axes": [{"name": a.name, "low": a.low, "high": a.high} for a in quantity.axes],
            "ends": quantity.limits,
            "seconds": quantity.seconds,
            "share": quantity.share,
        }
        for quantity in all_computations()
    ]
    lines = []
    for quantity in all_computations():
        domain = _range_of(quantity)
        share = f"share {quantity.share:g}"
        lines.append(f"{quantity.name:26}{domain['what']}\n{'':26}{domain['over']}; {share}")
        if quantity.limits:
            lines.append(f"{'':26}({domain['ends']})")
    return Answer({"quantities": rows}, "\n".join(lines))


def _work_reduction(record: bool) -> Answer:
    from verification.work_reduction.table import REDUCTIONS

    rows = [reduction.measured() for reduction in REDUCTIONS]
    lines = []
    for row in rows:
        lines.append(f"{row['what']}: {row['decided']}")
        lines += [f"    {name}: {row[name]}" for name in ("bound", "measured", "changed", "test")]
    payload: dict[str, object] = {"work_reduction": rows}
    if record:
        _store("work_reduction", payload, "fronts stress --work-reduction", REDUCTION_CODE)
    exceeded = not all(row["holds"] for row in rows)
    return Answer(payload, "\n".join(lines), exit_code=1 if exceeded else 0)
