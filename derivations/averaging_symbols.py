"""Symbols of the averaged chain: complex variables by offset from site n."""

from __future__ import annotations

import sympy as sp

OFFSETS = (-1, 0, 1)
psi = {o: sp.Symbol(rf"\Psi_{{n{o:+d}}}" if o else r"\Psi_n") for o in OFFSETS}
phi = {o: sp.Symbol(rf"\varphi_{{n{o:+d}}}" if o else r"\varphi_n") for o in OFFSETS}
psi_rate, phi_rate = sp.Symbol(r"\dot{\Psi}_n"), sp.Symbol(r"\dot{\varphi}_n")
y, y_rate, y_second = sp.symbols(r"y_n \dot{y}_n \ddot{y}_n", real=True)
r = {o: sp.Symbol(f"r_{{n{o:+d}}}" if o else "r_n", real=True) for o in OFFSETS}
r_rate, r0_rate, r0, r1 = sp.symbols("r_n' r_0' r_0 r_1", real=True)
s = sp.symbols("s_n s_m s_p", real=True)
h = sp.symbols("h_n h_m h_p", real=True)
A_n = sp.Symbol("A_n", positive=True)
