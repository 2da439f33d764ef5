"""Insert several SVG documents into one HTML page without conflicts between their names."""

from __future__ import annotations

import re
from html import escape

from paper_checks.report.safe_svg import safe_svg

ENLARGE = 1.25
"""Magnification on screen, where type that suits a printed column is too small."""


def width_of(svg: str) -> float | None:
    """Width of a picture as drawn, in points; None if the document does not state it."""
    root = re.search(r"<svg[^>]*>", svg)
    width = re.search(r'\swidth="([0-9.]+)(pt|px|)"', root.group()) if root else None
    if width is None:
        return None
    return float(width.group(1)) * (1.0 if width.group(2) == "pt" else 0.75)


def inline_svg(svg: str, prefix: str, title: str) -> str:
    """Turn an SVG document into an element of an HTML page.

    Ids and style sheets are global in a page, so both are made specific to the picture. What only a
    separate file needs (prologue, metadata) is dropped, and so are comments and everything that
    `paper_checks.report.safe_svg` does not list.

    Parameters
    ----------
    svg : str
        The document.
    prefix : str
        Prefix for each id; unique in the page.
    title : str
        Alternative text.

    Examples
    --------
    >>> inline_svg('<svg width="8pt"><path id="a"/><use href="#a"/></svg>', "p", "Dot")
    '<svg role="img" aria-label="Dot" style="width: 10pt"><path id="p-a"/>\
<use xlink:href="#p-a"/></svg>'
    """
    body = re.sub(r"<style.*?</style>", "", safe_svg(svg), flags=re.DOTALL)
    body = re.sub(r'\sxmlns(?::xlink)?="[^"]*"', "", body, count=2)
    body = re.sub(r'(\s)id="([^"]*)"', rf'\1id="{prefix}-\2"', body)
    body = re.sub(r'(href=")#([^"]*)"', rf'\1#{prefix}-\2"', body)
    body = re.sub(r"url\(#([^)]*)\)", rf"url(#{prefix}-\1)", body)
    label = escape(" ".join(title.split()))
    width = width_of(body)
    style = ""
    if width is not None:
        style = f' style="width: {width * ENLARGE:g}pt"'
        root, rest = body.split(">", 1)
        body = re.sub(r'\s(?:width|height)="[^"]*"', "", root) + ">" + rest
    # A function, because a backslash in the caption must be kept.
    return re.sub("^<svg", lambda _: f'<svg role="img" aria-label="{label}"{style}', body)
