"""A breather of the averaged chain (43) by direct integration, from a perturbed start."""

from __future__ import annotations

import time

import numpy as np

from theory.averaged.breather import BreatherStatus
from theory.averaged.envelope import envelope_rate
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VanDerPolChain
from verification.breathers.result import Breather
from verification.breathers.run import BLOCK, NOISE, SLOW_TIME, TOLERANCE, at_end
from verification.runs.envelope_run import run_envelope


def run_averaged_breather(chain: VanDerPolChain, nucleus: Nucleus, *, seed: int = 0) -> Breather:
    """Integrate (43) from a prepared nucleus until it rotates as a whole.

    The drift is max |φ_n' - iΩφ_n| with Ω of the centre, from the equation and not from
    differences of states: it is zero on a breather, whatever the step of the run.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        a, b, c, ε and the ends.
    nucleus : Nucleus
        Excited sites and their phases at the start.
    seed : int, optional
        Of the noise on both parts of every φ_n.

    Returns
    -------
    Breather
        The end of the run: settled, unsettled or escaped. Its time is in t.

    Raises
    ------
    ParameterError
        If the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> run = run_averaged_breather(AveragedChain(a=2.5, b=0.5, c=0.1, sites=7), Nucleus(1))
    >>> run.status.value, round(run.frequency, 6)
    ('settled', 1.001)
    """
    started = time.perf_counter()
    centre, outside = nucleus.centre(chain.sites), nucleus.outside(chain.sites)
    parts = np.random.default_rng(seed).normal(size=(2, chain.sites))
    phi = nucleus.envelope(chain) + NOISE * (parts[0] + 1j * parts[1])
    status, elapsed, drifts, rotation = BreatherStatus.UNSETTLED, 0.0, [], 0.0
    while elapsed < SLOW_TIME and status is BreatherStatus.UNSETTLED:
        run = run_envelope(chain, phi, BLOCK, watched=outside, limit=chain.unstable_amplitude)
        phi, elapsed = run.phi, elapsed + run.time
        rate = envelope_rate(phi, chain)
        rotation = float((rate[centre] / phi[centre]).imag)
        drifts.append(float(np.abs(rate - 1j * rotation * phi).max()))
        if run.escaped:
            status = BreatherStatus.ESCAPED
        elif drifts[-1] < TOLERANCE:
            status = BreatherStatus.SETTLED
    return at_end(
        chain,
        nucleus,
        status,
        drifts,
        waves=phi,
        amplitudes=np.abs(phi),
        frequency=1.0 + chain.eps * rotation,
        elapsed=elapsed / chain.eps,
        started=started,
    )
