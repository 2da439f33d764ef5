"""Fig. 15: the map of states over (η, c), by the full equation (8) or the averaged one (43).

The labels and their rules are in ``verification.maps.vdp_state``. Here each point is run twice, the
second time with the start perturbed on all sites by 1e-6 of the displacement: if the labels differ
the point is undecided.

The paper gives η but not (a, b) in Fig. 15, and its displacement of 6 is not scaled by a, so that
the map depends on them (y → y√a turns (a, b) into (1, η) and 6 into 6√a). Here one of the two is
held: by default b = 0.5, as in Figs. 7 to 13.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, count_within, positive, within
from verification.execution.table import Point, Scalar, Table, grid
from verification.maps.state import Label
from verification.maps.vdp_state import HOLD, label_state
from verification.runs.excite import add_noise, excite
from verification.runs.model import Model


@dataclass(frozen=True)
class StateTask:
    """The label at a point (η, c), for ``verification.execution.sweep``.

    Attributes
    ----------
    model : Model
        Equation.
    held : str
        Which of "a" and "b" is the same for all η; an ambiguity of Fig. 15.
    value : float
        Its value.
    sites : int
        Number of oscillators.
    eps : float
        ε.
    displacement : float
        y of the last site at time zero, where all velocities are zero.
    end : float
        End time, slow.
    tolerance : float
        See :func:`label_state`.
    perturbation : float
        Size of the perturbation of the second start relative to the displacement; 0 for none.
    seed : int
        Of the perturbation.

    Examples
    --------
    >>> StateTask(Model.ENVELOPE)(Point(eta=0.12, c=0.6))["label"]
    'fixed point'
    """

    model: Model = Model.FULL
    held: str = "b"
    value: float = 0.5
    sites: int = 16
    eps: float = 0.01
    displacement: float = 6.0
    end: float = 2000.0
    tolerance: float = 1e-8
    perturbation: float = 1e-6
    seed: int = 15

    def __post_init__(self) -> None:
        object.__setattr__(self, "model", Model(self.model))
        if self.held not in ("a", "b"):
            raise ParameterError("coefficient held", self.held, "a or b", "name one of them")
        positive(f"damping coefficient {self.held}", self.value)
        count_within("number of sites n", self.sites, 2, 1000)
        low, reason = (1e-4, "use the envelope below") if self.model is Model.FULL else (1e-9, None)
        within("small parameter eps", self.eps, low, 10.0, reason)
        within("displacement", self.displacement, 0.0, 100.0)
        within("end time", self.end, 4.0 * HOLD, 1e5)
        within("tolerance", self.tolerance, 1e-13, 1e-3)
        within("perturbation", self.perturbation, 0.0, 1e-2)

    def alone(self) -> StateTask:
        """Return the same task without the second, perturbed run, as bisection uses it."""
        return replace(self, perturbation=0.0)

    def averaged(self) -> StateTask:
        """Return the same task by the averaged equation."""
        return replace(self, model=Model.ENVELOPE)

    def chain(self, eta: float, c: float) -> VdpChain:
        """Return the chain at a point."""
        positive("eta = b/a^2", eta)
        a = self.value if self.held == "a" else math.sqrt(self.value / eta)
        b = self.value if self.held == "b" else eta * self.value**2
        return VdpChain(a=a, b=b, c=c, eps=self.eps, sites=self.sites)

    def __call__(self, point: Point) -> dict[str, Scalar]:
        """Return label, why it is undecided if it is, time, sites above the level, and steps."""
        chain = self.chain(point.number("eta"), point.number("c"))
        starts = [excite(chain, [self.sites], self.displacement)]
        if self.perturbation:
            size = self.perturbation * self.displacement
            starts.append(add_noise(starts[0], size, self.seed))
        states = [
            label_state(self.model.chain_of(chain), start, end=self.end, tolerance=self.tolerance)
            for start in starts
        ]
        first, labels = states[0], {state.label for state in states}
        if Label.UNDECIDED in labels:
            why = "end time"
        else:
            why = "decided" if len(labels) == 1 else "perturbation"
        return {
            "label": str(first.label if why == "decided" else Label.UNDECIDED),
            "why": why,
            "time": max(state.time for state in states),
            "above": first.above,
            "steps": sum(state.steps for state in states),
        }


def state_points(etas: Sequence[float], couplings: Sequence[float]) -> tuple[Point, ...]:
    """Return the points of a map, checked before any of them is run."""
    for eta in etas:
        within("eta = b/a^2", eta, 1e-6, 1e3)
    for c in couplings:
        within("coupling c", c, 0.0, 1e3)
    return grid(eta=[float(eta) for eta in etas], c=[float(c) for c in couplings])


@dataclass(frozen=True)
class Agreement:
    """Two maps of the same points, compared.

    Attributes
    ----------
    same : int
        Points that have the same label in both, undecided or not.
    total : int
        Points.
    differing : tuple of dict
        The others: coordinates and the two labels.
    contradicting : int
        Those of them where both maps have decided.
    """

    same: int
    total: int
    differing: tuple[dict[str, Scalar], ...]
    contradicting: int


def compare(first: Table, second: Table, axes: Sequence[str] = ("eta", "c")) -> Agreement:
    """Count the points to which two maps give the same label.

    Parameters
    ----------
    first, second : Table
        Maps of the same points.
    axes : sequence of str, optional
        Names of the coordinates.

    Raises
    ------
    ValueError
        If the maps are not over the same points.
    """
    if not all(np.array_equal(first[name], second[name]) for name in axes):
        raise ValueError("the two maps are not over the same points.")
    differing: list[dict[str, Scalar]] = [
        {**{name: one[name] for name in axes}, "first": one["label"], "second": two["label"]}
        for one, two in zip(first.rows(), second.rows(), strict=True)
        if one["label"] != two["label"]
    ]
    contradicting = sum(Label.UNDECIDED not in (row["first"], row["second"]) for row in differing)
    return Agreement(len(first) - len(differing), len(first), tuple(differing), contradicting)
