"""Symbols of the averaged cell."""

from __future__ import annotations

import sympy as sp

from derivations.symbols import t

radius = sp.Function("r", positive=True)(t)
"""Amplitude of the cell."""
angle = sp.Function("psi", real=True)(t)
"""Its phase in the rotating frame."""
ratio = sp.Symbol("ratio", positive=True)
"""|φ_us| / |φ_s|."""
