"""The table of test problems, shared by tests, benchmarks, the robustness table and the report.

`PROBLEMS` holds them by family, one for each set of parameters; a quantity names its family
(``verification.quantities.quantity``). The rules of the table, checked by tests/test_problems.py,
are:

1. Names are unique in their family and usable as test identifiers.
2. All problems of a family have values for the same parameters, and a quantity uses all of them.
3. ``ordinary`` problems lie on a curve of the paper and come first; ``stiff`` ones have a narrow
   strip of analyticity, crowded roots, or fast as well as slow motion; ``extreme`` ones are where a
   carelessly written formula overflows, underflows or loses a root, or where there are very many
   sites. Every problem has a tag; ordinary ones have no other.
4. The first problem of a family is ordinary and timed, and at least one is not ordinary.
5. For Σ the tags follow from numbers: a problem is extreme if v or c is at or beyond 10⁻³ or 10³;
   it is ordinary if it is not extreme, the root-free strip is no narrower than 1/10, and c/v,
   the approximate number of roots per unit, is at most 10.

If η and a are given, b = ηa² (`Problem.cell`). ε = 0 stands for the averaged chain (43).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from theory.chains.vdp import VdpChain

Tag = Literal["ordinary", "stiff", "extreme"]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A named set of parameter values.

    Attributes
    ----------
    name : str
        What is special about it, usable as a test identifier; unique in its family.
    values : mapping of str to float
        Parameters by symbol, dimensionless.
    tags : tuple of str
        Any of ``"ordinary"``, ``"stiff"``, ``"extreme"``.
    timed : bool
        Whether the benchmarks measure error against run time at this problem.
    """

    name: str
    values: Mapping[str, float]
    tags: tuple[Tag, ...]
    timed: bool

    def __getitem__(self, name: str) -> float:
        """Return the value of a parameter; ``KeyError`` if the problem does not have it."""
        return self.values[name]

    @property
    def v(self) -> float:
        """Scaled front velocity, dimensionless; ``KeyError`` if the problem does not have it."""
        return self.values["v"]

    @property
    def c(self) -> float:
        """Coupling, dimensionless; ``KeyError`` if the problem does not have it."""
        return self.values["c"]

    @property
    def sites(self) -> int:
        """Number of sites; ``KeyError`` if the problem does not have it."""
        return int(self.values["sites"])

    @property
    def cell(self) -> dict[str, float]:
        """Parameters a, b = ηa² and ε of a cell of (8).

        Examples
        --------
        >>> timed("chain")[0].cell
        {'a': 4.0, 'b': 0.5, 'eps': 0.01}
        """
        a = self["a"]
        return {"a": a, "b": self["eta"] * a * a, "eps": self["eps"]}

    def vdp_chain(self, sites: int | None = None) -> VdpChain:
        """Return its chain (8), by default with its own length; ε = 0 is replaced by 0.01."""
        a, b, eps = self.cell.values()
        sites = self.sites if sites is None else sites
        return VdpChain(a=a, b=b, c=self.c, eps=eps or 0.01, sites=sites)


def _problem(name: str, *tags: Tag, timed: bool = False, **values: float) -> Problem:
    return Problem(name=name, values=values, tags=tags, timed=timed)


PROBLEMS: Mapping[str, tuple[Problem, ...]] = {
    "sum": (
        _problem("ordinary", "ordinary", v=0.3, c=0.5, timed=True),
        _problem("unit", "ordinary", v=1.0, c=1.0),
        _problem("fast", "ordinary", v=3.0, c=0.7),
        _problem("slow", "stiff", v=1e-2, c=0.5),
        _problem("small-v", "stiff", "extreme", v=1e-3, c=0.5, timed=True),
        _problem("large-c", "stiff", v=7.4, c=100.0, timed=True),
        _problem("larger-c", "stiff", "extreme", v=74.0, c=1e4),
        _problem("large-v-over-c", "extreme", v=1e3, c=1e-3),
        _problem("small-v-over-c", "stiff", "extreme", v=1e-3, c=1e3),
        _problem("weak-coupling", "extreme", v=0.3, c=1e-6),
        _problem("resonance", "stiff", v=72.46, c=100.0),
        _problem("pole-crossing-the-contour", "stiff", v=159.82338529816317, c=214.92354611211903),
        _problem("contour-touching-a-pole", "stiff", v=7.0562693897135915, c=10.802444936499525),
    ),
    "relation": (
        _problem("ordinary", "ordinary", c=0.5, eta=0.03125, timed=True),
        _problem("hysteresis", "ordinary", c=0.45, eta=0.03125, timed=True),
        _problem("pinned", "ordinary", c=0.2, eta=0.03125),
        _problem("retreat", "ordinary", c=2.0, eta=0.11),
        _problem("three-at-a-resonance", "stiff", c=100.0, eta=1e-4, timed=True),
        _problem("no-pinning-from-here", "stiff", c=1.0, eta=0.08),
        _problem("cycles-meet", "stiff", c=1.0, eta=0.125 * (1 - 1e-12)),
        _problem("cycles-gone", "extreme", c=1.0, eta=0.2),
        _problem("fastest", "extreme", c=1e8, eta=1e-12),
    ),
    "breather": (
        _problem("paper", "ordinary", a=2.5, eta=0.08, c=0.1, eps=0.01, sites=7, timed=True),
        _problem("paper-steep", "ordinary",
                 a=4.0, eta=0.03125, c=0.1, eps=0.01, sites=7, timed=True),
        _problem("beside-the-fold", "stiff",
                 a=2.5, eta=0.08, c=0.19, eps=0.01, sites=7, timed=True),
        _problem("weak", "extreme", a=1.0, eta=0.05, c=1e-8, eps=1e-6, sites=7),
        _problem("cycles-meet", "stiff", a=1.0, eta=0.125 * (1 - 1e-9), c=1e-6, eps=0.01, sites=7),
        _problem("not-averageable", "extreme", a=1.0, eta=0.01, c=0.1, eps=1.0, sites=7),
    ),
    "multipliers": (
        _problem("paper", "ordinary", a=2.5, eta=0.08, c=0.1, eps=0.01, sites=7, timed=True),
        _problem("long-chain", "stiff", a=4.0, eta=0.03125, c=0.1, eps=0.01, sites=31, timed=True),
        _problem("beside-the-fold", "stiff",
                 a=2.5, eta=0.08, c=0.19, eps=0.01, sites=7, timed=True),
    ),
    "chain": (
        _problem(
            "ordinary", "ordinary", a=4.0, eta=0.03125, c=0.6, eps=0.01, sites=31, t=1000.0,
            timed=True,
        ),
        _problem(
            "strong-damping", "stiff", a=4.0, eta=0.03125, c=0.6, eps=1.0, sites=31, t=40.0,
            timed=True,
        ),
    ),
    "own-chain": (
        _problem("next-nearest", "ordinary", k=0.01, far=0.2, d=0.0, spread=0.1, c=0.6, eps=0.05,
                 sites=31, rows=1, t=200.0, timed=True),
        _problem("lattice", "extreme", k=0.0, far=0.0, d=0.0, spread=0.0, c=0.6, eps=0.05,
                 sites=10_000, rows=100, t=200.0, timed=True),
    ),
    "friction": (
        _problem("ordinary", "ordinary", c=0.02, sites=31, t=200.0, timed=True),
        _problem("many-events", "stiff", c=0.05, sites=31, t=400.0, timed=True),
    ),
    "front": (
        _problem("averaged", "ordinary", a=4.0, eta=0.03125, c=0.6, eps=0.0, timed=True),
        _problem("full", "ordinary", a=4.0, eta=0.03125, c=0.6, eps=0.01, timed=True),
        _problem("slow", "stiff", a=4.0, eta=0.03125, c=0.45, eps=0.0, timed=True),
    ),
    "map": (
        _problem("breather-to-front", "ordinary", eta=0.05, low=0.1, high=0.9, timed=True),
        _problem("steep", "stiff", eta=0.02, low=0.05, high=0.9, timed=True),
    ),
    "derivation": (
        _problem("first-order", "ordinary", order=1, a=2.5, eta=0.08, eps=1e-3, timed=True),
        _problem("second-order", "stiff", order=2, a=2.5, eta=0.08, eps=1e-3, timed=True),
    ),
}  # fmt: skip
"""Test problems by family; a point of the robustness table takes the parameters that it needs."""


def timed(family: str) -> tuple[Problem, ...]:
    """Return the problems of a family that the benchmarks measure, the easiest first.

    Examples
    --------
    >>> [problem.name for problem in timed("sum")]
    ['ordinary', 'small-v', 'large-c']
    """
    return tuple(problem for problem in PROBLEMS[family] if problem.timed)
