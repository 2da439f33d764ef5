"""A direct run of Model II, by (8) or by its averaged form (43): steps, samples, arrivals.

Both are stepped by the Runge-Kutta method of order 8, the fastest of those measured
(``benchmarks/``). Where steps would become too short because the damping is stiff (a site
displaced far beyond the cycle), ``verification.steppers.stiff_stage`` takes over until they would
not. The error comes from two companions (``verification.runs.comparison``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.chains.chain import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, end_time, positive, within
from verification.execution.checkpoint import check_samples, run_to_end
from verification.runs.comparison import (
    ROUNDINGS,
    arrival_error_from,
    companion_tolerances,
    error_from,
)
from verification.runs.vdp_integration import Lane

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


class Model(StrEnum):
    """Which equation is stepped."""

    FULL = "full"
    """(8)."""

    ENVELOPE = "envelope"
    """(43)."""


@dataclass(frozen=True)
class VdpRun:
    """What a run has seen.

    Attributes
    ----------
    chain : VdpChain
        Parameters.
    model : Model
        Equation.
    times : ndarray, shape (M,)
        Times t (not slow time) of the samples.
    psi : ndarray of complex, shape (M, N)
        Ψ = ẏ + iy at those times; for the envelope φ.
    arrivals : ndarray, shape (N,)
        Time t at which |Ψ| first reached ``level``; nan where it did not.
    level : float
        Amplitude that counts as an arrival.
    error : float or None
        Bound on the error of ``psi``, from the companions; None if there were none. Where the
        stiff method has run, at least a tenth of its tolerance times the largest |Ψ(0)|.
    arrival_error : float or None
        The same of ``arrivals``; inf if one run saw an arrival that the other did not.
    tolerance : float
        Local error, relative to the largest |Ψ|.
    steps, stiff_steps : int
        Explicit steps, and steps of the stiff method.
    mean_active : float
        Sites stepped, averaged over the steps.
    seconds : float
        Run time, of all sessions if it was resumed.
    """

    chain: VdpChain
    model: Model
    times: FloatArray
    psi: ComplexArray
    arrivals: FloatArray
    level: float
    error: float | None
    arrival_error: float | None
    tolerance: float
    steps: int
    stiff_steps: int
    mean_active: float
    seconds: float

    @property
    def amplitude(self) -> FloatArray:
        """|Ψ|, shape (M, N): the envelope of y, up to a ripple of O(ε) for (8)."""
        return np.abs(self.psi)

    @property
    def phase(self) -> FloatArray:
        """Phase of φ in radians, shape (M, N); for (8) of Ψe^{-it}."""
        turn = np.exp(-1j * self.times)[:, None] if self.model is Model.FULL else 1.0
        return np.angle(self.psi * turn)

    @property
    def width(self) -> npt.NDArray[np.int64]:
        """Number of sites above the level at each sample, shape (M,)."""
        width: npt.NDArray[np.int64] = np.count_nonzero(self.amplitude > self.level, axis=1)
        return width


def run_vdp(
    chain: VdpChain,
    start: ComplexArray,
    t_end: float,
    *,
    model: Model = Model.FULL,
    tolerance: float = 1e-9,
    samples: int = 201,
    level: float | None = None,
    window: bool = True,
    behind: int = 0,
    companion: bool = True,
    checkpoint: Path | None = None,
    progress: Callable[[float], None] | None = None,
    budget: int = 2_000_000,
) -> VdpRun:
    """Run the chain from t = 0 to ``t_end``.

    Parameters
    ----------
    chain : VdpChain
        Parameters of (8).
    start : ndarray of complex, shape (N,)
        Ψ(0) = ẏ + iy (``verification.runs.vdp_start``).
    t_end : float
        Time t, positive, at most 1e9; slow time is εt.
    model : Model
        (8), or (43).
    tolerance : float
        Local error relative to the largest |Ψ|, from 1e-14 to 1e-2.
    samples : int
        States kept, evenly spaced from 0 to ``t_end``; at least 2.
    level : float, optional
        Amplitude of an arrival; by default the unstable cycle of one cell.
    window : bool
        Leave sites out while they and their neighbours are at rest to within the tolerance. The run
        is then changed by less than a tenth of the tolerance, relative to the largest |Ψ|.
    behind : int
        Keep only so many sites behind the foremost arrival of a front that runs to larger n; the
        last one kept is coupled to a continued wave. 0 keeps all. What is left behind stays as it
        was in later samples.
    companion : bool
        Run two companions beside it, for the error.
    checkpoint : Path, optional
        File in which the run is kept every few seconds and when it is interrupted. If it exists,
        the run goes on from it, to the same bits.
    progress : callable, optional
        Told the fraction done, now and then.
    budget : int
        Sites times steps between two looks at the clock.

    Raises
    ------
    ParameterError
        If a parameter is out of range, the start does not fit, or the checkpoint belongs to
        another run.

    Examples
    --------
    >>> from verification.runs.vdp_start import displaced
    >>> chain = VdpChain(a=4, b=0.5, c=0.6, sites=5)
    >>> run = run_vdp(chain, displaced(chain, [1]), 50.0, samples=2)
    >>> run.psi.shape, run.error < 1e-5
    ((2, 5), True)
    """
    begin = perf_counter()
    end_time("end time t", t_end)
    within("tolerance", tolerance, 1e-14, 1e-2)
    check_samples(samples, chain.sites)
    psi = np.asarray(start, dtype=complex)
    if psi.shape != (chain.sites,) or not np.all(np.isfinite(psi)):
        raise ParameterError(
            "start", f"an array of shape {psi.shape}", f"{chain.sites} finite numbers",
            "give one complex number a site",
        )  # fmt: skip
    if behind and chain.ends is Ends.PERIODIC:
        raise ParameterError("sites kept behind", behind, "0 on a ring", "take free ends")
    threshold = chain.unstable_amplitude if level is None else positive("level", level)
    runs = [(tolerance, psi)]
    if companion:
        moved = psi * (1.0 + ROUNDINGS * np.finfo(float).eps)
        runs += zip(companion_tolerances(tolerance), (moved, psi), strict=True)
    times = np.linspace(0.0, t_end, int(samples))
    lanes = [
        Lane(chain, model is Model.FULL, each_psi, times, each, threshold, window, behind)
        for each, each_psi in runs
    ]
    spent = run_to_end(lanes, t_end, budget, checkpoint, progress)
    first = lanes[0]
    error = arrival_error = None
    if companion:
        others = lanes[1:]
        error = error_from(first.psi, [other.psi for other in others])
        if first.stiff_steps:
            from verification.steppers.stiff_stage import least_error

            error = max(error, least_error(tolerance, float(np.abs(psi).max())))
        arrival_error = arrival_error_from(first.arrivals, [other.arrivals for other in others])
    steps = int(first.counters[3])
    return VdpRun(
        chain,
        model,
        times,
        first.psi,
        first.arrivals,
        threshold,
        error,
        arrival_error,
        tolerance,
        steps,
        first.stiff_steps,
        float(first.counters[4]) / max(1, steps),
        spent + perf_counter() - begin,
    )
