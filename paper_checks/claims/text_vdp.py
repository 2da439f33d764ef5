"""Statements of the text about Model II apart from its figures (sections 2 to 2.3.1)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paper_checks.claim import Claim, Ruling
from paper_checks.claims._breathers import EPS, A, B
from paper_checks.claims._closed_form import solutions
from paper_checks.claims._required import required
from paper_checks.ruling import corrected, fails, holds, partly
from theory.arrays import ComplexArray, FloatArray

SETS = ((2.5, 0.5), (4.0, 0.5))
"""Values of (a, b) in Figs. 7-11, and in Figs. 12, 13, 16, 17."""


@dataclass(frozen=True, kw_only=True)
class Cells:
    """Fixed points of the return maps of one cell of either model, with their multipliers."""

    rest: tuple[float, ...]
    """Multiplier of the rest state of (8), for each of `SETS`."""
    inner: tuple[tuple[float, float], ...]
    """Amplitude and multiplier of the inner cycle."""
    outer: tuple[tuple[float, float], ...]
    predicted: float
    """Largest relative difference of the amplitudes from those of the averaged cell."""
    friction_inner: tuple[float, float]
    """ẏ at the centre and multiplier of the unstable slip cycle of Model I at v_d = 1.25."""
    friction_inside: bool
    friction_outside: bool
    sticks: bool


def _trajectory(
    rate: Callable[[float, FloatArray], list[float]], end: float, start: list[float]
) -> Callable[[float], FloatArray]:
    """Return (y, y') as a function of time from 0 to ``end``."""
    from scipy.integrate import solve_ivp

    run = solve_ivp(
        rate, (0.0, end), start, method="DOP853", rtol=1e-11, atol=1e-13, dense_output=True
    )
    dense = required(run.sol, "solution kept by the integrator")
    return lambda time: np.asarray(dense(time), dtype=float)


def _turn(a: float, b: float, height: float) -> float:
    """Return the next maximum of y after one of the given height, for one cell of (8)."""
    from scipy.optimize import brentq

    from verification.references.equations import damping

    def rate(_: float, state: np.ndarray) -> list[float]:
        y, w = state
        return [w, -y - EPS * w * damping(y, a, b)]

    run = _trajectory(rate, 9.0, [height, 0.0])
    return float(run(brentq(lambda t: run(t)[1], 5.0, 8.0))[0])


@lru_cache(maxsize=1)
def cells() -> Cells:
    """Find the cycles of one cell of either model as fixed points, and their stability."""
    from scipy.optimize import brentq

    from verification.references.friction_cell import CELL, highest_after_slip, slip_rate

    rows: dict[int, list[tuple[float, float]]] = {-1: [], 1: []}
    off = []
    for a, b in SETS:
        for sign, found in rows.items():
            predicted = math.sqrt(a / b * (1.0 + sign * math.sqrt(1.0 - 8.0 * b / a**2)))
            cycle = float(
                brentq(lambda y, a=a, b=b: _turn(a, b, y) - y, 0.8 * predicted, 1.1 * predicted)
            )
            slope = (_turn(a, b, cycle + 1e-4) - _turn(a, b, cycle - 1e-4)) / 2e-4
            found.append((cycle, slope))
            off.append(abs(cycle / predicted - 1.0))
    belt, centre = CELL.v_d, CELL.steady_sliding

    def after(w: float, turns: int = 1) -> float:
        """Return ẏ at the centre after a number of turns of slip."""
        for _ in range(turns):
            run = _trajectory(slip_rate(belt), 7.5, [centre, w])
            w = float(run(brentq(lambda t, run=run: run(t)[0] - centre, 5.2, 7.4))[1])
        return w

    slip = float(brentq(lambda w: after(w) - w, 0.2, 1.1, xtol=1e-10))
    return Cells(
        rest=tuple(_turn(a, b, 0.01) / 0.01 for a, b in SETS),
        inner=tuple(rows[-1]),
        outer=tuple(rows[1]),
        predicted=max(off),
        friction_inner=(slip, (after(slip + 1e-4) - after(slip - 1e-4)) / 2e-4),
        friction_inside=after(0.9 * slip, 5) < 0.9 * slip,
        friction_outside=after(1.1 * slip, 5) > 1.1 * slip,
        sticks=highest_after_slip(belt) > -1e-12,
    )


def rule_cells(e: Cells) -> Ruling:
    """Rule: in both models rest must lie inside an unstable cycle inside a stable one."""
    second = max(e.rest) < 1.0 and min(m for _, m in e.inner) > 1.0 > max(m for _, m in e.outer)
    first = e.friction_inner[1] > 1.0 and e.friction_inside and e.friction_outside and e.sticks
    if second and first and e.predicted < 0.05:
        return holds()
    return fails("one of the cells has not these three states.")


@dataclass(frozen=True, kw_only=True)
class Small:
    """The small parameter of averaging, and the ripple of the cycle, for each of `SETS`."""

    effective: tuple[float, ...]
    ripple: tuple[float, ...]
    orders: tuple[float, ...]
    """Observed orders of the ripple in ε."""


def small() -> Small:
    """Integrate one cell at ε and ε/4, and compare the ripple with ε max|damping|."""
    from scipy.integrate import solve_ivp

    from theory.chains.vdp import VdpChain, effective_epsilon
    from verification.references.equations import damping

    ripples = []
    for a, b in SETS:
        pair = []
        for eps in (EPS, EPS / 4.0):

            def rate(_: float, x: np.ndarray, a: float = a, b: float = b,
                     eps: float = eps) -> list[float]:  # fmt: skip
                y, w = x
                return [w, -y - eps * w * damping(y, a, b)]

            settle = 2.5 / eps  # on the slower cycle, deviations have decayed by e^{-7}
            high = math.sqrt(a / b * (1.0 + math.sqrt(1.0 - 8.0 * b / a**2)))
            run = solve_ivp(rate, (0.0, settle), [high, 0.0], method="DOP853", rtol=1e-9,
                            atol=1e-10,
                            t_eval=np.linspace(settle - 2 * math.pi, settle, 400))  # fmt: skip
            size = np.hypot(*run.y)
            pair.append(float(np.ptp(size) / size.mean()))
        ripples.append(pair)
    return Small(
        effective=tuple(effective_epsilon(VdpChain(a=a, b=b, c=0.0, eps=EPS)) for a, b in SETS),
        ripple=tuple(pair[0] for pair in ripples),
        orders=tuple(math.log(pair[0] / pair[1]) / math.log(4.0) for pair in ripples),
    )


def rule_small(e: Small) -> Ruling:
    """Rule: the cycle must be a sinusoid to within a tenth, and approach one as ε decreases."""
    if max(e.ripple) < 0.1 and min(e.orders) > 0.8:
        return holds()
    return fails("at ε = 0.01 the cycle is far from a sinusoid.")


@dataclass(frozen=True, kw_only=True)
class Substitution:
    """Which of (10), (11), (15) as printed contain the wave of (9); and whether they agree."""

    has_wave: dict[int, bool]
    same: bool


def substitution() -> Substitution:
    """Look for the forcing term of (15) in (10) and in (11), as printed."""
    import sympy as sp

    from derivations.judgement import printed
    from derivations.symbols import omega, t, t_hat

    sides = {number: printed(number).expression.args[0] for number in (10, 11, 15)}
    waves = {number: side.atoms(sp.sin) for number, side in sides.items()}
    same = {each.subs(t, t_hat / omega) for each in waves[11]} == waves[15]
    return Substitution(has_wave={n: bool(found) for n, found in waves.items()}, same=same)


def rule_substitution(e: Substitution) -> Ruling:
    """Rule: (15) must follow from (10) as printed, or from (11)."""
    if e.has_wave[10]:
        return holds()
    if e.has_wave[11] and e.has_wave[15] and e.same:
        return corrected("(15) contains the wave of (9) as (11) does, and (10) contains none.")
    return fails("(15) comes from neither equation.")


@dataclass(frozen=True, kw_only=True)
class Extraction:
    """Solutions of (29) with (37) at n = 0 and n = 1, c = 0.1."""

    alpha: float
    decay: float
    centre: int
    """Solutions at n = 0 found by the search."""
    found: tuple[tuple[float, float], ...]
    """(α_0, e^{k_1}) with 0 < e^{k_1} < 1 at n = 1."""

    @property
    def gap(self) -> float:
        """Distance of the nearest solution of the search from the closed branch."""
        return min(math.hypot(a - self.alpha, z - self.decay) for a, z in self.found)

    @property
    def number(self) -> int:
        """Number of solutions at n = 1."""
        return len(self.found)


@lru_cache(maxsize=1)
def extraction() -> Extraction:
    """Solve (29) with (37) in closed form, and also by a search from random starts."""
    from theory.averaged.breather import solve_breather
    from theory.chains.vdp import VdpChain

    closed = solve_breather(VdpChain(a=A, b=B, c=0.1, eps=EPS))
    generator = np.random.default_rng(37)
    hits = [
        solutions(site, 0.1, generator.uniform((1.0, 0.02), (3.5, 0.95), (150, 2)))
        for site in (0, 1)
    ]
    return Extraction(
        alpha=required(closed.alpha_0, "solution at n = 1"),
        decay=required(closed.decay, "solution at n = 1"),
        centre=len(hits[0]),
        found=tuple(hits[1]),
    )


def rule_extraction(e: Extraction) -> Ruling:
    """Rule: the pair must have a solution, and the search must find it."""
    return holds() if e.gap < 1e-8 else fails("(29) and (37) have no common solution.")


def rule_uniquely(e: Extraction) -> Ruling:
    """Rule: there must be exactly one solution that decays."""
    if e.gap > 1e-8:
        return fails("(29) and (37) have no common solution.")
    if e.number == 1:
        return holds()
    return partly(
        "uniquely",
        f"at c = 0.1 the two equations have {e.number} solutions with a decay, of which one joins "
        "the stable cycle as c vanishes.",
    )


@dataclass(frozen=True, kw_only=True)
class Unknowns:
    """Which of R, k_1, ω_1 (26) contains as printed."""

    names: tuple[str, ...]


def unknowns() -> Unknowns:
    """Count the free symbols of (26) other than its parameters."""
    from derivations.judgement import printed

    free = {str(symbol) for symbol in printed(26).expression.free_symbols} - {"a", "b", "c"}
    return Unknowns(names=tuple(sorted(free)))


def rule_unknowns(e: Unknowns) -> Ruling:
    """Rule: there must be three."""
    return holds() if len(e.names) == 3 else fails("(26) has another number of unknowns.")


@dataclass(frozen=True, kw_only=True)
class Displays:
    """Largest errors of formulas without a number, at random values."""

    wave: float
    """sin(t̂ + k_2) written in exponentials, before (21)."""
    envelope: float
    """Ψ_n = φ_n e^{iωt} inserted into (31): ẏ and the derivative of y."""


def displays() -> Displays:
    """Evaluate displayed and in-line formulas that have no number."""
    t, k, w, e = np.random.default_rng(21).uniform(0.1, 3.0, (4, 50))
    wave = (np.exp(1j * k) * np.exp(1j * t) - np.exp(-1j * k) * np.exp(-1j * t)) / 2j - np.sin(
        t + k
    )
    phi = e * np.exp(1j * k)

    def psi(later: float) -> ComplexArray:
        return np.asarray(phi * np.exp(1j * w * (t + later)))

    def y(later: float) -> ComplexArray:
        return np.asarray(-1j * (psi(later) - psi(later).conj()) / (2 * w))

    h = 1e-6
    rate = (psi(0.0) + psi(0.0).conj()) / 2
    return Displays(
        wave=float(np.abs(wave).max()),
        envelope=float(np.abs((y(h) - y(-h)) / (2 * h) - rate).max()),
    )


def rule_displays(e: Displays) -> Ruling:
    """Rule: all must hold exactly, or to the error of a finite difference."""
    if e.wave < 1e-12 and e.envelope < 1e-8:
        return holds()
    return fails("a formula without a number does not hold.")


CLAIMS = (
    Claim.beside("text-topology", evidence=cells, rule=rule_cells),
    Claim.beside("text-small", evidence=small, rule=rule_small, weight=0),
    Claim.beside("text-substitution", evidence=substitution, rule=rule_substitution, weight=0),
    Claim.beside("text-displays", evidence=displays, rule=rule_displays, weight=0),
    Claim.beside("text-unknowns", evidence=unknowns, rule=rule_unknowns, weight=0),
    Claim.beside("text-uniquely", evidence=extraction, rule=rule_uniquely, shared=extraction),
    Claim.beside(
        "text-extraction", evidence=extraction, rule=rule_extraction, weight=0, shared=extraction
    ),
)
