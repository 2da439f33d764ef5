"""Fig. 13: front velocity against coupling in the Van der Pol chain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._fronts import EPS, A, B
from paper_checks.claims._required import required
from paper_checks.ruling import fails, holds
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, new_panels, picture

if TYPE_CHECKING:
    from verification.fronts.result import Front

ETA = B / A**2
AVERAGED = (0.115, 0.12, 0.135, 0.15, 0.175, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.4, 2.0,
            3.0, 5.0, 10.0, 20.0, 50.0, 100.0)  # fmt: skip
FULL = (0.3, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0)
"""Couplings of (8), which include all those that the paper mentions."""
CHECKED = (0.3, 0.6, 1.0)
"""Couplings at which the velocity is compared with that by scipy."""
MARK = 0.02
"""Fraction of the largest velocity: about the size of a mark in a printed figure."""
LINEAR = 0.02
"""Tolerance of the exponent at c = 100, where the law for large c still differs from one by
0.01."""

LAW_ETAS = (0.01, 0.03125, 0.08)
LAW_COUPLINGS = (10.0, 30.0, 100.0, 300.0, 1000.0)
LAW = 2e-3
"""Largest difference between law and run beyond the error of the run, from c = 100 on: the accuracy
of the runs."""
ONE = 1.0
BELTS, BELT_COUPLING = (1.2, 1.25), 0.3
"""Belt velocities of Model I on either side of the change of sign of its κ, and a strong coupling
at which they are compared."""


@dataclass(frozen=True, kw_only=True)
class AveragedScaling:
    """v̂ against c, for the averaged chain and for (8)."""

    c: tuple[float, ...]
    v: tuple[float, ...]
    error: tuple[float, ...]
    full_c: tuple[float, ...]
    full_v: tuple[float, ...]
    full_error: tuple[float, ...]
    kappa: float
    gap: float
    """Largest relative difference from the velocities by scipy at `CHECKED`."""

    @property
    def line(self) -> tuple[float, float]:
        """Offset and slope of the line fitted to (8)."""
        slope, offset = np.polyfit(self.full_c, self.full_v, 1)
        return float(offset), float(slope)

    @property
    def residual(self) -> float:
        """Largest residual of (8) relative to the largest velocity."""
        c, v = np.array(self.full_c), np.array(self.full_v)
        return float(np.abs(self.line[0] + self.line[1] * c - v).max() / v.max())

    @property
    def exponents(self) -> tuple[np.ndarray, np.ndarray]:
        """Couplings between neighbours and d ln v̂/d ln c there, for the averaged chain."""
        return local_exponents(self.c, self.v)

    @property
    def exponent(self) -> float:
        """The last of these exponents."""
        return float(self.exponents[1][-1])

    @property
    def last(self) -> tuple[float, float]:
        """v̂(100) by the run and by the law."""
        return self.v[-1], self.c[-1] + self.kappa * (self.c[-1] / 6.0) ** (1.0 / 3.0)

    @property
    def worst(self) -> float:
        """Largest relative error of the velocities."""
        return max(e / v for e, v in zip(self.full_error, self.full_v, strict=True))


def local_exponents(c: Sequence[float], v: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the geometric means of neighbouring couplings, and d ln v/d ln c between them."""
    couplings = np.array(c)
    slopes = np.diff(np.log(v)) / np.diff(np.log(couplings))
    return np.sqrt(couplings[1:] * couplings[:-1]), slopes


def _measured(fronts: Sequence[Front]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the velocities and their errors; raise an `ArithmeticError` if one is missing."""
    at = [f"c = {each.chain.c:g}: {each.status}" for each in fronts]
    return (
        tuple(required(each.v, f"velocity at {a}") for a, each in zip(at, fronts, strict=True)),
        tuple(required(each.error, f"error at {a}") for a, each in zip(at, fronts, strict=True)),
    )


@lru_cache(maxsize=1)
def scaling() -> AveragedScaling:
    """Measure v̂ of (43) and of (8), and compare with scipy and with the law for large c."""
    from theory.averaged.front import strong_coupling_front
    from theory.chains.vdp import VdpChain
    from verification.fronts.measure import measure_front
    from verification.references.passages import quarter_turn_velocity

    averaged = [
        measure_front(
            VdpChain(a=A, b=B, c=c).averaged(), accuracy=1e-3, max_sites=1000 if c > 1.0 else 250
        )
        for c in AVERAGED
    ]
    full = [
        measure_front(VdpChain(a=A, b=B, c=c, eps=EPS), accuracy=1e-3, max_sites=250) for c in FULL
    ]
    (v, error), (full_v, full_error) = _measured(averaged), _measured(full)
    at = dict(zip(AVERAGED, v, strict=True))
    return AveragedScaling(
        c=AVERAGED,
        v=v,
        error=error,
        full_c=FULL,
        full_v=full_v,
        full_error=full_error,
        kappa=strong_coupling_front(ETA).kappa,
        gap=max(abs(at[c] / quarter_turn_velocity(A, B, c) - 1.0) for c in CHECKED),
    )


def rule_scaling(e: AveragedScaling) -> Ruling:
    """Rule: a line must fit in the range of the figure, and the exponent must tend to one."""
    straight = e.residual < MARK
    asymptotic = abs(e.exponent - 1.0) < LINEAR and abs(e.last[0] / e.last[1] - 1.0) < 1e-3
    if straight and asymptotic and e.gap < 1e-3:
        return holds()
    return fails("the velocity is not asymptotically linear in c.")


def draw(e: AveragedScaling) -> tuple[Picture, ...]:
    """Draw Fig. 13, and velocity over coupling up to c = 100."""
    figure, (left, right) = new_panels(2, width="page", height=2.6)
    c, v = np.array(e.c), np.array(e.v)
    near = c <= 3.0
    fine = np.linspace(0.3, 3.0, 50)
    curves = Curves({"averaged (43)": {"c": e.c, "v": e.v, "error": e.error}})
    left.plot(c[near], v[near], "-", color=COLOURS["blue"], label="averaged chain (43)")
    full = curves.add("(8)", c=e.full_c, v=e.full_v, error=e.full_error)
    left.plot(*full, "s", color=COLOURS["vermilion"], label="(8), ε = 0.01")
    left.plot(*curves.add("line", c=fine, v=e.line[0] + e.line[1] * fine), "--", color="black",
              lw=0.9, label=f"line fitted to (8): {e.line[0]:.2f} + {e.line[1]:.2f} c")  # fmt: skip
    left.set(xlabel="coupling c", ylabel=r"$\hat v = v/\varepsilon$", xlim=(0, 3.1), ylim=(0, None))
    left.set(title=r"$a$ = 4, $b$ = 0.5")
    for name, points, mark, colour in (
        ("averaged chain (43)", e.exponents, "o-", "blue"),
        ("(8), ε = 0.01", local_exponents(e.full_c, e.full_v), "s", "vermilion"),
    ):
        found = curves.add(f"exponent, {name}", c=points[0], exponent=points[1])
        right.semilogx(*found, mark, color=COLOURS[colour], label=name)
    right.axhline(1.0, color="black", lw=0.9, ls="--", label="paper: linear in the end")
    right.set(xlabel="coupling c", ylabel=r"$d\ln\hat v\,/\,d\ln c$", ylim=(0.5, 2.0))
    left.legend()
    right.legend()
    return (picture("fig13-velocity", figure, long_table(curves)),)


@dataclass(frozen=True, kw_only=True)
class Law:
    """A single velocity law, v̂ = v_g/ε + κ(η) (|ω'''|/(6ε))^(1/3), compared with runs of (8)."""

    rows: tuple[tuple[float, float, float | None, float | None, float, float], ...]
    """η, c, v̂ of (8) if the run settled, its error, v̂ by the law, and v̂ of the fastest waves."""
    turning: float
    """η at which κ changes sign."""
    one: float
    """v̂ at c = 1, a = 4, b = 0.5, ε = 0.01 to a relative accuracy of 1e-5."""
    one_error: float
    by_scipy: float
    """v̂ of (8) at η = 1/32, c = 100 by scipy on 160 sites."""
    belt: tuple[tuple[float, float, float, float], ...]
    """v_d, v of Model I at c = 0.3 relative to its fastest waves, its error, and the same ratio for
    its averaged chain at strong coupling."""

    @property
    def settled(self) -> list[tuple[float, float, float, float, float, float]]:
        """The rows with a steady front."""
        return [
            (eta, c, v, required(error, f"error at c = {c:g}"), law, waves)
            for eta, c, v, error, law, waves in self.rows
            if v is not None
        ]

    @property
    def worst(self) -> float:
        """Largest difference between law and run from c = 100 on, minus the error of the run."""
        return max(
            (abs(v - law) - error) / v for _, c, v, error, law, _ in self.settled if c >= 100
        )

    @property
    def belt_agrees(self) -> bool:
        """Whether the averaged cell of Model I predicts where its fronts outrun its waves."""
        return all((ratio > 1.0) == (averaged > 1.0) for _, ratio, _, averaged in self.belt)

    @property
    def outrun(self) -> bool:
        """Whether fronts outrun the waves exactly where κ > 0, for all settled rows."""
        return all((v > waves) == (eta < self.turning) for eta, _, v, _, _, waves in self.settled)


def velocity_law() -> Law:
    """Measure (8) from c = 10 to 1000 at three η, and find where κ changes sign."""
    from theory.averaged.front import strong_coupling_front, wave_fast_eta
    from theory.chains.vdp import VdpChain
    from verification.fronts.measure import measure_front
    from verification.references.passages import velocity_on_few_sites

    rows = []
    for eta in LAW_ETAS:
        kappa = strong_coupling_front(eta).kappa
        for c in LAW_COUPLINGS:
            run = measure_front(
                VdpChain(a=1.0, b=eta, c=c, eps=EPS, sites=500), accuracy=2e-3,
                max_sites=4000 if kappa > 0.0 else 2000)  # fmt: skip
            waves, bend = fastest_waves(c)
            law = waves + kappa * bend
            v = run.v if run.steady else None
            rows.append((eta, c, v, run.error, law, waves))
    one = measure_front(VdpChain(a=A, b=B, c=ONE, eps=EPS, sites=31), accuracy=1e-5, max_sites=2000)
    return Law(
        rows=tuple(rows),
        turning=wave_fast_eta()[0],
        one=required(one.v, "front of (8) at c = 1"),
        one_error=required(one.error, "error of the front of (8) at c = 1"),
        by_scipy=velocity_on_few_sites(VdpChain(a=A, b=B, c=100.0, eps=EPS, sites=160)),
        belt=tuple(_belt(v_d) for v_d in BELTS),
    )


def _belt(v_d: float) -> tuple[float, float, float, float]:
    """Measure the front of Model I relative to its fastest waves, and its averaged chain."""
    from paper_checks.claims._friction import chain_of
    from verification.fronts.measure import measure_front
    from verification.references.friction_cell import averaged_front

    run = measure_front(chain_of(BELT_COUPLING, 101, v_d), max_sites=400, accuracy=5e-3)
    (v,), (error,) = _measured([run])
    waves = run.chain.largest_group_velocity
    return v_d, v / waves, error / waves, averaged_front(v_d)


def fastest_waves(c: float) -> tuple[float, float]:
    """Return v_g/ε of the fastest linear wave of (8), and (|ω'''|/(6ε))^(1/3) there.

    With ω² = 1 + 2εc(1 - cos k), differentiating ω ω' = εc sin k twice gives, at ω'' = 0, ω ω''' =
    -εc sin k = -ω ω'.
    """
    from verification.references.passages import wave_velocity

    top = wave_velocity(c, EPS) * EPS
    return top / EPS, float((top / (6.0 * EPS)) ** (1.0 / 3.0))


def rule_law(e: Law) -> Ruling:
    """Rule: the law must hold at every η from c = 100 on, and κ > 0 where fronts are faster."""
    if e.worst < LAW and e.outrun and e.belt_agrees and len(e.settled) >= 10:
        return holds()
    return fails("runs leave the law for large c.")


def draw_law(e: Law) -> tuple[Picture, ...]:
    """Draw the velocity relative to that of the fastest waves."""
    figure, axes = new_axes("column", height=2.7, xlabel="coupling c",
                            ylabel="front velocity $v/v_g$")  # fmt: skip
    fine, curves = np.geomspace(5.0, 1200.0, 80), Curves()
    for eta, colour, mark in zip(LAW_ETAS, ("blue", "green", "vermilion"), "os^", strict=True):
        chosen = [row for row in e.settled if row[0] == eta]
        c, v = [row[1] for row in chosen], [row[2] / row[5] for row in chosen]
        kappa = (chosen[0][4] - chosen[0][5]) / fastest_waves(chosen[0][1])[1]
        law = [1.0 + kappa * fastest_waves(float(x))[1] / fastest_waves(float(x))[0] for x in fine]
        axes.semilogx(*curves.add(f"eta = {eta:g}", c=c, ratio=v), mark, color=COLOURS[colour],
                      label=rf"η = {eta:g}, κ = ${kappa:.2f}$")  # fmt: skip
        axes.semilogx(*curves.add(f"law, eta = {eta:g}", c=fine, ratio=law),
                      color=COLOURS[colour], lw=0.8)  # fmt: skip
    axes.axhline(1.0, color="0.4", lw=0.8, ls="--")
    axes.legend(title="(8), ε = 0.01; lines: law at strong coupling", title_fontsize=7)
    return (picture("fig13-law", figure, long_table(curves)),)


CLAIMS = (
    Claim.beside("fig13-scaling", evidence=scaling, rule=rule_scaling, figure=draw),
    Claim.beside(
        "fig13-similar",
        evidence=velocity_law,
        rule=rule_law,
        figure=draw_law,
        expensive=True,
        weight=0,
    ),
)
