"""``fronts derive``: derivations step by step, the verdict on each equation, and other chains.

SymPy is imported only when something is derived, so that the listing remains fast.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal

from derivations import catalogue
from fronts.answer import Answer, UsageError
from fronts.arguments import check_writable
from fronts.output import with_table
from verification.execution.files import write_by
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from derivations.algebra.steps import Derivation
    from derivations.chain import ChainModel
    from derivations.judgement import EquationJudgement

EXAMPLE = """examples:
  fronts derive                                         list the derivations
  fronts derive multiple-scales --order 2               one derivation, to second order
  fronts derive multiple-scales --damping "1 - a*y**2 + b*y**6" --stiffness "g*y**3"
  fronts derive averaging --weights "1, w"              with springs to the second neighbours
  fronts derive --equation 34                           one equation with check and verdict
  fronts derive linearisation --format latex --out jacobian.tex
  fronts derive all                                     the verdict on each of Eqs. 1-54
  fronts derive --graph --out equations.svg             which equation follows from which
  fronts derive cell --damping "1 - a*y**2 + b*y**4" --value a=4 --value b=0.5 --order 2"""

TABLES = (".csv", ".npz")
"""Endings of files with rows (steps, equations or derivations); other files contain the text."""

NOT_TEXT = (".zarr", ".png", ".pdf", ".gif", ".mp4")
"""Endings of files that contain neither text nor rows."""


def derive(  # noqa: PLR0913  (options of a command, by name)
    name: str | None = None,
    /,
    *,
    order: int = 1,
    equation: int | None = None,
    format: Literal["text", "latex", "mathml", "markdown", "json"] = "text",
    graph: bool = False,
    out: Path | None = None,
    damping: str | None = None,
    stiffness: str | None = None,
    coupling: str | None = None,
    weights: str | None = None,
    value: Sequence[str] = (),
    no_front: bool = False,
    quiet: bool,
) -> Answer:
    """List the derivations; or derive, check and show equations.

    Parameters
    ----------
    name : str, optional
        Friction, multiple-scales, averaging, linearisation, piecewise-front, second-order, all, or
        cell; or the number of an equation, as with --equation.
    order : int, optional
        Order in eps, 1 or 2.
    equation : int, optional
        Number of a single equation.
    format : str, optional
        Format of the text.
    graph : bool, optional
        Draw which equation follows from which, as SVG.
    out : Path, optional
        File for the text; a file ending in .csv or .npz receives the rows, and one ending in .json
        the whole answer with its command and versions.
    damping : str, optional
        Polynomial h(y) of another cell.
    stiffness : str, optional
        Polynomial g(y) of another cell.
    coupling : str, optional
        Coupling of another chain (default c).
    weights : str, optional
        Weights of the springs to nearest, second … neighbours.
    value : sequence of str, optional
        Value of a symbol of the chain, as in a=4; may be repeated.
    no_front : bool, optional
        For a cell, derive only the averaged equation and its cycles.
    quiet : bool, optional
        Whether the answer is printed as JSON.
    """
    if name is not None and name.isdecimal():
        if equation is not None:
            raise UsageError(f"one equation at a time: leave out {name} or --equation {equation}.")
        equation, name = int(name), None
    if no_front and name != "cell":
        raise UsageError("--no-front belongs to 'cell'.")
    cell = _Cell(
        damping=damping, stiffness=stiffness, coupling=coupling, weights=weights, values=value
    )
    if cell.given and name != "cell" and name not in catalogue.WITH_MODEL:
        names = ", ".join(("cell", *catalogue.WITH_MODEL))
        raise UsageError(
            f"--damping, --stiffness, --coupling, --weights and --value belong to {names}."
        )
    if out is not None:
        check_writable(out)
        ending = out.suffix.lower()
        if ending in NOT_TEXT or (ending == ".svg" and not graph):
            raise UsageError(
                f"--out {out} would contain text: name a file ending in .txt, .tex, .csv, .npz or "
                ".json, or one ending in .svg with --graph."
            )
    if graph:
        answer = _graph(name, order, equation)
    elif name is None and equation is None:
        answer = _listing()
    elif name == "all":
        answer = _all(equation, format, quiet)
    elif name == "cell":
        answer = _cell(cell, order, equation, format, not no_front)
    else:
        name = name or catalogue.owner(equation or 0)
        answer = _one(name, order, equation, format, cell.model() if cell.given else None)
    if out is None:
        return answer
    asked = {"name": name, "order": order, "equation": equation, **vars(cell)}
    return _written(answer, out, asked, format)


@dataclass(frozen=True, kw_only=True)
class _Cell:
    """Another chain, described by options; the rest is as in Eq. (8)."""

    damping: str | None
    stiffness: str | None
    coupling: str | None
    weights: str | None
    values: Sequence[str]

    @property
    def given(self) -> bool:
        """Whether any of these options was given."""
        return any(vars(self).values())

    @property
    def numbers(self) -> dict[str, str]:
        """The given values of symbols, by name."""
        from theory.chains.site_values import pairs

        return pairs("value", self.values)

    def model(self) -> ChainModel:
        """Return the chain."""
        from derivations.cell.polynomial_input import chain_of

        return chain_of(self.damping, self.stiffness, self.coupling, self.weights, self.numbers)


def _written(answer: Answer, out: Path, asked: Mapping[str, Any], form: str) -> Answer:
    """Write the text, the rows or the whole answer to a file, depending on its ending."""
    ending = out.suffix.lower()
    if ending in TABLES or (ending == ".json" and form == "text"):
        rows = next((name for name in _ROWS if name in answer.payload), None)
        if rows is None:
            raise UsageError(f"{out} cannot be written: this answer has no rows.")
        return with_table(answer, rows, out, asked)
    write_by(out, lambda path: _write(path, answer.text))
    return Answer(answer.payload, f"wrote {out}", answer.exit_code)


_ROWS = ("steps", "equations", "derivations")
"""Entries of an answer that are lists of rows."""


def _write(path: Path, words: str) -> None:
    path.write_text(words + "\n", encoding="utf-8")


def _listing() -> Answer:
    rows = [{"name": name, "derives": line, "equations": numbers}
            for name, (_, line, numbers) in catalogue.LISTING.items()]  # fmt: skip
    lines = [f"  {row['name']:<16} {row['equations']:<9} {row['derives']}" for row in rows]
    lines += ["  all              1-54      the verdict on every printed equation",
              "  cell                       the average of your own oscillator"]  # fmt: skip
    return Answer({"derivations": rows}, "\n".join(lines))


def _graph(name: str | None, order: int, equation: int | None) -> Answer:
    if equation is not None or name == "cell":
        raise UsageError("--graph draws all equations, or those of one derivation.")
    from derivations.graph import graph_of, svg

    one = () if name is None or name == "all" else (catalogue.load(name, order),)
    made = one or catalogue.everything()
    graph = graph_of(made)
    payload = {"sources": {key: list(found) for key, found in graph.sources.items()},
               "kinds": {key: step.kind.value for key, step in graph.steps.items()}}  # fmt: skip
    return Answer(payload, svg(made))


def _one(
    name: str, order: int, equation: int | None, form: str, model: ChainModel | None
) -> Answer:
    if name not in catalogue.LISTING:
        names = ", ".join((*catalogue.LISTING, "all", "cell"))
        raise UsageError(f"'{name}' is not a derivation: choose one of {names}.")
    derivation = catalogue.load(name, order, model)
    if equation is None:
        return _shown(derivation, form)
    single = derivation.only(equation)
    answer = _shown(single, form)
    if model is not None:  # the paper says nothing about another chain
        return answer
    from derivations.judgement import judge, printed

    judgement = judge(printed(equation), single)
    payload = {**answer.payload, "judgement": judgement.record()}
    text = answer.text
    if form == "text":
        text = f"{text}\n\n{_verdict_lines(judgement)}"
    elif form == "json":
        text = json.dumps(payload)
    return Answer(payload, text, answer.exit_code or int(not judgement.confirmed))


def _verdict_lines(judgement: EquationJudgement) -> str:
    printed = judgement.printed
    lines = [f"In print: {printed.verdict.value}. {printed.note}"]
    if printed.affects:
        lines.append(f"  Affected: {printed.affects}")
    for reading, found in zip(printed.readings, judgement.on_readings, strict=True):
        lines.append(f"  Read as: {reading.meaning}: {'holds' if found.holds else 'does not hold'}"
                     f" ({reading.implies}). {found.statement}")  # fmt: skip
    if not judgement.on_print.holds:
        lines.append(f"  The check on print: {judgement.on_print.statement}")
    if not judgement.confirmed:
        lines.append("  The checks did NOT confirm this verdict.")
    return "\n".join(lines)


def _shown(derivation: Derivation, form: str) -> Answer:
    from derivations.algebra import rendering

    payload: dict[str, Any] = rendering.records(derivation)
    text = json.dumps(payload) if form == "json" else rendering.shown(derivation, form)
    return Answer(payload, text, 0 if payload["complete"] else 1)


def _all(equation: int | None, form: str, as_json: bool) -> Answer:
    from derivations import judgement
    from derivations.algebra import rendering

    if equation is not None:
        raise UsageError("'all' has no single equation: leave out 'all' or --equation.")
    if form in ("latex", "mathml") and not as_json:
        made = catalogue.everything()
        steps = [step for each in made for step in each.steps]
        with Progress("derivations") as live:
            for done, step in enumerate(steps, start=1):
                step.verify()
                live.report(done / len(steps))
        if form == "latex":
            return Answer({}, rendering.document(*made))
        return Answer({}, "\n".join(rendering.mathml(each) for each in made))
    with Progress("equations", quiet=as_json) as live:
        found = judgement.report(progress=live.report)
    payload = {"equations": [each.record() for each in found.judgements],
               "failures": list(found.failures), "seconds": round(found.seconds, 3)}  # fmt: skip
    code = int(bool(found.failures))
    if form == "json":
        return Answer(payload, json.dumps(payload), code)
    if form == "markdown":
        from derivations.verdict_page import page

        return Answer(payload, page(found), code)
    lines = []
    for each in found.judgements:
        lines.append(f"({each.printed.number})".rjust(4) + f" {each.printed.verdict.value:<12} "
                     f"{each.step.kind.value:<10} {each.printed.note}")  # fmt: skip
    lines += ["", *(f"FAILED: {failure}" for failure in found.failures)]
    lines.append(f"{len(found.judgements)} equations, {found.seconds:.1f} s")
    return Answer(payload, "\n".join(lines), code)


def _cell(cell: _Cell, order: int, equation: int | None, form: str, front: bool) -> Answer:
    if cell.damping is None:
        raise UsageError('a cell needs its damping, as in --damping "1 - a*y**2 + b*y**4".')
    if equation is not None or cell.weights is not None:
        raise UsageError("'cell' takes neither --equation nor --weights: a cell has no equation "
                         "number in the paper, and no neighbours.")  # fmt: skip
    if order not in (1, 2):
        raise UsageError(f"--order {order} is not allowed: it must be 1 or 2.")
    from derivations.algebra.errors import DerivationInputError
    from derivations.cell.envelope import derive_envelope
    from fronts.checking import DerivedCell

    begin = perf_counter()
    averaged = derive_envelope(cell.damping, cell.stiffness, cell.coupling or "c")
    envelope = replace(averaged.with_values(cell.numbers), order=order, front=front)
    if front:
        try:
            envelope.kinetic_relation()
        except DerivationInputError as error:
            remedy = f"{error.remedy}; for its averaged equation alone add --no-front"
            raise DerivationInputError(
                error.quantity, error.value, error.allowed, remedy
            ) from None  # fmt: skip
    answer = _shown(envelope.derivation, form)
    found = DerivedCell(envelope=envelope, seconds=perf_counter() - begin)
    payload = {**answer.payload, **found.to_dict()}
    text = json.dumps(payload) if form == "json" else answer.text
    return Answer(payload, text, answer.exit_code)
