"""A task by its name, its parameters and its code, with which a stored result is compared."""

from __future__ import annotations

import dataclasses
import functools
import itertools
from argparse import Namespace
from collections.abc import Iterator, Mapping
from contextlib import suppress
from enum import Enum
from types import FunctionType, MethodType, ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from theory.parameters import ParameterError
from verification.execution.columns import plain
from verification.execution.digest import digest_of_arrays, functions_of_class, names_in
from verification.execution.imports import is_library, source_of


def task_name(task: object) -> str:
    """Return the importable name of a function or class.

    Examples
    --------
    >>> task_name(plain)
    'verification.execution.columns.plain'
    """
    if isinstance(task, functools.partial):
        return task_name(task.func)
    owner: Any = task if hasattr(task, "__qualname__") else type(task)
    return f"{owner.__module__}.{owner.__qualname__}"


def parameters_of(task: object, *, session: bool = True) -> Any:
    """Return the parameters of a function or object as JSON data.

    For a task from a script or session, they include as ``session`` the variables that it uses
    there, except those that JSON cannot represent.

    Raises
    ------
    ParameterError
        If it holds something that JSON cannot represent.
    """
    again = functools.partial(parameters_of, session=session)
    if isinstance(task, functools.partial):
        named = {str(i): value for i, value in enumerate(task.args)} | task.keywords
        called = again(task.func)
        held = called if isinstance(called, dict) else {}
        return held | {name: again(value) for name, value in named.items()}
    if isinstance(task, Enum):
        return task.value
    if isinstance(task, np.ndarray) and not task.dtype.hasobject:
        return {"array": digest_of_arrays({"": task})}
    if isinstance(task, SimpleNamespace | Namespace):
        return again(vars(task))
    if isinstance(task, Mapping):
        return {str(name): again(value) for name, value in task.items()}
    if isinstance(task, tuple | list):
        return [again(value) for value in task]
    if isinstance(task, set | frozenset):
        return {"set": sorted((again(value) for value in task), key=repr)}
    if _is_dataclass(task) or callable(task):
        inner = again(_held(task))
        if session and (used := _session_parameters(task)):
            inner["session"] = used
        return {"is": task_name(task), **inner} if inner or _is_dataclass(task) else task_name(task)
    if isinstance(task, complex):
        return [task.real, task.imag]
    try:
        return task if task is None else plain(task)
    except TypeError:
        raise ParameterError(
            "function", f"one that holds a {type(task).__name__}",
            "one that holds numbers, words and their collections where its results are stored",
            "give its parameters as fields of a frozen dataclass",
        ) from None  # fmt: skip


def code_owners(task: object, *, session: bool = True) -> Iterator[Any]:
    """Yield everything that has code: functions, classes of objects, and modules."""
    again = functools.partial(code_owners, session=session)
    if isinstance(task, functools.partial):
        yield from again(task.func)
        yield from again((*task.args, *task.keywords.values()))
    elif isinstance(task, tuple | list):
        yield from itertools.chain.from_iterable(map(again, task))
    elif isinstance(task, Mapping):
        yield from again(tuple(task.values()))
    elif isinstance(task, ModuleType):
        yield task
    elif _is_dataclass(task) or callable(task):
        owner = task.__self__ if isinstance(task, MethodType) else task
        yield owner if hasattr(owner, "__qualname__") else type(owner)
        yield from again(_held(task))
        for value in _used_in_session(task).values() if session else ():
            yield from code_owners(value, session=False)


def _is_dataclass(task: object) -> bool:
    return dataclasses.is_dataclass(task) and not isinstance(task, type)


def _held(task: Any) -> dict[str, Any]:
    """Return the fields or attributes of an object, or the defaults and captures of a function."""
    if _is_dataclass(task):
        return {each.name: getattr(task, each.name) for each in dataclasses.fields(task)}
    if isinstance(task, MethodType):
        owner = task.__self__
        known = _is_dataclass(owner) or isinstance(owner, type)
        return {"self": owner if known else _attributes(owner)}
    function = _function(task)
    if function is None:
        return {} if isinstance(task, type) else _attributes(task)
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    defaults = {f"default {i}": value for i, value in enumerate(function.__defaults__ or ())}
    return defaults | (function.__kwdefaults__ or {}) | {
        name: cell.cell_contents for name, cell in cells
    }  # fmt: skip


def _attributes(task: object) -> dict[str, Any]:
    """Return the attributes of an object, but none of what a library defines."""
    if is_library(type(task).__module__):
        return {}
    return dict(getattr(task, "__dict__", {}))


def _function(task: Any) -> FunctionType | None:
    """Return the function itself, or that which numba has compiled or a cache wraps, or None."""
    if not isinstance(task, FunctionType | MethodType | type):
        task = getattr(task, "py_func", None) or getattr(task, "__wrapped__", None)
    return task if isinstance(task, FunctionType) else None


def _session_parameters(task: object) -> dict[str, Any]:
    """Return what a task takes from its script or session, as JSON data."""
    found: dict[str, Any] = {}
    for name, value in _used_in_session(task).items():
        with suppress(ParameterError):
            if (function := _function(value)) is None:
                if not isinstance(value, ModuleType | type) and not _is_callable_of_library(value):
                    found[name] = parameters_of(value, session=False)
            elif not is_library(function.__module__) and (inner := _held(function)):
                found[name] = parameters_of(inner, session=False)
    return found


def _is_callable_of_library(value: object) -> bool:
    return callable(value) and is_library(type(value).__module__)


def _used_in_session(task: object) -> dict[str, Any]:
    """Return the functions, classes, modules and variables of a session that a task uses there.

    Those used by these functions, and by methods of these classes, are included. For a task from an
    importable module there are none, since the code of the module determines them.
    """
    found: dict[str, Any] = {}
    pending = [each for each in _methods(task) if source_of(each.__module__) is None]
    seen = {id(each) for each in pending}
    while pending:
        function = pending.pop()
        for name in names_in(function.__code__):
            value = function.__globals__.get(name)
            if name in found or value is None or value is task:
                continue
            found[name] = value
            further = [
                each
                for each in _methods(value)
                if each.__globals__ is function.__globals__ and id(each) not in seen
            ]
            seen |= {id(each) for each in further}
            pending += further
    return found


def _methods(task: object) -> list[FunctionType]:
    """Return the functions that a call of a task, or of its methods, can enter first."""
    function = _function(task)
    if function is not None:
        return [function]
    owner = task.__self__ if isinstance(task, MethodType) else task
    kind = owner if isinstance(owner, type) else type(owner)
    return [each for base in kind.__mro__ for each in functions_of_class(base)]
