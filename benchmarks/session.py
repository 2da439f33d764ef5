"""A whole measurement of one quantity: its points, its first calls, and which code they are of."""

from __future__ import annotations

from dataclasses import asdict, replace

from benchmarks.first_call import first_calls
from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Record
from verification.execution.metadata import Code


def measured(quantity: Quantity, quick: bool, tell: Tell) -> Record:
    """Return the record of a quantity; a quick one is without first calls."""
    code = asdict(Code.of([quantity.module, *quantity.code]))  # as it is at the start
    found = quantity.measure(quick, tell)
    calls = () if quick else first_calls(quantity, tell)
    return replace(found, first_calls=calls, code=code)
