"""What the command line says: its help, its refusals, its tables, and the ends of its commands."""

from __future__ import annotations

import functools
import json
import logging
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

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


def _helps(parser: Any) -> Iterator[str]:
    for action in parser._actions:
        yield action.help or ""
        if isinstance(action.choices, Mapping):
            for inner in action.choices.values():
                yield from _helps(inner)


def test_defaults_in_help_are_values_as_one_would_write_them() -> None:
    found = [re.search(r"\(default (.*?)\)", text) for text in _helps(cli.whole_parser())]
    said = {each[1] for each in found if each}
    assert {"12", "1e-12", "0.05"} <= said
    assert not {each for each in said if re.search(r"None|<|True|False|^$|\.0$", each)}


def test_text_that_is_no_number_is_refused_by_the_name_of_its_option(capsys: Capture) -> None:
    assert main(["sum", "--v", "fast", "--c", "0.5", "--json"]) == 2
    assert json.loads(capsys.readouterr().err)["error"]["quantity"] == "--v"


def test_what_belongs_to_runs_is_refused_beside_a_wave(capsys: Capture) -> None:
    line = "front averaged --a 4 --b 0.5 --c 0.6 --method wave --stall-time 10 --json"
    assert main(line.split()) == 2
    assert json.loads(capsys.readouterr().err)["error"]["quantity"] == "--stall-time"


def test_no_worker_is_refused_before_any_point_is_tried(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from verification.quantities import robustness

    monkeypatch.setattr(robustness, "stability", None)
    for count in ("0", "1025"):
        assert main(["stress", "--workers", count, "--json"]) == 2
        error = json.loads(capsys.readouterr().err)["error"]
        assert (error["quantity"], error["value"]) == ("workers", count)


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


@pytest.mark.parametrize(
    "line", ["threshold averaged", "cell vdp --a 2.5 --b 0.5", "sum --v 0.3 --c 0.5"]
)
def test_a_picture_that_there_is_not_is_refused_before_any_work(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from fronts.bound import Bound
    from fronts.catalogue import COMMANDS

    name, *rest = line.split()
    calls = COMMANDS[name].calls
    function = Bound(calls[rest[0] if rest[0] in calls else ""], "").function

    @functools.wraps(function)
    def worked(*_: Any, **__: Any) -> Any:
        raise AssertionError("worked")

    monkeypatch.setattr(sys.modules[function.__module__], function.__name__, worked)
    assert main([*line.split(), "-o", str(tmp_path / "x.png")]) == 2
    assert "there is no picture of" in capsys.readouterr().err


def test_a_single_cell_has_its_cycles_in_every_table(tmp_path: Path, capsys: Capture) -> None:
    import csv

    line = "cell vdp --a 2.5 --b 0.5 --json"
    files = [tmp_path / f"x{ending}" for ending in (".csv", ".npz", ".zarr")]
    assert main([*line.split(), *(word for each in files for word in ("-o", str(each)))]) == 0
    answer = json.loads(capsys.readouterr().out)
    with files[0].open() as lines:
        (row,) = csv.DictReader(each for each in lines if not each.startswith("#"))
    assert float(row["stable_cycle_max"]) == answer["stable_cycle"]["max"]
    with np.load(files[1]) as held:
        assert held["unstable_cycle_min"].tolist() == [answer["unstable_cycle"]["min"]]
    xarray = pytest.importorskip("xarray")
    stored = xarray.open_zarr(files[2])
    assert stored["stable_cycle_period"].values.tolist() == [answer["stable_cycle"]["period"]]


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


def test_progress_says_of_a_stored_finding_whether_it_is_stale() -> None:
    from fronts.commands.check import _Reporter

    said: list[str] = []
    shown = SimpleNamespace(end=lambda key, words, computed: said.append(words))
    for stored, stale in ((True, False), (True, True), (False, False)):
        judgement = SimpleNamespace(seconds=0.5, stored=stored, stale=stale)
        claim = SimpleNamespace(key="fig01-x")
        outcome: Any = SimpleNamespace(
            judgement=judgement, changed=False, claim=claim, status="reproduced"
        )
        _Reporter(cast("Any", shown)).done(outcome)
    assert [words.count("stored") for words in said] == [1, 1, 0]
    assert [words.count("stale") for words in said] == [0, 1, 0]


def test_what_was_recorded_is_named_claim_by_claim(tmp_path: Path) -> None:
    from fronts.commands.check import _record

    recorded: list[Any] = []
    shipped: Any = SimpleNamespace(
        folder=tmp_path, path=lambda each: each, record=lambda *given: recorded.append(given[0])
    )

    def outcome(key: str, evidence: str, **changes: Any) -> Any:
        claim = SimpleNamespace(key=key, evidence=evidence, expensive=True)
        stored = changes.get("stored", False)
        return SimpleNamespace(
            claim=claim, finding=object(), judgement=SimpleNamespace(stored=stored), entry=key
        )

    several = [outcome("a", "one"), outcome("b", "one"), outcome("c", "two"),
               outcome("d", "three", stored=True)]  # fmt: skip
    report: Any = SimpleNamespace(outcomes=several, versions={})
    assert _record(shipped, report) == f"Recorded in {tmp_path}: a, b, c."
    assert sorted(recorded) == ["a", "c"]  # evidence that claims share is stored once
    report = SimpleNamespace(outcomes=several[3:], versions={})
    assert "none: no expensive claim was asked" in _record(shipped, report)


def test_default_methods_are_judged_from_the_records_of_a_folder(capsys: Capture) -> None:
    assert main(["bench", "sum", "--defaults", "--json"]) in (0, 1)
    choices = json.loads(capsys.readouterr().out)["choices"]
    assert {each["quantity"] for each in choices} == {"sum"}


@pytest.mark.parametrize("asked", [False, True])
def test_growth_is_written_into_the_folder_that_is_named(
    asked: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from benchmarks import floor, growth
    from fronts.commands.bench import _measure

    written: list[tuple[Any, ...]] = []
    monkeypatch.setattr(growth, "measure", lambda quick, report: ["row"])
    monkeypatch.setattr(floor, "measure", lambda quick, report: ["floor"])
    monkeypatch.setattr(growth, "as_payload", lambda rows, command: {"rows": rows})
    monkeypatch.setattr(growth, "as_text", lambda rows: f"{rows}")
    monkeypatch.setattr(floor, "as_rows", list)
    monkeypatch.setattr(floor, "as_text", lambda rows: f"{rows}")
    monkeypatch.setattr(growth, "write_growth", lambda *given: written.append(given))
    folder = tmp_path if asked else None
    answer = _measure((), growth=True, quick=True, folder=folder)
    assert answer.payload["growth"] == {"rows": ["row"], "floors": ["floor"]}
    assert written == ([(answer.payload["growth"], ["row"], tmp_path)] if asked else [])


# ----------------------------------------------------------------------------------- the explorer


def test_the_explorer_runs_the_chain_for_the_slow_time_of_its_axis() -> None:
    from fronts.explore.calls import SLOW_TIME, Settings, calls

    for eps in (0.01, 0.1):
        options = dict(calls(Settings(eps=eps))["run"].options)
        assert eps * options["t_end"] == pytest.approx(SLOW_TIME)
    assert dict(calls(Settings(eps=0.0))["run"].options)["t_end"] == 0.0  # refused by simulate


def test_the_explorer_looks_for_a_breather_of_the_full_chain_beyond_the_fold_of_the_average(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The folds differ by O(ε), so that up to some parts of ε there may be one."""
    from fronts.explore import calls as module

    monkeypatch.setattr(module, "outcome", lambda call: SimpleNamespace(fold=0.2))
    for part, eps, method in ((0.9, 0.1, "orbit"), (1.2, 0.1, "orbit"), (2.0, 0.1, "envelope")):
        settings = module.Settings(c=0.2 * part, eps=eps, model="vdp")
        assert dict(module.calls(settings)["breather"].options)["method"] == method


def test_the_program_of_the_explorer_shows_every_result_and_computes_no_map_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from fronts.explore import calls as module

    asked: list[str] = []
    monkeypatch.setattr(module, "outcome", lambda call: asked.append(call.function))
    lines = module.script(module.Settings()).splitlines()
    compile("\n".join(lines), "script", "exec")
    assert "state_map" not in asked
    for name in module.calls(module.Settings()):
        assert (f"print({name})" in lines) == (name in ("point", "breather"))
        drawn = any(line.startswith(f"{name}.plot()") for line in lines)
        assert drawn == (name != "point")


def test_times_of_updates_are_stored_where_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from fronts.explore import update_time

    taken = update_time.UpdateTime(median_ms=1.0, largest_ms=2.0, slowest_c=0.5)
    monkeypatch.setattr(update_time, "measure", lambda model: taken)
    monkeypatch.setattr(update_time, "RECORD", tmp_path / "explorer.json")
    for more in ([], ["--record"]):
        monkeypatch.setattr(sys, "argv", ["update_time", *more])
        update_time.main()
        assert (tmp_path / "explorer.json").exists() == bool(more)
    assert "at most 2 ms at c = 0.5" in capsys.readouterr().out


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


def test_the_radius_of_a_root_of_many_digits_is_what_printing_them_costs() -> None:
    import mpmath as mp

    v, c = "0.3", "0.5"
    coarse = fr.roots(v, c, count=3, digits=30)
    fine = fr.roots(v, c, count=3, digits=60)
    for one, two in zip(coarse.upper + coarse.lower, fine.upper + fine.lower, strict=True):
        with mp.workdps(70):
            k = mp.mpc(two.re, two.im)
            assert abs(mp.mpc(one.re, one.im) - k) <= one.radius <= 2e-29 * abs(k)


def test_roots_are_counted_in_the_strips_of_all_that_were_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Were there one more than labels, the count would say so."""
    from theory.piecewise import root_count

    strips: list[int] = []

    def one_more(v: float, c: float, labels: Any, upper: bool) -> int:
        strips.extend(labels.tolist())
        return int(labels.size) + 1

    plain = fr.roots(0.3, 0.5, count=4)
    assert plain.counted == 8
    monkeypatch.setattr(root_count, "count_in_strips", one_more)
    assert fr.roots(0.3, 0.5, count=4).counted == 10
    assert {root.label for root in plain.upper} <= {*strips}
