"""The kinetic relation (54): every velocity at which a front can travel at given coupling and η."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from functools import lru_cache
from time import perf_counter
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from theory.arrays import BoolArray, FloatArray
from theory.cells.vdp import ETA_END, checked_eta, threshold_ratio, threshold_ratio_slope
from theory.parameters import Range, with_ranges, within
from theory.piecewise.admissibility import check_fronts
from theory.piecewise.branch_search import Solutions, all_velocities
from theory.piecewise.folds import KineticFold, fold_couplings
from theory.piecewise.limits import ETA_PIN_END, pinning_coupling, pinning_error, retreat_coupling
from theory.piecewise.stability import front_stability
from theory.piecewise.stability_limit import StabilityLimit, stability_limit
from theory.result import Result

COUPLINGS = Range(1e-8, 1e8)
_BLOCK = 2000
"""Number of cases that are solved at once; more would need memory and not be faster."""


class Regime(StrEnum):
    """Behaviour of the fronts of (44); `KineticRelation.reason` explains it."""

    PROPAGATING = "propagating"
    """A travelling wave is admissible, or no front can stand still."""
    PINNED = "pinned"
    """Fronts stand still, and no travelling wave is admissible."""
    NOT_BISTABLE = "not_bistable"
    """There is no front."""


@dataclass(frozen=True, kw_only=True)
class KineticBranch(Result):
    """One solution of the kinetic relation.

    Attributes
    ----------
    v : float
        Velocity v̂ in sites per unit εt; negative where the excited state retreats.
    error : float
        Bound on the error of v.
    slope : int
        Sign of d|Σ|/d|v|; -1 on the branch that a direct simulation follows.
    by_c, by_eta : float
        ∂v/∂c and ∂v/∂η along the branch, dimensionless; infinite at a fold.
    by_c_error, by_eta_error : float
        Their errors, which grow like that of v towards a fold; infinite (null in JSON) where the
        slope of |Σ| may vanish within the error of v, so that not even their signs are known: where
        a fold is nearer than this error, and where v tends to zero, as just above c_retreat. They
        are estimates rather than proven bounds: within the error interval of v, the derivatives of
        |Σ| are assumed to lie between those at its middle and its ends.
    admissible : bool or None
        Whether (47) holds for every ζ; None if it was not decided.
    fails_at : float or None
        A position ζ, in sites, at which (47) is violated: the one nearest 0 of those examined; None
        if there is none.
    stable : bool or None
        Whether the front is linearly stable (``theory.piecewise.stability``); None if the front is
        not admissible, or if stability was not decided or not requested.
    multiplier : float or None
        Largest modulus of a nontrivial multiplier; None if all are below e^{-1/4v}, or unknown.
    multiplier_error : float or None
        Its error, which includes the effect of the error of v to first order.
    """

    derived = ("derivative_errors",)

    v: float
    error: float
    slope: int
    by_c: float
    by_eta: float
    by_c_error: float
    by_eta_error: float
    admissible: bool | None
    fails_at: float | None
    stable: bool | None = None
    multiplier: float | None = None
    multiplier_error: float | None = None

    @property
    def derivative_errors(self) -> str:
        """Kind of the errors of ∂v/∂c and ∂v/∂η: they are estimates, not bounds."""
        return "estimates"


@lru_cache(maxsize=16)
def _folds(etas: tuple[float, ...]) -> dict[float, KineticFold | None]:
    """Return the folds at several η, which are found faster together."""
    return dict(zip(etas, fold_couplings(etas), strict=True))


def _end_of_rest(eta: float) -> float:
    """Return the coupling up to which fronts can be at rest; infinite at η = 2/25."""
    end = pinning_coupling(eta) if eta < ETA_PIN_END else retreat_coupling(eta)
    return math.inf if end is None else end


def _status(c: float, end_of_rest: float | None, branches: tuple[KineticBranch, ...]) -> Regime:
    """Return the behaviour at coupling c with these branches; no ``end_of_rest`` means η ≥ 1/8."""
    if end_of_rest is None:
        return Regime.NOT_BISTABLE
    if c > end_of_rest or (end_of_rest < math.inf and _any_moving(branches)):
        return Regime.PROPAGATING
    return Regime.PINNED


def _any_moving(branches: tuple[KineticBranch, ...]) -> bool:
    return any(branch.admissible is not False for branch in branches)


@dataclass(frozen=True, kw_only=True)
class KineticRelation(Result):
    """The answer at one (c, η).

    Attributes
    ----------
    c, eta : float
        Coupling and η = b/a², dimensionless.
    status : Regime
        Behaviour of the fronts.
    branches : tuple of KineticBranch
        Solutions of (54), ascending in v.
    method : str
        Method by which Σ was evaluated.
    terms : int
        Number of values of Σ computed.
    seconds : float
        Wall time.
    limit_shown : bool
        Whether ``c_stable`` and its error are included in the JSON object.
    etas : tuple of float
        All η below 1/8 of the same call, whose folds are found together.
    """

    c: float
    eta: float
    status: Regime
    branches: tuple[KineticBranch, ...]
    method: str
    terms: int
    seconds: float
    limit_shown: bool = field(default=False, repr=False, metadata={"json": None})
    etas: tuple[float, ...] = field(repr=False, compare=False, metadata={"json": None})

    derived: ClassVar[tuple[str, ...]] = (
        "reason", "c_pin", "c_fold", "c_retreat", "c_pin_error", "c_fold_error", "c_retreat_error",
    )  # fmt: skip

    @property
    def reason(self) -> str:
        """Reason of the status in one sentence, with the nearest threshold."""
        moving = _any_moving(self.branches)
        if self.eta >= ETA_END:
            return (
                f"eta = {self.eta:g} is not below 1/8, where the two limit cycles meet: there is "
                "no front."
            )
        if self.c_pin is None:
            return self._reason_of_retreat(moving)
        if self.c > self.c_pin and moving:
            return f"c is above c_pin = {self.c_pin:.6g}."
        if self.c > self.c_pin and not self.branches:
            return self._reason_beside("c_pin", self.c_pin)
        if self.c > self.c_pin:
            return (
                f"c is above c_pin = {self.c_pin:.6g}, where no static front exists, but no "
                "travelling wave is admissible: simulate it."
            )
        if moving:
            return (
                f"c is between c_fold = {self.c_fold:.6g} and c_pin = {self.c_pin:.6g}: a moving "
                "front keeps moving, a resting one stays."
            )
        return (
            f"the front is pinned: steady motion begins at c_fold = {self.c_fold:.6g} (static "
            f"fronts end at c_pin = {self.c_pin:.6g})."
        )

    def _reason_of_retreat(self, moving: bool) -> str:
        """Return the reason for η ≥ 2/25, where no front advances."""
        end = self.c_retreat
        if end is None:
            return "the front is pinned: at eta = 2/25 static fronts always exist."
        if self.c > end and moving:
            return f"the excited state retreats (v < 0): c is above c_retreat = {end:.6g}."
        if self.c > end and not self.branches:
            return self._reason_beside("c_retreat", end)
        if self.c > end:
            return (
                f"c is above c_retreat = {end:.6g}, where no static front exists, but no "
                "travelling wave is admissible: simulate it."
            )
        if moving:
            return (
                "a moving front keeps retreating (v < 0), a resting one stays: c is below "
                f"c_retreat = {end:.6g}."
            )
        return (
            "the front is pinned: for eta > 2/25 no front advances, and it retreats only above "
            f"c_retreat = {end:.6g}."
        )

    def _reason_beside(self, name: str, end: float) -> str:
        """Return the reason just above the end of fronts at rest, where (54) has a solution.

        Between v = 0 and large v, |Σ| or |2 + Σ| passes 2r. If no solution was found, it lies below
        v = 0.018, where none is searched for (``theory.piecewise.first_points``).
        """
        return (
            f"c is above {name} = {end:.6g}, but so close to it that the front is slower than "
            "|v| = 0.018, where solutions are not searched for: take a larger c."
        )

    @property
    def c_pin(self) -> float | None:
        """Coupling up to which static fronts exist; None for η ≥ 2/25."""
        return pinning_coupling(self.eta) if self.eta < ETA_END else None

    @property
    def c_retreat(self) -> float | None:
        """Coupling above which the excited state retreats; None for η ≤ 2/25."""
        return retreat_coupling(self.eta) if self.eta < ETA_END else None

    @property
    def c_fold(self) -> float | None:
        """Coupling from which moving fronts exist; None for η ≥ 2/25.

        Computed on first access, since it takes longer than the velocities.
        """
        fold = self._fold
        return None if fold is None else fold.value

    @property
    def c_pin_error(self) -> float | None:
        """Bound on the error of ``c_pin``, including the rounding of η; large near η = 2/25."""
        return None if self.c_pin is None else pinning_error(self.eta)

    @property
    def c_retreat_error(self) -> float | None:
        """Bound on the error of ``c_retreat``, including the rounding of η."""
        return None if self.c_retreat is None else pinning_error(self.eta)

    @property
    def c_fold_error(self) -> float | None:
        """Bound on the error of ``c_fold``."""
        fold = self._fold
        if fold is None:
            return None
        return self.c_pin_error if fold.velocity == 0.0 else fold.error

    @property
    def _fold(self) -> KineticFold | None:
        return _folds(self.etas)[self.eta] if self.eta < ETA_END else None

    @property
    def c_stable(self) -> float | None:
        """Coupling up to which, as c grows, the fastest admissible front is stable; or None.

        Computed on first access, within a few seconds (`theory.piecewise.stability_limit`).
        """
        return self._stability_limit.c

    @property
    def c_stable_error(self) -> float | None:
        """Bound on the error of ``c_stable``."""
        return self._stability_limit.error

    @property
    def c_stable_reason(self) -> str | None:
        """Why there is no ``c_stable``."""
        return self._stability_limit.reason

    @property
    def _stability_limit(self) -> StabilityLimit:
        if self.eta < ETA_END:
            return stability_limit(self.eta)
        return StabilityLimit(reason=f"no front advances at eta = {self.eta:.12g}")

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON, with ``c_stable`` where it was requested."""
        found = super().to_dict()
        if self.limit_shown:
            names = ("c_stable", "c_stable_error", "c_stable_reason")
            found |= {name: getattr(self, name) for name in names}
        return found

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per branch, or one row without velocity if there is none.

        See `Result.columns`.
        """
        rows: tuple[KineticBranch | None, ...] = self.branches or (None,)
        kinds = dict.fromkeys(("slope", "admissible", "stable"), object)
        listed = {
            each.name: np.array([getattr(row, each.name, None) for row in rows],
                                kinds.get(each.name, float))
            for each in fields(KineticBranch)
        }  # fmt: skip
        names = ["c_pin", "c_fold", "c_retreat", *(["c_stable"] if self.limit_shown else [])]
        limits = {
            each: np.full(len(rows), getattr(self, each), float)
            for name in names
            for each in (name, f"{name}_error")
        }
        return {
            "c": np.full(len(rows), self.c),
            "eta": np.full(len(rows), self.eta),
            "status": np.array([self.status.value] * len(rows)),
            **listed,
            **limits,
        }


@with_ranges(couplings=COUPLINGS)
def kinetic_relation(c: float, eta: float) -> KineticRelation:
    """Return every front velocity at coupling c and η = b/a², and the thresholds (Eq. 54).

    For each velocity, the result says whether the front is admissible (47) and whether it is
    stable.

    Parameters
    ----------
    c : float
        Coupling, dimensionless, {couplings}.
    eta : float
        η = b/a², dimensionless, positive. For η ≥ 1/8 the result says that there is no front.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> answer = kinetic_relation(0.5, 0.03125)
    >>> [(round(branch.v, 9), branch.admissible) for branch in answer.branches]
    [(0.300992351, True)]
    >>> kinetic_relation(0.2, 0.03125).reason
    'the front is pinned: steady motion begins at c_fold = 0.433776 (static fronts end at c_pin = \
0.455301).'
    """
    (answer,) = trace_kinetic_relation([c], [eta])
    return replace(answer, branches=tuple(with_stability(b, c) for b in answer.branches))


def with_stability(branch: KineticBranch, c: float) -> KineticBranch:
    """Return a branch at coupling c with its linear stability, if it is admissible."""
    if not branch.admissible:
        return branch
    found = front_stability(branch.v, c, branch.error)
    return replace(
        branch,
        stable=found.stable,
        multiplier=found.multiplier,
        multiplier_error=found.error,
    )


def trace_kinetic_relation(
    c: npt.ArrayLike,
    eta: npt.ArrayLike,
    admissibility: bool = True,
    progress: Callable[[float], None] | None = None,
) -> list[KineticRelation]:
    """Return :func:`kinetic_relation` for arrays of c and η, broadcast together, all at once.

    Parameters
    ----------
    c, eta : array_like of float
        Couplings and η.
    admissibility : bool
        Check assumption (47) on every branch.
    progress : callable, optional
        Called from time to time with the fraction done.

    Returns
    -------
    list of KineticRelation
        In the order of the broadcast arrays, flattened. ``terms`` and ``seconds`` are totals
        divided by the number of cases.

    Raises
    ------
    ParameterError
        If any parameter is out of range.
    """
    start = perf_counter()
    c_, eta_ = (
        array.ravel() for array in np.broadcast_arrays(np.asarray(c, float), np.asarray(eta, float))
    )
    for extreme in (c_.min(), c_.max()) if c_.size else ():
        checked_coupling(extreme)
    etas = sorted(checked_eta(value) for value in set(eta_.tolist()))
    bistable = tuple(value for value in etas if value < ETA_END)
    ends = {value: _end_of_rest(value) for value in bistable}
    branches, terms = _branches_of_cases(c_, eta_, admissibility, progress)
    if progress is not None:
        progress(1.0)
    seconds = (perf_counter() - start) / max(1, c_.size)
    answers = []
    for c_here, eta_here, list_ in zip(c_.tolist(), eta_.tolist(), branches, strict=True):
        ascending = tuple(sorted(list_, key=lambda branch: branch.v))
        answers.append(
            KineticRelation(
                c=c_here,
                eta=eta_here,
                status=_status(c_here, ends.get(eta_here), ascending),
                branches=ascending,
                method="integral",
                terms=math.ceil(terms / c_.size),
                seconds=seconds,
                etas=bistable,
            )
        )
    return answers


def _branches_of_cases(
    c: FloatArray,
    eta: FloatArray,
    admissibility: bool,
    progress: Callable[[float], None] | None,
) -> tuple[list[list[KineticBranch]], int]:
    """Return the branches of every pair of c and η, and the number of values of Σ computed."""
    branches: list[list[KineticBranch]] = [[] for _ in c]
    terms = 0
    blocks = [
        (retreating, cases[begin : begin + _BLOCK])
        for retreating in (True, False)
        for cases in [np.flatnonzero(_can_move(eta, retreating))]
        for begin in range(0, cases.size, _BLOCK)
    ]
    for done, (retreating, cases) in enumerate(blocks):
        if progress is not None:
            progress(done / len(blocks))
        etas = eta[cases].tolist()
        ratio = {value: threshold_ratio(value) for value in set(etas)}
        r = np.array([ratio[value] for value in etas])
        found = all_velocities(c[cases], 2.0 * r, retreating)
        terms += found.evaluations
        case_of_solution = cases[found.case]
        solutions = _branches(
            found, c[case_of_solution], eta[case_of_solution], r[found.case], retreating,
            admissibility=admissibility,
        )  # fmt: skip
        for case, branch in zip(case_of_solution.tolist(), solutions, strict=True):
            branches[case].append(branch)
    return branches, terms


def checked_coupling(c: float) -> float:
    """Return the coupling after checking that it is in the range of the method.

    Raises
    ------
    ParameterError
        If it does not.
    """
    remedy = "give a coupling between these"
    return within("coupling c", c, *COUPLINGS, remedy)


def _can_move(eta: FloatArray, retreating: bool) -> BoolArray:
    if retreating:
        return (eta > ETA_PIN_END) & (eta < ETA_END)
    return eta < ETA_END


def _branches(
    found: Solutions, c: FloatArray, eta: FloatArray, r: FloatArray, retreating: bool, *,
    admissibility: bool,
) -> list[KineticBranch]:  # fmt: skip
    """Return the branch of each solution, given its coupling, η and threshold."""
    direction = -1.0 if retreating else 1.0
    v = direction * found.v
    verdicts = check_fronts(v, c, r) if admissibility else [None] * v.size
    columns = (
        v, found.error, found.slope, found.by_coupling, found.error_along_coupling,
        found.error_along_target, eta,
    )  # fmt: skip
    branches = []
    for row, verdict in zip(
        zip(*(column.tolist() for column in columns), strict=True), verdicts, strict=True
    ):
        v_, error, slope, by_coupling, along_coupling, along_target, eta_ = row
        inverse = direction / slope if slope else math.inf
        by_eta = 2.0 * threshold_ratio_slope(eta_)
        branches.append(
            KineticBranch(
                v=v_,
                error=error,
                slope=(slope > 0.0) - (slope < 0.0),
                by_c=-inverse * by_coupling,
                by_eta=inverse * by_eta,
                by_c_error=along_coupling,
                by_eta_error=by_eta * (along_target + 1e-15 * abs(inverse)),
                admissible=verdict.admissible if verdict else None,
                fails_at=verdict.fails_at if verdict else None,
            )
        )
    return branches
