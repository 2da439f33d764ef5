"""Options of the friction chain (Model I) that several subcommands share."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from fronts.arguments import given, real

if TYPE_CHECKING:
    from theory.cells.friction import FrictionCell
    from verification.runs.excite import StartPoint

CELL = ("v_d", "mu_st", "mu_d", "v0", "xi")
"""Names of the options of one cell; each is None where it was not given."""

START = ("start_point",)
"""Name of the option of the point of the cycle."""


def add_cell_options(parser: argparse.ArgumentParser, v_d: bool = True) -> None:
    """Declare the parameters of one cell; the defaults are those of (7) and v_d = 1.25."""
    if v_d:
        parser.add_argument("--v-d", type=real, help="friction: velocity of the belt (1.25)")
    parser.add_argument("--mu-st", type=real, help="friction: static coefficient (1)")
    parser.add_argument("--mu-d", type=real, help="friction: dynamic coefficient (0.5)")
    parser.add_argument("--v0", type=real, help="friction: reference velocity of Eq. 2 (0.5)")
    parser.add_argument("--xi", type=real, help="friction: damping ratio (0.05)")


def add_start_option(parser: argparse.ArgumentParser) -> None:
    """Declare where on the cycle the excited sites start."""
    parser.add_argument(
        "--start-point",
        choices=("maximum", "minimum"),
        help="friction: point of the cycle from which excited sites start (maximum)",
    )


def cell_numbers(options: argparse.Namespace) -> dict[str, float]:
    """Return the parameters that were given, by name, but for v_d."""
    named = {name: getattr(options, name) for name in CELL if name != "v_d"}
    return {name: value for name, value in named.items() if value is not None}


def cell_of(options: argparse.Namespace) -> FrictionCell:
    """Return the cell that the options describe.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    """
    from theory.cells.friction import FrictionCell

    return FrictionCell(v_d=given(options.v_d, FrictionCell.v_d), **cell_numbers(options))


def start_point_of(options: argparse.Namespace) -> StartPoint:
    """Return the point of the cycle that the options name."""
    from verification.runs.excite import StartPoint

    return StartPoint(options.start_point or "maximum")
