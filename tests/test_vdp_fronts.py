"""Fronts of Model II: velocities against an independent chain, statuses, the law, the commands."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fronts.cli import main
from theory.averaged.front import strong_coupling_front
from theory.chains.vdp import VanDerPolChain, VdpChain
from theory.parameters import ParameterError
from verification.fronts import preparation
from verification.fronts.arrival_fit import line, velocity_of_arrivals
from verification.fronts.measure import measure_front
from verification.fronts.request import TOLERANCE
from verification.fronts.result import LeftBoundary
from verification.fronts.status import FrontStatus
from verification.fronts.wave import front_wave
from verification.references.passages import quarter_turn_velocity


@pytest.mark.parametrize(
    ("eta", "c", "sites"), [(0.002, 0.3, 24), (0.03125, 0.15, 40), (0.05, 1.0, 60), (0.09, 0.3, 40)]
)
def test_the_velocity_is_that_of_the_real_chain_of_quarter_turns(
    eta: float, c: float, sites: int
) -> None:
    front = measure_front(
        VdpChain(a=1.0, b=eta, c=c).averaged(), left_boundary=LeftBoundary.WAVE, accuracy=1e-6
    )
    assert front.status is FrontStatus.STEADY
    # scipy's own tolerance of 1e-9 a step, over some hundred steps
    assert abs(front.v - quarter_turn_velocity(1.0, eta, c, sites)) < front.error + 3e-7 * front.v


@pytest.mark.parametrize("of", [VdpChain.full, VdpChain.averaged])
def test_the_uncertainty_bounds_the_distance_from_a_longer_measurement(
    of: Callable[[VdpChain], VanDerPolChain],
) -> None:
    for c in (0.3, 0.6, 3.0):
        chain = VdpChain(a=4.0, b=0.5, c=c)
        short = measure_front(of(chain), accuracy=1e-2)
        long = measure_front(of(chain), accuracy=1e-4)
        assert abs(short.v - long.v) <= short.error + long.error


@pytest.mark.parametrize(("c", "b"), [(1.5, 0.5), (2.0, 0.32), (3.0, 0.5), (6.0, 0.32)])
def test_the_uncertainty_holds_at_the_coarsest_tolerance(c: float, b: float) -> None:
    """The front itself, solved for; the run is compared with one that is coarser still."""
    chain = VdpChain(a=4.0, b=b, c=c).averaged()
    front = measure_front(chain, tolerance=TOLERANCE.allowed.high)
    assert abs(front.v - front_wave(c, chain.eta).v) <= front.error


@pytest.mark.parametrize(
    ("eta", "c", "status"),
    [(0.0236, 110.6, FrontStatus.STEADY), (0.013, 654.0, FrontStatus.UNSTEADY)],
)
def test_at_strong_coupling_the_error_bounds_what_is_left_of_the_start(
    eta: float, c: float, status: FrontStatus
) -> None:
    """The velocity after the start passes through a minimum before it rises to that of the wave."""
    chain = VdpChain(a=1.0, b=eta, c=c).averaged()
    front = measure_front(chain, left_boundary=LeftBoundary.WAVE)
    assert abs(front.v - front_wave(c, eta).v) <= front.error
    assert front.status is status


def test_a_front_of_the_full_chain_below_depinning_is_pinned_and_not_creeping() -> None:
    """Within a cycle √(y² + ẏ²) varies by 3 %; the largest of scipy's run ahead does not change."""
    chain = VdpChain(a=4, b=0.5, c=0.05)
    assert measure_front(chain).status is FrontStatus.PINNED

    def rate(_: float, state: np.ndarray) -> list[float]:
        (y, v), w = state[:2].tolist(), state[2:].tolist()
        pull = 0.01 * 0.05 * (v - y)
        return [
            *w,
            -y + pull - 0.01 * w[0] * (1 - 4 * y**2 + 0.5 * y**4),
            -v - pull - 0.01 * w[1] * (1 - 4 * v**2 + 0.5 * v**4),
        ]

    start = [chain.stable_amplitude, 0.0, 0.0, 0.0]
    times = np.concatenate([end + np.linspace(-6.3, 0.0, 64) for end in (1500.0, 2000.0)])
    run = solve_ivp(rate, (0.0, 2000.0), start, "DOP853", times, rtol=1e-6, atol=1e-8)
    amplitude = np.hypot(run.y[:2], run.y[2:])
    early, late = amplitude[:, :64], amplitude[:, 64:]
    assert np.ptp(early[0]) > 0.02 * chain.stable_amplitude
    assert abs(late.max(axis=1) - early.max(axis=1)).max() < 1e-3 * chain.stable_amplitude
    assert late[1].max() < 0.5 * chain.unstable_amplitude


def test_a_front_that_outruns_the_waves_does_not_know_what_is_behind_it() -> None:
    free, wave = (
        measure_front(VdpChain(a=4.0, b=0.5, c=0.3).averaged(), left_boundary=each)
        for each in LeftBoundary
    )
    assert free.v == wave.v
    assert free.v > 0.3


def test_a_front_slower_than_the_waves_does() -> None:
    free, wave = (
        measure_front(VdpChain(a=1.0, b=0.09, c=0.3).averaged(), left_boundary=each)
        for each in LeftBoundary
    )
    assert free.v < 0.3
    assert abs(free.v - wave.v) > 100.0 * ((free.error or 0.0) + (wave.error or 0.0))


def test_a_front_that_a_wave_overtakes_errs_by_what_the_place_of_the_boundary_changes() -> None:
    """At ε = 0.16 a quarter of a turn a site is not the front's own wave: v differs in its third
    digit with the sites between, and runs that stated 3e-5 were apart by 4e-3.
    """
    chain = VdpChain(a=4.0, b=1.48, c=0.6227, eps=0.1564)
    found = [
        measure_front(chain, left_boundary=LeftBoundary.WAVE, excited=excited)
        for excited in (12, 24)
    ]
    (one, error), (other, other_error) = ((each.v or 0.0, each.error or 0.0) for each in found)
    assert 0.0 < one < chain.c
    assert 1e-3 < abs(one - other) <= error + other_error
    assert all(each.status is FrontStatus.UNSTEADY for each in found)


def test_all_sites_kept_give_the_front_measured_with_few() -> None:
    """Sites behind are left out for a fast front: nothing of its arrivals changes."""
    from verification.runs.excite import excite_edge
    from verification.runs.simulate import simulate

    chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=60)
    runs = [
        simulate(
            chain.averaged(), excite_edge(chain, 24), 4500.0, trailing_sites=behind,
            estimate_error=False, samples=2)
        for behind in (0, 24)
    ]  # fmt: skip
    reached = ~np.isnan(runs[0].arrivals)
    assert reached.sum() > 50
    assert np.abs(runs[0].arrivals - runs[1].arrivals)[reached].max() < 1e-4


@pytest.mark.parametrize(
    ("eta", "c", "status"),
    [(0.03125, 0.09, "pinned"), (0.11, 0.3, "collapsed"), (0.1, 0.3, "creeping")],
)
def test_what_does_not_run_is_named(eta: float, c: float, status: str) -> None:
    front = measure_front(VdpChain(a=1.0, b=eta, c=c).averaged(), max_sites=250)
    assert front.status.value == status
    assert front.v == (0.0 if status == "pinned" else None)


@pytest.mark.parametrize("count", [3, 4, 9, 200])
def test_the_error_of_a_slope_is_that_of_numpys_regression(count: int) -> None:
    x, y = np.random.default_rng(7).normal(size=(2, count))
    slope, error = line(x, y)
    theirs, covariance = np.polyfit(x, y, 1, cov=True)
    assert (slope, error) == pytest.approx((theirs[0], math.sqrt(covariance[0, 0])), rel=1e-10)


def test_the_regression_knows_its_noise() -> None:
    random = np.random.default_rng(5)
    hits = 0
    for _ in range(200):
        arrivals = np.arange(64) / 0.02 + random.normal(0.0, 0.5, 64)
        v, error = (x / 0.01 for x in velocity_of_arrivals(arrivals))
        hits += abs(v - 2.0) <= error
    # Two standard errors or more: at least 95 of 100, less three standard deviations of 200 trials.
    assert hits >= 181


@pytest.mark.parametrize("eta", [0.01, 0.03125, 0.05])
def test_kappa_is_the_limit_of_the_chain(eta: float) -> None:
    """(v - c)/(c/6)^(1/3) tends to κ with corrections of order c^(-2/3): Richardson over c."""
    kappa = strong_coupling_front(eta).kappa
    values = []
    for c in (1.0, 8.0):
        v = quarter_turn_velocity(1.0, eta, c, 100)
        values.append((v - c) / math.cbrt(c / 6.0))
    extrapolated = values[1] + (values[1] - values[0]) / (4.0 - 1.0)
    assert abs(values[1] - kappa) < abs(values[0] - kappa)
    assert extrapolated == pytest.approx(kappa, abs=0.02 * max(1.0, abs(kappa)))


@pytest.mark.parametrize("eta", [0.0, 1e-5, 0.115, math.nan])
def test_the_law_is_refused_where_it_is_not_known(eta: float) -> None:
    with pytest.raises(ParameterError, match="eta"):
        strong_coupling_front(eta)


def _run(line: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    code = main(shlex.split(line))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.parametrize("model", ["vdp", "envelope"])
def test_front_gives_the_documented_object(model: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = _run(f"front {model} --c 0.6 --a 4 --b 0.5 --json", capsys)
    answer = json.loads(out)
    assert code == 0
    assert {"v", "error", "steady", "status", "seconds"} <= set(answer)
    assert answer["steady"]
    assert answer["v"] == pytest.approx(0.72, abs=0.01)


def test_simulate_writes_what_it_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, drawn = tmp_path / "run.npz", tmp_path / "run.png"
    code, text, _ = _run(
        "simulate vdp --n 12 --a 4 --b 0.5 --c 0.6 --excite 1 --t-end 400 --samples 11 "
        f"--out {out} --picture {drawn} --json",
        capsys,
    )
    assert code == 0
    answer = json.loads(text)
    assert len(answer["amplitudes"]) == 12
    with np.load(out) as file:
        assert file["psi"].shape == (11, 12)
        assert np.abs(file["psi"][-1]).tolist() == answer["amplitudes"]
    assert drawn.stat().st_size > 1000


_SIMULATE = "simulate vdp --a 4 --b 0.5 --c 0.6 --excite 1 --t-end 10"


@pytest.mark.parametrize(
    ("line", "named"),
    [
        (f"{_SIMULATE} --n 1", "sites n"),
        (f"{_SIMULATE} --eps 0", "eps"),
        (f"{_SIMULATE} --eps -1", "eps"),
        (f"{_SIMULATE} --excite 40", "excited site"),
        (f"{_SIMULATE} --excite 5:2", "--excite = 5:2"),
        (f"{_SIMULATE} --out /nowhere/run.npz", "/nowhere"),
        (f"{_SIMULATE} --out run.txt", "run.txt"),
        (f"{_SIMULATE} --displacement 1e9", "displacement"),
        (f"{_SIMULATE} --samples 1", "samples"),
        (f"{_SIMULATE} --tolerance 0", "tolerance"),
        ("simulate vdp --a 1 --b 0.5 --c 0.6 --excite 1 --t-end 10", "eta"),
        ("simulate vdp --a 4 --b 0.5 --c nan --excite 1 --t-end 10", "nan"),
        ("front vdp --c 0 --a 4 --b 0.5", "coupling c"),
        ("front vdp --c 0.5 --a 1 --b 0.5", "eta"),
        ("front vdp --c 0.5 --a 4 --b 0.5 --accuracy 1", "accuracy"),
        ("front envelope --c 0.5 --a 4 --b 0.5 --eps -1", "eps"),
        ("front envelope --c 0.5 --a 4 --b 0.5 --start-v 1", "start-v"),
        ("front piecewise --c 0.5 --a 4 --b 0.5 --behind wave", "behind"),
    ],
)
def test_bad_input_ends_with_one_sentence(
    line: str, named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, error = _run(line, capsys)
    assert code == 2
    assert out == ""
    assert named in error
    assert error.strip().count("\n") == 0
    assert "Traceback" not in error


@pytest.mark.parametrize("c", [0.6, 10.0])
@pytest.mark.parametrize("margin", [4, 12])
def test_sites_beside_the_far_end_change_the_velocity_by_less_than_its_error(
    c: float, margin: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The wave reflected at the end reaches back some sites; those are not timed."""
    chain = VdpChain(a=4.0, b=0.5, c=c).averaged()
    front = measure_front(chain)
    monkeypatch.setattr(preparation, "MARGIN", margin)
    other = measure_front(chain)
    assert 0.0 < abs(front.v - other.v) <= front.error + other.error
