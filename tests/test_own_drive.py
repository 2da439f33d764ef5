"""Harmonic forces on chains of one's own: against scipy and against linear response."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.steppers.fixed import fixed_steps
from fronts.cli import main
from tests.reference_runs import overdamped_rate, states_by_scipy
from theory.arrays import FloatArray
from theory.chains.oscillator import OscillatorChain
from theory.parameters import ParameterError
from verification.breathers.breather import breather
from verification.fronts.measure import measure_front
from verification.fronts.status import FrontStatus
from verification.maps.smooth_rules import find_smooth_state
from verification.maps.task import StateTask
from verification.references.equations import pull_matrix
from verification.references.network import oscillator_rate
from verification.runs.excite import excite
from verification.runs.integrations import integration
from verification.runs.simulate import simulate
from verification.runs.trajectory import RunStatus

PAPER = {"damping": "1 - a*y**2 + b*y**4", "values": {"a": 4.0, "b": 0.5}}
DRIVE = ["0.3,1.1@3", {"amplitude": 0.1, "frequency": 0.7, "phase": 0.4, "sites": [7, 8, 9]}]


def driven(**changes: Any) -> OscillatorChain:
    return OscillatorChain(**{**PAPER, "c": 2.0, "eps": 0.05, "sites": 9, "drive": DRIVE} | changes)


@pytest.fixture(scope="module")
def exact() -> FloatArray:
    """The states of a driven chain from rest at five times up to 100, by scipy."""
    one, other = np.zeros(9), np.zeros(9)
    one[2], other[6:] = 0.3, 0.1
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - 4.0 * y**2 + 0.5 * y**4, pull_matrix(9), c=2.0, eps=0.05,
        force=lambda t: one * np.cos(1.1 * t) + other * np.cos(0.7 * t + 0.4),
    )  # fmt: skip
    return states_by_scipy(rate, np.zeros(18), np.linspace(0.0, 100.0, 5))


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_the_error_of_a_driven_run_bounds_its_distance_from_scipy(
    tolerance: float, exact: FloatArray
) -> None:
    """From rest, where the state itself has no size to which an error could be relative."""
    run = simulate(driven(), np.zeros((2, 9)), 100.0, samples=5, tolerance=tolerance)
    assert run.times == pytest.approx(np.linspace(0.0, 100.0, 5), rel=1e-15)
    assert run.status is RunStatus.RESOLVED
    assert not integration(driven(), np.zeros((2, 9)), [1.0]).going_to_rest()
    distance = np.abs(run.states.reshape(5, -1) - exact).max()
    assert 1e-3 * tolerance < distance <= run.error < 1e3 * tolerance


def test_sites_that_a_force_excites_at_once_have_no_velocity() -> None:
    """The force takes every site at rest across the level at the same time."""
    driven_alike = OscillatorChain(**PAPER, c=0.1, drive="8,1@all")
    lattice = driven_alike.replace(coupling="square", sites=(24, 4))
    for chain, options in ((driven_alike, {"max_sites": 64}), (lattice, {})):
        front = measure_front(chain, **options)
        assert (front.status, front.v, front.error) == (FrontStatus.UNSTEADY, None, None)


def test_a_drift_below_the_last_bit_of_a_parameter_changes_nothing() -> None:
    start = np.zeros((2, 9))
    still, drifting = (
        simulate(driven(), start, 30.0, samples=4, drift=each) for each in ({}, {"c": 1e-30})
    )
    np.testing.assert_array_equal(drifting.states, still.states)


def test_a_linear_chain_stays_on_its_steady_response() -> None:
    """y = Re z exp(iωt) with (1 + εcL - ω² + iεω)z = F."""
    sites, eps, omega = 40, 0.2, 1.3
    force = np.zeros(sites, complex)
    force[[4, 20]] = 0.8 * np.exp(0.6j), 0.3 * np.exp(-1.1j)
    stiff = (1.0 + 1j * eps * omega - omega**2) * np.eye(sites) + eps * 0.9 * pull_matrix(sites)
    z = np.linalg.solve(stiff, force)
    chain = driven(
        values={"a": 0.0, "b": 0.0}, c=0.9, eps=eps, sites=sites,
        drive=[f"0.8,{omega},0.6@5", f"0.3,{omega},-1.1@21"],
    )  # fmt: skip
    start = np.array([z.real, (1j * omega * z).real])
    run = simulate(chain, start, 1000.0, samples=11, tolerance=1e-11, level=1e3)
    turn = np.exp(1j * omega * run.times)[:, None, None]
    exact = (turn * np.array([z, 1j * omega * z])).real
    assert np.abs(run.states - exact).max() <= run.error < 1e-9


def test_the_window_holds_the_driven_sites_and_pieces_change_nothing() -> None:
    chain = driven(sites=120, drive=["0.3,1.1@60", "0.1,0.7@62"])
    start = np.zeros((2, 120))
    options: dict[str, Any] = {"samples": 3, "estimate_error": False, "tolerance": 1e-8}
    part = simulate(chain, start, 30.0, **options)
    whole = simulate(chain, start, 30.0, active_window=False, **options)
    pieces = simulate(chain, start, 30.0, budget=1000, **options)
    assert part.mean_active < 60.0
    assert np.abs(part.states - whole.states).max() < 1e-8 * np.abs(whole.states).max()
    assert np.array_equal(pieces.states, part.states)


def test_a_chain_that_is_driven_is_never_about_to_rest() -> None:
    for drive, rests in (("", True), ("0.3,1.1@2", False)):
        chain = driven(sites=3, drive=drive or ())
        assert integration(chain, np.zeros((2, 3)), [1.0]).going_to_rest() is rests


def test_arrivals_and_velocity_of_a_driven_front_are_those_of_scipy() -> None:
    """A slow force pushes all sites: the front runs unsteadily, and faster on average."""
    sites, times = 120, np.linspace(0.0, 260.0, 26001)
    rate = overdamped_rate(
        lambda y: y * (1.0 - y) * (0.2 - y), pull_matrix(sites), c=1.0,
        force=lambda t: 0.02 * np.cos(0.3 * t),
    )  # fmt: skip
    chain = OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(alpha - y)", values={"alpha": 0.2}, overdamped=True,
        c=1.0, sites=sites, drive="0.02,0.3@all",
    )  # fmt: skip
    start = excite(chain, range(1, 25))
    y = states_by_scipy(rate, start[0], times, 1e-7)
    at = np.array([float(np.interp(0.2, y[:2600:, n], times[:2600])) for n in range(24, 26)])
    late = np.array([times[np.argmax(y[:, n] > 0.2)] for n in range(30, 100)])
    run = simulate(chain, start, 260.0, samples=2)
    assert run.arrivals[24:26] == pytest.approx(at, abs=1e-3)
    assert run.arrivals[30:100] == pytest.approx(late, abs=0.011)  # the samples are 0.01 apart
    front = measure_front(chain, accuracy=1e-2)
    assert front.v is not None
    assert front.error is not None
    v = np.polyfit(late, np.arange(70), 1)[0]
    # A third of a period more or less among the arrivals changes the mean velocity by 0.4 %.
    assert front.v == pytest.approx(v, rel=4e-3)
    assert front.v > np.sqrt(0.5) * 0.6  # of the continuum without a force; a lattice is slower


@pytest.mark.parametrize(
    ("drive", "words"),
    [
        ("0.3,1.1", "0.1,1.2@1,4:6"),
        ("0.3@3", "0.1,1.2@1,4:6"),
        ("0.3,x@3", "0.1,1.2@1,4:6"),
        ("nan,1@3", "amplitude of the drive = nan"),
        ("1,1e9@3", "frequency of the drive"),
        ("1,1@0", "site of the drive = 0"),
        ("1,1@8:10", "site of the drive = 10"),
        ("1,1@", "drive"),
        ("1,1@x", "0.1,1.2@1,4:6"),
        ("1,1@2:", "0.1,1.2@1,4:6"),
        ("1,1@1,6:4", "0.1,1.2@1,4:6"),
        ("1,1@1:10000000000000000000", "at most 1000000 sites"),
        ("1,1@1:1000000,1", "at most 1000000 sites"),
        ("1,1@1_0", "0.1,1.2@1,4:6"),
        ({"amplitude": 1.0}, "drive"),
        ({"amplitude": 1, "frequency": 1, "sites": []}, "sites of the drive"),
        (3.0, "drive = 3.0"),
    ],
)
def test_a_force_that_is_none_is_refused_in_one_sentence(drive: Any, words: str) -> None:
    with pytest.raises(ParameterError, match=words) as refusal:
        driven(drive=drive)
    assert str(refusal.value).count("\n") == 0


def test_what_is_left_alone_has_no_meaning_under_a_force() -> None:
    chain = driven()
    for refused in (
        chain.averaged,
        lambda: breather(chain),
        lambda: StateTask(chain=chain),
        lambda: find_smooth_state(chain, np.zeros((2, 9))),
        lambda: fixed_steps(chain, np.zeros((2, 9)), 0.1, 1, 8),
    ):
        with pytest.raises(ParameterError, match=r"drive = 0\.3,1\.1.*none for"):
            refused()


def test_shell_and_model_file_take_forces(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "mine.toml"
    model.write_text(
        'damping = "1 - a*y**2 + b*y**4"\nvalues = {a = 4, b = 0.5}\nc = 2.0\n'
        "eps = 0.05\nsites = 9\n"
        'drive = ["0.3,1.1@3", {amplitude = 0.1, frequency = 0.7, phase = 0.4, sites = "7:9"}]\n'
    )
    out = tmp_path / "run.json"
    line = ["--out", str(out), "--t-end", "20", "--displacement", "0", "--json"]
    by_hand = ["--damping", PAPER["damping"], "--value", "a=4", "--value", "b=0.5", "--c", "2"]
    forces = ["--drive", "0.3,1.1@3", "--drive", "0.1,0.7,0.4@7:9"]
    found = []
    for given in (["--model", str(model)], [*by_hand, "--eps", "0.05", "--n", "9", *forces]):
        assert main(["simulate", "chain", *given, *line]) == 0
        found.append(json.loads(capsys.readouterr().out))
    assert found[0]["amplitudes"] == found[1]["amplitudes"]
    stored = json.loads(out.read_text())["provenance"]["parameters"]
    assert stored["drive"] == ["0.3,1.1,0.0@3", "0.1,0.7,0.4@7,8,9"]
    run = simulate(driven(), np.zeros((2, 9)), 20.0, samples=2)
    assert run.amplitude[-1].tolist() == found[0]["amplitudes"]
    assert OscillatorChain.from_file(model) == driven()
