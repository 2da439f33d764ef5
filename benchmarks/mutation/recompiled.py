"""Compiling, in memory, the functions compiled by numba that a change concerns.

These are the functions whose code or constants are changed, and all compiled functions that call
them, which contain a copy of their code.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any

from benchmarks.mutation.places import names_bound

if TYPE_CHECKING:
    from benchmarks.mutation.mutants import Mutant

made: list[Any] = []
"""All dispatchers and C callbacks that exist, in the order in which they were made."""


def python_function(compiled: Any) -> FunctionType:
    """Return the Python function of a dispatcher or a C callback."""
    function: FunctionType = getattr(compiled, "py_func", None) or compiled._pyfunc
    return function


def with_code(function: FunctionType, code: CodeType) -> FunctionType:
    """Return a function that has other code, but the same globals, defaults and captured values."""
    found = FunctionType(
        code, function.__globals__, function.__name__, function.__defaults__, function.__closure__
    )
    found.__module__, found.__qualname__ = function.__module__, function.__qualname__
    return found


def named_by(function: FunctionType) -> Iterator[Any]:
    """Yield the values that a function captures, and the global ones that it names."""
    for cell in function.__closure__ or ():
        yield cell.cell_contents
    for name in function.__code__.co_names:
        if name in function.__globals__:
            yield function.__globals__[name]


def concerned_by(mutant: Mutant) -> list[Any]:
    """Return the compiled functions that are changed, and those that call them, also indirectly.

    Functions that name a changed constant of a module contain its value.
    """
    names = names_bound(mutant.statement) if not mutant.outermost or mutant.of_default else ()

    def changed(function: FunctionType) -> bool:
        code = function.__code__
        if names:
            return not names.isdisjoint(code.co_names)
        top = code.co_qualname.partition(".<locals>")[0]
        return top == mutant.outermost and code.co_filename.endswith(f"/{mutant.module}")

    more = found = {id(each) for each in made if changed(python_function(each))}
    while more:
        more = {
            id(each)
            for each in made
            if id(each) not in found
            and any(id(value) in found for value in named_by(python_function(each)))
        }
        found = found | more
    return [each for each in made if id(each) in found]


def compile_again(compiled: list[Any]) -> None:
    """Forget the machine code of functions, and compile it for the same types of arguments.

    These are also the types for which the cache on disk contains a function.
    """
    from numba.core.caching import NullCache
    from numba.core.ccallback import CFunc

    callbacks = [each for each in compiled if isinstance(each, CFunc)]
    dispatchers = [each for each in compiled if not isinstance(each, CFunc)]
    signatures = [dict.fromkeys([*each.overloads, *_cached(each)]) for each in dispatchers]
    for each in compiled:
        each._cache = NullCache()
    for each in dispatchers:
        each._make_finalizer()()
        each._reset_overloads()
        each._can_compile = True  # also where numba was given its signature
    for each, known in zip(dispatchers, signatures, strict=True):
        for signature in known:
            each.compile(signature)
    for each in callbacks:
        each.compile()


def _cached(dispatcher: Any) -> Iterator[Any]:
    """Yield the types of arguments for which the cache on disk contains a function."""
    file = getattr(dispatcher._cache, "_cache_file", None)
    for signature, *_ in file._load_index() if file else ():
        yield signature


def compile_everything() -> None:
    """Compile all functions that are compiled so far, or were in earlier processes.

    Otherwise each child would compile what its tests use. Nothing is read from the cache, since
    code from there does not contain the functions that it calls separately: all of them would have
    to be compiled again for a change of one.
    """
    use_no_cache()
    compile_again(list(made))


def use_no_cache(*, reading: bool = False) -> None:
    """Write no compiled code to the disk in this process and, unless ``reading``, read none."""
    from numba.core import caching

    caching.Cache.save_overload = lambda *_: None  # type: ignore[method-assign]
    if not reading:
        caching.Cache.load_overload = lambda *_: None  # type: ignore[method-assign]
