"""The chains and cells that a point of the stability table describes."""

from __future__ import annotations

from collections.abc import Mapping

from theory.cells.friction import FrictionCell
from theory.chains.friction import FrictionChain
from theory.chains.vdp import VdpChain
from verification.quantities.quantity import whole


def vdp_chain(at: Mapping[str, float]) -> VdpChain:
    """Return the chain of (8) with b = η a²."""
    return VdpChain(
        a=at["a"], b=at["eta"] * at["a"] ** 2, c=at["c"], eps=at["eps"], sites=whole(at["sites"])
    )


def friction_cell(at: Mapping[str, float]) -> FrictionCell:
    """Return one cell of (5), with μ_d = 1/2."""
    return FrictionCell(v_d=at["v_d"], mu_st=at["mu_st"], mu_d=0.5, v0=at["v0"], xi=at["xi"])


def friction_chain(at: Mapping[str, float]) -> FrictionChain:
    """Return the chain (5)."""
    return FrictionChain.of(friction_cell(at), c=at["c"], sites=whole(at["sites"]))
