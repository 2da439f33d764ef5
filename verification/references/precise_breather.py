"""Breathers of (43), phase-locked states φ_n e^{iΩT}, and their folds, in extended precision.

    0 = (ic/2)(2φ_n - φ_{n-1} - φ_{n+1}) - (φ_n/2)(1 - |φ_n|²/4 + η|φ_n|⁴/8) - iΩφ_n,

with Im φ = 0 at the site of the largest amplitude, at a = 1, b = η. Newton's matrix is computed by
finite differences and its residual in long doubles, so that the limit has the accuracy of the
latter.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from theory.arrays import AnyArray
from verification.references.equations import averaged_damping, pull
from verification.references.extrapolation import PreciseState, extended
from verification.references.pace import NoReferenceError

Defect = Callable[[AnyArray], AnyArray]

_STEP = 1e-5
"""Step of the finite differences."""

_UNIT = float(np.finfo(np.longdouble).eps)
_MAX_ITERATIONS = 30


def locked_state(eta: float, c: float, phi: AnyArray, omega: float) -> PreciseState:
    """Return the phase-locked state closest to a given one.

    Parameters
    ----------
    eta, c : float
        η and coupling, dimensionless.
    phi : complex ndarray, shape (N,)
        Starting point of Newton's method.
    omega : float
        Ω at the starting point, per unit T.

    Returns
    -------
    PreciseState
        (Re φ, Im φ, Ω), shape (2N + 1,).

    Raises
    ------
    NoReferenceError
        If Newton's method does not converge.

    Examples
    --------
    >>> alone = locked_state(0.08, 0.0, np.array([4.5 + 0j]), 0.0)
    >>> eta = np.longdouble(0.08)
    >>> bool(abs(alone.value[0] - np.sqrt((1 + np.sqrt(1 - 8 * eta)) / eta)) <= alone.uncertainty)
    True
    >>> alone.uncertainty < 1e-16
    True
    """
    centre = int(np.argmax(np.abs(phi)))

    def defect(x: AnyArray) -> AnyArray:
        return _defect(x, eta, c, centre)

    x, inverse = _newton(defect, extended([*phi.real, *phi.imag, omega]))
    rounding = np.abs(inverse) @ _rounding(x, eta, c)
    return PreciseState(value=x, uncertainty=float(rounding.max()))


def locked_fold(eta: float, c: float, phi: AnyArray, omega: float) -> PreciseState:
    """Return the mirror-symmetric state at the fold that ends a branch, and its coupling.

    The equations are those of a state, together with the condition that their matrix maps a vector
    q to zero.

    Parameters
    ----------
    eta, c, phi, omega
        As in `locked_state`, near the fold.

    Returns
    -------
    PreciseState
        (Re φ, Im φ, Ω, c), shape (2N + 2,); its uncertainty is that of c.

    Raises
    ------
    NoReferenceError
        If Newton's method does not converge.
    """
    centre, keep, whole = int(np.argmax(np.abs(phi))), *_mirrored(phi.size)
    size = keep.size

    def locked(x: AnyArray, c: Any) -> AnyArray:
        return _defect(x[whole], eta, c, centre)[keep]

    def along(x: AnyArray, c: Any, q: AnyArray) -> AnyArray:
        """Return the derivative of the defect along q; its error hardly affects c."""
        return (locked(x + _STEP * q, c) - locked(x - _STEP * q, c)) / (2 * _STEP)

    start = extended([*phi.real, *phi.imag, omega])[keep]
    first = extended(np.linalg.svd(_differences(lambda x: locked(x, c), start))[2][-1])

    def defect(z: AnyArray) -> AnyArray:
        x, q, c = z[:size], z[size:-1], z[-1]
        return np.concatenate([locked(x, c), along(x, c, q), [np.dot(first, q) - 1]])

    z, inverse = _newton(defect, np.concatenate([start, first, extended([c])]))
    rounding = _rounding(z[:size][whole], eta, float(z[-1]))[keep]
    both = np.concatenate([rounding, rounding / _STEP, [_UNIT]])
    return PreciseState(
        value=np.append(z[:size][whole], z[-1]), uncertainty=float(np.abs(inverse[-1]) @ both)
    )


def _mirrored(sites: int) -> tuple[AnyArray, AnyArray]:
    """Return which of (Re φ, Im φ, Ω) suffice for a state, and the index of each entry among them.

    This excludes modes that break the mirror symmetry, which become neutral elsewhere.
    """
    half = (sites + 1) // 2
    near = np.minimum(np.arange(sites), np.arange(sites)[::-1])
    keep = np.concatenate([np.arange(half), sites + np.arange(half), [2 * sites]])
    return keep, np.concatenate([near, half + near, [2 * half]])


def _defect(x: AnyArray, eta: float, c: Any, centre: int) -> AnyArray:
    sites = x.size // 2
    phi, omega = x[:sites] + 1j * x[sites:-1], x[-1]
    rate = c * pull(phi) * 0.5j - phi * averaged_damping(np.abs(phi), 1, eta) / 2 - 1j * omega * phi
    return np.concatenate([rate.real, rate.imag, [x[sites + centre]]])


def _rounding(x: AnyArray, eta: float, c: float) -> AnyArray:
    """Return the rounding error of the defect: ten operations on the largest of its terms."""
    sites = x.size // 2
    r = np.abs(x[:sites] + 1j * x[sites:-1]).astype(float)
    largest = r * (1.0 + r**2 / 4.0 + eta * r**4 / 8.0 + abs(float(x[-1]))) + 4.0 * c * r.max()
    return np.asarray(10.0 * _UNIT * np.concatenate([largest, largest, [0.0]]))


def _differences(defect: Defect, x: AnyArray) -> AnyArray:
    columns = [
        (defect(x + _STEP * each) - defect(x - _STEP * each)) / (2 * _STEP)
        for each in np.eye(x.size)
    ]
    return np.array(columns).T.astype(float)


def _newton(defect: Defect, x: AnyArray) -> tuple[AnyArray, AnyArray]:
    """Return the root next to x and the inverse of the matrix there."""
    last = np.inf
    for _ in range(_MAX_ITERATIONS):
        inverse = np.linalg.inv(_differences(defect, x))
        step = inverse @ defect(x)
        x = x - step
        moved = float(np.abs(step).max())
        if moved == 0.0 or (last < 1e-12 * float(np.abs(x).max()) and moved > 0.1 * last):
            return x, inverse
        last = moved
    raise NoReferenceError("Newton's method does not converge in extended precision.")
