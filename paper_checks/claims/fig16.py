"""Fig. 16: the profile of the front, its admissibility and its limits."""

from __future__ import annotations

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.data_table import long_table
from paper_checks.pictures import COLOURS, NO_NUMBERS, new_axes, picture

A, B, C = 4.0, 0.5, 0.5
"""Parameters of Fig. 16."""


def _profile() -> Finding:
    """Compare the series, the integral and the running chain, and look for a violation of (47)."""
    from theory.cells.vdp import eta_from_damping, threshold_ratio
    from theory.piecewise.admissibility import check_admissible
    from theory.piecewise.kinetic_relation import kinetic_relation
    from theory.piecewise.profile import front_profile, front_profile_by_roots
    from verification.piecewise.simulation import simulate_front

    eta = eta_from_damping(A, B)
    r = threshold_ratio(eta)
    (branch,) = kinetic_relation(C, eta).branches
    zeta = np.linspace(-10.0, 10.0, 401)
    integral = front_profile(zeta, branch.v, C)
    few = np.setdiff1d(np.arange(-9.25, 10.0, 0.75), [0.0])
    series = front_profile_by_roots(few, branch.v, C, 4000)
    difference = float(np.max(np.abs(series.phi - front_profile(few, branch.v, C).phi)))
    run = simulate_front(C, eta)
    sites = np.arange(run.final.phi.size) - (run.final.latest or 0)
    near = np.abs(sites) <= 10
    chain = run.final.phi[near]
    off = float(np.max(np.abs(chain - front_profile(sites[near], branch.v, C).phi)))
    verdict = check_admissible(branch.v, C, r)
    others = _inadmissible_scenes()
    amplitude = float(np.sqrt((A / B) * (1.0 + np.sqrt(1.0 - 8.0 * eta))))
    figure, axes = new_axes("column", height=2.9, xlabel=r"$\zeta$ (sites)", ylabel=r"$|\varphi|$")
    axes.plot(zeta, amplitude * np.abs(integral.phi), color=COLOURS["blue"], label="integral")
    axes.plot(
        few, amplitude * np.abs(series.phi), "x", color=COLOURS["green"], label="root series (49)"
    )
    axes.plot(
        sites[near],
        amplitude * np.abs(chain),
        "o",
        mfc="none",
        color=COLOURS["vermilion"],
        label="chain (44), simulated",
    )
    black = COLOURS["black"]
    axes.axhline(amplitude * r, color=black, lw=0.8, label=r"paper, $|\varphi_{us}|$")
    axes.axhline(amplitude, color=black, lw=0.8, ls="--", label=r"paper, $|\varphi_s|$ and 0")
    axes.axhline(0.0, color=black, lw=0.8, ls="--")
    axes.set_xticks((-10, -5, 0, 5, 10))
    axes.legend(loc="upper right", bbox_to_anchor=(1.0, 0.93))
    drawn = picture(
        "fig16-profile",
        f"Envelope of the front at a = 4, b = 0.5, c = 0.5, v = {branch.v:.9f}: closed integral, "
        "root series and the running chain at the moment a site crosses the threshold. Lines: what "
        f"the paper states of it, its limits and its value at ζ = 0. {NO_NUMBERS}",
        figure,
        long_table(
            {
                "closed integral": {"zeta": zeta, "abs_phi": amplitude * np.abs(integral.phi)},
                "root series (49)": {"zeta": few, "abs_phi": amplitude * np.abs(series.phi)},
                "chain (44)": {"zeta": sites[near], "abs_phi": amplitude * np.abs(chain)},
                "paper, at 0": {"zeta": 0.0, "abs_phi": amplitude * r},
                "paper, far behind": {"zeta": -np.inf, "abs_phi": amplitude},
                "paper, far ahead": {"zeta": np.inf, "abs_phi": 0.0},
            }
        ),
    )
    fine = bool(verdict.admissible) and off < 1e-8 and difference <= series.error
    return Finding(
        verdict=Verdict.REPRODUCED if fine else Verdict.NOT_REPRODUCED,
        value=f"admissible for every ζ at v = {branch.v:.12f}",
        error=f"profile {integral.error:.1e}, velocity {branch.error:.1e}",
        methods=(
            "closed integral, with a proof of the tails beyond "
            f"ζ = -{verdict.proven_beyond[0]:.0f} and {verdict.proven_beyond[1]:.0f}",
            f"root series (within {difference:.1e}) and direct simulation (within {off:.1e})",
        ),
        tolerance="1e-8 between theory and chain: far above both errors, far below the margin",
        explanation=(
            "True at these parameters. It is not true of every solution of (54): " + others
        ),
        pictures=(drawn,),
    )


def _inadmissible_scenes() -> str:
    """Name other solutions of (54) that violate (47), found now."""
    from theory.piecewise.kinetic_relation import kinetic_relation

    found = []
    for c, eta in ((0.45, 0.03125), (10.0, 0.03125), (100.0, 1e-4), (0.3, 1e-6)):
        for branch in kinetic_relation(c, eta).branches:
            if branch.admissible is False:
                place = "at ζ = 0" if branch.fails_at == 0 else f"near ζ = {branch.fails_at:.2f}"
                found.append(f"c = {c:g}, η = {eta:g}, v = {branch.v:.6g} fails {place}")
    return "; ".join(found) + "."


def _limits() -> Finding:
    """Measure how far φ is from its limits, against the proven bound."""
    from theory.cells.vdp import eta_from_damping
    from theory.piecewise.kinetic_relation import kinetic_relation
    from theory.piecewise.profile import front_profile, tail_bound
    from verification.piecewise.simulation import simulate_front

    eta = eta_from_damping(A, B)
    (branch,) = kinetic_relation(C, eta).branches
    far = 25.0
    phi = front_profile([-far, far], branch.v, C).phi
    behind, ahead = abs(phi[0] - 1.0), abs(phi[1])
    bounds = [
        K * np.exp(-s * far) for s, K in (tail_bound(branch.v, C, way) for way in (False, True))
    ]
    run = simulate_front(C, eta)
    index = run.final.latest or 0
    chain = abs(run.final.phi[index - int(far)] - 1.0)
    holds = behind <= bounds[0] + 1e-11 and ahead <= bounds[1] + 1e-11 and chain < 1e-8
    return Finding(
        verdict=Verdict.REPRODUCED if holds else Verdict.NOT_REPRODUCED,
        value=f"|φ - φ_s| = {behind:.1e} φ_s and |φ| = {ahead:.1e} φ_s, {far:.0f} sites away",
        error=f"proven: below {bounds[0]:.1e} behind and {bounds[1]:.1e} ahead",
        methods=("contour integral with a bound on the tails", f"running chain: {chain:.1e}"),
        tolerance="the proven bounds; 1e-8 for the chain, whose window ends cost 1e-12",
        explanation="Both limits are reached exponentially, at a rate per site that is bounded.",
    )


CLAIMS = (
    Claim(
        "fig16-admissible",
        "Fig. 16, after Eq. (54)",
        "The solution clearly satisfies the admissibility condition.",
        "at a = 4, b = 0.5, c = 0.5",
        Verdict.REPRODUCED,
        "fronts profile --c 0.5 --a 4 --b 0.5 --out profile.png",
        _profile,
    ),
    Claim(
        "fig16-limits",
        "Fig. 16, after Eq. (54)",
        "The solution converges to 0 ahead and to φ_s behind.",
        None,
        Verdict.REPRODUCED,
        "fronts profile --c 0.5 --a 4 --b 0.5 --from -25 --to 25 --json",
        _limits,
    ),
)
