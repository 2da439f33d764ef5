"""The sweep engine: the same table however it was come by, and nothing lost or done twice."""

from __future__ import annotations

import importlib
import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from verification.execution.journal import journal_path

from theory.parameters import ParameterError
from verification.execution.sweep import SweepError, sweep
from verification.execution.table import Point, Table, grid, stamp_path, table_of

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER))  # inherited by spawned processes
sweep_example = importlib.import_module("sweep_example")
POINTS, Slow, failing = sweep_example.POINTS, sweep_example.Slow, sweep_example.failing


def _computed(log: Path) -> list[str]:
    return log.read_text(encoding="ascii").splitlines() if log.exists() else []


def _alive(log: Path) -> set[int]:
    """Return the processes that wrote into the log and still run."""
    running = set()
    for pid in {int(line.split()[-1]) for line in _computed(log)} - {os.getpid()}:
        try:
            os.kill(pid, 0)
            state = Path(f"/proc/{pid}/stat")
            if not state.exists() or state.read_text(encoding="utf-8").split(") ")[1][0] != "Z":
                running.add(pid)
        except (ProcessLookupError, FileNotFoundError):
            pass
    return running


def _command(out: Path, log: Path, workers: int) -> list[str]:
    # A test run in the background may have been told to ignore interrupts.
    program = (
        "import signal, sys, sweep_example\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "sweep_example.main(*sys.argv[1:])"
    )
    return [sys.executable, "-c", program, str(out), str(log), str(workers)]


def _interrupted(out: Path, log: Path) -> None:
    """Leave the journal of a sweep that came to an end after half of the points."""

    def stop(done: int, total: int, left: float | None) -> None:
        if done == len(POINTS) // 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(Slow(str(log)), POINTS, out=out, workers=1, progress=stop)


@pytest.fixture
def whole(tmp_path: Path) -> bytes:
    """Return the CSV of a sweep that was never disturbed."""
    out = tmp_path / "whole.csv"
    sweep(Slow(str(tmp_path / "whole.log")), POINTS, out=out, workers=1)
    return out.read_bytes()


def test_one_worker_two_workers_and_any_executor_give_the_same_bytes(
    tmp_path: Path, whole: bytes
) -> None:
    task = Slow(str(tmp_path / "log"))
    two = tmp_path / "two.csv"
    sweep(task, POINTS, out=two, workers=2)
    assert two.read_bytes() == whole
    threads = tmp_path / "threads.csv"
    with ThreadPoolExecutor(3) as executor:
        sweep(task, POINTS, out=threads, executor=executor)
        assert executor.submit(int, "1").result() == 1  # left open
    assert threads.read_bytes() == whole
    assert not journal_path(two).exists()


@pytest.mark.parametrize("workers", [1, 2])
def test_a_killed_sweep_is_resumed_with_nothing_lost_and_nothing_twice(
    workers: int, tmp_path: Path, whole: bytes
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    victim = subprocess.Popen(_command(out, log, workers), cwd=FOLDER)
    deadline = time.monotonic() + 20
    journal = journal_path(out)
    while not journal.exists() or journal.read_bytes().count(b"\n") < 6:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.kill(victim.pid, signal.SIGKILL)
    victim.wait()
    # Workers notice that their parent is gone, but may first end the point they are at.
    time.sleep(0.5)
    before = _computed(log)
    kept = journal.read_bytes().count(b"\n") - 1
    assert 5 <= kept <= len(before) < len(POINTS)
    time.sleep(0.3)
    assert _computed(log) == before
    assert not _alive(log), "a worker lives on without its parent"
    table = sweep(Slow(str(log), 0.1), POINTS, out=out, workers=workers, resume=True)
    assert out.read_bytes() == whole
    assert table.resumed == kept
    # only points that were not yet in the journal are computed again
    assert len(_computed(log)) == len(before) + len(POINTS) - kept
    assert not journal.exists()


def test_a_sweep_cut_at_any_byte_of_its_journal_gives_the_same_table(
    tmp_path: Path, whole: bytes
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    _interrupted(out, log)
    content = journal_path(out).read_bytes()
    lines = content.splitlines(keepends=True)
    # every byte of the last line, of the end of the header, and a few others
    cuts = {0, 1, len(lines[0]) - 1, len(lines[0]), len(lines[0]) + 1, len(content)}
    cuts |= set(range(len(content) - len(lines[-1]), len(content), 5)) | {len(content) - 1}
    for cut in sorted(cuts):
        journal_path(out).write_bytes(content[:cut])
        complete = max(content[:cut].count(b"\n") - 1, 0)
        before = len(_computed(log))
        assert sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True).resumed == complete
        assert out.read_bytes() == whole
        assert len(_computed(log)) - before == len(POINTS) - complete


def test_a_sweep_killed_twice_keeps_what_it_did_after_the_half_written_line(
    tmp_path: Path, whole: bytes
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    _interrupted(out, log)
    journal_path(out).write_bytes(journal_path(out).read_bytes()[:-7])

    def stop(done: int, total: int, left: float | None) -> None:
        if done == 15:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(Slow(str(log)), POINTS, out=out, workers=1, progress=stop, resume=True)
    assert sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True).resumed == 15
    assert out.read_bytes() == whole


def test_a_damaged_line_is_passed_over_and_its_point_computed_again(
    tmp_path: Path, whole: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    _interrupted(out, log)
    lines = journal_path(out).read_bytes().splitlines(keepends=True)
    # another value that is well-formed JSON: only the checksum can tell
    digit = lines[3].rindex(b"0.")
    lines[3] = (
        lines[3][: digit + 2]
        + (b"1" if lines[3][digit + 2] != 49 else b"2")
        + lines[3][digit + 3 :]
    )
    journal_path(out).write_bytes(b"".join(lines))
    table = sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True)
    assert table.resumed == len(POINTS) // 2 - 1
    assert out.read_bytes() == whole
    assert "line 4" in caplog.text


@pytest.mark.parametrize(
    ("task", "points", "named"),
    [
        (Slow("log", factor=2.0), POINTS, "parameters.factor"),
        (Slow("log"), POINTS[:-1], "points.count"),
        (failing, POINTS, "task"),
    ],
)
def test_a_journal_of_another_sweep_is_refused_and_left_alone(
    task: object,
    points: tuple[Point, ...],
    named: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    out = tmp_path / "out.csv"
    _interrupted(out, Path("log"))
    before = journal_path(out).read_bytes()
    with pytest.raises(ParameterError, match=named) as caught:
        sweep(task, points, out=out, workers=1, resume=True)  # type: ignore[arg-type]
    assert caught.value.remedy
    assert journal_path(out).read_bytes() == before


def test_a_journal_is_not_overwritten_unasked_nor_is_a_file_that_is_none(tmp_path: Path) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    _interrupted(out, log)
    with pytest.raises(ParameterError, match="--resume"):
        sweep(Slow(str(log)), POINTS, out=out, workers=1)
    for text in ("a letter\n", "a letter", '{"task": 1}\n'):
        journal_path(out).write_text(text, encoding="ascii")
        with pytest.raises(ParameterError, match="unreadable"):
            sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True)
        assert journal_path(out).read_text(encoding="ascii") == text


def test_two_sweeps_do_not_write_one_file(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    out = tmp_path / "out.csv"

    def second(done: int, total: int, left: float | None) -> None:
        if done == 3:
            with pytest.raises(ParameterError, match="in use"):
                sweep(Slow(str(tmp_path / "log")), POINTS, out=out, workers=1, resume=True)

    sweep(Slow(str(tmp_path / "log")), POINTS, out=out, workers=1, progress=second)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_failing_point_is_named_and_the_others_are_kept(workers: int, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    points = grid(x=range(1, 8))
    with pytest.raises(SweepError, match=r"Point\(x=2\) and 1 other.*no such point") as caught:
        sweep(failing, points, out=out, workers=workers)
    assert [point["x"] for point, _ in caught.value.failures] == [2, 5]
    assert journal_path(out).read_bytes().count(b"\n") == 1 + 5
    assert not out.exists()


def test_a_dead_worker_leaves_a_usable_journal(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    with pytest.raises(SweepError, match="resumed"):
        sweep(sweep_example.dying, grid(x=range(1, 8)), out=out, workers=2)
    assert journal_path(out).exists()


def test_an_interrupt_ends_the_workers_and_keeps_the_journal(tmp_path: Path, whole: bytes) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    runner = subprocess.Popen(
        _command(out, log, 2), cwd=FOLDER, stderr=subprocess.PIPE, start_new_session=True
    )
    deadline = time.monotonic() + 20
    while len(_computed(log)) < 4:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.killpg(runner.pid, signal.SIGINT)  # as Ctrl-C does: parent and workers
    assert b"KeyboardInterrupt" in runner.communicate(timeout=10)[1]
    before = _computed(log)
    time.sleep(0.3)
    assert _computed(log) == before
    assert not _alive(log), "a worker lives on"
    assert not out.exists()
    sweep(Slow(str(log), 0.1), POINTS, out=out, workers=1, resume=True)
    assert out.read_bytes() == whole


def test_numpy_opens_the_table(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    table = sweep(Slow(str(tmp_path / "log")), POINTS, out=out, workers=1)
    read = np.genfromtxt(out, names=True, delimiter=",", dtype=None, encoding="utf-8")
    assert read.dtype.names == ("x", "y", "value", "label", "count", "odd")
    for name in read.dtype.names:
        assert read[name].dtype.kind == table[name].dtype.kind
        assert (read[name] == table[name]).all()


def test_pandas_and_xarray_open_the_table(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    out = tmp_path / "out.csv"
    table = sweep(Slow(str(tmp_path / "log")), POINTS, out=out, workers=1)
    frame = pandas.read_csv(out)
    # the last digit is lost by the reader unless it is asked for it
    assert frame["value"].to_numpy() == pytest.approx(table["value"], rel=1e-15)
    assert (frame["label"] == table["label"]).all()
    pytest.importorskip("xarray")
    cube = frame.set_index(["x", "y"]).to_xarray()
    assert cube["value"].shape == (10, 2)


def test_a_finished_sweep_is_not_computed_again_unless_its_file_was_changed(
    tmp_path: Path, whole: bytes
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    first = sweep(Slow(str(log)), POINTS, out=out, workers=1)
    again = sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True)
    assert len(_computed(log)) == len(POINTS)
    assert again.as_csv() == first.as_csv() == whole.decode()
    assert {name: column.dtype for name, column in again.columns.items()} == {
        name: column.dtype for name, column in first.columns.items()
    }
    out.write_bytes(whole.replace(b"small", b"large", 1))
    sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True)
    assert len(_computed(log)) == 2 * len(POINTS)
    assert out.read_bytes() == whole


def test_the_stamp_names_task_parameters_and_versions(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    log = str(tmp_path / "log")
    sweep(Slow(log, factor=3.0), POINTS, out=out, workers=1)
    stamp = json.loads(stamp_path(out).read_text(encoding="utf-8"))
    assert stamp["task"] == "sweep_example.Slow"
    assert stamp["parameters"]["factor"] == 3.0
    assert stamp["points"]["count"] == 20
    assert {"python", "numpy", "numba"} <= set(stamp["versions"])
    assert stamp["table"]["seconds"] > 0


def test_progress_counts_up_and_the_time_left_ends_at_zero(tmp_path: Path) -> None:
    seen: list[tuple[int, int, float | None]] = []
    sweep(
        Slow(str(tmp_path / "log"), 0.01),
        POINTS,
        workers=1,
        progress=lambda *numbers: seen.append(numbers),
    )
    assert [done for done, _, _ in seen] == list(range(len(POINTS) + 1))
    assert {total for _, total, _ in seen} == {len(POINTS)}
    assert seen[0][2] is None
    assert seen[-1][2] == 0.0
    # a pause of 10 ms a point: a third of the points in, more than 13 * 10 ms are left
    assert seen[7][2] is not None
    assert 0.13 <= seen[7][2] < 1.3


def test_words_that_a_reader_would_misread_are_refused() -> None:
    for word in ("a,b", "", " a", 'a"b', "a#b", "a\nb"):
        with pytest.raises(ValueError, match="misread"):
            table_of([{"label": word}])
    with pytest.raises(ValueError, match="columns"):
        table_of([{"a": 1}, {"b": 1}])


def test_a_table_keeps_special_numbers(tmp_path: Path) -> None:
    table = table_of([{"x": float("nan")}, {"x": float("inf")}, {"x": 5e-324}])
    out = tmp_path / "out.csv"
    table.save(out)
    read = np.genfromtxt(out, names=True, delimiter=",", dtype=None, encoding="utf-8")
    assert np.array_equal(read["x"], table["x"], equal_nan=True)
    assert isinstance(table, Table)
