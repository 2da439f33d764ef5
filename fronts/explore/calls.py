"""The calls behind the explorer's pictures: carried out by the page, and shown as Python.

Examples
--------
>>> settings = Settings(c=0.5, eta=0.03125)
>>> print(calls(settings)["profile"])
fr.front_profile(c=0.5, eta=0.03125)
>>> round(calls(settings)["profile"].run().v, 6)
0.300992
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import fronts as fr

SITES = 41
"""Sites of the chain that is run."""

AROUND = 4
"""Sites on each side of the nucleus of the breather, fewer than elsewhere: the last one, where the
amplitude is a thousandth, changes by a hundredth of that and the centre by 1e-9, which no picture
shows, and a periodic orbit takes half the time."""

SLOW_TIME = 80.0
"""How long it is run, in slow time εt."""

PICTURE = 1e-6
"""Tolerance of the run: its amplitudes are off by 1e-5, which no picture shows."""

MODELS = {"averaged": "AveragedChain", "vdp": "VdpChain"}
"""Models of the chain that is run and of the breather; the kinetic relation is that of (44)."""

SLOW = ("curve", "states")
"""Calls that take longer than an update: once for each η, and once."""

REFUSALS = (fr.ParameterError, fr.RunError, fr.PrecisionError)
"""What a function raises where there is nothing to show; the message is a sentence."""


@dataclass(frozen=True)
class Steps:
    """The numbers step, 2 step, …, count step, written as Python.

    Examples
    --------
    >>> Steps(0.25, 2)
    [0.25 * n for n in range(1, 3)]
    >>> Steps(0.25, 2).run()
    [0.25, 0.5]
    """

    step: float
    count: int

    def run(self) -> list[float]:
        """Return the numbers."""
        return [self.step * n for n in range(1, self.count + 1)]

    def __repr__(self) -> str:
        return f"[{self.step!r} * n for n in range(1, {self.count + 1})]"


@dataclass(frozen=True)
class PendingCall:
    """A call of a public function, not yet carried out.

    Attributes
    ----------
    function : str
        A public name of `fronts`.
    arguments : tuple
        Arguments by position; a `PendingCall` or a `Steps` is carried out first.
    options : tuple of (str, object)
        Arguments by name.
    name : str
        The variable that holds the result where the call is an argument of another.
    """

    function: str
    arguments: tuple[Any, ...] = ()
    options: tuple[tuple[str, Any], ...] = ()
    name: str = ""

    def run(self) -> Any:
        """Return the result; it raises what the function raises."""
        function = getattr(fr, self.function)
        options = {name: _carried_out(each) for name, each in self.options}
        return function(*map(_carried_out, self.arguments), **options)

    def __str__(self) -> str:
        words = [*map(repr, self.arguments), *(f"{name}={each!r}" for name, each in self.options)]
        return f"fr.{self.function}({', '.join(words)})"

    def __repr__(self) -> str:
        return self.name or str(self)


def _carried_out(value: Any) -> Any:
    return value.run() if isinstance(value, (PendingCall, Steps)) else value


def _call(function: str, *arguments: Any, **options: Any) -> PendingCall:
    return PendingCall(function, arguments, tuple(options.items()))


@dataclass(frozen=True, kw_only=True)
class Settings:
    """What the controls of the page say; nothing is checked here, the functions do it.

    Attributes
    ----------
    c : float
        Coupling, dimensionless.
    eta : float
        η = b/a², dimensionless.
    a, b : float or None
        Damping coefficients; by default 1 and η, other ones only rescale the amplitude.
    eps : float
        Small parameter ε of (8), dimensionless.
    model : str
        One of `MODELS`.
    nucleus : int
        Number of sites that are excited, in phase, in the middle of the chain.
    """

    c: float = 0.5
    eta: float = 0.03125
    a: float | None = None
    b: float | None = None
    eps: float = 0.01
    model: str = "averaged"
    nucleus: int = 1


def calls(settings: Settings) -> dict[str, PendingCall]:
    """Return the calls behind the pictures, the quick ones first.

    Parameters
    ----------
    settings : Settings
        What the controls say.

    Returns
    -------
    dict of str to Call
        ``point``, ``profile``, ``run``, ``breather``, ``curve``, ``states``.
    """
    c, eta, size = settings.c, settings.eta, settings.nucleus
    chain = _chain(settings, SITES, "chain")
    first = (SITES - size) // 2 + 1
    return {
        "point": _call("kinetic_relation", c=c, eta=eta),
        "profile": _call("front_profile", c=c, eta=eta),
        "run": _call(
            "simulate",
            chain,
            _call("excite", chain, range(first, first + size)),
            t_end=SLOW_TIME / settings.eps if settings.eps else 0.0,
            samples=121,
            tolerance=PICTURE,
            estimate_error=False,
        ),
        "breather": _breather(settings),
        "curve": _call("kinetic_relation", c=Steps(0.025, 80), eta=eta),
        "states": _call(
            "state_map",
            PendingCall("AveragedChain", (), (("a", 4.0), ("b", 0.5), ("c", 0.6), ("sites", 16))),
            eta=Steps(0.01, 14),
            c=Steps(0.1, 20),
            refine=0.0,
            workers=1,
        ),
    }


def _breather(settings: Settings) -> PendingCall:
    """Return the call for the breather: of (8) a periodic orbit, where there may be one.

    That there is none is known from the fold of its branch, which takes (43) a tenth of the time;
    its coupling differs from that of (8) by O(ε).
    """
    size = settings.nucleus
    around = _chain(settings, size + 2 * AROUND, "around")
    nucleus = PendingCall("Nucleus", (size,))
    averaged = _call("breather", around, nucleus=nucleus, method="envelope")
    if settings.model != "vdp":
        return averaged
    fold = getattr(outcome(averaged), "fold", None)
    if fold is not None and settings.c > (1.1 + 5.0 * settings.eps) * fold:
        return averaged
    return _call("breather", around, nucleus=nucleus, method="orbit")


def _chain(settings: Settings, sites: int, name: str) -> PendingCall:
    a, b = (1.0, settings.eta) if settings.a is None else (settings.a, settings.b)
    options = {"a": a, "b": b, "c": settings.c, "eps": settings.eps, "sites": sites}
    return PendingCall(MODELS[settings.model], (), tuple(options.items()), name)


@lru_cache(maxsize=256)
def outcome(call: PendingCall) -> Any:
    """Return the result of a call, or the sentence with which it is refused."""
    try:
        return call.run()
    except REFUSALS as refusal:
        return str(refusal)


def script(settings: Settings) -> str:
    """Return a Python program that makes the pictures, each into a file.

    What is refused stands in it as a comment, with its sentence.

    Examples
    --------
    >>> print(script(Settings(c=0.5)).splitlines()[0])
    import fronts as fr
    """
    lines = ["import fronts as fr", ""]
    for name, call in calls(settings).items():
        found = None if name == "states" else outcome(call)
        if isinstance(found, str):
            lines.append(f"# {name}: {found}")
            continue
        named = (x for x in call.arguments if isinstance(x, PendingCall) and x.name)
        chains = [f"{each.name} = {each}" for each in named]
        lines += [*chains, f"{name} = {call}"]
        if name in ("point", "breather"):
            lines.append(f"print({name})")
        if name != "point":
            lines.append(f'{name}.plot().figure.savefig("{name}.png")')
    return "\n".join([*lines, ""])
