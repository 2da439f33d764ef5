"""What became of the nucleus in a run of a Van der Pol chain, beside the run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from theory.chains.ends import Ends
from theory.chains.vdp import VanDerPolChain
from theory.result import plain

if TYPE_CHECKING:
    from verification.runs.trajectory import Trajectory


def evolution_in_time(run: Trajectory) -> dict[str, Any]:
    """Return the entry ``nucleus`` of a run that has one: how it ended, and its sizes, in time t.

    Parameters
    ----------
    run : Trajectory
        Of any chain.

    Returns
    -------
    dict
        Empty where the notion has no meaning: without two cycles, or on a ring.
    """
    chain = run.chain
    if not isinstance(chain, VanDerPolChain) or not chain.bistable or chain.ends is not Ends.FREE:
        return {}
    from verification.breathers.outcome import PAUSE, evolution

    end, size = float(run.times[-1]), int(run.width[-1])
    found = evolution(run.arrivals, end, size, pause=PAUSE / chain.eps)
    return {
        "nucleus": {
            "end": plain(found.outcome),
            "size": found.size,
            "sizes": plain(found.sizes),
            "longest_pause": plain(found.longest_pause),
        }
    }
