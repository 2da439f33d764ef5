"""A reference confirms what is stated where it is right, and refutes it where it is made wrong.

`tests.test_robustness` asks the first of many points. Here the second is asked of each reference
that is quick: a value that is a hundredth off, a root or a velocity left out, another label.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from verification.quantities import runs
from verification.quantities.chains import vdp_chain
from verification.quantities.friction import _root_energy
from verification.quantities.judging import PointOutcome, compared
from verification.quantities.quantity import StatedValue
from verification.quantities.registry import computation_named
from verification.quantities.states import _label_holds
from verification.runs.excite import as_psi, excite

RUN = {"a": 4.0, "eta": 0.03, "c": 0.6, "eps": 0.1, "sites": 4, "displacement": 2.0,
       "tolerance": 1e-9}  # fmt: skip

POINTS: list[tuple[str, Mapping[str, float]]] = [
    ("closed-form-fold", {"a": 2.5, "eta": 0.08, "reading": 1.0}),
    ("closed-form-breather", {"a": 2.5, "eta": 0.08, "c": 0.1, "reading": 1.0}),
    ("closed-form-breather", {"a": 2.5, "eta": 0.08, "c": 0.1, "reading": 2.0}),
    ("envelope-breather", {"eta": 0.08, "c": 0.1}),
    ("front-averaged", {"c": 2.0, "eta": 0.03125}),
    ("c-pin", {"eta": 0.03125}),
    ("eta-pin", {"c": 0.3}),
    ("strong-coupling-velocity", {"eta": 0.03125}),
    ("profile", {"v": 0.3, "c": 0.5, "distance": 3.16, "tolerance": 3e-8, "side": 1.0}),
    ("profile", {"v": 0.3, "c": 0.5, "distance": 4.0, "tolerance": 1e-8, "side": 3.0}),
    ("run-vdp", RUN),
    ("run-envelope", RUN),
    ("sigma-integral", {"v": 0.3, "c": 0.5, "tolerance": 1e-8}),
    ("sigma-series", {"v": 0.3, "c": 0.5, "digits": 8.0}),
]


def _once(integrate: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that integrates one chain from each start to each tolerance once."""
    known: dict[tuple[Any, ...], Any] = {}

    def same(rate: Any, start: np.ndarray, *rest: float) -> Any:
        asked = (start.tobytes(), *rest)
        if asked not in known:
            known[asked] = integrate(rate, start, *rest)
        return known[asked]

    return same


@pytest.mark.parametrize(("name", "at"), POINTS)
def test_what_is_right_is_confirmed_and_what_is_a_hundredth_off_refuted(
    name: str, at: Mapping[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runs, "integrate", _once(runs.integrate))
    monkeypatch.setattr(runs, "_END", 10.0)  # steps in extended precision take long
    row = computation_named(name)
    stated = row.compute(at)
    check = row.check(at, stated)
    assert compared(stated.error, check) is PointOutcome.RIGHT, check
    off = row.check(at, replace(stated, value=1.01 * stated.value))
    assert compared(stated.error, off) is PointOutcome.EXCEEDED, off
    # In the units of the error: of the value, or relative to it.
    size = float(np.abs(np.asarray(stated.value, dtype=complex)).max())
    assert off.distance == pytest.approx(0.01, rel=0.1) or off.distance <= 0.0101 * size


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("which", [0, 1])
def test_an_amplitude_or_a_decay_alone_that_is_off_is_refuted(which: int, side: float) -> None:
    row = computation_named("closed-form-breather")
    at = {"a": 2.5, "eta": 0.08, "c": 0.1, "reading": 1.0}
    stated = row.compute(at)
    value = stated.value.copy()
    value[which] *= 1.0 + 1e-4 * side
    assert row.check(at, replace(stated, value=value)).distance == pytest.approx(1e-4, rel=1e-3)


def test_a_root_or_a_velocity_that_is_left_out_is_missed() -> None:
    roots = computation_named("roots")
    at = {"v": 0.3, "c": 0.5, "label": 10.0, "side": 2.0}
    stated = roots.compute(at)
    k = stated.extra.k.copy()
    k[2] = k[1]  # twice the one, and not the other
    wrong = replace(stated, extra=replace(stated.extra, k=k + 1e-3))
    assert compared(stated.error, roots.check(at, wrong)) is PointOutcome.EXCEEDED
    kinetic = computation_named("kinetic")
    at = {"c": 0.45, "eta": 0.03125}
    stated = kinetic.compute(at)
    one = replace(stated, extra=replace(stated.extra, branches=stated.extra.branches[1:]))
    assert compared(stated.error, kinetic.check(at, one)) is PointOutcome.EXCEEDED
    at = {"c": 0.0453125, "eta": 0.001}  # just above c_pin, where fronts are slowest
    stated = kinetic.compute(at)
    assert 0.018 < stated.extra.branches[0].v < 0.036
    assert kinetic.check(at, stated).distance == 0.0
    none = replace(stated, extra=replace(stated.extra, branches=()))
    assert compared(stated.error, kinetic.check(at, none)) is PointOutcome.EXCEEDED


@pytest.mark.parametrize(
    ("eta", "c", "label"),
    [(0.03, 0.5, "front"), (0.05, 0.05, "breather"), (0.14, 0.5, "fixed point")],
)
def test_of_three_labels_one_holds(eta: float, c: float, label: str) -> None:
    at = {"eta": eta, "c": c, "displacement": 6.0}
    chain = vdp_chain({"a": 4.0, "eps": 0.01, "sites": 16, **at})
    psi = as_psi(excite(chain, [16], 6.0))
    for note in ("front", "breather", "fixed point"):
        stated = StatedValue(value=1.0, error=0.0, note=note, extra=(20.0, psi))
        assert (_label_holds(at, stated, full=False).distance == 0.0) is (note == label), note
    # A promise that is given before the front has run through is not kept.
    if label == "front":
        early = StatedValue(value=1.0, error=0.0, note=label, extra=(-15.0, psi))
        assert _label_holds(at, early, full=False).distance > 0.0


def test_the_energy_of_a_chain_is_that_of_places_velocities_and_springs() -> None:
    y, velocity = np.array([1.0, 2.0]), np.array([3.0, 4.0])
    assert _root_energy(2.0, y, velocity) == pytest.approx(np.sqrt(1 + 4 + 9 + 16 + 2.0))
