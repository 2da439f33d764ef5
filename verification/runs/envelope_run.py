"""Runs of the averaged chain (43) in slow time at equal steps, with fixed or growing coupling.

The coupling may grow linearly, c = c_0 + rate·T; within a step its value at the midpoint is used. A
mirror-symmetric start stays symmetric to the last bit. The loop is that of every smooth chain
(``verification.steppers.smooth``), with escape as its stop condition.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from theory.arrays import BoolArray, ComplexArray, FloatArray
from theory.cells.vdp import attraction_rate
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError
from verification.runs.excite import as_psi
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers.kernel import fast
from verification.steppers.runge_kutta import Step

STEP = 0.1
"""Longest step in T of the method of order 8, for rates of order 1."""
_ATTRACTED = 2.0
"""Largest product of a step and the rate at which the stable cycle attracts, some 1/(2η): the
method is unstable from about 5."""
SMALLEST_ETA = 1e-5
"""Smallest η, at which a slow time of 1 takes 25 000 steps."""


@dataclass(frozen=True, kw_only=True)
class EnvelopeRun:
    """The final state of a run.

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

    phi: ComplexArray
    time: float
    escaped: bool
    coupling: float
    steps: int


@fast
def escape(  # noqa: PLR0917  (as a Condition)
    take_step: Step,
    t: float,
    h: float,
    before: FloatArray,
    after: FloatArray,
    parameters: FloatArray,
    K: FloatArray,
    work: FloatArray,
    memory: FloatArray,
) -> int:
    """Return 1 once the amplitude of a watched site passes a limit.

    ``memory`` is the square of the limit, then for each site whether it is watched.
    """
    m = after.size // 2
    for n in range(m):
        if memory[1 + n] > 0.0 and not after[n] ** 2 + after[m + n] ** 2 <= memory[0]:
            return 1
    return 0


def run_envelope(
    chain: VanDerPolChain,
    phi: ComplexArray,
    duration: float,
    *,
    rate: float = 0.0,
    watched: BoolArray | None = None,
    limit: float = np.inf,
) -> EnvelopeRun:
    """Integrate (43) until ``duration`` or until a watched site passes the limit.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        The chain: a, b, c at T = 0, and the ends.
    phi : complex array, shape (N,)
        Envelope at T = 0.
    duration : float
        Slow time.
    rate : float, optional
        dc/dT.
    watched : bool array, optional
        Sites whose amplitude may not exceed ``limit``; all by default.
    limit : float, optional
        Amplitude that ends the run.

    Raises
    ------
    ParameterError
        If η is below `SMALLEST_ETA`.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> chain = AveragedChain(a=2.5, b=0.5, c=0.1, sites=5)
    >>> start = np.full(5, 2.5, dtype=complex)
    >>> round(float(abs(run_envelope(chain, start, 100.0).phi[2])), 6)
    2.828427
    """
    if chain.eta < SMALLEST_ETA:
        raise ParameterError(
            "eta = b/a^2", chain.eta, f"at least {SMALLEST_ETA:g} for runs of (43) at equal steps",
            "take the method envelope, or a larger eta",
        )  # fmt: skip
    averaged = chain.averaged()
    mask = np.ones(chain.sites) if watched is None else np.asarray(watched, dtype=float)
    stable_step = _ATTRACTED / attraction_rate(chain.eta) if chain.bistable else STEP
    steps = max(1, round(duration / min(STEP, stable_step)))
    run = SmoothIntegration(
        averaged,
        np.asarray(phi, dtype=complex),
        [duration / chain.eps],
        level=np.inf,
        active_window=False,
        drift={"c": rate * chain.eps} if rate else None,
        step=duration / steps,
        watch=escape,
        memory=np.concatenate([[limit**2], mask]),
    )
    run.finish()
    escaped = bool(run.outcome)
    time = chain.eps * run.time if escaped else duration
    return EnvelopeRun(
        phi=as_psi(run.state if escaped else run.samples[-1]),
        time=time,
        escaped=escaped,
        coupling=chain.c + rate * time,
        steps=run.counts["steps"],
    )
