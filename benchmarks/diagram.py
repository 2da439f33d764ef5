"""Error against run time, a panel a scene, a line a method."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.record import WorkPoint, write_whole
from paper_checks.pictures import COLOURS, new_panels, picture

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_FLOOR = 1e-17
_COLUMNS = 2


@dataclass(frozen=True)
class Style:
    """How a diagram is drawn.

    Attributes
    ----------
    xlabel, ylabel, caption : str
        Texts.
    methods : mapping of str to (str, str)
        Colour and marker of each method.
    garbage : float
        Error beyond which a result is no answer.
    floor : float
        Errors below are drawn there.
    """

    xlabel: str
    ylabel: str
    caption: str
    methods: Mapping[str, tuple[str, str]]
    garbage: float
    floor: float = _FLOOR


def draw(name: str, points: Sequence[WorkPoint], style: Style, folder: Path) -> None:
    """Write ``<name>.svg`` and ``.png``."""
    scenes = list(dict.fromkeys(point.scene for point in points))
    columns = min(_COLUMNS, max(1, len(scenes)))
    rows = max(1, -(-len(scenes) // columns))
    figure, panels = new_panels(columns, rows, height=1.0 + 2.7 * rows)
    for axes, scene in zip(panels, scenes, strict=False):
        _panel(axes, [point for point in points if point.scene == scene], style)
        axes.set_title(scene)
        axes.set_xlabel(style.xlabel)
    for axes in panels[::columns]:
        axes.set_ylabel(style.ylabel)
    for axes in panels[len(scenes) :]:
        axes.set_visible(False)
    handles: dict[str, Artist] = {}
    for axes in panels:
        lines, labels = axes.get_legend_handles_labels()
        handles |= dict(zip(labels, lines, strict=True))
    if handles:
        figure.legend(
            handles=list(handles.values()),
            labels=list(handles),
            loc="outside lower center",
            ncols=columns + 1,
        )
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=200, metadata={"Software": None})
    drawn = picture(
        name,
        style.caption,
        figure,
        {
            "scene": [point.scene for point in points],
            "method": [point.method for point in points],
            "knob": [point.knob for point in points],
            "error": [point.error for point in points],
            "seconds": [point.seconds for point in points],
        },
    )
    write_whole(folder / f"{name}.png", image.getvalue())
    write_whole(folder / f"{name}.svg", drawn.svg.encode())


def _panel(axes: Axes, points: Sequence[WorkPoint], style: Style) -> None:
    """Draw each method: a line through the settings worth choosing, the others pale."""
    axes.set(xscale="log", yscale="log")
    for method, (colour, marker) in style.methods.items():
        best, rest = worth_choosing([point for point in points if point.method == method])
        for some, line, alpha, label in ((best, "-", 1.0, method), (rest, "none", 0.3, None)):
            if some:
                axes.plot(
                    [max(point.error, style.floor) for point in some],
                    [point.seconds for point in some],
                    color=COLOURS[colour], marker=marker, linestyle=line, alpha=alpha, label=label,
                )  # fmt: skip
    axes.invert_xaxis()
    if any(point.error > style.garbage for point in points):
        limits = axes.get_xlim()
        axes.axvspan(limits[0], style.garbage, color="0.9", label="garbage")
        axes.set_xlim(limits)
    axes.grid(True)


def worth_choosing(points: Sequence[WorkPoint]) -> tuple[list[WorkPoint], list[WorkPoint]]:
    """Return the points that no other beats in both time and error, by error, and the rest."""
    best: list[WorkPoint] = []
    rest: list[WorkPoint] = []
    for point in sorted(points, key=lambda p: (p.seconds, p.error)):
        keep = not best or point.error < best[-1].error
        (best if keep else rest).append(point)
    return best, rest
