"""The integration of each kind of chain."""

from __future__ import annotations

from inspect import signature
from typing import Any

import numpy.typing as npt

from theory.chains.chain import Chain, SmoothChain
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError
from verification.runs.friction_integration import FrictionIntegration
from verification.runs.integration import Integration
from verification.runs.smooth_integration import SmoothIntegration

INTEGRATIONS: dict[type, Any] = {
    FrictionChain: FrictionIntegration,
    SmoothChain: SmoothIntegration,
}
"""Integrations by class of chain; a class derived from one of these uses the same."""


def integration(
    chain: Chain, start: npt.ArrayLike, times: npt.ArrayLike, **options: Any
) -> Integration:
    """Return the integration of a chain from a start; see :class:`Integration`.

    Parameters
    ----------
    chain : Chain
        Parameters.
    start : array_like
        State at t = 0, in a form that :func:`checked_state` accepts.
    times : array_like, shape (M,)
        Times t of the samples, ascending from 0 or later.
    **options
        ``tolerance``, ``end`` (by default the last of ``times``), and the parameters of the
        integration's class.

    Raises
    ------
    ParameterError
        If there is no integration for the model, or an option or the start does not fit.
    """
    kinds = (INTEGRATIONS[each] for each in type(chain).__mro__ if each in INTEGRATIONS)
    kind = next(kinds, None)
    if kind is None:
        raise ParameterError(
            "model", getattr(chain, "model", type(chain).__name__),
            "one with an integration in time", "take another chain, or name an integration for it",
        )  # fmt: skip
    known = [name for name in signature(kind).parameters if name not in {"chain", "start", "times"}]
    for name in options:
        if name not in known:
            allowed = f"one of {', '.join(known)} for the model {chain.model}"
            raise ParameterError("option", name, allowed, "leave it out")
    run: Integration = kind(chain, start, times, **options)
    return run
