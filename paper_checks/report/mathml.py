"""Equations for the page: MathML, with long ones in parts between which a line may break."""

from __future__ import annotations

from html import escape
from xml.etree.ElementTree import Element

from derivations.algebra.mathml import LatexError, as_text, mathml, mathml_element

__all__ = ["LatexError", "formula", "mathml"]

LONG = 40
"""Number of characters of LaTeX above which an equation may not fit on a line of a phone or of
paper."""
WIDE = 40
"""Number of nodes between brackets above which a line may also break inside them."""
_BREAKS = frozenset("+−=≈→≡⇔")
"""Signs before which a line may break."""


def formula(latex: str, *, block: bool = False) -> str:
    """Return MathML as `breakable` does, or the LaTeX itself if it cannot be typeset."""
    try:
        return breakable(latex, block=block)
    except LatexError:
        return f"<code>{escape(latex)}</code>"


def breakable(latex: str, *, block: bool = False) -> str:
    """Return MathML, with a long equation divided into parts between which a line may break.

    Raises
    ------
    LatexError
        If it cannot be typeset.
    """
    if len(latex) <= LONG:
        return mathml(latex, block=block)
    parts = "<wbr>".join(as_text(part) for part in _parts(mathml_element(latex)))
    return f'<span class="broken">{parts}</span>'


def _parts(root: Element) -> list[Element]:
    """Divide an equation before signs outside brackets, and after spaces."""
    nodes = _opened(root[0])
    parts = [Element("math")]
    depth, after_space = 0, False
    for node in nodes:
        sign = node.text
        breaks = sign in _BREAKS and node.get("form") != "prefix"
        if len(parts[-1]) and not depth and (breaks or after_space):
            parts.append(Element("math"))
            if breaks:
                node.set("form", "infix")
        if node.get("minsize") is None:
            depth += (sign in ("(", "[")) - (sign in (")", "]"))
        after_space = node.tag == "mspace"
        parts[-1].append(node)
    return parts


def _opened(row: Element) -> list[Element]:
    """Return the nodes of a row, with brackets opened whose content is longer than a line.

    Such brackets are as high as a fraction: they cannot adapt to their content once it is divided.
    """
    nodes: list[Element] = []
    for node in row:
        fenced = node.tag == "mrow" and len(node) > 0 and node[0].get("fence") == "true"
        if not fenced or sum(1 for _ in node.iter()) <= WIDE:
            nodes.append(node)
            continue
        for bracket in node.findall("mo[@fence='true']"):
            bracket.set("minsize", "2.6em")
        nodes += _opened(node)
    return nodes
