"""Fig. 2 and sections 1.1 and 1.2: the cell of Model I, its two states, and where each exists."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._required import required
from paper_checks.ruling import corrected, fails, holds
from verification.pictures.data_table import long_table
from verification.pictures.figures import COLOURS, new_axes, new_panels, picture

if TYPE_CHECKING:
    from theory.arrays import FloatArray
    from theory.cells.friction import FrictionCell
    from verification.cells.diagram import Bifurcation
    from verification.cells.result import BeltCell
    from verification.references.friction_events import EventRun
    from verification.runs.trajectory import Trajectory

V_D = 1.25
VELOCITIES = (0.5, 1.0, 1.2, 1.5, 1.8, 1.9)
"""Belt velocities run from both starts, on either side of both ends of the bistable range."""
LONG = 300.0
AGREE = 1e-8
"""Largest difference between shooting and runs with scipy; both are accurate to 1e-9."""
SETTLED = 500.0
"""τ after which sliding is steady on the scale of the picture: beats decay like exp(-0.009 τ)."""


@lru_cache(maxsize=1)
def _orbits() -> BeltCell:
    from theory.cells.friction import FrictionCell
    from verification.cells.friction import friction_cell

    return friction_cell(FrictionCell(v_d=V_D))


@lru_cache(maxsize=32)
def _scipy(cell: FrictionCell, y: float, t_end: float, samples: int = 1001) -> EventRun:
    """Run from rest."""
    return _scipy_at(cell, y, np.linspace(0.0, t_end, samples))


def _scipy_at(cell: FrictionCell, y: float, times: FloatArray) -> EventRun:
    """Run from rest to the last of the times; the period of the cycle is right to 1e-12."""
    from theory.chains.friction import FrictionChain
    from verification.references.friction_events import run_events

    chain, start = FrictionChain.of(cell, c=0.0, sites=1), np.array([[y], [0.0]])
    end = float(times[-1])
    return run_events(chain, start, end, times=times, tolerance=1e-12, longest_step=0.4)


@dataclass(frozen=True, kw_only=True)
class TwoStates:
    """Both states of the cell at v_d = 1.25."""

    low: float
    high: float
    period: float
    stick: float
    sliding: float
    inner: tuple[float, float]
    error: float
    gap: float
    inside_slides: bool
    outside_sticks: bool
    settles: bool
    cycle: Any
    rest: Any
    unstable: Any


def two_states() -> TwoStates:
    """Find both cycles by shooting; run with scipy from both sides of the inner one."""
    orbits = _orbits()
    stable = required(orbits.stable_cycle, "stick-slip cycle")
    unstable = required(orbits.unstable_cycle, "unstable cycle")
    basin = required(orbits.basin, "basin of steady sliding")
    cell = orbits.cell
    cycle = _scipy(cell, 2.0, 40.0)
    rest = _scipy(cell, 1.0, SETTLED, 8001)
    period, stick = required(cycle.last_cycle, "second stick in scipy's run")
    step = 5e-3
    inside, outside = (
        bool(len(_scipy(cell, edge, LONG, 3).log)) for edge in (basin[1] - step, basin[1] + step)
    )
    late = rest.y[-600:, 0]
    return TwoStates(
        low=stable.min,
        high=stable.max,
        period=stable.period,
        stick=stable.stick_time,
        sliding=cell.steady_sliding,
        inner=(unstable.min, unstable.max),
        error=orbits.error,
        gap=max(abs(period - stable.period), abs(stick - stable.stick_time)),
        inside_slides=not inside,
        outside_sticks=outside,
        settles=not len(rest.log) and float(np.abs(late - cell.steady_sliding).max()) < 0.02,
        cycle=cycle,
        rest=rest,
        unstable=_scipy(cell, unstable.max, unstable.period, 401),
    )


def rule_two_states(e: TwoStates) -> Ruling:
    """Rule: both states must attract from their side of the cycle that separates their basins."""
    if e.gap < AGREE and e.inside_slides and e.outside_sticks and e.settles:
        return holds()
    return fails("runs from the two sides of the basin boundary do not end in the two states.")


def draw_two_states(e: TwoStates) -> tuple[Picture, ...]:
    """Draw time series on the left and the state space on the right, as in Fig. 2."""
    figure, (top, right, bottom, spare) = new_panels(2, 2, width="page", height=3.6)
    spare.remove()
    both = right.get_subplotspec()
    if both is not None:
        right.set_subplotspec(both.get_gridspec()[:, 1])
    blue, black = COLOURS["blue"], COLOURS["black"]
    y, v = e.cycle.y[:, 0], e.cycle.velocity[:, 0]
    top.plot(e.cycle.times, y, color=blue)
    top.set(ylabel=r"$\tilde{y}$", xlabel=r"$\tau$", title="stick-slip limit cycle, from y = 2")
    bottom.plot(e.rest.times, e.rest.y[:, 0], color=black, lw=0.5)
    bottom.axhline(e.sliding, color=COLOURS["green"], lw=0.9)
    bottom.set(ylabel=r"$\tilde{y}$", xlabel=r"$\tau$", title="steady sliding, from y = 1")
    right.plot(y[600:], v[600:], color=blue, label="stick-slip limit cycle (LC)")
    right.plot(
        e.unstable.y[:, 0], e.unstable.velocity[:, 0], "--", color=COLOURS["vermilion"],
        label="unstable pure-slip limit cycle",
    )  # fmt: skip
    right.plot(e.rest.y[:, 0], e.rest.velocity[:, 0], color=black, lw=0.3)
    right.plot([e.sliding], [0.0], "o", color=COLOURS["green"], label="steady sliding (SS)")
    right.axhline(V_D, color="0.5", lw=0.8, ls=":", label=r"stick, $\tilde{v}_d$ = 1.25")
    right.set(xlabel=r"$\tilde{y}$", ylabel=r"$d\tilde{y}/d\tau$", ylim=(-1.6, 2.9))
    right.legend(loc="upper center")
    runs = {"limit cycle": e.cycle, "to steady sliding": e.rest, "unstable cycle": e.unstable}
    series: dict[str, dict[str, Any]] = {
        name: {"tau": run.times, "y": run.y[:, 0], "velocity": run.velocity[:, 0]}
        for name, run in runs.items()
    }
    series["steady sliding"] = {"y": e.sliding, "velocity": 0.0}
    return (picture("fig02-cell", figure, long_table(series)),)


@dataclass(frozen=True, kw_only=True)
class Regions:
    """Where each state of the cell is stable."""

    hopf: float
    end: float
    error: float
    amplitude_at_end: float
    stick_at_end: float
    seen: tuple[tuple[bool, bool], ...]
    """At each of `VELOCITIES`: whether a start near sliding slides, and a distant one sticks."""
    diagram: Bifurcation

    @property
    def expected(self) -> tuple[tuple[bool, bool], ...]:
        """What the two ends of bistability predict for the same starts."""
        return tuple((v > self.hopf, v < self.end) for v in VELOCITIES)


def regions() -> Regions:
    """Find both ends of bistability by shooting, and run from both starts at six velocities."""
    from theory.cells.friction import FrictionCell
    from verification.cells.diagram import cell_diagram
    from verification.cells.friction import stick_slip_cycle

    cell = FrictionCell(v_d=V_D)
    end = _orbits().cycle_end_velocity
    seen = []
    for v_d in VELOCITIES:
        here = replace(cell, v_d=v_d)
        runs = [_scipy(here, y, LONG, 3) for y in (here.steady_sliding + 0.1, 2.5)]
        near, far = (bool(run.log.size and run.log[-1, 0] > 0.9 * LONG) for run in runs)
        seen.append((not near, far))
    below = stick_slip_cycle(replace(cell, v_d=end * (1.0 - 1e-6)))
    last = required(below, "cycle just below its end")
    return Regions(
        hopf=cell.hopf_velocity,
        end=end,
        error=_orbits().cycle_end_error,
        amplitude_at_end=last.amplitude,
        stick_at_end=last.stick_time,
        seen=tuple(seen),
        diagram=cell_diagram(cell, np.linspace(0.9, 2.0, 221).tolist()),
    )


def rule_regions(e: Regions) -> Ruling:
    """Rule: there must be three ranges in this order, and every run must end as they predict."""
    if e.hopf < e.end and e.seen == e.expected:
        return holds()
    return fails("runs do not end in the states that the three ranges predict.")


def draw_regions(e: Regions) -> tuple[Picture, ...]:
    """Draw the turning points of all states against the belt velocity."""
    from paper_checks.report.cell_picture import draw_bifurcation

    figure, axes = new_axes("column", height=3.6)
    draw_bifurcation(axes, e.diagram)
    axes.axvline(V_D, color=COLOURS["purple"], lw=1.2, label=r"Fig. 2, $\tilde{v}_d$ = 1.25")
    legend = axes.get_legend()
    if legend is not None:
        legend.remove()  # there is no room for it beside a column
    figure.legend(loc="outside lower center", ncols=2)
    d = e.diagram
    columns = {
        "steady sliding": d.sliding,
        "stick-slip cycle, lower": d.stable[:, 0],
        "stick-slip cycle, upper": d.stable[:, 1],
        "unstable cycle, lower": d.unstable[:, 0],
        "unstable cycle, upper": d.unstable[:, 1],
    }
    table = long_table({name: {"v_d": d.v_d, "y": y} for name, y in columns.items()})
    return (picture("fig02-bifurcation", figure, table),)


@dataclass(frozen=True, kw_only=True)
class Subcritical:
    """The unstable cycle just above the Hopf velocity."""

    ratios: tuple[float, ...]
    """Its amplitude relative to the expansion, 1e-2, 1e-3 and 1e-4 above the Hopf velocity."""
    repels: tuple[bool, bool]
    """Whether a run from inside moves inwards, and one from outside moves outwards."""


def subcritical() -> Subcritical:
    """Compare the unstable cycle near the Hopf velocity with its expansion, and with runs."""
    from theory.cells.friction import FrictionCell, friction_slope
    from verification.cells.friction import unstable_cycle

    hopf = FrictionCell(v_d=V_D).hopf_velocity
    ratios, repels = [], []
    for distance in (1e-2, 1e-3, 1e-4):
        cell = FrictionCell(v_d=hopf + distance)
        cycle = required(unstable_cycle(cell), f"cycle {distance:g} above the Hopf velocity")
        third = -friction_slope(cell, cell.v_d) / cell.v0**2
        ratios.append(cycle.amplitude / math.sqrt(8.0 * cell.effective_damping / third))
        if distance == 1e-2:
            for side in (-1.0, 1.0):
                start = cycle.max + side * 0.05 * cycle.amplitude
                run = _scipy(cell, start, 200.0, 4001)
                early, late = (float(np.ptp(part)) for part in np.split(run.y[:4000, 0], 2))
                repels.append((late > early) == (side > 0.0))
    return Subcritical(ratios=tuple(ratios), repels=(repels[0], repels[1]))


def rule_subcritical(e: Subcritical) -> Ruling:
    """Rule: the unstable cycle must shrink to sliding like the square root of the distance."""
    if abs(e.ratios[-1] - 1.0) < 1e-3 and all(e.repels):
        return holds()
    return fails("no unstable cycle shrinks to steady sliding on its stable side.")


@dataclass(frozen=True, kw_only=True)
class LawValues:
    """(2) in both limits, as printed and with μ_d in front; and the slopes of both at v_d."""

    printed: tuple[float, float]
    corrected: tuple[float, float]
    required: tuple[float, float]
    slope_gap: float
    reference_gap: float
    """Largest difference from the law as written for scipy."""


def friction_law() -> LawValues:
    """Evaluate (2) at v_rel = 0 and at a large v_rel, as printed and corrected."""
    from theory.cells.friction import FrictionCell, friction_coefficient
    from verification.references.equations import dynamic_friction

    cell = FrictionCell(v_d=V_D)

    def printed(v: float) -> float:
        return cell.mu_st + (cell.mu_st - cell.mu_d) * math.exp(-v / cell.v0)

    def ours(v: float) -> float:
        return friction_coefficient(cell, v)

    step = 1e-5
    slopes = [(law(V_D + step) - law(V_D - step)) / (2.0 * step) for law in (printed, ours)]
    return LawValues(
        printed=(printed(0.0), printed(1e3)),
        corrected=(ours(0.0), ours(1e3)),
        required=(cell.mu_st, cell.mu_d),
        slope_gap=abs(slopes[0] - slopes[1]),
        reference_gap=max(abs(ours(v) - dynamic_friction(v, cell)) for v in (0.0, 0.3, V_D, 1e3)),
    )


def rule_friction_law(e: LawValues) -> Ruling:
    """Rule: both limits must be those of the text, for the printed or the corrected line."""
    if e.printed == e.required:
        return holds()
    if e.corrected == e.required and e.slope_gap < 1e-9 and e.reference_gap < 1e-12:
        return corrected("the limits are those of (2) with $\\mu_d$ for its first $\\mu_{st}$.")
    return fails("neither the printed nor the corrected (2) has these limits.")


@dataclass(frozen=True, kw_only=True)
class Stick:
    """The friction force while the cell sticks, over μ_st."""

    largest: float
    at_release: float
    """Difference between |F| and μ_st at the releases."""
    releases: int
    gap: float


def stick() -> Stick:
    """Compute the force that holds the cell over every stick interval of two runs, to its end."""
    from theory.chains.friction import FrictionChain
    from verification.runs.simulate import simulate

    cell = _orbits().cell
    chain, start = FrictionChain.of(cell, c=0.0, sites=1), np.array([[2.0], [0.0]])
    reference = _scipy(cell, 2.0, 40.0)
    ours = simulate(chain, start, 40.0, samples=1001, logged_events=1000)
    runs: tuple[EventRun | Trajectory, ...] = (reference, ours)
    largest, sticks = [], []
    logs = [reference.log, ours.event_log]
    for each, log in zip(runs, logs, strict=True):
        held = each.velocity[:, 0] == V_D
        largest.append(float(np.abs(each.y[held, 0] + 2.0 * cell.xi * V_D).max()))
        begin, end = (log[log[:, 2] == kind, 0] for kind in (0, 1))
        sticks.append([float(b - a) for a, b in zip(begin, end, strict=False)])
    stops = [log[log[:, 2] == 1, 0] for log in logs]
    ends = (
        _scipy_at(cell, 2.0, stops[0]),
        simulate(chain, start, 40.0, times=stops[1].tolist()),
    )
    forces = [np.abs(end.y[:, 0] + 2.0 * cell.xi * V_D) for end in ends]
    return Stick(
        largest=max(largest) / cell.mu_st,
        at_release=max(float(np.abs(force - cell.mu_st).max()) for force in forces),
        releases=len(stops[0]),
        gap=max(abs(a - b) for a, b in zip(*sticks, strict=True)),
    )


def rule_stick(e: Stick) -> Ruling:
    """Rule: it must be below μ_st throughout stick; equality at release is only a remark."""
    if e.gap < AGREE and e.largest < 1.0 and e.at_release < AGREE:
        return holds()
    return fails("the force exceeds what holds the cell, or does not reach it at release.")


@dataclass(frozen=True, kw_only=True)
class SwitchModel:
    """Error of the period of the cycle by the paper's method."""

    defaults: float
    """At ode23t's default tolerances, relative to the period."""
    tight: float
    order: float
    """Dependence of the error on the band, at tight tolerances."""


def switch_model() -> SwitchModel:
    """Run the cell by the paper's method, and compare its period with the exact one."""
    from theory.chains.friction import FrictionChain
    from verification.references.switch_model import PAPER_BAND, run_switch

    orbits = _orbits()
    stable = required(orbits.stable_cycle, "stick-slip cycle")
    chain = FrictionChain.of(orbits.cell, c=0.0, sites=1)
    rows = []
    for relative, absolute in ((1e-3, 1e-6), (1e-9, 1e-11)):
        for band in (1e-2, 1e-3, PAPER_BAND):
            run = run_switch(
                chain, np.array([[stable.max], [0.0]]), 40.0 * stable.period, band=band,
                relative=relative, absolute=absolute, samples=100_001,
            )  # fmt: skip
            rows.append(run.period / stable.period - 1.0)
    return SwitchModel(defaults=rows[2], tight=rows[5], order=math.log10(rows[3] / rows[4]))


def rule_switch_model(e: SwitchModel) -> Ruling:
    """Rule: the period must be right to one per cent; a larger error would show in Fig. 2."""
    if abs(e.defaults) < 0.01 and abs(e.tight) < 0.01:
        return holds()
    return fails("the switch model misses the period by more than one per cent.")


CLAIMS = (
    Claim.beside("fig02-states", evidence=two_states, rule=rule_two_states, figure=draw_two_states),
    Claim.beside("fig02-regions", evidence=regions, rule=rule_regions, figure=draw_regions),
    Claim.beside("fig02-subcritical", evidence=subcritical, rule=rule_subcritical),
    Claim.beside("fig02-friction-law", evidence=friction_law, rule=rule_friction_law, weight=0),
    Claim.beside("fig02-stick", evidence=stick, rule=rule_stick, weight=0),
    Claim.beside("fig02-switch-model", evidence=switch_model, rule=rule_switch_model, weight=0),
)
