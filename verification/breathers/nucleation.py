"""What nuclei do when prepared as in section 2.2: in phase, near the cycle, at rest around.

Runs are of the averaged chain (43), in slow time, the coupling held. A nucleus *holds* while every
site outside it stays below the unstable cycle |φ_us|, and *escapes* when one passes.
A perturbation is seeded noise, the same relative size in both parts of every φ_n.

An escape tells that the breather of this size is lost, and at which coupling. It does not tell what
comes after: the run ends when the first new site passes, and the nucleus may then stand at a larger
size, grow by jumps or become a front. ``fate`` goes on from there, in (8).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from theory.chains.nucleus import MARGIN, Nucleus, Place, sites_for
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.runs.envelope_run import EnvelopeRun, run_envelope

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Preparation:
    """The start of a run.

    Attributes
    ----------
    size : int
        Excited sites, all in phase.
    place : Place
        Middle or edge of the chain.
    perturbation : float
        Standard deviation of the noise added to both parts of every φ_n; 0 for none.
    seed : int
        Seed of the noise.
    """

    size: int
    place: Place = Place.BULK
    perturbation: float = 0.0
    seed: int = 0

    def chain(self, chain: VdpChain, c: float) -> VdpChain:
        """Return the chain with `MARGIN` sites around the nucleus."""
        return replace(chain, sites=sites_for(self.size, MARGIN), c=c)

    def start(self, chain: VdpChain) -> Complex:
        """Return φ_n at T = 0, shape (N,)."""
        nucleus = Nucleus(self.size, "0" * (self.size - 1), self.place)
        phi = nucleus.envelope(chain)
        if self.perturbation > 0.0:
            noise = np.random.default_rng(self.seed).normal(size=(2, chain.sites))
            phi = phi + self.perturbation * (noise[0] + 1j * noise[1])
        return phi

    def outside(self, chain: VdpChain) -> NDArray[np.bool_]:
        """Return which sites are not excited."""
        first = Nucleus(self.size, "0" * (self.size - 1), self.place).first(chain.sites)
        mask = np.ones(chain.sites, dtype=np.bool_)
        mask[first : first + self.size] = False
        return mask


@dataclass(frozen=True)
class EscapeThreshold:
    """Smallest coupling found at which a prepared nucleus escapes.

    Attributes
    ----------
    c : float
        Middle of the last bracket.
    error : float
        Half the bracket, plus how much ``c`` falls when the runs are twice as long.
    duration : float
        Slow time of the longer runs.
    runs : int
        Runs made.
    seconds : float
        Wall-clock time.
    """

    c: float
    error: float
    duration: float
    runs: int
    seconds: float


def hold(chain: VdpChain, preparation: Preparation, c: float, duration: float) -> EnvelopeRun:
    """Run the averaged chain at a coupling until it escapes or the time is over.

    Examples
    --------
    >>> hold(VdpChain(a=2.5, b=0.5, c=0), Preparation(1), 0.2, 200.0).escaped
    True
    """
    here = preparation.chain(chain, c)
    return run_envelope(
        here,
        preparation.start(here),
        duration,
        watched=preparation.outside(here),
        limit=here.unstable_amplitude,
    )


def phase_steps(run: EnvelopeRun, preparation: Preparation) -> NDArray[np.float64]:
    """Return the phase steps inside the nucleus in units of π, from -1 to 1."""
    core = run.phi[~preparation.outside(VdpChain(a=1, b=0.1, c=0, sites=len(run.phi)))]
    return np.asarray(np.angle(core[1:] / core[:-1]) / np.pi, dtype=float)


def escape_threshold(
    chain: VdpChain,
    preparation: Preparation,
    low: float = 0.15,
    high: float = 0.25,
    duration: float = 2000.0,
    tolerance: float = 1e-6,
) -> EscapeThreshold:
    """Bisect for the coupling at which the prepared nucleus escapes within a time.

    Runs near a fold pass it ever more slowly, c - c_fold ~ duration⁻², so the bisection is done
    with ``duration`` and with half of it, and the difference is part of the error.

    Raises
    ------
    ParameterError
        If the nucleus escapes at ``low`` or holds at ``high``.
    """
    started = time.perf_counter()
    runs = 0

    def bisect(length: float) -> float:
        nonlocal runs
        below, above = low, high
        for c, wanted in ((below, False), (above, True)):
            runs += 1
            if hold(chain, preparation, c, length).escaped is not wanted:
                raise ParameterError(
                    "bracket",
                    f"[{low}, {high}]",
                    "such that the nucleus holds at its lower end and escapes at its upper end",
                    "widen it",
                )
        while above - below > tolerance:
            runs += 1
            middle = 0.5 * (below + above)
            if hold(chain, preparation, middle, length).escaped:
                above = middle
            else:
                below = middle
        return 0.5 * (below + above)

    short, c = bisect(0.5 * duration), bisect(duration)
    error = 0.5 * tolerance + abs(short - c)
    return EscapeThreshold(c, error, duration, runs, time.perf_counter() - started)
