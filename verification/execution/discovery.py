"""Discovery of what modules expose: claims, quantities, benchmarks."""

from __future__ import annotations

import importlib
import pkgutil
import re
from collections import Counter
from collections.abc import Iterable
from types import ModuleType
from typing import Any


def modules_of(package: str) -> tuple[ModuleType, ...]:
    """Import and return the modules directly in a package, in natural order.

    Parameters
    ----------
    package : str
        Dotted name. Modules whose names begin with an underscore and subpackages are omitted.

    Examples
    --------
    >>> [module.__name__ for module in modules_of("theory.averaged")][0]
    'theory.averaged.breather'
    """
    home = importlib.import_module(package)
    names = [each.name for each in pkgutil.iter_modules(home.__path__) if not each.ispkg]
    public = sorted((name for name in names if not name.startswith("_")), key=natural_order)
    return tuple(importlib.import_module(f"{package}.{name}") for name in public)


def exposed(package: str, name: str) -> dict[str, Any]:
    """Return what the modules of a package expose under a name, by module, as in ``"fig17"``.

    Modules that do not define the name are omitted.

    Examples
    --------
    >>> exposed("theory.averaged", "no_such_name")
    {}
    """
    return {
        module.__name__.rpartition(".")[2]: getattr(module, name)
        for module in modules_of(package)
        if hasattr(module, name)
    }


def check_distinct(what: str, names: Iterable[str]) -> None:
    """Refuse repeated names.

    Raises
    ------
    ValueError
        If a name occurs twice.

    Examples
    --------
    >>> check_distinct("claims", ["fig9", "fig9"])
    Traceback (most recent call last):
    ...
    ValueError: two claims have the name fig9.
    """
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise ValueError(f"two {what} have the name {', '.join(twice)}.")


def natural_order(name: str) -> list[str | int]:
    """Return a sort key that puts ``fig9`` before ``fig16``: words and numbers in turn.

    Examples
    --------
    >>> sorted(["fig16", "fig9"], key=natural_order)
    ['fig9', 'fig16']
    """
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", name)]
