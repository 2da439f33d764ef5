"""A cell whose forces are any smooth functions, as `OscillatorCell` is for polynomials."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from theory.arrays import FloatArray
from theory.cells.compiled import CompiledForce
from theory.cells.oscillator import Oscillator
from theory.cells.polynomial import Polynomial
from theory.parameters import ParameterError

_STEP = 1e-3
"""Step of the finite difference for g'(0), used where no derivative is given."""
_PANELS = np.concatenate([[0.0], np.geomspace(1e-3, 1e3, 80)])
"""Edges of the panels of |y|, in each of which g is interpolated."""
_NODES = 16
_HUGE, _GROWTH = 1e150, 1e3
"""Largest size of g, and largest growth factor between panels, up to which g is evaluated."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CompiledCell(Oscillator):
    """A cell given by functions of numbers; dimensionless.

    The functions are evaluated for |y| up to 1000, or up to where g grows a thousandfold while |y|
    grows by a fifth.

    Attributes
    ----------
    stiffness : callable
        g(y).
    damping : callable
        h(y, v).
    slope : float, optional
        g'(0); by default computed by finite differences.
    overdamped : bool
        Whether the equation is ẏ + g(y) = 0 instead.

    Raises
    ------
    ParameterError
        If y = 0 is not a rest state with a restoring force, or large motion grows without bound.

    Examples
    --------
    >>> cell = CompiledCell(stiffness=math.sinh, damping=lambda y, v: y * y - 1.0)
    >>> [(round(each.amplitude, 3), each.stable) for each in cell.cycles]
    [(1.967, True)]
    """

    stiffness: Callable[[float], float]
    damping: Callable[[float, float], float]
    slope: float | None = None
    overdamped: bool = False
    harmonic = False

    def __post_init__(self) -> None:
        self._check_rest(self.stiffness(0.0), self._slope)
        for side in (-1, 1):
            end = side * float(self._edges(side)[-1])
            depths = self.potential(side * self._edges(side))
            if not (side * self.stiffness(end) > 0.0 and depths[-1] == np.max(depths)):
                raise ParameterError(
                    f"potential at y = {end:g}", f"{depths[-1]:g}", "growing there and larger than "
                    "anywhere inside, so that motion stays bounded", "add a stiffer term",
                )  # fmt: skip
        if not self.overdamped and not (loss := self.loss(self.largest)) >= 0.0:
            kind = "no number" if math.isnan(loss) else "negative"
            raise ParameterError(
                "damping", f"{kind} over a cycle of amplitude {self.largest:g}", "positive "
                "there, so that motion stays bounded", "let it grow at large y or v",
            )  # fmt: skip

    @cached_property
    def _slope(self) -> float:
        if self.slope is not None:
            return self.slope
        near, far = (
            (self.stiffness(h) - self.stiffness(-h)) / (2.0 * h) for h in (_STEP, 2.0 * _STEP)
        )
        return (4.0 * near - far) / 3.0

    @property
    def frequency(self) -> float:  # type: ignore[override]
        """Angular frequency ω of small motion."""
        return math.sqrt(self._slope)

    @cached_property
    def largest(self) -> float:
        """Largest amplitude considered; motion of this energy stays where g is known."""
        right, left = (float(self._edges(side)[-1]) for side in (1, -1))
        depth = float(self.potential(-left))
        if float(self.potential(right)) <= depth:
            return right
        return float(brentq(lambda y: float(self.potential(y)) - depth, 0.0, right, xtol=1e-9))

    def potential(self, y: FloatArray | float) -> FloatArray:
        """Return V(y), V(0) = 0."""
        y = np.asarray(y, dtype=float)
        left = y < 0.0
        if not left.any():
            return self._potential_on(1, y)
        below = self._potential_on(-1, np.abs(y))
        return below if left.all() else np.where(left, below, self._potential_on(1, np.abs(y)))

    def force(self, y: float, v: float, eps: float, step: float) -> tuple[float, float]:
        """Return g(y) + εh(y, v)v and, by a central difference, its derivative by v."""
        loss = self.damping(y, v)
        apart = self.damping(y, v * (1.0 + step)) - self.damping(y, v * (1.0 - step))
        return self.stiffness(y) + eps * v * loss, eps * (loss + apart / (2.0 * step))

    def damping_at(self, y: FloatArray, v: FloatArray) -> FloatArray:
        """Return h(y, v)."""
        return np.array(
            [self.damping(float(one), float(other)) for one, other in zip(y, v, strict=True)]
        )

    def rest_states(self, side: int = 1) -> list[tuple[float, bool]]:
        """Return the distances of the rest states on a side, and whether they are stable."""

        def force(distance: float) -> float:
            return side * self.stiffness(side * distance)

        edges = np.geomspace(1e-3, self._edges(side)[-1], 600)
        found = []
        for low, high in pairwise(edges.tolist()):
            if force(low) * force(high) < 0.0:
                root = float(brentq(force, low, high, xtol=1e-15, rtol=1e-15))
                found.append((root, force(high) > 0.0))
        return found

    def _other_end(self, amplitude: float, energy: float) -> float:
        """Return the negative y at which the motion turns, or the last y at which g is known."""
        low, high = self._flank(energy)
        end = max(low, -float(self._edges(-1)[-1]))
        if float(self.potential(end)) <= energy:
            return end
        return float(brentq(lambda y: float(self.potential(y)) - energy, end, high, xtol=1e-15))

    @cached_property
    def _interpolants(self) -> dict[int, tuple[FloatArray, FloatArray]]:
        return {side: self._interpolated(side) for side in (1, -1)}

    def _edges(self, side: int) -> FloatArray:
        return self._interpolants[side][0]

    def _interpolated(self, side: int) -> tuple[FloatArray, FloatArray]:
        """Return the edges of the panels, and Chebyshev coefficients of V in each, in columns."""
        chebyshev = np.polynomial.chebyshev
        nodes = chebyshev.chebpts1(_NODES)
        columns: list[FloatArray] = []
        total = largest = 0.0
        for low, high in pairwise(_PANELS.tolist()):
            half = 0.5 * (high - low)
            force = np.array([self.stiffness(side * (low + half * (1.0 + x))) for x in nodes])
            size = float(np.max(np.abs(force)))
            if not size < min(_HUGE, _GROWTH * largest if columns else math.inf):
                break
            largest = max(largest, size)
            part = chebyshev.chebint(chebyshev.chebfit(nodes, side * force, _NODES - 1), lbnd=-1)
            column = half * part
            column[0] += total
            total = float(chebyshev.chebval(1.0, column))
            columns.append(column)
        if not columns:
            raise ParameterError(
                "stiffness near y = 0", "infinite or not a number", "finite", "correct the function"
            )
        return _PANELS[: len(columns) + 1], np.array(columns).T

    def _potential_on(self, side: int, distance: FloatArray) -> FloatArray:
        edges, columns = self._interpolants[side]
        found = edges.searchsorted(distance) - 1
        at = np.minimum(np.maximum(found, 0), columns.shape[1] - 1)  # np.clip takes 10 µs
        low, high = edges[at], edges[at + 1]
        inside = 2.0 * (np.minimum(distance, high) - low) / (high - low) - 1.0
        return np.asarray(np.polynomial.chebyshev.chebval(inside, columns[:, at], tensor=False))


def compiled_cell(
    stiffness: Polynomial | CompiledForce,
    damping: Polynomial | CompiledForce,
    values: Mapping[str, float],
    overdamped: bool,
) -> CompiledCell:
    """Return the cell with two forces, at least one of them compiled, at given parameter values."""
    for force in (stiffness, damping):
        if isinstance(force, CompiledForce):
            force.check(values)
    return _cell(stiffness, damping, tuple(values.items()), overdamped)


@lru_cache(maxsize=64)
def _cell(
    stiffness: Polynomial | CompiledForce,
    damping: Polynomial | CompiledForce,
    values: tuple[tuple[str, float], ...],
    overdamped: bool,
) -> CompiledCell:
    named = dict(values)
    slope = None
    if isinstance(stiffness, CompiledForce) and stiffness.has_derivatives:
        slope = stiffness.function(named, "y")(0.0)
    return CompiledCell(
        stiffness=stiffness.function(named),
        damping=damping.function(named),
        slope=slope,
        overdamped=overdamped,
    )
