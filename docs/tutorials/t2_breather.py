r"""
A breather four ways, and its stability
=======================================

In a breather one site is on the stable cycle and the others remain near rest. Four methods compute
it, and the differences between them show the accuracy of each.

If :math:`8b < a^2`, an isolated site of the Van der Pol chain (8) has two cycles besides rest. At
weak coupling one site can remain on the stable cycle, while its neighbours follow with amplitudes
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
# The methods are the closed form (29), (37); the averaged chain (43), solved exactly; the periodic
# orbit of (8), found by shooting; and a run of (8) from a perturbed initial condition until it is
# periodic. ``error`` is the distance of the amplitudes from those of a solution of (8).

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
# The Floquet multipliers of the orbit are the factors by which small perturbations grow in one
# period. One of them is 1, since a shift in time leads to the same orbit. The breather is stable if
# all others lie inside the unit circle.

orbit = found.methods["orbit"]
moduli = np.sort(np.abs(orbit.multipliers))
print(f"stable: {orbit.stable}; largest moduli {moduli[-3:]}")

axes = plt.subplots(layout="constrained")[1]
angle = np.linspace(0, 2 * np.pi, 400)
axes.plot(np.cos(angle), np.sin(angle), color="0.7", lw=0.8)
axes.plot(orbit.multipliers.real, orbit.multipliers.imag, "o", ms=5, mfc="none")
axes.set(xlabel="Re μ", ylabel="Im μ", xlim=(0.8, 1.03), ylim=(-0.08, 0.08))
axes.set_aspect("equal")

# %%
# The averaged chain predicts the same multipliers without an orbit: :math:`\mu =
# e^{2\pi\varepsilon\lambda}`, where λ is a growth rate of the rotating solution of (43).

growth = found.methods["envelope"].growth
print(f"averaged: exp(2π ε λ) = {np.exp(2 * np.pi * chain.eps * growth):.6f}")
print(f"orbit:                  {moduli[-2]:.6f}")

# %%
# Where it ends
# -------------
# As the coupling increases, the stable breather meets an unstable one in a fold. Continuation
# follows the branch around the fold, which is then located with a stated error.

threshold = fr.threshold(chain)
print(f"c = {threshold.c_crit:.8f} (error {threshold.error:.1e}); {threshold.mechanism.sentence}")
