"""Each operation of the algebra by itself, on an equation whose answer is known by hand."""

import importlib
import pkgutil

import numpy as np
import pytest
import sympy as sp

import derivations
from derivations.algebra.equations import equation, is_zero, parts_of, same
from derivations.algebra.expansion import (
    CollectPower,
    Detune,
    DifferentiateInScales,
    Limit,
    Linearise,
    RescaleTime,
    SolveOscillator,
    SteadyState,
    Truncate,
)
from derivations.algebra.operations import (
    CancelCommonFactors,
    CollectTerms,
    Differentiate,
    Divide,
    DivideByLeftSide,
    DividedDifference,
    Eliminate,
    Factorise,
    ImposeMirrorSymmetry,
    Isolate,
    Join,
    Multiply,
    Operation,
    OperationError,
    SelectBranch,
    SolveFor,
    Specialise,
    Substitute,
    Subtract,
    SwapSides,
    Take,
)
from derivations.algebra.oscillation import (
    Average,
    CollectHarmonic,
    MatchHarmonic,
    RealAndImaginaryParts,
    RemoveSecularTerms,
    SolveCosine,
    SquareAndAdd,
    SquareRoot,
    TakeAmplitude,
)
from derivations.algebra.steps import Derived, Evidence, Given, Kind, derived, model
from tests import test_derivations_operations_by_subject as by_subject

p, q, e = sp.symbols("p q e", positive=True)
w = sp.Symbol("w", positive=True)
t, s, u, angle, other = sp.symbols("t s u angle other", real=True)
n = sp.Symbol("n", integer=True)
y = sp.Function("y", real=True)
z = sp.Function("z")
slow = sp.Function("slow", real=True)(s)

CASES = {
    "substitute": (Substitute(), (equation(p**2), equation(p, q + 1)), equation((q + 1) ** 2)),
    "substitute a field at sites": (
        Substitute(n, (n - 1, n + 1)),
        (equation(y(n + 1, t) - y(n - 1, t)), equation(y(n, t), n**2)),
        equation((n + 1) ** 2 - (n - 1) ** 2),
    ),
    "substitute under a derivative": (
        Substitute(), (equation(y(n, t).diff(t)), equation(y(n, t), sp.sin(w * t))),
        equation(w * sp.cos(w * t)),
    ),
    "specialise": (Specialise({p: 3}), (equation(p * q, p),), equation(3 * q, 3)),
    "mirror": (ImposeMirrorSymmetry(y), (equation(y(-1, t) + y(1, t)),), equation(2 * y(1, t))),
    "divide": (Divide(p), (equation(p * q, p**2),), equation(q, p)),
    "divide by left": (DivideByLeftSide(), (equation(p, q + e),), equation(1, q / p + e / p)),
    "multiply": (Multiply(p), (equation(q / p, 1),), equation(q, p)),
    "solve for": (SolveFor(q), (equation(p * q, 2),), equation(q, 2 / p)),
    "solve for, two": (
        SolveFor(p), (equation(p**2 - 3 * p + 2),), sp.Tuple(equation(p, 1), equation(p, 2)),
    ),
    "eliminate": (Eliminate(q), (equation(p, q**2), equation(q, e)), equation(p, e**2)),
    "isolate": (Isolate(q, (q,)), (equation(p * q + e, 1),), equation(q, (1 - e) / p)),
    "select": (SelectBranch(1, "the second"), (sp.Tuple(equation(p, 1), equation(p, 2)),),
               equation(p, 2)),
    "take": (Take(0), (sp.Tuple(equation(p, 1), equation(q, 2)),), equation(p, 1)),
    "join": (Join(), (equation(p, 1), equation(q, 2)), sp.Tuple(equation(p, 1), equation(q, 2))),
    "swap": (SwapSides(), (equation(p, 1),), equation(1, p)),
    "subtract": (Subtract(), (equation(p, 1), equation(q, 3)), equation(p - q + 2)),
    "differentiate": (Differentiate(p), (equation(p**3, q),), equation(3 * p**2, 0)),
    "factorise": (Factorise(), (equation(p**2 - q**2),), equation((p - q) * (p + q))),
    "collect": (CollectTerms((p,)), (equation(p * q + p * e),), equation(p * (q + e))),
    "cancel": (CancelCommonFactors(), (equation(e, (p**2 - 1) / (p - 1)),), equation(e, p + 1)),
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
    "steady": (SteadyState({slow: p}), (equation(slow.diff(s) + slow**2),), equation(p**2)),
    "limit": (Limit(e, 0), (equation(((1 + e) ** 2 - 1) / e, p),), equation(2, p)),
    "limit at infinity": (Limit(u, -sp.oo), (equation(1 + sp.exp(u), p),), equation(1, p)),
    "detune": (Detune(e), (equation(p, q),), equation(p, q + e)),
    "linearise": (Linearise({p: q}), (equation(p**3 + p * w),), equation(3 * p**2 * q + q * w)),
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
    "collect harmonic": (CollectHarmonic(t, 3), (equation(sp.sin(3 * t), p * sp.cos(3 * t)),),
                         equation(-sp.I / 2, p / 2)),
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
    "square root": (SquareRoot(), (equation(4 * p**2, (u + 1) ** 2),),
                    sp.Tuple(equation(2 * p, u + 1), equation(2 * p, -u - 1))),
    "solve cosine": (SolveCosine(angle), (equation(sp.cos(angle)),),
                     sp.Tuple(equation(angle, -sp.pi / 2), equation(angle, sp.pi / 2))),
    "match harmonic": (
        MatchHarmonic(t), (equation(u, p * sp.sin(t)), equation(u, 2 * q * sp.cos(t + angle))),
        sp.Tuple(equation(p, 2 * q), equation(-sp.pi / 2, angle)),
    ),
    "amplitude": (TakeAmplitude(t, q), (equation(u, p * sp.exp(-abs(n)) * sp.sin(t + n * w)),),
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
}  # fmt: skip


ALL = CASES | by_subject.CASES


@pytest.mark.parametrize("name", ALL)
def test_an_operation_gives_the_answer_known_by_hand(name):
    operation, sources, expected = ALL[name]
    found = operation(*sources)
    assert same(found, expected), found
    for one, two in zip(parts_of(found), parts_of(expected), strict=True):
        if one != two:
            assert is_zero(one.lhs - two.lhs), (one, two)
            assert is_zero(one.rhs - two.rhs), (one, two)


@pytest.mark.parametrize("name", ALL)
def test_an_operation_says_what_it_did(name):
    operation, sources, _ = ALL[name]
    words = operation.words([f"({place})" for place in range(1, len(sources) + 1)])
    assert words
    assert words[0].islower() or words.startswith("Fourier")
    assert not words.endswith(".")
    assert "None" not in words


def test_every_operation_is_tested_by_itself():
    for module in pkgutil.walk_packages(derivations.__path__, "derivations."):
        importlib.import_module(module.name)
    assert not CASES.keys() & by_subject.CASES.keys()
    tested = {type(own[0]) for own in ALL.values()}
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
    assert known == tested | by_subject.BY_THEMSELVES


@pytest.mark.parametrize(
    ("operation", "sources"),
    [
        (SolveFor(q), (equation(p, 2),)),
        (Eliminate(p), (equation(p), equation(p**2, 3 * p - 2))),
        (Isolate(q, (q,)), (equation(p),)),
        (RemoveSecularTerms(t, y(t, s)), (equation(y(t, s).diff(t, 2) + 2 * y(t, s), p),)),
        (RealAndImaginaryParts(), (equation(z(n, t)),)),
        (SquareAndAdd(angle), (sp.Tuple(equation(p * sp.cos(angle), q), equation(p, q)),)),
        (SolveOscillator(t, p), (equation(y(t, s).diff(t, 2) - y(t, s)),)),
        (SolveCosine(angle), (equation(sp.cos(angle) + sp.sin(angle)),)),
        (Substitute(), (equation(p), p > 1)),
        (RescaleTime(y(0, t), y(u, s), t),
         (equation(y(0, t) + y(1, t)), sp.Tuple(equation(u, w * t), equation(s, e * t)))),
    ],
)  # fmt: skip
def test_what_cannot_be_carried_out_is_refused(operation, sources):
    with pytest.raises(OperationError):
        operation(*sources)


def test_the_average_is_that_of_equal_samples():
    wave = sp.cos(w * t) ** 4 * (p + q * sp.sin(2 * w * t)) + sp.exp(3 * sp.I * w * t)
    found = Average(w * t)(equation(wave)).lhs
    phase = 2 * np.pi * np.arange(16) / 16
    sampled = np.mean(np.cos(phase) ** 4 * (0.7 + 1.3 * np.sin(2 * phase)) + np.exp(3j * phase))
    assert complex(found.subs({p: 0.7, q: 1.3})) == pytest.approx(sampled, abs=1e-14)


def test_two_forms_of_an_equation_are_the_same_and_a_multiple_is_not():
    assert same(equation(p - q), equation(p, q))
    assert same(equation(z(n, t) * sp.Abs(z(n, t)) ** 2),
                equation(z(n, t) ** 2 * sp.conjugate(z(n, t))))  # fmt: skip
    assert not same(equation(2 * p - 2 * q), equation(p, q))
    assert not same(equation(p, q), sp.Tuple(equation(p, q), equation(q, p)))
    assert not same(equation(p), p)
    assert not same(sp.Lt(p, q, evaluate=False), sp.Le(p, q, evaluate=False))


def passes(_):
    return Evidence(True, "")


def test_a_derived_step_cannot_be_given_its_result():
    start = model("start", equation(p, q), "a model", check=passes)
    with pytest.raises(TypeError, match="equation"):
        Derived(name="x", check=passes, operations=(SwapSides(),), given_by=(start,),
                equation=equation(q, p))  # fmt: skip
    with pytest.raises(TypeError, match="result"):
        Derived(name="x", check=passes, operations=(SwapSides(),), given_by=(start,),
                result=equation(q, p))  # fmt: skip
    with pytest.raises(ValueError, match="never given"):
        Given(name="x", check=passes, given_as=Kind.DERIVED, equation=equation(p, q), words="")
    with pytest.raises(ValueError, match="source"):
        Derived(name="x", check=passes, operations=(SwapSides(),), given_by=())


def test_a_result_follows_when_its_source_changes():
    for right in (q, q**2):
        start = model("start", equation(p, right), "a model", check=passes)
        found = derived("end", (SwapSides(), Multiply(q)), start, check=passes)
        assert same(found.result, equation(q * right, q * p))
        assert found.operation == "exchange the sides of 'start'; multiply the result by q"
