"""The switch model of the friction chain, the paper's own integrator, in the stability table.

It states no error, so it is held against what friction can do. With E the energy and |v_rel| at
most half of v_d in the band, friction of at most μ_st at each of N sites lets √(2E) grow by at
most 2μ_st √N a unit of τ.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from verification.quantities.chains import friction_chain
from verification.quantities.quantity import Axis, Check, Claim, Quantity

_TAU = 10.0


def switch_energy(at: Mapping[str, float]) -> Claim:
    """Return √(2E) at the end of a run with fixed steps; ``band`` is a share of v_d."""
    from verification.references.switch_model import run_switch
    from verification.runs.excite import excite

    chain = friction_chain(at)
    start = excite(chain, [1], at["displacement"])
    run = run_switch(
        chain, start, _TAU, step=at["step"], band=at["band"] * chain.cell.v_d, samples=2
    )
    return Claim(_root_energy(chain.c, run.y[-1], run.velocity[-1]), 0.0, extra=start)


def _root_energy(c: float, y: npt.NDArray[np.float64], velocity: npt.NDArray[np.float64]) -> float:
    return math.sqrt(float(y @ y + velocity @ velocity + c * np.sum(np.diff(y) ** 2)))


def below_the_work_of_friction(at: Mapping[str, float], claim: Claim) -> Check:
    """Compare with √(2E) of the start and the most that friction can add."""
    most = _root_energy(at["c"], *claim.extra) + 2.0 * at["mu_st"] * math.sqrt(at["sites"]) * _TAU
    return Check(max(0.0, float(claim.value) - most), 1e-9 * most, "the work of friction")


QUANTITIES = (
    Quantity(
        "switch-friction",
        "energy of the switch model of (5) at tau = 10, for any stick band and step",
        (
            Axis("band", 1e-12, 0.5),
            Axis("step", 1e-4, 1.0),
            Axis("c", 1e-8, 1e8),
            Axis("v_d", 1e-8, 1e8),
            Axis("v0", 1e-8, 1e8),
            Axis("xi", 1e-6, 1.0),
            Axis("mu_st", 0.51, 1e3),
            Axis("sites", 1, 100, whole=True),
            Axis("displacement", 1e-8, 1e3),
        ),
        switch_energy,
        below_the_work_of_friction,
        30.0,
        share=0.5,
    ),
)
