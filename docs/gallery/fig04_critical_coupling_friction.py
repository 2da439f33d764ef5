"""
Fig. 4: critical coupling of the friction chain against nucleus size
====================================================================

One site at the edge requires the strongest coupling to spread. From three sites on, neither the
size nor the place makes much difference. A nucleus is said to spread when one new site sticks by τ
= 1000.
"""

import matplotlib.pyplot as plt

import fronts as fr

chain = fr.FrictionChain(c=0, v_d=1.25, sites=31)
sizes = (1, 3, 5, 7)
axes = plt.subplots(layout="constrained")[1]
for place, marker in (("edge", "o-"), ("bulk", "s--")):
    found = [
        fr.threshold(
            chain,
            fr.Nucleus(size, place=place),
            accuracy=1e-4,
            highest=0.05,
            final_time=1000,
            tests=0,
        )
        for size in sizes
    ]
    axes.plot(sizes, [each.c_crit for each in found], marker, label=place)
axes.set(xlabel="nucleus size (sites)", ylabel="critical coupling c", xticks=sizes, ylim=(0, None))
axes.legend()
