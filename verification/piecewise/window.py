"""The window in which the piecewise-linear chain (Eq. 44) is followed, and its truncation error.

The window is a ring of N sites with a twist, ``phi_{n+N} = phi_n - 1``: the front is repeated every
N sites, each time one equilibrium lower. By linearity the twisted chain is the infinite chain plus
its images, and the images decay, so that the error due to the window can be bounded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from theory.arrays import BoolArray, ComplexArray, FloatArray
from theory.parameters import ParameterError

MAX_SITES = 1 << 15
_RESERVE = 1 / 16
"""Fraction of the damping held in reserve, so that the bounds stay finite as the front slows
down."""


@dataclass(frozen=True)
class ChainState:
    """A state of the chain: phi = 1 far to the left of the window and 0 far to the right.

    Attributes
    ----------
    phi : ndarray of complex, shape (N,)
        Envelope over phi_s, dimensionless.
    origin : int
        Site number of ``phi[0]``.
    on : ndarray of bool, shape (N,), optional
        Sites with ``|phi| > r``; determined from ``phi`` if not given.
    latest : int, optional
        Index in ``phi`` of a site that has just crossed and is exactly at r.
    """

    phi: ComplexArray
    origin: int = 0
    on: BoolArray | None = None
    latest: int | None = None


def decay_rate(coupling: float, velocity: float) -> float:
    """Smallest decay rate s of both tails of a front: ``c sinh s + |v| s = (1/2)(15/16)``.

    From the strip in which the dispersion relation (50) has no root; dimensionless, per site.

    Examples
    --------
    >>> round(decay_rate(0.5, 0.3), 4)
    0.5667
    """
    target, speed = 0.5 * (1 - _RESERVE), abs(velocity)
    s = min(math.asinh(target / coupling), target / speed if speed > 0 else math.inf)
    for _ in range(50):
        step = (coupling * math.sinh(s) + speed * s - target) / (coupling * math.cosh(s) + speed)
        s -= step
        if abs(step) <= 1e-15 * s:
            break
    return s


def truncation_bound(coupling: float, velocity: float, distance: float) -> float:
    """Bound on the error in ``|phi|`` at the front due to images ``distance`` sites away.

    Uses ``|J_m(x)| <= exp(x sinh s - |m| s)`` in the Green's function of (44), summed over all
    switchings of a front at ``velocity`` and over all images.
    """
    s, speed = decay_rate(coupling, velocity), max(abs(velocity), 1e-12)
    response = 0.5 / (0.5 - coupling * math.sinh(s))
    old = -1 / math.expm1(-0.5 * _RESERVE / speed)
    ahead = -1 / math.expm1(-s)
    behind = old + ahead + 1 / -math.expm1(-2 * s)
    return response * (ahead + behind) * math.exp(-s * distance) / -math.expm1(-s * distance)


def window_length(coupling: float, velocity: float, tolerance: float, zone: int = 0) -> int:
    """Return the smallest N, a multiple of 16, whose images disturb by less than ``tolerance``.

    Parameters
    ----------
    coupling, velocity : float
        c > 0 and v of either sign, dimensionless.
    tolerance : float
        Allowed disturbance of ``|phi|``.
    zone : int
        Number of sites over which the front itself is spread (0 for a sharp one).

    Raises
    ------
    ParameterError
        If more than 32768 sites are needed, at couplings of a few hundred.
    """
    s = decay_rate(coupling, velocity)
    distance = math.log(max(truncation_bound(coupling, velocity, 100 / s) / tolerance, 1e-300)) / s
    sites = 16 * math.ceil((distance + 100 / s + zone + 8) / 16)
    if sites > MAX_SITES:
        raise ParameterError(
            "coupling c", coupling, f"small enough for a window of {MAX_SITES} sites",
            "use the kinetic relation at such couplings",
        )  # fmt: skip
    return max(sites, 32)


def widened(state: ChainState, sites: int) -> ChainState:
    """Return the state in a window of at least ``sites`` sites, padded with 1 and 0."""
    extra = max(sites - len(state.phi), 0)
    behind, ahead = extra // 2, extra - extra // 2
    on, latest = state.on, state.latest
    return ChainState(
        np.pad(state.phi, (behind, ahead), constant_values=(1, 0)),
        state.origin - behind,
        None if on is None else np.pad(on, (behind, ahead), constant_values=(True, False)),
        None if latest is None else latest + behind,
    )


def step_state(sites: int) -> ChainState:
    """Return a step: phi = 1 for site numbers n <= 0 and 0 beyond, out of equilibrium at both."""
    front = sites // 2 - sites // 8
    return ChainState((np.arange(sites) <= front).astype(np.complex128), -front)


def static_state(coupling: float, sites: int) -> ChainState:
    """Return a resting start: the equilibrium of (44) with the force on for n <= 0 and off beyond.

    Up to ``c_pin`` it is consistent with the threshold; beyond, site 1 (or 0) lies past it.
    """
    front = sites // 2 - sites // 8
    rates, _ = _mode_data(coupling, sites)
    slots = np.arange(sites)
    force = 0.5 * ((slots <= front) + slots / sites)
    return ChainState(np.fft.ifft(np.fft.fft(force) / -rates) - slots / sites, -front)


def _mode_data(coupling: float, sites: int) -> tuple[ComplexArray, FloatArray]:
    k = 2 * np.pi * np.arange(sites) / sites
    return (-0.5 + 1j * coupling * (1 - np.cos(k))).astype(np.complex128), k


def _spectrum_at_switching(
    coupling: float, velocity: float, sites: int, front: int
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    rates, k = _mode_data(coupling, sites)
    slots = np.arange(sites)
    equilibrium = np.fft.fft(0.5 * ((slots <= front) + slots / sites)) / -rates
    direction = 1 if velocity > 0 else -1
    growth = np.exp(rates / abs(velocity))
    shift = np.zeros(sites)
    shift[0] = direction
    spectrum = (equilibrium * (1 - growth) - shift) / (np.exp(-1j * direction * k) - growth)
    return spectrum, equilibrium, rates


def travelling_state(coupling: float, velocity: float, sites: int) -> ChainState:
    """Return a moving start: the wave that switches every ``1/|velocity|``, half a period later.

    Each mode of (44) repeats itself, shifted by one site, after one period, which determines it.
    The velocity need not satisfy the kinetic relation (54); it then changes during the run.
    """
    front = sites // 2 - sites // 8
    spectrum, equilibrium, rates = _spectrum_at_switching(coupling, velocity, sites, front)
    later = equilibrium + (spectrum - equilibrium) * np.exp(0.5 * rates / abs(velocity))
    phi = np.fft.ifft(later) - np.arange(sites) / sites
    return ChainState(phi, -front)


def switching_amplitude(coupling: float, velocity: float) -> float:
    """``|phi|`` of a site at the moment when the wave of :func:`travelling_state` switches it."""
    sites = window_length(coupling, velocity, 1e-9)
    front = sites // 2
    spectrum, _, _ = _spectrum_at_switching(coupling, velocity, sites, front)
    site = front if velocity > 0 else front + 1
    k = 2 * np.pi * np.arange(sites) / sites
    return float(abs(np.mean(spectrum * np.exp(1j * k * site)) - site / sites))


def starting_velocity(coupling: float, threshold: float) -> float:
    """Velocity for a moving start: five per cent above the fastest wave that fits the threshold.

    Waves are tried in a range of velocities that contains the fastest one unless the threshold is
    small. If no advancing wave fits, the fastest retreating one is taken; if none fits at all, the
    advancing one that comes nearest.
    """
    speeds = np.geomspace(0.05, 6.0, 48) * coupling / (1 + 0.3 * math.sqrt(coupling))
    for direction in (1, -1):
        excess = [switching_amplitude(coupling, direction * u) - threshold for u in speeds]
        for i in range(len(speeds) - 2, -1, -1):
            if excess[i] * excess[i + 1] < 0:
                part = excess[i] / (excess[i] - excess[i + 1])
                return float(1.05 * direction * (speeds[i] + part * (speeds[i + 1] - speeds[i])))
        if direction == 1:
            nearest = float(speeds[int(np.argmin(np.abs(excess)))])
    return nearest
