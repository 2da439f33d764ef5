"""The content of functions and values as text, by which stored results of them are told apart.

numba treats captured values as constants, from the first compilation of a function on. A function
whose values are changed afterwards continues to use the old ones, while its content as it can be
read has the new ones. Chains therefore take a copy (`independent_copy`), which is compiled with the
values that its content states.
"""

from __future__ import annotations

import dis
import hashlib
import sys
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from theory.parameters import ParameterError

_PLAIN = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis))
_LIBRARIES = {*sys.stdlib_module_names, "numpy", "numba", "scipy"}


def function_content(function: Any) -> str:
    """Return a text that is different for functions that do different things once compiled.

    Parameters
    ----------
    function : callable
        A function compiled by ``numba.njit``, or one that can be.

    Raises
    ------
    ParameterError
        If the function captures a value whose content cannot be read.
    """
    return ContentReader().function(function)


class ContentReader:
    """Reads functions that numba compiles, and values, as text that is the same in every process.

    A subclass may read further values, see `other`, and decide which modules determine what they
    define, see `determines`.
    """

    def __init__(self) -> None:
        self._seen: dict[int, tuple[int, Any]] = {}
        self._name = ""

    def value(self, value: Any, name: str) -> str:
        """Return the content of a value, which has this name where it is used.

        Raises
        ------
        ParameterError
            If it cannot be read.
        """
        kind = type(value)
        if kind in _PLAIN:
            return repr(value)
        if isinstance(value, CodeType):
            return _code(value)
        if isinstance(value, tuple):
            fields = getattr(kind, "_fields", "")
            return f"{fields}({', '.join(self.value(each, name) for each in value)})"
        if kind in (set, frozenset):  # in another order in every process
            seen, texts = self._seen, []
            for each in value:
                self._seen = dict(seen)
                texts.append(self.value(each, name))
            self._seen = seen
            return f"set({sorted(texts)})"
        if isinstance(value, np.ndarray | np.generic) and not value.dtype.hasobject:
            return f"{value.dtype} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
        if (known := self._seen.get(id(value))) is not None:
            return f"<{known[0]}>"
        self._seen[id(value)] = len(self._seen), value
        return self.other(value, name)

    def other(self, value: Any, name: str) -> str:
        """Return the content of a value that is none of numbers and text.

        Raises
        ------
        ParameterError
            If it cannot be read.
        """
        kind = type(value)
        value = getattr(value, "_dispatcher", value)  # of a function that numba vectorises
        if hasattr(value, "py_func") and hasattr(value, "targetoptions"):
            return self.function(value)
        if kind is type and issubclass(value, tuple) and hasattr(value, "_fields"):
            return f"{value.__qualname__}{value._fields}"
        if isinstance(value, BuiltinFunctionType | FunctionType | type):
            if self.determines(value.__module__):
                return f"{value.__module__}.{value.__qualname__}"
            if isinstance(value, FunctionType):  # compiled where it is called, if numba knows it
                return self.function(value)
        elif kind is np.ufunc or kind.__module__.startswith("numba.core.types"):
            return str(value)
        raise ParameterError(
            f"the variable {name}, which {self._name} takes from outside", kind.__name__,
            "a number, a text, an array or a tuple of these, or a function compiled by numba.njit",
            "give its numbers as such, or as named parameters",
        )  # fmt: skip

    def determines(self, module: str | None) -> bool:
        """Return whether a module determines what it defines: its version or its files are known.

        Here, those of Python, numpy, numba and scipy.
        """
        return _of_library(module)

    def function(self, function: Any) -> str:
        """Return the content of a function: code, options, defaults, and captured values."""
        self._seen.setdefault(id(function), (len(self._seen), function))
        plain, own = getattr(function, "py_func", function), getattr(function, "targetoptions", {})
        outer, self._name = self._name, plain.__name__
        parts = [self.value(plain.__code__, plain.__name__)]
        parts.append(self.value(plain.__defaults__, "a default"))
        for options in (own, plain.__kwdefaults__ or {}):
            parts += [f"{key}={self.value(options[key], key)}" for key in sorted(options)]
        for name, value in sorted(self._captured(plain).items()):
            parts.append(f"{name}={self.value(value, name)}")
        self._name = outer
        return "\n".join(parts)

    def _captured(self, plain: FunctionType) -> dict[str, Any]:
        """Return the captured values of a function by name, including attributes of modules."""
        used, attributes = _names(plain.__code__)
        found = {name: plain.__globals__[name] for name in used & plain.__globals__.keys()}
        return self._without_modules(found | captured_in_closure(plain), attributes)

    def _without_modules(self, found: dict[str, Any], attributes: frozenset[str]) -> dict[str, Any]:
        """Return the values with each module replaced by those of its attributes that are used.

        A module that determines what it defines is replaced by its name.
        """
        places, read = list(found), []
        for place in places:
            if not isinstance(found[place], ModuleType):
                continue
            module = found.pop(place)
            if self.determines(module.__name__):
                found[place] = module.__name__
                continue
            if module in read:
                continue
            read.append(module)
            for name in attributes & {*vars(module)}:
                found[f"{place}.{name}"] = vars(module)[name]
                places.append(f"{place}.{name}")
        return found


def _of_library(module: str | None) -> bool:
    return (module or "").partition(".")[0] in _LIBRARIES


def independent_copy(function: Any, made: dict[int, Any] | None = None) -> Any:
    """Return a copy of a function that later changes of what it captures do not reach.

    Captured arrays, and functions that it calls by a global name, from a closure or as attributes
    of a module, are copied as well.

    Parameters
    ----------
    function : callable
        A function compiled by ``numba.njit``, or one that can be. A copy of the former is compiled
        anew.
    made : dict, optional
        Copies already made, by the identity of the function, for functions that call each other.
    """
    made = {} if made is None else made
    if id(function) in made:
        return made[id(function)]
    plain = getattr(function, "py_func", function)
    names = dict(plain.__globals__)
    cells = tuple(CellType() for _ in plain.__closure__ or ())
    copy: Any = FunctionType(plain.__code__, names, plain.__name__, plain.__defaults__, cells)
    copy.__kwdefaults__, copy.__qualname__ = plain.__kwdefaults__, plain.__qualname__
    copy.__module__ = plain.__module__
    if plain is not function:
        copy = type(function)(
            copy, locals=function.locals, targetoptions=dict(function.targetoptions),
            pipeline_class=function._compiler.pipeline_class,
        )  # fmt: skip
    made[id(function)] = copy
    used, attributes = _names(plain.__code__)
    for name in used & names.keys():
        names[name] = _independent(names[name], made, attributes)
    captured = captured_in_closure(plain)
    for name, own in zip(plain.__code__.co_freevars, cells, strict=True):
        if name in captured:  # one that is not yet assigned remains so
            own.cell_contents = _independent(captured[name], made, attributes)
    return copy


def _independent(value: Any, made: dict[int, Any], attributes: frozenset[str]) -> Any:
    """Return a captured value, or a copy of it if it could change or calls what could.

    Of a module that is not of a library, the copy holds the attributes that are used.
    """
    kind = type(value)
    if id(value) in made:
        return made[id(value)]
    if hasattr(value, "py_func") and hasattr(value, "targetoptions"):
        return independent_copy(value, made)
    if hasattr(value, "_dispatcher"):  # of a function that numba vectorises
        made[id(value)] = kind(independent_copy(value._dispatcher.py_func, made))
    elif kind is FunctionType and not _of_library(value.__module__):
        import numba.extending

        made[id(value)] = numba.extending.register_jitable(independent_copy(value, made))
    elif kind is ModuleType and not _of_library(value.__name__):
        made[id(value)] = copy = ModuleType(value.__name__)
        for name in attributes & vars(value).keys():
            setattr(copy, name, _independent(vars(value)[name], made, attributes))
    elif isinstance(value, np.ndarray):
        return value.copy(order="K")
    elif isinstance(value, tuple):
        parts = (_independent(each, made, attributes) for each in value)
        return kind(*parts) if hasattr(value, "_fields") else tuple(parts)
    return made.get(id(value), value)


def captured_in_closure(plain: FunctionType) -> dict[str, Any]:
    """Return the values that a function captures from the function in which it is defined."""
    found = {}
    for name, cell in zip(plain.__code__.co_freevars, plain.__closure__ or (), strict=True):
        with suppress(ValueError):  # not yet assigned
            found[name] = cell.cell_contents
    return found


@lru_cache(maxsize=1024)
def _code(code: CodeType) -> str:
    """Return the content of a code object: instructions, constants and names."""
    constants = [ContentReader().value(each, code.co_name) for each in code.co_consts]
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    return f"{code.co_code.hex()} {constants} {names}"


@lru_cache(maxsize=1024)
def _names(code: CodeType) -> tuple[frozenset[str], frozenset[str]]:
    """Return the global names that a function uses, and those of attributes."""
    words = list(words_of(code))
    return (
        frozenset(name for kind, name in words if kind in ("LOAD_GLOBAL", "LOAD_NAME")),
        frozenset(name for kind, name in words if kind in ("LOAD_ATTR", "LOAD_METHOD")),
    )


def words_of(code: CodeType) -> Iterator[tuple[str, Any]]:
    """Yield the instructions of a code object, and of the functions inside it, with arguments."""
    for each in dis.get_instructions(code):
        yield each.opname, each.argval
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from words_of(constant)
