"""Every argument of every public function refuses an object of the wrong kind in one sentence."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from inspect import Parameter, isclass, signature
from pathlib import Path
from typing import Any

import pytest

import fronts as fr

KINDS: dict[str, Any] = {"3": 3, "x": "x", "None": None, "[]": [], "object": object()}

CELL = fr.FrictionCell()
FULL = fr.VdpChain(a=4, b=0.5, c=0.05, sites=7)
AVERAGED = fr.AveragedChain(a=4, b=0.5, c=0.05, sites=7)
FRICTION = fr.FrictionChain(c=0.02, sites=31)
OWN = fr.OscillatorChain(
    damping=0, stiffness="y*(1 - y)*(alpha - y)", values={"alpha": 0.2},
    disorder={"alpha": 0.1}, overdamped=True, c=0.1, sites=4,
)  # fmt: skip
START = fr.excite(FULL, [1])
NONE: tuple[str, ...] = ("None",)
NUMBER: tuple[str, ...] = ("3",)
WORD: tuple[str, ...] = ("x",)
MAYBE = (*NUMBER, *NONE)


@dataclass(frozen=True)
class Call:
    """A function with arguments that it takes, and for some the kinds that it takes as well."""

    function: Callable[..., Any]
    arguments: dict[str, Any]
    taken: dict[str, tuple[str, ...]]


def _cell(**more: Any) -> dict[str, Any]:
    numbers = {name: getattr(CELL, name) for name in ("v_d", "mu_st", "mu_d", "v0", "xi", "v_s")}
    return {**numbers, "law": "exponential", "viscous": 0.0, **more}


_CELL_TAKES = dict.fromkeys(("v_d", "mu_st", "v0", "xi", "v_s", "viscous"), NUMBER)


def _smooth(**more: Any) -> dict[str, Any]:
    return {"a": 4, "b": 0.5, "c": 0.1, "eps": 0.01, "sites": 7, "ends": "free", **more}


_SMOOTH_TAKES = dict.fromkeys(("a", "b", "c", "eps", "sites"), NUMBER)


def _judge(key: Any, **options: Any) -> object:
    """Judge one claim, which can then be named as an argument."""
    return fr.judge(key, **options)


FRONT_OPTIONS = (
    "accuracy", "tolerance", "excited", "max_sites", "stall_time", "directions", "progress",
)  # fmt: skip

CALLS: dict[str, Call] = {
    "animate": Call(
        fr.animate,
        {
            "run": fr.simulate(FULL, START, 1.0, samples=2, estimate_error=False),
            "path": Path("film.gif"), "frames_per_second": 15.0, "note": "", "progress": None,
        },
        {"frames_per_second": NUMBER, "note": WORD, "progress": NONE},
    ),
    "follow_breather": Call(
        fr.follow_breather,
        {
            "chain": AVERAGED, "couplings": [0.01], "nucleus": fr.Nucleus(1), "method": "envelope",
            "folds": 1,
        },
        {"method": NONE, "folds": NUMBER},
    ),
    "follow_front": Call(
        fr.follow_front, {"chain": AVERAGED, "couplings": [0.05], "etas": None}, {"etas": NONE}
    ),
    "follow_front in eta": Call(
        fr.follow_front, {"chain": AVERAGED, "couplings": None, "etas": [0.1]}, {"couplings": NONE}
    ),
    "derivation": Call(fr.derivation, {"of": 50, "order": 1}, {"of": NUMBER}),
    "derive_cell": Call(
        fr.derive_cell,
        {"damping": "1 - 4*y**2", "stiffness": "y", "coupling": "c", "values": {}},
        {"damping": WORD, "stiffness": NONE, "coupling": ("3", "x"), "values": NONE},
    ),
    "judge": Call(
        _judge, {"key": "fig16-limits", "workers": 1, "full": False}, {"workers": NUMBER}
    ),
    "robustness": Call(
        fr.robustness,
        {"quantities": ["c-pin"], "points": 12, "seed": 0, "workers": 1},
        {"quantities": ("[]",), "points": NUMBER, "seed": NUMBER, "workers": MAYBE},
    ),
    "kinetic_relation": Call(
        fr.kinetic_relation,
        {
            "c": 0.2, "eta": 0.03, "a": None, "b": None, "stability": False, "certify": False,
            "progress": None,
        },
        {"c": NUMBER, "eta": NUMBER, "a": NONE, "b": NONE, "progress": NONE},
    ),
    "kinetic_relation of a and b": Call(
        fr.kinetic_relation, {"c": 0.2, "a": 4.0, "b": 0.5}, {"c": NUMBER, "a": NUMBER, "b": NUMBER}
    ),
    "front_profile": Call(
        fr.front_profile,
        {
            "c": 0.5, "eta": 0.03, "a": None, "b": None, "branch": 1, "low": -1.0, "high": 1.0,
            "points": 5,
        },
        {
            "c": NUMBER, "eta": NUMBER, "a": NONE, "b": NONE, "branch": NONE, "high": NUMBER,
            "points": NUMBER,
        },
    ),
    "roots": Call(
        fr.roots,
        {
            "v": 0.3, "c": 0.5, "count": 2, "extent": None, "digits": 15, "certify": False,
            "progress": None,
        },
        {
            "v": NUMBER, "c": NUMBER, "count": MAYBE, "extent": NONE, "digits": NUMBER,
            "progress": NONE,
        },
    ),
    "roots by extent": Call(fr.roots, {"v": 0.3, "c": 0.5, "extent": 5.0}, {
        "v": NUMBER, "c": NUMBER, "extent": MAYBE,
    }),
    "sigma": Call(
        fr.sigma,
        {"v": 0.3, "c": 0.5, "method": "integral", "digits": 12},
        {"v": NUMBER, "c": NUMBER, "digits": NUMBER},
    ),
    "FrictionCell": Call(fr.FrictionCell, _cell(), _CELL_TAKES),
    "FrictionChain": Call(
        fr.FrictionChain, _cell(c=0.1, sites=7, ends="free"),
        {**_CELL_TAKES, "c": NUMBER, "sites": NUMBER},
    ),
    "Nucleus": Call(
        fr.Nucleus,
        {"size": 2, "pattern": "", "place": "bulk", "relaxed_from": ""},
        {"size": NUMBER, "pattern": WORD, "relaxed_from": WORD},
    ),
    "OscillatorChain": Call(
        fr.OscillatorChain,
        {
            "damping": "a*y**2 - 1", "c": 0.1, "stiffness": "y", "values": {"a": 1.0},
            "coupling": "chain", "eps": 0.01, "velocity_coupling": 0.0, "overdamped": False,
            "disorder": {}, "seed": 0, "drive": (), "sites": 7, "ends": "free", "shape": None,
        },
        {
            "damping": NUMBER, "c": NUMBER, "stiffness": NUMBER, "eps": NUMBER,
            "velocity_coupling": NUMBER, "disorder": ("[]",), "seed": NUMBER, "drive": ("[]",),
            "sites": MAYBE, "shape": NONE,
        },
    ),
    "PiecewiseChain": Call(
        fr.PiecewiseChain, {"c": 0.5, "eta": 0.03, "a": None, "b": None},
        {"c": NUMBER, "a": NONE, "b": NONE},
    ),
    "AveragedChain": Call(fr.AveragedChain, _smooth(), _SMOOTH_TAKES),
    "VdpChain": Call(fr.VdpChain, _smooth(), _SMOOTH_TAKES),
    "breather": Call(
        fr.breather,
        {
            "chain": AVERAGED, "nucleus": fr.Nucleus(1), "method": "envelope",
            "reading": "neighbour", "seed": 0,
        },
        {"method": NONE},
    ),
    "cell": Call(
        fr.cell, {"of": CELL, "tolerance": 1e-8, "progress": None}, {"progress": NONE}
    ),
    "cell of a chain": Call(
        fr.cell, {"of": FULL, "tolerance": 1e-8, "progress": None}, {"progress": NONE}
    ),
    "Progress": Call(
        fr.Progress,
        {"name": "run", "steps": 0, "at_once": 1, "quiet": False, "stream": None},
        {"name": WORD, "steps": NUMBER, "at_once": NUMBER, "stream": NONE},
    ),
    "sweep": Call(
        fr.sweep,
        {
            "function": len, "points": {"x": [1.0]}, "out": None, "resume": False, "workers": 1,
            "executor": None, "dims": None, "progress": None, "command": "",
        },
        {
            "points": ("[]",), "out": ("x", "None"), "workers": MAYBE, "executor": NONE,
            "dims": NONE, "progress": NONE, "command": WORD,
        },
    ),
    "measure_front": Call(
        fr.measure_front,
        {
            "chain": AVERAGED, "method": "run", **dict.fromkeys(FRONT_OPTIONS),
            "left_boundary": "free", "point": "maximum",
        },
        {**dict.fromkeys(FRONT_OPTIONS, NONE), "stall_time": MAYBE},
    ),
    "measure_front of friction": Call(
        fr.measure_front,
        {
            "chain": FRICTION, "method": "run", **dict.fromkeys(FRONT_OPTIONS),
            "left_boundary": "free", "point": "maximum",
        },
        {
            **dict.fromkeys(FRONT_OPTIONS, NONE), "excited": MAYBE, "stall_time": MAYBE,
            "point": NUMBER,
        },
    ),
    "measure_front of (44)": Call(
        fr.measure_front,
        {"chain": fr.PiecewiseChain(c=0.2, eta=0.03), "accuracy": None, "max_sites": None},
        {"accuracy": NONE, "max_sites": NONE},
    ),
    "state_map": Call(
        fr.state_map,
        {
            "what": AVERAGED, "refine": 0.0, "workers": 1, "executor": None, "out": None,
            "resume": False, "progress": None, "c": [0.05],
        },
        {
            "workers": MAYBE, "executor": NONE, "out": ("x", "None"), "progress": NONE,
            "c": NUMBER,
        },
    ),
    "averaging_error": Call(
        fr.averaging_error,
        {"chain": FULL, "start": None, "slow_time": 3.0, "halvings": 2},
        {"start": NONE, "slow_time": NUMBER, "halvings": NUMBER},
    ),
    "ensemble": Call(
        fr.ensemble,
        {"function": len, "chain": OWN, "seeds": [0], "workers": 1, "progress": None},
        {"workers": MAYBE, "progress": NONE},
    ),
    "excite": Call(
        fr.excite,
        {
            "chain": FULL, "sites": [1], "displacement": None, "quarter_turns": None,
            "point": "maximum",
        },
        {"displacement": MAYBE, "quarter_turns": NONE},
    ),
    "simulate": Call(
        fr.simulate,
        {
            "chain": FULL, "start": START, "t_end": 1.0, "tolerance": None, "samples": None,
            "times": None, "level": None, "estimate_error": False, "checkpoint": None,
            "progress": None, "budget": None, "active_window": False, "trailing_sites": 0,
            "left_boundary_wave": False,
        },
        {
            **dict.fromkeys(("tolerance", "times", "progress"), NONE), "checkpoint": ("x", "None"),
            **dict.fromkeys(("samples", "level", "budget"), MAYBE), "t_end": NUMBER,
            "trailing_sites": NUMBER,
        },
    ),
    "threshold": Call(
        fr.threshold,
        {
            "chain": FRICTION, "nucleus": fr.Nucleus(1), "method": "bisection",
            "definition": "first", "final_time": 20.0, "lowest": 0.001, "highest": 0.5,
            "accuracy": 0.1, "tests": 0, "displacement": None, "start_point": None,
            "perturbation": 0.0, "seed": 0, "progress": None,
        },
        {
            **dict.fromkeys(("method", "definition", "start_point", "progress"), NONE),
            "final_time": NUMBER, "highest": NUMBER, "tests": NUMBER, "displacement": MAYBE,
        },
    ),
}  # fmt: skip
"""A call of each public function, beside which only the kinds that are named are taken."""


def _public() -> dict[str, Callable[..., Any]]:
    """Return the public functions and classes, without errors and the base class of results."""
    found = {name: getattr(fr, name) for name in fr.__all__}
    return {
        name: each
        for name, each in found.items()
        if callable(each)
        and each is not fr.Result
        and not (isclass(each) and issubclass(each, Exception))
    }


def test_there_is_a_call_with_every_argument_of_every_public_function() -> None:
    for name, function in _public().items():
        named = [call.arguments for each, call in CALLS.items() if each.split()[0] == name]
        given = {argument for arguments in named for argument in arguments}
        fixed = {
            parameter.name
            for parameter in signature(function).parameters.values()
            if parameter.kind not in (Parameter.VAR_KEYWORD, Parameter.VAR_POSITIONAL)
        }
        assert fixed <= given, name


@pytest.mark.parametrize("name", CALLS)
def test_an_argument_of_the_wrong_kind_is_refused_in_one_sentence(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    call = CALLS[name]
    for argument in call.arguments:
        for kind, given in KINDS.items():
            if kind in call.taken.get(argument, ()):
                continue
            refusal = _refusal(call, argument, given)
            assert _is_one_sentence(refusal), f"{argument} = {kind}: {refusal or 'taken'}"
    assert not [*tmp_path.iterdir()]


def _refusal(call: Call, argument: str, given: object) -> str:
    """Return the refusal of a call with this argument; empty if there is none."""
    try:
        call.function(**{**call.arguments, argument: given})
    except (fr.ParameterError, fr.DerivationInputError) as refused:
        return str(refused)
    return ""


def _is_one_sentence(refusal: str) -> bool:
    """Return whether a refusal names quantity, value, range and remedy, in words of its own."""
    form = r"[^.;\n]+ = .* is not allowed: it must be .+; [^;\n]+[^.]\."
    return bool(re.fullmatch(form, refusal)) and "' object is not" not in refusal
