"""One point of a map of states: the runs from which its state is determined.

The rules by which a state is determined are in ``vdp_rules``, ``friction_rules`` and
``smooth_rules``. At each point there are two runs, the second with the start perturbed at all sites
by 1e-6; if the states differ, the point is undecided.

For Fig. 15 the paper gives η but not (a, b), and its displacement of 6 is not scaled by a, so that
the map depends on both (y → y√a turns (a, b) into (1, η) and 6 into 6√a). Along an axis η one of
the two coefficients is therefore kept constant, namely ``held``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from theory.chains.chain import Chain
from theory.chains.nucleus import Nucleus
from theory.chains.own import OwnChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, random_seed, real_array, truth, within, word
from verification.execution.columns import Cell, Scalar
from verification.execution.points import Grid, Point
from verification.maps.rules import rules_of
from verification.maps.state import Reason, State
from verification.runs.excite import StartPoint

HELD = ("a", "b")


@dataclass(frozen=True, kw_only=True)
class StateTask:
    """The state at one point of a map: a task for ``verification.execution.sweep``.

    Attributes
    ----------
    chain : Chain
        The parameters that a point does not specify; its values for the axes are not used.
    held : str
        Which of "a" and "b" is kept constant for all η, if η is an axis.
    nucleus : Nucleus or None
        Excited sites; None for those of the paper's figure: the last site of (8) and (43), the
        middle one of any other chain.
    displacement : float or None
        Displacement of the excited sites at time zero; None for 6 in (8) and (43), for the point of
        the cycle in (5), for the excited state in any other chain.
    point : StartPoint
        Point on the cycle of (5) from which the excited sites start.
    end : float or None
        End time, in the unit of `FoundState.time`; states found in its second half are not
        accepted.
    tolerance : float or None
        Local error of the runs; None for the value given by the rules.
    perturbation : float
        Size of the perturbation of the second start, relative to the displacement; 0 for none.
    seed : int or None
        Seed of the perturbation; None for the value given by the rules.
    amplitudes : bool
        Whether the amplitude of every site at the end is part of the result, as an array.

    Raises
    ------
    ParameterError
        If a value is out of range, or there are no rules for the chain.

    Examples
    --------
    >>> from theory.chains.friction import FrictionChain
    >>> from theory.chains.vdp import AveragedChain
    >>> StateTask(chain=AveragedChain(a=4, b=0.5, c=0, sites=16))(Point(eta=0.12, c=0.6))["label"]
    'fixed point'
    >>> StateTask(chain=FrictionChain(c=0, sites=7))(Point(c=0.05, v_d=1.25))["label"]
    'front'
    """

    chain: Chain
    held: str = "b"
    nucleus: Nucleus | None = None
    displacement: float | None = None
    point: StartPoint = StartPoint.MAXIMUM
    end: float | None = None
    tolerance: float | None = None
    perturbation: float = 1e-6
    seed: int | None = None
    amplitudes: bool = False

    def __post_init__(self) -> None:
        rules = rules_of(self.chain)
        rules.check(self.chain)
        truth("amplitudes", self.amplitudes)
        if self.held not in HELD:
            raise ParameterError("coefficient held", self.held, "a or b", "name one of them")
        within("end time", self.end_time, *rules.ends)
        within("tolerance", self.local_error, *rules.tolerances)
        within("perturbation", self.perturbation, 0.0, 1e-2)
        if self.seed is not None:
            random_seed(self.seed)
        if self.displacement is not None:
            within("displacement", self.displacement, 0.0, 100.0)
        self.excited(self.chain)

    @property
    def end_time(self) -> float:
        """End time, as given or from the rules."""
        return rules_of(self.chain).default_end if self.end is None else self.end

    @property
    def local_error(self) -> float:
        """Local error of the runs, as given or from the rules."""
        return rules_of(self.chain).tolerance if self.tolerance is None else self.tolerance

    def excited(self, chain: Chain) -> tuple[int, ...] | None:
        """Return the excited sites of a chain, counted from 1; None for those of the rules."""
        sites: int = chain.sites  # type: ignore[attr-defined]
        return None if self.nucleus is None else self.nucleus.excited(sites)

    def alone(self) -> StateTask:
        """Return the same task with a single run for the state only, as used by bisection."""
        return replace(self, perturbation=0.0, amplitudes=False)

    def average(self) -> StateTask | None:
        """Return the task for the averaged chain, without the perturbed run, if there is one."""
        if not isinstance(self.chain, VdpChain):
            return None
        return replace(self.alone(), chain=self.chain.averaged())

    def at(self, point: Mapping[str, Scalar]) -> Any:
        """Return the chain at a point, of the same class as ``chain``.

        Raises
        ------
        ParameterError
            If an axis is not a parameter of the chain, or its value is out of range.
        """
        known = axes_of(self.chain)
        for name in point:
            word("axis", name, known, "name a parameter that is a number")
        changes = {name: float(value) for name, value in point.items() if name != "eta"}
        chain = self.chain.replace(**changes)
        if "eta" not in point:
            return chain
        eta = within("eta = b/a^2", point["eta"], 1e-6, 1e3)
        if self.held == "a":
            return chain.replace(b=eta * chain.a**2)  # type: ignore[attr-defined]
        return chain.replace(a=math.sqrt(chain.b / eta))  # type: ignore[attr-defined]

    def __call__(self, point: Point) -> dict[str, Cell]:
        """Return state, reason, time, active and reached sites, steps, requested amplitudes."""
        chain, rules = self.at(point), rules_of(self.chain)
        options = {"displacement": self.displacement, "point": self.point}
        run_options = {"end": self.end_time, "tolerance": self.local_error}
        starts = [rules.start(chain, self.excited(chain), **options)]
        if self.perturbation:
            seed = rules.seed if self.seed is None else self.seed
            starts.append(rules.perturbed(starts[0], self.perturbation, seed))
        found = [rules.find(chain, start, **run_options) for start in starts]
        states = {each.state for each in found}
        reason = next((r.reason for r in found if r.reason is not Reason.DECIDED), Reason.DECIDED)
        if len(states) > 1:
            reason = Reason.PERTURBATION
        decided = reason is Reason.DECIDED
        row: dict[str, Cell] = {
            "label": str(found[0].state if decided else State.UNDECIDED),
            "why": str(reason),
            "time": max(each.time for each in found),
            "above": found[0].above,
        }
        if found[0].reached is not None:
            row["reached"] = found[0].reached
        row["steps"] = sum(each.steps for each in found)
        if self.amplitudes:
            # These belong to the first start; the perturbed one may have been decided at another
            # time.
            row["amplitude"], row["amplitude_time"] = found[0].amplitude, found[0].time
        return row


def axes_of(chain: Chain) -> list[str]:
    """Return the parameters of a chain that may be axes of a map: those that are numbers.

    Examples
    --------
    >>> axes_of(VdpChain(a=4, b=0.5, c=0))
    ['a', 'b', 'c', 'eps', 'sites', 'eta']
    """
    found = _fields_of(chain, "float", "int")
    if isinstance(chain, OwnChain):
        return [*found, *chain.names, "damping"]  # which may be a number
    return [*found, "eta"] if {"a", "b"} <= {*found} else found


def whole_axes(chain: Chain) -> list[str]:
    """Return the parameters of a chain that are whole numbers, between which there is no point.

    Examples
    --------
    >>> whole_axes(VdpChain(a=4, b=0.5, c=0))
    ['sites']
    """
    return _fields_of(chain, "int")


def _fields_of(chain: Chain, *kinds: str) -> list[str]:
    return [each.name for each in fields(chain) if each.type in kinds]  # type: ignore[arg-type]


def state_points(task: StateTask, axes: Mapping[str, Sequence[float]]) -> Grid:
    """Return the points of a map, the first axis varying slowest, all checked before any run.

    Raises
    ------
    ParameterError
        If a value is out of range.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> task = StateTask(chain=VdpChain(a=4, b=0.5, c=0, sites=16))
    >>> state_points(task, {"eta": [0.1], "c": [0.2, 0.3]})[1]
    Point(eta=0.1, c=0.3)
    """
    values = {name: real_array(name, each).ravel().tolist() for name, each in axes.items()}
    for name, each in values.items():
        if not each:
            raise ParameterError(name, "[]", "one number or more", "give at least one")
    points = Grid(values)
    rules = rules_of(task.chain)
    for point in points:
        chain = task.at(point)
        rules.check(chain)
        task.excited(chain)
    return points
