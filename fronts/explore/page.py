"""The page of the explorer: its controls, its pictures, and the local server."""

from __future__ import annotations

import html
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter
from typing import Any

import panel as pn
from bokeh.events import DocumentReady
from bokeh.models import CustomJS
from tornado.ioloop import PeriodicCallback

from fronts.explore.calls import SLOW, Settings, calls, outcome, script
from fronts.explore.pictures import PICTURES, NowPicture, RunPicture

ADDRESS = "127.0.0.1"
"""The page can be reached from this machine only."""

PAGE = """
body { margin: 0; background: #f6f6f4; color: #222; }
"""
TEXT = ":host { font: 15px/1.4 system-ui, sans-serif; } h1 { font-size: 21px; margin: 4px 0; }"
GRID = """
:host { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 12px; }
@media (max-width: 1150px) { :host { grid-template-columns: repeat(2, minmax(0, 1fr)); } }
@media (max-width: 640px) { :host { grid-template-columns: minmax(0, 1fr); } }
"""
CARD = """
:host { background: white; border: 1px solid #dcdcd8; border-radius: 6px; padding: 8px 12px;
        box-sizing: border-box; min-width: 0; overflow: hidden; }
"""
NO_ARROWS = ".bk-spin-btn { display: none !important }"
CODE = """
pre { background: white; border: 1px solid #dcdcd8; border-radius: 6px; padding: 10px 14px;
      overflow: auto; margin: 4px 0; font-size: 13px; user-select: all; white-space: pre-wrap; }
"""

STEP = """
const image = picture.data.image[0];
if (image === undefined) return;
const [sites, samples] = image.shape;
const at = now.tags[0] = (now.tags[0] + 1) % samples;
now.location = last * at / (samples - 1);
const y = new Float64Array(sites);
for (let n = 0; n < sites; n++) y[n] = image[n * samples + at];
line.data = {x: line.data.x, y: y};
"""
"""JavaScript, run in the browser, that shows the next sample in time."""


class Controls:
    """The sliders and menus of the page, and the settings that they represent."""

    def __init__(self) -> None:
        slider = pn.widgets.EditableFloatSlider
        look = {"width": 200, "margin": (4, 10)}
        self.model = pn.widgets.Select(
            name="simulated chain",
            options={"averaged (43)": "averaged", "Van der Pol (8)": "vdp"},
            **look,
        )
        self.damping = pn.widgets.Select(
            name="damping given by", options={"η": False, "a and b": True}, **look
        )
        # A typed value may lie outside the slider's range; if it is not allowed, the functions
        # refuse it. The fixed bounds exclude allowed values for which they would take minutes.
        self.c = slider(
            name="coupling c", start=0.02, end=2.0, step=0.01, value=0.5, fixed_end=20.0,
            format="0.00[000]", **look,
        )  # fmt: skip
        self.eta = slider(
            name="η = b/a²", start=0.005, end=0.14, step=0.00125, value=0.03125, fixed_start=0.001,
            format="0.00000", **look,
        )  # fmt: skip
        self.a = slider(
            name="a", start=0.5, end=6.0, step=0.1, value=4.0, fixed_start=0.1, fixed_end=10.0,
            visible=False, **look,
        )  # fmt: skip
        self.b = slider(
            name="b", start=0.05, end=1.0, step=0.05, value=0.5, fixed_start=0.01, fixed_end=10.0,
            visible=False, **look,
        )  # fmt: skip
        self.eps = slider(
            name="ε", start=0.005, end=0.1, step=0.005, value=0.01, fixed_start=0.001,
            fixed_end=1.0, format="0.000", **look,
        )  # fmt: skip
        self.nucleus = pn.widgets.IntSlider(name="nucleus size", start=1, end=9, value=1, **look)
        self.all = (
            self.c, self.eta, self.a, self.b, self.eps, self.nucleus, self.model, self.damping,
        )  # fmt: skip
        for number in (self.c, self.eta, self.a, self.b, self.eps):
            for typed in number.select(pn.widgets.FloatInput):
                typed.stylesheets = [*typed.stylesheets, NO_ARROWS]
        self.damping.param.watch(self._swap, "value")

    def _swap(self, event: Any) -> None:
        self.a.visible = self.b.visible = event.new
        self.eta.visible = not event.new

    def settings(self) -> Settings:
        """Return the current settings."""
        settings = {
            "c": float(self.c.value), "eps": float(self.eps.value), "model": self.model.value,
            "nucleus": self.nucleus.value,
        }  # fmt: skip
        if not self.damping.value:
            return Settings(eta=float(self.eta.value), **settings)
        a, b = float(self.a.value), float(self.b.value)
        return Settings(eta=b / a**2, a=a, b=b, **settings)


class ExplorerPage:
    """The page of one reader.

    Calls are executed in one thread, settings that are no longer current are skipped, and each
    picture is shown as soon as its calls are done. While a slider is dragged, the page is at most
    one update behind.
    """

    def __init__(self) -> None:
        self.pictures = [each() for each in PICTURES]
        self.controls = Controls()
        self.code = pn.pane.HTML(visible=False, stylesheets=[CODE], sizing_mode="stretch_width")
        self.status = pn.pane.HTML(stylesheets=[TEXT], margin=(18, 10, 4, 10))
        self.worker = ThreadPoolExecutor(1)
        self.document = pn.state.curdoc
        self.current: Settings | None = None
        self.begun = 0.0
        for each in self.controls.all:
            each.param.watch(lambda _: self.follow(), "value")
        self.document.on_session_destroyed(lambda _: self.worker.shutdown(cancel_futures=True))
        self._start_clock()
        self.follow()

    def _start_clock(self) -> None:
        run = next(each for each in self.pictures if isinstance(each, RunPicture))
        now = next(each for each in self.pictures if isinstance(each, NowPicture))
        run.now.tags = [0]
        things = {"picture": run.image, "now": run.now, "line": now.chain}
        last = run.figure.x_range.end
        ticking = CustomJS(
            args={**things, "last": last}, code=f"setInterval(() => {{{STEP}}}, 100);"
        )
        self.document.js_on_event(DocumentReady, ticking)

    def follow(self) -> None:
        """Update the page to the current settings of the controls."""
        settings = self.controls.settings()
        if settings != self.current:
            self.current, self.begun = settings, perf_counter()
            self.worker.submit(self._work, settings)

    def _work(self, settings: Settings) -> None:
        """Execute the calls, skipping slow ones whose settings are no longer current."""
        found: dict[str, Any] = {}
        try:
            for name, call in calls(settings).items():
                if self.current is not settings and name in ("point", *SLOW):
                    return
                found[name] = outcome(call)
                self._later(self._shower(settings, dict(found)))
            text = script(settings)
            self._later(lambda: self.code.param.update(object=f"<pre>{html.escape(text)}</pre>"))
        except Exception as defect:
            message = f"a defect of this toolkit: {type(defect).__name__}: {defect}"
            self._later(lambda: self.status.param.update(object=html.escape(message)))

    def _later(self, do: Callable[[], Any]) -> None:
        self.document.add_next_tick_callback(do)

    def _shower(self, settings: Settings, found: dict[str, Any]) -> Callable[[], None]:
        def show() -> None:
            newest = next(reversed(found))
            self.document.hold("combine")
            for each in self.pictures:
                if newest in each.needs + each.also:
                    each.show(settings, found)
            if newest == "breather":
                spent = f"; updated in {1e3 * (perf_counter() - self.begun):.0f} ms"
                first = not self.status.object  # the first one includes loading compiled code
                self.status.object = f"η = {settings.eta:.6g}{'' if first else spent}"
            self.document.unhold()

        return show

    def view(self) -> pn.viewable.Viewable:
        """Return the page."""
        cards = [
            pn.Column(
                pn.pane.HTML(f"<b>{each.title}</b>", stylesheets=[TEXT], margin=0),
                *(
                    pn.pane.Bokeh(model, margin=0, sizing_mode="stretch_width")
                    for model in (each.caption, each.figure, each.refusal)
                ),
                stylesheets=[CARD],
                sizing_mode="stretch_width",
            )
            for each in self.pictures
        ]
        button = pn.widgets.Toggle(name="Python", width=100, margin=(18, 10, 4, 10))
        button.param.watch(lambda event: self.code.param.update(visible=event.new), "value")
        return pn.Column(
            pn.pane.HTML("<h1>Excitation fronts</h1>", stylesheets=[TEXT], margin=(4, 10)),
            pn.FlexBox(*self.controls.all, button, self.status, sizing_mode="stretch_width"),
            self.code,
            pn.Column(*cards, stylesheets=[GRID], sizing_mode="stretch_width", margin=10),
            sizing_mode="stretch_width",
        )


def serve(port: int, ready: Callable[[str], None], *, show: bool) -> None:
    """Serve the page until the process is interrupted or its parent process has ended.

    Parameters
    ----------
    port : int
        Port of 127.0.0.1; 0 for any free port.
    ready : callable
        Called with the address once the page is available.
    show : bool
        Whether to open a browser.

    Raises
    ------
    OSError
        If the port is in use.
    """
    pn.extension(raw_css=[PAGE])
    server = pn.io.server.get_server(
        lambda: ExplorerPage().view(), port=port, address=ADDRESS, title="Excitation fronts",
        websocket_origin=[f"{ADDRESS}:{port}"] if port else None,
    )  # fmt: skip
    parent = os.getppid()

    def watch() -> None:
        if os.getppid() != parent:
            server.io_loop.stop()

    server.start()
    PeriodicCallback(watch, 500).start()
    ready(f"http://{ADDRESS}:{server.port}")
    if show:
        server.io_loop.add_callback(server.show, "/")
    try:
        server.io_loop.start()
    finally:
        server.stop()
