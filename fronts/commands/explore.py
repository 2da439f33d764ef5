"""``fronts explore``: a page with sliders for the parameters, in a browser on this machine."""

from __future__ import annotations

import sys
from contextlib import suppress

from fronts.answer import Answer
from theory.parameters import MissingPackageError, count_within

EXAMPLE = """examples:
  fronts explore
  fronts explore --port 5006 --no-browser

The page is served to this machine only, at 127.0.0.1, until Ctrl-C is pressed or the shell that
started it ends. It needs the extra explore: pip install "excitation-fronts[explore]"."""


def explore(*, port: int = 0, no_browser: bool = False) -> Answer:
    """Serve the page until it is interrupted.

    Parameters
    ----------
    port : int, optional
        Port of 127.0.0.1; 0 for any free port.
    no_browser : bool, optional
        Do not open a browser.
    """
    port = count_within("--port", port, 0, 65535)
    try:
        from fronts.explore.page import serve
    except ModuleNotFoundError as missing:
        if (missing.name or "").split(".")[0] not in ("panel", "bokeh", "tornado"):
            raise
        raise MissingPackageError("panel", "explore", "the explorer") from None
    served: list[str] = []

    def ready(address: str) -> None:
        served.append(address)
        print(f"{address} (Ctrl-C ends it)", file=sys.stderr)

    with suppress(KeyboardInterrupt):
        serve(port, ready, show=not no_browser)
    return Answer(payload={"address": served[0] if served else None}, text="ended.")
