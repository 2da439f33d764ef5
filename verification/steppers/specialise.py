"""Compiled functions as arguments of compiled functions, with both stored on disk."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from types import FunctionType
from typing import Any

from numba import cfunc

from theory.cells.function_content import function_content
from verification.execution.compiled import DISTINCT_NAMES, OuterCompiler


def source_mark(function: Callable[..., Any]) -> str:
    """Return a name for a function that is different for functions that do different things.

    Functions of one definition differ if they capture different values.

    Raises
    ------
    ParameterError
        If the function captures a value whose content cannot be read.

    Examples
    --------
    >>> from theory.chains.vdp import vdp_acceleration
    >>> source_mark(vdp_acceleration).rpartition(".")[0]
    'theory.chains.vdp.vdp_acceleration'
    """
    plain: Any = getattr(function, "py_func", function)
    mark = hashlib.sha256(function_content(function).encode()).hexdigest()[:12]
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
