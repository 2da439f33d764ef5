"""Each printed equation stands once as LaTeX and once as an object: the two are proved equal.

What is confirmed as a misprint becomes the derived equation by exchanging its stated tokens alone.
"""

from functools import lru_cache

import pytest
import sympy as sp

from derivations import catalogue, judgement
from derivations.algebra.equations import same
from derivations.algebra.errors import DerivationInputError
from derivations.printing import EquationVerdict
from derivations.transcription.latex_reader import Notation, read
from derivations.transcription.latex_tokens import changed_tokens, tokens_of
from derivations.transcription.readings import (
    as_object,
    found_changes,
    read_correction,
    stated_changes,
)

ALL = judgement.equations()
BY_NUMBER = {entry.number: entry for entry in ALL}
MISPRINTS = [entry.number for entry in ALL if entry.verdict is EquationVerdict.MISPRINT]
x, y = sp.symbols("x y")
PLAIN = Notation(names={"x": x, "y": y}, functions={"f": sp.Function("f")})


@lru_cache(maxsize=64)
def derived(number):
    return catalogue.load(catalogue.owner(number)).numbered(number).result


def test_every_number_has_a_line_and_an_object():
    assert [entry.number for entry in ALL] == list(range(1, 55))


@pytest.mark.parametrize("number", BY_NUMBER)
def test_the_latex_reads_as_the_object(number):
    assert same(as_object(number, BY_NUMBER[number].latex), BY_NUMBER[number].expression)


def flipped(latex):
    """The line with one sign changed, at up to two places of it."""
    places = [
        place
        for place, sign in enumerate(latex)
        if sign in "+-"
        and latex[place - 1] != "^"
        and latex[place + 1] not in "}"
        and not latex[place + 1 :].lstrip().startswith(r"\ldots")
    ]
    for place in places[:: max(1, len(places) // 2)][:2]:
        sign = {"+": "-", "-": "+"}[latex[place]]
        yield latex[:place] + sign + latex[place + 1 :]


@pytest.mark.parametrize("number", [n for n in BY_NUMBER if n != 41])
def test_a_wrong_sign_in_the_latex_is_noticed(number):
    """(41) is left out: only its last part is an equation of the perturbation."""
    for line in flipped(BY_NUMBER[number].latex):
        try:
            found = as_object(number, line)
        except DerivationInputError:
            continue  # the rows of a matrix no longer follow one pattern, or a name is unknown
        assert not same(found, BY_NUMBER[number].expression), line


@pytest.mark.parametrize("number", MISPRINTS)
def test_a_misprint_differs_from_the_derived_equation_in_its_stated_tokens_alone(number):
    entry = BY_NUMBER[number]
    assert entry.amendments
    assert found_changes(entry) == stated_changes(entry)
    assert same(read_correction(entry), derived(number))
    assert not same(as_object(entry.number, entry.latex), derived(number))


@pytest.mark.parametrize("number", [6, 44, 45, 47])
def test_an_ambiguous_line_amended_to_its_reading_is_the_derived_equation(number):
    assert same(read_correction(BY_NUMBER[number]), derived(number))


def test_the_amended_40_is_the_chain_with_free_ends():
    free = catalogue.load("linearisation").named("first-order system with free ends").result
    assert same(read_correction(BY_NUMBER[40]), free)


def test_a_misprint_with_a_second_slip_is_not_confirmed():
    from dataclasses import replace

    entry = BY_NUMBER[4]
    wrong = replace(entry, latex=entry.latex.replace(r"\frac{F_N}{k}", r"\frac{F_N}{m}"))
    found = judgement.judge(wrong, catalogue.load("friction"))
    assert not found.confirmed


@pytest.mark.parametrize(
    ("latex", "expected"),
    [
        (r"2x^2y", 2 * x**2 * y),
        (r"\frac12 x", x / 2),
        (r"x|y|^2", x * sp.Abs(y) ** 2),
        (r"|x||y|", sp.Abs(x) * sp.Abs(y)),
        (r"-x^2 - (-y)", y - x**2),
        (r"x/y \cdot 3", 3 * x / y),
        (r"e^{-2ix}", sp.exp(-2 * sp.I * x)),
        (r"\sin^2\frac{x}{2}", sp.sin(x / 2) ** 2),
        (r"\cos x y", sp.cos(x) * y),
        (r"x^*y", sp.conjugate(x) * y),
        (r"f(x + y)x", sp.Function("f")(x + y) * x),
        (r"0.05x", x / 20),
        (r"\sqrt{x}^3", sp.sqrt(x) ** 3),
    ],
)
def test_the_reader_knows_the_grammar(latex, expected):
    assert sp.simplify(read(latex, PLAIN) - expected) == 0


@pytest.mark.parametrize(
    ("latex", "message"),
    [
        ("x + z", "LaTeX name = z"),
        ("x + )", r"LaTeX = '\)'"),
        (r"\frac{x}", "LaTeX = ''"),
        (r"\begin{array} x \end{array}", "environment"),
        (r"\begin{aligned} x \end{cases}", "balance"),
        (r"(x", "must be"),
    ],
)
def test_what_the_reader_does_not_know_is_refused_in_a_sentence(latex, message):
    with pytest.raises(DerivationInputError, match=message):
        read(latex, PLAIN)


def test_tokens_carry_no_spacing_and_rows_of_aligned_lines_go_on():
    one = r"\begin{aligned} & x \quad \\ & + y\,z \end{aligned}"
    assert tokens_of(one) == tokens_of("x+yz")
    assert tokens_of(r"\begin{aligned} x \\ y \end{aligned}") == ("x", r"\\", "y")
    assert changed_tokens("x + y", r"x - y") == (("+", "-"),)
