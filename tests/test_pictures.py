"""What pictures show are the numbers of the result, on the axes that their labels name."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock, call

import matplotlib as mpl
import matplotlib.animation
import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from PIL import Image, ImageSequence

import fronts as fr
from fronts.animation import _writer, animate, snapshot
from fronts.branches import BranchFold, FollowedBranch
from fronts.pictures import (
    BLUE,
    DRAWINGS,
    SLOW_VELOCITY,
    VERMILION,
    _label,
    _thresholds,
    draw,
)
from tests.tables import table_of
from theory.parameters import MissingPackageError, ParameterError
from theory.result import Result
from verification.pictures import figures
from verification.pictures.figures import COLOURS, new_axes, new_panels, picture, use_style
from verification.runs.trajectory import Trajectory

mpl.use("Agg")


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    """Close the figures that a test has drawn."""
    yield
    pyplot.close("all")


needs_explorer = pytest.mark.skipif(
    any(find_spec(name) is None for name in ("panel", "bokeh")), reason="extra explore is missing"
)


@dataclass(frozen=True, kw_only=True)
class _Found(Result):
    v: float
    stable: bool | None


@dataclass(frozen=True, kw_only=True)
class _Centred(Result):
    centre: float
    stable: bool | None


def _branch(along: str, stable: list[bool | None], **ends: Any) -> FollowedBranch:
    values = np.linspace(0.6, 0.2, len(stable))
    points = tuple(_Found(v=2.0 * x, stable=y) for x, y in zip(values, stable, strict=True))
    return FollowedBranch(along=along, values=values, points=points, seconds=0.0, **ends)


def test_a_branch_of_breathers_is_drawn_by_the_amplitude_at_the_centre() -> None:
    points = tuple(_Centred(centre=3.0 * c, stable=True) for c in (0.1, 0.2))
    axes = draw(FollowedBranch(along="c", values=np.array([0.1, 0.2]), points=points, seconds=0.0))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("coupling c", "amplitude at the centre")
    assert list(axes.lines[0].get_ydata()) == pytest.approx([0.3, 0.6])


def _segments(axes: Any, style: str) -> list[tuple[float, float]]:
    """Return the ends in x of all lines between points that have this style."""
    lines = [each for each in axes.lines if each.get_linestyle() == style]
    return [tuple(each.get_xdata()) for each in lines if len(each.get_xdata()) == 2]


def _marked(line: Any) -> list[tuple[float, float]]:
    return [tuple(pair) for pair in line.get_xydata()]


def test_a_branch_is_solid_where_it_is_stable_and_dashed_where_it_is_not() -> None:
    axes = draw(_branch("c", [True, True, False, False]))
    assert _segments(axes, "-") == [pytest.approx((0.6, 0.6 - 0.4 / 3))]
    assert _segments(axes, "--") == [pytest.approx((0.6 - 0.8 / 3, 0.2))]
    dots = {each.get_color(): list(each.get_ydata()) for each in axes.lines
            if each.get_marker() == "o"}  # fmt: skip
    assert dots == {
        BLUE: pytest.approx([1.2, 1.2 - 0.8 / 3]),
        VERMILION: pytest.approx([1.2 - 1.6 / 3, 0.4]),
    }
    words = [each.get_text() for each in axes.get_legend().get_texts()]
    assert words == ["stable", "not stable"]
    for line in axes.lines:  # here v = 2 c
        assert list(line.get_ydata()) == pytest.approx([2.0 * x for x in line.get_xdata()])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("coupling c", SLOW_VELOCITY)


@pytest.mark.parametrize("along", ["c", "eta"])
def test_a_branch_goes_through_its_folds_in_their_order(along: str) -> None:
    """A fold after two points, and beyond the last but one of them the end, where v = 0."""
    place = {"c": 0.45, "eta": 0.45}
    turn = BranchFold(**place, error=0.0, points_before=2, height=0.9)
    axes = draw(_branch(along, [True] * 5, folds=(turn,), **{f"{along}_pin": 0.25}))
    chained = _segments(axes, "-")
    # 0.6, 0.5, fold 0.45, 0.4, 0.3, end 0.25, 0.2
    shown = [line for line in axes.lines if line.get_transform() is axes.transData]
    heights = [x_y for line in shown for x_y in zip(*line.get_data(), strict=True)]
    assert {(0.25, 0.0), (0.45, 0.9)} <= set(heights)
    vertical = [each for each in chained if each[0] == each[1]]
    assert vertical == [(0.25, 0.25), (0.45, 0.45)]
    order = [each for each in chained if each[0] != each[1]]
    assert np.allclose(np.ravel(order), np.repeat([0.6, 0.5, 0.45, 0.4, 0.3, 0.25, 0.2], 2)[1:-1])
    symbol, end = {"c": ("c", "pinned up to c"), "eta": ("η", "pinned from η")}[along]
    words = [each.get_text() for each in axes.get_legend().get_texts()]
    assert words == [f"{end} = 0.25", f"fold, {symbol} = 0.45", "stable"]
    assert [_marked(line) for line in shown if line.get_marker() == "o"] == [
        [(x, 2.0 * x) for x in np.linspace(0.6, 0.2, 5)]
    ]


@pytest.mark.parametrize("along", ["c", "eta"])
def test_a_fold_beyond_the_end_of_a_branch_stands_beyond_it(along: str) -> None:
    turn = BranchFold(c=0.25, eta=0.25, error=0.0, points_before=4, height=0.9)
    axes = draw(_branch(along, [True] * 5, folds=(turn,), **{f"{along}_pin": 0.45}))
    order = [each for each in _segments(axes, "-") if each[0] != each[1]]
    assert np.allclose(np.ravel(order), np.repeat([0.6, 0.5, 0.45, 0.4, 0.3, 0.25, 0.2], 2)[1:-1])


@pytest.mark.parametrize("along", ["c", "eta"])
def test_a_branch_has_no_gap_where_a_fold_follows_the_other_without_a_point(along: str) -> None:
    """In descending order: fronts at rest are at the end along c, and at the beginning along η."""
    place = {"c": 3, "eta": 2}[along]
    turn = BranchFold(c=0.45, eta=0.45, error=0.0, points_before=place, height=0.9)
    pin = {"c": 0.35, "eta": 0.45}[along]
    axes = draw(_branch(along, [True] * 5, folds=(turn,), **{f"{along}_pin": pin}))
    ends = [(0.45, 0.9), (pin, 0.0)]
    dotted = [each for each in axes.lines if each.get_linestyle() == ":"]
    (line,) = (each for each in dotted if each.get_label() == "stability not decided")
    shown = list(zip(*line.get_data(), strict=True))
    assert shown == (ends if along == "c" else ends[::-1])
    solid = [
        {(round(x, 9), round(y, 9)) for x, y in zip(*each.get_data(), strict=True)}
        for each in axes.lines
        if each.get_linestyle() == "-" and each.get_transform() is axes.transData
    ]
    beside = {"c": (0.4, 0.3), "eta": (0.5, 0.4)}[along]  # the last point before, the first after
    for x, node in zip(beside, shown, strict=True):
        assert {(x, 2.0 * x), node} in solid


def test_a_curve_has_bars_of_its_errors() -> None:
    from fronts.curves import Curve

    @dataclass(frozen=True, kw_only=True)
    class Measured(Result):
        v: float | None
        error: float | None

    points = (
        Measured(v=1.0, error=0.25), Measured(v=None, error=None), Measured(v=2.0, error=0.5),
        Measured(v=3.0, error=None),
    )  # fmt: skip
    axes = draw(Curve(along="c", values=np.arange(4.0), points=points, seconds=0.0))
    (shown,) = axes.containers
    (bars,) = shown[2]
    ends = [[y for _, y in each] for each in bars.get_segments()]
    assert ends == [[0.75, 1.25], [1.5, 2.5], [3.0, 3.0]]
    assert list(shown[0].get_xdata()) == [0.0, 2.0, 3.0]
    assert axes.get_legend() is None  # of one method there is nothing to tell apart


def test_a_curve_of_breathers_has_the_bars_of_what_is_drawn_and_a_line_a_method() -> None:
    """The amplitude has another error than the frequency."""
    from fronts.curves import curve

    couplings = [0.05, 0.15]
    chains = [fr.VdpChain(a=2.5, b=0.5, c=c, sites=9) for c in couplings]
    here: Any = {"workers": 1, "progress": None}
    closed = curve(fr.breather, chains, "c", couplings, {"method": "closed-form"}, **here)
    (shown,) = draw(closed).containers
    points = [fr.breather(chain, method="closed-form") for chain in chains]
    for segment, x, point in zip(shown[2][0].get_segments(), couplings, points, strict=True):
        centre, error = point.amplitudes[4], point.error
        assert segment == pytest.approx(np.array([[x, centre - error], [x, centre + error]]))
    every = draw(curve(fr.breather, chains, "c", couplings, {"method": "all"}, **here))
    names = [text.get_text() for text in every.get_legend().get_texts()]
    assert names == ["closed-form", "envelope", "orbit", "simulation"]


@pytest.mark.parametrize(("chain", "label"), [
    (fr.VdpChain(a=4, b=0.5, c=0.6), SLOW_VELOCITY),
    (fr.PiecewiseChain(c=1, eta=0.03), SLOW_VELOCITY),
    (fr.FrictionChain(c=0.02), "front velocity v"),
])  # fmt: skip
def test_a_velocity_has_the_name_that_goes_with_the_unit_of_time(chain: Any, label: str) -> None:
    """Also where the first of its points is refused, which has no chain."""
    from fronts.curves import Curve, Refusal

    @dataclass(frozen=True, kw_only=True)
    class Measured(Result):
        v: float
        chain: Any

    points = (Measured(v=0.5, chain=chain), Measured(v=0.75, chain=chain))
    for some in (points, (Refusal(reason="of a cell"), points[1])):
        axes = draw(Curve(along="c", values=np.array([1.0, 2.0]), points=some, seconds=0.0))
        assert axes.get_ylabel() == label
    assert _label("centre", chain) == "amplitude at the centre"  # in any unit of time


def test_methods_that_agree_are_drawn_with_different_hollow_marks() -> None:
    axes = Figure().subplots()
    DRAWINGS["BreatherComparison"](_results()["BreatherComparison"], axes)
    lines = axes.lines
    assert [line.get_marker() for line in lines] == ["o", "s"]
    assert {line.get_markerfacecolor() for line in lines} == {"none"}


@pytest.mark.parametrize("along", ["c", "eta"])
def test_solutions_are_drawn_over_the_parameter_that_the_axis_names(along: str) -> None:
    """The axis shows the whole range, although no front moves at the first or the last value."""
    values = {"c": [0.3, 0.434, 0.5], "eta": [0.02, 0.03, 0.07]}[along]
    found = fr.kinetic_relation(**{"c": 0.5, "eta": 0.03125, along: values})
    axes = draw(found)
    assert axes.get_xlabel() == {"c": "coupling c", "eta": "η = b/a²"}[along]
    assert axes.get_ylabel() == SLOW_VELOCITY
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == axes.get_legend_handles_labels()[1]
    shown = {
        (x, v)
        for line in axes.lines
        if line.get_marker() not in ("", "None")
        for x, v in zip(line.get_xdata(), line.get_ydata(), strict=True)
    }
    assert shown == {
        (x, b.v) for x, point in zip(values, found.points, strict=True) for b in point.branches
    }
    low, high = axes.get_xlim()
    beyond = 0.03 * (max(values) - min(values))
    assert (low, high) == pytest.approx((min(values) - beyond, max(values) + beyond))
    upright = {line.get_label(): [*line.get_xdata()] for line in axes.lines
               if line.get_marker() == "None"}  # fmt: skip
    first = found.points[0]
    assert upright == ({} if along == "eta" else {
        r"$c_\mathrm{fold}$ = 0.4338": [first.c_fold] * 2,
        r"$c_\mathrm{pin}$ = 0.4553": [first.c_pin] * 2,
    })  # fmt: skip


def test_a_threshold_that_is_not_shown_in_words_is_not_drawn_either() -> None:
    for shown in (False, True):
        axes = Figure().subplots()
        axes.plot([0.0, 1.0], [0.0, 1.0])
        answer = SimpleNamespace(c_fold=None, c_pin=0.25, c_retreat=7.0, c_stable=0.75,
                                 limit_shown=shown)  # fmt: skip
        limits = axes.get_xlim()
        _thresholds(axes, answer)
        assert [each.get_xdata()[0] for each in axes.lines[1:]] == [0.25, 0.75][: 1 + shown]
        assert axes.get_xlim() == limits


def test_a_profile_is_drawn_by_its_modulus_its_two_parts_and_its_threshold() -> None:
    found = fr.front_profile(0.5, 0.03125, points=11)
    axes = draw(found)
    named = {line.get_label(): line for line in axes.lines if not line.get_label().startswith("_")}
    parts = np.abs(found.phi), found.phi.real, found.phi.imag
    for line, part in zip(named.values(), parts, strict=True):
        assert np.array_equal(line.get_xdata(), found.zeta)
        assert np.array_equal(line.get_ydata(), part)
    assert axes.texts[0].xy == (found.zeta[-1], found.threshold)
    (level,) = (line for line in axes.lines if line.get_label() not in named)
    assert list(level.get_ydata()) == [found.threshold] * 2
    assert [text.get_text() for text in axes.texts] == [r"threshold $|\varphi_{us}|/|\varphi_s|$"]
    assert axes.get_legend().get_title().get_text() == rf"$\hat v$ = {found.v:.6g}"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("ζ (sites)", r"$\varphi/\varphi_s$")


def test_roots_are_drawn_where_they_are_about_the_real_axis() -> None:
    found = fr.roots(0.3, 0.5, count=3)
    axes = draw(found)
    *halves, axis = axes.lines
    for line, half in zip(halves, (found.upper, found.lower), strict=True):
        drawn = zip(line.get_xdata(), line.get_ydata(), strict=True)
        assert [*drawn] == [(root.re, root.im) for root in half]
    assert list(axis.get_ydata()) == [0.0, 0.0]
    assert [each.get_text() for each in axes.get_legend().get_texts()] == ["$M^+$", "$M^-$"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Re k (per site)", "Im k (per site)")


def test_of_a_run_each_site_is_in_the_middle_of_its_row() -> None:
    axes = Figure().subplots()
    DRAWINGS["Trajectory"](_results()["Trajectory"], axes)
    (image,) = axes.images
    assert image.get_extent() == [0.0, 10.0, 0.5, 4.5]
    assert (image.origin, image.get_clim()[0]) == ("lower", 0.0)


def test_a_branch_of_one_point_has_nothing_to_explain() -> None:
    assert draw(_branch("c", [True])).get_legend() is None


def test_a_curve_of_cells_is_drawn_by_its_cycles() -> None:
    from fronts.curves import Curve

    values = np.array([0.5, 0.6])
    cells = tuple(fr.cell(fr.VdpChain(a=2.5, b=float(b), c=0)) for b in values)
    axes = draw(Curve(along="b", values=values, points=cells, seconds=0.0))
    for kind, style in (("stable_cycle", "-"), ("unstable_cycle", "--")):
        lines = [each for each in axes.lines if each.get_linestyle() == style]
        turning = [(getattr(each, kind).min, getattr(each, kind).max) for each in cells]
        assert [tuple(each.get_ydata()) for each in lines] == [*zip(*turning, strict=True)]
        assert all(np.array_equal(each.get_xdata(), values) for each in lines)
    assert [each.get_text() for each in axes.get_legend().get_texts()] == [
        "stable cycle", "unstable cycle",
    ]  # fmt: skip
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "damping coefficient b", "turning points of y",
    )  # fmt: skip


def test_a_front_in_the_plane_is_drawn_by_when_it_arrives_where() -> None:
    places, times = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.866]]), np.array([1.0, 2.0, 4.0])
    axes = Figure().subplots()
    detail = SimpleNamespace(positions=places, arrivals=times)
    DRAWINGS["Front"](SimpleNamespace(detail=detail), axes)
    (dots,) = axes.collections
    assert np.array_equal(dots.get_offsets(), places)
    assert np.array_equal(dots.get_array(), times)
    assert axes.get_aspect() == 1.0
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "x (lattice spacings)", "y (lattice spacings)",
    )  # fmt: skip
    assert axes.figure.axes[1].get_ylabel() == "time of arrival"


@pytest.mark.parametrize("last", [0.3, np.nan])
def test_an_ensemble_is_drawn_about_its_mean(last: float) -> None:
    """The band has no width where there is one value."""
    from verification.runs.ensemble import Ensemble

    found = Ensemble(
        chain=None, quantity="v", seeds=np.array([3, 5, 7]), values=np.array([0.1, np.nan, last]),
        errors=np.zeros(3), reasons=np.array(["", "none", ""]), seconds=0.0,
    )  # fmt: skip
    axes = draw(found)
    dots, mean = axes.lines
    known = [(3, 0.1)] if np.isnan(last) else [(3, 0.1), (7, 0.3)]
    centre, half = (0.1, 0.0) if np.isnan(last) else (0.2, 0.1 * np.sqrt(2.0))
    assert _marked(dots) == known
    assert [each.get_text() for each in axes.get_legend().get_texts()] == [
        "mean", "± one standard deviation",
    ]  # fmt: skip
    assert list(mean.get_ydata()) == pytest.approx([centre, centre])
    (band,) = axes.patches
    low, high = band.get_extents().transformed(axes.transData.inverted()).intervaly
    assert (low, high) == pytest.approx((centre - half, centre + half))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("seed of the disorder", "front velocity v")
    assert np.isnan(last) or all(tick == round(tick) for tick in axes.get_xticks())


def _run(amplitude: np.ndarray, **chain: Any) -> Any:
    return SimpleNamespace(amplitude=amplitude, chain=SimpleNamespace(**chain))


def _trajectory(amplitude: np.ndarray, times: Any = ()) -> Trajectory:
    """Return a trajectory of which nothing is known but what a film shows."""
    run = Trajectory.__new__(Trajectory)
    vars(run).update(vars(_run(amplitude, model="vdp")), times=np.asarray(times))
    return run


def test_a_frame_of_a_chain_leaves_no_amplitude_out_and_half_of_it_is_not_empty() -> None:
    axes = Figure().subplots()
    show = snapshot(_run(np.array([[1.0, 0.5], [3.0, 2.0]])), axes)
    (curve,) = axes.lines
    assert (list(curve.get_xdata()), list(curve.get_ydata())) == ([1, 2], [1.0, 0.5])
    show(1)
    assert (list(curve.get_xdata()), list(curve.get_ydata())) == ([1, 2], [3.0, 2.0])
    assert axes.get_ylim()[0] == 0.0
    assert 3.0 < axes.get_ylim()[1] < 6.0


def test_a_film_in_mp4_is_refused_without_the_program_that_writes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("matplotlib.animation.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(MissingPackageError, match="ffmpeg"):
        animate(_trajectory(np.zeros((2, 3))), tmp_path / "run.mp4")
    for rate in (0.5, 61.0):
        with pytest.raises(ParameterError, match="frames per second"):
            animate(_trajectory(np.zeros((2, 3))), tmp_path / "run.gif", frames_per_second=rate)


def test_the_note_of_a_film_is_the_comment_of_its_file(tmp_path: Path) -> None:
    figure = Figure()
    frames = [Image.new("L", (4, 4), shade) for shade in (0, 255)]
    writer = _writer(mpl.animation, ".gif", 15.0, "of two frames", figure.subplots())
    with writer.saving(figure, str(tmp_path / "run.gif"), dpi=10):
        writer._frames += frames
    with Image.open(tmp_path / "run.gif") as film:
        assert (film.n_frames, film.info["comment"]) == (2, b"of two frames")


def test_nothing_of_a_frame_remains_in_the_next_one(tmp_path: Path) -> None:
    figure = Figure(figsize=(0.5, 0.5))
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    axes.set_axis_off()
    (line,) = axes.plot([0.0, 1.0], [0.0, 1.0], animated=True)
    writer = _writer(mpl.animation, ".gif", 15.0, "", axes)
    with writer.saving(figure, str(tmp_path / "run.gif"), dpi=40):
        for end in (1.0, 0.0, 1.0):
            line.set_ydata([0.0, end])
            writer.grab_frame()
        first, middle, last = (np.array(each) for each in writer._frames)
    assert np.array_equal(first, last)
    assert not np.array_equal(first, middle)


def test_each_frame_of_a_film_shows_its_own_sample_and_no_other(tmp_path: Path) -> None:
    """Below the title, a sample that comes again, or that comes first, gives the same frame."""
    one, other = np.array([1.0, 2.0, 3.0]), np.array([3.0, 1.0, 2.0])
    films = []
    for samples in ([one, other, one], [other, one]):
        run = _trajectory(np.array(samples), np.arange(float(len(samples))))
        path = animate(run, tmp_path / "run.gif")
        with Image.open(path) as film:
            frames = [np.array(each.convert("L"), int) for each in ImageSequence.Iterator(film)]
        films.append([each[len(each) // 8 :] for each in frames])
    (first, middle, last), (begin, end) = films
    # Each frame has a palette of its own, which changes a shade of grey a little.
    for same, again in ((first, last), (first, end), (middle, begin)):
        assert np.abs(same - again).max() < 50
    assert (np.abs(first - middle) > 100).sum() > 500


def test_each_frame_of_a_film_has_its_own_time_in_every_style(tmp_path: Path) -> None:
    """Pictures made before set titles to the left; the frames of one sample differ in their title.

    A digit of the title has some ten dark pixels.
    """
    run = _trajectory(np.ones((2, 3)), np.array([1.0, 8.0]))
    with mpl.rc_context({"axes.titlelocation": "left"}):
        path = animate(run, tmp_path / "run.gif")
    with Image.open(path) as film:
        one, other = (np.array(each.convert("L"), int) for each in ImageSequence.Iterator(film))
    differ = np.abs(one - other) > 100
    assert differ[: len(differ) // 8].sum() > 5


@pytest.mark.parametrize(("model", "symbol"), [("vdp", "t"), ("friction", "τ")])
def test_a_film_cuts_no_label_off_and_tells_what_part_of_it_is_drawn(
    model: str, symbol: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Amplitudes far below one have long numbers beside their axis."""

    class Writer:
        @contextmanager
        def saving(self, figure: Figure, *_: Any, **__: Any) -> Iterator[None]:
            yield
            drawn = figure.get_tightbbox()
            assert min(drawn.x0, drawn.y0) > 0.0
            assert all((drawn.x1, drawn.y1) < figure.get_size_inches())

        def grab_frame(self) -> None:
            # Where a title stands is a matter of style, which other tests may have set.
            titles.append("".join(axes.get_title(loc=each) for each in ("left", "center")))

    def writer(*given: Any) -> Writer:
        nonlocal axes
        axes = given[-1]
        return Writer()

    axes: Any = None
    titles: list[str] = []
    monkeypatch.setattr("matplotlib.animation.FFMpegWriter.isAvailable", lambda: True)
    monkeypatch.setattr("fronts.animation._writer", writer)
    run = _trajectory(np.array([[1e-3, 2e-3], [2e-3, 1.1e-3]]), [0.0, 5.0])
    vars(run.chain)["model"] = model
    seen: list[float] = []
    assert animate(run, "run.mp4", progress=seen.append) == Path("run.mp4")
    assert titles == [f"{symbol} = 0", f"{symbol} = 5"]
    assert seen == [0.5, 1.0]


def test_a_frame_of_a_chain_at_rest_has_an_axis() -> None:
    axes = Figure().subplots()
    snapshot(_run(np.zeros((2, 3))), axes)
    assert axes.get_ylim()[1] > 0.0


def test_sites_of_a_lattice_are_drawn_where_they_are() -> None:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.866], [1.5, 0.866]])
    axes = Figure().subplots()
    links = SimpleNamespace(positions=places)
    show = snapshot(_run(np.array([[1.0, 2, 3, 4], [5, 6, 7, 8]]), shape=(2, 2), links=links), axes)
    (dots,) = axes.collections
    assert np.array_equal(dots.get_offsets(), places)
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_aspect()) == (
        "x (lattice spacings)", "y (lattice spacings)", 1.0,
    )  # fmt: skip
    assert dots.colorbar.ax.get_ylabel() == "amplitude"
    assert dots.get_clim() == (0.0, 8.0)
    assert list(dots.get_array()) == [1.0, 2.0, 3.0, 4.0]
    show(1)
    assert list(dots.get_array()) == [5.0, 6.0, 7.0, 8.0]
    axes.set(xlim=(0.0, 2.2), ylim=(0.0, 2.2))
    assert all(tick == round(tick) for tick in (*axes.get_xticks(), *axes.get_yticks()))


def test_marks_of_more_sites_are_smaller_so_that_they_do_not_cover_one_another() -> None:
    sizes = []
    for count in (4, 1000, 4000):
        places = np.column_stack([np.arange(count) + 0.5, np.zeros(count)])
        axes = Figure().subplots()
        links = SimpleNamespace(positions=places)
        snapshot(_run(np.ones((1, count)), shape=(1, count), links=links), axes)
        (dots,) = axes.collections
        sizes += list(dots.get_sizes())
        detail = SimpleNamespace(positions=places, arrivals=np.arange(count))
        axes = Figure().subplots()
        DRAWINGS["Front"](SimpleNamespace(detail=detail), axes)
        assert list(axes.collections[0].get_sizes()) == sizes[-1:]
    assert sizes[1] < sizes[0]
    assert sizes[1] * 1000 == sizes[2] * 4000  # the same area


def test_the_first_sample_of_a_square_lattice_is_drawn_in_its_rows() -> None:
    links = SimpleNamespace(positions=np.array([[0.0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]))
    axes = Figure().subplots()
    samples = np.arange(12.0).reshape(2, 6)
    show = snapshot(_run(samples, shape=(2, 3), links=links), axes)
    (image,) = axes.images
    assert np.array_equal(image.get_array(), [[0.0, 1, 2], [3, 4, 5]])
    show(1)
    assert np.array_equal(image.get_array(), [[6.0, 7, 8], [9, 10, 11]])


def _results() -> dict[str, Any]:
    """Made-up results of the classes that are drawn, with all that their pictures show."""
    from fronts.curves import Curve

    @dataclass(frozen=True, kw_only=True)
    class Way(Result):
        v: float
        method: str

    ways = tuple(Way(v=v, method=method) for v, method in ((1.0, "run"), (2.0, "wave")))
    ends = np.array([0.1, 0.2])
    amplitude = np.arange(12.0).reshape(3, 4)
    run = _run(amplitude, model="averaged")
    run.times, run.arrivals = np.array([0.0, 5.0, 10.0]), np.array([0.0, np.nan, 7.0, 9.0])
    instant = _run(np.array([[1.0, 3.0, 2.0]]), model="friction")
    instant.times = np.array([7.5])
    square = SimpleNamespace(positions=np.array([[0.0, 0], [1, 0], [0, 1], [1, 1]]))
    lattice = _run(amplitude, model="vdp", shape=(2, 2), links=square)
    lattice.times = run.times
    line = SimpleNamespace(positions=np.arange(3.0))
    front, slow = (SimpleNamespace(detail=detail, arrivals=run.times, v=0.5,
                                   chain=SimpleNamespace(time_unit=unit))
                   for detail, unit in ((None, 1.0), (line, 100.0)))  # fmt: skip
    v_d = np.linspace(0.9, 2.0, 12)
    cycles = np.stack([-v_d, v_d], axis=1)
    states = table_of([{"c": c, "v_d": v, "label": "front" if c else "breather"}
                       for c in (0.0, 0.1) for v in (1.0, 2.0)])  # fmt: skip
    branches = [SimpleNamespace(v=v, admissible=v < 0.5, stable=None) for v in (0.3, 0.7)]
    relation = SimpleNamespace(c=0.5, branches=branches, limit_shown=False, c_fold=None, c_pin=0.4,
                               c_retreat=None)  # fmt: skip
    breathers = [SimpleNamespace(amplitudes=x * np.array([0.1, 1.0])) for x in (1.0, 2.0)]
    return {
        "KineticRelation": relation,
        "KineticCurve": SimpleNamespace(along="c", points=[relation]),
        "Bifurcation": SimpleNamespace(
            v_d=v_d, stable=3.0 * cycles, unstable=2.0 * cycles, sliding=0.5 * v_d,
            cycle_end_velocity=1.95, hopf_velocity=0.95, sliding_stable=v_d > 0.95,
        ),
        "FollowedBranch": _branch("c", [True, True, False, False]),
        "Curve": Curve(along="c", values=ends, points=ways, seconds=0.0),
        "Curve of one method": Curve(along="eta", values=ends, points=ways[:1] * 2, seconds=0.0),
        "Trajectory": run,
        "Trajectory of one instant": instant,
        "Trajectory of a lattice": lattice,
        "Front": front,
        "Front in slow time": slow,
        "StateMap": SimpleNamespace(axes=("c", "v_d"), states=states, boundary=None),
        "Breather": breathers[0],
        "BreatherComparison": SimpleNamespace(methods=dict(zip("ab", breathers, strict=True))),
    }  # fmt: skip


NAMES: dict[str, tuple[str, str, str, list[str], list[tuple[float, float]]]] = {
    "KineticRelation": ("coupling c", SLOW_VELOCITY, "", ["admissible", "not admissible"],
                        [(0.5, 0.3), (0.5, 0.7)]),
    "KineticCurve": ("coupling c", SLOW_VELOCITY, "", ["admissible", "not admissible"],
                     [(0.5, 0.3), (0.5, 0.7)]),
    "Bifurcation": ("belt velocity $v_d$", "turning points of y", "",
                    ["stick-slip cycle", "unstable cycle", "steady sliding, stable",
                     "steady sliding, unstable", "Hopf, $v_d$ = 0.95", "grazing, $v_d$ = 1.95"],
                    []),
    "FollowedBranch": ("coupling c", SLOW_VELOCITY, "", ["stable", "not stable"],
                       [(x, 2.0 * x) for x in np.linspace(0.6, 0.2, 4)]),
    "Curve": ("coupling c", "front velocity v", "", ["run", "wave"], [(0.1, 1.0), (0.2, 2.0)]),
    "Curve of one method": ("η = b/a²", "front velocity v", "", [], [(0.1, 1.0), (0.2, 1.0)]),
    "Trajectory": ("time t", "site n", "", ["reached"], [(0.0, 1), (7.0, 3), (9.0, 4)]),
    "Trajectory of one instant": ("site n", "amplitude", "time τ = 7.5", [],
                                  [(1, 1.0), (2, 3.0), (3, 2.0)]),
    "Trajectory of a lattice": ("column", "row", "t = 10", [], []),
    "Front": ("time of arrival", "sites passed", "v = 0.5", [], [(0.0, 1), (5.0, 2), (10.0, 3)]),
    "Front in slow time": (r"slow time of arrival $\varepsilon t$", "sites passed",
                           r"$\hat v$ = 0.5", [],
                           [(0.0, 1), (0.05, 2), (0.1, 3)]),
    "StateMap": ("coupling c", "belt velocity $v_d$", "", ["front (2)", "breather (2)"],
                 [(0.1, 1.0), (0.1, 2.0), (0.0, 1.0), (0.0, 2.0)]),
    "Breather": ("site n", "amplitude", "", [], [(1, 0.1), (2, 1.0)]),
    "BreatherComparison": ("site n", "amplitude", "", ["a", "b"],
                           [(1, 0.1), (2, 1.0), (1, 0.2), (2, 2.0)]),
}  # fmt: skip
"""Names of the axes, title, entries of the legend, and the points that are marked."""


def test_every_picture_names_its_axes_its_colours_and_what_is_in_it() -> None:
    images = {"Trajectory": np.arange(12.0).reshape(3, 4).T,
              "Trajectory of a lattice": [[8.0, 9.0], [10.0, 11.0]]}  # fmt: skip
    for name, result in _results().items():
        axes = Figure().subplots()
        DRAWINGS[name.partition(" ")[0]](result, axes)
        across, up, title, named, points = NAMES[name]
        assert (axes.get_xlabel(), axes.get_ylabel()) == (across, up), name
        # Where a title stands is a matter of style, which other tests may have set.
        titles = [axes.get_title(loc=each) for each in ("left", "center", "right")]
        assert "".join(titles) == title, name
        marked = [line for line in axes.lines if line.get_marker() not in ("", "None")]
        drawn = [pair for line in marked for pair in _marked(line)]
        assert np.ravel(drawn) == pytest.approx(np.ravel(points)), name
        legend = axes.get_legend()
        shown = [text.get_text() for text in legend.get_texts()] if legend else []
        assert shown == axes.get_legend_handles_labels()[1] == named, name
        beside, image = axes.figure.axes[1:], axes.images
        assert [each.get_ylabel() for each in beside] == ["amplitude"] * len(image), name
        assert all(np.array_equal(each.get_array(), images[name]) for each in image), name
        assert len(image) == (name in images), name
        assert not image or not legend or legend.get_frame_on(), name  # readable on the image


@pytest.mark.parametrize("asked", [True, False])
def test_every_kind_of_solution_has_its_name_and_its_mark(asked: bool) -> None:
    """Where stability was not asked for there is nothing that was not decided."""
    kinds: list[tuple[bool | None, bool | None, str, str]] = [
        (True, None, "admissible, stability not decided", "x") if asked
        else (True, None, "admissible", "o"),
        (False, None, "not admissible", "o"), (None, None, "not decided", "o"),
    ]  # fmt: skip
    if asked:
        kinds += [(True, True, "admissible, stable", "o"),
                  (True, False, "admissible, not stable", "s")]  # fmt: skip
    branches = [SimpleNamespace(v=1.0 + k, admissible=admissible, stable=stable)
                for k, (admissible, stable, _, _) in enumerate(kinds)]  # fmt: skip
    axes = Figure().subplots()
    relation = _results()["KineticRelation"]
    DRAWINGS["KineticRelation"](SimpleNamespace(**{**vars(relation), "branches": branches}), axes)
    found = {str(line.get_label()): (line.get_marker(), *map(float, line.get_xydata()[0]))
             for line in axes.lines}  # fmt: skip
    assert found == {name: (mark, 0.5, 1.0 + k) for k, (*_, name, mark) in enumerate(kinds)}


# ---------------------------------------------------------------------------- the explorer's page


def _kinetic(c: float, eta: float) -> tuple[Any, Any]:
    from fronts.explore.pictures import KineticPicture

    picture, point = KineticPicture(), fr.kinetic_relation(c=c, eta=eta)
    from fronts.explore.calls import Settings

    picture.show(Settings(c=c, eta=eta), {"point": point})
    return picture, point


@needs_explorer
def test_the_explorer_shows_every_branch_at_the_coupling_and_what_is_known_of_it() -> None:
    picture, point = _kinetic(0.5, 0.03125)
    assert picture.point.data["y"] == [each.v for each in point.branches]
    assert set(picture.point.data["x"]) == {0.5}
    assert picture.here.location == 0.5
    assert f"v = {point.branches[-1].v:.12g} " in picture.caption.text
    assert "(admissible, stable)" in picture.caption.text
    assert (picture.figure.visible, picture.refusal.visible) == (True, False)


@needs_explorer
def test_the_explorer_draws_every_branch_and_says_the_last_two() -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.pictures import KineticPicture

    kinds = ((0.25, False, None), (0.5, True, False), (0.75, None, None))
    branches = [SimpleNamespace(v=v, error=1e-9, admissible=each, stable=stable)
                for v, each, stable in kinds]  # fmt: skip
    point = SimpleNamespace(c=0.5, c_pin=None, branches=branches)
    picture = KineticPicture()
    picture.show(Settings(), {"point": point, "curve": "refused in a sentence"})
    assert not len(picture.curve[True].data["x"])
    picture.show(Settings(), {"point": point, "curve": SimpleNamespace(points=[point])})
    assert dict(picture.curve[True].data) == {"x": [0.5], "y": [0.5]}
    assert dict(picture.curve[False].data) == {"x": [0.5, 0.5], "y": [0.25, 0.75]}
    said = "v = 0.5 ± 1e-09 (admissible, unstable), v = 0.75 ± 1e-09 (not decided)"
    assert picture.caption.text == said


@needs_explorer
def test_the_explorer_says_that_a_front_is_pinned_below_its_threshold() -> None:
    """There fronts travel at stronger coupling, so that the curve has something to show."""
    picture, point = _kinetic(0.01, 0.03125)
    assert not point.branches
    assert picture.caption.text == f"{point.status.value}: {point.reason}"
    assert picture.figure.visible


@needs_explorer
def test_the_explorer_says_that_no_front_travels_where_none_does_at_any_coupling() -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.pictures import KineticPicture

    status = SimpleNamespace(value="none")
    nowhere = SimpleNamespace(c=0.5, c_pin=None, branches=(), reason="none at all", status=status)
    picture = KineticPicture()
    picture.show(Settings(), {"point": nowhere})
    assert picture.refusal.text == "No front travels: none at all"
    assert (picture.figure.visible, picture.refusal.visible) == (False, True)
    some = SimpleNamespace(**{**vars(nowhere), "c_pin": 0.1})
    picture.show(Settings(), {"point": some})
    assert picture.figure.visible
    picture.show(Settings(), {"point": "refused in a sentence"})
    assert picture.refusal.text == "refused in a sentence"


@needs_explorer
@pytest.mark.parametrize("index", range(6))
def test_the_explorer_shows_neither_picture_nor_sentence_before_there_is_a_result(
    index: int,
) -> None:
    from fronts.explore.pictures import PICTURES

    picture = PICTURES[index]()
    assert (picture.figure.visible, picture.refusal.visible) == (False, False)
    assert len(PICTURES) == 6


@needs_explorer
def test_the_explorer_waits_for_every_call_that_a_picture_needs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.pictures import KineticPicture

    monkeypatch.setattr(KineticPicture, "needs", ("point", "curve"))
    picture, point = KineticPicture(), fr.kinetic_relation(c=0.5, eta=0.03125)
    curve = fr.kinetic_relation(c=[0.45, 0.5], eta=0.03125)
    for found in ({"point": point}, {"curve": curve}, {"point": point, "curve": curve}):
        picture.show(Settings(), found)
        assert picture.figure.visible == (len(found) == 2)


@needs_explorer
def test_squares_of_the_explorer_are_as_large_as_the_steps_of_the_map() -> None:
    from fronts.explore.calls import Settings, calls
    from fronts.explore.pictures import StatesPicture

    steps = dict(calls(Settings())["states"].options)
    glyphs = [each.glyph for each in StatesPicture().figure.renderers]
    squares = [
        (each.x, each.y, each.width, each.height) for each in glyphs if hasattr(each, "width")
    ]
    assert squares == [("x", "y", steps["eta"].step, steps["c"].step)] * len(StatesPicture.COLOURS)
    assert steps["refine"] == 0.0  # boundaries would take longer, and are not drawn


@needs_explorer
def test_the_image_of_the_run_fills_its_picture_with_each_site_in_the_middle_of_its_row() -> None:
    from bokeh.models import ColorBar

    from fronts.explore.calls import SITES, SLOW_TIME
    from fronts.explore.pictures import RunPicture

    figure = RunPicture().figure
    assert [bar.title for bar in figure.select(type=ColorBar)] == ["amplitude"]
    (image,) = (each.glyph for each in figure.renderers)
    across, up = figure.x_range, figure.y_range
    assert (image.x, image.x + image.dw) == (across.start, across.end) == (0.0, SLOW_TIME)
    assert (image.y, image.y + image.dh) == (up.start, up.end) == (0.5, SITES + 0.5)
    (now,) = figure.select({"name": "now"})
    assert now.location == 0.0  # as the clock says at first


@needs_explorer
@pytest.mark.parametrize(("index", "lines"), [*enumerate((1, 1, 0, 1, 2, 0))])
def test_every_straight_line_and_every_column_of_the_explorer_is_in_its_figure(
    index: int, lines: int
) -> None:
    from bokeh.models import ColumnDataSource, Span

    from fronts.explore.pictures import PICTURES, RunPicture

    kind = PICTURES[index]
    picture = kind()
    held = [each.values() if isinstance(each, dict) else each if isinstance(each, tuple)
            else (each,) for each in vars(picture).values()]  # fmt: skip
    spans = [each for some in held for each in some if isinstance(each, Span)]
    assert all(span in picture.figure.center for span in spans)
    assert len(spans) == lines
    for source in (x for some in held for x in some if isinstance(x, ColumnDataSource)):
        glyphs = [each.glyph for each in picture.figure.renderers if each.data_source is source]
        across = {glyph.x for glyph in glyphs}
        drawn = {getattr(glyph, at, "x") for glyph in glyphs for at in ("x", "y", "image")}
        assert glyphs, (kind, source.name)
        assert across == ({0.0} if kind is RunPicture else {"x"})
        assert drawn >= set(source.column_names), (kind, source.name)


@needs_explorer
def test_the_explorer_fills_the_marks_of_what_is_admissible_only() -> None:
    picture, _ = _kinetic(0.5, 0.03125)
    fills = {each.data_source.name: each.glyph.fill_alpha for each in picture.figure.renderers}
    assert (fills["curve-True"], fills["curve-False"]) == (1.0, 0.0)


@needs_explorer
def test_the_explorer_draws_modulus_real_and_imaginary_part_of_the_profile() -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.pictures import ProfilePicture

    picture, front = ProfilePicture(), fr.front_profile(c=0.5, eta=0.03125)
    picture.show(Settings(), {"profile": front})
    shape = picture.shape.data
    assert np.array_equal(shape["x"], front.zeta)
    assert np.allclose(np.hypot(shape["re"], shape["im"]), shape["modulus"])
    assert np.array_equal(shape["re"] + 1j * shape["im"], front.phi)
    assert np.array_equal(front.columns()["abs_phi"], shape["modulus"])
    said = f"v = {front.v:.6g}, admissible; "
    assert picture.caption.text.startswith(said)
    assert picture.threshold.location == front.threshold
    picture.show(Settings(), {"profile": replace(front, admissible=False)})
    assert picture.caption.text.startswith(said.replace("adm", "not adm"))


def _frame(nucleus: int, breather: Any, height: float = 1.0) -> Any:
    from fronts.explore.calls import SITES, Settings
    from fronts.explore.pictures import NowPicture

    chain = SimpleNamespace(stable_amplitude=2.0, unstable_amplitude=1.0)
    amplitude = height * np.arange(float(SITES)) * np.array([[1.0], [0.5]])
    found = {"run": SimpleNamespace(chain=chain, amplitude=amplitude), "breather": breather}
    picture = NowPicture()
    picture.show(Settings(nucleus=nucleus), found)
    return picture


@needs_explorer
@pytest.mark.parametrize("size", [1, 2, 3, 9])
def test_the_explorer_puts_the_breather_where_the_nucleus_is(size: int) -> None:
    """The run is excited at the same sites, and the breather has its largest amplitudes there."""
    from fronts.explore.calls import AROUND, Settings, calls

    called = calls(Settings(c=0.02, nucleus=size))
    breather = called["breather"].run()
    picture = _frame(size, breather)
    drawn = picture.breather.data
    excited = [x for x, y in zip(drawn["x"], drawn["y"], strict=True) if y > 1.0]
    assert excited == list(called["run"].arguments[1].arguments[1])
    assert len(drawn["x"]) == size + 2 * AROUND


@needs_explorer
def test_the_explorer_draws_the_chain_without_a_breather() -> None:
    for breather in (None, "refused in a sentence"):
        picture = _frame(1, breather)
        assert not len(picture.breather.data["x"])
        assert [each.location for each in picture.cycles] == [2.0, 1.0]


@needs_explorer
@pytest.mark.parametrize(("fold", "where"), [(0.25, " The fold is at c = 0.25."), (None, "")])
def test_the_explorer_says_why_there_are_no_multipliers(fold: float | None, where: str) -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.pictures import MultipliersPicture

    status = SimpleNamespace(sentence="no breather exists.")
    picture = MultipliersPicture()
    breather = SimpleNamespace(multipliers=None, fold=fold, status=status)
    picture.show(Settings(), {"breather": breather})
    assert picture.refusal.text == f"No breather exists.{where}"
    picture.show(Settings(), {"breather": "refused in a sentence"})
    assert picture.refusal.text == "refused in a sentence"


@needs_explorer
def test_the_explorer_leaves_the_trivial_multiplier_out_of_the_largest() -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.pictures import MultipliersPicture

    multipliers = np.array([0.3 + 0.4j, 1.0 + 1e-9, 0.2])
    breather = SimpleNamespace(multipliers=multipliers, stable=True, trivial=1e-9)
    picture = MultipliersPicture()
    picture.show(Settings(), {"breather": breather})
    assert "trivial one is 0.5;" in picture.caption.text
    assert np.array_equal(picture.points.data["x"], multipliers.real)
    assert np.array_equal(picture.points.data["y"], multipliers.imag)
    assert picture.caption.text.startswith("stable: ")
    unstable = SimpleNamespace(
        multipliers=np.array([2.2, 1.0, 0.2 + 0.0j]), stable=False, trivial=1e-9
    )
    picture.show(Settings(), {"breather": unstable})
    assert picture.caption.text.startswith(
        "not stable: the largest |μ| apart from the trivial one is 2.2;"
    )
    circle = picture.figure.renderers[0].data_source.data
    assert np.allclose(np.hypot(circle["x"], circle["y"]), 1.0)
    assert circle["x"][0] == pytest.approx(circle["x"][-1])
    assert np.ptp(np.unwrap(np.arctan2(circle["y"], circle["x"]))) == pytest.approx(2 * np.pi)
    for span in (picture.figure.x_range, picture.figure.y_range):  # with the whole circle
        assert (span.start < -1.0, span.end > 1.0) == (True, True)


def test_panels_stand_side_by_side_and_then_below_in_a_column_or_a_page() -> None:
    figure, panels = new_panels(3, 2, width="page", height=4.0)
    assert figure.get_size_inches().tolist() == [7.0, 4.0]
    places = [axes.get_subplotspec() for axes in panels]
    assert [(each.rowspan.start, each.colspan.start) for each in places if each] == [
        (row, column) for row in (0, 1) for column in (0, 1, 2)
    ]
    assert new_axes("column")[0].get_size_inches().tolist() == [3.4, 3.4 * 0.68]


def test_the_style_of_pictures_leaves_room_for_labels_and_yellow_for_areas() -> None:
    """A yellow line on white cannot be seen; without a layout labels are cut off or overlap."""
    with mpl.rc_context():
        mpl.rcdefaults()
        use_style()
        lines = mpl.rcParams["axes.prop_cycle"].by_key()["color"]
        assert set(lines) == {colour for name, colour in COLOURS.items() if name != "yellow"}
        assert isinstance(Figure().get_layout_engine(), ConstrainedLayoutEngine)
        assert mpl.rcParams["axes.axisbelow"] is True


@needs_explorer
def test_the_explorer_leaves_no_amplitude_of_the_chain_out() -> None:
    from fronts.explore.calls import SITES

    picture = _frame(1, None)
    up = picture.figure.y_range
    assert up.start == 0.0
    assert SITES - 1.0 < up.end < 2.0 * SITES
    assert list(picture.chain.data["x"]) == list(range(1, SITES + 1))
    assert list(picture.chain.data["y"]) == list(range(SITES))
    assert 2.0 < _frame(1, None, height=1e-3).figure.y_range.end < 4.0  # nor the stable cycle


@needs_explorer
def test_the_explorer_colours_the_largest_amplitude_at_first_and_that_of_the_cycle() -> None:
    from fronts.explore.calls import SITES, Settings
    from fronts.explore.pictures import RunPicture

    for cycle, largest in ((2.0, 3.0), (4.0, 4.0)):
        amplitude = np.vstack([np.linspace(0.0, 3.0, SITES), np.ones((4, SITES))])
        run = SimpleNamespace(amplitude=amplitude, arrivals=np.array([0.0, np.nan, 7.0]),
                              chain=SimpleNamespace(stable_amplitude=cycle))  # fmt: skip
        picture = RunPicture()
        picture.show(Settings(), {"run": run})
        assert picture.colours.low == 0.0
        assert largest < picture.colours.high < 1.1 * largest
        (image,) = picture.image.data["image"]
        assert np.allclose(image, amplitude.T)  # sent in single precision
        assert picture.caption.text.startswith(f"2 of {SITES} sites ")


@needs_explorer
def test_errors_of_the_run_of_the_explorer_are_not_visible() -> None:
    from fronts.explore.calls import Settings, calls

    shown = calls(Settings())["run"]
    finer = replace(shown, options=tuple((dict(shown.options) | {"tolerance": 1e-10}).items()))
    off = np.abs(shown.run().amplitude - finer.run().amplitude).max()
    assert 0.0 < off < 1e-5


@needs_explorer
def test_the_explorer_fills_the_map_once_and_moves_the_place_in_it() -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.pictures import StatesPicture

    rows = [(0.01, 0.1, "front"), (0.02, 0.1, "breather"), (0.02, 0.2, "front"),
            (0.13, 0.2, "fixed point"), (0.13, 0.3, "undecided")]  # fmt: skip
    eta, c, label = (np.array(each) for each in zip(*rows, strict=True))
    asked = []

    def columns() -> dict[str, Any]:
        asked.append(1)
        return {"eta": eta, "c": c, "label": label}

    picture, point = StatesPicture(), object()
    picture.show(Settings(eta=0.05, c=0.5), {"point": point})
    assert not any(len(each.data["x"]) for each in picture.squares.values())
    for place in (0.5, 0.25):
        found = {"point": point, "states": SimpleNamespace(columns=columns)}
        picture.show(Settings(eta=0.05, c=place), found)
        assert dict(picture.place.data) == {"x": [0.05], "y": [place]}
        for state, source in picture.squares.items():
            shown = list(zip(source.data["x"], source.data["y"], strict=True))
            assert shown == [(x, y) for x, y, kind in rows if kind == state]
    assert len(asked) == 1


@needs_explorer
@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")  # of panel: names of widgets
def test_the_controls_say_eta_or_what_follows_from_a_and_b() -> None:
    from fronts.explore.page import Controls

    controls = Controls()
    assert (controls.a.visible, controls.b.visible, controls.eta.visible) == (False, False, True)
    for number in (
        controls.c,
        controls.eta,
        controls.a,
        controls.b,
        controls.eps,
        controls.nucleus,
    ):
        assert number.start <= number.value <= number.end
    controls.c.value = 0.75
    assert (controls.settings().eta, controls.settings().a) == (controls.eta.value, None)
    controls.damping.value = True
    controls.a.value, controls.b.value = 2.0, 0.25
    said = controls.settings()
    assert (said.eta, said.a, said.b, said.c) == (0.0625, 2.0, 0.25, 0.75)
    assert (controls.a.visible, controls.b.visible, controls.eta.visible) == (True, True, False)


@needs_explorer
@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")  # of panel: names of widgets
def test_the_page_follows_every_new_setting_once_until_it_is_closed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from bokeh.document import Document
    from panel.io.state import set_curdoc

    from fronts.explore.page import ExplorerPage
    from fronts.explore.pictures import RunPicture

    asked: list[Any] = []
    monkeypatch.setattr(ExplorerPage, "_work", lambda _, settings: asked.append(settings))
    with set_curdoc(Document()):
        page = ExplorerPage()
    assert not page.code.visible
    view: Any = page.view()
    title, first, code, (*cards,) = view
    assert (title.object, code) == ("<h1>Excitation fronts</h1>", page.code)
    *controls, button, status = first
    assert (controls, status) == (list(page.controls.all), page.status)
    for button.value in (True, False):
        assert page.code.visible is button.value
    assert [card[2].object for card in cards] == [each.figure for each in page.pictures]
    page.controls.c.value = 0.75
    page.follow()
    page.worker.submit(lambda: None).result()  # after all before it
    assert asked == [replace(page.controls.settings(), c=0.5), page.controls.settings()]
    (run,) = (each for each in page.pictures if isinstance(each, RunPicture))
    assert run.now.tags == [0]  # the sample at which the clock stands
    (closed,) = page.document.session_destroyed_callbacks
    ready = page.document.callbacks._js_event_callbacks
    assert list(ready) == ["document_ready"]  # which starts the clock of the run
    assert (page.worker._max_workers, page.code.visible) == (1, False)
    worker, page.worker = page.worker, Mock(wraps=page.worker)
    closed(None)
    page.worker.shutdown.assert_called_once_with(cancel_futures=True)
    page.worker = worker
    assert not page.document.session_callbacks
    page._later(lambda: None)
    assert len(page.document.session_callbacks) == 1
    with pytest.raises(RuntimeError, match="after shutdown"):
        page.controls.c.value = 0.25


@needs_explorer
def test_the_page_shows_its_program_or_in_its_place_a_defect(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Both as text, whatever signs of HTML are in it."""
    from fronts.explore import page as module
    from fronts.explore.calls import Settings

    def shown(failing: Any) -> list[dict[str, str]]:
        said: list[dict[str, str]] = []
        pane = SimpleNamespace(param=SimpleNamespace(update=lambda **new: said.append(new)))
        settings = Settings()
        page: Any = SimpleNamespace(current=settings, code=pane, status=pane,
                                    _later=lambda do: do())  # fmt: skip
        monkeypatch.setattr(module, "calls", failing)
        monkeypatch.setattr(module, "script", lambda _: "1 < 2")
        module.ExplorerPage._work(page, settings)
        return said

    assert shown(lambda _: {}) == [{"object": "<pre>1 &lt; 2</pre>"}]
    asked: list[str] = []

    def executed(name: str) -> None:
        asked.append(name)
        page.current = None  # the controls are moved

    settings = Settings()
    page: Any = SimpleNamespace(current=settings, _later=Mock(), _shower=Mock())
    monkeypatch.setattr(module, "outcome", executed)
    names = ("point", "profile", "curve", "run")
    monkeypatch.setattr(module, "calls", lambda _: dict(zip(names, names, strict=True)))
    for _ in range(2):  # what is fast is shown all the same, what is slow is not begun
        module.ExplorerPage._work(page, settings)
        assert asked == ["point", "profile"]
    found = {"point": None}, {"point": None, "profile": None}
    assert page._shower.call_args_list == [call(settings, each) for each in found]
    assert page._later.call_args_list == [call(page._shower.return_value)] * len(found)
    defect = Mock(side_effect=ZeroDivisionError("a < b"))
    assert shown(defect) == [{"object": "a defect of this toolkit: ZeroDivisionError: a &lt; b"}]


@needs_explorer
def test_what_is_newest_is_shown_by_the_pictures_that_need_it_or_take_it_too() -> None:
    from fronts.explore.calls import Settings
    from fronts.explore.page import ExplorerPage

    shown: list[str] = []

    def picture(name: str, needs: tuple[str, ...], also: tuple[str, ...]) -> Any:
        def show(settings: Settings, found: Any) -> None:
            assert (type(settings), held) == (Settings, ["hold"])
            assert set(found) <= set(results)
            shown.append(name)

        return SimpleNamespace(needs=needs, also=also, show=show)

    pictures = [picture("a", ("run",), ("breather",)), picture("b", ("breather",), ()),
                picture("c", ("point",), ("run",))]  # fmt: skip
    held: list[str] = []
    document = SimpleNamespace(hold=lambda _: held.append("hold"), unhold=held.clear)
    page: Any = SimpleNamespace(document=document, pictures=pictures, begun=0.0,
                                status=SimpleNamespace(object=""))  # fmt: skip
    results = {"point": 1, "run": 2, "breather": 3, "curve": 4}
    for count, expected in ((1, ["c"]), (2, ["a", "c"]), (3, ["a", "b"]), (4, [])):
        shown.clear()
        found = dict(list(results.items())[:count])
        ExplorerPage._shower(page, Settings(), found)()
        assert (shown, held) == (expected, [])
        assert bool(page.status.object) is (count >= 3)
        assert "updated in" not in page.status.object  # the first one includes compiling
    ExplorerPage._shower(page, Settings(), dict(list(results.items())[:3]))()
    assert "; updated in " in page.status.object


def test_a_picture_may_have_guides_and_is_emptied_and_a_large_one_is_told(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(figures, "_render", lambda name, figure: "x" * 12_300_000)
    figure = Figure()
    axes = figure.subplots()
    axes.plot([0.0, 1.0], [0.0, 2.0])
    axes.plot([0.0, 1.0], [0.0, 3.0], label="slope")
    data = {"x": [0.0, 1.0], "y": [0.0, 2.0]}
    with pytest.raises(ValueError, match="draws 'slope'"):
        picture("line", figure, data, encoded=False)
    assert picture("line", figure, data, guides=True, encoded=False).png == ""
    assert "the picture line has 12.3 MB" in caplog.text
    assert figure.axes == []
