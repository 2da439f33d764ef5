"""Numbers from the modulation equations: the steady breather of nucleus one, to second order.

At leading order ``2 i A_n = (-i)^{|n|} r_n e^{i eps c t}`` with real r_n. The next order moves the
frequency, the amplitudes and the phases; all three are linear solves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import root

from derivations.algebra.harmonics import Coefficient, HarmonicRing
from derivations.algebra.modulation import Modulation


@dataclass(frozen=True)
class BreatherCorrection:
    """``omega = 1 + eps c + eps^2 omega_2``; the amplitude of site n is ``r_n + eps p_n``.

    Attributes
    ----------
    amplitudes : ndarray, shape (sites,)
        r_n for n = 0, 1, ….
    amplitude_corrections : ndarray, shape (sites,)
        p_n: change of the amplitude of the fundamental of y_n.
    phase_corrections : ndarray, shape (sites,)
        q_n / r_n in radians a unit of eps, beyond the steps of -pi/2; zero at the centre.
    omega_2 : float
        Second-order change of the frequency.
    """

    amplitudes: Any
    amplitude_corrections: Any
    phase_corrections: Any
    omega_2: float


def numeric(
    ring: HarmonicRing, coefficient: Coefficient, sites: Mapping[int, Any], given: Mapping[str, Any]
) -> Any:
    """Evaluate a coefficient at amplitudes (scalars or arrays) by offset and named parameters."""
    values = [sites[place - ring.reach] for place in range(len(ring.amplitudes))]
    values = values + [np.conj(q) for q in values]
    values += [given[symbol.name] for symbol in ring.parameters]
    total: Any = 0j
    for powers, number in coefficient.items():
        term: Any = complex(float(number.x), float(number.y))
        for power, found in zip(powers, values, strict=True):
            if power:
                term = term * found**power
        total = total + term
    return total


def breather(
    modulation: Modulation, given: Mapping[str, float], sites: int = 9
) -> BreatherCorrection:
    """Second-order correction of the breather of nucleus one.

    Parameters
    ----------
    modulation : Modulation
        Of the chain of Eq. (8) at second order, from either route.
    given : mapping of str to float
        Values of a, b and c, below the fold where the breather ends.
    sites : int
        Sites kept on one side; the amplitude decays by about c a site.

    Raises
    ------
    ArithmeticError
        If no steady breather was found.
    """
    ring = modulation.ring
    # A route in phi gives y = Im(phi e^{it}): phi itself turns by -pi/2 a site. In A it is 2 i A.
    by_phi = ring.amplitudes[0].name.startswith(r"\varphi")
    scale = 1.0 if by_phi else -0.5j
    phases = scale * (-1j) ** np.arange(sites)

    def rate(coefficient: Coefficient, r: Any) -> Any:
        wave = r * phases
        padded = np.concatenate([wave[2:0:-1], wave, [0, 0]])
        reach = ring.reach
        near = {o: padded[2 + o : 2 + o + sites] for o in range(-reach, reach + 1)}
        return numeric(ring, coefficient, near, given) / phases

    def steady(r: Any) -> Any:
        return rate(modulation.first, r).real

    a, b, c = (given[name] for name in "abc")
    start = np.sqrt((a + np.sqrt(a * a - 8 * b)) / b) * (1.05 * c) ** np.arange(sites)
    solved = root(steady, start, tol=1e-14)
    r = solved.x
    if np.abs(steady(r)).max() > 1e-10 or r[0] < r[1]:
        raise ArithmeticError("no steady breather at these parameters")
    # The turning of the frame, i c, moves neither the real part along r nor the imaginary across.
    along = _jacobian(steady, r)
    across = _jacobian(lambda q: rate(modulation.first, r + 1j * q).imag, np.zeros(sites))
    push = rate(modulation.second, r)
    real_part = np.linalg.solve(along, -push.real)
    # across q - omega_2 r = -push.imag with q_0 = 0; r itself is the null vector of across.
    bordered = np.zeros((sites + 1, sites + 1))
    bordered[:sites, :sites], bordered[:sites, sites], bordered[sites, 0] = across, -r, 1
    found = np.linalg.solve(bordered, np.append(-push.imag, 0))
    if by_phi:
        shift = _fundamental_shift(modulation, given, r, phases)
        real_part = real_part + shift.real
        found[:sites] += shift.imag - shift.imag[0] / r[0] * r
    return BreatherCorrection(r, real_part, found[:sites] / r, float(found[sites]))


def _fundamental_shift(
    modulation: Modulation, given: Mapping[str, float], r: Any, phases: Any
) -> Any:
    """Return what the oscillating part of phi adds to the fundamental of y, per eps, like r."""
    ring = modulation.ring
    shift = -ring.conjugate(modulation.correction.coefficient(-2))
    wave = r * phases
    padded = np.concatenate([wave[2:0:-1], wave, [0, 0]])
    near = {o: padded[2 + o : 2 + o + len(r)] for o in range(-ring.reach, ring.reach + 1)}
    return numeric(ring, shift, near, given) / phases


def _jacobian(function: Any, at: Any, step: float = 1e-6) -> Any:
    """Central differences; the functions are polynomials of low degree."""
    columns = [(function(at + step * row) - function(at - step * row)) / (2 * step)
               for row in np.eye(len(at))]  # fmt: skip
    return np.array(columns).T
