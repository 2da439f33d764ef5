"""Parameters of a chain or network of user-defined cells, common to its two models."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from theory.arrays import FloatArray
from theory.cells.compiled import CompiledForce, read_force
from theory.cells.compiled_cell import compiled_cell
from theory.cells.oscillator import Oscillator, OscillatorCell
from theory.cells.polynomial import Polynomial
from theory.chains.chain import (
    COUPLING_RANGE,
    EPS_RANGE,
    MAX_SITES,
    SITES_RANGE,
    SmoothChain,
    parameter,
)
from theory.chains.coupling import Network, is_file, largest_group_slope, network_of, size_of
from theory.chains.drive import Drive, read_drives
from theory.chains.ends import Ends
from theory.chains.model_file import read_model
from theory.chains.oscillator_kernel import OWN, Force, KernelText, clock_size
from theory.chains.site_values import (
    checked_disorder,
    checked_values,
    listed,
    pairs,
    relative_spread,
)
from theory.parameters import ParameterError, count_within, random_seed, truth

_EPS = 0.01
"""Default of the small parameter."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnChain(SmoothChain):
    """Parameters common to a chain of user-defined cells and to its average.

    They are described in :class:`~theory.chains.oscillator.OscillatorChain`.

    Raises
    ------
    ParameterError
        If a force is not a valid polynomial, a function cannot be compiled, a parameter has no
        value, the coupling does not fit, the cell has no rest state at y = 0, or its motion would
        grow without bound.
    """

    allowed_ends: ClassVar[tuple[Ends, ...]] = (Ends.FREE, Ends.PERIODIC, Ends.FIXED)

    damping: Any = parameter(
        "polynomial h in y and v = dy/dt; it multiplies eps*v, as in '1 - a*y**2 + b*y**4'", "h",
        kind="str",
    )  # fmt: skip
    c: float = parameter("coupling, zero or positive", "c")
    stiffness: Any = parameter("polynomial g in y, the restoring force", "g", "y", kind="str")
    values: Any = parameter(
        "value of a parameter named in the two polynomials, as in a=4; repeat for each",
        "values",
        {},
        kind="strings",
    )
    coupling: Any = parameter(
        "chain, ring, next-nearest:1,0.2, small-world:4,0.1,7, square, hexagonal, or a file of "
        "weights ending in .npz or .mtx", "W", "chain", kind="str",
    )  # fmt: skip
    eps: float = parameter("small parameter, {allowed}", "ε", _EPS, allowed=EPS_RANGE)
    velocity_coupling: float = parameter(
        "coefficient d of the coupling eps*c*(y_n - y_m + d*(v_n - v_m)); it multiplies c", "d", 0.0
    )
    overdamped: bool = parameter("without inertia: dy/dt takes the place of d²y/dt²", "-", False)
    disorder: Any = parameter(
        "relative spread of a parameter over the sites: a=0.1 is normal, a=uniform:0.1 uniform; "
        "repeat for each", "-", {}, kind="strings",
    )  # fmt: skip
    seed: int = parameter("seed of the disorder", "-", 0)
    drive: Any = parameter(
        "harmonic force F cos(wt + phase), as in F,w@1 or F,w,phase@1,4:6 or F,w@all; repeat for "
        "several", "F", (), kind="strings",
    )  # fmt: skip
    sites: int = parameter("number of sites, or rows x columns as in 5x6", "N", None, kind="shape")
    ends: Ends = parameter(
        "free: one neighbour only; periodic: a ring; fixed: springs to walls", "ends", Ends.FREE
    )
    shape: tuple[int, ...] | None = parameter(
        "rows and columns of a lattice, which may be given as sites", "-", None, option=False
    )

    def __post_init__(self) -> None:
        self._check_number("c", "coupling c", *COUPLING_RANGE)
        self._check_number("eps", "small parameter eps", *EPS_RANGE)
        self._check_number("velocity_coupling", "velocity coupling", -1e6, 1e6)
        self._check_ends()
        self._check_size()
        self._close_ring()
        set_ = object.__setattr__
        set_(self, "seed", random_seed(self.seed))
        set_(self, "overdamped", truth("overdamped", self.overdamped))
        for name in ("damping", "stiffness"):
            set_(self, name, _stored(getattr(self, name), name))
        if self.overdamped:
            self._check_overdamped()
        self._check_names()
        set_(self, "values", checked_values(self.values, self.names, self.sites))
        set_(self, "disorder", checked_disorder(self.disorder, self.names))
        set_(self, "drive", read_drives(self.drive, self.sites))
        for values in self._extreme_values():
            self._cell_of(values)
        _ = self.network

    def _check_size(self) -> None:
        given: Any = self.sites
        shape: Any = self.shape
        if isinstance(given, (tuple, list)):
            shape, given = given, None
        if shape is not None:
            if not isinstance(shape, (tuple, list)):
                raise ParameterError("shape", shape, "rows and columns", "as in (60, 60)")
            sides = tuple(count_within("rows and columns", each, 1, MAX_SITES) for each in shape)
            if len(sides) != 2:
                raise ParameterError("sites", shape, "a number or rows x columns", "as in 60x60")
            count = sides[0] * sides[1]
            if given is not None and given != count:
                raise ParameterError(
                    "number of sites n", given, f"{sides[0]} x {sides[1]} as for the lattice",
                    "give rows x columns as in 60x60",
                )  # fmt: skip
            object.__setattr__(self, "shape", sides)
            given = count
        if given is None:
            given = size_of(self.coupling) or 31
        object.__setattr__(self, "sites", given)
        self._check_count("sites", "number of sites n", *SITES_RANGE)

    def _close_ring(self) -> None:
        """Store a ring as a chain with periodic ends."""
        name, *weights = self.coupling.split(":") if isinstance(self.coupling, str) else [""]
        if name != "ring" or self.shape is not None:
            return
        if self.ends is Ends.FIXED:
            raise ParameterError(
                "ends", self.ends.value, "periodic of a ring", "leave them out, or couple a chain"
            )
        object.__setattr__(self, "coupling", ":".join(["chain", *weights]))
        object.__setattr__(self, "ends", Ends.PERIODIC)

    def _check_overdamped(self) -> None:
        """Refuse parameters that have no meaning without inertia, and set ε to one."""
        if not (isinstance(self._h, Polynomial) and not self._h.terms):
            raise ParameterError(
                "damping", self.damping, "0 without inertia", "put the force into the stiffness"
            )
        if self.velocity_coupling:
            raise ParameterError(
                "velocity coupling", self.velocity_coupling, "0 without inertia", "leave it out"
            )
        if self.eps not in (_EPS, 1.0):
            raise ParameterError(
                "small parameter eps", self.eps, "1 without inertia", "leave it out"
            )
        object.__setattr__(self, "eps", 1.0)

    @cached_property
    def _g(self) -> Force:
        found = read_force(self.stiffness, "stiffness")
        if isinstance(found, Polynomial) and found.degree("v"):
            raise ParameterError(
                "stiffness", repr(self.stiffness), "a polynomial in y", "put v into the damping"
            )
        return found

    @cached_property
    def _h(self) -> Force:
        return read_force(self.damping, "damping")

    def _check_names(self) -> None:
        own = {each.name for each in dataclasses.fields(self)}
        for name in self.names:
            if name in own:
                raise ParameterError(
                    "named parameter", name, f"other than {', '.join(sorted(own))}", "rename it"
                )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters of the cell, in alphabetical order."""
        return tuple(sorted({*self._g.names, *self._h.names}))

    @cached_property
    def site_values(self) -> dict[str, float | FloatArray]:
        """Values of the named parameters with disorder: a number, or an array of shape (N,)."""
        found: dict[str, float | FloatArray] = dict(self.values)
        for place, (name, spread) in enumerate(sorted(self.disorder.items())):
            found[name] = self.values[name] * (
                1.0 + relative_spread(spread, self.sites, [self.seed, place])
            )
        return found

    def _extreme_values(self) -> list[dict[str, float]]:
        """Return the mean values, and the values at sites where a parameter is extreme."""
        values = self.site_values
        arrays = [each for each in values.values() if isinstance(each, np.ndarray)]
        places = {int(place) for each in arrays for place in (each.argmin(), each.argmax())}
        at_places = [
            {
                name: float(np.asarray(each).flat[place % np.size(each)])
                for name, each in values.items()
            }
            for place in sorted(places)
        ]
        mean = {name: float(np.mean(each)) for name, each in self.values.items()}
        return [mean, *at_places]

    def _cell_of(self, values: Mapping[str, float]) -> Oscillator:
        g, h = self._g, self._h
        if isinstance(g, CompiledForce) or isinstance(h, CompiledForce):
            return compiled_cell(g, h, values, self.overdamped)
        stiffness = {i: value for (i, _), value in g.at(values).items()}
        damping = h.at(values)
        return OscillatorCell(stiffness=stiffness, damping=damping, overdamped=self.overdamped)

    @cached_property
    def cell(self) -> Oscillator:
        """A single cell, without disorder."""
        return self._cell_of(self._extreme_values()[0])

    @cached_property
    def network(self) -> Network | None:
        """The coupling; None if it is to the two neighbours only and all sites are alike."""
        varied = any(isinstance(each, np.ndarray) for each in self.site_values.values())
        alike = not (varied or self.drive)
        plain = isinstance(self.coupling, str) and self.coupling == "chain"
        if plain and alike and self.shape is None and self.ends is not Ends.FIXED:
            return None
        return self.links

    @property
    def along_line(self) -> bool:
        """Whether sites are coupled by distance along a line, so that it can be made longer."""
        named = isinstance(self.coupling, str) and self.shape is None
        return named and self.coupling.partition(":")[0] in ("chain", "next-nearest")

    @cached_property
    def links(self) -> Network:
        """The weights of the coupling, also where `network` is None."""
        return network_of(self.coupling, self.shape or (self.sites,), self.ends)

    @property
    def front_phase_step(self) -> int:  # type: ignore[override]
        """-1 if there is inertia and only displacements are coupled, as in (8); otherwise 0."""
        return -1 if self._has_waves else 0

    @property
    def time_unit(self) -> float:
        """1/ε, which is 1 without inertia."""
        return 1.0 / self.eps

    @property
    def trailing_wave_velocity(self) -> float:
        """Velocity of the fastest phase wave behind a front, εc/ω for neighbours of weight one.

        It is 0 if waves are damped, or if sites are not coupled by their distance along a line.
        """
        if not (self._has_waves and self.along_line):
            return 0.0
        fastest = largest_group_slope(self.coupling)
        return self.eps * self.c / self.cell.frequency * fastest

    @property
    def relaxation_time(self) -> float:
        """Time t in which motion at rest or near the unstable cycle is forgotten; 0 if overdamped.

        See `Oscillator.relaxation_time`.
        """
        return 0.0 if self.overdamped else self.cell.relaxation_time / self.eps

    @property
    def _has_waves(self) -> bool:
        """Whether undamped phase waves travel behind a front."""
        return not self.overdamped and not self.velocity_coupling

    @cached_property
    def _pair(self) -> tuple[float, float]:
        """The amplitude above which a site counts as reached, and that to which it then grows."""
        cycles = self.cell.cycles
        unstable = [each.amplitude for each in cycles if not each.stable]
        level = unstable[0] if unstable else 0.0
        above = [each.amplitude for each in cycles if each.stable and each.amplitude > level]
        if not above:
            raise ParameterError(
                "cell", "without a stable cycle", "one whose cell has an excited state",
                "change its parameters, or give a level and a displacement",
            )  # fmt: skip
        return (level or 0.5 * above[0]), above[0]

    @property
    def stable_amplitude(self) -> float:
        """Largest y of the first stable cycle above `unstable_amplitude`, to O(ε)."""
        return self._pair[1]

    @property
    def unstable_amplitude(self) -> float:
        """Largest y of the innermost unstable cycle; if there is none, half `stable_amplitude`."""
        return self._pair[0]

    @cached_property
    def rest_attracts(self) -> bool:
        """Whether no cell has stable cycles only, which would attract every motion."""
        cells = (self._cell_of(values) for values in self._extreme_values())
        return not any(cell.cycles and all(each.stable for each in cell.cycles) for cell in cells)

    @property
    def forces(self) -> tuple[Drive, ...]:
        """The harmonic forces."""
        found: tuple[Drive, ...] = self.drive
        return found

    @property
    def forced_size(self) -> float:
        """Displacement under static forces of the same amplitudes, F/g'(0)."""
        total = sum(abs(each.amplitude) for each in self.forces)
        return total / self.cell.frequency**2

    @cached_property
    def _scalars(self) -> tuple[str, ...]:
        return tuple(n for n in self.names if not isinstance(self.site_values[n], np.ndarray))

    @cached_property
    def _arrays(self) -> tuple[str, ...]:
        return tuple(n for n in self.names if n not in self._scalars)

    @property
    def _text(self) -> KernelText:
        return KernelText(
            stiffness=self._g,
            damping=self._h,
            scalars=self._scalars,
            arrays=self._arrays,
            neighbours=self.network is None,
            velocity_coupling=self.velocity_coupling != 0.0,
            overdamped=self.overdamped,
            drives=len(self.drive),
        )

    @property
    def kernel_layout(self) -> tuple[int, ...]:
        """Number of scalars in ``p`` and, for a network, the further entries of `SmoothChain`."""
        count = OWN + len(self._scalars) + clock_size(len(self.drive))
        if self.network is None:
            return (count,)
        return count, len(self._arrays) + len(self.drive), int(self.velocity_coupling != 0.0)

    def kernel_parameters(self) -> FloatArray:
        """Return c, ε, d, the number of weights, ω, named parameters, drive and network."""
        return self._packed

    @cached_property
    def _packed(self) -> FloatArray:
        values = self.site_values
        links = 0 if self.network is None else self.network.weights.size
        own = [self.c, self.eps, self.velocity_coupling, float(links), self.cell.frequency]
        head = np.array(own + [float(np.asarray(values[name])) for name in self._scalars])
        clock = [np.array([each.frequency, each.phase, np.cos(each.phase)]) for each in self.drive]
        clock = [np.zeros(1), *clock] if clock else []
        arrays = [np.asarray(values[name]) for name in self._arrays]
        arrays += [each.amplitudes(self.sites) for each in self.drive]
        network = [] if self.network is None else [self.network.packed()]
        packed: FloatArray = np.concatenate([head, *clock, *arrays, *network])
        packed.setflags(write=False)
        return packed

    def _attributes(self) -> dict[str, Any]:
        """Return the attributes by name."""
        return {each.name: getattr(self, each.name) for each in dataclasses.fields(self)}

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some parameters changed; parameters of the cell are given by name."""
        own = {each.name for each in dataclasses.fields(self)}
        named = {name: value for name, value in changes.items() if name in self.names}
        rest = {name: value for name, value in changes.items() if name not in named}
        if named:
            rest["values"] = {**pairs("values", rest.get("values", self.values)), **named}
        if "sites" in rest and "shape" not in rest:
            rest["shape"] = None
        for name in rest:
            if name not in own:
                allowed = f"one of {', '.join([*self.names, *sorted(own)])}"
                raise ParameterError("parameter", name, allowed, "rename it")
        return dataclasses.replace(self, **rest)

    def __getattr__(self, name: str) -> Any:
        """Return a named parameter of the cell, as ``chain.a``."""
        values = self.__dict__.get("values")
        if isinstance(values, dict) and name in values:
            return values[name]
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")

    def parameters(self) -> dict[str, Any]:
        """Return the model and its parameters in a form suitable for JSON."""
        found = super().parameters()
        found |= {"damping": str(self.damping), "stiffness": str(self.stiffness)}
        found["values"] = {name: listed(value) for name, value in self.values.items()}
        found["disorder"] = dict(self.disorder)
        if not isinstance(self.coupling, str):
            found["coupling"] = f"weights {self.links.digest}"
        elif is_file(self.coupling):
            found["coupling"] = f"{Path(self.coupling).name} {self.links.digest}"
        for name, given in (("drive", [*map(str, self.drive)]), ("shape", [*(self.shape or ())])):
            if given:
                found[name] = given
            else:
                del found[name]
        return found

    @cached_property
    def _identity(self) -> str:
        return json.dumps(self.parameters(), sort_keys=True)

    def __eq__(self, other: object) -> bool:
        """Return whether the other chain has the same parameters."""
        return type(other) is type(self) and self._identity == other._identity

    def __hash__(self) -> int:
        """Return a hash of the parameters."""
        return hash(self._identity)

    @classmethod
    def from_file(cls, path: Path | str, **changes: Any) -> Self:
        """Return the chain that a model file in TOML describes, with some parameters changed.

        Parameters
        ----------
        path : Path or str
            The model file. Its keys are the attributes of this class; ``values`` and ``disorder``
            are tables. A file of weights is searched for in the same directory.
        **changes
            Attributes that replace those in the file.

        Raises
        ------
        ParameterError
            If the file cannot be read, or contains a key that is not an attribute.
        """
        known = [each.name for each in dataclasses.fields(cls)]
        return cls(**read_model(Path(path), known, changes))


def _stored(given: Any, quantity: str) -> Any:
    """Return a force in the form in which it is stored: the text of a polynomial, or functions."""
    force = read_force(given, quantity)
    if isinstance(force, CompiledForce):
        return force
    return given if isinstance(given, str) else str(given)
