"""Compiling one loop for several right-hand sides and stop conditions, so that disk keeps it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from types import FunctionType
from typing import Any

from verification.execution.compiled import njit


@lru_cache(maxsize=256)
def source_mark(function: Callable[..., Any]) -> str:
    """Return a name for a function that changes with the file in which it stands.

    Examples
    --------
    >>> source_mark(source_mark.__wrapped__).split(".")[0]
    'verification'
    """
    plain: Any = getattr(function, "py_func", function)
    code = plain.__code__
    try:
        content = Path(code.co_filename).read_bytes()
    except OSError:  # typed in at a prompt
        content = code.co_code + repr((code.co_consts, code.co_names)).encode()
    mark = hashlib.sha256(content).hexdigest()[:12]
    return f"{plain.__module__}.{plain.__qualname__}.{mark}"


def specialised(function: Any, mark: str, **names: Any) -> Any:
    """Compile a copy of a function in which some global names mean other compiled functions.

    The compiled code is kept on disk. numba does not find again what it has compiled for closures
    over, or arguments that are, other compiled functions: it knows these by a number that is drawn
    anew in every process. A copy with globals of its own has no such parts.

    Parameters
    ----------
    function : callable
        A plain function of a module.
    mark : str
        What tells this copy from others of the function; it must say all that ``names`` mean.
    **names
        The global names, and what they mean in the copy.
    """
    copy = FunctionType(function.__code__, {**function.__globals__, **names}, function.__name__)
    copy.__module__ = function.__module__
    copy.__qualname__ = f"{function.__qualname__}-{hashlib.sha256(mark.encode()).hexdigest()[:16]}"
    return njit(cache=True)(copy)
