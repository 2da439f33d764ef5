"""Checkpoints that were damaged, forged, or written by others: one sentence, never a wrong run."""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import os
import platform
import signal
import subprocess
import sys
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.lib import format as npy

from theory.chains.friction import FrictionChain
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, RunError
from verification.execution.digest import digest_of_arrays
from verification.execution.files import FileError
from verification.execution.interruption import Terminated, terminated_as_interrupted
from verification.execution.metadata import Code, installed_versions
from verification.runs import checkpoint
from verification.runs.checkpoint import load_checkpoint, run_to_end, save_checkpoint
from verification.runs.excite import excite
from verification.runs.simulate import MAX_NUMBERS, _check_samples, simulate
from verification.runs.smooth_integration import SmoothIntegration

VDP = VdpChain(a=4.0, b=0.5, c=0.6, sites=40)
FRICTION = FrictionChain(c=0.05, sites=9)
FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER))
Logistic = importlib.import_module("checkpoint_example").Logistic

METADATA = {"c": 0.5, "sites": 3}


def arrays() -> dict[str, np.ndarray]:
    return {
        "state": np.array([[0.1, -0.0, np.nan], [np.inf, 5e-324, 1.0]]),
        "psi": np.array([1 + 2j]),
        "counters": np.arange(4),
        "released": np.array([True, False]),
        "empty": np.zeros((0, 3)),
        "scalar": np.array(0.25),
        "transposed": np.arange(6.0).reshape(2, 3).T,
    }


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "run.npz"
    save_checkpoint(file, arrays(), METADATA, 2.5)
    return file


def blank() -> dict[str, np.ndarray]:
    return {name: np.zeros_like(array) for name, array in arrays().items()}


def test_what_is_saved_is_loaded_to_the_bit_and_the_same_bytes_each_time(path: Path) -> None:
    found = blank()
    assert load_checkpoint(path, found, METADATA) == 2.5
    assert digest_of_arrays(found) == digest_of_arrays(arrays())
    before = path.read_bytes()
    save_checkpoint(path, arrays(), METADATA, 2.5)
    assert path.read_bytes() == before
    with np.load(path) as opened:  # numpy reads it as well
        assert np.array_equal(opened["counters"], np.arange(4))


def entries(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as box:
        return {name: box.read(name) for name in box.namelist()}


def forge(path: Path, change: Callable[[dict[str, bytes], dict[str, Any]], None]) -> None:
    """Change entries and header, and give the file a digest that fits, as a forger would."""
    found = entries(path)
    header = json.loads(found["header.json"])
    change(found, header)
    try:
        content = {
            name.removesuffix(".npy"): np.load(io.BytesIO(found[name]))
            for name in found
            if name.endswith(".npy")
        }
        header["digest"] = digest_of_arrays(content)
    except (ValueError, MemoryError):
        pass
    with zipfile.ZipFile(path, "w") as box:
        for name, content_ in (found | {"header.json": json.dumps(header).encode()}).items():
            box.writestr(name, content_)


def npy_bytes(array: np.ndarray, pickled: bool = False) -> bytes:
    file = io.BytesIO()
    npy.write_array(file, array, allow_pickle=pickled)
    return file.getvalue()


def huge(shape: str) -> bytes:
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".encode()
    head += b" " * (-(len(head) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head


FORGED: dict[str, Callable[[dict[str, bytes], dict[str, Any]], object]] = {
    "an array is missing": lambda e, h: e.pop("state.npy"),
    "another shape": lambda e, h: e.update({"state.npy": npy_bytes(np.zeros((3, 2)))}),
    "another type": lambda e, h: e.update({"counters.npy": npy_bytes(np.arange(4.0))}),
    "16 TiB": lambda e, h: e.update({"state.npy": huge(f"({2**41},)")}),
    "a negative shape": lambda e, h: e.update({"state.npy": huge("(-1,)")}),
    "a shape of words": lambda e, h: e.update({"state.npy": huge("('a',)")}),
    "too short": lambda e, h: e.update({"state.npy": e["state.npy"][:-8]}),
    "too long": lambda e, h: e.update({"state.npy": e["state.npy"] + b"12345678"}),
    "objects": lambda e, h: e.update(
        {"state.npy": npy_bytes(np.array([[1, 2, 3]] * 2, dtype=object), pickled=True)}
    ),
    "columns first": lambda e, h: e.update(
        {"state.npy": npy_bytes(np.asfortranarray(arrays()["state"]))}
    ),
    "no header": lambda e, h: h.clear(),
    "another format": lambda e, h: h.update(format=2),
    "a deep header": lambda e, h: h.update(metadata=eval("[" * 90 + "]" * 90)),
    "time of NaN": lambda e, h: h.update(seconds=float("nan")),
    "time without an end": lambda e, h: h.update(seconds=float("inf")),
    "time before the start": lambda e, h: h.update(seconds=-1.0),
    "time in words": lambda e, h: h.update(seconds="long"),
    "a digest of no word": lambda e, h: h.update(digest=5) or e.pop("psi.npy"),
    "other parameters": lambda e, h: h["metadata"].update(c=0.6),
    "another numpy": lambda e, h: h["metadata"]["versions"].update(numpy="1.0"),
}


@pytest.mark.parametrize("name", FORGED)
def test_a_forged_checkpoint_is_one_sentence_and_fills_nothing(name: str, path: Path) -> None:
    forge(path, FORGED[name])
    found = blank()
    with pytest.raises(ParameterError, match="checkpoint") as caught:
        load_checkpoint(path, found, METADATA)
    assert "\n" not in str(caught.value)
    assert digest_of_arrays(found) == digest_of_arrays(blank())


@pytest.mark.parametrize("digest", [None, 5])
def test_a_checkpoint_without_a_digest_is_refused(digest: int | None, path: Path) -> None:
    found = entries(path)
    header = json.loads(found["header.json"])
    del header["digest"]
    if digest is not None:
        header["digest"] = digest
    with zipfile.ZipFile(path, "w") as box:
        for name, content in (found | {"header.json": json.dumps(header).encode()}).items():
            box.writestr(name, content)
    with pytest.raises(ParameterError, match="a checkpoint written by this toolkit"):
        load_checkpoint(path, blank(), METADATA)


def test_an_array_of_another_file_is_noticed(path: Path) -> None:
    """Its own checksum fits; that of the whole does not."""
    found = entries(path) | {"counters.npy": npy_bytes(np.arange(1, 5))}
    with zipfile.ZipFile(path, "w") as box:
        for name, content in found.items():
            box.writestr(name, content)
    with pytest.raises(ParameterError, match="unchanged since it was written"):
        load_checkpoint(path, blank(), METADATA)


def test_what_differs_is_named(path: Path) -> None:
    with pytest.raises(ParameterError, match=r"c: 0\.5 there, 0\.6 here"):
        load_checkpoint(path, blank(), METADATA | {"c": 0.6})
    forge(path, FORGED["another numpy"])
    with pytest.raises(ParameterError, match=r"versions\.numpy: 1\.0 there"):
        load_checkpoint(path, blank(), METADATA)


def test_what_is_no_checkpoint_is_one_sentence(path: Path) -> None:
    array = npy_bytes(np.zeros(3))
    for content in (b"", b"PK", array, b"\x00" * 1000, path.read_bytes()[:-30], os.urandom(3000)):
        path.write_bytes(content)
        with pytest.raises(ParameterError, match="a checkpoint written by this toolkit"):
            load_checkpoint(path, blank(), METADATA)
    path.unlink()
    with pytest.raises(FileError):
        load_checkpoint(path, blank(), METADATA)


def test_no_changed_byte_goes_unnoticed(path: Path) -> None:
    """Every byte of the file changed in turn: refused, or of no meaning (dates, padding)."""
    content = path.read_bytes()
    expected, silent = digest_of_arrays(arrays()), 0
    for place in range(0, len(content), 7):
        changed = bytearray(content)
        changed[place] ^= 0x41
        path.write_bytes(changed)
        found = blank()
        try:
            load_checkpoint(path, found, METADATA)
        except ParameterError:
            assert digest_of_arrays(found) == digest_of_arrays(blank())
        else:
            silent += 1
            assert digest_of_arrays(found) == expected
    assert silent < len(content) / 14


def test_a_clock_that_is_none_or_stands_still_does_not_run_for_ever(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    run_to_end([Logistic()], 3.0, 1, path, progress=None)
    for clock in (np.nan, -1.0, 7.0, np.inf):
        forged = npy_bytes(np.array([clock]))
        forge(path, lambda e, _, forged=forged: e.update({"0.clock.npy": forged}))
        with pytest.raises(ParameterError, match="checkpoint"):
            run_to_end([Logistic()], 3.0, 1, path, progress=None)
    run_to_end([Logistic()], 3.0, 1, tmp_path / "other.npz", progress=None)
    infinite = npy_bytes(np.full(7, np.inf))
    forge(tmp_path / "other.npz", lambda e, _: e.update({"0.state.npy": infinite}))
    with pytest.raises(ParameterError, match="a state that is finite"):
        run_to_end([Logistic()], 3.0, 1, tmp_path / "other.npz", progress=None)
    broken = Logistic()
    broken.clock[0] = np.nan
    with pytest.raises(RunError, match="does not advance"):
        run_to_end([broken], 3.0, 1, checkpoint=None, progress=None)


def test_a_piece_of_work_may_end_at_the_time_at_which_it_began() -> None:
    """As where several events are at one time."""

    class Events(Logistic):
        events = 0

        def advance(self, budget: int) -> None:
            self.events += 1
            if self.events % 2:
                super().advance(budget)

    run = Events()
    assert run_to_end([run], 3.0, 1, checkpoint=None, progress=None) == 0.0  # seconds before
    assert (run.time, run.events) == (3.0, 5)


def test_a_run_that_is_too_slow_is_refused_while_it_runs() -> None:
    class Slow(Logistic):
        def check_pace(self) -> None:
            raise RunError("it would take hours")

    with pytest.raises(RunError, match="hours"):
        run_to_end([Slow()], 3.0, 1, checkpoint=None, progress=None)


def test_a_run_of_other_parameters_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    run_to_end([Logistic()], 3.0, 1, path, progress=None)
    with pytest.raises(ParameterError, match="steps"):
        run_to_end([Logistic(steps=4)], 4.0, 1, path, progress=None)


def test_an_array_may_be_larger_than_an_entry_without_a_long_header(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That is, than 2 GiB; here the limit is taken to be smaller."""
    monkeypatch.setattr(zipfile, "ZIP64_LIMIT", 2000)
    large, found = {"state": np.arange(1000.0)}, {"state": np.zeros(1000)}
    save_checkpoint(tmp_path / "run.npz", large, METADATA, 1.0)
    load_checkpoint(tmp_path / "run.npz", found, METADATA)
    assert np.array_equal(found["state"], large["state"])


def test_a_second_request_to_end_does_not_cut_the_first_one_short() -> None:
    usual = signal.getsignal(signal.SIGTERM)
    with terminated_as_interrupted():
        with pytest.raises(Terminated):
            signal.raise_signal(signal.SIGTERM)
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
    assert signal.getsignal(signal.SIGTERM) is usual


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_saves_the_run_where_it_is(number: signal.Signals, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    program = (
        "import signal, sys, checkpoint_example\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "checkpoint_example.main(sys.argv[1])"
    )
    runner = subprocess.Popen(
        [sys.executable, "-c", program, str(path)],
        cwd=FOLDER,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert runner.stdout.readline() == b"5\n"
    runner.send_signal(number)
    errors = runner.communicate(timeout=10)[1]
    assert (b"Terminated" if number == signal.SIGTERM else b"KeyboardInterrupt") in errors
    resumed, whole = Logistic(steps=2000), Logistic(steps=2000)
    begun: list[float] = []
    run_to_end([resumed], 2000.0, 1, path, begun.append)
    assert begun[0] * 2000 > 5
    run_to_end([whole], 2000.0, 1, checkpoint=None, progress=None)
    assert resumed.state.tobytes() == whole.state.tobytes()
    assert [p.name for p in tmp_path.iterdir()] == ["run.npz"]


def test_a_signal_within_a_piece_of_work_waits_for_its_end(tmp_path: Path) -> None:
    """In the middle the arrays are no state of the run."""
    path = tmp_path / "run.npz"

    class Split(Logistic):  # type: ignore[misc, valid-type]
        def advance(self, budget: int) -> None:
            super().advance(budget)
            self.clock += 1000.0
            if self.clock[0] == 1002.0:
                os.kill(os.getpid(), signal.SIGTERM)
            self.clock -= 1000.0

    with pytest.raises(KeyboardInterrupt):
        run_to_end([Split()], 3.0, 1, path, progress=None)
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    with np.load(path) as opened:
        assert opened["0.clock"] == 2.0


@pytest.mark.parametrize(("period", "saved"), [(-1.0, 2.0), (1e6, None)])
def test_a_run_is_saved_every_few_seconds_and_not_more_often(
    period: float, saved: float | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checkpoint, "SAVE_PERIOD", period)
    monkeypatch.setattr(checkpoint, "SAVE_SHARE", 0.0)
    path = tmp_path / "run.npz"

    def broken(fraction: float) -> None:
        if fraction == 1.0:
            raise ZeroDivisionError  # as sudden as a kill: nothing is saved on its account

    with pytest.raises(ZeroDivisionError):
        run_to_end([Logistic()], 3.0, 1, path, broken)
    assert path.exists() is (saved is not None)
    if saved is not None:
        with np.load(path) as opened:
            assert opened["0.clock"] == saved


@pytest.mark.parametrize(
    ("chain", "excited", "end", "options"),
    [
        (VDP, [1], 1500.0, {"tolerance": 1e-7, "budget": 7000}),
        (VDP.averaged(), [1], 1500.0, {"tolerance": 1e-7, "budget": 400}),
        # A budget of one step of nine sites: the run is left after every step.
        *((FRICTION, excited, 30.0, {"logged_events": 500, "budget": 1})
          for excited in ([1], [5], range(1, 10))),
    ],
)  # fmt: skip
def test_an_interrupted_run_goes_on_to_the_same_bits(
    chain: Any, excited: Any, end: float, options: dict[str, Any], tmp_path: Path
) -> None:
    options = {"samples": 7, **options}
    start, looks = excite(chain, excited), 0
    whole = simulate(chain, start, end, **options | {"budget": None})

    def interrupt(_: float) -> None:
        nonlocal looks
        looks += 1
        if looks % 3 == 0:
            raise KeyboardInterrupt

    for _ in range(2000):
        with contextlib.suppress(KeyboardInterrupt):
            resumed = simulate(
                chain, start, end, checkpoint=tmp_path / "run.npz", progress=interrupt, **options
            )
            break
    assert looks > (100 if chain is FRICTION else 6)
    for name in ("states", "amplitude", "arrivals", "event_log"):
        assert np.array_equal(getattr(whole, name), getattr(resumed, name), equal_nan=True), name
    assert (whole.error, whole.steps) == (resumed.error, resumed.steps)


@pytest.mark.parametrize("chain", [VDP, FRICTION])
def test_a_checkpoint_of_another_run_is_refused(chain: Any, tmp_path: Path) -> None:
    file, start = tmp_path / "run.npz", excite(chain, [1])
    simulate(chain, start, 9.0, checkpoint=file)
    for other, begun, end, named in (
        (replace(chain, c=0.7), start, 9.0, f"c: {chain.c} there, 0.7 here"),
        (chain, excite(chain, [2]), 9.0, "start"),
        (chain, start, 10.0, "t_end"),
    ):
        with pytest.raises(ParameterError, match=named):
            simulate(other, begun, end, checkpoint=file)
    file.write_bytes(file.read_bytes()[:200])
    with pytest.raises(ParameterError, match="checkpoint"):
        simulate(chain, start, 9.0, checkpoint=file)


def test_other_code_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "run.npz"
    run_to_end([Logistic()], 3.0, 1, path, progress=None)
    monkeypatch.setattr(checkpoint, "code_of", lambda *_: Code(modules=(), digest="other"))
    with pytest.raises(ParameterError, match=r"same parameters, code and versions .*code"):
        run_to_end([Logistic()], 3.0, 1, path, progress=None)


def test_samples_are_as_many_as_memory_has_room_for() -> None:
    most = MAX_NUMBERS // 1000
    _check_samples(2, 1, 2)
    _check_samples(1, 1, 1)
    _check_samples(most, 1000, 2)
    for samples, sites, least, said in (
        (1, 1, 2, "number of samples"),
        (0, 1, 1, "number of samples"),
        (1_000_001, 1, 1, "number of samples"),
        (most + 1, 1000, 2, f"at most {most} for 1000 sites"),
    ):
        with pytest.raises(ParameterError, match=said) as refusal:
            _check_samples(samples, sites, least)
        assert (refusal.value.quantity, refusal.value.value) == ("number of samples", samples)


def test_a_refusal_names_the_file_what_it_must_be_and_what_to_do(path: Path) -> None:
    path.write_bytes(b"")
    with pytest.raises(ParameterError) as refusal:
        load_checkpoint(path, blank(), METADATA)
    told = refusal.value
    assert (told.quantity, told.value) == ("checkpoint", path)
    assert told.allowed == "a checkpoint written by this toolkit"
    assert told.remedy == "remove it, or name another file"


def test_seconds_of_earlier_runs_add_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the clock does meanwhile, they are not negative."""
    path = tmp_path / "run.npz"
    clock = iter([100.0, 101.0, 100.0])
    monkeypatch.setattr(checkpoint, "_advance", lambda *_: None)
    monkeypatch.setattr(checkpoint, "perf_counter", lambda: next(clock))
    assert run_to_end([Logistic()], 3.0, 1, path, progress=None) == 0.0
    monkeypatch.setattr(checkpoint, "perf_counter", lambda: 5.0)
    assert run_to_end([Logistic()], 3.0, 1, path, progress=None) == 1.0
    assert run_to_end([Logistic()], 3.0, 1, path, progress=None) == 1.0
    clock = iter([100.0, 98.0])
    monkeypatch.setattr(checkpoint, "perf_counter", lambda: next(clock))
    run_to_end([Logistic()], 3.0, 1, path, progress=None)
    with zipfile.ZipFile(path) as box:
        assert json.loads(box.read("header.json"))["seconds"] == 0.0


@pytest.mark.parametrize("saved", [False, True])
def test_an_interrupt_waits_only_where_a_run_is_saved(
    saved: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[bool] = []
    deferred = checkpoint.deferred_interrupts
    monkeypatch.setattr(checkpoint, "deferred_interrupts", lambda: begun.append(True) or deferred())
    run_to_end([Logistic()], 3.0, 1, tmp_path / "run.npz" if saved else None, progress=None)
    assert begun == [True] * saved


def test_two_runs_do_not_write_one_checkpoint(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"

    def second(_: float) -> None:
        with pytest.raises(FileError, match="another"):
            run_to_end([Logistic()], 3.0, 1, path, progress=None)

    run_to_end([Logistic()], 3.0, 1, path, second)
    assert path.exists()


@pytest.mark.parametrize("version", [(1, 0), (2, 0)])
def test_arrays_are_read_with_a_short_header_and_with_a_long_one(
    version: tuple[int, int], tmp_path: Path
) -> None:
    """As numpy writes them, by the number of bytes that tell the length of the header."""
    array, file = np.arange(6.0).reshape(2, 3), tmp_path / "run.npz"
    with zipfile.ZipFile(file, "w") as box, box.open("state.npy", "w") as entry:
        npy.write_array(entry, array, version=version)
    with zipfile.ZipFile(file) as box:
        assert np.array_equal(checkpoint._read(box, "state.npy", array), array)
        with pytest.raises(ValueError, match="shape"):
            checkpoint._read(box, "state.npy", array.T)


def test_a_shipped_chain_is_known_by_its_source_and_another_python_is_named_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bytecode differs between versions of Python; it had been listed as another equation."""
    shipped = VdpChain(a=4.0, b=0.5, c=0.6, sites=4)
    own = OscillatorChain(damping="1 - 4*y**2 + y**4/2", c=0.6, sites=4)
    for chain, known in ((shipped, True), (shipped.averaged(), True), (own, False)):
        run = SmoothIntegration(chain, excite(chain, [1]), [1.0])
        assert (run.metadata["right_hand_side"] is None) is known
    file = tmp_path / "run.npz"
    simulate(shipped, excite(shipped, [1]), 5.0, checkpoint=file)
    monkeypatch.setattr(
        "verification.runs.checkpoint.installed_versions",
        lambda names: {**installed_versions(names), "python": "4.0.0"},
    )
    monkeypatch.setattr("theory.cells.function_content._code", lambda _: "other bytecode")
    with pytest.raises(ParameterError) as refused:
        simulate(shipped, excite(shipped, [1]), 5.0, checkpoint=file)
    here = platform.python_version()
    assert f"(versions.python: {here} there, 4.0.0 here)" in str(refused.value)
