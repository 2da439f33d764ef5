"""Rows of numbers in compiled loops."""

from __future__ import annotations

import math

from theory.arrays import FloatArray
from verification.execution.compiled import inner


@inner()
def put(source: FloatArray, target: FloatArray) -> None:
    """Copy a row into another of its length.

    ``target[:] = source`` does the same, but takes numba seconds to compile, all of it for the
    message that says that the shapes differ.
    """
    for n in range(target.size):
        target[n] = source[n]


@inner(fastmath={"nnan", "nsz"})
def largest(row: FloatArray) -> float:
    """Return the largest modulus; what it is worth if one is not finite, :func:`finite` says."""
    found = 0.0
    for n in range(row.size):
        found = max(found, abs(row[n]))
    return found


@inner(fastmath={"reassoc"})
def finite(row: FloatArray) -> bool:
    """Return whether all values are finite, and so small that their sum is."""
    total = 0.0
    for n in range(row.size):
        total += abs(row[n])
    return math.isfinite(total)
