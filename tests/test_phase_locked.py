"""Phase-locked breathers of any size: against another solver, differences, and runs."""

from __future__ import annotations

import numpy as np
import pytest

from theory.chains.nucleus import Nucleus, outward_pattern
from verification.references import phase_locked
from verification.references.phase_locked import MARGIN, follow, follow_to, locked_breathers

A, B = 2.5, 0.5


def rate(phi: np.ndarray, c: float) -> np.ndarray:
    """Return dφ/dT of (43) with free ends, written site by site."""
    out = np.empty_like(phi)
    for n, value in enumerate(phi):
        near = [phi[k] for k in (n - 1, n + 1) if 0 <= k < phi.size]
        size = abs(value) ** 2
        pull = sum(value - other for other in near)
        out[n] = 0.5j * c * pull - 0.5 * value * (1 - A * size / 4 + B * size**2 / 8)
    return out


def test_a_breather_turns_and_does_nothing_else() -> None:
    for found in locked_breathers(4, A, B):
        turn = 1j * found.omega * found.phi
        assert np.abs(rate(found.phi, found.c) - turn).max() < 1e-11


def test_the_jacobian_is_the_slope_of_the_residual() -> None:
    u = np.random.default_rng(1).normal(size=2 * (2 * MARGIN + 3) + 1)
    step = 1e-6
    columns = [
        (phase_locked.residual(u + step * e, 0.1, A, B)
         - phase_locked.residual(u - step * e, 0.1, A, B)) / (2 * step)
        for e in np.eye(u.size)
    ]  # fmt: skip
    # Third derivatives of the damping at |φ| of about two, times the step squared.
    assert np.abs(np.array(columns).T - phase_locked.jacobian(u, 0.1, A, B)).max() < 1e-7


@pytest.mark.parametrize("size", [1, 3])
def test_folds_are_those_of_the_continuation_of_the_averaged_chain(size: int) -> None:
    from theory.chains.vdp import VdpChain
    from verification.thresholds.continuation import breather_threshold
    from verification.thresholds.result import ThresholdMethod

    chain = VdpChain(a=A, b=B, c=0.0, eps=0.01)
    other = breather_threshold(
        chain, Nucleus(size, outward_pattern(size)), method=ThresholdMethod.ENVELOPE
    )
    ends = [follow(found, A, B).c_end for found in locked_breathers(size, A, B)]
    assert min(abs(end - other.c_crit) for end in ends) < 2e-7


def test_odd_sizes_have_quarter_turns_only_and_none_above_one_is_stable() -> None:
    for size in (3, 5):
        found = locked_breathers(size, A, B)
        assert len(found) == {3: 3, 5: 10}[size]
        assert not any(one.stable for one in found)
        # Beyond the first order in c the steps differ from a quarter by terms of order c.
        assert all(np.abs(np.abs(one.steps) - 0.5).max() < 0.03 for one in found)
        for core, steps in ((one.phi[MARGIN:-MARGIN], one.steps) for one in found):
            turned = core[1:] / core[:-1] * np.exp(-1j * np.pi * steps)
            assert np.abs(np.angle(turned)).max() < 1e-14


@pytest.mark.parametrize(
    ("outward", "c"), [([0.0, 0.5, 0.03], 0.195), ([0.0, 0.5, 0.0, 0.5, 0.0], 0.2)]
)
def test_breathers_of_six_and_ten_sites_are_stable_beyond_the_end_of_one_site(
    outward: list[float], c: float
) -> None:
    """Also by the exponents of (43) written site by site, with differences."""
    end = follow(locked_breathers(1, A, B)[0], A, B).c_end
    steps = np.pi * np.array([*(-each for each in outward[:0:-1]), *outward])
    u = phase_locked.solve(phase_locked.start_from(steps, A, B, 0.03), 0.03, A, B)
    start = phase_locked.LockedBreather(
        size=steps.size + 1, c=0.03, phi=u[: u.size // 2] + 1j * u[u.size // 2 : -1],
        omega=float(u[-1]), growth=phase_locked.growth_rate(u, 0.03, A, B),
    )  # fmt: skip
    found = follow_to(start, c, A, B)
    assert found.c > end
    assert found.stable
    x, step = np.concatenate([found.phi.real, found.phi.imag]), 1e-6

    def turning(x: np.ndarray) -> np.ndarray:
        phi = x[: x.size // 2] + 1j * x[x.size // 2 :]
        out = rate(phi, c) - 1j * found.omega * phi
        return np.concatenate([out.real, out.imag])

    slope = [(turning(x + step * e) - turning(x - step * e)) / (2 * step) for e in np.eye(x.size)]
    rates = np.linalg.eigvals(np.array(slope).T)
    growth = float(np.delete(rates, np.argmin(np.abs(rates))).real.max())
    assert growth < 0.0
    assert abs(growth - found.growth) < 1e-6


def test_the_end_of_a_branch_cannot_be_passed() -> None:
    (one,) = locked_breathers(1, A, B)
    with pytest.raises(ArithmeticError, match="ends before"):
        follow_to(one, 0.195, A, B)
