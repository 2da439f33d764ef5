"""What the text asserts about fronts of Model II (section 2.3.1 and the start of 2.3.2)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claim import Claim, Erratum, Fault, Finding, Verdict
from paper_checks.claims._text import untestable
from paper_checks.following import following

if TYPE_CHECKING:
    from theory.chains.vdp import VdpChain

A, B = 4.0, 0.5


def _gauge() -> Finding:
    """Run (34) with ω = 1 and with ω = 1 + εc and compare, for three ε."""
    from scipy.integrate import solve_ivp

    from theory.averaged.envelope import envelope_rate
    from theory.chains.vdp import VdpChain

    sites, duration = 6, 12.0
    size = VdpChain(a=A, b=B, c=0.5).stable_amplitude
    start = np.array([size * (1.0 + 0.2j) * math.exp(-0.8 * n) for n in range(sites)])
    gaps = []
    small = (0.02, 0.01, 0.005)
    for eps in small:
        chain = VdpChain(a=A, b=B, c=0.5, eps=eps, sites=sites)
        ends = []
        for omega in (1.0, 1.0 + eps * chain.c):

            def rate(_: float, phi: np.ndarray, omega: float = omega) -> np.ndarray:
                return _rate_34(phi, chain, omega)  # noqa: B023 - used within the loop only

            run = solve_ivp(rate, (0.0, duration), start, method="DOP853", rtol=1e-10, atol=1e-12)
            # y = Im(φ e^{iωt})/ω: both must describe the same y, up to O(ε).
            ends.append(run.y[:, -1] * np.exp(1j * (omega - 1.0) / eps * duration) / omega)
        gaps.append(float(np.abs(ends[1] - ends[0]).max() / np.abs(ends[0]).max()))
    order = math.log(gaps[0] / gaps[-1]) / math.log(small[0] / small[-1])
    at_one = np.abs(
        _rate_34(start, VdpChain(a=A, b=B, c=0.5, eps=0.01, sites=sites), 1.0)
        - envelope_rate(start, VdpChain(a=A, b=B, c=0.5, eps=0.01, sites=sites))
    ).max()
    right = order > 0.9 and gaps[1] < 0.1 and at_one < 1e-12
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value=f"y differs by {gaps[1]:.1e} of itself at ε = 0.01 between ω = 1 and ω = 1 + εc",
        error=f"the difference falls in proportion to ε (observed order {order:.2f})",
        methods=(
            "runs of (34) with both ω by scipy",
            f"the rate of (43) in the toolkit equals (34) at ω = 1 to {at_one:.0e}",
        ),
        tolerance="an order of at least 0.9: the error of averaging itself is O(ε)",
        explanation="ω only says in which rotating frame φ is written.",
    )


def _rate_34(phi: np.ndarray, chain: VdpChain, omega: float) -> np.ndarray:
    """Return dφ/d(εt) of (34) for any ω, free ends."""
    pull = np.zeros_like(phi)
    pull[1:] += phi[1:] - phi[:-1]
    pull[:-1] += phi[:-1] - phi[1:]
    size = np.abs(phi) ** 2
    damping = 1.0 - chain.a * size / (4 * omega**2) + chain.b * size**2 / (8 * omega**4)
    frame = 1j * (omega - 1.0 / omega) / (2.0 * chain.eps)
    rate: np.ndarray = 0.5j * chain.c / omega * pull - 0.5 * phi * damping - frame * phi
    return rate


def _collapse_figure() -> Finding:
    """See on which figure sets of (a, b) can collapse, by the scaling of (8)."""
    from theory.averaged.envelope import envelope_rate
    from theory.chains.vdp import VdpChain

    generator = np.random.default_rng(14)
    gaps = []
    for a, b, c in generator.uniform((1.0, 0.1, 0.1), (5.0, 1.0, 1.0), (5, 3)):
        sites = 5
        phi = np.asarray(generator.normal(size=(2, sites)).T @ [1.0, 1.0j], dtype=complex)
        whole = envelope_rate(phi, VdpChain(a=a, b=b, c=c, sites=sites))
        scaled = envelope_rate(
            complex(math.sqrt(a)) * phi, VdpChain(a=1.0, b=b / a**2, c=c, sites=sites)
        )
        gaps.append(float(np.abs(scaled / math.sqrt(a) - whole).max()))
    full = _full_scaling()
    right = max(gaps) < 1e-11 and full < 1e-11
    return Finding(
        verdict=Verdict.CORRECTED if right else Verdict.NOT_REPRODUCED,
        value="the sets (a, b) are in Fig. 14; Fig. 13 has one set, a = 4, b = 0.5",
        error=f"{max([*gaps, full]):.0e}: rounding",
        methods=("the averaged chain with (a, b) and with (1, η)", "the same of (8)"),
        tolerance="1e-11: rounding",
        explanation=(
            "With y√a in the place of y only η is left, so the collapse over η is an identity "
            "and needs no simulation. Over c at one (a, b), as the caption of Fig. 13 says, "
            "there is nothing to collapse."
        ),
        erratum=Erratum(
            Fault.INCONSISTENT,
            "“different sets of $a, b$ in Figure 13”",
            "different sets of $a, b$ in Figure 14",
            "The caption of Fig. 13 gives one set; Fig. 14 is over $\\eta$.",
            "The scaling that makes the sets collapse leaves η, the abscissa of Fig. 14 (checked "
            f"on (8) and (43) to {max([*gaps, full]):.0e}).",
            "Nothing else.",
        ),
    )


def _full_scaling() -> float:
    """Return how far (8) is from its scaled form at random states."""
    generator = np.random.default_rng(8)
    worst = 0.0
    for a, b, c in generator.uniform((1.0, 0.1, 0.1), (5.0, 1.0, 1.0), (5, 3)):
        y, w = generator.normal(size=(2, 3))

        def force(y: np.ndarray, w: np.ndarray, a: float, b: float, c: float = c) -> float:
            drag = w[1] * (1.0 - a * y[1] ** 2 + b * y[1] ** 4)
            return float(-y[1] - 0.01 * (c * (2 * y[1] - y[0] - y[2]) + drag))

        root = math.sqrt(a)
        worst = max(worst, abs(force(root * y, root * w, 1.0, b / a**2) / root - force(y, w, a, b)))
    return worst


CLAIMS = (
    following(
        "text-steady",
        "Caption of Fig. 12",
        "At t = 14000, 17000, 20000 the front is seen to propagate steadily.",
        "fig12-steady",
        printed="t = 14000, 17000, 20000",
    ),
    following(
        "text-linear-both",
        "Section 2.3.1",
        "This is similar to the friction-excited system.",
        "models-velocity",
    ),
    Claim(
        "text-collapse",
        "Section 2.3.1",
        "The results for different sets of a, b are in Figure 13.",
        "Figure 13",
        Verdict.CORRECTED,
        "fronts check text-collapse",
        _collapse_figure,
        weight=0,
    ),
    untestable(
        "text-forcing",
        "Section 2.3.1",
        "η is in a sense the equivalent of the belt speed.",
        "The sense is not given. What can be compared, the two maps, is under models-maps.",
    ),
    Claim(
        "text-gauge",
        "Section 2.3.2, before Eq. (43)",
        "ω can be set to 1 in (34) without loss of generality.",
        "ω = 1",
        Verdict.REPRODUCED,
        "fronts check text-gauge",
        _gauge,
        weight=0,
    ),
)
