"""What is printed ambiguously is, term by term, what is derived: only its meaning is open.

A reading is judged by a part of such an equation or expected to fail, so its check need not notice
a slip in the transcription.
"""

import random

import pytest
import sympy as sp

from derivations import catalogue
from derivations import judgement as printed
from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import value


@pytest.mark.parametrize("number", [35, 36, 37, 40, 53])
def test_each_part_of_the_print_is_the_derived_one(number):
    derived = catalogue.load(catalogue.owner(number)).numbered(number).result
    given = printed.printed(number).expression
    pairs = list(zip(parts_of(given), parts_of(derived), strict=True))
    for ours, theirs in pairs:
        for one, other in zip(ours.args, theirs.args, strict=True):
            if one == other:
                continue
            if one.is_Matrix:
                assert (one - other).expand().is_zero_matrix
                continue
            names = sorted(one.free_symbols | other.free_symbols, key=str)
            for seed in range(3):
                rng = random.Random(seed)
                point = {name: rng.uniform(0.5, 1.5) for name in names}
                assert abs(value(one - other, point)) < 1e-12, (number, one, other)


def test_the_phase_step_of_37_is_minus_a_quarter_turn():
    last = printed.printed(37).expression.args[1]
    assert sp.sin(last.rhs) == -1
    assert sp.cos(last.rhs) == 0
