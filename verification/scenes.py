"""One table of named scenes (v, c) for the sum Σ, shared by tests, benchmarks and the report.

A scene is a front velocity and a coupling at which Σ(v, c) of Eq. (53) is to be computed.
``ordinary`` scenes are where a paper's curve lies; ``stiff`` ones narrow the strip of
analyticity or crowd the roots; ``extreme`` ones are where a formula written carelessly
overflows, underflows or loses a root.
"""

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
