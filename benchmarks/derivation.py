"""Time to derive the modulation equations of one cell, compared with OSCILATE and ``asymptotics``.

The claim is that the derivation to second order for the cell of Eq. (8), with symbolic parameters,
takes milliseconds and is correct. Each program runs in a process of its own with a time limit;
import time is not counted, and times are wall-clock seconds. The error is

- at first order, the mean damping at the amplitudes found, by direct sampling of the cell,
- at second order, the error of the frequency shift with respect to a true periodic orbit at small
  eps.

A program whose modulation equation does not contain a drive at the linear frequency is listed as a
failure, whatever its error.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import subprocess
import sys
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from benchmarks.work_precision import (
    Effort,
    MethodAnswer,
    Prepared,
    Report,
    Setting,
    Style,
    WorkPrecision,
)
from derivations.averaging.periodic_orbit import orbit
from derivations.averaging.readings import damping_mean, paper_numbers
from verification.quantities.problems import Problem, timed

A, B, EPS = timed("derivation")[-1].cell.values()

OURS = """
import json, sys, time
import sympy as sp
from derivations.algebra.modulation import Force, ROUTE
from derivations.chain import PAPER
from derivations.symbols import epsilon
order = int(sys.argv[1])
motion = PAPER.cell().equation()
start = time.perf_counter()
found = ROUTE(Force.read(motion, epsilon), order)
seconds = time.perf_counter() - start
name = found.ring.amplitudes[0]
scale = SCALE  # amplitude of y over the modulus of this amplitude
r, a, b = sp.Symbol("r", positive=True), *sp.symbols("a b", positive=True)
here = {name: r / scale, a: sp.Rational("VALUE_A"), b: sp.Rational("VALUE_B")}
rate = sp.expand((found.first_expr().subs(here).doit() * scale))
shift = sp.expand(found.second_expr().subs(here).doit() * scale / r / sp.I) if order == 2 else None
chain = ROUTE(Force.read(PAPER.equation(), epsilon), 1)
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
    numbers = {a: sp.Rational("VALUE_A"), b: sp.Rational("VALUE_B"), w0: 1, m: 1}
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
numbers = {s: {"a": sp.Rational("VALUE_A"), "b": sp.Rational("VALUE_B")}[s.name]
           for s in right.free_symbols if s.name in ("a", "b")}
rate = sp.expand(right.subs(names).subs(numbers))
linear = apply("u'' + u + eps*u' - eps*f*cos(t)", 1)[1]
driven = any("f" in {s.name for s in condition.rhs.free_symbols}
             for condition in (linear.solvability_A, linear.solvability_B))
print(json.dumps({"seconds": seconds, "rate": str(rate), "shift": "None", "driven": driven}))
"""


def ours(route: str, scale: int) -> str:
    return OURS.replace("ROUTE", route).replace("SCALE", str(scale))


MULTIPLE, AVERAGING = "multiple scales", "averaging"
CONTENDERS = {
    MULTIPLE: (ours("by_multiple_scales", 2), None, 5),
    AVERAGING: (ours("by_averaging", 1), None, 5),
    "OSCILATE": (OSCILATE, "oscilate", 1),
    "asymptotics": (ASYMPTOTICS, "asymptotics", 1),
}
"""Program, package and repetitions of each contender (one where a program takes too long)."""


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return how well the reference is known, and the settings of every contender."""
    order = int(problem["order"])
    settings = [
        Setting(
            method=name, knob="as it is", reference=0.0,
            evaluate=partial(_derived, name, order, 15.0 if quick else 60.0, 1 if quick else None),
        )
        for name in CONTENDERS
    ]  # fmt: skip
    return Prepared(agreement=reference_apart(order), settings=settings)


def _derived(name: str, order: int, limit: float, repeats: int | None) -> MethodAnswer:
    runs = answers(name, order, limit, repeats)
    undriven = "" if runs[0]["driven"] else (
        "resonance: a force at the linear frequency does not enter the equation"
    )  # fmt: skip
    seconds = tuple(run["seconds"] for run in runs)
    return MethodAnswer(value=judged(runs[0], order), seconds=seconds, defect=undriven)


def program_of(name: str) -> str:
    """Return a contender's program with the parameter values of the test problem."""
    return CONTENDERS[name][0].replace("VALUE_A", repr(A)).replace("VALUE_B", repr(B))


def answers(name: str, order: int, limit: float, repeats: int | None) -> list[dict[str, Any]]:
    """Return what each run of a contender printed.

    Raises
    ------
    ModuleNotFoundError, ArithmeticError, TimeoutError
        If it is not installed, stops with an error, or gives no answer within ``limit`` seconds.
    """
    _, package, most = CONTENDERS[name]
    program = program_of(name)
    if installed(package) is None:
        raise ModuleNotFoundError("not installed")
    runs = []
    for _ in range(repeats or most):
        try:
            done = subprocess.run(
                [sys.executable, "-c", program, str(order)],
                capture_output=True, text=True, timeout=limit, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise TimeoutError(f"no answer in {limit:g} s") from None
        if done.returncode:
            raise ArithmeticError((done.stderr.strip().splitlines() or ["no message"])[-1])
        runs.append(json.loads(done.stdout.strip().splitlines()[-1]))
    return runs


def judged(found: dict[str, Any], order: int) -> float:
    """Return the error of the derived equation.

    Raises
    ------
    ArithmeticError
        If it does not have two cycles, or gives no shift of the frequency.
    """
    if order == 1:
        error = cycles_error(found["rate"])
        if not math.isfinite(error):
            raise ArithmeticError("the rate does not have two zeros")
        return error
    if found["shift"] == "None":
        raise ArithmeticError("no shift of the frequency")
    return shift_error(found["shift"])


def reference_apart(order: int) -> float:
    """Return how well the reference itself is known.

    At first order, this is the change of the sampled damping when the amplitude changes by a
    rounding error; at second order, the change of the shift, which is measured at a finite eps,
    when eps is halved.
    """
    if order == 1:
        return float(np.finfo(float).eps)
    return abs(measured_shift(EPS) - measured_shift(0.5 * EPS))


def installed(package: str | None) -> str | None:
    if package is None:
        return "here"
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def cycles_error(rate: str) -> float:
    """Return the largest sampled mean damping at the zeros of a contender's growth rate."""
    import sympy as sp

    r = sp.Symbol("r", positive=True)
    roots = sp.Poly(sp.sympify(rate, locals={"r": r}), r).nroots()
    sizes = [float(q) for q in roots if q.is_real and q > 1e-9]
    if len(sizes) != 2:
        return math.inf
    unit = paper_numbers(A, B)
    return max(abs(damping_mean(size**2, unit)) for size in sizes)


def shift_error(shift: str) -> float:
    """Return the error of the frequency of the outer cycle, divided by eps squared."""
    import sympy as sp

    r = sp.Symbol("r", positive=True)
    predicted = float(sp.sympify(shift, locals={"r": r}).subs(r, outer_amplitude()))
    return abs(measured_shift(EPS) - predicted)


def outer_amplitude() -> float:
    """Return the amplitude of the stable cycle."""
    return math.sqrt((A + math.sqrt(A * A - 8 * B)) / B)


def measured_shift(eps: float) -> float:
    """Return (frequency - 1)/eps² of the true outer cycle, which is computed numerically."""
    start = outer_amplitude() * np.sin(2 * np.pi * np.arange(61) / 61)[None, :]
    _, frequency = orbit(start, 1.0, paper_numbers(A, B, eps=eps))
    return float((frequency - 1) / eps**2)


def _first(name: str) -> None:
    """Run a contender's program at first order, in this process."""
    sys.argv = [name, "1"]
    with contextlib.redirect_stdout(io.StringIO()):
        exec(program_of(name), {})


BENCHMARK = WorkPrecision(
    name="derivation",
    prepare=prepare,
    effort=Effort(limit=600.0),
    quick_effort=Effort(limit=600.0),
    quick_problems=2,
    style=Style(
        xlabel="error of the result (right is better)",
        ylabel="seconds, without imports",
        caption="Error against run time of the modulation equations of one cell. The second order "
        "is compared with an orbit at ε = 0.001, which limits the error that can be seen.",
        methods={
            MULTIPLE: ("blue", "o"),
            AVERAGING: ("sky", "s"),
            "OSCILATE": ("vermilion", "v"),
            "asymptotics": ("orange", "D"),
        },
        garbage=1e-3,
        floor=1e-16,
    ),
    reasons={
        AVERAGING: "the same equation to the last term by another route, kept to check it; "
        "multiple scales is the paper's route and gives each step of it, in milliseconds more"
    },
    first={name: partial(_first, name) for name in (MULTIPLE, "OSCILATE")},
    code=("derivations.algebra.modulation", "derivations.algebra.harmonics"),
)
