"""Averaged chains of one's own: the average itself, its distance from full runs, its refusals."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from theory.cells.oscillator import OscillatorCell
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.breathers.breather import breather
from verification.runs import averaging_error as averaging_error_module
from verification.runs.averaging_error import averaging_error
from verification.runs.excite import excite
from verification.runs.simulate import simulate

PAPER: dict[str, Any] = {"damping": "1 - a*y**2 + b*y**4", "values": {"a": 4, "b": 0.5}, "c": 0.6}

# One text for all three, so that it is compiled once.
GENERAL, STIFFNESS = "p0 + p2*y**2 + p4*y**4 + p6*y**6 + q*v**2", "y + share_of_eps*k*y**3"
NEAREST = "next-nearest:1,0"
CELLS = {
    # Lord Rayleigh, On maintained vibrations, Phil. Mag. 15, 229 (1883).
    "Rayleigh": {"p0": -1, "p2": 0, "p4": 0, "p6": 0, "q": 1, "k": 0},
    # J. Kyzioł, A. Okniński, arXiv:1904.07678, without their force.
    "Duffing-Van der Pol": {"p0": -1, "p2": 1, "p4": 0, "p6": 0, "q": 0, "k": 0.005},
    # H. G. Enjieu Kadji, J. B. Chabi Orou, R. Yamapi, P. Woafo, Chaos, Solitons & Fractals 32,
    # 862 (2007); R. Yamapi et al., Chaos 22, 043114 (2012).
    "birhythmic Van der Pol": {"p0": -1, "p2": 1, "p4": -0.144, "p6": 0.005, "q": 0, "k": 0},
}


FULL = {
    **{name: OscillatorChain(damping=GENERAL, stiffness="y + k*y**3", values=values, c=0.5,
                             eps=0.02, sites=6, coupling="next-nearest:1,0.2")
       for name, values in CELLS.items()},
    # ω = 2: the turning frame, the velocities and the errors are those of the cell.
    "another frequency": OscillatorChain(damping="v**2 - 1", stiffness="4*y", c=0.5, eps=0.02,
                                         sites=3),
    "paper": VdpChain(a=4, b=0.5, c=0.5, eps=0.01, sites=6),
}  # fmt: skip


@pytest.mark.parametrize("name", FULL)
def test_the_averaged_chain_is_first_order_close_to_the_full_one(name: str) -> None:
    """Distance Cε(1 + O(ε)), so the slope is 1 + O(ε); a wrong average would make it 0."""
    chain: Any = FULL[name]
    start = excite(chain, [3, 4], quarter_turns=[0, 1]) if name in CELLS else None
    found = averaging_error(chain, start, slow_time=2.0)
    assert found.eps.tolist() == [chain.eps, chain.eps / 2.0, chain.eps / 4.0]
    assert np.all(found.errors < 1e-3 * found.distances)
    assert found.slope == pytest.approx(1.0, abs=0.1)


def test_the_averaged_rate_is_the_mean_of_the_full_one_over_a_turn() -> None:
    """By equal samples of a turn, exact for polynomials; every kind of term is there."""
    chain = OscillatorChain(
        damping="v**2*u - 1 + y**2 + 0.3*y*v + 0.2*y + 0.1*v**3*y**3", c=0.7, eps=0.02, sites=5,
        stiffness="w*y + 0.001*y**2 + k*y**3", velocity_coupling=0.3,
        values={"u": 1.5, "k": 0.002, "w": 2.0}, disorder={"w": 0.01, "u": 0.2}, seed=2,
        coupling="next-nearest:1,0.4",
    )  # fmt: skip
    averaged = chain.averaged()
    omega, matrix = math.sqrt(2.0), chain.links.matrix.toarray()
    u, w = chain.site_values["u"], chain.site_values["w"]
    random = np.random.default_rng(0)
    phi = random.standard_normal(5) + 1j * random.standard_normal(5)
    turn = np.exp(2j * np.pi * np.arange(64) / 64)[:, None]
    y, v = (phi * turn).imag, omega * (phi * turn).real
    h = v**2 * u - 1.0 + y**2 + 0.3 * y * v + 0.2 * y + 0.1 * v**3 * y**3
    force = -(w - 2.0) * y - 0.001 * y**2 - 0.002 * y**3
    force = force - 0.02 * h * v - 0.02 * 0.7 * (y + 0.3 * v) @ matrix.T
    expected = (force / turn).mean(axis=0) / (omega * 0.02)
    pull, numbers = matrix @ phi, averaged.kernel_parameters()
    for n in range(5):
        im, re = averaged.kernel()(
            (phi[n].imag, phi[n].real), (pull[n].imag, pull[n].real), numbers, n, 5
        )
        assert re + 1j * im == pytest.approx(expected[n], abs=1e-13)


def test_the_two_forms_of_the_averaged_rate_are_one() -> None:
    """With two neighbours given, and with the pull of a network."""
    random = np.random.default_rng(1)
    phi = [tuple(random.standard_normal(2)) for _ in range(3)]
    left, site, right = phi
    pull = tuple(2.0 * site[at] - left[at] - right[at] for at in (0, 1))
    neighbours, network = (
        OscillatorChain(**PAPER, coupling=coupling, sites=5).averaged()
        for coupling in ("chain", "next-nearest:1,0")
    )
    one = neighbours.kernel()(site, left, right, neighbours.kernel_parameters())
    other = network.kernel()(site, pull, network.kernel_parameters(), 2, 5)
    assert one == pytest.approx(other, rel=1e-14)


def test_the_averaged_chain_of_the_paper_as_text_is_the_built_in_one(
    answered: Any,
) -> None:
    values = {"p0": 1, "p2": -4, "p4": 0.5, "p6": 0, "q": 0, "k": 0, "share_of_eps": 1}
    full = OscillatorChain(
        damping=GENERAL, stiffness=STIFFNESS, values=values, c=0.6, sites=9, coupling=NEAREST
    )
    text, built_in = full.averaged(), AveragedChain(a=4, b=0.5, c=0.6, sites=9)
    assert text.full() == full != text
    start = excite(built_in, [4, 5])
    ours, theirs = (simulate(each, start, 500.0, samples=4) for each in (text, built_in))
    np.testing.assert_allclose(ours.states, theirs.states, atol=1e-10)
    np.testing.assert_allclose(ours.arrivals, theirs.arrivals, rtol=1e-9)
    line = ["simulate", "averaged-chain", "--damping", GENERAL, "--stiffness", STIFFNESS]
    line += [part for name, value in values.items() for part in ("--value", f"{name}={value}")]
    line += ["--c", "0.6", "--n", "9", "--coupling", NEAREST, "--excite", "4:5", "--t-end", "500"]
    amplitudes = answered(line)["amplitudes"]
    assert amplitudes == pytest.approx(np.hypot(*theirs.states[-1]).tolist(), abs=1e-9)


def test_cycles_are_the_roots_of_the_averaged_equation() -> None:
    """For α = 0.144, β = 0.005 by hand: 1 - s/4 + αs²/8 - 5βs³/64 = 0, s = A²."""
    birhythmic = OscillatorChain(damping=GENERAL, values=CELLS["birhythmic Van der Pol"],
                                 stiffness="y + k*y**3", c=0.0)  # fmt: skip
    squares = np.sort(np.roots([-5.0 * 0.005 / 64.0, 0.144 / 8.0, -0.25, 1.0]))
    cycles = birhythmic.cell.cycles
    assert [each.amplitude for each in cycles] == pytest.approx(np.sqrt(squares), rel=1e-12)
    assert [each.stable for each in cycles] == [True, False, True]


@pytest.mark.parametrize("stiffness", [{1: 1.0}, {1: 1.0, 3: 1e-13}])
@pytest.mark.parametrize("apart", [1e-2, 1e-4])
def test_two_cycles_close_to_each_other_are_both_found(
    stiffness: dict[int, float], apart: float
) -> None:
    """H = (s - 4)(s - 4(1 + δ)), by its polynomial and by the general search."""
    one, other = 4.0, 4.0 * (1.0 + apart)
    damping = {(0, 0): one * other, (2, 0): -4.0 * (one + other), (4, 0): 8.0}
    cycles = OscillatorCell(stiffness=stiffness, damping=damping).cycles
    assert [each.stable for each in cycles] == [False, True]
    # A root beside another one is known to rounding over their distance.
    expected = [2.0, math.sqrt(other)]
    assert [each.amplitude for each in cycles] == pytest.approx(expected, abs=1e-13 / apart)


def test_an_average_that_would_mislead_is_refused() -> None:
    chain = OscillatorChain(**PAPER, sites=5)
    with pytest.raises(ParameterError, match="unit of eps t"):
        chain.replace(stiffness="y + y**3").averaged()
    with pytest.raises(ParameterError, match="without inertia the chain does not oscillate"):
        OscillatorChain(damping=0, stiffness="y*(1-y)*(0.2-y)", overdamped=True, c=1).averaged()
    with pytest.raises(ParameterError, match=r"AveragedOscillatorChain .* take chain.full\(\)"):
        breather(chain.averaged())
    spread = chain.replace(stiffness="w*y", values={**PAPER["values"], "w": 1}, disorder="w=0.01")
    for bad, words in (
        ({"chain": spread}, "from site to site"),
        ({"chain": chain, "halvings": 1}, "halvings"),
        ({"chain": chain, "slow_time": 1e3}, "at most 100"),
    ):
        with pytest.raises(ParameterError, match=words):
            averaging_error(**bad)


@pytest.mark.parametrize("omega", [0.5, 2.0])
def test_a_rotation_at_the_frequency_of_the_cell_is_no_distance_from_its_envelope(
    omega: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """y = sin ωt and v = ω cos ωt have the envelope 1, whatever ω is."""
    chain = OscillatorChain(damping="v**2 - 1", stiffness=f"{omega**2}*y", c=0.5, eps=0.02, sites=3)
    starts: list[np.ndarray] = []

    def simulate(run: Any, start: np.ndarray, end: float, times: list[float], **_: Any) -> Any:
        starts.append(start)
        y, v = np.zeros(len(times)), np.ones(len(times))
        if run is chain:
            y, v = np.sin(omega * np.array(times)), omega * np.cos(omega * np.array(times))
        states = np.array([y, v]).T[:, :, None] * np.ones(3)
        return SimpleNamespace(states=states, error=0.5 if run is chain else 0.25)

    monkeypatch.setattr(averaging_error_module, "simulate", simulate)
    start = np.array([[0.0, 0.0, 0.0], [omega, omega, omega]])
    distance, error = averaging_error_module._distance(chain, start, 2.0)
    assert distance < 1e-12
    assert starts[1].tolist() == [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]
    # y and v / ω of the chain err by no more than its state and that over ω.
    assert error == 0.5 * max(1.0, 1.0 / omega) + 0.25


@pytest.mark.parametrize(("sites", "middle"), [(3, 2), (6, 3), (7, 4)])
def test_the_middle_site_is_excited_if_nothing_is_said(
    sites: int, middle: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    starts: list[np.ndarray] = []
    shares: list[float] = []

    def distance(chain: Any, start: np.ndarray, _: float) -> tuple[float, float]:
        starts.append(start)
        shares.append(chain.values[averaging_error_module.SHARE] if chain.model == "chain" else 1.0)
        return chain.eps, 1e-9

    monkeypatch.setattr(averaging_error_module, "_distance", distance)
    chain = VdpChain(a=4, b=0.5, c=0.5, eps=0.04, sites=sites)
    found = averaging_error(chain, halvings=3)
    assert found.eps.tolist() == [0.04, 0.02, 0.01, 0.005]
    assert all(np.array_equal(each, excite(chain, [middle])) for each in starts)
    assert averaging_error(chain, slow_time=100.0).slow_time == 100.0
    duffing = OscillatorChain(damping="y**2 - 1", stiffness="y + k*y**3", values={"k": 0.01}, c=0.1)
    averaging_error(duffing)
    assert shares[-3:] == [1.0, 0.5, 0.25]
    linear = OscillatorChain(damping="y**2 - 1", c=0.1, eps=0.04, sites=3)  # has nothing to halve
    assert averaging_error_module._at_eps(linear, 0.02) == linear.replace(eps=0.02)
    fisher = OscillatorChain(damping=0, stiffness="y*(1 - y)*(0.2 - y)", overdamped=True, c=0.1)
    with pytest.raises(ParameterError, match="overdamped"):  # before anything is run
        averaging_error(fisher)
