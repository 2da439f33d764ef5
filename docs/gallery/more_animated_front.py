"""
An animated front
=================

The moduli of the averaged chain while a front runs through it.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation

import fronts as fr

chain = fr.AveragedChain(a=4, b=0.5, c=0.6, sites=40)
run = fr.simulate(chain, fr.excite(chain, [1, 2, 3]), t_end=5000, samples=41)
figure, axes = plt.subplots(figsize=(6, 3.2), dpi=80, layout="constrained")
(line,) = axes.plot(np.arange(1, 41), run.amplitude[0], "o-", ms=3)
axes.axhline(chain.unstable_amplitude, color="0.5", lw=0.8, label="unstable cycle")
axes.set(xlabel="site n", ylabel="amplitude", ylim=(0, 1.2 * chain.stable_amplitude))
axes.legend(loc="upper right")


def show(frame: int) -> None:
    """Show one sample."""
    line.set_ydata(run.amplitude[frame])


animation = FuncAnimation(figure, show, frames=run.times.size, interval=120)
