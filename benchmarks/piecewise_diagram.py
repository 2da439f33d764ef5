"""Work–precision diagrams of Σ: error across, median seconds up, a line a method."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmarks.record import WorkPoint
from paper_checks.pictures import COLOURS, new_panels, picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D
    from numpy.typing import ArrayLike

_FLOOR = 1e-17  # where an error is below, a double cannot show it
_DOUBLE = {
    "integral, in a batch": ("blue", "o", "-"),
    "integral, one call": ("sky", "o", "-"),
    "root series": ("vermilion", "s", "-"),
    "root series, cut off": ("vermilion", "s", ":"),
    "Bessel series": ("green", "^", "-"),
    "quadrature in pieces": ("purple", "D", "-"),
    "scipy.integrate.quad": ("orange", "v", "-"),
    "cxroots, our tail": ("black", "X", "-"),
    "cxroots, cut off": ("black", "X", ":"),
}
_PRECISE = {"root series": ("vermilion", "s", "-"), "integral, many digits": ("blue", "P", "-")}


def draw_scene(scene: str, v: float, c: float, points: Sequence[WorkPoint], folder: Path) -> None:
    """Write ``sum-<scene>.svg`` and ``.png`` of the points at one scene."""
    here = [point for point in points if point.scene == scene]
    figure, (left, right) = new_panels(2, width="page", height=3.9)
    lines = _lines(left, here, _DOUBLE, double=True)
    more = _lines(right, here, _PRECISE, double=False)
    left.set_title(f"{scene}: v = {v:g}, c = {c:g}")
    right.set_title("more digits than a double has")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.invert_xaxis()
        axes.grid(True)
        axes.set_xlabel("error of Σ (right is better)")
    left.set_ylabel("seconds an evaluation (low is better)")
    handles = {**lines, **more}
    figure.legend(
        list(handles.values()), list(handles), loc="outside lower center", ncols=4, markerscale=1.1
    )
    columns: dict[str, ArrayLike] = {
        "method": [point.method for point in here],
        "knob": [point.knob for point in here],
        "error": [point.error for point in here],
        "seconds": [point.seconds for point in here],
    }
    name = f"sum-{scene}"
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=200, metadata={"Software": None})
    drawn = picture(
        name,
        f"Error against run time of Σ, {scene} scene. Pale: settings that another one beats.",
        figure,
        columns,
    )
    (folder / f"{name}.png").write_bytes(image.getvalue())
    (folder / f"{name}.svg").write_text(drawn.svg, encoding="utf-8")


def _lines(
    axes: Axes,
    points: Sequence[WorkPoint],
    styles: dict[str, tuple[str, str, str]],
    double: bool,
) -> dict[str, Line2D]:
    """Draw each method: a line through the settings worth choosing, the others pale.

    A setting is worth choosing if no other of its method is both faster and more exact.
    """
    handles: dict[str, Line2D] = {}
    for method, (colour, marker, dash) in styles.items():
        chosen = [p for p in points if p.method == method and _is_double(p) is double]
        if method == "integral, many digits":
            chosen = [p for p in points if p.method == method]
        if not chosen:
            continue
        best, rest = worth_choosing(chosen)
        style: dict[str, Any] = {"color": COLOURS[colour], "marker": marker}
        (line,) = axes.plot(*_places(best, double), **style, linestyle=dash)
        axes.plot(*_places(rest, double), **style, linestyle="none", alpha=0.3, markeredgewidth=0)
        handles[method] = line
    return handles


def worth_choosing(points: Sequence[WorkPoint]) -> tuple[list[WorkPoint], list[WorkPoint]]:
    """Return the points that no other beats in both time and error, by error, and the rest."""
    best: list[WorkPoint] = []
    rest: list[WorkPoint] = []
    for point in sorted(points, key=lambda p: (p.seconds, p.error)):
        keep = not best or point.error < best[-1].error
        (best if keep else rest).append(point)
    return best, rest


def _places(points: Sequence[WorkPoint], double: bool) -> tuple[list[float], list[float]]:
    errors = [max(p.error, _FLOOR) if double else p.error for p in points]
    return errors, [p.seconds for p in points]


def _is_double(point: WorkPoint) -> bool:
    return not (point.knob.endswith(" digits") and int(point.knob.split()[0]) > 15)
