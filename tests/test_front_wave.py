"""Fronts of (43) as solutions: against scipy on the complex chain, running chains and limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from theory.averaged.front import strong_coupling_front
from theory.parameters import ParameterError
from verification.fronts import wave
from verification.fronts.wave import NoFrontError, follow_front, front_wave, static_fold

ETA = 0.03125


@pytest.mark.parametrize(("c", "eta"), [(0.3, ETA), (1.0, ETA), (2.0, 0.06)])
def test_the_complex_chain_carries_the_front_one_site_further(c: float, eta: float) -> None:
    """φ_{n+1}(1/v) = -i e^{ic/v} φ_n(0), by scipy on (43) written out here."""
    front = front_wave(c, eta)
    n = np.arange(front.r.size)
    start = (-1j) ** n * front.r

    def rate(_: float, phi: Any) -> Any:
        s = np.abs(phi) ** 2
        spring = 2 * phi - np.roll(phi, 1) - np.roll(phi, -1)
        return 0.5j * c * spring - 0.5 * phi * (1 - s / 4 + eta * s**2 / 8)

    period = 1.0 / front.v
    end = solve_ivp(rate, (0, period), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    inner = slice(12, front.r.size - 12)  # a period carries what the ends do a few sites inwards
    expected = -1j * np.exp(1j * c * period) * start
    off = np.abs(end[1:][inner] - expected[:-1][inner]).max()
    assert off < 1e-9 * front.r.max()  # of scipy, at rates up to 1/2η over a period


@pytest.mark.parametrize(("c", "eta"), [(0.3, ETA), (0.6, ETA), (2.0, ETA), (10.0, 0.06)])
def test_the_stated_error_bounds_the_true_one(
    c: float, eta: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    front = front_wave(c, eta)
    monkeypatch.setattr(wave, "_STEP", 0.3)
    monkeypatch.setattr(wave, "_FEWEST", 40)
    monkeypatch.setattr(wave, "_WIDER", 14)
    better = front_wave(c, eta, front)
    assert abs(front.v - better.v) <= front.error + better.error
    assert front.error < 1e-10


def test_it_is_the_front_of_the_running_chain() -> None:
    from theory.chains.vdp import VdpChain
    from verification.fronts.measure import measure_front

    found = measure_front(VdpChain(a=4, b=0.5, c=0.6).averaged(), accuracy=1e-5)
    assert found.v is not None
    assert found.error is not None
    assert abs(found.v - front_wave(0.6, ETA).v) < found.error < 1e-5


def test_the_branch_ends_in_the_law_of_strong_coupling() -> None:
    law = strong_coupling_front(ETA)
    fronts = list(follow_front(np.geomspace(10.0, 160.0, 9).tolist(), ETA))
    off = [abs(front.v - law.velocity(front.c)) for front in fronts]
    # The next term is of order c^{-1/3}: sixteen times the coupling, 2.5 times less.
    assert off[0] / off[-1] == pytest.approx(16.0 ** (1.0 / 3.0), rel=0.15)
    assert all(front.stable for front in fronts)


def test_the_matrix_is_that_of_small_disturbances() -> None:
    """Its column by differences; and the disturbance dr/dt belongs to the multiplier one."""
    cell = wave._Cell.at(ETA)
    window = wave._Window.at(cell, 0.6)
    settled = window.solved(*window.relaxed())
    solution = window.solved(settled.r, settled.period)  # the matrix of the solution itself
    step = 1e-6
    for site in (window.left - 1, window.left, window.left + 3):
        ends = []
        for sign in (1.0, -1.0):
            r = solution.r.copy()
            r[site] += sign * step
            ends.append(window._moved_on(window.advanced(r[:, None], solution.period))[:, 0])
        column = (ends[0] - ends[1]) / (2.0 * step)
        assert np.abs(column - solution.shifted[:, site]).max() < 1e-7  # differences of size step²
    assert front_wave(0.6, ETA).trivial_defect < 1e-9


def test_fronts_rest_up_to_the_fold_and_move_from_there() -> None:
    fold = static_fold(ETA)
    with pytest.raises(NoFrontError, match="take a larger coupling"):
        front_wave(0.98 * fold.c, ETA)
    # v² is smooth in c and zero at the fold: a parabola through three points leads back to it.
    c = np.array([1.1, 1.2, 1.3]) * fold.c
    parabola = np.polyfit(c, [front_wave(each, ETA).v ** 2 for each in c.tolist()], 2)
    nearest = min(np.roots(parabola).real, key=lambda root: abs(root - fold.c))
    # The neglected third power shifts the root by some 0.1 · 0.2 · 0.3 of c_pin.
    assert nearest == pytest.approx(fold.c, rel=1e-2)


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


@pytest.mark.parametrize(("c", "eta"), [(-1.0, ETA), (float("nan"), ETA), (1.0, 0.12), (1e4, ETA)])
def test_what_cannot_be_answered_is_refused(c: float, eta: float) -> None:
    with pytest.raises(ParameterError):
        front_wave(c, eta)
