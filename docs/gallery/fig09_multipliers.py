"""
Fig. 9: Floquet multipliers of a breather against coupling
==========================================================

One multiplier is always 1, that of a shift in time. Close to c = 0.191 two others reach the unit
circle almost together: one belongs to an odd perturbation, with which the breather loses stability,
and the other to the fold just beyond, in which it ends.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

axes = plt.subplots(layout="constrained")[1]
for c in np.append(np.linspace(0.05, 0.18, 8), [0.185, 0.188, 0.19]):
    found = fr.breather(fr.VdpChain(a=2.5, b=0.5, c=c, sites=11), method="orbit")
    moduli = np.abs(found.multipliers)
    axes.plot(np.full(moduli.size, c), moduli, "o", ms=3, color="#0072B2")
axes.axhline(1.0, color="0.5", lw=0.8)
axes.set(xlabel="coupling c", ylabel="modulus of the Floquet multipliers")
