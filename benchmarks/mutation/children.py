"""Forked children, each of which does one task and writes its answers."""

from __future__ import annotations

import contextlib
import json
import os
import resource
import selectors
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

Answer = dict[str, Any]
STOPPED, HUNG = "time limit or crash", "no end in more than three times its time"
"""What is reported as having noticed a change if its child process did not end by itself."""

HANGING = 60.0
"""Wall-clock seconds, in addition to three times its processor time, after which a child ends."""


@dataclass(frozen=True, kw_only=True)
class ChildTask:
    """The function that a child runs, its limit of processor time, and the receiver of answers."""

    run: Callable[[Callable[[Answer], None]], None]
    seconds: float
    take: Callable[[list[Answer]], None]


def in_children(tasks: Iterator[ChildTask], count: int) -> None:
    """Run tasks in at most ``count`` forked children at a time; what they start ends with them.

    If a child is ended by a signal or by its limit of processor time before it has answered, that
    is recorded as what noticed the change; if it hangs and is ended by the clock, this is added to
    its answers.
    """
    waiting = selectors.DefaultSelector()
    left = True
    try:
        while left or waiting.get_map():
            while left and len(waiting.get_map()) < count:
                task = next(tasks, None)
                left = task is not None
                if task is not None:
                    child, pipe = _begin(task)
                    until = time.monotonic() + 3.0 * task.seconds + HANGING
                    state = (task, child, until, bytearray())
                    waiting.register(pipe, selectors.EVENT_READ, state)
            ready = {key.fd for key, _ in waiting.select(0.5)}
            for key in list(waiting.get_map().values()):
                task, child, until, received = key.data
                part = os.read(key.fd, 1 << 16) if key.fd in ready else None
                received += part or b""
                hangs = part != b"" and time.monotonic() > until
                if part == b"" or hangs:
                    waiting.unregister(key.fd)
                    os.close(key.fd)
                    answers = _ended(child, bytes(received))
                    task.take([{"by": HUNG}, *answers] if hangs else answers)
    finally:
        for key in waiting.get_map().values():
            _ended(key.data[1], b"")


def _begin(task: ChildTask) -> tuple[int, int]:
    reading, writing = os.pipe()
    child = os.fork()
    if child:
        os.close(writing)
        return child, reading
    os.setsid()
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    limit = int(time.process_time() + task.seconds) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))

    def write(answer: Answer) -> None:
        os.write(writing, json.dumps(answer).encode() + b"\n")

    try:
        task.run(write)
    except BaseException as error:
        write({"by": type(error).__name__})
    os._exit(0)


def _ended(child: int, received: bytes) -> list[Answer]:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)  # the child's own session
    _, status = os.waitpid(child, 0)
    whole, _, _ = received.rpartition(b"\n")
    answers = [json.loads(line) for line in whole.splitlines()]
    return answers or ([{"by": STOPPED}] if os.WIFSIGNALED(status) else [])
