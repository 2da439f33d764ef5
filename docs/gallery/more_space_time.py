"""
A front in space and time
=========================

Three sites at the left are excited. The dots are the times at which the sites are reached; their
slope is the velocity.
"""

import fronts as fr

chain = fr.AveragedChain(a=4, b=0.5, c=0.6, sites=60)
run = fr.simulate(chain, fr.excite(chain, [1, 2, 3]), t_end=8000)
run.plot()
