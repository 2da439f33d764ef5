"""The command ``fronts``: identify subcommand and model, import only these, print the answer."""

from __future__ import annotations

import argparse
import errno
import importlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NoReturn

import fronts
from fronts.answer import Answer, UsageError
from fronts.arguments import BadText, with_values_joined
from fronts.catalogue import ALIASES, COMMANDS, Command, CommandCall

_OF_A_FILE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)


class _Parser(argparse.ArgumentParser):
    """An argument parser that raises instead of printing and exiting."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see '{self.prog} --help'.")

    def refuse(self, word: str, value: str) -> NoReturn:
        """Refuse an option that does not exist for this command and model."""
        flag, _, joined = word.partition("=")
        where = f"'{self.prog}'"
        if not flag.startswith("--"):
            self.error(f"'{word}' is not expected here")
        close = self._close_to(flag)
        fault, remedy = "has no meaning for", "leave it out"
        if close:
            fault, remedy = "is not an option of", f"write {close}"
        raise UsageError(
            f"{flag} {fault} {where}: {remedy}.",
            quantity=flag,
            value=joined or value,
            allowed=f"absent for {where}",
            remedy=remedy,
        )

    def _close_to(self, flag: str) -> str:
        """Return the options that may be meant: those that begin with ``flag``, or are similar.

        A single letter is a quantity with a meaning of its own, as N or c, and not an abbreviation.
        """
        import difflib

        if len(flag) == len("--n"):
            return ""
        every = [each for each in self._option_string_actions if each.startswith("--")]
        begun = [each for each in every if each.startswith(flag)]
        return " or ".join(begun or difflib.get_close_matches(flag, every, n=1, cutoff=0.8))

    def read(self, words: Sequence[str]) -> argparse.Namespace:
        """Return the options, or raise an error that names the option that cannot be read."""
        try:
            options, unknown = self.parse_known_args(with_values_joined(words))
            if unknown:
                self.refuse(unknown[0], " ".join(unknown[1:2]))
            return options
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
        *(f"  {name:<10} {command.line}" for name, command in COMMANDS.items()),
        "",
        "With --json, every command prints one JSON object. --version prints the version, and",
        "--print-completion bash (zsh, tcsh) prints the completion script for that shell.",
    ]
    return "\n".join(lines)


def _run(argv: Sequence[str]) -> int:
    if not argv or argv[0] in ("-h", "--help", "help"):
        print(_overview())
        return 0
    if argv[0] == "--version":
        print(f"fronts {fronts.__version__}")
        return 0
    if argv[0] == "--print-completion":
        print(_completion(argv[1:]))
        return 0
    name, *rest = argv
    command = COMMANDS.get(name)
    if command is None:
        known = ", ".join(COMMANDS)
        raise UsageError(
            f"'{name}' is not a command: choose one of {known}.",
            quantity="command",
            value=name,
            allowed=known,
            remedy="choose one of these",
        )
    parser, carry_out, rest = _chosen(name, command, rest)
    _announce_compilation()
    answer = carry_out(parser.read(rest))
    if "--json" in rest:
        print(json.dumps(answer.payload, allow_nan=False))
    else:
        print(answer.text)
    return int(answer.exit_code)


def _chosen(
    name: str, command: Command, rest: Sequence[str]
) -> tuple[_Parser, Callable[[argparse.Namespace], Answer], list[str]]:
    """Return the parser of a command and model, the function to call, and the remaining words."""
    if command.module:
        return _of_its_own(name, command, rest)
    from fronts import derived
    from fronts.bound import BoundCall, configure, models_of

    calls = models_of(command)
    model, rest = _model(name, command, calls, rest)
    bound = BoundCall(calls[model], model)
    examples = _examples(command, model, f"{name} {model} {bound.required()}".rstrip())
    parser = new_parser(f"fronts {name} {model}".rstrip(), command.line, examples)
    configure(parser, bound)
    words = [word for word in (name, model, *rest) if word]
    return parser, lambda options: derived.run(options, bound, words), rest


def _of_its_own(
    name: str, command: Command, rest: Sequence[str]
) -> tuple[_Parser, Callable[[argparse.Namespace], Answer], list[str]]:
    """Return the same for a command that is a function in `fronts.commands`."""
    from functools import partial

    from fronts.options import QUIET, options_of

    module, function = _own(command)
    parser = new_parser(f"fronts {name}", command.line, module.EXAMPLE)
    own = options_of(function)
    own.declare(parser)
    if any(each.name == QUIET for each in own.every):
        function = partial(function, quiet="--json" in rest)

    def carry_out(options: argparse.Namespace) -> Answer:
        if hasattr(options, "out"):
            from fronts.output import command_line
            from verification.execution.metadata import COMMAND_LINE

            COMMAND_LINE.set(command_line([name, *rest]))
        found: Answer = own.call(function, options)
        return found

    return parser, carry_out, list(rest)


def _own(command: Command) -> tuple[Any, Callable[..., Answer]]:
    """Return the module of a command, and the function of the same name in it."""
    module = importlib.import_module(f"fronts.commands.{command.module}")
    return module, getattr(module, command.module)


def _examples(command: Command, model: str, required: str = "") -> str:
    """Return the examples for a model; if there are none, ``required`` serves as example."""
    every = command.examples.split("\n  fronts ")[1:]
    named = {each: each.split()[1] for each in every}
    shown = {model} if model != command.default else {model, *_not_models(command, named.values())}
    own = [each for each in every if named[each] in shown]
    notes = f"\n\n{command.notes}" if command.notes else ""
    if command.default and model == command.default:
        name = required.partition(" ")[0]
        others = [f"\n  fronts {name} {each} --help" for each in command.calls if each != model]
        notes += f"\n\nThe model is {model} unless another one is named:{''.join(others)}"
    return "\n  fronts ".join(["examples:", *(own or [required])]) + notes


def _not_models(command: Command, words: Iterable[str]) -> set[str]:
    return {word for word in words if word not in command.calls}


def _model(
    name: str, command: Command, calls: Mapping[str, CommandCall], rest: Sequence[str]
) -> tuple[str, list[str]]:
    """Return the model, named by the first word or the default, and the remaining words."""
    if "" in calls:
        return "", list(rest)
    known = ", ".join(calls)
    first = rest[0] if rest else ""
    if first in ("-h", "--help") and not command.default:
        lines = [f"usage: fronts {name} MODEL [options]", "", f"{_sentence(command.line)}", ""]
        lines += [f"  fronts {name} {model} --help" for model in calls]
        print("\n".join([*lines, "", _examples(command, next(iter(calls)))]))
        raise SystemExit(0)
    model = ALIASES.get(first, first)
    if model in calls:
        return _renamed(model, list(rest[1:]), calls, name)
    if command.default and (not first or first.startswith("-")):
        return _renamed(command.default, list(rest), calls, name)
    message = f"'{first}' is not a model" if first else "a model is missing"
    raise UsageError(
        f"{message}: choose one of {known}; see 'fronts {name} --help'.",
        quantity="model",
        value=first,
        allowed=known,
        remedy="choose one of these",
    )


def _renamed(
    model: str, rest: list[str], calls: Mapping[str, CommandCall], command: str
) -> tuple[str, list[str]]:
    """Interpret ``vdp --model envelope`` as the model averaged, and ``vdp --model full`` as vdp."""
    for index, word in enumerate(rest):
        name, equals, value = word.partition("=")
        if model == "vdp" and name == "--model" and "averaged" in calls:
            used = 1 if equals else 2
            value = value if equals else "".join(rest[index + 1 : index + 2])
            models = {"full": "vdp", "averaged": "averaged", **ALIASES}
            if value not in models:
                raise UsageError(
                    f"argument --model: invalid choice: '{value}' (choose from {', '.join(models)})"
                    f"; see 'fronts {command} --help'.",
                    quantity="--model",
                )
            return models[value], rest[:index] + rest[index + used :]
    return model, rest


def new_parser(program: str, line: str, examples: str) -> _Parser:
    """Return a parser with the option ``--json``, which every command has."""
    parser = _Parser(
        prog=program,
        description=_sentence(line),
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
        exit_on_error=False,
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    return parser


def _sentence(line: str) -> str:
    return line[:1].upper() + line[1:] + "."


def _completion(words: Sequence[str]) -> str:
    """Return the script for the completion of this command in a shell."""
    try:
        import shtab
    except ModuleNotFoundError:
        from theory.parameters import MissingPackageError

        raise MissingPackageError("shtab", "completion", "shell completion") from None
    shells = ", ".join(shtab.SUPPORTED_SHELLS)
    if len(words) != 1 or words[0] not in shtab.SUPPORTED_SHELLS:
        raise UsageError(f"--print-completion takes one shell: choose one of {shells}.")
    script: str = shtab.complete(whole_parser(), shell=words[0])
    return script


def whole_parser() -> argparse.ArgumentParser:
    """Return one parser with all commands, models and options, for shell completion."""
    from fronts.bound import BoundCall, configure, models_of
    from fronts.options import options_of

    whole = argparse.ArgumentParser(prog="fronts", description="Excitation fronts.")
    commands = whole.add_subparsers()
    for name, command in COMMANDS.items():
        parser = commands.add_parser(name, help=command.line)
        if command.module:
            options_of(_own(command)[1]).declare(parser)
            continue
        if "" in command.calls:
            configure(parser, BoundCall(command.calls[""], ""))
            continue
        models = parser.add_subparsers()
        for model, call in models_of(command).items():
            configure(models.add_parser(model), BoundCall(call, model))
    return whole


def _announce_compilation() -> None:
    """Make a terminal show a message when a stepper is compiled on first use."""
    if sys.stderr is None or not sys.stderr.isatty():
        return
    import logging

    logger = logging.getLogger("verification.execution.compiled")
    if not logger.handlers:
        handler = logging.StreamHandler()
        handler.setFormatter(logging.Formatter("fronts: %(message)s"))
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)


def _complain(message: str, as_json: bool, details: dict[str, str]) -> None:
    if sys.stderr is None:  # closed: the exit code must suffice
        return
    if as_json:
        print(json.dumps({"error": {"message": message, **details}}), file=sys.stderr)
    else:
        print(f"fronts: {message}", file=sys.stderr)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Exit code 0: success. 1: success, but the answer needs attention. 2: the input cannot be used;
    one sentence says why. 3: a defect of the toolkit. 130: interrupted.

    Errors that are shown to the user are ``UsageError``, ``OSError`` for a file, errors with the
    attributes ``quantity``, ``value``, ``allowed`` and ``remedy``, ``PrecisionError``, ``RunError``
    and ``MissingPackageError``.
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
    except KeyboardInterrupt as interrupted:
        left = str(interrupted) or "nothing half-written is left behind"
        _complain(f"interrupted; {left}.", as_json, {})
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        message = _message_for_the_user(error)
        if message is None:
            return _defect(error, as_json)
        _complain(message, as_json, _details(error))
        return 2


def _message_for_the_user(error: Exception) -> str | None:
    """Return the message of an error that the user can correct; None for a defect."""
    if isinstance(error, MemoryError):
        return "memory ran out: ask for fewer sites, samples or points."
    if isinstance(error, UsageError) or hasattr(error, "remedy"):
        return str(error)
    if isinstance(error, OSError):
        # Errors of files only; those of the file system while writing are for the user to correct.
        if error.filename is None and error.errno not in _OF_A_FILE:
            return None
        where = "" if error.filename is None else f" {error.filename}"
        return f"the file{where} cannot be used: {error.strerror}."
    from theory.parameters import MissingPackageError, RunError
    from theory.piecewise.sums.result import PrecisionError

    if isinstance(error, PrecisionError | RunError | MissingPackageError):
        return str(error)
    return None


def _details(error: Exception) -> dict[str, str]:
    """Return quantity, value, allowed range and remedy of an error that has them."""
    if isinstance(error, UsageError):
        return error.details
    fields = ("quantity", "value", "allowed", "remedy")
    return {name: str(getattr(error, name)) for name in fields if hasattr(error, "remedy")}


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
