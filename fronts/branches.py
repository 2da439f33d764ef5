"""Continuation of branches through their folds: fronts of (43) in c or η, and breathers in c.

The module contains `fronts.follow_front` and `fronts.follow_breather`, which the command line uses
for ``--c low:high:n`` and ``--eta low:high:n`` where the method permits continuation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fronts.curves import Curve
from theory.arrays import FloatArray
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import (
    ParameterError,
    ascending,
    count_within,
    need_instance,
    with_ranges,
    word,
)
from verification.continuation.branch import BranchFold
from verification.fronts.resting import ETAS
from verification.fronts.wave import COUPLINGS, SLOWEST

if TYPE_CHECKING:
    from verification.fronts.result import Front


@with_ranges(eta=ETAS)
@dataclass(frozen=True, kw_only=True)
class FollowedBranch(Curve):
    """Solutions in order along a branch, at each required value of the parameter.

    Attributes
    ----------
    along, values, points, seconds
        As in `fronts.curves.Curve`; a value is repeated for each solution at it.
    folds : tuple of BranchFold
        The folds of the branch.
    c_pin, c_pin_error : float or None
        For fronts along c: coupling of the fold of fronts at rest, up to which fronts are pinned,
        and its error.
    eta_pin, eta_pin_error : float or None
        For fronts along η: η of the fold of fronts at rest, from which on fronts are pinned, and
        its error; None if it is not {eta}.
    square_root, square_root_error : float or None
        For fronts: the limit of v/√(c - c_pin), or of v/√(η_pin - η), and its error.
    kappa, kappa_error : float or None
        For fronts along c: κ in v = c + κ(c/6)^{1/3} + O(c^{-1/3}) at strong coupling, and its
        error.
    """

    folds: tuple[BranchFold, ...] = ()
    c_pin: float | None = None
    c_pin_error: float | None = None
    eta_pin: float | None = None
    eta_pin_error: float | None = None
    square_root: float | None = None
    square_root_error: float | None = None
    kappa: float | None = None
    kappa_error: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the points, the folds and, for fronts, the ends of the branch."""
        found = super().to_dict() | {"folds": [fold.to_dict() for fold in self.folds]}
        curve = {each.name for each in fields(Curve)} | {"folds"}
        own = [each.name for each in fields(self) if each.name not in curve]
        ends = {name: getattr(self, name) for name in own}
        return found | {name: value for name, value in ends.items() if value is not None}


@with_ranges(c=COUPLINGS, eta=ETAS, slowest=SLOWEST)
def follow_front(
    chain: AveragedChain,
    couplings: Sequence[float] | FloatArray | None = None,
    *,
    etas: Sequence[float] | FloatArray | None = None,
) -> FollowedBranch:
    """Continue the front of (43), as a travelling wave, in c or in η.

    Parameters
    ----------
    chain : AveragedChain
        The chain. Of a, b and c, those that vary are not used, and neither is N.
    couplings : array_like of float, shape (n,), optional
        Couplings at which the front is computed, dimensionless, {c}.
    etas : array_like of float, shape (n,), optional
        Values of η = b/a², {eta}, in place of couplings; a is that of the chain.

    Returns
    -------
    FollowedBranch
        The points are `Front` objects in descending order of the parameter, with the velocity v,
        its error and, in ``detail``, the multipliers; v = 0 where the front is pinned.

    Raises
    ------
    ParameterError
        If a coupling or an η is out of range, or if both are given.
    RunError
        If a front is slower than {slowest}, which happens within about 1e-5 of pinning.

    References
    ----------
    Keller (1977), for pseudo-arclength continuation.

    Examples
    --------
    >>> import fronts as fr
    >>> branch = fr.follow_front(fr.AveragedChain(a=4, b=0.5, c=0), [0.1, 0.3, 0.6])
    >>> [round(point.v, 9) for point in branch.points], branch.folds
    ([0.722566456, 0.344982869, 0.0], ())
    >>> round(branch.c_pin, 9)
    0.101944386
    >>> branch = fr.follow_front(fr.AveragedChain(a=4, b=0.5, c=0.15), etas=[0.03125, 0.08])
    >>> [round(point.v, 9) for point in branch.points], round(branch.eta_pin, 9)
    ([0.0, 0.123055986], 0.059829802)
    """
    need_instance("chain", chain, (AveragedChain,), "take chain.averaged() where there is one")
    if etas is None:
        return _fronts(chain, "c", ascending("coupling c", couplings))
    if couplings is not None:
        remedy = "follow one parameter at a time"
        raise ParameterError("couplings", couplings, "absent when etas are given", remedy)
    return _fronts(chain, "eta", ascending("eta = b/a^2", etas))


def _fronts(
    chain: AveragedChain, along: Literal["c", "eta"], values: Sequence[float]
) -> FollowedBranch:
    """Return the fronts at ascending values of c or η."""
    from verification.fronts.follow import follow_front_wave
    from verification.fronts.measure import front_of_wave
    from verification.fronts.resting import static_fold

    def at(value: float) -> AveragedChain:
        return chain.replace(c=value) if along == "c" else chain.replace(b=value * chain.a**2)

    begin = perf_counter()
    ends, pinned = (_ends_in_c if along == "c" else _ends_in_eta)(chain, values)
    moving = [value for value in values if value not in pinned]
    # In descending order: fronts are pinned at small c, and at large η.
    before = 0 if along == "c" else len(pinned)
    folds: list[BranchFold] = []
    fronts: list[tuple[float, Front]] = []
    if moving:
        found = follow_front_wave(moving, chain.eta if along == "c" else chain.c, along)
        followed = [(getattr(wave, along), wave) for wave in found.fronts]
        fronts = [(value, front_of_wave(at(value), wave)) for value, wave in followed]
        for fold, index in found.folds:
            there = at(float(fold.parameter))
            folds.append(
                BranchFold(
                    c=there.c,
                    eta=there.eta,
                    error=float(fold.error),
                    points_before=before + index,
                    height=float(fold.u[-1]),
                )
            )
    resting = [
        (value, front_of_wave(at(value), static_fold(at(value).eta))) for value in reversed(pinned)
    ]
    rows = [*resting, *fronts] if before else [*fronts, *resting]
    return FollowedBranch(
        along=along,
        values=np.array([value for value, _ in rows]),
        points=tuple(front for _, front in rows),
        seconds=perf_counter() - begin,
        folds=tuple(folds),
        **ends,
    )


def _ends_in_c(
    chain: AveragedChain, couplings: Sequence[float]
) -> tuple[dict[str, float], list[float]]:
    """Return the two ends of a branch in c, and the couplings at which fronts are pinned."""
    from theory.averaged.front import strong_coupling_front
    from verification.fronts.resting import static_fold

    rest, strong = static_fold(chain.eta), strong_coupling_front(chain.eta)
    ends = {
        "c_pin": rest.c,
        "c_pin_error": rest.error,
        "square_root": rest.square_root,
        "square_root_error": rest.square_root_error,
        "kappa": strong.kappa,
        "kappa_error": strong.error,
    }
    return ends, [c for c in couplings if c <= rest.c + rest.error]


def _ends_in_eta(
    chain: AveragedChain, etas: Sequence[float]
) -> tuple[dict[str, float], list[float]]:
    """Return the end of a branch in η, and the η at which fronts are pinned."""
    from verification.fronts.resting import pinning_eta, static_fold

    pin = pinning_eta(chain.c)
    if pin is None:  # as c_pin rises with η, either all fronts are pinned or all travel
        return {}, list(etas) if chain.c <= static_fold(etas[0]).c else []
    ends = {
        "eta_pin": pin.eta,
        "eta_pin_error": pin.error,
        "square_root": pin.square_root,
        "square_root_error": pin.square_root_error,
    }
    return ends, [eta for eta in etas if eta >= pin.eta - pin.error]


def follow_breather(
    chain: VanDerPolChain,
    couplings: Sequence[float] | FloatArray,
    *,
    nucleus: Nucleus = Nucleus(1),  # noqa: B008  (frozen)
    method: Literal["orbit", "envelope"] | None = None,
    folds: int = 1,
) -> FollowedBranch:
    """Continue a breather in the coupling, through its folds.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        The chain, of which a, b, ε, N and the ends are used, but not c.
    couplings : array_like of float, shape (n,)
        Couplings at which the breather is computed, dimensionless, positive.
    nucleus : Nucleus, optional
        The sites that oscillate, and their phase steps.
    method : {"orbit", "envelope"}, optional
        The periodic orbit of (8), or the rotating solution of (43); by default the one that solves
        the equation of the given chain.
    folds : int, optional
        Largest number of folds that are passed. The branch begins at or just above the smallest
        coupling, and ends where it returns to this coupling, or at c = 2.

    Returns
    -------
    FollowedBranch
        The points are `Breather` objects with multipliers. Each coupling occurs once on every
        sheet of the branch; couplings without a solution come last. The chain of solutions of (43)
        is ``chain.averaged()``.

    Raises
    ------
    ParameterError
        If a coupling is out of range, the cell has no cycle, or the nucleus does not fit.

    References
    ----------
    Marín and Aubry (1996), for continuation of breathers; Keller (1977), for pseudo-arclength.

    Examples
    --------
    >>> import fronts as fr
    >>> chain = fr.VdpChain(a=2.5, b=0.5, c=0, sites=11)
    >>> branch = fr.follow_breather(chain, [0.15, 0.19], method="envelope")
    >>> [round(float(c), 3) for c in branch.values], round(branch.folds[0].c, 6)
    ([0.15, 0.19, 0.19, 0.15], 0.190788)
    """
    from verification.breathers.families import own_method
    from verification.breathers.follow import follow

    begin = perf_counter()
    need_instance("chain", chain, (VdpChain, AveragedChain), "other models cannot be followed")
    need_instance("nucleus", nucleus, (Nucleus,), "give one, as Nucleus(3)")
    default = own_method(chain).value
    chosen = word("method", default if method is None else method, ("orbit", "envelope"))
    if chosen == "envelope":
        chain = chain.averaged()
    elif not isinstance(chain, VdpChain):
        raise ParameterError(
            "method", "orbit", "envelope for the averaged chain", "take it, or chain.full()"
        )
    folds = count_within("number of folds", folds, 0, 20)
    found = follow(chain, couplings, nucleus=nucleus, folds=folds)
    return FollowedBranch(
        along="c",
        values=np.array([point.chain.c for point in found.points]),
        points=found.points,
        seconds=perf_counter() - begin,
        folds=found.folds,
    )


def front_branch(
    chains: Sequence[Any], along: str, values: Sequence[float], **options: Any
) -> FollowedBranch | None:
    """Return the branch of waves of (43) in c or η; None for other methods or parameters."""
    if options.get("method") != "wave":
        return None
    if along == "eta":
        return follow_front(chains[0], etas=values)
    return follow_front(chains[0], values) if along == "c" else None


def breather_branch(
    chains: Sequence[Any],
    along: str,
    values: Sequence[float],
    *,
    nucleus: Nucleus,
    **options: Any,
) -> FollowedBranch | None:
    """Return the branch of breathers of the given chain in c; None for another method."""
    from verification.breathers.families import own_method

    if along != "c" or options.get("method") not in (None, own_method(chains[0]).value):
        return None
    return follow_breather(chains[0], values, nucleus=nucleus)


__all__ = ["BranchFold", "FollowedBranch", "follow_breather", "follow_front"]
