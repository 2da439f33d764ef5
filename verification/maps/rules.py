"""The rules by which the state of a chain is determined: their contract and their register.

How to write rules for another kind of chain
--------------------------------------------
1. Derive from `StateRules`, in a module of its own whose docstring states the rules. Define a
   state by what *lasts*: a chain is not filled because each site was reached once, and a chain
   that looks quiet need not be at rest for ever.
2. ``fixed point`` must be certain: a norm or an energy that can only decrease from then on or,
   where none is known, a long decay. State which.
3. Stop at half of the end time: a state found later would not be found, and the point would be
   undecided, if the end time were halved.
4. Register an instance for the class of chains: ``RULES[MyChain] = MyRules()``. Classes derived
   from it use the rules of the nearest base class.
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
"""Rules by class of chain."""


class StateRules(ABC):
    """How, for one kind of chain, a start is made and the state is determined.

    Attributes
    ----------
    default_end : float
        Default end time, in the unit of `FoundState.time`.
    shortest_end, longest_end : float
        Range allowed for the end time.
    tolerance : float
        Default local error of the runs.
    seed : int
        Default seed of the noise on the second start.
    """

    default_end: ClassVar[float]
    shortest_end: ClassVar[float]
    longest_end: ClassVar[float]
    tolerance: ClassVar[float] = 1e-8
    seed: ClassVar[int] = 5

    def check(self, chain: Chain) -> None:
        """Refuse a chain to which these rules do not apply, or that would take hours.

        Raises
        ------
        ParameterError
            The message states the reason.
        """
        count_within("number of sites n", getattr(chain, "sites", 0), 2, MAX_SITES)

    @abstractmethod
    def start(self, chain: Chain, sites: tuple[int, ...] | None, **options: Any) -> Any:
        """Return a start with some sites excited, by default those of the figure or the middle."""

    def perturbed(self, start: Any, size: float, seed: int) -> Any:
        """Return the start with noise on every site, relative to its largest displacement."""
        return add_noise(start, size * float(np.abs(start).max()), seed)

    @abstractmethod
    def find(self, chain: Chain, start: Any, *, end: float, tolerance: float) -> FoundState:
        """Run until the state is determined, or half of the end time is over."""


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
