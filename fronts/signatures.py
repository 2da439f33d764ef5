"""Descriptions of the parameters of functions and classes: names, kinds, defaults, help texts.

The command line has no list of options of its own; it reads signatures and numpy docstrings.
"""

from __future__ import annotations

import ast
import dataclasses
import inspect
import re
import sys
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from theory.parameters import Range

REQUIRED = inspect.Parameter.empty
"""Value that marks a parameter without a default."""

_ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: :(?: .*)?)?$")


KINDS = frozenset({
    "Smooth chain", "Friction chain", "Chain (44)", "Lattice", "Lattice or network",
    "Lattice with directions, or network",
})  # fmt: skip
"""Kinds of chains, with which a sentence of a description begins that holds for one of them."""


@dataclass(frozen=True, kw_only=True)
class Described:
    """One parameter of a function or one field of a dataclass.

    Attributes
    ----------
    name : str
        Its name in Python.
    kind : str
        One of ``float``, ``numbers`` (a number or an array), ``decimal`` (a number kept as text),
        ``int``, ``str``, ``bool``, ``path``, ``folder``, ``sites``, ``choice``, ``strings``, or the
        name of the class. The metadata of a field may specify it
        (``theory.chains.chain.parameter``).
    default : object
        Default, or `REQUIRED` if there is none.
    help : str
        Description in the docstring or the metadata, as one paragraph.
    choices : tuple of str
        Allowed values of a ``choice``.
    make : callable or None
        Function that converts a choice to the value that is passed on.
    allowed : Range or None
        Its range, which takes the place of "{allowed}" in ``help``; commands may have a narrower
        one.
    positional : bool
        Whether it is given without its name: before a ``/`` in the signature, or after a ``*``.
    """

    name: str
    kind: str
    default: Any
    help: str
    choices: tuple[str, ...] = ()
    make: Callable[[str], Any] | None = None
    allowed: Range | None = None
    positional: bool = False


def described(what: Callable[..., Any]) -> tuple[Described, ...]:
    """Return the parameters of a function, or the fields of a dataclass that a user may set.

    Parameters
    ----------
    what : callable
        A function or class whose numpy docstring describes them under Parameters or Attributes.

    Returns
    -------
    tuple of Described
        In the order of the signature.

    Examples
    --------
    >>> from theory.cells.friction import FrictionCell
    >>> described(FrictionCell)[0].name, described(FrictionCell)[0].kind
    ('v_d', 'float')
    """
    words = documented(inspect.getdoc(what) or "")
    module = dict(vars(sys.modules[what.__module__]))
    if dataclasses.is_dataclass(what):
        return tuple(
            _described(
                each.name,
                str(each.type),
                _default(each),
                words=words,
                module=module,
                metadata=each.metadata,
            )
            for each in dataclasses.fields(what)
            if each.init and each.metadata.get("option", True)
        )
    return tuple(
        _of_signature(each, words, module)
        for each in inspect.signature(what).parameters.values()
        if each.kind is not inspect.Parameter.VAR_KEYWORD
    )


def _of_signature(
    each: inspect.Parameter, words: Mapping[str, str], module: Mapping[str, Any]
) -> Described:
    found = _described(
        each.name, str(each.annotation), each.default, words=words, module=module, metadata={}
    )
    if each.kind is inspect.Parameter.VAR_POSITIONAL:
        return replace(found, kind="strings", default=(), positional=True)
    return replace(found, positional=each.kind is inspect.Parameter.POSITIONAL_ONLY)


def documented(doc: str) -> dict[str, str]:
    """Return the text of each entry of the sections Parameters and Attributes.

    Examples
    --------
    >>> documented('''Do it.
    ...
    ... Parameters
    ... ----------
    ... a, b : float
    ...     Coefficients,
    ...     positive.
    ... ''')
    {'a': 'Coefficients, positive.', 'b': 'Coefficients, positive.'}
    """
    found: dict[str, str] = {}
    lines = doc.splitlines()
    names: list[str] = []
    inside = False
    for number, line in enumerate(lines):
        if number + 1 < len(lines) and set(lines[number + 1].strip()) == {"-"}:
            inside, names = line.strip() in ("Parameters", "Attributes"), []
        elif inside and (entry := _ENTRY.match(line)):
            names = [name.lstrip("*") for name in entry[1].split(", ")]
            found |= dict.fromkeys(names, "")
        elif inside:
            for name in names:
                found[name] = f"{found[name]} {line.strip()}".strip()
    return found


def of_kinds(words: str, kinds: Collection[str]) -> str:
    """Return a description without the sentences that hold for other kinds of chains.

    Where there is one kind only, its sentences need not name it.

    Examples
    --------
    >>> words = "Longest chain. Smooth chain: from 32. Friction chain: from 24, or 30."
    >>> of_kinds(words, ["Friction chain"])
    'Longest chain. From 24, or 30.'
    >>> of_kinds(words, ["Smooth chain", "Lattice"])
    'Longest chain. Smooth chain: from 32.'
    """
    kept = []
    for sentence in re.split(r"(?<=\.) (?=[A-Z])", words):
        kind, _, text = sentence.partition(": ")
        if kind not in KINDS:
            kept.append(sentence)
        elif kind in kinds:
            kept.append(sentence if len(kinds) > 1 else text[:1].upper() + text[1:])
    return " ".join(kept)


def _default(each: dataclasses.Field[Any]) -> Any:
    if each.default is not dataclasses.MISSING:
        return each.default
    if each.default_factory is not dataclasses.MISSING:
        return each.default_factory()
    return REQUIRED


def _described(
    name: str,
    annotation: str,
    default: Any,
    *,
    words: Mapping[str, str],
    module: Mapping[str, Any],
    metadata: Mapping[str, Any],
) -> Described:
    text = metadata.get("help", words.get(name, "")).replace("`", "")
    plain = annotation.strip("'\"").replace(" | None", "").replace("None | ", "")
    first = plain.partition(" | ")[0]
    plain = first if isinstance(module.get(first), type) else plain
    if plain.startswith("Literal["):
        choices = ast.literal_eval(plain.removeprefix("Literal"))
        return Described(
            name=name, kind="choice", default=default, help=text, choices=tuple(choices)
        )
    known = module.get(plain)
    if isinstance(known, type) and issubclass(known, Enum):
        values = tuple(str(member.value) for member in known)
        return Described(
            name=name, kind="choice", default=default, help=text, choices=values, make=known
        )
    kind = metadata.get("kind") or _KINDS.get(plain, plain)
    allowed = metadata.get("allowed")
    return Described(name=name, kind=kind, default=default, help=text, allowed=allowed)


_KINDS = {
    "float": "float",
    "SupportsFloat": "float",
    "Numbers": "numbers",
    "float | str": "decimal",
    "int": "int",
    "str": "str",
    "bool": "bool",
    "Path": "path",
    "Folder": "folder",
    "Sequence[int]": "sites",
    "tuple[int, ...]": "sites",
    "Sequence[str]": "strings",
}
