"""The reading of (53) in which both cycles have the same phase."""

from __future__ import annotations

import cmath

import sympy as sp

from derivations.algebra.steps import Evidence
from derivations.chain import PAPER
from derivations.front.numbers import profile
from derivations.front.sampling import front


def real_ratio(_: sp.Basic) -> Evidence:
    """Check the phase of phi_us / phi_s = -Sum/2 on a front that satisfies (54) and (47)."""
    sample, velocity = front(PAPER)
    found = profile(sample.lattice, 0.0, velocity)
    phase = cmath.phase(found)
    return Evidence(
        abs(phase) < 1e-6,
        f"at v̂ = {velocity:.6f} of (54) |φᵤₛ/φₛ| = {sample.ratio:.4f} with phase {phase:.4f}",
    )
