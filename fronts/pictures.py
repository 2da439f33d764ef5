"""One picture for each class of results, registered under the name of the class.

A new picture requires a function ``(result, axes, **style)`` and one line in `DRAWINGS`. The
function receives empty axes and labels them. Matplotlib is imported by the caller.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from fronts.wording import error_name
from verification.pictures.figures import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BLUE, VERMILION, GREEN = (COLOURS[name] for name in ("blue", "vermilion", "green"))


def draw(result: Any, axes: Axes | None = None, **style: Any) -> Axes:
    """Draw a result.

    Parameters
    ----------
    result : Result
        The result.
    axes : matplotlib.axes.Axes, optional
        Axes in which to draw; by default new ones.
    **style
        Options passed on to Matplotlib for the lines of the picture.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError
        If results of this class cannot be drawn.
    """
    names = [each.__name__ for each in type(result).__mro__]
    need_picture(names)
    drawing = next(DRAWINGS[name] for name in names if name in DRAWINGS)
    if axes is None:
        import matplotlib.pyplot as plt

        axes = plt.subplots(layout="compressed")[1]
    drawing(result, axes, **style)
    return axes


def need_picture(names: Sequence[str]) -> None:
    """Refuse classes of results none of which has a picture.

    Raises
    ------
    TypeError
        If none has a picture; the message names the first class.
    """
    if DRAWINGS.keys().isdisjoint(names):
        raise TypeError(
            f"a result of the class {names[0]} cannot be drawn: write its numbers to a .json file."
        )


def _kinetic_point(result: Any, axes: Axes, **style: Any) -> None:
    _branches(axes, [result], "c", style)
    axes.set(xlabel="coupling c", ylabel=SLOW_VELOCITY)
    _explain(axes)


def _kinetic_curve(result: Any, axes: Axes, **style: Any) -> None:
    label = "coupling c" if result.along == "c" else "η = b/a²"
    axes.set(xlabel=label, ylabel=SLOW_VELOCITY)
    _branches(axes, result.points, result.along, style)
    # The whole range is shown, since there is no moving front where it is empty.
    values = [getattr(point, result.along) for point in result.points]
    margin = 0.03 * (max(values) - min(values))
    if margin:
        axes.set_xlim(min(values) - margin, max(values) + margin)
    if result.along == "c":
        _thresholds(axes, result.points[0])
    _explain(axes)


def _explain(axes: Axes) -> None:
    """Add the legend, if there is anything to explain."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend()


def _branches(axes: Axes, points: Any, along: str, style: Mapping[str, Any]) -> None:
    branches = [(getattr(each, along), branch) for each in points for branch in each.branches]
    asked = any(branch.stable is not None for _, branch in branches)
    undecided = "admissible, stability not decided" if asked else "admissible"
    kinds: tuple[tuple[bool | None, bool | None, str, dict[str, Any]], ...] = (
        (True, True, "admissible, stable", {"color": BLUE}),
        (True, False, "admissible, not stable", {"color": GREEN, "marker": "s", "mfc": "none"}),
        (True, None, undecided, {"color": BLUE, "marker": "x" if asked else "o"}),
        (False, None, "not admissible", {"color": VERMILION, "mfc": "none"}),
        (None, None, "not decided", {"color": "0.6"}),
    )
    for admissible, stable, label, look in kinds:
        pairs = [
            (place, branch.v)
            for place, branch in branches
            if (branch.admissible, branch.stable) == (admissible, stable)
        ]
        if pairs:
            shown = {"marker": "o", "ls": "", "ms": 2.2, **look, **style}
            axes.plot(*zip(*pairs, strict=True), label=label, **shown)


def _thresholds(axes: Axes, answer: Any) -> None:
    from paper_checks.report.velocity_plot import draw_thresholds

    low, high = axes.get_xlim()
    names = ("fold", "pin", "retreat", *(["stable"] if answer.limit_shown else []))
    values = {name: getattr(answer, f"c_{name}") for name in names}
    inside = {name: c for name, c in values.items() if c is not None and low < c < high}
    draw_thresholds(axes, inside, "c")
    axes.set_xlim(low, high)


def _roots(result: Any, axes: Axes, **style: Any) -> None:
    for half, label, look in (
        (result.upper, "$M^+$", {"color": BLUE}),
        (result.lower, "$M^-$", {"color": VERMILION, "mfc": "none"}),
    ):
        parts = [(float(root.re), float(root.im)) for root in half]
        if parts:
            axes.plot(*zip(*parts, strict=True), "o", label=label, **{"ms": 3.0, **look, **style})
    axes.axhline(0.0, color="0.5", lw=0.6)
    axes.set(xlabel="Re k (per site)", ylabel="Im k (per site)")
    _explain(axes)


def _profile(result: Any, axes: Axes, **style: Any) -> None:
    axes.set(xlabel="ζ (sites)", ylabel=r"$\varphi/\varphi_s$")
    zeta, phi = result.zeta, result.phi
    axes.plot(zeta, np.abs(phi), **{"color": BLUE, "label": r"$|\varphi|$", **style})
    axes.plot(zeta, phi.real, color=VERMILION, lw=0.9, ls="--", label=r"Re $\varphi$")
    axes.plot(zeta, phi.imag, color=GREEN, lw=0.9, ls=":", label=r"Im $\varphi$")
    axes.axhline(result.threshold, color="0.5", lw=0.8)
    place = (zeta[-1], result.threshold)
    name = r"threshold $|\varphi_{us}|/|\varphi_s|$"
    axes.annotate(name, place, ha="right", va="bottom", fontsize=8, color="0.35")
    axes.legend(title=rf"$\hat v$ = {result.v:.6g}")


def _bifurcation(result: Any, axes: Axes, **style: Any) -> None:
    from paper_checks.report.cell_picture import draw_bifurcation

    draw_bifurcation(axes, result)


def _curve(result: Any, axes: Axes, **style: Any) -> None:
    """Draw the main quantity of the points of a curve: their cycles, or the first of `CURVES`.

    If there are several methods, each has a line of its own.
    """
    table = result.columns()
    if "stable_cycle_max" in table:
        _cycles(table, result.along, axes, style)
        return
    name = next(each for each in CURVES if each in table)
    x, y = table[result.along], table[name].astype(float)
    error = table.get(error_name(name, table))
    known = np.isfinite(y)
    methods = table.get("method", np.full(y.size, ""))
    several = dict.fromkeys(methods[known].tolist())
    for method in several:
        shown = known & (methods == method)
        look = {"label": method} if len(several) > 1 else {"color": BLUE}
        bars = None if error is None else np.nan_to_num(error.astype(float))[shown]
        axes.errorbar(
            x[shown], y[shown], yerr=bars, **{"fmt": "o-", "ms": 2.5, "lw": 0.9, **look, **style}
        )
    chains = (point.chain for point in result.points if hasattr(point, "chain"))
    label = _label(name, next(chains, None))
    axes.set(xlabel=LABELS.get(result.along, result.along), ylabel=label)
    _explain(axes)


def _label(name: str, chain: Any) -> str:
    """Return the label of a quantity of a chain."""
    slow = name == "v" and _in_slow_time(chain)
    return SLOW_VELOCITY if slow else LABELS.get(name, name)


def _in_slow_time(chain: Any) -> bool:
    """Return whether the velocities of a chain are in sites per unit of slow time εt."""
    return getattr(chain, "model", "") == "piecewise" or getattr(chain, "time_unit", 1.0) != 1.0


def _cycles(
    table: Mapping[str, np.ndarray], along: str, axes: Axes, style: Mapping[str, Any]
) -> None:
    """Draw the turning points of the two cycles of a cell, as far as they exist."""
    for name, look in (
        ("stable", {"color": BLUE}),
        ("unstable", {"color": VERMILION, "ls": "--"}),
    ):
        for end, label in (("min", f"{name} cycle"), ("max", "_")):
            column = f"{name}_cycle_{end}"
            if column in table:
                shown = {"marker": "o", "ms": 2.5, "lw": 0.9, "label": label, **look, **style}
                axes.plot(table[along], table[column].astype(float), **shown)
    axes.set(xlabel=LABELS.get(along, along), ylabel="turning points of y")
    _explain(axes)


def _branch(result: Any, axes: Axes, **style: Any) -> None:
    """Draw a branch: solid where it is stable, dashed where it is unstable; mark folds and pinning.

    It is dotted between two folds without a point between them.
    """
    table = result.columns()
    name = next(each for each in BRANCHES if each in table)
    words = [point.to_dict().get("stable") is not False for point in result.points]
    nodes: list[Any] = list(zip(result.values, table[name].astype(float), words, strict=True))
    along = result.along
    turns = [
        (fold.points_before, (getattr(fold, along), fold.height, None)) for fold in result.folds
    ]
    pin = getattr(result, f"{along}_pin")
    if pin is not None:
        end = (sum(node[0] > pin for node in nodes), (pin, 0.0, None))
        # In descending order: fronts at rest come first along η, and last along c.
        turns = [end, *turns] if along == "eta" else [*turns, end]
        turns.sort(key=lambda turn: turn[0])
    symbol = "η" if along == "eta" else along
    for place, node in reversed(turns):
        what = "fold," if node[0] != pin else "pinned from" if along == "eta" else "pinned up to"
        axes.axvline(node[0], color="0.5", lw=0.8, label=f"{what} {symbol} = {node[0]:.6g}")
        nodes.insert(place, node)
    for stable, line, label in (
        (True, "-", "stable"), (False, "--", "not stable"), (None, ":", "stability not decided"),
    ):  # fmt: skip
        colour = {True: BLUE, False: VERMILION, None: "0.6"}[stable]
        look = {"color": colour, "ls": line, "lw": 1.2, **style}
        pairs = [pair for pair in pairwise(nodes) if _kinds(*pair) == {stable}]
        for at, (first, last) in enumerate(pairs):
            ends = [first[0], last[0]], [first[1], last[1]]
            axes.plot(*ends, label="_" if at else label, **look)
        shown = [node[:2] for node in nodes if node[2] is stable]
        if shown and stable is not None:
            axes.plot(*zip(*shown, strict=True), "o", ms=2.5, color=look["color"])
    _explain(axes)
    axes.set(xlabel=LABELS[along], ylabel=SLOW_VELOCITY if name == "v" else LABELS[name])


def _kinds(first: tuple[Any, ...], last: tuple[Any, ...]) -> set[bool | None]:
    """Return the stabilities of two nodes of a branch, of which a fold has that of the other."""
    return {first[2], last[2]} - {None} or {None}


def _breather(result: Any, axes: Axes, **style: Any) -> None:
    _amplitudes(axes, result, {"color": BLUE, **style})


def _breathers(result: Any, axes: Axes, **style: Any) -> None:
    # Hollow marks of different shapes, since the amplitudes of the methods hardly differ.
    for (name, found), mark in zip(result.methods.items(), cycle("os^x"), strict=False):
        _amplitudes(axes, found, {"label": name, "marker": mark, "mfc": "none", "ms": 5.0, **style})
    axes.legend()


def _amplitudes(axes: Axes, found: Any, look: Mapping[str, Any]) -> None:
    if found.amplitudes.size:
        sites = np.arange(1, found.amplitudes.size + 1)
        axes.semilogy(sites, found.amplitudes, **{"marker": "o", "ms": 3.0, "lw": 0.8, **look})
    axes.set(xlabel="site n", ylabel="amplitude")


def _trajectory(result: Any, axes: Axes, **style: Any) -> None:
    amplitude = result.amplitude
    if getattr(result.chain, "shape", None) is not None:
        from fronts.animation import snapshot

        snapshot(result, axes, **style)(-1)
        axes.set_title(f"t = {result.times[-1]:.6g}")
        return
    time = "time τ" if result.chain.model == "friction" else "time t"
    if result.times[0] == result.times[-1]:  # one instant has no extent in time
        sites = np.arange(1, amplitude.shape[1] + 1)
        axes.plot(sites, amplitude[-1], **{"marker": "o", "ms": 3.0, "color": BLUE, **style})
        axes.set(xlabel="site n", ylabel="amplitude", title=f"{time} = {result.times[-1]:.6g}")
        return
    image = axes.imshow(
        amplitude.T,
        origin="lower",
        aspect="auto",
        extent=(float(result.times[0]), float(result.times[-1]), 0.5, amplitude.shape[1] + 0.5),
        interpolation="nearest",
        **{"cmap": "cividis", "vmin": 0.0, **style},
    )
    reached = np.flatnonzero(~np.isnan(result.arrivals))
    if reached.size:
        axes.plot(
            result.arrivals[reached], reached + 1, "o", ms=2.0, color=VERMILION, label="reached"
        )
        axes.legend(loc="upper left", frameon=True, facecolor="white", framealpha=0.8)
    axes.set(xlabel=time, ylabel="site n")
    axes.figure.colorbar(image, ax=axes, label="amplitude")


def _front(result: Any, axes: Axes, **style: Any) -> None:
    places = getattr(result.detail, "positions", None)
    if places is not None and places.ndim == 2:
        times = result.detail.arrivals
        from fronts.animation import label_plane

        size = min(60.0, 12_000.0 / len(places))  # so that neighbours nearly touch
        dots = axes.scatter(places[:, 0], places[:, 1], size, times, cmap="cividis", **style)
        label_plane(axes, places)
        axes.figure.colorbar(dots, ax=axes, label="time of arrival")
        return
    if not result.arrivals.size:
        raise TypeError(
            "a front without arrivals cannot be drawn: write its numbers to a .json file."
        )
    count = np.arange(1, result.arrivals.size + 1)
    unit = result.chain.time_unit  # v is the slope: sites in this time
    axes.plot(result.arrivals / unit, count, "o", **{"ms": 2.5, "color": BLUE, **style})
    slow = _in_slow_time(result.chain)
    time = r"slow time of arrival $\varepsilon t$" if slow else "time of arrival"
    axes.set(xlabel=time, ylabel="sites passed")
    if result.v is not None:
        symbol = r"$\hat v$" if slow else "v"
        axes.set_title(f"{symbol} = {result.v:.6g}")


def _ensemble(result: Any, axes: Axes, **style: Any) -> None:
    known = ~np.isnan(result.values)
    axes.plot(result.seeds[known], result.values[known], "o", **{"ms": 3.0, "color": BLUE, **style})
    axes.axhline(result.mean, color=VERMILION, label="mean")
    spread = result.spread or 0.0
    low, high = result.mean - spread, result.mean + spread
    axes.axhspan(low, high, color="0.9", zorder=0, label="± one standard deviation")
    axes.locator_params("x", integer=True)
    axes.legend()
    axes.set(xlabel="seed of the disorder", ylabel=_label(result.quantity, result.chain))


def _state_map(result: Any, axes: Axes, **style: Any) -> None:
    from paper_checks.report.state_picture import draw_states

    found = getattr(result, "found", result)
    across, up = (*found.axes, *found.axes)[:2]
    draw_states(axes, found.states, across, up, found.boundary)
    axes.set(xlabel=LABELS.get(across, across), ylabel=LABELS.get(up, up))
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


CURVES = ("v", "c_crit", "centre", "effective_damping")
"""Quantities that are drawn as functions of the parameter of a curve."""

BRANCHES = ("v", "centre")
"""Quantities that are drawn as functions of the parameter along a branch."""

SLOW_VELOCITY = r"front velocity $\hat v = v/\varepsilon$"
"""Label of velocities in sites per unit of slow time εt."""

LABELS = {
    "c": "coupling c",
    "v": "front velocity v",
    "centre": "amplitude at the centre",
    "c_crit": "critical coupling c",
    "v_d": "belt velocity $v_d$",
    "eps": "small parameter ε",
    "eta": "η = b/a²",
    "a": "damping coefficient a",
    "b": "damping coefficient b",
    "xi": "damping ratio ξ",
    "mu_st": r"static friction coefficient $\mu_{st}$",
    "mu_d": r"dynamic friction coefficient $\mu_d$",
    "v0": "reference velocity $v_0$",
}

DRAWINGS: dict[str, Callable[..., None]] = {
    "KineticRelation": _kinetic_point,
    "KineticCurve": _kinetic_curve,
    "Roots": _roots,
    "FrontProfile": _profile,
    "Bifurcation": _bifurcation,
    "FollowedBranch": _branch,
    "Curve": _curve,
    "Trajectory": _trajectory,
    "Ensemble": _ensemble,
    "Front": _front,
    "StateMap": _state_map,
    "Breather": _breather,
    "BreatherComparison": _breathers,
}
"""The function that draws results of each class, by the name of the class."""
