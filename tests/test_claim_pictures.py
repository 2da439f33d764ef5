"""What the pictures of claims show: the numbers of the evidence, on the axes that name them.

That a picture has all that it draws in its table is refused otherwise (`tests.test_report`); here
made-up evidence is drawn, and read from the figure again.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paper_checks.claims import (
    fig02,
    fig03,
    fig04,
    fig05,
    fig06,
    fig07,
    fig08,
    fig09,
    fig10,
    fig11,
    fig12,
    fig13,
    fig14,
    fig15,
    fig16,
    fig17,
    fig18,
    text_nuclei,
)
from paper_checks.claims._friction import chain_of
from paper_checks.report.cell_picture import draw_bifurcation
from paper_checks.report.velocity_plot import PlottedSolutions, curve_of
from verification.execution.table import Table
from verification.pictures.data_table import Curves
from verification.pictures.figures import new_axes

Points = list[tuple[float, float]]


@dataclass(frozen=True)
class Panel:
    """One set of axes, read from a figure."""

    title: str
    across: str
    up: str
    lines: Mapping[str, Points]
    """By label: the points of lines, bars and error bars, those that are no numbers left out."""
    levels: Mapping[str, float]
    """By label: where lines across all of the axes are."""
    bands: tuple[tuple[float, float], ...]
    """Left and right end of shaded bands."""
    legend: bool
    texts: tuple[str, ...]
    width: tuple[float, float]
    height: tuple[float, float]
    nameless: frozenset[str]
    """The directions, across and up, that have numbers and no name."""

    def reaches(self, across: Any, up: Any = ()) -> bool:
        """Whether the axes are wide and high enough for some numbers."""
        return all(
            low <= min(values, default=low) and max(values, default=high) <= high
            for (low, high), values in ((self.width, across), (self.height, up))
        )

    def fills(self, across: Any, up: Any = ()) -> bool:
        """Whether some numbers are on the axes and take most of their width and height."""
        return self.reaches(across, up) and all(
            max(values) - min(values) > 0.7 * (high - low)
            for (low, high), values in ((self.width, across), (self.height, up))
            if len(values)
        )


def read(axes: Any) -> Panel:
    """Read what is drawn on one set of axes."""
    from matplotlib.container import BarContainer, ErrorbarContainer
    from matplotlib.patches import Rectangle

    lines: dict[str, Points] = {}
    levels: dict[str, float] = {}
    for line in axes.get_lines():
        label = str(line.get_label())
        points = [(float(x), float(y)) for x, y in line.get_xydata() if np.isfinite(x + y)]
        if line.get_transform() is axes.transData:
            lines.setdefault(label, []).extend(points)
        else:
            flat = len({y for _, y in points}) == 1
            levels[label] = points[0][1] if flat else points[0][0]
    bars: list[Any] = []
    for each in axes.containers:
        if isinstance(each, ErrorbarContainer):
            lines[str(each.get_label())] = [(float(x), float(y)) for x, y in each[0].get_xydata()]
        elif isinstance(each, BarContainer):
            bars += each
            middles = [bar.get_x() + 0.5 * bar.get_width() for bar in each]
            tops = [bar.get_height() for bar in each]
            lines["bars"] = [
                (round(float(x), 9), float(y)) for x, y in zip(middles, tops, strict=True)
            ]
    bands = [each.get_bbox() for each in axes.patches
             if isinstance(each, Rectangle) and each not in bars]  # fmt: skip
    ticks = {
        "across": [] if axes.get_xlabel() else axes.get_xticklabels(),
        "up": [] if axes.get_ylabel() else axes.get_yticklabels(),
    }
    return Panel(
        title=axes.get_title(loc="left"), across=axes.get_xlabel(), up=axes.get_ylabel(),
        lines=lines, levels=levels, bands=tuple((each.x0, each.x1) for each in bands),
        legend=bool(axes.get_legend() or axes.figure.legends),
        texts=tuple(each.get_text() for each in axes.texts),
        width=axes.get_xlim(), height=axes.get_ylim(),
        nameless=frozenset(
            side for side, labels in ticks.items() if any(each.get_visible() for each in labels)
        ),
    )  # fmt: skip


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[Panel]]:
    """Draw evidence, and return the panels of its pictures; what has a name is in a legend.

    Every curve that is recorded for the table is in the picture, too.
    """
    panels: list[Panel] = []
    curves: dict[str, Points] = {}
    record = Curves.add

    def add(self: Curves, name: str, **columns: Any) -> Any:
        x, y = record(self, name, **columns)
        known = np.broadcast_arrays(np.array(x, dtype=float), np.array(y, dtype=float))
        curves[name] = [(a, b) for a, b in points(*known) if np.isfinite(a + b)]
        return x, y

    def render(_: str, figure: Any) -> str:
        panels.extend(read(axes) for axes in figure.axes)
        legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes)]
        shown = {text.get_text() for each in legends if each for text in each.get_texts()}
        assert shown >= {x for axes in figure.axes for x in axes.get_legend_handles_labels()[1]}
        for axes in figure.axes:
            looks: dict[tuple[object, ...], str] = {}
            for line in axes.get_lines():
                name, mark = str(line.get_label()), line.get_marker()
                face, edge = line.get_markerfacecolor(), line.get_markeredgecolor()
                assert edge != "none" or (face != "none" and mark not in ("x", "+")), name
                look = (line.get_color(), line.get_linestyle(), mark, face)
                assert name.startswith("_") or looks.setdefault(look, name) == name
        marks = {tuple(map(float, at)) for axes in figure.axes for each in axes.collections
                 for at in each.get_offsets()}  # fmt: skip
        for panel in panels:
            marks.update(at for line in panel.lines.values() for at in line)
        for name, curve in curves.items():
            assert marks >= set(curve), name
        return ""

    monkeypatch.setattr("verification.pictures.figures._render", render)
    monkeypatch.setattr("verification.pictures.figures._encoded", lambda *_: "")
    monkeypatch.setattr(Curves, "add", add)

    def draw(figure: Callable[[Any], Any], evidence: Any, without: str = "") -> list[Panel]:
        panels.clear()
        curves.clear()
        figure(evidence)
        assert without == "title" or any(panel.title for panel in panels)
        assert not {side for panel in panels for side in panel.nameless} - {without}
        for panel in panels:  # nothing is wholly out of view
            for name, line in panel.lines.items():
                assert not line or any(panel.reaches([x], [y]) for x, y in line), name
        return list(panels)

    return draw


def points(x: Any, y: Any) -> Points:
    return [(float(a), float(b)) for a, b in zip(x, y, strict=True)]


def known(of: Any, **some: Any) -> Any:
    """Return evidence of which only some is known."""
    return of(**dict.fromkeys((each.name for each in fields(of)), None) | some)


def stated(title: str) -> dict[str, float]:
    """Return the numbers that a title gives to letters."""
    found = re.findall(r"\$?(\\varepsilon|[abc])\$? = ([0-9.]+)", title)
    return {{"\\varepsilon": "EPS"}.get(name, name.upper()): float(x) for name, x in found}


# ------------------------------------------------------------------------------- the friction chain


def run_of(size: int, height: float) -> Any:
    times = np.linspace(0.0, 10.0, size)
    wave = height * np.array([[np.sin(t), np.cos(t)] for t in times])
    return SimpleNamespace(times=times, y=wave[:, :1], velocity=wave[:, 1:])


def test_the_two_states_are_drawn_in_time_and_in_the_plane(drawn: Any) -> None:
    runs = {"cycle": run_of(1001, 3.0), "rest": run_of(51, 2.0), "unstable": run_of(41, 1.0)}
    top, right, bottom = drawn(fig02.draw_two_states, known(fig02.TwoStates, sliding=0.5, **runs))
    plane = {name: points(run.y[:, 0], run.velocity[:, 0]) for name, run in runs.items()}
    cycle = right.lines["stick-slip limit cycle (LC)"]
    assert cycle == plane["cycle"][-len(cycle) :]
    assert len(cycle) > 300
    assert right.lines["unstable pure-slip limit cycle"] == plane["unstable"]
    assert right.lines["steady sliding (SS)"] == [(0.5, 0.0)]
    assert plane["rest"] in right.lines.values()
    assert bottom.levels == {"_child1": 0.5}
    for panel, name in ((top, "cycle"), (bottom, "rest")):
        assert points(runs[name].times, runs[name].y[:, 0]) in panel.lines.values()
    assert right.levels == {r"stick, $\tilde{v}_d$ = 1.25": fig02.V_D}
    assert right.reaches((), (-fig02.V_D, fig02.V_D))
    assert all(panel.across and panel.up for panel in (top, right, bottom))


def diagram() -> Any:
    v_d = np.linspace(0.9, 2.0, 12)
    both = np.stack([-v_d, v_d], axis=1)
    return SimpleNamespace(v_d=v_d, stable=3.0 * both, unstable=2.0 * both, sliding=0.5 * v_d,
                           cycle_end_velocity=1.95, hopf_velocity=0.95,
                           sliding_stable=v_d > 0.95)  # fmt: skip


def test_turning_points_of_both_cycles_are_drawn_on_both_sides() -> None:
    figure, axes = new_axes()
    found = diagram()
    draw_bifurcation(axes, found)
    panel = read(axes)
    every = [panel.lines[name] for name in panel.lines if "sliding" not in name]
    for cycle in (found.stable, found.unstable):
        for side in (0, 1):
            assert points(found.v_d, cycle[:, side]) in every
    assert {"stick-slip cycle", "unstable cycle"} <= panel.lines.keys()
    assert panel.lines["steady sliding, stable"] == points(found.v_d, found.sliding)[1:]
    assert panel.lines["steady sliding, unstable"] == points(found.v_d, found.sliding)[:1]
    assert sorted(panel.levels.values()) == [0.95, 1.95]  # within the outermost velocities
    assert panel.across
    assert panel.up
    figure.clear()


def test_regions_are_drawn_with_the_velocity_of_the_figure(drawn: Any) -> None:
    (panel,) = drawn(fig02.draw_regions, known(fig02.Regions, diagram=diagram()), "title")
    assert panel.levels[r"Fig. 2, $\tilde{v}_d$ = 1.25"] == fig02.V_D


@pytest.mark.parametrize(
    ("draw", "of", "times", "excited"),
    [
        (fig03.draw_breather, fig03.BreatherEnvelopes, fig03.TIMES_A, fig03.CORE),
        (fig03.draw_front, fig03.FrontEnvelopes, fig03.TIMES_B, (1,)),
    ],
)
def test_envelopes_are_drawn_over_a_band_of_the_excited_sites(
    drawn: Any, draw: Any, of: Any, times: Any, excited: tuple[int, ...]
) -> None:
    envelope = np.arange(3.0 * 31).reshape(3, 31)
    (panel,) = drawn(draw, known(of, envelope=envelope))
    sites = range(1, 32)
    ((left, right),) = panel.bands
    assert panel.title.startswith("$c$ = ")
    assert tuple(n for n in sites if left < n < right) == excited
    # Half of the way to the next site on either side.
    assert (left, right) == (excited[0] - 0.5, excited[-1] + 0.5)
    for row, time in zip(envelope, times, strict=True):
        assert panel.lines[rf"$\tau$ = {time:g}"] == points(sites, row)


def test_thresholds_are_drawn_over_the_size_of_the_nucleus(drawn: Any) -> None:
    edge, bulk = np.linspace(0.013, 0.008, 5), np.linspace(0.007, 0.005, 5)
    (panel,) = drawn(fig04.draw, known(fig04.Thresholds, edge=edge, bulk=bulk))
    assert panel.lines["“edge” excitation"] == points(fig04.SIZES, edge)
    assert panel.lines["“bulk” excitation"] == points(fig04.SIZES, bulk)
    assert panel.reaches(fig04.SIZES, (*edge, *bulk))
    (printed,) = (found for name, found in panel.lines.items() if name.startswith("paper: about"))
    assert printed == points(fig04.SIZES[1:], [(1.0 - 0.01 * fig04.PRINTED) * edge[0]] * 4)


def labelled(across: str, up: str) -> Any:
    x, y = (each.ravel() for each in np.meshgrid([0.03, 0.06, 0.09], [1.25, 1.5]))
    label = np.array(["front", "breather", "fixed point", "undecided", "front", "breather"])
    states = Table(arrays={across: x, up: y, "label": label})
    return states, {name: points(x[label == name], y[label == name]) for name in set(label)}


@pytest.mark.parametrize(
    ("module", "draw", "across", "up"),
    [(fig05, fig05.draw_map, "c", "v_d"), (fig15, fig15.draw, "eta", "c")],
)
def test_maps_are_drawn_with_each_label_at_its_points(
    drawn: Any, module: Any, draw: Any, across: str, up: str
) -> None:
    states, expected = labelled(across, up)
    if module is fig05:
        found = known(fig05.FrictionStateMap, states=states, hopf=1.15, cycle_end=1.8)
    else:
        found = known(fig15.VdpStateMap, states=states)
    (panel,) = drawn(draw, found)
    named = (
        {"fixed point": "steady sliding"} if module is fig05 else {"front": "front, stays filled"}
    )
    for label, where in expected.items():
        assert panel.lines[f"{named.get(label, label)} ({len(where)})"] == where
    levels = {0.125} if module is fig15 else {1.15, 1.8}
    assert set(panel.levels.values()) == levels
    if module is fig05:
        assert panel.fills(fig05.COUPLINGS, fig05.VELOCITIES)
    letters = {"c": "coupling c", "eta": "η = b/a²", "v_d": r"belt velocity $\tilde{v}_d$"}
    assert (panel.across, panel.up) == (letters[across], letters[up])
    assert panel.title
    assert panel.legend


def test_measured_velocities_are_drawn_over_their_couplings(drawn: Any) -> None:
    c = (*fig06.COUPLINGS, *fig06.LARGE)
    v = tuple(0.25 + 3.0 * each for each in c)
    (panel,) = drawn(fig06.draw_velocities, known(
        fig06.FrictionVelocities, c=c, v=v, error=(1e-3,) * len(c), waves=v, gap=0.0,
        threshold=0.0106
    ))  # fmt: skip
    inside = len(fig06.COUPLINGS)
    assert panel.lines["measured"] == points(c[:inside], v[:inside])
    assert panel.fills(fig06.COUPLINGS)
    assert panel.reaches((), v[:inside])
    assert panel.lines["no propagation"] == points(fig06.BELOW, np.zeros(len(fig06.BELOW)))
    (line,) = (found for name, found in panel.lines.items() if name.startswith("line"))
    assert np.array(line)[:, 1] == pytest.approx(0.25 + 3.0 * np.array(line)[:, 0])
    assert line[0][0] == 0.0106  # from the threshold on
    assert line[-1][0] > fig06.COUPLINGS[-1]
    waves = panel.lines["fastest linear waves"]
    assert waves[-1] == (waves[-1][0], chain_of(waves[-1][0]).largest_group_velocity)
    assert list(panel.levels.values()) == [0.0106]


# ---------------------------------------------------------------------------------------- breathers


def test_a_breather_is_drawn_by_site_beside_its_run_and_one_exponential(drawn: Any) -> None:
    place = np.arange(fig07.SITES) - fig07.CENTRE
    orbit = 3.0 * 0.25 ** np.abs(place)
    orbit[0] = 7e-4
    left, right = drawn(fig07.draw, known(fig07.Localised, orbit=orbit, run=2.0 * orbit))
    assert left.lines["bars"] == points(place, orbit)
    assert right.lines["periodic orbit of (8)"] == points(place, orbit)
    assert right.lines["run of (8), scipy"] == points(place, 2.0 * orbit)
    (one,) = (found for name, found in right.lines.items() if name.startswith("paper"))
    assert np.array(one)[:, 1] == pytest.approx(3.0 * 0.25 ** np.abs(place))
    assert stated(left.title) == {"A": 2.5, "B": 0.5, "C": fig07.C, "EPS": fig07.EPS}
    assert left.reaches((), (0.0, *orbit))
    assert right.reaches((), (1e-5, *orbit))
    assert all(panel.across and panel.up for panel in (left, right))
    assert right.legend


def test_phase_steps_are_drawn_below_the_shapes_of_their_nuclei(drawn: Any) -> None:
    times = np.linspace(0.0, 10.0, 5)
    steps = {
        (n, noise): 0.01 * (np.arange(5.0 * (n - 1)).reshape(5, n - 1) + n + 0.25 * (noise > 0.0))
        for n in fig10.SIZES
        for noise in (0.0, fig10.NOISE)
    }
    shapes = {n: n + 1.0 / (1.0 + np.arange(31.0)) for n in fig10.SIZES}
    panels = drawn(fig10.draw, known(fig10.InPhase, times=times, steps=steps, shapes=shapes))
    (picture,) = fig10.draw(known(fig10.InPhase, times=times, steps=steps, shapes=shapes))
    for size in fig10.SIZES:
        tabled = {int(name) for name in re.findall(rf"size {size}, .*, step (\d+)", picture.data)}
        assert tabled == set(range(1, size))
    assert len(panels) == 2 * len(fig10.SIZES)
    for k, size in enumerate(fig10.SIZES):
        shape, below = panels[k], panels[2 + k]
        assert dict(shape.lines["bars"])[0] == shapes[size][15]
        assert set(dict(shape.lines["bars"]).values()) <= set(shapes[size])
        assert sorted(dict(shape.lines["bars"])) == list(range(-8, 9))
        every = [pair for found in below.lines.values() for pair in found]
        rows = [row for (n, _), found in steps.items() if n == size for row in found.T]
        assert sorted(every) == sorted(pair for row in rows for pair in points(times, row))
        first = below.lines["exact mirror symmetry"]
        assert first == points(times, steps[size, 0.0][:, 0])
        assert below.levels == {"in phase": 0.0}
        assert below.across
        assert below.up


def test_sweeps_are_drawn_over_the_power_of_their_rate_beside_fold_and_print(drawn: Any) -> None:
    rates = (8e-6, 1e-6)
    escapes = {1: (0.2, 0.195), 3: (0.21, 0.205)}
    folds = known(fig11.Folds, averaged={1: 0.19, 3: 0.2}, orbit={})
    (panel,) = drawn(fig11.draw_sweeps, known(fig11.Sweeps, folds=folds, rates=rates,
                                              escapes=escapes))  # fmt: skip
    for n, found in escapes.items():
        shown = np.array(panel.lines[f"size {n}: sweeps"])
        assert shown == pytest.approx(np.array([(4e-4, found[0]), (1e-4, found[1])]))
    assert panel.lines["fold"] == [(0.0, 0.19), (0.0, 0.2)]
    assert panel.levels == {f"paper, {text}": float(text) for text in fig11.PRINTED.values()}
    assert panel.reaches((0.0, 4e-4), (0.19, *panel.levels.values(), *escapes[3]))
    assert stated(panel.title) == {"A": fig11.A, "B": fig11.B}


def test_ends_of_breathers_are_drawn_over_their_sizes(drawn: Any) -> None:
    orbit, averaged = {1: 0.191, 3: 0.199}, {1: 0.1915, 3: 0.1995}
    (panel,) = drawn(fig11.draw_thresholds, known(fig11.Folds, orbit=orbit, averaged=averaged))
    assert panel.lines["end of the breather in (8)"] == list(orbit.items())
    assert panel.lines["the same, ε → 0"] == list(averaged.items())
    assert panel.texts == tuple(fig11.PRINTED.values())
    assert panel.reaches(orbit, (*orbit.values(), *averaged.values()))
    assert panel.lines["paper"] == [(n, float(text)) for n, text in fig11.PRINTED.items()]
    branches = {1: (fig11.Ended(c_end=0.19, stable=((0.0, 0.18),)),),
                3: (fig11.Ended(c_end=0.2, stable=()),)}  # fmt: skip
    (panel,) = drawn(fig11.draw_nuclei, known(fig11.Nuclei, branches=branches))
    assert panel.lines["end of a breather, stable in the bar"] == [(1, 0.19)]
    assert panel.lines["end of a breather, never stable"] == [(3, 0.2)]
    assert [(1, 0.0), (1, 0.18)] in panel.lines.values()
    assert list(panel.levels.values()) == [fig11.LAST]
    assert stated(panel.title) == {"A": fig11.A, "B": fig11.B}


def test_assumptions_are_drawn_over_epsilon(drawn: Any) -> None:
    detuning, turns = (-0.04, -0.02, -0.01, -0.005), (-0.4, -0.2, -0.1, -0.05)
    left, right = drawn(fig08.draw_assumptions, known(
        fig08.Assumptions, detuning=detuning, turns=turns, ratio=0.25), "up")  # fmt: skip
    share = np.abs(detuning) / fig08.C
    assert left.lines["|δ|/c"] == points(fig08.EPSILONS, share)
    (needed,) = (found for name, found in left.lines.items() if "(28)" in name)
    assert needed == points(fig08.EPSILONS, share / 0.25)
    assert right.lines[r"$|k_2+\pi/2|$"] == points(fig08.EPSILONS, np.abs(turns))
    assert stated(left.title) == {"A": fig08.A, "B": fig08.B, "C": fig08.C}
    (picture,) = fig08.draw_assumptions(
        known(fig08.Assumptions, detuning=detuning, turns=turns, ratio=0.25)
    )
    assert picture.data.splitlines()[-1] == "averaged chain,0.0,0.0,,0.0"
    assert left.reaches(fig08.EPSILONS, (0.0, fig08.SMALL, *share))
    assert right.reaches(fig08.EPSILONS, (0.0, *np.abs(turns)))
    assert left.levels == {"“small”: 0.1": fig08.SMALL}


def test_amplitudes_are_drawn_over_coupling_beside_the_closed_form(
    drawn: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def closed_form(_: Any, c: Any) -> Any:
        return np.stack([2.0 + c, c], axis=1)

    monkeypatch.setattr(fig08, "closed_form", closed_form)
    exact = closed_form(None, 2.0 * np.array(fig08.COUPLINGS))
    (panel,) = drawn(fig08.draw_amplitudes, known(fig08.OrbitAmplitudes, exact=exact))
    for n in (0, 1):
        orbit, theory = (panel.lines[f"n = {n}, {by}"] for by in (
            "periodic orbit of (8)", "paper: (29), (37), (38)"))  # fmt: skip
        assert orbit == points(fig08.COUPLINGS, exact[:, n])
        assert np.array(theory)[:, 1] == pytest.approx(2.0 * (n == 0) + np.array(theory)[:, 0])
        assert theory == sorted(theory)
        assert panel.fills([x for x, _ in orbit + theory])
        assert panel.reaches((), [y for _, y in orbit + theory])
    assert stated(panel.title) == {"A": fig08.A, "B": fig08.B, "EPS": fig08.EPS}


def test_multipliers_are_drawn_over_coupling_in_both_panels(drawn: Any) -> None:
    c, exact_c = (0.1, 0.195), (0.1, 0.15, 0.19)
    rows, exact = ((0.9, 1.0), (0.995, 1.001)), ((0.8, 1.0), (0.85, 1.0), (0.993, 1.0))
    panels = drawn(fig09.draw, known(
        fig09.Multipliers, couplings=c, along=rows, exact_couplings=exact_c, exact=exact,
        true_odd=0.191))  # fmt: skip
    for panel in panels:
        every = {pair for found in panel.lines.values() for pair in found}
        assert every == {
            *((x, m) for x, row in zip(c, rows, strict=True) for m in row),
            *((x, m) for x, row in zip(exact_c, exact, strict=True) for m in row),
        }
        assert sorted(panel.levels.values()) == [0.191, float(fig09.PRINTED), 1.0]
        assert {"along (9), as in the paper", "true periodic orbit"} <= panel.lines.keys()
    assert panels[0].reaches((*fig09.ALONG, *fig09.EXACT))
    assert panels[1].reaches((0.191, float(fig09.PRINTED), fig09.ALONG[-1]), (1.0,))
    assert panels[1].title == "near the unit circle"
    assert panels[0].fills(fig09.EXACT)
    assert not panels[1].reaches(fig09.EXACT[:1])


# ------------------------------------------------------------------------------------------- fronts


def test_the_chain_is_drawn_at_each_of_the_three_times(
    drawn: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fig12, "SITES", 4)
    shapes = tuple(np.arange(4.0) + k for k in range(3))
    panels = drawn(fig12.draw, known(fig12.Steady, shapes=shapes,
                                     amplitudes=tuple(10.0 + y for y in shapes)))  # fmt: skip
    for panel, y, time in zip(panels, shapes, fig12.TIMES, strict=True):
        assert panel.lines["$y_n$"] == points((1, 2, 3, 4), y)
        assert panel.lines[r"$|\dot y_n + iy_n|$"] == points((1, 2, 3, 4), 10.0 + y)
        assert panel.title.startswith(f"t = {time:g}")
    held = {name: getattr(fig12, name) for name in ("A", "B", "C", "EPS")}
    assert stated(panels[0].title) == held
    assert panels[-1].across


def test_velocity_and_its_exponent_are_drawn_over_coupling(drawn: Any) -> None:
    c = (1.0, 2.0, 4.0)
    full = (0.5, 1.0)
    left, right = drawn(fig13.draw, known(
        fig13.AveragedScaling, c=c, v=(1.0, 4.0, 16.0), error=(0.0,) * 3, full_c=full,
        full_v=(2.0, 3.0), full_error=(0.0,) * 2))  # fmt: skip
    assert left.lines["averaged chain (43)"] == [(1.0, 1.0), (2.0, 4.0)]
    assert left.lines["(8), ε = 0.01"] == [(0.5, 2.0), (1.0, 3.0)]
    (line,) = (found for name, found in left.lines.items() if name.startswith("line"))
    assert np.array(line)[:, 1] == pytest.approx(1.0 + 2.0 * np.array(line)[:, 0])
    assert (line[0][0], line[-1][0]) == (fig13.FULL[0], fig13.FULL[-1])
    assert np.array(right.lines["averaged chain (43)"])[:, 1] == pytest.approx(2.0)
    ((middle, exponent),) = right.lines["(8), ε = 0.01"]
    assert middle == pytest.approx(np.sqrt(full[0] * full[1]))
    assert exponent == pytest.approx(np.log(1.5) / np.log(2.0))
    assert right.levels == {"paper: linear in the end": 1.0}
    assert stated(left.title) == {"A": fig13.A, "B": fig13.B}
    assert left.reaches((0.0, *fig13.FULL), (0.0, *full))
    assert right.reaches((), (1.0,))
    assert all(panel.across == "coupling c" and panel.up for panel in (left, right))


def test_velocities_of_the_law_are_drawn_over_those_of_the_fastest_waves(drawn: Any) -> None:
    """Each with the κ that its rows imply; a run that has not settled is not drawn."""
    kappas = dict(zip(fig13.LAW_ETAS, (1.5, 0.5, -0.75), strict=True))
    rows = []
    for eta, kappa in kappas.items():
        for c, v in ((10.0, 12.0), (100.0, 110.0), (1000.0, None)):
            waves, bend = fig13.fastest_waves(c)
            rows.append((eta, c, v, 1e-3, waves + kappa * bend, waves))
    (panel,) = drawn(fig13.draw_law, known(fig13.Law, rows=tuple(rows)), "title")
    for eta, kappa in kappas.items():
        (runs,) = (found for name, found in panel.lines.items()
                   if name == rf"η = {eta:g}, κ = ${kappa:.2f}$")  # fmt: skip
        ratios = [(c, v / fig13.fastest_waves(c)[0]) for c, v in ((10.0, 12.0), (100.0, 110.0))]
        assert np.array(runs) == pytest.approx(np.array(ratios))
    laws = [np.array(found) for name, found in panel.lines.items() if name.startswith("_")]
    for law, kappa in zip(laws, kappas.values(), strict=True):
        for c, ratio in law[:: len(law) - 1]:
            waves, bend = fig13.fastest_waves(c)
            assert (ratio - 1.0) * waves == pytest.approx(kappa * bend)
        assert law[0, 0] < min(fig13.LAW_COUPLINGS)
        assert law[-1, 0] > max(fig13.LAW_COUPLINGS)
    assert list(panel.levels.values()) == [1.0]
    assert panel.across
    assert panel.up


def test_the_size_of_a_nucleus_is_drawn_over_slow_time(drawn: Any) -> None:
    histories = {
        (seed, c): tuple(k + 0.5 * (seed is None) + np.linspace(0.0, 5.0, 201))
        for seed in (None, text_nuclei.SEEDS[0])
        for k, c in enumerate(text_nuclei.DRAWN)
    }
    (panel,) = drawn(text_nuclei.draw_to_larger, known(text_nuclei.ToLarger, histories=histories))
    assert {"mirror-symmetric", "noise of 1e-3"} <= set(panel.lines)
    times = np.linspace(0.0, 1000.0, 201)
    for k, c in enumerate(text_nuclei.DRAWN):
        assert panel.lines[f"c = {c:g}"] == points(times, histories[None, c])
        perturbed = points(times, histories[text_nuclei.SEEDS[0], c])
        (found,) = (name for name, each in panel.lines.items() if each == perturbed)
        assert found.startswith("_"), k
    assert panel.reaches((0.0, 1000.0), (1.0, text_nuclei.CHAIN_SITES))
    held = {name: getattr(text_nuclei, name) for name in ("A", "B", "EPS")}
    assert stated(panel.title) == held


def test_velocities_of_several_a_are_drawn_over_eta(drawn: Any) -> None:
    averaged = 0.1 * np.arange(1.0, 1.0 + len(fig14.ETAS))
    full = {a: tuple(a + np.arange(len(fig14.FULL))) for a in fig14.SHARES}
    (panel,) = drawn(fig14.draw, known(fig14.Collapse, averaged=averaged, full=full))
    assert panel.lines["averaged chain (43)"] == points(fig14.ETAS, averaged)
    for a, v in full.items():
        b = "η" if a == 1.0 else f"{a * a:g}η"
        assert panel.lines[f"(8), $a$ = {a:g}, $b$ = {b}"] == points(fig14.FULL, v)
    assert stated(panel.title) == {"C": fig14.C, "EPS": fig14.EPS}
    assert panel.reaches((0.0, *fig14.ETAS), (0.0, *averaged))
    assert panel.legend


def test_the_profile_is_drawn_in_units_of_the_chain_with_both_amplitudes(drawn: Any) -> None:
    zeta, few, sites = np.linspace(-10, 10, 5), np.array([-1.5, 1.5]), np.array([-1.0, 0.0, 1.0])
    (panel,) = drawn(fig16.draw, known(
        fig16.ProfileValues, zeta=zeta, phi=1j * zeta, few=few, series=-few, sites=sites,
        chain=1j * sites, amplitude=4.0, threshold=0.25))  # fmt: skip
    assert panel.lines["solution of (48), periodised integral"] == points(zeta, 4 * np.abs(zeta))
    assert panel.lines["root series (49)"] == points(few, 4 * np.abs(few))
    assert panel.lines["chain (44), simulated"] == points(sites, 4 * np.abs(sites))
    assert panel.levels[r"$|\varphi_{us}|$"] == 1.0
    assert sorted(panel.levels.values()) == [0.0, 1.0, 4.0]
    assert stated(panel.title) == {"A": fig16.A, "B": fig16.B, "C": fig16.C}


def steady(c: float, v: float | None) -> Any:
    return SimpleNamespace(coupling=c, v=v, steady=v is not None)


def curve(*rows: tuple[float, float, bool]) -> PlottedSolutions:
    x, v, kinds = zip(*rows, strict=True)
    return PlottedSolutions(x, v, kinds)


ALL, NEAR = curve((0.5, 1.0, True), (0.5, 2.0, False)), curve((0.44, 0.1, False), (0.45, 0.2, True))


def shows_solutions(panel: Panel, found: PlottedSolutions) -> None:
    rows = list(zip(found.x, found.v, found.admissible, strict=True))
    assert panel.lines["admissible"] == [(x, v) for x, v, kind in rows if kind]
    assert panel.lines["not admissible"] == [(x, v) for x, v, kind in rows if not kind]


def test_every_solution_is_drawn_beside_runs_and_thresholds(drawn: Any) -> None:
    both = SimpleNamespace(couplings=(0.43, 0.44), moving=(steady(0.43, 0.3), steady(0.44, 0.4)),
                           resting=(steady(0.43, None), steady(0.44, 0.5)))  # fmt: skip
    held = known(
        fig17.PiecewiseScaling, solutions=ALL, near=NEAR,
        runs=(steady(0.5, 1.0), steady(0.6, None)), c_fold=0.44, c_pin=0.455, hysteresis=both,
        c=(1.0, 4.0), v=(2.0, 8.0), exponent=(0.5, 1.0),
        limit=3.0)  # fmt: skip
    first, second, left, right = drawn(fig17.draw_scaling, held)
    shows_solutions(first, ALL)
    shows_solutions(second, NEAR)
    assert first.lines["chain (44), steady"] == [(0.5, 1.0)]
    assert second.lines["chain, moving start"] == [(0.43, 0.3), (0.44, 0.4)]
    assert second.lines["chain, resting start"] == [(0.44, 0.5)]
    assert sorted(second.levels.values()) == [0.44, 0.455]
    assert stated(first.title) == stated(left.title) == {"A": fig17.A, "B": fig17.B}
    # At c = 1 the linear law has the velocity of the solution; the other is V times the root of c.
    assert left.lines["fastest solution of (54)"] == [(1.0, 2.0), (4.0, 8.0)]
    assert left.lines["paper: linear"] == [(1.0, 2.0), (4.0, 8.0)]
    (root,) = (found for name, found in left.lines.items() if "√c" in name)
    assert root == [(1.0, 3.0), (4.0, 6.0)]
    assert right.lines["fastest solution of (54)"] == [(1.0, 0.5), (4.0, 1.0)]
    assert right.levels == {"paper: linear": 1.0, "√c": 0.5}


def test_velocities_are_drawn_over_eta_beside_the_averaged_chain(drawn: Any) -> None:
    runs = tuple((eta, steady(eta, 1.0 + 0.1 * k)) for k, eta in enumerate(fig18.ETAS))
    averaged = 0.1 * np.arange(1.0, 1.0 + len(fig18.ETAS))
    moving = tuple(float(k) for k in range(len(fig18.CROSSING)))
    every, near = curve((0.02, 1.0, True), (0.02, 1.2, False)), curve((0.0208, 0.2, True))
    left, right = drawn(fig18.draw, known(
        fig18.VelocityAgreement, solutions=every, near=near, runs=runs, averaged=averaged,
        moving=moving, resting=(None,) * len(moving), fold=0.021, pin=0.02))  # fmt: skip
    shows_solutions(left, every)
    shows_solutions(right, near)
    assert left.lines["chain (44)"] == [(eta, run.v) for eta, run in runs]
    assert left.lines["averaged chain (43), Fig. 14"] == points(fig18.ETAS, averaged)
    assert right.lines["chain, moving start"] == points(fig18.CROSSING, moving)
    assert right.lines["chain, resting start"] == []
    assert sorted(right.levels.values()) == [0.02, 0.021]
    assert stated(left.title) == {"C": fig18.C}
    assert right.title == "near the thresholds"
    assert left.reaches((0.0, *fig18.ETAS), (0.0, fig18.C))


def test_what_is_not_judged_admissible_is_drawn_and_tabled_as_not_so() -> None:
    def answer(c: float, *kinds: bool | None) -> Any:
        found = [SimpleNamespace(v=float(k), admissible=kind) for k, kind in enumerate(kinds)]
        return SimpleNamespace(c=c, eta=2.0 * c, branches=found)

    answers: Any = [answer(0.5, True, None), answer(0.25, False)]
    found = curve_of(answers, "eta")
    assert (found.x, found.v) == ((1.0, 1.0, 0.5), (0.0, 1.0, 0.0))
    assert found.admissible == (True, False, False)
    assert found.part(True) == ([1.0], [0.0])
    assert found.columns("eta")["admissible"] == ["yes", "no", "no"]
    assert curve_of(answers, "c").x == (0.5, 0.5, 0.25)
