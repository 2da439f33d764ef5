"""numba's ``njit``, with compiled code kept on disk until any source of this package changes.

numba by itself looks only at the file in which a compiled function stands: after a change in a
function that it calls from another file, the old code would go on being used, in silence.

It also calls the machine code of a function by the function's name and a number that counts the
functions of the process, from 1. Code from disk brings along what it calls, under the names of the
process that compiled it; where two such names meet, as of the right-hand sides of two chains that
one factory makes, the linker takes the first, and a chain would be stepped with the right-hand side
of another. So the count begins at a random number here.
"""

from __future__ import annotations

import atexit
import gc
import itertools
import logging
import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar

from llvmlite import binding
from numba import njit, types
from numba.core import caching, config
from numba.core.bytecode import FunctionIdentity
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, Flags

from verification.execution.digest import digest_of_files

__all__ = ["COUNTED", "DISTINCT_NAMES", "UNCOUNTED", "OuterCompiler", "inner", "outer"]

logger = logging.getLogger(__name__)

_HOME = Path(__file__).parents[1]
_PREFIX, _OPTION = "compiled-", "CACHE_DIR"
_WEEK = 7 * 86400.0
_SKIPPED = {
    "with_lifting",
    "inline_closure_likes",
    "make_function_op_code_to_jit_function",
    "inline_inlinables",
    "find_literally",
    "literal_unroll",
    "LiteralPropagation",
}
_DECORATOR = re.compile(rb"\b(njit|inner|outer|fast|vectorised)\b")

UNCOUNTED: dict[str, Any] = {"_nrt": False}
"""Options of functions that make no arrays: no references are counted to those that they are given.

numba counts by atomic instructions at every slice and every call; where arrays are short, this
takes more than half of the time. What they call makes none either, unless it is ``COUNTED``."""
COUNTED: dict[str, Any] = {"_nrt": True}

Function = TypeVar("Function", bound=Callable[..., Any])


class _PartOfItsCallers(JITCodeLibrary):
    """Code that becomes machine code only as a part of what calls it.

    numba optimises and translates each function by itself, and then once more in each that calls
    it, at every level; of functions that Python cannot call, only the second is of use.
    """

    def finalize(self) -> None:
        for library in dict.fromkeys(self._linking_libraries):
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0, as numba does for a function that Python cannot call."""
        return 0

    @property
    def codegen(self) -> Any:
        """Return where numba puts the Python objects that machine code uses."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing; a function that uses such objects ends with "missing Environment"."""


class _Rolled(JITCodeLibrary):
    """Code whose loops are vectorised, but not unrolled."""

    def _optimize_final_module(self) -> None:
        codegen: Any = self._codegen
        if not hasattr(codegen, "_pass_builder"):  # as in numba before 0.62
            whole: Any = super()._optimize_final_module
            whole()
            return
        module = self._final_module
        passes, builder = codegen._module_pass_manager(loop_vectorize=False, opt=0, cost="cheap")
        passes.run(module, builder)
        choice = binding.create_pipeline_tuning_options(speed_level=3)
        choice.loop_vectorization, choice.loop_unrolling = True, False
        builder = binding.create_pass_builder(codegen._tm, choice)
        builder.getModulePassManager().run(module, builder)


class _Flags(Flags):
    """Options of a compilation; numba looks what it knows up by them some 50 000 times."""

    def __hash__(self) -> int:
        return hash(frozenset(self._values))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Flags) and bool(self._values == other._values)


class _ShortCompiler(Compiler):
    """numba's compiler, without passes for what functions here do not have."""

    def __init__(  # noqa: PLR0917  (as numba's)
        self, typing: Any, target: Any, library: Any, args: Any, returned: Any, flags: Any, own: Any
    ) -> None:
        start: Any = super().__init__
        known: Any = _Flags
        start(typing, target, library, args, returned, known(flags), own)

    def define_pipelines(self) -> list[Any]:
        """Return numba's passes but those for closures, ``with`` and loops over literals."""
        whole: Any = super().define_pipelines
        pipelines: list[Any] = whole()
        for each in pipelines:
            each.passes = [step for step in each.passes if step[0].name() not in _SKIPPED]
            each.finalize()
        return pipelines


class OuterCompiler(_ShortCompiler):
    """The same, without searches for garbage, a tenth of the time: nearly all is in use."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function, and all that it calls and that is not compiled yet."""
        searching = gc.isenabled()
        gc.disable()
        try:
            compiled: Any = super().compile_extra
            with _operations_resolved_once(self.state.typingctx):
                return compiled(func)
        finally:
            if searching:
                gc.enable()


class _RolledCompiler(OuterCompiler):
    """The same, without unrolled loops."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        rolled: Any = _Rolled
        own = rolled(target.codegen(), "outer")
        own.enable_object_caching()
        super().__init__(typing, target, own, *rest)


@contextmanager
def _operations_resolved_once(context: Any) -> Iterator[None]:
    """Let numba look up what an operation gives once for given types of what it is applied to.

    It tries dozens of candidates for each sum, product or index of an array, wherever one stands
    and whenever inference comes by; of the friction stepper this took a seventh of the time.
    """
    resolve, known = context.resolve_function_type, {}

    def resolved(function: Any, given: Any, named: Any) -> Any:
        if named or not isinstance(function, types.Function):
            return resolve(function, given, named)
        place = (function, tuple(given))
        if place not in known:
            known[place] = resolve(function, given, named)
        return known[place]

    context.resolve_function_type = resolved
    try:
        yield
    finally:
        context.resolve_function_type = resolve


class _InnerCompiler(_ShortCompiler):
    """The same, without machine code."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        part: Any = _PartOfItsCallers
        super().__init__(typing, target, part(target.codegen(), "inner"), *rest)


def outer(*, unrolled: bool = True, **options: Any) -> Callable[[Function], Function]:
    """Compile what Python calls too.

    Loops over the few coefficients of a series are better not unrolled: where there are many, that
    is a tenth of the time to compile them, and they are no faster.
    """
    return _compiled(OuterCompiler if unrolled else _RolledCompiler, options)


def inner(**options: Any) -> Callable[[Function], Function]:
    """Compile what only compiled functions call; it is stored on disk as a part of these."""
    return _compiled(
        _InnerCompiler, {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, **options}
    )


def _compiled(compiler: type[Compiler], options: dict[str, Any]) -> Callable[[Function], Function]:
    compiled: Callable[[Function], Function] = njit(**options, pipeline_class=compiler)
    return compiled


def _count_from_random() -> bool:
    """Let numba count functions from a random number; return whether this numba can do so."""
    if not isinstance(getattr(FunctionIdentity, "_unique_ids", None), itertools.count):
        return False
    FunctionIdentity._unique_ids = itertools.count(int.from_bytes(os.urandom(6), "big"))
    return True


DISTINCT_NAMES = _count_from_random()
"""Whether functions have names of their own; if not, nothing that calls closures is stored."""


def source_digest(folder: Path = _HOME) -> str:
    """Digest of the Python files in a folder and below that have compiled functions.

    Examples
    --------
    >>> source_digest() == source_digest()
    True
    """
    return digest_of_files(folder, files_with_compiled_functions(folder))[:16]


def files_with_compiled_functions(folder: Path = _HOME) -> list[Path]:
    """Return the Python files in a folder and below in which a compiling decorator is named."""
    return [path for path in folder.rglob("*.py") if _DECORATOR.search(path.read_bytes())]


def keep_compiled_code() -> Path:
    """Name, and return, a folder for this state of the sources; remove old ones unused a week."""
    base = next(base for base in _places() if _can_be_written(base))
    folder = base / f"{_PREFIX}{source_digest(_HOME)}"
    if not folder.exists():
        logger.info("compiling the steppers: some seconds, once")
        for old in base.glob(f"{_PREFIX}*"):
            with suppress(OSError):  # another process may be removing it as well
                if old.stat().st_mtime < time.time() - _WEEK:
                    shutil.rmtree(old, ignore_errors=True)
    setattr(config, _OPTION, str(folder))
    return folder


def _places() -> Iterator[Path]:
    """Yield where compiled code may go, the last one until this process ends."""
    given = getattr(config, _OPTION)
    if given:
        yield Path(given)
    yield _HOME / "__pycache__"
    with suppress(RuntimeError):  # no home
        yield Path.home() / ".cache" / "fronts"
    # A folder of one name in a place where everybody may write could be prepared by somebody else.
    temporary = tempfile.mkdtemp(prefix="fronts-")
    atexit.register(shutil.rmtree, temporary, ignore_errors=True)
    os.environ["NUMBA_CACHE_DIR"] = temporary  # for worker processes
    logger.info("no folder for compiled code can be written; it is compiled for this run only")
    yield Path(temporary)


def _can_be_written(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder)
        os.close(handle)
        Path(name).unlink()
    except OSError:
        return False
    return True


@contextmanager
def _storing_may_fail(_: object) -> Iterator[None]:
    """Stand in for numba's guard of its files, which lets a full disk end the computation."""
    try:
        yield
    except OSError as error:
        logger.info("compiled code is not on disk: %s", error)


keep_compiled_code()
setattr(caching.Cache, "_guard_against_spurious_io_errors", _storing_may_fail)  # noqa: B010
