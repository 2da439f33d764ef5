"""Fig. 8: amplitudes of the sites n = 0 and 1 against coupling, and the underlying assumptions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._breathers import EPS, A, B, flow
from paper_checks.claims._orbits import CENTRE, SMALL, averaged_of, orbit_of
from paper_checks.ruling import fails, holds
from theory.arrays import FloatArray
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, new_panels, picture

if TYPE_CHECKING:
    from theory.averaged.breather import Reading

COUPLINGS = (0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.16, 0.175, 0.185, 0.19)
MARK = 0.02 * 3.0
"""Two per cent of the axis of Fig. 8: the width of its circles."""
C = 0.1
EPSILONS = (0.04, 0.02, 0.01, 0.005)


def closed_form(reading: Reading, places: FloatArray) -> FloatArray:
    """Return the amplitudes of n = 0 and 1 by (29), (37) and (38)."""
    from theory.averaged.breather import solve_breather
    from theory.chains.vdp import VdpChain

    chains = [VdpChain(a=A, b=B, c=float(c), eps=EPS) for c in places]
    return np.array([solve_breather(chain, reading).amplitudes(2) for chain in chains])


@dataclass(frozen=True, kw_only=True)
class OrbitAmplitudes:
    """Amplitudes of n = 0 and 1 on the orbit and by the closed form, shape (11, 2)."""

    exact: FloatArray
    theory: FloatArray
    tail: FloatArray
    """The closed form with (37) evaluated in the far tail instead of at n = 1."""
    centre_has_none: bool
    """Whether (37) evaluated at n = 0 has no solution."""
    error: float
    closing: float
    """Closure error of two of the orbits under scipy's flow."""

    @property
    def off(self) -> tuple[float, float]:
        """Largest error of the closed form at n = 0 and n = 1."""
        worst = np.abs(self.theory - self.exact).max(axis=0)
        return float(worst[0]), float(worst[1])

    @property
    def off_tail(self) -> float:
        """The same at n = 1, with (37) in the tail."""
        return float(np.abs(self.tail - self.exact)[:, 1].max())


def amplitudes() -> OrbitAmplitudes:
    """Solve (29) and (37), and the periodic orbit of (8), along the couplings of the figure."""
    from theory.averaged.breather import Reading, solve_breather
    from theory.chains.vdp import VdpChain

    c = np.array(COUPLINGS)
    orbits = [orbit_of(each) for each in COUPLINGS]
    closing = [
        float(np.abs(flow(orbits[k].state, COUPLINGS[k], orbits[k].period)
                     - orbits[k].state).max())
        for k in (4, 10)
    ]  # fmt: skip
    none = solve_breather(VdpChain(a=A, b=B, c=C, eps=EPS), Reading.CENTRE).status.value == "none"
    return OrbitAmplitudes(
        exact=np.array([orbit.amplitudes[CENTRE : CENTRE + 2] for orbit in orbits]),
        theory=closed_form(Reading.NEIGHBOUR, c),
        tail=closed_form(Reading.TAIL, c),
        centre_has_none=none,
        error=max(orbit.error for orbit in orbits if orbit.error is not None),
        closing=max(closing),
    )


def rule_amplitudes(e: OrbitAmplitudes) -> Ruling:
    """Rule: every circle of the figure must lie on its curve to within its own width."""
    if e.closing < 1e-8 and max(e.off) < MARK:
        return holds()
    return fails("the closed form is off by more than a circle of the figure.")


def draw_amplitudes(e: OrbitAmplitudes) -> tuple[Picture, ...]:
    """Draw Fig. 8."""
    from theory.averaged.breather import Reading

    figure, axes = new_axes("column", height=3.0, xlabel="coupling c", ylabel=r"amplitude of $y_n$")
    fine = np.concatenate([np.linspace(0.005, 0.18, 60), np.linspace(0.181, 0.1973, 60)])
    closed, curves = closed_form(Reading.NEIGHBOUR, fine), Curves()
    for n, colour in ((0, COLOURS["blue"]), (1, COLOURS["vermilion"])):
        axes.plot(*curves.add(f"closed form, n = {n}", c=fine, amplitude=closed[:, n]),
                  color=colour, label=f"n = {n}, paper: (29), (37), (38)")  # fmt: skip
        axes.plot(*curves.add(f"orbit, n = {n}", c=COUPLINGS, amplitude=e.exact[:, n]), "o", ms=4,
                  mfc="none", color=colour, label=f"n = {n}, periodic orbit of (8)")  # fmt: skip
    axes.set(xlim=(0, 0.2), ylim=(0, 3.05), xticks=(0, 0.05, 0.1, 0.15, 0.2))
    axes.set(title=r"$a$ = 2.5, $b$ = 0.5, $\varepsilon$ = 0.01")
    axes.legend(loc="center left", bbox_to_anchor=(0.0, 0.6))
    return (picture("fig08-amplitudes", figure, long_table(curves)),)


@dataclass(frozen=True, kw_only=True)
class Assumptions:
    """δ of (27) and k₂ + π/2 on orbits of (8), at each of `EPSILONS`."""

    detuning: tuple[float, ...]
    turns: tuple[float, ...]
    averaged: float
    """|Ω - c| in the averaged chain."""
    ratio: float
    """e^{k_1}, the first ratio of amplitudes."""

    @property
    def share(self) -> float:
        """|δ|/c at ε = 0.01."""
        return abs(self.detuning[2]) / C

    @property
    def needed(self) -> float:
        """|δ|/(c e^{k_1}) at ε = 0.01, which must be small for (28)."""
        return self.share / self.ratio

    @property
    def neglected(self) -> float:
        """The term neglected in (28): (δ/(c e^{k_1}))²."""
        return self.needed**2

    @property
    def turn(self) -> float:
        """k₂ + π/2 at ε = 0.01."""
        return self.turns[2]

    @property
    def orders(self) -> tuple[float, ...]:
        """Observed orders in ε of δ and of k₂ + π/2."""
        return tuple(
            math.log(abs(row[-2] / row[-1])) / math.log(EPSILONS[-2] / EPSILONS[-1])
            for row in (self.detuning, self.turns)
        )


@lru_cache(maxsize=1)
def assumptions() -> Assumptions:
    """Measure δ and the phase step on orbits at four ε, and in the averaged chain."""
    orbits = [orbit_of(C, eps) for eps in EPSILONS]
    pairs = zip(orbits, EPSILONS, strict=True)
    steps = [np.angle(each.waves[CENTRE + 1] / each.waves[CENTRE]) for each in orbits]
    amplitude = orbits[2].amplitudes
    return Assumptions(
        detuning=tuple((2.0 * math.pi / orbit.period - 1.0) / eps - C for orbit, eps in pairs),
        turns=tuple(float(step) + 0.5 * math.pi for step in steps),
        averaged=abs(float(averaged_of(C).unknowns[-1]) - C),
        ratio=float(amplitude[CENTRE + 1] / amplitude[CENTRE]),
    )


def _sound(e: Assumptions) -> bool:
    """Whether orbits tend to the averaged chain, where δ = 0 and k₂ = -π/2 hold exactly."""
    return e.averaged < 1e-9 and min(e.orders) > 0.9


def rule_assumptions(e: Assumptions) -> Ruling:
    """Rule: δ must be small compared with c, and k₂ + π/2 small."""
    if _sound(e) and e.share < SMALL and abs(e.turn) < SMALL:
        return holds()
    return fails("δ is not small beside c, or the phase step is not -π/2.")


def rule_neglected(e: Assumptions) -> Ruling:
    """Rule: what (28) neglects must be small compared with what it keeps."""
    if _sound(e) and e.neglected < SMALL:
        return holds()
    return fails("what (28) neglects is not small.")


def draw_assumptions(e: Assumptions) -> tuple[Picture, ...]:
    """Draw both assumptions against ε."""
    figure, (left, right) = new_panels(2, width="page", height=2.2)
    curves, small = Curves(), np.abs(e.detuning) / C
    left.plot(*curves.add("(27)", eps=EPSILONS, delta_over_c=small), "o-", color=COLOURS["blue"],
              label="|δ|/c")  # fmt: skip
    needed = curves.add("(28)", eps=EPSILONS, delta_over_c_exp_k1=small / e.ratio)
    left.plot(*needed, "s--", color=COLOURS["vermilion"],
              label=r"$|\delta|/(c\,e^{k_1})$, as (28) needs")  # fmt: skip
    left.axhline(SMALL, color="0.4", lw=0.8, ls=":", label=f"“small”: {SMALL:g}")
    right.plot(*curves.add("(37)", eps=EPSILONS, turn=np.abs(e.turns)), "o-",
               color=COLOURS["blue"], label=r"$|k_2+\pi/2|$")  # fmt: skip
    limit = curves.add("averaged chain", eps=[0.0], delta_over_c=[0.0], turn=[0.0])
    for axes in (left, right):
        axes.set(xlabel="ε", xlim=(0, 0.042), ylim=(0, None))
        axes.plot(*limit, "s", color="black", clip_on=False, label="averaged chain, ε → 0")
        axes.legend()
    left.set_title(r"$c$ = 0.1, $a$ = 2.5, $b$ = 0.5")
    return (picture("fig08-assumptions", figure, long_table(curves)),)


CLAIMS = (
    Claim.beside(
        "fig08-amplitudes", evidence=amplitudes, rule=rule_amplitudes, figure=draw_amplitudes
    ),
    Claim.beside(
        "fig08-assumptions",
        evidence=assumptions,
        rule=rule_assumptions,
        figure=draw_assumptions,
        shared=assumptions,
    ),
    Claim.beside(
        "fig08-neglected", evidence=assumptions, rule=rule_neglected, weight=0, shared=assumptions
    ),
)
