"""Each model written a second time, for scipy and mpmath: the right-hand sides of the references.

There is one right-hand side per model: (8) and its variational equations (42), the averaged chain
(43) and its reduction to real amplitudes, the piecewise-linear chain (44), and friction (6). They
share no code with the compiled right-hand sides of the steppers, so that they can be used to check
the steppers. Springs, forces and damping are plain functions that accept arrays, complex numbers
and mpmath numbers alike.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from theory.arrays import AnyArray, BoolArray, ComplexArray, FloatArray
from theory.cells.friction import FrictionCell
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.vdp import VanDerPolChain

Rate = Callable[[float, FloatArray], FloatArray]
ComplexRate = Callable[[float, ComplexArray], ComplexArray]


def pull(y: AnyArray, ends: Ends = Ends.FREE) -> AnyArray:
    """Return 2y_n - y_{n-1} - y_{n+1} along the first axis.

    Parameters
    ----------
    y : ndarray, shape (N, ...)
        Real or complex.
    ends : Ends
        The missing neighbour at an end is the site itself, the site at the other end, or zero.

    Examples
    --------
    >>> pull(np.array([1.0, 0.0, 0.0])).tolist(), pull(np.array([1.0, 0.0]), Ends.LITERAL).tolist()
    ([1.0, -1.0, 0.0], [2.0, -1.0])
    """
    out = 2.0 * y
    out[1:] -= y[:-1]
    out[:-1] -= y[1:]
    if ends is Ends.FREE:
        out[0] -= y[0]
        out[-1] -= y[-1]
    elif ends is Ends.PERIODIC:
        out[0] -= y[-1]
        out[-1] -= y[0]
    return out


def pull_matrix(sites: int, ends: Ends = Ends.FREE) -> FloatArray:
    """Return the matrix of `pull`, shape (N, N)."""
    return pull(np.eye(sites), ends)


def damping(y: Any, a: Any, b: Any) -> Any:
    """Return 1 - ay² + by⁴ of (8).

    Examples
    --------
    >>> damping(1.0, 2.5, 0.5)
    -1.0
    """
    square = y * y
    return 1 - a * square + b * square * square


def averaged_damping(size: Any, a: Any, b: Any) -> Any:
    """Return 1 - a|φ|²/4 + b|φ|⁴/8 of (43), the average of `damping` weighted by ẏ².

    Examples
    --------
    >>> averaged_damping(2.0, 2.5, 0.5)
    -0.5
    """
    square = size * size
    return 1 - a * square / 4 + b * square * square / 8


def full_rate(chain: VanDerPolChain, wave: bool = False) -> Rate:
    """Return d(y, ẏ)/dt of (8).

    Parameters
    ----------
    chain : VanDerPolChain
        Its a, b, c, ε and ends are used.
    wave : bool
        Whether a wave continues to the left of the first site with a quarter turn per site, so that
        y_0 = ẏ_1.

    Returns
    -------
    callable
        Function of t and (y, ẏ), shape (2N,), or of several such columns, shape (2N, M) flattened.
    """
    n, a, b, c, eps, ends = chain.sites, chain.a, chain.b, chain.c, chain.eps, chain.ends

    def rate(_: float, state: FloatArray) -> FloatArray:
        x = state.reshape(2 * n, -1)
        y, w = x[:n], x[n:]
        springs = pull(y, ends)
        if wave:
            springs[0] += y[0] - w[0]
        force = -y - eps * (c * springs + w * damping(y, a, b))
        return np.concatenate([w, force]).reshape(state.shape)

    return rate


def variational_rate(chain: VanDerPolChain) -> Rate:
    """Return the rate of a motion of (8) and of deviations from it, (42).

    Returns
    -------
    callable
        Function of t and a matrix, shape (2N, 1 + M) flattened, with the motion in the first column
        and deviations in the others.
    """
    n, a, b, motion = chain.sites, chain.a, chain.b, full_rate(chain)

    def rate(t: float, flat: FloatArray) -> FloatArray:
        x = flat.reshape(2 * n, -1)
        y, w, dy, dw = x[:n, :1], x[n:, :1], x[:n, 1:], x[n:, 1:]
        bend = w * y * (4.0 * b * y * y - 2.0 * a)
        springs = chain.c * pull(dy, chain.ends)
        out = np.empty_like(x)
        out[:, 0] = motion(t, x[:, 0])
        out[:n, 1:] = dw
        out[n:, 1:] = -dy - chain.eps * (springs + bend * dy + damping(y, a, b) * dw)
        return out.ravel()

    return rate


def full_jacobian(chain: VanDerPolChain) -> Callable[[float, FloatArray], Any]:
    """Return the sparse matrix of (42) as a function of t and (y, ẏ), for implicit methods."""
    from scipy.sparse import bmat, csc_matrix, diags, identity

    n, a, b, eps = chain.sites, chain.a, chain.b, chain.eps
    springs = csc_matrix(pull_matrix(n, chain.ends))

    def jacobian(_: float, state: FloatArray) -> Any:
        y, w = np.split(state, 2)
        bend = diags(eps * w * y * (4.0 * b * y * y - 2.0 * a))
        lower = [-identity(n) - eps * chain.c * springs - bend, diags(-eps * damping(y, a, b))]
        blocks: Any = [[None, identity(n)], lower]
        return bmat(blocks, format="csc")

    return jacobian


def averaged_rate(chain: VanDerPolChain) -> ComplexRate:
    """Return dφ/dT of (43), T = εt, as a function of T and φ, complex, shape (N,)."""
    a, b, c, ends = chain.a, chain.b, chain.c, chain.ends

    def rate(_: float, phi: ComplexArray) -> ComplexArray:
        damped = phi * averaged_damping(np.abs(phi), a, b)
        out: ComplexArray = 0.5j * c * pull(phi, ends) - 0.5 * damped
        return out

    return rate


def quarter_turn_rate(chain: VanDerPolChain, wave: bool = False) -> Rate:
    """Return dr/dT of (43) with each site a quarter turn behind its left neighbour.

    With φ_n = (-i)ⁿ e^{icT} r_n and r real, r_n' = (c/2)(r_{n-1} - r_{n+1}) - (r_n/2)(…).

    Parameters
    ----------
    chain : VanDerPolChain
        Its a, b, c are used.
    wave : bool
        Whether r_0 = r_1, as for a wave that continues to the left; otherwise the missing
        neighbours at the ends are zero, without the term of a free end, which the reduction cannot
        represent.
    """
    a, b, c = chain.a, chain.b, chain.c

    def rate(_: float, r: FloatArray) -> FloatArray:
        out: FloatArray = -0.5 * r * averaged_damping(r, a, b)
        out[1:] += 0.5 * c * r[:-1]
        out[:-1] -= 0.5 * c * r[1:]
        if wave:
            out[0] += 0.5 * c * r[0]
        return out

    return rate


def piecewise_rate(
    c: float, excited: BoolArray, left: complex, right: complex, ring: bool = False
) -> ComplexRate:
    """Return dφ/dT of (44), phases locked, as long as the same sites have |φ| above the threshold.

    Parameters
    ----------
    c : float
        Coupling, dimensionless.
    excited : ndarray of bool, shape (N,)
        Which sites are above the threshold.
    left, right : complex
        The missing neighbours at the two ends: numbers, or with ``ring`` the quantities that are
        added to the values at the opposite ends.
    ring : bool
        Whether the ends are neighbours, up to these additions.
    """

    def rate(_: float, phi: ComplexArray) -> ComplexArray:
        before, after = (left + phi[-1], right + phi[0]) if ring else (left, right)
        around = np.concatenate([[before], phi[:-1]]) + np.concatenate([phi[1:], [after]])
        out: ComplexArray = 0.5j * c * (2.0 * phi - around) - 0.5 * phi + 0.5 * excited
        return out

    return rate


def dynamic_friction(speed: Any, cell: FrictionCell, exp: Callable[[Any], Any] = np.exp) -> Any:
    """Return μ of (6) at a speed |v|: μ_d + (μ_st - μ_d) e^{-|v|/v₀}, or that of another law.

    For a negative speed the curve is continued smoothly, as needed to test for a grazing orbit.

    Examples
    --------
    >>> float(dynamic_friction(0.0, FrictionCell()))
    1.0
    """
    if cell.law == "exponential":
        falling = exp(-speed / cell.v0)
    elif cell.law == "stribeck":
        falling = exp(-((speed / cell.v_s) ** 2))
    else:
        falling = 0.0
    return cell.mu_d + (cell.mu_st - cell.mu_d) * falling + cell.viscous * speed


def load(y: FloatArray, velocity: Any, chain: FrictionChain) -> FloatArray:
    """Return 2ξẏ + y + c(2y_n - y_{n-1} - y_{n+1}) of (5), the load that friction balances."""
    springs = y + chain.c * pull(y, chain.ends)
    out: FloatArray = springs + 2.0 * chain.cell.xi * velocity
    return out


def as_state(psi: ComplexArray) -> FloatArray:
    """Return (y, ẏ), shape (2N,), of Ψ = ẏ + iy."""
    return np.concatenate([psi.imag, psi.real])


def as_complex(state: FloatArray) -> ComplexArray:
    """Return Ψ = ẏ + iy, shape (N, ...), of states (y, ẏ) of shape (2N, ...)."""
    y, w = np.split(state, 2)
    return np.asarray(w + 1j * y)


def amplitude_of(state: FloatArray) -> FloatArray:
    """Return |Ψ|, shape (N, ...), of states (y, ẏ) of shape (2N, ...)."""
    sites = len(state) // 2
    return np.hypot(state[:sites], state[sites:])
