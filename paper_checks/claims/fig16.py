"""Fig. 16: the profile of the front, its admissibility and its limits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._required import required
from paper_checks.ruling import fails, holds
from theory.arrays import ComplexArray, FloatArray
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, picture

A, B, C = 4.0, 0.5, 0.5
"""Parameters of Fig. 16."""
AGREE = 1e-8
"""Largest difference between theory and chain: far above both errors, far below the margin of
admissibility."""
FAR = 25


@dataclass(frozen=True, kw_only=True)
class ProfileValues:
    """The front of Fig. 16, in units of |φ_s|."""

    v: float
    v_error: float
    zeta: FloatArray
    phi: ComplexArray
    error: float
    few: FloatArray
    series: ComplexArray
    series_gap: float
    series_error: float
    sites: FloatArray
    chain: ComplexArray
    chain_gap: float
    admissible: bool
    proven_beyond: tuple[float, float]
    threshold: float
    amplitude: float
    behind: float
    """|φ - φ_s| 25 sites behind, and |φ| 25 sites ahead, with the proven bounds."""
    ahead: float
    bounds: tuple[float, float]
    chain_behind: float


@lru_cache(maxsize=1)
def profile() -> ProfileValues:
    """Compute the profile by the integral, by the root series and by the running chain."""
    from theory.cells.vdp import eta_from_damping, threshold_ratio
    from theory.piecewise.admissibility import check_admissible
    from theory.piecewise.kinetic_relation import kinetic_relation
    from theory.piecewise.profile import front_profile, front_profile_by_roots, tail_bound
    from verification.piecewise.simulation import simulate_front

    eta = eta_from_damping(A, B)
    r = threshold_ratio(eta)
    (branch,) = kinetic_relation(C, eta).branches
    zeta = np.linspace(-10.0, 10.0, 401)
    integral = front_profile(zeta, branch.v, C)
    few = np.arange(-9.25, 10.0, 0.75)
    series = front_profile_by_roots(few, branch.v, C, 4000)
    run = simulate_front(C, eta)
    latest = required(run.final.latest, "front in the chain")
    sites = np.arange(run.final.phi.size) - latest
    near = np.abs(sites) <= 10
    chain = run.final.phi[near]
    ends = front_profile([-FAR, FAR], branch.v, C).phi
    verdict = check_admissible(branch.v, C, r)
    pairs = [tail_bound(branch.v, C, way) for way in (False, True)]
    bounds = [float(K * np.exp(-s * FAR)) for s, K in pairs]
    return ProfileValues(
        v=branch.v,
        v_error=branch.error,
        zeta=zeta,
        phi=np.asarray(integral.phi, dtype=complex),
        error=integral.error,
        few=few,
        series=np.asarray(series.phi, dtype=complex),
        series_gap=float(np.abs(series.phi - front_profile(few, branch.v, C).phi).max()),
        series_error=series.error,
        sites=sites[near].astype(float),
        chain=chain,
        chain_gap=float(np.abs(chain - front_profile(sites[near], branch.v, C).phi).max()),
        admissible=bool(verdict.admissible),
        proven_beyond=verdict.proven_beyond,
        threshold=r,
        amplitude=float(np.sqrt((A / B) * (1.0 + np.sqrt(1.0 - 8.0 * eta)))),
        behind=float(abs(ends[0] - 1.0)),
        ahead=float(abs(ends[1])),
        bounds=(bounds[0], bounds[1]),
        chain_behind=float(abs(run.final.phi[latest - FAR] - 1.0)),
    )


def _agreed(e: ProfileValues) -> bool:
    return e.chain_gap < AGREE and e.series_gap <= e.series_error


def rule_admissible(e: ProfileValues) -> Ruling:
    """Rule: (47) must hold for every ζ, and all three profiles must agree."""
    size = np.abs(e.phi)
    seen = bool(np.all(size[e.zeta < 0] > e.threshold) and np.all(size[e.zeta > 0] < e.threshold))
    if _agreed(e) and e.admissible and seen:
        return holds()
    return fails("the solution does not satisfy (47) for every ζ.")


def rule_limits(e: ProfileValues) -> Ruling:
    """Rule: both limits must be within the proven bounds, in theory and in the chain."""
    near = e.behind <= e.bounds[0] + 1e-11 and e.ahead <= e.bounds[1] + 1e-11
    if _agreed(e) and near and e.chain_behind < AGREE:
        return holds()
    return fails("the profile does not reach its limits.")


def draw(e: ProfileValues) -> tuple[Picture, ...]:
    """Draw Fig. 16."""
    figure, axes = new_axes("column", height=3.4, xlabel=r"$\zeta$", ylabel=r"$|\varphi|$")
    black, curves = COLOURS["black"], Curves()
    axes.plot(*curves.add("integral", zeta=e.zeta, abs_phi=e.amplitude * np.abs(e.phi)),
              color=COLOURS["blue"], label="solution of (48), periodised integral")  # fmt: skip
    axes.plot(*curves.add("root series (49)", zeta=e.few, abs_phi=e.amplitude * np.abs(e.series)),
              "x", color=COLOURS["green"], label="root series (49)")  # fmt: skip
    axes.plot(*curves.add("chain (44)", zeta=e.sites, abs_phi=e.amplitude * np.abs(e.chain)), "o",
              mfc="none", color=COLOURS["vermilion"], label="chain (44), simulated")  # fmt: skip
    axes.axhline(e.amplitude * e.threshold, color=black, lw=0.8, label=r"$|\varphi_{us}|$")
    axes.axhline(e.amplitude, color=black, lw=0.8, ls="--", label=r"$|\varphi_s|$ and 0")
    axes.axhline(0.0, color=black, lw=0.8, ls="--")
    axes.set_xticks((-10, -5, 0, 5, 10))
    axes.set(title=r"$a$ = 4, $b$ = 0.5, $c$ = 0.5")
    figure.legend(loc="outside lower center", ncols=2)
    return (picture("fig16-profile", figure, long_table(curves)),)


CLAIMS = (
    Claim.beside(
        "fig16-admissible", evidence=profile, rule=rule_admissible, figure=draw, shared=profile
    ),
    Claim.beside("fig16-limits", evidence=profile, rule=rule_limits, weight=0, shared=profile),
)
