"""Runs of the averaged chain (43) in slow time by equal steps, the coupling fixed or growing.

The coupling may grow linearly, c = c_0 + rate·T; within a step it is held at the value of the
middle. A mirror-symmetric start stays symmetric to the last bit (``active.add_coupling``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from theory.chains.chain import Ends
from theory.chains.vdp import VdpChain
from verification.execution.compiled import njit
from verification.steppers.active import FREE, RING, end_codes
from verification.steppers.rows import put
from verification.steppers.runge_kutta import STAGES, take_step
from verification.steppers.slopes import ENVELOPE

FloatArray = NDArray[np.float64]
Complex = NDArray[np.complex128]

STEP = 0.1
"""Step in T of the method of order 8; rates are of order 1."""


@dataclass(frozen=True)
class EnvelopeRun:
    """The end of a run.

    Attributes
    ----------
    phi : complex array, shape (N,)
        Envelope at the end.
    time : float
        Slow time at the end.
    escaped : bool
        Whether a watched site passed the limit, which ended the run.
    coupling : float
        c at the end.
    steps : int
        Steps taken.
    """

    phi: Complex
    time: float
    escaped: bool
    coupling: float
    steps: int


def run_envelope(
    chain: VdpChain,
    phi: Complex,
    duration: float,
    *,
    rate: float = 0.0,
    watched: NDArray[np.bool_] | None = None,
    limit: float = np.inf,
    step: float = STEP,
) -> EnvelopeRun:
    """Integrate (43) until ``duration`` or until a watched site passes the limit.

    Parameters
    ----------
    chain : VdpChain
        a, b, c at T = 0 and the ends.
    phi : complex array, shape (N,)
        Envelope at T = 0.
    duration : float
        Slow time.
    rate : float, optional
        dc/dT.
    watched : bool array, optional
        Sites whose amplitude may not pass ``limit``; all by default.
    limit : float, optional
        Amplitude that ends the run.
    step : float, optional
        Step in T.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=5)
    >>> start = np.full(5, 2.5, dtype=complex)
    >>> round(float(abs(run_envelope(chain, start, 100.0).phi[2])), 6)
    2.828427
    """
    state = np.concatenate([np.real(phi), np.imag(phi)]).astype(float)
    mask = np.ones(chain.sites, dtype=np.bool_) if watched is None else watched
    steps = max(1, round(duration / step))
    h = duration / steps
    parameters = np.array([chain.a, chain.b, chain.c, chain.eps])
    done, escaped = _run(
        state,
        parameters,
        RING if chain.ends is Ends.PERIODIC else FREE,
        mask,
        limit**2,
        rate,
        h,
        steps,
    )
    real, imaginary = np.split(state, 2)
    time = done * h
    return EnvelopeRun(real + 1j * imaginary, time, bool(escaped), chain.c + rate * time, int(done))


@njit(cache=True)
def _run(
    x: FloatArray,
    parameters: FloatArray,
    first: int,
    watched: NDArray[np.bool_],
    limit: float,
    rate: float,
    h: float,
    steps: int,
) -> tuple[int, bool]:
    """Step; return the number of steps and whether a watched |φ|² has passed the limit."""
    m = x.size // 2
    left, right = end_codes(0, m, m, first, False)
    K, out = np.zeros((STAGES, x.size)), np.zeros(x.size)
    c = parameters[2]
    for done in range(steps):
        parameters[2] = c + rate * h * (done + 0.5)
        take_step(ENVELOPE, x, parameters, left, right, h, K, out)
        put(out, x)
        for n in range(m):
            if watched[n] and not x[n] ** 2 + x[m + n] ** 2 <= limit:
                return done + 1, True
    return steps, False
