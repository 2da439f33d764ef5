"""Statements of the text about the simplified model apart from its figures (section 2.3.2)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paper_checks.claim import Claim, Ruling
from paper_checks.claims._required import required
from paper_checks.ruling import corrected, fails, holds

A, B = 4.0, 0.5
ETA = B / A**2


@dataclass(frozen=True, kw_only=True)
class Gauge:
    """y by (34) with ω = 1 and with ω = 1 + εc, at εt = 12."""

    gaps: tuple[float, ...]
    """Relative differences at ε = 0.02, 0.01, 0.005."""

    @property
    def order(self) -> float:
        """Observed order in ε."""
        return math.log(self.gaps[0] / self.gaps[-1]) / math.log(4.0)


def gauge() -> Gauge:
    """Run (34) with both values of ω by scipy and compare the resulting y."""
    from verification.references.pace import last_state

    sites, end, c = 6, 12.0, 0.5
    size = math.sqrt(A / B * (1.0 + math.sqrt(1.0 - 8.0 * ETA)))
    start = np.array([size * (1.0 + 0.2j) * math.exp(-0.8 * n) for n in range(sites)])
    gaps = []
    for eps in (0.02, 0.01, 0.005):
        found = []
        for omega in (1.0, 1.0 + eps * c):

            def rate(_: float, phi: np.ndarray, omega: float = omega,
                     eps: float = eps) -> np.ndarray:  # fmt: skip
                return _rate_34(phi, c, eps, omega)

            # y = Im(φ e^{iωt})/ω: both must describe the same y, up to O(ε).
            found.append(
                last_state(rate, end, start, 1e-10, 1e-12)
                * np.exp(1j * (omega - 1.0) / eps * end)
                / omega
            )
        gaps.append(float(np.abs(found[1] - found[0]).max() / np.abs(found[0]).max()))
    return Gauge(gaps=tuple(gaps))


def _rate_34(phi: np.ndarray, c: float, eps: float, omega: float) -> np.ndarray:
    """Return dφ/d(εt) of (34) for any ω, free ends."""
    from verification.references.equations import averaged_damping, pull

    damping = averaged_damping(np.abs(phi) / omega, A, B)
    frame = 1j * (omega - 1.0 / omega) / (2.0 * eps)
    rate: np.ndarray = 0.5j * c / omega * pull(phi) - 0.5 * phi * damping - frame * phi
    return rate


def rule_gauge(e: Gauge) -> Ruling:
    """Rule: the difference must be of order ε, like the error of averaging."""
    return holds() if e.order > 0.9 and e.gaps[1] < 0.1 else fails("ω = 1 changes the solution.")


@dataclass(frozen=True, kw_only=True)
class Equilibria:
    """Equilibria of (44) and the motion of one of its sites from both sides of |φ_us|."""

    rest: float
    """|φ| at T = 40 from just below |φ_us|, relative to |φ_s|."""
    cycle: float
    """|φ - φ_s| at T = 40 from just above, relative to |φ_s|."""
    rates: tuple[float, float]
    """Decay rates to both, per unit of slow time."""
    envelope_rates: tuple[float, float]
    """The same for (43), about rest and for the amplitude of its cycle."""


def equilibria() -> Equilibria:
    """Integrate one site of (44) and linearise one site of (43)."""
    root = math.sqrt(1.0 - 8.0 * ETA)
    stable, unstable = (math.sqrt(A / B * (1.0 + sign * root)) for sign in (1.0, -1.0))

    def left(start: float, time: float) -> float:
        """Return how far one uncoupled site of (44), on the line through φ_s, is from its goal."""
        goal = stable if start > unstable else 0.0
        # dφ/dT = -(φ - goal)/2 never crosses |φ_us| from either side.
        return abs(start - goal) * math.exp(-0.5 * time)

    now, later = ([left(side * unstable, time) for side in (0.999, 1.001)] for time in (40.0, 41.0))
    return Equilibria(
        rest=now[0] / stable,
        cycle=now[1] / stable,
        rates=(math.log(now[0] / later[0]), math.log(now[1] / later[1])),
        envelope_rates=(0.5, 0.5 * (1.0 - 0.75 * A * stable**2 + 0.625 * B * stable**4)),
    )


def rule_equilibria(e: Equilibria) -> Ruling:
    """Rule: each side of |φ_us| must lead to its own equilibrium, both also stable in (43)."""
    if max(e.rest, e.cycle) < 1e-6 and min(*e.rates, *e.envelope_rates) > 0.0:
        return holds()
    return fails("(44) is not bistable between 0 and φ_s.")


@dataclass(frozen=True, kw_only=True)
class ModelVelocities:
    """v̂ at a = 4, b = 0.5, c = 0.6."""

    averaged: float
    averaged_error: float
    kinetic: float
    chain: float

    @property
    def gap(self) -> float:
        """Difference between (54) and the run of (44)."""
        return abs(self.kinetic - self.chain)

    @property
    def ratio(self) -> float:
        """Ratio of (43) to (54)."""
        return self.averaged / self.kinetic


@lru_cache(maxsize=1)
def velocities() -> ModelVelocities:
    """Run (43) and (44), and solve (54)."""
    from theory.chains.vdp import VdpChain
    from theory.piecewise.kinetic_relation import kinetic_relation
    from verification.fronts.measure import measure_front
    from verification.piecewise.simulation import simulate_front

    front = measure_front(VdpChain(a=A, b=B, c=0.6).averaged())
    return ModelVelocities(
        averaged=required(front.v, "front of (43)"),
        averaged_error=required(front.error, "error of the front of (43)"),
        kinetic=kinetic_relation(0.6, ETA).branches[-1].v,
        chain=required(simulate_front(0.6, ETA).v, "front of (44)"),
    )


def rule_quantitative(e: ModelVelocities) -> Ruling:
    """Rule: the two must differ by more than a tenth, which would still count as a match."""
    if e.gap < 1e-8 and abs(e.ratio - 1.0) > 0.1:
        return holds()
    return fails("(54) matches the velocity of the averaged chain.")


def rule_captions(e: ModelVelocities) -> Ruling:
    """Rule: (54), which the figures show, must be the velocity of (43), or else of (44)."""
    if abs(e.averaged - e.kinetic) <= e.averaged_error:
        return holds()
    if e.gap < 1e-8:
        return corrected("the figures show (54), which solves (44) and not (43).")
    return fails("(54) is the velocity of neither model.")


CLAIMS = (
    Claim.beside("text-gauge", evidence=gauge, rule=rule_gauge, weight=0),
    Claim.beside("text-equilibria", evidence=equilibria, rule=rule_equilibria, weight=0),
    Claim.beside(
        "text-quantitative",
        evidence=velocities,
        rule=rule_quantitative,
        weight=0,
        shared=velocities,
    ),
    Claim.beside(
        "text-captions", evidence=velocities, rule=rule_captions, weight=0, shared=velocities
    ),
)
