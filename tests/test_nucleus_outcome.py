"""Claims about what becomes of a nucleus: by other integrators, and by made-up arrivals."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fronts.nucleus_evolution import evolution_in_time
from paper_checks.claims import text_nuclei
from theory.chains.ends import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.breathers.outcome import (
    PAUSE,
    SAME,
    NucleusOutcome,
    _same_until,
    distance_from_breather,
    evolution,
    follow_nucleus,
)
from verification.references.equations import full_rate

A, B, EPS = 2.5, 0.5, 0.01
NAN = float("nan")


def chain(c: float, sites: int = 41) -> VdpChain:
    return VdpChain(a=A, b=B, c=c, eps=EPS, sites=sites)


def joined_by_scipy(chain: VdpChain, slow_time: float) -> np.ndarray:
    """Slow time at which |ẏ + iy| of each site first exceeds the unstable cycle: DOP853 on (8)."""
    amplitude, level = (
        np.sqrt((A / B) * (1 + side * np.sqrt(1 - 8 * B / A**2))) for side in (1, -1)
    )
    half, eps = chain.sites // 2 + 1, chain.eps
    free = full_rate(chain.replace(sites=half))

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        # Mirror symmetry by folding: site 0 is the middle, with its neighbour on both sides.
        out = free(t, x)
        out[half] -= eps * chain.c * (x[0] - x[1])
        return out

    state = np.zeros(2 * half)
    state[0] = amplitude
    joined = np.full(half, np.nan)
    joined[0] = 0.0
    step = 1.0 / eps
    for block in range(round(slow_time)):
        run = solve_ivp(rate, (0, step), state, "DOP853", rtol=1e-8, atol=1e-9)
        size = np.hypot(run.y[:half], run.y[half:])
        for site in np.flatnonzero(np.isnan(joined) & (size > level).any(axis=1)):
            joined[site] = block + eps * run.t[np.argmax(size[site] > level)]
        state = run.y[:, -1]
    return joined


def test_sites_join_when_they_do_by_scipy() -> None:
    """Five sites by T = 42 at c = 0.21."""
    fast = chain(0.21, 31).replace(eps=0.02)  # fewer turns in the same slow time
    followed = follow_nucleus(fast, slow_time=42.0, perturbation=0.0, seed=0)
    half = fast.eps * followed.run.arrivals[15:]
    expected = joined_by_scipy(fast, 42.0)
    assert np.array_equal(np.isnan(half), np.isnan(expected))
    assert np.count_nonzero(~np.isnan(half)) == 3
    # scipy is read at its steps, of 0.01 of T or less; its own error is 1e-3 by then.
    assert np.nanmax(np.abs(half - expected)) < 0.05


def test_a_pause_is_long_if_it_is_longer_than_that_of_a_front() -> None:
    """Up to the last site of the chain, or up to the end of the run."""
    for pause, outcome in (
        (PAUSE, NucleusOutcome.FRONT),
        (np.nextafter(PAUSE, 2 * PAUSE), NucleusOutcome.CREEP),
    ):
        times = pause * np.arange(1.0, 5.0)
        joined = np.concatenate([times[::-1], [0.0], times])
        assert evolution(joined, 10.0 * PAUSE, 9).outcome is outcome
        assert evolution(joined / 8.0, 10.0 * PAUSE, 9, pause=PAUSE / 8.0).outcome is outcome


@pytest.mark.parametrize("order", [1, -1])
def test_two_runs_are_the_same_until_the_first_site_that_joins_at_another_time(order: int) -> None:
    one = np.array([0.0, 10.0, 30.0, 50.0, NAN])[::order]
    other = np.array([0.0, 10.0 + 0.9 * SAME, 30.0 - 1.1 * SAME, NAN, NAN])[::order]
    assert _same_until(one, other, 90.0) == _same_until(other, one, 90.0) == 30.0 - 1.1 * SAME
    assert _same_until(one, one, 90.0) == 90.0
    late = np.where(np.isnan(one), 70.0, one)
    assert _same_until(one, late, 90.0) == 70.0
    # One unit of slow time is allowed for.
    assert _same_until(one, one + 0.99, 90.0) == 90.0
    assert _same_until(one, one + 1.01, 90.0) == 0.0


def test_where_a_mirrored_nucleus_stands_it_is_the_periodic_orbit_of_its_size() -> None:
    followed = follow_nucleus(chain(0.193), slow_time=500.0, perturbation=0.0, seed=0)
    assert (followed.evolution.outcome, followed.evolution.size) == (NucleusOutcome.LARGER, 5)
    assert followed.mirrored
    assert followed.confirmed
    assert followed.same_until == 500.0
    near = distance_from_breather(followed)
    # |Ψ| of a motion of amplitude 3 has a ripple of ε times that, on both sides.
    assert near.gap < 2 * EPS * 3
    assert near.growth > 0.01


def test_noise_drives_the_same_nucleus_on() -> None:
    followed = follow_nucleus(chain(0.193), perturbation=1e-3, seed=1, slow_time=800.0)
    assert followed.evolution.size_at(300.0) == 5
    assert followed.evolution.outcome is NucleusOutcome.CREEP
    assert followed.evolution.size > 5
    assert not followed.mirrored
    assert followed.confirmed
    assert followed.evolution.longest_pause > PAUSE


def test_below_the_loss_it_holds_and_beyond_the_range_a_front_runs() -> None:
    assert (
        follow_nucleus(chain(0.19), slow_time=300.0, perturbation=0.0, seed=0).evolution.outcome
        is NucleusOutcome.HELD
    )
    assert (
        follow_nucleus(chain(0.21, 21), slow_time=400.0, perturbation=0.0, seed=0).evolution.outcome
        is NucleusOutcome.FRONT
    )


@pytest.mark.parametrize(
    ("joined", "size", "outcome"),
    [
        ([NAN, 0, NAN], 0, NucleusOutcome.SHRUNK),
        ([NAN, 0, NAN], 1, NucleusOutcome.HELD),
        ([NAN, NAN, 40, 0, 40, NAN, NAN], 3, NucleusOutcome.LARGER),
        ([NAN, NAN, 50, 0, 50, NAN, NAN], 3, NucleusOutcome.LARGER),
        ([NAN, NAN, 60, 0, 60, NAN, NAN], 3, NucleusOutcome.UNDECIDED),
        ([NAN, 90, 60, 30, 0, 30, 60, 90, NAN], 7, NucleusOutcome.FRONT),
        ([NAN, 99, 60, 30, 0, 30, 60, 99, NAN], 7, NucleusOutcome.FRONT),
        ([40, 30, 20, 0, 20, 30, 40], 7, NucleusOutcome.FRONT),
        ([0, 10, 20, 30, 40, 50, 60, 70], 8, NucleusOutcome.FRONT),
        ([0, 0, NAN, NAN], 2, NucleusOutcome.HELD),
        ([40, 0, 40], 3, NucleusOutcome.FRONT),  # few, but there are no more
    ],
)
def test_the_rules_on_made_up_arrivals(
    joined: list[float], size: int, outcome: NucleusOutcome
) -> None:
    assert evolution(np.array(joined, dtype=float), 100.0, size).outcome is outcome


def test_one_long_pause_makes_creep_of_a_front() -> None:
    """In the middle of the growth, or at its end if the run goes on."""
    even = np.array([NAN, 90, 60, 30, 0, 30, 60, 90, NAN])
    late = np.array([NAN, 290, 260, 30, 0, 30, 260, 290, NAN])
    assert evolution(even, 150.0, 7).outcome is NucleusOutcome.FRONT
    assert evolution(late, 300.0, 7).outcome is NucleusOutcome.CREEP
    assert evolution(even + 0.9 * 90 * (even > 0), 300.0, 7).outcome is NucleusOutcome.CREEP


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_chain_that_has_been_filled_is_no_larger_nucleus_in_whatever_unit(unit: float) -> None:
    """Its ends have joined, and there is nothing left to join."""
    filled = unit * np.array([0.95, 0.6, 0.3, 0.0, 0.3, 0.6, 0.95])
    found = evolution(filled, 2.0 * unit, 7, pause=0.4 * unit)
    assert found.outcome is NucleusOutcome.FRONT
    assert found.longest_pause == pytest.approx(0.35 * unit)  # until the ends joined


def test_a_nucleus_wider_than_the_chain_is_refused() -> None:
    with pytest.raises(ParameterError, match="nucleus size"):
        follow_nucleus(chain(0.19, 5), 7, perturbation=0.0, seed=0)


@pytest.mark.parametrize("perturbation", [-1e-3, 1.5, NAN])
def test_noise_that_is_none_is_refused(perturbation: float) -> None:
    with pytest.raises(ParameterError, match="perturbation"):
        follow_nucleus(chain(0.19, 5), perturbation=perturbation, seed=0)


@pytest.mark.parametrize("slow_time", [0.0, -1.0])
def test_a_time_that_is_none_is_refused(slow_time: float) -> None:
    with pytest.raises(ParameterError, match="slow time"):
        follow_nucleus(chain(0.19, 5), slow_time=slow_time, perturbation=0.0, seed=0)


def test_the_verdict_follows_what_the_runs_show() -> None:
    stands = {0.193: "larger nucleus", 0.203: "front"}
    assert text_nuclei.succession(stands)
    assert not text_nuclei.succession({0.193: "creep", 0.203: "front"})
    assert not text_nuclei.succession({0.193: "larger nucleus", 0.203: "creep"})
    assert not text_nuclei.succession({0.193: "front", 0.203: "larger nucleus"})


@pytest.mark.parametrize(
    ("joined", "longest"),
    [
        ([NAN, NAN, 0, NAN, NAN], None),
        ([NAN, 30, 0, NAN, NAN], None),
        ([NAN, 30, 0, 75, NAN], 45.0),
        ([NAN, 30, 0, 50, 90, NAN, NAN], 40.0),
    ],
)
def test_the_longest_pause_is_between_two_sites_that_join(
    joined: list[float], longest: float | None
) -> None:
    assert evolution(np.array(joined), 100.0, len(joined)).longest_pause == longest


@pytest.mark.parametrize("eps", [0.01, 0.04])
def test_beside_a_run_the_nucleus_has_the_times_of_the_run(eps: float, answered: Any) -> None:
    """Those at which sites were reached, in t; the rules are about slow time all the same."""
    end = 35.0 / eps
    line = f"simulate vdp --n 9 --c 0.25 --eps {eps} --excite 5 --t-end {end}"
    found = answered(line)
    reached = sorted(t for t in found["arrivals"] if t is not None)
    moments = sorted(set(reached))
    assert len(moments) > 2
    sizes = [[t, sum(each <= t for each in reached)] for t in moments]
    assert found["nucleus"]["sizes"] == sizes
    pauses = np.diff([t for t in reached if t > 0])
    assert found["nucleus"]["longest_pause"] == pytest.approx(pauses.max())
    assert found["nucleus"]["end"] == "front"


def test_the_evolution_of_a_nucleus_is_judged_from_the_last_sample(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[float, int]] = []

    def judged(_: Any, end: float, size: int, **__: Any) -> Any:
        asked.append((end, size))
        return SimpleNamespace(outcome="pinned", size=size, sizes=(), longest_pause=0.0)

    monkeypatch.setattr("verification.breathers.outcome.evolution", judged)
    run: Any = SimpleNamespace(
        chain=VdpChain(a=4, b=0.5, c=0.1, sites=9), times=np.array([0.0, 5.0, 9.0]),
        width=np.array([1, 5, 3]), arrivals=np.zeros(9),
    )  # fmt: skip
    assert evolution_in_time(run)["nucleus"]["size"] == 3
    assert asked == [(9.0, 3)]
    for chain in (VdpChain(a=4, b=2.5, c=0.1), VdpChain(a=4, b=0.5, c=0.1, ends=Ends.PERIODIC)):
        assert not evolution_in_time(SimpleNamespace(**{**vars(run), "chain": chain}))
