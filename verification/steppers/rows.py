"""Rows of numbers in compiled loops."""

from __future__ import annotations

import math

from theory.arrays import FloatArray
from verification.execution.compiled import inner


@inner()
def put(source: FloatArray, target: FloatArray) -> None:
    """Copy a row into another one of equal length.

    ``target[:] = source`` would do the same, but takes numba seconds to compile, all of them for
    the error message about differing shapes.
    """
    for n in range(target.size):
        target[n] = source[n]


@inner(fastmath={"nnan", "nsz"})
def largest(row: FloatArray) -> float:
    """Return the largest modulus; it is meaningful only if all values are :func:`finite`."""
    found = 0.0
    for n in range(row.size):
        found = max(found, abs(row[n]))
    return found


@inner(fastmath={"reassoc"})
def finite(row: FloatArray) -> bool:
    """Return whether all values are finite and small enough for their sum to be finite."""
    total = 0.0
    for n in range(row.size):
        total += abs(row[n])
    return math.isfinite(total)
