"""
Nucleation, and what kills a nucleus
====================================

A nucleus stays, spreads or dies. Which of the three happens is decided by coupling, driving, and
the phases inside the nucleus.

The same nucleus of one site is started in three chains that differ in the coupling c or in
η = b/a².
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

# %%
# Three outcomes
# --------------
# Weak coupling: a breather. Stronger coupling: the neighbours are pulled over the unstable cycle,
# and a front leaves on each side. Weak driving (large η): the neighbours take more energy than the
# site receives, and it falls back to rest.

cases = {
    "stays": fr.AveragedChain(a=2.5, b=0.5, c=0.1, sites=31),
    "spreads": fr.AveragedChain(a=2.5, b=0.5, c=0.25, sites=31),
    "dies": fr.AveragedChain(a=2.5, b=0.11 * 2.5**2, c=0.25, sites=31),
}
figure, panels = plt.subplots(1, 3, figsize=(10, 3.4), sharey=True, layout="constrained")
for axes, (name, chain) in zip(panels, cases.items(), strict=True):
    run = fr.simulate(chain, fr.excite(chain, [16]), t_end=6000)
    axes.imshow(
        run.amplitude.T, origin="lower", aspect="auto", extent=(0, 6000, 0.5, 31.5), vmin=0, vmax=3
    )
    axes.set(title=f"{name}: η = {chain.eta:.2g}, c = {chain.c}", xlabel="time t")
    print(
        f"{name}: {np.count_nonzero(run.amplitude[-1] > chain.unstable_amplitude)} sites at the end"
    )
panels[0].set_ylabel("site n")

# %%
# The coupling at which a breather ends
# -------------------------------------
# Continuation gives the coupling at the fold without a run in time. It has a meaning only together
# with its definition: here the end of existence, and before it the loss of stability.

for size, pattern in ((1, ""), (3, "-+"), (5, "--++")):
    found = fr.threshold(fr.AveragedChain(a=2.5, b=0.5, c=0.1), fr.Nucleus(size, pattern))
    print(f"{size} site(s): exists up to c = {found.c_crit:.7f}; {found.mechanism.value}")

# %%
# Phases matter
# -------------
# Three sites that start in phase do not stay in phase. To leading order in c the phases inside a
# nucleus of equal amplitudes are locked only at steps of ±π/2 (odd nuclei), and that is where the
# run goes.

chain = fr.AveragedChain(a=2.5, b=0.5, c=0.1, sites=15)
run = fr.simulate(chain, fr.excite(chain, [7, 8, 9]), t_end=20000)
phase = np.unwrap(np.arctan2(run.y, run.velocity), axis=0)
axes = plt.subplots(layout="constrained")[1]
axes.plot(run.times, np.degrees(phase[:, 7] - phase[:, 6]))
axes.set(xlabel="time t", ylabel="phase of site 8 against site 7 (degrees)")
print(f"at the end: {np.degrees(phase[-1, 7] - phase[-1, 6]):.2f} degrees")

# %%
# That start keeps its mirror symmetry for ever, because the arithmetic does. A stable nucleus must
# also stand asymmetric perturbations, and the multipliers of the breather account for all of them.

locked = fr.breather(chain, nucleus=fr.Nucleus(3, "-+"))
print(f"growth rate of the worst perturbation: {locked.growth:.4f}; stable: {locked.stable}")
