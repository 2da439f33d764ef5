"""What the pages say in their sentences, with the numbers read from the pages themselves."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from fronts.piecewise.kinetic_relation import kinetic_relation
from theory.cells.friction import FrictionCell
from theory.cells.vdp import threshold_ratio
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain
from theory.piecewise.sums.result import PrecisionError
from verification.fronts.measure import measure_front

DOCS = Path(__file__).parents[1] / "docs"
EDGES = " ".join((DOCS / "sharp_edges.md").read_text("utf-8").split())
START = " ".join((DOCS / "start.md").read_text("utf-8").split())


def said(text: str, page: str = EDGES) -> tuple[float, ...]:
    """Return the numbers that stand where the text has ``#``."""
    found = re.search(re.escape(text).replace(r"\#", r"([\d.]+(?:e-?\d+)?)"), page)
    assert found is not None, text
    return tuple(float(each.rstrip(".")) for each in found.groups())


def velocities(c: float, eta: float) -> list[float]:
    return [each.v for each in kinetic_relation(c=c, eta=eta).branches]


def test_two_velocities_between_fold_and_pinning_and_more_above() -> None:
    ((c, eta), (above, same)) = (
        said("`fronts kinetic --c # --eta #`. Just above"),
        said("admissible: `fronts kinetic --c # --eta #`."),
    )
    assert len(velocities(c, eta)) == 2
    branches = kinetic_relation(c=above, eta=same).branches
    assert len(branches) > 2
    assert [each.admissible for each in branches][:-1] == [False] * (len(branches) - 1)


def test_a_front_retreats_beyond_two_twentyfifths() -> None:
    c, eta = said("`fronts kinetic --c # --eta #`. The paper does not mention it")
    assert eta > 2 / 25
    assert max(velocities(c, eta)) < 0.0


def test_an_admissible_front_may_not_be_stable() -> None:
    c, eta = said("At c = #, η = # the front satisfies (47) for every ζ")
    (branch,) = kinetic_relation(c=c, eta=eta).branches
    assert branch.admissible
    assert measure_front(PiecewiseChain(c=c, eta=eta)).status.value == "unsteady"


def test_without_an_admissible_front_the_chain_moves() -> None:
    c, eta = said("does not mean no motion: `fronts kinetic --c # --eta #`")
    assert not any(each.admissible for each in kinetic_relation(c=c, eta=eta).branches)
    assert measure_front(PiecewiseChain(c=c, eta=eta)).v


def test_the_resonance_is_the_fastest_wave_and_gives_three_velocities() -> None:
    """A wave of c(1 - cos k) is as fast as the front where that over k is v."""
    (ratio,) = said("Near v = # c the front runs with a linear wave")
    fastest = minimize_scalar(lambda k: -(1.0 - np.cos(k)) / k, bounds=(1.0, 4.0), method="bounded")
    assert ratio == pytest.approx(-fastest.fun, abs=5e-5)
    assert len(velocities(*said("there are three velocities: `fronts kinetic --c # --eta #`"))) == 3


def test_what_averaging_neglects_is_not_small_epsilon() -> None:
    share, a, b, eps = said("ε max|1 - a y² + b y⁴|, # at a = #, b = #, ε = #;")
    largest = 2.0 * np.sqrt(2.0 / a) / np.sqrt(1.0 + np.sqrt(1.0 - 8.0 * b / a**2))
    y = np.linspace(0.0, largest / threshold_ratio(b / a**2), 10_001)
    assert share == pytest.approx(eps * np.abs(1.0 - y**2 * (a - b * y**2)).max(), abs=0.005)


def test_a_far_start_is_stiff() -> None:
    start, rate = said("A site displaced by # has a damping rate of #:")
    assert rate == pytest.approx(0.01 * (1.0 - 4.0 * start**2 + 0.5 * start**4), rel=0.01)


@pytest.mark.parametrize(
    ("text", "boundary", "status"),
    [
        ("`fronts front averaged --eta # --c #` says `collapsed`", None, "collapsed"),
        ("come: `fronts front averaged --eta # --c #` ends `unsteady`", None, "unsteady"),
    ],
)
def test_fronts_of_the_averaged_chain_end_as_said(
    text: str, boundary: str | None, status: str
) -> None:
    eta, c = said(text)
    chain = AveragedChain(a=0.5 / np.sqrt(0.5 * eta), b=0.5, c=c)
    assert measure_front(chain).status.value == status


def test_one_front_creeps_with_a_free_end_and_runs_with_a_wave_behind_it() -> None:
    _, c = said("Compare `fronts front averaged --eta # --c #`")
    (eta,) = said("at η = # the first creeps and the second runs")
    chain = AveragedChain(a=0.5 / np.sqrt(0.5 * eta), b=0.5, c=c)
    assert measure_front(chain).status.value == "creeping"
    assert measure_front(chain, left_boundary="wave").status.value == "steady"


def test_beside_two_twentyfifths_at_large_coupling_it_is_refused() -> None:
    c, eta = said("`fronts kinetic --c # --eta #` is refused at once")
    with pytest.raises(PrecisionError, match="take a smaller c"):
        kinetic_relation(c=c, eta=eta)


def test_the_hopf_velocity_of_the_papers_friction() -> None:
    (velocity,) = said("**Below the Hopf velocity** (# with")
    assert velocity == pytest.approx(FrictionCell().hopf_velocity, abs=5e-5)


def test_the_first_result_is_what_the_start_page_says_of_it() -> None:
    c, v, error = (
        *said("At the coupling c = # and η", START),
        *said("v = # sites per unit of slow time εt; the number is right to #,", START),
    )
    (branch,) = kinetic_relation(c=c, eta=1 / 32).branches
    assert branch.admissible
    assert v == pytest.approx(branch.v, abs=5e-4)
    assert branch.error <= error
