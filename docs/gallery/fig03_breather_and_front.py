"""
Fig. 3: a discrete breather and a front of the friction chain
=============================================================

At c = 0.004 three excited sites remain a breather, and the three curves coincide. At c = 0.02 one
excited site at the edge excites its neighbours, one after the other.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

cases = ((0.004, [15, 16, 17], (200, 400, 600)), (0.02, [1], (400, 700, 1000)))
figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
for axes, (c, sites, times) in zip(panels, cases, strict=True):
    chain = fr.FrictionChain(c=c, v_d=1.25, sites=31)
    run = fr.simulate(chain, fr.excite(chain, sites), t_end=times[-1], times=(0, *times))
    for time, amplitude in zip(times, run.amplitude[1:], strict=True):
        axes.plot(np.arange(1, 32), amplitude, "o-", ms=3, label=f"τ = {time}")
    axes.set(xlabel="site n", ylabel="vibration amplitude", title=f"c = {c}")
    axes.legend()
