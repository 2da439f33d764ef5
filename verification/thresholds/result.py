"""Results for a threshold: the coupling, its definition, and what happens there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from theory.chains.ends import Ends
from theory.chains.nucleus import Nucleus
from theory.result import Result
from theory.status import Status
from verification.runs.excite import StartPoint


class ThresholdMethod(Status):
    """Method by which a threshold is found."""

    ENVELOPE = "envelope", "continuation of the breather of the averaged chain (43), ε → 0."
    ORBIT = "orbit", "continuation of the periodic orbit of the chain itself."
    CLOSED_FORM = "closed-form", "the largest coupling at which (29) and (37) have a solution."
    SWEEP = (
        "sweep",
        "slow growth of the coupling from an in-phase start, extrapolated to rate zero (hold, if "
        "there is no escape at a fold).",
    )
    HOLD = "hold", "runs of (43) with the coupling held, over seeds of noise."
    BISECTION = "bisection", "bisection between runs of the chain that spread and that do not."


_AVERAGED = "the averaged chain (43), the limit eps -> 0 of (8)"
_EQUATIONS = {
    ThresholdMethod.ENVELOPE: _AVERAGED,
    ThresholdMethod.SWEEP: _AVERAGED,
    ThresholdMethod.HOLD: _AVERAGED,
    ThresholdMethod.CLOSED_FORM: "(29) with (37), an approximation of the averaged chain (43)",
}
"""The equation to which a method's threshold refers, where it is not that of its model."""


class Definition(Status):
    """Definition of a threshold."""

    EXISTENCE = "existence", "up to it the breather exists."
    STABILITY = "stability", "up to it the breather is stable against every small perturbation."
    FIRST = "first", "from it on a new site is reached by the final time."
    SEVERAL = (
        "several", "from it on three new sites are reached on each side of the nucleus.",
    )  # fmt: skip
    WHOLE = "whole", "from it on every site is reached by the final time."


class Mechanism(Status):
    """How a nucleus stops being localised, or a breather stops being stable."""

    FOLD = "fold", "it ends in a fold: it meets its unstable partner and neither exists beyond."
    SYMMETRY_BREAKING = (
        "symmetry-breaking",
        "before its fold it becomes unstable to a mode that breaks mirror symmetry.",
    )
    REAL_EXPONENT = "real exponent", "before its fold a real exponent becomes positive."
    COMPLEX_EXPONENTS = (
        "complex exponents",
        "before its fold a pair of complex exponents acquires a positive real part.",
    )
    NEVER_STABLE = "never stable", "it is stable at no coupling on its branch."
    SPREADING = "spreading by the final time", "new sites are reached by the final time."
    SLOW_SWEEP = (
        "escape in a slow sweep",
        "the nucleus escapes while the coupling grows; the limit of rate zero is stated.",
    )
    HELD = "escape while c is held", "the nucleus escapes while the coupling is held."


@dataclass(frozen=True, kw_only=True)
class Threshold(Result):
    """The coupling at which a nucleus stops being localised; dimensionless.

    Attributes
    ----------
    c_crit, error : float
        The coupling, and a bound on its error or half the width of the interval that contains it.
        It is the error with respect to ``equation``; the difference from (8) at ε > 0 is not
        included. Method ``hold``: it extends to where escapes end if the nucleus is held for longer
        than ``final_time``, an estimate from the times of escape and from runs of twice that time;
        escapes from an irregular motion may come later still, and other seeds may lie outside.
    method : ThresholdMethod
        How it was found.
    definition : Definition
        Definition of the threshold.
    mechanism : Mechanism
        What happens there.
    model : str
        Name of the chain's model.
    nucleus : Nucleus
        Size, pattern and place of the nucleus; of runs, that of the start, which may change before
        it escapes or spreads.
    sites : int or None
        Length of the chain; None if it is infinite.
    readings, readings_error : mapping of str to float or None, or None
        Closed form: the fold for each site at which (37) may be evaluated, and its error.
    delay : Delay or None
        Sweeps: couplings of escape at each rate, and the law of the delay.
    seconds : float
        Wall-clock time.
    """

    derived: ClassVar[tuple[str, ...]] = ("equation",)
    in_columns: ClassVar[tuple[str, ...]] = ("readings_error",)

    c_crit: float
    error: float
    method: ThresholdMethod
    definition: Definition
    mechanism: Mechanism
    model: str
    nucleus: Nucleus
    sites: int | None = None
    readings: Mapping[str, float | None] | None = None
    readings_error: Mapping[str, float | None] | None = None
    delay: Delay | None = None
    seconds: float

    @property
    def equation(self) -> str:
        """Equation to which the threshold refers; its difference from (8) is not in the error."""
        averaged = _EQUATIONS.get(self.method)
        if averaged is None:
            return f"that of the model {self.model} itself"
        return f"{averaged}; how far (8) is from it is not in the error"

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON."""
        found = {"pattern": self.nucleus.pattern, "place": str(self.nucleus.place)}
        found |= super().to_dict()
        if self.delay is not None:
            law = self.delay.to_dict()
            found |= {name: law[name] for name in ("rates", "escapes", "delay_exponent")}
        return found

    def row(self) -> dict[str, Any]:
        """Return the entries of one table row, with one for each site at which (37) is read."""
        cells = super().row()
        for name, ending in (("readings", ""), ("readings_error", "_error")):
            of = cells.pop(name) or {}
            cells |= {f"readings_{site}{ending}": value for site, value in of.items()}
        return cells


@dataclass(frozen=True, kw_only=True)
class BranchThreshold(Threshold):
    """A threshold on a branch of breathers that was followed to its fold.

    Attributes
    ----------
    stable_to : float or None
        Coupling up to which the breather is stable against every small perturbation; None if it
        never is.
    stable_to_error : float or None
        Bound on the error of ``stable_to`` from the finite number of sites at rest and from the
        errors of the growth rate; None if ``stable_to`` is None.
    lost_by : Mechanism
        Mechanism of instability: at the fold itself, before it, or never stable.
    growth_half_way, growth_half_way_error : float
        Largest growth rate per unit of slow time, without the trivial mode, at half of ``c_crit``,
        and its error.
    growth_half_way_mirrored, growth_half_way_mirrored_error : float or None
        The same for perturbations that keep the mirror symmetry; None if there is none.
    """

    stable_to: float | None
    stable_to_error: float | None
    lost_by: Mechanism
    growth_half_way: float
    growth_half_way_error: float
    growth_half_way_mirrored: float | None
    growth_half_way_mirrored_error: float | None


@dataclass(frozen=True, kw_only=True)
class RunThreshold(Threshold):
    """A threshold between runs of the chain at neighbouring couplings.

    Attributes
    ----------
    low, high : float
        Couplings at which the nucleus stays localised and at which it does not.
    final_time : float
        Maximum duration of a run in units of the chain's `time_unit`: τ for (5), slow time for (8)
        and (43).
    monotone : bool or None
        Whether escape or spreading was monotone in c among the couplings tested; None if this was
        not tested.
    c_crit_at_twice_the_time, c_crit_at_twice_the_time_error : float or None
        The threshold for twice the final time and its error, if that was tested.
    fuzzy : tuple of float or None
        Interval around ``c_crit`` in which runs contradict a single sharp threshold, because
        spreading takes longer than the final time or is not monotone in c. None if there is no such
        interval.
    perturbation : float
        Standard deviation of the noise on the start.
    range_by_seed : mapping of int to (float, float)
        The interval for each seed of the noise.
    runs : int
        Number of runs.
    ends : Ends or None
        Ends of the chain; None for runs of (43) from an in-phase start.
    start_point : StartPoint or None
        Point on the cycle of a friction chain from which the excited sites started.
    """

    derived: ClassVar[tuple[str, ...]] = ("equation", "bracket", "fuzzy_width")

    low: float
    high: float
    final_time: float
    monotone: bool | None = None
    c_crit_at_twice_the_time: float | None = None
    c_crit_at_twice_the_time_error: float | None = None
    fuzzy: tuple[float, float] | None = None
    perturbation: float = 0.0
    range_by_seed: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    runs: int
    ends: Ends | None = None
    start_point: StartPoint | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON."""
        found = super().to_dict()
        if self.method is ThresholdMethod.HOLD:
            found |= {"range": list(self.bracket), "waiting_time": self.final_time}
        return found

    @property
    def bracket(self) -> tuple[float, float]:
        """(low, high)."""
        return self.low, self.high

    @property
    def fuzzy_width(self) -> float:
        """Width of the fuzzy interval; 0 if there is none."""
        return 0.0 if self.fuzzy is None else self.fuzzy[1] - self.fuzzy[0]


@dataclass(frozen=True, kw_only=True)
class Delay(Result):
    """Couplings of escape in slow sweeps, and the law of the delay fitted to them.

    Attributes
    ----------
    rates : tuple of float
        dc/dT, in descending order.
    escapes : tuple of float
        c at which the nucleus escaped, for each rate; too large by up to 0.1 of the rate, the step
        in slow time; apart from this no error is known.
    c_0 : float or None
        Extrapolation to zero rate by c_0 + K rate^{2/3} + K' rate through the three slowest sweeps;
        None if the escapes do not follow this law.
    error : float or None
        Difference from the extrapolation without K' through the two slowest sweeps, and the effect
        of the step on the escapes.
    delay_exponent : float or None
        ln((c₁ - c₂)/(c₂ - c₃))/ln(ratio of rates) of the three slowest sweeps: 2/3 at a fold; None
        if the escapes do not decrease with the rate. It shows which law holds; no error is known.
    seconds : float
        Wall-clock time.
    """

    rates: tuple[float, ...]
    escapes: tuple[float, ...]
    c_0: float | None
    error: float | None
    delay_exponent: float | None
    seconds: float
