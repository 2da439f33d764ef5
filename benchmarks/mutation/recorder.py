"""What a test enters, and how long it takes."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from benchmarks.mutation import entered
from benchmarks.mutation.children import Answer

KEPT_WARM = frozenset({"verification.execution.imports"})
"""What this keeps is read from the files of the project, which no change touches: seconds of
reading that would be charged to each test which stores a result with the digest of its code."""


class TooLong(BaseException):
    """A test is too long to be asked; no exception that the project catches, as a claim does."""


class Recorder:
    """What a test enters and how long it takes, with the fixtures that it shares with others."""

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
        """Return the processor seconds of the last test and what it entered."""
        seconds = max(0.0, _spent() - self._begin - self._elsewhere)
        entered_ = set(self._names)
        for fixture in getattr(item, "fixturenames", ()):
            took, more = self._shared.get(fixture, (0.0, set()))
            seconds += took
            entered_ |= more
        return {"seconds": seconds, "entered": sorted(entered_)}


def forget() -> None:
    """Empty all caches of the project and its tests, as a child that runs a single test finds them.

    What one test leaves in them another would not enter, and would seem cheaper than it is alone.
    """
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] in (*entered.PACKAGES, "tests") and name not in KEPT_WARM:
            for value in list(vars(module).values()):
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def _spent() -> float:
    """Return the processor seconds of this process and of the children that have ended."""
    return sum(os.times()[:4])


def _too_long(*_: object) -> None:
    raise TooLong
