"""The equations in a real browser: every one is drawn, whole, and as a formula."""

import pytest

from derivations import catalogue, judgement
from derivations.algebra.mathml import mathml
from derivations.algebra.rendering import equation_latex, equation_mathml
from tests.driven_browser import need_browser, opened

PROBE = """(() => {
  const all = (root, what) => [...root.querySelectorAll(what)];
  const size = (one) => parseFloat(getComputedStyle(one).fontSize);
  const box = (one) => one.getBoundingClientRect();
  return all(document, "li").map((row) => {
    const math = row.querySelector("math");
    const leaves = all(math, "mi, mn, mo")
      .filter((one) => !"\\u2061\\u2062".includes(one.textContent));
    const signs = leaves.filter((one) => "()".includes(one.textContent));
    return {
      tags: [...new Set(all(math, "*").map((one) => one.tagName))],
      foreign: all(row, "*").filter((one) => one.namespaceURI != math.namespaceURI).length,
      // A circumflex is an accent over its letter, or LaTeX.
      text: leaves.filter((one) => one.parentNode.tagName != "mover")
        .map((one) => one.textContent).join(" "),
      width: box(math).width, height: box(math).height, em: size(row), leaves: leaves.length,
      lost: leaves.filter((one) => box(one).width < 1).map((one) => one.textContent),
      wide: signs.filter((one) => box(one).height < 1.5 * size(one)
        && box(one).width > 0.6 * size(one)).length,
      primes: all(math, "mo").filter((one) => "′″‴⁗".includes(one.textContent))
        .map((one) => size(one) / size(one.previousSibling)),
      stacked: all(math, "mfrac").every(
        (one) => box(one.children[0]).bottom <= box(one.children[1]).top),
    };
  });
})()"""


STYLE = "<style>math { display: inline math; }</style>"
"""A displayed formula has the width of its page."""


@pytest.fixture(scope="module")
def equations():
    """LaTeX and MathML of every derived equation, and of every one as printed, by its name."""
    need_browser()  # before seconds are spent on what it would draw
    found = {}
    for key in catalogue.LISTING:
        for step in catalogue.load(key).steps:
            result = step.result
            found[f"{key}: {step.name}"] = equation_latex(result), equation_mathml(result)
    for each in judgement.equations():
        found[f"({each.number})"] = each.latex, mathml(each.latex, block=True)
    return found


@pytest.fixture(scope="module")
def drawn(equations, tmp_path_factory):
    """What the browser says about each."""
    folder = tmp_path_factory.mktemp("equations")
    rows = "".join(f"<li>{math}</li>" for _, math in equations.values())
    page = f"<!doctype html><meta charset=utf-8><title>Equations</title>{STYLE}<ol>{rows}</ol>"
    (folder / "all.html").write_text(page, encoding="utf-8")
    with opened(folder / "profile") as browser:
        browser.open((folder / "all.html").as_uri())
        found = browser.ask(PROBE)
        assert browser.problems == []
    return dict(zip(equations, found, strict=True))


def test_each_is_drawn_whole_and_holds_no_latex(drawn):
    known = {"math", "mrow", "mstyle", "mi", "mn", "mo", "mtext", "mspace", "mfrac", "msqrt",
             "mroot", "msub", "msup", "msubsup", "mover", "munder", "munderover", "mtable", "mtr",
             "mtd"}  # fmt: skip
    for name, found in drawn.items():
        assert set(found["tags"]) <= known, name  # no merror, no element that is not known
        assert found["foreign"] == 0, name
        assert not set("\\_^&$") & set(found["text"]), name
        assert found["lost"] == [], name


def test_each_has_the_size_of_a_formula(drawn):
    for name, found in drawn.items():
        assert found["width"] > 0.3 * found["em"] * found["leaves"] ** 0.5, name
        assert found["width"] < 1.5 * found["em"] * found["leaves"] + 3 * found["em"], name
        assert 0.5 * found["em"] < found["height"] < 60 * found["em"], name
        assert found["stacked"], name


def test_only_matrices_are_wider_than_a_page(drawn):
    wide = {name for name, found in drawn.items() if found["width"] > 50 * found["em"]}
    assert wide == {"(42)", "linearisation: Jacobian", "linearisation: Jacobian with free ends"}


def test_primes_are_as_large_as_their_letters_and_brackets_stand_close(drawn):
    assert any(found["primes"] for found in drawn.values())
    for name, found in drawn.items():
        assert all(ratio > 0.99 for ratio in found["primes"]), name
        assert found["wide"] == 0, name


def test_there_was_latex_to_begin_with(equations):
    assert len(equations) == 276
    assert sum("\\" in latex for latex, _ in equations.values()) > 200
