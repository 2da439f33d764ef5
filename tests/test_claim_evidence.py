"""What claims compute: at smaller sizes all of it runs, and finds what was recorded.

Whether the two methods of a claim agree is judged at the published sizes, by ``make paper``; here a
change of the code that leads to its evidence, to what the text says of it and to the data of the
pictures shows in a second. Who changes it on purpose records it anew (`tests.behaviour.evidence`).
"""

from __future__ import annotations

import json
import re
from copy import deepcopy

import pytest

from paper_checks import shipped
from paper_checks.claims.fig09 import Escape
from paper_checks.claims.fig14 import Collapse
from paper_checks.discover import find_entries
from paper_checks.prose import words
from tests.behaviour.evidence import (
    SMALLER,
    apart,
    claims_by_evidence,
    computed,
    shipped_roots,
    stored,
)
from tests.behaviour.replay import EVIDENCE

RECORDED = json.loads(EVIDENCE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("root", SMALLER)
def test_evidence_at_a_smaller_size_is_as_recorded(root: str) -> None:
    assert not list(apart(RECORDED[root], computed(root)))


@pytest.mark.parametrize("root", shipped_roots())
def test_shipped_evidence_says_what_was_recorded(root: str) -> None:
    found = stored(root)
    for claim in claims_by_evidence()[root]:
        assert found["said"][claim.key][0] == claim.recorded
    assert not list(apart(RECORDED[f"{root} as shipped"], found))


@pytest.mark.parametrize("root", [root for root, found in RECORDED.items() if "compared" in found])
def test_a_claim_says_on_how_many_sites_and_for_how_long_two_methods_are_compared(
    root: str,
) -> None:
    compared = RECORDED[root]["compared"]
    for claim in claims_by_evidence()[root]:
        lines = (line for name, line in words(claim.rule.__module__, claim.key) if name == "by")
        form = r"with located events on (\d+) sites(?: to τ = (\d+))?"
        ((sites, end),) = re.findall(form, "\n".join(lines))
        assert int(sites) in {each[1] for each in compared}
        assert not end or {float(end)} == {each[-1] for each in compared}


def test_all_evidence_is_computed_here_or_shipped() -> None:
    assert {*SMALLER, *shipped_roots()} == set(claims_by_evidence())


def test_evidence_is_shipped_of_the_claims_that_take_long_and_of_no_others() -> None:
    long = {entry.claim.evidence for entry in find_entries() if entry.claim.expensive}
    folder = shipped.Shipped(shipped.FOLDER, ())
    assert {folder.path(each) for each in long} == set(shipped.FOLDER.glob("*.json"))
    for claims in claims_by_evidence().values():  # which takes as long for all of them
        assert len({claim.expensive for claim in claims}) == 1


def test_of_several_distances_the_largest_is_told() -> None:
    for pairs in (((0.9, 0.95), (1.1, 1.0)), ((1.1, 1.0), (0.9, 0.95)), ((1.0, 1.1), (1.0, 1.0))):
        assert Escape(inside=pairs[0], outside=pairs[1]).gap == pytest.approx(0.1)
    rows = {1.0: (1.0, 2.0), 2.5: (1.0, 2.2), 4.0: (1.0, 2.1)}
    found = Collapse(full=rows, averaged=(), scipy=rows)
    assert (found.apart, found.scipy_apart) == pytest.approx((0.2 / 2.1, 0.2 / 2.1))


def test_numbers_that_are_apart_are_named() -> None:
    here = {"v": [1.0, "2.5", None], "gap": 3e-10, "state": "front", "x": "at c = 0.512"}
    assert not list(apart(here, {**here, "gap": 4e-10}))
    for name, other in (("v", [1.0, "2.6", None]), ("v", [1.0, "2.5"]), ("gap", 3e-7),
                        ("state", "rest"), ("v", [1.0, "2.5", 0.0]),
                        ("x", "at c = 0.514")):  # fmt: skip
        assert list(apart(here, deepcopy(here) | {name: other})), name
