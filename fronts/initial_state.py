"""The initial state of a simulation, from options: excited sites, displacement, and noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from theory.arrays import FloatArray
from theory.chains.chain import Chain
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError, random_seed, within
from verification.runs.excite import StartPoint, add_noise, excite


@dataclass(frozen=True, kw_only=True)
class InitialState:
    """An initial state, and the parameters from which it was made, including defaults.

    Attributes
    ----------
    state : ndarray, shape (2, N)
        The state (y, w) of every site.
    parameters : mapping
        ``sites`` and their ``displacement``; ``perturbation`` and its ``seed`` if there is noise.
    """

    state: FloatArray
    parameters: Mapping[str, Any]


def prepared(
    chain: Chain,
    sites: Sequence[int] | None = None,
    displacement: float | None = None,
    *,
    start_point: StartPoint | None = None,
    perturbation: float | None = None,
    seed: int | None = None,
) -> InitialState:
    """Return an initial state with some sites excited, the others at rest, and noise on all.

    Parameters
    ----------
    chain : Chain
        A chain of finite length.
    sites : sequence of int, optional
        Excited sites: 15, or 14,15,16, or 14:16; by default the middle one or, for the friction
        chain, the first.
    displacement : float, optional
        Displacement of the excited sites; by default that of the excited state of a single cell.
    start_point : StartPoint, optional
        Point of the cycle from which excited sites of the friction chain start, by default its
        maximum.
    perturbation : float, optional
        Standard deviation of normal noise on every site, by default 0.
    seed : int, optional
        Seed of the noise, by default 1.

    Returns
    -------
    InitialState
        The state, and the parameters that were chosen.

    Raises
    ------
    ParameterError
        If a value is out of range, is redundant because of another one, or requires another one
        that is missing.
    """
    if start_point is not None and displacement is not None:
        raise ParameterError(
            "start point", start_point, "absent with a displacement", "give one of them"
        )
    if seed is not None and perturbation is None:
        raise ParameterError(
            "seed", seed, "absent without a perturbation",
            "give a perturbation too",
        )  # fmt: skip
    if sites is None:
        count: int = getattr(chain, "sites", 1)
        sites = (1,) if isinstance(chain, FrictionChain) else ((count + 1) // 2,)
    point = StartPoint.MAXIMUM if start_point is None else start_point
    start = excite(chain, sites, displacement, point=point)
    chosen: dict[str, Any] = {} if start_point is None else {"start_point": start_point}
    chosen |= {"sites": list(sites), "displacement": float(start[0, sites[0] - 1])}
    if not perturbation:
        return InitialState(state=start, parameters=chosen)
    seed = random_seed(1 if seed is None else seed)
    noisy = add_noise(start, within("perturbation", perturbation, 0.0, 1.0), seed)
    chosen |= {"perturbation": perturbation, "seed": seed}
    return InitialState(state=noisy, parameters=chosen)
