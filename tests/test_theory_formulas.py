"""Formulas against definitions they were not coded from; each was once changed and not noticed."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from theory.averaged.breather import (
    BreatherStatus,
    Reading,
    closed_form_fold,
    decay_of_centre,
    solve_breather,
    tail_residual,
)
from theory.cells.vdp import eta_from_ratio, threshold_ratio
from theory.chains.vdp import VdpChain, effective_epsilon
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.first_points import MAX_POINTS
from theory.piecewise.folds import fold_coupling, fold_eta
from theory.piecewise.kinetic_relation import Regime, kinetic_relation, trace_kinetic_relation
from theory.piecewise.limits import resonant_velocities, static_sum, static_sum_distance
from theory.piecewise.profile import front_profile, tail_bound
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.integral import sums
from theory.piecewise.sums.result import PrecisionError
from verification.references.equations import damping


@pytest.mark.parametrize("v", [0.05, 0.3, 1.0, 20.0])
def test_the_bound_of_slow_fronts_is_its_geometric_series(v: float) -> None:
    # |sinh a/(cosh a - cos k) - 1| ≤ 2 Σ e^{-n/2v}, reached at k = 0 and real a
    n = np.arange(1, math.ceil(80 * v) + 50)
    assert static_sum_distance(v, 1.0) == pytest.approx(2 * math.fsum(np.exp(-0.5 * n / v)), 1e-12)


@pytest.mark.parametrize("c", [1e-12, 1e-6, 0.1, 3.0, 1e9])
def test_the_static_sum_keeps_its_digits_at_small_couplings(c: float) -> None:
    with mp.workdps(50):
        exact = -1 + 1 / mp.sqrt(1 - 4j * mp.mpf(c))
        assert abs(static_sum(c) - exact) < 1e-15 * abs(exact)


def test_resonant_velocities_are_the_maxima_of_the_phase_velocity() -> None:
    velocities, widths = resonant_velocities(7.0, np.arange(4))
    q = np.linspace(1e-3, 2 * np.pi, 2_000_001)
    for j, (v, width) in enumerate(zip(velocities, widths, strict=True)):
        phase_velocity = 7.0 * (1 - np.cos(q)) / (q + 2 * np.pi * j)
        top = int(np.argmax(phase_velocity))
        assert v == pytest.approx(float(phase_velocity[top]), rel=1e-10)
        assert width == pytest.approx(0.5 / (q[top] + 2 * np.pi * j), rel=1e-5)


@pytest.mark.parametrize(("v", "c"), [(1e-8, 1e8), (1e8, 1e-8), (0.3, 0.5), (1e-8, 1e-8)])
def test_the_root_free_strip_solves_its_equation_everywhere(v: float, c: float) -> None:
    with mp.workdps(40):
        s = mp.mpf(root_free_strip(v, c))
        off = c * mp.sinh(s) + v * s - mp.mpf(0.5)
        assert -1e-12 < off / (s * (c * mp.cosh(s) + v)) <= 0


@pytest.mark.parametrize("eta", [0.09, 0.1, 0.12, 0.1249, 0.125 * (1 - 1e-6), 1e-3, 1e-8])
def test_the_fold_of_the_closed_form_is_a_maximum_on_both_sheets(eta: float) -> None:
    """Above η = 0.09 the ratio w of squares turns before c does, and w names two points."""
    fold = closed_form_fold(VdpChain(a=1, b=eta, c=0.1))
    gap = 1 - 8 * eta
    w = np.geomspace(1e-3 * min(gap, eta**2), 0.999, 400_001)
    first, second = eta * (2 * w**3 + 1 - w), -(4 * w**2 + 2 * (1 - w))
    inside = second**2 - 4 * first * (8 + 8 * w)
    end = int(np.argmax(inside < 0)) if np.any(inside < 0) else w.size
    w, first, second, root = (x[:end] for x in (w, first, second, np.sqrt(np.abs(inside))))
    S = np.concatenate([(-second + root) / (2 * first), ((-second - root) / (2 * first))[::-1]])
    s = S * np.concatenate([w, w[::-1]])
    c = np.sqrt(s * S) * (1 - s / 4 + eta * s**2 / 8) / (S - s)
    top = int(np.argmax(np.diff(c) < 0))
    # the scan is as fine as 1e-4 in ln w, and c is flat there; where w itself turns it goes as √
    assert fold.c == pytest.approx(float(c[top]), rel=2e-5)
    assert fold.error < 1e-13


@pytest.mark.parametrize("reading", [Reading.NEIGHBOUR, Reading.TAIL])
@pytest.mark.parametrize("eta", [1e-6, 0.01, 0.08, 0.1, 0.1249])
@pytest.mark.parametrize("part", [1e-6, 0.1, 0.9, 0.999])
def test_the_breather_solves_both_equations_to_many_digits(
    reading: Reading, eta: float, part: float
) -> None:
    top = closed_form_fold(VdpChain(a=3, b=9 * eta, c=0.1), reading).c
    chain = VdpChain(a=3, b=9 * eta, c=part * top)
    found = solve_breather(chain, reading)
    assert found.alpha_0 is not None
    assert found.decay is not None
    with mp.workdps(50):
        a, b, c = mp.mpf(chain.a), mp.mpf(chain.b), mp.mpf(chain.c)

        def both(alpha: mp.mpf, z: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
            near = alpha * z if reading is Reading.NEIGHBOUR else 0
            centre = -8 + 2 * a * alpha**2 - b * alpha**4
            balance = mp.mpf(1) / 2 - a * near**2 / 8 + b * near**4 / 16
            return centre / (16 * c * z) - 1, balance / (c / 2 * (1 / z - z)) - 1

        exact = mp.findroot(both, (found.alpha_0, found.decay), tol=1e-35)
        off = max(abs(found.alpha_0 / exact[0] - 1), abs(found.decay / exact[1] - 1))
        assert off <= found.error
    # rounding, made larger by the square root with which the branch turns at the fold
    assert found.error < 3e-14 / math.sqrt(1 - part) * (1 + 1 / math.sqrt(1 - 8 * eta))


@pytest.mark.parametrize("eta", [1e-4, 0.01, 0.08, 0.1, 0.12])
def test_the_fold_is_where_the_two_equations_touch_and_its_error_holds(eta: float) -> None:
    """At the fold the Jacobian of (29) and (37) by α and z is singular: three equations."""
    chain = VdpChain(a=3, b=9 * eta, c=0.1)
    fold = closed_form_fold(chain)
    assert fold.c is not None
    at_fold = solve_breather(replace(chain, c=fold.c))
    assert at_fold.alpha_0 is not None
    assert at_fold.decay is not None
    with mp.workdps(50):
        a, b = mp.mpf(chain.a), mp.mpf(chain.b)

        def first(x: mp.mpf, z: mp.mpf, c: mp.mpf) -> mp.mpf:
            return (-8 + 2 * a * x**2 - b * x**4) / 16 - c * z

        def second(x: mp.mpf, z: mp.mpf, c: mp.mpf) -> mp.mpf:
            s = (x * z) ** 2
            return z * (mp.mpf(1) / 2 - a * s / 8 + b * s**2 / 16) - c / 2 * (1 - z * z)

        def touching(x: mp.mpf, z: mp.mpf, c: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
            rows = [
                [mp.diff(f, (x, z, c), n) for n in ((1, 0, 0), (0, 1, 0))] for f in (first, second)
            ]
            det = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
            return first(x, z, c), second(x, z, c), det

        start = (at_fold.alpha_0, at_fold.decay, fold.c)
        x, z, c = mp.findroot(touching, start, tol=1e-35)
        assert abs(c - fold.c) <= fold.error
        assert abs(at_fold.alpha_0 / x - 1) <= at_fold.error
        assert abs(at_fold.decay / z - 1) <= at_fold.error
    # c is stationary there: what is 1e-14 of c is 1e-7 of the amplitudes
    assert fold.error < 2e-14 * fold.c
    assert 1e-9 < at_fold.error < 1e-4


def test_beyond_its_fold_there_is_no_breather() -> None:
    for reading in (Reading.NEIGHBOUR, Reading.TAIL):
        fold = closed_form_fold(VdpChain(a=1, b=0.1, c=0.1), reading)
        assert 0 < fold.error < 1e-13
        at = [VdpChain(a=1, b=0.1, c=fold.c * (1 + side * 1e-9)) for side in (-1, 1)]
        states = [solve_breather(chain, reading).status for chain in at]
        assert states == [BreatherStatus.EXISTS, BreatherStatus.NONE]


def test_far_out_the_phase_of_the_profile_is_not_rounded() -> None:
    """At ζ = ±10⁴ rounding of the product k m was once fifty times the stated error."""
    v, c = 3.6468747920478104e-05, 0.0026075861037203017
    for zeta in (-6567.0716870, 6567.0716870):
        found = front_profile([zeta], v, c, 1e-13)
        limit = 1.0 if zeta < 0 else 0.0  # every root is e^{-100} away there
        assert abs(found.phi[0] - limit) <= found.error


@pytest.mark.parametrize("zeta", [-0.9502750961962, -2.25, 0.4])
def test_a_fast_front_is_its_series_to_the_stated_error(zeta: float) -> None:
    """At large v the pole at k = 0 and that at k = 2π nearly cancel; once seen off by 5e-12."""
    v, c = 1070.0994714053202, 0.21004104088980302
    found = front_profile([zeta], v, c, 1e-13)
    k = labelled_roots(v, c, np.arange(-20_000, 20_001), zeta > 0).k
    terms = np.exp(1j * zeta * k) / (-1j * k * (v + c * np.sin(k)))
    total = complex(np.sum(terms[::-1]))
    series = -0.5 * total if zeta > 0 else 1 + 0.5 * total
    # the series is cut off at 1e-16, and rounds like its largest term, 2
    assert abs(found.phi[0] - series) <= found.error + 1e-15


def test_velocities_that_need_too_many_points_are_refused_at_once() -> None:
    """Beside η = 2/25 at c = 1e8 the search once filled the memory."""
    assert kinetic_relation(1e8, 0.0799999).status is Regime.PINNED
    c = 1e10  # beyond the couplings that are answered
    with pytest.raises(PrecisionError, match="need more than") as caught:
        all_velocities(np.array([c]), np.array([(1.0 - 1e-6) * abs(static_sum(c))]))
    assert str(MAX_POINTS) in str(caught.value)


def test_terms_and_seconds_are_shares_of_the_whole() -> None:
    one = kinetic_relation(0.5, 0.03125)
    begin = time.perf_counter()
    many = trace_kinetic_relation(np.full(50, 0.5), 0.03125)
    whole = time.perf_counter() - begin
    assert many[0].terms == pytest.approx(one.terms, abs=2)
    assert 0 < sum(answer.seconds for answer in many) <= whole


def test_beside_the_fold_without_a_moving_branch_the_front_is_pinned() -> None:
    eta = 0.03125
    fold = fold_coupling(eta)
    assert fold is not None
    below, above = (kinetic_relation(fold.value * (1 + side * 1e-6), eta) for side in (-1, 1))
    assert (below.status, above.status) == (Regime.PINNED, Regime.PROPAGATING)


@pytest.mark.parametrize("eta", [0.001, 0.03125, 0.04])
def test_the_fold_is_given_both_ways_with_one_velocity_and_honest_errors(eta: float) -> None:
    by_eta = fold_coupling(eta)
    back = fold_eta(by_eta.value)
    slope = (fold_eta(by_eta.value * (1 + 1e-6)).value - eta) / (1e-6 * by_eta.value)
    assert abs(back.value - eta) <= back.error + abs(slope) * by_eta.error
    # the maximum is flat: its place is known to some 1e-7
    assert back.velocity == pytest.approx(by_eta.velocity, rel=1e-5)
    # its error is that of the height |Σ| = 2r through dη/d(2r), twice over, and rounding
    r, h = threshold_ratio(eta), 1e-6
    by_r = (eta_from_ratio(r + h) - eta_from_ratio(r - h)) / (2 * h)
    height = float(sums(back.velocity, by_eta.value, 1e-14).error)
    assert back.error - 1e-16 == pytest.approx(by_r * height, rel=0.01)


@pytest.mark.parametrize("reading", [Reading.NEIGHBOUR, Reading.TAIL])
def test_the_residuals_of_the_breather_are_those_of_29_and_37(reading: Reading) -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.13)
    found = solve_breather(chain, reading)
    assert found.residual < 1e-14
    alpha, z, c = 1.01 * found.alpha_0, 1.02 * found.decay, 0.13
    assert decay_of_centre(alpha, chain) == pytest.approx(
        (-0.5 * alpha**4 + 5 * alpha**2 - 8) / (16 * c), rel=1e-13
    )
    s = (alpha * z) ** 2 if reading is Reading.NEIGHBOUR else 0.0
    site = 1.0 if reading is Reading.NEIGHBOUR else math.inf
    expected = 0.5 - 2.5 * s / 8 + 0.5 * s**2 / 16 - c / 2 * (1 / z - z)
    assert tail_residual(alpha, z, site, chain) == pytest.approx(expected, rel=1e-12)
    assert tail_residual(alpha, z, 2.0, chain) == pytest.approx(
        0.5 - 2.5 * (alpha * z * z) ** 2 / 8 + 0.5 * (alpha * z * z) ** 4 / 16 - c / 2 * (1 / z - z)
    )


def test_from_the_last_fold_on_the_fold_is_at_pinning() -> None:
    found = fold_eta(5.0)
    assert found.velocity == 0.0
    r = 0.5 * abs(static_sum(5.0))
    assert found.value == pytest.approx(r**2 / (2 * (1 + r**2) ** 2), rel=1e-14)


@pytest.mark.parametrize("eta", [1e-3, 0.03125, 0.1, 0.124])
def test_the_two_amplitudes_are_the_roots_of_the_averaged_damping(eta: float) -> None:
    chain = VdpChain(a=3, b=9 * eta, c=0.1)
    low, high = sorted(np.roots([chain.b / 8, -chain.a / 4, 1.0]).real)
    assert chain.unstable_amplitude**2 == pytest.approx(low, rel=1e-9)
    assert chain.stable_amplitude**2 == pytest.approx(high, rel=1e-9)


@pytest.mark.parametrize("eta", [1e-3, 0.03125, 0.1, 0.124])
def test_the_effective_epsilon_is_the_largest_damping_over_the_cycle(eta: float) -> None:
    chain = VdpChain(a=3, b=9 * eta, c=0.1, eps=0.02)
    y = np.linspace(0.0, chain.stable_amplitude, 200_001)
    largest = np.abs(damping(y, chain.a, chain.b)).max()
    assert effective_epsilon(chain) == pytest.approx(0.02 * largest, rel=1e-8)


@pytest.mark.parametrize("ahead", [True, False])
def test_tails_of_many_fronts_are_those_of_each_and_no_root_is_before_them(ahead: bool) -> None:
    v, c = (
        x.ravel() for x in np.meshgrid(np.geomspace(1e-9, 1e9, 37), np.geomspace(1e-8, 1e8, 33))
    )
    rates, sizes = tail_bound(v, c, ahead)
    for i in range(0, v.size, 7):
        rate, size = tail_bound(float(v[i]), float(c[i]), ahead)
        # where v is nearly c both are steep functions of their difference, down to its rounding
        assert (rates[i], sizes[i]) == pytest.approx((rate, size), rel=1e-8)
    # Re L on Im k = rate is at least this, and falls from 1/2 as Im k grows
    side = 1.0 if ahead else -1.0
    assert np.all(0.5 + side * v * rates - c * np.sinh(rates) > 0.05)


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1e-3, 0.5), (1e3, 0.2), (7.4, 100.0)])
def test_the_tail_bound_has_its_rate_from_the_strip_and_is_not_wasteful(v: float, c: float) -> None:
    for ahead in (True, False):
        rate, size = tail_bound(v, c, ahead=ahead)
        s = rate / 0.85
        side = -1 if ahead else 1
        assert c * math.sinh(s) + side * v * s == pytest.approx(0.5, rel=1e-6)
        x = np.concatenate(
            [-np.geomspace(1e-9, 1e9, 400_001)[::-1], np.geomspace(1e-9, 1e9, 400_001)]
        )
        k = x + 1j * rate * (1 if ahead else -1)
        integrand = 1 / np.abs(k * (0.5 - 1j * c * (1 - np.cos(k)) - 1j * v * k))
        true = float(np.trapezoid(integrand, x)) / (4 * math.pi)
        assert true < size < 60 * true
