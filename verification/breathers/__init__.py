"""Breathers of Model II (Figs. 7-11): found, followed, and held against the chain.

``nucleus`` says which sites and phases. ``envelope`` solves (43), ``orbits`` (8), with ``newton``
and ``continuation``; ``run`` integrates; ``orbit_distance`` compares; ``periodic_motion`` measures
one period. Stability: ``exponents`` and ``floquet``. Escape of prepared nuclei:
``nucleation``, ``slow_sweep`` and ``escape_range``. ``outcome`` follows a
nucleus that is lost: what size it grows to, and whether it stands, creeps on or becomes a front.
"""
