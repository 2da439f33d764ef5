"""
Fig. 16: the shape of the front, in closed form
===============================================

The modulus crosses the threshold once, at ζ = 0, so that the front is admissible; behind it the
profile settles on the stable cycle, and ahead of it on rest.
"""

import fronts as fr

fr.front_profile(c=0.5, a=4, b=0.5).plot()
