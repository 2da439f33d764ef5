"""Options of the command line, derived from the parameters of a function or a class."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeAlias

from fronts.answer import UsageError
from fronts.arguments import decimal, folder, real, real_or_range, site_list, size_or_shape, whole
from fronts.signatures import REQUIRED, Described, described

FLAGS: Mapping[str, tuple[str, ...]] = {
    "sites": ("--n", "--sites"),
    "start.sites": ("--excite",),
    "chain.seed": ("--disorder-seed",),
    "values": ("--value",),
    "excited": ("--excited", "--nucleus"),
    "lowest": ("--c-min", "--lowest"),
    "highest": ("--c-max", "--highest"),
    "left_boundary": ("--left-boundary", "--behind"),
    "point": ("--start-point",),
    "size": ("--nucleus",),
    "workers": ("--workers", "--jobs"),
    "perturbation": ("--perturbation", "--perturb"),
    "final_time": ("--t-end", "--final-time"),
    "end": ("--t-end", "--end"),
    "low": ("--from",),
    "high": ("--to",),
    "out": ("--out", "-o"),
    "listing": ("--list",),
}
"""Names of options that differ from those of their parameters, and alternative names."""

INTERNAL = frozenset(
    {"progress", "executor", "chain", "nucleus", "times", "estimate_error", "budget", "held", "out"}
)
"""Parameters that are not options: they cannot be given as text, or the command sets them."""

QUIET = "quiet"
"""Parameter of functions in `fronts.commands` that is set by ``--json``."""

Folder: TypeAlias = Path
"""Annotation of a parameter that is a folder."""

_READERS: Mapping[str, Any] = {
    "float": real,
    "numbers": real_or_range,
    "decimal": decimal,
    "int": whole,
    "str": str,
    "path": Path,
    "folder": folder,
    "sites": site_list,
    "shape": size_or_shape,
}


def option(name: str) -> str:
    """Return the name of the option for a parameter.

    Examples
    --------
    >>> option("sites"), option("start_v")
    ('--n', '--start-v')
    """
    return FLAGS.get(name, (f"--{name.replace('_', '-')}",))[0]


@dataclass(frozen=True)
class Group:
    """A group of options: the fields of a chain, or the parameters of a function.

    Attributes
    ----------
    prefix : str
        Prefix of each name in the namespace, so that groups may have names in common.
    every : tuple of Described
        All parameters, including those that are not options.
    presets : mapping
        Defaults of this command, for parameters that have none or another one.
    ranged : str
        What a number gives if it is a range ``low:high:count``; empty if it may not be one.
    internal : frozenset of str
        Parameters that are not options.
    """

    prefix: str
    every: tuple[Described, ...]
    presets: Mapping[str, Any]
    ranged: str = ""
    internal: frozenset[str] = INTERNAL

    @property
    def parameters(self) -> tuple[Described, ...]:
        """Parameters that are options: those of a kind that can be read from text."""
        return tuple(
            each
            for each in self.every
            if each.name not in self.internal and (each.kind in _READERS or each.kind in _OTHERS)
        )

    def declare(
        self,
        parser: Any,
        not_required: Iterable[str] = (),
        defaults: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """Declare one option for each parameter.

        An option that is not given is absent from the namespace, so that the default of the library
        applies.

        Parameters
        ----------
        parser : argparse.ArgumentParser or a group of it
            Parser or group that receives the options.
        not_required : iterable of str, optional
            Parameters that may be absent although they have no default.
        defaults : mapping of str to str, optional
            Descriptions of those defaults that depend on other parameters.
        """
        for each in self.parameters:
            default = defaults.get(each.name, self._default(each))
            dest, words = self.prefix + each.name, _help(each, default, self.ranged)
            if each.positional:
                parser.add_argument(dest, nargs="*" if each.kind == "strings" else "?",
                                    default=argparse.SUPPRESS, metavar=each.name.upper(),
                                    help=words)  # fmt: skip
                continue
            if each.kind == "bool":
                kind = argparse.BooleanOptionalAction if default is True else "store_true"
                parser.add_argument(*_names(self.prefix, each.name), dest=dest, action=kind,
                                    default=argparse.SUPPRESS, help=words)  # fmt: skip
                continue
            ranged = bool(self.ranged) and each.kind == "float"
            parser.add_argument(
                *_names(self.prefix, each.name),
                dest=dest,
                type=real_or_range if ranged else _READERS.get(each.kind, str),
                choices=each.choices or None,
                action="append" if each.kind == "strings" else "store",
                required=default is REQUIRED and each.name not in not_required,
                default=argparse.SUPPRESS,
                metavar=_metavar(self.prefix, each),
                help=words,
            )

    def is_required(self, each: Described) -> bool:
        """Return whether a parameter has no default."""
        return self._default(each) is REQUIRED

    def given(self, options: argparse.Namespace) -> dict[str, Any]:
        """Return the values that were given, or preset by the command, as library arguments."""
        found = {}
        for each in self.parameters:
            if hasattr(options, self.prefix + each.name):
                value = getattr(options, self.prefix + each.name)
                found[each.name] = each.make(value) if each.make is not None else value
            elif self.prefix + each.name in self.presets:
                found[each.name] = self.presets[self.prefix + each.name]
        return found

    def call(self, function: Callable[..., Any], options: argparse.Namespace) -> Any:
        """Call the function whose parameters these are with the given values."""
        given = self.given(options)
        words: list[Any] = []
        for each in self.parameters:
            if each.positional and each.name in given:
                value = given.pop(each.name)
                words += value if each.kind == "strings" else [value]
        return function(*words, **given)

    def defaults(self) -> dict[str, Any]:
        """Return the defaults of the parameters that have one."""
        found = {each.name: self._default(each) for each in self.parameters}
        return {
            name: value
            for name, value in found.items()
            if value is not REQUIRED and value is not None
        }

    def _default(self, each: Described) -> Any:
        return self.presets.get(self.prefix + each.name, each.default)


def options_of(function: Callable[..., Any]) -> Group:
    """Return every parameter of a function of `fronts.commands` as an option."""
    return Group("", described(function), {}, internal=frozenset({QUIET}))


def refuse_beside(question: str, **given: Any) -> None:
    """Refuse options that have no meaning together with another one.

    Parameters
    ----------
    question : str
        The other option, and what it does not do, as in ``"--list judges nothing"``.
    **given
        The values by parameter; None, False and () mean that an option is absent.

    Raises
    ------
    UsageError
        If such an option was given.
    """
    named = {option(name): each for name, each in given.items() if each not in (None, False, ())}
    if named:
        first = next(iter(named))
        raise UsageError(
            f"{question}: leave out {' and '.join(named)}.",
            quantity=first,
            value=named[first],
            allowed=f"absent when {question.split(maxsplit=1)[0]} is given",
            remedy="leave it out",
        )


_OTHERS = {"bool", "choice", "strings"}


def _names(prefix: str, name: str) -> tuple[str, ...]:
    return FLAGS.get(prefix + name) or FLAGS.get(name, (option(name),))


def _metavar(prefix: str, each: Described) -> str | None:
    if each.choices:
        return None
    if each.kind in ("path", "folder", "sites") or each.name == "size":
        return {"path": "FILE", "folder": "DIR", "sites": "SITES"}.get(each.kind, "SIZE")
    return _names(prefix, each.name)[0].strip("-").upper().replace("-", "_")


def _help(each: Described, default: Any, ranged: str) -> str:
    words = each.help.replace("{allowed}", str(each.allowed))
    words = words[:1].lower() + words[1:].rstrip(".")
    if each.kind == "numbers" or (ranged and each.kind == "float"):
        words += f"; a range low:high:count gives {ranged or 'a curve'}"
    value = getattr(default, "value", default)
    shown = (
        isinstance(value, (str, int, float, Path)) and value != "" and not isinstance(value, bool)
    )
    if shown:
        words += f" (default {value:g})" if isinstance(value, float) else f" (default {value})"
    return words.replace("%", "%%")
