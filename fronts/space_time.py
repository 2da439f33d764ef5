"""Space-time pictures of a run: amplitude by site and time, and when each site was reached."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def draw_space_time(
    path: Path,
    times: FloatArray,
    amplitude: FloatArray,
    arrivals: FloatArray,
    mark: str,
    clock: str = "time t",
    quantity: str = "amplitude |Ψ|",
) -> None:
    """Draw the amplitude over site and time into a file.

    Parameters
    ----------
    path : Path
        Ends in .png, .svg or .pdf.
    times : ndarray, shape (M,)
        Times of the rows.
    amplitude : ndarray, shape (M, N)
        Amplitudes.
    arrivals : ndarray, shape (N,)
        Time at which each site was reached, nan where it was not.
    mark : str
        What it is to be reached, for the legend.
    clock, quantity : str, optional
        Names of the time and of the amplitude.
    """
    from matplotlib.figure import Figure

    from paper_checks.report.pictures import save

    figure = Figure(figsize=(5.0, 3.6), layout="constrained")
    axes = figure.subplots()
    count = amplitude.shape[1]
    image = axes.imshow(
        amplitude.T,
        origin="lower",
        aspect="auto",
        extent=(float(times[0]), float(times[-1]), 0.5, count + 0.5),
        cmap="cividis",
        vmin=0.0,
        interpolation="nearest",
    )
    reached = np.flatnonzero(~np.isnan(arrivals))
    if reached.size:
        axes.plot(
            arrivals[reached],
            reached + 1,
            "o",
            ms=2.0,
            color="#D55E00",
            label=mark,
        )
        axes.legend(loc="upper left", fontsize=7, framealpha=0.8)
    axes.set(xlabel=clock, ylabel="site n")
    axes.locator_params(axis="x", nbins=6)
    figure.colorbar(image, ax=axes, label=quantity)
    save(path, figure, dpi=160)
