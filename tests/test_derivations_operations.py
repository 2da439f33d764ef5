"""Each operation of the algebra by itself, on an equation whose answer is known by hand.

Those that transform an integral are in ``test_derivations_contours``.
"""

import importlib
import pkgutil
import re

import numpy as np
import pytest
import sympy as sp

import derivations
from derivations import catalogue
from derivations.algebra.amplitudes import (
    ChangeAmplitude,
    FindModulation,
    FundamentalOfAverage,
    NextHarmonics,
    Route,
    SeekCycles,
)
from derivations.algebra.balance import BalancePower, phase_mean
from derivations.algebra.dispersion import (
    AtFastestWave,
    EnvelopeOfWave,
    FastestWave,
)
from derivations.algebra.equations import equation, is_zero, left_minus_right, on_sides, same
from derivations.algebra.errors import CheckFailedError
from derivations.algebra.evidence import parts_of
from derivations.algebra.expansion import (
    CollectPower,
    DifferentiateInScales,
    Limit,
    Linearise,
    Truncate,
)
from derivations.algebra.harmonics import Harmonics, chain_ring
from derivations.algebra.lattice import (
    CloseChain,
    InsertPlaneWave,
    LatticeEnds,
    ReadMatrix,
    WriteFirstOrder,
)
from derivations.algebra.operations import Operation, OperationError
from derivations.algebra.oscillation import (
    Average,
    CollectHarmonic,
    CompareFundamental,
    RealAndImaginaryParts,
    RemoveSecularTerms,
    SquareAndAdd,
    harmonics_of,
    with_modulus,
)
from derivations.algebra.rearrangement import (
    Apply,
    Differentiate,
    Divide,
    DividedDifference,
    Form,
    Function,
    Isolate,
    Join,
    Rewrite,
    Subtract,
    Take,
    TakeCoefficient,
)
from derivations.algebra.roots import CountAbove, ParametriseRadical, RootTerm, SquareModulus
from derivations.algebra.solution import (
    PrescribeCoefficients,
    SelectRoot,
    SelectSign,
    SolveFor,
    SolveLimits,
    SolveOscillator,
)
from derivations.algebra.steps import Derived, Draft, Evidence, Given, Kind
from derivations.algebra.substitution import (
    HALF,
    ChangeVariables,
    Eliminate,
    EliminatePowers,
    EnterMovingFrame,
    InsertRightSide,
    RescaleTime,
    Substitute,
    TakeBranch,
    WriteWithStep,
    alike,
    mirrored,
)
from derivations.algebra.sums import SumOver
from derivations.algebra.transform import (
    CloseContour,
    FourierTransform,
    IntegratePeriod,
    InvertTransform,
    LayOnRealAxis,
    SumOverPeriods,
)
from derivations.averaging.cycles import FindCycles, GrowthRates, RatioOfAmplitudes, RatioOfCycles
from derivations.averaging.symbols import radius, ratio
from derivations.symbols import epsilon

p, q, e, w, v = sp.symbols("p q e w v", positive=True)
t, s, u, x, zeta, angle, other = sp.symbols("t s u x zeta angle other", real=True)
k, name, other_name, rate, root = sp.symbols("k name other_name rate root")
n = sp.Symbol("n", integer=True)
y, small, profile = (sp.Function(letter, real=True) for letter in ("y", "small", "g"))
z, F, L = (sp.Function(letter) for letter in ("z", "F", "L"))
f = sp.Function("f", real=True)(t)
here = y(n, t)
z_here = z(n, t)
upper, lower = sp.symbols("upper lower")
SQUARES = sp.Tuple(equation(p**2, 1), equation(q**2, 4))
BAND = equation(w**2, 1 + 2 * q * (1 - sp.cos(k)))
SLOPES = sp.symbols("w_1 w_2 w_3")
FASTEST = equation(sp.cos(k), (1 + 2 * q - sp.sqrt(1 + 4 * q)) / (2 * q))
RADIUS = equation(radius.diff(t), -epsilon * radius / 8 * (radius**2 - 1) * (radius**2 - 4))
DUFFING = equation(here.diff(t, 2) + here + e * here**3)
DAMPED = equation(here.diff(t, 2) + here + e * here.diff(t))
BALANCED = equation(here.diff(t, 2) + here + e * (here**2 - 1) * here.diff(t))
SIZE = sp.Abs(z_here) ** 2

slow = sp.Function("slow", real=True)(s)
BY_THEMSELVES = {CloseContour, IntegratePeriod, LayOnRealAxis, SeekCycles, SumOverPeriods}
"""Operations whose answer is not in a table."""

CASES = {
    "substitute": (Substitute(), (equation(p**2), equation(p, q + 1)), equation((q + 1) ** 2)),
    "substitute a field at sites": (
        Substitute(index=n, at=(n - 1, n + 1)),
        (equation(y(n + 1, t) - y(n - 1, t)), equation(y(n, t), n**2)),
        equation((n + 1) ** 2 - (n - 1) ** 2),
    ),
    "substitute under a derivative": (
        Substitute(), (equation(y(n, t).diff(t)), equation(y(n, t), sp.sin(w * t))),
        equation(w * sp.cos(w * t)),
    ),
    "divide": (Divide(p), (equation(p * q, p**2),), equation(q, p)),
    "divide by left": (Divide(), (equation(p, q + e),), equation(1, q / p + e / p)),
    "solve for": (SolveFor(q), (equation(p * q, 2),), equation(q, 2 / p)),
    "solve for, two": (
        SolveFor(p), (equation(p**2 - 3 * p + 2),), sp.Tuple(equation(p, 1), equation(p, 2)),
    ),
    "eliminate": (Eliminate((q,)), (equation(p, q**2), equation(q, e)), equation(p, e**2)),
    "isolate": (Isolate((q,), (q,)), (equation(p * q + e, 1),), equation(q, (1 - e) / p)),
    "isolate one of two": (
        Isolate((p, q), (q,)), (equation(2 * p * q + e * p**2, 1),),
        equation(q + e * p / 2, 1 / (2 * p)),
    ),
    "take": (Take(0), (sp.Tuple(equation(p, 1), equation(q, 2)),), equation(p, 1)),
    "join": (Join(), (equation(p, 1), equation(q, 2)), sp.Tuple(equation(p, 1), equation(q, 2))),
    "subtract": (Subtract(), (equation(p, 1), equation(q, 3)), equation(p - q + 2)),
    "divided difference": (
        DividedDifference(p, sp.symbols("a b c"), q), (equation(5 * p**2 + 3 * p + 1),),
        equation(q, 5),
    ),
    "truncate": (Truncate(e, 1), (equation(sp.exp(e) * p, (1 + e) ** 3),),
                 equation(p + e * p, 1 + 3 * e)),
    "collect power": (CollectPower(e, 2), (equation((1 + e * p) ** 3),), equation(3 * p**2)),
    "collect power with an unknown": (
        CollectPower(e, 1, u), (equation(u * e + p * e + q),), equation(u, -p),
    ),
    "limit": (Limit(e, 0), (equation(((1 + e) ** 2 - 1) / e, p),), equation(2, p)),
    "limit at infinity": (Limit(u, -sp.oo), (equation(1 + sp.exp(u), p),), equation(1, p)),
    "solve oscillator": (
        SolveOscillator(t, p), (equation(y(t, s).diff(t, 2) + 4 * y(t, s)),),
        equation(y(t, s), p * sp.exp(2 * sp.I * t) + p * sp.exp(-2 * sp.I * t)),
    ),
    "secular": (
        RemoveSecularTerms(t, y(t, s)),
        (equation(y(t, s).diff(t, 2) + y(t, s), p * sp.cos(t) + q * sp.cos(3 * t)),),
        equation(-p / 2),
    ),
    "secular, after a substitution": (
        RemoveSecularTerms(t, y(t, s)),
        (equation(y(t, s).diff(t, 2) + y(t, s), slow**3), equation(slow, sp.cos(t))),
        equation(-sp.Rational(3, 8)),
    ),
    "secular, of the mean": (
        RemoveSecularTerms(t, y(t, s), 0),
        (equation(y(t, s).diff(t, 2), p + q * sp.cos(t)),), equation(-p),
    ),
    "secular, of first order": (
        RemoveSecularTerms(t, z(t, s)),
        (equation(z(t, s).diff(t) - sp.I * z(t, s), p * sp.cos(t)),), equation(-p / 2),
    ),
    "average": (Average(w * t), (equation(z(n, t) + sp.cos(w * t) ** 2),),
                equation(z(n, t) + sp.Rational(1, 2))),
    "real and imaginary parts": (
        RealAndImaginaryParts(), (equation(p + sp.I * q * sp.exp(sp.I * angle)),),
        sp.Tuple(equation(p - q * sp.sin(angle)), equation(q * sp.cos(angle))),
    ),
    "square and add": (
        SquareAndAdd(angle),
        (sp.Tuple(equation(p * sp.cos(other - angle), q), equation(p * sp.sin(other - angle), e)),),
        equation(p**2, q**2 + e**2),
    ),
    "square and add, two waves": (
        SquareAndAdd(angle),
        (sp.Tuple(
            equation(p * sp.cos(other - angle) + q * sp.cos(2 * other - angle), 1),
            equation(p * sp.sin(other - angle) + q * sp.sin(2 * other - angle), 0)),),
        equation(p**2 + q**2 + 2 * p * q * sp.cos(other), 1),
    ),
    "match harmonic": (
        CompareFundamental(t), (equation(u, p * sp.sin(t)), equation(u, 2 * q * sp.cos(t + angle))),
        sp.Tuple(equation(p, 2 * q), equation(-sp.pi / 2, angle)),
    ),
    "amplitude": (CompareFundamental(t, q), (equation(u, p * sp.exp(-abs(n)) * sp.sin(t + n * w)),),
                  equation(q, p * sp.exp(-abs(n)))),
    "chain rule": (
        DifferentiateInScales(y(0, t), y(u, s), t),
        (sp.Tuple(equation(u, w * t), equation(s, e * t)),),
        sp.Tuple(
            equation(y(0, t).diff(t), w * y(u, s).diff(u) + e * y(u, s).diff(s)),
            equation(y(0, t).diff(t, 2), w**2 * y(u, s).diff(u, 2)
                     + 2 * w * e * y(u, s).diff(u, s) + e**2 * y(u, s).diff(s, 2))),
    ),
    "rescale time": (
        RescaleTime(y(0, t), y(u, s), t),
        (equation(y(0, t) + sp.sin(w * t + p)), sp.Tuple(equation(u, w * t), equation(s, e * t))),
        equation(y(u, s) + sp.sin(u + p)),
    ),
    # substitution
    "give values": (Substitute({p: 3}), (equation(p * q, p),), equation(3 * q, 3)),
    "give a value, and leave integrals": (
        Substitute({p: q}), (equation(sp.Integral(p * x, (x, 0, 1)), e),),
        equation(sp.Integral(q * x, (x, 0, 1)), e),
    ),
    "let a function be constant": (
        Substitute({slow: p}), (equation(slow.diff(s) + slow**2),), equation(p**2),
    ),
    "give a field another name": (
        Substitute({f: here}), (equation(f.diff(t), f**2),), equation(here.diff(t), here**2),
    ),
    "equate what two equations give": (
        Substitute(), (equation(p, e), equation(p, q)), equation(q, e),
    ),
    "mirror": (mirrored(y, t, 1), (equation(y(-1, t) + y(1, t)),), equation(2 * y(1, t))),
    "move alike": (
        alike(y, n, t, 1), (equation(here.diff(t) + y(n + 1, t) - 2 * here + y(n - 1, t)),),
        equation(here.diff(t)),
    ),
    "eliminate two": (
        Eliminate((p,)), (equation(p**2 + q * p), equation(name, p * q)),
        equation(name**2 / q**2 + name),
    ),
    "eliminate where something holds": (
        Eliminate((p,), {L(k): 0}), (equation(name, p * k), equation(L(k), p - k**2)),
        equation(name, k**3),
    ),
    "branch of a law": (
        TakeBranch(u > 0), (equation(name, 2 * sp.Piecewise((p, u < 0), (q, u > 0))),),
        equation(name, 2 * q),
    ),
    "branch above a threshold": (
        TakeBranch(u > w),
        (equation(name, sp.Piecewise((p, u < w), (q, u > w), evaluate=False)),),
        equation(name, q),
    ),
    "branch below a threshold": (
        TakeBranch(abs(u) < q),
        (equation(name, sp.Piecewise((p, abs(u) < q), (e, True), evaluate=False)),),
        equation(name, p),
    ),
    "negative branch": (TakeBranch(u < 0), (equation(abs(u) + q * sp.sign(u)),), equation(-u - q)),
    # rearranging
    "divide relations": (
        Divide((p, q)), (sp.Tuple(equation(p * q, p**2), sp.Gt(q * u, q, evaluate=False)),),
        sp.Tuple(equation(q, p), sp.Gt(u, 1, evaluate=False)),
    ),
    "isolate two": (Isolate((p, q)), (equation(p, 2 - q),), equation(p + q, 2)),
    "take a solution": (Take(1, "the second"), (sp.Tuple(equation(p, 1), equation(p, 2)),),
                        equation(p, 2)),
    "exchange": (Rewrite(Form.EXCHANGED), (equation(p, 1),), equation(1, p)),
    "to the left": (Rewrite(Form.ON_THE_LEFT), (equation(p, q),), equation(p - q)),
    "expand": (Rewrite(Form.EXPANDED), (equation(e + p * (q + e), 1),),
               equation(e + p * q + p * e, 1)),
    "simplify": (Rewrite(Form.SIMPLIFIED), (equation(sp.sin(x) ** 2 + sp.cos(x) ** 2, p),),
                 equation(1, p)),
    "cancel": (Rewrite(Form.CANCELLED), (equation(e, (p**2 - 1) / (p - 1)),), equation(e, p + 1)),
    "short roots": (
        Rewrite(Form.SHORT_ROOTS), (equation(name, sp.sqrt(p**2 + 2 * p * q + q**2)),),
        equation(name, p + q),
    ),
    "square": (Apply(Function.SQUARE), (equation(p, q + 1),), equation(p**2, (q + 1) ** 2)),
    "reciprocal": (Apply(Function.RECIPROCAL), (equation(p, q / e),), equation(1 / p, e / q)),
    "square root": (Apply(Function.SQUARE_ROOT), (equation(4 * p**2, (u + 1) ** 2),),
                    sp.Tuple(equation(2 * p, u + 1), equation(2 * p, -u - 1))),
    "coefficient that vanishes": (
        TakeCoefficient(sp.sin(t)), (equation(p * sp.sin(t) + q * sp.cos(t), e * sp.sin(t)),),
        equation(p - e),
    ),
    "coefficient with a name": (
        TakeCoefficient(F(k), L(k)),
        (equation((sp.I * k + sp.exp(sp.I * k) + sp.exp(-sp.I * k)) * F(k), 1),),
        equation(L(k), sp.I * k + 2 * sp.cos(k)),
    ),
    "differentiate": (
        Differentiate(L(k), k, (name,)), (equation(L(k), p * k**2),),
        equation(name, 2 * p * k),
    ),
    # solving
    "solve for an angle": (
        SolveFor(angle), (equation(2 * sp.cos(angle), 1),),
        sp.Tuple(equation(angle, -sp.pi / 3), equation(angle, sp.pi / 3)),
    ),
    "solve for a real unknown": (SolveFor(u), (equation(u**3, 1),), equation(u, 1)),
    "solve for an angle, of second degree": (
        SolveFor(angle), (equation(2 * sp.cos(angle) ** 2 - 3 * sp.cos(angle) + 1),),
        sp.Tuple(*(equation(angle, q) for q in (0, 0, -sp.pi / 3, sp.pi / 3))),
    ),
    "solve a system": (
        SolveFor((p, q)), (sp.Tuple(equation(2 * p, e), equation(-q, 3)),),
        sp.Tuple(equation(p, e / 2), equation(q, -3)),
    ),
    "solve for a square": (SolveFor(p**2), (equation(2 * p**2, 3),), equation(p**2, HALF * 3)),
    "solve with a named factor": (
        SolveFor(F(k)), (equation((p + k) * F(k), sp.I / k), equation(L(k), p + k)),
        equation(F(k), sp.I / (k * L(k))),
    ),
    # expansion
    "limit of strong coupling": (
        Limit(q, sp.oo), (equation(rate, q * (1 - sp.cos(p / sp.sqrt(q)))),),
        equation(rate, p**2 / 2),
    ),
    "linearise a field about a state": (
        Linearise({y: small}), (equation(here.diff(t) + here**2, p**2), equation(name, p)),
        equation(small(n, t).diff(t) + 2 * p * small(n, t)),
    ),
    "linearise a complex field about rest": (
        Linearise({z: z}, at_rest=True),
        (equation(z_here.diff(t), p * z_here * (1 + q * sp.Abs(z_here) ** 2)),),
        equation(z_here.diff(t) - p * z_here),
    ),
    "linearise a system": (
        Linearise({p: q}, name), (equation(rate, sp.ImmutableMatrix([p**3])),),
        equation(name, sp.ImmutableMatrix([3 * p**2 * q])),
    ),
    # harmonics
    "collect a harmonic": (
        CollectHarmonic(s, name, 2), (equation(rate, p * sp.cos(s) + q * sp.sin(2 * s)),),
        equation(name, -sp.I * q / 2),
    ),
    "parts on a line": (
        RealAndImaginaryParts((name, rate)), (equation(L(k), sp.exp(sp.I * (x + sp.I * p))),),
        sp.Tuple(equation(name, sp.exp(-p) * sp.cos(x)), equation(rate, sp.exp(-p) * sp.sin(x))),
    ),
    # scales and laws
    "change variables": (
        ChangeVariables(t, s),
        (
            equation(here.diff(t, 2) + y(n + 1, t), rate),
            sp.Tuple(equation(here, p * small(n, s)), equation(s, w * t), equation(rate, q * name)),
        ),
        equation(p * w**2 * small(n, s).diff(s, 2) + p * small(n + 1, s), q * name),
    ),
    "prescribe coefficients": (
        PrescribeCoefficients((((name,), sp.S.One), ((rate,), e)), (p, q)),
        (equation(p * name + p * q * rate),),
        sp.Tuple(equation(p, 1), equation(q, e)),
    ),
    "prescribe a square, and then what is negative": (
        PrescribeCoefficients((((name,), sp.Integer(-2)), ((rate,), sp.Integer(9))), (p, q)),
        (equation(p * q * name + q**2 * rate),),
        sp.Tuple(equation(p, -sp.Rational(2, 3)), equation(q, 3)),
    ),
    "solve limits": (
        SolveLimits(u, (name, rate)),
        (
            equation(L(u), name + rate * sp.exp(-u)),
            sp.Tuple(equation(L(0), q), equation(L(sp.oo), e)),
        ),
        equation(L(u), e + (q - e) * sp.exp(-u)),
    ),
    "plane wave": (
        InsertPlaneWave(y, rate, x),
        (equation(here.diff(t, 2) + 2 * here - y(n + 1, t) - y(n - 1, t)),),
        equation(rate**2 + 2 - 2 * sp.cos(x)),
    ),
    # radicals
    "parametrise": (
        ParametriseRadical(p, q),
        (equation(name, 1 / sp.sqrt(1 - 4 * sp.I * q)),),
        sp.Tuple(
            equation(sp.sqrt(1 - 4 * sp.I * q), p - sp.I * sp.sqrt(p**2 - 1)),
            equation(q, p * sp.sqrt(p**2 - 1) / 2),
        ),
    ),
    "square a modulus": (
        SquareModulus(p),
        (
            sp.Tuple(equation(sp.Abs(name), e), equation(name, 1 / root)),
            sp.Tuple(equation(root, p - sp.I * sp.sqrt(p**2 - 1))),
        ),
        equation(1 / (2 * p**2 - 1), e**2),
    ),
    "term at a root": (
        RootTerm(name),
        (equation(L(k), k**2 - q**2), equation(k, q)),
        equation(name, 1 / (2 * q**2)),
    ),
    # half-planes: cos k = -i has one root above the axis in each period, at Re k = pi/2
    "count, one": (
        CountAbove(k, 0, name),
        (equation(L(k), 2 - 2 * sp.I * sp.cos(k)), equation(rate, 2), equation(rate, 2 + u)),
        equation(name, 1),
    ),
    "count, none": (
        CountAbove(k, -1, name),
        (equation(L(k), 2 - 2 * sp.I * sp.cos(k)), equation(rate, 2), equation(rate, 2)),
        equation(name, 0),
    ),
    # cycles of a cell, at amplitudes 1 and 2
    "ratio of amplitudes": (RatioOfAmplitudes(2), (SQUARES,), equation(2 * p / q, 1)),
    "select a root": (
        SelectRoot("a positive value", lambda value: value.real > 0, {q: (1.0, 2.0)}),
        (sp.Tuple(equation(p, -q), equation(p, 3 - 2 * q), equation(p, q)),),
        equation(p, q),
    ),
    "select a sign": (
        SelectSign("the cell feeds energy in"),
        (sp.Tuple(equation(p, q - 1), equation(p, 1 - q)), equation(2 * q - 2, 0)),
        equation(p, 1 - q),
    ),
    "cycles of a cell": (
        FindCycles(),
        (RADIUS,),
        sp.Tuple(equation(sp.Symbol("r_1"), 1), equation(sp.Symbol("r_2"), 2)),
    ),
    "squares of two cycles": (FindCycles((p, q)), (RADIUS,), SQUARES),
    "cycles with letters, in the lowest power": (
        FindCycles((p, q)),
        (equation(radius.diff(t), -epsilon * radius * (radius**4 - e) * (radius**4 - 9 * e)),),
        sp.Tuple(equation(p**2, sp.sqrt(e)), equation(q**2, 3 * sp.sqrt(e))),
    ),
    "growth of cycles": (
        GrowthRates(epsilon),
        (RADIUS, sp.Tuple(equation(sp.Symbol("r_1"), 1), equation(sp.Symbol("r_2"), 2))),
        sp.Tuple(
            equation(sp.Symbol("lambda_1"), sp.Rational(3, 4)), equation(sp.Symbol("lambda_2"), -3)
        ),
    ),
    "growth of cycles given by their squares": (
        GrowthRates(names=(name, -rate)), (RADIUS, SQUARES),
        sp.Tuple(equation(name, 3 * epsilon / 4), equation(-rate, -3 * epsilon)),
    ),
    "ratio of cycles with letters": (
        RatioOfCycles(),
        (equation(radius.diff(t), -epsilon * radius * (radius**2 - e) * (radius**2 - 9 * e)),),
        equation(ratio, sp.Rational(1, 3)),
    ),
    "ratio of cycles": (RatioOfCycles(), (RADIUS,), equation(ratio, HALF)),
    # finite chains
    "free ends": (
        CloseChain(y, n, t, 3, LatticeEnds.FREE),
        (equation(here.diff(t) + 2 * here - y(n + 1, t) - y(n - 1, t)),),
        sp.Tuple(
            equation(y(1, t).diff(t) + y(1, t) - y(2, t)),
            equation(y(2, t).diff(t) + 2 * y(2, t) - y(3, t) - y(1, t)),
            equation(y(3, t).diff(t) + y(3, t) - y(2, t)),
        ),
    ),
    "ring": (
        CloseChain(y, n, t, 3, LatticeEnds.RING),
        (equation(here.diff(t) - y(n + 1, t)),),
        sp.Tuple(*(equation(y(site, t).diff(t) - y(site % 3 + 1, t)) for site in (1, 2, 3))),
    ),
    "first order": (
        WriteFirstOrder(rate, (p, q), t),
        (equation(2 * f.diff(t, 2) + w * f), equation(name, sp.ImmutableMatrix([f, f.diff(t)]))),
        equation(rate, sp.ImmutableMatrix([q, -w * p / 2])),
    ),
    "read a matrix": (
        ReadMatrix((p, q), name),
        (equation(rate, sp.ImmutableMatrix([p + 2 * q, 3 * q])),),
        equation(name, sp.ImmutableMatrix([[1, 2], [0, 3]])),
    ),
    # means over a phase
    "balance of power": (
        BalancePower(f, t, p * sp.cos(s), s),
        (equation(f.diff(t, 2) + f + e * f.diff(t) * (1 - f**2)),),
        equation(e * p**2 * (HALF - p**2 / 8)),
    ),
    # dispersion: w² = 1 + 2 q (1 - cos k)
    "group velocity": (
        Differentiate(w, k, SLOPES[:2]),
        (BAND,),
        sp.Tuple(
            equation(SLOPES[0], q * sp.sin(k) / w),
            equation(SLOPES[1], (q * sp.cos(k) - SLOPES[0] ** 2) / w),
        ),
    ),
    "fastest wave": (
        FastestWave(w, k),
        (Differentiate(w, k, SLOPES)(BAND), BAND),
        FASTEST,
    ),
    "at the fastest wave": (
        AtFastestWave(w, k),
        (Differentiate(w, k, SLOPES)(BAND), BAND, FASTEST),
        sp.Tuple(
            equation(SLOPES[0], (sp.sqrt(1 + 4 * q) - 1) / 2),
            equation(SLOPES[2], (1 - sp.sqrt(1 + 4 * q)) / 2),
        ),
    ),
    "envelope of a wave": (
        EnvelopeOfWave(y(x, t), x, t, (p, 0, q)),
        (equation(y(x, t).diff(t), -e * y(x, t)),),
        equation(y(x, t).diff(t), -p * y(x, t).diff(x) + q / 6 * y(x, t).diff(x, 3) - e * y(x, t)),
    ),
    # transforms
    "Fourier transform": (
        FourierTransform(zeta, k, profile, F),
        (equation(profile(zeta).diff(zeta) + profile(zeta + 1), sp.Heaviside(-zeta, HALF)),),
        equation((sp.I * k + sp.exp(sp.I * k)) * F(k), sp.I / k),
    ),
    "invert a transform": (
        InvertTransform(zeta, k, profile(zeta)),
        (equation(F(k), 1 / L(k)),),
        equation(profile(zeta), sp.Integral(sp.exp(sp.I * k * zeta) / (2 * sp.pi * L(k)), k)),
    ),
    # waves and steps
    "write with a step": (
        WriteWithStep(name),
        (
            equation(
                rate,
                sp.Piecewise(
                    (p, sp.Lt(u, q, evaluate=False)),
                    (e, sp.Gt(u, q, evaluate=False)),
                    evaluate=False,
                ),
            ),
        ),
        equation(name, p + (e - p) * sp.Heaviside(u - q, HALF)),
    ),
    "insert a right side": (InsertRightSide(), (equation(p, q), equation(e, w)), equation(p, w)),
    "locate steps": (
        Substitute(),
        (
            equation(name, sp.Heaviside(u - q, HALF)),
            sp.Equivalent(sp.Gt(u, q), sp.Lt(s, 0), evaluate=False),
        ),
        equation(name, sp.Heaviside(-s, HALF)),
    ),
    "moving frame": (
        EnterMovingFrame(n, t),
        (
            equation(here.diff(t), y(n + 1, t)),
            sp.Tuple(
                equation(here, profile(n - v * t)), equation(profile(n - v * t), profile(zeta))
            ),
        ),
        equation(-v * profile(zeta).diff(zeta), profile(zeta + 1)),
    ),
    "moving frame of a velocity that is a sum": (
        EnterMovingFrame(n, t),
        (
            equation(here, y(n - 1, t)),
            sp.Tuple(
                equation(here, profile(n - (v + w) * t)),
                equation(profile(n - (v + w) * t), profile(zeta)),
            ),
        ),
        equation(profile(zeta), profile(zeta - 1)),
    ),
    "modulus": (
        Apply(Function.MODULUS), (equation(name, rate),), equation(sp.Abs(name), sp.Abs(rate)),
    ),
    # modulation: Duffing's frequency 1 + 3/8 e a² - 15/256 e² a⁴ (Nayfeh), a = 2 |A|;
    # a damped oscillator turns at sqrt(1 - e²/4); Van der Pol's cycle at 1 - e²/16
    "scales, damped": (
        FindModulation(Route.MULTIPLE_SCALES, e, z, 2), (DAMPED,),
        equation(z_here.diff(t), (-e / 2 - sp.I * e**2 / 8) * z_here),
    ),
    "scales, stiff": (
        FindModulation(Route.MULTIPLE_SCALES, e, z, 2), (DUFFING,),
        equation(
            z_here.diff(t),
            sp.I * (sp.Rational(3, 2) * e * SIZE - sp.Rational(15, 16) * e**2 * SIZE**2) * z_here,
        ),
    ),
    "average, damped": (
        FindModulation(Route.AVERAGING, e, z, 2), (DAMPED,),
        equation(z_here.diff(t), (-e / 2 - sp.I * e**2 / 8) * z_here),
    ),
    "average, damped, to first order": (
        FindModulation(Route.AVERAGING, e, z, 1), (DAMPED,),
        equation(z_here.diff(t), -e / 2 * z_here),
    ),
    "change of amplitude": (
        ChangeAmplitude(e, z, F),
        (FindModulation(Route.AVERAGING, e, z, 2)(DUFFING),
         FundamentalOfAverage(e, z, name)(DUFFING)),
        FindModulation(Route.MULTIPLE_SCALES, e, F, 2)(DUFFING),
    ),
    "fundamental": (
        FundamentalOfAverage(e, z, name),
        (DAMPED,),
        equation(name, -sp.I / 2 * (z_here - sp.I * e / 4 * z_here)),
    ),
    "next harmonics": (
        NextHarmonics(e, z, name, w),
        (DUFFING,),
        equation(name, z_here**3 * w**3 / 8 + sp.conjugate(z_here) ** 3 / w**3 / 8),
    ),
    "lower powers": (
        EliminatePowers(q),
        (equation(name, q**2 + 1), equation(q - 4)),
        equation(name, 17),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_an_operation_gives_the_answer_known_by_hand(name):
    operation, sources, expected = CASES[name]
    found = operation(*sources)
    assert same(found, expected), found
    for one, two in zip(parts_of(found), parts_of(expected), strict=True):
        if one != two:
            assert is_zero(one.lhs - two.lhs), (one, two)
            assert is_zero(one.rhs - two.rhs), (one, two)


@pytest.mark.parametrize("name", CASES)
def test_an_operation_says_what_it_did(name):
    operation, sources, _ = CASES[name]
    words = operation.words([f"({place})" for place in range(1, len(sources) + 1)])
    assert words
    assert words[0].islower() or words.startswith("Fourier")
    assert not words.endswith(".")
    assert "None" not in words


@pytest.mark.parametrize(
    ("operation", "words"),
    [
        (Truncate(e, 0), "expand (1) in e and omit O(e)"),
        (Truncate(e, 1), "expand (1) in e and omit O(e²)"),
        (Substitute({p: q}), "set p = q in (1)"),
        (Substitute({p: q, q: 2 * q}), "set p = q and q → 2⋅q in (1)"),
        (Substitute(index=n, at=(0,)), "substitute (2) at n = 0 into (1)"),
        (Substitute(index=n, at=(0, n + 1)), "substitute (2) at the sites 0 and n + 1 into (1)"),
        (CountAbove(k, -1, name), "count the roots of (1) with -π < Re k < 0 above the axis: by "
         "(2) only the far end changes the argument"),
        (CollectPower(e, 0), "collect the terms of order 1 of (1)"),
        (CollectPower(e, 1), "collect the terms of order e of (1)"),
        (Linearise({z: z}, at_rest=True), "linearise (1) about rest"),
        (Linearise({z: z}), "linearise (1) about (2)"),
        (RealAndImaginaryParts(), "take the real and imaginary parts of (1)"),
        (RealAndImaginaryParts((), True), "take the imaginary and real parts of (1)"),
        (Limit(e, 0), "take the limit e → 0 of (1)"),
        (Limit(e, 0, 1), "take the limit e → 0⁺ of (1)"),
        (Isolate((q,)), "bring the terms with q of (1) to the left"),
        (Isolate((q,), (q,)), "bring the terms with q of (1) to the left and divide by the factor "
         "of q"),
        (CollectHarmonic(s, name, 1), "call the coefficient of e^(is) in (1) name"),
        (CollectHarmonic(s, name, 2), "call the coefficient of e^(2is) in (1) name"),
    ],
)  # fmt: skip
def test_words_name_what_the_parameters_say(operation, words):
    assert operation.words(["(1)", "(2)"] if "(2)" in words else ["(1)"]) == words


ODD = re.compile(r"  |\(\)|None|\b1i|│|\b(pi|I)\b|,,|and and| $")
"""What no sentence holds: gaps, empty brackets, the one before an i, and SymPy's own names."""


@pytest.mark.parametrize("key", catalogue.LISTING)
def test_the_words_of_every_step_name_all_that_it_follows_from(key):
    for step in (each for each in catalogue.load(key).steps if each.sources):
        assert all(source.label in step.operation for source in step.sources), step.operation
        assert not ODD.search(step.operation), step.operation


WAVE = sp.exp(sp.I * x) + sp.exp(-sp.I * x)
WAVES = chain_ring("A", (), 1).real_wave(0)
FORMS = {
    "slow waves and exponentials stay": lambda: (
        harmonics_of(sp.exp(p + s) * sp.sin(s) * sp.cos(t), t),
        dict.fromkeys((1, -1), sp.exp(p + s) * sp.sin(s) / 2),
    ),
    "a harmonic of unit size": lambda: (harmonics_of(sp.exp(sp.I * t), t), {1: 1}),
    "nothing has no harmonics": lambda: (harmonics_of(sp.S.Zero, t), {}),
    "a power is a product": lambda: (WAVES**3, WAVES * WAVES * WAVES),
    "nothing is left of a difference": lambda: (WAVES - WAVES, Harmonics(WAVES.ring, {})),
    "moduli": lambda: (
        [with_modulus(z_here**2 * sp.conjugate(z_here) ** m) for m in (1, 3)],
        [z_here * SIZE, sp.conjugate(z_here) * SIZE**2],
    ),
    "cosines": lambda: (
        TakeCoefficient(F(k))(equation(WAVE * sp.exp(p) * F(k))),
        equation(2 * sp.exp(p) * sp.cos(x)),
    ),
    "an integral stays, with its value put in": lambda: (
        Substitute({p: 3})(equation(sp.Integral(p * x, (x, 0, 1)))),
        equation(sp.Integral(3 * x, (x, 0, 1))),
    ),
    "an integral is not expanded": lambda: (
        Rewrite(Form.EXPANDED)(equation(p * (q + sp.Integral((x + 1) ** 2, (x, 0, 1))))),
        equation(p * q + p * sp.Integral((x + 1) ** 2, (x, 0, 1))),
    ),
    "a positive factor is taken out of a root": lambda: (
        IntegratePeriod()(
            equation(
                name, sp.Integral(1 / (sp.sqrt(1 + q + sp.I * p) - sp.cos(k)), (k, -sp.pi, sp.pi))
            )
        ),
        equation(name, 2 * sp.pi / (sp.sqrt(q) * sp.sqrt(1 + sp.I * p / q))),
    ),
    "numerators of up to four terms are cancelled": lambda: (
        Rewrite(Form.CANCELLED)(equation((1 + p + q + p * q) / (1 + p) ** 2)),
        equation((1 + q) / (1 + p)),
    ),
    "what has no denominator is left": lambda: (
        Rewrite(Form.CANCELLED)(equation(p**2 + p * q, (p**2 - 1) / (p - 1))),
        equation(p**2 + p * q, p + 1),
    ),
    "longer numerators are left": lambda: (
        Rewrite(Form.CANCELLED)(equation((1 + 2 * p + q + p**2 + p * q) / (1 + p) ** 2)),
        equation((1 + 2 * p + q + p**2 + p * q) / (1 + p) ** 2),
    ),
    "what is squared is expanded, and no root": lambda: (
        Truncate(e, 0)(equation(sp.sqrt(x * (x + 1)), (x * (x + 1) - x**2) ** 2)),
        equation(sp.sqrt(x * (x + 1)), x**2),
    ),
}
"""What is found, and how it is written down."""


@pytest.mark.parametrize("name", FORMS)
def test_a_result_is_written_as_it_is_read(name):
    found, expected = FORMS[name]()
    assert found == expected


def test_names_are_as_many_as_the_entries_of_the_state():
    state = equation(name, sp.ImmutableMatrix([f, f.diff(t)]))
    with pytest.raises(ValueError, match="shorter"):
        WriteFirstOrder(rate, (p,), t)(equation(f.diff(t, 2) + f), state)


def test_a_coefficient_is_shifted_within_the_sites_of_its_ring():
    ring = chain_ring("A", (p,), 1)
    left, middle, right = map(ring.amplitude, (-1, 0, 1))
    held = 3 * left**2 * ring.conjugate(middle) * ring.element(p)
    assert ring.shift(held, 1) == 3 * middle**2 * ring.conjugate(right) * ring.element(p)
    assert ring.shift(right, -2) == left
    for beyond, places in ((right, 1), (left, -1), (ring.conjugate(middle), 2)):
        with pytest.raises(IndexError, match="too few sites"):
            ring.shift(beyond, places)


def test_neighbours_are_mirrored_or_alike_as_far_as_springs_reach():
    assert mirrored(y, t, 2).values == {y(-1, t): y(1, t), y(-2, t): y(2, t)}
    sites = (n + 1, n - 1, n + 2, n - 2)
    assert alike(y, n, t, 2).values == {y(site, t): here for site in sites}


def test_the_mean_over_a_phase_of_sines_and_cosines_is_known():
    assert phase_mean(q * sp.sin(s) ** 2 * sp.cos(s) ** 2, s) == q / 8


def test_the_mean_over_a_phase_is_an_integral_where_it_has_no_closed_form():
    assert phase_mean(p + q * sp.cos(s) ** 2, s) == p + q / 2
    open_ = phase_mean(sp.sqrt(2 + sp.cos(s)), s)
    assert open_ == sp.Integral(sp.sqrt(2 + sp.cos(s)), (s, -sp.pi, sp.pi)) / (2 * sp.pi)


def test_every_operation_is_tested_by_itself():
    for module in pkgutil.walk_packages(derivations.__path__, "derivations."):
        importlib.import_module(module.name)
    tested = {type(own[0]) for own in CASES.values()}
    known = set()
    queue = [Operation]
    while queue:
        found = [
            kind
            for kind in queue.pop().__subclasses__()
            if kind.__module__.startswith("derivations.")
        ]
        known |= {kind for kind in found if not kind.__name__.startswith("_")}
        queue += found
    assert known == tested | BY_THEMSELVES


@pytest.mark.parametrize(
    ("operation", "sources"),
    [
        (SolveFor(q), (equation(p, 2),)),
        (Limit(p, 1, 1), (equation(q, sp.Integral(sp.sinh(u / p), (u, 0, 1))),)),
        (Eliminate((p,)), (equation(p), equation(0, p**2 - 3 * p + 2))),
        (Isolate((q,), (q,)), (equation(p),)),
        (RemoveSecularTerms(t, y(t, s)), (equation(y(t, s).diff(t, 2) + 2 * y(t, s), p),)),
        (RealAndImaginaryParts(), (equation(z(n, t)),)),
        (SquareAndAdd(angle), (sp.Tuple(equation(p * sp.cos(angle), q), equation(p, q)),)),
        (SolveOscillator(t, p), (equation(y(t, s).diff(t, 2) - y(t, s)),)),
        (SolveOscillator(t, p), (equation(y(t, s).diff(t, 4) - y(t, s)),)),
        (SolveFor(angle), (equation(sp.cos(angle) + sp.sin(angle)),)),
        (Substitute(), (equation(p), p > 1)),
        (RescaleTime(y(0, t), y(u, s), t),
         (equation(y(0, t) + y(1, t)), sp.Tuple(equation(u, w * t), equation(s, e * t)))),
        (PrescribeCoefficients((((name,), sp.S.One),), (p,)), (equation(q * name),)),
        (PrescribeCoefficients((((name,), sp.S.One),), (u,)), (equation(u**2 * name),)),
        (PrescribeCoefficients((((name,), sp.S.One), ((rate,), q)), (p,)),
         (equation(p * name + p * rate),)),
        (Divide(u), (sp.Lt(p, q, evaluate=False),)),
        (TakeBranch(u < 0), (equation(abs(x)),)),
        (TakeBranch(x < 1), (equation(abs(x)),)),
        (ParametriseRadical(p, q), (equation(name, q),)),
        (ParametriseRadical(p, q), (equation(name, sp.sqrt(1 + sp.I * q)),)),
        (ParametriseRadical(p, q), (equation(name, sp.sqrt(q - sp.I * q)),)),
        (AtFastestWave(w, k),
         (Differentiate(w, k, SLOPES)(BAND), BAND, equation(sp.cos(k), sp.sqrt(q) / 2))),
        (Limit(p, 0, 1), (equation(name, sp.Integral(sp.sinh(u + u / p) / p, (u, 0, 1))),)),
        (Limit(p, 0), (equation(name, sp.Integral(sp.sinh(u / p) / sp.cosh(u / p), (u, 0, 1))),)),
        (LayOnRealAxis(zeta, k),
         (equation(profile(zeta), sp.Integral(sp.exp(sp.I * k * zeta) / (k * L(k)), k)),
          equation(L(k), k**2 + sp.I * k))),
        (TakeBranch(u > 0), (equation(name, sp.Piecewise((p, u < 0), (q, True))),)),
        (WriteWithStep(rate), (equation(name, sp.Piecewise((p, u < 0), (q, u > 1))),)),
        (WriteWithStep(rate), (equation(name, sp.Piecewise((p, u > 0), (q, u < 0))),)),
        (
            SumOverPeriods(k),
            (equation(name, sp.Integral(1 / ((2 + sp.cos(k)) ** 4 + p**2 * k**2), (k, 0, sp.oo))),),
        ),
        (CountAbove(k, 0, name), (equation(L(k), sp.cos(k)), equation(rate, x), equation(rate, 1))),
        (FindCycles((p, q)), (equation(radius.diff(t), epsilon * radius * (1 - radius**2)),)),
        (FindCycles((p, q)), (equation(RADIUS.lhs, -RADIUS.rhs),)),
        (
            FindCycles((p, q)),
            (equation(radius.diff(t), -epsilon * radius * (1 + e * radius**2 - radius**4)),),
        ),
        (
            SelectRoot("x", lambda value: True, {q: (1.0,)}),
            (sp.Tuple(equation(p, q), equation(p, -q)),),
        ),
        (
            SelectSign("x"),
            (sp.Tuple(equation(p, -q), equation(p, -2 * q)), equation(q)),
        ),
        (
            WriteFirstOrder(rate, (p, q), t),
            (
                equation(f.diff(t, 2) + sp.sin(t)),
                equation(name, sp.ImmutableMatrix([f, f.diff(t)])),
            ),
        ),
        (ReadMatrix((p,), name), (equation(rate, sp.ImmutableMatrix([p**2])),)),
        (FourierTransform(zeta, k, profile, F), (equation(profile(zeta) ** 2, 1),)),
        (FourierTransform(zeta, k, profile, F), (equation(profile(zeta), sp.Heaviside(zeta)),)),
        (SolveFor(F(k)), (equation(k * F(k), 1), equation(L(k), p))),
        (Substitute(), (equation(name), sp.Equivalent(sp.Gt(u, q), sp.Le(s, 0), evaluate=False))),
        (
            EnterMovingFrame(n, t),
            (
                equation(here.diff(t), t),
                sp.Tuple(
                    equation(here, profile(n - v * t)), equation(profile(n - v * t), profile(zeta))
                ),
            ),
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_carried_out_is_refused(operation, sources):
    with pytest.raises(OperationError):
        operation(*sources)


def test_van_der_pol_turns_more_slowly_at_second_order():
    modulation = FindModulation(Route.MULTIPLE_SCALES, e, z, 2)(BALANCED)
    damping, frequency, size = SeekCycles(e, z, q, name, w)(modulation).args
    assert same(damping, equation(q / 4 - 1))
    assert same(equation(name, frequency.rhs.subs(q, 4)), equation(name, 1 - e**2 / 16))
    assert same(size, equation(w, sp.sqrt(q) / 2))


def test_the_size_of_a_cycle_is_where_its_growth_vanishes_to_second_order():
    # Of A' = (e (1 - |A|²) / 2 + e² (p |A|² - q i)) A, by the growth of |A| itself.
    growth = e * (1 - SIZE) / 2 + e**2 * (p * SIZE - sp.I * q)
    damping, frequency, size = SeekCycles(e, z, v, name, w)(
        equation(z_here.diff(t), sp.expand(growth * z_here))
    ).args
    assert same(damping, equation(v / 4 - 1))
    assert same(equation(frequency.rhs), equation(1 - e**2 * q))
    there = sp.re(growth).subs(sp.Abs(z_here), size.rhs.subs(v, 4))
    assert [sp.expand(there).coeff(e, power) for power in range(3)] == [0, 0, 0]


def test_the_average_is_that_of_equal_samples():
    wave = sp.cos(w * t) ** 4 * (p + q * sp.sin(2 * w * t)) + sp.exp(3 * sp.I * w * t)
    found = Average(w * t)(equation(wave)).lhs
    phase = 2 * np.pi * np.arange(16) / 16
    sampled = np.mean(np.cos(phase) ** 4 * (0.7 + 1.3 * np.sin(2 * phase)) + np.exp(3j * phase))
    assert complex(found.subs({p: 0.7, q: 1.3})) == pytest.approx(sampled, abs=1e-14)


def test_left_minus_right_is_of_one_equation_or_expression():
    assert left_minus_right(equation(p, q)) == p - q
    assert left_minus_right(p - q) == p - q
    for system in (sp.Tuple(equation(p, q)), sp.Lt(p, q, evaluate=False)):
        with pytest.raises(TypeError, match="one equation or expression"):
            left_minus_right(system)


def test_two_forms_of_an_equation_are_the_same_and_a_multiple_is_not():
    assert same(equation(p - q), equation(p, q))
    assert same(equation(z(n, t) * sp.Abs(z(n, t)) ** 2),
                equation(z(n, t) ** 2 * sp.conjugate(z(n, t))))  # fmt: skip
    assert not same(equation(2 * p - 2 * q), equation(p, q))
    assert not same(equation(p, q), sp.Tuple(equation(p, q), equation(q, p)))
    assert not same(equation(p), p)
    assert not same(sp.Lt(p, q, evaluate=False), sp.Le(p, q, evaluate=False))
    assert same(sp.Lt(p, q, evaluate=False), sp.Lt(p - q, 0, evaluate=False))
    assert not same(sp.Tuple(equation(p, q), equation(q)), sp.Tuple(equation(p, q), equation(p)))
    assert not same(sp.Lt(p, q, evaluate=False), sp.Lt(p, 2 * q, evaluate=False))
    assert not same(p, sp.true)
    assert not same(sp.true, p)
    row, other_row = ([p * (q + last), p] for last in (1, 2))
    matrix = equation(name, sp.ImmutableMatrix([row]))
    assert same(matrix, equation(name, sp.ImmutableMatrix([[p * q + p, p]])))
    assert not same(matrix, equation(name, sp.ImmutableMatrix([other_row])))
    assert not same(matrix, equation(name, sp.ImmutableMatrix(row)))  # a column
    assert not same(matrix, equation(rate, matrix.rhs))
    assert is_zero(sp.S.Zero)
    assert not is_zero(sp.S.One)
    ordered = sp.Piecewise((1, sp.Lt(k, 1)), (2, True))  # k has no order
    assert not is_zero(ordered)
    assert is_zero(ordered * (q - 1) - ordered * q + ordered)
    assert on_sides(sp.Tuple(p, equation(p, q)), sp.exp) == sp.Tuple(
        sp.exp(p), equation(sp.exp(p), sp.exp(q))
    )


OVER_ROOTS = SumOver(1 / k, k, upper)
IDENTITIES = {
    "a sum": ((p + q) ** 2, p**2 + 2 * p * q + q**2),
    "a sum of large terms": ((p + 10**25) ** 2, p**2 + 2 * 10**25 * p + 10**50),
    "a fraction": ((p**2 - 1) / (p - 1), p + 1),
    "fractions": (1 / (1 + 1 / p) + 1 / (1 + p), sp.S.One),
    "a whole power": (q**n * q, q ** (n + 1)),
    "an exponential": (sp.exp(p + sp.I * x), sp.exp(p) * (sp.cos(x) + sp.I * sp.sin(x))),
    "a hyperbolic function": (2 * sp.cosh(k) ** 2, 1 + sp.cosh(2 * k)),
    "an angle": (sp.sin(x + angle), sp.sin(x) * sp.cos(angle) + sp.cos(x) * sp.sin(angle)),
    "a modulus": (sp.Abs(k * z_here) ** 4, (k * z_here * sp.conjugate(k * z_here)) ** 2),
    "a special function": (sp.gamma(p + 1), p * sp.gamma(p)),
    "a sum without a value": ((p + 1) * OVER_ROOTS, p * OVER_ROOTS + OVER_ROOTS),
    "infinite for positive x": (
        (p + 1) / (sp.sign(x) - 1),
        p / (sp.sign(x) - 1) + 1 / (sp.sign(x) - 1),
    ),
    "a derivative": ((z_here**2).diff(t), 2 * z_here * z_here.diff(t)),
}
"""Both sides of identities, of real, positive, whole and complex quantities."""


@pytest.mark.parametrize("name", IDENTITIES)
def test_an_identity_is_zero_and_what_is_a_little_off_is_not(name):
    one, other = IDENTITIES[name]
    assert is_zero(one - other)
    assert same(one, other)
    assert same(equation(one, k), equation(other, k))
    for size in (1, sp.Rational(1, 10**6)):
        assert not is_zero(one - (1 + size) * other)
        assert not is_zero(size * other)
        assert not same(one, other + size * q)
    # Nothing is known of a complex quantity but what it is: not even its own conjugate.
    assert not is_zero(sp.conjugate(z_here) - z_here)
    assert not is_zero(sp.conjugate(k) - k)


def passes(_):
    return Evidence(True, "")


def test_a_step_is_called_by_its_number_or_its_name():
    draft = begun()
    draft.model("other", equation(p, 1), "a model", check=passes, number=7)
    assert [draft[each].label for each in ("start", "other")] == ["'start'", "(7)"]


def begun(right: sp.Expr = q) -> Draft:
    draft = Draft()
    draft.model("start", equation(p, right), "a model", check=passes)
    return draft


def test_a_derived_step_cannot_be_given_its_result():
    start = begun()["start"]
    with pytest.raises(TypeError, match="equation"):
        Derived(name="x", check=passes, operations=(Rewrite(Form.EXCHANGED),), given_by=(start,),
                equation=equation(q, p))  # fmt: skip
    with pytest.raises(TypeError, match="result"):
        Derived(name="x", check=passes, operations=(Rewrite(Form.EXCHANGED),), given_by=(start,),
                result=equation(q, p))  # fmt: skip
    with pytest.raises(ValueError, match="never given"):
        Given(name="x", check=passes, given_as=Kind.DERIVED, equation=equation(p, q), words="")
    with pytest.raises(ValueError, match="source"):
        Derived(name="x", check=passes, operations=(Rewrite(Form.EXCHANGED),), given_by=(),
                assumes=False)  # fmt: skip


def test_a_result_follows_when_its_source_changes():
    for right in (q, q**2):
        draft = begun(right)
        draft.derived("end", (Rewrite(Form.EXCHANGED), Divide(q)), "start", check=passes)
        found = draft["end"]
        assert same(found.result, equation(right / q, p / q))
        assert found.operation == "exchange the sides of 'start'; divide the result by q"


def test_an_ansatz_that_is_written_out_stays_one():
    draft = begun()
    draft.derived("derived", Divide(q), "start", check=passes)
    draft.derived("written out", Divide(q), "start", check=passes, assumes=True)
    assert [draft[each].kind for each in ("derived", "written out")] == [Kind.DERIVED, Kind.ANSATZ]


def test_the_first_step_whose_check_fails_is_named_by_its_place():
    draft = begun()
    for place in (2, 3):
        draft.derived(f"step {place}", Divide(q), "start", check=lambda _: Evidence(False, "off"))
    with pytest.raises(CheckFailedError, match="step 2"):
        draft.finished("x", "").verify()


def test_a_source_is_a_step_that_was_written_down_before():
    draft = begun()
    with pytest.raises(ValueError, match="no step is called 'later' so far"):
        draft.derived("end", Rewrite(Form.EXCHANGED), "later", check=passes)
    assert "end" not in draft


def test_a_source_is_a_step_of_the_same_derivation_before_one_of_an_earlier():
    earlier = begun(q**2).finished("earlier", "")
    later = Draft(earlier)
    assert later["start"] is earlier.named("start")
    assert "start" not in later
    later.model("start", equation(p, q), "another model", check=passes)
    assert later["start"].result == equation(p, q)
    assert later.finished("later", "").steps == (later["start"],)


def test_a_derivation_has_no_two_steps_of_one_name():
    draft = begun()
    draft.ansatz("start", equation(p, q), "once more", check=passes)
    with pytest.raises(ValueError, match="two steps called 'start'"):
        draft.finished("x", "")
