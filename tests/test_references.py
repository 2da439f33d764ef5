"""References share nothing with what they check, and each right side is that of its model."""

from __future__ import annotations

from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from benchmarks.regularised import regularised_rate
from tests.reference_runs import overdamped_rate, states_by_scipy
from theory.averaged.envelope import envelope_rate
from theory.cells.friction import FrictionCell
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.vdp import VdpChain
from theory.piecewise.limits import static_sum_distance
from verification.execution.imports import SOURCES, closure
from verification.references import equations
from verification.references.piecewise import static_sum, sum_by_quadrature, threshold_ratio

ROOT = Path(__file__).parents[1]
REFERENCES = sorted((ROOT / "verification" / "references").glob("*.py"))
ALLOWED = (
    "theory.arrays", "theory.cells", "theory.chains", "theory.compiled_code", "theory.compiler",
    "theory.interruption", "theory.parameters", "theory.status", "verification.references",
    "verification.execution",
)  # fmt: skip
"""Parameters, the enum of the ends, interrupts from the keyboard, and the compiler's front with the
folder of its code; no engine, and no other formula."""

CHAIN = VdpChain(a=2.5, b=0.5, c=0.3, eps=0.05, sites=6)


@pytest.mark.parametrize("path", REFERENCES, ids=lambda path: path.stem)
def test_a_reference_imports_none_of_the_engines(path: Path) -> None:
    module = f"verification.references.{path.stem}".removesuffix(".__init__")
    for name in closure(module, packages=SOURCES):
        assert name in ("theory", "verification") or name.startswith(ALLOWED), name


def test_following_imports_would_see_an_engine() -> None:
    assert "verification.steppers.kernel" in closure("verification.runs.simulate", packages=SOURCES)


def test_no_other_place_writes_the_damping_of_the_chain_for_scipy() -> None:
    """Outside engines, derivations and theory, 1 - ay² + by⁴ stands in one file."""
    folders = ("tests", "benchmarks", "verification/quantities", "verification/work_reduction")
    for folder in folders:
        for path in (ROOT / folder).rglob("*.py"):
            if path.name in ("test_references.py", "derivation.py"):
                continue  # this file; programs of symbols for other packages
            text = "".join(path.read_text(encoding="utf-8").split())
            for written in ("b*y**4)", "B*y**4)", "b*square*square)", "b*square**2)"):
                peer = path.name == "chain.py" and folder == "benchmarks"  # heyoka and jitcode
                assert written not in text or peer, (path.name, written)


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_averaged_rate_is_the_average_of_the_full_one(ends: Ends) -> None:
    """Over one turn of frozen φ; 64 instants average harmonics up to the sixth exactly."""
    chain = CHAIN.replace(ends=ends)
    rng = np.random.default_rng(7)
    phi = rng.normal(size=6) + 1j * rng.normal(size=6)
    full, total = equations.full_rate(chain), np.zeros(6, dtype=complex)
    for angle in 2.0 * np.pi * np.arange(64) / 64:
        psi = phi * np.exp(1j * angle)
        y, w = np.split(full(0.0, equations.as_state(psi)), 2)
        total += (w + 1j * y - 1j * psi) * np.exp(-1j * angle) / 64
    found = equations.averaged_rate(chain)(0.0, phi)
    assert np.abs(found - total / chain.eps).max() < 1e-12
    assert np.abs(found - envelope_rate(phi, chain)).max() < 1e-13


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_variations_and_the_jacobian_are_derivatives_of_the_rate(ends: Ends) -> None:
    chain = CHAIN.replace(ends=ends)
    state = np.random.default_rng(8).normal(size=12)
    rate, step = equations.full_rate(chain), 1e-6
    columns = [
        (rate(0.0, state + step * e) - rate(0.0, state - step * e)) / (2 * step) for e in np.eye(12)
    ]
    slope = np.array(columns).T
    # Central differences: step² times third derivatives of order one.
    assert np.abs(equations.full_jacobian(chain)(0.0, state).toarray() - slope).max() < 1e-9
    several = rate(0.0, np.column_stack([state, 2.0 * state, -state]).ravel()).reshape(12, 3)
    for k, factor in enumerate((1.0, 2.0, -1.0)):
        assert np.array_equal(several[:, k], rate(0.0, factor * state))
    start = np.column_stack([state, np.eye(12)]).ravel()
    both = equations.variational_rate(chain)(0.0, start).reshape(12, 13)
    assert np.abs(both[:, 0] - rate(0.0, state)).max() == 0.0
    assert np.abs(both[:, 1:] - slope).max() < 1e-9


def test_the_quarter_turn_rate_is_the_averaged_one_on_its_manifold() -> None:
    r = np.random.default_rng(3).normal(size=6)
    turn = (-1j) ** np.arange(6)
    # In the frame e^{icT}; the end sites lack a neighbour and are left out.
    rate = (equations.averaged_rate(CHAIN)(0.0, turn * r) - 1j * CHAIN.c * turn * r) / turn
    found = equations.quarter_turn_rate(CHAIN)(0.0, r)
    assert np.abs(rate[1:-1] - found[1:-1]).max() < 1e-14
    wave = equations.quarter_turn_rate(CHAIN, wave=True)(0.0, r)
    assert np.array_equal(wave[1:], found[1:])
    assert wave[0] - found[0] == pytest.approx(0.5 * CHAIN.c * r[0])


def test_a_chain_without_inertia_moves_by_its_forces_and_springs() -> None:
    y, matrix = np.array([0.3, -0.2]), np.array([[1.0, -1.0], [-2.0, 2.0]])
    rate = overdamped_rate(lambda y: y**3, matrix, c=0.4, force=lambda t: np.array([t, 0.0]))
    expected = np.array([2.0, 0.0]) - y**3 - 0.4 * np.array([0.5, -1.0])
    assert rate(2.0, y) == pytest.approx(expected, abs=1e-15)


def test_a_wave_goes_on_at_the_left_end() -> None:
    """On a chain that is long to the left, a wave e^{i(t - πn/2)} has y_0 = ẏ_1."""
    turns = 1j * (-1j) ** np.arange(7)
    long = equations.full_rate(CHAIN.replace(sites=7))(0.0, equations.as_state(turns))
    short = equations.full_rate(CHAIN, wave=True)(0.0, equations.as_state(turns[1:]))
    assert np.abs(short.reshape(2, 6)[:, 0] - long.reshape(2, 7)[:, 1]).max() < 1e-15


def test_the_uniform_states_of_the_piecewise_chain_rest() -> None:
    """φ = 0 and φ = 1, and a ring whose turn is closed by its additions."""
    on = np.array([True, True, False, False])
    phi = on.astype(complex)
    inner = equations.piecewise_rate(0.7, on, 1.0, 0.0)(0.0, phi)
    assert np.abs(inner[[0, 3]]).max() == 0.0
    assert np.allclose(inner[[1, 2]], [0.35j, -0.35j])
    ring = equations.piecewise_rate(0.7, on, 1.0, -1.0, ring=True)(0.0, phi)
    assert np.allclose(ring, inner)


def test_regularised_friction_tends_to_that_of_the_cell() -> None:
    chain = FrictionChain.of(FrictionCell(), c=0.2, sites=3)
    z = np.array([0.3, 0.5, -0.2, 2.0, 0.1, 0.0])
    y, velocity = z[0::2], z[1::2]
    rate = regularised_rate(chain, 1e-6)(0.0, z)
    cell = chain.cell
    slip = velocity - cell.v_d
    mu = cell.mu_d + (cell.mu_st - cell.mu_d) * np.exp(-np.abs(slip) / cell.v0)
    springs = np.array([y[0] - y[1], 2 * y[1] - y[0] - y[2], y[2] - y[1]])
    force = -np.sign(slip) * mu - 2 * cell.xi * velocity - y - chain.c * springs
    assert np.abs(rate[1::2] - force).max() < 1e-14
    assert np.array_equal(rate[0::2], velocity)


def test_the_sum_by_quadrature_tends_to_the_static_one() -> None:
    value, error = sum_by_quadrature(0.05, 0.5, 1e-7, 4000)
    assert abs(value - complex(static_sum(mp.mpf(0.5)))) < error + static_sum_distance(0.05, 0.5)


def test_the_threshold_is_the_ratio_of_the_two_cycles() -> None:
    chain = VdpChain(a=4, b=0.5, c=0.1)
    found = float(threshold_ratio(0.5 / 16))
    assert found == pytest.approx(chain.unstable_amplitude / chain.stable_amplitude, rel=1e-15)


def test_a_turn_by_scipy_is_right_to_eleven_digits() -> None:
    times = np.linspace(0.0, 20.0, 5)
    found = states_by_scipy(lambda _, x: np.array([x[1], -x[0]]), np.array([0.0, 1.0]), times)
    assert np.abs(found - np.column_stack([np.sin(times), np.cos(times)])).max() < 1e-10


def test_a_run_that_does_not_reach_its_last_time_is_no_reference() -> None:
    with pytest.raises(ArithmeticError, match="step size"):  # y' = y² from 1 is infinite at t = 1
        states_by_scipy(lambda _, y: y**2, np.ones(1), np.array([0.0, 2.0]))
