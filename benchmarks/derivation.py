"""Time to the modulation equations of one cell, beside OSCILATE and ``asymptotics``.

The claim: second order for the cell of Eq. (8), with symbols, takes milliseconds and is right.
Run ``python -m benchmarks.derivation`` with the ``bench`` extra installed. Each contender runs in
a process of its own with a time limit; import time is not counted. Judged are

- both cycles: the zeros of the amplitude rate, against the cell averaged by direct sampling,
- second order: the shift of the frequency, against a true periodic orbit at small eps,
- resonance: whether a drive at the linear frequency enters the modulation equation.
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import statistics
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from derivations.averaging_evidence import damping_mean
from derivations.periodic_orbit import orbit

A, B = 2.5, 0.5
EPS = 1e-3

OURS = """
import json, sys, time
import sympy as sp
from derivations.modulation import ROUTE
from derivations.oscillator import Oscillator, van_der_pol
order = int(sys.argv[1])
cell = van_der_pol(False)
start = time.perf_counter()
found = ROUTE(cell, order)
seconds = time.perf_counter() - start
name = found.ring.amplitudes[0]
scale = SCALE  # amplitude of y over the modulus of this amplitude
r, a, b = sp.Symbol("r", positive=True), *sp.symbols("a b", positive=True)
here = {name: r / scale, a: sp.Rational(5, 2), b: sp.Rational(1, 2)}
rate = sp.expand((found.first_expr().subs(here).doit() * scale))
shift = sp.expand(found.second_expr().subs(here).doit() * scale / r / sp.I) if order == 2 else None
chain = ROUTE(van_der_pol(True), 1)
driven = chain.ring.amplitudes[chain.ring.reach + 1] in chain.first_expr().free_symbols
print(json.dumps({"seconds": seconds, "rate": str(rate), "shift": str(shift), "driven": driven}))
"""

OSCILATE = """
import contextlib, io, json, sys, time
import sympy as sp
from oscilate.MMS.dyn_sys import Dynamical_system
from oscilate.MMS.mms_oscillator import Multiple_scales_oscillator
order = int(sys.argv[1])
t, eps = sp.Symbol("t"), sp.Symbol("epsilon", positive=True)
x = sp.Function("x", real=True)(t)
a, b, w0, mu, m, F, G = sp.symbols("a b omega_0 mu m F G", positive=True)
def apply(damping, order, drive):
    scaling = [(mu, eps * m)], [(m, mu / eps)]
    if drive:
        scaling = scaling[0] + [(F, eps * G)], scaling[1] + [(G, F / eps)]
    motion = x.diff(t, 2) + w0**2 * x + mu * x.diff(t) * damping
    with contextlib.redirect_stdout(io.StringIO()):
        system = Dynamical_system(t, x, motion, w0, F=F if drive else 0)
        scales = Multiple_scales_oscillator(system, eps, order, w0, scaling)
        scales.apply_MMS()
    return scales.sol.DA[0]
start = time.perf_counter()
found = apply(1 - a * x**2 + b * x**4, order, False)
seconds = time.perf_counter() - start
r = sp.Symbol("r", positive=True)
def put(expression):
    names = {f: r / 2 for f in expression.atoms(sp.core.function.AppliedUndef)}
    numbers = {a: sp.Rational(5, 2), b: sp.Rational(1, 2), w0: 1, m: 1}
    return sp.expand(expression.subs(names).subs(numbers).doit() * 2)
rate = put(found[1])
shift = sp.expand(put(found[2]) / r / sp.I) if order == 2 else None
driven = G in apply(1, 1, True)[1].free_symbols
print(json.dumps({"seconds": seconds, "rate": str(rate), "shift": str(shift), "driven": driven}))
"""

ASYMPTOTICS = """
import contextlib, io, json, sys, time
import matplotlib
matplotlib.use("Agg")
import sympy as sp
from asymptotics import ODE
order = int(sys.argv[1])
def apply(text, order):
    with contextlib.redirect_stdout(io.StringIO()):
        ode = ODE(text, small_param="eps", conditions=["u(0) = 3", "u'(0) = 0"],
                  dependent="u", independent="t")
        return ode.expand_multiple_scales(order=order)
start = time.perf_counter()
found = apply("u'' + u + eps*u'*(1 - a*u**2 + b*u**4)", order)
seconds = time.perf_counter() - start
r = sp.Symbol("r", positive=True)
right = found[1].solvability_A.rhs
names = {f: r if f.func.__name__ == "A" else 0
         for f in right.atoms(sp.core.function.AppliedUndef)}
numbers = {s: {"a": sp.Rational(5, 2), "b": sp.Rational(1, 2)}[s.name]
           for s in right.free_symbols if s.name in ("a", "b")}
rate = sp.expand(right.subs(names).subs(numbers))
linear = apply("u'' + u + eps*u' - eps*f*cos(t)", 1)[1]
driven = any("f" in {s.name for s in condition.rhs.free_symbols}
             for condition in (linear.solvability_A, linear.solvability_B))
print(json.dumps({"seconds": seconds, "rate": str(rate), "shift": "None", "driven": driven}))
"""


def ours(route: str, scale: int) -> str:
    return OURS.replace("ROUTE", route).replace("SCALE", str(scale))


CONTENDERS = {
    "this toolkit, multiple scales": (ours("by_multiple_scales", 2), None, 5),
    "this toolkit, averaging": (ours("by_averaging", 1), None, 5),
    "OSCILATE": (OSCILATE, "oscilate", 1),
    "asymptotics": (ASYMPTOTICS, "asymptotics", 1),
}
"""Program, package, and repetitions (the peers take too long for more than one)."""


def measure(name: str, order: int, limit: float) -> dict[str, Any]:
    """Return the median time and the verdicts of one contender at one order."""
    program, package, repeats = CONTENDERS[name]
    line: dict[str, Any] = {"contender": name, "order": order, "version": installed(package)}
    if line["version"] is None:
        return {**line, "failure": "not installed"}
    runs = []
    for _ in range(repeats):
        try:
            done = subprocess.run(
                [sys.executable, "-c", program, str(order)],
                capture_output=True, text=True, timeout=limit, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return {**line, "failure": f"no answer in {limit:g} s"}
        if done.returncode:
            return {**line, "failure": (done.stderr.strip().splitlines() or ["no message"])[-1]}
        runs.append(json.loads(done.stdout.strip().splitlines()[-1]))
    found = runs[0]
    line["seconds"] = statistics.median(run["seconds"] for run in runs)
    line["both cycles"] = cycles_error(found["rate"]) < 1e-9
    if order == 2:
        line["second order"] = found["shift"] != "None" and shift_error(found["shift"]) < 1e-4
    line["resonance"] = found["driven"]
    return line


def installed(package: str | None) -> str | None:
    if package is None:
        return "here"
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def cycles_error(rate: str) -> float:
    """Return the largest mean damping, by sampling, at the zeros of a contender's rate."""
    import sympy as sp

    r = sp.Symbol("r", positive=True)
    roots = sp.Poly(sp.sympify(rate, locals={"r": r}), r).nroots()
    sizes = [float(q) for q in roots if q.is_real and q > 1e-9]
    if len(sizes) != 2:
        return math.inf
    unit = {"a": A, "b": B, "c": 0.0, "e": 1.0, "w": 1.0}
    return max(abs(damping_mean(size**2, unit)) for size in sizes)


def shift_error(shift: str) -> float:
    """Return the difference from the frequency of the true outer cycle, over eps squared."""
    import sympy as sp

    size = math.sqrt((A + math.sqrt(A * A - 8 * B)) / B)
    start = size * np.sin(2 * np.pi * np.arange(61) / 61)[None, :]
    _, frequency = orbit(start, 1.0, {"e": EPS, "a": A, "b": B, "c": 0.0})
    r = sp.Symbol("r", positive=True)
    predicted = float(sp.sympify(shift, locals={"r": r}).subs(r, size))
    return abs((frequency - 1) / EPS**2 - predicted)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--limit", type=float, default=120.0, help="seconds for each run")
    parser.add_argument("--json", action="store_true")
    parsed = parser.parse_args()
    lines = [measure(name, order, parsed.limit) for order in (1, 2) for name in CONTENDERS]
    if parsed.json:
        machine = {"python": platform.python_version(), "machine": platform.machine()}
        print(json.dumps({"machine": machine, "lines": lines}))
        return 0
    for line in lines:
        head = f"order {line['order']}  {line['contender']:<30}"
        if "failure" in line:
            print(f"{head} {line['failure']}")
            continue
        verdicts = ", ".join(
            f"{key}: {'right' if line[key] else 'WRONG'}"
            for key in ("both cycles", "second order", "resonance")
            if key in line
        )
        print(f"{head} {line['seconds'] * 1e3:9.1f} ms  {verdicts}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
