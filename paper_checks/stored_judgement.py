"""Judgements as plain data, for the store of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from paper_checks.finding import Erratum, Fault, Finding, Formula, Picture
from paper_checks.outcome import Judgement, checked_finding
from paper_checks.ruling import Verdict


def plain_judgement(judgement: Judgement) -> dict[str, Any]:
    """Return a judgement as JSON has it, without what says that it was stored."""
    return asdict(replace(judgement, stored=False, provenance=None, evidence=None))


def judgement_from(record: Mapping[str, Any]) -> Judgement:
    """Rebuild a judgement from plain data; it is marked as stored.

    Raises
    ------
    KeyError, TypeError, ValueError
        If the data are not those of a judgement.
    """
    fields = record["finding"]
    if not isinstance(fields, dict):
        raise TypeError("finding")
    methods = tuple(map(str, fields["methods"]))
    if len(methods) not in (1, 2):
        raise ValueError("methods")
    finding = Finding(
        **{
            **fields,
            "verdict": Verdict(fields["verdict"]),
            "methods": methods,
            "remarks": tuple(map(str, fields["remarks"])),
            "pictures": tuple(Picture(**picture) for picture in fields["pictures"]),
            "formulas": tuple(Formula(**formula) for formula in fields["formulas"]),
            "erratum": _erratum(fields["erratum"]),
        }
    )
    return Judgement(
        checked_finding(finding),  # a forged name of a picture would be a path elsewhere
        None,
        float(record["seconds"]),
        str(record["judged"]),
        True,
        shared=float(record.get("shared", 0.0)),
    )


def _erratum(fields: Mapping[str, str] | None) -> Erratum | None:
    if fields is None:
        return None
    rest = {name: text for name, text in fields.items() if name != "fault"}
    return Erratum(Fault(fields["fault"]), **rest)
