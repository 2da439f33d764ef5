"""What every stored result says of itself: command, parameters, versions, code, machine, date."""

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

from verification.execution.digest import digest_of_code
from verification.execution.imports import SOURCES

TOOLKIT = "excitation-fronts"
"""Name of the distribution."""

COMPUTING = ("numpy", "scipy", "mpmath", "sympy", "numba")
"""Packages that the toolkit computes with."""

CHANGED = "the code it depends on has changed since"
UNKNOWN = "it does not say which code it depends on"


def installed_versions(packages: Iterable[str] = COMPUTING) -> dict[str, str | None]:
    """Return the versions of Python, the toolkit and some packages; None where not installed.

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
    """Return system, processor, cores and thread setting; nothing that identifies the machine."""
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
        Dotted names of the modules it came from, sorted.
    digest : str
        Of their code and of what they import (`verification.execution.digest.digest_of_code`).
    """

    modules: tuple[str, ...]
    digest: str

    @classmethod
    def of(
        cls,
        modules: Iterable[str],
        packages: Collection[str] = SOURCES,
    ) -> Code:
        """Return the code of modules as it is now; parameters as of `digest_of_code`."""
        names = tuple(sorted(set(modules)))
        return cls(modules=names, digest=digest_of_code(names, packages))


COMMAND_LINE: ContextVar[str] = ContextVar("COMMAND_LINE", default="")
"""The command line that is carried out, for the files of what it computes; empty in Python."""


@dataclass(frozen=True, kw_only=True)
class Metadata:
    """What a stored result says of itself.

    Attributes
    ----------
    command : str
        What gives it again, at the shell or in Python.
    parameters : mapping
        What was computed, as JSON has it.
    versions : mapping of str to str or None
        Of Python, the toolkit and the packages computed with; None where not installed.
    code : Code or None
        The code it depends on; None if that is not known.
    machine : mapping
        Where it was computed, as far as that matters for run times; no host name, no path.
    date : str
        When: UTC, ISO 8601, to the second.
    """

    command: str = ""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    versions: Mapping[str, str | None] = field(default_factory=installed_versions)
    code: Code | None = None
    machine: Mapping[str, Any] = field(default_factory=this_machine)
    date: str = field(default_factory=now)

    def to_dict(self) -> dict[str, Any]:
        """Return the entries as JSON has them."""
        found = asdict(self)
        if self.code is not None:
            found["code"]["modules"] = list(self.code.modules)
        return found

    @classmethod
    def from_dict(cls, found: Mapping[str, Any]) -> Metadata:
        """Return the metadata that `to_dict` gave.

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
    """Return why a result no longer is of the code that is here; empty if it is.

    Parameters
    ----------
    code : Code, mapping or None
        Of the result; a mapping as `Metadata.to_dict` has it.
    packages : collection of str, optional
        As of `digest_of_code`.

    Examples
    --------
    >>> staleness(None)
    'it does not say which code it depends on'
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
    """Return what differs between two sets of entries, those of inner mappings with a dot.

    Examples
    --------
    >>> differences({"c": 0.5, "versions": {"numpy": "1.0"}}, {"c": 0.6, "versions": {}})
    'c: 0.5 there, 0.6 here; versions.numpy: 1.0 there, None here'
    """
    parts = []
    for name in sorted({*found, *here}):
        there, ours = found.get(name), here.get(name)
        if there == ours:
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
