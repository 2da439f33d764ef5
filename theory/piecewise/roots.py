"""All roots of the dispersion relation (52), each with a label that never changes.

The label n denotes a strip that contains exactly one root (facts 3 and 4 of
``theory.piecewise.dispersion``): above the axis 2πn - π < Re k < 2πn; below it (0, π) for n = 0,
(2πn - π, 2πn + π) for n > 0 and (2πn, 2πn + 2π) for n < 0. A set of labels is therefore complete by
construction, and once a root is found in a strip, that strip need not be searched further.
``theory.piecewise.root_count`` counts the roots independently.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import SupportsFloat

import numpy as np

from theory.arrays import EPS, AnyArray, BoolArray, ComplexArray, FloatArray, IntArray
from theory.parameters import (
    ParameterError,
    Range,
    count_within,
    number,
    positive,
    with_ranges,
    within,
)
from theory.piecewise.dispersion import dispersion, dispersion_slope
from theory.result import Result

MAX_ROOTS = 1_000_000
MAX_LABEL = 10**12
"""Largest |label|; beyond it the rounding error of k exceeds 0.001, and it can no longer be decided
whether a root lies inside its strip."""
PARAMETERS = Range(1e-12, 1e12)


class IncompleteRootsError(ArithmeticError):
    """Raised where the root of a strip was not found; as one exists, this would be a defect."""


@dataclass(frozen=True, kw_only=True)
class RootSet(Result):
    """Roots of L(k) = 0 in one half-plane, one per label.

    Attributes
    ----------
    labels : ndarray of int, shape (n,)
        Strip numbers.
    k : ndarray of complex, shape (n,)
        Roots, per site.
    residual : ndarray of float, shape (n,)
        |L(k)|, dimensionless.
    radius : ndarray of float, shape (n,)
        Bound on the distance of ``k`` from the true root, rounding included.
    """

    labels: IntArray = field(metadata={"axis": "label"})
    k: ComplexArray = field(metadata={"dims": ("label",)})
    residual: FloatArray = field(metadata={"dims": ("label",)})
    radius: FloatArray = field(metadata={"dims": ("label",)})

    def take(self, index: IntArray | BoolArray) -> RootSet:
        """Return the roots at ``index``, in that order."""
        return RootSet(
            labels=self.labels[index],
            k=self.k[index],
            residual=self.residual[index],
            radius=self.radius[index],
        )


@with_ranges(parameters=PARAMETERS)
def checked_velocity_and_coupling(
    v: SupportsFloat | str, c: SupportsFloat | str
) -> tuple[float, float]:
    """Return (v, c) as floats after checking that they are in the range tested for roots.

    Raises
    ------
    ParameterError
        If either is not {parameters}.
    """
    for name, value in (("velocity v", v), ("coupling c", c)):
        within(name, number(name, value), *PARAMETERS)
    return float(v), float(c)


def strip_bounds(labels: IntArray, upper: bool) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper end of Re k for each label, shapes (n,)."""
    base: AnyArray = 2.0 * np.pi * labels
    if upper:
        return base - np.pi, base
    low = np.where(labels > 0, base - np.pi, base)
    return low, low + np.where(labels == 0, np.pi, 2.0 * np.pi)


@with_ranges(parameters=PARAMETERS, label=float(MAX_LABEL))
def labelled_roots(
    v: float | FloatArray, c: float | FloatArray, labels: IntArray, upper: bool
) -> RootSet:
    """Return the root of (50) in each of the strips ``labels``.

    Parameters
    ----------
    v, c : float or ndarray of float, shape (n,)
        Front velocity v̂ and coupling, dimensionless, {parameters}; one pair for all labels
        or one pair each.
    labels : ndarray of int, shape (n,)
        Strip numbers, at most {label} in modulus.
    upper : bool
        Above (M⁺ of Eq. 52) or below (M⁻) the real axis.

    Raises
    ------
    ParameterError
        If v, c or a label is out of range.
    IncompleteRootsError
        If a root was not found, which would be a defect.

    Examples
    --------
    >>> roots = labelled_roots(0.3, 0.5, np.array([-1, 0, 1]), upper=True)
    >>> bool(np.all(roots.radius < 1e-14))
    True
    """
    if not isinstance(v, np.ndarray) and not isinstance(c, np.ndarray):
        v, c = checked_velocity_and_coupling(v, c)
    labels = np.asarray(labels, dtype=np.int64)
    if labels.size:
        for label in (int(labels.min()), int(labels.max())):
            count_within("label", label, -MAX_LABEL, MAX_LABEL, "take labels nearer 0")
    v, c = np.broadcast_to(v, labels.shape), np.broadcast_to(c, labels.shape)
    k = np.full(labels.shape, complex(np.nan))
    missing = np.arange(labels.size)
    with np.errstate(all="ignore"):
        for start in _seeds(labels, v, c, upper):
            if missing.size == 0:
                break
            for newton_step in (_labelled_step, _plain_step):
                required, v_, c_ = labels[missing], v[missing], c[missing]
                found = _iterate(newton_step, start[missing], required, v_, c_, upper=upper)
                accepted = _inside(found, required, upper)
                accepted &= _radius(found, v_, c_) <= 1e-6 * np.abs(found)
                k[missing[accepted]] = found[accepted]
                missing = missing[~accepted]
    if missing.size:
        raise IncompleteRootsError(
            f"no root was found in strips {labels[missing].tolist()} at v = {v[missing]}, "
            f"c = {c[missing]}"
        )
    for _ in range(2):
        k -= _plain_step(k, labels, v, c, upper)
    residual = np.abs(dispersion(k, v, c))
    return RootSet(labels=labels, k=k, residual=residual, radius=_radius(k, v, c))


def nearest_roots(v: float, c: float, count: int, upper: bool) -> RootSet:
    """Return the ``count`` roots nearest the origin in one half-plane, ascending in |k|.

    Raises
    ------
    ParameterError
        If the count is not from 1 to 1 000 000.
    """
    count = count_within("root count", count, 1, MAX_ROOTS)
    reach = count // 2 + 2
    while True:
        roots = labelled_roots(v, c, np.arange(-reach, reach + 1), upper)
        roots = roots.take(np.argsort(np.abs(roots.k), kind="stable")[:count])
        farthest = float(np.abs(roots.k[-1]))
        # A root with a label beyond reach has |Re k| > 2π(reach + 1) - π, and so |k| is larger.
        if farthest <= 2.0 * np.pi * reach + np.pi:
            return roots
        reach = math.ceil(farthest / (2.0 * np.pi)) + 1


def roots_within(v: float, c: float, extent: float, upper: bool) -> RootSet:
    """Return every root with |Re k| ≤ ``extent`` in one half-plane, ascending in |k|.

    Raises
    ------
    ParameterError
        If there would be more than 1 000 000 roots.
    """
    extent = positive("extent |Re k|", extent)
    reach = math.ceil(extent / (2.0 * np.pi)) + 1
    if 2 * reach + 1 > MAX_ROOTS:
        raise ParameterError(
            "extent |Re k|", extent, f"at most {np.pi * MAX_ROOTS:.0f}", "ask less"
        )
    roots = labelled_roots(v, c, np.arange(-reach, reach + 1), upper)
    roots = roots.take(np.abs(roots.k.real) <= extent)
    return roots.take(np.argsort(np.abs(roots.k), kind="stable"))


def _inside(k: ComplexArray, labels: IntArray, upper: bool) -> BoolArray:
    """Return which roots lie in their strips.

    Above the axis, the distance of the root of a distant strip from the edge is about Im k/Re k,
    which is below rounding, and the strips are π apart; below the axis, a distant root lies in the
    middle of its strip.
    """
    low, high = strip_bounds(labels, upper)
    in_half_plane = k.imag > 0 if upper else k.imag < 0
    rounding = 4.0 * EPS * np.abs(k.real) if upper else 0.0
    return in_half_plane & (k.real > low - rounding) & (k.real < high + rounding)


def _radius(k: ComplexArray, v: FloatArray, c: FloatArray) -> FloatArray:
    """Return the radius that the Newton–Kantorovich theorem gives for a root; inf if it fails."""
    square = np.abs(np.sin(0.5 * k)) ** 2
    rounding = 4.0 * EPS * (0.5 + 2.0 * c * square + v * np.abs(k))
    value = np.abs(dispersion(k, v, c)) + rounding
    # v + c sin k cancels near a branch point of the labels; subtract its rounding from the slope.
    slope = np.abs(dispersion_slope(k, v, c)) - 4.0 * EPS * (v + c * np.abs(np.sin(k)))
    step = value / slope
    h = 2.0 * step * (c * np.cosh(np.abs(k.imag) + 2.0 * step)) / slope
    return np.where((slope > 0) & (h < 0.5), 2.0 * step, np.inf)


def _argument(
    k: ComplexArray, labels: IntArray, v: FloatArray, c: FloatArray, upper: bool
) -> ComplexArray:
    """Return w with 4 sinh²(w/2) = q - 2 on the sheet of the label; q = 2 cos k at a root.

    q - 2 = (2vk + i)/c. Computed by arcsinh, w suffers no cancellation at small k and no overflow.
    """
    z = np.asarray((2.0 * v * k + 1j) / (4.0 * c), dtype=complex)
    w = 2.0 * np.arcsinh(np.sqrt(z))
    if upper:
        return np.asarray(w)
    # The strips to the left of the origin are (0, 2π) modulo 2π, instead of (-π, π).
    shifted: ComplexArray = np.where((labels < 0) & (w.imag < 0), w + 2j * np.pi, w)
    return shifted


def _labelled_step(
    k: ComplexArray, labels: IntArray, v: FloatArray, c: FloatArray, upper: bool
) -> ComplexArray:
    """Return Newton's step for k = ±i w(k) + 2πn, nearly linear for all but the nearest roots."""
    sign = 1j if upper else -1j
    z = (2.0 * v * k + 1j) / (4.0 * c)
    value = k - sign * _argument(k, labels, v, c, upper) - 2.0 * np.pi * labels
    step: ComplexArray = value / (1.0 - sign * (0.5 * v / c) / (np.sqrt(z) * np.sqrt(1.0 + z)))
    return step


def _plain_step(
    k: ComplexArray, labels: IntArray, v: FloatArray, c: FloatArray, upper: bool
) -> ComplexArray:
    """Return Newton's step for L(k) = 0 itself, for roots near the origin, where labels meet."""
    del labels, upper
    return dispersion(k, v, c) / dispersion_slope(k, v, c)


def _iterate(
    newton_step: Callable[..., ComplexArray],
    k: ComplexArray,
    labels: IntArray,
    v: FloatArray,
    c: FloatArray,
    *,
    upper: bool,
) -> ComplexArray:
    """Apply Newton's steps to each root until its own step is of the order of rounding."""
    k = k.copy()
    unconverged = np.arange(k.size)
    for _ in range(25):
        step = newton_step(
            k[unconverged], labels[unconverged], v[unconverged], c[unconverged], upper
        )
        k[unconverged] -= step
        unconverged = unconverged[np.abs(step) > 1e-13 * np.abs(k[unconverged])]
        if unconverged.size == 0:
            break
    return k


def _seeds(labels: IntArray, v: FloatArray, c: FloatArray, upper: bool) -> Iterator[AnyArray]:
    """Yield starting points, the most promising first; in nearly all cases the first suffices."""
    base: AnyArray = 2.0 * np.pi * labels
    sign = 1j if upper else -1j
    static = 2.0 * np.arcsinh(np.sqrt(0.25j / c))
    yield base + sign * static  # the roots at v = 0
    # Near a zero k* of L_k on the real axis two roots lie at k = k* ± √(-2 L/L_kk).
    zero_of_slope: AnyArray = (
        base + (-np.pi if upper else np.pi) + np.arcsin(np.minimum(v / c, 1.0))
    )
    separation = np.sqrt(
        -2.0 * dispersion(zero_of_slope + 0j, v, c) / (-1j * c * np.cos(zero_of_slope))
    )
    yield zero_of_slope + np.where(separation.imag * sign.imag > 0, separation, -separation)
    k = base - sign * 0.5j * np.pi
    for _ in range(3):  # the labelled fixed point
        k = sign * _argument(k, labels, v, c, upper) + base
    yield k
    outer_root = (
        -(v + np.sqrt(np.asarray(v * v - 1j * c, dtype=complex))) / c
    )  # k² + 2(v/c)k + i/c = 0, the continuum
    yield outer_root
    yield 1j / (c * outer_root)
    yield -0.5j / v + 0.0 * outer_root
    low, high = strip_bounds(labels, upper)
    for fraction in (0.05, 0.25, 0.5, 0.75, 0.95):
        for height in (0.01, 0.1, 0.5, 1.5, 4.0, 10.0, 20.0):
            yield low + fraction * (high - low) + (1j if upper else -1j) * height
