"""
Fig. 2: two states of one friction oscillator
=============================================

At a belt velocity of 1.25 the initial condition decides. A large displacement leads to the
stick–slip cycle, which moves with the belt during stick (flat top in the right panel), and a small
one to steady sliding.
"""

import matplotlib.pyplot as plt

import fronts as fr

chain = fr.FrictionChain(c=0, v_d=1.25, sites=1)
figure, (series, plane) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for name, y in (("stick–slip cycle", 2.0), ("steady sliding", 1.0)):
    run = fr.simulate(chain, fr.excite(chain, [1], y), t_end=150, samples=3001)
    series.plot(run.times, run.y[:, 0], lw=0.8, label=name)
    plane.plot(run.y[:, 0], run.velocity[:, 0], lw=0.8)
series.set(xlabel="time τ", ylabel="displacement y")
series.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
plane.set(xlabel="displacement y", ylabel="velocity dy/dτ")
