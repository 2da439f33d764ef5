"""What an envelope gives: compiled functions and a kinetic relation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import sympy as sp


@dataclass(frozen=True)
class Compiled:
    """Numeric functions of an envelope; arrays are allowed, shapes broadcast.

    Attributes
    ----------
    rate : callable
        ``rate(phi, left, right)``: complex dphi_n/d(eps t).
    amplitude_rate : callable
        ``amplitude_rate(r)``: dr/d(eps t) of the isolated cell.
    frequency_shift : callable
        ``frequency_shift(r)``: the frequency is 1 + eps times this.
    amplitudes : tuple of float
        All cycles, inner to outer.
    """

    rate: Callable[..., Any]
    amplitude_rate: Callable[..., Any]
    frequency_shift: Callable[..., Any]
    amplitudes: tuple[float, ...]


@dataclass(frozen=True)
class CellKineticRelation:
    """``|Sum over M+ of 1/(k L_k)| = 2 ratio`` for velocity and coupling over ``rest_rate``.

    Attributes
    ----------
    ratio : Expr
        |phi_us| / |phi_s|.
    rest_rate : Expr
        h(0): the sum is taken at ``v/h(0)``, ``c/h(0)``, for the rest state decays at h(0)/2.
    equation : Eq
        The relation.
    neglected : str
        What the simplified model leaves out for this cell; empty if nothing more than in print.
    """

    ratio: sp.Expr
    rest_rate: sp.Expr
    equation: sp.Eq
    neglected: str
