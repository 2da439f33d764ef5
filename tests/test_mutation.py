"""The changes that the mutation script makes, and its list of explanations."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

from benchmarks.mutation.__main__ import chosen
from benchmarks.mutation.explained import Explained, matches, read_explained, stale_entries
from benchmarks.mutation.mutants import mutants_of
from benchmarks.mutation.outcome import write_record
from benchmarks.mutation.survey import closure
from benchmarks.mutation.survey import test_files as files_with_tests

ROOT = Path(__file__).parents[1]
SOURCE = '''
def f(x, scale=2.0):
    """Return 3 times nothing."""
    if x < 0:
        raise ValueError(f"{x + 1} is too small")
    y = [exp(-x), sinh(x)][0]
    return abs(y) * 1e-12 + sum(x for _ in range(5))
'''


def test_each_change_is_one_and_compiles() -> None:
    found = mutants_of("m.py", SOURCE)
    whole = ast.unparse(ast.parse(SOURCE))
    for mutant in found:
        compile(mutant.source, "m.py", "exec")
        ours, theirs = mutant.source.splitlines(), whole.splitlines()
        assert sum(a != b for a, b in zip(ours, theirs, strict=True)) == 1, mutant.name
    assert len({mutant.name for mutant in found}) == len(found)


def test_messages_and_loop_limits_are_left_alone() -> None:
    changes = {mutant.change for mutant in mutants_of("m.py", SOURCE)}
    sum_ = "abs(y) * 1e-12 + sum((x for _ in range(5)))"
    assert changes == {
        "default 2.0 -> 4.0",
        "x < 0 -> x >= 0",
        "x < 0 -> x <= 0",
        "0 -> 1",
        "exp(-x) -> exp(--x)",
        "-x -> x",
        "sinh(x) -> cosh(x)",
        "0 -> 1 #2",
        f"{sum_} -> {sum_.replace('+', '-')}",
        f"{sum_} -> abs(y) * 1e-12",
        f"{sum_} -> sum((x for _ in range(5)))",
        "1e-12 -> 1e-09",
        "abs(y) * 1e-12 -> abs(y) / 1e-12",
        "abs(y) -> y",
    }


JUDGEMENT = """
def judge(found, bound, strict=False, limit=1e-9):
    save(found)
    if found <= bound and strict:
        return Verdict(found, bound, error=found - bound, good=True)
    return 1 if found else 0
"""


def test_what_judges_is_loosened_dropped_swapped_and_misstated() -> None:
    """A boundary, a condition, a call, a term, an error, a flag, a branch, a default."""
    changes = [mutant.change for mutant in mutants_of("m.py", JUDGEMENT)]
    assert changes == [
        "default False -> True",
        "default 1e-09 -> 1e-06",
        "save(found) -> ...",
        "found <= bound and strict -> found <= bound or strict",
        "found <= bound and strict -> strict",
        "found <= bound and strict -> found <= bound",
        "found <= bound -> found > bound",
        "found <= bound -> found < bound",
        "Verdict(found, bound, error=found - bound, good=True) -> "
        "Verdict(bound, found, error=found - bound, good=True)",
        "found - bound -> found + bound",
        "found - bound -> found",
        "found - bound -> 0.01 * (found - bound)",
        "found - bound -> -(found - bound)",
        "True -> False",
        "1 if found else 0 -> 1",
        "1 if found else 0 -> 0",
        "1 -> 2",
        "0 -> 1",
    ]


def test_the_record_counts_what_was_run(tmp_path: Path) -> None:
    mutants = mutants_of("m.py", JUDGEMENT)[:9]
    found = {mutant.name: "killed" for mutant in mutants[:-1]}
    found[mutants[0].name] = found[mutants[1].name] = "survived"
    reasons = {mutants[0].name: "because", mutants[1].name: None}
    write_record(
        tmp_path / "m.json",
        ROOT,
        command="a command",
        mutants=mutants,
        found=found,
        reasons=reasons,
    )
    record = json.loads((tmp_path / "m.json").read_text(encoding="utf-8"))
    assert record["total"] == record["modules"]["m.py"]
    assert record["total"] == {
        "chosen": 9, "run": 8, "noticed": 6, "explained": 1, "open": 1, "not_run": 1,
    }  # fmt: skip
    assert record["open"] == [mutants[1].name]
    assert record["explained"] == {mutants[0].name: "because"}


def test_the_list_is_the_same_again() -> None:
    source = (ROOT / "theory" / "piecewise" / "dispersion.py").read_text(encoding="utf-8")
    first, second = (mutants_of("theory/piecewise/dispersion.py", source) for _ in range(2))
    assert [m.name for m in first] == [m.name for m in second]
    assert len(first) > 30


def test_every_explanation_is_about_a_change_that_can_be_made() -> None:
    explained = read_explained(ROOT / "benchmarks" / "mutation" / "explained.toml")
    names: dict[str, list[str]] = {}
    for form, why in explained.reasons.items():
        assert len(why) > 20, form
        module = form.split(":")[0]
        if module not in names:
            source = (ROOT / module).read_text(encoding="utf-8")
            names[module] = [mutant.name for mutant in mutants_of(module, source)]
        assert any(matches(form, name) for name in names[module]), form


def test_an_explanation_that_is_not_needed_is_named() -> None:
    mutants = mutants_of("m.py", SOURCE)
    found = {mutant.name: "killed" for mutant in mutants}
    explained = Explained({mutants[0].name: "because", "m.py:f:0 ...": "because"})
    assert stale_entries(explained, mutants, found) == list(explained.reasons)
    found[mutants[0].name] = "survived"
    assert stale_entries(explained, mutants, found) == ["m.py:f:0 ..."]


@pytest.mark.parametrize("file", ["tests/test_theory_sums.py", "theory/piecewise/limits.py"])
def test_tests_are_found_by_what_they_import(file: str) -> None:
    assert file in files_with_tests(ROOT)
    assert {"theory/piecewise/limits.py", "theory/cells/vdp.py"} <= closure(ROOT, file)
    assert not any(name.startswith("derivations") for name in closure(ROOT, file))


def test_a_package_is_changed_with_the_packages_inside_it() -> None:
    found = {mutant.module for mutant in chosen(ROOT, ["theory"], 0.02, 0, "")}
    assert {"theory/piecewise/limits.py", "theory/cells/vdp.py"} <= found
