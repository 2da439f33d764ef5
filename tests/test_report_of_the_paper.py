"""The report on the paper itself in a real browser, at three widths, in light and dark.

``FRONTS_REPORT`` names the folder of a report that ``fronts check --out`` has written, which
``.ci/run`` does; without it one is written here on the claims of `QUICK`, whose evidence comes with
the toolkit or takes seconds.
"""

import os
import re
from pathlib import Path

import pytest

from fronts.cli import main
from paper_checks import shipped
from tests.driven_browser import need_browser, opened

QUICK = ("equations", "expectations", "fig05-regions", "fig13-similar", "fig15-regions", "fig16",
         "text-uniquely")  # fmt: skip

TITLE = "Nucleation and propagation of excitation fronts in self-excited systems"
AUTHORS = ("Shiroky", "Papangelo", "Hoffmann", "Gendelman")

# Opens all that can be opened, and reports what is wrong with what is then seen.
PROBE = """(() => {
  const all = (selector) => [...document.querySelectorAll(selector)];
  all("details").forEach((one) => { one.open = true; });
  const named = (one) => one.tagName + "." + (one.className.baseVal ?? one.className)
    + " " + (one.closest("[id]")?.id ?? "");
  const colour = (one) => getComputedStyle(one).backgroundColor.match(/[\\d.]+/g).map(Number);
  const text = document.body.innerText;
  const scrolled = (one) => {
    for (let box = one.parentElement; box; box = box.parentElement) {
      if (["auto", "scroll", "hidden"].includes(getComputedStyle(box).overflowX)) return true;
    }
    return false;
  };
  return {
    width: innerWidth,
    text,
    over: document.documentElement.scrollWidth - innerWidth,
    wide: all("body *").filter((one) => {
      const box = one.getBoundingClientRect();
      return box.width > 0 && box.right > innerWidth + 1 && !one.closest("svg") && !scrolled(one);
    }).map(named),
    bright: all("body *").filter((one) => {
      const [red, green, blue, alpha] = colour(one);
      return alpha !== 0 && (red + green + blue) / 3 > 128
        && one.getBoundingClientRect().width > 60;
    }).map(named),
    pictures: all("figure svg, figure img").map((one) => {
      const box = one.getBoundingClientRect();
      const loaded = one.tagName !== "IMG" || (one.complete && one.naturalWidth > 0);
      return [named(one), loaded && box.width > 100 && box.height > 60];
    }),
    formulas: all("math").filter((one) => one.getBoundingClientRect().width < 2).map(named),
  };
})()"""


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Return the address of a report on the paper."""
    need_browser()  # before seconds are spent on what it would show
    given = os.environ.get("FRONTS_REPORT")
    if given is None:
        given = tmp_path_factory.mktemp("report")
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(shipped, "CHEAP", 0.0)  # stale evidence is shown, and not computed anew
            main(["check", *QUICK, "--out", str(given)])
    index = Path(given).resolve() / "index.html"
    assert index.exists(), f"there is no report in {given}"
    return index.as_uri()


@pytest.fixture(scope="module")
def browser(page, tmp_path_factory):
    """Open a browser that all tests drive, once there is a page: while it waits it works too."""
    with opened(tmp_path_factory.mktemp("profile")) as driven:
        yield driven


def probed(browser, page, width, scheme="light"):
    """Open the page at a width, and return what the probe finds."""
    feature = {"name": "prefers-color-scheme", "value": scheme}
    browser.send("Emulation.setEmulatedMedia", features=[feature])
    browser.resize(width, 900)
    browser.open(page)
    found = browser.ask(PROBE)
    assert browser.problems == []
    assert found["width"] == width
    return found


@pytest.mark.parametrize("width", [1400, 800, 390])
def test_nothing_is_cut_or_lost_at_any_width(browser, page, width):
    found = probed(browser, page, width)
    assert found["over"] <= 0
    assert found["wide"] == []
    assert found["pictures"]
    assert [name for name, shown in found["pictures"] if not shown] == []
    assert found["formulas"] == []


def test_no_markup_is_left_in_the_text(browser, page):
    text = probed(browser, page, 1400)["text"]
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("fronts ")]
    stray = re.compile(r"\\[a-zA-Z]+|\$|&|\{\{|\}\}|</?[a-z]+>|\bnan\b|None\b|\^\{|_\{")
    assert [line for line in lines if stray.search(line)] == []


def test_no_card_is_white_in_the_dark(browser, page):
    assert probed(browser, page, 1400, "dark")["bright"] == []
    assert probed(browser, page, 1400)["bright"]


def test_the_paper_and_its_authors_are_named_on_the_first_screen(browser, page):
    probed(browser, page, 1400)
    first = browser.ask(
        "[...document.querySelectorAll('h1, h2, p, a')].filter((one) => {"
        " const box = one.getBoundingClientRect(); return box.top >= 0 && box.bottom < 900; })"
        ".map((one) => one.innerText).join(' ')"
    )
    for name in (TITLE, *AUTHORS):
        assert name in " ".join(first.split())
