"""Direct simulation of the piecewise-linear front (Eq. 44), and the classification of its motion.

The chain is advanced exactly from switching to switching (``chain``), so that the period of the
front is known to within round-off. The travelling-wave theory (48)-(54) is not used, except that a
moving start may take its initial shape from a wave.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from theory.cells.vdp import threshold_ratio
from theory.parameters import ParameterError, Range, at_least, count_within, positive, within
from verification.piecewise.chain import PiecewiseMotion
from verification.piecewise.run import FrontRun
from verification.piecewise.verdict import BLOCK, History
from verification.piecewise.window import (
    ChainState,
    starting_velocity,
    static_state,
    step_state,
    travelling_state,
    window_length,
)

SMALLEST_ETA = 1e-8
"""Smallest η: below it the threshold is so low that round-off in phi affects the front."""
SMALLEST_COUPLING = 1e-300
"""Smallest c: below it the decay of a tail from one site to the next is not a finite number."""


ACCURACIES, ACCURACY = Range(1e-13, 1e-2), 1e-12
"""Range and default of the relative spread of the period at which the motion counts as steady."""
MAX_SITES_RANGE, MAX_SITES = Range(4 * BLOCK, 1_000_000), 1000
"""Range and default of the number of sites after which a front that has not settled is given up."""


class Start(StrEnum):
    """The initial state of a run."""

    RESTING = "resting"
    MOVING = "moving"
    STEP = "step"


@dataclass(frozen=True)
class Hysteresis:
    """Runs at descending couplings: one series follows a moving front, the other starts from rest.

    Attributes
    ----------
    couplings : tuple of float
        Descending.
    moving, resting : tuple of FrontRun
        One run per coupling; each moving run continues from the preceding one.
    """

    couplings: tuple[float, ...]
    moving: tuple[FrontRun, ...]
    resting: tuple[FrontRun, ...]


def simulate_front(
    coupling: float,
    eta: float,
    start: Start | str | ChainState = Start.MOVING,
    *,
    start_velocity: float | None = None,
    accuracy: float = ACCURACY,
    max_sites: int = MAX_SITES,
) -> FrontRun:
    """Run the chain (44) until its front is steady, pinned, or clearly neither.

    Parameters
    ----------
    coupling : float
        c > 0.
    eta : float
        ``b/a^2`` between 0 and 1/8.
    start : Start, str or ChainState
        As in `verification.fronts.switchings.front_by_switchings`, or a state from which the run
        continues.
    start_velocity, accuracy, max_sites
        As ``start_v``, ``accuracy`` and ``max_sites`` there.

    Returns
    -------
    FrontRun

    Raises
    ------
    ParameterError
        If a quantity is outside its range.

    Examples
    --------
    >>> run = simulate_front(0.5, 0.03125)
    >>> run.status.value, round(run.v, 10)
    ('steady', 0.3009923508)
    >>> simulate_front(0.3, 0.03125, "resting").status.value
    'pinned'
    """
    c, r = _coupling(coupling), _threshold(eta)
    within("accuracy", accuracy, *ACCURACIES)
    max_sites = count_within("most sites passed, max_sites,", max_sites, *MAX_SITES_RANGE)
    began = time.perf_counter()
    state = _start_state(c, r, start, start_velocity)
    history = History(PiecewiseMotion(c, r, state), c)
    while True:
        outcome = history.extend(BLOCK)
        if outcome is not None or history.decided(accuracy, max_sites):
            break
    return history.verdict(outcome, accuracy, began)


def hysteresis(eta: float, couplings: Sequence[float]) -> Hysteresis:
    """Lower the coupling of a moving front step by step, and compare with starts from rest.

    Between the fold and ``c_pin`` a moving and a pinned front coexist, and the start decides.

    Raises
    ------
    ParameterError
        If a quantity is outside its range.

    Examples
    --------
    >>> runs = hysteresis(0.03125, [0.5, 0.3])
    >>> [run.status.value for run in runs.moving]
    ['steady', 'pinned']
    """
    descending = tuple(sorted(map(_coupling, couplings), reverse=True))
    moving: list[FrontRun] = []
    for c in descending:
        start = moving[-1].final if moving else Start.MOVING
        moving.append(simulate_front(c, eta, start))
    resting = tuple(simulate_front(c, eta, Start.RESTING) for c in descending)
    return Hysteresis(descending, tuple(moving), resting)


def _coupling(coupling: float) -> float:
    remedy = "take a larger one, at which the sites are independent of each other as well"
    return at_least("coupling c of a simulation", coupling, SMALLEST_COUPLING, remedy)


def _threshold(eta: float) -> float:
    remedy = "take b/a^2 below 1/8, where the unit cell is bistable"
    if positive("eta = b/a^2", eta, remedy) >= 0.125:
        raise ParameterError("eta = b/a^2", eta, "below 1/8", remedy)
    remedy = "use the kinetic relation"
    return threshold_ratio(at_least("eta = b/a^2 of a simulation", eta, SMALLEST_ETA, remedy))


def _start_state(
    c: float, r: float, start: Start | str | ChainState, velocity: float | None
) -> ChainState:
    if isinstance(start, ChainState):
        if len(start.phi) < 32 or not np.all(np.isfinite(start.phi)):
            raise ParameterError(
                "start", f"{len(start.phi)} sites", "finite and at least 32 sites long",
                "pad it with ones behind and zeros ahead",
            )  # fmt: skip
        worst = max(abs(start.phi[0] - 1), abs(start.phi[-1]))
        if worst > 1e-3:
            raise ParameterError(
                "start", f"with an end {worst:.2g} off", "1 at the left end and 0 at the right",
                "pad it with ones behind and zeros ahead",
            )  # fmt: skip
        return start
    try:
        kind = Start(start)
    except ValueError:
        raise ParameterError("start", start, "moving, resting or step", "choose one") from None
    if kind is not Start.MOVING:
        if velocity is not None:
            raise ParameterError(
                "start velocity", velocity, "not given unless the start is moving",
                "leave it out or start moving",
            )  # fmt: skip
        sites = window_length(c, 1.2 * c / (1 + 0.15 * c), 1e-15 * r)
        return step_state(sites) if kind is Start.STEP else static_state(c, sites)
    if velocity is None:
        velocity = starting_velocity(c, r)
    elif not math.isfinite(velocity) or not 1e-4 * c <= abs(velocity) <= 1e3 * (1 + c):
        raise ParameterError(
            "start velocity", velocity, "between c/10000 and 1000 (1 + c) in size",
            "give a velocity near a branch of the kinetic relation",
        )  # fmt: skip
    return travelling_state(c, velocity, window_length(c, velocity, 1e-15 * r))
