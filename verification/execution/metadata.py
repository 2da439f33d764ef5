"""The provenance of every stored result: command, parameters, versions, code, machine, date."""

from __future__ import annotations

import functools
import os
import platform
from collections.abc import Collection, Iterable, Mapping
from contextvars import ContextVar
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from verification.execution.digest import digest_of, digest_of_code
from verification.execution.imports import SOURCES

TOOLKIT = "excitation-fronts"
"""Name of the distribution."""

COMPUTING = ("numpy", "scipy", "mpmath", "sympy", "numba")
"""Packages with which the toolkit computes."""

CHANGED = "the code on which it depends has changed since"
UNKNOWN = "it does not state the code on which it depends"


def installed_versions(packages: Iterable[str] = COMPUTING) -> dict[str, str | None]:
    """Return the versions of Python, the toolkit and given packages; None if not installed.

    Examples
    --------
    >>> list(installed_versions(["numpy"]))
    ['python', 'toolkit', 'numpy']
    """
    found: dict[str, str | None] = {"python": platform.python_version()}
    found["toolkit"] = _version(TOOLKIT)
    return found | {package: _version(package) for package in packages}


@functools.cache
def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def this_machine() -> dict[str, Any]:
    """Return system, processor, cores and thread setting; nothing identifies the machine."""
    return {
        "system": platform.system(),
        "architecture": platform.machine(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "threads": os.environ.get("OMP_NUM_THREADS"),
    }


def now() -> str:
    """Return the date and time: UTC, ISO 8601, to the second."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


@functools.cache
def _processor() -> str:
    information = Path("/proc/cpuinfo")
    if information.is_file():
        for line in information.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"


@dataclass(frozen=True, kw_only=True)
class Code:
    """The code that a result depends on.

    Attributes
    ----------
    modules : tuple of str
        Dotted names of the modules from which it came, sorted.
    digest : str
        Digest of their code and of what they import
        (`verification.execution.digest.digest_of_code`).
    """

    modules: tuple[str, ...]
    digest: str

    @classmethod
    def of(
        cls,
        modules: Iterable[str],
        packages: Collection[str] = SOURCES,
    ) -> Code:
        """Return the present code of modules; parameters as in `digest_of_code`."""
        names = tuple(sorted(set(modules)))
        return cls(modules=names, digest=digest_of_code(names, packages))


COMMAND_LINE: ContextVar[str] = ContextVar("COMMAND_LINE", default="")
"""The command line being executed, for the files it writes; empty when used from Python."""


@dataclass(frozen=True, kw_only=True)
class Metadata:
    """The provenance of a stored result.

    Attributes
    ----------
    command : str
        The command that reproduces it, in the shell or in Python.
    parameters : mapping
        What was computed, as JSON data.
    versions : mapping of str to str or None
        Versions of Python, the toolkit and the packages used; None if not installed.
    code : Code or None
        The code it depends on; None if unknown.
    machine : mapping
        Where it was computed, as far as this matters for run times; no host name, no path.
    date : str
        Time of computation: UTC, ISO 8601, to the second.
    """

    command: str = ""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    versions: Mapping[str, str | None] = field(default_factory=installed_versions)
    code: Code | None = None
    machine: Mapping[str, Any] = field(default_factory=this_machine)
    date: str = field(default_factory=now)

    def to_dict(self) -> dict[str, Any]:
        """Return the entries as JSON data."""
        found = asdict(self)
        if self.code is not None:
            found["code"]["modules"] = list(self.code.modules)
        return found

    @classmethod
    def from_dict(cls, found: Mapping[str, Any]) -> Metadata:
        """Return the metadata that `to_dict` produced.

        Raises
        ------
        KeyError, TypeError
            If an entry is missing or of another kind.
        """
        code = found["code"]
        if code is not None:
            code = Code(modules=tuple(map(str, code["modules"])), digest=str(code["digest"]))
        return cls(
            command=str(found["command"]),
            parameters=dict(found["parameters"]),
            versions=dict(found["versions"]),
            code=code,
            machine=dict(found["machine"]),
            date=str(found["date"]),
        )


def staleness(code: Code | Mapping[str, Any] | None, packages: Collection[str] = SOURCES) -> str:
    """Return why a result no longer matches the present code; empty if it does.

    Parameters
    ----------
    code : Code, mapping or None
        Code of the result; a mapping as in `Metadata.to_dict`.
    packages : collection of str, optional
        As in `digest_of_code`.

    Examples
    --------
    >>> staleness(None)
    'it does not state the code on which it depends'
    >>> staleness(Code.of(["theory.parameters"]))
    ''
    """
    if not code:
        return UNKNOWN
    if not isinstance(code, Code):
        code = Code(modules=tuple(code["modules"]), digest=code["digest"])
    try:
        return "" if Code.of(code.modules, packages) == code else CHANGED
    except ValueError:
        return CHANGED


def differences(found: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """Return the differences between two sets of entries; keys of inner mappings follow a dot.

    Examples
    --------
    >>> differences({"c": 0.5, "versions": {"numpy": "1.0"}}, {"c": 0.6, "versions": {}})
    'c: 0.5 there, 0.6 here; versions.numpy: 1.0 there, None here'
    """
    parts = []
    for name in sorted({*found, *here}):
        there, ours = found.get(name), here.get(name)
        if digest_of(there) == digest_of(ours):  # 1 is not 1.0, and 0.0 not -0.0
            continue
        if isinstance(there, Mapping) and isinstance(ours, Mapping):
            inner = differences(there, ours)
            parts += [f"{name}.{part}" for part in inner.split("; ") if part]
        elif name == "digest" or len(f"{there}{ours}") > _LONGEST:
            parts.append(name)
        else:
            parts.append(f"{name}: {there} there, {ours} here")
    return "; ".join(parts)


_LONGEST = 80
