"""A command that is derived from the library: its parser, and carrying it out."""

from __future__ import annotations

import argparse
import inspect
import shlex
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from fronts.answer import Answer, UsageError
from fronts.arguments import real
from fronts.catalogue import Call
from fronts.options import add_options, offered, option
from fronts.signatures import REQUIRED, Described, described

Range = tuple[float, float, int]


def configure(parser: argparse.ArgumentParser, call: Call) -> None:
    """Declare the options of a call: those of its chain, of its nucleus, its own, and of files.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Where.
    call : Call
        What.
    """
    if call.chain:
        group = parser.add_argument_group("the chain")
        fields = described(located(call.chain))
        add_options(group, fields, scene=_scene_of(call, fields), ranged=call.ranged)
        if _takes_eta(fields):
            words = "b/a^2, in place of a and b: a = 1 and b = eta are the same chain up to a scale"
            group.add_argument("--eta", type=real, default=argparse.SUPPRESS, help=words)
    function = located(call.function)
    own = described(function)
    for each in own:
        if each.kind == "Nucleus":
            group = parser.add_argument_group("the nucleus")
            add_options(group, described(_nucleus()), scene=call.scene)
    add_options(parser, offered(own, call.hidden), scene=call.scene)
    add_output_options(parser)


def add_output_options(parser: argparse.ArgumentParser) -> None:
    """Declare the files that every command can write."""
    group = parser.add_argument_group("files")
    group.add_argument(
        "-o", "--out", "--picture",
        dest="out", type=Path, action="append", default=[], metavar="FILE",
        help="write the result to a file ending in .csv, .json, .npz, .png, .svg or .pdf; repeat "
        "it for several. Each holds the command, the parameters and the versions",
    )  # fmt: skip


def run(options: argparse.Namespace, call: Call, words: Sequence[str]) -> Answer:
    """Call the function that is behind a command, and write the files that are asked for.

    Parameters
    ----------
    options : argparse.Namespace
        The options that were given; others are absent.
    call : Call
        What to call.
    words : sequence of str
        The command line, for the files.

    Returns
    -------
    Answer
        The result as JSON and in words.
    """
    from fronts.files import Provenance, check_files, write_result
    from fronts.progress import Fraction
    from fronts.wording import in_words

    check_files(options.out)
    function = located(call.function)
    own = described(function)
    arguments = _given(options, offered(own, call.hidden))
    arguments = {**_own_scene(call, own), **arguments}
    with Fraction(words[0]) as live:
        if "progress" in inspect.signature(function).parameters:
            arguments["progress"] = live.show
        result = function(**_values(arguments))
    arguments.pop("progress", None)
    shown = Provenance(
        command=shlex.join(["fronts", *without_files(words)]),
        parameters=_parameters(own, arguments),
    )
    for path in options.out:
        write_result(path, result, shown)
    text = in_words(result)
    if options.out:
        text += f"\nwritten to {' and '.join(str(path) for path in options.out)}"
    return Answer(result.to_dict(), text)


def located(where: str) -> Callable[..., Any]:
    """Return what ``module:name`` names."""
    module, name = where.split(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found


def without_files(words: Sequence[str]) -> list[str]:
    """Return a command line without what says where its answer goes.

    Examples
    --------
    >>> without_files(["kinetic", "--c", "1", "-o", "x.csv", "--out=y.png", "--json"])
    ['kinetic', '--c', '1']
    """
    left: list[str] = []
    skip = False
    for word in words:
        name = word.split("=")[0]
        if skip:
            skip = False
        elif name in ("-o", "--out", "--picture"):
            skip = "=" not in word
        elif word != "--json":
            left.append(word)
    return left


def _given(options: argparse.Namespace, parameters: Sequence[Described]) -> dict[str, Any]:
    """Return the parameters that were given, as the function takes them."""
    found = {}
    for each in parameters:
        if hasattr(options, each.name):
            value = getattr(options, each.name)
            found[each.name] = each.make(value) if each.make is not None else value
    return found


def _own_scene(call: Call, parameters: Sequence[Described]) -> dict[str, Any]:
    names = {each.name for each in parameters}
    return {name: value for name, value in call.scene.items() if name in names}


def _values(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Turn ranges into arrays; one at most."""
    ranges = [name for name, value in arguments.items() if is_range(value)]
    if len(ranges) > 1:
        names = " or for ".join(option(name) for name in ranges)
        raise UsageError(f"give a range for {names}, not for both.")
    return {
        name: values_of(value) if is_range(value) else value for name, value in arguments.items()
    }


def is_range(value: Any) -> bool:
    """Tell whether an option was given as ``low:high:count``.

    Examples
    --------
    >>> is_range((0.0, 1.0, 5)), is_range((14, 15, 16)), is_range(0.5)
    (True, False, False)
    """
    return isinstance(value, tuple) and len(value) == 3 and isinstance(value[0], float)


def values_of(given: Range) -> list[float]:
    """Return the values of a range, without the rounding that 0.1 added thrice would show.

    Examples
    --------
    >>> values_of((0.01, 0.14, 14))[2]
    0.03
    """
    import numpy as np

    return [float(f"{value:.15g}") for value in np.linspace(*given)]


def _parameters(own: Sequence[Described], arguments: Mapping[str, Any]) -> dict[str, Any]:
    defaults = {
        each.name: each.default
        for each in offered(own)
        if each.default is not REQUIRED and each.default is not None
    }
    return {**defaults, **arguments}


def _scene_of(call: Call, fields: Sequence[Described]) -> dict[str, Any]:
    scene = dict(call.scene)
    if _takes_eta(fields):  # not required: eta may be given in their place
        scene = {"a": None, "b": None, **scene}
    return scene


def _takes_eta(fields: Sequence[Described]) -> bool:
    names = {each.name for each in fields}
    return {"a", "b"} <= names and "eta" not in names


def _nucleus() -> type:
    return located("theory.chains.nucleus:Nucleus")  # type: ignore[return-value]
