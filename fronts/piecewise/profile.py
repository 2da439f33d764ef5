"""The shape of a front of the piecewise-linear chain (Eq. 49), and its admissibility (Eq. 47)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fronts.piecewise.kinetic_relation import damping_ratio
from theory.arrays import ComplexArray, FloatArray
from theory.parameters import ParameterError, RunError, count_within, number, with_ranges, within
from theory.piecewise.kinetic_relation import COUPLINGS, KineticBranch, trace_kinetic_relation
from theory.result import Result

_MAX_POSITION = 1e6


@dataclass(frozen=True, kw_only=True)
class FrontProfile(Result):
    """The shape φ(ζ)/φ_s of a front.

    Attributes
    ----------
    c, eta : float
        Coupling and η = b/a², dimensionless.
    v, v_error : float
        Velocity v̂ of the front, negative where it retreats, and the bound on its error.
    admissible : bool or None
        Whether (47) holds for every ζ; None if it was not decided.
    fails_at : float or None
        A position ζ, in sites, at which (47) is violated: the one nearest 0 of those examined; None
        if there is none.
    threshold : float
        The threshold |φ_us|/|φ_s|, to rounding.
    zeta : ndarray of float, shape (n,)
        Positions ζ = site - vT, in sites.
    phi : ndarray of complex, shape (n,)
        φ(ζ)/φ_s, dimensionless.
    error : float
        Bound on the error of every value.
    points : int
        Number of quadrature points.
    """

    derived = ("re", "im")
    in_columns = ("re", "im")

    c: float
    eta: float
    v: float
    v_error: float
    admissible: bool | None
    fails_at: float | None
    threshold: float
    zeta: FloatArray = field(metadata={"axis": "zeta"})
    phi: ComplexArray = field(metadata={"dims": ("zeta",), "json": None})
    error: float
    points: int

    @property
    def re(self) -> FloatArray:
        """Real part of φ(ζ)/φ_s."""
        return self.phi.real

    @property
    def im(self) -> FloatArray:
        """Imaginary part of φ(ζ)/φ_s."""
        return self.phi.imag

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per position."""
        return {
            "zeta": self.zeta,
            "re_phi": self.phi.real,
            "im_phi": self.phi.imag,
            "abs_phi": np.abs(self.phi),
        }


@with_ranges(couplings=COUPLINGS)
def front_profile(
    c: float,
    eta: float | None = None,
    *,
    a: float | None = None,
    b: float | None = None,
    branch: int | None = None,
    low: float = -8.0,
    high: float = 8.0,
    points: int = 321,
) -> FrontProfile:
    """Return the shape of a travelling front (Eq. 49) and whether it is admissible (Eq. 47).

    Parameters
    ----------
    c : float
        Coupling, dimensionless, {couplings}.
    eta : float, optional
        η = b/a², dimensionless; two limit cycles exist below 1/8.
    a, b : float, optional
        Damping coefficients of (8), dimensionless; both must be given, in place of eta.
    branch : int, optional
        Number of the solution in ascending order of v; by default the fastest admissible one.
    low : float, optional
        First position ζ, in sites.
    high : float, optional
        Last position ζ, in sites.
    points : int, optional
        Number of positions.

    Returns
    -------
    FrontProfile
        Positions, values, and the velocity and admissibility of the front.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or there is no such branch.
    RunError
        If no front travels at these parameters.
    PrecisionError
        If more than two million points of quadrature would be needed (v or c above some 10⁴).

    References
    ----------
    Trefethen, L. N. & Weideman, J. A. C. (2014), SIAM Review 56, 385: the trapezoidal rule.

    Examples
    --------
    >>> import fronts as fr
    >>> shape = fr.front_profile(0.5, 0.03125, low=-40, high=40, points=3)
    >>> [round(float(abs(value)), 6) for value in shape.phi]
    [1.0, 0.267949, 0.0]
    """
    from theory.cells.vdp import threshold_ratio
    from theory.piecewise.profile import front_profile as shape_of

    points = count_within("number of points", points, 2, 1_000_000)
    low = within("first position", low, -_MAX_POSITION, _MAX_POSITION)
    high = within("last position", high, -_MAX_POSITION, _MAX_POSITION)
    if not low < high:
        raise ParameterError(
            "last position", high, f"above the first, {low:g}", "make it larger than the first"
        )
    (answer,) = trace_kinetic_relation(
        number("coupling c", c), damping_ratio(None if eta is None else number("eta", eta), a, b)
    )
    if not answer.branches:
        raise RunError(f"there is no travelling front to draw: {answer.reason}")
    chosen = _chosen(answer.branches, branch)
    zeta = np.linspace(low, high, points)
    if chosen.v > 0:
        shape = shape_of(zeta, chosen.v, answer.c)
        phi = shape.phi
    else:  # a retreating front is 1 - φ(-ζ), where φ is the advancing one
        shape = shape_of(-zeta, -chosen.v, answer.c)
        phi = 1.0 - shape.phi
    return FrontProfile(
        c=answer.c,
        eta=answer.eta,
        v=chosen.v,
        v_error=chosen.error,
        admissible=chosen.admissible,
        fails_at=chosen.fails_at,
        threshold=threshold_ratio(answer.eta),
        zeta=zeta,
        phi=np.asarray(phi, dtype=np.complex128),
        error=shape.error,
        points=shape.points,
    )


def _chosen(branches: tuple[KineticBranch, ...], position: int | None) -> KineticBranch:
    if position is not None:
        last = len(branches)
        remedy = "choose one of these, in ascending v"
        return branches[count_within("branch", position, 1, last, remedy) - 1]
    admissible = [each for each in branches if each.admissible]
    return (admissible or list(branches))[-1]
