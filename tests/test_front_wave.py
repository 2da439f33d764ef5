"""Fronts of (43) as solutions: against scipy in two ways, running chains and limits."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache, partial
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fronts as fr
from fronts import branches
from fronts.cli import main
from tests.folds import fold_of
from theory.averaged.front import strong_coupling_front
from theory.parameters import ParameterError
from verification.continuation.newton import BranchPoint, NotConvergedError
from verification.fronts import follow, resting, wave
from verification.fronts.follow import follow_front_wave
from verification.fronts.resting import PinningEta, pinning_eta, static_fold
from verification.fronts.wave import NoFrontError, front_wave
from verification.references import phase_locked
from verification.references.front_wave import front_velocity
from verification.steppers.amplitudes import Amplitudes, rate, rate_by, with_disturbances

ETA = 0.03125


@cache
def by_differences(c: float, eta: float) -> tuple[float, float]:
    """Return the velocity on two grids, whose errors differ by a factor of 29: a tenth power.

    At small η the wave is steep, and the grids are finer.
    """
    grids = (80, 112) if eta < 0.02 else (40, 56)
    coarse, fine = (front_velocity(c, eta, m, behind=30) for m in grids)
    return coarse, fine


@pytest.mark.parametrize(("c", "eta"), [(0.6, ETA), (2.0, ETA), (1.0, 0.1), (0.6, 0.01)])
def test_the_velocity_is_that_of_differences_along_the_wave(c: float, eta: float) -> None:
    front = front_wave(c, eta)
    coarse, fine = by_differences(c, eta)
    # The reference errs by a tenth power: a factor of 29 less than the two differ.
    assert abs(front.v - fine) <= front.error + abs(fine - coarse) + 1e-13
    assert abs(fine - coarse) < 1e-7


def test_windows_are_as_long_as_the_tails_ask_for() -> None:
    """At c = 0.85 some start of Newton's method wanders; it is not to be taken for a root."""
    for c in np.linspace(0.8, 0.9, 41):
        window = wave.Window.started(float(c), ETA)
        behind, ahead = window._decay(float(window.guess[-1]))
        v, attraction = window.guess[-1], window.attraction
        assert abs(c * math.sinh(ahead) - v * ahead - 0.5) < 1e-10
        assert 2.0 < behind < 4.0
        # No root has a smaller positive real part: the winding of the function about a rectangle.
        corners = np.array(
            [1e-3 - 4j, behind - 0.01 - 4j, behind - 0.01 + 4j, 1e-3 + 4j, 1e-3 - 4j]
        )
        edge = np.concatenate([np.linspace(*pair, 400) for pair in pairwise(corners)])
        values = c * np.sinh(edge) - v * edge + attraction
        assert abs(np.angle(values[1:] / values[:-1]).sum()) < 1e-6


@pytest.mark.parametrize("c", [0.3, 1.0, 2.0])
def test_the_error_is_below_what_was_asked_for(c: float) -> None:
    assert front_wave(c, ETA).error < 1e-11


def complex_rate(c: float, eta: float) -> Any:
    """(43) at a = 1 as it is printed, written out here; beyond the ends is what is at them."""

    def rate(_: float, phi: Any) -> Any:
        s = np.abs(phi) ** 2
        spring = 2 * phi - np.roll(phi, 1) - np.roll(phi, -1)
        return 0.5j * c * spring - 0.5 * phi * (1 - s / 4 + eta * s**2 / 8)

    return rate


def test_the_complex_chain_carries_the_front_and_its_disturbances_one_site_further() -> None:
    """φ_{n+1}(1/v) = -i e^{ic/v} φ_n(0), by scipy; and what a small push of one site becomes."""
    c = 1.0
    front = front_wave(c, ETA)
    padded = np.concatenate([np.full(20, front.r[0]), front.r, np.zeros(20)])
    turn = (-1j) ** np.arange(padded.size)
    period = 1.0 / front.v

    def carried(r: Any) -> Any:
        run = solve_ivp(complex_rate(c, ETA), (0, period), turn * r, "DOP853", rtol=1e-12,
                        atol=1e-13)  # fmt: skip
        return run.y[:, -1] / turn * np.exp(-1j * c * period)

    inner = slice(20, 20 + front.r.size)  # a period carries what the ends do a few sites inwards
    end = carried(padded)
    off = np.abs(end[21 : 21 + front.r.size] - front.r)
    assert off.max() < 1e-9 * front.r.max()  # of scipy, at rates up to 1/2η over a period
    square = (1.0 + math.sqrt(1.0 - 8.0 * ETA)) / ETA
    rho = front.r / math.sqrt(square)
    push = 1e-5
    for direction, phases in ((1.0, False), (1j, True)):
        matrix = with_disturbances(rho, Amplitudes(c, ETA, square), period, 60, phases)[2]
        for site in (front.crossing - 1, front.crossing + 2):
            pushed = padded.astype(complex)
            pushed[20 + site] += push * direction
            column = (carried(pushed) - end)[inner] / (push * direction)
            assert np.abs(column - matrix[:, site]).max() < 10.0 * push  # of second order


@pytest.mark.parametrize("phases", [False, True])
def test_disturbances_of_a_chain_at_rest_reach_equally_far_to_both_sides(phases: bool) -> None:
    """As far as (ct/2)^d/d! exceeds 1e-19; the coupling has opposite signs on both sides."""
    found = with_disturbances(np.zeros(60), Amplitudes(0.5, ETA, 1.0), 0.5, 20, phases)[2]
    for d in range(12):
        left, right = (abs(found[30 + side * d, 30]) for side in (-1, 1))
        assert left == pytest.approx(right, rel=1e-9, abs=1e-19)
        assert left > 1e-2 * 0.125**d / math.factorial(d)


@pytest.mark.parametrize(
    ("c", "eta"),
    [(0.3, ETA), (2.0, 0.06), (0.25, 0.08), (0.1, 0.002), (30.0, 0.01), (7.65, 0.0945)],
)
def test_the_stated_error_bounds_the_true_one(
    c: float, eta: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    front = front_wave(c, eta)
    monkeypatch.setattr(wave, "_STEP", 0.2)
    monkeypatch.setattr(wave, "_DEPTHS", (40.0, 44.0))
    better = front_wave(c, eta)
    assert abs(front.v - better.v) <= front.error + better.error
    assert front.error < 1e-10 * max(1.0, c)


@pytest.mark.parametrize(
    ("step", "depths"),
    [(3.0, (30.0, 36.0)), (0.5, (5.0, 11.0)), (3.0, (5.0, 11.0))],
    ids=["coarse steps", "a short window", "both"],
)
def test_the_error_tells_of_coarse_steps_and_of_a_short_window(
    step: float, depths: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The check must have finer steps and a longer window, or one of the two goes unnoticed."""
    right = front_wave(1.0, ETA)
    assert right.r.size > wave.Window.started(1.0, ETA).guess.size - 1 + 2
    monkeypatch.setattr(wave, "_STEP", step)
    monkeypatch.setattr(wave, "_DEPTHS", depths)
    crude = front_wave(1.0, ETA)
    off = abs(crude.v - right.v)
    assert off > 100.0 * right.error  # there is something to tell
    assert off + right.error < crude.error < 1e4 * off


@pytest.mark.parametrize("c", [0.6, 30.0])
def test_the_check_and_the_spectrum_have_more_steps_than_the_first_solution(
    c: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a fast front as well, whose steps are as few as there can be."""
    asked: list[tuple[float, int]] = []

    def spied(rho: Any, chain: Any, time: float, steps: int, *rest: Any, **more: Any) -> Any:
        asked.append((time, steps))
        return with_disturbances(rho, chain, time, steps, *rest, **more)

    monkeypatch.setattr(wave, "with_disturbances", spied)
    front = front_wave(c, ETA)
    count = front.iterations - 1
    first, check = (
        {steps for time, steps in part if abs(time * front.v - 1.0) < 1e-6}
        for part in (asked[: count - 1], asked[-5:-2])  # then the spectrum of the first solution
    )
    assert check == {front.steps}
    assert min(first) < front.steps


def _described(
    monkeypatch: pytest.MonkeyPatch, amplitudes: Any, phases: Any, **last: float
) -> wave.FrontWave:
    """Describe a made-up front, with these multipliers; ``last`` is of its second solution."""
    window = replace(wave.Window.started(1.0, ETA), left=12, right=12)
    window = replace(window, guess=np.append(np.linspace(1.0, 0.0, 24), 0.8))
    first = BranchPoint(window.guess, 1.0, np.ones(26), 0.0, 1e-13, 5, 1.0)

    def second(_: Any, guess: Any, c: float) -> BranchPoint:
        u = np.append(guess[:-1], last.get("v", 0.8))
        return BranchPoint(u, c, np.ones(u.size + 1), 0.0, last.get("correction", 0.0), 3, 1.0)

    def disturbed(rho: Any, *_: Any) -> tuple[Any, Any, Any]:
        values = phases if _[-1] else amplitudes
        if "earlier" in last and rho.size == window.guess.size - 1:
            values = (last["earlier"], *values[1:])
        matrix = np.zeros((rho.size, rho.size))
        for n, value in enumerate(values):
            matrix[n + 1, n] = value  # of a site on the one before; moved on, on the diagonal
        return rho, rho, matrix

    monkeypatch.setattr(wave, "solve_at", second)
    monkeypatch.setattr(wave, "with_disturbances", disturbed)
    return window.described(first, 0.0)


@pytest.mark.parametrize(
    ("amplitudes", "phases", "stable"),
    [
        ((0.3, 1.0, -0.9), (1.0, 0.5), True),
        ((0.3, 1.0, -0.9), (1.0 + 1e-9, 0.5), True),  # as far off as rounding may be
        ((0.3, 1.0, -0.9), (-1.0 - 1e-7, 0.5), False),
        ((0.3, 1.0 + 1e-9, -1.0 - 1e-6), (1.0, 0.5), False),
        ((0.3, 1.0 - 1e-9, -0.9), (1.0, 0.5), True),
        ((1.001, 1.0, 0.2), (1.0,), False),
        ((0.3, 1.0, 0.999999), (1.0,), True),
    ],
)
def test_stability_is_read_off_the_multipliers(
    amplitudes: tuple[float, ...],
    phases: tuple[float, ...],
    stable: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    front = _described(monkeypatch, amplitudes, phases)
    assert front.stable is stable
    nearest = min(amplitudes, key=lambda value: abs(value - 1.0))
    others = sorted((x for x in amplitudes if x != nearest), key=lambda x: -abs(x))
    assert front.multipliers[:2].tolist() == others
    assert front.multipliers.shape == (6,)
    assert front.trivial == abs(nearest - 1.0)
    assert front.phase_multiplier == max(map(abs, phases))
    assert front.iterations == 8
    continuous = np.abs(front.multipliers) <= front.continuum
    assert np.isinf(front.multipliers_error).tolist() == continuous.tolist()
    # Both windows have the same: some roundings.
    for error in (*front.multipliers_error[~continuous], front.phase_multiplier_error):
        assert 1e-14 < error < 1e-13


@pytest.mark.parametrize(
    ("first", "last", "least"),
    [(0.9, 0.95, 0.1), (0.9, 1.2, 0.6), (0.8, 0.95, 0.3), (1.05, 0.95, 0.2)],
)
def test_errors_of_multipliers_are_from_the_first_solution(
    first: float, last: float, least: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Twice the change; of phases, at least the distance from the 1 that a rotation has."""
    front = _described(monkeypatch, (last, 1.0), (last,), earlier=first)
    assert front.multipliers[0] == last
    assert front.multipliers_error[0] == pytest.approx(2.0 * abs(last - first), rel=1e-12)
    assert front.phase_multiplier_error == pytest.approx(max(2.0 * abs(last - first), 1.0 - last))
    assert front.phase_multiplier_error == pytest.approx(least)


@pytest.mark.parametrize(("c", "eta"), [(0.12, ETA), (0.6, 0.09), (2.0, ETA)])
def test_the_rotation_of_all_phases_is_within_the_error_of_its_multiplier(
    c: float, eta: float
) -> None:
    front = front_wave(c, eta)
    assert abs(front.phase_multiplier - 1.0) <= front.phase_multiplier_error < 0.05
    assert np.isinf(front.multipliers_error).all()  # all in the continuous spectrum


def test_a_front_has_the_amplitudes_of_every_site_of_its_longer_window(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From the cycle on the left to less than rounding on the right, √a r in units of the cycle."""
    window = replace(wave.Window.started(1.0, ETA), left=12, right=12)
    window = replace(window, guess=np.append(np.linspace(1.0, 0.0, 24), 0.8))
    longer = window._resized(0.8, wave._DEPTHS[1])
    front = _described(monkeypatch, (1.0,), (1.0,))
    cycle = math.sqrt((1.0 + math.sqrt(1.0 - 8.0 * ETA)) / ETA)
    assert front.r.size == longer.left + longer.right
    assert front.crossing == longer.left
    assert front.r == pytest.approx(cycle * longer.guess[:-1], rel=1e-14)


def test_the_continuous_spectrum_is_that_of_the_slower_fading_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Ahead at a rate of 1/2; behind at that of the cycle, which is weaker near η = 1/8."""
    assert _described(monkeypatch, (1.0,), (1.0,)).continuum == math.exp(-0.5 / 0.8)
    weak = replace(wave.Window.started(1.0, 0.1), guess=np.append(np.ones(24), 0.8))
    s = (1.0 + math.sqrt(0.2)) / 0.1
    behind = 0.5 - 0.375 * s + 0.3125 * 0.1 * s**2  # d(rg)/dr on the cycle, r² = s
    assert weak.attraction == pytest.approx(behind, rel=1e-12)


@pytest.mark.parametrize(
    "last", [{"v": 0.8 + 1e-9}, {"v": 0.8 - 3e-7}, {"correction": 1e-6}, {"v": 0.8}]
)
def test_the_error_has_its_three_parts(
    last: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Distance of the two solutions, of which each may err; what Newton left; rounding."""
    front = _described(monkeypatch, (1.0,), (1.0,), **last)
    least = abs(last.get("v", 0.8) - 0.8) + last.get("correction", 0.0)
    assert front.v == last.get("v", 0.8)
    assert least + np.spacing(front.v) < front.error < 3.0 * least + 1e-13


def test_a_front_that_creeps_is_not_called_pinned() -> None:
    fold, eta = static_fold(0.08), 0.08  # at smaller η an amplitude takes shorter steps
    with pytest.raises(NoFrontError, match=r"slower than 0\.001; near c_pin = 0\.1826"):
        front_wave(fold.c * (1.0 + 1e-7), eta)
    with pytest.raises(NoFrontError, match="pinned up to"):
        front_wave(fold.c, eta)
    slow = (1.2e-3 / fold.square_root) ** 2
    assert front_wave(fold.c + slow, eta).v == pytest.approx(1.2e-3, rel=0.05)


def test_a_front_slower_than_the_slowest_is_refused() -> None:
    fold, eta = static_fold(0.08), 0.08
    slow = (0.7e-3 / fold.square_root) ** 2
    with pytest.raises(NoFrontError, match=r"slower than 0\.001"):
        front_wave(fold.c + slow, eta)


@pytest.mark.parametrize("v", [1e-4, -0.5, float("nan")])
def test_newtons_method_does_not_leave_for_what_is_no_front(v: float) -> None:
    window = wave.Window.started(1.0, ETA)
    system = window.system()
    with pytest.raises(NotConvergedError, match="no front"):
        system(np.append(window.guess[:-1], v), 1.0)
    for factor in (4.0, -4.0, float("nan")):
        with pytest.raises(NotConvergedError, match="no front"):
            system(np.append(factor * window.guess[:-1], 0.8), 1.0)


def test_the_derivatives_of_the_period_map_are_those_of_its_differences() -> None:
    window = wave.Window.started(0.6, ETA)
    system, u = window.system(), window.guess
    value, slope, by_c = system(u, 0.6)
    step = 1e-6
    ahead, behind = system(u, 0.6 + step)[0], system(u, 0.6 - step)[0]
    assert np.abs((ahead - behind) / (2.0 * step) - by_c).max() < 1e-7
    for place in (window.left - 3, window.left, window.left + 2, u.size - 1):
        change = np.zeros(u.size)
        change[place] = step
        column = (system(u + change, 0.6)[0] - system(u - change, 0.6)[0]) / (2.0 * step)
        assert np.abs(column - slope[:, place]).max() < 1e-7
    assert value[-1] == u[window.left] - window.unstable


def test_the_derivative_of_the_period_map_by_eta_is_that_of_its_differences() -> None:
    window = wave.Window.started(0.6, ETA, "eta")
    system, u = window.system(), window.guess
    by_eta = system(u, ETA)[2]
    step = 1e-7
    ahead, behind = system(u, ETA + step)[0], system(u, ETA - step)[0]
    assert np.abs(by_eta).max() > 1.0
    assert np.abs((ahead - behind) / (2.0 * step) - by_eta).max() < 1e-6
    alone = wave.Window.started(0.6, ETA).system()
    assert all(
        np.array_equal(x, y) for x, y in zip(system(u, ETA)[:2], alone(u, 0.6)[:2], strict=True)
    )
    for outside in (0.0, -0.01, 0.125, float("nan")):
        with pytest.raises(NotConvergedError, match="no front"):
            system(u, outside)


def test_it_is_the_front_of_the_running_chain() -> None:
    chain = fr.AveragedChain(a=4, b=0.5, c=0.6)
    run = fr.measure_front(chain, accuracy=1e-5)
    solved = fr.measure_front(chain, method="wave")
    assert abs(run.v - solved.v) < run.error < 1e-5
    assert solved.to_dict()["stable"] is True


@pytest.mark.parametrize("eta", [ETA, 0.1])
def test_the_branch_ends_in_the_law_of_strong_coupling(eta: float) -> None:
    law = strong_coupling_front(eta)
    branch = follow_front_wave([10.0, 80.0], eta, along="c")
    off = [abs(front.v - law.velocity(front.c)) for front in branch.fronts]
    # The next term is of order c^{-1/3}: eight times the coupling, half of it.
    assert off[-1] / off[0] == pytest.approx(2.0, rel=0.15)
    assert all(front.stable for front in branch.fronts)
    assert branch.folds == ()


@pytest.mark.parametrize("eta", [0.01, 0.11])
def test_newtons_method_begins_near_the_front_at_strong_coupling_too(eta: float) -> None:
    """There a front is ten sites wide and settles slowly; v - c is what it has to settle to."""
    law = strong_coupling_front(eta).velocity(1e3)
    assert abs(wave.Window.started(1e3, eta).guess[-1] - law) < 0.5 * abs(law - 1e3)


def test_there_is_a_front_at_the_largest_coupling_and_eta() -> None:
    front = front_wave(1e3, 0.11)
    assert front.v == pytest.approx(strong_coupling_front(0.11).velocity(1e3), abs=1e-2)
    assert front.error < 1e-10


@pytest.mark.parametrize("eta", [ETA, 0.08])
def test_fronts_rest_up_to_the_fold_and_leave_it_by_a_square_root(eta: float) -> None:
    fold = static_fold(eta)
    with pytest.raises(NoFrontError, match=r"pinned up to c_pin = 0\."):
        front_wave(0.98 * fold.c, eta)
    far, near = (
        front_wave(fold.c * (1.0 + d), eta).v / math.sqrt(d * fold.c) for d in (1e-2, 1e-3)
    )
    # The next term is of order c - c_pin, √(c - c_pin) of the first: √10 times less.
    assert (far - fold.square_root) / (near - fold.square_root) == pytest.approx(10**0.5, rel=0.15)


def test_the_state_at_the_fold_is_at_rest_and_about_to_leave() -> None:
    fold = static_fold(0.05)
    r = np.concatenate([[math.sqrt((1 + math.sqrt(1 - 8 * 0.05)) / 0.05)], fold.r, [0.0]])
    s = r[1:-1] ** 2
    rate = 0.5 * fold.c * (r[:-2] - r[2:]) - 0.5 * r[1:-1] * (1 - s / 4 + 0.05 * s**2 / 8)
    assert np.abs(rate).max() < 1e-12
    matrix = 0.5 * fold.c * (np.eye(s.size, k=-1) - np.eye(s.size, k=1))
    matrix -= np.diag(0.5 - 0.375 * s + 0.3125 * 0.05 * s**2)
    growth = np.linalg.eigvals(matrix).real
    assert abs(growth.max()) < 1e-5  # the square root of rounding, at a double zero


@pytest.mark.parametrize(
    ("c", "eta"), [(-1.0, ETA), (float("nan"), ETA), (1.0, 0.12), (1001.0, ETA)]
)
def test_what_cannot_be_answered_is_refused(c: float, eta: float) -> None:
    with pytest.raises(ParameterError):
        front_wave(c, eta)


@pytest.mark.parametrize("eta", [0.0, 9e-4, 0.111, 0.12, 0.2, float("nan")])
def test_the_fold_of_fronts_at_rest_is_refused_where_that_of_waves_is(eta: float) -> None:
    """Also where a branch asks for it alone, or for more than η."""
    with pytest.raises(ParameterError, match=r"eta = b/a\^2"):
        static_fold(eta)
    with pytest.raises(ParameterError, match=r"eta = b/a\^2"):
        follow_front_wave([eta, ETA], 0.6, "eta")


def test_the_branch_of_fronts_is_made_of_fronts() -> None:
    branch = fr.follow_front(fr.AveragedChain(a=4, b=0.5, c=0), [0.05, 0.11, 0.4])
    fast, slow, resting = branch.points
    for point in (fast, slow):
        alone = front_wave(point.chain.c, ETA)
        assert abs(point.v - alone.v) <= point.error + alone.error
    assert (resting.v, resting.status.value) == (0.0, "pinned")
    assert branch.values.tolist() == [0.4, 0.11, 0.05]
    with pytest.raises(ParameterError, match="averaged"):
        fr.follow_front(fr.VdpChain(a=4, b=0.5, c=0), [0.4])


def test_at_the_end_of_a_branch_fronts_are_pinned() -> None:
    """There v = 0: the end that a branch states can be asked for."""
    chain = fr.AveragedChain(a=4, b=0.5, c=0.15)
    for along, end in (("couplings", static_fold(ETA).c), ("etas", pinning_eta(0.15).eta)):
        (point,) = fr.follow_front(chain, **{along: [end]}).points
        assert (point.v, point.status.value) == (0.0, "pinned")


@pytest.mark.parametrize("part", [-2.0, -0.9, 0.0, 0.9, 1.1])
def test_a_front_within_the_error_of_c_pin_may_travel_as_fast_as_the_error_allows(
    part: float,
) -> None:
    """By the square-root law it is this fast if the true c_pin is the lowest that is allowed."""
    fold = static_fold(ETA)
    chain = fr.AveragedChain(a=4, b=0.5, c=fold.c + part * fold.error)
    if part > 1.0:
        for ask in (lambda: fr.measure_front(chain, method="wave"),
                    lambda: fr.follow_front(chain, [chain.c])):  # fmt: skip
            with pytest.raises(NoFrontError, match="slower than"):
                ask()
        return
    for point in (
        fr.measure_front(chain, method="wave"),
        *fr.follow_front(chain, [chain.c]).points,
    ):
        assert (point.v, point.status.value) == (0.0, "pinned")
        possible = max(0.0, chain.c - (fold.c - fold.error))
        assert point.error == pytest.approx(fold.square_root * math.sqrt(possible), rel=1e-6)


@pytest.mark.parametrize("part", [-0.9, -0.5, 0.9])
def test_within_the_error_of_eta_pin_fronts_are_pinned(part: float) -> None:
    pin = pinning_eta(0.15)
    eta = pin.eta + part * pin.error
    (point,) = fr.follow_front(fr.AveragedChain(a=4, b=0.5, c=0.15), etas=[eta]).points
    assert (point.v, point.status.value) == (0.0, "pinned")
    assert point.error <= pin.square_root * math.sqrt(3.0 * pin.error)
    assert (point.error > 0.0) == (part < 0.0)


def test_what_is_within_the_error_of_eta_pin_counts_as_pinned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pin = PinningEta(eta=0.0625, error=0.015625, square_root=1.0, square_root_error=0.0)
    monkeypatch.setattr(resting, "pinning_eta", lambda _: pin)
    chain = fr.AveragedChain(a=4, b=0.5, c=0.15)
    etas = [0.03125, 0.046875, 0.0625, 0.078125]  # the second one lower by the error
    assert branches._ends_in_eta(chain, etas)[1] == etas[1:]


def test_a_branch_is_along_the_parameter_of_which_values_are_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(branches, "_fronts", lambda *given: given)
    chain = fr.AveragedChain(a=4, b=0.5, c=0.15)
    given: Any = fr.follow_front(chain, [0.1, 0.3]), fr.follow_front(chain, etas=[0.02, 0.05])
    for (of, along, values), expected in zip(
        given, (("c", [0.1, 0.3]), ("eta", [0.02, 0.05])), strict=True
    ):
        assert (of, along, list(values)) == (chain, *expected)


def test_what_is_within_the_error_of_c_pin_counts_as_pinned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rest = SimpleNamespace(c=0.125, error=0.03125, square_root=1.0, square_root_error=0.0)
    monkeypatch.setattr(resting, "static_fold", lambda _: rest)
    couplings = [0.0625, 0.125, 0.15625, 0.1875]  # the third one higher by the error
    chain = fr.AveragedChain(a=4, b=0.5, c=0.0)
    assert branches._ends_in_c(chain, couplings)[1] == couplings[:3]


@pytest.mark.parametrize(("c", "all_rest"), [(0.05, True), (0.2, False)])
def test_where_no_eta_pins_the_first_fold_tells_whether_all_fronts_rest(
    c: float, all_rest: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(resting, "pinning_eta", lambda _: None)
    monkeypatch.setattr(resting, "static_fold", lambda _: SimpleNamespace(c=0.1))
    chain, etas = fr.AveragedChain(a=4, b=0.5, c=c), [0.03125, 0.0625]
    assert branches._ends_in_eta(chain, etas) == ({}, etas if all_rest else [])


def test_branches_of_breathers_are_of_the_models_of_the_paper() -> None:
    own = fr.OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.05, sites=7)
    for chain in (fr.FrictionChain(c=0.1), own):
        with pytest.raises(ParameterError, match="other models cannot be followed"):
            fr.follow_breather(chain, [0.1])


def test_the_branch_in_eta_is_made_of_the_fronts_of_each_eta() -> None:
    """Each beside differences along the wave, which share no code with it."""
    chain = fr.AveragedChain(a=4, b=1, c=0.6)
    branch = fr.follow_front(chain, etas=[0.1, 0.01, ETA])
    assert branch.along == "eta"
    assert branch.values.tolist() == [0.1, ETA, 0.01]
    assert branch.folds == ()
    assert branch.eta_pin is None  # c is above c_pin at every eta
    for eta, point in zip(branch.values, branch.points, strict=True):
        assert point.chain.b == pytest.approx(16.0 * eta, rel=1e-15)
        coarse, fine = by_differences(0.6, float(eta))
        assert abs(point.v - fine) <= point.error + abs(fine - coarse) + 1e-13
        assert point.error < 1e-10
        alone = front_wave(0.6, float(eta))
        assert abs(point.v - alone.v) <= point.error + alone.error
        assert point.detail.stable is alone.stable is True
        assert point.detail.eta == eta
        nearest = np.abs(point.detail.multipliers[0] - alone.multipliers[0])
        assert nearest < 1e-6


@pytest.mark.parametrize("c", [0.15, 0.18])
def test_fronts_travel_up_to_an_eta_and_slow_down_by_a_square_root(c: float) -> None:
    pin = pinning_eta(c)
    assert pin is not None
    below, above = (static_fold(pin.eta + d * (pin.error + 1e-13)).c for d in (-2.0, 2.0))
    assert below < c < above
    far, near = (
        front_wave(c, pin.eta * (1.0 - d)).v / math.sqrt(d * pin.eta) for d in (1e-2, 1e-3)
    )
    # The next term is of order η_pin - η, √(η_pin - η) of the first: √10 times less.
    assert (far - pin.square_root) / (near - pin.square_root) == pytest.approx(10**0.5, rel=0.15)


def test_c_pin_rises_with_eta_at_the_rate_of_its_differences() -> None:
    step = 1e-5
    ahead, behind = static_fold(0.05 + step), static_fold(0.05 - step)
    difference = (ahead.c - behind.c) / (2.0 * step)
    assert static_fold(0.05).slope == pytest.approx(difference, rel=1e-7)


@pytest.mark.parametrize(("c", "travels"), [(0.01, False), (0.3, True)])
def test_beyond_the_range_of_eta_all_fronts_rest_or_all_travel(c: float, travels: bool) -> None:
    assert pinning_eta(c) is None
    chain = fr.AveragedChain(a=1, b=0.02, c=c)
    assert [point.v > 0.0 for point in fr.follow_front(chain, etas=[0.1]).points] == [travels]
    branch = fr.follow_front(chain, etas=[0.01, 0.1])
    assert [point.v > 0.0 for point in branch.points] == [travels] * 2
    assert branch.values.tolist() == [0.1, 0.01]
    assert "eta_pin" not in branch.to_dict()


def test_a_fold_of_the_branch_has_both_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    """No branch of fronts that was tried has one; a made-up fold stands before its front."""
    found = follow_front_wave([0.02], 0.15, "eta")
    fold = fold_of(0.05, 1e-12, np.array([0.5, 0.25, 0.125]))
    folded = replace(found, folds=((fold, 0),))
    monkeypatch.setattr(follow, "follow_front_wave", lambda *_: folded)
    chain = fr.AveragedChain(a=2, b=1, c=0.15)
    branch = fr.follow_front(chain, etas=[0.02, 0.07, 0.08])
    assert branch.values.tolist() == [0.08, 0.07, 0.02]
    (turn,) = branch.folds
    assert (turn.c, turn.eta, turn.error) == (0.15, 0.05, 1e-12)
    assert (turn.points_before, turn.height) == (2, 0.125)
    branch.plot()


def test_one_parameter_is_followed() -> None:
    chain = fr.AveragedChain(a=4, b=0.5, c=0.6)
    with pytest.raises(ParameterError, match="absent when etas are given"):
        fr.follow_front(chain, [0.4], etas=[0.02])
    for etas, said in (([], "sequence"), ([0.02, 0.12], "0.11"), ([5e-4, 0.02], "0.001")):
        with pytest.raises(ParameterError, match=said):
            fr.follow_front(chain, etas=etas)


def test_a_breather_is_followed_through_its_fold() -> None:
    """Both sheets solve (43) as another module writes it, and meet in the fold of the threshold."""
    a, b = 2.5, 0.5
    chain = fr.AveragedChain(a=a, b=b, c=0, sites=19)
    branch = fr.follow_breather(chain, [0.1, 0.18, 0.3], method="envelope")
    *sheets, beyond = branch.points
    assert branch.values.tolist() == [0.1, 0.18, 0.18, 0.1, 0.3]
    assert [point.stable for point in sheets] == [True, True, False, False]
    assert beyond.status.value == "none"
    for point in sheets:
        detuning = (point.frequency - 1.0) / chain.eps
        u = np.concatenate([point.waves.real, point.waves.imag, [detuning]])
        off = phase_locked.residual(u, point.chain.c, a, b)
        assert np.abs(off).max() < 1e-10
        growth = phase_locked.growth_rate(u, point.chain.c, a, b)
        assert point.growth == pytest.approx(growth, abs=1e-9)
    (fold,) = branch.folds
    other = fr.threshold(fr.AveragedChain(a=a, b=b, c=0), method="envelope")
    assert abs(fold.c - other.c_crit) <= fold.error + other.error
    assert {(point.fold, point.fold_error) for point in branch.points} == {(fold.c, fold.error)}
    assert sheets[1].outward[0] > fold.height > sheets[2].outward[0]


@pytest.mark.parametrize("coupling", [1e-3, 2e-4])
def test_a_breather_is_followed_back_to_small_couplings(coupling: float) -> None:
    """On a ring of four the other sheet ends, as c → 0, with the site opposite on its inner cycle.

    There the equations determine the phases to the order of c² only, and the last step of the
    branch passes c = 0, so that solutions between its ends are not found at the first attempt.
    """
    a, eta = 2.5, 0.095
    b = eta * a * a
    chain = fr.AveragedChain(a=a, b=b, c=0, sites=4, ends="periodic")
    first, other = fr.follow_breather(chain, [coupling]).points
    for point in (first, other):
        phi = point.waves
        pull = 2.0 * phi - np.roll(phi, 1) - np.roll(phi, -1)
        square = np.abs(phi) ** 2
        rate = 0.5j * coupling * pull - 0.5 * phi * (1.0 - a * square / 4 + b * square**2 / 8)
        omega = (point.frequency - 1.0) / chain.eps
        assert np.abs(rate - 1j * omega * phi).max() < 1e-10
    inner, outer = (
        math.sqrt((1.0 + sign * math.sqrt(1.0 - 8.0 * eta)) / (a * eta)) for sign in (-1, 1)
    )
    # Neighbours at rest have amplitudes of about c times those of the cycles.
    beside = 4.0 * coupling * outer
    for point, opposite in ((first, 0.0), (other, inner)):
        assert np.abs(np.sort(point.amplitudes) - np.sort([0, 0, opposite, outer])).max() < beside


def test_the_orbit_beyond_the_fold_is_near_that_of_the_averaged_chain() -> None:
    chain = fr.VdpChain(a=2.5, b=0.5, c=0, sites=9)
    branch = fr.follow_breather(chain, [0.18])
    averaged = fr.follow_breather(chain.averaged(), [0.18])
    assert [point.stable for point in branch.points] == [True, False]
    for orbit, near in zip(branch.points, averaged.points, strict=True):
        # Averaging errs by ε max|damping| = 0.16 of the cycle; the sheets are apart by 0.3 beside.
        assert np.abs(orbit.outward[:2] - near.outward[:2]).max() < 0.02
        assert orbit.growth == pytest.approx(near.growth, rel=0.1)
    assert abs(branch.points[0].outward[1] - branch.points[1].outward[1]) > 0.1


def test_an_averaged_chain_has_no_orbits_to_follow() -> None:
    chain = fr.AveragedChain(a=2.5, b=0.5, c=0, sites=9)
    with pytest.raises(fr.ParameterError, match="envelope for the averaged chain"):
        fr.follow_breather(chain, [0.18], method="orbit")


def test_the_shell_follows_branches(
    capsys: pytest.CaptureFixture[str], tmp_path: Any, answered: Any
) -> None:
    words = ["front", "averaged", "--c", "0.05:0.5:4", "--eta", "0.03125", "--method", "wave"]
    found = answered([*words, "--out", str(tmp_path / "branch.png")])
    assert [point["status"] for point in found["points"]] == ["steady"] * 3 + ["pinned"]
    assert found["c_pin"] == static_fold(ETA).c
    assert main(["breather", "averaged", "--c", "0.1:0.3:3"]) == 0
    _, _, folds = capsys.readouterr().out.partition("folds:\n")
    head, fold = map(str.split, folds.splitlines()[:2])
    assert fold[head.index("c")].startswith("0.1907")
    assert (tmp_path / "branch.png").exists()
    words = ["front", "averaged", "--c", "0.15", "--eta", "0.02:0.08:3", "--method", "wave"]
    found = answered([*words, "--out", str(tmp_path / "eta.png")])
    assert [point["eta"] for point in found["points"]] == [0.08, 0.05, 0.02]
    assert [point["status"] for point in found["points"]] == ["pinned", "steady", "steady"]
    assert found["points"][1]["chain"]["b"] == 0.05
    assert found["eta_pin"] == pinning_eta(0.15).eta
    single = "front averaged --c 0.6 --eta 0.03125 --method wave"
    assert main(f"{single} --tolerance 1e-9".split()) == 2


@pytest.mark.parametrize("along", ["c", "eta"])
def test_a_search_that_ends_names_the_parameter_that_was_followed(along, monkeypatch) -> None:
    """Of breathers the sentence speaks of a coupling and asks for a smaller one."""

    def ends(system, guess, value):
        raise NotConvergedError(
            f"no solution was found at c = {value}: take a smaller coupling.", value
        )

    monkeypatch.setattr("verification.fronts.follow.solve_at", ends)
    other, values = (0.03125, [0.6]) if along == "c" else (0.6, [0.03125])
    with pytest.raises(NoFrontError, match=rf"{along} = {values[0]}: take a value farther"):
        follow_front_wave(values, other, along)


@pytest.mark.parametrize("v", [1e-3, 0.8, 50.0])
def test_rounding_is_a_part_of_the_velocity(v: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two solutions that agree to the last bit, and nothing left by Newton's method."""
    window = replace(wave.Window.started(1.0, ETA), left=12, right=12)
    window = replace(window, guess=np.append(np.linspace(1.0, 0.0, 24), v))
    point = BranchPoint(window.guess, 1.0, np.ones(26), 0.0, 0.0, 5, 1.0)
    monkeypatch.setattr(
        wave, "solve_at",
        lambda _, guess, c: BranchPoint(guess, c, np.ones(guess.size + 1), 0.0, 0.0, 3, 1.0),
    )  # fmt: skip
    monkeypatch.setattr(
        wave, "with_disturbances", lambda rho, *_: (rho, rho, np.eye(rho.size, k=-1))
    )
    error = window.described(point, 0.0).error
    assert np.finfo(float).eps * v < error < 1e-13 * v


@pytest.mark.parametrize("eta", [0.125, 0.13, 2.0])
def test_where_there_is_no_front_none_is_advised_to_be_measured(
    eta: float, capsys: pytest.CaptureFixture[str]
) -> None:
    """Above 0.11, up to 1/8, a running chain has one; from 1/8 on the cell has no two cycles."""
    calls = (partial(front_wave, 0.3), static_fold, strong_coupling_front,
             lambda eta: follow_front_wave([eta], 0.3, "eta"))  # fmt: skip
    for solve in calls:
        with pytest.raises(ParameterError) as refused:
            solve(eta)
        assert f"eta = b/a^2 = {eta} is not allowed" in str(refused.value)
        assert "to 0.11; take a smaller eta: from 1/8 on" in str(refused.value)
        with pytest.raises(ParameterError, match=r"to 0\.11; measure the front on a running chain"):
            solve(0.12499)
        with pytest.raises(ParameterError, match="is not allowed"):
            solve(math.nan)
    assert main(["front", "averaged", "--method", "wave", "--c", "0.3", "--eta", str(eta)]) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1
    assert "there is no front" in shown


@pytest.mark.parametrize("along", ["c", "eta"])
def test_the_rate_of_the_amplitudes_depends_on_a_parameter_as_its_differences_do(
    along: str,
) -> None:
    """To the last site, which also has rest to its right; so do the amplitudes after a time."""
    rho, step = np.random.default_rng(2).uniform(0.1, 1.0, 9), 1e-6
    at = {"c": 0.6, "eta": 0.05}

    def chain(shift: float) -> Amplitudes:
        given = at | {along: at[along] + shift}
        eta = given["eta"]
        return Amplitudes(**given, square=(1.0 + math.sqrt(1.0 - 8.0 * eta)) / eta)

    apart = (rate(rho, chain(step)) - rate(rho, chain(-step))) / (2.0 * step)
    found = rate_by(rho, chain(0.0), along)  # type: ignore[arg-type]
    assert found == pytest.approx(apart, rel=1e-6, abs=1e-8)

    def end(shift: float) -> Any:
        run = solve_ivp(
            lambda _, y: rate(y, chain(shift)), (0, 0.4), rho, "DOP853", rtol=1e-12, atol=1e-13
        )
        return run.y[:, -1]

    apart = (end(step) - end(-step)) / (2.0 * step)
    found = with_disturbances(rho, chain(0.0), 0.4, 20, along=along)[1]  # type: ignore[arg-type]
    assert found == pytest.approx(apart, rel=1e-6, abs=1e-7)
