"""The kinetic relation of the piecewise-linear chain, at points and along curves (Eq. 54)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any, TypeAlias

import numpy as np

from theory.arrays import FloatArray
from theory.parameters import ParameterError, check_progress, real_array, truth, with_ranges
from theory.piecewise.kinetic_relation import (
    COUPLINGS,
    KineticRelation,
    trace_kinetic_relation,
    with_stability,
)
from theory.result import Result
from verification.execution.progress import ProgressCallback, of_part

Numbers: TypeAlias = float | Sequence[float] | FloatArray
"""A number or a one-dimensional array of numbers."""


@dataclass(frozen=True, kw_only=True)
class KineticCurve(Result):
    """All velocities along a line in the plane of coupling and η.

    Attributes
    ----------
    along : str
        The parameter that varies, ``c`` or ``eta``.
    points : tuple of KineticRelation
        The results, in the order of the values.
    seconds : float
        Wall time.
    """

    is_curve = True

    along: str
    points: tuple[KineticRelation, ...]
    seconds: float

    @property
    def stability_shown(self) -> bool:
        """Whether the stability of the fronts was requested."""
        return any(point.limit_shown for point in self.points)

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per branch, and one without a velocity where there is no branch."""
        tables = [point.columns() for point in self.points]
        return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


@with_ranges(couplings=COUPLINGS)
def kinetic_relation(
    c: Numbers,
    eta: Numbers | None = None,
    *,
    a: float | None = None,
    b: float | None = None,
    stability: bool = False,
    certify: bool = False,
    progress: ProgressCallback | None = None,
) -> KineticRelation | KineticCurve:
    """Return every velocity at which the piecewise-linear front can travel (Eq. 54).

    Parameters
    ----------
    c : float or array_like of float, shape (n,)
        Coupling, dimensionless, {couplings}.
    eta : float or array_like of float, shape (n,), optional
        η = b/a², dimensionless, positive; two limit cycles exist below 1/8.
    a, b : float, optional
        Damping coefficients of (8), dimensionless; both must be given, in place of eta.
    stability : bool, optional
        Determine the linear stability of each admissible front along a curve too, and the coupling
        at which the fastest front first loses stability (``c_stable``); this takes longer. For
        single numbers the stability is always determined, without ``c_stable``. At strong coupling
        (such as c = 1000) stability may remain undecided, because its series is too long.
    certify : bool, optional
        Prove the velocities, their number and the thresholds in ball arithmetic; needs the extra
        certify (python-flint). Parts that could not be proven are named in ``unproven``.
    progress : callable, optional
        Called from time to time with the fraction done.

    Returns
    -------
    KineticRelation or KineticCurve
        A curve if c or eta is an array; its ``points`` are the results for single numbers, with
        all branches. With ``certify``, a `theory.piecewise.certified_relation.CertifiedRelation`.
        A pinned front, or η ≥ 1/8, is not an error; see ``status``.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or η is given twice or not at all.
    MissingPackageError
        If ``certify`` is true and python-flint is not installed.

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
    stability, certify = truth("stability", stability), truth("certify", certify)
    check_progress(progress)
    eta_ = damping_ratio(eta, a, b)
    c_ = real_array("coupling c", c)
    _check_curve(c_, np.asarray(eta_))
    begin = perf_counter()
    # Compared with a proof, the search takes no time.
    answers = trace_kinetic_relation(c_, eta_, progress=None if certify else progress)
    single = c_.ndim == 0 and np.ndim(eta_) == 0
    if stability or single:
        answers = [_with_stability(answer, stability) for answer in answers]
    if certify:
        from theory.piecewise.certified_relation import certify_relation

        callbacks = [of_part(progress, i, len(answers)) for i in range(len(answers))]
        answers = [certify_relation(*each) for each in zip(answers, callbacks, strict=True)]
    if single:
        return answers[0]
    return KineticCurve(
        along="c" if c_.ndim else "eta",
        points=tuple(answers),
        seconds=perf_counter() - begin,
    )


def _check_curve(c: FloatArray, eta: FloatArray) -> None:
    """Refuse arrays that do not form a curve along one of the two parameters."""
    for quantity, values in (("coupling c", c), ("eta", eta)):
        if not values.size:
            raise ParameterError(quantity, "[]", "one number or more", "give at least one")
        if values.ndim > 1:
            raise ParameterError(
                f"shape of {quantity}", values.shape, "a row of numbers", "give one row at a time"
            )
    if 1 not in (c.size, eta.size) and c.size != eta.size:
        raise ParameterError(
            "eta", f"{eta.size} numbers", f"one number, or one for each of {c.size} couplings",
            "vary one of them, or sweep over both",
        )  # fmt: skip


def _with_stability(answer: KineticRelation, limit: bool) -> KineticRelation:
    branches = tuple(with_stability(branch, answer.c) for branch in answer.branches)
    return replace(answer, branches=branches, limit_shown=limit)


def damping_ratio(eta: Any, a: float | None, b: float | None) -> Any:
    """Return η, given as such or by a and b."""
    if eta is not None:
        if a is not None or b is not None:
            raise ParameterError("eta", eta, "absent when a and b are given", "give one of them")
        return real_array("eta", eta)
    if a is None or b is None:
        raise ParameterError(
            "eta", "absent", "given where a and b are not both given", "give eta, or both a and b"
        )
    from theory.cells.vdp import eta_from_damping

    return eta_from_damping(a, b)
