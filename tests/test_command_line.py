"""The command line as a user meets it: examples, JSON, files, and one sentence on bad input."""

from __future__ import annotations

import errno
import importlib
import itertools
import math
import shlex
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from fronts import cli
from fronts.cli import COMMANDS, main
from verification.breathers import breather
from verification.breathers import run as breather_run
from verification.steppers import friction

Refused = Callable[[str], dict[str, str]]


# check takes minutes, article reads what it has written (tests/test_article.py), and explore serves
# until it is interrupted (tests/test_explore.py)
@pytest.mark.parametrize(
    "name", [name for name in COMMANDS if name not in ("check", "article", "explore")]
)
def test_the_first_example_of_every_help_works(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """On one core: starting processes takes longer than what they would share."""
    monkeypatch.setattr("verification.execution.pool.cores_allowed", lambda: 1)
    command = COMMANDS[name]
    example = command.examples
    if command.module:
        example = importlib.import_module(f"fronts.commands.{command.module}").EXAMPLE
    words = shlex.split(example.splitlines()[1].split("   ")[0])
    assert words[0] == "fronts"
    assert main(words[1:]) == 0
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_with_an_example(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stopped:
        main([name, "--help"])
    assert stopped.value.code == 0
    shown = capsys.readouterr().out
    assert f"fronts {name}" in shown
    line = " ".join(shown.split()).partition(f" {cli._sentence(COMMANDS[name].line)} ")
    assert "examples:" not in line[0]
    assert "examples:" in line[2]


def test_kinetic_gives_the_documented_object(answered: Any) -> None:
    answer = answered("kinetic --c 0.45 --a 4 --b 0.5")
    assert {"c", "eta", "status", "branches", "c_pin", "c_fold", "method", "terms", "seconds"} <= {
        *answer
    }
    assert answer["status"] == "propagating"
    branches = answer["branches"]
    assert isinstance(branches, list)
    assert [set(branch) >= {"v", "error", "admissible", "slope"} for branch in branches] == [
        True,
        True,
    ]
    assert branches[0]["v"] < branches[1]["v"]
    assert [branch["admissible"] for branch in branches] == [False, True]


def test_pinned_and_not_bistable_are_answers(answered: Any) -> None:
    assert answered("kinetic --c 0.2 --eta 0.03125")["status"] == "pinned"
    outside = answered("kinetic --c 0.2 --eta 0.2")
    assert outside["status"] == "not_bistable"
    assert outside["c_pin"] is None


@pytest.mark.parametrize(
    ("method", "digits"),
    [("integral", 13), ("series", 13), ("certified", 13), ("bessel", 13), ("quadrature", 10)],
)
def test_sum_gives_the_same_by_every_method(method: str, digits: int, answered: Any) -> None:
    answer = answered(f"sum --v 0.3 --c 0.5 --digits {digits} --method {method}")
    assert set(answer) == {"re", "im", "error", "terms", "method", "seconds"}
    # digits of the 50-digit series, to those asked for
    assert answer["re"] == pytest.approx(-0.2887967561902520, abs=10**-digits)
    assert answer["im"] == pytest.approx(0.4522687587493947, abs=10**-digits)


@pytest.mark.parametrize("method", ["integral", "series"])
def test_many_digits_come_as_strings(method: str, answered: Any) -> None:
    answer = answered(f"sum --v 0.3 --c 0.5 --digits 50 --method {method}")
    assert isinstance(answer["re"], str)
    assert isinstance(answer["im"], str)
    assert len(answer["re"].lstrip("-0.")) >= 49


def test_roots_are_listed_counted_and_certified(answered: Any) -> None:
    pytest.importorskip("flint")
    answer = answered("roots --v 0.3 --c 0.5 --count 12 --certify")
    upper, lower = answer["upper"], answer["lower"]
    assert isinstance(upper, list)
    assert isinstance(lower, list)
    assert answer["counted"] == len(upper) + len(lower) == 24
    assert answer["certified"] is True
    for rows in (upper, lower):
        sizes = [math.hypot(row["re"], row["im"]) for row in rows]
        assert sizes == sorted(sizes)
        assert {"label", "re", "im", "residual", "radius"} == set(rows[0])


def test_the_direct_simulation_agrees_with_the_theory(answered: Any) -> None:
    run = answered("front piecewise --c 0.5 --eta 0.03125")
    theory = answered("kinetic --c 0.5 --eta 0.03125")
    assert {"v", "error", "steady", "status", "events", "seconds"} <= set(run)
    branches = theory["branches"]
    assert isinstance(branches, list)
    assert run["v"] == pytest.approx(branches[0]["v"], abs=1e-12)
    assert run["steady"] is True


@pytest.mark.parametrize("suffix", [".csv", ".png"])
def test_curves_and_profiles_are_written_whole(suffix: str, tmp_path: Path) -> None:
    curve, shape = tmp_path / f"curve{suffix}", tmp_path / f"shape{suffix}"
    assert main(shlex.split(f"kinetic --c 0.4:0.6:5 --eta 0.03125 --out {curve}")) == 0
    assert main(shlex.split(f"profile --c 0.5 --eta 0.03125 --out {shape}")) == 0
    assert {path.name for path in tmp_path.iterdir()} == {curve.name, shape.name}
    if suffix == ".csv":
        assert curve.read_text().splitlines()[0].startswith("c,eta,status,v,error")
        rows = [row for row in shape.read_text().splitlines() if not row.startswith("#")]
        assert len(rows) == 322


_RUN = "--a 2.5 --b 0.5 --c 0.1 --excite 15 --t-end 9"

BAD = [
    "kinetic --c 0 --eta 0.03",
    "kinetic --c -1 --eta 0.03",
    "kinetic --c nan --eta 0.03",
    "kinetic --c inf --eta 0.03",
    "kinetic --c 0.5 --eta 0",
    "kinetic --c 0.5 --eta -1",
    "kinetic --c 0.5 --eta nan",
    "kinetic --c 0.5",
    "kinetic --c 0.5 --eta 0.03 --a 4 --b 0.5",
    "kinetic --c 0.3:3 --eta 0.03",
    "kinetic --c 0.3:3:4 --eta 0.03 --out /nowhere/curve.csv",
    "sum --v 0 --c 0.5",
    "sum --v 0.3 --c inf",
    "sum --v 0.3 --c 0.5 --digits 0",
    "sum --v 0.3 --c 0.5 --method bessel --digits 14",
    "roots --v 0.3 --c 0.5 --count 1000000000",
    "roots --v 0.3 --c 0.5 --count 0",
    "roots --v -0.3 --c 0.5",
    "profile --c 0.2 --eta 0.03125",
    "profile --c 0.5 --eta 0.03125 --branch 7",
    "profile --c 0.5 --eta 0.03125 --out /nowhere/shape.png",
    "front piecewise --c 0 --eta 0.03",
    "front piecewise --c 0.5 --eta 0.2",
    "kinetic --c 0.5 --a 1e300 --b 0.5",
    "breather --c 0.1 --a 1e300",
    "breather --c 0.1 --reading tail",
    "breather --c 0.1 --method simulation --seed -1",
    "threshold vdp --perturbation 1e-3",
    "threshold vdp --a 1e200",
    "threshold friction --seed 1",
    "threshold friction --v-d 1",
    "threshold friction --c-min 0",
    "threshold friction --t-end 0",
    "front vdp --c 0.6 --a 1e300 --b 0.5",
    "cell vdp --a 1e-300 --b 1e-300",
    "cell vdp --a 2.5 --b 1e-12",
    "cell friction --v-d 1.25 --eps 0.01",
    f"simulate vdp {_RUN} --eps 0",
    f"simulate vdp {_RUN} --n 1",
    f"simulate vdp {_RUN} --t-end inf",
    f"simulate vdp {_RUN} --t-end 1e300",
    f"simulate vdp {_RUN} --out /proc/run.npz",
    f"simulate vdp {_RUN} --out run.npz --checkpoint ./run.npz",
    f"simulate vdp {_RUN} --n 1000000 --samples 1000000",
    "simulate friction --c 0.02 --excite 1 --t-end 1e300",
    "simulate friction --c 0.02 --excite 1 --t-end 9 --mu-st 0.5",
    "simulate friction --c 0.02 --excite 1 --t-end 9 --v-d 0",
    "simulate friction --c 0.02 --excite 1 --t-end 9 --v-d 1e300",
    "kinetic --c 0_5 --eta 0.03",
    "simulate friction --c 0.02 --excite 1_5 --t-end 9",
    "simulate friction --c 0.02 --excite 1:1_5 --t-end 9",
    "simulate chain --coupling square --n 6x1_0 --damping v**2-1 --c 0.1 --excite 1 --t-end 9",
    "sum --v 0.3 --c 0.5 --digits 1_2",
    "check nosuchclaim",
    "nosuchcommand",
]


@pytest.mark.parametrize("line", BAD)
def test_bad_input_gets_one_sentence_and_exit_code_2(line: str, refused: Refused) -> None:
    assert refused(line)["message"]


@pytest.mark.parametrize("option", ["--out", "--picture", "--checkpoint"])
def test_a_file_that_cannot_be_written_is_named_by_its_own_option(
    option: str, tmp_path: Path, refused: Refused
) -> None:
    folder = tmp_path / ("run.png" if option == "--picture" else "run.npz")
    folder.mkdir()
    error = refused(f"simulate vdp {_RUN} {option} {shlex.quote(str(folder))}")
    assert f"{option} {folder} is a folder" in error["message"]


def test_a_disk_that_fills_up_is_no_defect(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, refused: Refused
) -> None:
    def full(*arguments: object, **options: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("numpy.savez_compressed", full)
    out = tmp_path / "run.npz"
    error = refused(f"simulate vdp {_RUN} --out {shlex.quote(str(out))}")
    assert "no space left on device" in error["message"]
    assert list(tmp_path.iterdir()) == []


def test_a_cycle_that_does_not_exist_is_shown_as_a_dash(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split("cell friction --v-d 0.9:2:3")) == 0
    shown = capsys.readouterr().out
    assert "nan" not in shown
    lines = itertools.pairwise(shown.splitlines())
    assert any("unstable" in head and " -" in row for head, row in lines)


def test_a_run_of_stiff_steps_only_has_no_nan(answered: Any) -> None:
    answer = answered(f"simulate vdp {_RUN} --displacement 1000")
    assert answer["method"] == "Radau"
    assert answer["steps"] == answer["stiff_steps"] > 0
    assert answer["mean_active"] == 31


def test_a_run_that_cannot_go_on_is_no_defect(
    monkeypatch: pytest.MonkeyPatch, refused: Refused
) -> None:
    monkeypatch.setattr(friction, "advance", lambda *_: friction.TOO_SHORT)
    error = refused("simulate friction --c 0.02 --excite 1 --t-end 9")
    assert "the time step vanished" in error["message"]


def test_a_threshold_below_the_hopf_velocity_says_why_there_is_none(refused: Refused) -> None:
    said = refused("threshold friction --v-d 1")["message"]
    assert "above 1.15129" in said
    assert "lower it" not in said


@pytest.mark.parametrize(
    ("command", "option"),
    [("simulate vdp", "--t-end"), ("map vdp", "--t-end"), ("threshold friction", "--t-end"),
     ("simulate friction", "--perturbation"), ("threshold vdp", "--perturbation"),
     ("check", "--workers"), ("map friction", "--workers"), ("front vdp", "--workers"),
     ("front friction", "--nucleus"), ("threshold vdp", "--nucleus"), ("breather", "--nucleus"),
     ("front vdp", "--accuracy"), ("threshold friction", "--accuracy")],
)  # fmt: skip
def test_one_thing_has_one_name_in_every_command(
    command: str, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([*command.split(), "--help"])
    assert f"{option} " in capsys.readouterr().out


def test_one_point_imports_nothing_it_does_not_use() -> None:
    code = (
        "import sys; from fronts.cli import main; main(['kinetic', '--c', '0.5', '--eta', '0.03']);"
        "print(sorted({name.split('.')[0] for name in sys.modules}), file=sys.stderr)"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    for heavy in ("scipy", "sympy", "matplotlib", "mpmath", "flint"):
        assert f"'{heavy}'" not in shown.stderr


@pytest.mark.parametrize("nucleus", ["--nucleus 1", "--nucleus 3 --pattern=+-", "--place edge"])
def test_a_breather_of_a_theory_says_how_far_the_chain_is(nucleus, answered):
    """Its error bounds the distance from the orbit and falls like eps."""
    errors = []
    for eps in (0.02, 0.01):
        line = f"breather --c 0.1 --eps {eps} {nucleus}"
        theory = answered(f"{line} --method envelope")
        orbit = answered(line)
        pairs = zip(theory["amplitudes"], orbit["amplitudes"], strict=True)
        apart = max(abs(one - other) for one, other in pairs)
        assert apart <= theory["error"] <= apart + 1e-8
        assert abs(theory["frequency"] - orbit["frequency"]) <= theory["frequency_error"]
        errors.append(theory["error"])
    assert math.log2(errors[0] / errors[1]) > 0.9


def test_all_methods_for_a_breather_stand_side_by_side(capsys):
    assert main(shlex.split("breather --c 0.195 --n 9 --method all")) == 0
    lines = capsys.readouterr().out.splitlines()
    head = next(n for n, line in enumerate(lines) if line.split()[:2] == ["method", "status"])
    rows = lines[head + 1 : head + 5]
    # Only the closed form has a breather there: the branches of the others fold before.
    assert [row.split()[:2] for row in rows] == [
        ["closed-form", "exists"], ["envelope", "none"], ["orbit", "none"], ["simulation", "none"],
    ]  # fmt: skip
    assert any("error_unknown" in line for line in lines)


def test_a_run_that_escapes_below_the_fold_says_so_and_does_not_deny_the_breather(
    capsys, monkeypatch, answered
):
    monkeypatch.setattr(breather, "run_breather", cache(breather.run_breather))  # shown three times
    line = "breather --c 0.19 --nucleus 3 --n 9"
    orbit = answered(line)
    assert orbit["status"] == "exists"
    assert not orbit["stable"]
    run = answered(f"{line} --method simulation")
    assert run["status"] == "escaped"
    assert run["stable"] is None
    assert run["fold"] is None
    assert main(shlex.split(f"{line} --method all")) == 0
    statuses = [row.split()[:2] for row in capsys.readouterr().out.splitlines()]
    assert ["simulation", "escaped"] in statuses
    assert main(shlex.split(f"{line} --method simulation")) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("escaped: ")
    assert "no such breather" not in shown


def test_a_run_that_escapes_beyond_the_fold_names_the_fold_of_the_orbits(answered):
    line = "breather --c 0.21 --n 9"
    run, orbit = answered(f"{line} --method simulation"), answered(line)
    assert run["status"] == orbit["status"] == "none"
    assert abs(run["fold"] - orbit["fold"]) <= run["fold_error"] + orbit["fold_error"]


def test_a_run_that_has_not_settled_decides_nothing(capsys, monkeypatch, answered):
    monkeypatch.setattr(breather_run, "SLOW_TIME", 10.0)
    line = "breather --c 0.1 --method simulation"
    found = answered(line)
    assert (found["status"], found["stable"]) == ("unsettled", None)
    assert main(shlex.split(line)) == 0
    assert ["stable", "not", "decided"] in map(str.split, capsys.readouterr().out.splitlines())


def test_the_error_of_a_perturbed_threshold_bounds_what_held_runs_do(answered):
    from theory.chains.vdp import VdpChain
    from verification.thresholds.preparation import NucleusPreparation, hold

    size, held, escaped = 3, 0.184, 0.186
    found = answered(f"threshold vdp --nucleus {size} --method sweep --perturbation 1e-6")
    for c, wanted in ((held, False), (escaped, True)):
        for seed in range(3):
            noisy = NucleusPreparation(size, perturbation=1e-6, seed=seed)
            assert hold(VdpChain(a=2.5, b=0.5, c=0), noisy, c, 2000.0).escaped is wanted
    assert held < found["c_crit"] - found["error"]
    assert escaped > found["c_crit"] + found["error"]


def test_sweeps_that_follow_no_law_are_replaced_by_held_runs(capsys, answered):
    """Four sites in phase have no breather: they escape away from any fold."""
    line = "threshold vdp --nucleus 4 --method sweep"
    found = answered(line)
    assert found["method"] == "hold"
    assert abs(found["delay_exponent"] - 2 / 3) > 0.5  # 0.06 is allowed
    assert found["range"][0] <= found["c_crit"] <= found["range"][1]
    assert main(shlex.split(line)) == 0
    assert ["method", "hold"] in map(str.split, capsys.readouterr().out.splitlines())


def test_the_version_is_that_of_the_project(capsys):
    assert main(["--version"]) == 0
    said = capsys.readouterr().out.removeprefix("fronts ").strip()
    project = Path(__file__).parents[1] / "pyproject.toml"
    assert f'version = "{said}"' in project.read_text() or said.startswith("not installed")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("breather --epps 1", "--epps is not an option of 'fronts breather vdp': write --eps."),
        ("front averaged --c 1 --tol=1e-8", "write --tolerance."),
        (
            "map friction --v-max 1",
            "--v-max has no meaning for 'fronts map friction': leave it out.",
        ),
        ("threshold vdp --n 3", "--n has no meaning for 'fronts threshold vdp': leave it out."),
        (
            "threshold averaged --c 1",
            "--c has no meaning for 'fronts threshold averaged': leave it out.",
        ),
        (
            "kinetic --c 1 --eta 0.03 --n 3",
            "--n has no meaning for 'fronts kinetic': leave it out.",
        ),
        ("threshold vdp --c-m 1", "write --c-min or --c-max."),
    ],
)
def test_a_misspelt_option_is_told_from_one_of_another_model(
    line: str, said: str, refused: Refused
) -> None:
    assert refused(line)["message"].endswith(said)


def test_a_front_of_44_may_pass_as_many_sites_as_are_allowed(
    answered: Any,
) -> None:
    """Near where it loses stability, at c = 2.406, it takes hundreds to settle."""
    line = "front piecewise --c 2.3 --eta 0.03125"
    few, many = (answered(f"{line} --max-sites {most}") for most in (80, 1000))
    assert (few["status"], few["arrivals"]) == ("unsteady", 80)
    assert many["status"] == "steady"
    assert 80 < many["arrivals"] < 1000
    assert abs(few["v"] - many["v"]) < few["error"]
