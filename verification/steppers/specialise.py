"""Compiled functions as arguments of compiled functions, with both stored on disk."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from types import FunctionType
from typing import Any

from numba import cfunc

from verification.execution.compiled import DISTINCT_NAMES, OuterCompiler


@lru_cache(maxsize=256)
def source_mark(function: Callable[..., Any]) -> str:
    """Return a name for a function that changes whenever the file that defines it changes.

    Examples
    --------
    >>> source_mark(source_mark.__wrapped__).split(".")[0]
    'verification'
    """
    plain: Any = getattr(function, "py_func", function)
    code = plain.__code__
    try:
        content = Path(code.co_filename).read_bytes()
    except OSError:  # defined interactively
        content = code.co_code + repr((code.co_consts, code.co_names)).encode()
    mark = hashlib.sha256(content).hexdigest()[:12]
    return f"{plain.__module__}.{plain.__qualname__}.{mark}"


def pointer(function: Any, signature: Any, mark: str, **names: Any) -> Any:
    """Return a compiled function that other compiled functions accept as an argument.

    It is compiled or loaded from disk once in a process. Both it and the function that accepts it
    are stored on disk, since numba takes the signature alone as the type of such an argument.
    Arguments or closures compiled by ``njit`` are instead identified by a number that differs in
    every process, so that everything is compiled again.

    Parameters
    ----------
    function : callable
        A function in a module, plain or compiled by ``njit``, in which case its options are used.
    signature
        Its types, in numba's notation.
    mark : str
        Distinguishes it from other versions of this function; it must reflect all of ``names``.
    **names
        Global names of the function, and the objects to which they refer.
    """
    plain: Any = getattr(function, "py_func", function)
    options = getattr(function, "targetoptions", {})
    key = (plain.__module__, plain.__qualname__, mark, signature)
    if key not in _COMPILED:
        copy = FunctionType(plain.__code__, {**plain.__globals__, **names}, plain.__name__)
        copy.__module__ = plain.__module__
        copy.__qualname__ = f"{plain.__qualname__}-{hashlib.sha256(mark.encode()).hexdigest()[:16]}"
        compiler: dict[str, Any] = {"cache": DISTINCT_NAMES, "pipeline_class": OuterCompiler}
        _COMPILED[key] = cfunc(signature, **compiler, **options)(copy)
    return _COMPILED[key]


_COMPILED: dict[tuple[str, str, str, Any], Any] = {}
