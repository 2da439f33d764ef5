"""Chains and cells described by points of the robustness table, and rows for any other chain.

A registered smooth chain (``theory.chains.chain``) that has no row of its own gets one here: a run
from one excited site, compared with scipy's DOP853 applied to the right-hand side that the chain
itself provides. This checks the stepper, the window of active sites and the stated error, but not
the equation.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import partial

import numpy as np

from theory.arrays import FloatArray
from theory.cells.friction import FrictionCell
from theory.chains.chain import CHAINS, SmoothChain
from theory.chains.friction import FrictionChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.quantities.quantity import Computation, ReferenceCheck, StatedValue, axes, whole
from verification.quantities.scipy_states import compared
from verification.references.pace import last_state, paced
from verification.runs.excite import excite
from verification.runs.simulate import simulate

OWN_ROWS = ("vdp", "averaged", "chain", "averaged-chain")
"""Smooth models whose runs are compared with a right-hand side written a second time."""

_END = 10.0
_RANGE = (1e-2, 1e1)
"""Range of each real parameter of a chain that states none; values that the chain refuses are
skipped."""


def vdp_chain(at: Mapping[str, float]) -> VdpChain:
    """Return the chain of (8) with b = ηa²; a module supplies what its points omit.

    Examples
    --------
    >>> vdp_chain({"a": 4.0, "eps": 0.01, "sites": 7, "eta": 0.03125, "c": 0.6}).b
    0.5
    """
    b = at["eta"] * at["a"] * at["a"]  # a power would raise an error where it overflows
    return VdpChain(a=at["a"], b=b, c=at["c"], eps=at["eps"], sites=whole(at["sites"]))


def friction_cell(at: Mapping[str, float]) -> FrictionCell:
    """Return one cell of (5), with μ_d = 1/2."""
    return FrictionCell(v_d=at["v_d"], mu_st=at["mu_st"], mu_d=0.5, v0=at["v0"], xi=at["xi"])


def friction_chain(at: Mapping[str, float]) -> FrictionChain:
    """Return the chain (5)."""
    return FrictionChain.of(friction_cell(at), c=at["c"], sites=whole(at["sites"]))


def computations_of_chains() -> tuple[Computation, ...]:
    """Return a row for each registered smooth chain that has none of its own."""
    return tuple(
        _run_of(kind)
        for model, kind in CHAINS.items()
        if model not in OWN_ROWS and issubclass(kind, SmoothChain)
    )


def _run_of(kind: type[SmoothChain]) -> Computation:
    fields = dataclasses.fields(kind)  # type: ignore[arg-type]
    names = [each.name for each in fields if each.name not in ("sites", "ends")]
    return Computation(
        name=f"run-{kind.model}",
        title=f"state of the chain {kind.model} at t = {_END:g} from one excited site",
        axes=axes(**dict.fromkeys(names, _RANGE), sites=(2, 20), tolerance=(1e-12, 1e-4)),
        compute=partial(_run, kind, names),
        check=partial(_check_run, kind, names),
        seconds=60.0,
        share=0.2,
        limits="the chain states no range for its parameters",
    )


def _chain(kind: type[SmoothChain], names: list[str], at: Mapping[str, float]) -> SmoothChain:
    return kind(**{name: at[name] for name in names}, sites=whole(at["sites"]))  # type: ignore[call-arg]


def _run(kind: type[SmoothChain], names: list[str], at: Mapping[str, float]) -> StatedValue:
    chain = _chain(kind, names, at)
    start = excite(chain, [1])
    run = simulate(chain, start, _END, samples=2, tolerance=at["tolerance"])
    if run.error is None:
        raise ParameterError(
            "tolerance", at["tolerance"], "one with an error", "take a larger tolerance"
        )
    return StatedValue(value=run.states[-1], error=run.error, extra=start)


def _check_run(
    kind: type[SmoothChain], names: list[str], at: Mapping[str, float], stated: StatedValue
) -> ReferenceCheck:
    """Integrate all sites by scipy, each by the chain's right-hand side in plain Python."""
    chain = _chain(kind, names, at)
    right_side, numbers, sites = chain.kernel(), chain.kernel_parameters(), chain.sites

    def rate(_: float, flat: FloatArray) -> FloatArray:
        pairs = flat.reshape(2, sites).T
        out = np.empty((sites, 2))
        for n, site in enumerate(pairs):
            left, right = pairs[max(n - 1, 0)], pairs[min(n + 1, sites - 1)]
            out[n] = right_side(tuple(site), tuple(left), tuple(right), numbers)
        return out.T.ravel()

    def last(tolerance: float) -> FloatArray:
        atol = tolerance * float(np.abs(stated.extra).max())
        end, start = _END * chain.kernel_rate, stated.extra.ravel()
        return last_state(paced(rate, end), end, start, rtol=tolerance, atol=atol).reshape(2, sites)

    return compared(stated.value, last, "scipy's DOP853 on the chain's own right side")
