"""The calls behind the pictures of the explorer, which the page executes and shows as Python.

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
"""Number of sites of the simulated chain."""

AROUND = 4
"""Number of sites on each side of the nucleus of the breather.

It is smaller than elsewhere, since a periodic orbit then takes half the time. The relative change
of the last site, where the amplitude is 0.001, is 0.01, and the centre changes by 1e-9, which is
not visible in a picture.
"""

SLOW_TIME = 80.0
"""Duration of the simulation, in slow time εt."""

PICTURE = 1e-6
"""Tolerance of the simulation; the error of the amplitudes, 1e-5, is not visible in a picture."""

MODELS = {"averaged": "AveragedChain", "vdp": "VdpChain"}
"""Models of the simulated chain and of the breather; the kinetic relation is that of (44)."""

SLOW = ("curve", "states")
"""Calls that take longer than an update: one is made for each η, the other only once."""

REFUSALS = (fr.ParameterError, fr.RunError, fr.PrecisionError)
"""Errors that a function raises if there is nothing to show; the message is a sentence."""


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
    """A call of a public function that has not been executed yet.

    Attributes
    ----------
    function : str
        A public name of `fronts`.
    arguments : tuple
        Positional arguments; a `PendingCall` or a `Steps` object is executed first.
    options : tuple of (str, object)
        Keyword arguments.
    name : str
        Name of the variable for the result, if the call is an argument of another one.
    """

    function: str
    arguments: tuple[Any, ...] = ()
    options: tuple[tuple[str, Any], ...] = ()
    name: str = ""

    def run(self) -> Any:
        """Execute the call and return the result; errors of the function are passed on."""
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
    """The settings of the page's controls; they are checked by the functions, not here.

    Attributes
    ----------
    c : float
        Coupling, dimensionless.
    eta : float
        η = b/a², dimensionless.
    a, b : float or None
        Damping coefficients; by default 1 and η, since others only rescale the amplitude.
    eps : float
        Small parameter ε of (8), dimensionless.
    model : str
        One of the keys of `MODELS`.
    nucleus : int
        Number of sites excited in phase in the middle of the chain.
    """

    c: float = 0.5
    eta: float = 0.03125
    a: float | None = None
    b: float | None = None
    eps: float = 0.01
    model: str = "averaged"
    nucleus: int = 1


def calls(settings: Settings) -> dict[str, PendingCall]:
    """Return the calls behind the pictures, the fast ones first.

    Parameters
    ----------
    settings : Settings
        The settings of the controls.

    Returns
    -------
    dict of str to PendingCall
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
    """Return the call for the breather; for (8) it is a periodic orbit, where one may exist.

    Where no breather exists is known from the fold of its branch for (43), which takes a tenth of
    the time; the coupling of this fold differs from that for (8) by O(ε).
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
    """Return the result of a call, or the message with which it is refused."""
    try:
        return call.run()
    except REFUSALS as refusal:
        return str(refusal)


def script(settings: Settings) -> str:
    """Return a Python program that writes each picture to a file.

    A call that is refused is replaced by a comment with the message.

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
