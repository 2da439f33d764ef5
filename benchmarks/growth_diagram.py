"""Diagrams of time and memory versus size: a panel per kind of size, a line per kind of work."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmarks.diagram import plain_decades, whole_decades, write_picture
from verification.pictures.data_table import long_table
from verification.pictures.figures import COLOURS, new_panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MARKS = (("o", "blue"), ("s", "vermilion"), ("^", "green"), ("D", "purple"), ("v", "orange"))

Line = Mapping[str, Any]
"""A row of the record: name, sizes, seconds, megabytes (None or nan where not measured), ..."""


def draw_growth(lines: Sequence[Line], folder: Path) -> None:
    """Write ``growth.svg`` and ``growth.csv``; the expected slope of time is drawn as well.

    Parameters
    ----------
    lines : sequence of mapping
        Rows as in ``growth.json``.
    folder : Path
        Folder of the two files.
    """
    panels = [
        (kind, quantity, chosen)
        for quantity in ("seconds", "megabytes")
        for kind in dict.fromkeys(line["size_name"] for line in lines)
        if (
            chosen := [x for x in lines if x["size_name"] == kind and any(map(_known, x[quantity]))]
        )
    ]
    heights = [1.9 + 0.26 * len(chosen) for *_, chosen in panels]
    figure, all_axes = new_panels(1, len(panels), width="column", height=0.3 + sum(heights))
    for axes, (kind, quantity, chosen) in zip(all_axes, panels, strict=True):
        _panel(axes, chosen, quantity)
        axes.set(xlabel=kind, ylabel=quantity)
    write_picture(
        "growth",
        "Run time and memory as the work grows, with fitted exponents and those expected.",
        figure,
        long_table(
            {
                line["name"]: {
                    "grows_with": line["size_name"],
                    "size": line["sizes"],
                    "seconds": line["seconds"],
                    "megabytes": [each if _known(each) else None for each in line["megabytes"]],
                }
                for line in lines
            }
        ),
        folder,
    )


def _panel(axes: Axes, lines: Sequence[Line], quantity: str) -> None:
    """Draw each row, with its fitted exponent in the legend and its expected time dashed."""
    axes.set(xscale="log", yscale="log")
    for line, (mark, colour) in zip(lines, MARKS, strict=False):
        known = [row for row in zip(line["sizes"], line[quantity], strict=True) if _known(row[1])]
        sizes, costs = zip(*known, strict=True)
        timed = quantity == "seconds"
        fitted, expected = line["exponent" if timed else "memory_exponent"], line["expected"]
        label = line["name"] + (f"\n  power {fitted:z.2f}" if _known(fitted) else "")
        if timed and expected is not None:
            label += f", expected {expected:g}"
            last, cost = sizes[-1], costs[-1]
            axes.plot(
                sizes, [cost * (size / last) ** expected for size in sizes], "--", lw=0.8,
                color=COLOURS[colour], alpha=0.7,
            )  # fmt: skip
        axes.plot(sizes, costs, marker=mark, color=COLOURS[colour], label=label)
    axes.set_ylim(*whole_decades([x for line in lines for x in line[quantity] if _known(x)]))
    plain_decades(axes)
    ticks = sorted({size for line in lines for size in line["sizes"]})
    axes.set_xlim(ticks[0] / 1.4, ticks[-1] * 1.4)
    if ticks[-1] < 100.0 * ticks[0]:
        axes.set_xticks(ticks, [f"{size:g}" for size in ticks])
        axes.minorticks_off()
    if quantity == "seconds":
        axes.plot([], [], "k--", lw=0.8, label="dashed: as expected, through the last point")
    axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), borderpad=0.0)


def _known(value: float | None) -> bool:
    return value is not None and math.isfinite(value)
