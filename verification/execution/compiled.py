"""Compiled code, kept on disk until a source file of this package or the compiler changes.

numba itself checks only the file that contains a compiled function: after a change in a function
that is called from another file, it would silently continue to use the old code.

It also calls the machine code of a function by the function's name and a number that counts the
functions of the process, from 1. Code loaded from disk brings along the code it calls, under the
names of the process that compiled it. If two such names coincide, as for the right-hand sides of
two chains made by one factory, the linker takes the first, and a chain would be integrated with the
right-hand side of another one. Therefore the count begins at a random number here.
"""

from __future__ import annotations

import atexit
import itertools
import logging
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from numba.core import caching, config
from numba.core.bytecode import FunctionIdentity

from theory import compiler
from theory.compiled_code import FOLDER, remove_unused
from theory.compiler import COUNTED, UNCOUNTED, OuterCompiler, inner, outer
from theory.interruption import compile_uninterrupted
from verification.execution.digest import digest_of, digest_of_files

__all__ = ["COUNTED", "DISTINCT_NAMES", "UNCOUNTED", "OuterCompiler", "inner", "outer"]

logger = logging.getLogger(__name__)

_HOME = Path(__file__).parents[1]
_PREFIX = "compiled-"
_DECORATOR = re.compile(rb"\b(njit|(friction_)?(inner|outer)|fast|vectorised)\b")


def _count_from_random() -> bool:
    """Let numba count functions from a random number; return whether this version can do so."""
    if not isinstance(getattr(FunctionIdentity, "_unique_ids", None), itertools.count):
        return False
    FunctionIdentity._unique_ids = itertools.count(int.from_bytes(os.urandom(6), "big"))
    return True


DISTINCT_NAMES = _count_from_random()
"""Whether functions have distinct names; if not, no caller of closures is stored on disk."""


def source_digest(folder: Path) -> str:
    """Digest of the compiler, and of the Python files below a folder with compiled functions.

    Examples
    --------
    >>> source_digest(_HOME) == source_digest(_HOME)
    True
    """
    own = Path(compiler.__file__)
    parts = (folder, files_with_compiled_functions(folder)), (own.parent, [own])
    return digest_of([digest_of_files(*part) for part in parts])[:16]


def files_with_compiled_functions(folder: Path) -> list[Path]:
    """Return the Python files in a folder and below in which a compiling decorator is named."""
    return [path for path in folder.rglob("*.py") if _DECORATOR.search(path.read_bytes())]


def keep_compiled_code() -> Path:
    """Name and return a folder for this state of the sources; remove old ones unused for a week."""
    base = next(base for base in _places() if _can_be_written(base))
    folder = base / f"{_PREFIX}{source_digest(_HOME)}"
    if not folder.exists():
        logger.info("compiling the steppers: some seconds, once")
        remove_unused(base.glob(f"{_PREFIX}*"))
    setattr(config, FOLDER, str(folder))
    return folder


def _places() -> Iterator[Path]:
    """Yield possible folders for compiled code; the last one exists until this process ends."""
    given = getattr(config, FOLDER)
    if given:
        yield Path(given)
    yield _HOME / "__pycache__"
    with suppress(RuntimeError):  # no home
        yield Path.home() / ".cache" / "fronts"
    # A folder of known name in a world-writable place could have been prepared by somebody else.
    temporary = tempfile.mkdtemp(prefix="fronts-")
    atexit.register(shutil.rmtree, temporary, ignore_errors=True)
    os.environ[f"NUMBA_{FOLDER}"] = temporary  # for worker processes
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
    """Replace numba's guard of its files, which lets a full disk abort the computation.

    Stored code names the module in which its function was defined; where the file of the function
    has since been imported under another name, it is compiled again.
    """
    try:
        yield
    except (OSError, ImportError) as error:
        logger.info("compiled code is not on disk: %s", error)


keep_compiled_code()
compile_uninterrupted()
setattr(caching.Cache, "_guard_against_spurious_io_errors", _storing_may_fail)  # noqa: B010
