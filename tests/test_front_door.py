"""``import fronts`` and what it promises: names, cost, results, files."""

from __future__ import annotations

import csv
import dataclasses
import inspect
import json
import math
import os
import pickle
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import matplotlib as mpl
import mpmath as mp
import numpy as np
import pytest

import fronts as fr
from fronts.bound import BoundCall, located, models_of
from fronts.catalogue import COMMANDS
from fronts.cli import main, whole_parser
from fronts.curves import Refusal
from fronts.signatures import described, documented
from fronts.wording import in_words
from theory.piecewise.profile import front_profile
from theory.result import Result

HEAVY = ("numpy", "scipy", "sympy", "matplotlib", "mpmath", "numba", "pandas", "xarray")

mpl.use("agg")


def _python(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False
    )


def test_import_loads_nothing_heavy(tmp_path):
    code = "import sys, fronts; print(*{name.partition('.')[0] for name in sys.modules})"
    assert not {*HEAVY} & {*_python(code, tmp_path).stdout.split()}


def test_every_public_name_is_there():
    assert len(fr.__all__) > 30
    assert {*dir(fr)} == {*fr.__all__}
    for name in fr.__all__:
        assert getattr(fr, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nosuchname'"):
        fr.nosuchname


def test_errors_of_derivations_and_sweeps_can_be_caught_by_their_public_names():
    with pytest.raises(fr.DerivationInputError, match="damping"):
        fr.derive_cell("sin(y)")
    with pytest.raises(fr.SweepError, match="division by zero") as caught:
        fr.sweep(lambda point: 1.0 / point["c"], {"c": [0.0, 1.0]})
    assert len(caught.value.failures) == 1


@pytest.mark.parametrize("package", ["theory", "derivations", "verification", "paper_checks"])
@pytest.mark.parametrize("kind", ["file", "folder"])
def test_a_file_of_the_user_that_hides_a_package_is_named(package, kind, tmp_path):
    hiding = tmp_path / (f"{package}.py" if kind == "file" else package)
    if kind == "file":
        hiding.write_text("x = 1\n")
    else:
        hiding.mkdir()
        (hiding / "__init__.py").write_text("")
    shown = _python("import fronts", tmp_path)
    assert shown.returncode == 1
    last = shown.stderr.strip().splitlines()[-1]
    assert last.startswith(f"ImportError: {hiding} hides the package '{package}'")
    assert last.count(".") >= 1
    assert last.endswith("folder.")


def test_a_file_of_another_name_hides_nothing(tmp_path):
    (tmp_path / "theories.py").write_text("")
    assert _python("import fronts; fronts.VdpChain", tmp_path).returncode == 0


def _subclasses(of: type) -> set[type]:
    return {of}.union(*map(_subclasses, of.__subclasses__()))


def test_every_result_is_frozen_and_keyword_only():
    for name in fr.__all__:
        getattr(fr, name)
    for name in COMMANDS:
        for call in COMMANDS[name].calls.values():
            located(call.function)
    kinds = _subclasses(Result) - {Result}
    assert len(kinds) > 8
    for kind in kinds:
        options = kind.__dataclass_params__
        assert options.frozen, kind
        assert all(each.kw_only for each in dataclasses.fields(kind) if each.init), kind


def _results() -> dict[str, Result]:
    return {
        "point": fr.kinetic_relation(c=0.45, eta=0.03125),
        "curve": fr.kinetic_relation(c=[0.4, 0.45, 0.5], eta=0.03125),
        "roots": fr.roots(0.3, 0.5, count=4),
        "profile": fr.front_profile(0.5, 0.03125, points=11),
        "cell": fr.cell(fr.VdpChain(a=2.5, b=0.5, c=0.0)),
        "breather": fr.breather(fr.VdpChain(a=2.5, b=0.5, c=0.1, sites=9), method="envelope"),
    }


RESULTS = ("point", "curve", "roots", "profile", "cell", "breather")


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    return _results()


def test_text_is_shown_in_a_notebook_without_quotes():
    shown = Refusal(reason="c < 0")._repr_html_()
    assert re.findall("<td[^>]*>([^<]*)</td>", shown) == ["refused", "c &lt; 0"]


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_shows_itself(name, results):
    result = results[name]
    json.dumps(result.to_dict(), allow_nan=False)
    assert len(repr(result)) < 1200
    assert repr(result).startswith(type(result).__name__ + "(")
    assert "array(" not in repr(result)
    shown = result._repr_html_()
    assert shown.startswith("<table>")
    assert "nan" not in shown
    assert "np." not in shown
    fields = [field.name for field in dataclasses.fields(result) if field.repr]
    held = {"branches", "points", "upper", "lower"}  # these are rows of a table of their own
    for each in {*fields, *result.derived} - held:
        assert f">{each}</th>" in shown


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_is_its_copy_and_no_other(name, results):
    result = results[name]
    copy = pickle.loads(pickle.dumps(result))
    assert copy == result
    assert hash(copy) == hash(result)
    assert result != 1
    assert all(result != other for key, other in results.items() if key != name)


@pytest.mark.parametrize(("of", "order"), [(34, 1), (42, 1), ("multiple-scales", 2)])
def test_a_derivation_can_be_stored_and_checked_again(of, order):
    one = fr.derivation(of, order=order)
    copy = pickle.loads(pickle.dumps(one))
    assert copy.to_dict() == one.to_dict()
    assert len(copy.verify()) == len(one.steps)


def test_results_are_equal_where_all_but_their_run_time_is():
    once, again = (fr.kinetic_relation(c=0.45, eta=0.03125) for _ in range(2))
    assert dataclasses.replace(once, seconds=again.seconds + 1.0) == again
    assert dataclasses.replace(once, terms=once.terms + 1) != again
    chain = fr.VdpChain(a=4, b=0.5, c=0.1, sites=5)
    run = fr.simulate(chain, fr.excite(chain, [3]), 1.0)
    assert np.isnan(run.arrivals).any()  # which are the same where both are missing
    assert pickle.loads(pickle.dumps(run)) == run
    moved = run.states.copy()
    moved[-1, 0, 0] += 1e-9
    assert dataclasses.replace(run, states=moved) != run


def test_a_notebook_shows_what_a_result_holds(results):
    point, curve, roots = (results[name] for name in ("point", "curve", "roots"))
    for branch in point.branches:
        assert f"<td>{branch.v:.15g}</td>" in point._repr_html_()
    for branch in (each for one in curve.points for each in one.branches):
        assert f"<td>{branch.v:.15g}</td>" in curve._repr_html_()
    for root in (*roots.upper, *roots.lower):
        assert f"<td>{root.re:.15g}</td><td>{root.im:.15g}</td>" in roots._repr_html_()
    many = fr.roots(0.3, 0.5, count=12)
    assert f"and {len(many.upper) - 10} more" in many._repr_html_()
    assert "more" not in roots._repr_html_()
    shown = results["breather"]._repr_html_()
    assert "<th>eps</th>" in shown
    assert f"<td>{results['breather'].chain.a:g}</td>" in shown


@pytest.mark.parametrize("name", ["point", "curve", "roots", "profile", "breather"])
def test_a_result_draws_itself(name, results):
    import matplotlib.pyplot as plt

    axes = results[name].plot()
    assert axes.get_xlabel()
    assert axes.get_ylabel()
    assert results[name].plot(axes) is axes
    plt.close("all")


def test_a_curve_asked_for_stability_shows_it_in_words_and_picture():
    import matplotlib.pyplot as plt

    curve = fr.kinetic_relation(c=[1.2, 2.0, 3.0], eta=0.03125, stability=True)
    said = [branch.stable for point in curve.points for branch in point.branches]
    assert {True, False} <= {*said}
    axes = curve.plot()
    drawn = {line.get_label(): line for line in axes.lines}
    for stable, label in ((True, "admissible, stable"), (False, "admissible, not stable")):
        shown = drawn[label].get_ydata()
        assert sorted(shown) == [
            branch.v
            for point in curve.points
            for branch in point.branches
            if branch.stable is stable
        ]
    limit = curve.points[0].c_stable
    assert limit is not None
    assert np.all(curve.columns()["c_stable"] == limit)
    assert any(line.get_xdata()[0] == limit for line in axes.lines)
    plain = fr.kinetic_relation(c=[1.2, 2.0], eta=0.03125).plot()
    assert [line.get_label() for line in plain.lines if line.get_label()[0] != "_"] == [
        "admissible"
    ]
    plt.close("all")


def test_the_slope_of_a_front_in_its_picture_is_the_velocity_in_its_title():
    import matplotlib.pyplot as plt

    chain = fr.AveragedChain(a=4, b=0.5, c=3.0, eps=0.1, sites=32)
    front = fr.measure_front(chain, max_sites=64)
    axes = front.plot()
    times, passed = (values[16:] for values in axes.lines[0].get_data())
    slope = np.polyfit(times, passed, 1)[0]
    assert abs(slope / front.v - 1) < 0.02  # counted in t it would be a tenth
    assert r"\varepsilon t" in axes.get_xlabel()
    titles = {axes.get_title(loc=place) for place in ("left", "center")}
    assert rf"$\hat v$ = {front.v:.6g}" in titles
    plt.close("all")


def test_phases_are_printed_with_their_units():
    chain = fr.AveragedChain(a=2.5, b=0.5, c=0.1, sites=5)
    found = fr.breather(chain)
    lines = dict(line.split(maxsplit=1) for line in in_words(found).splitlines())
    assert lines["phases"].endswith("in units of π")
    assert " rad, uncertain by " in lines["phase_step"]
    # The neighbour lags by a quarter of a turn, but for what the ends of five sites change.
    assert found.phases[3] == pytest.approx(-0.5, abs=1e-3)
    assert found.phase_step == pytest.approx(-np.pi / 2, abs=1e-2)
    compared = in_words(fr.breather(chain, method="all"))
    branch = in_words(fr.follow_breather(chain, [0.1], method="envelope"))
    assert "phase_step (rad)" in compared
    assert "phase_step (rad)" in branch


def test_a_threshold_of_the_averaged_chain_says_of_which_equation_it_is():
    chain = fr.VdpChain(a=2.5, b=0.5, c=0, sites=5)
    for method, equation in (("envelope", "(43)"), ("closed-form", "(29) with (37)")):
        found = fr.threshold(chain, method=method)
        assert equation in found.to_dict()["equation"]
        assert "how far (8) is from it is not in the error" in in_words(found)
    edge = fr.Nucleus(1, place="edge")
    friction = fr.FrictionChain(c=0, sites=11)
    runs = fr.threshold(friction, edge, accuracy=1e-2, tests=0, final_time=100.0)
    assert runs.to_dict()["equation"] == "that of the model friction itself"
    orbit = fr.threshold(chain.averaged(), method="orbit")  # of (8), though (43) was given
    assert orbit.to_dict()["equation"] == "that of the model vdp itself"


def test_what_has_no_picture_says_so():
    with pytest.raises(TypeError, match="KineticSum cannot be drawn"):
        fr.sigma(0.3, 0.5).plot()
    wave = fr.measure_front(fr.AveragedChain(a=4, b=0.5, c=0.6), method="wave")
    with pytest.raises(TypeError, match="a front without arrivals cannot be drawn"):
        wave.plot()  # axes with nothing in them


def test_tables_of_pandas_and_xarray_hold_the_same_numbers(results):
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    curve, profile = results["curve"], results["profile"]
    frame = curve.to_pandas()
    # Nothing at 0.4, two velocities at 0.45, one at 0.5.
    assert frame["c"].tolist() == [0.4, 0.45, 0.45, 0.5]
    velocities = [branch.v for point in curve.points for branch in point.branches]
    assert frame["v"].dropna().tolist() == velocities
    data = profile.to_xarray()
    assert data["phi"].dims == ("zeta",)
    assert np.array_equal(data["zeta"], profile.zeta)
    assert np.array_equal(profile.to_pandas()["re_phi"], profile.phi.real)
    with pytest.raises(TypeError, match="cannot be written as a table"):
        fr.sigma(0.3, 0.5).to_pandas()


def test_a_missing_extra_is_named(monkeypatch, results):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"excitation-fronts\[tables\]"):
        results["curve"].to_pandas()


def test_certified_roots_name_the_extra_that_they_need(monkeypatch, refused):
    monkeypatch.setitem(sys.modules, "flint", None)
    said = refused("roots --v 0.3 --c 0.5 --count 4 --certify")["message"]
    assert "excitation-fronts[certify]" in said


def test_a_run_and_a_front_are_results_too(tmp_path):
    import matplotlib.pyplot as plt

    pytest.importorskip("xarray")
    chain = fr.AveragedChain(a=4, b=0.5, c=0.6, sites=9)
    run = fr.simulate(chain, fr.excite(chain, [1]), 500.0, samples=5)
    data = run.to_xarray()
    assert data["states"].dims == ("t", "component", "site")
    assert np.array_equal(data["t"], run.times)
    assert len(run.to_pandas()) == 5
    front = fr.measure_front(chain)
    for result in (run, front):
        json.dumps(result.to_dict(), allow_nan=False)
        assert len(repr(result)) < 1200
        assert result.plot().get_xlabel()
        assert "<table>" in result._repr_html_()
    plt.close("all")
    out = tmp_path / "run.npz"
    line = "simulate averaged --n 9 --a 4 --b 0.5 --c 0.6 --excite 1 --t-end 500 --samples 5 -o"
    assert main([*line.split(), str(out)]) == 0
    with np.load(out) as kept:
        assert np.array_equal(kept["psi"], run.psi)
        provenance = json.loads(str(kept["provenance"]))
    assert provenance["parameters"]["sites"] == 9
    assert provenance["parameters"]["start"]["sites"] == [1]


def test_velocities_of_the_averaged_chain_come_from_the_shell_as_a_curve(answered):
    points = answered("front averaged --c 0.6:1:2 --a 4 --b 0.5")["points"]
    for point in points:
        alone = fr.measure_front(fr.AveragedChain(a=4, b=0.5, c=point["c"], sites=32))
        assert point["v"] == alone.v
        assert point["status"] == "steady"


def test_a_curve_has_what_its_points_have(results):
    for point in results["curve"].points:
        alone = fr.kinetic_relation(c=point.c, eta=point.eta)
        # The search for many at once starts from other values: equal to their errors.
        for one, other in zip(alone.branches, point.branches, strict=True):
            assert abs(one.v - other.v) <= one.error + other.error
    assert results["curve"].along == "c"
    assert fr.kinetic_relation(c=0.5, eta=[0.03, 0.04]).along == "eta"


@pytest.mark.parametrize("digits", [16, 40, 400])
def test_the_error_of_many_digits_is_neither_zero_nor_exceeded(digits):
    """Against the same sum to 20 digits more, by the same integral on another grid."""
    found, better = (
        fr.sigma("0.3", "0.5", digits=digits),
        fr.sigma("0.3", "0.5", digits=digits + 20),
    )
    told = found.to_dict()
    with mp.workdps(digits + 30):
        error = mp.mpf(str(told["error"]))
        assert 0 < error < mp.mpf(10) ** (1 - digits)
        written = mp.mpc(told["re"], told["im"])
        assert abs(written - better.value) <= error


def test_an_error_below_every_double_is_told(capsys):
    assert main(shlex.split("sum --v 0.3 --c 0.5 --digits 400")) == 0
    shown = capsys.readouterr().out
    assert "e+00" not in shown
    assert "e-400" in shown


def test_two_thousand_digits_may_be_asked_for(monkeypatch):
    """The series works in more digits than it gives; its limit is of what is asked for."""
    from theory.piecewise import precise_roots

    asked = []

    def noted(quantity, value, low, high, *remedy):
        asked.append((value, high))
        raise KeyboardInterrupt

    monkeypatch.setattr(precise_roots, "count_within", noted)
    with pytest.raises(KeyboardInterrupt):
        fr.sigma("0.3", "0.5", digits=2000, method="series")
    assert all(value <= high for value, high in asked)
    assert asked[0][0] > 2000


PUBLIC = [name for name in fr.__all__ if inspect.isfunction(getattr(fr, name))]


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_function_says_what_it_takes_gives_and_raises(name):
    doc = inspect.getdoc(getattr(fr, name)) or ""
    for section in ("Parameters", "Returns"):
        assert f"{section}\n{'-' * len(section)}\n" in doc, (name, section)
    described_ = documented(doc)
    for parameter in inspect.signature(getattr(fr, name)).parameters:
        assert described_.get(parameter), (name, parameter)


def _parsers():
    for name, command in COMMANDS.items():
        if command.module:
            continue
        calls = command.calls if "" in command.calls else models_of(command)
        for model, call in calls.items():
            yield pytest.param(BoundCall(call, model), id=f"{name} {model}".strip())


@pytest.mark.parametrize("bound", list(_parsers()))
def test_every_option_of_a_model_has_help_of_the_library(bound):
    for group in (bound.fields, bound.start, bound.nucleus, bound.own):
        for each in group.parameters:
            assert each.help, each.name


@pytest.mark.parametrize(
    ("line", "own", "others"),
    [
        ("cell friction", "--v-d", ("--eps", "--a ")),
        ("cell vdp", "--eps", ("--v-d", "--mu-st")),
        ("breather averaged", "--pattern", ("--v-d", "--start-point")),
    ],
)
def test_help_of_a_model_has_its_options_and_no_others(line, own, others, capsys):
    with pytest.raises(SystemExit) as stopped:
        main([*line.split(), "--help"])
    assert stopped.value.code == 0
    shown = capsys.readouterr().out
    assert own in shown
    for other in others:
        assert other not in shown


def test_options_have_the_defaults_of_the_library():
    call = COMMANDS["profile"].calls[""]
    parameters = {each.name: each.default for each in described(located(call.function))}
    assert parameters["points"] == inspect.signature(fr.front_profile).parameters["points"].default
    parser_defaults = vars(whole_parser().parse_args(["profile", "--c", "1"]))
    assert "points" not in parser_defaults  # absent, so that the function's own default holds


@pytest.mark.parametrize("suffix", ["csv", "json", "npz", "png", "svg", "pdf"])
def test_every_format_carries_command_parameters_and_versions(suffix, tmp_path):
    out = tmp_path / f"curve.{suffix}"
    line = "kinetic --c 0.45:0.5:2 --eta 0.03125"
    assert main([*line.split(), "-o", str(out)]) == 0
    content = out.read_bytes()
    if suffix == "npz":
        with np.load(out) as data:
            assert data["v"].size == 3
            content = str(data["provenance"]).encode()
    elif suffix == "pdf":
        # Strings of a PDF are in octal or UTF-16 where it needs to be; the command is plain.
        content = content.replace(b"\\", b"").replace(b"\x00", b"")
    for part in ("fronts kinetic --c 0.45:0.5:2 --eta 0.03125", "versions", "numpy"):
        assert part.encode() in content, part
    assert str(tmp_path).encode() not in content


def test_a_table_with_its_provenance_is_read_back(tmp_path):
    pandas = pytest.importorskip("pandas")
    out = tmp_path / "curve.csv"
    assert main(f"kinetic --c 0.45:0.5:2 --eta 0.03125 -o {out}".split()) == 0
    frame = pandas.read_csv(out, comment="#")
    assert frame["v"].tolist() == [
        branch.v
        for point in fr.kinetic_relation(c=[0.45, 0.5], eta=0.03125).points
        for branch in point.branches
    ]
    # Named columns of numpy as well, which takes the first line for the names whatever it is.
    columns = np.genfromtxt(out, delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert columns["v"].tolist() == frame["v"].tolist()


def _numbers(value: Any) -> Iterator[float]:
    """Yield the numbers of a JSON value, except run times and counts."""
    if isinstance(value, dict):
        for name, each in value.items():
            if name not in ("seconds", "provenance"):
                yield from _numbers(each)
    elif isinstance(value, list):
        for each in value:
            yield from _numbers(each)
    elif isinstance(value, float):
        yield value


def _read(path: Path) -> set[float]:
    """Return all numbers in a file: in its table, and in the result and parameters beside it."""
    held = set()
    if path.suffix == ".csv":
        lines = path.read_text(encoding="utf-8").splitlines()
        for row in csv.reader(line for line in lines if not line.startswith("#")):
            for cell in row:
                with suppress(ValueError):
                    held.add(float(cell))
        notes = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
        beside = [json.loads(notes.get(name, "{}")) for name in ("result", "parameters")]
    else:
        with np.load(path) as data:
            beside = [json.loads(str(data[name])) for name in ("result", "parameters")]
            for column in data.values():
                if column.dtype.kind == "c":
                    held |= {*np.ravel(column.real).tolist(), *np.ravel(column.imag).tolist()}
                elif column.dtype.kind in "fiu":
                    held |= {float(each) for each in np.ravel(column)}
    return held | {*_numbers(beside)}


@pytest.mark.parametrize(
    "line",
    [
        "kinetic --c 0.5 --eta 0.03125 --stability",
        "kinetic --c 0.5 --eta 0.03:0.1:3 --stability",
        "sum --v 0.3 --c 0.5",
        "roots --v 0.3 --c 0.5 --count 3",
        "profile --c 0.5 --eta 0.03125 --points 5",
        "front averaged --c 0.6 --eta 0.03125 --method wave",
        "simulate averaged --n 4 --t-end 20",
        "cell friction",
        "cell averaged --a 2.5 --b 0.4:0.5:2",
        "breather --c 0.1 --method closed-form",
        "breather averaged --c 0.1",
        "threshold vdp --method closed-form",
        "threshold vdp --method closed-form --b 0.4:0.6:2",
    ],
)
def test_a_table_and_what_is_beside_it_hold_every_number_of_the_answer(line, tmp_path):
    """The frequency of a breather and the readings of a threshold were in the JSON file only."""
    paths = [tmp_path / f"answer{ending}" for ending in (".json", ".csv", ".npz")]
    assert main([*line.split(), *(part for path in paths for part in ("--out", str(path)))]) == 0
    answer = {*_numbers(json.loads(paths[0].read_text(encoding="utf-8")))}
    for path in paths[1:]:
        assert not answer - _read(path), path.suffix


def test_several_files_at_once_and_one_twice(tmp_path, capsys):
    table, picture = tmp_path / "p.csv", tmp_path / "p.png"
    line = f"profile --c 0.5 --eta 0.03125 --out {table} --picture {picture}"
    assert main(line.split()) == 0
    assert {*tmp_path.iterdir()} == {table, picture}
    assert main(f"profile --c 0.5 --eta 0.03125 -o {table} -o {tmp_path}/./p.csv".split()) == 2
    assert "are the same file" in capsys.readouterr().err


def test_a_link_is_written_through_and_a_device_is_left_alone(tmp_path, capsys):
    target, link = tmp_path / "target.csv", tmp_path / "link.csv"
    link.symlink_to(target)
    line = "profile --c 0.5 --eta 0.03125 --points 3 --out"
    assert main([*line.split(), str(link)]) == 0
    assert link.is_symlink()
    assert target.read_text().startswith("zeta,")
    device = tmp_path / "null.csv"
    device.symlink_to("/dev/null")
    assert main([*line.split(), str(device)]) == 2
    assert "is a device" in capsys.readouterr().err
    assert Path("/dev/null").is_char_device()


@pytest.mark.skipif(sys.platform == "win32", reason="no named pipes in a folder there")
def test_a_fifo_gets_the_file(tmp_path):
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    reader = subprocess.Popen(["cat", str(pipe)], stdout=subprocess.PIPE, text=True)
    assert (
        main([*["profile", "--c", "0.5", "--eta", "0.03125", "--points", "3", "--out"], str(pipe)])
        == 0
    )
    assert reader.communicate(timeout=30)[0].startswith("zeta,")
    assert pipe.is_fifo()


def test_a_range_gives_a_curve_of_any_chain(tmp_path, answered):
    out = tmp_path / "c.csv"
    answer = answered(f"breather averaged --c 0.05:0.25:3 -o {out}")
    assert answer["along"] == "c"
    # Along the branch: through its fold and back, then where there is no breather.
    assert [point["c"] for point in answer["points"]] == [0.05, 0.15, 0.15, 0.05, 0.25]
    alone = fr.breather(fr.AveragedChain(a=2.5, b=0.5, c=0.15, sites=15))
    assert answer["points"][1]["frequency"] == pytest.approx(alone.frequency, abs=1e-12)
    assert answer["points"][4]["status"] == "none"
    assert out.read_text().splitlines()[0].startswith("c,")


def test_a_point_that_is_refused_does_not_lose_the_others(capsys):
    """Two cycles need eta < 1/8: the first two values of b have them."""
    assert main(["breather", "averaged", "--b", "0.5:1.1:3", "--c", "0.05", "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    assert [point["status"] for point in answer["points"]] == ["exists", "refused", "refused"]
    assert "1/8" in answer["points"][2]["reason"]


def test_two_ranges_are_refused(refused):
    error = refused("breather averaged --b 0.4:0.5:2 --c 0.05:0.1:2")
    assert "not for both" in error["message"]


def test_envelope_is_another_name_of_averaged(answered):
    one = answered("breather envelope --c 0.1")
    other = answered("breather vdp --model envelope --c 0.1")
    assert one["chain"]["model"] == other["chain"]["model"] == "averaged"


@pytest.mark.parametrize("shell", ["bash", "zsh", "tcsh"])
def test_completion_knows_commands_models_and_options(shell, capsys):
    pytest.importorskip("shtab")
    assert main(["--print-completion", shell]) == 0
    shown = capsys.readouterr().out
    # tcsh completes commands and models only.
    options = () if shell == "tcsh" else ("--eta", "--graph")
    for word in ("kinetic", "breather", "averaged", "derive", *options):
        assert word in shown


def test_completion_of_an_unknown_shell_is_refused(capsys):
    assert main(["--print-completion", "dos"]) == 2
    assert "choose one of" in capsys.readouterr().err


def test_bad_input_in_python_is_a_parameter_error():
    for call in (
        lambda: fr.kinetic_relation(c=0.5, eta=0.03, a=4, b=0.5),
        lambda: fr.kinetic_relation(c=0.5, a=4),
        lambda: fr.kinetic_relation(c=float("nan"), eta=0.03),
        lambda: fr.sigma(0.3, 0.5, method="guess"),
        lambda: fr.roots(0.3, 0.5, count=3, extent=9.0),
        lambda: fr.front_profile(0.5, 0.03125, branch=7),
        lambda: fr.judge("nosuchclaim"),
        lambda: fr.derivation(99),
        lambda: fr.derivation("nosuch"),
    ):
        with pytest.raises(fr.ParameterError) as refused:
            call()
        assert str(refused.value).count("\n") == 0
    with pytest.raises(fr.RunError, match="no travelling front"):
        fr.front_profile(0.2, 0.03125)


@pytest.mark.parametrize(("c", "eta", "sign"), [(0.5, 0.03125, 1.0), (2.0, 0.11, -1.0)])
def test_a_profile_is_that_of_its_velocity_with_the_error_and_the_points_of_its_integral(
    c: float, eta: float, sign: float
) -> None:
    """A retreating front is 1 - φ(-ζ) of the advancing one."""
    found = fr.front_profile(c, eta, low=-2.0, high=3.0, points=6)
    integral = front_profile(sign * found.zeta, abs(found.v), c)
    expected = integral.phi if sign > 0.0 else 1.0 - integral.phi
    assert math.copysign(1.0, found.v) == sign
    assert np.array_equal(found.phi, expected)
    assert (found.error, found.points) == (integral.error, integral.points)


def test_verdicts_cells_and_the_robustness_table_are_results() -> None:
    verdicts = fr.judge("fig16-admissible")
    assert [each.claim.key for each in verdicts] == ["fig16-admissible"]
    assert verdicts[0].claim.key == verdicts.to_dict()["claims"][0]["key"]
    assert verdicts.columns()["changed"].tolist() == [False]
    cell = fr.derive_cell("1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5})
    stated = cell.to_dict()
    assert [each["stability"] for each in stated["cycles"]] == ["unstable", "stable"]
    assert stated["ratio"]["value"] == pytest.approx(2 - math.sqrt(3), rel=1e-14)
    open_cell = fr.derive_cell("1 - a*y**2 + b*y**4 - c*y**6 + d*y**8").to_dict()
    assert (open_cell["cycles"], open_cell["ratio"]) == (None, None)
    again = pickle.loads(pickle.dumps(cell))
    assert (again, again.cycles, again.equation) == (cell, cell.cycles, cell.equation)
    derived = fr.derivation(34)
    assert derived.columns()["number"].tolist() == ["34"]
    assert derived.to_dict()["steps"][0]["from"] == [33]
    assert (derived.order, fr.derivation("multiple-scales").order) == (1, 1)
    assert len(repr(derived)) < 200
    assert "<math" in derived._repr_html_()
    assert all(evidence.holds for evidence in derived.verify())
    json.dumps(derived.to_dict(), allow_nan=False)
    table = fr.robustness(["c-pin"], points=12, workers=1)
    assert table.columns()["right"].tolist() == [table.counts["right"]]
    for each in (verdicts, cell, table):
        assert isinstance(each, fr.Result)
        assert json.loads(json.dumps(each.to_dict(), allow_nan=False))["seconds"] >= 0.0


def test_every_public_function_documents_what_it_takes_returns_and_refuses() -> None:
    for name in fr.__all__:
        function = getattr(fr, name)
        if not inspect.isfunction(function):
            continue
        said = inspect.getdoc(function) or ""
        gives = inspect.signature(function).return_annotation not in (None, "None")
        for section in ("Parameters", "Raises", *(("Returns", "Examples") if gives else ())):
            assert f"\n{section}\n{'-' * len(section)}\n" in said, (name, section)
        listed = said.split("Parameters\n----------\n")[1].split("\nReturns\n")[0]
        for each in inspect.signature(function).parameters:
            assert re.search(rf"^(\w+, )*\**{each}\b.*( :|$)", listed, re.MULTILINE), (name, each)


def test_a_notebook_shows_errors_and_run_times_with_two_digits():
    (branch,) = (found := fr.kinetic_relation(c=0.5, eta=0.03125)).branches
    shown = found._repr_html_()
    for value in (branch.error, found.c_pin_error, found.seconds):
        assert f">{value:.2g}</td>" in shown
        assert f"{value:.15g}" not in shown
