"""Branches of solutions in the coupling, through their folds: fronts of (43), and breathers.

`fronts.follow_front` and `fronts.follow_breather`, and what the shell makes of ``--c low:high:n``
where the method is one that can be followed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from fronts.curves import Curve
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import ParameterError, ascending, count_within, need_instance
from theory.result import Result

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Turn(Result):
    """Where a branch turns back in c.

    Attributes
    ----------
    c, error : float
        Coupling of the fold, and a bound on its error.
    place : int
        Points of the branch before it.
    height : float
        Of breathers the amplitude at the centre; of fronts the velocity.
    """

    c: float
    error: float
    place: int
    height: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch(Curve):
    """Solutions in order along a branch: at each coupling that was asked for, folds passed or not.

    Attributes
    ----------
    along, values, points, seconds
        As of `fronts.curves.Curve`; a coupling stands here once for each solution there.
    folds : tuple of Turn
        Where the branch turns back.
    c_pin, c_pin_error : float or None
        Of fronts: up to this fold of fronts at rest they are pinned, and its error.
    square_root : float or None
        Of fronts: the limit of v/√(c - c_pin).
    kappa : float or None
        Of fronts: v = c + κ(c/6)^{1/3} + O(c^{-1/3}) at strong coupling.
    """

    folds: tuple[Turn, ...] = ()
    c_pin: float | None = None
    c_pin_error: float | None = None
    square_root: float | None = None
    kappa: float | None = None

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row a point; of breathers also the amplitude at the ``centre``."""
        outward = [getattr(point, "outward", np.empty(0)) for point in self.points]
        if not any(each.size for each in outward):
            return super().columns()
        centre = np.array([each[0] if each.size else np.nan for each in outward])
        return super().columns() | {"centre": centre}

    def to_dict(self) -> dict[str, Any]:
        """Return the points, the folds, and of fronts the two ends of the branch."""
        found = super().to_dict() | {"folds": [fold.to_dict() for fold in self.folds]}
        names = ("c_pin", "c_pin_error", "square_root", "kappa")
        ends = {name: getattr(self, name) for name in names}
        return found | {name: value for name, value in ends.items() if value is not None}


def follow_front(chain: AveragedChain, couplings: Sequence[float] | FloatArray) -> Branch:
    """Follow the front of (43) as a travelling wave through a range of couplings.

    Parameters
    ----------
    chain : AveragedChain
        a and b; its c and N are not used.
    couplings : array_like of float, shape (n,)
        Where the front is computed, dimensionless, from 1e-6 to 1e3.

    Returns
    -------
    Branch
        Points are `Front`, from the largest coupling down, with v, its error, and in ``detail`` the
        multipliers; v = 0 where the front is pinned.

    Raises
    ------
    ParameterError
        If a coupling, or η, is out of range.
    RunError
        If a front is slower than 1e-3: within some 1e-5 of c_pin.

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
    """
    from theory.averaged.front import strong_coupling_front
    from verification.fronts.follow import follow_front_wave
    from verification.fronts.measure import wave_front
    from verification.fronts.resting import static_fold

    begin = perf_counter()
    need_instance("chain", chain, (AveragedChain,), "take chain.averaged() where there is one")
    chains = [chain.replace(c=c) for c in ascending("coupling c", couplings)]
    rest = static_fold(chain.eta)
    pinned = [wave_front(each) for each in chains if each.c <= rest.c]
    moving = [each.c for each in chains if each.c > rest.c]
    folds: list[Turn] = []
    waves: list[Result] = []
    if moving:
        found = follow_front_wave(moving, chain.eta)
        waves = [wave_front(chain.replace(c=wave.c), wave) for wave in found.fronts]
        folds = [
            Turn(c=float(fold.c), error=float(fold.error), place=place, height=float(fold.u[-1]))
            for fold, place in found.folds
        ]
    points = [*waves, *reversed(pinned)]
    return Branch(
        along="c",
        values=np.array([point.to_dict()["chain"]["c"] for point in points]),
        points=tuple(points),
        seconds=perf_counter() - begin,
        folds=tuple(folds),
        c_pin=rest.c,
        c_pin_error=rest.error,
        square_root=rest.square_root,
        kappa=strong_coupling_front(chain.eta).kappa,
    )


def follow_breather(
    chain: VanDerPolChain,
    couplings: Sequence[float] | FloatArray,
    *,
    nucleus: Nucleus = Nucleus(1),  # noqa: B008  (frozen)
    method: Literal["orbit", "envelope"] = "orbit",
    folds: int = 1,
) -> Branch:
    """Follow a breather in the coupling through its folds.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        a, b, ε, N and ends; its c is not used.
    couplings : array_like of float, shape (n,)
        Where the breather is computed, dimensionless, positive.
    nucleus : Nucleus, optional
        Which sites oscillate, and with which phase steps.
    method : {"orbit", "envelope"}, optional
        The periodic orbit of (8), or the rotating solution of (43).
    folds : int, optional
        Folds that are passed, at most. The branch begins at the smallest coupling or just above,
        and ends where it comes back to it, or at c = 2.

    Returns
    -------
    Branch
        Points are `Breather`, with multipliers: each coupling once on every sheet of the branch,
        and at the end those where there is none. Solutions of (43) have the chain ``averaged()``.

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
    from verification.breathers.follow import follow
    from verification.breathers.result import BreatherMethod

    begin = perf_counter()
    need_instance("chain", chain, (VdpChain, AveragedChain), "other models cannot be followed")
    need_instance("nucleus", nucleus, (Nucleus,), "give one, as Nucleus(3)")
    if method == "envelope" and isinstance(chain, VdpChain):
        chain = chain.averaged()
    elif method not in ("orbit", "envelope"):
        raise ParameterError("method", method, "orbit or envelope", "name one of them")
    count_within("number of folds", folds, 0, 20)
    found = follow(chain, couplings, nucleus=nucleus, method=BreatherMethod(method), turns=folds)
    return Branch(
        along="c",
        values=np.array([point.chain.c for point in found.points]),
        points=found.points,
        seconds=perf_counter() - begin,
        folds=tuple(
            Turn(
                c=float(fold.c),
                error=float(fold.error),
                place=place,
                height=float(there.outward[0]),
            )
            for fold, there, place in found.folds
        ),
    )


def front_branch(
    chains: Sequence[Any], along: str, values: Sequence[float], **options: Any
) -> Branch | None:
    """Return the branch of waves of (43) in c; None for runs, or along another parameter."""
    if along != "c" or options.get("method") != "wave":
        return None
    return follow_front(chains[0], values)


def breather_branch(
    chains: Sequence[Any], along: str, values: Sequence[float], **options: Any
) -> Branch | None:
    """Return the branch of solutions of the chain itself in c; None for another method."""
    averaged = isinstance(chains[0], AveragedChain)
    method: Literal["orbit", "envelope"] = "envelope" if averaged else "orbit"
    if along != "c" or options.get("method", "envelope") != method:
        return None
    nucleus = options.get("nucleus", Nucleus(1))
    return follow_breather(chains[0], values, nucleus=nucleus, method=method)


__all__ = ["Branch", "Turn", "follow_breather", "follow_front"]
