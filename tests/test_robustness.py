"""The robustness table: a fast part of it, and that it can see what it is there to see."""

from __future__ import annotations

import itertools
import json
import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fronts.cli import main
from fronts.commands import bench
from fronts.commands.stress import _MAX_SHOWN, _text
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from theory.piecewise.sums.result import PrecisionError
from verification.quantities import breathers, fronts, judging, own_chains
from verification.quantities.friction import cycle_by_scipy, stable_cycle
from verification.quantities.judging import BAD, PointOutcome, is_clear, judge
from verification.quantities.quantity import Axis, Computation, ReferenceCheck, StatedValue
from verification.quantities.registry import all_computations, computation_named
from verification.quantities.robustness import Robustness, points_of, robustness
from verification.references import pace

pytestmark = pytest.mark.usefixtures("unhurried")

QUICK = ("c-pin", "c-retreat", "eta-pin", "strong-coupling-velocity")
POINTS = {
    "sigma-integral": 30,
    "roots": 50,
    "closed-form-fold": 40,
    "closed-form-breather": 40,
    "c-fold": 14,
    "eta-fold": 10,
}
OWN = {
    "k": 0.1, "far": 0.2, "d": 0.3, "spread": 0.1, "c": 2.0, "eps": 0.05, "sites": 20,
    "displacement": 3.0, "tolerance": 1e-8, "force": 0.3,
}  # fmt: skip
RUN = {
    "a": 4.0, "eta": 0.03, "c": 0.6, "eps": 0.01, "sites": 8, "displacement": 2.0,
    "tolerance": 1e-9,
}  # fmt: skip
SLIDING = {
    "c": 0.02, "v_d": 1.25, "v0": 0.5, "xi": 0.05, "mu_st": 1.0, "sites": 4, "displacement": 2.0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "values"),
    [
        # what is compiled for a long time comes first, see conftest.py
        ("run-friction", {**SLIDING, "v_d": 1.1513}),
        ("run-friction", {**SLIDING, "c": 1.0}),
        # steady sliding is unstable: roundings grow a thousandfold and more
        ("run-friction", {**SLIDING, "v_d": 0.11, "v0": 2.9, "mu_st": 4.4, "displacement": 1e-5}),
        # a run at a hundred times the tolerance is right by accident
        (
            "run-friction",
            {
                "c": 0.012352770094605076,
                "v_d": 0.21199667225721808,
                "v0": 0.003649774025879142,
                "xi": 9.045611641016546e-05,
                "mu_st": 4.821828551660506,
                "sites": 1.0,
                "displacement": 0.04205416947900084,
            },
        ),
        ("run-chain", OWN),
        ("run-chain", {**OWN, "eps": 0.2, "sites": 5, "tolerance": 1e-4}),
        ("run-chain", {**OWN, "displacement": 1e-6, "eps": 1e-6, "sites": 60, "force": 1e-6}),
        (
            "profile",
            {"v": 1070.0994714, "c": 0.21, "distance": 0.95, "tolerance": 1e-13, "side": 3},
        ),
        ("profile", {"v": 1e-8, "c": 1e-8, "distance": 1e4, "tolerance": 1e-14, "side": 1}),
        ("kinetic", {"c": 100.0, "eta": 1e-4}),
        ("kinetic", {"c": 2.0, "eta": 0.11}),
        ("envelope-breather", {"eta": 0.08, "c": 0.1}),
        ("envelope-breather", {"eta": 1e-4, "c": 1e-8}),
        ("envelope-breather", {"eta": 0.125 * (1 - 1e-9), "c": 1e-6}),
        ("envelope-breather", {"eta": 0.124875, "c": 1e-8}),
        ("sigma-series", {"v": 0.3, "c": 0.5, "digits": 40}),
        ("run-vdp", {**RUN, "displacement": 1e3, "eps": 1e-3}),
        ("run-vdp", {**RUN, "eps": 0.37, "c": 6.7, "sites": 12.0}),
        ("orbit", {"eta": 0.08, "c": 0.1, "eps": 0.01}),
        ("multipliers", {"eta": 0.03125, "c": 0.1, "eps": 0.01}),
        ("envelope-threshold", {"eta": 0.08}),
        ("front-velocity", {"c": 0.5, "eta": 0.03125}),
        ("front-averaged", {"c": 0.6, "eta": 0.03125}),
        ("front-wave", {"c": 0.6, "eta": 0.03125}),
        ("run-vdp", {**RUN, "sites": 1e5, "displacement": 1e-8}),
        ("run-envelope", {**RUN, "c": 1e-8}),
        (
            "run-vdp",
            {
                "a": 35.96484628969489,
                "eta": 0.12452837424194366,
                "c": 7.083398328862791e-06,
                "eps": 0.7167950895289498,
                "sites": 3520.0,
                "displacement": 1.1597375615635013,
                "tolerance": 1.0586491191425466e-06,
            },
        ),
    ],
)
def test_costly_computations_are_right_at_single_points(
    name: str, values: Mapping[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(own_chains, "_END", 10.0)  # steps in extended precision take long
    monkeypatch.setattr(breathers, "_SITES", 3)  # so do eigenvalues in many digits
    found = judge(computation_named(name), values)
    assert found["outcome"] == PointOutcome.RIGHT.value, found


@pytest.mark.parametrize("name", [*QUICK, *POINTS])
def test_no_point_is_wrong_or_nan_or_crashes(name: str) -> None:
    found = robustness([name], POINTS.get(name, 80), workers=1, seed=0)
    # a slow point may be another process's fault; time is judged by the whole table
    assert not [row for row in found.bad if row["outcome"] != PointOutcome.SLOW.value], found.bad
    assert found.counts["right"] > 0.4 * len(found.table)


def test_what_a_costly_reference_cannot_confirm_it_does_not_refute() -> None:
    """Steady sliding is unstable here: roundings grow a thousandfold and more."""
    sliding = {**SLIDING, "v_d": 0.21, "v0": 1.6, "mu_st": 3.0, "c": 1e-6, "sites": 3.0}
    sliding["displacement"] = 0.5
    found = judge(computation_named("run-friction"), sliding)
    assert found["outcome"] == PointOutcome.UNDECIDED.value, found
    assert float(found["distance"]) < float(found["uncertainty"])


CELL = {"v_d": 1.0, "v0": 0.5, "xi": 0.05, "mu_st": 1.0}


@pytest.mark.parametrize(
    "values",
    [
        {**CELL, "v_d": 2.0, "v0": 1e-6, "mu_st": 2.2},
        {**CELL, "v_d": 5e-3, "v0": 1.2, "xi": 1e-3},
        {**CELL, "v_d": 1e-5, "v0": 100.0, "mu_st": 0.6},  # slides: 2 xi is above its slope
    ],
)
def test_cycles_on_thin_friction_curves_and_slow_belts_are_held_against_scipy(
    values: Mapping[str, float],
) -> None:
    """No limit of v_d or v0 keeps scipy from them: it gives up where it is too slow."""
    assert judge(computation_named("cycle-friction"), values)["outcome"] == PointOutcome.RIGHT.value


@pytest.mark.parametrize("belt", [1e-3, 0.012, 1.0])
def test_a_cycle_that_is_denied_is_seen_however_long_its_stick_phase(belt: float) -> None:
    """The second release of a slow belt comes after thousands of τ; that it sticks is enough."""
    denied = StatedValue(value=np.zeros(2), error=0.0, note="no cycle")
    values = {**CELL, "v_d": belt, "mu_st": 5.0}
    assert stable_cycle(values).value[0] > 0.0
    check = cycle_by_scipy(values, denied)
    assert judging.compared(denied.error, check) is PointOutcome.EXCEEDED


def test_a_belt_too_slow_for_scipy_is_left_unchecked_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With a clock that goes a millisecond on whenever it is read, once a step."""
    milliseconds = itertools.count()
    clock = SimpleNamespace(process_time=lambda: 1e-3 * next(milliseconds))
    monkeypatch.setattr(pace, "time", clock)
    monkeypatch.setattr(pace, "MAX_SECONDS", 0.1 * pace.MAX_SECONDS)  # this clock is never slow
    found = judge(computation_named("cycle-friction"), {**CELL, "v_d": 1e-8, "v0": 1e-6})
    assert found["outcome"] == PointOutcome.UNCHECKED.value
    assert "too stiff or too long" in str(found["said"])
    assert clock.process_time() < 0.06 * pace.MAX_SECONDS  # 0.05 of it are the first part


def test_the_reference_of_a_running_front_knows_its_velocity(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It once stepped another chain, and was uncertain by more than any velocity.

    Over so few sites it is uncertain by more than half of the error that is stated, and so does not
    confirm it.
    """
    monkeypatch.setattr(fronts, "_MIN_SITES", 48)
    monkeypatch.setattr(fronts, "_MAX_SITES", 48)
    time, sizes = fronts.arrivals_by_scipy, []

    def timed(*given: Any, amplitude: Any, **how: Any) -> Any:
        sizes.extend(amplitude(given[1]))
        return time(*given, amplitude=amplitude, **how)

    monkeypatch.setattr(fronts, "arrivals_by_scipy", timed)
    found = judge(computation_named("front-vdp"), {"c": 0.6, "eta": 0.03125, "eps": 0.15})
    stable = VdpChain(a=4.0, b=0.5, c=0.6).stable_amplitude
    assert sizes == pytest.approx([stable] * 24 + [0.0] * 56)
    assert found["outcome"] == PointOutcome.UNDECIDED.value, found
    assert float(found["distance"]) < float(found["uncertainty"]) < 1e-3


def test_a_breather_that_pulses_keeps_its_label() -> None:
    """Far from a harmonic motion |Ψ| itself changes manifold within a period."""
    pulsing = {"eta": 0.03, "c": 0.01, "displacement": 3.0, "eps": 0.5}
    assert judge(computation_named("label-vdp"), pulsing)["outcome"] == PointOutcome.RIGHT.value


def test_an_orbit_too_stiff_to_be_found_is_refused_at_once() -> None:
    stiff = {"eta": 0.005, "c": 1e-6, "eps": 1.0}  # it once took more than 100 s
    for name in ("orbit", "multipliers"):
        found = judge(computation_named(name), stiff)
        assert found["outcome"] == PointOutcome.REFUSED.value
        assert float(found["seconds"]) < 1.0


def _computation(compute: object, off: float = 0.0, seconds: float = 1.0) -> Computation:
    return Computation(
        name="made-up",
        title="for this test",
        axes=(Axis(name="x", low=1.0, high=2.0),),
        compute=compute,  # type: ignore[arg-type]
        check=lambda at, stated: ReferenceCheck(distance=off, uncertainty=1e-3, method="this test"),
        seconds=seconds,
    )


def _root_two(noise: float, factor: float) -> Computation:
    """Return √2 to about 1e-6, with ``factor`` times its true error as the error stated.

    The reference knows √2 to the last bit, and says ``noise`` of itself.
    """
    value = 1.414214
    true = value - math.sqrt(2.0)
    return Computation(
        name="made-up",
        title="for this test",
        axes=(Axis(name="x", low=1.0, high=2.0),),
        compute=lambda at: StatedValue(value=value, error=factor * abs(true)),
        check=lambda at, stated: ReferenceCheck(
            distance=abs(true), uncertainty=noise * abs(true), method="square root"
        ),
        seconds=1.0,
    )


@pytest.mark.parametrize(
    ("noise", "factor", "outcome"),
    [
        (0.0, 1.0, "right"),
        (0.5, 1.0, "right"),
        (0.51, 1.0, "undecided"),  # nearly as uncertain as what it is to judge
        (1e6, 1.0, "undecided"),
        (0.4, 0.5, "exceeded"),  # too uncertain to confirm, and yet it refutes
        (0.6, 0.5, "undecided"),
        (0.1, 0.0, "exceeded"),
        (1.0, 0.0, "undecided"),
        (math.nan, 1.0, "exceeded"),
    ],
)
def test_a_reference_confirms_only_what_is_above_its_own_uncertainty(
    noise: float, factor: float, outcome: str
) -> None:
    assert judge(_root_two(noise, factor), {"x": 1.0})["outcome"] == outcome


@pytest.mark.parametrize("share", [0.0, 0.2, 0.45, 0.5])
def test_an_error_understated_by_a_factor_of_two_is_never_confirmed(share: float) -> None:
    """Whatever the reference's own error within its uncertainty: that is what the rule is for."""
    for understated in (2.001, 2.5, 10.0):
        stated = 1.0 / understated
        for own in np.linspace(-1.0, 1.0, 41):
            uncertainty = share * stated
            check = ReferenceCheck(
                distance=abs(1.0 + own * uncertainty), uncertainty=uncertainty, method="another"
            )
            assert judging.compared(stated, check) is PointOutcome.EXCEEDED


def test_what_is_undecided_is_counted_and_shown_and_not_passed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    known = computation_named("c-pin")
    made = replace(_root_two(0.9, 1.0), name=known.name, axes=known.axes)
    monkeypatch.setattr(judging, "computation_named", lambda _: made)
    line = ["stress", "--quantity", "c-pin", "--points", "12", "--workers", "1"]
    assert main([*line, "--json"]) == 0
    counts = json.loads(capsys.readouterr().out)["counts"]
    assert (counts["undecided"], counts["right"]) == (12, 0)
    assert main(line) == 0
    head, row, _ = capsys.readouterr().out.splitlines()[:3]
    assert row.split()[head.split().index("undecided")] == "12"


def _raising(error: Exception) -> object:
    def compute(at: Mapping[str, float]) -> StatedValue:
        raise error

    return compute


def _slow(at: Mapping[str, float]) -> StatedValue:
    total = 0.0
    for _ in range(10**8):
        total += 1.0
    return StatedValue(value=total, error=1.0)


@pytest.mark.parametrize(
    ("quantity", "outcome"),
    [
        (_computation(lambda at: StatedValue(value=1.0, error=0.1), off=0.05), PointOutcome.RIGHT),
        (
            _computation(lambda at: StatedValue(value=1.0, error=0.1), off=0.2),
            PointOutcome.EXCEEDED,
        ),
        (_computation(lambda at: StatedValue(value=math.nan, error=0.1)), PointOutcome.NAN),
        (
            _computation(lambda at: StatedValue(value=np.array([1.0, math.inf]), error=0.1)),
            PointOutcome.NAN,
        ),
        (_computation(lambda at: StatedValue(value=1.0, error=math.inf)), PointOutcome.NAN),
        (
            _computation(_raising(ParameterError("x", 1, "below 1", "take less"))),
            PointOutcome.REFUSED,
        ),
        (
            _computation(_raising(PrecisionError("x = 1 is too much; take less."))),
            PointOutcome.REFUSED,
        ),
        (_computation(_raising(PrecisionError("no"))), PointOutcome.CRASH),
        (_computation(_raising(ZeroDivisionError())), PointOutcome.CRASH),
        (_computation(_slow, seconds=0.004), PointOutcome.SLOW),
    ],
)
def test_every_outcome_differs_from_the_others(
    quantity: Computation, outcome: PointOutcome
) -> None:
    assert judge(quantity, {"x": 1.0})["outcome"] == outcome.value


def test_a_wrong_reference_is_a_crash_of_the_table_and_not_a_success() -> None:
    def broken(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
        raise ZeroDivisionError

    quantity = replace(_computation(lambda at: StatedValue(value=1.0, error=0.1)), check=broken)
    assert judge(quantity, {"x": 1.0})["outcome"] == PointOutcome.CRASH.value


def test_an_understated_error_is_seen_in_every_quick_computation() -> None:
    """Move each value by a hundred times its stated error: nearly every point must fail."""
    for name in ("sigma-integral", "c-pin", "eta-pin", "closed-form-fold"):
        quantity = computation_named(name)

        def moved(at: Mapping[str, float], quantity: Computation = quantity) -> StatedValue:
            stated = quantity.compute(at)
            if stated.value is None:
                return stated
            return replace(stated, value=stated.value + 100.0 * (stated.error + 1e-300))

        wrong = replace(quantity, compute=moved)
        found = [judge(wrong, wrong.point(0, i))["outcome"] for i in range(16)]
        claimed = [word for word in found if word not in ("refused", "unchecked", "undecided")]
        right = claimed.count(PointOutcome.RIGHT.value)
        # zero is right where nothing is claimed: c_pin that does not exist
        assert claimed.count(PointOutcome.EXCEEDED.value) > right / 2, (name, found)


def test_the_points_of_each_quantity_are_spread_over_the_whole() -> None:
    """So that a tenth of the points is a tenth of the work, and the time left can be estimated."""
    found = points_of((), 1000)
    total = Counter(str(point["quantity"]) for point in found)
    for part in (0.1, 0.5, 0.9):
        done = Counter(str(point["quantity"]) for point in found[: round(part * len(found))])
        assert all(abs(done[name] - part * count) <= 1.5 for name, count in total.items())
    for name, count in total.items():
        numbers = [point["number"] for point in found if point["quantity"] == name]
        assert numbers == list(range(count))


def test_points_are_the_same_again_and_others_with_another_seed() -> None:
    quantity = computation_named("sigma-integral")
    index = 2 * len(quantity.fixed_points) + 3
    assert quantity.point(1, index) == quantity.point(1, index) != quantity.point(2, index)
    bad = [quantity.point(0, 20 * i + 19) for i in range(10, 60)]
    odd = [p for p in bad if not all(a.low <= p[a.name] <= a.high for a in quantity.axes)]
    assert len(odd) == len(bad)


def test_what_must_not_happen_is_what_the_command_complains_of() -> None:
    neither = {PointOutcome.REFUSED, PointOutcome.UNDECIDED, PointOutcome.UNCHECKED}
    assert {*BAD, PointOutcome.RIGHT, *neither} == set(PointOutcome)
    assert not is_clear("two sentences.\nhere.")


def test_a_quantity_named_twice_is_tried_once(answered: Any) -> None:
    counts = []
    for names in (["c-pin"], ["c-pin", "c-pin"], ["c-pin", "eta-pin", "c-pin"]):
        options = [word for name in names for word in ("--quantity", name)]
        found = answered(["stress", "--points", "20", "--workers", "1", *options])
        assert found["out"] is None
        assert sum(found["counts"].values()) == found["points"]
        counts.append([(one["quantity"], one["points"]) for one in found["quantities"]])
    assert counts[0] == counts[1]
    assert [name for name, _ in counts[2]] == ["c-pin", "eta-pin"]


def test_without_options_a_thousand_points_are_tried_and_the_file_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A table of points is written as they are tried, and not once more at the end."""
    plain = robustness(("c-pin",), 12, 0, workers=1)
    asked: list[object] = []

    def tried(quantities: tuple[str, ...], points: int, seed: int, **_: object) -> Robustness:
        asked.append((quantities, points, seed))
        return plain

    monkeypatch.setattr("verification.quantities.robustness.robustness", tried)
    for name in ("", "found.json", "found.csv"):
        options = ["--out", str(tmp_path / name)] if name else []
        assert main(["stress", "--json", *options]) == 0
        assert json.loads(capsys.readouterr().out)["out"] == (options[1] if name else None)
    assert asked == [((), 1000, 0)] * 3
    for name in ("found.gif", "found.mp4"):  # a table is no film
        assert main(["stress", "--json", "--out", str(tmp_path / name)]) == 2
        assert name in json.loads(capsys.readouterr().err)["error"]["value"]
    assert len(asked) == 3
    assert [path.name for path in tmp_path.iterdir()] == ["found.json"]


def test_the_command_refuses_what_it_does_not_know(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stress", "--quantity", "nothing"]) == 2
    assert "quantity = nothing" in capsys.readouterr().err
    assert main(["stress", "--resume"]) == 2
    assert main(["stress", "--list"]) == 0
    said = capsys.readouterr().out
    assert all(f"({each.limits})" in said for each in all_computations() if each.limits)


def test_what_is_bad_is_named_and_recorded_where_the_report_finds_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In words the first of it; an infinite distance is none in JSON."""
    plain = robustness(("c-pin",), 12, 0, workers=1)
    row = {"outcome": "exceeded", "quantity": "c-pin", "values": "eta = 0.1", "said": "0.5",
           "stated": 1e-9, "distance": math.inf, "by": "another"}  # fmt: skip
    found = replace(plain, bad=(row,) * (_MAX_SHOWN + 2))
    monkeypatch.setattr("verification.quantities.robustness.robustness", lambda *_, **__: found)
    monkeypatch.setattr(bench, "ROOT", tmp_path)
    assert main(["stress", "--record"]) == 2
    assert "source tree" in capsys.readouterr().err
    (tmp_path / "benchmarks" / "results").mkdir(parents=True)
    (tmp_path / "benchmarks" / "work_precision.py").touch()
    assert main(["stress", "--record", "--points", "12", "--seed", "3"]) == 1
    said = capsys.readouterr().out.splitlines()[-_MAX_SHOWN - 1 :]
    line = "exceeded: c-pin at eta = 0.1: 0.5 (stated 1e-09, distance inf, another)"
    assert said == [line] * _MAX_SHOWN + ["and 2 more; --json or --out has them all."]
    assert _text(replace(plain, bad=(row,) * _MAX_SHOWN)).splitlines()[-_MAX_SHOWN:] == said[:-1]
    kept = json.loads((tmp_path / "benchmarks" / "results" / "stability.json").read_text())
    assert kept["bad"][0] == row | {"distance": None}
    assert kept["command"] == "fronts stress --points 12 --seed 3"


def test_what_a_reference_is_called_can_be_written_to_a_table() -> None:
    """Text with commas and quotes would be misread in CSV."""
    known = computation_named("c-pin")
    named = replace(
        known,
        check=lambda *_: ReferenceCheck(distance=0.0, uncertainty=0.0, method='scipy, "timed"'),
    )
    assert judge(named, {"eta": 0.03})["by"] == "scipy; 'timed'"
