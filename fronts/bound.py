"""A command for a given model: the functions behind it, and their options.

Options have three sources, in this order: the fields of the chain, the parameters of the function
that prepares the initial state, and those of the function that computes the result. Prefixes
distinguish parameters of the same name.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.arguments import real, real_or_range
from fronts.catalogue import EVERY, Command, CommandCall, MapCall, MeasurementCall, RunCall
from fronts.options import Group, option
from fronts.output import add_output_options
from fronts.signatures import Described, described, of_kinds

if TYPE_CHECKING:
    from theory.chains.chain import Chain

_NUCLEUS = "theory.chains.nucleus:Nucleus"


@dataclass(frozen=True)
class BoundCall:
    """The call of a command for a given model, and the sources of its options."""

    call: CommandCall
    model: str

    @property
    def function(self) -> Callable[..., Any]:
        """The function that computes the result."""
        found: Callable[..., Any] = located(self.call.function)
        return found

    @property
    def filmed(self) -> bool:
        """Whether the result is a simulation, of which a film can be made."""
        return isinstance(self.call, RunCall)

    @property
    def chain(self) -> type[Chain] | None:
        """Class of the chain, or of the object that the function takes instead; None if neither."""
        if isinstance(self.call, MeasurementCall) and self.call.cell:
            found: type[Chain] = located(self.call.cell)
            return found
        return models()[self.model] if self.model else None

    @property
    def fixed(self) -> Mapping[str, Any]:
        """Fields of the chain that are not options."""
        return self.call.fixed if isinstance(self.call, MeasurementCall) else {}

    @property
    def axes(self) -> Mapping[str, tuple[float, float, int]]:
        """Default axes of a map."""
        return self.call.axes if isinstance(self.call, MapCall) else {}

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
            if each.name not in self.fixed
        )
        own = tuple(
            replace(each, allowed=located(self.call.ranges[each.name]))
            if each.name in self.call.ranges
            else each
            for each in own
        )
        return self._group("chain.", own, ranged=self._of_ranges)

    @property
    def _of_ranges(self) -> str:
        """What a field of the chain gives if it is a range; empty if it may not be one."""
        if isinstance(self.call, MapCall):
            return "an axis of the map"
        return "a curve" if isinstance(self.call, MeasurementCall) else ""

    @property
    def start(self) -> Group:
        """Options of the function that prepares the initial state."""
        own = described(located(self.call.start)) if isinstance(self.call, RunCall) else ()
        return self._group("start.", own)

    @property
    def nucleus(self) -> Group:
        """Options of a nucleus, if the function takes one."""
        takes = any(each.kind == "Nucleus" for each in described(self.function))
        return self._group("nucleus.", described(located(_NUCLEUS)) if takes else ())

    @property
    def own(self) -> Group:
        """Options of the function itself, with the words that apply to the model."""
        own = described(self.function)
        if self.call.kinds:
            own = tuple(replace(each, help=of_kinds(each.help, self.call.kinds)) for each in own)
        if self.call.choices:
            words = located(self.call.choices)(self.chain)
            own = tuple(
                replace(each, choices=words[each.name][0], help=words[each.name][1])
                if each.name in words
                else each
                for each in own
            )
        return self._group("", own)

    def _group(self, prefix: str, parameters: Sequence[Described], ranged: str = "") -> Group:
        hidden = self.call.hidden
        shown = tuple(each for each in parameters if prefix + each.name not in hidden)
        return Group(prefix, shown, {"nucleus.size": 1, **self.call.presets}, ranged)

    def required(self) -> str:
        """Return the required options as text for an example."""
        free = {*self.axes, *(("a", "b") if self.takes_eta else ())}
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
        """Whether η may be given in place of a and b of the chain; in a map, as one of its axes."""
        names = {each.name for each in self.fields.parameters}
        of_a_map = isinstance(self.call, MapCall) and "eta" not in self.axes
        return {"a", "b"} <= names and "eta" not in names and not of_a_map


def models() -> dict[str, type[Chain]]:
    """Return every registered chain by the name of its model."""
    from pkgutil import iter_modules

    import theory.chains
    from theory.chains.chain import CHAINS

    for module in iter_modules(theory.chains.__path__):
        import_module(f"theory.chains.{module.name}")
    return CHAINS


def models_of(command: Command) -> dict[str, CommandCall]:
    """Return the calls of a command by model, including those of further registered models.

    Models without a number of sites are excluded: they are infinite and cannot be simulated.
    """
    calls = {model: call for model, call in command.calls.items() if model != EVERY}
    if EVERY in command.calls:
        further = (model for model in models() if model not in calls)
        calls |= {model: command.calls[EVERY] for model in further if _has_sites(models()[model])}
    return calls


def _has_sites(chain: type[Chain]) -> bool:
    return "sites" in signature(chain).parameters


def located(where: str) -> Any:
    """Return the function, class or range that ``module:name`` denotes."""
    module, name = where.split(":")
    return getattr(import_module(module), name)


def configure(parser: argparse.ArgumentParser, bound: BoundCall) -> None:
    """Declare the options of a call, and those for output files.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser that receives the options.
    bound : BoundCall
        The command for a given model.
    """
    if bound.fields.parameters:
        names = {each.name for each in bound.fields.parameters}
        of_chain = not names.isdisjoint(("c", "sites", "ends"))
        group = parser.add_argument_group("the chain" if of_chain else "the cell")
        eta = bound.takes_eta
        defaults = {
            name: ":".join(f"{part:g}" for part in each) for name, each in bound.axes.items()
        }
        if isinstance(bound.call, MeasurementCall) and bound.call.sites:
            defaults["sites"] = "7 on each side of the nucleus"
        from_file = bound.takes_file
        optional = (*(("a", "b") if eta else ()), *bound.axes, *(names if from_file else ()))
        bound.fields.declare(group, optional, defaults)
        if from_file:
            group.add_argument("--model", dest="chain_file", type=Path, metavar="FILE",
                               default=argparse.SUPPRESS, help="a model file in TOML with these "
                               "options; options given in addition take precedence")  # fmt: skip
        if eta:
            words = "b/a^2, instead of a and b: the same chain, up to a scale, as a = 1 and b = eta"
            kind: Callable[[str], Any] = real
            if isinstance(bound.call, MapCall):
                kind, words = real_or_range, "b/a^2, or low:high:count (default 0.01:0.14:14)"
            elif isinstance(bound.call, MeasurementCall):
                kind, words = real_or_range, f"{words}; or low:high:count"
            group.add_argument("--eta", type=kind, default=argparse.SUPPRESS, help=words)
    if bound.start.parameters:
        bound.start.declare(parser.add_argument_group("the initial state"))
    if bound.nucleus.parameters:
        bound.nucleus.declare(parser.add_argument_group("the nucleus"))
    title = "the method" if bound.fields.parameters else "parameters and method"
    bound.own.declare(parser.add_argument_group(title))
    if isinstance(bound.call, MeasurementCall):
        parser.add_argument("--workers", "--jobs", dest="curve.workers", type=int,
                            default=argparse.SUPPRESS, metavar="N",
                            help="number of processes for a curve (default 1)")  # fmt: skip
    add_output_options(parser)
