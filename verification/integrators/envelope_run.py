"""Plain runs of the averaged chain (43) in slow time: the classical Runge-Kutta rule, compiled.

The sum of neighbours is formed before it is subtracted, so a mirror-symmetric start stays
symmetric to the last bit. The coupling may grow linearly, c = c_0 + rate·T.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from theory.vdp_chain import Ends, VdpChain

Complex = NDArray[np.complex128]

STEP = 0.04
"""Step in T; rates are of order 1. Tests hold the error of a run to scipy's DOP853."""


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
    state = np.array(phi, dtype=np.complex128)
    mask = np.ones(chain.sites, dtype=np.bool_) if watched is None else watched
    steps = max(1, round(duration / step))
    done, escaped = _run(
        state,
        mask,
        limit**2,
        chain.c,
        rate,
        duration / steps,
        steps,
        chain.a,
        chain.b,
        chain.ends is Ends.PERIODIC,
    )
    time = done * duration / steps
    return EnvelopeRun(state, time, bool(escaped), chain.c + rate * time, int(done))


@njit(cache=True)  # type: ignore[misc, unused-ignore]
def _rate(phi, out, c, a, b, ring):  # type: ignore[no-untyped-def]
    sites = phi.shape[0]
    for n in range(sites):
        own = phi[n]
        around = 0.0 + 0.0j
        count = 2.0
        if 0 < n < sites - 1:
            around = phi[n - 1] + phi[n + 1]
        elif ring:
            around = phi[(n + sites - 1) % sites] + phi[(n + 1) % sites]
        else:
            count = 1.0
            around = phi[1] if n == 0 else phi[sites - 2]
        s = own.real * own.real + own.imag * own.imag
        out[n] = 0.5j * c * (count * own - around) - own * (
            0.5 * (1.0 - 0.25 * a * s + 0.125 * b * s * s)
        )


@njit(cache=True)  # type: ignore[misc, unused-ignore]
def _run(phi, watched, limit, c, speed, h, steps, a, b, ring):  # type: ignore[no-untyped-def]
    sites = phi.shape[0]
    k1 = np.empty(sites, dtype=np.complex128)
    k2 = np.empty(sites, dtype=np.complex128)
    k3 = np.empty(sites, dtype=np.complex128)
    k4 = np.empty(sites, dtype=np.complex128)
    for done in range(steps):
        start = c + speed * h * done
        _rate(phi, k1, start, a, b, ring)
        _rate(phi + 0.5 * h * k1, k2, start + 0.5 * h * speed, a, b, ring)
        _rate(phi + 0.5 * h * k2, k3, start + 0.5 * h * speed, a, b, ring)
        _rate(phi + h * k3, k4, start + h * speed, a, b, ring)
        for n in range(sites):
            phi[n] += h / 6.0 * ((k1[n] + k4[n]) + 2.0 * (k2[n] + k3[n]))
        for n in range(sites):
            if watched[n]:
                s = phi[n].real * phi[n].real + phi[n].imag * phi[n].imag
                if not s <= limit:
                    return done + 1, True
    return steps, False
