r"""
Your own cell
=============

Chains can be made of any oscillator with smooth damping and stiffness, with any coupling. Runs,
fronts, thresholds, breathers and maps are computed for them as for the chains of the paper.
"""

import matplotlib.pyplot as plt
import numba
import numpy as np

import fronts as fr

# %%
# From text
# ---------
# ``damping`` is the coefficient h(y) of the velocity, and ``stiffness`` the restoring force g(y).
# With the paper's damping the cycles are those of (8); they are found from the polynomial and not
# assumed.

chain = fr.OscillatorChain(damping="1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5}, c=0.6)
print(f"cycles: {chain.unstable_amplitude:.6f} (unstable), {chain.stable_amplitude:.6f} (stable)")
own, paper = fr.measure_front(chain), fr.measure_front(fr.VdpChain(a=4, b=0.5, c=0.6))
print(f"own chain v = {own.v:.6f}, VdpChain v = {paper.v:.6f}, each ± {own.error:.0e}")

# %%
# Another cell
# ------------
# With a cubic stiffness the frequency depends on the amplitude, so that sites on the cycle are
# detuned from sites near rest, and the front becomes slower.

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
# ``overdamped`` replaces ÿ by ẏ. With g(y) = y (1 − y)(α − y) this is the Nagumo chain, whose
# fronts travel at :math:`\sqrt{c/2}\,(1 - 2\alpha)` in the continuum limit. On the lattice they are
# slower, and pinned at weak coupling.

axes = plt.subplots(layout="constrained")[1]
couplings = np.array([0.1, 0.3, 0.6, 1.0, 2.0])
found = []
for c in couplings:
    nagumo = fr.OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(alpha - y)", overdamped=True, values={"alpha": 0.3}, c=c
    )
    found.append(fr.measure_front(nagumo))
axes.plot(couplings, [front.v for front in found], "o", label="lattice")
fine = np.linspace(0, 2, 1000)
axes.plot(fine, np.sqrt(fine / 2) * 0.4, label="continuum")
axes.set(xlabel="coupling c", ylabel="front velocity v (sites per unit of time)")
axes.legend()

# %%
# Disorder
# --------
# A parameter may have a different random value at each site; a seed makes these values repeatable.

start = chain.replace(sites=60)
figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
for axes, spread in zip(panels, (0.0, 0.1), strict=True):
    disordered = start.replace(disorder={"a": spread}, seed=1) if spread else start
    run = fr.simulate(
        disordered, fr.excite(disordered, [1, 2, 3]), t_end=6000, estimate_error=False
    )
    image = axes.imshow(
        run.amplitude.T,
        origin="lower",
        aspect="auto",
        extent=(0, 6000, 0.5, 60.5),
        vmin=0,
        vmax=4.5,
    )
    axes.set(title=f"spread of a: {spread}", xlabel="time t")
panels[0].set_ylabel("site n")
figure.colorbar(image, ax=panels, label="amplitude")

# %%
# A force
# -------
# ``drive`` applies harmonic forces F cos(ωt + phase) to chosen sites. A weak force at the end of a
# chain at rest moves only a few sites; a force that drives the end beyond the unstable cycle starts
# a front.

for force in (0.005, 0.03):
    driven = start.replace(drive=f"{force},1@1", sites=31)
    run = fr.simulate(driven, np.zeros((2, 31)), t_end=6000, estimate_error=False)
    print(f"F = {force}: {np.isfinite(run.arrivals).sum()} of 31 sites reached")

# %%
# Beyond polynomials
# ------------------
# Forces that are not polynomials are given as functions compiled by numba, g(y) and h(y, v) with v
# = ẏ. Further arguments are named parameters. Averaging is possible only for polynomials, and
# breathers require the derivatives too, as ``(g, g_y)`` and ``(h, h_y, h_v)``. An expression of
# SymPy becomes such a function by ``numba.njit(sympy.lambdify((y, v), expression, "math"))``.


@numba.njit
def gain(y, v, p):
    """Return a coefficient that damps near rest and at large y, and drives in between."""
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
# A new right-hand side requires one dataclass and one function. The docstring of
# `theory.chains.chain` describes this step by step, and ``examples/your_own_model.py`` is a
# complete example.
