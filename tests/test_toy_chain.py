"""The proof of the design: a further model is one dataclass and one right-hand side, defined here.

It is the chain of Nagumo, ẏ_n = y_n (1 - y_n)(y_n - α) + c (y_{n-1} - 2y_n + y_{n+1}): another
equation, of first order, without oscillation, waves or phases. Nothing outside this file knows it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fronts.cli import main
from theory.arrays import FloatArray
from theory.chains.chain import CHAINS, SmoothChain, parameter
from theory.chains.ends import Ends
from theory.chains.nucleus import Nucleus, Place
from theory.parameters import ParameterError
from verification.fronts.measure import measure_front
from verification.fronts.status import FrontStatus
from verification.maps.smooth_rules import find_smooth_state
from verification.maps.state import Reason, State
from verification.maps.state_map import state_map
from verification.maps.task import StateTask
from verification.quantities.judging import PointOutcome, judge
from verification.quantities.registry import computation_named
from verification.quantities.robustness import robustness
from verification.runs.excite import excite, excite_edge
from verification.runs.simulate import simulate
from verification.runs.smooth_integration import SmoothIntegration
from verification.runs.trajectory import RunStatus
from verification.thresholds.result import Definition, Mechanism, RunThreshold
from verification.thresholds.spreading import Spreading, spreads
from verification.thresholds.threshold import threshold


def nagumo(site: Any, left: Any, right: Any, p: Any) -> Any:
    """Return (ẏ, ẇ) of a site; w is not used and stays zero."""
    y, w = site
    return y * (1.0 - y) * (y - p[0]) + p[1] * (left[0] + right[0] - 2.0 * y), -w


@dataclass(frozen=True, kw_only=True)
class NagumoChain(SmoothChain, model="nagumo", kernel=nagumo):
    """Parameters of the chain of Nagumo."""

    alpha: float = parameter("threshold, from 0 to 1/2", "α", 0.2)
    c: float = parameter("coupling, zero or positive", "c", 1.0)
    sites: int = parameter("number of sites", "N", 31)
    ends: Ends = parameter("what the end sites are coupled to", "ends", Ends.FREE)

    def __post_init__(self) -> None:
        self._check_number("alpha", "threshold alpha", 0.0, 0.5)
        self._check_number("c", "coupling c", 0.0, 1e6)
        self._check_count("sites", "number of sites n", 2, 10**6)
        self._check_ends()

    @property
    def stable_amplitude(self) -> float:
        return 1.0

    @property
    def unstable_amplitude(self) -> float:
        return self.alpha


@dataclass(frozen=True, kw_only=True)
class ScaledChain(NagumoChain, model="scaled", kernel=nagumo):
    """A chain with parameters called a and b, which need not be those of (8)."""

    a: float = parameter("a number", "a", 1.0)
    b: float = parameter("another number", "b", 1.0)


del CHAINS["nagumo"], CHAINS["scaled"]  # entered by definition; only this file knows them


@pytest.fixture(autouse=True, scope="module")
def _registered() -> Iterator[None]:
    """Leave the register as it was: other tests ask which models there are."""
    CHAINS["nagumo"] = NagumoChain
    yield
    del CHAINS["nagumo"]


def by_scipy(chain: NagumoChain, y: FloatArray, times: FloatArray) -> FloatArray:
    """Return y at the times, by scipy; the equation is written a second time."""

    def rate(_: float, y: FloatArray) -> FloatArray:
        spread = np.diff(y, prepend=y[:1], append=y[-1:], n=2)
        slope: FloatArray = y * (1.0 - y) * (y - chain.alpha) + chain.c * spread
        return slope

    span = (0.0, float(times[-1]))
    found = solve_ivp(rate, span, y, method="DOP853", rtol=1e-12, atol=1e-13, t_eval=times)
    return np.asarray(found.y.T)


def test_it_is_a_model_and_refuses_what_is_wrong() -> None:
    assert CHAINS["nagumo"] is NagumoChain
    assert NagumoChain().parameters() == {
        "model": "nagumo", "alpha": 0.2, "c": 1.0, "sites": 31, "ends": "free"
    }  # fmt: skip
    with pytest.raises(ParameterError, match=r"threshold alpha = '0\.2'"):
        NagumoChain(alpha="0.2")  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="ends"):
        NagumoChain(ends=Ends.PERIODIC)


def test_it_runs_and_its_error_bounds_the_distance_from_scipy() -> None:
    chain = NagumoChain(c=0.5)
    start = excite(chain, [15, 16, 17])
    run = simulate(chain, start, 40.0, samples=5, tolerance=1e-7)
    assert run.status is RunStatus.RESOLVED
    exact = by_scipy(chain, start[0], run.times)
    assert 1e-12 < np.abs(run.y - exact).max() <= run.error < 1e-4
    assert run.width[-1] > 3
    assert np.array_equal(run.y, run.y[:, ::-1])
    reached = run.arrivals[17]
    value = by_scipy(chain, start[0], np.array([reached]))[0, 17]
    assert abs(value - chain.alpha) < 1e-5


def test_its_run_is_resumed_to_the_same_bits(tmp_path: Path) -> None:
    chain = NagumoChain()
    start, file = excite(chain, [1, 2]), tmp_path / "run.npz"
    whole = simulate(chain, start, 30.0, samples=4)

    def interrupt(fraction: float) -> None:
        if fraction > 0.1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(chain, start, 30.0, samples=4, checkpoint=file, progress=interrupt, budget=500)
    resumed = simulate(chain, start, 30.0, samples=4, checkpoint=file)
    assert np.array_equal(whole.states, resumed.states)


def test_its_front_has_the_velocity_of_scipy_and_of_the_continuum() -> None:
    chain = NagumoChain(c=2.0, sites=60)
    front = measure_front(chain)
    assert front.status is FrontStatus.STEADY
    # v = √(c/2)(1 - 2α) of the partial differential equation; the chain is slower by O(1/c).
    continuum = math.sqrt(chain.c / 2.0) * (1.0 - 2.0 * chain.alpha)
    assert 0.0 < 1.0 - front.v / continuum < 0.05
    long = chain.replace(sites=200)
    times = np.linspace(30.0, 80.0, 251)
    mass = by_scipy(long, excite_edge(long, 24)[0], times).sum(axis=1)
    # A travelling profile gains one site's worth of mass a site; over 50 units of time its steps
    # within a site average out.
    v = np.polyfit(times, mass, 1)[0]
    assert abs(front.v - v) < front.error + 1e-3 * v


def test_its_front_is_pinned_where_the_coupling_is_weak() -> None:
    front = measure_front(NagumoChain(alpha=0.3, c=0.02), excited=6)
    assert (front.status, front.v) == (FrontStatus.PINNED, 0.0)
    assert "at rest" in front.status.sentence


def test_its_runs_are_a_row_of_the_robustness_table(capsys: pytest.CaptureFixture[str]) -> None:
    """They are tried, held against scipy and listed; a shifted value is seen."""
    found = robustness(["run-nagumo"], 12, 0, workers=1)
    assert found.bad == ()
    assert found.counts["right"] >= 3
    assert found.counts["refused"] > 0  # alpha above one half
    row = computation_named("run-nagumo")
    inside = {"alpha": 0.2, "c": 0.5, "sites": 8.0, "tolerance": 1e-8}
    stated = row.compute(inside)
    shifted = replace(stated, value=stated.value + 100.0 * stated.error)
    assert judge(row, inside)["outcome"] == PointOutcome.RIGHT.value
    off = replace(row, compute=lambda _: shifted)
    assert judge(off, inside)["outcome"] == PointOutcome.EXCEEDED.value
    assert main(["stress", "--list"]) == 0
    assert row.name in capsys.readouterr().out


SITES, ALPHA, END = 9, 0.3, 400.0


def late_by_scipy(c: float, excited: list[int], end: float = END) -> FloatArray:
    """Return y at 201 times up to the end, from these sites at 1."""
    start = np.zeros(SITES)
    start[[n - 1 for n in excited]] = 1.0
    chain = NagumoChain(alpha=ALPHA, c=c, sites=SITES)
    return by_scipy(chain, start, np.linspace(0.0, end, 201))


def test_the_threshold_of_a_toy_is_that_of_scipy() -> None:
    """Five sites in the middle spread from the coupling on at which another one passes α."""
    found = threshold(
        NagumoChain(alpha=ALPHA, c=0.0, sites=SITES),
        Nucleus(5, "0000"),
        final_time=END,
        lowest=1e-3,
        accuracy=1e-5,
        tests=0,
    )
    assert (found.definition, found.mechanism) == (Definition.FIRST, Mechanism.SPREADING)
    assert isinstance(found, RunThreshold)
    assert found.high - found.low <= 1e-5
    for c, spread in ((found.low, False), (found.high, True)):
        outside = late_by_scipy(c, [3, 4, 5, 6, 7])[:, 1]
        assert bool(outside.max() > ALPHA) is spread


@pytest.mark.parametrize("definition", ["first", "several", "whole"])
def test_spreading_counts_what_its_definition_says(definition: str) -> None:
    """In between, some sites are reached and not all that a definition asks for."""
    seen = []
    for excited in ([5], [4, 5, 6]):
        for c in (0.03, 0.05, 0.1):
            y = late_by_scipy(c, excited, 60.0)
            for end in (21.0, 60.0):
                spreading = Spreading(
                    len(excited), Place.BULK, Definition(definition), final_time=end
                )
                by_then = y[: round(end / 0.3) + 1]
                reached = set((np.flatnonzero((by_then > ALPHA).any(axis=0)) + 1).tolist())
                needed = set(spreading.watched(SITES))
                expected = bool(needed & reached) if definition == "first" else needed <= reached
                chain = NagumoChain(alpha=ALPHA, c=c, sites=SITES)
                assert spreads(chain, spreading) is expected, (excited, c, end)
                seen.append((expected, bool(reached - set(excited))))
    assert {spread for spread, _ in seen} == {True, False}
    assert definition == "first" or (False, True) in seen


@pytest.mark.parametrize(
    ("c", "excited", "state"),
    [
        (0.005, [4, 5, 6], State.BREATHER),
        (0.08, [4, 5, 6], State.FRONT),
        (1.0, [5], State.FIXED_POINT),
    ],
)
def test_the_state_of_a_toy_is_where_scipy_ends(c: float, excited: list[int], state: State) -> None:
    chain = NagumoChain(alpha=ALPHA, c=c, sites=SITES)
    found = find_smooth_state(chain, excite(chain, excited))
    assert (found.state, found.reason) == (state, Reason.DECIDED)
    late = late_by_scipy(c, excited, 4.0 * found.time)[-1] > ALPHA
    assert int(np.count_nonzero(late)) == {"breather": 3, "front": SITES}.get(state.value, 0)


def test_what_was_reached_once_is_no_front() -> None:
    """Every site passes α once, and then all go to rest: that is not a filled chain."""
    chain = NagumoChain(alpha=ALPHA, c=20.0, sites=SITES)
    start = excite(chain, [4, 5, 6], 1.6)
    found = find_smooth_state(chain, start)
    assert found.reached == SITES
    assert found.state is (State.FRONT if 3 * 1.6 / SITES > ALPHA else State.FIXED_POINT)
    weaker = find_smooth_state(chain, excite(chain, [4, 5, 6], 0.8))
    assert weaker.state is State.FIXED_POINT


def test_an_early_end_leaves_a_toy_undecided() -> None:
    chain = NagumoChain(alpha=ALPHA, c=0.08, sites=SITES)
    sure = find_smooth_state(chain, excite(chain, [5]))
    late = find_smooth_state(chain, excite(chain, [5]), end=1.9 * sure.time)
    assert (late.state, late.reason) == (State.UNDECIDED, Reason.END_TIME)


def test_the_map_of_a_toy_has_boundaries_where_scipy_has_them() -> None:
    three = StateTask(chain=NagumoChain(alpha=ALPHA, c=0.0, sites=SITES), nucleus=Nucleus(3, "00"))
    found = state_map(three, c=[0.005, 0.08], alpha=[0.3, 0.5], workers=1, refine=1e-2)
    assert found.states["label"].tolist() == ["breather", "breather", "front", "breather"]
    assert found.boundary is not None
    edge = next(
        row for row in found.boundary.rows() if (row["along"], row["alpha"]) == ("c", ALPHA)
    )
    for c, count in ((float(edge["low"]), 3), (float(edge["high"]), SITES)):
        assert np.count_nonzero(late_by_scipy(c, [4, 5, 6], 4000.0)[-1] > ALPHA) == count
    assert found.to_dict()["counts"] == {"breather": 3, "front": 1}


@pytest.mark.parametrize(
    ("line", "key"),
    [
        ("simulate nagumo --n 21 --c 0.5 --excite 11 --t-end 30", "amplitudes"),
        ("front nagumo --c 1 --n 40", "v"),
        ("front nagumo --c 0.5:1:2 --n 40", "points"),
        ("threshold nagumo --place edge --accuracy 1e-2 --n 15", "c_crit"),
        ("map nagumo --c 0.05:0.5:2 --alpha 0.1:0.3:2 --n 15 --refine 0 --workers 1", "counts"),
    ],
)
def test_the_command_line_knows_the_model(
    line: str, key: str, answered: Any, tmp_path: Path
) -> None:
    """Its options are the fields of its class; nothing in ``fronts`` names it."""
    picture = tmp_path / "picture.svg"
    files = [] if line.startswith("threshold") else ["-o", str(picture)]
    assert key in answered([*line.split(), *files])
    assert picture.exists() is bool(files)


def test_help_shows_the_parameters_of_the_model(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["front", "nagumo", "--help"])
    shown = capsys.readouterr().out
    assert "threshold, from 0 to 1/2" in shown
    assert "--eps" not in shown


def test_a_run_of_another_right_hand_side_is_another_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """A checkpoint holds the state of one, and is refused for the other."""

    def slower(site: Any, left: Any, right: Any, p: Any) -> Any:
        return 0.5 * nagumo(site, left, right, p)[0], -site[1]

    def metadata() -> dict[str, Any]:
        return SmoothIntegration(NagumoChain(), excite(NagumoChain(), [1]), [1.0]).metadata

    one = metadata()
    assert metadata() == one
    monkeypatch.setattr(NagumoChain, "_right_hand_side", staticmethod(slower))
    other = metadata()
    assert {key for key in one if one[key] != other[key]} == {"right_hand_side"}
    assert None not in (one["right_hand_side"], other["right_hand_side"])  # not of this project


@pytest.mark.parametrize("eta", ["0.1", "0.01:0.1:3"])
def test_a_map_whose_axes_do_not_include_eta_refuses_it(
    eta: str, monkeypatch: pytest.MonkeyPatch, refused: Any
) -> None:
    """A single number was ignored, although the chain has a and b."""
    monkeypatch.setitem(CHAINS, "scaled", ScaledChain)
    error = refused(f"map scaled --c 0.1:0.2:2 --alpha 0.2:0.3:2 --eta {eta}")
    assert error["message"] == "--eta has no meaning for 'fronts map scaled': leave it out."
