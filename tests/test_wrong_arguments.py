"""Functions that take a chain refuse what is none, or another model, in a sentence."""

from __future__ import annotations

import re
from collections.abc import Callable
from inspect import signature
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

import fronts as fr
from theory.parameters import refuse_unread
from verification.breathers import breather as breathers
from verification.breathers.outcome import follow_nucleus
from verification.cells.diagram import bifurcation
from verification.cells.friction import friction_cell
from verification.cells.oscillator import oscillator_cell
from verification.cells.vdp import vdp_cell
from verification.maps.friction_rules import WINDOW, find_friction_state
from verification.maps.smooth_rules import find_smooth_state
from verification.maps.task import StateTask
from verification.maps.vdp_rules import find_vdp_state
from verification.piecewise.simulation import simulate_front
from verification.references.friction_events import run_events
from verification.references.switch_model import run_switch
from verification.thresholds import threshold as thresholds
from verification.thresholds.escape import escape_range
from verification.thresholds.preparation import NucleusPreparation
from verification.thresholds.slow_sweep import sweep_envelope
from verification.thresholds.spreading import Spreading, spreading_threshold

CHAINS = {
    "vdp": fr.VdpChain(a=4, b=0.5, c=0.05, sites=7),
    "averaged": fr.AveragedChain(a=4, b=0.5, c=0.05, sites=7),
    "piecewise": fr.PiecewiseChain(c=0.5, eta=0.03125),
    "friction": fr.FrictionChain(c=0.02, sites=7),
    "own": fr.OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.05, sites=7),
}
NO_CHAINS = {
    "nothing": None,
    "text": "vdp",
    "cell": fr.FrictionCell(),
    "class": fr.VdpChain,
    "array": [[0.0, 1.0], [0.0, 0.0]],
}
TAKE_A_CHAIN: dict[str, tuple[Callable[[Any], object], set[str]]] = {
    "averaging_error": (fr.averaging_error, {"averaged", "piecewise", "friction"}),
    "breather": (fr.breather, {"piecewise", "friction"}),
    "cell": (fr.cell, {"piecewise"}),
    "ensemble": (lambda chain: fr.ensemble(len, chain), {*CHAINS}),
    "excite": (lambda chain: fr.excite(chain, [1]), {"piecewise"}),
    "follow_breather": (
        lambda chain: fr.follow_breather(chain, [0.1]), {"piecewise", "friction", "own"}
    ),
    "follow_front": (
        lambda chain: fr.follow_front(chain, [0.5]), {"vdp", "piecewise", "friction", "own"}
    ),
    "measure_front": (fr.measure_front, set()),
    "simulate": (lambda chain: fr.simulate(chain, [[0.0] * 7] * 2, 1.0), {"piecewise"}),
    "state_map": (lambda chain: fr.state_map(chain, c=[0.1]), {"piecewise"}),
    "threshold": (fr.threshold, {"piecewise"}),
}  # fmt: skip
"""Function, and the models that it has no answer for."""


@pytest.mark.parametrize("given", NO_CHAINS)
@pytest.mark.parametrize("name", TAKE_A_CHAIN)
def test_what_is_no_chain_is_refused(name: str, given: str) -> None:
    if (name, given) == ("cell", "cell"):
        return
    with pytest.raises(fr.ParameterError, match="is not allowed: it must be") as refused:
        TAKE_A_CHAIN[name][0](NO_CHAINS[given])
    assert refused.value.quantity == ("cell" if name == "cell" else "chain")


@pytest.mark.parametrize(
    ("name", "model"), [(n, m) for n, (_, wrong) in TAKE_A_CHAIN.items() for m in sorted(wrong)]
)
def test_a_model_that_a_function_has_no_answer_for_is_refused(name: str, model: str) -> None:
    with pytest.raises(fr.ParameterError, match="is not allowed: it must be"):
        TAKE_A_CHAIN[name][0](CHAINS[model])


@pytest.mark.parametrize("nucleus", [3, "3", None])
def test_a_nucleus_is_a_nucleus(nucleus: Any) -> None:
    chain = CHAINS["vdp"]
    for ask in (
        lambda: fr.breather(chain, nucleus=nucleus),
        lambda: fr.threshold(chain, nucleus),
        lambda: fr.follow_breather(chain, [0.1], nucleus=nucleus),
    ):
        with pytest.raises(fr.ParameterError, match=r"Nucleus\(3\)"):
            ask()


@pytest.mark.parametrize(
    "couplings", [0.1, "0.1", np.array(0.1), [], [-0.1], [float("nan")], ["a"], ["0.1"], None]
)
def test_couplings_are_positive_numbers(couplings: Any) -> None:
    for ask in (
        lambda: fr.follow_breather(CHAINS["vdp"], couplings),
        lambda: fr.follow_front(CHAINS["averaged"], couplings),
    ):
        with pytest.raises(fr.ParameterError, match=r"^coupling c = "):
            ask()


START = fr.excite(CHAINS["vdp"], [1])
HIDDEN = np.ma.array([0.3, 0.5], mask=[False, True])
REFUSED: dict[str, tuple[Callable[[], object], str]] = {
    "masked-c": (lambda: fr.kinetic_relation(HIDDEN, 0.03), "coupling c"),
    "masked-eta": (lambda: fr.kinetic_relation(0.5, HIDDEN), "eta"),
    "masked-times": (lambda: fr.simulate(CHAINS["vdp"], START, 1.0, times=HIDDEN), "times"),
    "masked-start": (
        lambda: fr.simulate(CHAINS["vdp"], np.ma.array(START, mask=START > 0), 1.0), "start"
    ),
    "flat-start": (lambda: fr.simulate(CHAINS["vdp"], START[0], 1.0), "start"),
    "no-sample": (lambda: fr.simulate(CHAINS["vdp"], START, 1.0, times=[]), "number of samples"),
    "no-length": (lambda: fr.threshold(CHAINS["piecewise"]), "model = piecewise"),
    "no-sites": (lambda: fr.excite(CHAINS["piecewise"], [2]), "model = piecewise"),
    "network-wave": (
        lambda: fr.simulate(
            fr.OscillatorChain(damping="y**2 - 1", c=0.1, sites=7, coupling="next-nearest:1,0.2"),
            START, 1.0, left_boundary_wave=True,
        ),
        "left boundary",
    ),
    "masked-axis": (lambda: fr.state_map(CHAINS["vdp"], c=HIDDEN), "c = "),
    "empty-axis": (lambda: fr.state_map(CHAINS["vdp"], eta=[], c=[0.1]), r"eta = \[\]"),
    "date": (lambda: fr.kinetic_relation(np.datetime64("2020"), 0.03), "coupling c"),
    "text": (lambda: fr.kinetic_relation("0.3", 0.03), "coupling c"),
    "one-site": (lambda: fr.excite(CHAINS["vdp"], 3), "excited sites = 3"),
    "point-of-no-cycle": (
        lambda: fr.excite(CHAINS["vdp"], [1], point="minimum"), "start point = minimum",
    ),
    "point-and-displacement": (
        lambda: fr.excite(CHAINS["friction"], [1], 2.0, point="minimum"), "start point = minimum",
    ),
    "half-a-site": (lambda: fr.excite(CHAINS["vdp"], [1.5]), "excited site = 1.5"),
    "turns": (lambda: fr.excite(CHAINS["vdp"], [1, 2], quarter_turns=[1]), "quarter turns"),
    "place": (lambda: fr.Nucleus(1, place="end"), "place = end"),
    "pattern": (lambda: fr.Nucleus(3, None), "pattern = None"),
    "ends": (lambda: fr.VdpChain(a=4, b=0.5, c=0.6, ends="open"), "ends = open"),
    "left": (lambda: fr.measure_front(CHAINS["vdp"], left_boundary="waves"), "left boundary"),
    "stall": (lambda: fr.measure_front(CHAINS["vdp"], stall_time=5e-324), "stall time"),
    "budget": (lambda: fr.simulate(CHAINS["vdp"], START, 1.0, budget=0), "budget"),
    "budget-text": (lambda: fr.simulate(CHAINS["vdp"], START, 1.0, budget="1"), "budget"),
    "checkpoint": (lambda: fr.simulate(CHAINS["vdp"], START, 1.0, checkpoint=True), "checkpoint"),
    "swept": (lambda: fr.sweep("abs", {"x": [1.0]}, workers=1), "function = 'abs'"),
    "no-points": (lambda: fr.sweep(len, 3, workers=1), "points = int"),
    "points": (lambda: fr.sweep(len, [1, 2], workers=1), "points = list"),
    "point-names": (lambda: fr.sweep(len, [{1: 2}], workers=1), "points = list"),
    "point-values": (lambda: fr.sweep(len, {"x": [[1.0], [2.0]]}, workers=1), "points = dict"),
    "table": (lambda: fr.sweep(len, {"x": [1.0]}, workers=1, out=3), "out = int"),
    "dims": (lambda: fr.sweep(len, {"x": [1.0]}, workers=1, dims=3), "dims = int"),
    "executor": (lambda: fr.sweep(len, {"x": [1.0]}, executor=3), "executor = int"),
    "result-name": (
        lambda: fr.sweep(lambda point: {"x": 7.0}, {"x": [1.0]}, workers=1), "result x = 7"
    ),
    "no-c": (lambda: fr.kinetic_relation([], 0.03), "coupling c"),
    "no-eta": (lambda: fr.kinetic_relation(0.5, []), "eta"),
    "values": (lambda: fr.derive_cell("1 - y**2", values=True), "values = bool"),
    "quantities": (lambda: fr.robustness(None), "quantities = NoneType"),
    "quantity": (lambda: fr.robustness(""), "quantity = "),
    "no-number": (
        lambda: fr.OscillatorChain(damping=numba.njit(lambda y, v: np.nan), c=0.1),
        "damping = no number",
    ),
    "claim": (lambda: fr.judge(3), "claim = 3"),
    "longest": (lambda: fr.measure_front(CHAINS["vdp"], max_sites="300"), "longest chain"),
    "excited": (lambda: fr.measure_front(CHAINS["vdp"], excited="24"), "excited sites"),
    "tolerance": (lambda: fr.measure_front(CHAINS["vdp"], tolerance=0.0), "tolerance"),
    "refine": (lambda: fr.state_map(CHAINS["vdp"], c=[0.1], refine="0.1"), "part of the spacing"),
    "slow-time": (lambda: fr.averaging_error(CHAINS["own"], slow_time="3"), "slow time"),
    "compared-start": (lambda: fr.averaging_error(CHAINS["own"], "start"), "start"),
    "no-turns": (lambda: fr.excite(CHAINS["vdp"], [1], quarter_turns=True), "quarter turns"),
    "turn": (lambda: fr.excite(CHAINS["vdp"], [1], quarter_turns=["x"]), "quarter turns"),
    "shape": (lambda: fr.OscillatorChain(damping="y**2 - 1", c=0.1, shape=31), "shape = 31"),
}  # fmt: skip


CHOICES: dict[str, Callable[[Any], object]] = {
    "method of Σ": lambda word: fr.sigma(0.3, 0.5, method=word),
    "method of a front": lambda word: fr.measure_front(CHAINS["vdp"], method=word),
    "method of a breather": lambda word: fr.breather(CHAINS["averaged"], method=word),
    "method of a breather of one's own": lambda word: fr.breather(CHAINS["own"], method=word),
    "method of a branch": lambda word: fr.follow_breather(CHAINS["vdp"], [0.1], method=word),
    "method of a threshold": lambda word: fr.threshold(CHAINS["vdp"], method=word),
    "definition": lambda word: fr.threshold(CHAINS["vdp"], definition=word),
    "reading": lambda word: fr.breather(CHAINS["vdp"], reading=word),
    "left boundary": lambda word: fr.measure_front(CHAINS["vdp"], left_boundary=word),
    "point": lambda word: fr.excite(CHAINS["friction"], [1], point=word),
    "point of a front": lambda word: fr.measure_front(CHAINS["friction"], point=str(word)),
    "law": lambda word: fr.FrictionChain(c=0.02, law=word),
    "ends": lambda word: fr.VdpChain(a=4, b=0.5, c=0.6, ends=word),
}


@pytest.mark.parametrize(
    "word", [3, ["run"], {"run": 1}, np.array([]), np.array("run"), b"run", ""]
)
@pytest.mark.parametrize("name", CHOICES)
def test_a_choice_is_one_of_the_words(name: str, word: Any) -> None:
    with pytest.raises(fr.ParameterError, match="is not allowed: it must be"):
        CHOICES[name](word)


class _BegunError(Exception):
    """Nothing that was asked has been refused."""


def _begun(*_: Any, **__: Any) -> Any:
    raise _BegunError


OF_THRESHOLDS: dict[str, Any] = {
    "final_time": 9.0, "lowest": 0.01, "highest": 0.4, "accuracy": 1e-3, "tests": 3,
    "displacement": 2.0, "start_point": "minimum", "perturbation": 1e-3, "seed": 4,
}  # fmt: skip
NOISE = {"perturbation", "seed"}
READ_BY_THRESHOLDS = {
    "envelope": set(), "orbit": set(), "closed-form": set(), "sweep": NOISE, "hold": NOISE,
    "bisection": {*OF_THRESHOLDS} - NOISE,
}  # fmt: skip


@pytest.mark.parametrize("option", OF_THRESHOLDS)
@pytest.mark.parametrize("method", READ_BY_THRESHOLDS)
def test_an_option_of_another_method_of_thresholds_is_refused(
    method: str, option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for work in ("breather_threshold", "closed_form_threshold", "escape_range", "sweep_threshold",
                 "spreading_threshold"):  # fmt: skip
        monkeypatch.setattr(thresholds, work, _begun)
    chain = CHAINS["friction" if method == "bisection" else "vdp"]
    read = option in READ_BY_THRESHOLDS[method]
    words = None if read else f"{option} = .* absent with the method {method}"
    with pytest.raises(_BegunError if read else fr.ParameterError, match=words):
        fr.threshold(chain, method=method, **{option: OF_THRESHOLDS[option]})
    usual = signature(fr.threshold).parameters[option].default
    with pytest.raises(_BegunError):  # as if it were not given
        fr.threshold(chain, method=method, **{option: usual})


@pytest.mark.parametrize(
    ("option", "given", "methods"),
    [("reading", "tail", {"closed-form", "all"}), ("seed", 4, {"simulation", "all"})],
)
@pytest.mark.parametrize(
    "method", ["envelope", "closed-form", "orbit", "simulation", "all", None, "own"]
)
def test_an_option_of_another_method_of_breathers_is_refused(
    method: Any, option: str, given: Any, methods: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for each in breathers._METHODS:
        monkeypatch.setitem(breathers._METHODS, each, _begun)
    read = method in methods
    chain, how = CHAINS["vdp"], {"method": method}
    if method == "own":
        chain, how = CHAINS["own"], {}
        monkeypatch.setattr(breathers, "OwnOrbits", _begun)
    with pytest.raises(_BegunError if read else fr.ParameterError,
                       match=None if read else f"{option} = .* absent with"):  # fmt: skip
        fr.breather(chain, **how, **{option: given})
    with pytest.raises(_BegunError):
        fr.breather(chain, **how, **{option: signature(fr.breather).parameters[option].default})


FLAGS: dict[str, Callable[[Any], object]] = {
    "stability": lambda flag: fr.kinetic_relation(0.5, 0.03, stability=flag),
    "certify": lambda flag: fr.kinetic_relation(0.5, 0.03, certify=flag),
    "certify of roots": lambda flag: fr.roots(0.3, 0.5, certify=flag),
    "full": lambda flag: fr.judge("fig16-admissible", full=flag),
    "estimate_error": lambda flag: fr.simulate(CHAINS["vdp"], START, 1.0, estimate_error=flag),
    "active_window": lambda flag: fr.simulate(CHAINS["vdp"], START, 1.0, active_window=flag),
    "active_window of friction": lambda flag: fr.simulate(
        CHAINS["friction"], START, 1.0, active_window=flag
    ),
    "left_boundary_wave": lambda flag: fr.simulate(
        CHAINS["vdp"], START, 1.0, left_boundary_wave=flag
    ),
    "resume": lambda flag: fr.sweep(len, {"x": [1.0]}, workers=1, resume=flag),
    "resume of a map": lambda flag: fr.state_map(
        CHAINS["averaged"], c=0.05, workers=1, refine=0, resume=flag
    ),
    "amplitudes": lambda flag: StateTask(chain=CHAINS["averaged"], amplitudes=flag),
    "overdamped": lambda flag: fr.OscillatorChain(damping="y**2 - 1", c=0.1, overdamped=flag),
}


@pytest.mark.parametrize(
    "flag", [np.array([]), np.array([True]), np.array([True, False]), 1, 0.0, "yes", None, []]
)
@pytest.mark.parametrize("name", FLAGS)
def test_a_flag_is_true_or_false(name: str, flag: Any) -> None:
    match = rf"^{name.split(maxsplit=1)[0]} = .* is not allowed: it must be true or false"
    with pytest.raises(fr.ParameterError, match=match):
        FLAGS[name](flag)


NUMBERS: dict[str, Callable[[Any], object]] = {
    "coupling c": lambda one: fr.kinetic_relation(one, 0.03),
    "velocity v": lambda one: fr.roots(one, 0.5),
    "root count": lambda one: fr.roots(0.3, 0.5, count=one),
    "digits": lambda one: fr.roots(0.3, 0.5, digits=one),
    "digits of Sigma": lambda one: fr.sigma(0.3, 0.5, digits=one),
    "excited site": lambda one: fr.excite(CHAINS["vdp"], [one]),
    "nucleus": fr.Nucleus,
    "number of samples": lambda one: fr.simulate(CHAINS["vdp"], START, 1.0, samples=one),
    "end time": lambda one: fr.simulate(CHAINS["vdp"], START, one),
    "number of folds": lambda one: fr.follow_breather(CHAINS["vdp"], [0.1], folds=one),
    "workers": lambda one: fr.sweep(len, {"x": [1.0]}, workers=one),
    "workers of a map": lambda one: fr.state_map(CHAINS["averaged"], c=0.05, refine=0, workers=one),
    "points": lambda one: fr.robustness("c-pin", points=one),
    "runs": lambda one: fr.ensemble(one, CHAINS["vdp"]),
    "seed": lambda one: fr.robustness("c-pin", points=40, seed=one),
    "extent": lambda one: fr.roots(0.3, 0.5, extent=one),
}


AVERAGED, FRICTION, PREPARED = CHAINS["averaged"], CHAINS["friction"], NucleusPreparation(1)
REST = np.zeros((2, 7))
STILL: Any = {"perturbation": 0.0, "seed": 0}
USUAL: Any = {"lowest": 1e-3, "accuracy": 1e-6, "tests": 12}
OUTSIDE: list[tuple[str, Callable[[Any], object], tuple[float, ...]]] = [
    ("nucleus size", lambda one: follow_nucleus(AVERAGED, one, **STILL), (0, 8)),
    ("slow time", lambda one: follow_nucleus(AVERAGED, slow_time=one, **STILL), (0.0, -1.0)),
    (
        "perturbation",
        lambda one: follow_nucleus(AVERAGED, **STILL | {"perturbation": one}),
        (-1e-9, 1.001),
    ),
    ("number of velocities", lambda one: bifurcation([], "v_d", [0.1] * one), (1, 2001)),
    ("tolerance", lambda one: friction_cell(fr.FrictionCell(), one), (9e-15, 1.1e-4)),
    ("belt velocity", lambda one: friction_cell(fr.FrictionCell(v_d=one)), (9e-10,)),
    ("tolerance", lambda one: oscillator_cell(CHAINS["own"], one), (9e-14, 1.1e-6)),
    ("tolerance", lambda one: vdp_cell(4.0, 0.5, 0.1, one), (9e-14, 1.1e-6)),
    ("small parameter", lambda one: vdp_cell(4.0, 0.5, one, 1e-9), (9e-5, 1.1)),
    (
        "end time tau",
        lambda one: find_friction_state(FRICTION, REST, end=one),
        (8.0 * WINDOW - 0.01, 1.001e7),
    ),
    ("tolerance", lambda one: find_friction_state(FRICTION, REST, tolerance=one), (9e-13, 1.1e-4)),
    (
        "tolerance",
        lambda one: find_smooth_state(CHAINS["own"], REST, tolerance=one),
        (9e-14, 1.1e-3),
    ),
    ("tolerance", lambda one: find_vdp_state(AVERAGED, REST, tolerance=one), (9e-14, 1.1e-3)),
    ("end time", lambda one: find_vdp_state(AVERAGED, REST, end=one), (0.0, -1.0)),
    ("end time", lambda one: StateTask(chain=AVERAGED, end=one), (0.0, 1e12)),
    ("tolerance", lambda one: StateTask(chain=AVERAGED, tolerance=one), (9e-14, 1.1e-3)),
    ("perturbation", lambda one: StateTask(chain=AVERAGED, perturbation=one), (-1e-9, 0.0101)),
    ("displacement", lambda one: StateTask(chain=AVERAGED, displacement=one), (-0.1, 100.1)),
    ("accuracy", lambda one: simulate_front(0.5, 0.03125, accuracy=one), (9e-14, 0.011)),
    ("end time tau", lambda one: run_events(FRICTION, REST, one, tolerance=1e-9), (0.0, -1.0)),
    (
        "longest step",
        lambda one: run_events(FRICTION, REST, 1.0, tolerance=1e-9, longest_step=one),
        (0.0, -1.0),
    ),
    ("tolerance", lambda one: run_events(FRICTION, REST, 1.0, tolerance=one), (2.2e-14, 0.011)),
    ("end time tau", lambda one: run_switch(FRICTION, REST, one), (0.0, -1.0)),
    ("stick band", lambda one: run_switch(FRICTION, REST, 1.0, band=one), (0.0, -1.0)),
    (
        "relative tolerance",
        lambda one: run_switch(FRICTION, REST, 1.0, relative=one),
        (9e-14, 0.11),
    ),
    ("absolute tolerance", lambda one: run_switch(FRICTION, REST, 1.0, absolute=one), (0.0, -1.0)),
    ("number of samples", lambda one: run_switch(FRICTION, REST, 1.0, samples=one), (1, 1_000_001)),
    ("duration", lambda one: escape_range(AVERAGED, PREPARED, one), (0.0, -1.0)),
    ("tolerance", lambda one: escape_range(AVERAGED, PREPARED, tolerance=one), (0.0, -1.0)),
    ("number of seeds", lambda one: escape_range(AVERAGED, PREPARED, seeds=one), (0, 101)),
    (
        "perturbation",
        lambda one: fr.threshold(AVERAGED, method="sweep", perturbation=one),
        (-1e-9, 0.1001),
    ),
    ("sweep rate", lambda one: sweep_envelope(AVERAGED, PREPARED, one), (0.0, -1.0)),
    ("nucleus size", Spreading, (0, 100_001)),
    ("final time", lambda one: Spreading(final_time=one), (0.99, 1.01e6)),
    ("tolerance", lambda one: Spreading(tolerance=one), (9e-13, 1.1e-4)),
    (
        "lowest coupling",
        lambda one: spreading_threshold(FRICTION, Spreading(), **USUAL | {"lowest": one}),
        (0.0, -1.0, 1e6),
    ),
    (
        "highest coupling",
        lambda one: spreading_threshold(
            FRICTION, Spreading(), **USUAL | {"highest": one, "lowest": 0.1}
        ),
        (0.1009, 1.1e6),
    ),
    (
        "accuracy",
        lambda one: spreading_threshold(FRICTION, Spreading(), **USUAL | {"accuracy": one}),
        (9e-13, 0.11),
    ),
    (
        "tolerance",
        lambda one: spreading_threshold(FRICTION, Spreading(tolerance=one), **USUAL),
        (9.9e-11,),
    ),
    (
        "tests of monotonicity",
        lambda one: spreading_threshold(FRICTION, Spreading(), **USUAL | {"tests": one}),
        (-1, 10_001),
    ),
]  # fmt: skip
"""Numbers below and above a range."""


@pytest.mark.parametrize(
    ("quantity", "ask", "one"), [(name, ask, one) for name, ask, all_ in OUTSIDE for one in all_]
)
def test_a_number_outside_its_range_is_refused(
    quantity: str, ask: Callable[[Any], object], one: float
) -> None:
    with pytest.raises(fr.ParameterError, match=f"^{quantity}.* = .* is not allowed: it must be"):
        ask(one)


@pytest.mark.parametrize("one", [True, np.True_, np.array(True), np.array([True])])
@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_is_no_truth_value(name: str, one: Any) -> None:
    with pytest.raises(fr.ParameterError, match="is not allowed: it must be"):
        NUMBERS[name](one)


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_asked_for_is_refused_in_a_sentence(name: str) -> None:
    ask, quantity = REFUSED[name]
    with pytest.raises(fr.ParameterError, match=f"^{quantity}.* is not allowed: it must be"):
        ask()


@pytest.mark.parametrize("axis", ["ends", "law", "coupling", "eta", "foo"])
@pytest.mark.parametrize("model", ["vdp", "averaged", "friction", "own"])
def test_the_axes_that_a_refusal_names_are_taken_by_maps(model: str, axis: str) -> None:
    """They are numbers, so that the chain itself, or one of constant damping, is a point."""
    task = StateTask(chain=CHAINS[model])
    if axis == "eta" and model in ("vdp", "averaged"):
        return
    with pytest.raises(fr.ParameterError, match=f"^axis = {axis} .* must be one of ") as refused:
        fr.state_map(task, **{axis: [1.0]})
    named = re.search("one of (.*);", str(refused.value))
    axes = named[1].split(", ")
    assert {"c", "sites"} <= {*axes}
    for name in axes:
        own = getattr(task.chain, name)
        at = 1.0 if isinstance(own, str) else float(own)  # a damping is text, or a number
        assert isinstance(task.at({name: at}), type(task.chain))


def test_a_whole_number_of_any_size_is_exact() -> None:
    found = fr.derive_cell("1 - 4*y**2", coupling=10**400)
    assert str(10**400) in str(found.equation)


def test_a_result_that_repeats_a_coordinate_changes_nothing() -> None:
    table = fr.sweep(lambda point: {"x": point["x"], "y": 2.0}, {"x": [1.0, 3.0]}, workers=1)
    assert {name: column.tolist() for name, column in table.columns().items()} == {
        "x": [1.0, 3.0], "y": [2.0, 2.0]
    }  # fmt: skip


def test_files_may_be_named_by_text(tmp_path: Path) -> None:
    map_file, checkpoint = tmp_path / "map.csv", tmp_path / "run.npz"
    found = fr.state_map(CHAINS["averaged"], c=0.05, workers=1, refine=0, out=str(map_file))
    assert found.counts == {"breather": 1}
    assert map_file.exists()
    run = fr.simulate(CHAINS["vdp"], START, 1.0, checkpoint=str(checkpoint))
    assert run.times[-1] == 1.0


def test_a_nucleus_wider_than_its_chain_is_refused_for_that_and_not_for_its_pattern() -> None:
    chain = fr.VdpChain(a=2.5, b=0.5, c=0.1, sites=9)
    with pytest.raises(fr.ParameterError, match=r"nucleus = 20 .* at most the 9 sites"):
        fr.breather(chain, nucleus=fr.Nucleus(20))


@pytest.mark.parametrize("size", [4, 6])
def test_the_pattern_that_is_advised_for_an_even_nucleus_has_a_breather(size: int) -> None:
    chain = fr.VdpChain(a=2.5, b=0.5, c=0.1, sites=size + 8)
    with pytest.raises(fr.ParameterError) as refused:
        fr.breather(chain, nucleus=fr.Nucleus(size))
    pattern = str(refused.value).split("'")[1]
    assert fr.breather(chain, nucleus=fr.Nucleus(size, pattern)).status.value == "exists"


def test_a_seed_that_no_generator_takes_is_refused_in_a_sentence() -> None:
    chain = fr.VdpChain(a=2.5, b=0.5, c=0.1)
    with pytest.raises(fr.ParameterError, match="seed = -1"):
        fr.breather(chain, method="simulation", seed=-1)
    with pytest.raises(fr.ParameterError, match="seed = -1"):
        fr.threshold(chain, fr.Nucleus(3), method="hold", perturbation=1e-3, seed=-1)


@pytest.mark.parametrize("c", [None, [0.5, None]])
def test_none_among_numbers_is_named(c: Any) -> None:
    with pytest.raises(fr.ParameterError, match=r"coupling c = .*None.* a number or numbers"):
        fr.kinetic_relation(c=c, eta=0.03)


def test_a_fold_that_does_not_exist_has_no_error() -> None:
    chain = fr.VdpChain(a=2.5, b=0.5, c=0.1)
    found = fr.breather(chain, method="closed-form", reading="centre")
    assert (found.fold, found.fold_error) == (None, None)


def test_a_claim_that_does_not_exist_is_refused_with_one_full_stop() -> None:
    with pytest.raises(fr.ParameterError, match=r"claim = nope .* shows all\.$"):
        fr.judge("nope")


@pytest.mark.parametrize("v", [0.3, 100.0])
def test_a_value_of_the_sum_is_a_complex_number_of_python(v: float) -> None:
    assert type(fr.sigma(v=v, c=3.0).value) is complex


@pytest.mark.parametrize("certify", [True, False])
def test_certified_radii_are_the_reason_for_few_digits_only_where_they_are_asked_for(
    certify: bool,
) -> None:
    with pytest.raises(fr.ParameterError, match=r"^digits = 100000 ") as refused:
        fr.roots(0.3, 0.5, digits=100_000, certify=certify)
    assert ("certified" in str(refused.value)) is certify


@pytest.mark.parametrize("names", [("tests", "reading"), ("reading", "tests")])
def test_of_several_options_without_effect_the_first_is_named(names: tuple[str, str]) -> None:
    with pytest.raises(fr.ParameterError, match=f"^{names[0]} = 1 "):
        refuse_unread(dict.fromkeys(names, 1), dict.fromkeys(names, 0), (), "here")
