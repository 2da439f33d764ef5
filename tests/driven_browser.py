"""A browser that is driven: over its debugging pipe, so that it ends when this process does.

``python -m tests.driven_browser docs/explore.png`` writes the picture of the explorer.
"""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PROGRAM = next(filter(None, map(shutil.which, NAMES)), None)
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
    "--no-first-run", "--remote-debugging-pipe", "--window-size=1400,1000",
)  # fmt: skip
TIMEOUT = 180.0
"""Seconds waited for anything; with five processes a core an update takes a third of it."""


START = '"$0" -m fronts explore --no-browser & read -r end'
"""A shell that starts the explorer, and ends as soon as nothing can be said to it any more."""


@contextmanager
def explorer() -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Start the explorer from a shell; give what speaks to the shell, and the address."""
    shell = subprocess.Popen(
        ["sh", "-c", START, sys.executable], stdin=subprocess.PIPE, stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    assert shell.stdin is not None
    assert shell.stderr is not None
    try:
        yield shell, shell.stderr.readline().split()[0]
    finally:
        shell.stdin.close()
        shell.wait(TIMEOUT)
        shell.stderr.close()


class Browser:
    """One page of Chromium, spoken to in the DevTools protocol (JSON with a zero byte after it)."""

    def __init__(self, address: str, profile: Path):
        self.problems: list[str] = []
        self.addresses: set[str] = set()
        self._sent, self._buffer = 0, b""
        theirs_in, self._out = os.pipe()
        self._in, theirs_out = os.pipe()
        # The pipe is what file descriptors 3 and 4 of the browser are.
        command = f'exec "$0" "$@" 3<&{theirs_in} 4>&{theirs_out}'
        self._process = subprocess.Popen(
            ["bash", "-c", command, str(PROGRAM), *FLAGS, f"--user-data-dir={profile}"],
            pass_fds=(theirs_in, theirs_out), start_new_session=True, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(theirs_in)
        os.close(theirs_out)
        self._session = ""
        page = self.send("Target.createTarget", url="about:blank")
        self._session = self.send(
            "Target.attachToTarget", targetId=page["targetId"], flatten=True
        )["sessionId"]  # fmt: skip
        for domain in ("Runtime", "Log", "Network", "Page"):
            self.send(f"{domain}.enable")
        self.send("Emulation.setFocusEmulationEnabled", enabled=True)
        self.open(address)

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._out)
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        os.close(self._in)

    def send(self, method: str, **params: Any) -> Any:
        """Ask for something and return the answer; what is told meanwhile is taken note of."""
        self._sent += 1
        message = {"id": self._sent, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        while True:
            told = self._read()
            if told.get("id") == self._sent:
                assert "error" not in told, told
                return told["result"]
            self._note(told)

    def _read(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            if not select.select([self._in], [], [], TIMEOUT)[0]:
                raise TimeoutError("the browser does not answer")
            part = os.read(self._in, 1 << 20)
            if not part:
                raise EOFError("the browser has ended")
            self._buffer += part
        message, _, self._buffer = self._buffer.partition(b"\0")
        return dict(json.loads(message))

    def _note(self, told: dict[str, Any]) -> None:
        method, params = told.get("method"), told.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.problems.append(str(params["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "assert"):
            self.problems.append(str([each.get("value") for each in params["args"]]))
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.problems.append(str(params["entry"]))
        elif method == "Network.requestWillBeSent":
            self.addresses.add(params["request"]["url"])

    def open(self, address: str) -> None:
        """Go to an address, as on a first visit, and forget what was noted so far."""
        self.send("Page.navigate", url="about:blank")
        self.problems, self.addresses = [], set()
        self.send("Page.navigate", url=address)
        self.wait("location.href != 'about:blank' && document.readyState == 'complete'")

    def resize(self, width: int, height: int) -> None:
        """Have a window of this size, in pixels."""
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=False)  # fmt: skip

    def ask(self, expression: str) -> Any:
        """Return the value of an expression of JavaScript in the page."""
        found = self.send("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def wait(self, expression: str) -> Any:
        """Return the value of an expression as soon as it is true."""
        last = time.monotonic() + TIMEOUT
        while not (value := self.ask(expression)):
            if time.monotonic() > last:
                raise TimeoutError(f"never true: {expression}; problems: {self.problems}")
            time.sleep(0.05)
        return value

    def click(self, element: str) -> None:
        """Click the middle of the element that an expression gives."""
        x, y = self.ask(
            f"(() => {{ const box = ({element}).getBoundingClientRect();"
            "return [box.x + box.width / 2, box.y + box.height / 2]; })()"
        )
        for kind in ("mousePressed", "mouseReleased"):
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def press(self, key: str, code: int) -> None:
        """Press and release a key."""
        about = {"key": key, "code": key, "windowsVirtualKeyCode": code}
        text = {"text": "\r"} if key == "Enter" else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", **about, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **about)

    def picture(self, path: Path, width: int, height: int) -> None:
        """Write what a window of this size shows."""
        self.resize(width, height)
        time.sleep(1.5)
        shot = self.send("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(shot["data"]))


def need_browser() -> None:
    """Where there is no browser, skip the test, or fail it if one is asked for."""
    if PROGRAM is None:
        missing = f"no browser found: install one of {', '.join(NAMES)}"
        if os.environ.get("FRONTS_NEED_BROWSER"):
            pytest.fail(missing)  # where the project is checked as a whole
        pytest.skip(missing)


@contextmanager
def opened(profile: Path) -> Iterator[Browser]:
    """Give a browser, if there is one."""
    need_browser()
    with Browser("data:text/html,ready", profile) as browser:
        yield browser


def main() -> None:
    """Write the picture of the explorer."""
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile,
        explorer() as (_, address),
        Browser(address, Path(profile)) as browser,
    ):
        states = "Bokeh.documents[0].get_model_by_name('state-front')"
        browser.wait(f"window.Bokeh?.documents.length && {states}?.data.x.length > 0")
        width, height = map(int, [*sys.argv[2:], 1400, 900][:2])
        browser.picture(Path(sys.argv[1]), width, height)


if __name__ == "__main__":
    main()
