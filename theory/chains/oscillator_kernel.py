"""Right-hand sides of a site, generated as source text from the forces of a cell.

Names of the cell's parameters never begin with ``_``, whereas all other names in the text do. The
text consists of numbers, names, the operations of `Polynomial.source`, and calls of compiled
forces.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import FunctionType
from typing import Any, TypeAlias

from theory.cells.averaging import (
    FREQUENCY,
    mean_damping,
    mean_shift_of_damping,
    mean_shift_of_stiffness,
)
from theory.cells.compiled import CompiledForce
from theory.cells.polynomial import Polynomial, as_polynomial
from theory.chains.chain import Kernel

Force: TypeAlias = Polynomial | CompiledForce
Namespace: TypeAlias = tuple[tuple[str, Any], ...]

OWN = 5
"""Number of scalars at the beginning of a kernel's parameters: c, ε, d, number of weights, ω."""


def clock_size(drives: int) -> int:
    """Return the number of scalars for the time and ``drives`` harmonic functions of it."""
    return 1 + 3 * drives if drives else 0


@dataclass(frozen=True, kw_only=True)
class KernelText:
    """Everything on which the source text of a right-hand side depends.

    Attributes
    ----------
    stiffness, damping : Polynomial or CompiledForce
        g and h.
    scalars, arrays : sequence of str
        Names of the parameters with one value, and of those with one value per site.
    neighbours : bool
        Whether the kernel takes the two neighbours of a site, instead of the pull of a network.
    velocity_coupling, overdamped : bool
        Whether velocities are coupled; whether there is no inertia.
    drives : int
        Number of harmonic forces; their amplitudes at the sites follow the other arrays.
    """

    stiffness: Force
    damping: Force
    scalars: Sequence[str]
    arrays: Sequence[str]
    neighbours: bool
    velocity_coupling: bool
    overdamped: bool
    drives: int = 0

    @property
    def _values(self) -> list[str]:
        """The lines that read the parameters."""
        first = OWN + len(self.scalars)
        head = first + clock_size(self.drives)
        arrays = [*self.arrays, *(f"_force{k}" for k in range(self.drives))]
        lines = [f"    _c, _eps, _d, {FREQUENCY} = _p[0], _p[1], _p[2], _p[4]"]
        lines += [f"    {name} = _p[{OWN + at}]" for at, name in enumerate(self.scalars)]
        lines += [f"    {name} = _p[{head} + {at} * _sites + _n]"
                  for at, name in enumerate(arrays)]  # fmt: skip
        lines += [f"    _cosine{k} = _p[{first + 3 * k + 3}]" for k in range(self.drives)]
        return lines

    @property
    def _signature(self) -> str:
        return "_site, _left, _right, _p" if self.neighbours else "_site, _pull, _p, _n, _sites"

    def _pull(self, at: int, own: str) -> str:
        if self.neighbours:
            return f"(2.0*{own} - (_left[{at}] + _right[{at}]))"
        return f"_pull[{at}]"

    def full(self) -> str:
        """Return the text of ``cell`` and, if the derivatives are known, of ``slopes``."""
        own = f"-({self.stiffness.source()})"
        if not self.overdamped:
            own += f" - _eps*v*({self.damping.source()})"
        force = f"{own} - _eps*_c*{self._pull(0, 'y')}"
        if self.velocity_coupling:
            force += f" - _eps*_c*_d*{self._pull(1, 'v')}"
        force += "".join(f" + _force{k}*_cosine{k}" for k in range(self.drives))
        rate = f"{force}, -v" if self.overdamped else f"v, {force}"
        lines = [f"def cell({self._signature}):", "    y, v = _site", *self._values]
        lines += [f"    return {rate}", *self._slopes(), ""]
        return "\n".join(lines)

    def _slopes(self) -> list[str]:
        """Return the lines of ``slopes``, or no lines where a derivative is not known."""
        known = [_derivatives(self.stiffness), _damped_derivatives(self.damping)]
        if not all(known):
            return []
        (g_y,), (by_y, by_v) = known
        by_y, by_v = f"-({g_y}) - _eps*({by_y})", f"-_eps*({by_v})"
        if self.overdamped:
            by_y, by_v = f"-({g_y})", "-1.0"
        head = "def slopes(y, v, _p, _n, _sites):"
        return [head, *self._values, f"    return {by_y}, {by_v}"]

    def averaged(self) -> str:
        """Return the text of ``cell`` for (Im φ, Re φ) per unit of εt (``theory.cells.averaging``).

        Coupling averages to (ic/2ω - cd/2) Σ_j W_nj (φ_n - φ_j).
        """
        damping = as_polynomial(self.damping, "damping")
        shift = mean_shift_of_stiffness(self._beyond_frequency())
        left = "" if self._linear_is_frequency() else f" - 0.5*{FREQUENCY}*{FREQUENCY}"
        real, imaginary = self._pull(1, "_re"), self._pull(0, "_im")
        return "\n".join(
            [f"def cell({self._signature}):", "    _im, _re = _site", *self._values,
             "    y = _im*_im + _re*_re",
             f"    _less = -0.5*({mean_damping(damping).source()})",
             f"    _turn = (({shift.source()}){left})/({FREQUENCY}*_eps)"
             f" + ({mean_shift_of_damping(damping).source()})",
             f"    _a, _b = 0.5*_c/{FREQUENCY}, 0.5*_c*_d",
             f"    _pull_im, _pull_re = {imaginary}, {real}",
             "    return (_less*_im + _turn*_re + _a*_pull_re - _b*_pull_im,",
             "            _less*_re - _turn*_im - _a*_pull_im - _b*_pull_re)", ""]
        )  # fmt: skip

    def _linear_is_frequency(self) -> bool:
        """Whether the linear part of the stiffness is ω²y at every site."""
        terms = as_polynomial(self.stiffness, "stiffness").terms
        linear = [each for each in terms if dict(each).get("y") == 1]
        return not any(name in self.arrays for each in linear for name, _ in each)

    def _beyond_frequency(self) -> Polynomial:
        """Return the stiffness, without its linear part if that is ω²y at every site."""
        stiffness = as_polynomial(self.stiffness, "stiffness")
        if not self._linear_is_frequency():
            return stiffness
        terms = stiffness.terms.items()
        return Polynomial({each: value for each, value in terms if dict(each).get("y") != 1})


def _derivatives(stiffness: Force) -> tuple[str, ...]:
    """Return the text of the derivative of g by y; an empty tuple if it is not known."""
    if isinstance(stiffness, Polynomial):
        return (stiffness.derivative("y").source(),)
    return (stiffness.source("y"),) if stiffness.has_derivatives else ()


def _damped_derivatives(damping: Force) -> tuple[str, ...]:
    """Return the texts of the derivatives of vh by y and v; an empty tuple if not known."""
    if isinstance(damping, Polynomial):
        damped = damping.times("v")
        return damped.derivative("y").source(), damped.derivative("v").source()
    if not damping.has_derivatives:
        return ()
    return f"v*{damping.source('y')}", f"{damping.source()} + v*{damping.source('v')}"


@lru_cache(maxsize=256)
def functions_of(source: str, outside: Namespace = (), mark: str = "") -> dict[str, Kernel]:
    """Return the functions defined by a generated text, by name.

    The functions themselves are renamed by a digest of the text and ``mark``.

    Parameters
    ----------
    source : str
        The text.
    outside : tuple of pairs
        Names of the functions that it calls, and the functions.
    mark : str
        Digest of the content of these functions.
    """
    digest = hashlib.sha256((source + mark).encode()).hexdigest()[:16]
    names: dict[str, Any] = {"__name__": __name__, **dict(outside)}
    exec(compile(source, f"<cell {digest}>", "exec"), names)
    found: dict[str, Kernel] = {}
    for name in ("cell", "slopes"):
        if name in names:
            function: FunctionType = names[name]
            function.__name__ = function.__qualname__ = f"{name}_{digest}"
            found[name] = function
    return found
