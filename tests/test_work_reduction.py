"""A truncation or active window changes no result by more than the bound that its row states.

Every test holds the result with the reduction against the result without it, for several
parameters, and keeps the bound itself from being made so wide that it would hold for anything.
"""

from __future__ import annotations

import ast
import dataclasses
import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.special import zeta

from fronts.cli import main
from fronts.commands import bench
from theory.cells.vdp import threshold_ratio
from theory.chains.vdp import VanDerPolChain, VdpChain, effective_epsilon
from theory.parameters import ParameterError
from theory.piecewise.folds import fold_coupling
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.series import RootSeries, tail_sum
from verification.breathers import orbits as breather_orbits
from verification.execution.points import Point
from verification.execution.sweep import sweep
from verification.piecewise.chain import PiecewiseMotion, Switching
from verification.piecewise.window import travelling_state, truncation_bound
from verification.work_reduction import orbits, runs, sums, table
from verification.work_reduction.comparison import Comparison
from verification.work_reduction.table import REDUCTIONS, Reduction

ROOT = Path(__file__).parents[1]


def held(found: Comparison, widest: float) -> None:
    """Assert the bound, that it is no wider than it may be, and that something is saved."""
    assert found.changed <= found.bound <= widest
    assert 0 < found.spent < found.whole


@pytest.mark.parametrize("v", [0.05, 0.3, 2.0])
@pytest.mark.parametrize("digits", [4, 5])
def test_roots_left_to_the_tail_change_less_than_the_error_returned(v: float, digits: int) -> None:
    held(sums.few_roots(v, 0.5, digits), 10.0**-digits)


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (2.0, 0.3), (0.5, 3.0)])
def test_orders_left_out_of_a_tail_change_less_than_30_times_the_smallest(
    v: float, c: float
) -> None:
    held(sums.few_tail_terms(v, c, 9), 1e-15)
    # The tail again, its first thirty terms as roots of their own: no Euler-Maclaurin among them.
    with mp.workdps(30):
        series = RootSeries(mp.mpf(v), mp.mpf(c), 1)
        few, missed = tail_sum(series, 9, 1, 25)
        rest, _ = tail_sum(series, 39, 1, 25)
        k = labelled_roots(v, c, np.arange(9, 40), True).k
        terms = 1.0 / (k * -1j * (v + c * np.sin(k)))
        terms[[0, -1]] *= 0.5
        off = abs(few - rest - mp.mpc(complex(terms.sum())))
    assert off <= missed + 1e-14 * np.abs(terms).sum()  # roots and terms in double precision


@pytest.mark.parametrize("c", [30.0, 100.0, 300.0])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-8, 1e-13])
def test_points_left_out_change_less_than_the_error_returned(c: float, tolerance: float) -> None:
    held(sums.few_points(c, tolerance), 2.0 * tolerance + 1e-13)  # the rounding of both


@pytest.mark.parametrize(("v", "c"), [(0.3, 300.0), (1.0, 1000.0)])
def test_digits_left_out_change_less_than_the_error_returned(v: float, c: float) -> None:
    held(sums.double_precision(v, c), 1e-14)


@pytest.mark.parametrize(
    ("c", "eta", "branch"),
    [(0.5, 0.03125, 0), (0.435, 0.03125, 0), (0.435, 0.03125, 1), (10.0, 0.03125, 0)],
)
def test_values_left_out_hide_no_violation_of_1e_11(c: float, eta: float, branch: int) -> None:
    """The second case fails at the crossing itself, the last a third of a site ahead of it."""
    hidden = 1e-11 if c < 1.0 else 1e-8  # that front fails by far more
    held(sums.few_values_of_the_shape(c, eta, branch, hidden), 2e-11)


@pytest.mark.parametrize("eta", [0.01, 0.03125, 0.05])
@pytest.mark.parametrize("above", [1e-8, 1e-5, 0.01])
def test_values_left_out_of_a_search_lose_no_velocity(eta: float, above: float) -> None:
    held(sums.few_values_in_a_search(eta, above), 5e-3)  # half the widest spacing of the scan


def test_switchings_found_by_few_searches_are_compared_with_those_of_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def switchings(chain: Any, count: int) -> np.ndarray:
        chain.sought = 90 if chain.every else 9
        return np.array([[1.0 + 1e-3 * chain.every, 3.0, 1.0, 0.0]] * count)

    monkeypatch.setattr(runs, "_switchings", switchings)
    found = runs.crossings_sought()
    assert (found.spent, found.whole) == (9.0, 90.0)
    assert found.changed >= 1e-3 * (1.0 - 1e-9)


def test_a_window_is_compared_with_one_that_holds_every_site_that_its_front_passes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def run(_: float, __: float, sites: int = 32) -> Any:
        v = 0.3 if sites == 32 else 0.3 + 1e-3
        return SimpleNamespace(window=sites, crossing_times=np.zeros(50), v=v, error=1e-4)

    wide: list[int] = []
    monkeypatch.setattr(runs, "simulate_front", run)
    monkeypatch.setattr(runs, "_moving", lambda *_: None)
    monkeypatch.setattr(runs, "widened", lambda _, sites: wide.append(sites) or sites)
    found = runs.sites_of_the_window()
    assert (found.spent, found.whole, found.bound) == (32, 82, 2e-4)
    assert found.changed == pytest.approx(1e-3)
    assert wide[0] >= found.whole


def test_the_change_by_sites_at_rest_is_that_of_the_site_that_changes_most(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def run(*_: Any, active_window: bool, **__: Any) -> Any:
        psi = np.zeros((5, 60), dtype=complex)
        psi[3, 7] = 1e-3j * active_window
        return SimpleNamespace(psi=psi, mean_active=9.0 if active_window else 60.0)

    monkeypatch.setattr(runs, "simulate", run)
    found = runs.sites_at_rest(tolerance=1e-7)
    assert (found.spent, found.whole, found.changed) == (9.0, 60.0, 1e-3)
    # A tenth of the tolerance, which is relative to the size of the state.
    assert found.bound == pytest.approx(1e-8 * runs.CHAIN.stable_amplitude)


def test_what_is_left_of_a_balance_is_in_the_error_of_its_period(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of any of its equations, and the last harmonic that is kept."""
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=3)
    h = np.array([[0.1, 0.0], [2.0, 1e-4], [0.1, 0.0]], dtype=complex)

    def solved(_: Any, guess: Any, **__: Any) -> Any:
        return SimpleNamespace(x=guess, jac=np.eye(guess.size), fun=1e-3 * np.eye(guess.size)[4])

    monkeypatch.setattr(orbits, "least_squares", solved)
    orbit: Any = SimpleNamespace(period=6.3)
    period, error = orbits._balanced(chain, np.array([1, 3]), h, orbit)
    assert period == pytest.approx(6.3 / 1.01)
    assert error == pytest.approx(period * (1e-3 + 1e-4), rel=1e-6)


@pytest.mark.parametrize("later", [1e-3, -1e-3])
def test_a_period_that_depends_on_the_steps_is_seen_whatever_its_sign(
    later: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def solve(*_: Any, steps: int = 0) -> Any:
        return SimpleNamespace(period=6.0 + (later if steps else 0.0), state=np.ones(3), error=1e-9)

    monkeypatch.setattr(orbits, "solve_orbit", solve)
    found = orbits.fewer_steps()
    assert (found.changed, found.bound) == pytest.approx((1e-3, 2e-9))
    # As many as for the steepest cycle for which an orbit is solved.
    monkeypatch.setattr(breather_orbits, "effective_epsilon", lambda _: breather_orbits.STIFFEST)
    most = breather_orbits.steps_for(VdpChain(a=2.5, b=0.5, c=0.1))
    assert found.whole == orbits._MAX_STEPS == most


@pytest.mark.parametrize("missing", ["v", "error"])
@pytest.mark.parametrize("which", [0, 1])
def test_a_front_that_does_not_settle_exceeds_every_bound(
    which: int, missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = {"v": 0.3, "error": 1e-9, "window": 48, "crossing_times": np.zeros(5)}
    made = [given, given]
    made[which] = given | {missing: None}
    fronts = iter([SimpleNamespace(**each) for each in made])
    monkeypatch.setattr(runs, "simulate_front", lambda *_: next(fronts))
    found = runs.sites_of_the_window()
    assert (found.spent, found.whole, found.changed, found.bound) == (48, 53, math.inf, 0.0)


@pytest.mark.parametrize(("c", "hidden"), [(0.5, 1e-9), (0.435, 1e-10), (10.0, 1e-8)])
def test_values_of_the_shape_are_as_dense_as_its_curvature_requires(
    c: float, hidden: float
) -> None:
    """A parabola through two of them is above its chord by h² max|g''|/8.

    They are computed in pieces, of which one less would not suffice.
    """
    r = threshold_ratio(0.03125)
    v = float(sums.all_velocities(np.array([c]), np.array([2.0 * r])).v[0])
    left, right = sums.check_admissible(v, c, r).proven_beyond
    grid = sums.ProfileGrid.make(v, c, max(left, right) + 2.0, 1e-11)
    zeta, phi = grid.on_lattice(400)
    g = np.abs(phi) ** 2
    bend = (g[2:] - 2.0 * g[1:-1] + g[:-2]) * 400.0**2
    inside = (zeta > -left) & (zeta < right) & (np.abs(zeta) > 1e-3)  # on either side of the kink
    found = sums.few_values_of_the_shape(c, 0.03125, 0, hidden)
    h = (left + right) / found.whole
    above = h**2 * float(np.abs(bend[inside[1:-1]]).max()) / 8.0
    pieces = found.whole / (left + right) / sums._PIECE
    # That of samples 1/400 apart is a few per cent less than it is beside the kink.
    assert 0.97 * (1.0 - 1.0 / pieces) ** 2 * hidden < above < hidden


@pytest.mark.parametrize("bend", [-2.0, 2.0])
def test_values_of_a_shape_are_as_dense_whichever_way_it_bends(
    bend: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of |φ|² = 20 + bend ζ²/2 two sites on either side; what may hide is |bend| h²/8."""

    def on_lattice(count: int) -> tuple[Any, Any]:
        zeta = np.arange(-4 * count, 4 * count + 1) / count
        return zeta, np.sqrt(20.0 + 0.5 * bend * zeta**2) * np.exp(3j * zeta)

    grid = SimpleNamespace(on_lattice=on_lattice, error=0.0)
    verdict = SimpleNamespace(proven_beyond=(2, 2), admissible=True, points=1)
    monkeypatch.setattr(sums.ProfileGrid, "make", lambda *_: grid)
    monkeypatch.setattr(sums, "all_velocities", lambda *_: SimpleNamespace(v=np.array([0.3])))
    monkeypatch.setattr(sums, "check_admissible", lambda *_: verdict)
    monkeypatch.setattr(sums, "_shape", lambda *_: [np.zeros((4, 1))])
    h = math.sqrt(8.0 * 1e-10 / abs(bend))
    pieces = math.ceil(1.0 / h / sums._PIECE)
    found = sums.few_values_of_the_shape(0.5, 0.03125, 0, 1e-10)
    assert (pieces, found.whole) == (13, 13 * sums._PIECE * 4)


@pytest.mark.parametrize("error", [0.25, 0.0])
def test_a_violation_that_may_be_passed_over_is_within_its_bound(
    error: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    r = threshold_ratio(0.03125)

    def shape(_: object, m: Any, __: int) -> Any:
        return [np.where(m < 0, math.sqrt(r * r - 5e-12), 0.0)[:, None]]

    make = sums.ProfileGrid.make
    monkeypatch.setattr(sums, "_shape", shape)
    monkeypatch.setattr(
        sums.ProfileGrid, "make", lambda *given: dataclasses.replace(make(*given), error=error)
    )
    found = sums.few_values_of_the_shape(0.5, 0.03125)
    assert found.changed == pytest.approx(5e-12, rel=1e-4)
    assert found.holds
    assert found.bound == pytest.approx(error, abs=2e-11)  # the error of the values themselves
    # A shape without a violation is not that of a front which fails.
    monkeypatch.setattr(sums, "_shape", lambda _, m, __: [np.where(m < 0, 1.0, 0.0)[:, None]])
    assert sums.few_values_of_the_shape(0.5, 0.03125).changed == 0.0
    assert sums.few_values_of_the_shape(10.0, 0.03125).changed == math.inf


def test_a_search_that_loses_a_velocity_exceeds_every_bound(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = sums.all_velocities

    def lost(*given: Any) -> Any:
        found = search(*given)
        return SimpleNamespace(v=found.v[1:], evaluations=found.evaluations)

    monkeypatch.setattr(sums, "all_velocities", lost)
    found = sums.few_values_in_a_search(0.03125, 0.01)
    assert found.changed == math.inf
    assert 0.0 < found.bound < 1.0


@pytest.mark.parametrize("share", [1.05, 0.95])
@pytest.mark.parametrize("at", [0, -1])
def test_a_search_that_finds_another_velocity_exceeds_the_bound(
    at: int, share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    search = sums.all_velocities

    def moved(*given: Any) -> Any:
        found = search(*given)
        v = found.v.copy()
        v[at] *= share
        return SimpleNamespace(v=v, evaluations=found.evaluations)

    monkeypatch.setattr(sums, "all_velocities", moved)
    assert not sums.few_values_in_a_search(0.03125, 0.01).holds


@pytest.mark.parametrize(("c", "eta"), [(0.5, 0.03125), (1.5, 0.05), (0.3, 0.01)])
def test_sites_outside_the_window_change_less_than_the_truncation_bound(
    c: float, eta: float
) -> None:
    held(runs.sites_of_the_window(c, eta), 1e-11)


@pytest.mark.parametrize(("c", "v"), [(0.1, 0.02), (0.5, 0.3), (3.0, 1.4), (0.5, -0.4)])
def test_windows_too_short_disturb_by_less_than_the_truncation_bound(c: float, v: float) -> None:
    """The windows that the code chooses leave only rounding to be seen: shorter ones leave more."""
    long = travelling_state(c, v, 2048)
    exact = long.phi[-3 - long.origin : 4 - long.origin]
    for sites in (32, 64):
        short = travelling_state(c, v, sites)
        off = np.abs(short.phi[-3 - short.origin : 4 - short.origin] - exact).max()
        assert off <= truncation_bound(c, v, sites - 4) + 1e-13  # four sites aside; rounding


@pytest.mark.parametrize("of", [VdpChain.full, VdpChain.averaged])
@pytest.mark.parametrize(("c", "tolerance"), [(0.6, 1e-9), (0.6, 1e-6), (5.0, 1e-9)])
def test_sites_at_rest_change_less_than_a_tenth_of_the_tolerance(
    of: Callable[[VdpChain], VanDerPolChain], c: float, tolerance: float
) -> None:
    end = 600.0 if c < 1.0 else 80.0  # waves have not reached the end
    chain = of(runs.CHAIN.replace(c=c))
    held(runs.sites_at_rest(chain, end, tolerance), tolerance)


@pytest.mark.parametrize(("c", "end"), [(0.6, 1e4), (1.5, 6e3)])
@pytest.mark.parametrize("tolerance", [1e-7, 1e-9, 1e-12])
def test_sites_behind_change_less_than_the_error_of_the_arrivals(
    c: float, end: float, tolerance: float
) -> None:
    held(runs.sites_behind(c, end, tolerance), 1e6 * tolerance)  # times of 1e4, COARSER = 100


@pytest.mark.parametrize(("c", "eta"), [(0.5, 0.03125), (1.5, 0.05), (3.0, 0.03125)])
def test_searches_left_out_lose_no_crossing_and_move_none(c: float, eta: float) -> None:
    found = runs.crossings_sought(c, eta, 6)
    held(found, 0.0)
    assert found.spent >= 6  # one for each crossing at least


@pytest.mark.parametrize(("c", "eta"), [(0.5, 0.03125), (1.5, 0.05)])
def test_steps_left_out_between_crossings_move_them_by_rounding_only(c: float, eta: float) -> None:
    """By Runge-Kutta to its own error; and the first crossing in 40 digits, to the jitter."""
    held(runs.steps_between_crossings(c, eta, 6), 1e-7)
    r = threshold_ratio(eta)
    state = travelling_state(c, 0.4, 96)
    step = PiecewiseMotion(c, r, state).advance(1e3)
    assert isinstance(step, Switching)
    slot, sites = step.site - state.origin, state.phi.size
    with mp.workdps(40):
        ramp = [mp.mpf(n) / sites for n in range(sites)]
        on = [mp.mpf(int(abs(x) > r)) for x in state.phi]
        turn = [mp.expjpi(mp.mpf(2 * n) / sites) for n in range(sites)]

        def mode(values: list[mp.mpc], k: int) -> mp.mpc:
            return mp.fsum(x / turn[k * n % sites] for n, x in enumerate(values)) / sites

        start = [mp.mpmathify(complex(x)) + y for x, y in zip(state.phi, ramp, strict=True)]
        force = [(x + y) / 2 for x, y in zip(on, ramp, strict=True)]
        rates = [mp.mpc(-0.5, c * (1 - mp.re(turn[k]))) for k in range(sites)]
        balance = [mode(force, k) / -rates[k] for k in range(sites)]
        parts = [mode(start, k) - balance[k] for k in range(sites)]

        def gap(time: mp.mpf) -> mp.mpf:
            each = (
                turn[k * slot % sites] * (balance[k] + parts[k] * mp.exp(rates[k] * time))
                for k in range(sites)
            )
            return abs(mp.fsum(each) - ramp[slot]) - r

        exact = mp.findroot(gap, (step.wait - 1e-6, step.wait + 1e-6), tol=1e-50)
        assert 0 < step.jitter < 1e-13
        assert abs(exact - step.wait) <= step.jitter


def test_as_many_steps_as_suffice_for_every_chain_are_those_of_the_stiffest() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.1, eps=1.0)
    eps = breather_orbits.STIFFEST * (1.0 - 1e-12) / effective_epsilon(chain)
    assert breather_orbits.steps_for(chain.replace(eps=eps)) == orbits._MAX_STEPS
    with pytest.raises(ParameterError, match="at most 10 for a true orbit"):
        breather_orbits.steps_for(chain.replace(eps=eps * (1.0 + 1e-9)))


@pytest.mark.parametrize("eta", [0.05, 0.08, 0.11])
def test_steps_left_out_of_a_period_change_less_than_the_error_of_the_orbit(eta: float) -> None:
    held(orbits.fewer_steps(eta), 1e-11)


@pytest.mark.parametrize("eps", [0.003, 0.01, 0.03])
def test_harmonics_not_solved_for_change_less_than_the_error_of_the_orbit(eps: float) -> None:
    # Only damping, of order eps, holds the orbit: that magnifies its rounding.
    found = orbits.harmonics_not_solved_for(eps)
    held(found, 1e-13 / eps)
    # A state and a period; real and imaginary parts of the harmonics of three sites, and a period.
    assert found.spent == 7
    assert (found.whole - 1) % 6 == 0


def process_of(_: Point) -> dict[str, int]:
    return {"process": os.getpid()}


def test_two_workers_allowed_start_no_process_for_one_point() -> None:
    assert sweep(process_of, {"x": [1.0]}, workers=2)["process"][0] == os.getpid()


def test_every_row_names_the_test_that_asserts_its_bound() -> None:
    """By name: the test of a row runs the comparison of that row."""
    for reduction in REDUCTIONS:
        file, function = reduction.test.split("::")
        tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
        (node,) = (
            one
            for one in ast.walk(tree)
            if isinstance(one, ast.FunctionDef) and one.name == function
        )
        called = {one.attr for one in ast.walk(node) if isinstance(one, ast.Attribute)}
        assert reduction.compare.__name__ in called, reduction.what
        assert "held" in {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}


def test_every_kind_of_thing_left_out_has_a_row() -> None:
    rows = " ".join(reduction.what for reduction in REDUCTIONS)
    for kind in (
        "roots", "tail terms", "quadrature points", "digits", "harmonics", "sites", "time steps",
        "events",
    ):  # fmt: skip
        assert kind in rows


def test_a_bound_that_is_exceeded_is_said_and_changes_the_exit_code(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def reduction(what: str, changed: float) -> Reduction:
        made_up = Comparison(1.0, 3.0, changed, 1e-12)
        return Reduction(
            what=what, decided="by y", bound="z", unit="u", test="t", compare=lambda: made_up
        )

    fine, bad = reduction("terms", 1e-13), reduction("points", 1e-3)
    for some, code in (((fine,), 0), ((bad,), 1), ((fine, bad), 1), ((bad, fine), 1)):
        monkeypatch.setattr(table, "REDUCTIONS", some)
        assert main(["stress", "--work-reduction"]) == code
        said = capsys.readouterr().out
        assert ("the bound is exceeded" in said) == bool(code)
        heads = [line for line in said.splitlines() if not line.startswith(" ")]
        assert heads == [f"{each.what}: by y" for each in some]
    (tmp_path / "benchmarks" / "results").mkdir(parents=True)
    (tmp_path / "benchmarks" / "work_precision.py").touch()
    monkeypatch.setattr(bench, "ROOT", tmp_path)
    assert main(["stress", "--work-reduction", "--record"]) == 1
    kept = json.loads((tmp_path / "benchmarks" / "results" / "work_reduction.json").read_text())
    assert [row["what"] for row in kept["work_reduction"]] == ["points", "terms"]
    assert kept["command"] == "fronts stress --work-reduction"


def test_what_changes_is_said_beside_what_may_unless_neither_does() -> None:
    said = [str(Comparison(1.0, 2.0, *pair)) for pair in ((0.0, 0.0), (0.0, 1e-12), (1e-9, 0.0))]
    assert said[0] == "nothing"
    assert "1e-12" in said[1]
    assert "1e-09" in said[2]
    assert "exceeded" in said[2]


def test_a_window_is_held_to_the_errors_of_both_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    made = iter([(0.5, 1e-9), (0.5 + 3e-9, 4e-9)])

    def front(*_: object) -> SimpleNamespace:
        v, error = next(made)
        return SimpleNamespace(v=v, error=error, window=30, crossing_times=np.zeros(70))

    monkeypatch.setattr(runs, "simulate_front", front)
    found = runs.sites_of_the_window(0.5, 0.03125)
    assert (found.spent, found.whole) == (30, 100)
    assert found.changed == pytest.approx(3e-9)
    assert found.bound == pytest.approx(5e-9)


def test_times_are_in_milliseconds(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is timed takes a quarter of a second and a half."""
    seconds = iter([0.25, 0.5] * 3)

    def timed(compute: Callable[[], Any], _: int = 2) -> tuple[Any, float]:
        return compute(), next(seconds)

    rows = np.array([[1.0, 3, 1, 1e-14], [2.0, 4, 1, 2e-14]])
    result = SimpleNamespace(value=mp.mpc(1), error=1e-15)
    for module in (runs, sums):
        monkeypatch.setattr(module, "timed", timed)
    monkeypatch.setattr(runs, "_switchings", lambda *_: rows)
    monkeypatch.setattr(runs, "_stepped_switchings", lambda *_: rows)
    monkeypatch.setattr(sums, "sum_by_roots", lambda *_: result)
    monkeypatch.setattr(sums, "tail_sum", lambda *_: (mp.mpc(1), mp.mpf(10) ** -16))
    for compare in (runs.steps_between_crossings, sums.few_tail_terms, sums.double_precision):
        found = compare()
        assert (found.spent, found.whole) == (250.0, 500.0)
        assert found.changed == 0.0
        assert 0.0 < found.bound < 1e-13


def test_points_are_judged_where_most_of_what_is_allowed_is_used(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Not where the sum changes most: there an error is stated that allows it."""
    error, off = np.full(200, 1e-12), np.zeros(200)
    error[20], off[20] = 1.0, 1e-2
    off[70] = 1e-3
    velocities: list[float] = []

    def made_up(v: np.ndarray, *_: object) -> SimpleNamespace:
        velocities.extend(v.tolist())
        return SimpleNamespace(value=off + 0j, error=error, points=np.full(200, 3))

    monkeypatch.setattr(sums, "sums", made_up)
    monkeypatch.setattr(sums, "plain_points", lambda v, c, _: (10 if v < c else 20,))
    monkeypatch.setattr(sums, "_plain_mean", lambda *_: 1.0 + 0j)
    found = sums.few_points(100.0, 1e-13)
    assert (found.spent, found.whole, found.changed) == (600.0, 1000.0, 1e-3)
    assert not found.holds
    # The stated error, the tolerance, and sixteen roundings of the plain sum and of one.
    assert found.bound == pytest.approx(
        1e-12 + 1e-13 + 32.0 * np.finfo(float).eps, rel=1e-9, abs=0.0
    )
    assert (min(velocities), max(velocities)) == pytest.approx((0.05, 5.0))


@pytest.mark.parametrize("beyond", [(3, 9), (9, 3)])
def test_the_shape_is_given_as_far_as_it_is_not_proven(
    beyond: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ahead of the front or behind it, whichever is farther."""
    asked: list[float] = []

    def make(*given: Any) -> None:
        asked.append(given[2])
        raise KeyboardInterrupt

    verdict = SimpleNamespace(proven_beyond=beyond, admissible=True, points=1)
    monkeypatch.setattr(sums, "check_admissible", lambda *_: verdict)
    monkeypatch.setattr(sums.ProfileGrid, "make", make)
    with pytest.raises(KeyboardInterrupt):
        sums.few_values_of_the_shape()
    assert asked[0] >= 9


def test_a_search_is_compared_just_above_the_fold(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def velocities(c: np.ndarray, _: object) -> None:
        asked.extend(c.tolist())
        raise KeyboardInterrupt

    monkeypatch.setattr(sums, "all_velocities", velocities)
    for above in (1e-8, 1e-2):
        with pytest.raises(KeyboardInterrupt):
            sums.few_values_in_a_search(0.03125, above)
    near, far = asked
    assert far / near - 1.0 == pytest.approx(0.01, rel=1e-5)
    fold = fold_coupling(0.03125)
    assert near / fold.value - 1.0 == pytest.approx(1e-8, rel=1e-5)


def test_a_front_that_retreats_crosses_downwards_by_both_methods() -> None:
    found = runs.steps_between_crossings(2.0, 0.115, 2)
    assert found.changed <= found.bound < 1e-7


def test_a_bound_holds_the_errors_of_both_results(monkeypatch: pytest.MonkeyPatch) -> None:
    results = iter([(1.0, 0.25), (1.5, 0.5)] * 2)

    def made(*_: object) -> SimpleNamespace:
        value, error = next(results)
        return SimpleNamespace(value=mp.mpc(value), error=error)

    monkeypatch.setattr(sums, "timed", lambda compute: (compute(), 0.5))
    monkeypatch.setattr(sums, "sum_by_roots", made)
    monkeypatch.setattr(sums, "tail_sum", lambda *_: tuple(map(mp.mpf, next(results))))
    for compare in (sums.double_precision, sums.few_tail_terms):
        found = compare()
        assert (found.changed, found.bound) == (0.5, 0.75)


@pytest.mark.parametrize(("v", "digits"), [(0.3, 2), (0.5, 3), (2.0, 3)])
def test_so_many_roots_are_summed_one_by_one_as_leave_out_less_than_is_asked(
    v: float, digits: int
) -> None:
    """Of k = 2πν to either side terms are 1/(v k²); ζ(2, M + 1) is the sum of 1/ν² beyond M."""
    most = (sums.few_roots(v, 0.5, digits).whole - 1) / 2
    left = 2.0 / (v * (2.0 * np.pi) ** 2) * zeta(2.0, [most + 1.0, 0.9 * most])
    assert left[0] < 10.0**-digits < left[1]


def test_roots_summed_one_by_one_err_by_what_their_places_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A term is 1/(k (v + c sin k)); two are halved. The error of the other sum is added."""
    v, c, radius = 0.3, 0.5, 1e-6
    k = np.array([-6.0 + 0.2j, 1.0j, 6.0 + 0.2j])
    roots = SimpleNamespace(k=k, radius=radius)
    monkeypatch.setattr(sums, "labelled_roots", lambda *_: roots)
    few = SimpleNamespace(value=0j, error=0.25, terms=1)
    monkeypatch.setattr(sums, "sum_by_roots", lambda *_: few)
    monkeypatch.setattr(sums, "tail_sum", lambda *_: (mp.mpc(0), mp.mpf(0)))
    stated = sums.few_roots(v, c, 0).bound - few.error
    turns = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 40))[:, None]
    moved = k + radius * turns
    terms = np.array([0.5, 1.0, 0.5]) / (moved * (v + c * np.sin(moved)))
    off = float(np.abs(terms - terms.mean(axis=0)).max(axis=0).sum())
    assert off <= stated < 1.5 * off


@pytest.mark.parametrize("error", [0.25, None])
def test_a_front_of_few_sites_is_compared_with_one_that_keeps_all(
    error: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As many as the table says; a run without an error allows no change."""
    asked: list[int] = []

    def run(*_: Any, trailing_sites: int, **__: Any) -> Any:
        asked.append(trailing_sites)
        active, arrivals = (30.0, [1.0, 2.5]) if trailing_sites else (90.0, [1.0, 2.0])
        return SimpleNamespace(mean_active=active, arrivals=np.array(arrivals), arrival_error=error)

    monkeypatch.setattr(runs, "simulate", run)
    found = runs.sites_behind()
    assert (found.spent, found.whole, found.changed) == (30.0, 90.0, 0.5)
    assert found.bound == (error or 0.0)
    (row,) = (each for each in REDUCTIONS if each.what == "sites behind a front")
    assert f" {asked[0]} sites behind " in row.decided
    assert asked[1] == 0


def test_the_shape_at_every_fraction_of_a_site_is_that_of_a_coarser_lattice() -> None:
    """Of two pieces; at sites on both sides of the kink, where the lattice has its zero."""
    grid = sums.ProfileGrid.make(0.3, 0.5, 6.0, 1e-11)
    zeta, phi = grid.on_lattice(4)
    m = np.arange(-3, 3)
    for quarter, piece in enumerate(sums._shape(grid, m, 2)):
        for half in (0, 1):
            ours = piece[:, half * sums._PIECE // 2]
            at = m + 0.5 * quarter + 0.25 * half
            theirs = phi[np.searchsorted(zeta, at)]
            assert np.abs(ours - theirs)[at != 0.0].max() < 1e-11


def test_crossings_are_as_far_apart_as_the_two_that_are_farthest() -> None:
    rows = np.array([[1.0, 3, 1, 0.0], [2.0, 4, 1, 0.0], [3.0, 5, -1, 0.0]])
    for place, off in ((0, 0.25), (1, -0.5), (2, 0.125)):
        moved = rows.copy()
        moved[place, 0] += off
        assert runs._apart(rows, moved) == abs(off)
    for column in (1, 2):
        other = rows.copy()
        other[1, column] += 1
        assert runs._apart(rows, other) == np.inf
    assert runs._apart(rows, rows[:-1]) == np.inf


def test_searches_for_a_crossing_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    sought: list[int] = []
    search = PiecewiseMotion._first_crossing

    def counted(self: Any, *given: Any) -> Any:
        sought.append(given[2])
        return search(self, *given)

    monkeypatch.setattr(PiecewiseMotion, "_first_crossing", counted)
    found = runs.crossings_sought(0.5, 0.03125, 2)
    assert found.spent + found.whole == len(sought)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_harmonics_are_compared_with_the_errors_of_both_solutions(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    known: list[Any] = []

    def balanced(_: object, odd: Any, __: object, orbit: Any) -> tuple[float, float]:
        known.extend((orbit, odd.size))
        return orbit.period + 0.25 * side, 0.5

    monkeypatch.setattr(orbits, "_balanced", balanced)
    found = orbits.harmonics_not_solved_for(0.01)
    assert found.changed == pytest.approx(0.25)
    assert found.bound == known[0].error + 0.5
    assert found.whole == 1 + 2 * 3 * known[1]  # a period, and each harmonic of three sites


@pytest.mark.parametrize(
    ("period", "site", "changed"), [(0.0, 0.25, 0.25), (0.0, -0.25, 0.25), (-0.5, -0.25, 0.5)]
)
def test_orbits_are_as_far_apart_as_their_periods_or_the_site_that_differs_most(
    period: float, site: float, changed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = SimpleNamespace(period=6.0, state=np.array([1.0, 2.0, 3.0]), error=1e-3)
    few = SimpleNamespace(period=6.0 + period, state=np.array([1.0, 2.0 + site, 3.125]), error=2e-3)

    def solved(*_: object, steps: int | None = None) -> SimpleNamespace:
        return few if steps is None else whole

    monkeypatch.setattr(orbits, "solve_orbit", solved)
    found = orbits.fewer_steps()
    assert found.changed == changed
    assert found.bound == pytest.approx(3e-3)


@pytest.mark.parametrize("left", [1e-3, -1e-3, 0.0])
def test_a_balance_errs_by_what_is_left_of_it_of_either_sign_and_by_rounding(
    left: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.1, eps=0.05, sites=3)
    odd = np.array([1, 3])
    harmonics = np.array([[0.1, 0.0], [2.0, 0.0], [0.1, 0.0]], dtype=complex)

    def solved(_: object, guess: np.ndarray, **__: object) -> SimpleNamespace:
        return SimpleNamespace(x=guess, jac=np.eye(guess.size), fun=np.full(guess.size, left))

    monkeypatch.setattr(orbits, "least_squares", solved)
    orbit: Any = SimpleNamespace(period=6.3)
    period, error = orbits._balanced(chain, odd, harmonics, orbit)
    assert period == pytest.approx(6.3 / 1.01)
    rounding = 8.0 * np.finfo(float).eps
    assert error == pytest.approx((abs(left) + rounding) * period, rel=1e-9, abs=0.0)


def test_a_site_that_crosses_back_at_once_does_so_by_both_methods() -> None:
    """At strong coupling waves take a site over the threshold and back before another crosses."""
    c, r = 20.0, threshold_ratio(0.02)
    start = runs._moving(c, r)
    exact = runs._switchings(PiecewiseMotion(c, r, start), 3)
    stepped = runs._stepped_switchings(c, r, start, 3, 1e-9)
    assert (exact[1, 1], exact[1, 2]) == (exact[2, 1], -exact[2, 2])
    assert runs._apart(exact, stepped) < 1e-6
