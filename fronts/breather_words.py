"""Breathers in words: what one method found, and several methods side by side."""

from __future__ import annotations

import math
from typing import Any


def breather_in_words(found: dict[str, Any]) -> str:
    """Say what one method found."""
    if found["status"] == "none":
        fold = found.get("fold")
        where = "" if fold is None else f" The branch folds at c = {fold:.10g}."
        return f"none: there is no such breather at c = {found['c']:g}.{where}"
    if found["status"] == "escaped":
        return (
            f"escaped: by t = {found['time']:.6g} a site at rest passed the unstable cycle.\n"
            "  The run does not tell whether there is an unstable breather at "
            f"c = {found['c']:g}; --method orbit does.\n  {found['seconds']:.3f} s"
        )
    shown = "  ".join(f"{value:.6g}" for value in found["amplitudes"][:8])
    error = found["error"]
    lines = [
        f"{found['status']}: {_STABILITY[found['stable']]}"
        + (f", pattern {found['pattern']}" if found["pattern"] else ""),
        f"  amplitudes, centre outwards: {shown}",
        f"  frequency {found['frequency']:.12g}, outward phase step {found['phase_step']:.6f}",
    ]
    if found.get("growth") is not None:
        lines.append(f"  largest growth rate per unit of slow time: {found['growth']:.6g}")
    if found.get("trivial") is not None:
        lines.append(f"  trivial exponent or multiplier off by {found['trivial']:.1e}")
    if found.get("error_unknown"):
        lines.append(f"  error against the periodic orbit of (8) unknown: {found['error_unknown']}")
    elif found["method"] in ("closed-form", "envelope"):
        lines.append(
            f"  error against the periodic orbit of (8): {error:.1e} of the amplitudes, "
            f"{found['frequency_error']:.1e} of the frequency"
        )
    elif error is not None:
        lines.append(f"  error {error:.1e}")
    lines.append(f"  {found['seconds']:.3f} s")
    return "\n".join(lines)


_STABILITY = {True: "stable", False: "not stable", None: "stability not decided"}


def breather_table(methods: dict[str, dict[str, Any]]) -> str:
    """Show the methods side by side."""
    lines = [
        f"{'method':12} {'status':9} {'centre':>10} {'neighbour':>10} {'frequency':>12} "
        f"{'phase step':>10} {'growth':>10} {'error':>8} {'seconds':>8}"
    ]
    for name, found in methods.items():
        cells = [f"{name:12} {found['status']:9}"]
        if found["status"] == "none":
            cells.append("" if found.get("fold") is None else f"folds at c = {found['fold']:.8g}")
        elif found["status"] == "escaped":
            cells.append(f"by t = {found['time']:.6g}")
        else:
            centre, neighbour = [*found["amplitudes"], math.nan][:2]
            growth, error = found["growth"], found["error"]
            cells += [
                f"{centre:10.6f} {neighbour:10.6f} {found['frequency']:12.9f}",
                f"{found['phase_step']:10.6f}",
                f"{'-' if growth is None else f'{growth:.6f}':>10}",
                f"{'unknown' if error is None else f'{error:.1e}':>8}",
                f"{found['seconds']:8.3f}",
            ]
        lines.append(" ".join(cells))
    return "\n".join([*lines, "errors are those of the amplitudes, as a solution of (8)"])
