"""All phase-locked breathers of the averaged chain (43) for one nucleus size, steps free.

As c → 0 the core of a nucleus is on the cycle, and only its phases are undetermined. To first order
in c, the steps δ_j between neighbours lock when the cosines of the steps around every core site
have the same sum: cos δ_1 = cos δ_1 + cos δ_2 = … = cos δ_last. Thus every second step is ±π/2. If
the number of sites is odd, so are the others; if it is even, the others share one cosine, cos δ,
which is determined at the next order. Here δ runs over a grid, all signs are tried, and Newton's
method decides which of them are solutions.

The solver, ``verification.breathers.envelope``, follows one breather of a given pattern. This
module enumerates all breathers of a size, without scaling a and b, as an independent check. A
single breather in extended precision is computed in ``verification.references.precise_breather``.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from verification.references.equations import averaged_damping, pull_matrix

MARGIN = 9
"""Sites at rest on each side of the core; amplitudes decrease at least fivefold per site."""
START = 0.03
"""Coupling at which branches start."""
LONGEST = 0.004
"""Largest step in c."""
SAME = 1e-5
"""Breathers closer than this, up to a rotation of the phase and a reflection, are identical."""
TINY = 1e-7
"""Growth rates below this, per unit of slow time, are rounding errors of the zero phase mode."""


@dataclass(frozen=True, kw_only=True)
class LockedBreather:
    """A phase-locked breather φ_n = u_n e^{iΩT} of (43).

    Attributes
    ----------
    size : int
        Number of sites on the cycle as c → 0.
    c : float
        Coupling, dimensionless.
    phi : complex array, shape (N,)
        The envelope, N = size + 2 MARGIN sites with free ends.
    omega : float
        Ω per unit of slow time.
    growth : float
        Largest growth rate per unit of slow time over all perturbations except the rotation of the
        phase.
    """

    size: int
    c: float
    phi: ComplexArray = field(repr=False)
    omega: float
    growth: float

    @property
    def steps(self) -> FloatArray:
        """Phase steps of the core divided by π, each from -1 to 1."""
        core = self.phi[MARGIN:-MARGIN]
        return np.angle(core[1:] / core[:-1]) / np.pi

    @property
    def stable(self) -> bool:
        """Whether no perturbation grows."""
        return self.growth < TINY


@dataclass(frozen=True, kw_only=True)
class LockedBranch:
    """A breather followed in c from `START` to the end of its existence.

    Attributes
    ----------
    first, last : LockedBreather
        The breather at `START`, and just before the end.
    c_end : float
        Coupling of the fold at which the branch ends.
    stable : tuple of pairs of float
        Ranges of c, from `START` on, in which the breather is stable.
    """

    first: LockedBreather
    last: LockedBreather
    c_end: float
    stable: tuple[tuple[float, float], ...]


def residual(u: FloatArray, c: float, a: float, b: float) -> FloatArray:
    """Return the residual of the equations, u = (Re φ, Im φ, Ω), and of the phase condition."""
    sites = (u.size - 1) // 2
    phi = u[:sites] + 1j * u[sites:-1]
    rate = 0.5j * c * (pull_matrix(sites) @ phi) - 0.5 * phi * averaged_damping(np.abs(phi), a, b)
    equations = rate - 1j * u[-1] * phi
    return np.concatenate([equations.real, equations.imag, [phi[MARGIN].imag]])


def jacobian(u: FloatArray, c: float, a: float, b: float) -> FloatArray:
    """Return the analytic derivative of `residual` with respect to u."""
    sites = (u.size - 1) // 2
    x, y = u[:sites], u[sites:-1]
    square = x * x + y * y
    drag = 0.5 * averaged_damping(np.abs(x + 1j * y), a, b)
    bend = 0.5 * (-a / 4.0 + b * square / 4.0)  # derivative of drag with respect to |φ|²
    springs = 0.5 * c * pull_matrix(sites) - u[-1] * np.eye(sites)
    matrix = np.zeros((u.size, u.size))
    matrix[:sites, :sites] = np.diag(-drag - 2.0 * bend * x * x)
    matrix[:sites, sites:-1] = -springs - np.diag(2.0 * bend * x * y)
    matrix[sites:-1, :sites] = springs - np.diag(2.0 * bend * x * y)
    matrix[sites:-1, sites:-1] = np.diag(-drag - 2.0 * bend * y * y)
    matrix[:sites, -1], matrix[sites:-1, -1] = y, -x
    matrix[-1, sites + MARGIN] = 1.0
    return matrix


def solve(guess: FloatArray, c: float, a: float, b: float, rounds: int = 40) -> FloatArray | None:
    """Solve by Newton's method, with steps of at most 0.5; None if it does not converge."""
    u = guess.copy()
    for _ in range(rounds):
        off = residual(u, c, a, b)
        if float(np.linalg.norm(off)) < 1e-12:
            return u
        try:
            step = np.linalg.solve(jacobian(u, c, a, b), off)
        except np.linalg.LinAlgError:
            return None
        u = u - min(1.0, 0.5 / float(np.abs(step).max())) * step
    return None


def growth_rate(u: FloatArray, c: float, a: float, b: float, *, mirrored: bool = False) -> float:
    """Return the largest real part of the exponents, without the zero phase mode.

    With ``mirrored``, only perturbations with mirror symmetry are considered.
    """
    matrix = jacobian(u, c, a, b)[:-1, :-1]
    if mirrored:
        sites = matrix.shape[0] // 2
        half = (np.eye(sites) + np.eye(sites)[::-1])[:, : (sites + 1) // 2]
        even = np.kron(np.eye(2), half / np.linalg.norm(half, axis=0))
        matrix = even.T @ matrix @ even
    rates = np.linalg.eigvals(matrix)
    return float(np.delete(rates, np.argmin(np.abs(rates))).real.max())


def phase_patterns(size: int, grid: int = 13) -> Iterator[FloatArray]:
    """Yield the phase steps that lock to first order in c; for even sizes, δ runs over a grid.

    Examples
    --------
    >>> len(list(phase_patterns(3))), len(list(phase_patterns(2, 5)))
    (4, 5)
    """
    links = size - 1
    seconds = range(1, links, 2)
    odd = range(0, links, 2)
    quarter = 0.5 * np.pi
    deltas = [quarter] if size % 2 else np.linspace(0.0, np.pi, grid)
    for delta in deltas:
        loose = (1.0,) if delta in (0.0, np.pi) else (1.0, -1.0)
        for signs in itertools.product((1.0, -1.0), repeat=len(seconds)):
            for others in itertools.product(loose, repeat=len(odd)):
                if size == 2 and others[0] < 0.0:
                    continue  # the reflection of another pattern
                steps = np.empty(links)
                steps[list(seconds)] = quarter * np.array(signs)
                steps[list(odd)] = float(delta) * np.array(others)
                yield steps


def locked_breathers(size: int, a: float, b: float) -> list[LockedBreather]:
    """Enumerate the phase-locked breathers of one nucleus size at `START`, each once.

    Two breathers that differ by a reflection count as one.

    Parameters
    ----------
    size : int
        Number of sites on the cycle.
    a, b : float
        Damping, dimensionless; η = b/a² < 1/8.
    """
    return _distinct(phase_patterns(size), size, a, b)


def family(size: int, a: float, b: float) -> list[LockedBreather]:
    """Return the breathers of an even size with steps δ, π/2, δ, π/2, …, of one sense or mirrored.

    For large sizes, for which there are too many combinations of signs. Every second step keeps one
    sign throughout (running) or changes it at the middle (mirrored), and so does δ; a step δ in the
    middle is then 0 or π.
    """
    links = size - 1
    patterns = []
    for delta in np.linspace(0.0, np.pi, 25):
        for mirrored, sense, side in itertools.product((False, True), (1.0, -1.0), (1.0, -1.0)):
            steps = np.where(np.arange(links) % 2 == 0, sense * delta, side * 0.5 * np.pi)
            if mirrored:
                steps[: links // 2] *= -1.0
                if links // 2 % 2 == 0:
                    steps[links // 2] = 0.0 if delta < 0.5 * np.pi else np.pi
            patterns.append(steps)
    return _distinct(patterns, size, a, b)


def _distinct(
    patterns: Iterable[FloatArray], size: int, a: float, b: float
) -> list[LockedBreather]:
    """Return the distinct breathers of a size to which the patterns of phase steps lead."""
    found: list[LockedBreather] = []
    for steps in patterns:
        u = solve(start_from(steps, a, b, START), START, a, b)
        if u is None or not _is_nucleus(u, size, a, b):
            continue
        here = _breather(u, size, START, a, b)
        if not any(_same(here.phi, other.phi) for other in found):
            found.append(here)
    return found


def follow(start: LockedBreather, a: float, b: float) -> LockedBranch:
    """Follow a breather in c to its end, halving the step where Newton's method fails.

    At the end two solutions meet. There, their distance varies like √(c_end - c), so that the last
    points determine c_end.
    """
    c, u, step = start.c, _unknowns(start), LONGEST
    before: tuple[float, FloatArray] | None = None
    history = [(c, start.growth)]
    while step > 1e-8:
        guess = u if before is None else u + (u - before[1]) * step / (c - before[0])
        trial = solve(guess, c + step, a, b, 12)
        moved = np.inf if trial is None else float(np.abs(trial - guess).max())
        if trial is None or moved > 0.05:
            step *= 0.5
            continue
        before, c, u = (c, u), c + step, trial
        history.append((c, growth_rate(u, c, a, b)))
        if moved < 0.005:
            step = min(2.0 * step, LONGEST)
        if c > 1.0:
            break
    last = _breather(u, start.size, c, a, b)
    return LockedBranch(first=start, last=last, c_end=c + step, stable=_ranges(history))


def start_from(steps: FloatArray, a: float, b: float, c: float) -> FloatArray:
    """Return unknowns with the core on the cycle at the given phase steps, and linear tails."""
    root = np.sqrt(1.0 - 8.0 * b / a**2)
    cycle = np.sqrt(a / b * (1.0 + root))
    phases = np.concatenate([[0.0], np.cumsum(steps)])
    core = cycle * np.exp(1j * phases)
    decay = -1j * c  # φ_{n+1} ≈ -ic φ_n outside the core, to first order
    tail = decay ** np.arange(1, MARGIN + 1)
    phi = np.concatenate([core[0] * tail[::-1], core, core[-1] * tail])
    return np.concatenate([phi.real, phi.imag, [c]])


def _unknowns(found: LockedBreather) -> FloatArray:
    turned = found.phi * np.exp(-1j * np.angle(found.phi[MARGIN]))
    return np.concatenate([turned.real, turned.imag, [found.omega]])


def _breather(u: FloatArray, size: int, c: float, a: float, b: float) -> LockedBreather:
    sites = (u.size - 1) // 2
    phi = u[:sites] + 1j * u[sites:-1]
    return LockedBreather(
        size=size, c=c, phi=phi, omega=float(u[-1]), growth=growth_rate(u, c, a, b)
    )


def _is_nucleus(u: FloatArray, size: int, a: float, b: float) -> bool:
    """Whether exactly the core is near the stable cycle."""
    root = np.sqrt(1.0 - 8.0 * b / a**2)
    unstable = np.sqrt(a / b * (1.0 - root))
    sites = (u.size - 1) // 2
    high = np.hypot(u[:sites], u[sites:-1]) > 1.2 * unstable
    core = np.zeros(sites, dtype=bool)
    core[MARGIN : MARGIN + size] = True
    return bool(np.array_equal(high, core))


def _same(one: ComplexArray, other: ComplexArray) -> bool:
    """Whether two envelopes differ at most by a rotation of the phase and a reflection."""
    for phi in (other, other[::-1]):
        turn = np.vdot(phi, one)
        if np.abs(one - phi * turn / abs(turn)).max() < SAME:
            return True
    return False


def _ranges(history: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Return the ranges of c in which the growth rate is not above rounding."""
    ranges: list[tuple[float, float]] = []
    begin: float | None = None
    for place, (c, growth) in enumerate(history):
        if growth < TINY:
            begin = c if begin is None else begin
            if place == len(history) - 1:
                ranges.append((begin, c))
        elif begin is not None:
            ranges.append((begin, history[place - 1][0]))
            begin = None
    return tuple(ranges)


def follow_to(start: LockedBreather, c: float, a: float, b: float) -> LockedBreather:
    """Follow a breather to a given coupling.

    Raises
    ------
    ArithmeticError
        If the branch ends before that.
    """
    couplings = np.linspace(start.c, c, max(2, round(abs(c - start.c) / LONGEST)))[1:]
    u = _solved_along(_unknowns(start), couplings, start.size, a, b)
    return _breather(u, start.size, c, a, b)


def outward_breather(size: int, c: float, a: float, b: float) -> FloatArray:
    """Return the unknowns of the mirror-symmetric breather of odd size with steps π/2 outwards.

    Raises
    ------
    ArithmeticError
        If the branch ends before that.
    """
    outward = np.where(np.arange(size - 1) < (size - 1) // 2, -0.5 * np.pi, 0.5 * np.pi)
    couplings = np.linspace(START, c, max(2, 1 + round(abs(c - START) / 0.002)))
    return _solved_along(start_from(outward, a, b, START), couplings, size, a, b)


def _solved_along(
    u: FloatArray, couplings: FloatArray, size: int, a: float, b: float
) -> FloatArray:
    """Return the unknowns at the last of several couplings, solved successively."""
    for c in couplings.tolist():
        found = solve(u, c, a, b)
        if found is None:
            raise ArithmeticError(f"the breather of size {size} ends before c = {couplings[-1]:g}")
        u = found
    return u
