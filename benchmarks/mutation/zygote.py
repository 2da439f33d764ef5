"""A process that has the libraries loaded and forks one child a run of the tests.

It works inside a copy of the project, reads one JSON request a line and writes one JSON answer a
line. A child sees the changed module as a file, so that tests that start other processes see it
too.
"""

from __future__ import annotations

import ast
import builtins
import contextlib
import importlib
import json
import os
import select
import signal
import sys
import time
from collections.abc import Callable
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any

ENTERED, IMPORTING = "entered_by_a_test", "importing_a_module"
LIBRARIES = (
    "hypothesis.internal.conjecture.engine",
    "hypothesis.strategies",
    "matplotlib",
    "mpmath",
    "numba",
    "pytest",
    "scipy.integrate",
    "scipy.linalg",
    "scipy.optimize",
    "sympy",
)
PACKAGES = ("theory", "derivations", "verification", "paper_checks", "fronts")


class Picked:
    """Run the named tests only, in that order."""

    def __init__(self, tests: list[str] | None) -> None:
        self.place = None if tests is None else {name: i for i, name in enumerate(tests)}
        self.failed: str | None = None

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        if self.place is not None:
            items[:] = [item for item in items if item.nodeid in self.place]
            items.sort(key=lambda item: self.place[item.nodeid] if self.place else 0)

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed and self.failed is None:
            self.failed = report.nodeid

    def pytest_collectreport(self, report: Any) -> None:
        if report.failed and self.failed is None:
            self.failed = f"{report.nodeid} (import)"


class Recorder:
    """Note which functions of the project each test enters, and how long it takes.

    Each function is compiled with one more line, that names it; a tracer would make the many small
    calls of mpmath and SymPy several times slower. What a function holds, other functions and
    lambdas, counts as the function. What is entered while a module of the project is imported
    counts for all tests of the file, whichever of them imported it. Functions for numba are left
    as they are.
    """

    def __init__(self, root: str) -> None:
        self.root = root + os.sep
        self.passed: dict[str, float] = {}
        self.entered: dict[str, list[str]] = {}
        self.shared: set[str] = set()
        self._now: set[str] = set()
        self._importing = 0
        builtins.__dict__[ENTERED] = self._enter
        builtins.__dict__[IMPORTING] = self._import
        compiled = SourceFileLoader.source_to_code
        SourceFileLoader.source_to_code = self._named(compiled)  # type: ignore[method-assign]

    def _named(self, compiled: Callable[..., CodeType]) -> Callable[..., CodeType]:
        def source_to_code(loader: Any, data: Any, path: Any, **options: Any) -> CodeType:
            if str(path).startswith(self.root):
                relative = str(path)[len(self.root) :]
                if relative.split(os.sep)[0] in PACKAGES:
                    tree = ast.parse(data)
                    _name_all(tree, relative)
                    data = ast.fix_missing_locations(tree)
            return compiled(loader, data, path, **options)

        return source_to_code

    def _enter(self, place: str) -> None:
        (self.shared if self._importing else self._now).add(place)

    def _import(self, change: int) -> None:
        self._importing += change

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.when == "setup":  # and everything since: what fixtures compute is for all
            self.shared |= self._now
        elif report.when == "call":
            self.entered[report.nodeid] = sorted(self._now)
            if report.passed:  # what a fixture takes counts as time of the file
                self.passed[report.nodeid] = report.duration
        self._now.clear()

    def pytest_runtest_setup(self) -> None:
        self.shared |= self._now
        self._now.clear()
        # What one test leaves in a cache another would not enter.
        for name, module in list(sys.modules.items()):
            if name.split(".")[0] in PACKAGES:
                for value in list(vars(module).values()):
                    if hasattr(value, "cache_clear"):
                        value.cache_clear()


def _name_all(tree: ast.Module, relative: str) -> None:
    """Begin each function, and each lambda in one, with a call that names the outermost."""
    outermost = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            outermost += [each for each in node.body if isinstance(each, ast.FunctionDef)]
    for top in outermost:
        first = min([top.lineno, *(each.lineno for each in top.decorator_list)])
        call = f"{ENTERED}({f'{relative}:{first}'!r})"
        compiled: set[ast.AST] = set()
        for node in ast.walk(top):
            if node in compiled:
                continue
            if isinstance(node, ast.FunctionDef):
                if any("jit" in ast.unparse(decorator) for decorator in node.decorator_list):
                    compiled.update(ast.walk(node))
                    continue
                place = 1 if ast.get_docstring(node) is not None else 0
                node.body.insert(place, ast.parse(call).body[0])
            elif isinstance(node, ast.Lambda):
                both = ast.Tuple([ast.parse(call, mode="eval").body, node.body], ast.Load())
                node.body = ast.Subscript(both, ast.Constant(1), ast.Load())
    future = sum(isinstance(node, ast.ImportFrom) and node.module == "__future__"
                 for node in tree.body)  # fmt: skip
    start = future + (1 if ast.get_docstring(tree) is not None else 0)
    tree.body.insert(start, ast.parse(f"{IMPORTING}(1)").body[0])
    tree.body.append(ast.parse(f"{IMPORTING}(-1)").body[0])


def run_tests(request: dict[str, Any], root: str) -> dict[str, Any]:
    """Run the tests of a request in this process."""
    import pytest

    picked = Picked(request.get("tests"))
    plugins: list[Any] = [picked]
    options = [
        "-q",
        "--no-header",
        "--assert=plain",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:faulthandler",
    ]
    recorder = None
    if request.get("record"):
        recorder = Recorder(root)
        plugins.append(recorder)
    else:
        options.append("-x")
    begin = time.perf_counter()
    code = int(pytest.main([*options, *request["files"]], plugins=plugins))
    answer: dict[str, Any] = {"seconds": time.perf_counter() - begin, "code": code}
    answer["status"] = "killed" if picked.failed or code not in (0, 5) else "survived"
    answer["by"] = picked.failed
    if recorder is not None:
        answer |= {
            "passed": recorder.passed,
            "entered": recorder.entered,
            "shared": sorted(recorder.shared),
        }
    return answer


def forked(request: dict[str, Any], root: str) -> dict[str, Any]:
    """Run a request in a child of its own, ended with all it started when its time is up."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.setsid()
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nowhere, stream)
        os.close(reading)
        try:
            answer = run_tests(request, root)
        except BaseException as error:
            answer = {"status": "killed", "by": f"{type(error).__name__}", "seconds": 0.0}
        with os.fdopen(writing, "w", encoding="utf-8") as pipe:
            json.dump(answer, pipe)
        os._exit(0)
    os.close(writing)
    deadline = time.monotonic() + request["timeout"]
    received = b""
    while True:
        left = deadline - time.monotonic()
        ready = left > 0 and select.select([reading], [], [], left)[0]
        if not ready:
            break
        part = os.read(reading, 1 << 16)
        if not part:
            break
        received += part
    os.close(reading)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)  # the child's own session
    os.waitpid(child, 0)
    try:
        return dict(json.loads(received))
    except ValueError:
        late = time.monotonic() >= deadline
        return {"status": "killed", "by": "time limit" if late else "crash", "seconds": 0.0}


def main() -> None:
    """Serve requests from standard input until it ends."""
    root = os.getcwd()
    sys.path.insert(0, root)
    sys.dont_write_bytecode = True
    for library in LIBRARIES:
        importlib.import_module(library)
    for line in sys.stdin:
        request = json.loads(line)
        module = request.get("module")
        whole = Path(module).read_bytes() if module else b""
        try:
            if module:
                Path(module).write_text(request["source"], encoding="utf-8")
            answer = forked(request, root)
        finally:
            if module:
                Path(module).write_bytes(whole)
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
