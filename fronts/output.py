"""The files that a command writes in addition to its answer: options and checks.

`fronts.files` contains the formats; it is imported only if a file is named.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import check_writable, same_file

if TYPE_CHECKING:
    from theory.result import Result

MAX_LINES = 40
"""Largest number of lines of an answer that are shown in full if it is written to a file too."""


def add_output_options(parser: argparse.ArgumentParser) -> None:
    """Declare the option for the files that every command can write."""
    group = parser.add_argument_group("files")
    group.add_argument(
        "-o", "--out", "--picture",
        dest="out", type=Path, action=_Files, default=[], metavar="FILE",
        help="write the result to a file ending in .csv, .json, .npz, .zarr, .png, .svg or .pdf; "
        "a simulation also as a film in .gif or .mp4; may be repeated. Each file contains the "
        "command, the parameters and the versions",
    )  # fmt: skip


class _Files(argparse.Action):
    """Collect files, and the option by which each was named, for error messages."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        namespace.out = [*namespace.out, values]
        name = "--out" if option_string == "-o" else option_string
        namespace.named = [*getattr(namespace, "named", ()), (values, name)]


def check_output(options: argparse.Namespace, filmed: bool) -> None:
    """Refuse files that cannot be written or are named twice, before any work is done.

    Parameters
    ----------
    options : argparse.Namespace
        The options, which may include a ``checkpoint``.
    filmed : bool
        Whether the result can be written as a film.

    Raises
    ------
    UsageError
        If there is such a file.
    """
    named, checkpoint = getattr(options, "named", ()), getattr(options, "checkpoint", None)
    if named:
        from fronts.files import check_files

        check_files(named, filmed)
    if checkpoint is None:
        return
    check_writable(checkpoint, (".npz",), "--checkpoint")
    if any(same_file(path, checkpoint) for path, _ in named):
        raise UsageError(f"--out and --checkpoint are both {checkpoint}: name two different files.")


def write_output(
    out: Sequence[Path], result: Result, parameters: Mapping[str, Any], payload: Mapping[str, Any]
) -> None:
    """Write a result to files, each with the command line and the parameters.

    Parameters
    ----------
    out : sequence of Path
        The files.
    result, parameters
        The result, and the parameters of the computation.
    payload : mapping
        The answer of the command as JSON; it may contain more than the result itself.
    """
    from fronts.files import write_result

    for path in out:
        if path != parameters.get("out"):  # the resumable table has been written already
            write_result(path, result, parameters, payload)


def with_table(answer: Answer, rows: str, out: Path, parameters: Mapping[str, Any]) -> Answer:
    """Write an answer to a file, with the command line and the parameters; return what to print.

    Parameters
    ----------
    answer : Answer
        The answer.
    rows : str
        Name of its entry that is a list with one mapping per row.
    out : Path
        Name of the file, ending in .csv, .json or .npz.
    parameters : mapping
        The parameters of the command.
    """
    from fronts.files import Listing, write_result

    found: Any = answer.payload[rows]
    write_result(out, Listing(payload=answer.payload, listed=found), parameters)
    return replace(answer, text=beside_files(answer.text, [out]))


def beside_files(text: str, out: Sequence[Path]) -> str:
    """Return the text to print for a result that was written to files, shortened if it is long."""
    lines = text.splitlines()
    if len(lines) > MAX_LINES:  # the files contain all lines
        lines = [line for table in _tables(lines) for line in _ends(table, 3)]
    if len(lines) > MAX_LINES:
        lines = _ends(lines, 3)
    return "\n".join([*lines, f"written to {' and '.join(str(path) for path in out)}"])


def _ends(lines: list[str], first: int) -> list[str]:
    """Return the first lines of many and the last two."""
    return lines if len(lines) <= first + 3 else [*lines[:first], "…", *lines[-2:]]


def _tables(lines: Iterable[str]) -> Iterator[list[str]]:
    """Yield the tables among lines, which are indented and begin with a head, and other lines.

    Below a table there may be further columns of it, under a head that begins with the same word.
    """
    table: list[str] = []
    for line in lines:
        if table and not (line.startswith("  ") and line.split()[:1] != table[0].split()[:1]):
            yield table
            table = []
        if line.startswith("  "):
            table.append(line)
        else:
            yield [line]
    if table:
        yield table


def command_line(words: Sequence[str]) -> str:
    """Return a command line without the options that say where its answer goes.

    Examples
    --------
    >>> command_line(["kinetic", "--c", "1", "-o", "x.csv", "--out=y.png", "--json"])
    'fronts kinetic --c 1'
    """
    left: list[str] = []
    skip = False
    for word in words:
        name = word.split("=")[0]
        if skip:
            skip = False
        elif name in ("-o", "--out", "--picture"):
            skip = "=" not in word
        elif word not in ("--json", "--resume"):
            left.append(word)
    return shlex.join(["fronts", *left])
