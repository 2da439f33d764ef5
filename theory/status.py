"""Statuses and choices: enums whose members carry the sentence that explains them."""

from __future__ import annotations

from enum import StrEnum
from typing import Self


class Status(StrEnum):
    """A word, and the sentence that says what it means and, where it helps, what to do.

    Examples
    --------
    >>> class Weather(Status):
    ...     DRY = "dry", "No rain is expected."
    >>> Weather.DRY.value, Weather.DRY.sentence, Weather("dry") is Weather.DRY
    ('dry', 'No rain is expected.', True)
    """

    sentence: str

    def __new__(cls, word: str, sentence: str = "") -> Self:
        """Make a member of its word and its sentence; a word alone looks the member up."""
        member = str.__new__(cls, word)
        member._value_ = word
        member.sentence = sentence
        return member
