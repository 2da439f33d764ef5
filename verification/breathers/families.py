"""Which family of breathers solves a chain itself, by the class of the chain."""

from __future__ import annotations

from typing import Any

from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import need_instance
from verification.breathers.envelope import RotatingWaves
from verification.breathers.family import BreatherFamily
from verification.breathers.orbits import Orbits
from verification.breathers.own import OwnOrbits
from verification.breathers.result import BreatherMethod

FAMILIES: dict[type, type[BreatherFamily]] = {
    AveragedChain: RotatingWaves,
    VdpChain: Orbits,
    OscillatorChain: OwnOrbits,
}


def own_family(chain: Any, nucleus: Nucleus) -> BreatherFamily:
    """Return the breathers that solve a chain itself."""
    return _class_of(chain)(chain, nucleus)


def own_method(chain: Any) -> BreatherMethod:
    """Return the default method, which solves the chain itself."""
    return _class_of(chain).method


def _class_of(chain: Any) -> type[BreatherFamily]:
    remedy = "of an average take chain.full(); breathers of other models are not computed"
    need_instance("chain", chain, tuple(FAMILIES), remedy)
    return next(family for kind, family in FAMILIES.items() if isinstance(chain, kind))
