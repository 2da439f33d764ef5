"""Progress: live in a terminal, a line a minute in a file, nothing in a pipe, honest estimates."""

from __future__ import annotations

import io
import os
import pty
import re
from pathlib import Path

import pytest

from verification.execution import progress
from verification.execution.progress import Progress, Remaining


class _Clock:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_compiling_is_not_taken_for_the_pace_of_the_work() -> None:
    """Sixty seconds of work after eleven of compiling: 6607 s were once announced."""
    clock = _Clock()
    left = Remaining(clock)
    left.add(0.0)
    clock.now = 11.0
    left.add(0.1 / 60.0)  # the first piece of work, compiled and done
    assert left.seconds is None
    for second in range(1, 59):
        clock.now = 11.0 + second
        left.add((0.1 + second) / 60.0)
        assert left.seconds == pytest.approx(60.0 - 0.1 - second)


def test_what_an_earlier_run_did_is_not_taken_for_the_pace_either() -> None:
    clock = _Clock()
    left = Remaining(clock)
    for fraction in (0.8, 0.9):
        left.add(fraction)
        clock.now += 5.0
    assert left.seconds == pytest.approx(5.0)


def test_a_clock_that_goes_back_says_nothing() -> None:
    clock = _Clock()
    left = Remaining(clock)
    for fraction in (0.1, 0.5, 0.7):
        left.add(fraction)
        clock.now -= 100.0
    assert left.seconds is None


def test_in_a_file_there_is_a_line_a_minute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = _Clock()
    monkeypatch.setattr(progress.time, "monotonic", clock)
    with (tmp_path / "log").open("w") as file:
        shown = Progress("run to t = 2000", stream=file)
        shown._remaining = Remaining(clock)
        with shown:
            for second in range(181):
                clock.now = float(second)
                shown.report(second / 240.0)
    lines = (tmp_path / "log").read_text().splitlines()
    assert lines == [
        "run to t = 2000: 25 %, about 180 s left",
        "run to t = 2000: 50 %, about 120 s left",
        "run to t = 2000: 75 %, about 60 s left",
    ]


def test_in_a_pipe_and_in_a_closed_stream_there_is_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(progress, "PERIOD", 0.0)
    reading, writing = os.pipe()
    closed = io.StringIO()
    closed.close()
    with os.fdopen(writing, "w") as pipe:
        for stream in (pipe, closed):
            with Progress("run", stream=stream) as shown:
                shown.report(0.5)
    with os.fdopen(reading) as read:
        assert read.read() == ""


def test_a_terminal_shows_name_part_and_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    master, slave = pty.openpty()
    with os.fdopen(slave, "w") as terminal:
        with Progress("claims [of all]", steps=2, stream=terminal) as shown:
            for key in ("fig9", "fig16"):
                shown.begin(key)
            shown.end("fig9", "reproduced [1 s]")
        assert shown.finished == 1
    seen = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", os.read(master, 100_000).decode())
    os.close(master)
    assert "claims [of all]" in seen
    assert "fig9 and 1 more" in seen
    assert "50 %" in seen
    assert re.search(r"\[1/2\] +\d+\.\d s  fig9: reproduced \[1 s\]", seen)
