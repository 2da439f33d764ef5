r"""
A breather four ways, and its stability
=======================================

In a breather one site stays on the stable cycle and the others remain near rest. Four methods
compute it, and the differences between them show how far each can be trusted.

In the Van der Pol chain (8) a site alone has two cycles besides rest, if :math:`8b < a^2`. At
weak coupling one site can stay on the stable cycle, while its neighbours follow with amplitudes
that fall off like :math:`e^{k_1 |n|}`.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

chain = fr.VdpChain(a=2.5, b=0.5, c=0.1, sites=15)
found = fr.breather(chain, method="all")

# %%
# Four methods
# ------------
# The closed form (29), (37); the averaged chain (43), solved exactly; the periodic orbit of (8) by
# shooting; and a run of (8) from a disturbed start until it repeats itself. ``error`` is the
# distance of the amplitudes from those of a solution of (8).

for name, each in found.methods.items():
    centre, neighbour = each.outward[:2]
    print(
        f"{name:12} centre {centre:.6f}  neighbour {neighbour:.6f}  "
        f"frequency {each.frequency:.9f}  error {each.error:.1e}"
    )

# %%
# Only the closed form departs visibly from the others, in the tails, because it assumes the same
# decay from each site to the next.

axes = found.plot()
axes.set_ylim(1e-8, 10)

# %%
# Stability
# ---------
# The Floquet multipliers of the orbit say what a small change becomes after a period. One of them
# is 1: a shift in time changes nothing. The breather is stable if all others lie inside the unit
# circle.

orbit = found.methods["orbit"]
moduli = np.sort(np.abs(orbit.multipliers))
print(f"stable: {orbit.stable}; largest moduli {moduli[-3:]}")

axes = plt.subplots(layout="constrained")[1]
angle = np.linspace(0, 2 * np.pi, 400)
axes.plot(np.cos(angle), np.sin(angle), color="0.7", lw=0.8)
axes.plot(orbit.multipliers.real, orbit.multipliers.imag, "o", ms=4)
axes.set(xlabel="Re μ", ylabel="Im μ", xlim=(0.8, 1.03), ylim=(-0.12, 0.12))

# %%
# The averaged chain predicts the same growth rates without an orbit: a multiplier is
# :math:`\mu = e^{2\pi\varepsilon\lambda}` with an exponent λ of the rotating solution of (43).

growth = found.methods["envelope"].growth
print(f"averaged: exp(2π ε λ) = {np.exp(2 * np.pi * chain.eps * growth):.6f}")
print(f"orbit:                  {moduli[-2]:.6f}")

# %%
# Where it ends
# -------------
# With stronger coupling the stable breather meets an unstable one in a fold. Continuation follows
# the branch around it, so that the coupling at the fold has an error of its own.

threshold = fr.threshold(chain)
print(f"c = {threshold.c_crit:.8f} (error {threshold.error:.1e}); {threshold.mechanism.sentence}")
