"""``python -m benchmarks.mutation``: change one thing in the code and see whether a test fails."""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

from benchmarks.mutation import entered
from benchmarks.mutation.mutants import Mutant, by_statement, mutants_of
from benchmarks.mutation.outcome import (
    KILLED,
    MutationOutcome,
    read_explained,
    stamp,
    still_known,
)

ROOT = Path(__file__).resolve().parents[2]
LONGER = 10.0
"""Factor of the time for tests in a second run of the changes that the first leaves open."""

EXAMPLE = """examples:
  python -m benchmarks.mutation theory                         every change of theory/
  python -m benchmarks.mutation theory/piecewise/limits.py --list        its changes, without a run
  python -m benchmarks.mutation verification paper_checks fronts --part 0.1
      a tenth of the changes, chosen at random, different in every run
  python -m benchmarks.mutation derivations/averaging/steps.py --each
      one change of each statement, chosen at random
  python -m benchmarks.mutation --again fronts.json --record fronts.json
      the changes left unnoticed or untested in a record, and all changes of the modules that have
      been edited since; the new record contains both

Changes chosen at random are tested in random order, so that those tested within --minutes are a
random sample too. The working tree is not modified, and must not be edited during a run. Changes in
code compiled by numba are tested with --compiled, and all others without it; they take longer,
since the code is compiled again. A change in derivations/ that no test notices is submitted, after
all tests, to the checks of the derivation steps that use it; for this purpose all equations are
derived and checked once, which takes a minute. --record writes the counts and every unnoticed
change to a file. The exit code is 1 if an unnoticed change is not explained in
benchmarks/mutation/explained, or if an explanation there is no longer needed; the latter is
determined only if all changes of a module were tested."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    parser = _parser()
    options = parser.parse_args(arguments)
    if bool(options.where) == bool(options.again):
        parser.error("give modules or packages, or --again and a record that names them")
    if options.unchanged and options.record:
        parser.error("--unchanged changes nothing, so that there is nothing to --record")
    before = json.loads(options.again.read_text(encoding="utf-8")) if options.again else {}
    names = ("where", "part", "each", "seed")
    selection = {name: getattr(options, name) for name in names} | before.get("selection", {})
    where, part, each, seed = (selection.get(name) for name in names)
    seed = random.SystemRandom().randrange(10**6) if seed is None else seed
    try:
        every = chosen(ROOT, where, part, seed, each=each)
    except OSError as error:
        print(f"mutation: {error.filename} is not a module or package here.", file=sys.stderr)
        return 2
    explained = read_explained()
    known = still_known(before, every, ROOT, explained) if before else {}
    mutants = [mutant for mutant in every if mutant.name not in known]
    if options.list:
        print("\n".join(f"{mutant.line:5} {mutant.name}" for mutant in mutants))
        return 0
    whole = part == 1.0 and not before and not each
    if not whole:
        print(f"seed {seed}", file=sys.stderr)
        random.Random(seed).shuffle(mutants)
    if options.unchanged:
        mutants = [replace(mutant, changed=mutant.place.node) for mutant in mutants]
    mutants, found = run(mutants, options, explained)
    if options.unchanged:
        noticed = sum(status == KILLED for status in found.values())
        print(f"{len(found)} runs of unchanged code; {noticed} of them had a failing test")
        return 1 if noticed else 0
    left = {mutant.name for mutant in mutants} | known.keys()
    outcome = MutationOutcome([m for m in every if m.name in left], found | known, explained)
    print(outcome)
    if options.record:
        asked = {name: getattr(options, name) for name in ("tests", "seconds", "longest")}
        runs = [*before.get("runs", ()), {**stamp(ROOT), "changes": len(found), **asked}]
        selection = {"where": where, "part": part, "each": each, "seed": seed}
        selection["left_out"] = [mutant.name for mutant in every if mutant.name not in left]
        outcome.write(options.record, ROOT, selection, runs)
    # For a selection, only the explanations of its own changes can be judged.
    stale = outcome.stale if whole and len(found) == len(mutants) else []
    for form in stale:
        print(f"NO LONGER NEEDED {form}")
    return 1 if outcome.open or stale else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.mutation",
        description="Change one place of the code at a time; list what no test notices.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add(
        "where", nargs="*", help="packages or modules, such as theory or theory/piecewise/limits.py"
    )
    add(
        "--part",
        type=float,
        default=1.0,
        help="fraction of the changes of each module, chosen at random (default 1)",
    )
    add("--each", action="store_true", help="choose from one change of each statement only")
    add(
        "--seed", type=int, help="seed of the random choice (default: a different one in every run)"
    )
    add(
        "--again",
        type=Path,
        metavar="RECORD",
        help="test the changes left unnoticed or untested in this record, and all changes of "
        "modules edited since",
    )
    add("--compiled", action="store_true", help="change only code compiled by numba")
    add(
        "--unchanged",
        action="store_true",
        help="do everything as for a change, but change nothing: a test that fails then shows a "
        "fault of the run",
    )
    add("--tests", nargs="+", default=(), metavar="FILE", help="test files to run (default: all)")
    add(
        "--seconds",
        type=float,
        default=0.6,
        help="processor time for the tests of one change, in seconds (default 0.6); changes that "
        "are then neither noticed nor explained are run again for ten times as long",
    )
    add(
        "--longest",
        type=float,
        default=0.3,
        help="longest processor time of a test that is run, in seconds (default 0.3)",
    )
    add("--jobs", type=int, default=2, choices=(1, 2), help="number of processes (default 2)")
    add("--minutes", type=float, help="time after which no further change is tested")
    add("--list", action="store_true", help="list the changes without testing them")
    add("--record", type=Path, metavar="FILE", help="write the outcome to a JSON file")
    return parser


def chosen(
    root: Path, where: Sequence[str], part: float, seed: int, *, each: bool = False
) -> list[Mutant]:
    """Return the requested changes, in the order of modules and lines.

    The ``__main__`` of a package is left out, because it runs when it is imported.
    """
    picked: list[Mutant] = []
    for name in where:
        path = root / name
        for module in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            relative = module.relative_to(root).as_posix()
            if path.is_dir() and module.name == "__main__.py":
                continue
            all_ = mutants_of(relative, module.read_text(encoding="utf-8"))
            chance = random.Random(f"{seed}:{relative}")
            if each:
                all_ = [chance.choice(of_one) for of_one in by_statement(all_)]
            if part < 1.0:
                count = int(part * len(all_) + chance.random())  # sometimes one, for a short module
                kept = set(chance.sample(range(len(all_)), count))
                all_ = [mutant for i, mutant in enumerate(all_) if i in kept]
            picked += all_
    return picked


def run(
    mutants: list[Mutant], options: argparse.Namespace, explained: Mapping[str, str]
) -> tuple[list[Mutant], dict[str, str]]:
    """Run the changes, and return those not left out with the outcome of each that was run.

    Those that are neither noticed nor explained are then run again for longer.
    """
    until = time.monotonic() + 60.0 * (options.minutes or 1e9)
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    names = entered.install(ROOT)  # before any module of the project is imported
    from benchmarks.mutation.children import in_children
    from benchmarks.mutation.recompiled import compile_everything
    from benchmarks.mutation.recorder import forget
    from benchmarks.mutation.records import Records
    from benchmarks.mutation.runs import Runs
    from benchmarks.mutation.session import Session
    from benchmarks.mutation.survey import closures, survey, test_files

    modules = list(dict.fromkeys(mutant.module for mutant in mutants))
    imported = closures(ROOT, options.tests or test_files(ROOT))
    imported = {file: near for file, near in imported.items() if near & set(modules)}
    mark = sha256(str(ROOT).encode()).hexdigest()[:8]
    kept = Path(tempfile.gettempdir()) / f"fronts-mutation-{mark}.jsonl"
    session = Session(ROOT, names)
    ran: list[Runs] = []

    def work() -> None:
        for module in session.missing.keys() & set(modules):
            library = session.missing[module]
            print(f"{module} is left out: {library} is not installed", file=sys.stderr)
        mutants[:] = [mutant for mutant in mutants if mutant.module not in session.missing]
        begin = time.monotonic()
        records = Records(ROOT, kept, options.longest)
        known = survey(session, records, imported, options.longest, options.jobs)
        took = time.monotonic() - begin
        ran.append(Runs(session, known, imported, options.seconds))
        asked = f"{len(known.seconds)} of {len(session.items)} tests are used"
        print(f"{asked}; recorded in {took:.0f} s", file=sys.stderr, flush=True)
        count, kind = len(mutants), "not compiled" if options.compiled else "compiled"
        mutants[:] = [m for m in mutants if (m.qualified in entered.compiled) is options.compiled]
        print(f"{count - len(mutants)} changes in code {kind} by numba are left out",
              file=sys.stderr)  # fmt: skip
        if options.compiled:
            compile_everything()
        with suppress(KeyboardInterrupt):  # the changes run so far are reported
            in_children(ran[0].tasks(mutants, until), options.jobs)
            more = MutationOutcome(mutants, ran[0].found, explained).unnoticed
            if more and not options.unchanged:
                ran[0].seconds *= LONGER
                print(f"{len(more)} changes again, with tests for {ran[0].seconds:g} s each",
                      file=sys.stderr)  # fmt: skip
                in_children(ran[0].tasks(more, until), options.jobs)
            # These take seconds to a minute each, and therefore come after all tests.
            if any(module.startswith("derivations/") for module in modules):
                from benchmarks.mutation.derived import DerivationChecks

                checks = DerivationChecks(names, forget)
                in_children(ran[0].tasks_of_checks(mutants, checks, until), options.jobs)

    code = session.collect(list(imported), work)
    if not ran:
        sys.exit(f"mutation: no tests were collected; pytest's exit code is {code}.")
    return mutants, ran[0].found


if __name__ == "__main__":
    sys.exit(main())
