"""The map and the commands of Model I: labels against scipy, symmetry, workers, bad input."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fronts.cli import main
from theory.cells.friction import FrictionCell
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.parameters import ParameterError
from verification.execution.points import Point
from verification.execution.sweep import sweep
from verification.maps.boundary import Bisection, boundary_lines
from verification.maps.friction_rules import HOLD, WINDOW, find_friction_state
from verification.maps.rules import rules_of
from verification.maps.state import State
from verification.maps.task import StateTask, state_points
from verification.references.friction_events import run_events
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration

STRIBECK = {"law": "stribeck", "v_s": 0.6, "viscous": 0.02}
SHORT = StateTask(chain=FrictionChain(c=0, sites=7))


@pytest.mark.parametrize(
    ("law", "c", "v_d", "label"),
    [
        ({}, 0.095, 1.05, State.FRONT),
        ({}, 0.05, 1.25, State.FRONT),
        ({}, 0.095, 1.45, State.FIXED_POINT),
        ({}, 0.02, 1.8, State.FIXED_POINT),
        ({}, 0.005, 1.55, State.BREATHER),
        (STRIBECK, 0.05, 1.1, State.FRONT),
        (STRIBECK, 0.01, 1.25, State.BREATHER),
        ({"law": "coulomb"}, 0.05, 1.25, State.FIXED_POINT),
    ],
)
def test_a_label_holds_in_an_independent_run(
    law: dict[str, Any], c: float, v_d: float, label: State
) -> None:
    task = replace(SHORT, chain=SHORT.chain.replace(**law))
    result = task(Point(c=c, v_d=v_d))
    assert result["label"] == label
    chain = task.at({"c": c, "v_d": v_d})
    end = min(float(result["time"]), 250.0)
    run = run_events(chain, excite(chain, [4]), end, tolerance=1e-7, longest_step=1.0)
    sticks = run.log[run.log[:, 2] == 0]
    late = sticks[sticks[:, 0] > end - WINDOW]
    if label is State.FRONT:
        assert set(sticks[:, 1]) == set(range(1, 8))
        assert len(set(late[:, 1])) >= 4
    elif label is State.BREATHER:
        assert set(sticks[:, 1]) == set(late[:, 1]) == {4}
        # six periods of about 6.35 in a window
        assert 5 <= len(late) <= 7
    else:
        assert len(late) == 0


def test_what_is_called_steady_sliding_never_sticks_again_and_loses_energy() -> None:
    rng = np.random.default_rng(2)
    for v_d in (1.2, 1.9):
        chain = FrictionChain.of(FrictionCell(v_d=v_d), c=0.1, sites=8)
        start = 1e-4 * rng.standard_normal((2, 8))
        start[0] += chain.cell.steady_sliding
        run = FrictionIntegration(chain, start, tolerance=1e-12)
        assert run.going_to_rest()
        before = np.abs(run.state[1]).max()
        run.advance_to(400.0)
        assert np.isnan(run.arrivals).all()
        assert np.abs(run.state[1]).max() < before
        excited = FrictionIntegration(chain, excite(chain, [4]), tolerance=1e-8)
        assert not excited.going_to_rest()
    # nothing can be said where sliding is unstable, however small the motion is
    unstable = FrictionChain.of(FrictionCell(v_d=1.0), c=0.1, sites=8)
    assert not FrictionIntegration(
        unstable, excite(unstable, [1], 0.57), tolerance=1e-12
    ).going_to_rest()


def test_near_the_hopf_velocity_only_slower_motions_are_certain_to_rest() -> None:
    """They cannot take the sliding velocity to where friction falls faster than damping grows."""
    hopf = FrictionCell().hopf_velocity
    chain = FrictionChain.of(FrictionCell(v_d=hopf + 1e-4), c=0.1, sites=8)
    for share, rests in ((0.9, True), (1.1, False)):
        start = np.zeros((2, 8))
        start[0] = chain.cell.steady_sliding
        start[1, 3] = share * 0.5e-4
        assert FrictionIntegration(chain, start, tolerance=1e-12).going_to_rest() is rests


def test_a_front_needs_all_sites_and_time_to_hold() -> None:
    chain = SHORT.at({"c": 0.05, "v_d": 1.25})
    start = excite(chain, [4])
    run = FrictionIntegration(chain, start, tolerance=1e-8)
    run.advance_to(1000.0)
    found = find_friction_state(chain, start)
    assert found.state is State.FRONT
    assert (found.reached, found.reason) == (7, "decided")
    last = float(np.max(run.arrivals))
    assert HOLD * WINDOW <= found.time - last <= (HOLD + 1) * WINDOW


def test_an_excited_site_of_a_friction_chain_starts_where_its_velocity_is_zero(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As at the largest and the smallest y of a cycle; the others are at rest, at y = μ(v_d)."""
    monkeypatch.setattr("verification.runs.excite._turning_points", lambda _: (-0.5, 2.5))
    chain = FrictionChain(c=0.02, sites=3)
    rest = chain.cell.steady_sliding
    for given, y in (
        ({}, 2.5),
        ({"point": StartPoint.MINIMUM}, -0.5),
        ({"displacement": 1.5}, 1.5),
    ):
        assert excite(chain, [2], **given).tolist() == [[rest, y, rest], [0.0, 0.0, 0.0]]


def test_a_map_is_of_the_sites_and_the_point_of_the_cycle_that_are_named() -> None:
    start = rules_of(SHORT.chain).start
    for point in StartPoint:
        expected = excite(SHORT.chain, [4], point=point)
        assert np.array_equal(start(SHORT.chain, None, point=point), expected)
    assert np.array_equal(start(SHORT.chain, None), excite(SHORT.chain, [4]))
    assert np.array_equal(start(SHORT.chain, (2, 5)), excite(SHORT.chain, [2, 5]))


def test_a_label_found_in_the_second_half_does_not_count() -> None:
    point = Point(c=0.05, v_d=1.25)
    sure = SHORT(point)
    time = float(sure["time"])
    assert (sure["label"], sure["why"]) == ("front", "decided")
    assert SHORT.alone()(point)["reached"] == sure["reached"] == 7
    assert replace(SHORT, end=1.9 * time)(point)["why"] == "end time"
    # windows are 40 long, without rounding: what is found by half of the end time counts
    assert replace(SHORT, end=2.0 * time)(point)["label"] == "front"


def test_a_breather_on_an_unstable_background_is_not_decided() -> None:
    # v_d = 1.1 is below the Hopf velocity 1.1513: only exact rest stays at rest
    still = SHORT(Point(c=0.0, v_d=1.1))
    assert (still["label"], still["why"]) == ("undecided", "unstable background")
    assert SHORT(Point(c=0.0, v_d=1.2))["label"] == "breather"
    assert SHORT(Point(c=0.005, v_d=1.1))["label"] == "front"


def test_a_perturbation_can_undecide_beside_a_boundary() -> None:
    lines = boundary_lines(
        sweep(SHORT, state_points(SHORT, {"c": [0.08], "v_d": [1.2, 1.4]}), workers=1), ["c", "v_d"]
    )
    edge = sweep(Bisection(SHORT.alone(), 1e-3), lines, workers=1)
    at = float(edge["at"][0])
    assert 1.2 < at < 1.4
    reasons = {
        replace(SHORT, perturbation=1e-2, seed=seed)(Point(c=0.08, v_d=at + shift))["why"]
        for seed in range(3)
        for shift in (-1e-3, 1e-3)
    }
    assert "perturbation" in reasons


def test_the_label_of_the_mirror_image_is_the_same() -> None:
    for c, v_d in ((0.05, 1.25), (0.005, 1.5), (0.09, 1.6)):
        chain = SHORT.at({"c": c, "v_d": v_d})
        one, other = (find_friction_state(chain, excite(chain, [site])) for site in (2, 6))
        assert (one.state, one.time, one.reached) == (other.state, other.time, other.reached)


def test_a_map_has_every_label() -> None:
    points = state_points(SHORT, {"c": [0.005, 0.1], "v_d": [1.05, 1.55, 1.9]})
    table = sweep(SHORT, points, workers=1)
    assert set(table["label"]) == {"front", "breather", "fixed point"}
    one = Point(c=0.05, v_d=1.25)
    three = Nucleus(3, "00", Place.EDGE)
    wide = StateTask(chain=FrictionChain(c=0, sites=9), nucleus=three)
    assert wide(one)["label"] == "front"


@pytest.mark.parametrize(
    "make",
    [
        lambda: StateTask(chain=FrictionChain(c=0, sites=1)),
        lambda: replace(SHORT, nucleus=Nucleus(8, "0000000")),
        lambda: replace(SHORT, end=1.0),
        lambda: find_friction_state(FrictionChain(c=0, sites=7), np.zeros((2, 7)), tolerance=1e-3),
        lambda: find_friction_state(FrictionChain(c=0, sites=7), np.zeros((2, 7)), end=100.0),
        lambda: replace(SHORT, perturbation=1.0),
        lambda: replace(SHORT, seed=1, held="c"),
        lambda: state_points(SHORT, {"c": [-0.1], "v_d": [1.0]}),
        lambda: state_points(SHORT, {"c": [0.1], "v_d": [0.0]}),
        lambda: state_points(SHORT, {"c": [0.1], "mu_st": [0.5]}),
        lambda: state_points(SHORT, {"eta": [0.1]}),
        lambda: state_points(SHORT, {"velocity": [0.1]}),
    ],
)
def test_bad_parameters_are_refused(make: object) -> None:
    with pytest.raises(ParameterError):
        make()  # type: ignore[operator]


def test_the_map_command_writes_map_boundary_and_picture(tmp_path: Path, answered: Any) -> None:
    out, drawn = tmp_path / "map.csv", tmp_path / "map.png"
    line = (
        "map friction --c 0.01:0.09:3 --v-d 1.1:1.9:3 --n 7 --refine 0.25 --workers 1 "
        f"--out {out} --picture {drawn}"
    )
    answer = answered(line)
    assert answer["model"] == "friction"
    assert sum(answer["counts"].values()) == answer["points"] == 9
    read = np.genfromtxt(out, names=True, delimiter=",", dtype=None, encoding="utf-8")
    assert read["v_d"].max() == 1.9
    assert drawn.read_bytes().startswith(b"\x89PNG")
    edge = np.atleast_1d(
        np.genfromtxt(
            tmp_path / "map-boundary.csv", names=True, delimiter=",", dtype=None, encoding="utf-8"
        )
    )
    assert edge.size == answer["boundary_points"] > 2
    assert answered(line + " --resume")["resumed"] == 9


def test_simulate_gives_numbers_files_and_a_picture(tmp_path: Path, answered: Any) -> None:
    out, drawn = tmp_path / "run.npz", tmp_path / "run.svg"
    line = (
        "simulate friction --n 9 --c 0.05 --excite 1 --t-end 150 --samples 31 "
        f"--out {out} --picture {drawn}"
    )
    answer = answered(line)
    run = FrictionIntegration(
        FrictionChain(c=0.05, sites=9), excite(FrictionChain(c=0.05, sites=9), [1]), tolerance=1e-9
    )
    run.advance_to(150.0)
    known = [t for t in answer["arrivals"] if t is not None]
    np.testing.assert_allclose(known, run.arrivals[~np.isnan(run.arrivals)], atol=1e-6)
    assert answer["width"] == len(known)
    assert answer["error"] < 1e-5
    with np.load(out) as kept:
        assert kept["y"].shape == kept["velocity"].shape == kept["envelope"].shape == (31, 9)
        assert json.loads(str(kept["parameters"]))["v_d"] == 1.25
    assert drawn.read_text(encoding="utf-8").lstrip().startswith("<?xml")


def test_front_and_threshold_give_the_documented_objects(
    capsys: pytest.CaptureFixture[str],
    answered: Any,
) -> None:
    front = answered("front friction --c 0.1 --n 61")
    assert {"v", "error", "steady", "status", "seconds", "arrivals", "sites", "steps"} <= {*front}
    assert front["steady"] is True
    assert front["v"] < front["largest_group_velocity"]
    line = "threshold friction --place edge --nucleus 1 --n 7 --final-time 400 --accuracy 1e-5"
    found = answered(line)
    assert {"c_crit", "error", "bracket", "fuzzy", "monotone", "definition", "ends"} <= {*found}
    assert found["bracket"][0] < found["c_crit"] < found["bracket"][1]
    assert main(shlex.split(line)) == 0
    assert ["ends", "free"] in map(str.split, capsys.readouterr().out.splitlines())


BAD = [
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --mu-st 0.5", "mu_st"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --mu-d 1", "mu_st"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --v0 0", "v0"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --v0 -1", "v0"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --v-d 0", "v_d"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --v-d nan", "v_d"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --xi -1", "xi"),
    ("simulate friction --c -1 --excite 1 --t-end 10", "coupling c"),
    ("simulate friction --c 0.02 --excite 32 --t-end 10", "site"),
    ("simulate friction --c 0.02 --excite 1 --t-end -1", "end time"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --ends periodic", "periodic"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --a 4", "--a"),
    ("simulate friction --c 0.02 --excite 1 --t-end 10 --out run.doc", ".npz"),
    ("simulate vdp --a 4 --b 0.5 --c 0.1 --excite 1 --t-end 10 --v-d 1", "--v-d"),
    ("simulate vdp --a 4 --b 0.5 --c 0.1 --excite 1 --t-end 10 --ends literal", "literal"),
    ("front friction --c 0", "coupling c"),
    ("front friction --c 0.02 --n 5", "sites"),
    ("front friction --c 0.02 --v-d -1", "v_d"),
    ("front friction --c 0.02 --mu-st 0.2", "mu_st"),
    ("front friction --c 0.02 --v0 0", "v0"),
    ("front friction --c 0.02 --eta 0.1", "--eta"),
    ("front friction --c 0.02 --nucleus 0", "excited sites"),
    ("front vdp --c 0.6 --a 4 --b 0.5 --nucleus 2", "excited sites"),
    ("front piecewise --c 0.6 --eta 0.03 --xi 0.1", "--xi"),
    ("threshold friction --nucleus 99", "nucleus"),
    ("threshold friction --v-d 0", "v_d"),
    ("threshold friction --v0 0", "v0"),
    ("threshold friction --mu-st 0.5", "mu_st"),
    ("threshold friction --v-d 1.9", "highest coupling"),
    ("threshold friction --method orbit", "--method"),
    ("threshold friction --final-time 0", "final time"),
    ("threshold friction --accuracy 0", "accuracy"),
    ("threshold vdp --definition whole", "definition"),
    ("map friction --c 0:0.1:3 --v-d 0:1:3", "v_d"),
    ("map friction --c 0:0.1:3 --v-d 1:2:3 --mu-st 0.5", "mu_st"),
    ("map friction --c 0:0.1:3 --v-d 1:2:3 --v0 0", "v0"),
    ("map friction --c 0:0.1:3 --v-d 1:2:3 --eta 0.1", "--eta"),
    ("map friction --c 0.1:0:3 --v-d 1:2:3", "begin with the smaller"),
    ("map friction --c 0:0.1:3 --v-d 1:2:3 --nucleus 40", "nucleus"),
    ("map vdp --c 0.1 --eta 0.1 --v-d 1", "--v-d"),
]


@pytest.mark.parametrize(("line", "word"), BAD)
def test_bad_input_ends_with_two_and_one_sentence(
    line: str,
    word: str,
    refused: Any,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert word in refused(line)["message"]
    assert list(tmp_path.iterdir()) == []
