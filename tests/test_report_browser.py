"""The page works in a real browser: silent console, pictures and links load, filter, phone."""

import base64
import hashlib
import json
import re
from pathlib import Path

import pytest

from fronts.cli import main
from paper_checks import discover
from paper_checks.report import measurements
from tests.driven_browser import need_browser, opened

TYPED = {
    ("fig16-escape",): ("eq. 4", "Eq 4", "(4)", "eq4", "equations 4", "Eq. (4)"),
    ("fig16-speed",): ("eq 54", "Equation (54)", "fig 16 velocity", "veloc"),
    ("fig9-decay", "fig9-monotone"): ("fig9", "Figure 9", "FIG. 09"),
    ("fig16-speed", "fig16-misprint", "fig16-escape", "fig16-vague"): ("fig 16", "Figs. 16"),
    ("fig16-vague",): ("Section 5", "§5", "sec. 5"),
    ("fig16-misprint",): ("12",),
    (): ("fig 1", "eq 5", "5 4", "()"),
}
"""What a reader may type, by the claims that are to be shown."""

# Runs in the page and reports what only a browser knows.
PROBE = """(() => {
  const WORDS = @WORDS@;
  const all = (selector) => [...document.querySelectorAll(selector)];
  const here = (id) => document.getElementById(id) !== null;
  const rows = all("#claims > li");
  const state = () => ({
    shown: rows.filter((row) => row.getBoundingClientRect().height > 0).map((row) => row.id),
    open: rows.filter((row) => row.querySelector("details").open).map((row) => row.id),
    text: document.getElementById("shown").textContent,
    chosen: document.getElementById("verdict").selectedIndex,
    none: !document.getElementById("none").hidden,
    hash: location.hash,
  });
  const report = { first: state(), resources: performance.getEntriesByType("resource").length };
  report.dark = matchMedia("(prefers-color-scheme: dark)").matches;
  report.background = getComputedStyle(document.body).backgroundColor;
  report.card = all(".card").map((card) => getComputedStyle(card).backgroundColor);
  report.width = innerWidth;
  report.columns = getComputedStyle(document.querySelector(".gallery"))
    .gridTemplateColumns.split(" ").length;
  if (@BRIEF@) return report;
  const place = document.getElementById("place");
  const verdict = document.getElementById("verdict");
  verdict.value = "";
  place.value = "fig. 9";
  place.dispatchEvent(new Event("input"));
  report.place = state();
  place.value = "nothing of the kind";
  place.dispatchEvent(new Event("input"));
  report.nothing = state();
  report.typed = {};
  for (const words of WORDS) {
    place.value = words;
    place.dispatchEvent(new Event("input"));
    report.typed[words] = state().shown;
  }
  place.value = "";
  place.dispatchEvent(new Event("input"));
  location.hash = "#erratum-fig16-misprint";
  dispatchEvent(new HashChangeEvent("hashchange"));
  report.erratum = document.querySelector("#erratum-fig16-misprint details").open;
  history.replaceState(null, "", "#");
  document.getElementById("unfold").click();
  report.unfolded = state();
  all(".failures").forEach((one) => { one.open = true; });
  report.overflow = document.documentElement.scrollWidth - innerWidth;
  report.pictures = all("figure svg").map((svg) => {
    const box = svg.getBoundingClientRect();
    const names = [...svg.querySelectorAll("use")].map((use) => use.href.baseVal.slice(1));
    for (const one of svg.querySelectorAll("[clip-path]")) {
      names.push(one.getAttribute("clip-path").slice(5, -1));
    }
    return {
      width: box.width,
      height: box.height,
      label: svg.getAttribute("aria-label"),
      names: names.length,
      lost: names.filter((name) => !svg.contains(document.getElementById(name))),
    };
  });
  all("#errata details").forEach((one) => { one.open = true; });
  report.formulas = all(".math math").map((one) => {
    const box = one.getBoundingClientRect();
    return { width: box.width, height: box.height, parts: one.querySelectorAll("*").length };
  });
  const fraction = document.querySelector("mfrac");
  report.stacked = fraction !== null
    && fraction.children[0].getBoundingClientRect().bottom
      <= fraction.children[1].getBoundingClientRect().top;
  report.overflow = Math.max(
    report.overflow, document.documentElement.scrollWidth - innerWidth);
  report.data = all("a[download]").map((link) => atob(link.href.split(",")[1]).split("\\n")[0]);
  report.dead = all("a[href^='#']:not([href*='='])")
    .map((link) => link.getAttribute("href").slice(1))
    .filter((id) => !here(id));
  report.unnamed = all("select, input").filter((one) => one.labels.length !== 1).length;
  report.alerted = all("#claims img, #claims script, #claims u").length;
  return report;
})()"""

WIDTHS = (1400, 800, 390)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Write the report on the made-up claims."""
    need_browser()
    out = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(Path(__file__).parent / "report_example"))
        patch.setattr(discover, "PACKAGE", "example_claims")
        patch.setattr(measurements, "RESULTS", Path(__file__).parent / "report_example/measured")
        assert main(["check", "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def browser(folder, tmp_path_factory):
    """Open a browser that all tests drive, page after page, once there is a report."""
    with opened(tmp_path_factory.mktemp("profile")) as driven:
        yield driven


def with_last_script_allowed(page):
    """Let the page's policy allow the script that a test has put at the end of it."""
    script = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)[-1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return page.replace("script-src ", f"script-src 'sha256-{digest}' ", 1)


def probe(browser, folder, hash_="", brief=False):
    """Open the page of the report, and give what only a browser knows of it.

    In brief this is the page as it opens; else things are typed, and all is unfolded.
    """
    browser.open((folder / "index.html").as_uri() + hash_)
    words = json.dumps([one for spellings in TYPED.values() for one in spellings])
    found = browser.ask(PROBE.replace("@WORDS@", words).replace("@BRIEF@", json.dumps(brief)))
    assert browser.problems == []
    return found


@pytest.fixture(scope="module")
def page(browser, folder):
    """What the browser knows of the page, in a window as it is opened."""
    return probe(browser, folder)


def test_the_page_itself_is_silent_and_whole(browser, folder):
    browser.open((folder / "index.html").as_uri())
    assert "6 of 6 shown" in browser.ask("document.body.innerText")
    assert browser.problems == []


def test_an_error_in_the_page_would_be_noticed(browser, folder, tmp_path):
    text = (folder / "index.html").read_text(encoding="utf-8")
    broken = tmp_path / "broken.html"
    page = text.replace("</body>", "<img src='x.png'><script>no()</script></body>")
    broken.write_text(with_last_script_allowed(page))
    browser.open(broken.as_uri())
    assert any("no is not defined" in each for each in browser.problems)
    assert any("Content Security Policy" in each for each in browser.problems)


def test_a_script_that_is_not_the_page_s_own_does_not_run(browser, folder, tmp_path):
    text = (folder / "index.html").read_text(encoding="utf-8")
    forged = tmp_path / "forged.html"
    forged.write_text(text.replace("</body>", "<script>no()</script><p onclick='no()'></body>"))
    browser.open(forged.as_uri())
    assert any("Content Security Policy" in each for each in browser.problems)
    assert not any("no is not defined" in each for each in browser.problems)


def test_pictures_data_and_links_load(page):
    assert len(page["pictures"]) == 3  # of two figures, and the first of them again on top
    for picture in page["pictures"]:
        assert picture["width"] > 300
        assert picture["height"] > 100
        assert picture["label"]
        assert picture["names"] > 5
        assert picture["lost"] == []
    assert page["data"] == ["t,amplitude", "series,c,v,exponent"]
    assert page["dead"] == []
    assert page["resources"] == 0
    assert page["unnamed"] == 0
    assert page["alerted"] == 0


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        ("", (6, [])),
        ("#verdict=not-reproduced", (["claim-fig16-speed"], [])),
        ("#verdict=reproduced&place=eqs.+1", (["claim-fig16-escape"], [])),
        ("#place=Section%205", (["claim-fig16-vague"], [])),
        ("#verdict=nonsense", (6, [])),
        ("#claim-fig16-speed", (6, ["claim-fig16-speed"])),
        ("#figure-fig9-decay", (6, [])),
        ("#verdict=reproduced&place=equation+4", (["claim-fig16-escape"], [])),
        ("#claim-none-such", (6, [])),
        ("#%", (6, [])),
    ],
)
def test_the_address_filters_and_opens(browser, folder, address, expected):
    shown, opened = expected
    found = probe(browser, folder, address, brief=True)["first"]
    assert found["shown"] == shown or len(found["shown"]) == shown
    assert found["text"] == f"{len(found['shown'])} of 6 shown"
    assert found["open"] == opened
    assert found["chosen"] >= 0


def test_typing_filters_and_is_kept_in_the_address(page):
    assert page["place"]["shown"] == ["claim-fig9-decay", "claim-fig9-monotone"]
    assert page["place"]["hash"] == "#place=fig.+9"
    assert page["nothing"]["shown"] == []
    assert page["nothing"]["none"]
    assert len(page["unfolded"]["open"]) == 6


def test_places_are_found_however_they_are_spelt(page):
    for keys, spellings in TYPED.items():
        for words in spellings:
            assert page["typed"][words] == [f"claim-{key}" for key in keys], words
    assert page["erratum"]


def test_paper_holds_open_rows_only_and_nothing_is_cut(folder):
    text = (folder / "index.html").read_text(encoding="utf-8")
    assert "beforeprint" not in text
    styles = text[text.index("@media print") : text.index("</style>")]
    assert "details-content" not in styles
    assert re.search(r"\.math, \.measured \{ overflow: visible; \}", styles)


@pytest.mark.parametrize(("scheme", "dark"), [("dark", True), ("light", False)])
def test_it_follows_the_colour_scheme_and_no_card_is_white_in_the_dark(
    browser, folder, scheme, dark
):
    feature = {"name": "prefers-color-scheme", "value": scheme}
    browser.send("Emulation.setEmulatedMedia", features=[feature])
    found = probe(browser, folder, brief=True)
    assert found["dark"] is dark
    brightness = sum(map(int, re.findall(r"\d+", found["background"])[:3])) / 3
    assert (brightness < 50) is dark
    white = "rgb(255, 255, 255)"
    assert found["card"]
    assert all((card == white) is not dark for card in found["card"])


def test_equations_are_typeset_by_the_browser_itself(page):
    assert len(page["formulas"]) == 3
    for formula in page["formulas"]:
        assert formula["width"] > 20
        assert formula["height"] > 10
        assert formula["parts"] > 3
    assert page["stacked"]  # a browser without MathML puts both parts of a fraction in a line


@pytest.mark.parametrize("width", WIDTHS)
def test_nothing_is_wider_than_the_screen_and_there_are_two_columns_where_there_is_room(
    browser, folder, width
):
    browser.resize(width, 800)
    found = probe(browser, folder)
    assert found["width"] == width
    assert found["overflow"] <= 0
    assert found["columns"] == (2 if width > 960 else 1)
