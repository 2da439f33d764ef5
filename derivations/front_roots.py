"""Where the roots of the dispersion relation lie: four short proofs, for v, c > 0.

(a) No root is real. (b) No root is double. (c) Above the real axis there is exactly one root in
each strip ``2 pi n - pi < Re k < 2 pi n`` and none between. (d) Below it there is exactly one in
each of ..., (-4 pi, -2 pi), (-2 pi, 0), (0, pi), (pi, 3 pi), (3 pi, 5 pi), ....

The counts follow from the argument of L along the boundary of a strip. The proofs give its sign
on the sides; far from the axis L is ``(ic/2) e^{|Im k|} e^{-+ i Re k}``, whose argument grows by
the width of the strip.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence

import sympy as sp

from derivations import front_numbers as numbers
from derivations.algebra.evidence import Point, solved_for, value, vanishes_at
from derivations.derivation import Check, Evidence, Step, equation
from derivations.front_symbols import DISPERSION, SLOPE, c, k, n, v, x, y

real_part, imaginary_part, gap = sp.symbols("Re(L) Im(L) g", real=True)
kappa = sp.Symbol("kappa", real=True)
above, between, below_left, below_first, below_right = sp.symbols(
    "N^+_{n} N^0_{n} N^-_{left} N^-_{first} N^-_{right}", integer=True
)


def steps() -> tuple[Step, ...]:
    """Return the proofs as steps."""
    whole = sp.Symbol("n", integer=True)
    on_axis = sp.re(DISPERSION.subs(k, x)).doit()
    # sin k = -v/c < 0 is real: off the axis Re k = -pi/2 + 2 pi n, and v = c cosh kappa.
    wave = 1 - sp.cos(x + sp.I * kappa)
    place = {x: -sp.pi / 2 + 2 * sp.pi * whole}
    level = sp.expand_complex(wave).subs(place).subs(sp.sin(2 * sp.pi * whole - sp.pi / 2), -1)
    level = sp.simplify(level.subs(sp.cos(2 * sp.pi * whole - sp.pi / 2), 0))
    double = sp.Rational(1, 2) - sp.I * c * sp.cosh(kappa) * (x + sp.I * kappa) - sp.I * c * level
    double_re, double_im = (sp.simplify(part) for part in sp.expand(double).as_real_imag())
    even = _on_line(2 * sp.pi * whole, 1)
    odd = _on_line((2 * whole + 1) * sp.pi, -1)
    crossing = -1 / (2 * v)
    return (
        Step("(a) On the real axis Re L is 1/2, so no root is real",
             equation(real_part, on_axis), _reads_off(_axis)),
        Step("(b) Suppose L_k = 0: sin k = -v/c, and off the axis Re k = -pi/2 + 2 pi n",
             equation(c * sp.cosh(kappa), v), _turning),
        Step("(b) There L is, with x = Re k and v = c cosh kappa; L = 0 needs x = -1/cosh kappa",
             sp.Tuple(equation(real_part, double_re), equation(imaginary_part, double_im)),
             _reads_off(_double)),
        Step("(b) but -1 <= -1/cosh kappa < 0 stays this far from every -pi/2 + 2 pi n: "
             "no root is double",
             sp.Ge(gap, sp.pi / 2 - 1), _gap),
        Step("(c) On Re k = n pi, at Im k = y", equation(real_part, sp.Rational(1, 2) + v * y),
             _reads_off(_both_lines)),
        Step("(c) So Re L > 0 on every side of the strips above the axis, and only the far end "
             "turns the argument: by pi and on to 2 pi, one root in (2 pi n - pi, 2 pi n)",
             equation(above, 1), _counts(((-5, -4), (-3, -2), (-1, 0), (1, 2), (5, 6)), True)),
        Step("(c) and from -pi/2 to pi/2 and back, no root in (2 pi n, 2 pi n + pi)",
             equation(between, 0), _counts(((-4, -3), (-2, -1), (0, 1), (2, 3)), True)),
        Step("(d) Below the axis, on Re k = 2 pi n: zero only with n > 0",
             sp.Tuple(equation(real_part, even[0]), equation(imaginary_part, even[1])),
             _reads_off(_even_line)),
        Step("(d) on Re k = (2 n + 1) pi: zero only with 2 n + 1 < 0",
             sp.Tuple(equation(real_part, odd[0]), equation(imaginary_part, odd[1])),
             _reads_off(_odd_line)),
        Step("(d) in both cases at this height", equation(y, crossing), _height),
        Step("(d) The other lines are never crossed: one root in each (2 pi n - 2 pi, 2 pi n), "
             "n <= 0", equation(below_left, 1), _counts(((-6, -4), (-4, -2), (-2, 0)), False)),
        Step("(d) one root in (0, pi)", equation(below_first, 1), _counts(((0, 1),), False)),
        Step("(d) one root in each (2 pi n - pi, 2 pi n + pi), n >= 1",
             equation(below_right, 1), _counts(((1, 3), (3, 5), (5, 7)), False)),
    )  # fmt: skip


def _on_line(at: sp.Expr, cosine: int) -> tuple[sp.Expr, sp.Expr]:
    """Re L and Im L at ``at + i y`` where cos(at) = ±1, so cos k = ±cosh y."""
    found = sp.Rational(1, 2) - sp.I * v * (at + sp.I * y) - sp.I * c * (1 - cosine * sp.cosh(y))
    real, imaginary = sp.expand(found).as_real_imag()
    return sp.expand(real), sp.expand(imaginary)


def _reads_off(where: Callable[[random.Random], Point]) -> Check:
    """Compare with the exponentials of L, evaluated at points of a line."""

    def draw(rng: random.Random) -> Point:
        return where(rng)

    return vanishes_at(draw, "L from its exponentials", count=6)


def _sized(rng: random.Random, at: complex, extra: Point, fast: float, spring: float) -> Point:
    found = complex(numbers.dispersion(at, fast, spring))
    return {v: fast, c: spring, real_part: found.real, imaginary_part: found.imag, **extra}


def _pair(rng: random.Random) -> tuple[float, float]:
    return rng.uniform(0.2, 2), rng.uniform(0.2, 2)


def _axis(rng: random.Random) -> Point:
    at = rng.uniform(-9, 9)
    return _sized(rng, complex(at), {x: at}, *_pair(rng))


def _both_lines(rng: random.Random) -> Point:
    line, height = rng.randrange(-4, 5), rng.uniform(0, 3)
    return _sized(rng, complex(line * math.pi, height), {y: height, n: line}, *_pair(rng))


def _even_line(rng: random.Random) -> Point:
    line, height = rng.randrange(-4, 5), -rng.uniform(0, 3)
    return _sized(rng, complex(2 * line * math.pi, height), {y: height, n: line}, *_pair(rng))


def _odd_line(rng: random.Random) -> Point:
    line, height = rng.randrange(-4, 5), -rng.uniform(0, 3)
    return _sized(rng, complex((2 * line + 1) * math.pi, height), {y: height, n: line},
                  *_pair(rng))  # fmt: skip


def _double(rng: random.Random) -> Point:
    line, height, spring = rng.randrange(-2, 3), rng.uniform(-2, 2), rng.uniform(0.2, 2)
    at, fast = -math.pi / 2 + 2 * math.pi * line, spring * math.cosh(height)
    return _sized(rng, complex(at, height), {kappa: height, x: at}, fast, spring)


def _turning(candidate: sp.Basic) -> Evidence:
    """At the heights that the equation gives, the derivative of L vanishes."""
    worst = 0.0
    for spring, height, line in ((0.7, 0.9, 0), (1.3, -1.4, 1)):
        fast = solved_for(candidate, v, {c: spring, kappa: height})
        at = complex(-sp.pi.evalf() / 2 + 2 * sp.pi.evalf() * line) + 1j * height
        worst = max(worst, abs(value(SLOPE, {v: fast, c: spring, k: at})))
    return Evidence(worst < 1e-12, f"L_k at two such points: at most {worst:.1e}")


def _gap(candidate: sp.Basic) -> Evidence:
    """Check that the bound is the infimum of the distances on a fine grid."""
    import numpy as np

    heights = np.linspace(-12, 12, 4001)
    centres = -np.pi / 2 + 2 * np.pi * np.arange(-3, 4)
    least = float(np.abs(-1 / np.cosh(heights)[:, None] - centres).min())
    holds = bool(candidate.subs(gap, least + 1e-9)) and not bool(candidate.subs(gap, least - 1e-3))
    return Evidence(holds, f"the least distance on a grid is {least:.6f}")


def _height(candidate: sp.Basic) -> Evidence:
    """At that height Re L vanishes on lines Re k = n pi."""
    worst = 0.0
    for fast, spring, line in ((0.6, 0.8, 2), (1.7, 0.3, -3)):
        height = solved_for(candidate, y, {v: fast, c: spring}).real
        at = complex(float(sp.pi * line), height)
        worst = max(worst, abs(numbers.dispersion(at, fast, spring).real))
    return Evidence(worst < 1e-12, f"Re L there is at most {worst:.1e}")


def _counts(strips: Sequence[tuple[int, int]], upper: bool) -> Check:
    """Winding numbers of L around strips (in units of pi), at slow, fast and weak scenes."""

    def check(candidate: sp.Basic) -> Evidence:
        (name,) = candidate.free_symbols
        expected = solved_for(candidate, name, {})
        scenes = ((0.15, 0.9), (1.1, 0.6), (0.4, 3.0))
        for fast, spring in scenes:
            for left, right in strips:
                found = numbers.count_in_strip(left * math.pi, right * math.pi, upper, fast, spring)
                if found != expected:
                    return Evidence(
                        False,
                        f"{found} roots in ({left} pi, {right} pi) at v = {fast}, c = {spring}",
                    )
        return Evidence(
            True, f"winding numbers of {len(strips)} strips at {len(scenes)} parameters"
        )

    return check
