"""The averaged equation of any polynomial oscillator, its limit cycles, and what they imply."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.algebra.harmonics import site_symbol
from derivations.derivation import equation
from derivations.envelope_input import Coefficients, coefficients, number, values_of
from derivations.envelope_results import Compiled, KineticRelation, LimitCycle
from derivations.front_symbols import M_plus, SumOver, k
from derivations.modulation import by_averaging
from derivations.oscillator import Oscillator

r, square = sp.symbols("r s", positive=True)
r_rate = sp.Symbol("r'", real=True)
PHI = {offset: site_symbol(r"\varphi", offset) for offset in (-1, 0, 1)}
phi_rate = sp.Symbol(r"\varphi_{n}'")


@dataclass(frozen=True)
class Envelope:
    """The averaged equation of an oscillator; made by `derive_envelope`.

    Attributes
    ----------
    oscillator : Oscillator
        What was averaged.
    damping_mean : Expr
        H(s): the amplitude obeys ``r' = -(r/2) H(r^2)``, a unit of ``eps t``.
    shift_mean : Expr
        Omega(s): the frequency of the isolated cell is ``1 + eps Omega(r^2)``.
    """

    oscillator: Oscillator
    damping_mean: sp.Expr
    shift_mean: sp.Expr
    symbols: tuple[sp.Symbol, ...] = field(default=())

    @property
    def equation(self) -> sp.Eq:
        """The averaged equation of the chain for ``y = Im(phi e^{it})``."""
        own, size = PHI[0], sp.Abs(PHI[0])
        mean = -own / 2 * self.damping_mean.subs(square, size**2)
        mean += sp.I * own * self.shift_mean.subs(square, size**2)
        differences = 2 * own - PHI[-1] - PHI[1]
        return equation(phi_rate, mean + sp.I * self.oscillator.coupling / 2 * differences)

    @property
    def amplitude_equation(self) -> sp.Eq:
        """``r' = -(r/2) H(r^2)``."""
        return equation(r_rate, -r / 2 * self.damping_mean.subs(square, r**2))

    @cached_property
    def cycles(self) -> tuple[LimitCycle, ...]:
        """All limit cycles, inner to outer, with their stability.

        Raises
        ------
        DerivationInputError
            If the coefficients are symbols and the roots have no closed form.
        """
        if self.damping_mean.free_symbols - {square}:
            return self._symbolic_cycles()
        polynomial = sp.Poly(self.damping_mean, square)
        roots = [(root, int(times)) for root, times in polynomial.real_roots(multiple=False)
                 if root.is_positive]  # fmt: skip
        found = []
        for place, (root, times) in enumerate(roots):
            low = roots[place - 1][0] if place else sp.Integer(0)
            high = roots[place + 1][0] if place + 1 < len(roots) else 2 * root + 1
            before, after = (
                _sign_between(polynomial, *ends) for ends in ((low, root), (root, high))
            )
            kind = {(-1, 1): "stable", (1, -1): "unstable"}.get((before, after), "half-stable")
            found.append(LimitCycle(sp.sqrt(root), self._exponent(root), kind, times))
        return tuple(found)

    def _symbolic_cycles(self) -> tuple[LimitCycle, ...]:
        polynomial = sp.Poly(self.damping_mean, square)
        if polynomial.degree() > 2:
            raise DerivationInputError(
                "damping", self.oscillator.damping, "of degree at most 4 in y with letters in it",
                "give numbers for the letters, as in --value a=4",
            )  # fmt: skip
        if polynomial.degree() == 2:
            top, middle, low = polynomial.all_coeffs()
            # Positive top coefficient: the minus sign belongs to the inner cycle.
            spread = sp.sqrt(sp.factor(middle**2 - 4 * top * low))
            roots = [(-middle + sign * spread) / (2 * top) for sign in (-1, 1)]
        else:
            roots = list(sp.roots(polynomial))
        kept = [sp.simplify(root) for root in roots]
        return tuple(
            LimitCycle(sp.sqrt(root), sp.simplify(self._exponent(root)), None)
            for root in kept
            if not root.is_nonpositive
        )

    def _exponent(self, root: sp.Expr) -> sp.Expr:
        return -root * sp.diff(self.damping_mean, square).subs(square, root)

    @cached_property
    def ratio(self) -> sp.Expr:
        """|phi_us| / |phi_s| of a cell with exactly two cycles, the inner one unstable.

        Raises
        ------
        DerivationInputError
            If the cell is not of that kind.
        """
        cycles = self.cycles
        rest = self.damping_mean.subs(square, 0)
        if any(cycle.stability is None for cycle in cycles):
            self._refuse_unless_two(len(cycles))
            top, middle, low = sp.Poly(self.damping_mean, square).all_coeffs()
            if not (top.is_positive and middle.is_negative and low.is_positive):
                raise self._not_bistable("the signs of its terms do not allow two cycles")
            spread = sp.sqrt(sp.factor(1 - 4 * top * low / middle**2))
            return sp.sqrt((1 - spread) / (1 + spread))
        self._refuse_unless_two(len(cycles))
        if not rest > 0 or [q.stability for q in cycles] != ["unstable", "stable"]:
            raise self._not_bistable("its rest state or its outer cycle is not stable")
        return sp.simplify(cycles[0].amplitude / cycles[1].amplitude)

    def _refuse_unless_two(self, found: int) -> None:
        if found != 2:
            raise self._not_bistable(f"this one has {found} limit cycle{'s' * (found != 1)}")

    def _not_bistable(self, why: str) -> DerivationInputError:
        return DerivationInputError(
            "damping", _shown(self.oscillator.damping),
            "that of a cell with exactly two cycles around a stable rest state",
            f"{why}, so the simplified model of the front does not apply",
        )  # fmt: skip

    def kinetic_relation(self) -> KineticRelation:
        """Return the kinetic relation (54) of the simplified model of this cell.

        Raises
        ------
        DerivationInputError
            If the cell has not exactly two cycles around a stable rest state.
        """
        ratio, rest = self.ratio, self.damping_mean.subs(square, 0)
        velocity = sp.Symbol(r"\hat{v}", positive=True) / rest
        slope = -sp.I * velocity - sp.I * self.oscillator.coupling / rest * sp.sin(k)
        neglected = ""
        if self.shift_mean.has(square):
            neglected = "the dependence of the frequency on amplitude is left out"
        relation = equation(sp.Abs(SumOver(1 / (k * slope), k, M_plus)), 2 * ratio)
        return KineticRelation(ratio, rest, relation, neglected)

    def compiled(self, **given: float) -> Compiled:
        """Fast numeric functions, once every letter has a value.

        Raises
        ------
        DerivationInputError
            If a letter has no value, or a value belongs to no letter.
        """
        numeric = self.with_values(given)
        left = sorted(symbol.name for symbol in numeric.symbols)
        if left:
            raise DerivationInputError(
                "values",
                ", ".join(given) or "none",
                f"complete ({', '.join(left)} missing)",
                "give them all",
            )
        right = numeric.equation.rhs
        rate = sp.lambdify((PHI[0], PHI[-1], PHI[1]), right, "numpy", cse=True)
        own = sp.lambdify(r, numeric.amplitude_equation.rhs, "numpy", cse=True)
        shift = sp.lambdify(r, numeric.shift_mean.subs(square, r**2), "numpy", cse=True)
        return Compiled(rate, own, shift, tuple(float(q.amplitude) for q in numeric.cycles))

    def with_values(self, given: Mapping[str, float | str]) -> Envelope:
        """Return the same envelope with numbers for some letters, exact for decimal numbers.

        Raises
        ------
        DerivationInputError
            If a value belongs to no letter, or is not a finite number.
        """
        put = values_of(given, self.symbols)
        damping, stiffness = (
            {power: sp.sympify(value).subs(put) for power, value in part.items()}
            for part in (self.oscillator.damping, self.oscillator.stiffness)
        )
        return _averaged(Oscillator(damping, stiffness, self.oscillator.coupling.subs(put)))


def derive_envelope(
    damping: Coefficients,
    stiffness: Coefficients = None,
    coupling: str | float | sp.Expr = "c",
) -> Envelope:
    """Average ``y_n'' + y_n + eps [y_n' h(y_n) + g(y_n) + c (2 y_n - y_{n-1} - y_{n+1})] = 0``.

    Parameters
    ----------
    damping : str, Expr or mapping of power to coefficient
        h(y), with even powers of y only. Letters other than y stand for positive numbers.
    stiffness : str, Expr, mapping or None
        g(y): the restoring force beyond the linear one, without a constant.
    coupling : str, number or Expr
        The coupling c.

    Returns
    -------
    Envelope

    Raises
    ------
    DerivationInputError
        If an input is not a polynomial of this form.

    Examples
    --------
    >>> cell = derive_envelope("1 - a*y**2 + b*y**4")
    >>> cell.damping_mean
    -a*s/4 + b*s**2/8 + 1
    >>> derive_envelope("y**2 - 1").cycles[0].amplitude
    2
    """
    h, g = coefficients(damping, "damping"), coefficients(stiffness, "stiffness")
    if any(power % 2 for power in h):
        raise DerivationInputError("damping", _shown(h), "even in y",
                                   "give h(y) with even powers of y only")  # fmt: skip
    if not h:
        raise DerivationInputError("damping", 0, "other than zero", "give some damping")
    if 0 in g:
        raise DerivationInputError("stiffness", _shown(g), "without a constant term",
                                   "measure y from the equilibrium")  # fmt: skip
    return _averaged(Oscillator(h, g, number(coupling, "coupling")))


def _averaged(oscillator: Oscillator) -> Envelope:
    isolated = Oscillator(oscillator.damping, oscillator.stiffness)
    mean = by_averaging(isolated, 1)
    real, imaginary = sp.Integer(0), sp.Integer(0)
    parameters = mean.ring.ring.gens[2:]
    for powers, coefficient in mean.first.items():
        # phi^{j+1} conj(phi)^j times a Gaussian rational times parameters.
        factor = square ** powers[1]
        for symbol, power in zip(parameters, powers[2:], strict=True):
            factor *= symbol.as_expr() ** power
        real += (
            -2 * sp.Rational(int(coefficient.x.numerator), int(coefficient.x.denominator)) * factor
        )
        imaginary += (
            sp.Rational(int(coefficient.y.numerator), int(coefficient.y.denominator)) * factor
        )
    return Envelope(oscillator, real, imaginary, oscillator.parameters)


def _sign_between(polynomial: sp.Poly, low: sp.Expr, high: sp.Expr) -> int:
    """Return the sign of the polynomial between two neighbouring roots."""
    digits = 30
    while True:
        middle = sp.Rational(str(((low + high) / 2).evalf(digits)))
        if low < middle < high:
            return int(sp.sign(polynomial.eval(middle)))
        digits *= 2


def _shown(powers: Mapping[int, sp.Expr]) -> str:
    y = sp.Symbol("y")
    return str(sum((value * y**power for power, value in powers.items()), sp.Integer(0)))
