"""
Fig. 18: velocity against η, simplified chain
=============================================

The velocity decreases with η, that is, with weaker driving. The branch ends at a finite velocity,
in a fold.
"""

import numpy as np

import fronts as fr

curve = fr.kinetic_relation(c=0.3, eta=np.linspace(0.001, 0.022, 106))
curve.plot()
