"""The rules of ``theory.piecewise.sums.rules`` compiled by numba: the same functions, much faster.

Each is compiled when it is first called, once for all processes. Loading numba takes half a second,
so that whoever asks for few values is better served by the functions as they stand.
"""

from __future__ import annotations

from functools import lru_cache
from types import FunctionType
from typing import Any

from theory.piecewise.sums import rules

_WITHIN_LOOPS = ("quotient_without_branches", "integrand", "integrand_and_slopes", "_slopes_at")
"""Calls that would keep a loop from being vectorised."""


@lru_cache(maxsize=1)
def compiled_rules() -> dict[str, Any]:
    """Return the functions of ``rules`` by name, each one compiled and calling the others so."""
    from numba import njit

    options: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"contract"}}
    namespace = dict(vars(rules))
    for name, plain in vars(rules).items():
        if isinstance(plain, FunctionType) and plain.__module__ == rules.__name__:
            copy = FunctionType(plain.__code__, namespace, name)
            copy.__module__, copy.__qualname__ = plain.__module__, plain.__qualname__
            namespace[name] = njit(**options, forceinline=name in _WITHIN_LOOPS)(copy)
    namespace["axis_means"] = namespace["axis_means_of_one"]
    namespace["quotient"] = namespace["quotient_without_branches"]
    return namespace
