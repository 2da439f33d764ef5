"""The coupling at which a nucleus stops being localised, of any chain that has one.

The public function `fronts.threshold`: continuation, closed form, slow sweeps or runs, by the chain
and the method that is named.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from theory.chains.chain import Chain
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, outward_pattern
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError, RunError, within
from verification.thresholds.result import (
    Definition,
    Mechanism,
    RunThreshold,
    Threshold,
    ThresholdMethod,
)

if TYPE_CHECKING:
    from verification.thresholds.preparation import Preparation

Method = Literal["envelope", "orbit", "sweep", "closed-form"]

MAX_NUCLEUS = 41


@dataclass(frozen=True, kw_only=True)
class SpreadingThreshold(RunThreshold):
    """The threshold of a friction chain, with what it is a threshold of.

    Attributes
    ----------
    ends : str
        Ends of the chain.
    start_point : str
        Point of the cycle from which the excited sites started.
    """

    ends: str
    start_point: str


def threshold(
    chain: Chain,
    nucleus: Nucleus = Nucleus(size=1),  # noqa: B008  (frozen)
    *,
    method: Literal["envelope", "orbit", "sweep", "closed-form"] = "envelope",
    perturbation: float = 0.0,
    seed: int = 0,
    definition: Literal["first", "several", "whole"] = "first",
    final_time: float = 1000.0,
    start_point: Literal["maximum", "minimum"] = "maximum",
    accuracy: float = 1e-6,
    c_min: float = 1e-3,
    c_max: float = 0.5,
    progress: Callable[[float], None] | None = None,
) -> Threshold:
    """Return the coupling from which on a nucleus spreads, or up to which its breather exists.

    Parameters
    ----------
    chain : VdpChain, AveragedChain or FrictionChain
        Its coupling is not used; of a Van der Pol chain neither is its length.
    nucleus : Nucleus, optional
        Size, pattern and place; by default one site in the middle. Three or more sites in phase are
        taken, where their breather is followed, as what an in-phase start relaxes to.
    method : {"envelope", "orbit", "sweep", "closed-form"}, optional
        Van der Pol chains. envelope: continuation of the averaged breather as ε tends to 0; orbit:
        continuation of the periodic orbit of (8); sweep: slow growth of c from an in-phase start,
        extrapolated to rate zero, or c held and bisected where that has no limit; closed-form:
        (29), (37).
    perturbation : float, optional
        Van der Pol chains, sweep: noise on the start; c is then held, not swept.
    seed : int, optional
        Van der Pol chains, sweep: first of three seeds of the noise.
    definition : {"first", "several", "whole"}, optional
        Friction: what counts as spreading: one new site sticks, three on each side, all sites.
    final_time : float, optional
        Friction: τ by which it must have happened, from 1 to 1e6.
    start_point : {"maximum", "minimum"}, optional
        Friction: point of the cycle from which excited sites start.
    accuracy : float, optional
        Friction: width of the bracket.
    c_min : float, optional
        Friction: lowest coupling tried.
    c_max : float, optional
        Friction: highest coupling tried.
    progress : callable, optional
        Called with the fraction done, as far as it can be foreseen.

    Returns
    -------
    Threshold
        The coupling ``c``, its ``error``, the ``mechanism``; more by the way it was found.

    Raises
    ------
    ParameterError
        If a parameter is out of range, the model has no such threshold, or none lies between
        ``c_min`` and ``c_max``.

    References
    ----------
    Keller, H. B. (1977), in Applications of Bifurcation Theory, p. 359: pseudo-arclength
    continuation. Jung, P., Gray, G., Roy, R. & Mandel, P. (1990), Phys. Rev. Lett. 65, 1873: the
    delay at a fold grows like rate^(2/3).

    Examples
    --------
    >>> import fronts as fr
    >>> found = fr.threshold(fr.VdpChain(a=2.5, b=0.5, c=0), fr.Nucleus(1))
    >>> round(found.c, 6), found.mechanism.value
    (0.190788, 'fold')
    """
    if isinstance(chain, FrictionChain):
        return _spreading(
            chain, nucleus, Definition(definition), final_time, start_point,
            lowest=c_min, highest=c_max, accuracy=accuracy, progress=progress,
        )  # fmt: skip
    if not isinstance(chain, VanDerPolChain):
        raise ParameterError(
            "model", chain.model, "vdp, averaged or friction", "take one of these chains"
        )
    if nucleus.size > MAX_NUCLEUS:
        raise ParameterError("nucleus", nucleus.size, f"at most {MAX_NUCLEUS} sites", "take fewer")
    _ = chain.stable_amplitude
    if method == "sweep":
        return _sweep(chain, nucleus, perturbation, seed)
    if method == "closed-form":
        return _closed_form(chain, nucleus)
    from verification.thresholds.continuation import breather_threshold

    words = ("envelope", "orbit", "sweep", "closed-form")
    if method not in words:
        raise ParameterError("method", method, f"one of {', '.join(words)}", "choose one")
    return breather_threshold(chain, _relaxed(nucleus), ThresholdMethod(method))


def _relaxed(nucleus: Nucleus) -> Nucleus:
    """Return the nucleus with the pattern that an in-phase start of it relaxes to."""
    if nucleus.size < 3 or set(nucleus.pattern) != {"0"}:
        return nucleus
    return Nucleus(nucleus.size, outward_pattern(nucleus.size), nucleus.place)


def _spreading(
    chain: FrictionChain,
    nucleus: Nucleus,
    definition: Definition,
    final_time: float,
    start_point: str,
    **search: Any,
) -> SpreadingThreshold:
    from verification.runs.friction_start import StartPoint
    from verification.thresholds.spreading import Spreading, friction_threshold

    if set(nucleus.pattern) - {"0"}:
        raise ParameterError(
            "pattern", nucleus.pattern, "absent for the friction chain, whose sites start in phase",
            "leave it out",
        )  # fmt: skip
    spreading = Spreading(
        nucleus.size, nucleus.place, definition, final_time, StartPoint(start_point)
    )
    found = friction_threshold(chain, spreading, **search)
    values = {each.name: getattr(found, each.name) for each in dataclasses.fields(found)}
    return SpreadingThreshold(**values, ends=str(chain.ends.value), start_point=start_point)


def _sweep(chain: VanDerPolChain, nucleus: Nucleus, perturbation: float, seed: int) -> Threshold:
    from verification.thresholds.preparation import Preparation
    from verification.thresholds.slow_sweep import measure_delay

    if set(nucleus.pattern) - {"0"}:
        raise ParameterError(
            "pattern", nucleus.pattern, "absent for a sweep, which starts in phase", "leave it out"
        )
    within("perturbation", perturbation, 0.0, 0.1)
    preparation = Preparation(nucleus.size, nucleus.place, perturbation, seed)
    if perturbation > 0.0:
        return _held(chain, preparation)
    found = measure_delay(chain, preparation)
    if found.c_0 is None or found.error is None:
        # What does not escape at a fold has no limit of rate zero that these sweeps could show.
        held = _held(chain, preparation)
        return dataclasses.replace(held, delay=found, seconds=held.seconds + found.seconds)
    return Threshold(
        c=found.c_0,
        error=found.error,
        method=ThresholdMethod.SWEEP,
        definition=Definition.FIRST,
        mechanism=Mechanism.SLOW_SWEEP,
        model="averaged",
        nucleus=nucleus,
        sites=preparation.chain(chain, 0.0).sites,
        delay=found,
        seconds=found.seconds,
    )


def _held(chain: VanDerPolChain, preparation: Preparation) -> RunThreshold:
    from verification.thresholds.escape import escape_range

    return escape_range(chain, preparation)


def _closed_form(chain: VanDerPolChain, nucleus: Nucleus) -> Threshold:
    from theory.averaged.breather import Reading, closed_form_fold
    from verification.breathers.breather import has_closed_form

    if not has_closed_form(nucleus):
        raise ParameterError(
            "nucleus", nucleus.size, "one site in the bulk: (9) has one centre",
            "take the method envelope or orbit",
        )  # fmt: skip
    started = time.perf_counter()
    folds = {reading.value: closed_form_fold(chain, reading).c for reading in Reading}
    fold = closed_form_fold(chain)
    if fold.c is None:
        raise RunError("(29) and (37) have no fold at these parameters: take the method envelope.")
    return Threshold(
        c=fold.c,
        error=fold.error,
        method=ThresholdMethod.CLOSED_FORM,
        definition=Definition.EXISTENCE,
        mechanism=Mechanism.FOLD,
        model=chain.model,
        nucleus=nucleus,
        readings=folds,
        seconds=time.perf_counter() - started,
    )
