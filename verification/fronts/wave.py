"""Fronts of the averaged chain (43) as solutions: v by Newton's method, and the stability spectrum.

With φ_n = (-i)^n r_n e^{icT}, r_n real, a front whose phase lags by a quarter turn a site obeys

    r_n' = (c/2)(r_{n-1} - r_{n+1}) - r_n g(r_n²),    g(s) = ½(1 - a s/4 + b s²/8),

and travels without change if after a time τ = 1/v each site is where its left neighbour was,
r_{n+1}(τ) = r_n(0): Newton's method in (r, τ) on a window of sites, with the matrix of the
variational equations over τ. To the left of the window is the stable cycle, to the right rest.
Nothing is fitted to arrival times. The scaling r → r√a makes everything depend on η = b/a² and c
only.

The same matrix, shifted by one site, is the map of small disturbances from site to site: its
eigenvalues are the multipliers of the front, one of them 1 (a shift in time). Disturbances ahead of
the front fade by e^{-1/2v} a site, which bounds the continuous spectrum.

Fronts at rest end, as c grows, in a fold at c_pin; beyond it v grows like √(c - c_pin).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
import numpy.typing as npt
from scipy.integrate import DOP853

from theory.cells.vdp import ETA_END, threshold_ratio
from theory.parameters import RunError, within

FloatArray = npt.NDArray[np.float64]

SMALLEST_ETA, LARGEST_ETA = 1e-3, 0.085
"""Below, the cycle attracts at a rate of 1/2η and steps are too many; above, fronts may retreat."""
LARGEST_COUPLING = 1e3

_STEP = 0.8
"""Step times the largest rate; at this DOP853 errs by some 1e-12 a period."""
_FEWEST = 16
"""Steps of a period, at least."""
_FINER, _WIDER = 1.5, 8
"""The check is made with so much finer steps, on a window longer by so many sites at each end."""
_PERIODS, _SETTLED = 20, 1e-5
"""Sites that a started front passes at most, and change of its intervals at which it has passed
enough for Newton's method."""
_LONGEST = 400.0
"""Time after which a chain that no site has joined is taken to be at rest."""
_MARGIN = 1.02


class NoFrontError(RunError):
    """No travelling front was found at these parameters."""


@dataclass(frozen=True, kw_only=True)
class FrontWave:
    """A travelling front of (43).

    Attributes
    ----------
    c, eta : float
        Coupling and η = b/a², dimensionless.
    v : float
        Velocity v̂ in sites per unit of slow time εt.
    error : float
        Bound on the error of v, from a second solution on a longer window with finer steps.
    r : ndarray of float, shape (N,)
        √a times the amplitudes of the sites, at the moment when site ``crossing`` passes the
        unstable cycle.
    crossing : int
        Index of that site.
    multipliers : ndarray of complex, shape (m,)
        Multipliers of disturbances of the amplitudes beyond the continuous spectrum, the trivial
        one left out; descending in modulus.
    continuum : float
        e^{-1/2v}, the modulus of the continuous spectrum.
    trivial_defect : float
        Distance from 1 of the multiplier that is exactly 1.
    stable : bool
        Whether all multipliers are inside the unit circle.
    iterations, steps : int
        Newton iterations, and steps a period.
    seconds : float
        Run time.
    """

    c: float
    eta: float
    v: float
    error: float
    r: FloatArray
    crossing: int
    multipliers: npt.NDArray[np.complex128]
    continuum: float
    trivial_defect: float
    stable: bool
    iterations: int
    steps: int
    seconds: float


def front_wave(c: float, eta: float, start: FrontWave | None = None) -> FrontWave:
    """Return the travelling front of (43) at coupling c.

    Parameters
    ----------
    c : float
        Coupling, dimensionless, up to 1e3.
    eta : float
        η = b/a², from 1e-3 to 0.085.
    start : FrontWave, optional
        A front at a coupling nearby from which Newton's method begins; by default the chain is run
        from a step until the intervals between sites settle.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    NoFrontError
        If the front is pinned (c below c_pin), or Newton's method does not converge.

    References
    ----------
    Chow, Mallet-Paret and Shen (1998), Traveling waves in lattice dynamical systems, J. Differ.
    Equations 149, for the period map; the steps are those of DOP853 (Hairer, Nørsett and Wanner,
    1993).

    Examples
    --------
    >>> front = front_wave(0.6, 0.03125)
    >>> round(front.v, 9), front.error < 1e-11, front.stable
    (0.722566456, True, True)
    """
    begin = perf_counter()
    cell = _Cell.at(eta)
    within("coupling c", c, 1e-6, LARGEST_COUPLING)
    window = _Window.at(cell, c)
    guess = window.relaxed() if start is None else window.placed(start)
    first = window.solved(*guess)
    wider = _Window(cell, c, window.left + _WIDER, window.right + _WIDER, window.step / _FINER)
    last = wider.solved(wider.extended(first.r), first.period)
    v = float(1.0 / last.period)
    error = 2.0 * abs(v - 1.0 / first.period) + 64.0 * float(np.finfo(float).eps) * v
    continuum = math.exp(-0.5 / v)
    multipliers = np.linalg.eigvals(last.shifted)
    trivial = int(np.argmin(np.abs(multipliers - 1.0)))
    others = np.delete(multipliers, trivial)
    others = others[np.argsort(-np.abs(others))]
    return FrontWave(
        c=c,
        eta=eta,
        v=v,
        error=error,
        r=last.r,
        crossing=wider.left,
        multipliers=others[np.abs(others) > _MARGIN * continuum],
        continuum=continuum,
        trivial_defect=float(abs(multipliers[trivial] - 1.0)),
        stable=bool(np.abs(others).max(initial=0.0) < 1.0),
        iterations=first.iterations + last.iterations,
        steps=last.steps,
        seconds=perf_counter() - begin,
    )


def follow_front(couplings: Sequence[float], eta: float) -> Iterator[FrontWave]:
    """Yield the fronts at several couplings, each from the one before; the first one is started.

    Parameters
    ----------
    couplings : sequence of float
        In the order in which they are to be followed; neighbours within some ten per cent.
    eta : float
        η = b/a², from 1e-3 to 0.085.

    Raises
    ------
    NoFrontError
        Where the branch ends.
    """
    last: FrontWave | None = None
    for c in couplings:
        last = front_wave(float(c), eta, last)
        yield last


@dataclass(frozen=True, kw_only=True)
class StaticFold:
    """Where the fronts of (43) at rest end.

    Attributes
    ----------
    c : float
        c_pin, dimensionless.
    error : float
        Bound on its error, from a longer window and from rounding.
    r : ndarray of float, shape (N,)
        √a times the amplitudes of the sites there.
    """

    c: float
    error: float
    r: FloatArray


def static_fold(eta: float) -> StaticFold:
    """Return c_pin(η) of (43): fronts with a quarter-turn phase step rest up to it.

    (c/2)(r_{n-1} - r_{n+1}) = r_n g(r_n²) is followed from c = 0 by pseudo-arclength, and the fold
    solved by Newton's method on the state, c and the vector of the kernel.

    Raises
    ------
    ParameterError
        If η is out of range.
    NoFrontError
        If the branch has no fold below c = 1e3.

    References
    ----------
    Seydel (2010), Practical Bifurcation and Stability Analysis, for the extended system.

    Examples
    --------
    >>> fold = static_fold(0.03125)
    >>> front_wave(2.0 * fold.c, 0.03125).v > 0
    True
    """
    cell = _Cell.at(eta)
    found = []
    for left, right in ((12, 40), (16, 56)):
        r, c = _to_the_fold(cell, left, right)
        found.append((r, c))
    error = 2.0 * abs(found[1][1] - found[0][1]) + 1e-14
    return StaticFold(c=found[1][1], error=error, r=found[1][0])


@dataclass(frozen=True)
class _Cell:
    """One cell at a = 1, b = η: amplitudes of its cycles, and its damping."""

    eta: float
    stable: float
    unstable: float
    attraction: float

    @classmethod
    def at(cls, eta: float) -> _Cell:
        within(
            "eta = b/a^2", eta, SMALLEST_ETA, LARGEST_ETA, "measure the front on a running chain"
        )
        root = math.sqrt(1.0 - eta / ETA_END)
        stable = math.sqrt((1.0 + root) / eta)
        return cls(eta, stable, threshold_ratio(eta) * stable, (1.0 + root) * root / (4.0 * eta))

    def damping(self, r: FloatArray) -> FloatArray:
        """Return r g(r²)."""
        s = r * r
        damped: FloatArray = 0.5 * r * (1.0 - 0.25 * s + 0.125 * self.eta * s * s)
        return damped

    def slope(self, r: FloatArray) -> FloatArray:
        """Return d(r g)/dr."""
        s = r * r
        slope: FloatArray = 0.5 - 0.375 * s + 0.3125 * self.eta * s * s
        return slope


@dataclass(frozen=True)
class _Period:
    """A solution of r_{n+1}(τ) = r_n(0), with the matrix of disturbances from site to site."""

    r: FloatArray
    period: float
    shifted: FloatArray
    iterations: int
    steps: int


@dataclass(frozen=True)
class _Window:
    """Sites around a front: ``left`` of them behind the one that passes the unstable cycle."""

    cell: _Cell
    c: float
    left: int
    right: int
    step: float

    @classmethod
    def at(cls, cell: _Cell, c: float) -> _Window:
        """Choose it so wide that the front has died away to rounding, and the step so short.

        At strong coupling the front is (c/6)^{1/3} wide, with a tail behind it that fades slowly
        where η is large.
        """
        width = max(1.0, math.cbrt(c))
        left = 14 + math.ceil(10.0 * width * max(1.0, 2.0 / cell.attraction))
        return cls(cell, c, left, 12 + math.ceil(30.0 * width), _STEP / (c + cell.attraction))

    @property
    def sites(self) -> int:
        return self.left + self.right

    def rate(self, x: FloatArray) -> FloatArray:
        """Return the derivative of (r | disturbances), shape (N, 1 + m)."""
        before, after = np.zeros_like(x), np.zeros_like(x)
        before[1:], after[:-1] = x[:-1], x[1:]
        before[0, 0] = self.cell.stable
        out: FloatArray = 0.5 * self.c * (before - after)
        out[:, 0] -= self.cell.damping(x[:, 0])
        out[:, 1:] -= self.cell.slope(x[:, 0])[:, None] * x[:, 1:]
        return out

    def advanced(self, x: FloatArray, time: float) -> FloatArray:
        """Return x after a time, by equal steps of DOP853."""
        steps = self.steps_in(time)
        h = time / steps
        for _ in range(steps):
            slopes = [self.rate(x)]
            for row in DOP853.A[1 : DOP853.n_stages]:
                slopes.append(self.rate(x + h * _combined(row, slopes)))
            x = x + h * _combined(DOP853.B, slopes)
        return x

    def steps_in(self, time: float) -> int:
        """Return the number of steps of a period."""
        return max(_FEWEST if time > self.step else 1, math.ceil(time / self.step - 1e-9))

    def relaxed(self) -> tuple[FloatArray, float]:
        """Return the state of a chain that has run from a step, and its last interval.

        Raises
        ------
        NoFrontError
            If no site was joined for a long time.
        """
        r = np.where(np.arange(self.sites) <= self.left, self.cell.stable, 0.0)[:, None]
        time, last, interval, before = 0.0, 0.0, 1.0, 0.0
        crossings = 0
        while crossings < _PERIODS and abs(interval - before) > _SETTLED * interval:
            after = self.advanced(r, self.step)
            if after[self.left + 1, 0] < self.cell.unstable:
                r, time = after, time + self.step
                if time - last > _LONGEST:
                    raise NoFrontError(
                        f"no front travels at c = {self.c:.6g}, eta = {self.cell.eta:.6g}: the "
                        f"next site has not been reached for {_LONGEST:g} units of slow time; "
                        "take a larger coupling, or ask for c_pin."
                    )
                continue
            part = self._passing_time(r)
            r = self._moved_on(self.advanced(r, part))
            time += part
            before, interval, last, crossings = interval, time - last, time, crossings + 1
        return r[:, 0], interval

    def _passing_time(self, r: FloatArray) -> float:
        """Return the time within a step at which the next site passes the unstable cycle."""
        low, high = 0.0, self.step
        below, above = (
            self.advanced(r, part)[self.left + 1, 0] - self.cell.unstable for part in (low, high)
        )
        for _ in range(6):  # the secant rule; Newton's method does the rest
            middle = low - below * (high - low) / (above - below)
            value = self.advanced(r, middle)[self.left + 1, 0] - self.cell.unstable
            if value < 0.0:
                low, below = middle, value
            else:
                high, above = middle, value
        return float(high)

    @staticmethod
    def _moved_on(r: FloatArray) -> FloatArray:
        """Return the window one site further on."""
        return np.vstack([r[1:], np.zeros((1, r.shape[1]))])

    def placed(self, start: FrontWave) -> tuple[FloatArray, float]:
        """Return another front on this window."""
        r = np.full(self.sites, self.cell.stable)
        position = np.arange(self.sites) - self.left + start.crossing
        inside = (position >= 0) & (position < start.r.size)
        r[inside] = start.r[position[inside]]
        r[position >= start.r.size] = 0.0
        return r, 1.0 / start.v

    def extended(self, r: FloatArray) -> FloatArray:
        """Return a state of a window that is shorter by ``_WIDER`` sites at each end, on this."""
        ends = np.full(_WIDER, self.cell.stable), np.zeros(_WIDER)
        return np.concatenate([ends[0], r, ends[1]])

    def solved(self, r: FloatArray, period: float) -> _Period:
        """Solve by Newton's method from a state and a period.

        Raises
        ------
        NoFrontError
            If it does not converge.
        """
        sites, steps = self.sites, self.steps_in(period)
        shifted = system = np.empty((0, 0))
        last, size = math.inf, math.inf
        for iteration in range(1, 40):
            fresh = not size < 0.1 * last  # the matrix is computed anew where it no longer serves
            x = r[:, None]
            if fresh:
                x = np.concatenate([x, np.eye(sites)], axis=1)
            end = self.advanced(x, period)
            if fresh:
                shifted = self._moved_on(end[:, 1:])
                system = np.zeros((sites + 1, sites + 1))
                system[:sites, :sites] = shifted - np.eye(sites)
                system[:sites, sites] = self._moved_on(self.rate(end[:, :1]))[:, 0]
                system[sites, self.left] = 1.0
            defect = self._moved_on(end[:, :1])[:, 0] - r
            wrong = np.append(defect, r[self.left] - self.cell.unstable)
            change = np.linalg.solve(system, wrong)
            r, period = r - change[:sites], period - float(change[sites])
            last, size = size, float(np.abs(change).max())
            if not (math.isfinite(size) and period > 0.0):
                break
            if size < 1e-11 * self.cell.stable:
                return _Period(r, period, shifted, iteration, steps)
        raise NoFrontError(
            f"Newton's method found no front at c = {self.c:.6g}, eta = {self.cell.eta:.6g}; "
            "start from a front at a coupling nearby, or measure it on a running chain."
        )


def _combined(weights: FloatArray, slopes: Sequence[FloatArray]) -> FloatArray:
    """Return the sum of weights times slopes, without those that are zero."""
    total = np.zeros_like(slopes[0])
    for weight, slope in zip(weights, slopes, strict=False):
        if weight:
            total += weight * slope
    return total


def _static(cell: _Cell, r: FloatArray, c: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the defect of a front at rest, its matrix, and its derivative by c."""
    padded = np.concatenate([[cell.stable], r, [0.0]])
    by_c = 0.5 * (padded[:-2] - padded[2:])
    shifts = np.eye(r.size, k=-1) - np.eye(r.size, k=1)
    return c * by_c - cell.damping(r), 0.5 * c * shifts - np.diag(cell.slope(r)), by_c


def _to_the_fold(cell: _Cell, left: int, right: int) -> tuple[FloatArray, float]:
    """Follow the front at rest from c = 0 to its fold."""
    sites = left + right
    r, c = np.where(np.arange(sites) < left, cell.stable, 0.0), 0.0
    tangent = np.append(np.zeros(sites), 1.0)
    step = 0.02
    while c < LARGEST_COUPLING:
        _, matrix, by_c = _static(cell, r, c)
        bordered = np.vstack([np.column_stack([matrix, by_c]), tangent])
        new = np.linalg.solve(bordered, np.append(np.zeros(sites), 1.0))
        new /= np.linalg.norm(new)
        if new[-1] < 0.0:
            return _fold(cell, r, c, new[:-1] / np.linalg.norm(new[:-1]))
        there = _corrected(cell, np.append(r, c) + step * new, new)
        if there is None:
            step *= 0.5
            if step < 1e-6:
                break
            continue
        r, c, tangent, step = there[:-1], float(there[-1]), new, min(1.3 * step, 0.2)
    raise NoFrontError(
        f"fronts at rest have no fold at eta = {cell.eta:.6g} below c = {LARGEST_COUPLING:g}."
    )


def _corrected(cell: _Cell, start: FloatArray, tangent: FloatArray) -> FloatArray | None:
    """Return the point of the branch in the plane through ``start`` across the tangent."""
    x = start.copy()
    for _ in range(8):
        defect, matrix, by_c = _static(cell, x[:-1], float(x[-1]))
        bordered = np.vstack([np.column_stack([matrix, by_c]), tangent])
        change = np.linalg.solve(bordered, np.append(defect, tangent @ (x - start)))
        x = x - change
        if np.abs(change).max() < 1e-12 * cell.stable:
            return x
    return None


def _fold(cell: _Cell, r: FloatArray, c: float, kernel: FloatArray) -> tuple[FloatArray, float]:
    """Solve defect = 0, matrix · kernel = 0, |kernel|² = 1 by Newton's method.

    Raises
    ------
    NoFrontError
        If it does not converge.
    """
    n = r.size
    for _ in range(30):
        defect, matrix, by_c = _static(cell, r, c)
        bend = -np.diag((-0.75 * r + 1.25 * cell.eta * r**3) * kernel)  # d(matrix·kernel)/dr
        shifts = 0.5 * (np.eye(n, k=-1) - np.eye(n, k=1))
        system = np.zeros((2 * n + 1, 2 * n + 1))
        system[:n, :n], system[:n, -1] = matrix, by_c
        system[n : 2 * n, :n], system[n : 2 * n, n : 2 * n] = bend, matrix
        system[n : 2 * n, -1] = shifts @ kernel
        system[-1, n : 2 * n] = 2.0 * kernel
        wrong = np.concatenate([defect, matrix @ kernel, [kernel @ kernel - 1.0]])
        change = np.linalg.solve(system, wrong)
        r, kernel = r - change[:n], kernel - change[n : 2 * n]
        c -= float(change[-1])
        if np.abs(change).max() < 1e-12 * cell.stable:
            return r, c
    raise NoFrontError(f"the fold of fronts at rest was not found at eta = {cell.eta:.6g}.")
