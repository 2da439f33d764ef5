"""LaTeX as presentation MathML by latex2mathml; commands it does not know are refused."""

from __future__ import annotations

from html import unescape
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from latex2mathml import exceptions
from latex2mathml.converter import convert_to_element

_REFUSED: tuple[type[Exception], ...] = (
    *(each for each in vars(exceptions).values() if isinstance(each, type)),
    IndexError, KeyError, AttributeError, StopIteration,
)  # fmt: skip
_PARTS = {"mfrac": 2, "msub": 2, "msup": 2, "msubsup": 3, "mover": 2, "munder": 2, "munderover": 3}
_PRIMES = frozenset("′″‴⁗")
"""Signs that are already raised: as an exponent they would be even smaller and higher."""
_TALL = frozenset({"mfrac", "mtable", "munder", "munderover"})
_FUNCTIONS = frozenset(
    ["sin", "cos", "tan", "cot", "sinh", "cosh", "tanh", "exp", "ln", "log", "arg", "det", "max",
     "min", "Re", "Im", "Res", "tr", "sgn", "sign"]
)  # fmt: skip
"""Function names, which are set slightly apart from their neighbours, as in 2 cos k."""
_OPENS = frozenset("([=,;→≈<>≤≥≪≡∈⇔|")
"""Signs after which a minus belongs to what follows and is set close to it."""


class LatexError(ValueError):
    """LaTeX that cannot be typeset."""


def mathml_element(latex: str, *, block: bool = False) -> Element:
    """Return the ``math`` element of some LaTeX.

    Parameters
    ----------
    latex : str
        Without dollar signs.
    block : bool, optional
        Whether to display it on a line of its own.

    Raises
    ------
    LatexError
        If a command is unknown, or braces or arguments do not match.
    """
    bare = latex.replace("\\{", "").replace("\\}", "")
    if bare.count("{") != bare.count("}"):
        raise LatexError(f"braces do not match in {latex!r}.")
    known = latex.replace(r"\begin{aligned}", r"\begin{array}{rl}")
    known = known.replace(r"\end{aligned}", r"\end{array}")
    try:
        root = convert_to_element(known, display="block" if block else "inline")
    except _REFUSED as error:
        raise LatexError(f"{latex!r} cannot be typeset: {type(error).__name__}.") from error
    root.attrib.pop("xmlns", None)
    if not block:
        root.attrib.pop("display", None)
    for node in root.iter():
        node.text = unescape(node.text) if node.text else node.text
        lost = node.tag in ("mi", "mn", "mo") and (node.text or "").strip() in ("", "&")
        if lost or "\\" in (node.text or "") or len(node) != _PARTS.get(node.tag, len(node)):
            raise LatexError(f"{latex!r} has a command that is not known, or lacks an argument.")
        if node.tag == "mo" and (node.text or "").isascii() and (node.text or "").isalpha():
            node.tag = "mi"  # the name of a function
        if node.tag == "mo" and node.text in ("|", "/"):  # modulus or quotient, not a relation
            node.set("lspace", "0")
            node.set("rspace", "0")
    for node in root.iter():
        _join_word(node)
        _mark_signs(node)
        _lower_primes(node)
        _set_close(node)
    for node in list(root.iter()):
        _space_functions(node)
    return root


def mathml(latex: str, *, block: bool = False) -> str:
    r"""Return the ``math`` element of some LaTeX as text; parameters as in `mathml_element`.

    Examples
    --------
    >>> mathml(r"\frac12 k_1")
    '<math><mrow><mfrac><mn>1</mn><mn>2</mn></mfrac><msub><mi>k</mi><mn>1</mn></msub></mrow></math>'
    """
    return as_text(mathml_element(latex, block=block))


def as_text(element: Element) -> str:
    """Return an element as text, with its signs as characters."""
    return ElementTree.tostring(element, encoding="unicode")


def _join_word(row: Element) -> None:
    """Combine single upright letters to one name."""
    if len(row) > 1 and all(node.get("mathvariant") == "normal" for node in row):
        word = "".join(node.text or "" for node in row)
        row[:] = [Element("mi")]
        row[0].text = word


def _mark_signs(row: Element) -> None:
    """Mark a minus as a sign if nothing precedes it from which it could be subtracted."""
    previous = ""
    for node in row:
        if node.tag == "mo" and node.text == "−" and (previous in _OPENS or not previous):
            node.set("form", "prefix")
        previous = (node.text or "x") if node.tag == "mo" else "x"


def _lower_primes(node: Element) -> None:
    """Place a prime after its symbol, instead of in an exponent."""
    if node.tag not in ("msup", "msubsup") or node[-1].text not in _PRIMES:
        return
    prime = Element("mo", {"lspace": "0", "rspace": "0"})
    prime.text = node[-1].text
    base = node[0]
    if node.tag == "msubsup":
        base = Element("msub")
        base.extend(node[:2])
    node.tag, node[:] = "mrow", [base, prime]


def _set_close(row: Element) -> None:
    """Keep brackets small if nothing in them is tall: browsers space out stretchy brackets."""
    if row.tag == "mrow" and not any(node.tag in _TALL for node in row.iter()):
        for node in row:
            if node.get("fence"):
                node.set("stretchy", "false")


def _space_functions(row: Element) -> None:
    """Separate a function name from its argument and its factor, unless there is a bracket."""
    if row.tag not in ("math", "mrow", "mtd"):
        return
    spaced: list[Element] = []
    for node in row:
        last = spaced[-1] if spaced else None
        if last is not None and node.tag != "mspace" and last.tag != "mspace":
            if _is_function(last) and (node.tag != "mo" or node.text == "|"):
                spaced.append(_thin_space("\u2061"))  # function application
            elif _is_function(node) and (last.tag != "mo" or last.text in (")", "]")):
                spaced.append(_thin_space("\u2062"))  # invisible times
        spaced.append(node)
    row[:] = spaced


def _is_function(node: Element) -> bool:
    """Whether a node is a function name, possibly with an exponent."""
    name = node[0] if node.tag in ("msup", "msub", "munder") else node
    return name.tag == "mi" and name.text in _FUNCTIONS


def _thin_space(sign: str) -> Element:
    """Return an invisible operator followed by a thin space."""
    found = Element("mo", {"lspace": "0", "rspace": "0.17em"})
    found.text = sign
    return found
