"""Records of the functions that the tests of each file enter, kept while they remain valid.

They remain valid while the test file, the files shared by tests, the functions entered and the code
executed by imports are unchanged, since the tests then take the same path. Data that tests read,
and sources that they read as text, are not taken into account.
"""

from __future__ import annotations

import ast
import json
import sys
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from benchmarks.mutation.entered import PACKAGES
from benchmarks.mutation.places import outermost_functions

RECORDING = ("entered", "places", "recorder", "session")
"""Modules of this folder that determine what is recorded."""


class Records:
    """The records in a file, one per line; for each test file the last one counts.

    Parameters
    ----------
    root : Path
        Root of the project.
    path : Path
        File of the records.
    limit : float
        Processor seconds of a test above which it is not recorded.
    """

    def __init__(self, root: Path, path: Path, limit: float) -> None:
        self._root, self._path, self._limit = root, path, limit
        self._parts: dict[str, dict[str, str]] = {}
        self._known = {record["file"]: record for record in _whole_lines(path)}

    def known(self, file: str, imported: Collection[str]) -> list[dict[str, Any]] | None:
        """Return the recorded answers for the tests of a file; None without a valid record."""
        record = self._known.get(file)
        if record is None or record["key"] != self._key(file, imported, record["entered"]):
            return None
        found: list[dict[str, Any]] = record["answers"]
        return found

    def keep(
        self,
        file: str,
        imported: Collection[str],
        entered: Collection[str],
        answers: list[dict[str, Any]],
    ) -> None:
        """Store the functions entered by the tests of a file and by its imports."""
        key = self._key(file, imported, entered)
        record = {"file": file, "key": key, "entered": sorted(entered), "answers": answers}
        with self._path.open("a", encoding="utf-8") as kept:
            kept.write(json.dumps(record) + "\n")

    def _key(self, file: str, imported: Collection[str], entered: Iterable[str]) -> str:
        """Return a digest of everything that determines the path taken by the tests of a file."""
        from verification.execution.digest import digest_of, digest_of_files
        from verification.execution.imports import content_of_file

        of_project = {path for path in imported if path.partition("/")[0] in PACKAGES}
        shared = {"conftest.py", *imported} - of_project
        shared = {path for path in shared if not path.startswith("benchmarks/mutation/")}
        parts: list[object] = [_runner(), self._limit]
        if file in of_project:  # its examples are in docstrings
            parts.append(digest_of_files(self._root, [self._root / file]))
        files = (self._root / path for path in sorted(shared))
        parts += [content_of_file(path) for path in files if path.exists()]
        for place in sorted(entered):
            path, _, name = place.partition(":")
            of_project.add(path)
            parts.append([place, self._parts_of(path).get(name)])
        parts += [[path, self._parts_of(path)[""]] for path in sorted(of_project)]
        return digest_of(parts)

    def _parts_of(self, path: str) -> dict[str, str]:
        if path not in self._parts:
            file = self._root / path
            self._parts[path] = _parts(file.read_bytes() if file.exists() else b"")
        return self._parts[path]


def _whole_lines(path: Path) -> Iterator[dict[str, Any]]:
    """Yield the records in a file, except lines that are truncated or from an older runner."""
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        with suppress(json.JSONDecodeError):
            record = json.loads(line)
            if isinstance(record, dict) and record.keys() >= {"file", "key", "entered", "answers"}:
                yield record


@cache
def _runner() -> str:
    """Return a digest of the recording modules and of the installed libraries."""
    from verification.execution.digest import digest_of
    from verification.execution.imports import content_of_file

    installed = sorted(f"{each.name} {each.version}" for each in distributions())
    modules = [content_of_file(Path(__file__).with_name(f"{name}.py")) for name in RECORDING]
    return digest_of([sys.version, installed, modules])


def _parts(source: bytes) -> dict[str, str]:
    """Return digests of a module's functions by name, and of the code outside them as ``""``."""
    from verification.execution.digest import digest_of
    from verification.execution.imports import shape

    tree = ast.parse(source)
    found: dict[str, list[str]] = defaultdict(list)  # a property may have a getter and a setter
    for name, function in list(outermost_functions(tree)):
        found[name].append(shape(function))
        function.body = []  # the rest is what an import executes: defaults, decorators
    found[""] = [shape(tree)]
    return {name: digest_of(each) for name, each in found.items()}
