"""What the text asserts about one isolated oscillator of either model."""

from __future__ import annotations

import math

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.claims._breathers import EPS
from paper_checks.claims._one_cell import trajectory
from paper_checks.claims._text import untestable
from paper_checks.following import following

SETS = ((2.5, 0.5), (4.0, 0.5))
"""The (a, b) of Figs. 7-11, and of Figs. 12, 13, 16, 17."""


def _turn(a: float, b: float, height: float) -> float:
    """Return the next largest y after one of the given height, for one cell of (8)."""
    from scipy.optimize import brentq

    def rate(_: float, state: np.ndarray) -> list[float]:
        y, w = state
        return [w, -y - EPS * w * (1.0 - a * y * y + b * y**4)]

    run = trajectory(rate, 9.0, [height, 0.0])
    return float(run(brentq(lambda t: run(t)[1], 5.0, 8.0))[0])


def _cell() -> Finding:
    """Find both cycles of one cell as fixed points of its return map, and their stability."""
    from scipy.optimize import brentq

    from theory.chains.vdp import VdpChain

    rows = []
    for a, b in SETS:
        chain = VdpChain(a=a, b=b, c=0.0, eps=EPS)
        for predicted in (chain.unstable_amplitude, chain.stable_amplitude):
            cycle = float(
                brentq(lambda y, a=a, b=b: _turn(a, b, y) - y, 0.8 * predicted, 1.1 * predicted)
            )
            slope = (_turn(a, b, cycle + 1e-4) - _turn(a, b, cycle - 1e-4)) / 2e-4
            rows.append((a, predicted, cycle, slope))
    rest = [_turn(a, b, 0.01) / 0.01 for a, b in SETS]
    gap = max(abs(cycle / predicted - 1.0) for _, predicted, cycle, _ in rows)
    inner, outer = [row[3] for row in rows[::2]], [row[3] for row in rows[1::2]]
    right = max(rest) < 1.0 and min(inner) > 1.0 and max(outer) < 1.0 and gap < 0.05
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value="; ".join(
            f"a = {a:g}: |y| = {cycle:.5f}, multiplier {slope:.4f}" for a, _, cycle, slope in rows
        ),
        error="1e-8 in the amplitudes, 1e-6 in the multipliers",
        methods=(
            "fixed points of the return map of one cell of (8), ε = 0.01",
            f"the averaged cell: the amplitudes agree to {gap:.1e}, of the order of ε_eff²",
        ),
        tolerance="a multiplier below one is stable; 5 per cent between amplitudes",
        explanation=(
            "At the parameters of the figures the rest state is stable too. In general this needs "
            "η = b/a² < 1/8; beyond it damping is positive at every amplitude and there is no "
            "cycle. The text does not give this bound."
        ),
    )


def _inner_cycle() -> Finding:
    """Find the unstable cycle of the friction cell at v_d = 1.25 and what is on its two sides."""
    from scipy.optimize import brentq

    from paper_checks.claims._friction_cell import (
        MU_D,
        MU_ST,
        V_0,
        XI,
        friction,
        highest_after_slip,
        hopf_speed,
        slip_rate,
    )

    belt = 1.25
    centre = friction(belt)

    def height_after(w: float, turns: int = 1) -> float:
        """Return y' at the centre after some turns of slip."""
        for _ in range(turns):
            run = trajectory(slip_rate(belt), 7.5, [centre, w])
            w = float(run(brentq(lambda t, run=run: run(t)[0] - centre, 5.2, 7.4))[1])
        return w

    cycle = float(brentq(lambda w: height_after(w) - w, 0.2, 1.1, xtol=1e-10))
    slope = (height_after(cycle + 1e-4) - height_after(cycle - 1e-4)) / 2e-4
    inside, outside = height_after(0.9 * cycle, 5), height_after(1.1 * cycle, 5)
    sticks = highest_after_slip(belt) > -1e-12
    # The averaged cell: linear damping and the cubic term of (2) about steady sliding.
    strength = (MU_ST - MU_D) / V_0 * math.exp(-belt / V_0)
    averaged = math.sqrt((2.0 * XI - strength) / (0.75 * strength / (6.0 * V_0**2)))
    near = abs(averaged / cycle - 1.0) < 0.1
    right = near and slope > 1.0 and inside < 0.9 * cycle and outside > 1.1 * cycle and sticks
    return Finding(
        verdict=Verdict.REPRODUCED if right else Verdict.NOT_REPRODUCED,
        value=f"at v_d = 1.25: unstable cycle through y' = {cycle:.6f}, multiplier {slope:.4f}; "
        "outside it stick-slip, inside it steady sliding",
        error="1e-9 in y'",
        methods=(
            "fixed point of the return map of the slip equation",
            f"averaging to third order: amplitude {averaged:.3f}; five turns on either side",
        ),
        tolerance=(
            "the multiplier must exceed one, and runs on both sides must part; the average within "
            "a tenth: it keeps the linear and cubic terms of the friction law only"
        ),
        explanation=(
            f"The unstable cycle exists for v_d above {hopf_speed():.4f}, where it is born from "
            "steady sliding, up to where it meets the stick-slip cycle (fig02-regions)."
        ),
    )


def _small() -> Finding:
    """Compare the ripple of the cycle with ε and with the number that governs averaging."""
    from scipy.integrate import solve_ivp

    from theory.chains.vdp import VdpChain, effective_epsilon

    rows = []
    for a, b in SETS:
        ripples = []
        for eps in (EPS, EPS / 4.0):
            chain = VdpChain(a=a, b=b, c=0.0, eps=eps)

            def rate(_: float, state: np.ndarray, chain: VdpChain = chain) -> list[float]:
                y, w = state
                return [w, -y - chain.eps * w * (1.0 - chain.a * y * y + chain.b * y**4)]

            settle = 2.5 / eps  # the slower cycle forgets e^{-7} of its start
            run = solve_ivp(
                rate,
                (0.0, settle),
                [chain.stable_amplitude, 0.0],
                method="DOP853",
                rtol=1e-9,
                atol=1e-10,
                t_eval=np.linspace(settle - 2 * math.pi, settle, 400),
            )
            size = np.hypot(*run.y)
            ripples.append(float((size.max() - size.min()) / size.mean()))
        rows.append((a, effective_epsilon(VdpChain(a=a, b=b, c=0.0, eps=EPS)), *ripples))
    orders = [math.log(row[2] / row[3]) / math.log(4.0) for row in rows]
    return Finding(
        verdict=Verdict.PARTIAL if max(row[2] for row in rows) > 0.1 else Verdict.REPRODUCED,
        value="; ".join(
            f"a = {a:g}: ε_eff = {effective:.3f}, ripple {ripple:.1%} of |ẏ + iy|"
            for a, effective, ripple, _ in rows
        ),
        error="0.1 % of the ripple",
        methods=(
            "largest damping factor on the cycle times ε",
            "direct integration of one cell, at ε and at ε/4: observed orders "
            + ", ".join(f"{order:.2f}" for order in orders),
        ),
        tolerance="a ripple above a tenth: no longer small",
        explanation=(
            "What must be small for averaging is ε max|1 - a y² + b y⁴| on the cycle, not ε. At "
            "a = 4, b = 0.5 it is fifty times ε = 0.01. The cycle is nearly a sinusoid there all "
            "the same; what averaging gets wrong elsewhere is measured with each figure."
        ),
    )


CLAIMS = (
    Claim(
        "text-cell",
        "Section 2, before Eq. (8)",
        "The isolated Van der Pol cell has two stable states, a limit cycle and a fixed point.",
        None,
        Verdict.REPRODUCED,
        "fronts check text-cell",
        _cell,
    ),
    Claim(
        "text-inner-cycle",
        "Conclusions, Fig. 2",
        "The friction cell has an unstable cycle between steady sliding and stick-slip.",
        None,
        Verdict.REPRODUCED,
        "fronts check text-inner-cycle",
        _inner_cycle,
    ),
    Claim(
        "text-small",
        "Section 2, after Eq. (8)",
        "ε = 0.01 is a small parameter.",
        "ε ≪ 1",
        Verdict.REPRODUCED,
        "fronts check text-small",
        _small,
    ),
    untestable(
        "text-simplest",
        "Section 2, before Eq. (8)",
        "The Van der Pol cell is probably the simplest model with a limit cycle and a fixed point.",
        "What counts as simple is not said. That it has both is judged under text-cell.",
    ),
    following(
        "text-smooth",
        "Section 2, before Eq. (8)",
        "The smoothness of Model II allows the application of several analytical techniques.",
        "eq26",
        "eq34",
    ),
)
