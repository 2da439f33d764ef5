"""Balls that provably contain one root of (50) each, and a proven count; needs python-flint."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from theory.arrays import IntArray
from theory.parameters import MissingPackageError
from theory.piecewise.root_count import box_corners, box_of_strips, edge_pieces
from theory.piecewise.roots import RootSet, labelled_roots, strip_bounds

_BITS = 120
_MAX_DEPTH = 12


class CertificationError(ArithmeticError):
    """Raised where ball arithmetic could not confirm a root or a count at the working precision."""


@dataclass(frozen=True)
class CertifiedRoots:
    """Roots of one half-plane, each the only one in its ball, none missing.

    Attributes
    ----------
    roots : RootSet
        The centres of the balls; ``radius`` is certified.
    counted : int
        Number of roots in the box of these strips, certified by the winding number of L in ball
        arithmetic.
    bits : int
        Working precision.
    """

    roots: RootSet
    counted: int
    bits: int


def certify_roots(v: float | str, c: float | str, labels: IntArray, upper: bool) -> CertifiedRoots:
    """Enclose the root of each of the consecutive strips ``labels`` and certify their number.

    The method is interval Newton: if m - L(m)/L_k(B) lies inside the ball B about m, then B
    contains exactly one root, and the root lies in that smaller set. The count is the winding
    number of L along the edge of a box; on every piece of the edge L is shown not to vanish.

    Parameters
    ----------
    v, c : float or str
        Front velocity v̂ and coupling, dimensionless: exact binary numbers, or decimals as text.
    labels : ndarray of int, shape (n,)
        Consecutive strip numbers.
    upper : bool
        Whether the roots are those above the real axis, or below.

    Raises
    ------
    MissingPackageError
        If python-flint is not installed.
    CertificationError
        If an enclosure or the count fails, or the two disagree.
    """
    flint = ball_arithmetic("a certified root")
    precision = flint.ctx.prec
    flint.ctx.prec = _BITS
    try:
        found = labelled_roots(float(v), float(c), labels, upper)
        balls = [_enclose(flint, v, c, k, r) for k, r in zip(found.k, found.radius, strict=True)]
        in_own_strips = _in_own_strips(flint, [place for _, place in balls], labels, upper)
        counted = _certified_count(flint, v, c, labels, upper)
    finally:
        flint.ctx.prec = precision
    where = f"at v = {v!r}, c = {c!r}"
    if counted != labels.size:
        raise CertificationError(f"{counted} roots counted and {labels.size} enclosed {where}")
    if not in_own_strips:
        raise CertificationError(f"a root is too near the edge of its strip {where}")
    radius = np.array([size for size, _ in balls])
    roots = RootSet(labels=found.labels, k=found.k, residual=found.residual, radius=radius)
    return CertifiedRoots(roots, counted, _BITS)


def ball_arithmetic(purpose: str) -> Any:
    """Return the module python-flint.

    Raises
    ------
    MissingPackageError
        If it is not installed; the message names the ``purpose`` for which it is needed.
    """
    try:
        import flint
    except ImportError:
        raise MissingPackageError("python-flint", "certify", purpose) from None
    return flint


def _enclose(
    flint: Any, v: float | str, c: float | str, k: complex, radius: float
) -> tuple[float, Any]:
    """Return a radius about ``k`` that provably contains exactly one root, and the root's ball.

    The latter is far smaller, and its centre need not be a double.
    """
    v_, c_, i = flint.arb(v), flint.arb(c), flint.acb(0, 1)
    middle = flint.acb(k.real, k.imag)
    value = flint.acb(0.5) - 2 * i * c_ * (middle / 2).sin() ** 2 - i * v_ * middle
    trial = radius
    for _ in range(20):
        side = flint.arb(0, trial)
        ball = middle + flint.acb(side, side)
        slope = -i * (v_ + c_ * ball.sin())
        if not slope.contains(0):
            shift = value / slope
            size = float(abs(shift).upper())
            if size < trial:  # the image lies inside the square of half-side trial
                return math.nextafter(size, math.inf), middle - shift
        trial *= 2.0
    raise CertificationError(f"no ball about {k} could be certified at v = {v!r}, c = {c!r}")


def _certified_count(
    flint: Any, v: float | str, c: float | str, labels: IntArray, upper: bool
) -> int:
    """Return the winding number of L around the box of these strips, with every piece proven."""
    v_, c_, i = flint.arb(v), flint.arb(c), flint.acb(0, 1)
    v, c = float(v), float(c)
    corners = box_corners(*box_of_strips(v, c, labels, upper))

    def value(k: Any) -> Any:
        return flint.acb(0.5) - 2 * i * c_ * (k / 2).sin() ** 2 - i * v_ * k

    argument_change = 0.0
    for start, end in itertools.pairwise(corners):
        a, b = edge_pieces(v, c, start, end)
        pieces = [
            (flint.acb(p), flint.acb(q), 0) for p, q in zip(a.tolist(), b.tolist(), strict=True)
        ]
        while pieces:
            low, high, depth = pieces.pop()
            middle = (low + high) / 2
            centre = value(middle)
            relative_change = -i * (v_ + c_ * low.union(high).sin()) * (high - low) / (2 * centre)
            if abs(relative_change) < 1:  # L/L(middle) stays in the right half-plane on this piece
                change = (value(high) / value(low)).arg()
                argument_change += float(change.mid())
            elif depth < _MAX_DEPTH:
                pieces += [(low, middle, depth + 1), (middle, high, depth + 1)]
            else:
                raise CertificationError(f"the edge piece {low} to {high} could not be certified")
    # The winding number of a closed curve is an integer; the rounding error is far below one half.
    return round(argument_change / (2.0 * math.pi))


def _in_own_strips(flint: Any, places: Sequence[Any], labels: IntArray, upper: bool) -> bool:
    """Return whether every root lies in its own strip, so that no two are the same."""
    bounds = zip(*strip_bounds(labels, upper), strict=True)
    return all(
        place.real > round(low / math.pi) * flint.arb.pi()
        and place.real < round(high / math.pi) * flint.arb.pi()
        for place, (low, high) in zip(places, bounds, strict=True)
    )
