"""Every example runs as it stands, draws its picture, and gives the number it is about."""

from __future__ import annotations

import importlib.util
import math
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from theory.cells.vdp import threshold_ratio
from theory.chains.chain import CHAINS
from theory.chains.friction import FrictionChain
from theory.piecewise.sums.series import sum_by_roots
from verification.references.friction_events import run_events
from verification.runs.excite import excite

EXAMPLES = Path(__file__).parents[1] / "examples"


def decay_per_site(c: float) -> complex:
    """Return the root of q + 1/q = 2 + i/c within the unit circle."""
    return complex(min(np.roots([1.0, -(2.0 + 1j / c), 1.0]), key=abs))


EXPECTED = {
    # |Σ| = 2r at c = 1, by the root series to 30 digits (tests/test_theory_kinetic.py)
    "kinetic_curve": (0.697386087321, 1e-11, "svg"),
    # a multiplier of the true orbit; the averaged chain gives exp(2πε λ), λ = -0.451, to O(ε²)
    "breather_stability": (math.exp(-2 * math.pi * 0.01 * 0.451), 2e-3, "svg"),
    # the front as a solution of (43); twenty sites of a run that began elsewhere
    "front_in_space_and_time": (0.7225664558, 1e-4, "png"),
    # the fold of the averaged breather, by continuation (tests/test_breather_thresholds.py)
    "nucleus_threshold": (0.190787743629, 1e-11, "svg"),
    # the second, event-located integrator through scipy gives the same arrival
    "stick_slip_front": (691.29555834, 1e-5, "png"),
    # 1 - 3s/4 + s²/16 = 0, so s = 6 + 2√5
    "derive_your_cell": (math.sqrt(6 + 2 * math.sqrt(5)), 1e-12, "txt"),
    # the continuum limit √(c/2)(1 - 2α), which the lattice slows by a few per cent
    "your_own_model": (math.sqrt(0.5) * 0.6, 0.03, "svg"),
    # its averaged chain, derived and integrated by scipy (tests/test_own_fronts.py)
    "own_cell": (2.2238, 1e-3, "svg"),
    # the continuum has D = c(1 + 4w), and v grows like √D
    "next_nearest": (math.sqrt(1.8), 0.01, "svg"),
    # scipy's arrivals (tests/test_own_fronts.py); √(c/2)(1 - 2α) of the continuum without disorder
    "disordered_chain": (math.sqrt(0.5) * 0.6, 0.02, "png"),
    # linear response of a half-infinite chain at ω = 1, 1/|iε + εc(1 - q)|, q + 1/q = 2 + i/c; a
    # A²/4 = 0.0016 of the damping is nonlinear
    "driven_chain": (100 / abs(1j + 0.6 * (1 - decay_per_site(0.6))), 0.15, "png"),
    # below that of planar fronts, 1.113 (tests/test_own_fronts.py)
    "lattice_front": (1.0767, 1e-3, "gif"),
    # without disorder √(c/2)(1 - 2α) in the continuum
    "seeds": (math.sqrt(0.5) * 0.6, 0.02, "svg"),
}


def test_every_example_is_pinned() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_an_example_is_under_forty_lines(name: str) -> None:
    assert len((EXAMPLES / f"{name}.py").read_text("utf-8").splitlines()) < 40


@pytest.mark.parametrize("name", EXPECTED)
def test_the_example_gives_its_number_and_its_picture(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)  # compiled code is kept by module
    # That two processes answer as one does is tested in tests/test_own_fronts.py.
    monkeypatch.setattr("verification.execution.pool.cores_allowed", lambda: 1)
    with mpl.rc_context({"backend": "agg"}):
        spec.loader.exec_module(module)
        value, tolerance, kind = EXPECTED[name]
        picture = tmp_path / f"{name}.{kind}"
        try:
            assert module.main(str(picture)) == pytest.approx(value, abs=tolerance)
        finally:
            CHAINS.pop("nagumo-example", None)  # an example may define a model
    assert picture.stat().st_size > 10


def test_the_velocity_of_the_curve_solves_the_kinetic_relation_by_another_sum() -> None:
    size = abs(sum_by_roots(EXPECTED["kinetic_curve"][0], 1.0, digits=30).value)
    assert float(size) == pytest.approx(2.0 * threshold_ratio(0.03125), abs=1e-11)


def test_the_arrival_is_that_of_the_event_located_integrator_of_scipy() -> None:
    chain = FrictionChain(c=0.02, v_d=1.25, sites=21)
    run = run_events(
        chain, excite(chain, [1]), 695.0, times=np.array([0.0, 695.0]), tolerance=1e-8,
        longest_step=0.5,
    )  # fmt: skip
    sticks = run.log[(run.log[:, 1] == 11) & (run.log[:, 2] == 0), 0]
    value, tolerance, _ = EXPECTED["stick_slip_front"]
    assert sticks[0] == pytest.approx(value, abs=tolerance)
