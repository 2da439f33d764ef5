"""A quantity of a disordered chain over many seeds of its disorder: mean and spread."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt
from scipy.special import stdtrit

from theory.arrays import EPS, FloatArray, IntArray
from theory.chains.oscillator import AveragedOscillatorChain, OscillatorChain
from theory.chains.own import OwnChain
from theory.parameters import ParameterError, RunError, check_progress, need_instance, random_seed
from theory.result import Result
from verification.execution.pool import answers_in_order
from verification.execution.progress import ProgressCallback

VALUES = ("v", "c_crit", "frequency", "value")
"""Attributes of a result that may be its value; the first one present is taken."""

_CONFIDENCE = 0.975
"""Probability below the upper end of a confidence interval of 95 per cent."""


@dataclass(frozen=True, kw_only=True)
class Ensemble(Result):
    """A quantity over many seeds.

    Attributes
    ----------
    chain : OscillatorChain
        The chain with its disorder; its own seed is not used.
    quantity : str
        Name of the quantity.
    seeds : int array, shape (K,)
        Seeds of the disorder.
    values, errors : float array, shape (K,)
        The value and its error for each seed; nan where there is none. For a result with a
        ``frequency_error`` the error is that of the frequency.
    reasons : str array, shape (K,)
        Why there is no value for a seed; empty where there is one.
    seconds : float
        Wall-clock time.
    """

    derived: ClassVar[tuple[str, ...]] = ("mean", "spread", "mean_error", "missing")

    chain: Any
    quantity: str
    seeds: IntArray = field(metadata={"axis": "seed"})
    values: FloatArray = field(metadata={"dims": ("seed",)})
    errors: FloatArray = field(metadata={"dims": ("seed",)})
    reasons: npt.NDArray[np.str_] = field(metadata={"dims": ("seed",)})
    seconds: float

    @property
    def mean(self) -> float:
        """Mean of the values that exist."""
        known, exponent = self._of_order_one
        return float(np.ldexp(math.fsum(known) / known.size, exponent))

    @property
    def spread(self) -> float | None:
        """Standard deviation of the values that exist; None if there is only one.

        No error is known.
        """
        known, exponent = self._of_order_one
        return float(np.ldexp(known.std(ddof=1), exponent)) if known.size > 1 else None

    @property
    def mean_error(self) -> float | None:
        """Half of the 95 per cent confidence interval of the mean, with the largest error stated.

        The interval is Student's, for values with a normal distribution over the seeds; values
        without an error count as exact. The rounding of the mean is included. None if there is only
        one value.
        """
        if self.spread is None:
            return None
        largest = float(np.nanmax(self.errors, initial=0.0))
        count = self._known.size
        interval = float(stdtrit(count - 1, _CONFIDENCE)) * self.spread / math.sqrt(count)
        return interval + largest + EPS * float(np.abs(self._known).max())

    @property
    def missing(self) -> int:
        """Number of seeds without a value: a seed for which there is no front, for example."""
        return int(self.values.size - self._known.size)

    @property
    def _of_order_one(self) -> tuple[FloatArray, int]:
        """The values that exist and a power of two, by which they are divided, exactly.

        Squares of tiny or huge values would leave double precision.
        """
        known = self._known
        exponent = int(np.frexp(np.abs(known).max())[1])
        return np.ldexp(known, -exponent), exponent

    @property
    def _known(self) -> FloatArray:
        return self.values[np.isfinite(self.values)]


@dataclass(frozen=True, kw_only=True)
class SeedTask:
    """The value for one seed, computed in this process or in another one."""

    function: Callable[..., Any]
    chain: OwnChain
    options: Mapping[str, Any]

    def __call__(self, point: Mapping[str, int]) -> dict[str, Any]:
        """Return value, error and name of the quantity, or the reason why there is none."""
        try:
            found = self.function(self.chain.replace(seed=point["seed"]), **self.options)
        except (ParameterError, ArithmeticError) as refusal:
            return _MISSING | {"reason": str(refusal)}
        name = next((each for each in VALUES if hasattr(found, each)), "value")
        value = getattr(found, name, found)
        if value is None:
            status = getattr(found, "status", None)
            return _MISSING | {
                "reason": getattr(status, "sentence", "the result has no such number.")
            }
        value = _number(name, value)
        error = getattr(found, f"{name}_error", getattr(found, "error", None))
        if not math.isfinite(value):
            return _MISSING | {"reason": "the number is not finite."}
        return {
            "quantity": name,
            "value": value,
            "error": math.nan if error is None else _number("error", error),
            "reason": "",
        }


_MISSING = {"quantity": "", "value": math.nan, "error": math.nan}


def _number(quantity: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise ParameterError(
            f"{quantity} that the function gives", type(value).__name__, "a real number",
            "let the function return one, or a result that has one",
        )  # fmt: skip
    return float(value)


def ensemble(
    function: Callable[..., Any],
    chain: OwnChain,
    seeds: Sequence[int] = range(16),
    *,
    workers: int | None = None,
    progress: ProgressCallback | None = None,
    **options: Any,
) -> Ensemble:
    """Compute a quantity of a disordered chain for every seed of its disorder.

    Parameters
    ----------
    function : callable
        `measure_front`, `threshold`, or a function in a module that maps a chain to a number or to
        a result with ``v``, ``c_crit``, ``frequency`` or ``value``.
    chain : OscillatorChain
        A chain with disorder.
    seeds : sequence of int, optional
        Seeds, at least one.
    workers : int, optional
        Number of processes, by default one per core.
    progress : callable, optional
        Called with the fraction done.
    **options
        Options of the function.

    Returns
    -------
    Ensemble

    Raises
    ------
    ParameterError
        If the chain has no disorder, a seed is not a whole number or occurs twice, no seed is
        given, or the function does not return a number.
    RunError
        If there is no value for any seed.

    Examples
    --------
    >>> nagumo = OscillatorChain(damping=0, stiffness="y*(1 - y)*(alpha - y)", overdamped=True,
    ...                          values={"alpha": 0.2}, disorder={"alpha": 0.1}, c=1, sites=9)
    >>> def mean_threshold(chain):
    ...     return chain.site_values["alpha"].mean()
    >>> found = ensemble(mean_threshold, nagumo, range(100), workers=1)
    >>> abs(found.mean - 0.2) < found.mean_error, abs(found.spread - 0.02 / 3) < 1e-3
    (True, True)
    """
    begin = perf_counter()
    kinds = OscillatorChain, AveragedOscillatorChain
    need_instance("chain", chain, kinds, "give the cell as text, so that disorder can be applied")
    if not chain.disorder:
        raise ParameterError("disorder", "none", "a spread", "give one, as disorder={'a': 0.1}")
    if not callable(function):
        raise ParameterError("function", function, "a function of a chain", "give measure_front")
    check_progress(progress)
    given = _distinct(seeds)
    task = SeedTask(function=function, chain=chain, options=options)
    points = [{"seed": seed} for seed in given]
    rows = answers_in_order(task, points, workers=workers, progress=progress)
    table = {name: [row[name] for row in rows] for name in rows[0]}
    names = [name for name in table["quantity"] if name]
    if not names:
        raise RunError(f"the function gave no such number at any seed: {table['reason'][0]}")
    return Ensemble(
        chain=chain,
        quantity=names[0],
        seeds=np.array(given),
        values=np.asarray(table["value"], dtype=float),
        errors=np.asarray(table["error"], dtype=float),
        reasons=np.asarray(table["reason"], dtype=str),
        seconds=perf_counter() - begin,
    )


def _distinct(seeds: Sequence[int]) -> list[int]:
    """Return the seeds as whole numbers, refusing repeated ones."""
    if not isinstance(seeds, Iterable) or isinstance(seeds, str):
        raise ParameterError("seeds", seeds, "a sequence of whole numbers", "give range(16)")
    given = [random_seed(seed) for seed in seeds]
    if not given:
        raise ParameterError("seeds", "none", "at least one", "give range(16)")
    if len({*given}) < len(given):
        raise ParameterError("seeds", given, "all different", "give each seed once")
    return given
