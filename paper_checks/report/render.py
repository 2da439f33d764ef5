"""The report as self-contained HTML: the main page, and a page of measurements.

The pages are Jinja templates next to this module, ``index.html.j2`` and ``methods.html.j2``. Text
passed to them is escaped; the filters here return HTML.
"""

from __future__ import annotations

import base64
import functools
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import TYPE_CHECKING

from paper_checks.outcome import FAILED, slug
from paper_checks.report import inline_math, mathml
from paper_checks.report.document import Report
from paper_checks.report.inline_svg import inline_svg, width_of
from paper_checks.report.section import grouped, in_words
from paper_checks.report.table import duration
from paper_checks.ruling import Verdict
from verification.execution.metadata import TOOLKIT

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
"""Content security policy: the page forbids the browser every request, to the network or to other
files, and every script; the report's page allows its own script, by its digest (`policy_for`)."""

DOCS = "../site/index.html"
"""The documentation as built by ``make docs``, relative to the report of ``make paper``."""

MAX_NAMED = 5
"""Number of changed verdicts above which they are folded away, so that the first screen stays
small."""

WIDE = 300
"""Width in points above which a picture does not fit on a phone."""

IN_ROW = 280
"""Number of characters of LaTeX of an equation that fit into a closed row."""

STATUS = {slug(verdict): verdict.value for verdict in Verdict} | {FAILED: "judge failed"}
"""Text for each status."""


@dataclass(frozen=True)
class Paper:
    """The paper that is judged."""

    title: str
    authors: str


PAPER = Paper(
    title="Nucleation and propagation of excitation fronts in self-excited systems",
    authors="I. B. Shiroky, A. Papangelo, N. Hoffmann, O. V. Gendelman",
)


def page(report: Report) -> str:
    """Write the report as a self-contained HTML document."""
    script = _resource("script.js")
    return _rendered(
        "index.html.j2",
        report,
        title=f"A check of “{PAPER.title}”",
        policy=policy_for(script),
        script=_markup(script),
        toolkit=f"{TOOLKIT} {report.versions.get('toolkit') or ''}".strip(),
    )


def measurements_page(report: Report) -> str:
    """Write the stored measurements of the methods as a page of their own."""
    title = "Benchmarks and stability of the methods"
    return _rendered("methods.html.j2", report, title=title, policy=POLICY)


def policy_for(script: str) -> str:
    """Return the content security policy of a page with one script, which is on lines of its own.

    Any other script, and any handler in an attribute, does not match the digest and does not run.
    """
    digest = base64.b64encode(hashlib.sha256(f"\n{script}".encode()).digest()).decode()
    return f"{POLICY}; script-src 'sha256-{digest}'"


def _rendered(template: str, report: Report, *, policy: str, **names: object) -> str:
    made = _environment().get_template(template)
    return made.render(report=report, policy=_markup(policy), **names)


@functools.lru_cache(maxsize=1)
def _environment() -> Environment:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    made = Environment(
        loader=FunctionLoader(_resource),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals |= {
        "paper": PAPER,
        "docs": DOCS,
        "style": _markup(_resource("style.css")),
        "status": STATUS,
        "failed": FAILED,
        "max_named": MAX_NAMED,
        "in_row": IN_ROW,
    }
    made.filters |= {
        "base64": lambda text: base64.b64encode(text.encode()).decode(),
        "drawing": lambda *svg_prefix_title: _markup(inline_svg(*svg_prefix_title)),
        "duration": duration,
        "formula": lambda latex, **how: _markup(mathml.formula(latex, **how)),
        "grouped": grouped,
        "is_wide": lambda svg: (width_of(svg) or 0) > WIDE,
        "place": _place,
        "quantity": in_words,
        "typeset": lambda text: _markup(inline_math.typeset(text)),
        "versions": _versions,
    }
    return made


def _resource(name: str) -> str:
    return resources.files("paper_checks.report").joinpath(name).read_text(encoding="utf-8")


def _markup(html: str) -> Markup:
    """Mark text as HTML, so that it is not escaped again."""
    from markupsafe import Markup

    return Markup(html)


def _place(machine: Mapping[str, object]) -> str:
    """Describe the kind of machine."""
    return f"{machine['system']} {machine['architecture']}, {machine['cores']} cores"


def _versions(versions: Mapping[str, str | None]) -> str:
    """List packages with their versions, without those that are not installed."""
    return ", ".join(f"{name} {version}" for name, version in versions.items() if version)
