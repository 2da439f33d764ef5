"""Fig. 6: velocity of the fronts of the friction chain against coupling."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._friction import SITES, chain_of, disagreement
from paper_checks.claims._required import required
from paper_checks.ruling import fails, holds
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, picture

COUPLINGS = (0.011, 0.012, 0.014, 0.017, 0.02, 0.025, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1)
LINEAR_FROM = 0.02
"""'Except in the vicinity of c_crit': from about twice the threshold upwards."""
STEEPER = 1.5
"""Ratio of slopes at which the difference from the line is visible."""
LARGE = (0.3, 1.0)
FAST_SITES, LARGE_SITES = 61, 101
"""Chains longer than the paper's 31 sites, for a better mean where fronts are fast."""
BELOW = (0.002, 0.004, 0.006, 0.008, 0.01)
WIDE = 6
SCIPY = ((0.02, 300.0), (0.05, 110.0), (0.1, 70.0))
"""Couplings at which the first six sites are also run by scipy, and the durations."""
RESIDUAL = 0.02
"""Fraction of the largest velocity: about the size of a mark in a printed figure."""


@dataclass(frozen=True, kw_only=True)
class FrictionVelocities:
    """Front velocity by coupling, started from one site at the edge."""

    c: tuple[float, ...]
    v: tuple[float, ...]
    error: tuple[float, ...]
    waves: tuple[float, ...]
    """Largest group velocity of waves about steady sliding, (√(1 + 4c) - 1)/2."""
    gap: float
    threshold: float
    """Coupling above which a site at the edge starts a front."""

    def _linear(self) -> tuple[np.ndarray, np.ndarray]:
        chosen = [k for k, c in enumerate(self.c) if LINEAR_FROM <= c <= COUPLINGS[-1]]
        return np.array(self.c)[chosen], np.array(self.v)[chosen]

    @property
    def line(self) -> tuple[float, float]:
        """Offset and slope of the fitted line."""
        slope, offset = np.polyfit(*self._linear(), 1)
        return float(offset), float(slope)

    @property
    def residual(self) -> float:
        """Largest residual relative to the largest velocity of the range."""
        c, v = self._linear()
        return float(np.abs(self.line[0] + self.line[1] * c - v).max() / v.max())

    @property
    def slopes(self) -> tuple[float, float]:
        """dv/dc just above the threshold, less its error, and of the line, plus its error."""
        at = {c: (v, e) for c, v, e in zip(self.c, self.v, self.error, strict=True)}

        def slope(low: float, high: float, sign: float) -> float:
            off = sign * (at[low][1] + at[high][1])
            return (at[high][0] - at[low][0] + off) / (high - low)

        first = slope(COUPLINGS[0], COUPLINGS[1], -1.0)
        return first, slope(LINEAR_FROM, COUPLINGS[-1], 1.0)

    @property
    def worst(self) -> float:
        """Largest error of v in the range of the figure."""
        return max(e for c, e in zip(self.c, self.error, strict=True) if c <= COUPLINGS[-1])

    @property
    def beyond(self) -> str:
        """Measured velocity, wave velocity and the line, at larger couplings."""
        return "; ".join(
            f"c = {c:g}: {v:.3f}, waves {w:.3f}, line {self.line[0] + self.line[1] * c:.3f}"
            for c, v, w in zip(self.c, self.v, self.waves, strict=True)
            if c in LARGE
        )


@lru_cache(maxsize=1)
def velocities() -> FrictionVelocities:
    """Measure the front at every coupling; compare arrivals with scipy at three of them."""
    from verification.fronts.measure import measure_front

    rows = []
    for c in (*COUPLINGS, *LARGE):
        sites = LARGE_SITES if c in LARGE else SITES if c < LINEAR_FROM else FAST_SITES
        front = measure_front(chain_of(c, sites), max_sites=2 * sites, accuracy=0.02)
        v = required(front.v, f"velocity at c = {c:g}: {front.status}")
        error = required(front.error, f"error of the velocity at c = {c:g}: {front.status}")
        rows.append((c, v, error, front.chain.largest_group_velocity))
    columns = list(zip(*rows, strict=True))
    return FrictionVelocities(
        c=columns[0], v=columns[1], error=columns[2], waves=columns[3],
        gap=max(disagreement(chain_of(c, 6), (1,), end) for c, end in SCIPY),
        threshold=no_propagation().threshold,
    )  # fmt: skip


def rule_linear(e: FrictionVelocities) -> Ruling:
    """Rule: in the range of the figure a line must fit to within the size of a mark."""
    if e.residual < RESIDUAL and e.gap < 1e-3:
        return holds()
    return fails("no line fits the velocities within the size of a mark.")


def rule_rapid(e: FrictionVelocities) -> Ruling:
    """Rule: just above the threshold v must be steeper than the line, beyond both errors."""
    if e.slopes[0] > STEEPER * e.slopes[1] and e.gap < 1e-3:
        return holds()
    return fails("just above the threshold the velocity is no steeper than the line.")


def draw_velocities(e: FrictionVelocities) -> tuple[Picture, ...]:
    """Draw Fig. 6, with v = 0 below the critical coupling, and the critical coupling itself."""
    figure, axes = new_axes(
        "column", height=2.8, xlabel="coupling c", ylabel=r"$\tilde{v}_\mathrm{front}$ (sites/τ)"
    )
    shown = [k for k, c in enumerate(e.c) if c <= COUPLINGS[-1]]
    fine = np.linspace(e.threshold, 0.105, 100)
    offset, slope = e.line
    curves = Curves({"measured": {"c": e.c, "v": e.v, "error": e.error}})
    axes.plot(*curves.add("line", c=fine, v=offset + slope * fine), "--",
              color=COLOURS["vermilion"], label=rf"line from $c$ = {LINEAR_FROM:g} on")  # fmt: skip
    waves = [chain_of(float(c)).largest_group_velocity for c in fine]
    axes.plot(*curves.add("fastest linear waves", c=fine, v=waves), color=COLOURS["green"], lw=0.9,
              label="fastest linear waves")  # fmt: skip
    axes.errorbar([e.c[k] for k in shown], [e.v[k] for k in shown], [e.error[k] for k in shown],
                  fmt="o", ms=3.2, color=COLOURS["blue"], label="measured")  # fmt: skip
    axes.plot(*curves.add("no propagation", c=BELOW, v=[0.0] * len(BELOW)), "o", mfc="none",
              color=COLOURS["blue"], label="no propagation", clip_on=False)  # fmt: skip
    curves["c_crit"] = {"c": e.threshold}
    axes.axvline(e.threshold, color="0.4", lw=0.8, ls=":",
                 label=rf"$c_\mathrm{{crit}}$ = {e.threshold:.5f}")  # fmt: skip
    axes.set(xlim=(0.0, 0.105), ylim=(0.0, None))
    axes.set(title=r"$\tilde{v}_d$ = 1.25, $N_\mathrm{dof}$ = 31, edge")
    axes.legend()
    return (picture("fig06-velocity", figure, long_table(curves)),)


@dataclass(frozen=True, kw_only=True)
class NoPropagation:
    """Runs below the threshold for one site at the edge, and for a wider nucleus."""

    threshold: float
    arrived: tuple[int, ...]
    """Number of sites that have stuck by τ = 4000 at each of `BELOW`."""
    wide_threshold: float
    gap: float


@lru_cache(maxsize=1)
def no_propagation() -> NoPropagation:
    """Bisect for the threshold of one site at the edge, and run below it."""
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate
    from verification.thresholds.spreading import Spreading, spreading_threshold

    single, wide = (
        spreading_threshold(
            chain_of(0.0), Spreading(size), lowest=0.005, accuracy=2e-5, tests=0
        ).c_crit
        for size in (1, WIDE)
    )  # fmt: skip
    arrived = []
    for c in BELOW:
        run = simulate(chain_of(c), excite(chain_of(c), [1]), 4000.0, samples=3)
        arrived.append(int(np.count_nonzero(np.isfinite(run.arrivals))))
    return NoPropagation(
        threshold=single,
        arrived=tuple(arrived),
        wide_threshold=wide,
        gap=max(disagreement(chain_of(part * single, 5), (1,), 400.0) for part in (0.98, 1.02)),
    )


def rule_no_propagation(e: NoPropagation) -> Ruling:
    """Rule: started from one site at the edge, as in the caption, no other site may ever stick."""
    if all(n == 1 for n in e.arrived) and max(BELOW) < e.threshold and e.gap < 1e-3:
        return holds()
    return fails("below the threshold other sites stick.")


CLAIMS = (
    Claim.beside(
        "fig06-linear",
        evidence=velocities,
        rule=rule_linear,
        figure=draw_velocities,
        shared=no_propagation,
    ),
    Claim.beside(
        "fig06-threshold", evidence=no_propagation, rule=rule_no_propagation, shared=no_propagation
    ),
    Claim.beside(
        "fig06-rapid", evidence=velocities, rule=rule_rapid, shared=no_propagation, weight=0
    ),
)
