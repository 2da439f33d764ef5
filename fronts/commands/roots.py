"""``fronts roots``: labelled roots of the dispersion relation (50) in both half-planes."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import decimal, real, whole
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from theory.piecewise.roots import RootSet

EXAMPLE = """examples:
  fronts roots --v 0.3 --c 0.5 --count 8
  fronts roots --v 0.3 --c 0.5 --extent 40 --certify --json
  fronts roots --v 0.3 --c 0.5 --count 4 --digits 40"""

_DOUBLE = 15
_MOST_SHOWN = 100_000
_MOST_DIGITS = 10_000_000
"""Roots times digits in one half-plane, beyond double precision: some minutes."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts roots``."""
    parser.add_argument("--v", type=decimal, required=True, help="front velocity v > 0")
    parser.add_argument("--c", type=decimal, required=True, help="coupling c > 0")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--count", type=whole, help="the roots nearest 0, in each half-plane")
    which.add_argument("--extent", type=real, help="every root with |Re k| up to this")
    parser.add_argument("--digits", type=whole, default=_DOUBLE, help="digits wanted (default 15)")
    parser.add_argument(
        "--certify", action="store_true", help="enclose and count in ball arithmetic"
    )


def run(options: argparse.Namespace) -> Answer:
    """Find, count and, if asked, certify the roots."""
    from theory.parameters import count_within
    from theory.piecewise.roots import nearest_roots, roots_within

    v, c = float(options.v), float(options.c)
    digits = count_within("digits", options.digits, 1, 2000)
    halves: dict[str, RootSet] = {}
    for half, upper in (("upper", True), ("lower", False)):
        if options.extent is not None:
            halves[half] = roots_within(v, c, options.extent, upper)
        else:
            count = count_within("root count", options.count or 10, 1, _MOST_SHOWN)
            if options.count == 0:
                count_within("root count", 0, 1, _MOST_SHOWN)
            halves[half] = nearest_roots(v, c, count, upper)
    if digits > _DOUBLE:
        most = max(roots.labels.size for roots in halves.values())
        remedy = "ask for fewer roots or digits"
        count_within("roots times digits", most * digits, 0, _MOST_DIGITS, remedy)
    counted = sum(_counted(v, c, roots, half == "upper") for half, roots in halves.items())
    if options.certify:
        halves = {half: _certified(v, c, roots, half == "upper") for half, roots in halves.items()}
    payload: dict[str, object] = {
        half: _rows(options.v, options.c, roots, half == "upper", digits)
        for half, roots in halves.items()
    }
    payload |= {"counted": counted, "certified": bool(options.certify)}
    return Answer(payload, _table(payload))


def _counted(v: float, c: float, roots: RootSet, upper: bool) -> int:
    """Count the roots by the argument principle, in a box about exactly these strips."""
    import numpy as np

    from theory.piecewise.root_count import count_in_strips

    if roots.labels.size == 0:
        return 0
    labels = np.arange(roots.labels.min(), roots.labels.max() + 1)
    others = labels.size - roots.labels.size
    return count_in_strips(v, c, labels, upper) - others


def _certified(v: float, c: float, roots: RootSet, upper: bool) -> RootSet:
    """Return the same roots with certified radii."""
    import numpy as np

    from theory.piecewise.certified_roots import CertificationError, certify_roots

    if roots.labels.size == 0:
        return roots
    labels = np.arange(roots.labels.min(), roots.labels.max() + 1)
    try:
        certified = certify_roots(v, c, labels, upper).roots
    except CertificationError as error:
        raise UsageError(f"not certified: {error}") from None
    return certified.take(roots.labels - labels[0])


def _rows(v: str, c: str, roots: RootSet, upper: bool, digits: int) -> list[dict[str, Any]]:
    if digits <= _DOUBLE:
        columns = (roots.labels, roots.k.real, roots.k.imag, roots.residual, roots.radius)
        names = ("label", "re", "im", "residual", "radius")
        return [
            dict(zip(names, row, strict=True))
            for row in zip(*(column.tolist() for column in columns), strict=True)
        ]
    import mpmath as mp

    from theory.piecewise.precise_roots import exact, precise_roots

    rows = []
    half = "upper" if upper else "lower"
    with mp.workdps(digits + 10), Progress(f"digits of the {half} roots") as live:
        v_, c_ = exact(v), exact(c)
        for done, label in enumerate(roots.labels.tolist()):
            live.report(done / roots.labels.size)
            (k,) = precise_roots(v, c, roots.labels[done : done + 1], upper, digits)
            residual = abs(mp.mpf(0.5) - 2j * c_ * mp.sin(k / 2) ** 2 - 1j * v_ * k)
            printed = abs(k) * mp.mpf(10) ** (1 - digits)  # what printing so many digits costs
            radius = 2 * residual / abs(v_ + c_ * mp.sin(k)) + printed
            rows.append(
                {
                    "label": label,
                    "re": mp.nstr(k.real, digits),
                    "im": mp.nstr(k.imag, digits),
                    "residual": float(residual),
                    "radius": float(radius),
                }
            )
    return rows


def _table(payload: dict[str, Any]) -> str:
    lines = []
    for half in ("upper", "lower"):
        lines.append(
            f"{half} half-plane\n  label  Re k                    Im k                    radius"
        )
        lines += [
            f"  {row['label']:>5}  {_cell(row['re'])}  {_cell(row['im'])}  {row['radius']:.1e}"
            for row in payload[half]
        ]
    certified = "; every radius and the count certified" if payload["certified"] else ""
    lines.append(f"{payload['counted']} roots by the argument principle{certified}")
    return "\n".join(lines)


def _cell(value: float | str) -> str:
    return f"{value:<22.16g}" if isinstance(value, float) else f"{value:<22}"
