"""The range of couplings at which a nucleus escapes while c is held, in words and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fronts.answer import Answer

if TYPE_CHECKING:
    from theory.chains.vdp import VdpChain
    from verification.thresholds.preparation import Preparation


def held_answer(chain: VdpChain, preparation: Preparation) -> Answer:
    """Find the range of escape with the coupling held."""
    from verification.thresholds.escape import escape_range

    found = escape_range(chain, preparation)
    noisy = preparation.perturbation > 0.0
    payload: dict[str, object] = {
        "c_crit": found.c,
        "error": found.error,
        "mechanism": "escape while c is held",
        "seconds": found.seconds,
        "range": [found.low, found.high],
        "range_by_seed": {str(seed): list(ends) for seed, ends in found.by_seed.items()},
        "waiting_time": found.final_time,
        "monotone": found.monotone,
        "perturbation": preparation.perturbation,
        "runs": found.runs,
        "method": "hold",
    }
    lines = [
        f"escape at c = {found.c:.6g}, uncertain by {found.error:.1e}, with c held: "
        f"from {found.low:.6f} to {found.high:.6f}",
        f"  below it every run held for {found.final_time:g} of slow time; above it every run "
        f"escaped within {0.5 * found.final_time:g}",
    ]
    if noisy:
        lines += [
            f"  seed {seed}: from {low:.6f} to {high:.6f}"
            for seed, (low, high) in found.by_seed.items()
        ]
    if not found.monotone:
        lines.append("  escape is not monotone in c: the range is twice as wide as what was found")
    lines += [
        "  this is for "
        + (f"noise of {preparation.perturbation:g}, these seeds and " if noisy else "")
        + "this waiting time: others may escape lower",
        f"  {found.runs} runs, {found.seconds:.3f} s",
    ]
    return Answer(payload, "\n".join(lines))
