"""A truncation or active window changes no result by more than the bound that its row states.

Every test holds the result with the reduction against the result without it, for several
parameters, and keeps the bound itself from being made so wide that it would hold for anything.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Callable
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from fronts.cli import main
from theory.cells.vdp import threshold_ratio
from theory.chains.vdp import VanDerPolChain, VdpChain
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.series import SeriesScene, tail_sum
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
        scene = SeriesScene(mp.mpf(v), mp.mpf(c), 1)
        few, missed = tail_sum(scene, 9, 1, 25)
        rest, _ = tail_sum(scene, 39, 1, 25)
        k = labelled_roots(v, c, np.arange(9, 40), True).k
        terms = 1.0 / (k * -1j * (v + c * np.sin(k)))
        terms[[0, -1]] *= 0.5
        off = abs(few - rest - mp.mpc(complex(terms.sum())))
    assert off <= missed + 1e-14 * np.abs(terms).sum()  # roots and terms in double precision


@pytest.mark.parametrize("c", [10.0, 100.0, 300.0])
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
    """The second scene fails at the crossing itself, the last a third of a site ahead of it."""
    hidden = 1e-11 if c < 1.0 else 1e-8  # that front fails by far more
    held(sums.few_values_of_the_shape(c, eta, branch, hidden), 2e-11)


@pytest.mark.parametrize("eta", [0.01, 0.03125, 0.05])
@pytest.mark.parametrize("above", [1e-8, 1e-5, 0.01])
def test_values_left_out_of_a_search_lose_no_velocity(eta: float, above: float) -> None:
    held(sums.few_values_in_a_search(eta, above), 5e-3)  # half the widest spacing of the scan


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


@pytest.mark.parametrize("eta", [0.05, 0.08, 0.11])
def test_steps_left_out_of_a_period_change_less_than_the_error_of_the_orbit(eta: float) -> None:
    held(orbits.fewer_steps(eta), 1e-11)


@pytest.mark.parametrize("eps", [0.003, 0.01, 0.03])
def test_harmonics_not_solved_for_change_less_than_the_error_of_the_orbit(eps: float) -> None:
    # Only damping, of order eps, holds the orbit: that magnifies its rounding.
    held(orbits.harmonics_not_solved_for(eps), 1e-13 / eps)


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
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for changed, code in ((1e-13, 0), (1e-3, 1)):
        made_up = Comparison(1.0, 3.0, changed, 1e-12)
        reduction = Reduction("x", "by y", "z", "u", lambda made_up=made_up: made_up, "t")
        monkeypatch.setattr(table, "REDUCTIONS", (reduction,))
        assert main(["stress", "--work-reduction"]) == code
        assert ("the bound is exceeded" in capsys.readouterr().out) == bool(code)
