"""Model I, Eqs. (1)-(7): the friction chain, its scales, and when steady sliding is stable."""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Sequence
from typing import Any

import sympy as sp

from derivations.algebra.evidence import (
    Point,
    all_of,
    equals,
    parts_of,
    predicate,
    value,
    vanishes_at,
)
from derivations.derivation import Derivation, Evidence, Step, equation

t, tau = sp.symbols("t tau", real=True)
m, d, k, eta_c, F_N, v_0, omega_n, y_0 = sp.symbols(
    "m d k eta_c F_N v_0 omega_n y_0", positive=True
)
c, xi, mu_st, mu_d, v_tilde_0 = sp.symbols(r"c xi mu_st mu_d \tilde{v}_0", positive=True)
v_rel, v_tilde_rel = sp.symbols(r"v_rel \tilde{v}_{rel}", real=True)
v_d, v_hopf = sp.symbols(r"\tilde{v}_d \tilde{v}_H", positive=True)
F, F_tilde, mu, y_star = sp.symbols(r"F \tilde{F} mu \tilde{y}_*", real=True)
lam = sp.Symbol("lambda")
Y = tuple(sp.Function(name)(t) for name in ("y_{n-1}", "y_n", "y_{n+1}"))
X = tuple(sp.Function(rf"\tilde{{{n}}}")(tau) for n in ("y_{n-1}", "y_n", "y_{n+1}"))


def chain(
    y: tuple[sp.Expr, ...], time: sp.Symbol, coefficients: Sequence[sp.Expr], force: sp.Expr
) -> sp.Eq:
    """Return an interior site with two neighbours; inertia, damping, stiffness, coupling."""
    left, middle, right = y
    inertia, damping, stiffness, coupling = coefficients
    own = inertia * middle.diff(time, 2) + damping * middle.diff(time) + stiffness * middle
    return equation(own + coupling * (2 * middle - right - left), force)


def friction_coefficient(speed: sp.Expr, scale: sp.Symbol) -> sp.Expr:
    """Eq. (2) as its two stated limits require it."""
    return mu_d + (mu_st - mu_d) * sp.exp(-sp.Abs(speed) / scale)


def derive() -> Derivation:
    """Eqs. (1)-(7), from Newton's law to the loss of stability of steady sliding."""
    dimensional = chain(Y, t, (m, d, k, eta_c), F)
    scales = sp.Tuple(
        equation(omega_n, sp.sqrt(k / m)),
        equation(y_0, F_N / k),
        equation(c, eta_c / k),
        equation(xi, d / (2 * sp.sqrt(k * m))),
        equation(tau, omega_n * t),
    )
    # Put y = y_0 x(omega_n t) in (1) and divide by F_N; each coefficient by the scales of (4).
    coefficients = [m * omega_n**2 * y_0, d * omega_n * y_0, k * y_0, eta_c * y_0]
    by_scales = [(coefficient / F_N).subs({y_0: F_N / k, omega_n: sp.sqrt(k / m)})
                 for coefficient in coefficients]  # fmt: skip
    named = [sp.simplify(q.subs({d: 2 * xi * sp.sqrt(k * m), eta_c: c * k})) for q in by_scales]
    scaled = chain(X, tau, named, F_tilde)
    sliding = friction_coefficient(v_d, v_tilde_0).subs(sp.Abs(v_d), v_d)
    damping = 2 * xi + sp.diff(sliding, v_d)
    lost = sp.solve(sp.Eq(damping, 0), v_d)[0]
    slip_law = -sp.sign(v_rel) * F_N * friction_coefficient(v_rel, v_0)
    scaled_law = -sp.sign(v_tilde_rel) * friction_coefficient(v_tilde_rel, v_tilde_0)
    steps = (
        Step("Newton's law for site n between two neighbours", dimensional,
             equals(_energy_point, "the forces of a potential energy, differentiated numerically"),
             1),
        Step("Friction falls exponentially from its static to its dynamic value",
             equation(mu, friction_coefficient(v_rel, v_0)), _limits_of_friction, 2),
        Step("Friction opposes slip; in stick it takes whatever value balances, up to the limit",
             sp.Tuple(equation(F, slip_law), sp.Le(sp.Abs(F), mu_st * F_N)), _friction_law, 3),
        Step("Scales that make inertia, stiffness and normal force one", scales,
             vanishes_at(_scales_point, "the scales that reduce (1) to unit coefficients", parts=5),
             4),
        Step("Put y = y_0 x(tau), tau = omega_n t in (1) and divide by F_N", scaled,
             equals(_scaled_point, "the dimensional equation divided by F_N"), 5),
        Step("The same scales in (3), with the reference velocity scaled too",
             sp.Tuple(equation(F_tilde, scaled_law), sp.Le(sp.Abs(F_tilde), mu_st)),
             _scaled_friction_law, 6),
        Step("The parameters of all simulations of model I",
             sp.Tuple(equation(mu_st, 1), equation(mu_d, sp.Rational(1, 2)),
                      equation(v_tilde_0, sp.Rational(1, 2)), equation(xi, sp.Rational(1, 20))),
             all_of(vanishes_at(lambda _: {mu_st: 1, mu_d: 0.5, v_tilde_0: 0.5, xi: 0.05},
                                "the caption of Fig. 2", parts=4),
                    predicate(_bistable_at_125, "sliding at 1.25 is linearly stable")), 7),
        Step("Steady sliding: all derivatives and differences vanish, v_rel = -v_d",
             equation(y_star, sliding),
             vanishes_at(_sliding_point, "the rest position of the cell found by bisection")),
        Step("Linear waves about steady sliding; coupling does not damp them",
             equation(lam**2 + damping * lam + 1 + 4 * c * sp.sin(sp.Symbol("q") / 2) ** 2, 0),
             vanishes_at(_wave_point, "eigenvalues of a ring, found numerically", tolerance=1e-7)),
        Step("Steady sliding loses stability where the effective damping vanishes",
             equation(v_hopf, lost),
             vanishes_at(_hopf_point, "the sign change of the damping, found by bisection")),
    )  # fmt: skip
    return Derivation("friction", "Model I: scales, steady sliding, stability (Eqs. 1-7)", steps)


def _law(speed: float, static: float, dynamic: float, scale: float) -> float:
    """Return the force of (3) and (6) as prose states it, for a normal force of one."""
    size = dynamic + (static - dynamic) / math.exp(abs(speed) / scale)
    return -math.copysign(size, speed)


def _energy_point(rng: random.Random) -> tuple[Point, list[complex]]:
    left, own, right = (rng.uniform(-1, 1) for _ in range(3))
    rate, second, force = (rng.uniform(-1, 1) for _ in range(3))
    mass, drag, ground, spring = (rng.uniform(0.5, 2) for _ in range(4))

    def energy(y: float) -> float:
        return ground * y**2 / 2 + spring * ((y - left) ** 2 + (right - y) ** 2) / 2

    slope = (energy(own + 0.5) - energy(own - 0.5)) / 1.0  # exact for a quadratic energy
    point = {Y[0]: left, Y[1]: own, Y[2]: right, Y[1].diff(t): rate, Y[1].diff(t, 2): second,
             m: mass, d: drag, k: ground, eta_c: spring, F: force}  # fmt: skip
    return point, [mass * second + drag * rate + slope - force]


def _limits_of_friction(candidate: sp.Basic) -> Evidence:
    static, dynamic, scale = 0.9, 0.35, 0.7
    base = {mu_st: static, mu_d: dynamic, v_0: scale}
    expected = {0.0: static, 200.0: dynamic, scale: dynamic + (static - dynamic) / math.e,
                -scale: dynamic + (static - dynamic) / math.e}  # fmt: skip
    worst = 0.0
    for speed, size in expected.items():
        left, right = candidate.args
        found = value(left, {**base, mu: size}) - value(right, {**base, v_rel: speed})
        worst = max(worst, abs(found))
    return Evidence(
        worst < 1e-9,
        f"mu(0) = mu_st, mu(infinity) = mu_d, one e-fold at v_0: off by at most {worst:.1e}",
    )


_SHARES = (sp.Rational(999, 1000), sp.Integer(1), sp.Rational(1001, 1000))
"""Of the limit: below it, at it, above it."""


def _stick(bound: sp.Basic, point: Point, force: sp.Symbol, limit: float) -> bool:
    numbers = {**point, force: 0}
    exact = {a: sp.nsimplify(v, rational=True) for a, v in numbers.items() if a != force}
    inside = bound.xreplace(exact)
    most = sp.nsimplify(limit, rational=True)
    # The slip law tends to the limit as slip vanishes: at the limit itself a site still sticks.
    allowed = [bool(inside.subs(force, most * share)) for share in _SHARES]
    return allowed == [True, True, False]


def _friction_law(candidate: sp.Basic) -> Evidence:
    law, bound = parts_of(candidate)
    base = {mu_st: 0.9, mu_d: 0.35, v_0: 0.7, F_N: 1.7}
    worst = 0.0
    for speed in (-1.3, -1e-9, 0.4, 2.0):
        point = {**base, v_rel: speed, F: 1.7 * _law(speed, 0.9, 0.35, 0.7)}
        worst = max(worst, abs(value(law.lhs, point) - value(law.rhs, point)))
    stick = _stick(bound, base, F, 0.9 * 1.7)
    holds = worst < 1e-9 and stick
    if worst < 1e-9 and not stick:
        return Evidence(False, "at |F| = mu_st F_N, where slip begins, it gives no law")
    return Evidence(
        holds,
        "opposes slip at four velocities, and in stick allows |F| up to the limit that slip starts "
        f"from, that included: {worst:.1e}",
    )


def _scaled_friction_law(candidate: sp.Basic) -> Evidence:
    law, bound = parts_of(candidate)
    normal, ground, mass, reference = 1.7, 2.3, 0.6, 0.8
    length, rate = normal / ground, math.sqrt(ground / mass)
    base = {mu_st: 0.9, mu_d: 0.35, v_tilde_0: reference / (rate * length), v_0: reference}
    worst = 0.0
    for speed in (-1.3, -0.2, 0.4, 2.0):
        point = {**base, v_tilde_rel: speed / (rate * length),
                 F_tilde: _law(speed, 0.9, 0.35, reference)}  # fmt: skip
        worst = max(worst, abs(value(law.lhs, point) - value(law.rhs, point)))
    holds = worst < 1e-9 and _stick(bound, base, F_tilde, 0.9)
    return Evidence(holds, f"equals the dimensional force over F_N at four velocities: {worst:.1e}")


def _scales_point(rng: random.Random) -> Point:
    mass, drag, ground, spring, normal = (rng.uniform(0.5, 2) for _ in range(5))
    # m w^2 y0 = k y0 = F_N makes two coefficients one; the others are then read off.
    length, rate, instant = normal / ground, (ground / mass) ** 0.5, rng.uniform(0, 1)
    return {m: mass, d: drag, k: ground, eta_c: spring, F_N: normal, t: instant, omega_n: rate,
            y_0: length, c: spring * length / normal, xi: drag * rate * length / normal / 2,
            tau: rate * instant}  # fmt: skip


def _scaled_point(rng: random.Random) -> tuple[Point, list[complex]]:
    mass, drag, ground, spring, normal = (rng.uniform(0.5, 2) for _ in range(5))
    y = [rng.uniform(-1, 1) for _ in range(3)]
    rate, second, force = (rng.uniform(-1, 1) for _ in range(3))
    net = mass * second + drag * rate + ground * y[1] + spring * (2 * y[1] - y[0] - y[2]) - force
    length, clock = normal / ground, math.sqrt(ground / mass)
    point: dict[Any, Any] = {site: position / length for site, position in zip(X, y, strict=True)}
    point |= {X[1].diff(tau): rate / (length * clock), F_tilde: force / normal,
              X[1].diff(tau, 2): second / (length * clock**2), c: spring / ground,
              xi: drag / (2 * math.sqrt(ground * mass))}  # fmt: skip
    return point, [net / normal]


def _bistable_at_125(candidate: sp.Basic) -> bool:
    static, dynamic, scale, ratio = (float(part.rhs) for part in parts_of(candidate))
    slope = (
        _law(-1.25 - 1e-6, static, dynamic, scale) - _law(-1.25 + 1e-6, static, dynamic, scale)
    ) / 2e-6
    return static > dynamic and 2 * ratio + slope > 0


def _friction_numbers(rng: random.Random) -> tuple[float, float, float, float]:
    dynamic = rng.uniform(0.3, 0.6)
    return dynamic + rng.uniform(0.3, 0.5), dynamic, rng.uniform(0.4, 0.8), rng.uniform(0.02, 0.06)


def _bisect(function: Any, low: float, high: float) -> float:
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if function(low) * function(middle) > 0 else (low, middle)
    return (low + high) / 2


def _sliding_point(rng: random.Random) -> Point:
    static, dynamic, scale, _ = _friction_numbers(rng)
    speed = rng.uniform(0.8, 2)
    rest = _bisect(lambda y: y - _law(-speed, static, dynamic, scale), 0.0, 5.0)
    return {mu_st: static, mu_d: dynamic, v_tilde_0: scale, v_d: speed, y_star: rest}


def _slope(speed: float, static: float, dynamic: float, scale: float) -> float:
    """Return Derivative of the friction force with respect to y', by four-point differences."""
    h = 1e-3

    def force(rate: float) -> float:
        return _law(rate - speed, static, dynamic, scale)

    return (8 * (force(h) - force(-h)) - (force(2 * h) - force(-2 * h))) / (12 * h)


def _wave_point(rng: random.Random) -> Point:
    import numpy as np

    static, dynamic, scale, ratio = _friction_numbers(rng)
    speed, spring, size, wave = rng.uniform(0.8, 2), rng.uniform(0.1, 1), 8, rng.randrange(1, 4)
    shift = np.roll(np.eye(size), 1, axis=0)
    stiff = np.eye(size) + spring * (2 * np.eye(size) - shift - shift.T)
    drag = (2 * ratio - _slope(speed, static, dynamic, scale)) * np.eye(size)
    matrix = np.block([[np.zeros((size, size)), np.eye(size)], [-stiff, -drag]])
    mode = np.exp(2j * np.pi * wave * np.arange(size) / size)
    # The mode is exact on a ring, so its 2 x 2 block is found by projection.
    project = np.kron(np.eye(2), mode.conj() / size)
    block = project @ matrix @ np.kron(np.eye(2), mode[:, None])
    root = np.linalg.eigvals(block)[0]
    return {lam: complex(root), mu_st: static, mu_d: dynamic, v_tilde_0: scale, xi: ratio,
            v_d: speed, c: spring, sp.Symbol("q"): 2 * math.pi * wave / size}  # fmt: skip


def _hopf_point(rng: random.Random) -> Point:
    static, dynamic, scale, ratio = _friction_numbers(rng)

    def damping(speed: float) -> float:
        return 2 * ratio - (static - dynamic) / scale * math.exp(-speed / scale)

    lost = _bisect(damping, 0.0, 50.0)
    return {mu_st: static, mu_d: dynamic, v_tilde_0: scale, xi: ratio, v_hopf: lost}


if __name__ == "__main__":
    from derivations.catalogue import main

    sys.exit(main("friction"))
