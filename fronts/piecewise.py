"""The closed solution of the piecewise-linear chain (44): relation, sum, roots, shape of its front.

Four functions of the public API, `fronts.kinetic_relation`, `fronts.sigma`, `fronts.roots` and
`fronts.front_profile`, with their results. What they compute is in `theory.piecewise`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from theory.parameters import ParameterError, RunError, count_within, number, within
from theory.piecewise.kinetic_relation import (
    Branch,
    KineticRelation,
    Status,
    trace_kinetic_relation,
    with_stability,
)
from theory.result import Result

if TYPE_CHECKING:
    from theory.piecewise.roots import RootSet
    from theory.piecewise.sums.result import KineticSum

FloatArray: TypeAlias = npt.NDArray[np.float64]
ComplexArray: TypeAlias = npt.NDArray[np.complex128]
Numbers: TypeAlias = float | Sequence[float] | FloatArray
"""A number or a one-dimensional array of them."""

_DOUBLE = 15
_MAX_DIGITS = 2000
_MAX_ROOTS = 100_000
_MAX_DIGITS_OF_ROOTS = 10_000_000
"""Roots times digits in one half-plane, beyond double precision: some minutes."""
_FARTHEST = 1e6


@dataclass(frozen=True, kw_only=True)
class KineticCurve(Result):
    """Every velocity along a line in the plane of coupling and η.

    Attributes
    ----------
    along : str
        ``c`` or ``eta``: what varies.
    points : tuple of KineticRelation
        The answers, in the order of the values.
    seconds : float
        Wall time.
    """

    along: str
    points: tuple[KineticRelation, ...]
    seconds: float

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row a branch, and one without a velocity where there is none."""
        tables = [point.columns() for point in self.points]
        return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def kinetic_relation(
    c: Numbers,
    eta: Numbers | None = None,
    *,
    a: float | None = None,
    b: float | None = None,
    stability: bool = False,
    certify: bool = False,
    progress: Callable[[float], None] | None = None,
) -> KineticRelation | KineticCurve:
    """Return every velocity at which the piecewise-linear front can travel (Eq. 54).

    Parameters
    ----------
    c : float or array_like of float, shape (n,)
        Coupling, dimensionless, from 1e-8 to 1e8.
    eta : float or array_like of float, shape (n,), optional
        η = b/a², dimensionless, positive; two limit cycles exist below 1/8.
    a, b : float, optional
        Damping coefficients of (8), dimensionless; both, in place of eta.
    stability : bool, optional
        Also decide the linear stability of each admissible front along a curve, and where the
        fastest one first loses it (``c_stable``), which takes longer. Of single numbers the
        stability is always given, without ``c_stable``.
    certify : bool, optional
        Prove the velocities, their number and the thresholds in ball arithmetic; needs the extra
        certify (python-flint). What could not be proven is named in ``unproven``.
    progress : callable, optional
        Called with the fraction done, now and then.

    Returns
    -------
    KineticRelation or KineticCurve
        A curve where c or eta is an array: its ``points`` are what single numbers give, with every
        branch. With ``certify``, a `theory.piecewise.certified_relation.CertifiedRelation`. A
        pinned front and η ≥ 1/8 are answers, not errors; see ``status``.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or η is given twice or not at all.
    MissingPackageError
        If certify is asked for and python-flint is not installed.
    PrecisionError
        If the velocities are too many to be distinguished (c above some 10⁴ and η near 2/25).

    References
    ----------
    Atkinson, W. & Cabrera, N. (1965), Phys. Rev. 138, A763: a chain of two parabolas.
    Slepyan, L. I. (2002), Models and Phenomena in Fracture Mechanics, Springer.

    Examples
    --------
    >>> import fronts as fr
    >>> round(fr.kinetic_relation(c=0.5, eta=0.03125).branches[0].v, 12)
    0.300992350759
    >>> curve = fr.kinetic_relation(c=[0.4, 0.45, 0.5], eta=0.03125)
    >>> [len(point.branches) for point in curve.points]
    [0, 2, 1]
    """
    eta_ = _eta(eta, a, b)
    c_ = _numbers("coupling c", c)
    answers = trace_kinetic_relation(c_, eta_, progress=progress)
    single = c_.ndim == 0 and np.ndim(eta_) == 0
    if stability or single:
        answers = [_with_stability(answer, stability) for answer in answers]
    if certify:
        from theory.piecewise.certified_relation import certify_relation

        shares = [_share(progress, i, len(answers)) for i in range(len(answers))]
        answers = [certify_relation(*each) for each in zip(answers, shares, strict=True)]
    if single:
        return answers[0]
    return KineticCurve(
        along="c" if c_.ndim else "eta",
        points=tuple(answers),
        seconds=sum(answer.seconds for answer in answers),
    )


def _with_stability(answer: KineticRelation, limit: bool) -> KineticRelation:
    branches = tuple(with_stability(branch, answer.c) for branch in answer.branches)
    return replace(answer, branches=branches, limit_shown=limit)


def _eta(eta: Any, a: float | None, b: float | None) -> Any:
    """Return η as it was given, or from a and b."""
    if eta is not None:
        if a is not None or b is not None:
            raise ParameterError("eta", eta, "absent beside a and b", "give one of them")
        return _numbers("eta", eta)
    if a is None or b is None:
        raise ParameterError(
            "eta", "absent", "given where a and b are not both given", "give eta, or both a and b"
        )
    from theory.cells.vdp import eta_from_damping

    return eta_from_damping(a, b)


def _numbers(quantity: str, values: Any) -> FloatArray:
    """Return one number or several as an array, or refuse what is none."""
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(quantity, values, "a number or numbers", "give those") from None


def _decimal(quantity: str, value: Any) -> float | str:
    """Return a decimal as it was written, or a number as a float."""
    found = number(quantity, value)
    return value if isinstance(value, str) else found


def sigma(
    v: float | str,
    c: float | str,
    *,
    method: Literal["integral", "series", "bessel", "quadrature", "certified"] = "integral",
    digits: int = 12,
) -> KineticSum:
    """Return Σ(v, c), the left side of the kinetic relation (Eq. 53).

    Parameters
    ----------
    v : float or str
        Front velocity v̂ > 0, dimensionless; a string is read as a decimal, digit for digit.
    c : float or str
        Coupling c > 0, dimensionless; a string is read as a decimal, digit for digit.
    method : {"integral", "series", "bessel", "quadrature", "certified"}, optional
        Integral: one integral over a period, trapezoidal rule; series: the printed series over the
        roots, its tail summed; bessel: a series of Bessel functions; quadrature: adaptive
        quadrature on the real line; these two work in double precision. Certified: the integral in
        ball arithmetic, whose error is proven (needs the extra certify).
    digits : int, optional
        Digits after the point that are wanted, from 1 to 2000.

    Returns
    -------
    KineticSum
        ``value``, its ``error`` bound, ``terms``, ``method``, ``seconds``; beyond 15 digits the
        value is one of mpmath.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or so many digits are beyond the method.
    PrecisionError
        If the method cannot reach so many digits at these parameters.

    References
    ----------
    Trefethen, L. N. & Weideman, J. A. C. (2014), SIAM Review 56, 385: the trapezoidal rule.

    Examples
    --------
    >>> import fronts as fr
    >>> found = fr.sigma(0.3, 0.5)
    >>> bool(abs(found.value - (-0.28879675619025 + 0.45226875874939j)) < 1e-12)
    True
    """
    from theory.piecewise.sums.result import PrecisionError

    v, c = _decimal("velocity v", v), _decimal("coupling c", c)
    digits = count_within("digits", digits, 1, _MAX_DIGITS)
    within_double = digits <= 13 or method in ("integral", "series", "certified")
    if not within_double:
        raise ParameterError(
            "digits", digits, f"at most 13 for {method}, which works in double precision",
            "ask for fewer, or take the method integral or series",
        )  # fmt: skip
    try:
        return _SUMS[method](v, c, digits)
    except KeyError:
        known = ", ".join(_SUMS)
        raise ParameterError("method", method, f"one of {known}", "choose one") from None
    except ParameterError:
        raise
    except ArithmeticError as refusal:
        raise PrecisionError(str(refusal)) from None


def _by_series(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.sums.series import sum_by_roots

    found = sum_by_roots(v, c, digits)
    if digits > _DOUBLE or found.error <= 10.0**-digits:
        return found
    return _rounded(sum_by_roots(v, c, _DOUBLE + 1))


def _by_integral(v: float | str, c: float | str, digits: int) -> KineticSum:
    if digits <= _DOUBLE:
        from theory.piecewise.sums.integral import sum_by_integral

        tolerance = 0.5 * 10.0**-digits if digits < _DOUBLE else 1e-15
        found = sum_by_integral(float(v), float(c), tolerance)
        if found.error <= 10.0**-digits:
            return found
    from theory.piecewise.sums.precise import precise_sum_by_integral

    found = precise_sum_by_integral(v, c, digits)
    return found if digits > _DOUBLE else _rounded(found)


def _by_bessel(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.sums.bessel import sum_by_bessel

    return sum_by_bessel(float(v), float(c), 10.0**-digits)


def _by_quadrature(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.sums.quadrature import sum_by_quadrature

    return sum_by_quadrature(float(v), float(c), 0.1 * 10.0**-digits)


def _certified_sum(v: float | str, c: float | str, digits: int) -> KineticSum:
    from theory.piecewise.certified_sum import certified_sum

    return certified_sum(v, c, digits)


def _rounded(found: KineticSum) -> KineticSum:
    """Return a precise sum in double precision, the rounding in its error."""
    value = complex(found.value)
    error = float(found.error) + abs(value) * np.finfo(float).eps
    return replace(found, value=value, error=float(error), digits=_DOUBLE)


_SUMS: dict[str, Callable[[float | str, float | str, int], KineticSum]] = {
    "integral": _by_integral,
    "series": _by_series,
    "bessel": _by_bessel,
    "quadrature": _by_quadrature,
    "certified": _certified_sum,
}


@dataclass(frozen=True, kw_only=True)
class Root(Result):
    """One root of the dispersion relation.

    Attributes
    ----------
    label : int
        The strip that holds it and no other.
    re, im : float or str
        Its parts, per site; strings of decimals beyond 15 digits.
    residual : float
        |L(k)|, dimensionless.
    radius : float
        The true root lies within this distance, rounding included.
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
        Their number by the argument principle, which knows nothing of labels.
    certified : bool
        Whether every radius and the number are proved in ball arithmetic.
    """

    upper: tuple[Root, ...]
    lower: tuple[Root, ...]
    counted: int
    certified: bool

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row a root, the upper half-plane first."""
        both = [*self.upper, *self.lower]
        names = ["upper"] * len(self.upper) + ["lower"] * len(self.lower)
        return {"half_plane": np.array(names)} | {
            name: np.array([getattr(root, name) for root in both])
            for name in ("label", "re", "im", "residual", "radius")
        }


def roots(
    v: float | str,
    c: float | str,
    *,
    count: int | None = None,
    extent: float | None = None,
    digits: int = _DOUBLE,
    certify: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Roots:
    """Return labelled complex roots of the dispersion relation (Eqs. 50-52).

    Parameters
    ----------
    v : float or str
        Front velocity v̂ > 0, dimensionless; a string is read as a decimal, digit for digit.
    c : float or str
        Coupling c > 0, dimensionless; a string is read as a decimal, digit for digit.
    count : int, optional
        The roots nearest 0, so many in each half-plane; 10 where extent is not given either.
    extent : float, optional
        Every root with |Re k| up to this, in place of count.
    digits : int, optional
        Digits that are wanted, from 1 to 2000.
    certify : bool, optional
        Enclose and count the roots in ball arithmetic; needs the extra certify (python-flint).
    progress : callable, optional
        Called with the fraction done, where digits are many.

    Returns
    -------
    Roots
        Both half-planes, with labels that never change and a radius about each root.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or count and extent are both given.
    MissingPackageError
        If certify is asked for and python-flint is not installed.
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

    v, c = _decimal("velocity v", v), _decimal("coupling c", c)
    v_, c_ = float(v), float(c)
    digits = count_within("digits", digits, 1, _MAX_DIGITS)
    if count is not None and extent is not None:
        raise ParameterError("extent |Re k|", extent, "absent beside a count", "give one of them")
    number = count_within("root count", 10 if count is None else count, 1, _MAX_ROOTS)
    halves = [
        nearest_roots(v_, c_, number, upper)
        if extent is None
        else roots_within(v_, c_, extent, upper)
        for upper in (True, False)
    ]
    if digits > _DOUBLE:
        most = max(half.labels.size for half in halves)
        remedy = "ask for fewer roots or digits"
        count_within("roots times digits", most * digits, 0, _MAX_DIGITS_OF_ROOTS, remedy)
    counted = sum(_counted(v_, c_, half, upper=not i) for i, half in enumerate(halves))
    if certify:
        halves = [_certified(v_, c_, half, upper=not i) for i, half in enumerate(halves)]
    rows = []
    for i, half in enumerate(halves):
        if digits <= _DOUBLE:
            rows.append(_in_double(half))
        else:
            shown = _share(progress, i, len(halves))
            rows.append(
                _in_decimals(str(v), str(c), half, upper=not i, digits=digits, progress=shown)
            )
    return Roots(upper=rows[0], lower=rows[1], counted=counted, certified=certify)


def _share(
    progress: Callable[[float], None] | None, part: int, parts: int
) -> Callable[[float], None]:
    """Return the progress of one part of several."""
    return lambda fraction: None if progress is None else progress((part + fraction) / parts)


def _counted(v: float, c: float, found: RootSet, upper: bool) -> int:
    """Count the roots by the argument principle, in a box about exactly these strips."""
    from theory.piecewise.root_count import count_in_strips

    if found.labels.size == 0:
        return 0
    labels = np.arange(found.labels.min(), found.labels.max() + 1)
    return count_in_strips(v, c, labels, upper) - (labels.size - found.labels.size)


def _certified(v: float, c: float, found: RootSet, upper: bool) -> RootSet:
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
    v: str, c: str, found: RootSet, *, upper: bool, digits: int, progress: Callable[[float], None]
) -> tuple[Root, ...]:
    import mpmath as mp

    from theory.piecewise.precise_roots import exact, precise_roots

    rows = []
    with mp.workdps(digits + 10):
        v_, c_ = exact(v), exact(c)
        for done, label in enumerate(found.labels.tolist()):
            progress(done / found.labels.size)
            (k,) = precise_roots(v, c, found.labels[done : done + 1], upper, digits)
            residual = abs(mp.mpf(0.5) - 2j * c_ * mp.sin(k / 2) ** 2 - 1j * v_ * k)
            printed = abs(k) * mp.mpf(10) ** (1 - digits)  # what printing so many digits costs
            radius = 2 * residual / abs(v_ + c_ * mp.sin(k)) + printed
            rows.append(
                Root(
                    label=label,
                    re=mp.nstr(k.real, digits),
                    im=mp.nstr(k.imag, digits),
                    residual=float(residual),
                    radius=float(radius),
                )
            )
    return tuple(rows)


@dataclass(frozen=True, kw_only=True, eq=False)
class Profile(Result):
    """The shape φ(ζ)/φ_s of a front.

    Attributes
    ----------
    c, eta : float
        Coupling and η = b/a², dimensionless.
    v, v_error : float
        Velocity v̂ of the front, negative where it retreats, and the bound on its error.
    admissible : bool or None
        Whether (47) holds for every ζ; None if it was not decided.
    fails_at : float or None
        ζ of the violation nearest 0.
    threshold : float
        |φ_us|/|φ_s|.
    zeta : ndarray of float, shape (n,)
        Positions, site - vT, in sites.
    phi : ndarray of complex, shape (n,)
        φ(ζ)/φ_s, dimensionless.
    error : float
        Bound on the error of every value.
    points : int
        Points of the quadrature.
    """

    derived = ("re", "im")

    c: float
    eta: float
    v: float
    v_error: float
    admissible: bool | None
    fails_at: float | None
    threshold: float
    zeta: FloatArray = field(metadata={"axis": "zeta"})
    phi: ComplexArray = field(metadata={"dims": ("zeta",), "json": None})
    error: float
    points: int

    @property
    def re(self) -> FloatArray:
        """Real part of φ(ζ)/φ_s."""
        return self.phi.real

    @property
    def im(self) -> FloatArray:
        """Imaginary part of φ(ζ)/φ_s."""
        return self.phi.imag

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row a position."""
        return {
            "zeta": self.zeta,
            "re_phi": self.phi.real,
            "im_phi": self.phi.imag,
            "abs_phi": np.abs(self.phi),
        }


def front_profile(
    c: float,
    eta: float | None = None,
    *,
    a: float | None = None,
    b: float | None = None,
    branch: int | None = None,
    low: float = -8.0,
    high: float = 8.0,
    points: int = 321,
) -> Profile:
    """Return the shape of a travelling front (Eq. 49) and whether it is admissible (Eq. 47).

    Parameters
    ----------
    c : float
        Coupling, dimensionless, from 1e-8 to 1e8.
    eta : float, optional
        η = b/a², dimensionless; two limit cycles exist below 1/8.
    a, b : float, optional
        Damping coefficients of (8), dimensionless; both, in place of eta.
    branch : int, optional
        Which solution, 1 the slowest; by default the fastest admissible.
    low : float, optional
        First position ζ, in sites.
    high : float, optional
        Last position ζ, in sites.
    points : int, optional
        Number of positions.

    Returns
    -------
    Profile
        Positions, values, and the front that they are of.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or there is no such branch.
    RunError
        If no front travels there.
    PrecisionError
        If more than two million points of quadrature would be needed (v or c above some 10⁴).

    References
    ----------
    Trefethen, L. N. & Weideman, J. A. C. (2014), SIAM Review 56, 385: the trapezoidal rule.

    Examples
    --------
    >>> import fronts as fr
    >>> shape = fr.front_profile(0.5, 0.03125, low=-40, high=40, points=3)
    >>> [round(float(abs(value)), 6) for value in shape.phi]
    [1.0, 0.267949, 0.0]
    """
    from theory.cells.vdp import threshold_ratio
    from theory.piecewise.profile import front_profile as shape_of

    points = count_within("number of points", points, 2, 1_000_000)
    low = within("first position", low, -_FARTHEST, _FARTHEST)
    high = within("last position", high, -_FARTHEST, _FARTHEST)
    if not low < high:
        raise ParameterError(
            "last position", high, f"above the first, {low:g}", "make it larger than the first"
        )
    (answer,) = trace_kinetic_relation(
        number("coupling c", c), _eta(None if eta is None else number("eta", eta), a, b)
    )
    if not answer.branches:
        raise RunError(f"there is no travelling front to draw: {answer.reason}")
    chosen = _chosen(answer.branches, branch)
    zeta = np.linspace(low, high, points)
    if chosen.v > 0:
        shape = shape_of(zeta, chosen.v, answer.c)
        phi = shape.phi
    else:  # a retreating front is 1 - φ(-ζ) of the advancing one
        shape = shape_of(-zeta, -chosen.v, answer.c)
        phi = 1.0 - shape.phi
    return Profile(
        c=answer.c,
        eta=answer.eta,
        v=chosen.v,
        v_error=chosen.error,
        admissible=chosen.admissible,
        fails_at=chosen.fails_at,
        threshold=threshold_ratio(answer.eta),
        zeta=zeta,
        phi=np.asarray(phi, dtype=np.complex128),
        error=shape.error,
        points=shape.points,
    )


def _chosen(branches: tuple[Branch, ...], wanted: int | None) -> Branch:
    if wanted is not None:
        last = len(branches)
        remedy = "choose one of these, in ascending v"
        return branches[count_within("branch", wanted, 1, last, remedy) - 1]
    admissible = [each for each in branches if each.admissible]
    return (admissible or list(branches))[-1]


__all__ = [
    "KineticCurve", "Profile", "Root", "Roots", "Status",
    "front_profile", "kinetic_relation", "roots", "sigma",
]  # fmt: skip
