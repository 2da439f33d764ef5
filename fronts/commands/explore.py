"""``fronts explore``: a page in the browser, on this machine, in which parameters are sliders."""

from __future__ import annotations

import argparse
import sys
from contextlib import suppress

from fronts.answer import Answer
from fronts.arguments import whole

EXAMPLE = """examples:
  fronts explore
  fronts explore --port 5006 --no-browser

The page is served to this machine only, at 127.0.0.1, until Ctrl-C or until the shell ends that
started it. It needs the extra explore: pip install "excitation-fronts[explore]"."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts explore``."""
    parser.add_argument("--port", type=whole, default=0, help="of 127.0.0.1 (default a free one)")
    parser.add_argument("--no-browser", action="store_true", help="open no browser")


def run(options: argparse.Namespace) -> Answer:
    """Serve the page until it is interrupted."""
    from theory.parameters import MissingPackageError, count_within

    port = count_within("--port", options.port, 0, 65535)
    try:
        from fronts.explore.page import serve
    except ModuleNotFoundError as missing:
        if (missing.name or "").split(".")[0] not in ("panel", "bokeh", "tornado"):
            raise
        raise MissingPackageError("panel", "explore", "the explorer") from None
    served: list[str] = []

    def ready(address: str) -> None:
        served.append(address)
        print(f"{address} (Ctrl-C ends it)", file=sys.stderr, flush=True)

    with suppress(KeyboardInterrupt):
        serve(port, ready, show=not options.no_browser)
    return Answer(payload={"address": served[0] if served else None}, text="ended.")
