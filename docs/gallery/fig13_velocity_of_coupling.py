"""
Fig. 13: front velocity of the Van der Pol chain against coupling
=================================================================

The velocity approaches a straight line. The front travels a little faster than the fastest wave of
the averaged chain (43), whose velocity is c. In the full chain (8) it is slower by a fraction of
order εc.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

couplings = np.array([0.3, 0.6, 1.0, 1.5, 2.0, 3.0])
axes = plt.subplots(layout="constrained")[1]
for kind, marker, label in ((fr.AveragedChain, "o", "Eq. (43)"), (fr.VdpChain, "+", "Eq. (8)")):
    found = [fr.measure_front(kind(a=4, b=0.5, c=c)) for c in couplings]
    axes.plot(couplings, [front.v for front in found], marker, ms=8, mfc="none", label=label)
axes.plot(couplings, couplings, "--", color="0.5", label="fastest wave of (43)")
axes.set(xlabel="coupling c", ylabel=r"front velocity $\hat v = v/\varepsilon$")
axes.legend()
