"""
Fig. 15: states of the Van der Pol chain over η and coupling
============================================================

At small η the driving is strong and the front runs; at larger η one site remains a breather or
returns to rest. The initial condition is that of the paper, in which the last of sixteen sites is
displaced by 6.
"""

import numpy as np

import fronts as fr

chain = fr.AveragedChain(a=4, b=0.5, c=0.6, sites=16)
found = fr.state_map(
    chain, eta=np.linspace(0.01, 0.14, 14), c=np.linspace(0.05, 1.0, 12), workers=1
)
found.plot()
