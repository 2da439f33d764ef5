"""Conversion of evidence to plain data for JSON and back, without loss of a single bit."""

from __future__ import annotations

import importlib
import math
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

_KINDS = {"tuple": tuple, "set": set, "frozenset": frozenset}


def plain_evidence(value: object) -> Any:
    """Return evidence as JSON data: dataclasses, mappings and arrays of numbers and words.

    Raises
    ------
    TypeError
        If it contains anything else.
    """
    if isinstance(value, Enum):
        return {"member": value.name, "of": _name_of(type(value))}
    if isinstance(value, np.generic):
        return plain_evidence(value.item())
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"float": repr(value)}
    if isinstance(value, complex):
        return {"complex": [value.real, value.imag]}
    if isinstance(value, np.ndarray):
        flat = [plain_evidence(each) for each in value.ravel().tolist()]
        return {"array": flat, "shape": list(value.shape), "type": value.dtype.str}
    if isinstance(value, dict):
        return {"mapping": [[plain_evidence(key), plain_evidence(x)] for key, x in value.items()]}
    if isinstance(value, list):
        return [plain_evidence(each) for each in value]
    if isinstance(value, tuple | set | frozenset):
        ordered = value if isinstance(value, tuple) else sorted(value)
        return {type(value).__name__: [plain_evidence(each) for each in ordered]}
    if is_dataclass(value) and not isinstance(value, type):
        held = {x.name: plain_evidence(getattr(value, x.name)) for x in fields(value) if x.init}
        return {"object": held, "of": _name_of(type(value))}
    raise TypeError(f"evidence cannot hold {value!r}: give numbers, words, arrays, dataclasses.")


def evidence_from(plain: Any, packages: tuple[str, ...]) -> Any:
    """Return the evidence from the data of `plain_evidence`; its classes must be in given packages.

    Raises
    ------
    KeyError, TypeError, ValueError, AttributeError, ImportError
        If the data are not those of evidence, or their class has changed.
    """
    if isinstance(plain, list):
        return [evidence_from(each, packages) for each in plain]
    if not isinstance(plain, dict):
        return plain
    kind, held = next(iter(plain.items()))
    if kind == "float":
        return float(held)
    if kind == "complex":
        return complex(*held)
    if kind == "mapping":
        return {evidence_from(key, packages): evidence_from(x, packages) for key, x in held}
    if kind == "array":
        flat = [evidence_from(each, packages) for each in held]
        return np.array(flat, dtype=plain["type"]).reshape(plain["shape"])
    if kind in _KINDS:
        return _KINDS[kind](evidence_from(each, packages) for each in held)
    found = _class(plain["of"], packages)
    if kind == "member" and issubclass(found, Enum):
        return found[held]
    if kind == "object" and is_dataclass(found):
        return found(**{name: evidence_from(each, packages) for name, each in held.items()})
    raise ValueError(f"evidence holds a {kind}")


def _name_of(found: type) -> str:
    return f"{found.__module__}:{found.__qualname__}"


def _class(name: str, packages: tuple[str, ...]) -> type:
    module, _, name = name.partition(":")
    if module.partition(".")[0] not in packages:
        raise ValueError(f"evidence holds a {name} of {module}")
    found = getattr(importlib.import_module(module), name)
    if not isinstance(found, type):
        raise TypeError(f"{name} is no class")
    return found
