"""
Fig. 17: velocity against coupling, simplified chain
====================================================

The velocity rises steeply from the fold and bends over; no straight line fits it for long.
"""

import numpy as np

import fronts as fr

curve = fr.kinetic_relation(c=np.linspace(0.4, 3.0, 131), a=4, b=0.5)
curve.plot()
