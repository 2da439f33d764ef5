"""CITATION.cff is a citation file of version 1.2.0, and says the version of the package."""

from __future__ import annotations

import datetime
import tomllib
from pathlib import Path
from typing import Any

import yaml

import fronts

ROOT = Path(__file__).parents[1]

KEYS = {
    "abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi",
    "identifiers", "keywords", "license", "license-url", "message", "preferred-citation",
    "references", "repository", "repository-artifact", "repository-code", "title", "type", "url",
    "version",
}  # fmt: skip
"""Those that the schema of the Citation File Format 1.2.0 knows; it allows no others."""

PLACE = {"address", "alias", "city", "country", "email", "fax", "orcid", "post-code", "region",
         "tel", "website"}  # fmt: skip
PERSON = PLACE | {"affiliation", "family-names", "given-names", "name-particle", "name-suffix"}
ENTITY = PLACE | {"date-end", "date-start", "location", "name"}


def test_the_citation_file_is_valid() -> None:
    cited: dict[str, Any] = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    assert {"authors", "cff-version", "message", "title"} <= set(cited) <= KEYS
    assert cited["cff-version"] == "1.2.0"
    assert cited["type"] in ("software", "dataset")
    assert isinstance(cited["date-released"], datetime.date)
    assert cited["license"] == "MIT"
    references = cited["references"]
    assert all({"authors", "title", "type"} <= set(each) for each in references)
    for author in [*cited["authors"], *(who for each in references for who in each["authors"])]:
        assert set(author) <= PERSON or ("name" in author and set(author) <= ENTITY)


def test_the_version_is_that_of_the_package() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert str(cited["version"]) == project["version"] == fronts.__version__
    changed = (ROOT / "CHANGELOG.md").read_text("utf-8")
    assert f"## [{project['version']}] - {cited['date-released']}" in changed


def test_every_extra_is_in_all() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
        "optional-dependencies"
    ]
    (everything,) = extras.pop("all")
    named = everything.partition("[")[2].rstrip("]").split(",")
    assert {"certify", "notebook", "docs", "bench"} <= set(extras)
    assert set(named) == set(extras) - {"dev"}
