"""Loops over many values of Σ, compiled by numba.

What is compiled are the functions named in `CompiledRules`, and what they call. For this, all
functions of the modules below are copied into one namespace, so that a copy calls other copies,
with the versions of the operations that have no branches; a copy is compiled when it is first
called, once for all processes. The rules for a single value (``theory.piecewise.sums.rules``,
`segments.arch`, `corrected_axis.corrected_axis`, `axis.plain_points`) run in Python only: since
importing numba takes half a second, they are faster where only few values are needed.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from types import FunctionType
from typing import Any

from theory.arrays import FloatArray
from theory.compiled_code import kept_where_numba_would, remove_unused
from theory.interruption import compile_uninterrupted
from theory.piecewise.sums import arithmetic, axis, blocks, corrected_axis, poles, segments

_MODULES = (arithmetic, axis, poles, segments, corrected_axis, blocks)
"""The modules whose functions are compiled; a name has the same meaning in all of them."""
_OF_RULES = re.compile(r"_[0-9a-f]{12}-")
"""The digest of the sources, as it occurs in the name of a file with compiled rules."""
_WITHOUT_BRANCHES = {
    "quotient": "quotient_without_branches",
    "modulus": "modulus_without_branches",
    "square_root": "square_root_without_branches",
    "exponential": "exponential_without_branches",
    "logarithm": "logarithm_without_branches",
    "remainder": "remainder_without_branches",
}
_WITHIN_LOOPS = (
    "quotient_without_branches", "modulus_without_branches", "square_root_without_branches",
    "exponential_without_branches", "logarithm_without_branches", "remainder_without_branches",
    "segment_nodes", "_segment_size", "second_phase", "static_part",
    "sine_and_cosine_near", "integrand", "integrand_and_slopes", "step_to_root",
    "has_converged", "pair_of_the_parabola", "pole_correction", "clearance_of", "segment_unit",
    "segment_term", "segment_slopes", "segment_width", "size_of", "over_root",
    "segment_errors", "phase_rate", "_node", "side_of", "twice_arcsine",
)  # fmt: skip
"""Functions that are inlined, because a call would prevent a loop from being vectorised."""


@dataclass(frozen=True, kw_only=True)
class CompiledRules:
    """The compiled functions that are called from Python.

    They are described where they are defined: the first two, which return rows, in ``axis``; the
    others, which write rows into their last argument, in ``blocks``.
    """

    block_values: Callable[..., FloatArray]
    block_slopes: Callable[..., FloatArray]
    arches: Callable[..., None]
    corrections_on_axis: Callable[..., None]


def _state_of_sources() -> str:
    """Return a digest of the modules, of this one, which contains options, and of the compiler.

    numba's cache of a function is invalid only when the file of that function changes. As the
    digest is part of the function names, a change in the file of any function called counts too.
    """
    from theory import compiler

    files = [__file__, *(str(module.__file__) for module in (compiler, *_MODULES))]
    sources = (Path(file).read_bytes() for file in files)
    return sha256(b"".join(sources)).hexdigest()[:12]


@lru_cache(maxsize=1)
def compiled_rules() -> CompiledRules:
    """Return the compiled rules, cached in the folder that numba would choose by itself."""
    compile_uninterrupted()
    state = _state_of_sources()
    with kept_where_numba_would():
        rules = _compile(state)
    first: Any = rules.block_values
    _remove_older(Path(first.stats.cache_path), state)
    return rules


def _remove_older(folder: Path, state: str) -> None:
    """Remove rules of other sources from the folder when rules of these first come into it."""
    if not any(folder.glob(f"*_{state}-*")):
        remove_unused(path for path in folder.glob("*.nb[ci]") if _OF_RULES.search(path.name))


def _compile(state: str) -> CompiledRules:
    from theory.compiler import inner, outer

    options: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}
    called = [each.name for each in fields(CompiledRules)]
    namespace: dict[str, Any] = {}
    for module in _MODULES:
        namespace |= vars(module)
    for module in _MODULES:
        for name, plain in vars(module).items():
            if isinstance(plain, FunctionType) and plain.__module__ == module.__name__:
                copy = FunctionType(plain.__code__, namespace, name)
                copy.__module__, copy.__qualname__ = plain.__module__, f"{name}_{state}"
                if name in called:
                    namespace[name] = outer(**options, no_cfunc_wrapper=True, cache=True)(copy)
                else:
                    inline = name in _WITHIN_LOOPS
                    namespace[name] = inner(**options, forceinline=inline)(copy)
    for plain_name, name in _WITHOUT_BRANCHES.items():
        namespace[plain_name] = namespace[name]
    return CompiledRules(**{name: namespace[name] for name in called})
