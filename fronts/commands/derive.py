"""``fronts derive``: derivations step by step, the verdict on each equation, and new cells.

SymPy is imported only when something is derived; the listing must stay fast.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from derivations import catalogue
from fronts.answer import Answer, UsageError
from fronts.arguments import check_writable, whole, write_whole

if TYPE_CHECKING:
    from derivations.derivation import Derivation
    from derivations.printed import Judgement

EXAMPLE = """examples:
  fronts derive                                         list the derivations
  fronts derive multiple-scales --order 2               one of them, to second order
  fronts derive --equation 34                           one equation, its check and its verdict
  fronts derive linearisation --format latex --out jacobian.tex
  fronts derive all                                     the verdict on each of Eqs. 1-54
  fronts derive cell --damping "1 - a*y**2 + b*y**4" --value a=4 --value b=0.5"""

FORMATS = ("text", "latex", "mathml", "json")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("name", nargs="?", metavar="NAME",
                        help=f"{', '.join(catalogue.LISTING)}, all, or cell")  # fmt: skip
    parser.add_argument("--order", type=whole, default=1, help="1 or 2, the power of eps")
    parser.add_argument("--equation", type=whole, metavar="N", help="only this equation")
    parser.add_argument("--format", choices=FORMATS, default="text")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write there instead")
    parser.add_argument("--damping", metavar="POLYNOMIAL", help="h(y) of a new cell")
    parser.add_argument("--stiffness", metavar="POLYNOMIAL", help="g(y) of a new cell")
    parser.add_argument("--coupling", metavar="C", help="coupling of a new cell (default c)")
    parser.add_argument("--value", action="append", metavar="NAME=NUMBER", default=[],
                        help="a number for a letter of the new cell; repeat for more")  # fmt: skip
    parser.add_argument("--no-front", action="store_true",
                        help="of a new cell only the averaged equation and its cycles")  # fmt: skip


def run(args: argparse.Namespace) -> Answer:
    """Carry out the command."""
    cell_options = args.damping or args.stiffness or args.coupling or args.value or args.no_front
    if args.name != "cell" and cell_options:
        raise UsageError(
            "--damping, --stiffness, --coupling, --value and --no-front belong to 'cell'."
        )
    if args.out is not None:
        check_writable(args.out)
    if args.name is None and args.equation is None:
        answer = _listing()
    elif args.name == "all":
        answer = _all(args)
    elif args.name == "cell":
        answer = _cell(args)
    else:
        answer = _one(args)
    if args.out is None:
        return answer
    write_whole(args.out, lambda path: _write(path, answer.text))
    return Answer(answer.payload, f"wrote {args.out}", answer.exit_code)


def _write(path: Path, words: str) -> None:
    path.write_text(words + "\n", encoding="utf-8")


def _listing() -> Answer:
    rows = [{"name": name, "derives": line, "equations": numbers}
            for name, (_, line, numbers) in catalogue.LISTING.items()]  # fmt: skip
    lines = [f"  {row['name']:<16} {row['equations']:<6} {row['derives']}" for row in rows]
    lines += ["  all              1-54   the verdict on every printed equation",
              "  cell                    the averaged equation of your own oscillator"]  # fmt: skip
    return Answer({"derivations": rows}, "\n".join(lines))


def _one(args: argparse.Namespace) -> Answer:
    name = args.name or catalogue.owner(args.equation)
    if name not in catalogue.LISTING:
        names = ", ".join((*catalogue.LISTING, "all", "cell"))
        raise UsageError(f"'{name}' is not a derivation: choose one of {names}.")
    derivation = catalogue.load(name, args.order)
    if args.equation is None:
        return _shown(derivation, args.format)
    from derivations.printed import judge, printed

    judgement = judge(printed(args.equation), derivation.only(args.equation))
    answer = _shown(derivation.only(args.equation), args.format)
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
    from derivations import rendering

    payload: dict[str, Any] = rendering.records(derivation)
    text = json.dumps(payload) if form == "json" else rendering.shown(derivation, form)
    return Answer(payload, text, 0 if payload["complete"] else 1)


def _all(args: argparse.Namespace) -> Answer:
    from derivations import printed, rendering

    if args.equation is not None:
        raise UsageError("'all' has no single equation: leave out 'all' or --equation.")
    if args.format in ("latex", "mathml") and not args.json:
        derivations = [catalogue.load(name) for name in catalogue.NUMBERED]
        derivations.append(catalogue.load("second-order"))
        if args.format == "latex":
            return Answer({}, rendering.document(*derivations))
        return Answer({}, "\n".join(rendering.mathml(each) for each in derivations))
    found = printed.report()
    payload = {"equations": [each.record() for each in found.judgements],
               "failures": list(found.failures), "seconds": round(found.seconds, 3)}  # fmt: skip
    if args.format == "json":
        return Answer(payload, json.dumps(payload), int(bool(found.failures)))
    lines = []
    for each in found.judgements:
        lines.append(f"({each.printed.number})".rjust(4) + f" {each.printed.verdict.value:<10} "
                     f"{each.printed.note}")  # fmt: skip
    lines += ["", *(f"FAILED: {failure}" for failure in found.failures)]
    lines.append(f"{len(found.judgements)} equations, {found.seconds:.1f} s")
    return Answer(payload, "\n".join(lines), int(bool(found.failures)))


def _cell(args: argparse.Namespace) -> Answer:
    if args.damping is None:
        raise UsageError('a cell needs its damping, as in --damping "1 - a*y**2 + b*y**4".')
    if args.equation is not None or args.order != 1:
        raise UsageError("'cell' takes neither --equation nor --order: it averages to first order.")
    from derivations.averaging.cell import derive
    from derivations.averaging.envelope import derive_envelope
    from derivations.algebra.errors import DerivationInputError

    envelope = derive_envelope(args.damping, args.stiffness, args.coupling or "c")
    envelope = envelope.with_values(_values(args.value))
    answer = _shown(derive(envelope), args.format)
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


def _pair(envelope: Any) -> tuple[str, str]:
    from derivations.rendering import equation_latex

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
