"""Results for a breather, whatever the method and the chain."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from theory.arrays import EPS, ComplexArray, FloatArray
from theory.averaged.breather import BreatherStatus
from theory.chains.nucleus import Nucleus
from theory.parameters import RunError
from theory.result import Result, json_value
from theory.status import Status
from verification.breathers.exponents import BreatherStability

_UNITS = {"phases": "in units of π", "phases_error": "in units of π", "phase_step": "rad"}


def wave_error_of(error: float, waves: ComplexArray, centre: int) -> float:
    """Return the error of the waves from that of the state (y, ẏ), or of both parts of φ.

    While an error δ of y and ẏ rotates, that of the wave is up to √2 δ. The rotation of all waves
    that makes the centre real adds as much, times ρ for a site ρ times as large as the centre. The
    sum is multiplied by √2 to allow for damping: 2 (1 + ρ) δ, with ρ at least 1.

    Examples
    --------
    >>> waves = np.array([0.1j, 1.0, 3.0])
    >>> wave_error_of(1e-9, waves, 2), wave_error_of(1e-9, waves, 1)
    (4e-09, 8e-09)
    """
    size = np.abs(waves)
    if size[centre] == 0.0:
        return math.inf
    return 2.0 * (1.0 + float(size.max() / size[centre])) * error


class BreatherMethod(Status):
    """Method by which a breather is found."""

    CLOSED_FORM = "closed-form", "amplitudes of (29) and (37), with the frequency of (30)."
    ENVELOPE = "envelope", "the averaged chain (43), solved by continuation from small coupling."
    ORBIT = "orbit", "the periodic orbit of (8), by shooting with variational equations."
    SIMULATION = "simulation", "a run of the chain from a perturbed start until it is periodic."


@dataclass(frozen=True, kw_only=True)
class Breather(Result):
    """A breather of a chain by one method; all quantities are dimensionless.

    Attributes
    ----------
    chain : VdpChain, AveragedChain or OscillatorChain
        The chain to which the breather belongs: `error` is the distance from its exact solution.
    nucleus : Nucleus
        Which sites oscillate, and their phase steps; that on which a run has settled, if it has a
        name: the pattern is then that of the nearest quarter turns.
    method : BreatherMethod
        Method by which it was found.
    status : BreatherStatus
        Whether the breather exists, or how the run ended.
    amplitudes : float array, shape (N,)
        max |y_n| over a period, or |φ_n|; empty if there is no breather.
    waves : complex array, shape (N,)
        First harmonic of each site, whose angle is its phase; empty if there is none.
    frequency : float or None
        In units of inverse t; None if there is no breather. Never NaN.
    growth_error : float or None
        Distance of the growth rate from that of the chain's own breather; None if unknown.
    error : float or None
        Distance of the amplitudes from those of the chain's own breather, plus the error of the
        latter; None if unknown, for the reason in `error_unknown`.
    frequency_error : float or None
        The same for the frequency.
    wave_error : float, float array of shape (N,), or None
        The same for the waves, rotated to be real at the centre, of all sites or of each;
        `phases_error` and `phase_step_error` follow from it. None if unknown.
    error_unknown : str
        Why an error is unknown; empty if all are known.
    residual : float or None
        Largest residual of the equations that the method solves.
    decay, decay_error : float or None
        e^{k_1} of (9) and its error as a solution of (29) and (37), for the method ``closed-form``.
    fold, fold_error : float or None
        Largest coupling of the branch and its error, if the fold was reached.
    time, drift : float or None
        Time t of the run, and the remaining change of the state per unit of slow time.
    unknowns : float array
        The vector solved for: (y, ẏ) at the moment when y = 0 < ẏ at the centre, and the period; or
        (Re φ, Im φ, Ω), with frequency 1 + εΩ; no error is known. Empty if there is no solution.
    stability : BreatherStability or None
        Multipliers, or exponents of (43), with the growth in either parity; None where the method
        does not compute them.
    seconds : float
        Wall-clock time.
    """

    derived = ("stable", "growth", "trivial")

    chain: Any
    nucleus: Nucleus
    method: BreatherMethod
    status: BreatherStatus
    amplitudes: FloatArray = field(
        default_factory=lambda: np.empty(0), metadata={"dims": ("site",)}
    )
    waves: ComplexArray = field(
        default_factory=lambda: np.empty(0, complex), metadata={"json": None}
    )
    frequency: float | None = None
    growth_error: float | None = None
    error: float | None = None
    frequency_error: float | None = None
    wave_error: float | FloatArray | None = field(default=None, metadata={"json": None})
    error_unknown: str = ""
    residual: float | None = None
    decay: float | None = None
    decay_error: float | None = None
    fold: float | None = None
    fold_error: float | None = None
    time: float | None = None
    drift: float | None = None
    unknowns: FloatArray = field(
        default_factory=lambda: np.empty(0), repr=False, metadata={"json": None}
    )
    stability: BreatherStability | None = field(default=None, repr=False, metadata={"json": None})
    seconds: float

    @property
    def state(self) -> FloatArray:
        """A state (y, ẏ) on the orbit, shape (2N,); for (43), (Re φ, Im φ)."""
        return self.unknowns[:-1]

    @property
    def period(self) -> float:
        """Period in t, dimensionless.

        Raises
        ------
        RunError
            If there is no breather.
        """
        if self.frequency is None:
            raise RunError(self.status.sentence)
        orbit = self.method is BreatherMethod.ORBIT
        return float(self.unknowns[-1]) if orbit else 2.0 * math.pi / self.frequency

    @property
    def stable(self) -> bool | None:
        """Whether no small perturbation of the chain's own breather grows; None if not decided.

        Close to a fold the error of the growth rate may be larger than the rate itself, and where
        that breather is not known, nothing is known of its stability. A run may settle beside a
        breather that loses stability slowly, and does not decide it either.
        """
        if self.stability is None or self.error is None:
            return None
        if self.growth_error is None:
            return self.stability.stable
        return replace(self.stability, growth_error=self.growth_error).stable

    @property
    def growth(self) -> float | None:
        """Largest growth rate per unit of slow time, without the trivial mode; None if unknown."""
        return None if self.stability is None else self.stability.growth

    @property
    def trivial(self) -> float | None:
        """Distance of the trivial multiplier from 1, or of the trivial exponent of (43) from 0.

        It measures how accurate the other rates are.
        """
        return None if self.stability is None else self.stability.trivial

    @property
    def multipliers(self) -> ComplexArray | None:
        """Floquet multipliers by descending modulus; for the averaged chain e^{ε λ period}."""
        if self.stability is None:
            return None
        values = self.stability.values
        averaged = self.method is BreatherMethod.ENVELOPE
        return np.exp(self.chain.eps * self.period * values) if averaged else values

    @property
    def outward(self) -> FloatArray:
        """Amplitudes outwards from the centre (of two, the right one; at an edge, site 1)."""
        return self.amplitudes[self.nucleus.outward(self.chain.sites) :]

    @property
    def inward(self) -> FloatArray:
        """Amplitudes from the centre (included only if the nucleus is odd) to the left end."""
        centre = self.nucleus.outward(self.chain.sites)
        return self.amplitudes[: centre + self.nucleus.size % 2][::-1]

    @property
    def phases(self) -> FloatArray:
        """Phases relative to the centre, in units of π; empty if there is no breather."""
        if not self.waves.size:
            return np.empty(0)
        centre = self.waves[self.nucleus.outward(self.chain.sites)]
        return np.asarray(np.angle(self.waves / centre) / np.pi)

    @property
    def phases_error(self) -> FloatArray:
        """Errors of the phases, in units of π: 1 where unknown; empty if unknown at every site."""
        if self.wave_error is None:
            return np.empty(0)
        errors = self._rotation_bounds / np.pi
        errors[self.nucleus.outward(self.chain.sites)] = 0.0
        return np.asarray(errors)

    @property
    def phase_step_error(self) -> float | None:
        """Error of the phase step, in radians; None if unknown, or if there is no step."""
        if self.phase_step is None or self.wave_error is None:
            return None
        last = self.nucleus.first(self.chain.sites) + self.nucleus.size - 1
        return min(float(self._rotation_bounds[last : last + 2].sum()), math.pi)

    @property
    def _rotation_bounds(self) -> FloatArray:
        """Largest rotation of each wave that its error allows, in radians."""
        size = np.abs(self.waves)
        error = np.broadcast_to(0.0 if self.wave_error is None else self.wave_error, size.shape)
        limited = size > error
        rotation = np.full_like(size, np.pi)
        rotation[limited] = np.arcsin(error[limited] / size[limited]) + 4.0 * EPS
        return rotation

    @property
    def phase_step(self) -> float | None:
        """Phase step beyond the last site of the nucleus, in radians; None if there is none."""
        last = self.nucleus.first(self.chain.sites) + self.nucleus.size - 1
        if last + 1 >= self.waves.size:
            return None
        return float(np.angle(self.waves[last + 1] / self.waves[last]))

    @property
    def units(self) -> Mapping[str, str]:
        """Units of the phases; all other quantities are dimensionless."""
        return _UNITS

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON, where ``amplitudes`` are listed from the centre outwards."""
        found = super().to_dict()
        return found | {
            "pattern": self.nucleus.pattern,
            "c": self.chain.c,
            "amplitudes": json_value(self.outward),
            "left": json_value(self.inward),
            "phases": json_value(self.phases),
            "phases_error": json_value(self.phases_error),
            "phase_step": self.phase_step,
            "phase_step_error": self.phase_step_error,
        }

    def row(self) -> dict[str, Any]:
        """Return the entries of one table row, with the amplitudes at the centre and next to it."""
        shown = dict(zip(("centre", "neighbour"), json_value(self.outward), strict=False))
        return super().row() | {"centre": None, "neighbour": None} | shown


@dataclass(frozen=True, kw_only=True)
class BreatherComparison(Result):
    """One breather by several methods, each with its distance from a solution of the chain.

    Attributes
    ----------
    chain, nucleus
        As in `Breather`.
    methods : mapping of str to Breather
        The breathers, by the value of the method.
    refusals : mapping of str to str
        Why a method does not apply to this chain or nucleus, by the value of the method.
    seconds : float
        Total wall-clock time.
    """

    chain: Any
    nucleus: Nucleus
    methods: Mapping[str, Breather]
    refusals: Mapping[str, str] = field(default_factory=dict)
    seconds: float

    @property
    def units(self) -> Mapping[str, str]:
        """Units of the phases."""
        return _UNITS

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON."""
        header = {"method": "all", "pattern": self.nucleus.pattern, "c": self.chain.c}
        rows = [{"method": name, "reason": reason} for name, reason in self.refusals.items()]
        return header | super().to_dict() | {"refusals": rows}

    def __getitem__(self, method: str) -> Breather:
        """Return the breather found by one method."""
        return self.methods[method]

    def rows(self) -> list[dict[str, Any]]:
        """Return one row per method; those that do not apply come last, with the reason."""
        refused = [
            {"method": name, "status": "refused", "reason": reason}
            for name, reason in self.refusals.items()
        ]
        return [*(each.row() for each in self.methods.values()), *refused]

    def columns(self) -> dict[str, np.ndarray]:
        """Return a row per method: status, centre, neighbour, frequency, growth, error, seconds."""
        rows = [each.row() for each in self.methods.values()]
        columns = {name: np.array([row[name] for row in rows]) for name in ("method", "status")}
        names = ("centre", "neighbour", "frequency", "phase_step", "growth", "error")
        for name in (*names, "frequency_error", "seconds"):
            columns[name] = np.array([row[name] for row in rows], dtype=float)
        return columns
