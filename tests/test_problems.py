"""The table of test problems keeps its own rule, and ``QUANTITIES`` of each module its contract."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from theory.averaged.breather import Reading, closed_form_fold
from theory.cells.vdp import ETA_END
from theory.parameters import ParameterError
from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.kinetic_relation import kinetic_relation
from theory.piecewise.limits import ETA_PIN_END
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities import registry
from verification.quantities.problems import PROBLEMS, Problem, timed
from verification.quantities.quantity import Quantity
from verification.quantities.registry import (
    all_computations,
    all_quantities,
    computation_named,
    quantity_named,
)

RECORDS = Path(__file__).parents[1] / "benchmarks" / "results"
NO_AXES = {"low", "high", "order", "t", "sites", "rows", "a"}
"""Parameters of a whole run or sweep, and a, which changes only the unit of y."""


@pytest.mark.parametrize("family", PROBLEMS)
def test_problems_of_a_family_have_names_tags_and_the_same_parameters(family: str) -> None:
    problems = PROBLEMS[family]
    names = [problem.name for problem in problems]
    assert len(set(names)) == len(names)
    assert all(name.replace("-", "").isalnum() and name == name.lower() for name in names)
    assert len({frozenset(problem.values) for problem in problems}) == 1
    for problem in problems:
        assert problem.tags
        assert {*problem.tags} <= {"ordinary", "stiff", "extreme"}
        assert "ordinary" not in problem.tags or len(problem.tags) == 1
    assert timed(family)[0] is problems[0]
    ordinary = [problem.tags == ("ordinary",) for problem in problems]
    assert ordinary == sorted(ordinary, reverse=True)  # first, and not all of them
    assert ordinary[0]
    assert not ordinary[-1]


def test_the_tags_of_the_sum_follow_from_its_numbers() -> None:
    for problem in PROBLEMS["sum"]:
        extreme = any(not 1e-3 < value < 1e3 for value in problem.values.values())
        easy = root_free_strip(problem.v, problem.c) >= 0.1 and problem.c / problem.v <= 10.0
        assert ("extreme" in problem.tags) == extreme, problem.name
        assert ("ordinary" in problem.tags) == (easy and not extreme), problem.name


def test_every_family_is_that_of_a_quantity_which_uses_its_parameters() -> None:
    assert {quantity.problems for quantity in all_quantities()} == set(PROBLEMS)
    for family, problems in PROBLEMS.items():
        rows = [row for row in all_computations() if row.problems == family]
        rows += [
            row for each in all_quantities() if each.problems == family for row in each.computations
        ]
        used = {axis.name for row in rows for axis in row.axes}
        if used:
            assert set(problems[0].values) <= used | NO_AXES, family


@pytest.mark.parametrize("quantity", all_quantities(), ids=lambda quantity: quantity.name)
def test_a_quantity_says_its_equation_its_reference_and_how_good_it_is(quantity: Quantity) -> None:
    assert quantity.equation.startswith("(")
    assert quantity.title
    assert quantity.reference
    assert quantity.default
    assert 0 < quantity.accuracy < 0.1
    assert quantity.test_problems
    assert bool(quantity.timed_problems) == bool(quantity.useful)


def test_problems_in_its_ranges_are_points_of_a_computation() -> None:
    for row in all_computations():
        inside = [
            problem
            for problem in PROBLEMS.get(row.problems, ())
            if all(
                axis.low <= problem[axis.name] <= axis.high
                for axis in row.axes
                if axis.name in problem.values
            )
        ]
        first = row.fixed_points[: len(inside)]
        for problem, point in zip(inside, first, strict=True):
            assert all(point[name] == problem[name] for name in point if name in problem.values)
        every_other = [row.point(0, 2 * number) for number in range(len(row.fixed_points))]
        assert every_other == list(row.fixed_points)


def test_what_is_not_there_is_refused() -> None:
    with pytest.raises(ParameterError, match="quantity = nothing"):
        quantity_named("nothing")


def test_two_quantities_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    twice = {module: (all_quantities()[0],) for module in ("one", "other")}
    monkeypatch.setattr(registry, "exposed", lambda *_: twice)
    with pytest.raises(ValueError, match=f"quantities.*{all_quantities()[0].name}"):
        all_quantities.__wrapped__()


def test_two_computations_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    first = all_computations()[0]
    monkeypatch.setattr(registry, "computations_of_chains", lambda: (first,))
    with pytest.raises(ValueError, match=f"computations.*{first.name}"):
        all_computations()


def test_a_problem_is_what_it_is_called() -> None:
    """Fronts by the kinetic relation, breathers by the closed form."""
    named = {problem.name: problem for problem in PROBLEMS["relation"]}
    found = {
        name: kinetic_relation(named[name].c, named[name]["eta"])
        for name in ("ordinary", "hysteresis", "pinned", "retreat", "three-at-a-resonance")
    }
    folds = found["hysteresis"].c_fold, found["hysteresis"].c_pin
    assert None not in folds
    assert folds[0] < named["hysteresis"].c < folds[1] < named["ordinary"].c
    assert named["pinned"].c < found["pinned"].c_fold
    assert [branch.v < 0.0 for branch in found["retreat"].branches] == [True]
    assert len(found["three-at-a-resonance"].branches) == 3
    assert named["no-pinning-from-here"]["eta"] == ETA_PIN_END
    assert named["cycles-gone"]["eta"] > ETA_END
    for family in ("relation", "breather"):
        (meeting,) = (each for each in PROBLEMS[family] if each.name == "cycles-meet")
        assert 0.0 < 1.0 - meeting["eta"] / ETA_END < 1e-8
    for family in ("breather", "multipliers"):
        for problem in PROBLEMS[family]:
            fold = closed_form_fold(problem.vdp_chain(), Reading.NEIGHBOUR).c
            assert (0.0 < problem.c < fold) is (problem.name != "not-averageable")
            if problem.name == "beside-the-fold":
                assert problem.c > 0.95 * fold


@pytest.mark.parametrize(
    ("family", "which", "number", "name"),
    [
        ("sum", min, lambda each: each.v, "small-v"),
        ("sum", min, lambda each: each.c, "weak-coupling"),
        ("sum", max, lambda each: each.c, "larger-c"),
        ("sum", max, lambda each: each.v / each.c, "large-v-over-c"),
        ("sum", min, lambda each: each.v / each.c, "small-v-over-c"),
        ("relation", max, lambda each: each.c / each["eta"], "fastest"),
        ("breather", min, lambda each: each.c, "weak"),
        ("breather", max, lambda each: each["eps"], "not-averageable"),
        ("multipliers", max, lambda each: each.sites, "long-chain"),
        ("chain", max, lambda each: each["eps"], "strong-damping"),
        ("own-chain", max, lambda each: each["far"], "next-nearest"),
        ("own-chain", max, lambda each: each["rows"], "lattice"),
        ("friction", max, lambda each: each.c * each["t"], "many-events"),
        ("front", max, lambda each: each["eps"], "full"),
        ("front", min, lambda each: each.c, "slow"),
        ("map", min, lambda each: each["eta"], "steep"),
        ("derivation", min, lambda each: each["order"], "first-order"),
        ("derivation", max, lambda each: each["order"], "second-order"),
    ],
)
def test_a_problem_has_the_largest_or_smallest_number_that_its_name_says(
    family: str, which: Any, number: Callable[[Problem], float], name: str
) -> None:
    assert which(PROBLEMS[family], key=number).name == name


def test_a_problem_has_the_number_that_its_name_says() -> None:
    numbers = {
        (family, each.name, number): each[number]
        for family, number in (("front", "eps"), ("own-chain", "rows"), ("derivation", "order"))
        for each in PROBLEMS[family]
        if each.name not in ("full", "lattice")
    }
    assert numbers == {
        ("front", "averaged", "eps"): 0.0,  # stands for the averaged chain
        ("front", "slow", "eps"): 0.0,
        ("own-chain", "next-nearest", "rows"): 1,  # second neighbours are those of a chain
        ("derivation", "first-order", "order"): 1,
        ("derivation", "second-order", "order"): 2,
    }


@pytest.mark.parametrize(
    ("name", "number", "inside", "outside"),
    [
        ("c-pin", "eta", 0.03, 0.1),
        ("c-retreat", "eta", 0.1, 0.03),
        ("strong-coupling-velocity", "eta", 0.03, 0.1),
        ("eta-pin", "c", 0.3, None),
    ],
)
def test_a_limit_is_confirmed_where_it_exists_and_denied_elsewhere(
    name: str, number: str, inside: float, outside: float | None
) -> None:
    row = computation_named(name)
    stated = row.compute({number: inside})
    assert row.check({number: inside}, stated).distance <= stated.error
    assert row.check({number: inside}, replace(stated, value=None)).distance == math.inf
    if outside is not None:
        assert row.check({number: outside}, row.compute({number: outside})).distance == 0.0
        assert row.check({number: outside}, stated).distance == math.inf


@pytest.mark.parametrize("name", ["roots", "profile"])
def test_both_half_planes_are_among_the_points(name: str) -> None:
    (side,) = (axis for axis in computation_named(name).axes if axis.name == "side")
    assert side.whole
    assert side.low < 2.0 <= side.high


def test_each_method_of_the_sum_is_tried_under_its_name_and_not_by_itself() -> None:
    for name, method, without in (
        ("integral", sum_by_integral, ""),
        ("series", sum_by_roots, "series"),
        ("precise-integral", precise_sum_by_integral, "integral"),
        ("bessel", sum_by_bessel, ""),
        ("quadrature", sum_by_quadrature, ""),
    ):
        row: Any = computation_named(f"sigma-{name}")
        assert row.title.startswith("the sum (53) ")
        assert (row.compute.args, row.check.args) == ((method,), (without,))


@pytest.mark.parametrize("name", [each.name for each in all_quantities() if each.useful])
def test_a_stored_record_has_the_problems_that_are_timed_and_an_agreement_as_stated(
    name: str,
) -> None:
    """Two references agree to all but five of their digits, or to within three orders as stated."""
    quantity = quantity_named(name)
    apart = json.loads((RECORDS / f"{name}.json").read_text(encoding="utf-8"))["agreement"]
    assert set(apart) == {each.name for each in quantity.timed_problems}
    digits = re.search(r"(\d+) digits", quantity.reference)
    most = 1.01 * 10.0 ** (5 - int(digits[1])) if digits else 1e3 * max(apart.values())
    assert max(apart.values()) <= quantity.accuracy <= most
