"""Symbols of the averaged cell."""

from __future__ import annotations

import sympy as sp

from derivations.symbols import t

angle = sp.Function("psi", real=True)(t)
"""Phase of the cell in the rotating frame."""
