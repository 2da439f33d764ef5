"""Fig. 15: the map of states of the Van der Pol chain over (η, c), and its similarity to Fig. 5."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._maps import FEW, REGIONS, LabelledMap
from paper_checks.report.state_picture import draw_states
from paper_checks.ruling import fails, holds
from verification.pictures.data_table import long_table
from verification.pictures.figures import new_axes, picture

if TYPE_CHECKING:
    from verification.execution.table import Table

ETAS = tuple(round(0.01 * n, 2) for n in range(1, 15))
COUPLINGS = tuple(round(0.05 * n, 2) for n in range(1, 21))
"""Couplings of the command below, since the points of the paper cannot be read."""
LARGEST_SHARE = 0.1
"""Largest share of points that may differ between (8) and its average: about one point in ten is
next to a boundary, and boundaries are displaced by O(ε_eff)."""
CHECKED = ((0.03, 0.5), (0.05, 0.05), (0.13, 0.5))
"""η and c of a front, a breather and the fixed point that are also run by scipy."""
EMPTIED, EMPTIED_AT = 0.09, (0.3, 0.35, 0.4, 0.5, 0.6, 0.8, 1.0)
"""η, beside the undecided points, and couplings at which a front fills the chain and is
monitored."""
WATCHED = 1000.0
"""Slow time for which it is monitored: half of the end time of the map."""
SCIPY_END = 60.0
"""Slow time in which this front crosses the 16 sites twice, and rest is reached to 1e-12."""


@lru_cache(maxsize=1)
def labels_by_scipy() -> tuple[str, ...]:
    """Run (8) by scipy at `CHECKED`, and count the sites that are on the cycle at the end."""
    from verification.maps.vdp_rules import DISPLACEMENT, FIGURE_15
    from verification.references.equations import full_rate
    from verification.references.pace import last_state

    names = []
    for eta, c in CHECKED:
        chain = FIGURE_15.replace(a=float(np.sqrt(FIGURE_15.b / eta)), c=c)
        start = np.zeros(2 * chain.sites)
        start[chain.sites - 1] = DISPLACEMENT
        size = np.hypot(
            *np.split(last_state(full_rate(chain), SCIPY_END / chain.eps, start, 1e-6, 1e-8), 2)
        )
        # Between the amplitudes of the two cycles if there are two, otherwise above rest.
        active = int(np.count_nonzero(size > np.sqrt(2.0 * chain.a / chain.b) / 2.0))
        names.append({0: "fixed point", chain.sites: "front"}.get(active, "breather"))
    return tuple(names)


@dataclass(frozen=True, kw_only=True)
class VdpStateMap(LabelledMap):
    """Labels by (8) and by the averaged chain."""

    by_scipy: tuple[str, ...]
    """Labels at `CHECKED`."""
    same: int
    least: dict[float, int]
    """Smallest number of sites on the cycle after the chain filled, by coupling, at `EMPTIED`."""
    other_reading: int
    """Number of points that keep their label if a = 4 is held instead of b = 0.5, averaged."""

    @property
    def confirmed(self) -> bool:
        """Whether the map has the same labels as the runs by scipy."""
        return self.by_scipy == labels_at_checked(self.states)

    @property
    def filled_once(self) -> str:
        """The undecided points up to `EMPTIED`, where fronts fill the chain."""
        chosen = (self.states["label"] == "undecided") & (self.states["eta"] <= EMPTIED)
        pairs = zip(self.states["eta"][chosen], self.states["c"][chosen], strict=True)
        return " and ".join(f"η = {eta:g}, c = {c:g}" for eta, c in pairs)


def labels_at_checked(states: Table) -> tuple[str, ...]:
    """Return the labels of a map at `CHECKED`."""
    return tuple(
        str(states["label"][np.isclose(states["eta"], eta) & np.isclose(states["c"], c)][0])
        for eta, c in CHECKED
    )


def sequence(states: Table, name: str, value: float) -> tuple[str, ...]:
    """Return the states met with growing c at one forcing, without undecided points."""
    here = states[name] == value
    order = np.argsort(states["c"][here])
    labels = [x for x in states["label"][here][order].tolist() if x != "undecided"]
    return tuple(x for k, x in enumerate(labels) if k == 0 or x != labels[k - 1])


def sequences(states: Table, name: str) -> set[tuple[str, ...]]:
    """Return the sequences of states met with growing c, over all forcings."""
    return {sequence(states, name, float(value)) for value in np.unique(states[name])}


def state_map() -> VdpStateMap:
    """Label the map by both equations, and bisect its boundaries by the averaged one."""
    from verification.execution.sweep import sweep
    from verification.maps.boundary import Bisection, boundary_lines
    from verification.maps.state_map import compare
    from verification.maps.task import StateTask, state_points
    from verification.maps.vdp_rules import FIGURE_15

    full = StateTask(chain=FIGURE_15)
    average = StateTask(chain=FIGURE_15.averaged())
    points = state_points(full, {"eta": ETAS, "c": COUPLINGS})
    states = sweep(full, points, workers=1)
    averaged = sweep(average, points, workers=1)
    lines = boundary_lines(averaged, ("eta", "c"))
    held = sweep(StateTask(chain=FIGURE_15.averaged().replace(a=4.0), held="a"), points, workers=1)
    return VdpStateMap(
        by_scipy=labels_by_scipy(),
        states=states,
        boundary=sweep(Bisection(average.alone(), 1e-3), lines, workers=1),
        same=compare(states, averaged).same,
        least={c: _least_after_filling(EMPTIED, c) for c in EMPTIED_AT},
        other_reading=compare(averaged, held).same,
    )


def _least_after_filling(eta: float, c: float) -> int:
    """Return the smallest number of sites on the cycle after the front has filled the chain."""
    from verification.maps.vdp_rules import DISPLACEMENT, FIGURE_15
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain = FIGURE_15.replace(a=float(np.sqrt(FIGURE_15.b / eta)), c=c)
    run = simulate(chain, excite(chain, (chain.sites,), DISPLACEMENT), WATCHED / chain.eps,
                   samples=1 + round(WATCHED), tolerance=1e-8)  # fmt: skip
    level = np.sqrt(2.0 * chain.a / chain.b) / 2.0
    active = (run.amplitude > level).sum(axis=1)
    if active.max() < chain.sites:
        raise ArithmeticError(f"no front fills the chain at η = {eta:g}, c = {c:g}")
    return int(active[int(active.argmax()) :].min())


def rule_map(e: VdpStateMap) -> Ruling:
    """Rule: all three states must occur, few points be undecided, and both equations agree."""
    three = all(e.counts.get(name, 0) for name in REGIONS)
    agreed = e.same >= (1.0 - LARGEST_SHARE) * e.points
    if three and agreed and e.confirmed and e.undecided <= FEW * e.points:
        return holds()
    return fails("the map does not have these three states.")


def draw(e: VdpStateMap) -> tuple[Picture, ...]:
    """Draw Fig. 15."""
    figure, axes = new_axes("column", height=4.0, xlabel="η = b/a²", ylabel="coupling c")
    drawn = draw_states(axes, e.states, "eta", "c", e.boundary, lines="boundary of (43), bisected",
                        names={"front": "front, stays filled"})  # fmt: skip
    axes.axvline(0.125, color="0.4", lw=0.8, ls=":", label="η = 1/8, the cycle ends")
    axes.set(title=r"16 oscillators, $\varepsilon$ = 0.01, $y_{16}(0)$ = 6, $b$ = 0.5")
    figure.legend(loc="outside lower center", ncols=2, columnspacing=1.0)
    return (picture("fig15-states", figure, long_table(drawn)),)


CORE = (("breather", "front"), ("breather", "fixed point"), ("fixed point",))
"""What similar maps have in common, in order of growing forcing."""


@dataclass(frozen=True, kw_only=True)
class Alike:
    """Sequences of states with growing c, in either map."""

    one: frozenset[tuple[str, ...]]
    two: frozenset[tuple[str, ...]]
    first_at: dict[str, tuple[float, ...]]
    """Smallest forcing at which each of `CORE` occurs, by model."""
    confirmed: bool
    """Whether the map of Model II has the same labels as the runs by scipy."""


def alike() -> Alike:
    """Read both maps column by column, from weak to strong coupling."""
    from theory.chains.friction import FrictionChain
    from verification.execution.sweep import sweep
    from verification.maps.task import StateTask, state_points
    from verification.maps.vdp_rules import FIGURE_15

    belt = StateTask(chain=FrictionChain(c=0.0)).alone()
    couplings, speeds = (
        (0.005, 0.015, 0.025, 0.035, 0.055, 0.095),
        (1.1, 1.25, 1.35, 1.45, 1.6, 1.9),
    )
    one = sweep(belt, state_points(belt, {"c": couplings, "v_d": speeds}), workers=1)
    average = StateTask(chain=FIGURE_15.averaged())
    two = sweep(average, state_points(average, {"eta": ETAS, "c": COUPLINGS}), workers=1)
    first = {}
    for name, table, forcing in (("I", one, "v_d"), ("II", two, "eta")):
        met = {float(x): sequence(table, forcing, float(x)) for x in np.unique(table[forcing])}
        first[name] = tuple(
            min((x for x, seen in met.items() if each == seen), default=np.inf) for each in CORE
        )
    return Alike(
        one=frozenset(sequences(one, "v_d")),
        two=frozenset(sequences(two, "eta")),
        first_at=first,
        confirmed=labels_by_scipy() == labels_at_checked(two),
    )


def rule_alike(e: Alike) -> Ruling:
    """Rule: both maps must have the core sequences, in the same order of growing forcing."""
    shared = all(each in e.one and each in e.two for each in CORE)
    ordered = all(list(row) == sorted(row) for row in e.first_at.values())
    if shared and ordered and e.confirmed:
        return holds()
    return fails("the two maps do not have the same states in the same places.")


CLAIMS = (
    Claim.beside("fig15-regions", evidence=state_map, rule=rule_map, figure=draw, expensive=True),
    Claim.beside("fig15-alike", evidence=alike, rule=rule_alike, expensive=True),
)
