"""Results of an envelope: compiled functions and a kinetic relation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import sympy as sp


@dataclass(frozen=True)
class Compiled:
    """Numerical functions of an envelope; they accept arrays, whose shapes are broadcast.

    Attributes
    ----------
    rate : callable
        ``rate(phi, left, right)``: complex dphi_n/d(eps t).
    amplitude_rate : callable
        ``amplitude_rate(r)``: dr/d(eps t) of the isolated cell.
    frequency_shift : callable
        ``frequency_shift(r)``: the frequency is 1 + eps times this.
    amplitudes : tuple of float
        All cycles, from the inner to the outer.
    """

    rate: Callable[..., Any]
    amplitude_rate: Callable[..., Any]
    frequency_shift: Callable[..., Any]
    amplitudes: tuple[float, ...]


@dataclass(frozen=True)
class CellKineticRelation:
    """``|Sum over M+ of 1/(k L_k)| = 2 ratio``, for velocity and coupling over ``rest_rate``.

    Attributes
    ----------
    ratio : Expr
        |phi_us| / |phi_s|.
    rest_rate : Expr
        h(0): the sum is evaluated at ``v/h(0)``, ``c/h(0)``, since the rest state decays at h(0)/2.
    equation : Eq
        The relation.
    neglected : str
        What the simplified model neglects for this cell, beyond what it neglects in print; may be
        empty.
    """

    ratio: sp.Expr
    rest_rate: sp.Expr
    equation: sp.Eq
    neglected: str
