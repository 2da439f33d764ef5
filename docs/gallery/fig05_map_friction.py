"""
Fig. 5: states of the friction chain over coupling and belt velocity
====================================================================

At weak coupling stick–slip motion remains where it was started (breather), at stronger coupling it
spreads (front), and on a fast belt it ends (fixed point, that is, steady sliding). The paper's map
has more points.
"""

import numpy as np

import fronts as fr

chain = fr.FrictionChain(c=0.02, sites=31)
found = fr.state_map(
    chain, c=np.linspace(0.005, 0.095, 7), v_d=np.linspace(1.05, 1.95, 7), refine=0, workers=1
)
found.plot()
