"""The rules of ``theory.piecewise.sums.rules`` compiled by numba: the same functions, much faster.

Each function is compiled when it is first called, once for all processes. Since importing numba
takes half a second, the uncompiled functions are faster where only few values are needed.
"""

from __future__ import annotations

from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from types import FunctionType
from typing import Any

from theory.piecewise.sums import arithmetic, axis, blocks, corrected_axis, poles, rules, segments

_MODULES = (arithmetic, axis, poles, segments, corrected_axis, rules, blocks)
_WITHOUT_BRANCHES = {
    "quotient": "quotient_without_branches",
    "modulus": "modulus_without_branches",
    "square_root": "square_root_without_branches",
    "axis_means": "axis_means_of_one",
}
_WITHIN_LOOPS = (
    "quotient_without_branches", "modulus_without_branches", "square_root_without_branches",
    "sine_and_cosine_near", "integrand", "integrand_and_slopes", "_slopes_at", "step_to_root",
    "has_converged", "pair_of_the_parabola", "pole_correction", "clearance_of", "segment_unit",
    "segment_term", "segment_slopes", "segment_width", "size_of", "root_below_one",
    "segment_errors", "phase_rate", "_node", "side_of", "twice_arcsine",
)  # fmt: skip
"""Functions that are inlined, because a call would prevent a loop from being vectorised."""
_CALLED = (
    "block_values", "block_slopes", "plan_segments", "static_parts", "start_roots",
    "start_resonant_pairs", "converge", "exponents_on_segments", "exponents_on_axis",
    "exponentials", "clearances", "add_pole_corrections", "add_pole_correction_slopes",
    "add_all_nodes", "add_segment", "add_segment_slopes", "plan_axis",
)  # fmt: skip
"""Functions called from Python; the others are compiled into these, without an entry point."""


def _state_of_sources() -> str:
    """Return a digest of the modules and of this one, which contains the compiler options.

    numba's cache of a function is invalid only when the file of that function changes. As the
    digest is part of the function names, a change in the file of any function called counts too.
    """
    files = (__file__, *(module.__file__ or "" for module in _MODULES))
    sources = (Path(file).read_bytes() for file in files)
    return sha256(b"".join(sources)).hexdigest()[:12]


@lru_cache(maxsize=1)
def compiled_rules() -> dict[str, Any]:
    """Return the compiled rules that are called from Python, by name."""
    import numba

    njit: Any = numba.njit
    options: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}
    inner: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    state = _state_of_sources()
    namespace: dict[str, Any] = {}
    for module in _MODULES:
        namespace |= vars(module)
    for module in _MODULES:
        for name, plain in vars(module).items():
            if isinstance(plain, FunctionType) and plain.__module__ == module.__name__:
                copy = FunctionType(plain.__code__, namespace, name)
                copy.__module__, copy.__qualname__ = plain.__module__, f"{name}_{state}"
                options |= {"forceinline": name in _WITHIN_LOOPS}
                kind = {"cache": True} if name in _CALLED else inner
                namespace[name] = njit(**(options | kind))(copy)
    for plain_name, name in _WITHOUT_BRANCHES.items():
        namespace[plain_name] = namespace[name]
    return {name: namespace[name] for name in _CALLED}
