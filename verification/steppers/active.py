"""The active part of a chain, sites lo to hi, and the boundary conditions at its two ends.

Its state is one row (u, v) of length 2m, m = hi - lo: (y, ẏ) for (8), (Re φ, Im φ) for (43).
Compiled loops are fastest on a single contiguous row.
"""

from __future__ import annotations

from theory.arrays import FloatArray
from verification.execution.compiled import inner

REST, FREE, RING, FOLLOWING, NETWORK = 0, 1, 2, 3, 4
"""What lies beyond an end: rest; nothing; the other end; or, on the left, an unending wave whose φ
is i times that of its right neighbour. A network has no ends; the two numbers that replace them are
the first active site and the number of all sites."""


@inner()
def end_codes(lo: int, hi: int, sites: int, first: int, following: bool) -> tuple[int, int]:
    """Return the codes of what lies beyond the left and the right end.

    Parameters
    ----------
    lo, hi, sites : int
        First active site, last one plus one, total number.
    first : int
        What lies beyond the first site of the chain: FREE, FOLLOWING, NETWORK or, if all sites are
        active, RING.
    following : bool
        Whether the wave continues to the left of lo > 0.
    """
    if first == RING:
        return RING, RING
    if first == NETWORK:
        return lo, sites
    left = first if lo == 0 else FOLLOWING if following else REST
    return left, FREE if hi == sites else REST


@inner(error_model="numpy")
def value_beyond(code: int, end: float, far: float, followed: float) -> float:
    """Return the value beyond an end; at a free end its own value, without coupling."""
    if code == FREE:
        return end
    if code == RING:
        return far
    if code == FOLLOWING:
        return followed
    return 0.0


@inner(error_model="numpy")
def neighbours_of_ends(
    u: FloatArray, left: int, right: int, followed: float
) -> tuple[float, float]:
    """Return the sums of both neighbours of the first and of the last site (possibly the same)."""
    last = u.size - 1
    before = value_beyond(left, u[0], u[last], followed)
    beyond = value_beyond(right, u[last], u[0], followed)
    if last == 0:
        return before + beyond, before + beyond
    return before + u[1], u[last - 1] + beyond


@inner(error_model="numpy", fastmath={"contract"})
def add_coupling(
    out: FloatArray, u: FloatArray, factor: float, left: int, right: int, followed: float
) -> None:
    """Add factor (2u_n - u_{n-1} - u_{n+1}) to out, both of shape (m,).

    The neighbours are added first, so that a mirror-symmetric state stays symmetric to the last
    bit.
    """
    last = u.size - 1
    near_first, near_last = neighbours_of_ends(u, left, right, followed)
    out[0] += factor * (2.0 * u[0] - near_first)
    if last > 0:
        out[last] += factor * (2.0 * u[last] - near_last)
    for n in range(1, last):
        out[n] += factor * (2.0 * u[n] - (u[n - 1] + u[n + 1]))
