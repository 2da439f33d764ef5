r"""
Your own cell
=============

Any oscillator with smooth damping and stiffness, on any coupling, can be made a chain, for which
runs, fronts, thresholds, breathers and maps are computed as for those of the paper.
"""

import matplotlib.pyplot as plt
import numba
import numpy as np

import fronts as fr

# %%
# From text
# ---------
# h(y) multiplies the damping and g(y) is the restoring force. With the paper's damping the cycles
# are those of (8); they are found from the polynomial, not assumed.

chain = fr.OscillatorChain(damping="1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5}, c=0.6)
print(f"cycles: {chain.unstable_amplitude:.6f} (unstable), {chain.stable_amplitude:.6f} (stable)")
own, paper = fr.measure_front(chain), fr.measure_front(fr.VdpChain(a=4, b=0.5, c=0.6))
print(f"own chain v = {own.v:.6f}, VdpChain v = {paper.v:.6f}, each ± {own.error:.0e}")

# %%
# Another cell
# ------------
# A cubic stiffness makes the frequency depend on the amplitude, so that sites on the cycle and
# sites at rest are out of tune: the front becomes slower.

for g in (0.0, 1e-4, 2e-4):
    stiff = fr.OscillatorChain(
        damping="1 - a*y**2 + b*y**4",
        stiffness="y + g*y**3",
        values={"a": 4, "b": 0.5, "g": g},
        c=0.6,
    )
    front = fr.measure_front(stiff)
    print(f"g = {g}: v = {front.v:.4f} ± {front.error:.0e}, {front.status.value}")

# %%
# Without inertia
# ---------------
# ``overdamped`` puts ẏ in the place of ÿ. With g(y) = y (1 − y)(α − y) this is the chain of Nagumo,
# whose fronts travel at :math:`\sqrt{c/2}\,(1 - 2\alpha)` in the continuum; the lattice slows them
# and pins them at weak coupling.

axes = plt.subplots(layout="constrained")[1]
couplings = np.array([0.1, 0.3, 0.6, 1.0, 2.0])
found = []
for c in couplings:
    nagumo = fr.OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(alpha - y)", overdamped=True, values={"alpha": 0.3}, c=c
    )
    found.append(fr.measure_front(nagumo))
axes.plot(couplings, [front.v for front in found], "o", label="lattice")
fine = np.linspace(0, 2, 100)
axes.plot(fine, np.sqrt(fine / 2) * 0.4, label="continuum")
axes.set(xlabel="coupling c", ylabel="front velocity")
axes.legend()

# %%
# Disorder
# --------
# Each site has its own value of a parameter; a seed makes it repeatable.

start = chain.replace(sites=60)
figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
for axes, spread in zip(panels, (0.0, 0.1), strict=True):
    disordered = start.replace(disorder={"a": spread}, seed=1) if spread else start
    run = fr.simulate(
        disordered, fr.excite(disordered, [1, 2, 3]), t_end=6000, estimate_error=False
    )
    axes.imshow(run.amplitude.T, origin="lower", aspect="auto", extent=(0, 6000, 0.5, 60.5))
    axes.set(title=f"spread of a: {spread}", xlabel="time t")
panels[0].set_ylabel("site n")

# %%
# A force
# -------
# ``drive`` lets harmonic forces F cos(ωt + phase) act on chosen sites. At the end of a chain at
# rest a weak one moves a few sites; one that takes the end over the unstable cycle starts a front.

for force in (0.005, 0.03):
    driven = start.replace(drive=f"{force},1@1", sites=31)
    run = fr.simulate(driven, np.zeros((2, 31)), t_end=6000, estimate_error=False)
    print(f"F = {force}: {np.isfinite(run.arrivals).sum()} of 31 sites reached")

# %%
# Beyond polynomials
# ------------------
# Forces that are no polynomials are functions that numba compiles: g(y) and h(y, v), with v = ẏ.
# Further arguments are named parameters. Averaging needs polynomials; breathers need the
# derivatives too, as ``(g, g_y)`` and ``(h, h_y, h_v)``. An expression of SymPy becomes such a
# function by ``numba.njit(sympy.lambdify((y, v), expression, "math"))``.


@numba.njit
def gain(y, v, p):
    """Damping at rest and at large y, gain between."""
    return 1 - p * y * y * np.exp(-y * y / 4)


gaining = fr.OscillatorChain(damping=gain, values={"p": 3}, c=0.6)
print(
    f"cycles: {gaining.unstable_amplitude:.4f} (unstable), {gaining.stable_amplitude:.4f} (stable)"
)
front = fr.measure_front(gaining)
print(f"v = {front.v:.4f} ± {front.error:.0e}, {front.status.value}")

# %%
# Another right-hand side
# -----------------------
# A right-hand side of your own is one dataclass and one function, as the docstring of
# `theory.chains.chain` says step by step; ``examples/your_own_model.py`` is complete.
