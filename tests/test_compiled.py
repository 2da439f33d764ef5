"""Compiled code on disk belongs to the sources as they are now."""

from __future__ import annotations

import atexit
import gc
import importlib.util
import itertools
import math
import os
import pkgutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numba.core import caching, config, types
from numba.core.dispatcher import Dispatcher

import verification
from theory import compiler
from theory.compiled_code import FOLDER
from theory.piecewise.sums import compiled as rules
from verification.execution import compiled
from verification.execution.compiled import files_with_compiled_functions, inner, outer
from verification.steppers import friction_series
from verification.steppers.specialise import pointer

ROOT = Path(__file__).parents[1]

SCRIPT = """
import sys
sys.path.insert(0, {folder!r})
import verification.execution.compiled as compiled
from numba.core import config
compiled._HOME = __import__("pathlib").Path({folder!r})
config.CACHE_DIR = {cache!r}
compiled.keep_compiled_code()
from outer import outer
print(outer(1.0))
"""


def _answer(folder: Path, cache: Path) -> float:
    script = SCRIPT.format(folder=str(folder), cache=str(cache))
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    return float(done.stdout)


def test_a_change_in_a_called_file_is_seen(tmp_path: Path) -> None:
    """The outer function's own file stays as it is; numba alone would give the old answer."""
    folder, cache = tmp_path / "code", tmp_path / "cache"
    folder.mkdir()
    inner = "from numba import njit\n@njit(cache=True)\ndef inner(x):\n    return {} * x\n"
    outer = (
        "from numba import njit\nfrom inner import inner\n"
        "@njit(cache=True)\ndef outer(x):\n    return inner(x)\n"
    )
    (folder / "inner.py").write_text(inner.format("2.0"))
    (folder / "outer.py").write_text(outer)
    assert _answer(folder, cache) == 2.0
    (folder / "inner.py").write_text(inner.format("3.25"))
    assert _answer(folder, cache) == 3.25
    assert len(list(cache.glob("compiled-*"))) == 2


def test_every_file_with_a_compiled_function_counts_in_the_digest() -> None:
    """Of all modules of the package, by the kind of object that numba makes."""
    for found in pkgutil.walk_packages(verification.__path__, "verification."):
        importlib.import_module(found.name)
    functions = [
        value.py_func
        for name, module in sys.modules.items()
        if name.startswith("verification.")
        for value in vars(module).values()
        if isinstance(value, Dispatcher)
    ]
    files = {Path(function.__code__.co_filename) for function in functions}
    own = {path for path in files if path.is_relative_to(ROOT / "verification")}
    assert len(own) > 10
    assert own <= set(files_with_compiled_functions(ROOT / "verification"))


def test_code_of_another_compiler_is_not_used(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    own = Path(str(compiler.__file__))
    before = [compiled.source_digest(tmp_path), rules._state_of_sources()]
    (tmp_path / own.name).write_bytes(own.read_bytes() + b"\n")
    monkeypatch.setattr(compiler, "__file__", str(tmp_path / own.name))
    after = [compiled.source_digest(tmp_path / "none"), rules._state_of_sources()]
    assert all(one != other for one, other in zip(before, after, strict=True))


NOWHERE = """
import os, sys
sys.path.insert(0, {folder!r})
import verification.execution.compiled as compiled
from numba.core import config
config.CACHE_DIR = ""
compiled._can_be_written = lambda folder: folder.name.startswith("fronts-")
print(compiled.keep_compiled_code())
from inner import inner
print(inner(1.0))
print(os.environ["NUMBA_CACHE_DIR"])
"""


def test_where_nothing_can_be_written_code_is_compiled_into_a_temporary_folder(
    tmp_path: Path,
) -> None:
    (tmp_path / "inner.py").write_text(
        "from numba import njit\n@njit(cache=True)\ndef inner(x):\n    return 2.0 * x\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", NOWHERE.format(folder=str(tmp_path))],
        capture_output=True, text=True, check=True, timeout=120,
        env={**os.environ, "TMPDIR": str(tmp_path), "HOME": "/proc/no-such-home"},
    )  # fmt: skip
    folder, answer, inherited = done.stdout.splitlines()
    assert answer == "2.0"
    assert Path(folder).parent == Path(inherited)
    assert Path(folder).parent.parent == tmp_path
    assert not Path(folder).parent.exists()  # gone with the process


def test_a_full_disk_does_not_end_a_computation_that_is_compiled(tmp_path: Path) -> None:
    (tmp_path / "inner.py").write_text(
        "from verification.execution.compiled import outer\n"
        "@outer(cache=True)\ndef inner(x):\n    return 2.0 * x\n"
    )
    program = (
        "import resource\nfrom inner import inner\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))\nassert inner(1.0) == 2.0"
    )
    path = os.pathsep.join([str(tmp_path), str(Path(__file__).parent.parent)])
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": path}
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=120,
        env=environment, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


FACTORY = """
import sys
from functools import lru_cache
from numba import njit, types
from verification.execution.compiled import outer
from verification.steppers.specialise import pointer

@lru_cache
def scaled(factor):
    @outer()
    def inner(x):  # calls itself twice, so that it is not put into its caller
        return factor * x if x < 2 else inner(x - 1) + inner(x - 2)
    return inner

def outer_of(factor):
    inner = scaled(factor)
    source = "def outer_{0}(x):\\n    return inner(x)\\n".format(factor)
    space = {"inner": inner}
    exec(compile(source, __file__, "exec"), space)
    function = space[f"outer_{factor}"]
    function.__module__ = "factory"
    return outer(cache=True)(function)

def call(x):
    return inner(x)

@njit(cache=True)
def apply(f, x):
    return f(x)

if __name__ == "__main__":
    for word in sys.argv[1:]:
        print(outer_of(int(word))(1.0))
        made = pointer(call, types.float64(types.float64), word, inner=scaled(int(word)))
        print(apply(made, 3.0))
"""


def test_code_that_other_processes_have_compiled_is_not_mixed_up(tmp_path: Path) -> None:
    """Two functions of one name from one factory, each compiled first by a process of its own.

    So are those that are called by pointers. With numba's own names the third process answers 2
    twice, or 3 twice.
    """
    script = tmp_path / "factory.py"
    script.write_text(FACTORY)

    def printed(*factors: str) -> list[str]:
        return subprocess.run(
            [sys.executable, str(script), *factors],
            cwd=ROOT,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()

    assert printed("2") == ["2.0", "4.0"]
    assert printed("3") == ["3.0", "6.0"]
    assert printed("3", "2") == ["3.0", "6.0", "2.0", "4.0"]


INNER = """
from verification.execution.compiled import inner, outer

@inner()
def part(x):
    return 2.0 * x

@outer(cache=True)
def whole(x):
    return part(x) + 1.0

if __name__ == "__main__":
    print(whole(1.0), len(part.overloads))
"""


def test_a_part_is_stored_with_what_calls_it_and_not_compiled_again(tmp_path: Path) -> None:
    """The first process compiles the part, the second loads the whole and never asks for it."""
    script, cache = tmp_path / "parts.py", tmp_path / "cache"
    script.write_text(INNER)
    answers = [
        subprocess.run(
            [sys.executable, str(script)], capture_output=True, text=True, check=True, timeout=120,
            env={**os.environ, "NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": str(ROOT)},
        ).stdout.split()
        for _ in range(2)
    ]  # fmt: skip
    assert answers == [["3.0", "1"], ["3.0", "0"]]
    assert {path.name.split("-")[0] for path in cache.rglob("*.nbi")} == {"parts.whole"}


@pytest.mark.parametrize("unrolled", [True, False])
def test_what_is_compiled_gives_what_python_gives(unrolled: bool) -> None:
    """With sums over arrays, a named argument, and a part that only compiled functions call."""

    def part(x: float, less: float) -> float:
        return 2.0 * x - less

    def whole(x: Any, y: Any, found: Any) -> None:
        for i in range(x.size):
            found[0, i] = math.hypot(x[i], y[i]) + called(x[i], less=y[i])
            for k in range(i + 1):
                found[1, i] += x[k] * y[i - k]

    x, y = np.linspace(-1.0, 1.0, 9), np.geomspace(0.1, 10.0, 9)
    called: Any = part
    expected, found = np.zeros((2, 9)), np.zeros((2, 9))
    whole(x, y, expected)
    called = inner()(part)
    outer(unrolled=unrolled)(whole)(x, y, found)
    assert np.allclose(found, expected, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("unrolled", [True, False])
def test_compiled_code_is_kept_on_disk(
    unrolled: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, cache = tmp_path / "kept.py", tmp_path / "cache"
    file.write_text("def twice(x):\n    return 2.0 * x\n")
    spec = importlib.util.spec_from_file_location("kept", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(config, FOLDER, str(cache))
    assert outer(unrolled=unrolled, cache=True)(module.twice)(1.5) == 3.0
    assert len(list(cache.rglob("*.nbc"))) == 1


def _twice(x: float) -> float:
    return 2.0 * x


def test_code_of_friction_that_python_calls_is_kept_on_disk() -> None:
    found: Any = friction_series.friction_outer(_twice)
    assert not isinstance(found._cache, caching.NullCache)


def test_places_for_compiled_code_are_tried_and_left_as_they_were(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last one is a folder of this process, and is gone when it ends."""
    at_end: list[Any] = []
    monkeypatch.setattr(atexit, "register", lambda *given, **by: at_end.append((given, by)))
    monkeypatch.setattr(config, "CACHE_DIR", "")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    *_, home, last = compiled._places()
    assert home == tmp_path / "home" / ".cache" / "fronts"
    for place in (home, last):
        assert compiled._can_be_written(place)
        assert list(place.iterdir()) == []
    assert os.environ["NUMBA_CACHE_DIR"] == str(last)
    (tmp_path / "file").touch()
    assert not compiled._can_be_written(tmp_path / "file" / "folder")
    for (function, *given), by in at_end:
        function(*given, **by)
    assert home.exists()
    assert not last.exists()
    monkeypatch.setattr(config, "CACHE_DIR", str(home))
    assert next(iter(compiled._places())) == home


def test_what_an_operation_gives_is_looked_up_once_but_with_named_arguments_each_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """numba is left as it was, after a compilation that fails too."""
    asked: list[Any] = []

    def resolve(function: Any, context: Any, given: Any, named: Any) -> Any:
        asked.append((function, tuple(given), dict(named)))
        return len(asked)

    monkeypatch.setattr(types.Function, "get_call_type", resolve)
    found: list[Any] = []

    def compiled_and_failed() -> None:
        with compiler._operations_resolved_once():
            found.extend(
                types.Function.get_call_type(function, None, given, named)
                for function, given, named in (
                    ("f", [1], {}), ("f", (1,), {}), ("f", (2,), {}), ("f", (1,), {"n": 3}),
                    ("f", (1,), {"n": 3}), ("g", (1,), {}), ("g", (1,), {}),
                )
            )  # fmt: skip
            raise ArithmeticError

    with pytest.raises(ArithmeticError):
        compiled_and_failed()
    assert found == [1, 1, 2, 3, 4, 5, 5]
    assert types.Function.get_call_type is resolve


def test_options_of_a_compilation_are_those_with_the_same_values() -> None:
    one, same, other = compiler._Flags(), compiler._Flags(), compiler._Flags()
    other.nrt = True
    assert (one == same, hash(one) == hash(same)) == (True, True)
    assert (one == other, one == "options") == (False, False)


def test_a_folder_that_was_tried_is_left_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened, closed = [], []
    begin, end = tempfile.mkstemp, os.close

    def mkstemp(**given: Any) -> tuple[int, str]:
        found = begin(**given)
        opened.append(found[0])
        return found

    monkeypatch.setattr(tempfile, "mkstemp", mkstemp)
    monkeypatch.setattr(os, "close", lambda handle: (closed.append(handle), end(handle))[1])
    assert compiled._can_be_written(tmp_path / "new")
    assert closed == opened != []
    assert list((tmp_path / "new").iterdir()) == []


def test_compiled_code_of_other_sources_is_kept_for_a_week(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiled, "_places", lambda: iter([tmp_path]))
    monkeypatch.setattr(config, FOLDER, getattr(config, FOLDER))
    day = 86400.0
    for days, name in ((6.0, "new"), (8.0, "old")):
        folder = tmp_path / f"{compiled._PREFIX}{name}"
        (folder / "part").mkdir(parents=True)
        os.utime(folder, (time.time() - days * day,) * 2)
    (tmp_path / "other").mkdir()
    os.utime(tmp_path / "other", (0.0, 0.0))
    folder = compiled.keep_compiled_code()
    assert getattr(config, FOLDER) == str(folder)
    assert folder.parent == tmp_path
    assert {each.name for each in tmp_path.iterdir()} == {f"{compiled._PREFIX}new", "other"}


def test_what_a_part_calls_is_linked_into_it_once() -> None:
    """Each library once, and by numba not again whenever the part itself is linked."""
    linked: list[tuple[str, bool]] = []

    class Called:
        def __init__(self, name: str) -> None:
            self.name = name

        def _get_module_for_linking(self) -> str:
            return self.name

    called = [Called("a"), Called("b")]
    part: Any = compiler._PartOfItsCallers.__new__(compiler._PartOfItsCallers)
    part._finalized, part._linking_libraries = False, [*called, called[0]]
    part._final_module = SimpleNamespace(
        link_in=lambda module, *, preserve: linked.append((module, preserve))
    )
    for _ in range(2):
        part._ensure_finalized()
    assert linked == [("a", True), ("b", True)]


def test_functions_are_counted_from_a_random_number_if_this_numba_counts_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    counter: Any = itertools.count(1)
    for given, possible in ((counter, True), (iter([1, 2]), False), (None, False)):
        monkeypatch.setattr(compiled.FunctionIdentity, "_unique_ids", given)
        assert compiled._count_from_random() is possible
        counting: Any = compiled.FunctionIdentity._unique_ids
        assert (counting is given) is not possible
        if possible:
            assert next(counting) > 1  # the chance of 1 is 4e-15


def test_garbage_is_searched_for_after_compiling_as_it_was_before() -> None:
    def twice(x: float) -> float:
        return 2.0 * x

    try:
        for searching in (True, False):
            (gc.enable if searching else gc.disable)()
            assert outer()(twice)(1.5) == 3.0
            assert gc.isenabled() is searching
    finally:
        gc.enable()


@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("kind", ["njit", "cfunc"])
def test_an_interrupt_waits_until_numba_has_compiled(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It would leave numba's tables half set up, and every later compilation would fail."""
    whole = compiler.OuterCompiler.compile_extra
    reached: list[str] = []

    def interrupted(self: Any, function: Any) -> Any:
        for _ in range(2):
            signal.raise_signal(signal.SIGINT)
        reached.append("interrupted")
        return whole(self, function)

    def double(x: float) -> float:
        return 2.0 * x

    def call() -> float:
        signature = types.float64(types.float64)
        return float(
            function(1.5) if kind == "njit" else pointer(double, signature, mark).ctypes(1.5)
        )

    function, mark = outer()(double), "interrupted"
    with monkeypatch.context() as during:
        during.setattr(compiler.OuterCompiler, "compile_extra", interrupted)
        during.setattr("verification.steppers.specialise.DISTINCT_NAMES", False)  # not from disk
        with pytest.raises(KeyboardInterrupt):
            call()
    assert reached == ["interrupted"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert call() == 3.0


@pytest.mark.parametrize("error", [OSError, ModuleNotFoundError])
def test_code_on_disk_that_cannot_be_loaded_is_compiled_again(
    error: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file of a function may since have been imported under another name."""

    def load(*_: object) -> Any:
        raise error("no module named as it was when the code was stored")

    monkeypatch.setattr(caching.FunctionCache, "_load_overload", load)
    stored = object.__new__(caching.FunctionCache)
    context = SimpleNamespace(refresh=lambda: None)
    assert stored.load_overload(None, context) is None  # nothing found, so that it is compiled
