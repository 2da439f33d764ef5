"""
Fig. 7: a discrete breather of the Van der Pol chain
====================================================

One site is on the stable limit cycle. The amplitudes of its neighbours decrease exponentially, and
each follows the one before it by a quarter of a period.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

chain = fr.VdpChain(a=2.5, b=0.5, c=0.1, sites=31)
start = fr.excite(chain, [16])
run = fr.simulate(chain, start, t_end=5000, times=np.linspace(4980, 5000, 201))
figure, (space, time) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
space.semilogy(np.arange(1, 32), run.amplitude[-1], "o-", ms=3)
space.set(xlabel="site n", ylabel="amplitude", ylim=(1e-6, 10))
for n in (16, 17, 18):
    time.plot(run.times, run.y[:, n - 1], label=f"site {n}")
time.set(xlabel="time t", ylabel="y")
time.locator_params("x", nbins=5)
time.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False)
