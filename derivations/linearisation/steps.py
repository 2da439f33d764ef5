"""The Jacobian of the chain from Eq. (8): for the ring of the paper and for free ends."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.expansion import Linearise
from derivations.algebra.lattice import CloseChain, LatticeEnds, ReadMatrix, WriteFirstOrder
from derivations.algebra.oscillation import CollectHarmonic
from derivations.algebra.steps import Derivation, Draft
from derivations.algebra.substitution import Substitute
from derivations.chain import PAPER, ChainModel
from derivations.linearisation import checks
from derivations.linearisation.symbols import (
    SITES,
    A,
    D,
    J,
    X,
    X_rate,
    components,
    delta_rate,
    deviation,
    motion,
    perturbations,
    resonant,
)
from derivations.multiple_scales.steps import derive as derive_scales
from derivations.symbols import i, n, t, y

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


def derive(chain: ChainModel = PAPER, sites: int | None = None) -> Derivation:
    """Derive Eqs. (39)-(42) for a chain of ``sites`` sites, as a ring and with free ends.

    Parameters
    ----------
    chain : ChainModel
        The chain; that of Eq. (8) by default.
    sites : int or None
        N, at least twice the reach of the springs plus one, so that on a ring no site is coupled to
        the same neighbour twice; by default the smallest ring whose corners are separate from the
        band.

    Raises
    ------
    DerivationInputError
        If the chain is too short.
    """
    least = 2 * chain.reach + 1
    count = max(SITES, least + 1) if sites is None else sites
    if count < least:
        raise DerivationInputError("number of sites N", count, f"at least {least}",
                                   "use a longer chain")
    draft = Draft(derive_scales(chain))
    own, change = components(count), perturbations(count)
    places = [y(site, t) for site in range(1, count + 1)]
    vector = sp.ImmutableMatrix([*places, *(place.diff(t) for place in places)])
    draft.definition("state", equation(X, vector), "displacements, then velocities",
                     check=checks.state, number=39)
    for ends in (LatticeEnds.RING, LatticeEnds.FREE):
        suffix, numbered = ("", True) if ends is LatticeEnds.RING else (" with free ends", False)
        draft.derived(f"closed chain{suffix}", CloseChain(y, n, t, count, ends), "chain",
                      check=checks.closed(chain, ends))
        draft.derived(f"first-order system{suffix}", WriteFirstOrder(X_rate, own, t),
                      f"closed chain{suffix}", "state", check=checks.field(chain, ends),
                      number=40 if numbered else None)
        draft.derived(f"linearised system{suffix}",
                      Linearise(dict(zip(own, change, strict=True)), delta_rate),
                      f"first-order system{suffix}", check=checks.linear(chain, ends),
                      number=41 if numbered else None,
                      note="the terms omitted are of second order in the perturbation")
        draft.derived(f"Jacobian{suffix}", ReadMatrix(change, J), f"linearised system{suffix}",
                      check=checks.jacobian(chain, ends),
                      number=42 if numbered else None)
    _extra_term(draft)
    return draft.finished("linearisation", "Linearisation and the Jacobian (39)-(42)")


def _extra_term(draft: Draft) -> None:
    """Derive the resonant part of ``-y' delta``, which the '1' in print adds."""
    wave = sp.exp(i * t)
    draft.definition("term added by print", equation(resonant, -motion.diff(t) * deviation),
                     "contribution of the '1' in the bracket of the printed (42), over ε",
                     check=checks.added)
    draft.ansatz("oscillation and deviation",
                 sp.Tuple(*(equation(own, size * wave + sp.conjugate(size) / wave)
                            for own, size in ((motion, A), (deviation, D)))),
                 "an oscillation at frequency one, and a deviation at the same frequency",
                 check=checks.waves)
    draft.derived("resonant part of the added term", (Substitute(), CollectHarmonic(t, resonant)),
                  "term added by print", "oscillation and deviation", check=checks.mean,
                  note="it vanishes, so the printed equation is in error at O(ε^2) only")
