"""A task by its name, its parameters and its code, with which a stored result is compared."""

from __future__ import annotations

import dataclasses
import functools
import inspect
import itertools
from collections.abc import Iterator, Mapping
from contextlib import suppress
from enum import Enum
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from theory.parameters import ParameterError
from verification.execution.columns import plain
from verification.execution.digest import digest_of_arrays
from verification.execution.imports import source_of


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


def parameters_of(task: object) -> Any:
    """Return the parameters of a function or object as JSON data.

    For a task from a script or session, they include what it uses there, as ``session``.

    Raises
    ------
    ParameterError
        If it holds something that JSON cannot represent.
    """
    if isinstance(task, functools.partial):
        named = {str(i): value for i, value in enumerate(task.args)} | task.keywords
        called = parameters_of(task.func)
        held = called if isinstance(called, dict) else {}
        return held | {name: parameters_of(value) for name, value in named.items()}
    if isinstance(task, Enum):
        return task.value
    if isinstance(task, np.ndarray):
        return {"array": digest_of_arrays({"": task})}
    if isinstance(task, Mapping):
        return {str(name): parameters_of(value) for name, value in task.items()}
    if isinstance(task, tuple | list):
        return [parameters_of(value) for value in task]
    if _is_dataclass(task) or callable(task):
        inner = parameters_of(_held(task))
        if session := _session_parameters(task):
            inner["session"] = session
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


def code_owners(task: object) -> Iterator[Any]:
    """Yield everything that has code: functions, and the classes of objects."""
    if isinstance(task, functools.partial):
        yield from code_owners(task.func)
        yield from code_owners((*task.args, *task.keywords.values()))
    elif isinstance(task, tuple | list):
        yield from itertools.chain.from_iterable(map(code_owners, task))
    elif isinstance(task, Mapping):
        yield from code_owners(tuple(task.values()))
    elif _is_dataclass(task) or callable(task):
        owner = task.__self__ if isinstance(task, MethodType) else task
        yield owner if hasattr(owner, "__qualname__") else type(owner)
        yield from code_owners(_held(task))
        functions, values = _used_in_session(task)
        for function in functions.values():
            yield function
            yield from code_owners(_held(function))
        for value in values.values():
            yield from [value] if isinstance(value, ModuleType) else code_owners(value)


def _is_dataclass(task: object) -> bool:
    return dataclasses.is_dataclass(task) and not isinstance(task, type)


def _held(task: Any) -> dict[str, Any]:
    """Return the fields or attributes of an object, or the defaults and captures of a function."""
    if _is_dataclass(task):
        return {each.name: getattr(task, each.name) for each in dataclasses.fields(task)}
    if isinstance(task, MethodType):
        owner = task.__self__
        known = _is_dataclass(owner) or isinstance(owner, type)
        return {"self": owner if known else getattr(owner, "__dict__", {})}
    function = _function(task)
    if function is None:
        return {} if isinstance(task, type) else dict(getattr(task, "__dict__", {}))
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    defaults = {f"default {i}": value for i, value in enumerate(function.__defaults__ or ())}
    return defaults | (function.__kwdefaults__ or {}) | {
        name: cell.cell_contents for name, cell in cells
    }  # fmt: skip


def _function(task: object) -> FunctionType | None:
    """Return the function of Python that a wrapped or compiled one stands for, or None."""
    plain_function = inspect.unwrap(getattr(task, "py_func", task))  # type: ignore[arg-type]
    return plain_function if isinstance(plain_function, FunctionType) else None


def _session_parameters(task: object) -> dict[str, Any]:
    """Return what a task takes from its script or session, as JSON data.

    Functions there are represented by their defaults and captured variables. Values that JSON
    cannot represent are left out.
    """
    functions, values = _used_in_session(task)
    found: dict[str, Any] = {}
    for name, function in functions.items():
        if inner := _held(function):
            found[name] = parameters_of(inner)
    for name, value in values.items():
        if not isinstance(value, ModuleType | type | FunctionType | BuiltinFunctionType):
            with suppress(ParameterError):
                found[name] = parameters_of(value)
    return found


def _used_in_session(task: object) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the functions and the variables of its script or session that a task uses.

    Variables used by these functions are included. For a task from an importable module both are
    empty, since the code of the module determines them.
    """
    functions: dict[str, Any] = {}
    values: dict[str, Any] = {}
    own = _methods(task)
    pending = [(each.__code__, each.__globals__) for each in own
               if source_of(each.__module__) is None]  # fmt: skip
    while pending:
        code, session = pending.pop()
        pending += [(each, session) for each in code.co_consts if isinstance(each, CodeType)]
        for name in code.co_names:
            value = session.get(name)
            if name in functions or name in values or value is None or value is task:
                continue
            function = _function(value)
            if function is not None and function.__globals__ is session:
                functions[name] = function
                pending.append((function.__code__, session))
            else:
                values[name] = value
    return functions, values


def _methods(task: object) -> list[FunctionType]:
    """Return the functions that a call of a task can enter first."""
    function = _function(task)
    if function is not None:
        return [function]
    owner = task.__self__ if isinstance(task, MethodType) else task
    kind = owner if isinstance(owner, type) else type(owner)
    return [each for each in vars(kind).values() if isinstance(each, FunctionType)]
