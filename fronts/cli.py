"""The command ``fronts``: find the subcommand, import only that one, print its answer."""

from __future__ import annotations

import argparse
import errno
import importlib
import json
import logging
import os
import sys
from collections.abc import Sequence
from types import ModuleType
from typing import NoReturn

from fronts.answer import UsageError
from fronts.arguments import BadText, with_values_joined
from verification.execution.files import FileError

_OF_A_FILE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)

COMMANDS = {
    "kinetic": "every velocity at which the piecewise-linear front can travel (Eq. 54)",
    "sum": "the sum of the kinetic relation, by four methods (Eq. 53)",
    "roots": "labelled complex roots of the dispersion relation (Eqs. 50-52)",
    "profile": "the shape of the front (Eq. 49) and whether it is admissible (Eq. 47)",
    "front": "velocity of a front by direct simulation (Eqs. 5, 8, 43, 44)",
    "simulate": "a run of a chain from given sites, as numbers and as a picture (Eqs. 5, 8, 43)",
    "cell": "what one oscillator alone can do: rest, cycles, basin (Fig. 2; Eqs. 2-8)",
    "map": "the state of a chain over a plane of parameters (Figs. 5, 15)",
    "breather": "a localised oscillation of the Van der Pol chain, four ways (Eqs. 8-43)",
    "threshold": "the coupling at which a nucleus stops being localised (Figs. 4, 11)",
    "derive": "the derivation of every equation, checked, and of your own cell (Eqs. 1-54)",
    "stress": "every quantity over all decades of its parameters, held against another method",
    "bench": "error against run time beside peers, and how cost grows (source tree only)",
    "check": "the verdict on each claim of the paper",
}
"""Subcommand and one line of help; the code is ``fronts.commands.<name>``."""


class _Parser(argparse.ArgumentParser):
    """An argument parser that raises instead of printing and exiting."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see '{self.prog} --help'.")

    def read(self, words: Sequence[str]) -> argparse.Namespace:
        """Return the options, or raise what names the option that cannot be read."""
        try:
            return self.parse_args(with_values_joined(words))
        except argparse.ArgumentError as error:
            name, cause = error.argument_name, error.__context__
            if name is None:
                self.error(str(error))
            name = name.split("/")[0]
            if isinstance(cause, BadText):
                from theory.parameters import ParameterError

                raise ParameterError(name, cause.value, cause.allowed, cause.remedy) from None
            raise UsageError(f"{error}; see '{self.prog} --help'.", quantity=name) from None


def _overview() -> str:
    lines = [
        "usage: fronts COMMAND [options]    (fronts COMMAND --help shows an example)",
        "",
        "Excitation fronts in self-excited chains: theory, direct simulation, verdicts.",
        "",
        *(f"  {name:<10} {line}" for name, line in COMMANDS.items()),
        "",
        "Every command takes --json and then prints one JSON object. --version tells the version.",
    ]
    return "\n".join(lines)


def _parser(name: str) -> tuple[_Parser, ModuleType]:
    module = importlib.import_module(f"fronts.commands.{name}")
    parser = _Parser(
        prog=f"fronts {name}",
        description=COMMANDS[name][:1].upper() + COMMANDS[name][1:] + ".",
        epilog=module.EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
        exit_on_error=False,
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    module.configure(parser)
    return parser, module


def _run(argv: Sequence[str]) -> int:
    if not argv or argv[0] in ("-h", "--help", "help"):
        print(_overview())
        return 0
    if argv[0] == "--version":
        print(f"fronts {_version()}")
        return 0
    name, *rest = argv
    if name not in COMMANDS:
        known = ", ".join(COMMANDS)
        raise UsageError(
            f"'{name}' is not a command: choose one of {known}.",
            quantity="command",
            value=name,
            allowed=known,
            remedy="choose one of these",
        )
    parser, module = _parser(name)
    _announce_compilation()
    answer = module.run(parser.read(rest))
    if "--json" in rest:
        print(json.dumps(answer.payload, allow_nan=False))
    else:
        print(answer.text)
    return int(answer.exit_code)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("excitation-fronts")
    except PackageNotFoundError:
        return "not installed: run from its source"


def _announce_compilation() -> None:
    """Let a terminal show that the first run of a stepper compiles it."""
    logger = logging.getLogger("verification.execution.compiled")
    if sys.stderr is not None and sys.stderr.isatty() and not logger.handlers:
        handler = logging.StreamHandler()
        handler.setFormatter(logging.Formatter("fronts: %(message)s"))
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)


def _complain(message: str, as_json: bool, details: dict[str, str]) -> None:
    if sys.stderr is None:  # closed: the exit code must do
        return
    if as_json:
        print(json.dumps({"error": {"message": message, **details}}), file=sys.stderr)
    else:
        print(f"fronts: {message}", file=sys.stderr)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Exit code 0: done. 1: done, and the answer needs attention. 2: the input cannot be used;
    one sentence says why. 3: a defect of the toolkit. 130: interrupted.

    An error meant for the user is a ``UsageError``, an ``OSError`` on a file, a ``ValueError``
    with the attributes ``quantity``, ``value``, ``allowed`` and ``remedy``, a ``PrecisionError``
    or a ``RunError``.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    as_json = "--json" in arguments
    if sys.stdout is None:
        _complain("standard output is closed: open it, or send it to a file.", as_json, {})
        return 2
    try:
        code = _run(arguments)
        sys.stdout.flush()
        return code
    except UsageError as error:
        _complain(str(error), as_json, error.details)
        return 2
    except KeyboardInterrupt as interrupted:
        kept = str(interrupted) or "nothing half-written is left behind"
        _complain(f"interrupted; {kept}.", as_json, {})
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except FileError as error:
        fields = ("quantity", "value", "allowed", "remedy")
        _complain(str(error), as_json, {field: str(getattr(error, field)) for field in fields})
        return 2
    except MemoryError:
        _complain("memory ran out: ask for fewer sites, samples or points.", as_json, {})
        return 2
    except OSError as error:
        # Of a file only: what a file system says while writing is for the user to mend.
        if error.filename is None and error.errno not in _OF_A_FILE:
            return _defect(error, as_json)
        where = "" if error.filename is None else f" {error.filename}"
        _complain(f"the file{where} cannot be used: {error.strerror}.", as_json, {})
        return 2
    except Exception as error:
        if isinstance(error, ValueError) and hasattr(error, "remedy"):
            fields = ("quantity", "value", "allowed", "remedy")
            details = {field: str(getattr(error, field)) for field in fields}
            _complain(str(error), as_json, details)
            return 2
        from theory.parameters import RunError
        from theory.piecewise.sums.result import PrecisionError

        if isinstance(error, (PrecisionError, RunError)):
            _complain(str(error), as_json, {})
            return 2
        return _defect(error, as_json)


def _defect(error: Exception, as_json: bool) -> int:
    if os.environ.get("FRONTS_TRACEBACK"):
        raise error
    _complain(
        f"a defect of this toolkit: {type(error).__name__}: {error} "
        "(set FRONTS_TRACEBACK=1 to see where).",
        as_json,
        {},
    )
    return 3


if __name__ == "__main__":
    sys.exit(main())
