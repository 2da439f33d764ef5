"""One number of a disordered chain over the seeds of its disorder: mean, and spread."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from theory.chains.oscillator import AveragedOscillatorChain, OscillatorChain
from theory.chains.own import OwnChain
from theory.parameters import ParameterError, need_instance
from theory.result import Result
from verification.execution.points import Point
from verification.execution.progress import ProgressCallback
from verification.execution.sweep import sweep

FloatArray = npt.NDArray[np.float64]

VALUES = ("v", "c", "frequency", "value")
"""Attributes of results that are the number asked for."""


@dataclass(frozen=True, kw_only=True)
class Ensemble(Result):
    """A number over seeds.

    Attributes
    ----------
    chain : OscillatorChain
        With its disorder; its own seed is not used.
    quantity : str
        Name of the number.
    seeds : int array, shape (K,)
        Of the disorder.
    values, errors : float array, shape (K,)
        The number and its error for each seed; nan where it does not exist.
    seconds : float
        Wall-clock time.
    """

    derived: ClassVar[tuple[str, ...]] = ("mean", "spread", "mean_error", "missing")

    chain: Any
    quantity: str
    seeds: npt.NDArray[np.int64] = field(metadata={"axis": "seed"})
    values: FloatArray = field(metadata={"dims": ("seed",)})
    errors: FloatArray = field(metadata={"dims": ("seed",)})
    seconds: float

    @property
    def mean(self) -> float:
        """Mean over the seeds for which the number exists; nan if there is none."""
        known = self._known
        return float(known.mean()) if known.size else math.nan

    @property
    def spread(self) -> float:
        """Standard deviation over the seeds; nan below two."""
        known = self._known
        return float(known.std(ddof=1)) if known.size > 1 else math.nan

    @property
    def mean_error(self) -> float:
        """Standard error of the mean, with the largest error of a value added."""
        known = self._known
        return self.spread / math.sqrt(known.size) + float(np.nanmax(self.errors, initial=0.0))

    @property
    def missing(self) -> int:
        """Seeds for which there is no such number: a front that is none, for example."""
        return int(self.values.size - self._known.size)

    @property
    def _known(self) -> FloatArray:
        return self.values[np.isfinite(self.values)]


@dataclass(frozen=True, kw_only=True)
class SeedTask:
    """The number at one seed: a task for ``verification.execution.sweep``."""

    function: Callable[..., Any]
    chain: OwnChain
    options: Mapping[str, Any]

    def __call__(self, point: Point) -> dict[str, Any]:
        """Return value, error and the name of the number."""
        found = self.function(self.chain.replace(seed=int(point["seed"])), **self.options)
        name = next((each for each in VALUES if hasattr(found, each)), "")
        value = getattr(found, name) if name else found
        error = getattr(found, "error", None)
        return {
            "quantity": name or "value",
            "value": math.nan if value is None else float(value),
            "error": math.nan if error is None else float(error),
        }


def ensemble(
    function: Callable[..., Any],
    chain: OwnChain,
    seeds: Sequence[int] = range(16),
    *,
    workers: int | None = None,
    progress: ProgressCallback | None = None,
    **options: Any,
) -> Ensemble:
    """Compute one number of a disordered chain at every seed of its disorder.

    Parameters
    ----------
    function : callable
        `measure_front`, `threshold`, or a function of a module from a chain to a number or to a
        result with ``v``, ``c``, ``frequency`` or ``value``.
    chain : OscillatorChain
        With a disorder.
    seeds : sequence of int, optional
        Seeds, at least one.
    workers : int, optional
        Processes, by default one a core.
    progress : callable, optional
        Called with the part done.
    **options
        Of the function.

    Returns
    -------
    Ensemble

    Raises
    ------
    ParameterError
        If the chain has no disorder, or no seed is given.

    Examples
    --------
    >>> nagumo = OscillatorChain(damping=0, stiffness="y*(1 - y)*(alpha - y)", overdamped=True,
    ...                          values={"alpha": 0.2}, disorder={"alpha": 0.1}, c=1, sites=9)
    >>> def mean_threshold(chain):
    ...     return chain.site_values["alpha"].mean()
    >>> found = ensemble(mean_threshold, nagumo, range(100), workers=1)
    >>> abs(found.mean - 0.2) < 4 * found.mean_error, abs(found.spread - 0.02 / 3) < 1e-3
    (True, True)
    """
    begin = perf_counter()
    kinds = OscillatorChain, AveragedOscillatorChain
    need_instance("chain", chain, kinds, "write the cell as text: it takes disorder")
    if not chain.disorder:
        raise ParameterError("disorder", "none", "a spread", "give one, as disorder={'a': 0.1}")
    if not len(seeds):
        raise ParameterError("seeds", "none", "at least one", "give range(16)")
    task = SeedTask(function=function, chain=chain, options=options)
    points = [{"seed": int(seed)} for seed in seeds]
    table = sweep(task, points, workers=workers, progress=progress)
    return Ensemble(
        chain=chain,
        quantity=str(table["quantity"][0]),
        seeds=np.asarray(table["seed"], dtype=np.int64),
        values=np.asarray(table["value"], dtype=float),
        errors=np.asarray(table["error"], dtype=float),
        seconds=perf_counter() - begin,
    )
