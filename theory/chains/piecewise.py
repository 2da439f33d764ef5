"""Model II simplified: the piecewise-linear envelope chain (Eq. 44), of infinite length.

    φ_n' = (ic/2)(2φ_n - φ_{n-1} - φ_{n+1}) - φ_n/2 + ½ φ_n/|φ_n| H(|φ_n| - r)            (44)

with amplitudes in units of |φ_s|, so that the excited state is |φ| = 1; it depends on c and on
r = |φ_us|/|φ_s|, a function of η = b/a² alone. All quantities are dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from theory.cells.vdp import DAMPING, DAMPING_REMEDY, ETA_END, SMALLEST_ETA, threshold_ratio
from theory.chains.chain import COUPLING_RANGE, Chain, Site, parameter
from theory.chains.ends import Ends
from theory.parameters import ParameterError, real_number


@dataclass(frozen=True, kw_only=True)
class PiecewiseChain(Chain, model="piecewise"):
    """The piecewise-linear envelope chain (44), given η, or a and b.

    Attributes
    ----------
    c : float
        Coupling, positive.
    eta : float
        η = b/a², positive and at most 1/8; given, or computed from a and b.
    a, b : float or None
        Damping coefficients, if they were given.

    Raises
    ------
    ParameterError
        If a parameter is out of range, if neither η nor both a and b are given, or if they
        contradict each other.

    Examples
    --------
    >>> PiecewiseChain(c=0.6, a=4, b=0.5).eta
    0.03125
    >>> round(PiecewiseChain(c=0.6, eta=0.03125).unstable_amplitude, 6)
    0.267949
    """

    allowed_ends: ClassVar[tuple[Ends, ...]] = ()

    c: float = parameter("coupling, positive", "c")
    eta: float = parameter("b/a^2, positive and at most 1/8", "η", None)
    a: float | None = parameter("damping coefficient a, instead of eta", "a", None)
    b: float | None = parameter("damping coefficient b, instead of eta", "b", None)

    def __post_init__(self) -> None:
        remedy = "give a positive coupling in this range"
        self._check_number("c", "coupling c", *COUPLING_RANGE, remedy)
        if self.c == 0.0:
            raise ParameterError("coupling c", self.c, "positive", "give a positive coupling")
        if (self.a is None) != (self.b is None):
            raise ParameterError(
                "damping coefficients a, b", "one alone", "given together", "give both, or eta"
            )
        eta: object = self.eta
        if self.a is not None and self.b is not None:
            for name in ("a", "b"):
                self._check_number(name, f"damping coefficient {name}", *DAMPING, DAMPING_REMEDY)
            ratio = self.b / self.a**2
            if eta is not None and eta != ratio:
                raise ParameterError(
                    "eta = b/a^2", eta, f"{ratio:.17g} with these a and b", "give eta, or a and b"
                )
            eta = ratio
        if eta is None:
            raise ParameterError("eta = b/a^2", "none", "given", "give eta, or a and b")
        remedy = (
            "take a value in this range: above 1/8 there are no cycles, and below "
            f"{SMALLEST_ETA:g} double precision does not resolve their ratio"
        )
        checked = real_number("eta = b/a^2", eta, SMALLEST_ETA, ETA_END, remedy)
        object.__setattr__(self, "eta", checked)

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed; a new η replaces a and b, and vice versa.

        Examples
        --------
        >>> PiecewiseChain(c=0.6, a=4, b=0.5).replace(eta=0.05).a is None
        True
        """
        if "eta" in changes:
            changes = {"a": None, "b": None, **changes}
        elif "a" in changes or "b" in changes:
            changes = {"eta": None, **changes}
        return super().replace(**changes)

    @property
    def rest_state(self) -> Site:
        """(0, 0)."""
        return Site(0.0, 0.0)

    @property
    def stable_amplitude(self) -> float:
        """1, the unit of amplitude."""
        return 1.0

    @property
    def unstable_amplitude(self) -> float:
        """The threshold r = |φ_us|/|φ_s| of (44)."""
        return threshold_ratio(self.eta)
