"""Pictures in a uniform style: deterministic SVG, and the numbers behind them as CSV.

Matplotlib is imported on first use, so that a claim file may import this module at its top.
"""

from __future__ import annotations

import base64
import io
import logging
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import permutations
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from verification.pictures.data_table import columns_as_csv

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from verification.pictures.data_table import Column

Width = Literal["column", "page"]

WIDTHS: Mapping[str, float] = {"column": 3.4, "page": 7.0}
"""Widths in inches of one column and of the whole page of a two-column journal."""

COLOURS: Mapping[str, str] = {
    "blue": "#0072B2",
    "vermilion": "#D55E00",
    "green": "#009E73",
    "purple": "#CC79A7",
    "orange": "#E69F00",
    "sky": "#56B4E9",
    "black": "#000000",
    "yellow": "#F0E442",
}
"""Okabe and Ito's palette, distinguishable by colour-blind readers; the most legible first."""

LARGE = 1_000_000
"""Number of characters above which an SVG makes the report slow to open."""

DOTS = 130
"""Resolution of the PNG files of the report in dots per inch."""

CHANGING: Mapping[str, tuple[str, ...]] = {
    "svg": ("Date", "Creator", "Format", "Type"),
    "png": ("Software",),
    "pdf": ("CreationDate", "Creator", "Producer"),
}
"""Entries in which Matplotlib writes the time of day and its version unless told otherwise."""

logger = logging.getLogger(__name__)

NAME = re.compile(r"[a-z0-9][a-z0-9._-]*")
"""Form of a claim's key and of a picture's name: both are used as file names and page anchors."""


@dataclass(frozen=True)
class Picture:
    """A figure of the report.

    Attributes
    ----------
    name : str
        File name without suffix; unique in the report.
    caption : str
        What is shown, in a sentence or two; also the alternative text.
    svg : str
        The picture, as an SVG document.
    data : str
        The numbers behind it, as CSV with a header line.
    png, pdf : str
        The same picture in these formats, base64-encoded; may be empty.
    """

    name: str
    caption: str
    svg: str = field(repr=False)
    data: str = field(repr=False)
    png: str = field(default="", repr=False)
    pdf: str = field(default="", repr=False)


def use_style() -> None:
    """Set the style of all pictures for the rest of this process."""
    import matplotlib as mpl
    from cycler import cycler

    lines = [colour for name, colour in COLOURS.items() if name != "yellow"]
    mpl.rcParams.update(
        {
            "axes.axisbelow": True,
            "axes.labelsize": 8,
            "axes.linewidth": 0.6,
            "axes.prop_cycle": cycler(color=lines),
            "axes.spines.right": False,
            "axes.spines.top": False,
            "axes.titlelocation": "left",
            "axes.titlesize": 8,
            "figure.constrained_layout.use": True,
            "figure.facecolor": "white",
            "font.family": "sans-serif",
            "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
            "font.size": 8,
            "grid.alpha": 0.5,
            "grid.color": "#bbbbbb",
            "grid.linewidth": 0.4,
            "legend.fontsize": 7,
            "legend.frameon": False,
            "legend.handlelength": 1.6,
            "lines.linewidth": 1.2,
            "lines.markersize": 3.5,
            "mathtext.fontset": "dejavusans",
            "savefig.facecolor": "white",
            "svg.fonttype": "path",
            "xtick.labelsize": 7,
            "xtick.major.size": 3,
            "xtick.major.width": 0.6,
            "xtick.minor.size": 1.6,
            "xtick.minor.width": 0.4,
            "ytick.labelsize": 7,
            "ytick.major.size": 3,
            "ytick.major.width": 0.6,
            "ytick.minor.size": 1.6,
            "ytick.minor.width": 0.4,
        }
    )


def new_axes(
    width: Width = "column",
    *,
    height: float | None = None,
    xlabel: str = "",
    ylabel: str = "",
) -> tuple[Figure, Axes]:
    r"""Make a figure with one set of axes in the project's style.

    Parameters
    ----------
    width : {"column", "page"}, optional
        3.4 or 7 inches.
    height : float, optional
        Height in inches; by default 0.68 of the width of a column, 0.45 of that of a page.
    xlabel, ylabel : str, optional
        What the axes show, with units or "dimensionless" where this is not obvious.

    Examples
    --------
    >>> figure, axes = new_axes(xlabel="coupling c", ylabel="front velocity")
    >>> line = axes.plot([0, 1], [0, 2])
    >>> picture("line", figure, {"c": [0, 1], "v": [0, 2]}).data
    'c,v\n0,0\n1,2\n'
    """
    figure, panels = new_panels(1, width=width, height=height)
    panels[0].set_xlabel(xlabel)
    panels[0].set_ylabel(ylabel)
    return figure, panels[0]


def new_panels(
    columns: int,
    rows: int = 1,
    *,
    width: Width = "page",
    height: float | None = None,
    sharex: bool = False,
) -> tuple[Figure, tuple[Axes, ...]]:
    """Make a figure with several sets of axes, listed row by row.

    Parameters
    ----------
    columns, rows : int
        Number of panels side by side and below each other.
    width, height
        As in `new_axes`.
    sharex : bool, optional
        Whether all panels share one horizontal axis.
    """
    from matplotlib.figure import Figure

    use_style()
    inches = WIDTHS[width]
    figure = Figure(figsize=(inches, height or inches * (0.68 if width == "column" else 0.45)))
    grid = figure.subplots(rows, columns, squeeze=False, sharex=sharex)
    return figure, tuple(grid.ravel())


def picture(
    name: str,
    figure: Figure,
    data: Mapping[str, Column],
    *,
    caption: str = "",
    guides: bool = False,
    encoded: bool = True,
) -> Picture:
    """Render a figure and put the numbers behind it into CSV; the figure is emptied.

    The same figure yields the same bytes, at any time and in any process.

    Parameters
    ----------
    name : str
        File name without suffix: lower-case letters, digits, dots, hyphens, underscores.
    figure : Figure
        A figure of `new_axes` or `new_panels`; one made by ``pyplot`` is closed as well.
    data : mapping of str to array_like
        Columns of the CSV file by name, one-dimensional and of equal length. For a picture of
        several curves use `data_table.long_table`.
    caption : str, optional
        What is shown, in a sentence or two; for a picture of a claim it is taken from the text of
        the claim.
    guides : bool, optional
        Whether lines that are not in the data may be drawn: slopes, bounds, a strip around zero.
    encoded : bool, optional
        Whether the picture is also rendered as PNG and PDF, which takes two thirds of the time.

    Raises
    ------
    ValueError
        If the name is not a valid file name, the columns do not form a table as in
        `columns_as_csv`, or a line or bar is drawn that is neither in the data nor a guide.
    """
    if not NAME.fullmatch(name):
        raise ValueError(
            f"the picture name '{name}' must be lower-case letters, digits, dots, hyphens or "
            "underscores: choose another."
        )
    table = columns_as_csv(data)
    for label in () if guides else drawn_beyond(figure, data):
        raise ValueError(f"the picture '{name}' draws '{label}', which is not in its data.")
    svg = _render(name, figure)
    figure.set_layout_engine("none")  # the layout found first is kept for the other formats
    png, pdf = (_encoded(figure, kind) if encoded else "" for kind in ("png", "pdf"))
    if len(svg) > LARGE:
        logger.warning("the picture %s has %.1f MB: draw fewer points", name, len(svg) / 1e6)
    pyplot = sys.modules.get("matplotlib.pyplot")
    if pyplot is not None:
        pyplot.close(figure)
    figure.clear()
    return Picture(name, caption, svg, table, png, pdf)


def drawn_beyond(figure: Figure, data: Mapping[str, Column]) -> list[str]:
    """Return the labels of lines and bars whose points are not in any two columns of the data.

    Lines across the whole axes, as drawn by ``axhline``, and lines without points, which exist only
    for the legend, are exempt.
    """
    from matplotlib.container import BarContainer

    columns = [column for column in map(_numbers, data.values()) if column is not None]
    pairs = [set(zip(x, y, strict=True)) for x, y in permutations(columns, 2)]
    lost = []
    for axes in figure.axes:
        drawn = [
            (line.get_label(), line.get_xydata())
            for line in axes.get_lines()
            if line.get_transform() is axes.transData
        ]
        for bars in axes.containers:
            if isinstance(bars, BarContainer):
                # The middle is stored as left side and width; rounded, it is the number that was
                # drawn.
                middles = [round(bar.get_x() + 0.5 * bar.get_width(), 9) for bar in bars]
                tops = list(zip(middles, [bar.get_height() for bar in bars], strict=True))
                drawn.append((bars.get_label(), np.array(tops)))
        for label, points in drawn:
            known = np.asarray(points, dtype=float)
            shown = set(map(tuple, known[np.isfinite(known).all(axis=1)].tolist()))
            if not any(shown <= pair for pair in pairs):
                lost.append(str(label))
    return lost


def _numbers(column: Column) -> list[float] | None:
    """Return a column as floats, NaN for an empty cell; None if it contains words."""
    try:
        return [float(value) for value in np.array(column, dtype=float)]
    except (TypeError, ValueError):
        return None


def _render(name: str, figure: Figure) -> str:
    import matplotlib as mpl

    metadata: dict[str, Any] = dict.fromkeys(CHANGING["svg"])
    buffer = io.StringIO()
    # With letters as paths, accents such as those of v̂ and ỹ are in place in every renderer.
    with mpl.rc_context({"svg.hashsalt": name, "svg.fonttype": "path"}):
        figure.savefig(buffer, format="svg", metadata=metadata)
    return buffer.getvalue()


def _encoded(figure: Figure, kind: str) -> str:
    """Render a figure into a binary format, as base64."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind, dpi=DOTS, metadata=dict.fromkeys(CHANGING[kind]))
    return base64.b64encode(buffer.getvalue()).decode("ascii")
