"""Symbols of the averaged chain."""

from __future__ import annotations

import sympy as sp

from derivations.symbols import t

psi = sp.Function("Psi")
"""Complex variable of Eq. (31); ``psi(n, t)``."""
phi = sp.Function("varphi")
"""Its envelope in the rotating frame; ``phi(n, t)``."""
r = sp.Function("r")
"""Amplitudes with phase steps of -π/2; real if springs join odd neighbours only."""
A_n = sp.Symbol("A_n", positive=True)
square = sp.Symbol("s", positive=True)
"""Square of the amplitude of φ at a site."""
radius = sp.Function("r", positive=True)(t)
"""Amplitude of an isolated cell."""
angle = sp.Function("psi", real=True)(t)
"""Its phase in the rotating frame."""
ratio = sp.Symbol("ratio", positive=True)
"""|φ_us| / |φ_s|."""
squares = sp.symbols("s_0:8", positive=True)
divided = sp.Symbol("H", real=True)
"""Divided difference of the damping over several sites."""

amplitude = sp.Function("A")
"""Complex amplitude of ``y = A e^{it} + c.c.``; ``amplitude(n, t)``."""
rho = sp.Function("rho")
"""Twice its modulus for phase steps of -π/2, including further rotations."""
fundamental = sp.Symbol("A_1")
y_next, turn = sp.symbols("y_next turn")
size = sp.Symbol("A_abs", positive=True)
