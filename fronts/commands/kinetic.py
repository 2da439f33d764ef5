"""``fronts kinetic``: every front velocity at given coupling and η, or along a curve (Eq. 54)."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import add_eta_options, check_writable, eta_of, real_or_range
from verification.execution.files import write_by
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from theory.piecewise.kinetic_relation import Branch, KineticRelation

EXAMPLE = """examples:
  fronts kinetic --c 0.5 --eta 0.03125
  fronts kinetic --c 0.45 --a 4 --b 0.5 --json
  fronts kinetic --c 0.3:3:200 --eta 0.03125 --out curve.png
  fronts kinetic --c 0.3 --eta 0.001:0.12:200 --out curve.csv"""

_COLUMNS = ("c", "eta", "status", "v", "error", "slope", "by_c", "by_eta", "admissible", "fails_at")


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts kinetic``."""
    parser.add_argument(
        "--c", type=real_or_range, required=True, help="coupling c > 0, or low:high:count"
    )
    add_eta_options(parser, real_or_range)
    parser.add_argument(
        "--out", type=Path, help="write the curve to a file ending in .csv, .png, .svg or .pdf"
    )


def run(options: argparse.Namespace) -> Answer:
    """Solve the kinetic relation at a point or along a curve."""
    if options.out is not None:
        check_writable(options.out, (".csv", ".png", ".svg", ".pdf"))
    import numpy as np

    from theory.piecewise.kinetic_relation import trace_kinetic_relation

    eta = eta_of(options)
    ranges = [isinstance(value, tuple) for value in (options.c, eta)]
    if all(ranges):
        raise UsageError("give a range for --c or for --eta, not for both.")
    if options.out is not None and not any(ranges):
        raise UsageError("--out needs a curve: give a range, as in --c 0.3:3:200.")
    c_values = np.linspace(*options.c) if ranges[0] else np.array([options.c])
    eta_values = np.linspace(*eta) if ranges[1] else np.array([eta])
    with Progress("kinetic relation") as live:
        answers = trace_kinetic_relation(c_values, eta_values, progress=live.report)
    if not any(ranges):
        return Answer(_payload(answers[0]), _in_words(answers[0]))
    along = "c" if ranges[0] else "eta"
    if options.out is not None:
        if options.out.suffix.lower() == ".csv":
            write_by(options.out, lambda path: _write_table(path, answers))
        else:
            write_by(options.out, lambda path: _draw(path, answers, along))
    seconds = sum(answer.seconds for answer in answers)
    payload = {"points": [_payload(answer) for answer in answers], "seconds": seconds}
    return Answer(payload, _curve_in_words(answers, along, options.out, seconds))


def _payload(answer: KineticRelation) -> dict[str, object]:
    return {
        "c": answer.c,
        "eta": answer.eta,
        "status": answer.status.value,
        "reason": answer.reason,
        "branches": [_branch(branch) for branch in answer.branches],
        "c_pin": answer.c_pin,
        "c_fold": answer.c_fold,
        "c_retreat": answer.c_retreat,
        "c_pin_error": answer.c_pin_error,
        "c_fold_error": answer.c_fold_error,
        "c_retreat_error": answer.c_retreat_error,
        "method": answer.method,
        "terms": answer.terms,
        "seconds": answer.seconds,
    }


def _branch(branch: Branch) -> dict[str, object]:
    import math

    def finite(value: float) -> float | None:
        return value if math.isfinite(value) else None

    return {
        "v": branch.v,
        "error": branch.error,
        "admissible": branch.admissible,
        "slope": branch.slope,
        "by_c": finite(branch.by_coupling),
        "by_eta": finite(branch.by_eta),
        "fails_at": branch.fails_at,
    }


def _in_words(answer: KineticRelation) -> str:
    lines = [f"{answer.status.value}: {answer.reason}"]
    if answer.branches:
        lines.append("  v                    error    slope  dv/dc       dv/deta     admissible")
    lines += [
        f"  {branch.v:<19.15g}  {branch.error:.1e}  {branch.slope:+5d}  {branch.by_coupling:<10.5g}"
        f"  {branch.by_eta:<10.5g}  {_verdict(branch)}"
        for branch in answer.branches
    ]
    thresholds = (
        ("c_fold", answer.c_fold, answer.c_fold_error),
        ("c_pin", answer.c_pin, answer.c_pin_error),
        ("c_retreat", answer.c_retreat, answer.c_retreat_error),
    )
    known = [
        f"{name} = {_digits_that_hold(value, error)}"
        for name, value, error in thresholds
        if value is not None and error is not None
    ]
    if known:
        lines.append("  " + ", ".join(known))
    lines.append(f"  {answer.terms} values of Sigma, {answer.seconds:.3g} s")
    return "\n".join(lines)


def _digits_that_hold(value: float, error: float) -> str:
    """Write at most twelve digits, and none that the error may change by more than one.

    Examples
    --------
    >>> _digits_that_hold(1151998399.931, 0.016), _digits_that_hold(0.25, 1e-17)
    ('1151998399.9', '0.25')
    """
    digits = 1
    while digits < 12 and error * 10.0**digits < value:
        digits += 1
    return f"{value:.{digits}g}"


def _verdict(branch: Branch) -> str:
    if branch.admissible is None:
        return "not decided"
    return "yes" if branch.admissible else f"no, fails at zeta = {branch.fails_at:.3g}"


def _curve_in_words(
    answers: list[KineticRelation], along: str, out: Path | None, seconds: float
) -> str:
    if out is not None:
        branches = sum(len(answer.branches) for answer in answers)
        return f"{len(answers)} points, {branches} branches in {seconds:.3g} s, written to {out}"
    lines = [f"{along:<12}  status         velocities (admissible ones marked *)"]
    for answer in answers:
        marks = "  ".join(
            f"{branch.v:.10g}{'*' if branch.admissible else ''}" for branch in answer.branches
        )
        lines.append(f"{getattr(answer, along):<12.7g}  {answer.status.value:<13}  {marks}")
    return "\n".join(lines)


def _rows(answers: list[KineticRelation]) -> Iterator[tuple[object, ...]]:
    """Yield one row a branch, and one with empty cells where there is none."""
    for answer in answers:
        here = (repr(answer.c), repr(answer.eta), answer.status.value)
        if not answer.branches:
            yield (*here, *[""] * (len(_COLUMNS) - len(here)))
        for branch in answer.branches:
            yield (
                *here,
                repr(branch.v),
                repr(branch.error),
                branch.slope,
                repr(branch.by_coupling),
                repr(branch.by_eta),
                "" if branch.admissible is None else str(branch.admissible).lower(),
                "" if branch.fails_at is None else repr(branch.fails_at),
            )


def _write_table(path: Path, answers: list[KineticRelation]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_COLUMNS)
        writer.writerows(_rows(answers))


def _draw(path: Path, answers: list[KineticRelation], along: str) -> None:
    from paper_checks.pictures import COLOURS, new_axes, save

    label = "coupling c" if along == "c" else "η = b/a²"
    figure, axes = new_axes("page", height=3.2, xlabel=label, ylabel="front velocity v")
    kinds: dict[str, tuple[list[float], list[float]]] = {}
    for answer in answers:
        for branch in answer.branches:
            kind = {True: "admissible", False: "not admissible", None: "not decided"}[
                branch.admissible
            ]
            xs, ys = kinds.setdefault(kind, ([], []))
            xs.append(getattr(answer, along))
            ys.append(branch.v)
    style: dict[str, dict[str, Any]] = {
        "admissible": {"color": COLOURS["blue"]},
        "not admissible": {"color": COLOURS["vermilion"], "mfc": "none"},
        "not decided": {"color": "0.6"},
    }
    for kind, (xs, ys) in kinds.items():
        axes.plot(xs, ys, "o", ms=2.2, label=kind, **style[kind])
    if along == "c":
        _mark_thresholds(axes, answers[0])
    if kinds:
        axes.legend()
    save(path, figure)


def _mark_thresholds(axes: Any, answer: KineticRelation) -> None:
    low, high = axes.get_xlim()
    for name, value in (
        ("$c_\\mathrm{fold}$", answer.c_fold),
        ("$c_\\mathrm{pin}$", answer.c_pin),
        ("$c_\\mathrm{retreat}$", answer.c_retreat),
    ):
        if value is not None and low < value < high:
            line = "--" if "fold" in name else "-"
            axes.axvline(value, color="0.5", lw=0.8, ls=line, label=f"{name} = {value:.4g}")
    axes.set_xlim(low, high)
