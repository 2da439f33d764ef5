"""Execution of a command that is derived from the library: the call described by its options."""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import is_range, values_of
from fronts.bound import BoundCall, located
from fronts.catalogue import MapCall, MeasurementCall, RunCall
from fronts.options import option
from fronts.output import beside_files, check_output, command_line, write_output
from fronts.signatures import described

if TYPE_CHECKING:
    from theory.chains.chain import Chain
    from theory.result import Result


def run(options: argparse.Namespace, bound: BoundCall, words: Sequence[str]) -> Answer:
    """Call the function behind a command, and write the requested files.

    Parameters
    ----------
    options : argparse.Namespace
        The options that were given; others are absent.
    bound : BoundCall
        The command for the given model.
    words : sequence of str
        The command line, which is recorded in the files.

    Returns
    -------
    Answer
        The result as JSON and in words.
    """
    from fronts.interrupted import resumable_run
    from fronts.wording import in_words
    from verification.execution.progress import Progress

    check_output(options, bound.filmed)
    if options.out:
        from verification.execution.metadata import COMMAND_LINE

        COMMAND_LINE.set(command_line(words))
    saved = resumable_run(getattr(options, "checkpoint", None))
    with saved, Progress(words[0], quiet=options.json) as live:
        result, parameters = _computed(options, bound, live.report)
    payload = result.to_dict()
    if isinstance(bound.call, RunCall):
        payload |= located("fronts.nucleus_evolution:evolution_in_time")(result)
    if options.out:
        write_output(options.out, result, parameters, payload)
    text = in_words(result, payload)
    if options.out:
        text = beside_files(text, options.out)
    return Answer(payload, text, int(getattr(result, "needs_attention", False)))


def _computed(
    options: argparse.Namespace, bound: BoundCall, progress: Callable[[float], None]
) -> tuple[Result, dict[str, Any]]:
    """Return the result and the parameters of the computation, including defaults."""
    function, arguments = bound.function, bound.own.given(options)
    parameters = {**bound.own.defaults(), **arguments}
    takes = {each.name: each for each in described(function)}
    nucleus = bound.nucleus.given(options)
    named = any(hasattr(options, f"nucleus.{name}") for name in nucleus)
    if named or (nucleus and takes["nucleus"].default is not None):
        parameters["nucleus"] = arguments["nucleus"] = _nucleus(nucleus)
    further = {"progress": progress} if "progress" in takes else {}
    new_chain = bound.chain
    if new_chain is None:
        _check_picture(options, function)
        return function(**_arrays(arguments), **further), parameters
    match bound.call:
        case RunCall(start=start):
            chain = new_chain(**_with_eta(bound, _fields(bound, options), options))
            started = located(start)(chain, **bound.start.given(options))
            further["start"], parameters["start"] = started.state, started.parameters
        case MapCall():
            chain, chosen = _grid(options, bound, new_chain, _fields(bound, options))
            arguments |= chosen
            parameters |= arguments
        case MeasurementCall(only=only, sites=sites, curve=traced):
            _refuse_other_methods(only, parameters, options)
            fields = _with_eta(bound, _fields(bound, options), options)
            if sites and "sites" not in fields:
                fields["sites"] = located(sites)(nucleus["size"])
            along = _range_of(fields)
            if along is not None:
                workers = getattr(options, "curve.workers", 1)
                found, shared = _curve(
                    bound, fields, along, traced=traced, given=arguments, workers=workers,
                    progress=progress,
                )  # fmt: skip
                return found, {"model": bound.model, **shared, **parameters}
            chain = new_chain(**fields)
    _check_picture(options, function)
    return function(chain, **arguments, **further), {**_parameters_of(chain), **parameters}


def _curve(
    bound: BoundCall,
    fields: Mapping[str, Any],
    along: str,
    *,
    traced: str,
    given: dict[str, Any],
    workers: int,
    progress: Callable[[float], None],
) -> tuple[Result, dict[str, Any]]:
    """Return the results along a range of one field, and the parameters of the chains.

    A branch, where the command can follow one, reads one chain, and both ends are checked first.
    """
    values = values_of(fields[along])
    ends = _along(bound, fields, along, [values[0], values[-1]])
    found: Result | None = None
    if traced:
        found = located(traced)(ends, along, values, progress=progress, **given)
    if found is None:
        from fronts.curves import curve

        chains = [ends[0], *_along(bound, fields, along, values[1:-1]), ends[1]]
        found = curve(
            bound.function, chains, along, values, given, workers=workers, progress=progress
        )
    varied = _varied(bound, along)
    own = _parameters_of(ends[0]).items()
    shared = {name: value for name, value in own if name != varied}
    return found, {**shared, along: fields[along]}


def _check_picture(options: argparse.Namespace, function: Callable[..., Any]) -> None:
    if options.out:
        from fronts.files import check_pictured

        check_pictured(options.out, function)


def _fields(bound: BoundCall, options: argparse.Namespace) -> dict[str, Any]:
    """Return the fields, including those of a model file; refuse if a required one is missing."""
    fields = {**bound.fixed, **bound.fields.given(options)}
    if not bound.takes_file:
        return fields
    if hasattr(options, "chain_file"):
        from theory.chains.model_file import read_model

        names = [each.name for each in dataclasses.fields(bound.chain)]  # type: ignore[arg-type]
        fields = read_model(options.chain_file, names, fields)
    for each in bound.fields.parameters:
        if bound.fields.is_required(each) and each.name not in fields:
            raise UsageError(f"give {option(each.name)}, or a model file by --model.")
    return fields


def _grid(
    options: argparse.Namespace,
    bound: BoundCall,
    new_chain: type[Chain],
    fields: dict[str, Any],
) -> tuple[Chain, dict[str, Any]]:
    """Return the chain of a map, its axes, and its table."""
    given = {**fields, "eta": options.eta} if hasattr(options, "eta") else fields
    axes = _axes(bound, given)
    chosen: dict[str, Any] = {}
    if "eta" in bound.axes:
        if "eta" in axes:
            if {"a", "b"} <= {*fields}:
                raise UsageError("--b is not allowed with --a while eta varies: give one of them.")
            chosen["held"] = "a" if "a" in fields else "b"
        fields = {"a": 4.0, "b": 0.5, **fields}  # the one that is not held follows from eta
    # The chain has the first values; the others are checked point by point.
    held = {name: values[0] for name, values in axes.items() if name != "eta"}
    chain = new_chain(**{**fields, **held})
    if getattr(options, "amplitudes", False) and not any(
        each.suffix in {".npz", ".zarr"} for each in options.out
    ):
        raise UsageError(
            "--amplitudes needs a file that keeps arrays: add --out map.zarr or --out map.npz."
        )
    # A CSV file comes first: if it cannot store the amplitudes, the map refuses it at once.
    resumable = [each for end in (".csv", ".zarr") for each in options.out if each.suffix == end]
    return chain, {**chosen, "axes": axes, "out": resumable[0] if resumable else None}


def _axes(bound: BoundCall, given: Mapping[str, Any]) -> dict[str, list[float]]:
    """Return the axes of a map with their values: the default axes in their order, then others.

    A map is a plane unless more ranges are given. A default axis takes the range or number that is
    given for it, or else its default range as long as fewer than two parameters are ranges.
    """
    ranges = [name for name, value in given.items() if is_range(value)]
    free = 2 - len(ranges)
    required = {each.name for each in bound.fields.parameters if bound.fields.is_required(each)}
    chosen: dict[str, Any] = {}
    for name, default in bound.axes.items():
        if name in given:
            chosen[name] = given[name]
        elif free > 0:
            chosen[name], free = default, free - 1
        elif name in required:
            named = " and ".join(map(option, ranges))
            raise UsageError(f"give {option(name)} too: {named} are the axes of the map.")
    chosen |= {name: given[name] for name in ranges}
    if not chosen:
        raise UsageError("a map needs a range, as in --c 0.1:1:10.")
    return {name: values_of(each) if is_range(each) else [each] for name, each in chosen.items()}


def _along(
    bound: BoundCall, fields: Mapping[str, Any], along: str, values: Sequence[float]
) -> list[Chain]:
    """Return the chains along one parameter."""
    name = _varied(bound, along)
    fixed = {each: value for each, value in fields.items() if each != along}
    return [bound.chain(**fixed, **{name: value}) for value in values]  # type: ignore[misc]


def _varied(bound: BoundCall, along: str) -> str:
    """Return the field in which the chains along a parameter differ, which is b for η."""
    return "b" if along == "eta" and bound.takes_eta else along


def _refuse_other_methods(
    only: Mapping[str, tuple[str, ...]],
    parameters: Mapping[str, Any],
    options: argparse.Namespace,
) -> None:
    """Refuse options that belong to a ``--method`` other than the chosen one."""
    chosen = parameters.get("method")
    for name, methods in only.items():
        if hasattr(options, name) and chosen not in (*methods, "all"):
            method = " or ".join(methods)
            raise UsageError(
                f"{option(name)} is for --method {method}: leave it out.",
                quantity=option(name),
                value=getattr(options, name),
                allowed=f"absent without --method {method}",
                remedy="leave it out",
            )


def _parameters_of(chain: Any) -> dict[str, Any]:
    """Return the parameters of a chain, or the fields of a cell."""
    own = getattr(chain, "parameters", None)
    return dict(own()) if own is not None else dataclasses.asdict(chain)


def _with_eta(
    bound: BoundCall, fields: dict[str, Any], options: argparse.Namespace
) -> dict[str, Any]:
    """Return the fields, with a and b computed from η if η was given in their place.

    A range of η remains a field of this name, with a = 1.
    """
    if not bound.takes_eta:
        return fields
    eta = getattr(options, "eta", None)
    if eta is None:
        if not {"a", "b"} <= {*fields}:
            raise UsageError("give --eta, or both --a and --b.")
        return fields
    if {"a", "b"} & {name for name in fields if hasattr(options, f"chain.{name}")}:
        raise UsageError(
            "--eta determines the same ratio as --a and --b: give either --eta or --a and --b."
        )
    from theory.cells.vdp import DAMPING, SMALLEST_ETA, checked_eta
    from theory.parameters import within

    if is_range(eta):
        checked_eta(eta[0])
        return {
            **{name: each for name, each in fields.items() if name != "b"},
            "a": 1.0,
            "eta": eta,
        }
    # b, which is refused by its own name, is not what was given.
    checked_eta(eta)
    number = within("eta = b/a^2", eta, SMALLEST_ETA, DAMPING.high, "give a value below 1/8")
    return {**fields, "a": 1.0, "b": number}


def _nucleus(given: Mapping[str, Any]) -> Any:
    from theory.chains.nucleus import Nucleus

    return Nucleus(**given)


def _range_of(arguments: Mapping[str, Any]) -> str | None:
    """Return the name of the parameter that was given as a range, if any; refuse several."""
    ranges = [name for name, value in arguments.items() if is_range(value)]
    if len(ranges) > 1:
        names = " or for ".join(option(name) for name in ranges)
        raise UsageError(f"give a range for {names}, not for both.")
    return ranges[0] if ranges else None


def _arrays(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments with a range replaced by its values."""
    along = _range_of(arguments)
    return {name: values_of(value) if name == along else value for name, value in arguments.items()}
