"""Model II: the chain of generalised Van der Pol oscillators (Eq. 8) and its averaged form (43).

    ÿ_n + y_n + εc(2y_n - y_{n-1} - y_{n+1}) + ε ẏ_n (1 - a y_n² + b y_n⁴) = 0            (8)

With Ψ = ẏ + iy = φ e^{it}, so that y = Im Ψ, averaging over a period gives, in slow time T = εt,

    φ_n' = (ic/2)(2φ_n - φ_{n-1} - φ_{n+1}) - (φ_n/2)(1 - a|φ_n|²/4 + b|φ_n|⁴/8).    (43)

In both equations the scaling y → y√a turns (a, b) into (1, η), η = b/a².
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from theory.cells.vdp import DAMPING, DAMPING_REMEDY, ETA_END, eta_from_damping
from theory.chains.chain import COUPLING_RANGE, EPS_RANGE, SITES_RANGE, SmoothChain, parameter
from theory.chains.ends import Ends
from theory.parameters import ParameterError, with_ranges


def vdp_acceleration(site, left, right, p):  # type: ignore[no-untyped-def]
    """Return (ẏ, ÿ) of a site of (8).

    Parameters
    ----------
    site, left, right : pair of float or of ndarray
        (y, ẏ) of the site and of its two neighbours.
    p : tuple of float
        a, b, c, ε.

    Examples
    --------
    >>> vdp_acceleration((1.0, 0.0), (1.0, 0.0), (1.0, 0.0), (4.0, 0.5, 0.6, 0.01))
    (0.0, -1.0)
    """
    y, w = site
    a, b, c, eps = p
    square = y * y
    damped = -y - eps * w * (1.0 + square * (b * square - a))
    return w, damped - eps * c * (2.0 * y - (left[0] + right[0]))


def envelope_velocity(site, left, right, p):  # type: ignore[no-untyped-def]
    """Return (Im φ', Re φ') of a site of (43), per unit of slow time T = εt.

    Parameters
    ----------
    site, left, right : pair of float or of ndarray
        (Im φ, Re φ) of the site and of its two neighbours.
    p : tuple of float
        a, b, c.

    Examples
    --------
    >>> envelope_velocity((1.0, 0.0), (1.0, 0.0), (1.0, 0.0), (4.0, 0.0, 0.6))
    (0.0, 0.0)
    """
    y, w = site
    a, b, c = p
    square = y * y + w * w
    less = square * (0.25 * a - 0.125 * b * square)
    return (
        0.5 * (y * less - y + c * (2.0 * w - (left[1] + right[1]))),
        0.5 * (w * less - w - c * (2.0 * y - (left[0] + right[0]))),
    )


@with_ranges(coupling=COUPLING_RANGE, eps=EPS_RANGE, sites=SITES_RANGE)
@dataclass(frozen=True, kw_only=True)
class VanDerPolChain(SmoothChain):
    """Parameters common to (8) and to (43); dimensionless.

    Attributes
    ----------
    a, b : float
        Damping coefficients, positive.
    c : float
        Coupling, {coupling}.
    eps : float
        Small parameter ε, {eps}. In slow time, (43) does not depend on ε.
    sites : int
        Number of oscillators N, {sites}.
    ends : Ends
        Free or periodic.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    """

    allowed_ends: ClassVar[tuple[Ends, ...]] = (Ends.FREE, Ends.PERIODIC)
    front_phase_step: ClassVar[int] = -1

    a: float = parameter("damping coefficient a, positive", "a")
    b: float = parameter("damping coefficient b, positive", "b")
    c: float = parameter("coupling, zero or positive", "c")
    eps: float = parameter("small parameter, {allowed}", "ε", 0.01, allowed=EPS_RANGE)
    sites: int = parameter("number of sites, from 2", "N", 31)
    ends: Ends = parameter(
        "free: one neighbour only; periodic: a ring, as in (40)", "ends", Ends.FREE
    )

    def __post_init__(self) -> None:
        for name in ("a", "b"):
            self._check_number(name, f"damping coefficient {name}", *DAMPING, DAMPING_REMEDY)
        self._check_number("c", "coupling c", *COUPLING_RANGE)
        self._check_number("eps", "small parameter eps", *EPS_RANGE)
        self._check_count("sites", "number of sites n", *SITES_RANGE)
        self._check_ends()

    @property
    def eta(self) -> float:
        """η = b/a²."""
        return eta_from_damping(self.a, self.b)

    @property
    def bistable(self) -> bool:
        """Whether an isolated cell has two cycles, 8b < a²."""
        return self.eta < ETA_END

    @property
    def stable_amplitude(self) -> float:
        """|φ_s| = √[(a/b)(1 + √(1 - 8η))], the amplitude of y on the stable cycle, to O(ε)."""
        self._need_cycles()
        return math.sqrt(self.a / self.b * (1.0 + math.sqrt(1.0 - 8.0 * self.eta)))

    @property
    def unstable_amplitude(self) -> float:
        """|φ_us| = √[(a/b)(1 - √(1 - 8η))] = √[(8/a)/(1 + √(1 - 8η))]."""
        self._need_cycles()
        return math.sqrt(8.0 / self.a / (1.0 + math.sqrt(1.0 - 8.0 * self.eta)))

    @property
    def time_unit(self) -> float:
        """1/ε, since amplitudes change on the scale of slow time T = εt."""
        return 1.0 / self.eps

    @property
    def trailing_wave_velocity(self) -> float:
        """εc, the velocity of the fastest phase wave behind a front."""
        return self.eps * self.c

    def averaged(self) -> AveragedChain:
        """Return the averaged chain (43) of the same parameters."""
        return AveragedChain(
            a=self.a, b=self.b, c=self.c, eps=self.eps, sites=self.sites, ends=self.ends
        )

    def full(self) -> VdpChain:
        """Return the chain (8) of the same parameters."""
        return VdpChain(
            a=self.a, b=self.b, c=self.c, eps=self.eps, sites=self.sites, ends=self.ends
        )

    def _need_cycles(self) -> None:
        if not self.bistable:
            raise ParameterError(
                "eta = b/a^2",
                f"{self.eta:.6g}",
                "below 1/8 where the two limit cycles are needed",
                "take a smaller eta, that is a larger a or a smaller b",
            )


@dataclass(frozen=True, kw_only=True)
class VdpChain(VanDerPolChain, model="vdp", kernel=vdp_acceleration):
    """Model II, Eq. (8): generalised Van der Pol oscillators, y and ẏ in time t.

    Attributes
    ----------
    a, b, c, eps, sites, ends
        As in :class:`~theory.chains.vdp.VanDerPolChain`.

    Examples
    --------
    >>> chain = VdpChain(a=4, b=0.5, c=0.6)
    >>> chain.eta, round(chain.stable_amplitude, 6), round(chain.unstable_amplitude, 6)
    (0.03125, 3.863703, 1.035276)
    >>> chain.averaged().model
    'averaged'
    """

    oscillates: ClassVar[bool] = True


@dataclass(frozen=True, kw_only=True)
class AveragedChain(VanDerPolChain, model="averaged", kernel=envelope_velocity):
    """Model II averaged over a period, Eq. (43): the envelope φ; times are t, slow time is εt.

    A state is (Im φ, Re φ), which is (y, ẏ) of Ψ = ẏ + iy in the rotating frame.

    Attributes
    ----------
    a, b, c, eps, sites, ends
        As in :class:`~theory.chains.vdp.VanDerPolChain`.

    Examples
    --------
    >>> AveragedChain(a=4, b=0.5, c=0.6).full()
    VdpChain(a=4.0, b=0.5, c=0.6, eps=0.01, sites=31, ends=<Ends.FREE: 'free'>)
    """

    def kernel_parameters(self) -> tuple[float, ...]:
        """Return a, b, c."""
        return self.a, self.b, self.c

    @property
    def kernel_rate(self) -> float:
        """ε, since the kernel is written in slow time."""
        return self.eps


def effective_epsilon(chain: VanDerPolChain) -> float:
    """Return ε max|1 - a y² + b y⁴| over the stable cycle, which governs the error of averaging.

    The maximum is (1 + 7s)/(1 - s), s = √(1 - 8η), at the turning points y² = |φ_s|². Where the
    damping is most negative, at y² = a/2b, the modulus is (1 + s²)/(1 - s²), which is never larger.

    Examples
    --------
    >>> round(effective_epsilon(VdpChain(a=4, b=0.5, c=0.6)), 3)
    0.527
    """
    turning = chain.stable_amplitude**2
    return chain.eps * (1.0 - chain.a * turning + chain.b * turning**2)
