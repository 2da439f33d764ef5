"""Sites and shapes of lattices written as text."""

from __future__ import annotations

MAX_LISTED = 1_000_000
"""Largest number of sites that a text may denote."""


def read_sites(text: str) -> list[int]:
    """Return the sites denoted by numbers and ranges, both ends included, in the order given.

    Raises
    ------
    ValueError
        If the text is not of this form, or denotes more than `MAX_LISTED` sites.

    Examples
    --------
    >>> read_sites("1,4:6")
    [1, 4, 5, 6]
    """
    found: list[int] = []
    for part in text.split(","):
        first, colon, last = part.partition(":")
        low, high = _whole(first), _whole(last if colon else first)
        if not 0 <= high - low < MAX_LISTED - len(found):
            raise ValueError(text)
        found += range(low, high + 1)
    return found


def read_shape(text: str) -> tuple[int, int]:
    """Return the rows and columns of a lattice.

    Raises
    ------
    ValueError
        If the text is not of this form.

    Examples
    --------
    >>> read_shape("60x40")
    (60, 40)
    """
    rows, columns = text.split("x")
    return _whole(rows), _whole(columns)


def _whole(text: str) -> int:
    if "_" in text or not text.isascii():  # Python reads separators, and digits of any script
        raise ValueError(text)
    return int(text)
