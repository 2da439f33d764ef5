"""(8) and (43) written once more, for scipy: references share no right side with the steppers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from theory.chains.vdp import VdpChain

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


def full_rate(chain: VdpChain, wave: bool = False) -> Callable[[float, FloatArray], FloatArray]:
    """Return d(y, ẏ)/dt of (8) with free ends, for states (y, ẏ) of shape (2N,).

    With ``wave`` a wave goes on to the left of the first site, a quarter of a turn a site: y_0 is
    ẏ_1 there.
    """
    a, b, c, eps = chain.a, chain.b, chain.c, chain.eps

    def rate(_: float, state: FloatArray) -> FloatArray:
        y, w = np.split(state, 2)
        left = np.concatenate([w[:1] if wave else y[:1], y[:-1]])
        right = np.concatenate([y[1:], y[-1:]])
        square = y * y
        damping = eps * w * (1.0 - a * square + b * square * square)
        return np.concatenate([w, -y - eps * c * (2.0 * y - left - right) - damping])

    return rate


def averaged_rate(chain: VdpChain) -> Callable[[float, ComplexArray], ComplexArray]:
    """Return dφ/dT of (43) with free ends, shape (N,)."""
    a, b, c = chain.a, chain.b, chain.c

    def rate(_: float, phi: ComplexArray) -> ComplexArray:
        pull = -np.diff(phi, prepend=phi[:1], append=phi[-1:], n=2)
        s = np.abs(phi) ** 2
        out: ComplexArray = 0.5j * c * pull - 0.5 * phi * (1 - a * s / 4 + b * s**2 / 8)
        return out

    return rate


def as_state(psi: ComplexArray) -> FloatArray:
    """Return (y, ẏ), shape (2N,), of Ψ = ẏ + iy."""
    return np.concatenate([psi.imag, psi.real])


def amplitude_of(state: FloatArray) -> FloatArray:
    """Return |Ψ|, shape (N, ...), of states (y, ẏ) of shape (2N, ...)."""
    amplitude: FloatArray = np.hypot(*np.split(state, 2))
    return amplitude
