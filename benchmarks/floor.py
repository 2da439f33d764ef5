"""Run time compared with a floor: the number of operations times the machine's time for each.

The body of a compiled loop is plain Python, so it can be run with numbers that count the operations
applied to them. The rates are those of compiled loops over numbers in the first-level cache: of
multiply-adds, each of which is two operations, and of divisions. The floor is the cost of the
arithmetic alone in such a loop; the rest of the run time is loads and stores, the choice of steps,
and operations that wait for one another.

For an event-driven run of (5), only the arithmetic of the series is counted; the search for events
makes the run time exceed it. There is no row for roots, where nearly all of the work is complex
logarithms and square roots of the C library, nor for derivations, whose work is symbolic: the
number of additions and products says nothing about either.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import lru_cache, partial
from typing import Any
from unittest import mock

import numpy as np
from numba import njit
from scipy.integrate import DOP853

from benchmarks.growth import least_seconds
from benchmarks.work_precision import Report
from theory.chains.friction import FrictionChain
from theory.chains.vdp import VanDerPolChain, VdpChain
from theory.piecewise.sums import arithmetic, axis
from theory.piecewise.sums.integral import MANY, sums
from verification.runs.excite import excite
from verification.runs.simulate import simulate
from verification.steppers import friction_series
from verification.steppers.friction_series import taylor_order

_STAGES = DOP853.n_stages
_ROWS = [DOP853.A[i, :i] for i in range(1, _STAGES)] + [DOP853.B]
_ERRORS = [DOP853.E5[:_STAGES], DOP853.E3[:_STAGES]]
_LENGTH, _PASSES, _DEPTH = 512, 20_000, 8


@dataclass(slots=True)
class Operations:
    """Operations on real numbers.

    Attributes
    ----------
    simple : float
        Additions, subtractions and multiplications.
    divisions : float
        Divisions.
    """

    simple: float = 0.0
    divisions: float = 0.0

    def __mul__(self, times: float) -> Operations:
        """Return the operations of this number of repetitions."""
        return Operations(self.simple * times, self.divisions * times)

    def __add__(self, other: Operations) -> Operations:
        """Return the sum of both counts."""
        return Operations(self.simple + other.simple, self.divisions + other.divisions)


class Counting:
    """A real or complex number that counts the real operations applied to it.

    Parameters
    ----------
    value : float or complex
        The number.
    done : Operations
        The count that it increases; numbers that are counted together share it.

    Examples
    --------
    >>> done = Operations()
    >>> x, z = Counting(3.0, done), Counting(1j, done)
    >>> y = 2.0 * x + x * z
    >>> done.simple  # 2x, xz, and one part of the sum
    4.0
    """

    __slots__ = ("done", "value")

    def __init__(self, value: complex, done: Operations) -> None:
        self.value, self.done = value, done

    def _after(self, value: complex, simple: int, divisions: int = 0) -> Counting:
        self.done.simple += simple
        self.done.divisions += divisions
        return Counting(value, self.done)

    def _with(self, other: Counting | complex) -> tuple[complex, int]:
        """Return the value of the other number, and how many of the two are complex."""
        value = other.value if isinstance(other, Counting) else other
        return value, isinstance(self.value, complex) + isinstance(value, complex)

    def __add__(self, other: Counting | complex) -> Counting:
        value, parts = self._with(other)
        return self._after(self.value + value, max(1, parts))

    def __sub__(self, other: Counting | complex) -> Counting:
        return self + (-other)

    def __mul__(self, other: Counting | complex) -> Counting:
        value, parts = self._with(other)
        return self._after(self.value * value, (1, 2, 6)[parts])

    def __truediv__(self, other: Counting | complex) -> Counting:
        value, parts = self._with(other)
        assert not parts, "complex numbers are divided by the rules' own quotient"
        return self._after(self.value / value, 0, 1)

    def __rtruediv__(self, other: float) -> Counting:
        assert not isinstance(self.value, complex)
        return self._after(other / self.value, 0, 1)

    def __neg__(self) -> Counting:
        return Counting(-self.value, self.done)  # free: part of the sum in which it occurs

    def __abs__(self) -> Counting:
        return Counting(abs(self.value), self.done)

    def __radd__(self, other: Counting | complex) -> Counting:
        return self + other

    def __rmul__(self, other: Counting | complex) -> Counting:
        return self * other

    def __rsub__(self, other: Counting | complex) -> Counting:
        return -self + other

    def __float__(self) -> float:
        """Return the value, which an exponential needs; neither is counted."""
        return float(self.value.real)

    def rint(self) -> Counting:
        """Return the nearest integer; called by numpy.rint."""
        return self._after(float(np.rint(self.value.real)), 1)

    def conjugate(self) -> Counting:
        """Return the conjugate, which costs nothing."""
        return Counting(self.value.conjugate(), self.done)

    @property
    def real(self) -> Counting:
        """Real part."""
        return Counting(self.value.real, self.done)

    @property
    def imag(self) -> Counting:
        """Imaginary part."""
        return Counting(self.value.imag, self.done)


def of_site_step(chain: VanDerPolChain) -> Operations:
    """Return the operations of one step of DOP853 per site: right-hand sides, stages, two errors.

    Examples
    --------
    >>> of_site_step(VdpChain(a=4, b=0.5, c=0.6)).divisions
    0.0
    """
    done = Operations()
    y, w = Counting(0.3, done), Counting(0.2, done)
    chain.kernel()((y, w), (y, w), (y, w), chain.kernel_parameters())
    combinations = sum(2 * int(np.count_nonzero(row)) + 1 for row in [*_ROWS, *_ERRORS])
    return done * _STAGES + Operations(simple=2.0 * combinations)


def of_site_series(chain: FrictionChain, order: int) -> Operations:
    """Return the operations for the coefficients of one new series of one site of (5).

    Examples
    --------
    >>> small, large = (of_site_series(FrictionChain(c=0.05), order) for order in (10, 20))
    >>> 3.0 < large.simple / small.simple < 4.0  # nearly as the square
    True
    """
    done = Operations()
    numbers = friction_series.new_numbers(chain.cell, chain.c, 1e-9)
    law = friction_series.law_of(chain.cell)
    series = np.full((3 + len(law), order + 1, 3), Counting(0.1, done))
    site = np.full((friction_series.ROWS, 3), 2.0, dtype=object)
    mode = np.zeros((friction_series.BEYOND + 1, 3), dtype=np.int64)
    mode[friction_series.MODE] = 1
    plain: Any = friction_series.expand
    plain.py_func(series, site, mode, numbers, law, 1, 2)
    return done


def of_sums(v: np.ndarray, c: np.ndarray, tolerance: float) -> Operations:
    """Return the operations at the points of the trapezoidal rule, for Σ without derivatives.

    Parameters
    ----------
    v, c : ndarray, shape (n,)
        Velocities and couplings for which the rule subtracts no root.
    tolerance : float
        Required truncation error.
    """
    done = Operations()

    def number(real: Any, imag: Any) -> Counting:
        return Counting(complex(*(x.value for x in (real, imag))), done)

    at = np.array([[Counting(x, done)] for x in axis._prepared(v[:1], c[:1])[:, 0]])
    totals = np.array([[Counting(0.0, done)] for _ in range(3)])
    with (
        mock.patch.object(axis, "complex", number, create=True),
        mock.patch.object(axis, "quotient", arithmetic.quotient_without_branches),
    ):
        axis._add_values(0.3, at, totals)
    counts, _ = axis.plan(v, c, tolerance)
    assert counts.all(), "a root is taken away somewhere"
    return done * float(np.sum(counts // 4))


@lru_cache(maxsize=1)
def rates() -> tuple[float, float]:
    """Return this machine's rates of multiply-adds, counted as two operations, and of divisions.

    Both are per second, the best of a few trials.
    """

    @njit(error_model="numpy", fastmath={"contract"})
    def multiply_add(x: Any, y: Any, passes: int) -> None:
        for _ in range(passes):
            for i in range(x.size):
                z, factor = x[i], y[i]
                for _ in range(_DEPTH):
                    z = z * factor + 1e-3
                x[i] = z

    @njit(error_model="numpy")
    def divide(x: Any, y: Any, passes: int) -> None:
        for _ in range(passes):
            for i in range(x.size):
                x[i] = 1.5 / (x[i] + y[i])

    x, y = np.full(_LENGTH, 0.5), np.full(_LENGTH, 0.9)
    found = []
    for loop, each in ((multiply_add, 2.0 * _DEPTH), (divide, 1.0)):
        call = partial(loop, x, y, _PASSES)
        call()  # compiles before the timing starts
        best = least_seconds(call, 5)
        found.append(each * _LENGTH * _PASSES / best)
    return found[0], found[1]


@dataclass(frozen=True, kw_only=True)
class Floor:
    """A run time and its floor.

    Attributes
    ----------
    name : str
        What is computed.
    operations, divisions : float
        Numbers of simple operations (without divisions) and of divisions.
    seconds : float
        Least processor time of a few calls.
    floor : float
        Time, in seconds, that the operations take at the machine's rates.
    """

    name: str
    operations: float
    divisions: float
    seconds: float
    floor: float

    @property
    def ratio(self) -> float:
        """Run time divided by its floor."""
        return self.seconds / self.floor


def measure(quick: bool, report: Report) -> list[Floor]:
    """Measure runs of (8), (43) and (5), and Σ in a batch."""
    repeats = 2 if quick else 5
    found = []
    chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=31)
    long = chain.replace(sites=1000)
    for name, model, end in (
        ("(8), 31 sites", chain, 1000.0),
        ("(43), 31 sites", chain.averaged(), 20_000.0),
        ("(8), 1000 sites", long, 100.0),
        ("(43), 1000 sites", long.averaged(), 1000.0),
    ):
        report(f"floor: {name}")
        found.append(_run(name, model, end, repeats))
    for sites, end in ((31, 200.0), (1000, 20.0)):
        report(f"floor: series of (5), {sites} sites")
        found.append(_event_run(FrictionChain(c=0.02, sites=sites), end, repeats))
    report("floor: sums")
    v, c = np.random.default_rng(1).uniform(0.3, 3.0, (2, 30_000))
    plain = axis.plan(v, c, 1e-12)[0] > 0
    v, c = v[plain][:MANY], c[plain][:MANY]
    sums(v, c, 1e-12)
    seconds = least_seconds(lambda: sums(v, c, 1e-12), repeats)
    found.append(_row(f"Σ at 1e-12, a batch of {v.size}", of_sums(v, c, 1e-12), seconds))
    return found


def _run(name: str, chain: VanDerPolChain, end: float, repeats: int) -> Floor:
    """Measure a run in which all sites move from the beginning."""
    start = excite(chain, range(1, chain.sites + 1)) * np.linspace(0.5, 1.0, chain.sites)

    def run() -> Any:
        return simulate(chain, start, end, samples=2, estimate_error=False)

    site_steps = run().counts["site_steps"]  # compiles here, before the timing
    return _row(name, of_site_step(chain) * site_steps, least_seconds(run, repeats))


def _event_run(chain: FrictionChain, end: float, repeats: int) -> Floor:
    """Measure a run from random positions of all sites, spread over the extent of the cycle."""
    rng, n = np.random.default_rng(1), chain.sites
    start = np.array([rng.uniform(-1.0, 2.0, n), rng.uniform(-1.0, 1.0, n)])

    def run() -> Any:
        return simulate(chain, start, end, samples=2, estimate_error=False)

    first = run()
    new = first.counts["site_steps"] + first.counts["local_series"]
    done = of_site_series(chain, taylor_order(first.tolerance)) * new
    return _row(f"series of (5), {n} sites", done, least_seconds(run, repeats))


def _row(name: str, done: Operations, seconds: float) -> Floor:
    simple, divisions = rates()
    return Floor(
        name=name,
        operations=done.simple,
        divisions=done.divisions,
        seconds=seconds,
        floor=done.simple / simple + done.divisions / divisions,
    )


def as_rows(floors: list[Floor]) -> list[dict[str, object]]:
    """Return the rows for JSON, with their ratio."""
    return [asdict(each) | {"ratio": each.ratio} for each in floors]


def as_text(floors: list[Floor]) -> str:
    """Return the table as text."""
    simple, divisions = rates()
    lines = [
        f"{'run time and floor':34} {'operations':>11} {'divisions':>10} {'seconds':>9} "
        f"{'floor':>9} {'ratio':>6}"
    ]
    lines += [
        f"{each.name:34} {each.operations:11.3g} {each.divisions:10.3g} {each.seconds:9.3g} "
        f"{each.floor:9.3g} {each.ratio:6.1f}"
        for each in floors
    ]
    lines.append(
        f"    at {simple:.3g} multiplications and additions, {divisions:.3g} divisions per s"
    )
    return "\n".join(lines)
