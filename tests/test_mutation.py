"""The changes that the mutation script makes, and its list of explanations."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

from benchmarks.mutation.__main__ import chosen
from benchmarks.mutation.explained import Explained, matches, read_explained, stale_entries
from benchmarks.mutation.formulas import one_of_each, one_of_each_kind
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


def test_messages_defaults_tolerances_and_loop_limits_are_left_alone() -> None:
    changes = {mutant.change for mutant in mutants_of("m.py", SOURCE)}
    assert changes == {
        "x < 0 -> x >= 0",
        "0 -> 1",
        "exp(-x) -> exp(--x)",
        "-x -> x",
        "sinh(x) -> cosh(x)",
        "0 -> 1 #2",
        "abs(y) * 1e-12 + sum((x for _ in range(5))) -> "
        "abs(y) * 1e-12 - sum((x for _ in range(5)))",
        "abs(y) * 1e-12 -> abs(y) / 1e-12",
        "abs(y) -> y",
    }


FORMULAS = """
rows = [equation(x, -3), equation(y[2], x**2 + a * b)]
def f(x, y):
    if x > y + 1:
        return x[0]
    total = 2 * x[1] - y**3
    total -= np.exp(x / 4)
    y = rng.uniform(-1 + x, 2 * x)
    return max(x, y)
"""


def test_of_each_formula_one_sign_one_factor_one_index() -> None:
    # By hand: -3; y[2], +, *, 2; then 2 * x[1] - y**3; then -= or exp(-), /, 4. The condition, the
    # bare index, the random range and the bare function are no formulas.
    chosen = one_of_each_kind(mutants_of("m.py", FORMULAS), 0)
    kinds: dict[int, list[str]] = {}
    for mutant in chosen:
        kinds.setdefault(mutant.formula, []).append(mutant.kind)
    three = ["sign", "factor", "index"]
    assert sorted(kinds.values()) == sorted([["sign"], three, three, ["sign", "factor"]])
    assert [m.name for m in chosen] == [
        m.name for m in one_of_each_kind(mutants_of("m.py", FORMULAS), 0)
    ]
    seeds = {
        tuple(m.name for m in one_of_each_kind(mutants_of("m.py", FORMULAS), seed))
        for seed in range(8)
    }
    assert len(seeds) > 1


def test_functions_that_state_an_equation_are_known() -> None:
    source = '''
def named(x):
    """Return L(k) of (50)."""
    return 2 * x
def written(x):
    """Return v = c + s of the front."""
    def inner(y):
        return y + x
    return inner
def plain(x):
    """Return the points.

    Examples
    --------
    >>> y = plain(3)
    """
    return 3 * x
'''
    stated = {m.function for m in mutants_of("m.py", source) if m.stated}
    assert stated == {"named", "written.inner"}


def test_of_each_formula_one_change() -> None:
    of_each_kind = one_of_each_kind(mutants_of("m.py", FORMULAS), 0)
    chosen = one_of_each(mutants_of("m.py", FORMULAS), 0)
    assert [m.formula for m in chosen] == list(dict.fromkeys(m.formula for m in of_each_kind))
    assert {m.name for m in chosen} < {m.name for m in of_each_kind}


def test_the_record_counts_what_was_run(tmp_path: Path) -> None:
    mutants = one_of_each_kind(mutants_of("m.py", FORMULAS), 0)
    found = {mutant.name: "killed" for mutant in mutants[:-1]}
    found[mutants[0].name] = found[mutants[1].name] = "survived"
    reasons = {mutants[0].name: "because", mutants[1].name: None}
    write_record(tmp_path / "m.json", ROOT, "a command", mutants, found, reasons)
    record = json.loads((tmp_path / "m.json").read_text(encoding="utf-8"))
    assert record["formulas"] == 4
    assert record["kinds"] == {"sign": 4, "factor": 3, "index": 2}
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
