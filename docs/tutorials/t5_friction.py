"""
The friction chain with exact events
====================================

The instants at which a site sticks or begins to slip are located to round-off. This is faster and
more accurate than smoothing the friction law, which would shift every threshold.
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

# %%
# One oscillator
# --------------
# On a belt at velocity 1.25 both steady sliding and the stick–slip cycle are stable; ``basin`` is
# the range of displacements from which the cell, released at zero velocity, returns to steady
# sliding.

one = fr.cell(fr.FrictionCell(v_d=1.25))
print(one.status.sentence)
low, high = one.basin
print(
    f"period {one.stable_cycle.period:.9f}, error {one.error:.1e}; basin {low:.6f} < y < {high:.6f}"
)

# %%
# Events
# ------
# Between two events the equations are smooth, and a step ends at the earliest event of any site.
# During stick the velocity is that of the belt, to the last bit.

chain = fr.FrictionChain(c=0.02, v_d=1.25, sites=15)
run = fr.simulate(chain, fr.excite(chain, [1]), t_end=40, samples=4001, logged_events=1000)
stuck = run.velocity == chain.v_d
print(f"{len(run.event_log)} events; the first at τ = {run.event_log[0, 0]:.12f}")
print(f"site 1 sticks during {np.mean(stuck[:, 0]):.1%} of the time; error {run.error:.1e}")

figure, axes = plt.subplots(figsize=(8, 3.4), layout="constrained")
axes.plot(run.times, run.velocity[:, 0], lw=0.9, label="site 1")
axes.plot(run.times, run.velocity[:, 1], lw=0.9, label="site 2")
axes.set(xlabel="time τ", ylabel="velocity dy/dτ")
axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)

# %%
# A front
# -------
# A site counts as reached when it first sticks.

chain = chain.replace(sites=41)
run = fr.simulate(chain, fr.excite(chain, [1]), t_end=1500)
run.plot()
front = fr.measure_front(chain)
print(f"v = {front.v:.6f} ± {front.error:.1e} sites per unit of τ")

# %%
# A threshold depends on its definition
# -------------------------------------
# The critical coupling depends on the meaning of spreading. For one new site by τ = 1000 and for
# the whole chain by that time, the values differ by a factor of three.

edge = fr.Nucleus(1, place="edge")
for definition in ("first", "whole"):
    found = fr.threshold(
        fr.FrictionChain(c=0), edge, definition=definition, accuracy=1e-4, tests=0, highest=0.1
    )
    print(f"{definition}: {found.low:.6f} < c < {found.high:.6f}")
