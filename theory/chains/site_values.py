"""Values of the named parameters of a cell, one for all sites or one for each, and disorder."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.parameters import ParameterError, real_number

_LISTED = 100
"""Largest number of values that are listed in the parameters; longer arrays give a digest."""

_LARGEST_VALUE = 1e100


def pairs(quantity: str, given: Any) -> dict[str, Any]:
    """Return a mapping, given as such or as texts of the form ``a=4``."""
    if isinstance(given, Mapping):
        return {str(name): value for name, value in given.items()}
    if isinstance(given, str):
        given = [given]
    if not isinstance(given, Sequence) or not all(isinstance(each, str) for each in given):
        raise ParameterError(quantity, repr(given)[:60], "a mapping, or texts", "write them as a=4")
    found: dict[str, Any] = {}
    for each in given:
        name, sign, value = each.partition("=")
        if not (name.strip() and sign and value.strip()):
            raise ParameterError(quantity, repr(each), "a name and a number", "write them as a=4")
        if name.strip() in found:
            raise ParameterError(quantity, repr(each), "one value for each name", "give it once")
        found[name.strip()] = value.strip()
    return found


def checked_values(given: Any, names: Sequence[str], sites: int) -> dict[str, float | FloatArray]:
    """Return the value of each named parameter: one number, or one per site, shape (N,).

    Raises
    ------
    ParameterError
        If a value is neither, or not finite; if one is missing; or if a name is unknown.
    """
    values = pairs("values", given)
    for name in values:
        if name not in names:
            known = ", ".join(names) or "none"
            raise ParameterError(
                "named parameter", name, f"one that the cell has ({known})", "leave it out"
            )
    missing = [name for name in names if name not in values]
    if missing:
        raise ParameterError(
            "values", ", ".join(values) or "none", f"complete: {', '.join(missing)} missing",
            f"give one, as {missing[0]}=1",
        )  # fmt: skip
    return {name: _checked_value(name, values[name], sites) for name in names}


def _checked_value(name: str, given: Any, sites: int) -> float | FloatArray:
    if isinstance(given, str):
        try:
            given = float(given)
        except ValueError:
            raise ParameterError(name, repr(given), "a number", f"give one, as {name}=4") from None
    if np.ndim(given) == 0:
        remedy = "give a number in this range"
        return real_number(name, given, -_LARGEST_VALUE, _LARGEST_VALUE, remedy)
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError):
        array = np.full(1, np.nan)
    if array.shape != (sites,) or not np.all(np.isfinite(array)):
        raise ParameterError(
            name, f"an array of shape {array.shape}", f"finite, of shape ({sites},)",
            "give one number, or one for each site",
        )  # fmt: skip
    array.setflags(write=False)
    return array


def checked_disorder(given: Any, names: Sequence[str]) -> dict[str, float | str]:
    """Return relative spreads by name: 0.1 for normal, ``uniform:0.1`` for uniform disorder.

    Raises
    ------
    ParameterError
        If a spread is neither, or there is no parameter of this name.
    """
    found = {}
    for name, spread in pairs("disorder", given).items():
        if name not in names:
            none = "absent: no parameter has a name"
            known = f"that of one of {', '.join(names)}" if names else none
            raise ParameterError("disorder", name, known, "leave it out")
        found[name] = _checked_spread(name, spread)
    return found


def _checked_spread(name: str, given: Any) -> float | str:
    kind, _, size = str(given).rpartition(":")
    try:
        spread = float(size)
    except ValueError:
        spread = -1.0
    if kind not in ("", "normal", "uniform") or not 0.0 <= spread <= 1.0:
        raise ParameterError(
            f"disorder of {name}", given, "a number from 0 to 1, or uniform:0.1",
            "give a relative spread",
        )  # fmt: skip
    return f"uniform:{spread!r}" if kind == "uniform" else spread


def relative_spread(spread: float | str, sites: int, seed: Sequence[int]) -> FloatArray:
    """Return the relative deviations at the sites; those at the first sites do not depend on N."""
    random = np.random.default_rng(seed)
    if isinstance(spread, str):
        return float(spread.partition(":")[2]) * random.uniform(-1.0, 1.0, sites)
    return spread * random.standard_normal(sites)


def listed(value: float | FloatArray) -> Any:
    """Return a value in a form suitable for JSON; a long array is replaced by a digest."""
    if not isinstance(value, np.ndarray):
        return value
    if value.size <= _LISTED:
        return value.tolist()
    return f"{value.size} values {hashlib.sha256(value.tobytes()).hexdigest()[:16]}"
