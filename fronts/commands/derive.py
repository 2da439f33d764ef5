"""``fronts derive``: derivations step by step, the verdict on each equation, and other chains.

SymPy is imported only when something is derived; the listing must stay fast.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from derivations import catalogue
from fronts.answer import Answer, UsageError
from fronts.arguments import check_writable, whole
from verification.execution.files import write_by

if TYPE_CHECKING:
    from derivations.algebra.steps import Derivation
    from derivations.cell.envelope import Envelope
    from derivations.chain import ChainModel
    from derivations.judgement import Judgement

EXAMPLE = """examples:
  fronts derive                                         list the derivations
  fronts derive multiple-scales --order 2               one of them, to second order
  fronts derive multiple-scales --damping "1 - a*y**2 + b*y**6" --stiffness "g*y**3"
  fronts derive averaging --weights "1, w"              with springs to the second neighbours
  fronts derive --equation 34                           one equation, its check and its verdict
  fronts derive linearisation --format latex --out jacobian.tex
  fronts derive all                                     the verdict on each of Eqs. 1-54
  fronts derive --graph --out equations.svg             which equation follows from which
  fronts derive cell --damping "1 - a*y**2 + b*y**4" --value a=4 --value b=0.5 --order 2"""

FORMATS = ("text", "latex", "mathml", "markdown", "json")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("name", nargs="?", metavar="NAME",
                        help=f"{', '.join(catalogue.LISTING)}, all, or cell")  # fmt: skip
    parser.add_argument("--order", type=whole, default=1, help="1 or 2, the power of eps")
    parser.add_argument("--equation", type=whole, metavar="N", help="only this equation")
    parser.add_argument("--format", choices=FORMATS, default="text")
    parser.add_argument("--graph", action="store_true",
                        help="draw which equation follows from which, as SVG")  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="FILE", help="write there instead")
    parser.add_argument("--damping", metavar="POLYNOMIAL", help="h(y) of another cell")
    parser.add_argument("--stiffness", metavar="POLYNOMIAL", help="g(y) of another cell")
    parser.add_argument("--coupling", metavar="C", help="coupling of another chain (default c)")
    parser.add_argument("--weights", metavar="LIST",
                        help="weights of the springs to nearest, second … neighbours")  # fmt: skip
    parser.add_argument("--value", action="append", metavar="NAME=NUMBER", default=[],
                        help="a number for a letter of the chain; repeat for more")  # fmt: skip
    parser.add_argument("--no-front", action="store_true",
                        help="of a cell only the averaged equation and its cycles")  # fmt: skip


def run(args: argparse.Namespace) -> Answer:
    """Carry out the command."""
    if args.no_front and args.name != "cell":
        raise UsageError("--no-front belongs to 'cell'.")
    other = bool(args.damping or args.stiffness or args.coupling or args.weights or args.value)
    if other and args.name != "cell" and args.name not in catalogue.WITH_MODEL:
        names = ", ".join(("cell", *catalogue.WITH_MODEL))
        raise UsageError(
            f"--damping, --stiffness, --coupling, --weights and --value belong to {names}."
        )
    if args.out is not None:
        check_writable(args.out)
    answer = _answer(args, other)
    if args.out is None:
        return answer
    write_by(args.out, lambda path: _write(path, answer.text))
    return Answer(answer.payload, f"wrote {args.out}", answer.exit_code)


def _answer(args: argparse.Namespace, other: bool) -> Answer:
    if args.graph:
        return _graph(args)
    if args.name is None and args.equation is None:
        return _listing()
    if args.name == "all":
        return _all(args)
    if args.name == "cell":
        return _cell(args)
    return _one(args, _model(args) if other else None)


def _write(path: Path, words: str) -> None:
    path.write_text(words + "\n", encoding="utf-8")


def _listing() -> Answer:
    rows = [{"name": name, "derives": line, "equations": numbers}
            for name, (_, line, numbers) in catalogue.LISTING.items()]  # fmt: skip
    lines = [f"  {row['name']:<16} {row['equations']:<9} {row['derives']}" for row in rows]
    lines += ["  all              1-54      the verdict on every printed equation",
              "  cell                       the average of your own oscillator"]  # fmt: skip
    return Answer({"derivations": rows}, "\n".join(lines))


def _graph(args: argparse.Namespace) -> Answer:
    if args.equation is not None or args.name == "cell":
        raise UsageError("--graph draws all equations, or those of one derivation.")
    from derivations.graph import graph_of, svg

    whole_paper = args.name in (None, "all")
    made = catalogue.everything() if whole_paper else (catalogue.load(args.name, args.order),)
    graph = graph_of(made)
    payload = {"sources": {key: list(found) for key, found in graph.sources.items()},
               "kinds": {key: step.kind.value for key, step in graph.steps.items()}}  # fmt: skip
    return Answer(payload, svg(made))


def _model(args: argparse.Namespace) -> ChainModel:
    """Return the chain that the options describe; what is left out is as in Eq. (8)."""
    from derivations.cell.polynomial_input import chain_of

    return chain_of(args.damping, args.stiffness, args.coupling, args.weights, _values(args.value))


def _one(args: argparse.Namespace, model: ChainModel | None) -> Answer:
    name = args.name or catalogue.owner(args.equation)
    if name not in catalogue.LISTING:
        names = ", ".join((*catalogue.LISTING, "all", "cell"))
        raise UsageError(f"'{name}' is not a derivation: choose one of {names}.")
    derivation = catalogue.load(name, args.order, model)
    if args.equation is None:
        return _shown(derivation, args.format)
    single = derivation.only(args.equation)
    answer = _shown(single, args.format)
    if model is not None:  # print says nothing about another chain
        return answer
    from derivations.judgement import judge, printed

    judgement = judge(printed(args.equation), single)
    payload = {**answer.payload, "judgement": judgement.record()}
    text = answer.text
    if args.format == "text":
        text = f"{text}\n\n{_verdict_lines(judgement)}"
    elif args.format == "json":
        text = json.dumps(payload)
    return Answer(payload, text, answer.exit_code or int(not judgement.confirmed))


def _verdict_lines(judgement: Judgement) -> str:
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


def _all(args: argparse.Namespace) -> Answer:
    from derivations import judgement
    from derivations.algebra import rendering

    if args.equation is not None:
        raise UsageError("'all' has no single equation: leave out 'all' or --equation.")
    if args.format in ("latex", "mathml") and not args.json:
        made = catalogue.everything()
        if args.format == "latex":
            return Answer({}, rendering.document(*made))
        return Answer({}, "\n".join(rendering.mathml(each) for each in made))
    found = judgement.report()
    payload = {"equations": [each.record() for each in found.judgements],
               "failures": list(found.failures), "seconds": round(found.seconds, 3)}  # fmt: skip
    code = int(bool(found.failures))
    if args.format == "json":
        return Answer(payload, json.dumps(payload), code)
    if args.format == "markdown":
        from derivations.verdict_page import page

        return Answer(payload, page(found), code)
    lines = []
    for each in found.judgements:
        lines.append(f"({each.printed.number})".rjust(4) + f" {each.printed.verdict.value:<12} "
                     f"{each.step.kind.value:<10} {each.printed.note}")  # fmt: skip
    lines += ["", *(f"FAILED: {failure}" for failure in found.failures)]
    lines.append(f"{len(found.judgements)} equations, {found.seconds:.1f} s")
    return Answer(payload, "\n".join(lines), code)


def _cell(args: argparse.Namespace) -> Answer:
    if args.damping is None:
        raise UsageError('a cell needs its damping, as in --damping "1 - a*y**2 + b*y**4".')
    if args.equation is not None or args.weights is not None:
        raise UsageError("'cell' takes neither --equation nor --weights: a cell has no number in "
                         "the paper, and nearest neighbours.")  # fmt: skip
    if args.order not in (1, 2):
        raise UsageError(f"--order {args.order} is not allowed: it must be 1 or 2.")
    from derivations.algebra.errors import DerivationInputError
    from derivations.cell.envelope import derive_envelope
    from derivations.cell.steps import derive

    envelope = derive_envelope(args.damping, args.stiffness, args.coupling or "c")
    envelope = envelope.with_values(_values(args.value))
    derivation = derive(envelope.model, args.order, front=not args.no_front)
    answer = _shown(derivation, args.format)
    payload = dict(answer.payload)
    payload["averaged"], payload["amplitude"] = _pair(envelope)
    try:
        payload["cycles"] = [
            {"amplitude": str(cycle.amplitude), "value": _number(cycle.amplitude),
             "stability": cycle.stability, "multiplicity": cycle.multiplicity}
            for cycle in envelope.cycles
        ]  # fmt: skip
        if not args.no_front:
            relation = envelope.kinetic_relation()
            payload["ratio"] = {"expression": str(relation.ratio), "value": _number(relation.ratio)}
    except DerivationInputError as error:
        if not args.no_front:
            remedy = f"{error.remedy}; for its averaged equation alone add --no-front"
            raise DerivationInputError(
                error.quantity, error.value, error.allowed, remedy
            ) from None  # fmt: skip
        payload["cycles"] = None  # no closed form
    text = json.dumps(payload) if args.format == "json" else answer.text
    return Answer(payload, text, answer.exit_code)


def _pair(envelope: Envelope) -> tuple[str, str]:
    from derivations.algebra.rendering import equation_latex

    return equation_latex(envelope.equation), equation_latex(envelope.amplitude_equation)


def _number(expression: Any) -> float | None:
    return None if expression.free_symbols else float(expression)


def _values(pairs: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for pair in pairs:
        name, equals, number = pair.partition("=")
        if not equals or not name or not number:
            raise UsageError(f"--value {pair} is not NAME=NUMBER, as in --value a=4.")
        if name in found:
            raise UsageError(f"--value gives {name} twice.")
        found[name] = number
    return found
