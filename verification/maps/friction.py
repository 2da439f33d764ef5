"""Fig. 5: the map of states of Model I over (c, v_d).

The labels and their rules are in ``verification.maps.friction_state``. As in
``verification.maps.vdp`` each point is run twice, the second time with the start perturbed on all
sites by 1e-6: if the labels differ the point is undecided.

Where one excited site goes to rest although fronts exist there, a wider nucleus shows it: that is
a failure to nucleate and not an absence of fronts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from theory.cells.friction import FrictionCell
from theory.chains.chain import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Place, nucleus_sites
from theory.parameters import count_within, within
from verification.execution.table import Point, Scalar, grid
from verification.maps.friction_state import WINDOW, label_friction
from verification.maps.state import Label
from verification.runs.excite import StartPoint, excite


@dataclass(frozen=True)
class FrictionStateTask:
    """The label at a point (c, v_d), for ``verification.execution.sweep``.

    Attributes
    ----------
    sites : int
        Number of oscillators.
    size : int
        Excited sites.
    place : Place
        At the edge or in the middle.
    point : StartPoint
        Point of the cycle from which they start.
    ends : Ends
        End condition.
    mu_st, mu_d, v0, xi : float
        Parameters of the cell; by default those of (7).
    end : float
        End time τ.
    tolerance : float
        See :func:`label_friction`.
    perturbation : float
        Size of the perturbation of the second start, in y and ẏ; 0 for none.
    seed : int
        Of the perturbation.

    Examples
    --------
    >>> FrictionStateTask(sites=7)(Point(c=0.05, v_d=1.25))["label"]
    'front'
    """

    sites: int = 31
    size: int = 1
    place: Place = Place.BULK
    point: StartPoint = StartPoint.MAXIMUM
    ends: Ends = Ends.FREE
    mu_st: float = 1.0
    mu_d: float = 0.5
    v0: float = 0.5
    xi: float = 0.05
    end: float = 20_000.0
    tolerance: float = 1e-8
    perturbation: float = 1e-6
    seed: int = 5

    def __post_init__(self) -> None:
        object.__setattr__(self, "place", Place(self.place))
        object.__setattr__(self, "ends", Ends(self.ends))
        object.__setattr__(self, "point", StartPoint(self.point))
        count_within("number of sites n", self.sites, 2, 1000)
        count_within("nucleus size", self.size, 1, self.sites, "give a nucleus that fits the chain")
        within("end time tau", self.end, 8.0 * WINDOW, 1e7)
        within("tolerance", self.tolerance, 1e-12, 1e-4)
        within("perturbation", self.perturbation, 0.0, 1e-2)
        self.chain(0.0, 1.0)

    def alone(self) -> FrictionStateTask:
        """Return the same task without the second, perturbed run, as bisection uses it."""
        return replace(self, perturbation=0.0)

    def chain(self, c: float, v_d: float) -> FrictionChain:
        """Return the chain at a point."""
        cell = FrictionCell(v_d=v_d, mu_st=self.mu_st, mu_d=self.mu_d, v0=self.v0, xi=self.xi)
        return FrictionChain.of(cell, c=c, sites=self.sites, ends=self.ends)

    def __call__(self, point: Point) -> dict[str, Scalar]:
        """Return label, why it is undecided if it is, time, active sites, and steps."""
        chain = self.chain(point.number("c"), point.number("v_d"))
        excited = nucleus_sites(self.sites, self.place, self.size)
        starts = [excite(chain, excited, point=self.point)]
        if self.perturbation:
            noise = np.random.default_rng(self.seed).standard_normal((2, self.sites))
            starts.append(starts[0] + self.perturbation * noise)
        states = [
            label_friction(chain, start, end=self.end, tolerance=self.tolerance) for start in starts
        ]
        first, labels = states[0], {state.label for state in states}
        why = next((state.why for state in states if state.why != "decided"), "decided")
        if len(labels) > 1:
            why = "perturbation"
        return {
            "label": str(first.label if why == "decided" else Label.UNDECIDED),
            "why": why,
            "time": max(state.time for state in states),
            "above": first.active,
            "reached": first.reached,
            "steps": sum(state.steps for state in states),
        }


def friction_points(couplings: Sequence[float], velocities: Sequence[float]) -> tuple[Point, ...]:
    """Return the points of a map, checked before any of them is run."""
    for c in couplings:
        within("coupling c", c, 0.0, 1e3)
    for v_d in velocities:
        within("belt velocity v_d", v_d, 1e-3, 1e3, "give a positive velocity")
    return grid(c=[float(c) for c in couplings], v_d=[float(v_d) for v_d in velocities])
