"""Progress: live in a terminal, a line a minute in a file, nothing in a pipe, honest estimates."""

from __future__ import annotations

import codecs
import io
import os
import pty
import re
import sys
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import TextIO

import pytest

import fronts as fr
from theory.parameters import ParameterError
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
    clock.now = 11.0 + 60.0 - 0.1
    left.add(1.0)
    assert left.seconds == 0.0


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


def test_a_fraction_that_is_told_twice_says_nothing_new() -> None:
    clock = _Clock()
    left = Remaining(clock)
    for _ in range(3):
        left.add(0.5)
        clock.now += 100.0
    assert left.seconds is None
    left.add(0.75)
    assert left.seconds == pytest.approx(300.0)


def logged(where: TextIO, monkeypatch: pytest.MonkeyPatch, *, quiet: bool = False) -> None:
    """Report 181 of 240 seconds of work, one a second."""
    clock = _Clock()
    with monkeypatch.context() as patch:
        patch.setattr(progress.time, "monotonic", clock)
        shown = Progress("run to t = 2000", stream=where, quiet=quiet)
        shown._remaining = Remaining(clock)
        with shown:
            for second in range(181):
                clock.now = float(second)
                shown.report(second / 240.0)


LINES = [
    "run to t = 2000: 4 %, about 230 s left",
    "run to t = 2000: 29 %, about 170 s left",
    "run to t = 2000: 54 %, about 110 s left",
]


def test_in_a_file_there_is_a_line_after_ten_seconds_and_then_one_a_minute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (tmp_path / "log").open("w") as file:
        logged(file, monkeypatch)
    assert (tmp_path / "log").read_text().splitlines() == LINES


@pytest.mark.parametrize("quiet", [False, True])
def test_in_a_pipe_there_are_the_same_lines_and_beside_json_none_for_each_step(
    quiet: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    reading, writing = os.pipe()
    with os.fdopen(writing, "w") as pipe:
        logged(pipe, monkeypatch, quiet=quiet)
        with Progress("claims", steps=1, stream=pipe, quiet=quiet) as shown:
            shown.end("fig9", "reproduced")
    with os.fdopen(reading) as read:
        found = read.read().splitlines()
    assert found[:3] == LINES
    assert len(found) == (3 if quiet else 4)


@pytest.mark.parametrize("steps", [1, 2, 4])
def test_of_equal_steps_each_is_its_part_of_the_whole(
    steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts: list[float] = []
    monkeypatch.setattr(Progress, "report", lambda _, part: parts.append(part))
    with Progress("claims", steps=steps, stream=io.StringIO(), quiet=True) as shown:
        for _ in range(steps):
            shown.end("fig9", "reproduced")
    assert parts[:steps] == [(k + 1) / steps for k in range(steps)]


def test_steps_that_print_no_line_of_their_own_count_in_that_of_a_minute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = _Clock()
    with (tmp_path / "log").open("w") as file, monkeypatch.context() as patch:
        patch.setattr(progress.time, "monotonic", clock)
        with Progress("claims", steps=4, stream=file, quiet=True) as shown:
            for second in (5.0, 20.0, 90.0):
                clock.now = second
                shown.end("fig9", "reproduced")
    lines = (tmp_path / "log").read_text().splitlines()
    assert [line.partition(",")[0] for line in lines] == ["claims: 50 %", "claims: 75 %"]


def test_the_only_step_is_all_that_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[float] = []
    shown = Progress("claims", steps=1, stream=io.StringIO(), quiet=True)
    monkeypatch.setattr(shown, "report", told.append)
    shown.end("fig9", "reproduced")
    assert told == [1.0]


def test_a_line_is_written_at_once_to_whatever_can_be_written_to() -> None:
    """Else the line of a step would be seen only when the buffer of a log is full."""
    for wrapper in (io.TextIOWrapper, codecs.getwriter("utf-8")):  # the second is no TextIOBase
        written = io.BytesIO()
        shown = Progress("claims", steps=1, stream=wrapper(written))  # type: ignore[arg-type]
        shown.end("fig9", "reproduced")
        assert b"fig9: reproduced" in written.getvalue()


def test_what_cannot_be_written_to_is_no_stream() -> None:
    with pytest.raises(ParameterError, match=r"stream = int is not allowed.*sys\.stderr"):
        Progress("claims", stream=3)  # type: ignore[arg-type]


def test_a_closed_stream_is_let_be(monkeypatch: pytest.MonkeyPatch) -> None:
    closed = io.StringIO()
    closed.close()
    logged(closed, monkeypatch)


def test_what_comes_from_a_store_says_nothing_of_the_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sixty stored findings within a second, then ten that take a minute each."""
    clock = _Clock()
    monkeypatch.setattr(progress.time, "monotonic", clock)
    monkeypatch.setattr(progress, "Remaining", lambda: Remaining(clock))
    monkeypatch.setattr(progress, "_in_notebook", lambda: True)
    with Progress("claims", steps=70, stream=io.StringIO()) as shown:
        _sixty_stored_and_three_computed(shown, clock)
    assert shown._remaining.seconds == pytest.approx(7 * 60.0, rel=1e-6)


def _sixty_stored_and_three_computed(shown: Progress, clock: _Clock) -> None:
    for place in range(60):
        clock.now += 0.01
        shown.end(f"stored {place}", "reproduced (stored)", computed=False)
    for place in range(3):
        clock.now += 60.0
        shown.end(f"computed {place}", "reproduced")


def all_of(master: int) -> str:
    """Return what stands in a pseudo-terminal, of which one read takes 4 kB at the most."""
    os.set_blocking(master, False)
    parts = []
    with suppress(BlockingIOError):
        while True:
            parts.append(os.read(master, 4096))
    return b"".join(parts).decode()


def test_a_terminal_shows_name_part_and_steps_on_a_line_that_is_removed_at_the_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    master, slave = pty.openpty()
    with os.fdopen(slave, "w") as terminal:
        with Progress("claims [of all]", steps=3, at_once=2, stream=terminal) as shown:
            for key in ("fig9", "fig16", "fig17"):  # the third waits
                shown.begin(key)
            shown.end("fig9", "reproduced [1 s]")
        shown.report(0.5)  # the line is no longer there
        assert shown.finished == 1
        written = all_of(master)
    os.close(master)
    assert written.endswith("\x1b[1A\x1b[2K")  # one line up, which is erased
    seen = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", written)
    assert "claims [of all]" in seen
    assert "fig9 and 1 more" in seen
    assert "33 %" in seen
    assert re.search(r"\[1/3\] +\d+\.\d s  fig9: reproduced \[1 s\]", seen)


def test_a_step_that_ends_is_numbered_with_the_seconds_since_the_first_began(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock, written = _Clock(), io.StringIO()
    clock.now = 5000.0
    monkeypatch.setattr(progress.time, "monotonic", clock)
    shown = Progress("claims", steps=12, stream=written)
    for place, (seconds, computed) in enumerate(((1.5, True), (0.0, False))):
        shown.begin(f"fig{place}")
        clock.now += seconds
        shown.end(f"fig{place}", "reproduced", computed=computed)
    assert [line.split() for line in written.getvalue().splitlines()] == [
        ["[", "1/12]", "1.5", "s", "fig0:", "reproduced"],
        ["[", "2/12]", "1.5", "s", "fig1:", "reproduced"],
    ]


def test_in_a_terminal_a_long_line_is_printed_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither broken nor coloured, so that it can be copied; beside JSON as well."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "40")
    said = "c_pin = 0.455301 " * 6 + "[/b] 'of' 1.5 s"
    master, slave = pty.openpty()
    with os.fdopen(slave, "w") as terminal:
        with Progress("claims", steps=1, quiet=True, stream=terminal) as shown:
            shown.end("fig9", said)
        seen = all_of(master)
    os.close(master)
    assert f"fig9: {said}" in seen


def test_steps_are_told_on_standard_error_unless_another_stream_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    Progress("claims", steps=1).end("fig9", "reproduced")
    assert "fig9: reproduced" in capsys.readouterr().err
    monkeypatch.setattr(progress.sys, "stderr", None)
    Progress("claims", steps=1).end("fig9", "reproduced")  # as without a console


def test_a_line_names_the_first_step_that_runs_and_how_many_run_beside_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown: list[str] = []

    class Line:
        def add_task(self, name: str, **_: object) -> int:
            return 0

        def update(self, _: int, *, description: str = "", **__: object) -> None:
            shown.append(description)

        def start(self) -> None: ...
        def stop(self) -> None: ...

    monkeypatch.setattr(progress, "_in_notebook", lambda: True)
    monkeypatch.setattr(progress, "_live_line", lambda _: Line())
    with Progress("claims", steps=9, at_once=2, stream=io.StringIO()) as told:
        for step in ("fig9", "fig16", "fig17"):
            told.begin(step)
    assert shown == ["fig9", "fig9 and 1 more", "fig9 and 1 more"]  # of two at once
    with Progress("claims", steps=9, stream=io.StringIO()) as told:
        for step in ("fig9", "fig16"):
            told.begin(step)
    assert shown[3:] == ["fig9", "fig9"]  # one at a time, unless another number is given


def test_a_kernel_of_jupyter_is_known_by_its_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, shown in (("ZMQInteractiveShell", True), ("TerminalInteractiveShell", False)):
        shell = type(name, (), {})()
        ipython = SimpleNamespace(get_ipython=lambda shell=shell: shell)
        monkeypatch.setitem(sys.modules, "IPython", ipython)
        assert progress._in_notebook() is shown
    monkeypatch.delitem(sys.modules, "IPython")
    assert not progress._in_notebook()


def test_a_live_line_names_a_step_that_has_not_ended() -> None:
    shown: list[str] = []
    done = Progress("sweep", steps=2, at_once=2)
    line = SimpleNamespace(
        update=lambda _, description="", **__: shown.append(description),
        console=SimpleNamespace(print=lambda *_, **__: None),
    )
    done._live = line, 0  # type: ignore[assignment]
    done.begin("first")
    done.begin("second")
    done.end("first", "steady")
    assert [each for each in shown if each] == ["first", "first and 1 more", "second"]


def test_a_curve_tells_its_progress_point_by_point():
    told = []
    fr.kinetic_relation(c=[0.5, 0.6], eta=0.03125, progress=told.append)
    assert (told, told[-1]) == (sorted(told), 1.0)
