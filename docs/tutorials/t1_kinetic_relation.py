r"""
The kinetic relation and its branches
=====================================

One equation gives every velocity at which a front of the simplified chain can travel. It has more
than one solution, and not every solution is a front.

The piecewise-linear chain (44) has travelling fronts :math:`\varphi_n(t) = \varphi(n - vt)`, and
their velocity solves the kinetic relation (54),

.. math:: |\Sigma(v, c)| = 2 \frac{|\varphi_{us}|}{|\varphi_s|}, \qquad
          \Sigma(v, c) = \sum_{k \in M^+} \frac{1}{k L_k} .

The right-hand side depends on :math:`\eta = b/a^2` alone.
"""

import numpy as np

import fronts as fr

# %%
# At one coupling
# ---------------
# Above the pinning coupling ``c_pin`` no front can stand still.

one = fr.kinetic_relation(c=0.5, eta=1 / 32)
one

# %%
# ``slope`` is the sign of d\|Σ\|/dv. ``error`` is confirmed by a change of sign of the residual
# between ``v - error`` and ``v + error``.

one.branches[0]

# %%
# Hysteresis
# ----------
# Between ``c_fold`` and ``c_pin`` a front at rest remains at rest and a moving one continues to
# move. There two velocities solve the relation, and only the faster one is admissible: its profile
# crosses the threshold once.

below = fr.kinetic_relation(c=0.45, eta=1 / 32)
print(f"c_fold = {below.c_fold:.6f}, c_pin = {below.c_pin:.6f}")
for branch in below.branches:
    print(f"v = {branch.v:.12f}, admissible: {branch.admissible}")

# %%
# The curve
# ---------
# Given many couplings the function returns the curve, with every branch at each of them.

curve = fr.kinetic_relation(c=np.linspace(0.42, 1.2, 79), eta=1 / 32)
curve.plot()

# %%
# The exponent of v(c)
# --------------------
# The paper concludes from its Fig. 17 that the velocity is asymptotically linear in c. The local
# exponent d ln v / d ln c is a sharper test: it falls through one and tends to one half, since v
# grows like :math:`\sqrt{c}` at strong coupling.

for c in (1.0, 10.0, 100.0, 1000.0):
    fastest = fr.kinetic_relation(c=c, eta=1 / 32).branches[-1]
    print(f"c = {c:7g}: v = {fastest.v:.6f}, exponent {c / fastest.v * fastest.by_c:.4f}")
