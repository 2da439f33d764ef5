"""Films of simulations: amplitudes of a lattice in the plane, or of a chain over its sites."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from theory.arrays import FloatArray
from theory.parameters import (
    MissingPackageError,
    ParameterError,
    Range,
    check_progress,
    file_path,
    need_instance,
    with_ranges,
    within,
)
from verification.runs.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

FORMATS = (".gif", ".mp4")


FRAMES = Range(1.0, 60.0)
"""Range of the number of frames per second."""


@with_ranges(frames=FRAMES)
def animate(
    run: Trajectory,
    path: Path | str,
    *,
    frames_per_second: float = 15.0,
    note: str = "",
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write a film of a simulation, one frame per sample.

    Parameters
    ----------
    run : Trajectory
        A simulation of any chain.
    path : Path or str
        Name of the file, ending in .gif or .mp4; for .mp4 the program ffmpeg is needed.
    frames_per_second : float, optional
        Number of frames per second, {frames}.
    note : str, optional
        Text that is stored in the file as its comment.
    progress : callable, optional
        Called with the fraction of the frames that have been drawn.

    Returns
    -------
    Path
        The name of the file.

    Raises
    ------
    ParameterError
        If the name of the file has another ending, or an argument is of another kind.
    MissingPackageError
        If ffmpeg is not installed.

    Examples
    --------
    >>> import tempfile
    >>> import fronts as fr
    >>> chain = fr.VdpChain(a=4, b=0.5, c=0.6, sites=5)
    >>> run = fr.simulate(chain, fr.excite(chain, [1]), t_end=5, samples=2, estimate_error=False)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     animate(run, Path(folder) / "run.gif").name
    'run.gif'
    """
    need_instance("run", run, (Trajectory,), "give the result of simulate")
    need_instance("note", note, (str,), "give a text, or leave it out")
    check_progress(progress)
    path = file_path("file of a film", path)
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise ParameterError("file of a film", path, "one ending in .gif or .mp4", "rename it")
    within("frames per second", frames_per_second, *FRAMES)
    import matplotlib as mpl
    from matplotlib import animation
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if kind == ".mp4" and not animation.FFMpegWriter.isAvailable():
        raise MissingPackageError("ffmpeg", "films", "a film in .mp4")
    with mpl.rc_context({"savefig.bbox": None}):
        figure = Figure(figsize=(4.6, 4.0), dpi=100, layout="compressed")
        FigureCanvasAgg(figure)
        axes = figure.subplots()
        show = snapshot(run, axes)
        # In the middle, where `_moving` finds it, whatever style a picture has set before.
        axes.set_title("t", loc="center")
        symbol = "τ" if run.chain.model == "friction" else "t"
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # the layout takes longer than a frame and never changes
        for each in _moving(axes):
            each.set_animated(True)
        writer = _writer(animation, kind, frames_per_second, note, axes)
        with writer.saving(figure, str(path), dpi=100):
            for at, time in enumerate(run.times):
                show(at)
                axes.set_title(f"{symbol} = {time:.6g}", loc="center")
                writer.grab_frame()
                if progress is not None:
                    progress((at + 1) / len(run.times))
    return path


def _moving(axes: Axes) -> Sequence[Artist]:
    """Return what differs from frame to frame."""
    return [*axes.lines, *axes.images, *axes.collections, axes.title]


def _writer(animation: Any, kind: str, frames_per_second: float, note: str, axes: Axes) -> Any:
    if kind == ".mp4":
        return animation.FFMpegWriter(fps=frames_per_second, metadata={"comment": note})

    from PIL import Image

    class Commented(animation.PillowWriter):  # type: ignore[misc]
        """Matplotlib's writer, extended by a comment in the file.

        Axes, ticks and labels, which take most of the time of a frame, are drawn only once.
        """

        _still: Any = None

        def grab_frame(self, **options: Any) -> None:
            canvas = self.fig.canvas
            if self._still is None:
                canvas.draw()
                self._still = canvas.copy_from_bbox(self.fig.bbox)
            canvas.restore_region(self._still)
            for each in _moving(axes):
                axes.draw_artist(each)
            self._frames.append(Image.fromarray(np.array(canvas.buffer_rgba())))

        def finish(self) -> None:
            self._frames[0].info["comment"] = note.encode()
            super().finish()

    return Commented(fps=frames_per_second)


def snapshot(run: Trajectory, axes: Axes, **style: Any) -> Callable[[int], None]:
    """Draw the first sample of a simulation, and return a function that replaces it by another.

    Parameters
    ----------
    run : Trajectory
        A simulation of a lattice, whose sites are drawn at their positions, or of a chain.
    axes : matplotlib.axes.Axes
        Axes in which to draw.
    **style
        Options passed on to Matplotlib.
    """
    amplitude = run.amplitude
    top = float(amplitude.max()) or 1.0
    shape = getattr(run.chain, "shape", None)
    if shape is None:
        sites = np.arange(1, amplitude.shape[1] + 1)
        (curve,) = axes.plot(sites, amplitude[0], **{"color": "#0072B2", **style})
        axes.set(xlabel="site n", ylabel="amplitude", ylim=(0.0, 1.05 * top))
        return lambda at: curve.set_ydata(amplitude[at])
    places = run.chain.links.positions
    look = {"cmap": "cividis", "vmin": 0.0, "vmax": top, **style}
    square = label_plane(axes, places)
    if square:
        image = axes.imshow(
            amplitude[0].reshape(shape), origin="lower", interpolation="nearest", **look
        )
        axes.figure.colorbar(image, ax=axes, label="amplitude")
        return lambda at: image.set_data(amplitude[at].reshape(shape))
    size = min(60.0, 12_000.0 / len(places))  # so that neighbours nearly touch
    dots = axes.scatter(places[:, 0], places[:, 1], size, amplitude[0], marker="h", **look)
    axes.figure.colorbar(dots, ax=axes, label="amplitude")
    return lambda at: dots.set_array(amplitude[at])


def label_plane(axes: Axes, places: FloatArray) -> bool:
    """Label the axes of a lattice, and return whether its sites are in the rows of a square one."""
    square = bool(np.array_equal(places, np.round(places)))
    names = ("column", "row") if square else ("x (lattice spacings)", "y (lattice spacings)")
    axes.set(xlabel=names[0], ylabel=names[1])
    axes.locator_params(integer=True)
    axes.set_aspect("equal")
    return square
