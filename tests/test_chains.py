"""The chains: what they accept, what they refuse, and that they are one family."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fronts.bound import models
from theory.cells.friction import FrictionCell
from theory.chains.chain import Chain, SmoothChain
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.thresholds.spreading import Spreading

CHAINS = models()
ORDINARY: dict[str, dict[str, Any]] = {
    "vdp": {"a": 4, "b": 0.5, "c": 0.6},
    "averaged": {"a": 4, "b": 0.5, "c": 0.6},
    "friction": {"c": 0.02},
    "piecewise": {"c": 0.6, "eta": 0.03},
    "chain": {"c": 0.6, "damping": "y**2 - 1"},
    "averaged-chain": {"c": 0.6, "damping": "y**2 - 1"},
}
NUMBERS = {
    model: [each for each in given if each != "damping"] for model, given in ORDINARY.items()
}


@pytest.mark.parametrize("model", ORDINARY)
def test_every_model_is_registered_and_describes_itself(model: str) -> None:
    chain = CHAINS[model](**ORDINARY[model])
    described = json.loads(json.dumps(chain.parameters()))
    assert described.pop("model") == model
    assert CHAINS[model](**described) == chain
    for each in dataclasses.fields(chain):  # type: ignore[arg-type]
        assert each.kw_only
        assert set(each.metadata) - {"kind", "allowed", "option"} == {"help", "symbol"}


@pytest.mark.parametrize(
    ("model", "name"), [(model, name) for model in ORDINARY for name in NUMBERS[model]]
)
@pytest.mark.parametrize(
    "wrong", ["0.3", True, np.True_, float("nan"), float("inf"), np.array([0.3]), None, 1j]
)
def test_what_is_not_a_number_is_refused(model: str, name: str, wrong: object) -> None:
    with pytest.raises(ParameterError):
        CHAINS[model](**{**ORDINARY[model], name: wrong})


@pytest.mark.parametrize("wrong", ["9", True, 9.5, float("nan"), np.array([9, 9])])
def test_a_number_of_sites_is_whole(wrong: object) -> None:
    for model in ("vdp", "averaged", "friction", "chain"):
        with pytest.raises(ParameterError, match="number of sites n"):
            CHAINS[model](**ORDINARY[model], sites=wrong)


def test_numbers_of_numpy_become_plain() -> None:
    chain = VdpChain(a=np.float64(4), b=np.float32(0.5), c=np.int64(1), sites=np.int64(9))
    assert [type(value) for value in chain.parameters().values()] == [
        str, float, float, float, float, int, str
    ]  # fmt: skip
    assert hash(chain) == hash(VdpChain(a=4, b=0.5, c=1, sites=9))


@pytest.mark.parametrize(
    "make",
    [
        lambda: FrictionCell(v_d="0.3"),  # type: ignore[arg-type]
        lambda: FrictionCell(xi=True),
        lambda: FrictionCell(mu_d=float("nan")),
        lambda: FrictionChain(c=0.1, v_d=-1.0),
        lambda: FrictionChain(c=0.1, mu_st=0.1),
        lambda: FrictionChain(c=0.1, ends="periodic"),  # type: ignore[arg-type]
        lambda: VdpChain(a=4, b=0.5, c=0.1, ends=Ends.LITERAL),
        lambda: VdpChain(a=4, b=0.5, c=0.1, ends=0),  # type: ignore[arg-type]
        lambda: VdpChain(a=4, b=0.5, c=-0.1),
        lambda: VdpChain(a=4, b=0.5, c=0.1).replace(d=1),
        lambda: VdpChain(a=4, b=3, c=0.1).stable_amplitude,
        lambda: PiecewiseChain(c=0.0, eta=0.03),
        lambda: PiecewiseChain(c=0.1),
        lambda: PiecewiseChain(c=0.1, a=4),
        lambda: PiecewiseChain(c=0.1, a=4, b=0.5, eta=0.03),
        lambda: PiecewiseChain(c=0.1, eta=0.2),
        lambda: Nucleus(1.5),  # type: ignore[arg-type]
    ],
)
def test_refused_in_one_sentence(make: Callable[[], object]) -> None:
    with pytest.raises(ParameterError) as caught:
        make()
    assert "\n" not in str(caught.value)


def test_a_chain_changes_by_replacement_and_is_checked_again() -> None:
    chain = FrictionChain.of(FrictionCell(v_d=2.0), c=0.02, sites=5)
    assert chain.replace(v_d=3).cell == FrictionCell(v_d=3.0)
    with pytest.raises(ParameterError, match="belt velocity"):
        chain.replace(v_d="2")
    assert VdpChain(a=4, b=0.5, c=0.6).averaged().full() == VdpChain(a=4, b=0.5, c=0.6)
    assert PiecewiseChain(c=0.6, a=4, b=0.5).replace(c=0.5).eta == 0.03125
    assert PiecewiseChain(c=0.6, a=4, b=0.5).replace(b=1).eta == 0.0625


@pytest.mark.parametrize("chain", [VdpChain(a=4, b=0.5, c=0.6), AveragedChain(a=3, b=0.3, c=0.6)])
def test_the_kernel_keeps_a_lone_site_on_its_cycle(chain: SmoothChain) -> None:
    # The averaged force over a period vanishes on the stable cycle: (1/2π)∮ ẏ·(damping) dt = 0.
    size, p = chain.stable_amplitude, chain.kernel_parameters()
    angle = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    site = (size * np.cos(angle), -size * np.sin(angle))
    slope_y, slope_w = chain.kernel()(site, site, site, p)
    growth = np.mean(site[0] * slope_y + site[1] * slope_w)
    assert abs(growth) < 1e-12 * size**2


def test_a_nucleus_is_placed() -> None:
    assert Nucleus(2, "0", Place("edge")).excited(9) == (1, 2)
    assert Nucleus(1).excited(31) == (16,)
    assert Nucleus(3) == Nucleus(3, "00")
    assert Spreading(3).nucleus == Nucleus(3, "00", Place.EDGE)
    assert Spreading().nucleus == Nucleus(1, place=Place.EDGE)
    several = Spreading(2, "edge", "several")  # type: ignore[arg-type]
    assert several.watched(9) == (3, 4, 5)  # three new sites
    assert Spreading(3, "bulk").place is Place.BULK  # type: ignore[arg-type]
    assert Place.EDGE.sentence.endswith(".")


def test_abstract_chains_are_not_models() -> None:
    assert set(CHAINS) >= {"vdp", "averaged", "friction", "piecewise"}
    assert not {"Chain", "SmoothChain", "VanDerPolChain"} & {c.__name__ for c in CHAINS.values()}
    assert issubclass(VdpChain, Chain)
