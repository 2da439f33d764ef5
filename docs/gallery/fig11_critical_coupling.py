"""
Fig. 11: critical coupling against nucleus size
===============================================

As the coupling increases, the breather of one site is the first to end in a fold and that of three
sites the last; from five sites on the size makes no difference. Each value is found by continuation
of the breather of the averaged chain, without a run in time.
"""

import matplotlib.pyplot as plt

import fronts as fr

chain = fr.AveragedChain(a=2.5, b=0.5, c=0)
sizes = (1, 3, 5, 7, 9)
found = [fr.threshold(chain, fr.Nucleus(n, "-" * (n // 2) + "+" * (n // 2))) for n in sizes]
axes = plt.subplots(layout="constrained")[1]
axes.plot(sizes, [each.c_crit for each in found], "o-")
axes.set(xlabel="nucleus size (sites)", ylabel="coupling c at the fold", xticks=sizes)
