"""The right-hand side of a whole chain, compiled from that of a single site.

The state is a row (y, w) of length 2m (``active``). This module contains the loop over sites; a
chain provides the equation of a site (``theory.chains.chain.SmoothChain.kernel``).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from theory.arrays import FloatArray
from theory.cells.function_content import independent_copy
from theory.chains.chain import Kernel, SmoothChain
from verification.execution.compiled import UNCOUNTED, inner
from verification.execution.imports import is_ours
from verification.steppers.active import FOLLOWING, FREE, RING
from verification.steppers.specialise import source_mark

Slope = Callable[[FloatArray, FloatArray, int, int, FloatArray], None]
"""Function of a state, parameters and the codes of both ends; puts the derivative into the last
argument."""

fast = inner(error_model="numpy", fastmath={"contract"}, **UNCOUNTED)
"""Compile arithmetic without division errors, with fused products and sums, and without new
arrays."""


def slope_of(chain: SmoothChain) -> Slope:
    """Return the compiled right-hand side of a chain, callable from compiled functions.

    Examples
    --------
    >>> from numba import njit
    >>> from theory.chains.vdp import VdpChain
    >>> chain, out = VdpChain(a=4, b=0.5, c=0.6, sites=2), np.zeros(4)
    >>> p, slope = np.array(chain.kernel_parameters()), slope_of(chain)
    >>> called = njit(lambda *given: slope(*given))
    >>> called(np.array([1.0, 1.0, 0.0, 0.0]), p, FREE, FREE, out)
    >>> out.tolist()
    [0.0, 0.0, -1.0, -1.0]
    """
    kernel = chain.kernel()
    mark = source_mark(kernel)
    if chain.network is not None:
        return network_slope(kernel, mark, *chain.kernel_layout)
    return compiled_slope(kernel, mark, *chain.kernel_layout, -chain.front_phase_step % 4)


def slope_mark(chain: SmoothChain) -> str:
    """Return a name for the right-hand side of a chain that changes with its source."""
    layout = "-".join(map(str, chain.kernel_layout))
    return f"{source_mark(chain.kernel())}-{layout}-{chain.front_phase_step}"


def own_slope_mark(chain: SmoothChain) -> str | None:
    """Return `slope_mark`; None for a right-hand side that stands in a module of this project.

    The digest of the code on which a run depends covers the latter. Its mark would change with the
    bytecode too, hence with the version of Python.
    """
    kernel: Any = chain.kernel()
    plain: Any = getattr(kernel, "py_func", kernel)
    stands = getattr(sys.modules.get(plain.__module__), plain.__qualname__, None)
    shipped = is_ours(plain.__module__) and getattr(stands, "py_func", stands) is plain
    return None if shipped else slope_mark(chain)


@lru_cache(maxsize=64)
def compiled_slope(kernel: Kernel, mark: str, count: int, ahead: int) -> Slope:
    """Return the right-hand side of a chain whose kernel takes ``count`` parameters.

    Parameters
    ----------
    kernel : callable
        Right-hand side of one site.
    mark : str
        Its mark, since what it captures may change.
    count : int
        Number of its parameters.
    ahead : int
        Number of quarter turns by which a wave beyond the left end is ahead of its neighbour.
    """
    plain: Any = independent_copy(getattr(kernel, "py_func", kernel))
    site: Any = inner(forceinline=True, error_model="numpy", fastmath={"contract"})(plain)
    tuple_of: Any = to_fixed_tuple

    @inner(forceinline=True)
    def beyond(code: int, end: Any, far: Any) -> Any:
        if code == FREE:
            return end
        if code == RING:
            return far
        if code == FOLLOWING:
            if ahead == 1:
                return end[1], -end[0]
            if ahead == 2:
                return -end[0], -end[1]
            if ahead == 3:
                return -end[1], end[0]
            return end
        return 0.0, 0.0

    # A single exit: with several, numba counts references to the four views at each call.
    @fast
    def slope(
        x: FloatArray, parameters: FloatArray, left: int, right: int, out: FloatArray
    ) -> None:
        p = tuple_of(parameters, count)
        m = x.size // 2
        end = m - 1
        y, w, next_y, next_w = x[:m], x[m:], out[:m], out[m:]
        first, last = (y[0], w[0]), (y[end], w[end])
        for n in (0, end):
            before = beyond(left, first, last) if n == 0 else (y[n - 1], w[n - 1])
            after = beyond(right, last, first) if n == end else (y[n + 1], w[n + 1])
            next_y[n], next_w[n] = site((y[n], w[n]), before, after, p)
        for n in range(1, end):
            next_y[n], next_w[n] = site((y[n], w[n]), (y[n - 1], w[n - 1]), (y[n + 1], w[n + 1]), p)

    return slope


@lru_cache(maxsize=64)
def network_slope(kernel: Kernel, mark: str, header: int, arrays: int, on_velocities: int) -> Slope:
    """Return the right-hand side of a chain whose coupling is given by compressed rows.

    Its argument ``left`` is the first active site, ``right`` the number of all sites (``active``).

    Parameters
    ----------
    kernel : callable
        Right-hand side of one site: (site, pull, p, n, N).
    mark : str
        Its mark, since what it captures may change.
    header : int
        Number of scalars at the beginning of the parameters; the fourth is the number of weights.
    arrays : int
        Number of parameters with N values each that follow them.
    on_velocities : int
        Whether the kernel uses the pull on velocities: 1, or 0 to pass zero instead.
    """
    plain: Any = independent_copy(getattr(kernel, "py_func", kernel))
    site: Any = inner(forceinline=True, error_model="numpy", fastmath={"contract"})(plain)

    # Sums first, then sites: the processor handles several sites of the second loop at once.
    # Unsigned indices are never counted from the end, which saves a comparison for each.
    @fast
    def slope(x: FloatArray, p: FloatArray, lo: int, sites: int, out: FloatArray) -> None:
        m = x.size // 2
        y, w, next_y, next_w = x[:m], x[m:], out[:m], out[m:]
        count = int(p[3])
        first = header + arrays * sites
        total, weights = p[first : first + sites], p[first + sites : first + sites + count]
        at = first + sites + count
        rows = (sites + 2) // 2
        starts = p[at : at + rows].view(np.uint32)
        others = p[at + rows : at + rows + (count + 1) // 2].view(np.uint32)
        complete = m == sites
        for i in range(m):
            n = np.uint64(lo + i)
            near_y = near_w = 0.0
            for k in range(np.uint64(starts[n]), np.uint64(starts[n + np.uint64(1)])):
                j = np.uint64(others[k])
                if not complete:
                    if j < np.uint64(lo) or j >= np.uint64(lo + m):
                        continue
                    j -= np.uint64(lo)
                near_y += weights[k] * y[j]
                if on_velocities:
                    near_w += weights[k] * w[j]
            next_y[i] = total[n] * y[i] - near_y
            if on_velocities:
                next_w[i] = total[n] * w[i] - near_w
        for i in range(m):
            pull = (next_y[i], next_w[i] if on_velocities else 0.0)
            next_y[i], next_w[i] = site((y[i], w[i]), pull, p, lo + i, sites)

    return slope
