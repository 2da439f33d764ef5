"""Cells given as compiled functions: a polynomial is its text, and others are scipy's."""

from __future__ import annotations

import math
import pickle
from fractions import Fraction
from types import ModuleType
from typing import Any, NamedTuple

import numba
import numba.extending
import numpy as np
import pytest

from tests.reference_runs import overdamped_rate, states_by_scipy
from theory.cells.compiled import CompiledForce
from theory.cells.compiled_cell import CompiledCell
from theory.cells.function_content import function_content, independent_copy
from theory.chains.oscillator import OscillatorChain
from theory.parameters import ParameterError
from verification.breathers.breather import breather
from verification.fronts.measure import measure_front
from verification.references.equations import pull_matrix
from verification.references.network import oscillator_rate
from verification.runs.averaging_error import averaging_error
from verification.runs.excite import excite
from verification.runs.simulate import simulate

SHARPNESS = 0.25


@numba.njit
def paper_h(y, v, a, b):  # type: ignore[no-untyped-def]
    return 1.0 - a * y**2 + b * y**4


@numba.njit
def paper_h_y(y, v, a, b):  # type: ignore[no-untyped-def]
    return -2.0 * a * y + 4.0 * b * y**3


@numba.njit
def paper_h_v(y, v, a, b):  # type: ignore[no-untyped-def]
    return 0.0


@numba.njit
def gain(y, v, p):  # type: ignore[no-untyped-def]
    return 1.0 - p * y * y * math.exp(-SHARPNESS * y * y) + 0.1 * math.tanh(v)


@numba.njit
def pendulum(y, k):  # type: ignore[no-untyped-def]
    return y + k * math.sin(y)


@numba.njit
def pendulum_y(y, k):  # type: ignore[no-untyped-def]
    return 1.0 + k * math.cos(y)


@numba.njit
def nagumo(y, alpha):  # type: ignore[no-untyped-def]
    return y * (1.0 - y) * (alpha - y)


@numba.njit
def named_otherwise(x):  # type: ignore[no-untyped-def]
    return x


@numba.njit
def of_text(y):  # type: ignore[no-untyped-def]
    return "a" + y


@numba.njit
def shifted(y):  # type: ignore[no-untyped-def]
    return y + 1.0


@numba.njit
def repelling(y):  # type: ignore[no-untyped-def]
    return -y


@numba.njit
def softening(y):  # type: ignore[no-untyped-def]
    return math.sin(y)


@numba.njit
def always_gains(y, v):  # type: ignore[no-untyped-def]
    return -1.0


def not_compiled(y: float) -> float:
    return y


TEXT = {"damping": "1 - a*y**2 + b*y**4", "values": {"a": 2.5, "b": 0.5}, "c": 0.1, "sites": 7}
PAPER = {**TEXT, "damping": (paper_h, paper_h_y, paper_h_v)}


def test_a_polynomial_as_functions_has_the_run_the_cycles_and_the_breather_of_its_text() -> None:
    ours, theirs = OscillatorChain(**PAPER), OscillatorChain(**TEXT)
    for one, other in zip(ours.cell.cycles, theirs.cell.cycles, strict=True):
        assert one == pytest.approx(other, rel=1e-11)  # quadrature of 80 nodes against roots
    start = excite(theirs, [4])
    runs = [simulate(each, start, 200.0, samples=3) for each in (ours, theirs)]
    # The choice of steps magnifies roundings; the orbit below is stepped by equal ones.
    errors = [each.error for each in runs if each.error is not None]
    assert np.abs(runs[0].states - runs[1].states).max() <= sum(errors) < 1e-8
    one, other = breather(ours), breather(theirs)
    assert one.frequency == pytest.approx(other.frequency, abs=1e-13)
    moduli = [np.sort(np.abs(each.multipliers)) for each in (one, other)]  # type: ignore[arg-type]
    np.testing.assert_allclose(*moduli, atol=1e-11)


def test_the_error_of_a_run_bounds_its_distance_from_scipy() -> None:
    chain = OscillatorChain(
        damping=gain, stiffness=(pendulum, pendulum_y), values={"p": 3.0, "k": 0.4}, c=1.0, eps=0.1,
        disorder={"p": 0.1}, seed=2, sites=9, velocity_coupling=0.2,
    )  # fmt: skip
    p = 3.0 * (1.0 + 0.1 * np.random.default_rng([2, 0]).standard_normal(9))
    rate = oscillator_rate(
        lambda y: y + 0.4 * np.sin(y),
        lambda y, v: 1.0 - p * y**2 * np.exp(-(y**2) / 4.0) + 0.1 * np.tanh(v),
        pull_matrix(9), c=1.0, eps=0.1, d=0.2,
    )  # fmt: skip
    start = excite(chain, [2, 3])
    run = simulate(chain, start, 30.0, samples=4, tolerance=1e-8)
    exact = states_by_scipy(rate, start.ravel(), run.times)
    assert 1e-12 < np.abs(run.states.reshape(4, -1) - exact).max() <= run.error < 1e-4


def test_an_overdamped_chain_of_a_function_is_that_of_scipy_and_has_its_front() -> None:
    chain = OscillatorChain(
        damping=0, stiffness=nagumo, values={"alpha": 0.2}, overdamped=True, c=1.0, sites=31
    )
    assert (chain.unstable_amplitude, chain.stable_amplitude) == pytest.approx((0.2, 1.0))
    start = excite(chain, range(1, 9))
    run = simulate(chain, start, 20.0, samples=3)
    rate = overdamped_rate(lambda y: y * (1.0 - y) * (0.2 - y), pull_matrix(31), c=1.0)
    exact = states_by_scipy(rate, start[0], run.times)
    assert np.abs(run.y - exact).max() <= run.error
    front = measure_front(chain)
    # √(c/2)(1 - 2α) in the continuum, which the lattice slows by a few per cent
    assert front.v == pytest.approx(math.sqrt(0.5) * 0.6, abs=0.03)


def test_the_frequency_of_small_motion_follows_from_differences() -> None:
    cell = CompiledCell(stiffness=lambda y: math.expm1(2.0 * y), damping=lambda y, _: y * y - 1.0)
    assert cell.frequency == pytest.approx(math.sqrt(2.0), abs=1e-10)  # 4h⁴·2⁵/5!, h = 1e-3


def test_cycles_of_a_function_are_where_scipy_ends() -> None:
    """To O(ε²) after a turn, at ε = 1e-3; g is neither a polynomial nor odd."""
    cell = CompiledCell(stiffness=math.expm1, damping=lambda y, _: y * y - 1.0)
    (cycle,) = cell.cycles
    eps = 1e-3
    rate = oscillator_rate(np.expm1, lambda y, v: y**2 - 1.0, np.zeros((1, 1)), c=0.0, eps=eps)
    start = np.array([cycle.amplitude, 0.0])
    after = states_by_scipy(rate, start, np.array([0.0, cycle.period]))[-1]
    assert abs(after[0] - cycle.amplitude) < 10.0 * eps**2


def test_a_chain_of_functions_goes_to_another_process_and_is_known_by_what_they_do() -> None:
    chain = OscillatorChain(**PAPER)
    assert chain.cell.cycles
    assert pickle.loads(pickle.dumps(chain)) == chain
    assert OscillatorChain(**PAPER).cell is chain.cell  # whose cycles are found once
    assert OscillatorChain(**{**PAPER, "damping": paper_h}) != chain

    def gain_of(sharpness: float) -> Any:
        @numba.njit
        def inner(y):  # type: ignore[no-untyped-def]
            return math.exp(-sharpness * y * y)

        @numba.njit
        def gain(y, v, p):  # type: ignore[no-untyped-def]
            return 1.0 - p * y * y * inner(y) + 0.1 * math.tanh(v)

        return gain

    both = [
        OscillatorChain(damping=gain_of(each), values={"p": 9.0}, c=1.0) for each in (0.25, 0.5)
    ]
    assert both[0] != both[1]
    assert both[0].kernel() is not both[1].kernel()


BAD: list[tuple[dict[str, Any], str]] = [
    ({"stiffness": not_compiled}, "write @numba.njit above the function"),
    ({"stiffness": named_otherwise}, r"arguments of named_otherwise = x .* must be g\(y\)"),
    ({"stiffness": gain}, r"must be g\(y\)"),
    ({"damping": (paper_h, paper_h_y)}, "h = 2 functions"),
    ({"stiffness": of_text}, "function of_text = TypingError"),
    ({"stiffness": shifted}, "y = 0 is a state of rest"),
    ({"stiffness": repelling}, "minimum of the potential"),
    ({"stiffness": softening}, "motion stays bounded"),
    ({"damping": always_gains}, "motion stays bounded"),
    ({"damping": gain}, "complete: p missing"),
    ({"damping": always_gains, "overdamped": True}, "0 without inertia"),
]


@pytest.mark.parametrize(("changes", "words"), BAD)
def test_what_is_wrong_is_refused_in_one_sentence(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ParameterError, match=words) as refusal:
        OscillatorChain(**{"damping": 1, "c": 1.0, **changes})
    assert str(refusal.value).count("\n") == 0
    assert len(str(refusal.value)) < 400


def test_what_needs_polynomials_or_derivatives_says_so() -> None:
    chain = OscillatorChain(**PAPER)
    with pytest.raises(ParameterError, match=r"a polynomial in y and v .* averaged exactly"):
        chain.averaged()
    with pytest.raises(ParameterError, match="averaged exactly"):
        averaging_error(chain)
    with pytest.raises(ParameterError, match="with its derivatives for a breather"):
        breather(chain.replace(damping=paper_h))


class _Numbers(NamedTuple):
    strength: float


def _pull(captured: Any, **options: Any) -> Any:
    """Return a force that captures something."""

    @numba.njit
    def first(x):  # type: ignore[no-untyped-def]
        return x[0]

    @numba.njit(**options)
    def pull(y):  # type: ignore[no-untyped-def]
        return y * (1.0 + (first(captured) - 0.1) * 1e10)

    return pull


def test_cells_differ_by_the_last_bit_of_what_their_functions_capture() -> None:
    """numpy prints eight digits of an array, and of more than a thousand numbers only the ends."""
    values = (0.1, 0.1 + 1e-10)
    middle = np.zeros((2, 2001))
    middle[:, 0], middle[1, 1000] = 0.1, 1.0
    for one, other in (
        [np.array([each]) for each in values],
        list(middle),
        [np.ones(1, dtype=kind) for kind in (float, int)],
        [(each,) for each in values],
        [_Numbers(each) for each in values],
    ):
        digests = [CompiledForce("g", (_pull(each),)).digest for each in (one, one, other)]
        assert digests[0] == digests[1] != digests[2]
    chains = [OscillatorChain(damping=1, stiffness=_pull(np.array([each])), c=0.0, sites=2)
              for each in (0.1, *values)]  # fmt: skip
    assert chains[0] == chains[1] != chains[2]
    names = [each.kernel().__name__ for each in chains]
    assert names[0] == names[1] != names[2]


def test_each_of_two_chains_runs_with_the_numbers_that_its_own_function_captures() -> None:
    """y'' + k y = 0 with k = 1 and 2: cos t and cos √2 t."""
    for value, k in ((0.1, 1.0), (0.1 + 1e-10, 2.0)):
        chain = OscillatorChain(damping=0, stiffness=_pull(np.array([value])), c=0.0, sites=2)
        run = simulate(chain, np.array([[1.0, 1.0], [0.0, 0.0]]), 2.0, samples=2, level=9.0)
        assert run.y[-1, 0] == pytest.approx(math.cos(2.0 * math.sqrt(k)), abs=1e-5)


@pytest.mark.parametrize(
    "through", ["closure", "helper", "tuple", "vectorised", "jitable", "module"]
)
def test_a_chain_keeps_the_numbers_that_its_function_captured_when_it_was_made(
    through: str,
) -> None:
    """numba goes on with those of the first compilation; the digest has those that are there."""
    numbers = np.array([1.0, 7.0])
    both = (numbers, 2)

    @numba.njit
    def first():  # type: ignore[no-untyped-def]
        return numbers[0]

    @numba.vectorize
    def vectorised(y):  # type: ignore[no-untyped-def]
        return y * numbers[0]

    @numba.extending.register_jitable
    def jitable(y):  # type: ignore[no-untyped-def]
        return y * numbers[0]

    module = ModuleType("forces_of_a_user")
    module.force = numba.njit(lambda y: y * numbers[0])  # type: ignore[attr-defined]

    @numba.njit
    def pull(y):  # type: ignore[no-untyped-def]
        if through == "vectorised":
            return vectorised(y)
        if through == "jitable":
            return jitable(y)
        if through == "module":
            return module.force(y)
        if through == "helper":
            return y * first()
        return y * (both[0][0] if through == "tuple" else numbers[0])

    assert pull(1.0) == 1.0
    early = OscillatorChain(damping=0, stiffness=pull, c=0.0, sites=2)
    numbers[0] = 4.0
    assert pull(1.0) == 1.0
    late = OscillatorChain(damping=0, stiffness=pull, c=0.0, sites=2)
    assert early != late
    forces = [dict(each._functions)["_g"] for each in (early, late, early.replace(c=0.1))]
    assert [force(1.0) for force in forces] == [1.0, 4.0, 1.0]
    assert forces[0] is forces[2]
    assert late.cell.frequency == pytest.approx(2.0)


def test_functions_that_call_themselves_are_copied_with_their_options() -> None:
    @numba.njit(fastmath=True, locals={"y": numba.float64})
    def power(y, k):  # type: ignore[no-untyped-def]
        return y if k < 2.0 else y * power(y, k - 1.0)

    copy = independent_copy(power)
    assert copy(2, 10.0) == 1024.0
    assert (copy.targetoptions, copy.locals) == (power.targetoptions, power.locals)
    assert not power.signatures
    assert function_content(copy) == function_content(power)


def test_a_function_that_captures_what_is_not_yet_assigned_is_refused_in_a_sentence() -> None:
    """A copy captures as little; once it is assigned, the function is taken."""

    @numba.njit
    def damping(y, v):  # type: ignore[no-untyped-def]
        return strength * y**2 - 1.0

    copy = independent_copy(damping)
    assert copy.py_func.__code__.co_freevars == ("strength",)
    with pytest.raises(ValueError, match="empty"):
        _ = copy.py_func.__closure__[0].cell_contents
    with pytest.raises(ParameterError, match=r"function damping = .* numba compiles"):
        OscillatorChain(damping=damping, c=0.1, sites=2)
    strength = 2.0
    assert independent_copy(damping)(3.0, 0.0) == 17.0


def test_options_defaults_and_modules_of_a_function_are_part_of_what_it_does() -> None:
    settings = ModuleType("settings_of_a_user")

    def read(strength: float, default: float, **options: Any) -> str:
        settings.strength = strength  # type: ignore[attr-defined]

        @numba.njit
        def scaled(y, by=default):  # type: ignore[no-untyped-def]
            return by * y

        @numba.njit(**options)
        def pull(y):  # type: ignore[no-untyped-def]
            strengths = [settings.strength for _ in range(2)]
            return scaled(strengths[1] * y)

        return CompiledForce("g", (pull,)).digest

    assert read(1.0, 1.0) == read(1.0, 1.0)
    others = [read(2.0, 1.0), read(1.0, 2.0), read(1.0, 1.0, fastmath=True)]
    assert len({read(1.0, 1.0), *others}) == 4


@pytest.mark.parametrize("captured", [[0.1], np.array([None]), Fraction(1, 10)])
def test_what_cannot_be_read_from_outside_is_refused(captured: Any) -> None:
    with pytest.raises(
        ParameterError, match=r"captured, which pull takes from outside .* as named"
    ):
        OscillatorChain(damping=1, stiffness=_pull(captured), c=0.0)
