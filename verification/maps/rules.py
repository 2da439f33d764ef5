"""The rules by which the state of a chain is determined: one entry for each kind of chain.

How to write rules for another kind of chain
--------------------------------------------
1. Write a function like ``find_smooth_state``, in a module whose docstring states the rules. Define
   a state by what *lasts*: a chain is not filled because each site was reached once, and a chain
   that appears quiet need not remain at rest.
2. ``fixed point`` must be certain: a norm or an energy that can only decrease from then on or,
   where none is known, a long decay. State which.
3. Stop at half of the end time: a state found later would not be found, and the point would be
   undecided, if the end time were halved.
4. Add an entry for the class of chains: ``RULES[MyChain] = StateRules(...)``. Classes derived from
   it use the rules of the nearest base class.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.chains.chain import Chain, SmoothChain
from theory.chains.friction import FrictionChain
from theory.chains.vdp import VanDerPolChain, VdpChain
from theory.parameters import ParameterError, Range, count_within
from verification.maps import friction_rules, smooth_rules, vdp_rules
from verification.maps.state import FoundState
from verification.runs.excite import add_noise

MAX_SITES = 1000
"""Longest chain of a map."""


def _noisy(start: FloatArray, size: float, seed: int) -> FloatArray:
    """Return the start with noise on every site, relative to its largest displacement."""
    return add_noise(start, size * float(np.abs(start).max()), seed)


@dataclass(frozen=True, kw_only=True)
class StateRules:
    """How, for one kind of chain, a start is made and the state is determined.

    Attributes
    ----------
    find : callable
        ``find(chain, start, end=..., tolerance=...)`` runs until the state is determined, or half
        of the end time is over.
    start : callable
        ``start(chain, sites, displacement=..., point=...)`` returns a start with some sites
        excited, by default those of the figure or the middle one.
    default_end : float
        Default end time, in the unit of `FoundState.time`.
    ends, tolerances : Range
        What is allowed for the end time and the local error of the runs.
    tolerance : float
        Default local error of the runs.
    seed : int
        Default seed of the noise on the second start.
    perturbed : callable
        ``perturbed(start, size, seed)`` returns the start with noise on every site.
    check_chain : callable
        Refuses a chain of this kind to which the rules do not apply, or that would take hours.
    """

    find: Callable[..., FoundState]
    start: Callable[..., FloatArray]
    default_end: float
    ends: Range
    tolerances: Range = smooth_rules.TOLERANCES
    tolerance: float = 1e-8
    seed: int = 5
    perturbed: Callable[[FloatArray, float, int], FloatArray] = _noisy
    check_chain: Callable[[Any], None] = lambda chain: None

    def check(self, chain: Chain) -> None:
        """Refuse a chain to which these rules do not apply, or that would take hours.

        Raises
        ------
        ParameterError
            The message states the reason.
        """
        count_within("number of sites n", getattr(chain, "sites", 0), 2, MAX_SITES)
        self.check_chain(chain)


_VAN_DER_POL = StateRules(
    find=vdp_rules.find_vdp_state,
    start=vdp_rules.start,
    default_end=2000.0,
    ends=Range(4.0 * vdp_rules.HOLD, 1e5),
    seed=15,
    check_chain=vdp_rules.check_chain,
)

RULES: dict[type, StateRules] = {
    FrictionChain: StateRules(
        find=friction_rules.find_friction_state,
        start=friction_rules.start,
        default_end=20_000.0,
        ends=friction_rules.ENDS,
        tolerances=friction_rules.TOLERANCES,
        perturbed=friction_rules.perturbed,
    ),
    SmoothChain: StateRules(
        find=smooth_rules.find_smooth_state,
        start=smooth_rules.start,
        default_end=2000.0,
        ends=Range(4.0 * smooth_rules.HOLD * smooth_rules.WINDOW, 1e6),
        check_chain=smooth_rules.check_chain,
    ),
    VanDerPolChain: _VAN_DER_POL,
    VdpChain: replace(_VAN_DER_POL, tolerance=1e-6),
}
"""Rules by class of chain."""


def rules_of(chain: Chain) -> StateRules:
    """Return the rules for a chain.

    Raises
    ------
    ParameterError
        If there are none, for example for a chain of infinite length.
    """
    for kind in type(chain).__mro__:
        if kind in RULES:
            return RULES[kind]
    raise ParameterError(
        "model", chain.model, "one whose states have rules", "take a chain of finite length"
    )
