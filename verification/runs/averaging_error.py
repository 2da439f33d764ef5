"""The distance between the averaged and the full chain, and how it decreases with ε."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from theory.arrays import FloatArray
from theory.cells.polynomial import Polynomial, as_polynomial
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain
from theory.parameters import (
    ParameterError,
    Range,
    count_within,
    need_instance,
    positive,
    with_ranges,
)
from theory.result import Result
from verification.runs.excite import excite
from verification.runs.integration import checked_state
from verification.runs.simulate import simulate

SHARE = "share_of_eps"
"""Name of the parameter that scales the nonlinear part of the stiffness with ε."""

_SAMPLES = 401
_TOLERANCE = 1e-10
_NO_LEVEL = 1e100
"""A level that is never reached, since arrivals are not needed."""


@dataclass(frozen=True, kw_only=True)
class AveragingError(Result):
    """Distance between the averaged and the full chain at several ε; made by `averaging_error`.

    Attributes
    ----------
    chain : OscillatorChain
        The full chain at the largest ε.
    slow_time : float
        Slow time εt up to which they were compared.
    eps : float array, shape (K,)
        Values of ε, each half of the preceding one.
    distances : float array, shape (K,)
        Largest |ẏ/ω + iy - φe^{iωt}| over sites and sampled times.
    errors : float array, shape (K,)
        Sum of the errors of both runs, a bound on the error of the distance.
    seconds : float
        Wall-clock time.
    """

    derived: ClassVar[tuple[str, ...]] = ("slope", "slope_error")

    chain: Any
    slow_time: float
    eps: FloatArray = field(metadata={"axis": "eps"})
    distances: FloatArray = field(metadata={"dims": ("eps",)})
    errors: FloatArray = field(metadata={"dims": ("eps",)})
    seconds: float

    @property
    def slope(self) -> float:
        """Slope of log(distance) over log ε at the two smallest ε; 1 for a first-order error."""
        return float(self._slopes[-1])

    @property
    def slope_error(self) -> float:
        """Change of the slope from the preceding pair of ε, plus the effect of the runs' errors."""
        change = abs(float(self._slopes[-1] - self._slopes[-2]))
        return change + float(np.sum(self.errors[-2:] / self.distances[-2:]) / np.log(2.0))

    @property
    def _slopes(self) -> FloatArray:
        return np.diff(np.log(self.distances)) / np.diff(np.log(self.eps))


HALVINGS = Range(2, 8)
"""Range of the number of times that ε is halved."""


@with_ranges(halvings=HALVINGS)
def averaging_error(
    chain: VdpChain | OscillatorChain,
    start: npt.ArrayLike | None = None,
    *,
    slow_time: float = 3.0,
    halvings: int = 2,
) -> AveragingError:
    """Compare the averaged chain with the full one at ε and at repeated halvings of it.

    The nonlinear part of the stiffness is taken to be of order ε and is halved with it.

    Parameters
    ----------
    chain : VdpChain or OscillatorChain
        The chain at the largest ε; an OscillatorChain may be disordered, except in its frequency.
    start : array_like, shape (2, N), optional
        (y, ẏ) of every site at t = 0; by default the middle site on its cycle.
    slow_time : float, optional
        εt at the end, dimensionless, from 0 to 100: if the motion is unstable, the two chains
        differ by more than O(ε) after long times.
    halvings : int, optional
        Number of times that ε is halved, {halvings}.

    Returns
    -------
    AveragingError

    Raises
    ------
    ParameterError
        If the chain is of another model or cannot be averaged, or its frequency differs from site
        to site.

    References
    ----------
    J. A. Sanders, F. Verhulst, J. Murdock, Averaging Methods in Nonlinear Dynamical Systems
    (2007): the distance is O(ε) over times of order 1/ε.

    Examples
    --------
    >>> rayleigh = OscillatorChain(damping="v**2 - 1", c=0.5, eps=0.02, sites=3)
    >>> found = averaging_error(rayleigh)
    >>> bool(abs(found.slope - 1) < 0.1)
    True
    """
    begin = perf_counter()
    need_instance(
        "chain", chain, (VdpChain, OscillatorChain), "give the chain of the full equation"
    )
    slow_time = positive("slow time", slow_time)
    if slow_time > 100.0:
        raise ParameterError("slow time", slow_time, "at most 100", "take a shorter time")
    halvings = count_within("halvings of eps", halvings, *HALVINGS)
    if start is None:
        start = excite(chain, [(chain.sites + 1) // 2])
    state = checked_state(chain, start)
    eps = np.array([chain.eps * 0.5**k for k in range(halvings + 1)])
    chain.averaged()  # refuses a chain that has no average
    scaled = _scalable(chain)
    found = [_distance(_at_eps(scaled, float(each)), state, slow_time) for each in eps]
    return AveragingError(
        chain=chain,
        slow_time=slow_time,
        eps=eps,
        distances=np.array([each[0] for each in found]),
        errors=np.array([each[1] for each in found]),
        seconds=perf_counter() - begin,
    )


def _scalable(chain: VdpChain | OscillatorChain) -> VdpChain | OscillatorChain:
    """Return the chain with a named parameter that multiplies the nonlinear part of g."""
    if isinstance(chain, VdpChain):
        return chain
    terms = as_polynomial(chain.stiffness, "stiffness").terms
    linear = {each: value for each, value in terms.items() if dict(each).get("y") == 1}
    nonlinear = {each: value for each, value in terms.items() if each not in linear}
    varied = {name for name, value in chain.site_values.items() if np.ndim(value)}
    if varied & {name for each in linear for name, _ in each}:
        raise ParameterError(
            "linear part of the stiffness", "different from site to site", "the same at every site "
            "where eps is halved", "run chain and chain.averaged() by themselves",
        )  # fmt: skip
    if not nonlinear:
        return chain
    if SHARE in chain.names:
        raise ParameterError("named parameter", SHARE, "another name here", "rename it")
    text = f"{Polynomial(linear).source()} + {SHARE}*({Polynomial(nonlinear).source()})"
    return chain.replace(stiffness=text, values={**chain.values, SHARE: 1.0})


def _at_eps(scaled: VdpChain | OscillatorChain, eps: float) -> VdpChain | OscillatorChain:
    if isinstance(scaled, VdpChain) or SHARE not in scaled.names:
        return scaled.replace(eps=eps)
    return scaled.replace(eps=eps, values={**scaled.values, SHARE: eps / scaled.eps})


def _distance(
    chain: VdpChain | OscillatorChain, start: FloatArray, slow_time: float
) -> tuple[float, float]:
    """Return the largest distance between the two runs, and the sum of their errors."""
    end = slow_time / chain.eps
    omega = 1.0 if isinstance(chain, VdpChain) else chain.cell.frequency
    times = np.linspace(0.0, end, _SAMPLES)
    full = simulate(chain, start, end, times=list(times), tolerance=_TOLERANCE, level=_NO_LEVEL)
    averaged_start = start / np.array([[1.0], [omega]])
    averaged = simulate(
        chain.averaged(),
        averaged_start,
        end,
        times=list(times),
        tolerance=_TOLERANCE,
        level=_NO_LEVEL,
    )
    assert full.error is not None
    assert averaged.error is not None
    psi = full.states[:, 1] / omega + 1j * full.states[:, 0]
    phi = averaged.states[:, 1] + 1j * averaged.states[:, 0]
    distance = np.abs(psi * np.exp(-1j * omega * times)[:, None] - phi)
    return float(distance.max()), full.error * max(1.0, 1.0 / omega) + averaged.error
