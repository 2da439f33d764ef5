"""A command that is derived from the library: its parser, and carrying it out.

Options come from three places, in this order: the fields of the chain, those of a function that
makes the start, and the parameters of the function that answers. Where two of them have one name,
each is kept apart by a prefix.
"""

from __future__ import annotations

import argparse
import dataclasses
import shlex
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import check_seed, check_writable, real, real_or_range, same_file
from fronts.catalogue import EVERY, Call, Command
from fronts.options import Group, option
from fronts.signatures import REQUIRED, Described, described

if TYPE_CHECKING:
    from theory.chains.chain import Chain
    from theory.result import Result

Range = tuple[float, float, int]

MAX_LINES = 40
"""Lines of an answer that are shown beside a file that has it."""

_NUCLEUS = "theory.chains.nucleus:Nucleus"


@dataclass(frozen=True)
class Bound:
    """A call with the model that was named, and what its options are read from."""

    call: Call
    model: str

    @property
    def function(self) -> Callable[..., Any]:
        """What answers."""
        return located(self.call.function)

    @property
    def filmed(self) -> bool:
        """Whether it returns a run, of which there is a film."""
        return bool(self.function.__annotations__.get("return") == "Trajectory")

    @property
    def chain(self) -> type[Chain] | None:
        """Class of the chain, or of what the function takes in its place; None if nothing."""
        if isinstance(self.call.chain, str):
            return located(self.call.chain)  # type: ignore[return-value]
        return models()[self.model] if self.call.chain else None

    @property
    def fields(self) -> Group:
        """Options of the chain."""
        own = () if self.chain is None else described(self.chain)
        allowed = getattr(self.chain, "allowed_ends", ())
        own = tuple(
            replace(each, choices=tuple(str(end.value) for end in allowed))
            if each.name == "ends" and allowed
            else each
            for each in own
        )
        return self._group("chain.", own, ranged=self.call.ranged)

    @property
    def start(self) -> Group:
        """Options of the function that makes the start."""
        own = described(located(self.call.start)) if self.call.start else ()
        return self._group("start.", own)

    @property
    def nucleus(self) -> Group:
        """Options of a nucleus, if the function takes one."""
        takes = any(each.kind == "Nucleus" for each in described(self.function))
        return self._group("nucleus.", described(located(_NUCLEUS)) if takes else ())

    @property
    def own(self) -> Group:
        """Options of the function itself."""
        return self._group("", described(self.function))

    def _group(self, prefix: str, parameters: Sequence[Described], ranged: bool = False) -> Group:
        without = {*self.call.hidden, *(self.call.fixed if prefix == "chain." else ())}
        shown = [each for each in parameters if each.name not in without]
        return Group(prefix, tuple(shown), {"nucleus.size": 1, **self.call.presets}, ranged)

    def required(self) -> str:
        """Return the options that must be given, as they are written."""
        free = {"a", "b"} if self.takes_eta else {*(self.call.grid or ())}
        names = [
            option(each.name)
            for group in (self.fields, self.start, self.own)
            for each in group.parameters
            if group.is_required(each) and each.name not in free
        ]
        return " ".join(f"{name} {name.strip('-').upper()}" for name in names)

    @property
    def takes_file(self) -> bool:
        """Whether the chain can be read from a model file."""
        return hasattr(self.chain, "from_file")

    @property
    def takes_eta(self) -> bool:
        """Whether η may stand for a and b of the chain."""
        names = {each.name for each in self.fields.parameters}
        return {"a", "b"} <= names and "eta" not in names


def models() -> dict[str, type[Chain]]:
    """Return every registered chain by the name of its model."""
    from pkgutil import iter_modules

    import theory.chains
    from theory.chains.chain import CHAINS

    for module in iter_modules(theory.chains.__path__):
        import_module(f"theory.chains.{module.name}")
    return CHAINS


def models_of(command: Command) -> dict[str, Call]:
    """Return the calls of a command by model, those of further registered models included."""
    calls = {model: call for model, call in command.calls.items() if model != EVERY}
    if EVERY in command.calls:
        calls |= {model: command.calls[EVERY] for model in models() if model not in calls}
    return calls


def configure(parser: argparse.ArgumentParser, bound: Bound) -> None:
    """Declare the options of a call, and those of files.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Where.
    bound : Bound
        What.
    """
    if bound.fields.parameters:
        group = parser.add_argument_group("the chain")
        eta = bound.takes_eta
        said = {"sites": "7 on each side of the nucleus"} if bound.call.sites else {}
        grid = bound.call.grid or {}
        said |= {name: ":".join(f"{part:g}" for part in each) for name, each in grid.items()}
        from_file = bound.takes_file
        names = tuple(each.name for each in bound.fields.parameters) if from_file else ()
        bound.fields.declare(group, (*(("a", "b") if eta else ()), *grid, *names), said)
        if from_file:
            group.add_argument("--model", dest="chain_file", type=Path, metavar="FILE",
                               default=argparse.SUPPRESS, help="a model file in TOML with these "
                               "options; what is given beside it holds")  # fmt: skip
        if eta:
            words = "b/a^2, in place of a and b: a = 1 and b = eta are the same chain up to a scale"
            kind: Callable[[str], Any] = real
            if bound.call.grid is not None:
                kind, words = real_or_range, "b/a^2, or low:high:count (default 0.01:0.14:14)"
            group.add_argument("--eta", type=kind, default=argparse.SUPPRESS, help=words)
    if bound.start.parameters:
        bound.start.declare(parser.add_argument_group("the start"))
    if bound.nucleus.parameters:
        bound.nucleus.declare(parser.add_argument_group("the nucleus"))
    bound.own.declare(parser.add_argument_group("the method"))
    if bound.call.ranged and bound.call.grid is None:
        parser.add_argument("--workers", "--jobs", dest="curve.workers", type=int,
                            default=argparse.SUPPRESS, metavar="N",
                            help="processes for a curve (default 1)")  # fmt: skip
    add_output_options(parser)


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


def run(options: argparse.Namespace, bound: Bound, words: Sequence[str]) -> Answer:
    """Call the function that is behind a command, and write the files that are asked for.

    Parameters
    ----------
    options : argparse.Namespace
        The options that were given; others are absent.
    bound : Bound
        What to call.
    words : sequence of str
        The command line, for the files.

    Returns
    -------
    Answer
        The result as JSON and in words.
    """
    from fronts.interrupted import resumable_run
    from fronts.wording import in_words
    from verification.execution.progress import Progress

    checkpoint = getattr(options, "checkpoint", None)
    _check_files(getattr(options, "named", ()), checkpoint, bound.filmed)
    saved = nullcontext() if checkpoint is None else resumable_run(checkpoint)
    if options.out:
        from verification.execution.metadata import COMMAND_LINE

        COMMAND_LINE.set(_command(words))
    with saved, Progress(words[0], quiet=getattr(options, "json", False)) as live:
        result, parameters = _computed(options, bound, live.report)
    if options.out:
        _write(options.out, result, parameters, words)
    payload, text = result.to_dict(), in_words(result)
    if bound.call.also:
        payload |= located(bound.call.also)(result)
        text += in_words_also(payload)
    if options.out:
        lines = text.splitlines()
        if len(lines) > MAX_LINES:  # the file has them all
            text = "\n".join([*lines[:3], "…", *lines[-2:]])
        text += f"\nwritten to {' and '.join(str(path) for path in options.out)}"
    return Answer(payload, text, int(getattr(result, "needs_attention", False)))


def _write(
    out: Sequence[Path], result: Result, parameters: Mapping[str, Any], words: Sequence[str]
) -> None:
    from fronts.files import Provenance, write_result

    shown = Provenance(command=_command(words), parameters=parameters)
    for path in out:
        if path != parameters.get("out"):  # what can be resumed has been written
            write_result(path, result, shown)


def _check_files(out: Sequence[tuple[Path, str]], checkpoint: Path | None, filmed: bool) -> None:
    if out:
        from fronts.files import check_files

        check_files(out, filmed)
    if checkpoint is None:
        return
    check_writable(checkpoint, (".npz",), "--checkpoint")
    if any(same_file(path, checkpoint) for path, _ in out):
        raise UsageError(f"--out and --checkpoint are both {checkpoint}: name two files.")


def _computed(
    options: argparse.Namespace, bound: Bound, progress: Callable[[float], None]
) -> tuple[Result, dict[str, Any]]:
    """Return the result, and the parameters that it was computed with, defaults included."""
    function, arguments = bound.function, bound.own.given(options)
    parameters = {**bound.own.defaults(), **arguments}
    takes = {each.name for each in described(function)}
    nucleus = bound.nucleus.given(options)
    if any(hasattr(options, f"nucleus.{name}") for name in nucleus):
        arguments["nucleus"] = nucleus_of(nucleus)
        parameters["nucleus"] = arguments["nucleus"]
    _refuse_other_methods(bound, arguments, options)
    further = {"progress": progress} if "progress" in takes else {}
    if bound.chain is None:
        found: Result = function(**_arrays(arguments), **further)
        return found, parameters
    fields = _with_file(bound, {**bound.call.fixed, **bound.fields.given(options)}, options)
    if bound.call.grid is not None:
        chain, chosen = _grid(options, bound, fields)
        arguments |= chosen
        if "out" in takes:
            resumable = (each for each in options.out if each.suffix in {".csv", ".zarr"})
            arguments["out"] = next(resumable, None)
        parameters = {**chain.parameters(), **parameters, **arguments}
        return function(chain, **arguments, **further), parameters
    fields = _with_eta(bound, fields, options)
    if bound.call.sites and "sites" not in fields:
        fields["sites"] = located(bound.call.sites)(nucleus.get("size", 1))
    ranges = _ranges(fields)
    if ranges:
        (along,) = ranges
        curve = _curve(
            options, bound, fields=fields, along=along, arguments=arguments, progress=progress
        )
        return curve, {"model": bound.model, **fields, **parameters}
    made = bound.chain(**fields)
    parameters = {**_parameters_of(made), **parameters}
    if bound.call.start:
        started = bound.start.given(options)
        arguments["start"] = located(bound.call.start)(made, **started)
        parameters["start"] = {**bound.start.defaults(), **started}
    return function(made, **arguments, **further), parameters


def _with_file(bound: Bound, fields: dict[str, Any], options: argparse.Namespace) -> dict[str, Any]:
    """Return the fields with those in a model file; refuse a required one that is nowhere."""
    if not bound.takes_file:
        return fields
    if hasattr(options, "chain_file"):
        from theory.chains.model_file import read_model

        names = [each.name for each in dataclasses.fields(bound.chain)]  # type: ignore[arg-type]
        fields = read_model(options.chain_file, names, fields)
    for each in bound.fields.parameters:
        known = each.name in fields or each.name in (bound.call.grid or ())
        if bound.fields.is_required(each) and not known:
            raise UsageError(f"give {option(each.name)}, or a model file by --model.")
    return fields


def _grid(
    options: argparse.Namespace, bound: Bound, fields: dict[str, Any]
) -> tuple[Chain, dict[str, Any]]:
    """Return the chain of a map, and its axes: what is a range, or one by default."""
    assert bound.call.grid is not None
    assert bound.chain is not None
    chosen: dict[str, Any] = {}
    axes: dict[str, list[float]] = {}
    if "eta" in bound.call.grid:
        if {"a", "b"} <= {*fields}:
            raise UsageError("--b is not allowed with --a while eta varies: give one of them.")
        chosen["held"] = "a" if "a" in fields else "b"
        fields = {"a": 4.0, "b": 0.5, **fields}  # the one that is not held follows from eta
    for name, default in bound.call.grid.items():
        value: Any = (
            getattr(options, "eta", default) if name == "eta" else fields.get(name, default)
        )
        axes[name] = values_of(value) if is_range(value) else [value]
    for name, value in fields.items():
        if is_range(value) and name not in axes:
            axes[name] = values_of(value)
    if not axes:
        raise UsageError("a map needs a range, as in --c 0.1:1:10.")
    # The first values stand for the others, which are checked point by point.
    held = {name: values[0] for name, values in axes.items() if name != "eta"}
    chain = bound.chain(**{**fields, **held})
    return chain, {**chosen, "axes": axes}


def in_words_also(payload: Mapping[str, Any]) -> str:
    """Return what is said of further entries: how a nucleus ended."""
    nucleus = payload.get("nucleus")
    if nucleus is None:
        return ""
    stations = [f"{size} from {joined:.4g}" for joined, size in nucleus["sizes"]]
    listed = stations if len(stations) < 9 else [*stations[:6], "…", *stations[-2:]]
    joined = ", ".join(listed)
    return f"\n  nucleus: {nucleus['end']}; sites that had joined by slow time: {joined}"


def _curve(
    options: argparse.Namespace,
    bound: Bound,
    *,
    fields: Mapping[str, Any],
    along: str,
    arguments: Mapping[str, Any],
    progress: Callable[[float], None],
) -> Result:
    from fronts.curves import curve

    assert bound.chain is not None
    values = values_of(fields[along])
    # Both ends are checked before any work.
    first, last = (bound.chain(**{**fields, along: value}) for value in (values[0], values[-1]))
    between = [bound.chain(**{**fields, along: value}) for value in values[1:-1]]
    chains = [first, *between, last]
    if bound.call.curve:
        found: Result | None = located(bound.call.curve)(chains, along, values, **arguments)
        if found is not None:
            return found
    return curve(
        bound.function,
        chains,
        along,
        values,
        arguments,
        workers=getattr(options, "curve.workers", 1),
        progress=progress,
    )


def _refuse_other_methods(
    bound: Bound, arguments: Mapping[str, Any], options: argparse.Namespace
) -> None:
    """Refuse options of another ``--method`` than the one that was named."""
    chosen = arguments.get("method", bound.own.defaults().get("method"))
    for name, method in bound.call.only.items():
        if hasattr(options, name) and chosen not in (method, "all"):
            raise UsageError(
                f"{option(name)} is for --method {method}: leave it out.",
                quantity=option(name),
                value=getattr(options, name),
                allowed=f"absent without --method {method}",
                remedy="leave it out",
            )
    seed = arguments.get("seed")
    if isinstance(seed, int):
        check_seed(seed)


def _parameters_of(chain: Any) -> dict[str, Any]:
    own = getattr(chain, "parameters", None)
    return dict(own()) if own is not None else dict(vars(chain))


def _with_eta(bound: Bound, fields: dict[str, Any], options: argparse.Namespace) -> dict[str, Any]:
    """Return the fields with a and b from η, where that was given in their place."""
    if not bound.takes_eta:
        return fields
    eta = getattr(options, "eta", None)
    if eta is None:
        if not {"a", "b"} <= {*fields}:
            raise UsageError("give --eta, or both --a and --b.")
        return fields
    if {"a", "b"} & {name for name in fields if hasattr(options, f"chain.{name}")}:
        raise UsageError("--eta and --a, --b say the same thing twice: give one of them.")
    from theory.cells.vdp import checked_eta

    return {**fields, "a": 1.0, "b": checked_eta(eta)}


def nucleus_of(given: Mapping[str, Any]) -> Any:
    """Return the nucleus that the options describe: its sites in phase if there is no pattern."""
    from theory.chains.nucleus import Nucleus, Place

    size, place = given.get("size", 1), Place(given.get("place", Place.BULK))
    return Nucleus(size=size, pattern=given.get("pattern", "0" * max(size - 1, 0)), place=place)


def located(where: str) -> Callable[..., Any]:
    """Return what ``module:name`` names."""
    module, name = where.split(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found


def _command(words: Sequence[str]) -> str:
    return shlex.join(["fronts", *without_files(words)])


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
        elif word not in ("--json", "--resume"):
            left.append(word)
    return left


def _ranges(arguments: Mapping[str, Any]) -> list[str]:
    """Return the names of what was given as a range: one at most."""
    ranges = [name for name, value in arguments.items() if is_range(value)]
    if len(ranges) > 1:
        names = " or for ".join(option(name) for name in ranges)
        raise UsageError(f"give a range for {names}, not for both.")
    return ranges


def _arrays(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Turn a range into its values."""
    ranges = _ranges(arguments)
    return {
        name: values_of(value) if name in ranges else value for name, value in arguments.items()
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


__all__ = ["REQUIRED", "Bound", "configure", "models_of", "nucleus_of", "run"]
