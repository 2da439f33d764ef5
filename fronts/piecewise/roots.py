"""Labelled complex roots of the dispersion relation (Eqs. 50-52)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from theory.parameters import (
    ParameterError,
    RunError,
    check_progress,
    count_within,
    decimal,
    truth,
    with_ranges,
)
from theory.piecewise.sums.result import DIGITS, DOUBLE
from theory.result import Result
from verification.execution.progress import ProgressCallback, of_part

if TYPE_CHECKING:
    from theory.piecewise.roots import RootSet

_MAX_ROOTS = 100_000
_MAX_DIGITS_OF_ROOTS = 10_000_000
"""Largest product of the numbers of roots and digits in one half-plane: a few minutes."""


@dataclass(frozen=True, kw_only=True)
class Root(Result):
    """One root of the dispersion relation.

    Attributes
    ----------
    label : int
        Number of the strip that contains this root and no other.
    re, im : float or str
        Real and imaginary part, per site; decimal strings if more than 15 digits are required.
    residual : float
        |L(k)|, dimensionless.
    radius : float
        Bound on the distance from the true root, rounding included.
    """

    label: int
    re: float | str
    im: float | str
    residual: float
    radius: float


@dataclass(frozen=True, kw_only=True)
class Roots(Result):
    """Roots of L(k) = 0 in both half-planes.

    Attributes
    ----------
    upper, lower : tuple of Root
        Roots above and below the real axis, ascending in |k|.
    counted : int
        Number of roots by the argument principle, which does not use labels.
    certified : bool
        Whether all radii and the number are proven in ball arithmetic.
    """

    upper: tuple[Root, ...]
    lower: tuple[Root, ...]
    counted: int
    certified: bool

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per root, the upper half-plane first."""
        both = [*self.upper, *self.lower]
        names = ["upper"] * len(self.upper) + ["lower"] * len(self.lower)
        return {"half_plane": np.array(names)} | {
            name: np.array([getattr(root, name) for root in both])
            for name in ("label", "re", "im", "residual", "radius")
        }


@with_ranges(digits=DIGITS, double=DOUBLE)
def roots(
    v: float | str,
    c: float | str,
    *,
    count: int | None = None,
    extent: float | None = None,
    digits: int = DOUBLE,
    certify: bool = False,
    progress: ProgressCallback | None = None,
) -> Roots:
    """Return labelled complex roots of the dispersion relation (Eqs. 50-52).

    Parameters
    ----------
    v : float or str
        Front velocity v̂ > 0, dimensionless; a string is read as a decimal with all its digits, a
        float is the exact binary number.
    c : float or str
        Coupling c > 0, dimensionless; read in the same way as v.
    count : int, optional
        Number of roots nearest 0 in each half-plane; 10 if extent is not given either.
    extent : float, optional
        Largest |Re k| of the roots, in place of count.
    digits : int, optional
        Required digits, {digits}; with certify at most {double}.
    certify : bool, optional
        Enclose and count the roots in ball arithmetic; needs the extra certify (python-flint).
    progress : callable, optional
        Called with the fraction done, if more than 15 digits are required.

    Returns
    -------
    Roots
        The roots in both half-planes, each with a permanent label and a radius.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or count and extent are both given.
    MissingPackageError
        If ``certify`` is true and python-flint is not installed.
    RunError
        If a root could not be enclosed.

    References
    ----------
    Krawczyk, R. (1969), Computing 4, 187, and Moore, R. E. (1977), SIAM J. Numer. Anal. 14, 611:
    the interval Newton test.

    Examples
    --------
    >>> import fronts as fr
    >>> found = fr.roots(0.3, 0.5, count=3)
    >>> found.counted, [root.label for root in found.upper]
    (6, [0, 1, -1])
    """
    from theory.piecewise.roots import nearest_roots, roots_within

    v, c, certify = decimal("velocity v", v), decimal("coupling c", c), truth("certify", certify)
    check_progress(progress)
    v_, c_ = float(v), float(c)
    remedy = (
        "certified radii are available in double precision only: leave one of them out"
        if certify
        else None
    )
    digits = count_within("digits", digits, DIGITS.low, DOUBLE if certify else DIGITS.high, remedy)
    if count is not None and extent is not None:
        raise ParameterError(
            "extent |Re k|", extent, "absent when a count is given", "give one of them"
        )
    requested = count_within("root count", 10 if count is None else count, 1, _MAX_ROOTS)
    halves = [
        nearest_roots(v_, c_, requested, upper)
        if extent is None
        else roots_within(v_, c_, extent, upper)
        for upper in (True, False)
    ]
    if digits > DOUBLE:
        largest = max(half.labels.size for half in halves)
        remedy = "ask for fewer roots or digits"
        count_within("roots times digits", largest * digits, 0, _MAX_DIGITS_OF_ROOTS, remedy)
    counted = sum(_counted(v_, c_, half, upper=not i) for i, half in enumerate(halves))
    if certify:
        halves = [_certified(v, c, half, upper=not i) for i, half in enumerate(halves)]
    else:
        halves = [_of_decimals(v, c, half) for half in halves]
    rows = []
    for i, half in enumerate(halves):
        if digits <= DOUBLE:
            rows.append(_in_double(half))
        else:
            part_progress = of_part(progress, i, len(halves))
            rows.append(
                _in_decimals(v, c, half, upper=not i, digits=digits, progress=part_progress)
            )
    return Roots(upper=rows[0], lower=rows[1], counted=counted, certified=certify)


def _counted(v: float, c: float, found: RootSet, upper: bool) -> int:
    """Count the roots by the argument principle, in a box around these strips."""
    from theory.piecewise.root_count import count_in_strips

    if found.labels.size == 0:
        return 0
    labels = np.arange(found.labels.min(), found.labels.max() + 1)
    return count_in_strips(v, c, labels, upper) - (labels.size - found.labels.size)


def _of_decimals(v: float | str, c: float | str, found: RootSet) -> RootSet:
    """Return the same roots with radii that include the rounding of v and c to doubles.

    It is based on dk/dv = -k/(v + c sin k) and dk/dc = -2 sin²(k/2)/(v + c sin k).
    """
    from fractions import Fraction

    v_, c_ = float(v), float(c)
    rounding = [abs(float(Fraction(text) - Fraction(float(text)))) for text in (v, c)]
    slope = np.abs(v_ + c_ * np.sin(found.k))
    by_v, by_c = np.abs(found.k) / slope, 2.0 * np.abs(np.sin(0.5 * found.k)) ** 2 / slope
    # The factor 1.5 accounts for higher orders.
    radius = found.radius + 1.5 * (by_v * rounding[0] + by_c * rounding[1])
    return replace(found, radius=radius)


def _certified(v: float | str, c: float | str, found: RootSet, upper: bool) -> RootSet:
    """Return the same roots with certified radii."""
    from theory.piecewise.certified_roots import CertificationError, certify_roots

    if found.labels.size == 0:
        return found
    labels = np.arange(found.labels.min(), found.labels.max() + 1)
    try:
        certified = certify_roots(v, c, labels, upper).roots
    except CertificationError as error:
        raise RunError(f"not certified: {error}") from None
    return certified.take(found.labels - labels[0])


def _in_double(found: RootSet) -> tuple[Root, ...]:
    columns = (found.labels, found.k.real, found.k.imag, found.residual, found.radius)
    return tuple(
        Root(label=label, re=re, im=im, residual=residual, radius=radius)
        for label, re, im, residual, radius in zip(
            *(column.tolist() for column in columns), strict=True
        )
    )


def _in_decimals(
    v: float | str, c: float | str, found: RootSet, *, upper: bool, digits: int,
    progress: ProgressCallback,
) -> tuple[Root, ...]:  # fmt: skip
    import mpmath as mp

    from theory.piecewise.precise_roots import exact, precise_roots

    rows = []
    with mp.workdps(digits + 10):
        v_, c_ = exact(v), exact(c)
        for done, label in enumerate(found.labels.tolist()):
            progress(done / found.labels.size)
            (k,) = precise_roots(v, c, found.labels[done : done + 1], upper, digits)
            residual = abs(mp.mpf(0.5) - 2j * c_ * mp.sin(k / 2) ** 2 - 1j * v_ * k)
            printed = abs(k) * mp.mpf(10) ** (1 - digits)  # error of printing ``digits`` digits
            radius = 2 * residual / abs(v_ + c_ * mp.sin(k)) + printed
            rows.append(
                Root(
                    label=label,
                    re=mp.nstr(k.real, digits),
                    im=mp.nstr(k.imag, digits),
                    residual=float(residual),
                    radius=math.nextafter(float(radius), math.inf),  # not zero even for 400 digits
                )
            )
    return tuple(rows)
