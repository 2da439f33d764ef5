"""Results written to files: the formats, and the provenance that every file contains.

A file contains the command, the parameters and the versions: as keys of a .json file, as an array
``provenance`` of a .npz file and an attribute of a .zarr file, as lines beginning with ``#`` at the
end of a .csv file, and in the metadata of a picture or film. The date is not included, so that the
same command writes the same file. What the table of a result does not hold, such as the frequency
of a breather beside its amplitudes, is written in the same places under the name ``result``. Only
the .json file of a curve contains the lists of each point, such as the amplitudes of all sites.

In a .csv file these lines are at the end, so that the first line contains the names, as
spreadsheets and ``numpy.genfromtxt(path, delimiter=",", names=True)`` require;
``pandas.read_csv(path, comment="#")`` accepts them anywhere.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, fields
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import UsageError
from fronts.arguments import check_writable
from theory.result import Result, is_cell, json_value, optional_package
from verification.execution.files import write_by, write_csv
from verification.execution.metadata import COMMAND_LINE, installed_versions
from verification.execution.table import commented, zarr_writer

if TYPE_CHECKING:
    import numpy as np

PICTURES = (".png", ".svg", ".pdf")
FILMS = (".gif", ".mp4")
FORMATS = (".csv", ".json", ".npz", ".zarr", *PICTURES)
"""Formats for every result; a simulation can be written as a film too."""

_Mapping = Mapping[str, Any]


def check_files(
    paths: Sequence[tuple[Path, str]], filmed: bool, formats: Sequence[str] = FORMATS
) -> None:
    """Refuse files that cannot be written or are named twice, before any work is done.

    Parameters
    ----------
    paths : sequence of (Path, str)
        The files, each with the option by which it was named.
    filmed : bool
        Whether the result can be written as a film.
    formats : sequence of str, optional
        Allowed endings.

    Raises
    ------
    UsageError
        If there is such a file.
    MissingPackageError
        If a file needs a package that is not installed.
    """
    seen: dict[Path, Path] = {}
    for path, option in paths:
        check_writable(path, (*formats, *FILMS) if filmed else tuple(formats), option)
        if path.suffix.lower() == ".zarr":
            optional_package("zarr")
        if path.resolve() in seen:
            raise UsageError(
                f"{seen[path.resolve()]} and {path} are the same file: name two different ones."
            )
        seen[path.resolve()] = path


def check_pictured(out: Sequence[Path], function: Callable[..., Any]) -> None:
    """Refuse a picture, before any work is done, if the result of a function cannot be drawn.

    Raises
    ------
    UsageError
        If it cannot be drawn.
    """
    from fronts.pictures import need_picture

    for path in out:
        if path.suffix.lower() in PICTURES:
            try:
                need_picture(re.findall(r"\w+", function.__annotations__["return"]))
            except TypeError as error:
                raise _no_file(path, error) from None


@dataclass(frozen=True, kw_only=True)
class Listing(Result):
    """An answer of a command that consists of rows.

    Attributes
    ----------
    payload : mapping
        The answer as a JSON object.
    listed : sequence of mapping
        One mapping per row, all with the same names.
    """

    payload: Mapping[str, Any]
    listed: Sequence[Mapping[str, Any]]

    def to_dict(self) -> dict[str, Any]:
        """Return the answer as the command prints it with ``--json``."""
        return dict(self.payload)

    def columns(self) -> dict[str, np.ndarray]:
        """Return the rows as a table; lists and mappings are written as JSON."""
        import numpy as np

        names = list(self.listed[0]) if self.listed else []
        return {
            name: np.array([_simple(row[name]) for row in self.listed], dtype=object)
            for name in names
        }


def _simple(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, (list, tuple, dict)) else value


def write_result(
    path: Path,
    result: Result,
    parameters: Mapping[str, Any],
    payload: Mapping[str, Any] | None = None,
) -> None:
    """Write a result in the format given by the ending of the file, completely or not at all.

    Parameters
    ----------
    path : Path
        Name of the file, with an ending in `FORMATS`.
    result : Result
        The result.
    parameters : mapping
        The parameters of the computation, including defaults; they are written together with the
        command line and the versions.
    payload : mapping, optional
        The answer of a command as JSON, if it contains more than the result itself.

    Raises
    ------
    UsageError
        If the result cannot be written as a table, or cannot be drawn.
    """
    writer = _WRITERS.get(path.suffix.lower(), _picture)
    provenance = {
        "command": COMMAND_LINE.get(),
        "parameters": json_value(parameters),
        "versions": installed_versions(),
    }
    try:
        write = writer(result, result.to_dict() if payload is None else payload, provenance)
    except TypeError as error:
        raise _no_file(path, error) from None
    write_by(path, write)


def _no_file(path: Path, error: TypeError) -> UsageError:
    return UsageError(f"{path} cannot be written: {error}", quantity="--out", value=path)


def _json(result: Result, payload: _Mapping, provenance: _Mapping) -> Callable[[Path], None]:
    text = json.dumps({**payload, "provenance": provenance}, allow_nan=False, indent=1)
    return lambda path: _write_text(path, text + "\n")


def _csv(result: Result, payload: _Mapping, provenance: _Mapping) -> Callable[[Path], None]:
    table = as_table(result)
    stream = StringIO(newline="")
    write_csv(stream, table, zip(*table.values(), strict=True))
    if beside := _beside(payload, {*table, *result.in_columns}):
        stream.write(commented({"result": beside}, ["result"]))
    stream.write(commented(provenance, provenance))
    return lambda path: _write_text(path, stream.getvalue())


def _beside(payload: _Mapping, table: Collection[str]) -> dict[str, Any]:
    """Return the entries of an answer that a table with these columns does not hold.

    Lists of mappings are the rows of a table. The run time is omitted, which differs each time.

    Examples
    --------
    >>> answer = {"v": 0.5, "of": {"c": 1}, "at": [1, 2], "points": [{"v": 0.5}], "seconds": 1.0}
    >>> _beside(answer, ["v", "of_c"])
    {'at': [1, 2]}
    """

    def held(name: str, value: Any) -> bool:
        if isinstance(value, dict):
            return name in table or all(f"{name}_{key}" in table for key in value)
        rows = isinstance(value, list) and not all(map(is_cell, value))
        return rows or name in table or name == "seconds"

    return {name: value for name, value in payload.items() if not held(name, value)}


def as_table(result: Result) -> dict[str, list[Any]]:
    """Return a result as columns of Python values: its table, or one row with its numbers.

    Examples
    --------
    >>> from fronts.piecewise.roots import Root
    >>> as_table(Root(label=0, re=0.1, im=0.2, residual=0.0, radius=1e-15))["re"]
    [0.1]
    """
    try:
        return {name: column.tolist() for name, column in result.columns().items()}
    except TypeError:
        return {name: [value] for name, value in result.row().items() if is_cell(value)}


def _npz(result: Result, payload: _Mapping, provenance: _Mapping) -> Callable[[Path], None]:
    import numpy as np

    own = getattr(result, "arrays", None)
    arrays: dict[str, Any] = {}
    if own is not None:
        arrays = own()
    elif not result.is_curve:  # the columns of a curve contain the data of its points
        arrays = {
            each.name: getattr(result, each.name)
            for each in fields(result)  # type: ignore[arg-type]
            if isinstance(getattr(result, each.name), np.ndarray)
        }
    if not arrays:
        arrays = {name: _array(values) for name, values in as_table(result).items()}
    listed = {name for name, value in payload.items() if isinstance(value, list)}
    arrays |= {
        "result": np.array(json.dumps(_beside(payload, listed & {*arrays, *result.in_columns}))),
        "parameters": np.array(json.dumps(provenance["parameters"])),
        "provenance": np.array(json.dumps(provenance)),
    }
    return lambda path: np.savez_compressed(path, **arrays)


def _zarr(result: Result, payload: _Mapping, provenance: _Mapping) -> Callable[[Path], None]:
    try:
        dataset = result.to_xarray()
    except TypeError:  # one row
        columns = {name: ("row", _array(values)) for name, values in as_table(result).items()}
        dataset = optional_package("xarray").Dataset(columns)
    names = {*map(str, dataset.variables), *result.in_columns}
    beside = json.dumps(_beside(payload, names))
    return zarr_writer(dataset.assign_attrs(result=beside), provenance)


def _array(values: list[Any]) -> Any:
    """Return a column as an array that can be stored without pickle: of numbers, or of text.

    Among numbers and truth values a missing one is nan, and the others are numbers, as in zarr.

    Examples
    --------
    >>> _array([True, None, False])
    array([ 1., nan,  0.])
    """
    import numpy as np

    column = np.array(values)
    if column.dtype.kind != "O":
        return column
    if all(value is None or isinstance(value, (bool, int, float)) for value in values):
        return np.array(values, dtype=float)
    return np.array(["" if value is None else str(value) for value in values])


def _picture(result: Result, payload: _Mapping, provenance: _Mapping) -> Callable[[Path], None]:
    import matplotlib as mpl

    from verification.pictures.figures import CHANGING, new_axes

    figure, axes = new_axes("page", height=3.6)
    result.plot(axes)
    figure.set_layout_engine("compressed")  # avoids an empty margin beside a lattice
    text = json.dumps(provenance)

    def write(path: Path) -> None:
        kind = path.suffix.lower().removeprefix(".")
        with mpl.rc_context({"svg.hashsalt": "fronts"}):
            metadata = {_NOTE[kind]: text, **dict.fromkeys(CHANGING[kind])}
            figure.savefig(path, dpi=200, metadata=metadata)

    return write


def _film(result: Result, payload: _Mapping, provenance: _Mapping) -> Callable[[Path], None]:
    from fronts.animation import animate
    from verification.execution.progress import Progress
    from verification.runs.trajectory import Trajectory

    if not isinstance(result, Trajectory):
        raise TypeError(
            f"a result of the class {type(result).__name__} cannot be written as a film."
        )
    run, text = result, json.dumps(provenance)

    def write(path: Path) -> None:
        with Progress("film", quiet="--json" in COMMAND_LINE.get().split()) as live:
            animate(run, path, note=text, progress=live.report)

    return write


_NOTE = {"png": "Description", "svg": "Description", "pdf": "Subject"}
"""Name of the metadata entry for a text in each kind of picture."""

_WRITERS: dict[str, Callable[[Result, _Mapping, _Mapping], Callable[[Path], None]]] = {
    ".json": _json,
    ".csv": _csv,
    ".npz": _npz,
    ".zarr": _zarr,
    **dict.fromkeys(FILMS, _film),
}


def _write_text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="")
