"""Putting a change in place in a child process, and running tests or checks against it.

A child begins with everything imported and all tests collected. The existing functions, classes and
constants are changed in memory, the files are left as they are, and tests run until one fails.
Code that is entered or named while modules are imported has left its results in them. If no test
fails, such changes are therefore tested again with the project imported again. What numba compiled
from the changed code is compiled again in memory; its cache on disk is not written to, and not read
in such a child.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import pytest

from benchmarks.mutation import entered
from benchmarks.mutation.children import Answer
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.places import names_bound
from benchmarks.mutation.put import fits, put_statement
from benchmarks.mutation.recompiled import compile_again, concerned_by, made, python_function
from benchmarks.mutation.session import OPTIONS, Failures, Session, dotted

if TYPE_CHECKING:
    from benchmarks.mutation.derived import DerivationChecks


class Judge:
    """Runs the tests, or the checks of the derivations, against changes."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def by_tests(
        self, mutant: Mutant, tests: Sequence[str], write: Callable[[Answer], None]
    ) -> None:
        """Run tests against a change until one fails, and write which test failed."""
        from numba.core import caching

        caching.Cache.save_overload = lambda *_: None  # type: ignore[method-assign]
        again = concerned_by(mutant)
        if again:
            caching.Cache.load_overload = lambda *_: None  # type: ignore[method-assign]
        if self._put(mutant):
            compile_again(again)
            failed = self._session.first_failing(tests)
            compiled = mutant.qualified in entered.compiled
            if failed or compiled or not self._used_on_import(mutant):
                return write({"by": failed})
        write({"by": self._anew(mutant, tests) if tests else None})

    def by_checks(
        self, mutant: Mutant, checks: DerivationChecks, write: Callable[[Answer], None]
    ) -> None:
        """Run the derivations' checks against a change; write the step whose check notices it."""
        write({"by": checks.noticing(mutant) if self._put(mutant) else None})

    def made_on_import(self, mutant: Mutant) -> bool:
        """Return whether the changed object is created, or entered, during the import."""
        at = mutant.function_at
        return not mutant.outermost or mutant.of_default or at in self._session.on_import

    def _used_on_import(self, mutant: Mutant) -> bool:
        """Return whether importing the project leaves results of the changed code elsewhere."""
        if mutant.outermost:
            return mutant.function_at in self._session.on_import
        bound = names_bound(mutant.statement)
        return not bound or not bound.isdisjoint(self._session.names_on_import)

    def seconds_to_begin(self, mutant: Mutant) -> float:
        """Return the processor seconds allowed, besides tests, for compiling or importing again."""
        if mutant.qualified in entered.compiled:
            return 12.0
        return 15.0 if self.made_on_import(mutant) else 2.0

    def _put(self, mutant: Mutant) -> bool:
        """Change the existing functions and values; return whether that was possible."""
        with mutant.made() as tree:
            if not mutant.outermost or mutant.of_default:
                return put_statement(sys.modules[dotted(mutant.module)], mutant.statement)
            code = compile(tree, str(self._session.root / mutant.module), "exec", dont_inherit=True)
        tops = [c for c in entered.codes_in(code) if c.co_qualname == mutant.outermost]
        new = [c for top in tops for c in entered.codes_in(top)]  # also nested ones it returned
        compiled = [python_function(each) for each in made]
        pairs = [
            (old, c)
            for c in new
            for old in [*self._session.living[f"{mutant.module}:{c.co_firstlineno}"], *compiled]
            if old.__code__.co_filename == c.co_filename
            and old.__code__.co_firstlineno == c.co_firstlineno
            and fits(old.__code__, c)
        ]
        for old, changed in pairs:
            old.__code__ = changed
        return bool(pairs)

    def _anew(self, mutant: Mutant, tests: Sequence[str]) -> str | None:
        """Import the project again with a change and run tests, in a session within this one."""
        with mutant.made() as tree:
            code = compile(tree, str(self._session.root / mutant.module), "exec", dont_inherit=True)
        entered.replaced[mutant.module] = code
        packages = (*entered.PACKAGES, "benchmarks", "tests")
        for name in list(sys.modules):
            if name.split(".")[0] in packages and not name.startswith("benchmarks.mutation"):
                del sys.modules[name]
        files = {name.split("::")[0] for name in tests}
        failures = Failures(tests)
        with tempfile.TemporaryDirectory(prefix="fronts-mutation-") as base:
            options = [*OPTIONS, "-x", f"--basetemp={base}/pytest"]
            code_ = pytest.main([*options, *sorted(files)], plugins=[failures])
        return failures.first or (None if code_ in (0, 5) else f"exit code {int(code_)}")
