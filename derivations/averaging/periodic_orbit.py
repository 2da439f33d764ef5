"""Exact periodic orbits of the cell and of the chain, by collocation in time.

They do not use that eps is small and test every prediction of the second order. Newton's method is
applied to equally spaced samples of one period, with spectral derivatives, so that the error is
that of rounding once the samples resolve the orbit. All quantities are dimensionless.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from derivations.chain_numbers import ChainNumbers

_MAX_NEWTON = 30
"""Largest number of Newton steps."""


def orbit(start: Any, frequency: float, p: ChainNumbers) -> tuple[Any, float]:
    """Find a periodic orbit of (8) on a half chain, mirrored at site 0 and ending at rest.

    Parameters
    ----------
    start : ndarray, shape (sites, samples)
        Initial displacements over one period.
    frequency : float
        Initial frequency.
    p : ChainNumbers
        Coefficients, springs and eps.

    Returns
    -------
    orbit : ndarray, shape (sites, samples)
        Displacements; at time 0 the fundamental of site 0 is a sine.
    frequency : float

    Raises
    ------
    ArithmeticError
        If Newton's method does not converge.
    """
    sites, samples = start.shape
    first = _derivative(samples)
    second = first @ first
    springs = np.eye(sites) + p.eps * _springs(sites, p)
    # Phase: the cosine part of the fundamental of site 0 vanishes.
    phase = np.cos(2 * np.pi * np.arange(samples) / samples)
    y, w, size = start.copy(), frequency, sites * samples
    close = False
    for _ in range(_MAX_NEWTON):
        rate, factor = y @ first.T, polyval(y, p.damping)
        pull = p.eps * polyval(y, p.stiffness or (0.0,))
        residual = w * w * (y @ second.T) + springs @ y + p.eps * w * rate * factor + pull
        matrix = np.zeros((size + 1, size + 1))
        matrix[:size, :size] = np.kron(np.eye(sites), w * w * second) + np.kron(
            springs, np.eye(samples)
        )
        slope = polyval(y, polyder(p.damping))
        stiffer = p.eps * polyval(y, polyder(p.stiffness or (0.0,)))
        for site in range(sites):
            block = slice(site * samples, (site + 1) * samples)
            matrix[block, block] += (
                p.eps * w * (factor[site][:, None] * first + np.diag(rate[site] * slope[site]))
            ) + np.diag(stiffer[site])
        matrix[:size, size] = (2 * w * (y @ second.T) + p.eps * rate * factor).ravel()
        matrix[size, :samples] = phase
        change = np.linalg.solve(matrix, -np.append(residual.ravel(), phase @ y[0]))
        y, w = y + change[:size].reshape(y.shape), w + change[size]
        if close:  # one more step has squared the error, so that only rounding is left
            return y, float(w)
        close = bool(np.abs(change[:size]).max() < 1e-8 * np.abs(y).max())
    raise ArithmeticError("Newton's method did not converge to a periodic orbit")


def _springs(sites: int, p: ChainNumbers) -> Any:
    """Return the stiffness matrix of a half chain mirrored at site 0, with rest beyond its end."""
    matrix = np.zeros((sites, sites))
    if sites == 1:
        return matrix  # an isolated cell
    for j, spring in enumerate(p.springs, start=1):
        for site in range(sites):
            matrix[site, site] += 2 * spring
            for other in (site + j, abs(site - j)):
                if other < sites:
                    matrix[site, other] -= spring
    return matrix


def harmonic(y: Any, number: int) -> Any:
    """Return the complex coefficient of ``e^{i number w t}``, shape of y without its last axis."""
    return np.fft.fft(y, axis=-1)[..., number] / y.shape[-1]


def _derivative(samples: int) -> Any:
    """Return the spectral differentiation matrix on an odd number of equal samples of 2 pi."""
    if samples % 2 == 0:
        raise ValueError("an odd number of samples is needed")
    column = np.zeros(samples)
    steps = np.arange(1, samples)
    column[1:] = 0.5 * (-1.0) ** steps / np.sin(np.pi * steps / samples)
    return np.array([np.roll(column, shift) for shift in range(samples)]).T
