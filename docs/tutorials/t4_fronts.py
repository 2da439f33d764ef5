r"""
Fronts and their velocity law
=============================

The velocity of a front of the Van der Pol chain is measured in runs, computed as the solution of an
equation, and followed to strong coupling.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

# %%
# One front
# ---------
# The chain is made longer until the velocity has settled; the uncertainty includes the drift that
# is still to be expected.

chain = fr.AveragedChain(a=4, b=0.5, c=0.6)
front = fr.measure_front(chain)
print(f"v = {front.v:.8f}, uncertain by {front.error:.1e}. {front.status.sentence}")
front.plot()

# %%
# The same front as a solution
# ----------------------------
# A front that travels without change of shape solves an advance–delay equation, and Newton's method
# finds its velocity without a fit. Followed towards weak coupling, the front ends where it is
# pinned.

branch = fr.follow_front(fr.AveragedChain(a=4, b=0.5, c=0), [0.11, 0.15, 0.2, 0.3, 0.45, 0.6])
for point in branch.points:
    print(f"c = {point.chain.c:.2f}: v = {point.v:.12f}")
print(f"pinned up to c = {branch.c_pin:.9f}; above it v ≈ {branch.square_root:.3f} √(c − c_pin)")

# %%
# Followed in η at a fixed coupling, the front ends in the same way.

branch = fr.follow_front(fr.AveragedChain(a=4, b=0.5, c=0.15), etas=[0.01, 0.03125, 0.05, 0.0595])
for eta, point in zip(branch.values, branch.points, strict=True):
    print(f"η = {eta:.5f}: v = {point.v:.12f}, stable: {point.detail.stable}")
print(f"pinned from η = {branch.eta_pin:.9f} on")

# %%
# The full chain (8) has nearly the same velocity: averaging neglects terms of order ε.

for eps in (0.02, 0.01, 0.005):
    full = fr.measure_front(fr.VdpChain(a=4, b=0.5, c=0.6, eps=eps))
    print(f"ε = {eps:5}: v = {full.v:.5f} ± {full.error:.0e}, off by {full.v - front.v:+.5f}")

# %%
# The law
# -------
# Behind the front the phase changes by a quarter turn from site to site. Waves with this phase step
# have the largest group velocity of the averaged chain, which is c. At strong coupling
#
# .. math:: \hat v = c + \kappa(\eta)\,(c/6)^{1/3} + \dots
#
# so that :math:`(\hat v - c)/(c/6)^{1/3}` tends to a constant of η alone.

couplings = np.array([1.0, 3.0, 10.0, 30.0])
axes = plt.subplots(layout="constrained")[1]
for b in (0.25, 0.5, 0.75):
    chains = [fr.AveragedChain(a=4, b=b, c=c) for c in couplings]
    v = np.array([fr.measure_front(each).v for each in chains])
    axes.semilogx(
        couplings, (v - couplings) / (couplings / 6) ** (1 / 3), "o-", label=f"η = {b / 16:g}"
    )
axes.axhline(0, color="0.6", lw=0.8)
axes.set(xlabel="coupling c", ylabel=r"$(\hat v - c)\,/\,(c/6)^{1/3}$")
axes.legend()

# %%
# Where κ is negative the waves overtake the front
# ------------------------------------------------
# κ changes its sign near η = 0.057. At larger η the velocity depends on the state behind the front.
# For every front, ``outruns_waves`` states whether it is faster than the waves.

for eta in (0.03, 0.07):
    found = fr.measure_front(fr.AveragedChain(a=1, b=eta, c=3.0))
    print(f"η = {eta}: v/c = {found.v / 3.0:.4f}, outruns the waves: {found.outruns_waves}")
