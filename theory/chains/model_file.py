"""Model files, which contain the attributes of a chain in TOML."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from theory.chains.coupling import is_file
from theory.chains.site_text import read_shape
from theory.chains.site_values import pairs
from theory.parameters import ParameterError


def read_model(
    path: Path, known: Sequence[str], changes: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Return the attributes in a model file, some of them changed.

    Parameters
    ----------
    path : Path
        The model file, in TOML; a file of weights is searched for in the same directory.
    known : sequence of str
        Names of the attributes.
    changes : mapping or None
        Attributes that replace those in the file; in ``values`` and ``disorder`` only the named
        entries are replaced.

    Raises
    ------
    ParameterError
        If the file cannot be read, or contains a key that is not an attribute.
    """
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise ParameterError(
            "model file", path, f"a readable file in the format TOML ({why})",
            "correct the file, or name another one",
        ) from None  # fmt: skip
    for key in found:
        if key not in known:
            raise ParameterError(
                f"key in {path.name}", key, f"one of {', '.join(known)}", "rename it"
            )
    coupling = found.get("coupling", "")
    if is_file(coupling):
        found["coupling"] = str(path.parent / coupling)
    sites = found.get("sites")
    if isinstance(sites, str):
        try:
            found["sites"] = read_shape(sites)
        except ValueError:
            raise ParameterError("sites", repr(sites), "rows x columns", "as in 60x60") from None
    if "sites" in (changes or {}):
        found.pop("shape", None)
    for key, value in (changes or {}).items():
        named = key in ("values", "disorder") and key in found
        found[key] = {**pairs(key, found[key]), **pairs(key, value)} if named else value
    return found
