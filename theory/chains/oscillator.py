"""A user-defined chain or network, and its average: any smooth cell, any linear coupling.

    ÿ_n + g(y_n) + ε h(y_n, ẏ_n) ẏ_n + εc Σ_j W_nj [(y_n - y_j) + d (ẏ_n - ẏ_j)] = F_n(t)

with g and h polynomials or compiled functions, named parameters that may differ from site to site,
any weights W (``theory.chains.coupling``), and harmonic forces F_n, if any; (8) is g = y,
h = 1 - ay² + by⁴, nearest neighbours, d = 0 and no force. Without inertia,
ẏ_n + g(y_n) + c Σ_j W_nj (y_n - y_j) = F_n(t).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from theory.cells.averaging import mean_shift_of_stiffness
from theory.cells.compiled import CompiledForce
from theory.cells.polynomial import as_polynomial
from theory.chains.chain import COUPLING_RANGE, EPS_RANGE, Kernel, Site
from theory.chains.oscillator_kernel import Namespace, functions_of
from theory.chains.own import OwnChain
from theory.parameters import ParameterError, with_ranges

MAX_PHASE = 0.1
"""Largest phase error of the averaged chain per unit of εt that its stiffness may cause."""


@with_ranges(coupling=COUPLING_RANGE, eps=EPS_RANGE)
@dataclass(frozen=True, kw_only=True, eq=False)
class OscillatorChain(OwnChain, model="chain"):
    """A chain or network of user-defined oscillators; dimensionless.

    ÿ_n + g(y_n) + ε h(y_n, ẏ_n) ẏ_n + ε c Σ_m w_nm [y_n - y_m + d (ẏ_n - ẏ_m)] = F_n(t), with
    weights w_nm of the coupling, 1 for neighbours; without inertia ẏ_n + g(y_n) + c Σ_m … = F_n(t).

    Attributes
    ----------
    damping : str, number, SymPy expression, function or sequence of functions
        h(y, v), v = ẏ, which multiplies εv: a polynomial; or ``h`` compiled by ``numba.njit``; or
        ``(h, h_y, h_v)`` with its derivatives, which are needed for breathers.
    c : float
        Coupling, {coupling}.
    stiffness : str, number, SymPy expression, function or sequence of functions
        g(y), with a minimum of its potential at y = 0: a polynomial; or ``g`` compiled, or
        ``(g, g_y)``.
    values : mapping of str to float or array of shape (N,)
        Values of the named parameters in g and h, one value for all sites or one for each; also
        texts such as ``a=4``. The named parameters of compiled functions are the arguments after y
        (and v).
    coupling : str, Path, sparse matrix or networkx graph
        The weights, in any form that `theory.chains.coupling.network_of` accepts.
    eps : float
        Small parameter ε, {eps}; 1 without inertia.
    velocity_coupling : float
        The coefficient d, with which the coupling also acts on differences of velocities.
    overdamped : bool
        Whether there is no inertia: ẏ takes the place of ÿ, and there is no damping.
    disorder : mapping of str to float or str
        Relative spread of parameters over the sites: 0.1 for a normal distribution with this
        standard deviation, ``uniform:0.1`` for a uniform one between -0.1 and 0.1; also texts such
        as ``a=0.1``.
    seed : int
        Seed of the disorder. A longer chain has the same values at its first sites.
    drive : str, mapping, or sequence of them
        Harmonic forces F cos(ωt + phase): texts ``amplitude,frequency[,phase]@sites`` with sites
        as ``1,4:6`` or ``all``, or mappings with these keys.
    sites : int or pair of int
        Number of sites, or rows and columns of a lattice; by default the size of the coupling's
        matrix, or 31.
    ends : Ends
        Ends of a coupling that is given by name: free, fixed or periodic.
    shape : tuple of int, optional
        Rows and columns; equivalent to a pair in ``sites``.

    Raises
    ------
    ParameterError
        If a force is not a valid polynomial, a function cannot be compiled, a parameter has no
        value, the coupling does not fit, the cell has no rest state at y = 0, or its motion would
        grow without bound.

    Examples
    --------
    >>> chain = OscillatorChain(damping="1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5}, c=0.6)
    >>> round(chain.stable_amplitude, 6), round(chain.unstable_amplitude, 6)
    (3.863703, 1.035276)
    >>> chain.replace(a=5).values["a"]
    5.0

    Any other smooth force is given as a compiled function:

    >>> import math, numba
    >>> @numba.njit
    ... def pendulum(y):
    ...     return math.sin(y) + y
    >>> chain = OscillatorChain(damping="y**2 - 1", stiffness=pendulum, c=0.6)
    >>> round(chain.stable_amplitude, 3), round(chain.cell.frequency, 3)
    (2.021, 1.414)
    """

    @property
    def oscillates(self) -> bool:  # type: ignore[override]
        """Whether there is inertia."""
        return not self.overdamped

    def excited_state(self, displacement: float, quarter_turns: int = 0) -> Site:
        """Return (y, ẏ) of a site in a motion of this amplitude; see `SmoothChain`."""
        site = super().excited_state(displacement, quarter_turns)
        if not self.oscillates or not displacement:
            return Site(site.y, 0.0)
        return Site(site.y, site.w / abs(displacement) * self.cell.velocity(abs(displacement)))

    def kernel(self) -> Kernel:
        """Return the right-hand side of a site, generated from the forces."""
        return functions_of(self._source, self._functions, self._mark)["cell"]

    def kernels(self) -> tuple[Kernel, Kernel]:
        """Return the right-hand side of a site, and the derivatives of its own force.

        The second function takes (y, ẏ, p, n, N) and returns the derivatives of the force by y and
        by ẏ. Both are plain Python and accept arrays.

        Raises
        ------
        ParameterError
            If a compiled force was given without its derivatives.
        """
        for name, force in (("stiffness", self._g), ("damping", self._h)):
            if isinstance(force, CompiledForce) and not force.has_derivatives:
                raise ParameterError(
                    name, force, "given with its derivatives for a breather",
                    "give (g, g_y) or (h, h_y, h_v)",
                )  # fmt: skip
        both = functions_of(self._source, self._array_functions, self._mark)
        return both["cell"], both["slopes"]

    @cached_property
    def _functions(self) -> Namespace:
        """Compiled functions, by their names in the source text of the kernel."""
        forces = (each for each in (self._g, self._h) if isinstance(each, CompiledForce))
        return tuple(pair for each in forces for pair in each.namespace)

    @cached_property
    def _array_functions(self) -> Namespace:
        """The same functions, vectorised for arrays."""
        return tuple((name, np.vectorize(each, otypes=[float])) for name, each in self._functions)

    @property
    def _mark(self) -> str:
        return " ".join(str(each) for each in (self._g, self._h) if isinstance(each, CompiledForce))

    @cached_property
    def _source(self) -> str:
        return self._text.full()

    def averaged(self) -> AveragedOscillatorChain:
        """Return the averaged chain of the same parameters."""
        return AveragedOscillatorChain(**self._attributes())


@dataclass(frozen=True, kw_only=True, eq=False)
class AveragedOscillatorChain(OwnChain, model="averaged-chain"):
    """An `OscillatorChain` averaged over a period, to first order in ε: the envelope φ.

        φ_n' = -½H(|φ_n|²)φ_n + iΩ(|φ_n|²)φ_n + (ic/2ω - cd/2) Σ_j W_nj (φ_n - φ_j)

    per unit of εt, for y = Im(φ e^{iωt}) and ẏ = ω Re(φ e^{iωt}); ω is the frequency of small
    motion of a cell, H and Ω are given in ``theory.cells.averaging``. A state is (Im φ, Re φ);
    times are t. The nonlinear part of the stiffness must be of order ε.

    Attributes
    ----------
    damping, c, stiffness, values, coupling, eps, velocity_coupling, overdamped, disorder, seed, \
sites, ends, shape
        As in :class:`OscillatorChain`.
    drive : empty
        Forces are not allowed, since they have frequencies of their own.

    Raises
    ------
    ParameterError
        If a parameter is out of range, there is a force or no inertia, or the frequency on a cycle
        differs too much from that to first order.

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
        self.check_unforced("the averaged chain, which assumes free oscillations")
        if self.overdamped:
            raise ParameterError(
                "overdamped",
                "true",
                "false: without inertia the chain does not oscillate",
                "leave it out",
            )
        for name in ("damping", "stiffness"):
            if not isinstance(getattr(self, name), str):
                raise ParameterError(
                    name, getattr(self, name), "a polynomial in y and v = dy/dt, which can be "
                    "averaged exactly", "give one as text, or run the full chain",
                )  # fmt: skip
        off = self._phase_lost()
        if off > MAX_PHASE:
            raise ParameterError(
                "stiffness", repr(self.stiffness), "linear up to terms of order eps: the phase of "
                f"the averaged chain would be wrong by {off:.2g} in a unit of eps t",
                "reduce the nonlinear terms, or run the full chain",
            )  # fmt: skip

    def _phase_lost(self) -> float:
        """Return the largest error of the first-order frequency of a stable cycle, divided by ε."""
        stiffness = as_polynomial(self.stiffness, "stiffness")
        mean = mean_shift_of_stiffness(stiffness).at(self._extreme_values()[0])
        small, worst = self.cell.frequency, 0.0
        for cycle in self.cell.cycles:
            if cycle.stable:
                shift = sum(value * cycle.amplitude ** (2 * i) for (i, _), value in mean.items())
                first = small + (shift - 0.5 * small**2) / small
                worst = max(worst, abs(2.0 * math.pi / cycle.period - first) / self.eps)
        return worst

    @property
    def kernel_rate(self) -> float:
        """ε, since the kernel is written in slow time."""
        return self.eps

    def kernel(self) -> Kernel:
        """Return the right-hand side for the envelope of a site, generated from the polynomials."""
        return functions_of(self._source)["cell"]

    @cached_property
    def _source(self) -> str:
        return self._text.averaged()

    @property
    def kernel_layout(self) -> tuple[int, ...]:
        """As for the full chain, except that the pull on both parts of φ is needed."""
        layout = super().kernel_layout
        return layout if self.network is None else (*layout[:2], 1)

    def full(self) -> OscillatorChain:
        """Return the full chain of the same parameters."""
        return OscillatorChain(**self._attributes())
