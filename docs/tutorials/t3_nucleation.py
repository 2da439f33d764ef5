"""
Nucleation and the decay of nuclei
==================================

A nucleus remains localised, spreads or decays. The outcome depends on the coupling, on the driving
and on the phases inside the nucleus.

Here the same nucleus of one site is started in three chains, which differ in the coupling c or in
η = b/a².
"""

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

# %%
# Three outcomes
# --------------
# At weak coupling the result is a breather. At stronger coupling the neighbours are driven beyond
# the unstable cycle, and a front leaves on each side. If the driving is weak (large η), the site
# loses more energy to its neighbours than it receives, and returns to rest.

cases = {
    "remains": fr.AveragedChain(a=2.5, b=0.5, c=0.1, sites=31),
    "spreads": fr.AveragedChain(a=2.5, b=0.5, c=0.25, sites=31),
    "decays": fr.AveragedChain(a=2.5, b=0.11 * 2.5**2, c=0.25, sites=31),
}
figure, panels = plt.subplots(1, 3, figsize=(10, 3.4), sharey=True, layout="constrained")
for axes, (name, chain) in zip(panels, cases.items(), strict=True):
    run = fr.simulate(chain, fr.excite(chain, [16]), t_end=6000)
    image = axes.imshow(
        run.amplitude.T, origin="lower", aspect="auto", extent=(0, 6000, 0.5, 31.5), vmin=0, vmax=3
    )
    axes.set(
        title=f"{name}: η = {chain.eta:.2g}, c = {chain.c}", xlabel="time t", xticks=(0, 2500, 5000)
    )
    print(
        f"{name}: {np.count_nonzero(run.amplitude[-1] > chain.unstable_amplitude)} sites at the end"
    )
panels[0].set_ylabel("site n")
figure.colorbar(image, ax=panels, label="amplitude")

# %%
# The coupling at which a breather ends
# -------------------------------------
# Continuation gives the coupling at the fold without a run in time. Such a threshold is meaningful
# only with its definition; here it is the coupling up to which the breather exists.

for size, pattern in ((1, ""), (3, "-+"), (5, "--++")):
    found = fr.threshold(fr.AveragedChain(a=2.5, b=0.5, c=0.1), fr.Nucleus(size, pattern))
    print(f"{size} site(s): exists up to c = {found.c_crit:.7f}; {found.mechanism.value}")

# %%
# Phases matter
# -------------
# Three sites that start in phase do not remain in phase. To leading order in c, the phases inside
# an odd nucleus of equal amplitudes can be locked only at steps of ±π/2, and the run tends to such
# a state.

chain = fr.AveragedChain(a=2.5, b=0.5, c=0.1, sites=15)
run = fr.simulate(chain, fr.excite(chain, [7, 8, 9]), t_end=20000)
phase = np.unwrap(np.arctan2(run.y, run.velocity), axis=0)
axes = plt.subplots(layout="constrained")[1]
axes.plot(run.times, np.degrees(phase[:, 7] - phase[:, 6]))
axes.set(xlabel="time t", ylabel="phase of site 8 against site 7 (degrees)")
print(f"at the end: {np.degrees(phase[-1, 7] - phase[-1, 6]):.2f} degrees")

# %%
# The arithmetic preserves the mirror symmetry of this initial condition exactly, so that it is
# never lost. A stable nucleus must also withstand asymmetric perturbations, all of which are
# included in the growth rates of the breather.

locked = fr.breather(chain, nucleus=fr.Nucleus(3, "-+"))
print(f"growth rate of the worst perturbation: {locked.growth:.4f}; stable: {locked.stable}")
