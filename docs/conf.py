"""Sphinx: how the site is built; ``make docs`` does it, into ``site/``, without a network."""

import re
import sys
from pathlib import Path
from typing import Any

import numpydoc.xref

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "extensions"))

import fronts  # noqa: E402

project = "Excitation fronts"
author = "The excitation-fronts developers"
project_copyright = "2026, the excitation-fronts developers"
version = release = fronts.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "sphinx_gallery.gen_gallery",
    "mathml_renderer",
    "generated_pages",
]
exclude_patterns = ["extensions", "tutorials", "gallery", "*_head.md", "**/sg_execution_times*"]
suppress_warnings = ["config.cache"]  # sphinx-gallery's settings hold functions

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3

html_theme = "pydata_sphinx_theme"
html_title = project  # with the version it would not fit beside the search on a phone
html_sidebars = {"start": [], "explore": []}  # pages without others below them
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "mathml"
html_context = {"default_mode": "auto"}
html_theme_options = {
    "show_toc_level": 2,
    "header_links_before_dropdown": 8,
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}

nitpicky = True
nitpick_ignore_regex = [("py:obj", ".*")]  # words in single backticks, most of them no reference
default_role = "autolink"
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autosummary_generate = True
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"
numpydoc.xref.DEFAULT_LINKS.clear()  # they lead to Python's own pages, on the network
classes = re.findall(
    r"autoclass:: (\S+)", (HERE / "reference" / "python.md").read_text(encoding="utf-8")
)
lasts = [name.rpartition(".")[2] for name in classes]
numpydoc_xref_aliases = {
    last: name for last, name in zip(lasts, classes, strict=True) if lasts.count(last) == 1
}

sphinx_gallery_conf = {
    "examples_dirs": ["tutorials", "gallery"],
    "gallery_dirs": ["generated/tutorials", "generated/gallery"],
    "filename_pattern": r"\.py$",
    "ignore_pattern": r"__init__\.py",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": True,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 0,
    "abort_on_example_error": True,
    "matplotlib_animations": (True, "jshtml"),
    "capture_repr": ("_repr_html_", "__repr__"),
    "ignore_repr_types": r"matplotlib|<class '(list|tuple)'>",  # what drawing returns
    "reset_modules": ("matplotlib", "pictures.look"),
    "parallel": 2,
    "write_computation_times": False,
}


def escape_bars(*called: Any) -> None:
    """Escape |x|, a modulus in this field and a substitution in reStructuredText."""
    lines: list[str] = called[-1]
    for place, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...", "..")):
            parts = re.split(r"(``.+?``)", line)
            parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
            lines[place] = "".join(parts)


def keep_local(app: object, document: str, source: list[str]) -> None:
    """Take the icons of an animation from the theme, and not from the network."""
    source[0] = re.sub(r"<link[^>]*font-?awesome[^>]*>", "", source[0], flags=re.S)


def setup(app: Any) -> None:
    """Connect both; the first after numpydoc, which rewrites the lines."""
    app.connect("source-read", keep_local)
    app.connect("autodoc-process-docstring", escape_bars, priority=900)
