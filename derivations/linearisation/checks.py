"""Checks of the linearisation by a chain of springs and dampers in plain numbers."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import (
    Point,
    Points,
    at_points,
    equals,
    fast_average,
    solved_for,
    value,
)
from derivations.algebra.lattice import LatticeEnds
from derivations.algebra.steps import Check, Evidence
from derivations.chain import ChainModel
from derivations.chain_numbers import ChainNumbers, drawn
from derivations.linearisation import symbols as s
from derivations.symbols import t, y


def state(candidate: sp.Basic) -> Evidence:
    """Insert motions with known rates: positions must come first, then their rates."""
    name, vector = candidate.args
    sites = len(vector) // 2
    at = 0.37

    def moved(site: int, when: float) -> float:
        return float(np.sin((0.4 + 0.3 * site) * when + site))

    places = [moved(site, at) for site in range(1, sites + 1)]
    step = 1e-5
    rates = [(moved(site, at + step) - moved(site, at - step)) / (2 * step)
             for site in range(1, sites + 1)]  # fmt: skip
    found = []
    for entry in vector:
        known = {}
        for own in entry.atoms(sp.Derivative, AppliedUndef):
            derivative = isinstance(own, sp.Derivative)
            site = int((own.expr if derivative else own).args[0])
            known[own] = rates[site - 1] if derivative else places[site - 1]
        found.append(value(entry, known).real)
    off = float(np.abs(np.array(found) - np.array(places + rates)).max())
    holds = name == s.X and len(vector) == 2 * sites and off < 1e-8
    return Evidence(holds, f"positions of a moving chain, then its rates: off by {off:.1e}")


def _forces(chain: ChainNumbers, ends: LatticeEnds, x: Any) -> Any:
    """Return the accelerations of all sites, from springs between pairs of sites."""
    size = len(x) // 2
    places, rates = x[:size], x[size:]
    out = []
    for site in range(size):
        field = {}
        for offset in range(-chain.reach, chain.reach + 1):
            other = site + offset
            inside = ends is LatticeEnds.RING or 0 <= other < size
            field[offset] = places[other % size] if inside else places[site]
        out.append(-chain.rest(field, rates[site]))
    return np.array(out)


def _rates(chain: ChainNumbers, ends: LatticeEnds, x: Any) -> Any:
    return np.concatenate([x[len(x) // 2 :], _forces(chain, ends, x)])


def _sample(model: ChainModel, sites: int) -> tuple[ChainNumbers, Any, Any]:
    rng = random.Random(7)
    chain = drawn(model, rng)
    # Not near zero, where a wrong power of a displacement would be hard to detect.
    x, change = (
        chain.unit
        * np.array([rng.choice((-1, 1)) * rng.uniform(0.6, 1.4) for _ in range(2 * sites)])
        for _ in range(2)
    )
    return chain, x, change


def closed(model: ChainModel, ends: LatticeEnds) -> Check:
    """Return a check of every site of the closed chain."""

    def check(candidate: sp.Basic) -> Evidence:
        parts = parts_of(candidate)
        sites = len(parts)
        chain, x, second = _sample(model, sites)
        point: dict[Any, Any] = dict(chain.values)
        for site in range(1, sites + 1):
            own = y(site, t)
            point |= {own: x[site - 1], own.diff(t): x[sites + site - 1],
                      own.diff(t, 2): second[site - 1]}  # fmt: skip
        exact = second[:sites] - _forces(chain, ends, x)
        worst = max(
            abs(value(part.lhs, point) - value(part.rhs, point) - expected) / chain.unit
            for part, expected in zip(parts, exact, strict=True)
        )
        return Evidence(worst < 1e-12, f"forces on each of {sites} sites: off by {worst:.1e}")

    return check


def field(model: ChainModel, ends: LatticeEnds) -> Check:
    """Return a check of the rates of the state, entry by entry."""

    def check(candidate: sp.Basic) -> Evidence:
        name, vector = candidate.args
        chain, x, _ = _sample(model, vector.shape[0] // 2)
        if name != s.X_rate or vector.shape[1] != 1:
            return Evidence(False, f"it gives {name} of shape {vector.shape}")
        rates = _rates(chain, ends, x)[:, None] / chain.unit
        return _entries(vector / chain.unit, rates, _point(chain, x), ends)

    return check


def _point(chain: ChainNumbers, x: Any, change: Any = None) -> dict[Any, Any]:
    sites = len(x) // 2
    point: dict[Any, Any] = dict(chain.values)
    point |= dict(zip(s.components(sites), x, strict=True))
    if change is not None:
        point |= dict(zip(s.perturbations(sites), change, strict=True))
    return point


def _entries(matrix: Any, exact: Any, point: Point, ends: LatticeEnds) -> Evidence:
    wrong = [
        (row + 1, column + 1)
        for row in range(matrix.shape[0])
        for column in range(matrix.shape[1])
        if abs(value(matrix[row, column], point) - exact[row, column]) > 1e-11
    ]
    kind = "ring" if ends is LatticeEnds.RING else "open chain"
    if wrong:
        return Evidence(False, f"{len(wrong)} entries differ, the first at {wrong[0]}")
    return Evidence(True, f"all {exact.size} entries agree with the {kind}, numerically")


def _jacobian(chain: ChainNumbers, ends: LatticeEnds, x: Any) -> Any:
    """Return the complex-step derivative of the rates, exact to rounding."""
    step = 1e-30 * chain.unit
    columns = [_rates(chain, ends, x + 1j * step * row).imag / step for row in np.eye(len(x))]
    return np.array(columns).T


def linear(model: ChainModel, ends: LatticeEnds) -> Check:
    """Return a check by the complex-step derivative of the rates along the perturbation."""

    def check(candidate: sp.Basic) -> Evidence:
        name, vector = candidate.args
        chain, x, change = _sample(model, vector.shape[0] // 2)
        if name != s.delta_rate:
            return Evidence(False, f"it gives {name}, not the rate of the perturbation")
        found = np.array([value(row, _point(chain, x, change)).real for row in vector])
        step = 1e-30
        exact = _rates(chain, ends, x + 1j * step * change).imag / step
        worst = float((np.abs(found - exact) / (chain.unit + np.abs(exact))).max())
        return Evidence(
            worst < 1e-11, f"complex-step derivative along the perturbation: off by {worst:.1e}"
        )

    return check


def jacobian(model: ChainModel, ends: LatticeEnds) -> Check:
    """Return a check of every entry by the complex-step derivative."""

    def check(candidate: sp.Basic) -> Evidence:
        name, matrix = candidate.args
        chain, x, _ = _sample(model, matrix.shape[0] // 2)
        exact = _jacobian(chain, ends, x)
        if name != s.J or matrix.shape != exact.shape:
            return Evidence(False, f"it gives {name} of shape {matrix.shape}")
        return _entries(matrix, exact, _point(chain, x), ends)

    return check


@at_points("the printed entry minus the derivative")
def added() -> Points:
    """Compare with print minus derivative in (42), for the superfluous term."""
    place, speed, change = 0.7, -0.4, 0.3
    printed = -speed * (1 - 2 * 1.9 * place + 4 * 0.6 * place**3) * change
    right = -speed * (-2 * 1.9 * place + 4 * 0.6 * place**3) * change
    yield {s.motion.diff(t): speed, s.deviation: change, s.resonant: printed - right}, [0]


def waves(candidate: sp.Basic) -> Evidence:
    """Require real motions of the given amplitude at frequency one."""
    worst = 0.0
    names = ((s.motion, s.A), (s.deviation, s.D))
    for part, (own, size) in zip(parts_of(candidate), names, strict=True):
        for given in (0.7 - 0.4j, -0.2 + 1.1j):

            def sampled(
                phase: Any, part: Any = part, own: Any = own, size: Any = size, given: Any = given
            ) -> Any:
                return np.array([solved_for(part, own, {t: at, size: given}) for at in phase])

            worst = max(worst, abs(fast_average(sampled, 1, 8) - given),
                        float(np.abs(sampled([0.3, 1.9]).imag).max()))  # fmt: skip
    return Evidence(worst < 1e-12, f"amplitude at frequency one by sampling: {worst:.1e}")


@equals("the product averaged by sampling", floor=1.0)
def _mean(rng: random.Random) -> Point:
    size, other = (complex(rng.uniform(-1, 1), rng.uniform(-1, 1)) for _ in range(2))

    def product(phase: Any) -> Any:
        rate = 2 * (1j * size * np.exp(1j * phase)).real
        return -rate * 2 * (other * np.exp(1j * phase)).real

    return {s.A: size, s.D: other, s.resonant: fast_average(product, 1)}


def mean(candidate: sp.Basic) -> Evidence:
    """Compare with the product averaged by direct sampling."""
    found = _mean(candidate)
    return found if candidate.lhs == s.resonant else Evidence(False, "not the resonant part")
