"""The base of enumerations whose members carry a sentence that explains them."""

from __future__ import annotations

import re
from enum import EnumType, StrEnum
from typing import Any, NoReturn, Self

from theory.parameters import ParameterError


class _FoundByWord(EnumType):
    """Metaclass of statuses, which refuses a list or an array as it refuses an unknown word.

    `enum` compares an unhashable value with each member, which is ambiguous for an array.
    """

    def __call__(cls, value: Any, *args: Any, **options: Any) -> Any:
        if not args and not options and not isinstance(value, str):
            return cls._missing_(value)  # type: ignore[attr-defined]
        return super().__call__(value, *args, **options)


class Status(StrEnum, metaclass=_FoundByWord):
    """An enumeration whose members have a word, for JSON and files, and a sentence for readers.

    Members are written as a pair. The word alone selects the member; an unknown word raises a
    `ParameterError`.

    Attributes
    ----------
    sentence : str
        Meaning of the member and, where something can be done, advice.

    Examples
    --------
    >>> class Outcome(Status):
    ...     DONE = "done", "the run has come to its end."
    >>> Outcome("done").sentence, f"{Outcome.DONE}"
    ('the run has come to its end.', 'done')
    """

    sentence: str

    def __new__(cls, value: str, sentence: str = "") -> Self:
        """Return a member that carries its sentence."""
        if not sentence.endswith("."):
            raise TypeError(
                f"{cls.__name__} member {value!r} needs a sentence that states its meaning."
            )
        member = str.__new__(cls, value)
        member._value_ = value
        member.sentence = sentence
        return member

    @classmethod
    def _missing_(cls, value: object) -> NoReturn:
        words = ", ".join(each.value for each in cls)
        name = re.sub(r"(?<!^)(?=[A-Z])", " ", cls.__name__).lower()
        raise ParameterError(name, value, f"one of {words}", "name one")
