"""The averaged chain of any polynomial cell and coupling: the envelope of an `OscillatorChain`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from theory.cells.averaging import mean_shift_of_stiffness
from theory.chains.chain import Kernel, Site, SmoothChain
from theory.chains.oscillator import OscillatorChain, vars_of
from theory.parameters import ParameterError

MAX_PHASE = 0.1
"""Phase that the averaged chain may lose against the full one in a unit of εt by its stiffness."""


@dataclass(frozen=True, kw_only=True, eq=False)
class AveragedOscillatorChain(OscillatorChain, model="averaged-chain"):
    """An `OscillatorChain` averaged over a period, to first order in ε: the envelope φ.

        φ_n' = -½H(|φ_n|²)φ_n + iΩ(|φ_n|²)φ_n + (ic/2ω - cd/2) Σ_j W_nj (φ_n - φ_j)

    per unit of εt, for y = Im(φ e^{iωt}) and ẏ = ω Re(φ e^{iωt}); ω is that of small motion of a
    cell, H and Ω are in ``theory.cells.averaging``. A state is (Im φ, Re φ); times are t. What is
    nonlinear in the stiffness must be of order ε.

    Attributes
    ----------
    damping, c, stiffness, values, coupling, eps, velocity_coupling, overdamped, disorder, seed, \
sites, ends, shape
        As in :class:`OscillatorChain`.
    drive : empty
        A force has a frequency of its own.

    Raises
    ------
    ParameterError
        If one is out of range, there is a force or no inertia, or the frequency on a cycle is not
        what first order says it is.

    References
    ----------
    J. Guckenheimer, P. Holmes (1983), Nonlinear Oscillations, Dynamical Systems, and Bifurcations
    of Vector Fields.

    Examples
    --------
    >>> chain = OscillatorChain(damping="v**2 - 1", c=0.5).averaged()
    >>> round(chain.stable_amplitude**2, 12)
    1.333333333333
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_unforced("the averaged chain, whose frequency is its own")
        if self.overdamped:
            raise ParameterError("overdamped", "true", "false: it has no period", "leave it out")
        off = self._phase_lost()
        if off > MAX_PHASE:
            raise ParameterError(
                "stiffness", repr(self.stiffness), "linear up to terms of order eps: the phase of "
                f"the averaged chain would be wrong by {off:.2g} in a unit of eps t",
                "make what is nonlinear smaller, or run the full chain",
            )  # fmt: skip

    def _phase_lost(self) -> float:
        """Return by how much first order misses the frequency of a stable cycle, over ε."""
        mean = mean_shift_of_stiffness(self._g).at(self._extreme_values()[0])
        small, worst = self.cell.frequency, 0.0
        for cycle in self.cell.cycles:
            if cycle.stable:
                shift = sum(value * cycle.amplitude ** (2 * i) for (i, _), value in mean.items())
                first = small + (shift - 0.5 * small**2) / small
                worst = max(worst, abs(2.0 * math.pi / cycle.period - first) / self.eps)
        return worst

    @property
    def oscillates(self) -> bool:  # type: ignore[override]
        """The envelope does not."""
        return False

    @property
    def kernel_rate(self) -> float:
        """ε: the kernel is in slow time."""
        return self.eps

    def excited_state(self, displacement: float, quarter_turns: int = 0) -> Site:
        """Return (Im φ, Re φ) of a site on the motion of this amplitude; see `SmoothChain`."""
        return SmoothChain.excited_state(self, displacement, quarter_turns)

    @cached_property
    def _source(self) -> str:
        return self._text.averaged()

    def kernels(self) -> tuple[Kernel, Kernel]:
        """Refuse: derivatives are those of the full chain.

        Raises
        ------
        ParameterError
            Always.
        """
        raise ParameterError("model", self.model, "chain for a breather", "take chain.full()")

    @property
    def kernel_layout(self) -> tuple[int, ...]:
        """As of the full chain; the pull on both parts of φ is needed."""
        layout = super().kernel_layout
        return layout if self.network is None else (*layout[:2], 1)

    def averaged(self) -> AveragedOscillatorChain:
        """Return this chain."""
        return self

    def full(self) -> OscillatorChain:
        """Return the full chain of the same parameters."""
        return OscillatorChain(**vars_of(self))
