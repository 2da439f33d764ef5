"""Averages over a phase of functions of its cosine: powers and exponentials (Jacobi-Anger)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from derivations.algebra.equations import equation, left_minus_right
from derivations.algebra.operations import Operation, inline, listed


@lru_cache(maxsize=1)
def exponential_mean() -> tuple[sp.Symbol, sp.Expr]:
    """Return z and the mean of ``e^{z cos s}`` over s, by summing its power series.

    The mean of ``cos^{2m}`` is ``binomial(2m, m) / 4^m``; that of odd powers is zero.
    """
    z = sp.Symbol("z")
    m = sp.Symbol("m")
    term = z ** (2 * m) / sp.factorial(2 * m) * sp.binomial(2 * m, m) / 4**m
    return z, sp.summation(term, (m, 0, sp.oo))


def phase_mean(expression: sp.Expr, phase: sp.Symbol) -> sp.Expr:
    """Return the mean over a period of the phase; an integral if no closed form is known."""
    cosine = sp.Dummy("cos")
    total = sp.S.Zero
    for term in sp.Add.make_args(sp.expand(expression)):
        slow, fast = term.as_independent(phase, as_Add=False)
        in_cosine = fast.subs(sp.cos(phase), cosine)
        mean = _closed(in_cosine, cosine, phase)
        total += slow * (_integral(fast, phase) if mean is None else mean)
    return total


def _closed(in_cosine: sp.Expr, cosine: sp.Symbol, phase: sp.Symbol) -> sp.Expr | None:
    """Return the mean of ``cos^p s e^{rate cos s}`` and of trigonometric polynomials."""
    if in_cosine.has(phase):
        expression = in_cosine.subs(cosine, sp.cos(phase))
        trigonometric = all(
            q in (sp.sin(phase), sp.cos(phase)) for q in expression.atoms(sp.Function)
        )
        if not trigonometric or not expression.is_polynomial(sp.sin(phase), sp.cos(phase)):
            return None
        return sp.integrate(expression, (phase, 0, 2 * sp.pi)) / (2 * sp.pi)
    power = sp.S.Zero
    rate = sp.S.Zero
    for factor in sp.Mul.make_args(in_cosine):
        base, exponent = factor.as_base_exp()
        if base == cosine and exponent.is_Integer:
            power += exponent
        elif isinstance(factor, sp.exp) and sp.degree(factor.exp, cosine) == 1:
            rate += factor.exp.coeff(cosine)
        elif factor != 1:
            return None
    if rate == 0:
        return sp.integrate(sp.cos(phase) ** power, (phase, 0, 2 * sp.pi)) / (2 * sp.pi)
    z, mean = exponential_mean()
    return sp.expand_func(mean.diff((z, int(power)))).subs(z, rate)


def _integral(fast: sp.Expr, phase: sp.Symbol) -> sp.Expr:
    return sp.Integral(fast, (phase, -sp.pi, sp.pi)) / (2 * sp.pi)


@dataclass(frozen=True)
class BalancePower(Operation):
    """Insert a harmonic motion into an oscillator, and require its mean power to vanish.

    Attributes
    ----------
    field : Expr
        The displacement, a function of time.
    time : Symbol
        The time.
    motion : Expr
        The displacement as a function of the phase, at frequency one.
    phase : Symbol
        The phase.
    """

    field: sp.Expr
    time: sp.Symbol
    motion: sp.Expr
    phase: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``mean of (left minus right) times velocity = 0``."""
        (source,) = sources
        rules = {
            self.field.diff((self.time, power)): self.motion.diff((self.phase, power))
            for power in (2, 1)
        }
        whole = left_minus_right(source).xreplace(rules).xreplace({self.field: self.motion})
        power = sp.expand(sp.expand(whole, power_exp=True) * self.motion.diff(self.phase))
        return equation(sp.expand(phase_mean(power, self.phase)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the motion."""
        return (
            f"insert {inline(self.field)} = {inline(self.motion)} into {listed(labels)}, multiply "
            "by the velocity and average over the phase (first order in damping and friction)"
        )
