"""``breather``: the localised oscillation of a Van der Pol chain by four methods."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from inspect import signature
from typing import Literal, NamedTuple, overload

import numpy as np

from theory.arrays import AnyArray, ComplexArray, FloatArray
from theory.averaged.breather import (
    BreatherStatus,
    Reading,
    check_closed_form,
    has_closed_form,
    solve_breather,
)
from theory.chains.nucleus import Nucleus, Place
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import ParameterError, need_instance, random_seed, refuse_unread, word
from verification.breathers.envelope import solve_envelope_breather
from verification.breathers.exponents import BreatherStability
from verification.breathers.families import own_family, own_method
from verification.breathers.floquet import approximate_multipliers
from verification.breathers.orbits import solve_orbit
from verification.breathers.own import OwnOrbits
from verification.breathers.result import (
    Breather,
    BreatherComparison,
    BreatherMethod,
    wave_error_of,
)
from verification.breathers.run import run_averaged_breather, run_breather
from verification.continuation.newton import NotConvergedError
from verification.thresholds.continuation import breather_threshold
from verification.thresholds.result import ThresholdMethod

MAX_SITES = {
    BreatherMethod.CLOSED_FORM: 100_000,
    BreatherMethod.ENVELOPE: 401,
    BreatherMethod.ORBIT: 101,
    BreatherMethod.SIMULATION: 2001,
}
"""Longest chain for each method: the matrices are dense, and a breather needs only a few sites."""
REST = 14
"""Largest number of sites at rest beside the nucleus in a solution computed for comparison; farther
out all amplitudes are small."""


@overload
def breather(
    chain: VanDerPolChain | OscillatorChain,
    nucleus: Nucleus = ...,
    *,
    method: Literal["all"],
    reading: Reading | str = ...,
    seed: int = ...,
) -> BreatherComparison: ...


@overload
def breather(
    chain: VanDerPolChain | OscillatorChain,
    nucleus: Nucleus = ...,
    *,
    method: Literal["envelope", "closed-form", "orbit", "simulation"] | None = ...,
    reading: Reading | str = ...,
    seed: int = ...,
) -> Breather: ...


def breather(
    chain: VanDerPolChain | OscillatorChain,
    nucleus: Nucleus = Nucleus(1),  # noqa: B008  (frozen)
    *,
    method: Literal["envelope", "closed-form", "orbit", "simulation", "all"] | None = None,
    reading: Reading | str = Reading.NEIGHBOUR,
    seed: int = 0,
) -> Breather | BreatherComparison:
    """Return the breather of a nucleus, and its distance from a solution of the chain.

    Parameters
    ----------
    chain : VdpChain, AveragedChain or OscillatorChain
        Needs two cycles (8b < a²) and c > 0. The stated error is the distance from the periodic
        orbit of (8) for a `VdpChain`, and from the rotating solution of (43) for an
        `AveragedChain`. An `OscillatorChain` needs a stable cycle; it is run until the nucleus has
        settled, and its orbit is then solved for.
    nucleus : Nucleus, optional
        Which sites oscillate, and with which phase steps; by default one in the middle. A nucleus
        of three or more sites without a pattern has the phases to which an in-phase start relaxes.
    method : {"envelope", "closed-form", "orbit", "simulation", "all"}, optional
        By default the method that solves the chain itself: ``envelope`` for an `AveragedChain`,
        ``orbit`` for a `VdpChain` and for an `OscillatorChain`, which allows no other.
        ``closed-form``: (29), (37), (30), for one site in the bulk. ``envelope``: solution of (43).
        ``orbit``: the periodic orbit of (8) by shooting, with Floquet multipliers; not for an
        `AveragedChain`. ``simulation``: a run from a perturbed start until it is periodic. ``all``:
        every applicable method side by side, and the reasons why the others do not apply.
    reading : Reading, optional
        Closed form: the site at which (37) is evaluated.
    seed : int, optional
        Simulation: seed of the noise.

    Returns
    -------
    Breather
        Amplitudes of (8), dimensionless, the frequency in t, and their errors;
        `BreatherComparison` for the method ``all``.

    Raises
    ------
    ParameterError
        If c = 0, the cell has no cycle, the nucleus does not fit, the method does not apply, or an
        option belongs to another method.

    References
    ----------
    Marín and Aubry (1996), for continuation of breathers from the anticontinuum limit; Keller
    (1977), for pseudo-arclength continuation.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=11)
    >>> orbit = breather(chain, method="orbit")
    >>> orbit.status.value, orbit.stable, round(orbit.frequency, 6)
    ('exists', True, 1.000985)
    >>> theory = breather(chain, method="closed-form")
    >>> bool(abs(theory.outward - orbit.outward).max() <= theory.error < 2e-3)
    True
    """
    started = time.perf_counter()
    default = own_method(chain).value
    need_instance("nucleus", nucleus, (Nucleus,), "give one, as Nucleus(3)")
    nucleus = with_pattern(nucleus, chain.sites)
    _ = chain.stable_amplitude
    choice = _Choice(Reading(reading), random_seed(seed))
    if isinstance(chain, OscillatorChain):
        if method is not None and not (isinstance(method, str) and method == "orbit"):
            raise ParameterError("method", method, "orbit for a chain of your own", "take it")
        choice.check_read(BreatherMethod.ORBIT)
        return OwnOrbits(chain, nucleus).solve()
    chosen = default if method is None else method
    if word("method", chosen, [*(each.value for each in BreatherMethod), "all"]) != "all":
        found = BreatherMethod(chosen)
        _check_length(chain, found)
        choice.check_read(found)
        return _METHODS[found](chain, nucleus, choice)
    applicable = [each for each in BreatherMethod if _applies(each, chain, nucleus)]
    _check_length(chain, min(applicable, key=lambda each: MAX_SITES[each]))
    methods: dict[str, Breather] = {}
    refusals: dict[str, ParameterError] = {}
    for each in applicable:
        try:
            methods[str(each)] = _METHODS[each](chain, nucleus, choice)
        except ParameterError as refusal:
            refusals[str(each)] = refusal
    if not methods:
        raise next(iter(refusals.values()))
    return BreatherComparison(
        chain=chain,
        nucleus=nucleus,
        methods=methods,
        refusals={name: str(refusal) for name, refusal in refusals.items()},
        seconds=time.perf_counter() - started,
    )


class _Choice(NamedTuple):
    """Options of the single methods besides chain and nucleus."""

    reading: Reading
    seed: int

    def check_read(self, method: BreatherMethod) -> None:
        """Refuse options that have no effect with the chosen method."""
        read = {BreatherMethod.CLOSED_FORM: ["reading"], BreatherMethod.SIMULATION: ["seed"]}
        defaults = {name: each.default for name, each in signature(breather).parameters.items()}
        refuse_unread(self._asdict(), defaults, read.get(method, []), f"with the method {method}")


def with_pattern(nucleus: Nucleus, sites: int) -> Nucleus:
    """Return the nucleus with a pattern that a breather in a chain of this length can have."""
    nucleus.first(sites)  # refuses a nucleus wider than the chain before its pattern is checked
    at_edge = nucleus.place is Place.EDGE and nucleus.size != sites
    if nucleus.size > 2 and nucleus.in_phase and at_edge:
        raise ParameterError(
            "pattern", repr(nucleus.pattern), "one of a breather at an edge", "name one with + or -"
        )
    return nucleus.relaxed(sites)


def _check_length(chain: VanDerPolChain, method: BreatherMethod) -> None:
    if chain.sites > MAX_SITES[method]:
        raise ParameterError(
            "number of sites n", chain.sites, f"at most {MAX_SITES[method]} for {method}",
            "take fewer: a breather needs only a few sites",
        )  # fmt: skip


def _applies(method: BreatherMethod, chain: VanDerPolChain, nucleus: Nucleus) -> bool:
    if method is BreatherMethod.CLOSED_FORM:
        return has_closed_form(nucleus, chain.sites)
    return method is not BreatherMethod.ORBIT or isinstance(chain, VdpChain)


def _closed_form(chain: VanDerPolChain, nucleus: Nucleus, choice: _Choice) -> Breather:
    check_closed_form(nucleus, chain.sites)
    full = chain.full()
    found = solve_breather(full, choice.reading)
    fold = found.fold
    if fold is None or found.alpha_0 is None:
        return Breather(
            chain=chain,
            nucleus=nucleus,
            method=BreatherMethod.CLOSED_FORM,
            status=BreatherStatus.NONE,
            fold=None if fold is None else fold.c,
            fold_error=None if fold is None else fold.error,
            seconds=found.seconds,
        )
    odd = replace(full, sites=min(chain.sites + (chain.sites + 1) % 2, 31))
    try:
        stability: BreatherStability | None = approximate_multipliers(odd, found)
    except ParameterError:
        stability = None  # too stiff: the stability remains undecided
    distance = np.abs(np.arange(chain.sites) - nucleus.outward(chain.sites))
    amplitudes = found.amplitudes(chain.sites)[distance]
    own = Breather(
        chain=chain,
        nucleus=nucleus,
        method=BreatherMethod.CLOSED_FORM,
        status=BreatherStatus.EXISTS,
        amplitudes=amplitudes,
        waves=np.asarray(amplitudes * np.exp(1j * found.phase_step * distance), dtype=complex),
        frequency=found.frequency,
        error=found.error * found.alpha_0,
        frequency_error=0.0,
        residual=found.residual,
        decay=found.decay,
        decay_error=None if found.decay is None else found.error * found.decay,
        fold=fold.c,
        fold_error=fold.error,
        stability=stability,
        seconds=found.seconds,
    )
    return _compared(own, chain)


def _envelope(chain: VanDerPolChain, nucleus: Nucleus, choice: _Choice) -> Breather:
    found = solve_envelope_breather(chain, nucleus)
    if isinstance(chain, AveragedChain) or found.frequency is None:
        return found
    return _compared(found, chain)


def _orbit(chain: VanDerPolChain, nucleus: Nucleus, choice: _Choice) -> Breather:
    if not isinstance(chain, VdpChain):
        raise ParameterError(
            "method", "orbit", "envelope, closed-form or simulation for the averaged chain",
            "take one of them, or the orbit of chain.full()",
        )  # fmt: skip
    return solve_orbit(chain, nucleus)


def _simulation(chain: VanDerPolChain, nucleus: Nucleus, choice: _Choice) -> Breather:
    if isinstance(chain, VdpChain):
        found = run_breather(chain, nucleus, seed=choice.seed)
    else:
        found = run_averaged_breather(chain, nucleus, seed=choice.seed)
    if found.status is BreatherStatus.SETTLED:
        settled = nucleus.found_in(found.waves, chain.unstable_amplitude)
        if settled is None:
            (sites,) = np.nonzero(np.abs(found.waves) > chain.unstable_amplitude)
            listed = ", ".join(str(site + 1) for site in sites.tolist())
            why = f"the run settled on another nucleus than the given one, of the sites {listed}"
            return replace(found, error_unknown=why)
        if settled != nucleus:
            found = _renamed(found, settled)
        # A run has no equation for its frequency.
        exact = _compared(replace(found, error=0.0, frequency_error=0.0), chain)
        why = found.error_unknown or exact.error_unknown
        return replace(found, frequency_error=exact.frequency_error, error_unknown=why)
    if found.status is not BreatherStatus.ESCAPED:
        return found
    fold, error = _fold_below(chain, nucleus)
    return Breather(
        chain=chain,
        nucleus=nucleus,
        method=found.method,
        status=BreatherStatus.ESCAPED if fold is None else BreatherStatus.NONE,
        fold=fold,
        fold_error=error,
        time=found.time,
        seconds=found.seconds,
    )


def _renamed(found: Breather, nucleus: Nucleus) -> Breather:
    """Return a settled run under the name of the nucleus on which it has settled."""
    centre = nucleus.outward(found.chain.sites)
    error = found.error
    wave_error = None if error is None else wave_error_of(error, found.waves, centre)
    return replace(found, nucleus=nucleus, wave_error=wave_error)


def _compared(found: Breather, chain: VanDerPolChain) -> Breather:
    """Return a breather of another equation with its errors relative to the chain itself.

    Its errors so far are those of a solution of that other equation. They are replaced by the
    distance from a solution of the chain itself, plus the errors of the latter.
    """
    unknown = replace(found, error=None, frequency_error=None, wave_error=None, growth_error=None)
    short = replace(chain, sites=min(chain.sites, found.nucleus.size + REST))
    try:
        exact = own_family(short, found.nucleus).solve()
    except (ParameterError, NotConvergedError) as refusal:
        return replace(unknown, error_unknown=str(refusal))
    if exact.frequency is None or exact.error is None or exact.frequency_error is None:
        missing = (
            "(8) has no such orbit" if isinstance(chain, VdpChain) else "(43) has no such breather"
        )
        why = f"{missing} at this coupling"
        return replace(unknown, error_unknown=why)
    assert found.frequency is not None  # since the breather exists
    assert found.error is not None
    assert found.frequency_error is not None
    amplitude_distance = float(_distances(found, exact, found.amplitudes, exact.amplitudes).max())
    frequency_distance = abs(found.frequency - exact.frequency)
    return replace(
        found,
        error=amplitude_distance + exact.error + found.error,
        frequency_error=frequency_distance + (exact.frequency_error + found.frequency_error),
        wave_error=_wave_distances(found, exact)
        + (0.0 if exact.wave_error is None else exact.wave_error)
        + wave_error_of(found.error, found.waves, found.nucleus.outward(found.chain.sites)),
        growth_error=_growth_distance(found, exact),
    )


def _growth_distance(found: Breather, exact: Breather) -> float | None:
    """Return the distance of a growth rate from the exact one plus both errors, if known."""
    if found.growth is None or exact.growth is None or exact.growth_error is None:
        return None
    return abs(found.growth - exact.growth) + exact.growth_error + (found.growth_error or 0.0)


def _wave_distances(found: Breather, exact: Breather) -> FloatArray:
    """Return the distance of each wave from the exact one, both real at the centre."""

    def rotated(each: Breather) -> ComplexArray:
        centre = each.nucleus.outward(each.chain.sites)
        return np.asarray(each.waves / np.exp(1j * np.angle(each.waves[centre])), dtype=complex)

    return _distances(found, exact, rotated(found), rotated(exact))


def _distances(found: Breather, exact: Breather, ours: AnyArray, true: AnyArray) -> FloatArray:
    """Return the distance of the value of each site from the exact one, on both sides.

    Sites beyond the end of the exact chain count with their whole amplitude.
    """
    centre, other = (each.nucleus.outward(each.chain.sites) for each in (found, exact))
    left, right = min(centre, other), min(ours.size - centre, true.size - other)
    distances: FloatArray = np.abs(ours)
    overlap = slice(centre - left, centre + right)
    distances[overlap] = np.abs(ours[overlap] - true[other - left : other + right])
    return distances


def _fold_below(chain: VanDerPolChain, nucleus: Nucleus) -> tuple[float | None, float | None]:
    """Return the fold of the chain's own breathers if it is known to lie below c.

    A run does not yield a fold. The chain used for the orbits is short, since a breather needs only
    a few sites.
    """
    try:
        fold = breather_threshold(chain, nucleus, ThresholdMethod(own_method(chain)))
    except (ParameterError, NotConvergedError):
        return None, None
    return (fold.c_crit, fold.error) if chain.c > fold.c_crit + fold.error else (None, None)


_METHODS: dict[BreatherMethod, Callable[[VanDerPolChain, Nucleus, _Choice], Breather]] = {
    BreatherMethod.CLOSED_FORM: _closed_form,
    BreatherMethod.ENVELOPE: _envelope,
    BreatherMethod.ORBIT: _orbit,
    BreatherMethod.SIMULATION: _simulation,
}
