"""Folds for tests in which only some of their entries matter."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from verification.continuation.branch import Fold

UNUSED = {"offset": np.empty(0), "transverse_error": math.inf, "tangent": np.zeros(1)}


def fold_of(parameter: float, error: float, u: FloatArray, **given: Any) -> Fold:
    """Return a fold whose other entries are those given, or of no use."""
    return Fold(parameter, error, u, **{**UNUSED, **given})
