"""The piecewise-linear envelope chain (Eq. 44), advanced exactly from one switching to the next.

Between switchings the chain is linear with constant coefficients. In terms of the Fourier modes of
the twisted ring, every mode evolves as ``exp(lambda_k T)``, ``lambda_k = -1/2 + i c (1 - cos k)``,
so the state is known at any time without stepping; only the times at which ``|phi_n| = r`` have to
be found.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from theory.arrays import BoolArray, ComplexArray, FloatArray
from verification.piecewise.crossing import first_zero
from verification.piecewise.window import ChainState

_TERMS = 20  # with |lambda| h <= 1 the first neglected Taylor term is 1/20! = 4e-19
_SAMPLES = 8
_FINEST = 5
_MANY = 6  # number of suspects in one interval above which all sites are bounded at once
_ROUND_OFF = 2e-15  # of phi, due to the transforms
_RELAY = 1e-4  # width in |phi|^2 of the relay that resolves sliding, relative to r^2


@dataclass(frozen=True)
class Switching:
    """One crossing of the threshold.

    Attributes
    ----------
    wait : float
        Slow time since the preceding switching.
    site : int
        Site number.
    direction : int
        +1 if ``|phi|`` rises through r, -1 if it falls.
    sliding : bool
        Whether the new force pushes the site straight back, so that (44) has no ordinary
        continuation; the site is then switched by a relay of relative width 1e-4.
    jitter : float
        Slow time by which round-off in phi can shift this crossing.
    """

    wait: float
    site: int
    direction: int
    sliding: bool
    jitter: float


@dataclass(frozen=True)
class Rest:
    """The front is at rest: no switching was found.

    Attributes
    ----------
    margin : float
        Smallest distance of ``|phi_n|`` at the equilibrium from r, on the side on which it must be.
    remainder : float
        Bound on the distance of every ``phi_n`` from that equilibrium, now and later.
    """

    margin: float
    remainder: float

    @property
    def proven(self) -> bool:
        """Whether no site can ever cross again (allowing 1e-13 for round-off and the window)."""
        return self.margin > self.remainder + 1e-13


class PiecewiseMotion:
    """The chain (44) at one moment, just after a switching.

    Parameters
    ----------
    coupling : float
        c > 0, dimensionless.
    threshold : float
        ``r = |phi_us| / |phi_s|``, 0 < r < 1.
    state : ChainState
        Initial state; sites with ``|phi| > r`` are switched on.
    """

    def __init__(self, coupling: float, threshold: float, state: ChainState) -> None:
        self.threshold = threshold
        self.sites = sites = len(state.phi)
        self.grazes = 0
        self._slots = np.arange(sites)
        self._ramp = self._slots / sites
        k = 2 * np.pi * self._ramp
        self._unit: ComplexArray = np.exp(1j * k)
        self._rates: ComplexArray = -0.5 + 1j * coupling * (1 - np.cos(k))
        self._speeds = np.abs(self._rates)
        self._longest = 1 / float(self._speeds.max())
        self._samplers: dict[int, ComplexArray] = {}
        taylor: ComplexArray = np.ones((_TERMS, sites), dtype=np.complex128) / sites
        for j in range(1, _TERMS):
            taylor[j] = taylor[j - 1] * self._rates * (self._longest / j)
        self._taylor = taylor
        self.origin = state.origin
        self._latest = state.latest
        self._relay = np.zeros(sites)
        self._relaying = False
        on = np.abs(state.phi) > threshold if state.on is None else state.on
        self._on: FloatArray = np.asarray(on).astype(np.float64)
        self._load(np.fft.fft(state.phi + self._ramp))

    def _load(self, spectrum: ComplexArray) -> None:
        self._sign = 2 * self._on - 1
        self._equilibrium: ComplexArray = np.fft.fft(0.5 * (self._on + self._ramp)) / -self._rates
        self._deviation: ComplexArray = spectrum - self._equilibrium

    def state(self) -> ChainState:
        """Return the present envelope."""
        phi = np.fft.ifft(self._equilibrium + self._deviation) - self._ramp
        return ChainState(phi, self.origin, self._on > 0.5, self._latest)

    def zone(self) -> tuple[int, int]:
        """Return the first slot that is off and the last that is on, as slots of the window."""
        return int(np.argmin(self._on)), self.sites - 1 - int(np.argmax(self._on[::-1]))

    def shift(self, sites: int) -> None:
        """Shift the window by ``sites``, which the twist makes exact."""
        spectrum = (self._equilibrium + self._deviation) * self._unit[
            (self._slots * (sites % self.sites)) % self.sites
        ]
        spectrum[0] -= sites
        self._on, self._relay = np.roll(self._on, -sites), np.roll(self._relay, -sites)
        if sites > 0:
            self._on[-sites:] -= 1
        else:
            self._on[:-sites] += 1
        self.origin += sites
        if self._latest is not None:
            self._latest = (self._latest - sites) % self.sites
        self._load(spectrum)

    def advance(self, stall_time: float) -> Switching | Rest:
        """Advance to the next switching, or until rest is proven or ``stall_time`` has passed."""
        waited = 0.0
        while True:
            step, curvature, level = self._sampling_step()
            parts = self._deviation * self._samplers[level]
            phi = np.fft.ifft(parts + self._equilibrium, axis=1) - self._ramp
            gap = (phi.real**2 + phi.imag**2 - self.threshold**2) * self._sign + self._relay
            if self._relaying:  # a relay ends once the site has left the threshold
                self._relay[gap[0] > 3 * self._relay] = 0
                self._relaying = bool(self._relay.any())
            suspect = self._suspects(gap, curvature * step**2 / 8, parts, phi, step)
            found: tuple[int, float, int] | None = None
            for j, n in zip(*(index.tolist() for index in np.nonzero(suspect)), strict=True):
                if found is not None and j > found[0]:
                    break
                fresh = j == 0 and n == self._latest
                at = self._first_crossing(parts[j], complex(phi[j, n]), n, step, fresh)
                if at is not None and (found is None or at < found[1]):
                    found = (j, at, n)
            if found is not None:
                j, at, n = found
                return self._switch(n, j * step + at, waited)
            self._deviation = parts[-1]
            waited += _SAMPLES * step
            self._latest = None
            equilibrium = np.fft.ifft(self._equilibrium) - self._ramp
            margin = float(((np.abs(equilibrium) - self.threshold) * self._sign).min())
            remainder = float(np.abs(self._deviation).sum()) / self.sites
            rest = Rest(margin, remainder)
            if rest.proven or waited > stall_time:
                return rest

    def _sampling_step(self) -> tuple[float, float, int]:
        """Choose the sampling step; return it, the bound F on ``|d^2 |phi|^2/dT^2|``, the level.

        If ``|phi| = r`` is reached within a step h, ``|phi| <= r + h B1`` throughout it.
        """
        weights = np.abs(self._deviation) / self.sites
        first = float((weights * self._speeds).sum())
        second = float((weights * self._speeds**2).sum())
        for level in range(_FINEST):
            step = self._longest * 0.5**level
            curvature = 2 * ((self.threshold + step * first) * second + first * first)
            if curvature * step**2 < 1.2 * self.threshold**2:
                break
        if level not in self._samplers:
            times = step * np.arange(_SAMPLES + 1)
            self._samplers[level] = np.exp(np.outer(times, self._rates))
        return step, curvature, level

    def _suspects(
        self,
        gap: FloatArray,
        least: float,
        parts: ComplexArray,
        phi: ComplexArray,
        step: float,
    ) -> BoolArray:
        """Return which sites may cross in which interval.

        A site with gap > 0 is on its own side. Between samples the gap is bounded below by the
        chord minus ``least``, F h^2/8.
        """
        suspect: BoolArray = np.minimum(gap[:-1], gap[1:]) < least
        for crowded in np.nonzero(suspect.sum(axis=1) > _MANY)[0].tolist():
            suspect[crowded] &= ~self._clear(parts[crowded], phi[crowded], step)
        return suspect

    def _clear(self, modes: ComplexArray, phi: ComplexArray, step: float) -> BoolArray:
        """Return which sites stay off the threshold within ``step``, each by its own Taylor sum.

        This is sharper than the common bound F if the sites differ by decades, as at small r.
        """
        reach = step / self._longest
        terms = np.abs(np.fft.ifft(self._taylor[1:] * self.sites * modes, axis=1))
        change = reach ** np.arange(1, _TERMS) @ terms
        return (np.abs(phi) - self.threshold) * self._sign > change

    def _row(self, slot: int) -> ComplexArray:
        return self._unit[(self._slots * slot) % self.sites]

    def _first_crossing(
        self, modes: ComplexArray, now: complex, slot: int, step: float, fresh: bool
    ) -> float | None:
        """Return the first time in ``[0, step]`` at which a site leaves its side, if any."""
        z = (self._taylor * (modes * self._row(slot))).sum(axis=1)
        z[0] = now
        sign = float(self._sign[slot])
        a = sign * np.convolve(z, z.conj())[:_TERMS].real
        a[0] -= sign * self.threshold**2 - float(self._relay[slot])
        # a site that has just switched (``fresh``) is at exactly zero: divide that zero out
        coefficients = a[1:].tolist() if fresh and self._relay[slot] == 0 else a.tolist()
        result = first_zero(coefficients, step / self._longest)
        self.grazes += result.grazes
        return None if result.at is None else result.at * self._longest

    def _switch(self, slot: int, after: float, waited: float) -> Switching:
        deviation = self._deviation * np.exp(self._rates * after)
        row = self._row(slot)
        now = (
            complex((row * (self._equilibrium + deviation)).sum()) / self.sites - slot / self.sites
        )
        drift = complex((row * self._rates * deviation).sum()) / self.sites
        direction = -int(self._sign[slot])
        jump = (direction * 0.5) * row.conj() / -self._rates
        self._equilibrium = self._equilibrium + jump
        self._deviation = deviation - jump
        self._on[slot] += direction
        self._sign[slot] = direction
        # slope of the gap just afterwards: below zero, the new force pushes the site straight back
        slope = direction * 2 * (now.conjugate() * (drift + 0.5 * direction)).real
        sliding = slope <= 0
        self._relay[slot] = _RELAY * self.threshold**2 if sliding else 0.0
        self._relaying = self._relaying or sliding
        self._latest = slot
        before = abs(slope - now.real)  # the force has added d|phi|^2/dT = direction * Re phi
        jitter = _ROUND_OFF * self.threshold / max(before, 1e-12)
        return Switching(waited + after, slot + self.origin, direction, sliding, jitter)
