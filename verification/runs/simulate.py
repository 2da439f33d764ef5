"""A direct run of any chain, with its error by comparison with runs at other tolerances."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.arrays import FloatArray, IntArray
from theory.chains.chain import Chain
from theory.parameters import (
    LATEST,
    ParameterError,
    Range,
    check_progress,
    count_within,
    end_time,
    file_path,
    need_instance,
    positive,
    real_array,
    truth,
    with_ranges,
    within,
)
from verification.execution.progress import ProgressCallback
from verification.runs.checkpoint import run_to_end
from verification.runs.comparison import (
    PERTURBATION,
    arrival_error_from,
    error_by_sample,
    other_tolerance,
)
from verification.runs.integration import Integration, checked_state
from verification.runs.integrations import integration
from verification.runs.trajectory import RunStatus, Trajectory

TOLERANCES = Range(1e-14, 1e-2)
SAMPLES = Range(2, 1_000_000)
DEFAULT_SAMPLES = 201

MAX_NUMBERS = 10**8
"""Samples times sites that a run may store: a few gigabytes."""

_COMPARED, _COMPARED_NUMBERS = 200, 10**5
"""Smallest number of times, samples included, at which runs are compared: at fewer times, runs that
have become independent may agree by chance. In long chains this does not happen, and the number of
times multiplied by that of sites is limited to the second number."""


@with_ranges(tolerance=TOLERANCES, latest=LATEST, samples=SAMPLES.low, default=DEFAULT_SAMPLES)
def simulate(  # noqa: PLR0913  (all but three by name)
    chain: Chain,
    start: npt.ArrayLike,
    t_end: float,
    *,
    tolerance: float | None = None,
    samples: int | None = None,
    times: Sequence[float] | None = None,
    level: float | None = None,
    estimate_error: bool = True,
    checkpoint: Path | str | None = None,
    progress: ProgressCallback | None = None,
    budget: int | None = None,
    **options: Any,
) -> Trajectory:
    """Run a chain from t = 0 to ``t_end``.

    Parameters
    ----------
    chain : Chain
        A chain of a model that is integrated in time: (8), (43), (5), or a user-defined smooth
        chain.
    start : array_like
        (y, w) of every site, shape (2, N), dimensionless, as made by ``verification.runs.excite``:
        w is ẏ or, for (43), y and w are Im φ and Re φ. Or Ψ = w + iy, complex, shape (N,).
    t_end : float
        Final time t, positive, at most {latest}; slow time is εt.
    tolerance : float, optional
        Local error, {tolerance}: relative to the largest value of the state, by default
        1e-9; for the friction chain absolute, by default 1e-10.
    samples : int, optional
        Number of states sampled, evenly spaced from 0 to ``t_end``; at least {samples}, by default
        {default}.
    times : sequence of float, optional
        Times at which states are sampled instead, ascending, the last one at most ``t_end``; one
        is enough.
    level : float, optional
        Amplitude that counts as an arrival; by default the unstable amplitude of the chain. The
        friction chain has no level: a site is reached when it first sticks.
    estimate_error : bool
        Also run the chain at a tenth of the tolerance, to estimate the error.
    checkpoint : Path or str, optional
        File into which the run is saved every few seconds and when it is interrupted. If it exists,
        the run is resumed from it and continues bit for bit.
    progress : callable, optional
        Called at intervals with the fraction done.
    budget : int, optional
        Work between two calls of ``progress`` or saves of the checkpoint, in sites times steps.
    **options
        Options of the integration: ``active_window`` (step only the sites that move, by default
        true), ``trailing_sites``, ``left_boundary_wave``
        (``smooth_integration.SmoothIntegration``), or ``logged_events``
        (``friction_integration.FrictionIntegration``).

    Returns
    -------
    Trajectory

    Raises
    ------
    ParameterError
        If a parameter is out of range, the start does not fit, the model is not integrated in time,
        or the checkpoint belongs to another run.
    RunError
        If the run cannot continue.

    References
    ----------
    Hairer, E., Nørsett, S. P. & Wanner, G. (1993), Solving Ordinary Differential Equations I,
    Springer: DOP853. Hénon, M. (1982), Physica D 5, 412: states on a section by shortened steps.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> from verification.runs.excite import excite
    >>> chain = VdpChain(a=4, b=0.5, c=0.6, sites=5)
    >>> run = simulate(chain, excite(chain, [1]), 50.0, samples=2)
    >>> run.states.shape, run.error < 1e-5, run.status.value
    ((2, 2, 5), True, 'resolved')
    """
    begin = perf_counter()
    need_instance("chain", chain, (Chain,), "give one, as VdpChain(a=4, b=0.5, c=0.6)")
    t_end = end_time("end time t", t_end)
    requested = _sample_times(chain, t_end, samples, times)
    if level is not None:
        options["level"] = positive("level", level)
    if tolerance is not None:
        options["tolerance"] = within("tolerance", tolerance, *TOLERANCES)
    if "end" in options:
        raise ParameterError("option", "end", "absent beside t_end", "give t_end only")
    options["end"] = t_end
    compared = truth("estimate_error", estimate_error)
    check_progress(progress)
    sampled, places = _with_comparisons(requested, chain) if compared else (requested, None)
    first = integration(chain, start, sampled, **options)
    runs = [first]
    if compared:
        other = first.perturbed(chain, checked_state(chain, start), PERTURBATION)
        options["tolerance"] = other_tolerance(first.tolerance)
        runs.append(integration(chain, other, sampled, **options))
    if budget is None:
        budget = first.default_budget
    budget = count_within("budget of sites times steps", budget, 1, 10**12)
    file = None if checkpoint is None else file_path("checkpoint", checkpoint)
    earlier_seconds = run_to_end(runs, t_end, budget, file, progress)
    return _trajectory(chain, t_end, runs, earlier_seconds - begin, places)


def _sample_times(
    chain: Chain, t_end: float, samples: int | None, times: Sequence[float] | None
) -> FloatArray:
    sites = getattr(chain, "sites", 1)
    if times is None:
        samples = DEFAULT_SAMPLES if samples is None else samples
        _check_samples(samples, sites, int(SAMPLES.low))
        return np.linspace(0.0, t_end, samples)
    if samples is not None:
        raise ParameterError("samples", samples, "absent beside times", "give one of the two")
    found = np.atleast_1d(real_array("times of the samples", times))
    _check_samples(len(found), sites, 1)
    if not (
        found.ndim == 1 and np.all(np.diff(found) >= 0.0) and found[0] >= 0.0 and found[-1] <= t_end
    ):
        raise ParameterError(
            "times of the samples",
            np.array2string(found, threshold=6, edgeitems=2),
            f"one ascending list of numbers between 0 and t_end = {t_end:g}",
            "sort them, leave out those outside, or take a later t_end",
        )
    return found


def _with_comparisons(requested: FloatArray, chain: Chain) -> tuple[FloatArray, IntArray | None]:
    """Return the times of the samples and of further comparisons, and the places of the former.

    The places are None if no comparison is added. Further times are in the middle of equal parts,
    so that few of them are those of samples.
    """
    further = min(_COMPARED, _COMPARED_NUMBERS // getattr(chain, "sites", 1)) - len(requested)
    if further <= 0:
        return requested, None
    all_times = np.append(requested, requested[-1] * (np.arange(further) + 0.5) / further)
    order = np.argsort(all_times, kind="stable")
    return all_times[order], np.flatnonzero(order < len(requested))


def _check_samples(samples: int, sites: int, fewest: int) -> None:
    count_within("number of samples", samples, fewest, int(SAMPLES.high))
    largest = MAX_NUMBERS // sites
    if samples > largest:
        raise ParameterError(
            "number of samples", samples, f"at most {largest} for {sites} sites", "ask for fewer"
        )


def _trajectory(
    chain: Chain,
    t_end: float,
    runs: Sequence[Integration],
    offset: float,
    places: IntArray | None = None,
) -> Trajectory:
    """Return the trajectory of the first run at the samples, with its error from the others."""
    first, *others = runs
    error = arrival_error = until = None
    at_samples = slice(None) if places is None else places
    status = RunStatus.NOT_COMPARED
    for other in others:
        errors = error_by_sample(first.samples, other.samples)
        error = max(float(errors.max()), first.least_error())
        arrival_error = arrival_error_from(first.arrivals, other.arrivals)
        if np.any(first.arrivals > 0.0):  # arrivals at t = 0 belong to the start and are exact
            arrival_error = max(arrival_error, first.least_arrival_error())
        status, until = _resolution(first, errors)
        if status is RunStatus.NOT_RESOLVED:
            error = max(error, _independent_distance(first, other))
        if status is RunStatus.RESOLVED and dict(other.events) != dict(first.events):
            status = RunStatus.EVENTS_DIFFER
    return Trajectory(
        chain=chain,
        t_end=t_end,
        times=first.times[at_samples],
        states=first.samples[at_samples],
        amplitude=first.sampled_amplitude[at_samples],
        arrivals=first.arrivals,
        level=first.level if hasattr(first, "level") else chain.unstable_amplitude,
        error=error,
        arrival_error=arrival_error,
        status=status,
        resolved_until=until,
        tolerance=first.tolerance,
        method=first.method_of(first.counts),
        counts={**first.counts, **first.events},
        event_log=first.log,
        seconds=perf_counter() + offset,
    )


def _distance_from_rest(run: Integration) -> FloatArray:
    """Return the largest distance of a site from rest at each sample."""
    rest = np.array(run.chain.rest_state)[None, :, None]
    distance: FloatArray = np.hypot(*np.moveaxis(run.samples - rest, 1, 0)).max(axis=-1)
    return distance


def _independent_distance(run: Integration, other: Integration) -> float:
    """Return a bound on the distance between two independent motions of the size of these runs.

    Where a run is not resolved, the distance of the second run is a matter of chance, and so is
    three times this distance. Two motions are never further apart than the sum of their largest
    distances from rest; the factor 1.5 allows for motions larger than those seen in either run.
    """
    return 1.5 * float(_distance_from_rest(run).max() + _distance_from_rest(other).max())


def _resolution(run: Integration, errors: FloatArray) -> tuple[RunStatus, float]:
    """Return whether errors stay below the largest distance from rest so far, and until when."""
    distance = _distance_from_rest(run)
    unresolved = np.flatnonzero(errors > np.maximum.accumulate(distance))
    if not unresolved.size:
        return RunStatus.RESOLVED, float(run.times[-1])
    return RunStatus.NOT_RESOLVED, float(run.times[max(0, int(unresolved[0]) - 1)])
