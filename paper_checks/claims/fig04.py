"""Fig. 4: critical coupling of the friction chain against the size of the nucleus."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._friction import SITES, chain_of, disagreement
from paper_checks.ruling import fails, holds, partly, rounding
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, picture

SIZES = (1, 3, 5, 7, 9)
ACCURACY = 2e-5
"""Half-widths of the brackets of the thresholds."""
PRINTED = 40.0
ABOUT = 10.0 * rounding("40")
"""'About 40 %' is a number of one digit: half a unit of its tens."""
INSENSITIVE = 0.1
"""A change that is barely visible beside the fall of 40 % at the edge: a quarter of it."""
LONG = 60_000.0
STALL = 20_000.0
"""Time without a new site after which a front has stopped; here it takes at most 1300 per site."""
BEFORE_END = 2
"""Number of sites before a free end at which a slow front may stop: there it is affected by the
wave reflected from the end, whereas the sentence is about the chain and not about its last
sites."""
KINDS = (("edge", 1), ("edge", 3), ("bulk", 1), ("bulk", 3), ("bulk", 7))
ASIDE = 0.02
"""Relative distance from a threshold at which long runs must lie on either side of it."""


def _threshold(size: int, place: str, ends: str = "free", **options: Any) -> float:
    from dataclasses import replace

    from theory.chains.ends import Ends
    from theory.chains.nucleus import Place
    from verification.thresholds.spreading import Spreading, spreading_threshold

    chain = replace(chain_of(0.0), ends=Ends(ends))
    spreading = Spreading(size, Place(place), **options)
    return spreading_threshold(chain, spreading, lowest=0.005, accuracy=ACCURACY, tests=0).c_crit


@dataclass(frozen=True, kw_only=True)
class Thresholds:
    """Critical couplings by place and size, for one new site by τ = 1000 and free ends."""

    edge: tuple[float, ...]
    bulk: tuple[float, ...]
    bulk_of_two: float
    literal: tuple[float, float]
    """Those for sizes 1 and 3 at the edge with (5) taken literally at its ends."""
    gap: float

    @property
    def falls(self) -> tuple[float, ...]:
        """Decrease at the edge from size 1 to each larger size, in per cent."""
        return tuple(100.0 * (1.0 - c / self.edge[0]) for c in self.edge[1:])

    @property
    def bulk_fall(self) -> float:
        """Decrease in the bulk from size 1 to size 3, as a fraction."""
        return 1.0 - self.bulk[1] / self.bulk[0]

    @property
    def bulk_rest(self) -> float:
        """Spread over sizes 3 to 9 in the bulk, as a fraction."""
        return 1.0 - min(self.bulk[1:]) / max(self.bulk[1:])

    @property
    def apart(self) -> float:
        """Difference between two sites in the bulk and one at the edge; zero by symmetry."""
        return abs(self.bulk_of_two - self.edge[0])


@lru_cache(maxsize=1)
def thresholds() -> Thresholds:
    """Bisect every threshold of the figure, and check two of them by scipy."""
    edge = tuple(_threshold(size, "edge") for size in SIZES)
    # Close to the threshold for three sites, a new site takes longer than a run by scipy can last.
    cases: list[tuple[tuple[int, ...], float]] = [
        ((1,), edge[0] * (1.0 + side)) for side in (-ASIDE, ASIDE)
    ]
    cases += [((1, 2, 3), edge[1] * factor) for factor in (0.97, 1.4)]
    return Thresholds(
        edge=edge,
        bulk=tuple(_threshold(size, "bulk") for size in SIZES),
        bulk_of_two=_threshold(2, "bulk"),
        literal=(_threshold(1, "edge", "literal"), _threshold(3, "edge", "literal")),
        gap=max(disagreement(chain_of(c, 5), excited, 400.0) for excited, c in cases),
    )


def rule_edge(e: Thresholds) -> Ruling:
    """Rule: the threshold of every larger size must lie about 40 per cent below that of size 1."""
    checked = e.gap < 1e-3 and e.apart < 2.0 * ACCURACY
    if checked and all(abs(fall - PRINTED) <= ABOUT for fall in e.falls):
        return holds()
    return fails("the fall from size 1 to larger sizes is not about 40 %.")


def rule_bulk(e: Thresholds) -> Ruling:
    """Rule: no size may change the threshold by more than a tenth."""
    checked = e.gap < 1e-3 and e.apart < 2.0 * ACCURACY
    if not checked or e.bulk_rest > INSENSITIVE:
        return fails("the threshold changes with every size.")
    if e.bulk_fall < INSENSITIVE:
        return holds()
    return partly(
        "almost insensitive",
        f"from size 1 to 3 the threshold falls by {e.bulk_fall:.0%}, and is insensitive to the "
        "size only from 3 on.",
    )


def draw(e: Thresholds) -> tuple[Picture, ...]:
    """Draw Fig. 4."""
    figure, axes = new_axes("column", height=2.7)
    curves = Curves()
    for place, values, style, colour in (
        ("edge", e.edge, "o-", "black"), ("bulk", e.bulk, "s--", "vermilion"),
    ):  # fmt: skip
        axes.plot(*curves.add(place, size=SIZES, c_crit=values, error=ACCURACY), style,
                  color=COLOURS[colour], label=f"“{place}” excitation")  # fmt: skip
    mark = (1.0 - PRINTED / 100.0) * e.edge[0]
    axes.plot(*curves.add("paper, edge", size=SIZES[1:], c_crit=[mark] * 4), lw=4, alpha=0.4,
              color=COLOURS["blue"], label="paper: about 40 % below edge, size 1")  # fmt: skip
    axes.set(xticks=SIZES, ylim=(0.0, 0.0145), xlabel=r"nucleus size $N_\mathrm{size}$")
    axes.set(ylabel=r"critical coupling $(c)_\mathrm{crit}$")
    axes.set(title=r"$\tilde{v}_d$ = 1.25, $N_\mathrm{dof}$ = 31")
    axes.legend(loc="upper right")
    return (picture("fig04-thresholds", figure, long_table(curves)),)


@dataclass(frozen=True, kw_only=True)
class LongRuns:
    """Long runs on either side of each threshold."""

    thresholds: tuple[float, ...]
    """One result for each kind in `KINDS`."""
    below: tuple[int, ...]
    """Number of sites that have stuck by `LONG`, 2 % below each threshold."""
    above: tuple[int, ...]
    """Number of sites that have stuck when the front stops or has filled the chain, 2 % above."""
    longer: dict[str, int]
    """The same in a chain of twice the length, for the kinds that did not fill the first one."""
    gap: float

    @property
    def falls(self) -> tuple[float, float]:
        """Decrease from size 1 to 3 at the edge and in the bulk, in per cent."""
        c = self.thresholds
        return 100.0 * (1.0 - c[1] / c[0]), 100.0 * (1.0 - c[3] / c[2])

    @property
    def left(self) -> int:
        """Largest number of sites left at rest before a free end by a front, in either chain."""
        return max([SITES - min(self.above), *(2 * SITES - n for n in self.longer.values())])


def _reached(c: float, size: int, place: str, sites: int, stall: float) -> int:
    """Return how many sites have stuck when all have, or none has for the stall time."""
    from theory.chains.nucleus import Nucleus, Place
    from verification.runs.excite import excite
    from verification.runs.friction_integration import FrictionIntegration

    chain = chain_of(c, sites)
    run = FrictionIntegration(
        chain, excite(chain, Nucleus(size, place=Place(place)).excited(sites)), tolerance=1e-9
    )
    latest = 0.0
    while np.isnan(run.arrivals).any() and run.time < latest + stall:
        run.advance_to(run.time + 0.25 * stall)
        latest = float(np.nanmax(run.arrivals, initial=0.0))
    return int(np.count_nonzero(~np.isnan(run.arrivals)))


def long_runs() -> LongRuns:
    """Bisect with τ = 4000 for the first new site, then run 2 % aside until nothing changes."""
    found = tuple(_threshold(size, place, final_time=4000.0) for place, size in KINDS)
    pairs = list(zip(found, KINDS, strict=True))
    above = [_reached((1.0 + ASIDE) * c, n, place, SITES, STALL) for c, (place, n) in pairs]
    return LongRuns(
        thresholds=found,
        below=tuple(_reached((1.0 - ASIDE) * c, n, place, SITES, LONG) for c, (place, n) in pairs),
        above=tuple(above),
        longer={
            f"{place} {n}": _reached((1.0 + ASIDE) * c, n, place, 2 * SITES, STALL)
            for (c, (place, n)), count in zip(pairs, above, strict=True)
            if count < SITES
        },
        gap=disagreement(chain_of((1.0 + ASIDE) * found[0], 5), (1,), 400.0),
    )


def rule_divides(e: LongRuns) -> Ruling:
    """Rule: below, only the nucleus sticks; above, a front travels through the whole chain.

    If it stops before a free end, it must stop equally close to the end of a chain twice as long.
    """
    stay = all(n == size for n, (_, size) in zip(e.below, KINDS, strict=True))
    if stay and e.left <= BEFORE_END and e.gap < 1e-3:
        return holds()
    return fails("beside a threshold a nucleus spreads over a part of the chain and stops.")


CLAIMS = (
    Claim.beside("fig04-edge", evidence=thresholds, rule=rule_edge, figure=draw, shared=thresholds),
    Claim.beside("fig04-bulk", evidence=thresholds, rule=rule_bulk, shared=thresholds),
    Claim.beside("fig04-divides", evidence=long_runs, rule=rule_divides, expensive=True),
)
