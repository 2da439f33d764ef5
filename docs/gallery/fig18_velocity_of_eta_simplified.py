"""
Fig. 18: velocity against η, simplified chain
=============================================

The velocity falls with η, that is, with weaker driving, and the front stops at a finite velocity.
"""

import numpy as np

import fronts as fr

curve = fr.kinetic_relation(c=0.3, eta=np.linspace(0.001, 0.022, 106))
curve.plot()
