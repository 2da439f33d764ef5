"""Diagrams of error versus run time, a panel per test problem, a line per method, with CSV data."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.record import WorkPoint
from verification.execution.files import write_bytes
from verification.pictures.figures import COLOURS, new_panels, picture

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from benchmarks.work_precision import Style
    from verification.pictures.data_table import Column

_PALE = 0.35
_SHORT = 24
"""Largest length, in characters, of labels of which two fit side by side."""
_STRIP = 0.02
"""Half the width of the strip for errors too small to plot, as a fraction of the axis."""


def draw(name: str, points: Sequence[WorkPoint], style: Style, folder: Path) -> None:
    """Write ``<name>.svg`` and ``<name>.csv``."""
    problems = list(dict.fromkeys(point.problem for point in points))
    two = max(map(len, style.methods)) <= _SHORT
    lines = (len(style.methods) + 3) // (2 if two else 1)
    height = 2.4 * max(1, len(problems)) + 0.16 * lines
    figure, panels = new_panels(1, max(1, len(problems)), width="column", height=height)
    for axes, problem in zip(panels, problems, strict=False):
        _panel(axes, [point for point in points if point.problem == problem], style)
        axes.set(title=problem, ylabel=style.ylabel)
    panels[-1].set_xlabel(style.xlabel)
    handles: dict[str, Artist] = {}
    for axes in panels:
        drawn, labels = axes.get_legend_handles_labels()
        handles = dict(zip(labels, drawn, strict=True)) | handles
    if handles:
        order = sorted(handles, key=lambda label: label not in style.methods)
        figure.legend(
            handles=[handles[label] for label in order],
            labels=order,
            loc="outside lower center",
            ncols=2 if max(map(len, order)) <= _SHORT else 1,
            columnspacing=1.0,
        )
    write_picture(
        name,
        style.caption,
        figure,
        {
            "problem": [point.problem for point in points],
            "method": [point.method for point in points],
            "setting": [point.knob for point in points],
            "error": [point.error for point in points],
            "claimed_error": [point.claimed for point in points],
            "seconds": [point.seconds for point in points],
            "first_call_seconds": [point.first_seconds for point in points],
            "repeats": [point.repeats for point in points],
        },
        folder,
    )


def write_picture(
    name: str, caption: str, figure: Figure, data: Mapping[str, Column], folder: Path
) -> None:
    """Write a figure as ``<name>.svg``, and its data as ``<name>.csv``."""
    drawn = picture(name, figure, data, caption=caption, guides=True, encoded=False)
    write_bytes(folder / f"{name}.svg", drawn.svg.encode())
    write_bytes(folder / f"{name}.csv", drawn.data.encode())


def _panel(axes: Axes, points: Sequence[WorkPoint], style: Style) -> None:
    """Draw a line through the settings of each method that are worth choosing, the others pale."""
    axes.set(xscale="log", yscale="log")
    pale = False
    for number, (method, (colour, marker)) in enumerate(style.methods.items()):
        best, rest = worth_choosing([point for point in points if point.method == method])
        for some, line, alpha, label in ((best, "-", 1.0, method), (rest, "none", _PALE, None)):
            if some:
                axes.plot(
                    [max(point.error, style.floor) for point in some],
                    [point.seconds for point in some],
                    color=COLOURS[colour], marker=marker, linestyle=line, alpha=alpha, label=label,
                    ms=5.5 if number == 0 else 3.5,  # the first stays visible below another
                )  # fmt: skip
        pale = pale or bool(rest)
    if pale:
        axes.plot([], [], "o", color="0.3", alpha=_PALE, label="pale: another setting is better")
    errors = [max(point.error, style.floor) for point in points]
    axes.set_xlim(*reversed(whole_decades(errors)))
    axes.set_ylim(*whole_decades([point.seconds for point in points]))
    worst, least = axes.get_xlim()
    if any(point.error < style.floor for point in points):
        half = (worst / least) ** _STRIP
        none = all(point.error == 0.0 for point in points if point.error < style.floor)
        axes.axvspan(
            style.floor * half, style.floor / half, color=COLOURS["yellow"], alpha=0.4, lw=0,
            label="no error seen" if none else f"error below {style.floor:g}",
        )  # fmt: skip
    if any(point.error > style.garbage for point in points):
        wrong = f"wrong: error above {style.garbage:g}"
        axes.axvspan(worst, style.garbage, color="0.9", label=wrong)
        axes.set_xlim(worst, least)
    plain_decades(axes)


def whole_decades(values: Sequence[float]) -> tuple[float, float]:
    """Return powers of ten that enclose positive values with a margin, at least one decade apart.

    Examples
    --------
    >>> whole_decades([4.0e-8, 4.1e-8])
    (1e-08, 1e-07)
    >>> whole_decades([1.0, 30.0])
    (0.1, 100.0)
    """
    logs = [math.log10(value) for value in values if value > 0.0]
    if not logs:
        return 0.1, 10.0
    room = 0.1 + 0.03 * (max(logs) - min(logs))
    low, high = math.floor(min(logs) - room), math.ceil(max(logs) + room)
    return 10.0**low, 10.0**high


def plain_decades(axes: Axes) -> None:
    """Label a few powers of ten on both axes, without minor labels."""
    from matplotlib.ticker import LogLocator, NullFormatter

    for axis, most in ((axes.xaxis, 7), (axes.yaxis, 6)):
        axis.set_major_locator(LogLocator(numticks=most))
        axis.set_minor_formatter(NullFormatter())
    axes.grid(True)


def worth_choosing(points: Sequence[WorkPoint]) -> tuple[list[WorkPoint], list[WorkPoint]]:
    """Return the points that no other point beats in both time and error, by error; the rest."""
    best: list[WorkPoint] = []
    rest: list[WorkPoint] = []
    for point in sorted(points, key=lambda p: (p.seconds, p.error)):
        keep = not best or point.error < best[-1].error
        (best if keep else rest).append(point)
    return best, rest
