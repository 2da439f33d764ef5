"""The base class of chains, whose contract every model fulfils, and the register of models.

A chain consists of the parameters of one model, checked on construction, and its equation of
motion. It does not integrate, measure or print; the functions that do so accept any chain.
"""

from __future__ import annotations

import dataclasses
import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from theory.arrays import FloatArray
from theory.chains.ends import Ends
from theory.parameters import ParameterError, Range, count_within, real_number

if TYPE_CHECKING:
    from theory.chains.coupling import Network
    from theory.chains.drive import Drive


CHAINS: dict[str, type[Chain]] = {}
"""Every model by name; subclasses of :class:`Chain` register themselves."""

MAX_SITES = 1_000_000
SITES_RANGE = Range(2, MAX_SITES)
EPS_RANGE = Range(1e-9, 10.0)
"""Range of the small parameter ε of smooth chains."""

COUPLING_RANGE = Range(0.0, 1e6)
SMALLEST_C = 1e-100
"""Smallest coupling of breathers and thresholds; c² must not be too small for double precision."""

_STEP = 1e-4
"""Part of the threshold amplitude by which a site at rest is displaced to find how it returns."""


class Site(NamedTuple):
    """The state of one site, two numbers: (y, ẏ), or (Im φ, Re φ) for an envelope."""

    y: float
    w: float


Kernel = Callable[..., tuple[Any, Any]]
"""Right-hand side of a site: (site, left neighbour, right neighbour, parameters) → (y', w')."""


def parameter(
    text: str,
    symbol: str,
    default: Any = dataclasses.MISSING,
    *,
    kind: str = "",
    allowed: Range | None = None,
    option: bool = True,
) -> Any:
    """Return a dataclass field with the help text and the symbol for its command-line option.

    Parameters
    ----------
    text : str
        Meaning and range of the parameter, for ``--help``; "{allowed}" is replaced by the range.
    symbol : str
        Its symbol in the equations.
    default : optional
        Value used if none is given.
    kind : str, optional
        How the command line reads the value (``fronts.signatures``), if that does not follow from
        its type.
    allowed : Range, optional
        Its range. Some commands allow a narrower one, which their help shows instead.
    option : bool, optional
        Whether it is an option of the command line.
    """
    metadata: dict[str, Any] = {"help": text, "symbol": symbol}
    metadata |= {"kind": kind} if kind else {}
    metadata |= {"allowed": allowed} if allowed else {}
    metadata |= {} if option else {"option": False}
    if isinstance(default, dict):
        return dataclasses.field(default_factory=lambda: dict(default), metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


class Chain(ABC):
    """Parameters and equation of motion of one model of a chain of bistable sites.

    How to write a new chain:

    1. Write a dataclass, ``@dataclass(frozen=True, kw_only=True)``, derived from
       :class:`SmoothChain` if its right-hand side is smooth, and name the model in the class line:
       ``class Nagumo(SmoothChain, model="nagumo")``. This registers it in :data:`CHAINS`.
    2. Declare each parameter by :func:`parameter`; the options of the command line are derived from
       these. Parameters are dimensionless.
    3. Check the parameters in ``__post_init__``: :meth:`_check_number` and :meth:`_check_count`
       refuse text, NaN, truth values and arrays, and store a plain float or int;
       :meth:`_check_ends` compares the ends with ``allowed_ends``.
    4. Define :attr:`stable_amplitude`, the amplitude of the excited state, and
       :attr:`unstable_amplitude`, the amplitude above which a site counts as reached. Raise
       ``ParameterError`` if they do not exist.
    5. Define :attr:`time_unit`, the time t in which amplitudes change by a factor of order one; it
       is the unit of waiting times for fronts and thresholds.
    6. If the motion is smooth, follow the remaining steps in :class:`SmoothChain`. If it is not,
       name an integration of your own in ``verification.runs.integrations.INTEGRATIONS``.

    Attributes
    ----------
    model : str
        Name of the model.
    allowed_ends : tuple of Ends
        Ends that the model accepts; empty if the chain has none.
    """

    model: ClassVar[str]
    allowed_ends: ClassVar[tuple[Ends, ...]] = (Ends.FREE,)

    def __init_subclass__(cls, model: str | None = None, **options: Any) -> None:
        """Register the subclass in :data:`CHAINS` if it names a model."""
        super().__init_subclass__(**options)
        if model is not None:
            cls.model = model
            CHAINS[model] = cls

    @property
    @abstractmethod
    def rest_state(self) -> Site:
        """State (y, w) of a site at rest."""

    @property
    @abstractmethod
    def stable_amplitude(self) -> float:
        """Amplitude of the excited state of an isolated site."""

    @property
    @abstractmethod
    def unstable_amplitude(self) -> float:
        """Amplitude above which a site counts as reached."""

    @property
    def time_unit(self) -> float:
        """Time t in which amplitudes change by a factor of order one."""
        return 1.0

    def replace(self, **changes: Any) -> Self:
        """Return a copy of this chain with some parameters changed and checked again.

        Raises
        ------
        ParameterError
            If one is out of range, or the chain has no such parameter.

        Examples
        --------
        >>> from theory.chains.vdp import VdpChain
        >>> VdpChain(a=4, b=0.5, c=0.6).replace(c=0.5).c
        0.5
        """
        names = [each.name for each in dataclasses.fields(self)]  # type: ignore[arg-type]
        for name in changes:
            if name not in names:
                raise ParameterError("parameter", name, f"one of {', '.join(names)}", "rename it")
        return dataclasses.replace(self, **changes)  # type: ignore[type-var]

    def parameters(self) -> dict[str, Any]:
        """Return the model and its parameters in a form suitable for JSON.

        Examples
        --------
        >>> from theory.chains.vdp import VdpChain
        >>> VdpChain(a=4, b=0.5, c=0.6).parameters()
        {'model': 'vdp', 'a': 4.0, 'b': 0.5, 'c': 0.6, 'eps': 0.01, 'sites': 31, 'ends': 'free'}
        """
        found: dict[str, Any] = {"model": self.model}
        for each in dataclasses.fields(self):  # type: ignore[arg-type]
            value = getattr(self, each.name)
            found[each.name] = value.value if isinstance(value, StrEnum) else value
        return found

    def _check_number(
        self,
        name: str,
        quantity: str,
        low: float,
        high: float,
        remedy: str = "give a number in this range",
    ) -> None:
        """Check a real parameter and store it as a float."""
        checked = real_number(quantity, getattr(self, name), low, high, remedy)
        object.__setattr__(self, name, checked)

    def _check_count(self, name: str, quantity: str, low: float, high: float) -> None:
        """Check an integer parameter and store it as an int."""
        object.__setattr__(self, name, count_within(quantity, getattr(self, name), low, high))

    def _check_ends(self) -> None:
        """Check the ends, given as a member of `Ends` or its value, and store the member."""
        given: Any = self.ends  # type: ignore[attr-defined]
        words = [end.value for end in self.allowed_ends]
        if not isinstance(given, str) or given not in words:
            raise ParameterError(
                "ends", given, " or ".join(words), f"the model {self.model} takes such ends"
            )
        object.__setattr__(self, "ends", Ends(given))


class SmoothChain(Chain):
    """A chain whose right-hand side is smooth; two numbers per site, coupled to its neighbours.

    How to write one, in addition to the guidelines of :class:`Chain`:

    1. Declare :attr:`sites` as a parameter, and :attr:`ends` if they can be other than free.
    2. Write the right-hand side of one site as a plain function at the top level of a module, and
       name it in the class line, ``class Nagumo(SmoothChain, model="nagumo", kernel=nagumo)``::

           def nagumo(site, left, right, p):
               y, _ = site
               return y * (1 - y) * (y - p[0]) + p[1] * (left[0] + right[0] - 2 * y), 0.0

       ``site``, ``left`` and ``right`` are pairs (y, w), and ``p`` is :meth:`kernel_parameters` as
       a tuple: by default all numerical parameters in the order of their declaration, except the
       number of sites. The function is compiled by numba when it is first integrated, so it may use
       arithmetic, ``math``, and functions of the same kind compiled by ``numba.njit``. Add the two
       neighbours first, so that a mirror-symmetric state remains symmetric to the last bit. At a
       free end the missing neighbour equals the site itself.
    3. Measure y and w from the rest state, which is then (0, 0); the amplitude of a site is
       √(y² + w²). If the rest state is not stable, override :attr:`rest_attracts`.
    4. If the time of the kernel is not t, override :attr:`kernel_rate`; if a site oscillates with a
       period of about 2π in that time, set :attr:`oscillates`.
    5. If waves travel behind a front, define :attr:`trailing_wave_velocity`; if the phases of
       successive excited sites differ by a fixed step, set :attr:`front_phase_step`.
    6. If sites are coupled to sites other than their two neighbours, return the weights from
       :attr:`network`. The kernel then takes (site, pull, p, n, N), where ``pull`` is the pair of
       Σ_j W_nj (y_n - y_j), including walls, and the same sum for w; ``p`` is the whole array of
       parameters, n the index of the site, and N the number of sites. :attr:`kernel_layout`
       contains the number of scalars at the beginning of ``p``, the fourth of which is the number
       of weights; the number of parameters with N values that follow; and whether the ``pull`` of w
       is needed (1 or 0). At the end of ``p`` come total, weights, starts and sites
       (:meth:`theory.chains.coupling.Network.packed`).
    7. If harmonic forces act, return them from :attr:`forces`. The scalars of the kernel must then
       end with t and, for each force, ω, its phase and cos(ωt + phase); integrations insert t and
       the cosines at every stage of a step. Define :attr:`forced_size`.

    Attributes
    ----------
    oscillates : bool
        Whether (y, w) turns clockwise with a period of about 2π in the kernel's time.
    front_phase_step : int
        Phase step from a site to the next one behind a front, in quarter turns.
    """

    _right_hand_side: ClassVar[Kernel]
    oscillates: ClassVar[bool] = False
    front_phase_step: ClassVar[int] = 0

    sites: int
    ends: Ends = Ends.FREE

    def __init_subclass__(cls, kernel: Kernel | None = None, **options: Any) -> None:
        """Store the right-hand side of one site, if it is the same for all parameters."""
        super().__init_subclass__(**options)
        if kernel is not None:
            cls._right_hand_side = staticmethod(kernel)

    def kernel(self) -> Kernel:
        """Return the right-hand side of one site; see the guidelines of the class."""
        return self._right_hand_side

    def kernel_parameters(self) -> tuple[float, ...] | FloatArray:
        """Return the kernel's ``p``: by default all numerical parameters except ``sites``."""
        names = (each.name for each in dataclasses.fields(self))  # type: ignore[arg-type]
        values = (getattr(self, name) for name in names if name != "sites")
        return tuple(float(each) for each in values if isinstance(each, (int, float)))

    @property
    def kernel_layout(self) -> tuple[int, ...]:
        """Number of scalars in ``p``; for a network, see the guidelines of the class."""
        return (len(self.kernel_parameters()),)

    @property
    def network(self) -> Network | None:
        """The coupling; None if each site is coupled to its two neighbours only."""
        return None

    @property
    def forces(self) -> tuple[Drive, ...]:
        """The harmonic forces on sites."""
        return ()

    @property
    def forced_size(self) -> float:
        """Size of the motion excited by forces; relative errors refer to at least this size."""
        return 0.0

    def check_unforced(self, what: str) -> None:
        """Refuse a chain on which forces act.

        Raises
        ------
        ParameterError
            If there is a force.
        """
        if self.forces:
            forces = " and ".join(map(str, self.forces))
            raise ParameterError("drive", forces, f"none for {what}", "leave it out")

    @property
    def kernel_rate(self) -> float:
        """Amount of the kernel's time that elapses per unit of t."""
        return 1.0

    @property
    def rest_state(self) -> Site:
        """(0, 0), since y and w are measured from the rest state."""
        return Site(0.0, 0.0)

    @property
    def rest_attracts(self) -> bool:
        """Whether an isolated site returns to rest from amplitudes below `unstable_amplitude`."""
        return True

    @property
    def trailing_wave_velocity(self) -> float:
        """Largest velocity, in sites per unit t, of undamped waves behind a front; 0 for none."""
        return 0.0

    @property
    def relaxation_time(self) -> float:
        """Time t in which small motion of a site at rest decays by a factor e.

        It is 0 if sites do not oscillate: without waves that run ahead of it, a front approaches
        its velocity from one side.
        """
        if not (self.oscillates or self.trailing_wave_velocity):
            return 0.0
        kernel, p, step = self.kernel(), self.kernel_parameters(), _STEP * self.unstable_amplitude

        def rate(y: float, w: float) -> tuple[float, float]:
            """Return the derivatives of a site with which all others move, so that none pulls."""
            site = (y, w)
            if self.network is None:
                return kernel(site, site, site, p)
            return kernel(site, (0.0, 0.0), p, 0, self.sites)

        # The area of a cloud of states shrinks at the rate -div, the amplitude at half of it.
        along = rate(step, 0.0)[0] - rate(-step, 0.0)[0]
        across = rate(0.0, step)[1] - rate(0.0, -step)[1]
        decay = -0.25 * self.kernel_rate * (along + across) / step
        return 1.0 / decay if decay > 0.0 else math.inf

    def excited_state(self, displacement: float, quarter_turns: int = 0) -> Site:
        """Return (y, w) of a site at a given distance from rest and with a given phase.

        Parameters
        ----------
        displacement : float
            √(y² + w²), dimensionless; its sign is that of y at phase zero.
        quarter_turns : int
            Phase in quarter turns; the phase grows with time, from y towards -w.

        Examples
        --------
        >>> from theory.chains.vdp import VdpChain
        >>> tuple(VdpChain(a=4, b=0.5, c=0.6).excited_state(2.0, 1))
        (0.0, -2.0)
        """
        y, w = ((1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 1.0))[quarter_turns % 4]
        return Site(displacement * y + 0.0, displacement * w + 0.0)
