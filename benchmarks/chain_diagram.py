"""Error against run time of one chain: every method on one diagram."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.piecewise_diagram import worth_choosing
from benchmarks.record import WorkPoint
from paper_checks.pictures import COLOURS, new_axes, picture


@dataclass(frozen=True)
class Style:
    """How a diagram is drawn.

    Attributes
    ----------
    name : str
        Of the files.
    xlabel, ylabel, caption : str
        Texts.
    methods : mapping of str to (str, str)
        Colour and marker of each method.
    garbage : float
        Error beyond which a result is no answer.
    """

    name: str
    xlabel: str
    ylabel: str
    caption: str
    methods: Mapping[str, tuple[str, str]]
    garbage: float


def draw(points: Sequence[WorkPoint], style: Style, folder: Path) -> None:
    """Write the diagram as SVG and PNG."""
    figure, axes = new_axes("page", height=3.6, xlabel=style.xlabel, ylabel=style.ylabel)
    for method, (colour, marker) in style.methods.items():
        here = [point for point in points if point.method == method]
        best, rest = worth_choosing(here)
        for chosen, line, alpha, label in ((best, "-", 1.0, method), (rest, "none", 0.3, None)):
            axes.plot(
                [point.error for point in chosen], [point.seconds for point in chosen],
                color=COLOURS[colour], marker=marker, linestyle=line, alpha=alpha, label=label,
            )  # fmt: skip
    axes.set(xscale="log", yscale="log")
    axes.invert_xaxis()
    axes.axvspan(axes.get_xlim()[0], style.garbage, color="0.9", label="garbage")
    axes.grid(True)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=200, metadata={"Software": None})
    drawn = picture(
        style.name,
        style.caption,
        figure,
        {
            "method": [point.method for point in points],
            "knob": [point.knob for point in points],
            "error": [point.error for point in points],
            "seconds": [point.seconds for point in points],
        },
    )
    (folder / f"{style.name}.png").write_bytes(image.getvalue())
    (folder / f"{style.name}.svg").write_text(drawn.svg, encoding="utf-8")
