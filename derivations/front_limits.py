"""Other forms of the sum of (53), and its limits: no roots needed.

With ``A(k) = 1/2 - ic(1 - cos k)`` the contour integral of (49) at zeta = 0 becomes an integral
along the real line, then over one period. Slow fronts give the depinning threshold; strong
coupling leaves two roots.
"""

from __future__ import annotations

import math

import sympy as sp

from derivations import front_numbers as numbers
from derivations.algebra.evidence import parts_of, solved_for, value
from derivations.derivation import Evidence, Step, equation
from derivations.front_symbols import ON_SITE, M_minus, M_plus, c, eta, k, over_roots, ratio, v

m = sp.Symbol("m", integer=True)
a_of_k = sp.Symbol("A")
static, c_pin, modulus, eta_max = sp.symbols("Sigma_0 c_pin S eta_max")
V = sp.Symbol("V", positive=True)
kappa, spread = sp.symbols("kappa q")


def steps() -> tuple[Step, ...]:
    """Return the forms and limits as steps."""
    total = over_roots(1, M_plus)
    along = sp.Integral(1 / (ON_SITE**2 + v**2 * k**2), (k, 0, sp.oo))
    period = sp.sinh(a_of_k / v) / (sp.cosh(a_of_k / v) - sp.cos(k)) / (2 * a_of_k)
    comb = sp.Sum(v / (a_of_k**2 + v**2 * (k + 2 * sp.pi * m) ** 2), (m, -sp.oo, sp.oo))
    over_period = sp.Integral(period.subs(a_of_k, ON_SITE), (k, -sp.pi, sp.pi))
    # v -> 0: the fraction of hyperbolic functions tends to 1, and the mean of 1/(p + q cos k) is
    # 1/sqrt(p^2 - q^2) with p = 1 - 2ic, q = 2ic.
    p, q = 1 - 2 * sp.I * c, 2 * sp.I * c
    slow = -1 + 1 / sp.sqrt(sp.expand(p**2 - q**2))
    # |1 - 1/w| = 2r with w = sqrt(1 - 4ic), |w|^2 = S = sqrt(1 + 16 c^2), (Re w)^2 = (S + 1)/2.
    keep = 1 - 4 * ratio**2
    root = ((1 - keep) + sp.sqrt((1 - keep) ** 2 + keep**2)) / keep**2
    return (
        Step("All residues of 1/(k L) together with that at k = 0, which is 2, add to zero",
             equation(total + over_roots(1, M_minus), -2), _sums),
        Step("The contour of (49) at zeta = 0, laid on the real axis; odd parts cancel",
             equation(total, -1 + v / sp.pi * along), _sums),
        Step("Sum the integrand over all periods, for any A with Re A > 0",
             equation(comb, period), _comb),
        Step("So one period is enough", equation(total, -1 + over_period / (2 * sp.pi)), _sums),
        Step("Static limit v -> 0", equation(static, slow), _static),
        Step("Static fronts end where |Sigma_0| = 2 r; with S = |1 - 4ic|",
             sp.Tuple(equation(c_pin, sp.sqrt(modulus**2 - 1) / 4), equation(modulus, root)),
             _pinning),
        Step("This needs r < 1/2; by (54) that is eta < eta_max",
             equation(eta_max, sp.solve(sp.Eq(4 * (1 - sp.sqrt(1 - 8 * eta)),
                                              1 + sp.sqrt(1 - 8 * eta)), eta)[0]), _largest_eta),
        Step("Strong coupling, k = kappa / sqrt(c), v = V sqrt(c): one root stays above the axis",
             equation(kappa, -V + sp.I * sp.sqrt(sp.I - V**2)), _continuum_root),
        Step("and with q for that square root the kinetic relation becomes",
             sp.Tuple(equation(spread, sp.sqrt(sp.I - V**2)),
                      equation(sp.Abs(spread * (V - sp.I * spread)), 1 / (2 * ratio))),
             _continuum),
    )  # fmt: skip


_SCENES = ((0.5, 0.5), (1.2, 0.4), (0.8, 0.9))


def _sums(candidate: sp.Basic) -> Evidence:
    """Put the time-domain front's sum in the place of M+, and evaluate the rest numerically."""
    worst = 0.0
    for fast, spring in _SCENES:
        exact = sp.sympify(numbers.kinetic_sum(fast, spring))
        left, right = (side.xreplace({over_roots(1, M_plus): exact}) for side in candidate.args)
        worst = max(worst, abs(numbers.evaluated(left - right, {v: fast, c: spring})))
    # Roots below the axis are summed with extrapolation, good to 1e-9; integrals to 1e-10.
    return Evidence(worst < 1e-7, f"phi(0) in the time domain: off by at most {worst:.1e}")


def _comb(candidate: sp.Basic) -> Evidence:
    import numpy as np

    worst = 0.0
    for fast, number, at in ((0.6, 0.5 - 0.4j, 0.7), (1.4, 0.5 - 0.9j, -2.1)):
        left, right = candidate.args
        function = sp.lambdify((m, v, a_of_k, k), left.args[0], "numpy")
        places = np.arange(-20000, 20001)
        direct = complex(function(places, fast, number, at).sum())
        # The tail beyond 20000 terms is 2/(4 pi^2 20000 v) to relative order 1/20000.
        direct += 2 / (4 * math.pi**2 * 20000.5 * fast)
        exact = value(right, {v: fast, a_of_k: number, k: at})
        worst = max(worst, abs(direct - exact))
    return Evidence(worst < 1e-8, f"40001 terms and their tail: off by at most {worst:.1e}")


def _static(candidate: sp.Basic) -> Evidence:
    """Check with a front so slow that the correction, about e^{-strip/v}, is below rounding."""
    worst = 0.0
    for spring in (0.2, 0.6):
        exact = numbers.kinetic_sum(0.02, spring)
        worst = max(worst, abs(solved_for(candidate, static, {c: spring}) - exact))
    return Evidence(worst < 1e-9, f"the front in the time domain at v = 0.02: {worst:.1e}")


def _pinning(candidate: sp.Basic) -> Evidence:
    """Against a standing chain: geometric tails on both sides of the step, matched at phi_us."""
    worst = 0.0
    threshold, root = candidate.args
    for r in (0.2, 0.35, 0.45):
        size = solved_for(root, modulus, {ratio: r}).real
        spring = solved_for(threshold, c_pin, {modulus: size}).real
        if spring <= 0 or abs(math.hypot(1, 4 * spring) - size) > 1e-9:
            return Evidence(False, "S is not |1 - 4ic|")
        worst = max(worst, abs(abs(_standing(spring)) - r))
    return Evidence(worst < 1e-9, f"the last site of a standing chain is off by {worst:.1e}")


def _standing(spring: float, sites: int = 60) -> complex:
    """phi/phi_s at the first site ahead of a standing front, by solving the linear chain."""
    import numpy as np

    chain = 0.5 * np.eye(2 * sites) - 0.5j * spring * (
        2 * np.eye(2 * sites) - np.eye(2 * sites, k=1) - np.eye(2 * sites, k=-1)
    )
    chain[0, 0] -= -0.5j * spring  # the far ends repeat their neighbour
    chain[-1, -1] -= -0.5j * spring
    pull = np.zeros(2 * sites, complex)
    pull[:sites] = 0.5
    return complex(np.linalg.solve(chain, pull)[sites])


def _largest_eta(candidate: sp.Basic) -> Evidence:
    import numpy as np

    limit = solved_for(candidate, eta_max, {}).real
    squares = np.roots([limit / 8, -1 / 4, 1.0]).real
    found = math.sqrt(squares.min() / squares.max())
    return Evidence(abs(found - 0.5) < 1e-12, f"the cycles of that eta have the ratio {found:.12f}")


def _continuum_root(candidate: sp.Basic) -> Evidence:
    """Check with the root nearest the origin at very large c, found in its strip."""
    speed, errors = 0.8, []
    for spring in (1e4, 1e6):
        exact = numbers.roots(speed * math.sqrt(spring), spring, 2)
        nearest = exact[abs(exact).argmin()] * math.sqrt(spring)
        errors.append(abs(solved_for(candidate, kappa, {V: speed}) - nearest))
    holds = errors[1] < 1e-4 and errors[1] < errors[0] / 5
    return Evidence(holds, f"distance at c = 1e4, 1e6: {errors[0]:.1e}, {errors[1]:.1e}")


def _continuum(candidate: sp.Basic) -> Evidence:
    """Against the periodised integral at large c, by the trapezoidal rule."""
    import numpy as np

    speed, errors = 0.8, []
    for spring in (1e3, 1e5):
        fast = speed * math.sqrt(spring)
        # The strip is about |kappa|/sqrt(c) wide, so 60 sqrt(c) points reach rounding.
        count = 2 * int(30 * math.sqrt(spring))
        wave = 2 * np.pi * np.arange(count) / count - np.pi
        own = 0.5 - 1j * spring * (1 - np.cos(wave))
        hyper = (1 - np.exp(-2 * own / fast)) / (
            1 + np.exp(-2 * own / fast) - 2 * np.cos(wave) * np.exp(-own / fast)
        )
        total = -1 + (hyper / (2 * own)).mean()
        root, relation = parts_of(candidate)
        q = solved_for(root, spread, {V: speed})
        left, right = (value(side, {V: speed, spread: q, ratio: abs(total) / 2})
                       for side in relation.args)  # fmt: skip
        errors.append(abs(left - right))
    holds = errors[1] < 1e-3 and errors[1] < errors[0] / 5
    return Evidence(holds, f"difference at c = 1e3, 1e5: {errors[0]:.1e}, {errors[1]:.1e}")
