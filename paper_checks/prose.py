"""The text of a claim, in a file beside its code: the paper's words, and a template of our finding.

A file has one section per claim, headed ``# key``. Its first paragraph states what is claimed and
how it is judged, with one line per field: ``place:``, ``quote:``, ``statement:``, ``printed:`` if
the paper gives a value, ``recorded:``, ``command:``, then a line ``by: WORDS [CODE]`` or ``by:
WORDS [CODE], for PART`` for each method, and a line ``also: PLACE: QUOTE`` for each repetition.
These are the fields of `paper_checks.claim.Claim` and are used without change.

The rest is a template that is filled with evidence. It begins with the short fields ``value:``,
``error:`` and ``tolerance:``, and for a few claims ``headline:`` for the first screen of the
report; paragraphs follow. A paragraph that begins with ``>`` is a remark. ``## picture NAME`` is
followed by the caption of that picture, ``## erratum`` by the fields of
`paper_checks.finding.Erratum`. Names in double braces are fields and properties of the evidence and
constants of the module; ``{{ c | f(".4f") }}`` formats a number, or several, joined by commas, and
``{{ folds | each("size {}: {:.4f}") }}`` formats rows of numbers and words. The section ``# all``
is the template for all claims of its module that have none of their own.
"""

from __future__ import annotations

import functools
import importlib.util
import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from paper_checks.finding import Erratum, Fault

if TYPE_CHECKING:
    from jinja2 import Environment

FIELDS = ("value", "error", "tolerance")
COMMON = "all"
"""Section for files in which all claims share one text."""
_REMARK = re.compile(r"^> ?", re.MULTILINE)
_FIELD = re.compile(r"^([a-z]+): ?", re.MULTILINE)


@dataclass(frozen=True)
class Prose:
    """The filled-in text of one claim.

    Attributes
    ----------
    value, error, tolerance : str
        The short fields.
    explanation : str
        Paragraphs, separated by empty lines.
    remarks : tuple of str
        The remarks, one per paragraph.
    parts : mapping
        Text of the ``##`` parts, by heading.
    headline : str
        The finding in one sentence for the first screen; for a few claims only.
    """

    value: str
    error: str
    tolerance: str
    explanation: str
    remarks: tuple[str, ...]
    parts: Mapping[str, str]
    headline: str = ""

    def caption(self, name: str) -> str:
        """Return the caption of a picture."""
        try:
            return _line(self.parts[f"picture {name}"])
        except KeyError:
            raise ValueError(f"the template has no '## picture {name}'.") from None

    def erratum(self) -> Erratum | None:
        """Return the erratum, if there is one."""
        if "erratum" not in self.parts:
            return None
        fields = _fields(self.parts["erratum"])
        return Erratum(
            Fault(fields["fault"]),
            *(fields[name] for name in ("printed", "corrected", "reason", "proof", "affects")),
        )


def written(module: str, key: str, evidence: object) -> Prose:
    """Fill the section of a claim with its evidence.

    Parameters
    ----------
    module : str
        Dotted name of the module with which the template belongs.
    key : str
        The claim's key.
    evidence : object
        Its fields and properties are available as names in the template, as are the constants of
        the module; ``e`` stands for the evidence itself.

    Raises
    ------
    ValueError
        If the section, or one of its fields, is missing.
    """
    text = _environment().from_string(template(module, key)).render(_names(module, evidence))
    head, *rest = re.split(r"^## +", text, flags=re.MULTILINE)
    parts = {}
    for part in rest:
        title, _, body = part.partition("\n")
        parts[title.strip()] = body
    top, _, body = head.strip().partition("\n\n")
    fields = _fields(top)
    missing = [name for name in FIELDS if not fields.get(name)]
    if missing:
        raise ValueError(f"{key}: the template has no {', '.join(missing)}.")
    paragraphs = [each.strip() for each in body.split("\n\n") if each.strip()]
    return Prose(
        **{name: fields[name] for name in FIELDS},
        explanation="\n\n".join(_line(each) for each in paragraphs if each[:2] != "> "),
        remarks=tuple(_line(_REMARK.sub("", each)) for each in paragraphs if each[:2] == "> "),
        parts=parts,
        headline=fields.get("headline", ""),
    )


def words(module: str, key: str) -> list[tuple[str, str]]:
    """Return the fields at the beginning of a claim's section, in order.

    Raises
    ------
    ValueError
        If there is no such section, or it does not begin with these fields.
    """
    head, _ = _section(module, key)
    if not head:
        raise ValueError(
            f"{_path(module).name} has no section '# {key}' that begins with 'place:'."
        )
    return [(name, value) for name, _, value in (line.partition(": ") for line in head.split("\n"))]


def template(module: str, key: str) -> str:
    """Return the template for the evidence of a claim: that of its section, or the common one."""
    own = _section(module, key)[1]
    found = own if own.strip() else _section(module, COMMON)[1]
    if not found:
        raise ValueError(f"{_path(module).name} has no section '# {key}'.")
    return found


def _section(module: str, key: str) -> tuple[str, str]:
    """Return the words of a claim and its template; a missing one is empty."""
    text = _sections(_path(module)).get(key, "")
    head, _, rest = text.partition("\n\n")
    return (head.rstrip(), rest) if head.startswith("place:") else ("", text)


def _path(module: str) -> Path:
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        raise ValueError(f"there is no module {module}.")
    return Path(spec.origin).with_suffix(".md")


@functools.lru_cache(maxsize=256)
def _sections(path: Path) -> Mapping[str, str]:
    found = re.split(r"^# +(\S+)\n", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return dict(zip(found[1::2], found[2::2], strict=True))


def _fields(text: str) -> dict[str, str]:
    found = _FIELD.split(text)
    return {name: _line(value) for name, value in zip(found[1::2], found[2::2], strict=True)}


def _line(text: str) -> str:
    return " ".join(text.split())


def _names(module: str, evidence: object) -> dict[str, Any]:
    constants = {name: it for name, it in vars(sys.modules[module]).items() if name.isupper()}
    names = {
        name: getattr(evidence, name)
        for name in dir(type(evidence))
        if isinstance(getattr(type(evidence), name, None), property)
    }
    fields = getattr(evidence, "__dataclass_fields__", {})
    return {
        **constants,
        **names,
        **{name: getattr(evidence, name) for name in fields},
        "e": evidence,
    }


def formatted(value: object, form: str = "g") -> str:
    """Format a number, or several numbers.

    Examples
    --------
    >>> formatted(0.12345, ".2f"), formatted([1.0, 2.5]), formatted(1e-9, ".0e"), formatted(None)
    ('0.12', '1, 2.5', '1e-09', 'none')
    """
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    if isinstance(value, Iterable):
        return ", ".join(formatted(each, form) for each in value)
    return format(value, form)


def rows_written(rows: Iterable[object], form: str, joint: str = ", ") -> str:
    """Write each row of numbers and words in one format, and join them.

    Examples
    --------
    >>> rows_written({1: 0.195, 3: 0.199}.items(), "size {}: {:.2f}", "; ")
    'size 1: 0.20; size 3: 0.20'
    """
    return joint.join(form.format(*row) if isinstance(row, tuple) else form.format(row)
                      for row in rows)  # fmt: skip


@functools.lru_cache(maxsize=1)
def _environment() -> Environment:
    from jinja2 import Environment, StrictUndefined

    # The text is escaped when the page is written; here it is plain text.
    made = Environment(undefined=StrictUndefined, autoescape=False, keep_trailing_newline=True)
    made.filters |= {"f": formatted, "each": rows_written}
    made.globals["zip"] = zip
    return made
