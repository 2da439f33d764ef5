"""The errata are found, not typed; equations are typeset whole."""

from __future__ import annotations

import re
from collections import Counter
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

from derivations import judgement as printed_module
from derivations import printing as printed_lines
from derivations.algebra.evidence import value
from derivations.averaging.symbols import phi
from derivations.catalogue import owner
from derivations.judgement import EquationJudgement
from derivations.printing import EquationVerdict
from derivations.symbols import a, b, c, epsilon, n, omega, t
from paper_checks.claim import Fault, Finding, Formula, Verdict
from paper_checks.claims import _equation_numbers, equations
from paper_checks.claims._equation_errata import LONG, _entry, correction, erratum_of
from paper_checks.report.inline_math import typeset
from paper_checks.report.mathml import LatexError, formula, mathml

MISPRINTED = {2, 4, 33, 42}
"""Found by hand when the paper was first read: lines that cannot be used as they stand."""


@pytest.fixture(scope="module")
def judgements() -> dict[int, EquationJudgement]:
    return equations.judgements()  # those that the claims judge by


@pytest.fixture(scope="module")
def findings() -> dict[int, Finding]:
    return {int(claim.key[2:]): claim.found(claim.evidence()) for claim in equations.CLAIMS}


def test_the_errata_are_those_found_by_hand(findings: dict[int, Finding]) -> None:
    found = {number: one.erratum for number, one in findings.items() if one.erratum}
    assert set(found) == MISPRINTED
    assert all(one.fault is Fault.MISPRINT for one in found.values())


def test_a_way_of_writing_is_a_remark_and_no_erratum(findings: dict[int, Finding]) -> None:
    for number in equations.STYLE:
        assert findings[number].verdict is Verdict.REPRODUCED
        assert findings[number].remarks[0] == equations.STYLE[number]


def test_each_states_what_proves_it_and_what_it_affects(findings: dict[int, Finding]) -> None:
    for number in MISPRINTED:
        erratum = findings[number].erratum
        for part in (erratum.printed, erratum.corrected, erratum.reason, erratum.affects):
            assert part.strip()
        assert "fails" in erratum.proof
        assert re.search(r"of the derivation '[a-z-]+'", erratum.proof)


@pytest.mark.parametrize(
    ("number", "right", "wrong"),
    [
        (4, r"\xi = \frac{d}{2 \sqrt{k} \sqrt{m}}", r"\omega"),
        (2, r"= \mu_{d} +", r"\mu_{st} + \left(\mu_{st}"),
        (42, r"2 a \epsilon x_{1} x_{5}", r"\epsilon x_{5} -"),
        (3, r"\leq F_{N} \mu_{st}", r"\operatorname{sign}"),
        (33, r"in place of $-", r"\epsilon"),
        (32, "= 0", "Psi"),
    ],
)
def test_a_correction_shows_what_differs_and_nothing_else(
    judgements: dict[int, EquationJudgement], number: int, right: str, wrong: str
) -> None:
    shown = correction(judgements[number])
    assert right in shown
    assert wrong not in shown.replace(r"\overline", "")


@pytest.mark.parametrize(
    ("corrected", "shown"),
    [("x = 1", "x = 1"), (None, ""), ("x" * LONG, "x" * LONG), ("x" * (LONG + 1), "")],
)
def test_the_derived_form_is_shown_unless_it_is_long(
    corrected: str | None, shown: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = SimpleNamespace(verdict=SimpleNamespace(value="holds"), note="ε", readings=(),
                           latex="x", affects="")  # fmt: skip
    said = SimpleNamespace(holds=True, statement="")
    found = SimpleNamespace(printed=line, on_print=said, on_derived=said, confirmed=True,
                            corrected=corrected, on_readings=())  # fmt: skip
    monkeypatch.setattr(equations, "judgements", lambda: {1: found})
    assert (equations.printed(1).derived, equations.printed(1).note) == (shown, "ε")


def test_of_a_matrix_the_first_entry_that_differs_is_shown_and_the_others_counted() -> None:
    printed = sp.Matrix([[1, 2, 3, 4]] * 4)
    derived = printed.copy()
    derived[1, 2], derived[3, 0], derived[3, 3] = 7, 8, 9
    matrix = sp.MatrixSymbol("M", 4, 4)
    entry = correction(made_up(sp.Eq(matrix, printed), sp.Eq(matrix, derived)))
    assert entry == _entry(printed, derived)
    assert entry.startswith("the entry (2, 3) for N = 2 is $7$")
    assert "2 others" in entry


@pytest.mark.parametrize("line", ["x = 2", None])
@pytest.mark.parametrize("verdict", [EquationVerdict.AMBIGUOUS, EquationVerdict.INCONSISTENT])
def test_of_a_changed_line_the_last_reading_that_holds_is_the_correction(
    line: str | None, verdict: EquationVerdict
) -> None:
    """And of one that stays as it is, each that holds."""
    holding, failing = (SimpleNamespace(holds=x, statement="s") for x in (True, False))
    printed = SimpleNamespace(
        verdict=verdict, amended_latex=line, latex="x", note="", affects="",
        readings=tuple(SimpleNamespace(meaning=word) for word in ("one", "other", "third", "last")),
    )  # fmt: skip
    step = SimpleNamespace(name="step", operation="add")
    found: Any = SimpleNamespace(printed=printed, step=step, on_print=failing, on_derived=holding,
                                 on_readings=(holding, failing, holding, holding))  # fmt: skip
    erratum = erratum_of(found, "averaging")
    assert erratum.fault.name == verdict.name
    if verdict is EquationVerdict.INCONSISTENT:
        assert erratum.corrected == ("$x = 2$; last" if line else "one; or third; or last")
    else:
        assert erratum.corrected == (
            "$x = 2$; read: last" if line else "$x$; read: one; or read: third; or read: last"
        )
    assert "“other” fails" in erratum.proof


REMARKED = {
    "(fig02-stick)": "|F| <",
    "its reference velocity": r"|\tilde{F}| <",
    "The text before (7)": r"\mu_d=",
    "sign of equality": r"&\dot{\Psi}_n -",
    "for a ring": " = f(X) = ",
    "The inequalities": r"\varphi_n < \varphi_{us}",
    "argument of the step": r"\theta\left(",
    "It is the derivative": "L_k(k) =",
}
"""Words of each remark, and what only the equation prints that it is about."""


@pytest.mark.parametrize("words", REMARKED)
def test_a_remark_stands_at_the_equation_that_prints_what_it_is_about(words: str) -> None:
    about = {n for n in range(1, 55) if REMARKED[words] in printed_module.printed(n).latex}
    assert len(about) == 1
    assert {n for n, text in equations.STYLE.items() if words in text} == about


def test_every_remark_is_about_one_of_these() -> None:
    assert len(equations.STYLE) == len(REMARKED)


def test_the_correction_of_33_turns_the_printed_bracket_into_a_square(
    judgements: dict[int, EquationJudgement],
) -> None:
    found = judgements[33]
    printed, derived = found.printed.expression, found.step.result
    own, fast_time = 0.3 + 0.4j, 0.6
    rest = {a: 1.7, epsilon: 0.2, omega: 1.1, t: fast_time}
    missing = derived.args[0] - printed.args[0]
    names = dict.fromkeys(missing.atoms(AppliedUndef, sp.Derivative), 0.4 + 0.1j)
    number = value(missing, {**names, **rest, b: 0.9, c: 0.3, phi(n, t): own})
    fast = sp.exp(-2j * rest[omega] * fast_time)
    # By hand: ε (φ + φ* e)/2 times a times twice (φ*)² e over 4ω².
    bar = own.conjugate()
    by_hand = complex(
        rest[epsilon] * (own + bar * fast) / 2 * rest[a] * 2 * bar**2 * fast
        / (4 * rest[omega] ** 2)
    )  # fmt: skip
    assert abs(number - by_hand) < 1e-12


def test_a_misprint_that_passes_its_check_is_no_erratum_and_changes_the_verdict(
    monkeypatch: pytest.MonkeyPatch, judgements: dict[int, EquationJudgement]
) -> None:
    found = judgements[4]
    passing = printed_module.EquationJudgement(
        found.printed,
        found.step,
        found.corrected,
        found.on_derived,
        found.on_derived,
        (),
        True,
    )
    monkeypatch.setattr(equations, "judgements", lambda: {**judgements, 4: passing})
    finding = equations.CLAIMS[3].found(equations.CLAIMS[3].evidence())
    assert finding.erratum is None
    assert finding.verdict is not equations.CLAIMS[3].recorded


def _letters(latex: str) -> Counter[str]:
    """Letters and numbers of a formula, commands that only shape it left out."""
    plain = re.sub(r"\\(begin|end)\{\w+\}|\\[A-Za-z]+|\\.", " ", latex)
    return Counter(re.findall(r"[A-Za-z0-9]", plain))


def test_every_equation_is_typeset_and_keeps_each_letter(
    judgements: dict[int, EquationJudgement],
) -> None:
    for number, found in judgements.items():
        for latex in filter(None, (found.printed.latex, found.corrected)):
            text = mathml(latex, block=True)
            tree = ElementTree.fromstring(text)
            assert tree.tag == "math"
            shown = Counter(
                letter
                for node in tree.iter()
                if node.tag in ("mi", "mn", "mtext")
                for letter in re.findall(r"[A-Za-z0-9]", node.text or "")
            )
            words = re.findall(r"\\(sin|cos|ln|exp)(?![a-z])", latex)
            expected = _letters(latex) + Counter("".join(words))
            assert shown == expected, (number, latex)


@pytest.mark.parametrize(
    ("latex", "expected"),
    [
        (r"\frac12", "<mfrac><mn>1</mn><mn>2</mn></mfrac>"),
        (r"x_1^2", "<msubsup><mi>x</mi><mn>1</mn><mn>2</mn></msubsup>"),
        (r"e^{-x}", '<msup><mi>e</mi><mrow><mo form="prefix">−</mo><mi>x</mi></mrow></msup>'),
        (r"a=-x", '<mi>a</mi><mo>=</mo><mo form="prefix">−</mo><mi>x</mi>'),
        (r"a-x", "<mi>a</mi><mo>−</mo><mi>x</mi>"),
        (r"\hat v", '<mover accent="true"><mi>v</mi><mo>^</mo></mover>'),
        (r"a<b", "<mi>a</mi><mo>&lt;</mo><mi>b</mi>"),
        (
            r"\begin{aligned}a&=b\end{aligned}",
            '<mtable><mtr><mtd columnalign="right"><mi>a</mi></mtd>'
            '<mtd columnalign="left"><mo>=</mo><mi>b</mi></mtd></mtr></mtable>',
        ),
    ],
)
def test_formulas_become_what_the_standard_says(latex: str, expected: str) -> None:
    assert mathml(latex) == f"<math><mrow>{expected}</mrow></math>"


@pytest.mark.parametrize(
    "latex", ["{x", "x}", r"\frac1", r"\left(x", r"\begin{pmatrix}x", r"\unknown", "x_", "_1",
              r"\begin{pmatrix}x}", r"\left"],
)  # fmt: skip
def test_what_is_not_known_is_refused_and_shown_as_written(latex: str) -> None:
    with pytest.raises(LatexError):
        mathml(latex)
    assert typeset(f"see ${latex}$") == f"see <code>{latex}</code>"


def test_a_mark_of_alignment_outside_of_lines_is_refused() -> None:
    with pytest.raises(LatexError):
        mathml("a&=b")


def test_a_formula_in_a_sentence_is_no_line_of_its_own() -> None:
    assert formula("x") == mathml("x", block=False) != mathml("x", block=True)


def test_text_in_formulas_is_escaped() -> None:
    assert "<script" not in typeset(r"$\text{<script>}$")


# ------------------------------------------------------- corrections of equations that are made up


X, Y = sp.symbols("x y")


def made_up(printed: sp.Basic, derived: sp.Basic, **known: Any) -> Any:
    """Return a judgement of a misprint with these equations."""
    line = {"slip": None, "number": 99, "verdict": printed_lines.EquationVerdict.MISPRINT,
            "amended_latex": None, "latex": "x = 3", "note": "A note.", "affects": ""}  # fmt: skip
    line |= {name: known.pop(name) for name in tuple(known) if name in line}
    return SimpleNamespace(
        printed=SimpleNamespace(expression=printed, **line),
        step=SimpleNamespace(name="the limit", operation="expand", result=derived),
        on_print=SimpleNamespace(statement="print is off"),
        on_derived=SimpleNamespace(statement="nothing is left"),
        **{"corrected": "whole", **known},
    )


@pytest.mark.parametrize("line", ["x = 2", None])
def test_of_a_misprint_the_changed_line_or_what_is_derived_is_the_correction(
    line: str | None,
) -> None:
    """Beside a changed line the proof says what it changes."""
    found = made_up(X - 2 * Y, sp.Eq(X, Y), amended_latex=line, affects="ε" if line else "")
    erratum = erratum_of(found, "averaging")
    assert (erratum.fault, erratum.corrected) == (Fault.MISPRINT, f"${line or 'whole'}$")
    assert erratum.proof.startswith("The check on print fails: print is off. ")
    assert ("differs from print in this: $whole$." in erratum.proof) == bool(line)
    assert erratum.affects == ("ε" if line else "Nothing else.")


def test_the_erratum_of_an_equation_is_of_its_judgement_and_derivation(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    corrected = SimpleNamespace(verdict=equations.Verdict.CORRECTED)
    monkeypatch.setattr(equations, "judgements", lambda: {42: "judged"})
    monkeypatch.setattr(equations, "rule", lambda _: corrected)
    monkeypatch.setattr(equations, "erratum_of", lambda *given: given)
    asked: Any = SimpleNamespace(number=42)
    assert equations.erratum(asked) == ("judged", owner(42))
    corrected.verdict = equations.Verdict.REPRODUCED
    assert equations.erratum(asked) is None


@pytest.mark.parametrize(("residual", "agree"), [(None, True), (1e-12, True), (1e-6, False)])
def test_numbers_agree_if_there_are_none_or_they_are_off_by_rounding(
    residual: float | None, agree: bool
) -> None:
    one = SimpleNamespace(residual=residual)
    found = equations.CheckedEquation.numbers_agree.fget(one)  # type: ignore[attr-defined]
    assert found is agree


def test_an_equation_that_fails_and_is_no_way_of_writing_is_said_to_fail(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def said(number: int) -> str:
        one: Any = SimpleNamespace(kind="holds", passes=False, number=number)
        one.style = equations.STYLE.get(number, "")
        shown: str = equations.CheckedEquation.outcome.fget(one)  # type: ignore[attr-defined]
        return shown

    assert said(1) == "holds; the printed equation fails the numerical test"
    assert said(3).startswith("holds as it is meant")
    monkeypatch.setitem(equations.STYLE, 33, "x")
    assert said(33).endswith("fails the numerical test")  # a misprint is not a way of writing
    assert equations.MISPRINTS == MISPRINTED


def test_the_second_method_of_an_equation_is_named_by_its_words_and_its_code() -> None:
    (way,) = _equation_numbers.method(43)
    assert way.words == "numbers of the toolkit put into the printed equation"
    assert way.code == "verification.references.equations:averaged_rate"


def test_of_a_system_the_equations_that_differ_are_shown_however_they_are_written() -> None:
    printed = sp.Tuple(sp.Eq(X, 2 * Y), sp.Eq(X, 3), X < Y, X < Y, X < Y)
    derived = sp.Tuple(sp.Eq(X - 2 * Y, 0), sp.Eq(X, 4), X <= Y, X < Y, sp.Eq(Y, 7))
    assert correction(made_up(printed, derived)) == r"$x = 4$; $x \leq y$; $y = 7$"
    parts = sp.Tuple((X + Y) ** 2, X), sp.Tuple(X**2 + 2 * X * Y + Y**2, 2 * X)
    assert correction(made_up(*parts)) == "$2 x$"


def test_of_one_equation_the_whole_is_shown_and_of_a_long_one_what_it_lacks() -> None:
    printed, derived = sp.Eq(X + Y, 0), sp.Eq(X + Y + X * Y, 0)
    assert correction(made_up(printed, derived)) == "$whole$"
    shown = correction(made_up(printed, derived, corrected="x" * 1000))
    assert shown == "add to the left side $x y$"


def test_of_an_expression_without_a_sign_of_equality_that_is_what_is_missing() -> None:
    assert correction(made_up(X - Y, sp.Eq(X, Y))) == "add $= 0$ at the end"
    assert correction(made_up(X - 2 * Y, sp.Eq(X, Y))) == "$whole$"


def test_what_cannot_be_evaluated_is_said_to_be_so_and_the_rest_as_it_is() -> None:
    said = equations._said("both sides could not be evaluated: TypeError")
    assert "could not be evaluated" not in said
    assert "taken literally" in said
    assert equations._said("ε is small") == "ε is small"


def test_a_term_that_is_wrong_must_be_all_that_is() -> None:
    printed, derived = sp.Eq(X + 2 * Y, 0), sp.Eq(X + 3 * Y, 0)
    slip = (2 * Y, 3 * Y, sp.Eq(3 * Y, -X))
    assert correction(made_up(printed, derived, slip=slip)) == "$3 y$ in place of $2 y$"
    with pytest.raises(ArithmeticError, match="not all"):
        correction(made_up(printed, derived, slip=(2 * Y, 3 * Y, sp.Eq(X + 3 * Y, 1))))


def test_the_proof_of_a_misprint_has_both_checks_and_the_step_and_what_differs() -> None:
    found = made_up(sp.Eq(X, 3), sp.Eq(X, 4), amended_latex="x = 4", corrected="x = 4")
    one = erratum_of(found, "two-scales")
    assert one is not None
    parts = ("print is off", "nothing is left", "'the limit: expand'", "'two-scales'", "$x = 4$")
    assert all(part in one.proof for part in parts)
    assert (one.printed, one.corrected) == ("$x = 3$", "$x = 4$")


def test_of_an_equation_with_several_readings_those_that_hold_are_named_and_all_are_proved() -> (
    None
):
    def read(verdict: printed_lines.EquationVerdict) -> Any:
        found = made_up(sp.Eq(X, 3), sp.Eq(X, 4), verdict=verdict)
        found.printed.readings = [
            SimpleNamespace(meaning=name) for name in ("one", "other", "third")
        ]
        found.on_readings = [
            SimpleNamespace(holds=name != "one", statement=f"{name} is tried")
            for name in ("one", "other", "third")
        ]
        return erratum_of(found, "two-scales")

    either = read(printed_lines.EquationVerdict.AMBIGUOUS)
    assert either.fault is Fault.AMBIGUOUS
    assert either.corrected == "$x = 3$; read: other; or read: third"
    for said in ("“one” fails: one is tried.", "“other” holds: other is tried."):
        assert f"The reading {said}" in either.proof
    assert "print is off" not in either.proof
    against = read(printed_lines.EquationVerdict.INCONSISTENT)
    assert against.fault is Fault.INCONSISTENT
    assert against.corrected == "other; or third"
    assert "By itself the print passes: print is off. “one” fails: one is tried." in against.proof
    assert read(printed_lines.EquationVerdict.HOLDS) is None


def test_of_several_roots_the_one_that_fails_most_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    known = iter((1e-15, 0.25, 0.5, 1e-3, 0.0, 0.0, 0.0))
    monkeypatch.setattr(_equation_numbers, "_off", lambda *_: next(known))
    assert _equation_numbers.residual(50) == 0.5


# ------------------------------------------------------------ what a claim says of an equation


def printed_as(**changes: Any) -> equations.CheckedEquation:
    """Return evidence on an equation that holds and has no remark."""
    held: dict[str, Any] = {
        "number": 1, "kind": "holds", "passes": True, "derived_passes": True, "confirmed": True,
        "note": "", "test": "", "derived_test": "", "readings": (), "latex": "x = 3",
        "derived": "x = 4", "affects": "", "residual": None,
    }  # fmt: skip
    return equations.CheckedEquation(**held | changes)


def test_remarks_are_the_way_of_writing_and_then_the_readings() -> None:
    number, style = next(iter(equations.STYLE.items()))
    assert 1 not in equations.STYLE
    assert printed_as().remarks == ()
    assert printed_as(number=number).remarks == (style,)
    said = printed_as(readings=(("one", True, "much"), ("other", False, "nothing"))).remarks
    assert said == (
        "Read as “one” it holds: much.", "Read as “other” it fails: nothing.",
    )  # fmt: skip


def test_the_derived_equation_is_shown_beside_one_that_fails_only() -> None:
    printed, derived = Formula("As printed", "x = 3"), Formula("As derived", "x = 4")
    assert equations.formulas(printed_as()) == (printed,)
    assert equations.formulas(printed_as(passes=False)) == (printed, derived)
    assert equations.formulas(printed_as(passes=False, derived="")) == (printed,)


def test_each_reading_stands_with_its_own_check(monkeypatch: pytest.MonkeyPatch) -> None:
    meanings = ("one", "other")
    found = made_up(sp.Eq(X, 3), sp.Eq(X, 4), confirmed=True)
    found.printed.readings = [SimpleNamespace(meaning=name, implies="it.") for name in meanings]
    found.on_readings = [SimpleNamespace(holds=name == "other") for name in meanings]
    found.on_print.holds = found.on_derived.holds = True
    monkeypatch.setattr(equations, "judgements", lambda: {99: found})
    readings = equations.printed(99).readings
    assert readings == (("one", False, "it"), ("other", True, "it"))


BY_NUMBERS = [n for n in range(1, 55) if _equation_numbers.method(n)]
"""Equations into which numbers of the toolkit are put."""


@pytest.mark.parametrize("number", BY_NUMBERS)
def test_numbers_satisfy_the_equation_itself_and_none_with_another_right_side(
    number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = printed_module.printed
    assert (_equation_numbers.residual(number) or 0.0) < equations.ROUNDING

    def off(asked: int) -> Any:
        """Return the equation with its right side displaced, and no other equation."""
        assert asked == number
        line = exact(asked).expression
        parts = line.args if isinstance(line, sp.Tuple) else (line,)
        moved = [sp.Eq(each.lhs, each.rhs + sp.Rational(1, 100)) for each in parts]
        return SimpleNamespace(expression=moved if isinstance(line, sp.Tuple) else moved[0])

    monkeypatch.setattr(printed_module, "printed", off)
    assert _equation_numbers.residual(number) == pytest.approx(0.01, rel=1e-6)


def test_the_printed_equations_with_a_remark_on_writing_fail_their_literal_check(
    judgements: dict[int, EquationJudgement],
) -> None:
    failing = {n for n, found in judgements.items() if not found.on_print.holds}
    assert failing >= MISPRINTED
    assert failing - MISPRINTED <= set(equations.STYLE)


def test_the_remark_on_a_bound_stands_at_the_equations_that_bound_the_force() -> None:
    lines = {n: printed_module.printed(n).latex for n in range(1, 55)}
    bounded = {n for n, line in lines.items() if re.search(r"\|(\\tilde\{)?F\}?\| <", line)}
    assert {n for n, said in equations.STYLE.items() if "< stands for ≤" in said} == bounded
    assert bounded == {3, 6}


def test_the_remark_on_a_ring_stands_at_the_equations_whose_last_site_is_beside_the_first() -> None:
    lines = {n: printed_module.printed(n).latex for n in range(1, 55)}
    closed = {n for n, line in lines.items() if "x_2 - x_N" in line}
    assert {n for n, remark in equations.STYLE.items() if "ring" in remark} == closed == {40}


def test_the_remark_on_moduli_stands_at_the_equations_that_compare_complex_amplitudes() -> None:
    """In (47), which says where either line holds, the note of its derivation says so."""
    lines = {n: printed_module.printed(n).latex for n in range(1, 55)}
    compared = {
        n
        for n, line in lines.items()
        if r"\varphi_n < \varphi_{us}" in line or r"\theta\left(\varphi_n" in line
    }
    assert {n for n, said in equations.STYLE.items() if "φ is complex" in said} == compared
    assert compared == {44, 45}
    assert "Read by modulus" in printed_module.printed(47).note
