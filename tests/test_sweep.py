"""The sweep engine: the same table however it was come by, and nothing lost or done twice."""

from __future__ import annotations

import csv
import errno
import gc
import hashlib
import importlib
import json
import math
import os
import pickle
import signal
import sqlite3
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.tables import table_of
from theory.parameters import MissingPackageError, ParameterError
from verification.execution import columns
from verification.execution import sweep as sweeping
from verification.execution import table as tables
from verification.execution.columns import column_of, on_disk, python_rows
from verification.execution.files import FileError, write_json
from verification.execution.metadata import COMMAND_LINE, Code, Metadata
from verification.execution.points import Grid, Point, coordinates, digest_of_points, points_of
from verification.execution.record import Record
from verification.execution.store import Store
from verification.execution.sweep import SweepError, part_path, sweep
from verification.execution.table import Table, load_table, record_path, zarr_writer
from verification.execution.task import parameters_of
from verification.runs.trajectory import RunStatus

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER))  # inherited by spawned processes
sweep_example = importlib.import_module("sweep_example")
POINTS, Slow, failing = sweep_example.POINTS, sweep_example.Slow, sweep_example.failing


EXPECTED = {signal.SIGINT: b"KeyboardInterrupt", signal.SIGTERM: b"Terminated"}


def _stored(out: Path) -> list[str]:
    """Return the keys of what is stored for a table."""
    with sqlite3.connect(part_path(out)) as file:
        keys = [key for (key,) in file.execute("SELECT key FROM results")]
    file.close()
    return keys


def _rows(path: Path) -> list[str]:
    """Return the table without its comments, which name the log of the run."""
    text = path.read_text(encoding="utf-8")
    return [line for line in text.splitlines() if not line.startswith("#")]


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


def _interrupted(task: Any, points: Any, **options: Any) -> None:
    """Leave the store of a sweep that was interrupted after half of the points."""

    def stop(done: float) -> None:
        if done == 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(task, points, progress=stop, **options)


@pytest.fixture
def whole(tmp_path: Path) -> list[str]:
    """Return the CSV of a sweep that was never disturbed."""
    out = tmp_path / "whole.csv"
    sweep(Slow(str(tmp_path / "whole.log")), POINTS, out=out, workers=1)
    return _rows(out)


def test_one_worker_two_workers_and_any_executor_give_the_same_bytes(
    tmp_path: Path, whole: list[str]
) -> None:
    task = Slow(str(tmp_path / "log"))
    two = tmp_path / "two.csv"
    sweep(task, POINTS, out=two, workers=2)
    assert _rows(two) == whole
    threads = tmp_path / "threads.csv"
    with ThreadPoolExecutor(3) as executor:
        sweep(task, POINTS, out=threads, executor=executor)
        assert executor.submit(int, "1").result() == 1  # left open
    assert _rows(threads) == whole
    assert not part_path(two).exists()


@pytest.mark.parametrize("workers", [1, 2])
def test_a_killed_sweep_is_resumed_with_nothing_lost_and_nothing_twice(
    workers: int, tmp_path: Path, whole: list[str]
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    victim = subprocess.Popen(_command(out, log, workers), cwd=FOLDER)
    deadline = time.monotonic() + 120  # a guard only: two cores may be busy
    while len(_computed(log)) < 6:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.kill(victim.pid, signal.SIGKILL)
    victim.wait()
    time.sleep(0.2)
    before = _computed(log)
    stored = len(_stored(out))
    # What was computed but not yet handed over is lost: a point a worker, and one on its way.
    assert len(before) - 2 * workers <= stored <= len(before) < len(POINTS)
    time.sleep(0.3)
    assert _computed(log) == before
    assert not _alive(log), "a worker lives on without its parent"
    table = sweep(Slow(str(log), 0.1), POINTS, out=out, workers=workers, resume=True)
    assert _rows(out) == whole
    assert table.resumed == stored
    # only points that were not yet in the store are computed again
    assert len(_computed(log)) == len(before) + len(POINTS) - stored
    assert not part_path(out).exists()


@pytest.mark.parametrize(
    ("task", "points", "named"),
    [
        (Slow("log", factor=2.0), POINTS, "parameters.factor"),
        (Slow("log"), POINTS[:-1], "points.count"),
        (failing, POINTS, "function: sweep_example.Slow there"),
    ],
)
def test_the_store_of_another_sweep_is_refused_and_left_alone(
    task: object,
    points: tuple[Point, ...],
    named: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    out = tmp_path / "out.csv"
    _interrupted(Slow("log"), POINTS, out=out, workers=1)
    before = part_path(out).read_bytes()
    with pytest.raises(ParameterError, match=named) as caught:
        sweep(task, points, out=out, workers=1, resume=True)  # type: ignore[arg-type]
    assert caught.value.remedy
    assert part_path(out).read_bytes() == before


def test_a_store_is_not_overwritten_unasked_nor_is_a_file_that_is_none(tmp_path: Path) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    _interrupted(Slow(str(log)), POINTS, out=out, workers=1)
    with pytest.raises(ParameterError, match="--resume"):
        sweep(Slow(str(log)), POINTS, out=out, workers=1)
    for text in ("a letter\n", "a longer letter" * 1000, '{"task": 1}\n'):
        part_path(out).write_text(text, encoding="ascii")
        with pytest.raises(ParameterError, match="unreadable"):
            sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True)
        assert part_path(out).read_text(encoding="ascii") == text


def test_two_sweeps_do_not_write_one_file(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"

    def second(done: float) -> None:
        if done == 0.5:
            with pytest.raises(FileError, match="in use"):
                sweep(Slow(str(tmp_path / "log")), POINTS, out=out, workers=1, resume=True)

    sweep(Slow(str(tmp_path / "log")), POINTS, out=out, workers=1, progress=second)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_failing_point_is_named_and_the_others_are_kept(workers: int, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    points = {"x": range(1, 8)}
    with pytest.raises(SweepError, match=r"Point\(x=2\) and at 1 more.*no such point") as caught:
        sweep(failing, points, out=out, workers=workers)
    assert [point["x"] for point, _ in caught.value.failures] == [2, 5]
    assert set(_stored(out)) == {"0", "2", "3", "5", "6"}
    assert not out.exists()


def test_a_point_that_kills_its_worker_is_named_and_the_others_are_kept(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    with pytest.raises(SweepError, match=r"Point\(x=4\) could not be computed.*killed") as caught:
        sweep(sweep_example.dying, {"x": range(1, 8)}, out=out, workers=2)
    assert [point["x"] for point, _ in caught.value.failures] == [4]
    assert set(_stored(out)) == {"0", "1", "2", "4", "5", "6"}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_the_workers_and_keeps_what_is_done(
    number: signal.Signals, tmp_path: Path, whole: list[str]
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    runner = subprocess.Popen(
        _command(out, log, 2), cwd=FOLDER, stderr=subprocess.PIPE, start_new_session=True
    )
    deadline = time.monotonic() + 120
    while len(_computed(log)) < 4:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    if number == signal.SIGINT:
        os.killpg(runner.pid, number)  # as Ctrl-C does: parent and workers
    else:
        os.kill(runner.pid, number)
    assert EXPECTED[number] in runner.communicate(timeout=10)[1]
    before = _computed(log)
    time.sleep(0.3)
    assert _computed(log) == before
    assert not _alive(log), "a worker lives on"
    assert not out.exists()
    sweep(Slow(str(log), 0.1), POINTS, out=out, workers=1, resume=True)
    assert _rows(out) == whole


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
    frame = pandas.read_csv(out, comment="#")
    # the last digit is lost by the reader unless it is asked for it
    assert frame["value"].to_numpy() == pytest.approx(table["value"], rel=1e-15)
    assert (frame["label"] == table["label"]).all()
    pytest.importorskip("xarray")
    cube = frame.set_index(["x", "y"]).to_xarray()
    assert cube["value"].shape == (10, 2)


def test_a_finished_sweep_is_not_computed_again_unless_its_file_was_changed(
    tmp_path: Path, whole: list[str]
) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    first = sweep(Slow(str(log)), POINTS, out=out, workers=1)
    again = sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True)
    assert len(_computed(log)) == len(POINTS)
    assert list(again.rows()) == list(first.rows())
    assert _rows(out) == whole
    assert {name: column.dtype for name, column in again.columns().items()} == {
        name: column.dtype for name, column in first.columns().items()
    }
    out.write_bytes(out.read_bytes().replace(b"small", b"large", 1))
    sweep(Slow(str(log)), POINTS, out=out, workers=1, resume=True)
    assert len(_computed(log)) == 2 * len(POINTS)
    assert _rows(out) == whole


def test_a_finished_sweep_is_computed_again_if_it_is_not_resumed(tmp_path: Path) -> None:
    out, log = tmp_path / "out.csv", tmp_path / "log"
    for times in (1, 2):
        sweep(Slow(str(log)), POINTS[:2], out=out, workers=1)
        assert len(_computed(log)) == 2 * times


@pytest.mark.parametrize(
    ("resume", "part", "dims"),
    [(True, False, {"value": "n"}), (True, False, None), (True, True, None), (False, False, None)],
)
def test_a_finished_table_is_looked_for_on_request_unless_a_part_is_left(
    resume: bool,
    part: bool,
    dims: dict[str, str] | None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    there = sweep(_square, {"x": [1.0, 2.0]}, workers=1)
    monkeypatch.setattr(sweeping, "_finished", lambda *given: asked.append(given) or there)
    out, options = tmp_path / "out.csv", {"workers": 1, "dims": dims, "resume": resume}
    if part:
        assert there.metadata is not None
        with Store(part_path(out), sweeping._identity(there.metadata), resume=False) as store:
            store.add("0", [("value", 1.0)])
    found = sweep(_square, {"x": [1.0, 2.0]}, out=out, **options)  # type: ignore[arg-type]
    read = resume and not part
    assert (found is there, len(asked)) == (read, read)
    assert found.resumed == (1 if part else 0)
    assert found["value"].tolist() == [1.0, 4.0]
    for where, metadata, names in asked:
        assert (where, names) == (out, dims or {})
        assert metadata.parameters == there.metadata.parameters  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("given", "part", "looked_for"),
    [({}, False, 0), ({"resume": False}, False, 0), ({"resume": True}, False, 1),
     ({"resume": True}, True, 0), ({}, True, 0)],
)  # fmt: skip
def test_what_is_there_is_continued_on_request_only_and_a_part_before_a_table(
    given: dict[str, bool],
    part: bool,
    looked_for: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    out, asked = tmp_path / "out.csv", []
    if part:
        part_path(out).touch()

    def opened(path: Path, _: object, *, resume: bool) -> None:
        asked.append((path, resume))
        raise InterruptedError

    monkeypatch.setattr(sweeping, "_metadata", lambda *_, **__: Metadata(command="", parameters={}))
    monkeypatch.setattr(sweeping, "_finished", lambda *_: asked.append("table"))
    monkeypatch.setattr(sweeping, "Store", opened)
    with pytest.raises(InterruptedError):
        sweep(_square, [Point(x=1.0)], out=out, workers=1, **given)
    assert asked == ["table"] * looked_for + [(part_path(out), given.get("resume", False))]


def test_a_table_is_saved_before_its_parts_are_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, done = tmp_path / "out.csv", []

    usual = signal.getsignal(signal.SIGTERM)

    class Kept(nullcontext[None]):
        def read(self) -> list[Any]:
            assert signal.getsignal(signal.SIGTERM) != usual  # a request to end is an interrupt
            return [("0", [("value", 0.5)])]

        def remove(self) -> None:
            done.append("removed")

    monkeypatch.setattr(sweeping, "_metadata", lambda *_, **__: Metadata(command="", parameters={}))
    monkeypatch.setattr(sweeping, "Store", lambda *_, **__: Kept())
    monkeypatch.setattr(Table, "save", lambda _, path: done.append(path))
    assert sweep(_square, [Point(x=1.0)], out=out, workers=1)["value"].tolist() == [0.5]
    assert done == [out, "removed"]
    assert signal.getsignal(signal.SIGTERM) == usual


def test_points_of_a_store_are_those_of_the_sweep_by_their_numbers() -> None:
    keys = ("0", "2", "1", "-1", "01", "one")
    stored: Any = SimpleNamespace(read=lambda: [(key, [("value", 0.5)]) for key in keys])
    found = sweeping._Found(points=points_of([{"x": 1}, {"x": 2}]), out=None, names={})
    assert found.take_from(stored) == 2
    assert found.columns.filled.all()


def test_of_a_result_what_is_no_cell_of_a_table_is_missing_in_its_row() -> None:
    cells: Any = sweeping._Cells(sweep_example.sometimes)
    known = {"count": 3, "odd": True, "reason": 'one, "twice"'}
    assert cells(Point(x=3)) == known | {"basin": None, "never": None}


def test_the_record_names_function_parameters_code_and_versions(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    log = str(tmp_path / "log")
    sweep(Slow(log, factor=3.0), POINTS, out=out, workers=1, command="fronts map")
    record = json.loads(record_path(out).read_text(encoding="utf-8"))
    assert record["command"] == "fronts map"
    comments = [line for line in out.read_text(encoding="utf-8").splitlines() if line[0] == "#"]
    assert comments[0] == "# command: fronts map"
    assert json.loads(comments[1].removeprefix("# parameters: ")) == record["parameters"]
    assert json.loads(comments[2].removeprefix("# versions: ")) == record["versions"]
    assert record["parameters"]["function"] == "sweep_example.Slow"
    assert record["parameters"]["factor"] == 3.0
    assert record["parameters"]["points"]["count"] == 20
    assert record["code"]["modules"] == ["sweep_example"]
    assert {"python", "numpy", "numba", "toolkit"} <= set(record["versions"])
    assert record["table"]["seconds"] > 0


def test_progress_is_the_fraction_done(tmp_path: Path) -> None:
    seen: list[float] = []
    sweep(Slow(str(tmp_path / "log")), POINTS, workers=1, progress=seen.append)
    assert seen == pytest.approx(np.linspace(0.0, 1.0, len(POINTS) + 1))


def test_an_array_by_the_name_of_a_coordinate_is_refused() -> None:
    with pytest.raises(ParameterError, match="the coordinate of the same name"):
        sweep(lambda p: {"x": np.ones(2)}, {"x": [1.0]}, workers=1)


def test_a_result_that_differs_from_its_coordinate_by_a_rounding_is_refused() -> None:
    """As a number of the same kind 2^53 + 1 would be 2^53."""
    with pytest.raises(ParameterError, match="the coordinate of the same name"):
        sweeping._Found(points=[{"x": 2**53 + 1}], out=None, names={}).put(0, {"x": float(2**53)})


def test_a_sweep_without_a_file_leaves_it_to_others_what_ends_the_process() -> None:
    """With one, a signal to end is an interrupt, at which what has been found is kept."""
    given = signal.getsignal(signal.SIGTERM)
    seen: list[Any] = []

    def asked(_: Point) -> float:
        seen.append(signal.getsignal(signal.SIGTERM))
        return 1.0

    sweep(asked, {"x": [1.0]}, workers=1)
    assert seen == [given]


def test_a_chunk_of_an_array_is_as_large_as_it_may_be() -> None:
    most = tables.CHUNK_BYTES // 8
    for shape in ((10**8,), (10**8, 1), (1, 10**8)):
        assert math.prod(tables.chunk_shape(shape, 8)) == most


def test_points_that_are_known_are_done_from_the_beginning() -> None:
    seen: list[float] = []
    found = sweeping._Found(points=points_of([{"x": 1}]), out=None, names={})
    found.put(0, {"value": 0.5})
    one: Any = sweeping._Cells(lambda point: point["x"])
    options: Any = dict.fromkeys(("store", "workers", "executor"))
    assert sweeping._compute(one, found, **options, progress=seen.append) == {}
    assert seen == [1.0]
    seen.clear()
    half = sweeping._Found(points=points_of([{"x": 1}, {"x": 2}]), out=None, names={})
    half.put(0, {"value": 1.0})
    assert sweeping._compute(one, half, **options, progress=seen.append) == {}
    assert seen == [0.5, 1.0]
    seen.clear()
    for x in (1, 2):
        whole = sweeping._Found(points=points_of([{"x": 1}, {"x": 2}]), out=None, names={})
        fails: Any = sweeping._Cells(lambda point, x=x: 1.0 / (point["x"] - x))  # type: ignore[misc]
        assert [*sweeping._compute(fails, whole, **options, progress=seen.append)] == [x - 1]
        assert seen == [0.0, 0.5, 1.0]  # what has failed is done, too, also at the end
        seen.clear()


def test_axes_without_a_value_make_a_table_without_axes() -> None:
    empty = sweep(_square, {"x": []}, workers=1)
    assert (len(empty), empty.axes) == (0, ())


def test_an_array_of_no_dimension_is_a_number() -> None:
    assert columns.plain(np.array(1.5)) == 1.5
    assert columns.plain(np.array("word")) == "word"


def test_points_may_be_axes_and_results_one_number() -> None:
    table = sweep(lambda p: p["x"] * p["y"], {"x": np.arange(3), "y": [1.5, 2.0]}, workers=1)
    assert table["value"] == pytest.approx([0, 0, 1.5, 2, 3, 4])


def test_the_points_of_axes_are_those_asked_for_one_by_one() -> None:
    """Also sent to another process, and in the digest, which is that of their JSON."""
    axes = Grid({"eta": [0.1, 2, True], "c": ['x "y"', math.inf], "n": [0]})
    asked = [axes[index] for index in range(len(axes))]
    assert list(axes) == asked == pickle.loads(pickle.dumps(asked))
    assert dict(asked[3]) == {"eta": 2, "c": math.inf, "n": 0}
    assert axes.distinct_axes == ("eta", "c", "n")
    for values in ([1, 2, 1], [math.nan, 1.0]):
        assert Grid({"eta": [0.1, 2], "c": values}).distinct_axes == ()
    written = json.dumps([[list(item) for item in point.items()] for point in asked])
    for points in (axes, asked):
        assert digest_of_points(points) == hashlib.sha256(written.encode()).hexdigest()
    assert digest_of_points(Grid({"c": []})) == digest_of_points([])


def test_an_axis_with_a_value_that_is_no_number_makes_no_grid() -> None:
    table = sweep(_double, {"x": [math.nan, 1.0], "y": [1, 2]}, workers=1)
    assert table.axes == ()
    assert dict(table.to_xarray().sizes) == {"row": 4}


def _double(point: Point) -> dict[str, float]:
    return {"double": 2.0 * point.number("y")}


def test_a_point_by_itself_is_one_row_and_no_grid() -> None:
    axes = {"x": [2.0], "word": ["a"]}
    (point,) = Grid(axes)
    one, grid = (sweep(lambda p: 2 * p["x"], points, workers=1) for points in (point, axes))
    assert (one["value"].tolist(), grid["value"].tolist()) == ([4.0], [4.0])
    assert (one.axes, grid.axes) == ((), ("x", "word"))


def test_a_function_without_a_name_is_computed_here_unless_more_workers_are_asked_for() -> None:
    for resume in (False, True):  # which has nothing to go on from without a file
        assert len(sweep(lambda p: p["x"], {"x": range(4)}, resume=resume)) == 4
    with pytest.raises(ParameterError, match="importable by its name") as caught:
        sweep(lambda p: p["x"], {"x": range(4)}, workers=2)
    assert "workers=1" in caught.value.remedy


def test_what_a_function_captures_and_does_belongs_to_the_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out.csv"

    def times(factor: float) -> Callable[[Point], float]:
        return lambda point: factor * point.number("x")

    def values(function: Callable[[Point], float]) -> list[float]:
        return sweep(function, {"x": [1.0]}, out=out, resume=True, workers=1)["value"].tolist()

    assert [values(times(factor)) for factor in (2.0, 3.0)] == [[2.0], [3.0]]
    # typed into a session: there is no file, and the code itself is compared
    monkeypatch.delattr(sys.modules["__main__"], "__file__", raising=False)
    for text in ("2 * point['x']", "2 + point['x']"):
        scope: dict[str, Any] = {"__name__": "__main__"}
        exec(f"def typed(point):\n    return {text}", scope)
        assert values(scope["typed"]) == [eval(text, {"point": {"x": 1.0}})]


def test_words_that_a_reader_would_misread_are_refused() -> None:
    for word in ("", " a", "a#b", "a\nb"):
        with pytest.raises(ValueError, match="every reader of CSV"):
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


def test_a_zarr_store_holds_the_table_over_its_axes_and_is_resumed(tmp_path: Path) -> None:
    pytest.importorskip("zarr")
    xarray = pytest.importorskip("xarray")
    out = tmp_path / "map.zarr"
    axes = {"x": [1, 3, 2], "y": [0.5, 0.25]}
    task = sweep_example.Area(str(tmp_path / "log"))

    _interrupted(task, axes, out=out, workers=1)
    table = sweep(task, axes, out=out, workers=1, resume=True)
    assert table.resumed == 3
    assert len(_computed(tmp_path / "log")) == 6
    data = xarray.open_zarr(out).load()
    assert data["area"].dims == ("x", "y")
    assert data["area"].values.tolist() == [[0.5, 0.25], [1.5, 0.75], [1.0, 0.5]]
    assert data["side"].sel(x=3, y=0.5).item() == "high"
    assert "versions" in json.loads(data.attrs["provenance"])
    again = sweep(task, axes, out=out, workers=1, resume=True)  # taken from the store
    assert len(_computed(tmp_path / "log")) == 6
    assert list(again.rows()) == list(table.rows())
    assert again.axes == ("x", "y")
    sweep(task, {"x": [5], "y": [2.0]}, out=out, workers=1)  # takes the place of another store
    assert xarray.open_zarr(out)["area"].values.tolist() == [[10.0]]
    assert sorted(each.name for each in tmp_path.iterdir()) == ["log", "map.zarr", "map.zarr.json"]


def test_a_changed_zarr_store_is_computed_again_and_other_folders_are_left(tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr")
    out, log = tmp_path / "map.zarr", tmp_path / "log"
    task, axes = sweep_example.Area(str(log)), {"x": [1, 2], "y": [3.0]}
    sweep(task, axes, out=out, workers=1)
    zarr.open_group(out)["area"][0, 0] = 7.0
    table = sweep(task, axes, out=out, workers=1, resume=True)
    assert table["area"].tolist() == [3.0, 6.0]
    assert len(_computed(log)) == 4
    other = tmp_path / "folder.zarr"
    other.mkdir()
    with pytest.raises(FileError, match="is a folder"):
        sweep(task, axes, out=other, workers=1)


def _shapes_by_a_loop() -> dict[str, list[object]]:
    """Return what `sweep_example.Shapes` gives, by a plain loop over x, then y."""
    profile, counts, label = [], [], []
    for x in range(1, 11):
        for y in (1.5, 2.5):
            profile.append([math.sin(x * n) / y for n in (1, 2, 3)])
            counts.append([[x, 1], [2, 15 if y == 1.5 else 25]])
            label.append("large" if x > 5 else "small")
    return {"profile": profile, "counts": counts, "label": label}


@pytest.mark.parametrize(("ending", "workers"), [(".zarr", 1), (".npz", 1), (".zarr", 2)])
def test_arrays_of_points_are_those_of_a_loop_through_a_stop_and_a_file(
    ending: str, workers: int, tmp_path: Path
) -> None:
    pytest.importorskip("zarr" if ending == ".zarr" else "numpy")
    xarray = pytest.importorskip("xarray")
    out, log = tmp_path / f"out{ending}", tmp_path / "log"
    task, dims = sweep_example.Shapes(str(log)), {"profile": "site", "counts": ("from_", "to")}
    _interrupted(task, POINTS, out=out, workers=workers, dims=dims)
    table = sweep(task, POINTS, out=out, workers=workers, dims=dims, resume=True)
    assert table.resumed == 10
    again = sweep(task, POINTS, out=out, workers=workers, dims={"profile": "n"}, resume=True)
    for found in (table, again):
        for name, expected in _shapes_by_a_loop().items():
            # numpy's sine need not be that of the C library to the last bit
            assert (
                np.allclose(found[name], expected, rtol=1e-15, atol=0)
                if (name == "profile")
                else found[name].tolist() == expected
            )
    assert table["profile"].tobytes() == again["profile"].tobytes()
    assert table["counts"].dtype == np.int64
    cube = table.to_xarray()
    assert cube["profile"].dims == ("x", "y", "site")
    assert cube["counts"].dims == ("x", "y", "from_", "to")
    assert cube["profile"].sel(x=4, y=2.5, site=1) == pytest.approx(math.sin(8) / 2.5, rel=1e-15)
    assert again.to_xarray()["counts"].dims == ("x", "y", "counts_0", "counts_1")
    if ending == ".zarr":
        assert (
            xarray.open_zarr(out)
            .load()["profile"]
            .identical(cube["profile"].assign_attrs(xarray.open_zarr(out)["profile"].attrs))
        )
    else:
        with np.load(out) as file:
            assert (file["profile"] == table["profile"]).all()
            assert "versions" in json.loads(str(file["provenance"]))


@pytest.mark.parametrize("axes", [{"x": range(32)}, {"x": [1], "y": range(32)}])
def test_arrays_larger_than_memory_are_written_and_read_by_chunks(
    axes: dict[str, object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 16 MB a quarter at most is ever in memory: zarr has some 25 chunks in hand."""
    zarr, out = pytest.importorskip("zarr"), tmp_path / "out.zarr"
    cells, size, chunk = 65_536, 32 * 65_536 * 8, 1 << 17
    monkeypatch.setattr("verification.execution.table.CHUNK_BYTES", chunk)

    def wave(point: Point) -> dict[str, object]:
        return {"wave": np.sin(sum(point.values()) + np.arange(cells))}

    for resume in (False, True):  # what is imported is not counted
        sweep(wave, {"x": [0]}, out=tmp_path / "imports.zarr", workers=1, resume=resume)
    searches = gc.get_threshold()
    gc.set_threshold(700, 10, 10)  # as anywhere but in these tests, see conftest.py
    tracemalloc.start()
    try:
        first = sweep(wave, axes, out=out, workers=1)
        again = sweep(wave, axes, out=out, workers=1, resume=True)
        assert tracemalloc.get_traced_memory()[1] < size / 4
    finally:
        tracemalloc.stop()
        gc.set_threshold(*searches)
    assert again.resumed == 32
    assert first["wave"].nbytes == size
    for table in (first, again):
        for place in (0, 17, 31):
            row = sum(int(table[name][place]) for name in axes)
            assert np.array_equal(table["wave"][place], np.sin(row + np.arange(cells)))
    stored = zarr.open_group(out)["wave"]
    assert np.prod(stored.chunks) * 8 == chunk


def test_a_disk_without_room_for_the_arrays_is_said_before_they_are_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)
    task = sweep_example.Shapes(str(tmp_path / "log"))
    with pytest.raises(FileError, match="free some space"):
        sweep(task, POINTS, out=tmp_path / "out.npz", workers=1)
    assert len(_computed(tmp_path / "log")) == 1


def test_arrays_of_several_shapes_are_refused_with_both_shapes(tmp_path: Path) -> None:
    task = sweep_example.Shapes(str(tmp_path / "log"), ragged=True)
    with pytest.raises(ParameterError, match=r"shape of profile = \(4,\) .* \(3,\)") as caught:
        sweep(task, POINTS, out=tmp_path / "out.npz", workers=1)
    assert "\n" not in str(caught.value)
    assert _stored(tmp_path / "out.npz") == [str(n) for n in range(5)]  # up to that point


def test_arrays_have_no_place_in_csv_nor_in_a_data_frame(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    task = sweep_example.Shapes(str(tmp_path / "log"))
    with pytest.raises(ParameterError, match=r"column profile .* CSV.*\.zarr or \.npz"):
        sweep(task, POINTS, out=tmp_path / "out.csv", workers=1)
    assert [path.name for path in tmp_path.iterdir()] == ["log"]  # nothing to go on from
    table = sweep(task, POINTS, workers=1)
    for use in (table.to_pandas, table.columns):
        with pytest.raises(ParameterError, match="column profile"):
            use()


@pytest.mark.parametrize(
    ("value", "said"),
    [([1, [2, 3]], "array of real numbers"), (np.array([1j]), "complex"), ([], "real numbers"),
     (np.array(["a"]), "real numbers"), (2**63, "64 bits"), (1j, "cannot hold")],
)  # fmt: skip
def test_what_no_column_holds_is_one_sentence(value: object, said: str) -> None:
    with pytest.raises((ParameterError, SweepError), match=said) as caught:
        sweep(lambda _: {"value": value}, {"x": [1]}, workers=1)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("dims", "said"),
    [({"profile": ("a", "b")}, "1 different"), ({"label": "site"}, "dims = label"),
     ({"profile": "x"}, "no column"), ({"profile": "row"}, "no column"),
     ({"profile": "my site"}, "letters, digits"), ({"profile": ("a", "a")}, "1 different"),
     ({"counts": ("n", "m", "n")}, "2 different"), ({"counts": ("n", "n")}, "2 different"),
     ({"profile": "n", "counts": ("n", "m")}, "of one length")],
)  # fmt: skip
def test_dimensions_that_do_not_fit_are_refused(
    dims: dict[str, Any], said: str, tmp_path: Path
) -> None:
    task = sweep_example.Shapes(str(tmp_path / "log"))
    with pytest.raises(ParameterError, match=said):
        sweep(task, POINTS, workers=1, dims=dims)
    assert len(_computed(tmp_path / "log")) == 1  # before the others are computed


@pytest.mark.parametrize("order", [(1, 2.5, True), (2.5, True, 1), (True, 1, 2.5)])
def test_the_type_of_a_column_does_not_depend_on_the_order(order: tuple[Any, ...]) -> None:
    table = table_of([{"value": value} for value in order])
    assert table["value"].dtype == np.float64
    assert table["value"].tolist() == [float(value) for value in order]
    ints = table_of([{"value": 2**53 + 1}, {"value": -5}])["value"]
    assert ints.dtype == np.int64
    assert ints.tolist() == [2**53 + 1, -5]


@pytest.mark.parametrize("file", [None, "out.csv", "out.npz"])
def test_memory_grows_by_the_columns_and_no_more(file: str | None, tmp_path: Path) -> None:
    """A row has 62 bytes in its columns: 3 numbers, 8 letters of 4 bytes, and a few to find it."""
    out = None if file is None else tmp_path / file
    axes = {"x": list(range(100)), "y": list(range(1, 61))}

    def task(point: Point) -> dict[str, float | str]:
        return {"value": point.number("x") / point.number("y"), "label": "breather"}

    few = {"x": axes["x"][:10], "y": axes["y"]}
    peaks = []
    for points in (few, few, axes):  # the first one loads what is loaded once
        tracemalloc.start()
        sweep(task, points, workers=1, out=out)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    growth = (peaks[2] - peaks[1]) / (6000 - 600)
    assert growth < 2 * 62  # columns, and once more while words are written out


def test_rows_are_all_that_there_are_in_their_order() -> None:
    """Also where they are too many to be lists at once, and where there is none."""
    c = np.linspace(0.0, 1.0, 3000)
    table = Table(arrays={"c": c, "n": np.arange(3000)})
    assert list(python_rows(table.arrays)) == list(zip(c.tolist(), range(3000), strict=True))
    assert [row["n"] for row in table.rows()] == list(range(3000))
    assert (len(table), len(Table(arrays={})), list(Table(arrays={}).rows())) == (3000, 0, [])


def test_an_array_beside_numbers_is_refused_as_are_numbers_beside_arrays() -> None:
    for cells in ([1.0, np.array([1.0])], [np.array([1.0]), 1.0], [np.ones(2), np.ones((2, 1))]):
        with pytest.raises(ParameterError, match="shape of v"):
            column_of("v", cells)
    assert column_of("v", [np.ones(2), np.arange(2)]).tolist() == [[1.0, 1.0], [0.0, 1.0]]


@pytest.mark.parametrize("name", ["out.csv", "out.npz", "out.zarr"])
def test_what_is_none_at_some_points_of_a_result_is_missing_there(
    name: str, tmp_path: Path
) -> None:
    """At 0, where nothing is known yet, at 2, and a list at 3; the sweep is resumed from its part,
    and its file is read again."""
    out, points = tmp_path / name, {"x": [0, 1, 2, 3]}
    function = sweep_example.sometimes
    with pytest.raises(SweepError, match="not yet"):
        sweep(sweep_example.Later(str(tmp_path / "mark")), points, out=out, workers=1)
    (tmp_path / "mark").touch()
    table = sweep(
        sweep_example.Later(str(tmp_path / "mark")), points, out=out, resume=True, workers=1
    )
    assert table.resumed == 3
    nan = math.nan
    expected = {
        "count": [nan, 1.0, nan, 3.0],
        "odd": [nan, 1.0, nan, 1.0],
        "reason": ["", 'one, "twice"', "", 'one, "twice"'],
    }
    read = load_table(out)
    assert read is not None
    for found in (table, read, sweep(function, points, workers=1)):
        assert list(found.arrays) == ["x", *expected]  # what is a list or nothing has no column
        for column, values in expected.items():
            np.testing.assert_array_equal(found[column], np.array(values))
    if name == "out.csv":
        with out.open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.reader(file) if not row[0].startswith("#")]
        assert rows[1:3] == [["0", "nan", "nan", ""], ["1", "1.0", "1.0", 'one, "twice"']]


def test_a_sweep_crosses_where_a_number_of_a_result_does_not_exist() -> None:
    """c_pin exists below η = 2/25 and c_retreat above."""
    table = sweep(sweep_example.kinetic, {"c": [0.5], "eta": [0.03, 0.1]}, workers=1)
    for name, (below, above) in {"c_pin": (True, False), "c_retreat": (False, True)}.items():
        assert np.isfinite(table[name]).tolist() == [below, above]
    assert table["status"].tolist() == ["propagating", "pinned"]


def test_coordinates_of_points_are_columns_however_the_points_are_given() -> None:
    listed = points_of([{"c": 1, "label": "a"}, {"c": 2.5, "label": "b"}])
    columns = {name: column.tolist() for name, column in coordinates(listed).items()}
    assert columns == {"c": [1.0, 2.5], "label": ["a", "b"]}
    for none in ([], {}, {"c": []}):
        assert coordinates(points_of(none)) == {}


def _with(cap: Any) -> Any:
    return partial(sweep_example.capped, cap=cap)


def test_sweeps_of_parameters_that_only_compare_as_equal_are_told_apart(tmp_path: Path) -> None:
    out = tmp_path / "t.csv"
    signs = [
        sweep(_with(cap), {"c": [1.0]}, workers=1, out=out, resume=True)["sign"].tolist()
        for cap in (0.0, -0.0, 0, -0.0)
    ]
    assert signs == [[1.0], [-1.0], [1.0], [-1.0]]
    named = [parameters_of(_with(cap))["cap"] for cap in (1 + 2j, [1.0, 2.0], math.inf, "inf")]
    assert len({json.dumps(each, allow_nan=False) for each in named}) == 4
    with Store(tmp_path / "s.part", {"cap": 0.0}, resume=False) as store:
        store.add("0", [])
    with pytest.raises(ParameterError, match=r"cap: 0\.0 there, -0\.0 here"):
        Store(tmp_path / "s.part", {"cap": -0.0}, resume=True)


@pytest.mark.parametrize("cap", [math.inf, -math.inf, math.nan])
def test_the_sweep_of_a_function_that_holds_no_finite_number_is_stored(
    cap: float, tmp_path: Path
) -> None:
    out = tmp_path / "t.csv"
    tables = [sweep(_with(cap), {"c": [1.0]}, workers=1, out=out, resume=True) for _ in range(2)]
    assert tables[0].seconds == tables[1].seconds


def test_an_error_without_a_bound_is_infinite_in_a_sweep_too() -> None:
    table = sweep(sweep_example.unbounded, {"c": [1.0]}, workers=1)
    assert table["error"].tolist() == [math.inf]


@pytest.mark.parametrize("ending", ["csv", "npz", "zarr"])
@pytest.mark.parametrize("points", [[], {"c": []}])
def test_a_sweep_over_no_points_is_an_empty_table_in_every_format(
    points: Any, ending: str, tmp_path: Path
) -> None:
    for package in ("pandas", "xarray", "zarr"):
        pytest.importorskip(package)
    table = sweep(_with(1.0), points, workers=1, out=tmp_path / f"t.{ending}")
    assert (len(table), len(table.to_pandas()), dict(table.to_xarray().sizes)) == (0, 0, {})


@pytest.mark.parametrize("body", [
    None, [], {}, {"kind": "map"}, {"kind": "table", "format": 3}, {"kind": "map", "format": 2},
])  # fmt: skip
def test_what_is_no_record_is_one_sentence(body: object) -> None:
    with pytest.raises(ParameterError, match="record"):
        Record.from_dict(body, "map")


def test_a_record_is_read_as_its_kind_and_format_only_and_as_it_was_written(
    tmp_path: Path,
) -> None:
    with pytest.raises(ValueError, match="JSON"):  # which has no such number
        Record(kind="map", content={"c": [math.nan]}).to_dict()
    with pytest.raises(ValueError, match="JSON"):
        write_json(tmp_path / "out.json", {"c": math.nan})
    Record(kind="map", content={"unit": "η"}).save(tmp_path / "out.json")
    assert '"η"' in (tmp_path / "out.json").read_text("utf-8")
    written = Record(kind="map", content={"c": [0.5, 1e-300]}).to_dict()
    assert Record.from_dict(written, "map").content == {"c": [0.5, 1e-300]}
    for kind, change, said in (
        ("table", {}, "of the kind 'table' in format"),
        ("map", {"format": 2}, "of the kind 'map' in format"),
        ("map", {"c": [0.5, 0.0]}, "as it was written"),
    ):
        with pytest.raises(ParameterError, match=f"must be {said}"):
            Record.from_dict(written | change, kind)


def test_a_finished_sweep_takes_other_names_of_dimensions(tmp_path: Path) -> None:
    def pair(point: Point) -> dict[str, object]:
        return {"pair": np.array([point["x"], 2 * point.number("x")])}

    def swept(**dims: str) -> Table:
        return sweep(
            pair, {"x": [1, 2]}, out=tmp_path / "out.npz", resume=True, workers=1, dims=dims
        )

    assert [dict(swept(**dims).dims) for dims in ({}, {"pair": "end"}, {})] == [
        {"pair": ("pair_0",)}, {"pair": ("end",)}, {"pair": ("pair_0",)},
    ]  # fmt: skip
    with pytest.raises(ParameterError, match="dims = c"):
        swept(c="end")


def test_a_table_for_zarr_says_that_it_needs_zarr(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("xarray")
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(MissingPackageError, match="zarr"):
        table_of([{"c": 1.0}]).save(tmp_path / "out.zarr")
    assert not (tmp_path / "out.zarr").exists()


def test_arrays_of_a_zarr_store_are_read_back_however_they_are_cut(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("zarr")
    pytest.importorskip("xarray")
    monkeypatch.setattr("verification.execution.table.CHUNK_BYTES", 40)  # five numbers
    cells = np.arange(5 * 7.0).reshape(5, 7)
    written = table_of([{"c": c, "wave": row} for c, row in zip(range(5), cells, strict=True)])
    written.save(tmp_path / "out.zarr")
    read = load_table(tmp_path / "out.zarr")
    assert np.array_equal(read["wave"], cells)
    assert np.array_equal(read["c"], np.arange(5))


@pytest.mark.parametrize("ending", [".npz", ".zarr"])
def test_a_damaged_table_is_none_or_what_it_was(ending: str, tmp_path: Path) -> None:
    """Every part of the file cut, emptied, overwritten or with one bit changed."""
    pytest.importorskip("zarr" if ending == ".zarr" else "numpy")
    rows = [{"c": float(n), "word": "front", "n": n, "wave": n * np.arange(4.0)} for n in range(20)]
    path, table, rng = tmp_path / f"x{ending}", table_of(rows), np.random.default_rng(5)
    table.save(path)
    parts = sorted(each for each in path.rglob("*") if each.is_file()) or [path]
    refused = 0
    for part in parts:
        content = part.read_bytes()
        place = int(rng.integers(len(content)))
        flipped = bytearray(content)
        flipped[place] ^= 1
        for damaged in (b"", content[:place], bytes(flipped), rng.bytes(len(content))):
            part.write_bytes(damaged)
            found = load_table(path)
            refused += found is None
            if found is not None:
                assert all(
                    np.array_equal(found.arrays[name], table.arrays[name]) for name in rows[0]
                )
        part.write_bytes(content)
    assert refused > len(parts)
    assert load_table(path) is not None


def test_a_store_that_was_resumed_stays_where_a_later_result_fits_no_table(tmp_path: Path) -> None:
    """One result of an earlier run, one more, and then one of other names."""
    out = tmp_path / "out.csv"

    def stopped(fraction: float) -> None:
        if fraction >= 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(_other_names_at_the_end, {"x": [0, 1, 2]}, out=out, workers=1, progress=stopped)
    assert _stored(out) == ["0"]
    with pytest.raises(ParameterError):
        sweep(_other_names_at_the_end, {"x": [0, 1, 2]}, out=out, workers=1, resume=True)
    assert sorted(_stored(out)) == ["0", "1"]


def _other_names_at_the_end(point: Point) -> dict[str, float]:
    return {"there" if point["x"] == 2 else "here": 1.0}


def test_the_columns_of_a_table_cannot_be_written_to() -> None:
    table = sweep(lambda point: {"square": point["x"] ** 2}, {"x": [1, 2]}, workers=1)
    for array in (table["x"], table["square"], columns.read_only(np.zeros(2))):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 7


def test_a_flat_column_holds_numbers_and_words_and_no_arrays() -> None:
    flat = columns.Columns(1, flat=True)
    flat.put(0, {"number": 1.5, "word": "a"})
    assert {name: cells.tolist() for name, cells in flat.arrays().items()} == {
        "number": [1.5], "word": ["a"],
    }  # fmt: skip
    with pytest.raises(ParameterError, match=r"column pair = an array of shape \(2,\)"):
        columns.Columns(1, flat=True).put(0, {"pair": np.ones(2)})


def test_columns_that_are_filled_and_coordinates_cannot_be_written_to() -> None:
    filled = columns.Columns(1)
    filled.put(0, {"number": 1.5, "word": "a", "pair": np.ones(2)})
    grid, listed = (coordinates(points_of(points)) for points in ({"x": [1]}, [{"x": 1}]))
    for array in (*filled.arrays().values(), grid["x"], listed["x"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 7


def test_a_table_of_a_function_without_a_known_code_is_no_table_of_another(tmp_path: Path) -> None:
    """A function that holds an object of which nothing can be told is computed without a file."""
    untold = sweep(partial(_second_power, held=object()), {"x": [1, 2]}, workers=1)
    assert untold.metadata is not None
    assert untold.metadata.code is None
    untold.save(tmp_path / "out.csv")
    table = sweep(_second_power, {"x": [3]}, out=tmp_path / "out.csv", resume=True, workers=1)
    assert (table["value"].tolist(), table.resumed) == ([9], 0)


def _second_power(point: Point, held: object = None) -> Any:
    return point["x"] ** 2


def test_a_zarr_store_may_be_put_where_nothing_is(tmp_path: Path) -> None:
    xr = pytest.importorskip("xarray")
    pytest.importorskip("zarr")
    zarr_writer(xr.Dataset({"c": ("n", [1.0, 2.0])}), {})(tmp_path / "out.zarr")
    assert xr.open_zarr(tmp_path / "out.zarr", consolidated=False)["c"].values.tolist() == [1, 2]


@pytest.mark.parametrize("points", [{1: [0.1, 0.2]}, [{1: 0.1}], [{"c": 0.1}, {None: 2.0}]])
def test_coordinates_without_a_name_are_refused(points: Any) -> None:
    with pytest.raises(ParameterError, match="is not a name"):
        points_of(points)


def test_an_array_of_a_point_has_signed_numbers_or_what_they_cannot_hold() -> None:
    for given, kind in (
        (np.array([1, 255], np.uint8), "i"),
        (np.array([1, 2**63 - 1], np.uint64), "i"),
        (np.array([1, 2**63], np.uint64), "f"),
        ([True, False], "b"),
        ((1, 2.5), "f"),
    ):
        found = columns.cell_of(given)
        assert isinstance(found, np.ndarray)
        assert found.dtype.kind == kind
        assert found.tolist() == np.asarray(given).tolist()
    assert columns.cell_of(RunStatus.RESOLVED) == "resolved"  # a word, though not a plain one


def test_arrays_are_on_disk_where_a_folder_is_named_and_numbers_never(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders: list[Path] = []
    monkeypatch.setattr(
        columns, "on_disk", lambda shape, kind, folder: folders.append(folder) or np.zeros(shape)
    )
    for cell, folder, expected in (
        (np.ones(3), tmp_path, [tmp_path]),
        (np.ones(3), None, []),
        (1.0, tmp_path, []),
        (1.0, None, []),
    ):
        folders.clear()
        columns._Column("a", 2, folder=folder).put(0, cell)
        assert folders == expected


def test_arrays_on_disk_are_zeros_where_the_system_reserves_no_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr(os, "posix_fallocate", raising=False)
    found = on_disk((3, 5), "i4", tmp_path)
    assert found.tolist() == [[0] * 5] * 3
    found[2, 4] = 7
    assert found.sum() == 7


def test_a_failure_says_how_many_other_points_failed_if_any_did() -> None:
    failed = [(Point(c=float(c)), ValueError("odd")) for c in range(3)]
    assert str(sweeping._failed(failed[:1])) == (
        "Point(c=0.0) could not be computed: ValueError: odd"
    )
    assert str(sweeping._failed(failed)).startswith("Point(c=0.0) and at 2 more could")


def test_arrays_of_a_zarr_store_are_copied_chunk_by_chunk(tmp_path: Path) -> None:
    class Stored:
        shape, dtype, encoding = (4, 6, 5), np.dtype(float), {"chunks": (1, 4, 5)}
        values = np.arange(120.0).reshape(shape)

        def __getitem__(self, chunk: tuple[slice, ...]) -> Any:
            taken.append(self.values[chunk].shape)
            return SimpleNamespace(values=self.values[chunk])

    taken: list[tuple[int, ...]] = []
    found = tables._from_chunks(Stored(), tmp_path, 2)  # type: ignore[arg-type]
    assert np.array_equal(found, Stored.values.reshape(24, 5))
    assert taken == [(1, 4, 5), (1, 2, 5)] * 4


def test_of_a_file_of_arrays_no_object_is_made(tmp_path: Path) -> None:
    path = tmp_path / "table.npz"
    np.savez(path, v=np.array([{}], dtype=object))
    with pytest.raises(ValueError, match="pickle"):
        tables._read(path, {"v": "f"}, 1, ())


def test_mappings_become_points() -> None:
    (point,) = points_of([{"c": np.float64(0.5)}])
    assert isinstance(point, Point)
    assert repr(point) == "Point(c=0.5)"


def test_words_of_a_store_are_words_and_axes_are_coordinates(tmp_path):
    """Some versions of zarr give words back as objects."""
    xarray = pytest.importorskip("xarray")
    words = np.array(["front", "rest"], dtype=object)
    data = xarray.Dataset({"state": ("row", words), "c": ("row", [0.1, 0.2])})
    found = tables._columns_of_zarr(data, tmp_path, ["state", "c"], 2, ())
    assert found["state"].dtype == np.dtype("<U5")
    assert found["state"].tolist() == words.tolist()
    cube = Table(arrays=found, axes=("c",)).to_xarray()
    assert (set(cube.data_vars), set(cube.coords)) == ({"state"}, {"c"})


def _square(point: Point) -> float:
    return point.number("x") ** 2


@pytest.mark.parametrize("stored", [True, False])
def test_a_request_to_end_is_an_interrupt_only_where_something_is_to_be_stored(
    stored: bool, tmp_path: Path
) -> None:
    usual = signal.getsignal(signal.SIGTERM)

    def as_usual(_: Point) -> float:
        return float(signal.getsignal(signal.SIGTERM) == usual)

    out = tmp_path / "out.csv" if stored else None
    assert sweep(as_usual, {"x": [1.0]}, workers=1, out=out)["value"].tolist() == [not stored]


@pytest.mark.parametrize("line", ["", "fronts sweep"])
@pytest.mark.parametrize("given", ["", "mine"])
def test_a_record_without_a_command_names_the_call(given: str, line: str) -> None:
    token = COMMAND_LINE.set(line)
    try:
        found = sweeping._metadata(_square, [Point(x=1.0)], given, needed=False)
    finally:
        COMMAND_LINE.reset(token)
    assert found.command == (given or line or f"sweep({__name__}._square, ...)")


def test_sweeps_are_told_apart_by_their_code_but_not_by_the_command_that_is_named() -> None:
    first, second = (Code(modules=("mine",), digest=digest) for digest in ("0", "1"))
    same, reworded, rewritten, untold = (
        sweeping._identity(Metadata(command=command, parameters={}, code=code))
        for command, code in (("a", first), ("b", first), ("a", second), ("a", None))
    )
    assert same == reworded
    assert same != rewritten
    assert untold not in (same, rewritten)


def test_what_is_computed_is_stored_beside_what_was_found() -> None:
    """How many points are stored says whether a store contains something to continue from."""
    written: list[str] = []
    found = sweeping._Found(points=[Point(x=n) for n in range(3)], out=None, names={})
    found.put(1, {"value": 0.5})
    found.stored = 1
    store: Any = SimpleNamespace(add=lambda key, _: written.append(key))
    cells: Any = lambda point: {"value": 0.5 * point["x"]}  # noqa: E731
    sweeping._compute(cells, found, store=store, workers=1, executor=None, progress=None)
    assert written == ["0", "2"]
    assert found.stored == 3
