"""A task by its name, its parameters and its code, with which a stored result is compared."""

from __future__ import annotations

import dataclasses
import functools
import math
from argparse import Namespace
from collections.abc import Iterator, Mapping
from enum import Enum
from pickle import PicklingError
from types import BuiltinMethodType, FunctionType, MethodType, ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from theory.cells.function_content import ContentReader, captured_in_closure, words_of
from theory.parameters import ParameterError
from verification.execution.columns import plain
from verification.execution.digest import (
    digest_of,
    digest_of_arrays,
    digest_of_code,
    digest_of_packages,
)
from verification.execution.imports import SOURCES, is_library, is_ours, source_of
from verification.execution.metadata import Code


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
        called = parameters_of(task.func)
        held = called if isinstance(called, dict) else {}
        return held | {name: parameters_of(value) for name, value in named.items()}
    if isinstance(task, Enum):
        return task.value
    if isinstance(task, np.ndarray) and not task.dtype.hasobject:
        return {"array": digest_of_arrays({"": task})}
    if isinstance(task, SimpleNamespace | Namespace):
        return parameters_of(vars(task))
    if isinstance(task, Mapping):
        return {str(name): parameters_of(value) for name, value in task.items()}
    if isinstance(task, tuple | list):
        return [parameters_of(value) for value in task]
    if isinstance(task, set | frozenset):
        return {"set": sorted((parameters_of(value) for value in task), key=repr)}
    if _is_dataclass(task) or callable(task):
        inner = parameters_of(_held(task))
        return {"is": task_name(task), **inner} if inner or _is_dataclass(task) else task_name(task)
    if isinstance(task, complex):
        return {"complex": [parameters_of(task.real), parameters_of(task.imag)]}
    try:
        value = task if task is None else plain(task)
    except TypeError:
        raise ParameterError(
            "function", f"one that holds a {type(task).__name__}",
            "one that holds numbers, words and their collections where its results are stored",
            "give its parameters as fields of a frozen dataclass",
        ) from None  # fmt: skip
    if isinstance(value, float) and not math.isfinite(value):  # which JSON does not have
        return {"number": str(value)}
    return value


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
    defaults = {f"default {i}": value for i, value in enumerate(function.__defaults__ or ())}
    return defaults | (function.__kwdefaults__ or {}) | captured_in_closure(function)


def _attributes(task: object) -> dict[str, Any]:
    """Return the attributes of an object, but none of what a library defines."""
    if is_library(type(task).__module__):
        return {}
    return dict(getattr(task, "__dict__", {}))


def _function(task: Any) -> FunctionType | None:
    """Return the function itself, or that which numba has compiled or a cache wraps, or None."""
    if not isinstance(task, FunctionType | MethodType | type):
        task = getattr(task, "__wrapped__", None)
    return task if isinstance(task, FunctionType) else None


def code_of(*objects: object) -> Code:
    """Return the code of functions, classes and objects, with all that determines what it does.

    The modules are those of this project and of the user; libraries are not among them, since their
    versions are recorded. Code that is in no importable module (a script, or code typed into a
    session) is included by itself, with the variables that it uses there and with all of this
    project.

    Examples
    --------
    >>> code_of(task_name).modules
    ('verification.execution.task',)
    """
    reader = _TaskReader()
    texts = [reader.value(each, "the task") for each in objects]
    if reader.in_session:
        texts.append(digest_of_packages((*SOURCES, "fronts")))
    modules = tuple(sorted(reader.modules))
    packages = {*SOURCES, *(module.partition(".")[0] for module in modules)}
    files = digest_of_code(modules, packages, users=True)
    return Code(modules=modules, digest=digest_of([files, texts]))


class _TaskReader(ContentReader):
    """Reads what a task does and holds; of what a module defines, the module is noted.

    Attributes
    ----------
    modules : set of str
        Modules of this project and of the user in which the task has code.
    in_session : bool
        Whether it has code that is in no importable module.
    """

    def __init__(self) -> None:
        super().__init__()
        self.modules: set[str] = set()
        self.in_session = False

    def determines(self, module: str | None) -> bool:
        """Return whether a module is of a library or can be imported; the latter is noted."""
        if module is None or is_library(module):
            return True
        if source_of(module) is None:
            self.in_session = True
            return False
        if not (self.in_session and is_ours(module)):  # in a session all of this project counts
            self.modules.add(module)
        return True

    def other(self, value: Any, name: str) -> str:
        """Return the content of a function, a class, an object or a collection."""
        if isinstance(value, functools.partial):
            return self.value((value.func, value.args, value.keywords), name)
        if isinstance(value, MethodType):
            return self.value((value.__func__, value.__self__), name)
        if isinstance(value, Mapping):
            pairs = [(self.value(key, name), self.value(value[key], name)) for key in value]
            return f"{{{sorted(pairs)}}}"
        if isinstance(value, list):
            return f"[{self.value(tuple(value), name)}]"
        if isinstance(value, Enum):
            return f"{self.value(type(value), name)}.{value.name}"
        if isinstance(value, BuiltinMethodType) and not isinstance(value.__self__, ModuleType):
            return f"{value.__name__} {self.value(value.__self__, name)}"
        if isinstance(value, ModuleType):
            return value.__name__ if self.determines(value.__name__) else "a module"
        function = _function(value) or value
        if hasattr(function, "__qualname__"):
            return self._definition(function)
        return self._object(value, name)

    def _definition(self, owner: Any) -> str:
        """Return the content of a function or class."""
        module = getattr(owner, "__module__", None)
        if module is None and isinstance(owner, FunctionType):  # made by exec, as by SymPy
            self.in_session = True
            return self.function(owner)
        if not self.determines(module):
            return self._class(owner) if isinstance(owner, type) else self.function(owner)
        place = f"{module}.{owner.__qualname__}"
        if isinstance(owner, FunctionType) and not is_library(module):
            return f"{place} {self.value(tuple(sorted(_held(owner).items())), place)}"
        return place

    def _class(self, kind: type) -> str:
        """Return the content of a class of a session: its bases, and what it defines by itself."""
        parts = [self.value(base, base.__qualname__) for base in kind.__bases__]
        for name, value in sorted(vars(kind).items()):
            if callable(value) or not name.startswith("__"):
                inner = [getattr(value, each, None) for each in ("fget", "fset", "func")]
                parts += [f"{name}={self.value(each, name)}" for each in (value, *inner)]
        return f"{kind.__qualname__} {parts}"

    def _object(self, value: object, name: str) -> str:
        """Return the content of an instance of a class: the class, and its fields or state."""
        kind = self.value(type(value), name)
        if _is_dataclass(value):
            return f"{kind} {self.value(_held(value), name)}"
        try:
            state = value.__reduce_ex__(4)
        except (TypeError, AttributeError, PicklingError):  # no data that can be read
            text = repr(value)
            return kind if " at 0x" in text else f"{kind} {text}"
        if isinstance(state, tuple):  # with the items of a list or mapping as iterators
            state = tuple(tuple(each) if isinstance(each, Iterator) else each for each in state)
        return f"{kind} {self.value(state, name)}"

    def function(self, function: Any) -> str:
        """Return the content of a function, and note the modules that it imports when called."""
        module = ""
        for kind, name in words_of(getattr(function, "py_func", function).__code__):
            if kind == "IMPORT_NAME":
                module = name
                self.determines(module)
            elif kind == "IMPORT_FROM":  # perhaps of a module
                self.determines(f"{module}.{name}")
        return super().function(function)
