"""Edges of the command line: negative values, conflicts, one range a quantity, what is kept."""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import shlex
import signal
import sys
from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import mpmath as mp
import numpy as np
import pytest

import fronts as fr
from derivations.catalogue import LISTING
from fronts import files
from fronts.__main__ import main as start
from fronts.arguments import site_list, with_values_joined
from fronts.bound import BoundCall, models_of
from fronts.catalogue import _VDP_MAP, COMMANDS
from fronts.cli import main
from fronts.interrupted import Interrupted, resumable_tables
from fronts.options import options_of
from fronts.signatures import described, documented
from paper_checks.claims import fig15
from theory.cells.friction import FrictionCell
from theory.cells.vdp import threshold_ratio
from theory.chains import chain
from theory.chains.oscillator import OscillatorChain
from theory.piecewise.admissibility import check_admissible
from theory.piecewise.kinetic_relation import COUPLINGS
from theory.piecewise.limits import pinning_coupling, pinning_error, retreat_coupling
from theory.piecewise.sums.result import DIGITS
from verification.cells import friction as cells
from verification.cells import shooting
from verification.cells.vdp import EPS_RANGE
from verification.execution.sweep import part_path
from verification.fronts import friction, request, smooth
from verification.maps import vdp_rules
from verification.piecewise import simulation
from verification.runs import simulate

_FIELDS = {"message", "quantity", "value", "allowed", "remedy"}


@pytest.mark.parametrize(
    ("line", "quantity", "value"),
    [
        ("kinetic --c -1e-3 --eta 0.03", "coupling c", "-0.001"),
        ("kinetic --c -inf --eta 0.03", "coupling c", "-inf"),
        ("kinetic --c -1:1:5 --eta 0.03", "coupling c", "-1.0"),
        ("cell friction --v-d -1:1:5", "belt velocity v_d", "-1.0"),
        ("kinetic --c -x --eta 0.03", "--c", "-x"),
    ],
)
def test_a_negative_value_is_no_option(refused, line, quantity, value):
    error = refused(line)
    assert set(error) == _FIELDS
    assert (error["quantity"], error["value"]) == (quantity, value)


def test_a_range_of_too_many_velocities_is_refused_before_their_cells_are_made(
    refused, monkeypatch
):
    made = []
    check = FrictionCell.__post_init__
    monkeypatch.setattr(FrictionCell, "__post_init__", lambda cell: made.append(check(cell)))
    error = refused("cell friction --v-d 1:2:99999")
    assert error["quantity"] == "number of velocities"
    assert len(made) < 10


@pytest.mark.parametrize("eta", ["0.13", "1e300", "-1"])
def test_an_eta_out_of_range_is_refused_by_its_own_name(refused, eta):
    error = refused(f"breather --eta {eta} --c 0.1")
    assert error["quantity"] == "eta = b/a^2"
    assert "eta" in error["remedy"] or "such" in error["remedy"] or "1/8" in error["remedy"]


@pytest.mark.parametrize(
    ("command", "range_in_help"),
    [("cell vdp", EPS_RANGE), ("map vdp", vdp_rules.EPS_RANGE), ("cell averaged", chain.EPS_RANGE)],
)
def test_the_range_of_eps_in_the_help_is_that_of_the_check(capsys, command, range_in_help):
    with pytest.raises(SystemExit):
        main([*command.split(), "--help"])
    assert f"small parameter, {range_in_help};" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("line", "outside", "allowed"),
    [
        ("front vdp --a 4 --b 0.5 --c 0.6 --accuracy", 0.2, smooth.ACCURACY.allowed),
        ("front vdp --a 4 --b 0.5 --c 0.6 --tolerance", 0.01, request.TOLERANCE.allowed),
        ("front friction --c 0.02 --accuracy", 0.2, friction.ACCURACY.allowed),
        ("front friction --c 0.02 --tolerance", 1e-13, friction.TOLERANCE.allowed),
        ("front piecewise --c 0.5 --eta 0.03 --accuracy", 0.02, simulation.ACCURACIES),
        ("simulate vdp --tolerance", 0.1, simulate.TOLERANCES),
        ("cell vdp --tolerance", 1e-14, shooting.TOLERANCES),
        ("cell friction --tolerance", 1e-15, cells.TOLERANCES),
        ("kinetic --eta 0.03 --c", 1e9, COUPLINGS),
        ("sum --v 0.3 --c 0.5 --digits", 0, DIGITS),
    ],
)
def test_a_refusal_states_the_range_of_the_help(capsys, refused, line, outside, allowed):
    """It is the range of this model, and the one that is checked."""
    error = refused(f"{line} {outside}")
    assert error["allowed"].endswith(str(allowed))
    assert outside < allowed.low or outside > allowed.high
    with pytest.raises(SystemExit):
        main([*line.split()[:-1], "--help"])
    assert str(allowed)[1:] in " ".join(capsys.readouterr().out.split())  # or "From", in a sentence


def test_rows_and_columns_of_a_lattice_are_one_option():
    assert "shape" in OscillatorChain.__dataclass_fields__
    assert {"shape", "sites"} & {each.name for each in described(OscillatorChain)} == {"sites"}


def test_what_is_hidden_of_a_function_is_not_hidden_of_the_chain():
    """The seed of noise has no meaning for a threshold by bisection; that of the disorder has."""
    for command, own in (("threshold", "start_point"), ("breather", "reading")):
        bound = BoundCall(COMMANDS[command].calls["chain"], "chain")
        assert {"disorder", "seed"} <= {each.name for each in bound.fields.parameters}
        assert {"seed", own}.isdisjoint(each.name for each in bound.own.parameters)


def test_every_hidden_option_is_one_of_its_command():
    for command in COMMANDS.values():
        calls = models_of(command) if command.calls and "" not in command.calls else command.calls
        for model, call in calls.items():
            bound = BoundCall(replace(call, hidden=()), model)
            groups = (bound.fields, bound.start, bound.nucleus, bound.own)
            known = {group.prefix + each.name for group in groups for each in group.every}
            assert {name for name in call.hidden if name not in known} <= {"chain.ends"}, model


@pytest.mark.parametrize(
    ("line", "title", "of_a_range"),
    [
        ("cell friction", "the cell:", "gives a curve"),
        ("front friction", "the chain:", "gives a curve"),
        ("map friction", "the chain:", "gives an axis of the map"),
    ],
)
def test_the_help_says_what_its_parameters_are_of_and_what_a_range_gives(
    capsys, line, title, of_a_range
):
    with pytest.raises(SystemExit):
        main([*line.split(), "--help"])
    shown = " ".join(capsys.readouterr().out.split())
    assert title in shown
    assert of_a_range in shown


def test_the_help_of_a_command_with_a_default_model_names_the_others(capsys):
    with pytest.raises(SystemExit):
        main(["breather", "--help"])
    shown = capsys.readouterr().out
    assert "The model is vdp unless another one is named:" in shown
    assert all(f"fronts breather {model} --help" in shown for model in ("averaged", "chain"))


def test_a_cell_in_closed_form_takes_no_tolerance(refused):
    assert "--tolerance" in refused("cell averaged --tolerance 1e-8")["message"]


def test_a_profile_from_a_negative_position_in_powers_of_ten(answered):
    line = "profile --c 0.5 --eta 0.03125 --from -1e-1 --to 1e-1 --points 3"
    assert answered(line)["zeta"] == [-0.1, 0.0, 0.1]


def test_only_values_are_joined():
    words = ["-1", "--json", "-h", "-3", "--c=1", "-2", "--v", "--c", "-", "--", "-3", "--all", "x"]
    assert with_values_joined(words) == words


@pytest.mark.parametrize(
    ("line", "option", "value"),
    [
        ("sum --v 0.3 --c 0.5 --digits 1e9", "--digits", "1e9"),
        ("front friction --c 0.02 --n 1.5", "--n", "1.5"),
        ("roots --v 0.3 --c 0.5 --count nan", "--count", "nan"),
        ("profile --c 0.5 --eta 0.03 --points 1e9", "--points", "1e9"),
        ("kinetic --c 0.1:1:2.5 --eta 0.03", "--c", "2.5"),
    ],
)
def test_a_whole_number_is_asked_for_by_name(refused, line, option, value):
    error = refused(line)
    assert set(error) == _FIELDS
    assert (error["quantity"], error["value"]) == (option, value)
    assert error["allowed"] == "a whole number"


@pytest.mark.parametrize(
    ("line", "quantity"),
    [
        ("simulate friction --start-point minimum --displacement 3", "start point"),
        ("simulate vdp --seed 3", "seed"),
        ("simulate vdp --perturbation 0.1 --seed -3", "seed"),
        ("simulate vdp --excite 1:99999999999", "--excite"),
        ("simulate vdp --excite 16:14", "--excite"),
        ("stress --list --work-reduction", "--list"),
        ("stress --list --record", "--record"),
        ("stress --work-reduction --points 5", "--points"),
        ("stress --work-reduction --resume", "--resume"),
        ("stress --list --resume", "--resume"),
        ("stress --record --quantity c-pin", "--quantity"),
        ("profile --c 0.5 --eta 0.03 --from 5 --to 5", "last position"),
        ("kinetic --c 0.1:0.1:5 --eta 0.03", "--c"),
        ("kinetic --c 0.5 --eta 0.1:0.01:5", "--eta"),
        ("kinetic --c 0.1:inf:5 --eta 0.03", "--c"),
        ("map vdp --c 0.3:0.1:4", "--c"),
        ("simulate vdp --mu-d 0.3", "--mu-d"),
        ("breather --c 0.1 --seed 3", "--seed"),
        ("kinetic --c 0.3:3:4 --eta 0.03 --out /nowhere/curve.csv", "--out"),
        ("profile --c 0.5 --eta 0.03125 --branch 7", "branch"),
        ("roots --v 0.3 --c 0.5 --count 100000 --digits 2000", "roots times digits"),
        ("roots --v 0.3 --c 0.5 --extent 100000 --digits 2000", "roots times digits"),
        ('derive cell --damping "1-y**40"', "damping"),
        ("nosuchcommand", "command"),
    ],
)  # fmt: skip
def test_what_contradicts_or_has_no_end_is_refused_with_every_field(refused, line, quantity):
    error = refused(line)
    assert set(error) == _FIELDS
    assert error["quantity"] == quantity


def test_an_option_without_its_value_is_named(refused):
    assert refused("kinetic --eta 0.03 --c")["quantity"] == "--c"


@pytest.mark.parametrize(
    ("lines", "allowed"),
    [
        (("front friction --c 0.02 --n 900", "front friction --c 0.02 --n 3"),
         "a whole number from 25 to 800"),
        (("front friction --c 0.02 --n 1000000000", "simulate friction --n 1000000000"),
         "a whole number from 1 to 1000000"),
        (("front vdp --c 0.6 --eta 0.03 --n 1001", "front vdp --c 0.6 --eta 0.03 --n 2000"),
         "a whole number from 2 to 1000"),
        (("kinetic --c 0 --eta 0.03", "kinetic --c 1e-300 --eta 0.03", "kinetic --c nan --eta 0.1",
          "kinetic --c 1e9 --eta 0.1"), "from 1e-8 to 1e8"),
        (("kinetic --c 0.5 --eta 0", "kinetic --c 0.5 --eta 1e-30", "kinetic --c 0.5 --eta inf"),
         "finite and at least 1e-24"),
        (("kinetic --c 0.5 --a 0 --b 1", "kinetic --c 0.5 --a 1e300 --b 1"),
         "from 1e-100 to 1e100"),
        (("roots --v 0 --c 0.5", "roots --v 1e-13 --c 0.5"), "from 1e-12 to 1e12"),
        (("simulate vdp --t-end 0", "simulate vdp --t-end 1e10"), "positive and at most 1e9"),
        (("profile --c 0.5 --eta 0.03 --to 1e300", "profile --c 0.5 --eta 0.03 --to -1e300"),
         "from -1e6 to 1e6"),
    ],
)  # fmt: skip
def test_a_quantity_has_one_range_whatever_is_wrong_with_it(refused, lines, allowed):
    assert [refused(line)["allowed"] for line in lines] == [allowed] * len(lines)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("cell vdp --a 1e200 --b 1", "y sqrt(s), which turns a into a/s"),
        ("front piecewise --c 0.5 --a 1 --b 1e-200", "y sqrt(s), which turns a into a/s"),
        ("kinetic --c 0.5 --a 1e200 --b 1", "y sqrt(s), which turns a into a/s"),
        ("cell averaged --eta 1e-30", "double precision does not resolve"),
        ("front piecewise --c 0.5 --eta 1e-30", "double precision does not resolve"),
        ("simulate vdp --c 1e200", "a number in this range"),
        ("simulate friction --c 1e200", "a number in this range"),
        ('cell chain --damping "1" --eps 1e200', "a number in this range"),
        ("cell friction --xi 1e200", "a damping in this range"),
        ("threshold friction --xi 0", "more damping"),
        ('derive cell --damping "1e200*y**2"', "a decimal whose exponent has at most two digits"),
    ],
)
def test_the_advice_of_a_refusal_is_not_what_was_already_done(refused, line, said):
    """A number of the right sign is not answered by the advice to give a positive number alone."""
    error = refused(line)
    assert said in error["remedy"]
    assert "inf" not in error["allowed"]


def test_a_coupling_of_zero_is_not_taken_for_none_given(answered):
    assert answered("map friction --c 0 --v-d 1.5 --t-end 400 --refine 0")["points"] == 1


def test_a_cell_without_a_front_still_gives_its_averaged_equation(answered):
    answer = answered('derive cell --damping "1-y**40" --no-front')
    assert len(answer["cycles"]) == 1
    assert answer["ratio"] is None


@pytest.mark.parametrize("eta", [1e-20, 0.03125, 0.079, 0.079999, 0.0799999999])
def test_c_pin_is_as_near_as_it_says(eta):
    """Against the same root in 50 digits, at this double and at half a unit beside it."""
    found, error = pinning_coupling(eta), pinning_error(eta)
    assert error is not None
    half = mp.mpf(math.ulp(eta)) / 2
    with mp.workdps(50):
        assert abs(found - _pinning(eta)) <= 4e-15 * found
        for beside in (eta - half, eta + half):
            assert abs(found - _pinning(beside)) <= error * (1 + 1e-3)  # the slope changes too


@pytest.mark.parametrize("eta", [0.0800001, 0.09, 0.124, 0.1249999999, 0.125])
def test_c_retreat_is_as_near_as_it_says(eta):
    found, error = retreat_coupling(eta), pinning_error(eta)
    with mp.workdps(50):
        assert abs(found - _pinning(eta)) <= error


def _pinning(eta: mp.mpf | float) -> mp.mpf:
    """Bisect | |Σ(0⁺)| - 2r | or | |2 + Σ(0⁺)| - 2r | in c, from the definition of each."""
    s = mp.sqrt(1 - 8 * mp.mpf(eta))
    r = mp.sqrt((1 - s) / (1 + s))

    def above(c: mp.mpf) -> bool:
        limit = 1 / mp.sqrt(1 - 4j * c)
        return bool(abs(limit - 1) > 2 * r if r < 0.5 else abs(limit + 1) < 2 * r)

    low, high = mp.mpf(10) ** -30, mp.mpf(10) ** 30
    if above(low):
        return low
    for _ in range(300):
        middle = mp.sqrt(low * high)
        low, high = (low, middle) if above(middle) else (middle, high)
    return low


def test_no_digit_of_c_pin_is_printed_that_does_not_hold(capsys):
    assert main(["kinetic", "--c", "0.5", "--eta", "0.079999"]) == 0
    lines = capsys.readouterr().out.splitlines()
    (words,) = (line.split() for line in lines if line.startswith("c_pin "))
    shown, error = words[1].strip(","), float(words[-1])
    with mp.workdps(50):
        true = _pinning(mp.mpf("0.079999"))  # the decimal, not the double
        assert abs(mp.mpf(shown) - true) < 1.5 * error
    rounding = 0.5 * 10.0 ** -len(shown.partition(".")[2])
    assert 0.05 * error < rounding <= 0.5 * error


def test_a_front_at_rest_on_the_threshold_is_judged_at_once():
    """At v = 0.0188 |φ| is r to rounding over half a site; dividing it took two million values."""
    verdict = check_admissible(0.018788303312689936, 0.455301391482, threshold_ratio(0.03125))
    assert verdict.admissible is False
    assert verdict.points < 5000


def test_the_progress_of_a_curve_rises_to_its_end():
    from theory.piecewise.kinetic_relation import trace_kinetic_relation

    told: list[float] = []
    many = trace_kinetic_relation([0.5] * 201, [0.03125], progress=told.append)
    assert told[0] == 0.0
    assert told == sorted(told)
    assert 0.5 <= told[-1] <= 1.0
    (alone,) = trace_kinetic_relation([0.5], [0.03125])
    (expected,) = alone.branches
    for answer in many:  # computed by compiled rules, which round otherwise
        (branch,) = answer.branches
        for name in ("v", "by_c", "by_eta"):
            error = getattr(expected, "error" if name == "v" else f"{name}_error")
            assert abs(getattr(branch, name) - getattr(expected, name)) <= error
        assert (branch.slope, branch.admissible) == (expected.slope, expected.admissible)


def _stopped(capsys: pytest.CaptureFixture[str], line: str) -> str:
    assert main(shlex.split(line)) == 130
    message: str = json.loads(capsys.readouterr().err.splitlines()[-1])["error"]["message"]
    return message


class _Interrupting:
    """An importer during which the user interrupts."""

    def find_spec(self, name: str, *_: object) -> None:
        if name == "fronts.cli":
            raise KeyboardInterrupt


def test_an_interruption_while_the_command_is_imported_ends_it_in_a_sentence(capsys, monkeypatch):
    monkeypatch.delitem(sys.modules, "fronts.cli")
    monkeypatch.setattr(sys, "meta_path", [_Interrupting(), *sys.meta_path])
    assert start() == 130
    assert capsys.readouterr() == ("", "fronts: interrupted; nothing had begun.\n")


@pytest.mark.parametrize("chain", ["vdp", "friction"])
def test_an_interrupted_run_names_its_checkpoint(chain, tmp_path, capsys, monkeypatch):
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("verification.execution.progress.Progress.report", stop)
    file = tmp_path / "kept.npz"
    line = f"simulate {chain} --excite 1 --t-end 50 --json"
    assert _stopped(capsys, line) == "interrupted; nothing half-written is left behind."
    said = _stopped(capsys, f"{line} --checkpoint {shlex.quote(str(file))}")
    assert file.exists()
    assert str(file) in said
    assert "--checkpoint" in said
    assert "nothing half-written" not in said


def test_an_interruption_names_the_tables_that_were_begun(tmp_path):
    begun, none = tmp_path / "begun.csv", tmp_path / "none.csv"
    part_path(begun).touch()
    for outs, said in (((begun, none, None), f"{part_path(begun)} is there: "), ((none,), "")):
        with pytest.raises(Interrupted) as stopped, resumable_tables(*outs):
            raise KeyboardInterrupt
        assert str(stopped.value).startswith(said)
        assert bool(str(stopped.value)) is bool(said)


def test_a_request_to_end_between_two_sweeps_names_the_tables_too(tmp_path):
    begun = tmp_path / "begun.csv"
    part_path(begun).touch()

    def ask() -> None:
        assert signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL  # which would end the tests
        os.kill(os.getpid(), signal.SIGTERM)

    with pytest.raises(Interrupted, match="is there: "), resumable_tables(begun):
        ask()
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


@pytest.mark.parametrize(
    "line",
    [
        "map vdp --eta 0.03:0.06:2 --c 0.1:0.2:2 --model envelope --t-end 50",
        "stress --quantity c-pin --points 60 --workers 1",
    ],
)
def test_an_interrupted_sweep_names_its_file(line, tmp_path, capsys, monkeypatch):
    def stop(_: object, fraction: float) -> None:
        if fraction > 0:
            raise KeyboardInterrupt

    out = tmp_path / "table.csv"
    with monkeypatch.context() as patch:
        patch.setattr("verification.execution.progress.Progress.report", stop)
        said = _stopped(capsys, f"{line} --out {shlex.quote(str(out))} --json")
    part = tmp_path / "table.csv.part"
    assert part.exists()
    assert f"{part} is there" in said
    assert "--resume" in said
    assert main(shlex.split(f"{line} --out {shlex.quote(str(out))} --resume")) == 0
    assert out.exists()
    assert not part.exists()


@pytest.mark.parametrize(
    ("line", "suffix"),
    [
        *(("kinetic --c 0.4:0.6:3 --eta 0.03125 --out", each) for each in ("svg", "png", "pdf")),
        ("simulate vdp --n 5 --t-end 20 --picture", "png"),
        ("profile --c 0.5 --eta 0.03125 --out", "svg"),
        ("cell friction --v-d 1.2:1.3:3 --out", "pdf"),
        ("map vdp --eta 0.03:0.06:2 --c 0.1:0.2:2 --model envelope --t-end 50 --picture", "svg"),
    ],
)
def test_the_same_command_writes_the_same_picture(line, suffix, tmp_path, monkeypatch):
    files = [tmp_path / f"{n}.{suffix}" for n in (1, 2)]
    for day, file in enumerate(files):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", str(86_400 * day))  # the day Matplotlib would write
        assert main([*shlex.split(line), str(file)]) == 0
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_map_ends_where_its_grid_ends():
    from paper_checks.report.state_picture import _rim, draw_states
    from tests.tables import table_of
    from verification.execution.table import Table
    from verification.pictures.figures import new_axes

    states = table_of(
        [{"c": c, "v_d": v, "label": "front" if c else "breather"}
         for c in (0.0, 0.1) for v in (1.0, 2.0)]
    )  # fmt: skip
    rows = [{"along": along, "c": 0.0, "v_d": 1.0, "at": at, "low": at, "high": at}
            for along, at in (("c", 0.05), ("v_d", 1.5))]  # fmt: skip
    _, axes = new_axes()
    draw_states(axes, states, "c", "v_d", table_of(rows))
    (contour,) = (each for each in axes.lines if each.get_label() == "boundary, bisected")
    assert contour.get_xydata()[:2].tolist() == [[0.05, 1.0], [0.0, 1.5]]
    assert axes.get_xlim() == pytest.approx((0.0, 0.103))
    assert axes.get_ylim() == pytest.approx((0.97, 2.03))
    low, high = _rim(table_of([{"c": 0.02}]), "c")
    assert 0.9 * 0.02 < low < 0.02 < high < 1.1 * 0.02
    assert _rim(table_of([{"c": 0.0}]), "c") == (0.0, 1.0)
    assert _rim(table_of([{"c": -2.0}]), "c") == pytest.approx((-2.0, -1.9))
    _, axes = new_axes()
    nowhere = Table(arrays={name: np.array([]) for name in ("along", "c", "v_d", "at")})
    assert list(draw_states(axes, states, "c", "v_d", nowhere)) == ["states"]
    assert all(each.get_label() != "boundary, bisected" for each in axes.lines)


def test_the_quick_benchmark_says_when_it_writes(capsys):
    with pytest.raises(SystemExit):
        main(["bench", "--help"])
    shown = " ".join(capsys.readouterr().out.split())
    assert "write nothing unless --out is given" in shown


@pytest.mark.parametrize(
    ("line", "column", "rows"),
    [
        ("derive averaging --equation 34", "name", 1),
        ("derive", "name", len(LISTING)),
        ("check fig16-limits fig16-admissible", "key", 2),
        ("stress --quantity c-pin --points 12 --workers 1", "quantity", None),
    ],
)
def test_rows_of_every_command_go_to_files_that_say_where_they_come_from(
    line, column, rows, tmp_path, capsys
):
    for ending in ("csv", "json", "npz"):
        path = tmp_path / f"rows.{ending}"
        assert main([*shlex.split(line), "-o", str(path)]) == 0
        if ending == "csv":
            text = path.read_text(encoding="utf-8")
            head, *body = [each for each in csv.reader(text.splitlines()) if each[0][:1] != "#"]
            assert column in head
            assert rows is None or len(body) == rows
            assert f"fronts {line}" in text
        elif ending == "json":
            said = json.loads(path.read_text(encoding="utf-8"))["provenance"]
            assert said["command"] == f"fronts {line}"
            assert "numpy" in said["versions"]
        else:
            with np.load(path, allow_pickle=False) as held:
                assert column in held.files
                assert json.loads(str(held["provenance"]))["command"] == f"fronts {line}"
    capsys.readouterr()


def test_words_without_a_name_and_those_after_it_are_read_from_the_signature():
    def judged(first: str | None = None, /, *, folder: str = "x") -> None:
        """Judge.

        Parameters
        ----------
        first : str, optional
            What.
        folder : str, optional
            Where.
        """

    def many(*key: str) -> None:
        """Judge.

        Parameters
        ----------
        *key : str
            What.
        """

    @dataclass(frozen=True)
    class Made:
        given: float
        derived: float = field(init=False, default=0.0)

    assert [each.positional for each in described(judged)] == [True, False]
    assert [each.name for each in described(Made)] == ["given"]
    prose = "Note : this is prose.\n\nParameters\n----------\na : float\n    A.\n"
    assert documented(prose) == {"a": "A."}
    parser = argparse.ArgumentParser()
    options_of(many).declare(parser)
    assert parser.parse_args([]) == argparse.Namespace()
    assert parser.parse_args(["a", "b"]).key == ["a", "b"]
    seen = []
    group = options_of(many)
    group.call(lambda *words, **rest: seen.append((words, rest)), argparse.Namespace(key=["a"]))
    assert seen == [(("a",), {})]


def test_a_range_of_one_site_is_that_site():
    assert site_list("15:15") == (15,)


def test_a_map_without_ranges_is_that_of_fig_15():
    """Which has η from 0.01 to 0.14 and c from 0.05 to 1."""
    axes = {name: np.linspace(*given) for name, given in _VDP_MAP.axes.items()}
    assert axes["eta"] == pytest.approx(fig15.ETAS)
    assert axes["c"] == pytest.approx(fig15.COUPLINGS)


def test_velocity_and_coupling_of_a_sum_keep_all_their_digits():
    kinds = {each.name: each.kind for each in described(fr.sigma)}
    assert (kinds["v"], kinds["c"]) == ("decimal", "decimal")


def test_a_picture_is_of_the_result(tmp_path):
    drawn = []
    result = SimpleNamespace(plot=drawn.append)
    files._picture(result, {}, {})(tmp_path / "result.svg")
    assert len(drawn) == 1
    assert (tmp_path / "result.svg").stat().st_size > 1000


def test_a_sum_of_fifteen_digits_is_rounded_where_double_precision_falls_short(monkeypatch):
    """To a double, whose rounding is in the error, as all sums of up to fifteen digits are."""
    monkeypatch.setattr(
        "theory.piecewise.sums.integral.sum_by_integral", lambda *_: SimpleNamespace(error=1e-14)
    )
    found = fr.sigma(0.3, 0.5, method="integral", digits=15)
    assert type(found.value) is complex
    assert found.digits == 15
    true = fr.sigma("0.3", "0.5", method="integral", digits=30)
    assert 0.0 < abs(complex(true.value) - found.value) + 1e-17 <= found.error < 1e-15
