"""Which of the two equations of Model II is meant, where a table has it as an entry."""

from __future__ import annotations

from enum import StrEnum

from theory.chains.vdp import AveragedChain, VanDerPolChain, VdpChain


class Model(StrEnum):
    """(8) or (43); a chain says it by its class, this says it in tables and at the command line."""

    FULL = "full"
    ENVELOPE = "envelope"

    def chain_of(self, chain: VanDerPolChain) -> VdpChain | AveragedChain:
        """Return the chain of this equation with the parameters of the one given.

        Examples
        --------
        >>> Model.ENVELOPE.chain_of(VdpChain(a=4, b=0.5, c=0.6)).model
        'averaged'
        """
        kind = VdpChain if self is Model.FULL else AveragedChain
        return kind(
            a=chain.a, b=chain.b, c=chain.c, eps=chain.eps, sites=chain.sites, ends=chain.ends
        )
