"""What the text asserts about the states and fronts of Model I."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.claims._friction import (
    SITES,
    V_D,
    chain_of,
    disagreement,
)
from paper_checks.following import following

PATTERNS = ((16,), (15, 16, 17), (3, 20), (5, 11, 12, 28), tuple(range(1, 31, 3)))
WEAK = 0.004
"""Sites excited, and the coupling of Fig. 3a."""

LATE = 4000.0
"""τ; at the lowest belt velocity all sites stick from τ = 2000 at the latest."""

SLOW, FAST = 1.05, 1.95
"""Belt velocities below and above the range in which the cell is bistable."""

LADDER = (0.002, 0.004, 0.006, 0.008, 0.009, 0.012, 0.016, 0.02, 0.03, 0.05, 0.07, 0.1)
KINDS = (("edge", 1), ("edge", 3), ("bulk", 1), ("bulk", 3), ("bulk", 9))
BEYOND = 1.35


def _kept(pattern: tuple[int, ...], belt: float, end: float) -> frozenset[int]:
    """Return the sites that stick between ``end`` and ``end`` + 40, some six periods."""
    from verification.runs.excite import excite
    from verification.runs.friction_integration import FrictionIntegration

    chain = chain_of(WEAK, SITES, belt)
    lane = FrictionIntegration(chain, excite(chain, pattern), tolerance=1e-8)
    lane.advance_to(end)
    lane.forget_arrivals()
    lane.advance_to(end + 40.0)
    return frozenset((np.flatnonzero(~np.isnan(lane.arrivals)) + 1).tolist())


def _many_patterns() -> Finding:
    """Start from several patterns, within and outside of the bistable range of the cell."""
    kept = {p: _kept(p, V_D, LATE) for p in PATTERNS}
    persist = [p for p in PATTERNS if kept[p] == frozenset(p)]
    slow = {_kept(p, SLOW, LATE) for p in PATTERNS}
    fast = {_kept(p, FAST, LATE) for p in PATTERNS}
    gap = 0.0
    for pattern in ((2, 6), (4,)):
        few = chain_of(WEAK, 7)
        gap = max(gap, disagreement(few, pattern, 60.0))
    many = len(set(kept.values())) == len(PATTERNS) == len(persist)
    only_there = slow == {frozenset(range(1, SITES + 1))} and fast == {frozenset()}
    verdict = Verdict.NOT_REPRODUCED
    if many:
        verdict = Verdict.REPRODUCED if only_there else Verdict.PARTIAL
    return Finding(
        verdict=verdict,
        value=(
            f"at v_d = {V_D:g} {len(persist)} of {len(PATTERNS)} patterns stay as they were "
            f"started; at {SLOW:g} they end in {len(slow)}, at {FAST:g} in {len(fast)}"
        ),
        error=f"none: sets of sites that stick, at τ = {LATE:g}",
        methods=(
            "Taylor steps from event to event on 31 sites",
            f"DOP853 with located events on 7 sites, two patterns: arrivals the same to {gap:.0e}",
        ),
        tolerance=f"exactly the excited sites must stick after τ = {LATE:g}, and no others",
        explanation=(
            f"At c = {WEAK:g} every one of these patterns persists: "
            + "; ".join(", ".join(map(str, p)) for p in PATTERNS)
            + f". That this comes from the bistable cell is seen outside of its range: at v_d = "
            f"{SLOW:g} steady sliding is unstable and all {SITES} sites stick, at {FAST:g} there "
            "is no cycle and none does, whatever the start. Whether some of the patterns are "
            "irregular in time, as [18] has it, is not judged here."
        ),
    )


def _promotes() -> Finding:
    """See on a ladder of couplings whether each kind of nucleus spreads."""
    from theory.chains.nucleus import Place
    from verification.thresholds.result import Definition
    from verification.thresholds.spreading import Spreading, spreads

    changes, first = [], []
    for place, size in KINDS:
        seen = [spreads(chain_of(c), Spreading(size, Place(place))) for c in LADDER]
        changes.append(sum(a != b for a, b in pairwise(seen)))
        first.append(LADDER[seen.index(True)] if any(seen) else np.inf)
    whole = [
        spreads(chain_of(c, SITES, BEYOND), Spreading(1, Place.BULK, Definition.WHOLE, 3000.0))
        for c in (0.03, 0.095)
    ]
    gap = max(disagreement(chain_of(c, 5), (1,), 300.0) for c in (0.009, 0.016))
    sharp = max(changes) == 1 and max(first) < np.inf
    return Finding(
        verdict=Verdict.REPRODUCED if sharp else Verdict.NOT_REPRODUCED,
        value="; ".join(
            f"{place} {size}: from c = {c:g}" for (place, size), c in zip(KINDS, first, strict=True)
        ),
        error=f"the ladder {', '.join(f'{c:g}' for c in LADDER)}",
        methods=(
            "runs from event to event, until a new site sticks or τ = 1000",
            f"DOP853 with located events on 5 sites, at c = 0.009 and 0.016: the same to {gap:.0e}",
        ),
        tolerance="each kind of nucleus must go over from staying to spreading once on the ladder",
        explanation=(
            f"At v_d = {V_D:g}, where Fig. 4 is, each kind of nucleus has one critical coupling: "
            "it stays localised below and spreads at every larger coupling tried. It is not so at "
            f"every belt velocity: at v_d = {BEYOND:g} one site in the bulk fills the chain at "
            f"c = 0.03 ({'yes' if whole[0] else 'no'}) and not at c = 0.095 "
            f"({'yes, it does' if whole[1] else 'it goes to rest'}), see Fig. 5."
        ),
    )


CLAIMS = (
    Claim(
        "text-intro-bistable",
        "Introduction",
        "Many localised patterns coexist in the chain, depending on the initial conditions, "
        "because its cell is bistable over a range of speeds.",
        None,
        Verdict.REPRODUCED,
        "fronts simulate friction --n 31 --c 0.004 --excite 5,11,12,28 --t-end 1000 --json",
        _many_patterns,
    ),
    following(
        "text-intro-propagating",
        "Introduction",
        "There is a region of parameters in which stick-slip propagates along the chain.",
        "fig03-front",
    ),
    following(
        "text-start-matters",
        "Section 1.2",
        "Initial conditions and coupling decide between breather and front.",
        "fig03-breather",
        "fig03-front",
        "text-coupling-promotes",
    ),
    Claim(
        "text-coupling-promotes",
        "Section 1.3, before Fig. 4",
        "A stronger coupling promotes propagation.",
        None,
        Verdict.REPRODUCED,
        "fronts threshold friction --place bulk --nucleus 3",
        _promotes,
    ),
    following(
        "text-critical-divides",
        "Caption of Fig. 4",
        "Below the critical coupling a breather is expected, above it a front.",
        "text-coupling-promotes",
    ),
    following(
        "text-after-front",
        "Section 1.3, after Fig. 5",
        "After propagation all oscillators of a finite chain are in stick-slip or, at higher "
        "speed, in steady sliding.",
        "fig05-regions",
        "fig05-nucleation",
    ),
)
