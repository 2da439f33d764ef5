"""
Fig. 14: front velocity against η for several a and b
=====================================================

All points lie on one curve: with y/√a in the place of y, equation (8) depends on a and b through
η = b/a² only.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

axes = plt.subplots(layout="constrained")[1]
for a, marker in ((1.0, "o"), (2.5, "s"), (4.0, "^")):
    etas = np.linspace(0.01, 0.07, 5) + 0.003 * (a - 1)
    chains = [fr.AveragedChain(a=a, b=eta * a * a, c=0.3) for eta in etas]
    axes.plot(etas, [fr.measure_front(chain).v for chain in chains], marker, label=f"a = {a:g}")
axes.set(xlabel="η = b/a²", ylabel=r"front velocity $\hat v = v/\varepsilon$")
axes.legend()
