"""Every number returned is one and has a bound; what cannot be computed is refused in a sentence.

One test for the registry of quantities and the public functions, whatever their parameters are:
all decades, zero, negative, subnormal, infinite and NaN, integers, numbers of numpy, fractions,
text, truth values, arrays of several shapes, nothing.
"""

import contextlib
import dataclasses
import importlib
import inspect
import math
import numbers
import pkgutil
import re
import signal
import threading
import time
from collections.abc import Mapping
from decimal import Decimal
from enum import Enum
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fronts as fr
from fronts import wording
from theory.cells import vdp
from theory.parameters import MissingPackageError, ParameterError, RunError
from theory.piecewise import folds, limits, stability
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.result import PrecisionError
from theory.piecewise.sums.series import sum_by_roots
from theory.result import Result
from verification.execution import time_limit as time_limit_module
from verification.execution.time_limit import TimeIsUpError, time_limit
from verification.fronts.resting import StaticFold
from verification.piecewise.run import FrontRun
from verification.quantities.registry import all_computations

REFUSALS = (ParameterError, PrecisionError, RunError, MissingPackageError)
SECONDS = 20
"""After so long a call counts as one that hangs; on a loaded machine nothing comes near."""

DECADES = st.floats(-330.0, 309.0).map(lambda x: 10.0**x if x < 308.0 else math.inf)
USUAL = st.floats(-9.0, 4.0).map(lambda x: 10.0**x)
EDGES = st.sampled_from(
    [0.0, -0.0, -1.0, 5e-324, 2.2e-308, 1e-100, 1e100, 1.7e308, math.inf, -math.inf, math.nan,
     0.125, 0.08, math.nextafter(0.08, 1), math.nextafter(0.125, 0), 1e-24, 1e-12, 1e12]
)  # fmt: skip
KINDS = st.sampled_from(
    [float, np.float64, np.float32, np.longdouble, lambda x: int(x) if math.isfinite(x) else x,
     lambda x: np.int64(min(max(x, -9e18), 9e18)) if math.isfinite(x) else x,
     lambda x: Fraction(x) if math.isfinite(x) else x, np.array]
)  # fmt: skip
NUMBERS = st.one_of(USUAL, DECADES, EDGES)
OTHERS = st.sampled_from(
    ["", "0.3", "1e400", "nan", "0.3 0.4", "x\ny", b"0.3", None, True, 1j, [], [0.3],
     (0.3, 0.5), {}, object(), np.array([]), np.array([0.3]), np.array([0.3, 0.5]), np.ones((2, 2)),
     np.array(["0.3"]), np.array([0.3, np.nan]), np.datetime64("2026-01-01"),
     Decimal("0.3"), 10**400]
)  # fmt: skip


@st.composite
def anything(draw):
    """Draw a parameter: mostly a number, of some kind, or else something that is none."""
    if draw(st.integers(0, 5)) == 0:
        return draw(OTHERS)
    number = draw(NUMBERS)
    with np.errstate(over="ignore"):
        return draw(KINDS)(number)


def floats_in(value, where=""):
    """Every number in a result, with the name of the place where it stands."""
    if isinstance(value, (str, bytes, bool, Enum, type(None))):
        return
    if isinstance(value, numbers.Complex) or hasattr(value, "_mpf_") or hasattr(value, "_mpc_"):
        yield where, value
    elif isinstance(value, np.ndarray):
        if value.dtype.kind in "fc":
            for each in value.ravel()[:2000].tolist():
                yield where, each
    elif dataclasses.is_dataclass(value):
        for each in dataclasses.fields(value):
            yield from floats_in(getattr(value, each.name), f"{where}.{each.name}")
    elif isinstance(value, Mapping):
        for key, each in value.items():
            yield from floats_in(each, f"{where}.{key}")
    elif isinstance(value, (list, tuple)):
        for each in value:
            yield from floats_in(each, where)


def check_outcome(call):
    """Call, and hold the outcome against the rule."""
    try:
        with time_limit(SECONDS):
            found = call()
    except REFUSALS as refusal:
        said = str(refusal)
        assert said.endswith((".", ")")), said
        assert "\n" not in said, said
        return None
    for where, number in floats_in(found):
        # NaN alone is unequal to itself, also in mpmath's arithmetic.
        assert number == number, f"NaN at {where} of {found!r}"  # noqa: PLR0124
    for each in found if isinstance(found, (list, tuple)) else (found,):
        if isinstance(each, Result) and hasattr(each, "error") and each.error is not None:
            error = np.asarray(each.error, dtype=object)
            assert all(one >= 0 for one in error.ravel()), f"a negative error: {each!r}"
    return found


PUBLIC = {
    "sigma": (fr.sigma, ("v", "c")),
    "sigma-series": (lambda v, c: fr.sigma(v, c, method="series"), ("v", "c")),
    "sigma-bessel": (lambda v, c: fr.sigma(v, c, method="bessel", digits=8), ("v", "c")),
    "sigma-quadrature": (lambda v, c: fr.sigma(v, c, method="quadrature", digits=6), ("v", "c")),
    "sum-by-integral": (sum_by_integral, ("v", "c")),
    "sum-by-roots": (lambda v, c: sum_by_roots(v, c, 12), ("v", "c")),
    "sum-by-bessel": (lambda v, c: sum_by_bessel(v, c, 1e-8), ("v", "c")),
    "sum-by-quadrature": (lambda v, c: sum_by_quadrature(v, c, 1e-6), ("v", "c")),
    "roots": (lambda v, c: fr.roots(v, c, count=3), ("v", "c")),
    "roots-extent": (lambda extent: fr.roots(0.3, 0.5, extent=extent), ("extent",)),
    "roots-count": (lambda count: fr.roots(0.3, 0.5, count=count), ("count",)),
    "kinetic": (fr.kinetic_relation, ("c", "eta")),
    "kinetic-damping": (lambda a, b: fr.kinetic_relation(0.5, a=a, b=b), ("a", "b")),
    "profile": (fr.front_profile, ("c", "eta")),
    "stability": (stability.front_stability, ("v", "c")),
    "pinning-coupling": (limits.pinning_coupling, ("eta",)),
    "pinning-error": (limits.pinning_error, ("eta",)),
    "retreat-coupling": (limits.retreat_coupling, ("eta",)),
    "pinning-eta": (limits.pinning_eta, ("c",)),
    "strong-coupling": (limits.strong_coupling_velocity, ("eta",)),
    "weak-threshold": (limits.weak_threshold_velocity, ("c", "eta")),
    "fold-coupling": (folds.fold_coupling, ("eta",)),
    "fold-eta": (folds.fold_eta, ("c",)),
    "threshold-ratio": (vdp.threshold_ratio, ("eta",)),
    "eta": (vdp.eta_from_damping, ("a", "b")),
    "chain": (
        lambda a, b, c, eps: fr.VdpChain(a=a, b=b, c=c, eps=eps, sites=5),
        ("a", "b", "c", "eps"),
    ),
    "chain-sites": (lambda sites: fr.VdpChain(a=4, b=0.5, c=0.6, sites=sites), ("sites",)),
    "chain-averaged": (lambda a, b, c: fr.AveragedChain(a=a, b=b, c=c, sites=5), tuple("abc")),
    "chain-piecewise": (lambda c, eta: fr.PiecewiseChain(c=c, eta=eta), ("c", "eta")),
    "chain-friction": (
        lambda c, v_d, xi: fr.FrictionChain(c=c, v_d=v_d, xi=xi), ("c", "v_d", "xi")
    ),
    "cell-averaged": (lambda a, b: fr.cell(fr.AveragedChain(a=a, b=b, c=0.0, sites=2)), ("a", "b")),
    "breather": (
        lambda a, b, c: fr.breather(fr.AveragedChain(a=a, b=b, c=c, sites=9), method="closed-form"),
        ("a", "b", "c"),
    ),
}  # fmt: skip
"""Public functions of numbers, and the parameters that are drawn."""


SLOW = {
    "kinetic": lambda c, eta: above(c, 30.0),
    "profile": lambda c, eta: above(c, 30.0),
    "sigma-quadrature": lambda v, c: above(c, 10.0) or not above(v, 1e-2),
    "sum-by-quadrature": lambda v, c: above(c, 10.0) or not above(v, 1e-2),
    "sigma-bessel": lambda v, c: above(c, 1e2),
    "sum-by-bessel": lambda v, c: above(c, 1e2),
    "stability": lambda v, c: above(v, 1e2),
}
"""Parameters at which an answer takes seconds; ``fronts stress`` has them."""


def above(value, bound):
    try:
        return bound < float(value) < 1e13
    except (TypeError, ValueError, OverflowError):
        return False


DRAWN = settings(
    derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)


@pytest.mark.parametrize("name", PUBLIC)
def test_public_functions_answer_with_bounds_or_refuse_in_a_sentence(name):
    function, parameters = PUBLIC[name]

    @settings(DRAWN, max_examples=20)
    @given(st.fixed_dictionaries(dict.fromkeys(parameters, anything())))
    def holds(values):
        if not (name in SLOW and SLOW[name](**values)):
            check_outcome(lambda: function(**values))

    holds()


QUICK = [each for each in all_computations() if each.seconds <= 0.2]


@pytest.mark.parametrize("computation", QUICK, ids=lambda each: each.name)
def test_quantities_of_the_registry_answer_with_bounds_or_refuse(computation):
    names = [axis.name for axis in computation.axes]

    @settings(DRAWN, max_examples=25)
    @given(st.fixed_dictionaries(dict.fromkeys(names, NUMBERS)))
    def holds(values):
        found = check_outcome(lambda: computation.compute(values))
        if found is not None and found.value is not None:
            assert found.error >= 0

    holds()


def test_the_rule_itself_finds_nan_raw_errors_and_calls_without_end(monkeypatch):
    monkeypatch.setitem(globals(), "SECONDS", 1)
    with pytest.raises(AssertionError, match="NaN"):
        check_outcome(lambda: {"v": [0.3, complex(0.0, math.nan)]})
    with pytest.raises(ZeroDivisionError):
        check_outcome(lambda: 1 / 0)
    with pytest.raises(TimeIsUpError):
        check_outcome(signal.pause)
    with pytest.raises(AssertionError):
        check_outcome(_two_lines)


def _two_lines():
    raise RunError("one line\nand another.")


@pytest.mark.parametrize("of_processor", [False, True])
def test_a_limit_is_kept_where_the_first_alarm_is_dropped(monkeypatch, of_processor):
    """As in a callback of the interpreter: a call without end once ran on after it."""
    monkeypatch.setattr(time_limit_module, "AGAIN", 0.05)
    begin = time.process_time() if of_processor else time.monotonic()

    def spent():
        return (time.process_time() if of_processor else time.monotonic()) - begin

    def without_end():
        while spent() < 5.0:
            pass

    def dropping_the_first():
        with contextlib.suppress(TimeIsUpError):
            without_end()
        without_end()

    with pytest.raises(TimeIsUpError), time_limit(0.05, of_processor=of_processor):
        dropping_the_first()
    assert spent() < 2.0


@pytest.mark.parametrize("of_processor", [True, False])
def test_after_a_limit_alarms_are_what_they_were(of_processor):
    alarm = signal.SIGPROF if of_processor else signal.SIGALRM
    before = signal.getsignal(alarm)
    with time_limit(100.0, of_processor=of_processor):
        assert signal.getsignal(alarm) is not before
    assert signal.getsignal(alarm) is before
    timer = signal.ITIMER_PROF if of_processor else signal.ITIMER_REAL
    assert signal.getitimer(timer) == (0.0, 0.0)


def test_a_limit_is_on_the_clock_unless_it_is_of_the_processor():
    """A call that waits takes no time of the processor."""
    limited = time_limit_module.time_limit
    with pytest.raises(TimeIsUpError), limited(0.02):
        time.sleep(0.5)
    with limited(10.0, of_processor=True):
        time.sleep(0.02)


def test_outside_the_main_thread_there_is_no_limit():
    ended = []

    def work():
        with time_limit(1e-6):
            ended.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert ended == [True]


def test_without_alarms_there_is_no_limit(monkeypatch):
    monkeypatch.delattr(time_limit_module.signal, "setitimer", raising=False)
    begin = time.monotonic()
    with time_limit(1e-9):
        while time.monotonic() - begin < 1e-3:
            pass


GIVEN = "given by the user or chosen by the method, such as a place at which (47) is violated"
CLOCK = "a run time, or the time at which a run ended"
MEASURE = "a measure of an error or of a noise itself, or an interval"

WITHOUT_ITS_OWN_ERROR = {
    "BranchFold": {"c": "error", "eta": "error"},
    "FollowedBranch": {"values": GIVEN},
    "Curve": {"values": GIVEN},
    "FrontProfile": {"c": GIVEN, "eta": GIVEN, "zeta": GIVEN, "fails_at": GIVEN, "phi": "error"},
    "CertifiedRelation": {"c": GIVEN, "eta": GIVEN, "etas": GIVEN},
    "KineticBranch": {"fails_at": GIVEN},
    "KineticRelation": {"c": GIVEN, "eta": GIVEN, "etas": GIVEN},
    "FrontShape": {"zeta": GIVEN, "phi": "error"},
    "Root": {"residual": MEASURE, "radius": MEASURE},
    "RootSet": {"k": "radius", "residual": MEASURE, "radius": MEASURE},
    "Breather": {
        "amplitudes": "error", "residual": MEASURE, "drift": MEASURE, "trivial": MEASURE,
        "time": CLOCK, "waves": "wave_error",
    },
    "BreatherStability": {
        "values": "error", "trivial": MEASURE, "leader": "error", "frequency": "growth_error",
        "marginal": MEASURE,
    },
    "Bifurcation": {
        "v_d": GIVEN, "stick_time": "stable_error", "cycle_end_velocity": "cycle_end_error",
    },
    "Cell": {"basin": "unstable_cycle"},
    "BeltCell": {
        "cycle_begin_velocity": "cycle_end_error", "cycle_end_velocity": "cycle_end_error",
    },
    "CellCycle": dict.fromkeys(
        ("max", "min", "period", "stick_time", "slip_time", "speed", "averaged", "amplitude"),
        "error",
    ),
    "Spread": {"angles": GIVEN, "velocities": "errors"},
    "FrontWave": {"c": GIVEN, "eta": GIVEN, "trivial": MEASURE},
    "FrontRun": {"period_spread": MEASURE, "truncation": MEASURE, "events_per_site": GIVEN},
    "StaticFold": {"c": "error"},
    "FoundState": {"time": CLOCK},
    "StateMap": {"map_seconds": CLOCK},
    "AveragingError": {"slow_time": GIVEN, "eps": GIVEN, "distances": "errors"},
    "Ensemble": {"values": "errors"},
    "Trajectory": {
        "t_end": GIVEN, "times": GIVEN, "level": GIVEN, "tolerance": GIVEN, "states": "error",
        "amplitude": "error", "arrivals": "arrival_error", "resolved_until": CLOCK,
    },
    "Delay": {"rates": GIVEN, "c_0": "error"},
    "RunThreshold": {
        "low": GIVEN, "high": GIVEN, "final_time": GIVEN, "perturbation": GIVEN,
        "bracket": MEASURE, "fuzzy": MEASURE, "fuzzy_width": MEASURE, "range_by_seed": MEASURE,
    },
}  # fmt: skip
"""Numbers of results that have no field ``<name>_error`` and are not described as having none or as
being exact to rounding: the field with their error, or why they have none; subclasses inherit."""


PACKAGES = ("theory", "verification", "fronts")


def every_result():
    """All classes of results of the packages."""
    for name in PACKAGES:
        package = importlib.import_module(name)
        for module in pkgutil.walk_packages(package.__path__, f"{name}."):
            if not module.name.endswith("__main__") and ".explore" not in module.name:
                importlib.import_module(module.name)
    found, left = [], [Result]
    while left:
        left += (below := left.pop().__subclasses__())
        found += [each for each in below if each.__module__.split(".")[0] in PACKAGES]
    return [*dict.fromkeys(found), FrontRun, StaticFold]  # these two appear within a `Front`


def numbers_of(kind):
    """Names of the entries of a result that are or contain numbers other than counts and errors."""
    kinds = {each.name: str(each.type) for each in dataclasses.fields(kind)}
    for name in (*getattr(kind, "derived", ()), *getattr(kind, "shown", ())):
        if name in kinds:
            continue
        value = inspect.getattr_static(kind, name)
        getter = value.fget if isinstance(value, property) else value.func
        kinds[name] = str(getter.__annotations__["return"])
    return [
        name for name, type_ in kinds.items()
        if re.search("float|complex|FloatArray|ComplexArray", type_)
        and not name.endswith(("error", "errors"))
    ]  # fmt: skip


def test_every_number_of_every_result_has_an_error_or_says_why_not():
    kinds = every_result()
    assert {"Front", "Breather", "KineticRelation", "Trajectory"} <= {k.__name__ for k in kinds}
    used = set()
    for kind in kinds:
        entries = {each.name for each in dataclasses.fields(kind)}
        entries |= {*getattr(kind, "derived", ()), *getattr(kind, "shown", ())}
        reasons = {}
        for base in reversed(kind.__mro__):
            reasons |= WITHOUT_ITS_OWN_ERROR.get(base.__name__, {})
        said = "".join(inspect.getdoc(each) or "" for each in kind.__mro__[:-1])
        for name in numbers_of(kind):
            of = [name + "_error", *(("error", "radius") if name in wording._MAIN else ())]
            if any(each in entries for each in of) or name == "seconds":
                continue
            where = f"{kind.__name__}.{name}"
            attribute = inspect.getattr_static(kind, name, None)
            doc = inspect.getdoc(attribute) if isinstance(attribute, property) else None
            text = doc or re.search(rf"(?m)^(?:\w+, )*{name}\b.*\n((    .*\n?)+)", said)[0]
            if re.search(r"to rounding|no error", re.sub(r"\s+", " ", text).lower()):
                continue
            assert name in reasons, f"{where} has no error, and no reason is given: {text}"
            used.add(where)
            assert reasons[name] in {GIVEN, CLOCK, MEASURE} | entries, f"{where}: {reasons[name]}"
    listed = {f"{kind}.{name}" for kind, names in WITHOUT_ITS_OWN_ERROR.items() for name in names}
    assert listed <= used
