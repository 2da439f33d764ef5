"""Nuclei prepared as in section 2.2: in phase, near the cycle, with the other sites at rest.

Runs are of the averaged chain (43) in slow time, at constant coupling. A nucleus *holds* while
every site outside it stays below the unstable cycle |φ_us|, and *escapes* when one passes it. A
perturbation is seeded noise of the same relative size in the real and imaginary part of every φ_n.

Escape shows that a breather of this size no longer holds, and at which coupling. It does not show
what follows: the run ends when the first new site passes, and the nucleus may then stop at a larger
size, grow by jumps or become a front. ``verification.breathers.outcome`` follows this further
evolution in (8).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from theory.chains.nucleus import MARGIN, Nucleus, Place, sites_for
from theory.chains.vdp import VanDerPolChain
from verification.runs.envelope_run import EnvelopeRun, run_envelope


@dataclass(frozen=True)
class NucleusPreparation:
    """The start of a run.

    Attributes
    ----------
    size : int
        Excited sites, all in phase.
    place : Place
        Middle or edge of the chain.
    perturbation : float
        Standard deviation of the noise added to both parts of every φ_n; 0 for no noise.
    seed : int
        Seed of the noise.
    """

    size: int
    place: Place = Place.BULK
    perturbation: float = 0.0
    seed: int = 0

    @property
    def nucleus(self) -> Nucleus:
        """The same sites as a `Nucleus`, all in phase."""
        return Nucleus(self.size, place=self.place)

    def chain(self, chain: VanDerPolChain, c: float) -> VanDerPolChain:
        """Return the chain with `MARGIN` sites on each side of the nucleus."""
        return replace(chain, sites=sites_for(self.size, MARGIN), c=c)

    def start(self, chain: VanDerPolChain) -> ComplexArray:
        """Return φ_n at T = 0, shape (N,)."""
        phi = self.nucleus.envelope(chain)
        if self.perturbation > 0.0:
            noise = np.random.default_rng(self.seed).normal(size=(2, chain.sites))
            phi = phi + self.perturbation * (noise[0] + 1j * noise[1])
        return phi


def hold(
    chain: VanDerPolChain, preparation: NucleusPreparation, c: float, duration: float
) -> EnvelopeRun:
    """Run the averaged chain at a coupling until the nucleus escapes or the time is over.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> hold(VdpChain(a=2.5, b=0.5, c=0), NucleusPreparation(1), 0.2, 200.0).escaped
    True
    """
    here = preparation.chain(chain, c)
    return run_envelope(
        here,
        preparation.start(here),
        duration,
        watched=preparation.nucleus.outside(here.sites),
        limit=here.unstable_amplitude,
    )


def phase_steps(run: EnvelopeRun, preparation: NucleusPreparation) -> FloatArray:
    """Return the phase steps inside the nucleus in units of π, from -1 to 1."""
    core = run.phi[~preparation.nucleus.outside(len(run.phi))]
    return np.asarray(np.angle(core[1:] / core[:-1]) / np.pi, dtype=float)
