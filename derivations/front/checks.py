"""All checks of the front, for one chain."""

from __future__ import annotations

from derivations.front.checks_strong import StrongChecks


class Checks(StrongChecks):
    """What the steps of the front are held against.

    Parameters
    ----------
    model : ChainModel
        The chain, of which only coefficients are read.
    """
