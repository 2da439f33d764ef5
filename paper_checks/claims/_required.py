"""A number that a claim rests on is there, or the claim says that it could not be computed."""

from __future__ import annotations


def required(value: float | None, what: str) -> float:
    """Return a number that was found.

    Raises
    ------
    ArithmeticError
        If there is none. No verdict may rest on a stand-in.

    Examples
    --------
    >>> required(0.25, "velocity of the front")
    0.25
    """
    if value is None:
        raise ArithmeticError(f"there is no {what}")
    return value
