"""Fig. 9: Floquet multipliers of the breather against coupling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._breathers import EPS, A, B, flow, monodromy_by_differences
from paper_checks.claims._orbits import SITES, orbit_of
from paper_checks.claims._required import required
from paper_checks.ruling import agrees, fails, holds, partly
from theory.arrays import FloatArray
from verification.pictures.data_table import long_table
from verification.pictures.figures import COLOURS, new_panels, picture

PRINTED = "0.195"
TOGETHER = 0.002
"""Difference of crossing couplings not visible in Fig. 9: one per cent of its axis."""
ALONG = (*np.arange(0.01, 0.18, 0.015).tolist(), *np.linspace(0.18, 0.195, 16).tolist(),
         *np.linspace(0.1955, 0.1973, 25).tolist())  # fmt: skip
EXACT = (*np.arange(0.02, 0.18, 0.02).tolist(), *np.linspace(0.18, 0.191, 9).tolist())
"""Couplings at which multipliers are drawn, along (9) and along the periodic orbit."""


def _approximate(c: float, *, misprinted: bool = False) -> Any:
    """Return the multipliers along the sinusoids (9) of the closed form."""
    from theory.averaged.breather import solve_breather
    from theory.chains.vdp import VdpChain
    from verification.breathers.floquet import approximate_multipliers

    chain = VdpChain(a=A, b=B, c=c, eps=EPS, sites=SITES)
    return approximate_multipliers(chain, solve_breather(chain), misprinted=misprinted)


def _crossing(parity: str, *, misprinted: bool = False) -> float:
    from scipy.optimize import brentq

    def growth(c: float) -> float:
        found: float | None = getattr(_approximate(c, misprinted=misprinted), parity)
        return required(found, f"{parity} multiplier at c = {c:g}")

    return float(brentq(growth, 0.19, 0.1973, xtol=1e-9))


@dataclass(frozen=True, kw_only=True)
class Multipliers:
    """Where multipliers leave the unit circle, along (9) as in the paper and on the exact orbit."""

    even: float
    odd: float
    odd_misprinted: float
    """The same with the Jacobian as printed in (42)."""
    true_odd: float
    true_fold: float
    trivial: float
    """|μ - 1| of the trivial multiplier along (9) at the crossing."""
    gap: float
    along: tuple[tuple[float, ...], ...]
    """All moduli along (9), one row per coupling in ``couplings``."""
    couplings: tuple[float, ...]
    exact: tuple[tuple[float, ...], ...]
    exact_couplings: tuple[float, ...]


def multipliers() -> Multipliers:
    """Follow all multipliers along the approximate and the exact orbit."""
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.thresholds.continuation import breather_threshold
    from verification.thresholds.result import ThresholdMethod

    true = breather_threshold(
        VdpChain(a=A, b=B, c=0.0, eps=EPS, sites=SITES), Nucleus(1), ThresholdMethod.ORBIT
    )
    test = orbit_of(0.19)
    by_scipy = np.sort(
        np.abs(np.linalg.eigvals(monodromy_by_differences(test.state, 0.19, test.period)))
    )
    ours = _moduli(test.stability)
    return Multipliers(
        even=_crossing("symmetric"),
        odd=_crossing("antisymmetric"),
        odd_misprinted=_crossing("antisymmetric", misprinted=True),
        true_odd=true.stable_to if true.stable_to is not None else true.c_crit,
        true_fold=true.c_crit,
        trivial=_approximate(_crossing("antisymmetric")).trivial,
        gap=float(np.abs(by_scipy[-3:] - ours[-3:]).max()),
        along=tuple(tuple(_moduli(_approximate(float(x)))) for x in ALONG),
        couplings=ALONG,
        exact=tuple(tuple(_moduli(orbit_of(float(x)).stability)) for x in EXACT),
        exact_couplings=EXACT,
    )


def _moduli(found: Any) -> FloatArray:
    return np.sort(np.abs(required(found, "multiplier of an orbit").values))


def rule_multipliers(e: Multipliers) -> Ruling:
    """Rule: two must cross together, at the printed coupling to within its rounding."""
    if not e.gap < 1e-6 or abs(e.even - e.odd) > TOGETHER:
        return fails("no two multipliers leave the unit circle together.")
    if agrees(e.odd, PRINTED) and agrees(e.even, PRINTED):
        return holds()
    return partly(
        "about the value of $c = 0.195$",
        f"along the approximate orbit the two cross at {e.odd:.4f} and {e.even:.4f}, and the orbit "
        f"that it approximates loses stability at {e.true_odd:.5f} already.",
    )


def draw(e: Multipliers) -> tuple[Picture, ...]:
    """Draw all moduli along both orbits, with the crossing enlarged."""
    figure, (left, right) = new_panels(2, width="page", height=2.7)
    series: dict[str, dict[str, Any]] = {}
    for axes in (left, right):
        for name, c, rows, style, colour in (
            ("along (9), as in the paper", e.couplings, e.along, "-", "blue"),
            ("true periodic orbit", e.exact_couplings, e.exact, "o", "vermilion"),
        ):
            moduli = np.array(rows)
            axes.plot(c, moduli, style, ms=2.2, lw=0.9, color=COLOURS[colour])
            axes.plot([], [], style, color=COLOURS[colour], label=name)
            for k in range(moduli.shape[1]):
                series[f"{name}, {k + 1}"] = {"c": c, "modulus": moduli[:, k]}
        axes.axhline(1.0, color="0.5", lw=0.8)
        axes.axvline(float(PRINTED), color="0", lw=0.9, ls=":", label="paper, about 0.195")
        axes.axvline(e.true_odd, color=COLOURS["green"], lw=0.9,
                     label=f"true orbit, {e.true_odd:.5f}")  # fmt: skip
        axes.set(xlabel="coupling c", ylabel="|Floquet multiplier|")
    left.set(
        xlim=(0, 0.2),
        xticks=(0, 0.05, 0.1, 0.15, 0.2),
        title=r"$a$ = 2.5, $b$ = 0.5, $\varepsilon$ = 0.01, 11 sites",
    )
    right.set(xlim=(0.186, 0.1978), ylim=(0.992, 1.0025), title="near the unit circle")
    left.legend(loc="center left")
    return (picture("fig09-multipliers", figure, long_table(series)),)


@dataclass(frozen=True, kw_only=True)
class Escape:
    """Multiplier, and factor per period by which a perturbation changes, inside and outside."""

    inside: tuple[float, float]
    outside: tuple[float, float]

    @property
    def gap(self) -> float:
        """Largest difference between multiplier and factor."""
        return max(abs(pair[0] - pair[1]) for pair in (self.inside, self.outside))


def escape() -> Escape:
    """Perturb one breather inside and one outside, and measure the change of the perturbation."""
    from theory.chains.nucleus import Nucleus, outward_pattern
    from theory.chains.vdp import VdpChain
    from verification.breathers.orbits import solve_orbit

    turns, rows = 8, []
    for size in (1, 3):
        orbit = solve_orbit(
            VdpChain(a=A, b=B, c=0.15, eps=EPS, sites=9), Nucleus(size, outward_pattern(size))
        )  # fmt: skip
        values, vectors = np.linalg.eig(monodromy_by_differences(orbit.state, 0.15, orbit.period))
        apart = np.argsort(np.abs(values - 1.0))[1:]
        lead = apart[int(np.argmax(np.abs(values[apart])))]
        kick = 1e-5 * np.real(vectors[:, lead] / np.linalg.norm(vectors[:, lead]))
        ends = flow(np.column_stack([orbit.state + kick, orbit.state - kick]), 0.15,
                    turns * orbit.period)  # fmt: skip
        grown = np.linalg.norm(ends[:, 0] - ends[:, 1]) / np.linalg.norm(2.0 * kick)
        ours = _moduli(orbit.stability)
        nearest = float(ours[np.abs(ours - abs(values[lead])).argmin()])
        rows.append((nearest, float(grown ** (1.0 / turns))))
    return Escape(inside=rows[0], outside=rows[1])


def rule_escape(e: Escape) -> Ruling:
    """Rule: perturbations must decay inside the circle and grow outside, as the multiplier says."""
    if e.gap < 1e-4 and e.inside[1] < 1.0 < e.outside[1]:
        return holds()
    return fails("perturbations do not follow the multipliers.")


CLAIMS = (
    Claim.beside(
        "fig09-multipliers", evidence=multipliers, rule=rule_multipliers, figure=draw, weight=2
    ),
    Claim.beside("fig09-escape", evidence=escape, rule=rule_escape, weight=0),
)
