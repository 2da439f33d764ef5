"""Symbols of the front, and their notation in the paper."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.sums import SumOver
from derivations.averaging import symbols as averaging
from derivations.symbols import a, b, c, epsilon, n, t
from derivations.transcription.latex_reader import Notation

eta = sp.Symbol("eta", positive=True)
v = sp.Symbol(r"\hat{v}", positive=True)
speed = sp.Symbol("v", positive=True)
k = sp.Symbol("k")
zeta = sp.Symbol("zeta", real=True)
phi_s, phi_us, F = sp.symbols("varphi_s varphi_us F")
phi = sp.Function("varphi")
"""Envelope ``phi(n, t)`` of site n; with one argument the profile ``phi(zeta)``."""
phi_hat = sp.Function(r"\hat{\varphi}")
L = sp.Function("L")
L_k, M_plus, M_minus = sp.symbols("L_k M^+ M^-")
ratio = sp.Symbol("r", positive=True)
static_sum, retreating_sum, strong_sum = sp.symbols("Sigma_0 Sigma_- Sigma_infinity")
c_pin, c_retreat = sp.symbols("c_pin c_retreat", positive=True)
p = sp.Symbol("p", positive=True)
V = sp.Symbol("V", positive=True)
kappa, long_wave = sp.symbols("kappa L_infinity")
radius = averaging.radius
phase = sp.Function("vartheta", real=True)(t)
growth_inside = sp.Symbol("lambda_us", positive=True)
radial_rate = sp.Symbol("lambda_r", positive=True)
deviation = sp.Function("u")(t)
x = sp.Symbol("x", real=True)
y = sp.Symbol("y", real=True)

half_real, half_imag, height = sp.symbols("Re(L) Im(L) kappa_r", real=True)
turns = sp.Symbol("m", integer=True)
root_count = sp.Symbol("N", integer=True)
position, q = sp.symbols("x q", real=True)
w_1, w_2, w_3 = sp.symbols("omega_q omega_qq omega_qqq", real=True)
w_3_size = sp.Symbol("g", positive=True)
"""Modulus of the third derivative of the frequency for the fastest wave."""
length = sp.Symbol("ell", positive=True)
kappa_front = sp.Symbol("kappa_f", real=True)
deviation_field = sp.Function("z", real=True)
envelope = sp.Function("psi", real=True)(position, t)
profile = sp.Function("rho", real=True)
inner_position = sp.Symbol("z", real=True)
inner = profile(inner_position)


def over_roots(numerator: sp.Expr | int, roots: sp.Symbol) -> SumOver:
    """Return the sum of ``numerator / (k L_k)`` over a set of roots."""
    return SumOver(numerator / (k * L_k), k, roots)


_SITES = {"n": n, "n+1": n + 1, "n-1": n - 1}
NOTATION = Notation(
    names={
        "a": a, "b": b, "c": c, r"\varepsilon": epsilon, r"\eta": eta, r"\hat{v}": v, "v": speed,
        "k": k, r"\zeta": zeta, "n": n, "t": t, r"\varphi_{s}": phi_s, r"\varphi_{us}": phi_us,
        "F": F, r"\varphi": phi(zeta), "L_{k}": L_k, "M^{+}": M_plus, "M^{-}": M_minus,
        **{rf"\varphi_{{{name}}}": phi(place, t) for name, place in _SITES.items()},
        r"\dot{\varphi}_{n}": phi(n, t).diff(t),
    },
    functions={
        r"\varphi": phi, r"\dot{\varphi}": lambda place: phi(place).diff(zeta),
        r"\theta": lambda place: sp.Heaviside(place, sp.Rational(1, 2)), "L": L,
        "L_{k}": lambda _: L_k,
    },
    sum_over=SumOver,
)  # fmt: skip
"""The L_k of (51) is a function of k there and elsewhere its value at a root: one symbol."""
