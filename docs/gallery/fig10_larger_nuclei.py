"""
Fig. 10: breathers with larger nuclei
=====================================

Three and seven sites are on the stable cycle. Their amplitudes are similar, but the sites do not
oscillate in phase; each leads or follows its neighbour by a quarter of a period.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

figure, panels = plt.subplots(2, 2, figsize=(9, 5), sharex=True, layout="constrained")
for (above, below), size in zip(panels.T, (3, 7), strict=True):
    chain = fr.AveragedChain(a=2.5, b=0.5, c=0.1, sites=21)
    found = fr.breather(chain, nucleus=fr.Nucleus(size, "-" * (size // 2) + "+" * (size // 2)))
    sites = np.arange(1, 22)
    above.plot(sites, found.amplitudes, "o-", ms=4)
    above.set(ylabel="amplitude", title=f"nucleus size {size}")
    below.plot(sites, 180 * found.phases, "s", ms=4)
    below.set(xlabel="site n", ylabel="phase (degrees)", yticks=(-90, 0, 90, 180))
