"""Fronts, thresholds and states of chains, lattices and networks of one's own."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from derivations.cell.envelope import derive_envelope
from fronts.animation import animate
from tests.reference_runs import overdamped_rate, states_by_scipy
from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, RunError
from verification.fronts.measure import measure_front
from verification.fronts.status import FrontStatus
from verification.fronts.wave import front_wave
from verification.maps.state_map import state_map
from verification.maps.task import StateTask
from verification.references.equations import pull_matrix
from verification.references.passages import passage_velocity
from verification.runs.ensemble import ensemble
from verification.runs.excite import excite
from verification.runs.simulate import simulate
from verification.thresholds.threshold import threshold

PAPER = {"damping": "1 - a*y**2 + b*y**4", "values": {"a": 4.0, "b": 0.5}}
NAGUMO: dict[str, Any] = {
    "damping": 0, "stiffness": "y*(1 - y)*(alpha - y)", "values": {"alpha": 0.2},
    "overdamped": True,
}  # fmt: skip


def nagumo(**changes: Any) -> OscillatorChain:
    return OscillatorChain(**{**NAGUMO, **changes})


def speed(chain: OscillatorChain, **options: Any) -> float:
    v = measure_front(chain, **options).v
    assert v is not None
    return v


def test_the_error_of_a_wide_front_bounds_the_effect_of_both_ends_of_its_chain() -> None:
    """Against arrivals at sites 105 and 145 of 260 in a run by scipy's DOP853 at 1e-11."""
    front = measure_front(nagumo(c=1.0))
    assert 1e-6 < abs(front.v - 0.42014877837) <= front.error < 1e-5


@pytest.mark.parametrize(
    ("c", "options", "v"),
    [
        (10.0, {}, 1.7875713),
        (30.0, {"accuracy": 1e-2}, 3.0976463),
        (10.0, {"excited": 6}, 1.7875713),
    ],
)
def test_a_front_wider_than_the_sites_kept_behind_it_is_given_more(
    c: float, options: dict[str, Any], v: float
) -> None:
    """Against arrivals far from both ends of a longer chain, by scipy's DOP853 at 1e-11.

    With 24 sites behind it, the second was slower by a factor of six.
    """
    front = measure_front(nagumo(c=c, values={"alpha": 0.1}), **options)
    assert front.status is FrontStatus.STEADY
    assert abs(front.v - v) <= front.error


def test_a_nucleus_too_small_for_a_wide_front_is_not_taken_for_the_lack_of_a_front() -> None:
    """v = √(D/2) (1 - 2α) in the continuum, where weights 1 and 0.2 give D = (1 + 4·0.2) c."""
    chain = nagumo(c=100.0, values={"alpha": 0.4}, coupling="next-nearest:1,0.2")
    short = {"accuracy": 0.1, "max_sites": 300}
    front = measure_front(chain, **short)
    assert front.excited == 48
    assert abs(front.v - math.sqrt(90.0) * 0.2) <= front.error + 0.01
    few = measure_front(chain, **short, excited=24)
    assert few.status is FrontStatus.COLLAPSED
    assert "or more of them must be excited" in few.status.sentence


@pytest.mark.parametrize("coupling", ["chain", "chain:1"])
def test_a_wide_front_is_steady_without_the_sites_that_its_tail_reaches_at_the_far_end(
    coupling: str,
) -> None:
    """Against scipy's DOP853 on a chain whose ends are further away; the second has free ends."""
    alpha, sites = 0.1, 480
    rate = overdamped_rate(lambda y: y * (1.0 - y) * (alpha - y), pull_matrix(sites), c=25.0)
    times = np.linspace(0.0, 140.0, 1401)
    y = states_by_scipy(rate, np.where(np.arange(sites) < 100, 1.0, 0.0), times, 1e-8)
    from_site, to_site = (
        CubicSpline(times, y[:, n]).solve(alpha, extrapolate=False)[0] for n in (240, 340)
    )
    front = measure_front(nagumo(c=25.0, values={"alpha": alpha}, coupling=coupling))
    assert front.status is FrontStatus.STEADY
    assert abs(front.v - 100.0 / (to_site - from_site)) <= front.error + 1e-6


def test_a_motion_that_decays_to_nothing_is_followed_to_its_end() -> None:
    """ẏ = -α y at the end, below 1e-155 too, where the squares of errors underflow."""
    chain, times = nagumo(c=1.0, sites=20), [1000.0, 1500.0, 2000.0, 2500.0, 4000.0]
    run = simulate(chain, excite(chain, [10]), 4000.0, times=times)
    size = np.abs(run.y).max(axis=1)
    alpha = NAGUMO["values"]["alpha"]
    assert size[-1] < 1e-200
    assert np.log(size[:-2] / size[1:-1]) == pytest.approx(500.0 * alpha, rel=1e-6)


def test_too_few_excited_rows_of_a_lattice_collapse() -> None:
    lattice = nagumo(c=1.0, coupling="hexagonal", shape=(15, 5))
    assert measure_front(lattice, excited=1).status is FrontStatus.COLLAPSED


@pytest.mark.parametrize(("c", "d", "v", "off"), [(50.0, 1.0, 8.9925, 5e-4)])
@pytest.mark.parametrize("options", [{"accuracy": 0.1}, {"accuracy": 0.01, "excited": 24}])
def test_the_error_of_a_wide_front_of_oscillating_cells_bounds_that_of_its_velocity(
    c: float, d: float, v: float, off: float, options: dict[str, Any]
) -> None:
    """Against arrivals at 140 sites far from both ends of a chain of 330, by scipy's DOP853.

    With 24 sites behind the front and 32 before it, v was off by 0.164, and 0.070 was stated.
    """
    chain = OscillatorChain(**PAPER, c=c, velocity_coupling=d)
    front = measure_front(chain, tolerance=1e-6, **options)
    assert front.status is FrontStatus.STEADY
    assert abs(front.v - v) <= front.error + off
    assert front.error < options["accuracy"] * v


def test_front_and_threshold_of_the_paper_as_text_are_those_of_the_built_in_chain() -> None:
    text, built_in = OscillatorChain(**PAPER, c=0.6), VdpChain(a=4, b=0.5, c=0.6)
    ours, theirs = measure_front(text), measure_front(built_in)
    assert (ours.v, ours.error, ours.outruns_waves) == pytest.approx(
        (theirs.v, theirs.error, theirs.outruns_waves), rel=1e-12
    )
    options: dict[str, Any] = {"method": "bisection", "accuracy": 1e-2, "tests": 0, "lowest": 0.1}
    found = [
        threshold(chain.replace(sites=7), Nucleus(1), final_time=10.0, **options).c_crit
        for chain in (text, built_in)
    ]
    assert found[0] == found[1]


@pytest.mark.parametrize(
    "weights", [[1.0], [2.0], [-1.0], [1.0, 0.2], [1.0, -0.3], [0.2, 0.1, 0.7], [0.0, 1.0]]
)
def test_the_fastest_wave_is_that_of_the_dispersion_relation(weights: list[float]) -> None:
    k = np.linspace(0.0, np.pi, 20001)
    slopes = sum(d * w * np.sin(d * k) for d, w in enumerate(weights, 1))
    coupling = "chain:" + ",".join(map(str, weights))
    chain = OscillatorChain(**PAPER, c=0.3, coupling=coupling)
    # a grid of spacing 1.6e-4 misses a maximum by half its curvature times (0.8e-4)²
    fastest = chain.eps * chain.c * np.abs(slopes).max()
    assert chain.trailing_wave_velocity == pytest.approx(fastest, rel=1e-7)


def test_a_weight_of_two_is_twice_the_coupling_also_where_waves_overtake_the_front() -> None:
    cell = {"damping": "1 - 4*y**2 + 1.15*y**4", "eps": 0.05}
    once, twice = (
        measure_front(
            OscillatorChain(**cell, c=c, coupling=coupling),
            accuracy=1e-2, tolerance=1e-6, max_sites=200,
        )
        for c, coupling in ((1.2, "chain"), (0.6, "chain:2"))
    )  # fmt: skip
    assert twice.v == pytest.approx(once.v, rel=1e-12)
    assert (twice.outruns_waves, twice.chain.sites) == (once.outruns_waves, once.chain.sites)
    assert not once.outruns_waves


def test_a_planar_front_on_a_square_lattice_is_that_of_the_chain() -> None:
    chain = measure_front(nagumo(c=1.0))
    lattice = measure_front(nagumo(c=1.0, coupling="square", sites=(80, 3)))
    assert abs(lattice.v - chain.v) <= lattice.error + chain.error < 2e-3


def of_the_paper(eta: float, **options: Any) -> Any:
    """Return (43) as text, with a = 1 and b = η."""
    cell = {"damping": "1 - y**2 + b*y**4", "values": {"b": eta}}
    return OscillatorChain(**cell, **options).averaged()


@pytest.mark.parametrize(
    ("eta", "c", "status"),
    [(0.0236, 110.6, FrontStatus.STEADY), (0.013, 654.0, FrontStatus.UNSTEADY)],
)
def test_the_error_of_a_front_of_a_text_bounds_what_is_left_of_its_start(
    eta: float, c: float, status: FrontStatus
) -> None:
    """After its start it is slower than the wave; the error with 64 sites was a ninth of it."""
    front = measure_front(of_the_paper(eta, c=c))
    assert abs(front.v - front_wave(c, eta).v) <= front.error
    assert front.status is status


def test_a_front_into_a_cell_without_linear_damping_is_steady_once_its_start_is_forgotten() -> None:
    """Against the chain of quarter turns by scipy, whose own drift is the difference of two parts.

    With 64 sites the stated error was twenty times too small.
    """
    b, c, sites = 0.0233, 448.0, 600
    chain = OscillatorChain(damping="y**2 - y**4 + b*y**6", values={"b": b}, c=c).averaged()
    on_cycle, level = chain.stable_amplitude, chain.unstable_amplitude

    def rate(_: float, r: Any) -> Any:
        left, right = np.r_[on_cycle, r[:-1]], np.r_[r[1:], 0.0]
        damping = r**2 * (1.0 / 4.0 - r**2 / 8.0 + 5.0 * b * r**4 / 64.0)
        return 0.5 * c * (left - right) - 0.5 * damping * r

    start = np.where(np.arange(sites) < 24, on_cycle, 0.0)
    options: dict[str, Any] = {"method": "DOP853", "rtol": 1e-8, "atol": 1e-8}
    run = solve_ivp(rate, (0.0, 1.25), start, dense_output=True, **options)
    earlier, v = (passage_velocity(run, range(n, n + 140), level) for n in (280, 420))
    front = measure_front(chain)
    assert front.status is FrontStatus.UNSTEADY
    assert abs(front.v - v) <= front.error + abs(v - earlier)
    assert abs(v - earlier) < 1e-3 * v
    front = measure_front(chain, max_sites=2100)
    assert front.status is FrontStatus.STEADY
    assert abs(front.v - v) <= front.error + abs(v - earlier)


def test_a_front_on_a_lattice_is_not_steady_as_long_as_it_is_at_the_minimum_of_its_velocity() -> (
    None
):
    """There the stated error was fifteen times too small."""
    eta, c = 0.0141138, 94.359
    short, long = (
        measure_front(of_the_paper(eta, c=c, coupling="square", sites=(rows, 3)))
        for rows in (67, 220)
    )
    assert (short.status, long.status) == (FrontStatus.UNSTEADY, FrontStatus.STEADY)
    assert abs(long.v - front_wave(c, eta).v) <= long.error


def test_the_front_on_a_lattice_depends_on_the_direction_most_near_pinning() -> None:
    """A planar front along the diagonal is that of a chain of diagonals: coupling 2c, rows 1/√2
    apart. A round front takes on the shape that its slower directions cut out (Wulff), so that
    along a ray it is at most as fast."""
    seen = []
    for c in (0.06, 0.3):
        lattice = nagumo(c=c, coupling="square", sites=(41, 41))
        front = measure_front(lattice, directions=8)
        v = front.detail.velocities
        assert v.reshape(4, 2).std(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)  # four-fold
        planar = speed(nagumo(c=2.0 * c)) / math.sqrt(2.0) / speed(nagumo(c=c))
        assert v[1] / v[0] < planar + 0.01
        seen.append((v[1] / v[0] - 1.0, planar - 1.0))
    (near, most), (far, least) = seen
    assert most > near > 0.06
    assert abs(far) < least + 0.01 < 0.5 * near


def test_arrivals_that_are_located_together_are_those_located_one_by_one() -> None:
    """A planar front reaches a row of a lattice at once; a chain, one site after another."""
    lattice = nagumo(c=1.0, coupling="square", sites=(20, 8))
    chain = nagumo(c=1.0, sites=20)
    wide = simulate(lattice, excite(lattice, range(1, 33)), 40.0, samples=2, tolerance=1e-10)
    thin = simulate(chain, excite(chain, range(1, 5)), 40.0, samples=2, tolerance=1e-10)
    assert np.count_nonzero(~np.isnan(thin.arrivals)) > 12
    rows = wide.arrivals.reshape(20, 8)
    np.testing.assert_allclose(rows, thin.arrivals[:, None] + 0.0 * rows, rtol=1e-9)


def test_on_a_network_a_front_is_timed_by_links() -> None:
    """A ring given as a matrix is a chain in two directions."""
    ring = np.roll(np.eye(80), 1, axis=1) + np.roll(np.eye(80), -1, axis=1)
    front = measure_front(nagumo(c=1.0, coupling=ring), excited=9)
    assert abs(front.v - speed(nagumo(c=1.0))) <= front.error < 0.03


def test_a_pinned_front_is_pinned_on_a_lattice_too() -> None:
    front = measure_front(nagumo(c=0.01, coupling="square", sites=(20, 3)), stall_time=20.0)
    assert (front.status, front.v) == (FrontStatus.PINNED, 0.0)


def test_a_front_on_a_lattice_that_is_too_short_for_the_accuracy_asked_is_unsteady() -> None:
    """Of 25 rows v is not known to a part in a thousand; what is known of it does not change."""
    lattice = nagumo(c=1.0, coupling="square", sites=(25, 3))
    usual, fine = measure_front(lattice), measure_front(lattice, accuracy=1e-3)
    assert (usual.status, fine.status) == (FrontStatus.STEADY, FrontStatus.UNSTEADY)
    assert (fine.v, fine.error) == (usual.v, usual.error)


def test_the_front_of_a_duffing_cell_is_that_of_its_averaged_chain() -> None:
    """The cell of ``examples/own_cell.py``: derived, averaged, and integrated by scipy."""
    full = OscillatorChain(
        damping="1 - a*y**2 + b*y**4", stiffness="y + k*y**3",
        values={"a": 4, "b": 0.5, "k": 0.0005}, c=2.0,
    )  # fmt: skip
    # ε g = k y³ with ε = 0.01.
    cell = derive_envelope("1 - a*y**2 + b*y**4", "k*y**3").compiled(a=4, b=0.5, k=0.05, c=2.0)
    sites = 80
    phi = np.zeros(sites, complex)
    phi[:24] = full.stable_amplitude * (-1j) ** np.arange(24)

    def rate(_: float, state: Any) -> Any:
        left, right = np.r_[state[:1], state[:-1]], np.r_[state[1:], state[-1:]]
        return cell.rate(state, left, right)

    times = np.linspace(0.0, 22.0, 1101)
    amplitude = np.abs(states_by_scipy(rate, phi, times, 1e-6))
    reached = [times[np.argmax(amplitude[:, n] > full.unstable_amplitude)] for n in (45, 65)]
    assert speed(full) == pytest.approx(20.0 / (reached[1] - reached[0]), rel=0.02)


def test_arrivals_of_a_disordered_chain_are_those_of_scipy() -> None:
    """The chain of ``examples/disordered_chain.py``."""
    alpha = 0.2 * (1.0 + 0.1 * np.random.default_rng([1, 0]).standard_normal(60))
    rate = overdamped_rate(lambda y: y * (1.0 - y) * (alpha - y), pull_matrix(60), c=1.0)
    start = np.zeros(60)
    start[:8] = 1.0
    times = np.linspace(0.0, 150.0, 15001)
    y = states_by_scipy(rate, start, times, 1e-9)
    at = [float(np.interp(0.2, y[:, n], times)) for n in (19, 49)]
    chain = nagumo(c=1.0, sites=60, disorder={"alpha": 0.1}, seed=1)
    run = simulate(chain, excite(chain, range(1, 9)), 150.0, samples=2)
    assert run.arrivals[[19, 49]] == pytest.approx(at, abs=1e-4)
    assert chain.replace(sites=90).site_values["alpha"][:60] == pytest.approx(alpha, rel=1e-15)


def test_disorder_spreads_the_threshold_the_more_the_stronger_it_is() -> None:
    """Nine sites in the middle of 25; a wider band of cells lets some seeds spread earlier."""
    chain = nagumo(c=0.0, sites=25, values={"alpha": 0.3})
    options: dict[str, Any] = {
        "nucleus": Nucleus(9, "0" * 8), "final_time": 200.0, "accuracy": 1e-3, "tests": 0,
        "lowest": 0.01,
    }  # fmt: skip
    clean = threshold(chain, **options).c_crit
    found = [
        ensemble(threshold, chain.replace(disorder={"alpha": size}), range(6), workers=1, **options)
        for size in (0.02, 0.15)
    ]
    assert [each.missing for each in found] == [0, 0]
    assert found[0].spread < 0.5 * found[1].spread
    assert abs(found[0].mean - clean) < 0.005
    assert found[1].quantity == "c_crit"


def test_the_error_of_a_number_in_an_ensemble_is_the_one_of_that_number() -> None:
    """A breather has an error of its amplitudes as well."""
    chain = nagumo(c=1.0, sites=9, values={"alpha": 0.2}, disorder={"alpha": 0.1})

    def found(_: OscillatorChain) -> SimpleNamespace:
        return SimpleNamespace(frequency=1.5, frequency_error=0.25, error=4.0)

    def other(_: OscillatorChain) -> SimpleNamespace:
        return SimpleNamespace(v=1.5, error=4.0)

    assert ensemble(found, chain, [1], workers=1).errors.tolist() == [0.25]
    assert ensemble(other, chain, [1], workers=1).errors.tolist() == [4.0]


def test_an_ensemble_is_the_same_on_two_processes() -> None:
    chain = nagumo(c=1.0, sites=40, disorder={"alpha": 0.1})
    one, two = (
        ensemble(measure_front, chain, range(3), workers=workers, accuracy=0.1)
        for workers in (1, 2)
    )
    assert np.array_equal(one.values, two.values)
    assert one.mean == pytest.approx(np.mean(one.values))
    assert one.spread == pytest.approx(math.sqrt(np.sum((one.values - one.mean) ** 2) / 2.0))
    with pytest.raises(ParameterError, match="disorder = none"):
        ensemble(measure_front, chain.replace(disorder={}), [1])


def _mean_threshold(chain: Any) -> float:
    return float(chain.site_values["alpha"].mean())


def _only_where_it_is_low(chain: Any) -> float:
    mean = _mean_threshold(chain)
    if mean > 0.2:
        raise RunError("no front")
    return mean


def test_a_seed_without_the_number_says_why_and_does_not_lose_the_others() -> None:
    chain = nagumo(c=1.0, sites=9, values={"alpha": 0.2}, disorder={"alpha": 0.1})
    every = ensemble(_mean_threshold, chain, range(8), workers=1)
    found = ensemble(_only_where_it_is_low, chain, range(8), workers=1)
    low = every.values <= 0.2
    assert 0 < found.missing == int(np.sum(~low)) < 8
    assert np.array_equal(found.values[low], every.values[low])
    assert [str(each) for each in found.reasons] == ["" if each else "no front" for each in low]
    assert found.mean == pytest.approx(np.mean(every.values[low]))
    assert found.columns()["reasons"].shape == (8,)


def test_of_one_seed_there_is_no_spread_and_of_none_no_result() -> None:
    chain = nagumo(c=1.0, sites=9, values={"alpha": 0.2}, disorder={"alpha": 0.1})
    one = ensemble(_mean_threshold, chain, [3], workers=1)
    assert (one.spread, one.mean_error) == (None, None)
    assert one.to_dict()["mean"] == one.values[0]
    for nothing in (lambda _: None, lambda _: math.inf):
        with pytest.raises(RunError, match="at any seed"):
            ensemble(nothing, chain, [1, 2], workers=1)


@pytest.mark.parametrize(
    ("seeds", "quantity"),
    [([1.5], "seed"), ([-1], "seed"), (["a"], "seed"), ([True], "seed"), ([2**32], "seed"),
     (5, "seeds"), ("12", "seeds"), ([], "seeds"), ([1, 2, 1], "seeds")],
)  # fmt: skip
def test_seeds_that_are_none_are_refused(seeds: Any, quantity: str) -> None:
    chain = nagumo(c=1.0, sites=9, values={"alpha": 0.2}, disorder={"alpha": 0.1})
    with pytest.raises(ParameterError) as refused:
        ensemble(_mean_threshold, chain, seeds, workers=1)
    assert refused.value.quantity == quantity


def test_a_function_that_gives_no_number_is_refused() -> None:
    chain = nagumo(c=1.0, sites=9, values={"alpha": 0.2}, disorder={"alpha": 0.1})
    for wrong in (lambda _: "front", lambda _: True, lambda _: [0.5], "front"):
        with pytest.raises(ParameterError):
            ensemble(wrong, chain, [1, 2], workers=1)


def test_the_map_of_an_own_chain_names_its_states_over_its_own_parameters() -> None:
    task = StateTask(chain=nagumo(c=0.0, sites=9, values={"alpha": 0.3}), nucleus=Nucleus(3, "00"))
    found = state_map(task, c=[0.005, 0.08], alpha=[0.3, 0.45], workers=1, refine=0.0)
    assert found.states["label"].tolist() == ["breather", "breather", "front", "breather"]


def test_a_run_on_a_lattice_is_a_picture_and_a_film(tmp_path: Path) -> None:
    for coupling in ("square", "hexagonal"):
        chain = nagumo(c=0.3, coupling=coupling, sites=(6, 7))
        run = simulate(chain, excite(chain, [17, 18, 24]), 9.0, samples=4, estimate_error=False)
        film = tmp_path / f"{coupling}.gif"
        parts: list[float] = []
        animate(run, film, note="said", progress=parts.append)
        assert parts == [0.25, 0.5, 0.75, 1.0]
        with Image.open(film) as image:
            assert image.n_frames == 4
            frames = [np.asarray(each.convert("RGB")) for each in ImageSequence.Iterator(image)]
            for one, next_one in pairwise(frames):  # what moves does, and what stands is there
                still = (one == next_one).all(axis=-1)
                assert still.mean() > 0.25
                assert not still[len(still) // 8 :].all()  # below the title too
                assert (one[still].min(axis=-1) < 100).sum() > 500
            assert image.info["comment"] == b"said"
        run.plot().figure.savefig(tmp_path / "run.png")
    with pytest.raises(ParameterError, match="file of a film"):
        animate(run, tmp_path / "run.avi")


@pytest.mark.parametrize(
    ("changes", "options", "words"),
    [
        ({"sites": 40}, {"directions": 8}, "directions = 8 .* absent"),
        (
            {"coupling": "square", "sites": (9, 9)},
            {"directions": 8, "excited": 81},
            "excited sites",
        ),
        ({"coupling": "square", "sites": (9, 9)}, {"directions": 8}, "take a larger lattice"),
        ({"coupling": "square", "sites": (1, 40)}, {}, "number of rows = 1 .* turn the lattice"),
        (
            {"coupling": "square", "sites": (14, 9)},
            {},
            "number of rows = 14 .* at least 18 .* from 4 excited rows; .* turn the lattice.$",
        ),
        (
            {"coupling": "square", "sites": (15, 9)},
            {},
            "number of rows = 15 .* at least 18 .* from 4 excited rows; .* excite at most 1.$",
        ),
        (
            {"coupling": "square", "sites": (17, 9)},
            {"excited": 5},
            "number of rows = 17 .* at least 19 .* from 5 excited rows; .* excite at most 3.$",
        ),
        (
            {"coupling": "square", "sites": (17, 9)},
            {"excited": 18},
            "excited rows = 18 .* from 1 to 17",
        ),
        ({"values": {"alpha": np.full(31, 0.2)}}, {}, "give disorder by its spread"),
        ({"coupling": "next-nearest:1,0.2"}, {"left_boundary": "wave"}, "leave it out"),
        ({"c": 0.0}, {}, "coupling c = 0"),
    ],
)
def test_what_cannot_be_measured_is_refused(
    changes: dict[str, Any], options: dict[str, Any], words: str
) -> None:
    with pytest.raises(ParameterError, match=words):
        measure_front(nagumo(**{"c": 0.3, **changes}), **options)


def test_the_command_line_gives_velocities_by_direction(answered: Any, tmp_path: Path) -> None:
    line = ["front", "chain", "--damping", "0", "--stiffness", "y*(1-y)*(alpha-y)", "--overdamped"]
    more = ["--value", "alpha=0.2", "--c", "0.3", "--coupling", "square", "--n", "31x31"]
    picture = tmp_path / "front.png"
    found = answered([*line, *more, "--directions", "4", "-o", str(picture)])
    assert len(found["velocities"]) == 4
    assert found["chain"]["shape"] == [31, 31]
    assert picture.stat().st_size > 1000


@pytest.mark.parametrize(
    ("damping", "attracts"),
    [
        ("1 - 4*y**2 + 0.5*y**4", True),
        ("1", True),  # no cycle at all
        ("y**2 - 1", False),
    ],
)
def test_rest_attracts_unless_the_only_cycle_does(damping: str, attracts: bool) -> None:
    assert OscillatorChain(damping=damping, c=0.1, sites=3).rest_attracts is attracts


def test_ahead_of_a_front_into_an_unstable_rest_state_the_smallest_motion_counts() -> None:
    """Of (43) with damping -1/2, r_n = r e^{T/2} J_n(cT): twelve sites on it is 1e-15 r."""
    from scipy.special import jv

    chain = OscillatorChain(damping="y**2 - 1", c=0.6, sites=41).averaged()
    tiny = 1e-5
    start = excite(chain, [21], displacement=tiny)
    run = simulate(chain, start, 1.0 / chain.eps, tolerance=1e-6)
    found = run.amplitude[-1, 20:33] / tiny
    assert found == pytest.approx(np.exp(0.5) * np.abs(jv(np.arange(13), 0.6)), rel=1e-2)
