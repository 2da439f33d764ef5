"""``fronts stress``: every quantity over all decades of its parameters, held against another."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import check_seed, check_writable, given, whole
from fronts.interrupted import resumable_tables
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from verification.quantities.quantity import Computation
    from verification.quantities.robustness import Stability

EXAMPLE = """examples:
  fronts stress --quantity c-pin --quantity eta-pin --points 40
  fronts stress --points 2000 --seed 1 --out stress.csv
  fronts stress --work-reduction --record
  fronts stress --list

Every quantity is tried at test problems, at the corners of its parameters and at random, one point
in twenty with a value that is not allowed. Exit code 1: a stated error was exceeded, or a point
gave NaN, crashed or was too slow."""

_MOST_SHOWN = 20
STABILITY_CODE = ("verification.quantities.robustness", "verification.quantities.registry")
REDUCTION_CODE = ("verification.work_reduction.table",)


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts stress``."""
    parser.add_argument("--quantity", action="append", help="only this one; may be repeated")
    parser.add_argument("--points", type=whole, help="in all (default 1000)")
    parser.add_argument("--seed", type=whole, help="of the points at random (default 0)")
    parser.add_argument("-o", "--out", type=Path, help="write every point to a .csv file")
    parser.add_argument("--workers", "--jobs", type=whole, help="processes (default: one a core)")
    parser.add_argument(
        "--resume", action="store_true", help="go on from OUT.part, which a killed run has left"
    )
    parser.add_argument("--list", action="store_true", help="list the quantities, try nothing")
    parser.add_argument(
        "--record", action="store_true", help="keep the result for the report (in the source tree)"
    )
    parser.add_argument(
        "--work-reduction",
        action="store_true",
        help="what is truncated or not computed, and the gain",
    )


def run(options: argparse.Namespace) -> Answer:
    """Try the points, list the quantities, or measure the work reductions."""
    if options.record:
        from fronts.commands.bench import ROOT, need_source_tree

        need_source_tree(ROOT)
    if options.work_reduction or options.list:
        _alone("--work-reduction" if options.work_reduction else "--list", options)
        return _work_reduction(options.record) if options.work_reduction else _list()
    if options.record and options.quantity:
        raise UsageError(
            "--record keeps the table of all quantities: leave out --quantity.",
            quantity="--quantity",
            value=options.quantity[0],
            allowed="absent beside --record",
            remedy="leave it out",
        )
    check_seed(options.seed)
    points, seed = given(options.points, 1000), given(options.seed, 0)
    from theory.parameters import count_within
    from verification.quantities.registry import computation_named
    from verification.quantities.robustness import stability

    if options.out is not None:
        check_writable(options.out, (".csv",))
    if options.resume and options.out is None:
        raise UsageError("--resume needs --out: what an earlier run has left is beside it.")
    if options.workers is not None:
        count_within("workers", options.workers, 1, 1024)
    with resumable_tables(options.out), Progress("stress", quiet=options.json) as live:
        found = stability(
            tuple(dict.fromkeys(options.quantity or ())),  # named twice is tried once
            points,
            seed,
            out=options.out,
            resume=options.resume,
            workers=options.workers,
            progress=live.report,
        )
    payload: dict[str, object] = {
        "points": len(found.table),
        "seed": seed,
        "counts": found.counts,
        "quantities": [
            vars(line) | _range_of(computation_named(line.quantity)) for line in found.lines
        ],
        "bad": [{k: _finite(v) for k, v in row.items()} for row in found.bad],
        "seconds": found.table.seconds,
        "out": None if options.out is None else str(options.out),
    }
    if options.record:
        stored = {name: value for name, value in payload.items() if name != "out"}
        _store(
            "stability", stored, f"fronts stress --points {points} --seed {seed}", STABILITY_CODE
        )
    return Answer(payload, _text(found), exit_code=1 if found.bad else 0)


def _alone(question: str, options: argparse.Namespace) -> None:
    """Refuse beside a question that tries no point what has no meaning for it."""
    others = ["out", "resume", "quantity", "workers", "points", "seed", "resume", "list"]
    if question == "--list":
        others[-1] = "record"
    for name in others:
        value = getattr(options, name)
        if value not in (None, False):
            raise UsageError(
                f"{question} tries no points: leave out --{name}.",
                quantity=f"--{name}",
                value=value,
                allowed=f"absent beside {question}",
                remedy="leave it out",
            )


def _store(name: str, payload: dict[str, object], command: str, modules: tuple[str, ...]) -> None:
    """Store a result where the report finds it, with a digest of the code that it is of."""
    from fronts.commands.bench import ROOT
    from verification.execution.metadata import Code, Metadata
    from verification.execution.record import Record

    metadata = Metadata(command=command, code=Code.of(modules))
    path = ROOT / "benchmarks" / "results" / f"{name}.json"
    Record(kind=name, content=payload, metadata=metadata).save(path)


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not abs(value) < float("inf"):
        return None
    return value


def _text(found: Stability) -> str:
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
    for row in found.bad[:_MOST_SHOWN]:
        lines.append(
            f"{row['outcome']}: {row['quantity']} at {row['values']}: {row['said']}"
            f" (stated {row['stated']:.2g}, distance {row['distance']:.2g}, {row['by']})"
        )
    if len(found.bad) > _MOST_SHOWN:
        lines.append(f"and {len(found.bad) - _MOST_SHOWN} more; --json or --out has them all.")
    return "\n".join(lines)


def _range_of(quantity: Computation) -> dict[str, str]:
    axes = ", ".join(f"{axis.name} {axis.low:g} to {axis.high:g}" for axis in quantity.axes)
    return {"what": quantity.title, "over": axes, "ends": quantity.limits}


def _list() -> Answer:
    from verification.quantities.registry import all_computations

    rows = [
        {
            "quantity": quantity.name,
            "what": quantity.title,
            "axes": [{"name": a.name, "low": a.low, "high": a.high} for a in quantity.axes],
            "ends": quantity.limits,
            "seconds": quantity.seconds,
        }
        for quantity in all_computations()
    ]
    lines = []
    for quantity in all_computations():
        said = _range_of(quantity)
        lines.append(f"{quantity.name:26}{said['what']}\n{'':26}{said['over']}")
        if quantity.limits:
            lines.append(f"{'':26}({said['ends']})")
    return Answer({"quantities": rows}, "\n".join(lines))


def _work_reduction(record: bool) -> Answer:
    from verification.work_reduction.table import measured_reductions

    rows = measured_reductions()
    lines = []
    for row in rows:
        lines.append(f"{row.reduction.what}: {row.reduction.decided}")
        lines.append(f"    bound: {row.reduction.bound}")
        lines.append(f"    measured: {row.text}")
        lines.append(f"    changed: {row.changed}")
        lines.append(f"    test: {row.reduction.test}")
    payload: dict[str, object] = {"work_reduction": [row.as_dict() for row in rows]}
    if record:
        _store("work_reduction", payload, "fronts stress --work-reduction", REDUCTION_CODE)
    exceeded = not all(row.found.holds for row in rows)
    return Answer(payload, "\n".join(lines), exit_code=1 if exceeded else 0)
