"""Each closed form of ``theory`` is the derived expression, at random parameters.

The two packages share no code: ``derivations`` never imports ``theory``, and only tests import
both. Random parameters come from fixed seeds.
"""

import math
import random
from functools import partial

import numpy as np
import pytest
import sympy as sp

import theory.cells.vdp
from derivations import catalogue
from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import solved_for, value
from derivations.cell.envelope import derive_envelope
from derivations.front.numbers import Lattice, count_between, evaluated
from derivations.front.symbols import (
    L,
    L_k,
    M_plus,
    V,
    c,
    c_pin,
    eta,
    k,
    over_roots,
    phi,
    phi_s,
    ratio,
    static_sum,
    strong_sum,
    v,
    zeta,
)
from theory.piecewise import dispersion, limits
from theory.piecewise.profile import front_profile, front_profile_by_roots
from theory.piecewise.roots import labelled_roots, strip_bounds
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.series import sum_by_roots

SUMS = (sum_by_integral, sum_by_quadrature, sum_by_roots, sum_by_bessel)


@pytest.fixture(scope="module")
def front():
    return catalogue.load("piecewise-front")


def lattice(spring):
    return Lattice(0.5, (spring,))


def pairs(seed, count=4):
    rng = random.Random(seed)
    return [(rng.uniform(0.3, 1.5), rng.uniform(0.2, 1.2)) for _ in range(count)]


def test_50_the_dispersion_relation(front):
    rng = random.Random(1)
    for fast, spring in pairs(1):
        number = complex(rng.uniform(-8, 8), rng.uniform(-2, 2))
        point = {v: fast, c: spring, k: number}
        derived = solved_for(front.numbered(50).result, L(k), point)
        assert complex(dispersion.dispersion(np.array(number), fast, spring)) == pytest.approx(
            derived
        )


def test_51_its_slope_at_any_k(front):
    rng = random.Random(2)
    for fast, spring in pairs(2):
        number = complex(rng.uniform(-8, 8), rng.uniform(-2, 2))
        point = {v: fast, c: spring, k: number}
        derived = solved_for(front.named("slope of the dispersion").result, L_k, point)
        found = complex(dispersion.dispersion_slope(np.array(number), fast, spring))
        assert found == pytest.approx(derived)


def test_51_as_printed_agrees_on_the_labelled_roots_only(front):
    printed = front.numbered(51).result
    for fast, spring in pairs(3):
        for number in labelled_roots(fast, spring, np.arange(-2, 3), True).k:
            point = {v: fast, c: spring, k: complex(number)}
            found = complex(dispersion.dispersion_slope(number, fast, spring))
            assert solved_for(printed, L_k, point) == pytest.approx(found, rel=1e-10)
            off = {**point, k: complex(number) + 0.3}
            elsewhere = complex(dispersion.dispersion_slope(number + 0.3, fast, spring))
            assert abs(solved_for(printed, L_k, off) - elsewhere) > 1e-3


@pytest.mark.parametrize("upper", [True, False])
def test_52_each_strip_of_a_label_holds_one_root_by_the_winding_number(upper):
    labels = np.arange(-2, 3)
    for fast, spring in pairs(4, 2):
        found = labelled_roots(fast, spring, labels, upper).k
        for low, high, root in zip(*strip_bounds(labels, upper), found, strict=True):
            assert count_between(lattice(spring), fast, low, high, upper) == 1
            assert low < root.real < high


@pytest.mark.parametrize("method", SUMS)
def test_53_every_sum_is_the_derived_sum_over_roots(method):
    for fast, spring in pairs(5, 2):
        derived = evaluated(over_roots(1, M_plus), {v: fast, c: spring}, lattice(spring), fast)
        found = complex(method(fast, spring).value)
        # The derived side is an extrapolated series of 8000 roots, good to about 1e-10.
        assert found == pytest.approx(derived, abs=1e-7)


@pytest.mark.parametrize("name", ["sum on the real axis", "sum over one period"])
def test_the_derived_integrals_are_those_of_theory(front, name):
    integral = front.named(name).result.rhs
    for fast, spring in pairs(6, 3):
        found = complex(sum_by_integral(fast, spring).value)
        derived = evaluated(integral, {v: fast, c: spring}, lattice(spring), fast)
        assert found == pytest.approx(derived, abs=1e-8)


@pytest.mark.parametrize("profile", [front_profile, partial(front_profile_by_roots, count=200)])
def test_49_the_profile(front, profile):
    right = front.numbered(49).result.rhs
    for (fast, spring), place in zip(pairs(7), (-2.3, -0.6, 0.4, 1.7), strict=True):
        branch = right.xreplace({zeta: sp.Float(place)})
        point = {v: fast, c: spring, phi_s: 1, zeta: place}
        derived = evaluated(branch, point, lattice(spring), fast)
        found = profile([place], fast, spring)
        assert complex(found.phi[0]) == pytest.approx(derived, abs=found.error + 1e-7)
    assert front.numbered(49).result.lhs == phi(zeta)


def test_54_the_ratio_of_the_cycles(front):
    relation = parts_of(front.numbered(54).result)[1].rhs / 2
    cell = derive_envelope("1 - a*y**2 + b*y**4")
    rng = random.Random(8)
    for _ in range(5):
        a = rng.uniform(1, 5)
        b = rng.uniform(0.01, 0.12) * a * a
        number = theory.cells.vdp.eta_from_damping(a, b)
        found = theory.cells.vdp.threshold_ratio(number)
        assert found == pytest.approx(value(relation, {eta: number}).real, rel=1e-12)
        inner, outer = cell.compiled(a=a, b=b, c=0.1).amplitudes
        assert found == pytest.approx(inner / outer, rel=1e-9)
        slope = value(sp.diff(relation, eta), {eta: number}).real
        assert theory.cells.vdp.threshold_ratio_slope(number) == pytest.approx(slope, rel=1e-10)
        assert theory.cells.vdp.eta_from_ratio(found) == pytest.approx(number, rel=1e-12)


def test_the_static_sum_and_pinning(front):
    static = front.named("static sum").result
    threshold = front.named("pinning coupling").result
    rng = random.Random(9)
    for _ in range(5):
        spring, number = rng.uniform(0.05, 3), rng.uniform(0.002, 0.079)
        derived = solved_for(static, static_sum, {c: spring})
        assert limits.static_sum(spring) == pytest.approx(derived)
        r = theory.cells.vdp.threshold_ratio(number)
        expected = solved_for(threshold, c_pin, {ratio: r}).real
        assert limits.pinning_coupling(number) == pytest.approx(expected, rel=1e-9)
        assert limits.pinning_eta(expected) == pytest.approx(number, rel=1e-9)


def test_pinning_ends_where_derived(front):
    derived = front.named("largest η of pinning").result
    assert pytest.approx(float(derived.rhs)) == limits.ETA_PIN_END
    assert limits.pinning_coupling(0.0799) is not None
    assert limits.pinning_coupling(0.0801) is None


def test_the_limit_of_strong_coupling(front):
    total = front.named("strong sum").result
    relation = front.named("relation at strong coupling").result
    rng = random.Random(10)
    for _ in range(4):
        number = rng.uniform(0.003, 0.07)
        fast = limits.strong_coupling_velocity(number)
        found = solved_for(total, strong_sum, {V: fast})
        point = {strong_sum: found, ratio: theory.cells.vdp.threshold_ratio(number)}
        assert value(relation.lhs, point).real == pytest.approx(value(relation.rhs, point).real)
        assert complex(limits.strong_coupling_sum(fast)) == pytest.approx(found)


def test_weak_thresholds_follow_from_the_derived_integral(front):
    # At large v the derived sum tends to i c / (4 v^2): the ratio to theory's limit tends to 1.
    integral = front.named("sum over one period").result.rhs
    errors = []
    for number in (1e-4, 1e-6):
        fast = limits.weak_threshold_velocity(0.5, number)
        size = abs(evaluated(integral, {v: fast, c: 0.5}, lattice(0.5), fast))
        errors.append(abs(size / (2 * theory.cells.vdp.threshold_ratio(number)) - 1))
    assert errors[1] < errors[0] / 2
    assert math.isclose(errors[1], 0, abs_tol=0.05)
