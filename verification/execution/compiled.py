"""numba's ``njit``, with compiled code kept on disk until any source of this package changes.

numba by itself looks only at the file in which a compiled function stands: after a change in a
function that it calls from another file, the old code would go on being used, in silence.

It also calls the machine code of a function by the function's name and a number that counts the
functions of the process. Two functions of one name that processes of their own have compiled, as
the right-hand sides of two chains that one factory makes, can thus have one symbol; a third process
that loads the code of both from disk gets one of them in both places. So a function that is made
inside another one is named after its content here.
"""

from __future__ import annotations

import atexit
import hashlib
import logging
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import CodeType
from typing import Any, TypeVar, overload

import numba
from numba.core import caching, config

from verification.execution.digest import digest_of_files

__all__ = ["njit"]

Function = TypeVar("Function", bound=Callable[..., Any])

logger = logging.getLogger(__name__)

_HOME = Path(__file__).parents[1]
_PREFIX, _OPTION = "compiled-", "CACHE_DIR"
_WEEK = 7 * 86400.0


@overload
def njit(function: Function, /) -> Function: ...


@overload
def njit(**options: Any) -> Callable[[Function], Function]: ...


def njit(*function: Callable[..., Any], **options: Any) -> Any:
    """Compile as ``numba.njit`` does, by a name that tells functions of other content apart.

    Parameters
    ----------
    *function : callable
        The function, where it is used without options.
    **options
        Of ``numba.njit``.

    Returns
    -------
    callable
        The compiled function, or what compiles it.
    """
    compiler = numba.njit(**options)
    if function:
        return compiler(_named(function[0]))
    return lambda later: compiler(_named(later))


def _named(function: Callable[..., Any]) -> Callable[..., Any]:
    """Put a digest of its content into the name of a function that is made inside another one."""
    if "<locals>" in function.__qualname__ and "#" not in function.__qualname__:
        digest = hashlib.sha256(_content(function).encode()).hexdigest()[:16]
        function.__qualname__ += f"#{digest}"
    return function


def _content(of: Any) -> str:
    """Return what a function does, as text: its code, and what it closes over."""
    plain = getattr(of, "py_func", of)
    if isinstance(plain, CodeType):
        parts = (plain.co_code, plain.co_names, *map(_content, plain.co_consts))
        return repr(parts)
    if isinstance(plain, (list, tuple)):
        return repr(tuple(map(_content, plain)))
    if hasattr(plain, "__code__"):
        closed = [cell.cell_contents for cell in plain.__closure__ or ()]
        name = f"{plain.__module__}.{plain.__qualname__}"
        return repr((name, _content(plain.__code__), *map(_content, closed)))
    if hasattr(plain, "tobytes"):
        return repr((plain.dtype.str, plain.shape, plain.tobytes()))
    if isinstance(plain, (int, float, complex, str, bytes, type(None))):
        return repr(plain)
    return f"{type(plain).__name__} {getattr(plain, '__name__', plain)}"


def source_digest(folder: Path = _HOME) -> str:
    """Digest of the Python files in a folder and below that have compiled functions.

    Examples
    --------
    >>> source_digest() == source_digest()
    True
    """
    compiled = [path for path in folder.rglob("*.py") if b"njit" in path.read_bytes()]
    return digest_of_files(folder, compiled)[:16]


def keep_compiled_code() -> Path:
    """Name, and return, a folder for this state of the sources; remove old ones unused a week."""
    base = next(base for base in _places() if _can_be_written(base))
    folder = base / f"{_PREFIX}{source_digest(_HOME)}"
    if not folder.exists():
        logger.info("compiling the steppers: ten seconds or more, once")
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
