"""Imports run one way between the packages, and never in a circle between modules.

Every import statement counts: those inside functions, and those for types only.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ALLOWED = {
    "theory": {"theory"},
    "derivations": {"derivations"},
    "verification": {"theory", "verification"},
    "paper_checks": {"theory", "derivations", "verification", "paper_checks"},
    "benchmarks": {"theory", "derivations", "verification", "benchmarks"},
    "fronts": {"theory", "derivations", "verification", "paper_checks", "benchmarks", "fronts"},
}


def _modules(root: Path, packages: list[str]) -> dict[str, Path]:
    """Return the files of some packages by the dotted names of their modules."""
    found = {}
    for package in packages:
        for path in (root / package).rglob("*.py"):
            name = ".".join(path.relative_to(root).with_suffix("").parts)
            found[name.removesuffix(".__init__")] = path
    return found


@cache
def _imported(path: Path) -> list[tuple[str, str]]:
    """Return what a file imports, dotted, each with the module that it is of if it is none."""
    found = []
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            found += [(alias.name, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, f"{path} imports relative to itself"
            home = node.module or ""
            found += [(f"{home}.{alias.name}", home) for alias in node.names]
    return found


def _graph(modules: dict[str, Path]) -> dict[str, set[str]]:
    """Return which modules each one imports."""
    return {
        module: {name if name in modules else home for name, home in _imported(path)} & {*modules}
        for module, path in modules.items()
    }


def _circle(modules: dict[str, Path]) -> list[str]:
    """Return the modules of a circle of imports, if there is one."""
    try:
        TopologicalSorter(_graph(modules)).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_modules_import_each_other_in_a_circle():
    assert _circle(_modules(ROOT, list(ALLOWED))) == []


@pytest.mark.parametrize(
    "inside", ["", "def f():\n    ", "if TYPE_CHECKING:\n    "], ids=["top", "function", "types"]
)
def test_a_circle_is_found_wherever_it_is_imported(tmp_path, inside):
    home = tmp_path / "home"
    home.mkdir()
    for name, text in {
        "__init__": "",
        "a": "from home.b import f\n",
        "b": "from home import c\n",
        "c": f"{inside}import home.a\n",
    }.items():
        (home / f"{name}.py").write_text(text)
    assert {*_circle(_modules(tmp_path, ["home"]))} == {"home.a", "home.b", "home.c"}


@pytest.mark.parametrize("package", ALLOWED)
def test_imports_run_one_way_between_the_packages(package):
    for path in (ROOT / package).rglob("*.py"):
        ours = {name.partition(".")[0] for name, _ in _imported(path)} & {*ALLOWED}
        assert ours <= ALLOWED[package], path


def _named_in(text: str) -> Iterator[str]:
    """Yield files and modules of ours that a text names in backquotes, as paths."""
    home = f"(?:{'|'.join([*ALLOWED, 'docs', 'examples', 'tests'])})"
    yield from re.findall(rf"`({home}/[\w/.]+\.\w+)`", text)
    yield from (name.replace(".", "/") for name in re.findall(rf"`({home}(?:\.\w+)+)`", text))


def _stands(path: str) -> bool:
    """Return whether a file or folder is there, or what is named in a module or package."""
    if (ROOT / path).exists() or (ROOT / path).with_suffix(".py").exists():
        return True
    for place in (ROOT / path).parents:
        for home in (place.with_suffix(".py"), place / "__init__.py"):
            if home.is_file():
                named = (ROOT / path).relative_to(place).parts
                text = home.read_text("utf-8")
                return all(re.search(rf"\b{name}\b", text) for name in named)
    return False


@pytest.mark.parametrize("suffix", ["*.py", "*.md"])
def test_files_and_modules_named_in_prose_are_there(suffix):
    folders = [ROOT / name for name in (*ALLOWED, "docs", "examples")]
    texts = [
        path for folder in folders for path in folder.rglob(suffix) if "site" not in path.parts
    ]
    for path in [*texts, *ROOT.glob(suffix)]:
        lost = [each for each in _named_in(path.read_text("utf-8")) if not _stands(each)]
        assert not lost, (path.relative_to(ROOT), lost)
