"""Formulas as MathML, which browsers typeset themselves: no script and no network."""

import re
from typing import Any

from docutils import nodes

from derivations.algebra.mathml import mathml

ALIGNED = re.compile(r"\\\\|(?<!\\)&")


def written(latex: str, *, block: bool) -> str:
    """Return the MathML of a formula."""
    text = latex.strip()
    if block and ALIGNED.search(text) and r"\begin" not in text:
        text = rf"\begin{{aligned}}{text}\end{{aligned}}"
    return mathml(text, block=block)


def inline(translator: Any, node: nodes.math) -> None:
    """Write a formula in a line."""
    translator.body.append(written(node.astext(), block=False))
    raise nodes.SkipNode


def block(translator: Any, node: nodes.math_block) -> None:
    """Write a displayed formula, with its number if it has a label."""
    name = node.get("number")
    number = f'<span class="eqno">({name})</span>' if name else ""
    translator.body.append(f'<div class="math">{number}{written(node.astext(), block=True)}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, Any]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
