"""
The exponent of v(c)
====================

The local exponent d ln v / d ln c of the simplified chain falls through one and tends to one half:
the velocity grows like the square root of c, not like c. The humps near c = 12, 33 and 65 are
resonances of the front with linear waves.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

points = fr.kinetic_relation(c=np.geomspace(0.45, 100, 250), eta=1 / 32).points
fastest = [(point.c, point.branches[-1]) for point in points if point.branches]
axes = plt.subplots(layout="constrained")[1]
axes.semilogx([c for c, _ in fastest], [c / front.v * front.by_c for c, front in fastest])
axes.axhline(0.5, color="0.6", lw=0.8)
axes.set(xlabel="coupling c", ylabel=r"local exponent $d\ln\hat v\,/\,d\ln c$", ylim=(0, 2.5))
