"""The reasons why a compiled loop over steps returns."""

from __future__ import annotations

from enum import IntEnum
from typing import Self


class StopCode(IntEnum):
    """Why a call of a compiled loop returned; each member carries a sentence."""

    sentence: str

    def __new__(cls, code: int, sentence: str = "") -> Self:
        """Make a member from its code and its sentence."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.sentence = sentence
        return member

    REACHED = 0, "The requested time is reached."
    STEP_TOO_SHORT = (
        1,
        "The tolerance requires steps that are too short, or the time step vanished.",
    )
    NOT_FINITE = 2, "The state has left the range of double precision."
    BUDGET_SPENT = 3, "The number of steps allowed has been taken; the next call continues."
    CONDITION = 4, "The stop condition is met."
    WINDOW_MOVED = 5, "Other sites than before are to be stepped; the next call continues."
