"""A task by its name, its parameters and its code, with which a stored result is compared."""

from __future__ import annotations

import dataclasses
import functools
import itertools
from collections.abc import Iterator, Mapping
from enum import Enum
from typing import Any

import numpy as np

from theory.parameters import ParameterError
from verification.execution.columns import plain
from verification.execution.digest import digest_of_arrays


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
        inner = _captured(task)
        return {"is": task_name(task), **parameters_of(inner)} if inner else task_name(task)
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
        yield task
        for value in _captured(task).values():
            yield from code_owners(value)
