"""The evolution of the nucleus in a simulation of a Van der Pol chain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from theory.chains.ends import Ends
from theory.chains.vdp import VanDerPolChain
from theory.result import json_value

if TYPE_CHECKING:
    from verification.runs.trajectory import Trajectory


def evolution_in_time(run: Trajectory) -> dict[str, Any]:
    """Return the entry ``nucleus`` for a simulation: its outcome and its sizes, in time t.

    Parameters
    ----------
    run : Trajectory
        A simulation of any chain.

    Returns
    -------
    dict
        Empty where a nucleus is not defined: if the cell does not have two cycles, or on a ring.
    """
    chain = run.chain
    if not isinstance(chain, VanDerPolChain) or not chain.bistable or chain.ends is not Ends.FREE:
        return {}
    from verification.breathers.outcome import PAUSE, evolution

    end, size = float(run.times[-1]), int(run.width[-1])
    found = evolution(run.arrivals, end, size, pause=PAUSE / chain.eps)
    return {
        "nucleus": {
            "end": json_value(found.outcome),
            "size": found.size,
            "sizes": json_value(found.sizes),
            "longest_pause": json_value(found.longest_pause),
        }
    }
