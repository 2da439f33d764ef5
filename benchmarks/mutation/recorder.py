"""The functions that a test enters, and the time that it takes."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Iterator
from typing import Any

import pytest

from benchmarks.mutation import entered
from benchmarks.mutation.children import Answer

KEPT_WARM = frozenset({"verification.execution.imports"})
"""Modules whose caches are not emptied. They hold what was read from the files of the project,
which no change modifies; reading takes seconds, which would otherwise be charged to every test that
stores a result with the digest of its code."""


class TooLong(BaseException):
    """A test takes too long; not an Exception, which code of the project (a claim) would catch."""


class Recorder:
    """Records what a test enters and how long it takes, including the fixtures that it shares."""

    def __init__(self, names: set[str]) -> None:
        self._names = names
        self._shared: dict[str, tuple[float, set[str]]] = {}
        self._begin = self._elsewhere = 0.0
        signal.signal(signal.SIGPROF, _too_long)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self) -> None:
        forget()
        self._names.clear()
        self._begin, self._elsewhere = _spent(), 0.0

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[None]:
        before, begin = set(self._names), _spent()
        self._names.clear()
        try:
            return (yield)
        finally:
            if fixturedef.scope != "function":
                took = _spent() - begin
                self._elsewhere += took
                self._shared[fixturedef.argname] = took, set(self._names)
            self._names |= before

    def answer(self, item: pytest.Item) -> Answer:
        """Return the processor time of the last test, in seconds, and the functions it entered."""
        seconds = max(0.0, _spent() - self._begin - self._elsewhere)
        entered_ = set(self._names)
        for fixture in getattr(item, "fixturenames", ()):
            took, more = self._shared.get(fixture, (0.0, set()))
            seconds += took
            entered_ |= more
        return {"seconds": seconds, "entered": sorted(entered_)}


def forget() -> None:
    """Empty all caches of the project and its tests, as they are in a child that runs one test.

    Otherwise a test would not enter functions whose results an earlier test left in a cache, and
    would seem cheaper than it is alone.
    """
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] in (*entered.PACKAGES, "tests") and name not in KEPT_WARM:
            for value in list(vars(module).values()):
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def _spent() -> float:
    """Return the processor time of this process and its ended children, in seconds."""
    return time.process_time() + sum(os.times()[2:4])


def _too_long(*_: object) -> None:
    raise TooLong
