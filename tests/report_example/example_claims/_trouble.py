"""Let a judge log that it ran, and fail the way the test asks for."""

import os
import signal
import time
from pathlib import Path


def visit(key):
    log = os.environ.get("EXAMPLE_LOG")
    if log:
        with Path(log).open("a", encoding="utf-8") as stream:
            stream.write(f"{key} {os.getpid()}\n")
    kind, _, where = os.environ.get("EXAMPLE_TROUBLE", "").partition(":")
    if where != key:
        return
    if kind == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    elif kind == "wait":
        time.sleep(40)
    elif kind == "raise":
        raise ArithmeticError("no root in the box <0, 1>\nsecond line")
