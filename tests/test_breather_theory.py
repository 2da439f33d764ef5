"""Claims about the averaged chain and the closed form of its breather (Eqs. 29-38, 43)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

from theory.averaged.breather import BreatherStatus, Reading, closed_form_fold, solve_breather
from theory.averaged.envelope import (
    envelope_jacobian,
    envelope_rate,
    quarter_turn_jacobian,
    quarter_turn_phase,
    quarter_turn_rate,
)
from theory.chains.ends import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.breathers.breather import breather
from verification.references.equations import damping, pull

CHAIN = VdpChain(a=2.5, b=0.5, c=0.17, sites=8)
SEED = 20261121


def noise(sites: int = 8) -> np.ndarray:
    rng = np.random.default_rng(SEED)
    return rng.normal(size=sites) + 1j * rng.normal(size=sites)


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_envelope_is_the_average_of_the_chain(ends: Ends) -> None:
    """Average εẏ-forces of (8) over a period at frozen φ, by a sum over 64 instants."""
    chain = replace(CHAIN, ends=ends)
    phi = noise()
    angle = 2 * np.pi * np.arange(64) / 64
    psi = phi[:, None] * np.exp(1j * angle)
    y, v = psi.imag, psi.real
    force = -(chain.c * pull(y, ends) + v * damping(y, chain.a, chain.b))
    # Ψ' = ÿ + iẏ = iΨ + ε·force; 64 instants average harmonics up to 6 exactly.
    averaged = (force * np.exp(-1j * angle)).mean(axis=1)
    assert np.abs(envelope_rate(phi, chain) - averaged).max() < 1e-13


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_jacobian_is_the_derivative_of_the_rate(ends: Ends) -> None:
    chain, phi, step = replace(CHAIN, ends=ends), noise(), 1e-6
    columns = []
    for direction in (*np.eye(8), *(1j * np.eye(8))):
        up, down = (envelope_rate(phi + s * step * direction, chain) for s in (1, -1))
        change = (up - down) / (2 * step)
        columns.append(np.concatenate([change.real, change.imag]))
    # Central differences: error step² times third derivatives of order 10.
    assert np.abs(envelope_jacobian(phi, chain) - np.array(columns).T).max() < 1e-8


def test_the_quarter_turn_reduction_is_exact_on_a_ring() -> None:
    chain = replace(CHAIN, ends=Ends.PERIODIC)
    r = noise().real
    phi = quarter_turn_phase(8) * r
    full = (envelope_rate(phi, chain) - 1j * chain.c * phi) / quarter_turn_phase(8)
    assert np.abs(full.imag).max() < 1e-15
    assert np.abs(full.real - quarter_turn_rate(r, chain)).max() < 1e-15


def test_the_quarter_turn_reduction_fails_at_free_ends_by_what_it_says() -> None:
    r = noise().real
    phi = quarter_turn_phase(8) * r
    full = (envelope_rate(phi, CHAIN) - 1j * CHAIN.c * phi) / quarter_turn_phase(8)
    left_out = np.abs(full - quarter_turn_rate(r, CHAIN))
    assert left_out.max() == pytest.approx(0.5 * CHAIN.c * max(abs(r[0]), abs(r[-1])), rel=1e-12)
    assert left_out[1:-1].max() < 1e-15


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_quarter_turn_jacobian_is_the_derivative(ends: Ends) -> None:
    chain, r, step = replace(CHAIN, ends=ends), noise().real, 1e-6
    columns = [
        (quarter_turn_rate(r + step * e, chain) - quarter_turn_rate(r - step * e, chain))
        / (2 * step)
        for e in np.eye(8)
    ]
    assert np.abs(quarter_turn_jacobian(r, chain) - np.array(columns).T).max() < 1e-8


def test_the_envelope_depends_on_a_and_b_through_eta_only() -> None:
    scaled = VdpChain(a=1.0, b=CHAIN.eta, c=CHAIN.c, sites=8)
    phi = noise()
    assert (
        np.abs(
            envelope_rate(phi * math.sqrt(CHAIN.a), scaled) / math.sqrt(CHAIN.a)
            - envelope_rate(phi, CHAIN)
        ).max()
        < 1e-14
    )


@pytest.mark.parametrize("c", [0.01, 0.1, 0.19])
def test_closed_form_solves_the_printed_equations(c: float) -> None:
    """(29) and (37) as printed, by a general solver that knows nothing of w."""
    chain = VdpChain(a=2.5, b=0.5, c=c)

    def printed(unknown: np.ndarray) -> list[float]:
        alpha, k = unknown
        z = math.exp(k)
        left = 0.5 - 2.5 * alpha**2 * z**2 / 8 + 0.5 * alpha**4 * z**4 / 16
        return [
            math.exp(k) - (-(alpha**4) * 0.5 + 2 * alpha**2 * 2.5 - 8) / (16 * c),
            2 / (c * (z - 1 / z)) * left + 1,
        ]

    found = solve_breather(chain)
    alpha, k = fsolve(printed, [found.alpha_0 + 1e-4, math.log(found.decay) + 1e-3], xtol=1e-14)
    assert found.alpha_0 == pytest.approx(alpha, abs=1e-10)
    assert found.decay == pytest.approx(math.exp(k), abs=1e-10)
    stated = breather(chain, method="closed-form")
    assert abs(stated.decay - math.exp(k)) <= stated.decay_error + 1e-13
    assert stated.decay_error == found.error * found.decay < 1e-12


def test_closed_form_ends_where_the_printed_equations_become_singular() -> None:
    chain = VdpChain(a=2.5, b=0.5, c=0.1)
    fold = closed_form_fold(chain)
    assert fold.c is not None
    # Below the fold two solutions meet like a square root: their distance quarters in 16 steps.
    gaps = []
    for away in (1.6e-6, 1e-7):
        found = solve_breather(replace(chain, c=fold.c - away))
        end = solve_breather(replace(chain, c=fold.c))
        gaps.append(end.decay - found.decay)
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.02)
    assert solve_breather(replace(chain, c=fold.c + 1e-9)).status is BreatherStatus.NONE


def test_the_reading_at_the_centre_has_no_solution() -> None:
    """With G > 0 the two sides of (37) at n = 0 have opposite signs, wherever one looks."""
    rng = np.random.default_rng(SEED)
    for alpha, z in zip(rng.uniform(1.5, 2.8, 500), rng.uniform(0.001, 0.999, 500), strict=True):
        gain = (-0.5 * alpha**4 + 5.0 * alpha**2 - 8) / 16
        if gain > 0:
            c = gain / z
            left = 0.5 - 2.5 * alpha**2 / 8 + 0.5 * alpha**4 / 16
            assert left < 0 < 0.5 * c * (1 / z - z)
    assert solve_breather(CHAIN, Reading.CENTRE).status is BreatherStatus.NONE


def test_the_tail_reading_ends_at_the_known_coupling() -> None:
    m = (2.5**2 - 8 * 0.5) / (16 * 0.5)
    fold = closed_form_fold(CHAIN, Reading.TAIL)
    assert fold.c == pytest.approx(math.sqrt(m * (1 + m)), rel=1e-14)


def test_bad_chains_are_refused() -> None:
    with pytest.raises(ParameterError, match="1/8"):
        solve_breather(VdpChain(a=1.0, b=0.5, c=0.1))
    with pytest.raises(ParameterError, match="c > 0"):
        solve_breather(VdpChain(a=2.5, b=0.5, c=0))
    with pytest.raises(ParameterError, match="multiple of 4"):
        quarter_turn_rate(np.zeros(6), VdpChain(a=2.5, b=0.5, c=0.1, sites=6, ends=Ends.PERIODIC))
