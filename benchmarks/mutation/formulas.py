"""A selection that is complete by formula: a sign, a factor or an index of each, or all three.

A formula is a simple statement that adds, subtracts, multiplies, divides or raises to a power, or
an equation in a list of them. Conditions, comparisons, functions, indices that stand alone and
the ranges of random points are left to the whole list.
"""

from __future__ import annotations

import random
from collections.abc import Iterable

from benchmarks.mutation.mutants import Mutant

KINDS = ("sign", "factor", "index")
"""An index is one of a subscript, or an exponent."""


def one_of_each_kind(mutants: Iterable[Mutant], seed: int) -> list[Mutant]:
    """Return for each formula a change of a sign, of a factor and of an index, where it has one.

    Which one is a matter of chance, the same for the same seed and text.

    Examples
    --------
    >>> from benchmarks.mutation.mutants import mutants_of
    >>> text = "def f(x): return x**2 / 3 - y"
    >>> for mutant in one_of_each_kind(mutants_of("m.py", text), 0):
    ...     print(mutant.kind, mutant.change)
    sign x ** 2 / 3 - y -> x ** 2 / 3 + y
    factor x ** 2 / 3 -> x ** 2 * 3
    index 2 -> 3
    """
    by_formula: dict[tuple[str, int], list[Mutant]] = {}
    for mutant in mutants:
        if mutant.formula:
            by_formula.setdefault((mutant.module, mutant.formula), []).append(mutant)
    picked: list[Mutant] = []
    for changes in by_formula.values():
        if not any(mutant.kind in ("sign", "factor") for mutant in changes):
            continue
        chance = random.Random(f"{seed}:" + "\n".join(mutant.name for mutant in changes))
        for kind in KINDS:
            possible = [mutant for mutant in changes if mutant.kind == kind]
            if possible:
                picked.append(chance.choice(possible))
    return picked


def one_of_each(mutants: Iterable[Mutant], seed: int) -> list[Mutant]:
    """Return for each formula one change: of a sign, of a factor or of an index."""
    by_formula: dict[tuple[str, int], list[Mutant]] = {}
    for mutant in one_of_each_kind(mutants, seed):
        by_formula.setdefault((mutant.module, mutant.formula), []).append(mutant)
    picked = []
    for changes in by_formula.values():
        names = "\n".join(mutant.name for mutant in changes)
        picked.append(random.Random(f"{seed}:{names}").choice(changes))
    return picked
