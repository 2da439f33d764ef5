"""What the command line says: its help, its refusals, its tables, and the ends of its commands."""

from __future__ import annotations

import json
import logging
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fronts as fr
from fronts import cli
from fronts.answer import Answer
from fronts.cli import main
from fronts.curves import Curve
from fronts.wording import in_words, table_lines
from theory.result import Result

Capture = pytest.CaptureFixture[str]


def _shown(capsys: Capture, *words: str) -> str:
    assert main(words) == 0
    return capsys.readouterr().out


def test_without_words_the_commands_are_listed(capsys: Capture) -> None:
    assert _shown(capsys) == _shown(capsys, "--help") == _shown(capsys, "help")


def test_words_are_those_of_the_process_where_none_are_given(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr(sys, "argv", ["/somewhere/fronts", "--version"])
    assert main() == 0
    assert capsys.readouterr().out == f"fronts {fr.__version__}\n"


@pytest.mark.parametrize(
    ("line", "where"),
    [
        ("derive 34 --a 1", "'fronts derive'"),
        ("front averaged --c 0.6 --mu-d 1", "the model averaged"),
    ],
)
def test_an_option_that_belongs_elsewhere_is_refused_for_what_was_asked(
    line: str, where: str, capsys: Capture
) -> None:
    assert main([*line.split(), "--json"]) == 2
    error = json.loads(capsys.readouterr().err)["error"]
    assert error["allowed"] == f"absent for {where}"


def test_the_model_may_be_named_after_the_command_or_by_an_option(capsys: Capture) -> None:
    by_option = json.loads(
        _shown(capsys, "breather", "--model", "averaged", "--c", "0.1", "--json")
    )
    by_name = json.loads(_shown(capsys, "breather", "averaged", "--c", "0.1", "--json"))
    assert by_option["amplitudes"] == by_name["amplitudes"]


def test_help_of_a_further_model_shows_its_own_examples(capsys: Capture) -> None:
    with pytest.raises(SystemExit):
        main(["breather", "averaged", "--help"])
    examples = capsys.readouterr().out.split("examples:")[1]
    assert {line.split()[2] for line in examples.splitlines() if "fronts" in line} == {"averaged"}


def test_help_ends_with_what_is_noted_of_the_command(capsys: Capture) -> None:
    with pytest.raises(SystemExit):
        main(["map", "friction", "--help"])
    assert "Beside a table OUT.csv stand" in capsys.readouterr().out.split("examples:")[1]


def test_help_names_no_default_of_what_must_be_given(capsys: Capture) -> None:
    with pytest.raises(SystemExit):
        main(["sum", "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert "--v V front velocity" in said.lower().replace("--v v", "--v V")
    assert "(default <" not in said
    assert "(default None)" not in said


@pytest.mark.parametrize("as_json", [False, True])
def test_an_interrupt_is_said_in_the_form_that_was_asked_for(
    as_json: bool, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def interrupted(_: Any) -> int:
        raise KeyboardInterrupt("half of it is in x.part")

    monkeypatch.setattr(cli, "_run", interrupted)
    assert main(["sum", *(["--json"] if as_json else [])]) == 130
    said, whole = capsys.readouterr().err, "interrupted; half of it is in x.part."
    assert (
        said
        == (json.dumps({"error": {"message": whole}}) if as_json else f"fronts: {whole}") + "\n"
    )


def test_an_answer_that_is_no_number_is_a_defect_and_not_json(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def chosen(name: str, command: Any, rest: Any) -> Any:
        return cli.new_parser("fronts", "x", ""), lambda _: Answer({"v": float("nan")}, "v"), rest

    monkeypatch.setattr(cli, "_chosen", chosen)
    assert main(["sum", "--json"]) == 3
    assert capsys.readouterr().out == ""


def test_a_terminal_is_told_that_the_first_run_compiles(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    logger = logging.getLogger("verification.execution.compiled")
    monkeypatch.setattr(logger, "handlers", [])
    level = logger.level
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    try:
        cli._announce_compilation()
        cli._announce_compilation()  # once is enough
        logger.info("compiling")
    finally:
        logger.setLevel(level)
    assert capsys.readouterr().err == "fronts: compiling\n"


# ------------------------------------------------------------------------------------------ words


@dataclass(frozen=True, kw_only=True)
class _Value(Result):
    v: float | None
    error: float
    known: bool = True
    why: str | None = None


def test_a_negative_number_of_a_table_has_the_digits_of_its_opposite() -> None:
    """Of a number that its rows are not about at most eight, as many as its error allows."""
    for number in (123.4567890123, 0.001234567890123):
        rows = [{"c": 1.0, "re_part": s * number, "re_part_error": 1e-15} for s in (1.0, -1.0)]
        _, plus, minus = table_lines(rows)
        shown = plus.split()[1]
        assert minus.split()[1] == f"-{shown}"
        assert abs(float(shown) - number) <= 0.5e-7 * number
        assert len(shown.replace(".", "").lstrip("0")) == 8


def test_flags_of_a_curve_stay_flags_and_numbers_are_numbers() -> None:
    points = (_Value(v=0.5, error=0.0), _Value(v=None, error=0.0, known=False))
    table = Curve(along="c", values=np.array([1.0, 2.0]), points=points, seconds=0.0).columns()
    assert table["known"].tolist() == [True, False]
    assert table["known"].dtype == object
    assert table["v"].dtype == float
    assert np.isnan(table["v"][1])


def test_a_status_is_followed_by_its_sentence_and_by_its_reason_where_it_has_none() -> None:
    point = fr.kinetic_relation(c=0.5, eta=0.03125)
    sentence = getattr(point.status, "sentence", "")
    first = in_words(point).splitlines()[0]
    assert first == f"{point.status.value}: {sentence or point.reason}"


# -------------------------------------------------------------------------------- single commands


def test_the_checks_of_a_verdict_that_they_do_not_bear_out_say_so(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from derivations import judgement

    plain = judgement.judge

    def doubted(*given: Any) -> Any:
        found = plain(*given)
        return replace(found, on_print=replace(found.on_print, holds=not found.on_print.holds))

    assert main(["derive", "34"]) == 0
    assert "NOT confirm" not in capsys.readouterr().out
    monkeypatch.setattr(judgement, "judge", doubted)
    assert main(["derive", "34"]) == 1
    assert "The checks did NOT confirm this verdict." in capsys.readouterr().out


def test_a_cell_as_json_is_the_same_by_either_option(capsys: Capture) -> None:
    line = ["derive", "cell", "--damping", "1 - a*y**2 + b*y**4", "--no-front"]
    by_format = json.loads(_shown(capsys, *line, "--format", "json"))
    assert by_format == json.loads(_shown(capsys, *line, "--json"))
    assert len(by_format["cycles"]) == 2


def test_a_table_of_verdicts_that_cannot_be_written_is_refused_before_any_is_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from fronts.commands import check

    def judged(*_: Any, **__: Any) -> Any:
        raise AssertionError("judged")

    monkeypatch.setattr(check, "_judged", judged)
    assert main(["check", "--out", str(tmp_path / "none" / "x.csv")]) == 2
    assert "x.csv" in capsys.readouterr().err


def test_files_of_a_film_are_allowed_where_there_is_one(tmp_path: Path) -> None:
    from fronts.answer import UsageError
    from fronts.files import check_files

    asked = [(tmp_path / "run.gif", "--out")]
    check_files(asked, filmed=True)
    with pytest.raises(UsageError, match="must end in"):
        check_files(asked, filmed=False)


def test_a_column_of_words_goes_into_a_file_of_numpy_without_pickle(tmp_path: Path) -> None:
    from fronts.files import write_result

    points = (_Value(v=0.5, error=0.0), _Value(v=None, error=0.0, known=False, why="late"))
    found = Curve(along="c", values=np.array([1.0, 2.0]), points=points, seconds=0.0)
    write_result(tmp_path / "x.npz", found, {})
    with np.load(tmp_path / "x.npz") as arrays:  # which unpickles nothing
        assert arrays["known"].tolist() == [True, False]
        assert arrays["why"].tolist() == ["", "late"]
        assert arrays["c"].tolist() == [1.0, 2.0]
        assert arrays["v"].tolist()[0] == 0.5
        assert arrays["v"].dtype == float


@pytest.mark.parametrize(
    "line",
    [
        "cell vdp --a 2.5 --b 0.5:0.9:2",
        "cell friction --v-d 1:1.5:3",
        "threshold averaged --b 0.4:0.5:2",
        "breather --c 0.05:0.1:2 --method envelope",
        "front averaged --a 4 --b 0.5 --method wave --c 0.3:0.6:2",
        "kinetic --c 0.3:0.6:2 --eta 0.03125",
    ],
)
def test_a_curve_loses_nothing_in_a_file_of_numpy_or_as_a_dataset(
    line: str, tmp_path: Path, capsys: Capture
) -> None:
    """The columns are those of the table, and of a cell its cycles are among them."""
    import csv

    table, arrays = tmp_path / "x.csv", tmp_path / "x.npz"
    assert main([*line.split(), "-o", str(table), "-o", str(arrays)]) == 0
    with table.open() as lines:
        rows = [*csv.DictReader(each for each in lines if not each.startswith("#"))]
    with np.load(arrays) as held:
        assert set(rows[0]) == {*held.files} - {"result", "parameters", "provenance"}
        for name in rows[0]:
            assert held[name].shape == (len(rows),)
            for cell, value in zip((row[name] for row in rows), held[name].tolist(), strict=True):
                same = isinstance(value, float) and float(cell or "nan") == value
                assert same or str(value) in (cell, "nan"), name
    if line.startswith("cell"):
        first = rows[0]
        low, high = (next(float(first[name]) for name in first if name.endswith(end)
                          and "unstable" not in name) for end in ("_min", "_max"))  # fmt: skip
        assert low < 0.0 < high
    capsys.readouterr()


def test_of_a_curve_of_cells_the_rows_have_the_cycles() -> None:
    cells = [fr.cell(fr.VdpChain(a=2.5, b=float(b), c=0)) for b in (0.5, 0.9)]
    found = Curve(along="b", values=np.array([0.5, 0.9]), points=tuple(cells), seconds=0.0)
    table = found.columns()
    assert cells[0].stable is not None
    assert table["stable_cycle_max"][0] == cells[0].stable.max
    assert np.isnan(table["stable_cycle_max"][1])  # η = 0.144: there is none
    assert "stable_cycle" not in table
    assert found.to_xarray()["unstable_cycle_min"].shape == (2,)


def test_expensive_claims_are_judged_by_stored_findings_unless_all_is_asked_for() -> None:
    import inspect

    from fronts.commands.stress import stress

    flags = {
        name: each.default
        for function in (fr.judge, stress)
        for name, each in inspect.signature(function).parameters.items()
        if isinstance(each.default, bool)
    }
    assert flags
    assert not any(flags.values())


def test_a_breather_of_the_other_method_is_no_branch(monkeypatch: pytest.MonkeyPatch) -> None:
    from fronts import branches

    followed: list[Any] = []
    monkeypatch.setattr(branches, "follow_breather", lambda *given, **_: followed.append(given))
    full, mean = (fr.VdpChain(a=4, b=0.5, c=0.1), fr.AveragedChain(a=4, b=0.5, c=0.1))
    for chain, own, other in ((full, "orbit", "envelope"), (mean, "envelope", "orbit")):
        followed.clear()
        branches.breather_branch([chain], "c", [0.1], method=other)
        branches.breather_branch([chain], "a", [0.1], method=own)
        assert not followed
        branches.breather_branch([chain], "c", [0.1], method=own)
        branches.breather_branch([chain], "c", [0.1])
        assert len(followed) == 2


# --------------------------------------------------------------------------- sums and roots


@pytest.mark.parametrize("method", ["integral", "series"])
@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1e-3, 4.0), (2e-4, 0.02)])
@pytest.mark.parametrize("digits", [3, 12, 15])
def test_a_sum_has_as_many_digits_as_were_asked_for(
    method: str, v: float, c: float, digits: int
) -> None:
    """The rounding to a double is left, where so many digits are asked for."""
    found = fr.sigma(v, c, method=method, digits=digits)
    rounding = np.finfo(float).eps * abs(found.value)
    assert found.error <= 10.0**-digits + 2.0 * rounding
    many = fr.sigma(v, c, digits=30)
    assert abs(found.value - complex(many.value)) <= found.error + rounding


def test_the_radius_of_a_root_of_many_digits_is_what_its_residual_leaves() -> None:
    """Newton's step is residual over |L'|; doubled it bounds, and nothing more is asked."""
    import mpmath as mp

    v, c = "0.3", "0.5"
    coarse = fr.roots(v, c, count=3, digits=30)
    fine = fr.roots(v, c, count=3, digits=60)
    for one, two in zip(coarse.upper + coarse.lower, fine.upper + fine.lower, strict=True):
        with mp.workdps(70):
            k = mp.mpc(two.re, two.im)
            distance = abs(mp.mpc(one.re, one.im) - k)
            slope = abs(1j * (mp.mpf(v) + mp.mpf(c) * mp.sin(k)))
            newton = one.residual / slope
            printed = abs(k) * mp.mpf(10) ** -29
        assert distance <= one.radius
        assert one.radius == pytest.approx(float(2 * newton + printed), rel=1e-6)
