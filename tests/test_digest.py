"""A stored measurement is stale when the code it is of has changed, and only then."""

import ast
import sys
from pathlib import Path

import numpy as np
import pytest

from verification.execution.digest import (
    DRAWING,
    digest_of_arrays,
)
from verification.execution.imports import closure, imports_of, shape
from verification.execution.metadata import CHANGED, UNKNOWN, Code, staleness

OURS = ("timed_code",)


@pytest.fixture
def package(tmp_path, monkeypatch):
    home = tmp_path / "timed_code"
    home.mkdir()
    (home / "__init__.py").write_text("")
    (home / "deep.py").write_text('"""What."""\n\n\ndef f(x):\n    """Say."""\n    return x + 1\n')
    (home / "top.py").write_text(
        "from timed_code import later\n\n\n"
        "def g(x):\n    from timed_code.deep import f\n    return f(x)\n"
    )
    (home / "other.py").write_text("N = 1\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield home
    for name in [name for name in sys.modules if name.startswith("timed_code")]:
        del sys.modules[name]


@pytest.mark.parametrize(
    ("file", "text", "stale"),
    [
        ("deep.py", "def f(x):\n    # a remark\n    return (\n        x + 1\n    )\n", False),
        ("deep.py", "def f(x):  # a remark\n\n    'Other words.'\n    return x + 1\n", False),
        ("deep.py", "def f(x):\n    return x + 2\n", True),
        ("deep.py", "def f(x):\n    if x:\n        pass\n    return x + 1\n", True),
        ("deep.py", "def f(x: int) -> int:\n    return x + 1\n", True),
        ("deep.py", "def f(x):\n    return x + 1\n\n\ndef unused():\n    return 2\n", True),
        ("deep.py", "def f(x):\n    return x + 1\n\n\nprint('imported')\n", True),
        ("deep.py", "def f(x):\n    return x + N\n\n\nN = 1\n", True),
        ("__init__.py", "print('imported')\n", True),
        ("other.py", "N = 2\n", False),
        ("top.py", "def g(x):\n    return x\n", True),
        ("later.py", "N = 1\n", True),  # what was imported may have been a name, and is a module
    ],
)
def test_what_makes_a_record_stale(package, file, text, stale):
    code = Code.of(["timed_code.top"], OURS)
    assert staleness(code, OURS) == ""
    (package / file).write_text(text)
    assert staleness(code, OURS) == (CHANGED if stale else "")


def test_a_record_of_a_module_that_is_gone_is_stale(package):
    code = Code.of(["timed_code.other"], OURS)
    (package / "other.py").unlink()
    assert staleness(code, OURS) == CHANGED
    with pytest.raises(ValueError, match=r"no module timed_code\.other"):
        Code.of(["timed_code.other"], OURS)


def test_a_record_that_names_no_code_is_stale():
    assert staleness(None) == staleness({}) == UNKNOWN


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("x = f'{1 + 1:d} # not a remark'", "x = f'{1 + 2:d} # not a remark'", False),
        ("x = 'a'", "x = 'b'", False),
        ("x = 1", "x = 1.0", False),
        ("if a:\n    b\n    c", "if a:\n    b\nc", False),
        ("f(a, b)", "f(a, *b)", False),
        ("x = f(\n    a,  # one\n    b,\n)", "x = f(a, b)", True),
        ("class A:\n    'Say.'\n    n = 1\n    'Of n.'", "class A:\n    n = (1)", True),
    ],
)
def test_the_shape_of_code_keeps_what_it_does_and_nothing_else(one, other, alike):
    assert (shape(ast.parse(one)) == shape(ast.parse(other))) is alike


def test_an_import_counts_wherever_it_stands_but_for_types(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("""
try:
    import p.a
except ImportError:
    import p.b
else:
    from . import c
finally:
    from ..q import d
for _ in ():
    match 1:
        case 1:
            with open(""):
                import p.e
if TYPE_CHECKING:
    import p.f
else:
    lambda: None
    import p.g
""")
    names, computed = imports_of(path, "r.s")
    assert set(names) == {"p.a", "p.b", "r.s", "r.s.c", "r.q", "r.q.d", "p.e", "p.g"}
    assert not computed


def test_a_benchmark_does_not_depend_on_the_others_nor_on_what_draws():
    held = closure("benchmarks.roots", without=DRAWING)
    needed = {"benchmarks.work_precision", "theory.piecewise.roots"}
    needed.add("verification.quantities.problems")
    assert needed <= set(held)
    assert not {"benchmarks.velocity", "benchmarks.chain", "verification.runs.simulate"} & set(held)
    assert not {"benchmarks.diagram", "paper_checks.pictures"} & set(held)


def test_every_bit_of_an_array_counts_and_so_do_type_shape_and_name():
    arrays = [
        {"a": np.zeros(4)}, {"a": np.zeros((2, 2))}, {"a": np.zeros(4, dtype=np.int64)},
        {"b": np.zeros(4)}, {"a": np.array([0, 0, 0, 5e-324])}, {"a": np.zeros(0)}, {},
    ]  # fmt: skip
    assert len({digest_of_arrays(each) for each in arrays}) == len(arrays)
    square = np.arange(9.0).reshape(3, 3)
    assert digest_of_arrays({"a": square.T}) == digest_of_arrays({"a": square.T.copy()})


def test_no_installed_package_imports_one_that_is_not():
    """Benchmarks are in the source tree only; ``fronts bench`` asks for that tree first."""
    packages = ("theory", "derivations", "verification", "paper_checks", "fronts", "benchmarks")
    root = Path(__file__).parent.parent
    installed = [path for name in packages[:-1] for path in (root / name).rglob("*.py")]
    for path in installed:
        names, _ = imports_of(path, path.parent.relative_to(root).as_posix().replace("/", "."))
        outside = {name for name in names if name.split(".")[0] in ("benchmarks", "tests")}
        assert not outside or path.name == "bench.py", path
