"""A task by its name, its parameters and its code, with which a stored result is compared."""

from __future__ import annotations

import dataclasses
import functools
import itertools
from collections.abc import Iterator, Mapping
from contextlib import suppress
from enum import Enum
from types import CodeType, FunctionType, ModuleType
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

    Raises
    ------
    ParameterError
        If it holds something that JSON cannot represent.
    """
    if isinstance(task, functools.partial):
        named = {str(i): value for i, value in enumerate(task.args)} | task.keywords
        return {name: parameters_of(value) for name, value in named.items()}
    if dataclasses.is_dataclass(task) and not isinstance(task, type):
        fields = {f.name: parameters_of(getattr(task, f.name)) for f in dataclasses.fields(task)}
        return {"is": task_name(task), **fields}
    if isinstance(task, Enum):
        return task.value
    if isinstance(task, np.ndarray):
        return {"array": digest_of_arrays({"": task})}
    if isinstance(task, Mapping):
        return {str(name): parameters_of(value) for name, value in task.items()}
    if isinstance(task, tuple | list):
        return [parameters_of(value) for value in task]
    if callable(task):
        inner = parameters_of(_captured(task)) | _session_parameters(task)
        return {"is": task_name(task), **inner} if inner else task_name(task)
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


def _captured(task: object) -> dict[str, Any]:
    """Return the default arguments and the captured variables of a function."""
    code = getattr(task, "__code__", None)
    if code is None:
        return {}
    cells = zip(code.co_freevars, getattr(task, "__closure__", None) or (), strict=False)
    defaults = {f"default {i}": v for i, v in enumerate(getattr(task, "__defaults__", None) or ())}
    return defaults | (getattr(task, "__kwdefaults__", None) or {}) | {
        name: cell.cell_contents for name, cell in cells
    }  # fmt: skip


def _session_parameters(task: object) -> dict[str, Any]:
    """Return what a function takes from a script or session besides its arguments, as JSON data.

    Functions there are represented by their defaults and captured variables. Values that JSON
    cannot represent are left out.
    """
    functions, values = _used_in_session(task)
    found: dict[str, Any] = {}
    for name, function in functions.items():
        if inner := _captured(function):
            found[name] = parameters_of(inner)
    for name, value in values.items():
        with suppress(ParameterError):
            found[name] = parameters_of(value)
    return found


def _used_in_session(task: object) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the functions and the variables of its script or session that a function uses.

    Variables used by these functions are included. For a function in an importable module both are
    empty, since the code of the module determines them.
    """
    functions: dict[str, Any] = {}
    values: dict[str, Any] = {}
    if not isinstance(task, FunctionType) or source_of(task.__module__) is not None:
        return functions, values
    session, pending = task.__globals__, [task.__code__]
    while pending:
        code = pending.pop()
        pending += [each for each in code.co_consts if isinstance(each, CodeType)]
        for name in code.co_names:
            value = session.get(name)
            plain_function: Any = getattr(value, "py_func", value)
            if name in functions or name in values or value is task or value is None:
                continue
            if getattr(plain_function, "__globals__", None) is session:
                functions[name] = plain_function
                pending.append(plain_function.__code__)
            elif not isinstance(value, ModuleType | type) and not callable(value):
                values[name] = value
    return functions, values


def code_owners(task: object) -> Iterator[Any]:
    """Yield everything that has code: functions, and the classes of objects."""
    if isinstance(task, functools.partial):
        yield from code_owners(task.func)
        for value in (*task.args, *task.keywords.values()):
            yield from code_owners(value)
    elif dataclasses.is_dataclass(task) and not isinstance(task, type):
        yield type(task)
        for each in dataclasses.fields(task):
            yield from code_owners(getattr(task, each.name))
    elif isinstance(task, tuple | list):
        yield from itertools.chain.from_iterable(map(code_owners, task))
    elif isinstance(task, Mapping):
        yield from itertools.chain.from_iterable(map(code_owners, task.values()))
    elif callable(task):
        for each in (task, *_used_in_session(task)[0].values()):
            yield each
            for value in _captured(each).values():
                yield from code_owners(value)
