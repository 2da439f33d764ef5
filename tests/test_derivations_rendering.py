"""A derivation shows itself as text, LaTeX, MathML, JSON, in a notebook, and in a document."""

import json
import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from functools import lru_cache

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

from derivations import catalogue
from derivations.algebra import rendering
from derivations.algebra.equations import parts_of
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.steps import Derivation
from derivations.algebra.sums import SumOver
from derivations.cell.envelope import derive_envelope
from derivations.cell.steps import derive as derive_cell

KEYS = tuple(catalogue.LISTING)
loaded = lru_cache(maxsize=None)(catalogue.load)  # a step that is shown again is not checked again


@pytest.mark.parametrize("key", KEYS)
def test_the_text_holds_each_step_with_its_number_and_evidence(key):
    derivation = loaded(key)
    shown = rendering.text(derivation)
    assert "FAILED" not in shown
    assert shown.count("checked:") == len(derivation.steps)
    for step in derivation.steps:
        assert rendering.sentence(step) in shown
        if step.number is not None:
            assert f"(Eq. {step.number})" in shown


@pytest.mark.parametrize("key", KEYS)
def test_mathml_is_well_formed(key):
    root = ET.fromstring(rendering.mathml(loaded(key)))
    math = [node for node in root.iter() if node.tag.endswith("}math")]
    assert len(math) == len(loaded(key).steps)
    assert all(len(node) for node in math)


@pytest.mark.parametrize("key", KEYS)
def test_json_survives_a_round_trip(key):
    data = json.loads(json.dumps(rendering.records(loaded(key)), allow_nan=False))
    assert data["complete"]
    assert all(step["holds"] and step["latex"] and step["evidence"] for step in data["steps"])


@pytest.mark.parametrize("key", KEYS)
def test_the_expression_in_json_is_read_back_by_sympy(key):
    for step in loaded(key).steps:
        back = sp.sympify(rendering.equation_expression(step.result))
        for one, other in zip(parts_of(back), parts_of(step.result), strict=True):
            assert type(one) is type(other), step.name
            assert one.free_symbols == _plain(other).free_symbols, step.name
            if isinstance(one, sp.core.relational.Relational):
                for side, expected in zip(one.args, _plain(other).args, strict=True):
                    assert side == expected or _agree(side, expected), step.name


def _plain(expression):
    """The expression with symbols and functions that have names only, as text has them."""
    if isinstance(expression, sp.core.relational.Relational):
        return expression.func(*map(_plain, expression.args), evaluate=False)
    for _ in range(3):  # functions of functions
        expression = expression.replace(
            lambda q: isinstance(q, AppliedUndef) and q.func.assumptions0,
            lambda q: sp.Function(q.func.__name__)(*q.args),
        )
    # A sum over roots is an unknown function to SymPy.
    expression = expression.replace(SumOver, sp.Function("SumOver"))
    names = {q: sp.Symbol(q.name) for q in expression.atoms(sp.Symbol)}
    return expression.xreplace(names)


def _agree(one, other):
    if isinstance(one, sp.MatrixBase):
        return (one - other).expand().is_zero_matrix
    return sp.sstr(one.expand()) == sp.sstr(other.expand())


def test_a_notebook_shows_steps_and_derivations():
    derivation = loaded("averaging")
    shown = rendering.markdown(derivation)
    assert shown.count("$$") == 2 * len(derivation.steps)


def test_a_system_is_one_display():
    x = sp.Symbol("x")
    system = sp.Tuple(sp.Eq(x, 1), sp.Eq(2 * x, 2))
    assert rendering.equation_text(system) == "x = 1\n2⋅x = 2"
    assert "aligned" in rendering.equation_latex(system)


def test_words_for_latex_are_escaped():
    document = rendering.document(derive_cell(derive_envelope("y**2 - 1", "k_2*y**3").model))
    body = document.split("\\begin{document}")[1]
    assert "k\\_2" in body or "k_{2}" in body


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("μ₁ → ∞", r"\ensuremath{\mu}\ensuremath{_{1}} \ensuremath{\to} \ensuremath{\infty}"),
        ("ẏ₀⁽¹⁾", r"\ensuremath{\dot{y}}\ensuremath{_{0}}\ensuremath{^{(1)}}"),
        (
            "φ̇₋₁ Ψ λ",
            r"\ensuremath{\dot{\phi}}\ensuremath{_{-1}} \ensuremath{\Psi} \ensuremath{\lambda}",
        ),
        ("a_b 5 %", r"a\_b 5 \%"),
    ],
)
def test_greek_letters_indices_and_accents_of_the_text_are_latex(words, written):
    step = derive_cell(derive_envelope("y**2 - 1").model).steps[0]
    titled = rendering.document(Derivation("key", words, (step,)))
    assert f"\\section*{{{written}}}" in titled


@pytest.mark.parametrize("key", KEYS)
def test_the_latex_document_is_ascii_so_that_every_engine_takes_it(key):
    assert rendering.document(loaded(key)).isascii()


def test_the_exported_document_compiles(tmp_path):
    if shutil.which("pdflatex") is None:
        if os.environ.get("FRONTS_NEED_LATEX"):
            pytest.fail("pdflatex is not installed")  # where the project is checked as a whole
        pytest.skip("pdflatex is not installed")
    derivations = [loaded(key) for key in KEYS]
    derivations.append(derive_cell(derive_envelope("1 - a*y**2 + b*y**4", "k_3*y**3").model))
    (tmp_path / "all.tex").write_text(rendering.document(*derivations), encoding="utf-8")
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"],
        cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-2000:]
    assert "Overfull" not in done.stdout
    assert (tmp_path / "all.pdf").stat().st_size > 10_000


def test_an_unknown_name_or_order_is_refused():
    for name, order in (("nothing", 1), ("averaging", 3), ("friction", 2)):
        with pytest.raises(DerivationInputError):
            catalogue.load(name, order)
    with pytest.raises(DerivationInputError, match="one of"):
        catalogue.load("friction").numbered(54)


def test_the_words_do_not_depend_on_the_terminal():
    # SymPy looks at the encoding of the terminal that imports it and sets a default by it.
    code = (
        "from derivations import catalogue; from derivations.algebra.rendering import sentence;"
        "print(ascii([sentence(s) for s in catalogue.load('averaging').steps]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        text=True,
        check=True,
    )
    said = ascii([rendering.sentence(step) for step in catalogue.load("averaging").steps])
    assert done.stdout.strip() == said
    assert "\\u03b1\\u2080" in said


@pytest.mark.parametrize(
    ("name", "shown"),
    [(r"\tilde{v}_{rel}", "ṽᵣₑₗ"), (r"\hat{v}", "v̂"), (r"\dot{\delta}", "δ̇"), (r"\delta_5", "δ₅"),
     (r"\varphi_{n+1}", "φₙ₊₁"), (r"\tilde{y}_*", "ỹ_*"), ("Sigma_infinity", "Σ_∞")],
)  # fmt: skip
def test_accents_and_greek_letters_are_read_off_the_latex_of_a_name(name, shown):
    assert rendering.equation_text(sp.Eq(sp.Symbol(name), 2)) == f"{shown} = 2"
    assert rendering.tex_words(shown.rstrip("_*")).isascii()
