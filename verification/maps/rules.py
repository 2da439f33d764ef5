"""The rules by which the state of a chain is named: the contract, and the register by chain.

How to write rules for another kind of chain
--------------------------------------------
1. Derive from `StateRules`, in a module of its own whose docstring states the rules. Name a state
   by what *lasts*: a site that was reached once is not a filled chain, and a chain that looks quiet
   is not at rest for ever.
2. ``fixed point`` must be certain: a norm or an energy that can only fall from here on, or, where
   none is known, a long decay. Say which.
3. Give up at half of the end time: a state found later would be another one, namely none, if the
   end time were halved.
4. Register an instance for the class of chains: ``RULES[MyChain] = MyRules()``. Derived classes of
   chains take the rules of the nearest base.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

from theory.chains.chain import Chain
from theory.parameters import ParameterError, count_within
from verification.maps.state import FoundState
from verification.runs.excite import add_noise

MAX_SITES = 1000
"""Longest chain of a map."""
RULES: dict[type, StateRules] = {}
"""Rules by class of chains."""


class StateRules(ABC):
    """How a start is made and a state is named, for one kind of chain.

    Attributes
    ----------
    default_end : float
        End time if none is given, in the unit of `FoundState.time`.
    shortest_end, longest_end : float
        Range of end times.
    tolerance : float
        Local error of the runs if none is given.
    seed : int
        Of the noise on the second start.
    """

    default_end: ClassVar[float]
    shortest_end: ClassVar[float]
    longest_end: ClassVar[float]
    tolerance: ClassVar[float] = 1e-8
    seed: ClassVar[int] = 5

    def check(self, chain: Chain) -> None:
        """Refuse a chain that these rules are not for, or that would take hours.

        Raises
        ------
        ParameterError
            With the reason.
        """
        count_within("number of sites n", getattr(chain, "sites", 0), 2, MAX_SITES)

    @abstractmethod
    def start(self, chain: Chain, sites: tuple[int, ...] | None, **options: Any) -> Any:
        """Return a state with some sites excited, by default those of the figure or the middle."""

    def perturbed(self, start: Any, size: float, seed: int) -> Any:
        """Return the start with noise on every site, relative to its largest displacement."""
        return add_noise(start, size * float(np.abs(start).max()), seed)

    @abstractmethod
    def find(self, chain: Chain, start: Any, *, end: float, tolerance: float) -> FoundState:
        """Run until the state has a name, or half of the end time is over."""


def rules_of(chain: Chain) -> StateRules:
    """Return the rules for a chain.

    Raises
    ------
    ParameterError
        If there are none, as for a chain of infinite length.
    """
    for kind in type(chain).__mro__:
        if kind in RULES:
            return RULES[kind]
    raise ParameterError(
        "model", chain.model, "one whose states have rules", "take a chain of finite length"
    )
