"""The store: what is damaged is computed again, what is another's is refused, nothing is run."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import random
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from theory.parameters import ParameterError
from verification.execution.files import FileError
from verification.execution.store import Store

IDENTITY = {"function": "f", "parameters": {"c": 0.5}, "versions": {"numpy": "2.0"}}
RESULTS = {str(n): [["value", 1.0 / (n + 1)], ["label", "front"]] for n in range(40)}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    with Store(tmp_path / "out.part", IDENTITY, resume=False) as store:
        for key, result in RESULTS.items():
            store.add(key, result)
    assert [each.name for each in tmp_path.iterdir()] == ["out.part"]
    return tmp_path / "out.part"


def found(path: Path, **options: Any) -> dict[str, Any]:
    with Store(path, IDENTITY, resume=True, **options) as store:
        return store.results


def change(path: Path, *statements: str) -> None:
    with contextlib.closing(sqlite3.connect(path)) as file:
        for statement in statements:
            file.execute(statement)
        file.commit()


def test_what_was_added_is_found_and_floats_to_the_bit(path: Path) -> None:
    assert found(path) == RESULTS


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE results SET text = replace(text, 'front', 'brink') WHERE key = '7'",
        "UPDATE results SET text = (SELECT text FROM results WHERE key = '8'), checksum = "
        "(SELECT checksum FROM results WHERE key = '8') WHERE key = '7'",
        "UPDATE results SET text = x'00ff' WHERE key = '7'",
        "UPDATE results SET checksum = 5 WHERE key = '7'",
        "UPDATE results SET key = x'37' WHERE key = '7'",
        "DELETE FROM results WHERE key = '7'",
    ],
)
def test_a_damaged_row_is_passed_over(statement: str, path: Path) -> None:
    change(path, statement)
    assert found(path) == {key: result for key, result in RESULTS.items() if key != "7"}


@pytest.mark.parametrize(
    ("statements", "word"),
    [
        (["DROP TABLE results"], "not one"),
        (["DROP TABLE results",
          "CREATE VIEW results AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
          "SELECT i AS key, i AS text, i AS checksum FROM n"], "not one"),
        (["CREATE TRIGGER t AFTER INSERT ON results BEGIN DELETE FROM results; END"], "not one"),
        (["ALTER TABLE results ADD COLUMN more TEXT"], "not one"),
        (["DELETE FROM identity"], "damaged"),
        (["INSERT INTO identity VALUES ('{}')"], "damaged"),
        (["UPDATE identity SET text = '[1'"], "damaged"),
        ([f"UPDATE identity SET text = '{'[' * 100_000}'"], "damaged"),
        (["UPDATE identity SET text = '{}'"], "another run"),
        (["UPDATE identity SET text = replace(text, '\"format\": 4', '\"format\": 3')"], "format"),
    ],
)  # fmt: skip
def test_a_crafted_file_is_one_sentence_or_begun_anew(
    statements: list[str], word: str, path: Path
) -> None:
    change(path, *statements)
    with pytest.raises(ParameterError, match=word) as caught:
        found(path)
    assert "\n" not in str(caught.value)
    assert found(path, replace=True) == {}
    assert found(path) == {}


def test_a_file_of_something_else_is_refused_and_left_alone(tmp_path: Path) -> None:
    other = tmp_path / "mine.sqlite"
    change(other, "CREATE TABLE letters (text TEXT)", "INSERT INTO letters VALUES ('dear')")
    with pytest.raises(ParameterError, match="not one"):
        found(other)
    with contextlib.closing(sqlite3.connect(other)) as file:
        assert file.execute("SELECT text FROM letters").fetchone() == ("dear",)
    os.mkfifo(tmp_path / "fifo")
    with pytest.raises(FileError, match="FIFO"):
        found(tmp_path / "fifo")


@pytest.mark.parametrize("name", ["function", "parameters", "versions"])
def test_what_differs_is_named_and_nothing_is_lost(name: str, path: Path) -> None:
    other = json.loads(json.dumps(IDENTITY))
    other[name] = "g" if name == "function" else {"c": 0.6, "numpy": "2.1"}
    with pytest.raises(ParameterError, match=f"{name}"):
        Store(path, other, resume=True)
    with pytest.raises(ParameterError, match="--resume"):
        Store(path, IDENTITY, resume=False)
    assert found(path) == RESULTS


def test_changed_bytes_are_noticed(path: Path, tmp_path: Path) -> None:
    """At random: a sentence, or true results only."""
    content = path.read_bytes()
    chance = random.Random(3)
    for n in range(150):
        changed = bytearray(content)
        for _ in range(chance.choice([1, 3, 30])):
            changed[chance.randrange(len(changed))] = chance.randrange(256)
        file = tmp_path / f"{n}"
        file.write_bytes(changed[: chance.choice([len(changed), chance.randrange(len(changed))])])
        try:
            results = found(file)
        except ParameterError as error:
            message = f"{error}"
            results = {}
        else:
            message = ""
        assert "\n" not in message
        assert results.items() <= RESULTS.items()


def test_the_file_is_ones_own_while_it_is_open(path: Path) -> None:
    with Store(path, IDENTITY, resume=True) as store:
        store.add("40", 1)
        for options in ({}, {"replace": True}):
            with pytest.raises(FileError, match="in use by another run"):
                found(path, **options)
    assert found(path)["40"] == 1


@pytest.mark.parametrize("resume", [True, False])
def test_a_store_that_may_be_replaced_keeps_what_fits_if_it_is_resumed_and_nothing_else(
    resume: bool, path: Path
) -> None:
    with Store(path, IDENTITY, resume=resume, replace=True) as store:
        assert store.results == (RESULTS if resume else {})
        store.add("new", 1)
    with Store(path, IDENTITY | {"function": "g"}, resume=True, replace=True) as store:
        assert store.results == {}
    path.write_bytes(b"no database" * 100)
    with pytest.raises(ParameterError, match="unreadable"):
        found(path)
    with Store(path, IDENTITY, resume=True, replace=True) as store:
        assert store.results == {}
        store.add("0", 2)
    assert found(path) == {"0": 2}


def test_a_store_that_is_removed_leaves_no_file(path: Path) -> None:
    with Store(path, IDENTITY, resume=True) as store:
        store.add("40", 1)  # which is in the journal beside it
        store.remove()
        assert list(path.parent.iterdir()) == []
    with Store(path, IDENTITY, resume=False) as store:
        assert store.results == {}
        path.unlink()  # by somebody else, which is no error
        store.remove()
    assert list(path.parent.iterdir()) == []


def test_a_store_is_removed_while_it_is_still_locked(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else another run could open it between the two, and what it adds would be lost."""
    store, there = Store(path, IDENTITY, resume=True), []
    close = store.close
    monkeypatch.setattr(store, "close", lambda: (there.append(path.exists()), close()))
    store.remove()
    assert there == [False]


def test_refusals_name_the_file_what_is_wrong_and_what_to_do(path: Path) -> None:
    change(path, "UPDATE identity SET text = '{}'")
    with pytest.raises(ParameterError) as refusal:
        found(path)
    assert (refusal.value.quantity, refusal.value.value) == (f"store {path}", "of another run")
    assert refusal.value.remedy == "remove it, or name another file"
    with Store(path, IDENTITY, resume=True, replace=True), pytest.raises(FileError) as busy:
        found(path)
    assert busy.value.errno == errno.EBUSY
    assert str(busy.value).startswith(f"the file {path} is in use by another run: wait")


def test_a_damaged_row_is_named(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    change(path, "UPDATE results SET checksum = 'x' WHERE key = '7'")
    found(path)
    assert caplog.messages == [f"the result '7' in {path} is damaged and is computed again"]


def test_a_file_that_cannot_be_read_is_said_to_be_so(path: Path) -> None:
    path.write_bytes(b"no table of results" * 100)
    with pytest.raises(ParameterError) as refusal:
        found(path)
    assert str(refusal.value.value).startswith("unreadable (")
    assert refusal.value.allowed == "a file of finished results"


def test_a_file_of_which_one_page_cannot_be_read_is_replaced_when_it_is_opened(
    tmp_path: Path,
) -> None:
    path = tmp_path / "pages.part"
    with Store(path, IDENTITY, resume=False) as store:
        for key in range(300):
            store.add(str(key), "x" * 200)
    content = bytearray(path.read_bytes())
    assert len(content) > 10 * 4096
    content[6 * 4096 : 7 * 4096] = b"\xff" * 4096
    path.write_bytes(content)
    with pytest.raises(ParameterError, match="unreadable"):
        found(path)
    assert found(path, replace=True) == {}


def test_results_of_another_thread_are_stored_as_well(tmp_path: Path) -> None:
    with Store(tmp_path / "threads.part", IDENTITY, resume=False) as store:
        with ThreadPoolExecutor(1) as threads:
            threads.submit(store.add, "7", 0.25).result()
        assert store.results == {"7": 0.25}


def test_a_store_that_can_be_neither_read_nor_begun_anew_does_not_keep_the_lock(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(self: Store) -> None:
        raise sqlite3.OperationalError("disk I/O error")

    path.write_bytes(b"no table of results" * 100)
    with monkeypatch.context() as during:
        during.setattr(Store, "_begin", fail)
        with pytest.raises(FileError) as refusal:
            found(path, replace=True)
    assert found(path) == {}  # while the refusal keeps the first store alive
    assert refusal.value.errno == errno.EIO


@pytest.mark.parametrize(
    "words", ["database or disk is full", "attempt to write a readonly database"]
)
def test_results_that_cannot_be_read_for_want_of_space_are_not_deleted(
    words: str, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise sqlite3.OperationalError(words)

    with monkeypatch.context() as during:
        during.setattr(Store, "_open", fail)
        with pytest.raises(FileError):
            found(path, replace=True)
    assert found(path) == RESULTS


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="no file system without new files")
def test_where_no_file_can_be_made_a_store_says_why() -> None:
    with pytest.raises(FileError) as refusal:
        Store(Path("/proc/out.part"), IDENTITY, resume=True)
    assert refusal.value.errno == errno.ENOENT


@pytest.mark.parametrize(
    ("words", "number"),
    [("database or disk is full", errno.ENOSPC), ("disk I/O error", errno.EIO),
     ("attempt to write a readonly database", errno.EIO)],
)  # fmt: skip
def test_a_full_disk_is_told_from_other_errors_of_writing(
    words: str, number: int, path: Path
) -> None:
    with Store(path, IDENTITY, resume=True) as store:
        told = store._sentence(sqlite3.OperationalError(words))
    assert isinstance(told, FileError)
    assert told.errno == number
