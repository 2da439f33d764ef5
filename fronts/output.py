"""The files that a command writes beside its answer: options, checks, and what each says of itself.

`fronts.files` has the formats; it is imported only where a file is named.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import check_writable, same_file

if TYPE_CHECKING:
    from theory.result import Result

MAX_LINES = 40
"""Lines of an answer that are shown beside a file that has it."""


def add_output_options(parser: argparse.ArgumentParser) -> None:
    """Declare the files that every command can write."""
    group = parser.add_argument_group("files")
    group.add_argument(
        "-o", "--out", "--picture",
        dest="out", type=Path, action=_Files, default=[], metavar="FILE",
        help="write the result to a file ending in .csv, .json, .npz, .zarr, .png, .svg or .pdf, "
        "a run also as a film in .gif or .mp4; repeat it for several. Each holds the command, the "
        "parameters and the versions",
    )  # fmt: skip


class _Files(argparse.Action):
    """Collect files, and the option by which each was named, for what is said of it."""

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
    """Refuse, before any work, files that cannot be written or are named twice.

    Parameters
    ----------
    options : argparse.Namespace
        What was given; perhaps a ``checkpoint``.
    filmed : bool
        Whether there will be a film of the result.

    Raises
    ------
    UsageError
        If there is one.
    """
    named, checkpoint = getattr(options, "named", ()), getattr(options, "checkpoint", None)
    if named:
        from fronts.files import check_files

        check_files(named, filmed)
    if checkpoint is None:
        return
    check_writable(checkpoint, (".npz",), "--checkpoint")
    if any(same_file(path, checkpoint) for path, _ in named):
        raise UsageError(f"--out and --checkpoint are both {checkpoint}: name two files.")


def write_output(
    out: Sequence[Path], result: Result, parameters: Mapping[str, Any], payload: Mapping[str, Any]
) -> None:
    """Write a result to files, each with the command line and the parameters.

    Parameters
    ----------
    out : sequence of Path
        The files.
    result, parameters
        What was found, with what.
    payload : mapping
        The result as the command answers it in JSON; it may say more than the result itself.
    """
    from fronts.files import write_result

    for path in out:
        if path != parameters.get("out"):  # what can be resumed has been written
            write_result(path, result, parameters, payload)


def with_table(answer: Answer, rows: str, out: Path, parameters: Mapping[str, Any]) -> Answer:
    """Write an answer to a file, with the command line and the parameters; return what is said.

    Parameters
    ----------
    answer : Answer
        What to write.
    rows : str
        Its entry that is a list with one mapping a row.
    out : Path
        Ends in .csv, .json or .npz.
    parameters : mapping
        What was asked.
    """
    from fronts.files import Listing, write_result

    found: Any = answer.payload[rows]
    write_result(out, Listing(payload=answer.payload, listed=found), parameters)
    return replace(answer, text=beside_files(answer.text, [out]))


def beside_files(text: str, out: Sequence[Path]) -> str:
    """Return what is said of a result that was written to files: a long text in short."""
    lines = text.splitlines()
    if len(lines) > MAX_LINES:  # the files have them all
        text = "\n".join([*lines[:3], "…", *lines[-2:]])
    return f"{text}\nwritten to {' and '.join(str(path) for path in out)}"


def command_line(words: Sequence[str]) -> str:
    """Return a command line without what says where its answer goes.

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
