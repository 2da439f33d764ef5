"""The compiled steps of Model II: orders, symmetries, and right sides, against scipy."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from functools import lru_cache, partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numba import njit
from scipy.integrate import DOP853, solve_ivp

from benchmarks.steppers.fixed import fixed_steps
from benchmarks.steppers.splitting import saba, split_steps
from benchmarks.steppers.taylor import taylor_steps
from tests.one_step import steps
from theory.arrays import ComplexArray, FloatArray
from theory.chains.ends import Ends
from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain
from theory.parameters import ParameterError
from verification.references.equations import as_complex, as_state, averaged_rate, full_rate
from verification.runs.excite import as_psi, excite
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers import amplitudes, kernel, runge_kutta, variational
from verification.steppers.active import FOLLOWING, FREE, NETWORK, REST, RING, end_codes
from verification.steppers.friction_series import taylor_order
from verification.steppers.kernel import slope_of
from verification.steppers.runge_kutta import dop853_step, step_error
from verification.steppers.smooth import compiled_step
from verification.steppers.specialise import source_mark

CHAIN = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.05, sites=7)


def reference(
    chain: VanDerPolChain,
    start: ComplexArray,
    end: float,
    full: bool = True,
    tolerance: float = 1e-13,
) -> ComplexArray:
    """Integrate (8), or (43) in complex form, by scipy's DOP853."""
    right, x = (full_rate(chain), as_state(start)) if full else (averaged_rate(chain), start)
    end = end if full else end * chain.eps
    out = solve_ivp(right, (0.0, end), x, method="DOP853", rtol=tolerance, atol=tolerance)
    return as_complex(out.y[:, -1]) if full else np.asarray(out.y[:, -1], dtype=complex)


@lru_cache
def _called(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return what Python can call in place of a function that only compiled ones can."""

    @njit
    def called(*given: Any) -> Any:
        return function(*given)

    answer: Callable[..., Any] = called
    return answer


def _start(chain: VdpChain) -> ComplexArray:
    return as_psi(excite(chain, [1, 3], 3.0, quarter_turns=[0, -1]))


def _of(chain: VdpChain, full: bool) -> VdpChain | AveragedChain:
    return chain if full else chain.averaged()


def _state(psi: ComplexArray, full: bool = True) -> FloatArray:
    return np.array([psi.imag, psi.real] if full else [psi.real, psi.imag])


@lru_cache
def _at_20(chain: VdpChain, full: bool) -> FloatArray:
    """Return the state at t = 20 of the full chain, at εt = 20 of the averaged one."""
    return _state(reference(chain, _start(chain), 20.0 if full else 20.0 / chain.eps, full))


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
@pytest.mark.parametrize("full", [True, False])
@pytest.mark.parametrize("order", [4, 8])
def test_a_runge_kutta_step_has_its_order(order: int, full: bool, ends: Ends) -> None:
    chain = VdpChain(a=CHAIN.a, b=CHAIN.b, c=CHAIN.c, eps=CHAIN.eps, sites=7, ends=ends)
    exact = _at_20(chain, full)
    errors = []
    # Steps whose errors lie between round-off and saturation.
    steps = {(4, True): 400, (8, True): 160, (4, False): 200, (8, False): 120}[order, full]
    for count in (steps, 2 * steps):
        state = _state(_start(chain))
        fixed_steps(_of(chain, full), state, 20.0 / count, count, order)
        errors.append(np.abs(state - exact).max())
    assert errors[1] > 1e-12
    assert math.log2(errors[0] / errors[1]) > order - 0.6


@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_splitting_gains_an_order_in_eps_at_fixed_steps(ends: Ends) -> None:
    """SABA_n: O(ε h^{2n}) + O(ε² h²): at small h the error falls like ε², and like h²."""

    def error(eps: float, count: int) -> float:
        chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=eps, sites=7, ends=ends)
        state = _state(_start(chain))
        parameters = np.array([chain.a, chain.b, chain.c, eps])
        split_steps(state, parameters, ends is Ends.PERIODIC, 5.0 / count, count, *saba(4))
        return float(np.abs(state - _state(reference(chain, _start(chain), 5.0))).max())

    by_step = math.log2(error(0.02, 10) / error(0.02, 20))
    by_eps = math.log2(error(0.004, 20) / error(0.002, 20))
    assert by_step > 1.7
    assert by_eps == pytest.approx(2.0, abs=0.3)


def _run(chain: VanDerPolChain, psi: ComplexArray, end: float, tolerance: float) -> ComplexArray:
    run = SmoothIntegration(chain, psi, [0.0, end], tolerance=tolerance, level=1.0)
    while not run.finished:
        run.advance(10**6)
    return as_psi(run.samples[-1])


def _by_runge_kutta(full: bool, tolerance: float, end: float) -> ComplexArray:
    return _run(_of(CHAIN, full), _start(CHAIN), end, tolerance)


def _by_series(full: bool, tolerance: float, end: float) -> ComplexArray:
    assert full
    state, parameters = _state(_start(CHAIN)), np.array([CHAIN.a, CHAIN.b, CHAIN.c, CHAIN.eps])
    assert taylor_steps(state, parameters, end, tolerance, taylor_order(tolerance)) > 0
    return np.asarray(state[1] + 1j * state[0])


@pytest.mark.parametrize(
    ("method", "full"),
    [(_by_runge_kutta, True), (_by_runge_kutta, False), (_by_series, True)],
)
def test_a_tighter_tolerance_gives_a_smaller_error(
    method: Callable[[bool, float, float], ComplexArray], full: bool
) -> None:
    end = 20.0
    exact = reference(CHAIN, _start(CHAIN), end, full)
    errors = [
        float(np.abs(method(full, tolerance, end) - exact).max())
        for tolerance in (1e-5, 1e-7, 1e-9, 1e-11)
    ]
    assert errors[-1] < 1e-8
    # Proportional to the tolerance within a factor of 30 over two decades, each time.
    for larger, smaller in itertools.pairwise(errors):
        assert smaller < 0.3 * larger


@pytest.mark.parametrize("full", [True, False])
def test_a_mirrored_state_has_the_mirrored_slope_to_the_last_bit(full: bool) -> None:
    random = np.random.default_rng(3)
    chain = _of(VdpChain(a=2.5, b=0.5, c=0.3), full)
    slope, parameters = _called(slope_of(chain)), np.array(chain.kernel_parameters())
    for m in (1, 2, 3, 8, 33, 64, 101):
        half = random.standard_normal((2, m))
        mirrored = half[:, ::-1]
        one, other = np.zeros(2 * m), np.zeros(2 * m)
        slope(half.ravel(), parameters, FREE, FREE, one)
        slope(np.ascontiguousarray(mirrored).ravel(), parameters, FREE, FREE, other)
        assert np.array_equal(one.reshape(2, m)[:, ::-1], other.reshape(2, m))


@pytest.mark.parametrize("full", [True, False])
@pytest.mark.parametrize("ends", VdpChain.allowed_ends)
def test_the_compiled_slope_is_the_kernel_at_every_site(full: bool, ends: Ends) -> None:
    """The kernel in numpy, its neighbours by padding: the loop over sites is not used.

    Of a wave that goes on beyond the first site, the part from the second site on has its slope.
    """
    chain = _of(VdpChain(a=2.5, b=0.5, c=0.3, eps=0.2, sites=6, ends=ends), full)
    y, w = state = np.random.default_rng(5).standard_normal((2, 6))
    mode = "wrap" if ends is Ends.PERIODIC else "edge"
    left, right = (np.pad(state, ((0, 0), (1, 1)), mode=mode)[:, part] for part in (  # type: ignore[call-overload]
        slice(0, 6), slice(2, 8)
    ))  # fmt: skip
    expected = np.array(chain.kernel()((y, w), left, right, chain.kernel_parameters()))
    out = np.zeros(12)
    code = RING if ends is Ends.PERIODIC else FREE
    slope = _called(slope_of(chain))
    slope(state.ravel(), np.array(chain.kernel_parameters()), code, code, out)
    assert np.abs(out - expected.ravel()).max() < 1e-14
    wave = excite(chain, range(1, 7), quarter_turns=[-n for n in range(6)])
    part = np.zeros(10)
    slope(wave.ravel(), np.array(chain.kernel_parameters()), FREE, FREE, out)
    slope(wave[:, 1:].ravel(), np.array(chain.kernel_parameters()), FOLLOWING, FREE, part)
    assert np.abs(part.reshape(2, 5) - out.reshape(2, 6)[:, 1:]).max() < 1e-14


@pytest.mark.parametrize("full", [True, False])
@pytest.mark.parametrize(
    ("window", "first", "before", "after"),
    [
        ((0, 6), FREE, "end", "end"),
        ((0, 6), RING, "far end", "far end"),
        ((0, 6), FOLLOWING, "wave", "end"),
        ((0, 5), FREE, "end", "rest"),
        ((1, 6), FREE, "rest", "end"),
        ((1, 5), FREE, "rest", "rest"),
        ((1, 3), FREE, "rest", "rest"),
        ((0, 1), FREE, "end", "rest"),
    ],
)
def test_a_compiled_step_is_that_of_scipy_whatever_is_beyond_its_ends(
    full: bool, window: tuple[int, int], first: int, before: str, after: str
) -> None:
    """The kernel in numpy, with neighbours of both ends by what is said to be there."""
    chain = _of(VdpChain(a=2.5, b=0.5, c=0.3, eps=0.2, sites=6), full)
    state = np.random.default_rng(5).standard_normal((2, 6))
    p, (low, high) = np.array(chain.kernel_parameters()), window
    ahead, behind = excite(chain, [1, 2], 1.0, quarter_turns=[0, -1])[:, :2].T
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    turn *= 1.0 if np.abs(turn @ behind - ahead).max() < 1e-9 else -1.0
    assert np.abs(turn @ behind - ahead).max() < 1e-9

    def rate(_: float, z: FloatArray) -> Any:
        x = z.reshape(2, -1)
        beyond = {"rest": 0.0 * x[:, 0], "wave": turn @ x[:, 0]}
        left = {**beyond, "end": x[:, 0], "far end": x[:, -1]}[before]
        right = {**beyond, "end": x[:, -1], "far end": x[:, 0]}[after]
        padded = np.column_stack([left, x, right])
        return np.concatenate(chain.kernel()(x, padded[:, :-2], padded[:, 2:], p))

    found = steps(
        state, window=window, first=first, step=compiled_step(chain), parameters=p, longest=0.1
    )
    exact = solve_ivp(
        rate, (0.0, 0.1), state[:, low:high].ravel(), "DOP853", rtol=1e-13, atol=1e-14
    )
    assert np.abs(found.rows.x - exact.y[:, -1]).max() < 1e-10


@pytest.mark.parametrize("full", [True, False])
def test_a_ring_is_the_same_from_every_site(full: bool) -> None:
    chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.05, sites=9, ends=Ends.PERIODIC)
    start = as_psi(excite(chain, [2, 3], 3.0, quarter_turns=[0, -1]))

    def run(psi: ComplexArray) -> ComplexArray:
        return _run(_of(chain, full), psi, 200.0, 1e-9)

    # Round-off of different orders of summation, grown over 200 units of time.
    assert np.abs(np.roll(run(start), 4) - run(np.roll(start, 4))).max() < 1e-9
    assert np.abs(run(-start) + run(start)).max() == 0.0


def test_the_clock_loses_nothing_over_many_equal_steps() -> None:
    """Equal steps are rounded alike: a plain sum of 20 000 of them is off by some 1e-10."""
    chain = VdpChain(a=4.0, b=0.5, c=0.6, eps=0.01, sites=31)
    start = excite(chain, [1])
    run = SmoothIntegration(chain, start, [0.0, 1000.0], tolerance=1e-13, level=1.0)
    while not run.finished:
        run.advance(10**7)
    state = start.copy()
    parameters = np.array([chain.a, chain.b, chain.c, chain.eps])
    taylor_steps(state, parameters, 1000.0, 1e-14, taylor_order(1e-14))
    assert run.counts["steps"] > 15_000
    assert np.abs(run.samples[-1] - state).max() < 3e-11


@pytest.mark.parametrize("duration", [1.14, 1.17, 1.28])
def test_equal_steps_whose_sum_rounds_to_the_end_take_the_sample_there(duration: float) -> None:
    """Time plus step is just below the end; with what rounding has lost so far it is the end."""
    chain = AveragedChain(a=4.0, b=0.5, c=0.6, sites=3)
    step = duration / round(10.0 * duration)
    run = SmoothIntegration(chain, excite(chain, [1]), [duration / chain.eps], step=step)
    run.advance(10**5)
    assert run.finished


@pytest.mark.parametrize("displacement", [30.0, 100.0, 300.0])
def test_a_step_that_explodes_never_passes(displacement: float) -> None:
    """The damping rate is up to 4e7: most of these steps are unstable, some end near 1e150."""
    chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=5)
    take_step, error_of = _called(dop853_step(slope_of(chain), clock=(0, 0))), _called(step_error)
    parameters = np.array(chain.kernel_parameters())
    K, work, out = np.zeros((12, 10)), np.zeros((2, 10)), np.zeros(10)
    x = np.zeros(10)
    x[2] = displacement
    exploded = 0
    for h in np.geomspace(1e-8, 1.0, 400):
        take_step(x, parameters, FREE, FREE, h, K, out)
        error = error_of(K, h, work, displacement)
        if not np.abs(out).max() < 10.0 * displacement:
            exploded += 1
            assert not error < 1e-2
    assert exploded > 50


@pytest.mark.parametrize(
    "slopes",
    [{5: -3e307, 6: -2e307, 8: -1.79e308, 9: 1.79e308, 10: 1.79e308}, {5: 1e308, 7: 5e307}],
    ids=["fifth order", "third order"],
)
def test_an_error_of_which_one_estimate_is_out_of_range_is_infinite(
    slopes: dict[int, float],
) -> None:
    """The largest weights of one have the signs that add up, while the other stays in range."""
    K, weights = np.zeros((12, 2)), np.stack([DOP853.E5[:12], DOP853.E3[:12]])
    K[list(slopes), 0] = list(slopes.values())
    with np.errstate(over="ignore", invalid="ignore"):
        sums = np.cumsum(weights * K[:, 0], axis=1)
    assert np.isfinite(sums).all(axis=1).sum() == 1
    assert _called(step_error)(K, 1e-308, np.zeros((2, 2)), 10.0) == math.inf


@pytest.mark.parametrize("forces", [0, 2])
def test_forces_are_put_in_at_the_time_of_each_stage_before_its_slope(
    forces: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The times of a Runge-Kutta method are the sums of the rows of its matrix."""
    done: list[Any] = []

    def as_text(text: list[str], **names: Any) -> Any:
        exec("\n".join(text), names)
        return names["step"]

    def put(_: object, *where: float) -> None:
        done.append(where)

    def slope(*_: object) -> None:
        done.append("slope")

    monkeypatch.setattr(runge_kutta, "_compiled", as_text)
    monkeypatch.setattr(runge_kutta, "_put_cosines", put)
    monkeypatch.setattr(runge_kutta, "_stages", [lambda *_: None] * 12)
    step: Any = dop853_step(slope, clock=(7, forces))
    step(None, None, 0, 0, 0.5, [None] * 12, None)
    assert [each for each in done if each == "slope"] == ["slope"] * 12
    times = 0.5 * DOP853.A[:12, :12].sum(axis=1)
    put_in = [(7, 2, pytest.approx(time, abs=1e-14)) for time in times]
    assert done[::2] == put_in if forces else len(done) == 12


def test_every_harmonic_force_is_put_in_at_the_time_of_the_stage() -> None:
    """(ω, phase, cosine) of each force follow the time; what stands before it is kept."""
    given = np.array([9.0, 8.0, 0.7, 1.3, 0.2, 0.0, 2.1, -0.4, 0.0])
    p = given.copy()
    runge_kutta._put_cosines.py_func(p, 2, 2, 0.5)
    expected = given.copy()
    expected[[5, 8]] = np.cos(given[[3, 6]] * (0.7 + 0.5) + given[[4, 7]])
    assert p == pytest.approx(expected, abs=1e-15)


def test_series_are_multiplied_and_summed_as_by_numpy() -> None:
    """Those of eight sites, four of which are treated at a time."""
    left, right = np.random.default_rng(5).normal(size=(2, 6, 8))
    product, values = np.zeros((6, 8)), left.copy()
    for k in range(6):
        variational._add_product.py_func(left, right, product, k)
    variational._sum_up.py_func(values, 0.7)
    whole = [np.convolve(left[:, n], right[:, n])[:6] for n in range(8)]
    assert product == pytest.approx(np.transpose(whole), abs=1e-13)
    assert values[0] == pytest.approx(np.polynomial.polynomial.polyval(0.7, left), abs=1e-13)
    room = [variational._in_fours.py_func(count) for count in range(1, 10)]
    assert room == [4, 4, 4, 4, 8, 8, 8, 8, 12]


@pytest.mark.parametrize("turns", [-1, 0, 1, 2])
def test_a_wave_goes_on_beyond_the_left_end_with_the_phase_step_of_its_chain(
    turns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the place of its slope each site has its left neighbour, or its right one.

    So it has at rest beyond both ends, and on a ring.
    """
    monkeypatch.setattr(kernel, "inner", lambda **_: lambda function: function)
    monkeypatch.setattr(kernel, "fast", lambda function: function)
    monkeypatch.setattr(kernel, "to_fixed_tuple", lambda values, count: tuple(values[:count]))
    chain = SimpleNamespace(network=None, kernel_layout=(3,), front_phase_step=turns)
    wave = excite(CHAIN, range(1, 8), 3.0, quarter_turns=[turns * n for n in range(7)])
    wave += excite(CHAIN, range(1, 8), 2.0, quarter_turns=[turns * n + 1 for n in range(7)])
    row, p, out = wave[:, 1:].ravel(), np.array([1.0, 2.0, 3.0]), np.zeros(12)
    names = {"left": wave[:, :-1], "right": np.column_stack([wave[:, 2:], wave[:, -1]])}
    for name, expected in names.items():
        text = f"def neighbour(site, left, right, p): return {name} if p == (1, 2, 3) else site"
        space: dict[str, Any] = {"__name__": "prompt"}
        exec(text, space)
        chain.kernel = partial(space.get, "neighbour")
        slope_of(chain)(row, p, FOLLOWING, FREE, out)  # type: ignore[arg-type]
        assert out.reshape(2, 6) == pytest.approx(expected, abs=1e-14)
        for code, beyond in ((REST, np.zeros((2, 2))), (RING, wave[:, [-1, 1]])):
            around = np.column_stack([beyond[:, 0], wave[:, 1:], beyond[:, 1]])
            slope_of(chain)(row, p, code, code, out)  # type: ignore[arg-type]
            neighbours = around[:, :-2] if name == "left" else around[:, 2:]
            assert out.reshape(2, 6) == pytest.approx(neighbours, abs=1e-14)


def test_ends_of_a_window_have_codes_of_their_own() -> None:
    assert len({REST, FREE, RING, FOLLOWING, NETWORK}) == 5
    ends = _called(end_codes)
    assert ends(0, 7, 7, RING, False) == (RING, RING)
    assert ends(0, 7, 7, FREE, False) == (FREE, FREE)
    assert ends(2, 5, 7, FREE, False) == (REST, REST)
    assert ends(2, 7, 7, FREE, True) == (FOLLOWING, FREE)
    assert ends(0, 5, 7, FOLLOWING, False) == (FOLLOWING, REST)
    assert ends(2, 5, 7, NETWORK, False) == (2, 7)


@pytest.mark.parametrize("half", [0.01, 1.0, 7.3, 60.0])
def test_a_disturbance_reaches_as_far_as_it_is_above_rounding(half: float) -> None:
    """half^d / d! falls from d = half on; by logarithms of factorials."""
    far = amplitudes._reach(half)

    def size(d: int) -> float:
        return d * math.log(half) - math.lgamma(d + 1.0)

    assert far >= half
    assert size(far) <= math.log(1e-19) + 1e-9
    assert far - 1 < half or far == 1 or size(far - 1) > math.log(1e-19) - 1e-9


def test_functions_typed_in_at_a_prompt_are_told_apart_by_what_they_do() -> None:
    """There is no file to look into; names and numbers may be the same."""
    marks = []
    for text in ("x + 1.0", "x - 1.0", "x + 2.0", "y + 1.0"):
        space: dict[str, Any] = {"__name__": "prompt"}
        exec(compile(f"def f(x, y): return {text}", "<prompt>", "exec"), space)
        marks.append(source_mark(space["f"]))
    assert len(set(marks)) == 4
    assert {mark.rpartition(".")[0] for mark in marks} == {"prompt.f"}


def test_functions_of_one_definition_are_told_apart_by_what_they_capture() -> None:
    """A chain whose right-hand side a function makes is not integrated with that of another."""

    def made(strength: float, helper: Any) -> Any:
        def rate(site: Any, left: Any, right: Any, p: Any) -> Any:
            return strength * helper(site[0]), -site[1]

        return rate

    def helper(factor: float) -> Any:
        return njit(lambda y: factor * y)

    marks = [
        source_mark(made(strength, helper(factor)))
        for strength, factor in ((1.0, 1.0), (2.0, 1.0), (1.0, 2.0), (1.0, 1.0))
    ]
    assert len(set(marks)) == 3
    assert marks[0] == marks[3]
    with pytest.raises(ParameterError, match="the variable strength, which rate takes from"):
        source_mark(made([1.0], helper(1.0)))  # type: ignore[arg-type]


def test_a_right_hand_side_is_compiled_again_when_a_number_that_it_captures_changes() -> None:
    """As in a notebook in which a cell with a number is run again."""
    space: dict[str, Any] = {"__name__": "prompt", "rate": 2.0}
    exec("def kernel(site, left, right, p): return rate * site[0], -site[1]", space)
    chain: Any = SimpleNamespace(
        network=None, kernel=lambda: space["kernel"], kernel_layout=(1,), front_phase_step=0
    )

    def velocity() -> float:
        slope, found = slope_of(chain), np.zeros(4)
        called: Any = njit(lambda x, p, out: slope(x, p, FREE, FREE, out))
        called(np.ones(4), np.zeros(1), found)
        return float(found[0])

    for space["rate"] in (2.0, 3.0, 2.0):
        assert velocity() == space["rate"]
