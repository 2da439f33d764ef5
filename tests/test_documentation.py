"""What README and the pages say is run: blocks of Python and of the shell, and every command."""

from __future__ import annotations

import ast
import doctest
import importlib
import importlib.util
import re
import shlex
import tomllib
from pathlib import Path
from types import ModuleType

import matplotlib as mpl
import pytest

import fronts
from fronts import cli
from fronts.catalogue import COMMANDS

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md")),
         *sorted(DOCS.glob("*/*.md"))]  # fmt: skip
PAGES = [page for page in PAGES if page.parent.name != "generated"]
SCRIPTS = sorted(DOCS.glob("tutorials/*.py")) + sorted(DOCS.glob("gallery/*.py"))

FENCED = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
SPAN = re.compile(r"(?<!`)`fronts ([^`]+)`(?!`)", re.S)
LINE = re.compile(r"^    fronts (\S.*)$", re.M)
SAME = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def blocks(page: Path, kind: str) -> list[str]:
    return [text for name, text in FENCED.findall(page.read_text("utf-8")) if name == kind]


def commands(page: Path) -> list[str]:
    """Every command line of ``fronts`` that a page names, those of its console blocks left out."""
    text = FENCED.sub("", page.read_text("utf-8"))
    found = [" ".join(each.split()) for each in SPAN.findall(text) + LINE.findall(text)]
    return [
        each
        for each in found
        if re.search(r" -|^\S+ \S", each) and not re.search("[A-Z]{2,}", each)
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_command_that_a_page_names_is_one(page: Path) -> None:
    for line in commands(page):
        words = shlex.split(line, comments=True)
        if words[0].startswith("--"):
            continue
        parser, _, rest = cli._chosen(words[0], COMMANDS[words[0]], words[1:])
        parser.read(rest)


@pytest.mark.parametrize(
    "page", [page for page in PAGES if blocks(page, "python")], ids=lambda page: page.stem
)
def test_the_python_blocks_of_a_page_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__main__"}
    with mpl.rc_context({"backend": "agg"}):
        for block in blocks(page, "python"):
            if ">>>" in block:
                test = doctest.DocTestParser().get_doctest(block, names, page.name, None, 0)
                told: list[str] = []
                doctest.DocTestRunner(optionflags=SAME).run(
                    test, out=told.append, clear_globs=False
                )
                assert not told, "".join(told)
                names = test.globs
            else:
                exec(compile(block, page.name, "exec"), names)


@pytest.mark.parametrize(
    "page", [page for page in PAGES if blocks(page, "console")], ids=lambda page: page.stem
)
def test_the_shell_blocks_of_a_page_print_what_they_show(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for block in blocks(page, "console"):
        for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
            line, _, shown = part.partition("\n")
            program, *words = shlex.split(line, comments=True)
            assert program == "fronts"
            assert cli.main(words) in (0, 1)
            printed = capsys.readouterr().out
            if shown.strip():
                assert is_shown(shown, printed), printed


NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.]*\w)")
ROUNDING = 1e-11
"""Error bounds below this are roundings, of which each processor has its own."""


def is_shown(shown: str, printed: str) -> bool:
    """Whether a block is what was printed; a line of three dots stands for any lines.

    Words and numbers are the same, but for seconds, for the size of a rounding within a factor of
    five, and for a value with its uncertainty beside it, in words or in the next column, which is
    the same within that.
    """
    pattern = "".join(
        "(?:.*\n)*" if line.strip() == "..." else _pattern_of(line) for line in shown.splitlines()
    )
    found = re.fullmatch(pattern, printed.rstrip("\n") + "\n")
    if found is None:
        return False
    wanted = [n for line in shown.splitlines() if line.strip() != "..." for n in _numbers(line)]
    return all(
        ours == theirs or slack is None or abs(float(ours) - float(theirs)) <= slack
        for (ours, slack), theirs in zip(wanted, found.groups(), strict=True)
    )


def _pattern_of(line: str) -> str:
    """Return a pattern of a line, in which any number may stand where there is one."""
    parts = [r"\s+".join(map(re.escape, re.split(r"\s+", part))) for part in NUMBER.split(line)]
    return f"({NUMBER.pattern})".join(parts) + r" *\n"


def _numbers(line: str) -> list[tuple[str, float | None]]:
    """Return each number of a line, with how far another may be from it; None without a limit."""
    found: list[tuple[str, float | None]] = []
    for number in NUMBER.finditer(line):
        value, rest = float(number[0]), line[number.end() :]
        uncertain = re.match(r"(?:, uncertain by| {2,}(?=\S+e-1\d )) *(\S+)", rest)
        slack: float | None = 0.0
        if rest == " s":
            slack = None
        elif uncertain:
            slack = float(uncertain[1])
        elif 0.0 < value < ROUNDING:
            slack = 5.0 * value
        found.append((number[0], slack))
    return found


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("  v = 0.25, in 3 s", "  v = 0.25, in 17 s", True),
        ("  v = 0.25, in 3 s", "  v = 0.26, in 3 s", False),
        ("v = 0.2501, uncertain by 1e-4", "v = 0.2502, uncertain by 1e-4", True),
        ("v = 0.2501, uncertain by 1e-4", "v = 0.2503, uncertain by 1e-4", False),
        ("v = 0.2501, uncertain by 1e-4", "v = 0.2501, uncertain by 2e-4", False),
        ("0.2500000000000002  3e-15 1", "0.2500000000000001  3e-15 1", True),
        ("0.2500000000000002  3e-15 1", "0.2500000000000102  3e-15 1", False),
        ("a     2.0e-14  yes", "a   5.0e-14   yes", True),
        ("a     2.0e-14  yes", "a   5.0e-13   yes", False),
        ("a     2.0e-14  yes", "a   2.0e-14   no", False),
        ("a\n...\nb", "a\nx\ny\nb", True),
        ("a\n...\nb", "a\nx\ny\nc", False),
        ("a\n...", "a", True),
        ("a", "a\nb", False),
    ],
)
def test_a_block_shows_what_is_printed(shown: str, printed: str, same: bool) -> None:
    assert is_shown(shown, printed) is same


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_uses_the_public_names_only_and_one_of_the_gallery_is_short(script: Path) -> None:
    text = script.read_text("utf-8")
    imported = {
        name.split(".")[0]
        for node in ast.walk(ast.parse(text))
        for name in (
            [each.name for each in node.names]
            if isinstance(node, ast.Import)
            else [node.module or ""]
            if isinstance(node, ast.ImportFrom)
            else []
        )
    }
    assert imported <= {
        "fronts",
        "numpy",
        "matplotlib",
        "sympy",
        "numba",  # compiles functions of the reader's own
        "concurrent",
        "tempfile",
        "pathlib",
    }
    if script.parent.name == "gallery":
        assert imported <= {"fronts", "numpy", "matplotlib"}
        assert len(text.splitlines()) < 40


def test_the_gallery_has_every_figure_of_the_paper_with_numbers() -> None:
    shown = {int(path.name[3:5]) for path in DOCS.glob("gallery/fig*.py")}
    assert shown == set(range(2, 19))  # Fig. 1 is a sketch


def test_every_public_name_is_in_the_reference() -> None:
    text = (DOCS / "reference" / "python.md").read_text("utf-8")
    listed = set(re.findall(r"auto(?:class|function|exception):: fronts\.(\w+)$", text, re.M))
    assert listed == set(fronts.__all__) - {"__version__"}


def test_each_function_beside_an_equation_says_its_number() -> None:
    rows = tomllib.loads((DOCS / "equations.toml").read_text("utf-8"))["uses"]
    for row in rows:
        for place in row["functions"]:
            module, _, name = place.partition(":")
            found = importlib.import_module(module)
            assert hasattr(found, name), place
            said = Path(str(found.__file__)).read_text("utf-8")
            for number in row["equations"]:
                assert covers(said, number), f"{place} does not say ({number})"


def covers(text: str, number: int) -> bool:
    """Whether a text names an equation, alone or within a range."""
    ranges = re.findall(r"\((\d+)\)-\((\d+)\)|Eqs\. \(?(\d+)\)?[-–]\(?(\d+)\)?", text)
    bounds = [(int(a or c), int(b or d)) for a, b, c, d in ranges]
    alone = re.search(rf"\({number}\)|Eqs?\. (?:\(?\d+\)?,? (?:and )?)*\(?{number}\b", text)
    return bool(alone) or any(low <= number <= high for low, high in bounds)


def site_check() -> ModuleType:
    spec = importlib.util.spec_from_file_location("check_site", DOCS / "check_site.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_broken_link_a_missing_anchor_and_a_fetched_script_are_found(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(
        '<h1 id="top"></h1><a href="#top">1</a><a href="other.html#here">2</a>'
        '<a href="other.html#there">3</a><a href="gone.html">4</a><a href="https://x.org">5</a>'
        '<script src="https://cdn.org/a.js"></script>'
    )
    (tmp_path / "other.html").write_text('<p id="here"></p>')
    assert site_check().faults(tmp_path) == [
        "index.html links to other.html#there, and there is no such place.",
        "index.html links to gone.html, which is not there.",
        "index.html fetches https://cdn.org/a.js from the network.",
    ]
