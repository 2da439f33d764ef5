"""Checks of sums, roots, shapes, velocities, runs and labels see what is made wrong.

As in ``tests/test_stability_checks.py``: small problems, or results that are made up.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from theory.chains.vdp import VdpChain
from theory.piecewise.folds import fold_coupling, fold_eta
from theory.piecewise.kinetic_relation import kinetic_relation
from theory.piecewise.limits import ETA_PIN_END, pinning_coupling, static_sum_distance
from theory.piecewise.root_count import count_in_strips
from theory.piecewise.roots import labelled_roots
from verification.fronts.result import LeftBoundary
from verification.fronts.status import FrontStatus
from verification.fronts.wave import front_wave
from verification.maps.state import State
from verification.quantities import fronts, roots, runs, states, sums
from verification.quantities import kinetic_relation as relation
from verification.quantities.judging import PointOutcome, compared, judge
from verification.quantities.quantity import ReferenceCheck, StatedValue
from verification.quantities.registry import computation_named
from verification.quantities.scipy_states import compared as states_compared
from verification.quantities.scipy_states import moving_sites
from verification.references import passages
from verification.references.equations import as_complex
from verification.references.extrapolation import PreciseState
from verification.references.pace import NoReferenceError
from verification.references.piecewise import static_sum

# ------------------------------------------------------------------------------------------- sums


def test_distances_are_of_as_many_digits_as_are_asked() -> None:
    with mp.workdps(60):
        one, other = mp.mpf(1), mp.mpf(1) + mp.mpf(10) ** -40
    assert sums.distance(one, other, 45) == pytest.approx(1e-40, rel=1e-4, abs=0.0)
    assert sums.distance(other, one, 45) == sums.distance(one, other, 45)


def test_a_reference_has_four_digits_more_than_the_error_that_it_judges() -> None:
    assert [sums.needed_digits(error) for error in (0.0, 3e-41, 1e-16, 1e-3)] == [304, 45, 20, 20]


def test_the_reference_of_the_sum_is_one_that_reaches_there() -> None:
    """The series where roots are few, the static limit where v is small, else the integral."""
    for v, c, by in ((1e4, 1e3, "series"), (1e-7, 1.0, "static limit"), (0.3, 0.5, "series")):
        value, uncertainty, method = sums.reference_sum(v, c, 20)
        assert method == by
        assert uncertainty < 1e-20
        other = sums.reference_sum(v, c, 20, without=by)[0] if by == "series" else None
        if other is not None and v < 1.0:
            assert abs(value - other) < 1e-19


@pytest.mark.parametrize(
    ("v", "c", "by"),
    [
        (30.0, 1e4, "series"),
        (0.3, 0.5, "series"),
        (1.0, 2e3, "integral in many digits"),
        (0.5, 1e3, "integral in many digits"),
        (1e-7, 1.0, "static limit"),
    ],
)
def test_roots_are_summed_where_there_are_at_most_some_thousand(
    v: float, c: float, by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """About one for each unit of c/v; the sums themselves are made up."""
    monkeypatch.setattr(sums, "sum_by_roots", lambda *_: SimpleNamespace(value=1.0, error=0.0))
    monkeypatch.setattr(
        sums, "precise_sum_by_integral", lambda *_: SimpleNamespace(value=1.0, error=0.0)
    )
    assert sums.reference_sum(v, c, 20)[2] == by


def test_the_static_limit_has_as_many_digits_as_are_asked() -> None:
    value, uncertainty, _ = sums.reference_sum(1e-7, 1.0, 40)
    with mp.workdps(60):
        assert abs(value - static_sum(mp.mpf(1))) <= uncertainty < 1e-40
    _, uncertainty, by = sums.reference_sum(0.01, 1.0, 20, without="series")
    assert by == "static limit"
    assert 1e-22 < static_sum_distance(0.01, 1.0) <= uncertainty < 1e-20


@pytest.mark.parametrize("name", ["integral", "series", "precise-integral", "bessel", "quadrature"])
def test_no_method_of_the_sum_is_its_own_reference(name: str) -> None:
    row = computation_named(f"sigma-{name}")
    given = {"v": 0.3, "c": 0.5, "tolerance": 1e-8, "digits": 8.0}
    at = {axis.name: given[axis.name] for axis in row.axes}
    stated = row.compute(at)
    check = row.check(at, stated)
    assert compared(stated.error, check) is PointOutcome.RIGHT
    assert check.method == ("integral in many digits" if name == "series" else "series")
    for off in (1e-4, -1e-4j):
        assert row.check(at, replace(stated, value=stated.value + off)).distance == pytest.approx(
            1e-4, rel=1e-3
        )


# ------------------------------------------------------------------------------- roots and shapes


@pytest.mark.parametrize("side", [1.0, 2.0, 3.0, 4.0])
def test_a_root_is_as_far_off_as_it_is_relative_to_its_size(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    counted: list[bool] = []

    def count(*given: Any) -> int:
        counted.append(given[-1])
        return count_in_strips(*given)

    monkeypatch.setattr(roots, "count_in_strips", count)
    row = computation_named("roots")
    at = {"v": 0.3, "c": 0.5, "label": 10.0, "side": side}
    stated = row.compute(at)
    check = row.check(at, stated)
    assert check.distance == 0.0
    assert "argument principle" in check.method
    # In the half plane of the roots.
    assert counted == [side == 1.0]
    assert np.all((stated.extra.k.imag > 0.0) == (side == 1.0))
    found = zip(stated.extra.radius, stated.extra.k, strict=True)
    relative = [mp.mpf(radius) / abs(mp.mpc(k)) for radius, k in found]
    assert stated.error == pytest.approx(float(max(relative)), rel=1e-12)
    for off in (1e-6, -1e-6, 1e-9j):
        k = stated.extra.k.copy()
        k[3] *= 1.0 + off
        wrong = replace(stated, extra=replace(stated.extra, k=k))
        assert row.check(at, wrong).distance == pytest.approx(abs(off), rel=1e-3)


def test_far_ahead_of_a_front_is_rest_and_far_behind_it_the_excited_state() -> None:
    at = {"v": 0.3, "c": 0.5, "distance": 60.0, "tolerance": 1e-9}
    assert abs(roots._profile({**at, "side": 1.0}).value) < 1e-6
    for side in (2.0, 3.0):
        assert abs(roots._profile({**at, "side": side}).value - 1.0) < 1e-6
    # Where all waves have died off, the sum is still rounded.
    stated = roots._profile({**at, "distance": 1e3, "side": 3.0})
    assert stated.error == stated.extra.error > 0.0
    assert 1e-16 < roots._check_profile({**at, "side": 3.0}, stated).uncertainty < 1e-14


@pytest.mark.parametrize("side", [1.0, 3.0])
@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (3.0, 0.05), (2.0, 20.0)])
def test_a_shape_is_as_uncertain_as_its_roots_make_it(
    side: float, v: float, c: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each moved by its radius in the worst direction, to first order."""
    at = {"v": v, "c": c, "distance": 2.0, "tolerance": 1e-12, "side": side}
    stated, radius = roots._profile(at), 1e-7

    def rough(*given: Any) -> Any:
        found = labelled_roots(*given)
        return replace(found, radius=np.full(found.k.size, radius))

    monkeypatch.setattr(roots, "labelled_roots", rough)
    check = roots._check_profile(at, replace(stated, error=1e-3))
    zeta = 2.0 if side < 2 else -2.0
    k = labelled_roots(v, c, np.arange(-400, 401), zeta > 0).k

    def terms(k: np.ndarray) -> np.ndarray:
        found: np.ndarray = np.exp(1j * zeta * k) / (k * (v + c * np.sin(k)))
        return found

    slope = (terms(k + 1e-7) - terms(k - 1e-7)) / 2e-7
    most = 0.5 * radius * float(np.abs(slope).sum())
    assert 0.99 * most <= check.uncertainty < 10.0 * most
    assert check.distance < 1e-9


@pytest.mark.parametrize("side", [1.0, 3.0])
@pytest.mark.parametrize("distance", [0.5, 5e-4])
def test_a_shape_is_as_uncertain_as_the_rest_of_its_series(
    side: float, distance: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside the front itself the waves hardly decay, and all that is left out counts."""
    at = {"v": 0.3, "c": 0.5, "distance": distance, "tolerance": 1e-12, "side": side}
    stated = replace(roots._profile(at), error=1e-3)
    monkeypatch.setattr(roots, "_TERMS", 20)
    check = roots._check_profile(at, stated)
    assert 1e-6 < check.distance <= check.uncertainty < 0.02


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (3.0, 280.0), (280.0, 3.0), (30.0, 2800.0)])
def test_of_a_shape_as_many_roots_are_summed_as_are_crowded_and_some_hundred_more(
    v: float, c: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """About one to either side for each unit of c/v, in which A turns up to 2c/v."""
    asked: list[np.ndarray] = []

    def noted(*given: Any) -> Any:
        asked.append(given[2])
        return labelled_roots(*given)

    monkeypatch.setattr(roots, "labelled_roots", noted)
    at = {"v": v, "c": c, "distance": 30.0, "tolerance": 1e-9, "side": 1.0}
    stated = StatedValue(value=0.0, error=1.0, extra=SimpleNamespace(zeta=np.array([30.0])))
    roots._check_profile(at, stated)
    (labels,) = asked
    assert 2.0 * c / v + 300 <= -labels[0] <= 2.0 * c / v + 1000
    assert 2.0 * c / v + 300 <= labels[-1] <= 2.0 * c / v + 1000


def test_beside_the_front_the_series_is_no_reference_for_an_error_far_below_its_rest() -> None:
    at = {"v": 0.3, "c": 0.5, "distance": 5e-4, "tolerance": 1e-12, "side": 1.0}
    with pytest.raises(NoReferenceError, match="too slowly"):
        roots._check_profile(at, roots._profile(at))


# -------------------------------------------------------------------------- the kinetic relation


def test_where_both_cycles_meet_the_sum_touches_the_threshold_and_there_is_no_front() -> None:
    at = {"c": 0.5, "eta": 0.125}
    stated = relation._velocities(at)
    assert stated.extra.branches == ()
    assert stated.error == 0.0
    assert relation._check_velocities(at, stated).distance == 0.0


@pytest.mark.parametrize("full", [True, False])
def test_a_front_at_rest_is_off_by_the_sites_that_scipy_reaches_in_the_second_half(
    full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Amplitudes are those of oscillations, or of (43): at the start, of the sites excited."""
    seen: list[np.ndarray] = []

    def arrivals(_: object, start: Any, *, amplitude: Any, end: float, **__: object) -> np.ndarray:
        seen.append(amplitude(start))
        return end * np.array([0.1, 0.2, 0.6, 0.9, 0.3, np.nan])

    monkeypatch.setattr(fronts, "arrivals_by_scipy", arrivals)
    at = {"a": 4.0, "eta": 0.03125, "c": 0.1}
    check = fronts._by_scipy(at, StatedValue(value=0.0, error=0.0), full)
    assert check.distance == pytest.approx(2 / fronts._STALL_TIME)
    cycle = VdpChain(a=4.0, b=0.5, c=0.1).stable_amplitude
    excited = np.arange(seen[0].size) < fronts._FILLED
    assert seen[0] == pytest.approx(np.where(excited, cycle, 0.0), abs=1e-12)


@pytest.mark.parametrize(("place", "held"), [(0.5, False), (0.6, True)])
def test_the_height_of_a_maximum_is_checked_at_its_velocity(
    place: float, held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It exceeds 2r on one side of the fold only; elsewhere it is not asked for."""
    monkeypatch.setattr(
        relation, "_excess", lambda v, at, _: 1.0 if at["c"] > 0.5 or v == place else -1.0
    )
    check = relation._check_height(0.5, 0.5, 0.03, 1e-9, 0.0)
    assert check.distance == (0.0 if held else math.inf)
    monkeypatch.setattr(relation, "_excess", lambda *_: 0.0)  # not resolved: it may be either
    assert relation._check_height(0.5, 0.5, 0.03, 1e-9, 0.0).distance == 0.0


@pytest.mark.parametrize(("ripple", "held"), [(0.04, True), (0.06, False)])
def test_a_breather_holds_whose_amplitude_changes_by_less_than_a_twentieth_of_the_level(
    ripple: float, held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    at = {"a": 100.0, "eta": 0.05, "c": 0.01, "eps": 1e-6, "displacement": 1.0}
    level = VdpChain(a=100.0, b=500.0, c=0.01).unstable_amplitude

    def run(*_: object, t_eval: np.ndarray, **__: object) -> SimpleNamespace:
        y = np.zeros((states._SITES, t_eval.size), dtype=complex)
        y[-1] = level * (2.0 + ripple * np.linspace(0.0, 1.0, t_eval.size))
        return SimpleNamespace(success=True, y=y)

    monkeypatch.setattr(states, "solve_ivp", run)
    extra = (100.0, np.zeros(states._SITES, dtype=complex))
    stated = StatedValue(value=1.0, error=0.0, note="breather", extra=extra)
    assert states._label_holds(at, stated, full=False).distance == (0.0 if held else math.inf)


def test_limits_are_stated_beside_velocities_so_that_none_of_them_is_nan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    true = kinetic_relation(0.45, 0.03125)
    assert len(true.branches) == 2
    stated = relation._velocities({"c": 0.45, "eta": 0.03125})
    assert stated.value.tolist() == [
        *(branch.v for branch in true.branches),
        *(x for x in (true.c_pin, true.c_fold, true.c_retreat) if x is not None),
    ]
    assert stated.error == max(branch.error / abs(branch.v) for branch in true.branches)
    wrong = SimpleNamespace(
        branches=true.branches, c_pin=math.nan, c_fold=true.c_fold, c_retreat=None
    )
    monkeypatch.setattr(relation, "kinetic_relation", lambda *_: wrong)
    row = judge(computation_named("kinetic"), {"c": 0.5, "eta": 0.03125})
    assert row["outcome"] == PointOutcome.NAN.value


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("off", "held"), [(0.5, True), (0.99, True), (1.01, False), (1.5, False)])
def test_a_change_of_sign_lies_within_the_stated_error_on_either_side(
    off: float, held: bool, side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(relation, "_excess", lambda v, *_: v - (0.3 + 1e-3 * side * off))
    monkeypatch.setattr(relation, "_changes_of_sign", lambda _: 1)
    made = SimpleNamespace(branches=[SimpleNamespace(v=0.3, error=1e-3)])
    stated = StatedValue(value=np.array([0.3]), error=1e-3, extra=made)
    check = relation._check_velocities({"c": 0.5, "eta": 0.03}, stated)
    assert (check.distance == 0.0) is held


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_step_to_a_velocity_is_as_uncertain_as_its_slope(
    sign: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a parabola through v = 0.3 of slope 50, whose slope changes by 6 for each unit of v."""

    def defect(v: Any, _: object, shift: int) -> tuple[Any, float]:
        assert shift == (2 if sign < 0.0 else 0)
        away = mp.mpf(v) - mp.mpf(3) / 10
        return 50 * away + 3 * away**2, 0.0

    monkeypatch.setattr(relation, "_defect", defect)
    off = 1e-6
    v, uncertainty = relation.precise_velocity(sign * (0.3 + off), {"c": 0.5, "eta": 0.03})
    assert float(v) == pytest.approx(sign * 0.3, rel=1e-12)
    assert uncertainty == pytest.approx(off * 6.0 * 0.3e-9 / 50.0, rel=1e-5, abs=0.0)


def test_an_excess_that_the_sum_does_not_resolve_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    for g, uncertainty, excess in (
        (1e-20, 1e-30, 1e-20), (-1e-20, 1e-30, -1e-20), (1e-40, 1e-30, 0.0), (-1e-40, 1e-30, 0.0)
    ):  # fmt: skip
        found = (mp.mpf(g), uncertainty)
        monkeypatch.setattr(relation, "_defect", lambda *_, found=found: found)
        assert relation._excess(0.5, {"c": 0.5, "eta": 0.03125}, 0) == excess
    # Of terms of order one, both to the digits that are asked for.
    monkeypatch.setattr(relation, "_defect", lambda *_: (1 + mp.mpf(10) ** -35 - 1, 1e-40))
    found = relation._excess(0.5, {"c": 0.5, "eta": 0.03125}, 0)
    assert found == pytest.approx(1e-35, rel=1e-6, abs=0.0)


@pytest.mark.parametrize(
    ("c", "eta"),
    [
        (0.5, 1e-4),
        (0.45, 0.03125),
        (2.0, 0.11),
        (100.0, 1e-4),
        (1e-3, 0.1),
        (1e4, 0.03125),
        (1.0, 1e-12),
    ],
)
def test_a_plain_grid_sees_every_velocity(c: float, eta: float) -> None:
    """That it would see one that is left out; none is near another here."""
    branches = kinetic_relation(c, eta).branches
    assert relation._changes_of_sign({"c": c, "eta": eta}) == len(branches)


@pytest.mark.parametrize(
    ("off", "error", "changes"),
    [(1e-6, 6e-7, 0), (1e-6, 4e-7, 1), (5e-13, 0.0, 0), (2e-12, 0.0, 1)],
)
def test_a_sum_within_twice_its_error_of_the_limit_has_no_sign(
    off: float, error: float, changes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor one within 1e-12 of it."""

    def made(v: Any, *_: float) -> Any:
        value = target + off * np.where(np.arange(v.size) < 9, 1.0, -1.0)
        return SimpleNamespace(value=value, error=np.full(v.size, error))

    at = {"c": 0.5, "eta": 0.1}
    target = 2.0 * float(relation.threshold_ratio(at["eta"]))
    monkeypatch.setattr(relation, "sums", made)
    assert relation._changes_of_sign(at) == changes


def test_a_limit_that_is_zero_is_substituted() -> None:
    none = StatedValue(value=0.0, error=0.0)
    for defect, held in ((lambda x, eta: x * eta, True), (lambda x, eta: x + eta, False)):
        check = relation._by_newton(defect, lambda _: True, "eta")({"eta": 0.05}, none)
        assert (check.distance == 0.0) is held


@pytest.mark.parametrize("value", [None, 0.0])
def test_a_closed_form_without_a_value_has_no_error(value: float | None) -> None:
    found = relation._closed(lambda _: value, "eta")({"eta": 0.05})
    assert (found.value, found.error) == (value, 0.0)


@pytest.mark.parametrize(
    ("name", "eta"),
    [("c-pin", 0.03), ("c-pin", 0.0799999), ("c-retreat", 0.0800001),
     ("strong-coupling-velocity", 0.02)],
)  # fmt: skip
def test_the_error_of_a_closed_form_is_of_roundings_at_the_eta_that_is_given(
    name: str, eta: float
) -> None:
    """Also beside the end of pinning, where another η a rounding off has another limit."""
    row = computation_named(name)
    stated = row.compute({"eta": eta})
    check = row.check({"eta": eta}, stated)
    assert check.distance <= stated.error < 1e-14 * stated.value


def test_folds_are_stated_with_their_errors_and_none_where_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = SimpleNamespace(value=0.25, error=1e-12, velocity=0.1)
    monkeypatch.setattr(relation, "fold_coupling", lambda eta: made if eta < 0.08 else None)
    monkeypatch.setattr(relation, "fold_eta", lambda _: made)
    for found in (relation._fold({"eta": 0.03}), relation._eta_fold({"c": 0.3})):
        assert (found.value, found.error, found.extra) == (0.25, 1e-12, made)
    none = relation._fold({"eta": 0.1})
    assert (none.value, none.error) == (None, 0.0)


@pytest.mark.parametrize("v", [0.5, -0.5])
@pytest.mark.parametrize(
    ("ends", "error", "off"),
    [
        ((-1e-9, 1e-9), 1e-6, 0.0),  # a change of sign within the error
        ((1e-9, -1e-9), 1e-6, 0.0),
        ((1e-16, 3e-16), 1e-6, 0.0),  # a fold that is touched to within rounding
        ((-3e-16, -1e-16), 1e-6, 0.0),
        ((1e-16, 3e-16), 4e-10, 4e-10 + 1e-16 / (2e-16 / 8e-10)),  # too sure for a fold
        ((1e-9, 3e-9), 1e-6, 1e-6 + 1e-9 / (2e-9 / 2e-6)),  # off by the line through both ends
        ((1e-14, 3e-14), 1e-6, 1e-6 + 1e-14 / (2e-14 / 2e-6)),
        ((-3e-9, -1e-9), 1e-6, 1e-6 + 1e-9 / (2e-9 / 2e-6)),
    ],
)
def test_a_velocity_without_a_change_of_sign_is_off_unless_it_is_a_fold(
    v: float, ends: tuple[float, float], error: float, off: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """|v| is what (54) has; a retreating front has another excess."""
    shifts = []

    def excess(speed: float, _: object, shift: int) -> float:
        shifts.append(shift)
        return ends[speed > 0.5]

    monkeypatch.setattr(relation, "_excess", excess)
    monkeypatch.setattr(relation, "_changes_of_sign", lambda _: 1)
    found: Any = SimpleNamespace(branches=(SimpleNamespace(v=v, error=error),))
    stated = StatedValue(value=np.array([v]), error=error, extra=found)
    check = relation._check_velocities({"c": 0.5, "eta": 0.1}, stated)
    assert check.distance == pytest.approx(off / 0.5, rel=1e-6)
    assert set(shifts) == {0 if v > 0 else 2}


@pytest.mark.parametrize(("c", "eta"), [(0.5, 0.03125), (0.45, 0.03125), (2.0, 0.11)])
def test_a_velocity_in_many_digits_is_a_root_of_the_relation(
    c: float, eta: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of advancing and of retreating fronts: (54) is smaller there than beside it, by the step."""
    monkeypatch.setattr(relation, "_DIGITS", 18)
    at = {"c": c, "eta": eta}
    branches = kinetic_relation(c, eta).branches
    assert branches
    for branch in branches:
        v, uncertainty = relation.precise_velocity(branch.v * (1.0 + 1e-12), at)
        assert abs(float(v) / branch.v - 1.0) < 1e-12 + branch.error / abs(branch.v)
        assert uncertainty < 1e-16
        shift = 2 if branch.v < 0 else 0
        with mp.workdps(50):
            here, beside = (
                relation._defect(abs(v) * (1 + step), at, shift)[0] for step in (0, mp.mpf("1e-9"))
            )
            assert abs(here) < 1e-6 * abs(beside)
            assert abs(here / beside) * 1e-9 * abs(v) <= uncertainty


def _pinned_fold(eta: float, off: float = 0.0) -> ReferenceCheck:
    value = pinning_coupling(eta)
    stated = StatedValue(
        value=value * (1.0 + off), error=1e-15, extra=SimpleNamespace(velocity=0.0)
    )
    return relation._check_fold({"eta": eta}, stated)


@pytest.mark.parametrize("eta", [0.001, 0.03125, 0.07])
def test_a_fold_at_pinning_is_as_far_off_as_it_is(eta: float) -> None:
    """What a rounding of η changes is within what the check says of itself, and not far below."""
    value = pinning_coupling(eta)
    assert value is not None
    for off in (0.0, 1e-9, -1e-9):
        check = _pinned_fold(eta, off)
        assert check.distance == pytest.approx(abs(off) * value, rel=1e-3, abs=check.uncertainty)
    beside = pinning_coupling(eta * (1.0 + 1e-7))
    rounding = abs(beside - value) * 1e-9  # of 1e-16
    assert rounding <= check.uncertainty < 1e3 * rounding


def test_where_no_front_is_pinned_there_is_no_fold_and_elsewhere_one() -> None:
    below, above = 0.5 * ETA_PIN_END, 1.1 * ETA_PIN_END
    for eta, value, held in (
        (below, None, False), (above, None, True), (above, 0.5, False)
    ):  # fmt: skip
        stated = StatedValue(value=value, error=1e-9, extra=SimpleNamespace(velocity=0.0))
        assert relation._check_fold({"eta": eta}, stated).distance == (0.0 if held else math.inf)
    at_end = {"eta": ETA_PIN_END}
    assert relation._fold(at_end).value is None
    assert relation._check_fold(at_end, relation._fold(at_end)).distance == 0.0


@pytest.mark.parametrize("off", [0.0, 1e-6, -1e-6])
def test_an_eta_at_which_moving_fronts_end_at_pinning_is_as_far_off_as_it_is(off: float) -> None:
    c = 0.3
    value = relation.pinning_eta(c) * (1.0 + off)
    stated = StatedValue(value=value, error=1e-15, extra=SimpleNamespace(velocity=0.0))
    check = relation._check_eta_fold({"c": c}, stated)
    assert check.distance == pytest.approx(abs(off) * value, rel=1e-4, abs=1e-15)


@pytest.mark.parametrize("off", [0.5e-6, -0.5e-6, 2e-6, -2e-6])
def test_a_fold_of_moving_fronts_holds_within_its_error_and_not_beyond(
    off: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(relation, "_DIGITS", 12)
    coupling = fold_coupling(0.03125)
    assert coupling.velocity > 0.0
    eta = fold_eta(coupling.value)
    assert eta.value == pytest.approx(0.03125, rel=1e-9)
    stated = StatedValue(value=coupling.value + off, error=1e-6, extra=coupling)
    held = relation._check_fold({"eta": 0.03125}, stated).distance == 0.0
    assert held is (abs(off) < 1e-6)
    stated = StatedValue(value=eta.value + off, error=1e-6, extra=eta)
    held = relation._check_eta_fold({"c": coupling.value}, stated).distance == 0.0
    assert held is (abs(off) < 1e-6)


def test_a_front_whose_sum_is_not_largest_is_no_fold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relation, "_DIGITS", 12)
    (front,) = kinetic_relation(0.5, 0.03125).branches
    assert relation._check_height(0.5, front.v, 0.03125, 1e-9, 0.0).distance == math.inf


@pytest.mark.parametrize(
    ("name", "etas"),
    [
        ("c-pin", (0.01, 0.05)), ("c-retreat", (0.1, 0.12)),
        ("strong-coupling-velocity", (0.01, 0.05)),
    ],
)  # fmt: skip
def test_a_limit_is_as_far_off_as_it_is_and_none_where_it_does_not_exist(
    name: str, etas: tuple[float, float]
) -> None:
    row = computation_named(name)
    for eta in etas:
        stated = row.compute({"eta": eta})
        for off in (0.0, 1e-7, -1e-7):
            wrong = replace(stated, value=stated.value * (1.0 + off))
            check = row.check({"eta": eta}, wrong)
            assert check.distance == pytest.approx(
                abs(off) * stated.value, rel=1e-4, abs=2.0 * stated.error
            )
        assert row.check({"eta": eta}, replace(stated, value=None)).distance == math.inf
    elsewhere = {"eta": 0.05 if name == "c-retreat" else 0.1}
    stated = row.compute(elsewhere)
    assert stated.value is None
    assert row.check(elsewhere, stated).distance == 0.0
    assert row.check(elsewhere, replace(stated, value=0.5)).distance == math.inf


# ----------------------------------------------------------------------------------------- fronts


def _short_fronts(monkeypatch: pytest.MonkeyPatch, sites: int) -> None:
    monkeypatch.setattr(fronts, "_FILLED", 8)
    monkeypatch.setattr(fronts, "_MIN_SITES", sites)
    monkeypatch.setattr(fronts, "_MAX_SITES", sites)


@pytest.mark.parametrize(("c", "eta"), [(0.6, 0.03125), (0.3, 0.05)])
def test_a_front_timed_by_scipy_has_the_velocity_of_the_wave(
    c: float, eta: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    _short_fronts(monkeypatch, 24)
    at = {"c": c, "eta": eta}
    v = front_wave(**at).v
    check = fronts._by_scipy(at, StatedValue(value=0.9 * v, error=1e-9), full=False)
    assert check.uncertainty < 0.02 * v
    assert check.distance == pytest.approx(0.1 * v, abs=check.uncertainty)


def test_a_front_that_has_settled_is_timed_to_1e_7(monkeypatch: pytest.MonkeyPatch) -> None:
    """Scipy's tolerances add no more than as much again."""
    _short_fronts(monkeypatch, 72)
    at = {"c": 0.4, "eta": 0.08}
    wave = front_wave(**at)
    check = fronts._by_scipy(at, StatedValue(value=wave.v, error=wave.error), full=False)
    assert check.distance <= check.uncertainty + wave.error
    assert check.uncertainty < 2e-7 * wave.v


def test_a_front_of_the_chain_is_timed_in_slow_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """By (8) itself; (43), of which the velocity is known, is off by the order of ε."""
    _short_fronts(monkeypatch, 20)
    at = {"c": 2.0, "eta": 0.03125}
    v = front_wave(**at).v
    check = fronts._by_scipy({**at, "eps": 0.05}, StatedValue(value=v, error=1e-9), full=True)
    assert check.distance < 0.1 * v
    assert check.uncertainty < 0.1 * v


def test_a_front_of_the_chain_starts_with_lags_of_a_quarter_turn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    started: list[Any] = []

    def run(rate: Any, _: float, start: np.ndarray, *__: Any, **___: Any) -> None:
        started.extend((rate, start))
        raise NoReferenceError("begun")

    monkeypatch.setattr("verification.references.passages.DOP853", run)
    stated = StatedValue(value=1.0, error=1e-9)
    with pytest.raises(NoReferenceError, match="begun"):
        fronts._by_scipy({"c": 2.0, "eta": 0.03125, "eps": 0.05}, stated, full=True)
    rate, start = started
    assert np.array_equal(rate(0.0, start)[: start.size // 2], start[start.size // 2 :])  # of (8)
    psi = as_complex(start)
    filled = psi[: fronts._FILLED]
    assert not psi[fronts._FILLED :].any()
    cycle = VdpChain(a=4.0, b=0.5, c=2.0).stable_amplitude
    assert np.abs(filled) == pytest.approx(cycle, rel=1e-14)
    assert filled[1:] == pytest.approx(-1j * filled[:-1], rel=1e-14)


def test_a_front_that_rests_reaches_no_site(monkeypatch: pytest.MonkeyPatch) -> None:
    """And one that travels, stated to rest, is off by the sites it reaches a unit of time."""
    _short_fronts(monkeypatch, 24)
    rest = StatedValue(value=0.0, error=0.0)
    assert fronts._by_scipy({"c": 0.01, "eta": 0.05}, rest, full=False).distance == 0.0
    monkeypatch.setattr(fronts, "_STALL_TIME", 20.0)
    v = front_wave(0.6, 0.03125).v
    off = fronts._by_scipy({"c": 0.6, "eta": 0.03125}, rest, full=False).distance
    assert 0.6 * v < off < 1.2 * v  # the chain ends before the time does


def _arrivals(v: float, first: float = 0.0) -> np.ndarray:
    """Return the arrivals of a front whose first half of sites is slower."""
    n = np.arange(60.0)
    return n / v + first * np.minimum(n, 30.0)


@pytest.mark.parametrize(("name", "full"), [("front-averaged", False), ("front-vdp", True)])
def test_a_front_is_measured_and_timed_on_the_chain_of_which_it_is(
    name: str, full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A front of (8) of velocity 0.3 passes a site in 3.3/ε, one of (43) in 3.3."""
    asked: list[Any] = []

    def measured(chain: Any, **given: Any) -> SimpleNamespace:
        asked.append((chain.model, given["left_boundary"], given["tolerance"]))
        return SimpleNamespace(status=FrontStatus.STEADY, v=0.3, error=1e-9)

    scale = 0.1 if full else 1.0
    monkeypatch.setattr(fronts, "measure_front", measured)
    monkeypatch.setattr(fronts, "arrivals_by_scipy", lambda *_, **__: np.arange(80.0) / 0.3 / scale)
    at = {"c": 0.01, "eta": 0.05, "eps": 0.1, "tolerance": 1e-6}
    row = computation_named(name)
    stated = row.compute(at)
    assert asked == [("vdp" if full else "averaged", LeftBoundary.WAVE, 1e-6)]
    for other in (
        SimpleNamespace(status=FrontStatus.UNSTEADY, v=0.3, error=1e-9),
        SimpleNamespace(status=FrontStatus.STEADY, v=0.3, error=None),
    ):
        monkeypatch.setattr(fronts, "measure_front", lambda *_, other=other, **__: other)
        none = row.compute(at)
        assert (none.value, none.error, none.note) == (None, 0.0, other.status.value)
    assert (stated.value, stated.error, stated.note) == (0.3, 1e-9, "")
    assert row.check(at, stated).distance < 1e-12


def test_a_timed_front_has_the_pace_of_its_second_half() -> None:
    for v in (0.25, 4.0):
        check = fronts._timed(_arrivals(v), v, "a clock")
        assert check.distance < 1e-12 * v
        assert check.uncertainty == pytest.approx(1e-7 * v, rel=1e-6)
        # A first half whose intervals are longer by d: six times as much of v is uncertain.
        slower = fronts._timed(_arrivals(v, first=0.01 / v), 1.1 * v, "a clock")
        assert slower.distance == pytest.approx(0.1 * v, rel=1e-9)
        assert slower.uncertainty == pytest.approx(0.06 * v, rel=1e-3)
        with pytest.raises(NoReferenceError, match="settle"):
            fronts._timed(_arrivals(v, first=0.02 / v), v, "a clock")
    n = np.arange(60.0)  # intervals that are quasi-periodic
    for times in (2.0 * n + 0.1 * np.cos(n), 2.0 * n - 0.1 * np.sin(n)):
        assert passages.mean_interval(times) == pytest.approx(2.0, abs=1e-5)
    missing = _arrivals(1.0)
    missing[7] = math.nan
    with pytest.raises(NoReferenceError, match="run through"):
        fronts._timed(missing, 1.0, "a clock")


@pytest.mark.parametrize(
    ("status", "error", "stated", "note"),
    [
        (FrontStatus.STEADY, 1e-9, 0.5, ""),
        (FrontStatus.STEADY, None, None, "steady"),
        (FrontStatus.CREEPING, 1e-9, None, "creeping"),
    ],
)
def test_a_front_from_event_to_event_that_states_nothing_says_why(
    status: FrontStatus, error: float | None, stated: float | None, note: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    made = SimpleNamespace(status=status, v=0.5, error=error)
    monkeypatch.setattr("verification.quantities.fronts.simulate_front", lambda *_: made)
    found = fronts._piecewise_front({"c": 0.5, "eta": 0.03125})
    assert (found.value, found.note) == (stated, note)


def test_a_front_from_event_to_event_is_held_against_the_nearest_velocity(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = SimpleNamespace(branches=[SimpleNamespace(v=v) for v in (0.1, 0.4, 0.9)])
    monkeypatch.setattr("verification.quantities.fronts.kinetic_relation", lambda *_: made)
    monkeypatch.setattr(fronts, "precise_velocity", lambda v, _: (mp.mpf(v), 1e-20))
    at = {"c": 0.5, "eta": 0.03125}
    for v, near in ((0.05, 0.1), (0.42, 0.4), (0.7, 0.9), (2.0, 0.9)):
        check = fronts._check_piecewise(at, StatedValue(value=v, error=1e-9))
        assert check.distance == pytest.approx(abs(v - near), rel=1e-12)
        assert check.uncertainty == 1e-20
    with pytest.raises(NoReferenceError, match="creeping"):
        fronts._check_piecewise(at, StatedValue(value=None, error=0.0, note="creeping"))
    made.branches = []
    with pytest.raises(NoReferenceError, match="no branch"):
        fronts._check_piecewise(at, StatedValue(value=0.5, error=1e-9))


def test_grids_become_finer_and_longer_until_two_neighbours_agree(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """To half of the error that is stated; v is that of the last."""
    asked: list[tuple[int, int, int]] = []

    def velocity(c: float, eta: float, points: int, *, behind: int, ahead: int) -> np.longdouble:
        assert (c, eta) in ((1.0, 0.03), (1000.0, 0.03))
        asked.append((points, behind, ahead))
        return np.longdouble(0.5 + 2.0 * 8.0 ** -len(asked))

    monkeypatch.setattr("verification.quantities.fronts.front_velocity", velocity)
    for error, rungs in ((0.5, 2), (0.06, 3), (0.008, 4), (1e-9, 5)):
        asked.clear()
        stated = StatedValue(value=0.25, error=error)
        check = fronts._by_differences({"c": 1.0, "eta": 0.03}, stated)
        assert len(asked) == rungs
        assert check.distance == pytest.approx(0.25 + 2.0 * 8.0**-rungs)
        asked.clear()
        beyond = fronts._by_differences({"c": 1.0, "eta": 0.03}, replace(stated, value=0.75))
        assert beyond.distance == pytest.approx(0.25 - 2.0 * 8.0**-rungs)
        assert check.uncertainty == pytest.approx(14.0 * 8.0**-rungs)
        assert min(asked[0]) >= 20  # of sites, on which the wave comes to the cycle and to rest
        for one, other in pairwise(asked):
            assert all(more > less for less, more in zip(one, other, strict=True))
    stronger = asked[-1]
    fronts._by_differences({"c": 1000.0, "eta": 0.03}, StatedValue(value=0.25, error=1e-9))
    assert asked[-1][2] == pytest.approx(10 * stronger[2], abs=10)  # c^{1/3} longer ahead


@pytest.mark.parametrize(
    ("c", "eta", "differences"),
    [(0.15, 0.02, True), (10.0, 0.02, True), (0.14, 0.02, False), (11.0, 0.02, False),
     (1.0, 0.01, True), (1.0, 0.009, False)],
)  # fmt: skip
def test_a_front_is_held_against_its_wave_where_that_is_steep_neither_nor_long(
    c: float, eta: float, differences: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else it is timed, on the averaged chain itself."""

    def timed(*_: Any, full: bool) -> ReferenceCheck:
        return ReferenceCheck(distance=0.0, method="(8)" if full else "(43)")

    exact = ReferenceCheck(distance=0.0, method="differences")
    monkeypatch.setattr(fronts, "_by_differences", lambda *_: exact)
    monkeypatch.setattr(fronts, "_by_scipy", timed)
    stated = StatedValue(value=0.5, error=1e-9)
    found = fronts._averaged_front_known({"c": c, "eta": eta}, stated)
    assert found.method == ("differences" if differences else "(43)")


def test_a_wave_is_stated_where_there_is_one() -> None:
    found = fronts._wave({"c": 0.6, "eta": 0.03125})
    assert found.value == front_wave(0.6, 0.03125).v
    assert 0.0 < found.error < 1e-9
    pinned = fronts._wave({"c": 0.05, "eta": 0.03125})
    assert (pinned.value, pinned.error) == (None, 0.0)
    assert "pinned" in pinned.note


# ------------------------------------------------------------------------------------------- runs


@pytest.mark.parametrize("full", [True, False])
def test_a_run_of_the_table_ends_at_time_thirty(full: bool) -> None:
    """A small displacement without damping or springs turns, or dies off as e^{-T/2} by (43)."""
    at = {
        "a": 1.0, "eta": 0.05, "c": 1e-8, "eps": 1e-6 if full else 0.01, "sites": 2.0,
        "displacement": 1e-3, "tolerance": 1e-10,
    }  # fmt: skip
    stated = runs._run(at, full)
    assert abs(stated.extra[0]) == pytest.approx(1e-3)
    turned = stated.value[0] / stated.extra[0]
    expected = np.exp(30j) if full else np.exp(-15.0)
    assert turned == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(("name", "full"), [("run-vdp", True), ("run-envelope", False)])
def test_a_run_of_the_table_is_of_the_chain_of_which_its_row_is(
    name: str, full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The slow time of (43) is ε t."""
    asked: list[Any] = []

    def run(chain: Any, _: object, end: float, **given: Any) -> SimpleNamespace:
        asked.append((chain.model, end, given["tolerance"]))
        return SimpleNamespace(psi=np.array([[0.0, 0.0], [3.0, 1j]]), error=1e-9)

    monkeypatch.setattr(runs, "simulate", run)
    at = {"a": 4.0, "eta": 0.03, "c": 0.6, "eps": 0.1, "sites": 2.0, "displacement": 2.0,
          "tolerance": 1e-7}  # fmt: skip
    stated = computation_named(name).compute(at)
    ((model, end, tolerance),) = asked
    assert (model, end) == (("vdp", 30.0) if full else ("averaged", pytest.approx(300.0)))
    assert (stated.value.tolist(), stated.error, tolerance) == ([3.0, 1j], 1e-9, 1e-7)
    assert stated.extra.tolist() == [2j, 0j]


@pytest.mark.parametrize(
    ("displacement", "eta", "stiff"),
    [(1e-3, 1e-12, False), (1.0, 1e-12, False), (40.0, 1e-12, False), (80.0, 1e-12, True),
     (12.0, 0.1, False), (14.0, 0.1, True)],
)  # fmt: skip
def test_damping_is_stiff_by_the_height_of_the_start(
    displacement: float, eta: float, stiff: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stiff is 30; ε a y² is 64 at y = 80, and ε b y⁴ is 21 and 38 at y = 12 and 14 for η = 0.1."""
    at = {"a": 1.0, "eta": eta, "c": 0.1, "eps": 0.01, "sites": 4.0, "displacement": displacement}
    monkeypatch.setattr(runs, "_full_by_radau", lambda *_: "Radau")
    monkeypatch.setattr(runs, "_where_it_moves", lambda *_: "explicit")
    stated = StatedValue(value=np.zeros(4), error=0.0, extra=np.zeros(4))
    found: Any = runs._full_precisely(at, stated)
    assert found == ("Radau" if stiff else "explicit")


@pytest.mark.parametrize(("c", "eps"), [(0.3, 0.01), (10.0, 0.3), (100.0, 0.01)])
def test_as_many_sites_are_followed_as_the_fastest_wave_passes(
    c: float, eps: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of small motion without damping, ω² = 1 + 4εc sin²(q/2), and of (43) Ω = 2c sin²(q/2)."""
    q = np.linspace(0.0, np.pi, 20_001)
    bend = 4.0 * np.sin(0.5 * q) ** 2
    monkeypatch.setattr(runs, "_where_it_moves", lambda *given: given[-1])
    at = {"a": 1.0, "eta": 0.05, "c": c, "eps": eps, "sites": 9.0, "displacement": 0.1}
    stated = StatedValue(value=np.zeros(9), error=0.0, extra=np.zeros(9))
    for reach, omega in (
        (runs._full_precisely(at, stated), np.sqrt(1.0 + eps * c * bend)),
        (runs._averaged_precisely(at, stated), 0.5 * c * bend),
    ):
        fastest = float(np.max(np.diff(omega))) / q[1]
        assert reach == pytest.approx(30.0 * fastest, rel=1e-6)


def test_a_stiff_run_is_followed_on_few_sites_first_and_on_more_where_they_move(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    followed: list[int] = []

    def made(rate: Any, end: float, start: np.ndarray, **_: object) -> np.ndarray:
        """Return a state of which as many sites move as there are, up to seventy.

        The others are at rest within a part of the displacement, which is 2.
        """
        assert rate(0.5 * end, start).shape == start.shape
        followed.append(start.size // 2)
        return np.tile(np.where(np.arange(start.size // 2) < moving, 1.0, runs.REST), 2)

    monkeypatch.setattr(runs, "last_state", made)
    chain = VdpChain(a=1.0, b=0.05, c=0.1, eps=0.01, sites=300)
    for moving, parts in ((20, {30}), (28, {30}), (29, {30, 60}), (70, {30, 60, 120})):
        followed.clear()
        true = np.where(np.arange(300) < moving, 1.0 + 1.0j, 0.0)
        stated = StatedValue(value=true + 1e-3, error=0.0, extra=np.eye(300)[0] * 2.0 + 0j)
        check = runs._full_by_radau(chain, 50.0, stated)
        assert set(followed) == parts
        assert check.distance == pytest.approx(1e-3)


def test_a_run_that_is_too_stiff_for_scipy_is_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 3e11 or 3e12 units of time of its damping."""
    monkeypatch.setattr(runs, "last_state", lambda *_, **__: np.zeros(8))
    chain = VdpChain(a=1.0, b=0.05, c=0.1, eps=0.01, sites=4)
    stated = StatedValue(value=np.zeros(4, complex), error=0.0, extra=np.ones(4, complex))
    assert runs._full_by_radau(chain, 1e10, stated).distance == 0.0
    with pytest.raises(NoReferenceError, match="too stiff"):
        runs._full_by_radau(chain, 1e11, stated)


def test_a_stiff_run_is_held_against_an_implicit_method() -> None:
    """On the sites that move: of forty the springs, of 1e-8, reach few."""
    at = {
        "a": 4.0, "eta": 0.03, "c": 1e-8, "eps": 0.01, "sites": 40.0, "displacement": 60.0,
        "tolerance": 1e-6,
    }  # fmt: skip
    stated = runs._run(at, True)
    check = runs._full_precisely(at, stated)
    assert check.method == "scipy's Radau"
    assert compared(stated.error, check) is PointOutcome.RIGHT, check
    wrong = stated.value.copy()
    wrong[0] += 1e-3
    off = runs._full_precisely(at, replace(stated, value=wrong))
    assert off.distance == pytest.approx(1e-3, rel=0.1)


def test_a_state_is_as_uncertain_as_two_tolerances_are_apart() -> None:
    """To either side."""
    for loose in (2.0, 0.0):

        def last(tolerance: float, loose: float = loose) -> np.ndarray:
            return np.array([1.0 if tolerance < 1e-11 else loose, 3.0])

        found = states_compared(np.array([1.5, 3.0]), last, "another")
        assert (found.distance, found.uncertainty) == (0.5, 1.0)


def test_a_reference_follows_all_sites_that_move() -> None:
    """Of 300 sites 130 move; the reference begins with thirty."""
    true = np.where(np.arange(300) < 130, 1.0, 5e-17).astype(complex)
    followed: list[int] = []

    def precise(part: int, tolerance: float) -> PreciseState:
        followed.append(part)
        value = true[:part] + 1.0 / part * (np.arange(part) == 0)
        return PreciseState(value=value, uncertainty=1e-3)

    stated = StatedValue(value=true, error=0.0, extra=np.eye(300)[0] + 0j)
    check = runs._where_it_moves(stated, precise, 0.0)
    assert 132 <= max(followed[:-1]) < 300
    tight, looser = max(followed[:-1]), followed[-1]
    assert check.distance == pytest.approx(1.0 / tight)
    # What is missing beyond its sites is seen by the looser run, which has more.
    assert looser > tight
    assert check.uncertainty == pytest.approx(1.0 / tight - 1.0 / looser + 1e-3)
    # At rest is what is below a part of the displacement, on the last two sites.
    true[130:] = 5e-14
    runs._where_it_moves(replace(stated, extra=1e3 * stated.extra), precise, 0.0)
    assert max(followed) < 300
    true[119:] = 5e-17
    followed.clear()
    runs._where_it_moves(stated, precise, 0.0)
    assert max(followed[:-1]) == 240
    true[119:130], true[130:] = 1.0, 2e-16  # far below rounding, and not at rest
    runs._where_it_moves(stated, precise, 0.0)
    assert max(followed) == 300
    with pytest.raises(NoReferenceError, match="Python includes"):
        runs._where_it_moves(replace(stated, value=np.zeros(500)), precise, 1e4)
    # As many as it follows at most it follows where waves pass all of them.
    runs._where_it_moves(replace(stated, value=np.zeros(400)), lambda part, _: PreciseState(
        value=np.zeros(part, complex), uncertainty=0.0), 1e4)  # fmt: skip


def test_as_many_sites_are_followed_as_move() -> None:
    asked: list[int] = []

    def at_rest(part: int) -> bool:
        asked.append(part)
        return part >= 50

    assert moving_sites(at_rest, 200, 30, 100) == 60
    assert asked == [30, 60]
    assert moving_sites(at_rest, 45, 30, 100) == 45  # all, which need not rest
    assert moving_sites(at_rest, 20, 30, 100) == 20
    assert asked == [30, 60, 30]
    with pytest.raises(NoReferenceError, match="slow reference"):
        moving_sites(lambda _: False, 200, 30, 100)


# ----------------------------------------------------------------------------------------- labels


@pytest.mark.parametrize("state", [State.FRONT, State.BREATHER, State.UNDECIDED])
def test_a_label_is_stated_without_error_or_not_at_all(
    state: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the chain itself, or of the averaged one."""
    made, asked = SimpleNamespace(state=state, time=17.0), []

    def find(chain: Any, _: object) -> SimpleNamespace:
        asked.append(chain.model)
        return made

    monkeypatch.setattr("verification.quantities.states.find_vdp_state", find)
    for full in (False, True):
        found = states._label({"eta": 0.05, "c": 0.1, "displacement": 3.0}, full=full)
        assert (found.value is None) is (state is State.UNDECIDED)
        assert (found.error, found.note, found.extra[0]) == (0.0, str(state), 17.0)
    assert asked == ["averaged", "vdp"]


def _labelled(
    note: str, amplitude: np.ndarray, full: bool, monkeypatch: pytest.MonkeyPatch
) -> tuple[bool, np.ndarray]:
    """Return whether a label holds in a run whose amplitudes are given, and the times asked."""
    asked: list[np.ndarray] = []

    def made_up(
        _: object, __: object, start: np.ndarray, *, t_eval: np.ndarray, **___: object
    ) -> SimpleNamespace:
        asked.append(t_eval)
        assert (start.shape, np.iscomplexobj(start)) == ((32,) if full else (16,), not full)
        heights = np.repeat(amplitude, t_eval.size // amplitude.shape[1], axis=1)
        turns = heights * np.exp(1j * np.arange(t_eval.size))
        y = np.vstack([turns.real, turns.imag]) if full else turns
        return SimpleNamespace(success=True, y=y)

    monkeypatch.setattr("verification.quantities.states.solve_ivp", made_up)
    at = {"eta": 0.05, "c": 0.1, "displacement": 3.0, "eps": 0.01}
    stated = StatedValue(value=1.0, error=0.0, note=note, extra=(100.0, np.zeros(16, complex)))
    return states._label_holds(at, stated, full).distance == 0.0, asked[0]


HIGH, LOW = 1.7, 0.1
"""Above and below the unstable amplitude, √(8/(1 + √(1 - 8η))/a) = 1.06 at η = 0.05, a = 4."""


@pytest.mark.parametrize("full", [True, False])
@pytest.mark.parametrize(
    ("note", "ends", "held"),
    [
        ("front", ((HIGH, HIGH), (HIGH, HIGH)), True),
        ("front", ((HIGH, LOW), (HIGH, HIGH)), False),  # it must stay
        ("breather", ((LOW, LOW), (HIGH, HIGH)), True),
        ("breather", ((LOW, HIGH), (HIGH, HIGH)), False),  # it spreads
        ("breather", ((1.05, 1.07), (HIGH, HIGH)), False),  # it reaches the other end at last
        ("breather", ((LOW, LOW), (HIGH, LOW)), False),  # it dies
        ("breather", ((LOW, LOW), (HIGH, HIGH + 0.5)), False),  # it swells by more than damping may
        ("breather", ((LOW, LOW), (HIGH, HIGH + 0.2)), False),
        ("breather", ((LOW, LOW), (HIGH, HIGH + 0.04)), True),
        ("breather", ((LOW, LOW), (HIGH, HIGH + 0.13)), True),  # that, and a ripple besides
        ("breather", ((LOW, LOW), (1.08, 1.04)), False),  # it falls below the unstable cycle
        ("fixed point", ((LOW, LOW), (LOW, 0.5 * LOW)), True),
        ("fixed point", ((LOW, LOW), (LOW, LOW)), False),  # it must fall
        ("fixed point", ((LOW, LOW), (HIGH, LOW)), False),
    ],
)
def test_a_label_is_kept_until_twice_its_time_and_forty_more(
    note: str, ends: tuple[tuple[float, float], ...], held: bool, full: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    amplitude = np.full((16, 2), LOW)
    if note == "fixed point":
        amplitude[:, 1] = 0.9 * LOW if ends[1][1] < LOW else LOW
    amplitude[0], amplitude[-1] = ends
    found, times = _labelled(note, amplitude, full, monkeypatch)
    assert found is held
    assert times[[0, -1]] * (0.01 if full else 1.0) == pytest.approx([120.0, 240.0])


@pytest.mark.parametrize("name", ["c-pin", "c-retreat", "strong-coupling-velocity"])
def test_at_the_end_of_pinning_no_closed_form_is_expected(name: str) -> None:
    row, at = computation_named(name), {"eta": ETA_PIN_END}
    stated = row.compute(at)
    assert stated.value is None
    assert row.check(at, stated).distance == 0.0


@pytest.mark.parametrize(
    ("name", "at"),
    [
        ("c-pin", {"eta": 0.03125}),
        ("c-retreat", {"eta": 0.12}),
        ("strong-coupling-velocity", {"eta": 0.03125}),
        ("eta-pin", {"c": 0.3}),
    ],
)
def test_a_closed_form_is_as_good_as_double_precision(name: str, at: dict[str, float]) -> None:
    stated = computation_named(name).compute(at)
    assert 2.0**-53 * stated.value < stated.error < 1e-14 * stated.value


@pytest.mark.parametrize(("name", "full"), [("label-averaged", False), ("label-vdp", True)])
def test_a_label_is_checked_on_the_chain_of_which_it_is(
    name: str, full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run of (8) has states of places and velocities, one of (43) has complex ones."""
    starts: list[Any] = []
    chains_labelled: list[str] = []

    def find(chain: Any, _: object) -> SimpleNamespace:
        chains_labelled.append(chain.model)
        return SimpleNamespace(state=State.FRONT, time=20.0)

    def run(_: object, __: object, start: Any, t_eval: Any, **___: object) -> Any:
        starts.append(start)
        return SimpleNamespace(success=True, y=np.zeros((start.size, t_eval.size)))

    monkeypatch.setattr(states, "solve_ivp", run)
    extra = (20.0, np.zeros(states._SITES, dtype=complex))
    stated = StatedValue(value=1.0, error=0.0, note="front", extra=extra)
    at = {"eta": 0.05, "c": 0.5, "displacement": 6.0, "eps": 0.1}
    assert computation_named(name).check(at, stated).distance == math.inf
    assert [start.size for start in starts] == [states._SITES * (1 + full)]
    monkeypatch.setattr(states, "find_vdp_state", find)
    computation_named(name).compute(at)
    assert chains_labelled == ["vdp" if full else "averaged"]
