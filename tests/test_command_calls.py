"""Which call of the library a command line becomes; nothing is computed here."""

import argparse
import dataclasses
import functools
import inspect
import json
import re
import shlex
from contextvars import copy_context
from pathlib import Path

import numpy as np
import pytest

from fronts import bound, cli, curves, derived
from fronts.answer import UsageError
from fronts.arguments import is_range, real_or_range
from fronts.bound import BoundCall, located
from fronts.branches import follow_breather
from fronts.catalogue import COMMANDS, EVERY
from fronts.cli import main
from fronts.curves import Refusal
from fronts.initial_state import prepared
from fronts.options import QUIET, Group
from fronts.output import MAX_LINES, beside_files, check_output, command_line
from fronts.piecewise.sigma import sigma
from fronts.signatures import REQUIRED, Described, described
from theory import chains
from theory.cells.friction import FrictionCell
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.chains.oscillator import AveragedOscillatorChain, OscillatorChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError, Range
from verification.breathers.breather import breather
from verification.execution import progress
from verification.execution.metadata import COMMAND_LINE
from verification.fronts.switchings import front_by_switchings
from verification.runs import simulate
from verification.runs.excite import StartPoint, as_psi
from verification.thresholds import threshold as thresholds
from verification.thresholds.result import ThresholdMethod
from verification.thresholds.threshold import threshold

OF_THE_LIBRARY = {
    where
    for command in COMMANDS.values()
    for call in command.calls.values()
    for where in (call.function, getattr(call, "curve", ""))
} - {""}


class CalledError(Exception):
    """Raised in place of an answer."""


@pytest.fixture
def called(monkeypatch):
    """Give a function of a command line that returns the arguments of the call behind it."""
    seen = []

    def stand_in(function):
        @functools.wraps(function)
        def call(*args, **options):
            seen.append((args, options, COMMAND_LINE.get()))
            raise CalledError

        return call

    def instead(where):
        return stand_in(located(where)) if where in OF_THE_LIBRARY else located(where)

    monkeypatch.setattr(bound, "located", instead)
    monkeypatch.setattr(derived, "located", instead)
    monkeypatch.setattr(curves, "curve", stand_in(curves.curve))

    def of(line):
        seen.clear()
        main(shlex.split(line))
        (found,) = seen
        return found

    return of


def bound_to(line):
    name, model = line.split()
    calls = COMMANDS[name].calls
    return BoundCall(calls.get(model, calls.get(EVERY)), model)


@pytest.mark.parametrize(
    ("line", "sites", "nucleus"),
    [
        ("breather --c 0.1", 15, Nucleus(1)),
        ("breather --c 0.1 --nucleus 3", 17, Nucleus(3, pattern="00")),
        ("breather --c 0.1 --nucleus 3 --n 9 --pattern=-+", 9, Nucleus(3, pattern="-+")),
        ("breather averaged --c 0.1 --place edge", 15, Nucleus(1, place=Place.EDGE)),
    ],
)
def test_a_nucleus_is_given_where_an_option_is_and_the_chain_is_seven_sites_longer_on_each_side(
    called, line, sites, nucleus
):
    (chain,), options, _ = called(line)
    assert chain.sites == sites
    assert options.get("nucleus") == nucleus


@pytest.mark.parametrize(
    ("line", "held", "a", "b"),
    [
        ("map averaged", "b", 4.0, 0.5),
        ("map vdp --a 3", "a", 3.0, 0.5),
        ("map averaged --b 0.7", "b", 4.0, 0.7),
    ],
)
def test_of_a_and_b_a_map_holds_the_one_that_is_given(called, line, held, a, b):
    (chain,), options, _ = called(line)
    assert (options["held"], chain.a, chain.b) == (held, a, b)
    assert {name: len(values) for name, values in options["axes"].items()} == {"eta": 14, "c": 20}
    assert (options["axes"]["eta"][-1], options["axes"]["c"][0]) == (0.14, 0.05)
    assert chain.c == 0.05
    assert callable(options["progress"])


def test_a_breather_is_that_of_the_figures_where_nothing_is_said(called):
    (chain,), _, _ = called("breather")
    assert (chain.model, chain.a, chain.b, chain.c) == ("vdp", 2.5, 0.5, 0.1)


def test_a_map_of_two_ranges_is_a_plane(called):
    """What has a range by default keeps the chain's own value, or must be given."""
    (chain,), options, _ = called("map friction --c 0.01:0.05:3 --xi 0.03:0.06:2")
    assert {name: len(values) for name, values in options["axes"].items()} == {"c": 3, "xi": 2}
    assert chain.v_d == 1.25
    (chain,), options, _ = called("map averaged --c 0.1:0.3:3 --a 2:4:2 --b 0.3")
    assert {name: len(values) for name, values in options["axes"].items()} == {"c": 3, "a": 2}
    assert chain.b == 0.3
    assert "held" not in options
    _, options, _ = called("map friction --xi 0.03:0.06:2")
    assert [*options["axes"]] == ["c", "xi"]
    _, options, _ = called("map averaged --a 4 --b 0.5 --c 0.1:0.2:2 --eps 0.01:0.02:2")
    assert [*options["axes"]] == ["c", "eps"]


def test_a_map_of_two_ranges_without_a_coupling_asks_for_it(capsys):
    for line in (
        "friction --xi 0.03:0.06:2 --v-d 1.2:1.3:2",
        "averaged --eta 0.1:0.12:2 --eps 1:2:2",
    ):
        assert main(["map", *line.split()]) == 2
        assert capsys.readouterr().err.startswith("fronts: give --c too: ")


def test_axes_of_a_map_are_what_is_a_range_and_what_the_command_names(called):
    (chain,), options, _ = called("map vdp --eta 0.05 --c 0.1:0.3:3 --eps 0.01:0.1:2")
    assert options["axes"] == {"eta": [0.05], "c": [0.1, 0.2, 0.3], "eps": [0.01, 0.1]}
    assert chain.eps == 0.01
    _, options, _ = called("map friction --c 0.02")
    assert options["axes"]["c"] == [0.02]
    assert len(options["axes"]["v_d"]) == 21


def test_of_the_files_a_map_gets_the_one_that_can_be_resumed(called, tmp_path):
    line = f"map averaged -o {tmp_path}/m.png"
    assert called(line)[1]["out"] is None
    assert called(f"{line} --out {tmp_path}/m.csv")[1]["out"] == tmp_path / "m.csv"


def test_a_map_gets_the_nucleus_that_is_named_and_else_that_of_the_figure(called):
    assert "nucleus" not in called("map friction --c 0.01:0.05:3")[1]
    assert called("map friction --c 0.01:0.05:3 --nucleus 3")[1]["nucleus"].size == 3


@pytest.mark.parametrize(
    ("function", "name", "choices"),
    [
        (sigma, "method", ("integral", "series", "bessel", "quadrature", "certified")),
        (follow_breather, "method", ("orbit", "envelope")),
        (breather, "method", ("envelope", "closed-form", "orbit", "simulation", "all")),
        (front_by_switchings, "start", ("moving", "resting", "step")),
        (sigma, "v", ()),
    ],
)
def test_words_that_an_annotation_lists_are_the_choices_of_an_option(function, name, choices):
    (found,) = (each for each in described(function) if each.name == name)
    assert (found.kind == "choice", found.choices) == (bool(choices), choices)


_RUNS = {"chain.a": 2.5, "chain.b": 0.5, "chain.c": 0.1, "t_end": 2000.0}
_MAPS = {"chain.sites": 16, "eta": (0.01, 0.14, 14), "c": (0.05, 1.0, 20)}
_BREATHERS = {"chain.a": 2.5, "chain.b": 0.5, "chain.c": 0.1}
_FIG_7 = {"chain.a": 2.5, "chain.b": 0.5}
OF_THE_FIGURES = {
    "front vdp": {"chain.sites": 32},
    "front averaged": {"chain.sites": 32},
    "front friction": {"chain.sites": 101},
    "simulate vdp": _RUNS,  # _VDP_RUN
    "simulate averaged": _RUNS,
    "simulate friction": {"chain.c": 0.02, "t_end": 1000.0},
    "simulate *": {"t_end": 1000.0},
    "cell vdp": _FIG_7,  # _VDP_CELL
    "cell averaged": _FIG_7,
    "map vdp": _MAPS,  # _VDP_MAP
    "map averaged": _MAPS,
    "map friction": {"c": (0.0, 0.1, 21), "v_d": (1.0, 2.0, 21)},
    "breather vdp": _BREATHERS,  # _VDP_BREATHER
    "breather averaged": _BREATHERS,
    "threshold vdp": _FIG_7,  # _VDP_THRESHOLD
    "threshold averaged": _FIG_7,
}
"""What the calls of a command take where nothing is said, by command and model."""


def test_a_command_takes_what_the_figures_have_where_nothing_is_said():
    found = {
        f"{name} {model}": {**call.presets, **getattr(call, "axes", {})}
        for name, command in COMMANDS.items()
        for model, call in command.calls.items()
    }
    assert {name: said for name, said in found.items() if said} == OF_THE_FIGURES


def test_what_belongs_to_some_methods_of_a_command_is_named_with_methods_that_it_has():
    """In tables of their own, as _VDP_THRESHOLD and _OF_RUNNING_FRONTS."""
    checked = set()
    for command in COMMANDS.values():
        for model, call in command.calls.items():
            for name, methods in getattr(call, "only", {}).items():
                own = {each.name: each for each in BoundCall(call, model).own.parameters}
                assert {name, "method"} <= {*own}
                assert {*methods} < {*own["method"].choices}
                checked.add(name)
    assert {"perturbation", "tests", "reading", "accuracy"} <= checked
    sites = COMMANDS["threshold"].calls["vdp"].fixed["sites"]
    assert sites == inspect.signature(VdpChain).parameters["sites"].default


def test_a_curve_gets_the_number_of_processes(called):
    line = "front vdp --c 0.5:1:3 --eta 0.05"
    assert [called(line + more)[1]["workers"] for more in ("", " --workers 2")] == [1, 2]


def test_eta_stands_for_a_and_b(called):
    (chain,), _, _ = called("front vdp --c 0.6 --eta 0.05")
    assert (chain.a, chain.b, chain.sites) == (1.0, 0.05, 32)


def test_a_run_gets_its_start_and_a_file_its_command(called, tmp_path):
    (chain,), options, said = called(f"simulate vdp --n 5 --excite 2,3 -o {tmp_path}/r.npz")
    assert chain.sites == 5
    assert np.count_nonzero(options["start"].any(axis=0)) == 2
    assert options["t_end"] == 2000.0
    assert said == "fronts simulate vdp --n 5 --excite 2,3"


def test_a_run_takes_the_usual_time_of_its_model_where_none_is_said(called):
    own = "chain --damping y**2-1 --c 0.5"
    for model, t_end in (("averaged", 2000.0), ("friction", 1000.0), (own, 1000.0)):
        assert called(f"simulate {model} --n 5 --excite 2")[1]["t_end"] == t_end


def test_a_range_becomes_a_curve_of_chains(called):
    (_, chains, along, values, own), options, _ = called("front vdp --c 0.5:1:3 --eta 0.05")
    assert [chain.c for chain in chains] == [0.5, 0.75, 1.0] == values
    assert (along, own, options["workers"]) == ("c", {}, 1)
    _, options, _ = called("front vdp --c 0.5:1:5 --eta 0.05 --jobs 2")
    assert options["workers"] == 2


def test_a_range_of_eta_becomes_chains_of_that_eta_and_the_a_that_is_held(called):
    (_, chains, along, values, _), _, _ = called("front vdp --c 0.6 --eta 0.02:0.06:3")
    assert along == "eta"
    assert values == [0.02, 0.04, 0.06] == [chain.b / chain.a**2 for chain in chains]
    assert {(chain.a, chain.c) for chain in chains} == {(1.0, 0.6)}
    (_, chains, *_), _, _ = called("front piecewise --c 0.5 --eta 0.02:0.06:3")  # of eta alone
    assert [chain.eta for chain in chains] == values


@pytest.mark.parametrize(
    "model", ["vdp --a 4 --b 0.5", "friction --v-d 1.2", "chain --damping 'y**2 - 1'"]
)
def test_a_cell_is_one_without_neighbours_that_pull_it(model, called):
    ((chain,), _, _) = called(f"cell {model}")
    assert getattr(chain, "c", 0.0) == getattr(chain, "velocity_coupling", 0.0) == 0.0


@pytest.mark.parametrize("count", [7, 8, 9, 10])
def test_a_run_starts_from_the_middle_as_a_nucleus_of_one_does(count):
    for chain in (
        AveragedChain(a=4.0, b=0.5, c=0.6, sites=count),
        FrictionChain(c=0.1, sites=count),
    ):
        start = prepared(chain)
        place = Place.EDGE if isinstance(chain, FrictionChain) else Place.BULK
        (site,) = Nucleus(1, place=place).excited(count)
        assert start.parameters["sites"] == [site]
        moved = prepared(chain, displacement=1.5, perturbation=1e-3)
        assert moved.parameters["displacement"] == pytest.approx(1.5)
        assert moved.parameters["seed"] == 1
        assert prepared(chain, perturbation=1e-3, seed=7).parameters["seed"] == 7
        for point in (None, StartPoint.MAXIMUM):
            named = prepared(chain, start_point=point).parameters
            assert named.get("start_point") is point
            assert ("start_point" in named) == (point is not None)
        away = np.abs(start.state - np.median(start.state, axis=1, keepdims=True)).max(axis=0)
        assert np.argmax(away) == site - 1


def test_a_range_of_a_function_without_a_chain_becomes_its_values(called):
    _, options, _ = called("kinetic --c 0.3:0.5:3 --eta 0.03125")
    assert (options["c"], options["eta"]) == ([0.3, 0.4, 0.5], 0.03125)


def test_a_curve_that_can_be_followed_gets_both_ends_the_parameter_and_its_values(called):
    (chains, along, values), options, _ = called(
        "front averaged --c 0.5:1:3 --eta 0.05 --method wave"
    )
    assert ([chain.c for chain in chains], along, values) == ([0.5, 1.0], "c", [0.5, 0.75, 1.0])
    assert callable(options.pop("progress"))
    assert options == {"method": "wave"}


def test_what_is_given_beside_a_model_file_holds(called, tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text('damping = "1 - 4*y**2 + y**4/2"\nc = 0.6\nsites = 9\n')
    (chain,), _, _ = called(f"simulate chain --model {file} --c 0.7")
    assert (chain.c, chain.sites, chain.damping) == (0.7, 9, "1 - 4*y**2 + y**4/2")


def test_options_of_a_method_go_with_it_and_with_all(called):
    for method in ("simulation", "all"):
        _, options, _ = called(f"breather --c 0.1 --method {method} --seed 3")
        assert options["seed"] == 3


def test_noise_goes_with_both_methods_that_run_the_averaged_chain(called):
    for method in ("sweep", "hold"):
        line = f"threshold vdp --method {method} --perturbation 1e-4 --seed 5"
        _, options, _ = called(line)
        assert (options["perturbation"], options["seed"]) == (1e-4, 5)
        assert options["method"] is ThresholdMethod(method)  # a member, not its word


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("threshold vdp --method orbit --seed 3", "--seed is for --method sweep or hold"),
        ("threshold vdp --method orbit --tests 3", "--tests is for --method bisection"),
        ("breather --c 0.1 --method orbit --seed 3", "--seed is for --method simulation"),
        ("breather --c 0.1 --seed 3", "--seed is for --method simulation"),
        (
            "front averaged --c 0.6 --eta 0.05 --method wave --accuracy 0.1",
            "--accuracy is for --method run",
        ),
        ("map vdp --a 3 --b 0.5", "--b is not allowed with --a while eta varies"),
        ("front vdp --c 0.6", "give --eta, or both --a and --b"),
        ("front vdp --c 0.6 --a 4", "give --eta, or both --a and --b"),
        ("front vdp --c 0.6 --a 4 --eta 0.05", "determines the same ratio"),
        ("front vdp --c 0.6 --eta -0.1:0.06:3", "eta = "),
        ("front vdp --c 0.5:1:3 --eta 0.05 --eps 0.01:0.1:2", "a range for --c or for --eps"),
        ("front chain --c 0.5", "give --damping, or a model file"),
        ("map chain --damping 1 --c 0.5", "a map needs a range"),
        ("front averaged --c 0.6 --eta 0.05 -o front.gif", "--out front.gif must end in"),
        ("front averaged --c 0.6 --eta 0.05 --picture x", "--picture x must end in"),
        ("simulate vdp --checkpoint run.txt", "--checkpoint run.txt must end in .npz"),
    ],
)
def test_what_says_nothing_or_twice_is_refused_before_any_call(line, said, refused):
    assert said in refused(line)["message"]


def test_a_switch_of_a_command_of_its_own_is_off_where_it_is_not_given():
    for name, command in COMMANDS.items():
        if command.module:
            for one in inspect.signature(cli._own(command)[1]).parameters.values():
                switch = one.annotation == "bool" and one.name != QUIET  # which is always given
                assert not switch or one.default is False, (name, one.name)


def test_options_are_those_of_the_model():
    assert bound_to("simulate vdp").filmed
    assert not bound_to("front vdp").filmed
    (ends,) = (each for each in bound_to("simulate averaged").fields.parameters
               if each.name == "ends")  # fmt: skip
    assert ends.choices == tuple(end.value for end in AveragedChain.allowed_ends)
    names = {each.name for each in bound_to("cell vdp").fields.parameters}
    assert {"a", "b", "eps"} <= names
    assert not names & {"c", "sites", "ends"}  # one cell alone has none
    for model, chain in (("vdp", VdpChain), ("chain", OscillatorChain)):
        own = {each.name: each for each in bound_to(f"threshold {model}").own.parameters}
        assert own["method"].choices == tuple(each.value for each in thresholds.methods_of(chain))
    assert bound_to("breather vdp").nucleus.given(argparse.Namespace()) == {"size": 1}
    nucleus = {each.name for each in described(Nucleus)}
    assert nucleus == {"size", "pattern", "place"}  # what it was relaxed from is for nobody to say


def test_an_option_of_a_group_is_given_preset_or_absent():
    """Of its numbers only those that are not whole may be ranges."""
    allowed = Range(0.0, 1.0)
    own = (
        Described(name="a", kind="float", default=REQUIRED, help="{allowed}.", allowed=allowed),
        Described(name="b", kind="float", default=1.0, help="Two."),
        Described(name="c", kind="int", default=2, help="Three."),
        Described(name="ends", kind="choice", default=None, help="", choices=("free",), make=Ends),
        Described(name="words", kind="strings", default=(), help=""),
        Described(name="progress", kind="float", default=0.0, help=""),  # which the command sets
        Described(name="other", kind="Nucleus", default=None, help=""),  # of no word
    )
    group = Group("chain.", own, {"chain.b": 3.0, "c": 5}, ranged="a curve")
    parser = argparse.ArgumentParser(exit_on_error=False)
    group.declare(parser)
    options = parser.parse_args(["--a", "0.1:0.3:3"])
    assert group.given(options) == {"a": (0.1, 0.3, 3), "b": 3.0}
    line = "--a 1 --b 2 --c 4 --ends free --words x --words y"
    given = group.given(parser.parse_args(line.split()))
    assert isinstance(given["ends"], Ends)
    assert given == {
        "a": 1.0, "b": 2.0, "c": 4, "ends": Ends.FREE, "words": ["x", "y"],
    }  # fmt: skip
    with pytest.raises(argparse.ArgumentError, match="--c"):
        parser.parse_args(["--a", "1", "--c", "4:6:3"])
    said = {action.dest: action.help for action in parser._actions}
    assert {*said} == {"help", *(f"chain.{name}" for name in ("a", "b", "c", "ends", "words"))}
    a_curve = "; a range low:high:count gives a curve"
    assert (said["chain.a"], said["chain.b"], said["chain.c"]) == (
        f"{allowed}{a_curve}", f"two{a_curve} (default 3)", "three (default 2)",
    )  # fmt: skip


def _parsed(line, words):
    parser = argparse.ArgumentParser(exit_on_error=False)
    bound.configure(parser, bound_to(line))
    return parser, parser.parse_args(words.split())


def test_options_of_a_measurement_are_those_of_its_chain_its_method_and_a_curve():
    """Of a and b none is required, since eta may stand for them."""
    parser, options = _parsed("front vdp", "--c 0.5:1:3 --eta 0.05 --workers 2")
    assert getattr(options, "curve.workers") == 2
    assert options.eta == 0.05
    titles = [each.title for each in parser._action_groups]
    assert {"the chain", "the method"} <= {*titles}
    assert "parameters and method" not in titles
    own = {each.dest: each for each in parser._actions}
    assert own["chain.sites"].help.endswith("(default 32)")
    assert [own[name].required for name in ("chain.a", "chain.b", "chain.c")] == [
        False,
        False,
        True,
    ]
    _, options = _parsed("breather vdp", "--nucleus 3")
    assert getattr(options, "nucleus.size") == 3
    _, options = _parsed("simulate chain", "--model mine.toml")  # which has what is required
    assert options.chain_file == Path("mine.toml")
    parser = argparse.ArgumentParser()
    bound.configure(parser, BoundCall(COMMANDS["kinetic"].calls[""], ""))
    assert "parameters and method" in [each.title for each in parser._action_groups]


def test_eta_may_stand_for_a_and_b_of_a_chain_that_has_them_and_in_a_map_as_an_axis():
    lines = (
        "front vdp", "map averaged", "map friction", "front friction", "front piecewise",
        "simulate chain",
    )  # fmt: skip
    assert {line for line in lines if bound_to(line).takes_eta} == {"front vdp", "map averaged"}
    call = dataclasses.replace(COMMANDS["map"].calls["vdp"], axes={"c": (0.1, 0.2, 2)})
    assert not BoundCall(call, "vdp").takes_eta


def test_fields_of_a_chain_are_those_of_its_file_with_what_is_given_beside_it(tmp_path):
    file, own = tmp_path / "mine.toml", bound_to("simulate chain")
    file.write_text('damping = "y**2 - 1"\nc = 0.6\n')
    given = argparse.Namespace(chain_file=file, **{"chain.c": 0.7})
    assert derived._fields(own, given) == {"damping": "y**2 - 1", "c": 0.7}
    assert derived._fields(own, argparse.Namespace(**{"chain.damping": "1", "chain.c": 1.0})) == {
        "damping": "1", "c": 1.0,
    }  # fmt: skip
    with pytest.raises(UsageError, match="give --damping, or a model file"):
        derived._fields(own, argparse.Namespace(**{"chain.c": 1.0}))
    assert derived._fields(bound_to("cell vdp"), argparse.Namespace()) == {
        **bound_to("cell vdp").fixed, "a": 2.5, "b": 0.5,
    }  # fmt: skip


def test_a_default_axis_of_a_map_has_its_range_as_long_as_there_are_fewer_than_two():
    own = bound_to("map friction")
    for given, axes in (
        ({}, ["c", "v_d"]),
        ({"xi": (0.03, 0.06, 2)}, ["c", "xi"]),
        ({"c": 0.02, "xi": (0.03, 0.06, 2), "mu_d": (0.3, 0.5, 2)}, ["c", "xi", "mu_d"]),
    ):
        assert [*derived._axes(own, given)] == axes


def test_every_eta_of_a_range_is_checked_by_its_lowest():
    own = bound_to("front vdp")
    assert derived._with_eta(own, {"c": 1.0}, argparse.Namespace(eta=(0.1, 0.2, 3))) == {
        "c": 1.0, "a": 1.0, "eta": (0.1, 0.2, 3),
    }  # fmt: skip
    with pytest.raises(ParameterError, match="eta = "):
        derived._with_eta(own, {}, argparse.Namespace(eta=(-0.1, 0.06, 3)))


def test_an_option_of_other_methods_is_refused_and_one_of_the_chosen_method_is_not():
    only = {"seed": ("sweep", "hold")}
    for method in ("sweep", "hold", "all"):
        derived._refuse_other_methods(only, {"method": method}, argparse.Namespace(seed=3))
    derived._refuse_other_methods(only, {}, argparse.Namespace())
    with pytest.raises(UsageError, match="--seed is for --method sweep or hold"):
        derived._refuse_other_methods(only, {"method": "orbit"}, argparse.Namespace(seed=3))


@pytest.mark.parametrize("seed", [[], ["--seed", "3"]])
def test_the_call_of_a_measurement_is_made_with_the_nucleus_after_its_options_are_checked(
    seed, monkeypatch
):
    """Of a breather one site is the nucleus where nothing is said, and of a map its figure's."""
    made = []

    def stand_in(where):
        found = located(where)
        return functools.wraps(found)(lambda *_, **by: made.append(by) or where)

    pictured = []
    monkeypatch.setattr(bound, "located", lambda where: (
        stand_in(where) if where in OF_THE_LIBRARY else located(where)))  # fmt: skip
    monkeypatch.setattr(derived, "_check_picture", lambda _, function: pictured.append(function))
    own = bound_to("breather vdp")
    _, options = _parsed("breather vdp", " ".join(["--nucleus", "3", *seed]))
    options.out = []
    if seed:
        with pytest.raises(UsageError, match="--seed is for --method simulation"):
            derived._computed(options, own, print)
        assert not made
        return
    found, parameters = derived._computed(options, own, print)
    assert found == own.call.function
    assert made[0]["nucleus"] == parameters["nucleus"] == Nucleus(3)
    assert len(pictured) == 1
    _, options = _parsed("map friction", "")
    options.out = []
    _, parameters = derived._computed(options, bound_to("map friction"), print)
    assert "nucleus" not in {*made[1], *parameters}


def test_a_result_goes_to_its_files_with_its_parameters_and_what_is_said(monkeypatch):
    result, written = Refusal(reason="none"), []
    monkeypatch.setattr(derived, "_computed", lambda *_: (result, {"v": 1.0}))
    monkeypatch.setattr(derived, "check_output", lambda *_: None)
    monkeypatch.setattr(derived, "write_output", lambda *given: written.append(given))
    options = argparse.Namespace(out=[Path("a.csv")], json=True)
    here = copy_context()
    answer = here.run(derived.run, options, bound_to("front vdp"), ["front", "vdp"])
    assert here[COMMAND_LINE] == "fronts front vdp"
    assert written == [([Path("a.csv")], result, {"v": 1.0}, result.to_dict())]
    assert answer.text == "refused: none\nwritten to a.csv"
    assert answer.payload == result.to_dict()


def test_every_module_of_chains_is_imported_for_its_models(monkeypatch):
    asked = []
    monkeypatch.setattr(bound, "import_module", asked.append)
    bound.models()
    modules = Path(chains.__file__).parent.glob("[!_]*.py")
    assert {*asked} == {f"theory.chains.{path.stem}" for path in modules}


@pytest.mark.parametrize("command", ["simulate", "map", "threshold"])
def test_a_chain_without_an_end_is_offered_where_something_answers_only(command):
    assert "piecewise" not in bound.models_of(COMMANDS[command])
    assert {"chain", "averaged-chain"} <= set(bound.models_of(COMMANDS[command]))


def test_the_threshold_of_a_model_is_that_of_the_function(called):
    # the envelope has no eps: as a default it answered for (43) where (8) was named
    (chain, *_), options, _ = called("threshold vdp --eps 0.1")
    assert (chain.eps, chain.sites) == (0.1, 31)
    (belt, *_), _, _ = called("threshold friction")
    assert (chain.c, belt.c) == (0.0, 0.0)  # of which the threshold is looked for
    assert options.get("method") is None


_OF_RUNS, _OF_BREATHERS = {"first", "several", "whole"}, {"existence", "stability"}
_EVERY_METHOD = {"envelope", "orbit", "closed-form", "sweep", "hold", "bisection"}


@pytest.mark.parametrize(
    ("chain", "methods", "definitions"),
    [
        (FrictionChain(c=0), {"bisection"}, _OF_RUNS),
        (AveragedOscillatorChain(damping="y**2 - 1", c=0), {"bisection"}, _OF_RUNS),
        (OscillatorChain(damping="y**2 - 1", c=0), {"bisection", "orbit"},
         _OF_RUNS | _OF_BREATHERS),
        (AveragedChain(a=4, b=0.5, c=0), _EVERY_METHOD, _OF_RUNS | _OF_BREATHERS),
        (VdpChain(a=4, b=0.5, c=0), _EVERY_METHOD, _OF_RUNS | _OF_BREATHERS),
    ],
    ids=lambda each: getattr(each, "model", ""),
)  # fmt: skip
def test_help_lists_the_methods_and_definitions_of_a_threshold_that_apply(
    chain, methods, definitions, capsys
):
    with pytest.raises(SystemExit):
        main(["threshold", chain.model, "--help"])
    shown = " ".join(capsys.readouterr().out.split())
    of_method = shown.partition(" the method: ")[2].partition(" --t-end ")[0]
    assert {word for word in definitions | _OF_BREATHERS if word in of_method} == definitions
    offered = re.findall(r"--(method|definition) \{(.*?)\}", of_method)
    asked = {"method": methods, "definition": definitions}
    assert {name: {*words.split(",")} for name, words in offered} == (
        asked if len(methods) > 1 else {"definition": definitions}
    )
    for method in _EVERY_METHOD - methods:
        assert f"{method}:" not in of_method
        with pytest.raises(ParameterError, match="method"):
            threshold(chain, method=method)
    for definition in (_OF_BREATHERS | _OF_RUNS) - definitions:
        with pytest.raises(ParameterError, match="definition"):
            threshold(chain, definition=definition)


def test_the_first_method_and_definition_of_a_threshold_in_help_are_the_defaults(monkeypatch):
    asked = []
    monkeypatch.setattr(thresholds, "spreading_threshold", lambda _, how, **__: asked.append(how))
    monkeypatch.setattr(thresholds, "breather_threshold", lambda *how, **_: asked.append(how[2]))
    monkeypatch.setattr(thresholds, "_of_stability", lambda _: asked.append("stability"))
    for chain in (FrictionChain(c=0), VdpChain(a=4, b=0.5, c=0), AveragedChain(a=4, b=0.5, c=0)):
        threshold(chain)
    assert asked.pop(0).definition == "first"
    assert asked == ["orbit", "envelope"]  # and their existence, not their stability
    for chain, method, definition in ((FrictionChain, "bisection", "first"),
                                      (VdpChain, "orbit", "existence"),
                                      (AveragedChain, "envelope", "existence")):  # fmt: skip
        said = thresholds.choices(chain)
        assert said["method"][1].startswith(f"{method} (default): ")
        assert f"{definition} (default)" in said["definition"][1]


def test_the_excited_sites_of_a_front_are_named_in_the_shell_as_in_python(called, capsys):
    for flag in ("--excited", "--nucleus"):
        assert called(f"front friction --c 0.02 {flag} 3")[1]["excited"] == 3
    with pytest.raises(SystemExit):
        main(["front", "friction", "--help"])
    assert "--excited EXCITED, --nucleus EXCITED" in capsys.readouterr().out


def test_help_says_that_a_coupling_of_velocities_is_multiplied_by_c(capsys):
    with pytest.raises(SystemExit):
        main(["front", "chain", "--help"])
    shown = " ".join(capsys.readouterr().out.split())
    assert "coupling eps*c*(y_n - y_m + d*(v_n - v_m)); it multiplies c" in shown


def test_no_preset_of_a_command_stands_in_for_a_default_of_its_function():
    calls = [call for command in COMMANDS.values() for call in command.calls.values()]
    options = [(call.function, name) for call in calls for name in call.presets if "." not in name]
    assert options
    for where, name in options:
        default = inspect.signature(located(where)).parameters[name].default
        assert default is inspect.Parameter.empty, (where, name)


@pytest.mark.parametrize(
    ("line", "needed"),
    [
        ("front vdp", "--c C"),
        ("front piecewise", "--c C"),
        ("map vdp", ""),
        ("map friction", ""),
        ("simulate friction", ""),
    ],
)
def test_what_must_be_given_is_what_has_no_default(line, needed):
    assert bound_to(line).required() == needed


def test_help_names_the_defaults_that_depend_on_others(capsys):
    for line, said in (("breather vdp", "7 on each side"), ("map vdp", "0.05:1:20")):
        parser = argparse.ArgumentParser()
        bound.configure(parser, bound_to(line))
        assert said in parser.format_help()
    for command in ("threshold", "front"):  # of which a chain has sites, and no nucleus
        with pytest.raises(SystemExit):
            main([command, "vdp", "--help"])
        assert "7 on each side" not in capsys.readouterr().out


@pytest.mark.parametrize("line", ["cell vdp", "map vdp"])
def test_help_says_the_range_beyond_which_eps_is_refused(line, refused):
    (eps,) = (each for each in bound_to(line).fields.parameters if each.name == "eps")
    assert refused(f"{line} --eps 5e-5")["allowed"] == str(eps.allowed)


@pytest.mark.parametrize(
    ("line", "missing"),
    [
        ("front vdp --eta 0.05", "--c"),
        ("front piecewise --eta 0.03125", "--c"),
        ("sum --c 0.5", "--v"),
    ],
)
def test_what_has_no_default_is_asked_for(line, missing, refused):
    assert f"required: {missing}" in refused(line)["message"]


def test_a_chain_that_restricts_no_ends_takes_all(monkeypatch):
    def choices():
        (ends,) = (each for each in bound_to("simulate averaged").fields.parameters
                   if each.name == "ends")  # fmt: skip
        return set(ends.choices)

    some = choices()
    monkeypatch.setattr(AveragedChain, "allowed_ends", ())
    assert choices() == {end.value for end in Ends} > some


def test_ranges_are_for_the_fields_of_a_chain_and_not_of_a_run():
    for line, ranged in (("front vdp", True), ("map vdp", True), ("simulate vdp", False)):
        found = bound_to(line)
        assert bool(found.fields.ranged) is ranged
        assert not any(group.ranged for group in (found.start, found.nucleus, found.own))
        for group in (found.fields, found.own):
            parser = argparse.ArgumentParser()
            group.declare(parser)
            readers = {action.type for action in parser._actions}
            assert (real_or_range in readers) is bool(group.ranged)


def test_a_chain_without_sites_is_given_none(called):
    (chain,), _, _ = called("front piecewise --c 0.5 --eta 0.03125")
    assert (chain.c, hasattr(chain, "sites")) == (0.5, False)


@pytest.mark.parametrize("more", [[], ["--json"]])
def test_progress_is_that_of_the_command_and_is_quiet_beside_json(more, monkeypatch):
    seen = []

    def begun(name, *, quiet):
        seen.append((name, quiet))
        raise KeyboardInterrupt

    monkeypatch.setattr(progress, "Progress", begun)
    assert main(["kinetic", "--c", "0.5", *more]) == 130
    assert seen == [("kinetic", bool(more))]


def test_an_interrupted_run_names_its_checkpoint(monkeypatch, capsys, tmp_path):
    def interrupted(*_, checkpoint, **__):
        if written:
            checkpoint.write_bytes(b"so far")
        raise KeyboardInterrupt

    monkeypatch.setattr(simulate, "simulate", functools.wraps(simulate.simulate)(interrupted))
    path = tmp_path / "run.npz"
    for written in (False, True):
        assert main(["simulate", "vdp", "--checkpoint", str(path)]) == 130
        said = f"{path} is there: the same command with this" in capsys.readouterr().err
        assert said is written


def test_a_file_holds_every_parameter_of_what_was_computed(tmp_path):
    for line, wanted in (
        ("cell friction --v-d 1.25", {"v_d": 1.25, "xi": 0.05}),
        (
            "breather averaged --c 0.1 --nucleus 2",
            {
                "model": "averaged",
                "a": 2.5,
                "c": 0.1,
                "sites": 16,
                "ends": "free",
                "nucleus": {"size": 2, "pattern": "0", "place": "bulk"},
            },
        ),
        (
            "breather averaged --c 0.1 --method envelope",
            {"nucleus": {"size": 1, "pattern": "", "place": "bulk"}},
        ),
        ("profile --c 0.5 --eta 0.03125 --points 3", {"c": 0.5, "points": 3}),
        ("map averaged --c 0.5 --eta 0.13:0.14:2 --n 8 --workers 1", {"sites": 8, "nucleus": None}),
        (
            "breather vdp --c 0.05:0.1:2 --method closed-form",
            {"c": [0.05, 0.1, 2], "eps": 0.01, "sites": 15, "ends": "free", "seed": 0},
        ),
        (
            "cell averaged --eta 0.02:0.03:2",
            {"a": 1.0, "b": None, "eta": [0.02, 0.03, 2], "eps": 0.01, "ends": "free"},
        ),
        ("cell friction --v-d 1:1.2:2", {"v_d": [1.0, 1.2, 2], "xi": 0.05, "law": "exponential"}),
    ):
        out = tmp_path / "found.json"
        assert main([*line.split(), "-o", str(out)]) == 0
        found = json.loads(out.read_text())["provenance"]["parameters"]
        assert {name: found.get(name) for name in wanted} == wanted


def test_the_file_of_a_run_holds_its_answer_and_the_start_that_it_had(tmp_path, capsys):
    """The start is made again, bit for bit, from the parameters that are kept."""
    out, arrays = tmp_path / "run.json", tmp_path / "run.npz"
    line = "simulate averaged --n 7 --a 4 --b 0.5 --c 0.3 --t-end 20 --samples 2 --json"
    for more, start in (("", {}), (" --excite 2,3 --perturbation 1e-3", {"seed": 1})):
        assert main([*f"{line}{more}".split(), "-o", str(out), "-o", str(arrays)]) == 0
        answer = json.loads(capsys.readouterr().out)
        kept = json.loads(out.read_text())
        given = kept.pop("provenance")["parameters"]["start"]
        assert kept == answer
        assert answer["nucleus"]["end"] == "held"
        assert given.items() >= start.items()
        assert None not in given.values()
        chain = AveragedChain(a=4.0, b=0.5, c=0.3, sites=7)
        with np.load(arrays) as held:
            assert json.loads(str(held["result"]))["nucleus"] == answer["nucleus"]
            again = as_psi(prepared(chain, **given).state)
            assert np.array_equal(held["psi"][0], again)
            assert np.count_nonzero(abs(again) > 1.0) == (1 if not more else 2)


def test_the_command_that_is_kept_says_nothing_of_files():
    words = [
        "map",
        "vdp",
        "-o",
        "m.csv",
        "--resume",
        "--picture=m.png",
        "--c",
        "1",
        "--out",
        "x.csv",
    ]
    assert command_line([*words, "--json"]) == "fronts map vdp --c 1"


def test_a_checkpoint_is_none_of_the_files(tmp_path):
    path = tmp_path / "r.npz"
    named = [(tmp_path / "p.png", "--picture"), (path, "--out")]
    check_output(argparse.Namespace(named=named[:1], checkpoint=path), filmed=True)
    with pytest.raises(UsageError, match="name two different files"):
        check_output(argparse.Namespace(named=named, checkpoint=path), filmed=True)


def test_a_long_answer_is_shown_in_short_beside_its_file():
    lines = [str(n) for n in range(MAX_LINES + 1)]
    last = f"written to {Path('a.csv')}"
    assert beside_files("\n".join(lines[:-1]), [Path("a.csv")]).splitlines() == [*lines[:-1], last]
    short = beside_files("\n".join(lines), [Path("a.csv")]).splitlines()
    assert short == [*lines[:3], "…", *lines[-2:], last]


def test_beside_a_file_a_long_table_is_shown_by_its_ends_and_the_numbers_below_it_in_full():
    rows = [f"  {n}  {n * n}" for n in range(MAX_LINES)]
    more = [f"  {n}  yes" for n in range(MAX_LINES)]
    text = "\n".join(["points:", "  c  v", *rows, "  c  stable", *more, "along  c", "c_pin  0.1"])
    assert beside_files(text, [Path("a.csv")]).splitlines() == [
        "points:", "  c  v", *rows[:2], "…", *rows[-2:],
        "  c  stable", *more[:2], "…", *more[-2:],
        "along  c", "c_pin  0.1", f"written to {Path('a.csv')}",
    ]  # fmt: skip
    text = "\n".join(["points:", "  c  v", *rows[: MAX_LINES - 2]])
    assert beside_files(text, [Path("a.csv")]) == f"{text}\nwritten to {Path('a.csv')}"
    few = ["few:", *rows[:6]]  # of which there are not more than would be shown
    more = ["more:", *rows[:3], "…", *rows[5:7]]
    text = "\n".join([*few, "more:", *rows[:7], "points:", *rows])
    shown = beside_files(text, [Path("a.csv")]).splitlines()
    assert shown[: len([*few, *more])] == [*few, *more]


def test_a_run_says_in_words_too_what_became_of_its_nucleus(capsys):
    line = shlex.split("simulate averaged --a 4 --b 0.5 --c 0.6 --n 9 --excite 4:6 --t-end 200")
    main([*line, "--json"])
    nucleus = json.loads(capsys.readouterr().out)["nucleus"]
    main(line)
    said = capsys.readouterr().out.splitlines()
    assert any(each.split()[:3] == ["nucleus", "end", f"{nucleus['end']},"] for each in said)


def _without_seconds(said):
    return re.sub(r"(?<=seconds) +[\d.e-]+", "", said.rstrip("\n"))


def test_an_answer_is_said_in_words_and_written_to_every_file_that_is_named(tmp_path, capsys):
    files = [tmp_path / "sum.csv", tmp_path / "sum.json"]
    line = shlex.split("sum --v 1 --c 0.5")
    assert main(line) == 0
    words = _without_seconds(capsys.readouterr().out)
    assert main([*line, "-o", str(files[0]), "--out", str(files[1])]) == 0
    assert _without_seconds(capsys.readouterr().out) == beside_files(words, files)
    assert all("fronts sum --v 1 --c 0.5" in each.read_text(encoding="utf-8") for each in files)
    kept = json.loads(files[1].read_text(encoding="utf-8"))
    parameters = kept["provenance"]["parameters"]
    assert (float(parameters["v"]), float(parameters["c"])) == (1.0, 0.5)
    assert f"{kept['re']:.10f}" in words
    assert "re" not in parameters


def test_the_parameters_beside_a_result_are_those_of_its_chain_or_the_fields_of_its_cell():
    chain = AveragedChain(a=4.0, b=0.5, c=0.6, ends=Ends.FREE)
    found = derived._parameters_of(chain)
    assert (found["model"], found["ends"]) == ("averaged", "free")
    cell = FrictionCell(v_d=0.3)
    assert derived._parameters_of(cell) == dataclasses.asdict(cell)


def test_a_range_is_a_low_a_high_and_a_count_and_no_list_of_sites():
    assert is_range((0.0, 1.0, 5))
    assert not any(map(is_range, [(0.0, 1.0), (14, 15.0, 16), (14, 15, 16), 0.5, "0:1:5"]))


@pytest.mark.parametrize(
    ("line", "shared"),
    [
        ("--c 0.05:0.1:2", {"a": 2.5, "b": 0.5, "c": (0.05, 0.1, 2)}),
        ("--eta 0.02:0.03:2 --c 0.1", {"a": 1.0, "b": None, "c": 0.1, "eta": (0.02, 0.03, 2)}),
    ],
)
def test_parameters_of_a_curve_are_the_nucleus_and_what_its_chains_share(line, shared, monkeypatch):
    monkeypatch.setattr(curves, "curve", lambda *_, **__: None)
    parser, breathers = argparse.ArgumentParser(), bound_to("breather averaged")
    bound.configure(parser, breathers)
    options = parser.parse_args(line.split())
    _, parameters = derived._computed(options, breathers, lambda _: None)
    shared |= {"model": "averaged", "ends": "free", "nucleus": Nucleus(1)}
    assert {name: parameters.get(name) for name in shared} == shared


def test_an_eta_that_is_too_small_is_refused_with_the_advice_to_enlarge_it(refused):
    error = refused("front averaged --eta 1e-200 --c 0.5")
    assert error["remedy"].startswith("give a larger value")
