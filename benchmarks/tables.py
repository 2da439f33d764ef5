"""A record as plain text: points by test problem, failures by name, targets with verdicts."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.record import BenchmarkRecord


def as_text(run: BenchmarkRecord) -> str:
    """Return the whole record as tables."""
    return "\n".join(
        [*_head(run), *_points(run), *_first_calls(run), *_failures(run), *_targets(run)]
    )


def _head(run: BenchmarkRecord) -> Iterator[str]:
    about = run.metadata
    yield f"{about.command}    {about.date}"
    yield ", ".join(f"{name} {value}" for name, value in about.machine.items())
    yield ", ".join(f"{name} {value or 'not installed'}" for name, value in about.versions.items())


def _points(run: BenchmarkRecord) -> Iterator[str]:
    wide = max((len(point.method) for point in run.points), default=0)
    for problem in dict.fromkeys(point.problem for point in run.points):
        yield ""
        yield f"{problem}: references without common code differ by {run.agreement[problem]:.0e}"
        yield f"  {'method':{wide}} {'setting':30} {'error':>8} {'claimed':>8} {'first s':>8}" + (
            f" {'median s':>9} {'of':>4}"
        )
        for point in (each for each in run.points if each.problem == problem):
            claimed = "-" if point.claimed is None else f"{point.claimed:.1e}"
            # The reference itself is known only to within the agreement.
            beyond = point.claimed is not None and (
                point.error > point.claimed + run.agreement[problem]
            )
            mark = "  ERROR LARGER THAN CLAIMED" if beyond else ""
            warned = f"  warned: {point.warning[:50]}" if point.warning else ""
            yield (
                f"  {point.method:{wide}} {point.knob:30} {point.error:8.1e} {claimed:>8} "
                f"{point.first_seconds:8.1e} {point.seconds:9.2e} {point.repeats:4d}{mark}{warned}"
            )


def _first_calls(run: BenchmarkRecord) -> Iterator[str]:
    if not run.first_calls:
        return
    yield ""
    yield "first call in a fresh process, wall-clock seconds"
    yield f"  {'method':32} {'cold':>9} {'loaded':>9} {'again':>9}"
    for each in run.first_calls:
        times = (each.cold, each.loaded, each.again)
        shown = " ".join("        -" if time is None else f"{time:9.2g}" for time in times)
        yield f"  {each.method:32} {shown}" + (f"  {each.reason}" if each.reason else "")


def _failures(run: BenchmarkRecord) -> Iterator[str]:
    yield ""
    yield "failures" if run.failures else "failures: none"
    for each in run.failures:
        yield f"  {each.problem}, {each.method}, {each.knob}: {each.reason}"


def _targets(run: BenchmarkRecord) -> Iterator[str]:
    if not run.targets:
        return
    yield ""
    yield "promised speeds, and other timings"
    for each in run.targets:
        measured = "-" if each.measured is None else f"{each.measured:.3g}"
        required = "" if each.limit is None else f"{each.relation} {each.limit:g}, "
        yield f"  {each.verdict:12} {each.claim}: {measured} {each.unit} ({required}{each.detail})"
