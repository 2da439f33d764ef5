"""Operations on harmonics of a phase and on complex amplitudes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, left_minus_right, parts_of, system
from derivations.algebra.operations import Operation, OperationError, inline, listed
from derivations.algebra.substitution import Substitute


def harmonics_of(expression: sp.Expr, phase: sp.Expr) -> dict[int, sp.Expr]:
    """Return the coefficient of ``e^{i m phase}`` for each m that occurs.

    Everything except trigonometric functions and exponentials of the phase counts as slow and is
    frozen, including functions of the time that occurs in the phase.

    Raises
    ------
    OperationError
        If the expression is not a polynomial in harmonics of the phase.
    """
    frozen = _frozen(expression)
    phase_factor, fast_phase = sp.Dummy("turn"), phase
    plain = sp.sympify(expression).xreplace(frozen)
    if not phase.is_Symbol:
        fast_phase = sp.Dummy("fast")
        (time,) = (q for q in phase.free_symbols if q.name == "t")
        plain = plain.subs(time, fast_phase * time / phase)
    plain = plain.replace(
        lambda q: isinstance(q, (sp.sin, sp.cos)) and q.has(fast_phase), lambda q: q.rewrite(sp.exp)
    )
    rules = {}
    for wave in plain.atoms(sp.exp):
        if wave.has(fast_phase):
            slow_exponent, fast_exponent = sp.expand(wave.exp).as_independent(
                fast_phase, as_Add=True
            )
            rules[wave] = phase_factor ** sp.cancel(fast_exponent / (sp.I * fast_phase)) * sp.exp(
                slow_exponent
            )
    plain = sp.expand(plain.xreplace(rules), power_exp=False)
    if plain.has(fast_phase):
        raise OperationError(f"{inline(phase)} remains outside the harmonics")
    found: dict[int, sp.Expr] = {}
    for term in sp.Add.make_args(plain):
        slow, wave = term.as_independent(phase_factor, as_Add=False)
        number = 0 if wave == 1 else int(wave.as_base_exp()[1])
        found[number] = found.get(number, sp.S.Zero) + slow
    originals = {dummy: atom for atom, dummy in frozen.items()}
    return {m: q.xreplace(originals) for m, q in found.items() if q != 0}


def _frozen(expression: sp.Basic) -> dict[sp.Basic, sp.Dummy]:
    """Return a stand-in for each undefined function and derivative, longest first."""
    found: dict[sp.Basic, sp.Dummy] = {}
    for atom in [*expression.atoms(sp.Derivative), *expression.atoms(AppliedUndef)]:
        real = atom.expr.is_real if isinstance(atom, sp.Derivative) else atom.is_real
        found[atom] = sp.Dummy(str(atom), real=True) if real else sp.Dummy(str(atom))
    return found


def complex_parts(expression: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Return real and imaginary part, for real symbols and real functions.

    Raises
    ------
    OperationError
        If a symbol or function is not known to be real.
    """
    frozen = _frozen(expression)
    plain = sp.powsimp(sp.expand(expression.xreplace(frozen)), combine="exp")
    plain = plain.replace(sp.exp, _euler)
    plain = sp.expand(plain)
    not_real = [q for q in plain.free_symbols if q.is_extended_real is not True]
    if not_real:
        raise OperationError(f"{', '.join(map(str, not_real))} may be complex")
    originals = {dummy: atom for atom, dummy in frozen.items()}
    real, imaginary = (plain.coeff(sp.I, power).xreplace(originals) for power in (0, 1))
    return real, imaginary


def _euler(exponent: sp.Expr) -> sp.Expr:
    real, imaginary = sp.expand(exponent).as_real_imag()
    return sp.exp(real) * (sp.cos(imaginary) + sp.I * sp.sin(imaginary))


@dataclass(frozen=True)
class RemoveSecularTerms(Operation):
    """Require that a forced oscillator is not driven at its own frequency.

    The sources are the forced equation and the solutions to be inserted. The terms of the unknown
    must vanish for ``u = e^{i m t}``; then the drive must not contain harmonic m.

    Attributes
    ----------
    fast : Symbol
        The fast time.
    unknown : Expr
        The function that must remain bounded.
    harmonic : int
        The resonant harmonic m.
    """

    fast: sp.Symbol
    unknown: sp.Expr
    harmonic: int = 1

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``coefficient of the resonant harmonic = 0``."""
        target, *rules = sources
        whole = sp.expand(left_minus_right(target))
        terms_of_unknown = sum(
            (q for q in sp.Add.make_args(whole) if q.has(self.unknown)), sp.S.Zero
        )
        wave = sp.exp(sp.I * self.harmonic * self.fast)
        if sp.expand(terms_of_unknown.subs(self.unknown, wave).doit()) != 0:
            raise OperationError(f"harmonic {self.harmonic} is not resonant")
        drive = left_minus_right(Substitute()(equation(whole - terms_of_unknown), *rules))
        return equation(harmonics_of(drive, self.fast).get(self.harmonic, sp.S.Zero))

    def words(self, labels: Sequence[str]) -> str:
        """Name the harmonic."""
        number = "" if self.harmonic == 1 else str(self.harmonic)
        into = f"substitute {listed(labels[1:])} into {labels[0]} and " if labels[1:] else ""
        return (
            f"{into}remove secular terms: the coefficient of e^({number}i{inline(self.fast)}) "
            "vanishes"
        )


@dataclass(frozen=True)
class CollectHarmonic(Operation):
    """Take the coefficient of a harmonic of a quantity.

    Attributes
    ----------
    phase : Expr
        The phase.
    name : Expr
        Name of the coefficient.
    harmonic : int
        Number of the harmonic.
    """

    phase: sp.Expr
    name: sp.Expr
    harmonic: int = 1

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = coefficient``."""
        (source,) = sources
        found = harmonics_of(source.rhs, self.phase).get(self.harmonic, sp.S.Zero)
        return equation(self.name, found)

    def words(self, labels: Sequence[str]) -> str:
        """Name the harmonic and its coefficient."""
        number = "" if self.harmonic == 1 else str(self.harmonic)
        wave = f"e^({number}i{inline(self.phase)})"
        return f"call the coefficient of {wave} in {listed(labels)} {inline(self.name)}"


@dataclass(frozen=True)
class Average(Operation):
    """Average over the fast phase while slow functions and their derivatives are frozen.

    Attributes
    ----------
    phase : Expr
        The fast phase, as in ``omega t``.
    """

    phrase: ClassVar[str] = (
        "average {sources} over a period of the fast phase {phase} at frozen amplitudes"
    )
    phase: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the mean of left minus right over a period; moduli are written as such."""
        (source,) = sources
        mean = harmonics_of(left_minus_right(source), self.phase).get(0, sp.S.Zero)
        return equation(with_modulus(mean))


def with_modulus(expression: sp.Expr) -> sp.Expr:
    """Return the expression with ``z z*`` written ``|z|²``."""
    terms = []
    for term in sp.Add.make_args(sp.expand(expression)):
        powers = dict(term.as_powers_dict())
        for factor in list(powers):
            if isinstance(factor, sp.conjugate) and factor.args[0] in powers:
                conjugated = factor.args[0]
                pairs = min(powers[conjugated], powers[factor])
                powers[conjugated] -= pairs
                powers[factor] -= pairs
                absolute = sp.Abs(conjugated)
                powers[absolute] = powers.get(absolute, 0) + 2 * pairs
        terms.append(sp.Mul(*(base**power for base, power in powers.items())))
    return sp.Add(*terms)


@dataclass(frozen=True)
class RealAndImaginaryParts(Operation):
    """Separate an equation between complex numbers into two real ones.

    Attributes
    ----------
    names : tuple of Symbol
        Names of the two parts of the right side; empty if the parts of left minus right vanish.
    imaginary_first : bool
        Order in which they are written.
    """

    names: tuple[sp.Symbol, ...] = ()
    imaginary_first: bool = False

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``(real part = 0, imaginary part = 0)``, or ``name = part`` twice."""
        (source,) = sources
        if self.names:
            plain = sp.expand(source.rhs).as_real_imag()
            return sp.Tuple(*map(equation, self.names, (sp.expand(sp.simplify(q)) for q in plain)))
        real, imaginary = complex_parts(left_minus_right(source))
        pair = (imaginary, real) if self.imaginary_first else (real, imaginary)
        return sp.Tuple(*(equation(part) for part in pair))

    def words(self, labels: Sequence[str]) -> str:
        """Name the order."""
        pair = "imaginary and real" if self.imaginary_first else "real and imaginary"
        return f"take the {pair} parts of {listed(labels)}"


@dataclass(frozen=True)
class SquareAndAdd(Operation):
    """Bring the terms with an angle to the left, square both sides, and add the equations.

    Attributes
    ----------
    angle : Symbol
        The angle that is eliminated by ``sin² + cos² = 1``.
    """

    angle: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the sum of the squares."""
        (source,) = sources
        first, second = (sp.expand(left_minus_right(part)) for part in parts_of(source))
        split = (q.as_independent(self.angle, as_Add=True) for q in (first, second))
        constants, oscillating = zip(*split, strict=True)
        # For real waves the sum of squares is a product of conjugates, in which angles cancel.
        exponentials = [sp.expand(wave.rewrite(sp.exp)) for wave in oscillating]
        up, down = (sp.expand(exponentials[0] + sign * sp.I * exponentials[1]) for sign in (1, -1))
        product = sp.expand(up * down)
        left = sp.expand(sp.powsimp(product, combine="exp").replace(sp.exp, _euler))
        if left.has(self.angle):
            raise OperationError(f"{self.angle} does not drop out")
        return equation(
            left, sum((sp.collect(constant, ()) ** 2 for constant in constants), sp.S.Zero)
        )

    def words(self, labels: Sequence[str]) -> str:
        """Name the angle."""
        return (
            f"bring the terms of {listed(labels)} with {inline(self.angle)} to the left, square "
            f"and add: {inline(self.angle)} drops out"
        )


@dataclass(frozen=True)
class CompareFundamental(Operation):
    """Find the amplitude of the fundamental of a motion, or equate those of two motions.

    Attributes
    ----------
    phase : Expr
        The phase.
    name : Symbol or None
        Name of the amplitude of a single motion.
    """

    phase: sp.Expr
    name: sp.Symbol | None = None

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = 2 |coefficient|``, or equal amplitudes and equal arguments."""
        found = [harmonics_of(source.rhs, self.phase).get(1, sp.S.Zero) for source in sources]
        if self.name is not None:
            return equation(self.name, 2 * modulus(found[0]))
        amplitudes = equation(*(2 * modulus(each) for each in found))
        return system((amplitudes, equation(*map(argument, found))))

    def words(self, labels: Sequence[str]) -> str:
        """Name the motions."""
        if self.name is not None:
            return f"take the amplitude of {listed(labels)}"
        return f"equate amplitude and phase of the fundamentals of {listed(labels)}"


def modulus(value: sp.Expr) -> sp.Expr:
    """Return the modulus of a product of real factors, phase factors and powers of i."""
    square = sp.factor(sp.powsimp(sp.expand(value * sp.conjugate(value)), combine="exp"))
    roots = [sp.exp(factor.exp / 2) if isinstance(factor, sp.exp) else sp.sqrt(factor)
             for factor in sp.Mul.make_args(square)]  # fmt: skip
    return sp.Mul(*roots)


def argument(value: sp.Expr) -> sp.Expr:
    """Return the argument of a product of positive factors, phase factors and powers of i."""
    total: sp.Expr = sp.S.Zero
    for factor in sp.Mul.make_args(sp.powsimp(value, combine="exp")):
        total += sp.im(factor.exp) if isinstance(factor, sp.exp) else sp.arg(factor)
    number, symbolic = total.as_independent(*total.free_symbols, as_Add=True)
    principal = sp.Mod(number + sp.pi, 2 * sp.pi) - sp.pi  # in [-pi, pi)
    return principal + symbolic
