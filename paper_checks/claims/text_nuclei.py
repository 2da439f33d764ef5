"""The fate of the breather of one particle at the end of its existence, Model II (section 2.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._breathers import EPS, A, B
from paper_checks.ruling import fails, holds, partly
from verification.pictures.figures import COLOURS, new_axes, picture

if TYPE_CHECKING:
    from verification.breathers.outcome import FollowedNucleus

CHAIN_SITES = 41
"""Length with room for twenty new sites on each side, so that no stationary nucleus reaches an
end."""
COUPLINGS = (0.19, 0.1913, 0.193, 0.195, 0.197, 0.199, 0.201, 0.203)
NOISE, SEEDS = 1e-3, (1, 2)
DRAWN = (0.193, 0.197, 0.199, 0.203)


@dataclass(frozen=True, kw_only=True)
class ToLarger:
    """Outcome for the nucleus by seed (None for exact mirror symmetry) and coupling."""

    ends: dict[int | None, dict[float, str]]
    sizes: dict[int | None, dict[float, int]]
    histories: dict[tuple[int | None, float], tuple[float, ...]]
    """Number of sites that have joined, at 201 slow times up to 1000."""
    confirmed: bool
    """Whether runs at a hundred times the tolerance have the same outcome."""
    gap: float
    """Amplitudes of stationary nuclei compared with periodic orbits of their size."""
    ripple: float

    def words(self, seed: int | None) -> str:
        """Write the outcomes by coupling, for one seed."""
        named = {"larger nucleus": "{} sites stationary", "creep": "{} sites, growing irregularly,"}
        return ", ".join(
            f"{named.get(end, end).format(self.sizes[seed][c])} at {c:g}"
            for c, end in self.ends[seed].items()
        )

    def summary(self, seed: int | None) -> str:
        """Write the couplings at which larger nuclei are stationary, and at which a front runs."""
        larger = [c for c, end in self.ends[seed].items() if end == "larger nucleus"]
        fronts = [c for c, end in self.ends[seed].items() if end == "front"]
        sizes = [self.sizes[seed][c] for c in larger]
        nuclei = (
            f"larger nuclei, of {min(sizes)} to {max(sizes)} sites, are stationary from "
            f"c = {min(larger):g} to {max(larger):g}"
            if larger
            else "no larger nucleus is stationary"
        )
        front = f"a front runs from c = {min(fronts):g} on" if fronts else "no front runs"
        return f"{nuclei}; {front}"

    @property
    def noisy(self) -> str:
        """The summary with noise."""
        return " or ".join(dict.fromkeys(self.summary(seed) for seed in SEEDS))

    @property
    def noisy_each(self) -> str:
        """The outcomes with noise, at each coupling."""
        return "; ".join(f"seed {seed}: {self.words(seed)}" for seed in SEEDS)


def to_larger() -> ToLarger:
    """Follow the single nucleus past the end of its breather, with and without symmetry."""
    from theory.chains.vdp import VdpChain
    from verification.breathers.outcome import distance_from_breather, follow_nucleus

    found: dict[tuple[int | None, float], FollowedNucleus] = {}
    for seed in (None, *SEEDS):
        for c in COUPLINGS:
            chain = VdpChain(a=A, b=B, c=c, eps=EPS, sites=CHAIN_SITES)
            noise = 0.0 if seed is None else NOISE
            found[seed, c] = follow_nucleus(chain, perturbation=noise, seed=seed or 0)
    larger = [c for c in COUPLINGS if found[None, c].evolution.outcome.value == "larger nucleus"]
    every = (None, *SEEDS)
    return ToLarger(
        ends={s: {c: found[s, c].evolution.outcome.value for c in COUPLINGS} for s in every},
        sizes={s: {c: found[s, c].evolution.size for c in COUPLINGS} for s in every},
        histories={
            (s, c): tuple(
                float(found[s, c].evolution.size_at(at)) for at in np.linspace(0, 1000, 201)
            )
            for s in (None, SEEDS[0])
            for c in DRAWN
        },
        confirmed=all(each.confirmed for each in found.values()),
        gap=max((distance_from_breather(found[None, c]).gap for c in larger), default=0.0),
        ripple=2.0 * EPS * found[None, COUPLINGS[0]].run.chain.stable_amplitude,
    )


def succession(ends: Mapping[float, str]) -> bool:
    """Return whether larger nuclei are stationary in some range, and fronts run only above it."""
    larger = [c for c, end in ends.items() if end == "larger nucleus"]
    run = [c for c, end in ends.items() if end == "front"]
    return bool(larger and run) and max(larger) < min(run)


def rule_to_larger(e: ToLarger) -> Ruling:
    """Rule: larger nuclei must be stationary before fronts run, also with noise (attractors)."""
    if not e.confirmed or e.gap > e.ripple or not succession(e.ends[None]):
        return fails("no larger nucleus is stationary between the single one and the front.")
    if all(succession(e.ends[seed]) for seed in SEEDS):
        return holds()
    return partly(
        "to DBs with a larger nucleus",
        "larger nuclei are stationary only where exact mirror symmetry is kept, and from a "
        "slightly perturbed start the nucleus keeps growing irregularly instead.",
    )


def draw_to_larger(e: ToLarger) -> tuple[Picture, ...]:
    """Draw the size of the nucleus against slow time."""
    figure, axes = new_axes("column", height=3.2, xlabel="slow time εt",
                            ylabel="sites in the nucleus")  # fmt: skip
    times = np.linspace(0.0, 1000.0, 201)
    data: dict[str, np.ndarray] = {"slow_time": times}
    for c, colour in zip(DRAWN, ("blue", "green", "purple", "vermilion"), strict=True):
        for seed, style in ((None, "-"), (SEEDS[0], ":")):
            values = np.array(e.histories[seed, c])
            data[f"c_{c:g}_{'mirrored' if seed is None else 'perturbed'}"] = values
            label = f"c = {c:g}" if seed is None else None
            axes.plot(times, values, style, color=COLOURS[colour], label=label)
    axes.plot([], [], "-", color="0.4", label="mirror-symmetric")
    axes.plot([], [], ":", color="0.4", label="noise of 1e-3")
    axes.set(ylim=(0, CHAIN_SITES + 1), title=r"$a$ = 2.5, $b$ = 0.5, $\varepsilon$ = 0.01")
    figure.legend(loc="outside lower center", ncols=3)
    return (picture("text-larger-nuclei", figure, data),)


CLAIMS = (
    Claim.beside(
        "text-to-larger",
        evidence=to_larger,
        rule=rule_to_larger,
        figure=draw_to_larger,
        weight=2,
        expensive=True,
    ),
)
