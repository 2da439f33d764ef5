"""
A breather through its fold
===========================

The stable breather meets an unstable one at c = 0.1908 and neither exists beyond. The unstable
branch leads back to weak coupling, with larger amplitudes of the neighbours.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

chain = fr.AveragedChain(a=2.5, b=0.5, c=0.1, sites=11)
branch = fr.follow_breather(chain, np.linspace(0.02, 0.19, 35), method="envelope")
axes = plt.subplots(layout="constrained")[1]
for label, colour, stable in (("stable", "#0072B2", True), ("unstable", "#D55E00", False)):
    points = [each for each in branch.points if each.status == "exists" and each.stable is stable]
    c, second = [each.chain.c for each in points], [each.outward[1] for each in points]
    axes.plot(c, second, "o", color=colour, label=label)
axes.axvline(branch.folds[0].c, color="0.6", lw=0.8, label=f"fold, c = {branch.folds[0].c:.6f}")
axes.set(xlabel="coupling c", ylabel="amplitude of a nearest neighbour")
axes.legend()
