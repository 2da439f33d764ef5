"""Where (8) is stiff: εb y⁴ ≫ 1 makes ẏ follow y on a slow manifold. Radau IIA from scipy.

Only the part of the chain that moves is solved for, with sites at rest on either side. A stage is
passed in pieces. It ends when the largest damping rate ε|1 - a y² + b y⁴| has fallen to
a level at which the explicit stepper has steps of ordinary length again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from theory.vdp_chain import Ends, VdpChain

if TYPE_CHECKING:
    from verification.vdp_lane import Lane

FloatArray = npt.NDArray[np.float64]

GENTLE = 2e3
"""Damping rate at which the stage ends."""

_PIECE = 2.0
"""Longest time passed in one call, so that a run can be watched, stopped and resumed, and so that
the part that moves is small for as long as it can be."""

_MOST_DENSE = 100
_PAD = 4
"""Margins of sites at rest that are solved for at first, on either side."""

_TIGHTEST = 1e-12


def full_right_side(chain: VdpChain, state: FloatArray) -> FloatArray:
    """Return d(y, ẏ)/dt of (8) for state (y, ẏ), shape (2N,)."""
    y, w = np.split(state, 2)
    padded = np.concatenate([[y[-1]], y, [y[0]]])
    if chain.ends is Ends.FREE:
        padded[0], padded[-1] = y[0], y[-1]
    pull = chain.eps * chain.c * (2.0 * y - padded[:-2] - padded[2:])
    square = y * y
    damping = chain.eps * w * (1.0 - chain.a * square + chain.b * square**2)
    return np.concatenate([w, -y - pull - damping])


def full_jacobian(chain: VdpChain, state: FloatArray) -> Any:
    """Return the Jacobian (42), corrected, 2N × 2N; sparse for long chains."""
    from scipy.sparse import bmat, diags, identity, lil_matrix

    n = chain.sites
    y, w = np.split(state, 2)
    laplacian = lil_matrix((n, n))
    laplacian.setdiag(2.0)
    laplacian.setdiag(-1.0, 1)
    laplacian.setdiag(-1.0, -1)
    if chain.ends is Ends.FREE:
        laplacian[0, 0] = laplacian[n - 1, n - 1] = 1.0
    else:
        laplacian[0, n - 1] -= 1.0
        laplacian[n - 1, 0] -= 1.0
    square = y * y
    slope = chain.eps * w * y * (-2.0 * chain.a + 4.0 * chain.b * square)
    lower_left = -identity(n) - chain.eps * chain.c * laplacian - diags(slope)
    damping = -chain.eps * (1.0 - chain.a * square + chain.b * square**2)
    blocks: Any = [[None, identity(n)], [lower_left, diags(damping)]]
    jacobian: Any = bmat(blocks, format="csc")
    return jacobian if n > _MOST_DENSE else jacobian.toarray()


@dataclass(frozen=True)
class _Gentle:
    """Event of scipy that ends the stage: the largest damping rate falls through GENTLE."""

    chain: VdpChain
    terminal: bool = True
    direction: float = -1.0

    def __call__(self, _: float, state: FloatArray) -> float:
        square = state[: self.chain.sites] ** 2
        largest = np.max(np.abs(1.0 - self.chain.a * square + self.chain.b * square**2))
        return float(self.chain.eps * largest - GENTLE)


def pass_stiff_stage(chain: VdpChain, lane: Lane) -> None:
    """Take a lane of (8) through a stiff stage: its samples and arrivals are taken on the way.

    Raises
    ------
    ArithmeticError
        If scipy's Radau gives up.
    """
    arrays = lane.kept
    clock, counters = arrays["clock"], arrays["counters"]
    samples, arrivals = arrays["samples"], arrays["arrivals"]
    lo, hi, solved = _solve_moving_part(chain, lane)
    path: Any = solved.sol
    end = float(solved.t[-1])
    times = lane.sample_times
    while counters[2] < times.size and times[counters[2]] <= end:
        samples[counters[2]] = arrays["state"]
        samples[counters[2], :, lo:hi] = path(times[counters[2]]).reshape(2, -1)
        counters[2] += 1
    sizes = np.hypot(*np.split(solved.y, 2))
    for n in np.flatnonzero(np.isnan(arrivals[lo:hi])).tolist():
        above = np.flatnonzero(sizes[n] >= lane.level)
        if above.size:
            arrivals[lo + n] = _crossing(path, hi - lo, n, lane.level, solved.t, int(above[0]))
    arrays["state"][:, lo:hi] = solved.y[:, -1].reshape(2, -1)
    clock[0], clock[4] = end, 0.0
    moving = lo + np.flatnonzero(sizes[:, -1] > lane.rest)
    if moving.size:
        counters[0] = min(counters[0], max(0, moving[0] - lane.margin))
        counters[1] = max(counters[1], min(chain.sites, moving[-1] + lane.margin + 1))
    counters[5] += solved.t.size - 1


def _solve_moving_part(chain: VdpChain, lane: Lane) -> tuple[int, int, Any]:
    """Return the first site, the last + 1, and scipy's solution between them.

    The part is widened until a margin at either end of it stays at rest throughout.
    """
    from scipy.integrate import solve_ivp

    arrays = lane.kept
    begin, tolerance = float(arrays["clock"][0]), max(_TIGHTEST, lane.tolerance)
    first, last = (int(site) for site in arrays["counters"][:2])
    size = float(np.abs(arrays["state"]).max())
    pad = _PAD * lane.margin
    while True:
        lo, hi = max(0, first - pad), min(chain.sites, last + pad)
        part = replace(chain, sites=hi - lo)
        solved = solve_ivp(
            lambda _, x, part=part: full_right_side(part, x),
            (begin, min(begin + _PIECE, lane.end)),
            arrays["state"][:, lo:hi].ravel(),
            method="Radau",
            jac=lambda _, x, part=part: full_jacobian(part, x),
            rtol=tolerance,
            atol=tolerance * size * 1e-3,
            events=_Gentle(part),
            dense_output=True,
        )
        if not solved.success or not np.all(np.isfinite(solved.y[:, -1])):
            raise ArithmeticError(
                f"the stiff stage ended at t = {solved.t[-1]:.6g}: {solved.message}"
            )
        sizes = np.hypot(*np.split(solved.y, 2)).max(axis=1)
        left = sizes[: lane.margin].max() if lo > 0 else 0.0
        right = sizes[-lane.margin :].max() if hi < chain.sites else 0.0
        if max(left, right) <= max(lane.rest, 0.0):
            return lo, hi, solved
        pad *= 4


def _crossing(path: Any, sites: int, n: int, level: float, times: FloatArray, index: int) -> float:
    """Return when site n passes the level, between two steps."""
    low, high = float(times[max(0, index - 1)]), float(times[index])
    for _ in range(60):
        middle = 0.5 * (low + high)
        value = path(middle)
        if np.hypot(value[n], value[n + sites]) >= level:
            high = middle
        else:
            low = middle
    return high
