"""The benchmarks measure what they say: turns, medians, failures by name, honest errors."""

import itertools
import time

import pytest

from benchmarks import friction, piecewise_suite, piecewise_targets, tables
from benchmarks.diagram import worth_choosing
from benchmarks.piecewise_sum import contenders, references
from benchmarks.record import Record, Target, WorkPoint, read_record, write_record
from benchmarks.runner import (
    Answer,
    Contender,
    Effort,
    TooSlowError,
    measure_side_by_side,
    time_limit,
)
from theory.friction_chain import FrictionChain
from verification.friction_run import run_friction
from verification.friction_start import nucleus
from verification.scenes import scene_named


def _fake(method, log, value=1.0, claimed=0.5, **options):
    def evaluate():
        log.append(method)
        return Answer(value, claimed)

    return Contender(method, "knob", evaluate, 1.25, **options)


def test_methods_take_turns_and_the_first_call_is_apart():
    log = []
    ticks = itertools.count()
    points, failures = measure_side_by_side(
        "sum",
        "fake",
        [_fake("a", log), _fake("b", log, batch=4)],
        Effort(seconds=0.0, fewest=3, most=3),
        clock=lambda: float(next(ticks)),
    )
    assert log == ["a", "b"] * 4
    assert failures == ()
    assert [(p.repeats, p.seconds, p.first_seconds) for p in points] == [
        (3, 1.0, 1.0),
        (3, 0.25, 0.25),  # a batch of four
    ]
    assert [p.error for p in points] == [0.25, 0.25]
    assert all(p.honest for p in points)


def test_the_median_ignores_one_slow_call():
    # start and end of the first call, then of three repeats lasting 1, 100 and 1
    clock = iter([0.0, 1.0, 0.0, 1.0, 0.0, 100.0, 0.0, 1.0])
    (point,), _ = measure_side_by_side(
        "sum", "fake", [_fake("a", [])], Effort(0.0, 3, 3), clock=lambda: next(clock)
    )
    assert point.seconds == 1.0


def test_a_failure_is_listed_by_name_and_does_not_stop_the_others():
    def broken():
        raise ArithmeticError("no root\nfound")

    points, failures = measure_side_by_side(
        "sum", "fake", [Contender("x", "k", broken, 0.0), _fake("a", [])], Effort(0.0, 1, 1)
    )
    assert [p.method for p in points] == ["a"]
    assert [(f.method, f.reason) for f in failures] == [("x", "ArithmeticError: no root found")]


def test_a_call_that_takes_too_long_is_given_up():
    with pytest.raises(TooSlowError, match=r"0\.05 s"), time_limit(0.05):
        time.sleep(5.0)
    time.sleep(0.06)  # and the alarm is off again


def test_an_error_beyond_the_claim_is_seen():
    (point,), _ = measure_side_by_side(
        "sum", "fake", [_fake("a", [], claimed=0.1)], Effort(0.0, 1, 1)
    )
    assert not point.honest


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
    rows = piecewise_targets.ratio_targets(points, "s")
    assert rows[0].measured == pytest.approx(200.0)
    assert rows[0].verdict == "met"


def test_a_line_of_the_diagram_joins_only_settings_that_none_beats():
    def point(error, seconds):
        return WorkPoint("sum", "s", "m", "k", error, None, seconds, seconds, 3)

    fast, beaten, exact = point(1e-3, 1.0), point(1e-3, 2.0), point(1e-9, 3.0)
    assert worth_choosing([exact, beaten, fast]) == ([fast, exact], [beaten])


def test_a_record_survives_writing_and_shows_its_failings(tmp_path):
    point = WorkPoint("sum", "s", "m", "k", 2.0, 1.0, 0.1, 0.1, 3)
    missed = Target("speed", 2.0, "below", 1.0, "s", "detail")
    run = Record("c", "d", {"system": "x"}, {"numpy": "1"}, {"s": 0.0}, (point,), (), (missed,))
    write_record(run, tmp_path / "run.json")
    assert read_record(tmp_path / "run.json") == run
    text = tables.as_text(run)
    assert "WORSE THAN IT CLAIMS" in text
    assert "not met" in text


@pytest.mark.parametrize("name", piecewise_suite.SCENES)
def test_the_error_of_every_quick_method_is_within_its_claim(name):
    scene = scene_named(name)
    known = references(scene.v, scene.c)
    assert known.apart < 1e-55  # 60 digits asked of both, by methods that share no code
    ours = [each for each in contenders(scene, known) if each.quick and not each.peer]
    points, failures = measure_side_by_side("sum", name, ours, Effort(0.0, 1, 1))
    assert [point for point in points if not point.honest] == []
    # The plain quadrature says that it cannot do small v; nothing else may fail.
    assert {failure.method for failure in failures} <= {"quadrature in pieces"}
    assert all("PrecisionError" in failure.reason for failure in failures)


def test_friction_targets_compare_at_equal_error_and_leave_garbage_out():
    def point(method, error, seconds):
        return WorkPoint("q", "s", method, "k", error, None, seconds, seconds, 1)

    found = friction.targets(
        [
            point(friction.EXACT, 1e-2, 0.001),
            point(friction.EXACT, 1e-6, 0.01),
            point("scipy LSODA", 0.5, 0.0001),  # garbage, however fast
            point("scipy LSODA", 1e-1, 0.2),
            point("scipy BDF", 1e-3, 0.3),  # only the slower of ours is as exact
        ]
    )[0]
    assert found.measured == pytest.approx(30.0)
    assert found.verdict == "not met"
    assert "1 of 3" in found.detail


def test_every_friction_method_gives_its_largest_error():
    np = pytest.importorskip("numpy")
    chain = FrictionChain(friction.COUPLING, sites=friction.SITES)
    start = nucleus(chain, [1])
    true = run_friction(chain, start, friction.T_END, samples=friction.SAMPLES).y
    rows = friction.contenders(chain, start, true, quick=True)
    seen = {}
    for row in rows:
        if not row.peer:
            seen.setdefault(row.method, []).append(row.evaluate().value)
    assert set(seen) == {friction.EXACT, friction.FIXED, friction.ADAPTIVE}
    # Finer settings are more exact, in every family.
    for errors in seen.values():
        assert errors[-1] < 0.1 * errors[0]
        assert np.isfinite(errors).all()
