"""Fig. 11: critical coupling against the size of the nucleus, and which nuclei are stable."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._breathers import EPS, A, B, monodromy_by_differences
from paper_checks.claims._required import required
from paper_checks.ruling import agrees, corrected, fails, holds, partly
from theory.arrays import FloatArray
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, picture

if TYPE_CHECKING:
    from verification.continuation.newton import BranchPoint, System
    from verification.references.phase_locked import LockedBranch

ODD = (1, 3, 5, 7, 9)
PRINTED = {1: "0.1916", 3: "0.2011"}
LAST = 0.2011
RANGE = (1, 2, 3, 4, 5, 6, 7, 8)
FAMILY = (10, 12, 14, 18, 22)
"""Sizes for which all signs are enumerated, and those of the family with steps δ, π/2, δ, π/2, …"""
MIRRORED_AT = (0.1, 0.15, 0.198)
"""Couplings up to just below the folds of sizes 3 to 9."""
ORBIT_AT = 0.195
"""Coupling above the loss of size 1 at which an even breather is also found in (8)."""
NEAR = 5e-4
"""Breathers end at couplings larger by about 4e-4 in (8) than for ε → 0: any that ends this close
to the last one may be the last in (8)."""
SAME_RATE = 1.5
"""Largest ratio of the rates of sweeps that were made alike for one figure."""
SOLVERS = 1e-5
"""Largest difference of growth rates between two solvers on chains of different lengths, whose ends
have an effect of 1e-6."""
CONVERGED = 5e-5
"""Half a unit of the fourth decimal, to which the paper gives its critical couplings."""


@dataclass(frozen=True, kw_only=True)
class Folds:
    """Folds of mirror-symmetric breathers of odd sizes, and escapes of perturbed runs."""

    orbit: dict[int, float]
    """Folds in (8) at ε = 0.01, by size."""
    averaged: dict[int, float]
    """Folds for ε → 0."""
    runs: dict[int, float]
    """Escape of the averaged chain by bisection of mirror-symmetric runs."""
    run_error: float
    error: float
    stable_to: float
    """Coupling at which size 1 of (8) loses stability to an odd mode."""

    @property
    def gap(self) -> float:
        """Largest difference between the folds and the bisection of runs."""
        return max(abs(self.runs[n] - self.averaged[n]) for n in self.runs)

    @property
    def spread(self) -> float:
        """Spread over sizes 5, 7, 9 in (8)."""
        late = [c for n, c in self.orbit.items() if n >= 5]
        return max(late) - min(late)

    @property
    def step(self) -> float:
        """Difference between size 3 and size 5 in (8)."""
        return self.orbit[3] - self.orbit[5]

    @property
    def agree(self) -> bool:
        """Whether the bisection of runs confirms the folds to within its brackets."""
        return self.gap <= self.run_error + 1e-8


@lru_cache(maxsize=1)
def folds() -> Folds:
    """Follow the mirror-symmetric breathers to their folds, and bisect runs for their escape."""
    from theory.chains.nucleus import Nucleus, outward_pattern
    from theory.chains.vdp import VdpChain
    from verification.thresholds.continuation import breather_threshold
    from verification.thresholds.escape import escape_threshold
    from verification.thresholds.preparation import NucleusPreparation
    from verification.thresholds.result import ThresholdMethod

    chain = VdpChain(a=A, b=B, c=0.0, eps=EPS)
    nuclei = {n: Nucleus(n, outward_pattern(n)) for n in ODD}
    orbit = {
        n: breather_threshold(chain, each, ThresholdMethod.ORBIT) for n, each in nuclei.items()
    }
    averaged = {
        n: breather_threshold(chain, each, ThresholdMethod.ENVELOPE) for n, each in nuclei.items()
    }
    runs = {n: escape_threshold(chain, NucleusPreparation(n), tolerance=1e-4) for n in (1, 3, 5)}
    one = orbit[1]
    return Folds(
        orbit={n: found.c_crit for n, found in orbit.items()},
        averaged={n: found.c_crit for n, found in averaged.items()},
        runs={n: run.c_crit for n, run in runs.items()},
        run_error=max(run.error for run in runs.values()),
        error=max(found.error for found in orbit.values()),
        stable_to=one.c_crit if one.stable_to is None else one.stable_to,
    )


@dataclass(frozen=True, kw_only=True)
class Sweeps:
    """Slow sweeps of c in the averaged chain, compared with the folds."""

    folds: Folds
    rates: tuple[float, ...]
    """dc/d(εt)."""
    escapes: dict[int, tuple[float, ...]]
    """Coupling at which a sweep leaves the breather, by size."""
    exponents: dict[int, float]

    @property
    def late(self) -> dict[int, float]:
        """Difference between the printed values and the folds of (8)."""
        return {n: float(text) - self.folds.orbit[n] for n, text in PRINTED.items()}

    @property
    def implied(self) -> dict[int, float]:
        """Sweep rate with a delay of this size; the delay is proportional to rate^(2/3)."""
        found = {}
        for n, late in self.late.items():
            slowest = self.escapes[n][-1] - self.folds.averaged[n]
            found[n] = self.rates[-1] * (max(late, 0.0) / slowest) ** 1.5
        return found

    @property
    def ratio(self) -> float:
        """Ratio of the larger implied rate to the smaller one."""
        low, high = sorted(self.implied.values())
        return high / low if low else math.inf


def sweeps() -> Sweeps:
    """Sweep c slowly through the folds of sizes 1 and 3."""
    from theory.chains.vdp import VdpChain
    from verification.thresholds.preparation import NucleusPreparation
    from verification.thresholds.slow_sweep import measure_delay

    chain = VdpChain(a=A, b=B, c=0.0, eps=EPS)
    found = {n: measure_delay(chain, NucleusPreparation(n)) for n in PRINTED}
    return Sweeps(
        folds=folds(),
        rates=tuple(found[1].rates),
        escapes={n: tuple(each.escapes) for n, each in found.items()},
        exponents={
            n: required(each.delay_exponent, f"exponent for size {n}") for n, each in found.items()
        },
    )


def rule_values(e: Sweeps) -> Ruling:
    """Rule: the digits must be right, or be those of sweeps at a single rate."""
    if not e.folds.agree:
        return fails("folds and runs disagree.")
    if all(agrees(e.folds.orbit[n], text, e.folds.error) for n, text in PRINTED.items()):
        return holds()
    slow = all(abs(x - 2.0 / 3.0) < 0.05 for x in e.exponents.values())
    if slow and min(e.late.values()) > 0.0 and e.ratio < SAME_RATE:
        return corrected("a finite sweep rate delays the observed transition.")
    return fails(
        "the breathers end at smaller couplings, and the delay of sweeps at one rate does not give "
        "both printed values."
    )


def draw_sweeps(e: Sweeps) -> tuple[Picture, ...]:
    """Draw the escape of slow sweeps against their rate, with fold and printed value."""
    figure, axes = new_axes(
        "column", height=2.9, xlabel="(dc/d(εt))$^{2/3}$", ylabel="coupling c at escape"
    )
    curves, slow = Curves(), [rate ** (2.0 / 3.0) for rate in e.rates]
    for (n, escapes), colour, mark in zip(
        e.escapes.items(), ("blue", "vermilion"), "os", strict=True
    ):
        shade = COLOURS[colour]
        sweeps = curves.add(f"sweeps, size {n}", rate_to_2_3=slow, c=escapes, rate=e.rates)
        axes.plot(*sweeps, mark, color=shade, label=f"size {n}: sweeps")
        fold = curves.add(f"fold, size {n}", rate_to_2_3=[0.0], c=[e.folds.averaged[n]])
        axes.plot(*fold, mark, mfc="none", ms=6, color=shade, label="fold")
        axes.axhline(float(PRINTED[n]), color=shade, lw=1.2, ls=":", label=f"paper, {PRINTED[n]}")
        curves[f"paper, size {n}"] = {"c": float(PRINTED[n])}
    axes.set(ylim=(0.1885, 0.2195), xlim=(-0.0002, None))
    axes.set(title=r"$a$ = 2.5, $b$ = 0.5, averaged chain (43)")
    axes.legend(ncols=2, loc="upper left", columnspacing=1.0)
    return (picture("fig11-sweeps", figure, long_table(curves)),)


def draw_values(e: Sweeps) -> tuple[Picture, ...]:
    """Draw Fig. 11, and the sweeps by which its values were found."""
    return *draw_thresholds(e.folds), *draw_sweeps(e)


def rule_order(e: Folds) -> Ruling:
    """Rule: size 1 must end first and size 3 last, for the start of the paper."""
    larger = [c for n, c in e.orbit.items() if n != 1]
    if e.agree and e.orbit[1] < min(larger) and e.orbit[3] == max(larger):
        return holds()
    return fails("the breather of size 1 is not the first to be lost.")


def rule_converged(e: Folds) -> Ruling:
    """Rule: from size 5 on the values must agree to the paper's four decimals."""
    if e.agree and e.spread < CONVERGED and e.step > e.spread:
        return holds()
    return fails("the critical coupling still changes from size 5 on.")


@dataclass(frozen=True, kw_only=True)
class Ended:
    """A breather followed in c to the end of its existence."""

    c_end: float
    stable: tuple[tuple[float, float], ...]
    """Ranges of c in which it is stable."""


@dataclass(frozen=True, kw_only=True)
class Left:
    """A breather of (8) that exists at the last printed coupling."""

    size: int
    end: float
    """Coupling at which it ends."""
    growth: float
    """Its growth rate at the last printed coupling, per unit of εt."""


@dataclass(frozen=True, kw_only=True)
class Nuclei:
    """All phase-locked breathers of `RANGE`, and the family of `FAMILY`, followed to their ends."""

    branches: dict[int, tuple[Ended, ...]]
    """The breathers by size, in the order in which they were found."""
    growth_by_envelope: dict[int, float]
    """Growth rate at c = 0.1 of the mirror-symmetric breathers of odd size, by another solver."""
    growth_here: dict[int, float]
    growth_mirrored: dict[int, float]
    """Largest growth at `MIRRORED_AT` for sizes 3, 5, 7, for mirror-symmetric perturbations."""
    orbit_growth: tuple[float, ...]
    """Growth rates in (8) at `ORBIT_AT` of the breathers of size 6 that are stable there."""
    orbit_end: float
    """Coupling at which the last breather ends in (8)."""
    left: tuple[Left, ...]
    """The breathers that exist in (8) at c = 0.2011."""
    seeded_runs: tuple[int, ...]
    """Sites on the cycle at the end of runs at c = 0.2011 from nuclei of random phases."""

    @property
    def stable(self) -> dict[int, float]:
        """Largest coupling of a stable breather of each size; sizes without one are omitted."""
        ends = {
            n: max((high for each in found for _, high in each.stable), default=0.0)
            for n, found in self.branches.items()
        }
        return {n: c for n, c in ends.items() if c}

    @property
    def odd_stable(self) -> tuple[int, ...]:
        """Odd sizes above 1 with a stable breather."""
        return tuple(n for n in self.stable if n % 2 and n > 1)

    @property
    def last(self) -> tuple[int, float]:
        """Size and coupling of the last fold of all."""
        return max(
            ((n, each.c_end) for n, found in self.branches.items() for each in found),
            key=lambda pair: pair[1],
        )

    @property
    def last_stable(self) -> tuple[int, float]:
        """Size and coupling of the last stable breather."""
        return max(self.stable.items(), key=lambda pair: pair[1])

    @property
    def unstable_left(self) -> tuple[float, ...]:
        """Growth rates of the unstable ones of the breathers that exist in (8) at c = 0.2011."""
        return tuple(each.growth for each in self.left if each.growth > 0.0)

    @property
    def stable_left(self) -> dict[int, float]:
        """Couplings up to which the stable ones of these exist, the largest of each size."""
        stable = [(each.end, each.size) for each in self.left if each.growth <= 0.0]
        return {size: end for end, size in sorted(stable)}

    @property
    def solvers_apart(self) -> float:
        """Largest difference of growth rates between the two solvers."""
        return max(abs(self.growth_here[n] - x) for n, x in self.growth_by_envelope.items())


@lru_cache(maxsize=1)
def nuclei() -> Nuclei:
    """Enumerate, follow and test every phase-locked breather."""
    from theory.chains.nucleus import Nucleus, outward_pattern, sites_for
    from theory.chains.vdp import VdpChain
    from verification.breathers.envelope import solve_envelope_breather
    from verification.references import phase_locked

    branches = {}
    for n in (*RANGE, *FAMILY):
        found = (phase_locked.locked_breathers if n in RANGE else phase_locked.family)(n, A, B)
        branches[n] = tuple(phase_locked.follow(each, A, B) for each in found)
    by_envelope, here, mirrored = {}, {}, {}
    for n in (1, 3, 5, 7):
        chain = VdpChain(a=A, b=B, c=0.1, eps=EPS, sites=sites_for(n))
        other = solve_envelope_breather(chain, Nucleus(n, outward_pattern(n)))
        by_envelope[n] = required(other.growth, f"breather of size {n} at c = 0.1")
        at = {
            c: phase_locked.outward_breather(n, c, A, B) for c in MIRRORED_AT if n > 1 or c == 0.1
        }
        here[n] = phase_locked.growth_rate(at[0.1], 0.1, A, B)
        if n > 1:
            mirrored[n] = max(
                phase_locked.growth_rate(u, c, A, B, mirrored=True) for c, u in at.items()
            )
    every = [(n, each) for n, found in branches.items() for each in found]
    late = max(each.c_end for _, each in every) - NEAR
    ends = [(n, *_orbit_end(each)) for n, each in every if each.c_end > late]
    return Nuclei(
        branches={
            n: tuple(Ended(c_end=each.c_end, stable=each.stable) for each in found)
            for n, found in branches.items()
        },
        growth_by_envelope=by_envelope,
        growth_here=here,
        growth_mirrored=mirrored,
        orbit_growth=_orbit_growth(branches[6]),
        orbit_end=max(end for _, end, _ in ends),
        left=tuple(
            Left(size=size, end=end, growth=growth)
            for size, end, growth in ends
            if growth is not None
        ),
        seeded_runs=_seeded_runs(),
    )


def _orbit(branch: LockedBranch, c: float) -> tuple[System, BranchPoint]:
    """Return the equations of orbits of (8), and the orbit of a phase-locked breather at c."""
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.breathers.orbits import Orbits
    from verification.continuation.newton import solve_at
    from verification.references import phase_locked

    point = phase_locked.follow_to(branch.first, c, A, B)
    centre = int(np.argmax(np.abs(point.phi)))
    phi = point.phi * np.exp(-1j * np.angle(point.phi[centre]))
    period = 2.0 * np.pi / (1.0 + EPS * point.omega)
    chain = VdpChain(a=A, b=B, c=c, eps=EPS, sites=phi.size)
    system = Orbits(chain, Nucleus(1)).system(centre=centre)
    return system, solve_at(system, np.concatenate([phi.imag, phi.real, [period]]), c)


def _orbit_growth(branches: tuple[LockedBranch, ...]) -> tuple[float, ...]:
    """Return growth rates in (8) of stable breathers of six sites, by shooting with scipy."""
    return tuple(
        _growth(_orbit(branch, ORBIT_AT)[1].u, ORBIT_AT)
        for branch in branches
        if any(high > ORBIT_AT for _, high in branch.stable)
    )


def _growth(u: FloatArray, c: float) -> float:
    """Return the largest growth rate per unit of εt of perturbations of (state, period)."""
    moduli = np.linalg.eigvals(monodromy_by_differences(u[:-1], c, float(u[-1])))
    others = np.delete(moduli, np.argmin(np.abs(moduli - 1.0)))
    return float(np.log(np.abs(others).max()) / (EPS * u[-1]))


def _orbit_end(branch: LockedBranch) -> tuple[float, float | None]:
    """Return where a breather ends in (8), and its growth rate at 0.2011 if it exists there."""
    from verification.continuation.branch import arrive, trace

    system, start = _orbit(branch, 0.99 * branch.c_end)
    followed = trace(system, start, 1.1 * branch.c_end)
    fold = followed.fold
    end = required(None if fold is None else fold.parameter, f"fold near {branch.c_end:.4f}")
    return end, _growth(arrive(system, followed, LAST).u, LAST) if end > LAST else None


def _seeded_runs() -> tuple[int, ...]:
    """Run the averaged chain at the last printed coupling from nuclei with random phases."""
    from theory.chains.vdp import VdpChain
    from verification.runs.envelope_run import run_envelope

    sites, reached = 41, []
    chain = VdpChain(a=A, b=B, c=LAST, eps=EPS, sites=sites)
    for n in range(1, 9):
        phases = np.random.default_rng(n).uniform(-np.pi, np.pi, n)
        phi = np.zeros(sites, dtype=complex)
        first = (sites - n) // 2
        phi[first : first + n] = chain.stable_amplitude * np.exp(1j * phases)
        run = run_envelope(chain, phi, 3000.0)
        reached.append(int(np.count_nonzero(np.abs(run.phi) > chain.unstable_amplitude)))
    return tuple(reached)


def rule_stable(e: Nuclei) -> Ruling:
    """Rule: some breather of each larger odd size must be stable against every perturbation."""
    if e.solvers_apart > SOLVERS or max(e.growth_mirrored.values()) > 0.0:
        return fails("breathers of larger odd sizes are unstable in the paper's own symmetry.")
    if set(e.odd_stable) >= {3, 5, 7}:
        return holds()
    return partly(
        "stability loss",
        "breathers of 3, 5 and 7 sites are stable up to their folds against perturbations that "
        "keep the mirror symmetry of the paper's start, and at no coupling against others.",
    )


def rule_all_lost(e: Nuclei) -> Ruling:
    """Rule: no breather may be stable beyond 0.2011 as printed, nor a run stay localised there."""
    beyond = {n: c for n, c in e.stable_left.items() if c >= LAST + CONVERGED}
    localised = e.last_stable[1] >= LAST + CONVERGED or min(e.seeded_runs) <= max(RANGE)
    if localised or min(beyond, default=math.inf) <= max(RANGE) or e.solvers_apart >= SOLVERS:
        return fails("a localised state is left at the largest printed coupling.")
    if beyond:
        return partly(
            "all possible nuclei",
            "nuclei of up to 8 sites lose stability by then, but in (8) a breather of "
            f"{max(beyond, key=lambda n: beyond[n])} sites is stable up to c = "
            f"{max(beyond.values()):.5f}.",
        )
    return holds()


def draw_thresholds(e: Folds) -> tuple[Picture, ...]:
    """Draw Fig. 11."""
    figure, axes = new_axes("column", height=3.0, xlabel="nucleus size",
                            ylabel=r"critical coupling $c_{cr}$")  # fmt: skip
    sizes, blue, curves = list(e.orbit), COLOURS["blue"], Curves()
    axes.plot(*curves.add("(8)", size=sizes, c=list(e.orbit.values())), "o-", color=blue, lw=0.8,
              label="end of the breather in (8)")  # fmt: skip
    axes.plot(*curves.add("averaged", size=sizes, c=list(e.averaged.values())), "o", mfc="none",
              ms=6, color=blue, label="the same, ε → 0")  # fmt: skip
    printed = [float(text) for text in PRINTED.values()]
    axes.plot(*curves.add("paper", size=list(PRINTED), c=printed), "D", mfc="none", ms=6,
              color="black", label="paper")  # fmt: skip
    for n, text in PRINTED.items():
        axes.annotate(text, (n, float(text)), xytext=(7, -2), textcoords="offset points",
                      fontsize=7)  # fmt: skip
    axes.set(xticks=sizes, ylim=(0.19, 0.2035))
    axes.set(title=r"$a$ = 2.5, $b$ = 0.5, $\varepsilon$ = 0.01, bulk, mirror-symmetric")
    axes.legend(loc="lower right")
    return (picture("fig11-thresholds", figure, long_table(curves)),)


def draw_nuclei(e: Nuclei) -> tuple[Picture, ...]:
    """Draw where every breather ends, and the ranges in which some are stable."""
    figure, axes = new_axes("column", height=3.5, xlabel="nucleus size", ylabel="coupling c")
    every = [(n, each) for n, found in e.branches.items() for each in found]
    curves, blue = Curves(), COLOURS["blue"]
    for name, mark, stable in (
        ("end of a breather, stable in the bar", "o", True),
        ("end of a breather, never stable", "x", False),
    ):  # fmt: skip
        ends = [(n, each.c_end) for n, each in every if bool(each.stable) is stable]
        n, c = zip(*ends, strict=True)
        axes.plot(*curves.add(name, size=n, c=c), mark, ms=4 if stable else 3,
                  color=blue if stable else "0.55", label=name)  # fmt: skip
    bars = [(n, c) for n, each in every if each.stable for c in (*each.stable[0], np.nan)]
    n, c = zip(*bars, strict=True)
    axes.plot(*curves.add("stable range", size=n, c=c), color=blue, lw=2)
    axes.axhline(LAST, color="black", ls=":", lw=1.0, label="paper: all lost at 0.2011")
    axes.set(xticks=[*RANGE, *FAMILY], ylim=(0.17, 0.203))
    axes.set(title=r"$a$ = 2.5, $b$ = 0.5, averaged chain (43)")
    figure.legend(loc="outside lower center")
    return (picture("fig11-nuclei", figure, long_table(curves)),)


CLAIMS = (
    Claim.beside(
        "fig11-values", evidence=sweeps, rule=rule_values, figure=draw_values, shared=folds
    ),
    Claim.beside("fig11-order", evidence=folds, rule=rule_order, shared=folds),
    Claim.beside("fig11-converged", evidence=folds, rule=rule_converged, shared=folds),
    Claim.beside(
        "fig11-stable",
        evidence=nuclei,
        rule=rule_stable,
        figure=draw_nuclei,
        weight=2,
        expensive=True,
    ),
    Claim.beside("fig11-all-lost", evidence=nuclei, rule=rule_all_lost, expensive=True),
)
