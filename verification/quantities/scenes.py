"""One table of named scenes, shared by tests, benchmarks, the stability table and the report.

`FAMILIES` holds scenes by name of parameter, one family for each kind of problem; `REFERENCES` says
for each quantity which family it is computed on, and by which independent method, to what accuracy,
its true value is known there. ``ordinary`` scenes are where a paper's curve lies; ``stiff`` ones
narrow the strip of analyticity, crowd the roots, or mix fast and slow motion; ``extreme`` ones are
where a formula written carelessly overflows, underflows or loses a root. `SCENES` are the
velocities and couplings at which Σ(v, c) of Eq. (53) is computed.

Where η and a are given, b = ηa² (`damping`). ε = 0 stands for the averaged chain (43), the limit.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Tag = Literal["ordinary", "stiff", "extreme"]


@dataclass(frozen=True)
class Scene:
    """A named point of any parameters.

    Attributes
    ----------
    name : str
        What is peculiar to it, usable as a test identifier; unique in its family.
    values : mapping of str to float
        Parameters by symbol, dimensionless.
    tags : tuple of str
        Any of ``"ordinary"``, ``"stiff"``, ``"extreme"``.
    timed : bool
        Whether the benchmarks measure error against run time there.
    """

    name: str
    values: Mapping[str, float]
    tags: tuple[Tag, ...]
    timed: bool = False

    @property
    def v(self) -> float:
        """Scaled front velocity, dimensionless; ``KeyError`` where the scene has none."""
        return self.values["v"]

    @property
    def c(self) -> float:
        """Coupling, dimensionless; ``KeyError`` where the scene has none."""
        return self.values["c"]


@dataclass(frozen=True)
class Reference:
    """How the true value of a quantity is known at the scenes of a family.

    Attributes
    ----------
    family : str
        Key of `FAMILIES`.
    method : str
        What ours is held against: it shares no code with ours.
    accuracy : float
        The two references are no further apart than this at any timed scene, nor the judge of
        the stability table at any other where it reaches; in the unit of the quantity.
    """

    family: str
    method: str
    accuracy: float


def damping(values: Mapping[str, float]) -> tuple[float, float, float, float]:
    """Return the parameters of a chain (8): a, b = ηa², c, ε.

    Examples
    --------
    >>> damping({"a": 4.0, "eta": 0.03125, "c": 0.1, "eps": 0.01, "sites": 7.0})
    (4.0, 0.5, 0.1, 0.01)
    """
    a = values["a"]
    return a, values["eta"] * a * a, values["c"], values["eps"]


def _scene(name: str, *tags: Tag, timed: bool = False, **values: float) -> Scene:
    return Scene(name, values, tags, timed)


SCENES: tuple[Scene, ...] = (
    _scene("ordinary", "ordinary", v=0.3, c=0.5, timed=True),
    _scene("unit", "ordinary", v=1.0, c=1.0),
    _scene("fast", "ordinary", v=3.0, c=0.7),
    _scene("slow", "stiff", v=1e-2, c=0.5),
    _scene("small-v", "stiff", "extreme", v=1e-3, c=0.5, timed=True),
    _scene("large-c", "stiff", v=7.4, c=100.0, timed=True),
    _scene("larger-c", "stiff", "extreme", v=74.0, c=1e4),
    _scene("large-v-over-c", "extreme", v=1e3, c=1e-3),
    _scene("small-v-over-c", "stiff", "extreme", v=1e-3, c=1e3),
    _scene("weak-coupling", "extreme", v=0.3, c=1e-6),
    _scene("resonance", "stiff", v=72.46, c=100.0),
    _scene("pole-crossing-the-contour", "stiff", v=159.82338529816317, c=214.92354611211903),
    _scene("contour-touching-a-pole", "stiff", v=7.0562693897135915, c=10.802444936499525),
)

FAMILIES: Mapping[str, tuple[Scene, ...]] = {
    "sum": SCENES,
    "relation": (
        _scene("ordinary", "ordinary", c=0.5, eta=0.03125, timed=True),
        _scene("hysteresis", "ordinary", c=0.45, eta=0.03125, timed=True),
        _scene("pinned", "ordinary", c=0.2, eta=0.03125),
        _scene("retreat", "ordinary", c=2.0, eta=0.11),
        _scene("three-at-a-resonance", "stiff", c=100.0, eta=1e-4, timed=True),
        _scene("no-pinning-from-here", "stiff", c=1.0, eta=0.08),
        _scene("cycles-meet", "stiff", c=1.0, eta=0.125 * (1 - 1e-12)),
        _scene("cycles-gone", "extreme", c=1.0, eta=0.2),
        _scene("fastest", "extreme", c=1e8, eta=1e-12),
    ),
    "breather": (
        _scene("paper", "ordinary", a=2.5, eta=0.08, c=0.1, eps=0.01, sites=7, timed=True),
        _scene("paper-steep", "ordinary", a=4.0, eta=0.03125, c=0.1, eps=0.01, sites=7, timed=True),
        _scene("beside-the-fold", "stiff", a=2.5, eta=0.08, c=0.19, eps=0.01, sites=7, timed=True),
        _scene("weak", "extreme", a=1.0, eta=0.05, c=1e-8, eps=1e-6, sites=7),
        _scene("cycles-meet", "stiff", a=1.0, eta=0.125 * (1 - 1e-9), c=1e-6, eps=0.01, sites=7),
        _scene("not-averageable", "extreme", a=1.0, eta=0.01, c=0.1, eps=1.0, sites=7),
    ),
    "multipliers": (
        _scene("paper", "ordinary", a=2.5, eta=0.08, c=0.1, eps=0.01, sites=7, timed=True),
        _scene("long-chain", "stiff", a=4.0, eta=0.03125, c=0.1, eps=0.01, sites=31, timed=True),
        _scene("beside-the-fold", "stiff", a=2.5, eta=0.08, c=0.19, eps=0.01, sites=7, timed=True),
    ),
    "chain": (
        _scene(
            "ordinary", "ordinary", a=4.0, eta=0.03125, c=0.6, eps=0.01, sites=31, t=1000.0,
            timed=True,
        ),
        _scene(
            "strong-damping", "stiff", a=4.0, eta=0.03125, c=0.6, eps=1.0, sites=31, t=40.0,
            timed=True,
        ),
    ),
    "friction": (
        _scene("ordinary", "ordinary", c=0.02, sites=31, t=200.0, timed=True),
        _scene("many-events", "stiff", c=0.05, sites=31, t=400.0, timed=True),
    ),
    "front": (
        _scene("averaged", "ordinary", a=4.0, eta=0.03125, c=0.6, eps=0.0, timed=True),
        _scene("full", "ordinary", a=4.0, eta=0.03125, c=0.6, eps=0.01, timed=True),
        _scene("slow", "stiff", a=4.0, eta=0.03125, c=0.45, eps=0.0, timed=True),
    ),
    "map": (
        _scene("breather-to-front", "ordinary", eta=0.05, low=0.1, high=0.9, timed=True),
        _scene("steep", "stiff", eta=0.02, low=0.05, high=0.9, timed=True),
    ),
    "derivation": (
        _scene("first-order", "ordinary", order=1, a=2.5, eta=0.08, timed=True),
        _scene("second-order", "stiff", order=2, a=2.5, eta=0.08, eps=1e-3, timed=True),
    ),
}  # fmt: skip
"""Scenes by family; a point of a quantity takes those of its parameters that a scene names."""

REFERENCES: Mapping[str, Reference] = {
    "sum": Reference(
        "sum", "the series over the roots and the integral over k, 60 digits each", 1e-55
    ),
    "roots": Reference(
        "sum", "secants of mpmath at 40 digits; their number from the winding of L", 1e-35
    ),
    "profile": Reference("sum", "the printed series (49), summed root by root", 1e-9),
    "velocity": Reference(
        "relation", "secants of mpmath over the series and over the integral, 30 digits each", 1e-27
    ),
    "breather": Reference(
        "breather", "root of scipy over the flow of its DOP853, both at 1e-13", 1e-9
    ),
    "multipliers": Reference(
        "multipliers", "the variational equations (42) by scipy's DOP853 at 1e-13", 1e-10
    ),
    "chain": Reference("chain", "scipy's DOP853 at 1e-13, beside our Taylor series at 1e-14", 1e-9),
    "friction": Reference(
        "friction", "scipy's DOP853 with located events, at 1e-13, beside ours at 1e-13", 1e-9
    ),
    "front": Reference(
        "front", "arrivals by scipy's DOP853, and by ours on twice the length", 2e-6
    ),
    "map": Reference("map", "scipy's DOP853 on (8) until far beyond the decision", 1e-2),
    "derivation": Reference(
        "derivation", "direct sampling of the cell; a true periodic orbit at small ε", 1e-6
    ),
}
"""By quantity, as the benchmarks and ``fronts stress`` name them."""


def scenes_tagged(tag: Tag) -> tuple[Scene, ...]:
    """Return the scenes of Σ that carry a tag, in the table's order."""
    return tuple(scene for scene in SCENES if tag in scene.tags)


def scene_named(name: str, family: str = "sum") -> Scene:
    """Return the scene of that name; raise ``KeyError`` when there is none.

    Examples
    --------
    >>> scene_named("paper", "breather").c
    0.1
    """
    for scene in FAMILIES[family]:
        if scene.name == name:
            return scene
    raise KeyError(name)


def timed(quantity: str) -> tuple[Scene, ...]:
    """Return the scenes at which a quantity is measured by the benchmarks, easiest first.

    Examples
    --------
    >>> [scene.name for scene in timed("roots")]
    ['ordinary', 'small-v', 'large-c']
    """
    return tuple(scene for scene in FAMILIES[REFERENCES[quantity].family] if scene.timed)


def scenes_of(family: str) -> tuple[Mapping[str, float], ...]:
    """Return the parameters of the scenes of a family; none for a name that is not there.

    Examples
    --------
    >>> dict(scenes_of("relation")[0])
    {'c': 0.5, 'eta': 0.03125}
    """
    return tuple(scene.values for scene in FAMILIES.get(family, ()))
