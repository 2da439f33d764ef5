"""Discovery of the claims: every module of ``paper_checks.claims`` that exposes ``CLAIMS``."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from paper_checks.claim import Claim
from verification.execution.discovery import modules_of
from verification.pictures.figures import NAME

PACKAGE = "paper_checks.claims"
"""The package that contains the claims of the paper."""


@dataclass(frozen=True)
class Entry:
    """A claim and the module that contains it.

    Attributes
    ----------
    group : str
        Name of the module without its package, as in ``fig17``.
    claim : Claim
        The claim.
    """

    group: str
    claim: Claim


class UnknownKeyError(ValueError):
    """A key that is neither that of a claim nor that of a group of claims."""


def find_entries(package: str | None = None) -> tuple[Entry, ...]:
    """Import every module of a package and collect its claims.

    Parameters
    ----------
    package : str, optional
        Dotted name of the package; by default `PACKAGE`. Modules whose names begin with an
        underscore are skipped: they contain code shared by several modules.

    Returns
    -------
    tuple of Entry
        Modules in natural order (``fig9`` before ``fig16``), claims in the order of their module.

    Raises
    ------
    ValueError
        If a module lacks ``CLAIMS``, or a key is malformed or used twice.
    """
    entries: list[Entry] = []
    seen: dict[str, str] = {}
    for module in modules_of(package or PACKAGE):
        group = module.__name__.rpartition(".")[2]
        if not hasattr(module, "CLAIMS"):
            raise ValueError(f"{module.__name__} has no CLAIMS: give it a tuple of Claim.")
        for claim in module.CLAIMS:
            if not NAME.fullmatch(claim.key):
                raise ValueError(
                    f"the key '{claim.key}' in {group} must be lower-case letters, digits, "
                    "dots, hyphens or underscores."
                )
            if claim.key in seen:
                raise ValueError(f"the key '{claim.key}' is in {seen[claim.key]} and in {group}.")
            seen[claim.key] = group
            entries.append(Entry(group, claim))
    return tuple(entries)


def select(entries: Sequence[Entry], keys: Iterable[str]) -> tuple[Entry, ...]:
    """Select the claims named by keys, in their original order; without keys, all of them.

    Parameters
    ----------
    entries : sequence of Entry
        The claims to choose from.
    keys : iterable of str
        Keys of claims, or names of modules, which stand for all their claims.

    Raises
    ------
    UnknownKeyError
        If a key is unknown; the message suggests the nearest names.
    """
    asked = list(keys)
    known = {entry.group for entry in entries} | {entry.claim.key for entry in entries}
    for key in asked:
        if key not in known:
            near = difflib.get_close_matches(key, sorted(known), n=3)
            hint = f"did you mean {' or '.join(near)}? " if near else ""
            raise UnknownKeyError(
                f"'{key}' is neither a claim nor a group of claims: "
                f"{hint}'fronts check --list' shows all."
            )
    if not asked:
        return tuple(entries)
    chosen = set(asked)
    return tuple(e for e in entries if e.group in chosen or e.claim.key in chosen)
