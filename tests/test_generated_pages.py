"""Pages of the site that are read off the toolkit: nothing is left as the sources write it."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

from derivations import catalogue
from derivations.judgement import equations

sys.path.insert(0, str(Path(__file__).parents[1] / "docs" / "extensions"))
generated_pages = importlib.import_module("generated_pages")

ASCII = re.compile(r"\b(?:mu|phi|psi|omega|eps|xi|infinity|sqrt|theta|alpha|v_hat)\b")


def test_the_notes_of_equations_have_the_letters_of_the_paper() -> None:
    steps = [step for made in catalogue.everything() for step in made.steps]
    of = {step.number: step for step in steps}
    rows = "".join(generated_pages._row(each, of[each.number], [], []) for each in equations())
    rows += "".join(f" {each.affects}" for each in equations())
    rows += "".join(f" {r.meaning} {r.implies}" for each in equations() for r in each.readings)
    rows += "".join(f" {step.operation} {step.note}" for step in steps)
    text = re.sub(r"<math\b.*?</math>", "", rows, flags=re.DOTALL)
    assert "μ(0) = 2 " in text
    assert ASCII.findall(text) == []


def test_a_ratio_of_run_times_is_called_a_factor() -> None:
    page = generated_pages.speed()
    assert "| at least a factor of 1 |" in page
    assert "N to the power | below 1.3 | " in page
    assert " times |" not in page
