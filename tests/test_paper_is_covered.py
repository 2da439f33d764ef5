"""The claims cover the paper's numbering, its printed numbers and its sections."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from paper_checks import claims
from paper_checks.discover import find_entries
from paper_checks.prose import COMMON, FIELDS, template

ENTRIES = find_entries()

EQUATIONS = range(1, 55)
FIGURES = range(2, 19)
"""Fig. 1 is a drawing of the model and states nothing."""

NUMBERS = (
    "40 %",
    "0.195",
    "0.1916",
    "0.2011",
    "t = 14000, 17000, 20000",
    "c = 0.4 %",
    "c = 2 %",
    "τ = 200, 400, 600",
    "τ = 400, 700, 1000",
    "N_dof = 31",
    "N_size = 1, 3, 5, 7, 9",
    "c from 0 to 0.1, v_d from 1 to 2",
    "μ_st = 1, μ_d = 0.5, v_0 = 0.5, ξ = 0.05, v_d = 1.25",
    "a = 2.5, b = 0.5, c = 0.1, ε = 0.01",
    "a = 4, b = 0.5, c = 0.6, ε = 0.01",
    "a = 4, b = 0.5, c = 0.5",
    "c = 0.3",
    "16 oscillators, displacement 6, ε = 0.01",
)
"""Numbers of the text: its results, and the parameters of its figures."""


def test_every_displayed_equation_has_one_claim() -> None:
    keys = [entry.claim.key for entry in ENTRIES if re.fullmatch(r"eq\d\d", entry.claim.key)]
    assert keys == [f"eq{number:02d}" for number in EQUATIONS]


@pytest.mark.parametrize("number", FIGURES)
def test_every_figure_has_a_claim_of_its_own_that_is_computed(number: int) -> None:
    group = f"fig{number:02d}"
    own = [entry for entry in ENTRIES if entry.group == group]
    assert own, f"no claim in paper_checks/claims/{group}.py"


@pytest.mark.parametrize("number", NUMBERS)
def test_every_printed_result_is_the_printed_value_of_a_claim(number: str) -> None:
    assert any(number in (entry.claim.printed or "") for entry in ENTRIES)


@pytest.mark.parametrize(
    "part", ["Abstract", "Introduction", "Section 1.1", "Section 1.2", "Section 1.3", "Section 2,",
             "Section 2.1.1", "Section 2.1.3", "Section 2.1.4", "Section 2.2", "Section 2.3.1",
             "Section 2.3.2", "Conclusions"],
)  # fmt: skip
def test_every_part_of_the_text_has_a_claim(part: str) -> None:
    assert any(entry.claim.place.startswith(part) for entry in ENTRIES)


def test_every_claim_quotes_the_paper_in_a_few_words() -> None:
    for entry in ENTRIES:
        words = entry.claim.quote.split()
        assert 2 <= len(words) <= 40, entry.claim.key
        assert all(repeat.quote and repeat.place for repeat in entry.claim.repeats)


def test_quotes_are_not_repeated() -> None:
    said = [(entry.claim.quote, entry.claim.statement) for entry in ENTRIES]
    assert len(set(said)) == len(said)


def test_a_sentence_that_repeats_a_claim_is_not_a_claim_of_its_own() -> None:
    own = {entry.claim.quote for entry in ENTRIES}
    assert not own & {one.quote for entry in ENTRIES for one in entry.claim.repeats}


def test_every_claim_has_its_text_with_all_fields() -> None:
    for entry in ENTRIES:
        text = template(entry.claim.rule.__module__, entry.claim.key)
        for name in FIELDS:
            assert f"{name}: " in text, (entry.claim.key, name)


def test_every_template_section_is_of_a_claim() -> None:
    for path in sorted(Path(claims.__path__[0]).glob("*.md")):
        module = f"{claims.__name__}.{path.stem}"
        keys = {entry.claim.key for entry in ENTRIES if entry.claim.rule.__module__ == module}
        found = set(re.findall(r"^# (\S+)$", path.read_text(), re.MULTILINE))
        assert found in (keys, {COMMON}, keys | {COMMON}), path.name
