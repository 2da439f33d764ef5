"""Compiling many changes at once, one of which is selected when the code runs.

A changed function is compiled again within all compiled functions that call it. That takes seconds,
while the tests that notice the change often take milliseconds. Functions with changes are therefore
compiled as a choice between their original and changed versions, and a child that tests one of the
changes selects it by writing its number to a fixed place in memory.
"""

from __future__ import annotations

import ctypes
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from types import CodeType, FunctionType
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.dispatcher import Dispatcher
from numba.extending import intrinsic

from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.recompiled import compile_again, concerned_by, made, with_code

Replacement = tuple[Any, CodeType]
"""A dispatcher, and the changed code of its function."""

_selected = ctypes.c_int64(0)
_ADDRESS = ctypes.addressof(_selected)


def select(number: int) -> None:
    """Let a change be in effect in this process; 0 for none."""
    _selected.value = number


@intrinsic
def _number_selected(context: Any) -> tuple[Any, Callable[..., Any]]:
    def read(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        place = ir.Constant(ir.IntType(64), _ADDRESS).inttoptr(ir.IntType(64).as_pointer())
        return builder.load(place)

    return types.int64(), read


class Alternatives:
    """Changes that are compiled together with the original code.

    Parameters
    ----------
    mutants : sequence of Mutant
        The changes.
    replacements : callable
        Returns the dispatchers of a changed function, each with the changed code.

    Attributes
    ----------
    numbers : dict
        The number by which each change is selected. Those that have none cannot stand beside the
        original: a callback, a constant or the type of a result is changed, or a function that has
        not been compiled so far.
    failed : dict
        For each change that cannot be compiled, the name of the error.
    """

    def __init__(
        self, mutants: Sequence[Mutant], replacements: Callable[[Mutant], Iterable[Replacement]]
    ) -> None:
        self.numbers: dict[str, int] = {}
        self.failed: dict[str, str] = {}
        again: dict[int, Any] = {}
        versions: dict[Any, dict[int, Any]] = defaultdict(dict)
        for number, mutant in enumerate(mutants, start=1):
            concerned, pairs = concerned_by(mutant), list(replacements(mutant))
            try:
                compiled = [_version(*pair) for pair in pairs]
            except Exception as error:  # numba raises any kind for code that has no types
                self.failed[mutant.name] = type(error).__name__
                continue
            if compiled and None not in compiled:
                self.numbers[mutant.name] = number
                again |= {id(each): each for each in concerned}
                for (each, _), version in zip(pairs, compiled, strict=True):
                    versions[each][number] = version
        try:
            for each, of_it in versions.items():
                each._compiler.py_func = _choice(each, of_it)
            compile_again(list(again.values()))
        finally:
            for each in versions:
                each._compiler.py_func = each.py_func


def _version(dispatcher: Any, code: CodeType) -> Any:
    """Compile changed code for the same arguments; return None if it cannot replace the original.

    It calls other functions in their original form, since only one change is selected at a time.
    """
    known: Any = dispatcher
    if not isinstance(known, Dispatcher) or not known.overloads:
        return None
    version: Any = _compiled_like(known, with_code(known.py_func, code))
    originals: dict[Any, Any] = known.overloads
    for given, result in originals.items():
        version.compile(given)
        if version.overloads[given].signature.return_type != result.signature.return_type:
            return None
    return version


def _compiled_like(dispatcher: Any, function: FunctionType) -> Any:
    """Return a dispatcher of another function with the same options, called by compiled code."""
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, **dispatcher.targetoptions}
    found = type(dispatcher)(
        function,
        locals=dispatcher.locals,
        targetoptions=options,
        pipeline_class=dispatcher._compiler.pipeline_class,
    )
    made.remove(found)
    return found


def _choice(dispatcher: Any, versions: dict[int, Any]) -> FunctionType:
    """Return a function that calls the selected version of a compiled function."""
    code = dispatcher.py_func.__code__
    arguments = ", ".join(code.co_varnames[: code.co_argcount])
    original = _compiled_like(dispatcher, with_code(dispatcher.py_func, code))
    space: dict[str, Any] = {"_number_selected": _number_selected, "_original": original}
    lines = [f"def chosen({arguments}):", "    number = _number_selected()"]
    for number, version in versions.items():
        space[f"_version_{number}"] = version
        lines += [f"    if number == {number}:", f"        return _version_{number}({arguments})"]
    exec("\n".join([*lines, f"    return _original({arguments})"]), space)
    chosen: FunctionType = space["chosen"]
    chosen.__defaults__ = dispatcher.py_func.__defaults__
    return chosen
