"""
Maps and sweeps on all cores
============================

A map determines the state of a chain at every point of a grid and locates the boundaries by
bisection. A sweep evaluates a user-defined function at many points. Both use all cores, and both
can be resumed after an interruption.
"""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import fronts as fr

# %%
# A map
# -----
# ``workers`` is the number of processes; by default there is one for each core. The boundaries are
# located by bisection, to the fraction ``refine`` of the spacing of the grid.

chain = fr.AveragedChain(a=4, b=0.5, c=0.6, sites=16)
found = fr.state_map(chain, eta=np.linspace(0.02, 0.13, 8), c=np.linspace(0.05, 0.8, 8), workers=1)
print(found.counts)
found.plot()

# %%
# A sweep
# -------
# The function takes a point and returns named numbers. It must be defined at the top level of a
# module, so that other processes can import it; here one process is enough.


def velocity(point):
    """Return the velocity of a front and its uncertainty."""
    front = fr.measure_front(fr.AveragedChain(a=4, b=16 * point["eta"], c=point["c"]))
    return {"v": front.v, "error": front.error}


points = {"eta": [0.02, 0.03, 0.04], "c": [0.5, 1.0]}
table = fr.sweep(velocity, points, workers=1)
table.to_pandas()

# %%
# Arrays
# ------
# A result may be an array of numbers, of the same shape at all points. ``dims`` names its
# dimensions, which follow those of the points. At the shell, ``fronts map --amplitudes --out
# map.zarr`` stores the amplitude of every site.


def amplitudes(point):
    """Return the amplitude of every site after a while."""
    chain = fr.AveragedChain(a=4, b=0.5, c=point["c"], sites=16)
    run = fr.simulate(chain, fr.excite(chain, [1]), t_end=40)
    return {"amplitude": np.hypot(*run.states[-1])}


fr.sweep(amplitudes, {"c": [0.1, 0.3, 0.6]}, workers=1, dims={"amplitude": "site"}).to_xarray()

# %%
# Interruptions
# -------------
# With ``out`` every finished point is written at once, and ``resume`` continues from there. A
# record is written beside the table, with parameters, versions and a digest of the code. A file
# that ends in ``.csv`` takes numbers and words, one that ends in ``.zarr`` or ``.npz`` arrays as
# well.

with tempfile.TemporaryDirectory() as folder:
    out = Path(folder) / "velocities.csv"
    fr.sweep(velocity, points, workers=1, out=out)
    again = fr.sweep(velocity, points, workers=1, out=out, resume=True)
    print(sorted(path.name for path in Path(folder).iterdir()))
print(np.array_equal(again["v"], table["v"]))

# %%
# Progress
# --------
# Long computations accept the argument ``progress``. `fronts.Progress` shows one line in a
# terminal, a bar in a notebook, and one line a minute in a log; the remaining time is estimated
# after the compilation.

with fr.Progress("velocities") as shown:
    fr.sweep(velocity, points, workers=1, progress=shown.report)

# %%
# Any executor
# ------------
# ``executor`` takes whatever has the interface of ``concurrent.futures``: a pool of processes, of
# MPI ranks, or of the workers of a cluster. The table is the same, bit for bit.

with ThreadPoolExecutor(1) as pool:
    other = fr.sweep(velocity, points, executor=pool)
print(np.array_equal(other["v"], table["v"]))

# %%
# A cluster
# ---------
# On the workers of a dask cluster (``pip install excitation-fronts[cluster]``, there as here) it is
#
# .. code-block:: python
#
#    from distributed import Client
#
#    client = Client("tcp://host:8786")
#    table = fr.sweep(velocity, points, executor=client.get_executor())
#
# where ``velocity`` is defined in a module that the workers can import. Points that a lost worker
# had not returned are computed again by the others; a point that kills four workers is abandoned
# and named in the error message. `fronts.state_map` takes ``executor`` too, and at the shell
# ``fronts map averaged --scheduler tcp://host:8786`` does the same.

# %%
# At the shell a map is ``fronts map averaged --eta 0.01:0.14:14 --c 0.05:1:20 --out map.csv``,
# which draws a picture with ``--picture`` and continues an interrupted map with ``--resume``.

axes = plt.subplots(layout="constrained")[1]
for eta in points["eta"]:
    rows = table["eta"] == eta
    axes.plot(table["c"][rows], table["v"][rows], "o-", label=f"η = {eta}")
axes.set(xlabel="coupling c", ylabel=r"front velocity $\hat v = v/\varepsilon$")
axes.legend()
