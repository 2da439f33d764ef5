"""
Fig. 8: amplitudes of a breather against coupling
=================================================

The closed form (29), (37) follows the periodic orbits of (8) closely, for the central site and for
its neighbours, until each of the two ends in a fold.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

axes = plt.subplots(layout="constrained")[1]
for method, couplings, style in (
    ("closed-form", np.linspace(0.005, 0.19, 60), "-"),
    ("orbit", np.linspace(0.02, 0.18, 9), "o"),
):
    chains = [fr.VdpChain(a=2.5, b=0.5, c=c, sites=11) for c in couplings]
    outward = np.array([fr.breather(chain, method=method).outward[:2] for chain in chains])
    for site, colour in enumerate(("#0072B2", "#D55E00")):
        label = f"n = {site}, {method}"
        axes.plot(couplings, outward[:, site], style, color=colour, label=label)
axes.set(xlabel="coupling c", ylabel="amplitude")
axes.legend()
