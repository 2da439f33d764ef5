"""``threshold``: the coupling at which a nucleus of any chain stops being localised."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from inspect import signature

from theory.averaged.breather import Reading, check_closed_form, closed_form_fold
from theory.chains.chain import Chain
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import (
    ParameterError,
    Range,
    check_progress,
    need_instance,
    random_seed,
    refuse_unread,
    with_ranges,
    within,
    word,
)
from verification.runs.excite import StartPoint
from verification.thresholds.continuation import breather_threshold
from verification.thresholds.escape import escape_range
from verification.thresholds.preparation import NucleusPreparation
from verification.thresholds.result import (
    BranchThreshold,
    Definition,
    Mechanism,
    Threshold,
    ThresholdMethod,
)
from verification.thresholds.slow_sweep import sweep_threshold
from verification.thresholds.spreading import Spreading, spreading_threshold

MAX_NUCLEUS = 41
"""Largest nucleus whose breather is followed; the matrices are dense."""
NOISE = Range(0.0, 0.1)
"""Range of the standard deviation of the noise on the start."""
SWEPT_ETA = Range(1e-3, 0.125)
"""Range of η of the methods sweep and hold, whose steps become shorter in proportion to η."""
_OF_BREATHERS = (Definition.EXISTENCE, Definition.STABILITY)
_DEFINITIONS = {
    ThresholdMethod.ENVELOPE: _OF_BREATHERS,
    ThresholdMethod.ORBIT: _OF_BREATHERS,
    ThresholdMethod.CLOSED_FORM: (Definition.EXISTENCE,),
    ThresholdMethod.SWEEP: (Definition.EXISTENCE,),
    ThresholdMethod.HOLD: (Definition.FIRST,),
    ThresholdMethod.BISECTION: (Definition.FIRST, Definition.SEVERAL, Definition.WHOLE),
}
"""Definitions of the threshold that each method can evaluate, the default first."""
_METHODS: dict[type, tuple[ThresholdMethod, ...]] = {
    AveragedChain: tuple(ThresholdMethod),
    VdpChain: (
        ThresholdMethod.ORBIT,
        *(each for each in ThresholdMethod if each is not ThresholdMethod.ORBIT),
    ),
    OscillatorChain: (ThresholdMethod.BISECTION, ThresholdMethod.ORBIT),
    Chain: (ThresholdMethod.BISECTION,),
}
"""Methods that apply to each class of chain, the default first."""
_OF_NOISE = ("perturbation", "seed")
_OPTIONS = {
    ThresholdMethod.SWEEP: _OF_NOISE,
    ThresholdMethod.HOLD: _OF_NOISE,
    ThresholdMethod.BISECTION: (
        "final_time", "lowest", "highest", "accuracy", "tests", "displacement", "start_point",
    ),
}  # fmt: skip
"""Options that apply to each method; continuation and the closed form have none."""


@with_ranges(noise=NOISE.high, swept=SWEPT_ETA.low)
def threshold(  # noqa: PLR0913  (all but two by name; what belongs to which method is said)
    chain: Chain,
    nucleus: Nucleus = Nucleus(1),  # noqa: B008  (frozen)
    *,
    method: ThresholdMethod | str | None = None,
    definition: Definition | str | None = None,
    final_time: float = 1000.0,
    lowest: float = 1e-3,
    highest: float = 0.5,
    accuracy: float = 1e-6,
    tests: int = 12,
    displacement: float | None = None,
    start_point: StartPoint | None = None,
    perturbation: float = 0.0,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> Threshold:
    """Find the coupling at which a nucleus stops being localised (Figs. 4, 11).

    Couplings are dimensionless. Equations (34) and (42) decide existence and stability of
    breathers; runs of (5), (8) or (43) decide whether a nucleus spreads.

    Parameters
    ----------
    chain : Chain
        A chain of any model with a coupling c; the value of c is not used.
    nucleus : Nucleus, optional
        Excited sites, their phase steps, and their place in the chain.
    method : ThresholdMethod or str, optional
        ``envelope`` (default for an `AveragedChain`) and ``orbit`` (default for a `VdpChain`;
        possible for an `OscillatorChain`): continuation of the breather to its fold.
        ``closed-form``: fold of (29) with (37). ``sweep`` and ``hold``: runs of (43) from an
        in-phase start, for η from {swept}; if a sweep shows no escape at a fold, ``hold`` is used
        instead.
        ``bisection`` (default for any other chain): bisection between runs of the chain itself that
        spread and runs that do not.
    definition : Definition or str, optional
        For continuation, ``existence`` (default) or ``stability`` of the breather; for bisection,
        ``first`` (default), ``several`` or ``whole``. The closed form and sweeps find only
        ``existence``, ``hold`` only ``first``.
    final_time : float, optional
        Bisection: time by which the nucleus must have spread: slow time εt, or τ for the friction
        chain.
    lowest : float, optional
        Bisection: smallest coupling of the search.
    highest : float, optional
        Bisection: largest coupling of the search.
    accuracy : float, optional
        Bisection: final width of the bracket.
    tests : int, optional
        Bisection: number of couplings tested for monotonicity on each side of the threshold.
    displacement : float, optional
        Bisection: displacement of the excited sites; by default the excited state of one cell.
    start_point : StartPoint, optional
        Bisection of a friction chain: point on the cycle from which excited sites start; by default
        the maximum.
    perturbation : float, optional
        Sweep, hold: standard deviation of the noise on the start, up to {noise}.
    seed : int, optional
        Sweep, hold: first seed of the noise.
    progress : callable, optional
        Bisection and continuation: called with the fraction done.

    Returns
    -------
    Threshold
        `BranchThreshold` for continuation, `RunThreshold` for runs.

    Raises
    ------
    ParameterError
        If the method or the definition does not apply to this chain, an option belongs to another
        method, or no threshold is found in the range.

    References
    ----------
    Keller (1977), for continuation through a fold; Berglund and Gentz (2006), for the delay when a
    fold is passed slowly.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> found = threshold(AveragedChain(a=2.5, b=0.5, c=0))
    >>> round(found.c_crit, 6), found.mechanism.value, found.lost_by.value
    (0.190788, 'fold', 'symmetry-breaking')
    >>> from theory.chains.friction import FrictionChain
    >>> edge = Nucleus(1, place="edge")
    >>> found = threshold(FrictionChain(c=0), edge, accuracy=1e-4, tests=0)
    >>> found.low < 0.01056 < found.high
    True
    """
    need_instance("chain", chain, (Chain,), "give one, as VdpChain(a=4, b=0.5, c=0.6)")
    need_instance("nucleus", nucleus, (Nucleus,), "give one, as Nucleus(3)")
    check_progress(progress)
    how = _method(chain, method)
    what = _definition(how, definition)
    given = {
        "final_time": final_time, "lowest": lowest, "highest": highest, "accuracy": accuracy,
        "tests": tests, "displacement": displacement, "start_point": start_point,
        "perturbation": perturbation, "seed": seed,
    }  # fmt: skip
    usual = {name: each.default for name, each in signature(threshold).parameters.items()}
    refuse_unread(given, usual, _OPTIONS.get(how, ()), f"with the method {how}")
    if how is ThresholdMethod.BISECTION:
        spreading = Spreading(
            nucleus.size, nucleus.place, what, final_time, pattern=nucleus.pattern,
            displacement=displacement, point=_start_point(chain, start_point, displacement),
        )  # fmt: skip
        return spreading_threshold(
            chain, spreading, lowest=lowest, highest=highest, accuracy=accuracy, tests=tests,
            progress=progress,
        )  # fmt: skip
    if nucleus.size > MAX_NUCLEUS:
        raise ParameterError("nucleus", nucleus.size, f"at most {MAX_NUCLEUS} sites", "excite less")
    assert isinstance(chain, VanDerPolChain | OscillatorChain)
    _ = chain.stable_amplitude
    if how in (ThresholdMethod.ENVELOPE, ThresholdMethod.ORBIT):
        end = breather_threshold(chain, nucleus.relaxed(chain.sites), how, progress=progress)
        return end if what is Definition.EXISTENCE else _of_stability(end)
    assert isinstance(chain, VanDerPolChain)
    if how is ThresholdMethod.CLOSED_FORM:
        return closed_form_threshold(chain, nucleus)
    found = _by_runs_of_43(chain, nucleus, how, perturbation, seed)
    if definition is not None and found.definition is not what:
        raise ParameterError(
            "definition", what.value, "first: the nucleus does not escape at a fold",
            "leave it out, or take the method hold",
        )  # fmt: skip
    return found


def closed_form_threshold(chain: VanDerPolChain, nucleus: Nucleus) -> Threshold:
    """Return the fold of (29) with (37) at the neighbour, and those of the other readings.

    Raises
    ------
    ParameterError
        If the nucleus is not one site in the bulk: (9) has one centre, with two neighbours.
    """
    started = time.perf_counter()
    check_closed_form(nucleus, chain.sites)
    fold, tail = closed_form_fold(chain), closed_form_fold(chain, Reading.TAIL)
    return Threshold(
        c_crit=fold.c,
        error=fold.error,
        method=ThresholdMethod.CLOSED_FORM,
        definition=Definition.EXISTENCE,
        mechanism=Mechanism.FOLD,
        model=chain.model,
        nucleus=nucleus,
        readings={
            Reading.CENTRE.value: None,
            Reading.NEIGHBOUR.value: fold.c,
            Reading.TAIL.value: tail.c,
        },
        readings_error={
            Reading.CENTRE.value: None,
            Reading.NEIGHBOUR.value: fold.error,
            Reading.TAIL.value: tail.error,
        },
        seconds=time.perf_counter() - started,
    )


def _start_point(chain: Chain, point: StartPoint | None, displacement: float | None) -> StartPoint:
    if point is None:
        return StartPoint.MAXIMUM
    if displacement is not None or not isinstance(chain, FrictionChain):
        raise ParameterError(
            "start point", str(point), "absent with a displacement, and for chains other than "
            "the friction chain", "leave it out",
        )  # fmt: skip
    return StartPoint(point)


def choices(kind: type) -> dict[str, tuple[tuple[str, ...], str]]:
    """Return words and help of the options ``method`` and ``definition`` for a class of chain.

    Examples
    --------
    >>> words, help = choices(FrictionChain)["definition"]
    >>> words, help.split(".")[0]
    (('first', 'several', 'whole'), 'first (default), several or whole')
    """
    methods = methods_of(kind)
    by_definitions: dict[tuple[Definition, ...], list[str]] = {}
    for each in methods:
        by_definitions.setdefault(_DEFINITIONS[each], []).append(each.value)
    texts = [
        f"{' and '.join(names)}: {_listed(words)}" if len(methods) > 1 else _listed(words)
        for words, names in by_definitions.items()
    ]
    defined = tuple(each for each in Definition if any(each in d for d in by_definitions))
    explained = (f"{each}: {each.sentence}" for each in methods[1:])
    return {
        "method": (
            tuple(each.value for each in methods),
            " ".join((f"{methods[0]} (default): {methods[0].sentence}", *explained)),
        ),
        "definition": (
            tuple(each.value for each in defined),
            " ".join((f"{'; '.join(texts)}.", *(f"{each}: {each.sentence}" for each in defined))),
        ),
    }


def _listed(words: Sequence[str]) -> str:
    """Return words as a list in which the first one is the default."""
    if len(words) == 1:
        return str(words[0])
    first, *others = words
    return f"{', '.join((f'{first} (default)', *others[:-1]))} or {others[-1]}"


def methods_of(kind: type) -> tuple[ThresholdMethod, ...]:
    """Return the methods that apply to a class of chain, the default first."""
    return next(methods for known, methods in _METHODS.items() if issubclass(kind, known))


def _method(chain: Chain, method: ThresholdMethod | str | None) -> ThresholdMethod:
    own = methods_of(type(chain))
    if method is None:
        return own[0]
    how = ThresholdMethod(word("method", method, [each.value for each in ThresholdMethod]))
    if how not in own:
        raise ParameterError(
            "method", how.value, f"{' or '.join(own)} for the model {chain.model}",
            "take it, or a chain that has breathers of (8) or (43)",
        )  # fmt: skip
    return how


def _definition(method: ThresholdMethod, definition: Definition | str | None) -> Definition:
    allowed = _DEFINITIONS[method]
    if definition is None:
        return allowed[0]
    words = [each.value for each in allowed]
    name, remedy = f"definition for the method {method}", "leave it out, or take another method"
    return Definition(word(name, definition, words, remedy))


def _by_runs_of_43(
    chain: VanDerPolChain, nucleus: Nucleus, how: ThresholdMethod, noise: float, seed: int
) -> Threshold:
    if not nucleus.in_phase:
        raise ParameterError(
            "pattern", repr(nucleus.pattern), f"in phase for the method {how}", "leave it out"
        )
    within("eta = b/a^2", chain.eta, *SWEPT_ETA, "take the method envelope at smaller eta")
    within("perturbation", noise, *NOISE)
    first = random_seed(seed)
    preparation = NucleusPreparation(nucleus.size, nucleus.place, noise, first)
    if how is ThresholdMethod.HOLD:
        return escape_range(chain, preparation)
    return sweep_threshold(chain, preparation)


def _of_stability(found: BranchThreshold) -> Threshold:
    if found.stable_to is None or found.stable_to_error is None:
        raise ParameterError(
            "pattern", repr(found.nucleus.pattern), "one that is stable at some coupling",
            "name another, or ask for its existence",
        )  # fmt: skip
    return replace(
        found,
        c_crit=found.stable_to,
        error=found.stable_to_error,
        definition=Definition.STABILITY,
        mechanism=found.lost_by,
    )
