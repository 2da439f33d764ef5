"""The active part of a chain, sites lo to hi, and the boundary conditions at its two ends.

Its state is one row (u, v) of length 2m, m = hi - lo: (y, ẏ) for (8), (Re φ, Im φ) for (43).
Compiled loops are fastest on a single contiguous row.
"""

from __future__ import annotations

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
