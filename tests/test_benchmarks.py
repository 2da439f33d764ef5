"""The benchmarks measure what they say: turns, medians, failures by name, honest errors."""

import dataclasses
import importlib
import itertools
import json
import math
import re
import time
from csv import DictReader
from functools import cache

import numpy
import pytest

from benchmarks import (
    choice,
    first_call,
    floor,
    friction,
    front,
    growth,
    multipliers,
    roots,
    tables,
)
from benchmarks import sum as sum_benchmark
from benchmarks.diagram import draw, worth_choosing
from benchmarks.growth_diagram import draw_growth
from benchmarks.record import BenchmarkRecord, Target, WorkPoint, read_record
from benchmarks.registry import all_benchmarks, chosen, quantity_of
from benchmarks.work_precision import (
    RESULTS,
    Effort,
    MethodAnswer,
    Setting,
    Style,
    WorkPrecision,
    distance,
    measure_side_by_side,
)
from fronts.cli import main
from fronts.commands import bench
from theory.chains.friction import FrictionChain
from theory.chains.vdp import vdp_acceleration
from theory.piecewise.sums import axis
from verification.execution.metadata import Metadata, staleness
from verification.execution.time_limit import TimeIsUpError, time_limit
from verification.quantities.problems import timed
from verification.quantities.quantity import Quantity
from verification.runs.excite import excite
from verification.runs.simulate import simulate


def _fake(method, log, value=1.0, claimed=0.5, **options):
    def evaluate():
        log.append(method)
        return MethodAnswer(value=value, claimed=claimed)

    return Setting(method=method, knob="knob", evaluate=evaluate, reference=1.25, **options)


def test_methods_take_turns_and_the_first_call_is_apart():
    log = []
    ticks = itertools.count()
    points, failures = measure_side_by_side(
        "sum",
        "fake",
        [_fake("a", log), _fake("b", log, batch=4)],
        effort=Effort(seconds=0.0, min_repeats=3, max_repeats=3),
        clock=lambda: float(next(ticks)),
    )
    assert log == ["a", "b"] * 4
    assert failures == ()
    assert [(p.repeats, p.seconds, p.first_seconds) for p in points] == [
        (3, 1.0, 1.0),
        (3, 0.25, 0.25),  # a batch of four
    ]
    assert [p.error for p in points] == [0.25, 0.25]
    assert all(p.error <= p.claimed for p in points)


def test_the_median_ignores_one_slow_call():
    # start and end of the first call, then of three repeats lasting 1, 100 and 1
    clock = iter([0.0, 1.0, 0.0, 1.0, 0.0, 100.0, 0.0, 1.0])
    (point,), _ = measure_side_by_side(
        "sum",
        "fake",
        [_fake("a", [])],
        effort=Effort(seconds=0.0, min_repeats=3, max_repeats=3),
        clock=lambda: next(clock),
    )
    assert point.seconds == 1.0


def test_a_failure_is_listed_by_name_and_does_not_stop_the_others():
    def broken():
        raise ArithmeticError("no root\nfound")

    points, failures = measure_side_by_side(
        "sum",
        "fake",
        [Setting(method="x", knob="k", evaluate=broken, reference=0.0), _fake("a", [])],
        effort=Effort(seconds=0.0, min_repeats=1, max_repeats=1),
    )
    assert [p.method for p in points] == ["a"]
    assert [(f.method, f.reason) for f in failures] == [("x", "ArithmeticError: no root found")]


def test_a_call_that_takes_too_long_is_given_up():
    with pytest.raises(TimeIsUpError, match=r"0\.05 s"), time_limit(0.05):
        time.sleep(5.0)
    time.sleep(0.06)  # and the alarm is off again


def test_an_error_beyond_the_claim_is_seen():
    (point,), _ = measure_side_by_side(
        "sum",
        "fake",
        [_fake("a", [], claimed=0.1)],
        effort=Effort(seconds=0.0, min_repeats=1, max_repeats=1),
    )
    assert (point.claimed, point.error) == (0.1, 0.25)


@pytest.mark.parametrize(
    ("measured", "relation", "limit", "verdict"),
    [
        (2.0, "at least", 1.0, "met"),
        (0.5, "at least", 1.0, "not met"),
        (0.5, "below", 1.0, "met"),
        (2.0, "below", 1.0, "not met"),
        (2.0, "no target", None, "-"),
        (None, "below", 1.0, "not measured"),
    ],
)
def test_verdicts(measured, relation, limit, verdict):
    assert Target("speed", measured, relation, limit, "s", "").verdict == verdict


def test_a_ratio_is_taken_at_equal_error_and_is_the_least_favourable():
    def point(method, error, seconds):
        return WorkPoint("sum", "s", method, f"{error:g}", error, None, seconds, seconds, 3)

    points = [
        point("integral, in a batch", 1e-3, 0.001),
        point("integral, in a batch", 1e-9, 0.01),
        point("scipy.integrate.quad", 1e-2, 1.0),  # 1000 times, by our faster setting
        point("scipy.integrate.quad", 1e-6, 2.0),  # 200 times, by our slower one
        point("scipy.integrate.quad", 1e-12, 1.0),  # beyond ours: no comparison
    ]
    rows = sum_benchmark.ratio_targets(points, "s")
    assert rows[0].measured == pytest.approx(200.0)
    assert rows[0].verdict == "met"


def test_a_line_of_the_diagram_joins_only_settings_that_none_beats():
    def point(error, seconds):
        return WorkPoint("sum", "s", "m", "k", error, None, seconds, seconds, 3)

    fast, beaten, exact = point(1e-3, 1.0), point(1e-3, 2.0), point(1e-9, 3.0)
    assert worth_choosing([exact, beaten, fast]) == ([fast, exact], [beaten])


def test_a_diagram_shows_errors_of_zero_in_a_strip_and_labels_powers_of_ten(tmp_path):
    def point(error, seconds):
        return WorkPoint("map", "s", "ours", "k", error, None, seconds, seconds, 3)

    style = Style(
        xlabel="x",
        ylabel="y",
        caption="c",
        methods={"ours": ("blue", "o")},
        garbage=1.0,
        floor=1e-3,
    )
    for name, least, shown in (("zero", 0.0, "no error seen"), ("small", 1e-9, "below 0.001")):
        draw(name, [point(4.1e-2, 1.0), point(least, 2.0), point(4.2e-2, 3.0)], style, tmp_path)
        svg = (tmp_path / f"{name}.svg").read_text()
        assert shown in svg
        assert "another setting is better" in svg
        assert (tmp_path / f"{name}.csv").read_text().count(f",{least!r},") == 1
    draw("near", [point(4.1e-2, 1.0), point(4.2e-2, 0.5)], style, tmp_path)
    svg = (tmp_path / "near.svg").read_text()
    assert "4.1" not in svg  # no label between powers of ten
    assert not {"beaten", "no error", "below"} & set(svg.split())


def test_the_diagram_of_growth_has_memory_workers_and_what_is_expected(tmp_path):
    stored = json.loads((RESULTS / "growth.json").read_text())["lines"]
    drawn = [line for line in stored if line["size_name"] == "workers"]
    drawn += [line for line in stored if line["size_name"] == "1/v"][:1]
    draw_growth(drawn, tmp_path)  # all of them take seconds
    svg = (tmp_path / "growth.svg").read_text()
    for shown in ("workers", "megabytes", "expected -1", "dashed: as expected"):
        assert shown in svg
    for folder, lines in ((tmp_path, drawn), (RESULTS, stored)):
        with (folder / "growth.csv").open(encoding="utf-8") as file:
            rows = [(row["series"], row["size"], row["seconds"]) for row in DictReader(file)]
        assert [(name, float(size), float(seconds)) for name, size, seconds in rows] == [
            (line["name"], *row)
            for line in lines
            for row in zip(line["sizes"], line["seconds"], strict=True)
        ]


def test_a_record_survives_writing_and_shows_its_failings(tmp_path):
    point = WorkPoint("sum", "s", "m", "k", 2.0, 1.0, 0.1, 0.1, 3)
    missed = Target("speed", 2.0, "below", 1.0, "s", "detail")
    metadata = Metadata(command="c", machine={"system": "x"}, versions={"numpy": "1"}, date="d")
    run = BenchmarkRecord(
        agreement={"s": 0.0}, points=(point,), failures=(), targets=(missed,), metadata=metadata
    )
    run.stored().save(tmp_path / "run.json")
    assert read_record(tmp_path / "run.json") == run
    text = tables.as_text(run)
    assert "ERROR LARGER THAN CLAIMED" in text
    assert "not met" in text


def test_columns_of_a_record_stand_below_their_heads_however_long_the_names_are():
    points = tuple(
        WorkPoint("sum", "s", name, "knob", 2.0, None, 0.1, 0.1, 3)
        for name in ("m", "a method with a name of forty characters")
    )
    metadata = Metadata(command="c", machine={}, versions={"cxroots": None}, date="d")
    run = BenchmarkRecord(
        agreement={"s": 0.0}, points=points, failures=(), targets=(), metadata=metadata
    )
    lines = tables.as_text(run).splitlines()
    head = next(line for line in lines if line.startswith("  method"))
    rows = [line for line in lines if "knob" in line]
    assert [row.index("knob") for row in rows] == [head.index("setting")] * 2
    assert [len(row) for row in rows] == [len(head)] * 2
    assert "cxroots not installed" in lines


def test_an_array_is_compared_by_its_largest_difference_and_must_be_finite():
    assert distance(numpy.array([1.0, 2.0j]), numpy.array([1.0, 3.0j])) == 1.0
    with pytest.raises(ArithmeticError, match="not finite"):
        distance(numpy.array([1.0, math.nan]), numpy.array([1.0, 1.0]))


def test_seconds_of_processes_are_taken_as_they_are_and_a_defect_is_listed():
    def evaluate():
        return MethodAnswer(value=1.0, seconds=(3.0, 1.0, 2.0), defect="it lacks a drive")

    setting = Setting(method="m", knob="k", evaluate=evaluate, reference=1.0)
    (point,), (failure,) = measure_side_by_side("q", "p", [setting], effort=Effort())
    assert (point.first_seconds, point.seconds, point.repeats) == (3.0, 2.0, 3)
    assert failure.reason == "it lacks a drive"


@pytest.mark.parametrize("problem", timed("sum"), ids=lambda problem: problem.name)
def test_the_error_of_every_quick_method_is_within_its_claim(problem):
    prepared = sum_benchmark.prepare(problem, True, lambda _: None)
    assert prepared.agreement < 1e-55  # 60 digits asked of both, by methods that share no code
    ours = [
        dataclasses.replace(each, evaluate=cache(each.evaluate))  # errors are asked, no seconds
        for each in prepared.settings
        if each.quick and not each.peer
    ]
    effort = Effort(seconds=0.0, min_repeats=1, max_repeats=1)
    points, failures = measure_side_by_side("sum", problem.name, ours, effort=effort)
    assert [p for p in points if p.claimed is not None and p.error > p.claimed] == []
    # The plain quadrature says that it cannot do small v; nothing else may fail.
    assert {failure.method for failure in failures} <= {"quadrature in pieces"}
    assert all("PrecisionError" in failure.reason for failure in failures)


def test_friction_targets_compare_at_equal_error_and_leave_garbage_out():
    def point(method, error, seconds):
        return WorkPoint("q", "ordinary", method, "k", error, None, seconds, seconds, 1)

    found = friction.targets(
        [
            point(friction.EXACT, 1e-2, 0.001),
            point(friction.EXACT, 1e-6, 0.01),
            point("scipy LSODA", 0.5, 0.0001),  # garbage, however fast
            point("scipy LSODA", 1e-1, 0.2),
            point("scipy BDF", 1e-3, 0.3),  # only the slower of ours is as exact
        ],
        True,
        lambda _: None,
    )[0]
    assert found.measured == pytest.approx(30.0)
    assert found.verdict == "not met"
    assert "1 of 3" in found.detail


def test_every_friction_method_gives_its_largest_error():
    problem = timed("friction")[0]
    chain, end = friction.chain_of(problem), problem["t"]
    start = excite(chain, [1])
    true = simulate(chain, start, end, samples=friction.SAMPLES).y
    seen = {}
    for name, _, evaluate in friction.methods(chain, start, end, few=True):
        if not name.startswith("scipy"):
            answer = evaluate()
            error = distance(answer.value, true)
            seen.setdefault(name, []).append(error)
            assert (answer.claimed is not None) == (name == friction.STATED)
            assert answer.claimed is None or error <= answer.claimed
    assert set(seen) == {friction.EXACT, friction.STATED, friction.FIXED, friction.ADAPTIVE}
    # Finer settings are more exact, in every family.
    for errors in seen.values():
        assert errors[-1] < 0.1 * errors[0]
        assert numpy.isfinite(errors).all()


NEW = ("velocity", "roots", "breather", "multipliers", "front", "map")


def test_every_quantity_of_the_plan_is_discovered_once():
    names = [benchmark.name for benchmark in all_benchmarks()]
    assert names == sorted({"sum", *NEW, "chain", "own-chain", "friction", "derivation"})
    # A quantity of the registry with useful errors is timed, and no other.
    registered = importlib.import_module("verification.quantities.registry").all_quantities()
    assert names == sorted(each.name for each in registered if each.useful)


@pytest.mark.parametrize("benchmark", all_benchmarks(), ids=lambda benchmark: benchmark.name)
def test_a_quantity_draws_its_default_and_has_useful_errors(benchmark):
    style = benchmark.style
    assert quantity_of(benchmark).default in style.methods
    assert len(set(style.methods.values())) == len(style.methods)  # told apart
    low, high = quantity_of(benchmark).useful
    assert 0 < low < high <= style.garbage or benchmark.name == "derivation"
    # Whatever is said about methods is said of methods that there are.
    spoken_of = {*benchmark.variants, *benchmark.others, *benchmark.reasons, *benchmark.first}
    assert spoken_of <= set(style.methods)
    assert quantity_of(benchmark).default in benchmark.first
    assert len(benchmark.first) > 1  # a peer beside it


@pytest.mark.parametrize("benchmark", all_benchmarks(), ids=lambda benchmark: benchmark.name)
def test_the_stored_record_of_every_quantity_is_complete(benchmark):
    record = read_record(RESULTS / f"{benchmark.name}.json")
    assert record.metadata.machine["processor"]
    assert record.metadata.versions["numpy"]
    assert (RESULTS / f"{benchmark.name}.svg").is_file()
    if staleness(record.metadata.code):
        return  # it says so; problems and methods may have changed since
    assert record.first_calls
    accuracy = quantity_of(benchmark).accuracy
    assert all(apart <= accuracy for apart in record.agreement.values())
    seen = {point.method for point in record.points}
    failed = {failure.method for failure in record.failures}
    assert set(record.agreement) == _problems(benchmark)
    assert {point.problem for point in record.points} == _problems(benchmark)
    assert set(benchmark.style.methods) <= seen | failed  # whoever is drawn was tried
    assert seen <= set(benchmark.style.methods)  # and whoever was measured is drawn
    with (RESULTS / f"{benchmark.name}.csv").open(encoding="utf-8") as file:
        rows = [(row["method"], row["setting"], float(row["error"])) for row in DictReader(file)]
    assert rows == [(point.method, point.knob, point.error) for point in record.points]


@pytest.mark.parametrize("benchmark", all_benchmarks(), ids=lambda benchmark: benchmark.name)
def test_the_choice_of_every_default_is_stored_and_follows_from_the_record(benchmark):
    stored = json.loads((RESULTS / "defaults.json").read_text())["choices"]
    mine = [row for row in stored if row["quantity"] == benchmark.name]
    record = read_record(RESULTS / f"{benchmark.name}.json")
    found = choice.choices(benchmark, quantity_of(benchmark), record)
    assert mine == json.loads(json.dumps(choice.as_payload(found)))
    assert all(row["default"] == quantity_of(benchmark).default for row in mine)
    assert all(row["reasons"].keys() == {each["by"] for each in row["beaten"]} for row in mine)
    assert all(choice.NO_REASON not in row["reasons"].values() for row in mine)
    if not staleness(record.metadata.code):
        assert {row["problem"] for row in mine} == _problems(benchmark)


def _problems(benchmark):
    return {problem.name for problem in quantity_of(benchmark).timed_problems}


def _choices(record, **options):
    quantity = Quantity(
        name="q", title="", equation="(1)", problems="sum", reference="r", accuracy=0.1,
        default="ours", useful=(1e-6, 1e-1),
    )  # fmt: skip
    benchmark = WorkPrecision(name="q", prepare=None, style=None, **options)
    return choice.choices(benchmark, quantity, record)


def _record(*points):
    rows = tuple(WorkPoint("q", "s", m, "k", e, None, t, t, 3) for m, e, t in points)
    return BenchmarkRecord(agreement={"s": 0.0}, points=rows, failures=(), targets=())


def test_a_default_is_judged_at_each_decade_of_error():
    record = _record(
        ("ours", 5e-3, 1.0), ("ours", 5e-5, 2.0), ("peer", 5e-2, 0.1), ("peer", 5e-4, 1.0),
        ("exact", 1e-9, 9.0),
    )  # fmt: skip
    (row,) = _choices(record)
    # At 0.1 the peer takes 0.1 s; at 1e-3 it takes 1 s and ours 2 s; below 1e-5 ours has nothing.
    assert row.fastest == (1e-2, 1e-4)
    assert [(b.error, b.by, b.factor) for b in row.beaten] == [
        (1e-1, "peer", 10.0),
        (1e-3, "peer", 2.0),
        (1e-5, "exact", None),
        (1e-6, "exact", None),
    ]
    assert not row.lower_envelope
    assert "exact is faster: 1e-05 (not reached)" in choice.as_text([row])


def test_a_default_that_is_never_beaten_is_the_lower_envelope():
    record = _record(("ours", 1e-9, 1.0), ("peer", 1e-9, 0.95))  # within the noise of a tenth
    (row,) = _choices(record)
    assert row.lower_envelope


def test_errors_that_the_reference_cannot_tell_are_not_compared():
    record = _record(("ours", 1e-9, 1.0), ("peer", 1e-9, 0.1))
    blurred = dataclasses.replace(record, agreement={"s": 1e-3})
    (row,) = _choices(blurred)
    assert [each.error for each in row.beaten] == [1e-1, 1e-2, 1e-3]


def test_a_variant_of_the_default_is_no_rival():
    record = _record(("ours", 1e-9, 1.0), ("ours, in a batch", 1e-9, 0.1))
    assert _choices(record, variants=("ours, in a batch",))[0].lower_envelope


def test_a_method_that_solves_another_problem_is_no_rival_and_is_named():
    record = _record(("ours", 1e-9, 1.0), ("one root", 1e-9, 0.1), ("peer", 1e-2, 0.5))
    others = {"one root": "one root in an interval", "absent": "not in the record"}
    (row,) = _choices(record, others=others, reasons={"peer": "it is inexact"})
    assert {each.by for each in row.beaten} == {"peer"}
    assert row.reasons == {"peer": "it is inexact"}
    assert row.others == {"one root": "one root in an interval"}
    text = choice.as_text([row])
    assert "the default is kept: it is inexact" in text
    assert "one root is not comparable: one root in an interval" in text
    assert "stale: it does not state the code on which it depends" in text


def test_a_rival_without_a_reason_is_said_to_have_none():
    record = _record(("ours", 1e-9, 1.0), ("peer", 1e-9, 0.1))
    (row,) = _choices(record)
    assert row.reasons == {"peer": choice.NO_REASON}


def test_the_first_call_is_cold_then_loaded_and_a_failure_says_why(tmp_path, monkeypatch):
    (tmp_path / "slow_start.py").write_text(
        "import os, pathlib, time\n"
        "done = pathlib.Path(os.environ['NUMBA_CACHE_DIR'], 'done')\n"
        "here = []\n"
        "def call():\n"
        "    if not done.exists():\n"
        "        time.sleep(0.5)\n"  # as if it compiled
        "        done.touch()\n"
        "    elif not here:\n"
        "        time.sleep(0.1)\n"  # as if it loaded
        "    here.append(1)\n"
        "class BENCHMARK:\n"
        "    first = {'it': call, 'broken': lambda: 1 / 0, 'slow': lambda: time.sleep(9)}\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    found = first_call.first_call("slow_start", "it")
    assert 0.5 <= found.cold < 3.0
    assert 0.1 <= found.loaded < found.cold
    assert found.again < 0.1
    assert "ZeroDivisionError" in first_call.first_call("slow_start", "broken").reason
    assert first_call.first_call("slow_start", "slow", limit=2.0).cold is None


def test_a_record_without_the_default_method_is_refused():
    with pytest.raises(ValueError, match="no point of ours"):
        _choices(_record(("peer", 1e-9, 1.0)))


def test_the_fit_of_growth_finds_a_power_and_sees_the_larger_half():
    assert growth.slope([1, 10, 100], [2, 2e3, 2e6]) == pytest.approx(3.0)
    assert math.isnan(growth.slope([1, 10], [0.0, 1.0]))


def test_growth_is_measured_at_every_size(monkeypatch):
    seen = []
    work = growth.Work("w", "sites", seen.append, (1, 2, 4), (8,), 1.0, "why", 2)
    monkeypatch.setattr(growth, "WORKS", (work,))
    (row,) = growth.measure(True, lambda _: None)
    assert row.sizes == (1.0, 2.0, 4.0)
    assert seen.count(4) == 3  # twice for the time, once for the memory
    assert len(row.seconds) == len(row.megabytes) == 3
    assert json.dumps(growth.as_payload([row], "c"), allow_nan=False)


def test_the_stored_growth_covers_what_was_promised():
    rows = json.loads((RESULTS / "growth.json").read_text())["lines"]
    ends = {row["name"]: (row["sizes"][0], row["sizes"][-1]) for row in rows}
    assert ends["front of (43), moving window"] == (10, 1e5)
    assert {row["size_name"] for row in rows} == {"sites", "digits", "1/v", "points", "workers"}


@pytest.mark.parametrize("name", ["roots", "multipliers"])
def test_a_quick_run_gives_a_small_error_and_a_record(name, answered, tmp_path, monkeypatch):
    def missing(*_):
        raise ModuleNotFoundError("cxroots")

    monkeypatch.setattr(roots, "_contour", missing)  # where it is installed, it takes 20 s
    monkeypatch.setattr(Effort, "repeats", lambda *_: 1)  # errors are asked, no seconds
    (record,) = answered(["bench", name, "--quick", "--out", str(tmp_path)])["records"].values()
    (benchmark,) = chosen([name])
    ours = [
        point for point in record["points"] if point["method"] == quantity_of(benchmark).default
    ]
    assert min(point["error"] for point in ours) < 1e-11  # what the default is good for
    written = read_record(tmp_path / f"{name}.json")
    assert [point.error for point in written.points] == [p["error"] for p in record["points"]]
    assert (tmp_path / f"{name}.svg").read_text().startswith("<?xml")
    assert {row["quantity"] for row in json.loads((tmp_path / "defaults.json").read_text())[
        "choices"
    ]} == {name}  # fmt: skip


def test_missed_roots_are_counted_and_not_passed_over():
    true = [1 + 1j, 2 + 1j, 3 + 1j]
    assert roots.largest_error(
        [1 + 1j, 2 + 1j, complex("nan"), 3 + 1.0001j], true
    ) == pytest.approx(1e-4)
    with pytest.raises(roots.MissedRootsError, match="2 of 3"):
        roots.largest_error([1 + 1j, complex("nan")], true)


def test_a_smooth_average_of_the_intervals_ignores_a_ripple():
    n = numpy.arange(300)
    arrivals = 2.0 * n + 0.1 * numpy.sin(1.7 * n)  # a ripple of a twentieth of the interval
    assert front.smooth_velocity(arrivals) == pytest.approx(0.5, abs=1e-9)


def test_multipliers_are_paired_before_they_are_compared():
    one = numpy.array([1.0, 0.5 + 0.5j, 0.5 - 0.5j])
    assert multipliers.largest_distance(one[[2, 0, 1]] + 1e-7, one) == pytest.approx(1e-7)


def test_bench_lists_every_quantity(capsys, answered):
    rows = answered("bench --list")["quantities"]
    assert [row["name"] for row in rows] == [benchmark.name for benchmark in all_benchmarks()]
    assert all(row["default"] in row["methods"] for row in rows)
    assert main(["bench", "--list"]) == 0
    text = capsys.readouterr().out
    assert all(benchmark.name in text for benchmark in all_benchmarks())
    assert "growth" in text
    assert main(["bench", "--list", "roots"]) == 0
    assert len(capsys.readouterr().out.strip().splitlines()) == 2  # no growth, which was not named


def test_bench_judges_the_defaults(capsys, answered):
    found = answered("bench --defaults")
    assert found["missing"] == []
    assert {row["quantity"] for row in found["choices"]} == {each.name for each in all_benchmarks()}
    assert main(["bench", "roots", "--defaults"]) == 0
    assert "labelled roots" in capsys.readouterr().out


def test_defaults_without_records_say_how_to_make_them(capsys, tmp_path):
    assert main(["bench", "--defaults", "--out", str(tmp_path)]) == 2
    assert "no record" in capsys.readouterr().err


def test_without_the_source_tree_bench_says_where_the_benchmarks_are(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(bench, "ROOT", tmp_path)
    assert main(["bench", "--list"]) == 2
    told = capsys.readouterr().err
    assert "source tree" in told
    assert len(told.strip().splitlines()) == 1


README_NUMBERS = [
    ("chain", "against scipy, at equal error", "| 100 times;", 1.0),
    ("chain", "against jitcode, at equal error", "; 4.4 times (not met: 5 times) |", 1.0),
    ("chain", "map of Fig. 15, full", "| 9.5 s;", 1.0),
    ("chain", "map of Fig. 15, envelope", "; 1.6 s |", 1.0),
    ("chain", "all thresholds of Fig. 11", "| 0.40 s |", 1.0),
    ("own-chain", "against heyoka, lattice", "| 3.9 times;", 1.0),
    ("own-chain", "against jitcode dop853, lattice", "; 1.7 times |", 1.0),
    ("own-chain", "against heyoka, next-nearest", "| 1.0 times;", 1.0),
    ("own-chain", "against jitcode dop853, next-nearest", "; 2.2 times |", 1.0),
    ("friction", "against scipy's best, at equal error", "148 times", 1.0),
    ("sum", "sum, vectorised, v and c from 0.3 to 3", "| 3.6e6 a second |", 1.0),
    ("sum", "all branches and admissibility at c", "| 0.99 ms;", 1.0),
    ("sum", "curve of 1000 couplings", "; 0.089 s |", 1.0),
    ("sum", "fronts kinetic", "| 0.21 s |", 1.0),
    ("sum", "2000 labelled roots", "| 2.6 ms;", 1e3),
    ("sum", "2000 certified roots", "; 0.40 s |", 1.0),
]


@pytest.mark.parametrize(("record", "claim", "shown", "unit"), README_NUMBERS)
def test_the_readme_shows_the_numbers_of_the_records(
    record: str, claim: str, shown: str, unit: float
) -> None:
    stored = json.loads((RESULTS / f"{record}.json").read_text(encoding="utf-8"))
    (target,) = [one for one in stored["targets"] if claim in one["claim"]]
    number = re.search(r"[\d.]+(e\d+)?", shown)
    assert float(number.group()) == pytest.approx(unit * target["measured"], rel=0.06)
    assert ("not met" in shown) == (target["verdict"] == "not met")
    table = (RESULTS.parents[1] / "README.md").read_text(encoding="utf-8").replace("\n", " ")
    assert shown in table


def test_operations_are_counted_as_by_hand():
    """Of (8): ẏ costs nothing, ÿ has six products and seven sums; c and ε are multiplied before."""
    done = floor.Operations()
    y, w = floor.Counting(0.5, done), floor.Counting(0.25, done)
    parameters = (4.0, 0.5, 0.6, 0.01)
    _, slope = vdp_acceleration((y, w), (y, w), (y, w), parameters)
    assert (done.simple, done.divisions) == (13.0, 0.0)
    assert slope.value == vdp_acceleration(*[(0.5, 0.25)] * 3, parameters)[1]
    z = floor.Counting(1.0 + 2.0j, floor.Operations())
    assert ((z * z + 1.0) * 2.0).done.simple == 6.0 + 1.0 + 2.0
    assert (1.0 / floor.Counting(2.0, z.done)).done.divisions == 1.0


def test_operations_of_a_series_are_counted_as_by_hand():
    """Of (5), from order k to k + 1: three for each of the k + 1 terms of the exponential, and
    twelve: one for y, three for both neighbours, seven for w and one that scales the exponential.
    """
    done = [floor.of_site_series(FrictionChain(c=0.05), order).simple for order in (10, 11, 12)]
    assert [after - before for before, after in itertools.pairwise(done)] == [
        3.0 * 11 + 12.0,
        3.0 * 12 + 12.0,
    ]


def test_a_sum_costs_in_proportion_to_its_points_and_counting_does_not_change_it():
    v, c = numpy.array([1.0]), numpy.array([0.5])
    counts, _ = axis.plan(numpy.repeat(v, 2), numpy.array([0.5, 0.9]), 1e-12)
    one, two = floor.of_sums(v, c, 1e-12), floor.of_sums(v, numpy.array([0.9]), 1e-12)
    assert one.simple / two.simple == pytest.approx(counts[0] / counts[1])
    assert one.divisions == 2 * 1 * (counts[0] // 4)
