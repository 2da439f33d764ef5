"""``fronts bench``: measured error versus run time, and growth of cost; needs the source tree."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.options import Folder, refuse_beside

if TYPE_CHECKING:
    from benchmarks.work_precision import WorkPrecision

EXAMPLE = """examples:
  fronts bench --list                     list quantities, test problems and default methods
  fronts bench roots velocity --quick     measure two of them, within half a minute
  fronts bench growth                     time and memory versus sites, digits, 1/v, points
  fronts bench --defaults                 check in the stored records that defaults are fastest
  fronts bench                            measure everything, into benchmarks/results

Run it on an otherwise idle machine. Other programs that are not installed are listed as failures;
'pip install .[bench]' in the source tree installs them."""

GROWTH = "growth"
ROOT = Path(__file__).resolve().parents[2]


def bench(
    *quantity: str,
    quick: bool = False,
    listing: bool = False,
    defaults: bool = False,
    out: Folder | None = None,
) -> Answer:
    """List the quantities, judge the default methods, or measure.

    Parameters
    ----------
    *quantity : str
        Quantities to be measured, or growth; by default all.
    quick : bool, optional
        Use fewer settings, and write nothing unless --out is given.
    listing : bool, optional
        List the quantities without measuring.
    defaults : bool, optional
        Judge the default methods by the stored records.
    out : folder, optional
        Folder of the records (benchmarks/results).
    """
    for limit in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(limit, "1")  # one core for all, before NumPy is imported
    need_source_tree(ROOT)
    from benchmarks.registry import chosen
    from benchmarks.work_precision import RESULTS

    names = [name for name in quantity if name != GROWTH]
    growth = GROWTH in quantity or not quantity
    selected = chosen(names) if names or not quantity else ()
    if out is not None and not out.is_dir():
        raise UsageError(f"--out {out} is not an existing folder: create it first.")
    if listing and defaults:
        raise UsageError("--list and --defaults exclude each other: give one of them.")
    if listing:
        refuse_beside("--list measures nothing", quick=quick)
        refuse_beside("--list reads and writes no record", out=out)
        return _list(selected, growth)
    if defaults:
        refuse_beside("--defaults measures nothing", quick=quick)
        if GROWTH in quantity:
            raise UsageError(
                f"--defaults does not judge any default method of growth: leave out {GROWTH}."
            )
        return _defaults(selected, out or RESULTS)
    folder = out or (None if quick else RESULTS)
    if folder is not None and not os.access(folder, os.W_OK):
        raise UsageError(f"the folder {folder} cannot be written: name another one with --out.")
    return _measure(selected, growth, quick, folder)


def need_source_tree(root: Path) -> None:
    """Make the benchmarks importable.

    Raises
    ------
    UsageError
        If they do not exist, as in an installed wheel.
    """
    if not (root / "benchmarks" / "work_precision.py").is_file():
        raise UsageError(
            "the benchmarks are in the source tree and not in the installed package: run this "
            "command from a checkout, after 'pip install --editable .[bench]' there."
        )
    if str(root) not in sys.path:
        sys.path.insert(0, str(root))


def _list(selected: tuple[WorkPrecision, ...], growth: bool) -> Answer:
    from benchmarks.registry import quantity_of

    rows, lines = [], []
    for benchmark in selected:
        quantity = quantity_of(benchmark)
        problems = [problem.name for problem in quantity.timed_problems]
        rows.append(
            {
                "name": quantity.name,
                "what": quantity.title,
                "problems": problems,
                "scenes": problems,  # its name until version 1.0
                "default": quantity.default,
                "methods": list(benchmark.style.methods),
                "useful": list(quantity.useful or ()),
            }
        )
        lines.append(f"{quantity.name:12} {quantity.title}; by default: {quantity.default}")
        lines.append(f"{'':12} test problems: {'; '.join(problems)}")
    if growth:
        lines.append(f"{GROWTH:12} how time and memory grow, with fitted exponents")
    return Answer({"quantities": rows}, "\n".join(lines))


def _defaults(selected: tuple[WorkPrecision, ...], folder: Path) -> Answer:
    from benchmarks.choice import as_payload, as_text, stored_choices

    rows, missing = stored_choices(selected, folder)
    if not rows:
        raise UsageError(f"there is no record in {folder}: run 'fronts bench --out {folder}'.")
    text = as_text(rows)
    if missing:
        text += "\nno record: " + ", ".join(missing)
    return Answer({"choices": as_payload(rows), "missing": missing}, text)


def _measure(
    selected: tuple[WorkPrecision, ...], growth: bool, quick: bool, folder: Path | None
) -> Answer:
    from benchmarks.choice import stored_choices, write_choices
    from benchmarks.diagram import draw
    from benchmarks.registry import all_benchmarks, measured
    from benchmarks.tables import as_text

    records: dict[str, object] = {}
    texts = []
    for benchmark in selected:
        record = measured(benchmark, quick, _report)
        stored = record.stored()
        records[benchmark.name] = stored.to_dict()
        texts.append(as_text(record))
        if folder is not None:
            stored.save(folder / f"{benchmark.name}.json")
            draw(benchmark.name, record.points, benchmark.style, folder)
    payload: dict[str, object] = {"records": records}
    if growth:
        payload[GROWTH], text = _growth(quick, folder, _report)
        texts.append(text)
    if folder is not None:
        if selected:
            rows, _ = stored_choices(all_benchmarks(), folder)
            write_choices(rows, folder / "defaults.json")
        texts.append(f"Written to {folder}; 'fronts bench --defaults' judges the default methods.")
    return Answer(payload, "\n\n".join(texts))


def _growth(
    quick: bool, folder: Path | None, report: Callable[[str], None]
) -> tuple[dict[str, Any], str]:
    from benchmarks import floor, growth

    rows, floors = growth.measure(quick, report), floor.measure(quick, report)
    payload = growth.as_payload(rows, "fronts bench growth" + " --quick" * quick)
    payload["floors"] = floor.as_rows(floors)
    if folder is not None:
        growth.write_growth(payload, rows, folder)
    return payload, f"{growth.as_text(rows)}\n\n{floor.as_text(floors)}"


def _report(text: str) -> None:
    print(f"{text} ...", file=sys.stderr)
