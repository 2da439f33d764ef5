"""The changes that the mutation script makes, and its list of explanations."""

from __future__ import annotations

import ast
import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest
from numba.core.errors import NumbaError

from benchmarks.mutation import alternatives
from benchmarks.mutation.__main__ import chosen, main
from benchmarks.mutation.children import Answer, ChildTask, in_children
from benchmarks.mutation.entered import PACKAGES
from benchmarks.mutation.mutants import by_statement, mutants_of
from benchmarks.mutation.outcome import (
    EXPLAINED,
    KILLED,
    SURVIVED,
    UNREACHED,
    MutationOutcome,
    matches,
    read_explained,
    still_known,
)
from benchmarks.mutation.put import libraries_of
from benchmarks.mutation.session import dotted
from benchmarks.mutation.survey import Survey, closures
from benchmarks.mutation.survey import test_files as files_with_tests
from verification.execution.imports import closure

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
        with mutant.made() as tree:
            compile(tree, "m.py", "exec")
            ours, theirs = ast.unparse(tree).splitlines(), whole.splitlines()
        assert sum(a != b for a, b in zip(ours, theirs, strict=True)) == 1, mutant.name
    assert len({mutant.name for mutant in found}) == len(found)


def test_messages_and_loop_limits_are_left_alone() -> None:
    changes = {mutant.change for mutant in mutants_of("m.py", SOURCE)}
    sum_ = "abs(y) * 1e-12 + sum((x for _ in range(5)))"
    assert changes == {
        "default 2.0 -> 4.0",
        "x < 0 -> x >= 0",
        "x < 0 -> x <= 0",
        "0 -> 1 in if x < 0:",
        "exp(-x) -> exp(--x)",
        "-x -> x",
        "sinh(x) -> cosh(x)",
        "0 -> 1 in y = [exp(-x), sinh(x)][0]",
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
    found = dict.fromkeys((mutant.name for mutant in mutants[:-1]), KILLED)
    found[mutants[0].name] = found[mutants[1].name] = SURVIVED
    found[mutants[2].name] = UNREACHED
    outcome = MutationOutcome(mutants, found, {mutants[0].name: "because"})
    (tmp_path / "m.py").write_text(JUDGEMENT, encoding="utf-8")
    outcome.write(tmp_path / "m.json", tmp_path, {"part": 1.0}, [{"changes": 8}])
    record = json.loads((tmp_path / "m.json").read_text(encoding="utf-8"))
    assert record["counts"]["all"] == record["counts"]["m.py"]
    assert record["counts"]["all"] == {
        "chosen": 9, "run": 8, "noticed": 5, "explained": 1, "open": 2, "unreached": 1,
    }  # fmt: skip
    assert record["open"] == [mutants[1].name, mutants[2].name]
    assert record["unreached"] == [mutants[2].name]
    assert record["not_run"] == [mutants[-1].name]
    said = str(outcome).splitlines()[-2:]
    assert [line.split(" m.py")[0] for line in said] == ["NOT NOTICED", "NOT REACHED"]
    assert record["explained"] == {mutants[0].name: "because"}


def test_a_record_is_known_again_but_for_what_was_open_not_run_withdrawn_or_has_changed(
    tmp_path: Path,
) -> None:
    mutants = [m for name in ("m.py", "n.py") for m in mutants_of(name, JUDGEMENT)]
    found = dict.fromkeys((mutant.name for mutant in mutants), KILLED)
    found[mutants[0].name] = found[mutants[1].name] = SURVIVED
    path = tmp_path / "m.json"
    for name in ("m.py", "n.py"):
        (tmp_path / name).write_text(JUDGEMENT, encoding="utf-8")

    def known() -> dict[str, str]:
        outcome = MutationOutcome(mutants, found, {mutants[0].name: "because"})
        outcome.write(path, tmp_path, {"left_out": left_out}, [])
        (tmp_path / "m.py").write_text(now, encoding="utf-8")
        record = json.loads(path.read_text(encoding="utf-8"))
        return still_known(record, mutants, tmp_path, explained)

    now, left_out, explained = JUDGEMENT, list[str](), [mutants[0].name]
    assert known() == {name: found[name] for name in found if name != mutants[1].name}
    explained.clear()  # the explanation has been withdrawn
    assert set(found) - set(known()) == {mutants[0].name, mutants[1].name}
    explained.append(mutants[0].name)
    now = JUDGEMENT + "\n"
    others = [mutant.name for mutant in mutants if mutant.module == "n.py"]
    assert list(known()) == others
    (tmp_path / "m.py").write_text(JUDGEMENT, encoding="utf-8")
    now, left_out = JUDGEMENT, [others[0]]
    assert set(found) - set(known()) == {mutants[1].name, others[0]}
    now, left_out = JUDGEMENT, []
    del found[others[0]]  # it was not run
    assert set(known()) == set(found) - {mutants[1].name}


def test_the_list_is_the_same_again() -> None:
    source = (ROOT / "theory" / "piecewise" / "dispersion.py").read_text(encoding="utf-8")
    first, second = (mutants_of("theory/piecewise/dispersion.py", source) for _ in range(2))
    assert [m.name for m in first] == [m.name for m in second]
    assert len(first) > 30


def of_functions(source: str, wanted: set[str]) -> str:
    """Return a module without the functions, and most classes, in which none is wanted."""
    lines = source.splitlines()
    names = {name.split(".")[0] for name in wanted}
    for each in ast.parse(source).body:
        whole = isinstance(each, ast.FunctionDef) or (
            isinstance(each, ast.ClassDef) and "<module>" not in wanted
        )
        if whole and each.name not in names:
            begin = min(node.lineno for node in (each, *each.decorator_list))
            lines[begin - 1 : each.end_lineno] = [""] * (each.end_lineno - begin + 1)
    return "\n".join(lines)


def test_equal_changes_are_told_apart_by_their_statement() -> None:
    """An edit elsewhere in the function leaves the names; an edit of the statement changes them."""
    sums = " + ".join(f"exp({q} * x)" for q in ("alpha", "beta", "gamma", "delta", "epsilon"))
    lines = [
        "def f(x, y=(1, 2)):",
        "z = g(2, h(2))",
        f"z += {sums} + 2 * p(2, x) + 3 * x * y",
        "z *= 2",
    ]
    names = [
        "2 -> 3 in z = g(2, h(2))",
        "2 -> 3 in z = g(2, h(2)) #2",
        "2 -> 3 in 2 * p(2, x)",  # the sum is too long
        "2 -> 3 in 2 * p(2, x) #2",
        "2 -> 3 in z *= 2",
    ]

    def found(*lines: str) -> list[str]:
        return [
            m.change for m in mutants_of("m.py", "\n ".join(lines)) if " 2 -> 3" in f" {m.change}"
        ]

    assert found(*lines) == ["default 2 -> 3", *names]
    assert found(*lines[:1], "w = 2", *lines[2:]) == [
        "default 2 -> 3",
        "2 -> 3 in w = 2",
        *names[2:],
    ]
    assert found(lines[0], lines[3]) == ["default 2 -> 3", "2 -> 3"]


def test_every_explanation_is_about_a_change_that_can_be_made() -> None:
    forms: dict[str, list[str]] = {}
    for form, why in read_explained().items():
        assert len(why) > 20, form
        forms.setdefault(form.split(":")[0], []).append(form)
    for module, of_it in forms.items():
        source = (ROOT / module).read_text(encoding="utf-8")
        wanted = {form.split(":")[1] for form in of_it}
        names = [mutant.name for mutant in mutants_of(module, of_functions(source, wanted))]
        for form in of_it:
            assert any(matches(form, name) for name in names), form


def test_no_change_is_explained_twice() -> None:
    entries = [
        entry
        for path in EXPLAINED.rglob("*.toml")
        for entry in tomllib.loads(path.read_text(encoding="utf-8"))["explained"]
    ]
    forms = Counter(form for entry in entries for form in entry["changes"])
    assert [form for form, times in forms.items() if times > 1] == []
    assert forms.keys() == read_explained().keys()  # no file is overlooked


def test_an_explanation_that_is_not_needed_is_named() -> None:
    mutants = mutants_of("m.py", SOURCE)
    found = dict.fromkeys((mutant.name for mutant in mutants), KILLED)
    explained = {mutants[0].name: "because", "m.py:f:0 ...": "because", "other.py:f:0": "because"}
    assert MutationOutcome(mutants, found, explained).stale == list(explained)[:2]
    found[mutants[0].name] = SURVIVED
    assert MutationOutcome(mutants, found, explained).stale == ["m.py:f:0 ..."]


@pytest.mark.parametrize(
    "file", ["tests/test_theory_sums.py", "theory/piecewise/limits.py", "tests/test_checkpoint.py"]
)
def test_tests_are_found_by_what_they_import(file: str) -> None:
    assert file in files_with_tests(ROOT)
    found = closures(ROOT, [file, "tests/test_chains.py"])[file]
    packages = (*PACKAGES, "benchmarks", "tests")
    alone = {path.relative_to(ROOT).as_posix() for path in closure(dotted(file), packages).values()}
    assert found == alone
    assert not {each for each in found - {file} if each.startswith("tests/test_")}
    assert file in found
    assert len(found) > 5


def test_a_package_is_changed_with_the_packages_inside_it(tmp_path: Path) -> None:
    """But for what runs when it is imported."""
    files = ("theory/a.py", "theory/piecewise/b.py", "theory/piecewise/sums/c.py")
    for name in (*files, "theory/piecewise/__main__.py", "fronts/d.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(SOURCE, encoding="utf-8")
    assert {mutant.module for mutant in chosen(tmp_path, ["theory"], 1.0, 0)} == {*files}


def test_of_tests_that_take_no_time_those_of_few_functions_come_first() -> None:
    """Of a change that runs on import only a few files are asked."""
    survey = Survey()
    (mutant, *_) = mutants_of("m.py", SOURCE)
    for name, seconds, others in (("a", 0.0, 30), ("b", 0.02, 1), ("c", 0.0, 0), ("d", 0.0, 2)):
        entered = [mutant.function_at, *(f"m.py:{i}" for i in range(others))]
        survey.add([{"test": f"{name}.py::t", "seconds": seconds, "entered": entered}])
    found = survey.reaching(mutant, False, {}, {})
    assert [test[0] for test in found] == ["c", "d", "b", "a"]


def test_of_a_change_of_a_constant_the_tests_that_name_or_use_it_come_first() -> None:
    survey = Survey()
    source = "LIMIT = 2.0\ndef f(): return LIMIT\nclass C:\n  def g(self): return 1.0"
    (mutant, *_) = mutants_of("m.py", source)
    texts = {"a.py": "near m", "b.py": "m.LIMITS", "c.py": "m.LIMIT", "d.py": "n.LIMIT"}
    texts["e.py"] = "m.f"
    importing = {file: frozenset({"n.py" if file == "d.py" else "m.py"}) for file in texts}
    entered = {"b.py": ["m.py:C.g"], "c.py": ["m.py:C.g", "n.py:f"], "e.py": ["m.py:f"]}
    for file in texts:
        survey.add([{"test": f"{file}::t", "seconds": 0.1, "entered": entered.get(file, [])}])
    found = survey.reaching(mutant, True, importing, texts)
    assert [test[0] for test in found] == ["e", "c", "b", "a"]


def test_libraries_are_those_that_functions_import_too(tmp_path: Path) -> None:
    file = tmp_path / "m.py"
    text = (
        "import json, scipy.optimize\ndef f():\n    from mpmath import mp\n    import theory.cells"
    )
    file.write_text(text)
    assert libraries_of([file]) == ["mpmath", "scipy.optimize"]


def test_of_each_statement_one_change_is_chosen() -> None:
    path = "derivations/averaging/steps.py"
    whole = mutants_of(path, (ROOT / path).read_text(encoding="utf-8"))
    found = chosen(ROOT, [path], 1.0, 0, each=True)
    assert {mutant.name for mutant in found} < {mutant.name for mutant in whole}
    own = [[mutant.name for mutant in of_one] for of_one in by_statement(whole)]
    assert [sum(mutant.name in names for mutant in found) for names in own] == [1] * len(own)
    steps = [names for names in own if any(".derived('balance'," in name for name in names)]
    assert len(steps) == 1
    assert not any(".derived('balance in parts'" in name for name in steps[0])


CODE = """
from functools import lru_cache
from numba import cfunc, njit
RATE = 2.0
@njit("float64(float64)")
def grown(x):
    return RATE * x
@njit("float64(float64)")
def shifted(x):
    return grown(x) + 1.0
@njit
def idle(x):
    return x + 1.0
def pair():
    @njit
    def near(x):
        return 3.0 * x
    @njit("float64(float64)")
    def far(x):
        return near(x) - 2.0
    return far
PAIR = pair()
def twice(x):
    return 2.0 * x
POINTER = cfunc("float64(float64)")(twice)
LIMIT = 1e-7
def inside(x, most=1.0):
    return abs(x) <= most
def near(x):
    return abs(x) < LIMIT
@lru_cache
def third(x):
    return 3 * x
START = third(2)
SPARE = third(4)
LISTED = [each for each in (1.0,)]
def unseen(x):
    return x + 1
class Sum:
    parts = (1, 2)
    @property
    def value(self):
        return sum(part for part in self.parts)
"""
ITS_TESTS = """
import pytest
from numba.core.errors import NumbaError
from importlib import import_module
from pathlib import Path
from fronts import small
import_module("benchmarks").__path__.append(str(Path(__file__).parents[1] / "fronts"))
companion = import_module("benchmarks.companion")
KEPT = small.SPARE
def test_companion(): assert companion.small is small
def test_compiled(): assert small.shifted(3.0) == 7.0 and small.idle(5.0)
def test_pair(): assert small.PAIR(3.0) == 7.0
@pytest.fixture(scope="module")
def three(): return small.Sum().value
def test_sum(three): assert three == 3
def test_inside(): assert small.inside(1.0) and not small.inside(1.5) and not small.inside(-1.5)
def test_near(): assert small.near(9e-8) and not small.near(1e-7) and not small.near(-1)
def test_start(): assert small.START == 6
def test_twice(): assert small.POINTER.ctypes(3.0) == 6.0
def test_fails(): assert small.unseen(1) == 3
def test_long():
    while small.unseen(1): pass
"""


MORE = """
def test_unseen(): assert small.unseen(1) == 2
def test_spare(): assert KEPT == 12 and small.LISTED == [1.0]
"""
ONCE = """
def test_once():
    small.unseen(1)
    Path("once").touch(exist_ok=False)
"""
SIX_RUNS = f"""
import os, sys
from pathlib import Path
import hypothesis, numba.core.ccallback, pytest, scipy.optimize  # once for all runs
from benchmarks.mutation import __main__ as runner, session
runner.ROOT = Path.cwd()
def run(*words):
    sys.stdout.flush()
    child = os.fork()
    if not child:
        more = ["--tests", "tests/test_small.py", "--longest", "0.3", "--jobs", "1"]
        sys.exit(runner.main([*words, *more]))
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
session.compile_steppers = session.read_sources = lambda: None  # the project's own
codes = [run("fronts/small.py", "--record", "first.json")]
codes.append(run("fronts/small.py", "--compiled", "--record", "compiled.json"))
def add(tests):
    with Path("tests/test_small.py").open("a") as file:
        file.write(tests)
add({MORE!r})
codes.append(run("--again", "first.json", "--record", "second.json"))
codes += [run("fronts/small.py", "--unchanged", *more) for more in ([], ["--compiled"])]
add({ONCE!r})
codes.append(run("fronts/small.py", "--unchanged"))
sys.exit(codes != [1, 1, 0, 0, 0, 1] and f"exit codes {{codes}}")
"""


def test_changes_of_functions_constants_defaults_and_what_an_import_leaves_are_noticed(
    tmp_path: Path,
) -> None:
    """Those which no test that passes in its time enters, or that no test is about, are not.

    Nor is unchanged code, unless a test fails in the run itself.
    """
    for folder, name, text in (
        ("fronts", "__init__.py", ""),
        ("fronts", "small.py", CODE),
        ("fronts", "companion.py", "from fronts import small"),
        ("tests", "test_small.py", ITS_TESTS),
    ):
        (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / folder / name).write_text(text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", SIX_RUNS],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{tmp_path}:{ROOT}", "TMPDIR": str(tmp_path),
             "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True, text=True, check=False, timeout=240,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    # In the first run, and of compiled code, whose tests are followed for longer.
    assert "\n2 changes again, with tests for 6 s each\n" in done.stderr
    assert "\n4 changes again, with tests for 6 s each\n" in done.stderr
    record, compiled, again = (
        json.loads((tmp_path / name).read_text(encoding="utf-8"))
        for name in ("first.json", "compiled.json", "second.json")
    )
    assert [name.removeprefix("fronts/small.py:") for name in compiled["open"]] == [
        "idle:x + 1.0 -> x - 1.0",
        "idle:x + 1.0 -> x",
        "idle:x + 1.0 -> 1.0",
        "idle:1.0 -> 2.0",
    ]
    everything = {mutant.name for mutant in mutants_of("fronts/small.py", CODE)}
    left_out = [set(each["selection"]["left_out"]) for each in (record, compiled)]
    assert {name.split(":")[1] for name in left_out[0]} == {
        "grown", "shifted", "idle", "pair.near", "pair.far", "twice"
    }  # fmt: skip
    assert left_out[1] == everything - left_out[0]
    assert [name.removeprefix("fronts/small.py:") for name in record["open"]] == [
        "<module>:4 -> 5",
        "<module>:1.0 -> 2.0",
        "unseen:x + 1 -> x - 1",
        "unseen:x + 1 -> x",
        "unseen:x + 1 -> 1",
        "unseen:1 -> 2",
    ]
    assert record["counts"]["all"]["noticed"] == record["counts"]["all"]["run"] - 6
    assert (tmp_path / "fronts" / "small.py").read_text(encoding="utf-8") == CODE
    kept = next(tmp_path.glob("fronts-mutation-*.jsonl"))
    what = json.loads(kept.read_text(encoding="utf-8").splitlines()[0])
    # On import, by numba, and by tests: also by those that fail or take too long.
    functions = {"third", "twice", "Sum.value", "inside", "near", "unseen"}
    assert set(what["entered"]) >= {f"fronts/small.py:{name}" for name in functions}
    by_test = {each["test"].split("::")[1]: each["entered"] for each in what["answers"]}
    assert by_test["test_sum"] == ["fronts/small.py:Sum.value"]
    assert not {"test_fails", "test_long"} & by_test.keys()
    assert [each["changes"] for each in again["runs"]] == [record["counts"]["all"]["run"], 6]
    assert again["counts"]["all"] == {**record["counts"]["all"], "open": 0, "unreached": 0,
                                      "noticed": record["counts"]["all"]["run"]}  # fmt: skip


TWO_WITH_FILES = """
import os, time
from pathlib import Path
def wait_for(name):
    while not Path(name).exists(): time.sleep(0.01)
def test_first(tmp_path):
    (tmp_path / "file").touch()
    Path("first").touch()
    wait_for("second")
    assert (tmp_path / "file").exists()
def test_second(request):
    wait_for("first")
    assert request.getfixturevalue("tmp_path").exists()
    Path("second").touch()
"""
AT_ONCE = """
import os
from pathlib import Path
from benchmarks.mutation import session
session.compile_steppers = session.read_sources = lambda: None
made = session.Session(Path.cwd(), set())
def work():
    children = []
    for name in ("test_first", "test_second"):
        children.append(os.fork())
        if not children[-1]:
            os._exit(made.first_failing([f"test_small.py::{name}"], None, 20.0) is not None)
    assert [os.waitpid(child, 0)[1] for child in children] == [0, 0]
raise SystemExit(made.collect(["test_small.py"], work))
"""


def test_files_of_tests_that_run_at_once_are_not_removed(tmp_path: Path) -> None:
    (tmp_path / "test_small.py").write_text(TWO_WITH_FILES, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", AT_ONCE],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_child_that_crashes_or_does_not_end_answers_so() -> None:
    answers: list[list[Answer]] = []

    def crash(write: Callable[[Answer], None]) -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    def spin(write: Callable[[Answer], None]) -> None:
        write({"before": 1})
        while time.time():
            pass

    tasks = [ChildTask(run=run, seconds=0.0, take=answers.append) for run in (crash, spin)]
    in_children(iter(tasks), 1)
    assert answers == [[{"by": "time limit or crash"}], [{"before": 1}]]


def test_changes_that_are_neither_noticed_nor_explained_are_run_again() -> None:
    """Not those that no test reaches, or that were not run."""
    mutants = mutants_of("small.py", "def f(x): return x + 2 * x")[:5]
    states = (KILLED, SURVIVED, UNREACHED, SURVIVED)
    found = dict(zip([mutant.name for mutant in mutants], states, strict=False))
    explained = dict.fromkeys([mutants[3].name, "small.py:g:..."], "why")
    assert MutationOutcome(mutants, found, explained).unnoticed == [mutants[1]]


def test_a_change_that_numba_cannot_compile_does_not_stop_those_compiled_with_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Numba raises errors of its own, and others."""
    wrong, other, plain = mutants_of("small.py", "def f(x): return x + 1")[:3]
    errors = {wrong.name: ValueError, other.name: NumbaError}

    def version(of: str, code: object) -> None:
        if of in errors:
            raise errors[of]("no types")

    monkeypatch.setattr(alternatives, "_version", version)
    found = alternatives.Alternatives(
        [wrong, other, plain], lambda mutant: [(mutant.name, version.__code__)]
    )
    assert found.failed == {wrong.name: "ValueError", other.name: "NumbaError"}
    assert found.numbers == {}


def test_a_run_that_changes_nothing_makes_no_record(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["theory/piecewise/limits.py", "--list", "--unchanged", "--record", "none.json"])
    assert "nothing to --record" in capsys.readouterr().err
