"""A check that a result on which a claim is based exists; otherwise the claim fails."""

from __future__ import annotations

from typing import TypeVar

Found = TypeVar("Found")


def required(value: Found | None, what: str) -> Found:
    """Return a result, which must exist.

    Raises
    ------
    ArithmeticError
        If it does not. No verdict may be based on a substitute.

    Examples
    --------
    >>> required(0.25, "velocity of the front")
    0.25
    """
    if value is None:
        raise ArithmeticError(f"there is no {what}")
    return value
