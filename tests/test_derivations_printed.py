"""The verdict on each printed equation is what its check finds."""

import json
from functools import lru_cache

import pytest
import sympy as sp

from derivations import catalogue
from derivations import judgement as printed
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import value
from derivations.averaging.symbols import phi
from derivations.printing import EquationVerdict
from derivations.symbols import a, b, c, epsilon, n, omega, t

MISPRINTS = {2, 3, 4, 32, 33, 42}
AMBIGUOUS = {6, 35, 37, 44, 45, 51, 53}
INCONSISTENT = {36, 40}
ASSUMPTIONS = {9, 12, 17, 27, 47}
DEFINITIONS = {1, 7, 8, 13, 22, 31, 39, 46, 52}


@lru_cache(maxsize=8)
def report_of(key):
    return printed.report((key,))


@pytest.fixture(scope="module")
def report():
    parts = [report_of(key) for key in catalogue.NUMBERED]
    judgements = sorted((j for part in parts for j in part.judgements), key=number_of)
    failures = tuple(text for part in parts for text in part.failures)
    return printed.EquationReport(
        judgements=tuple(judgements), failures=failures,
        seconds=sum(part.seconds for part in parts),
    )  # fmt: skip


def number_of(judgement):
    return judgement.printed.number


@pytest.mark.parametrize("key", catalogue.NUMBERED)
def test_every_step_and_every_verdict_of_a_derivation_is_confirmed(key):
    report = report_of(key)
    assert report.failures == ()
    found = tuple(number_of(judgement) for judgement in report.judgements)
    assert found == catalogue.numbers_of(key)


@pytest.mark.parametrize(("key", "order"), [("averaging", 2), ("second-order", 1)])
def test_every_step_beyond_the_first_order_holds(key, order):
    derivation = catalogue.load(key, order)
    assert len(derivation.verify()) == len(derivation.steps)
    assert order == 1 or len(derivation.steps) > len(catalogue.load(key).steps)


def test_every_number_has_one_confirmed_verdict(report):
    assert [found.printed.number for found in report.judgements] == list(range(1, 55))
    assert report.failures == ()
    assert all(found.confirmed for found in report.judgements)


def test_the_verdicts_are_these(report):
    by_kind = {
        kind: {q.printed.number for q in report.judgements if q.printed.verdict == kind}
        for kind in EquationVerdict
    }
    assert by_kind[EquationVerdict.MISPRINT] == MISPRINTS
    assert by_kind[EquationVerdict.AMBIGUOUS] == AMBIGUOUS
    assert by_kind[EquationVerdict.INCONSISTENT] == INCONSISTENT
    assert by_kind[EquationVerdict.ASSUMPTION] == ASSUMPTIONS
    assert by_kind[EquationVerdict.DEFINITION] == DEFINITIONS


def test_a_misprint_fails_its_check_and_its_correction_passes(report):
    for found in report.judgements:
        if found.printed.number in MISPRINTS:
            assert not found.on_print.holds
            assert found.on_derived.holds
            assert found.corrected


def test_the_record_of_each_equation_is_plain_data(report):
    for found in report.judgements:
        record = json.loads(json.dumps(found.record()))
        assert record["verdict"] in {kind.value for kind in EquationVerdict}
        assert record["note"]
        assert (record["corrected"] is None) == (record["number"] not in MISPRINTS | AMBIGUOUS)


def test_a_false_verdict_would_not_be_confirmed():
    from dataclasses import replace

    derivation = catalogue.load("friction")
    claimed = replace(printed.printed(2), verdict=EquationVerdict.HOLDS)
    assert not printed.judge(claimed, derivation).confirmed
    claimed = replace(printed.printed(5), verdict=EquationVerdict.MISPRINT)
    assert not printed.judge(claimed, derivation).confirmed


def test_the_misprint_in_33_does_not_reach_34():
    # Average the printed (33) by equal samples of one period and compare with (34).
    wrong = printed.printed(33).expression.lhs
    point = {a: 1.7, b: 0.6, c: 0.4, epsilon: 0.3, omega: 1.1, phi(n, t).diff(t): 0.3j,
             phi(n, t): 0.8 - 0.3j, phi(n - 1, t): 0.2 + 0.5j,
             phi(n + 1, t): -0.4 + 0.1j}  # fmt: skip
    period = 2 * sp.pi.evalf() / 1.1
    # The highest harmonic of (33) is 6 omega, so 8 samples average it exactly.
    derived = catalogue.load("averaging").numbered(34).result.lhs
    mean = sum(value(wrong, {**point, t: float(k * period / 8)}) for k in range(8)) / 8
    assert mean == pytest.approx(value(derived, point), abs=1e-13)


def test_the_signs_of_34_are_those_of_print_and_no_others():
    step = catalogue.load("averaging").numbered(34)
    left = printed.printed(34).expression.lhs
    assert step.verify(printed.printed(34).expression).holds
    for term in sp.Add.make_args(left):
        assert not step.verify(sp.Eq(left - 2 * term, 0)).holds


def test_print_agrees_symbolically_with_what_is_derived_where_it_holds(report):
    for found in report.judgements:
        if found.printed.verdict is not EquationVerdict.MISPRINT:
            # (47) is printed without the modulus that complex envelopes need.
            assert found.agrees or found.printed.number in {6, 44, 45, 47, 51, 53}, number_of(found)
        else:
            assert not found.agrees


def test_a_number_that_the_paper_does_not_have_is_refused():
    with pytest.raises(DerivationInputError, match="from 1 to 54"):
        printed.printed(55)
    with pytest.raises(DerivationInputError, match="from 1 to 54"):
        catalogue.owner(0)
