"""Operations on scales, radicals, cycles, lattices, waves and modulations, each by itself.

The answers are known by hand; where an integral is transformed, both forms are integrated. Those
of `CASES` are tested with the general operations, in ``test_derivations_operations``.
"""

import mpmath as mp
import pytest
import sympy as sp

from derivations.algebra.amplitudes import (
    AverageToSecondOrder,
    ChangeAmplitude,
    CycleAmplitude,
    CycleFrequency,
    CycleFundamental,
    EliminatePowers,
    FundamentalOfAverage,
    NextHarmonics,
    ScalesToSecondOrder,
)
from derivations.algebra.balance import BalancePower, ResonantPart
from derivations.algebra.cycles import (
    DecayAtRoot,
    FactorRadicals,
    LineariseAtRest,
    MoveUniformly,
    RatioOfAmplitudes,
    SelectRoot,
    StationaryAmplitudes,
    TakeBranch,
)
from derivations.algebra.dispersion import (
    AtFastestWave,
    DifferentiateDispersion,
    EnvelopeOfWave,
    FastestWave,
    NameNegative,
    RealWave,
)
from derivations.algebra.equations import equation, same
from derivations.algebra.half_planes import CountAbove, PartsOnLine
from derivations.algebra.lattice import (
    CloseChain,
    Ends,
    LineariseSystem,
    ReadMatrix,
    WriteFirstOrder,
)
from derivations.algebra.operations import OperationError
from derivations.algebra.radicals import (
    AddHalfPlanes,
    EquateRatio,
    Expand,
    ParametriseRadical,
    PutZero,
    RootTerm,
    ScaledLimit,
    SquareModulus,
    SquareSides,
    VanishingDenominator,
)
from derivations.algebra.scaling import (
    ChangeVariables,
    DivideByPositive,
    ExpressIn,
    InsertPlaneWave,
    OnOneSide,
    PerturbField,
    PrescribeCoefficients,
    PutEqual,
    Rename,
    RenameField,
    RestUniformly,
    SolveLimits,
    TakeCoefficient,
    TakeNegativeBranch,
)
from derivations.algebra.sums import SumOver
from derivations.algebra.transform import (
    CloseContour,
    EliminateOnRoots,
    FourierTransform,
    IntegratePeriod,
    InvertTransform,
    LayOnRealAxis,
    NameDerivative,
    ReadFactor,
    SolveTransform,
    StaticLimit,
    SumOverPeriods,
)
from derivations.algebra.waves import (
    HALF,
    EnterMovingFrame,
    EquateRightSides,
    EvaluateBranch,
    InsertRightSide,
    LocateSteps,
    TakeModulus,
    WriteWithStep,
)
from derivations.cell.steps import FindCycles, FrontOfCell, GrowthRates, RatioOfCycles
from derivations.cell.symbols import radius, ratio
from derivations.front import symbols as front
from derivations.symbols import epsilon

p, q, e, w, v = sp.symbols("p q e w v", positive=True)
t, s, u, x, zeta = sp.symbols("t s u x zeta", real=True)
k, name, other_name, rate, root = sp.symbols("k name other_name rate root")
n = sp.Symbol("n", integer=True)
y, small, profile = (sp.Function(letter, real=True) for letter in ("y", "small", "g"))
z, F, L = (sp.Function(letter) for letter in ("z", "F", "L"))
f, r = sp.Function("f", real=True)(t), sp.Function("r", positive=True)(t)
here = y(n, t)
z_here = z(n, t)
upper, lower = sp.symbols("upper lower")
HALF_PLANES = sp.Tuple(
    *(
        equation(
            half, sp.ConditionSet(k, sp.And(sp.Eq(L(k), 0), relation(sp.im(k), 0)), sp.S.Complexes)
        )
        for half, relation in ((upper, sp.Gt), (lower, sp.Lt))
    )
)
RATE = equation(r.diff(t), r * (r**2 - 1) * (4 - r**2))
SQUARES = sp.Tuple(equation(p**2, 1), equation(q**2, 4))
BAND = equation(w**2, 1 + 2 * q * (1 - sp.cos(k)))
SLOPES = sp.symbols("w_1 w_2 w_3")
FASTEST = equation(sp.cos(k), (1 + 2 * q - sp.sqrt(1 + 4 * q)) / (2 * q))
RADIUS = equation(radius.diff(t), -epsilon * radius / 8 * (radius**2 - 1) * (radius**2 - 4))
DUFFING = equation(here.diff(t, 2) + here + e * here**3)
DAMPED = equation(here.diff(t, 2) + here + e * here.diff(t))
BALANCED = equation(here.diff(t, 2) + here + e * (here**2 - 1) * here.diff(t))
SIZE = sp.Abs(z_here) ** 2


def contour(integrand):
    return equation(profile(zeta), sp.Integral(integrand * sp.exp(sp.I * k * zeta), k))


CASES = {
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
    "express in": (
        ExpressIn((p,)),
        (equation(p**2 + q * p), equation(name, p * q)),
        equation(name**2 / q**2 + name),
    ),
    "divide by what is positive": (
        DivideByPositive(p),
        (sp.Tuple(equation(p * q, p**2), sp.Gt(p * u, 0, evaluate=False)),),
        sp.Tuple(equation(q, p), sp.Gt(u, 0, evaluate=False)),
    ),
    "negative branch": (
        TakeNegativeBranch(u),
        (equation(abs(u) + q * sp.sign(u)),),
        equation(-u - q),
    ),
    "solve limits": (
        SolveLimits(u, (name, rate)),
        (
            equation(L(u), name + rate * sp.exp(-u)),
            sp.Tuple(equation(L(0), q), equation(L(sp.oo), e)),
        ),
        equation(L(u), e + (q - e) * sp.exp(-u)),
    ),
    "rest uniformly": (
        RestUniformly(y, p),
        (equation(here.diff(t, 2) + y(n + 1, t) ** 2),),
        equation(p**2),
    ),
    "perturb a field": (
        PerturbField(y, small),
        (equation(here.diff(t) + here**2, p**2), equation(name, p)),
        equation(small(n, t).diff(t) + 2 * p * small(n, t)),
    ),
    "plane wave": (
        InsertPlaneWave(y, rate, x),
        (equation(here.diff(t, 2) + 2 * here - y(n + 1, t) - y(n - 1, t)),),
        equation(rate**2 + 2 - 2 * sp.cos(x)),
    ),
    "coefficient": (
        TakeCoefficient(sp.sin(t)),
        (equation(p * sp.sin(t) + q * sp.cos(t), e * sp.sin(t)),),
        equation(p - e),
    ),
    "rename": (Rename(p, q), (equation(p, e),), equation(q, e)),
    "rename a field": (
        RenameField(f, here, t),
        (equation(f.diff(t), f**2),),
        equation(here.diff(t), here**2),
    ),
    "on one side": (OnOneSide(), (equation(p, q),), equation(p - q)),
    "put equal": (PutEqual(p, q), (equation(p**2, e),), equation(q**2, e)),
    # radicals
    "expand": (Expand(), (equation(p * (q + e), 1),), equation(p * q + p * e, 1)),
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
    "denominator": (
        VanishingDenominator(p),
        (equation(e, q / (p**2 - 4 * q**2)),),
        equation(p, 2 * q),
    ),
    "scaled limit": (
        ScaledLimit({k: p / sp.sqrt(q)}, q, name),
        (equation(rate, q * (1 - sp.cos(k))),),
        equation(name, p**2 / 2),
    ),
    "term at a root": (
        RootTerm(name),
        (equation(L(k), k**2 - q**2), equation(k, q)),
        equation(name, 1 / (2 * q**2)),
    ),
    "add half planes": (
        AddHalfPlanes(),
        (equation(SumOver(1 / k, k, upper), -2 - SumOver(1 / k, k, lower)),),
        equation(SumOver(1 / k, k, upper) + SumOver(1 / k, k, lower), -2),
    ),
    "name a quotient": (EquateRatio(name), (equation(2 * p / q, e),), equation(name, e / 2)),
    "square": (SquareSides(), (equation(p, q + 1),), equation(p**2, (q + 1) ** 2)),
    "let vanish": (PutZero(name), (equation(name, q - 1),), equation(q - 1)),
    # half-planes: cos k = -i has one root above the axis in each period, at Re k = pi/2
    "parts on a line": (
        PartsOnLine({k: x + sp.I * p}, (name, rate)),
        (equation(L(k), sp.exp(sp.I * k)),),
        sp.Tuple(equation(name, sp.exp(-p) * sp.cos(x)), equation(rate, sp.exp(-p) * sp.sin(x))),
    ),
    "count, one": (
        CountAbove(k, 0, name),
        (equation(L(k), 2 - 2 * sp.I * sp.cos(k)), equation(rate, 2), equation(rate, 2)),
        equation(name, 1),
    ),
    "count, none": (
        CountAbove(k, -1, name),
        (equation(L(k), 2 - 2 * sp.I * sp.cos(k)), equation(rate, 2), equation(rate, 2)),
        equation(name, 0),
    ),
    # cycles of a cell, at amplitudes 1 and 2
    "stationary amplitudes": (StationaryAmplitudes(r, (p, q)), (RATE,), SQUARES),
    "decay, outer": (DecayAtRoot(r, 1, name), (RATE, SQUARES), equation(name, 24)),
    "decay, inner": (DecayAtRoot(r, 0, name), (RATE, SQUARES), equation(name, -6)),
    "ratio of amplitudes": (RatioOfAmplitudes(2), (SQUARES,), equation(2 * p / q, 1)),
    "factor radicals": (
        FactorRadicals(),
        (equation(name, sp.sqrt(p**2 + 2 * p * q + q**2)),),
        equation(name, p + q),
    ),
    "select a root": (
        SelectRoot("a positive value", lambda value: value.real > 0, {q: (1.0, 2.0)}),
        (sp.Tuple(equation(p, -q), equation(p, q)),),
        equation(p, q),
    ),
    "branch of a law": (
        TakeBranch(1),
        (equation(name, 2 * sp.Piecewise((p, u < 0), (q, u > 0))),),
        equation(name, 2 * q),
    ),
    "move alike": (
        MoveUniformly(y, n),
        (equation(here.diff(t) + y(n + 1, t) - 2 * here + y(n - 1, t)),),
        equation(here.diff(t)),
    ),
    "linearise at rest": (
        LineariseAtRest(z),
        (equation(z_here.diff(t), p * z_here + z_here**3),),
        equation(z_here.diff(t) - p * z_here),
    ),
    "cycles of a cell": (
        FindCycles(),
        (RADIUS,),
        sp.Tuple(equation(sp.Symbol("r_1"), 1), equation(sp.Symbol("r_2"), 2)),
    ),
    "growth of cycles": (
        GrowthRates(),
        (RADIUS, sp.Tuple(equation(sp.Symbol("r_1"), 1), equation(sp.Symbol("r_2"), 2))),
        sp.Tuple(
            equation(sp.Symbol("lambda_1"), sp.Rational(3, 4)), equation(sp.Symbol("lambda_2"), -3)
        ),
    ),
    "ratio of cycles": (RatioOfCycles(), (RADIUS,), equation(ratio, HALF)),
    "front of a cell": (
        FrontOfCell(q),
        (equation(ratio, HALF), RADIUS),
        equation(
            sp.Abs(
                SumOver(
                    1 / (front.k * (-sp.I * front.v - sp.I * q * sp.sin(front.k))),
                    front.k,
                    front.M_plus,
                )
            ),
            1,
        ),
    ),
    # finite chains
    "free ends": (
        CloseChain(y, n, t, 3, Ends.FREE),
        (equation(here.diff(t) + 2 * here - y(n + 1, t) - y(n - 1, t)),),
        sp.Tuple(
            equation(y(1, t).diff(t) + y(1, t) - y(2, t)),
            equation(y(2, t).diff(t) + 2 * y(2, t) - y(3, t) - y(1, t)),
            equation(y(3, t).diff(t) + y(3, t) - y(2, t)),
        ),
    ),
    "ring": (
        CloseChain(y, n, t, 3, Ends.RING),
        (equation(here.diff(t) - y(n + 1, t)),),
        sp.Tuple(*(equation(y(site, t).diff(t) - y(site % 3 + 1, t)) for site in (1, 2, 3))),
    ),
    "first order": (
        WriteFirstOrder(rate, (p, q), t),
        (equation(2 * f.diff(t, 2) + w * f), equation(name, sp.ImmutableMatrix([f, f.diff(t)]))),
        equation(rate, sp.ImmutableMatrix([q, -w * p / 2])),
    ),
    "linearise a system": (
        LineariseSystem((p,), (q,), name),
        (equation(rate, sp.ImmutableMatrix([p**3])),),
        equation(name, sp.ImmutableMatrix([3 * p**2 * q])),
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
    "resonant part": (
        ResonantPart(s),
        (equation(name, p * sp.cos(s) + q * sp.cos(2 * s)),),
        equation(name, p / 2),
    ),
    # dispersion: w² = 1 + 2 q (1 - cos k)
    "group velocity": (
        DifferentiateDispersion(w, k, SLOPES[:2]),
        (BAND,),
        sp.Tuple(
            equation(SLOPES[0], q * sp.sin(k) / w),
            equation(SLOPES[1], (q * sp.cos(k) - SLOPES[0] ** 2) / w),
        ),
    ),
    "fastest wave": (
        FastestWave(w, k),
        (DifferentiateDispersion(w, k, SLOPES)(BAND), BAND),
        FASTEST,
    ),
    "at the fastest wave": (
        AtFastestWave(w, k),
        (DifferentiateDispersion(w, k, SLOPES)(BAND), BAND, FASTEST),
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
    "real wave": (
        RealWave(w),
        (equation(-2 * w**2 + 3 + sp.I * e * w),),
        equation(w**2, sp.Rational(3, 2)),
    ),
    "name what is negative": (
        NameNegative(u, p),
        (sp.Tuple(equation(u, -3), equation(q, 1)),),
        sp.Tuple(equation(p, 3), equation(q, 1)),
    ),
    # transforms
    "Fourier transform": (
        FourierTransform(zeta, k, profile, F),
        (equation(profile(zeta).diff(zeta) + profile(zeta + 1), sp.Heaviside(-zeta, HALF)),),
        equation((sp.I * k + sp.exp(sp.I * k)) * F(k), sp.I / k),
    ),
    "factor": (
        ReadFactor(F(k), L(k)),
        (equation((sp.I * k + sp.exp(sp.I * k) + sp.exp(-sp.I * k)) * F(k), 1),),
        equation(L(k), sp.I * k + 2 * sp.cos(k)),
    ),
    "divide a transform": (
        SolveTransform(F(k)),
        (equation((p + k) * F(k), sp.I / k), equation(L(k), p + k)),
        equation(F(k), sp.I / (k * L(k))),
    ),
    "invert a transform": (
        InvertTransform(zeta, k, profile(zeta)),
        (equation(F(k), 1 / L(k)),),
        contour(1 / (2 * sp.pi * L(k))),
    ),
    "derivative": (NameDerivative(k, name), (equation(L(k), p * k**2),), equation(name, 2 * p * k)),
    "eliminate on roots": (
        EliminateOnRoots(p),
        (equation(name, p * k), equation(L(k), p - k**2)),
        equation(name, k**3),
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
    "equate right sides": (EquateRightSides(), (equation(p, q), equation(p, e)), equation(q, e)),
    "evaluate a branch": (
        EvaluateBranch(u, 0, 1),
        (equation(L(u), sp.Piecewise((u + 1, u < 0), (u + 2, u > 0))),),
        equation(L(0), 2),
    ),
    "locate steps": (
        LocateSteps(),
        (
            equation(name, sp.Heaviside(u - q, HALF)),
            sp.Equivalent(sp.Gt(u, q), sp.Lt(s, 0), evaluate=False),
        ),
        equation(name, sp.Heaviside(-s, HALF)),
    ),
    "moving frame": (
        EnterMovingFrame(n, t, zeta),
        (
            equation(here.diff(t), y(n + 1, t)),
            sp.Tuple(
                equation(here, profile(n - v * t)), equation(profile(n - v * t), profile(zeta))
            ),
        ),
        equation(-v * profile(zeta).diff(zeta), profile(zeta + 1)),
    ),
    "modulus": (TakeModulus(), (equation(name, rate),), equation(sp.Abs(name), sp.Abs(rate))),
    # modulation: Duffing's frequency 1 + 3/8 e a² - 15/256 e² a⁴ (Nayfeh), a = 2 |A|;
    # a damped oscillator turns at sqrt(1 - e²/4); Van der Pol's cycle at 1 - e²/16
    "scales, damped": (
        ScalesToSecondOrder(e, z),
        (DAMPED,),
        equation(z_here.diff(t), (-e / 2 - sp.I * e**2 / 8) * z_here),
    ),
    "scales, stiff": (
        ScalesToSecondOrder(e, z),
        (DUFFING,),
        equation(
            z_here.diff(t),
            sp.I * (sp.Rational(3, 2) * e * SIZE - sp.Rational(15, 16) * e**2 * SIZE**2) * z_here,
        ),
    ),
    "average, damped": (
        AverageToSecondOrder(e, z),
        (DAMPED,),
        equation(z_here.diff(t), (-e / 2 - sp.I * e**2 / 8) * z_here),
    ),
    "fundamental": (
        FundamentalOfAverage(e, z, name),
        (DAMPED,),
        equation(name, -sp.I / 2 * (z_here - sp.I * e / 4 * z_here)),
    ),
    "change of amplitude": (
        ChangeAmplitude(e, z, F),
        (AverageToSecondOrder(e, z)(DUFFING), FundamentalOfAverage(e, z, name)(DUFFING)),
        ScalesToSecondOrder(e, F)(DUFFING),
    ),
    "next harmonics": (
        NextHarmonics(e, z, name, w),
        (DUFFING,),
        equation(name, z_here**3 * w**3 / 8 + sp.conjugate(z_here) ** 3 / w**3 / 8),
    ),
    "amplitude of a cycle": (
        CycleAmplitude(e, z, q),
        (ScalesToSecondOrder(e, z)(BALANCED),),
        equation(q / 4 - 1),
    ),
    "fundamental of a cycle": (
        CycleFundamental(e, z, q, name),
        (ScalesToSecondOrder(e, z)(BALANCED),),
        equation(name, sp.sqrt(q) / 2),
    ),
    "lower powers": (
        EliminatePowers(q),
        (equation(name, q**2 + 1), equation(q - 4)),
        equation(name, 17),
    ),
}


def test_van_der_pol_turns_more_slowly_at_second_order():
    modulation = ScalesToSecondOrder(e, z)(BALANCED)
    found = CycleFrequency(e, z, q, name)(modulation)
    assert same(equation(name, found.rhs.subs(q, 4)), equation(name, 1 - e**2 / 16))


def test_closing_the_contour_gives_the_residues_on_either_side():
    slope = sp.Symbol("L_k")
    integral = contour(sp.I / (2 * sp.pi * k * L(k)))
    found = CloseContour(zeta, k, slope)(integral, equation(L(k), p - sp.I * v * k), HALF_PLANES)
    (behind, _), (ahead, _) = found.rhs.args
    at_root = sp.exp(sp.I * k * zeta) / (k * slope)
    assert sp.simplify(ahead + SumOver(at_root, k, upper)) == 0
    assert sp.simplify(behind - 1 / p - SumOver(at_root, k, lower)) == 0


def numerical(side, **values):
    """An expression with integrals over k, by mpmath."""
    plain = side.subs({sp.Symbol(letter, positive=True): value for letter, value in values.items()})
    for integral in plain.atoms(sp.Integral):
        own, low, high = integral.limits[0]
        inner = sp.lambdify(own, integral.function, "mpmath")
        if high is sp.oo:  # period by period while the integrand oscillates
            bounds = [*(2 * mp.pi * place for place in range(60)), mp.inf]
        else:
            bounds = [mp.mpf(sp.N(low)), mp.mpf(sp.N(high))]
        plain = plain.subs(integral, sp.sympify(mp.quad(inner, bounds)))
    return complex(plain.evalf())


def test_a_contour_on_the_real_axis_keeps_its_value():
    # With L = p + i q k the profile is a decaying exponential: at zero half of the jump, here 1/p.
    found = LayOnRealAxis(zeta, k)(
        contour(sp.I / (2 * sp.pi * k * L(k))), equation(L(k), p + sp.I * q * k)
    )
    assert found.lhs == profile(0)
    assert numerical(found.rhs, p=0.7, q=1.3) == pytest.approx(1 / 0.7)


def test_the_sum_over_periods_keeps_the_integral():
    whole = equation(name, sp.Integral(1 / ((2 + sp.cos(k)) ** 2 + q**2 * k**2), (k, 0, sp.oo)))
    found = SumOverPeriods(k)(whole)
    (one,) = found.rhs.atoms(sp.Integral)
    assert one.limits[0][1:] == (-sp.pi, sp.pi)
    # The quadrature up to infinity is good to 7e-9 here.
    assert numerical(found.rhs, q=0.8) == pytest.approx(numerical(whole.rhs, q=0.8), rel=1e-7)
    with pytest.raises(OperationError, match="periodic"):
        SumOverPeriods(k)(equation(name, sp.Integral(1 / ((2 + k) ** 2 + k**2), (k, 0, sp.oo))))


@pytest.mark.parametrize("sign", [1, -1])
def test_the_static_limit_is_approached(sign):
    velocity = sp.Symbol("v", real=True)
    wide = (2 + sp.cos(k)) / velocity
    moving = equation(
        name,
        sp.Integral(
            sp.sinh(wide) / (sp.cosh(wide) - sp.cos(k)) / (2 + sp.cos(k)), (k, -sp.pi, sp.pi)
        ),
    )
    found = StaticLimit(velocity, sign)(moving)
    near = numerical(moving.rhs.subs(velocity, sign * sp.Rational(1, 40)))
    assert numerical(found.rhs) == pytest.approx(near, rel=1e-12)
    assert found.rhs.has(sp.Integral)


def test_the_integral_over_a_period_is_that_of_samples():
    whole = equation(name, sp.Integral(1 / (2 - sp.cos(k)), (k, -sp.pi, sp.pi)))
    assert numerical(IntegratePeriod()(whole).rhs) == pytest.approx(2 * mp.pi / mp.sqrt(3))
    with pytest.raises(OperationError, match="rational"):
        IntegratePeriod()(equation(name, sp.Integral(sp.exp(sp.cos(k)), (k, -sp.pi, sp.pi))))


BY_THEMSELVES = {
    CycleFrequency,
    CloseContour,
    LayOnRealAxis,
    SumOverPeriods,
    StaticLimit,
    IntegratePeriod,
}
"""Operations whose answer is not in a table: the tests above."""


@pytest.mark.parametrize(
    ("operation", "sources"),
    [
        (PrescribeCoefficients((((name,), sp.S.One),), (p,)), (equation(q * name),)),
        (DivideByPositive(u), (equation(p, q),)),
        (TakeNegativeBranch(u), (equation(abs(x)),)),
        (RenameField(f, here, t), (equation(f, p),)),
        (ParametriseRadical(p, q), (equation(name, q),)),
        (VanishingDenominator(p), (equation(e, p),)),
        (ScaledLimit({k: p * q}, q, name), (equation(rate, k),)),
        (PutZero(name), (equation(rate, q),)),
        (CountAbove(k, 0, name), (equation(L(k), sp.cos(k)), equation(rate, x), equation(rate, 1))),
        (StationaryAmplitudes(r, (p, q)), (equation(r.diff(t), r * (1 - r**2)),)),
        (
            SelectRoot("x", lambda value: True, {q: (1.0,)}),
            (sp.Tuple(equation(p, q), equation(p, -q)),),
        ),
        (
            WriteFirstOrder(rate, (p, q), t),
            (
                equation(f.diff(t, 2) + sp.sin(t)),
                equation(name, sp.ImmutableMatrix([f, f.diff(t)])),
            ),
        ),
        (ReadMatrix((p,), name), (equation(rate, sp.ImmutableMatrix([p**2])),)),
        (RealWave(w), (equation(w**2 + w),)),
        (FourierTransform(zeta, k, profile, F), (equation(profile(zeta) ** 2, 1),)),
        (FourierTransform(zeta, k, profile, F), (equation(profile(zeta), sp.Heaviside(zeta)),)),
        (SolveTransform(F(k)), (equation(k * F(k), 1), equation(L(k), p))),
        (EquateRightSides(), (equation(p, q), equation(e, q))),
        (
            LocateSteps(),
            (equation(name, u), sp.Equivalent(sp.Gt(u, q), sp.Lt(s, 0), evaluate=False)),
        ),
        (
            EnterMovingFrame(n, t, zeta),
            (
                equation(here.diff(t), t),
                sp.Tuple(
                    equation(here, profile(n - v * t)), equation(profile(n - v * t), profile(zeta))
                ),
            ),
        ),
    ],
)
def test_what_cannot_be_carried_out_is_refused(operation, sources):
    with pytest.raises(OperationError):
        operation(*sources)
