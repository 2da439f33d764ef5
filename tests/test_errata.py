"""The errata are found, not typed; equations are typeset whole."""

from __future__ import annotations

import re
from collections import Counter
from xml.etree import ElementTree

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

from derivations import judgement as printed_module
from derivations.algebra.evidence import value
from derivations.averaging.symbols import phi
from derivations.judgement import Judgement
from derivations.symbols import a, b, c, epsilon, n, omega, t
from paper_checks.claim import Fault, Finding, Verdict
from paper_checks.claims import equations
from paper_checks.claims._equation_errata import correction, readable
from paper_checks.report.inline_math import typeset
from paper_checks.report.mathml import LatexError, mathml

MISPRINTED = {2, 4, 33, 42}
"""Found by hand when the paper was first read: lines that cannot be used as they stand."""


@pytest.fixture(scope="module")
def judgements() -> dict[int, Judgement]:
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
        assert erratum is not None
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
    judgements: dict[int, Judgement], number: int, right: str, wrong: str
) -> None:
    shown = correction(judgements[number])
    assert right in shown
    assert wrong not in shown.replace(r"\overline", "")


def test_the_correction_of_33_turns_the_printed_bracket_into_a_square(
    judgements: dict[int, Judgement],
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
    monkeypatch: pytest.MonkeyPatch, judgements: dict[int, Judgement]
) -> None:
    found = judgements[4]
    passing = printed_module.Judgement(
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


def test_every_equation_is_typeset_and_keeps_each_letter(judgements: dict[int, Judgement]) -> None:
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


def test_text_in_formulas_is_escaped() -> None:
    assert "<script" not in typeset(r"$\text{<script>}$")


@pytest.mark.parametrize(
    ("prose", "better"),
    [
        ("mu_st >= eps c", "μ_st ≥ ε c"),
        ("the derivation 'multiple-scales' of a pinned theta", None),
        ("O(eps^2), phi* and alpha_0", "O(ε^2), φ* and α_0"),
        ("meta and museum", "meta and museum"),
    ],
)
def test_letters_are_replaced_and_words_are_not(prose: str, better: str | None) -> None:
    assert readable(prose) == (better or prose.replace("theta", "θ"))
