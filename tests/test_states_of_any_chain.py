"""A chain that the toolkit has never seen: its thresholds and its map, against scipy.

The toy is the discrete Nagumo equation,

    ẏ_n = y_n (1 - y_n)(y_n - α) + c (y_{n-1} + y_{n+1} - 2y_n):

one number a site, no oscillation, fronts that are pinned at small coupling.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from theory.chains.chain import CHAINS, Ends, Kernel, SmoothChain, parameter
from theory.chains.nucleus import Nucleus, Place
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.maps.smooth_rules import find_smooth_state
from verification.maps.state import Reason, State
from verification.maps.state_map import StateTask, state_map
from verification.runs.excite import excite
from verification.thresholds.result import Definition, Mechanism, RunThreshold
from verification.thresholds.spreading import Spreading, spreads
from verification.thresholds.threshold import threshold

SITES, END = 9, 400.0


def nagumo(site: Any, left: Any, right: Any, p: Any) -> Any:
    """Return (ẏ, 0) of a site."""
    y, w = site
    return y * (1.0 - y) * (y - p[0]) + p[1] * ((left[0] + right[0]) - 2.0 * y), 0.0 * w


@pytest.fixture(scope="module")
def toy() -> Iterator[Any]:
    """A chain class defined here, and taken out of the register afterwards."""

    @dataclass(frozen=True, kw_only=True)
    class Nagumo(SmoothChain, model="nagumo"):
        alpha: float = parameter("threshold of a site", "α", 0.3)
        c: float = parameter("coupling", "c")
        sites: int = parameter("number of sites", "N", SITES)
        ends: Ends = parameter("ends", "ends", Ends.FREE)

        def __post_init__(self) -> None:
            self._check_number("alpha", "threshold alpha", 1e-6, 1.0)
            self._check_number("c", "coupling c", 0.0, 1e3)
            self._check_count("sites", "number of sites n", 2, 1000)
            self._check_ends()

        @property
        def stable_amplitude(self) -> float:
            return 1.0

        @property
        def unstable_amplitude(self) -> float:
            return self.alpha

        def kernel(self) -> Kernel:
            return nagumo

        def kernel_parameters(self) -> tuple[float, ...]:
            return self.alpha, self.c

    yield Nagumo
    del CHAINS["nagumo"]


def by_scipy(alpha: float, c: float, excited: list[int], end: float = END) -> np.ndarray:
    """y at 201 times, written anew."""

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        around = np.concatenate([y[:1], y, y[-1:]])
        return y * (1 - y) * (y - alpha) + c * np.diff(around, 2)

    start = np.zeros(SITES)
    start[[n - 1 for n in excited]] = 1.0
    times = np.linspace(0.0, end, 201)
    return solve_ivp(rate, (0, end), start, "LSODA", times, rtol=1e-10, atol=1e-12).y.T


def test_the_threshold_of_a_toy_is_that_of_scipy(toy: Any) -> None:
    """Five sites in the middle spread from the coupling on at which a sixth passes α."""
    found = threshold(
        toy(c=0.0), Nucleus(5, "0000"), final_time=END, lowest=1e-3, accuracy=1e-5, tests=0
    )
    assert (found.definition, found.mechanism) == (Definition.FIRST, Mechanism.SPREADING)
    assert found.high - found.low <= 1e-5
    for c, spread in ((found.low, False), (found.high, True)):
        outside = by_scipy(0.3, c, [3, 4, 5, 6, 7])[:, 1]
        assert bool(outside.max() > 0.3) is spread


@pytest.mark.parametrize("c", [0.01, 0.03, 0.1, 0.4])
@pytest.mark.parametrize("definition", ["first", "several", "whole"])
def test_spreading_counts_what_its_definition_says(toy: Any, c: float, definition: str) -> None:
    spreading = Spreading(3, Place.BULK, Definition(definition), final_time=END, tolerance=1e-8)
    y = by_scipy(0.3, c, [4, 5, 6])
    reached = set((np.flatnonzero((y > 0.3).any(axis=0)) + 1).tolist()) - {4, 5, 6}
    needed = set(spreading.watched(SITES))
    expected = bool(needed & reached) if definition == "first" else needed <= reached
    assert spreads(toy(c=c), spreading) is expected


@pytest.mark.parametrize(
    ("c", "excited", "state"),
    [
        (0.005, [4, 5, 6], State.BREATHER),
        (0.08, [4, 5, 6], State.FRONT),
        (1.0, [5], State.FIXED_POINT),
    ],
)
def test_the_state_of_a_toy_is_where_scipy_ends(
    toy: Any, c: float, excited: list[int], state: State
) -> None:
    chain = toy(c=c)
    found = find_smooth_state(chain, excite(chain, excited))
    assert (found.state, found.reason) == (state, Reason.DECIDED)
    late = by_scipy(0.3, c, excited, 4.0 * found.time)[-1] > 0.3
    assert int(np.count_nonzero(late)) == {"breather": 3, "front": SITES}.get(state.value, 0)


def test_what_was_reached_once_is_no_front(toy: Any) -> None:
    """Every site passes α once, and then all go to rest: that is not a filled chain."""
    chain = toy(c=20.0, alpha=0.3)
    start = excite(chain, [4, 5, 6], 1.6)
    found = find_smooth_state(chain, start)
    assert found.reached == SITES
    assert found.state is (State.FRONT if 3 * 1.6 / SITES > 0.3 else State.FIXED_POINT)
    weaker = find_smooth_state(chain, excite(chain, [4, 5, 6], 0.8))
    assert weaker.state is State.FIXED_POINT


def test_an_early_end_leaves_a_toy_undecided(toy: Any) -> None:
    chain = toy(c=0.08)
    sure = find_smooth_state(chain, excite(chain, [5]))
    late = find_smooth_state(chain, excite(chain, [5]), end=1.9 * sure.time)
    assert (late.state, late.reason) == (State.UNDECIDED, Reason.END_TIME)


def test_the_map_of_a_toy_has_boundaries_where_scipy_has_them(toy: Any) -> None:
    three = StateTask(chain=toy(c=0.0), nucleus=Nucleus(3, "00"))
    found = state_map(three, c=[0.005, 0.08], alpha=[0.3, 0.8], workers=1, refine=1e-2)
    assert found.states["label"].tolist() == ["breather", "fixed point", "front", "fixed point"]
    assert found.boundary is not None
    edge = next(row for row in found.boundary.rows() if (row["along"], row["alpha"]) == ("c", 0.3))
    for c, count in ((float(edge["low"]), 3), (float(edge["high"]), SITES)):
        assert np.count_nonzero(by_scipy(0.3, c, [4, 5, 6], 4000.0)[-1] > 0.3) == count
    assert found.to_dict()["counts"] == {"breather": 1, "fixed point": 2, "front": 1}


def test_bisection_between_runs_meets_the_fold_of_continuation() -> None:
    """Two methods that share no code; a run passes a fold in a time like (c - c_fold)^(-1/2)."""
    chain = AveragedChain(a=2.5, b=0.5, c=0.0, sites=15)
    fold = threshold(chain)
    runs = threshold(chain, method="bisection", accuracy=1e-4, lowest=0.1, tests=0, final_time=1e3)
    assert fold.definition is Definition.EXISTENCE
    assert isinstance(runs, RunThreshold)
    assert runs.high > fold.c
    assert -runs.error <= runs.c - fold.c < 3e-4
    stable = threshold(chain, definition="stability")
    assert stable.mechanism is Mechanism.SYMMETRY_BREAKING
    assert stable.c < fold.c


@pytest.mark.parametrize(
    "make",
    [
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), method="guess"),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), definition="whole"),
        lambda: threshold(VdpChain(a=1, b=0.5, c=0)),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(43, "0" * 42)),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"), method="sweep"),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"), method="closed-form"),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"), definition="stability"),
        lambda: threshold(PiecewiseChain(c=0.5, eta=0.03)),
        lambda: state_map(VdpChain(a=2.5, b=0.5, c=0, sites=16)),
        lambda: state_map(PiecewiseChain(c=0.5, eta=0.03), c=[0.1]),
    ],
)
def test_what_does_not_apply_is_refused_in_a_sentence(make: Any) -> None:
    with pytest.raises(ParameterError):
        make()
