"""The content of a function for compilation as text: its code, options, and captured values."""

from __future__ import annotations

import dis
import hashlib
import sys
from collections.abc import Iterator
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from theory.parameters import ParameterError

_PLAIN = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis))
_LIBRARIES = {*sys.stdlib_module_names, "numpy", "numba", "scipy"}


def function_content(function: Any, within: tuple[Any, ...] = ()) -> str:
    """Return a text that is different for functions that do different things once compiled.

    Parameters
    ----------
    function : callable
        A function compiled by ``numba.njit``, or one that can be.
    within : tuple of callable
        Functions by which this one is called, so that recursive functions are read only once.

    Raises
    ------
    ParameterError
        If the function captures a value whose content cannot be read.
    """
    if any(function is each for each in within):
        return function.__name__  # type: ignore[no-any-return]
    within = (*within, function)
    plain, own = getattr(function, "py_func", function), getattr(function, "targetoptions", {})
    parts = [_code(plain.__code__), _value(plain.__defaults__, "a default", within)]
    for options in (own, plain.__kwdefaults__ or {}):
        parts += [f"{key}={_value(options[key], key, within)}" for key in sorted(options)]
    for name, value in sorted(_captured(plain).items()):
        parts.append(f"{name}={_value(value, name, within)}")
    return "\n".join(parts)


def _codes(code: CodeType) -> Iterator[CodeType]:
    """Yield a code object and those of the functions inside it."""
    yield code
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield from _codes(each)


def _code(code: CodeType) -> str:
    constants = [_constant(each) for each in code.co_consts]
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    return f"{code.co_code.hex()} {constants} {names}"


def _constant(value: object) -> str:
    if isinstance(value, CodeType):
        return _code(value)
    if isinstance(value, frozenset):  # in another order in every process
        return f"set({sorted(map(repr, value))})"
    return repr(value)


def _captured(plain: FunctionType) -> dict[str, Any]:
    """Return the captured values of a function by name, including attributes of modules."""
    codes = list(_codes(plain.__code__))
    words = [(each.opname, each.argval) for code in codes for each in dis.get_instructions(code)]
    found = {
        name: plain.__globals__[name]
        for kind, name in words
        if kind in ("LOAD_GLOBAL", "LOAD_NAME") and name in plain.__globals__
    }
    for name, cell in zip(plain.__code__.co_freevars, plain.__closure__ or (), strict=True):
        found[name] = cell.cell_contents
    attributes = {name for kind, name in words if kind in ("LOAD_ATTR", "LOAD_METHOD")}
    return _without_modules(found, attributes)


def _without_modules(found: dict[str, Any], attributes: set[str]) -> dict[str, Any]:
    """Return the values with each module replaced by those of its attributes that are used."""
    places, read = list(found), []
    for place in places:
        if not isinstance(found[place], ModuleType):
            continue
        module = found.pop(place)
        if _of_library(module.__name__) or module in read:
            continue
        read.append(module)
        for name in attributes & {*vars(module)}:
            found[f"{place}.{name}"] = vars(module)[name]
            places.append(f"{place}.{name}")
    return found


def _of_library(module: str | None) -> bool:
    """Return whether the versions of Python, numpy, numba and scipy determine a module's code."""
    return (module or "").partition(".")[0] in _LIBRARIES


def _value(value: Any, name: str, within: tuple[Any, ...]) -> str:
    """Return the content of a captured value as text."""
    kind = type(value)
    if kind in _PLAIN:
        return repr(value)
    if isinstance(value, tuple):
        fields = getattr(kind, "_fields", "")
        return f"{fields}({', '.join(_value(each, name, within) for each in value)})"
    if kind in (set, frozenset):
        return f"set({sorted(_value(each, name, within) for each in value)})"
    if isinstance(value, (np.ndarray, np.generic)) and not value.dtype.hasobject:
        return f"{value.dtype} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
    value = getattr(value, "_dispatcher", value)  # of a function that numba vectorises
    if hasattr(value, "py_func") and hasattr(value, "targetoptions"):
        return function_content(value, within)
    if kind is type and issubclass(value, tuple) and hasattr(value, "_fields"):
        return f"{value.__qualname__}{value._fields}"
    if isinstance(value, (BuiltinFunctionType, FunctionType, type)):
        if _of_library(value.__module__):
            return f"{value.__module__}.{value.__qualname__}"
        if isinstance(value, FunctionType):  # compiled where it is called, if numba knows it
            return function_content(value, within)
    elif kind is np.ufunc or kind.__module__.startswith("numba.core.types"):
        return str(value)
    raise ParameterError(
        f"the variable {name}, which {within[-1].__name__} takes from outside", kind.__name__,
        "a number, a text, an array or a tuple of these, or a function compiled by numba.njit",
        "give its numbers as such, or as named parameters",
    )  # fmt: skip
