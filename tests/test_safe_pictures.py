"""What a forged picture can do in the report: nothing."""

import base64
import hashlib
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from html.parser import HTMLParser

import matplotlib
import pytest

from paper_checks.claim import Finding, Picture, Verdict
from paper_checks.outcome import checked_finding
from paper_checks.report import render
from paper_checks.report.inline_svg import inline_svg, width_of
from paper_checks.report.safe_svg import ELEMENTS, safe_svg

HARMLESS = '<path id="a" d="M0 0L1 1" style="fill: none; clip-path: url(#c)"/>'
FORGED = {
    "script": "<script>alert(1)</script>",
    "script of another namespace": '<h:script xmlns:h="http://www.w3.org/1999/xhtml">f()</h:script>',
    "handler": '<path onload="alert(1)" d="M0 0"/>',
    "foreign content": '<foreignObject><iframe src="javascript:f()"/></foreignObject>',
    "address of a script": '<a href="javascript:alert(1)"><text>x</text></a>',
    "address of a file": '<use href="https://example.org/x.svg#a"/>',
    "image": '<image href="data:image/svg+xml;base64,PHN2Zz4="/>',
    "animation": '<animate attributeName="href" values="javascript:alert(1)"/>',
    "style sheet": "<style>@import url(https://example.org/x.css);</style>",
    "style": '<path style="fill: url(https://example.org/x)" d="M0 0"/>',
    "escaped style": r'<path style="fill: u\72l(https://example.org/x)" d="M0 0"/>',
    "rule of a style": """<path style="fill: none; @import 'https://example.org/x'" d="M0 0"/>""",
    "escaped bracket": r'<path style="fill: url\28 https://example.org/x\29" d="M0 0"/>',
    "another function": """<path style="fill: image('https://example.org/x')" d="M0 0"/>""",
    "style breaking out": "<style><![CDATA[</style><script>f()</script>]]></style>",
    "text breaking out": "<text>&lt;/svg&gt;&lt;script&gt;alert(1)&lt;/script&gt;</text>",
    "title breaking out": "<title>&lt;/title&gt;&lt;img src=x onerror=alert(1)&gt;</title>",
    "attribute breaking out": '<path id="&quot;&gt;&lt;script&gt;f()&lt;/script&gt;" d="M0 0"/>',
}


def _document(inner, head=""):
    return (
        f'<?xml version="1.0"?>{head}<svg xmlns="http://www.w3.org/2000/svg" '
        f'xmlns:xlink="http://www.w3.org/1999/xlink" width="9pt">{HARMLESS}{inner}</svg>'
    )


class _Seen(HTMLParser):
    """Tags and attributes as a page's parser meets them."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.attributes = [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs


@pytest.mark.parametrize("inner", FORGED.values(), ids=FORGED)
def test_forged_pictures_lose_what_could_run_or_load(inner):
    page = inline_svg(_document(inner), "p", "A picture")
    seen = _Seen(page)
    assert set(seen.tags) <= {each.lower() for each in ELEMENTS}
    assert not {"script", "style", "img", "image", "a"} & set(seen.tags)
    for name, value in seen.attributes:
        assert not name.startswith("on")
        assert not re.search(r"javascript|https?:|data:", value or "")
    assert "p-a" in dict(seen.attributes)["id"] or ("id", "p-a") in seen.attributes
    assert ("style", "fill: none; clip-path: url(#p-c)") in seen.attributes


@pytest.mark.parametrize(
    "document",
    [
        "no picture",
        "<svg><g></svg>",
        _document("&boom;", '<!DOCTYPE svg [<!ENTITY boom "boom">]>'),
        '<svg xmlns="http://www.w3.org/1999/xhtml"></svg>',
    ],
)
def test_what_is_no_picture_is_refused(document):
    with pytest.raises(ValueError, match="picture"):
        safe_svg(document)


def test_text_of_a_picture_goes_on_behind_an_element_within_it():
    text = "<text>v<tspan>0</tspan> in <tspan>sites</tspan> per time</text>"
    assert ">v<tspan>0</tspan> in <tspan>sites</tspan> per time</text>" in safe_svg(_document(text))


def test_pictures_of_matplotlib_keep_every_element_and_attribute():
    import io

    import matplotlib.pyplot as plt

    with matplotlib.rc_context({"svg.fonttype": "none"}):
        figure, axes = plt.subplots()
        axes.plot([0, 1, 2], [0, 1, 0], "o--", label="$v_0$ & <others>")
        axes.fill_between([0, 1], [0, 1], alpha=0.3, hatch="/")
        axes.legend()
        stream = io.StringIO()
        figure.savefig(stream, format="svg")
        plt.close(figure)
    drawn = stream.getvalue()

    def listed(document):
        root = ET.fromstring(document[document.index("<svg") :])
        inside = root.find("{http://www.w3.org/2000/svg}metadata")
        if inside is not None:
            root.remove(inside)
        return [(e.tag, dict(e.attrib), (e.text or "").strip()) for e in root.iter()]

    kept = safe_svg(drawn)
    assert listed(kept) == listed(drawn)
    assert safe_svg(kept) == kept
    assert width_of(kept) == pytest.approx(6.4 * 72)  # the width of figures, in inches
    assert width_of("no picture") is None


def test_a_finding_names_no_path_and_holds_pictures_only():
    picture = Picture("front", "A front", _document(""), "", "", "")
    finding = Finding(
        verdict=next(iter(Verdict)), value="1", error="0", tolerance="0", explanation="x",
        methods=("one",), pictures=(picture,),
    )  # fmt: skip
    assert checked_finding(finding) is finding
    for change in ({"name": "../front"}, {"svg": "<svg><script>"}):
        forged = replace(finding, pictures=(replace(picture, **change),))
        with pytest.raises(ValueError, match="picture"):
            checked_finding(forged)


def test_policy_allows_the_page_s_own_script_and_no_other():
    template = render._resource("index.html.j2")
    script = render._resource("script.js")
    (written,) = re.findall(r"<script>(.*?)</script>", template, re.DOTALL)
    content = written.replace("{{ script }}", script)
    digest = base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
    policy = render.policy_for(script)
    assert f"script-src 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy
    assert "unsafe-inline" not in policy.split("script-src")[1]
    assert "script-src" not in render.POLICY
    assert "<script" not in render.measurements_page.__doc__
