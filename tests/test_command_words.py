"""What the command line says: its help, its refusals, its tables, and the ends of its commands."""

from __future__ import annotations

import argparse
import csv
import functools
import importlib
import json
import logging
import math
import os
import re
import shlex
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping
from contextvars import copy_context
from dataclasses import dataclass, field, replace
from enum import Enum
from html import escape
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast
from unittest.mock import Mock

import mpmath as mp
import numpy as np
import pytest

import fronts as fr
from fronts import cli
from fronts.answer import Answer, UsageError
from fronts.bound import BoundCall
from fronts.catalogue import COMMANDS, Command
from fronts.checking import DerivedEquations
from fronts.cli import main
from fronts.curves import Curve, Refusal
from fronts.files import Listing, _beside, _json
from fronts.notebook import _cell, _word
from fronts.options import REQUIRED, _help, options_of
from fronts.piecewise.kinetic_relation import KineticCurve
from fronts.signatures import KINDS, described, documented
from fronts.wording import WIDTH, _judged, in_words, table_lines
from paper_checks.claim import Verdict
from paper_checks.claims import fig05
from paper_checks.outcome import slug
from paper_checks.shipped import FOLDER, Shipped
from theory.cells.vdp import eta_from_damping
from theory.parameters import MissingPackageError, ParameterError
from theory.piecewise.sums.result import DOUBLE
from theory.result import Result, summary
from verification.execution.imports import SOURCES
from verification.execution.metadata import COMMAND_LINE
from verification.fronts.status import FrontStatus

Capture = pytest.CaptureFixture[str]
Refused = Callable[[str], dict[str, str]]


def _shown(capsys: Capture, *words: str) -> str:
    assert main(words) == 0
    return capsys.readouterr().out


def test_without_words_the_commands_are_listed(capsys: Capture) -> None:
    assert _shown(capsys) == _shown(capsys, "--help") == _shown(capsys, "help")


def test_a_reader_that_has_seen_enough_ends_a_command_without_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As ``head`` does; what is left in the buffer is written when Python closes the output."""
    reader, writer = os.pipe()
    os.close(reader)
    with open(writer, "w") as shown:
        monkeypatch.setattr(sys, "stdout", shown)
        assert main(["--version"]) == 0


def test_a_closed_output_and_an_interruption_are_said_on_the_other_one(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    with monkeypatch.context() as closed:
        closed.setattr(sys, "stdout", None)
        assert main(["--version", "--json"]) == main(["--version"]) == 2
    as_json, plain = capsys.readouterr().err.splitlines()
    assert f"fronts: {json.loads(as_json)['error']['message']}" == plain
    assert plain.startswith("fronts: standard output is closed: ")
    monkeypatch.setattr(cli, "_run", Mock(side_effect=KeyboardInterrupt))
    assert main(["--version"]) == 130
    said = capsys.readouterr().err
    assert said == "fronts: interrupted; nothing half-written is left behind.\n"


def test_words_are_those_of_the_process_where_none_are_given(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr(sys, "argv", ["/somewhere/fronts", "--version"])
    assert main() == 0
    assert capsys.readouterr().out == f"fronts {fr.__version__}\n"


@pytest.mark.parametrize(
    ("line", "where"),
    [
        ("derive 34 --a 1", "'fronts derive'"),
        ("front averaged --c 0.6 --mu-d 1", "'fronts front averaged'"),
    ],
)
def test_an_option_that_belongs_elsewhere_is_refused_for_what_was_asked(
    line: str, where: str, refused: Refused
) -> None:
    assert refused(line)["allowed"] == f"absent for {where}"


def test_the_model_may_be_named_after_the_command_or_by_an_option(capsys: Capture) -> None:
    by_option = json.loads(
        _shown(capsys, "breather", "--model", "averaged", "--c", "0.1", "--json")
    )
    by_name = json.loads(_shown(capsys, "breather", "averaged", "--c", "0.1", "--json"))
    assert by_option["amplitudes"] == by_name["amplitudes"]


@pytest.mark.parametrize("option", [["--model", "averaged"], ["--model=averaged"]])
@pytest.mark.parametrize("before", [[], ["--c", "0.1"]])
@pytest.mark.parametrize("after", [[], ["--json"], ["--n", "9"]])
def test_only_the_option_that_names_the_model_is_taken_out(
    option: list[str], before: list[str], after: list[str]
) -> None:
    calls = cast("Any", {"vdp": None, "averaged": None})
    found = cli._renamed("vdp", [*before, *option, *after], calls, "breather")
    assert found == ("averaged", [*before, *after])


def test_a_word_that_is_no_option_is_refused_as_a_word(refused: Refused) -> None:
    assert "'more' is not expected here" in refused("sum --v 1 --c 0.5 more")["message"]


@pytest.mark.parametrize("name", ["front", "simulate", "cell", "map"])
def test_help_of_a_command_that_needs_a_model_has_no_empty_end(name: str, capsys: Capture) -> None:
    with pytest.raises(SystemExit):
        main([name, "--help"])
    shown = capsys.readouterr().out
    assert shown == shown.rstrip("\n") + "\n"


@pytest.mark.parametrize("name", ["stress", "check"])
@pytest.mark.parametrize("more", [[], ["--json"]])
def test_a_command_of_its_own_is_quiet_beside_json(
    name: str, more: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    module = importlib.import_module(f"fronts.commands.{name}")
    own, asked = getattr(module, name), []

    @functools.wraps(own)
    def called(*_: Any, **options: Any) -> Answer:
        asked.append(options["quiet"])
        return Answer({}, "")

    monkeypatch.setattr(module, name, called)
    assert main([name, *more]) == 0
    assert asked == [bool(more)]


@pytest.mark.parametrize(
    ("more", "kept"), [(["--out", "x.json"], "fronts derive 34"), ([], "another")]
)
def test_a_command_of_its_own_that_writes_a_file_is_kept_for_it(
    more: list[str], kept: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = importlib.import_module("fronts.commands.derive")
    found: list[str] = []

    @functools.wraps(module.derive)
    def called(*_: Any, **__: Any) -> Answer:
        found.append(COMMAND_LINE.get())
        return Answer({}, "")

    monkeypatch.setattr(module, "derive", called)
    context = copy_context()
    context.run(COMMAND_LINE.set, "another")
    assert context.run(main, ["derive", "34", *more]) == 0
    assert found == [kept]


def test_help_of_a_further_model_shows_its_own_examples(capsys: Capture) -> None:
    with pytest.raises(SystemExit):
        main(["breather", "averaged", "--help"])
    examples = capsys.readouterr().out.split("examples:")[1]
    assert {line.split()[2] for line in examples.splitlines() if "fronts" in line} == {"averaged"}


@pytest.mark.parametrize("command", ["front", "simulate", "cell", "map", "threshold"])
def test_help_without_a_model_shows_examples_of_the_first(capsys: Capture, command: str) -> None:
    with pytest.raises(SystemExit):
        main([command, "--help"])
    examples = capsys.readouterr().out.split("examples:")[1]
    first = next(iter(cli.COMMANDS[command].calls))
    assert f"\n  fronts {command} {first} --" in examples
    named = [f"fronts{each}" for each in cli.COMMANDS[command].examples.split("\n  fronts")[1:]]
    of_first = [each for each in named if each.split()[2] == first]
    assert [each for each in of_first if f"  {each}" in examples] == of_first
    assert "\n  fronts \n" not in f"{examples}\n"


def test_help_begins_with_the_line_of_the_command_as_a_sentence() -> None:
    parser = cli.new_parser("fronts sum", "the sum of Eq. 53", "")
    assert parser.description == "The sum of Eq. 53."


def test_help_ends_with_what_is_noted_of_the_command(capsys: Capture) -> None:
    with pytest.raises(SystemExit):
        main(["map", "friction", "--help"])
    assert "In addition to a table OUT.csv" in capsys.readouterr().out.split("examples:")[1]


def _helps(parser: Any) -> Iterator[str]:
    for action in parser._actions:
        yield action.help or ""
        if isinstance(action.choices, Mapping):
            for inner in action.choices.values():
                yield from _helps(inner)


def test_defaults_in_help_are_values_as_one_would_write_them() -> None:
    found = [re.search(r"\(default (.*?)\)", text) for text in _helps(cli.whole_parser())]
    said = {each[1] for each in found if each}
    assert {"12", "1e-12", "0.05"} <= said
    assert not {each for each in said if re.search(r"None|<|True|False|^$|\.0$", each)}


@pytest.mark.parametrize(
    ("default", "said"),
    [(2000.0, " (default 2000)"), (1e-12, " (default 1e-12)"), (12, " (default 12)"),
     (True, ""), (None, ""), ("", ""), ("wave", " (default wave)"), (REQUIRED, "")],
)  # fmt: skip
def test_the_default_of_an_option_is_said_as_one_would_write_it(default: Any, said: str) -> None:
    each = cast("Any", SimpleNamespace(help="How long.", kind="float", allowed=None))
    assert _help(each, default, ranged=False) == f"how long{said}"


@pytest.mark.parametrize(
    ("model", "said", "unsaid"),
    [
        ("vdp", ["from 1e-13", "From 4 to 1000"], ["riction", "attice", "etwork", "(44)"]),
        ("averaged", ["from 1e-13", "(43) only"], ["riction", "attice", "etwork", "(44)"]),
        ("friction", ["from 1e-6", "From 1 to 100"], ["mooth", "attice", "etwork", "(44)"]),
        ("chain", ["Smooth chain: from 4", "Lattice: the number of rows"], ["riction", "(44)"]),
        ("piecewise", ["from 1e-13"], ["riction", "mooth", "attice", "etwork"]),
    ],
)
def test_help_for_a_front_says_nothing_of_the_chains_that_the_model_is_not(
    model: str, said: list[str], unsaid: list[str], capsys: Capture
) -> None:
    with pytest.raises(SystemExit):
        main(["front", model, "--help"])
    text = " ".join(capsys.readouterr().out.split())
    # Which side a chain has, or where it starts, is a matter of one kind; its help may name it.
    words = re.sub("of a (smooth|friction) chain", "", text[text.index("the method:") :])
    for each in said:
        assert re.search(re.escape(each), words, re.IGNORECASE), each
    for each in unsaid:
        assert each not in words[: words.index("files:")], each


def test_every_kind_of_chain_with_which_a_sentence_begins_is_one_that_help_knows() -> None:
    begin = re.compile(r"(?<=\.) ((?:[A-Z]\w+|Chain \(44\))(?: \w+|, or \w+)*): ")
    options = {each.name: each.help for each in described(fr.measure_front)[1:]}  # not the chain
    found = {kind for text in options.values() for kind in begin.findall(text)}
    assert found == KINDS


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("breather vdp", "--nucleus SIZE"),
        ("breather vdp", "--c C"),
        ("cell friction", "--v-d V_D"),
        ("simulate vdp", "--excite SITES"),
        ("stress", "--out FILE"),
        ("bench", "--out DIR"),
        (
            "kinetic",
            "--c C coupling, dimensionless, from 1e-8 to 1e8; a range low:high:count gives",
        ),
    ],
)
def test_help_says_what_kind_of_value_an_option_takes(
    line: str, said: str, capsys: Capture
) -> None:
    with pytest.raises(SystemExit):
        main([*line.split(), "--help"])
    assert said in " ".join(capsys.readouterr().out.split())


def test_help_may_have_a_sign_of_percent() -> None:
    parser = cli.new_parser("fronts", "x", "")
    each = cast("Any", SimpleNamespace(help="To 3 %.", kind="float", allowed=None))
    parser.add_argument("--x", help=_help(each, 0.5, ranged=False))
    assert "to 3 % (default 0.5)" in parser.format_help()


def test_what_must_be_given_and_what_is_absent_are_no_defaults() -> None:
    found = [
        BoundCall(call, model).own.defaults()
        for command in COMMANDS.values()
        for model, call in command.calls.items()
        if model in ("", "vdp", "averaged", "friction", "piecewise")
    ]
    values = [value for defaults in found for value in defaults.values()]
    assert len(values) > 50
    assert not any(value is REQUIRED or value is None for value in values)


def test_what_of_a_map_is_not_given_has_a_range_that_ascends() -> None:
    """And of the map of Fig. 5 that of the figure."""
    calls = COMMANDS["map"].calls
    for call in calls.values():
        assert all(low < high and count > 1 for low, high, count in cast("Any", call).axes.values())
    axes = cast("Any", calls["friction"]).axes
    for name, sampled in (("c", fig05.COUPLINGS), ("v_d", fig05.VELOCITIES)):
        low, high, _ = axes[name]
        assert low < min(sampled) < max(sampled) < high
        assert low + high == pytest.approx(min(sampled) + max(sampled))


def test_text_that_is_no_number_is_refused_by_the_name_of_its_option(refused: Refused) -> None:
    assert refused("sum --v fast --c 0.5")["quantity"] == "--v"


def test_what_belongs_to_runs_is_refused_beside_a_wave(refused: Refused) -> None:
    line = "front averaged --a 4 --b 0.5 --c 0.6 --method wave --stall-time 10"
    assert refused(line)["quantity"] == "--stall-time"


def test_no_worker_is_refused_before_any_point_is_tried(
    monkeypatch: pytest.MonkeyPatch, refused: Refused
) -> None:
    from verification.quantities import robustness

    monkeypatch.setattr(robustness, "robustness", None)
    for count in ("0", "1025"):
        error = refused(f"stress --workers {count}")
        assert (error["quantity"], error["value"]) == ("workers", count)


@pytest.mark.parametrize("as_json", [False, True])
def test_an_interrupt_is_said_in_the_form_that_was_asked_for(
    as_json: bool, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def interrupted(_: Any) -> int:
        raise KeyboardInterrupt("half of it is in x.part")

    monkeypatch.setattr(cli, "_run", interrupted)
    assert main(["sum", *(["--json"] if as_json else [])]) == 130
    said, whole = capsys.readouterr().err, "interrupted; half of it is in x.part."
    assert (
        said
        == (json.dumps({"error": {"message": whole}}) if as_json else f"fronts: {whole}") + "\n"
    )


def test_an_answer_needs_no_attention_unless_it_says_so() -> None:
    assert Answer({}, "").exit_code == 0


def test_an_answer_that_is_no_number_is_a_defect_and_not_json(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def chosen(name: str, command: Any, rest: Any) -> Any:
        return cli.new_parser("fronts", "x", ""), lambda _: Answer({"v": float("nan")}, "v"), rest

    monkeypatch.setattr(cli, "_chosen", chosen)
    assert main(["sum", "--json"]) == 3
    assert capsys.readouterr().out == ""
    with pytest.raises(ValueError, match="not JSON compliant"):
        _json(Listing(payload={}, listed=()), {"v": math.nan}, {})


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (FileNotFoundError(2, "No such file", "a.toml"), 2, "the file a.toml cannot be used: "),
        (OSError(28, "No space left"), 2, "the file cannot be used: "),
        (RuntimeError("lost"), 3, "a defect of this toolkit: RuntimeError: lost (set "),
    ],
)
def test_an_error_is_said_in_the_form_that_was_asked_for(
    error: Exception,
    code: int,
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    def failed(_: Any) -> int:
        raise error

    monkeypatch.setattr(cli, "_run", failed)
    monkeypatch.delenv("FRONTS_TRACEBACK", raising=False)
    assert main(["sum"]) == main(["sum", "--json"]) == code
    plain, as_json = capsys.readouterr().err.splitlines()
    assert plain.startswith(f"fronts: {said}")
    assert plain == f"fronts: {json.loads(as_json)['error']['message']}"


@pytest.mark.parametrize(
    ("default", "words", "found"),
    [
        ("vdp", "", "vdp"), ("vdp", "--c 1", "vdp --c 1"), ("vdp", "--help", "vdp --help"),
        ("vdp", "averaged --c 1", "averaged --c 1"), ("vdp", "envelope", "averaged"),
        ("vdp", "--model envelope --c 1", "averaged --c 1"), ("", "vdp --c 1", "vdp --c 1"),
        ("vdp", "x", "'x' is not a model"), ("", "--c 1", "'--c' is not a model"),
        ("", "", "a model is missing"),
    ],
)  # fmt: skip
def test_the_model_is_the_first_word_or_else_the_default(
    default: str, words: str, found: str
) -> None:
    calls: Any = dict.fromkeys(("vdp", "averaged"))
    command = Command(line="x", calls=calls, default=default)
    if "model " in found or found.endswith("model"):
        with pytest.raises(UsageError, match=f"^{found}: choose one of vdp, averaged; see"):
            cli._model("x", command, calls, words.split())
        return
    model, *rest = found.split()
    assert cli._model("x", command, calls, words.split()) == (model, rest)
    alone: Any = {"": None}
    assert cli._model("x", command, alone, words.split()) == ("", words.split())
    only: Any = {"vdp": None}
    assert cli._renamed("vdp", ["--model", "x"], only, "x") == ("vdp", ["--model", "x"])


def test_the_examples_of_a_command_are_those_of_its_model_or_what_it_requires() -> None:
    calls: Any = dict.fromkeys(("vdp", "friction"))
    command = Command(line="x", calls=calls, default="vdp", notes="Note.",
                      examples="examples:\n  fronts x vdp --c 1\n  fronts x own.py")  # fmt: skip
    assert cli._examples(command, "vdp", "x vdp") == (
        f"{command.examples}\n\nNote.\n\nThe model is vdp unless another one is named:\n"
        "  fronts x friction --help"
    )
    assert cli._examples(command, "friction", "x friction --c C") == (
        "examples:\n  fronts x friction --c C\n\nNote."
    )
    without: Any = {"": None}
    alone = replace(command, calls=without, default="")
    assert cli._examples(alone, "", "x").endswith("\n\nNote.")


def test_what_is_said_of_a_status_is_its_sentence_or_else_the_reason() -> None:
    @dataclass(frozen=True, kw_only=True)
    class Told(Result):
        status: Any
        reason: str | None = None

    steady = Told(status=FrontStatus.STEADY, reason="a reason")
    assert in_words(steady).splitlines()[0] == f"steady: {FrontStatus.STEADY.sentence}"
    assert in_words(Told(status="none", reason="a reason")) == "none: a reason"


def test_a_script_of_completion_is_printed_and_no_failure(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    monkeypatch.setattr(cli, "_completion", " ".join)
    assert main(["--print-completion", "a", "shell"]) == 0
    assert capsys.readouterr().out == "a shell\n"


def test_a_flag_that_is_on_can_be_taken_back() -> None:
    def made_up(*, on: bool = True, off: bool = False) -> None:
        """Do nothing.

        Parameters
        ----------
        on, off : bool
            Whether.
        """

    parser = cli.new_parser("x", "x", "")
    options_of(made_up).declare(parser)
    assert vars(parser.read(["--no-on", "--off"])) == {"json": False, "on": False, "off": True}


def test_of_an_option_that_has_no_meaning_the_next_word_is_the_value(refused: Refused) -> None:
    assert refused("kinetic --c 1 --n 3 4")["value"] == "3"


def test_what_argparse_says_of_no_single_option_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """As later versions of Python say that an option is missing."""
    parser = cli.new_parser("fronts x", "x", "")
    error = argparse.ArgumentError(None, "two at once")
    monkeypatch.setattr(parser, "parse_known_args", Mock(side_effect=error))
    with pytest.raises(UsageError, match="two at once; see"):
        parser.read([])


@pytest.mark.parametrize(
    "begin", [cli._announce_compilation, lambda: main(["sum", "--v", "1", "--c", "0.5"])]
)
def test_a_terminal_is_told_that_the_first_run_compiles(
    begin: Callable[[], object], monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    logger = logging.getLogger("verification.execution.compiled")
    monkeypatch.setattr(logger, "handlers", [])
    level = logger.level
    begin()
    with monkeypatch.context() as without:
        without.setattr(sys, "stderr", None)
        begin()
    assert not logger.handlers
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    try:
        for _ in range(2):  # once is enough
            begin()
        capsys.readouterr()
        logger.info("compiling")
    finally:
        logger.setLevel(level)
    assert capsys.readouterr().err == "fronts: compiling\n"


# ------------------------------------------------------------------------------------------ words


@dataclass(frozen=True, kw_only=True)
class _Value(Result):
    v: float | None
    error: float
    known: bool = True
    why: str | None = None
    lifetime: float = math.inf


@dataclass(frozen=True, kw_only=True)
class _Several(Result):
    one: _Value
    ways: Mapping[str, _Value]
    rows: tuple[_Value, ...]
    growth: float
    growth_error: float
    listed: tuple[float | None, ...]
    listed_error: tuple[float, ...]
    turns: np.ndarray
    turns_error: np.ndarray


@pytest.mark.parametrize(
    ("error", "of_a_value", "of_none", "beside"),
    [
        (1e-3, "0.500 1.0e-03", "- 1.0e-03", "0.500, uncertain by 1.0e-03"),
        (math.inf, "0.5 inf", "- -", "0.5 (error unknown)"),
    ],
)
def test_an_error_that_is_not_known_is_said_wherever_its_number_stands(
    error: float, of_a_value: str, of_none: str, beside: str
) -> None:
    """In a result within another one, in a table by name or in order, by itself, and in a list.

    What is infinite and no error is left out.
    """
    value, none = _Value(v=0.5, error=error), _Value(v=None, error=error)
    several = _Several(one=value, ways={"a": value, "b": none}, rows=(value, none), growth=0.5,
                       growth_error=error, listed=(0.5, None), listed_error=(error, math.nan),
                       turns=np.array([0.5j]), turns_error=np.array([error]))  # fmt: skip
    assert [" ".join(line.split()) for line in in_words(several).splitlines()] == [
        f"one v 0.5, error {error:.1e}, known yes",
        *("ways:", "name v error known", f"a {of_a_value} yes", f"b {of_none} yes"),
        *("rows:", "v error known", f"{of_a_value} yes", f"{of_none} yes"),
        f"growth {beside}",
        "listed [0.5, -]",
        f"listed_error [{error:.1e}, -]",
        "turns re [0], im [0.5]",
        f"turns_error [{error:.1e}]",
    ]
    for name in ("one", "ways", "rows"):  # entries may say what they like of what is within
        assert in_words(several, {name: "no"}) == f"{name}  no"
    assert in_words(several, {"ways": {"a": "no"}}) == "ways  a no"
    assert in_words(several, {"rows": ["no"]}) == "rows  [no]"


@dataclass(frozen=True, kw_only=True)
class _OneError(Result):
    v: float
    c_crit: float | None
    error: float | None


@pytest.mark.parametrize("error", [math.inf, None, math.nan])
def test_an_error_of_two_numbers_is_said_of_the_one_that_is_known_if_it_is_infinite(
    error: float | None,
) -> None:
    words = in_words(_OneError(v=0.5, c_crit=None, error=error)).split()
    assert words == ["v", "0.5", *(["(error", "unknown)"] if error == math.inf else [])]


def test_a_negative_number_of_a_table_has_the_digits_of_its_opposite() -> None:
    """Of a number that its rows are not about at most eight, as many as its error allows."""
    for number in (123.4567890123, 0.001234567890123):
        rows = [{"c": 1.0, "re_part": s * number, "re_part_error": 1e-15} for s in (1.0, -1.0)]
        _, plus, minus = table_lines(rows, units=None)
        shown = plus.split()[1]
        assert minus.split()[1] == f"-{shown}"
        assert abs(float(shown) - number) <= 0.5e-7 * number
        assert len(shown.replace(".", "").lstrip("0")) == 8


def test_a_stability_that_was_asked_for_and_not_decided_is_said_to_be_so() -> None:
    single = in_words(fr.kinetic_relation(c=1e4, eta=0.03))
    assert single.count("not decided") == 1
    curve = in_words(fr.kinetic_relation(c=[1e4, 0.5], eta=0.03, stability=True))
    assert curve.count("not decided") == 1
    assert "not decided" not in in_words(fr.kinetic_relation(c=[1e4, 0.5], eta=0.03))
    # Of two fronts one is not admissible, so that its stability is no question.
    assert "not decided" not in in_words(fr.kinetic_relation(c=0.45, eta=0.03125))


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ({"admissible": True, "stable": None}, "not decided"),
        ({"admissible": True, "stable": True}, True),
        ({"admissible": True, "stable": False}, False),
        ({"admissible": False, "stable": None}, None),
        ({"admissible": None, "stable": None}, None),
        ({"admissible": True}, "of no row"),  # as it was not asked for
        ({"stable": None}, None),
    ],
)
def test_a_row_says_that_the_stability_of_an_admissible_front_was_not_decided(
    row: dict[str, Any], said: object
) -> None:
    found = _judged({"c": 0.5, **row})
    assert found.pop("stable", "of no row") == said
    assert found == {"c": 0.5, **{name: row[name] for name in row if name != "stable"}}


def test_flags_of_a_curve_stay_flags_and_numbers_are_numbers() -> None:
    single = fr.kinetic_relation(c=[0.5], eta=0.03125)
    assert isinstance(single, KineticCurve)
    assert single.is_curve  # one table of all its points
    assert single.columns()["v"].tolist() == [each.v for each in single.points[0].branches]
    points = (_Value(v=0.5, error=0.0), _Value(v=None, error=0.0, known=False))
    table = Curve(along="c", values=np.array([1.0, 2.0]), points=points, seconds=0.0).columns()
    assert table["known"].tolist() == [True, False]
    assert table["known"].dtype == object
    assert table["v"].dtype == float
    assert np.isnan(table["v"][1])


def test_a_status_is_followed_by_its_sentence_and_by_its_reason_where_it_has_none() -> None:
    point = fr.kinetic_relation(c=0.5, eta=0.03125)
    sentence = getattr(point.status, "sentence", "")
    first = in_words(point).splitlines()[0]
    assert first == f"{point.status.value}: {sentence or point.reason}"


def test_a_status_without_sentence_or_reason_stands_alone() -> None:
    plain = Curve(along="c", values=np.array([]), points=(), seconds=0.0)
    assert in_words(plain, {"status": "done", "v": 0.5}).splitlines()[0] == "done"
    assert in_words(plain, {"status": "done", "reason": "so", "v": 0.5}).splitlines()[0] == (
        "done: so"
    )


def test_an_error_stands_beside_its_number_and_how_it_was_found_at_the_end() -> None:
    plain = cast("Any", SimpleNamespace(is_curve=False, units={"third": "of a site"}))
    found = {"seconds": 0.5, "method": "wave", "v": 0.25, "v_error": 1e-3, "held": [*range(8)],
             "third": 1 / 3, "same": 1 / 3, "same_error": 1e-20}  # fmt: skip
    assert in_words(plain, found).splitlines() == [
        "v        0.250, uncertain by 1.0e-03",
        "held     [0, 1, 2, 3, 4, 5, 6, 7]",
        "third    0.3333333333 of a site",
        "same     0.333333333333333, uncertain by 1.0e-20",
        "seconds  0.5",
        "method   wave",
    ]
    nine = f"x  [{', '.join(['0.3333333'] * 8)}, … (9 values)]"
    assert in_words(plain, {"x": [1 / 3] * 9}) == nine
    alone = {"x": [0.5], "x_error": [0.1, 0.2], "y_error": [0.1]}  # not an error of each number
    assert in_words(plain, alone).splitlines() == [
        "x        [0.5]",
        "x_error  [1.0e-01, 2.0e-01]",
        "y_error  [1.0e-01]",
    ]
    mixed = {"of": {"a": {"v": 0.5}, "b": 0.25}, "in": [{"v": 0.5}, 0.25]}
    assert in_words(plain, mixed).splitlines() == ["of  a v 0.5, b 0.25", "in  [v 0.5, 0.25]"]
    ways = {"a": {"way": "a", "v": 0.5}, "b": {"way": "b", "v": 0.25}}  # named by themselves
    assert in_words(plain, {"ways": ways}).split() == ["ways:", "way", "v", "a", "0.5", "b", "0.25"]


def test_lists_and_mappings_have_no_column_and_numbers_beside_them_do() -> None:
    rows = [{"c": 0.1, "held": [1, 2], "of": {"a": 1}}, {"c": 0.2, "held": None, "of": {}}]
    head, *lines = table_lines(rows, units=None)
    assert head.split() == ["c"]
    assert Listing(payload={}, listed=()).columns() == {}
    written = Listing(payload={}, listed=[{"name": "x", **row} for row in rows]).columns()
    assert {name: column.tolist() for name, column in written.items()} == {
        "name": ["x", "x"], "c": [0.1, 0.2], "held": ["[1, 2]", None], "of": ['{"a": 1}', "{}"],
    }  # fmt: skip
    assert [line.split() for line in lines] == [["0.1"], ["0.2"]]


def test_a_table_that_is_too_wide_goes_on_below_with_its_first_column() -> None:
    names = ["c", *(f"a_long_name_of_a_number_{n}" for n in range(12))]
    lines = list(table_lines([dict.fromkeys(names, 0.5), dict.fromkeys(names, 0.25)], units=None))
    heads = [line.split() for line in lines[::3]]
    assert len(heads) > 1
    assert all(head[0] == "c" and len(head) > 1 for head in heads)
    assert [name for head in heads for name in head[1:]] == names[1:]
    assert all(len(line) <= WIDTH for line in lines)
    assert [line.split()[0] for line in lines] == ["c", "0.5", "0.25"] * len(heads)
    for lengths, tables in (((32, 32, 30), 1), ((32, 32, 31), 2), ((60, 60), 1)):
        row = {name * length: 0.5 for name, length in zip("cde", lengths, strict=False)}
        assert len([*table_lines([row], units=None)]) == 2 * tables  # of up to 100 characters


def test_in_a_notebook_words_are_those_of_the_member_and_what_is_missing_is_empty() -> None:
    class Fine(Enum):
        YES = "yes"

        @property
        def sentence(self) -> str:
            return "it is < 1"

    assert _cell("status", Fine.YES) == "yes: it is &lt; 1"
    bare = Enum("bare", {"NO": "no"}).NO
    said = SimpleNamespace(sentence="of something that is no status")
    for value in (bare, said, 0.5):
        assert _cell("v", value) == escape(summary(value))
    assert [_word("v", value) for value in (None, math.nan, 0.5, "x")] == ["", "", "0.5", "x"]
    assert [_word(name, 1 / 3) for name in ("v_error", "seconds")] == ["0.33", "0.33"]
    assert _word("v", 1 / 3) == summary(1 / 3)


# -------------------------------------------------------------------------------- single commands


def test_a_file_of_arrays_is_refused_before_any_work_where_its_package_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fronts.files import check_files

    monkeypatch.setitem(sys.modules, "zarr", None)
    check_files([(tmp_path / "x.csv", "--out")], filmed=False)
    with pytest.raises(MissingPackageError, match="zarr"):
        check_files([(tmp_path / "x.zarr", "--out")], filmed=False)


@pytest.mark.parametrize("number", [0, 55])
def test_the_paper_has_fifty_four_equations(number: int) -> None:
    with pytest.raises(ParameterError, match="a whole number from 1 to 54"):
        fr.derivation(number)


def test_a_seed_that_no_generator_takes_is_refused_before_any_point(
    monkeypatch: pytest.MonkeyPatch, refused: Refused
) -> None:
    def tried(*_: Any, **__: Any) -> Any:
        raise AssertionError("tried")

    monkeypatch.setattr("verification.quantities.robustness.sweep", tried)
    assert refused("stress --seed -1")["quantity"] == "seed"


@pytest.mark.parametrize("found", [["hidden_example.py"], ["hidden_example/__init__.py"]])
def test_a_file_that_hides_a_package_is_named(
    found: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (path,) = (tmp_path / each for each in found)
    path.parent.mkdir(exist_ok=True)
    path.write_text("", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    taken = tmp_path / found[0].split("/")[0]
    assert fr._place("hidden_example") == taken.resolve()
    assert fr._place("there_is_no_such_package") is None
    with monkeypatch.context() as nowhere:
        nowhere.setattr(fr, "_place", lambda _: None)
        fr._refuse_hidden()  # what is nowhere hides nothing
    monkeypatch.setattr(fr, "_PACKAGES", ("hidden_example",))
    with pytest.raises(ImportError, match=re.escape(f"{taken.resolve()} hides the package")):
        fr._refuse_hidden()


def test_the_checks_of_a_verdict_that_they_do_not_bear_out_say_so(
    monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from derivations import judgement

    plain = judgement.judge

    def doubted(*given: Any) -> Any:
        found = plain(*given)
        return replace(found, on_print=replace(found.on_print, holds=not found.on_print.holds))

    assert main(["derive", "34"]) == 0
    assert "NOT confirm" not in capsys.readouterr().out
    monkeypatch.setattr(judgement, "judge", doubted)
    assert main(["derive", "34"]) == 1
    assert "The checks did NOT confirm this verdict." in capsys.readouterr().out


def test_a_derivation_is_that_of_its_name_and_order(monkeypatch: pytest.MonkeyPatch) -> None:
    from derivations import catalogue

    load = Mock(return_value=SimpleNamespace(title="x"))
    monkeypatch.setattr(catalogue, "load", load)
    for order in (1, 2):
        fr.derivation("averaging", order=order)
        load.assert_called_with("averaging", order)
    for order in (0, 3):
        with pytest.raises(ParameterError, match=f"order = {order}"):
            fr.derivation("averaging", order=order)


def test_a_cell_as_json_is_the_same_by_either_option(capsys: Capture) -> None:
    line = ["derive", "cell", "--damping", "1 - a*y**2 + b*y**4", "--no-front"]
    by_format = json.loads(_shown(capsys, *line, "--format", "json"))
    by_option = json.loads(_shown(capsys, *line, "--json"))
    assert {**by_format, "seconds": 0.0} == {**by_option, "seconds": 0.0}
    assert len(by_format["cycles"]) == 2


def test_a_table_of_verdicts_that_cannot_be_written_is_refused_before_any_is_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: Refused
) -> None:
    from fronts.commands import check

    def judged(*_: Any, **__: Any) -> Any:
        raise AssertionError("judged")

    monkeypatch.setattr(check, "_judged", judged)
    assert "x.csv" in refused(f"check --out {tmp_path}/none/x.csv")["message"]


def test_the_folder_of_a_report_is_made_with_those_above_it(tmp_path: Path) -> None:
    from fronts.commands.check import _checked_folder

    folder = tmp_path / "reports" / "one"
    for _ in range(2):  # which may exist
        assert _checked_folder(folder, resume=False) == folder
        assert folder.is_dir()


@pytest.mark.parametrize("changed", [True, False])
def test_verdicts_are_written_as_a_table_or_a_report_and_the_code_says_whether_one_has_changed(
    changed: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from fronts.commands import check

    asked: list[Any] = []
    monkeypatch.setattr(check, "_judged", lambda *_, **by: asked.append(by) or report)
    monkeypatch.setattr(check, "to_json", lambda _: {"claims": [{"key": "fig01-x"}]})
    monkeypatch.setattr(check, "report_as_text", lambda *_: "one claim")
    monkeypatch.setattr(check, "_write", lambda *given: written.append(given) or 0)
    written: list[Any] = []
    report, path, folder = SimpleNamespace(changed=changed), tmp_path / "x.json", tmp_path / "one"
    line = ["check", "fig16-admissible", "--out"]
    assert main([*line, str(path), "--workers", "2"]) == int(changed)
    assert json.loads(path.read_text("utf-8"))["claims"] == [{"key": "fig01-x"}]
    assert capsys.readouterr().out == f"one claim\nwritten to {path}\n"
    assert main([*line, str(folder), "--workers", "1"]) == int(changed)
    said = f"one claim\nThe report is in {folder / 'index.html'}.\n"
    assert capsys.readouterr().out == said
    assert written == [(folder, report, {"claims": [{"key": "fig01-x"}]})]
    assert [(by["jobs"], by["folder"]) for by in asked] == [(2, None), (1, folder)]
    assert main([*line[:2], "--full"]) == int(changed)
    assert [by["shipped"] is None for by in asked] == [False, False, True]


def test_evidence_of_other_code_is_replaced_when_a_run_is_continued(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fronts.commands import check

    kept: list[int] = []

    def judged(*_: Any, store: Any, **__: Any) -> Any:
        kept.append(len(store.results))
        store.add("fig01-x", [0.5])
        raise KeyboardInterrupt

    monkeypatch.setattr(check, "judge_all", judged)
    monkeypatch.setattr(check, "installed_versions", lambda _: {})
    for code in ("one", "one", "other"):
        monkeypatch.setattr(check, "digest_of_packages", lambda _, code=code: code)
        with pytest.raises(KeyboardInterrupt, match="0 of 0 claims are judged"):
            check._judged(
                (), every=(), jobs=1, folder=tmp_path, resume=bool(kept), shipped=None, quiet=True
            )
    assert kept == [0, 1, 0]


def test_files_of_a_film_are_allowed_where_there_is_one(tmp_path: Path) -> None:
    from fronts.files import check_files

    asked = [(tmp_path / "run.gif", "--out")]
    check_files(asked, filmed=True)
    with pytest.raises(UsageError, match="must end in"):
        check_files(asked, filmed=False)


def test_a_film_is_of_the_run_and_says_its_command_and_of_no_other_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fronts import animation
    from fronts.files import write_result

    chain = fr.AveragedChain(a=4, b=0.5, c=0.3, sites=5)
    run = fr.simulate(chain, fr.excite(chain, [3]), t_end=1.0, samples=2, estimate_error=False)
    filmed: list[Any] = []

    def animate(found: Any, path: Path, *, note: str, progress: Any) -> None:
        path.touch()
        filmed.append((found, json.loads(note)["parameters"]))

    monkeypatch.setattr(animation, "animate", animate)
    write_result(tmp_path / "run.gif", run, {"c": 0.3})
    assert filmed == [(run, {"c": 0.3})]
    with pytest.raises(UsageError, match="Cell cannot be written as a film"):
        write_result(tmp_path / "cell.gif", fr.cell(chain), {})


def test_a_column_of_words_goes_into_a_file_of_numpy_without_pickle(tmp_path: Path) -> None:
    from fronts.files import write_result

    points = (_Value(v=0.5, error=0.0), _Value(v=None, error=0.0, known=False, why="late"))
    found = Curve(along="c", values=np.array([1.0, 2.0]), points=points, seconds=0.0)
    write_result(tmp_path / "x.npz", found, {})
    with np.load(tmp_path / "x.npz") as arrays:  # which unpickles nothing
        assert arrays["known"].tolist() == [True, False]
        assert arrays["why"].tolist() == ["", "late"]
        assert arrays["c"].tolist() == [1.0, 2.0]
        assert arrays["v"].tolist()[0] == 0.5
        assert arrays["v"].dtype == float


@pytest.mark.parametrize(
    "line",
    [
        "cell vdp --a 2.5 --b 0.5:0.9:2",
        "cell friction --v-d 1:1.5:3",
        "threshold averaged --b 0.4:0.5:2",
        "breather --c 0.05:0.1:2 --method envelope",
        "front averaged --a 4 --b 0.5 --method wave --c 0.3:0.6:2",
        "kinetic --c 0.3:0.6:2 --eta 0.03125",
    ],
)
def test_a_curve_loses_nothing_in_a_file_of_numpy_or_as_a_dataset(
    line: str, tmp_path: Path, capsys: Capture
) -> None:
    """The columns are those of the table, and of a cell its cycles are among them.

    Truth values are numbers in a column in which one is missing.
    """
    import csv

    truth = {"True": "1", "False": "0"}

    table, arrays = tmp_path / "x.csv", tmp_path / "x.npz"
    assert main([*line.split(), "-o", str(table), "-o", str(arrays)]) == 0
    with table.open() as lines:
        rows = [*csv.DictReader(each for each in lines if not each.startswith("#"))]
    with np.load(arrays) as held:
        assert set(rows[0]) == {*held.files} - {"result", "parameters", "provenance"}
        for name in rows[0]:
            assert held[name].shape == (len(rows),)
            for cell, value in zip((row[name] for row in rows), held[name].tolist(), strict=True):
                number = truth.get(cell, cell) or "nan"
                same = isinstance(value, float) and float(number) == value
                assert same or str(value) in (cell, "nan"), name
    if line.startswith("cell"):
        first = rows[0]
        low, high = (next(float(first[name]) for name in first if name.endswith(end)
                          and "unstable" not in name) for end in ("_min", "_max"))  # fmt: skip
        assert low < 0.0 < high
    capsys.readouterr()


def test_a_map_of_as_many_points_as_are_allowed_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    from fronts import maps

    monkeypatch.setattr(maps, "MAX_POINTS", 4)
    monkeypatch.setattr(maps, "state_map", lambda task, *, c, **_: (task.amplitudes, c))
    chain = fr.AveragedChain(a=4, b=0.5, c=0.1)
    axes = {"c": [0.1, 0.2], "eta": [0.03, 0.04]}
    assert maps.mapped(chain, axes) == (False, [0.1, 0.2])
    assert maps.mapped(chain, axes, amplitudes=True) == (True, [0.1, 0.2])
    with pytest.raises(ParameterError, match=r"points of the map = 6 .* at most 4"):
        maps.mapped(chain, {"c": [0.1, 0.2, 0.3], "eta": [0.03, 0.04]})


@pytest.mark.parametrize(
    "line", ["threshold averaged", "cell vdp --a 2.5 --b 0.5", "sum --v 0.3 --c 0.5"]
)
def test_a_picture_that_there_is_not_is_refused_before_any_work(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: Refused
) -> None:
    from fronts.bound import BoundCall
    from fronts.catalogue import COMMANDS

    name, *rest = line.split()
    calls = COMMANDS[name].calls
    function = BoundCall(calls[rest[0] if rest[0] in calls else ""], "").function

    @functools.wraps(function)
    def worked(*_: Any, **__: Any) -> Any:
        raise AssertionError("worked")

    monkeypatch.setattr(sys.modules[function.__module__], function.__name__, worked)
    assert "cannot be drawn" in refused(f"{line} -o {tmp_path}/x.png")["message"]


def test_a_single_cell_has_its_cycles_in_every_table(tmp_path: Path, capsys: Capture) -> None:
    import csv

    line = "cell vdp --a 2.5 --b 0.5 --json"
    files = [tmp_path / f"x{ending}" for ending in (".csv", ".npz", ".zarr")]
    assert main([*line.split(), *(word for each in files for word in ("-o", str(each)))]) == 0
    answer = json.loads(capsys.readouterr().out)
    with files[0].open() as lines:
        (row,) = csv.DictReader(each for each in lines if not each.startswith("#"))
    assert float(row["stable_cycle_max"]) == answer["stable_cycle"]["max"]
    with np.load(files[1]) as held:
        assert held["unstable_cycle_min"].tolist() == [answer["unstable_cycle"]["min"]]
    xarray = pytest.importorskip("xarray")
    stored = xarray.open_zarr(files[2])
    assert stored["stable_cycle_period"].values.tolist() == [answer["stable_cycle"]["period"]]


def test_what_is_none_wherever_a_curve_has_an_answer_keeps_its_column() -> None:
    """Beside a refusal, which has no such entry; a part that is None somewhere is no column."""

    @dataclass(frozen=True, kw_only=True)
    class Part(Result):
        size: float

    @dataclass(frozen=True, kw_only=True)
    class Sought(Result):
        v: float | None = None
        part: Part | None = None

    points = (Sought(), Refusal(reason="too stiff"), Sought(part=Part(size=2.0)))
    found = Curve(along="c", values=np.arange(3.0), points=points, seconds=0.0).columns()
    assert list(found) == ["c", "v", "status", "reason", "part_size"]
    assert np.isnan(found["v"]).all()


def test_a_curve_of_several_methods_has_a_row_for_each_with_its_amplitudes(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """As the methods alone at these couplings; digits of which no error is known are not said."""
    paths = [tmp_path / "all.json", tmp_path / "all.csv", tmp_path / "all.png"]
    line = shlex.split("breather --nucleus 3 --c 0.1:0.2:2 --eps 0.12 --method all --n 5")
    assert main([*line, *(word for path in paths for word in ("--out", str(path)))]) == 0
    with paths[1].open(encoding="utf-8", newline="") as file:
        lines = [each for each in file if not each.startswith("#")]
    rows = list(csv.DictReader(lines))
    points = json.loads(paths[0].read_text(encoding="utf-8"))["points"]
    alone = [(point["c"], each) for point in points for each in point["methods"].values()]
    assert [(float(row["c"]), row["method"], row["status"]) for row in rows] == [
        (c, each["method"], each["status"]) for c, each in alone
    ]
    for row, (_, each) in zip(rows, alone, strict=True):
        sites = [float(row[name]) for name in ("centre", "neighbour")]
        expected = each["amplitudes"][:2] or [math.nan, math.nan]
        np.testing.assert_array_equal(sites, expected)
    unknown = next(each["amplitudes"][0] for _, each in alone if each["status"] == "unsettled")
    text = capsys.readouterr().out
    assert f"{unknown:.10g}" in text
    assert f"{unknown:.11g}" not in text


def test_of_a_curve_of_cells_the_rows_have_the_cycles() -> None:
    cells = [fr.cell(fr.VdpChain(a=2.5, b=float(b), c=0)) for b in (0.5, 0.9)]
    found = Curve(along="b", values=np.array([0.5, 0.9]), points=tuple(cells), seconds=0.0)
    table = found.columns()
    assert table["stable_cycle_max"][0] == cells[0].stable_cycle.max
    assert np.isnan(table["stable_cycle_max"][1])  # η = 0.144: there is none
    assert "stable_cycle" not in table
    assert found.to_xarray()["unstable_cycle_min"].shape == (2,)


def test_a_step_without_a_number_has_an_empty_one_in_a_table(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    row = dict.fromkeys(("name", "kind", "operation", "expression", "latex"), "x")
    steps = [{**row, "holds": True, "number": number} for number in (34, None)]
    monkeypatch.setattr("derivations.algebra.rendering.records", lambda _: {"steps": steps})
    derived = DerivedEquations(of="cell", order=1, title="", derivation=cast(Any, None))
    assert derived.columns()["number"].tolist() == ["34", ""]


def test_expensive_claims_are_judged_by_stored_findings_unless_all_is_asked_for() -> None:
    import inspect

    from fronts.commands.explore import explore
    from fronts.commands.stress import stress

    flags = {
        name: each.default
        for function in (fr.judge, stress, explore)
        for name, each in inspect.signature(function).parameters.items()
        if isinstance(each.default, bool)
    }
    assert flags
    assert not any(flags.values())


def test_a_breather_of_the_other_method_is_no_branch(monkeypatch: pytest.MonkeyPatch) -> None:
    from fronts import branches

    followed: list[Any] = []
    monkeypatch.setattr(branches, "follow_breather", lambda *given, **_: followed.append(given))
    monkeypatch.setattr(branches, "follow_front", lambda *given, **by: followed.append((given, by)))
    full, mean = (fr.VdpChain(a=4, b=0.5, c=0.1), fr.AveragedChain(a=4, b=0.5, c=0.1))
    for chain, own, other in ((full, "orbit", "envelope"), (mean, "envelope", "orbit")):
        followed.clear()
        branch = functools.partial(
            branches.breather_branch, [chain], values=[0.1], nucleus=fr.Nucleus(1)
        )
        branch("c", method=other)
        branch("a", method=own)
        assert not followed
        branch("c", method=own)
        branch("c")
        assert len(followed) == 2
    followed.clear()
    for along, method in (("a", "wave"), ("c", "run"), ("c", "wave"), ("eta", "wave")):
        branches.front_branch([mean], along, [0.1], method=method)
    assert followed == [((mean, [0.1]), {}), ((mean,), {"etas": [0.1]})]


def test_only_waves_along_c_or_eta_make_a_branch_of_fronts(monkeypatch: pytest.MonkeyPatch) -> None:
    from fronts import branches

    monkeypatch.setattr(branches, "follow_front", lambda *given, **by: (given, by))
    found = {along: branches.front_branch(["chain"], along, [0.1], method="wave")
             for along in ("c", "eta", "a")}  # fmt: skip
    assert found == {"c": (("chain", [0.1]), {}), "eta": (("chain",), {"etas": [0.1]}), "a": None}
    assert branches.front_branch(["chain"], "c", [0.1]) is None


@pytest.mark.parametrize(
    ("c", "asked", "shown"),
    [(0.5, False, [False]), (0.5, True, [True]), ([0.5], True, [True]), ([0.5], False, [])],
)
def test_stability_is_determined_of_one_front_and_along_a_curve_if_it_is_asked_for(
    c: Any, asked: bool, shown: list[bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    from fronts.piecewise import kinetic_relation

    limits: list[bool] = []
    monkeypatch.setattr(
        kinetic_relation, "_with_stability", lambda answer, limit: limits.append(limit) or answer
    )
    found: Any = fr.kinetic_relation(c=c, eta=0.03125, stability=asked)
    assert limits == shown
    if np.ndim(c):
        assert (found.along, found.points[0].c) == ("c", 0.5)


def test_each_point_that_is_proven_is_an_equal_part_of_the_progress(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: list[float] = []

    def certified(answer: Any, progress: Callable[[float], None]) -> Any:
        progress(0.5)
        return answer

    monkeypatch.setattr("theory.piecewise.certified_relation.certify_relation", certified)
    found: Any = fr.kinetic_relation(c=[0.5, 0.6], eta=0.03125, certify=True, progress=seen.append)
    assert [point.c for point in found.points] == [0.5, 0.6]
    assert seen == [0.25, 0.75]


def test_an_interrupted_run_names_its_checkpoint_if_there_is_one(tmp_path: Path) -> None:
    from fronts.interrupted import Interrupted, resumable_run

    there = tmp_path / "run.npz"
    there.write_bytes(b"")
    for path, said in ((None, ""), (tmp_path / "no.npz", ""), (there, f"{there} is there: ")):
        with pytest.raises(Interrupted) as stopped, resumable_run(path):
            raise KeyboardInterrupt
        assert str(stopped.value).startswith(said)
        assert bool(str(stopped.value)) == bool(said)


def test_an_interrupted_map_names_the_table_that_was_begun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fronts import maps
    from fronts.interrupted import Interrupted
    from verification.execution.sweep import part_path

    out = tmp_path / "map.csv"

    def begun(*_: Any, **__: Any) -> None:
        part_path(out).write_text("")
        raise KeyboardInterrupt

    monkeypatch.setattr(maps, "state_map", begun)
    chain = fr.AveragedChain(a=4, b=0.5, c=0.1, sites=16)
    with pytest.raises(Interrupted, match=re.escape(f"{part_path(out)} is there")):
        maps.mapped(chain, {"c": [0.1, 0.2], "eta": [0.01]}, out=out)


def test_the_overview_lists_every_command(capsys: Capture) -> None:
    for words in ([], ["-h"], ["--help"], ["help"]):
        assert main(words) == 0
        listed = [line.split()[0] for line in capsys.readouterr().out.splitlines()
                  if line.startswith("  ")]  # fmt: skip
        assert listed == [*COMMANDS]


def test_the_value_of_an_option_that_does_not_exist_is_the_word_after_it() -> None:
    with pytest.raises(UsageError, match="--nope has no meaning for 'fronts sum'") as refused:
        cli.new_parser("fronts sum", "x", "").read(["--nope", "3", "4"])
    with pytest.raises(UsageError, match="--js is not an option of 'fronts sum': write --json"):
        cli.new_parser("fronts sum", "x", "").read(["--js"])
    assert (refused.value.details["quantity"], refused.value.details["value"]) == ("--nope", "3")


def test_a_shell_is_named_for_the_script_of_completion() -> None:
    pytest.importorskip("shtab")
    for words in ([], ["bash", "zsh"], ["none"]):
        with pytest.raises(UsageError, match="--print-completion takes one shell: choose one of "):
            cli._completion(words)


def test_full_and_envelope_name_a_model_where_there_are_both() -> None:
    both: Any = {"vdp": None, "averaged": None, "friction": None}
    for rest, model, left in (
        (["--model", "envelope", "--c", "1"], "averaged", ["--c", "1"]),
        (["--c", "1", "--model=full"], "vdp", ["--c", "1"]),
    ):
        assert cli._renamed("vdp", rest, both, "front") == (model, left)
        assert cli._renamed("friction", rest, both, "front") == ("friction", rest)
        assert cli._renamed("vdp", rest, {"vdp": both["vdp"]}, "front") == ("vdp", rest)
    with pytest.raises(UsageError, match=r"invalid choice: 'x' .* see 'fronts front --help'"):
        cli._model("front", COMMANDS["front"], both, ["vdp", "--model", "x"])


def test_one_order_is_derived_unless_two_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derivations.catalogue.load", lambda *of: SimpleNamespace(title=f"{of}"))
    assert fr.derivation("averaging").title == "('averaging', 1)"
    assert fr.derivation("averaging", order=2).title == "('averaging', 2)"


def test_a_section_without_entries_may_end_a_docstring() -> None:
    words = "Do it.\n\nParameters\n----------\na : float\n    One.\n\nReturns\n-------"
    assert documented(words) == {"a": "One."}


def test_the_head_of_a_column_has_its_unit_and_what_is_missing_is_a_dash() -> None:
    rows = [{"c": 0.1, "v": 0.5}, {"c": 0.2, "v": math.nan}, {"c": 0.3, "v": None}]
    for units, head in (({"v": "sites"}, ["c", "v", "(sites)"]), ({}, ["c", "v"])):
        table = [line.split() for line in table_lines(rows, units=units)]
        assert table == [head, ["0.1", "0.5"], ["0.2", "-"], ["0.3", "-"]]


def test_a_stability_that_is_none_was_not_decided() -> None:
    plain = cast("Any", SimpleNamespace(is_curve=False, units={}))
    for stable, said in ((None, "stable  not decided"), (True, "stable  yes")):
        assert in_words(plain, {"stable": stable}) == said
    assert in_words(plain, {"v": 0.5}) == "v  0.5"


def test_of_results_within_a_result_a_notebook_shows_what_they_show_of_themselves() -> None:
    @dataclass(frozen=True, kw_only=True)
    class Own(Result):
        v: float
        hidden: float = field(default=0.25, repr=False)

    assert re.findall("<t[hd]>([^<]*)</t[hd]>", _cell("points", (Own(v=0.5),))) == ["v", "0.5"]


def test_a_zarr_store_has_beside_its_table_what_the_table_does_not_hold(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from fronts import files

    monkeypatch.setattr(files, "zarr_writer", lambda *given: given)
    dataset = SimpleNamespace(variables=["v"], assign_attrs=dict)
    result: Any = SimpleNamespace(to_xarray=lambda: dataset, in_columns=("w",))
    stored: Any = files._zarr(result, {"v": 1, "w": 2, "of": [3]}, {"c": 0.5})
    assert stored == ({"result": json.dumps({"of": [3]})}, {"c": 0.5})
    assert files._beside({"points": [{"v": 1}, {"v": 2}], "mixed": [{"v": 1}, 2]}, ()) == {}


def test_every_quantity_is_listed_with_its_range_and_its_share() -> None:
    from fronts.commands import stress

    answer: Any = stress._list()
    for row in answer.payload["quantities"]:
        assert any(line.split()[0] == row["quantity"] for line in answer.text.splitlines())
        assert f"share {row['share']:g}" in answer.text


@pytest.mark.parametrize(
    ("along", "resting", "order", "place"),
    [("c", [0.1], [0.3, 0.2, 0.1], 1), ("eta", [0.08], [0.08, 0.05, 0.03], 2)],
)
def test_along_a_branch_fronts_at_rest_are_last_in_c_and_first_in_eta(
    along: Any, resting: Any, order: Any, place: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And a fold stands at its place among all of them."""
    from fronts import branches

    def follow(moving: Any, other: float, along: str) -> Any:
        assert other == {"c": 0.03125, "eta": 0.15}[along]  # η of the chain, or its c
        waves = [SimpleNamespace(**{along: value}) for value in reversed(moving)]
        fold = SimpleNamespace(parameter=0.04, error=1e-6, u=np.ones(1))
        return SimpleNamespace(fronts=waves, folds=[(fold, 1)])  # after the first moving front

    monkeypatch.setattr("verification.fronts.follow.follow_front_wave", follow)
    monkeypatch.setattr("verification.fronts.measure.front_of_wave", lambda chain, _: chain)
    monkeypatch.setattr("verification.fronts.resting.static_fold", lambda eta: eta)
    monkeypatch.setattr(branches, f"_ends_in_{along}", lambda *_: ({}, resting))
    branch = branches._fronts(fr.AveragedChain(a=4, b=0.5, c=0.15), along, order[::-1])
    assert branch.values.tolist() == order
    assert {type(chain) for chain in branch.points} == {fr.AveragedChain}
    assert [getattr(chain, along) for chain in branch.points] == pytest.approx(order)
    assert [(fold.points_before, fold.error) for fold in branch.folds] == [(place, 1e-6)]


def test_progress_is_told_of_a_claim_before_and_after_it_is_judged(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from fronts.commands import check

    def judged(entries: Any, *, started: Any, done: Any, **_: Any) -> None:
        started("fig01-x")
        done(entries)
        raise KeyboardInterrupt

    told: list[Any] = []
    monkeypatch.setattr(check, "judge_all", judged)
    monkeypatch.setattr(check.Progress, "begin", lambda _, key: told.append(key))
    monkeypatch.setattr(check, "_tell", lambda _, outcome: told.append(outcome))
    main(["check", "fig16-admissible"])
    assert told[0] == "fig01-x"
    assert [entry.claim.key for entry in told[1]] == ["fig16-admissible"]


@pytest.mark.parametrize(
    ("stored", "stale", "changed", "notes"),
    [
        (True, False, False, ", stored"),
        (True, True, False, ", stored, stale"),
        (False, False, False, ""),
        (False, False, True, ", not as recorded"),
    ],
)
def test_progress_says_of_a_finding_whether_it_is_stored_stale_or_not_as_recorded(
    stored: bool, stale: bool, changed: bool, notes: str
) -> None:
    from fronts.commands.check import _tell

    said: list[Any] = []
    shown: Any = SimpleNamespace(end=lambda *given, computed: said.append((*given, computed)))
    judgement = SimpleNamespace(seconds=0.5, stored=stored, stale=stale)
    claim = SimpleNamespace(key="fig01-x")
    outcome: Any = SimpleNamespace(
        judgement=judgement, changed=changed, claim=claim, status="reproduced"
    )
    _tell(shown, outcome)
    assert said == [("fig01-x", f"reproduced (0.50 s{notes})", not stored)]


def test_what_was_recorded_is_named_claim_by_claim(tmp_path: Path) -> None:
    from fronts.commands.check import _record

    recorded: list[Any] = []
    shipped: Any = SimpleNamespace(
        folder=tmp_path, path=lambda each: each, record=lambda *given: recorded.append(given[0])
    )

    def outcome(key: str, evidence: str, **changes: Any) -> Any:
        claim = SimpleNamespace(
            key=key, evidence=evidence, expensive=changes.get("expensive", True)
        )
        judgement = SimpleNamespace(stored=changes.get("stored", False))
        finding = changes.get("finding", object())
        return SimpleNamespace(claim=claim, finding=finding, judgement=judgement, entry=key)

    several = [outcome("a", "one"), outcome("b", "one"), outcome("c", "two"),
               outcome("d", "three", stored=True), outcome("e", "four", finding=None),
               outcome("f", "five", expensive=False)]  # fmt: skip
    report: Any = SimpleNamespace(outcomes=several, versions={})
    assert _record(shipped, report) == f"Recorded in {tmp_path}: a, b, c."
    assert sorted(recorded) == ["a", "c"]  # evidence that claims share is stored once
    report = SimpleNamespace(outcomes=several[3:], versions={})
    assert "none: no expensive claim was asked" in _record(shipped, report)


def test_a_verdict_is_named_by_its_slug_or_its_words_with_spaces_or_without() -> None:
    from fronts.commands.check import _chosen, _verdict

    for verdict in Verdict:
        for name in (slug(verdict), verdict.value, "-".join(verdict.value.split())):
            assert _verdict(name) is verdict
    with pytest.raises(UsageError, match="no claim has the verdict 'partial'"):
        _chosen((), (), "partial")


def test_default_methods_are_judged_from_the_records_of_a_folder(
    tmp_path: Path, capsys: Capture
) -> None:
    from benchmarks.work_precision import RESULTS

    assert main(["bench", "sum", "--defaults", "--json"]) in (0, 1)
    choices = json.loads(capsys.readouterr().out)["choices"]
    assert {each["quantity"] for each in choices} == {"sum"}
    for name in ("sum.json", "sum.csv"):
        shutil.copy(RESULTS / name, tmp_path)
    assert main(["bench", "sum", "roots", "--defaults", "--out", str(tmp_path)]) in (0, 1)
    assert capsys.readouterr().out.endswith("\nno record: roots\n")


@pytest.mark.parametrize("asked", [False, True])
def test_growth_is_written_into_the_folder_that_is_named(
    asked: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from benchmarks import floor, growth
    from fronts.commands.bench import _measure

    written: list[tuple[Any, ...]] = []
    for module, row in ((growth, "row"), (floor, "floor")):

        def measure(quick: bool, report: Any, row: str = row) -> list[str]:
            assert quick is True
            report(row)
            return [row]

        monkeypatch.setattr(module, "measure", measure)
    monkeypatch.setattr(growth, "as_payload", lambda rows, command: {"rows": rows})
    monkeypatch.setattr(growth, "as_text", lambda rows: f"{rows}")
    monkeypatch.setattr(floor, "as_rows", list)
    monkeypatch.setattr(floor, "as_text", lambda rows: f"{rows}")
    monkeypatch.setattr(growth, "write_growth", lambda *given: written.append(given))
    folder = tmp_path if asked else None
    answer = _measure((), growth=True, quick=True, folder=folder)
    assert answer.payload["growth"] == {"rows": ["row"], "floors": ["floor"]}
    assert answer.text.startswith("['row']\n\n['floor']")
    assert written == ([(answer.payload["growth"], ["row"], tmp_path)] if asked else [])


@pytest.mark.parametrize("asked", [False, True])
@pytest.mark.parametrize("count", [0, 2])
def test_records_and_the_choice_of_defaults_are_written_into_the_folder_that_is_named(
    asked: bool, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from benchmarks import choice, diagram, registry, tables
    from fronts.commands.bench import _measure

    written: list[tuple[Any, ...]] = []
    some: Any = tuple(SimpleNamespace(name=f"b{n}", style="style") for n in range(count))
    made = {"points": "points"}

    def measured(each: Any, quick: bool, report: Any) -> SimpleNamespace:
        assert quick is False
        report(f"timing {each.name}")

        def save(path: Path) -> None:
            written.append((each.name, path))

        stored = SimpleNamespace(to_dict=lambda: {"of": each.name}, save=save)
        return SimpleNamespace(of=each.name, stored=lambda: stored, **made)

    monkeypatch.setattr(registry, "measured", measured)
    monkeypatch.setattr(tables, "as_text", lambda found: f"text of {found.of}")
    monkeypatch.setattr(diagram, "draw", lambda *given: written.append(given))
    monkeypatch.setattr(choice, "stored_choices", lambda every, folder: ((every, folder), []))
    monkeypatch.setattr(choice, "write_choices", lambda *given: written.append(given))
    monkeypatch.setattr(registry, "all_benchmarks", lambda: "every")
    answer = _measure(some, growth=False, quick=False, folder=tmp_path if asked else None)
    assert answer.payload == {"records": {each.name: {"of": each.name} for each in some}}
    assert all(f"text of {each.name}" in answer.text for each in some)
    expected: list[tuple[Any, ...]] = []
    for each in some:
        expected.append((each.name, tmp_path / f"{each.name}.json"))
        expected.append((each.name, "points", "style", tmp_path))
    if some:
        expected.append((("every", tmp_path), tmp_path / "defaults.json"))
    assert written == (expected if asked else [])
    assert (str(tmp_path) in answer.text) is asked
    assert capsys.readouterr().err == "".join(f"timing {each.name} ...\n" for each in some)


def test_all_is_measured_into_the_records_unless_some_are_named_or_it_is_quick(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from benchmarks.registry import all_benchmarks
    from benchmarks.work_precision import RESULTS
    from fronts.commands import bench

    asked: list[tuple[Any, ...]] = []
    monkeypatch.setattr(bench, "_measure", lambda *given: asked.append(given) or Answer({}, ""))
    monkeypatch.setattr(bench, "_defaults", lambda *given: asked.append(given) or Answer({}, ""))
    one = tuple(each for each in all_benchmarks() if each.name == "sum")
    for words, expected in (
        ([], (all_benchmarks(), True, False, RESULTS)),
        (["--quick"], (all_benchmarks(), True, True, None)),
        (["sum", "--quick", "--out", str(tmp_path)], (one, False, True, tmp_path)),
        (["sum"], (one, False, False, RESULTS)),
        (["sum", "growth"], (one, True, False, RESULTS)),
        (["growth"], ((), True, False, RESULTS)),
        (["--defaults"], (all_benchmarks(), RESULTS)),
        (["sum", "--defaults"], (one, RESULTS)),
    ):
        asked.clear()
        assert main(["bench", *words]) == 0
        assert asked == [expected]
    monkeypatch.setattr(bench, "ROOT", tmp_path)  # as where it is installed without its sources
    assert main(["bench", "--quick"]) == 2
    assert asked == [expected]


def test_the_list_of_benchmarks_has_their_problems_and_growth_where_it_is_meant() -> None:
    from benchmarks.registry import all_benchmarks
    from fronts.commands.bench import _list

    one = tuple(each for each in all_benchmarks() if each.name == "sum")
    answer = _list(one, growth=True)
    (row,) = answer.payload["quantities"]
    lines = answer.text.splitlines()
    assert lines == [*_list(one, growth=False).text.splitlines(), lines[-1]]
    assert lines[0].split(maxsplit=1) == ["sum", f"{row['what']}; by default: {row['default']}"]
    assert lines[1].strip() == f"test problems: {'; '.join(row['problems'])}"
    assert lines[2].split()[0] == "growth"
    assert row["default"] in row["methods"]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("bench rots", ("quantity = rots", "one of breather", "--list")),
        ("bench roots --out nowhere/at/all", ("nowhere/at/all", "create it first")),
        ("bench --list --defaults", ("--list and --defaults",)),
        ("bench --quik", ("--quik", "--quick")),
        ("bench --list --quick", ("--list measures nothing", "leave out --quick")),
        ("bench --defaults --quick", ("--defaults measures nothing", "--quick")),
        ("bench --list --out .", ("--list reads and writes no record", "--out")),
        (
            "bench growth --defaults",
            ("not judge any default method of growth", "leave out growth"),
        ),
    ],
)
def test_bad_input_to_bench_is_one_sentence(
    line: str, words: tuple[str, ...], refused: Refused
) -> None:
    said = refused(line)["message"]
    assert all(word in said for word in words)


def test_the_claims_of_a_report_are_written_as_a_table(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "claims.csv"
    assert main(["check", "text-trapezoid", "text-ends", "--out", str(path)]) == 0
    rows = [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]
    assert [row["key"] for row in csv.DictReader(rows)] == ["text-ends", "text-trapezoid"]
    assert str(path) in capsys.readouterr().out


@pytest.mark.parametrize("full", [True, False])
def test_stored_findings_are_used_unless_all_is_asked_for_anew(
    full: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr("paper_checks.run.run", lambda *_, **options: asked.append(options) or ())
    fr.judge("fig16-admissible", full=full)
    assert asked[0]["shipped"] == (None if full else Shipped(FOLDER, SOURCES))


# ----------------------------------------------------------------------------------- the explorer


@pytest.mark.parametrize("more", [[], ["--no-browser"]])
def test_a_browser_is_opened_unless_it_is_not_wanted(
    more: list[str], monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    def serve(port: int, ready: Any, *, show: bool) -> None:
        assert show is not bool(more)
        if port:
            assert port == 8123
            ready("http://here")
        raise KeyboardInterrupt

    monkeypatch.setitem(
        sys.modules, "fronts.explore.page", cast("Any", SimpleNamespace(serve=serve))
    )
    assert main(["explore", "--port", "8123", *more, "--json"]) == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out) == {"address": "http://here"}
    assert shown.err.startswith("http://here ")
    assert main(["explore", *more, "--json"]) == 0  # at any port, and ended before it is served
    assert json.loads(capsys.readouterr().out) == {"address": None}


@pytest.mark.parametrize("model", ["averaged", "vdp"])
def test_the_chain_of_the_explorer_has_the_damping_that_was_set(model: str) -> None:
    from fronts.explore.calls import Settings, calls
    from verification.maps.vdp_rules import FIGURE_15

    for given in ({"eta": 0.05}, {"eta": 0.02, "a": 5.0, "b": 0.5}):
        called = calls(Settings(model=model, c=0.3, **given))
        for chain in (called["run"].arguments[0], called["breather"].arguments[0]):
            made = chain.run()
            assert (made.a, made.b) == (given.get("a", 1.0), given.get("b", given["eta"]))
            assert eta_from_damping(made.a, made.b) == pytest.approx(given["eta"])
            assert made.c == 0.3
    of_map = called["states"].arguments[0].run()
    assert (of_map.sites, of_map.b) == (FIGURE_15.sites, FIGURE_15.b)  # as its caption says


def test_records_are_those_of_the_source_tree() -> None:
    from fronts.commands.bench import ROOT
    from fronts.explore.update_time import RECORD

    assert Path(__file__).parents[1] == ROOT == RECORD.parents[2]


def test_an_entry_that_is_a_column_is_not_repeated_beside_its_table() -> None:
    answer = {"found": {"of": 1}, "kept": {"of": 2}, "parts": {"re": 1.0}}
    in_part = {"half": {"re": 1.0, "im": 2.0}}
    assert _beside(answer | in_part, ["found", "parts_re", "half_re"]) == {
        "kept": {"of": 2},
        **in_part,
    }


def test_times_of_updates_are_in_milliseconds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here an update takes as many seconds as its coupling."""
    from fronts.explore import update_time

    asked: list[float] = []

    def taken(settings: Any) -> float:
        asked.append(settings.c)
        return float(settings.c)

    monkeypatch.setattr(update_time, "_seconds_of_update", taken)
    found = update_time.measure("vdp", (0.5, 0.125, 0.25))
    assert (found.median_ms, found.largest_ms, found.slowest_c) == (250.0, 500.0, 0.5)
    assert asked[-3:] == [0.5, 0.125, 0.25]
    assert asked[:-3]  # not timed: they compile


def test_an_update_is_all_but_what_is_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    from fronts.explore import update_time

    clock, asked = iter([5.0, 7.5]), []
    monkeypatch.setattr(update_time, "process_time", lambda: next(clock))
    monkeypatch.setattr(update_time, "outcome", asked.append)
    assert update_time._seconds_of_update(update_time.Settings()) == 2.5
    every = update_time.calls(update_time.Settings())
    assert asked == [call for name, call in every.items() if name not in update_time.SLOW]
    assert ("estimate_error", False) in every["run"].options  # which would take another run


def test_the_explorer_runs_the_chain_for_the_slow_time_of_its_axis() -> None:
    from fronts.explore.calls import SITES, SLOW_TIME, Settings, Steps, calls

    assert Steps(0.25, 2).run() == [0.25, 0.5]
    excited = calls(Settings(nucleus=3))["run"].arguments[1].arguments[1]
    assert list(excited) == [SITES // 2, SITES // 2 + 1, SITES // 2 + 2]  # of 1, …, 41
    for eps in (0.01, 0.1):
        options = dict(calls(Settings(eps=eps))["run"].options)
        assert eps * options["t_end"] == pytest.approx(SLOW_TIME)
    assert dict(calls(Settings(eps=0.0))["run"].options)["t_end"] == 0.0  # refused by simulate


def test_the_explorer_looks_for_a_breather_of_the_full_chain_beyond_the_fold_of_the_average(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The folds differ by O(ε), so that up to some parts of ε there may be one."""
    from fronts.explore import calls as module

    monkeypatch.setattr(module, "outcome", lambda call: SimpleNamespace(fold=0.2))
    for part, eps, method in ((0.9, 0.1, "orbit"), (1.2, 0.1, "orbit"), (2.0, 0.1, "envelope")):
        settings = module.Settings(c=0.2 * part, eps=eps, model="vdp")
        assert dict(module.calls(settings)["breather"].options)["method"] == method


def test_the_program_of_the_explorer_shows_every_result_and_computes_no_map_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from fronts.explore import calls as module

    asked: list[str] = []
    monkeypatch.setattr(module, "outcome", lambda call: asked.append(call.function))
    lines = module.script(module.Settings()).splitlines()
    compile("\n".join(lines), "script", "exec")
    assert "state_map" not in asked
    for name in module.calls(module.Settings()):
        assert (f"print({name})" in lines) == (name in ("point", "breather"))
        drawn = any(line.startswith(f"{name}.plot()") for line in lines)
        assert drawn == (name != "point")


def test_times_of_updates_are_stored_where_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from fronts.explore import update_time

    assert update_time.RECORD.is_file()
    taken = update_time.UpdateTime(median_ms=1.0, largest_ms=2.0, slowest_c=0.5)
    monkeypatch.setattr(update_time, "measure", lambda model: taken)
    monkeypatch.setattr(update_time, "RECORD", tmp_path / "explorer.json")
    for more in ([], ["--record"]):
        monkeypatch.setattr(sys, "argv", ["update_time", *more])
        update_time.main()
        assert (tmp_path / "explorer.json").exists() == bool(more)
    assert "at most 2 ms at c = 0.5" in capsys.readouterr().out
    monkeypatch.setattr(sys, "argv", ["update_time", "--help"])
    with pytest.raises(SystemExit, match="0"):
        update_time.main()
    shown = " ".join(capsys.readouterr().out.split())
    assert (update_time.__doc__ or "").splitlines()[0] in shown


# --------------------------------------------------------------------------- sums and roots


@pytest.mark.parametrize("method", ["series", "bessel", "quadrature", "certified"])
def test_the_methods_of_a_sum_agree_within_their_errors(method: Any) -> None:
    if method == "certified":
        pytest.importorskip("flint")
    one, other = fr.sigma(0.3, 0.5), fr.sigma(0.3, 0.5, method=method)
    assert abs(complex(one.value) - complex(other.value)) <= one.error + other.error < 2e-12


def test_thirteen_digits_are_the_most_of_a_sum_in_double_precision() -> None:
    assert fr.sigma(0.3, 0.5, method="bessel", digits=13).error <= 1e-13
    with pytest.raises(ParameterError, match="at most 13 for bessel"):
        fr.sigma(0.3, 0.5, method="bessel", digits=14)


def test_a_sum_of_many_digits_is_returned_as_it_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Although its error may be a little larger: in double precision it would lose digits."""
    found = SimpleNamespace(error=2e-30)
    monkeypatch.setattr("theory.piecewise.sums.series.sum_by_roots", lambda *_: found)
    summed: Any = fr.sigma(0.3, 0.5, method="series", digits=30)
    assert summed is found


@pytest.mark.parametrize("method", ["integral", "series"])
@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1e-3, 4.0), (2e-4, 0.02)])
@pytest.mark.parametrize("digits", [3, 12, 15])
def test_a_sum_has_as_many_digits_as_were_asked_for(
    method: str, v: float, c: float, digits: int
) -> None:
    """The rounding to a double is left, where so many digits are asked for."""
    found = fr.sigma(v, c, method=method, digits=digits)
    rounding = np.finfo(float).eps * abs(found.value)
    assert found.error <= 10.0**-digits + 2.0 * rounding
    many = fr.sigma(v, c, digits=30)
    assert abs(found.value - complex(many.value)) <= found.error + rounding


def test_roots_of_many_digits_solve_their_equation_in_both_halves() -> None:
    """L(k) = 1/2 - ic(1 - cos k) - ivk = 0 at the velocity and the coupling, which differ."""
    found = fr.roots("0.3", "0.5", count=1, digits=20)
    with mp.workdps(30):
        v, c = mp.mpf("0.3"), mp.mpf("0.5")
        for half, sign in ((found.upper, 1), (found.lower, -1)):
            (root,) = half
            k = mp.mpc(root.re, root.im)
            assert mp.sign(k.imag) == sign
            assert abs(0.5 - 1j * c * (1 - mp.cos(k)) - 1j * v * k) < 1e-18


def test_the_radius_of_a_root_of_many_digits_is_what_printing_them_costs() -> None:
    import mpmath as mp

    v, c = "0.3", "0.5"
    coarse = fr.roots(v, c, count=3, digits=30)
    fine = fr.roots(v, c, count=3, digits=60)
    for one, two in zip(coarse.upper + coarse.lower, fine.upper + fine.lower, strict=True):
        with mp.workdps(70):
            k = mp.mpc(two.re, two.im)
            assert abs(mp.mpc(one.re, one.im) - k) <= one.radius
            assert one.radius == pytest.approx(float(1e-29 * abs(k)), rel=1e-6, abs=0.0)
            assert one.residual < 1e-36


@pytest.mark.parametrize(("v", "c"), [("0.3", "0.5"), ("0.05", "2.0")])
def test_the_radius_of_a_root_of_many_digits_reaches_as_far_as_it_is_off(
    v: str, c: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each is handed over a little off: by far more than printing costs."""
    from theory.piecewise import precise_roots as finder

    def moved(*asked: Any) -> list[Any]:
        return [k + off for k in found(*asked)]

    found, off = finder.precise_roots, 1e-20
    monkeypatch.setattr(finder, "precise_roots", moved)
    shown = fr.roots(v, c, count=3, digits=30)
    for one in shown.upper + shown.lower:
        assert off <= one.radius <= 2.001 * off


@pytest.mark.parametrize(("v", "c"), [("0.3", 0.5), ("0.1", 0.5), (0.25, "0.7"), (0.25, "0.1")])
def test_the_radius_of_a_root_includes_the_rounding_of_what_is_given_in_decimals(
    v: str | float, c: str | float
) -> None:
    import mpmath as mp

    from theory.piecewise.precise_roots import precise_roots

    decimal, double = fr.roots(v, c, count=3), fr.roots(float(v), float(c), count=3)
    for upper in (True, False):
        pair = [getattr(each, "upper" if upper else "lower") for each in (decimal, double)]
        labels = np.array([root.label for root in pair[0]])
        true = [precise_roots(*of, labels, upper, 40) for of in ((v, c), (float(v), float(c)))]
        for one, other, near, far in zip(*pair, *true, strict=True):
            with mp.workdps(40):
                moved = float(abs(near - far))
            assert 1.0 <= (one.radius - other.radius) / moved < 2.0


def test_roots_are_counted_in_the_strips_of_all_that_were_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Were there one more than labels, the count would say so."""
    from theory.piecewise import root_count

    strips: list[int] = []

    def one_more(v: float, c: float, labels: Any, upper: bool) -> int:
        strips.extend(labels.tolist())
        return int(labels.size) + 1

    plain = fr.roots(0.3, 0.5, count=4)
    assert plain.counted == 8
    monkeypatch.setattr(root_count, "count_in_strips", one_more)
    assert fr.roots(0.3, 0.5, count=4).counted == 10
    assert {root.label for root in plain.upper} <= {*strips}


def test_a_strip_between_others_whose_root_is_not_listed_is_not_counted() -> None:
    from fronts.piecewise.roots import _counted
    from theory.piecewise.roots import labelled_roots

    for labels in (np.arange(-2, 3), np.array([-2, 0, 1, 4])):
        listed = labelled_roots(0.3, 0.5, labels, True)
        assert _counted(0.3, 0.5, listed, upper=True) == labels.size


def test_a_bound_on_roots_times_digits_holds_only_where_digits_are_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from fronts.piecewise import roots

    monkeypatch.setattr(roots, "_MAX_DIGITS_OF_ROOTS", 4 * (DOUBLE + 1))
    assert len(fr.roots(0.3, 0.5, count=9, digits=DOUBLE).upper) == 9
    assert len(fr.roots(0.3, 0.5, count=4, digits=DOUBLE + 1).upper) == 4
    for more in ({"count": 5}, {"extent": 10.0}):  # of which 3 lie above, and 4 below
        monkeypatch.setattr(roots, "_MAX_DIGITS_OF_ROOTS", 3 * (DOUBLE + 1))
        with pytest.raises(ParameterError, match="roots times digits"):
            fr.roots(0.3, 0.5, digits=DOUBLE + 1, **cast("Any", more))


@pytest.mark.parametrize(("extent", "numbers"), [(0.05, (0, 0)), (0.5, (0, 1)), (3.0, (1, 1))])
def test_a_half_plane_without_roots_has_none_and_one_root_is_certified(
    extent: float, numbers: tuple[int, int]
) -> None:
    pytest.importorskip("flint")
    plain, proven = (fr.roots(0.3, 0.5, extent=extent, certify=each) for each in (False, True))
    for found in (plain, proven):
        assert (len(found.upper), len(found.lower)) == numbers
        assert found.counted == sum(numbers)
    for one, other in zip(plain.upper + plain.lower, proven.upper + proven.lower, strict=True):
        assert abs(complex(one.re, one.im) - complex(other.re, other.im)) <= other.radius
        assert other.radius != one.radius


def test_roots_are_counted_at_the_velocity_and_coupling_that_are_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from theory.piecewise import root_count

    asked: list[tuple[Any, ...]] = []

    def counted(v: float, c: float, labels: Any, upper: bool) -> int:
        asked.append((v, c, upper))
        return int(labels.size)

    monkeypatch.setattr(root_count, "count_in_strips", counted)
    fr.roots(0.3, 0.5, count=2)
    assert asked == [(0.3, 0.5, True), (0.3, 0.5, False)]


def test_the_progress_of_many_digits_rises_from_zero_and_stays_below_one() -> None:
    parts: list[float] = []
    fr.roots("0.3", "0.5", count=4, digits=30, progress=parts.append)
    assert parts[0] == 0.0
    assert all(0.0 <= part <= 1.0 for part in parts)
    assert parts == sorted(parts)
    assert len(set(parts)) >= 8


def test_the_progress_of_a_proof_rises_from_zero_and_stays_below_one() -> None:
    pytest.importorskip("flint")
    parts: list[float] = []
    fr.kinetic_relation([0.1, 0.2], 0.03125, certify=True, progress=parts.append)
    assert parts[0] == 0.0
    assert parts == sorted(parts)
    assert 0.5 < parts[-1] <= 1.0


def test_a_sum_in_double_precision_is_as_uncertain_as_it_was_and_its_rounding() -> None:
    import mpmath as mp

    from fronts.piecewise.sigma import _rounded

    plain = fr.sigma(0.3, 0.5, method="series")
    with mp.workdps(40):
        exact = mp.mpc(1) + mp.mpf(2) ** -53 * mp.mpf("0.999")  # rounds to 1
        for error in (0.0, 1e-3):
            found = _rounded(replace(plain, value=exact, error=error))
            assert found.value == 1.0
            assert abs(exact - found.value) + error <= found.error <= 1e-15 + error


@pytest.mark.parametrize(
    ("given", "refused"),
    [
        ({"eta": 0.03125}, False),
        ({"a": 4.0, "b": 0.5}, False),
        ({"eta": 0.03125, "a": 4.0}, True),
        ({"eta": 0.03125, "b": 0.5}, True),
        ({"eta": 0.03125, "a": 4.0, "b": 0.5}, True),
        ({"a": 4.0}, True),
        ({"b": 0.5}, True),
        ({}, True),
    ],
)
def test_damping_is_given_by_eta_or_by_a_and_b(given: dict[str, float], refused: bool) -> None:
    for function in (fr.kinetic_relation, fr.front_profile):
        if refused:
            with pytest.raises(ParameterError, match="eta = "):
                function(0.5, **given)
        else:
            assert function(0.5, **given).eta == 0.03125
    if not refused:
        front = fr.kinetic_relation(0.5, **given).branches[-1]
        assert fr.front_profile(0.5, **given).v_error == front.error > 0.0
