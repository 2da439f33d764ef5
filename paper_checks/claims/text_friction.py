"""Statements of the text about Model I apart from its figures (introduction, sections 1.1-1.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Ruling
from paper_checks.claims._breathers import EPS
from paper_checks.claims._breathers import A as VDP_A
from paper_checks.claims._breathers import B as VDP_B
from paper_checks.claims._friction import SITES, chain_of, disagreement
from paper_checks.ruling import corrected, fails, holds
from theory.arrays import FloatArray

if TYPE_CHECKING:
    from verification.breathers.outcome import Evolution

EXACT = 1e-12
"""Rounding."""
APART = 1e-3
"""Smallest difference by which a wrong reading must be recognised."""


@dataclass(frozen=True, kw_only=True)
class Scales:
    """Difference between (1), scaled, and (5): for the right symbol, and at least as printed."""

    right: float
    printed: float


def spring() -> Scales:
    """Compare eigenfrequencies of (1) over ω_n with those of (5) for c = η_c/k and c = η_c."""
    generator = np.random.default_rng(4)
    stretch = np.diff(np.eye(5), axis=0)
    springs = stretch.T @ stretch
    off: dict[bool, list[float]] = {True: [], False: []}
    for m, k, eta_c in generator.uniform(0.5, 3.0, (5, 3)):
        scaled = np.sqrt(np.linalg.eigvalsh((k * np.eye(5) + eta_c * springs) / m) / (k / m))
        for right, c in ((True, eta_c / k), (False, eta_c)):
            expected = np.sqrt(np.linalg.eigvalsh(np.eye(5) + c * springs))
            off[right].append(float(np.abs(scaled - expected).max()))
    return Scales(right=max(off[True]), printed=min(off[False]))


def length() -> Scales:
    """Scale a velocity by ω_n times y_0 or another length; compare with a derivative in τ."""
    generator = np.random.default_rng(5)
    gaps, others = [], []
    for omega, y_0, rate, other in generator.uniform(0.5, 3.0, (5, 4)):
        step = 1e-5
        slope = (math.sin(rate * step / omega) - math.sin(-rate * step / omega)) / (2 * step * y_0)
        gaps.append(abs(rate / (omega * y_0) - slope))
        others.append(abs(rate / (omega * other) - slope))
    return Scales(right=max(gaps), printed=min(others))


def rule_spring(e: Scales) -> Ruling:
    """Rule: the coupling spring of (1) must be η_c, as printed in (1), and not c."""
    if e.right < EXACT and e.printed > APART:
        return corrected("the spring of (1) is $\\eta_c$, and $c = \\eta_c/k$ its scaled value.")
    return holds() if e.printed < EXACT else fails("neither symbol gives the scaled chain.")


def rule_length(e: Scales) -> Ruling:
    """Rule: the length must be y_0; the derivative is accurate to 1e-8."""
    if e.right < 1e-8 < e.printed:
        return corrected("$x_0$ is not defined and must be the $y_0$ of (4).")
    return holds() if e.printed < 1e-8 else fails("no length gives the scaled velocity.")


@dataclass(frozen=True, kw_only=True)
class UnbalancedForce:
    """Unbalanced force on a uniform chain in steady sliding, c = 0.02."""

    free: float
    literal: float


def ends() -> UnbalancedForce:
    """Compute the force for free ends, and for (1) with missing neighbours set to zero."""
    from theory.chains.ends import Ends
    from verification.references.equations import pull_matrix

    c, sliding = 0.02, np.full(SITES, chain_of(0.02).cell.steady_sliding)
    free, literal = (
        float(np.abs(c * pull_matrix(SITES, each) @ sliding).max())
        for each in (Ends.FREE, Ends.LITERAL)
    )
    return UnbalancedForce(free=free, literal=literal)


def rule_ends(e: UnbalancedForce) -> Ruling:
    """Rule: free ends must leave uniform steady sliding an equilibrium."""
    return holds() if e.free < EXACT else fails("free ends pull a uniform chain.")


@dataclass(frozen=True, kw_only=True)
class Trapezoid:
    """Damping of the trapezoidal rule."""

    drift: float
    """Change of the amplitude in 200 turns at a step of 0.1."""
    factor: float
    """Largest distance of an amplification factor from one, at steps from 0.001 to 1000."""


def trapezoid() -> Trapezoid:
    """Advance a harmonic oscillator by the trapezoidal rule."""
    generator, eye = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.eye(2)

    def rule(step: float) -> FloatArray:
        halved = 0.5 * step * generator
        return np.asarray(np.linalg.solve(eye - halved, eye + halved), dtype=float)

    step, turns = 0.1, 200
    state = np.linalg.matrix_power(rule(step), round(turns * 2 * math.pi / step)) @ [1.0, 0.0]
    factors = np.abs([np.linalg.eigvals(rule(each)) for each in np.geomspace(1e-3, 1e3, 61)])
    return Trapezoid(
        drift=abs(float(np.hypot(*state)) - 1.0), factor=float(np.abs(factors - 1.0).max())
    )


def rule_trapezoid(e: Trapezoid) -> Ruling:
    """Rule: the amplitude must be preserved to within rounding."""
    return holds() if max(e.drift, e.factor) < 1e-10 else fails("the rule changes amplitudes.")


PATTERNS = ((16,), (15, 16, 17), (3, 20), (5, 11, 12, 28), tuple(range(1, 31, 3)))
WEAK, BISTABLE, SLOW, FAST, LATE = 0.004, 1.25, 1.05, 1.95, 3000.0


@dataclass(frozen=True, kw_only=True)
class Patterns:
    """Sites in stick-slip late in runs from several patterns, by belt velocity."""

    late: dict[float, tuple[tuple[int, ...], ...]]
    gap: float

    @property
    def kept(self) -> int:
        """Number of patterns that persist at v_d = 1.25."""
        return sum(a == b for a, b in zip(self.late[BISTABLE], PATTERNS, strict=True))

    @property
    def ends(self) -> dict[float, int]:
        """Number of different final patterns by belt velocity."""
        return {v: len(set(rows)) for v, rows in self.late.items()}


def patterns() -> Patterns:
    """Start several patterns at three belt velocities and record which sites stick late."""
    from verification.runs.excite import excite
    from verification.runs.friction_integration import FrictionIntegration

    late: dict[float, tuple[tuple[int, ...], ...]] = {}
    for v_d in (SLOW, BISTABLE, FAST):
        chain, rows = chain_of(WEAK, SITES, v_d), []
        source = chain_of(WEAK)  # all runs start on the cycle of the bistable cell
        for excited in PATTERNS:
            run = FrictionIntegration(chain, excite(source, excited), tolerance=1e-9)
            run.advance_to(LATE)
            run.arrivals[:] = np.nan
            run.advance_to(LATE + 100.0)
            rows.append(tuple(int(n) + 1 for n in np.flatnonzero(~np.isnan(run.arrivals))))
        late[v_d] = tuple(rows)
    return Patterns(late=late, gap=disagreement(chain_of(WEAK, 7), (2, 6), 60.0))


def rule_patterns(e: Patterns) -> Ruling:
    """Rule: all must persist where the cell is bistable, and end alike where it is not."""
    one = e.ends[SLOW] == e.ends[FAST] == 1
    if e.kept == len(PATTERNS) and one and e.gap < APART:
        return holds()
    return fails("patterns do not coexist, or do so outside bistability.")


FRICTION = (0.0079, 0.00796, 0.0085, 0.0095, 0.011)
"""Couplings around 0.00794, where the breather of a single site in the bulk ends (fig04-bulk)."""
END, PAUSE, PUSH = 4000.0, 1000.0, 1e-3
SMOOTH, SLOW_END = 0.203, 1200.0
"""Coupling at which the single site of Model II, at the parameters of Fig. 11, gives way to a front
(text-to-larger), and the slow time in which that front fills 31 sites."""


@dataclass(frozen=True, kw_only=True)
class Nucleation:
    """Outcome for a single site of Model I, by coupling."""

    outcomes: dict[float, tuple[Evolution, ...]]
    """By the displacement of one neighbour."""
    outward: tuple[bool, ...]
    """For each front, that of Model II last: whether every site joins after its inner neighbour."""
    gap: float

    def words(self, push: float) -> str:
        """Write the outcomes at `FRICTION` for one displacement."""
        pairs = zip(FRICTION, self.outcomes[push], strict=True)
        return ", ".join(f"{each.outcome.value} at {c:g}" for c, each in pairs)

    @property
    def ends(self) -> set[str]:
        """All outcomes that occur."""
        return {each.outcome.value for row in self.outcomes.values() for each in row}


@lru_cache(maxsize=1)
def nucleation() -> Nucleation:
    """Follow the single site through the end of its breather in Model I, with and without symmetry.

    Model II is run at one coupling at which its single site gives way to a front.
    """
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.breathers.outcome import evolution
    from verification.runs.excite import excite
    from verification.runs.friction_integration import FrictionIntegration
    from verification.runs.simulate import simulate

    rows: dict[float, tuple[Evolution, ...]] = {}
    outward = []
    excited = Nucleus(1).excited(SITES)
    for push in (0.0, PUSH):
        found = []
        for c in FRICTION:
            start = excite(chain_of(c), excited)
            start[0, excited[-1]] += push
            run = FrictionIntegration(chain_of(c), start, tolerance=1e-9)
            run.advance_to(END)
            joined = run.arrivals.copy()
            joined[excited[0] - 1] = 0.0
            found.append(evolution(joined, END, int(np.count_nonzero(~np.isnan(joined))), PAUSE))
            if found[-1].outcome.value == "front":
                outward.append(_outward(joined, excited[0] - 1))
        rows[push] = tuple(found)
    smooth = VdpChain(a=VDP_A, b=VDP_B, c=SMOOTH, eps=EPS, sites=SITES)
    run_two = simulate(smooth, excite(smooth, excited), SLOW_END / EPS, samples=2, tolerance=1e-8)
    outward.append(_outward(run_two.arrivals, excited[0] - 1))
    return Nucleation(
        outcomes=rows,
        outward=tuple(outward),
        gap=disagreement(chain_of(FRICTION[-2], 5), (3,), 300.0),
    )


def _outward(arrivals: FloatArray, centre: int) -> bool:
    """Return whether the sites joined one after the other, outwards from the centre."""
    sides = arrivals[centre + 1 :], arrivals[:centre][::-1]
    reached = [int(np.count_nonzero(~np.isnan(side))) for side in sides]
    return min(reached) > 1 and all(
        bool(np.all(np.diff(side[:n]) > 0.0)) for side, n in zip(sides, reached, strict=True)
    )


def rule_nucleation(e: Nucleation) -> Ruling:
    """Rule: in both models the front must start at the nucleus and advance site by site."""
    if {"held", "front"} <= e.ends and all(e.outward) and len(e.outward) > 2 and e.gap < APART:
        return holds()
    return fails("the front does not grow from the nucleus, site after site.")


CLAIMS = (
    Claim.beside("text-patterns", evidence=patterns, rule=rule_patterns),
    Claim.beside("text-nucleation", evidence=nucleation, rule=rule_nucleation),
    Claim.beside("text-spring", evidence=spring, rule=rule_spring, weight=0),
    Claim.beside("text-length", evidence=length, rule=rule_length, weight=0),
    Claim.beside("text-ends", evidence=ends, rule=rule_ends, weight=0),
    Claim.beside("text-trapezoid", evidence=trapezoid, rule=rule_trapezoid, weight=0),
)
