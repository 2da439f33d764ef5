"""``fronts derive``: fast to list, strict about its input, complete in JSON."""

import contextlib
import io
import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock, call

import numpy as np
import pytest
import sympy as sp

import fronts as fr
from derivations import catalogue, judgement
from derivations.algebra import rendering
from derivations.algebra.errors import DerivationInputError
from derivations.cell import steps
from fronts.answer import Answer, UsageError
from fronts.checking import DerivedCell
from fronts.cli import main
from fronts.commands import derive
from fronts.commands.derive import _verdict_lines

UNCACHED = judgement.report


def run(capsys, *words):
    code = main(["derive", *words])
    shown = capsys.readouterr()
    return code, shown.out, shown.err


@pytest.fixture(scope="module", autouse=True)
def _equations_are_judged_once():
    """Judging all of them takes seconds, and gives the same each time."""
    with pytest.MonkeyPatch.context() as patch:
        once = cache(judgement.report)
        patch.setattr(judgement, "report", lambda progress: once())
        yield


@pytest.fixture(scope="module")
def everything():
    """Give the answer of ``fronts derive all --json``."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        assert main(["derive", "all", "--json"]) == 0
    return json.loads(said.getvalue())


def test_the_listing_does_not_import_sympy():
    program = (
        "import sys\nfrom fronts.cli import main\nmain(['derive'])\n"
        "assert not {'sympy', 'numpy', 'scipy'} & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}, timeout=60,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    for name in catalogue.LISTING:
        assert name in done.stdout


def test_all_in_json_has_one_entry_for_each_number(everything):
    entries = everything["equations"]
    assert [entry["number"] for entry in entries] == list(range(1, 55))
    verdicts = {"holds", "misprint", "ambiguous", "inconsistent", "definition", "assumption"}
    assert {entry["verdict"] for entry in entries} == verdicts
    assert all(isinstance(entry["corrected"], (str, type(None))) for entry in entries)
    assert everything["seconds"] > 0


@pytest.mark.parametrize("form", ["text", "latex", "mathml", "json"])
def test_each_format(capsys, form):
    code, out, _ = run(capsys, "linearisation", "--format", form)
    assert code == 0
    assert {"text": "checked:", "latex": "\\documentclass", "mathml": "<math", "json": '"steps"'}[
        form
    ] in out


def test_one_equation_shows_its_check_and_its_verdict(capsys):
    code, out, _ = run(capsys, "--equation", "42")
    assert code == 0
    assert "(Eq. 42)" in out
    assert "In print: misprint" in out
    code, out, _ = run(capsys, "averaging", "--equation", "34", "--json")
    data = json.loads(out)
    assert data["judgement"]["verdict"] == "holds"
    assert [step["number"] for step in data["steps"]] == [34]


def test_a_number_alone_is_that_equation(capsys):
    assert run(capsys, "42") == run(capsys, "--equation", "42")
    code, _, err = run(capsys, "42", "--equation", "43")
    assert code == 2
    assert "leave out 42 or --equation 43" in err


def test_second_order(capsys):
    code, out, _ = run(capsys, "multiple-scales", "--order", "2")
    assert code == 0
    assert "'quarter turns to second order' at the sites" in out


def test_a_new_cell(capsys):
    code, out, _ = run(capsys, "cell", "--damping", "1 - a*y**2 + b*y**4", "--value", "a=4",
                       "--value", "b=0.5", "--json")  # fmt: skip
    data = json.loads(out)
    assert code == 0
    assert [cycle["stability"] for cycle in data["cycles"]] == ["unstable", "stable"]
    assert data["ratio"]["value"] == pytest.approx(0.267949192431)
    of_python = fr.derive_cell("1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5}).to_dict()
    assert {**of_python, "seconds": data["seconds"]}.items() <= data.items()
    code, out, err = run(capsys, "cell", "--damping", "y**2 - 1")
    assert (code, out) == (2, "")
    assert "exactly two cycles" in err
    assert run(capsys, "cell", "--damping", "y**2 - 1", "--no-front")[0] == 0


def test_a_cell_without_coupling_has_cycles_and_no_front(capsys):
    line = ["cell", "--damping", "1 - 4*y**2 + y**4/2", "--coupling", "0"]
    code, out, err = run(capsys, *line)
    assert (code, out) == (2, "")
    assert "coupling = 0 is not allowed: it must be other than zero for a front" in err
    assert "--no-front" in err
    code, out, _ = run(capsys, *line, "--no-front", "--json")
    assert (code, len(json.loads(out)["cycles"])) == (0, 2)


@pytest.mark.parametrize(
    "words",
    [
        ("nothing",),
        ("--equation", "55"),
        ("averaging", "--equation", "54"),
        ("averaging", "--order", "3"),
        ("friction", "--order", "2"),
        ("all", "--equation", "3"),
        ("cell", "--damping", "y**2 - 1", "--no-front", "--weights", "1, w"),
        ("cell", "--damping", "y**2 - 1", "--no-front", "--equation", "34"),
        ("cell",),
        ("cell", "--damping", "__import__('os')"),
        ("cell", "--damping", "1", "--value", "a"),
        ("cell", "--damping", "1", "--value", "a=1"),
        ("cell", "--damping", "a", "--value", "a=1", "--value", "a=2"),
        ("cell", "--damping", "a", "--value", "a=y"),
        ("cell", "--damping", "1", "--order", "3"),
        ("multiple-scales", "--coupling", "0"),
        ("averaging", "--weights", "0, 1"),
        ("cell", "--damping", "1 + y**2", "--order", "2", "--no-front"),  # no cycle to check with
        ("multiple-scales", "--damping", "sin(y)"),
        ("friction", "--damping", "1"),
        ("friction", "--out", "/nowhere/at/all.txt"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_two(capsys, words):
    code, out, err = run(capsys, *words)
    assert (code, out) == (2, "")
    assert len(err.strip().splitlines()) == 1
    assert "defect" not in err


@pytest.mark.parametrize("pair", ["a", "=1", "a="])
def test_a_value_has_a_name_and_a_number(capsys, pair):
    code, _, err = run(capsys, "cell", "--damping", "a*y**2 - 1", "--value", pair)
    assert (code, f"value = '{pair}' is not allowed: it must be a name and a number" in err) == (
        2,
        True,
    )


def test_the_verdict_on_an_equation_says_all_that_was_found():
    """What it affects, each reading, and the check on print where that does not hold."""
    read = [SimpleNamespace(meaning=f"as {n}", implies=f"so {n}") for n in "ab"]
    checks = [SimpleNamespace(holds=n == "a", statement=f"found {n}.") for n in "ab"]
    printed = SimpleNamespace(verdict=SimpleNamespace(value="ambiguous"), note="Two signs.",
                              affects="(43)", readings=read)  # fmt: skip
    on_print = SimpleNamespace(holds=False, statement="0 != 1.")
    found = SimpleNamespace(printed=printed, on_readings=checks, on_print=on_print, confirmed=True)
    expected = [
        "In print: ambiguous. Two signs.",
        "  Affected: (43)",
        "  Read as: as a: holds (so a). found a.",
        "  Read as: as b: does not hold (so b). found b.",
        "  The check on print: 0 != 1.",
    ]
    assert _verdict_lines(found).splitlines() == expected
    on_print.holds, printed.affects = True, ""
    assert _verdict_lines(found).splitlines() == [expected[0], *expected[2:4]]
    found.confirmed = False
    assert _verdict_lines(found).splitlines()[3:] == ["  The checks did NOT confirm this verdict."]


def test_out_writes_a_whole_file(capsys, tmp_path):
    target = tmp_path / "jacobian.tex"
    code, out, _ = run(capsys, "linearisation", "--format", "latex", "--out", str(target))
    assert (code, str(target) in out) == (0, True)
    assert target.read_text(encoding="utf-8").rstrip().endswith("\\end{document}")
    assert list(tmp_path.iterdir()) == [target]


def test_all_in_json_says_how_each_equation_came_about(everything):
    entries = everything["equations"]
    for entry in entries:
        assert {"verdict", "kind", "operation", "from", "check", "corrected", "note"} <= set(entry)
        assert entry["kind"] in {"model", "definition", "ansatz", "derived"}
        assert entry["operation"]
        assert bool(entry["from"]) == (entry["kind"] == "derived") or entry["number"] == 27
    by_number = {entry["number"]: entry for entry in entries}
    assert by_number[11]["from"] == [10, 9]
    assert by_number[34]["from"] == [33]


def test_another_chain_on_the_command_line(capsys):
    code, out, _ = run(capsys, "multiple-scales", "--damping", "1 - a*y**2 + b*y**6",
                       "--stiffness", "g*y**3", "--value", "a=3", "--json")  # fmt: skip
    data = json.loads(out)
    assert code == 0
    assert data["complete"]
    by_number = {step["number"]: step for step in data["steps"] if step["number"]}
    assert sorted(by_number) == list(range(8, 31))
    assert "g" in by_number[30]["expression"]
    names = {q.name for q in sp.sympify(by_number[29]["expression"]).free_symbols}
    assert "a" not in names
    code, out, _ = run(capsys, "averaging", "--weights", "1, w", "--equation", "34", "--json")
    assert code == 0
    assert "varphi(n - 2, t)" in json.loads(out)["steps"][0]["expression"]


def test_odd_powers_leave_no_damping_on_average(capsys):
    code, out, _ = run(capsys, "averaging", "--damping", "1 - y")
    assert code == 0
    assert "FAILED" not in out


def test_a_cell_to_second_order(capsys):
    code, out, _ = run(capsys, "cell", "--damping", "y**2 - 1", "--no-front", "--order", "2",
                       "--json")  # fmt: skip
    data = json.loads(out)
    assert code == 0
    (shift,) = [step for step in data["steps"] if step["name"] == "frequency of its cycles"]
    # Van der Pol: the frequency falls by eps²/16.
    assert shift["expression"] == "Equality(omega, 1 - epsilon**2/16, evaluate=False)"


def test_a_file_that_cannot_be_written_is_refused_before_anything_is_derived(
    capsys, monkeypatch, tmp_path
):
    monkeypatch.setattr(catalogue, "load", None)
    for words in (["averaging"], ["averaging", "--graph"], ["--equation", "34"]):
        code, _, err = run(capsys, *words, "--out", str(tmp_path / "none" / "x.svg"))
        assert code == 2
        assert "does not exist" in err


@pytest.mark.parametrize("ending", ["svg", "PNG", "pdf", "zarr", "gif", "mp4"])
def test_text_is_not_written_under_the_name_of_a_picture(capsys, tmp_path, ending):
    target = tmp_path / f"jacobian.{ending}"
    code, _, err = run(capsys, "linearisation", "--out", str(target))
    assert code == 2
    assert f"--out {target} would contain text: name a file ending in .txt" in err
    assert not target.exists()


def test_the_graph_is_an_svg(capsys, tmp_path):
    target = tmp_path / "equations.svg"
    code, _, _ = run(capsys, "--graph", "--out", str(target))
    assert code == 0
    root = ET.fromstring(target.read_text(encoding="utf-8"))
    assert root.tag.endswith("svg")
    data = json.loads(run(capsys, "averaging", "--graph", "--json")[1])
    assert data["sources"]["34"] == ["33"]
    assert data["kinds"]["8"] == "model"


def test_the_graph_is_of_one_derivation_or_of_all(capsys, monkeypatch):
    every = (catalogue.load("linearisation"), catalogue.load("averaging"))
    monkeypatch.setattr(catalogue, "everything", lambda: every)
    shown = [json.loads(run(capsys, *words, "--graph", "--json")[1])["kinds"]
             for words in (["linearisation"], ["averaging"], ["all"], [])]  # fmt: skip
    one, other, *both = shown
    assert one != other
    assert both == [one | other] * 2
    for words in (["cell", "--damping", "1"], ["linearisation", "--equation", "40"]):
        code, out, err = run(capsys, *words, "--graph")
        assert (code, out) == (2, "")
        assert "--graph draws all equations" in err


@pytest.mark.parametrize("failures", [(), ("the check of (3)",)])
def test_all_verdicts_are_shown_in_the_form_that_is_asked_for(failures, capsys, monkeypatch):
    from derivations import verdict_page

    made = judgement.EquationReport(judgements=(), failures=failures, seconds=1.5)
    monkeypatch.setattr(judgement, "report", lambda progress: made)
    monkeypatch.setattr(verdict_page, "page", lambda found: f"page of {found.seconds}")
    code = int(bool(failures))
    assert run(capsys, "all", "--format", "markdown")[:2] == (code, "page of 1.5\n")
    said = run(capsys, "all")
    assert said[0] == code
    assert said[1].endswith("0 equations, 1.5 s\n")
    assert ("FAILED: the check of (3)" in said[1]) == bool(code)
    for form in (["--json"], ["--format", "json"]):
        found, shown, _ = run(capsys, "all", *form)
        assert found == code
        assert json.loads(shown) == {
            "equations": [], "failures": list(failures), "seconds": 1.5,
        }  # fmt: skip


def test_every_derivation_is_typeset_in_the_form_that_is_asked_for(capsys, monkeypatch):
    """Beside --json the answer is that on the verdicts, whatever the form."""
    made = judgement.EquationReport(judgements=(), failures=(), seconds=1.5)
    monkeypatch.setattr(judgement, "report", lambda progress: made)
    named = SimpleNamespace
    every = [named(key=key, steps=[named(verify=list)] * 2) for key in ("one", "two")]
    monkeypatch.setattr(catalogue, "everything", lambda: every)
    monkeypatch.setattr(rendering, "document", lambda *made: f"document of {[e.key for e in made]}")
    monkeypatch.setattr(rendering, "mathml", lambda each: f"<{each.key}>")
    assert run(capsys, "all", "--format", "latex")[1] == "document of ['one', 'two']\n"
    assert run(capsys, "all", "--format", "mathml")[1] == "<one>\n<two>\n"
    for form in ("latex", "mathml"):
        assert json.loads(run(capsys, "all", "--format", form, "--json")[1])["seconds"] == 1.5


@pytest.mark.parametrize("form", ["text", "markdown", "latex", "mathml"])
def test_a_derivation_of_everything_reports_its_progress_to_the_end(form, monkeypatch):
    seen, names = [], []

    def shown(name, quiet=False):
        names.append(name)
        return contextlib.nullcontext(SimpleNamespace(report=seen.append))

    friction = catalogue.load("friction")
    full = partial(UNCACHED, ("friction",))
    monkeypatch.setattr(judgement, "report", lambda progress: full(progress=progress))
    monkeypatch.setattr(catalogue, "everything", lambda: (friction,))
    monkeypatch.setattr(derive, "Progress", shown)
    assert main(["derive", "all", "--format", form]) == 0
    assert len(names) == 1
    assert seen == pytest.approx(np.linspace(0.0, 1.0, len(friction.steps) + 1)[1:])


def test_a_step_that_fails_its_check_changes_the_exit_code_of_its_equation(capsys, monkeypatch):
    """Also where the verdict on print is confirmed."""
    plain = rendering.records
    for complete, code in ((True, 0), (False, 1)):
        monkeypatch.setattr(
            rendering, "records", lambda found, told=complete: plain(found) | {"complete": told}
        )
        assert run(capsys, "friction", "--equation", "3")[0] == code


def test_a_cell_that_has_no_front_is_refused_before_its_steps_are_shown(monkeypatch):
    """With the advice to ask for its averaged equation alone."""

    @dataclass
    class Averaged:
        order: int = 1
        front: bool = False

        def with_values(self, _):
            return self

        def kinetic_relation(self):
            raise DerivationInputError("coupling", 0, "other than zero", "give one")

    shown = Mock(side_effect=AssertionError)
    monkeypatch.setattr(derive, "_shown", shown)
    monkeypatch.setattr("derivations.cell.envelope.derive_envelope", lambda *_: Averaged())
    cell = SimpleNamespace(damping="1", stiffness=None, coupling="0", numbers={}, weights=None)
    said = "give one; for its averaged equation alone add --no-front"
    with pytest.raises(DerivationInputError, match=f"{said}.$"):
        derive._cell(cell, 1, None, "text", True)
    assert not shown.called


def test_the_page_of_verdicts_is_what_the_code_finds(capsys):
    written = Path(__file__).parents[1] / "docs" / "derivations.md"
    assert run(capsys, "all", "--format", "markdown")[1] == written.read_text(encoding="utf-8")


@pytest.mark.parametrize(("more", "times"), [([], 1), (["--order", "2"], 1), (["--no-front"], 0)])
def test_the_front_of_a_cell_is_derived_once(more, times, capsys, monkeypatch):
    derived, made = [], steps._front
    monkeypatch.setattr(
        steps, "_front", lambda *given, **named: derived.append(given) or made(*given, **named)
    )
    code, out, _ = run(capsys, "cell", "--damping", "1 - 4*y**2 + y**4/2", "--json", *more)
    assert code == 0
    assert len(derived) == times
    names = [step["name"] for step in json.loads(out)["steps"]]
    assert names.count("kinetic relation of the cell") == times
    assert any("second order" in name for name in names) == ("--order" in more)


def test_a_model_whose_cells_never_have_two_cycles_is_refused_for_the_front(capsys):
    code, shown, said = run(capsys, "piecewise-front", "--damping", "1 + a*y**2 - b*y**4")
    assert (code, shown) == (2, "")
    assert said.startswith("fronts: damping = a*y**2 - b*y**4 + 1 is not allowed: it must be")
    assert said.count("\n") == 1


def test_all_equations_are_listed_one_a_line(monkeypatch):
    named = SimpleNamespace
    printed = named(number=34, verdict=named(value="correct"), note="as printed")
    judged = named(printed=printed, step=named(kind=named(value="exact")), record=dict)
    found = named(judgements=[judged], failures=["(7): no."], seconds=1.0)
    monkeypatch.setattr(judgement, "report", lambda progress: found)
    answer = derive._all(None, "text", as_json=False)
    lines = answer.text.splitlines()
    assert lines[0].split() == ["(34)", "correct", "exact", "as", "printed"]
    assert lines[1:] == ["", "FAILED: (7): no.", "1 equations, 1.0 s"]
    assert answer.exit_code == 1


def test_a_model_is_made_of_its_options_by_name(monkeypatch):
    monkeypatch.setattr("derivations.cell.polynomial_input.chain_of", lambda *texts: texts)
    cell = derive._Cell(damping="h", stiffness="g", coupling="c", weights="1, w", values=["a=4"])
    assert cell.model() == ("h", "g", "c", "1, w", {"a": "4"})
    monkeypatch.setattr(derive, "_one", lambda *given: Answer({"model": given[-1]}, ""))
    assert derive.derive("averaging", weights="1, w", quiet=False).payload == {
        "model": (None, None, None, "1, w", {}),
    }  # fmt: skip
    with pytest.raises(UsageError, match="--weights and --value belong to cell, "):
        derive.derive("friction", weights="1, w", quiet=False)


@pytest.mark.parametrize("order", [0, 3])
def test_a_cell_is_derived_to_order_one_or_two(order):
    cell = derive._Cell(damping="1 - y**2", stiffness=None, coupling=None, weights=None, values=())
    with pytest.raises(UsageError, match="it must be 1 or 2"):
        derive._cell(cell, order, None, "text", front=False)


@pytest.mark.parametrize(("given", "read"), [("k", "k"), (None, "c")])
def test_the_coupling_of_a_cell_is_named_as_it_is_asked_for(given, read, monkeypatch):
    def envelope(*texts):
        raise LookupError(*texts)

    monkeypatch.setattr("derivations.cell.envelope.derive_envelope", envelope)
    cell = derive._Cell(
        damping="1 - y**2", stiffness="k*y", coupling=given, weights=None, values=()
    )
    with pytest.raises(LookupError) as begun:
        derive._cell(cell, 1, None, "text", front=False)
    assert begun.value.args == ("1 - y**2", "k*y", read)


@pytest.mark.parametrize("form", ["text", "latex", "json"])
def test_the_text_of_an_equation_or_a_cell_is_json_only_if_it_is_asked_for(form, monkeypatch):
    @dataclass(frozen=True)
    class Envelope:
        order: int = 1
        front: bool = False
        derivation: str = "cell"

        def with_values(self, _):
            return self

    single = SimpleNamespace(only=lambda equation: f"only {equation}")
    judged = SimpleNamespace(record=dict, confirmed=form == "text")
    monkeypatch.setattr(catalogue, "load", lambda *_: single)
    monkeypatch.setattr(derive, "_shown", lambda what, form: Answer({"of": what}, form))
    whole = derive._one("averaging", 1, None, form, None)
    assert (whole.payload, whole.text) == ({"of": single}, form)
    monkeypatch.setattr(judgement, "judge", lambda *_: judged)
    monkeypatch.setattr(derive, "_verdict_lines", lambda _: "verdict")
    answer = derive._one("averaging", 1, 34, form, None)
    payload = {"of": "only 34", "judgement": {}}
    assert answer.payload == payload
    assert answer.exit_code == int(form != "text")
    assert answer.text == {"text": "text\n\nverdict", "json": json.dumps(payload)}.get(form, form)
    monkeypatch.setattr("derivations.cell.envelope.derive_envelope", lambda *_: Envelope())
    monkeypatch.setattr("fronts.checking.DerivedCell", lambda **_: SimpleNamespace(to_dict=dict))
    cell = derive._Cell(damping="1 - y**2", stiffness=None, coupling=None, weights=None, values=())
    answer = derive._cell(cell, 1, None, form, front=False)
    assert answer.text == (json.dumps({"of": "cell"}) if form == "json" else form)


@pytest.mark.parametrize("form", ["text", "latex", "json"])
def test_a_derivation_is_shown_in_the_form_that_is_asked_for(form, monkeypatch):
    monkeypatch.setattr(rendering, "records", lambda _: {"complete": form == "text"})
    monkeypatch.setattr(rendering, "shown", lambda what, form: f"{what} as {form}")
    answer = derive._shown("cell", form)
    assert answer.exit_code == int(form != "text")
    if form == "json":
        assert json.loads(answer.text) == answer.payload == {"complete": False}
    else:
        assert answer.text == f"cell as {form}"


@pytest.mark.parametrize("alone", [True, False])
def test_the_front_of_a_cell_is_derived_unless_its_cycles_alone_are_asked_for(alone, monkeypatch):
    monkeypatch.setattr(derive, "_cell", lambda *given: Answer({"front": given[-1]}, ""))
    assert derive.derive("cell", no_front=alone, quiet=False).payload == {"front": not alone}
    if alone:
        with pytest.raises(UsageError, match="--no-front belongs to 'cell'"):
            derive.derive("averaging", no_front=True, quiet=False)


def test_a_number_with_a_symbol_in_it_has_no_value():
    a = sp.Symbol("a")
    cycle = SimpleNamespace(amplitude=2 / a, stability="stable", multiplicity=1)
    envelope = SimpleNamespace(
        cycles=(cycle,), ratio=sp.Rational(1, 4), equation="x", amplitude_equation="y",
        damping_mean="z",
    )  # fmt: skip
    found = DerivedCell(envelope=envelope, seconds=0.0).to_dict()
    assert [each["value"] for each in found["cycles"]] == [None]
    assert found["ratio"] == {"expression": "1/4", "value": 0.25}


def test_only_the_graph_is_written_as_a_picture(tmp_path, monkeypatch):
    monkeypatch.setattr(derive, "_graph", lambda *_: Answer({}, "<svg/>"))
    monkeypatch.setattr(derive, "_listing", lambda: Answer({}, "a list"))
    out = tmp_path / "x.svg"
    assert derive.derive(graph=True, out=out, quiet=False).text == f"wrote {out}"
    assert out.read_text("utf-8").strip() == "<svg/>"
    with pytest.raises(UsageError, match="would contain text"):
        derive.derive(out=out, quiet=False)


def test_a_file_ending_in_json_has_rows_or_the_text_of_another_form(tmp_path):
    out = tmp_path / "x.json"
    assert derive._written(Answer({}, "x = 1"), out, {}, "latex").text == f"wrote {out}"
    assert out.read_text("utf-8").strip() == "x = 1"
    with pytest.raises(UsageError, match="this answer has no rows"):
        derive._written(Answer({}, "x = 1"), out, {}, "text")


@pytest.mark.parametrize("form", ["latex", "mathml"])
def test_every_step_is_verified_before_all_derivations_are_typeset(form, monkeypatch):
    steps = [SimpleNamespace(verify=Mock()) for _ in range(3)]
    made = [SimpleNamespace(steps=steps[:2]), SimpleNamespace(steps=steps[2:])]
    monkeypatch.setattr(catalogue, "everything", lambda: made)
    monkeypatch.setattr(rendering, "document", lambda *found: f"{len(found)} in LaTeX")
    monkeypatch.setattr(rendering, "mathml", lambda _: "one in MathML")
    told = Mock()
    monkeypatch.setattr(derive, "Progress", lambda _: contextlib.nullcontext(told))
    text = {"latex": "2 in LaTeX", "mathml": "one in MathML\none in MathML"}[form]
    assert derive._all(None, form, as_json=False).text == text
    assert told.report.call_args_list == [call(1 / 3), call(2 / 3), call(1.0)]
    for each in steps:
        each.verify.assert_called_once_with()
