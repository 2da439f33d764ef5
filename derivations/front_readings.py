"""The reading of (53) in which both cycles have the same phase."""

from __future__ import annotations

import cmath

import sympy as sp

from derivations import front_numbers as numbers
from derivations.derivation import Evidence
from derivations.piecewise_front_evidence import figure_16


def real_ratio(_: sp.Basic) -> Evidence:
    """Check the phase of phi_us / phi_s = -Sum/2 at the velocity that (54) gives for Fig. 16."""
    fast, spring, ratio = figure_16()
    found = numbers.profile(0.0, fast, spring)
    phase = cmath.phase(found)
    return Evidence(
        abs(phase) < 1e-6,
        f"at v_hat = {fast:.6f} of Fig. 16 |phi_us/phi_s| = {ratio:.4f} with phase {phase:.4f}",
    )
