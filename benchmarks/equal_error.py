"""Ratios of run time at equal error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from benchmarks.record import WorkPoint


def least_factor(
    ours: Sequence[WorkPoint], peers: Sequence[WorkPoint], low: float, high: float
) -> tuple[float, WorkPoint] | None:
    """Return the least factor by which ours beat the peers at equal error, and where.

    Each peer with an error from ``low`` to ``high`` is compared with the fastest of ours that is
    at least as exact; None if no pair can be compared.
    """
    factors = []
    for peer in peers:
        if low <= peer.error <= high:
            equal = [point.seconds for point in ours if point.error <= peer.error]
            if equal:
                factors.append((peer.seconds / min(equal), peer))
    return min(factors, default=None, key=lambda row: row[0])
