"""One table of named scenes, shared by tests, benchmarks, the stability table and the report.

`SCENES` are velocities and couplings at which Σ(v, c) of Eq. (53) is to be computed; `FAMILIES`
holds these and the scenes of other quantities by name of parameter.
``ordinary`` scenes are where a paper's curve lies; ``stiff`` ones narrow the strip of
analyticity or crowd the roots; ``extreme`` ones are where a formula written carelessly
overflows, underflows or loses a root.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Tag = Literal["ordinary", "stiff", "extreme"]


@dataclass(frozen=True)
class Scene:
    """A named point of the (v, c) plane.

    Attributes
    ----------
    name : str
        What is peculiar to it, usable as a test identifier.
    v, c : float
        Scaled front velocity and coupling, dimensionless, positive.
    tags : tuple of str
        Any of ``"ordinary"``, ``"stiff"``, ``"extreme"``.
    """

    name: str
    v: float
    c: float
    tags: tuple[Tag, ...]


SCENES: tuple[Scene, ...] = (
    Scene("ordinary", 0.3, 0.5, ("ordinary",)),
    Scene("unit", 1.0, 1.0, ("ordinary",)),
    Scene("fast", 3.0, 0.7, ("ordinary",)),
    Scene("slow", 1e-2, 0.5, ("stiff",)),
    Scene("small-v", 1e-3, 0.5, ("stiff", "extreme")),
    Scene("large-c", 7.4, 100.0, ("stiff",)),
    Scene("larger-c", 74.0, 1e4, ("stiff", "extreme")),
    Scene("large-v-over-c", 1e3, 1e-3, ("extreme",)),
    Scene("small-v-over-c", 1e-3, 1e3, ("stiff", "extreme")),
    Scene("weak-coupling", 0.3, 1e-6, ("extreme",)),
    Scene("resonance", 72.46, 100.0, ("stiff",)),
    Scene("pole-crossing-the-contour", 159.82338529816317, 214.92354611211903, ("stiff",)),
    Scene("contour-touching-a-pole", 7.0562693897135915, 10.802444936499525, ("stiff",)),
)


def scenes_tagged(tag: Tag) -> tuple[Scene, ...]:
    """Return the scenes that carry a tag, in the table's order."""
    return tuple(scene for scene in SCENES if tag in scene.tags)


def scene_named(name: str) -> Scene:
    """Return the scene of that name; raise ``KeyError`` when there is none."""
    for scene in SCENES:
        if scene.name == name:
            return scene
    raise KeyError(name)


@dataclass(frozen=True)
class NamedScene:
    """A named point of any parameters.

    Attributes
    ----------
    name : str
        What is peculiar to it.
    values : mapping of str to float
        Parameters by symbol, dimensionless.
    tags : tuple of str
        Any of ``"ordinary"``, ``"stiff"``, ``"extreme"``.
    """

    name: str
    values: Mapping[str, float]
    tags: tuple[Tag, ...]


def _named(name: str, *tags: Tag, **values: float) -> NamedScene:
    return NamedScene(name, values, tags)


FAMILIES: Mapping[str, tuple[NamedScene, ...]] = {
    "sum": tuple(_named(s.name, *s.tags, v=s.v, c=s.c) for s in SCENES),
    "relation": (
        _named("ordinary", "ordinary", c=0.5, eta=0.03125),
        _named("hysteresis", "ordinary", c=0.45, eta=0.03125),
        _named("pinned", "ordinary", c=0.2, eta=0.03125),
        _named("retreat", "ordinary", c=2.0, eta=0.11),
        _named("three-at-a-resonance", "stiff", c=100.0, eta=1e-4),
        _named("no-pinning-from-here", "stiff", c=1.0, eta=0.08),
        _named("cycles-meet", "stiff", c=1.0, eta=0.125 * (1 - 1e-12)),
        _named("cycles-gone", "extreme", c=1.0, eta=0.2),
        _named("fastest", "extreme", c=1e8, eta=1e-12),
    ),
    "breather": (
        _named("paper", "ordinary", a=2.5, eta=0.08, c=0.1, eps=0.01),
        _named("paper-steep", "ordinary", a=4.0, eta=0.03125, c=0.1, eps=0.01),
        _named("beside-the-fold", "stiff", a=2.5, eta=0.08, c=0.19, eps=0.01),
        _named("weak", "extreme", a=1.0, eta=0.05, c=1e-8, eps=1e-6),
        _named("cycles-meet", "stiff", a=1.0, eta=0.125 * (1 - 1e-9), c=1e-6, eps=0.01),
        _named("not-averageable", "extreme", a=1.0, eta=0.01, c=0.1, eps=1.0),
    ),
}
"""Scenes by family; a point of a quantity takes those of its parameters that a scene names."""


def scenes_of(family: str) -> tuple[Mapping[str, float], ...]:
    """Return the parameters of the scenes of a family; none for a name that is not there.

    Examples
    --------
    >>> dict(scenes_of("relation")[0])
    {'c': 0.5, 'eta': 0.03125}
    """
    return tuple(scene.values for scene in FAMILIES.get(family, ()))
