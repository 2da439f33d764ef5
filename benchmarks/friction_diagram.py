"""Error against run time of the friction chain: three families of methods on one diagram."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

from benchmarks.friction import ADAPTIVE, EXACT, FIXED, GARBAGE
from benchmarks.piecewise_diagram import worth_choosing
from benchmarks.record import WorkPoint
from paper_checks.pictures import COLOURS, new_axes, picture

_STYLES = {
    EXACT: ("blue", "o"),
    FIXED: ("green", "^"),
    ADAPTIVE: ("sky", "v"),
    "scipy LSODA": ("vermilion", "s"),
    "scipy Radau": ("orange", "D"),
    "scipy BDF": ("purple", "X"),
}


def draw(points: Sequence[WorkPoint], folder: Path) -> None:
    """Write ``friction.svg`` and ``friction.png``."""
    figure, axes = new_axes(
        "page",
        height=3.6,
        xlabel="largest error of y (right is better)",
        ylabel="processor seconds a run",
    )
    for method, (colour, marker) in _STYLES.items():
        here = [point for point in points if point.method == method]
        best, rest = worth_choosing(here)
        for chosen, line, alpha, label in ((best, "-", 1.0, method), (rest, "none", 0.3, None)):
            axes.plot(
                [point.error for point in chosen], [point.seconds for point in chosen],
                color=COLOURS[colour], marker=marker, linestyle=line, alpha=alpha, label=label,
            )  # fmt: skip
    axes.set(xscale="log", yscale="log")
    axes.invert_xaxis()
    axes.axvspan(axes.get_xlim()[0], GARBAGE, color="0.9", label="garbage")
    axes.grid(True)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=200, metadata={"Software": None})
    drawn = picture(
        "friction",
        "Error against run time, friction chain, N = 31, τ = 200. Pale: settings that another one "
        "of the same method beats. Grey: errors of the order of the motion itself.",
        figure,
        {
            "method": [point.method for point in points],
            "knob": [point.knob for point in points],
            "error": [point.error for point in points],
            "seconds": [point.seconds for point in points],
        },
    )
    (folder / "friction.png").write_bytes(image.getvalue())
    (folder / "friction.svg").write_text(drawn.svg, encoding="utf-8")
