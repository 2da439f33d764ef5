"""The second-order breather against true orbits, and the readings of (37) against the chain."""

import math

import numpy as np
import pytest

from derivations import judgement
from derivations.algebra.modulation import Force, by_averaging, by_multiple_scales
from derivations.averaging import readings
from derivations.averaging.periodic_orbit import harmonic, orbit
from derivations.averaging.readings import paper_numbers
from derivations.chain import PAPER
from derivations.symbols import epsilon
from tests.second_order_breather import breather
from theory.averaged.breather import Reading, solve_breather
from theory.averaged.envelope import envelope_rate
from theory.chains.ends import Ends
from theory.chains.vdp import VdpChain

CELL = {"a": 2.5, "b": 0.5, "c": 0.1}


@pytest.fixture(scope="module")
def true_orbits():
    """Size and phase of the fundamental at each site, beyond steps of -pi/2, at two eps."""
    sites, samples = 6, 41
    wave = 2 * np.pi * np.arange(samples) / samples - np.pi / 2 * np.arange(sites)[:, None]
    start = np.array([2.8, 0.3, 0.03, 0.003, 0.0, 0.0])[:, None] * np.sin(wave)
    found = {}
    for e in (0.01, 0.005):
        y, _ = orbit(start, 1 + e * CELL["c"], paper_numbers(*CELL.values(), e))
        turned = 2j * harmonic(y, 1) * 1j ** np.arange(sites)
        found[e] = abs(turned), np.angle(turned)
    return found


@pytest.mark.parametrize("route", [by_multiple_scales, by_averaging])
@pytest.mark.parametrize("site", [1, 2])
def test_sizes_and_phases_of_the_sites_approach_the_true_orbit(true_orbits, route, site):
    found = breather(route(Force.read(PAPER.equation(), epsilon), 2), CELL)
    errors = {"size": [], "corrected size": [], "phase": [], "corrected phase": []}
    for e, (size, phase) in true_orbits.items():
        errors["size"].append(abs(size[site] - found.amplitudes[site]))
        corrected = found.amplitudes[site] + e * found.amplitude_corrections[site]
        errors["corrected size"].append(abs(size[site] - corrected))
        errors["phase"].append(abs(phase[site]))
        errors["corrected phase"].append(abs(phase[site] - e * found.phase_corrections[site]))
    slopes = {name: math.log2(large / small) for name, (large, small) in errors.items()}
    # eps_eff is about 0.1 here, which is what the slopes are off by at most.
    assert slopes["size"] == pytest.approx(1, abs=0.3)
    assert slopes["corrected size"] == pytest.approx(2, abs=0.4)
    assert slopes["phase"] == pytest.approx(1, abs=0.3)
    assert slopes["corrected phase"] == pytest.approx(2, abs=0.4)
    assert found.phase_corrections[0] == pytest.approx(0, abs=1e-12)


def test_the_chain_that_judges_the_readings_is_a_steady_breather_of_the_averaged_chain():
    r = readings.averaged_breather()
    steps = np.arange(-len(r) + 1, len(r))
    phi = (-1j) ** abs(steps) * r[abs(steps)]
    chain = VdpChain(**CELL, sites=len(phi), ends=Ends.FREE)
    # It turns at the rate c; the free ends are 11 sites away, where r is 1e-11.
    np.testing.assert_allclose(envelope_rate(phi, chain), 1j * CELL["c"] * phi, atol=1e-9)
    assert r[0] > 2.5
    assert r[1] > 10 * r[2] * 0.9


def test_each_reading_of_37_is_judged_by_the_neighbour_that_theory_finds_with_it():
    exact = readings.averaged_breather()[1]
    centre, first, tail = (reading.check(reading.equation) for reading in
                           judgement.printed(37).readings)  # fmt: skip
    assert "no solution" in centre.statement
    assert solve_breather(VdpChain(**CELL), Reading.CENTRE).alpha_0 is None
    for found, place in ((first, Reading.NEIGHBOUR), (tail, Reading.TAIL)):
        neighbour = solve_breather(VdpChain(**CELL), place).amplitudes(2)[1]
        # The statement gives two digits.
        stated = float(found.statement.split()[-1])
        assert stated == pytest.approx(abs(neighbour / exact - 1), rel=0.05)
        assert found.holds == (place is Reading.NEIGHBOUR)


def test_three_sites_of_a_geometric_sequence_are_what_is_tried(monkeypatch):
    # A damping that vanishes at size e^{-0.2 site}, site = 1, 2, 3, and at no other amplitudes.
    def damping(square, _):
        site = math.log(0.3 / math.sqrt(square)) / 0.2
        return abs(site - round(site)) + (0.0 if 0.9 < site < 3.1 else site)

    monkeypatch.setattr(readings, "damping_mean", damping)
    assert readings.at_every_site(None).holds
    monkeypatch.undo()
    assert not readings.at_every_site(None).holds
