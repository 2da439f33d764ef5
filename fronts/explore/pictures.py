"""The six pictures of the explorer, each of which draws results into a Bokeh figure.

A new picture is a class derived from `ExplorerPicture` that names the calls it needs; it must be
added to `PICTURES`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from bokeh.models import ColorBar, ColumnDataSource, Div, LinearColorMapper, Span
from bokeh.plotting import figure

from fronts.explore.calls import SITES, SLOW_TIME, Settings
from fronts.pictures import BLUE, GREEN, VERMILION

GREY = "#777777"
HEIGHT = 265


class ExplorerPicture:
    """A figure with a caption, both replaced by a sentence if a call is refused.

    Attributes
    ----------
    name, title : str
        Name and title on the page.
    needs : tuple of str
        Names of the calls without which there is nothing to draw.
    also : tuple of str
        Names of further calls, whose results are drawn once they are available.
    x, y : str
        Labels of the axes.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    needs: ClassVar[tuple[str, ...]] = ()
    also: ClassVar[tuple[str, ...]] = ()
    x: ClassVar[str]
    y: ClassVar[str]
    options: ClassVar[Mapping[str, Any]] = {}

    def __init__(self) -> None:
        self.figure = figure(
            height=HEIGHT, sizing_mode="stretch_width", name=self.name, x_axis_label=self.x,
            y_axis_label=self.y, visible=False, tools="pan,wheel_zoom,box_zoom,reset",
            toolbar_location="right", **self.options,
        )  # fmt: skip
        self.figure.toolbar.logo = None
        self.figure.toolbar.autohide = True
        self.figure.grid.grid_line_color = "#eeeeee"
        self.figure.outline_line_color = None
        self.caption = Div(name=f"{self.name}-caption", sizing_mode="stretch_width", margin=0,
                           styles={"color": "#555", "min-height": "2.7em"})  # fmt: skip
        self.refusal = Div(name=f"{self.name}-refusal", sizing_mode="stretch_width", visible=False,
                           margin=0, height=HEIGHT, styles={"color": "#9a3412"})  # fmt: skip
        self.prepare()
        for legend in self.figure.legend:
            self.figure.add_layout(legend, "above")
            legend.update(orientation="horizontal", border_line_color=None, padding=0, margin=0,
                          spacing=12, label_text_font_size="12px", glyph_height=14)  # fmt: skip

    def prepare(self) -> None:
        """Add glyphs with empty data sources to the figure."""
        raise NotImplementedError

    def draw(self, settings: Settings, found: Mapping[str, Any]) -> str:
        """Draw the results, and return the caption."""
        raise NotImplementedError

    def show(self, settings: Settings, found: Mapping[str, Any]) -> None:
        """Draw the available results, or show the message with which a call is refused."""
        if any(name not in found for name in self.needs):
            return
        refused = self.refused(found)
        if not refused:
            self.caption.text = self.draw(settings, found)
        self.refusal.text = refused
        self.refusal.visible = bool(refused)
        self.figure.visible = self.caption.visible = not refused

    def refused(self, found: Mapping[str, Any]) -> str:
        """Return the message with which a call is refused, or an empty string."""
        return next((found[name] for name in self.needs if isinstance(found[name], str)), "")

    def source(self, name: str, *columns: str) -> ColumnDataSource:
        """Return an empty data source with these columns."""
        return ColumnDataSource({each: [] for each in columns or ("x", "y")}, name=name)

    def line(self, dimension: str, **look: Any) -> Span:
        """Return a straight line across the figure."""
        span = Span(dimension=dimension, line_color=GREY, line_width=1, **look)
        self.figure.add_layout(span)
        return span


class KineticPicture(ExplorerPicture):
    """All velocities versus coupling at the current η, and those at the current coupling."""

    name, title = "kinetic", "Kinetic relation (54)"
    needs, also = ("point",), ("curve",)
    x, y = "coupling c", "front velocity v̂ = v/ε"
    KINDS = ((True, "admissible", BLUE), (False, "not admissible", VERMILION))

    def prepare(self) -> None:
        """Add two kinds of points, the current point, and a line at the coupling."""
        self.curve = {}
        for kind, label, colour in self.KINDS:
            self.curve[kind] = self.source(f"curve-{kind}")
            self.figure.scatter("x", "y", source=self.curve[kind], size=4, color=colour,
                                fill_alpha=1.0 if kind else 0.0, legend_label=label)  # fmt: skip
        self.point = self.source("point")
        self.figure.scatter("x", "y", source=self.point, size=11, line_color="black",
                            fill_color=BLUE)  # fmt: skip
        self.here = self.line("height", name="here")

    def refused(self, found: Mapping[str, Any]) -> str:
        """Return the message, also if fronts of (44) do not travel at any coupling."""
        refused = super().refused(found)
        if not refused and found["point"].c_pin is None and not found["point"].branches:
            return f"No front travels: {found['point'].reason}"
        return refused

    def draw(self, settings: Settings, found: Mapping[str, Any]) -> str:
        """Draw the kinetic relation."""
        answer, curve = found["point"], found.get("curve")
        self.here.location = answer.c
        self.point.data = {
            "x": [answer.c for _ in answer.branches],
            "y": [each.v for each in answer.branches],
        }
        if curve is not None and not isinstance(curve, str):
            for kind, _, _ in self.KINDS:
                pairs = [(point.c, each.v) for point in curve.points for each in point.branches
                         if bool(each.admissible) is kind]  # fmt: skip
                self.curve[kind].data = {
                    "x": [c for c, _ in pairs], "y": [v for _, v in pairs],
                }  # fmt: skip
        if not answer.branches:
            return f"{answer.status.value}: {answer.reason}"
        words = {True: "admissible", False: "not admissible", None: "not decided"}
        return ", ".join(
            f"v = {each.v:.12g} ± {each.error:.1g} ({words[each.admissible]}"
            f"{'' if each.stable is None else ', stable' if each.stable else ', unstable'})"
            for each in answer.branches[-2:]
        )


class ProfilePicture(ExplorerPicture):
    """The shape of the fastest admissible front."""

    name, title = "profile", "Profile of the front (49)"
    needs = ("profile",)
    x, y = "ζ (sites)", "φ/φₛ"

    def prepare(self) -> None:
        """Add modulus, real and imaginary part, and the threshold."""
        self.shape = self.source("shape", "x", "modulus", "re", "im")
        for part, label, colour, dash in (
            ("modulus", "|φ|", BLUE, "solid"),
            ("re", "Re φ", VERMILION, "dashed"),
            ("im", "Im φ", GREEN, "dotted"),
        ):
            self.figure.line("x", part, source=self.shape, color=colour, line_dash=dash,
                             line_width=1.5, legend_label=label)  # fmt: skip
        self.threshold = self.line("width")

    def draw(self, settings: Settings, found: Mapping[str, Any]) -> str:
        """Draw the profile."""
        front = found["profile"]
        phi = front.phi
        self.shape.data = {"x": front.zeta, "modulus": np.abs(phi), "re": phi.real, "im": phi.imag}
        self.threshold.location = front.threshold
        kind = "admissible" if front.admissible else "not admissible"
        return f"v = {front.v:.6g}, {kind}; the threshold is |φ/φₛ| = {front.threshold:.4g}."


class StatesPicture(ExplorerPicture):
    """The plane of η and c with the states of the averaged chain and the current point."""

    name, title = "states", "Position in the map of states"
    needs, also = ("point",), ("states",)
    x, y = "η = b/a²", "coupling c"
    COLOURS: ClassVar[Mapping[str, str]] = {
        "front": "#bcd9ee",
        "breather": "#f7d3b8",
        "fixed point": "#d9d9d9",
    }

    def prepare(self) -> None:
        """Add the squares of the map, and the current point."""
        self.squares = {}
        for state, colour in self.COLOURS.items():
            self.squares[state] = self.source(f"state-{state}")
            self.figure.rect("x", "y", 0.01, 0.1, source=self.squares[state], color=colour,
                             legend_label=state)  # fmt: skip
        self.place = self.source("place")
        self.figure.scatter("x", "y", source=self.place, size=11, line_color="black",
                            fill_color=BLUE)  # fmt: skip

    def draw(self, settings: Settings, found: Mapping[str, Any]) -> str:
        """Draw the map and the current point."""
        self.place.data = {"x": [settings.eta], "y": [settings.c]}
        states = found.get("states")
        if states is None:
            return "The map is computed once and takes some seconds."
        if not len(self.squares["front"].data["x"]):
            table = states.columns()
            for state, source in self.squares.items():
                here = table["label"] == state
                source.data = {"x": table["eta"][here], "y": table["c"][here]}
        return (
            "State of 16 sites of (43) after displacement of the last one by 6 (Fig. 15), b = 0.5; "
            "white: undecided."
        )


class RunPicture(ExplorerPicture):
    """Amplitudes of the chain over time and site, with a line at the time of the next picture."""

    name, title = "run", "The chain in space and time"
    needs = ("run",)
    x, y = "slow time εt", "site n"
    options: ClassVar[Mapping[str, Any]] = {
        "x_range": (0.0, SLOW_TIME), "y_range": (0.5, SITES + 0.5),
    }  # fmt: skip

    def prepare(self) -> None:
        """Add the image, and the line at the current time."""
        self.image = self.source("picture", "image")
        self.colours = LinearColorMapper(palette="Cividis256", low=0.0, high=1.0)
        self.figure.image("image", x=0.0, y=0.5, dw=SLOW_TIME, dh=SITES, source=self.image,
                          color_mapper=self.colours)  # fmt: skip
        self.figure.add_layout(ColorBar(color_mapper=self.colours, title="amplitude", width=12),
                               "right")  # fmt: skip
        self.now = self.line("height", location=0.0, name="now")
        self.now.line_color = "white"

    def draw(self, settings: Settings, found: Mapping[str, Any]) -> str:
        """Draw the amplitudes."""
        run = found["run"]
        self.colours.high = 1.05 * max(run.chain.stable_amplitude, float(run.amplitude[0].max()))
        self.image.data = {"image": [np.ascontiguousarray(run.amplitude.T, dtype=np.float32)]}
        reached = int(np.isfinite(run.arrivals).sum())
        return f"{reached} of {SITES} sites have passed the unstable cycle by εt = {SLOW_TIME:g}."


class NowPicture(ExplorerPicture):
    """Amplitudes of the chain at the current time, together with those of the breather."""

    name, title = "amplitudes", "Amplitudes at the marked time"
    needs, also = ("run",), ("breather",)
    x, y = "site n", "amplitude"
    options: ClassVar[Mapping[str, Any]] = {"y_range": (0.0, 1.0)}

    def prepare(self) -> None:
        """Add the animated line, the breather, and the two cycles of a single cell."""
        self.chain = self.source("chain")
        self.breather = self.source("breather")
        self.figure.line("x", "y", source=self.chain, color=BLUE, line_width=1.5,
                         legend_label="chain")  # fmt: skip
        self.figure.scatter("x", "y", source=self.breather, color=VERMILION, size=6,
                            fill_alpha=0.0, legend_label="breather")  # fmt: skip
        self.cycles = self.line("width"), self.line("width", line_dash="dashed")

    def draw(self, settings: Settings, found: Mapping[str, Any]) -> str:
        """Draw the amplitudes."""
        run, breather = found["run"], found.get("breather")
        cycles = run.chain.stable_amplitude, run.chain.unstable_amplitude
        for line, amplitude in zip(self.cycles, cycles, strict=True):
            line.location = amplitude
        top = 1.15 * max(cycles[0], float(run.amplitude.max()))
        self.figure.y_range.update(start=0.0, end=top)
        self.chain.data = {"x": np.arange(1, SITES + 1), "y": run.amplitude[0]}
        size = [] if breather is None or isinstance(breather, str) else breather.amplitudes
        first = (SITES - len(size)) // 2 + 1
        self.breather.data = {"x": np.arange(first, first + len(size)), "y": size}
        return f"Cycles of one cell: {cycles[0]:.5g}, stable, and {cycles[1]:.5g}, unstable."


class MultipliersPicture(ExplorerPicture):
    """Floquet multipliers of the breather, and the unit circle."""

    name, title = "multipliers", "Floquet multipliers of the breather"
    needs = ("breather",)
    x, y = "Re μ", "Im μ"
    options: ClassVar[Mapping[str, Any]] = {
        "match_aspect": True, "x_range": (-1.6, 1.6), "y_range": (-1.1, 1.1),
    }  # fmt: skip

    def prepare(self) -> None:
        """Add the circle and the points."""
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        self.figure.line(np.cos(turn), np.sin(turn), color=GREY)
        self.points = self.source("multipliers-points")
        self.figure.scatter("x", "y", source=self.points, color=BLUE, size=7, fill_alpha=0.25)

    def refused(self, found: Mapping[str, Any]) -> str:
        """Return the message, also if there is no breather."""
        refused = super().refused(found)
        if not refused and found["breather"].multipliers is None:
            fold = found["breather"].fold
            where = "" if fold is None else f" The fold is at c = {fold:.9g}."
            sentence = str(found["breather"].status.sentence)
            return f"{sentence[:1].upper()}{sentence[1:]}{where}"
        return refused

    def draw(self, settings: Settings, found: Mapping[str, Any]) -> str:
        """Draw the multipliers."""
        breather = found["breather"]
        multipliers = breather.multipliers
        self.points.data = {"x": multipliers.real, "y": multipliers.imag}
        trivial = int(np.argmin(np.abs(multipliers - 1.0)))
        largest = np.abs(np.delete(multipliers, trivial)).max()
        kind = "stable" if breather.stable else "not stable"
        return (
            f"{kind}: the largest |μ| apart from the trivial one is {largest:.6g}; "
            f"the trivial one differs from 1 by {breather.trivial:.1g}."
        )


PICTURES = (
    KineticPicture, ProfilePicture, StatesPicture, RunPicture, NowPicture, MultipliersPicture,
)  # fmt: skip
"""The pictures in their order on the page."""
