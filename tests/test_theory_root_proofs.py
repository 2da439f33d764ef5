"""The steps that enclose roots and count them, where an ordinary case would not need them."""

import math

import mpmath as mp
import numpy as np
import pytest

from theory.piecewise import certified_roots, root_count, roots
from theory.piecewise.dispersion import dispersion, dispersion_slope
from theory.piecewise.roots import labelled_roots, nearest_roots

EPS = float(np.finfo(float).eps)


def true_root(k: complex, v: float, c: float) -> mp.mpc:
    with mp.workdps(50):
        place = mp.mpc(k)
        for _ in range(4):
            value = 0.5 - 1j * mp.mpf(c) * (1 - mp.cos(place)) - 1j * mp.mpf(v) * place
            place -= value / (-1j * (mp.mpf(v) + mp.mpf(c) * mp.sin(place)))
        return place


@pytest.mark.parametrize("share", [1.0, 0.01])
@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1.2, 2.0)])
def test_the_small_ball_is_at_the_true_root_however_small_the_first_try(
    v: float, c: float, share: float
) -> None:
    flint = pytest.importorskip("flint")
    found = labelled_roots(v, c, np.arange(-3, 4), upper=True)
    before = flint.ctx.prec
    flint.ctx.prec = 120
    try:
        for k in found.k.tolist():
            true = true_root(k, v, c)
            off = float(abs(true - k))
            # a share of one per cent of the distance can hold no root: the ball has to grow
            first = share * off if off > 0 else 1e-18
            radius, place = certified_roots._enclose(flint, v, c, k, first)
            assert off <= radius <= 1.01 * off + 1e-30
            with mp.workdps(50):
                centre = [mp.mpf(x.mid().str(40, radius=False)) for x in (place.real, place.imag)]
                assert abs(mp.mpc(*centre) - true) <= 1e-12 * off + mp.mpf(10) ** -30
    finally:
        flint.ctx.prec = before


def test_edges_that_are_not_divided_beforehand_are_divided_until_they_are_proved(
    monkeypatch,
) -> None:
    flint = pytest.importorskip("flint")
    monkeypatch.setattr(
        certified_roots, "edge_pieces", lambda v, c, a, b: (np.array([a]), np.array([b]))
    )
    labels = np.arange(-1, 2)
    assert certified_roots._certified_count(flint, 0.3, 0.5, labels, True) == 3


@pytest.mark.parametrize("tall", [2.0, 4.0, 6.0])
def test_on_a_piece_of_edge_l_changes_by_less_than_its_distance_from_the_axes(
    tall: float, monkeypatch
) -> None:
    # L less a constant is as steep and as bent. Where its slope is zero, at -pi/2 + i tall for
    # v = cosh tall, it is made small: only the bend says there how far it changes.
    v, c = math.cosh(tall), 1.0
    middle = complex(-math.pi / 2, tall)
    small = -0.08 * math.sinh(tall) * (1 + 1j)
    shift = complex(dispersion(np.array([middle]), v, c)[0]) - small

    def moved(k, v, c):
        return dispersion(k, v, c) - shift

    assert abs(dispersion_slope(np.array([middle]), v, c)[0]) < 1e-12 * v
    monkeypatch.setattr(root_count, "dispersion", moved)
    low, high = root_count.edge_pieces(v, c, middle - 2.5, middle + 2.5)
    assert np.sum(np.abs(high - low)) == pytest.approx(5.0)
    for a, b in zip(low, high, strict=True):
        values = moved(a + (b - a) * np.linspace(0, 1, 201), v, c)
        centre = values[100]
        room = max(abs(centre.real), abs(centre.imag))
        assert np.abs(values - centre).max() < room


@pytest.mark.parametrize(("v", "c", "k"), [(200.0, 1000.0, -1 + 0j), (900.0, 400.0, -0.8 + 0.02j)])
def test_terms_that_cancel_are_charged_with_the_rounding_of_each(
    v: float, c: float, k: complex
) -> None:
    # Im L is the difference of two large terms here, and far above Re L
    large = c * abs(1 - np.cos(k)) + v * abs(k.real)
    place = np.array([k])
    value = abs(dispersion(place, v, c)[0].imag)
    assert abs(dispersion(place, v, c)[0].real) < value < 0.8 * large
    charged = value - root_count._distance_from_axes(place, v, c)[0]
    # a few roundings of either; ulp(value) is what the difference itself is known to
    assert charged == pytest.approx(16 * EPS * large, abs=2 * math.ulp(value))


def test_a_finite_radius_means_that_the_slope_hardly_changes_within_it() -> None:
    # Newton and Kantorovich: L is one to one where its slope changes by less than half
    turn = np.exp(2j * np.pi * np.arange(64) / 64)
    finite = far = 0
    for v in (2.0, 5.0, 20.0, 100.0):
        x, y = np.meshgrid(np.linspace(-2, 2, 17), np.linspace(-4, 4, 33))
        k = (x + 1j * y).ravel()
        radius = roots._radius(k, np.full(k.shape, v), np.full(k.shape, 1.0))
        sure = np.isfinite(radius)
        finite, far = finite + int(sure.sum()), far + int((radius[sure] > 0.5).sum())
        edge = k[sure, None] + radius[sure, None] * turn
        slope = dispersion_slope(k[sure], v, 1.0)
        change = np.abs(dispersion_slope(edge, v, 1.0) - slope[:, None]).max(axis=1)
        assert np.all(change < 0.5 * np.abs(slope))
    assert finite > 100
    assert far > 20


@pytest.mark.parametrize("c", np.geomspace(1e-12, 1e-9, 7))
def test_high_roots_are_found_with_one_wider_search(c: float, monkeypatch) -> None:
    # For little coupling cosh Im k is about v |k| / c: no root above the axis is within 20.
    plain, calls = roots.labelled_roots, 0

    def counted(*arguments):
        nonlocal calls
        calls += 1
        assert calls <= 3, "the search goes on with the same reach"
        return plain(*arguments)

    every = np.sort(np.abs(plain(0.3, c, np.arange(-30, 31), True).k))
    monkeypatch.setattr(roots, "labelled_roots", counted)
    for count in (1, 2, 3):
        calls = 0
        found = nearest_roots(0.3, c, count, upper=True)
        assert np.abs(found.k).min() > 20
        np.testing.assert_array_equal(np.abs(found.k), every[:count])
