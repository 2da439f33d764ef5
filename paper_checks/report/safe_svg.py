"""Sanitise pictures before they are shown: only what is listed here is kept.

The diagrams of the report are read from files in ``benchmarks/results``, which whoever can write
there may replace; the pictures of findings are drawn anew in each run, and go through the same
function. The document is parsed and rewritten with the elements and attributes listed below.
Scripts, event handlers, foreign content, animations, images and references to anything but the
document itself are removed. The page's content security policy would also stop a script; either
measure suffices alone.
"""

from __future__ import annotations

import functools
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from html import escape

_SVG = "{http://www.w3.org/2000/svg}"
_HREFS = ("href", "{http://www.w3.org/1999/xlink}href")

_NAMES = re.compile(r"[\w-]+")

ELEMENTS = frozenset(
    _NAMES.findall(
        "svg g defs use symbol path rect circle ellipse line polyline polygon text tspan title "
        "desc clipPath marker pattern linearGradient radialGradient stop style"
    )
)
ATTRIBUTES = frozenset(
    _NAMES.findall(
        "id d x y x1 y1 x2 y2 cx cy r rx ry dx dy fx fy width height points transform viewBox "
        "version preserveAspectRatio role style class fill fill-opacity fill-rule stroke "
        "stroke-width stroke-opacity stroke-linecap stroke-linejoin stroke-dasharray "
        "stroke-dashoffset stroke-miterlimit opacity color clip-path clip-rule clipPathUnits "
        "marker-start marker-mid marker-end markerWidth markerHeight markerUnits refX refY orient "
        "offset stop-color stop-opacity gradientUnits gradientTransform spreadMethod patternUnits "
        "patternTransform font-family font-size font-style font-weight text-anchor "
        "dominant-baseline type"
    )
)
FUNCTIONS = frozenset(_NAMES.findall("translate scale rotate matrix skewX skewY rgb rgba url"))
"""Functions that may occur in a value."""

_STYLE_SHEET = re.compile(r"[\w\s*{}:;.,#-]*")


@functools.lru_cache(maxsize=256)  # needed by the judge, the files and each place of a page
def safe_svg(svg: str) -> str:
    """Return an SVG document that contains only listed elements and attributes.

    Parameters
    ----------
    svg : str
        The document. Entities and a document type are not processed.

    Returns
    -------
    str
        The document from ``<svg`` to ``</svg>``.

    Raises
    ------
    ValueError
        If it is not a well-formed SVG document.

    Examples
    --------
    >>> safe_svg('<svg width="8pt" onload="f()"><script>f()</script><path id="a"/></svg>')
    '<svg xmlns="http://www.w3.org/2000/svg" \
xmlns:xlink="http://www.w3.org/1999/xlink" width="8pt"><path id="a"/></svg>'
    """
    begin, end = svg.find("<svg"), svg.rfind("</svg>")
    if begin < 0 or end < begin:
        raise ValueError("the picture holds no SVG document.")
    try:
        root = ET.fromstring(_with_namespaces(svg[begin : end + len("</svg>")]))
    except ET.ParseError as error:
        raise ValueError(f"the picture is no well-formed SVG document ({error}).") from None
    parts = list(_written(root))
    if not parts:
        raise ValueError("the picture holds no SVG document.")
    spaces = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    return "".join(parts).replace("<svg", f"<svg {spaces}", 1)


def _with_namespaces(body: str) -> str:
    """Return the document with its namespace prefixes declared, as in the page it was cut from."""
    head, _, rest = body.partition(">")
    if "xmlns:xlink" not in head:
        head = head.replace("<svg", '<svg xmlns:xlink="http://www.w3.org/1999/xlink"', 1)
    return f"{head}>{rest}"


def _written(element: ET.Element) -> Iterator[str]:
    """Write an element and its content, if the element is listed."""
    name = element.tag.removeprefix(_SVG)  # of another language it begins with a bracket
    if name not in ELEMENTS:
        return
    text = element.text or ""
    if name == "style":
        if _STYLE_SHEET.fullmatch(text):
            yield f'<style type="text/css">{text}</style>'
        return
    yield f"<{name}"
    for attribute, value in element.attrib.items():
        if attribute in _HREFS and re.fullmatch(r"#[\w.-]+", value):
            yield f' xlink:href="{value}"'
        elif attribute in ATTRIBUTES and _harmless(value):
            yield f' {attribute}="{escape(value)}"'
    inner = [escape(text)]
    for child in element:
        inner += [*_written(child), escape(child.tail or "")]
    content = "".join(inner)
    yield f">{content}</{name}>" if content else "/>"


def _harmless(value: str) -> bool:
    """Return whether a value uses only listed functions and refers only to the document itself."""
    if "\\" in value or "@" in value:  # escapes in style sheets could encode anything
        return False
    calls = re.findall(r"([\w-]*)\s*\(", value)
    addresses = re.findall(r"(?i)url\s*\(([^)]*)", value)
    return all(call in FUNCTIONS for call in calls) and all(
        re.fullmatch(r"#[\w.-]+", each) for each in addresses
    )
