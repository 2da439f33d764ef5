"""``fronts profile``: the shape φ(ζ) of a front (49), as numbers, CSV or a picture."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import (
    add_eta_options,
    check_writable,
    eta_of,
    real,
    whole,
)
from verification.execution.files import write_by

if TYPE_CHECKING:
    from theory.piecewise.kinetic_relation import Branch
    from theory.piecewise.profile import FrontProfile

EXAMPLE = """examples:
  fronts profile --c 0.5 --eta 0.03125
  fronts profile --c 0.5 --a 4 --b 0.5 --out profile.png
  fronts profile --c 0.45 --eta 0.03125 --branch 1 --from -5 --to 5 --out profile.csv"""

_FARTHEST = 1e6


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts profile``."""
    parser.add_argument("--c", type=real, required=True, help="coupling c > 0")
    add_eta_options(parser, real)
    parser.add_argument(
        "--branch",
        type=whole,
        help="which solution, 1 the slowest (default: the fastest admissible)",
    )
    parser.add_argument("--from", dest="low", type=real, default=-8.0, help="first position")
    parser.add_argument("--to", dest="high", type=real, default=8.0, help="last position")
    parser.add_argument("--points", type=whole, default=321, help="number of positions")
    parser.add_argument("--out", type=Path, help="a file ending in .csv, .png, .svg or .pdf")


def run(options: argparse.Namespace) -> Answer:
    """Choose the branch, evaluate the profile, write it where asked."""
    if options.out is not None:
        check_writable(options.out, (".csv", ".png", ".svg", ".pdf"))
    import numpy as np

    from theory.cells.vdp import threshold_ratio
    from theory.parameters import ParameterError, count_within, within
    from theory.piecewise.kinetic_relation import kinetic_relation
    from theory.piecewise.profile import front_profile

    points = count_within("number of points", options.points, 2, 1_000_000)
    low = within("first position --from", options.low, -_FARTHEST, _FARTHEST)
    high = within("last position --to", options.high, -_FARTHEST, _FARTHEST)
    if not low < high:
        raise ParameterError(
            "last position --to", high, f"above the first, {low:g}", "give --to larger than --from"
        )
    answer = kinetic_relation(options.c, eta_of(options))
    if not answer.branches:
        raise UsageError(f"there is no travelling front to draw: {answer.reason}")
    branch = _chosen(answer.branches, options.branch)
    zeta = np.linspace(low, high, points)
    try:
        if branch.v > 0:
            shape = front_profile(zeta, branch.v, options.c)
            phi = shape.phi
        else:  # a retreating front is 1 - φ(-ζ) of the advancing one
            shape = front_profile(-zeta, -branch.v, options.c)
            phi = 1.0 - shape.phi
    except ArithmeticError as error:
        raise UsageError(str(error)) from None
    r = threshold_ratio(answer.eta)
    if options.out is not None:
        write = _write_table if options.out.suffix.lower() == ".csv" else _draw
        write_by(options.out, lambda path: write(path, zeta, phi, branch, r))
    payload: dict[str, object] = {
        "c": answer.c,
        "eta": answer.eta,
        "v": branch.v,
        "v_error": branch.error,
        "admissible": branch.admissible,
        "fails_at": branch.fails_at,
        "threshold": r,
        "zeta": zeta.tolist(),
        "re": phi.real.tolist(),
        "im": phi.imag.tolist(),
        "error": shape.error,
        "points": shape.points,
    }
    return Answer(payload, _in_words(branch, r, shape, options.out))


def _chosen(branches: tuple[Branch, ...], wanted: int | None) -> Branch:
    if wanted is not None:
        if not 1 <= wanted <= len(branches):
            last = len(branches)
            raise UsageError(
                f"--branch {wanted} does not exist: choose from 1 to {last} (ascending v).",
                quantity="--branch",
                value=wanted,
                allowed=f"from 1 to {last}",
                remedy="choose one of these, in ascending v",
            )
        return branches[wanted - 1]
    admissible = [branch for branch in branches if branch.admissible]
    return (admissible or list(branches))[-1]


def _in_words(branch: Branch, r: float, shape: FrontProfile, out: Path | None) -> str:
    if branch.admissible:
        verdict = "admissible: above threshold everywhere behind, below it everywhere ahead"
    elif branch.admissible is None:
        verdict = "admissibility was not decided"
    else:
        verdict = f"not admissible: it crosses the threshold again at zeta = {branch.fails_at:.4g}"
    lines = [
        f"v = {branch.v:.15g}, error below {branch.error:.1e}",
        verdict,
        f"threshold |phi_us|/|phi_s| = {r:.12g}; phi/phi_s is exact to {shape.error:.1e}",
    ]
    if out is not None:
        lines.append(f"written to {out}")
    return "\n".join(lines)


def _write_table(path: Path, zeta: Any, phi: Any, branch: Branch, r: float) -> None:
    import numpy as np

    table = np.column_stack([zeta, phi.real, phi.imag, np.abs(phi)])
    header = "zeta,re_phi,im_phi,abs_phi"
    np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.17g")


def _draw(path: Path, zeta: Any, phi: Any, branch: Branch, r: float) -> None:
    import numpy as np

    from paper_checks.pictures import COLOURS, new_axes, save

    figure, axes = new_axes("page", height=3.0, xlabel="ζ (sites)", ylabel=r"$\varphi/\varphi_s$")
    axes.plot(zeta, np.abs(phi), color=COLOURS["blue"], label=r"$|\varphi|$")
    axes.plot(zeta, phi.real, color=COLOURS["vermilion"], lw=0.9, ls="--", label=r"Re $\varphi$")
    axes.plot(zeta, phi.imag, color=COLOURS["green"], lw=0.9, ls=":", label=r"Im $\varphi$")
    axes.axhline(r, color="0.5", lw=0.8)
    axes.annotate("threshold", (zeta[-1], r), ha="right", va="bottom", fontsize=8, color="0.35")
    axes.legend(title=f"v = {branch.v:.6g}")
    save(path, figure)
