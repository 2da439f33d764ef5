"""``python -m benchmarks.mutation``: change one thing in the code and see whether a test fails."""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.mutation.explained import read_explained, stale_entries
from benchmarks.mutation.mutants import Mutant, mutants_of
from benchmarks.mutation.outcome import counts, write_record
from benchmarks.mutation.runs import Runs, Workers
from verification.execution.digest import digest_of

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = """examples:
  python -m benchmarks.mutation theory                         every change of theory/
  python -m benchmarks.mutation theory/piecewise/limits.py --list        the changes, nothing run
  python -m benchmarks.mutation verification paper_checks fronts --part 0.1 --minutes 9
      a tenth at random, another one each time, as far as nine minutes reach

Changes chosen at random are run in random order, so those that were run are a sample too. Nothing
in the working tree is touched: tests run in copies of it in --work. Results are kept there by the
text of what was changed, so that a run that was stopped goes on where it was. --record writes the
counts and every change that went unnoticed to a file. Exit code 1: a change that no test notices is
not explained in benchmarks/mutation/explained.toml, or an explanation there is no longer needed;
the latter is judged when every change of a module was run."""


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
    whole = options.part == 1.0 and not options.function
    stale = stale_entries(explained, mutants, found) if whole and len(found) == len(mutants) else []
    for entry in stale:
        print(f"NO LONGER NEEDED {entry}")
    return 1 if open_ or stale else 0


def _selected(options: argparse.Namespace) -> list[Mutant]:
    """Return the changes that are asked for, a part of them in random order."""
    seed = random.SystemRandom().randrange(10**6) if options.seed is None else options.seed
    mutants = chosen(ROOT, options.where, options.part, seed, options.function or "")
    if options.part < 1.0:
        print(f"seed {seed}", file=sys.stderr)
        random.Random(seed).shuffle(mutants)
    return mutants


def _run(mutants: Sequence[Mutant], options: argparse.Namespace) -> dict[str, str]:
    """Return what became of the changes, by name."""
    work = options.work or default_work(ROOT)
    work.mkdir(parents=True, exist_ok=True)
    until = time.monotonic() + 60.0 * (options.minutes or 1e9)
    with Workers(ROOT, work, options.jobs) as workers:
        runs = Runs(
            ROOT, work, workers, modules=modules_of(mutants), tests=options.tests,
            seconds=options.seconds, again=options.again,
        )  # fmt: skip
        return runs.run(mutants, until)


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
        "--seconds",
        type=float,
        default=30.0,
        help="of tests spent on a change at most (default 30)",
    )
    parser.add_argument("--minutes", type=float, help="begin no further change after so long")
    parser.add_argument("--list", action="store_true", help="list the changes, run nothing")
    parser.add_argument("--again", action="store_true", help="forget stored results")
    parser.add_argument("--work", type=Path, help="folder of the copies and results")
    parser.add_argument("--record", type=Path, metavar="FILE", help="write the outcome as JSON")
    return parser


def command_line(arguments: Sequence[str] | None) -> str:
    """Return the command as typed, without the places of copies and record."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    for option in ("--work", "--record"):
        if option in words:
            place = words.index(option)
            del words[place : place + 2]
    return " ".join(["python -m benchmarks.mutation", *words])


def default_work(root: Path) -> Path:
    """Return the folder for copies and results of this working tree, outside of it."""
    mark = digest_of(str(root))[:8]
    return Path(tempfile.gettempdir()) / f"fronts-mutation-{mark}"


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
