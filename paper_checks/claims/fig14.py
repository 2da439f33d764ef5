"""Fig. 14: front velocity against η in the Van der Pol chain, for several (a, b)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._fronts import EPS
from paper_checks.claims._required import required
from paper_checks.ruling import fails, holds
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, picture

C = 0.3
ETAS = (0.003, 0.004, 0.005, 0.0065, 0.008, 0.01, 0.0125, 0.015, 0.02, 0.025, 0.03, 0.035, 0.04,
        0.05, 0.06, 0.07, 0.08, 0.085, 0.09)  # fmt: skip
SHARES = (1.0, 2.5, 4.0)
"""Values of a; b = η a²."""
FULL = (0.005, 0.01, 0.02, 0.03, 0.05)
ACCURACY = 1e-3
AGREE = 2.0 * ACCURACY
"""Largest difference between two measured velocities, each known to half this fraction."""


@dataclass(frozen=True, kw_only=True)
class Collapse:
    """v̂ at c = 0.3 against η, for (8) with several a and for the averaged chain."""

    full: dict[float, tuple[float, ...]]
    """v̂ of (8) at `FULL`, by a."""
    averaged: tuple[float, ...]
    """v̂ of (43) at `ETAS`, a = 1."""
    scipy: dict[float, tuple[float, ...]]
    """v̂ of the reduced averaged chain at η = 0.01 and 0.03, by a."""

    @property
    def apart(self) -> float:
        """Largest relative difference of (8) between values of a at one η."""
        table = np.array(list(self.full.values()))
        return float((np.ptp(table, axis=0) / table.mean(axis=0)).max())

    @property
    def scipy_apart(self) -> float:
        """The same for the velocities by scipy."""
        table = np.array(list(self.scipy.values()))
        return float((np.ptp(table, axis=0) / table.mean(axis=0)).max())

    @property
    def fast_to(self) -> float:
        """Largest η in `ETAS` at which the averaged front is as fast as its waves, v̂ = c."""
        return max(eta for eta, v in zip(ETAS, self.averaged, strict=True) if v >= C)

    @property
    def varies(self) -> float:
        """Ratio of largest to smallest velocity along the curve, the scale for a collapse."""
        return max(self.averaged) / min(self.averaged)


def collapse() -> Collapse:
    """Measure the front of (8) at equal η and different (a, b), and along the curve."""
    from theory.chains.vdp import VdpChain
    from verification.fronts.measure import measure_front
    from verification.references.passages import quarter_turn_velocity

    def full(a: float, eta: float) -> float:
        chain = VdpChain(a=a, b=eta * a**2, c=C, eps=EPS)
        run = measure_front(chain, accuracy=ACCURACY, max_sites=250)
        return required(run.v, f"front of (8) at a = {a:g}, η = {eta:g}")

    def averaged(eta: float) -> float:
        run = measure_front(VdpChain(a=1.0, b=eta, c=C).averaged(), max_sites=250)
        return required(run.v, f"front of (43) at η = {eta:g}")

    return Collapse(
        full={a: tuple(full(a, eta) for eta in FULL) for a in SHARES},
        averaged=tuple(averaged(eta) for eta in ETAS),
        scipy={
            a: tuple(quarter_turn_velocity(a, eta * a**2, C, 40) for eta in (0.01, 0.03))
            for a in SHARES
        },
    )


def rule_collapse(e: Collapse) -> Ruling:
    """Rule: there must be a single curve, to within the errors, although η itself matters."""
    if e.apart < AGREE and e.scipy_apart < 1e-6 and e.varies > 2.0:
        return holds()
    return fails("sets of a and b of one η have different velocities.")


def draw(e: Collapse) -> tuple[Picture, ...]:
    """Draw Fig. 14 with three sets of (a, b)."""
    figure, axes = new_axes("column", height=2.9, xlabel="η = b/a²", ylabel=r"$\hat v$")
    curves = Curves()
    axes.plot(*curves.add("averaged (43)", eta=ETAS, v=e.averaged), "-", color="0.3", lw=0.9,
              label="averaged chain (43)")  # fmt: skip
    for (a, v), colour, mark, size in zip(
        e.full.items(), ("blue", "vermilion", "green"), "os^", (7, 5, 3), strict=True
    ):
        axes.plot(*curves.add(f"(8), a = {a:g}", eta=FULL, v=v), mark, ms=size,
                  mfc="none" if size > 3 else None, color=COLOURS[colour],
                  label=f"(8), $a$ = {a:g}, $b$ = {a * a:g}η".replace(" 1η", " η"))  # fmt: skip
    axes.set(title=r"$c$ = 0.3, $\varepsilon$ = 0.01", xlim=(0, 0.095), ylim=(0, None))
    axes.legend()
    return (picture("fig14-collapse", figure, long_table(curves)),)


CLAIMS = (Claim.beside("fig14-collapse", evidence=collapse, rule=rule_collapse, figure=draw),)
