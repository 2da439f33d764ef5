"""``python -m benchmarks.mutation``: change one thing in the code and see whether a test fails."""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import tempfile
import time
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

from benchmarks.mutation import entered
from benchmarks.mutation.explained import read_explained, stale_entries
from benchmarks.mutation.mutants import Mutant, mutants_of
from benchmarks.mutation.outcome import counts, write_record

ROOT = Path(__file__).resolve().parents[2]
LEFT_OUT = "left out"
EXAMPLE = """examples:
  python -m benchmarks.mutation theory                         every change of theory/
  python -m benchmarks.mutation theory/piecewise/limits.py --list        the changes, nothing run
  python -m benchmarks.mutation verification paper_checks fronts --part 0.1
      a tenth at random, another one each time
  python -m benchmarks.mutation fronts --open fronts.json      what a record left open, again

Changes chosen at random are run in random order, so that those run before the time is over
(--minutes) are a sample too. The working tree is not touched. What numba compiles is compiled anew
for each change of it, half a minute or more: such changes are left out unless --compiled asks for
them. --record writes the counts and every change that went unnoticed to a file. Exit code 1: a
change that no test notices is not explained in benchmarks/mutation/explained.toml, or an
explanation there is no longer needed; the latter is judged when all of a module was run."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    options = _parser().parse_args(arguments)
    try:
        mutants = _selected(options)
    except OSError as error:
        print(f"mutation: {error.filename} is not a module or package here.", file=sys.stderr)
        return 2
    if options.list:
        print("\n".join(f"{mutant.line:5} {mutant.name}" for mutant in mutants))
        return 0
    found = _run(mutants, options)
    mutants = [mutant for mutant in mutants if found.get(mutant.name) != LEFT_OUT]
    found = {name: status for name, status in found.items() if status != LEFT_OUT}
    explained = read_explained(Path(__file__).with_name("explained.toml"))
    survivors = [mutant for mutant in mutants if found.get(mutant.name) == "survived"]
    reasons = {m.name: explained.why(m.name) for m in survivors}
    print(table(mutants, found, reasons))
    open_ = [mutant for mutant in survivors if reasons[mutant.name] is None]
    for mutant in open_:
        print(f"NOT NOTICED {mutant.module}:{mutant.line} {mutant.function}: {mutant.change}")
    if options.record:
        write_record(
            options.record, ROOT, command=command_line(arguments), mutants=mutants, found=found,
            reasons=reasons,
        )  # fmt: skip
    # Of a selection only those explanations can be judged that are about its changes.
    whole = options.part == 1.0 and not options.function and not options.open
    stale = stale_entries(explained, mutants, found) if whole and len(found) == len(mutants) else []
    for entry in stale:
        print(f"NO LONGER NEEDED {entry}")
    return 1 if open_ or stale else 0


def _selected(options: argparse.Namespace) -> list[Mutant]:
    """Return the changes that are asked for, a part of them in random order."""
    seed = random.SystemRandom().randrange(10**6) if options.seed is None else options.seed
    mutants = chosen(ROOT, options.where, options.part, seed, options.function or "")
    if options.open:
        left = set(json.loads(options.open.read_text(encoding="utf-8"))["open"])
        mutants = [mutant for mutant in mutants if mutant.name in left]
    if options.part < 1.0:
        print(f"seed {seed}", file=sys.stderr)
        random.Random(seed).shuffle(mutants)
    return mutants


def _run(mutants: Sequence[Mutant], options: argparse.Namespace) -> dict[str, str]:
    """Return what became of the changes, by name."""
    until = time.monotonic() + 60.0 * (options.minutes or 1e9)
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    names = entered.install(ROOT)
    from benchmarks.mutation.runs import Runs
    from benchmarks.mutation.session import Session, in_children
    from benchmarks.mutation.survey import closure, survey, test_files

    imported = {file: closure(ROOT, file) for file in options.tests or test_files(ROOT)}
    modules = modules_of(mutants)
    imported = {file: near for file, near in imported.items() if near & set(modules)}
    session = Session(ROOT, names)
    found: dict[str, str] = {}

    def work() -> None:
        begin = time.monotonic()
        known = survey(session, kept(ROOT), imported, options.longest, options.jobs)
        print(f"{len(known.seconds)} of {len(session.items)} tests are asked; recorded in "
              f"{time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)  # fmt: skip
        found.update({m.name: LEFT_OUT for m in mutants if _is_compiled(m)})
        if options.compiled:
            found.clear()
        elif found:
            print(f"{len(found)} changes of what numba compiles are left out", file=sys.stderr)
        runs = Runs(session, known, imported, options.seconds)
        in_children(runs.tasks([m for m in mutants if m.name not in found], until), options.jobs)
        found.update(runs.found)
        if options.by:
            for test, count in runs.by.most_common():
                print(f"{count:6} {test}")

    code = session.collect(list(imported), modules, work)
    if not found:
        sys.exit(f"mutation: the tests were not collected, pytest's exit code is {code}.")
    return found


def _is_compiled(mutant: Mutant) -> bool:
    return f"{mutant.module}:{mutant.first_line}" in entered.compiled


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.mutation",
        description="Change one thing at a time; report what no test notices.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "where", nargs="+", help="packages or modules, as theory or theory/piecewise/limits.py"
    )
    parser.add_argument(
        "--part", type=float, default=1.0, help="of each module's changes (default 1)"
    )
    parser.add_argument(
        "--tests", nargs="+", default=(), metavar="FILE", help="ask these only (default: all)"
    )
    parser.add_argument("--seed", type=int, help="chooses the part (default: another each time)")
    parser.add_argument("--function", help="only functions whose qualified name begins so")
    parser.add_argument("--jobs", type=int, default=2, choices=(1, 2), help="processes (default 2)")
    parser.add_argument(
        "--seconds", type=float, default=5.0, help="of tests asked about a change (default 5)"
    )
    parser.add_argument(
        "--longest", type=float, default=1.0, help="seconds of a test that is asked (default 1)"
    )
    parser.add_argument("--minutes", type=float, help="begin no further change after so long")
    parser.add_argument("--list", action="store_true", help="list the changes, run nothing")
    parser.add_argument("--open", type=Path, metavar="RECORD", help="only what it left open")
    parser.add_argument("--compiled", action="store_true", help="also what numba compiles")
    parser.add_argument("--by", action="store_true", help="say how much each test noticed")
    parser.add_argument("--record", type=Path, metavar="FILE", help="write the outcome as JSON")
    return parser


def command_line(arguments: Sequence[str] | None) -> str:
    """Return the command as typed, without the places of copies and record."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    for option in ("--record", "--open"):
        if option in words:
            place = words.index(option)
            del words[place : place + 2]
    return " ".join(["python -m benchmarks.mutation", *words])


def kept(root: Path) -> Path:
    """Return the file that keeps which tests enter what in this working tree, outside of it."""
    mark = sha256(str(root).encode()).hexdigest()[:8]
    return Path(tempfile.gettempdir()) / f"fronts-mutation-{mark}.jsonl"


def chosen(root: Path, where: Sequence[str], part: float, seed: int, function: str) -> list[Mutant]:
    """Return the changes asked for, in the order of modules and lines."""
    picked: list[Mutant] = []
    for name in where:
        path = root / name
        modules = sorted(path.rglob("*.py")) if path.is_dir() else [path]
        for module in modules:
            relative = module.relative_to(root).as_posix()
            all_ = mutants_of(relative, module.read_text(encoding="utf-8"))
            all_ = [mutant for mutant in all_ if mutant.function.startswith(function)]
            if part < 1.0:
                chance = random.Random(f"{seed}:{relative}")
                kept = set(chance.sample(range(len(all_)), round(part * len(all_))))
                all_ = [mutant for i, mutant in enumerate(all_) if i in kept]
            picked += all_
    return picked


def table(mutants: Sequence[Mutant], found: dict[str, str], reasons: dict[str, str | None]) -> str:
    """Return one line a module: changes, run, noticed, explained, not noticed."""
    lines = [f"{'module':40} {'run':>6} {'noticed':>8} {'explained':>10} {'open':>6}"]
    parts = {module: [m for m in mutants if m.module == module] for module in modules_of(mutants)}
    for name, part in {**parts, "all": list(mutants)}.items():
        row = counts(part, found, reasons)
        lines.append(
            f"{name:40} {row['run']:6} {row['noticed']:8} {row['explained']:10} {row['open']:6}"
        )
    left = len(mutants) - len(found)
    return "\n".join(lines) + (f"\n{left} changes were not run." if left > 0 else "")


def modules_of(mutants: Sequence[Mutant]) -> list[str]:
    """Return the modules that are changed, in their order."""
    return list(dict.fromkeys(mutant.module for mutant in mutants))


if __name__ == "__main__":
    sys.exit(main())
