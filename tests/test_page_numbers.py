"""What the pages say in their sentences, with the numbers read from the pages themselves."""

from __future__ import annotations

import csv
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import fronts as fr
from fronts.explore import calls as explorer
from fronts.piecewise.kinetic_relation import kinetic_relation
from theory.averaged.front import wave_fast_eta
from theory.cells.friction import FrictionCell
from theory.cells.vdp import threshold_ratio
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.piecewise.limits import strong_coupling_velocity
from theory.piecewise.sums import axis, integral
from verification.breathers import orbits
from verification.execution import pool
from verification.execution.points import Point
from verification.fronts import arrival_fit
from verification.fronts.measure import measure_front
from verification.maps.task import StateTask
from verification.maps.vdp_rules import FIGURE_15
from verification.references.equations import damping
from verification.runs import comparison

ROOT = Path(__file__).parents[1]


def page(name: str) -> str:
    """Return the prose of a page, or of the comments of a script, on one line."""
    text = (ROOT / name).read_text("utf-8")
    if name.endswith(".py"):
        text = re.sub("^# ?", "", text, flags=re.M)
    return " ".join(text.split())


EDGES, START = page("docs/sharp_edges.md"), page("docs/start.md")
SUMS, SWEEPS = page("docs/methods/sums.md"), page("docs/sweeps_head.md")


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
    assert measure_front(PiecewiseChain(c=c, eta=eta), max_sites=300).v


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
    ("text", "status"),
    [
        ("`fronts front averaged --eta # --c #` says `collapsed`", "collapsed"),
        ("unknown: `fronts front averaged --eta # --c #` ends `unsteady`", "unsteady"),
    ],
)
def test_fronts_of_the_averaged_chain_end_as_said(text: str, status: str) -> None:
    eta, c = said(text)
    chain = AveragedChain(a=0.5 / np.sqrt(0.5 * eta), b=0.5, c=c)
    front = measure_front(chain)
    assert front.status.value == status
    assert front.error == (math.inf if front.v else None)


def test_one_front_creeps_with_a_free_end_and_runs_with_a_wave_behind_it() -> None:
    _, c = said("Compare `fronts front averaged --eta # --c #`")
    (eta,) = said("at η = # the first creeps and the second runs")
    chain = AveragedChain(a=0.5 / np.sqrt(0.5 * eta), b=0.5, c=c)
    assert measure_front(chain).status.value == "creeping"
    assert measure_front(chain, left_boundary="wave").status.value == "steady"


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


def test_slower_solutions_need_sums_within_the_distance_of_their_limit() -> None:
    slowest, distance = said("Those with v < # need |Σ| within # of its limit")
    for c in (0.1, 0.5, 5.0):
        limit, here, beyond = (
            abs(fr.sigma(str(v), str(c), digits=30).value)
            for v in (slowest / 3.0, slowest, slowest * 1.25)
        )
        assert abs(here - limit) < distance < abs(beyond - limit)


@pytest.mark.parametrize(("start", "status"), [("step", "steady"), ("resting", "pinned")])
def test_a_step_moves_where_a_resting_front_stays(start: str, status: str, answered: Any) -> None:
    c, eta = said("`fronts front piecewise --c # --eta # --start step`")
    assert answered(f"front piecewise --c {c} --eta {eta} --start {start}")["status"] == status


def test_the_two_limits_do_not_commute() -> None:
    """With r = |φ_us|/|φ_s| at η = 1e-12, where both limits are reached to 1e-3."""
    assert "v → √(c/(8r)); for c → ∞ first, v → V√c with V → 1/(2√r), larger by √2" in EDGES
    eta, c = 1e-12, 1.0
    r = threshold_ratio(eta)
    first = max(velocities(c, eta)) / math.sqrt(c)
    second = strong_coupling_velocity(eta)
    assert second is not None
    assert first == pytest.approx(1.0 / math.sqrt(8.0 * r), rel=1e-3)
    assert second == pytest.approx(1.0 / (2.0 * math.sqrt(r)), rel=1e-3)


def test_a_nucleus_that_escapes_stops_at_as_many_sites_as_said() -> None:
    """By the stored evidence of the claim that the page names; sizes by seed and coupling."""
    (c,) = said("`fronts simulate vdp --n 41 --c # --excite 21")
    stored = ROOT / "paper_checks" / "findings" / "text_nuclei.to_larger.json"
    evidence = json.loads(stored.read_text("utf-8"))["evidence"]["object"]
    sizes = {seed: dict(each["mapping"]) for seed, each in evidence["sizes"]["mapping"]}
    ends = {seed: dict(each["mapping"]) for seed, each in evidence["ends"]["mapping"]}
    assert "ends with nine sites" in EDGES
    assert (sizes[None][c], ends[None][c]) == (9, "larger nucleus")
    assert all(sizes[seed][c] > 9 and ends[seed][c] == "creep" for seed in sizes if seed)


def test_at_small_eta_what_averaging_neglects_is_larger_than_one() -> None:
    (eta,) = said("compare `fronts front vdp --eta # --c")
    a, b = math.sqrt(0.5 / eta), 0.5
    stable = VdpChain(a=a, b=b, c=0.3).stable_amplitude
    y = np.linspace(0.0, stable, 10_001)
    assert 0.01 * np.abs(damping(y, a, b)).max() > 1.0


def test_the_stable_cycle_attracts_at_a_rate_like_one_over_eta() -> None:
    """The rate of the amplitude, d/dρ of ρ/2 (1 - a ρ²/4 + b ρ⁴/8), at small η."""
    (rate,) = said("attracts at a rate of some 1/(#η) per unit of slow time")
    _, a, b = said("`fronts simulate averaged --n # --a # --b #")
    rho = AveragedChain(a=a, b=b, c=0.1).stable_amplitude
    slope = 0.5 - 3.0 * a * rho**2 / 8.0 + 5.0 * b * rho**4 / 16.0
    assert 1.0 / (rate * b / a**2) == pytest.approx(slope, rel=0.01)


def test_smoothed_friction_is_wrong_in_every_solver_by_the_stored_benchmark() -> None:
    tolerance, width, error = said("tolerance # and δ = # every solver of scipy that is tried is")[
        :2
    ] + said("is wrong by more than #, where the amplitude is about one")
    path = ROOT / "benchmarks" / "results" / "friction.csv"
    with path.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["method"].startswith("scipy")]
    setting = f"delta {width}, tolerance {tolerance}"
    errors = [float(row["error"]) for row in rows if row["setting"] == setting]
    assert len(errors) >= 3
    assert min(errors) > error
    assert fr.cell(fr.FrictionCell(v_d=1.25)).stable_cycle.amplitude == pytest.approx(1.0, abs=0.5)


def test_no_orbit_is_sought_where_damping_is_strong() -> None:
    assert "on the cycle is above ten no orbit is sought" in EDGES
    assert orbits.STIFFEST == 10.0


def test_fronts_and_undecided_points_alternate_where_it_is_said() -> None:
    ((eta, c), (size,)) = said("near η = #, c = #:"), said("perturbation of the start by # changes")
    task = StateTask(chain=FIGURE_15, tolerance=1e-8, perturbation=size)
    couplings = [c + shift for shift in (-0.0025, 0.00246, -0.005, 0.0, 0.0012)]
    assert any(task(Point(eta=eta, c=each))["why"] == "perturbation" for each in couplings)


def test_the_thresholds_of_the_friction_chain_are_those_said() -> None:
    first, by_first, whole = said(
        "one site at the edge is # if one new site must stick by τ = #, and # if the whole"
    )
    early, by_early, late, by_late = said(
        "spread from # on by τ = #, from # by τ = #: near its threshold"
    )
    edge, bulk = fr.Nucleus(1, place="edge"), fr.Nucleus(3, "00")
    for coupling, nucleus, definition, end in (
        (first, edge, "first", by_first), (whole, edge, "whole", by_first),
        (early, bulk, "first", by_early), (late, bulk, "first", by_late),
    ):  # fmt: skip
        found = fr.threshold(
            fr.FrictionChain(c=0), nucleus, definition=definition, accuracy=1e-5, tests=0,
            highest=0.1, final_time=end,
        )  # fmt: skip
        digit = 10.0 ** (math.floor(math.log10(coupling)) - (2 if coupling == first else 1))
        assert abs(found.c_crit - coupling) <= 0.5 * digit + 1e-5, (definition, end)
    assert 2.5 < whole / first < 3.5  # "a factor of three", in the tutorial
    assert "differ by a factor of three" in page("docs/tutorials/t5_friction.py")


def test_pages_of_methods_name_the_numbers_of_the_code() -> None:
    assert said("all that happens up to # points", SUMS) == (axis.MAX_PLAIN,)
    assert "Arrays of 20 000 values or more" in SUMS
    assert integral.MANY == 20_000
    assert said("and none at v below #", SUMS) == (axis.SLOWEST,)
    size, milliseconds = said("in batches of up to #, of about # ms", SWEEPS)
    assert (size, milliseconds) == (pool.MAX_BATCH, 1e3 * pool.BATCH_SECONDS)
    assert said("what a worker does in # ms", SWEEPS) == (milliseconds,)
    fitted = page("docs/methods/averaged_fronts.md")
    assert "three times the standard error" in fitted
    assert "a run at a hundred times the tolerance" in fitted
    assert "A drift counts six times" in fitted
    assert (arrival_fit._NOISE, arrival_fit._DRIFT, comparison.COARSER) == (3.0, 6.0, 100.0)
    assert said("a run of a chain of # sites", page("docs/explore.md")) == (explorer.SITES,)


def test_a_band_between_breather_and_front_is_one_of_slow_fronts() -> None:
    (eta, low, high), (end,), (begin,) = (
        said("a band at η = #, from c = # to # of the averaged chain"),
        said("--c 0.19:0.21:3 --t-end #`"),
        said("has fronts from # on"),
    )
    assert begin == low
    usual = StateTask(chain=FIGURE_15.averaged())
    longer = replace(usual, end=end)

    def labels(task: StateTask, *couplings: float) -> list[str]:
        return [str(task(Point(eta=eta, c=c))["label"]) for c in couplings]

    # At its upper end the two alternate: the rule counts whole windows.
    inside, near = (low + 1e-4, 0.2, 0.5 * (low + high)), 1e-4
    assert labels(usual, low - near, *inside, high + near) == [
        "breather", *["undecided"] * 3, "front",
    ]  # fmt: skip
    assert labels(longer, low - near, *inside, high + near) == ["breather", *["front"] * 4]


def test_kappa_changes_its_sign_where_the_tutorial_says() -> None:
    (eta,) = said("κ changes its sign near η = #.", page("docs/tutorials/t4_fronts.py"))
    assert eta == pytest.approx(wave_fast_eta()[0], abs=5e-4)


def test_the_gallery_names_the_folds_and_the_loss_of_stability_that_are_there() -> None:
    (fold,) = said(
        "meets an unstable one at c = # and", page("docs/gallery/more_breather_through_fold.py")
    )
    assert fold == pytest.approx(fr.threshold(AveragedChain(a=2.5, b=0.5, c=0.1)).c_crit, abs=5e-5)
    (c,) = said("stable up to c = #;", page("docs/gallery/more_branches_and_stability.py"))
    assert c == pytest.approx(kinetic_relation(c=0.5, eta=1 / 32).c_stable, abs=5e-4)


def test_the_humps_of_the_exponent_are_where_the_gallery_says() -> None:
    near = said("The humps near c = #, # and # are", page("docs/gallery/more_exponent.py"))
    c = np.concatenate([np.linspace(0.9 * c, 1.1 * c, 17) for c in near])
    fastest = [point.branches[-1] for point in kinetic_relation(c=c, eta=1 / 32).points]
    exponent = np.array([x / f.v * f.by_c for x, f in zip(c, fastest, strict=True)])
    for hump, values in zip(near, exponent.reshape(len(near), -1), strict=True):
        assert 0 < values.argmax() < values.size - 1, hump
        assert values.max() > 0.6


def test_an_update_of_the_explorer_takes_what_the_record_says() -> None:
    stored = json.loads((ROOT / "benchmarks" / "results" / "explorer.json").read_text("utf-8"))
    updates = [stored["updates"][model] for model in ("averaged", "vdp")]
    shown = said(
        "takes # ms of processor time with the averaged chain and # ms with the full chain (8), "
        "in the median over couplings, and at most # ms and # ms;",
        page("docs/explore.md"),
    )
    assert shown[:2] == tuple(round(each["median_ms"]) for each in updates)
    assert shown[2:] == tuple(round(each["largest_ms"]) for each in updates)
    assert max(shown) < 100.0
