"""numba's compiler without what the functions of this project do not need, which is faster.

Functions called only by compiled code are optimised and translated only as part of their callers.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from llvmlite import binding
from numba import njit, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, Flags

_SKIPPED = {
    "with_lifting",
    "inline_closure_likes",
    "make_function_op_code_to_jit_function",
    "inline_inlinables",
    "find_literally",
    "literal_unroll",
    "LiteralPropagation",
    "nopython_rewrites",  # looking for sums of whole arrays takes 3.6 % of the time
}

UNCOUNTED: dict[str, Any] = {"_nrt": False}
"""Options of functions that create no arrays: references to their arguments are not counted.

numba counts by atomic instructions at every slice and every call; for short arrays, this takes more
than half of the time. Functions called from them create no arrays either, unless ``COUNTED``."""
COUNTED: dict[str, Any] = {"_nrt": True}

Function = TypeVar("Function", bound=Callable[..., Any])


class _PartOfItsCallers(JITCodeLibrary):
    """Code that becomes machine code only as part of its callers.

    numba optimises and translates each function by itself, and again within each function that
    calls it, at every level; for functions that Python cannot call, only the latter is of use.
    """

    def finalize(self) -> None:
        for library in dict.fromkeys(self._linking_libraries):
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0, as numba does for a function that Python cannot call."""
        return 0

    @property
    def codegen(self) -> Any:
        """Return the place where numba puts the Python objects that machine code uses."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing; a function that uses such objects fails with "missing Environment"."""


class _Rolled(JITCodeLibrary):
    """Code whose loops and equal adjacent operations are vectorised; loops are not unrolled."""

    def _optimize_final_module(self) -> None:
        codegen: Any = self._codegen
        if not hasattr(codegen, "_pass_builder"):  # as in numba before 0.62
            inherited: Any = super()._optimize_final_module
            inherited()
            return
        module = self._final_module
        passes, builder = codegen._module_pass_manager(loop_vectorize=False, opt=0, cost="cheap")
        passes.run(module, builder)
        choice = binding.create_pipeline_tuning_options(speed_level=3)
        choice.loop_vectorization, choice.loop_unrolling = True, False
        choice.slp_vectorization = True
        builder = binding.create_pass_builder(codegen._tm, choice)
        builder.getModulePassManager().run(module, builder)


class _Flags(Flags):
    """Compilation options; numba uses them as dictionary keys in about 50 000 look-ups."""

    def __hash__(self) -> int:
        return hash(frozenset(self._values))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Flags) and bool(self._values == other._values)


class _ShortCompiler(Compiler):
    """numba's compiler without the passes for features that functions here do not use."""

    def __init__(  # noqa: PLR0917  (as numba's)
        self, typing: Any, target: Any, library: Any, args: Any, returned: Any, flags: Any, own: Any
    ) -> None:
        start: Any = super().__init__
        known: Any = _Flags
        start(typing, target, library, args, returned, known(flags), own)

    def define_pipelines(self) -> list[Any]:
        """Return numba's passes except those for closures, ``with``, literals and whole arrays."""
        inherited: Any = super().define_pipelines
        pipelines: list[Any] = inherited()
        for each in pipelines:
            each.passes = [step for step in each.passes if step[0].name() not in _SKIPPED]
            each.finalize()
        return pipelines


class OuterCompiler(_ShortCompiler):
    """The same, without garbage collection, which takes a tenth of the time and finds little."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function and everything it calls that is not yet compiled."""
        searching = gc.isenabled()
        gc.disable()
        try:
            compiled: Any = super().compile_extra
            with _operations_resolved_once():
                return compiled(func)
        finally:
            if searching:
                gc.enable()


class _RolledCompiler(OuterCompiler):
    """The same, without unrolled loops."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        rolled: Any = _Rolled
        own = rolled(target.codegen(), "outer")
        own.enable_object_caching()
        super().__init__(typing, target, own, *rest)


@contextmanager
def _operations_resolved_once() -> Iterator[None]:
    """Let numba determine the result of an operation only once for given operand types.

    It tries dozens of candidates for each sum, product or index of an array, at every occurrence,
    in every pass of type inference and again when it generates code; for the friction stepper this
    took a fifth of the time.
    """
    kind: Any = types.Function
    resolve, known = kind.get_call_type, {}

    def resolved(function: Any, context: Any, given: Any, named: Any) -> Any:
        if named:
            return resolve(function, context, given, named)
        place = (function, tuple(given))
        if place not in known:
            known[place] = resolve(function, context, given, named)
        return known[place]

    kind.get_call_type = resolved
    try:
        yield
    finally:
        kind.get_call_type = resolve


class _InnerCompiler(_ShortCompiler):
    """The same, without machine code."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        part: Any = _PartOfItsCallers
        super().__init__(typing, target, part(target.codegen(), "inner"), *rest)


def outer(*, unrolled: bool = True, **options: Any) -> Callable[[Function], Function]:
    """Compile a function that is also called from Python.

    Loops over the few coefficients of a series are better not unrolled: if there are many of them,
    this saves a tenth of the compile time, and unrolled loops are no faster.
    """
    return _compiled(OuterCompiler if unrolled else _RolledCompiler, options)


def inner(**options: Any) -> Callable[[Function], Function]:
    """Compile a function called by compiled code only; it is stored as part of its callers."""
    return _compiled(
        _InnerCompiler, {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, **options}
    )


def _compiled(compiler: type[Compiler], options: dict[str, Any]) -> Callable[[Function], Function]:
    compiled: Callable[[Function], Function] = njit(**options, pipeline_class=compiler)
    return compiled
