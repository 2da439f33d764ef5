"""Initial states: which sites are excited, with what displacement, phase and perturbation.

A start is a state (y, w) of every site, shape (2, N). Excited sites of a smooth chain are displaced
by the amplitude of its excited state. Those of the friction chain start, as in the paper, "close to
the stick-slip limit cycle" of one cell with ẏ = 0; the cycle has two such points. Where the cell
has no stick-slip cycle, beyond the end of its range, the paper does not specify the start; here the
point of the cycle at that end is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, singledispatch

import numpy as np

from theory.arrays import FloatArray
from theory.cells.friction import FrictionCell
from theory.chains.chain import Chain, SmoothChain
from theory.chains.friction import FrictionChain
from theory.parameters import (
    ParameterError,
    Range,
    count_within,
    need_instance,
    with_ranges,
    within,
)
from theory.status import Status
from verification.runs.integration import as_psi

__all__ = ["StartPoint", "add_noise", "as_psi", "cycle_point", "excite", "excite_edge"]


DISPLACEMENTS = Range(-1e3, 1e3)


class StartPoint(Status):
    """The point on the stick-slip cycle of one cell at which excited sites start, with ẏ = 0."""

    MAXIMUM = "maximum", "Excited sites start at the largest y of the cycle."
    MINIMUM = "minimum", "Excited sites start at the smallest y of the cycle."


@with_ranges(displacement=DISPLACEMENTS)
def excite(
    chain: Chain,
    sites: Sequence[int],
    displacement: float | None = None,
    *,
    quarter_turns: Sequence[int] | None = None,
    point: StartPoint = StartPoint.MAXIMUM,
) -> FloatArray:
    """Return a start with some sites excited and the others at rest.

    Parameters
    ----------
    chain : Chain
        The chain: its number of sites, its rest state, and its excited state for the default.
    sites : sequence of int
        Excited sites, from 1 to N.
    displacement : float, optional
        For a smooth chain √(y² + w²), for the friction chain y itself; by default that of the
        excited state of one cell. Dimensionless, {displacement}.
    quarter_turns : sequence of int, optional
        Phase of each excited site of a smooth chain, in quarter turns; by default 0 for all, that
        is, w = 0.
    point : StartPoint, optional
        Point on the cycle of the friction chain.

    Returns
    -------
    ndarray, shape (2, N)
        (y, w) of every site, dimensionless.

    Raises
    ------
    ParameterError
        If a site is not in the chain, or the cell has no cycle from which to take the displacement.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> excite(VdpChain(a=4, b=0.5, c=0.6, sites=3), [2], 6.0).tolist()
    [[0.0, 6.0, 0.0], [0.0, 0.0, 0.0]]
    >>> excite(FrictionChain(c=0.02, sites=3), [2], 2.0)[0].round(6).tolist()
    [0.541042, 2.0, 0.541042]
    """
    need_instance("chain", chain, (Chain,), "give one, as VdpChain(a=4, b=0.5, c=0.6)")
    count: int = getattr(chain, "sites", 0)
    if not count:
        raise ParameterError(
            "model", chain.model, "a chain of finite length", "measure a front instead"
        )
    if not np.ndim(sites):
        raise ParameterError(
            "excited sites", sites, "a sequence of sites", "write a site in brackets, as [1]"
        )
    if not len(sites):
        raise ParameterError("excited sites", "none", "at least one", "name a site from 1 to n")
    remedy = "name a site of the chain"
    places = [count_within("excited site", site, 1, count, remedy) - 1 for site in sites]
    if displacement is not None:
        displacement = within("displacement", displacement, *DISPLACEMENTS)
    turns = [0] * len(sites) if quarter_turns is None else quarter_turns
    if not np.ndim(turns) or len(turns) != len(sites):
        raise ParameterError("quarter turns", turns, "one for each excited site", "give as many")
    turns = [count_within("quarter turns", each, -(10**9), 10**9) for each in turns]
    start = np.empty((2, count))
    start[:] = np.array(chain.rest_state)[:, None]
    for place, turn in zip(places, turns, strict=True):
        start[:, place] = _excited(chain, displacement, turn, StartPoint(point))
    return start


@singledispatch
def _excited(
    chain: Chain, displacement: float | None, turn: int, point: StartPoint
) -> tuple[float, float]:
    raise ParameterError("model", chain.model, "one with excited states", "take another chain")


@_excited.register
def _(
    chain: SmoothChain, displacement: float | None, turn: int, point: StartPoint
) -> tuple[float, float]:
    if point is not StartPoint.MAXIMUM:
        raise ParameterError(
            "start point", str(point), "absent for chains other than the friction chain",
            "leave it out, or give quarter turns",
        )  # fmt: skip
    size = chain.stable_amplitude if displacement is None else displacement
    return chain.excited_state(size, turn)


@_excited.register
def _(
    chain: FrictionChain, displacement: float | None, turn: int, point: StartPoint
) -> tuple[float, float]:
    if turn:
        raise ParameterError(
            "phase steps", turn, "0 for the friction chain, whose sites start in phase",
            "leave them out",
        )  # fmt: skip
    if displacement is None:
        return cycle_point(chain.cell, point), 0.0
    if point is not StartPoint.MAXIMUM:
        raise ParameterError(
            "start point", str(point), "absent with a displacement", "give one of them"
        )
    return displacement, 0.0


def cycle_point(cell: FrictionCell, point: StartPoint) -> float:
    """Return y at a point of the stick-slip cycle, or at the end of its range if there is none."""
    low, high = _turning_points(cell)
    return high if StartPoint(point) is StartPoint.MAXIMUM else low


@lru_cache(maxsize=4096)
def _turning_points(cell: FrictionCell) -> tuple[float, float]:
    from verification.cells.friction_cycles import cycle_turning_points

    return cycle_turning_points(cell)


def excite_edge(chain: SmoothChain, filled: int) -> FloatArray:
    """Return the start of a front: the first sites excited, with the phase step of its fronts.

    Fronts of (8) and (43) lock to a phase step of -π/2 per site.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> excite_edge(VdpChain(a=4, b=0.5, c=0.6, sites=4), 3).round(6).tolist()
    [[3.863703, 0.0, -3.863703, 0.0], [0.0, 3.863703, 0.0, 0.0]]
    """
    turns = [chain.front_phase_step * n for n in range(filled)]
    return excite(chain, range(1, filled + 1), quarter_turns=turns)


def add_noise(start: FloatArray, size: float, seed: int) -> FloatArray:
    """Return the start with normal noise of deviation ``size`` added to w and y of every site.

    Examples
    --------
    >>> noisy = add_noise(np.zeros((2, 3)), 1e-6, seed=1)
    >>> bool(0 < abs(noisy).max() < 1e-5)
    True
    """
    noise = np.random.default_rng(seed).standard_normal((2, start.shape[1]))
    return start + size * noise[::-1]
