"""Where each evaluation of the sum begins and ends, and the errors that it adds up."""

import cmath
import dataclasses
import math

import mpmath as mp
import numpy as np
import pytest
import scipy.integrate
from scipy.special import jv

from theory.piecewise.precise_roots import exact
from theory.piecewise.roots import RootSet, labelled_roots
from theory.piecewise.sums import bessel as sum_bessel
from theory.piecewise.sums import precise as sum_integral_precise
from theory.piecewise.sums import series as sum_series
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.result import PrecisionError
from theory.piecewise.sums.series import RootSeries, sum_by_roots

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("tolerance", [1e-14, 1e-8])
@pytest.mark.parametrize("v", [0.05, 0.7])
def test_sites_that_are_left_out_are_within_the_error(v: float, tolerance: float) -> None:
    # For c well below v the Bessel functions die off within the first few sites.
    for c in v * np.geomspace(1e-9, 0.3, 18):
        found, exact_ = sum_by_bessel(v, float(c), tolerance), sum_by_integral(v, float(c), 1e-15)
        assert abs(found.value - exact_.value) <= found.error + 2e-15


def test_the_size_of_the_bessel_series_is_the_integral_of_its_modulus() -> None:
    v, c, panels = 0.8, 1.3, 4

    def modulus(s: float, j: int) -> float:
        m = np.arange(j + 1, 60)
        return math.exp(-s / 2) * abs(np.sum((-1j) ** m * jv(m, c * s)))

    size = sum(
        scipy.integrate.quad(modulus, j / v, (j + 1) / v, args=(j,))[0] for j in range(panels)
    )
    assert sum_bessel._summed(v, c, panels, panels / v, 2, nodes=20)[2] == pytest.approx(
        size, rel=1e-9
    )


def test_rounding_of_the_bessel_series_grows_with_its_size_and_its_phase(monkeypatch) -> None:
    # e^{ics} J(cs) over s of order one: the phase c s is rounded in proportion to c
    size, stated = 1e6, []
    monkeypatch.setattr(sum_bessel, "_summed", lambda *_, **__: (0j, 1, size))
    for c in (0.5, 1.0, 2.0):
        error = sum_by_bessel(0.3, c, 1e-14).error - 0.5e-14
        stated.append(error / (EPS * size * (1 + c)))
    assert stated == pytest.approx([stated[0]] * 3)
    assert stated[0] >= 16


def test_quadrature_charges_twice_both_parts_of_each_estimate(monkeypatch) -> None:
    calls = 0

    def estimated(*_, **__):
        nonlocal calls
        calls += 1
        return 0j, complex(1e-3, 2e-3), {}

    monkeypatch.setattr(scipy.integrate, "quad", estimated)
    v, c, tolerance = 0.7, 1.2, 1e-6
    largest = 0.25 + 4 * c * c
    rest = tolerance / 4  # max|A|^2 / 2X^3 at X^3 = 2 max|A|^2 / tolerance
    assert (2 * largest / tolerance) ** (1 / 3) > 2
    found = sum_by_quadrature(v, c, tolerance)
    assert calls > 3
    assert found.error == pytest.approx((rest + calls * 2 * 3e-3) / math.pi, rel=1e-9)


def test_many_digits_charge_the_square_of_what_halving_the_step_changes(monkeypatch) -> None:
    difference = mp.mpf("1e-4")
    monkeypatch.setattr(sum_integral_precise, "_graded", lambda *_: (mp.mpc(0), difference))
    monkeypatch.setattr(sum_integral_precise, "_correction", lambda *_: mp.mpc(0))
    found = sum_integral_precise.precise_sum_by_integral("6", "40", 12)
    assert found.error == pytest.approx(100 * float(difference) ** 2, rel=1e-6)


def series(v: float, c: float, upper: bool = True) -> RootSeries:
    return RootSeries(exact(v), exact(c), 1 if upper else -1)


def recorded(monkeypatch, missed: list[float]) -> list[float]:
    """Let the tails miss by so much, one after the other; return the distances asked for."""
    distances: list[float] = []
    left = iter(missed)

    def labels(_, distance: float) -> tuple[int, int]:
        distances.append(distance)
        return -3, 8

    monkeypatch.setattr(sum_series, "_summed_labels", labels)
    monkeypatch.setattr(sum_series, "_summed_terms", lambda *_: (mp.mpc(0), 0.0))
    monkeypatch.setattr(sum_series, "tail_sum", lambda *_: (mp.mpc(0), mp.mpf(next(left))))
    return distances


@pytest.mark.parametrize("digits", [1, 10, 15, 40])
def test_the_tails_begin_where_their_error_is_below_the_digits(digits: int, monkeypatch) -> None:
    distances = recorded(monkeypatch, [0.0, 0.0])
    sum_by_roots(0.3, 0.5, digits)
    (rho,) = distances
    assert math.exp(-2 * math.pi * rho) < 10.0**-digits


def test_tails_that_miss_too_much_begin_farther_out(monkeypatch) -> None:
    distances = recorded(monkeypatch, [1e-9, 0.0, 0.0, 1e-9, 1e-17, 1e-17])
    assert sum_by_roots(0.3, 0.5, 15).error == pytest.approx(2e-17)
    assert len(distances) == 3
    assert distances[0] < distances[1] < distances[2]


def singular_labels(v: float, c: float, sign: int) -> list[complex]:
    """Return nu = (k - sign i w)/2 pi where k = 0, S = 0 or S = ± i alpha, on the sheets near."""
    alpha, beta = 2 * v / c, 2 + 1j / c
    turn = cmath.sqrt(4 - alpha * alpha)  # S^2 = q^2 - 4 = -alpha^2
    found = []
    for q in (beta, 2, -2, turn, -turn):
        # z + 1/z = q, of which w = ln z with 0 <= Re w
        z = max((q / 2 + s * cmath.sqrt(q * q / 4 - 1) for s in (1, -1)), key=abs)
        k, w = (q - beta) / alpha, cmath.log(z)
        for image in (w, -w, w + 2j * math.pi, w - 2j * math.pi):
            found.append((k - sign * 1j * image) / (2 * math.pi))
    return found


@pytest.mark.parametrize("upper", [True, False])
@pytest.mark.parametrize("distance", [0.5, 1.0, 2.5, 6.0])
@pytest.mark.parametrize(
    ("v", "c"),
    [(0.3, 0.5), (1.2, 2.0), (0.05, 1.0), (3.0, 0.4), (20.0, 30.0), (0.1, 1e-9), (0.02, 3.0)],
)
def test_the_labels_kept_are_those_nearer_than_the_distance(
    v: float, c: float, distance: float, upper: bool
) -> None:
    with mp.workdps(30):
        first, last = sum_series._summed_labels(series(v, c, upper), distance)
    places = singular_labels(v, c, 1 if upper else -1)
    # A little way in from the last labels a singularity is too near; at them none is.
    for end, side in ((first, -1), (last, 1)):
        assert all(abs(nu - end) >= distance - 1e-9 for nu in places)
        inner = end - side * (1 + 1e-9)
        near = any(
            abs(nu - inner) < distance or side * (nu.real - inner) > 0
            for nu in places
            if abs(nu.imag) < distance
        )
        assert near or end == 2 * side


def test_twenty_thousand_roots_to_many_digits_and_a_million_to_few() -> None:
    # S = 0 near k = -2c/v: some 10^5 strips away
    place = series(1.0, 3e5)
    with mp.workdps(30):
        first, last = sum_series._summed_labels(place, 5.0)
    assert 30_000 < last - first < 1_000_000
    with mp.workdps(60), pytest.raises(PrecisionError, match="more than 20000"):
        sum_series._summed_labels(place, 5.0)


def test_what_a_shift_of_the_roots_does_to_the_kept_terms_is_their_error(monkeypatch) -> None:
    v, c, shift = 0.7, 1.1, 1e-3
    roots = labelled_roots(v, c, np.arange(-4, 5), True)

    def shifted(*_) -> RootSet:
        return dataclasses.replace(roots, radius=np.full(roots.k.shape, shift))

    def term(k: np.ndarray) -> np.ndarray:
        return 1 / (-1j * k * (v + c * np.sin(k)))

    monkeypatch.setattr(sum_series, "labelled_roots", shifted)
    _, error = sum_series._summed_terms(series(v, c), -4, 4, 15)
    # d ln t = -(1/k + c cos k/(v + c sin k)) dk, and |cos k| is at most cosh Im k
    share = 1 / np.abs(roots.k)
    share += c * np.cosh(roots.k.imag) / np.abs(v + c * np.sin(roots.k))
    size = np.abs(term(roots.k)) * np.where(np.abs(roots.labels) == 4, 0.5, 1.0)
    assert error == pytest.approx(shift * np.sum(size * share), rel=1e-9)
    h = 1e-6
    slope = np.abs(term(roots.k + h) - term(roots.k - h)) / (2 * h)
    assert np.sum(slope * np.where(np.abs(roots.labels) == 4, 0.5, 1.0)) * shift <= error


def test_many_digits_give_up_eight_of_them_to_rounding() -> None:
    v, c = 0.7, 1.1
    k = labelled_roots(v, c, np.arange(-4, 5), True).k
    size = np.sum(np.abs(1 / (k * (v + c * np.sin(k)))))
    with mp.workdps(45):
        _, rounding = sum_series._summed_terms(series(v, c), -4, 4, 30)
        share = float(rounding * mp.mpf(10) ** (45 - 8))
    assert share == pytest.approx(size, rel=1e-9)


@pytest.mark.parametrize("upper", [True, False])
def test_thirty_times_the_smallest_term_of_a_tail_is_its_error(upper: bool) -> None:
    v, c, label, sign = 0.7, 1.1, 6, 1 if upper else -1
    with mp.workdps(30):
        _, error = sum_series.tail_sum(series(v, c, upper), label, 1, 1)
    # One term, B_2/2 dt/dnu = t'/12: by hand, with S = u - 1/u at u = e^{-ik} above the axis,
    # t = ± 2/(c k (S ∓ i alpha)), S S' = alpha q and dk/dnu = 2 pi S/(S ∓ i alpha).
    k = complex(labelled_roots(v, c, np.array([label]), upper).k[0])
    alpha, beta = 2 * v / c, 2 + 1j / c
    S = cmath.exp(-sign * 1j * k) - cmath.exp(sign * 1j * k)
    lower = S - sign * 1j * alpha
    t = sign * 2 / (c * k * lower)
    by_k = -t * (1 / k + alpha * (alpha * k + beta) / S / lower)
    by_label = by_k * 2 * math.pi * S / lower
    assert float(error) == pytest.approx(30 * abs(by_label) / 12, rel=1e-9)
