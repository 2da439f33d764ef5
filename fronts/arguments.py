"""Readers of option values shared by several subcommands: numbers, ranges, files."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from fronts.answer import UsageError
from theory.chains.site_text import MAX_LISTED, read_shape, read_sites
from verification.execution import files

Number = TypeVar("Number", int, float)

MAX_POINTS = 100_000


class BadText(argparse.ArgumentTypeError):
    """Raised for text that cannot be the value of an option; ``fronts.cli`` adds the option's name.

    Parameters
    ----------
    value : object
        The text.
    allowed : str
        The allowed values, in words.
    remedy : str
        Advice on what to do instead.
    """

    def __init__(self, value: object, allowed: str, remedy: str) -> None:
        self.value, self.allowed, self.remedy = value, allowed, remedy


def with_values_joined(words: Sequence[str]) -> list[str]:
    """Join an option with a value that begins with a minus sign.

    Otherwise ``argparse`` would take the value for an option. The only options with a single minus
    sign are ``-h`` and ``-o``.

    Examples
    --------
    >>> with_values_joined(["--c", "-1e-3", "--v-d", "-1:1:5", "--json", "-h"])
    ['--c=-1e-3', '--v-d=-1:1:5', '--json', '-h']
    """
    joined: list[str] = []
    for word in words:
        before = joined[-1] if joined else ""
        value = word[:1] == "-" and word[:2] not in ("-", "--", "-h", "-o")
        if value and before.startswith("--") and before != "--" and "=" not in before:
            joined[-1] = f"{before}={word}"
        else:
            joined.append(word)
    return joined


def _read(kind: Callable[[str], Number], text: str) -> Number:
    """Read a number; raise ValueError for other text, and for 0_5, which Python would read as 5."""
    if "_" in text:
        raise ValueError(text)
    return kind(text)


def real(text: str) -> float:
    """Read one number; its range, and NaN, are checked by the function that receives it."""
    try:
        return _read(float, text)
    except ValueError:
        raise BadText(text, "a number", "write it as in 0.5 or 1e-3") from None


def whole(text: str) -> int:
    """Read one whole number; its range is checked by the command.

    Examples
    --------
    >>> whole("12")
    12
    """
    try:
        return _read(int, text)
    except ValueError:
        raise BadText(text, "a whole number", "write it in digits, as in 12") from None


def real_or_range(text: str) -> float | tuple[float, float, int]:
    """Read a number, or an ascending range ``low:high:count``.

    Examples
    --------
    >>> real_or_range("0.5"), real_or_range("0.3:3:200")
    (0.5, (0.3, 3.0, 200))
    """
    if ":" not in text:
        return real(text)
    parts = text.split(":")
    if len(parts) != 3:
        raise BadText(text, "one number or low:high:count", "write it as in 0.3:3:200")
    low, high, count = real(parts[0]), real(parts[1]), whole(parts[2])
    if not -math.inf < low < high < math.inf:
        raise BadText(
            text, "low:high:count with low below high", "begin with the smaller, or give one"
            " number"
        )  # fmt: skip
    if not 2 <= count <= MAX_POINTS:
        raise BadText(
            text, f"low:high:count with a count from 2 to {MAX_POINTS}", "give such a count"
        )
    return low, high, count


def is_range(value: Any) -> bool:
    """Return whether an option was given as ``low:high:count``.

    Examples
    --------
    >>> is_range((0.0, 1.0, 5)), is_range((14, 15, 16)), is_range(0.5)
    (True, False, False)
    """
    return isinstance(value, tuple) and len(value) == 3 and isinstance(value[0], float)


def values_of(given: tuple[float, float, int]) -> list[float]:
    """Return the values of a range, rounded to 15 digits so that they print as decimals.

    Examples
    --------
    >>> values_of((0.01, 0.14, 14))[2]
    0.03
    """
    import numpy as np

    return [float(f"{value:.15g}") for value in np.linspace(*given)]


def size_or_shape(text: str) -> int | tuple[int, int]:
    """Read a number of sites, or rows and columns.

    Examples
    --------
    >>> size_or_shape("31"), size_or_shape("60x40")
    (31, (60, 40))
    """
    if "x" not in text:
        return whole(text)
    try:
        return read_shape(text)
    except ValueError:
        raise BadText(text, "a whole number or rows x columns", "write it as in 60x40") from None


def site_list(text: str) -> tuple[int, ...]:
    """Read ``15``, ``14,15,16`` or ``14:16`` (both ends included), or a list of these.

    Examples
    --------
    >>> site_list("15"), site_list("14:16"), site_list("3,5")
    ((15,), (14, 15, 16), (3, 5))
    """
    try:
        return tuple(read_sites(text))
    except ValueError:
        allowed = f"a list of at most {MAX_LISTED} sites"
        raise BadText(text, allowed, "write it as in 15 or 14,15,16 or 14:16") from None


def folder(text: str) -> Path:
    """Read the name of a folder.

    Examples
    --------
    >>> folder("report").name
    'report'
    """
    if not text.strip():
        remedy = "an empty name is no folder: name one, or . for this one"
        raise BadText(repr(text), "a name", remedy)
    return Path(text)


def decimal(text: str) -> str:
    """Check that the text is a number, and return it as text so that no digit is lost."""
    real(text)
    return text


def check_writable(path: Path, suffixes: tuple[str, ...] = (), option: str = "--out") -> Path:
    """Refuse a path that cannot be written, before any work is done.

    Raises
    ------
    UsageError
        If `verification.execution.files.check_writable` refuses it, or its suffix is not one of
        ``suffixes`` (if any are named).
    """
    if suffixes and path.suffix.lower() not in suffixes:
        _unusable(option, path, f"must end in {' or '.join(suffixes)}", "give it such an ending")
    try:
        files.check_writable(path)
    except files.FileError as error:
        _unusable(option, path, str(error.strerror), error.remedy)
    return path


def _unusable(option: str, path: Path, why: str, remedy: str) -> NoReturn:
    raise UsageError(
        f"{option} {path} {why}: {remedy}.",
        quantity=option,
        value=path,
        allowed="a file that can be written",
        remedy=remedy,
    ) from None


def same_file(one: Path, other: Path) -> bool:
    """Return whether two names denote the same file, which need not exist.

    Examples
    --------
    >>> same_file(Path("run.npz"), Path("./run.npz"))
    True
    """
    return one.resolve() == other.resolve()
