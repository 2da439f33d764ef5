"""Fronts of the averaged chain (43) as travelling waves: v by Newton's method, and stability.

With φ_n = (-i)^n r_n e^{icT}, r_n real, a front whose phase lags by a quarter turn per site obeys

    r_n' = (c/2)(r_{n-1} - r_{n+1}) - r_n g(r_n),    g = ½(1 - a r²/4 + b r⁴/8),

and travels without change of shape if each site, after a time 1/v, is where its left neighbour was:
r_{n+1}(1/v) = r_n(0). This is solved for (r, v) by Newton's method on a window of sites, with the
matrix of the variational equations over that time. To the left of the window is the stable cycle,
to the right is rest. Arrival times are not used. After the scaling r → r√a everything depends on η
= b/a² and c only.

The same matrix, shifted by one site, maps small disturbances from site to site; its eigenvalues are
the multipliers of the front, and one of them is 1 (a shift in time). Ahead of the front,
disturbances decay by a factor e^{-1/2v} per site, and behind it faster: this is the continuous
spectrum of the amplitudes. To first order, disturbances of the phases are independent of those of
the amplitudes; far behind the front they are waves that neither grow nor decay, and one multiplier
is 1 (a rotation of all phases).

Fronts at rest end in a fold at c_pin (``resting``). From there v grows like √(c - c_pin), and v is
a single-valued function of c up to the law of strong coupling (``theory.averaged.front``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from time import perf_counter
from typing import ClassVar

import numpy as np

from theory.arrays import EPS, ComplexArray, FloatArray
from theory.cells.vdp import (
    ETA_END,
    attraction_rate,
    eta_of_fronts,
    threshold_ratio,
    threshold_ratio_slope,
)
from theory.parameters import Range, RunError, with_ranges, within
from theory.result import Result
from verification.continuation.newton import BranchPoint, NotConvergedError, System, solve_at
from verification.fronts.resting import ETAS, amplitudes_of, static_fold
from verification.steppers.amplitudes import (
    Amplitudes,
    Parameter,
    advanced,
    rate,
    steps_in,
    with_disturbances,
)

COUPLINGS = Range(1e-6, 1e3)
SLOWEST = 1e-3
"""Slowest front that is computed; slower ones lie within 1e-5 of c_pin and would take minutes."""

_STEP = 0.5
"""Step times the largest rate; with it, the error of DOP853 is below 1e-12 per period."""
_FINER = 1.5
"""Factor by which the steps of the check are shorter."""
_DEPTHS = 30.0, 36.0
"""Logarithm of the decay of the front towards the ends of its window; the second is for the
check."""
_PERIODS, _SETTLED = 30, 1e-4
"""Largest number of sites that the initial run passes, and relative change of the interval between
sites below which its front is a good enough starting point for Newton's method. A front that is
wider than a site settles more slowly: these are multiplied and divided by the square of its width.
"""
_LISTED = 6
"""Number of multipliers listed."""
_ROUNDING = 64.0 * EPS
_NEUTRAL = 1e-8
"""Largest error allowed in a modulus that is exactly one."""


class NoFrontError(RunError):
    """No travelling front was found at the given parameters."""


@dataclass(frozen=True, kw_only=True)
class FrontWave(Result):
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
        unstable cycle; no error is known.
    crossing : int
        Index of that site.
    stable : bool
        Whether every disturbance of the amplitudes decays and no disturbance of the phases grows.
    multipliers : ndarray of complex, shape (6,)
        Largest multipliers of disturbances of the amplitudes from site to site, without the trivial
        one, in descending order of modulus. Those with a modulus of at most ``continuum`` represent
        the continuous spectrum and depend on the window.
    multipliers_error : ndarray of float, shape (6,)
        Errors of these, from the first solution; infinite, as none is known, for those that
        represent the continuous spectrum.
    phase_multiplier, phase_multiplier_error : float
        Largest modulus of the multipliers of phase disturbances, and its error, from the first
        solution and, as a rotation of all phases of an infinite chain has the multiplier 1, at
        least the distance below 1.
    continuum : float
        e^{-1/2v}, the modulus of the continuous spectrum ahead of the front, to rounding.
    trivial : float
        Distance from 1 of the computed multiplier that is exactly 1 in theory.
    iterations, steps : int
        Evaluations of the period map, and steps per period.
    seconds : float
        Run time.
    """

    shown: ClassVar[tuple[str, ...]] = (
        "stable", "multipliers", "multipliers_error", "phase_multiplier", "phase_multiplier_error",
        "continuum",
    )  # fmt: skip

    c: float
    eta: float
    v: float
    error: float
    r: FloatArray
    crossing: int
    stable: bool
    multipliers: ComplexArray
    multipliers_error: FloatArray
    phase_multiplier: float
    phase_multiplier_error: float
    continuum: float
    trivial: float
    iterations: int
    steps: int
    seconds: float


@with_ranges(c=COUPLINGS, eta=ETAS, slowest=SLOWEST)
def front_wave(c: float, eta: float) -> FrontWave:
    """Return the travelling front of (43) at coupling c.

    Parameters
    ----------
    c : float
        Coupling, dimensionless, {c}.
    eta : float
        η = b/a², {eta}.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    NoFrontError
        If the front is pinned (c below c_pin), or slower than {slowest}.

    References
    ----------
    Chow, Mallet-Paret and Shen (1998), Traveling waves in lattice dynamical systems, J. Differ.
    Equations 149, for the period map.

    Examples
    --------
    >>> front = front_wave(0.6, 0.03125)
    >>> round(front.v, 9), front.error < 1e-11, front.stable
    (0.722566456, True, True)
    """
    begin = perf_counter()
    window = Window.started(c, eta)
    try:
        point = solve_at(window.system(), window.guess, window.chain.c)
    except NotConvergedError as refusal:
        raise not_found(refusal, "c") from None
    return window.described(point, begin)


def not_found(refusal: NotConvergedError, along: Parameter) -> NoFrontError:
    """Return the error for a search that failed at a value of the continuation parameter.

    The message of the search itself is worded for breathers, which end at large couplings, whereas
    fronts end at small ones.
    """
    if refusal.at is None:
        return NoFrontError(str(refusal))
    return NoFrontError(
        f"no front was found at {along} = {refusal.at:.6g}: take a value farther from where "
        "fronts are pinned."
    )


@dataclass(frozen=True)
class Window:
    """Sites around a front: ``left`` of them behind the one that passes the unstable cycle.

    ``along`` names the parameter, c or η, in which the fronts on it are followed.
    """

    chain: Amplitudes
    left: int
    right: int
    guess: FloatArray
    along: Parameter = "c"

    @property
    def unstable(self) -> float:
        """Value of ρ on the unstable cycle."""
        return threshold_ratio(self.chain.eta)

    @property
    def attraction(self) -> float:
        """Rate at which the stable cycle attracts."""
        return attraction_rate(self.chain.eta)

    @property
    def place(self) -> float:
        """Value of the parameter in which the fronts are followed."""
        return self.chain.c if self.along == "c" else self.chain.eta

    def at(self, value: float) -> Window:
        """Return the same window at another value of the parameter.

        Raises
        ------
        NotConvergedError
            If the value is outside the range in which fronts exist.
        """
        if not 0.0 < value < (math.inf if self.along == "c" else ETA_END):
            raise NotConvergedError(f"there is no front at {self.along} = {value:.6g}.")
        if self.along == "c":
            return replace(self, chain=self.chain._replace(c=value))
        return replace(self, chain=amplitudes_of(self.chain.c, value))

    @classmethod
    def started(cls, c: float, eta: float, along: Parameter = "c") -> Window:
        """Run the chain from a step until the intervals between the arrivals settle.

        Raises
        ------
        ParameterError
            If a parameter is out of range.
        NoFrontError
            If no further site was reached for a long time.
        """
        eta_of_fronts(eta, ETAS)
        chain = amplitudes_of(within("coupling c", c, *COUPLINGS), eta)
        width = _width(c)
        left = 14 + math.ceil(10.0 * width * max(1.0, 2.0 / attraction_rate(eta)))
        right = 12 + math.ceil(30.0 * width)
        wide = cls(chain=chain, left=left, right=right, guess=np.empty(0), along=along)
        rho, v = wide._run_to_a_front()
        return replace(wide, guess=np.append(rho, v))._resized(v, _DEPTHS[0])

    def _resized(self, v: float, depth: float) -> Window:
        """Resize window and guess so that a front of velocity v decays by e^-depth at its ends."""
        left, right = (1 + math.ceil(depth / each) for each in self._decay(v))
        first = self.guess[:-1][max(0, self.left - left) :]
        rho = np.concatenate([np.ones(max(0, left - self.left)), first, np.zeros(right)])
        return replace(
            self, left=left, right=right, guess=np.append(rho[: left + right], self.guess[-1])
        )

    def _decay(self, v: float) -> tuple[float, float]:
        """Return the decay rates of the front per site, behind and ahead of it.

        A tail e^{λξ} has vλ = c sinh λ + f'(ρ). The rate behind is the smallest positive real part
        of a root; the rate ahead is that of the only negative root, with f'(0) = ½.
        """
        c = self.chain.c
        ahead = math.log(2.0 * (v + 2.0 * c + 1.0) / c) + 2.0
        for _ in range(60):
            ahead -= (c * math.sinh(ahead) - v * ahead - 0.5) / (c * math.cosh(ahead) - v)
        real, turn = np.meshgrid(np.geomspace(0.02, 8.0, 12), np.linspace(0.0, math.pi, 6))
        roots = (real + 1j * turn).ravel()
        with np.errstate(all="ignore"):
            for _ in range(40):
                value = c * np.sinh(roots) - v * roots + self.attraction
                step = value / (c * np.cosh(roots) - v)
                roots = roots - step
        found = roots.real[(np.abs(step) < 1e-9) & (roots.real > 0.0)]
        return float(found.min(initial=8.0)), ahead

    def _steps_in(self, time: float, finer: float) -> int:
        # The factor is applied last, so that the check takes more steps even at the minimum number.
        return math.ceil(finer * steps_in(time, self.chain.c + self.attraction, _STEP))

    def _run_to_a_front(self) -> tuple[FloatArray, float]:
        """Run the chain from a step; return its amplitudes and the velocity of its front."""
        rho = np.where(np.arange(self.left + self.right) <= self.left, 1.0, 0.0)
        h = 0.8 * _STEP / (self.chain.c + self.attraction)
        time = last = 0.0
        interval, unstable = math.inf, self.unstable
        slower = _width(self.chain.c) ** 2
        for _ in range(math.ceil(_PERIODS * slower)):
            after = rho
            while after[self.left + 1] < unstable:
                rho, time = after, time + h
                after = advanced(rho, self.chain, h)
                if time - last > 1.0 / SLOWEST:
                    raise self._no_front()
            part = (unstable - rho[self.left + 1]) / (after - rho)[self.left + 1]
            rho = np.append(advanced(rho, self.chain, part * h)[1:], 0.0)
            time -= (1.0 - part) * h
            before, interval, last = interval, time - last, time
            if abs(interval - before) < _SETTLED / slower * interval:
                break
        return rho, 1.0 / interval

    def _no_front(self) -> NoFrontError:
        fold = static_fold(self.chain.eta)
        here = f"c = {self.chain.c:.12g}, eta = {self.chain.eta:.6g}"
        if self.chain.c <= fold.c:
            return NoFrontError(
                f"no front travels at {here}: fronts are pinned up to c_pin = {fold.c:.12g}; take "
                "a larger coupling."
            )
        return NoFrontError(
            f"the front at {here} is slower than {SLOWEST:g}; near c_pin = {fold.c:.12g} its "
            f"velocity is {fold.square_root:.6g} sqrt(c - c_pin)."
        )

    def system(self, finer: float = 1.0) -> System:
        """Return F(u, p) with u = (ρ, v): ρ_{n+1}(1/v) - ρ_n = 0 and the phase condition.

        The parameter p is c or η, according to ``along``.
        """
        sites = self.left + self.right

        def system(u: FloatArray, value: float) -> tuple[FloatArray, FloatArray, FloatArray]:
            rho, v = u[:-1], float(u[-1])
            if not (v > 0.2 * SLOWEST and np.abs(rho).max() < 3.0):
                raise NotConvergedError(
                    f"no front of velocity {v:.3g} was found at {self.along} = {value:.6g}."
                )
            here = self.at(value)
            steps = here._steps_in(1.0 / v, finer)
            end, by_parameter, matrix = with_disturbances(
                rho, here.chain, 1.0 / v, steps, along=self.along
            )
            off = np.append(_moved_on(end) - rho, rho[self.left] - here.unstable)
            slope = np.zeros((sites + 1, sites + 1))
            slope[:sites, :sites] = _moved_on(matrix) - np.eye(sites)
            slope[:sites, sites] = -_moved_on(rate(end, here.chain)) / v**2
            slope[sites, self.left] = 1.0
            turn = 0.0 if self.along == "c" else -threshold_ratio_slope(value)
            return off, slope, np.append(_moved_on(by_parameter), turn)

        return system

    def _multipliers(self, u: FloatArray, finer: float) -> tuple[ComplexArray, ComplexArray]:
        """Return the multipliers of disturbances of the amplitudes, and of the phases, of a front.

        u = (ρ, v) is the front on this window.
        """
        rho, time = u[:-1], 1.0 / float(u[-1])
        steps = self._steps_in(time, finer)
        amplitudes, phases = (
            np.linalg.eigvals(_moved_on(with_disturbances(rho, self.chain, time, steps, kind)[2]))
            for kind in (False, True)
        )
        return amplitudes.astype(complex), phases.astype(complex)

    def described(self, point: BranchPoint, begin: float) -> FrontWave:
        """Solve again on a longer window with finer steps, and return the front with its error."""
        first = float(point.u[-1])
        here = replace(self.at(point.parameter), guess=point.u)
        wider = here._resized(first, _DEPTHS[1])
        last = solve_at(wider.system(_FINER), wider.guess, point.parameter)
        v = float(last.u[-1])
        amplitudes, phases = wider._multipliers(last.u, _FINER)
        first_amplitudes, first_phases = here._multipliers(point.u, 1.0)
        trivial, others = _without_trivial(amplitudes)
        others = others[np.argsort(-np.abs(others))][:_LISTED]
        first_others = _without_trivial(first_amplitudes)[1]
        apart = 2.0 * np.abs(np.subtract.outer(others, first_others)).min(axis=1)
        continuum = math.exp(-min(0.5, here.attraction) / v)
        phase = float(np.abs(phases).max())
        changed = 2.0 * abs(phase - float(np.abs(first_phases).max()))
        return FrontWave(
            c=here.chain.c,
            eta=here.chain.eta,
            v=v,
            error=2.0 * abs(v - first) + last.correction + _ROUNDING * v,
            r=last.u[:-1] * math.sqrt(here.chain.square),
            crossing=wider.left,
            stable=bool(abs(others[0]) < 1.0 and phase < 1.0 + _NEUTRAL),
            multipliers=others,
            multipliers_error=np.where(
                np.abs(others) <= continuum + apart, math.inf, apart + _ROUNDING
            ),
            phase_multiplier=phase,
            phase_multiplier_error=max(changed, 1.0 - phase) + _ROUNDING,
            continuum=continuum,
            trivial=abs(trivial - 1.0),
            iterations=point.iterations + last.iterations,
            steps=wider._steps_in(1.0 / v, _FINER),
            seconds=perf_counter() - begin,
        )


def _width(c: float) -> float:
    """Return the width of a front in sites: at strong coupling it grows like c^{1/3}."""
    return max(1.0, math.cbrt(c))


def _without_trivial(multipliers: ComplexArray) -> tuple[complex, ComplexArray]:
    """Return the multiplier nearest 1, and the others."""
    place = int(np.argmin(np.abs(multipliers - 1.0)))
    return complex(multipliers[place]), np.delete(multipliers, place)


def _moved_on(x: FloatArray) -> FloatArray:
    """Return the values shifted by one site, with rest beyond the last one."""
    return np.concatenate([x[1:], np.zeros((1, *x.shape[1:]))])
