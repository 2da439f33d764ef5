"""Breathers of chains of one's own: those of the paper's chain, and orbits that scipy confirms."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from fronts.cli import main
from theory.chains.nucleus import Nucleus
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.breathers.breather import breather
from verification.breathers.own import OwnOrbits, integrate_with_tangents
from verification.breathers.periodic_motion import largest_displacements
from verification.continuation.newton import solve_at
from verification.references.equations import pull_matrix
from verification.references.network import oscillator_rate, states_by_scipy
from verification.thresholds.continuation import breather_threshold
from verification.thresholds.result import ThresholdMethod
from verification.thresholds.threshold import threshold

PAPER = {"damping": "1 - a*y**2 + b*y**4", "values": {"a": 2.5, "b": 0.5}}


@pytest.mark.parametrize("nucleus", [Nucleus(1), Nucleus(2, "0")])
def test_the_breather_of_the_paper_as_text_is_that_of_the_built_in_chain(nucleus: Nucleus) -> None:
    """By other steps (Runge-Kutta and not Taylor), from another start, the same orbit."""
    ours = breather(OscillatorChain(**PAPER, c=0.1, sites=9), nucleus=nucleus)
    theirs = breather(VdpChain(a=2.5, b=0.5, c=0.1, sites=9), nucleus=nucleus, method="orbit")
    assert ours.multipliers is not None
    assert theirs.multipliers is not None
    np.testing.assert_allclose(ours.amplitudes, theirs.amplitudes, atol=1e-11)
    assert ours.frequency == pytest.approx(theirs.frequency, abs=1e-12)
    assert ours.growth == pytest.approx(theirs.growth, abs=1e-8)
    far = [np.abs(ours.multipliers - each).min() for each in theirs.multipliers]
    assert max(far) < 1e-9
    assert ours.stable is theirs.stable


def test_the_cycle_of_van_der_pol_has_the_published_period_and_amplitude() -> None:
    """ε = 1, far from averaging: two cells in step, whose coupling does nothing.

    The numbers are those of P. Amore, Computing the solutions of the van der Pol equation to
    arbitrary precision, arXiv:2111.12198, and of the test problem of E. Hairer, S. P. Nørsett and
    G. Wanner, Solving Ordinary Differential Equations I.
    """
    chain = OscillatorChain(damping="y**2 - 1", c=0.1, eps=1.0, sites=2)
    start = np.array([0.0, 0.0, 2.0, 2.0, 6.7])
    solved = solve_at(OwnOrbits(chain, Nucleus(1), 400).system(centre=0), start, chain.c).u
    assert solved[-1] == pytest.approx(6.663286859323130, abs=1e-13)
    flow = integrate_with_tangents(chain, solved[:-1], float(solved[-1]), 400)
    assert largest_displacements(flow.samples) == pytest.approx(2.008619860874843, abs=1e-13)


def test_an_orbit_of_a_disordered_chain_is_one_of_scipy_with_its_multipliers() -> None:
    """The state comes back after a period, and disturbances grow as the monodromy matrix says."""
    chain = OscillatorChain(**PAPER, c=0.08, disorder={"a": 0.02}, seed=4, sites=7)
    a = 2.5 * (1.0 + 0.02 * np.random.default_rng([4, 0]).standard_normal(7))
    rate = oscillator_rate(
        lambda y: y, lambda y, v: 1.0 - a * y**2 + 0.5 * y**4, pull_matrix(7), c=0.08, eps=0.01
    )
    orbit = OwnOrbits(chain, Nucleus(1)).solve()
    times = np.array([0.0, orbit.period])

    def after(state: np.ndarray) -> np.ndarray:
        return states_by_scipy(rate, state, times, 1e-13)[-1]

    assert np.abs(after(orbit.state) - orbit.state).max() < 1e-9 > orbit.error
    flow = integrate_with_tangents(chain, orbit.state, orbit.period, 128)
    kick = np.random.default_rng(0).standard_normal(14)
    moved = (after(orbit.state + 1e-4 * kick) - after(orbit.state - 1e-4 * kick)) / 2e-4
    np.testing.assert_allclose(flow.monodromy @ kick, moved, atol=1e-6)
    size = 1e-4
    apart = [
        integrate_with_tangents(chain.replace(c=0.08 + d), orbit.state, orbit.period, 128).state
        for d in (-size, size)
    ]
    np.testing.assert_allclose(flow.by_c, (apart[1] - apart[0]) / (2.0 * size), atol=1e-8)


def test_the_branch_of_a_rayleigh_chain_ends_where_that_of_van_der_pol_does() -> None:
    """The velocity of ÿ + y + εh(ẏ)ẏ + … = 0 obeys (8): (h(w)w)' = (1 - 3aw² + 5bw⁴)w'."""
    rayleigh = OscillatorChain(damping="1 - a*v**2 + b*v**4", values={"a": 2.5 / 3, "b": 0.1}, c=0)
    ours = breather_threshold(rayleigh, Nucleus(1), ThresholdMethod.ORBIT, margin=3)
    theirs = breather_threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(1), ThresholdMethod.ORBIT, 3)
    assert ours.c_stable is not None
    assert ours.c == pytest.approx(theirs.c, abs=1e-10)
    assert ours.c_stable == pytest.approx(theirs.c_stable, abs=1e-8)
    assert ours.growth == pytest.approx(theirs.growth, abs=1e-4)
    assert ours.stability_lost_by is theirs.stability_lost_by


def test_a_branch_is_followed_of_alike_sites_along_a_line_only() -> None:
    line: dict[str, Any] = {**PAPER, "c": 0.1}
    for chain, words in (
        (OscillatorChain(**line, disorder="a=0.1"), "take bisection"),
        (OscillatorChain(**line, coupling="square", sites=(5, 5)), "take bisection"),
        (OscillatorChain(**line, drive="1,1@1"), "none for a breather"),
    ):
        with pytest.raises(ParameterError, match=words):
            threshold(chain, method="orbit")
    with pytest.raises(ParameterError, match="bisection for the model chain"):
        threshold(OscillatorChain(**line), method="envelope")


def test_a_nucleus_that_spreads_has_no_orbit_and_an_overdamped_cell_none_at_all() -> None:
    with pytest.raises(ParameterError, match="the nucleus stays as it is"):
        breather(OscillatorChain(**PAPER, c=0.6, sites=9))
    with pytest.raises(ParameterError, match="orbit for a chain of your own"):
        breather(OscillatorChain(**PAPER, c=0.1, sites=9), method="simulation")
    nagumo = OscillatorChain(damping=0, stiffness="y*(1-y)*(0.2-y)", overdamped=True, c=0.01)
    with pytest.raises(ParameterError, match="overdamped"):
        breather(nagumo)


def test_the_command_line_gives_the_breather(capsys: pytest.CaptureFixture[str]) -> None:
    line = ["breather", "chain", "--damping", PAPER["damping"], "--value", "a=2.5", "--value"]
    assert main([*line, "b=0.5", "--c", "0.1", "--n", "9", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["stable"] is True
    assert abs(found["frequency"] - 1.0009) < 1e-3
