"""What may become of a chain of either model; the rules stand where a model is labelled."""

from __future__ import annotations

from enum import StrEnum


class Label(StrEnum):
    """What became of a chain."""

    FRONT = "front"
    BREATHER = "breather"
    FIXED_POINT = "fixed point"
    UNDECIDED = "undecided"
