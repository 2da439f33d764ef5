"""The stiff stage of (8), where εb y⁴ ≫ 1 makes ẏ follow y on a slow manifold: Radau IIA of scipy.

Only the moving part of the chain is solved for, with sites at rest on either side. A stage is
integrated in pieces. It ends when the largest damping rate ε|1 - a y² + b y⁴| has fallen to a level
at which the explicit stepper again has steps of ordinary length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.chains.ends import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import RunError

GENTLE = 2e3
"""Damping rate at which the stage ends."""

_PIECE = 2.0
"""Longest time covered by one call, so that a run can be watched, stopped and resumed, and the
moving part stays small for as long as possible."""

MAX_STEPS = 20_000
"""Largest number of Radau steps in one run: about a minute."""

_PAD = 4
"""Number of margins of sites at rest that are solved for initially, on either side."""

MAX_RATE = 1e60
"""Largest damping rate at which the stage begins. scipy's Radau never ends at some 1e80."""

TIGHTEST = 1e-12
"""Smallest tolerance passed to the implicit method."""


def full_right_side(chain: VdpChain, state: FloatArray) -> FloatArray:
    """Return d(y, ẏ)/dt of (8) for state (y, ẏ), shape (2N,)."""
    y, w = state[: chain.sites], state[chain.sites :]
    padded = np.concatenate([y[-1:], y, y[:1]])
    if chain.ends is Ends.FREE:
        padded[0], padded[-1] = y[0], y[-1]
    pull = chain.eps * chain.c * (2.0 * y - padded[:-2] - padded[2:])
    square = y * y
    damping = chain.eps * w * (1.0 - chain.a * square + chain.b * square**2)
    return np.concatenate([w, -y - pull - damping])


def full_jacobian(chain: VdpChain, state: FloatArray) -> Any:
    """Return the corrected Jacobian (42), a sparse matrix of 2N × 2N."""
    from scipy.sparse import bmat, diags, identity, lil_matrix

    n = chain.sites
    y, w = state[: chain.sites], state[chain.sites :]
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
    return bmat(blocks, format="csc")


def largest_damping(chain: VdpChain, y: FloatArray) -> float:
    """Return max |1 - a y² + b y⁴| over the sites."""
    square = y**2
    return float(np.max(np.abs(1.0 - chain.a * square + chain.b * square**2)))


@dataclass
class _Gentle:
    """scipy event that ends the stage: the largest damping rate falls through GENTLE."""

    chain: VdpChain
    steps_left: int
    terminal: bool = True
    direction: float = -1.0

    def __call__(self, time: float, state: FloatArray) -> float:
        self.steps_left -= 1
        if self.steps_left < 0:
            size = float(np.abs(state[: self.chain.sites]).max())
            raise RunError(
                f"the run at t = {time:.6g}, |y| = {size:.3g} is so stiff that it needs more than "
                f"{MAX_STEPS} implicit steps: take a larger tolerance, or a smaller displacement."
            )
        return self.chain.eps * largest_damping(self.chain, state[: self.chain.sites]) - GENTLE


@dataclass(frozen=True)
class StiffPiece:
    """A piece of a run, solved for the moving part of the chain.

    Attributes
    ----------
    first, last : int
        The first site solved for, and the last one plus one.
    times : ndarray, shape (M,)
        End times of Radau's steps.
    path : callable
        Maps a time to (y, ẏ) of that part, shape (2(last - first),).
    """

    first: int
    last: int
    times: FloatArray
    path: Callable[[float], FloatArray]

    def state(self, time: float) -> FloatArray:
        """Return (y, ẏ) of the moving part, shape (2, last - first)."""
        return self.path(time).reshape(2, -1)

    def passes(self, level: float) -> dict[int, float]:
        """Return, for each site whose |Ψ| reaches the level, the time at which it first does."""
        sizes = np.array([np.hypot(*self.state(time)) for time in self.times])
        found = {}
        for n in range(self.last - self.first):
            above = np.flatnonzero(sizes[:, n] >= level)
            if above.size:
                found[self.first + n] = self._crossing(n, level, int(above[0]))
        return found

    def _crossing(self, n: int, level: float, index: int) -> float:
        """Return the time, between two steps, at which site n of the part passes the level."""
        low, high = float(self.times[max(0, index - 1)]), float(self.times[index])
        for _ in range(60):
            middle = 0.5 * (low + high)
            y, w = self.state(middle)[:, n]
            if np.hypot(y, w) >= level:
                high = middle
            else:
                low = middle
        return high


def solve_stiff_piece(
    chain: VdpChain,
    state: FloatArray,
    moving: tuple[int, int],
    begin: float,
    end: float,
    tolerance: float,
    rest: float,
    margin: int,
    steps_taken: int,
) -> StiffPiece:
    """Solve (8) from ``begin`` until it is no longer stiff, but for at most one piece of time.

    Parameters
    ----------
    chain : VdpChain
        Parameters.
    state : ndarray, shape (2, N)
        y and ẏ at ``begin``.
    moving : tuple of int
        The first site that is stepped, and the last one plus one.
    begin, end : float
        Times t; the end of the run.
    tolerance : float
        Relative local error; at least 1e-12 is used.
    rest : float
        |Ψ| below which a site is at rest; negative if all sites are stepped.
    margin : int
        Sites at rest on either side of the moving part, which is widened until they remain at rest.
    steps_taken : int
        Number of stiff steps of the run so far.

    Raises
    ------
    RunError
        If the run needs more than ``MAX_STEPS`` steps, or its damping rate is too large.
    ArithmeticError
        If scipy's Radau fails.
    """
    pad = _PAD * margin
    while True:
        lo, hi = max(0, moving[0] - pad), min(chain.sites, moving[1] + pad)
        part = replace(chain, sites=hi - lo)
        gentle = _Gentle(part, MAX_STEPS - steps_taken)
        solved = _radau(part, state[:, lo:hi], begin, min(begin + _PIECE, end), tolerance, gentle)
        sizes = np.hypot(*np.split(solved.y, 2)).max(axis=1)
        left = sizes[:margin].max() if lo > 0 else 0.0
        right = sizes[-margin:].max() if hi < chain.sites else 0.0
        if max(left, right) <= max(rest, 0.0):
            return StiffPiece(lo, hi, solved.t, solved.sol)
        pad *= 4


def _radau(
    chain: VdpChain,
    state: FloatArray,
    begin: float,
    end: float,
    tolerance: float,
    gentle: _Gentle,
) -> Any:
    """Return scipy's Radau solution up to the end, or to where (8) is no longer stiff."""
    from scipy.integrate import solve_ivp

    tolerance = max(TIGHTEST, tolerance)
    with np.errstate(over="ignore", invalid="ignore"):
        fastest = chain.eps * largest_damping(chain, state[0])
    if not fastest <= MAX_RATE:
        raise RunError(
            f"a displacement of {np.abs(state[0]).max():.3g} at t = {begin:.6g} makes the damping "
            f"rate larger than {MAX_RATE:g}: start from a smaller displacement."
        )
    solved = solve_ivp(
        lambda _, x: full_right_side(chain, x),
        (begin, end),
        state.ravel(),
        method="Radau",
        jac=lambda _, x: full_jacobian(chain, x),
        rtol=tolerance,
        atol=tolerance * float(np.abs(state).max()) * 1e-3,
        events=gentle,
        dense_output=True,
    )
    if not solved.success or not np.all(np.isfinite(solved.y[:, -1])):
        raise ArithmeticError(f"the stiff stage ended at t = {solved.t[-1]:.6g}: {solved.message}")
    return solved
