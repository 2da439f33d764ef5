"""
Fig. 6: velocity of a stick–slip front against coupling
=======================================================

Above the critical coupling the velocity rises steeply, and then almost linearly. The dashed line is
the largest group velocity of linear waves about steady sliding.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

couplings = np.array([0.013, 0.02, 0.03, 0.045, 0.06, 0.08, 0.1])
chains = [fr.FrictionChain(c=c, v_d=1.25, sites=41) for c in couplings]
measured = [fr.measure_front(chain, accuracy=0.02) for chain in chains]
axes = plt.subplots(layout="constrained")[1]
axes.errorbar(
    couplings, [m.v for m in measured], [m.error for m in measured], fmt="o-", ms=4, label="front"
)
axes.plot(
    couplings,
    [chain.largest_group_velocity for chain in chains],
    "--",
    color="0.5",
    label="fastest linear wave",
)
axes.set(xlabel="coupling c", ylabel="front velocity v (sites per unit of τ)")
axes.legend()
