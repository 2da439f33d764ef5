"""
Every branch through the fold, with its stability
=================================================

The slow branch below the pinning coupling meets the fast one in the fold. The fast branch is
stable up to c = 2.406; beyond, small changes of the switching times grow.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

couplings = np.concatenate([np.linspace(0.4338, 0.47, 40), np.linspace(0.48, 3.0, 64)])
curve = fr.kinetic_relation(c=couplings, eta=1 / 32, stability=True)
kinds = (
    ("stable", "#0072B2", lambda each: each.stable),
    ("unstable", "#D55E00", lambda each: each.admissible and not each.stable),
    ("not admissible", "0.6", lambda each: not each.admissible),
)
axes = plt.subplots(layout="constrained")[1]
for label, colour, belongs in kinds:
    pairs = [(p.c, each.v) for p in curve.points for each in p.branches if belongs(each)]
    axes.plot(*zip(*pairs, strict=True), "o", ms=2.5, color=colour, label=label)
axes.set(xlabel="coupling c", ylabel=r"front velocity $\hat v = v/\varepsilon$")
axes.legend()
