"""Options that several subcommands share: numbers, ranges ``low:high:count``, output files."""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from fronts.answer import UsageError

MOST_POINTS = 100_000


def real(text: str) -> float:
    """Read one number; ranges and ``nan`` checks are left to the theory's own validation."""
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number") from None


def real_or_range(text: str) -> float | tuple[float, float, int]:
    """Read ``0.5`` or ``low:high:count``.

    Examples
    --------
    >>> real_or_range("0.5"), real_or_range("0.3:3:200")
    (0.5, (0.3, 3.0, 200))
    """
    if ":" not in text:
        return real(text)
    parts = text.split(":")
    if len(parts) != 3:
        raise argparse.ArgumentTypeError(f"'{text}' is not low:high:count, as in 0.3:3:200")
    low, high = real(parts[0]), real(parts[1])
    try:
        count = int(parts[2])
    except ValueError:
        raise argparse.ArgumentTypeError(f"the count '{parts[2]}' is not a whole number") from None
    if not 2 <= count <= MOST_POINTS:
        raise argparse.ArgumentTypeError(f"the count {count} must be from 2 to {MOST_POINTS}")
    return low, high, count


def decimal(text: str) -> str:
    """Check that the text is a number and keep it as text, so that no digit is lost."""
    real(text)
    return text


def add_eta_options(
    parser: argparse.ArgumentParser, kind: Callable[[str], float | tuple[float, float, int]]
) -> None:
    """Declare ``--eta``, and ``--a`` with ``--b`` in its place; ``kind`` reads ``--eta``."""
    parser.add_argument("--eta", type=kind, help="b/a^2; two limit cycles exist below 1/8")
    parser.add_argument("--a", type=real, help="damping coefficient a, with --b, for --eta")
    parser.add_argument("--b", type=real, help="damping coefficient b, with --a, for --eta")


def eta_of(options: argparse.Namespace) -> Any:
    """Return η as given, or from a and b.

    Raises
    ------
    UsageError
        If it is given twice or not at all.
    """
    given = (options.a is not None, options.b is not None)
    if options.eta is not None:
        if any(given):
            raise UsageError("--eta and --a, --b say the same thing twice: give one of them.")
        return options.eta
    if not all(given):
        raise UsageError("give --eta, or both --a and --b.")
    from theory.unit_cell import eta_from_damping

    return eta_from_damping(options.a, options.b)


def given(value: Any, default: Any) -> Any:
    """Return an option as it was given, or the default of the model that was named."""
    return default if value is None else value


def refuse(options: argparse.Namespace, names: Iterable[str], model: str) -> None:
    """Refuse options that belong to other models than the one that was named.

    Raises
    ------
    UsageError
        If one was given.
    """
    for name in names:
        if getattr(options, name) is not None:
            flag = name.replace("_", "-")
            raise UsageError(f"--{flag} has no meaning for the model {model}.")


def refuse_other_methods(options: argparse.Namespace, owners: Mapping[str, str]) -> None:
    """Refuse options of another ``--method`` than the one that was named; by option, its method.

    Raises
    ------
    UsageError
        If one was given, or a seed is negative.
    """
    for name, method in owners.items():
        if getattr(options, name) is not None and options.method != method:
            raise UsageError(f"--{name} is for --method {method}: leave it out.")
    if (getattr(options, "seed", None) or 0) < 0:
        raise UsageError(f"--seed {options.seed} must not be negative.")


def check_writable(path: Path, suffixes: tuple[str, ...] = (), option: str = "--out") -> Path:
    """Refuse early, before any work, a path that cannot be written.

    Raises
    ------
    UsageError
        If the folder does not exist or may not be written, the path is a folder, or its suffix
        is not one of ``suffixes`` (if any are named). The folder is tried, not asked: permissions
        say nothing of file systems that refuse.
    """
    if suffixes and path.suffix.lower() not in suffixes:
        raise UsageError(f"{option} {path} must end in {' or '.join(suffixes)}.")
    folder = path.parent
    if path.is_dir():
        raise UsageError(f"{option} {path} is a folder: name a file in it.")
    if not folder.is_dir():
        raise UsageError(f"{option} {path} cannot be written: the folder {folder} does not exist.")
    if path.exists() and not os.access(path, os.W_OK):
        raise UsageError(f"{option} {path} cannot be written: no permission on {path}.")
    try:
        _neighbour(path).unlink()
    except OSError as error:
        raise UsageError(f"{option} {path} cannot be written: {error.strerror}.") from None
    return path


def same_file(one: Path, other: Path) -> bool:
    """Tell whether two names lead to one file, whether it exists or not.

    Examples
    --------
    >>> same_file(Path("run.npz"), Path("./run.npz"))
    True
    """
    return one.resolve() == other.resolve()


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Write a file so that it is there whole or not at all.

    ``write`` fills a temporary neighbour with the same suffix, which then takes the name.
    """
    temporary = _neighbour(path)
    try:
        write(temporary)
        mode = 0o666 & ~_umask()
        temporary.chmod(mode)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _neighbour(path: Path) -> Path:
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=path.suffix, prefix=".writing-")
    os.close(handle)
    return Path(name)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
