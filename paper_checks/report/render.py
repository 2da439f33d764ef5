"""The report as HTML that needs nothing but itself: one page, and one of measurements.

The pages are templates of Jinja beside this module, ``index.html.j2`` and ``methods.html.j2``. What
they are given as text is escaped; the filters here return HTML.
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
"""The page itself forbids the browser every request, to the network or to other files, and every
script; the report's page allows its own one, by its digest (`policy_for`)."""

DOCS = "../site/index.html"
"""The documentation as ``make docs`` builds it, beside the report of ``make paper``."""

MAX_NAMED = 5
"""More changed verdicts than these are folded away, so that the first screen stays one."""

WIDE = 300
"""Pictures wider than this, in points, do not fit a phone."""

IN_ROW = 280
"""Characters of LaTeX of an equation that a closed row has room for."""

STATUS = {slug(verdict): verdict.value for verdict in Verdict} | {FAILED: "judge failed"}
"""Words for each status."""


@dataclass(frozen=True)
class Paper:
    """The paper that is judged."""

    title: str
    authors: str


PAPER = Paper(
    "Nucleation and propagation of excitation fronts in self-excited systems",
    "I. B. Shiroky, A. Papangelo, N. Hoffmann, O. V. Gendelman",
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
    """Return the content security policy of a page with one script, written on a line of its own.

    A handler in an attribute, and any other script, is not of this digest and does not run.
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
    """Mark text as HTML already, which is not escaped again."""
    from markupsafe import Markup

    return Markup(html)


def _place(machine: Mapping[str, object]) -> str:
    """Write what kind of machine it was."""
    return f"{machine['system']} {machine['architecture']}, {machine['cores']} cores"


def _versions(versions: Mapping[str, str | None]) -> str:
    """Write packages with their versions, without those that are not installed."""
    return ", ".join(f"{name} {version}" for name, version in versions.items() if version)
