"""Tables for tests, from rows written down."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from verification.execution.columns import Columns, cell_of
from verification.execution.table import Table, named_dims


def table_of(rows: Sequence[Mapping[str, object]]) -> Table:
    """Make a table from rows with the same names.

    Parameters
    ----------
    rows : sequence of mappings
        Names mapped to truth values, numbers, words, or arrays, with one shape for each name.

    Raises
    ------
    ParameterError
        If rows differ in their names or shapes, or a name or word would be misread in CSV.
    """
    columns = Columns(len(rows))
    for index, row in enumerate(rows):
        columns.put(index, {name: cell_of(value) for name, value in row.items()})
    return Table(arrays=columns.arrays(), dims=named_dims(columns.shapes, {}))
