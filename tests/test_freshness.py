"""A stored measurement is stale when the code it is of has changed, and only then."""

import sys

import pytest
from paper_checks.imports import closure, essence

from paper_checks import freshness


@pytest.fixture
def package(tmp_path, monkeypatch):
    home = tmp_path / "timed_code"
    home.mkdir()
    (home / "__init__.py").write_text("")
    (home / "deep.py").write_text('"""What."""\n\n\ndef f(x):\n    """Say."""\n    return x + 1\n')
    (home / "top.py").write_text("def g(x):\n    from timed_code.deep import f\n    return f(x)\n")
    (home / "other.py").write_text("N = 1\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(freshness, "SOURCES", ("timed_code",))
    yield home
    for name in [name for name in sys.modules if name.startswith("timed_code")]:
        del sys.modules[name]


@pytest.mark.parametrize(
    ("file", "text", "stale"),
    [
        ("deep.py", "def f(x):\n    # a remark\n    return (\n        x + 1\n    )\n", True),
        ("deep.py", "def f(x):  # a remark\n\n    'Other words.'\n    return x + 1\n", False),
        ("deep.py", "def f(x):\n    return x + 2\n", True),
        ("deep.py", "def f(x):\n    if x:\n        pass\n    return x + 1\n", True),
        ("other.py", "N = 2\n", False),
        ("top.py", "def g(x):\n    return x\n", True),
    ],
)
def test_what_makes_a_record_stale(package, file, text, stale):
    record = {"code": freshness.fingerprint(["timed_code.top"])}
    assert freshness.staleness(record) == ""
    (package / file).write_text(text)
    assert freshness.staleness(record) == (freshness.CHANGED if stale else "")


def test_a_record_of_a_module_that_is_gone_is_stale(package):
    record = {"code": freshness.fingerprint(["timed_code.other"])}
    (package / "other.py").unlink()
    assert freshness.staleness(record) == freshness.CHANGED
    with pytest.raises(ValueError, match=r"no module timed_code\.other"):
        freshness.fingerprint(["timed_code.other"])


def test_a_record_that_names_no_code_is_stale():
    assert freshness.staleness({}) == freshness.UNKNOWN


def test_the_essence_keeps_strings_that_are_used_and_blocks(tmp_path):
    path = tmp_path / "code.py"
    found = []
    for text in (
        "x = f'{1 + 1:d} # not a remark'\n",
        "x = f'{1 + 2:d} # not a remark'\n",
        "if a:\n    b\n    c\n",
        "if a:\n    b\nc\n",
    ):
        path.write_text(text + "#" * len(found))  # another size, so that nothing is remembered
        found.append(essence(path))
    assert len(set(found)) == 4
    assert "# not a remark" in found[0]


def test_a_benchmark_does_not_depend_on_the_others_nor_on_what_draws():
    held = closure("benchmarks.roots", freshness.SOURCES)
    needed = {"benchmarks.runner", "theory.piecewise.roots", "verification.quantities.scenes"}
    assert needed <= set(held)
    assert not {"benchmarks.velocity", "benchmarks.vdp", "verification.runs.vdp"} & set(held)
    assert "benchmarks.diagram" in freshness.DRAWING
