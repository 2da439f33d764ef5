"""Options of the command line, derived from the parameters of a function or a class."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fronts.arguments import decimal, real, real_or_range, site_list, whole
from fronts.signatures import REQUIRED, Described

FLAGS: Mapping[str, tuple[str, ...]] = {
    "sites": ("--n", "--sites"),
    "size": ("--nucleus",),
    "workers": ("--workers", "--jobs"),
    "perturbation": ("--perturbation", "--perturb"),
    "final_time": ("--t-end", "--final-time"),
    "end": ("--t-end", "--end"),
    "low": ("--from",),
    "high": ("--to",),
}
"""Options whose names are not their parameter's, and the other names that are understood."""

INTERNAL = frozenset({"progress", "executor", "self"})
"""Parameters that no shell can give."""

_READERS: Mapping[str, Any] = {
    "float": real,
    "numbers": real_or_range,
    "decimal": decimal,
    "int": whole,
    "str": str,
    "path": Path,
    "sites": site_list,
}


def option(name: str) -> str:
    """Return how a parameter is written at the shell.

    Examples
    --------
    >>> option("sites"), option("start_v")
    ('--n', '--start-v')
    """
    return FLAGS.get(name, (f"--{name.replace('_', '-')}",))[0]


def add_options(
    parser: argparse.ArgumentParser,
    parameters: Iterable[Described],
    *,
    scene: Mapping[str, Any],
    ranged: bool = False,
) -> None:
    """Declare one option for each parameter that a shell can give.

    An option that is not given is absent from the namespace, so that the function's own default
    holds.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Where.
    parameters : iterable of Described
        What.
    scene : mapping
        Defaults of this command for parameters that have none of their own, or another one.
    ranged : bool, optional
        Whether a number may also be a range ``low:high:count``.
    """
    for each in parameters:
        default = scene.get(each.name, each.default)
        words = _help(each, default, ranged)
        if each.kind == "bool":
            parser.add_argument(
                *_names(each.name),
                dest=each.name,
                action=argparse.BooleanOptionalAction if default is True else "store_true",
                default=argparse.SUPPRESS,
                help=words,
            )
            continue
        parser.add_argument(
            *_names(each.name),
            dest=each.name,
            type=real_or_range if ranged and each.kind == "float" else _READERS.get(each.kind, str),
            choices=each.choices or None,
            action="append" if each.kind == "strings" else "store",
            required=default is REQUIRED,
            default=argparse.SUPPRESS,
            metavar=_metavar(each),
            help=words,
        )


def offered(parameters: Iterable[Described], hidden: Iterable[str] = ()) -> tuple[Described, ...]:
    """Return the parameters that a shell can give: of a simple kind, and not hidden."""
    without = INTERNAL | set(hidden)
    return tuple(
        each
        for each in parameters
        if each.name not in without and (each.kind in _READERS or each.kind in _OTHERS)
    )


_OTHERS = {"bool", "choice", "strings"}


def _names(name: str) -> tuple[str, ...]:
    return FLAGS.get(name, (option(name),))


def _metavar(each: Described) -> str | None:
    if each.choices:
        return None
    return {"size": "SIZE", "path": "FILE"}.get(each.name, option(each.name).strip("-").upper())


def _help(each: Described, default: Any, ranged: bool) -> str:
    words = each.help[:1].lower() + each.help[1:].rstrip(".") if each.help else ""
    if each.kind == "numbers" or (ranged and each.kind == "float"):
        words += "; a range low:high:count gives a curve"
    value = getattr(default, "value", default)
    if default is not REQUIRED and value is not None and not isinstance(value, (bool, tuple)):
        words += f" (default {value:g})" if isinstance(value, float) else f" (default {value})"
    return words.replace("%", "%%")
