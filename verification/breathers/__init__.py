"""Breathers of Model II (Figs. 7-11): ``breather`` finds one by each of four methods.

Its answer is in ``result``. ``envelope`` solves (43), ``orbits`` (8) and ``own`` other chains, by
one contract (``family``) with ``verification.continuation``; ``run`` integrates either of the
first two; ``periodic_motion`` measures one period.
Stability: ``exponents`` and ``floquet``. Their thresholds are in ``verification/thresholds``.
``outcome`` follows a nucleus of which no breather holds: what size it grows to, and whether it
stands, creeps on or becomes a front.
"""
