"""A reference confirms what is stated where it is right, and refutes it where it is made wrong.

`tests.test_robustness` asks the first of many points. Here the second is asked of each reference
that is quick: a value that is a hundredth off, a root or a velocity left out, another label.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from verification.quantities import (
    friction,
    fronts,
    kinetic_relation,
    own_chains,
    roots,
    runs,
    states,
)
from verification.quantities.chains import vdp_chain
from verification.quantities.friction import _root_energy
from verification.quantities.judging import PointOutcome, compared
from verification.quantities.quantity import StatedValue
from verification.quantities.registry import computation_named
from verification.quantities.states import _label_holds
from verification.references.pace import NoReferenceError
from verification.references.piecewise import sum_by_quadrature, threshold_ratio
from verification.runs.excite import as_psi, excite

RUN = {"a": 4.0, "eta": 0.03, "c": 0.6, "eps": 0.1, "sites": 4, "displacement": 2.0,
       "tolerance": 1e-9}  # fmt: skip

POINTS: list[tuple[str, Mapping[str, float]]] = [
    ("closed-form-fold", {"a": 2.5, "eta": 0.08, "reading": 1.0}),
    ("closed-form-breather", {"a": 2.5, "eta": 0.08, "c": 0.1, "reading": 1.0}),
    ("closed-form-breather", {"a": 2.5, "eta": 0.08, "c": 0.1, "reading": 2.0}),
    ("envelope-breather", {"eta": 0.08, "c": 0.1}),
    ("front-averaged", {"c": 2.0, "eta": 0.03125}),
    ("c-pin", {"eta": 0.03125}),
    ("eta-pin", {"c": 0.3}),
    ("strong-coupling-velocity", {"eta": 0.03125}),
    ("profile", {"v": 0.3, "c": 0.5, "distance": 3.16, "tolerance": 3e-8, "side": 1.0}),
    ("profile", {"v": 0.3, "c": 0.5, "distance": 4.0, "tolerance": 1e-8, "side": 3.0}),
    ("run-vdp", RUN),
    ("run-envelope", RUN),
    ("sigma-integral", {"v": 0.3, "c": 0.5, "tolerance": 1e-8}),
    ("sigma-series", {"v": 0.3, "c": 0.5, "digits": 8.0}),
]


def _once(integrate: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that integrates one chain from each start to each tolerance once."""
    known: dict[tuple[Any, ...], Any] = {}

    def same(rate: Any, start: np.ndarray, *rest: float) -> Any:
        asked = (start.tobytes(), *rest)
        if asked not in known:
            known[asked] = integrate(rate, start, *rest)
        return known[asked]

    return same


@pytest.mark.parametrize(("name", "at"), POINTS)
def test_what_is_right_is_confirmed_and_what_is_a_hundredth_off_refuted(
    name: str, at: Mapping[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runs, "integrate", _once(runs.integrate))
    monkeypatch.setattr(runs, "_END", 10.0)  # steps in extended precision take long
    row = computation_named(name)
    stated = row.compute(at)
    check = row.check(at, stated)
    assert compared(stated.error, check) is PointOutcome.RIGHT, check
    off = row.check(at, replace(stated, value=1.01 * stated.value))
    assert compared(stated.error, off) is PointOutcome.EXCEEDED, off
    # In the units of the error: of the value, or relative to it.
    size = float(np.abs(np.asarray(stated.value, dtype=complex)).max())
    assert off.distance == pytest.approx(0.01, rel=0.1) or off.distance <= 0.0101 * size


@pytest.mark.parametrize(("c", "off"), [(0.1, 1e-4), (0.1, -1e-4), (0.19, 0.02), (0.19, -0.02)])
@pytest.mark.parametrize("which", [0, 1])
def test_an_amplitude_or_a_decay_alone_that_is_off_is_refuted(
    which: int, c: float, off: float
) -> None:
    """Also where the stated amplitude is below that of the fold, and the true one above."""
    row = computation_named("closed-form-breather")
    at = {"a": 2.5, "eta": 0.08, "c": c, "reading": 1.0}
    stated = row.compute(at)
    value = stated.value.copy()
    value[which] *= 1.0 + off
    true = abs(1.0 / (1.0 + off) - 1.0)
    assert row.check(at, replace(stated, value=value)).distance == pytest.approx(true, rel=1e-9)


def test_a_root_or_a_velocity_that_is_left_out_is_missed() -> None:
    roots = computation_named("roots")
    at = {"v": 0.3, "c": 0.5, "label": 10.0, "side": 2.0}
    stated = roots.compute(at)
    k = stated.extra.k.copy()
    k[2] = k[1]  # twice the one, and not the other
    wrong = replace(stated, extra=replace(stated.extra, k=k + 1e-3))
    assert compared(stated.error, roots.check(at, wrong)) is PointOutcome.EXCEEDED
    kinetic = computation_named("kinetic")
    at = {"c": 0.45, "eta": 0.03125}
    stated = kinetic.compute(at)
    one = replace(stated, extra=replace(stated.extra, branches=stated.extra.branches[1:]))
    assert compared(stated.error, kinetic.check(at, one)) is PointOutcome.EXCEEDED
    at = {"c": 0.0453125, "eta": 0.001}  # just above c_pin, where fronts are slowest
    stated = kinetic.compute(at)
    assert 0.018 < stated.extra.branches[0].v < 0.036
    assert kinetic.check(at, stated).distance == 0.0
    none = replace(stated, extra=replace(stated.extra, branches=()))
    assert compared(stated.error, kinetic.check(at, none)) is PointOutcome.EXCEEDED


@pytest.mark.parametrize(
    ("eta", "c", "label"),
    [(0.03, 0.5, "front"), (0.05, 0.05, "breather"), (0.14, 0.5, "fixed point")],
)
def test_of_three_labels_one_holds(eta: float, c: float, label: str) -> None:
    at = {"eta": eta, "c": c, "displacement": 6.0}
    chain = vdp_chain({"a": 4.0, "eps": 0.01, "sites": 16, **at})
    psi = as_psi(excite(chain, [16], 6.0))
    for note in ("front", "breather", "fixed point"):
        stated = StatedValue(value=1.0, error=0.0, note=note, extra=(20.0, psi))
        assert (_label_holds(at, stated, full=False).distance == 0.0) is (note == label), note
    # A promise that is given before the front has run through is not kept.
    if label == "front":
        early = StatedValue(value=1.0, error=0.0, note=label, extra=(-15.0, psi))
        assert _label_holds(at, early, full=False).distance > 0.0


def test_the_energy_of_a_chain_is_that_of_places_velocities_and_springs() -> None:
    y, velocity = np.array([1.0, 3.0]), np.array([3.0, 4.0])
    assert _root_energy(2.0, y, velocity) == pytest.approx(np.sqrt(1 + 9 + 9 + 16 + 2.0 * 4))


@pytest.mark.parametrize("full", [True, False])
def test_a_front_is_timed_at_its_amplitude_over_slow_times(
    full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A front of (8) of velocity 0.3 passes a site in 3.3/ε; one that rests, none in the end."""
    at, scale, seen = {"c": 0.6, "eta": 0.03125, "eps": 0.1}, 0.1 if full else 1.0, {}
    progress: list[float] = []

    def arrivals(rate: Any, start: Any, **given: Any) -> Any:
        seen.update(given, start=start, slope=rate(0.0, start))
        given["each_step"](0.5 * given["end"], np.full(4, np.nan))
        return seen["arrivals"] / scale

    monkeypatch.setattr(fronts, "arrivals_by_scipy", arrivals)
    monkeypatch.setattr(fronts, "Pace", lambda: SimpleNamespace(check=progress.append))
    seen["arrivals"] = np.arange(80.0) / 0.3
    check = fronts._by_scipy(at, StatedValue(value=0.3, error=0.0), full)
    assert check.distance < 1e-12
    # 5e3 units of the run's own time are 5e3 ε of slow time, in which it passes 0.3 sites each.
    sites = 24 + (150 if full else 352) + 8
    assert seen["end"] == pytest.approx(1.5 * sites / 0.3 / scale)
    assert seen["watched"] == slice(24, sites - 8)
    assert seen["rtol"] + seen["atol"] < 1e-7  # of which the interval between sites is uncertain
    assert progress == [pytest.approx(0.75)]
    chain = vdp_chain({"a": 4.0, "sites": 2, **at})
    assert seen["level"] == chain.unstable_amplitude
    # To the left the wave continues: the first site moves as that after a whole turn of four.
    slope = seen["slope"].reshape(-1, sites)
    assert slope[:, 0] == pytest.approx(slope[:, 4], abs=1e-12)
    amplitude = seen["amplitude"](seen["start"])
    assert amplitude == pytest.approx([chain.stable_amplitude] * 24 + [0.0] * (sites - 24))
    seen["arrivals"] = np.array([1.0, 2.0, 59.0, 61.0, np.nan])
    check = fronts._by_scipy(at, StatedValue(value=0.0, error=0.0), full)
    assert seen["end"] == pytest.approx(120.0 / scale)
    assert check.distance == pytest.approx(1.0 / 60.0)


def test_the_kinetic_relation_of_a_front_that_retreats_has_a_shift_of_two() -> None:
    v, at = 0.4, {"c": 2.0, "eta": 0.11}
    plain, _ = sum_by_quadrature(v, at["c"], 1e-8, 1000)
    for shift in (0, 2):
        found, _ = kinetic_relation._defect(v, at, shift)
        true = abs(plain + shift) - 2.0 * float(threshold_ratio(at["eta"]))
        assert float(found) == pytest.approx(true, abs=1e-7)


@pytest.mark.parametrize("above", [1.0 - 1e-7, 1.0, 1.0 + 1e-7])
def test_below_the_fold_no_velocity_near_its_own_is_above_the_target(
    above: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def excess(v: float, at: Mapping[str, float], _: int) -> float:
        return 1.0 if at["c"] > 1.0 or v == 0.3 * above * reached else -1.0

    monkeypatch.setattr(kinetic_relation, "_excess", excess)
    for reached in (0.0, 1.0):
        check = kinetic_relation._check_height(1.0, 0.3, 0.05, 1e-9, 0.0)
        assert (check.distance == 0.0) is (reached == 0.0)


@pytest.mark.parametrize(
    ("missed", "v", "error", "held"),
    [
        (1e-16, 0.3, 3e-7, True),
        (1e-13, 0.3, 3e-7, False),
        (1e-16, 0.05, 4e-10, True),
        (1e-16, 5.0, 4e-9, False),  # known to below 1e-9 of itself, as v at a fold is not
    ],
)
def test_a_branch_without_a_change_of_sign_is_a_fold_touched_to_within_rounding(
    missed: float, v: float, error: float, held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kinetic_relation, "_excess", lambda *_: missed)
    monkeypatch.setattr(kinetic_relation, "_changes_of_sign", lambda _: 1)
    relation = SimpleNamespace(branches=[SimpleNamespace(v=v, error=error)])
    stated = StatedValue(value=np.array([v]), error=1e-6, extra=relation)
    check = kinetic_relation._check_velocities({"c": 0.5, "eta": 0.03}, stated)
    assert (check.distance == 0.0) is held


def test_roots_are_counted_of_the_relation_with_the_same_parameters(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def count(*given: Any) -> int:
        asked.append(given)
        return 5

    monkeypatch.setattr(roots, "count_in_strips", count)
    for side, label in ((1.0, 3.0), (1.0, 10.0), (2.0, 10.0), (3.0, 3.0)):  # odd: labels above 0
        at = {"v": 0.3, "c": 0.5, "label": label, "side": side}
        stated = roots._roots(at)
        assert np.all(stated.value.imag > 0.0) == (side < 2.0)
        assert np.all(stated.value.real > 0.0) == (side % 2.0 == 1.0)
        assert roots._check_roots(at, stated).distance == 0.0
        assert (*asked[-1][:2], asked[-1][3]) == (0.3, 0.5, side < 2.0)


def test_a_breather_may_pulse_by_a_twentieth_of_the_level(monkeypatch: pytest.MonkeyPatch) -> None:
    at = {"a": 0.04, "eta": 0.05, "c": 0.1, "eps": 1e-6}
    level = vdp_chain({"sites": 16, **at}).unstable_amplitude
    assert level > 5.0  # so that it differs from its inverse
    stated = StatedValue(value=1.0, error=0.0, note="breather", extra=(20.0, np.zeros(16)))
    for share, held in ((0.04, True), (0.06, False)):
        y = np.zeros((16, 200))
        y[-1] = level * (1.5 + share * np.linspace(0.0, 1.0, 200))
        run = SimpleNamespace(success=True, y=y)
        monkeypatch.setattr(states, "solve_ivp", lambda *_, run=run, **__: run)
        assert (_label_holds(at, stated, full=False).distance == 0.0) is held


def test_a_run_or_a_cycle_states_its_own_error(monkeypatch: pytest.MonkeyPatch) -> None:
    at = {"k": 0.0, "far": 0.1, "d": 0.0, "spread": 0.0, "c": 0.6, "eps": 0.1, "sites": 5.0,
          "displacement": 2.0, "tolerance": 1e-9}  # fmt: skip
    run = SimpleNamespace(states=np.zeros((2, 2, 5)), error=0.25)
    monkeypatch.setattr(own_chains, "simulate", lambda *_, **__: run)
    assert own_chains.own_run(at).error == 0.25
    cycle = SimpleNamespace(period=10.0, stick_time=4.0, error=0.25)
    monkeypatch.setattr(friction, "stick_slip_cycle", lambda _: cycle)
    cell = {"v_d": 0.5, "mu_st": 0.6, "v0": 0.3, "xi": 0.05}
    stated = friction.stable_cycle(cell)
    assert (stated.value.tolist(), stated.error) == ([10.0, 4.0], 0.25)
    # Two releases of the cell are a period apart: a run of two periods has both.
    ends: list[float] = []

    def events(_: object, __: object, end: float, ___: object) -> Any:
        ends.append(end)
        return SimpleNamespace(last_cycle=(10.0, 4.5))

    monkeypatch.setattr(friction, "_events", events)
    assert friction.cycle_by_scipy(cell, stated).distance == 0.5
    assert min(ends) > 20.0


def test_a_chain_on_which_no_force_acts_stays_at_rest() -> None:
    at = {"k": 0.0, "far": 0.1, "d": 0.0, "spread": 0.0, "c": 0.6, "eps": 0.1, "sites": 5.0}
    for kind in (float, np.longdouble):
        assert not own_chains.rate_of(at)(0.0, np.zeros(10, dtype=kind)).any()
        driven = own_chains.rate_of({**at, "force": 0.5})(0.0, np.zeros(10, dtype=kind))
        assert np.flatnonzero(driven).tolist() == [6]  # the velocity of the second site


@pytest.mark.parametrize(
    ("share", "held"), [(1.0 - 1e-12, True), (1.0 + 1e-10, True), (1.0 + 1e-7, False)]
)
def test_a_friction_chain_has_no_more_energy_than_friction_can_add(
    share: float, held: bool
) -> None:
    """At rest at first: √(2E) grows by at most √N times the largest friction, which is 2 μ_st.

    Roundings of thousands of steps are allowed for.
    """
    at = {"c": 0.5, "mu_st": 0.7, "sites": 9.0}
    most = 3.0 * 2.0 * 0.7 * friction._SHORT
    stated = StatedValue(value=share * most, error=0.0, extra=np.zeros((2, 9)))
    check = friction.within_the_work_of_friction(at, stated)
    assert (check.distance == 0.0) is held


def test_a_chain_of_ones_own_is_the_one_that_is_asked_for() -> None:
    """Of several rows it is a square lattice; the damping of its sites differs where asked."""
    at = {"k": 0.0, "far": 0.0, "d": 0.0, "spread": 0.0, "c": 0.6, "eps": 0.1, "sites": 12.0}
    lattice = own_chains.chain_of({**at, "rows": 3.0})
    assert (lattice.shape, lattice.coupling) == ((3, 4), "square")
    assert np.ptp(own_chains.chain_of({**at, "spread": 0.2}).site_values["a"]) > 0.2
    assert np.ptp(own_chains.chain_of(at).site_values["a"]) == 0.0
    assert (own_chains.chain_of(at).sites, own_chains.chain_of(at).coupling[:4]) == (12, "next")
    assert own_chains.chain_of(at).shape is None
    assert own_chains.chain_of(at).values == {"a": 4.0, "b": 0.5}
    assert own_chains.chain_of(at).drive != own_chains.chain_of({**at, "force": 0.3}).drive


def test_the_equation_of_a_chain_of_ones_own_is_written_a_second_time() -> None:
    """ÿ = -(y + ky³) - ε(1 - 4y² + y⁴/2)ẏ - εc(springs of y + dẏ), also to second neighbours."""
    at = {"k": 0.3, "far": 0.2, "d": 0.7, "spread": 0.0, "c": 0.6, "eps": 0.1, "sites": 6.0}
    y, v = np.array([0.3, -1.2, 0.8, 2.0, -0.5, 0.1]), np.array([1.0, 0.4, -2.0, 0.6, 0.2, -0.9])
    force = -(y + 0.3 * y**3) - 0.1 * (1.0 - 4.0 * y**2 + 0.5 * y**4) * v
    for i in range(6):
        for j in range(6):
            spring = {1: 1.0, 2: 0.2}.get(abs(i - j), 0.0)
            force[i] -= 0.06 * spring * (y[i] - y[j] + 0.7 * (v[i] - v[j]))
    found = own_chains.rate_of(at)(0.0, np.concatenate([y, v]))
    assert found == pytest.approx(np.concatenate([v, force]), rel=1e-13)


def test_a_run_too_stiff_for_scipy_is_refused() -> None:
    at = {**RUN, "a": 100.0, "displacement": 1e3, "eps": 1.0}
    psi = as_psi(excite(vdp_chain(at), [1], 1e3))
    stated = StatedValue(value=psi, error=0.0, extra=psi)
    with pytest.raises(NoReferenceError, match="too stiff"):
        runs._full_precisely(at, stated)
