"""Integrations: one run of a chain in progress, and the contract of every stepper.

How to write a new integration
------------------------------
1. Derive from :class:`Integration`, and name it for your chain, as
   ``verification.runs.integrations.INTEGRATIONS[MyChain] = MyIntegration``. It is made from chain,
   start, times and options; options that it does not have are refused.
2. Keep the whole state of the run in numpy arrays that are created once, changed in place and
   listed in ``state_arrays``. When they are filled from a file, the run continues bit for bit.
3. ``advance(budget)`` steps until ``end``, or until about ``budget`` sites times steps are spent
   (a fraction of a second), so that the run can be watched or interrupted. The division of a run
   into such calls must not change the result by a single bit.
4. Do not stop early and do not print; if the run cannot continue, raise ``RunError`` with one
   sentence.
5. Take the samples exactly at ``times``, with the accuracy of the steps. The arrival of a site is
   the first time at which it is reached, to the accuracy of the run.
6. ``metadata`` contains everything that determines the run, as JSON data; it is compared with that
   of a checkpoint.
7. Control the local error by ``tolerance``, so that a run with a hundred times the tolerance has
   an error about a hundred times as large: the error of a run is estimated by comparison.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from theory.arrays import EPS, AnyArray, ComplexArray, FloatArray
from theory.chains.chain import Chain
from theory.parameters import ParameterError, RunError


class NotFiniteError(RunError):
    """The state has left the range of double precision."""


class StandstillError(RunError):
    """Time does not advance since no step is short enough, or its steps are too short."""


class Integration(ABC):
    """One run of a chain at one tolerance, in progress; the module states the contract.

    Attributes
    ----------
    method : str
        Name of the stepper; results state that of ``method_of``.
    default_budget : int
        Sites times steps between two readings of the clock, by default.
    chain : Chain
        Parameters.
    tolerance : float
        Local error; the class states what it is relative to.
    times : ndarray, shape (M,)
        Times t of the samples, ascending.
    end : float
        Time t of the end, at least the last of ``times``.
    """

    method: ClassVar[str]
    default_budget: ClassVar[int] = 2_000_000

    chain: Any
    tolerance: float
    times: FloatArray
    end: float

    @abstractmethod
    def advance(self, budget: int) -> None:
        """Step until the end, or until about ``budget`` sites times steps are spent.

        Raises
        ------
        RunError
            If the run cannot continue.
        """

    def check_pace(self) -> None:  # noqa: B027  (most integrations are never that slow)
        """Refuse a run that would take minutes to hours, unless it ends when a condition is met.

        Raises
        ------
        RunError
            If it would take that long.
        """

    def finish(self) -> None:
        """Step until the end; raises what `advance` raises."""
        while not self.finished:
            self.advance(self.default_budget)

    @property
    @abstractmethod
    def time(self) -> float:
        """Time t reached, from 0 to the end."""

    @property
    @abstractmethod
    def finished(self) -> bool:
        """Whether the end is reached and every sample taken."""

    @property
    @abstractmethod
    def state(self) -> FloatArray:
        """Present state (y, w), shape (2, N)."""

    @property
    @abstractmethod
    def amplitude(self) -> FloatArray:
        """Present amplitude of every site, shape (N,)."""

    @property
    @abstractmethod
    def arrivals(self) -> FloatArray:
        """Time t at which each site was first reached, shape (N,); nan if it was not."""

    @property
    @abstractmethod
    def samples(self) -> FloatArray:
        """(y, w) at ``times``, shape (M, 2, N)."""

    @property
    @abstractmethod
    def sampled_amplitude(self) -> FloatArray:
        """Amplitude of every site at ``times``, shape (M, N)."""

    @property
    @abstractmethod
    def counts(self) -> dict[str, int]:
        """Counters: at least ``steps`` and ``site_steps``, the sum of sites over all steps."""

    @property
    @abstractmethod
    def state_arrays(self) -> Mapping[str, AnyArray]:
        """The arrays that make up the state of the run; filled in place when it is resumed."""

    @property
    @abstractmethod
    def metadata(self) -> Mapping[str, Any]:
        """Everything that determines the run, to be compared with a checkpoint."""

    @abstractmethod
    def check_state(self) -> None:
        """Raise ValueError if the arrays are no valid state; compiled code does not check them."""

    @abstractmethod
    def going_to_rest(self) -> bool:
        """Whether no further site will be reached, because all are decaying to rest."""

    @classmethod
    def method_of(cls, counts: Mapping[str, int]) -> str:
        """Return the name of the stepper, or steppers, by which runs of these counts were made."""
        return cls.method

    @property
    def events(self) -> Mapping[str, int]:
        """Number of events of each kind; runs in which it differs are not the same motion."""
        return {}

    @property
    def log(self) -> FloatArray:
        """Rows (t, site from 1, kind) of the first events, if they were requested."""
        return np.zeros((0, 3))

    def least_error(self) -> float:
        """Return the local error of an ordinary step, below which no error of a run is stated.

        Two runs may agree far better than either is accurate: if both reach a sample by the same
        few steps, or if one step of the finer run happens to be inaccurate.
        """
        return self.tolerance

    def least_arrival_error(self) -> float:
        """Return the corresponding bound for times: the tolerance, in the equations' time unit."""
        return self.tolerance

    @classmethod
    def perturbed(cls, chain: Chain, start: FloatArray, ulps: int) -> FloatArray:
        """Return a start in which every number is larger by ``ulps`` units in the last place.

        All sites are changed alike, so that a mirror-symmetric start stays symmetric.
        """
        return start * (1.0 + ulps * EPS)


def checked_state(chain: Chain, start: npt.ArrayLike) -> FloatArray:
    """Return a start as a newly allocated state (y, w), shape (2, N).

    Parameters
    ----------
    chain : Chain
        A chain with ``sites``.
    start : array_like
        (y, w), shape (2, N); or Ψ = w + iy, complex, shape (N,).

    Raises
    ------
    ParameterError
        If it has another shape, or a value is not finite.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> checked_state(VdpChain(a=4, b=0.5, c=0.6, sites=2), [1j, 2.0]).tolist()
    [[1.0, 0.0], [0.0, 2.0]]
    """
    sites: int = chain.sites  # type: ignore[attr-defined]
    try:
        given = np.asarray(start)
        kind = given.dtype.kind
    except (TypeError, ValueError):
        given, kind = np.zeros(0), "O"
    if np.ma.is_masked(start):
        raise ParameterError("start", "a masked array", "without a masked value", "fill them in")
    state: AnyArray = given
    if kind == "c" and given.shape == (sites,):
        state = np.array([given.imag, given.real])
    if kind not in "iufc" or state.shape != (2, sites) or not np.all(np.isfinite(state)):
        raise ParameterError(
            "start", f"an array of shape {given.shape}",
            f"finite, of shape (2, {sites}), or complex of shape ({sites},)",
            "give y and w at every site",
        )  # fmt: skip
    if kind == "c" and given.shape != (sites,):
        raise ParameterError("start", "a complex array", "real", "give y and w at every site")
    return np.array(state, dtype=float, order="C")


def as_psi(state: FloatArray) -> ComplexArray:
    """Return Ψ = ẏ + iy, or φ, of states (…, 2, N).

    Examples
    --------
    >>> as_psi(np.array([[1.0], [2.0]]))
    array([2.+1.j])
    """
    return state[..., 1, :] + 1j * state[..., 0, :]
