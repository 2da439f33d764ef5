"""What a reference says of its own error bounds it: each is held against a still sharper one."""

from __future__ import annotations

from functools import partial

import mpmath as mp
import numpy as np
import pytest

from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from theory.piecewise.kinetic_relation import kinetic_relation
from verification.breathers.envelope import solve_envelope_breather
from verification.breathers.floquet import floquet_multipliers
from verification.quantities import breathers
from verification.quantities.breathers import _eigenvalues, _farthest, _precise_orbit
from verification.quantities.kinetic_relation import precise_velocity
from verification.quantities.registry import computation_named
from verification.quantities.sums import reference_sum
from verification.references import extrapolation, pace
from verification.references.equations import averaged_rate, full_rate, variational_rate
from verification.references.extrapolation import PreciseState, extended, integrate, precise_state
from verification.references.front_wave import front_velocity
from verification.references.piecewise import threshold_ratio
from verification.references.precise_breather import _defect, locked_fold, locked_state

pytestmark = pytest.mark.usefixtures("unhurried")


def many_digits(values: np.ndarray) -> np.ndarray:
    return np.array([mp.mpf(float(x)) for x in values], dtype=object)


def farthest(found: np.ndarray, true: np.ndarray) -> float:
    """Return the largest distance of long doubles from numbers of mpmath."""
    halves = [(float(x), float(x - np.longdouble(float(x)))) for x in found]
    return float(max(abs(mp.mpf(a) + b - t) for (a, b), t in zip(halves, true, strict=True)))


@pytest.mark.parametrize("seed", range(6))
def test_a_run_in_extended_precision_is_as_near_to_the_truth_as_it_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    chain = VdpChain(
        a=4.0, b=0.5, c=10.0 ** rng.uniform(-3, 1), eps=10.0 ** rng.uniform(-3, 0), sites=3
    )
    start = rng.normal(size=6) * 10.0 ** rng.uniform(-6, 0.3)
    found = precise_state(full_rate(chain), start, 2.5)
    with mp.workdps(34):
        true = integrate(full_rate(chain), many_digits(start), 2.5, 1e-22).value
        error = farthest(found.value, true)
    assert 0.0 < error <= found.uncertainty < 1e-13 * max(1.0, np.abs(start).max())


def test_a_run_agrees_with_taylor_series_of_mpmath() -> None:
    chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.1, sites=2)
    start = np.array([2.0, 0.0, 0.0, 0.3])
    found = precise_state(full_rate(chain), start, 1.0)
    rate = full_rate(chain)
    with mp.workdps(28):
        path = mp.odefun(
            lambda t, x: list(rate(0.0, np.array(list(x), dtype=object))), 0, many_digits(start)
        )
        assert farthest(found.value, np.array(path(1), dtype=object)) <= found.uncertainty < 1e-15


def test_a_complex_run_and_one_backwards_return_to_their_start() -> None:
    chain = VdpChain(a=4.0, b=0.5, c=2.0, eps=0.1, sites=5)
    start = np.array([2.0, 0.1j, 0.0, 0.3, 0.0])
    ahead = precise_state(averaged_rate(chain), start, 1.0)
    back = precise_state(averaged_rate(chain), ahead.value, -1.0)
    # What grows backwards: at most e^{max damping}, of this cycle.
    assert np.abs(back.value - start).max() < 1e8 * (ahead.uncertainty + back.uncertainty)
    assert ahead.uncertainty + back.uncertainty < 1e-14


def test_what_is_too_stiff_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "MAX_SECONDS", 0.3)  # no limit makes these ones possible
    with pytest.raises(ArithmeticError, match="too stiff"):
        precise_state(lambda _, y: -1e6 * y, np.ones(1), 1.0)
    with pytest.raises(ArithmeticError, match="too stiff"):  # infinite at t = 1
        precise_state(lambda _, y: y**2, np.ones(1), 2.0)


def test_the_uncertainty_sees_a_run_that_is_too_loose(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extrapolation, "TOLERANCE", 1e-6)
    monkeypatch.setattr(extrapolation, "LOOSER", 1e-5)
    chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.1, sites=2)
    start = np.array([2.0, 0.0, 0.0, 0.3])
    found = precise_state(full_rate(chain), start, 5.0)
    true = integrate(full_rate(chain), extended(start), 5.0, 1e-17).value
    assert 1e-14 < float(np.abs(found.value - true).max()) <= found.uncertainty < 1e-3


AT = {"eta": 0.08, "c": 0.1, "eps": 0.01}


@pytest.fixture(name="orbit")
def orbit_of_three_sites(monkeypatch: pytest.MonkeyPatch) -> np.ndarray:
    monkeypatch.setattr(breathers, "_SITES", 3)
    return np.asarray(computation_named("orbit").compute(AT).value)


def test_a_polished_orbit_is_the_same_from_another_start(
    orbit: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    moved = orbit + 1e-9 * np.cos(np.arange(orbit.size))
    found = _precise_orbit(AT, moved)
    monkeypatch.setattr(breathers, "_TOLERANCES", (1e-21, 1e-22))
    sharp = _precise_orbit(AT, orbit)
    assert found.uncertainty < 1e-16
    assert sharp.uncertainty < 1e-17
    assert float(max(np.abs(found.value - sharp.value))) <= found.uncertainty + sharp.uncertainty


def test_multipliers_of_the_reference_are_those_of_a_longer_arithmetic(orbit: np.ndarray) -> None:
    """A short chain, whose monodromy mpmath can have in thirty digits."""
    chain = VdpChain(a=1.0, b=0.08, c=0.1, eps=0.01, sites=2)
    start = np.column_stack([orbit[[0, 1, 3, 4]], np.eye(4)])
    found = precise_state(variational_rate(chain), start.ravel(), 1.57)
    with mp.workdps(32):
        rate = variational_rate(chain)

        def exact(t: object, x: np.ndarray) -> np.ndarray:
            # The rate fills arrays of doubles: of objects, column by column.
            columns = x.reshape(4, 5)
            out = np.empty_like(columns)
            for k in range(1, 5):
                pair = np.column_stack([columns[:, 0], columns[:, k]])
                out[:, [0, k]] = rate(0.0, pair.ravel()).reshape(4, 2)
            return out.ravel()

        true = integrate(exact, many_digits(start.ravel()), 1.57, 1e-22).value
        assert farthest(found.value, true) <= found.uncertainty < 1e-14
        matrix = mp.matrix(true.reshape(4, 5)[:, 1:].tolist())
        values = np.array([complex(x) for x in mp.eig(matrix, left=False, right=False)])
    ours = _eigenvalues(found.value.reshape(4, 5)[:, 1:])
    assert _farthest(ours, values) < 1e-14


def test_the_error_of_multipliers_bounds_what_an_error_of_their_matrix_does() -> None:
    """Also where vectors are nearly dependent, and roundings alone move values by 1e-8."""
    rng = np.random.default_rng(4)
    for gap in (0.3, 1e-6, 1e-14):
        true = np.diag([1.0, 1.0 - gap, 0.5, 0.2])
        true[0, 1] = 1.0
        for error in (1e-10, 1e-13):
            moved = true + error * rng.uniform(-1.0, 1.0, true.shape)
            found = floquet_multipliers(moved, 2.0, 0.1, error=error, parity=0)
            off = _farthest(found.values, np.diag(true).astype(complex))
            assert error / 10 < off <= found.error < 3.0, gap


def test_a_locked_state_is_that_of_forty_digits() -> None:
    eta, c = 0.05, 0.1
    phi, omega = _three_sites(eta, c)
    found = locked_state(eta, c, phi, omega)
    with mp.workdps(40):
        true = mp.findroot(
            lambda *x: list(_in_mpmath(x, eta, c)), [mp.mpf(float(x)) for x in found.value]
        )
        assert 0.0 < farthest(found.value, np.array(list(true))) <= found.uncertainty < 1e-15


def _three_sites(eta: float, c: float) -> tuple[np.ndarray, float]:
    found = solve_envelope_breather(VdpChain(a=1.0, b=eta, c=c, eps=0.01, sites=3), Nucleus(1))
    return found.waves, float(found.unknowns[-1])


def _in_mpmath(x: tuple[object, ...], eta: float, c: object) -> np.ndarray:
    """Return the equations of three sites, written once more."""
    p = [mp.mpc(x[i], x[3 + i]) for i in range(3)]
    pulls = [p[0] - p[1], 2 * p[1] - p[0] - p[2], p[2] - p[1]]
    rates = []
    for phi, springs in zip(p, pulls, strict=True):
        square = abs(phi) ** 2
        damped = phi / 2 * (1 - square / 4 + mp.mpf(eta) * square**2 / 8)
        rates.append(mp.mpc(0, c) / 2 * springs - damped - mp.mpc(0, x[6]) * phi)
    return np.array([*(r.real for r in rates), *(r.imag for r in rates), x[4]])


def test_a_fold_is_where_the_matrix_is_singular_in_forty_digits() -> None:
    """Of half of the mirror-symmetric state of three sites: two amplitudes and Ω."""
    eta = 0.05
    beyond = VdpChain(a=1.0, b=eta, c=1.0, eps=0.01, sites=3)
    fold = solve_envelope_breather(beyond, Nucleus(1)).fold
    found = locked_fold(eta, fold, *_three_sites(eta, 0.999 * fold))
    with mp.workdps(40):

        def half(u: list[object], c: object) -> list[object]:
            whole = (u[0], u[1], u[0], u[2], u[3], u[2], u[4])
            value = _in_mpmath(whole, eta, c)
            return [value[i] for i in (0, 1, 3, 4, 6)]

        def singular(*z: object) -> list[object]:
            u, h = list(z[:5]), mp.mpf(10) ** -15
            slope = mp.matrix(5, 5)
            for j in range(5):
                ahead, behind = ([x + s * h * (i == j) for i, x in enumerate(u)] for s in (1, -1))
                for i, (a, b) in enumerate(zip(half(ahead, z[5]), half(behind, z[5]), strict=True)):
                    slope[i, j] = (a - b) / (2 * h)
            return [*half(u, z[5]), mp.det(slope)]

        first = [mp.mpf(float(found.value[i])) for i in (0, 1, 3, 4, 6, 7)]
        true = mp.findroot(singular, first, tol=1e-40)
        assert farthest(found.value[-1:], np.array([true[5]])) <= found.uncertainty < 1e-16


def test_of_all_locked_states_the_one_that_is_given_is_refined() -> None:
    """Of three sites on the cycle, a quarter of a turn apart, and not of fewer."""
    chain = VdpChain(a=1.0, b=0.05, c=0.05, eps=0.01, sites=7)
    given = solve_envelope_breather(chain, Nucleus(3, "-+"))
    phi, omega = given.waves, float(given.unknowns[-1])
    found = locked_state(0.05, 0.05, phi, omega)
    assert farthest(found.value, np.array([*phi.real, *phi.imag, omega])) < 1e-10


def test_newton_does_not_invent_a_state() -> None:
    with pytest.raises(ArithmeticError, match="converge"):
        locked_state(0.05, 5.0, np.array([0.1j, 6.0, 0.1j, 0.0, 0.0]), 3.0)


def test_the_defect_of_a_locked_state_is_the_rate_in_its_frame() -> None:
    chain = VdpChain(a=1.0, b=0.05, c=0.3, eps=0.1, sites=4)
    rng = np.random.default_rng(2)
    phi = rng.normal(size=4) + 1j * rng.normal(size=4)
    found = _defect(extended([*phi.real, *phi.imag, 0.7]), 0.05, 0.3, 2)
    rate = averaged_rate(chain)(0.0, phi) - 0.7j * phi
    assert np.abs(found - [*rate.real, *rate.imag, phi[2].imag]).max() < 1e-15


@pytest.mark.parametrize(("c", "eta"), [(0.6, 0.03125), (0.3, 0.05)])
def test_two_grids_are_farther_apart_than_the_finer_is_from_the_truth(c: float, eta: float) -> None:
    coarse = front_velocity(c, eta, 28, behind=20, ahead=24)
    fine = front_velocity(c, eta, 40, behind=30, ahead=36)
    finest = front_velocity(c, eta, 56, behind=40, ahead=48)
    assert abs(finest - fine) <= abs(fine - coarse) < 1e-7


def test_a_velocity_of_many_digits_is_enclosed_by_a_change_of_sign() -> None:
    at = {"c": 0.5, "eta": 0.03125}
    for branch in kinetic_relation(**at).branches:
        v, uncertainty = precise_velocity(branch.v * (1.0 + 3e-13), at)
        assert uncertainty < 1e-16 * abs(v)
        signs = []
        for side in (-1, 1):
            with mp.workdps(50):
                text = mp.nstr(abs(v) + side * max(uncertainty, 1e-30), 45)
                value = partial(reference_sum, c=at["c"], digits=40)(mp.mpf(text))[0]
                shift = 2 if v < 0 else 0
                signs.append(mp.sign(abs(value + shift) - 2 * threshold_ratio(at["eta"])))
        assert signs[0] == -signs[1]


def test_a_state_beside_another_is_as_uncertain_as_they_are_apart() -> None:
    one = PreciseState(value=extended([1.0, 2.0]), uncertainty=1e-3)
    other = PreciseState(value=extended([1.0, 2.5]), uncertainty=9.0)
    assert one.beside(other).uncertainty == 0.501
