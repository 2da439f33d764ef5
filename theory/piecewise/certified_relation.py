"""The kinetic relation (54) with proofs: each velocity enclosed, their number, the thresholds.

For c and η as binary numbers, it is proven that each velocity lies in its interval and is the only
one there, that there are no other velocities, and that c_pin, c_fold and c_retreat lie in their
intervals. Admissibility and stability are not proven.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any

from theory.cells.vdp import ETA_END
from theory.piecewise.certified_roots import ball_arithmetic
from theory.piecewise.certified_thresholds import ball_ratio, enclose_fold, enclose_static_end
from theory.piecewise.certified_velocities import (
    BITS,
    Enclosure,
    Relation,
    WorkLimitError,
    enclose_near,
    prove_velocities,
)
from theory.piecewise.kinetic_relation import KineticRelation
from theory.piecewise.limits import ETA_PIN_END


@dataclass(frozen=True, kw_only=True)
class CertifiedRelation(KineticRelation):
    """The answer at one (c, η), with those parts of it that are proven in ball arithmetic.

    Attributes
    ----------
    certified : bool
        Whether the velocities, their number and the thresholds are all proven.
    v_enclosures : tuple of Enclosure
        Intervals that contain exactly one velocity each, ascending; unless ``unproven`` says
        otherwise, there is no further velocity.
    c_pin_enclosure, c_fold_enclosure, c_retreat_enclosure : Enclosure or None
        Intervals that contain the thresholds; None where there is no such threshold, or no proof.
    unproven : tuple of str
        One sentence for each part that could not be proven.
    """

    certified: bool
    v_enclosures: tuple[Enclosure, ...]
    c_pin_enclosure: Enclosure | None
    c_fold_enclosure: Enclosure | None
    c_retreat_enclosure: Enclosure | None
    unproven: tuple[str, ...] = field(default=())


def certify_relation(
    answer: KineticRelation, progress: Callable[[float], None] | None = None
) -> CertifiedRelation:
    """Prove the velocities and thresholds of an answer, as far as possible.

    Parameters
    ----------
    answer : KineticRelation
        The answer computed in double precision.
    progress : callable, optional
        Called from time to time with the fraction done.

    Raises
    ------
    MissingPackageError
        If python-flint is not installed.

    Examples
    --------
    >>> from theory.piecewise.kinetic_relation import kinetic_relation
    >>> proven = certify_relation(kinetic_relation(0.45, 0.03125))
    >>> proven.certified, len(proven.v_enclosures)
    (True, 2)
    >>> abs(proven.branches[1].v - proven.v_enclosures[1].lower) <= proven.branches[1].error
    True
    """
    flint = ball_arithmetic("a certified kinetic relation")
    unproven: list[str] = []
    ends: dict[str, Enclosure | None] = dict.fromkeys(("c_pin", "c_fold", "c_retreat"))
    velocities: list[Enclosure] = []
    with flint.ctx.workprec(BITS):
        if answer.eta < ETA_END:
            velocities = _velocities(flint, answer, unproven, progress)
            ends |= _thresholds(flint, answer, unproven)
    known = {each.name: getattr(answer, each.name) for each in fields(KineticRelation)}
    return CertifiedRelation(
        **known,
        certified=not unproven,
        v_enclosures=tuple(velocities),
        c_pin_enclosure=ends["c_pin"],
        c_fold_enclosure=ends["c_fold"],
        c_retreat_enclosure=ends["c_retreat"],
        unproven=tuple(unproven),
    )


def _velocities(
    flint: Any,
    answer: KineticRelation,
    unproven: list[str],
    progress: Callable[[float], None] | None,
) -> list[Enclosure]:
    """Return the enclosures of all velocities, ascending; add failures to ``unproven``."""
    retreating = answer.eta > ETA_PIN_END
    c, target = flint.arb(answer.c), 2 * ball_ratio(flint, answer.eta)
    relation = Relation(flint, c, target, 2 if retreating else 0)
    try:
        found, undecided = prove_velocities(relation, progress)
        other = prove_velocities(Relation(flint, c, target, 0 if retreating else 2))
        if any(other):
            way = "forwards" if retreating else "backwards"
            unproven.append(f"that no front travels {way} is not proven.")
    except WorkLimitError as limit:
        unproven.append(
            f"the number of velocities is not proven, for resonances or a fold: {limit}."
        )
        found, undecided = _one_by_one(relation, answer, unproven), []
    else:
        for low, high in undecided:
            unproven.append(
                f"the number of velocities is not proven between |v| = {low:.12g} and "
                f"{high:.12g}, where two of them meet in a fold or |Sigma| nearly does not vary."
            )
        _compare(answer, found, bool(undecided), unproven)
    if retreating:
        found = [each.mirrored() for each in found]
    return sorted(found, key=lambda each: each.lower)


def _one_by_one(
    relation: Relation, answer: KineticRelation, unproven: list[str]
) -> list[Enclosure]:
    """Return enclosures of the velocities that the search found, without proof of their number."""
    relation.max_work *= 2
    found = []
    for branch in answer.branches:
        try:
            enclosure = enclose_near(relation, abs(branch.v), branch.error)
        except WorkLimitError:
            enclosure = None
        if enclosure is None:
            unproven.append(f"that v = {branch.v:.12g} solves (54) is not proven.")
        else:
            found.append(enclosure)
    return found


def _compare(
    answer: KineticRelation, found: list[Enclosure], open_: bool, unproven: list[str]
) -> None:
    """Add to ``unproven`` where the computed velocities differ from the proven ones."""
    speeds = sorted((abs(branch.v), branch.error) for branch in answer.branches)
    proven = sorted(found, key=lambda each: each.lower)
    if len(speeds) != len(proven):
        if not open_:
            unproven.append(
                f"{len(proven)} velocities are proven, and {len(speeds)} were computed: the table "
                "of branches is not complete; take the enclosures."
            )
        return
    for (v, error), each in zip(speeds, proven, strict=True):
        if v + error < each.lower or v - error > each.upper:
            unproven.append(
                f"the velocity {v:.15g} is farther than its error from the proven one, which lies "
                f"between {each.lower:.17g} and {each.upper:.17g}."
            )


def _thresholds(
    flint: Any, answer: KineticRelation, unproven: list[str]
) -> dict[str, Enclosure | None]:
    """Return the enclosures of the thresholds that exist; add failures to ``unproven``."""
    found: dict[str, Enclosure | None] = {}
    end = enclose_static_end(flint, answer.eta)
    if answer.c_retreat is not None:
        found["c_retreat"] = end
    if answer.c_pin is None or end is None:
        return found
    found["c_pin"] = end
    try:
        fold = enclose_fold(flint, answer.eta, end)
        reason = "some velocity near the fold could not be excluded at smaller couplings"
    except WorkLimitError as limit:
        fold, reason = None, str(limit)
    if fold is None:
        unproven.append(f"c_fold = {answer.c_fold:.12g} is not proven: {reason}.")
    found["c_fold"] = fold
    return found
