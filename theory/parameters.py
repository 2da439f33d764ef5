"""Checks of parameters, and the errors that describe what is wrong.

Each check returns the value, or raises a `ParameterError` if it is not what the description says.
"""

from __future__ import annotations

import math
import numbers
import sys
from collections.abc import Callable, Collection, Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsFloat, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LATEST = 1e9
"""Largest end time of a simulation."""


_Documented = TypeVar("_Documented", bound=Callable[..., Any])

_MAX_SHOWN = 500
"""Largest number of characters of a value that are shown in a message."""


class Range(NamedTuple):
    """The range that is allowed for a quantity, including both ends.

    Its text appears in help and in refusals, so that they cannot differ from the check.

    Examples
    --------
    >>> print(Range(1e-9, 10.0), Range(1e-12, 1e-4), Range(1, 1_000_000), sep="; ")
    from 1e-9 to 10; from 1e-12 to 1e-4; from 1 to 1000000
    """

    low: float
    high: float

    def __str__(self) -> str:
        return f"from {as_text(self.low)} to {as_text(self.high)}"


def as_text(value: float) -> str:
    """Return a number as it is written in help and in refusals.

    Examples
    --------
    >>> [as_text(each) for each in (1e9, 1e-4, 0.01, -1000.0, 2000)]
    ['1e9', '1e-4', '0.01', '-1000', '2000']
    """
    if isinstance(value, int):
        return str(value)
    text = f"{value:.5e}" if 0.0 < abs(value) < 1e-3 else f"{value:g}"
    mantissa, _, exponent = text.partition("e")
    return f"{float(mantissa):g}e{int(exponent)}" if exponent else text


def with_ranges(**ranges: Range | float) -> Callable[[_Documented], _Documented]:
    """Replace names in braces in the docstring of a function or class by ranges or numbers.

    The docstring, and the help of the command line with it, thus states what is checked.

    Examples
    --------
    >>> end_time.__doc__.splitlines()[0]
    'Return the end time of a simulation after checking that it is positive and at most 1e9.'
    """

    def replace(documented: _Documented) -> _Documented:
        text = documented.__doc__ or ""  # there is none under python -OO
        for name, value in ranges.items():
            shown = str(value) if isinstance(value, Range) else as_text(value)
            text = text.replace(f"{{{name}}}", shown)
        documented.__doc__ = text
        return documented

    return replace


class ParameterError(ValueError):
    """A quantity outside the range where the theory is defined.

    The message is one sentence: quantity, value, allowed range, remedy.

    Parameters
    ----------
    quantity : str
        Name of the quantity, with its symbol.
    value : object
        The value that was given.
    allowed : str
        The allowed range, in words.
    remedy : str
        Advice on what to do instead.
    """

    def __init__(self, quantity: str, value: object, allowed: str, remedy: str) -> None:
        self.quantity = quantity
        self.value = value
        self.allowed = allowed
        self.remedy = remedy
        shown = _in_one_line(str(value), _MAX_SHOWN)
        super().__init__(f"{quantity} = {shown} is not allowed: it must be {allowed}; {remedy}.")


class RunError(ArithmeticError):
    """A computation that cannot be continued; one sentence says where, and what to change."""


class MissingPackageError(ImportError):
    """A package that is not installed; the message is one sentence that names the extra.

    Parameters
    ----------
    package : str
        Name of the package.
    extra : str
        Extra of this distribution that installs it.
    purpose : str
        What the package is needed for.

    Examples
    --------
    >>> print(MissingPackageError("python-flint", "certify", "a certified root"))
    a certified root needs python-flint, which is not installed: 'pip install \
excitation-fronts[certify]' installs it.
    """

    def __init__(self, package: str, extra: str, purpose: str) -> None:
        self.package, self.extra, self.purpose = package, extra, purpose
        super().__init__(
            f"{purpose} needs {package}, which is not installed: "
            f"'pip install excitation-fronts[{extra}]' installs it.",
            name=package,
        )


def number(
    quantity: str, value: object, allowed: str = "a number", remedy: str = "give a number"
) -> float:
    """Return a value as a float if it is a single number; NaN and infinities are accepted.

    Raises
    ------
    ParameterError
        If it is an array of several numbers, a complex number, a truth value, text that is not a
        number, or anything else.

    Examples
    --------
    >>> from fractions import Fraction
    >>> number("coupling c", Fraction(1, 4)), number("coupling c", "0.25")
    (0.25, 0.25)
    """
    try:
        if not _is_truth(value):
            return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        pass
    raise ParameterError(quantity, value, allowed, remedy)


def real_array(quantity: str, values: object) -> NDArray[np.float64]:
    """Return one or several real numbers as an array of the same shape.

    Raises
    ------
    ParameterError
        If the values are text, truth values, dates or complex numbers, or if some are masked.

    Examples
    --------
    >>> real_array("coupling c", [1, 0.5])
    array([1. , 0.5])
    """
    import numpy as np

    ma = sys.modules.get("numpy.ma")  # if it is not loaded, there are no masked arrays
    try:
        given = np.asarray(values)
        absent = given.dtype.kind == "O" and any(each is None for each in given.ravel())
        if given.dtype.kind in "iufO" and not absent and not (ma and ma.is_masked(values)):
            return given.astype(float)
    except (TypeError, ValueError, OverflowError):
        pass
    raise ParameterError(quantity, values, "a number or numbers, none masked", "give those")


def decimal(quantity: str, value: object) -> float | str:
    """Return a decimal as it was written, digit for digit, or a number as a float.

    Examples
    --------
    >>> decimal("coupling c", "0.10"), decimal("coupling c", 1)
    ('0.10', 1.0)
    """
    found = number(quantity, value)
    return value if isinstance(value, str) else found


def positive(
    quantity: str, value: SupportsFloat | str, remedy: str = "give a positive number"
) -> float:
    """Return ``value`` as a float if it is finite and positive.

    Examples
    --------
    >>> positive("coupling c", 0.5)
    0.5
    >>> positive("coupling c", -1)
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: coupling c = -1 is not allowed: it must be finite and \
positive; give a positive number.
    """
    return _checked(quantity, value, "finite and positive", remedy, lambda x: x > 0)


def ascending(quantity: str, values: object) -> list[float]:
    """Return positive numbers in ascending order, at least one.

    Examples
    --------
    >>> ascending("coupling c", (0.3, 0.1))
    [0.1, 0.3]
    >>> ascending("coupling c", [])
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: coupling c = [] is not allowed: it must be a sequence of \
positive numbers; give at least one, as [0.1, 0.2].
    """
    one = isinstance(values, str) or getattr(values, "ndim", 1) == 0  # numpy scalars have no length
    if one or not isinstance(values, Iterable) or not (given := list(values)):
        allowed = "a sequence of positive numbers"
        raise ParameterError(quantity, values, allowed, "give at least one, as [0.1, 0.2]")
    return sorted(positive(quantity, each) for each in given)


def within(
    quantity: str,
    value: SupportsFloat | str,
    low: float,
    high: float,
    remedy: str | None = None,
) -> float:
    """Return ``value`` as a float if ``low <= value <= high``."""
    if isinstance(value, float) and low <= value <= high:  # the check below is costly
        return float(value)
    return _checked(
        quantity,
        value,
        str(Range(low, high)),
        remedy or "give a value in this range",
        lambda x: low <= x <= high,
    )


def at_least(quantity: str, value: SupportsFloat | str, low: float, remedy: str) -> float:
    """Return ``value`` as a float if it is finite and not below ``low``."""
    if isinstance(value, float) and low <= value < math.inf:  # the check below is costly
        return float(value)
    allowed = f"finite and at least {as_text(low)}"
    return _checked(quantity, value, allowed, remedy, lambda x: x >= low)


def refuse_unread(
    given: Mapping[str, object], defaults: Mapping[str, object], read: Collection[str], where: str
) -> None:
    """Refuse options that have no effect, unless they are at their defaults.

    Parameters
    ----------
    given, defaults : mapping
        Values of the options, and their defaults, by name.
    read : collection of str
        Names of the options that have an effect.
    where : str
        The case in question, such as "for the model vdp".

    Examples
    --------
    >>> refuse_unread({"seed": 0, "tests": 3}, {"seed": 0, "tests": 12}, (), "with an orbit")
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: tests = 3 is not allowed: it must be absent with an orbit; \
leave it out: nothing depends on it.
    """
    for name, value in given.items():
        if name in read:
            continue
        default = defaults[name]
        plain = isinstance(value, (int, float, str))
        if value is not default and not (plain and value == default):
            remedy = "leave it out: nothing depends on it"
            raise ParameterError(name, value, f"absent {where}", remedy)


def count_within(
    quantity: str, value: object, low: float, high: float, remedy: str | None = None
) -> int:
    """Return ``value`` as an int if it is a whole number with ``low <= value <= high``.

    Examples
    --------
    >>> count_within("number of sites n", 31.0, 2, 100)
    31
    """
    return int(
        _checked(
            quantity,
            value,
            f"a whole number {Range(low, high)}",
            remedy or "give a whole number in this range",
            lambda x: low <= x <= high and x == int(x),
        )
    )


def real_number(quantity: str, value: object, low: float, high: float, remedy: str) -> float:
    """Return a parameter as a float if it is a real number with ``low <= value <= high``.

    Only numbers are accepted, including those of numpy; text, truth values and arrays are refused.

    Examples
    --------
    >>> real_number("coupling c", 1, 0.0, 1e6, "give a coupling")
    1.0
    >>> real_number("coupling c", "0.3", 0.0, 1e6, "give a coupling")
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: coupling c = '0.3' is not allowed: it must be a number from \
0 to 1e6; give a coupling.
    """
    allowed = f"a number {Range(low, high)}"
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise ParameterError(quantity, _shown(value), allowed, remedy)
    return _checked(quantity, value, allowed, remedy, lambda x: low <= x <= high)


def random_seed(value: object) -> int:
    """Return the seed of a random number generator as an int: a whole number below 2³².

    Examples
    --------
    >>> random_seed(7.0)
    7
    """
    return count_within("seed", value, 0, 2**32 - 1)


def truth(quantity: str, value: object) -> bool:
    """Return a flag as a bool if it is true or false; numbers, text, arrays and None are refused.

    Examples
    --------
    >>> truth("certify", 1)
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: certify = 1 is not allowed: it must be true or false; give \
one of them.
    """
    ndim: int = getattr(value, "ndim", 0)
    if ndim or not _is_truth(value):
        raise ParameterError(quantity, _shown(value), "true or false", "give one of them")
    return bool(value)


def _is_truth(value: object) -> bool:
    """Return whether a value is a truth value of Python or numpy, or an array of truth values."""
    return isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"


def word(quantity: str, value: object, words: Iterable[str], remedy: str = "name one") -> str:
    """Return a word if it is one of ``words``; numbers, arrays and lists are refused.

    Examples
    --------
    >>> word("method", "run", ("run", "wave"))
    'run'
    >>> word("method", "ran", ("run", "wave"))
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: method = ran is not allowed: it must be one of run, wave; \
name one.
    """
    known = list(words)
    if not isinstance(value, str) or value not in known:
        raise ParameterError(quantity, value, f"one of {', '.join(known)}", remedy)
    return value


def need_instance(quantity: str, value: object, kinds: tuple[type, ...], remedy: str) -> None:
    """Refuse a value that is not an instance of one of these classes.

    Examples
    --------
    >>> need_instance("nucleus", "3", (int, list), "give a number or sites")
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: nucleus = '3' is not allowed: it must be an object of the \
class int or list; give a number or sites.
    """
    if not isinstance(value, kinds):
        given = _shown(value) if isinstance(value, str) else type(value).__name__
        names = " or ".join(kind.__name__ for kind in kinds)
        raise ParameterError(quantity, given, f"an object of the class {names}", remedy)


def file_path(quantity: str, value: object) -> Path:
    """Return the path of a file that is given as text or as a path.

    Examples
    --------
    >>> file_path("out", "map.csv").suffix
    '.csv'
    """
    need_instance(quantity, value, (str, PathLike), "name a file")
    assert isinstance(value, (str, PathLike))
    return Path(value)


def check_progress(progress: object) -> None:
    """Refuse a progress callback that cannot be called; None stands for no report.

    Examples
    --------
    >>> check_progress(3)
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: progress = 3 is not allowed: it must be a function of the \
fraction done; give one, as print, or leave it out.
    """
    if progress is not None and not callable(progress):
        allowed, remedy = "a function of the fraction done", "give one, as print, or leave it out"
        raise ParameterError("progress", _shown(progress), allowed, remedy)


def _shown(value: object) -> str:
    """Return a short representation, on one line, of a value that is not a number."""
    return _in_one_line(repr(value), 60)


def _in_one_line(text: str, most: int) -> str:
    """Return a text without line breaks, truncated to ``most`` characters."""
    text = " ".join(text.split())
    return text if len(text) <= most else f"{text[: most - 3]}..."


@with_ranges(latest=LATEST)
def end_time(quantity: str, value: float) -> float:
    """Return the end time of a simulation after checking that it is positive and at most {latest}.

    At larger times double precision does not resolve the phase to one part in a million, and a
    simulation takes days.
    """
    allowed = f"positive and at most {as_text(LATEST)}"
    return _checked(
        quantity, value, allowed, "give a time in this range", lambda x: 0.0 < x <= LATEST
    )


def _checked(
    quantity: str,
    value: object,
    allowed: str,
    remedy: str,
    accept: Callable[[float], bool],
) -> float:
    if isinstance(value, (str, bytes)):  # a caller that only checks would continue with the text
        raise ParameterError(quantity, _shown(value), allowed, remedy)
    found = number(quantity, value, allowed, remedy)
    if not math.isfinite(found) or not accept(found):
        raise ParameterError(quantity, value, allowed, remedy)
    return found
