"""
Fig. 12: a front of the Van der Pol chain at three times
========================================================

The sites behind the front oscillate on the stable cycle. From one time to the next the front moves
by the same number of sites.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

chain = fr.VdpChain(a=4, b=0.5, c=0.6, sites=200)
times = (14000, 17000, 20000)
run = fr.simulate(
    chain, fr.excite(chain, [1, 2, 3]), t_end=20000, times=times, estimate_error=False
)
figure, panels = plt.subplots(3, 1, sharex=True, sharey=True, figsize=(8, 5), layout="constrained")
for axes, time, y in zip(panels, times, run.y, strict=True):
    axes.plot(np.arange(1, 201), y, lw=0.8)
    axes.set(ylabel="displacement y", title=f"t = {time}")
panels[-1].set_xlabel("site n")
