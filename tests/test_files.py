"""Files are written whole or not at all, through links, into FIFOs, and never over a device."""

from __future__ import annotations

import errno
import os
import pickle
import socket
import stat
import threading
from pathlib import Path

import pytest

from verification.execution import files
from verification.execution.files import (
    FileError,
    check_writable,
    file_error,
    sole_writer,
    write_by,
    write_bytes,
    writing,
)


def test_what_fails_half_way_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "out.csv"
    write_bytes(path, b"old")
    with pytest.raises(TypeError), writing(path) as file:
        file.writelines([b"half of the n", "ew"])  # type: ignore[list-item]
    assert path.read_bytes() == b"old"
    with pytest.raises(TypeError), writing(tmp_path / "new") as file:
        file.writelines([b"half of the n", "ew"])  # type: ignore[list-item]
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_keeps_its_permissions_and_a_new_one_has_the_usual_ones(tmp_path: Path) -> None:
    private, new = tmp_path / "private", tmp_path / "new"
    private.touch(0o600)
    mask = os.umask(0o026)
    try:
        for path in (private, new):
            write_bytes(path, b"x")
    finally:
        os.umask(mask)
    assert [stat.S_IMODE(path.stat().st_mode) for path in (private, new)] == [0o600, 0o640]


@pytest.mark.parametrize("exists", [True, False])
def test_a_symbolic_link_stays_and_the_file_it_leads_to_is_written(
    exists: bool, tmp_path: Path
) -> None:
    (tmp_path / "there").mkdir()
    target = tmp_path / "there" / "target"
    if exists:
        target.write_bytes(b"old")
    link, second = tmp_path / "link", tmp_path / "second"
    link.symlink_to("there/target")
    second.symlink_to(link)
    write_bytes(second, b"new")
    assert link.is_symlink()
    assert second.is_symlink()
    assert target.read_bytes() == b"new"


def test_a_loop_of_links_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(FileError, match="symbolic link"):
        write_bytes(tmp_path / "a", b"x")


@pytest.mark.parametrize("by_path", [True, False])
def test_into_a_fifo_the_content_is_passed_on(by_path: bool, tmp_path: Path) -> None:
    fifo = tmp_path / "out.svg"
    os.mkfifo(fifo)
    content = b"0123456789" * 20_000  # more than a pipe holds
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(fifo.read_bytes()))
    reader.start()
    check_writable(fifo)
    if by_path:
        write_by(fifo, lambda path: path.write_bytes(content))
    else:
        write_bytes(fifo, content)
    reader.join(10)
    assert read == [content]
    assert stat.S_ISFIFO(fifo.stat().st_mode)


def test_a_fifo_whose_reader_leaves_is_one_sentence(tmp_path: Path) -> None:
    fifo = tmp_path / "out"
    os.mkfifo(fifo)
    reader = threading.Thread(target=lambda: os.close(os.open(fifo, os.O_RDONLY)))
    reader.start()
    with pytest.raises(FileError, match="keep its reader open"):
        write_bytes(fifo, b"x" * 1_000_000)
    reader.join(10)


def test_what_is_no_file_is_refused_and_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "folder").mkdir()
    listening = socket.socket(socket.AF_UNIX)
    monkeypatch.chdir(tmp_path)  # the name of a socket must be short
    listening.bind("socket")
    link = tmp_path / "link"
    link.symlink_to("/dev/null")
    for path, word, number in (
        (Path("/dev/null"), "is a device", errno.EINVAL), (link, "is a device", errno.EINVAL),
        (Path("socket"), "is a socket", errno.EINVAL),
        (tmp_path / "folder", "is a folder", errno.EISDIR),
        (tmp_path / "none" / "out", "does not exist", errno.ENOENT),
        (tmp_path / ("x" * 300), "written: file name too long: name", errno.ENAMETOOLONG),
        (Path("a\0b"), "null", errno.EINVAL),
    ):  # fmt: skip
        for write in (check_writable, lambda path: write_bytes(path, b"x")):
            with pytest.raises(FileError, match=word) as caught:
                write(path)
            assert caught.value.errno == number
            assert "\n" not in str(caught.value)
            assert str(caught.value).endswith(f"{caught.value.remedy}.")
    listening.close()
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, 9999])
def test_each_error_of_the_system_has_its_remedy(number: int) -> None:
    error = file_error(Path("run.npz"), OSError(number, os.strerror(number)))
    assert str(error).startswith("the file run.npz cannot be written: ")
    assert str(error).count(".") == 2  # of the name, and of one sentence
    assert error.errno == number


def test_a_lock_ends_with_its_block_and_is_taken_by_one_only(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    for _ in range(2):
        with sole_writer(path):
            assert (tmp_path / "run.npz.lock").exists()
            with pytest.raises(FileError, match="in use"), sole_writer(path):
                pass
    assert list(tmp_path.iterdir()) == []


def test_a_lock_whose_file_was_removed_by_its_holder_is_let_go_and_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = iter([False, False, True])
    monkeypatch.setattr(os.path, "samestat", lambda *_: next(answers))
    with sole_writer(tmp_path / "run"):
        assert next(answers, None) is None


def test_of_many_threads_that_want_a_file_one_at_a_time_has_it(tmp_path: Path) -> None:
    """The lock's file comes and goes, and a stale one may be held by somebody else."""
    inside, most, taken = [0], [0], [0]

    def want() -> None:
        for _ in range(200):
            try:
                with sole_writer(tmp_path / "run"):
                    inside[0] += 1
                    most[0] = max(most[0], inside[0])
                    taken[0] += 1
                    inside[0] -= 1
            except FileError:
                continue

    threads = [threading.Thread(target=want) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1]
    assert taken[0] >= 200


def test_writing_leaves_no_file_open_and_a_lock_that_nobody_executes(tmp_path: Path) -> None:
    """A descriptor that is left open would be the lowest of those that are free."""
    path = tmp_path / "out"

    def lowest_free() -> int:
        handle = os.open(os.devnull, os.O_RDONLY)
        os.close(handle)
        return handle

    before = lowest_free()
    write_bytes(path, b"x")
    write_by(path, lambda part: part.write_bytes(b"y"))
    check_writable(path)
    with sole_writer(path):
        assert not (tmp_path / "out.lock").stat().st_mode & 0o111
        inside = lowest_free()
        with pytest.raises(FileError, match="in use"), sole_writer(path):
            pass
        assert lowest_free() == inside
    assert lowest_free() == before
    assert [each.name for each in tmp_path.iterdir()] == ["out"]


def test_an_error_that_is_not_the_system_s_is_one_of_input_and_output() -> None:
    found = file_error(Path("run.npz"), OSError("odd"))
    assert found.errno == errno.EIO
    assert "cannot be written: odd" in str(found)
    assert "cannot be written: timeoutError:" in str(file_error(Path("run.npz"), TimeoutError()))


def test_what_is_written_is_on_the_disk_before_it_takes_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, synced = tmp_path / "out", []
    names: list[bool] = []

    def sync(handle: int) -> None:
        if stat.S_ISDIR(os.fstat(handle).st_mode):
            names.append(path.exists())
        if stat.S_ISREG(os.fstat(handle).st_mode):
            synced.append((os.fstat(handle).st_size, path.exists()))

    monkeypatch.setattr("verification.execution.files.os.fsync", sync)
    write_by(path, lambda part: part.write_bytes(b"by path"))
    assert synced == [(len(b"by path"), False)]
    assert names == [True]  # then the name is written
    path.unlink()
    write_bytes(path, b"bytes")
    assert synced[1:] == [(len(b"bytes"), False)]
    assert path.read_bytes() == b"bytes"


def test_asking_for_the_mask_of_new_files_leaves_it_as_it_is() -> None:
    before = os.umask(0o027)
    try:
        assert files._umask() == 0o027
        assert os.umask(0o027) == 0o027
    finally:
        os.umask(before)


def test_a_file_takes_the_place_of_another_in_one_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There is no moment without it, since none is moved away."""
    monkeypatch.setattr(Path, "rename", None)
    target = tmp_path / "table.csv"
    target.write_text("old")
    write_by(target, lambda part: part.write_text("new"))
    assert target.read_text() == "new"


def test_a_folder_is_put_where_nothing_is(tmp_path: Path) -> None:
    def write(part: Path) -> None:
        part.unlink()
        part.mkdir()

    write_by(tmp_path / "table.zarr", write)
    assert (tmp_path / "table.zarr").is_dir()


def test_a_folder_takes_the_place_of_one_that_is_not_empty(tmp_path: Path) -> None:
    target = tmp_path / "table.zarr"
    target.mkdir()
    (target / "old").write_text("old")
    with files._replacing(target, target) as part:
        part.unlink()
        part.mkdir()
        (part / "new").write_text("new")
    assert [each.name for each in tmp_path.iterdir()] == ["table.zarr"]
    assert [each.name for each in target.iterdir()] == ["new"]


@pytest.mark.parametrize("folder", [True, False])
@pytest.mark.parametrize("error", [OSError(errno.EIO, "odd"), KeyboardInterrupt()])
def test_what_a_folder_was_to_replace_returns_if_it_cannot_take_its_place(
    error: BaseException, folder: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "table.zarr"
    if folder:
        target.mkdir()
    kept = target / files.ZARR_MARK if folder else target
    kept.write_text("old")

    def fail(part: Path, _: Path) -> None:
        raise error

    def write(part: Path) -> None:
        part.unlink()
        part.mkdir()
        (part / "new").write_text("new")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(FileError if isinstance(error, OSError) else KeyboardInterrupt):
        write_by(target, write)
    assert [each.name for each in tmp_path.iterdir()] == ["table.zarr"]
    assert kept.read_text() == "old"


def test_a_folder_takes_the_place_of_a_file_and_a_file_that_of_a_store(tmp_path: Path) -> None:
    target = tmp_path / "table.zarr"
    target.write_text("no store")

    def write(part: Path) -> None:
        part.unlink()
        part.mkdir()
        (part / "new").write_text("new")

    write_by(target, write)
    assert [each.name for each in tmp_path.iterdir()] == ["table.zarr"]
    assert (target / "new").read_text() == "new"
    (target / files.ZARR_MARK).touch()  # and a file takes that of a store
    write_bytes(target, b"no store")
    assert [each.name for each in tmp_path.iterdir()] == ["table.zarr"]
    assert target.read_text() == "no store"


def test_a_fifo_is_refused_for_a_store_before_any_work(tmp_path: Path) -> None:
    fifo = tmp_path / "table.ZARR"
    os.mkfifo(fifo)
    with pytest.raises(FileError, match=r"table\.ZARR is a FIFO, .* store: name another file"):
        check_writable(fifo)


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EINVAL])
def test_a_refusal_comes_from_another_process_as_it_was(number: int) -> None:
    error = FileError(Path("run.npz"), "is odd", "name another file", number)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert again.errno == error.errno
