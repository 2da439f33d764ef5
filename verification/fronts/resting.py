"""Fronts of (43) at rest, and the fold at c_pin, where they end and travelling fronts begin.

The solution of (c/2)(r_{n-1} - r_{n+1}) = r_n g(r_n), with the stable cycle to the left and rest to
the right, is followed from small c to its fold by pseudo-arclength continuation. At the fold the
matrix of the linearised equations has a right null vector φ and a left null vector ψ, ψ·φ = 1, and
along φ the chain drifts as

    x' = α (c - c_pin) + β x²,     α = ψ·∂F/∂c,   β = ½ ψ·F''[φ, φ],

so that the front takes a time π/√(αβ(c - c_pin)) per site: v = (√(αβ)/π) √(c - c_pin) + O(c -
c_pin).

c_pin rises with η, at the rate dc_pin/dη = -(ψ·∂F/∂η)/α: at a given c, fronts travel for η < η_pin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from scipy.optimize import brentq

from theory.arrays import EPS, FloatArray
from theory.cells.vdp import ETA_END, eta_of_fronts
from theory.parameters import Range, RunError, with_ranges
from verification.continuation.branch import Fold, StepControl, trace
from verification.continuation.newton import System, solve_at
from verification.steppers.amplitudes import Amplitudes, rate, rate_by

ETAS = Range(1e-3, 0.11)
"""Range of η. Below it, the cycle attracts at a rate of 1/2η and too many steps are needed; above
it, so weakly that the windows become long, and the two cycles nearly coincide."""

_WINDOWS = (12, 30), (16, 40)
_ROUNDING = 16.0 * EPS
_STEPS = StepControl(length=0.05, longest=0.3, tolerance=1e-13, fold_tolerance=1e-16)


@dataclass(frozen=True, kw_only=True)
class StaticFold:
    """The fold in which the fronts of (43) at rest end.

    Attributes
    ----------
    c : float
        c_pin, dimensionless.
    error : float
        Bound on its error, which includes the effects of the window length and of rounding.
    square_root, square_root_error : float
        The limit of v/√(c - c_pin) as c approaches c_pin from above, and its error.
    slope, slope_error : float
        dc_pin/dη, and its error.
    r : ndarray of float, shape (N,)
        √a times the amplitudes of the sites at the fold; no error is known.
    """

    shown: ClassVar[tuple[str, ...]] = ("c_pin", "c_pin_error")

    c: float
    error: float
    square_root: float
    square_root_error: float
    slope: float
    slope_error: float
    r: FloatArray

    @property
    def c_pin(self) -> float:
        """Alias of ``c``: the name used when it is listed beside a front."""
        return self.c

    @property
    def c_pin_error(self) -> float:
        """Alias of ``error``, for the same reason."""
        return self.error

    def fastest(self, c: float) -> float:
        """Return the largest velocity that a front may have, within the error of ``c``.

        It is zero unless the coupling is within this error of the fold, or above it.
        """
        beyond = max(0.0, c - (self.c - self.error))
        return (self.square_root + self.square_root_error) * math.sqrt(beyond)


def amplitudes_of(c: float, eta: float) -> Amplitudes:
    """Return the chain of amplitudes at these parameters, 0 < η < 1/8."""
    return Amplitudes(c, eta, (1.0 + math.sqrt(1.0 - eta / ETA_END)) / eta)


@with_ranges(eta=ETAS)
@lru_cache(maxsize=64)
def static_fold(eta: float) -> StaticFold:
    """Return c_pin(η) of (43): up to it, fronts with a quarter-turn phase step remain at rest.

    Parameters
    ----------
    eta : float
        η = b/a², {eta}.

    Raises
    ------
    ParameterError
        If η is out of range.
    RunError
        If the branch has no fold below c = 2.

    References
    ----------
    Carpio and Bonilla (2001), Wave front depinning transition in discrete one-dimensional
    reaction-diffusion systems, Phys. Rev. Lett. 86, 6034, for the square-root law.

    Examples
    --------
    >>> fold = static_fold(0.03125)
    >>> round(fold.c, 9), fold.error < 1e-12
    (0.101944386, True)
    """
    eta_of_fronts(eta, ETAS)
    chain = amplitudes_of(0.0, eta)
    shorter, longer = (_fold(chain, *window) for window in _WINDOWS)
    square_root, slope = _beside(chain, longer.u, longer.parameter)
    by_window = _beside(chain, shorter.u, shorter.parameter)
    by_place = _beside(chain, longer.u + longer.offset, longer.parameter)
    rounding = _ROUNDING * _condition(chain, longer)
    square_root_error, slope_error = (
        2.0 * abs(value - other) + abs(value - moved) + rounding * value
        for value, other, moved in zip((square_root, slope), by_window, by_place, strict=True)
    )
    return StaticFold(
        c=float(longer.parameter),
        error=float(2.0 * abs(longer.parameter - shorter.parameter) + longer.error),
        square_root=square_root,
        square_root_error=square_root_error,
        slope=slope,
        slope_error=slope_error,
        r=longer.u * math.sqrt(chain.square),
    )


@dataclass(frozen=True, kw_only=True)
class PinningEta:
    """The largest η at which the fronts of (43) travel, at a given coupling.

    Attributes
    ----------
    eta, error : float
        η_pin, and a bound on its error.
    square_root, square_root_error : float
        The limit of v/√(η_pin - η) as η approaches η_pin from below, and its error.
    """

    eta: float
    error: float
    square_root: float
    square_root_error: float


@with_ranges(eta=ETAS)
@lru_cache(maxsize=64)
def pinning_eta(c: float) -> PinningEta | None:
    """Return η_pin(c), at which c_pin(η) = c; None if it is not {eta}.

    Parameters
    ----------
    c : float
        Coupling, dimensionless.

    Examples
    --------
    >>> pin = pinning_eta(0.101944386)
    >>> round(pin.eta, 7), pin.error < 1e-11
    (0.03125, True)
    """
    if not static_fold(ETAS.low).c < c < static_fold(ETAS.high).c:
        return None
    eta = float(brentq(lambda eta: static_fold(eta).c - c, *ETAS, xtol=1e-14))
    there = static_fold(eta)
    return PinningEta(
        eta=eta,
        error=2e-14 + (abs(there.c - c) + there.error) / there.slope,
        square_root=there.square_root * math.sqrt(there.slope),
        square_root_error=there.square_root_error * math.sqrt(there.slope)
        + 0.5 * there.slope_error * there.square_root / math.sqrt(there.slope),
    )


def _fold(chain: Amplitudes, left: int, right: int) -> Fold:
    start = np.where(np.arange(left + right) < left, 1.0, 0.0)
    system = _at_rest(chain, left + right)
    fold = trace(system, solve_at(system, start, 1e-4), 2.0, None, _STEPS).fold
    if fold is None:
        raise RunError(f"fronts at rest have no fold at eta = {chain.eta:.6g} below c = 2.")
    return fold


def _at_rest(chain: Amplitudes, sites: int) -> System:
    """Return F(ρ, c) = ρ'."""
    shifts = np.eye(sites, k=-1) - np.eye(sites, k=1)

    def system(rho: FloatArray, c: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        s = chain.square * rho * rho
        slope = 0.5 - 0.375 * s + 0.3125 * chain.eta * s * s
        return (
            rate(rho, chain._replace(c=c)),
            0.5 * c * shifts - np.diag(slope),
            rate_by(rho, chain, "c"),
        )

    return system


def _beside(chain: Amplitudes, rho: FloatArray, c: float) -> tuple[float, float]:
    """Return √(αβ)/π and dc_pin/dη from the solution at the fold."""
    matrix = _at_rest(chain, rho.size)(rho, c)[1]
    left, _, right = np.linalg.svd(matrix)
    psi, phi = left[:, -1], right[-1]
    psi = psi / (psi @ phi)
    # The second derivative of -ρg(ρ).
    bend = chain.square * rho * (0.75 - 1.25 * chain.eta * chain.square * rho * rho)
    alpha, beta = float(psi @ rate_by(rho, chain, "c")), float(0.5 * psi @ (bend * phi * phi))
    slope = -float(psi @ rate_by(rho, chain, "eta")) / alpha
    return math.sqrt(alpha * beta) / math.pi, slope


def _condition(chain: Amplitudes, fold: Fold) -> float:
    """Return by how much rounding of the matrix changes its null vectors at a fold."""
    matrix = _at_rest(chain, fold.u.size)(fold.u, fold.parameter)[1]
    sizes = np.linalg.svd(matrix, compute_uv=False)
    return float(sizes[0] / sizes[-2])
