"""The two methods of a claim share no solver, by the imports of their code."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import pytest

from paper_checks.claim import Method
from paper_checks.discover import find_entries
from tests.independence import solvers

CLAIMS = {entry.claim.key: entry.claim for entry in find_entries()}
TWO = [key for key, claim in CLAIMS.items() if len(claim.methods) == 2]


def shared_solvers(methods: Sequence[Method]) -> frozenset[str]:
    """Return the solvers that two methods have in common; empty for a single method."""
    if len(methods) < 2:
        return frozenset()
    first, second = (solvers(method) for method in methods)
    return first & second


@pytest.mark.parametrize("key", TWO)
def test_the_methods_of_a_claim_share_no_solver(key: str) -> None:
    assert shared_solvers(CLAIMS[key].methods) == frozenset()


def test_every_method_names_code_that_is_there() -> None:
    for claim in CLAIMS.values():
        assert len(claim.methods) in (1, 2), claim.key
        for method in claim.methods:
            module, _, name = method.code.partition(":")
            assert hasattr(importlib.import_module(module), name), (claim.key, method.code)


def test_every_method_has_a_solver_of_its_own() -> None:
    """Else two of them would share none by having none."""
    for key in TWO:
        for method in CLAIMS[key].methods:
            assert method.module in solvers(method), (key, method.code)


def test_a_shared_solver_is_noticed() -> None:
    pair = (
        Method("bisection", "verification.thresholds.spreading:spreading_threshold"),
        Method("a run", "verification.runs.simulate:simulate"),
    )
    assert "verification.steppers.friction" in shared_solvers(pair)
    assert shared_solvers(pair[:1]) == frozenset()


def test_most_claims_that_compute_have_two() -> None:
    computed = [key for key in CLAIMS if not key.startswith(("eq", "expect", "text"))]
    assert sum(key in TWO for key in computed) > 0.8 * len(computed)


def test_no_claim_is_about_a_chain_of_one_s_own() -> None:
    """So that the code for those is no part of its methods, though some of them import it."""
    folder = Path(find_spec("paper_checks.claims").origin).parent
    texts = [path.read_text(encoding="utf-8") for path in folder.glob("*.py")]
    assert len(texts) > 20
    assert not any("OscillatorChain" in text or "breathers.own" in text for text in texts)
