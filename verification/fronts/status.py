"""What became of a front; one enum for every model."""

from __future__ import annotations

from theory.status import Status


class FrontStatus(Status):
    """What became of a front."""

    STEADY = "steady", "The front travels, and its velocity has settled."
    SETTLING = (
        "settling",
        "The front travels, and the spread of its period decays but has not yet reached the "
        "accuracy: allow more sites, max_sites.",
    )
    UNSTEADY = (
        "unsteady",
        "The front travels, but its velocity had not settled by the end of the run: it may settle "
        "with more sites, max_sites, or never, for example if its period repeats itself only after "
        "several sites.",
    )
    SLIDING = (
        "sliding",
        "The front travels while sites slide along the threshold, where (44) as printed has no "
        "solution in the ordinary sense: v depends slightly on how this is resolved.",
    )
    PINNED = (
        "pinned",
        "The front is at rest, or slower than the uncertainty of v: no site was reached for a long "
        "time and the amplitudes ahead no longer grow, or c is at most c_pin, where the static "
        "front of (43) ends, or (44) proves that no site can cross the threshold again.",
    )
    MARGINAL = "marginal", "The front is at rest within round-off of the threshold."
    CREEPING = (
        "creeping",
        "No site was reached for a long time, but amplitudes ahead of the front still grow, or "
        "those behind it decrease: nothing can be concluded. Allow a longer stall time.",
    )
    COLLAPSED = (
        "collapsed",
        "The excited sites went to rest: there is no front, or more of them must be excited.",
    )
