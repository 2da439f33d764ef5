"""Write down what every command of ``fronts`` answers today, for tests/test_behaviour.py.

    python -m tests.behaviour.record                  every argument set
    python -m tests.behaviour.record sum-series ...   these only; the others stay as recorded

Chains are small and times short: the whole takes some twenty seconds, once the steppers are
compiled. The shared test problems are added, with what the command line gives for them.
What the data mean and how they are compared: `tests.behaviour.replay`.
"""

from __future__ import annotations

import json
import shlex
import sys
import time
from collections.abc import Iterator

from tests.behaviour.replay import DATA, Json, recorded, replay
from verification.quantities.problems import PROBLEMS

CASES = """
kinetic-ordinary | kinetic --c 0.5 --eta 0.03125 | the README's
kinetic-hysteresis | kinetic --c 0.45 --a 4 --b 0.5 | two velocities, from a and b
kinetic-curve-c | kinetic --c 0.4:2:9 --eta 0.03125 | a curve in c, pinned at first
kinetic-curve-eta | kinetic --c 0.5 --eta 0.01:0.12:7 | a curve in eta, pinned in the end
kinetic-no-cycle | kinetic --c 0.5 --eta 0.125 | boundary: the cycles have met
kinetic-edge-c | kinetic --c 1e-8 --eta 0.03125 | boundary: the smallest coupling
kinetic-negative-c | kinetic --c -1 --eta 0.03 | refused
kinetic-nan | kinetic --c nan --eta 0.03 | refused
kinetic-word | kinetic --c strong --eta 0.03 | refused
kinetic-twice | kinetic --c 0.5 --eta 0.03 --a 4 --b 0.5 | refused: eta said twice
kinetic-half | kinetic --c 0.5 --a 4 | refused: a without b
kinetic-no-c | kinetic --eta 0.03 | refused: an option is missing
kinetic-two-ranges | kinetic --c 0.4:2:9 --eta 0.01:0.1:3 | refused: two ranges
kinetic-bad-out | kinetic --c 0.5 --eta 0.03125 --out curve.doc | refused: unknown format
sum-series | sum --v 0.3 --c 0.5 --method series --digits 50 | many digits
sum-bessel | sum --v 0.3 --c 0.5 --method bessel | another method
sum-quadrature | sum --v 0.3 --c 0.5 --method quadrature | another method
sum-thirty | sum --v 7.4 --c 100 --digits 30 | many digits where poles are near
sum-smallest-v | sum --v 1e-12 --c 0.5 | boundary
sum-zero-v | sum --v 0 --c 0.5 | refused
sum-no-digits | sum --v 0.3 --c 0.5 --digits 0 | refused
sum-method | sum --v 0.3 --c 0.5 --method guess | refused
roots-ordinary | roots --v 0.3 --c 0.5 --count 6 | labelled roots
roots-certified | roots --v 0.3 --c 0.5 --extent 20 --certify | enclosed and counted
roots-digits | roots --v 7.4 --c 100 --count 4 --digits 40 | many digits
roots-one | roots --v 0.3 --c 0.5 --count 1 | boundary
roots-none | roots --v 0.3 --c 0.5 --count 0 | refused
roots-both | roots --v 0.3 --c 0.5 --count 4 --extent 20 | refused: count and extent
profile-ordinary | profile --c 0.5 --eta 0.03125 | the admissible front
profile-branch | profile --c 0.45 --eta 0.03125 --branch 1 --from -5 --to 5 --points 21 | slow one
profile-retreat | profile --c 2 --eta 0.11 --from -3 --to 3 --points 7 | a front that retreats
profile-pinned | profile --c 0.2 --eta 0.03125 | refused: no front travels
profile-no-branch | profile --c 0.5 --eta 0.03125 --branch 9 | refused
profile-reversed | profile --c 0.5 --eta 0.03125 --from 5 --to -5 | refused
front-piecewise | front piecewise --c 0.5 --eta 0.03125 | event by event
front-piecewise-resting | front piecewise --c 0.44 --a 4 --b 0.5 --start resting | it stays
front-piecewise-step | front piecewise --c 0.6 --eta 0.03125 --start step | from a step
front-piecewise-back | front piecewise --c 2 --eta 0.11 --start-v -0.4 | a retreating start
front-piecewise-modulated | front piecewise --c 2.5 --eta 0.03125 | not a travelling wave
front-envelope-wave | front envelope --c 0.6 --a 4 --b 0.5 --behind wave --accuracy 1e-2 | a wave
front-vdp-short | front vdp --c 0.6 --a 4 --b 0.5 --n 16 | Model II, short chain
front-vdp-still | front vdp --c 0.1 --a 4 --b 0.5 --n 16 | no front
front-friction | front friction --c 0.02 --n 31 | Model I
front-friction-still | front friction --c 0.001 --n 31 | no front
front-friction-short | front friction --c 0.02 --n 1 | refused
front-other-option | front vdp --c 0.6 --a 4 --b 0.5 --v-d 1.25 | refused: another model's
front-other-model | front toy --c 0.6 | refused
simulate-vdp | simulate vdp --n 15 --a 2.5 --b 0.5 --c 0.1 --excite 7 --t-end 300 | a breather
simulate-ring | simulate vdp --n 12 --c 0.25 --ends periodic --excite 3:5 --t-end 200 \
    --perturb 1e-6 --seed 3 | a ring with seeded noise
simulate-envelope | simulate vdp --n 30 --a 4 --b 0.5 --c 0.6 --excite 1:3 --model envelope \
    --t-end 3000 | a front of (43)
simulate-two | simulate vdp --n 2 --excite 1 --t-end 100 | boundary: the shortest chain
simulate-one | simulate vdp --n 1 --t-end 100 | refused: no chain
simulate-stiff | simulate vdp --n 5 --a 40 --b 50 --eps 1 --t-end 20 | stiff
simulate-long | simulate vdp --n 1000 --c 0.3 --excite 500 --t-end 300 | only a window is active
simulate-friction | simulate friction --n 15 --c 0.02 --excite 1 --t-end 195 | stick and slip
simulate-friction-literal | simulate friction --n 9 --c 0.05 --excite 4:6 --ends literal \
    --start-point minimum --t-end 100 | the ends of (5) as printed
simulate-site | simulate vdp --n 15 --excite 16 --t-end 100 | refused
simulate-no-sites | simulate friction --n 0 | refused
simulate-ends | simulate friction --ends periodic | refused
simulate-inf | simulate vdp --n 5 --t-end inf | refused
breather-orbit | breather --c 0.1 | the default
breather-all | breather --c 0.1 --method all | four ways side by side
breather-pattern | breather --c 0.1 --nucleus 3 --pattern=-+ --method envelope | size 3
breather-branch | breather --c 0.1:0.18:2 --n 9 | through its fold
breather-tail | breather --c 0.195 --method closed-form --reading tail | another reading of (37)
breather-edge | breather --c 0.1 --place edge --method envelope | at the end
breather-none | breather --c 0.3 --method envelope | beyond the fold
breather-simulation | breather --c 0.1 --method simulation --n 7 | a run
breather-eta | breather --c 0.1 --a 2.5 --b 1 | refused: no cycles
breather-signs | breather --c 0.1 --nucleus 3 --pattern=+ | refused
threshold-envelope | threshold vdp --nucleus 3 --method envelope | by continuation
threshold-orbit | threshold vdp --nucleus 1 --method orbit | in (8)
threshold-steep | threshold vdp --nucleus 1 --a 4 --method envelope | other damping
threshold-edge | threshold vdp --nucleus 1 --place edge --method envelope | at the end
threshold-closed | threshold vdp --nucleus 1 --method closed-form | (29), (37)
threshold-sweep | threshold vdp --nucleus 1 --method sweep | slow growth of c
threshold-friction | threshold friction --place edge --nucleus 1 --n 11 --t-end 300 \
    --accuracy 1e-4 | Model I
threshold-whole | threshold friction --nucleus 3 --n 9 --definition whole --t-end 300 \
    --accuracy 1e-4 | the whole chain, under its other definition
threshold-range | threshold friction --c-min 0.5 --c-max 0.1 | refused
threshold-nothing | threshold vdp --nucleus 0 | refused
map-envelope | map vdp --eta 0.02:0.14:4 --c 0.1:1:4 --model envelope --n 8 --t-end 500 | (43)
map-vdp | map vdp --eta 0.03:0.1:2 --c 0.1:0.8:3 --n 8 --t-end 300 --refine 0 --workers 1 | (8)
map-friction | map friction --c 0:0.1:3 --v-d 1:2:3 --n 7 --t-end 500 --workers 1 \
    --refine 0.25 | Model I
map-no-points | map vdp --eta 0.01:0.14:0 --c 0.1 | refused
map-resume | map vdp --eta 0.02 --c 0.1 --resume | refused: nothing to resume
cell-friction | cell friction --v-d 1.25 | two cycles
cell-undamped | cell friction --v-d 1.25 --xi 0 | boundary
cell-diagram | cell friction --v-d 0.9:2:5 | a diagram
cell-vdp | cell vdp --a 2.5 --b 0.5 | Model II
cell-vdp-rest | cell vdp --a 1 --b 0.5 | no cycle
cell-negative | cell friction --v-d -1 | refused
derive-names | derive | the list
front-wave | front averaged --c 0.6 --a 4 --b 0.5 --method wave | solved for
front-wave-branch | front averaged --c 0.05:0.6:3 --eta 0.03125 --method wave | through c_pin
front-wave-eta | front averaged --c 0.6 --eta 0.115 --method wave | refused
derive-34 | derive --equation 34 | print agrees
derive-2 | derive --equation 2 | print does not
derive-averaging | derive averaging | step by step
derive-friction | derive friction | step by step
derive-linearisation | derive linearisation | step by step
derive-cell | derive cell --damping "1 - a*y**2 + b*y**4" --value a=4 --value b=0.5 | one's own
derive-sine | derive cell --damping "sin(y)" | refused
derive-55 | derive --equation 55 | refused
stress-list | stress --list | the quantities
stress-no-points | stress --quantity c-pin --points 0 | refused
check-list | check --list | the claims
check-quick | check fig08-assumptions fig16-admissible fig16-limits fig18-any text-small | judged
check-nothing | check no-such-claim | refused
bench-list | bench --list | the quantities
command-unknown | nothing | refused
command-bare | kinetic | refused: nothing given
"""
"""Name, command and why it is here; the first word of the name is that of the file of data."""


def written() -> Iterator[tuple[str, str, str]]:
    """Yield name, command and reason of the sets above."""
    for line in CASES.replace("\\\n", "").strip().splitlines():
        name, command, why = (" ".join(word.split()) for word in line.split("|"))
        yield name, command, why


def from_problems() -> Iterator[tuple[str, str]]:
    """Yield name and command of the quantities at the shared test problems."""
    for problem in PROBLEMS["sum"]:
        yield f"sum-at-{problem.name}", f"sum --v {problem.v} --c {problem.c}"
        yield f"roots-at-{problem.name}", f"roots --v {problem.v} --c {problem.c} --count 3"
    for problem in PROBLEMS["relation"]:
        yield f"kinetic-at-{problem.name}", f"kinetic --c {problem.c} --eta {problem['eta']}"
    for family in ("breather", "multipliers"):
        for problem in PROBLEMS[family]:
            a, b, eps = problem.cell.values()
            rest = f"--b {b} --c {problem.c} --n {problem.sites} --eps {eps}"
            yield f"breather-{family}-at-{problem.name}", f"breather --a {a} {rest}"
    for problem in PROBLEMS["chain"]:
        a, b, eps = problem.cell.values()
        run = f"--c {problem.c} --n 31 --excite 1:3 --eps {eps} --t-end {problem['t']}"
        yield f"simulate-chain-at-{problem.name}", f"simulate vdp --a {a} --b {b} {run}"
    for problem in PROBLEMS["friction"]:
        # A little earlier: at the problem's time itself a site is at its turn, and whether its
        # envelope has taken that turn up depends on where the last step began.
        run = f"--n 31 --excite 1 --t-end {problem['t'] - 5}"
        yield f"simulate-friction-at-{problem.name}", f"simulate friction --c {problem.c} {run}"
    for problem in PROBLEMS["front"]:
        a, b, eps = problem.cell.values()
        model = f"vdp --eps {eps}" if eps else "envelope"
        yield f"front-at-{problem.name}", f"front {model} --a {a} --b {b} --c {problem.c}"
    for problem in PROBLEMS["map"]:
        low, high, eta = (problem[name] for name in ("low", "high", "eta"))
        plane = f"--eta {eta} --c {low}:{high}:5 --model envelope --n 16"
        yield f"map-at-{problem.name}", f"map vdp {plane}"


def _write(cases: dict[str, Json]) -> None:
    """Write one file a command, one line an argument set."""
    DATA.mkdir(exist_ok=True)
    for command in {name.split("-")[0] for name in cases}:
        lines = (
            f"{json.dumps(name)}: {json.dumps(case, ensure_ascii=False, separators=(',', ':'))}"
            for name, case in cases.items()
            if name.split("-")[0] == command
        )
        text = "{\n" + ",\n".join(lines) + "\n}\n"
        (DATA / f"{command}.json").write_text(text, encoding="utf-8")


def main(names: list[str]) -> None:
    """Record the sets of these names, or all."""
    sets = [
        *written(),
        *((name, command, "a shared test problem") for name, command in from_problems()),
    ]
    if unknown := set(names) - {name for name, _, _ in sets}:
        sys.exit(f"no such argument set: {', '.join(sorted(unknown))}.")
    before = recorded() if names else {}
    cases = {}
    for name, command, why in sets:
        start = time.perf_counter()
        if not names or name in names:
            cases[name] = {"why": why, "command": command, **replay(shlex.split(command))}
            print(f"{time.perf_counter() - start:7.2f} s  {cases[name]['exit']}  {name}")
        elif name in before:
            cases[name] = before[name]
    _write(cases)


if __name__ == "__main__":
    main(sys.argv[1:])
